# SPDX-License-Identifier: MIT
"""serve_clients.py PORT PAGES FOXGLOVE SECONDS: that many clients of g4-serve, which read everything.

Sets the lidar to 12 revolutions a second, waits until it turns so, then prints "warm", counts messages for SECONDS, and
prints "page N" and "foxglove N": scans that each client received in a second, the fewest of all clients.
"""
import selectors
import socket
import sys
import time


def connect(port, protocol):
    """A WebSocket whose handshake is done, and what came behind it."""
    sock = socket.create_connection(('127.0.0.1', port))
    sock.sendall((f'GET / HTTP/1.1\r\nHost: localhost:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n'
                  'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n'
                  f'Sec-WebSocket-Protocol: {protocol}\r\n\r\n').encode())
    got = b''
    while b'\r\n\r\n' not in got:
        part = sock.recv(65536)
        if not part:
            sys.exit(f'{protocol} is refused: {got[:60]}')
        got += part
    return sock, got.split(b'\r\n\r\n', 1)[1]


def send(sock, text):
    data = text.encode()
    # RFC 6455, 5.2: the length takes as few bytes as possible.
    size = bytes([0x80 | len(data)]) if len(data) < 126 else b'\xFE' + len(data).to_bytes(2, 'big')
    sock.sendall(b'\x81' + size + bytes(4) + data)


class Client:
    """Counts the binary messages of one server: all of a page, those of /scan of Foxglove."""

    def __init__(self, port, protocol):
        self.sock, self.buffer = connect(port, protocol)
        self.is_page = protocol.startswith('g4lidar')
        self.scans = 0

    def read(self):
        part = self.sock.recv(1 << 20)
        if not part:
            sys.exit('the server closed a connection')
        self.buffer += part
        while len(self.buffer) >= 10:
            size, head = self.buffer[1], 2
            if size == 126:
                size, head = int.from_bytes(self.buffer[2:4], 'big'), 4
            elif size == 127:
                size, head = int.from_bytes(self.buffer[2:10], 'big'), 10
            if len(self.buffer) < head + size:
                return
            if self.buffer[0] & 15 == 2 and (self.is_page or self.buffer[head + 1] == 1):
                self.scans += 1
            self.buffer = self.buffer[head + size:]


def main():
    port, pages, foxgloves, seconds = (int(word) for word in sys.argv[1:])
    clients = [Client(port, 'g4lidar.page.v1') for _ in range(pages)]
    clients += [Client(port, 'foxglove.sdk.v1') for _ in range(foxgloves)]
    for client in clients:
        if not client.is_page:
            send(client.sock, '{"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":2},'
                              '{"id":3,"channelId":3}]}')
    send(clients[0].sock, '{"op":"set","name":"frequency","value":12}')
    selector = selectors.DefaultSelector()
    for client in clients:
        selector.register(client.sock, selectors.EVENT_READ, client)

    def read_for(duration):
        end = time.monotonic() + duration
        while time.monotonic() < end:
            for key, _ in selector.select(0.1):
                key.data.read()

    read_for(6)
    for client in clients:
        client.scans = 0
    print('warm', flush=True)
    read_for(seconds)
    for name, is_page in (('page', True), ('foxglove', False)):
        print(name, min((c.scans for c in clients if c.is_page == is_page), default=0) / seconds, flush=True)


main()
