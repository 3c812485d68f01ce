# SPDX-License-Identifier: MIT
"""Scans in the loop of asyncio: Lidar.scans_async()."""
import asyncio
import math
import os
from collections.abc import AsyncIterator

from ._g4lidar import Lidar, Scan

STEP = 0.1  # seconds of a lidar without a descriptor, whose time is virtual


async def scans(lidar: Lidar, timeout: float | None, newest: bool) -> AsyncIterator[Scan]:
    """Yields scans, and waits for the descriptor of the lidar and for its deadline."""
    loop = asyncio.get_running_loop()
    waiting = lidar.scans(timeout, newest=newest)
    while True:
        descriptor = lidar.fileno()
        try:
            scan = waiting._advance(0.0 if descriptor >= 0 else STEP)
        except StopIteration:
            return
        if scan is not None:
            yield scan
        if scan is not None or descriptor < 0:
            await asyncio.sleep(0)
            continue
        deadline = lidar.next_deadline()
        until = min(loop.time() + waiting._left(), math.inf if deadline is None else deadline)
        await _readable(loop, (descriptor, lidar._notice()), until)


async def _readable(loop: asyncio.AbstractEventLoop, descriptors: tuple[int, ...], until: float) -> None:
    """Waits until one of the descriptors is readable, or for this time of the loop."""
    ready = loop.create_future()

    def end() -> None:
        if not ready.done():
            ready.set_result(None)

    timer = None if until == math.inf else loop.call_at(until, end)
    # Copies: close() of another task closes the descriptor of the lidar, and another task may wait for it, too.
    copies = [os.dup(each) for each in descriptors if each >= 0]
    try:
        for each in copies:
            loop.add_reader(each, end)
        await ready
    finally:
        for each in copies:
            loop.remove_reader(each)
            os.close(each)
        if timer is not None:
            timer.cancel()
