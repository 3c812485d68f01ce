# SPDX-License-Identifier: MIT
"""Runs the robots of scripts/ci/fleet and measures them: fleet.py NET ROBOTS G4_ROS2 SCRATCH

NET-switch is the network namespace of the switch, NET-1, NET-2, ... those of the robots, NET-250 that of the machine
that subscribes.
"""
import json
import os
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

net, count, g4_ros2, scratch = sys.argv[1], int(sys.argv[2]), sys.argv[3], Path(sys.argv[4])
VIEWER = 250
FREQUENCY_HZ = 7
STREAM_S = 15
failures: list[str] = []


def expect(is_true: bool, what: str) -> None:
    if not is_true:
        failures.append(what)
        print("FAILED:", what)


def inside(machine: int, *command: str) -> list[str]:
    return ["ip", "netns", "exec", f"{net}-{machine}", *command]


@dataclass
class Traffic:
    """Bytes of all Ethernet frames, as the switch counts them."""

    when: float
    sent: int  # by all machines; multicast once
    to_robots: int  # to all robots; multicast once for each
    to_viewer: int

    @staticmethod
    def now() -> "Traffic":
        command = ["ip", "-n", f"{net}-switch", "-s", "-j", "link"]
        links = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
        ports = {link["ifname"]: link["stats64"] for link in links if link["ifname"].startswith("m")}
        viewer = ports.pop(f"m{VIEWER}")
        return Traffic(time.monotonic(), sum(port["rx"]["bytes"] for port in ports.values()) + viewer["rx"]["bytes"],
                       sum(port["tx"]["bytes"] for port in ports.values()), viewer["tx"]["bytes"])

    def since(self, before: "Traffic") -> "Traffic":
        return Traffic(self.when - before.when, self.sent - before.sent, self.to_robots - before.to_robots,
                       self.to_viewer - before.to_viewer)


class Fleet:
    """A g4-ros2 with a configuration file for each robot."""

    def __init__(self, environment: dict[str, str]) -> None:
        self.robots = []
        for number in range(1, count + 1):
            half = 1 + number / 20
            walls = [(-half, -half, half, -half), (half, -half, half, half), (half, half, -half, half),
                     (-half, half, -half, -half)]
            room = scratch / f"room{number}.txt"
            room.write_text("".join("wall {:.2f} {:.2f} {:.2f} {:.2f}\n".format(*w) for w in walls) + "lidar 0 0 0\n")
            # The bytes come in batches, as from a USB bridge with a high latency: 50 lidars share this machine.
            source = f"sim:?world={room}&seed={number}&serial={serial_of(number)}&batch_min_ns=30ms&batch_max_ns=40ms"
            config = scratch / f"robot{number}.toml"
            config.write_text(f'SOURCE = ["{source}"]\nnamespace = "robot{number}"\nframe-id = "robot{number}/laser"\n'
                              f'base-frame = "robot{number}/base_link"\nmount = ["0.2,0,0"]\nstandby = true\n'
                              f'set = ["frequency={FREQUENCY_HZ}"]\n')
            with open(scratch / f"robot{number}.log", "w") as log:
                self.robots.append(subprocess.Popen(inside(number, g4_ros2, "--config", str(config)), stderr=log,
                                                    env=os.environ | environment))

    def expect_all(self) -> None:
        """Ends the program if a robot has ended: nothing can be measured."""
        ended = [number for number, robot in enumerate(self.robots, 1) if robot.poll() is not None]
        if ended:
            sys.exit(f"FAILED: the robots {ended} have ended\n" + (scratch / f"robot{ended[0]}.log").read_text())

    def read_bytes(self) -> list[int]:
        """What each process has read from files and its lidar: sockets do not count."""
        return [int(Path(f"/proc/{robot.pid}/io").read_text().split("rchar:")[1].split()[0]) for robot in self.robots]

    def memory_mb(self) -> float:
        sizes = [int(Path(f"/proc/{r.pid}/smaps_rollup").read_text().split("Pss:")[1].split()[0]) for r in self.robots]
        return max(sizes) / 1024

    def cpu_s(self) -> float:
        ticks = [Path(f"/proc/{robot.pid}/stat").read_text().rsplit(") ", 1)[1].split() for robot in self.robots]
        return sum(int(t[11]) + int(t[12]) for t in ticks) / os.sysconf("SC_CLK_TCK")

    def stop(self) -> None:
        for robot in self.robots:
            robot.terminate()
        codes = [robot.wait(20) for robot in self.robots]
        expect(set(codes) <= {0, 143, -15}, f"the robots end with {sorted(set(codes))}")


def serial_of(number: int) -> str:
    return f"{2026000000000000 + number}"


def processor_times() -> tuple[int, int]:
    """Of all processors: used, and all."""
    times = [int(word) for word in Path("/proc/stat").read_text().split("\n")[0].split()[1:9]]
    return sum(times) - times[3] - times[4], sum(times)


def expect_rest(fleet: Fleet, when: str) -> None:
    """A lidar that turns sends 18 kB a second."""
    before = fleet.read_bytes()
    time.sleep(2)
    most = max(now - then for now, then in zip(fleet.read_bytes(), before))
    expect(most < 4000, f"{when} a motor turns: {most} bytes in 2 s")


def measure(name: str, environment: dict[str, str], words: list[str]) -> dict[str, Any]:
    """One arrangement, from the start of the robots to their end."""
    nothing = Traffic.now()
    fleet = Fleet(environment)
    time.sleep(12)
    fleet.expect_all()
    found: dict[str, Any] = {"start": Traffic.now().since(nothing)}
    expect_rest(fleet, f"{name}: before anyone subscribes")
    most = max(fleet.read_bytes())
    expect(most < 60_000, f"{name}: a motor has turned before anyone subscribed: {most} bytes")  # libraries: 30 kB
    idle = Traffic.now()
    time.sleep(20)
    found["idle"] = Traffic.now().since(idle)

    before, cpu, processors = Traffic.now(), fleet.cpu_s(), processor_times()
    viewer = subprocess.Popen(inside(VIEWER, sys.executable, "scripts/ci/fleet-subscriber.py", str(count),
                                     str(STREAM_S), *words), stdout=subprocess.PIPE, text=True)
    assert viewer.stdout
    for stage in ("matched", "first"):
        line = viewer.stdout.readline().split()
        now = Traffic.now()
        expect(len(line) == 3 and line[0] == stage, f"{name}: {' '.join(line)}")
        found[stage] = now.since(before)
        found[f"{stage}_s"] = float(line[1])
        found[f"{stage}_payload"] = float(line[2])
        if stage == "first":
            before, cpu, processors = now, fleet.cpu_s(), processor_times()
    expect(viewer.stdout.readline() == "end\n", f"{name}: the subscriber has ended")
    found["stream"] = Traffic.now().since(before)
    used, all_time = (now - then for now, then in zip(processor_times(), processors))
    idle_time = 1 - used / all_time
    found["cpu"] = (fleet.cpu_s() - cpu) / found["stream"].when / count
    found["memory_mb"] = fleet.memory_mb()
    seen = json.loads(viewer.stdout.readline())
    expect(viewer.wait(20) == 0, f"{name}: the subscriber failed")
    judge(name, seen, idle_time)
    found["payload"] = sum(robot["bytes"] for robot in seen["robots"].values()) - found["first_payload"]
    time.sleep(6)  # the motors stop 3 s after the last subscriber has gone
    expect_rest(fleet, f"{name}: after the subscriber has gone")
    fleet.stop()
    return found


def judge(name: str, seen: dict[str, Any], idle: float) -> None:
    """Checks what the subscriber saw; `idle`: the unused part of the processors. A simulated lidar whose driver
    gets no time loses bytes, as a real one does."""
    robots = seen["robots"]
    rates = [robot["scan_rate_hz"] for robot in robots.values()]
    for number, robot in robots.items():
        expect(not robot["complaints"], f"{name}: robot {number}: {'; '.join(robot['complaints'])}")
        expect(robot["lost"] == 0, f"{name}: robot {number}: {robot['lost']} scans were lost")
    print(f"{name}: {sum(r['scans'] for r in robots.values())} scans of {len(robots)} robots, "
          f"{min(rates):.2f} to {max(rates):.2f} Hz, {sum(r['gaps'] for r in robots.values())} gaps, "
          f"{sum(r['thin'] for r in robots.values())} thin, "
          f"{sum(r['lost'] for r in robots.values())} lost")
    expect(all(abs(rate - FREQUENCY_HZ) < 0.3 for rate in rates), f"{name}: scan rates {min(rates)} to {max(rates)}")
    missing = {serial_of(number) for number in range(1, count + 1)} - set(seen["serials"])
    expect(not seen["shared_names"], f"{name}: statuses of several robots: {seen['shared_names'][:3]}")
    expect(not missing, f"{name}: /diagnostics without {sorted(missing)[:3]}, {len(missing)} in all")
    if idle < 0.1:
        print(f"SKIPPED: {name}: whether all scans are complete: the processors were idle for {100 * idle:.0f} %")
        return
    expect(all(robot["counted"] > 0.9 * FREQUENCY_HZ * STREAM_S for robot in robots.values()), f"{name}: too few scans")
    for word in ("gaps", "thin"):
        many = sum(robot[word] for robot in robots.values())
        expect(many <= 0.01 * sum(robot["scans"] for robot in robots.values()), f"{name}: {many} {word}")


class Table:
    """Measured values of both arrangements; prints a row, and compares it with the promises of docs/fleet.md."""

    def __init__(self) -> None:
        print(f"\n{f'{count} robots and one subscriber':<52} {'multicast':>18} {'one peer':>18}")

    def row(self, what: str, values: list[float], limits: list[float], unit: str) -> None:
        cells = [f"{value:9.1f} <= {limit:5g}" for value, limit in zip(values, limits)]
        print(f"{what:<52}", *(f"{cell:>18}" for cell in cells), unit)
        for name, value, limit in zip(("multicast", "one peer"), values, limits):
            expect(value <= limit, f"{name}: {what}: {value:.1f} {unit}, promised are {limit:g}")


def main() -> None:
    # Without the limit each robot announces itself to 32 ports of the machine.
    peers = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_STATIC_PEERS": f"10.77.0.{VIEWER}",
             "CYCLONEDDS_URI": "<Discovery><MaxAutoParticipantIndex>3</MaxAutoParticipantIndex></Discovery>"}
    ways = [measure("multicast", {}, []), measure("one peer", peers, ["peer"])]

    def each(part: str, field: str, parts: float = 1) -> list[float]:
        return [getattr(way[part], field) / getattr(way[part], "when") / 1e3 / parts for way in ways]

    table = Table()
    table.row("the robots start: sent by all in 12 s", [w["start"].sent / 1e6 for w in ways], [40, 2], "MB")
    table.row("nobody subscribes: sent by all", each("idle", "sent"), [100, 50], "kB/s")
    table.row("nobody subscribes: to each robot", each("idle", "to_robots", count), [12, 1], "kB/s")
    table.row("the subscriber has found all robots after", [w["matched_s"] for w in ways], [15, 25], "s")
    table.row("the subscriber has a scan of each after", [w["first_s"] for w in ways], [20, 30], "s")
    # By then the lidars that were found first have sent scans.
    table.row("discovery: sent by all, without scans",
              [(w["matched"].sent - 1.25 * w["matched_payload"]) / 1e6 for w in ways], [8, 12], "MB")
    table.row("streaming: to the subscriber", each("stream", "to_viewer"), [1600, 1600], "kB/s")
    table.row("streaming: to each robot", each("stream", "to_robots", count), [15, 4], "kB/s")
    table.row("streaming: sent by all, of the bytes of the scans",
              [100 * w["stream"].sent / w["payload"] for w in ways], [180, 180], "%")
    table.row("memory of the largest g4-ros2 (Pss)", [w["memory_mb"] for w in ways], [20, 20], "MB")
    print("a g4-ros2 with its simulated lidar needs "
          + " and ".join(f"{100 * way['cpu']:.1f} %" for way in ways) + " of a processor")
    sys.exit(1 if failures else 0)


main()
