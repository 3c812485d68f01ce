# SPDX-License-Identifier: MIT
"""Code in Python that runs within a call: handlers of signals, finalizers. And signals that end calls."""
import os
import pty
import signal
import socket
import time
import tty
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import PATIENCE, start_program, takes_less

import g4lidar

Make = Callable[..., g4lidar.Simulator]


def test_a_handler_uses_the_lidar_whose_call_it_interrupts() -> None:
    # Errors are made by code in Python, before which handlers run.
    program = start_program("""
        import signal, time
        lidar = g4lidar.open("sim:?silence_ns=60s", stall_time=60)
        lidar.start()
        seen = []
        signal.signal(signal.SIGALRM, lambda *_: seen.append(lidar.counts()["bytes"]))
        signal.setitimer(signal.ITIMER_REAL, 0.01, 0.0011)
        end = time.monotonic() + 4
        while time.monotonic() < end:
            try:
                lidar.try_scan(0.0)
            except g4lidar.errors.Timeout:
                pass
        signal.setitimer(signal.ITIMER_REAL, 0)
        print(len(seen) > 20)
    """)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "True\n", err


@pytest.mark.parametrize("inner", ["close", "stop", "counts", "try_scan", "player", "release", "events", "fileno"])
def test_a_handler_calls_anything_during_anything(inner: str) -> None:
    program = start_program("""
        import signal, time
        lidar = g4lidar.open("sim:?silence_ns=60s", stall_time=60)
        calls = {"try_scan": lambda: lidar.try_scan(0.01), "player": lambda: lidar.player}
        inner = calls.get(sys.argv[1]) or getattr(lidar, sys.argv[1])
        handled = []
        def handle(*_):
            try:
                inner()
            except (g4lidar.Error, RuntimeError):
                pass
            handled.append(1)
        signal.signal(signal.SIGALRM, handle)
        for outer in (lidar.start, lambda: lidar.try_scan(1), lidar.stop, lidar.counts, lidar.start, lidar.close):
            signal.setitimer(signal.ITIMER_REAL, 0.01, 0.1)
            try:
                outer()
            except (g4lidar.Error, RuntimeError):
                pass
            signal.setitimer(signal.ITIMER_REAL, 0)
        print("ended", len(handled) > 0)
    """, inner)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "ended True\n", err


def test_the_collector_frees_another_lidar_of_the_same_simulator() -> None:
    program = start_program("""
        import gc
        class Cycle:
            pass
        simulated = g4lidar.Simulator()
        gc.set_threshold(1, 1, 1)
        with g4lidar.open(simulated) as lidar:
            lidar.start()
            for _ in range(50):
                cycle = Cycle()
                cycle.me = cycle
                cycle.lidar = g4lidar.open(simulated)
                del cycle
                try:
                    lidar.start()
                    lidar.try_scan(0.0)
                except g4lidar.Error:
                    pass
        print("ended")
    """)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "ended\n", err


def test_interrupt_ends_close(g4_simulator: Make) -> None:
    def longest() -> float:
        # An interrupted start() is completed first, which takes some times answer_time.
        program = start_program("""
            lidar = g4lidar.open(sys.argv[1], answer_time=10)
            for name, call in (("start", lidar.start), ("close", lidar.close)):
                try:
                    print(name, flush=True)
                    call()
                except KeyboardInterrupt:
                    print("interrupted", flush=True)
            lidar.release()
            lidar.close()
        """, g4_simulator(virtual_time=False, header_ns="60s").path)
        assert program.stdout is not None
        times = []
        for name in ("start", "close"):
            assert program.stdout.readline() == f"{name}\n"
            time.sleep(0.3)
            begin = time.monotonic()
            program.send_signal(signal.SIGINT)
            assert program.stdout.readline() == "interrupted\n"
            times.append(time.monotonic() - begin)
        _, err = program.communicate(timeout=PATIENCE)
        assert program.returncode == 0, err
        return max(times)

    assert takes_less(4, longest)  # else 5.5 s


def interrupted_after(call: str, port: str) -> float:
    """How long a program that calls this of a silent port runs after SIGINT."""
    program = start_program(f"""
        try:
            print("calls", flush=True)
            {call}
        except KeyboardInterrupt:
            print("interrupted", flush=True)
    """, port)
    assert program.stdout is not None
    assert program.stdout.readline() == "calls\n"
    time.sleep(0.3)
    begin = time.monotonic()
    program.send_signal(signal.SIGINT)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "interrupted\n", err
    return time.monotonic() - begin


def test_interrupt_ends_open() -> None:
    ends = pty.openpty()
    tty.setraw(ends[1])
    assert takes_less(5, lambda: interrupted_after("g4lidar.open(sys.argv[1], answer_time=5)", os.ttyname(ends[1])))


def test_interrupt_ends_find_lidars(g4_simulator: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("G4LIDAR_SIM_DIR", str(tmp_path))
    for number in range(5):  # 2.5 s each
        silent = g4_simulator(virtual_time=False, faults=["deaf"])
        (tmp_path / f"silent{number}").symlink_to(os.path.realpath(silent.path))
    assert len([port for port in g4lidar.list_ports() if port.driver == "sim"]) == 5
    assert takes_less(5, lambda: interrupted_after("g4lidar.find_lidars()", ""))


@pytest.mark.parametrize("device", ["", "serial:2021101000070079"])
def test_interrupt_ends_open_of_several_ports(
    g4_simulator: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, device: str
) -> None:
    monkeypatch.setenv("G4LIDAR_SIM_DIR", str(tmp_path))
    for number in range(5):
        silent = g4_simulator(virtual_time=False, faults=["deaf"])
        (tmp_path / f"silent{number}").symlink_to(os.path.realpath(silent.path))
    assert takes_less(5, lambda: interrupted_after("g4lidar.open(sys.argv[1])", device))


def test_interrupt_ends_open_of_a_network_address() -> None:
    with socket.socket() as deaf:
        deaf.bind(("127.0.0.1", 0))
        deaf.listen(0)
        port = deaf.getsockname()[1]
        # The queue of the system is full after two connections: it answers no more.
        held = [socket.socket() for _ in range(4)]
        for each in held:
            each.setblocking(False)
            each.connect_ex(("127.0.0.1", port))
        address = f"tcp:127.0.0.1:{port}"
        assert takes_less(2, lambda: interrupted_after("g4lidar.open(sys.argv[1])", address))  # else 3 s
        for each in held:
            each.close()


# An attribute alone does not do: see test_ends.py.
@pytest.mark.parametrize("call", ["getattr(simulated, 'now_ns')", "g4lidar.open(simulated)"])
def test_interrupt_ends_a_wait_for_another_thread(call: str) -> None:
    # In virtual time a year of attempts to reconnect every millisecond takes hours.
    program = start_program(f"""
        import threading
        simulated = g4lidar.Simulator(faults=["unplug@3s"])
        lidar = g4lidar.open(simulated, reconnect=True, longest_backoff=0.001)
        lidar.start()
        begun = threading.Event()
        def wait():
            begun.set()
            try:
                for scan in lidar.scans(timeout=None):
                    pass
            except g4lidar.Error:
                pass
        thread = threading.Thread(target=wait)
        thread.start()
        begun.wait()
        print("calls", flush=True)
        try:
            while True:
                try:
                    {call}
                except g4lidar.Error:  # it is lost
                    pass
        except KeyboardInterrupt:
            print("interrupted", flush=True)
        lidar.close()
        thread.join()
    """)
    assert program.stdout is not None
    assert program.stdout.readline() == "calls\n"
    time.sleep(0.3)
    program.send_signal(signal.SIGINT)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "interrupted\n", err


def test_a_port_can_be_opened_after_an_interrupt(g4_simulator: Make) -> None:
    program = start_program("""
        import signal
        is_attempt = False
        def interrupt(*_):
            if is_attempt:  # not later, where nothing would catch it
                raise LookupError
        signal.signal(signal.SIGALRM, interrupt)
        def attempt(seconds):
            global is_attempt
            try:
                is_attempt = True
                signal.setitimer(signal.ITIMER_REAL, seconds)
                g4lidar.open(sys.argv[1]).close()
            finally:
                is_attempt = False
                signal.setitimer(signal.ITIMER_REAL, 0)
        for number in range(40):
            try:
                attempt(0.002 * (number % 20) + 0.001)
            except (LookupError, g4lidar.errors.Busy):  # busy: what was begun has not ended yet
                pass
        import time
        end = time.monotonic() + 30
        while time.monotonic() < end:
            try:
                with g4lidar.open(sys.argv[1]) as lidar:
                    lidar.start()
                    print(len(lidar.try_scan(20)) > 100)
                break
            except g4lidar.errors.Busy:
                time.sleep(0.05)
    """, g4_simulator(virtual_time=False).path)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "True\n", err


def test_a_handler_that_does_not_raise_leaves_open_alone(g4_simulator: Make) -> None:
    program = start_program("""
        import signal
        seen = []
        signal.signal(signal.SIGALRM, lambda *_: seen.append(True))
        signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)
        for _ in range(5):
            g4lidar.open(sys.argv[1]).close()
        signal.setitimer(signal.ITIMER_REAL, 0)
        print(len(seen) > 5)
    """, g4_simulator(virtual_time=False).path)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "True\n", err


@pytest.mark.parametrize("inner", ["stop", "counts", "next_scan", "events", "rest", "pause", "set_speed", "seek", "state"])
def test_a_handler_calls_anything_of_a_reader_during_anything(inner: str) -> None:
    program = start_program("""
        import signal
        reader = g4lidar.open("sim:?silence_ns=60s", stall_time=60).background()
        calls = {"next_scan": lambda: reader.next_scan(0.01), "set_speed": lambda: reader.set_speed(2),
                 "seek": lambda: reader.seek(0), "state": lambda: reader.state}
        inner = calls.get(sys.argv[1]) or getattr(reader, sys.argv[1])
        handled = []
        def handle(*_):
            try:
                inner()
            except g4lidar.Error:
                pass
            handled.append(1)
        signal.signal(signal.SIGALRM, handle)
        for outer in (lambda: reader.next_scan(1), reader.counts, reader.rest, lambda: reader.rest(False), reader.events,
                      lambda: reader.next_scan(0.1), reader.stop):
            signal.setitimer(signal.ITIMER_REAL, 0.01, 0.1)
            try:
                outer()
            except g4lidar.Error:
                pass
            signal.setitimer(signal.ITIMER_REAL, 0)
        print("ended", len(handled) > 0)
    """, inner)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "ended True\n", err
