# SPDX-License-Identifier: MIT
"""The examples, where the packages that they need are installed: the nightly of scripts/ci/python installs them."""
import importlib.util
import struct
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from conftest import PATIENCE

import g4lidar

Make = Callable[..., g4lidar.Simulator]
EXAMPLES = Path(__file__).parent.parent / "examples"


def load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_view(g4_simulator: Make) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from g4lidar import view

    view.main(g4_simulator(virtual_time=False).path, frames=3)


def test_points_map(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    way = tmp_path / "way.txt"
    way.write_text("drive wait 2\ndrive forward 1 0.5\n")
    picture = tmp_path / "map.png"
    load("points_map").main(f"sim:?path={way}", str(picture), seconds=6)
    assert picture.stat().st_size > 10_000
    # The lidar looks back: 1 m ahead of the robot is behind it, in a straight line.
    words = capsys.readouterr().out.split()
    x_m, y_m = float(words[words.index("at") + 1]), float(words[words.index("at") + 3])
    assert abs((x_m**2 + y_m**2) ** 0.5 - 1.0) < 0.25


def test_table(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("pandas")
    load("table").main("sim:", scans=3)
    assert len(capsys.readouterr().out.splitlines()) == 5


def test_rerun_points(tmp_path: Path) -> None:
    pytest.importorskip("rerun")
    file = tmp_path / "walk.rrd"
    load("rerun_points").main("sim:", str(file), scans=5)
    assert file.stat().st_size > 10_000


def test_zenoh_scan() -> None:
    zenoh: Any = pytest.importorskip("zenoh")
    example = load("zenoh_scan")
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", '["tcp/127.0.0.1:17447"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config) as router:
        samples: list[Any] = []
        held = router.declare_subscriber(f"0/scan/**/{example.HASH}", samples.append)
        example.main("sim:", "scan", "tcp/127.0.0.1:17447", scans=4)
        end = time.monotonic() + PATIENCE
        while len(samples) < 4 and time.monotonic() < end:
            time.sleep(0.05)
        held.undeclare()
    assert len(samples) == 4
    for number, sample in enumerate(samples, 1):
        sequence, sent_ns, gid_length = struct.unpack("<qqB", sample.attachment.to_bytes()[:17])
        assert sequence == number and gid_length == 16
        assert abs(sent_ns * 1e-9 - time.time()) < 60
        message = sample.payload.to_bytes()
        seconds, _, name_length = struct.unpack_from("<iII", message, 4)
        assert abs(seconds - time.time()) < 60
        assert message[16 : 16 + name_length] == b"laser\0"
        assert struct.unpack_from("<I", message, 24 + 7 * 4) == (720,)


def test_zenoh_scan_is_read_by_another_program() -> None:
    zenoh: Any = pytest.importorskip("zenoh")
    sdk: Any = pytest.importorskip("zenoh_ros2_sdk")
    example = load("zenoh_scan")
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", '["tcp/127.0.0.1:17448"]')
    with zenoh.open(config):
        for name, text in DEFINITIONS.items():
            sdk.ZenohSession.get_instance("127.0.0.1", 17448).register_message_type(text, name)
        found: list[Any] = []
        reader = sdk.ROS2Subscriber(
            topic="/scan", msg_type="sensor_msgs/msg/LaserScan", callback=found.append, router_port=17448,
            msg_definition=DEFINITIONS["sensor_msgs/msg/LaserScan"], type_hash=example.HASH)
        example.main("sim:", "scan", "tcp/127.0.0.1:17448", scans=4)
        end = time.monotonic() + PATIENCE
        while len(found) < 4 and time.monotonic() < end:
            time.sleep(0.05)
        reader.close()
    assert len(found) == 4
    assert found[-1].header.frame_id == "laser"
    assert len(found[-1].ranges) == 720
    assert found[-1].angle_min == pytest.approx(-3.14159265)


DEFINITIONS = {
    "builtin_interfaces/msg/Time": "int32 sec\nuint32 nanosec\n",
    "std_msgs/msg/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "sensor_msgs/msg/LaserScan": "std_msgs/Header header\n"
    + "".join(
        f"float32 {name}\n"
        for name in (
            "angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max"
        )
    )
    + "float32[] ranges\nfloat32[] intensities\n",
}
