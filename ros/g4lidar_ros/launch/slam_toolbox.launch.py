# SPDX-License-Identifier: MIT
"""A lidar and slam_toolbox: a starting file. It was not run by the developers: slam_toolbox was not at hand.

The robot publishes odom -> base_link, and the place of the lidar base_link -> laser (g4lidar_description).
"""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node

SHARE = get_package_share_directory("g4lidar_ros")


def generate_launch_description():
    return LaunchDescription([
        IncludeLaunchDescription(PythonLaunchDescriptionSource(os.path.join(SHARE, "launch", "lidar.launch.py"))),
        Node(package="slam_toolbox", executable="async_slam_toolbox_node", name="slam_toolbox", output="screen",
             parameters=[os.path.join(SHARE, "config", "slam_toolbox.yaml")]),
    ])
