# SPDX-License-Identifier: MIT
"""What a program does by mistake must not end in a crash, a wait for ever, or a damaged file."""
import subprocess
import sys
import textwrap
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import PATIENCE, start_program

import g4lidar

Make = Callable[..., g4lidar.Simulator]


def test_a_child_after_fork_leaves_recordings_alone(tmp_path: Path) -> None:
    # The child ends before the parent writes most of the file: its writer must add nothing.
    program = start_program("""
        import os
        writer = g4lidar.RecordingWriter(sys.argv[1])
        writer.from_device(b"first", 1)
        writer.flush()
        whole = g4lidar.Recording(sys.argv[1])
        next(whole)
        real = g4lidar.Simulator(virtual_time=False)
        child = os.fork()
        if child == 0:
            calls = [lambda: writer.from_device(b"child", 2), lambda: writer.to_device(b"child", 2), writer.close,
                     writer.flush, lambda: writer.set_wall_clock(1), lambda: writer.odometry(2, 0, 0, 0),
                     lambda: next(whole), lambda: whole.seek(0), lambda: whole.duration, lambda: whole.position,
                     real.close, lambda: real.path]
            for number, call in enumerate(calls):
                try:
                    call()
                    print("call", number, "was not refused")
                except RuntimeError as refused:
                    assert "fork" in str(refused), refused
            del writer, whole, real
            sys.exit(7)  # with all destructors
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), os.path.exists(real.path))
        for number in range(2000):
            writer.from_device(b"parent %d" % number, 3 + number)
        writer.close()
        read = g4lidar.Recording(sys.argv[1])
        items = [item.data for item in read if item.kind == "from_device"]
        print(len(items), items[-1], read.is_damaged)
    """, str(tmp_path / "both.mcap"))
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "7 True\n2001 b'parent 1999' False\n", err


def test_closing_a_simulator_that_another_thread_uses() -> None:
    program = start_program("""
        import threading
        for _ in range(100):
            simulated = g4lidar.Simulator(virtual_time=False)
            begun = threading.Event()
            def use():
                try:
                    while True:
                        simulated.now_ns
                        begun.set()
                except RuntimeError as closed:
                    assert "closed" in str(closed), closed
            users = [threading.Thread(target=use) for _ in range(3)]
            for user in users:
                user.start()
            begun.wait()
            simulated.close()
            for user in users:
                user.join()
        print("ended")
    """)
    out, err = program.communicate(timeout=PATIENCE)
    assert (program.returncode, out, err) == (0, "ended\n", "")


def test_a_lidar_keeps_its_simulator() -> None:
    with g4lidar.open(g4lidar.Simulator(virtual_time=False)) as lidar:
        lidar.start()
        assert len(lidar.try_scan(20)) > 100


def test_close_removes_the_port_of_an_open_lidar() -> None:
    simulated = g4lidar.Simulator(virtual_time=False)
    lidar = g4lidar.open(simulated)
    lidar.start()
    lidar.try_scan(20)
    simulated.close()
    with pytest.raises(g4lidar.errors.Gone):
        while True:
            lidar.try_scan(20)
    with pytest.raises(RuntimeError, match="closed"):
        simulated.now_ns  # noqa: B018


def test_the_simulator_can_be_used_while_the_doctor_runs() -> None:
    program = start_program("""
        import signal
        simulated = g4lidar.Simulator()
        seen = []
        signal.signal(signal.SIGALRM, lambda *_: seen.append(simulated.is_scanning))
        signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)
        times = []
        reports = g4lidar.doctor(simulated, measuring_time=600, on_stage=lambda _: times.append(simulated.now_ns))
        signal.setitimer(signal.ITIMER_REAL, 0)
        print(len(times) == len(reports) > 3, times == sorted(times), len(seen) > 0)
    """)
    out, err = program.communicate(timeout=PATIENCE)
    assert out == "True True True\n", err


def test_signals_if_another_thread_imported_the_module() -> None:
    program = textwrap.dedent("""
        import importlib, os, signal, threading, time
        importing = threading.Thread(target=importlib.import_module, args=("g4lidar",))
        importing.start()
        importing.join()
        import g4lidar
        lidar = g4lidar.open("sim:?silence_ns=60s", stall_time=60)
        lidar.start()
        threading.Timer(1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        begin = time.monotonic()
        try:
            lidar.try_scan(40)
        except KeyboardInterrupt:
            print(time.monotonic() - begin < 20)
    """)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=PATIENCE,
                          check=False)
    assert done.stdout == "True\n", done.stderr


def test_a_handler_that_restores_the_default() -> None:
    program = start_program("""
        import os, signal, threading
        lidar = g4lidar.open("sim:")
        lidar.start()
        lidar.try_scan(20)
        def handle(*_):
            print("first", flush=True)
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.signal(signal.SIGTERM, handle)
        threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGTERM)).start()
        for _ in range(10):
            lidar.try_scan(20)
        assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
        os.kill(os.getpid(), signal.SIGTERM)
        print("still there")
    """)
    out, err = program.communicate(timeout=PATIENCE)
    assert (out, program.returncode) == ("first\n", -15), err


def test_misaligned_arrays_are_copied(g4_lidar: g4lidar.Lidar) -> None:
    g4_lidar.start()
    points = g4_lidar.try_scan().points
    shifted = np.frombuffer(b"\0" + points.tobytes(), dtype=g4lidar.POINT_DTYPE, offset=1)
    assert g4lidar.to_xy(shifted).tobytes() == g4lidar.to_xy(points).tobytes()
    room = np.frombuffer(bytearray(24 * 200 + 1), dtype=g4lidar.POINT_DTYPE, offset=1)
    with pytest.raises(ValueError, match="multiple of 8"):
        g4lidar.Decoder().decode(b"", room)


def test_the_documented_room_of_decode_is_enough() -> None:
    # 80 samples, of which all but the last byte is held: 169 bytes.
    held = bytes([0xAA, 0x55, 0, 80, 1, 0, 1, 0]) + bytes(161)
    for given in range(0, 30):
        decoder = g4lidar.Decoder()
        decoder.decode(held)
        assert decoder.counts()["held"] == 169
        decoder.decode(bytes(given), np.zeros(given // 2 + 165, g4lidar.POINT_DTYPE))
        with pytest.raises(ValueError, match="165 more"):
            decoder.decode(bytes(given), np.zeros(given // 2 + 164, g4lidar.POINT_DTYPE))


def test_a_decoder_in_two_threads_is_refused() -> None:
    decoder = g4lidar.Decoder()
    zeros = bytes(20_000_000)
    refused: list[str] = []
    ended = threading.Event()

    def use() -> None:
        while not ended.is_set():
            try:
                decoder.decode(zeros)
            except RuntimeError as error:
                refused.append(str(error))
                ended.set()

    threads = [threading.Thread(target=use) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE)
    assert refused and "one for each thread" in refused[0]
    assert len(decoder.decode(b"")) == 0  # it can be used again


def test_the_mark_takes_names_only(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("""
        import pytest

        @pytest.mark.g4("unplug@3s")
        def test_one(g4_lidar): ...
    """)
    result = pytester.runpytest_subprocess("-p", "no:cacheprovider")
    result.stdout.fnmatch_lines("*takes arguments by name*")
