# SPDX-License-Identifier: MIT
"""The module as a whole."""
import inspect

import g4lidar


def test_everything_public_has_a_docstring() -> None:
    missing = []
    for name in g4lidar.__all__:
        what = getattr(g4lidar, name)
        if name.endswith("_DTYPE") or inspect.ismodule(what):
            continue
        members = [(name, what)]
        if inspect.isclass(what) and what.__module__.startswith("g4lidar"):
            members += [(f"{name}.{n}", m) for n, m in vars(what).items() if not n.startswith("_") and n.islower()]
        missing += [each for each, member in members if not (getattr(member, "__doc__", None) or "").strip()]
    assert missing == []

