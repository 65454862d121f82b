"""What a board refuses ends the verb that asked for it with 1, the reason and what would be accepted."""

import time

from harness import Case, main
from played_adapter import BAD_LENGTH, BAD_PERIOD, LIGHT_RING, NOT_SCHEDULABLE, NOT_SERVED, POWER_MANAGEMENT, WithAdapter, refusal

FORWARDS, REST = "201#50C3000000000000", "201#0000000000000000"
SAMPLE = "t60860300FFFF00000010\r"  # of the gyroscope


class OnARobotThatRefuses(WithAdapter, Case):
    """A robot behind a played adapter, which refuses as its file says."""

    def robot(self, script):
        self.played = self.adapter(script=script)
        return ("--bus", f"slcan:{self.played.path}")

    def test_each_verb_says_what_is_refused_and_why(self):
        bus = self.robot({"208#02": [refusal(0x08, NOT_SERVED)],
                          "208#00": [refusal(0x08, NOT_SERVED)],
                          "208#01F40100": [refusal(0x08, NOT_SCHEDULABLE)],
                          "23E#FF0000": [refusal(0x3E, BAD_LENGTH, LIGHT_RING)],
                          REST: [refusal(0x01, BAD_LENGTH)],
                          FORWARDS: [refusal(0x01, BAD_LENGTH)]})
        no_length = r"bad_length \(the board expects another number of bytes\)\n.*`amiroctl info "
        for verb, what in (
                (("once", "gyro"), r"once: di_wheel_drive refuses gyroscope: not_served \(nothing on the board serves "
                                   r"it\)\n +di_wheel_drive accepts what its firmware serves"),
                (("once", "gyro", "--wait"), "once: di_wheel_drive refuses gyroscope: not_served"),
                (("publish", "gyro", "500ms"), r"publish: di_wheel_drive refuses gyroscope: not_schedulable "
                                               r"\(.*\)\n.*longer period"),
                (("publish", "gyro", "500ms", "--wait"), "publish: di_wheel_drive refuses gyroscope: not_schedulable"),
                (("stop", "gyro"), "stop: di_wheel_drive refuses gyroscope: not_served"),
                (("led", "3", "red"), "led: light_ring refuses led_3: " + no_length + "led_3`"),
                (("set", "led_3", "red=255"), "set: light_ring refuses led_3: bad_length"),
                (("set", "motors", "x=5cm/s"), "set: di_wheel_drive refuses motors: bad_length"),
                (("drive", "5cm/s", "--once"), "drive: di_wheel_drive refuses motors: bad_length"),
                (("drive", "stop"), "drive: di_wheel_drive refuses motors: bad_length"),
                (("drive", "5cm/s"), "drive: di_wheel_drive refuses motors: " + no_length + "motors`")):
            out, err = self.run_tool(*bus, *verb, code=1, timeout=60)
            self.assertRegex(err, "amiroctl: " + what, verb)
            self.assertEqual(out, "")
            if "--wait" in verb:
                continue  # there is no sample to wait for
            self.run_tool(*bus, *verb, *(("--for", "1ms") if verb == ("drive", "5cm/s") else ()), "--no-confirm")

    def test_a_wait_ends_at_the_refusal(self):
        bus = self.robot({"208#02": [refusal(0x08, NOT_SERVED)]})
        begin = time.monotonic()
        self.run_tool(*bus, "once", "gyro", "--wait", "20s", code=1)
        self.assertLess(time.monotonic() - begin, 10)

    def test_a_board_that_says_nothing_has_not_heard_it(self):
        bus = self.robot({})
        for verb in (("once", "gyro"), ("publish", "gyro", "500ms"), ("publish", "gyro", "500ms", "--wait", "10ms")):
            out, err = self.run_tool(*bus, *verb, code=1)
            self.assertEqual(out, "")
            self.assertIn(f"amiroctl: {verb[0]}: no gyroscope within {'10ms' if '--wait' in verb else '2s'}\n"
                          "          is board di_wheel_drive powered and on ", err)
        self.run_tool(*bus, "once", "gyro", "--no-confirm")
        bus = self.robot({"208#02": [SAMPLE]})
        self.assertEqual(self.run_tool(*bus, "once", "gyro", "--no-confirm")[0], "")
        for words in ((), ("--wait",), ("--no-confirm", "--wait", "2s")):
            self.assertIn("gyroscope", self.run_tool(*bus, "once", "gyro", *words)[0])

    def test_each_board_that_is_spoken_to_is_listened_to(self):
        bus = self.robot({REST: [refusal(0x01, BAD_LENGTH)], "21F#00": [refusal(0x1F, BAD_PERIOD, POWER_MANAGEMENT)],
                          "204#00": [refusal(0x04, NOT_SERVED, count=2)]})
        _, err = self.run_tool(*bus, "stop", code=1)
        self.assertIn("stop: di_wheel_drive refuses motors: bad_length", err)
        self.assertIn("stop: power_management refuses proximity_ring: bad_period", err)
        # A sensor that nothing serves is silent, as it should be.
        self.assertNotIn("floor_proximity", err)
        # Only what was sent: of eight lights of one board one is refused.
        bus = self.robot({"243#FF0000": [refusal(0x43, NOT_SERVED, LIGHT_RING)]})
        _, err = self.run_tool(*bus, "led", "all", "red", code=1)
        self.assertEqual(err.count("refuses"), 1)
        self.assertIn("led: light_ring refuses led_8: not_served", err)

    def test_stop_of_a_robot_without_some_of_its_sensors_is_no_failure(self):
        bus = self.robot({"204#00": [refusal(0x04, NOT_SERVED)]})
        self.run_tool(*bus, "stop")

    def test_what_others_are_refused_is_not_told(self):
        bus = self.robot({"208#02": [refusal(0x05, NOT_SCHEDULABLE), refusal(0x08, NOT_SERVED, POWER_MANAGEMENT), SAMPLE]})
        _, err = self.run_tool(*bus, "once", "gyro")
        self.assertNotIn("refuses", err)

    def test_a_drive_that_is_refused_ends_and_leaves_rest_behind(self):
        bus = self.robot({FORWARDS: [refusal(0x01, BAD_LENGTH)]})
        _, err = self.run_tool(*bus, "drive", "5cm/s", "--for", "60s", code=1, timeout=50)
        self.assertEqual(err.count("refuses"), 1)
        self.assertEqual(self.played.frames[-1], REST)
        self.assertLess(len(self.played.frames), 20)

    def test_a_script_goes_on_and_ends_with_1(self):
        path = self.script("0s publish mag 900us\n300ms led 1 red\n")
        bus = self.robot({"205#01840302": [refusal(0x05, NOT_SCHEDULABLE)]})
        _, err = self.run_tool(*bus, "run", path, code=1)
        self.assertIn("run: di_wheel_drive refuses magnetometer: not_schedulable", err)
        self.assertLess(err.index("refuses"), err.index("led 1 red"))  # at once, not at the end
        self.assertEqual(self.played.frames, ["205#01840302", "23C#FF0000", "357#02"])  # and whether the lights' board is there
        self.run_tool(*bus, "run", path, "--no-confirm")
        # Also of the last step, after which there is nothing else to wait for.
        bus = self.robot({"23C#FF0000": [refusal(0x3C, BAD_LENGTH, LIGHT_RING)]})
        _, err = self.run_tool(*bus, "run", path, code=1)
        self.assertIn("run: light_ring refuses led_1: bad_length", err)

    def test_a_script_asks_once_what_the_boards_do_by_themselves(self):
        """While it listens before its first step, or 100 ms before its drive."""
        for late in ("0s", "105ms", "120ms", "600ms"):
            bus = self.robot({})
            self.run_tool(*bus, "run", self.script(f"{late} drive 5cm/s --for 100ms\n{late} led 1 red\n"), "--no-confirm")
            self.assertEqual(self.played.frames.count("20D#02"), 1, (late, self.played.frames))
            self.assertEqual(self.played.frames[-1], REST)

    def test_a_step_of_the_moment_in_which_a_script_asks_goes_first(self):
        bus = self.robot({})
        self.run_tool(*bus, "run", self.script("0s led 1 red\n500ms led 2 red\n600ms drive 5cm/s --for 100ms\n"), "--no-confirm")
        self.assertEqual(self.played.frames[:4], ["23C#FF0000", "23D#FF0000", "20D#02", FORWARDS])

    def test_a_script_whose_drive_is_refused_ends(self):
        bus = self.robot({FORWARDS: [refusal(0x01, BAD_LENGTH)]})
        _, err = self.run_tool(*bus, "run", self.script("0s drive 5cm/s\n60s led 1 red\n"), code=1, timeout=50)
        self.assertIn("run: di_wheel_drive refuses motors: bad_length", err)
        self.assertEqual(self.played.frames[-1], REST)


class OnTheSimulatedRobot(Case):
    def test_what_one_board_cannot_carry(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "500ms")
        self.run_tool("publish", "accel", "500ms")
        for more in ((), ("--wait",)):
            _, err = self.run_tool("publish", "mag", "900us", *more, code=1)
            self.assertIn("amiroctl: publish: di_wheel_drive refuses magnetometer: not_schedulable (", err)
        self.run_tool("publish", "mag", "900us", "--no-confirm")
        out, _ = self.run_tool("doctor", "--listen", "100ms")
        self.assertIn("3 requests refused so far, the last for magnetometer: not_schedulable\n"
                      "         `amiroctl publish magnetometer --dry-run --explain --listen 2s` shows what runs", out)

    def test_a_sample_of_the_stream_that_ran_before_does_not_hide_it(self):
        self.start_sim()
        self.run_tool("publish", "ring", "5ms")
        _, err = self.run_tool("publish", "ring", "1ms", "--priority", "urgent", "--force", "--wait", code=1)
        self.assertIn("power_management refuses proximity_ring: not_schedulable", err)

    def test_what_is_accepted_is_no_failure(self):
        self.start_sim()
        for verb in (("publish", "gyro", "500ms"), ("publish", "gyro", "500ms", "--wait"), ("once", "gyro"),
                     ("once", "gyro", "--wait"), ("stop", "gyro"), ("led", "all", "red"), ("set", "led_3", "red=1"),
                     ("drive", "1cm/s", "--for", "200ms"), ("drive", "1cm/s", "--once"), ("drive", "stop"), ("stop",)):
            _, err = self.run_tool(*verb)
            self.assertNotIn("refuses", err, verb)

    def test_an_old_refusal_that_is_published_again_is_no_news(self):
        self.start_sim()
        self.run_tool("send", "208#01000000")  # a period of zero
        self.run_tool("publish", "di_wheel_drive_refusal", "20ms")
        self.run_tool("publish", "gyro", "500ms")

    def test_it_listens_for_a_tenth_of_a_second_or_until_the_sample(self):
        self.start_sim()

        def seconds(*arguments):
            begin = time.monotonic()
            self.run_tool(*arguments)
            return time.monotonic() - begin
        self.assertGreater(seconds("led", "1", "red"), 0.1)
        # The shortest of several, of more on a busy machine, so that this counts on neither side.
        waited, silent = [], []
        while len(waited) < 6 or (min(waited) + 0.04 > min(silent) and len(waited) < 40):
            waited.append(seconds("once", "gyro"))
            silent.append(seconds("led", "1", "red"))
        self.assertLess(min(waited) + 0.04, min(silent))


if __name__ == "__main__":
    main()
