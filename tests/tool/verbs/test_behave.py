"""amiroctl behave: the boards follow a line or avoid obstacles, until the verb ends."""

import json
import os
import resource
import signal
import subprocess
import time

from harness import SOURCE, Case, main, waiting


class Behave(Case):
    def standing(self):
        """The wheels' speeds are zero, by the odometry, within two seconds."""
        for _ in range(20):
            if self.sample("odom")[0] == {"x": 0, "z": 0}:
                return True
            time.sleep(0.1)
        return False

    def sample(self, topic):
        """The fields of its frames."""
        out, _ = self.run_tool("once", topic, "--wait")
        return [json.loads(line)["fields"] for line in out.splitlines()]

    def behaving(self, which, *arguments):
        listener = self.listen(which, "--timeout", "20s")
        behave = self.start("behave", which, *arguments)
        listener.stdout.readline()
        self.interrupt(listener)
        if which == "avoid":  # whose board commands the motors
            self.run_tool("listen", "motors", "-n", "1", "--timeout", "20s")
        else:
            waiting.until(lambda: self.sample("behaviour")[0]["active"] != 0, f"the board does {which}")
        return behave

    def test_frames(self):
        for arguments, frames in ((("follow",), "20C#E803\n"), (("avoid", "--speed", "15cm/s", "--priority", "high"), "129#DC05\n"),
                                  (("home", "--distance", "8cm"), "22A#2003E803\n"), (("none",), "229#0000\n22A#00000000\n20C#0000\n20B#0000000000000000\n")):
            out, err = self.run_tool("behave", *arguments, "--dry-run")
            self.assertEqual((out, err), (frames, ""), arguments)

    def test_wrong_usage(self):
        for arguments, words in (((), "follow"), (("fly",), "fly"), (("follow", "--speed", "0"), "goes nowhere"),
                                 (("follow", "--speed", "1"), "needs a unit"), (("avoid", "--speed", "1m/s"), "speed takes 0 to 0.2 m/s"),
                                 (("none", "--for", "2s"), "none takes no --for"), (("none", "--speed", "1m/s"), "none takes no --speed"), (("home", "--distance", "20cm"), "distance takes 0 to 0.12 m"),
                                 (("follow", "--distance", "5cm"), "follow takes no --distance"), (("follow", "--for", "2"), "2")):
            out, err = self.run_tool("behave", *arguments, code=2)
            self.assertIn(words, err, arguments)
            self.assertEqual(out, "", arguments)

    def test_follow_for_a_time(self):
        self.start_sim()  # which starts on the line
        self.run_tool("behave", "follow", "--for", "1500ms")
        self.assertTrue(self.standing())
        behaviour = self.sample("behaviour")[0]
        self.assertEqual((behaviour["active"], behaviour["ended"]), (0, 2))  # none, stopped
        self.assertGreater(self.sample("odom")[1]["x"], 0.05)

    def test_follow_without_a_line(self):
        self.start_sim()
        self.run_tool("travel", "--turn", "90deg", "--speed", "30cm/s")
        self.run_tool("travel", "15cm", "--speed", "30cm/s")
        _, err = self.run_tool("behave", "follow", code=1)
        self.assertIn("behave: follow was ended: line_lost", err)

    def test_avoid_and_what_ends_it(self):
        self.start_sim()
        for command in (("behave", "none"), ("stop",)):
            behave = self.behaving("avoid")
            self.run_tool(*command)
            _, err = behave.communicate(timeout=60)
            self.assertEqual(behave.returncode, 1, err)
            self.assertIn("avoid was ended: stopped", err)
            self.assertTrue(self.standing())

    def test_none_that_no_board_can_have_heard(self):
        self.start_sim("--without", "di_wheel_drive")
        _, err = self.run_tool("behave", "none", code=1)
        self.assertIn("behave: no behaviour came, so nothing shows that di_wheel_drive has done it\n"
                      "          is board di_wheel_drive powered and on sim?", err)
        _, err = self.run_tool("behave", "none", "--no-confirm")  # asks no board
        self.assertNotIn("behave", err)

    def test_one_whose_program_stood_still_is_ended(self):
        self.start_sim()
        listener = self.listen("--commands", "avoid", "--timeout", "20s")
        behave = self.start("behave", "avoid", "--for", "20s")
        listener.stdout.readline()
        behave.send_signal(signal.SIGSTOP)
        time.sleep(2)  # longer than a program may be stopped
        behave.send_signal(signal.SIGCONT)
        _, err = behave.communicate(timeout=60)
        self.assertEqual(behave.returncode, 1, err)
        self.assertRegex(err, "behave: this program did not run for .*, so the behaviour has ended; it was set to zero\n")
        waiting.until(lambda: '"0000' in listener.stdout.readline(), "zero")

    def test_home(self):
        self.start_sim()
        _, err = self.run_tool("behave", "home", "--distance", "2cm", code=1)
        self.assertIn("power_management refuses home: out_of_range", err)
        self.run_tool("behave", "home", "--distance", "6cm", "--speed", "20cm/s", "--for", "10s")
        self.assertTrue(self.standing())
        out, _ = self.run_tool("once", "ring", "--wait")
        near = min(json.loads(line)["fields"].get("distance", 1) for line in out.splitlines())
        self.assertAlmostEqual(near, 0.06, delta=0.02)  # the sensors' places are 4 mm behind the foremost one

    def test_a_drive_hears_avoid(self):
        self.start_sim()
        behave = self.behaving("avoid")
        _, err = self.run_tool("drive", "5cm/s", code=1)
        self.assertRegex(err, "drive: another program commands motors: 101#")
        _, err = self.run_tool("travel", "5cm", code=1)
        self.assertIn("travel: another program commands motors", err)
        for number in (signal.SIGHUP, signal.SIGINT):  # the terminal is closed; Ctrl-C
            behave.send_signal(number)
            _, err = behave.communicate(timeout=60)
            self.assertEqual(behave.returncode, 128 + number, err)
            self.assertTrue(self.standing())
            if number == signal.SIGHUP:
                behave = self.behaving("avoid")

    def test_what_it_asked_for_ends_with_it(self):
        self.start_sim()
        self.run_tool("behave", "follow", "--for", "500ms")
        out, _ = self.run_tool("listen", "behaviour", "--json", "--timeout", "500ms")
        self.assertEqual(out, "")

    def test_it_asks_for_ten_reports_a_second(self):
        self.start_sim()
        listener = self.listen("behaviour", "--commands", "--timeout", "20s")
        self.run_tool("behave", "follow", "--for", "300ms")
        self.settle()
        out, _ = self.interrupt(listener)
        asked = [line["fields"] for line in self.objects(out) if line["frame"] == "request"]
        # Once: while they come it asks no more.
        self.assertEqual([fields["period"] for fields in asked if fields["mode"] == "publish"], [0.1])

    def test_a_stream_of_reports_goes_on(self):
        """Reports are heard before it begins, so it asks for none, and ends none."""
        self.start_sim()
        self.run_tool("publish", "behaviour", "40ms")
        for force in ((), ("--force",)):
            self.run_tool("behave", "follow", "--for", "100ms", *force)
            self.run_tool("listen", "behaviour", "--count", "3", "--timeout", "20s")

    def test_a_set_point_ends_follow(self):
        self.start_sim()
        behave = self.behaving("follow")
        self.run_tool("drive", "stop")
        _, err = behave.communicate(timeout=60)
        self.assertEqual(behave.returncode, 1, err)
        self.assertIn("follow was ended: stopped", err)

    def test_what_to_do_where_the_board_or_another_program_ended_it(self):
        """A board that is played follows until it says how that has ended; or it says nothing of its end, and the motors are commanded."""
        self.start_sim("--without", "di_wheel_drive")
        others = self.start("send", "--stdin", stdin=subprocess.PIPE)
        for frame, ended, remedy in (("60D#0004000000000000", "no_sample", "`amiroctl doctor` shows which part does not answer"),
                                     ("60D#0005000000000000", "line_lost", "put the robot on the line, or go more slowly: docs/behaviours.md has the "
                                      "least radius for a speed"),
                                     ("60D#0007000000000000", "late", "streams take the board's time: `amiroctl stop`, then ask for slower ones"),
                                     ("201#0000000000000000", "stopped", "another program has commanded the robot")):
            listener = self.listen("follow", "--timeout", "20s")
            behave = self.start("behave", "follow", "--no-confirm", "--for", "10s")
            self.assertIn('"E803"', listener.stdout.readline())
            others.stdin.write("60D#0200000000000000\n608#000000000000\n")  # it follows; and zeros of a sensor, which end nothing
            others.stdin.flush()
            self.assertEqual([json.loads(listener.stdout.readline())["data"] for _ in range(2)], ["E803"] * 2, ended)
            others.stdin.write(frame + "\n")
            others.stdin.flush()
            _, err = behave.communicate(timeout=20)
            self.assertEqual(behave.returncode, 1, err)
            self.assertTrue(err.endswith(f"amiroctl: behave: follow was ended: {ended}\n          {remedy}\n"), err)
            self.interrupt(listener)

    def test_a_board_that_is_off(self):
        self.start_sim("--without", "di_wheel_drive")
        for arguments in (("--for", "100ms"), ("--force", "--for", "700ms")):
            _, err = self.run_tool("behave", "follow", *arguments, code=1)
            self.assertTrue(err.endswith("amiroctl: behave: no behaviour came, so nothing shows that di_wheel_drive has done it\n"
                                         "          is board di_wheel_drive powered and on sim? See `amiroctl doctor`\n"), err)
            self.assertEqual(err.count("no behaviour came"), 1, err)  # while it waits that is said after two seconds

    def test_a_script_that_is_interrupted_ends_what_it_repeats(self):
        self.start_sim()
        listener = self.listen("avoid", "--commands")
        run = self.start("run", "-", stdin=subprocess.PIPE)
        run.stdin.write("0s set avoid speed=10cm/s --every 100ms\n")
        run.stdin.close()
        run.stdin = None
        self.assertIn("E803", listener.stdout.readline())
        _, err = self.interrupt(run)
        self.assertEqual(run.returncode, 130, err)
        self.assertTrue(err.endswith("interrupted: avoid was ended\n"), err)
        self.settle()
        out, _ = self.interrupt(listener)
        self.assertEqual(self.objects(out)[-1]["data"], "0000")

    def test_a_board_that_would_command_the_motors_and_is_off(self):
        self.start_sim("--without", "power_management")
        for which, lasting in (("avoid", "700ms"), ("home", "700ms"), ("avoid", "100ms")):
            _, err = self.run_tool("behave", which, "--for", lasting, code=1)
            self.assertIn("amiroctl: behave: power_management does not answer, so nothing shows that it has done it\n"
                          "          is it powered and on sim? ", err)
            self.assertNotIn("no set point", err)
        # Not asked whether it is there: in so short a time it need not have commanded the motors.
        _, err = self.run_tool("behave", "avoid", "--for", "100ms", "--no-confirm")
        self.assertNotIn("nothing shows", err)

    def test_a_board_that_commands_no_motors_of_another_shows_nothing(self):
        """The motors are its own, or there are none: that no set point came says nothing of it."""
        with open(os.path.join(SOURCE, "tests", "tool", "verbs", "transcripts", "files", "behaves.json"), encoding="utf-8") as file:
            spec = json.load(file)
        with open(os.path.join(SOURCE, "spec", "topics.json"), encoding="utf-8") as file:
            motors = next(topic for topic in json.load(file)["topics"] if topic["name"] == "motors")
        avoid = {"name": "avoid", "id": "0x30", "board": "wheels", "source": "decided: for tests", "kind": "actuator",
                 "frames": [{"fields": [{"name": "speed", "byte": 0, "type": "u16", "scale": 0.001, "unit": "m/s"}]}]}
        path = os.path.join(self.folder, "own.json")
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        for topics in ([avoid], [avoid, motors | {"board": "wheels"}]):
            with open(path, "w", encoding="utf-8") as file:
                json.dump(spec | {"topics": topics}, file)
            _, err = self.run_tool("--spec", path, "behave", "avoid", "--for", "600ms")  # longer than a board may be silent
            self.assertNotIn("nothing shows", err)

    def test_a_board_that_is_off_is_told_of_while_it_waits(self):
        self.start_sim("--without", "di_wheel_drive")
        behave = self.start("behave", "follow")
        said = next(line for line in behave.stderr if not line.startswith("bus: "))
        self.assertEqual(said, "behave: no behaviour came, so nothing shows that di_wheel_drive has done it; "
                               "is board di_wheel_drive powered and on sim? See `amiroctl doctor`\n")
        behave.send_signal(signal.SIGINT)
        _, err = behave.communicate(timeout=60)
        self.assertEqual((behave.returncode, err), (130, ""))

    def test_it_waits_between_two_looks_at_the_board(self):
        """Without a wait its processor time is all the time that there is."""
        self.start_sim("--without", "di_wheel_drive")
        for arguments, code in ((("avoid", "--for", "2s"), 0), (("none",), 1)):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            self.run_tool("behave", *arguments, "--no-confirm" if code == 0 else "--force", code=code)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            self.assertLess(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 0.5, arguments)

    def test_killed(self):
        self.start_sim()
        for which in ("follow", "avoid"):
            behave = self.behaving(which)
            behave.send_signal(signal.SIGKILL)
            behave.wait()
            waiting.until(lambda: self.sample("behaviour")[0]["active"] == 0, f"the board's watchdog ends {which}")
            self.assertTrue(self.standing(), which)

    def test_the_ring_needs_its_offsets(self):
        self.start_sim()
        self.run_tool("set", "ring_calibration", "action=forget")
        _, err = self.run_tool("behave", "avoid", code=1)
        self.assertIn("power_management refuses avoid: no_sample", err)
        self.assertIn("`amiroctl set ring_calibration action=measure`", err)


if __name__ == "__main__":
    main()
