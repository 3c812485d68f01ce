# SPDX-License-Identifier: MIT
"""Arrays of points of models with and without a turn: where the walls of the simulated room really are."""
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import g4lidar
from g4lidar import errors

# In the frame of the robot: ahead 1 m, to the left 2 m, behind 4 m, to the right 3 m.
WORLD = "wall 1 -3 1 2\nwall 1 2 -4 2\nwall -4 2 -4 -3\nwall -4 -3 1 -3\nmount 0,0,0\nlidar 0 0 0\n"
HALL = "wall 6 -3 6 2\nwall 6 2 -4 2\nwall -4 2 -4 -3\nwall -4 -3 6 -3\nmount 0,0,0\nlidar 0 0 0\n"
MODELS = ["x4", "g4", "scl", "t-mini-pro", "tg30"]


def scans_of(model: str, tmp_path: Path, world: str = WORLD, count: int = 5) -> list[g4lidar.Scan]:
    (tmp_path / "room.txt").write_text(world)
    with g4lidar.open(g4lidar.Simulator(world=str(tmp_path / "room.txt"), model=model, seed=3)) as lidar:
        lidar.start()
        found = []
        for scan in lidar.scans():
            if scan.is_whole:
                found.append(scan)
            if len(found) == count:
                return found
    raise AssertionError("too few scans")


def off_the_walls(xy: npt.NDArray[np.floating]) -> float:
    """The median distance of points from the nearest wall, in metres."""
    x, y = xy[~np.isnan(xy[:, 0])].T
    return float(np.median(np.min(np.abs([x - 1, y - 2, x + 4, y + 3]), axis=0)))


@pytest.mark.parametrize("model", MODELS)
def test_arrays_have_the_turn_of_the_model(model: str, tmp_path: Path) -> None:
    scan = scans_of(model, tmp_path)[-1]
    points = scan.points
    assert scan.model == model
    assert off_the_walls(g4lidar.to_xy(points, model=model)) < 0.03
    assert off_the_walls(g4lidar.to_xy(points, turn_deg=scan.turn_deg)) < 0.03
    assert (off_the_walls(g4lidar.to_xy(points)) < 0.03) == (model in ("g4", "tg30")), "the default is a G4"
    ranges = g4lidar.fill_grid(points, 16, pick="minimum", model=model)
    assert ranges[8] == pytest.approx(1, abs=0.05) and ranges[12] == pytest.approx(2, abs=0.05)
    assert ranges[4] == pytest.approx(3, abs=0.05) and ranges[0] == pytest.approx(4, abs=0.05)
    mount = g4lidar.Mounting(0, 0, 0)
    still = g4lidar.Twist(0, 0, 0)
    by_model, *_ = g4lidar.merge_scans([(points, mount, model)], still, scan.end_ns)
    by_turn, *_ = g4lidar.merge_scans([(points, mount, scan.turn_deg)], still, scan.end_ns)
    assert off_the_walls(g4lidar.to_xy(by_model)) < 0.03, "a merged scan is that of a G4"
    assert by_model.tobytes() == by_turn.tobytes()


def test_the_grid_is_that_of_the_model(tmp_path: Path) -> None:
    nothing = scans_of("x4", tmp_path)[-1].points.copy()
    nothing["range_mm"], nothing["flags"] = 0, g4lidar.PointFlag.NO_RETURN
    # Four fifths of 20,000 and 5,000 samples a second at 10 Hz; the longest ranges by the manufacturer.
    for model, bins, longest_m in [("tg30", 1600, 30), ("x4", 400, 10)]:
        ranges = g4lidar.fill_grid(nothing, no_return="max", model=model)
        assert len(ranges) == bins and np.nanmax(ranges) == pytest.approx(longest_m)
    ranges = g4lidar.fill_grid(nothing, no_return="max")
    assert len(ranges) == 720 and np.nanmax(ranges) == pytest.approx(16)
    assert np.nanmax(g4lidar.fill_grid(nothing, no_return="max", longest_mm=5, model="x4")) == pytest.approx(0.005)


@pytest.mark.parametrize("model", ["x4", "g4"])
def test_motion_has_the_turn_of_the_model(model: str, tmp_path: Path) -> None:
    scans = scans_of(model, tmp_path, HALL + "drive forward 2 0.4\n", 20)
    named, as_g4 = g4lidar.TwistEstimator(), g4lidar.TwistEstimator()
    speeds = []
    for scan in scans:
        found, other = named.add(scan.points, model=model), as_g4.add(scan.points)
        if found.is_known and other.is_known:
            speeds.append((found.twist.x_m_per_s, other.twist.x_m_per_s))
    found_speed, other_speed = np.median(speeds, axis=0)
    assert 0.25 < found_speed < 0.7
    assert other_speed == pytest.approx(found_speed if model == "g4" else -found_speed, abs=0.02)
    # Deskewed points are on the walls as they are at the end of the scan; how far it had driven is not known here.
    scan = scans[-1]
    fast = g4lidar.Twist(-5, 0, 0)
    here, _ = g4lidar.deskew(scan.points, fast, scan.end_ns, model=model)
    same, _ = g4lidar.deskew(scan.points, fast, scan.end_ns, turn_deg=scan.turn_deg)
    assert here.tobytes() == same.tobytes()
    # What was ahead when the revolution was half over is 5 m/s times half of its time nearer than it is at the end.
    turned = np.deg2rad(scan.turn_deg - scan.points["angle_deg"].astype(float))
    x_m = scan.points["range_mm"] / 1000 * np.cos(turned)
    ago = (scan.end_ns - scan.points["time_ns"]) * 1e-9
    xy = g4lidar.to_xy(here, model=model)
    returns = scan.points["range_mm"] > 0
    assert np.allclose(xy[returns, 0], (x_m + 5 * ago)[returns], atol=1e-3)


def test_marks_know_the_model_and_the_angle_between_samples(tmp_path: Path) -> None:
    points = np.zeros(60, g4lidar.POINT_DTYPE)
    points["angle_deg"] = np.arange(60) * 3.0
    points["range_mm"] = 2000  # 10.5 cm apart: 5.2 % of the range
    assert g4lidar.mark_isolated(points, near_ratio=0.05)["flags"].astype(bool).all()
    assert not g4lidar.mark_isolated(points)["flags"].any()
    points["range_mm"] = 40_000
    points["range_mm"][30] = 40_000 - 32_768  # bit 15, which samples in quarters of a millimetre do not have
    assert np.flatnonzero(g4lidar.mark_bit_errors(points, model="tg30")["flags"]).tolist() == [30]
    assert not g4lidar.mark_bit_errors(points)["flags"].any()


def test_the_model_and_the_turn_agree(tmp_path: Path) -> None:
    points = np.zeros(1, g4lidar.POINT_DTYPE)
    assert len(g4lidar.to_xy(points, turn_deg=0, model="x4")) == 1
    with pytest.raises(ValueError, match="turn_deg of the model: 0, not 180"):
        g4lidar.to_xy(points, turn_deg=180, model="x4")
    with pytest.raises(ValueError, match="turn_deg: 0 or 180, not 90"):
        g4lidar.fill_grid(points, turn_deg=90)
    unknown: list[Callable[[], object]] = [
        lambda: g4lidar.to_xy(points, model="x44"), lambda: g4lidar.fill_grid(points, model="x44"),
        lambda: g4lidar.TwistEstimator().add(points, model="x44"),
        lambda: g4lidar.ScanShaper().shape(points, model="x44"),
        lambda: g4lidar.mark_bit_errors(points, model="x44"),
    ]
    for call in unknown:
        with pytest.raises(errors.BadOption, match="'x44' is not one of g4"):
            call()
