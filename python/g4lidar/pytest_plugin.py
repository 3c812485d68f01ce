# SPDX-License-Identifier: MIT
"""Simulated lidars for pytest; installed with g4lidar.

    @pytest.mark.g4(seed=7, faults=["unplug@5s"])
    def test_my_program(g4_lidar):          # an open lidar, in virtual time
        g4_lidar.start()
        for scan in g4_lidar.scans(): ...

    def test_another_program(g4_simulator):
        simulated = g4_simulator(virtual_time=False, world="room.txt")
        run("my_program", simulated.path)   # any program that opens a serial port
"""
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import g4lidar


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "g4(**options): the arguments of g4lidar.Simulator for the fixture g4_lidar")


@pytest.fixture
def g4_simulator() -> Iterator[Callable[..., g4lidar.Simulator]]:
    """Makes simulated lidars with the arguments of g4lidar.Simulator, and closes them after the test."""
    made: list[g4lidar.Simulator] = []

    def make(**options: Any) -> g4lidar.Simulator:
        made.append(g4lidar.Simulator(**options))
        return made[-1]

    yield make
    for each in made:
        each.close()


@pytest.fixture
def g4_lidar(
    request: pytest.FixtureRequest, g4_simulator: Callable[..., g4lidar.Simulator]
) -> Iterator[g4lidar.Lidar]:
    """An open lidar on a simulator with the options of the mark `g4`; by default in virtual time."""
    marker = request.node.get_closest_marker("g4")
    if marker and marker.args:
        raise pytest.UsageError(f"the mark g4 takes arguments by name, not {marker.args}")
    options = dict(marker.kwargs) if marker else {}
    with g4lidar.open(g4_simulator(**options)) as lidar:
        yield lidar
