# SPDX-License-Identifier: MIT
"""The version of the package, for pyproject.toml: that of cmake/version.sh, as pip writes it."""

import subprocess
from collections.abc import Mapping
from typing import Any


def dynamic_metadata(settings: Mapping[str, Any], project: Mapping[str, Any]) -> dict[str, str]:
    line = subprocess.run(["sh", "cmake/version.sh"], check=True, stdout=subprocess.PIPE, text=True).stdout
    return {"version": line.split()[1]}
