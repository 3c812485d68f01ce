# SPDX-License-Identifier: MIT
"""foreign-robot.py <prefix>: reads <prefix>-angle.mcap and <prefix>-time.mcap, recordings of a robot that drives, with
PyPI's rosbags, and holds each message against what g4-dump writes as text of the same bytes: <prefix>.csv (points, in
metres, with the time by the wall clock), <prefix>-grid.csv (720 ranges of each scan in the robot's frame), and
<prefix>.odo. The lidar is mounted at 0.2, -0.1, turned by 90 degrees, with its top down."""

import csv
import math
import sys
from pathlib import Path

import numpy
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

BINS = 720
NS = 10**9
prefix = sys.argv[1]
TYPES = {
    "/scan": "sensor_msgs/msg/LaserScan",
    "/points": "sensor_msgs/msg/PointCloud2",
    "/odom": "nav_msgs/msg/Odometry",
    "/tf_static": "tf2_msgs/msg/TFMessage",
}


def messages_of(order):
    """Of each topic. The types are those of the schemas in the file."""
    with AnyReader([Path(f"{prefix}-{order}.mcap")], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        found = {each.topic: each.msgtype for each in reader.connections}
        assert {topic: found.get(topic) for topic in TYPES} == TYPES, found
        connections = [each for each in reader.connections if each.topic in TYPES]
        messages = {topic: [] for topic in TYPES}
        for connection, _, data in reader.messages(connections=connections):
            messages[connection.topic].append(reader.deserialize(data, connection.msgtype))
        return messages


def count_by_mcap(order):
    """The messages of the file, with all checksums, as a stream and by its summary."""
    with open(f"{prefix}-{order}.mcap", "rb") as file:
        records = list(StreamReader(file, validate_crcs=True).records)
        file.seek(0)
        statistics = make_reader(file, validate_crcs=True).get_summary().statistics
        file.seek(0)
        indexed = sum(1 for _ in make_reader(file, validate_crcs=True).iter_messages())
    assert records and indexed == statistics.message_count == sum(statistics.channel_message_counts.values())
    assert statistics.channel_count == 7 and statistics.schema_count == 6
    return indexed


def stamp_of(message):
    return message.header.stamp.sec * NS + message.header.stamp.nanosec


def scans_of_csv():
    """The time of the first point of each scan, and its returns: angle as in the csv, range, time."""
    scans = {}
    with open(f"{prefix}.csv", encoding="ascii") as file:
        for line in csv.DictReader(file):
            row = (float(line["angle_deg"]), float(line["range_m"]), int(line["time_ns"]))
            begin, returns = scans.setdefault(line["scan"], (row[2], []))
            if row[1] > 0:
                returns.append(row)
    return [(begin, numpy.array(returns)) for begin, returns in scans.values()]


def close(what, one, other, most):
    worst = numpy.max(numpy.abs(numpy.asarray(one, dtype=float) - numpy.asarray(other, dtype=float)))
    assert worst <= most, (what, worst)


def the_scan_at(stamp, scans):
    """The wall clock of a recording is measured anew at times: it need not be that of the csv to the last bit."""
    begin, returns = min(scans, key=lambda scan: abs(scan[0] - stamp))
    assert abs(begin - stamp) < 5_000_000, "the stamp is not that of a first ray"
    return begin, returns


def check_cloud(cloud, scans, left):
    begin, returns = the_scan_at(stamp_of(cloud), scans)
    assert [field.name for field in cloud.fields] == ["x", "y", "z", "t", "range", "angle"]
    assert [field.offset for field in cloud.fields] == [0, 4, 8, 12, 16, 20]
    assert [field.datatype for field in cloud.fields] == [7, 7, 7, 6, 7, 7]
    assert (cloud.height, cloud.width, cloud.point_step) == (1, len(returns), 24)
    assert cloud.row_step == 24 * len(returns) and cloud.is_dense and not cloud.is_bigendian
    form = [(name, "<u4" if name == "t" else "<f4") for name in ("x", "y", "z", "t", "range", "angle")]
    points = numpy.frombuffer(cloud.data.tobytes(), dtype=form)
    bearing = numpy.radians(180.0 - returns[:, 0]) * left
    close("t", points["t"], returns[:, 2] - begin, 0.5 + 256)  # floats hold the times of the csv to 256 ns
    close("range", points["range"], returns[:, 1], 1e-5)
    close("angle", numpy.remainder(points["angle"] - bearing + 3, 2 * math.pi), 3, 1e-5)
    close("x", points["x"], returns[:, 1] * numpy.cos(bearing), 1e-4)
    close("y", points["y"], returns[:, 1] * numpy.sin(bearing), 1e-4)
    assert not points["z"].any()
    return len(points)


def check_scan(scan, scans, grid, by_time):
    begin, returns = the_scan_at(stamp_of(scan), scans)
    wanted = min(grid, key=lambda row: abs(row[0] - begin))[1]
    assert len(scan.ranges) == BINS == round((scan.angle_max - scan.angle_min) / scan.angle_increment) + 1
    close("increment", scan.angle_increment * BINS, 2 * math.pi, 1e-5)
    if not by_time:
        assert scan.time_increment == 0
        close("angle_min", scan.angle_min, -math.pi, 1e-6)
        assert all(a == b or math.isnan(a) and math.isnan(b) or abs(a - b) < 1e-5 for a, b in zip(scan.ranges, wanted))
        return 0
    close("time_increment", scan.time_increment * BINS, scan.scan_time, 1e-6)
    close("scan_time", scan.scan_time, 1 / 7, 0.01)
    turned = returns[:, 0] - 180.0  # the angle with z down
    missing = 0
    for i, found in enumerate(scan.ranges):
        angle = math.degrees(scan.angle_min + i * scan.angle_increment)
        same = wanted[round((180.0 - angle) / 360.0 * BINS) % BINS]  # the bin at the opposite angle, from -180 degrees
        if not math.isfinite(found):
            missing += math.isfinite(same)
            continue
        off = numpy.abs(numpy.remainder(turned - angle + 180.0, 360.0) - 180.0)
        late = numpy.abs((returns[:, 2] - begin) / NS - i * scan.time_increment)
        there = (off < 180.0 / BINS + 1e-3) & (numpy.abs(returns[:, 1] - found) < 1e-5) & (late < 5 / 360 / 7)
        assert there.any(), (i, found)
        missing += found != same and abs(found - same) > 1e-5
    assert missing < 20, missing  # at the seam only
    return missing


def check_odometry(messages, lines):
    assert len(lines) >= len(messages) >= len(lines) - 1
    before = None
    for message, (time_ns, x, y, yaw) in zip(messages, lines):
        assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_link")
        assert stamp_of(message) - stamp_of(messages[0]) == time_ns - lines[0][0]
        pose, twist = message.pose.pose, message.twist.twist
        close("position", [pose.position.x, pose.position.y, pose.position.z], [x, y, 0], 1e-9)
        turn = pose.orientation
        sign = math.copysign(1, turn.w * math.cos(yaw / 2))  # both signs are the same rotation
        turned = [0, 0, sign * math.sin(yaw / 2), sign * math.cos(yaw / 2)]
        close("orientation", [turn.x, turn.y, turn.z, turn.w], turned, 1e-9)
        if before:
            seconds = (time_ns - before[0]) / NS
            way = math.hypot(x - before[1], y - before[2])
            close("speed", math.hypot(twist.linear.x, twist.linear.y) * seconds, way, 1e-5)
            close("rate", math.remainder(twist.angular.z * seconds - (yaw - before[3]), 2 * math.pi), 0, 1e-9)
        assert not message.pose.covariance.any() and not message.twist.covariance.any()
        before = (time_ns, x, y, yaw)
    return len(messages)


def check_transform(messages, z_down):
    assert len(messages) == 1 and len(messages[0].transforms) == 1
    found = messages[0].transforms[0]
    assert (found.header.frame_id, found.child_frame_id) == ("base_link", "laser")
    place, turn = found.transform.translation, found.transform.rotation
    close("place", [place.x, place.y, place.z], [0.2, -0.1, 0], 1e-9)
    x, y, z, w = turn.x, turn.y, turn.z, turn.w
    # Where the axes of the lidar point: x to the left of the robot; z down, which --order time turns up again.
    close("x axis", [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], [0, 1, 0], 1e-9)
    close("z axis", 1 - 2 * (x * x + y * y), 1 if z_down else -1, 1e-9)


scans = scans_of_csv()
with open(f"{prefix}-grid.csv", encoding="ascii") as file:
    rows = [line.rstrip("\n").split(",") for line in file][1:]
grid = [(int(row[1]), [float(word) for word in row[3:]]) for row in rows]
with open(f"{prefix}.odo", encoding="ascii") as file:
    lines = [(int(words[0]), *map(float, words[1:])) for words in map(str.split, file)]

for order in ("angle", "time"):
    by_time = order == "time"
    messages = messages_of(order)
    assert len(messages["/scan"]) == len(messages["/points"]) == len(grid) > 10
    points = sum(check_cloud(each, scans, -1 if by_time else 1) for each in messages["/points"])
    missing = sum(check_scan(each, scans, grid, by_time) for each in messages["/scan"])
    poses = check_odometry(messages["/odom"], lines)
    check_transform(messages["/tf_static"], by_time)
    count = count_by_mcap(order)
    print(f"{prefix.split('/')[-1]}-{order}.mcap: {count} messages by mcap, {len(grid)} LaserScan ({missing} ranges left out at the seams), "
          f"{points} points of PointCloud2, {poses} Odometry and a TFMessage by rosbags: as in the csv and .odo")
