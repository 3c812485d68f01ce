# SPDX-License-Identifier: MIT
"""A lifecycle manager: configure does not wait for the lidar, nothing else configures the node, and there is a bond."""

import os
import pty
import sys
import tempfile
import time
import unittest

import launch
import launch_testing.actions
import launch_testing.asserts
from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch.actions import GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch_ros.actions import Node
from lifecycle_msgs.msg import State, Transition, TransitionEvent
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402

UP = (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE)
# A port at which something is that does not answer: the lidar is searched there for long.
SILENT, SILENT_END = pty.openpty()


def has_stand_in():
    """Whether the package that the tests have for bondcpp is used: its messages are texts."""
    try:
        return not os.path.isdir(os.path.join(get_package_prefix("bondcpp"), "share", "bond"))
    except LookupError:
        return False


def launched(**arguments):
    path = os.path.join(get_package_share_directory("g4lidar_ros"), "launch", "lidar.launch.py")
    return GroupAction([IncludeLaunchDescription(AnyLaunchDescriptionSource(path), launch_arguments=arguments.items())])


def generate_test_description():
    bond = {"bond_heartbeat_period": 0.05} if has_stand_in() else {}
    return launch.LaunchDescription([
        launched(namespace="managed", source="sim:?seed=1", autostart="false"),
        launched(namespace="itself", source="sim:?seed=2"),
        Node(package="rclcpp_components", executable="component_container", name="container"),
        launched(namespace="composed", source="sim:?seed=3", container="/container", autostart="false"),
        Node(package="g4lidar_ros", executable="lidar_node", name="g4lidar", namespace="silent",
             parameters=[{"source": os.ttyname(SILENT_END)}]),
        Node(package="g4lidar_ros", executable="lidar_node", name="g4lidar", namespace="gives_up",
             parameters=[{"source": os.path.join(tempfile.mkdtemp(), "absent"), "connect_timeout": 0.5}]),
        Node(package="g4lidar_ros", executable="lidar_node", name="g4lidar", namespace="bound",
             parameters=[{"source": "sim:?seed=4", **bond}]),
        launch_testing.actions.ReadyToTest(),
    ])


class TestManager(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def state(self, name):
        return self.watcher.state(f"/{name}/g4lidar")

    def change(self, name, *transitions):
        for each in transitions:
            self.assertTrue(self.watcher.change_state(f"/{name}/g4lidar", each), each)

    def test_nothing_else_configures_it(self):
        scans = self.watcher.collect(LaserScan, "/itself/scan")
        self.assertTrue(support.wait_for(lambda: scans))  # as long as that takes, the others could do the same
        for name in ("managed", "composed"):
            events = self.watcher.collect(TransitionEvent, f"/{name}/g4lidar/transition_event")
            self.assertEqual(self.state(name), State.PRIMARY_STATE_UNCONFIGURED)
            self.change(name, *UP)
            self.assertEqual(self.state(name), State.PRIMARY_STATE_ACTIVE)
            self.assertTrue(support.wait_for(lambda: events and events[-1].goal_state.label == "active"))
            self.assertEqual([each.goal_state.label for each in events],
                             ["configuring", "inactive", "activating", "active"])

    def test_configure_does_not_wait_for_the_lidar(self):
        times = []
        for _ in range(3):  # a busy machine may delay some
            begin = time.monotonic()
            self.change("silent", UP[0])
            times.append(time.monotonic() - begin)
            self.change("silent", UP[1])
            self.assertEqual(self.state("silent"), State.PRIMARY_STATE_ACTIVE)
            self.change("silent", Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_CLEANUP)
        # Before, it waited for 10 s, and failed. An idle machine needs less than 0.1 s.
        self.assertLess(min(times), 2.0)

    def test_without_a_lidar_it_gives_up_when_that_is_wanted(self):
        for transitions in (UP[:1], UP):  # while it is inactive, and while it is active
            events = self.watcher.collect(TransitionEvent, "/gives_up/g4lidar/transition_event")
            self.watcher.wait_for_publishers("/gives_up/g4lidar/transition_event", 1)
            for each in transitions:
                self.watcher.change_state("/gives_up/g4lidar", each)
            self.assertTrue(support.wait_for(lambda: events and events[-1].goal_state.label == "unconfigured"))

    def test_the_bond_is_there_while_it_is_active(self):
        if not has_stand_in():
            self.skipTest("SKIPPED: the package in test/bondcpp was not built")
        texts = self.watcher.collect(String, "/bound/bond", 100)
        self.change("bound", UP[0])
        self.assertEqual(texts, [])
        self.change("bound", UP[1])
        self.assertTrue(support.wait_for(lambda: len(texts) > 5))
        self.assertEqual({each.data for each in texts}, {"g4lidar alive"})
        self.change("bound", Transition.TRANSITION_DEACTIVATE)
        self.assertTrue(support.wait_for(lambda: texts[-1].data == "g4lidar dead"))


@launch_testing.post_shutdown_test()
class TestExit(unittest.TestCase):
    def test_exit_codes(self, proc_info):
        for name in proc_info.process_names():
            if "lidar_node" in name:
                self.assertEqual(proc_info[name].returncode, 0, name)
