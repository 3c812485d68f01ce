# SPDX-License-Identifier: MIT
"""foreign-readers.py <recording.mcap> <what is in it.txt>: reads a recording with PyPI's mcap, which sums up
everything, and with rosbags, and holds what comes out against what is known of it: a thing a line, as
make_recording prints them. Of what g4-dump has recorded less is known: `about`, and that in decimals."""

import math
import struct
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

RAW = ("/g4lidar/from_device", "/g4lidar/to_device")
MASK = 0xFFFFFFFFFFFFFFFF


def wanted_from(path):
    wanted = {"scans": [], "about": False, "topic": ["/scan"]}
    for line in Path(path).read_text(encoding="ascii").splitlines():
        name, *words = line.split()
        if name == "scan":
            wanted["scans"].append((int(words[0]), [float.fromhex(word) for word in words[1:]]))
        elif name == "about":
            wanted["about"] = True
            wanted["scans"].append((int(words[0]), [float(word) for word in words[1:]]))
        else:
            wanted[name] = words
    return wanted


def same(one, other):
    """Bit for bit, so that what was not measured is equal to itself."""
    return struct.pack(f"<{len(one)}f", *one) == struct.pack(f"<{len(other)}f", *other)


def close(one, other):
    """As near as five decimals are."""
    for a, b in zip(one, other):
        alike = math.isnan(a) if math.isnan(b) else a == b or abs(a - b) < 1e-5
        if not alike:
            return False
    return True


def digest(pieces):
    """FNV-1a as docs/recordings.md has it."""
    value, way = 0xCBF29CE484222325, None
    for topic, data in pieces:
        symbols = list(data)
        if way != topic:
            symbols.insert(0, 0x100 + RAW.index(topic))
        way = topic
        for symbol in symbols:
            value = (value ^ symbol) * 0x100000001B3 & MASK
    return f"{value:016x}"


def recorded_bytes(message):
    count = struct.unpack_from("<I", message, 12)[0]
    assert len(message) == 16 + count
    return message[16:]


def by_mcap(path, wanted):
    with open(path, "rb") as file:
        records = list(StreamReader(file, validate_crcs=True).records)
    assert records
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        statistics = summary.statistics
        assert reader.get_header().profile == "ros2"
        assert statistics.chunk_count == len(summary.chunk_indexes)
        counts = {
            channel.topic: statistics.channel_message_counts.get(id, 0)
            for id, channel in summary.channels.items()
        }
        assert counts[wanted["topic"][0]] == len(wanted["scans"]) > 0
        if not wanted["about"]:
            assert statistics.chunk_count == int(wanted["chunks"][0])
            assert counts["/g4lidar/from_device"] == int(wanted["from_device"][0])
        assert statistics.message_count == sum(counts.values())
        metadata = {each.name: each.metadata for each in reader.iter_metadata()}
        assert metadata["g4lidar.device"]["serial_number"] == "2021101000070073"
        assert metadata["g4lidar.digest"]["payload"] == wanted["payload"][0]
        # In the order of the file, which is that of the transport.
        messages = list(reader.iter_messages(topics=RAW, log_time_order=False))
        pieces = [(channel.topic, recorded_bytes(message.data)) for _, channel, message in messages]
        assert digest(pieces) == wanted["payload"][0]
        # Also by the indexes.
        middle = (statistics.message_start_time + statistics.message_end_time) // 2
        late = list(reader.iter_messages(topics=wanted["topic"], starting_at=middle))
        assert 0 < len(late) < len(wanted["scans"])
    return statistics.message_count


def by_rosbags(path, wanted):
    store = get_typestore(Stores.ROS2_HUMBLE)
    with AnyReader([Path(path)], default_typestore=store) as reader:
        connections = [each for each in reader.connections if each.topic == wanted["topic"][0]]
        assert len(connections) == 1
        assert connections[0].msgtype == "sensor_msgs/msg/LaserScan"
        scans = [
            reader.deserialize(data, each.msgtype)
            for each, _, data in reader.messages(connections=connections)
        ]
        raw = [each for each in reader.connections if each.topic == RAW[0]]
        first = next(reader.messages(connections=raw))
        message = reader.deserialize(first[2], raw[0].msgtype)
        if not wanted["about"]:
            assert message.monotonic_ns + 1_700_000_000 * 10**9 == first[1]
    assert len(scans) == len(wanted["scans"])
    for scan, (stamp, ranges) in zip(scans, wanted["scans"]):
        assert scan.header.frame_id == "lidar_frame"
        late_ns = scan.header.stamp.sec * 10**9 + scan.header.stamp.nanosec - stamp
        # Each message has the wall clock of its own time, not that of its chunk.
        assert abs(late_ns) <= (5_000_000 if wanted["about"] else 0)
        assert len(scan.ranges) == len(ranges)
        assert (close if wanted["about"] else same)(scan.ranges, ranges)
        assert abs(scan.angle_min + scan.angle_increment * len(ranges) / 2) < 1e-5
        assert abs(scan.angle_max - scan.angle_min - scan.angle_increment * (len(ranges) - 1)) < 1e-5


def main():
    path, text = sys.argv[1:]
    wanted = wanted_from(text)
    count = by_mcap(path, wanted)
    by_rosbags(path, wanted)
    print(f"{Path(path).name}: {count} messages by mcap, {len(wanted['scans'])} scans by rosbags")


main()
