# SPDX-License-Identifier: MIT
"""What the tests share. The fixtures g4_simulator and g4_lidar are those of the installed plugin."""
import os
import subprocess
import sys
import textwrap
from collections.abc import Iterator

import pytest

pytest_plugins = ["pytester"]
programs: list[subprocess.Popen[str]] = []


def scaled(count: int) -> int:
    """So many times more in the nightly."""
    return count * int(os.environ.get("G4LIDAR_TEST_SCALE", "1"))


def start_program(text: str, *words: str) -> subprocess.Popen[str]:
    """A program that has imported sys and g4lidar. The end of the test ends it."""
    program = "import sys, g4lidar\n" + textwrap.dedent(text)
    programs.append(subprocess.Popen([sys.executable, "-c", program, *words], stdout=subprocess.PIPE,
                                     stderr=subprocess.PIPE, text=True))
    return programs[-1]


@pytest.fixture(autouse=True)
def no_program_stays() -> Iterator[None]:
    yield
    for each in programs:
        if each.poll() is None:
            each.kill()
            each.communicate()
    programs.clear()
