# SPDX-License-Identifier: MIT
"""foreign-diagnostics.py <directory> <what is in it.txt>: rosbags reads the schema of a DiagnosticArray, which
must have the type hash of its own definition, and a message, which must have the contents that make_diagnostics
printed."""

import sys
from pathlib import Path

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

NAME = "diagnostic_msgs/msg/DiagnosticArray"


def main(directory, printed):
    wanted = []
    for line in Path(printed).read_text(encoding="ascii").splitlines():
        kind, *words = line.split("\t")
        if kind == "status":
            wanted.append((int(words[0]), *words[1:], []))
        else:
            wanted[-1][-1].append(tuple(words))
    own = get_typestore(Stores.ROS2_HUMBLE)
    store = get_typestore(Stores.EMPTY)
    schema = (Path(directory) / "schema.txt").read_text(encoding="ascii")
    store.register(get_types_from_msg(schema, NAME))
    assert store.hash_rihs01(NAME) == own.hash_rihs01(NAME)
    data = (Path(directory) / "message.cdr").read_bytes()
    for each in (own, store):
        message = each.deserialize_cdr(data, NAME)
        stamp = message.header.stamp
        assert stamp.sec * 10**9 + stamp.nanosec == 1_700_000_000_123_456_789
        assert message.header.frame_id == ""
        assert len(message.status) == len(wanted) > 5
        for status, (level, name, text, hardware, values) in zip(message.status, wanted):
            assert (status.level, status.name, status.message, status.hardware_id) == (level, name, text, hardware)
            assert [(value.key, value.value) for value in status.values] == values
        assert bytes(own.serialize_cdr(message, NAME)) == data
    assert any(status[0] == 2 and ("diagnosis", "bits_flipped") in status[-1] for status in wanted)
    print(f"DiagnosticArray: {len(wanted)} statuses by rosbags, type hash {own.hash_rihs01(NAME)}")


main(*sys.argv[1:])
