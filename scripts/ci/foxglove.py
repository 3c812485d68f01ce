# SPDX-License-Identifier: MIT
"""foxglove.py RECORD GRID POINTS AGAIN: the messages that Foxglove recorded have the numbers of g4-dump's csv, and
so have the points AGAIN that g4-dump decodes from the record."""
import csv
import math
import struct
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

record, grid_file, points_file, again_file = sys.argv[1:]


def check(is_so, what):
    if not is_so:
        sys.exit(f'foxglove.py: {what}')


def near(one, other, most):
    return one == other or math.isnan(one) and math.isnan(other) or abs(one - other) <= most


def nanoseconds(stamp):
    return stamp.sec * 1_000_000_000 + stamp.nanosec


with open(grid_file, encoding='ascii') as file:
    grid = {int(row[1]): [float(word) for word in row[3:]] for row in list(csv.reader(file))[1:]}
with open(points_file, encoding='ascii') as file:
    points = {int(row['time_ns']): row for row in csv.DictReader(file)}

# In a later round of the recording the sensor clock goes on, so the times differ by its estimates.
first_round_ends = max(grid)

scans = clouds = returns = diagnostics = 0
with open(record, 'rb') as file:
    messages = make_reader(file, decoder_factories=[DecoderFactory()])
    for schema, channel, _, decoded in messages.iter_decoded_messages():
        check(channel.message_encoding == 'cdr' and schema.encoding == 'ros2msg', 'another encoding')
        if channel.topic in ('/scan', '/points') and nanoseconds(decoded.header.stamp) > first_round_ends:
            continue
        if channel.topic == '/scan':
            wanted = grid.get(nanoseconds(decoded.header.stamp))
            check(wanted is not None, 'a scan with another time')
            check(len(wanted) == len(decoded.ranges), 'another number of ranges')
            check(all(near(a, b, 1e-5) for a, b in zip(decoded.ranges, wanted)), 'another range')
            check(decoded.header.frame_id == 'laser', 'another frame')
            scans += 1
        elif channel.topic == '/points':
            check([(f.name, f.offset) for f in decoded.fields] == list(zip(
                ('x', 'y', 'z', 't', 'range', 'angle'), range(0, 24, 4))), 'other fields')
            stamp = nanoseconds(decoded.header.stamp)
            for at in range(0, len(decoded.data), decoded.point_step):
                x, y, z, t, distance, angle = struct.unpack_from('<fffIff', bytes(decoded.data), at)
                row = points.get(stamp + t)
                check(row is not None, 'a point with another time')
                check(near(distance, float(row['range_m']), 1e-5), 'another range of a point')
                check(near(math.degrees(angle), float(row['angle_deg']), 1e-4), 'another angle of a point')
                is_there = near(x, distance * math.cos(angle), 1e-4) and near(y, distance * math.sin(angle), 1e-4)
                check(is_there and z == 0, 'another place of a point')
                returns += 1
            clouds += 1
        elif channel.topic == '/diagnostics':
            check(any('rate' in status.name for status in decoded.status), 'no status of the rate')
            diagnostics += 1
check(scans >= 20 and clouds >= 20 and returns >= 10_000 and diagnostics >= 3,
      f'only {scans} scans, {clouds} clouds with {returns} points, {diagnostics} diagnostics')

# Consecutive points; the recording may have begun again.
with open(again_file, encoding='ascii') as file:
    again = [(row['angle_deg'], row['range_m']) for row in csv.DictReader(file)]
wanted = [(row['angle_deg'], row['range_m']) for row in points.values()]
begin = next((at for at in range(len(wanted)) if wanted[at:at + 50] == again[:50]), None)
check(begin is not None, 'the bytes in the record give other points')
same = 0
while same < len(again) and again[same] == wanted[(begin + same) % len(wanted)]:
    same += 1
check(same >= 10_000, f'only {same} of the points from the bytes of the record are the same')
print(f'Foxglove recorded {scans} scans, {clouds} clouds with {returns} points, and {diagnostics} diagnostics, '
      f'as g4-dump prints them; {same} points from its bytes')
