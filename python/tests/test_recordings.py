# SPDX-License-Identifier: MIT
"""Recordings and raw bytes: played, read, written, decoded."""
import math
import os
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import PATIENCE, start_program

import g4lidar
from g4lidar import errors

Make = Callable[..., g4lidar.Simulator]


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


def begin_of(path: Path) -> int:
    return next(item.time_ns for item in g4lidar.Recording(path) if item.kind == "opened")


def player_of(lidar: g4lidar.Lidar) -> g4lidar.Player:
    assert lidar.player is not None
    return lidar.player


def test_seek_in_an_open_recording(recorded: tuple[Path, list[g4lidar.Scan]]) -> None:
    path, scans = recorded
    with g4lidar.open(path, end=3) as lidar:
        player = player_of(lidar)
        player.seek(2)
        assert player.position == pytest.approx(2)
        with pytest.raises(errors.NotScanning):
            lidar.try_scan()
        lidar.start()
        with g4lidar.open(path, begin=2, end=3) as other:
            other.start()
            wanted = [scan.points.tobytes() for scan in other.scans()]
        assert [scan.points.tobytes() for scan in lidar.scans()] == wanted
        for seconds in (2.5, 0.0, 1.5):  # after the end, back, and ahead
            player.seek(seconds)
            found = lidar.try_scan()
            assert 0 <= found.time_ns - begin_of(path) - seconds * 1e9 < 0.8e9
        player.seek(0)
        # In a loop.
        times = []
        for scan in lidar.scans():
            times.append(scan.time_ns)
            if len(times) == 2:
                player.seek(2)
        assert times[0] < times[1] < begin_of(path) + 2_000_000_000 <= times[2] and len(times) == 2 + len(wanted)
        for wrong in (-1.0, math.nan):
            with pytest.raises(ValueError):
                player.seek(wrong)
        player.seek(1e6)  # the end
        with pytest.raises(errors.EndOfInput):
            lidar.try_scan()
    assert lidar.player is None
    with pytest.raises(errors.Gone):
        player.seek(0)


def test_seek_wakes_another_thread(recorded: tuple[Path, list[g4lidar.Scan]]) -> None:
    path, scans = recorded
    with g4lidar.open(path, speed=1e-6) as lidar:  # the next scan comes in hours
        lidar.start()
        found: list[int] = []
        waiting = threading.Thread(target=lambda: found.extend(len(scan) for scan in lidar.scans(timeout=None)))
        waiting.start()
        time.sleep(0.2)
        player_of(lidar).seek(60)
        waiting.join(PATIENCE)
        assert not waiting.is_alive()


def test_pause_and_speed_from_another_thread(recorded: tuple[Path, list[g4lidar.Scan]]) -> None:
    path, scans = recorded
    with g4lidar.open(path, speed=1e-6) as lidar:
        player = player_of(lidar)
        lidar.start()
        player.pause()
        assert player.is_paused and player.speed == 1e-6
        found: list[int] = []
        waiting = threading.Thread(target=lambda: found.extend(len(scan) for scan in lidar.scans(timeout=0.3)))
        waiting.start()
        waiting.join(1)
        assert waiting.is_alive() and not found and player.position < 0.001  # a pause is no timeout
        player.speed = 1000
        player.pause(False)
        waiting.join(PATIENCE)
        assert not waiting.is_alive() and len(found) >= len(scans) and not player.is_paused
        assert player.position == pytest.approx(player.length) and player.length == pytest.approx(3.3, abs=0.5)
        with pytest.raises(errors.BadOption):
            player.speed = 1e9


def test_a_loop_that_is_set_and_ended(recorded: tuple[Path, list[g4lidar.Scan]]) -> None:
    path, scans = recorded
    with g4lidar.open(path) as lidar:
        player = player_of(lidar)
        player.set_loop(True)
        lidar.start()
        stamps = []
        for scan in lidar.scans():
            stamps.append(scan.stamp)
            if len(stamps) == 2 * len(scans) + 2:
                player.set_loop(False)
        assert stamps == sorted(stamps) and len(stamps) >= 2 * len(scans) + 2


def test_raw_bytes_are_played(recorded: tuple[Path, list[g4lidar.Scan]], raw: Path) -> None:
    path, scans = recorded
    with g4lidar.open(raw, begin=1, end=2) as lidar:
        lidar.start()
        some = list(lidar.scans())
        assert 5 <= len(some) <= 7
        assert 0 < some[0].stamp - os.stat(raw).st_mtime < 10
        assert player_of(lidar).length == pytest.approx(3.0, abs=0.5)  # without the time before the scan


@pytest.fixture
def raw(recorded: tuple[Path, list[g4lidar.Scan]], tmp_path: Path) -> Path:
    """The bytes of the recording."""
    made = tmp_path / "raw.bin"
    items = g4lidar.Recording(recorded[0])
    made.write_bytes(b"".join(item.data for item in items if item.kind == "from_device"))
    return made


def test_what_is_no_file_refuses_what_is_for_files(
    g4_simulator: Make, recorded: tuple[Path, list[g4lidar.Scan]], tmp_path: Path
) -> None:
    for device in (g4_simulator(), "sim:", "/dev/ttyUSB99"):
        wrong: list[dict[str, Any]] = [{"begin": 1.0}, {"end": 1.0}, {"speed": 1.0}, {"loop": True}]
        for options in wrong:
            with pytest.raises(errors.BadOption, match="source cannot use this option"):
                g4lidar.open(device, **options)
            with pytest.raises(errors.BadOption, match="source cannot use this option"):
                g4lidar.open(device, record=tmp_path / "never.mcap", **options)
            assert not (tmp_path / "never.mcap").exists()
    for_lidars: list[dict[str, Any]] = [{"reconnect": True}, {"baud": 115200}, {"frequency_hz": 10.0}, {"stall_time": 0.5}]
    for options in for_lidars:
        with pytest.raises(errors.BadOption, match="is a recording"):
            g4lidar.open(recorded[0], **options)
    with g4lidar.open(g4_simulator()) as lidar:
        assert lidar.player is None
    with g4lidar.open(recorded[0], record=tmp_path / "again.mcap") as lidar:  # its times do not go back
        with pytest.raises(errors.BadOption, match="seek"):
            player_of(lidar).seek(0)


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


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -2e6])
@pytest.mark.parametrize("place", range(6))
def test_a_writer_refuses_impossible_odometry(tmp_path: Path, wrong: float, place: int) -> None:
    numbers = [0.0] * 6
    numbers[place] = wrong
    with g4lidar.RecordingWriter(tmp_path / "a.mcap") as writer:
        with pytest.raises(ValueError, match="first bytes"):
            writer.odometry(1, 0, 0, 0)
        writer.from_device(b"first", 1)
        with pytest.raises(ValueError, match="finite"):
            writer.odometry(2, numbers[0], numbers[1], numbers[2], g4lidar.Twist(*numbers[3:]))
        writer.odometry(3, 1.0, 2.0, 3.0)
    assert [item.pose for item in g4lidar.Recording(tmp_path / "a.mcap") if item.pose] == [(1.0, 2.0, 3.0)]


def test_a_closed_writer_refuses_more(tmp_path: Path, g4_lidar: g4lidar.Lidar) -> None:
    g4_lidar.start()
    scan = g4_lidar.try_scan()
    writer = g4lidar.RecordingWriter(tmp_path / "a.mcap")
    writer.from_device(b"first", 1)
    writer.close()
    writer.close()
    calls: list[Callable[[], None]] = [
        lambda: writer.from_device(b"more", 2), lambda: writer.to_device(b"more", 2), lambda: writer.scan(scan),
        lambda: writer.odometry(2, 0, 0, 0), lambda: writer.set_wall_clock(0), writer.flush,
    ]
    for call in calls:
        with pytest.raises(ValueError, match="closed"):
            call()


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


def test_time_packets_are_counted() -> None:
    decoder = g4lidar.Decoder()
    assert len(decoder.decode(bytes.fromhex("AA6627E803000000" "00"))) == 0
    counts = decoder.counts()
    assert counts["time_packets"] == 1
    assert counts["parsed_bytes"] == 8
    assert counts["skipped_noise"] == 1
    assert counts["crc_matches"] == counts["crc_mismatches"] == 0


READING = {
    "Recording": "list(g4lidar.Recording(path))",
    "open": "g4lidar.open(path)",
}


@pytest.mark.parametrize("how", READING)
def test_a_signal_ends_the_reading_of_a_file(tmp_path: Path, how: str) -> None:
    path = tmp_path / "slow.mcap"
    path.write_bytes(b"\x89MCAP0\r\n")
    os.truncate(path, 1 << 40)  # zeros, in which chunks are searched for minutes; they take no place
    program = start_program(f"""
        print("ready", flush=True)
        path = {str(path)!r}
        {READING[how]}
    """)
    assert program.stdout is not None and program.stdout.readline() == "ready\n"
    counts = Path(f"/proc/{program.pid}/io")

    def bytes_read() -> int:
        return int(counts.read_text().split()[1])

    begin = bytes_read()
    end = time.monotonic() + PATIENCE
    while program.poll() is None and bytes_read() - begin < 64 << 20:
        assert time.monotonic() < end
        time.sleep(0.01)
    program.send_signal(signal.SIGINT)
    _, err = program.communicate(timeout=PATIENCE)
    assert err.splitlines()[-1] == "KeyboardInterrupt"
