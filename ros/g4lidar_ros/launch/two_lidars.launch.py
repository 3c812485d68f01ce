# SPDX-License-Identifier: MIT
r"""Two lidars in one container, each with its namespace and its frame: /front/scan, /rear/scan.

    ros2 launch g4lidar_ros two_lidars.launch.py front:=/dev/ttyUSB0 rear:=/dev/ttyUSB1
    ros2 launch g4lidar_ros two_lidars.launch.py sim:=true front_mount:=0.2,0,0 rear_mount:=-0.2,0,180
    ros2 launch g4lidar_ros two_lidars.launch.py front:=/dev/ttyUSB0 rear:=/dev/ttyUSB1 \
      frequency:=10.0 rear_model:=x4 rear_range_max:=6.0

Each argument of lidar.launch.py is that of both lidars, and with front_ or rear_ before it that of one.
"""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import ComposableNodeContainer

ONE = os.path.join(get_package_share_directory("g4lidar_ros"), "launch", "lidar.launch.py")


def lidar(context, name, simulated):
    given = context.launch_configurations
    is_simulated = given["sim"].lower() in ("true", "1", "yes", "on")
    source = given[name] or (simulated if is_simulated else "")
    if not source:
        raise RuntimeError(f"argument {name} is missing: /dev/ttyUSB0, serial:NUMBER, ...; or sim:=true")
    own = {key[len(name) + 1:]: value for key, value in given.items() if key.startswith(name + "_")}
    arguments = {"frame_id": name + "_laser", **own, "source": source, "namespace": name, "container": "/lidars",
                 "rviz": "false"}
    return GroupAction([IncludeLaunchDescription(PythonLaunchDescriptionSource(ONE), launch_arguments=arguments.items())])


def lidars(context):
    # With several threads: to open a lidar takes a moment, and must not delay the other one. Not _isolated, which does
    # not end by Ctrl-C in Humble.
    container = ComposableNodeContainer(package="rclcpp_components", executable="component_container_mt",
                                        name="lidars", namespace="", composable_node_descriptions=[])
    # It is last: one that was just started would go on for ever if an argument is refused.
    return [lidar(context, "front", "sim:?seed=1"), lidar(context, "rear", "sim:?seed=2"), container]


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("front", default_value="",
                              description="the lidar in front: /dev/ttyUSB0, serial:NUMBER, sim:, ..."),
        DeclareLaunchArgument("rear", default_value="", description="the lidar behind"),
        DeclareLaunchArgument("sim", default_value="false", description="whether those that are not named are simulated"),
        OpaqueFunction(function=lidars),
    ])
