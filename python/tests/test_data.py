# SPDX-License-Identifier: MIT
"""Filters, grids, deskewing, merging, and the doctor."""
import math
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import g4lidar
from g4lidar import PointFlag

Make = Callable[..., g4lidar.Simulator]
Points = npt.NDArray[np.void]


def ring(range_mm: float, count: int = 720, begin_ns: int = 1_000_000_000) -> Points:
    """One turn in 0.1 s, all at the same range."""
    points = np.zeros(count, g4lidar.POINT_DTYPE)
    points["angle_deg"] = np.arange(count) * (360 / count)
    points["range_mm"] = range_mm
    points["time_ns"] = begin_ns + np.arange(count) * (100_000_000 // count)
    return points


def test_grid() -> None:
    points = ring(1500, 360)
    points["range_mm"][90] = 700
    points["range_mm"][180] = 0
    points["flags"][180] = PointFlag.NO_RETURN
    grid = g4lidar.fill_grid(points[points["angle_deg"] != 200], 360, frame="vendor")
    assert grid[0] == pytest.approx(1.5) and grid[90] == pytest.approx(0.7)
    assert math.isinf(grid[180]) and math.isnan(grid[200])
    # 90 degrees clockwise from the cable is 90 degrees to the left of the robot.
    assert g4lidar.fill_grid(points, 360)[270] == pytest.approx(0.7)
    with pytest.raises(ValueError):
        g4lidar.fill_grid(points, 0)


def test_no_return_is_not_free_space() -> None:
    points = ring(2000, 3)
    points["angle_deg"] = [90, 86.9, 180]  # the first two are on one beam: corrected by their ranges
    points["range_mm"] = [400, 0, 0]
    points["revolution"] = [0, 1, 1]
    points["flags"] = [0, PointFlag.NO_RETURN, PointFlag.NO_RETURN]
    grid = g4lidar.fill_grid(points[1:], 4, frame="vendor", no_return="max")
    assert grid[1] == grid[2] == pytest.approx(16)
    assert np.isnan(g4lidar.fill_grid(points[1:], 4, frame="vendor", no_return="nan")).all()
    shaper = g4lidar.ScanShaper(near=True)
    marked = shaper.shape(points).kept
    assert list(marked["flags"]) == [0, PointFlag.NO_RETURN | PointFlag.MAY_BE_TOO_NEAR, PointFlag.NO_RETURN]
    grid = g4lidar.fill_grid(marked[1:], 4, frame="vendor")
    assert math.isnan(grid[1]) and grid[2] == math.inf
    assert g4lidar.fill_grid(marked[1:], 4, frame="vendor", near_is_minus_infinity=True)[1] == -math.inf
    assert (shaper.shape(points[2:]).kept["flags"] & PointFlag.MAY_BE_TOO_NEAR == 0).all()
    assert shaper.shape(points[1:2]).kept["flags"][0] & PointFlag.MAY_BE_TOO_NEAR, "it remembers the first revolution"
    far = g4lidar.ScanShaper(near=True, shortest_mm=100)
    assert (far.shape(points).kept["flags"] & PointFlag.MAY_BE_TOO_NEAR == 0).all()
    with pytest.raises(ValueError):
        g4lidar.ScanShaper(near=True, shortest_mm=-1)
    with pytest.raises(TypeError):
        g4lidar.fill_grid(points, 4, no_return="far")  # type: ignore[arg-type]


def kept(points: Points, **options: object) -> int:
    return len(g4lidar.ScanShaper(**options).shape(points).kept)  # type: ignore[arg-type]


def test_filters() -> None:
    points = ring(1000, 360)
    points["range_mm"][:10] = 5000
    assert kept(points, greatest_range_mm=2000) == 350
    assert kept(points, field_of_view=(-90, 90)) == 181
    assert kept(points, field_of_view=(0, 90), frame="vendor") == 91
    assert kept(points, ignored_sectors=[(350, 10)], frame="vendor") == 339
    ahead = [(0.5, -0.2), (1.5, -0.2), (1.5, 0.2), (0.5, 0.2)]
    left = g4lidar.ScanShaper(masks=[ahead]).shape(points)
    assert 360 - len(left.kept) == 23  # within asin(0.2) of straight ahead
    assert len(left.for_grid) == 360
    points["flags"][5] = PointFlag.ISOLATED
    assert kept(points, excluded=PointFlag.ISOLATED) == 359


def test_a_shaper_leaves_out_what_is_marked() -> None:
    points = ring(2000, 1286)
    points["range_mm"][100] = 1000
    assert kept(points, speckle=True) == 1285
    points["range_mm"][600:] = 4000
    points["range_mm"][600] = 3000
    assert kept(points, edges=True) == 1285
    assert kept(points) == 1286


def test_a_shaper_deskews_and_counts_what_it_does_not() -> None:
    points = ring(2000)
    reference = int(points["time_ns"][0])
    path = np.zeros(2, g4lidar.POSE_DTYPE)
    path["time_ns"] = [reference, reference + 50_000_000]
    path["yaw_rad"] = [0.0, 0.05]
    shaper = g4lidar.ScanShaper(deskew="by_path", restamps=True)
    moved = shaper.shape(points, path).kept
    half = points["time_ns"] <= path["time_ns"][1]
    expected, outside = g4lidar.deskew(points, path, reference)
    assert shaper.outside == outside == np.count_nonzero(~half) > 300
    assert (moved["angle_deg"] == expected["angle_deg"]).all() and (moved["flags"] == expected["flags"]).all()
    assert (moved["time_ns"][half] == reference).all() and (moved["time_ns"][~half] == points["time_ns"][~half]).all()
    assert ((moved["flags"] & PointFlag.NOT_DESKEWED != 0) == ~half).all()
    assert shaper.shape(points).outside == 720 and shaper.points_not_deskewed == 720 + outside
    with pytest.raises(ValueError, match="ascend"):
        shaper.shape(points, path[::-1])
    assert g4lidar.ScanShaper(deskew="by_scans").shape(points).twist is None


def test_a_shaper_estimates_the_motion(g4_simulator: Make) -> None:
    shaper = g4lidar.ScanShaper(deskew="by_scans")
    with g4lidar.open(g4_simulator()) as lidar:
        lidar.start()
        for number, scan in enumerate(lidar.scans()):
            shaper.shape(scan)
            if number == 3:
                break
    assert shaper.twist is not None and abs(shaper.twist.x_m_per_s) < 0.1  # it stands
    assert shaper.outside == 0 and shaper.points_not_deskewed > 1000  # of the first scan


def test_marks() -> None:
    points = ring(2000, 1286)
    points["range_mm"][100] = 1000
    marked = g4lidar.mark_isolated(points)
    assert list(np.flatnonzero(marked["flags"] & PointFlag.ISOLATED)) == [100]
    assert (points["flags"] == 0).all()
    points["range_mm"][600:] = 4000
    points["range_mm"][600] = 3000
    veiling = g4lidar.mark_veiling(points)
    assert list(np.flatnonzero(veiling["flags"] & PointFlag.VEILING)) == [600]
    wrong = ring(2000, 1286)
    wrong["range_mm"][300] = 2000 + 4096  # bit 14 of the quarters of a millimetre
    unlikely = g4lidar.mark_bit_errors(wrong)
    assert list(np.flatnonzero(unlikely["flags"] & PointFlag.UNLIKELY)) == [300]
    with pytest.raises(ValueError):
        g4lidar.mark_isolated(points, window=17)


def test_a_shaper_gives_the_points_of_convert_bit_for_bit(tmp_path: Path) -> None:
    tool = os.environ.get("G4_DUMP", "")
    if not os.access(tool, os.X_OK):
        pytest.skip("g4-dump is not built")
    (tmp_path / "way.txt").write_text("drive forward 2 1\ndrive turn 180 90\n")
    for words in (
        "sim --seconds 6 --dropout 0.02 --path way.txt -o way.bin",
        "convert way.bin way.mcap",
        "convert way.mcap way.npy --time mono --speckle --edges --near --range 0.3: --deskew scans",
    ):
        subprocess.run([tool, *words.split()], cwd=tmp_path, check=True, stderr=subprocess.DEVNULL)
    shaper = g4lidar.ScanShaper(speckle=True, edges=True, near=True, least_range_mm=300, deskew="by_scans")
    points = []
    with g4lidar.open(f"file:{tmp_path}/way.mcap", partial_scans=True) as lidar:
        lidar.start()
        for scan in lidar.scans():
            points.append(shaper.shape(scan).kept)
    got, expected = np.concatenate(points), np.load(tmp_path / "way.npy")
    for name in ("angle_deg", "range_mm", "time_ns", "revolution", "flags", "sample_flags", "intensity"):
        assert got[name].tobytes() == expected[name].astype(got[name].dtype).tobytes(), name


def test_deskew_by_a_twist_and_along_poses() -> None:
    points = ring(2000)
    reference = int(points["time_ns"][0])
    seconds = (points["time_ns"] - reference) * 1e-9
    moved, outside = g4lidar.deskew(points, g4lidar.Twist(yaw_rad_per_s=1.0), reference)
    assert outside == 0
    # The head turns clockwise; the robot turned counter-clockwise by t radians.
    expected = (points["angle_deg"] - np.degrees(seconds)) % 360
    assert np.abs((moved["angle_deg"] - expected + 180) % 360 - 180).max() < 1e-3
    assert np.abs(moved["range_mm"] - 2000).max() < 0.01
    path = np.zeros(2, g4lidar.POSE_DTYPE)
    path["time_ns"] = [reference, reference + 1_000_000_000]
    path["yaw_rad"] = [0.0, 1.0]
    along, outside = g4lidar.deskew(points, path, reference)
    assert outside == 0
    assert np.abs(along["angle_deg"] - moved["angle_deg"]).max() < 1e-3
    _, outside = g4lidar.deskew(points, path[:1], reference)
    assert outside == len(points)
    straight, _ = g4lidar.deskew(points, g4lidar.Twist(x_m_per_s=1.0), reference)
    x, y = g4lidar.to_xy(points).T
    moved_x, moved_y = g4lidar.to_xy(straight).T
    assert np.abs(moved_x - (x + seconds)).max() < 1e-4 and np.abs(moved_y - y).max() < 1e-4
    with pytest.raises(ValueError, match="ascend"):
        g4lidar.deskew(points, path[::-1], reference)
    with pytest.raises(ValueError, match="finite"):
        g4lidar.deskew(points, g4lidar.Twist(math.nan), reference)


def test_merge() -> None:
    points = ring(2000)
    end = int(points["time_ns"][-1])
    front, rear = g4lidar.Mounting(x_m=0.5), g4lidar.Mounting(x_m=-0.5, yaw_rad=math.pi)
    scans = [(points, front), (points, rear), (points[:0], rear)]
    merged, outside, lost = g4lidar.merge_scans(scans, g4lidar.Twist(), end)
    assert len(merged) == 2 * len(points) and outside == 0 and lost == [False, False, True]
    x, y = g4lidar.to_xy(merged).T
    middle = np.where(np.arange(len(merged)) < len(points), 0.5, -0.5)
    assert np.abs(np.hypot(x - middle, y) - 2.0).max() < 1e-3


def test_doctor_takes_the_file_that_open_takes(g4_simulator: Make, tmp_path: Path) -> None:
    path = tmp_path / "walk.mcap"
    with g4lidar.open(g4_simulator(), record=path) as lidar:
        lidar.start()
        lidar.try_scan(20)
    by_name = [(report.stage, report.verdict) for report in g4lidar.doctor(path)]
    assert by_name == [(report.stage, report.verdict) for report in g4lidar.doctor(f"file:{path}")]
    assert ("permission", "skipped") in by_name


def test_doctor(g4_simulator: Make) -> None:
    seen = []
    reports = g4lidar.doctor(g4_simulator(), measuring_time=2, on_stage=lambda report: seen.append(report.stage))
    assert seen == [report.stage for report in reports]
    assert [report.verdict for report in reports] == ["ok"] * len(reports)
    answers = next(report for report in reports if report.stage == "answers")
    assert any(name.endswith("_ms") for name in answers.evidence)
    sick = g4lidar.doctor(g4_simulator(faults=["flip*0.003"]), measuring_time=5)
    loss = next(report for report in sick if report.stage == "loss")
    assert loss.verdict in ("warn", "fail")
    assert "bits_flipped" in [diagnosis.name for diagnosis in loss.diagnoses]
    assert loss.diagnoses[0].advice and loss.diagnoses[0].cause


def test_doctor_takes_the_model(g4_simulator: Make) -> None:
    def found(expected: str | None) -> list[str]:
        simulated = g4_simulator(model="x4")
        reports = g4lidar.doctor(simulated, measuring_time=1, model=expected)
        return [each.name for report in reports for each in report.diagnoses]

    assert found(None) == found("x4") == []
    assert found("x2") == ["other_device"]
    with pytest.raises(g4lidar.errors.BadOption):
        g4lidar.doctor(g4_simulator(), model="x44")


def test_doctor_passes_on_what_its_callback_raises(g4_simulator: Make) -> None:
    def refuse(report: g4lidar.StageReport) -> None:
        raise LookupError(report.stage)

    with pytest.raises(LookupError):
        g4lidar.doctor(g4_simulator(), measuring_time=1, on_stage=refuse)


def test_filters_refuse_what_they_would_ignore() -> None:
    points = ring(1000)
    wrong: list[dict[str, object]] = [
        {"least_range_mm": math.nan}, {"greatest_range_mm": math.nan}, {"excluded": 256},
        {"field_of_view": (0, math.nan)}, {"ignored_sectors": [(math.inf, 1)]}, {"masks": [[(0, 0), (1, 1)]]},
        {"masks": [[(0, 0), (1, 1), (math.nan, 2)]]},
    ]
    for options in wrong:
        with pytest.raises(ValueError):
            kept(points, **options)
    with pytest.raises(ValueError):
        g4lidar.mark_isolated(points, near_m=math.nan)


def test_ports() -> None:
    assert all(port.path for port in g4lidar.list_ports())
