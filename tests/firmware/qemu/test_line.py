"""A host on DiWheelDrive's serial line: driver of the USART, bridge and its thread as on the chip, in QEMU, with a played CAN
bus behind them (firmware/qemu/line_test.cpp). The hosts are written from the manual; and amiroctl."""
# Sleeps: an emulated line runs in real time, and carries, or is silent, for so long.

import os
import socket
import struct
import subprocess
import time
import unittest

import harness
import waiting
from test_boards import ACCEL, GYRO, GYRO_OUTPUT, di_wheel_drive_parts

AMIROCTL = os.environ.get("AMIROCTL")
PLAY, CONDITION = 0x7F0, 0x7F1
FOREIGN, FOREIGN_EXTENDED = 0x6A0, 0x12345678
LINE = 11_520  # characters a second


class Host(harness.Machine):
    """The image, and an SLCAN host on its first line. `said` has each line and BEL with its time."""

    def __init__(self):
        super().__init__("line_test", "qemu_m3", ("line", "parts"))
        self.parts = di_wheel_drive_parts()
        self.said = []
        self.relay = None        # a program that has the line instead
        self.thread(self._hear)
        self.thread(self.parts.serve, self.lines["parts"])
        self.wait(lambda: self.said, 10, "the first CR")
        self.said.clear()

    def _hear(self):
        text = b""
        while True:
            try:
                data = self.lines["line"].recv(4096)
            except OSError:
                return
            if not data:
                return
            if (program := self.relay) is not None:
                try:
                    program.sendall(data)
                except OSError:
                    pass  # it has ended
                continue
            now = time.monotonic()
            with self.news:
                for byte in data:
                    if byte in (7, 13):
                        self.said.append((now, text.decode("ascii") + ("\a" if byte == 7 else "")))
                        text = b""
                    else:
                        text += bytes([byte])
                self.news.notify_all()

    def heard(self):
        return f"heard {self.said[-5:]}"

    def write(self, data):
        self.lines["line"].sendall(data if isinstance(data, bytes) else data.encode("ascii"))

    def answers(self):
        return [text for _, text in list(self.said) if text[:1] not in ("t", "T")]

    def ask(self, text, count=1):
        """The answers to a line: those that are no frames."""
        seen = len(self.answers())
        self.write(text + "\r")
        self.wait(lambda: len(self.answers()) >= seen + count, 10, f"the answer to {text!r}")
        return self.answers()[seen]

    def open(self):
        for command in ("S6", "O"):
            assert self.ask(command) == "", command

    def send(self, identifier, data):
        return self.ask(f"t{identifier:03X}{len(data)}{data.hex().upper()}")

    def publish(self, topic, period_ms, priority=2):
        assert self.send(priority << 8 | topic, struct.pack("<BHB", 1, period_ms, 0)) == "z"

    def frames(self, identifier, since=0):
        head = f"t{identifier:03X}" if identifier < 0x800 else f"T{identifier:08X}"
        return [(at, bytes.fromhex(text[len(head) + 1:])) for at, text in list(self.said)[since:] if text.startswith(head)]


class Line(harness.Case):
    def setUp(self):
        self.host = Host()
        self.addCleanup(lambda: self.host.end(self.code))
        self.code = None

    def test_silent_until_it_is_opened_and_after_it_is_closed(self):
        host = self.host
        self.assertEqual(host.ask("t2081AB"), "\a")
        self.assertEqual(host.ask("S5"), "\a")
        self.assertEqual(host.ask("V"), "V1110")
        self.assertEqual(host.ask("N"), "NDIWD")
        host.open()
        host.publish(GYRO, 20)
        host.wait(lambda: len(host.frames(0x608)) >= 5, 10, "five samples")
        self.assertEqual(host.frames(0x608)[-1][1], struct.pack("<3h", *GYRO_OUTPUT))
        self.assertEqual(host.ask("C"), "")
        time.sleep(0.1)
        seen = len(host.said)
        time.sleep(0.5)
        self.assertEqual(host.said[seen:], [], "a closed channel says nothing")
        self.assertEqual(host.ask("O"), "")
        host.wait(lambda: host.frames(0x608, seen + 1), 10, "the samples go on: the board has not noticed")

    def test_other_boards_are_heard_in_order(self):
        host = self.host
        host.open()
        self.assertEqual(host.send(PLAY, struct.pack("<2H", 200, 10_000)), "z")
        host.wait(lambda: len(host.frames(FOREIGN)) + len(host.frames(FOREIGN_EXTENDED)) >= 200, 20, "all frames")
        self.assertEqual(self.numbers(), list(range(200)))
        self.assertEqual(len(host.frames(FOREIGN_EXTENDED)), 50)
        self.assertEqual(host.ask("F"), "F00")

    def test_storm(self):
        """Twice the frames that the line carries: it carries what it can, the rest is reported, and the board's own work and the
        host's commands go on."""
        host = self.host
        host.open()
        host.publish(GYRO, 100, priority=0)
        host.wait(lambda: len(host.frames(0x408)) >= 5, 10, "the gyroscope's first frames")
        self.assertEqual(host.send(PLAY, struct.pack("<2H", 1000, 700)), "z")
        flags = 0
        while not flags & 0x01:
            flags |= int(host.ask("F")[1:], 16)
        self.assertEqual(flags, 0x01, "frames are lost, and nothing else is wrong")
        self.assertEqual(host.ask("V"), "V1110")  # while the line is full
        while True:
            seen = len(self.numbers())
            time.sleep(1)
            host.ask("V")  # it has run meanwhile
            if len(self.numbers()) == seen:
                break
        numbers = self.numbers()
        self.assertLess(len(numbers), 1000)
        self.assertGreater(len(numbers), 100)
        self.assertEqual(numbers, sorted(set(numbers)), "in order, and none twice")
        self.assertEqual([host.ask("F"), host.ask("F")][1], "F00")
        seen = len(host.said)
        host.wait(lambda: len(host.frames(0x408, seen)) >= 5, 10, "the board's samples, as before")
        self.assertEqual(host.send(0x31D, b"\x02"), "z")
        host.wait(lambda: host.frames(0x71D), 10, "what it says of refusals")
        lost = struct.unpack("<BBHHH", host.frames(0x71D)[0][1])[4]
        self.assertGreaterEqual(lost, 1000 - len(numbers))
        self.assertLess(lost, 1000 - len(numbers) + 50)  # and some of the gyroscope's

    def numbers(self):
        """Of the other boards' frames."""
        return [struct.unpack("<I", bytes.fromhex(text[-16:])[:4])[0] for _, text in list(self.host.said)
                if text.startswith((f"t{FOREIGN:03X}", f"T{FOREIGN_EXTENDED:08X}"))]

    def test_line_is_no_faster_than_its_bits(self):
        host = self.host
        host.open()
        seen = len(host.said)
        self.assertEqual(host.send(PLAY, struct.pack("<2H", 500, 700)), "z")
        host.wait(lambda: len(host.said) > seen + 200, 20, "200 lines")
        lines = host.said[seen + 1:]
        characters = sum(len(text) + 1 for _, text in lines)
        self.assertLess(characters / (lines[-1][0] - lines[0][0]), 1.3 * LINE, "the played line has no pace")

    def test_states_of_the_bus(self):
        host = self.host
        host.open()
        self.assertEqual(host.ask("F"), "F00")
        self.assertEqual(host.send(CONDITION, bytes([0x24, 1])), "z")
        self.assertEqual([host.ask("F"), host.ask("F")], ["FA4", "F24"])
        self.assertEqual(host.send(CONDITION, bytes(2)), "z")
        self.assertEqual(host.ask("F"), "F00")

    def test_garbage_and_half_lines(self):
        host = self.host
        host.open()
        for garbage in (b"t2081A\r", b"t2089\r", b"\x00\x80\xff\r", b"t208\r", b"t2081ABt2081AB\r", b"x" * 600 + b"\r"):
            seen = len(host.answers())
            host.write(garbage)
            host.wait(lambda: len(host.answers()) > seen, 10, repr(garbage))
            self.assertEqual(host.answers()[-1], "\a")
        host.publish(GYRO, 20)
        host.wait(lambda: host.frames(0x608), 10, "a sample")
        host.write("t208")  # this host ends here; the next one begins
        self.assertEqual(host.ask("\rC", 2), "\a")
        for command, answer in (("V", "V1110"), ("S6", ""), ("Z1", ""), ("O", "")):
            self.assertEqual(host.ask(command), answer)
        self.assertEqual(host.send(0x208, b"\x02"), "z")

    def test_connect_is_obeyed_on_an_open_line(self):
        self.host.open()
        self.host.publish(GYRO, 20)
        self.code = 0
        self.host.write(b"t20\x02\xff\x00")
        self.assertEqual(self.host.process.wait(10), 0)

    def test_connect_is_obeyed_on_a_closed_line(self):
        self.code = 0
        self.host.write(b"\x02\xff\x00")
        self.assertEqual(self.host.process.wait(10), 0)

    def test_levels_do_not_notice(self):
        """The stack of the line's thread, and the board's own samples at their period under a storm."""
        host = self.host
        host.open()
        host.publish(ACCEL, 50, priority=0)
        host.wait(lambda: len(host.frames(0x409)) >= 3, 10, "the first samples")
        self.assertEqual(host.send(PLAY, struct.pack("<2H", 3000, 1000)), "z")
        host.write("Z1\rV\rF\rT1234567881122334455667788\r")
        time.sleep(2)
        free = host.untouched("::line", ["line"])["line"]
        self.assertGreater(free, 150, "of the stack of the line's thread")


@unittest.skipIf(AMIROCTL is None, "no amiroctl")
class Tool(harness.Case):
    """amiroctl at the other end, through a socket of its own."""

    def setUp(self):
        self.host = Host()
        self.addCleanup(self.host.end)
        self.path = self.host._path("tool")
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(self.path)
        self.listener.listen(1)
        self.addCleanup(self.listener.close)
        self.host.thread(self._serve)

    def _serve(self):
        while True:
            try:
                program = self.listener.accept()[0]
            except OSError:
                return
            with program:
                self.host.relay = program
                try:
                    while data := program.recv(4096):
                        self.host.write(data)
                except OSError:
                    pass

    def tool(self, *arguments, code=0):
        result = subprocess.run([AMIROCTL, "--bus", f"slcan:{self.path}", *arguments], capture_output=True, text=True,
                                timeout=60, check=False)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result

    def test_once_and_listen(self):
        def known():
            once = [AMIROCTL, "--bus", f"slcan:{self.path}", "once", "gyro", "--wait"]
            return subprocess.run(once, capture_output=True, timeout=120, check=False).returncode == 0
        waiting.until(known, "the parts are known")
        out = self.tool("once", "gyro", "--wait").stdout
        self.assertIn("gyroscope", out)
        self.tool("publish", "accelerometer", "100ms")
        out = self.tool("listen", "-n", "5", "accelerometer").stdout
        self.assertEqual(out.count('"topic":"accelerometer"'), 5, out)
        self.tool("stop", "accelerometer")

    def test_doctor(self):
        out = self.tool("doctor", code=1).stdout  # the other boards are only played
        line = next(line for line in out.splitlines() if line.startswith("di_wheel_drive "))
        self.assertIn("same", line)
        self.assertIn("light_ring", out)


if __name__ == "__main__":
    harness.main()
