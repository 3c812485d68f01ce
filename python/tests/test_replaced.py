# SPDX-License-Identifier: MIT
"""What `record` of open() replaces, and what it leaves."""
from pathlib import Path

import pytest

import g4lidar
from g4lidar import errors

ROOM = "wall 2 2 -2 2\nwall -2 2 -2 -2\nwall -2 -2 2 -2\nwall 2 -2 2 2\n"


def test_the_source_is_not_replaced(tmp_path: Path) -> None:
    path = tmp_path / "walk.mcap"
    with g4lidar.open(g4lidar.Simulator(seed=4), record=path) as lidar:
        lidar.start()
        next(iter(lidar.scans()))
    room = tmp_path / "room.txt"
    room.write_text(ROOM)
    link = tmp_path / "link.mcap"
    link.symlink_to(path)
    for source, file in (path, path), (path, link), (f"sim:?world={room}", room):
        before = file.read_bytes()
        with pytest.raises(errors.BadOption):
            g4lidar.open(str(source), record=file, overwrite=True)
        assert file.read_bytes() == before


def test_an_older_file_stays_without_a_lidar(tmp_path: Path) -> None:
    old = tmp_path / "old.mcap"
    old.write_text("dear")
    with pytest.raises(g4lidar.Error):
        g4lidar.open(str(tmp_path / "nosuch"), record=old, overwrite=True)
    assert old.read_text() == "dear"
    assert [each.name for each in tmp_path.iterdir()] == ["old.mcap"]
