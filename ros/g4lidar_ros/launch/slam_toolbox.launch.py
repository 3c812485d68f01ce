# SPDX-License-Identifier: MIT
"""A lidar and slam_toolbox. Where its node is a lifecycle node, as after Humble, this file configures and activates it.

    ros2 launch g4lidar_ros slam_toolbox.launch.py source:=walk.mcap use_sim_time:=true

use_sim_time, the frames and the namespace are those of both. The robot publishes odom -> base_link, and the place of the
lidar base_link -> laser (g4lidar_description).
"""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import (DeclareLaunchArgument, EmitEvent, IncludeLaunchDescription, OpaqueFunction,
                            RegisterEventHandler, TimerAction)
from launch.events import matches_action
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import LifecycleNode
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
from launch_ros.ros_adapters import get_ros_node
from lifecycle_msgs.msg import Transition

SHARE = get_package_share_directory("g4lidar_ros")


def check(context):
    if context.launch_configurations.get("order") == "time":
        raise RuntimeError("order:=time is not for slam_toolbox, which would make a wrong map: use order:=angle")
    get_package_share_directory("slam_toolbox")  # before the lidar starts, which would go on if that fails


def driven(context, node):
    """Configures and activates the node when it is seen to be a lifecycle node."""
    if node.return_code is not None or context.is_shutdown:
        return []
    space, _, name = node.node_name.rpartition("/")
    whose, here = (name, space or "/"), get_ros_node(context)
    is_there = whose in here.get_node_names_and_namespaces()
    if not is_there or node.node_name + "/change_state" not in dict(here.get_service_names_and_types_by_node(*whose)):
        return [TimerAction(period=0.5, actions=[OpaqueFunction(function=driven, args=[node])])]
    configure, activate = (
        EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node), transition_id=each))
        for each in (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE))
    return [RegisterEventHandler(OnStateTransition(target_lifecycle_node=node, start_state="configuring",
                                                   goal_state="inactive", entities=[activate])), configure]


def slam_actions(context):
    given = context.launch_configurations
    both = {theirs: given[ours] for ours, theirs in (("base_frame", "base_frame"), ("odometry_frame", "odom_frame"),
                                                     ("use_sim_time", "use_sim_time")) if given[ours]}
    if "use_sim_time" in both:
        both["use_sim_time"] = both["use_sim_time"].lower() in ("true", "1", "yes", "on")
    if given["namespace"]:
        both["scan_topic"] = "/" + given["namespace"].strip("/") + "/scan"
    node = LifecycleNode(package="slam_toolbox", executable="async_slam_toolbox_node", name="slam_toolbox",
                         namespace="", output="screen", parameters=[given["slam_params_file"], both])
    is_driven = given.get("autostart", "").lower() not in ("false", "0", "no", "off")
    return [node, OpaqueFunction(function=driven, args=[node])] if is_driven else [node]


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("slam_params_file", default_value=os.path.join(SHARE, "config", "slam_toolbox.yaml"),
                              description="file of parameters of slam_toolbox"),
        OpaqueFunction(function=check),
        IncludeLaunchDescription(PythonLaunchDescriptionSource(os.path.join(SHARE, "launch", "lidar.launch.py"))),
        OpaqueFunction(function=slam_actions),
    ])
