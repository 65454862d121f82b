"""amiroctl calibrate: a mapper's compass, on a central that is played on a pseudo terminal, and on the simulated robots."""

import os
import signal
import time

from harness import Case, main, waiting
from played_central import Central, Owner, Robot, row

GOOD = "AVR: good: within 1 deg; field of the robot x 41 mG, y -57 mG, of the earth 152 mG; stored\n"


class Played(Case):
    def setUp(self):
        super().setUp()
        self.avr = Robot("AVR")
        self.central = Central(self.folder, [self.avr], link="ocm/central")
        self.addCleanup(self.central.close)

    def calibrate(self, *options, code=0):
        return self.run_tool("calibrate", "AVR", *options, "--scan", "200ms", code=code)

    def test_turns_around_once_and_says_how_good_it_is(self):
        self.assertEqual(self.calibrate(), (GOOD, ""))
        words = [line for line in self.avr.heard if line.startswith("{C,")]
        self.assertEqual(words[:2], ["{C,0}", "{C,1}"])
        self.assertEqual(set(words[2:]) - {"{C,1}"}, set())
        # Another one is another number.
        self.assertEqual(self.calibrate()[0], GOOD)
        self.assertEqual(self.avr.calibration, 2)
        # And how good it was can be asked without a turn.
        heard = len(self.avr.heard)
        self.assertEqual(self.calibrate("--show"), (GOOD, ""))
        self.assertEqual(self.avr.calibration, 2)
        self.assertNotIn("{C,3}", self.avr.heard[heard:])
        self.assertNotIn("{U,0,0}", self.avr.heard)  # what has come to its end is not stopped

    def test_what_was_not_heard_is_said_again(self):
        self.avr.loses = 3
        self.assertEqual(self.calibrate(), (GOOD, ""))
        self.assertEqual(self.avr.calibration, 1)
        self.assertEqual(self.avr.loses, 0)

    def test_it_is_asked_until_it_has_stored_it(self):
        self.avr.finds = [(2, 41, -57, 152, 1, 1), (2, 41, -57, 152, 1, 2)]
        self.assertEqual(self.calibrate(), (GOOD, ""))

    def test_one_that_cannot_store_it(self):
        self.avr.finds = [(2, 41, -57, 152, 1, 1)]
        out, err = self.calibrate(code=1)
        self.assertEqual(out, GOOD.replace("stored", "not stored"))
        self.assertEqual(err, "calibrate: AVR has not stored it: it is lost when the robot is switched off\n"
                              "check the robot's memory, and calibrate it again\n")

    def test_each_end_that_is_not_good(self):
        elsewhere = "calibrate it in another place, away from steel, motors and cables with current"
        for finds, said, remedy in (
                ((3, 41, -57, 152, 6, 2), "AVR may be wrong by 6 deg; a robot that has a good calibration keeps that", elsewhere),
                ((4, 0, 0, 0, 0, 0), "AVR was stopped before it had turned around; its compass corrects nothing", "calibrate it again"),
                ((5, 0, 0, 0, 0, 0), "AVR has not seen itself turn around; its compass corrects nothing",
                 "is it free to turn, and does its gyroscope answer?"),
                ((6, 41, -57, 152, 30, 2), "the field changed while AVR turned: its compass would be wrong by 30 deg; it keeps "
                 "the calibration that it had", elsewhere),
                ((7, 0, 0, 20, 0, 0), "the field around AVR is too weak, 20 mG; its compass corrects nothing", elsewhere),
                ((8, 0, 0, 0, 0, 0), "the compass of AVR does not answer; its compass corrects nothing", "check the part and its cable")):
            self.avr.finds = [finds]
            self.avr.turn_s = 0.2
            out, err = self.calibrate(code=1)
            self.assertEqual(out, "" if finds[0] != 3 else
                             "AVR: poor: within 6 deg; field of the robot x 41 mG, y -57 mG, of the earth 152 mG; stored\n")
            self.assertEqual(err, f"calibrate: {said}\n{remedy}\n")

    def test_never_calibrated(self):
        out, err = self.calibrate("--show", code=1)
        self.assertEqual((out, err), ("", "calibrate: AVR was never calibrated\ndrop --show: it turns around once\n"))
        self.assertEqual(self.avr.calibration, 0)

    def test_one_that_turns_for_another_program_goes_on(self):
        self.avr.calibration, self.avr.turning_until = 3, time.monotonic() + 1000
        self.assertEqual(self.calibrate("--show", code=1), ("", "calibrate: AVR turns around now, for another program\n"
                                                                "ask again in a minute\n"))
        self.assertIsNotNone(self.avr.turning_until)
        self.assertNotIn("{U,0,0}", self.avr.heard)

    def test_a_robot_whose_program_does_not_know_the_sentence(self):
        self.avr.knows_compass = False
        began = time.monotonic()
        out, err = self.calibrate(code=1)
        self.assertEqual(out, "")
        self.assertRegex(err, r"AVR does not say how its compass is \(asked 1\d times\)")
        self.assertIn("too old", err)
        self.assertLess(time.monotonic() - began, 40)

    def test_a_paused_robot_is_paused_again(self):
        self.run_tool("pause", "AVR", "--scan", "200ms")
        self.assertEqual(self.calibrate(), (GOOD, ""))
        self.assertTrue(self.avr.paused)
        # It is asked behind each pause what it does, so that no more are said than it needs.
        self.assertNotIn(("{S,PAU}", "{S,PAU}"), list(zip(self.avr.heard, self.avr.heard[1:])))

    def test_a_paused_robot_is_paused_again_however_it_ends(self):
        self.run_tool("pause", "AVR", "--scan", "200ms")
        self.avr.turn_s = 1000
        self.calibrate("--timeout", "1s", code=1)
        waiting.until(lambda: self.avr.paused, "it is paused again behind the time-out")
        tool = self.start("calibrate", "AVR", "--scan", "200ms")
        waiting.until(lambda: self.avr.turning_until is not None, "the turn")
        self.assertFalse(self.avr.paused)
        self.interrupt(tool)
        waiting.until(lambda: self.avr.paused, "it is paused again behind Ctrl-C")

    def test_one_that_does_not_come_to_an_end_is_stopped(self):
        self.avr.turn_s = 1000
        began = time.monotonic()
        out, err = self.calibrate("--timeout", "2s", code=1)
        self.assertLess(time.monotonic() - began, 10)  # in which one that does not answer is asked
        self.assertEqual(err, "amiroctl: calibrate: AVR has not said how it ended after 2s; it was stopped\n"
                              "          give it more time: --timeout 180s\n")
        self.assertEqual((out, self.avr.turning_until), ("", None))
        self.assertIn("{U,0,0}", self.avr.heard)

    def test_interrupted_it_stops_the_robot(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            self.avr.turn_s = 1000
            tool = self.start("calibrate", "AVR", "--scan", "200ms")
            waiting.until(lambda: self.avr.turning_until is not None, "the turn")
            tool.send_signal(number)
            tool.communicate(timeout=60)
            self.assertEqual(tool.returncode, 128 + number)
            self.assertIsNone(self.avr.turning_until)

    def test_the_link_is_lost_on_the_way(self):
        self.avr.turn_s = 1000
        tool = self.start("calibrate", "AVR", "--scan", "200ms")
        waiting.until(lambda: self.avr.turning_until is not None, "the turn")
        self.avr.turning_until = None
        self.central.drop(self.avr)
        _, err = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 1)
        self.assertIn("AVR is lost: its link is gone", err)


    def test_one_that_falls_silent_is_not_asked_for_longer_than_its_deadline(self):
        self.avr.knows_compass = False
        self.avr.deadline_ms = 250
        tool = self.start("calibrate", "AVR", "--show", "--scan", "200ms")
        waiting.until(lambda: "{C,0}" in self.avr.heard, "the question")
        self.avr.silent = True
        _, err = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 1)
        self.assertIn("AVR is lost: it has said nothing for its deadline; it does not turn", err)
        self.assertLess(self.avr.heard.count("{C,0}"), 6)  # one each 700 ms; of a robot that speaks, for 10 s


class OnALineOfAnotherProgram(Case):
    """That program is played, and what it says of the robot. An update comes each time that it is asked: the robot is not paused."""

    def setUp(self):
        super().setUp()
        central = Central(self.folder, [], link="ocm/central")
        self.addCleanup(central.close)
        self.owner = Owner(os.path.join(self.folder, "ocm"), central.path)
        self.addCleanup(self.owner.close)

    def says(self, **begun):
        """What it says of the robot, with `begun` behind the order."""
        self.owner.robot = lambda heard: row(updated=len(heard), **(begun if "calibrate 0" in heard else {}))

    def orders(self):
        return [request for request in self.owner.heard if request.split()[0] in ("go", "stop", "pause", "unpause", "calibrate")]

    def failed(self):
        out, err = self.run_tool("calibrate", "AVR", code=1)
        self.assertEqual(out, "")
        self.assertEqual(self.orders(), ["calibrate 0"])
        return err

    def test_one_that_may_not_be_calibrated_now_is_left_as_it_is(self):
        self.says()
        self.owner.ordered = b"no\nAVR is driven by goto (process 7)\nwait until that is over"
        self.assertEqual(self.failed(), "amiroctl: calibrate: AVR is driven by goto (process 7)\n          wait until that is over\n")

    def test_one_that_another_program_sends_meanwhile_is_left_to_it(self):
        for compass in ("none", "turning"):
            with self.subTest(compass=compass):
                self.owner.heard.clear()
                self.says(compass=compass, order=2, by="goto (process 7)")
                self.assertEqual(self.failed(), "amiroctl: calibrate: another program has stopped AVR or sent it: goto (process 7)\n"
                                                 "          calibrate it again once that is over\n")

    def test_one_whose_link_was_gone_for_a_while(self):
        self.says(compass="none", order=1)
        self.assertEqual(self.failed(), "amiroctl: calibrate: the link to AVR was gone for a while; a robot without a link stops\n"
                                         "          say it again\n")


class OnSimulatedRobots(Case):
    def sim(self, *arguments):
        sim = self.start("sim", *arguments)
        for line in sim.stderr:
            if "Ctrl-C ends it" in line:
                return
        self.fail(f"the simulator ended with {sim.wait()}")

    def calibrate(self, *arguments, code=0):
        """On a busy machine a robot that lives ten times as fast loses its link now and then; the tool says it, and to say it again."""
        for _ in range(10):
            tool = self.start("calibrate", "AVR", *arguments)
            out, err = tool.communicate(timeout=60)
            if "was gone for a while" not in err:
                break
        self.assertEqual(tool.returncode, code, err)
        return out, err

    def test_uncalibrated_calibrates_and_keeps_it(self):
        self.sim("--robots", "1", "--speed", "10", "--uncalibrated")
        _, err = self.calibrate("--show", code=1)
        self.assertIn("AVR was never calibrated", err)
        out, _ = self.calibrate()
        self.assertRegex(out, r"^AVR: good: within [0-3] deg; field of the robot x -?\d+ mG, y -?\d+ mG, of the earth 1\d\d mG; "
                              r"stored\n$")
        self.assertEqual(self.calibrate("--show")[0], out)

    def test_robots_are_calibrated_unless_it_is_said(self):
        self.sim("--robots", "1", "--speed", "10")
        self.assertRegex(self.calibrate("--show")[0], "^AVR: good: within 0 deg; .* stored\n$")


if __name__ == "__main__":
    main()
