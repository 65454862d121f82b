"""publish asks the bus before it asks the board."""

import os
import re
import time

from harness import SOURCE, Case, main, waiting
from realtime import MOST_LATE

NOT_SCHEDULABLE = 15
SENSORS = "odometry floor_proximity magnetometer gyroscope accelerometer power_status proximity_ring".split()


class Admission(Case):
    # It listens for 100 ms, in which each stream of 50 ms is to be heard.
    most_late = MOST_LATE

    def everything_at(self, period):
        self.start_sim()
        for sensor in SENSORS:
            self.run_tool("publish", sensor, period)

    def heard_for(self, out, least, words=r"heard within (([\d.]+)(ms|s))$"):
        """How long it has listened, in its own words: at least so many milliseconds, and 100 more on a machine that holds nothing up."""
        text, number, unit = re.search(words, out, re.MULTILINE).groups()
        listened = float(number) * {"ms": 1, "s": 1000}[unit]
        self.assertGreaterEqual(listened, least)
        self.assertLess(listened, least + 100 + 1000 * self.spare.slack)
        return text

    def test_a_spec_that_is_of_one_interface(self):
        self.start_sim()
        spec = ("--spec", "sim=" + os.path.join(SOURCE, "spec/topics.json"))
        out, _ = self.run_tool(*spec, "once", "power", "--wait")
        self.assertIn('"topic":"power_status"', out)
        for period, priority in (("900us", "medium"), ("900us", "high"), ("50ms", "low")):  # the stream before does not count
            self.run_tool(*spec, "publish", "mag", period, "--priority", priority)

    def test_a_request_that_makes_somebody_late_is_refused_with_a_counter_offer(self):
        self.everything_at("50ms")
        ring = ("publish", "ring", "--priority", "urgent")
        out, err = self.run_tool(*ring, "1ms", code=1)
        self.assertEqual(out, "")
        # Six of the ring's eight frames and one of 8 bytes that is on its way take more than 1 ms.
        self.assertRegex(err, r"proximity_ring every 1ms at urgent does not fit on the bus: proximity_ring/sensor_6 "
                              r"would miss its deadline of 1ms by 1\d\dus")
        offer = re.search(r"the shortest period that passes beside what was heard within 100ms is 1\.(\d+)ms \(--listen hears more\)", err)
        offered = 1000 + int(offer[1].ljust(3, "0"))
        self.assertTrue(1300 <= offered <= 1470, err)
        # Nothing was sent: the ring still comes every 50 ms, and at medium.
        out, _ = self.run_tool("listen", "ring", "--raw", "--count", "12")
        self.assertNotRegex(out, " 4(1F|2[0-6])#")
        self.run_tool(*ring, f"{offered - 1}us", code=1)
        _, err = self.run_tool(*ring, "1500us")
        self.assertEqual(err.splitlines(), ["bus: sim (the only one there is; --bus chooses)",
                                            "publish: the part samples proximity_ring every 4ms: samples will be repeated"])

    def test_a_period_that_is_shorter_than_the_part_s_own(self):
        self.start_sim()
        _, err = self.run_tool("publish", "gyro", "1ms")
        self.assertIn("publish: the part samples gyroscope every 1.25ms: samples will be repeated\n", err)
        self.assertNotIn("the part", self.run_tool("publish", "gyro", "1250us")[1])
        _, err = self.run_tool("publish", "gyro", "100us", code=1)
        self.assertRegex(err, r"is \d+us \(--listen hears more\); the part samples every 1.25ms; --explain shows all, ")

    def test_the_offer_passes(self):
        self.everything_at("50ms")
        _, err = self.run_tool("publish", "mag", "500us", "--priority", "high", code=1)
        offer = re.search(r"the shortest period that passes beside what was heard within 100ms is (\S+) \(", err)[1]
        self.run_tool("publish", "mag", offer, "--priority", "high")

    def test_explain_shows_why_not(self):
        self.everything_at("50ms")
        out, _ = self.run_tool("publish", "ring", "1ms", "--priority", "urgent", "--explain", code=1)
        lines = out.splitlines()
        self.assertEqual(lines[0].split(), "ID MESSAGE PERIOD DEADLINE BITS RESPONSE SLACK VERDICT".split())
        self.assertEqual(len(lines), 1 + 17 + 2)
        # In time on the bus; but a board looks at a sample as a whole.
        self.assertIn("its board may refuse it, asked for", lines[1])
        self.assertRegex(lines[8], "^426 .*never gets through, asked for")
        self.assertEqual(lines[-2], "the shortest period that passes beside what was heard is 1.394ms")
        self.assertRegex(lines[-1], r"^load 1\d\d\.\d % of 500000 bit/s at worst; 17 identifiers heard within ")
        self.heard_for(out, 100)

    def test_force_sends_what_others_could_not_bear(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "1ms", "--priority", "low")
        ring = ("publish", "ring", "1500us", "--priority", "urgent")
        _, err = self.run_tool(*ring, code=1)
        self.assertIn("gyroscope, which runs already, would ", err)
        self.run_tool(*ring, "--force")
        out, _ = self.run_tool("listen", "ring", "--raw", "--count", "2")
        self.assertRegex(out, " 4(1F|2[0-6])#")

    def test_the_board_refuses_too_and_says_why(self):
        self.start_sim()
        self.run_tool("publish", "ring", "50ms")
        listener = self.listen("power_management_refusal", "--count", "1", "--timeout", "60s")
        self.run_tool("publish", "ring", "1ms", "--priority", "urgent", "--force", "--no-confirm")
        out, _ = listener.communicate(timeout=60)
        refusal = self.objects(out)[0]["fields"]
        self.assertEqual((refusal["topic"], refusal["reason"], refusal["refused"]), (0x1F, NOT_SCHEDULABLE, 1))
        # What ran goes on as it did.
        out, _ = self.run_tool("listen", "ring", "--raw", "--count", "16")
        self.assertNotRegex(out, " 4(1F|2[0-6])#")
        self.assertEqual(out.count(" 61F#"), 2)
        out, _ = self.run_tool("doctor", "--listen", "100ms")
        self.assertIn("proximity_ring: not_schedulable", out)

    def test_who_runs_already_is_not_harmed(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "500us", "--priority", "low")
        _, err = self.run_tool("publish", "ring", "2ms", "--priority", "urgent", code=1)
        self.assertIn("gyroscope, which runs already, would ", err)

    def test_a_request_that_no_bus_carries_is_refused_on_a_silent_one_too(self):
        self.start_sim()
        _, err = self.run_tool("publish", "ring", "1ms", code=1)
        self.assertIn("proximity_ring/sensor_", err)

    def test_on_a_slow_bus_the_offer_is_in_whole_milliseconds(self):
        with open(os.path.join(SOURCE, "spec", "topics.json"), encoding="utf-8") as file:
            text = file.read()
        path = os.path.join(self.folder, "slow.json")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace('"deadline": "50ms"', '"deadline": "500ms"'))
        sim = self.start_sim("--bitrate", "3000")  # what the bus has counts, not the spec's 500000
        # A frame of 8 bytes that is on its way, 135 bits at most, and its own of 6 bytes, 111: 246 bits in 82 ms. The wire has
        # microseconds up to 65.535 ms, and milliseconds above.
        for period in ("20ms", "66ms", "81ms"):
            _, err = self.run_tool("--spec", path, "publish", "gyro", period, code=1)
            self.assertIn("the shortest period that passes beside what was heard within 100ms is 82ms (--listen hears more);", err)
        out, _ = self.run_tool("--spec", path, "publish", "gyro", "82ms", "--dry-run", "--explain")
        self.assertIn("208#01520000\n", out)
        self.interrupt(sim)
        self.start_sim("--bitrate", "70000")  # 246 bits in 3.5143 ms
        _, err = self.run_tool("--spec", path, "publish", "gyro", "3ms", code=1)
        self.assertIn("the shortest period that passes beside what was heard within 100ms is 3.515ms (--listen hears more);", err)

    def test_a_signal_ends_its_listening(self):
        self.start_sim()
        publish = self.start("publish", "gyro", "50ms", "--listen", "60s")
        self.assertIn("bus: sim", publish.stderr.readline())
        self.settle()
        self.interrupt(publish)
        self.assertEqual(publish.returncode, 130)

    def test_it_listens_for_a_tenth_of_a_second_and_force_does_not(self):
        self.start_sim()
        def seconds(*arguments):
            begin = time.monotonic()
            self.run_tool("publish", "gyro", "50ms", *arguments)
            return time.monotonic() - begin
        # Each is a bound that a slow machine cannot break: it takes as long as it listens, and does not listen when forced.
        self.assertGreater(seconds(), 0.1)
        self.assertGreater(seconds("--listen", "600ms"), 0.6)
        self.assertLess(seconds("--force", "--listen", "30s"), 30)

    def test_dry_run_needs_no_bus(self):
        out, _ = self.run_tool("publish", "ring", "1ms", "--priority", "urgent", "--dry-run")
        self.assertEqual(out, "01F#01010000\n")

    def test_dry_run_explain_sends_nothing(self):
        self.start_sim()
        out, _ = self.run_tool("publish", "gyro", "50ms", "--dry-run", "--explain")
        self.assertIn("in time, asked for", out)
        self.assertIn("208#01320000\n", out)
        self.run_tool("listen", "gyro", "--count", "1", "--timeout", "300ms", code=1)

    def test_once_and_scripts_do_not_ask(self):
        self.run_tool("once", "gyro", "--explain", code=2)
        self.start_sim()
        path = f"{self.folder}/fast.script"
        with open(path, "w") as script:
            script.write("0s publish ring 1ms --priority urgent\n100ms stop ring\n")
        _, err = self.run_tool("run", path, code=1)  # the board does
        self.assertIn("run: power_management refuses proximity_ring: not_schedulable", err)

    def verdicts(self, *request):
        """Of the messages that are asked for."""
        out, _ = self.run_tool("publish", *request, "--dry-run", "--explain")
        return re.findall(r" {2}([a-z][a-z ]*), asked for$", out, re.MULTILINE), out

    def test_what_it_cannot_know_is_not_called_in_time(self):
        self.start_sim()
        mag = ("mag", "900us")
        # Both come more seldom than it listens.
        for sensor in ("gyro", "accel"):
            self.run_tool("publish", sensor, "60s")
        verdicts, out = self.verdicts(*mag)
        self.assertEqual(verdicts, ["not known"] * 3, out)
        self.heard_for(out, 100, r"^not known: in time unless one of these runs unheard, at a period above (([\d.]+)(ms|s)) \(--listen hears more\): "
                                 r"odometry, .*accelerometer, .*motors")
        # Heard, they are what the board refuses it for: its own streams of one level delay each other.
        for sensor in ("gyro", "accel"):
            self.run_tool("publish", sensor, "500ms")
        verdicts, out = self.verdicts(*mag, "--listen", "1200ms")
        self.assertEqual(verdicts, ["its board may refuse it"] * 3, out)
        offer = re.search(r"the shortest period that passes beside what was heard is (\S+)", out)[1]
        _, err = self.run_tool("publish", *mag, "--listen", "1200ms", code=1)
        self.assertIn("di_wheel_drive refuses magnetometer: not_schedulable", err)
        # What it has not heard may be in the way: its board has just shown that.
        self.assertIn("--explain --listen 2s` shows what runs, and the shortest period that passes", err)
        self.run_tool("publish", "mag", offer)  # and the board takes it
        # A period that leaves time for all that may run is in time without more listening.
        self.assertEqual(self.verdicts("mag", "50ms")[0], ["in time"] * 3)

    def test_what_the_boards_report_is_known(self):
        self.start_sim()
        for board in ("di_wheel_drive", "power_management", "light_ring"):
            self.run_tool("publish", f"{board}_status", "30ms")
        drive = self.start("drive", "1cm/s")  # no status says whether there is one
        self.settle()
        gyro = ("gyro", "1500us", "--listen", "300ms")
        verdicts, out = self.verdicts(*gyro)
        self.assertEqual(verdicts, ["in time"], out)
        self.assertNotIn("not known", out)
        self.interrupt(drive)
        # One that a status names, and that was not heard, may be of any priority.
        self.run_tool("publish", "ring", "10s", "--priority", "urgent")
        waiting.until(lambda: self.verdicts(*gyro)[0] == ["not known"], "the status names it")
        _, out = self.verdicts(*gyro)
        self.assertRegex(out, "not known: .*: proximity_ring, motors")

    def test_a_longer_look_sees_what_comes_seldom(self):
        self.start_sim()
        self.run_tool("publish", "power", "200ms")
        out, _ = self.run_tool("publish", "gyro", "50ms", "--dry-run", "--explain", "--listen", "700ms")
        self.assertRegex(out, r"power_status +(19\d|200)(\.\d+)?ms +50ms")
        # A status tells of a stream that was not heard; it counts as often as it could have been missed.
        self.run_tool("publish", "power", "20s")
        self.run_tool("publish", "power_management_status", "100ms")
        out, _ = self.run_tool("publish", "gyro", "50ms", "--dry-run", "--explain", "--listen", "350ms")
        heard = self.heard_for(out, 350)
        self.assertRegex(out, rf"power_status +{re.escape(heard)} +50ms")
        _, err = self.run_tool("publish", "gyro", "--listen", "soon", code=2)
        self.assertIn("--listen soon: not a time", err)


if __name__ == "__main__":
    main()
