"""Boots a board's image in QEMU and plays both of its serial lines: the bus, as an SLCAN host, and the parts, by plain
register files. Written from the manuals, with nothing of the library: what both got wrong alike would not be seen."""

import json
import os
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
from realtime import RealTime  # noqa: E402

IMAGES = os.environ.get("OCM_IMAGES", "")
QEMU = shutil.which("qemu-system-arm")
MACHINES = {"qemu_m3": "netduino2", "qemu_m4": "netduinoplus2"}
CHIPS = {"di_wheel_drive": "qemu_m3", "light_ring": "qemu_m3", "power_management": "qemu_m4"}

# The parts' line: kinds and errors. [firmware/qemu/parts_frames.hpp; include/ocm/base/result.hpp]
I2C, SPI, SET_DUTY, ENCODERS, INPUTS, OUTPUTS, CONVERT, SET_PULSE = 1, 2, 3, 4, 5, 6, 7, 8


def error_numbers():
    """Names of ocm::base::Error in their order, from where it is defined."""
    with open(os.path.join(os.environ["OCM_SOURCE_DIR"], "include/ocm/base/result.hpp"), encoding="utf-8") as file:
        body = file.read().split("enum class Error")[1].split("{")[1].split("}")[0]
    names = [line.split("///")[0].strip().rstrip(",") for line in body.splitlines()]
    return {name: number for number, name in enumerate(name for name in names if name)}


ERRORS = error_numbers()


class NoAnswer(Exception):
    """No part acknowledges."""


class MotionSensor:
    """L3G4200D or LIS331DLH on SPI: bit 7 reads, bit 6 goes on to the next register."""

    def __init__(self, identity, output):
        self.registers = bytearray(64)
        self.registers[0x0F] = identity
        self.registers[0x28:0x2E] = struct.pack("<3h", *output)
        self.present = True

    def transfer(self, mode, clock, out):
        if not self.present:
            return b"\xff" * len(out)  # the line is not driven
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
        self.converter = {}      # channel -> count
        self.pulses = []         # (time, counts)
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
        if kind == CONVERT:
            return struct.pack("<H", self.converter[unit])
        if kind == SET_PULSE:
            self.pulses.append((time.monotonic(), *struct.unpack("<H", written)))
            return b""
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


class Machine:
    """A running image; its serial lines, named in their order, are `lines`. `news` is notified when something came. One
    that restarts ends, unless it `restarts`: a fault is no part of a test that does not ask for it."""

    def __init__(self, name, chip, lines, restarts=False):
        self.news = threading.Condition()
        self._folder = tempfile.TemporaryDirectory(prefix="ocm-qemu-")
        listeners = {line: self._listen(line) for line in (*lines, "qmp")}
        self.image = os.path.join(IMAGES, f"{name}_{chip}.elf")
        self.process = subprocess.Popen(
            [QEMU, "-M", MACHINES[chip], "-nographic", "-monitor", "none", "-semihosting", "-kernel", self.image,
             *([] if restarts else ["-no-reboot"]),
             *(f for line in lines for f in ("-serial", f"unix:{self._path(line)}")),
             "-qmp", f"unix:{self._path('qmp')}"],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.lines = {}
        for line, listener in listeners.items():
            listener.settimeout(20)
            self.lines[line] = listener.accept()[0]
            listener.close()
        self._qmp_file = self.lines["qmp"].makefile("rw")
        self._threads = []
        json.loads(self._qmp_file.readline())
        self.monitor("qmp_capabilities")

    def _path(self, name):
        return os.path.join(self._folder.name, name)

    def _listen(self, name):
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(self._path(name))
        listener.listen(1)
        return listener

    def thread(self, target, *arguments):
        thread = threading.Thread(target=target, args=arguments, daemon=True)
        self._threads.append(thread)
        thread.start()

    def monitor(self, command, **arguments):
        self._qmp_file.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        self._qmp_file.flush()
        while True:
            answer = json.loads(self._qmp_file.readline())
            if "event" not in answer:
                assert "return" in answer, answer
                return answer["return"]

    def wait(self, condition, timeout, what):
        """Until condition() holds; looked at with each news and now and then."""
        end = time.monotonic() + timeout
        with self.news:
            while not condition():
                left = end - time.monotonic()
                assert left > 0, f"{what}: not within {timeout} s; {self.heard()}"
                self.news.wait(min(left, 0.02))

    def heard(self):
        """For a wait without result."""
        return ""

    def memory(self, start, size):
        path = self._path("memory")
        self.monitor("pmemsave", val=start, size=size, filename=path)
        with open(path, "rb") as file:
            return file.read()

    def symbols(self):
        """Name -> (address, size) of the image's variables, and of what its linker script defines."""
        found = {}
        for line in subprocess.run(["arm-none-eabi-nm", "-SC", self.image], capture_output=True, text=True,
                                   check=True).stdout.splitlines():
            fields = line.split(maxsplit=3)
            if len(fields) == 4 and len(fields[1]) == 8:
                found[fields[3]] = (int(fields[0], 16), int(fields[1], 16))
            elif fields[-1].startswith("__"):
                found[fields[-1]] = (int(fields[0], 16), 0)
        return found

    def untouched(self, threads, names):
        """Bytes of stack that were never touched, by the fill patterns in the machine's memory: those of the threads
        `names` in the variable that ends with `threads`, of main()'s, which is the lowest level's, and of the interrupts."""
        symbols = self.symbols()
        place = next(place for name, place in symbols.items() if name.endswith(threads) and "guard" not in name)
        memory = self.memory(*place)
        runs, at = [], 0
        while at < len(memory):
            length = 0
            while at + length < len(memory) and memory[at + length] == 0x55:
                length += 1
            if length >= 32:
                runs.append(length)
            at += length + 1
        assert len(runs) == len(names), (names, runs)
        free = dict(zip(names, runs))
        for name, stack in (("low", "process"), ("interrupts", "main")):
            start, end = (symbols[f"__{stack}_stack_{side}__"][0] for side in ("base", "end"))
            memory = self.memory(start, end - start)
            free[name] = len(memory) - len(memory.lstrip(b"\x55"))
        return free

    def end(self, code=None):
        """Ends QEMU. An image that gave up said why, and is not running any more: that is wrong, unless `code` is what
        it has to end with. What QEMU said."""
        if code is None:
            gone = self.process.poll()
            if gone is None:
                self.process.kill()
        else:
            gone = self.process.wait(10)
        said = self.process.communicate()[0]
        self._qmp_file.close()
        for line in self.lines.values():
            line.close()
        for thread in self._threads:
            thread.join(5)
        self._folder.cleanup()
        assert gone == code, f"the image ended with {gone}: {said}"
        return said


class Board(Machine):
    """A board on its bus. Frames that it sent are in `frames`: (time, id, data)."""

    def __init__(self, name, parts, chip=None, restarts=False):
        super().__init__(name, chip or CHIPS[name], ("can", "parts"), restarts)
        self.parts = parts
        self.frames = []
        self.answers = []        # lines that are no frames: "z", "V1010", "\a", ...
        self._can = self.lines["can"]
        self.thread(self._listen_can)
        self.thread(parts.serve, self.lines["parts"])
        # Before it says CR it does not listen: QEMU throws away what a UART gets that is not enabled.
        self.wait(lambda: self.answers, 10, "the adapter's first word")

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
        with self.news:
            if text.startswith("t"):
                data = bytes.fromhex(text[5:])
                assert len(data) == int(text[4]), text
                self.frames.append((now, int(text[1:4], 16), data))
            else:
                self.answers.append(text)
            self.news.notify_all()

    def say(self, text):
        """A line to the adapter."""
        self._can.sendall(text.encode("ascii") + b"\r")

    def ask(self, text, timeout=5):
        """The adapter's next answer that is no frame."""
        with self.news:
            seen = len(self.answers)
            self.say(text)
            assert self.news.wait_for(lambda: len(self.answers) > seen, timeout), f"no answer to {text!r}"
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

    def heard(self):
        return f"heard {self.frames[-5:]}"

    def of(self, identifier, since=0.0):
        return [(at, data) for at, name, data in list(self.frames) if name == identifier and at >= since]


class Case(RealTime):
    def boot(self, name, parts, chip=None, restarts=False):
        board = Board(name, parts, chip, restarts)
        self.addCleanup(board.end)
        return board


def main():
    if QEMU is None or not os.path.isdir(IMAGES):
        print("no qemu-system-arm, or no images in OCM_IMAGES: nothing tested")
        raise SystemExit(77)
    unittest.main()
