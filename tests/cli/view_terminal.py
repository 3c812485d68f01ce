# SPDX-License-Identifier: MIT
"""view_terminal.py <g4-dump>: runs `g4-dump view` on a pseudo-terminal that pyte shows."""

import fcntl
import os
import pty
import select
import shutil
import signal
import struct
import subprocess
import sys
import termios
import time

import pyte

TOOL = sys.argv[1]
SOURCE = "sim:?world=room.txt&seed=1"
PATIENCE_S = 40
LEAVE = b"\x1b[?1049l"  # xterm: back from the screen of full-screen programs


class Terminal:
    """A pseudo-terminal, a program in it, and what it shows."""

    def __init__(self, *words, columns=80, rows=24, locale="C.UTF-8", shell=None, kind="xterm-256color"):
        self.raw = b""
        self.columns, self.rows = columns, rows
        self.screen = pyte.Screen(columns, rows)
        self.stream = pyte.ByteStream(self.screen)
        self.master, slave = pty.openpty()
        self.resize_kernel()
        self.before = termios.tcgetattr(slave)
        environment = dict(os.environ, TERM=kind, LC_ALL=locale)
        self.child = subprocess.Popen(
            [*shell, TOOL, *words] if shell else [TOOL, "view", *words], stdin=slave, stdout=slave, stderr=slave, env=environment, start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
        )
        self.slave = slave

    def resize_kernel(self):
        size = struct.pack("HHHH", self.rows, self.columns, 0, 0)
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, size)

    def resize(self, columns, rows):
        self.columns, self.rows = columns, rows
        self.screen.resize(rows, columns)
        self.resize_kernel()

    def read(self, seconds):
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if select.select([self.master], [], [], left)[0]:
                data = os.read(self.master, 65536)
                self.raw += data
                self.stream.feed(data)

    def wait_for(self, what, condition):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            self.read(0.1)
            if condition():
                return
        raise AssertionError(f"no {what} within {PATIENCE_S} s:\n" + "\n".join(self.screen.display))

    def shows(self, words):
        self.wait_for(words, lambda: words in "\n".join(self.screen.display))

    def press(self, keys):
        os.write(self.master, keys.encode())

    def end(self, code):
        """The program ends with this code, and the terminal is as before."""
        end = time.monotonic() + PATIENCE_S
        while self.child.poll() is None and time.monotonic() < end:
            self.read(0.1)
        self.read(0.2)
        assert self.child.returncode == code, (self.child.returncode, code, self.raw[-300:])
        assert LEAVE in self.raw and b"\x1b[?25h" in self.raw, self.raw[-300:]
        assert self.raw.rindex(LEAVE) > self.raw.rindex(b"\x1b[?1049h")
        assert termios.tcgetattr(self.slave) == self.before
        os.close(self.slave)
        os.close(self.master)


def dots(screen, columns=53, rows=24):
    """Where there are green braille dots, as (x, y) from the left and from the top."""
    bits = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
    found = set()
    for row in range(rows):
        for column in range(columns):
            cell = screen.buffer[row][column]
            code = ord(cell.data[0]) - 0x2800 if cell.data else -1
            if cell.fg != "green" or not 0 < code < 256:
                continue
            found |= {(2 * column + x, 4 * row + y) for y in range(4) for x in range(2) if code & bits[y][x]}
    return found


def check_room(found, behind_m, ahead_m, left_m, right_m):
    """53 x 24 cells are 106 x 96 dots: the middle is at 52.5, 47.5, and 3 m are 47.5 dots."""
    metre = 47.5 / 3
    edges = (52.5 - left_m * metre, 52.5 + right_m * metre, 47.5 - ahead_m * metre, 47.5 + behind_m * metre)
    actual = (min(x for x, _ in found), max(x for x, _ in found), min(y for _, y in found), max(y for _, y in found))
    assert all(abs(one - other) <= 1.5 for one, other in zip(edges, actual)), (edges, actual)
    # Each return is on a wall.
    for x, y in found:
        assert min(abs(x - edges[0]), abs(x - edges[1]), abs(y - edges[2]), abs(y - edges[3])) <= 1.5, (x, y)


def shows_room(terminal, **walls_m):
    def fits():
        try:
            check_room(dots(terminal.screen), **walls_m)
        except (AssertionError, ValueError):  # ValueError: there is no dot
            return False
        return True

    terminal.wait_for(f"room with {walls_m}", fits)


def test_pictures_keys_and_sizes():
    terminal = Terminal("--zoom", "3", SOURCE)
    terminal.shows("running")
    terminal.wait_for("room", lambda: len(dots(terminal.screen)) > 120)
    terminal.shows("7.0")
    shows_room(terminal, behind_m=1, ahead_m=2, left_m=1.5, right_m=1)
    terminal.press("g")  # all rings are gone: what is left is the room, and words
    terminal.wait_for("no rings", lambda: "3 m" not in "\n".join(line[:53] for line in terminal.screen.display))
    terminal.press("f")
    terminal.shows("vendor")
    shows_room(terminal, behind_m=2, ahead_m=1, left_m=1, right_m=1.5)
    terminal.press("p")
    terminal.shows("frozen")
    terminal.press("h")
    terminal.shows("freeze the picture")
    terminal.press("h")
    terminal.press("p-")
    terminal.shows("4 m")
    terminal.press("0")
    terminal.shows("auto")
    for columns, rows in ((40, 10), (20, 5), (3, 2), (1, 1), (200, 50), (80, 24)):
        terminal.resize(columns, rows)
        terminal.read(0.7)
        assert terminal.child.poll() is None
        if columns == 40:
            terminal.wait_for("one line", lambda: terminal.screen.display[-1].startswith("running"))
    terminal.shows("frequency")
    terminal.press("q")
    terminal.end(0)


def test_map():
    """Where the motion is known there is a third frame, in which the robot moves and the walls stay."""
    with open("drive.txt", "w", encoding="utf-8") as world:
        world.write("wall -2 -2 4 -2\nwall 4 -2 4 2\nwall 4 2 -2 2\nwall -2 2 -2 -2\nmount 0,0,0\nlidar 0 0 0\n"
                    "drive wait 3\ndrive forward 2 0.5\ndrive wait 60\n")
    terminal = Terminal("--zoom", "6", "--map", "sim:?world=drive.txt")
    terminal.shows("map")

    def robot():
        rows = [row for row, line in enumerate(terminal.screen.display) if "+" in line[:53]]
        return rows[0] if rows else None

    terminal.wait_for("robot in the middle", lambda: robot() in (11, 12))
    terminal.press("t")
    terminal.wait_for("robot that has moved up", lambda: (robot() or 12) <= 8)  # 2 m are 15.8 dots: 4 rows
    terminal.press("f")
    terminal.wait_for("robot in the middle", lambda: robot() in (11, 12))
    terminal.shows("robot")
    terminal.press("f")
    terminal.shows("vendor")
    terminal.press("f")
    terminal.shows("map")
    terminal.press("q")
    terminal.end(0)


def test_ascii():
    terminal = Terminal(SOURCE, locale="C")
    terminal.shows("*")
    assert all(ord(letter) < 128 for line in terminal.screen.display for letter in line)
    terminal.press("q")
    terminal.end(0)


def test_signals():
    """Each signal that ends a program; those that the program ignores, or that stop it, are none."""
    ends = {signal.SIGTERM: 143, signal.SIGINT: 130, signal.SIGHUP: 129}
    others = {signal.SIGKILL, signal.SIGSTOP, signal.SIGCHLD, signal.SIGCONT, signal.SIGTSTP, signal.SIGTTIN,
              signal.SIGTTOU, signal.SIGURG, signal.SIGWINCH, signal.SIGPIPE, signal.SIGXFSZ}
    numbers = sorted(int(number) for number in signal.valid_signals() if number not in others)
    assert len(numbers) > 50 and signal.SIGRTMAX in numbers, numbers
    for first in range(0, len(numbers), 8):
        terminals = [(number, Terminal(SOURCE)) for number in numbers[first : first + 8]]
        for number, terminal in terminals:
            terminal.shows("state")
            terminal.child.send_signal(number)
            terminal.end(ends.get(number, -number))
    terminal = Terminal(SOURCE)
    terminal.shows("state")
    terminal.press("\x03")
    terminal.end(130)


def test_error():
    """An error while the picture is shown: first the terminal is as before, then the message comes."""
    terminal = Terminal("--on-loss", "exit", "sim:?fault=unplug@2s")
    terminal.wait_for("picture", lambda: b"frequency" in terminal.raw)  # it may be over already
    terminal.end(9)
    message = terminal.raw[terminal.raw.rindex(LEAVE) :]
    assert b"unplugged" in message, message


def test_background():
    """^Z gives the terminal back to the shell, and fg shows the picture again."""
    script = '"$0" "$@"; echo "the shell"; read -r _; fg >/dev/null'
    terminal = Terminal("view", SOURCE, shell=["bash", "-m", "-c", script])
    terminal.shows("running")
    terminal.press("\x1a")
    terminal.wait_for("shell", lambda: b"the shell" in terminal.raw)
    assert LEAVE in terminal.raw[: terminal.raw.index(b"the shell")]
    assert termios.tcgetattr(terminal.slave) == terminal.before
    begin = len(terminal.raw)
    terminal.press("\n")
    terminal.wait_for("the screen again", lambda: b"\x1b[?1049h" in terminal.raw[begin:])
    terminal.shows("running")
    terminal.press("q")
    terminal.end(0)


def test_lost_lidar():
    link = os.path.abspath("lost.tty")
    simulated = subprocess.Popen([TOOL, "sim", "-q", "--link", link])
    while not os.path.exists(link):
        time.sleep(0.05)
    terminal = Terminal(link)
    terminal.shows("running")
    simulated.terminate()
    simulated.wait()
    terminal.shows("lost")
    terminal.press("q")
    terminal.end(0)


def test_failures():
    for words in ((), ("no-such-file.mcap",)):
        done = subprocess.run([TOOL, "view", *words], stdin=subprocess.DEVNULL, capture_output=True, check=False)
        assert done.returncode in (2, 3, 10), done
        assert b"\x1b" not in done.stdout + done.stderr


def test_terminals_that_cannot_show_it():
    # For builds with the address sanitizer: ncurses asks for too much memory, and keeps some, when it refuses a terminal.
    os.environ["ASAN_OPTIONS"] = os.environ.get("ASAN_OPTIONS", "") + ":allocator_may_return_null=1:detect_leaks=0"
    for kind, size, words in (("dumb", 80, b"cannot move its cursor"), ("no-such-type", 80, b"is not known"),
                              ("xterm", 65000, b"Make it smaller")):
        terminal = Terminal(SOURCE, kind=kind, columns=size, rows=size)
        end = time.monotonic() + PATIENCE_S
        while terminal.child.poll() is None and time.monotonic() < end:
            terminal.read(0.1)
        terminal.read(0.2)
        terminal.child.kill()
        assert terminal.child.wait() == 2, terminal.raw[-300:]
        assert words in terminal.raw and len(terminal.raw) < 300, terminal.raw[-300:]
        assert termios.tcgetattr(terminal.slave) == terminal.before


def test_tmux():
    if shutil.which("tmux") is None:
        print("SKIPPED: tmux is not installed")  # the last test: the others have passed
        return
    tmux = ["tmux", "-L", f"g4-view-{os.getpid()}", "-f", "/dev/null"]
    environment = dict(os.environ, LC_ALL="C.UTF-8")
    environment.pop("TMUX", None)
    size = ["-x", "90", "-y", "30"]
    subprocess.run([*tmux, "new-session", "-d", *size, TOOL, "view", SOURCE], check=True, env=environment)
    try:
        end = time.monotonic() + PATIENCE_S
        shown = ""
        while "running" not in shown and time.monotonic() < end:
            time.sleep(0.2)
            capture = subprocess.run([*tmux, "capture-pane", "-p"], capture_output=True, env=environment, check=True)
            shown = capture.stdout.decode()
        assert "running" in shown, shown
        assert any(0x2800 < ord(letter) <= 0x28FF for letter in shown), shown
    finally:
        subprocess.run([*tmux, "kill-server"], check=False, env=environment)


for name, test in list(globals().items()):
    if name.startswith("test_"):
        begin = time.monotonic()
        test()
        print(f"{name}: {time.monotonic() - begin:.1f} s")
