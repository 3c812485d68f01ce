# SPDX-License-Identifier: MIT
"""Two lidars in one container."""

import os
import sys
import unittest

import launch
import launch_testing.actions
import launch_testing.asserts
from ament_index_python.packages import get_package_share_directory
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from composition_interfaces.srv import ListNodes
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402


def generate_test_description():
    launches = os.path.join(get_package_share_directory("g4lidar_ros"), "launch")
    return launch.LaunchDescription([
        IncludeLaunchDescription(AnyLaunchDescriptionSource(os.path.join(launches, "two_lidars.launch.py")),
                                 launch_arguments={"front": "sim:?seed=1", "rear": "sim:?seed=2", "front_mount": "0.2,0,0",
                                                   "rear_mount": "-0.2,0,180"}.items()),
        IncludeLaunchDescription(AnyLaunchDescriptionSource(os.path.join(launches, "lidar.launch.xml")),
                                 launch_arguments={"sim": "true", "namespace": "xml"}.items()),
        launch_testing.actions.ReadyToTest(),
    ])


class TestContainer(unittest.TestCase):
    def test_each_has_its_topic_and_frame(self):
        watcher = support.Watcher()
        frames = {"front": "front_laser", "rear": "rear_laser", "xml": "laser"}
        scans = {name: watcher.collect(LaserScan, f"/{name}/scan") for name in frames}
        self.assertTrue(support.wait_for(lambda: all(len(each) > 3 for each in scans.values())),
                        {name: len(each) for name, each in scans.items()})
        for name, frame in frames.items():
            self.assertEqual(scans[name][-1].header.frame_id, frame)
        # Both share the transforms of the process: each has a place.
        quality = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        places = watcher.collect(TFMessage, "/tf_static", quality)

        def children():
            return {each.child_frame_id for message in list(places) for each in message.transforms}
        self.assertTrue(support.wait_for(lambda: children() >= {"front_laser", "rear_laser"}), children())
        # One process: both nodes are components of the container.
        listed = watcher.call(ListNodes, "/lidars/_container/list_nodes", ListNodes.Request())
        self.assertEqual(sorted(listed.full_node_names), ["/front/g4lidar", "/rear/g4lidar"])
        watcher.close()


@launch_testing.post_shutdown_test()
class TestExit(unittest.TestCase):
    def test_exit_codes(self, proc_info):
        launch_testing.asserts.assertExitCodes(proc_info)
