# SPDX-License-Identifier: MIT
"""Extreme numbers in every argument, and in the arrays, give an exception or a result, and never end the program."""
import itertools
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import g4lidar

Make = Callable[..., g4lidar.Simulator]
Points = npt.NDArray[np.void]
Case = tuple[str, Callable[..., Any], dict[str, Any], dict[str, Any]]

INTEGERS: list[Any] = [0, 1, -1, 255, 65535, 65536, 2**31 - 1, 2**31, -(2**31), 2**32, 2**53, 2**63 - 1, 2**63,
                       -(2**63), 2**64, 10**400, True]
REALS: list[Any] = [0.0, -0.0, 5e-324, 1e-45, 0.5, 1e9, 1e15, 2.0**63, -(2.0**63), 3.4e38, 1e39, 1.8e308, -1.8e308,
                    math.inf, -math.inf, math.nan]
# An array of this many numbers does not fit into the memory, and one of fewer is not extreme.
SIZES: list[Any] = [0, -1, 2**62, 2**63 - 1, 2**63, 2**64, 10**400]
REFUSALS = (ValueError, TypeError, OverflowError, MemoryError, RuntimeError, OSError, g4lidar.Error)


def extreme_points() -> Points:
    """Each extreme number in each field."""
    rows = [(0.0, 0.0, 0), *itertools.product(REALS, REALS, [0, 1, -1, 2**63 - 1, -(2**63), 10**9])]
    points = np.zeros(len(rows), g4lidar.POINT_DTYPE)
    with np.errstate(over="ignore"):
        points["angle_deg"] = np.array([row[0] for row in rows]).astype(np.float32)
        points["range_mm"] = np.array([row[1] for row in rows]).astype(np.float32)
    points["time_ns"] = [row[2] for row in rows]
    points["revolution"] = np.arange(len(rows)) * 1_000_003 % 2**32
    points["flags"] = np.arange(len(rows)) % 256
    return points


def poses(*times_ns: int) -> Points:
    path = np.zeros(len(times_ns), g4lidar.POSE_DTYPE)
    path["time_ns"] = times_ns
    path["x_m"] = np.arange(len(times_ns))
    return path


POINTS = extreme_points()
MOTION = g4lidar.Twist(1.0, 0.0, 0.5)
# What is called, with what, and the extreme values that are set one at a time.
CASES: list[Case] = [
    ("Twist", g4lidar.Twist, {}, {"x_m_per_s": REALS, "y_m_per_s": REALS, "yaw_rad_per_s": REALS}),
    ("Mounting", g4lidar.Mounting, {}, {"x_m": REALS, "y_m": REALS, "yaw_rad": REALS}),
    ("to_xy", g4lidar.to_xy, {"points": POINTS}, {"turn_deg": INTEGERS}),
    ("fill_grid", g4lidar.fill_grid, {"points": POINTS, "n": 90},
     {"n": SIZES, "turn_deg": INTEGERS, "longest_mm": REALS}),
    ("deskew", g4lidar.deskew, {"points": POINTS, "motion": MOTION, "reference_ns": 1},
     {"reference_ns": INTEGERS, "turn_deg": INTEGERS}),
    ("deskew by path", g4lidar.deskew,
     {"points": POINTS, "motion": poses(-(2**63), 0, 2**63 - 1), "reference_ns": 1}, {"reference_ns": INTEGERS}),
    ("merge_scans", g4lidar.merge_scans,
     {"lidars": [(POINTS, g4lidar.Mounting())], "motion": MOTION, "reference_ns": 1},
     {"reference_ns": INTEGERS, "fresh": REALS}),
    ("mark_isolated", g4lidar.mark_isolated, {"points": POINTS},
     {"window": INTEGERS, "count": INTEGERS, "near_m": REALS, "near_ratio": REALS}),
    ("mark_veiling", g4lidar.mark_veiling, {"points": POINTS}, {"window": INTEGERS, "least_angle_deg": REALS}),
    ("mark_bit_errors", g4lidar.mark_bit_errors, {"points": POINTS}, {}),
    ("ScanShaper", g4lidar.ScanShaper, {"near": True},
     {"field_of_view": [(a, b) for a in REALS for b in REALS], "ignored_sectors": [[(a, 10.0)] for a in REALS],
      "masks": [[[(a, 0.0), (1.0, a), (0.0, 1.0)]] for a in REALS], "least_range_mm": REALS,
      "greatest_range_mm": REALS, "excluded": INTEGERS, "shortest_mm": REALS, "near_revolutions": INTEGERS}),
    ("TwistEstimator.add", g4lidar.TwistEstimator().add, {"points": POINTS}, {"turn_deg": INTEGERS}),
    ("open", g4lidar.open, {"device": "/dev/nosuch-port"},
     {"baud": INTEGERS, "answer_time": REALS, "stall_time": REALS, "longest_backoff": REALS, "batch": REALS,
      "transport_delay": REALS, "speed": REALS, "begin": REALS, "end": REALS, "raw_sample_rate_hz": INTEGERS,
      "device_wait": [value for value in REALS if not value > 0.0]}),
    ("doctor", g4lidar.doctor, {"device": "/dev/nosuch-port"},
     {"measuring_time": REALS, "baud": INTEGERS}),
]


def is_handled(call: Callable[..., Any], arguments: dict[str, Any]) -> bool:
    """Whether the call gives a result or an exception of the documented kinds; another one is passed on."""
    try:
        call(**arguments)
    except REFUSALS:
        return False
    return True


@pytest.mark.parametrize("case", CASES, ids=[case[0] for case in CASES])
def test_arguments(case: Case) -> None:
    _, call, usual, extremes = case
    is_handled(call, usual)
    for name, values in extremes.items():
        for value in values:
            is_handled(call, {**usual, name: value})


def test_products_of_extreme_points() -> None:
    assert not np.isnan(g4lidar.fill_grid(POINTS, 4)).all()
    assert g4lidar.to_xy(POINTS).shape == (len(POINTS), 2)
    shaper = g4lidar.ScanShaper(near=True, speckle=True, edges=True, deskew="by_scans")
    for _ in range(3):
        assert len(shaper.shape(POINTS).kept) <= len(POINTS)
        assert len(shaper.for_grid) <= len(POINTS)


def test_calls_of_a_lidar(g4_simulator: Make, tmp_path: Path) -> None:
    made = g4_simulator()
    lidar = g4lidar.open(made)
    with lidar:
        lidar.start()
        for seconds in [value for value in REALS if not value > 1.0]:
            is_handled(lidar.try_scan, {"timeout": seconds})
            is_handled(lidar.next_points, {"timeout": seconds})
        scan = lidar.try_scan()
        for number in SIZES:
            is_handled(scan.ranges, {"n": number})
            is_handled(scan.laser_scan, {"bins": number})
        for setting, value in itertools.product(["frequency", "sample_rate"], [*INTEGERS, *REALS]):
            try:
                setattr(lidar, setting, value)
            except (*REFUSALS, AttributeError):
                pass
    writer = g4lidar.RecordingWriter(tmp_path / "extreme.mcap", overwrite=True)
    for time_ns in INTEGERS:
        is_handled(writer.from_device, {"data": b"\xaa\x55", "time_ns": time_ns})
        is_handled(writer.to_device, {"data": b"\xa5\x60", "time_ns": time_ns})
        is_handled(writer.set_wall_clock, {"ahead_ns": time_ns})
        for value in REALS:
            is_handled(writer.odometry, {"time_ns": time_ns, "x_m": value, "y_m": value, "yaw_rad": value})
    writer.close()
    for begin, end in itertools.product(REALS, REALS):
        is_handled(g4lidar.Recording, {"path": tmp_path / "extreme.mcap", "begin": begin, "end": end})
    with g4lidar.open(tmp_path / "extreme.mcap") as played:
        assert played.player is not None
        for value in REALS:
            is_handled(played.player.seek, {"seconds": value})
            try:
                played.player.speed = value
            except REFUSALS:
                pass
