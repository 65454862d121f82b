"""Boots a board's image in QEMU and plays both of its serial lines: the bus, as an SLCAN host, and the parts, by plain
register files. Written from the manuals, with nothing of the library: what both got wrong alike would not be seen."""

import json
import os
import shutil
import socket
import struct
import subprocess
import tempfile
import threading
import time
import unittest

IMAGES = os.environ.get("OCM_IMAGES", "")
QEMU = shutil.which("qemu-system-arm")
MACHINES = {"qemu_m3": "netduino2", "qemu_m4": "netduinoplus2"}
CHIPS = {"di_wheel_drive": "qemu_m3", "light_ring": "qemu_m3", "power_management": "qemu_m4"}

# The parts' line: kinds and errors. [firmware/qemu/link.hpp; include/ocm/base/result.hpp]
I2C, SPI, SET_DUTY, ENCODERS, INPUTS, OUTPUTS = 1, 2, 3, 4, 5, 6


def error_numbers():
    """Names of ocm::base::Error in their order, from where it is defined."""
    with open(os.path.join(os.environ["OCM_SOURCE_DIR"], "include/ocm/base/result.hpp"), encoding="utf-8") as file:
        body = file.read().split("enum class Error")[1].split("{")[1].split("}")[0]
    names = [line.split("///")[0].strip().rstrip(",") for line in body.splitlines()]
    return {name: number for number, name in enumerate(name for name in names if name)}


ERRORS = error_numbers()


class NoAnswer(Exception):
    """Nobody acknowledges."""


class MotionSensor:
    """L3G4200D or LIS331DLH on SPI: bit 7 reads, bit 6 goes on to the next register."""

    def __init__(self, identity, output):
        self.registers = bytearray(64)
        self.registers[0x0F] = identity
        self.registers[0x28:0x2E] = struct.pack("<3h", *output)
        self.present = True

    def transfer(self, mode, clock, out):
        if not self.present:
            return b"\xff" * len(out)  # nobody drives the line
        assert mode == 3 and clock <= 10_000_000, (mode, clock)
        at, answer = out[0] & 0x3F, bytearray([0])
        for byte in out[1:]:
            answer.append(self.registers[at] if out[0] & 0x80 else 0)
            if not out[0] & 0x80:
                self.registers[at] = byte
            at += 1 if out[0] & 0x40 else 0
        return bytes(answer)


class I2cRegisters:
    """A part that is written a register's number, then data or a read."""

    def __init__(self, registers):
        self.registers = dict(registers)

    def transfer(self, write, asked):
        if len(write) > 1:
            for i, byte in enumerate(write[1:]):
                self.registers[write[0] + i] = byte
        return bytes(self.registers.get(write[0] + i, 0) for i in range(asked)) if asked else b""


class FuelGauge(I2cRegisters):
    """BQ27500: control() answers what its subcommand asked for."""

    def transfer(self, write, asked):
        if len(write) == 3 and bytes(write) == b"\x00\x01\x00":
            self.registers.update({0: 0x00, 1: 0x05})  # DEVICE_TYPE 0x0500
            return b""
        return super().transfer(write, asked)


class Parts:
    """What hangs on the parts' line. Everything that is not set is absent."""

    def __init__(self):
        self.i2c = {}            # (bus, address) -> part
        self.spi = {}            # device -> part
        self.encoders = (0, 0)
        self.inputs = 0
        self.duties = []         # (time, left, right)
        self.outputs = []        # (time, levels)
        self.exchanges = 0
        self.silent = False      # the host is away: no answers at all

    def answer(self, kind, unit, a, written, asked):
        if kind == I2C:
            part = self.i2c.get((unit, a))
            if part is None:
                raise NoAnswer
            return part.transfer(written, asked)
        if kind == SPI:
            part = self.spi.get(unit)
            clock, out = struct.unpack("<I", written[:4])[0], written[4:]
            return part.transfer(a, clock, out) if part else b"\xff" * len(out)
        if kind == SET_DUTY:
            self.duties.append((time.monotonic(), *struct.unpack("<2h", written)))
            return b""
        if kind == ENCODERS:
            return struct.pack("<2H", *self.encoders)
        if kind == INPUTS:
            return bytes([self.inputs])
        assert kind == OUTPUTS, kind
        self.outputs.append((time.monotonic(), written[0]))
        return b""

    def serve(self, line):
        """Until the board's end closes."""
        buffer = b""
        while True:
            try:
                data = line.recv(4096)
            except OSError:
                return
            if not data:
                return
            buffer += data
            while len(buffer) >= 6 and len(buffer) >= 6 + buffer[4]:
                (sequence, kind, unit, a, length, asked), buffer = buffer[:6], buffer[6:]
                written, buffer = buffer[:length], buffer[length:]
                self.exchanges += 1
                if self.silent:
                    continue
                try:
                    read = self.answer(kind, unit, a, written, asked)
                    assert len(read) == asked, (kind, unit, a, written, asked)
                    reply = bytes([sequence, 0, len(read)]) + read
                except NoAnswer:
                    reply = bytes([sequence, ERRORS["no_answer"], 0])
                try:
                    line.sendall(reply)
                except OSError:
                    return


class Board:
    """A running image. Frames that it sent are in `frames`: (time, id, data)."""

    def __init__(self, name, parts, chip=None):
        chip = chip or CHIPS[name]
        self.parts = parts
        self.frames = []
        self.answers = []        # lines that are no frames: "z", "V1010", "\a", ...
        self._news = threading.Condition()
        self._folder = tempfile.TemporaryDirectory(prefix="ocm-qemu-")
        listeners = [self._listen("can"), self._listen("parts"), self._listen("qmp")]
        self.process = subprocess.Popen(
            [QEMU, "-M", MACHINES[chip], "-nographic", "-monitor", "none", "-semihosting",
             "-kernel", os.path.join(IMAGES, f"{name}_{chip}.elf"),
             *(f for listener in ("can", "parts") for f in ("-serial", f"unix:{self._path(listener)}")),
             "-qmp", f"unix:{self._path('qmp')}"],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        lines = []
        for listener in listeners:
            listener.settimeout(20)
            lines.append(listener.accept()[0])
            listener.close()
        self._can, self._parts_line, self._qmp = lines
        self._qmp_file = self._qmp.makefile("rw")
        self._threads = [threading.Thread(target=self._listen_can, daemon=True),
                         threading.Thread(target=parts.serve, args=(self._parts_line,), daemon=True)]
        for thread in self._threads:
            thread.start()
        json.loads(self._qmp_file.readline())
        self.monitor("qmp_capabilities")
        # Before it says CR it does not listen: QEMU throws away what a UART gets that is not enabled.
        self.wait(lambda: self.answers, 10, "the adapter's first word")

    def _path(self, name):
        return os.path.join(self._folder.name, name)

    def _listen(self, name):
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(self._path(name))
        listener.listen(1)
        return listener

    def _listen_can(self):
        line = b""
        while True:
            try:
                data = self._can.recv(4096)
            except OSError:
                return
            if not data:
                return
            now = time.monotonic()
            for byte in data:
                if byte == 7:
                    self._heard(now, "\a")
                elif byte != 13:
                    line += bytes([byte])
                else:
                    self._heard(now, line.decode("ascii"))
                    line = b""

    def _heard(self, now, text):
        with self._news:
            if text.startswith("t"):
                data = bytes.fromhex(text[5:])
                assert len(data) == int(text[4]), text
                self.frames.append((now, int(text[1:4], 16), data))
            else:
                self.answers.append(text)
            self._news.notify_all()

    def monitor(self, command, **arguments):
        self._qmp_file.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        self._qmp_file.flush()
        while True:
            answer = json.loads(self._qmp_file.readline())
            if "event" not in answer:
                assert "return" in answer, answer
                return answer["return"]

    def say(self, text):
        """A line to the adapter."""
        self._can.sendall(text.encode("ascii") + b"\r")

    def ask(self, text, timeout=5):
        """The adapter's next answer that is no frame."""
        with self._news:
            seen = len(self.answers)
            self.say(text)
            assert self._news.wait_for(lambda: len(self.answers) > seen, timeout), f"no answer to {text!r}"
            return self.answers[seen]

    def send(self, identifier, data):
        """A frame to the board; when it was about to be sent."""
        now = time.monotonic()
        assert self.ask(f"t{identifier:03X}{len(data)}{data.hex().upper()}") == "z"
        return now

    def publish(self, topic, period_ms, priority=2):
        """Mode 1, period, unit 0: ms. [thesis 4.2]"""
        return self.send(priority << 8 | topic, struct.pack("<BHB", 1, period_ms, 0))

    def stop(self, topic, priority=2):
        return self.send(priority << 8 | topic, bytes(1))

    def wait(self, condition, timeout, what):
        """Until condition() holds; looked at with each frame and now and then."""
        end = time.monotonic() + timeout
        with self._news:
            while not condition():
                left = end - time.monotonic()
                assert left > 0, f"{what}: not within {timeout} s; heard {self.frames[-5:]}"
                self._news.wait(min(left, 0.02))

    def of(self, identifier, since=0.0):
        return [(at, data) for at, name, data in list(self.frames) if name == identifier and at >= since]

    def memory(self, start, size):
        path = self._path("memory")
        self.monitor("pmemsave", val=start, size=size, filename=path)
        with open(path, "rb") as file:
            return file.read()

    def end(self, code=None):
        """Ends QEMU. An image that gave up said why, and is not running any more: that is wrong, unless `code` is what
        it has to end with."""
        if code is None:
            gone = self.process.poll()
            if gone is None:
                self.process.kill()
        else:
            gone = self.process.wait(10)
        said = self.process.communicate()[0]
        self._qmp_file.close()
        for line in (self._can, self._parts_line, self._qmp):
            line.close()
        for thread in self._threads:
            thread.join(5)
        self._folder.cleanup()
        assert gone == code, f"the image ended with {gone}: {said}"


class Case(unittest.TestCase):
    def boot(self, name, parts, chip=None):
        board = Board(name, parts, chip)
        self.addCleanup(board.end)
        return board


def main():
    if QEMU is None or not os.path.isdir(IMAGES):
        print("no qemu-system-arm, or no images in OCM_IMAGES: nothing tested")
        raise SystemExit(77)
    unittest.main()
