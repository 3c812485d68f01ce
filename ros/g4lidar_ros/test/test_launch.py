# SPDX-License-Identifier: MIT
"""The launch files: two lidars, what is refused, and slam_toolbox, for which a node of the test stands in."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import unittest

import launch
import launch_testing.actions
import launch_testing.util
from ament_index_python.packages import PackageNotFoundError, get_package_prefix
from lifecycle_msgs.msg import Transition
from rcl_interfaces.srv import GetParameters
from sensor_msgs.msg import LaserScan

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402


def generate_test_description():
    return launch.LaunchDescription([launch_testing.util.KeepAliveProc(), launch_testing.actions.ReadyToTest()])


def slam_toolbox(prefix):
    """A package slam_toolbox with the stand-in as its program."""
    index, programs = (os.path.join(prefix, *parts) for parts in (
        ("share", "ament_index", "resource_index", "packages"), ("lib", "slam_toolbox")))
    for each in (index, programs, os.path.join(prefix, "share", "slam_toolbox")):
        os.makedirs(each)
    open(os.path.join(index, "slam_toolbox"), "w").close()
    program = os.path.join(programs, "async_slam_toolbox_node")
    with open(os.path.join(os.path.dirname(__file__), "stand_in.py")) as file, open(program, "w") as made:
        made.write("#!/usr/bin/python3\n" + file.read())
    os.chmod(program, 0o755)


class TestLaunch(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()
        self.addCleanup(self.watcher.close)
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        slam_toolbox(self.scratch.name)
        self.record = os.path.join(self.scratch.name, "record.txt")

    def start(self, file, *words, **variables):
        """`ros2 launch` in a group of its own, which Ctrl-C ends, and which has the stand-in."""
        prefixes = self.scratch.name + ":" + os.environ["AMENT_PREFIX_PATH"]
        output = open(os.path.join(self.scratch.name, "output.txt"), "w")
        self.addCleanup(output.close)
        process = subprocess.Popen(["ros2", "launch", "g4lidar_ros", file, *words], start_new_session=True,
                                   stdout=output, stderr=output,
                                   env={**os.environ, "AMENT_PREFIX_PATH": prefixes, "RECORD": self.record, **variables})
        self.addCleanup(self.end, process)
        return process

    def end(self, process):
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGINT)
        self.assertEqual(process.wait(support.PATIENCE), 0, self.output())

    def output(self):
        with open(os.path.join(self.scratch.name, "output.txt")) as file:
            return file.read()

    def recorded(self, key):
        if not os.path.exists(self.record):
            return []
        with open(self.record) as file:
            lines = [json.loads(line) for line in file if line.endswith("\n")]
        return [each[key] for each in lines if key in each]

    def refused(self, file, *words):
        """What a launch prints that ends at once, and of which no process goes on."""
        launched = subprocess.Popen(["ros2", "launch", "g4lidar_ros", file, *words], start_new_session=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            shown, _ = launched.communicate(timeout=support.PATIENCE)
        finally:
            left = support.processes_of(launched.pid)
            if left:
                os.killpg(launched.pid, signal.SIGKILL)
        self.assertEqual(left, [])
        self.assertNotIn("process started", shown)
        return shown

    def wait_for_scan(self, topic, is_wanted=lambda scan: True):
        scans = self.watcher.collect(LaserScan, topic)
        self.assertTrue(support.wait_for(lambda: scans and is_wanted(scans[-1])), topic)

    def check_slam(self, kind, transitions):
        # An X2, as that takes no settings at all.
        self.start("slam_toolbox.launch.py", "source:=sim:?model=x2", "use_sim_time:=true", "base_frame:=base_footprint",
                   "namespace:=robot7", STAND_IN=kind)
        self.assertTrue(support.wait_for(lambda: self.recorded("parameters")), self.output())
        wanted = {"use_sim_time": True, "base_frame": "base_footprint", "odom_frame": "odom", "scan_topic": "/robot7/scan",
                  "mode": "mapping"}
        self.assertLessEqual(wanted.items(), self.recorded("parameters")[0].items())
        request = GetParameters.Request(names=["use_sim_time", "base_frame"])
        clock, frame = self.watcher.call(GetParameters, "/robot7/g4lidar/get_parameters", request).values
        self.assertTrue(clock.bool_value)
        self.assertEqual(frame.string_value, "base_footprint")
        self.assertTrue(support.wait_for(lambda: self.recorded("transition") == transitions), self.output())
        self.wait_for_scan("/robot7/scan")

    def test_slam_toolbox_with_a_lifecycle(self):
        self.check_slam("lifecycle", [Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE])

    def test_slam_toolbox_of_humble(self):
        self.check_slam("plain", [])
        self.doCleanups()  # it ends by Ctrl-C, without a word about services

    def test_slam_toolbox_refuses_the_order_of_time(self):
        self.assertIn("use order:=angle", self.refused("slam_toolbox.launch.py", "sim:=true", "order:=time"))

    def test_slam_toolbox_is_missing(self):
        try:
            get_package_prefix("slam_toolbox")
        except PackageNotFoundError:
            self.assertIn("'slam_toolbox' not found", self.refused("slam_toolbox.launch.py", "sim:=true"))
        else:
            self.skipTest("slam_toolbox is installed")

    def test_the_order_of_time_is_explained(self):
        self.start("lidar.launch.py", "sim:=true", "namespace:=by_time", "order:=time")
        self.wait_for_scan("/by_time/scan")
        self.assertIn("order: time is not for slam_toolbox", self.output())

    def parameters(self, text):
        """The argument for a file of parameters."""
        with tempfile.NamedTemporaryFile("w", dir=self.scratch.name, suffix=".yaml", delete=False) as file:
            file.write(text)
        return "params_file:=" + file.name

    def test_files_for_other_nodes_are_refused(self):
        page = "docs/migrating.md"
        values = "\n  ros__parameters: {frame_id: other, frequency: 9.0, "
        for node, more, words in (
                ("ydlidar_ros2_driver_node:", "port: /dev/ttyUSB0, lidar_type: 1}", ["/ydlidar_ros2_driver_node", page]),
                ("sllidar_node:", "serial_port: /dev/ttyUSB0}", ["/sllidar_node", page]),
                ("/**:", "port: /dev/ttyUSB0}", ["the parameter port of another driver", page]),
                ("camera:", "}", ["nothing for the node /robot7/g4lidar, but for /camera"]),
                ("g4lidar:", "}", ["nothing for the node /robot7/g4lidar, but for /g4lidar"])):
            shown = self.refused("lidar.launch.py", "sim:=true", "namespace:=robot7", self.parameters(node + values + more))
            for word in words:
                self.assertIn(word, shown)
            if page not in words:
                self.assertNotIn(page, shown)
        for text in ("", "g4lidar: 7\n", "g4lidar: {ros__parameters: 7}\n", "/**:\n  ros__parameters: {gain: 1}\n"):
            self.assertIn("nothing for the node /g4lidar", self.refused("lidar.launch.xml", "sim:=true", self.parameters(text)))
        vendor = self.parameters("ydlidar_ros2_driver_node:" + values + "}")
        for which in ("params_file:=", "rear_params_file:="):
            self.assertIn(page, self.refused("two_lidars.launch.py", "sim:=true", vendor.replace("params_file:=", which)))

    def test_files_for_this_node_among_others_are_used(self):
        values = "ros__parameters: {frequency: 9.0, range_max: 5.0}"
        for name, head in (("nested", "nested:\n  g4lidar:\n    "), ("whole", "/whole/g4lidar:\n  "), ("all", "/**:\n  "),
                           ("one", "/*/g4lidar:\n  ")):
            others = "ydlidar_ros2_driver_node:\n  ros__parameters: {port: /dev/ttyUSB0}\n"
            self.start("lidar.launch.py", "sim:=true", "namespace:=" + name, self.parameters(others + head + values))
        for name in ("nested", "whole", "all", "one"):
            self.wait_for_scan(f"/{name}/scan", lambda scan: abs(scan.range_max - 5.0) < 1e-5)

    def test_rviz_is_missing(self):
        try:
            get_package_prefix("rviz2")
        except PackageNotFoundError:
            self.assertRegex(self.refused("lidar.launch.py", "sim:=true", "rviz:=true"),
                             r"rviz:=true needs the package rviz2.*apt-get install ros-\w+-rviz2")
        else:
            self.skipTest("rviz2 is installed")

    def test_two_simulated_lidars(self):
        self.start("two_lidars.launch.py", "sim:=true", "frequency:=9.0", "rear_frequency:=8.0", "front_range_max:=5.0")
        self.wait_for_scan("/front/scan", lambda scan: abs(scan.scan_time - 1 / 9.0) < 0.005 and abs(scan.range_max - 5.0) < 1e-5)
        self.wait_for_scan("/rear/scan", lambda scan: abs(scan.scan_time - 1 / 8.0) < 0.005 and abs(scan.range_max - 16.0) < 1e-5
                           and scan.header.frame_id == "rear_laser")

    def test_two_lidars_without_settings(self):
        self.start("two_lidars.launch.py", "front:=sim:?model=x2", "rear:=sim:?model=scl")
        self.wait_for_scan("/front/scan")
        self.wait_for_scan("/rear/scan")

    def test_two_lidars_need_names(self):
        self.assertIn("argument rear is missing", self.refused("two_lidars.launch.py", "front:=sim:"))
