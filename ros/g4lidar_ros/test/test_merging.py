# SPDX-License-Identifier: MIT
"""Two simulated lidars in two halves of a room, with a wall between them: the merged scan has the walls of both halves,
where this file knows them to be."""

import math
import os
import struct
import sys
import unittest

import launch
import launch_testing.actions
import launch_testing.asserts
from diagnostic_msgs.msg import DiagnosticArray
from launch_ros.actions import Node
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParametersAtomically
from sensor_msgs.msg import LaserScan, PointCloud2

sys.path.insert(0, os.path.dirname(__file__))
import room  # noqa: E402
import support  # noqa: E402

HALF_LENGTH, HALF_WIDTH = 2.0, 1.5
WALLS = f"""wall -2 -1.5  2 -1.5
wall  2 -1.5  2  1.5
wall  2  1.5 -2  1.5
wall -2  1.5 -2 -1.5
wall  0 -1.5  0  1.5
"""
DIRECTORY = room.directory()
SERIALS = {"front": "1111111111111111", "rear": "2222222222222222"}
MOUNTS = {"front": "1,0.2,0", "rear": "-1,-0.3,180"}


def source(name):
    world = room.file_with(DIRECTORY, name + ".txt", WALLS + f"lidar 0 0 0\nmount {MOUNTS[name]}\n")
    return f"{name}=sim:?world={world}&serial={SERIALS[name]}"


def generate_test_description():
    parameters = {"sources": [source(name) for name in MOUNTS], "autostart": True, "frame_id": "unused",
                  "mounts": [f"{name}={mount}" for name, mount in MOUNTS.items()]}
    # An X2 takes no settings.
    mixed = {"sources": [source("front"), "rear=sim:?model=x2"], "autostart": True}
    nodes = [Node(package="g4lidar_ros", executable="lidar_node", name="g4lidar", namespace=name, output="screen",
                  parameters=[values]) for name, values in (("merged", parameters), ("mixed", mixed))]
    return launch.LaunchDescription([*nodes, launch_testing.actions.ReadyToTest()])


def points_of(cloud):
    return [struct.unpack_from("<ff", cloud.data, i * cloud.point_step) for i in range(cloud.width)]


class TestMerging(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def set(self, node, **values):
        """All or none of these numbers."""
        parameters = [Parameter(name=name, value=ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value))
                      for name, value in values.items()]
        request = SetParametersAtomically.Request(parameters=parameters)
        return self.watcher.call(SetParametersAtomically, f"/{node}/g4lidar/set_parameters_atomically", request).result

    def get(self, node, *names):
        request = GetParameters.Request(names=names)
        values = self.watcher.call(GetParameters, f"/{node}/g4lidar/get_parameters", request).values
        return [each.double_value for each in values]

    def test_the_cloud_has_the_walls_of_both(self):
        clouds = self.watcher.collect(PointCloud2, "/merged/points")
        # 9000 samples a second at 7 Hz of each lidar, all with a return.
        self.assertTrue(support.wait_for(lambda: clouds and clouds[-1].width > 2000), [each.width for each in clouds[-1:]])
        self.assertEqual(clouds[-1].header.frame_id, "base_link")
        found = points_of(clouds[-1])
        errors = sorted(min(abs(abs(x) - HALF_LENGTH), abs(abs(y) - HALF_WIDTH), abs(x)) for x, y in found)
        self.assertLess(room.part(errors, 0.95), 0.03)
        for side in (-1, 1):
            self.assertGreater(sum(x * side > 0.1 for x, _ in found), 700)

    def test_the_scan_has_the_corners_of_both(self):
        scans = self.watcher.collect(LaserScan, "/merged/scan")

        def at(scan, degrees):
            return scan.ranges[round((math.radians(degrees) - scan.angle_min) / scan.angle_increment) % len(scan.ranges)]

        def misses():
            """By how much the walls at the sides are missed, which only one of the lidars sees."""
            return [abs(at(scans[-1], each) - HALF_WIDTH * math.sqrt(2.0)) for each in (45, 135, -135, -45)]
        self.assertTrue(support.wait_for(lambda: scans and max(misses()) < 0.05), scans and misses())
        self.assertEqual(scans[-1].header.frame_id, "base_link")

    def test_diagnostics_have_the_names(self):
        messages = self.watcher.collect(DiagnosticArray, "/diagnostics")

        def statuses():
            return {each.name.removeprefix("/merged/g4lidar: "): each for message in list(messages) for each in message.status}
        self.assertTrue(support.wait_for(lambda: all(
            f"{name} state" in statuses() and statuses()[f"{name} state"].hardware_id == serial
            for name, serial in SERIALS.items())))
        self.assertGreaterEqual(set(statuses()), {"front motor", "rear motor", "rear counts", "merging", "deskewing", "topics"})
        self.assertNotIn("state", statuses())

        def lost():
            return {each.key: each.value for each in statuses()["merging"].values}
        self.assertTrue(support.wait_for(lambda: int(lost().get("scans", "0")) > 0))
        self.assertLessEqual({"scans_without_front", "scans_without_rear"}, set(lost()))

    def test_settings_are_those_of_both(self):
        names = ("frequency", "device.frequency")
        self.assertTrue(support.wait_for(lambda: self.get("merged", *names) == [0.0, 7.0]), self.get("merged", *names))
        done = self.set("merged", frequency=9.0)
        self.assertTrue(done.successful, done.reason)
        scans = self.watcher.collect(LaserScan, "/merged/scan")
        self.assertTrue(support.wait_for(lambda: scans and abs(scans[-1].scan_time - 1 / 9.0) < 0.005))
        self.assertTrue(support.wait_for(lambda: self.get("merged", *names) == [9.0, 9.0]), self.get("merged", *names))
        self.assertFalse(self.set("merged", frequency=14.0).successful)  # a G4 has 5 to 12 Hz
        self.assertEqual(self.get("merged", *names), [9.0, 9.0])
        self.assertTrue(self.set("merged", frequency=7.0).successful)

    def test_what_one_of_them_refuses_is_undone(self):
        messages = self.watcher.collect(DiagnosticArray, "/diagnostics")

        def front():
            """The frequency of the first lidar, Hz."""
            found = [pair.value for message in list(messages) for each in message.status for pair in each.values
                     if each.name == "/mixed/g4lidar: front state" and pair.key == "frequency"]
            return float(found[-1]) if found else None
        self.assertTrue(support.wait_for(lambda: front() == 7.0), front())
        refused = self.set("mixed", frequency=9.0, range_max=1.5)
        self.assertFalse(refused.successful)
        self.assertTrue(refused.reason.startswith("rear: "), refused.reason)
        self.assertEqual(self.get("mixed", "frequency", "range_max"), [0.0, 100.0])
        scans = self.watcher.collect(LaserScan, "/mixed/scan")
        del messages[:]
        self.assertTrue(support.wait_for(lambda: front() is not None and len(scans) > 2))
        self.assertEqual(front(), 7.0)
        self.assertAlmostEqual(scans[-1].scan_time, 1 / 7.0, delta=0.01)
        self.assertGreater(scans[-1].range_max, 1.6)


@launch_testing.post_shutdown_test()
class TestExit(unittest.TestCase):
    def test_exit_codes(self, proc_info):
        launch_testing.asserts.assertExitCodes(proc_info)
