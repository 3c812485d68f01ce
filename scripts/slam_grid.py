# SPDX-License-Identifier: MIT
# For scripts/slam: an occupancy grid, as map_server of ROS reads it, from scans in the form of CARMEN and a trajectory.
#   slam_grid.py SCANS.carmen PATH.tum DIRECTORY    writes map.pgm and map.yaml
#   slam_grid.py --check PATH.tum DIRECTORY         fails if the way of the robot is not free, or nothing is occupied
import argparse
import math
import sys
from pathlib import Path

import numpy as np

CELL_M = 0.05
OCCUPIED, FREE, UNKNOWN = 0, 254, 205
# A cell is occupied if at least this share of the beams that reached it ended there, and free if at most that.
OCCUPIED_SHARE, FREE_SHARE = 0.5, 0.1


def poses_of(path):
    """x, y and yaw of a TUM trajectory."""
    lines = np.loadtxt(path, ndmin=2)
    return np.column_stack([lines[:, 1], lines[:, 2], 2.0 * np.arctan2(lines[:, 6], lines[:, 7])])


def composed(a, b):
    """The pose b, given in the frame of a, in the frame in which a is given."""
    sine, cosine = math.sin(a[2]), math.cos(a[2])
    return a[0] + cosine * b[0] - sine * b[1], a[1] + sine * b[0] + cosine * b[1], a[2] + b[2]


def inverse(a):
    sine, cosine = math.sin(a[2]), math.cos(a[2])
    return -(cosine * a[0] + sine * a[1]), sine * a[0] - cosine * a[1], -a[2]


def scans_of(path):
    """Of each line: the bearings and ranges of its returns, and the place of the lidar on the robot."""
    for line in Path(path).read_text().splitlines():
        words = line.split()
        if not words or words[0] != "ROBOTLASER1":
            continue
        field_of_view, step, longest = (float(word) for word in words[3:6])
        count = int(words[8])
        ranges = np.array(words[9:9 + count], dtype=float)
        after = 9 + count + 1 + int(words[9 + count])
        lidar = tuple(float(word) for word in words[after:after + 3])
        robot = tuple(float(word) for word in words[after + 3:after + 6])
        bearings = -field_of_view / 2.0 + step * np.arange(count)
        # A direction without return is not known to be free.
        is_return = (ranges > 0.0) & (ranges < longest)
        yield bearings[is_return], ranges[is_return], composed(inverse(robot), lidar)


def write(arguments):
    poses = poses_of(arguments.path)
    scans = list(scans_of(arguments.scans))
    if len(scans) != len(poses):
        raise SystemExit(f"{len(scans)} scans and {len(poses)} poses")
    begins, ends = [], []
    for pose, (bearings, ranges, lidar) in zip(poses, scans):
        x, y, yaw = composed(pose, lidar)
        ends.append(np.column_stack([x + ranges * np.cos(bearings + yaw), y + ranges * np.sin(bearings + yaw)]))
        begins.append(np.broadcast_to([x, y], ends[-1].shape))
    begins, ends = np.concatenate(begins), np.concatenate(ends)
    least = np.floor(np.minimum(begins.min(axis=0), ends.min(axis=0)) / CELL_M).astype(int) - 2
    most = np.floor(np.maximum(begins.max(axis=0), ends.max(axis=0)) / CELL_M).astype(int) + 3
    width, height = most - least
    hits, passed = np.zeros(width * height), np.zeros(width * height)

    def cells_of(points):
        column, row = (np.floor(points / CELL_M).astype(int) - least).T
        return row * width + column

    np.add.at(hits, cells_of(ends), 1)
    # Each beam passes the cells before its last one: it is looked at every half cell.
    lengths = np.linalg.norm(ends - begins, axis=1)
    for at in np.arange(0.0, lengths.max(), CELL_M / 2.0):
        is_before = at < lengths - 1.5 * CELL_M
        part = at / lengths[is_before][:, None]
        np.add.at(passed, cells_of(begins[is_before] + part * (ends - begins)[is_before]), 0.5)
    seen = hits + passed
    share = np.divide(hits, seen, out=np.zeros_like(hits), where=seen > 0.0)
    values = np.full(width * height, UNKNOWN, dtype=np.uint8)
    values[(seen > 0.0) & (share <= FREE_SHARE)] = FREE
    values[(hits >= 2) & (share >= OCCUPIED_SHARE)] = OCCUPIED
    directory = Path(arguments.directory)
    picture = values.reshape(height, width)[::-1]  # the first row is the upper one
    (directory / "map.pgm").write_bytes(f"P5\n{width} {height}\n255\n".encode() + picture.tobytes())
    x, y = least * CELL_M
    (directory / "map.yaml").write_text(
        f"image: map.pgm\nmode: trinary\nresolution: {CELL_M}\norigin: [{x:.3f}, {y:.3f}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n")


def check(arguments):
    directory = Path(arguments.directory)
    data = (directory / "map.pgm").read_bytes()
    width, height = (int(word) for word in data.split(b"\n", 3)[1].split())
    values = np.frombuffer(data[-width * height:], dtype=np.uint8).reshape(height, width)[::-1]
    texts = dict(line.split(": ", 1) for line in (directory / "map.yaml").read_text().splitlines())
    origin = np.array([float(word) for word in texts["origin"].strip("[]").split(",")][:2])
    column, row = np.floor((poses_of(arguments.path)[:, :2] - origin) / float(texts["resolution"])).astype(int).T
    way = values[row, column]
    print(f"{np.mean(way == FREE):.1%} of the way are free, {np.mean(way == OCCUPIED):.1%} occupied; "
          f"{np.count_nonzero(values == OCCUPIED)} cells of the map are occupied")
    return 0 if np.mean(way == FREE) > 0.99 and np.count_nonzero(values == OCCUPIED) > 100 else 1


def main():
    parser = argparse.ArgumentParser()
    if "--check" in sys.argv:
        parser.add_argument("--check", action="store_true")
    else:
        parser.add_argument("scans")
    parser.add_argument("path")
    parser.add_argument("directory")
    arguments = parser.parse_args()
    raise SystemExit(check(arguments) if "check" in arguments else write(arguments))


if __name__ == "__main__":
    main()
