"""amiroctl drive and run beside another program that commands the motors, and what they say when something ends them."""

import json
import os
import re
import signal
import time

from harness import Case, main, waiting
from played_adapter import WithAdapter
from realtime import MOST_LATE

FORWARDS = "201#50C3000000000000"
BACKWARDS = "-5cm/s"
STOPPED = "another program has set the motors to zero, which ends this "
ZERO = "0000000000000000"
OTHER = "another program commands motors: " + FORWARDS


class Drive(Case):
    # Who begins listens for 150 ms to others, which repeat what they command each 100 ms.
    most_late = MOST_LATE

    def driving(self, *arguments):
        """A drive that goes on: one that begins now could have heard it."""
        listener = self.listen("motors", "--timeout", "20s")
        drive = self.start("drive", *(arguments or ("5cm/s",)))
        self.drives(listener)
        self.interrupt(listener)
        return drive

    def drives(self, listener):
        for _ in range(3):
            self.assertIn("50C3000000000000", listener.stdout.readline())


class TwoCommanders(Drive):
    def test_a_second_drive_is_refused_and_the_first_goes_on(self):
        self.start_sim()
        first = self.driving()
        for command in (("drive", BACKWARDS), ("drive", BACKWARDS, "--once"),
                        ("run", self.script("0s drive -5cm/s --for 1s\n")),
                        ("run", self.script("0s led 1 red\n300ms drive -5cm/s\n"))):
            _, err = self.run_tool(*command, code=1)
            self.assertRegex(err, rf"amiroctl: {command[0]}: {OTHER}, [12] set points? within 150ms\n", command)
            self.assertIn("--force", err)
            self.assertNotIn("MAY STILL MOVE", err)
        # What moves nothing is no second drive.
        self.run_tool("run", self.script("0s led 1 red\n200ms led 1 blue\n300ms publish gyro 1s\n"))
        _, err = self.interrupt(first)
        self.assertEqual(first.returncode, 130)
        self.assertNotIn("another program", err)  # none of the refused ones has sent a set point

    def test_a_drive_that_is_interrupted_names_a_board_that_has_not_answered(self):
        self.start_sim("--without", "di_wheel_drive")
        _, err = self.interrupt(self.driving())
        words = "drive: di_wheel_drive has not answered, so it may be off; `amiroctl doctor` says which boards are there\n"
        self.assertIn(words, err)

    def test_force_drives_all_the_same_and_both_sides_say_so(self):
        sim = self.start_sim()
        first = self.driving()
        doctor = self.start("doctor", "--json", "--listen", "5s")  # until the second one has begun, too
        self.assertIn("bus: sim", doctor.stderr.readline())
        _, second = self.run_tool("drive", BACKWARDS, "--for", "1200ms", "--force")
        out, _ = doctor.communicate(timeout=60)
        _, err = first.communicate(timeout=60)  # the end of the second is a stop
        self.assertEqual(first.returncode, 1)
        self.assertIn(STOPPED, err)
        for text, frame in ((err, "201#B03CFFFF00000000"), (second, FORWARDS)):
            self.assertEqual(text.count(f"drive: another program commands motors, too: {frame}"), 1, text)
            self.assertRegex(text, r"drive: \d+ set points of another program came meanwhile")
        findings = [f for f in json.loads(out)["findings"] if "motors" in f["what"]]
        self.assertEqual([(f["severity"], f["board"]) for f in findings], [("warning", "di_wheel_drive")], out)
        self.assertRegex(findings[0]["what"], "two programs command motors in turns: 201#.* and 201#")
        self.assertEqual(doctor.returncode, 1)
        _, err = self.interrupt(sim)
        turns = re.search(r"motors +was commanded by two senders, in turns: (\d+) times", err)
        self.assertGreater(int(turns[1]), 5)

    def test_one_that_comes_later_is_reported_by_a_script(self):
        self.start_sim()
        listener = self.listen("motors", "--timeout", "20s")
        run = self.start("run", self.script("0s drive 5cm/s\n5s stop\n"))  # late enough for another program to begin
        self.drives(listener)
        self.run_tool("set", "motors", "x=-1cm/s")
        _, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 0)
        self.assertEqual(err.count("run: another program commands motors, too: 201#F0D8FFFF00000000"), 1)
        self.assertIn("run: 1 set point of another program came meanwhile", err)

    def test_a_drive_alone_hears_no_other_and_stops_at_once(self):
        sim = self.start_sim()
        begin = time.monotonic()
        _, err = self.run_tool("drive", "5cm/s", "--for", "300ms")
        self.assertGreater(time.monotonic() - begin, 0.45)  # 150 ms to listen
        _, again = self.run_tool("drive", BACKWARDS, "--for", "300ms")  # the zero of the first is no commander
        _, forced = self.run_tool("drive", "5cm/s", "--once", "--force")
        _, script = self.run_tool("run", self.script("0s drive 5cm/s\n200ms drive stop\n300ms drive 1cm/s --for 200ms\n"))
        for text in (err, again, forced, script):
            self.assertNotIn("another program", text)
        _, err = self.interrupt(sim)
        self.assertNotIn("in turns", err)

    def test_stop_does_not_wait_and_ends_the_other_drive(self):
        self.start_sim()
        for stop in (("drive", "stop"), ("stop",)):
            drive = self.driving()
            listener = self.listen("motors", "--timeout", "60s")
            self.run_tool(*stop)
            _, err = drive.communicate(timeout=60)
            self.assertEqual(drive.returncode, 1)
            self.assertIn(STOPPED, err)
            self.settle()
            out, _ = self.interrupt(listener)
            data = [e["data"] for e in self.objects(out)]
            first = data.index(ZERO)
            self.assertEqual((data.count(ZERO), data[-1]), (2, ZERO), data)  # of both
            self.assertLessEqual(len(data[first:]), 3, data)  # one was under way as the stop came

    def test_a_script_goes_on_until_its_last_hold_is_over(self):
        self.start_sim()
        listener = self.listen("motors", "--timeout", "60s")
        self.run_tool("run", self.script("0s drive 5cm/s --for 500ms\n"))
        self.settle()
        out, _ = self.interrupt(listener)
        seen = self.objects(out)
        self.assertEqual((seen[0]["data"], seen[-1]["data"]), ("50C3000000000000", ZERO))
        self.assertGreater(int(seen[-1]["time_ns"]) - int(seen[0]["time_ns"]), 450_000_000)

    def test_a_stop_ends_a_script_that_has_set_motors_without_a_hold(self):
        self.start_sim()
        listener = self.listen("motors", "--timeout", "20s")
        run = self.start("run", self.script("0s set motors x=5cm/s\n60s drive 5cm/s\n"))
        self.assertIn("50C3000000000000", listener.stdout.readline())
        self.run_tool("stop")
        _, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 1)
        self.assertIn(STOPPED + "run", err)

    def test_with_force_a_stop_ends_nothing(self):
        self.start_sim()
        drive = self.driving("5cm/s", "--force")
        self.run_tool("drive", "stop")
        time.sleep(0.5)  # it would have ended by then
        self.assertIsNone(drive.poll())
        self.interrupt(drive)
        self.assertEqual(drive.returncode, 130)

    def test_doctor_finds_nothing_in_one_drive(self):
        self.start_sim()
        self.driving()
        out, _ = self.run_tool("doctor", "--listen", "500ms")
        self.assertIn("all is well", out)


class Unforeseen(Drive):
    """Whatever ends the command: the motors are at rest behind it."""

    def last_set_points(self, command, read=None, **options):
        """The set points of a command, whose messages are read until one has `read` in it; and how it ended."""
        listener = self.listen("motors", "--timeout", "20s")
        process = self.start(*command, **options)
        if read is not None:
            while read not in process.stderr.readline():
                pass
            process.stderr.close()
        process.wait(timeout=60)
        self.settle()
        out, _ = self.interrupt(listener)
        return [e["data"] for e in self.objects(out)], process.returncode

    def test_messages_that_are_not_read(self):
        self.start_sim()
        reader, writer = os.pipe()
        os.close(reader)
        data, code = self.last_set_points(["stop"], stderr=writer)
        self.assertEqual((data, code), ([ZERO], 0))
        data, code = self.last_set_points(["drive", "5cm/s"], stderr=writer)
        os.close(writer)
        self.assertEqual((data, code), ([], 141))  # the first message ends it, before anything moves
        script = self.script("0s drive 5cm/s\n400ms led 1 red\n5s stop\n")
        data, code = self.last_set_points(["run", script], read="0s  drive")
        self.assertIn("50C3000000000000", data)
        self.assertEqual((data[-1], code), (ZERO, 141))

    def test_the_output_takes_no_more(self):
        self.start_sim()
        script = self.script("0s drive 5cm/s\n300ms publish gyro 50ms\n5s stop\n")
        with open("/dev/full", "wb") as full:
            data, code = self.last_set_points(["run", script, "--show"], stdout=full)
        self.assertIn("50C3000000000000", data)
        self.assertEqual((data[-1], code), (ZERO, 1))
        self.run_tool("stop")
        reader, writer = os.pipe()
        os.close(reader)
        data, code = self.last_set_points(["run", script, "--show"], stdout=writer)
        os.close(writer)
        self.assertIn("50C3000000000000", data)
        self.assertEqual((data[-1], code), (ZERO, 141))


class Alarm(WithAdapter, Drive):
    """THE ROBOT MAY STILL MOVE is said where it may."""

    def test_not_where_nothing_was_sent(self):
        adapter = self.adapter(refuse="t")
        for command in (("drive", "5cm/s"), ("drive", "5cm/s", "--once"), ("run", self.script("0s drive 5cm/s\n")),
                        ("run", self.script("0s led 1 red\n0s led 1 blue\n"))):
            _, err = self.run_tool("--bus", f"slcan:{adapter.path}", *command, code=1)
            self.assertRegex(err, "was not sent|did not leave|no set point has left .*; no set point has reached the robot")
            self.assertNotIn("MAY STILL MOVE", err, command)

    def test_where_a_stop_was_not_sent(self):
        adapter = self.adapter(refuse="t")
        for command in (("stop",), ("drive", "stop"), ("run", self.script("0s stop\n"))):
            _, err = self.run_tool("--bus", f"slcan:{adapter.path}", *command, code=1)
            self.assertIn("THE ROBOT MAY STILL MOVE", err, command)

    def test_where_the_adapter_goes_while_the_robot_moves(self):
        for command, begun, end in ((("drive", "5cm/s", "--for", "60s"), "201#50C3", "until its watchdog stops it"),
                                    (("travel", "30cm"), "20B#", "to the end of its way")):
            asked, _ = self.run_tool("publish", "behaviour", "50ms", "--dry-run")
            adapter = self.adapter(script={asked.strip(): ["t60D80000000000000000\r"]})  # the board does nothing by itself
            tool = self.start("--bus", f"slcan:{adapter.path}", *command)
            waiting.until(lambda: any(frame.startswith(begun) for frame in adapter.frames), "it moves")
            adapter.unplug()
            _, err = tool.communicate(timeout=60)
            self.assertEqual(tool.returncode, 1, err)
            self.assertRegex(err, f"amiroctl: .* is gone.*; THE ROBOT MAY STILL MOVE,? {end}: be ready to cut its power\n")

    def test_not_where_there_is_no_bus(self):
        for bus in ("sim", "can7", "slcan:/dev/null@500k"):
            for command in (("drive", "5cm/s"), ("run", self.script("0s drive 5cm/s\n"))):
                _, err = self.run_tool("--bus", bus, *command, code=1)
                self.assertNotIn("MAY STILL MOVE", err)


class Interrupted(Drive):
    def test_a_script_says_where_its_drive_has_no_end(self):
        self.start_sim()
        words = "run: the drive goes on until Ctrl-C; --for, or a last step `drive stop`, ends it\n"
        run = self.start("run", self.script("0s drive 5cm/s\n"))
        self.assertEqual([run.stderr.readline() for _ in range(3)][1:], ["      0s  drive 5cm/s\n", words])
        self.interrupt(run)
        for steps in ("0s drive 5cm/s --for 200ms\n", "0s drive 5cm/s\n200ms drive stop\n"):
            self.assertNotIn(words, self.run_tool("run", self.script(steps))[1])

    def test_a_travel_that_a_script_has_begun_is_ended(self):
        """The board would travel on without the script."""
        self.start_sim()
        listener = self.listen("--commands", "--timeout", "20s")
        run = self.start("run", self.script("0s set travel distance=50cm angle=0rad speed=10cm/s\n9s led 1 red\n"))
        self.assertIn("50C300000000E803", listener.stdout.readline())
        _, err = self.interrupt(run)
        self.assertEqual(run.returncode, 130, err)
        self.assertIn("interrupted: travel was ended\n", err)
        line = json.loads(listener.stdout.readline())
        self.assertEqual((line["id"], line["data"]), ("20B", "0000000000000000"))


    def test_an_interrupted_script_says_how_the_sensors_that_it_asked_end(self):
        self.start_sim()
        for steps, said in (("0s publish gyro 100ms\n0s drive 5cm/s\n9s led 1 red\n",
                             "interrupted: the motors were set to zero; `amiroctl stop` stops the sensors too\n"),
                            ("0s drive 5cm/s\n9s publish gyro 100ms\n", "interrupted: the motors were set to zero\n")):
            listener = self.listen("motors", "--timeout", "20s")
            run = self.start("run", self.script(steps))
            self.assertIn("50C3000000000000", listener.stdout.readline())
            _, err = self.interrupt(run)
            self.assertEqual(run.returncode, 130, err)
            self.assertTrue(err.endswith(said), err)
            self.interrupt(listener)

    def test_also_by_an_error(self):
        self.start_sim()
        listener = self.listen("--commands", "--timeout", "20s")
        run = self.start("run", self.script("0s set travel distance=50cm angle=0rad speed=10cm/s\n1s led 1 red\n"))
        self.assertIn("50C300000000E803", listener.stdout.readline())
        run.send_signal(signal.SIGSTOP)
        time.sleep(2)  # longer than a script may be stopped
        run.send_signal(signal.SIGCONT)
        _, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 1, err)
        self.assertRegex(err, r"run: this program did not run for \S+, so no further command is sent\n.*\ntravel was ended\n")
        line = json.loads(listener.stdout.readline())
        self.assertEqual((line["id"], line["data"]), ("20B", "0000000000000000"))


class LateSteps(Drive):
    def test_a_script_that_stood_still_carries_out_no_late_steps(self):
        self.start_sim()
        listener = self.listen("--commands", "--timeout", "20s")
        # For a minute: on a busy machine it is stopped after some of them.
        steps = "".join(f"{1000 + 100 * i}ms led 1 {i % 256},0,0\n" for i in range(1, 600))
        run = self.start("run", self.script("0s led 1 red\n" + steps))
        self.assertIn("FF0000", listener.stdout.readline())
        run.send_signal(signal.SIGSTOP)
        time.sleep(2)  # longer than a script may be stopped
        self.run_tool("led", "2", "green", "--no-confirm")  # behind the steps before; its last frame
        for line in listener.stdout:
            if "00FF00" in line:
                break
        run.send_signal(signal.SIGCONT)
        _, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 1, err)
        self.assertRegex(err, r"run: this program did not run for [0-9.]+m?s, so no further command is sent")
        self.assertNotIn("MAY STILL MOVE", err)
        self.settle()
        out, _ = self.interrupt(listener)
        self.assertEqual(out, "", "a late step was carried out")

    def test_a_slow_bus_makes_steps_late_and_no_more(self):
        """The queue takes 64 frames, and the bus some 24 a second: the last steps wait for more than a second."""
        self.start_sim("--bitrate", "2000")
        listener = self.listen("--commands", "-n", "100", "--timeout", "60s")
        self.run_tool("run", self.script("".join(f"0s led 1 {i},0,0\n" for i in range(100))))
        out, _ = listener.communicate(timeout=60)
        self.assertEqual(len(self.objects(out)), 100)

    def test_a_script_that_drives_and_stood_still_ends_with_zero(self):
        self.start_sim()
        listener = self.listen("motors", "--timeout", "20s")
        run = self.start("run", self.script("0s drive 5cm/s\n500ms drive 6cm/s\n1s drive 7cm/s\n20s stop\n"))
        self.assertIn("50C3000000000000", listener.stdout.readline())
        run.send_signal(signal.SIGSTOP)
        time.sleep(1.5)  # longer than a drive may be stopped
        run.send_signal(signal.SIGCONT)
        _, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 1, err)
        self.assertRegex(err, r"run: this program did not run for .*, so the drive has ended; the motors were set to zero")
        self.settle()
        out, _ = self.interrupt(listener)
        self.assertEqual({line["data"] for line in self.objects(out)} - {"50C3000000000000"}, {"0000000000000000"})


if __name__ == "__main__":
    main()
