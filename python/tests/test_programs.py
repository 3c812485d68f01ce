# SPDX-License-Identifier: MIT
"""Threads, signals, fork, sub-interpreters, asyncio and the end of a program."""
import asyncio
import signal
import sys
import threading
import time
from collections.abc import Callable

import pytest
from conftest import PATIENCE, start_program, takes_less

import g4lidar
from g4lidar import errors

Make = Callable[..., g4lidar.Simulator]


def await_true(condition: Callable[[], bool], seconds: float = PATIENCE) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.01)
    return False


def test_waiting_releases_the_gil(g4_simulator: Make) -> None:
    with g4lidar.open(g4_simulator(virtual_time=False, silence_ns="1s")) as lidar:
        lidar.start()
        turns = 0

        def count() -> None:
            nonlocal turns
            while not done.is_set():
                turns += 1
                time.sleep(0.001)

        done = threading.Event()
        other = threading.Thread(target=count)
        other.start()
        lidar.try_scan(20)
        done.set()
        other.join()
    assert turns > 20


def test_threads_read_different_lidars(g4_simulator: Make) -> None:
    found: list[set[str]] = [set(), set(), set()]

    def read(index: int) -> None:
        simulated = g4_simulator(serial=f"{index + 1:016d}", seed=index, virtual_time=index > 0)
        with g4lidar.open(simulated) as lidar:
            lidar.start()
            for scan, _ in zip(lidar.scans(timeout=10), range(6), strict=False):
                assert scan.points["revolution"].max() - scan.points["revolution"].min() <= 1
                found[index].add(lidar.information.serial_number)

    threads = [threading.Thread(target=read, args=(index,)) for index in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [{f"{index + 1:016d}"} for index in range(3)]


def test_threads_share_a_lidar(g4_simulator: Make) -> None:
    with g4lidar.open(g4_simulator(virtual_time=False)) as lidar:
        lidar.start(frequency_hz=12)
        revolutions: list[int] = []

        def read() -> None:
            for _ in range(5):
                revolutions.append(lidar.try_scan(20).revolution)

        threads = [threading.Thread(target=read) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert len(set(revolutions)) == 15


def test_close_and_wake_end_a_wait_of_another_thread(g4_simulator: Make) -> None:
    with g4lidar.open(g4_simulator(virtual_time=False, silence_ns="60s"), stall_time=60) as lidar:
        lidar.start()
        ends: list[str] = []

        def wait() -> None:
            try:
                lidar.try_scan(1000)
            except errors.Cancelled:
                ends.append("cancelled")
            ends.append(f"{len(list(lidar.scans(timeout=None)))} scans")

        thread = threading.Thread(target=wait)
        thread.start()
        time.sleep(0.2)
        lidar.wake()
        assert await_true(lambda: ends == ["cancelled"])
        lidar.close()
        thread.join(PATIENCE)
        assert ends == ["cancelled", "0 scans"]


WAITING = """
    with g4lidar.open(sys.argv[1], stall_time=60) as lidar:
        lidar.start()
        try:
            print("waits", flush=True)
            lidar.try_scan(1000)
        except KeyboardInterrupt:
            print("interrupted", flush=True)
            raise
"""


def test_interrupt_ends_a_wait_and_stops_the_lidar(g4_simulator: Make) -> None:
    simulated = g4_simulator(virtual_time=False, silence_ns="60s")
    program = start_program(WAITING, simulated.path)
    assert program.stdout is not None
    assert program.stdout.readline() == "waits\n"
    time.sleep(0.3)
    assert simulated.is_scanning
    program.send_signal(signal.SIGINT)  # else it waits for 1000 s
    assert program.stdout.readline() == "interrupted\n"
    out, err = program.communicate(timeout=PATIENCE)
    assert program.returncode == -signal.SIGINT and "KeyboardInterrupt" in err
    assert await_true(lambda: not simulated.is_scanning)


def test_interrupt_ends_start(g4_simulator: Make) -> None:
    def time_to_the_end() -> float:
        program = start_program("""
            lidar = g4lidar.open(sys.argv[1], answer_time=10)
            try:
                print("starts", flush=True)
                lidar.start()
            except KeyboardInterrupt:
                print("interrupted", flush=True)
                lidar.release()
        """, g4_simulator(virtual_time=False, header_ns="60s").path)
        assert program.stdout is not None
        assert program.stdout.readline() == "starts\n"
        time.sleep(0.3)
        begin = time.monotonic()
        program.send_signal(signal.SIGINT)
        assert program.stdout.readline() == "interrupted\n"
        took = time.monotonic() - begin
        program.communicate(timeout=PATIENCE)
        return took

    assert takes_less(5, time_to_the_end)


def test_handler_that_does_not_raise_continues_the_wait(g4_simulator: Make) -> None:
    simulated = g4_simulator(virtual_time=False, silence_ns="1s")
    program = start_program("""
        import signal
        signal.signal(signal.SIGINT, lambda *_: print("handled", flush=True))
        with g4lidar.open(sys.argv[1], stall_time=60) as lidar:
            lidar.start()
            print("waits", flush=True)
            print(len(lidar.try_scan(1000)) > 100, len(lidar.try_scan(1000)) > 100, flush=True)
    """, simulated.path)
    assert program.stdout is not None
    assert program.stdout.readline() == "waits\n"
    time.sleep(0.1)
    program.send_signal(signal.SIGINT)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "handled\nTrue True\n", err


def test_the_end_of_a_program_stops_the_lidar(g4_simulator: Make) -> None:
    simulated = g4_simulator(virtual_time=False)
    program = start_program("""
        kept = g4lidar.open(sys.argv[1])
        kept.start()
        kept.try_scan(20)
        sys.own = kept
        raise SystemExit(3)
    """, simulated.path)
    _, err = program.communicate(timeout=PATIENCE)
    assert program.returncode == 3, err
    assert any(code == 0x60 for _, code, _ in simulated.commands())
    assert await_true(lambda: not simulated.is_scanning)


def test_a_child_after_fork_leaves_the_lidar_alone(g4_simulator: Make) -> None:
    simulated = g4_simulator(virtual_time=False)
    program = start_program("""
        import os
        lidar = g4lidar.open(sys.argv[1])
        lidar.start()
        lidar.try_scan(20)
        child = os.fork()
        if child == 0:
            for call in (lidar.try_scan, lidar.stop, lidar.close, lidar.counts):
                try:
                    call()
                except RuntimeError as refused:
                    assert "fork" in str(refused), refused
            del lidar
            sys.exit(7)  # with all destructors
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
        print(lidar.is_scanning, len(lidar.try_scan(20)) > 100, len(lidar.try_scan(20)) > 100)
    """, simulated.path)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "7\nTrue True True\n", err
    stops = [code for _, code, _ in simulated.commands() if code == 0x65]
    assert len(stops) <= 3  # at open, and at the end of the parent


@pytest.mark.skipif(sys.version_info >= (3, 14), reason="another module for sub-interpreters")
def test_a_subinterpreter_is_refused() -> None:
    program = start_program("""
        try:
            import _xxsubinterpreters as interpreters
        except ImportError:
            import _interpreters as interpreters
        inner = interpreters.create()
        text = '''
        try:
            import g4lidar
        except ImportError as refused:
            print("refused", flush=True)
        '''
        import textwrap
        text = textwrap.dedent(text)
        (interpreters.run_string if hasattr(interpreters, "run_string") else interpreters.exec)(inner, text)
    """)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "refused\n", err


def test_async_timeout(g4_simulator: Make) -> None:
    async def read() -> None:
        with g4lidar.open(g4_simulator(virtual_time=False, faults=["stall@1.5s"]), stall_time=60) as lidar:
            lidar.start()
            with pytest.raises(errors.Timeout):
                async for _ in lidar.scans_async(timeout=0.3):
                    pass

    asyncio.run(read())


def test_a_lidar_in_a_loop_of_ones_own(g4_simulator: Make) -> None:
    import select

    with g4lidar.open(g4_simulator(virtual_time=False)) as lidar:
        lidar.start()
        count = 0
        waits = 0
        while count < 5:
            scan = lidar.poll_scan()
            if scan is not None:
                count += 1
                continue
            deadline = lidar.next_deadline()
            left = 60.0 if deadline is None else max(0.0, deadline - time.monotonic())
            select.select([lidar], [], [], left)
            waits += 1
        assert waits < 2000
