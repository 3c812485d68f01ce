# SPDX-License-Identifier: MIT
"""Other models than the G4: raw bytes, recordings, and the intensity in messages."""
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import PATIENCE

import g4lidar
from g4lidar import errors

Make = Callable[..., g4lidar.Simulator]


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
    with pytest.raises(errors.OtherDevice, match="x4, and the source states t-mini-pro"):
        g4lidar.open(walk, model="x4")
    unknown: list[Callable[[], object]] = [
        lambda: g4lidar.open(raw, model="x44"), lambda: g4lidar.decode(data, model="x44"),
        lambda: g4lidar.Decoder(model="x44"), lambda: g4lidar.RecordingWriter(tmp_path / "b", model="x44"),
    ]
    for call in unknown:
        with pytest.raises(errors.BadOption, match="'x44' is not one of g4, g4-pro, "):
            call()
    with pytest.raises(errors.BadOption, match="'LD19' is not supported: a lidar of LDROBOT, usual driver ldlidar_stl"):
        g4lidar.open(raw, model="LD19")


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


@pytest.mark.parametrize(
    ("options", "known"),
    [
        ({"model": "g4"}, {"frequency_hz", "sample_rate_hz", "direction", "idle"}),
        ({"model": "t-mini-pro"}, {"frequency_hz"}),
        ({"model": "tg30"}, {"frequency_hz"}),
        ({"model": "tg30", "answers_sample_rate": True}, {"frequency_hz", "sample_rate_hz"}),
        ({"model": "x2"}, set()),
        ({"model": "x4"}, set()),
    ],
)
def test_a_setting_that_the_model_does_not_have_is_none(
    g4_simulator: Make, options: dict[str, object], known: set[str]
) -> None:
    with g4lidar.open(g4_simulator(**options)) as lidar:
        settings = lidar.settings()
        assert list(settings) == ["sample_rate_hz", "frequency_hz", "direction", "idle"]
        assert {name for name, value in settings.items() if value is not None} == known
        if "direction" not in known:
            with pytest.raises(errors.NotSupported, match="direction"):
                lidar.set(direction="clockwise")


@pytest.mark.g4(answers_sample_rate=False)
def test_a_setting_that_the_model_has_is_not_none(g4_lidar: g4lidar.Lidar) -> None:
    with pytest.raises(errors.Timeout, match="sample rate"):
        g4_lidar.settings()


def test_nothing_is_sent_if_one_setting_is_refused(g4_simulator: Make) -> None:
    g4, t_mini = g4_simulator(), g4_simulator(model="t-mini-pro")
    with g4lidar.open(g4) as lidar, g4lidar.open(t_mini) as other:
        lidar.settings(), other.settings()
        sent = len(g4.commands()), len(t_mini.commands())
        with pytest.raises(errors.BadSetting):
            lidar.set(sample_rate_hz=4000, frequency_hz=13)
        with pytest.raises(errors.NotSupported):
            other.set(frequency_hz=8, direction="clockwise")
        assert (len(g4.commands()), len(t_mini.commands())) == sent


def answer(value: int) -> bytes:
    """An answer of four bytes."""
    return bytes([0xA5, 0x5A, 4, 0, 0, 0, 4]) + value.to_bytes(4, "little", signed=True)


def tg_stream() -> bytes:
    """A packet of a TG with 40 samples of 1000 mm, from 10 to 49 degrees."""
    first, last = 10 * 64 * 2 + 1, 49 * 64 * 2 + 1
    checksum = 0x55AA ^ (40 << 8) ^ first ^ last
    words = [0x55AA, 40 << 8, first, last, checksum]
    return b"".join(word.to_bytes(2, "little") for word in [*words, *[1000] * 40])


def test_the_offset_of_zero(tmp_path: Path) -> None:
    data = tg_stream()
    plain = g4lidar.decode(data, model="tg15")
    assert plain["angle_deg"][0] == pytest.approx(10.0)
    for turned in (g4lidar.decode(data, model="tg15", zero_angle=180.0),
                   g4lidar.decode(answer(-720) + data, model="tg15")):
        assert turned["angle_deg"][0] == pytest.approx(190.0)
    decoder = g4lidar.Decoder(model="tg15")
    assert decoder.zero_angle is None
    decoder.decode(answer(-295))
    assert decoder.zero_angle == pytest.approx(-73.75)
    (tmp_path / "raw.bin").write_bytes(data)
    with g4lidar.open(tmp_path / "raw.bin", model="tg15", zero_angle=90.0, partial_scans=True) as lidar:
        lidar.start()
        found = np.concatenate([scan.points for scan in lidar.scans()])
    assert found["angle_deg"][0] == pytest.approx(100.0)
    with g4lidar.open(tmp_path / "raw.bin", model="tg15", partial_scans=True) as lidar:
        lidar.start()
        assert len(list(lidar.scans())) > 0
        assert "no_zero_angle" in [event.kind for event in lidar.events()]
    with pytest.raises(errors.NotSupported):
        g4lidar.decode(data, zero_angle=1.0)
    with pytest.raises(errors.BadOption):
        g4lidar.decode(data, model="tg15", zero_angle=361.0)


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_the_shortest_program_runs_with_each_model(page: str) -> None:
    file = Path(__file__).parents[2] / page
    if not file.exists():
        pytest.skip("the documents are not beside the tests")
    text = file.read_text(encoding="utf-8")
    program = text.split("```python\n")[1].split("```")[0]
    with pytest.raises(errors.BadOption) as refused:
        g4lidar.open("sim:", model="none")
    words = str(refused.value).split("is not one of ")[1].split(".")[0].split(", ")
    assert len(words) > 30

    def run(word: str) -> str:
        done = subprocess.run([sys.executable, "-c", program, f"sim:?model={word}"], capture_output=True, text=True,
                              timeout=PATIENCE, check=False)
        return "" if done.returncode == 0 and "points" in done.stdout else f"{word}: {done.stderr}"

    with ThreadPoolExecutor(8) as pool:
        assert [wrong for wrong in pool.map(run, words) if wrong] == []
