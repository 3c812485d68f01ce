# SPDX-License-Identifier: MIT
# For scripts/ci/ros2: Cyclone DDS of PyPI reads the announcement of the node of g4-ros2, and compares it with what DDS
# reports of the same participant; the hash is that which rosbags computes. Arguments: humble or iron, the domain.
import sys
import time
from dataclasses import dataclass

from cyclonedds.builtin import (BuiltinDataReader, BuiltinTopicDcpsParticipant, BuiltinTopicDcpsPublication,
                                BuiltinTopicDcpsSubscription)
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import array, bounded_str, sequence, uint8
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from rosbags.typesys import Stores, get_typestore

SIZE = {"humble": 24, "iron": 16}[sys.argv[1]]
STORE = {"humble": Stores.ROS2_HUMBLE, "iron": Stores.LATEST}[sys.argv[1]]


@dataclass
@final
class Gid(IdlStruct, typename="rmw_dds_common::msg::dds_::Gid_"):
    data: array[uint8, SIZE]


@dataclass
@final
class NodeEntitiesInfo(IdlStruct, typename="rmw_dds_common::msg::dds_::NodeEntitiesInfo_"):
    node_namespace: bounded_str[256]
    node_name: bounded_str[256]
    reader_gid_seq: sequence[Gid]
    writer_gid_seq: sequence[Gid]


@dataclass
@final
class ParticipantEntitiesInfo(IdlStruct, typename="rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"):
    gid: Gid
    node_entities_info_seq: sequence[NodeEntitiesInfo]


def gid_of(key):
    return key.bytes.ljust(SIZE, b"\0")


def user_data(one):
    return bytes(one.qos[Policy.Userdata].data).decode() if Policy.Userdata in one.qos else ""


def found(participant):
    """What DDS reports of the one other participant."""
    others = {gid_of(one.key): user_data(one) for one in BuiltinDataReader(participant, BuiltinTopicDcpsParticipant).take(99)
              if one.key != participant.guid}
    writers, readers = (
        {gid_of(one.key): (one.topic_name, user_data(one)) for one in BuiltinDataReader(participant, kind).take(999)
         if gid_of(one.participant_key) in others}
        for kind in (BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription))
    return others, writers, readers


def main():
    participant = DomainParticipant(int(sys.argv[2]))
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal,
              Policy.History.KeepAll)
    reader = DataReader(participant, Topic(participant, "ros_discovery_info", ParticipantEntitiesInfo), qos=qos)
    wanted_hash = f"typehash={get_typestore(STORE).hash_rihs01('rmw_dds_common/msg/ParticipantEntitiesInfo')};"
    end = time.monotonic() + 30
    info = None
    while time.monotonic() < end:
        for info in reader.take(10):
            assert len(info.node_entities_info_seq) == 1, info
        others, writers, readers = found(participant)
        own = [gid for gid, (topic, _) in writers.items() if topic == "ros_discovery_info"]
        if info and own:
            node = info.node_entities_info_seq[0]
            got = [{bytes(each.data) for each in gids} for gids in (node.writer_gid_seq, node.reader_gid_seq)]
            if got == [set(writers) - set(own), set(readers)]:
                break
        time.sleep(0.05)
    else:
        raise AssertionError((info, others, writers, readers))
    assert (node.node_namespace, node.node_name) == ("/", "g4lidar"), node
    assert others == {bytes(info.gid.data): "enclave=/;"}, others
    assert [writers[each][1] for each in own] == [wanted_hash], (writers, wanted_hash)
    assert {"rt/scan", "rt/points"} <= {topic for topic, _ in writers.values()}, writers
    print(f"cyclonedds of PyPI: the node /g4lidar as {sys.argv[1]} has it, with {len(writers) - 1} publishers and "
          f"{len(readers)} subscriptions")


main()
