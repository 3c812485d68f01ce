# SPDX-License-Identifier: MIT
"""A recording as a lidar on a microcontroller's serial line: microcontroller.py RECORDING SENT QEMU...

Runs QEMU with the lidar's serial line on a socket. Sends the recording from its beginning at a start
command, as fast as it is taken, and nothing more after a stop command. What it has sent is then in the
file SENT. Prints what the program prints, and ends with its exit code.
"""
import select
import socket
import subprocess
import sys
import tempfile

start = b"\xa5\x60"
stops = (b"\xa5\x65", b"\xa5\x00")


def play(line, recording, sent):
    """Until the program closes the line. Little is sent at once: bytes that the program has not read
    when it sends a stop cannot be called back."""
    left = b""
    heard = b""
    line.setblocking(False)
    try:
        while True:
            readable, writable, _ = select.select([line], [line] if left else [], [])
            if readable:
                come = line.recv(64)
                if not come:
                    return
                heard += come
            while len(heard) >= 2:
                command, heard = heard[:2], heard[2:]
                if command == start:
                    left = recording
                elif command in stops:
                    left = b""
            if writable and left:
                count = line.send(left[:256])
                sent.write(left[:count])
                left = left[count:]
    except (BrokenPipeError, ConnectionResetError):
        return


def main():
    recording_name, sent_name, *qemu = sys.argv[1:]
    with open(recording_name, "rb") as file:
        recording = file.read()
    with tempfile.TemporaryDirectory() as scratch, open(sent_name, "wb") as sent:
        path = scratch + "/line"
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
            listener.bind(path)
            listener.listen(1)
            listener.settimeout(60)
            program = subprocess.Popen(
                [*qemu, "-chardev", f"socket,id=lidar,path={path}", "-serial", "chardev:lidar",
                 "-chardev", "stdio,id=console", "-serial", "chardev:console"],
                stdin=subprocess.DEVNULL)
            try:
                line, _ = listener.accept()
                with line:
                    line.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 2048)
                    play(line, recording, sent)
                return program.wait(60)
            finally:
                program.kill()


sys.exit(main())
