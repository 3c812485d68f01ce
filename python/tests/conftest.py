# SPDX-License-Identifier: MIT
"""What the tests share. The fixtures g4_simulator and g4_lidar are those of the installed plugin."""
import os

pytest_plugins = ["pytester"]


def scaled(count: int) -> int:
    """So many times more in the nightly."""
    return count * int(os.environ.get("G4LIDAR_TEST_SCALE", "1"))
