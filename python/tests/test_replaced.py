# SPDX-License-Identifier: MIT
"""What `record` of open() replaces, and what it leaves."""
import os
import pty
import select
import signal
from pathlib import Path

import pytest
from conftest import PATIENCE, start_program

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
    for _ in range(50):  # a thread opens the lidar, which may end later
        with pytest.raises(g4lidar.Error) as failed:
            g4lidar.open(str(tmp_path / "nosuch"), record=old, overwrite=True)
        assert [each.name for each in tmp_path.iterdir()] == ["old.mcap"], failed
    assert old.read_text() == "dear"


def test_an_older_file_stays_after_a_signal(tmp_path: Path) -> None:
    old = tmp_path / "old.mcap"
    old.write_text("dear")
    silent, port = pty.openpty()
    try:
        program = start_program("g4lidar.open(sys.argv[1], record=sys.argv[2], overwrite=True)", os.ttyname(port), str(old))
        assert select.select([silent], [], [], PATIENCE)[0], "it asks nothing"
        assert len(list(tmp_path.iterdir())) == 2
        program.send_signal(signal.SIGINT)
        _, err = program.communicate(timeout=PATIENCE)
    finally:
        os.close(silent)
        os.close(port)
    assert err.splitlines()[-1] == "KeyboardInterrupt"
    assert [each.name for each in tmp_path.iterdir()] == ["old.mcap"]
    assert old.read_text() == "dear"
