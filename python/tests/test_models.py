# SPDX-License-Identifier: MIT
"""Other models than the G4: raw bytes, recordings, and the intensity in messages."""
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import g4lidar
from g4lidar import errors


def t_mini_stream(revolutions: int) -> bytes:
    """Packets of 30 samples of 3 bytes, each 30 degrees: 2000 mm, flags 2, intensity 100 + packet."""
    made = bytearray()
    for _ in range(revolutions):
        for packet in range(13):
            count = 1 if packet == 0 else 30
            first = 0 if packet == 0 else 64 * 30 * (packet - 1) + 32
            words = [0x55AA, (packet == 0) + 256 * count, 2 * first + 1, 2 * (first + 64 * (count - 1)) + 1]
            checksum = 0
            for word in words:
                checksum ^= word
            if count % 2 == 1:  # the words of an even number of equal samples give 0
                checksum ^= (100 + packet) ^ 8002
            made += b"".join(word.to_bytes(2, "little") for word in [*words, checksum])
            made += (bytes([100 + packet]) + (8002).to_bytes(2, "little")) * count
    return bytes(made)


def test_the_model_of_bytes_and_recordings(tmp_path: Path) -> None:
    data = t_mini_stream(6)
    points = g4lidar.decode(data, model="t-mini-pro")
    assert len(points) == 6 * 361
    assert list(points["intensity"][:2]) == [100, 101] and set(points["sample_flags"]) == {2}
    assert set(points["range_mm"]) == {2000.0}
    decoder = g4lidar.Decoder(model="t-mini-pro")
    assert decoder.decode(data).tobytes() == points.tobytes()
    raw, walk = tmp_path / "raw.bin", tmp_path / "walk.mcap"
    raw.write_bytes(data)
    with g4lidar.RecordingWriter(walk, model="t-mini-pro") as writer:
        writer.from_device(data, 1_000_000_000)
    assert g4lidar.Recording(walk).model == "t-mini-pro"
    for path, model in [(raw, None), (raw, "t-mini-pro"), (walk, None), (walk, "t-mini-pro")]:
        with g4lidar.open(path, model=model, partial_scans=True, record=tmp_path / "again.mcap",
                          overwrite=True) as lidar:
            lidar.start()
            found = np.concatenate([scan.points for scan in lidar.scans()])
        assert (found["intensity"] == points["intensity"]).all()
        assert (found["range_mm"] == points["range_mm"]).all()
        assert g4lidar.Recording(tmp_path / "again.mcap").model == "t-mini-pro"
    with pytest.raises(errors.BadOption, match="x4, and the source states t-mini-pro"):
        g4lidar.open(walk, model="x4")
    unknown: list[Callable[[], object]] = [
        lambda: g4lidar.open(raw, model="x44"), lambda: g4lidar.decode(data, model="x44"),
        lambda: g4lidar.Decoder(model="x44"), lambda: g4lidar.RecordingWriter(tmp_path / "b", model="x44"),
    ]
    for call in unknown:
        with pytest.raises(errors.BadOption, match="'x44' is not one of g4, g4-pro, "):
            call()


def test_messages_have_the_intensity(tmp_path: Path) -> None:
    (tmp_path / "raw.bin").write_bytes(t_mini_stream(6))
    with g4lidar.open(tmp_path / "raw.bin") as lidar:
        lidar.start()
        scan = next(scan for scan in lidar.scans() if scan.is_whole)
    message = scan.laser_scan(bins=360)
    floats = np.frombuffer(message[-360 * 4 :], "<f4")
    assert set(floats) <= {*range(100, 113), 0} and set(range(101, 113)) <= set(floats)
    cloud = scan.point_cloud2()
    rows = np.frombuffer(cloud[-1 - 361 * 28 : -1], "<f4").reshape(361, 7)
    assert (rows[:, 6] == scan.points["intensity"]).all()


def test_the_model_of_an_open_lidar_and_what_sends_the_same() -> None:
    with g4lidar.open("sim:?model=x2") as lidar:  # sim: states its model, so nothing is searched
        assert lidar.candidates == ["x2"]
