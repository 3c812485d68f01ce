# SPDX-License-Identifier: MIT
"""Reads a lidar with one of several packages: read.py NAME PATH SECONDS

Prints the processor time per second of whole scans, after the first two scans, and the points per second.
"""
import math
import sys
import time
from collections.abc import Iterator
from typing import Any


def by_g4lidar(path: str) -> Iterator[int]:
    import g4lidar

    with g4lidar.open(path) as lidar:
        lidar.start()
        for scan in lidar.scans(timeout=10):
            yield len(scan.points)


def by_pylidar3(path: str) -> Iterator[int]:
    import PyLidar3

    lidar = PyLidar3.YdLidarG4(path)
    if not lidar.Connect():
        raise SystemExit("PyLidar3 does not connect")
    try:
        for directions in lidar.StartScanning():
            yield len(directions)
    finally:
        lidar.StopScanning()
        lidar.Disconnect()


def by_lds2d(path: str) -> Iterator[int]:
    import lds2d

    lidar = lds2d.Lidar.open("YDLIDAR-X4", path, baud=230400)  # a G4 sends the same packets
    lidar.start()
    try:
        for scan in lidar.scans():
            yield len(scan)
    finally:
        lidar.stop()
        lidar.close()


def by_loop(path: str) -> Iterator[int]:
    """A loop in the manner of rplidar-roboticia: each packet is read with pyserial, each sample becomes a tuple."""
    import serial

    port = serial.Serial(path, 230400, timeout=1)
    port.write(b"\xa5\x60")
    scan: list[tuple[int, float, float]] = []
    try:
        while True:
            if port.read(1) != b"\xaa" or port.read(1) != b"\x55":
                continue
            header = port.read(8)
            kind, count = header[0], header[1]
            body = port.read(2 * count)
            if kind & 1:
                if scan:
                    yield len(scan)
                scan = []
            scan.extend(samples_of(header, body, count))
    finally:
        port.write(b"\xa5\x65")
        port.close()


def samples_of(header: bytes, body: bytes, count: int) -> Iterator[tuple[int, float, float]]:
    words = [body[2 * i] | body[2 * i + 1] << 8 for i in range(count)]
    check = 0x55AA ^ (header[0] | header[1] << 8) ^ (header[2] | header[3] << 8) ^ (header[4] | header[5] << 8)
    for word in words:
        check ^= word
    if check != header[6] | header[7] << 8:
        return
    first = (header[2] | header[3] << 8) / 128
    turn = ((header[4] | header[5] << 8) / 128 - first) % 360
    for i, word in enumerate(words):
        range_mm = word / 4
        angle = first + (turn * i / (count - 1) if count > 1 else 0)
        if range_mm:
            angle += math.degrees(math.atan(21.8 * (155.3 - range_mm) / (155.3 * range_mm)))
        yield (15 if range_mm else 0, angle % 360, range_mm)


def main(name: str, path: str, seconds: float) -> None:
    readers: dict[str, Any] = {"g4lidar": by_g4lidar, "pylidar3": by_pylidar3, "lds2d": by_lds2d, "loop": by_loop}
    scans = readers[name](path)
    next(scans)
    next(scans)
    begin, used, points, count = time.monotonic(), time.process_time(), 0, 0
    while time.monotonic() - begin < seconds:
        points += next(scans)
        count += 1
    took = time.monotonic() - begin
    used = time.process_time() - used
    scans.close()
    print(f"{1000 * used / took:.2f} {count / took:.2f} {points / took:.0f}")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], float(sys.argv[3]))
