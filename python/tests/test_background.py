# SPDX-License-Identifier: MIT
"""Lidars that a thread of the library reads."""
import os
import threading
import time
from pathlib import Path

import pytest
from conftest import PATIENCE, start_program

import g4lidar


def wait_for(reader: g4lidar.BackgroundReader, state: str) -> None:
    end = time.monotonic() + PATIENCE
    while reader.state != state and time.monotonic() < end:
        time.sleep(0.01)
    assert reader.state == state


@pytest.fixture
def recorded(tmp_path: Path) -> str:
    """Four seconds."""
    path = str(tmp_path / "walk.mcap")
    with g4lidar.open(g4lidar.Simulator(), record=path) as lidar:
        lidar.start()
        first = lidar.try_scan(PATIENCE)
        while lidar.try_scan(PATIENCE).time_ns - first.time_ns < 4e9:
            pass
    return path


def test_the_program_need_not_call_it() -> None:
    lidar = g4lidar.open("sim:?seed=7")
    with lidar.background(newest=True) as reader:
        with pytest.raises(g4lidar.errors.Gone):
            lidar.start()
        end = time.monotonic() + PATIENCE
        while reader.counts()["scans_missed"] < 3 and time.monotonic() < end:
            time.sleep(0.01)
        scan = reader.next_scan(PATIENCE)
        assert scan.revolution >= 3
        assert len(scan.points) > 100
        assert abs(scan.stamp - time.time()) < PATIENCE
        reader.rest()
        wait_for(reader, "resting")
    assert list(reader) == []  # stopped


def test_a_file_is_controlled(recorded: str) -> None:
    lidar = g4lidar.open(recorded)
    player = lidar.player
    assert player is not None
    player.pause()
    with lidar.background() as reader:
        with pytest.raises(g4lidar.errors.Timeout):
            reader.next_scan(0.02)
        reader.seek(2.0)  # gives one scan
        late = reader.next_scan(PATIENCE)
        with pytest.raises(g4lidar.errors.BadOption):
            reader.set_speed(-1.0)
        reader.set_speed(20.0)
        reader.seek(0.0)
        early = reader.next_scan(PATIENCE)
        assert 1.5e9 < late.time_ns - early.time_ns < 2.5e9
        assert late.stamp - early.stamp == pytest.approx((late.time_ns - early.time_ns) * 1e-9, abs=1e-3)
        reader.pause(False)
        scans = list(reader)
        assert len(scans) > 10
        wait_for(reader, "ended")


def test_what_has_another_clock_or_owner_is_refused(tmp_path: Path) -> None:
    for lidar in (g4lidar.open(g4lidar.Simulator()), g4lidar.open("sim:", record=tmp_path / "walk.mcap")):
        with lidar, pytest.raises(g4lidar.errors.BadOption):
            lidar.background()


def test_stop_of_another_thread_ends_the_loop() -> None:
    reader = g4lidar.open("sim:").background()
    reader.rest()
    stopping = threading.Timer(0.2, reader.stop)
    stopping.start()
    for _ in reader:
        pass
    stopping.join(PATIENCE)


def test_a_signal_ends_the_wait_and_the_end_of_the_program_stops_it() -> None:
    program = start_program("""
        import os, signal, threading
        reader = g4lidar.open("sim:").background()
        reader.rest()
        def raises(*_):
            raise KeyError
        signal.signal(signal.SIGALRM, raises)
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        try:
            for _ in reader:
                pass
        except KeyError:
            print("raised")
    """)
    out, err = program.communicate(timeout=PATIENCE)
    assert (program.returncode, out, err) == (0, "raised\n", "")


def test_it_belongs_to_the_process() -> None:
    reader = g4lidar.open("sim:").background()
    child = os.fork()
    if child == 0:
        try:
            reader.next_scan(0.0)
        except RuntimeError:
            os._exit(7)
        os._exit(8)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
    assert len(reader.next_scan(PATIENCE).points) > 0
    reader.stop()
