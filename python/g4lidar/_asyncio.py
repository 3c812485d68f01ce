# SPDX-License-Identifier: MIT
"""Scans in the loop of asyncio: Lidar.scans_async()."""
import asyncio
from collections.abc import AsyncIterator

from ._g4lidar import Lidar, Scan
from .errors import EndOfInput, Timeout

LONGEST_SPIN_UP = 10.0  # seconds; see Lidar.scans()
STEP = 0.1  # seconds of a lidar without a descriptor, whose time is virtual


async def scans(lidar: Lidar, timeout: float | None, newest: bool) -> AsyncIterator[Scan]:
    """Yields scans, and waits for the descriptor of the lidar and for its deadline."""
    loop = asyncio.get_running_loop()
    waited = 0.0  # without a scan
    while True:
        limit = None if timeout is None else timeout + (LONGEST_SPIN_UP if lidar.is_spinning_up else 0.0)
        try:
            scan = lidar.poll_scan(newest=newest) if lidar.fileno() >= 0 else lidar.next_scan(STEP)
        except Timeout:
            scan = None
            waited += STEP
        except EndOfInput:
            return
        if scan is not None:
            yield scan
            waited = 0.0
        elif limit is not None and waited >= limit:
            lidar.next_scan(0.0)  # raises Timeout, or what has happened
        elif lidar.fileno() < 0:
            await asyncio.sleep(0)
        else:
            begin = loop.time()
            times = [None if limit is None else begin + limit - waited, lidar.next_deadline()]
            await _readable(loop, lidar.fileno(), min((t for t in times if t is not None), default=None))
            waited += loop.time() - begin


async def _readable(loop: asyncio.AbstractEventLoop, descriptor: int, until: float | None) -> None:
    """Waits until the descriptor is readable, or for this time of the loop."""
    ready = loop.create_future()

    def end() -> None:
        if not ready.done():
            ready.set_result(None)

    timer = None if until is None else loop.call_at(until, end)
    loop.add_reader(descriptor, end)
    try:
        await ready
    finally:
        loop.remove_reader(descriptor)
        if timer is not None:
            timer.cancel()
