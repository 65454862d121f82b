"""A client of the virtual bus in Python (docs/virtual-bus.md): sends numbered frames as fast as the bus takes them."""

import os
import socket
import struct

RECORD = 32
HELLO, FRAME, CREDIT, OVERRUN, _, _, GOODBYE = range(1, 8)
MAGIC, VERSION = 0x6D636F62, 1


class Client:
    """One node of the bus of `folder` (XDG_RUNTIME_DIR)."""

    def __init__(self, folder):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.socket.connect(os.path.join(folder, "ocm", "sim.sock"))
        self.socket.send(struct.pack("<B3xIIII12s", HELLO, MAGIC, VERSION, 0, 0, b""))
        self.credit = 0
        self.frames = []  # identifier, data: what others sent
        self.bit_rate = 0
        while self.bit_rate == 0:
            self.receive()

    def receive(self):
        """Waits for the server to say something, and takes it."""
        message = self.socket.recv(RECORD * 128)
        if not message:
            raise EOFError("the simulator is gone")
        for at in range(0, len(message), RECORD):
            record = message[at:at + RECORD]
            if record[0] == HELLO:
                _, _, self.bit_rate, self.credit = struct.unpack_from("<IIII", record, 4)
            elif record[0] == CREDIT:
                self.credit += struct.unpack_from("<Q", record, 8)[0]
            elif record[0] == FRAME:
                dlc, number = record[2], struct.unpack_from("<I", record, 4)[0]
                self.frames.append((number, record[16:16 + dlc]))
            elif record[0] == GOODBYE:
                raise EOFError("the simulator says goodbye")

    def send(self, number, data=b"", form=0):
        """One frame; waits for room. `form`: 0 base, 1 extended, 2 base remote, 3 extended remote."""
        while self.credit == 0:
            self.receive()
        self.credit -= 1
        self.socket.send(struct.pack("<BBBxIq8s8x", FRAME, form, len(data), number, 0, data))

    def close(self):
        """In order: what waits for the bus is sent."""
        self.socket.send(struct.pack("<BB2xI24x", GOODBYE, 0, VERSION))
        self.socket.close()
