# SPDX-License-Identifier: MIT
# For scripts/ci/ros2: readers on Cyclone DDS of PyPI receive what g4-ros2 publishes of a recording, and compare it with
# the truth of the simulator, number by number. Arguments: the file of `g4-dump sim --truth`, the domain.
import math
import sys
import time
from dataclasses import dataclass

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import float64, sequence, uint8, uint32
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from ros2_messages import Header, LaserScan
from ros2_numbers import Truth
from rosbags.typesys import Stores, get_typestore


@dataclass
@final
class PointField(IdlStruct, typename="sensor_msgs::msg::dds_::PointField_"):
    name: str
    offset: uint32
    datatype: uint8
    count: uint32


@dataclass
@final
class PointCloud2(IdlStruct, typename="sensor_msgs::msg::dds_::PointCloud2_"):
    header: Header
    height: uint32
    width: uint32
    fields: sequence[PointField]
    is_bigendian: bool
    point_step: uint32
    row_step: uint32
    data: sequence[uint8]
    is_dense: bool


@dataclass
@final
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
@final
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
@final
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: Quaternion


@dataclass
@final
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
@final
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: sequence[TransformStamped]


HASHES = {"rt/scan": "sensor_msgs/msg/LaserScan", "rt/points": "sensor_msgs/msg/PointCloud2",
          "rt/diagnostics": "diagnostic_msgs/msg/DiagnosticArray", "rt/tf": "tf2_msgs/msg/TFMessage",
          "rt/tf_static": "tf2_msgs/msg/TFMessage", "rt/odom": "nav_msgs/msg/Odometry",
          "rt/clock": "rosgraph_msgs/msg/Clock"}
RELIABLE = Policy.Reliability.Reliable(duration(seconds=1))
LONGEST_S = 60
SLOW_S = 1.5


def check_hashes(participant):
    store = get_typestore(Stores.ROS2_HUMBLE)
    found = {}
    reader = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
    end = time.monotonic() + LONGEST_S
    while time.monotonic() < end and not HASHES.keys() <= found.keys():
        for each in reader.take(100):
            data = each.qos[Policy.Userdata] if each.qos and Policy.Userdata in each.qos else None
            if data:
                found[each.topic_name] = bytes(data.data).decode()
        time.sleep(0.05)
    for topic, name in HASHES.items():
        assert found.get(topic) == f"typehash={store.hash_rihs01(name)};", (topic, found.get(topic))
    return len(HASHES)


def reader_of(participant, name, kind, *policies):
    return DataReader(participant, Topic(participant, name, kind), qos=Qos(*policies))


def check_place(participant):
    """A late subscriber gets the place of the lidar that --mount 0.2,-0.1,90 gives."""
    reader = reader_of(participant, "rt/tf_static", TFMessage, RELIABLE, Policy.Durability.TransientLocal,
                       Policy.History.KeepLast(1))
    end = time.monotonic() + LONGEST_S
    while not (got := reader.take(1)):
        assert time.monotonic() < end, "nothing on /tf_static"
        time.sleep(0.01)
    (place,) = got[0].transforms
    assert (place.header.frame_id, place.child_frame_id) == ("base_link", "laser"), place
    at, turn = place.transform.translation, place.transform.rotation
    wanted = (0.2, -0.1, 0, 0, 0, math.sqrt(0.5), math.sqrt(0.5))
    assert math.dist((at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w), wanted) < 1e-9, place


def main():
    truth = Truth(sys.argv[1])
    participant, other = (DomainParticipant(int(sys.argv[2])) for _ in range(2))
    fast = reader_of(participant, "rt/scan", LaserScan, RELIABLE, Policy.History.KeepLast(100))
    clouds = reader_of(participant, "rt/points", PointCloud2, RELIABLE, Policy.History.KeepLast(100))
    best_effort = reader_of(other, "rt/scan", LaserScan, Policy.Reliability.BestEffort, Policy.History.KeepLast(100))
    slow = reader_of(other, "rt/scan", LaserScan, RELIABLE, Policy.History.KeepLast(1))
    seen = {"reliable": [], "best effort": [], "slow": [], "clouds": []}
    begin = time.monotonic()
    slow_due = begin + SLOW_S

    def take(name, reader, check):
        seen[name] += [number for message in reader.take(100) if (number := check(message)) is not None]

    while min(len(seen[name]) for name in ("reliable", "best effort", "clouds")) < 30 or len(seen["slow"]) < 2:
        assert time.monotonic() < begin + LONGEST_S, seen
        take("clouds", clouds, truth.check_cloud)
        take("reliable", fast, truth.check_scan)
        take("best effort", best_effort, truth.check_scan)
        if time.monotonic() > slow_due:
            take("slow", slow, truth.check_scan)
            slow_due += SLOW_S
        time.sleep(0.01)
    # Each revolution after the other, until the recording begins again; the slow one gets the newest when it reads.
    numbers = seen["reliable"]
    assert all(after == before + 1 or after < before for before, after in zip(numbers, numbers[1:])), numbers
    assert len(seen["slow"]) < len(numbers) / 3, seen
    check_place(participant)
    print("cyclonedds of PyPI: " + ", ".join(f"{len(numbers)} {name}" for name, numbers in seen.items()) +
          f" as the simulator has them; a late subscriber of /tf_static; {check_hashes(participant)} type hashes as "
          f"rosbags computes them")


main()
