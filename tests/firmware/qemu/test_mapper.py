"""The mapper's image in QEMU: handshakes, set points driven in a played world, pause, ping, packed updates, a lost
link, parts that are away, damaged lines, stacks and idle time; and one whose stack is too small."""
# Sleeps: emulated boards run in real time, and drive, publish or are silent for so long.

import math
import os
import random
import time

import harness
from mapper import CHIPS, GREEN, YELLOW, Robot, World


class Case(harness.Case):
    chip = "qemu_m3"

    def start(self, world=None, **options):
        self.world = world or World()
        robot = Robot(self.world, **{"chip": self.chip, **options})
        if "name" not in options:
            self.addCleanup(robot.end)
        return robot


class Life(Case):
    def test_advertises_says_who_it_is_and_is_confirmed(self):
        robot = self.start()
        began = time.monotonic()
        time.sleep(5)
        self.assertEqual(robot.said, [], "nothing is said before there is a link")
        self.assertTrue(self.world.standing())
        on = [at for at, levels in self.world.lamps(began) if levels == GREEN]
        self.assertEqual({levels for _, levels in self.world.lamps(began)}, {0, GREEN})
        self.assertIn(len(on), (2, 3), "green blinks every 2 s")
        self.assertAlmostEqual(on[1] - on[0], 2, delta=0.25)

        connected = robot.connect()
        robot.wait(lambda: len(robot.of("{H,")) >= 4, 10, "four handshakes")
        times = [at for at, _ in robot.of("{H,")]
        self.assertLess(times[0] - connected, 0.3)
        self.assertAlmostEqual((times[3] - times[0]) / 3, 1, delta=0.1)
        self.assertEqual({line for _, line in robot.said}, {"{H,20,20,1,3,0,90,180,270,5000,20225,3}"})
        lamps = self.world.lamps(connected + 0.3)
        self.assertEqual({levels for _, levels in lamps}, {GREEN, GREEN | YELLOW}, "yellow at each handshake")

        confirmed = robot.tell("{S,CON}")
        robot.wait(lambda: len(robot.updates(confirmed)) >= 11, 10, "eleven updates")
        self.assertLessEqual(len(robot.of("{H,", confirmed + 0.1)), 0)
        times = [at for at, _ in robot.updates(confirmed)]
        self.assertAlmostEqual((times[10] - times[0]) / 10, 0.2, delta=0.03)
        self.assertEqual({tuple(numbers[:3]) for _, numbers in robot.updates(confirmed)}, {(0, 0, 0)})
        self.assertEqual({tuple(numbers[4:]) for _, numbers in robot.updates(confirmed)}, {(0, 0, 0, 0)})
        servo = [numbers[3] for _, numbers in robot.updates(confirmed)]
        self.assertEqual(servo[:5], [0, 2, 4, 6, 8], "small steps while it waits")
        widths = [counts for at, counts in self.world.pulses if at >= confirmed][:4]
        self.assertEqual(widths, [1026, 1051, 1077, 1102], "1000 + 1150 / 90 a degree")

    def test_drives_where_it_is_told_and_says_idle(self):
        robot = self.start()
        robot.confirm()
        told = robot.tell("{U,90,30}")
        robot.wait(lambda: not self.world.standing(), 2, "movement")
        self.assertLess(self.world.duties[-1][1], 0, "left wheel back, right wheel ahead: to the left")
        self.assertGreater(self.world.duties[-1][2], 0)
        robot.wait(lambda: self.world.standing() and robot.of("{S,IDL}", told + 1), 40, "the set point")
        time.sleep(0.5)
        world = self.world
        world.advance()
        self.assertAlmostEqual(math.degrees(world.heading), 90, delta=6)
        self.assertAlmostEqual(math.hypot(world.x, world.y), 0.30, delta=0.03)
        self.assertAlmostEqual(world.y, 0.30, delta=0.04)
        x, y, heading = robot.updates()[-1][1][:3]
        self.assertAlmostEqual(x / 100, world.x, delta=0.02)
        self.assertAlmostEqual(y / 100, world.y, delta=0.02)
        self.assertAlmostEqual(heading, math.degrees(world.heading), delta=3)
        # Idle: on arrival, then each second.
        times = [at for at, _ in robot.of("{S,IDL}", told + 1)]
        robot.wait(lambda: len(robot.of("{S,IDL}", told + 1)) >= 4, 10, "idle, again and again")
        times = [at for at, _ in robot.of("{S,IDL}", told + 1)]
        self.assertAlmostEqual((times[3] - times[1]) / 2, 1, delta=0.15)

        # And back to a stop on the way.
        told = robot.tell("{U,0,100}")
        robot.wait(lambda: not self.world.standing(), 2, "movement")
        time.sleep(1)
        stopped = robot.tell("{U,0,0}")
        robot.wait(lambda: self.world.standing(), 0.5, "standstill")
        robot.wait(lambda: robot.of("{S,IDL}", stopped), 2, "idle after a stop")

    def test_pause_ping_and_formats(self):
        robot = self.start()
        robot.confirm()
        for ping in ("{}", "{ }"):
            asked = robot.tell(ping)
            robot.wait(lambda asked=asked: robot.of("\t!", asked), 1, "an answer to the ping")
        paused = robot.tell("{S,PAU}")
        robot.wait(lambda: robot.of("{S,IDL}", paused), 1, "idle on pause")
        robot.wait(lambda: self.world.lamps()[-1][1] == GREEN | YELLOW, 1, "both lamps")
        time.sleep(0.1)
        held = len(self.world.pulses)
        time.sleep(1)
        self.assertEqual(robot.updates(paused + 0.25), [], "no updates while paused")
        self.assertEqual(len(self.world.pulses), held, "the tower holds")
        robot.tell("{U,30,0}")
        robot.wait(lambda: not self.world.standing(), 2, "control goes on while paused")
        unpaused = robot.tell("{S,UNP}")
        robot.wait(lambda: len(robot.updates(unpaused)) >= 3, 2, "updates again")

        packed = robot.tell("{S,BIN}")
        robot.wait(lambda: len(robot.packed(packed)) >= 4, 3, "packed updates")
        updates = [bits(line) for _, line in robot.packed(packed)[:4]]
        self.assertEqual([update >> 104 for update in updates], [0, 1, 2, 3], "numbered from 0")
        text = robot.tell("{S,TXT}")
        robot.wait(lambda: len(robot.updates(text)) >= 2, 2, "text again")

    def test_link_lost_while_driving(self):
        robot = self.start()
        robot.confirm()
        robot.tell("{U,0,200}")
        robot.wait(lambda: not self.world.standing(), 2, "movement")
        time.sleep(1)
        lost = robot.lose()
        robot.wait(self.world.standing, 0.5, "standstill")
        off = next(at for at, *duty in self.world.duties if at >= lost and duty == [0, 0])
        self.assertLess(off - lost, 0.1, "at once")
        time.sleep(0.1)
        quiet = time.monotonic()
        robot.tell("{U,0,50}")  # without a link
        time.sleep(1)
        self.assertEqual([line for at, line in robot.said if at >= quiet], [])
        self.assertTrue(self.world.standing())
        back = robot.connect()
        robot.wait(lambda: robot.of("{H,", back), 5, "the next link's handshake")
        first = next(line for at, line in robot.said if at >= back)
        self.assertTrue(first.startswith("{H,"), f"of the dead link: {first}")
        robot.tell("{S,CON}")
        robot.wait(lambda: robot.updates(back), 2, "updates")
        self.assertEqual(robot.updates(back)[0][1][:3], [0, 0, 0], "a new operator's robot is at 0")
        time.sleep(0.5)
        self.assertTrue(self.world.standing(), "the dead link's set point is void")

    def test_stops_in_front_of_things(self):
        robot = self.start()
        robot.confirm()
        told = robot.tell("{U,0,200}")
        robot.wait(lambda: not self.world.standing(), 2, "movement")
        time.sleep(0.5)
        self.world.converter = {channel: 471 for channel in range(4)}  # 2.3 V: 10 cm, all around
        near = time.monotonic()
        robot.wait(self.world.standing, 3, "standstill")
        robot.wait(lambda: robot.of("{S,IDL}", near), 2, "idle")
        self.assertLess(time.monotonic() - told, 6)
        robot.wait(lambda: robot.updates(near + 0.3), 2, "an update")
        self.assertEqual(robot.updates(near + 0.3)[0][1][4:], [10, 10, 10, 10])


def bits(packed):
    """The 112 bits of a packed update: byte 0 is the tag, seven bits a byte follow. [docs/mapper-link.md]"""
    assert packed[0] == 0xB1 and all(byte & 0x80 for byte in packed)
    number = 0
    for byte in packed[1:17]:
        number = number << 7 | byte & 0x7F
    return number


class Compass(Case):
    """The robot's own field is a third of the earth's. Something turns it that neither wheels nor gyro see: only a compass
    that was calibrated brings the heading back."""

    GOOD, TURNING, STORED = 2, 1, 2

    def switch_on(self, world):
        robot = self.start(world)
        robot.confirm()
        self.zero = world.heading
        return robot

    def off(self, robot):
        """Degrees that its heading is too far to the left."""
        self.world.advance()
        off = robot.updates()[-1][1][2] - math.degrees(self.world.heading - self.zero)
        return (off + 180) % 360 - 180

    def turned_by_hand(self, robot):
        """By 5 degrees, where the compass is trusted: after a straight drive on which it did not change. How far off the
        heading is, before and 14 s later."""
        told = robot.tell("{U,0,12}")
        robot.wait(lambda: robot.of("{S,IDL}", told + 0.5), 30, "the end of a straight drive")
        time.sleep(8)
        before = self.off(robot)
        self.world.turn_by_hand(5)
        time.sleep(14)
        return before, self.off(robot)

    def ask(self, robot):
        asked = robot.tell("{C,0}")
        robot.wait(lambda: robot.compass(asked), 2, "how the compass is")
        return robot.compass(asked)[0][1]

    def corrects(self, since):
        return any(levels == GREEN | YELLOW for _, levels in self.world.lamps(since))

    def test_uncalibrated_calibrates_corrects_and_still_does_when_switched_on_again(self):
        world = World()
        world.compass.own = (0.05, -0.03)
        robot = self.switch_on(world)
        self.assertEqual(self.ask(robot), [0] * 7)
        begun = time.monotonic()
        before, uncalibrated = self.turned_by_hand(robot)
        self.assertFalse(self.corrects(begun), "a compass that was never calibrated does not correct")
        self.assertAlmostEqual(uncalibrated - before, -5, delta=1.5)

        told = robot.tell("{C,7}")
        robot.tell("{C,7}")  # a copy of the word changes nothing
        robot.wait(lambda: robot.of("{S,IDL}", told + 1), 30, "the end of the turn")
        robot.wait(lambda: robot.compass()[-1][1][1] == self.GOOD, 2, "the result")
        said = [numbers for _, numbers in robot.compass(told)]
        self.assertEqual({tuple(numbers[:2]) for numbers in said[:-1]}, {(7, self.TURNING)})
        number, verdict, x, y, field, error, _ = said[-1]
        self.assertEqual((number, verdict), (7, self.GOOD))
        for figure, truth in ((x, 50), (y, -30), (field, 150)):
            self.assertAlmostEqual(figure, truth, delta=5)
        self.assertLessEqual(error, 3)
        robot.wait(lambda: self.ask(robot)[-1] == self.STORED, 3, "stored")

        robot.lose()
        time.sleep(3)  # it measures where its compass has its zero
        robot.connect()
        robot.wait(lambda: robot.of("{H,", time.monotonic() - 1), 10, "a handshake")
        self.zero = world.heading
        robot.tell("{S,CON}")
        begun = time.monotonic()
        _, calibrated = self.turned_by_hand(robot)
        print(f"heading off by {uncalibrated:.1f} deg without a calibration, by {calibrated:.1f} deg with one")
        self.assertLess(abs(calibrated), 2.5)
        self.assertTrue(self.corrects(begun))
        self.doCleanups()

        # Switched off and on again, with the same memory.
        again = World()
        again.compass.own = world.compass.own
        again.memory.bytes = world.memory.bytes
        robot = self.switch_on(again)
        answer = self.ask(robot)
        self.assertEqual(answer[:2] + answer[-1:], [0, self.GOOD, self.STORED])
        self.assertEqual(answer[2:5], [x, y, field])
        begun = time.monotonic()
        self.assertLess(abs(self.turned_by_hand(robot)[1]), 2.5)
        self.assertTrue(self.corrects(begun))


class Trouble(Case):
    def fault_and_recovery(self, take_away, put_back):
        world = World()
        take_away(world)
        robot = self.start(world)
        robot.connect()
        robot.wait(lambda: world.lamps()[-1][1] == YELLOW, 10, "yellow alone")
        time.sleep(1)
        self.assertEqual(world.lamps()[-1][1], YELLOW)
        self.assertEqual(robot.of("{H,"), [], "a robot that knows nothing does not say that it is there")
        self.assertTrue(world.standing())
        put_back(world)
        robot.wait(lambda: robot.of("{H,"), 15, "a handshake when the part is back")

    def test_gyroscope_missing_at_the_start(self):
        def present(world, is_there):
            world.gyroscope.present = is_there
        self.fault_and_recovery(lambda world: present(world, False), lambda world: present(world, True))

    def test_compass_missing_at_the_start(self):
        self.fault_and_recovery(lambda world: world.i2c.clear(), lambda world: world.i2c.update({(1, 0x1E): world.compass}))

    def test_parts_that_go_away_while_driving(self):
        robot = self.start()
        robot.confirm()
        told = robot.tell("{U,0,20}")
        time.sleep(0.5)
        self.world.gyroscope.present = False
        self.world.i2c.clear()
        robot.wait(lambda: robot.of("{S,IDL}", told + 0.6), 20, "the wheels alone bring it there")
        self.world.advance()
        self.assertAlmostEqual(self.world.x, 0.2, delta=0.03)
        self.assertAlmostEqual(self.world.y, 0, delta=0.02)

    def test_host_of_the_parts_does_not_answer(self):
        robot = self.start()
        robot.confirm()
        self.world.silent = True
        time.sleep(1.5)
        self.world.silent = False
        back = robot.tell("{}")
        robot.wait(lambda: robot.of("\t!", back), 3, "an answer to the ping")
        robot.wait(lambda: len(robot.updates(back)) >= 3, 3, "updates")

    def test_noise_and_floods(self):
        robot = self.start()
        robot.confirm()
        noise = random.Random(7)
        for _ in range(20):
            robot.tell(bytes(noise.randrange(256) for _ in range(500)))
            robot.tell(b"{U,9{S,PA{U,,}{U,1,2,3}{S,XXX}{U,00,1}{U,99999,1}" * 5)
        self.answers_again(robot)
        self.assertTrue(self.world.standing(), "noise moves nothing")
        # More commands than it takes, some of them damaged by that. It stays alive, and stops at the next whole word.
        for i in range(200):
            robot.tell(f"{{U,{i % 30 + 1},1}}")
        self.answers_again(robot)
        robot.tell("{U,0,0}")
        robot.wait(self.world.standing, 2, "standstill")

    def answers_again(self, robot):
        """What comes while its ring is full is lost to a robot, so it is asked until it answers."""
        asked, end = time.monotonic(), time.monotonic() + 15
        while not robot.of("\t!", asked):
            self.assertLess(time.monotonic(), end, robot.heard())
            robot.tell("\n{}")
            time.sleep(0.3)


class Resources(Case):
    def test_stacks_and_idle_time(self):
        """Fill patterns and the load meter, read out of the machine's memory after all paths were taken."""
        for chip in CHIPS:
            with self.subTest(chip=chip):
                robot = self.start(chip=chip)
                robot.confirm()
                robot.tell("{S,BIN}")
                for command in ("{U,45,3}", "{}", "{S,PAU}", "{S,UNP}", "{U,0,0}", "{U,-20,2}"):
                    robot.tell(command)
                    time.sleep(0.7)
                robot.tell("{U,0,0}")
                robot.tell("{C,1}")
                robot.wait(lambda: robot.compass() and robot.compass()[-1][1][1] > 1, 30, "the end of a calibration")
                time.sleep(0.5)  # it is stored
                robot.tell(b"{U,9{U,,}\x80\xb1" * 40)
                robot.lose()
                time.sleep(0.3)
                robot.connect()
                time.sleep(0.5)
                robot.tell("{S,CON}")
                robot.tell("{U,90,10}")
                time.sleep(2.5)
                free = robot.untouched("::levels", ("urgent", "high", "medium"))
                address, size = robot.symbols()["main::load"]
                load = robot.memory(address, size)[24]  # LoadMeter: a pointer and padding, two of 8 bytes, percent
                print(f"{chip}: untouched bytes of stack: {free}; load {load} %")
                self.assertGreaterEqual(min(free.values()), 96, free)
                # QEMU's time is the host's, so that a busy host makes a busy robot: only the impossible is wrong.
                self.assertGreater(load, 0)
                self.assertLess(load, 90)

    def test_stack_overflow(self):
        robot = self.start(name="mapper_overflow_test")
        time.sleep(0.5)
        robot.connect()
        said = robot.end(code=2)
        self.assertIn("stack overflow", said)
        self.assertTrue(self.world.standing())
        lamps = self.world.lamps()[-180:]
        self.assertEqual({levels for _, levels in lamps}, {0, GREEN | YELLOW}, "both, and dim")
        on = sum(after - at for (at, levels), (after, _) in zip(lamps, lamps[1:]) if levels)
        self.assertLess(on / (lamps[-1][0] - lamps[0][0]), 0.5)
        self.assertGreater(len(lamps), 100)


if __name__ == "__main__":
    assert os.environ["OCM_SOURCE_DIR"]
    harness.main()
