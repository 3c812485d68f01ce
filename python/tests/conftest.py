# SPDX-License-Identifier: MIT
"""What the tests share. The fixtures g4_simulator and g4_lidar are those of the installed plugin."""
import os
import subprocess
import sys
import textwrap
from collections.abc import Callable, Iterator

import pytest

pytest_plugins = ["pytester"]
programs: list[subprocess.Popen[str]] = []
# Seconds that a test waits for what must happen: at least ten times what an idle machine needs (a reconnect in real
# time: 6 s), because a busy machine may stop a test for seconds.
PATIENCE = 100


def scaled(count: int) -> int:
    """So many times more in the nightly."""
    return count * int(os.environ.get("G4LIDAR_TEST_SCALE", "1"))


def start_program(text: str, *words: str) -> subprocess.Popen[str]:
    """A program that has imported sys and g4lidar. The end of the test ends it."""
    program = "import sys, g4lidar\n" + textwrap.dedent(text)
    programs.append(subprocess.Popen([sys.executable, "-c", program, *words], stdout=subprocess.PIPE,
                                     stderr=subprocess.PIPE, text=True))
    return programs[-1]


def takes_less(limit: float, measure: Callable[[], float]) -> bool:
    """Whether a real time is below the limit in one of three runs: a busy machine may delay the others."""
    return any(measure() < limit for _ in range(3))


@pytest.fixture(autouse=True)
def no_program_stays() -> Iterator[None]:
    yield
    for each in programs:
        if each.poll() is None:
            each.kill()
            each.communicate()
    programs.clear()
