# SPDX-License-Identifier: MIT
"""The table of cases that all doors of the library have: tests/cases/cases.json."""
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl

import numpy as np
import pytest

import g4lidar

HERE = Path(__file__).parent  # or a copy of it, with the table in it
DIRECTORY = HERE / "cases" if (HERE / "cases").exists() else HERE.parents[1] / "tests" / "cases"
TABLE: dict[str, Any] = json.loads((DIRECTORY / "cases.json").read_text(encoding="utf-8"))
KEYWORDS = {"frequency": "frequency_hz", "sample_rate": "sample_rate_hz"}
FILTERS = ("ignore", "fov", "range", "mask", "speckle", "edges")


def numbers(text: str) -> tuple[float, float]:
    begin, end = text.split(":")
    return float(begin or 0), float(end)


def shaper_of(options: dict[str, Any]) -> g4lidar.ScanShaper:
    given: dict[str, Any] = {name: True for name in ("speckle", "edges") if name in options}
    if "ignore" in options:
        given["ignored_sectors"] = [numbers(options["ignore"])]
    if "fov" in options:
        given["field_of_view"] = numbers(options["fov"])
    if "range" in options:
        least, most = numbers(options["range"])
        given |= {"least_range_mm": 1000 * least, "greatest_range_mm": 1000 * most}
    if "mask" in options:
        line = (DIRECTORY / options["mask"].removeprefix("$/")).read_text(encoding="utf-8").split("polygon")[1].split()
        given["masks"] = [[(float(x), float(y)) for x, y in zip(line[::2], line[1::2], strict=True)]]
    return g4lidar.ScanShaper(returns_only=True, **given)


def last_scan(case: dict[str, Any], make: Callable[..., g4lidar.Simulator]) -> tuple[g4lidar.Scan, Any]:
    """The last scan of 20, and its returns as angles in the frame of the robot, ranges, intensities."""
    options = case.get("options", {})
    source = case["source"].replace("$", str(DIRECTORY))
    keywords = {KEYWORDS.get(name, name): value for name, value in options.items() if name not in FILTERS}
    if keywords.get("direction") == "ccw":
        keywords["direction"] = "counter_clockwise"
    if "stall_time" in keywords:
        keywords["stall_time"] /= 1000
    device: Any = source
    if source.startswith("sim:") and "expect" in case:
        words = dict(parse_qsl(source.removeprefix("sim:?")))
        faults = [words.pop("fault")] if "fault" in words else []
        device = make(faults=faults, **words)
    shaper = shaper_of(options)
    with g4lidar.open(device, **keywords) as lidar:
        lidar.start()
        for _, scan in zip(range(20), lidar.scans(timeout=10)):
            kept = shaper.shape(scan).kept
            if scan.is_whole:
                last = scan, kept
    bearing = (last[0].turn_deg - last[1]["angle_deg"].astype(float)) % 360
    return last[0], (bearing, last[1]["range_mm"] * 1e-3, last[1]["intensity"])


def check_hits(want: dict[str, Any], bearings: Any, ranges: Any, intensities: Any) -> None:
    walls = {"ahead": 1, "left": 2, "behind": 4, "right": 3} if "walls" in want else want
    for name, direction in {"ahead": 0, "left": 90, "behind": 180, "right": 270}.items():
        if name in walls:
            near = np.abs((bearings - direction + 180) % 360 - 180) <= 5
            assert ranges[near].min() == pytest.approx(walls[name], abs=0.02), name
    if "none" in want:
        begin, end = want["none"]
        behind = (bearings - begin) % 360
        assert not ((behind > 0.01) & (behind < end - begin - 0.01)).any()
        if "outside" in want:
            assert len(set(np.floor(bearings))) == pytest.approx(360 - (end - begin), abs=2)
    else:
        assert len(ranges) > 100
    if "between" in want:
        assert ranges.min() >= want["between"][0] - 1e-4 and ranges.max() <= want["between"][1] + 1e-4
    if "intensity" in want:
        assert (want["intensity"] + 1) // 4 <= intensities.max() <= want["intensity"]


@pytest.mark.parametrize("case", TABLE["cases"], ids=lambda case: case["name"])
def test_case(case: dict[str, Any], g4_simulator: Callable[..., g4lidar.Simulator]) -> None:
    if "python" in case.get("not", {}):
        assert case["not"]["python"] in TABLE["reasons"]
        return
    if "error" in case:
        problem, *words = case["error"]
        with pytest.raises(getattr(g4lidar.errors, "".join(map(str.title, problem.split("_"))))) as caught:
            last_scan(case, g4_simulator)
        assert all(word in str(caught.value) for word in words), str(caught.value)
        return
    scan, hits = last_scan(case, g4_simulator)
    want = case["expect"]
    assert scan.model == want.get("model", scan.model)
    if "samples" in want:
        assert len(scan) == pytest.approx(want["samples"], rel=0.01, abs=2)
    if "frequency" in want:
        assert math.isclose(scan.measured_frequency_hz, want["frequency"], rel_tol=0.01)
    check_hits(want, *hits)
