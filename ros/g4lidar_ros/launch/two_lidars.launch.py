# SPDX-License-Identifier: MIT
r"""Two lidars in one container, each with its namespace and its frame: /front/scan, /rear/scan.

    ros2 launch g4lidar_ros two_lidars.launch.py front:=/dev/ttyUSB0 rear:=/dev/ttyUSB1
    ros2 launch g4lidar_ros two_lidars.launch.py front:='sim:?seed=1' rear:='sim:?seed=2' \
      front_mount:=0.2,0,0 rear_mount:=-0.2,0,180
"""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import ComposableNodeContainer
from launch_ros.descriptions import ComposableNode
from launch_ros.parameter_descriptions import ParameterValue

DEFAULTS = os.path.join(get_package_share_directory("g4lidar_ros"), "config", "lidar.yaml")


def lidar(name):
    return ComposableNode(
        package="g4lidar_ros",
        plugin="g4lidar_ros::LidarNode",
        name="g4lidar",
        namespace=name,
        parameters=[DEFAULTS, {
            "source": ParameterValue(LaunchConfiguration(name), value_type=str),
            "mount": ParameterValue(LaunchConfiguration(name + "_mount"), value_type=str),
            "model": ParameterValue(LaunchConfiguration(name + "_model"), value_type=str),
            "frame_id": name + "_laser",
            "autostart": True,
        }],
        extra_arguments=[{"use_intra_process_comms": True}],
    )


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("front", description="the lidar in front: /dev/ttyUSB0, serial:NUMBER, sim:, ..."),
        DeclareLaunchArgument("rear", description="the lidar behind"),
        *[DeclareLaunchArgument(name + "_mount", default_value="",
                                description="where it is on the robot: X,Y,DEG in metres and degrees")
          for name in ("front", "rear")],
        *[DeclareLaunchArgument(name + "_model", default_value="", description="its model; empty: it is searched")
          for name in ("front", "rear")],
        # With several threads: to open a lidar takes a moment, and must not delay the other one. Not _isolated, which
        # does not end by Ctrl-C in Humble.
        ComposableNodeContainer(package="rclcpp_components", executable="component_container_mt",
                                name="lidars", namespace="",
                                composable_node_descriptions=[lidar("front"), lidar("rear")]),
    ])
