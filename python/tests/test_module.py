# SPDX-License-Identifier: MIT
"""The module as a whole."""
import inspect
import re
import subprocess
import sys
from importlib import metadata, resources

from conftest import PATIENCE

import g4lidar


def test_everything_public_has_a_docstring() -> None:
    missing, joined = [], []
    for name in g4lidar.__all__:
        what = getattr(g4lidar, name)
        if name.endswith("_DTYPE") or inspect.ismodule(what):
            continue
        members = [(name, what)]
        if inspect.isclass(what) and what.__module__.startswith("g4lidar"):
            members += [(f"{name}.{n}", m) for n, m in vars(what).items() if not n.startswith("_") and n.islower()]
        texts = [(each, getattr(member, "__doc__", None) or "") for each, member in members]
        missing += [each for each, text in texts if not text.strip()]
        joined += [each for each, text in texts if re.search(r"[a-z],[a-z]", text)]  # parts without a space between
    assert missing == []
    assert joined == []


def test_each_keyword_of_open_is_a_row_of_the_options() -> None:
    (signature, *_), *_ = g4lidar.open.__nb_signature__  # type: ignore[attr-defined]
    keywords = set(re.findall(r"(\w+): ", signature.split("*,")[1]))
    rows = set(re.findall(r"^- `(\w+)`:", g4lidar.open.__doc__ or "", re.MULTILINE))
    assert rows - keywords == set()
    assert keywords - rows == {"device_wait", "overwrite", "record"}


def test_the_view_has_twenty_lines() -> None:
    lines = [line for line in (resources.files(g4lidar) / "view.py").read_text().splitlines() if line.strip()]
    words = [line for line in lines if line.lstrip().startswith(("#", '"""'))]
    assert 10 < len(lines) - len(words) <= 20


def test_the_version_is_that_of_the_package() -> None:
    assert g4lidar.__version__ == metadata.version("g4lidar")


def test_the_view_explains_itself() -> None:
    command = [sys.executable, "-m", "g4lidar.view", "--help"]
    shown = subprocess.run(command, text=True, capture_output=True, timeout=PATIENCE)
    assert shown.returncode == 0, shown.stderr
    assert shown.stdout.startswith("usage: python -m g4lidar.view [-h] [device]")
