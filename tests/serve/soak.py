# SPDX-License-Identifier: MIT
"""soak.py G4_SERVE SECONDS: clients of g4-serve that come and go, in every way in which a connection can end.

About 91 clients at a time, and now and then more than have a place. Each one that has a place must get scans, each
other one the reason; one client stays for the whole time. At the end all places must be free, and the memory of the
server must not have grown. Prints the seed; G4LIDAR_TEST_SEED repeats a run.
"""
import os
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import time

PLACES = 128
USUAL = 91
REFUSAL = b'the server has 128 clients already'
# Of a server that sends a status twice a second, on a busy machine.
PATIENCE_S = 30


class Client:
    """A page, or a Foxglove that subscribes."""

    def __init__(self, port, is_page=True):
        self.is_page = is_page
        self.buffer = b''
        self.sock = socket.create_connection(('127.0.0.1', port), PATIENCE_S)
        protocol = 'g4lidar.page.v1' if is_page else 'foxglove.sdk.v1'
        self.sock.sendall((f'GET / HTTP/1.1\r\nHost: localhost:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n'
                           'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n'
                           f'Sec-WebSocket-Protocol: {protocol}\r\n\r\n').encode())
        while b'\r\n\r\n' not in self.buffer:
            self.__fill()
        head, self.buffer = self.buffer.split(b'\r\n\r\n', 1)
        if not head.startswith(b'HTTP/1.1 101'):
            raise AssertionError(f'refused: {head[:80]}')

    def __fill(self):
        part = self.sock.recv(1 << 20)
        if not part:
            raise AssertionError('the server closed a connection without a reason')
        self.buffer += part

    def send(self, opcode, data):
        # RFC 6455, 5.2: the length takes as few bytes as possible.
        size = bytes([0x80 | len(data)]) if len(data) < 126 else b'\xFE' + len(data).to_bytes(2, 'big')
        self.sock.sendall(bytes([0x80 | opcode]) + size + bytes(4) + data)

    def frame(self):
        """The opcode and the payload of the next message."""
        while True:
            if len(self.buffer) >= 10:
                size, head = self.buffer[1], 2
                if size == 126:
                    size, head = int.from_bytes(self.buffer[2:4], 'big'), 4
                elif size == 127:
                    size, head = int.from_bytes(self.buffer[2:10], 'big'), 10
                if len(self.buffer) >= head + size:
                    opcode, payload = self.buffer[0] & 15, self.buffer[head:head + size]
                    self.buffer = self.buffer[head + size:]
                    if opcode == 9:
                        self.send(10, payload)  # who does not answer pings is disconnected after 30 s
                        continue
                    return opcode, payload
            self.__fill()

    def is_served(self):
        """Whether a scan comes; false where the server is full and answers so."""
        if not self.is_page:
            self.send(1, b'{"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]}')
        while True:
            opcode, payload = self.frame()
            if opcode == 8:
                if payload[2:] != REFUSAL:
                    raise AssertionError(f'closed: {payload}')
                return False
            if opcode == 2:
                return True

    def end(self, how):
        if how == 'close':
            self.send(8, b'\x03\xe8')
        elif how == 'reset':
            self.sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack('ii', 1, 0))
        elif how == 'half a frame':
            self.sock.sendall(b'\x81\xfe\x01')
        elif how == 'a bad frame':
            self.send(3, b'x')
        elif how == 'half':
            self.sock.shutdown(socket.SHUT_WR)
        self.sock.close()


ENDS = ('close', 'reset', 'half a frame', 'a bad frame', 'half', 'at once')


def start(program):
    server = subprocess.Popen([program, 'sim:', '--port', '0'], stderr=subprocess.PIPE, text=True)
    for line in server.stderr:
        found = re.search(r'http://127\.0\.0\.1:(\d+)/', line)
        if found:
            return server, int(found[1])
    sys.exit(f'g4-serve does not start: exit code {server.wait()}')


def memory_kb(server):
    with open(f'/proc/{server.pid}/status', encoding='ascii') as status:
        return int(re.search(r'VmRSS:\s*(\d+)', status.read())[1])


def soak(server, port, end_s):
    """Returns how many clients were served and refused, and how much memory the server took at first, in kB."""
    served = refused = memory_at_first = 0
    stays = Client(port)
    clients = []
    while time.monotonic() < end_s:
        crowd = PLACES + random.randrange(70) if random.random() < 0.1 else USUAL
        fresh = [Client(port, random.random() < 0.5) for _ in range(crowd - len(clients))]
        for client in fresh[-20:]:  # the others never read
            if client.is_served():
                served += 1
            else:
                refused += 1
        clients += fresh
        if not stays.is_served():
            raise AssertionError('a client that stays was refused')
        if server.poll() is not None:
            raise AssertionError(f'g4-serve ended with {server.returncode}')
        random.shuffle(clients)
        for _ in range(random.randrange(len(clients) + 1)):
            clients.pop().end(random.choice(ENDS))
        memory_at_first = memory_at_first or (memory_kb(server) if served > 2000 else 0)
    for client in clients + [stays]:
        client.end('at once')
    return served, refused, memory_at_first


def main():
    program, seconds = sys.argv[1], float(sys.argv[2])
    seed = int(os.environ.get('G4LIDAR_TEST_SEED', '1'))
    random.seed(seed)
    print(f'G4LIDAR_TEST_SEED={seed}', flush=True)
    server, port = start(program)
    try:
        served, refused, memory_at_first = soak(server, port, time.monotonic() + seconds)
        everybody = [Client(port) for _ in range(PLACES)]
        if not all(client.is_served() for client in everybody):
            raise AssertionError('clients that have ended are still counted')
        memory = memory_kb(server)
        if memory_at_first and memory > 1.2 * memory_at_first + 4096:
            raise AssertionError(f'the memory of the server grew from {memory_at_first} kB to {memory} kB')
        server.send_signal(signal.SIGTERM)
        if server.wait(PATIENCE_S) != 128 + signal.SIGTERM:
            raise AssertionError(f'g4-serve ended with {server.returncode}')
    finally:
        server.kill()
    print(f'{served} clients were served, {refused} learned that there was no place; {memory} kB')


if __name__ == '__main__':
    main()
