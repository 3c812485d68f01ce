# SPDX-License-Identifier: MIT
"""The process of the node: Ctrl-C ends it with the motor at rest, and it does not grow."""

import os
import select
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import launch
import launch_testing.actions
from launch.actions import ExecuteProcess
from ament_index_python.packages import get_package_prefix
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

    @unittest.skipUnless(G4_DUMP, "SKIPPED: g4-dump is not installed")
    def test_ends_with_the_motor_at_rest(self):
        link = os.path.join(tempfile.mkdtemp(prefix="g4lidar-ros-"), "g4")
        device = subprocess.Popen([G4_DUMP, "sim", "-q", "--link", link])
        self.assertTrue(support.wait_for(lambda: os.path.exists(link)))
        node = run_node(link)
        scans = self.watcher.collect(LaserScan, "/scan")
        self.assertTrue(support.wait_for(lambda: len(scans) > 2))
        begin = time.monotonic()
        node.send_signal(signal.SIGINT)
        code = node.wait(support.PATIENCE)
        took = time.monotonic() - begin
        self.assertEqual(code, 0)
        print(f"ended after {took:.2f} s")
        if os.getloadavg()[0] < (os.cpu_count() or 1):
            self.assertLess(took, 2.0)
        self.assertEqual(bytes_within(link, 1.0), 0, "it still scans")
        device.send_signal(signal.SIGINT)
        device.wait(support.PATIENCE)

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
