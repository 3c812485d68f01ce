# SPDX-License-Identifier: MIT
"""Drivers of other authors read simulated lidars of other models than the G4.

pylidar3-family.py points MODEL BYTES TRUTH
    lds2d decodes a file of bytes; its points are compared with the truth, one by one.
pylidar3-family.py port MODEL PATH
    lds2d reads the model at a serial port; it stands in a square room whose walls are 1 m away.
pylidar3-family.py x4 PATH
    The class YdLidarX4 of PyLidar3 reads an X4, with ranges by angle; its room has four different walls. It sets
    DTR: needs pylidar3-dtr.c, preloaded.
"""
import csv
import itertools
import math
import sys

NAMES = {"x4": "YDLIDAR-X4", "x2": "YDLIDAR-X2", "x4-pro": "YDLIDAR-X4-PRO", "scl": "YDLIDAR-SCL"}
NEAREST, FARTHEST = 1000.0, 1415.0


def need(condition, words):
    if not condition:
        raise AssertionError(words)


class Bytes:
    """A transport of lds2d: a file."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.left = file.read()

    def read(self, count):
        if not self.left:
            raise EOFError
        part, self.left = self.left[:count], self.left[count:]
        return part


def points_of(driver):
    try:
        yield from driver.points()
    except (EOFError, RuntimeError):  # a generator turns some exceptions into RuntimeError
        return


def points(model, stream, truth):
    from lds2d import core

    found = list(points_of(core.driver_for(NAMES[model])(Bytes(stream))))
    with open(truth, newline="") as file:
        rows = list(csv.DictReader(file))
    need(len(rows) - 80 < len(found) <= len(rows), f"{len(found)} points of {len(rows)} samples")
    worst = 0.0
    returns = 0
    for point, row in zip(found, rows):
        raw = int(row["raw"])
        need(point.dist_mm == raw, f"{row}: {point}")
        if raw == 0:
            continue
        returns += 1
        # First and last angle are rounded to 1/64 degree, lds2d cuts to 1/64; and the range is in millimetres.
        allowed = 3 / 64 + math.degrees(22 / raw**2)
        apart = abs((point.angle_deg - float(row["bearing_deg"]) + 180) % 360 - 180)
        need(apart < allowed, f"{row}: {point}, {apart} degrees apart")
        worst = max(worst, apart)
    need(returns > len(rows) / 2, f"only {returns} returns")
    print(f"{model}: lds2d gives {len(found)} points, {returns} with a range, at most {worst:.4f} degrees off")


def room(name, ranges, least):
    need(len(ranges) > least, f"{name}: only {len(ranges)} ranges")
    need(min(ranges) > NEAREST - 60, f"{name}: {min(ranges)} mm is too near")
    need(max(ranges) < FARTHEST + 60, f"{name}: {max(ranges)} mm is too far")
    print(f"{name}: {len(ranges)} ranges of {min(ranges)} to {max(ranges)} mm at its port")


def port(model, path):
    import lds2d

    with lds2d.Lidar.open(NAMES[model], path) as lidar:
        lidar.start()
        scans = list(itertools.islice(lidar.scans(), 1, 6))
        lidar.stop()
    room(f"{model} and lds2d", [p.dist_mm for scan in scans for p in scan if p.dist_mm > 0], 1000)


# What is in front of, to the left of, behind and to the right of the X4, in mm.
WALLS = (1000.0, 1300.0, 1600.0, 1900.0)
# PyLidar3 rounds down to whole degrees, corrects the first and the last angle of a packet only, and spreads the
# others over one sample too many.
BELOW_DEG, ABOVE_DEG, BESIDE_MM = -1.5, 2.5, 20.0


def wall_mm(clockwise_deg):
    """The range in this direction, clockwise from straight ahead."""
    ahead = math.cos(math.radians(clockwise_deg))
    right = math.sin(math.radians(clockwise_deg))
    front, left, back, side = WALLS
    return min(
        front / ahead if ahead > 1e-9 else math.inf,
        -back / ahead if ahead < -1e-9 else math.inf,
        side / right if right > 1e-9 else math.inf,
        -left / right if right < -1e-9 else math.inf,
    )


def angles(scan):
    """Compares ranges by whole degrees with the walls; returns how many there are."""
    returns = [(degree, found) for degree, found in scan.items() if found > 0]
    for degree, found in returns:
        near = [wall_mm(degree + BELOW_DEG + step / 4) for step in range(int(4 * (ABOVE_DEG - BELOW_DEG)) + 1)]
        need(
            min(near) - BESIDE_MM < found < max(near) + BESIDE_MM,
            f"{found} mm at {degree} degrees, where the wall is {min(near):.0f} to {max(near):.0f} mm away",
        )
    return len(returns)


def x4(path):
    import PyLidar3

    lidar = PyLidar3.YdLidarX4(path)
    need(lidar.Connect(), "it does not connect")
    info = lidar.GetDeviceInfo()
    need(info["model_number"] == "6", f"model {info}")
    need(info["firmware_version"] == "1.10", f"firmware {info}")
    scans = lidar.StartScanning()
    next(scans)  # while the motor spins up
    found = sum(angles(next(scans)) for _ in range(3))
    lidar.StopScanning()
    lidar.Disconnect()
    need(found > 3 * 300, f"x4 and PyLidar3: only {found} ranges")
    print(f"x4 and PyLidar3: {found} ranges by angle at its port")


{"points": points, "port": port, "x4": x4}[sys.argv[1]](*sys.argv[2:])
