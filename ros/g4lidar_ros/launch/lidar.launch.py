# SPDX-License-Identifier: MIT
"""One lidar as a lifecycle node, which this file configures and activates.

    ros2 launch g4lidar_ros lidar.launch.py
    ros2 launch g4lidar_ros lidar.launch.py sim:=true rviz:=true
    ros2 launch g4lidar_ros lidar.launch.py source:=/dev/ttyUSB0 frame_id:=front_laser
    ros2 launch g4lidar_ros lidar.launch.py container:=/my_container

A launch file that includes it twice puts each into a GroupAction, as arguments are passed on to what follows.
"""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, OpaqueFunction, RegisterEventHandler, TimerAction
from launch.conditions import IfCondition
from launch.events import matches_action
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LifecycleNode, LoadComposableNodes, Node
from launch_ros.descriptions import ComposableNode
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
from launch_ros.parameter_descriptions import ParameterValue
from lifecycle_msgs.msg import Transition

# How long after a failure configure is tried again.
RETRY_SECONDS = 2.0
SHARE = get_package_share_directory("g4lidar_ros")

# The parameters that are also arguments, with their types. An argument that is not given stays as in the file.
PARAMETERS = {
    "source": (str, "the lidar or the recording; empty: the only lidar"),
    "model": (str, "the model of the lidar; empty: it is searched, or that of the recording"),
    "baud": (int, "bits per second; 0: those of the model"),
    "frame_id": (str, "frame of the scans"),
    "grid": (int, "ranges of each LaserScan; 0: those of the model"),
    "order": (str, "order of the ranges of a LaserScan: angle or time"),
    "mount": (str, "where the lidar is on the robot: X,Y,DEG in metres and degrees"),
    "deskew": (str, "deskew by scans, odometry or tf; none"),
    "base_frame": (str, "frame of the robot"),
    "odometry_frame": (str, "frame of the odometry"),
    "mask": (str, "file of polygons, parts of the robot that are left out"),
    "standby": (bool, "whether the motor rests while nobody subscribes"),
    "loop": (bool, "whether a recording starts again at its end"),
    "playback_speed": (float, "speed of a recording"),
    "connect_timeout": (float, "how long configure waits for the lidar, seconds"),
    "use_sim_time": (bool, "whether the time is that of /clock"),
    "range_min": (float, "returns that are nearer are left out, m"),
    "range_max": (float, "returns that are farther are left out, m"),
    "fov": (str, "directions that are kept, degrees: -90:90"),
    "ignore": (str, "directions that are left out, degrees: 30:40 90:100"),
    "speckle": (str, "on: returns without another one near them are left out"),
    "edges": (str, "on: veiling points at jumps of the range are left out"),
    "near": (str, "on: flag directions where something may be too near for a return"),
    "near_as": (str, "what ranges become that near flags: nan or minus-inf"),
    "no_return": (str, "what ranges without return become: inf, nan or max"),
    "frequency": (float, "revolutions per second, Hz"),
    "sample_rate": (int, "samples per second, Hz"),
    "direction": (str, "direction of rotation: cw or ccw"),
    "constant": (bool, "whether the lidar regulates its frequency"),
    "idle": (bool, "whether the motor stops when it is idle"),
    "protection": (bool, "whether it stops when the host sends nothing for 3 s"),
}


def is_true(word):
    if word.lower() not in ("true", "1", "yes", "on", "false", "0", "no", "off"):
        raise ValueError(f"'{word}' is not true or false")
    return word.lower() in ("true", "1", "yes", "on")


def converted(name, kind, word):
    """The value of an argument; its name is in what is wrong with it."""
    try:
        return is_true(word) if kind is bool else kind(word)
    except ValueError as wrong:
        raise ValueError(f"argument {name}: {wrong}") from None


def given_parameters(context):
    """The arguments that were given, as parameters."""
    made = {}
    for name, (kind, _) in PARAMETERS.items():
        word = LaunchConfiguration(name).perform(context)
        if word == "":
            continue
        if kind is str:  # a text as it is, although it may look like YAML
            made[name] = ParameterValue(word, value_type=str)
        else:
            made[name] = converted(name, kind, word)
    if converted("sim", bool, LaunchConfiguration("sim").perform(context)) and "source" not in made:
        made["source"] = ParameterValue("sim:", value_type=str)
    return made


def driven(node):
    """The actions that configure a lifecycle node, again until there is a lidar, and then activate it."""

    def change(transition):
        return EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node), transition_id=transition))

    return [
        RegisterEventHandler(
            OnStateTransition(
                target_lifecycle_node=node,
                start_state="configuring",
                goal_state="inactive",
                entities=[change(Transition.TRANSITION_ACTIVATE)],
            )
        ),
        # There is no lidar: it may be plugged in later. After wrong parameters the state before is errorprocessing.
        RegisterEventHandler(
            OnStateTransition(
                target_lifecycle_node=node,
                start_state="configuring",
                goal_state="unconfigured",
                entities=[TimerAction(period=RETRY_SECONDS, actions=[change(Transition.TRANSITION_CONFIGURE)])],
            )
        ),
        change(Transition.TRANSITION_CONFIGURE),
    ]


def lidar_actions(context):
    name = LaunchConfiguration("name").perform(context)
    namespace = LaunchConfiguration("namespace").perform(context)
    container = LaunchConfiguration("container").perform(context)
    parameters = [LaunchConfiguration("params_file").perform(context), given_parameters(context)]
    if container:
        component = ComposableNode(
            package="g4lidar_ros",
            plugin="g4lidar_ros::LidarNode",
            name=name,
            namespace=namespace,
            parameters=[*parameters, {"autostart": True}],
            extra_arguments=[{"use_intra_process_comms": True}],
        )
        return [LoadComposableNodes(target_container=container, composable_node_descriptions=[component])]
    node = LifecycleNode(
        package="g4lidar_ros",
        executable="lidar_node",
        name=name,
        namespace=namespace,
        parameters=parameters,
        output="screen",
    )
    return [node, *driven(node)]


def generate_launch_description():
    parameters = [DeclareLaunchArgument(name, default_value="", description=words)
                  for name, (_, words) in PARAMETERS.items()]
    return LaunchDescription([
        DeclareLaunchArgument("name", default_value="g4lidar", description="name of the node"),
        DeclareLaunchArgument("namespace", default_value="", description="namespace of the node and its topics"),
        DeclareLaunchArgument("sim", default_value="false", description="whether the lidar is simulated"),
        DeclareLaunchArgument("container", default_value="",
                              description="a component container to load it into; empty: a process of its own"),
        DeclareLaunchArgument("rviz", default_value="false", description="whether rviz2 is started"),
        DeclareLaunchArgument("params_file", default_value=os.path.join(SHARE, "config", "lidar.yaml"),
                              description="file of parameters; arguments have precedence"),
        *parameters,
        OpaqueFunction(function=lidar_actions),
        Node(package="rviz2", executable="rviz2", arguments=["-d", os.path.join(SHARE, "rviz", "lidar.rviz")],
             condition=IfCondition(LaunchConfiguration("rviz"))),
    ])
