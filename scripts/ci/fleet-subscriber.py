# SPDX-License-Identifier: MIT
"""The one machine that sees a fleet, with PyPI cyclonedds: fleet-subscriber.py ROBOTS SECONDS [peer]

Subscribes /robotN/scan of each robot and /diagnostics. Prints "matched S B" when it has found all of them, "first S B"
when it has a scan of each, with the seconds since it began and the bytes of the scans that it has received, "end" after
SECONDS more, and then a line of JSON with what it received. Each scan must be that of its robot: robot N stands in a
square room with walls at 1 + N / 20 m.
With "peer" it uses no multicast: the robots know its address.
"""
import json
import math
import os
import sys
import time
from dataclasses import dataclass, field

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from ros2_messages import DiagnosticArray, LaserScan

BINS = 720
TOLERANCE_M = 0.01
PATIENCE_S = 60


@dataclass
class Robot:
    """What came from one robot."""

    number: int
    reader: DataReader
    stamps: list[float] = field(default_factory=list)
    message_bytes: int = 0
    complaints: list[str] = field(default_factory=list)
    counted: int = 0  # scans in the measured time
    thin: int = 0  # scans with fewer ranges

    def take(self, is_counted: bool) -> None:
        for scan in self.reader.take(50):
            if not isinstance(scan, LaserScan):
                continue  # the writer has gone
            stamp = scan.header.stamp.sec + scan.header.stamp.nanosec * 1e-9
            if (reason := self.fault_of(scan, stamp)) and len(self.complaints) < 3:
                self.complaints.append(reason)
            self.stamps.append(stamp)
            self.counted += is_counted
            self.message_bytes += 60 + 4 * len(scan.ranges) + 4 * len(scan.intensities)
            self.thin += self.is_thin(scan)

    @staticmethod
    def is_thin(scan: LaserScan) -> bool:
        return sum(map(math.isfinite, scan.ranges)) < 0.95 * BINS

    def fault_of(self, scan: LaserScan, stamp: float) -> str:
        half = 1 + self.number / 20
        expected = f"robot{self.number}/laser"
        known = [r for r in scan.ranges if math.isfinite(r)]
        if scan.header.frame_id != expected:
            return f"frame {scan.header.frame_id} instead of {expected}"
        if len(scan.ranges) != BINS or abs(scan.angle_min + (BINS - 1) * scan.angle_increment - scan.angle_max) > 1e-4:
            return f"{len(scan.ranges)} ranges from {scan.angle_min} to {scan.angle_max}"
        if self.stamps and not stamp > self.stamps[-1]:
            return f"stamp {stamp:.6f} after {self.stamps[-1]:.6f}"
        nearest, farthest = min(known, default=0), max(known, default=0)
        if not half - TOLERANCE_M < nearest <= farthest < half * 1.42:
            return f"ranges from {nearest:.3f} to {farthest:.3f} m in a room of {2 * half:.2f} m"
        if not self.is_thin(scan) and (nearest > half + TOLERANCE_M or farthest < half * 1.35):
            return f"ranges from {nearest:.3f} to {farthest:.3f} m, but not to all walls of {2 * half:.2f} m"
        return ""

    def report(self) -> dict[str, object]:
        """A gap of twice the usual time is a lost scan, but not while the motor speeds up."""
        steps = sorted(b - a for a, b in zip(self.stamps, self.stamps[1:]) if a > self.stamps[0] + 2)
        usual = steps[len(steps) // 2] if steps else 0
        late = sum(max(0, round(step / usual) - 1) for step in steps) if usual else 0
        return {"scans": len(self.stamps), "counted": self.counted, "gaps": late, "thin": self.thin,
                "complaints": self.complaints, "scan_rate_hz": 1 / usual if usual else 0, "bytes": self.message_bytes,
                "lost": self.reader.get_sample_lost_status().total_count}


def main(count: int, seconds: float, is_peer: bool) -> None:
    if is_peer:
        os.environ["CYCLONEDDS_URI"] = ("<General><AllowMulticast>false</AllowMulticast></General>"
                                        "<Discovery><ParticipantIndex>auto</ParticipantIndex></Discovery>")
    begin = time.monotonic()
    participant = DomainParticipant()
    qos = Qos(Policy.Reliability.Reliable(duration(milliseconds=100)), Policy.History.KeepLast(50))
    robots = []
    for number in range(1, count + 1):
        topic = Topic(participant, f"rt/robot{number}/scan", LaserScan)
        robots.append(Robot(number, DataReader(participant, topic, qos=qos)))
    diagnostics = DataReader(participant, Topic(participant, "rt/diagnostics", DiagnosticArray), qos=qos)
    owners: dict[str, set[str]] = {}  # the serial numbers of a status, by its name

    def turn(is_counted: bool = False) -> None:
        for robot in robots:
            robot.take(is_counted)
        for array in diagnostics.take(200):
            if isinstance(array, DiagnosticArray):
                for status in array.status:
                    owners.setdefault(status.name, set()).add(status.hardware_id)
        time.sleep(0.02)

    stages = {"matched": lambda r: r.reader.get_subscription_matched_status().current_count == 1,
              "first": lambda r: r.stamps}
    for stage, is_done in stages.items():
        while (missing := [r.number for r in robots if not is_done(r)]) and time.monotonic() < begin + PATIENCE_S:
            turn()
        words = [stage, f"{time.monotonic() - begin:.2f}", sum(r.message_bytes for r in robots)]
        print(*words, *(["without", *missing] if missing else []), flush=True)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        turn(is_counted=True)
    print("end", flush=True)
    shared = sorted(name for name, serials in owners.items() if len(serials - {""}) > 1)
    print(json.dumps({"serials": sorted(set().union(*owners.values())), "shared_names": shared,
                      "robots": {r.number: r.report() for r in robots}}), flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), float(sys.argv[2]), sys.argv[3:] == ["peer"])
