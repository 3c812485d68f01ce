# SPDX-License-Identifier: MIT
"""Deskewing by a subscribed odometry and by tf: each point of a robot that turns is on a wall of the room, which this
file computes from the true poses. Also a recording that is played twice, and the time of /clock."""

import math
import os
import sys
import unittest

import launch
import launch_testing.actions
import launch_testing.asserts
from geometry_msgs.msg import TransformStamped
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from lifecycle_msgs.msg import State, Transition
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan, PointCloud2
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(__file__))
import room  # noqa: E402
import support  # noqa: E402

MOUNT_TEXT = "{},{},{}".format(*room.MOUNT)
WITH_ODOMETRY, BARE = support.recordings(seconds=5, seed=3, world=room.WORLD, way=room.WAY)

# The nodes by their namespaces.
NODES = {
    "known": {"source": WITH_ODOMETRY},
    "by_odometry": {"source": BARE, "deskew": "odometry", "mount": MOUNT_TEXT},
    "by_tf": {"source": BARE, "deskew": "tf", "mount": MOUNT_TEXT},
    "live": {"source": "sim:?seed=4", "use_sim_time": True, "autostart": True},
    "robot": {"source": "", "mount": MOUNT_TEXT, "autostart": True, "deskew": "odometry"},
}


def generate_test_description():
    if not BARE:
        return launch.LaunchDescription([launch_testing.actions.ReadyToTest()])
    NODES["robot"]["source"] = room.moving_source(os.path.dirname(BARE))
    nodes = [Node(package="g4lidar_ros", executable="lidar_node", name="g4lidar", namespace=name, output="screen",
                  remappings=[("/tf", "tf")],
                  parameters=[{key: ParameterValue(value, value_type=type(value)) for key, value in values.items()}])
             for name, values in NODES.items()]
    return launch.LaunchDescription([*nodes, launch_testing.actions.ReadyToTest()])


@unittest.skipUnless(BARE, "SKIPPED: g4-dump is not installed")
class TestMotion(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def play(self, name):
        """Plays the recording of a node once: its odometry and its clouds."""
        way = self.watcher.collect(Odometry, f"/{name}/odom", 1000)
        clouds = self.watcher.collect(PointCloud2, f"/{name}/points", 100)
        self.watcher.wait_for_publishers(f"/{name}/points", 1)
        self.assertTrue(self.watcher.change_state(f"/{name}/g4lidar", Transition.TRANSITION_ACTIVATE))
        self.assertTrue(support.wait_for(
            lambda: self.watcher.state(f"/{name}/g4lidar") == State.PRIMARY_STATE_INACTIVE))
        return list(way), list(clouds)

    def truth(self):
        if self.watcher.state("/known/g4lidar") == State.PRIMARY_STATE_UNCONFIGURED:
            self.assertTrue(self.watcher.change_state("/known/g4lidar", Transition.TRANSITION_CONFIGURE))
        way, clouds = self.play("known")
        self.assertGreater(len(way), 200)
        self.assertGreater(len(clouds), 25)
        return room.Way(way), clouds

    def check_deskewed(self, name, publish, count_of_subscribers):
        """`publish` is called with each true pose, a little before the lidar gets there."""
        way, skewed = self.truth()
        self.assertTrue(self.watcher.change_state(f"/{name}/g4lidar", Transition.TRANSITION_CONFIGURE))
        self.assertTrue(support.wait_for(lambda: count_of_subscribers() > 0), "it does not subscribe")
        next_pose = 0

        def publish_until(time_ns):
            nonlocal next_pose
            while next_pose < len(way.times) and way.times[next_pose] <= time_ns:
                publish(way.messages[next_pose])
                next_pose += 1
        ahead_ns = 700_000_000
        publish_until(way.times[0] + ahead_ns)
        self.watcher.node.create_subscription(
            Clock, "/clock", lambda now: publish_until(now.clock.sec * 10**9 + now.clock.nanosec + ahead_ns), 10)
        _, clouds = self.play(name)
        turning = [each for each in clouds if way.turns_at(support.stamp_of(each))]
        self.assertGreater(len(turning), 5)
        for cloud in turning:
            errors = room.errors_m(cloud, way.at(support.stamp_of(cloud)))
            self.assertGreater(len(errors), 1000)
            self.assertLess(room.part(errors, 0.95), 0.01)
        # Without deskewing they are not there: the check can fail.
        for cloud in skewed:
            if way.turns_at(support.stamp_of(cloud)):
                errors = room.errors_m(cloud, way.at(support.stamp_of(cloud)))
                self.assertGreater(room.part(errors, 0.95), 0.05)

    def test_by_subscribed_odometry(self):
        publisher = self.watcher.node.create_publisher(Odometry, "/by_odometry/odom", 1000)
        self.check_deskewed("by_odometry", publisher.publish, publisher.get_subscription_count)

    def test_by_tf(self):
        publisher = self.watcher.node.create_publisher(TFMessage, "/by_tf/tf", 1000)

        def publish(at):
            made = TransformStamped(header=at.header, child_frame_id=at.child_frame_id)
            made.transform.translation.x = at.pose.pose.position.x
            made.transform.translation.y = at.pose.pose.position.y
            made.transform.rotation = at.pose.pose.orientation
            publisher.publish(TFMessage(transforms=[made]))
        self.check_deskewed("by_tf", publish, publisher.get_subscription_count)

    def test_a_recording_that_is_activated_again_is_played_again(self):
        first, first_clouds = self.truth()
        second, second_clouds = self.truth()
        self.assertGreater(len(second.messages), len(first.messages) * 9 // 10)
        self.assertGreater(len(second_clouds), len(first_clouds) * 9 // 10)

    def test_use_sim_time_is_the_time_of_the_recording(self):
        clock = self.watcher.collect(Clock, "/clock", 1000)
        scans = self.watcher.collect(LaserScan, "/live/scan", 100)
        self.assertTrue(support.wait_for(lambda: scans))
        self.truth()
        played = [each.clock.sec * 10**9 + each.clock.nanosec for each in list(clock)]
        during = [each for each in list(scans) if played[0] <= support.stamp_of(each) <= played[-1]]
        # 5 s at 7 Hz; the time since the recording was made is longer than that of a scan.
        self.assertGreater(len(during), 15)
        # When the recording has ended, time stands: stamps stay near the last one.
        self.assertTrue(support.wait_for(lambda: abs(support.stamp_of(scans[-1]) - played[-1]) < 1_000_000_000))

    def test_a_simulated_robot_publishes_its_odometry(self):
        way = self.watcher.collect(Odometry, "/robot/odom", 1000)
        moving = self.watcher.collect(TFMessage, "/robot/tf", 1000)
        clouds = self.watcher.collect(PointCloud2, "/robot/points", 100)
        self.assertTrue(support.wait_for(lambda: len(way) > 100 and len(moving) > 100 and len(clouds) > 10))
        times = [support.stamp_of(each) for each in list(way)]
        # 50 times a second; a busy subscriber may miss some.
        for earlier, later in zip(times, times[1:]):
            self.assertLess(abs((later - earlier + 10_000_000) % 20_000_000 - 10_000_000), 1_000_000)
        self.assertEqual(moving[-1].transforms[0].child_frame_id, "base_link")
        # On a busy machine bytes may be late, and with them the times of their points: only some clouds must fit. One
        # whose odometry is late by a tenth of a second, or that is not deskewed, never does.
        self.assertTrue(support.wait_for(lambda: self.count_of_exact(list(clouds)[-5:], room.Way(list(way))) >= 3))

    def count_of_exact(self, clouds, way):
        known = [each for each in clouds if way.times[0] < support.stamp_of(each) < way.times[-1]]
        errors = [room.errors_m(each, way.at(support.stamp_of(each))) for each in known]
        return sum(room.part(each, 0.95) < 0.02 for each in errors)


@launch_testing.post_shutdown_test()
class TestExit(unittest.TestCase):
    def test_exit_codes(self, proc_info):
        launch_testing.asserts.assertExitCodes(proc_info)
