# SPDX-License-Identifier: MIT
# For scripts/ci/ros2: a reader on Cyclone DDS of PyPI receives what g4-ros2 publishes of a recording, and compares it
# with what g4-dump prints of it, number by number. Arguments: the grid and the points as csv, the domain.
import sys
import time
from dataclasses import dataclass

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import sequence, uint8, uint32
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from ros2_messages import Header, LaserScan
from ros2_numbers import check_cloud, check_scan, nearest, stamp_ns, wanted_clouds, wanted_scans
from ros2_services import check_services
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


HASHES = {"rt/scan": "sensor_msgs/msg/LaserScan", "rt/points": "sensor_msgs/msg/PointCloud2",
          "rt/diagnostics": "diagnostic_msgs/msg/DiagnosticArray", "rt/tf": "tf2_msgs/msg/TFMessage",
          "rt/odom": "nav_msgs/msg/Odometry", "rt/clock": "rosgraph_msgs/msg/Clock"}


def check_hashes(participant):
    store = get_typestore(Stores.ROS2_HUMBLE)
    found = {}
    reader = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
    end = time.monotonic() + 20
    while time.monotonic() < end and not HASHES.keys() <= found.keys():
        for each in reader.take(100):
            data = each.qos[Policy.Userdata] if each.qos and Policy.Userdata in each.qos else None
            if data:
                found[each.topic_name] = bytes(data.data).decode()
        time.sleep(0.05)
    for topic, name in HASHES.items():
        assert found.get(topic) == f"typehash={store.hash_rihs01(name)};", (topic, found.get(topic))
    return len(HASHES)


def main():
    scans, clouds = wanted_scans(sys.argv[1]), wanted_clouds(sys.argv[2])
    participant = DomainParticipant(int(sys.argv[3]))
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(100))
    scan_reader = DataReader(participant, Topic(participant, "rt/scan", LaserScan), qos=qos)
    cloud_reader = DataReader(participant, Topic(participant, "rt/points", PointCloud2), qos=qos)
    print("ready", flush=True)
    seen = [0, 0]
    end = time.monotonic() + 60
    while time.monotonic() < end and min(seen) < 15:
        for scan in scan_reader.take(100):
            check_scan(scan, nearest(scans, stamp_ns(scan.header)))
            seen[0] += 1
        for cloud in cloud_reader.take(100):
            check_cloud(cloud, nearest(clouds, stamp_ns(cloud.header)))
            seen[1] += 1
        time.sleep(0.01)
    assert min(seen) >= 15, seen
    print(f"cyclonedds of PyPI: {seen[0]} scans and {seen[1]} clouds as g4-dump prints them; "
          f"{check_hashes(participant)} type hashes as rosbags computes them; {check_services(participant)} calls of services")


main()
