# SPDX-License-Identifier: MIT
# For scripts/ci/ros2: what g4-dump prints of a recording, and its comparison with messages. As a program, with the grid
# and the points as csv, it reads the lines that ros2-reader prints.
import csv
import math
import struct
import sys
from types import SimpleNamespace


def stamp_ns(header):
    return header.stamp.sec * 1_000_000_000 + header.stamp.nanosec


def wanted_scans(path):
    """Ranges by stamp."""
    with open(path, encoding="ascii") as file:
        rows = csv.reader(file)
        next(rows)
        return {int(row[1]): [float(x) for x in row[3:]] for row in rows}


def wanted_clouds(path):
    """Places and times of the returns of each revolution, by its stamp."""
    revolutions = {}
    with open(path, encoding="ascii") as file:
        for row in csv.DictReader(file):
            revolutions.setdefault(row["scan"], []).append(
                (int(row["time_ns"]), float(row["angle_deg"]), float(row["range_m"])))
    return {points[0][0]: [(r * math.cos(math.radians(a)), r * math.sin(math.radians(a)), t - points[0][0])
                           for t, a, r in points if r > 0] for points in revolutions.values()}


def nearest(table, stamp):
    """That of the stamp; the difference of the clocks is rounded."""
    key = min(table, key=lambda each: abs(each - stamp))
    assert abs(key - stamp) < 1_000_000, (key, stamp)
    return table[key]


def check_scan(scan, wanted):
    assert scan.header.frame_id == "laser" and len(scan.ranges) == len(wanted)
    for got, want in zip(scan.ranges, wanted):
        assert got == want or math.isnan(got) and math.isnan(want) or abs(got - want) < 6e-6, (got, want)


def check_cloud(cloud, wanted):
    assert [f.name for f in cloud.fields] == ["x", "y", "z", "t", "range", "angle"]
    assert cloud.width == len(wanted) and len(cloud.data) == cloud.row_step
    points = struct.iter_unpack("<fffIff", bytes(cloud.data))
    for (x, y, z, t, _, _), (want_x, want_y, want_t) in zip(points, wanted):
        assert abs(x - want_x) < 2e-4 and abs(y - want_y) < 2e-4 and z == 0 and t == want_t


def header_of(words):
    return SimpleNamespace(stamp=SimpleNamespace(sec=int(words[1]), nanosec=int(words[2])), frame_id="laser")


def main():
    scans, clouds = wanted_scans(sys.argv[1]), wanted_clouds(sys.argv[2])
    seen = [0, 0]
    for line in sys.stdin:
        words = line.split()
        header = header_of(words)
        if words[0] == "scan":
            assert words[3] == header.frame_id
            scan = SimpleNamespace(header=header, ranges=[float(word) for word in words[4:]])
            check_scan(scan, nearest(scans, stamp_ns(header)))
        else:
            fields = [SimpleNamespace(name=name) for name in words[5].split(",")]
            cloud = SimpleNamespace(fields=fields, width=int(words[3]), row_step=int(words[4]),
                                    data=bytes.fromhex(words[6]))
            check_cloud(cloud, nearest(clouds, stamp_ns(header)))
        seen[words[0] == "cloud"] += 1
        if min(seen) >= 15:
            break
    assert min(seen) >= 15, seen
    print(f"RustDDS: {seen[0]} scans and {seen[1]} clouds as g4-dump prints them")


if __name__ == "__main__":
    main()
