# SPDX-License-Identifier: MIT
# For scripts/ci/ros2: the truth of a simulated lidar, and its comparison with messages. As a program, with the file of
# `g4-dump sim --truth`, it reads the lines that ros2-reader prints.
import csv
import math
import struct
import sys
from types import SimpleNamespace
from typing import NamedTuple

RANGE_M = 0.000125 + 1e-6  # half of a quarter of a millimetre, and the rounding of a float
SILENT_DEG = math.degrees(math.atan(-21.8 / 155.3))  # the correction for an infinite range
LEAST_RANGE_M = 0.1  # of the datasheet; a nearer return is not reliable
SETTLED_NS = 5_000_000_000  # from here on times are within a millisecond of the truth


class Sample(NamedTuple):
    time_ns: int
    angle_deg: float  # as ROS 2 has it: counter-clockwise, 0 ahead
    range_m: float
    is_return: bool

    @property
    def is_reliable(self):
        return self.is_return and self.range_m > LEAST_RANGE_M

    @property
    def angle_error_deg(self):
        """Half of 1/64 degree, the rounding of what is between two angles of a packet, and that of the range in the
        second-level correction."""
        return 1 / 128 + 1e-3 + (math.degrees(0.0218 / self.range_m**2 * RANGE_M) if self.is_return else 0)


def stamp_ns(header):
    return header.stamp.sec * 1_000_000_000 + header.stamp.nanosec


def turned(degrees):
    """Between -180 and 180."""
    return (degrees + 180) % 360 - 180


class Truth:
    """The revolutions of `g4-dump sim --truth`."""

    def __init__(self, path):
        revolutions = {}
        with open(path, encoding="ascii") as file:
            for row in csv.DictReader(file):
                is_return = row["raw"] != "0"
                angle_deg = float(row["bearing_deg"]) if is_return else float(row["first_level_deg"]) + SILENT_DEG
                revolutions.setdefault(int(row["scan"]), []).append(
                    Sample(int(row["time_ns"]), turned(180 - angle_deg), float(row["range_mm"]) / 1000, is_return))
        self.end_ns = max(sample.time_ns for sample in revolutions.pop(max(revolutions)))  # not all of it was sent
        self.settled = {number: samples for number, samples in revolutions.items() if samples[0].time_ns > SETTLED_NS}
        self.begin_ns = None  # the stamp that is time 0 of the simulation

    def follow(self, header):
        """Where the recording begins again, its stamps go on a second later."""
        if self.begin_ns is not None and stamp_ns(header) - self.begin_ns > self.end_ns + 500_000_000:
            self.begin_ns = None

    def check_cloud(self, cloud):
        """The number of the revolution that it is; None for one of the first seconds."""
        assert [f.name for f in cloud.fields] == ["x", "y", "z", "t", "range", "angle"]
        assert len(cloud.data) == cloud.row_step == cloud.width * 24
        self.follow(cloud.header)
        points = list(struct.iter_unpack("<fffIff", bytes(cloud.data)))
        for number, samples in self.settled.items():
            returns = [each for each in samples if each.is_return]
            if len(returns) == len(points) and all(abs(p[4] - s.range_m) < RANGE_M for p, s in zip(points, returns)):
                break
        else:
            # By its time it must be one of the first seconds; else its numbers are wrong.
            assert self.begin_ns is None or stamp_ns(cloud.header) - self.begin_ns < SETTLED_NS + 1_000_000, points[:5]
            return None
        self.check_time(cloud.header, samples[0])
        for (x, y, z, t, _, angle), sample in zip(points, returns):
            assert abs(turned(math.degrees(angle) - sample.angle_deg)) < sample.angle_error_deg, (angle, sample)
            place = (sample.range_m * math.cos(math.radians(sample.angle_deg)),
                     sample.range_m * math.sin(math.radians(sample.angle_deg)))
            limit = RANGE_M + sample.range_m * math.radians(sample.angle_error_deg)
            assert math.dist((x, y), place) < limit and z == 0, (x, y, sample)
            assert abs(t - (sample.time_ns - samples[0].time_ns)) < 1_000_000, (t, sample)
        return number

    def check_scan(self, scan):
        """The number of the revolution that it is; None before the first cloud, and for one of the first seconds."""
        assert scan.header.frame_id == "laser"
        self.follow(scan.header)
        if self.begin_ns is None or stamp_ns(scan.header) - self.begin_ns < SETTLED_NS + 1_000_000:
            return None
        number, samples = min(self.settled.items(), key=lambda each: abs(
            stamp_ns(scan.header) - self.begin_ns - each[1][0].time_ns))
        self.check_time(scan.header, samples[0])
        width = 360 / len(scan.ranges)
        near = [[] for _ in scan.ranges]  # samples of each range, and those at its edges: distance from its middle
        for sample in samples:
            place = (sample.angle_deg + 180) / width
            for index in {math.floor(place), math.ceil(place)}:
                off = abs(place - index) * width
                if off < width / 2 + sample.angle_error_deg:
                    near[index % len(near)].append((off, sample))
        for got, candidates in zip(scan.ranges, near):
            assert is_explained(got, candidates, width), (got, candidates)
        return number

    def check_time(self, header, sample):
        begin_ns = stamp_ns(header) - sample.time_ns
        self.begin_ns = self.begin_ns or begin_ns
        assert abs(begin_ns - self.begin_ns) < 1_000_000, (begin_ns - self.begin_ns, sample)


def is_explained(got, candidates, width):
    """Whether a range is that of the return nearest to its middle; of two that are equally near, that of either."""
    certain = [(off, s) for off, s in candidates if off < width / 2 - s.angle_error_deg]
    if math.isfinite(got):
        nearest = min((off for off, s in certain if s.is_reliable), default=width)
        return any(off < nearest + 2 * s.angle_error_deg and abs(got - s.range_m) < RANGE_M
                   for off, s in candidates if s.is_reliable)
    if any(s.is_reliable for _, s in certain):
        return False
    if got == math.inf:
        return any(not s.is_return for _, s in candidates)
    return not certain or any(s.is_return for _, s in candidates)


def header_of(words):
    return SimpleNamespace(stamp=SimpleNamespace(sec=int(words[1]), nanosec=int(words[2])), frame_id="laser")


def main():
    truth = Truth(sys.argv[1])
    scans, clouds = set(), set()
    for line in sys.stdin:
        words = line.split()
        header = header_of(words)
        if words[0] == "scan":
            assert words[3] == header.frame_id
            scans.add(truth.check_scan(SimpleNamespace(header=header, ranges=[float(word) for word in words[4:]])))
        else:
            fields = [SimpleNamespace(name=name) for name in words[5].split(",")]
            clouds.add(truth.check_cloud(SimpleNamespace(header=header, fields=fields, width=int(words[3]),
                                                         row_step=int(words[4]), data=bytes.fromhex(words[6]))))
        if min(len(scans), len(clouds)) > 15:
            print(f"RustDDS: {len(scans - {None})} scans and {len(clouds - {None})} clouds as the simulator has them")
            return
    raise AssertionError((scans, clouds))


if __name__ == "__main__":
    main()
