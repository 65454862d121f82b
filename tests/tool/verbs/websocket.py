"""A WebSocket client with nothing but the standard library, and Foxglove's protocol on it. [RFC 6455; ws-protocol]"""

import base64
import collections
import hashlib
import json
import os
import socket
import ssl
import struct
import time

GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
Message = collections.namedtuple("Message", "topic time_ns fields")


class Refused(Exception):
    """The handshake was answered with another status than 101."""

    def __init__(self, status, body):
        super().__init__(f"{status}: {body}")
        self.status, self.body = status, body


class Socket:
    """One connection. `offer` is what it offers as subprotocols."""

    def __init__(self, port, path="/", offer="foxglove.websocket.v1", host=None, origin=None, context=None, timeout=10, room=None):
        self.buffer = b""
        self.closed = None  # the code with which the server has closed
        self.socket = socket.socket()
        if room is not None:  # bytes that the kernel keeps for it
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, room)
        self.socket.settimeout(timeout)
        self.socket.connect(("127.0.0.1", port))
        if context is not None:
            plain = self.socket
            try:
                self.socket = context.wrap_socket(plain, server_hostname="localhost")
            except ssl.SSLError:
                plain.close()
                raise
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET {path} HTTP/1.1", f"Host: {host or f'127.0.0.1:{port}'}", "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13"]
        if offer:
            lines.append(f"Sec-WebSocket-Protocol: {offer}")
        if origin:
            lines.append(f"Origin: {origin}")
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        while b"\r\n\r\n" not in self.buffer:
            if not self.fill():
                self.socket.close()
                raise Refused(0, self.buffer.decode(errors="replace"))
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        status = int(head.split()[1])
        if status != 101:
            while self.fill():
                pass
            self.socket.close()
            raise Refused(status, self.buffer.decode(errors="replace"))
        headers = dict(line.lower().split(": ", 1) for line in head.decode().split("\r\n")[1:])
        expected = base64.b64encode(hashlib.sha1((key + GUID).encode()).digest()).decode().lower()
        assert headers["sec-websocket-accept"] == expected, headers
        self.protocol = headers.get("sec-websocket-protocol")

    def fill(self):
        """More bytes; false: the other end has closed, or nothing comes in time."""
        try:
            more = self.socket.recv(65536)
        except (ConnectionError, TimeoutError, socket.timeout):
            return False
        self.buffer += more
        return bool(more)

    def take(self, count):
        while len(self.buffer) < count:
            if not self.fill():
                return None
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def receive(self):
        """The next text (str) or binary message (bytes); None: there is none any more."""
        whole, kind = b"", None
        while True:
            head = self.take(2)
            if head is None:
                return None
            opcode, length = head[0] & 15, head[1] & 127
            if length == 126:
                length = struct.unpack(">H", self.take(2))[0]
            elif length == 127:
                length = struct.unpack(">Q", self.take(8))[0]
            payload = self.take(length)
            if payload is None:
                return None
            if opcode == 8:
                self.closed = struct.unpack(">H", payload[:2])[0] if len(payload) >= 2 else 0
                return None
            if opcode == 9:
                self.send_frame(10, payload)
                continue
            if opcode == 10:
                continue
            kind = opcode if opcode else kind
            whole += payload
            if head[0] & 128:
                return whole.decode() if kind == 1 else whole

    def send_frame(self, opcode, payload, final=True):
        mask = os.urandom(4)
        length = len(payload)
        head = bytes([opcode | (128 if final else 0)])
        head += bytes([128 | length]) if length < 126 else struct.pack(">BH", 254, length) if length < 65536 else struct.pack(">BQ", 255, length)
        self.socket.sendall(head + mask + bytes(byte ^ mask[i % 4] for i, byte in enumerate(payload)))

    def close(self):
        self.socket.close()


class Viewer(Socket):
    """A client of Foxglove's protocol."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.info = json.loads(self.receive())
        self.channels = {channel["topic"]: channel for channel in json.loads(self.receive())["channels"]}
        self.statuses = []
        self.topics = {}
        self.published = {}

    def ask(self, **members):
        self.send_frame(1, json.dumps(members).encode())

    def subscribe(self, *topics):
        """By ids that differ from those of the channels."""
        subscriptions = []
        for topic in topics:
            number = self.channels[topic]["id"] + 1000
            self.topics[number] = topic
            subscriptions.append({"id": number, "channelId": self.channels[topic]["id"]})
        self.ask(op="subscribe", subscriptions=subscriptions)

    def message(self, topic=None):
        """The next message, of that topic; what else comes is kept in `statuses` or dropped. None: the end."""
        while True:
            got = self.receive()
            if got is None:
                return None
            if isinstance(got, str):
                self.statuses.append(json.loads(got))
                continue
            opcode, subscription, time_ns = struct.unpack("<BIQ", got[:13])
            assert opcode == 1, opcode
            if topic in (None, self.topics.get(subscription)):
                return Message(self.topics[subscription], time_ns, json.loads(got[13:]))

    def text(self, operation, limit=30):
        """The next text message of that operation. Samples may come for ever meanwhile."""
        end = time.monotonic() + limit
        while time.monotonic() < end:
            got = self.receive()
            if got is None:
                return None
            if isinstance(got, str) and json.loads(got)["op"] == operation:
                return json.loads(got)
        raise AssertionError(f"no message {operation} within {limit} s")

    def is_told(self, part, limit=30):
        """Returns when a status has said it, which may have been before, among messages of a topic."""
        end = time.monotonic() + limit
        while not any(part in status.get("message", "") for status in self.statuses):
            if time.monotonic() > end:
                raise AssertionError(f"no status says {part!r} within {limit} s: {self.statuses}")
            got = self.receive()
            if got is None:
                raise AssertionError(f"the server has closed, and no status says {part!r}")
            if isinstance(got, str):
                self.statuses.append(json.loads(got))

    def publish(self, topic, fields):
        self.publish_bytes(topic, json.dumps(fields).encode())

    def publish_bytes(self, topic, payload):
        if topic not in self.published:
            self.published[topic] = len(self.published) + 1
            self.ask(op="advertise", channels=[{"id": self.published[topic], "topic": topic, "encoding": "json", "schemaName": ""}])
        self.send_frame(2, struct.pack("<BI", 1, self.published[topic]) + payload)
