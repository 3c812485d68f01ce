# SPDX-License-Identifier: MIT
"""What the launch tests share: programs of the library, recordings, and a node that waits for things."""

import os
import shutil
import subprocess
import tempfile
import threading
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor

# At least ten times what an idle machine needs.
PATIENCE = 60.0


def program(name, variable):
    """The path of a program of the library, or None."""
    return os.environ.get(variable) or shutil.which(name)


def recording(seconds=6, seed=7):
    """The path of a recording of a lidar on a robot that drives, with its odometry; None without g4-dump."""
    g4_dump = program("g4-dump", "G4_DUMP")
    if not g4_dump:
        return None
    directory = tempfile.mkdtemp(prefix="g4lidar-ros-")
    path = os.path.join(directory, "walk.mcap")
    raw = os.path.join(directory, "walk.bin")
    way = os.path.join(directory, "way.txt")
    driven = os.path.join(directory, "way.odo")
    with open(way, "w") as file:
        file.write("drive forward 0.4 0.3\ndrive turn 180 60\ndrive forward 0.4 0.3\n")
    subprocess.run([g4_dump, "sim", "-q", "--seconds", str(seconds), "--seed", str(seed), "--path", way, "--odometry",
                    driven, "-o", raw], check=True)
    subprocess.run([g4_dump, "convert", "-q", raw, path, "--odometry", driven], check=True)
    return path


class Watcher:
    """A node with a thread of its own, which collects messages."""

    def __init__(self, name="watcher"):
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        self.node = rclpy.create_node(name, context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.thread = threading.Thread(target=self.spin, daemon=True)
        self.thread.start()

    def spin(self):
        try:
            self.executor.spin()
        except Exception:  # the context is gone
            pass

    def close(self):
        self.executor.shutdown()
        self.thread.join(PATIENCE)
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)

    def collect(self, kind, topic, quality=10):
        """A list that grows with the messages of a topic."""
        found = []
        self.node.create_subscription(kind, topic, found.append, quality)
        return found

    def call(self, kind, name, request):
        """The reply of a service."""
        client = self.node.create_client(kind, name)
        assert client.wait_for_service(PATIENCE), name
        future = client.call_async(request)
        assert wait_for(future.done), name
        self.node.destroy_client(client)
        return future.result()


def wait_for(condition, longest=PATIENCE):
    """Whether the condition became true in time."""
    end = time.monotonic() + longest
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True
