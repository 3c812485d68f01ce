# SPDX-License-Identifier: MIT
"""The launch file plays a recording, and its messages are those of g4-ros2 from the same recording."""

import math
import os
import sys
import unittest

import launch
import launch_testing.actions
from launch.actions import ExecuteProcess, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from ament_index_python.packages import get_package_share_directory
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan, PointCloud2
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402

RECORDING, _ = support.recordings()
MOUNT = "0.2,-0.1,90"
G4_ROS2 = support.program("g4-ros2", "G4_ROS2")


def generate_test_description():
    share = get_package_share_directory("g4lidar_ros")
    actions = []
    if RECORDING:
        actions.append(IncludeLaunchDescription(
            AnyLaunchDescriptionSource(os.path.join(share, "launch", "lidar.launch.py")),
            launch_arguments={"source": RECORDING, "loop": "true", "deskew": "odometry", "mount": MOUNT}.items()))
    if RECORDING and G4_ROS2:
        actions.append(ExecuteProcess(cmd=[G4_ROS2, RECORDING, "--loop", "--namespace", "reference",
                                           "--deskew", "odometry", "--mount", MOUNT]))
    return launch.LaunchDescription([*actions, launch_testing.actions.ReadyToTest()])


def same(a, b):
    """Whether two lists of floats are equal, bit by bit."""
    return len(a) == len(b) and all(x == y or (math.isnan(x) and math.isnan(y)) for x, y in zip(a, b))


@unittest.skipUnless(RECORDING, "SKIPPED: g4-dump is not installed")
class TestRecording(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def test_publishes_the_room(self):
        scans = self.watcher.collect(LaserScan, "/scan")
        clouds = self.watcher.collect(PointCloud2, "/points")
        self.assertTrue(support.wait_for(lambda: len(scans) > 3 and len(clouds) > 3))
        scan = scans[-1]
        self.assertEqual(scan.header.frame_id, "laser")
        self.assertEqual(len(scan.ranges), 720)
        self.assertAlmostEqual(scan.angle_min, -math.pi, places=5)
        self.assertAlmostEqual(scan.angle_increment, 2 * math.pi / 720, places=7)
        self.assertAlmostEqual(scan.range_min, 0.1, places=6)
        # The built-in world is an apartment: most of it is within 6 m.
        self.assertGreater(sum(0.1 <= each < 6.0 for each in scan.ranges), 500)
        self.assertEqual([field.name for field in clouds[-1].fields], ["x", "y", "z", "t", "range", "angle"])

    @unittest.skipUnless(G4_ROS2, "SKIPPED: g4-ros2 is not installed")
    def test_numbers_are_those_of_g4_ros2(self):
        ours = self.watcher.collect(LaserScan, "/scan")
        theirs = self.watcher.collect(LaserScan, "/reference/scan")
        our_way = self.watcher.collect(Odometry, "/odom")
        their_way = self.watcher.collect(Odometry, "/reference/odom")
        our_clouds = self.watcher.collect(PointCloud2, "/points")
        their_clouds = self.watcher.collect(PointCloud2, "/reference/points")

        # Both repeat the recording, with times that continue: revolutions with equal stamps are the same ones.
        def pairs(ours_now, theirs_now):
            by_stamp = {support.stamp_of(each): each for each in list(theirs_now)}
            return [(each, by_stamp[support.stamp_of(each)]) for each in list(ours_now) if support.stamp_of(each) in by_stamp]

        self.assertTrue(support.wait_for(
            lambda: len(pairs(ours, theirs)) >= 10 and len(pairs(our_clouds, their_clouds)) >= 10
            and len(pairs(our_way, their_way)) >= 10),
            f"{len(ours)} and {len(theirs)} scans, {len(pairs(ours, theirs))} with equal stamps")
        for mine, other in pairs(ours, theirs):
            self.assertTrue(same(mine.ranges, other.ranges))
            self.assertTrue(same(mine.intensities, other.intensities))
            for name in ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min",
                         "range_max"):
                self.assertEqual(getattr(mine, name), getattr(other, name), name)
            self.assertEqual(mine.header.frame_id, other.header.frame_id)
        for mine, other in [*pairs(our_clouds, their_clouds), *pairs(our_way, their_way)]:
            self.assertEqual(mine, other)

    def test_transforms_and_the_clock(self):
        moving = self.watcher.collect(TFMessage, "/tf", 100)
        quality = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        fixed = self.watcher.collect(TFMessage, "/tf_static", quality)
        clock = self.watcher.collect(Clock, "/clock")
        self.assertTrue(support.wait_for(lambda: moving and fixed and len(clock) > 5))
        frames = {(each.header.frame_id, each.child_frame_id)
                  for message in list(moving) for each in message.transforms}
        self.assertEqual(frames, {("odom", "base_link")})
        place = fixed[0].transforms[0]
        self.assertEqual((place.header.frame_id, place.child_frame_id), ("base_link", "laser"))
        self.assertAlmostEqual(place.transform.translation.x, 0.2)
        self.assertAlmostEqual(place.transform.rotation.z, math.sqrt(0.5))
