# SPDX-License-Identifier: MIT
"""Errors as exceptions."""
import errno
from collections.abc import Callable
from pathlib import Path

import pytest

import g4lidar
from g4lidar import _g4lidar, errors

Make = Callable[..., g4lidar.Simulator]


def test_every_problem_has_a_class() -> None:
    classes = {
        name: kind
        for name, kind in vars(errors).items()
        if isinstance(kind, type) and issubclass(kind, g4lidar.Error) and kind is not g4lidar.Error
    }
    assert set(classes) == set(_g4lidar._problems)
    for name, description in _g4lidar._problems.items():
        documented = classes[name].__doc__ or ""
        assert documented.rstrip(".").lower() == description.lower()


def test_an_error_states_what_was_done_and_what_to_try(tmp_path: Path) -> None:
    missing = tmp_path / "ttyUSB7"
    with pytest.raises(errors.NoPort) as caught:
        g4lidar.open(missing)
    error = caught.value
    assert isinstance(error, g4lidar.Error)
    assert error.doing == "opening"
    assert error.subject == str(missing)
    assert error.system_errno == errno.ENOENT
    assert "a recording that exists" in error.advice
    assert "there is no port and no file of this name" in str(error)
    assert error.is_fatal
    assert str(error).startswith(f"opening {missing}: ") and error.advice in str(error)


def test_each_class_is_also_that_of_python() -> None:
    assert issubclass(errors.Timeout, TimeoutError)
    assert issubclass(errors.Permission, PermissionError)
    assert issubclass(errors.BadOption, ValueError)
    made = errors.Timeout("words", doing="reading", subject="/dev/x", system_errno=5, advice="wait", is_fatal=False)
    assert str(made) == "words" and made.system_errno == 5 and not made.is_fatal


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"frequency_hz": 13}, r"frequency: 500 to 1200 \(5 to 12 Hz of a G4\), not 1300"),
        ({"frequency_hz": float("nan")}, "frequency_hz: 0 to 655, not nan"),
        ({"sample_rate_hz": 5000}, "sample_rate: 4000, 8000 or 9000 of a G4"),
        ({"sample_rate_hz": 65536 + 4000}, "sample_rate_hz: 0 to 65535, not 69536"),
        ({"stall_time": 0.0}, "stall_time: 100 ms to 1 min, not 0 ms"),
    ],
)
def test_bad_options(g4_simulator: Make, options: dict[str, float], words: str) -> None:
    with pytest.raises(errors.BadOption, match=words):
        g4lidar.open(g4_simulator(), **options)  # type: ignore[arg-type]


def test_an_impossible_value_is_repeated(g4_simulator: Make) -> None:
    points = g4lidar.decode(b"")
    for call, words in (
        (lambda: g4lidar.doctor(g4_simulator(), measuring_time=-7), "0 to 3600 s, not -7.0"),
        (lambda: g4lidar.fill_grid(points, 0), "1 to 65536 ranges, not 0"),
        (lambda: g4lidar.mark_isolated(points, window=17), "1 to 16, not 17"),
        (lambda: g4lidar.ScanShaper(excluded=256), "not 256"),
        (lambda: g4lidar.open(g4_simulator()).try_scan(-2), "0 or more, not -2.0"),
    ):
        with pytest.raises(ValueError, match=words):
            call()


def test_a_mistake_in_a_simulation() -> None:
    with pytest.raises(errors.BadOption, match="frobnicate"):
        g4lidar.Simulator(faults=["frobnicate@3s"])
    with pytest.raises(errors.BadOption, match="no_such_file"):
        g4lidar.Simulator(world="no_such_file")


def test_setting_during_a_scan(g4_lidar: g4lidar.Lidar) -> None:
    g4_lidar.start()
    g4_lidar.try_scan()
    with pytest.raises(errors.Scanning):
        g4_lidar.set(frequency_hz=8)
    g4_lidar.set(frequency_hz=8, interrupt=True)
    assert g4_lidar.is_scanning


def test_wrong_arrays_are_refused() -> None:
    import numpy as np

    with pytest.raises(TypeError, match="angle_deg"):
        g4lidar.to_xy(np.zeros(3))  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        g4lidar.to_xy([1, 2, 3])  # type: ignore[arg-type]
