# SPDX-License-Identifier: MIT
"""Each model of the table runs with what the launch file has by default, which sets nothing that a model may lack."""

import os
import re
import subprocess
import sys
import unittest

import launch
import launch_testing.actions
import launch_testing.asserts
from ament_index_python.packages import get_package_share_directory
from launch.actions import GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch_ros.actions import Node
from sensor_msgs.msg import LaserScan

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402

G4_DUMP = support.program("g4-dump", "G4_DUMP")


def model_words():
    """Each model of the table; none without g4-dump."""
    if not G4_DUMP:
        return []
    done = subprocess.run([G4_DUMP, "scan", "--model", "none", "sim:"], capture_output=True, text=True, check=False)
    return re.search(r"is not one of (.*)\. See", done.stderr).group(1).split(", ")


WORDS = model_words()
NAMESPACES = {word: word.replace("-", "_") for word in WORDS}


def generate_test_description():
    path = os.path.join(get_package_share_directory("g4lidar_ros"), "launch", "lidar.launch.py")
    # In one process, as Cyclone DDS with Humble has room for 10.
    return launch.LaunchDescription([
        Node(package="rclcpp_components", executable="component_container_mt", name="models"),
        *(GroupAction([IncludeLaunchDescription(AnyLaunchDescriptionSource(path), launch_arguments={
            "container": "/models", "source": f"sim:?model={word}", "namespace": name}.items())])
          for word, name in NAMESPACES.items()),
        launch_testing.actions.ReadyToTest(),
    ])


class TestEachModel(unittest.TestCase):
    @unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
    def test_each_model_with_the_defaults(self):
        watcher = support.Watcher()
        self.addCleanup(watcher.close)
        self.assertGreater(len(WORDS), 30)
        scans = {word: watcher.collect(LaserScan, f"/{name}/scan") for word, name in NAMESPACES.items()}
        self.assertTrue(support.wait_for(lambda: all(scans.values())), [word for word in WORDS if not scans[word]])
        for word, found in scans.items():
            self.assertGreater(sum(each < found[-1].range_max for each in found[-1].ranges), 50, word)


@launch_testing.post_shutdown_test()
class TestExit(unittest.TestCase):
    def test_exit_codes(self, proc_info):
        launch_testing.asserts.assertExitCodes(proc_info)
