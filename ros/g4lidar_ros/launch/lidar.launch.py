# SPDX-License-Identifier: MIT
"""One lidar as a lifecycle node, which configures and activates itself; with autostart:=false a manager does it.

    ros2 launch g4lidar_ros lidar.launch.py
    ros2 launch g4lidar_ros lidar.launch.py sim:=true
    ros2 launch g4lidar_ros lidar.launch.py source:=/dev/ttyUSB0 frame_id:=front_laser
    ros2 launch g4lidar_ros lidar.launch.py container:=/my_container

A launch file that includes it twice puts each into a GroupAction, as arguments are passed on to what follows.
"""

import os
import re
from typing import List

import yaml
from ament_index_python.packages import PackageNotFoundError, get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LoadComposableNodes, Node
from launch_ros.descriptions import ComposableNode
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.utilities import make_namespace_absolute, prefix_namespace

SHARE = get_package_share_directory("g4lidar_ros")
DEFAULTS = os.path.join(SHARE, "config", "lidar.yaml")
# The parameters that are also arguments, with the comments of that file. One that is not given stays as in the file.
with open(DEFAULTS) as file:
    PARAMETERS = dict(re.findall(r"^    (?:# )?(\w+): .*?# (.*)", file.read(), re.M))
ARRAYS = ("sources", "mounts")


def is_true(name, context):
    word = LaunchConfiguration(name).perform(context)
    if word.lower() not in ("true", "1", "yes", "on", "false", "0", "no", "off"):
        raise ValueError(f"argument {name}: '{word}' is not true or false")
    return word.lower() in ("true", "1", "yes", "on")


def given_parameters(context):
    """The arguments that were given, as parameters: texts, which the node converts."""
    words = {name: LaunchConfiguration(name).perform(context) for name in PARAMETERS}
    if is_true("sim", context):
        words["source"] = words["source"] or "sim:"
    made = {name: ParameterValue(word, value_type=List[str] if name in ARRAYS else str)
            for name, word in words.items() if word}
    if LaunchConfiguration("use_sim_time").perform(context):
        made["use_sim_time"] = is_true("use_sim_time", context)
    return made


def sections_in(tree, above=""):
    """The names of the nodes that a file of parameters is for, which may have wildcards, and the parameters."""
    for key, value in tree.items() if isinstance(tree, dict) else ():
        name = above + "/" + str(key).strip("/")
        if isinstance(value, dict) and "ros__parameters" in value:
            yield name, value["ros__parameters"]
        else:
            yield from sections_in(value, name)


def check_file(path, node):
    """Refuses a file that has nothing for the node, which would be ignored without a word, or that is another driver's."""
    with open(path) as file:
        sections = list(sections_in(yaml.safe_load(file)))
    own = set()
    for name, values in sections:
        pattern = re.escape(name).replace(r"/\*\*", "(/[^/]+)*").replace(r"/\*", "/[^/]+")
        if isinstance(values, dict) and re.fullmatch(pattern, node):
            own |= {str(each).split(".")[0] for each in values}
    foreign = own & {"port", "serial_port"}  # of ydlidar_ros2_driver, sllidar_ros2
    if not foreign and own & {*PARAMETERS, "use_sim_time", "qos_overrides", "diagnostic_updater"}:
        return
    what = f"has the parameter {min(foreign)} of another driver" if foreign else \
        f"has nothing for the node {node}, but for {', '.join(dict(sections)) or 'none'}"
    if foreign or re.search("ydlidar|sllidar", what):
        what += ": docs/migrating.md has the names that the parameters of other drivers have here"
    raise RuntimeError(f"params_file: {path} {what}")


def lidar_actions(context):
    container = LaunchConfiguration("container").perform(context)
    node = {
        "package": "g4lidar_ros",
        "name": LaunchConfiguration("name").perform(context),
        "namespace": LaunchConfiguration("namespace").perform(context),
        "parameters": [LaunchConfiguration("params_file").perform(context), given_parameters(context)],
    }
    space = prefix_namespace(context.launch_configurations.get("ros_namespace"), node["namespace"])
    check_file(node["parameters"][0], make_namespace_absolute(space or "").rstrip("/") + "/" + node["name"])
    if not container:
        return [Node(executable="lidar_node", output="screen", **node)]
    component = ComposableNode(plugin="g4lidar_ros::LidarNode", extra_arguments=[{"use_intra_process_comms": True}], **node)
    return [LoadComposableNodes(target_container=container, composable_node_descriptions=[component])]


def rviz_actions(context):
    if not is_true("rviz", context):
        return []
    try:
        get_package_share_directory("rviz2")
    except PackageNotFoundError:
        install = f"sudo apt-get install ros-{os.environ.get('ROS_DISTRO', '$ROS_DISTRO')}-rviz2"
        raise RuntimeError(f"rviz:=true needs the package rviz2, which is not installed: {install}") from None
    return [Node(package="rviz2", executable="rviz2", arguments=["-d", os.path.join(SHARE, "rviz", "lidar.rviz")])]


def generate_launch_description():
    parameters = [DeclareLaunchArgument(name, default_value="true" if name == "autostart" else "", description=words)
                  for name, words in PARAMETERS.items()]
    return LaunchDescription([
        DeclareLaunchArgument("name", default_value="g4lidar", description="name of the node"),
        DeclareLaunchArgument("namespace", default_value="", description="namespace of the node and its topics"),
        DeclareLaunchArgument("sim", default_value="false", description="whether the lidar is simulated"),
        DeclareLaunchArgument("container", default_value="",
                              description="a component container to load it into; empty: a process of its own"),
        DeclareLaunchArgument("use_sim_time", default_value="", description="whether the time is that of /clock"),
        DeclareLaunchArgument("rviz", default_value="false", description="whether rviz2 is started"),
        DeclareLaunchArgument("params_file", default_value=DEFAULTS,
                              description="file of parameters; arguments have precedence"),
        *parameters,
        # Nothing is started before all is checked: it would go on for ever.
        OpaqueFunction(function=lambda context: rviz_actions(context) + lidar_actions(context)),
    ])
