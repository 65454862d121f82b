"""The mapper's image with a world played for it: two wheels that push a robot over an even floor, and the registers
of its parts. Written from the data sheets and thesis 2, with nothing of the library."""

import math
import struct
import threading
import time

import harness
from harness import CONVERT, ENCODERS, I2cRegisters

GREEN, YELLOW = 1, 2
WHEEL_RADIUS, WHEELBASE, TICKS_PER_TURN, TICKS_PER_S = 0.033, 0.15, 198, 66  # m; the model avr_robot
CHIPS = ("qemu_m3", "qemu_m4")


class Lsm6ds3:
    """The gyroscope: bit 7 reads, CTRL3_C's IF_INC goes on to the next register. [LSM6DS3 data sheet 6.2, table 16]"""

    def __init__(self, world):
        self.world = world
        self.present = True
        self.reset()

    def reset(self):
        self.registers = bytearray(128)
        self.registers[0x0F], self.registers[0x12] = 0x69, 0x04

    def transfer(self, mode, clock, out):
        if not self.present:
            self.reset()  # it comes back as after power-up
            return b"\xff" * len(out)
        assert mode == 3 and clock <= 10_000_000, (mode, clock)
        at, answer = out[0] & 0x7F, bytearray([0])
        # CTRL2_G: on, 500 dps: 17.5 mdps a digit [table 3]
        rate = self.world.turn_rate() if self.registers[0x11] & 0xFC == 0x54 else 0
        self.registers[0x26:0x28] = struct.pack("<h", round(math.degrees(rate) / 0.0175))
        for byte in out[1:]:
            answer.append(self.registers[at] if out[0] & 0x80 else 0)
            if not out[0] & 0x80:
                self.registers[at] = byte
            at += 1 if self.registers[0x12] & 0x04 else 0
        return bytes(answer)


class Hmc5883l(I2cRegisters):
    """The compass: x, z, y, the high byte first; 390 counts a gauss at gain 5. [HMC5883L data sheet, tables 2 and 9]"""

    def __init__(self, world):
        super().__init__(dict(enumerate(b"H43", 10)))
        self.world = world
        self.own = (0.0, 0.0)  # gauss: the robot's own field, ahead and to the left

    def transfer(self, write, asked):
        heading = self.world.heading
        ahead, left = self.own
        field = (0.15 * math.cos(heading) + ahead, 0.4, -0.15 * math.sin(heading) + left)  # north is ahead at the start
        self.registers.update(enumerate(struct.pack(">3h", *(round(axis * 390) for axis in field)), 3))
        return super().transfer(write, asked)


class Eeprom:
    """AT24C01B: 128 bytes in pages of 8; for 5 ms after a page it does not acknowledge. [AT24C01B data sheet]"""

    def __init__(self):
        self.bytes = bytearray(b"\xff" * 128)
        self.at, self.written = 0, -1.0

    def transfer(self, write, asked):
        if time.monotonic() - self.written < 0.005:
            raise harness.NoAnswer
        if write:
            self.at = write[0]
            assert len(write) == 1 or self.at % 8 + len(write) - 1 <= 8, "over the end of a page"
            self.bytes[self.at:self.at + len(write) - 1] = write[1:]
            self.written = time.monotonic() if len(write) > 1 else self.written
        read = bytes(self.bytes[(self.at + i) % 128] for i in range(asked))
        self.at = (self.at + asked) % 128
        return read


class World(harness.Parts):
    """Registers on one side, a robot on a floor on the other."""

    def __init__(self):
        super().__init__()
        self.x = self.y = self.heading = 0.0
        self._speeds, self._ticks, self._at = [0.0, 0.0], [0.0, 0.0], time.monotonic()
        self._lock = threading.Lock()
        self.gyroscope, self.compass = Lsm6ds3(self), Hmc5883l(self)
        self.memory = Eeprom()
        self.spi, self.i2c = {1: self.gyroscope}, {(1, 0x1E): self.compass, (1, 0x50): self.memory}
        self.converter = {channel: 61 for channel in range(4)}  # 0.3 V: nothing within 80 cm

    def turn_rate(self):
        per_tick = 2 * math.pi * WHEEL_RADIUS / TICKS_PER_TURN
        return (self._speeds[1] - self._speeds[0]) * per_tick / WHEELBASE

    def turn_by_hand(self, degrees):
        """Neither its wheels nor its gyro see that: as if they were wrong by so much."""
        with self._lock:
            self.heading += math.radians(degrees)

    def advance(self):
        """To now: each wheel follows its motor within a tenth of a second, and hardly less at part duty. [Thesis 2, 10.2.3]"""
        with self._lock:
            now = time.monotonic()
            while self._at < now:
                dt = min(0.002, now - self._at)
                self._at += dt
                duty = self.duties[-1][1:] if self.duties else (0, 0)
                for i in range(2):
                    wanted = math.copysign(TICKS_PER_S * (0.85 + 0.15 * abs(duty[i]) / 32767), duty[i])
                    self._speeds[i] += ((wanted if abs(duty[i]) > 9000 else 0) - self._speeds[i]) * dt / 0.1
                    self._ticks[i] += self._speeds[i] * dt
                ahead = sum(self._speeds) / 2 * 2 * math.pi * WHEEL_RADIUS / TICKS_PER_TURN
                self.x += ahead * math.cos(self.heading) * dt
                self.y += ahead * math.sin(self.heading) * dt
                self.heading += self.turn_rate() * dt

    def answer(self, kind, unit, a, written, asked):
        self.advance()
        if kind == ENCODERS:
            self.encoders = tuple(int(ticks) & 0xFFFF for ticks in self._ticks)
        assert kind != CONVERT or unit in self.converter, unit
        return super().answer(kind, unit, a, written, asked)

    def standing(self):
        return not self.duties or self.duties[-1][1:] == (0, 0)

    def lamps(self, since=0.0):
        """(time, levels) at each change."""
        changes = []
        for at, levels in list(self.outputs):
            if not changes or changes[-1][1] != levels:
                changes.append((at, levels))
        return [change for change in changes if change[0] >= since]


class Robot(harness.Machine):
    """What it says is in `said`: (time, line), the packed updates as bytes. `connect` and `lose` move its dongle's pin."""

    def __init__(self, world, chip="qemu_m3", name="mapper"):
        super().__init__(name, chip, ("dongle", "parts", "pin"))
        self.world = world
        self.said = []
        self.thread(self._listen_dongle)
        self.thread(world.serve, self.lines["parts"])
        assert self.lines["pin"].recv(1) == b"\r", "the robot's first word: it listens"

    def _listen_dongle(self):
        rest = b""
        while True:
            try:
                data = self.lines["dongle"].recv(4096)
            except OSError:
                return
            if not data:
                return
            rest += data
            with self.news:
                while rest:
                    if rest[0] == 0xB1:  # a packed update: 20 bytes
                        if len(rest) < 20:
                            break
                        self.said.append((time.monotonic(), rest[:20]))
                        rest = rest[20:]
                    elif b"\n" in rest:
                        line, rest = rest.split(b"\n", 1)
                        self.said.append((time.monotonic(), line.decode("ascii", "replace")))
                    else:
                        break
                self.news.notify_all()

    def heard(self):
        return f"said {self.said[-8:]}; duties {self.world.duties[-3:]}; lamps {self.world.lamps()[-4:]}"

    def connect(self):
        """Pin 19 low. [Thesis 2, 6.4.1]"""
        self.lines["pin"].sendall(b"0")
        return time.monotonic()

    def lose(self):
        now = time.monotonic()
        self.lines["pin"].sendall(b"1")
        return now

    def tell(self, text):
        now = time.monotonic()
        self.lines["dongle"].sendall(text if isinstance(text, bytes) else text.encode("ascii") + b"\n")
        return now

    def of(self, start, since=0.0):
        """(time, line) of the lines that begin so."""
        return [(at, line) for at, line in list(self.said) if at >= since and isinstance(line, str) and
                line.startswith(start)]

    def updates(self, since=0.0):
        """(time, [x, y, heading, servo, s1, s2, s3, s4])"""
        return [(at, [int(number) for number in line[3:-1].split(",")]) for at, line in self.of("{U,", since)]

    def compass(self, since=0.0):
        """(time, [number, verdict, x, y, field, error, use])"""
        return [(at, [int(number) for number in line[3:-1].split(",")]) for at, line in self.of("{C,", since)]

    def packed(self, since=0.0):
        return [(at, line) for at, line in list(self.said) if at >= since and isinstance(line, bytes)]

    def confirm(self):
        """From switched on to confirmed."""
        self.connect()
        self.wait(lambda: self.of("{H,"), 15, "the first handshake, once the sensors are measured")
        now = self.tell("{S,CON}")
        self.wait(lambda: self.of("{U,", now), 5, "the first update")
        return now
