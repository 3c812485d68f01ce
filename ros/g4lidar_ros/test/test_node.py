# SPDX-License-Identifier: MIT
"""The node with simulated lidars: transitions, parameters, services, unplug, an error that it cannot recover from."""

import os
import pty
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import launch
import launch_testing.actions
import launch_testing.asserts
from launch_ros.actions import Node
from lifecycle_msgs.msg import State, Transition, TransitionEvent
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import (DescribeParameters, GetParameters, ListParameters, SetParameters,
                                SetParametersAtomically)
from rclpy.qos import ReliabilityPolicy, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool
from std_srvs.srv import Empty, Trigger

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402

DIRECTORY = tempfile.mkdtemp(prefix="g4lidar-ros-")
ABSENT = os.path.join(DIRECTORY, "lidar")

# A device that writes which commands it gets.
G4_DUMP = support.program("g4-dump", "G4_DUMP")
IDLE_PORT = os.path.join(DIRECTORY, "idle")

# A port at which something is that does not answer: the lidar is searched there for long.
SEARCHED_PORT = os.path.join(DIRECTORY, "searched")
SILENT, SILENT_END = pty.openpty()
os.symlink(os.ttyname(SILENT_END), SEARCHED_PORT)

UNPLUGS = "&".join(f"fault=unplug@{at}s+3s" for at in range(4, 200, 12))

# The nodes by their namespaces: at most 8, as Cyclone DDS with Humble has room for 10 participants in a domain.
NODES = {
    "life": {"source": "sim:?seed=7"},
    "values": {"source": "sim:?seed=8", "autostart": True, "range_max": 9.0},
    "plug": {"source": "sim:?seed=9&" + UNPLUGS, "autostart": True},
    "never": {"source": ABSENT},
    "quality": {"source": "sim:?seed=11", "autostart": True, "qos_overrides./quality/scan.publisher.depth": 3,
                "qos_overrides./quality/scan.publisher.reliability": "best_effort"},
    "idle": {"source": IDLE_PORT, "autostart": True, "standby": True},
    "searched": {"source": SEARCHED_PORT, "autostart": True},
}


def generate_test_description():
    nodes = [Node(package="g4lidar_ros", executable="lidar_node", name="g4lidar", namespace=name, output="screen",
                  parameters=[{key: launch_value(value) for key, value in values.items()}])
             for name, values in NODES.items()]
    return launch.LaunchDescription([*nodes, launch_testing.actions.ReadyToTest()])


def launch_value(value):
    from launch_ros.parameter_descriptions import ParameterValue as Typed
    return Typed(value, value_type=str) if isinstance(value, str) else value


def double(value):
    return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)


def text(value):
    return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=value)


class NodeTest(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def state(self, name):
        return self.watcher.state(f"/{name}/g4lidar")

    def change(self, name, transition):
        return self.watcher.change_state(f"/{name}/g4lidar", transition)

    def wait_for_state(self, name, state):
        self.assertTrue(support.wait_for(lambda: self.state(name) == state), f"/{name} in {self.state(name)}")

    def scans(self, name):
        return self.watcher.collect(LaserScan, f"/{name}/scan")


class TestLifecycle(NodeTest):
    def test_transitions(self):
        scans = self.scans("life")
        self.assertEqual(self.state("life"), State.PRIMARY_STATE_UNCONFIGURED)
        for _ in range(2):
            self.assertTrue(self.change("life", Transition.TRANSITION_CONFIGURE))
            self.assertEqual(self.state("life"), State.PRIMARY_STATE_INACTIVE)
            count = len(scans)
            self.assertTrue(self.change("life", Transition.TRANSITION_ACTIVATE))
            self.assertTrue(support.wait_for(lambda: len(scans) > count + 2))
            self.assertTrue(self.change("life", Transition.TRANSITION_DEACTIVATE))
            self.assertEqual(self.state("life"), State.PRIMARY_STATE_INACTIVE)
            self.assertTrue(self.change("life", Transition.TRANSITION_CLEANUP))
            self.assertEqual(self.state("life"), State.PRIMARY_STATE_UNCONFIGURED)

    def test_an_error_that_cannot_heal_ends_in_unconfigured(self):
        events = self.watcher.collect(TransitionEvent, "/never/g4lidar/transition_event")
        self.assertTrue(self.change("never", Transition.TRANSITION_CONFIGURE))
        self.assertTrue(self.change("never", Transition.TRANSITION_ACTIVATE))
        self.assertEqual(self.state("never"), State.PRIMARY_STATE_ACTIVE)
        with open(ABSENT + ".new", "wb") as file:
            file.write(b"this is no recording and no lidar\n" * 1000)
        os.rename(ABSENT + ".new", ABSENT)
        self.wait_for_state("never", State.PRIMARY_STATE_UNCONFIGURED)
        # on_deactivate() has returned ERROR: without it the node would be inactive.
        self.assertTrue(support.wait_for(lambda: ("deactivating", "errorprocessing") in
                                         [(each.start_state.label, each.goal_state.label) for each in list(events)]))

    def test_an_unplug_heals_by_itself(self):
        scans = self.scans("plug")
        self.assertTrue(support.wait_for(lambda: len(scans) > 2))
        stamps = lambda: [each.header.stamp.sec + each.header.stamp.nanosec * 1e-9 for each in list(scans)]

        def gaps():
            times = stamps()
            return [later - earlier for earlier, later in zip(times, times[1:]) if later - earlier > 2.0]
        self.assertTrue(support.wait_for(gaps), "no gap of the unplug, or no scan after it")
        self.assertEqual(self.state("plug"), State.PRIMARY_STATE_ACTIVE)


class TestMotor(NodeTest):
    def test_stop_and_start(self):
        scans = self.scans("values")
        self.assertTrue(support.wait_for(lambda: len(scans) > 2))
        self.assertTrue(self.watcher.call(Trigger, "/values/g4lidar/stop", Trigger.Request()).success)

        def has_stopped():
            count = len(scans)
            return not support.wait_for(lambda: len(scans) > count, 2.0)
        self.assertTrue(support.wait_for(has_stopped))
        self.assertTrue(self.watcher.call(Trigger, "/values/g4lidar/start", Trigger.Request()).success)
        count = len(scans)
        self.assertTrue(support.wait_for(lambda: len(scans) > count))

    def test_the_services_of_other_drivers(self):
        scans = self.scans("values")
        self.assertTrue(support.wait_for(lambda: len(scans) > 2))

        def has_stopped():
            count = len(scans)
            return not support.wait_for(lambda: len(scans) > count, 2.0)
        for what in ("scan", "motor"):
            self.watcher.call(Empty, f"/values/stop_{what}", Empty.Request())
            self.assertTrue(support.wait_for(has_stopped), what)
            self.watcher.call(Empty, f"/values/start_{what}", Empty.Request())
            count = len(scans)
            self.assertTrue(support.wait_for(lambda: len(scans) > count), what)

    def test_the_topic_run_rests_and_turns_the_motor(self):
        scans = self.scans("quality")
        self.assertTrue(support.wait_for(lambda: len(scans) == 0 and self.state("quality") == State.PRIMARY_STATE_ACTIVE))
        best = self.watcher.collect(LaserScan, "/quality/scan", qos_profile_sensor_data)
        self.assertTrue(support.wait_for(lambda: len(best) > 2))
        publisher = self.watcher.node.create_publisher(Bool, "/quality/g4lidar/run", 10)
        self.assertTrue(support.wait_for(lambda: publisher.get_subscription_count() > 0))

        def has_stopped():
            publisher.publish(Bool(data=False))
            count = len(best)
            return not support.wait_for(lambda: len(best) > count, 2.0)
        self.assertTrue(support.wait_for(has_stopped))
        publisher.publish(Bool(data=True))
        count = len(best)
        self.assertTrue(support.wait_for(lambda: len(best) > count))

    @unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
    def test_standby_turns_for_subscribers_only(self):
        path = os.path.join(DIRECTORY, "commands.txt")
        with open(path, "w") as log:
            device = subprocess.Popen([G4_DUMP, "sim", "-q", "--link", IDLE_PORT, "--log"], stderr=log)
        self.addCleanup(device.wait, support.PATIENCE)
        self.addCleanup(device.send_signal, signal.SIGINT)

        def commands():
            """The bytes of each command, in order."""
            with open(path) as log:
                return re.findall(r" A5 ([0-9A-F]{2}) ", log.read())

        def turns():
            """60 starts the scan, with the motor; 65 stops it."""
            scanning = [each for each in commands() if each in ("60", "65")]
            return scanning[-1:] == ["60"]
        self.wait_for_state("idle", State.PRIMARY_STATE_ACTIVE)
        # 90 asks for the device information: the lidar is open.
        self.assertTrue(support.wait_for(lambda: "90" in commands()))
        time.sleep(2.0)  # in which nothing happens
        self.assertNotIn("60", commands())
        for _ in range(2):
            scans = []
            subscription = self.watcher.node.create_subscription(LaserScan, "/idle/scan", scans.append, 10)
            self.assertTrue(support.wait_for(lambda: len(scans) > 2))
            self.assertTrue(turns())
            left = time.monotonic()
            self.watcher.node.destroy_subscription(subscription)
            self.assertTrue(support.wait_for(lambda: not turns()))
            # 3 s after the node has last seen the subscriber, which may have been before on a busy machine.
            self.assertGreater(time.monotonic() - left, 2.0)

class TestQuality(NodeTest):
    def test_overrides(self):
        self.wait_for_state("quality", State.PRIMARY_STATE_ACTIVE)
        reliability = {}
        for topic in ("/quality/scan", "/quality/points"):
            self.watcher.wait_for_publishers(topic, 1)
            reliability[topic] = self.watcher.node.get_publishers_info_by_topic(topic)[0].qos_profile.reliability
        self.assertEqual(reliability["/quality/scan"], ReliabilityPolicy.BEST_EFFORT)
        self.assertEqual(reliability["/quality/points"], ReliabilityPolicy.RELIABLE)


class TestParameters(NodeTest):
    def get(self, name):
        request = GetParameters.Request(names=[name])
        return self.watcher.call(GetParameters, "/values/g4lidar/get_parameters", request).values[0]

    def set(self, name, value):
        request = SetParameters.Request(parameters=[Parameter(name=name, value=value)])
        return self.watcher.call(SetParameters, "/values/g4lidar/set_parameters", request).results[0]

    def test_settings_of_the_device(self):
        scans = self.scans("values")
        self.assertTrue(support.wait_for(lambda: scans))
        self.assertTrue(self.set("frequency", double(9.5)).successful)
        self.assertEqual(self.get("frequency").double_value, 9.5)
        # The lidar turns so: a revolution takes 1 / 9.5 s.
        self.assertTrue(support.wait_for(lambda: scans and abs(scans[-1].scan_time - 1 / 9.5) < 0.005))
        self.assertFalse(self.set("frequency", double(20.0)).successful)
        self.assertEqual(self.get("frequency").double_value, 9.5)
        refused = self.set("source", text("sim:"))
        self.assertFalse(refused.successful)

    def test_filters(self):
        scans = self.scans("values")
        self.assertTrue(support.wait_for(lambda: len(scans) > 2))
        self.assertLessEqual(max(each for each in scans[-1].ranges if each < 100.0), 9.0)
        self.assertTrue(self.set("fov", text("-90:90")).successful)
        # Behind the lidar nothing is kept: NaN in the first and in the last quarter.
        quarter = 178
        self.assertTrue(support.wait_for(
            lambda: all(each != each for each in [*scans[-1].ranges[:quarter], *scans[-1].ranges[-quarter:]])))
        refused = self.set("fov", text("north"))
        self.assertFalse(refused.successful)
        self.assertIn("north", refused.reason)
        self.assertTrue(self.set("fov", text("")).successful)

    def set_together(self, **values):
        request = SetParametersAtomically.Request(
            parameters=[Parameter(name=name, value=value) for name, value in values.items()])
        return self.watcher.call(SetParametersAtomically, "/values/g4lidar/set_parameters_atomically", request).result

    def test_all_or_none(self):
        self.assertTrue(support.wait_for(lambda: self.get("device.frequency").double_value > 0.0))
        self.assertTrue(self.set("frequency", double(7.0)).successful)
        refused = [{"ignore": text("30:east")}, {"range_max": double(500.0)}, {"source": text("sim:")},
                   {"sample_rate": text("many")}, {"near_as": text("far")}]
        for wrong in refused:
            result = self.set_together(frequency=double(9.0), range_min=double(0.5), **wrong)
            self.assertFalse(result.successful, wrong)
            self.assertTrue(result.reason, wrong)
            self.assertEqual(self.get("range_min").double_value, 0.0, wrong)
            self.assertEqual(self.get("frequency").double_value, 7.0, wrong)
        # The lidar was not asked, either.
        scans = self.scans("values")
        self.assertTrue(support.wait_for(lambda: len(scans) > 2))
        self.assertAlmostEqual(scans[-1].scan_time, 1 / 7.0, delta=0.005)
        self.assertTrue(self.set_together(frequency=double(9.0), range_min=double(0.5)).successful)
        self.assertEqual((self.get("range_min").double_value, self.get("frequency").double_value), (0.5, 9.0))
        self.assertTrue(self.set_together(frequency=double(7.0), range_min=double(0.0)).successful)

    @unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
    def test_while_the_lidar_is_searched(self):
        self.wait_for_state("searched", State.PRIMARY_STATE_ACTIVE)
        changes = (("fov", text("-90:90"), ""), ("fov", text("north"), "north"),
                   ("frequency", double(9.0), "not connected"), ("range_min", double(0.5), ""))
        longest = 0.0
        begin = time.monotonic()
        # An attempt takes 5 s, and the next one begins 0.5 s later: one begins and ends in this time.
        while time.monotonic() - begin < 7.0:
            for name, value, reason in changes:
                request = SetParameters.Request(parameters=[Parameter(name=name, value=value)])
                asked = time.monotonic()
                result = self.watcher.call(SetParameters, "/searched/g4lidar/set_parameters", request).results[0]
                longest = max(longest, time.monotonic() - asked)
                self.assertEqual(result.successful, not reason, name)
                self.assertIn(reason, result.reason)
        # An idle machine needs less than 0.1 s.
        self.assertLess(longest, 3.0)
        # When the lidar is there, the filters are those that were set.
        os.unlink(SEARCHED_PORT)
        os.close(SILENT)
        device = subprocess.Popen([G4_DUMP, "sim", "-q", "--link", SEARCHED_PORT])
        self.addCleanup(device.wait, support.PATIENCE)
        self.addCleanup(device.send_signal, signal.SIGINT)
        scans = self.scans("searched")
        self.assertTrue(support.wait_for(lambda: scans))
        quarter = 178
        self.assertTrue(all(each != each for each in [*scans[0].ranges[:quarter], *scans[0].ranges[-quarter:]]))
        self.assertGreater(min(each for each in scans[0].ranges if each == each), 0.5)

    def test_each_has_a_description(self):
        service = "/values/g4lidar/"
        names = self.watcher.call(ListParameters, service + "list_parameters", ListParameters.Request()).result.names
        ours = [name for name in names if "." not in name and name != "use_sim_time"
                and name != "start_type_description_service"]
        self.assertIn("sample_rate", ours)
        request = DescribeParameters.Request(names=ours)
        for each in self.watcher.call(DescribeParameters, service + "describe_parameters", request).descriptors:
            self.assertTrue(each.description, each.name)
            if each.name in ("source", "frame_id", "grid", "order"):
                self.assertTrue(each.read_only, each.name)


@launch_testing.post_shutdown_test()
class TestExit(unittest.TestCase):
    def test_exit_codes(self, proc_info):
        launch_testing.asserts.assertExitCodes(proc_info)
