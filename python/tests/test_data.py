# SPDX-License-Identifier: MIT
"""Recordings, raw bytes, filters, grids, deskewing, merging, and the doctor."""
import math
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import g4lidar
from g4lidar import PointFlag, errors

Make = Callable[..., g4lidar.Simulator]
Points = npt.NDArray[np.void]


@pytest.fixture
def recorded(g4_simulator: Make, tmp_path: Path) -> tuple[Path, list[g4lidar.Scan]]:
    """A recording, and the scans while it was made."""
    path = tmp_path / "walk.mcap"
    with g4lidar.open(g4_simulator(seed=4), record=path) as lidar:
        lidar.start()
        scans = [scan for scan, _ in zip(lidar.scans(), range(20), strict=False)]
    return path, scans


def test_a_recording_is_a_lidar(recorded: tuple[Path, list[g4lidar.Scan]]) -> None:
    path, scans = recorded
    with g4lidar.open(path) as lidar:
        lidar.start()
        again = list(lidar.scans())
    assert len(again) >= len(scans)
    for live, replayed in zip(scans, again, strict=False):
        assert live.points.tobytes() == replayed.points.tobytes()
    assert again[0].stamp == pytest.approx(os.stat(path).st_mtime, abs=600)
    assert not again[-1].is_piece


def test_begin_and_end_of_a_recording(recorded: tuple[Path, list[g4lidar.Scan]]) -> None:
    path, scans = recorded
    duration = g4lidar.Recording(path).duration
    assert duration is not None and duration == pytest.approx(3.3, abs=0.5)
    with g4lidar.open(path, begin=1, end=2) as lidar:
        lidar.start()
        some = list(lidar.scans())
    assert 5 <= len(some) <= 7


def test_items_of_a_recording(recorded: tuple[Path, list[g4lidar.Scan]]) -> None:
    path, scans = recorded
    recording = g4lidar.Recording(path)
    items = list(recording)
    assert recording.serial_number == "2021101000070073"
    assert not recording.is_damaged and recording.bytes_skipped == 0
    assert items[0].kind == "opened"
    sent = b"".join(item.data for item in items if item.kind == "to_device")
    assert b"\xa5\x60" in sent
    received = b"".join(item.data for item in items if item.kind == "from_device")
    assert len(g4lidar.decode(received)) >= sum(len(scan) for scan in scans)
    times = [item.time_ns for item in items if item.kind == "from_device"]
    assert times == sorted(times)
    recording.seek(2.0)
    later = next(item for item in recording if item.kind == "from_device")
    assert abs(later.time_ns - items[0].time_ns - 2_000_000_000) < 100_000_000
    recording.seek(0)
    assert next(recording).time_ns == items[0].time_ns


def test_a_written_recording_can_be_read(recorded: tuple[Path, list[g4lidar.Scan]], tmp_path: Path) -> None:
    path, scans = recorded
    copy = tmp_path / "copy.mcap"
    with g4lidar.RecordingWriter(copy) as writer:
        for item in g4lidar.Recording(path):
            if item.kind == "from_device":
                writer.from_device(item.data, item.time_ns)
            elif item.kind == "to_device":
                writer.to_device(item.data, item.time_ns)
        writer.scan(scans[0])
        writer.odometry(scans[0].time_ns, 1.0, 2.0, 0.5)
    poses = [item.pose for item in g4lidar.Recording(copy) if item.kind == "odometry"]
    assert poses == [(1.0, 2.0, 0.5)]
    with pytest.raises(errors.System, match="EEXIST"):
        g4lidar.RecordingWriter(copy)
    with pytest.raises(errors.BadFile):
        g4lidar.Recording(__file__)


def test_decode_gives_the_points_of_the_lidar(recorded: tuple[Path, list[g4lidar.Scan]]) -> None:
    path, scans = recorded
    data = b"".join(item.data for item in g4lidar.Recording(path) if item.kind == "from_device")
    whole = g4lidar.decode(data)
    wanted = np.concatenate([scan.points for scan in scans])
    first = int(np.flatnonzero(whole["revolution"] == wanted["revolution"][0])[0])
    found = whole[first : first + len(wanted)]
    assert (found["range_mm"] == wanted["range_mm"]).all()
    assert np.abs(found["angle_deg"] - wanted["angle_deg"]).max() < 1e-4
    # In pieces, and into memory of the caller.
    decoder = g4lidar.Decoder()
    out = np.zeros(2000, g4lidar.POINT_DTYPE)
    pieces = []
    for begin in range(0, len(data), 997):
        view = decoder.decode(memoryview(data)[begin : begin + 997], out)
        assert np.shares_memory(view, out) or len(view) == 0
        pieces.append(view.copy())
    pieces.append(decoder.finish())
    assert (np.concatenate(pieces) == whole).all()
    counts = decoder.counts()
    assert sum(v for k, v in counts.items() if k.startswith("skipped")) + counts["parsed_bytes"] == len(data)
    with pytest.raises(ValueError, match="short"):
        decoder.decode(data, np.zeros(10, g4lidar.POINT_DTYPE))
    frozen = np.zeros(100_000, g4lidar.POINT_DTYPE)
    frozen.flags.writeable = False
    with pytest.raises((BufferError, ValueError)):
        decoder.decode(b"", frozen)


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


def test_filters() -> None:
    points = ring(1000, 360)
    points["range_mm"][:10] = 5000
    assert len(g4lidar.filter_points(points, greatest_range_mm=2000)) == 350
    assert len(g4lidar.filter_points(points, field_of_view=(-90, 90))) == 181
    assert len(g4lidar.filter_points(points, field_of_view=(0, 90), frame="vendor")) == 91
    assert len(g4lidar.filter_points(points, ignored_sectors=[(350, 10)], frame="vendor")) == 339
    ahead = [(0.5, -0.2), (1.5, -0.2), (1.5, 0.2), (0.5, 0.2)]
    left = g4lidar.filter_points(points, masks=[ahead])
    assert 360 - len(left) == 23  # within asin(0.2) of straight ahead
    assert len(g4lidar.filter_points(points, masks=[ahead], for_grid=True)) == 360
    points["flags"][5] = PointFlag.ISOLATED
    assert len(g4lidar.filter_points(points, excluded=PointFlag.ISOLATED)) == 359


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


def test_twist_from_scans(g4_simulator: Make, tmp_path: Path) -> None:
    way = tmp_path / "way.txt"
    way.write_text("drive wait 2\ndrive forward 2 0.5\n")
    estimator = g4lidar.TwistEstimator()
    known = []
    with g4lidar.open(g4_simulator(path=str(way))) as lidar:
        lidar.start(frequency_hz=10)
        for scan in lidar.scans():
            estimate = estimator.add(scan.points)
            if estimate.is_known and 3_200_000_000 < scan.time_ns < 5_000_000_000:
                known.append(math.hypot(estimate.twist.x_m_per_s, estimate.twist.y_m_per_s))
            if scan.time_ns > 5_500_000_000:
                break
    assert len(known) > 5
    assert abs(float(np.median(known)) - 0.5) < 0.1


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


def test_doctor_passes_on_what_its_callback_raises(g4_simulator: Make) -> None:
    def refuse(report: g4lidar.StageReport) -> None:
        raise LookupError(report.stage)

    with pytest.raises(LookupError):
        g4lidar.doctor(g4_simulator(), measuring_time=1, on_stage=refuse)


def test_raw_bytes_of_a_file(g4_simulator: Make, recorded: tuple[Path, list[g4lidar.Scan]], tmp_path: Path) -> None:
    path, scans = recorded
    raw = tmp_path / "walk.bin"
    raw.write_bytes(b"".join(item.data for item in g4lidar.Recording(path) if item.kind == "from_device"))
    with g4lidar.open(raw) as lidar:
        lidar.start()
        again = list(lidar.scans())
    assert len(again) >= len(scans)
    assert 0 < again[0].stamp - os.stat(raw).st_mtime < 10


def test_ports() -> None:
    assert all(port.path for port in g4lidar.list_ports())
