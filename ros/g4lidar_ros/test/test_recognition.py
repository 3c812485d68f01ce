# SPDX-License-Identifier: MIT
"""Lidars that are not as the model that is named: what is refused, read, only listened to, and reported."""

import os
import re
import sys
import tempfile
import unittest

import launch
import launch_testing.actions
from ament_index_python.packages import get_package_share_directory
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from launch.actions import ExecuteProcess, GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from lifecycle_msgs.msg import State, Transition
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, SetParameters
from sensor_msgs.msg import LaserScan

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402

G4_DUMP = support.program("g4-dump", "G4_DUMP")
DIRECTORY = tempfile.mkdtemp(prefix="g4lidar-ros-")
RECORDING, _ = support.recordings(seconds=2)
WORLD = os.path.join(DIRECTORY, "nothing.txt")
with open(WORLD, "w") as text:
    text.write("wall -900 900 900 900\nlidar 0 0 0\n")  # farther than any lidar sees
# A G5 has samples as a G4, and another number: the ports of two lidars may have been swapped.
NODES = {
    "swapped": {"model": "g5"},
    "word": {"model": "g5!"},
    "insists": {"model": "g5", "insist_on_model": "true"},
    "listens": {"model": "t-mini-plus", "listen_only": "true"},
}
REAL = {"listens": ["--model", "t-mini-plus", "--fault", "scanning"]}  # it was left so; the others are G4s


def port(name):
    return os.path.join(DIRECTORY, name)


def commands(name):
    """What a lidar was sent: a line with its bytes for each command."""
    with open(port(name) + ".log") as log:
        return re.findall(r" A5 ([0-9A-F]{2}) ", log.read())


def lidar(name, **arguments):
    path = os.path.join(get_package_share_directory("g4lidar_ros"), "launch", "lidar.launch.py")
    arguments["namespace"] = name
    return GroupAction([IncludeLaunchDescription(AnyLaunchDescriptionSource(path), launch_arguments=arguments.items())])


def generate_test_description():
    actions = [launch_testing.actions.ReadyToTest()]
    if G4_DUMP:
        actions = [lidar("file", source=RECORDING, listen_only="true"),
                   lidar("blind", source=f"sim:?world={WORLD}"), *actions]
        for name, arguments in NODES.items():
            words = [G4_DUMP, "sim", "-q", "--log", "--link", port(name), *REAL.get(name, [])]
            device = ExecuteProcess(cmd=["sh", "-c", 'exec "$@" 2>"$0"', port(name) + ".log", *words])
            actions = [device, lidar(name, source=port(name), **arguments), *actions]
    return launch.LaunchDescription([ExecuteProcess(cmd=["sleep", "100000"]), *actions])


@unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
class TestRecognition(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def wait_for_scans(self, name):
        scans = self.watcher.collect(LaserScan, f"/{name}/scan")
        self.assertTrue(support.wait_for(lambda: len(scans) > 2), name)

    def status(self, name):
        """The status that has the state of the node, as soon as it has a model."""
        messages = self.watcher.collect(DiagnosticArray, "/diagnostics")

        def found():
            return [each for message in list(messages) for each in message.status
                    if each.name == f"/{name}/g4lidar: state" and any(pair.key == "model" for pair in each.values)]
        self.assertTrue(support.wait_for(found), name)
        return found()[-1], {pair.key: pair.value for pair in found()[-1].values}

    def test_a_named_model_of_another_port_is_refused(self):
        name = "/swapped/g4lidar"
        self.assertTrue(support.wait_for(lambda: commands("swapped")))
        self.assertTrue(support.wait_for(lambda: self.watcher.state(name) == State.PRIMARY_STATE_UNCONFIGURED))

    def test_a_user_who_insists_is_right(self):
        for name in ("word", "insists"):
            self.wait_for_scans(name)
            status, values = self.status(name)
            self.assertEqual(status.level, DiagnosticStatus.WARN)
            self.assertIn("reports the number 5, that of a G4", status.message)
            self.assertIn("reports the number 5, that of a G4", values["contradictions"])
            self.assertEqual((values["model"], values["known_by"], values["number"]), ("g5", "user", "5"))
        # The limits are those of the model: a G5 has 5 to 12 Hz.
        request = DescribeParameters.Request(names=["frequency"])
        made = self.watcher.call(DescribeParameters, "/word/g4lidar/describe_parameters", request).descriptors[0]
        self.assertIn("; 5:12", made.additional_constraints)

    def test_what_is_listened_to_gets_no_byte(self):
        self.wait_for_scans("listens")
        status, values = self.status("listens")
        self.assertEqual((status.level, values["model"]), (DiagnosticStatus.OK, "t-mini-plus"))
        wanted = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=8.0)
        request = SetParameters.Request(parameters=[Parameter(name="frequency", value=wanted)])
        refused = self.watcher.call(SetParameters, "/listens/g4lidar/set_parameters", request).results[0]
        self.assertFalse(refused.successful)
        self.assertTrue(self.watcher.change_state("/listens/g4lidar", Transition.TRANSITION_DEACTIVATE))
        self.assertEqual(commands("listens"), [])

    def test_a_lidar_that_sees_nothing_is_a_warning(self):
        messages = self.watcher.collect(DiagnosticArray, "/diagnostics")

        def found():
            return [each for message in list(messages) for each in message.status
                    if each.name == "/blind/g4lidar: returns" and each.level != DiagnosticStatus.OK]
        self.assertTrue(support.wait_for(found))
        self.assertEqual(found()[-1].level, DiagnosticStatus.WARN)
        self.assertIn("no_returns", [pair.value for pair in found()[-1].values])

    def test_a_recording_cannot_be_listened_to(self):
        self.assertEqual(self.watcher.state("/file/g4lidar"), State.PRIMARY_STATE_UNCONFIGURED)
        self.assertFalse(self.watcher.change_state("/file/g4lidar", Transition.TRANSITION_CONFIGURE))
