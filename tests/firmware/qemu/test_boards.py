"""The boards' images in QEMU: requests over SLCAN, parts that are there, away or come back, actuators, stacks."""
# Sleeps: emulated boards run in real time, and drive, publish or are silent for so long.

import struct
import time

import harness
from harness import FuelGauge, I2cRegisters, MotionSensor, Parts

GYRO, ACCEL, MAG, ODOMETRY = 0x08, 0x09, 0x05, 0x03
GYRO_OUTPUT, ACCEL_OUTPUT = (100, -200, 32767), (-64, 1600, 8192)


def di_wheel_drive_parts():
    """SPI 1 gyroscope, SPI 2 accelerometer, I2C 1 compass; no floor sensors, no EEPROM. [docs/parts.md]"""
    parts = Parts()
    parts.spi = {1: MotionSensor(0xD3, GYRO_OUTPUT), 2: MotionSensor(0x32, ACCEL_OUTPUT)}
    compass = dict(enumerate(b"H43", 10)) | dict(enumerate(struct.pack(">3h", 100, -7, 2), 3))
    parts.i2c = {(1, 0x1E): I2cRegisters(compass)}
    return parts


def motors(forward_um_s, turn_urad_s=0):
    return struct.pack("<2i", forward_um_s, turn_urad_s)


class DiWheelDrive(harness.Case):
    def setUp(self):
        self.parts = di_wheel_drive_parts()
        self.board = self.boot("di_wheel_drive", self.parts)

    def settle(self):
        """The gyroscope's turn-on is the longest: 300 ms. [AN3393 2.4]"""
        self.board.publish(GYRO, 10)
        self.board.wait(lambda: self.board.of(0x608), 10, "the gyroscope's first frame")
        self.board.stop(GYRO)
        time.sleep(0.05)

    def test_publishes_at_the_period(self):
        self.settle()
        asked = self.board.publish(GYRO, 500)
        self.assertEqual(bytes.fromhex("01F40100"), struct.pack("<BHB", 1, 500, 0))
        self.board.wait(lambda: len(self.board.of(0x608, asked)) >= 7, 10, "seven frames")
        frames = self.board.of(0x608, asked)[:7]
        self.assertEqual({data for _, data in frames}, {struct.pack("<3h", *GYRO_OUTPUT)})
        self.assertLess(frames[0][0] - asked, 0.2, "the first sample is due at once")
        self.assertAlmostEqual((frames[6][0] - frames[0][0]) / 6, 0.5, delta=0.02)
        self.board.stop(GYRO)
        time.sleep(0.1)
        heard = len(self.board.frames)
        time.sleep(1.2)
        self.assertEqual(self.board.frames[heard:], [], "a stopped topic went on")

    def test_four_levels_at_once(self):
        self.settle()
        for level, topic in enumerate((GYRO, ACCEL, MAG, ODOMETRY)):
            # Parts answer in real time, too: every 50 ms, a busy machine's are too slow, and the lower levels lose samples.
            self.board.publish(topic, 200, level)
        identifiers = (0x408, 0x509, 0x605, 0x606, 0x607, 0x702, 0x703)
        # A request may come to the board late, with the first frames of those before it long here.
        self.board.wait(lambda: all(map(self.board.of, identifiers)), 30, "a frame of each")
        begin = time.monotonic()
        # By the frames that come and not by the clock, which an emulator on a busy machine falls behind.
        self.board.wait(lambda: all(len(self.board.of(each, begin)) >= 40 for each in identifiers), 30, "40 frames of each")
        end = time.monotonic()
        self.assertGreater(end - begin, 7.2, "faster than every 200 ms")
        expected = {0x408: struct.pack("<3h", *GYRO_OUTPUT),
                    # 12 bits, left-justified, 1/512 g each: in 1/1024 g
                    0x509: struct.pack("<3h", *(value // 16 * 2 for value in ACCEL_OUTPUT)),
                    # sent x, y, z, but registers are x, z, y; 2560 uG a count
                    0x605: struct.pack("<i", 100 * 2560), 0x606: struct.pack("<i", 2 * 2560),
                    0x607: struct.pack("<i", -7 * 2560)}
        for identifier in identifiers:
            frames = [frame for frame in self.board.of(identifier, begin) if frame[0] < end]
            self.assertAlmostEqual(len(frames), 42, delta=2, msg=f"{identifier:03X}")
            if identifier in expected:
                self.assertEqual({data for _, data in frames}, {expected[identifier]}, f"{identifier:03X}")
        compass = [name for _, name, _ in self.board.frames if 0x605 <= name <= 0x607]
        self.assertEqual(compass[:30], [0x605, 0x606, 0x607] * 10, "a sample's frames stay together, in order")

    def test_a_request_that_cannot_be_met_is_refused_and_harms_no_stream(self):
        self.settle()
        self.board.publish(ACCEL, 50)
        self.board.wait(lambda: len(self.board.of(0x609)) >= 3, 5, "the accelerometer")
        asked = time.monotonic()
        self.board.send(0x008, struct.pack("<BHB", 1, 300, 2))  # the gyroscope every 300 us, urgent
        self.board.wait(lambda: self.board.of(0x71D, asked), 5, "the refusal")
        topic, reason = self.board.of(0x71D, asked)[0][1][:2]
        self.assertEqual((topic, reason), (GYRO, 15))  # not_schedulable
        self.board.wait(lambda: len(self.board.of(0x609, asked)) >= 17, 10, "the accelerometer goes on")
        self.assertEqual(self.board.of(0x408, asked), [])
        self.board.publish(GYRO, 20)
        self.board.wait(lambda: len(self.board.of(0x608, asked)) >= 3, 5, "a request that can be met")

    def test_reprioritised_while_running(self):
        self.settle()
        self.board.publish(GYRO, 20, priority=3)
        self.board.wait(lambda: len(self.board.of(0x708)) >= 3, 5, "frames at low")
        changed = self.board.publish(GYRO, 20, priority=0)
        self.board.wait(lambda: len(self.board.of(0x408)) >= 3, 5, "frames at urgent")
        self.assertEqual([at for at, _ in self.board.of(0x708) if at > changed + 0.1], [])

    def test_absent_part_hurts_nobody_and_comes_back(self):
        self.settle()
        self.parts.spi[1].present = False
        time.sleep(0.1)
        asked = self.board.publish(GYRO, 50)
        self.board.publish(ACCEL, 50)
        self.board.wait(lambda: len(self.board.of(0x609, asked)) >= 17, 10, "the accelerometer goes on")
        self.assertEqual(self.board.of(0x608, asked + 0.1), [])
        self.parts.spi[1] = MotionSensor(0xD3, (7, 8, 9))
        self.board.wait(lambda: any(data == struct.pack("<3h", 7, 8, 9) for _, data in self.board.of(0x608)), 5,
                        "the part that came back")
        back = time.monotonic()
        self.board.wait(lambda: len(self.board.of(0x609, back)) >= 8, 5, "the accelerometer goes on")

    def test_host_that_does_not_answer(self):
        self.settle()
        self.board.publish(ACCEL, 50)
        self.board.wait(lambda: self.board.of(0x609), 5, "the accelerometer")
        self.parts.silent = True
        time.sleep(1.5)
        self.assertEqual(self.board.of(0x609, time.monotonic() - 0.5), [])
        self.assertEqual(self.board.ask("V"), "V1010", "the board is dead")
        self.parts.silent = False
        back = time.monotonic()
        self.board.wait(lambda: self.board.of(0x609, back), 5, "the accelerometer after the host's silence")

    def moving(self):
        return self.parts.duties and self.parts.duties[-1][1:] != (0, 0)

    def test_motors_stop_at_the_watchdog(self):
        for _ in range(12):  # kept alive: far beyond the watchdog's 500 ms
            last = self.board.send(0x201, motors(100_000))
            time.sleep(0.1)
        self.assertTrue(self.moving())
        left, right = self.parts.duties[-1][1:]
        self.assertGreater(left, 0)
        self.assertGreater(right, 0)
        self.board.wait(lambda: not self.moving(), 3, "standstill")
        stopped = next(at for at, *duty in reversed(self.parts.duties) if duty != [0, 0])
        self.assertGreater(stopped - last, 0.4, "the watchdog is 500 ms")
        self.assertLess(stopped - last, 0.7, "the watchdog is 500 ms")

    def test_motors_stop_when_the_bus_is_lost(self):
        self.board.send(0x201, motors(0, 1_000_000))
        self.board.wait(self.moving, 3, "movement")
        left, right = self.parts.duties[-1][1:]
        self.assertLess(left, 0)
        self.assertGreater(right, 0)
        self.assertEqual(self.board.ask("C"), "")
        closed = time.monotonic()
        self.board.wait(lambda: not self.moving(), 3, "standstill")
        self.assertLess(time.monotonic() - closed, 0.3, "not only when the watchdog is over")

    def test_adapter_closes_and_opens(self):
        self.settle()
        self.board.publish(GYRO, 20)
        self.board.wait(lambda: len(self.board.of(0x608)) > 5, 5, "frames")
        self.assertEqual(self.board.ask("C"), "")
        time.sleep(0.1)
        heard = len(self.board.frames)
        time.sleep(0.3)
        self.assertEqual(len(self.board.frames), heard, "frames from a closed channel")
        self.assertEqual(self.board.ask("t2088"), "\a", "a frame into a closed channel")
        self.assertEqual(self.board.ask("S6"), "")
        self.assertEqual(self.board.ask("O"), "")
        opened = time.monotonic()
        self.board.wait(lambda: len(self.board.of(0x608, opened)) > 5, 5, "frames after opening")

    def test_noise_on_the_line(self):
        self.settle()
        for noise in ("t20", "x" * 200, "t208Z", "T1", "\x01\x02\xff".encode("latin-1").decode("latin-1")[:2]):
            self.assertEqual(self.board.ask(noise), "\a", repr(noise))
        self.board.publish(GYRO, 20)
        self.board.wait(lambda: len(self.board.of(0x608)) > 5, 5, "frames after noise")

    def test_stacks_have_room(self):
        """Fill patterns, read out of the machine's memory after all paths were taken."""
        self.settle()
        for level, topic in enumerate((GYRO, ACCEL, MAG, ODOMETRY)):
            self.board.publish(topic, 20, level)
        self.board.publish(0x04, 100, 0)
        for _ in range(10):
            self.board.send(0x201, motors(50_000))
            self.board.ask("t20")
            time.sleep(0.1)
        free = self.board.untouched("::runtime", ("receiver", "urgent", "high", "medium"))
        print("untouched bytes of stack:", free)
        self.assertGreaterEqual(min(free.values()), 96, free)


class LightRing(harness.Case):
    class Lights:
        def __init__(self):
            self.shown = []

        def transfer(self, mode, clock, out):
            assert mode == 0 and clock <= 30_000_000
            self.shown.append(bytes(out))
            return bytes(len(out))

    def test_colours(self):
        parts = Parts()
        lights = parts.spi[1] = self.Lights()
        board = self.boot("light_ring", parts)
        board.wait(lambda: parts.outputs and parts.outputs[-1][1] == 0, 5, "the outputs switched on")
        self.assertEqual(lights.shown[0], bytes(36), "dark before the outputs are on")
        board.send(0x23C, bytes([255, 128, 0]))  # the first light: red, green, blue
        board.wait(lambda: any(lights.shown[-1]), 3, "light")
        # Shifted in first: output 23 blue, 22 green, 21 red, 12 bits each.
        self.assertEqual(lights.shown[-1][:5].hex(), "000808fff0")
        self.assertEqual(lights.shown[-1][5:], bytes(31))


class PowerManagement(harness.Case):
    def test_battery_and_absent_ring(self):
        parts = Parts()
        for bus, power, charge in ((1, -1000, 70), (2, -500, 81)):
            registers = dict(enumerate(struct.pack("<H", 0x0008), 0x0A))
            registers |= dict(enumerate(struct.pack("<2H", 100, 65535), 0x16))
            registers |= dict(enumerate(struct.pack("<h", power), 0x24))
            registers |= dict(enumerate(struct.pack("<H", charge), 0x2C))
            parts.i2c[bus, 0x55] = FuelGauge(registers)
        parts.inputs = 1
        board = self.boot("power_management", parts)
        board.publish(0x1F, 100, 0)  # the ring: eight sensors that are not there
        asked = board.publish(0x1E, 1000)
        board.wait(lambda: len(board.of(0x61E)) >= 3, 10, "three battery reports")
        frames = board.of(0x61E)
        self.assertEqual({data for _, data in frames}, {struct.pack("<BBHh", 1, 75, 100, -1500)})
        self.assertAlmostEqual((frames[2][0] - frames[0][0]) / 2, 1.0, delta=0.05)
        self.assertLess(frames[0][0] - asked, 1.5)
        self.assertEqual([frame for frame in board.frames if frame[1] != 0x61E], [])


if __name__ == "__main__":
    harness.main()
