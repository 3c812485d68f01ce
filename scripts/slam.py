# SPDX-License-Identifier: MIT
# For scripts/slam: the trajectory of icp-slam with times, the error of its map, and a picture.
import argparse
import math
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from evo.core import metrics, sync
from evo.tools import file_interface


def numbers(path):
    """The numbers of a text file, line by line."""
    return np.loadtxt(path, ndmin=2, comments=("#", "%"))


def poses_of(path):
    """x, y and yaw of a TUM trajectory."""
    lines = numbers(path)
    return np.column_stack([lines[:, 1], lines[:, 2], 2.0 * np.arctan2(lines[:, 6], lines[:, 7])])


def write_trajectory(arguments):
    """icp-slam writes a pose for the odometry of each scan and one for the scan, in the order of the log, without times."""
    stamps = [line.split()[-1] for line in Path(arguments.scans).read_text().splitlines()]
    poses = numbers(arguments.poses)[1::2]
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

    def offsets(self, points):
        """From each point to the nearest wall or pillar: its number, and the distance with a sign for the side."""
        offsets = []
        for begin, end in zip(self.begins, self.ends):
            along = end - begin
            part = np.clip((points - begin) @ along / (along @ along), 0.0, 1.0)
            off = points - (begin + part[:, None] * along)
            side = np.sign(off @ [-along[1], along[0]])
            offsets.append(np.where(side == 0.0, 1.0, side) * np.linalg.norm(off, axis=1))
        for radius, middle in self.discs:
            offsets.append(np.linalg.norm(points - middle, axis=1) - radius)
        offsets = np.array(offsets)
        nearest = np.argmin(abs(offsets), axis=0)
        return nearest, offsets[nearest, np.arange(len(points))]


def trajectory_error(truth, estimated, relation):
    """The root mean square of the absolute trajectory error. Both begin at the same pose, and are not aligned."""
    truth = file_interface.read_tum_trajectory_file(truth)
    pair = sync.associate_trajectories(truth, file_interface.read_tum_trajectory_file(estimated))
    if pair[0].num_poses < truth.num_poses:
        raise SystemExit(f"only {pair[0].num_poses} of {truth.num_poses} poses have a counterpart in time")
    error = metrics.APE(relation)
    error.process_data(pair)
    return error.get_statistic(metrics.StatisticsType.rmse)


def wall_errors(world, directory):
    """Of each wall and pillar with at least 20 points of the map: how far off the median of its points is, in metres."""
    wall, off_m = world.offsets(map_points(directory))
    return np.array([abs(np.median(off_m[wall == each])) for each in np.unique(wall) if np.sum(wall == each) >= 20])


def score(arguments):
    """A table of all drives; the exit code is 1 if a promise is not kept."""
    world = World(arguments.world)
    results = Path(arguments.results)
    drives = sorted(results.glob("drive-*-truth.tum"))
    print("| deskewed by | trajectory, m | trajectory, degrees | walls within 3 cm | worst wall, cm |")
    print("|---|---|---|---|---|")
    found = {}
    for how in ("odometry", "scans", "none"):
        rows = []
        for truth in drives:
            name = truth.name.replace("truth.tum", how)
            estimated = results / (name + ".tum")
            walls = wall_errors(world, results / name / "map")
            rows.append((trajectory_error(truth, estimated, metrics.PoseRelation.translation_part),
                         trajectory_error(truth, estimated, metrics.PoseRelation.rotation_angle_deg),
                         100.0 * np.mean(walls <= 0.03), 100.0 * np.max(walls)))
        found[how] = np.array(rows)
        cells = [f"{np.median(column):.{digits}f} ({np.min(column):.{digits}f} to {np.max(column):.{digits}f})"
                 for column, digits in zip(found[how].T, (3, 2, 0, 1))]
        print(f"| {how} | {cells[0]} | {cells[1]} | {cells[2]} % | {cells[3]} |")
    print(f"Medians of {len(drives)} drives, and in brackets the least and the greatest value.")
    missed = []
    for how in ("odometry", "scans"):
        if np.any(found[how][:, 0] > 0.05) or np.any(found[how][:, 1] > 0.5):
            missed.append(f"deskewed by {how}: 0.05 m and 0.5 degrees in each drive")
        if np.any(found[how][:, :2] >= found["none"][:, :2]):
            missed.append(f"deskewed by {how}: better than without in each drive")
        if np.median(found[how][:, 2]) < 90.0:
            missed.append(f"deskewed by {how}: 90 % of the walls within 3 cm")
    for words in missed:
        print(f"Missed: {words}")
    raise SystemExit(1 if missed else 0)


def draw(arguments):
    figure, axes = plt.subplots(figsize=(10, 7), layout="constrained")
    if arguments.world:
        world = World(arguments.world)
        for number, wall in enumerate(zip(world.begins, world.ends)):
            axes.plot(*np.transpose(wall), color="#f0a030", linewidth=3.0, zorder=1,
                      label="_" if number else "walls of the world")
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
    figure.legend(loc="outside lower center", ncols=4, markerscale=6)
    figure.savefig(arguments.out, dpi=100, metadata={"Software": None})


def main():
    parser = argparse.ArgumentParser()
    commands = parser.add_subparsers(required=True)
    for name, run, words in (("trajectory", write_trajectory, ("scans", "poses", "out")),
                             ("score", score, ("results", "world")),
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
