# SPDX-License-Identifier: MIT
# For scripts/ci/ros2-nodes: a node of ROS 2 reads and commands the simulated lidar of g4-ros2. It prints "ready" before
# the lidar is there, then what it has seen. Argument: the middleware.
import math
import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan, PointCloud2
from std_msgs.msg import Bool

PATIENCE_S = 30
SCANS = 15
# As rosbags computes them: scripts/ci/ros2.
HASHES = {"/scan": "RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828",
          "/points": "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"}


class Probe:
    def __init__(self):
        self.node = rclpy.create_node("probe")
        self.scans, self.best_effort, self.clouds, self.states = [], [], [], set()
        self.node.create_subscription(LaserScan, "/scan", self.scans.append, 10)
        self.node.create_subscription(LaserScan, "/scan", self.best_effort.append, qos_profile_sensor_data)
        self.node.create_subscription(PointCloud2, "/points", self.clouds.append, qos_profile_sensor_data)
        self.node.create_subscription(DiagnosticArray, "/diagnostics", self.see, 10)
        self.run = self.node.create_publisher(Bool, "/g4lidar/run", 10)

    def see(self, message):
        self.states |= {(each.name, each.level, each.message) for each in message.status}

    def until(self, what, condition):
        """Spins until the condition holds; the seconds that it took."""
        begin = time.monotonic()
        while not condition():
            assert time.monotonic() < begin + PATIENCE_S, what
            rclpy.spin_once(self.node, timeout_sec=0.05)
        return time.monotonic() - begin

    def is_still(self):
        """Whether no scan has come for a second: seven revolutions."""
        count = len(self.scans)
        end = time.monotonic() + 1
        while time.monotonic() < end:
            rclpy.spin_once(self.node, timeout_sec=0.05)
        return len(self.scans) == count

    def turns(self):
        count = len(self.scans)
        self.until("no scans after a start", lambda: len(self.scans) > count + 3)

    def check_messages(self):
        took = self.until("no messages", lambda: min(len(self.scans), len(self.best_effort), len(self.clouds)) >= SCANS)
        for scan in self.scans:
            assert (scan.header.frame_id, len(scan.ranges)) == ("laser", 720), scan.header
            assert math.isclose(scan.angle_increment, math.tau / 720, rel_tol=1e-5), scan.angle_increment
        # The first revolution of a lidar that has just begun may be a part of one.
        returns = [sum(map(math.isfinite, scan.ranges)) for scan in self.scans]
        assert min(returns[2:]) > 360, returns
        stamps = [scan.header.stamp.sec + scan.header.stamp.nanosec * 1e-9 for scan in self.scans]
        gaps = [after - before for before, after in zip(stamps, stamps[1:])]
        assert 0.12 < sum(gaps) / len(gaps) < 0.16, gaps  # at 7 Hz
        assert abs(time.time() - stamps[-1]) < 5, stamps
        assert all(cloud.width * cloud.height > 360 for cloud in self.clouds[2:])
        return took

    def check_graph(self):
        self.until("no node /g4lidar", lambda: ("g4lidar", "/") in self.node.get_node_names_and_namespaces())
        for topic, wanted in HASHES.items():
            (publisher,) = self.node.get_publishers_info_by_topic(topic)
            found = getattr(publisher, "topic_type_hash", None)  # since Iron
            if found is not None:
                text = "RIHS0" + str(found.version) + "_" + bytes(found.value).hex()
                assert text == wanted, (topic, text)

    def check_run(self):
        self.until("nobody subscribes to run", lambda: self.run.get_subscription_count() > 0)
        self.run.publish(Bool(data=False))
        self.until("the motor turns", self.is_still)
        self.run.publish(Bool(data=True))
        self.turns()
        # What was acknowledged late is not lost.
        topics = {status for status in self.states if status[0] == "g4lidar: topics"}
        assert topics == {("g4lidar: topics", b"\0", "ok")}, topics


rclpy.init()
probe = Probe()
rclpy.spin_once(probe.node, timeout_sec=0.5)
print("ready", flush=True)
took = probe.check_messages()
probe.check_graph()
probe.check_run()
print(f"rclpy: {len(probe.scans)} scans reliable, {len(probe.best_effort)} best effort, {SCANS} of each after {took:.1f} s; "
      f"the node is listed; run turns the motor")
