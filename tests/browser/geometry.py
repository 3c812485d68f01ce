# SPDX-License-Identifier: MIT
"""Where the points of a world file belong: an independent calculation."""
import math


class World:
    """The walls of a world file, and where the robot begins. Metres; directions in radians."""

    def __init__(self, path):
        self.walls = []
        self.discs = []
        with open(path, encoding="utf-8") as lines:
            for line in lines:
                words = line.split("#")[0].split()
                if not words:
                    continue
                numbers = [float(word) for word in words[1:] if words[0] in ("wall", "disc", "lidar")]
                if words[0] == "wall":
                    self.walls.append(numbers)
                elif words[0] == "disc":
                    self.discs.append(numbers[:3])
                elif words[0] == "lidar":
                    self.robot = (numbers[0], numbers[1], math.radians(numbers[2]))

    def place(self, x, y):
        """A place of the robot's frame in the world. The worlds mount the lidar so that it looks ahead."""
        east, north, heading = self.robot
        return (east + x * math.cos(heading) - y * math.sin(heading),
                north + x * math.sin(heading) + y * math.cos(heading))

    def distance(self, x, y):
        """From a place of the robot's frame to the nearest wall or disc."""
        here = self.place(x, y)
        walls = (_to_segment(here, wall) for wall in self.walls)
        discs = (abs(math.dist(here, disc[1:]) - disc[0]) for disc in self.discs)
        return min(min(walls), min(discs, default=math.inf))

    def range_at(self, bearing):
        """The range of the first wall at a bearing, counter-clockwise from ahead; inf if there is none."""
        east, north, heading = self.robot
        right, up = math.cos(heading + bearing), math.sin(heading + bearing)
        nearest = math.inf
        for x1, y1, x2, y2 in self.walls:
            dx, dy = x2 - x1, y2 - y1
            across = right * dy - up * dx
            if abs(across) < 1e-12:
                continue
            along = ((x1 - east) * dy - (y1 - north) * dx) / across
            part = ((x1 - east) * up - (y1 - north) * right) / across
            if along > 0 and 0 <= part <= 1:
                nearest = min(nearest, along)
        return nearest


def _to_segment(place, wall):
    x1, y1, x2, y2 = wall
    dx, dy = x2 - x1, y2 - y1
    part = ((place[0] - x1) * dx + (place[1] - y1) * dy) / (dx * dx + dy * dy)
    part = min(1.0, max(0.0, part))
    return math.dist(place, (x1 + part * dx, y1 + part * dy))
