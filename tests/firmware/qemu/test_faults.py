"""A board that breaks, in QEMU: its actuators are at rest before it restarts, its status names the cause, and it serves
again. The images are those of the boards with one thing more, which breaks them when the host asks for it
(firmware/qemu/fault_injection.hpp); the way from the fault on is that of the real boards."""
# Sleeps: emulated boards run in real time, and drive, publish or are silent for so long.

import struct
import time

import harness
from harness import INPUTS, OUTPUTS, SET_DUTY, Parts
from test_boards import GYRO, di_wheel_drive_parts, motors

STATUS = {"di_wheel_drive": 0x1B, "light_ring": 0x57, "power_management": 0x39}
NOTE = 0x20008000  # ocm_restart_note: magic, cause, where, check

# Breakdowns [fault_injection.hpp], and what the status says of each [spec/topics.json, field reset].
POWER, WATCHDOG, FAULT, MEMORY_FAULT, BUS_FAULT, USAGE_FAULT, KERNEL_HALT = 1, 4, 6, 7, 8, 9, 10
BREAKPOINT, INVALID_INSTRUCTION, EXECUTE_NEVER, LOST_STACK, HALT, HANG_LOW, HANG_URGENT = range(1, 8)


def breaking(parts):
    """`parts`, and the inputs that break the board: once for each number in `breakdowns`. What the board set is in
    `events`, in its order."""

    class Breaking(type(parts)):
        def __init__(self):
            super().__init__()
            self.breakdowns = []
            self.asked = 0
            self.events = []

        def answer(self, kind, unit, a, written, asked):
            if kind == INPUTS and unit == 9:
                self.asked += 1
                return bytes([self.breakdowns.pop(0) if self.breakdowns else 0])
            if kind in (OUTPUTS, SET_DUTY):
                self.events.append((kind, bytes(written)))
            return super().answer(kind, unit, a, written, asked)

    result = Breaking()
    for name, value in vars(parts).items():
        setattr(result, name, value)
    return result


class Breakdowns(harness.Case):
    def start(self, name, parts=None):
        self.name = name
        self.parts = breaking(parts or Parts())
        self.board = self.boot(f"{name}_fault_test", self.parts, harness.CHIPS[name], restarts=True)

    def status(self):
        """Cause of the start and seconds since, from a status that is asked for once."""
        asked = time.monotonic()
        topic = STATUS[self.name]
        self.board.send(0x200 | topic, b"\x02")
        self.board.wait(lambda: self.board.of(0x600 | topic, asked), 5, "the status")
        data = self.board.of(0x600 | topic, asked)[0][1]
        return data[3], int.from_bytes(data[:3], "little")

    def breaks(self, breakdown):
        """Breaks the board, and waits until it serves again. The events from the breakdown on, and the cause that its
        status names."""
        started, events = len(self.board.answers), len(self.parts.events)
        self.parts.breakdowns.append(breakdown)
        self.board.wait(lambda: len(self.board.answers) > started, 10, "the restart")
        self.assertEqual(self.board.answers[started:], [""], "the adapter's first word after the restart")
        cause, uptime = self.status()
        self.assertLess(uptime, 10)
        return self.parts.events[events:], cause

    def where(self):
        """What the note keeps for a debugger; the note itself was taken."""
        magic, _, where, _ = struct.unpack("<4I", self.board.memory(NOTE, 16))
        self.assertEqual(magic, 0, "a note is believed only once")
        return where

    def function_at(self, address):
        names = [name for name, (start, size) in self.board.symbols().items() if start & ~1 <= address < start + size]
        return " ".join(names)


class DiWheelDrive(Breakdowns):
    def setUp(self):
        self.start("di_wheel_drive", di_wheel_drive_parts())

    def drive(self):
        self.board.send(0x201, motors(200_000))
        self.board.wait(lambda: self.parts.duties and min(self.parts.duties[-1][1:]) > 0, 5, "movement")

    def expect_rest(self, events):
        """Power off and no duty, and no other duty until the program that starts next switches the power on again. What
        came before: whether the motors had voltage until then."""
        off = events.index((OUTPUTS, b"\0"))
        rest = events[off:events.index((OUTPUTS, b"\1"))]
        self.assertEqual(set(rest), {(OUTPUTS, b"\0"), (SET_DUTY, bytes(4))}, events)
        self.assertEqual(rest[1], (SET_DUTY, bytes(4)), "at once")
        before = [data for kind, data in events[:off] if kind == SET_DUTY]
        return not before or any(before[-1])

    def test_each_fault_rests_the_motors_and_names_itself(self):
        self.assertEqual(self.status()[0], POWER)
        for breakdown, cause in ((BREAKPOINT, FAULT), (INVALID_INSTRUCTION, USAGE_FAULT),
                                 (EXECUTE_NEVER, MEMORY_FAULT), (LOST_STACK, BUS_FAULT), (HALT, KERNEL_HALT)):
            with self.subTest(cause):
                self.drive()
                events, said = self.breaks(breakdown)
                self.assertTrue(self.expect_rest(events), "the motors had stopped before")
                self.assertEqual(said, cause)
                self.assertEqual(self.parts.duties[-1][1:], (0, 0))

    def test_the_note_says_where(self):
        self.breaks(INVALID_INSTRUCTION)
        self.assertIn("FaultInjection::happen", self.function_at(self.where()))
        self.breaks(LOST_STACK)
        self.assertEqual(self.where(), 0, "a stack that leads nowhere is not read")
        self.breaks(HALT)
        self.assertEqual(self.board.memory(self.where(), 10), b"on request")

    def test_streams_are_gone_and_can_be_asked_for_again(self):
        self.board.publish(GYRO, 20)
        self.board.wait(lambda: len(self.board.of(0x608)) > 5, 10, "the gyroscope")
        self.breaks(INVALID_INSTRUCTION)
        back = time.monotonic()
        time.sleep(0.7)
        self.assertEqual(self.board.of(0x608, back), [], "published without a request")
        self.board.publish(GYRO, 20)
        self.board.wait(lambda: len(self.board.of(0x608, back)) > 5, 10, "the gyroscope, asked for again")
        self.drive()

    def test_a_level_that_hangs_is_missed(self):
        for breakdown in (HANG_LOW, HANG_URGENT):
            with self.subTest(breakdown):
                self.drive()
                events, cause = self.breaks(breakdown)
                self.expect_rest(events)
                self.assertEqual(cause, WATCHDOG)

    def test_nothing_to_do_and_much_to_do_are_no_hang(self):
        # The played watchdog waits for 1 s: without a sign of every level the board would not come this far.
        time.sleep(3)
        self.board.publish(GYRO, 10, 0)
        self.board.publish(0x09, 10, 3)
        time.sleep(3)
        cause, uptime = self.status()
        self.assertEqual(cause, POWER)
        self.assertGreaterEqual(uptime, 5)


class LightRing(Breakdowns):
    class Lights:
        def transfer(self, mode, clock, out):
            return bytes(len(out))

    def test_dark(self):
        parts = Parts()
        parts.spi[1] = self.Lights()
        self.start("light_ring", parts)
        self.board.wait(lambda: self.parts.events and self.parts.events[-1] == (OUTPUTS, b"\0"), 5, "outputs on")
        events, cause = self.breaks(INVALID_INSTRUCTION)
        self.assertEqual(events[0], (OUTPUTS, b"\1"), "blank")
        self.assertEqual(cause, USAGE_FAULT)


class PowerManagement(Breakdowns):
    def test_on_the_other_core(self):
        self.start("power_management")
        self.assertEqual(self.status()[0], POWER)
        self.assertEqual(self.breaks(INVALID_INSTRUCTION)[1], USAGE_FAULT)


if __name__ == "__main__":
    harness.main()
