# SPDX-License-Identifier: MIT
"""robot_state_publisher with the example: the place of `laser` on /tf_static, and the housing for rviz.

    ros2 launch g4lidar_description description.launch.py housing:=x4
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import Command, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    file = PathJoinSubstitution([FindPackageShare("g4lidar_description"), "urdf", "example.urdf.xacro"])
    text = Command(["xacro ", file, " housing:=", LaunchConfiguration("housing")])
    return LaunchDescription([
        DeclareLaunchArgument("housing", default_value="g4", description="g4, g2, x4, x2, t_mini or tg"),
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{"robot_description": ParameterValue(text, value_type=str)}]),
    ])
