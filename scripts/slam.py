# SPDX-License-Identifier: MIT
# For scripts/slam: the trajectory of icp-slam with times, the error of its map, and a picture.
import argparse
import math
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np


def numbers(path):
    """The numbers of a text file, line by line."""
    return np.loadtxt(path, ndmin=2, comments=("#", "%"))


def poses_of(path):
    """x, y and yaw of a TUM trajectory."""
    lines = numbers(path)
    return np.column_stack([lines[:, 1], lines[:, 2], 2.0 * np.arctan2(lines[:, 6], lines[:, 7])])


def write_trajectory(arguments):
    """icp-slam numbers its poses; their times are those of the scans, in the same order."""
    stamps = [line.split()[0] for line in Path(arguments.stamps).read_text().splitlines()]
    poses = numbers(arguments.poses)
    if len(stamps) != len(poses):
        raise SystemExit(f"icp-slam wrote {len(poses)} poses for {len(stamps)} scans")
    with open(arguments.out, "w") as out:
        for stamp, (_, x, y, yaw) in zip(stamps, poses):
            out.write(f"{stamp} {x:.6f} {y:.6f} 0 0 0 {math.sin(yaw / 2):.9f} {math.cos(yaw / 2):.9f}\n")


def map_points(directory):
    """The points of the map that icp-slam wrote."""
    found = sorted(Path(directory).glob("_finalmap*oints*.txt"))
    if not found:
        raise SystemExit(f"icp-slam wrote no map of points into {directory}")
    return numbers(found[0])[:, :2]


class World:
    """The walls and pillars of a world, in the frame of the robot's first pose."""

    def __init__(self, path):
        lines = [line.split("#")[0].split() for line in Path(path).read_text().splitlines()]
        values = {kind: [[float(word) for word in line[1:]] for line in lines if line and line[0] == kind]
                  for kind in ("wall", "disc", "lidar", "pose")}
        x, y, heading = values["lidar"][0] if values["lidar"] else values["pose"][0][1:]
        turn = np.array([[math.cos(math.radians(heading)), -math.sin(math.radians(heading))],
                         [math.sin(math.radians(heading)), math.cos(math.radians(heading))]])
        def placed(points):
            return (np.reshape(points, (-1, 2)) - [x, y]) @ turn
        self.begins = placed([wall[:2] for wall in values["wall"]])
        self.ends = placed([wall[2:] for wall in values["wall"]])
        self.discs = [(disc[0], placed([disc[1:3]])[0]) for disc in values["disc"] if len(disc) == 3]

    def distances(self, points):
        """From each point to the nearest wall or pillar."""
        nearest = np.full(len(points), np.inf)
        for begin, end in zip(self.begins, self.ends):
            along = end - begin
            part = np.clip((points - begin) @ along / (along @ along), 0.0, 1.0)
            nearest = np.minimum(nearest, np.linalg.norm(points - (begin + part[:, None] * along), axis=1))
        for radius, middle in self.discs:
            nearest = np.minimum(nearest, abs(np.linalg.norm(points - middle, axis=1) - radius))
        return nearest


def print_map_error(arguments):
    off_m = World(arguments.world).distances(map_points(arguments.map))
    print(f"map: {len(off_m)} points, {100.0 * np.mean(off_m <= 0.03):.1f} % within 3 cm of a wall, "
          f"median {100.0 * np.median(off_m):.1f} cm, 95th percentile {100.0 * np.percentile(off_m, 95):.1f} cm")


def draw(arguments):
    figure, axes = plt.subplots(figsize=(10, 7), layout="constrained")
    if arguments.world:
        world = World(arguments.world)
        for begin, end in zip(world.begins, world.ends):
            axes.plot(*np.transpose([begin, end]), color="#f0a030", linewidth=3.0, zorder=1,
                      label="walls of the world" if begin is world.begins[0] else None)
        for radius, middle in world.discs:
            axes.add_patch(plt.Circle(middle, radius, color="#f0a030", fill=False, linewidth=3.0, zorder=1))
    points = map_points(arguments.map)
    axes.plot(points[:, 0], points[:, 1], ".", color="black", markersize=1.5, zorder=2, label="map of icp-slam")
    if arguments.truth:
        axes.plot(*poses_of(arguments.truth)[:, :2].T, color="#30a040", linewidth=3.0, zorder=3, label="true path")
    axes.plot(*poses_of(arguments.path)[:, :2].T, color="#d03030", linewidth=1.0, zorder=4, label="path of icp-slam")
    axes.set_aspect("equal")
    axes.set_xlabel("x in m")
    axes.set_ylabel("y in m")
    axes.legend(loc="upper right")
    figure.savefig(arguments.out, dpi=100, metadata={"Software": None})


def main():
    parser = argparse.ArgumentParser()
    commands = parser.add_subparsers(required=True)
    for name, run, words in (("trajectory", write_trajectory, ("stamps", "poses", "out")),
                             ("map", print_map_error, ("map", "world")),
                             ("draw", draw, ("map", "path", "out"))):
        command = commands.add_parser(name)
        for word in words:
            command.add_argument(word)
        if run is draw:
            command.add_argument("--world")
            command.add_argument("--truth")
        command.set_defaults(run=run)
    arguments = parser.parse_args()
    arguments.run(arguments)


if __name__ == "__main__":
    main()
