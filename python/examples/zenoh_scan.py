# SPDX-License-Identifier: MIT
"""Publishes scans by zenoh in the form of rmw_zenoh, so that ROS 2 nodes receive them: pip install eclipse-zenoh

    python zenoh_scan.py [DEVICE [TOPIC [ROUTER]]]     python zenoh_scan.py "" scan tcp/localhost:7447

The domain is that of ROS_DOMAIN_ID. The frame is "laser"; for a topic in a namespace, as robot7/scan, "robot7/laser".
"""
import json
import os
import struct
import sys
import time

import zenoh

import g4lidar

TYPE = "sensor_msgs::msg::dds_::LaserScan_"
HASH = "RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"
QOS = "::,5:,:,:,,"  # reliable, volatile, the last 5


def tokens(session: zenoh.Session, domain: str, topic: str) -> list[zenoh.LivelinessToken]:
    """By these `ros2 topic list` finds the node g4lidar and its publisher."""
    ids = f"@ros2_lv/{domain}/{session.zid()}/0"
    names = (f"{ids}/0/NN/%/%/g4lidar", f"{ids}/1/MP/%/%/g4lidar/%{topic.replace('/', '%')}/{TYPE}/{HASH}/{QOS}")
    return [session.liveliness().declare_token(name) for name in names]


def main(
    device: str = "", topic: str = "scan", router: str = "tcp/localhost:7447", *, scans: int | None = None
) -> None:
    domain = os.environ.get("ROS_DOMAIN_ID", "0")
    frame = topic.rpartition("/")[0] + "/laser" if "/" in topic else "laser"
    config = zenoh.Config()
    config.insert_json5("connect/endpoints", json.dumps([router]))
    with zenoh.open(config) as session, g4lidar.open(device, reconnect=True) as lidar:
        held = tokens(session, domain, topic)
        publisher = session.declare_publisher(f"{domain}/{topic}/{TYPE}/{HASH}")
        writer = os.urandom(16)
        lidar.start()
        for number, scan in enumerate(lidar.scans(timeout=None), 1):
            attachment = struct.pack("<qqB", number, time.time_ns(), len(writer)) + writer
            publisher.put(scan.laser_scan(frame_id=frame), attachment=attachment)
            if number == scans:
                break
        del held


if __name__ == "__main__":
    main(*sys.argv[1:4])
