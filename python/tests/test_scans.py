# SPDX-License-Identifier: MIT
"""Opening, scans, their points, and how long they are valid."""
import gc
import math
import random
import time
from collections.abc import Callable

import numpy as np
import pytest
from conftest import scaled

import g4lidar
from g4lidar import errors

Make = Callable[..., g4lidar.Simulator]


def scans_of(lidar: g4lidar.Lidar, count: int) -> list[g4lidar.Scan]:
    return [scan for scan, _ in zip(lidar.scans(timeout=0.5), range(count), strict=False)]


def test_points_are_a_structured_array(g4_lidar: g4lidar.Lidar) -> None:
    g4_lidar.start()
    scan = scans_of(g4_lidar, 3)[-1]
    assert scan.points.dtype == g4lidar.POINT_DTYPE
    assert scan.points.dtype.names == ("angle_deg", "range_mm", "time_ns", "revolution", "flags", "sample_flags", "intensity")
    assert scan.points.dtype.itemsize == 24
    assert len(scan) == len(scan.points)
    assert (scan.turn_deg, len(scan.ranges())) == (180, 720)
    assert scan.is_whole and scan.flags == 0
    assert (scan.points["angle_deg"] >= 0).all() and (scan.points["angle_deg"] < 360).all()
    assert (np.diff(scan.points["time_ns"]) > 0).all()
    assert scan.time_ns == scan.points["time_ns"][0]
    nothing = scan.points["flags"] & g4lidar.PointFlag.NO_RETURN != 0
    assert ((scan.points["range_mm"] == 0) == nothing).all()


def laser_scan_ranges(message: bytes) -> "np.typing.NDArray[np.float32]":
    """The ranges of a sensor_msgs/msg/LaserScan in CDR whose frame is "laser": 720 of them."""
    # Behind the four bytes of CDR: the stamp, the frame with its size, 7 numbers, the number of ranges.
    begin = 4 + 8 + 4 + len("laser\0") + 2 + 7 * 4
    assert int.from_bytes(message[begin : begin + 4], "little") == 720
    return np.frombuffer(message, np.float32, 720, begin + 4)


def test_no_return_of_a_laser_scan(g4_simulator: Make, tmp_path: object) -> None:
    world = f"{tmp_path}/wall.txt"
    with open(world, "w") as file:
        file.write("lidar 0 0 0\nwall -2 -3 -2 3\n")  # ahead of the robot; the cable points away
    with g4lidar.open(g4_simulator(world=world)) as lidar:
        lidar.start()
        scan = scans_of(lidar, 3)[-1]
    usual = laser_scan_ranges(scan.laser_scan())
    assert usual[360] == pytest.approx(2, abs=0.02) and usual[0] == math.inf
    for no_return, expected in (("inf", math.inf), ("nan", math.nan), ("max", 16)):
        ranges = laser_scan_ranges(scan.laser_scan(no_return=no_return))  # type: ignore[arg-type]
        assert ranges[0] == pytest.approx(expected, nan_ok=True)
        assert ranges[360] == usual[360]
    with pytest.raises(TypeError):
        scan.laser_scan(no_return="far")  # type: ignore[arg-type]


def test_frequency_is_that_of_start(g4_lidar: g4lidar.Lidar) -> None:
    g4_lidar.start(frequency_hz=10, sample_rate_hz=8000)
    scan = scans_of(g4_lidar, 10)[-1]
    assert abs(scan.measured_frequency_hz - 10) < 0.1
    assert abs(len(scan) - 800) < 20
    assert abs(scan.duration - 0.1) < 0.002
    g4_lidar.stop()
    assert g4_lidar.settings()["frequency_hz"] == pytest.approx(10, abs=0.05)
    assert g4_lidar.settings()["sample_rate_hz"] == 8000
    assert g4_lidar.health() == ("ok", 0)


def test_kept_scans_stay_valid_in_any_order(g4_lidar: g4lidar.Lidar) -> None:
    g4_lidar.start(frequency_hz=12, sample_rate_hz=4000)
    kept: list[tuple[object, int]] = []
    count = scaled(10_000)
    for number, scan in enumerate(g4_lidar.scans(), 1):
        all_of: tuple[object, ...] = (scan, scan.points, scan.points[10:20], scan.points["range_mm"], scan.xy())
        what = all_of[number % 5]
        kept.append((what, hash(as_bytes(what))))
        if number == count:
            break
    g4_lidar.close()
    random.Random(1).shuffle(kept)
    while kept:
        what, expected = kept.pop()
        assert hash(as_bytes(what)) == expected
        del what
    gc.collect()


def as_bytes(what: object) -> bytes:
    array = what.points if isinstance(what, g4lidar.Scan) else what
    assert isinstance(array, np.ndarray)
    return array.tobytes()


def test_points_may_be_changed_by_their_owner(g4_lidar: g4lidar.Lidar) -> None:
    g4_lidar.start()
    first, second = scans_of(g4_lidar, 2)
    before = second.points.tobytes()
    first.points["range_mm"] = 0
    assert second.points.tobytes() == before


def test_newest_drops_and_counts(g4_simulator: Make) -> None:
    with g4lidar.open(g4_simulator(virtual_time=False)) as lidar:
        lidar.start(frequency_hz=12)
        found = []
        for scan in lidar.scans(timeout=5, newest=True):
            dropped = lidar.counts()["scans_dropped"]
            found.append((scan.revolution, dropped))
            if dropped >= found[0][1] + 3:  # a busy machine may drop some before the first
                break
            time.sleep(0.5)  # the system keeps the bytes of five revolutions
        assert found[-1][0] - found[0][0] - (len(found) - 1) >= found[-1][1] - found[0][1]


def test_timeout_is_raised_and_the_loop_can_go_on(g4_simulator: Make) -> None:
    with g4lidar.open(g4_simulator(faults=["stall@3s+0.7s"]), stall_time=10) as lidar:
        lidar.start()
        scans = lidar.scans(timeout=0.3)
        with pytest.raises(g4lidar.errors.Timeout) as caught:
            for _ in range(100):
                next(scans)
        assert not caught.value.is_fatal
        assert isinstance(caught.value, TimeoutError)
        while True:
            try:
                assert len(next(scans)) > 0
                break
            except errors.Timeout:
                pass


def test_spin_up_is_no_timeout(g4_simulator: Make) -> None:
    with g4lidar.open(g4_simulator(silence_ns="3s")) as lidar:
        lidar.start()
        assert lidar.is_spinning_up
        assert next(lidar.scans(timeout=0.5)).is_whole
        assert not lidar.is_spinning_up


@pytest.mark.parametrize("seed", range(1, 13))
def test_the_spin_up_of_a_healthy_lidar_is_no_timeout(g4_simulator: Make, seed: int) -> None:
    with g4lidar.open(g4_simulator(seed=seed)) as lidar:
        lidar.start()
        assert len(scans_of(lidar, 5)) == 5


def test_a_motor_that_never_spins_up_ends_the_loop_after_10_s(g4_simulator: Make) -> None:
    simulated = g4_simulator(silence_ns="60s")
    with g4lidar.open(simulated) as lidar:
        lidar.start()
        begin_ns = simulated.now_ns
        with pytest.raises(errors.Timeout, match="the motor spins up"):
            next(lidar.scans(timeout=0.3))
        assert abs(simulated.now_ns - begin_ns - 10_000_000_000) < 600_000_000
        assert not lidar.is_spinning_up


def test_a_lost_lidar_is_waited_for_without_limit(g4_simulator: Make) -> None:
    with g4lidar.open(g4_simulator(faults=["unplug@4s+60s"]), reconnect=True) as lidar:
        lidar.start()
        assert len(scans_of(lidar, 40)) == 40
        assert lidar.counts()["reconnects"] == 1
    with g4lidar.open(g4_simulator(faults=["unplug@4s"])) as lidar:
        lidar.start()
        with pytest.raises(errors.Gone):
            scans_of(lidar, 40)


def test_an_error_of_try_scan_states_what_is_awaited(g4_simulator: Make) -> None:
    with g4lidar.open(g4_simulator(faults=["unplug@4s+60s"]), reconnect=True) as lidar:
        lidar.start()
        with pytest.raises(errors.Timeout, match="the motor spins up"):
            lidar.try_scan(0.01)
        with pytest.raises(errors.Reconnecting):
            while True:
                lidar.try_scan(1)
        with pytest.raises(errors.Timeout, match="the lidar was lost") as caught:
            lidar.try_scan(1)
        assert "unplug" not in str(caught.value)


@pytest.mark.parametrize("timeout", [None, 0.3, 1.0])
def test_reconnects_in_a_loop(g4_simulator: Make, timeout: float | None) -> None:
    with g4lidar.open(g4_simulator(faults=["unplug@4s+2s"]), reconnect=True) as lidar:
        lidar.start()
        last = 0
        for scan in lidar.scans(timeout=timeout):
            last = scan.time_ns
            if last > 10_000_000_000:
                break
        assert {"lost", "reconnected"} <= {event.kind for event in lidar.events()}
        assert lidar.counts()["reconnects"] == 1


def test_next_points_gives_each_point_once(g4_lidar: g4lidar.Lidar) -> None:
    g4_lidar.start()
    pieces = [g4_lidar.next_points() for _ in range(200)]
    times = np.concatenate([piece["time_ns"] for piece in pieces])
    assert len(times) > 5000
    assert (np.diff(times) > 0).all()


def test_with_stops_the_motor(g4_simulator: Make) -> None:
    simulated = g4_simulator()
    with g4lidar.open(simulated) as lidar:
        lidar.start()
        scans_of(lidar, 1)
        assert simulated.motor_turns
    assert not simulated.is_scanning
    with pytest.raises(errors.Gone):
        lidar.try_scan()
    assert list(lidar.scans()) == []
    lidar.close()


def test_truth_is_where_the_points_are(g4_simulator: Make) -> None:
    simulated = g4_simulator(seed=2)
    with g4lidar.open(simulated) as lidar:
        lidar.start()
        scan = scans_of(lidar, 8)[-1]
    truth = simulated.truth()
    first = np.searchsorted(truth["time_ns"], scan.time_ns - 1_000_000)
    near = truth[first : first + len(scan) + 20]
    hits = scan.points[scan.points["range_mm"] > 0][:200]
    for point in hits:
        off = np.abs((near["bearing_deg"] - point["angle_deg"] + 180) % 360 - 180)
        best = near[np.argmin(off)]
        assert abs(best["range_mm"] - point["range_mm"]) < 1.0


def test_stamp_is_the_wall_clock(g4_simulator: Make) -> None:
    with g4lidar.open(g4_simulator(virtual_time=False)) as lidar:
        lidar.start()
        scan = lidar.try_scan(10)
        now = time.time()
        assert now - 10 < scan.stamp < now
