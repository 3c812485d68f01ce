# SPDX-License-Identifier: MIT
"""The process of the node: Ctrl-C ends it with the motor at rest, and it does not grow."""

import os
import pty
import re
import select
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import launch
import launch_testing.actions
from launch.actions import ExecuteProcess
from ament_index_python.packages import get_package_prefix
from lifecycle_msgs.msg import State, Transition
from sensor_msgs.msg import LaserScan, PointCloud2

sys.path.insert(0, os.path.dirname(__file__))
import support  # noqa: E402

NODE = os.path.join(get_package_prefix("g4lidar_ros"), "lib", "g4lidar_ros", "lidar_node")
G4_DUMP = support.program("g4-dump", "G4_DUMP")
# The nightly: 600.
GROWTH_SECONDS = float(os.environ.get("G4LIDAR_GROWTH_SECONDS", "20"))


def generate_test_description():
    # The tests run while some process of the description does.
    return launch.LaunchDescription([ExecuteProcess(cmd=["sleep", "100000"]), launch_testing.actions.ReadyToTest()])


def run_node(source, *arguments):
    return subprocess.Popen([NODE, "--ros-args", "-p", f"source:='{source}'", "-p", "autostart:=true", *arguments])


def resident_kib(process):
    with open(f"/proc/{process.pid}/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS:"))


def bytes_within(path, seconds):
    """How many bytes a port sends."""
    port = os.open(path, os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)
    count = 0
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if select.select([port], [], [], 0.1)[0]:
            count += len(os.read(port, 65536))
    os.close(port)
    return count


class TestProcess(unittest.TestCase):
    def setUp(self):
        self.watcher = support.Watcher()

    def tearDown(self):
        self.watcher.close()

    def ends_within_2_s(self, start, check=lambda: None):
        """`start` starts a node, which Ctrl-C ends within 2 s (an idle machine needs 0.2 s). Where it takes longer while
        other programs delay it, it is repeated."""
        for _ in range(3):
            node = start()
            took, was_delayed = support.interrupted(node)
            print(f"ended after {took:.2f} s" + (", delayed by other programs" if was_delayed else ""))
            self.assertEqual(node.returncode, 0)
            check()
            if took < 2.0:
                return
            self.assertTrue(was_delayed, took)
        self.skipTest("SKIPPED: other programs delay the node")

    @unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
    def test_ends_with_the_motor_at_rest(self):
        link = os.path.join(tempfile.mkdtemp(prefix="g4lidar-ros-"), "g4")
        device = subprocess.Popen([G4_DUMP, "sim", "-q", "--link", link])
        self.addCleanup(device.wait, support.PATIENCE)
        self.addCleanup(device.send_signal, signal.SIGINT)
        self.assertTrue(support.wait_for(lambda: os.path.exists(link)))
        scans = self.watcher.collect(LaserScan, "/scan")

        def start():
            node = run_node(link)
            count = len(scans)
            self.assertTrue(support.wait_for(lambda: len(scans) > count + 2))
            return node
        self.ends_within_2_s(start, lambda: self.assertEqual(bytes_within(link, 1.0), 0, "it still scans"))

    @unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
    def test_transitions_open_the_port_turn_the_motor_rest_it_and_close_the_port(self):
        directory = tempfile.mkdtemp(prefix="g4lidar-ros-")
        link, path = os.path.join(directory, "g4"), os.path.join(directory, "commands.txt")
        with open(path, "w") as log:
            device = subprocess.Popen([G4_DUMP, "sim", "-q", "--link", link, "--log"], stderr=log)
        self.addCleanup(device.wait, support.PATIENCE)
        self.addCleanup(device.send_signal, signal.SIGINT)
        self.assertTrue(support.wait_for(lambda: os.path.exists(link)))
        port = os.path.realpath(link)
        node = subprocess.Popen([NODE, "--ros-args", "-p", f"source:={link}", "-r", "__ns:=/steps"])
        self.addCleanup(node.wait, support.PATIENCE)
        self.addCleanup(node.send_signal, signal.SIGINT)

        def is_open():
            files = f"/proc/{node.pid}/fd"
            return port in [os.path.realpath(os.path.join(files, each)) for each in os.listdir(files)]

        def turns():
            """60 starts the scan, with the motor; 65 stops it."""
            with open(path) as log:
                scanning = [each for each in re.findall(r" A5 ([0-9A-F]{2}) ", log.read()) if each in ("60", "65")]
            return scanning[-1:] == ["60"]
        self.watcher.state("/steps/g4lidar")
        self.assertFalse(is_open())
        for transition, opened, turned in ((Transition.TRANSITION_CONFIGURE, True, False),
                                           (Transition.TRANSITION_ACTIVATE, True, True),
                                           (Transition.TRANSITION_DEACTIVATE, True, False),
                                           (Transition.TRANSITION_CLEANUP, False, False)) * 2:
            self.assertTrue(self.watcher.change_state("/steps/g4lidar", transition))
            self.assertTrue(support.wait_for(lambda: turns() == turned), transition)
            self.assertEqual(is_open(), opened, transition)

    def test_ends_while_it_waits_for_a_lidar(self):
        def start():
            node = subprocess.Popen([NODE, "--ros-args", "-p", "source:=/dev/g4lidar-absent", "-p", "autostart:=true"],
                                    stderr=subprocess.PIPE, text=True)
            self.addCleanup(node.stderr.close)
            self.assertTrue(any("opening: " in line for line in node.stderr))
            return node
        self.ends_within_2_s(start)

    def test_ends_without_an_error_while_the_lidar_is_searched(self):
        searched, end = pty.openpty()  # something that does not answer
        self.addCleanup(os.close, end)
        self.addCleanup(os.close, searched)
        nodes = []

        def start():
            nodes.append(subprocess.Popen([NODE, "--ros-args", "-p", f"source:={os.ttyname(end)}", "-p", "autostart:=true"],
                                          stderr=subprocess.PIPE, text=True))
            self.addCleanup(nodes[-1].stderr.close)
            self.assertTrue(select.select([searched], [], [], support.PATIENCE)[0], "it sends nothing")
            return nodes[-1]
        self.ends_within_2_s(start, lambda: self.assertNotIn("[ERROR]", nodes[-1].stderr.read()))

    def test_ends_while_a_long_file_is_read(self):
        with tempfile.NamedTemporaryFile(suffix=".mcap") as file:
            file.write(b"\x89MCAP0\r\n")
            file.truncate(1 << 40)  # zeros, which take no place
            nodes = []

            def bytes_read():
                with open(f"/proc/{nodes[-1].pid}/io") as counts:
                    return int(counts.read().split()[1])

            def start():
                nodes.append(subprocess.Popen([NODE, "--ros-args", "-p", f"source:={file.name}", "-p", "autostart:=true"],
                                              stderr=subprocess.PIPE, text=True))
                self.addCleanup(nodes[-1].stderr.close)
                self.assertTrue(support.wait_for(lambda: bytes_read() > 1 << 27))
                return nodes[-1]
            # ROS itself reports that it cannot publish the transition any more.
            self.ends_within_2_s(start, lambda: self.assertNotIn("not configured", nodes[-1].stderr.read()))

    def fails(self, arguments, words):
        """The node ends with exit code 1, and its last words contain these."""
        done = subprocess.run([NODE, "--ros-args", *arguments], capture_output=True, text=True, timeout=support.PATIENCE)
        self.assertEqual(done.returncode, 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def parameter_file(self, text):
        path = os.path.join(tempfile.mkdtemp(prefix="g4lidar-ros-"), "bad.yaml")
        with open(path, "w") as file:
            file.write(text)
        return ["--params-file", path]

    def test_parameters_that_cannot_be_used_end_it_with_a_reason(self):
        head = "/**:\n  ros__parameters:\n    "
        self.fails(["--params-file", "/nonexistent.yaml"], ["/nonexistent.yaml"])
        self.fails(self.parameter_file("/**: [\n"), ["bad.yaml"])
        self.fails(self.parameter_file("source: here\n"), ["bad.yaml"])
        self.fails(self.parameter_file(head + "grid: many\n"), ["grid"])
        self.fails(self.parameter_file(head + "grid: -5\n"), ["grid"])
        self.fails(self.parameter_file(head + "grid: 99999999999999\n"), ["grid"])
        self.fails(self.parameter_file(head + "frame_id: [laser]\n"), ["frame_id"])
        self.fails(self.parameter_file(head + "source: 7\n"), ["source"])
        self.fails(self.parameter_file(head + "range_max: 200.0\n"), ["range_max"])
        self.fails(self.parameter_file(head + "frequency: 100.0\n"), ["frequency"])
        self.fails(self.parameter_file(head + "playback_speed: 0.0\n"), ["playback_speed"])
        self.fails(["-p", "connect_timeout:=-1.0"], ["connect_timeout"])
        self.fails(["-p", "frequency:=7.77"], ["frequency"])
        self.fails(["-p", "angle_min:=-1000.0"], ["angle_min"])
        self.fails(["-p", "standby:=maybe"], ["standby"])
        self.fails(["-p", "bond_heartbeat_period:=-0.1"], ["bond_heartbeat_period"])

    def not_configured(self, arguments, words):
        """configure fails with these words, and the node stays unconfigured."""
        with self.subTest(arguments=arguments), subprocess.Popen(
                [NODE, "--ros-args", "-p", "autostart:=true", "-r", "__ns:=/bad", *arguments],
                stderr=subprocess.PIPE, text=True) as node:
            output = []
            watchdog = threading.Timer(support.PATIENCE, node.kill)
            watchdog.start()
            for line in node.stderr:
                output.append(line)
                if "[ERROR]" in line:
                    break
            watchdog.cancel()
            # Of a device that is the error of a thread, which the node then finds.
            self.assertTrue(support.wait_for(
                lambda: self.watcher.state("/bad/g4lidar") == State.PRIMARY_STATE_UNCONFIGURED))
            node.send_signal(signal.SIGINT)
            node.communicate(timeout=support.PATIENCE)
            self.assertEqual(node.returncode, 0, output)
            for word in words:
                self.assertIn(word, output[-1])
        return "".join(output)

    def test_values_that_cannot_be_used_are_errors_of_configure(self):
        sim = ["-p", "source:='sim:'"]
        self.not_configured([*sim, "-p", "model:=g99"], ["model", "g99"])
        self.not_configured([*sim, "-p", "order:=size"], ["order", "size"])
        self.not_configured([*sim, "-p", "deskew:=magic"], ["deskew", "magic"])
        self.not_configured([*sim, "-p", "deskew:=tf", "-p", "order:=time"], ["order", "deskew"])
        self.not_configured([*sim, "-p", "mount:='1,2'"], ["mount"])
        self.not_configured([*sim, "-p", "mount:='nan,0,0'"], ["mount"])
        self.not_configured([*sim, "-p", "mask:=/nonexistent.mask"], ["mask", "/nonexistent.mask"])
        self.not_configured([*sim, "-p", "mask:=/tmp"], ["mask: '/tmp' is a directory. Give a file with lines 'polygon"])
        fifo = os.path.join(tempfile.mkdtemp(prefix="g4lidar-ros-"), "mask")
        os.mkfifo(fifo)
        self.not_configured([*sim, "-p", f"mask:={fifo}"], ["mask", fifo, "is a pipe or a device, not a file"])
        self.not_configured([*sim, "-p", "fov:=north"], ["fov", "north"])
        self.not_configured([*sim, "-p", "fov:=-90:90", "-p", "angle_min:=0.0"], ["fov", "angle_min"])
        self.not_configured([*sim, "-p", "frequency:=2.0"], ["frequency", "3 to 16"])
        self.not_configured([*sim, "-p", "direction:=up"], ["direction", "up"])
        self.not_configured([*sim, "-p", "range_min:=.nan"], ["range"])
        self.not_configured(["-p", "source:='sim:?seed=x'"], ["seed"])
        self.not_configured(["-p", "source:='sim:?model=x2'", "-p", "model:=g4"], ["model"])
        self.not_configured(["-p", "source:=/nonexistent.mcap", "-p", "connect_timeout:=0.5"], ["/nonexistent.mcap"])
        broken = os.path.join(tempfile.mkdtemp(prefix="g4lidar-ros-"), "broken.mcap")
        with open(broken, "wb") as file:
            file.write(b"\x89MCAP0\r\n" + b"this is no recording\n" * 100)
        self.not_configured(["-p", f"source:={broken}"], [broken])
        self.not_configured([*sim, "-p", "playback_speed:=.nan"], ["playback_speed"])
        self.not_configured([*sim, "-p", "connect_timeout:=.nan"], ["connect_timeout"])
        both = ["-p", "sources:=['front=sim:?seed=1', 'rear=sim:?seed=2']"]
        self.not_configured([*both, "-p", "order:=time"], ["order: time", "sources"])
        self.not_configured([*both, *sim], ["source", "sources"])
        self.not_configured([*both, "-p", "mount:='0,0,0'"], ["mount", "sources"])
        self.not_configured([*both, "-p", "mounts:=['left=0,0,0']"], ["mounts", "left"])
        self.not_configured([*both, "-p", "mounts:=['front=0,0']"], ["mounts"])
        self.not_configured(["-p", "sources:=['front=sim:?seed=1']"], ["sources"])
        self.not_configured(["-p", "sources:=['sim:?seed=1', 'rear=sim:?seed=2']"], ["sources", "NAME="])
        self.not_configured(["-p", "sources:=['a=sim:?seed=1', 'a=sim:?seed=2']"], ["two lidars", "same name"])
        self.not_configured(["-p", f"sources:=['front=sim:?seed=1', 'rear={broken}']"], ["sources", "file"])
        output = self.not_configured([*sim, "-p", "frequncy:=7.0", "-p", "model:=g99"], ["g99"])
        self.assertIn("'frequncy' is ignored", output)

    def test_does_not_grow(self):
        node = run_node("sim:?seed=3")
        scans = self.watcher.collect(LaserScan, "/scan")
        clouds = self.watcher.collect(PointCloud2, "/points")
        self.assertTrue(support.wait_for(lambda: len(scans) > 20 and len(clouds) > 20))
        before = resident_kib(node)
        end = time.monotonic() + GROWTH_SECONDS
        while time.monotonic() < end:
            time.sleep(1.0)
            del scans[:], clouds[:]
        after = resident_kib(node)
        print(f"{before} KiB, and {after} KiB after {GROWTH_SECONDS:.0f} s")
        self.assertLess(after - before, 2048)
        node.send_signal(signal.SIGINT)
        self.assertEqual(node.wait(support.PATIENCE), 0)
