# SPDX-License-Identifier: MIT
"""Other models: simulated lidars of models that are named, and one at a port whose model is searched. The numbers are
those of the family: docs/models.md."""

import os
import signal
import subprocess
import sys
import tempfile
import unittest

import launch
import launch_testing.actions
import launch_testing.asserts
from ament_index_python.packages import get_package_share_directory
from launch.actions import ExecuteProcess, GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from lifecycle_msgs.msg import State, TransitionEvent
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, GetParameters, SetParameters
from sensor_msgs.msg import LaserScan, PointCloud2

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402

G4_DUMP = support.program("g4-dump", "G4_DUMP")
DIRECTORY = tempfile.mkdtemp(prefix="g4lidar-ros-")
PORT = os.path.join(DIRECTORY, "lidar")
LATE_PORT = os.path.join(DIRECTORY, "late")  # where a lidar is plugged in later


def lidar(file, **arguments):
    launches = os.path.join(get_package_share_directory("g4lidar_ros"), "launch")
    return GroupAction([IncludeLaunchDescription(AnyLaunchDescriptionSource(os.path.join(launches, file)),
                                                 launch_arguments=arguments.items())])


def generate_test_description():
    actions = [
        lidar("lidar.launch.py", namespace="x2", source="sim:?model=x2&seed=1", model="x2"),
        lidar("lidar.launch.xml", namespace="mini", source="sim:?model=t-mini&seed=2", model="t-mini"),
    ]
    actions += [
        lidar("lidar.launch.py", namespace="late", source=LATE_PORT, model="g4"),
        # An error that does not pass is not tried again.
        lidar("lidar.launch.py", namespace="wrong", sim="true", order="size"),
    ]
    if G4_DUMP:
        actions += [ExecuteProcess(cmd=[G4_DUMP, "sim", "-q", "--model", "t-mini", "--link", PORT]),
                    lidar("lidar.launch.py", namespace="found", source=PORT)]
    return launch.LaunchDescription([*actions, launch_testing.actions.ReadyToTest()])


def double(value):
    return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)


class TestModels(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def scan(self, name):
        scans = self.watcher.collect(LaserScan, f"/{name}/scan")
        self.assertTrue(support.wait_for(lambda: len(scans) > 3))
        return scans[-1]

    def describe(self, node, name):
        request = DescribeParameters.Request(names=[name])
        return self.watcher.call(DescribeParameters, f"/{node}/g4lidar/describe_parameters", request).descriptors[0]

    def set_frequency(self, node, value):
        request = SetParameters.Request(parameters=[Parameter(name="frequency", value=double(value))])
        return self.watcher.call(SetParameters, f"/{node}/g4lidar/set_parameters", request).results[0]

    def test_x2(self):
        scan = self.scan("x2")
        self.assertAlmostEqual(scan.range_min, 0.1, places=6)
        self.assertAlmostEqual(scan.range_max, 8.0, places=5)
        self.assertEqual(len(scan.intensities), 0)
        # 3000 samples per second at 7 Hz, less than 720 directions.
        self.assertGreater(sum(each < 8.0 for each in scan.ranges), 200)
        # It takes no commands.
        self.assertIn("this model does not have it", self.describe("x2", "frequency").additional_constraints)
        self.assertFalse(self.set_frequency("x2", 8.0).successful)

    def check_t_mini(self, name):
        scan = self.scan(name)
        self.assertAlmostEqual(scan.range_min, 0.05, places=6)
        self.assertAlmostEqual(scan.range_max, 12.0, places=5)
        self.assertAlmostEqual(scan.scan_time, 0.1, places=2)  # a simulated one turns at 10 Hz
        self.assertEqual(len(scan.intensities), len(scan.ranges))
        self.assertGreater(max(scan.intensities), 0)
        self.assertLessEqual(max(scan.intensities), 255)
        clouds = self.watcher.collect(PointCloud2, f"/{name}/points")
        self.assertTrue(support.wait_for(lambda: clouds))
        self.assertIn("intensity", [field.name for field in clouds[0].fields])

    def test_t_mini(self):
        self.check_t_mini("mini")
        self.assertIn("; 6:12", self.describe("mini", "frequency").additional_constraints)
        self.assertFalse(self.set_frequency("mini", 5.5).successful)
        self.assertTrue(self.set_frequency("mini", 8.0).successful)
        scans = self.watcher.collect(LaserScan, "/mini/scan")
        self.assertTrue(support.wait_for(lambda: scans and abs(scans[-1].scan_time - 0.125) < 0.005))

    @unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
    def test_a_model_that_is_not_named_is_found(self):
        self.check_t_mini("found")
        # The limits of all models: what is at the port may be any.
        self.assertIn("; 3:16", self.describe("found", "frequency").additional_constraints)
        # The lidar itself refuses what its model does not have.
        refused = self.set_frequency("found", 14.0)
        self.assertFalse(refused.successful)
        self.assertTrue(refused.reason)
        request = GetParameters.Request(names=["device.frequency"])
        found = self.watcher.call(GetParameters, "/found/g4lidar/get_parameters", request).values[0]
        self.assertAlmostEqual(found.double_value, 10.0)

    @unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
    def test_a_lidar_that_is_plugged_in_later_is_used(self):
        wrong = self.watcher.collect(TransitionEvent, "/wrong/g4lidar/transition_event")
        self.assertTrue(support.wait_for(lambda: self.watcher.state("/late/g4lidar") == State.PRIMARY_STATE_ACTIVE))

        def publishers():
            return {topic: [bytes(each.endpoint_gid) for each in self.watcher.node.get_publishers_info_by_topic(topic)]
                    for topic in ("/late/scan", "/late/points")}
        self.assertTrue(support.wait_for(lambda: all(len(each) == 1 for each in publishers().values())), publishers())
        made = publishers()
        device = subprocess.Popen([G4_DUMP, "sim", "-q", "--link", LATE_PORT])
        self.addCleanup(device.wait, support.PATIENCE)
        self.addCleanup(device.send_signal, signal.SIGINT)
        self.scan("late")
        # Publishers are made once, as a node never forgets one.
        self.assertEqual(publishers(), made)
        self.assertEqual(self.watcher.state("/wrong/g4lidar"), State.PRIMARY_STATE_UNCONFIGURED)
        self.assertLessEqual(sum(each.goal_state.label == "configuring" for each in list(wrong)), 1)


@launch_testing.post_shutdown_test()
class TestExit(unittest.TestCase):
    def test_exit_codes(self, proc_info):
        for name in proc_info.process_names():
            if "lidar_node" in name:
                self.assertEqual(proc_info[name].returncode, 0, name)
