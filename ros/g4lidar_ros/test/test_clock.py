# SPDX-License-Identifier: MIT
"""use_sim_time with a /clock that begins at 100 s, as that of a simulation does: less than the time since the machine was
started. Stamps are times of this clock, and the motion of the robot is known by it: each deskewed point is on a wall of
the room, which this file computes."""

import math
import os
import sys
import threading
import time
import unittest

import launch
import launch_testing.actions
import launch_testing.asserts
from geometry_msgs.msg import TransformStamped
from launch.actions import ExecuteProcess
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan, PointCloud2
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(__file__))
import room  # noqa: E402
import support  # noqa: E402

G4_DUMP = support.program("g4-dump", "G4_DUMP")
DIRECTORY = room.directory()
MOUNT_TEXT = "{},{},{}".format(*room.MOUNT)
# The robot turns on the spot at this speed.
TURN_RAD_PER_S = math.radians(60.0)
BEGIN_S = 100.0

NODES = {
    "robot": {"source": room.moving_source(DIRECTORY), "deskew": "odometry", "mount": MOUNT_TEXT},
    "by_odometry": {"source": os.path.join(DIRECTORY, "odometry"), "deskew": "odometry", "mount": MOUNT_TEXT},
    "by_tf": {"source": os.path.join(DIRECTORY, "tf"), "deskew": "tf", "mount": MOUNT_TEXT},
    "skewed": {"source": os.path.join(DIRECTORY, "none"), "mount": MOUNT_TEXT},
}
PORTS = ["odometry", "tf", "none"]


def generate_test_description():
    nodes = [Node(package="g4lidar_ros", executable="lidar_node", name="g4lidar", namespace=name, output="screen",
                  remappings=[("/tf", "tf")],
                  parameters=[{key: ParameterValue(value, value_type=type(value)) for key, value in
                               {**values, "use_sim_time": True, "autostart": True}.items()}])
             for name, values in NODES.items()]
    devices = [ExecuteProcess(cmd=[G4_DUMP, "sim", "-q", "--world", room.world_file(DIRECTORY), "--path",
                                   room.way_file(DIRECTORY), *(word for port in PORTS for word in
                                                               ("--link", os.path.join(DIRECTORY, port)))])]
    return launch.LaunchDescription([*(devices + nodes if G4_DUMP else []), launch_testing.actions.ReadyToTest()])


class SimulationTime:
    """Publishes /clock, the odometry and the transforms of the robot, 100 times a second."""

    def __init__(self, watcher):
        self.begin = time.monotonic()
        self.clock = watcher.node.create_publisher(Clock, "/clock", 10)
        self.odometry = watcher.node.create_publisher(Odometry, "/by_odometry/odom", 100)
        self.transforms = watcher.node.create_publisher(TFMessage, "/by_tf/tf", 100)
        self.ends = threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def now(self):
        """In nanoseconds."""
        return int((BEGIN_S + time.monotonic() - self.begin) * 1e9)

    def run(self):
        while not self.ends.wait(0.01):
            now = self.now()
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(now, 10**9)
            self.clock.publish(message)
            half = TURN_RAD_PER_S * now * 1e-9 / 2.0
            pose = Odometry(child_frame_id="base_link")
            pose.header.frame_id = "odom"
            pose.header.stamp = message.clock
            pose.pose.pose.orientation.z, pose.pose.pose.orientation.w = math.sin(half), math.cos(half)
            pose.twist.twist.angular.z = TURN_RAD_PER_S
            self.odometry.publish(pose)
            transform = TransformStamped(header=pose.header, child_frame_id=pose.child_frame_id)
            transform.transform.rotation = pose.pose.pose.orientation
            self.transforms.publish(TFMessage(transforms=[transform]))

    def close(self):
        self.ends.set()
        self.thread.join()


@unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
class TestClock(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def test_a_clock_that_begins_at_100_s(self):
        scans = {name: self.watcher.collect(LaserScan, f"/{name}/scan", 100) for name in NODES}
        way = self.watcher.collect(Odometry, "/robot/odom", 1000)
        moving = self.watcher.collect(TFMessage, "/robot/tf", 1000)
        # Before the first /clock, all stamps are 0.
        self.assertTrue(support.wait_for(lambda: all(len(each) > 3 for each in scans.values()) and way and moving))
        self.assertEqual({support.stamp_of(each) for each in [*scans["robot"], *scans["by_tf"], *list(way)]}, {0})
        self.assertEqual({support.stamp_of(each.transforms[0]) for each in list(moving)}, {0})
        clock = SimulationTime(self.watcher)
        try:
            self.check_with(clock, scans, way, moving)
        finally:
            clock.close()

    def check_with(self, clock, scans, way, moving):
        begin = clock.now()
        for name, found in scans.items():
            self.assertTrue(support.wait_for(lambda: support.stamp_of(found[-1]) > begin + 2_000_000_000), name)
            stamps = [support.stamp_of(each) for each in list(found)]
            # The first one may have begun before the clock did.
            known = [each for each in stamps if each > 0][1:]
            self.assertTrue(known, name)
            self.assertGreater(known[0], begin - 1_000_000_000, name)
            self.assertLess(known[-1], clock.now(), name)
        self.check_the_robot(way, moving)
        for name in ("by_odometry", "by_tf"):
            clouds = self.watcher.collect(PointCloud2, f"/{name}/points", 100)
            self.assertTrue(support.wait_for(lambda: self.count_on_walls(clouds) >= 3), name)
        # Without deskewing they are not there: the check can fail.
        clouds = self.watcher.collect(PointCloud2, "/skewed/points", 100)
        self.assertTrue(support.wait_for(lambda: len(clouds) >= 5))
        self.assertEqual(self.count_on_walls(clouds), 0)

    def check_the_robot(self, way, moving):
        """Its odometry and its clouds have the same clock: the points are on the walls that its poses lead to."""
        clouds = self.watcher.collect(PointCloud2, "/robot/points", 100)

        def fitting():
            known = room.Way([each for each in list(way) if support.stamp_of(each) > 0])
            return [each for each in list(clouds)[-5:] if known.times[0] < support.stamp_of(each) < known.times[-1]
                    and room.part(room.errors_m(each, known.at(support.stamp_of(each))), 0.95) < 0.02]
        self.assertTrue(support.wait_for(lambda: len(fitting()) >= 3))
        by_stamp = {support.stamp_of(each): each for each in list(way)}
        both = [each.transforms[0] for each in list(moving) if support.stamp_of(each.transforms[0]) in by_stamp]
        both = [each for each in both if support.stamp_of(each) > 0]
        self.assertGreater(len(both), 10)
        for each in both:
            self.assertEqual(each.transform.rotation, by_stamp[support.stamp_of(each)].pose.pose.orientation)

    def count_on_walls(self, clouds):
        """How many of the newest clouds are those of the room, however the robot has turned in it: this test does not
        know when it began. On a busy machine bytes may be late, so only some must fit."""
        count = 0
        for cloud in list(clouds)[-5:]:
            best = min(room.part(room.errors_m(cloud, (0.0, 0.0, math.radians(turn)), every=10), 0.95)
                       for turn in range(0, 180))
            count += best < 0.05
        return count


@launch_testing.post_shutdown_test()
class TestExit(unittest.TestCase):
    def test_exit_codes(self, proc_info):
        for name in proc_info.process_names():
            if "lidar_node" in name:
                self.assertEqual(proc_info[name].returncode, 0, name)
