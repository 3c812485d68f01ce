# SPDX-License-Identifier: MIT
"""foreign-clouds.py <points.csv> <scans> <a directory of PCD files>...: reads each file with PyPI's pypcd4, and holds
its points against the lines of the same scan, with their time by the same clock."""

import csv
import math
import sys
from pathlib import Path

from pypcd4 import PointCloud

FIELDS = ("x", "y", "z", "range_m", "angle_deg", "time_ns")


def scans_of(path):
    """The returns of each scan, by the time of the first one."""
    scans = {}
    with open(path, encoding="ascii") as file:
        for line in csv.DictReader(file):
            point = (float(line["range_m"]), float(line["angle_deg"]), int(line["time_ns"]))
            if point[0] > 0:
                scans.setdefault(line["scan"], []).append(point)
    return {points[0][2]: points for points in scans.values()}


def check(path, scans):
    cloud = PointCloud.from_path(path)
    assert cloud.fields == FIELDS, cloud.fields
    points = scans[int(cloud.pc_data["time_ns"][0])]
    assert cloud.points == len(cloud.pc_data) == len(points), path
    assert cloud.metadata.width == len(points) and cloud.metadata.height == 1
    for row, (range_m, angle_deg, time_ns) in zip(cloud.pc_data, points):
        angle = math.radians(angle_deg)
        assert int(row["time_ns"]) == time_ns, path
        assert abs(row["range_m"] - range_m) < 1e-5, path
        assert abs(row["angle_deg"] - angle_deg) < 1e-4, path
        assert abs(row["x"] - range_m * math.cos(angle)) < 1e-4, path
        assert abs(row["y"] - range_m * math.sin(angle)) < 1e-4, path
        assert row["z"] == 0, path
    return len(points), str(cloud.metadata.data.value)


def main():
    scans = scans_of(sys.argv[1])
    for directory in sys.argv[3:]:
        files = sorted(Path(directory).glob("*.pcd"))
        assert len(files) == int(sys.argv[2]), (directory, len(files))
        found = [check(file, scans) for file in files]
        assert len({form for _, form in found}) == 1
        print(f"{directory}: {sum(count for count, _ in found)} points in {len(files)} {found[0][1]} files by pypcd4")


main()
