# SPDX-License-Identifier: MIT
"""What the launch tests share: programs of the library, recordings, and a node that waits for things."""

import gc
import glob
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import time

import rclpy
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.executors import SingleThreadedExecutor

# At least ten times what an idle machine needs.
PATIENCE = 60.0


def program(name, variable):
    """The path of a program of the library, or None."""
    return os.environ.get(variable) or shutil.which(name)


def recordings(seconds=6, seed=7, world=None, way="drive forward 0.4 0.3\ndrive turn 180 60\ndrive forward 0.4 0.3\n"):
    """Two recordings of a lidar on a robot that drives: with its odometry, and without; None without g4-dump."""
    g4_dump = program("g4-dump", "G4_DUMP")
    if not g4_dump:
        return None, None
    directory = tempfile.mkdtemp(prefix="g4lidar-ros-")
    raw, path, driven, made, bare = (
        os.path.join(directory, name) for name in ("walk.bin", "way.txt", "way.odo", "walk.mcap", "bare.mcap"))
    options = []
    if world:
        options = ["--world", os.path.join(directory, "world.txt")]
        with open(options[1], "w") as file:
            file.write(world)
    with open(path, "w") as file:
        file.write(way)
    subprocess.run([g4_dump, "sim", "-q", "--seconds", str(seconds), "--seed", str(seed), *options, "--path", path,
                    "--odometry", driven, "-o", raw], check=True)
    subprocess.run([g4_dump, "convert", "-q", raw, made, "--odometry", driven], check=True)
    subprocess.run([g4_dump, "convert", "-q", raw, bare], check=True)
    return made, bare


def stamp_of(message):
    """In nanoseconds since 1970."""
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


def waited_for_processor(pid):
    """How long the threads of a process that exist have waited for a processor, seconds."""
    waited_ns = 0
    for path in glob.glob(f"/proc/{pid}/task/*/schedstat"):
        try:
            with open(path) as file:
                waited_ns += int(file.read().split()[1])
        except (OSError, IndexError):  # the thread has ended
            pass
    return waited_ns * 1e-9


def processes_of(group):
    """The command lines of the processes of a group that have not ended."""
    found = []
    for path in glob.glob("/proc/[0-9]*"):
        try:
            with open(path + "/cmdline") as file:
                words = file.read().split("\0")
            if words != [""] and os.getpgid(int(path[6:])) == group:
                found.append(words)
        except OSError:  # it has ended
            pass
    return found


def interrupted(process):
    """Sends SIGINT to a process. Returns how long it took to end, seconds, and whether other programs delayed it, or this
    test: then the time does not describe the process."""
    late = 0.0
    before = waited = waited_for_processor(process.pid)
    begin = awake = time.monotonic()
    process.send_signal(signal.SIGINT)
    while process.poll() is None:
        if awake - begin > PATIENCE:
            process.kill()
        waited = max(waited, waited_for_processor(process.pid))
        time.sleep(0.005)
        now = time.monotonic()
        late += max(0.0, now - awake - 0.02)
        awake = now
    return awake - begin, late > 0.02 or waited - before > 0.1


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
        # Cyclone DDS with Humble has room for 10 participants in a domain: this one goes now.
        self.executor = self.thread = self.node = self.context = None
        gc.collect()

    def collect(self, kind, topic, quality=10):
        """A list that grows with the messages of a topic."""
        found = []
        self.node.create_subscription(kind, topic, found.append, quality)
        return found

    def wait_for_publishers(self, topic, count):
        assert wait_for(lambda: self.node.count_publishers(topic) >= count), topic

    def state(self, node):
        """The state of a lifecycle node by its full name."""
        return self.call(GetState, node + "/get_state", GetState.Request()).current_state.id

    def change_state(self, node, transition):
        request = ChangeState.Request(transition=Transition(id=transition))
        return self.call(ChangeState, node + "/change_state", request).success

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
