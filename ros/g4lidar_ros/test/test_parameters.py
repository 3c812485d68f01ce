# SPDX-License-Identifier: MIT
"""Parameters are what the user wants, with one type each. What the lidar has is in others, and in /diagnostics."""

import os
import signal
import subprocess
import sys
import tempfile
import unittest

import launch
import launch_testing.actions
import yaml
from ament_index_python.packages import get_package_prefix
from diagnostic_msgs.msg import DiagnosticArray
from launch.actions import ExecuteProcess
from lifecycle_msgs.msg import State, Transition
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters, SetParametersAtomically
from rclpy.parameter import parameter_value_to_python
from sensor_msgs.msg import LaserScan

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402

NODE = os.path.join(get_package_prefix("g4lidar_ros"), "lib", "g4lidar_ros", "lidar_node")
G4_DUMP = support.program("g4-dump", "G4_DUMP")
DIRECTORY = tempfile.mkdtemp(prefix="g4lidar-ros-")
UP = (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE)
DOWN = (Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_CLEANUP)


def generate_test_description():
    # The tests run while some process of the description does.
    return launch.LaunchDescription([ExecuteProcess(cmd=["sleep", "100000"]), launch_testing.actions.ReadyToTest()])


def parameter_file(values):
    """The values as they are written, which decides their types."""
    path = os.path.join(tempfile.mkdtemp(dir=DIRECTORY), "parameters.yaml")
    with open(path, "w") as file:
        file.write("/**:\n  ros__parameters:\n")
        file.writelines(f"    {name}: {word}\n" for name, word in values.items())
    return path


class ParameterTest(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def start(self, name, path):
        """A node with a file of parameters; its services are called by its namespace."""
        self.namespace = name
        process = subprocess.Popen([NODE, "--ros-args", "-r", f"__ns:=/{name}", "--params-file", path])
        self.addCleanup(self.end, process)
        self.service = f"/{name}/g4lidar/"
        self.watcher.state(f"/{name}/g4lidar")
        return process

    def end(self, process):
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        process.wait(support.PATIENCE)

    def plug(self, port, *words):
        """A lidar at a port, with the settings that it has when it is new: 7 Hz, 9000 samples a second."""
        device = subprocess.Popen([G4_DUMP, "sim", "-q", "--link", port, *words])
        self.addCleanup(self.end, device)
        self.assertTrue(support.wait_for(lambda: os.path.exists(port)))
        return device

    def go(self, *transitions):
        for each in transitions:
            self.assertTrue(self.watcher.change_state(f"/{self.namespace}/g4lidar", each), each)

    def get(self, *names):
        request = GetParameters.Request(names=names)
        values = self.watcher.call(GetParameters, self.service + "get_parameters", request).values
        found = [parameter_value_to_python(each) for each in values]
        return found[0] if len(names) == 1 else tuple(found)

    def set(self, name, **value):
        kind = getattr(ParameterType, "PARAMETER_" + next(iter(value)).removesuffix("_value").upper())
        request = SetParameters.Request(parameters=[Parameter(name=name, value=ParameterValue(type=kind, **value))])
        return self.watcher.call(SetParameters, self.service + "set_parameters", request).results[0]

    def all(self):
        """All parameters with their values."""
        listed = self.watcher.call(ListParameters, self.service + "list_parameters", ListParameters.Request())
        names = sorted(listed.result.names)
        return dict(zip(names, self.get(*names)))

    def wait_for_frequency(self, hertz):
        scans = self.watcher.collect(LaserScan, f"/{self.namespace}/scan")
        self.assertTrue(support.wait_for(lambda: scans and abs(scans[-1].scan_time - 1 / hertz) < 0.002),
                        [each.scan_time for each in scans[-1:]])


@unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
class TestSettings(ParameterTest):
    names = ("frequency", "sample_rate", "idle")
    states = tuple("device." + name for name in names)
    wanted = {"frequency": "10.0", "sample_rate": "8000", "idle": "false"}

    def check(self):
        self.wait_for_frequency(10.0)
        self.assertEqual(self.get(*self.names), (10.0, 8000, "off"))
        self.assertTrue(support.wait_for(lambda: self.get(*self.states) == (10.0, 8000, "off")), self.get(*self.states))

    def test_a_file_over_resets_an_unplug_and_an_error(self):
        port = os.path.join(DIRECTORY, "wanted")
        device = self.plug(port)
        self.start("wanted", parameter_file({"source": port, **self.wanted}))
        self.assertEqual(self.get(*self.states), (0.0, 0, ""))  # it is not open
        self.go(*UP)
        self.check()
        for _ in range(2):
            self.go(*DOWN)
            self.assertEqual(self.get(*self.states), (0.0, 0, ""))
            self.end(device)
            device = self.plug(port)  # another one, or the same without power
            self.go(*UP)
            self.check()
        self.end(device)
        device = self.plug(port)
        self.check()
        self.go(*DOWN)
        self.end(device)
        with open(port, "wb") as file:
            file.write(b"\x89MCAP0\r\n" + b"this is no recording\n" * 100)
        self.assertFalse(self.watcher.change_state("/wanted/g4lidar", Transition.TRANSITION_CONFIGURE))
        self.assertEqual(self.watcher.state("/wanted/g4lidar"), State.PRIMARY_STATE_UNCONFIGURED)
        os.unlink(port)
        self.plug(port)
        self.go(*UP)
        self.check()

    def test_what_is_set_while_it_runs_is_wanted_again_after_an_unplug_and_a_reset(self):
        port = os.path.join(DIRECTORY, "set")
        device = self.plug(port)
        self.start("set", parameter_file({"source": port, "frequency": "10.0"}))
        self.go(*UP)
        self.wait_for_frequency(10.0)
        self.assertTrue(self.set("frequency", double_value=6.0).successful)
        self.wait_for_frequency(6.0)
        self.assertTrue(support.wait_for(lambda: self.get("device.frequency") == 6.0))
        self.end(device)
        device = self.plug(port)
        self.wait_for_frequency(6.0)
        self.go(*DOWN, *UP)
        self.wait_for_frequency(6.0)
        # What is no longer wanted stays as it is, until the lidar loses it.
        self.assertTrue(self.set("frequency", double_value=0.0).successful)
        self.assertEqual(self.get("frequency", "device.frequency"), (0.0, 6.0))
        self.go(*DOWN)
        self.end(device)
        self.plug(port)
        self.go(*UP)
        self.wait_for_frequency(7.0)
        self.assertEqual(self.get("frequency", "device.frequency"), (0.0, 7.0))

    def test_the_state_is_reported_and_cannot_be_set(self):
        messages = self.watcher.collect(DiagnosticArray, "/diagnostics")
        self.start("state", parameter_file({"source": "'sim:?serial=1234567890123456'", **self.wanted}))
        self.go(*UP)
        self.check()
        self.assertEqual(self.get("device.serial_number"), "1234567890123456")
        for name, value in (("device.frequency", {"double_value": 8.0}), ("device.serial_number", {"string_value": "1"})):
            self.assertIn("only the lidar changes it", self.set(name, **value).reason)

        def settings():
            return [{pair.key: pair.value for pair in each.values} for message in list(messages) for each in message.status
                    if each.name == "/state/g4lidar: state"]
        wanted = {"frequency": "10.000000", "sample_rate": "8000", "idle": "off", "direction": "cw"}
        self.assertTrue(support.wait_for(lambda: settings() and settings()[-1].items() >= wanted.items()), settings()[-1:])

    def test_a_dump_makes_the_same_node(self):
        values = {"source": "'sim:?seed=5'", "frequency": "8.0", "ignore": "[30, 40]", "speckle": "true", "near_as": ".nan"}
        first = self.start("dumped", parameter_file(values))
        self.go(*UP)
        self.wait_for_frequency(8.0)
        self.assertTrue(support.wait_for(lambda: self.get("device.frequency") == 8.0))
        before = self.all()
        dumped = subprocess.run(["ros2", "param", "dump", "--no-daemon", "/dumped/g4lidar"], capture_output=True, text=True,
                                timeout=support.PATIENCE)
        self.assertEqual(dumped.returncode, 0, dumped.stderr)
        self.assertNotIn("null", dumped.stdout)
        self.end(first)
        path = os.path.join(DIRECTORY, "dump.yaml")
        with open(path, "w") as file:
            file.write(dumped.stdout)
        self.assertEqual(set(yaml.safe_load(dumped.stdout)), {"/dumped/g4lidar"})
        self.start("dumped", path)
        # It does not know its lidar yet.
        self.assertEqual(self.get("device.frequency", "device.serial_number"), (0.0, ""))
        self.go(*UP)
        self.wait_for_frequency(8.0)
        self.assertTrue(support.wait_for(lambda: self.get("device.frequency") == 8.0))
        self.assertEqual(self.all(), before)


class TestTypes(ParameterTest):
    def check(self, wanted):
        for name, value in wanted.items():
            found = self.get(name)
            self.assertEqual((type(found), found), (type(value), value), name)

    def test_values_of_a_file_are_converted(self):
        self.start("file", parameter_file({
            "source": "'sim:?seed=6'", "frequency": "9", "sample_rate": "'8000'", "idle": "'false'", "constant": "true",
            "range_max": "'8'", "speckle": "true", "near_as": ".nan", "no_return": ".inf", "ignore": "[30, 40, 90, 100]",
            "angle_min": "-90", "angle_max": "90", "standby": "'false'", "connect_timeout": "3", "baud": "512000.0",
            "loop": "'true'"}))
        self.check({"frequency": 9.0, "sample_rate": 8000, "idle": "off", "constant": "on", "range_max": 8.0,
                    "speckle": "on", "near_as": "nan", "no_return": "inf", "ignore": "30:40 90:100", "angle_min": -90.0,
                    "angle_max": 90.0, "standby": False, "connect_timeout": 3.0, "baud": 512000, "loop": True})

    def test_values_that_are_set_are_converted(self):
        self.start("types", parameter_file({"source": "'sim:?seed=6'"}))
        for transitions in (UP, DOWN):  # while it is not open, and while it is
            self.assertTrue(self.set("frequency", integer_value=9).successful)
            self.assertTrue(self.set("sample_rate", double_value=8000.0).successful)
            self.assertTrue(self.set("idle", bool_value=False).successful)
            self.assertTrue(self.set("speckle", bool_value=True).successful)
            self.assertTrue(self.set("range_max", string_value="8").successful)
            self.assertTrue(self.set("standby", string_value="false").successful)
            self.assertTrue(self.set("ignore", integer_array_value=[30, 40]).successful)
            wanted = {"frequency": 9.0, "sample_rate": 8000, "idle": "off", "speckle": "on", "range_max": 8.0,
                      "standby": False, "ignore": "30:40"}
            self.check(wanted)
            for name, value in (("frequency", {"string_value": "fast"}), ("frequency", {"bool_value": True}),
                                ("sample_rate", {"double_value": 8000.5}), ("standby", {"string_value": "maybe"}),
                                ("ignore", {"double_array_value": [1.0, 2.0, 3.0]}), ("frequency", {"double_value": 40.0}),
                                ("direction", {"string_value": "up"}), ("sample_rate", {"integer_value": 8001})):
                refused = self.set(name, **value)
                self.assertFalse(refused.successful, name)
                self.assertTrue(refused.reason, name)
            self.check(wanted)
            for name in ("ignore", "speckle"):
                self.assertTrue(self.set(name, string_value="off").successful)
            self.go(*transitions)
            if transitions == UP:
                self.wait_for_frequency(9.0)

    def test_directions_as_numbers(self):
        self.start("angles", parameter_file({"source": "'sim:?seed=6'", "angle_min": "-90", "angle_max": "90.0"}))
        self.go(*UP)
        scans = self.watcher.collect(LaserScan, "/angles/scan")

        def kept():
            """The share of the directions that are kept, as the others are NaN."""
            return sum(each == each for each in scans[-1].ranges) / len(scans[-1].ranges) if scans else 1.0
        self.assertTrue(support.wait_for(lambda: abs(kept() - 0.5) < 0.02), kept())
        self.assertTrue(self.set("angle_max", integer_value=0).successful)
        self.assertTrue(support.wait_for(lambda: abs(kept() - 0.25) < 0.02), kept())
        refused = self.set("fov", string_value="-45:45")
        self.assertIn("angle_min", refused.reason)
        values = {"fov": ParameterValue(type=ParameterType.PARAMETER_INTEGER_ARRAY, integer_array_value=[-45, 45])}
        values |= {name: ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=angle)
                   for name, angle in (("angle_min", -180.0), ("angle_max", 180.0))}
        request = SetParametersAtomically.Request(
            parameters=[Parameter(name=name, value=value) for name, value in values.items()])
        done = self.watcher.call(SetParametersAtomically, self.service + "set_parameters_atomically", request).result
        self.assertTrue(done.successful, done.reason)
        self.assertEqual(self.get("fov"), "-45:45")
        self.assertTrue(support.wait_for(lambda: abs(kept() - 0.25) < 0.02), kept())
        self.assertTrue(self.set("ignore", double_array_value=[-45.0, 0.0]).successful)
        self.assertTrue(support.wait_for(lambda: abs(kept() - 0.125) < 0.02), kept())


class TestBlind(ParameterTest):
    def wait_for_sector(self, expected):
        """The directions from which nothing returns, as /diagnostics has them, whole degrees; none: ()."""
        def found():
            all_of_it = [{pair.key: pair.value for pair in each.values} for message in list(self.messages)
                         for each in message.status if each.name == "/blind/g4lidar: returns"]
            if not all_of_it or "samples" not in all_of_it[-1]:
                return None
            values = all_of_it[-1]
            return tuple(int(values[key]) for key in ("nothing_from_deg", "nothing_to_deg") if key in values)

        def is_expected(sector):
            return sector is not None and len(sector) == len(expected) and all(
                abs(a - b) <= 4 for a, b in zip(sector, expected))
        del self.messages[:]
        self.assertTrue(support.wait_for(lambda: is_expected(found())), (found(), expected))

    def test_directions_that_are_left_out_are_not_reported(self):
        # No wall behind the lidar: their ends are at 117 and -117 degrees.
        world = os.path.join(DIRECTORY, "open.txt")
        with open(world, "w") as file:
            file.write("wall 2 -2 2 2\nwall -1 2 2 2\nwall -1 -2 2 -2\nlidar 0 0 180\n")
        self.messages = self.watcher.collect(DiagnosticArray, "/diagnostics")
        self.start("blind", parameter_file({"source": f"'sim:?world={world}'"}))
        self.go(*UP)
        blind = (117, 243)
        self.wait_for_sector(blind)
        self.assertTrue(self.set("ignore", integer_array_value=[110, 250]).successful)
        self.wait_for_sector(())
        self.go(*DOWN, *UP)  # as from a file
        self.wait_for_sector(())
        self.assertTrue(self.set("ignore", string_value="off").successful)
        self.wait_for_sector(blind)
        self.assertTrue(self.set("fov", string_value="-100:100").successful)
        self.wait_for_sector(())
        self.assertTrue(self.set("fov", string_value="").successful)
        self.wait_for_sector(blind)
        for name, angle in (("angle_min", -100), ("angle_max", 100)):
            self.assertTrue(self.set(name, integer_value=angle).successful)
        self.wait_for_sector(())
