# SPDX-License-Identifier: MIT
"""scans_async() does what scans() does: ends, timeouts, reconnects, the newest scan."""
import asyncio
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import PATIENCE

import g4lidar
from g4lidar import errors

Make = Callable[..., g4lidar.Simulator]


def in_loop(work: Callable[[], object]) -> None:
    """Runs a coroutine function, which fails if it does not end."""

    async def limited() -> None:
        await asyncio.wait_for(work(), PATIENCE)  # type: ignore[arg-type]

    asyncio.run(limited())


async def count_scans(lidar: g4lidar.Lidar, timeout: float | None = PATIENCE) -> int:
    return len([scan async for scan in lidar.scans_async(timeout=timeout)])


@pytest.mark.parametrize("end", ["close", "release"])
@pytest.mark.parametrize("in_thread", [False, True])
@pytest.mark.parametrize("silence", ["60s", "0s"])
def test_close_of_another_task_ends_the_loop(g4_simulator: Make, end: str, in_thread: bool, silence: str) -> None:
    async def work() -> None:
        lidar = g4lidar.open(g4_simulator(virtual_time=False, silence_ns=silence), stall_time=60)
        lidar.start()
        waiting = [asyncio.create_task(count_scans(lidar, None)) for _ in range(2)]
        await asyncio.sleep(0.3)
        if in_thread:
            await asyncio.to_thread(getattr(lidar, end))
        else:
            getattr(lidar, end)()
        for each in waiting:
            await each
        assert await count_scans(lidar) == 0

    in_loop(work)


def test_close_ends_a_loop_in_virtual_time(g4_simulator: Make) -> None:
    async def work() -> None:
        lidar = g4lidar.open(g4_simulator())
        lidar.start()
        waiting = asyncio.create_task(count_scans(lidar))
        await asyncio.sleep(0.1)
        lidar.close()
        assert await waiting > 0

    in_loop(work)


def test_wake_raises_cancelled(g4_simulator: Make) -> None:
    async def work() -> None:
        with g4lidar.open(g4_simulator(virtual_time=False, silence_ns="60s"), stall_time=60) as lidar:
            lidar.start()
            waiting = asyncio.create_task(count_scans(lidar, None))
            await asyncio.sleep(0.3)
            lidar.wake()
            with pytest.raises(errors.Cancelled):
                await waiting

    in_loop(work)


def test_a_task_that_is_cancelled_leaves_the_lidar_open(g4_simulator: Make) -> None:
    async def work() -> None:
        with g4lidar.open(g4_simulator(virtual_time=False)) as lidar:
            lidar.start()
            waiting = asyncio.create_task(count_scans(lidar, None))
            await asyncio.sleep(0.3)
            waiting.cancel()
            with pytest.raises(asyncio.CancelledError):
                await waiting
            assert len(lidar.try_scan(20)) > 100

    in_loop(work)


@pytest.mark.parametrize("virtual_time", [True, False])
def test_reconnects(g4_simulator: Make, virtual_time: bool) -> None:
    fault = "unplug@3s+2s"  # longer than the timeout

    async def work() -> None:
        with g4lidar.open(g4_simulator(virtual_time=virtual_time, faults=[fault]), reconnect=True) as lidar:
            lidar.start(frequency_hz=12)
            async for _ in lidar.scans_async(timeout=1):
                if lidar.counts()["reconnects"] == 1:
                    break

    in_loop(work)


def test_newest_drops_and_counts(g4_simulator: Make) -> None:
    async def work() -> None:
        with g4lidar.open(g4_simulator(virtual_time=False)) as lidar:
            lidar.start(frequency_hz=12)
            async for scan in lidar.scans_async(timeout=20, newest=True):
                if lidar.counts()["scans_dropped"] >= 3:
                    break
                time.sleep(0.5)  # the system keeps the bytes of five revolutions
            assert time.monotonic_ns() - scan.end_ns < 20_000_000_000

    in_loop(work)


@pytest.mark.parametrize("timeout", [0.05, 0.25, 1.0])
def test_the_same_scans_and_the_same_timeout(g4_simulator: Make, timeout: float) -> None:
    """Until the device falls silent; then both raise Timeout, at the same time of the lidar."""

    def make() -> tuple[g4lidar.Simulator, g4lidar.Lidar]:
        simulated = g4_simulator(seed=3, faults=["stall@9s"])
        lidar = g4lidar.open(simulated, stall_time=60)
        lidar.start()
        return simulated, lidar

    simulated, lidar = make()
    wanted: list[int] = []
    timeouts = 0
    loop = lidar.scans(timeout=timeout)
    while simulated.now_ns < 11_000_000_000:
        try:
            wanted.append(next(loop).revolution)
        except errors.Timeout:
            timeouts += 1
    ended_ns = simulated.now_ns
    simulated, lidar = make()

    async def work() -> None:
        found: list[int] = []
        again = 0
        while simulated.now_ns < 11_000_000_000:
            try:
                async for scan in lidar.scans_async(timeout=timeout):
                    found.append(scan.revolution)
            except errors.Timeout:
                again += 1
        assert found == wanted and again == timeouts
        assert abs(simulated.now_ns - ended_ns) < 150_000_000

    in_loop(work)


def test_spin_up_is_no_timeout(g4_simulator: Make) -> None:
    async def work() -> None:
        for virtual_time in (True, False):
            with g4lidar.open(g4_simulator(virtual_time=virtual_time, silence_ns="2s")) as lidar:
                lidar.start()
                async for scan in lidar.scans_async(timeout=0.3):
                    assert len(scan) > 100
                    break

    in_loop(work)


def test_a_lost_lidar_is_waited_for_without_limit(g4_simulator: Make) -> None:
    async def work() -> None:
        count = 0
        with g4lidar.open(g4_simulator(faults=["unplug@4s+60s"]), reconnect=True) as lidar:
            lidar.start()
            async for _ in lidar.scans_async(timeout=0.3):
                count += 1
                if count == 40:
                    break
            assert lidar.counts()["reconnects"] == 1

    in_loop(work)


def test_a_motor_that_never_spins_up_ends_the_loop_after_10_s(g4_simulator: Make) -> None:
    async def work() -> None:
        simulated = g4_simulator(silence_ns="60s")
        with g4lidar.open(simulated) as lidar:
            lidar.start()
            begin_ns = simulated.now_ns
            with pytest.raises(errors.Timeout, match="the motor spins up"):
                async for _ in lidar.scans_async(timeout=0.3):
                    pass
            assert abs(simulated.now_ns - begin_ns - 10_000_000_000) < 600_000_000

    in_loop(work)


def test_a_recording_ends_and_leaves_the_loop_free(g4_simulator: Make, tmp_path: Path) -> None:
    path = tmp_path / "walk.mcap"
    with g4lidar.open(g4_simulator(), record=path) as lidar:
        lidar.start()
        recorded = [scan for scan, _ in zip(lidar.scans(), range(12), strict=False)]

    async def work() -> None:
        for speed in (0.0, 8.0):
            ticks = 0

            async def tick() -> None:
                nonlocal ticks
                while True:
                    await asyncio.sleep(0)
                    ticks += 1

            other = asyncio.create_task(tick())
            before = threading.active_count()
            with g4lidar.open(path, speed=speed) as lidar:
                lidar.start()
                assert await count_scans(lidar) >= len(recorded)
                assert threading.active_count() == before
            other.cancel()
            assert ticks >= len(recorded)

    in_loop(work)
