# SPDX-License-Identifier: MIT
"""The end of a program: with threads that still run, with lidars that others destroy, in any order."""
import signal
import sys

import pytest
from conftest import PATIENCE, start_program

# In 3.10 a loop over `try` that calls nothing, as of an attribute alone, lets no other thread or handler run.
RUNNING = {
    "try_scan": "real.try_scan(1000)",
    "virtual_scan": "lidar.try_scan(1)",
    "simulator": "getattr(simulated, 'now_ns')",
    "decode": "g4lidar.decode(zeros)",
    "open": "g4lidar.open(simulated).close()",
    "doctor": "g4lidar.doctor(simulated, measuring_time=1, on_stage=lambda _: sum(range(1000)))",
    "error": "g4lidar.open('', model='none')",
    "path": "g4lidar.open(pathlib.Path('/none'), listen_only=True)",
    "list_ports": "g4lidar.find_lidars()",
}


# Python 3.10 itself can end with SIGSEGV while daemon threads run, also without g4lidar: one of six runs must end well.
RUNS = 1 if sys.version_info >= (3, 11) else 6


@pytest.mark.parametrize("call", RUNNING)
def test_threads_that_still_run(call: str) -> None:
    text = f"""
        import pathlib, threading, time
        zeros = bytes(3_000_000)
        simulated = g4lidar.Simulator()
        lidar = g4lidar.open(simulated)
        lidar.start()
        real = g4lidar.open("sim:")
        real.start()
        begun = threading.Semaphore(0)
        def use():
            begun.release()
            while True:
                try:
                    {RUNNING[call]}
                except g4lidar.Error:
                    pass
        for _ in range(3):
            threading.Thread(target=use, daemon=True).start()
        for _ in range(3):
            begun.acquire()
        time.sleep(0.1)
    """
    for _ in range(RUNS):
        program = start_program(text)
        _, err = program.communicate(timeout=PATIENCE)
        if program.returncode != -signal.SIGSEGV:
            break
    assert (program.returncode, err) == (0, "")


def test_lidars_are_destroyed_while_all_are_closed() -> None:
    # While the first one is closed, which takes time, a thread destroys the others and makes new ones.
    program = start_program("""
        import gc, threading
        from g4lidar import _g4lidar
        for _ in range(20):
            first = g4lidar.open("sim:")
            first.start()
            simulated = g4lidar.Simulator()
            others = [g4lidar.open(simulated) for _ in range(30)]
            begun = threading.Event()
            def destroy():
                begun.set()
                while others:
                    others.pop()
                    g4lidar.open(simulated)
            thread = threading.Thread(target=destroy)
            thread.start()
            begun.wait()
            _g4lidar._close_all()
            thread.join()
            del first
            gc.collect()
        print("ended")
    """)
    out, err = program.communicate(timeout=PATIENCE)
    assert (program.returncode, out, err) == (0, "ended\n", "")


def test_a_handler_destroys_lidars_while_all_are_closed() -> None:
    program = start_program("""
        import signal
        from g4lidar import _g4lidar
        first = g4lidar.open("sim:")
        first.start()
        simulated = g4lidar.Simulator()
        kept = []
        for _ in range(200):
            kept.append(g4lidar.open(simulated))
            kept[-1].start()
        signal.signal(signal.SIGALRM, lambda *_: kept and kept.pop())
        signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)
        _g4lidar._close_all()
        signal.setitimer(signal.ITIMER_REAL, 0)
        print(len(kept) < 200)
    """)
    out, err = program.communicate(timeout=PATIENCE)
    assert (program.returncode, out, err) == (0, "True\n", "")


def test_a_lidar_in_a_global_that_is_destroyed_last() -> None:
    program = start_program("""
        import atexit
        class Owner:
            def __init__(self, lidar):
                self.lidar = lidar
            def __del__(self):
                self.lidar.close()
        sys.modules["own"] = Owner(g4lidar.open("sim:"))
        sys.modules["own"].lidar.start()
        @atexit.register
        def late():  # before the module closes all lidars
            sys.late = g4lidar.open("sim:")
            sys.late.start()
    """)
    _, err = program.communicate(timeout=PATIENCE)
    assert (program.returncode, err) == (0, "")
