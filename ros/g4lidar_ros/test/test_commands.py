# SPDX-License-Identifier: MIT
"""What a user of ROS sees: the commands of `ros2`, the parameter file, arguments of the launch files, /diagnostics."""

import os
import re
import signal
import subprocess
import sys
import time
import unittest

import launch
import launch_testing.actions
import launch_testing.asserts
import yaml
from ament_index_python.packages import get_package_share_directory
from diagnostic_msgs.msg import DiagnosticArray
from launch.actions import GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch_ros.actions import Node
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters
from sensor_msgs.msg import LaserScan

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402

SHARE = get_package_share_directory("g4lidar_ros")
# Commands look for nodes themselves: a daemon would outlive the test.
ALONE = "--no-daemon"
UNPLUGS = "&".join(f"fault=unplug@{at}s+4s" for at in range(6, 200, 12))


def launch_file(name):
    return AnyLaunchDescriptionSource(os.path.join(SHARE, "launch", name))


def generate_test_description():
    return launch.LaunchDescription([
        Node(package="g4lidar_ros", executable="lidar_node", name="g4lidar", namespace="plug",
             parameters=[{"source": "sim:?seed=9&serial=1234567890123456&" + UNPLUGS, "autostart": True}]),
        Node(package="rclcpp_components", executable="component_container", name="container"),
        GroupAction([IncludeLaunchDescription(launch_file("lidar.launch.py"), launch_arguments={
            "container": "/container", "namespace": "composed", "source": "sim:?seed=21"}.items())]),
        launch_testing.actions.ReadyToTest(),
    ])


def ros2(*words):
    """What a command of ros2 prints; it succeeds. Repeated where it looked too shortly for the node."""
    end = time.monotonic() + support.PATIENCE
    while True:
        done = subprocess.run(["ros2", *words], capture_output=True, text=True, timeout=support.PATIENCE)
        output = done.stdout + done.stderr
        if done.returncode == 0:
            return done.stdout
        was_missed = "Node not found" in output or "Unable to find container" in output
        if not was_missed or time.monotonic() > end:
            raise AssertionError(f"ros2 {' '.join(words)}: {done.returncode}: {output}")


class CommandTest(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def start(self, *words):
        """A command of ros2 in a group of its own, which Ctrl-C ends."""
        process = subprocess.Popen(["ros2", *words], start_new_session=True)
        self.addCleanup(self.end, process)
        return process

    def end(self, process):
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGINT)
        self.assertEqual(process.wait(support.PATIENCE), 0)

    def wait_for_scan(self, name, is_wanted=lambda scan: True):
        scans = self.watcher.collect(LaserScan, f"/{name}/scan")
        self.assertTrue(support.wait_for(lambda: scans and is_wanted(scans[-1])), name)


class TestCommands(CommandTest):
    def test_run_lifecycle_parameters_and_topics(self):
        self.start("run", "g4lidar_ros", "lidar_node", "--ros-args", "-r", "__ns:=/bare", "-p", "source:='sim:'")
        node = "/bare/g4lidar"
        self.assertEqual(self.watcher.state(node), 1)  # it is there
        self.assertIn("unconfigured", ros2("lifecycle", "get", ALONE, node))
        for transition, state in (("configure", "inactive"), ("activate", "active")):
            self.assertIn("successful", ros2("lifecycle", "set", ALONE, node, transition))
            self.assertIn(state, ros2("lifecycle", "get", ALONE, node))
        self.assertTrue(support.wait_for(lambda: node in ros2("node", "list", ALONE)))
        topic = "/bare/scan [sensor_msgs/msg/LaserScan]"
        self.assertTrue(support.wait_for(lambda: topic in ros2("topic", "list", "-t", ALONE)))
        self.assertIn("frame_id: laser", ros2("topic", "echo", "--once", ALONE, "/bare/scan", "sensor_msgs/msg/LaserScan"))
        self.assertTrue(support.wait_for(lambda: "7.0" in ros2("param", "get", ALONE, node, "device.frequency")))
        self.assertIn("successful", ros2("param", "set", ALONE, node, "frequency", "9"))
        self.assertIn("Double value is: 9.0", ros2("param", "get", ALONE, node, "frequency"))
        self.wait_for_scan("bare", lambda scan: abs(scan.scan_time - 1 / 9) < 0.005)
        described = ros2("param", "describe", ALONE, node, "connect_timeout")
        for words in ("How long the lidar may be missing", "Read only: true", "Max value: 3600.0"):
            self.assertIn(words, described)
        for command, words in (("stop", "rests until start"), ("start", "the motor turns")):
            answer = ros2("service", "call", f"{node}/{command}", "std_srvs/srv/Trigger")
            self.assertIn("success=True", answer)
            self.assertIn(words, answer)
        self.assertIn("publishing", ros2("topic", "pub", "--once", f"{node}/run", "std_msgs/msg/Bool", "{data: true}"))
        for transition, state in (("deactivate", "inactive"), ("cleanup", "unconfigured"), ("shutdown", "finalized")):
            self.assertIn("successful", ros2("lifecycle", "set", ALONE, node, transition))
            self.assertIn(state, ros2("lifecycle", "get", ALONE, node))

    def test_launch_with_arguments(self):
        words = ("sim:=true", "range_max:=3.0", "fov:=-90:90", "frequency:=9.0", "speckle:=off", "grid:=360")
        for name in ("py", "xml"):
            self.start("launch", "g4lidar_ros", f"lidar.launch.{name}", f"namespace:={name}", *words)
        for name in ("py", "xml"):
            self.wait_for_scan(name, lambda scan: abs(scan.scan_time - 1 / 9.0) < 0.005)
            scans = self.watcher.collect(LaserScan, f"/{name}/scan")
            self.assertTrue(support.wait_for(lambda: scans))
            ranges = scans[-1].ranges
            self.assertAlmostEqual(scans[-1].range_max, 3.0, places=5)
            self.assertEqual(len(ranges), 360)
            self.assertLess(max(each for each in ranges if each < 100.0), 3.001)  # in a float
            self.assertTrue(all(each != each for each in [*ranges[:88], *ranges[-88:]]))  # behind it

    def test_components(self):
        self.wait_for_scan("composed")  # by the launch file
        self.assertIn("g4lidar_ros::LidarNode", ros2("component", "types"))
        loaded = ros2("component", "load", ALONE, "/container", "g4lidar_ros", "g4lidar_ros::LidarNode",
                      "--node-namespace", "/loaded", "-p", "source:=sim:?seed=23", "-p", "autostart:=true")
        number = re.search(r"component (\d+)", loaded).group(1)
        self.wait_for_scan("loaded")
        self.assertTrue(support.wait_for(lambda: "/loaded/g4lidar" in ros2("component", "list", ALONE, "/container")))
        self.assertIn("Unloaded", ros2("component", "unload", ALONE, "/container", number))
        self.assertTrue(support.wait_for(lambda: self.watcher.node.count_publishers("/loaded/scan") == 0))

    def test_diagnostics(self):
        messages = self.watcher.collect(DiagnosticArray, "/diagnostics")

        def statuses():
            """The newest status of each name, of the node that is unplugged."""
            return {each.name: each for message in list(messages) for each in message.status
                    if each.name.startswith("/plug/g4lidar: ")}

        def state():
            return statuses().get("/plug/g4lidar: state")
        self.assertTrue(support.wait_for(lambda: state() and state().message.startswith("running")))
        self.assertEqual(state().level, b"\0")
        self.assertEqual(state().hardware_id, "1234567890123456")
        names = {each.split(": ")[1] for each in statuses()}
        self.assertGreaterEqual(names, {"state", "port", "health", "motor", "counts", "deskewing", "topics"})
        self.assertIn("/plug/scan subscribers", [each.key for each in statuses()["/plug/g4lidar: topics"].values])
        self.assertTrue(support.wait_for(lambda: state().level == b"\2" and state().message.startswith("lost: ")))
        self.assertTrue(support.wait_for(lambda: state().level == b"\0"), "it does not heal")
        # It is unplugged again 8 s after its return.
        levels = lambda: {statuses()[f"/plug/g4lidar: {name}"].level for name in ("state", "port")}
        self.assertTrue(support.wait_for(lambda: levels() == {b"\0"}), "the port does not heal")


class TestFiles(CommandTest):
    def parameters(self):
        """The parameters of the node: their values and descriptions by their names."""
        service = "/plug/g4lidar/"
        names = self.watcher.call(ListParameters, service + "list_parameters", ListParameters.Request()).result.names
        of_ros = ("use_sim_time", "start_type_description_service")
        names = [each for each in names if "." not in each and each not in of_ros]
        values = self.watcher.call(GetParameters, service + "get_parameters", GetParameters.Request(names=names)).values
        described = self.watcher.call(DescribeParameters, service + "describe_parameters",
                                      DescribeParameters.Request(names=names)).descriptors
        return {name: each for name, *each in zip(names, values, described)}

    def test_each_line_of_the_parameter_file_is_explained(self):
        known = self.parameters()
        path = os.path.join(SHARE, "config", "lidar.yaml")
        with open(path) as file:
            text = file.read()
        begin, running = text.index("Set at the start only"), text.index("Also while it runs")
        lines = [(line.group(1), line.start()) for line in re.finditer(r"^    (?:# )?(\w+): .*?\S +# \S.*$", text, re.M)]
        self.assertEqual(len(lines), sum(bool(re.match(r"    (# )?\w+: ", line)) for line in text.splitlines()))
        self.assertEqual({name for name, _ in lines}, set(known))
        for name, at in lines:
            self.assertEqual(known[name][1].read_only, begin < at < running, name)
        # The values are the defaults: those of a node that was started without the file.
        fields = {bool: "bool_value", int: "integer_value", float: "double_value", str: "string_value"}
        for name, value in yaml.safe_load(text)["/**"]["ros__parameters"].items():
            if name not in ("source", "autostart"):
                self.assertEqual(getattr(known[name][0], fields[type(value)]), value, name)

    def test_the_parameters_are_arguments_of_the_launch_files(self):
        of_launch = {"name", "namespace", "sim", "container", "rviz", "params_file", "use_sim_time"}
        wanted = set(self.parameters()) | of_launch
        for name in ("lidar.launch.py", "lidar.launch.xml"):
            shown = ros2("launch", "g4lidar_ros", name, "--show-args")
            self.assertEqual(set(re.findall(r"^    '(\w+)':$", shown, re.M)), wanted, name)


@launch_testing.post_shutdown_test()
class TestExit(unittest.TestCase):
    def test_exit_codes(self, proc_info):
        launch_testing.asserts.assertExitCodes(proc_info)
