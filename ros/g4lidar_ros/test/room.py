# SPDX-License-Identifier: MIT
"""A room of 4 by 3 m with a robot that drives and turns in it, and how far points are from its walls."""

import bisect
import math
import os
import struct
import tempfile

import support

WALLS = """wall -2 -1.5   2 -1.5
wall  2 -1.5   2  1.5
wall  2  1.5  -2  1.5
wall -2  1.5  -2 -1.5
lidar 0 0 0
"""
WAY = """drive forward 0.4 0.5
drive turn 170 90
drive forward 0.4 0.5
"""
# It turns on the spot for ten minutes.
LONG_WAY = "drive turn 3600 60\n" * 10
# Of the lidar on the robot: metres and degrees.
MOUNT = (0.2, -0.1, 90.0)
WORLD = WALLS + "mount {},{},{}\n".format(*MOUNT)


def file_with(directory, name, text):
    path = os.path.join(directory, name)
    with open(path, "w") as file:
        file.write(text)
    return path


def directory():
    return tempfile.mkdtemp(prefix="g4lidar-ros-")


def world_file(directory):
    return file_with(directory, "world.txt", WORLD)


def way_file(directory):
    return file_with(directory, "long.txt", LONG_WAY)


def moving_source(directory):
    """A simulated robot that turns for ten minutes."""
    return f"sim:?world={world_file(directory)}&path={way_file(directory)}&seed=5"


def pose_of(message):
    turn = message.pose.pose.orientation
    return (message.pose.pose.position.x, message.pose.pose.position.y, 2.0 * math.atan2(turn.z, turn.w))


class Way:
    """The true poses of the robot."""

    def __init__(self, messages):
        self.messages = sorted(messages, key=support.stamp_of)
        self.times = [support.stamp_of(each) for each in self.messages]

    def at(self, time_ns):
        after = min(max(bisect.bisect(self.times, time_ns), 1), len(self.times) - 1)
        first, last = self.times[after - 1], self.times[after]
        part = (time_ns - first) / (last - first)
        a, b = pose_of(self.messages[after - 1]), pose_of(self.messages[after])
        turn = math.remainder(b[2] - a[2], math.tau)
        return (a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * turn)

    def turns_at(self, time_ns):
        """Whether the robot turns by more than 45 degrees a second in the next 0.15 s."""
        return abs(math.remainder(self.at(time_ns + 150_000_000)[2] - self.at(time_ns)[2], math.tau)) > 0.12


def moved(pose, point):
    x, y, yaw = pose
    cosine, sine = math.cos(yaw), math.sin(yaw)
    return x + cosine * point[0] - sine * point[1], y + sine * point[0] + cosine * point[1]


def errors_m(cloud, pose, every=1):
    """How far each point of a cloud (or some of them) is from the nearest wall, ascending, if this was the pose of the
    robot."""
    place = (MOUNT[0], MOUNT[1], math.radians(MOUNT[2]))
    found = []
    for i in range(0, cloud.width, every):
        x, y = moved(pose, moved(place, struct.unpack_from("<ff", cloud.data, i * cloud.point_step)))
        found.append(min(abs(abs(x) - 2.0), abs(abs(y) - 1.5)))
    return sorted(found)


def part(values, which):
    """The value that this part of the values, which are ascending, does not exceed."""
    return values[int(len(values) * which)]
