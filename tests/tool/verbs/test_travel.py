"""amiroctl travel: the board drives a way by itself, and the verb says where that ended."""

import json
import os
import re
import signal
import subprocess
import time

from harness import Case, main, waiting
from played_adapter import Adapter

NONE, ARRIVED, STOPPED = 0, 1, 2  # as the spec numbers them


class Travel(Case):
    def sample(self, topic):
        """Its fields, of all of its frames together."""
        out, _ = self.run_tool("once", topic, "--wait")
        fields = {}
        for line in out.splitlines():
            frame = json.loads(line)
            fields |= {f"{frame['frame']}.{name}": value for name, value in frame["fields"].items()}
        return fields

    def test_frames(self):
        for arguments, frame in ((("30cm",), "20B#307500000000E803"), (("-0.3m", "--speed", "5cm/s"), "20B#D08AFF000000F401"),
                                 (("30cm", "--turn", "-90deg"), "20B#307500689AFDE803"),
                                 (("--turn", "1rad", "--priority", "urgent"), "00B#000000A08601E803")):
            out, err = self.run_tool("travel", *arguments, "--dry-run")
            self.assertEqual((out, err), (frame + "\n", ""), arguments)

    def test_wrong_usage(self):
        for arguments, words in (((), "nowhere to go"), (("0",), "nowhere to go"), (("30",), "'30' needs a unit: distance takes -10 to 10 m"),
                                 (("11m",), "'11m' is out of range"), (("30cm", "--turn", "90"), "'90' needs a unit: angle"),
                                 (("30cm", "--turn", "90m"), "in another unit"), (("30cm", "--speed", "1m/s"), "speed takes 0 to 0.3 m/s"),
                                 (("30cm", "5cm"), "5cm"), (("30cm", "--speed", "0m/s"), "--speed 0m/s goes nowhere"), (("30cm", "--for", "2s"), "--for")):
            out, err = self.run_tool("travel", *arguments, code=2)
            self.assertIn(words, err, arguments)
            self.assertEqual(out, "", arguments)

    def test_it_arrives(self):
        self.start_sim()
        out, _ = self.run_tool("travel", "20cm", "--turn", "90deg", "--speed", "30cm/s")
        left = re.fullmatch(r"arrived; (-?[\d.]+) m, (-?[\d.]+) rad are left\n", out)
        self.assertTrue(left, out)
        self.assertLess(abs(float(left[1])), 0.0015)
        self.assertLess(abs(float(left[2])), 0.0175)
        odometry = self.sample("odom")
        self.assertAlmostEqual(odometry["pose.x"], 0.2, delta=0.003)
        self.assertAlmostEqual(odometry["pose.y"], 0, delta=0.003)
        self.assertAlmostEqual(odometry["pose.orientation"], 1.571, delta=0.02)
        # What was asked for the progress is stopped.
        self.assertEqual(self.sample("di_wheel_drive_status")["health.publishing"], 0)

    def test_the_reader_of_the_output_has_gone(self):
        self.start_sim()
        reader, writer = os.pipe()
        os.close(reader)
        travel = self.start("travel", "1cm", stdout=writer)
        os.close(writer)
        _, err = travel.communicate(timeout=30)
        self.assertEqual((travel.returncode, err), (141, "bus: sim (the only one there is; --bus chooses)\n"))

    def test_a_stream_of_the_progress_goes_on(self):
        self.start_sim()
        self.run_tool("publish", "behaviour", "20ms")
        for force in ((), ("--force",)):
            self.run_tool("travel", "1cm", *force)
            out, _ = self.run_tool("listen", "behaviour", "--json", "--count", "3", "--timeout", "20s")
            self.assertEqual([json.loads(line)["fields"]["ended"] for line in out.splitlines()], [ARRIVED] * 3)

    def test_it_asks_for_twenty_reports_a_second(self):
        self.start_sim()
        listener = self.listen("behaviour", "--commands", "--timeout", "20s")
        self.run_tool("travel", "1cm")
        self.settle()
        out, _ = self.interrupt(listener)
        asked = [line["fields"] for line in self.objects(out) if line["frame"] == "request"]
        self.assertEqual({fields["period"] for fields in asked if fields["mode"] == "publish"}, {0.05})

    def travels(self):
        """Returns when the board has driven some of the metre."""
        waiting.until(lambda: 0 < self.sample("behaviour")["behaviour.distance"] < 0.99, "the board travels")

    def test_each_signal_ends_it(self):
        self.start_sim()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            listener = self.listen("travel", "--timeout", "20s")
            travel = self.start("travel", "1m")
            self.assertIn('"A08601000000E803"', listener.stdout.readline())
            self.travels()
            travel.send_signal(number)
            out, err = travel.communicate(timeout=20)
            self.assertEqual((travel.returncode, out), (128 + number, ""), err)
            self.assertIn('"0000000000000000"', listener.stdout.readline())
            sample = self.sample("behaviour")
            self.assertEqual((sample["behaviour.active"], sample["behaviour.ended"]), (NONE, STOPPED))

    def test_samples_that_say_that_it_is_not_active_are_no_end(self):
        # Of before the board heard it, or of one that begins late: whatever they say, none is left behind.
        self.start_sim("--without", "di_wheel_drive")
        listener = self.listen("travel", "behaviour", "--commands", "--timeout", "20s")
        others = self.start("send", "--stdin", stdin=subprocess.PIPE)
        travel = self.start("travel", "1m", "--no-confirm")

        def say_that_it_is_not():
            others.stdin.write("60D#0001000000000000\n")  # the one before has arrived
            others.stdin.flush()
        for line in listener.stdout:  # each question is answered
            if '"topic":"travel"' in line:
                break
            say_that_it_is_not()
        else:
            self.fail("it did not begin")
        for _ in range(10):
            say_that_it_is_not()
        _, err = travel.communicate(timeout=20)
        self.assertEqual(travel.returncode, 1, err)
        self.assertIn("di_wheel_drive has not begun it", err)
        self.assertIn('"data":"0000000000000000"', next(line for line in listener.stdout if '"topic":"travel"' in line))

    def test_what_to_do_where_the_board_ended_it(self):
        self.start_sim("--without", "di_wheel_drive")
        others = self.start("send", "--stdin", stdin=subprocess.PIPE)
        for number, ended, remedy in ((4, "no_sample", "`amiroctl doctor` shows which part does not answer"),
                                      (6, "too_long", "is a wheel blocked? `amiroctl listen odom` shows whether they turn"),
                                      (7, "late", "streams take the board's time: `amiroctl stop`, then ask for slower ones")):
            listener = self.listen("travel", "behaviour", "--commands", "--timeout", "20s")
            travel = self.start("travel", "1m", "--no-confirm")
            for line in listener.stdout:  # each question is answered
                if '"topic":"travel"' in line:
                    break
                if '"mode"' in line:
                    others.stdin.write("60D#0000000000000000\n")
                    others.stdin.flush()
            else:
                self.fail("it did not begin")
            others.stdin.write(f"60D#010050C300000000\n60D#{number:04X}50C300000000\n")  # active, then no longer, with 0.5 m left
            others.stdin.flush()
            _, err = travel.communicate(timeout=20)
            self.assertEqual(travel.returncode, 1, err)
            self.assertTrue(err.endswith(f"amiroctl: travel: ended by di_wheel_drive: {ended}; 0.5 m, 0 rad are left\n          {remedy}\n"), err)
            self.interrupt(listener)

    def test_one_that_was_stopped_before_it_began_does_not_begin(self):
        """It asks for samples, and is stopped meanwhile; the answer that waits for it is of long ago."""
        self.start_sim("--without", "di_wheel_drive")
        listener = self.listen("travel", "behaviour", "--commands", "--timeout", "30s")
        travel = self.start("travel", "1m", "--no-confirm")
        next(line for line in listener.stdout if '"mode":"publish"' in line)
        travel.send_signal(signal.SIGSTOP)
        self.run_tool("send", "60D#0000000000000000")
        # Longer than a board goes on without a set point.
        time.sleep(0.7)  # what is tested is that this time has passed
        travel.send_signal(signal.SIGCONT)
        _, err = travel.communicate(timeout=20)
        self.assertEqual(travel.returncode, 1, err)
        self.assertRegex(err, r"travel: this program did not run for \d+ms, so no further command is sent")
        self.settle()
        out, _ = self.interrupt(listener)
        sent = [sample["data"] for sample in self.objects(out) if sample["topic"] == "travel"]
        self.assertLessEqual(set(sent), {"0000000000000000"})
        # What it has asked for ends all the same.
        asked = [line["fields"]["mode"] for line in self.objects(out) if line.get("frame") == "request"]
        self.assertEqual(asked[-1:], ["stop"], out)

    def test_force_beside_what_is_held_and_told_by_no_sample(self):
        self.start_sim()
        follow = self.start("send", "--stdin", "--timed", stdin=subprocess.PIPE)
        follow.stdin.write("".join(f"({n / 10:.6f}) sim 20C#E803\n" for n in range(200)))
        follow.stdin.close()
        listener = self.listen("follow", "--timeout", "20s")
        listener.stdout.readline()
        self.interrupt(listener)
        _, err = self.run_tool("travel", "10cm", code=1)
        self.assertRegex(err, "drives the wheels by itself|another program has just begun follow 20C#E803")
        _, err = self.run_tool("travel", "10cm", "--force", code=1)
        self.assertIn("replaced by another program, follow 20C#E803", err)  # which holds on

    def test_without_what_tells_of_it_it_does_not_begin(self):
        self.start_sim()
        listener = self.listen("travel", "--timeout", "30s")
        self.run_tool("publish", "mag", "900us")
        _, err = self.run_tool("travel", "30cm", code=1)
        self.assertEqual(err.count("di_wheel_drive refuses behaviour"), 1, err)
        self.assertTrue(err.endswith("travel: not begun: nothing would tell how far it is\n"), err)
        out, _ = self.interrupt(listener)
        self.assertEqual(out, "")

    def test_a_stop_ends_it_and_so_does_a_set_point(self):
        self.start_sim()
        for command, ended in ((("stop",), r"stopped by motors \w{3}#0{16}"), (("drive", "1cm/s", "--once", "--force"), "replaced by motors 201#1027000000000000")):
            listener = self.listen("travel", "--timeout", "20s")
            travel = self.start("travel", "1m", "--force")
            listener.stdout.readline()
            self.interrupt(listener)
            self.travels()
            self.run_tool(*command)
            _, err = travel.communicate(timeout=20)
            self.assertEqual(travel.returncode, 1, err)
            self.assertRegex(err, rf"travel: ended by di_wheel_drive: {ended}; 0\.\d+ m, 0 rad are left")

    def travelling(self, *arguments):
        listener = self.listen("travel", "--timeout", "20s")
        travel = self.start("travel", *arguments)
        listener.stdout.readline()
        self.interrupt(listener)
        return travel

    def test_of_two_that_begin_at_once_none_is_left_behind(self):
        self.start_sim()
        for _ in range(3):
            both = [self.start("travel", way, "--speed", "30cm/s") for way in ("30cm", "-30cm")]
            said = [travel.communicate(timeout=30)[1] for travel in both]
            self.assertIn(1, [travel.returncode for travel in both], said)
            for text in said:
                if "replaced" in text:
                    self.assertIn("both began in the same moment, and were ended", text)
            sample = self.sample("behaviour")
            self.assertEqual(sample["behaviour.active"], NONE, said)

    def test_another_travel_replaces_it_and_goes_on(self):
        self.start_sim()
        travel = self.travelling("1m")
        time.sleep(0.3)  # it drives for so long before it is replaced
        out, err = self.run_tool("travel", "10cm", "--speed", "30cm/s", "--force")
        self.assertRegex(out, "^arrived; ")  # what was replaced has not sent zeros
        out, err = travel.communicate(timeout=20)
        self.assertEqual((travel.returncode, out), (1, ""), err)
        self.assertRegex(err, r"travel: replaced by another program, travel 20B#10270000000\w+; 0\.\d+ m, 0 rad were left\n"
                              "          it was not ended: the robot does what came last\n")

    def test_a_follow_replaces_it(self):
        self.start_sim()  # which starts on the line
        travel = self.travelling("1m")
        follow = self.start("behave", "follow", "--force", "--for", "1s")
        out, err = travel.communicate(timeout=20)
        self.assertEqual((travel.returncode, out), (1, ""), err)
        self.assertRegex(err, "travel: replaced by another program, follow 20C#E803; ")
        _, err = follow.communicate(timeout=20)
        self.assertEqual(follow.returncode, 0, err)

    def test_what_a_board_does_is_another_commander(self):
        self.start_sim()
        travel = self.travelling("90cm", "--speed", "2cm/s")
        for command in (("drive", "5cm/s"), ("drive", "5cm/s", "--once"), ("travel", "5cm"), ("behave", "follow"), ("behave", "avoid")):
            _, err = self.run_tool(*command, code=1)
            self.assertIn(f"{command[0]}: di_wheel_drive drives the wheels by itself, as another program has asked it to: travel", err)
            self.assertIn("--force begins all the same", err)
        self.interrupt(travel)
        self.run_tool("travel", "1cm")

    def test_also_where_the_program_has_gone_and_no_sample_comes(self):
        self.start_sim()
        travel = self.travelling("90cm", "--speed", "2cm/s")
        travel.kill()
        travel.wait()
        self.run_tool("stop", "behaviour")
        _, err = self.run_tool("drive", "5cm/s", code=1)
        self.assertIn("drive: di_wheel_drive drives the wheels by itself", err)
        for late in ("0s", "120ms", "600ms"):  # a script's first drive
            _, err = self.run_tool("run", "-", stdin=f"0s led 1 red\n{late} drive 5cm/s --for 100ms\n", code=1)
            self.assertIn("run: di_wheel_drive drives the wheels by itself", err)
        self.run_tool("behave", "none")
        self.run_tool("drive", "5cm/s", "--for", "100ms")

    def test_a_stop_of_the_program_is_none_of_the_board(self):
        self.start_sim()
        travel = self.travelling("10cm", "--speed", "10cm/s")
        travel.send_signal(signal.SIGSTOP)
        time.sleep(2.5)  # it arrives meanwhile, where the simulator has the time for it
        waiting.until(lambda: self.sample("behaviour")["behaviour.ended"] == ARRIVED, "it has arrived")
        travel.send_signal(signal.SIGCONT)
        out, err = travel.communicate(timeout=20)
        self.assertEqual(travel.returncode, 0, err)
        self.assertNotIn("amiroctl:", err)
        self.assertRegex(out, "^arrived; ")

    def test_a_simulator_that_stops(self):
        sim = self.start_sim()
        travel = self.travelling("1m")
        time.sleep(0.3)  # it drives for so long before the simulator stops
        sim.send_signal(signal.SIGSTOP)
        _, err = travel.communicate(timeout=30)
        sim.send_signal(signal.SIGCONT)
        self.assertEqual(travel.returncode, 1, err)
        self.assertIn("THE ROBOT MAY STILL MOVE", err)

    def test_another_commander(self):
        self.start_sim()
        listener = self.listen("motors", "--timeout", "20s")
        drive = self.start("drive", "0", "10deg/s")
        listener.stdout.readline()
        self.interrupt(listener)
        _, err = self.run_tool("travel", "30cm", code=1)
        self.assertIn("another program commands motors", err)
        self.interrupt(drive)

    def falls_silent(self, answers):
        """A travel on an adapter of its own, and what is sent there. The board says that it does nothing, `answers` to the set
        point, and no more."""
        asked = self.run_tool("publish", "behaviour", "50ms", "--dry-run")[0].strip()
        adapter = Adapter({asked: ["t60D80000000000000000\r"], "20B#102700000000E803": answers})
        self.addCleanup(adapter.unplug)
        travel = self.start("--bus", f"slcan:{adapter.path}", "travel", "10cm")
        waiting.until(lambda: any(frame.startswith("20B#") for frame in adapter.frames), "it begins")
        del adapter.script[asked]
        return travel, asked, adapter.frames

    def test_refused_and_nobody_there(self):
        sim = self.start_sim()
        _, err = self.run_tool("travel", "10m", "--speed", "1cm/s", code=1)
        self.assertIn("di_wheel_drive refuses travel: out_of_range", err)
        self.interrupt(sim)
        self.start_sim("--without", "di_wheel_drive")
        silent = ((self.falls_silent([]), "no behaviour within 1.2s, so the travel was ended\n          is board di_wheel_drive powered and on slcan:"),
                  (self.falls_silent(["t60D80100102700000000\r"]), "di_wheel_drive has been silent for 1.2s, so zeros were sent; THE ROBOT MAY STILL MOVE"))
        listener = self.listen("behaviour", "--commands", "--timeout", "60s")
        begin = time.monotonic()
        _, err = self.run_tool("travel", "10cm", code=1)
        self.assertGreater(time.monotonic() - begin, 1.2)  # four times 300 ms, counted from each question
        asked = []
        while "stop" not in asked:
            asked.append(json.loads(listener.stdout.readline())["fields"]["mode"])
        self.assertEqual(asked.count("publish"), 4, asked)
        self.assertIn("no behaviour within 1.2s, so the travel was not begun", err)
        self.assertIn("di_wheel_drive", err)
        self.assertNotIn("has not answered", err)  # which says the same
        for (travel, asked, sent), words in silent:  # meanwhile
            _, err = travel.communicate(timeout=20)
            self.assertEqual(travel.returncode, 1, err)
            self.assertIn(f"amiroctl: travel: {words}", err)
            self.assertEqual(sent.count(asked), 1 + 3, sent)  # before it, and each time that nothing had come for 300 ms


if __name__ == "__main__":
    main()
