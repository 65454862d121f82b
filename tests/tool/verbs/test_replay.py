"""amiroctl replay on a virtual bus: frames at their times, and a log that answers like the robot that it is of."""

import gzip
import os
import re
import signal
import statistics
import sys
import time

from harness import SOURCE, Case, main, waiting

sys.path.insert(0, os.path.join(SOURCE, "tests", "peers", "logs"))
from realtime import RealTime  # noqa: E402
from virtual_bus import Client  # noqa: E402

LINE = re.compile(r"^\((\d+\.\d+)\) (\S+) (\S+)#(\S*)(?: ([RT]))?$")


class Replaying(Case):
    had_time = RealTime.had_time

    def setUp(self):
        super().setUp()
        self.path = lambda name: os.path.join(self.folder, name)

    def write_log(self, *lines, name="in.log", interface="can0"):
        with open(self.path(name), "w") as file:
            for second, frame in lines:
                file.write(f"({second:.6f}) {interface} {frame}\n")
        return self.path(name)

    def lines(self, name):
        with open(self.path(name)) as file:
            whole = file.read().rpartition("\n")[0].splitlines()  # while it is recorded the last line may be a part
        return [(float(line[1]), f"{line[3]}#{line[4]}") for line in map(LINE.match, whole)]

    def recorded(self, name, count):
        """Returns when a recording has so many frames."""
        waiting.until(lambda: len(self.lines(name)) >= count, f"{count} frames in {name}")

    def recording(self, name, *arguments):
        recorder = self.start("record", "-o", self.path(name), *arguments)
        for line in recorder.stderr:
            if "Ctrl-C ends" in line:
                return recorder
        self.fail(f"record ended with {recorder.wait()}")

    def test_a_simulator_that_ends_during_a_pause_of_the_log_is_seen_at_once(self):
        for end in (signal.SIGKILL, signal.SIGINT):
            sim = self.start_sim()
            replay = self.start("replay", self.write_log((0, "605#00D20000"), (60, "605#00D20000")))
            self.assertIn("bus: sim", replay.stderr.readline())
            self.settle()
            begin = time.monotonic()
            sim.send_signal(end)
            _, err = replay.communicate(timeout=60)
            self.assertLess(time.monotonic() - begin, 10)
            self.assertEqual(replay.returncode, 1)
            self.assertRegex(err, r"amiroctl: the simulator .* (is gone|was ended)")
            self.assertIn("sent 1 frame ", err)
            sim.wait()

    def replayed(self, log, *arguments, code=0):
        """What comes on the bus when a log is replayed, with its times; and what replay says."""
        name = f"out{len(os.listdir(self.folder))}.log"
        recorder = self.recording(name)
        _, err = self.run_tool("replay", log, *arguments, code=code)
        self.settle()
        self.interrupt(recorder)
        return self.lines(name), err

    def test_record_replay_record(self):
        self.start_sim()
        recorder = self.recording("first.log")
        for words in (("gyro", "20ms"), ("odom", "30ms"), ("ring", "100ms")):
            self.run_tool("publish", *words)
        self.recorded("first.log", 200)
        self.run_tool("stop", "all")
        self.settle()
        self.interrupt(recorder)
        first = self.lines("first.log")
        self.assertGreater(len(first), 150)
        # Sensor data only: the robot would answer the requests.
        sensors = [line for line in first if int(line[1][:3], 16) & 0x400]
        second, _ = self.replayed(self.path("first.log"), "--only", "sensors")
        self.assertEqual([frame for _, frame in second], [frame for _, frame in sensors])
        times = [(here, there) for (here, _), (there, _) in zip(sensors, second)]
        shift = min(there - here for here, there in times)
        monotonic = time.monotonic() - time.time()
        # By the clock that tells when this machine was held up: a frame that was due meanwhile comes behind that.
        late = [there - here - shift - self.spare.held_up_between(here + shift + monotonic - 0.01, there + monotonic)
                for here, there in times]
        self.assertLess(max(late), 0.2)

    def test_times_are_kept_and_scaled(self):
        self.start_sim()
        log = self.write_log((100, "608#01"), (100.2, "608#02"), (100.2, "608#03"), (101, "608#04"))
        for speed, factor in (("1", 1), ("4", 0.25)):
            out, err = self.replayed(log, "--speed", speed)
            self.assertEqual([frame for _, frame in out], ["608#01", "608#02", "608#03", "608#04"])
            for (when, _), wanted in zip(out, (0, 0.2, 0.2, 1)):
                self.assertAlmostEqual(when - out[0][0], wanted * factor, delta=0.1 + self.spare.slack)
            number, unit = re.search(r"sent 4 frames in (\d+(?:\.\d+)?)(m?s)", err).groups()
            lasted = float(number) * (0.001 if unit == "ms" else 1)
            self.assertGreaterEqual(lasted, factor)
            self.assertLess(lasted, factor + 5)
        out, err = self.replayed(log, "--speed", "max")
        self.assertEqual(len(out), 4)
        self.assertLess(out[-1][0] - out[0][0], 0.5 + self.spare.slack)
        number, unit = re.search(r"sent 4 frames in (\d+(?:\.\d+)?)([mun]?s)", err).groups()
        self.assertLess(float(number) * (1 if unit == "s" else 0.001), 5)  # by itself: its start and the recorder's count for nothing

    def test_all_that_a_bus_can_carry(self):
        self.start_sim()
        frames = ["7FF#1122334455667788", "18FF1234#AA", "123#R", "1F334455#R", "000#", "123##1AABB",
                  "18FF1234##0" + "5A" * 64, "7FF##3"]
        log = self.write_log(*[(i / 1000, frame) for i, frame in enumerate(frames)], (0.01, "20000040#0000000000000000"))
        out, err = self.replayed(log)
        self.assertEqual([frame for _, frame in out], frames)
        self.assertIn("1 error frame left out", err)
        self.assertNotIn("CAN FD frame", err)

    def test_times_that_go_back(self):
        self.start_sim()
        log = self.write_log((100, "608#01"), (99.999, "608#02"), (100.1, "608#03"), (50, "608#04"), (50.1, "608#05"))
        out, err = self.replayed(log)
        self.assertEqual([frame for _, frame in out], [f"608#0{i}" for i in range(1, 6)])
        self.assertIn("2 with a time before the last", err)
        self.assertAlmostEqual(out[4][0] - out[3][0], 0.1, delta=0.05 + self.spare.slack)

    def test_parts_of_a_log(self):
        lines = [(10 + i / 10, f"608#{i:02X}") for i in range(50)] + [(14.95, "609#00"), (14.96, "209#00")]
        log = self.write_log(*lines)
        def dry(*arguments):
            out, err = self.run_tool("replay", log, "--dry-run", *arguments)
            return [(float(line[1]), f"{line[3]}#{line[4]}") for line in map(LINE.match, out.splitlines())], err
        out, err = dry()
        self.assertEqual(out, [(round(when - 10, 6), frame) for when, frame in lines])
        self.assertIn("52 frames would be sent", err)
        self.assertEqual(dry("--since", "1s", "--until", "1200ms")[0], [(0, "608#0A"), (0.1, "608#0B"), (0.2, "608#0C")])
        self.assertEqual([frame for _, frame in dry("accel")[0]], ["609#00", "209#00"])
        self.assertEqual([frame for _, frame in dry("accel", "--only", "commands")[0]], ["209#00"])
        self.assertEqual(len(dry("--only", "sensors")[0]), 51)
        self.assertEqual(dry("--speed", "2")[0][1], (0.05, "608#01"))
        long = self.write_log((0, "608#01"), (3600, "608#02"), (3601, "608#03"), name="long.log")
        log = long
        out, err = dry("--max-gap", "2s")
        self.assertEqual([when for when, _ in out], [0, 2, 3])
        self.assertIn("1 pause cut", err)

    def test_a_log_without_what_was_chosen(self):
        log = self.write_log((1, "608#01"), (2, "608#02"))
        for words in (("accel",), ("--since", "1h"), ("--only", "commands")):
            out, err = self.run_tool("replay", log, "--dry-run", *words, code=1)
            self.assertEqual(out, "")
            self.assertEqual(err, "0 frames would be sent, 2 not chosen\n"
                                  f"amiroctl: replay: no frame of {log} was chosen\n"
                                  f"          `amiroctl stats {log}` shows what it has\n")
        self.start_sim()
        for loop in (("--loop",), ("--loop", "3")):  # whatever it says: more passes without a frame would take no time, and never end
            _, err = self.run_tool("replay", log, "accel", *loop, code=1)
            self.assertRegex(err, r"\nsent 0 frames in \S+, 2 not chosen\namiroctl: replay: no frame of .* was chosen\n")
        _, err = self.run_tool("replay", log, "--interface", "can7=sim", code=1)
        self.assertIn(f"replay: all frames of {log} are of interfaces without a bus\n          name them: --interface LOG=BUS\n", err)

    def test_a_drive_that_is_cut_short_ends_with_zero(self):
        self.start_sim()
        log = self.write_log((1, "201#50C3000000000000"), (1.1, "201#50C3000000000000"), (21, "201#0000000000000000"))
        frames, err = self.replayed(log, "--until", "500ms")
        self.assertEqual([frame for _, frame in frames][-2:], ["201#50C3000000000000", "201#0000000000000000"])
        self.assertIn("the motors were set to zero: the log goes on behind this", err)
        for number in (signal.SIGINT, signal.SIGHUP, signal.SIGQUIT):
            recorder = self.recording(f"{number}.log")
            replay = self.start("replay", log)
            self.recorded(f"{number}.log", 2)
            _, err = self.interrupt(replay, number)
            self.assertEqual(replay.returncode, 128 + number)
            self.assertIn("sent 2 frames", err)
            self.settle()
            self.interrupt(recorder)
            self.assertEqual([frame for _, frame in self.lines(f"{number}.log")][-1], "201#0000000000000000")
        frames, err = self.replayed(log, "--speed", "100")  # to its end: as it was recorded
        self.assertEqual(len(frames), 3)
        self.assertNotIn("set to zero", err)
        _, err = self.run_tool("replay", self.write_log((1, "201#50C3000000000000"), name="end.log"))  # also where that moves
        self.assertIn("sent 1 frame in ", err)
        self.assertNotIn("set to zero", err)

    def test_loops(self):
        self.start_sim()
        log = self.write_log((1, "608#01"), (1.05, "608#02"))
        out, _ = self.replayed(log, "--loop", "3")
        self.assertEqual([frame for _, frame in out], ["608#01", "608#02"] * 3)
        self.recording("endless.log")
        endless = self.start("replay", log, "--loop")
        self.recorded("endless.log", 11)
        _, err = self.interrupt(endless)
        self.assertEqual(endless.returncode, 130)
        self.assertGreater(int(re.search(r"sent (\d+) frames", err)[1]), 10)

    def test_a_log_from_a_pipe_is_played_while_it_comes(self):
        self.start_sim()
        out, err = self.run_tool("replay", "-", stdin="(1.0) x 608#01\n(1.1) x 608#02\n")
        self.assertIn("sent 2 frames", err)

    def test_interfaces_go_to_their_buses(self):
        other = "sim:" + self.path("other.sock")
        self.start_sim()
        self.start_sim("--bus", other)
        with open(self.path("in.log"), "w") as file:
            file.write("(1.0) can0 608#01\n(1.0) can1 608#02\n(1.0) can2 608#03\n")
        here = self.recording("here.log", "--bus", "sim")
        there = self.recording("there.log", "--bus", other)
        _, err = self.run_tool("replay", self.path("in.log"), "--interface", "can0=sim", "--interface", f"can1={other}")
        self.settle()
        self.interrupt(here)
        self.interrupt(there)
        self.assertEqual([frame for _, frame in self.lines("here.log")], ["608#01"])
        self.assertEqual([frame for _, frame in self.lines("there.log")], ["608#02"])
        self.assertIn("1 of interfaces without a bus", err)
        _, err = self.run_tool("replay", self.path("in.log"), "--interface", "can2=sim", "--interface", "can0=sim")
        self.assertIn("sent 2 frames in ", err)  # two interfaces, one bus
        out, err = self.run_tool("replay", self.path("in.log"), "--interface", "can0=sim", "--dry-run")
        self.assertRegex(out, r"^\([0-9.]+\) can0 608#01\n$")
        self.assertIn("1 frame would be sent", err)
        self.assertIn("2 of interfaces without a bus", err)

    def test_a_log_stands_in_for_the_robot(self):
        sim = self.start_sim("--without", "di_wheel_drive,light_ring,power_management")
        lines = []
        for i in range(4):
            lines.append((i, f"608#{i:02X}0000000000"))
            lines += [(i + 0.1, f"602#{i:02X}00000000000000"), (i + 0.11, f"603#{i:02X}000000000000FF")]
        robot = self.start("replay", self.write_log(*lines), "--on-command")
        for line in robot.stderr:
            if "waiting for requests" in line:
                break
        self.assertIn("4 gyroscope", line)
        self.assertIn("4 odometry", line)
        listener = self.recording("out.log")
        self.run_tool("publish", "gyro", "100ms", "--priority", "high")
        self.recorded("out.log", 10)
        self.run_tool("stop", "gyro")
        self.run_tool("once", "odom", "--wait", "3s")
        self.assertIn("once: no accelerometer within 2s\n", self.run_tool("once", "accel", code=1)[1])
        self.run_tool("send", "208#07")
        self.settle()
        self.interrupt(listener)
        _, err = self.interrupt(robot)
        self.assertEqual(robot.returncode, 130)
        bus = self.lines("out.log")
        out = [line for line in bus if int(line[1][:3], 16) & 0x400]
        gyro = [line for line in out if line[1].startswith("508#")]
        # The samples of the log in turn, its first after its last, at the period that was asked for, from one request to
        # the other, however long a busy machine took between them.
        self.assertEqual([frame for _, frame in gyro], [f"508#{i % 4:02X}0000000000" for i in range(len(gyro))])
        began, ended = [at for at, frame in bus if int(frame[:3], 16) & 0x4FF == 0x008][:2]
        self.assertAlmostEqual(len(gyro), (ended - began) / 0.1, delta=1.5 + self.spare.slack / 0.1)
        gaps = [later - earlier for (earlier, _), (later, _) in zip(gyro, gyro[1:])]
        self.assertAlmostEqual(statistics.median(gaps), 0.1, delta=0.05)
        self.assertEqual([frame for _, frame in out[len(gyro):]], ["602#0000000000000000", "603#00000000000000FF"])
        self.assertIn("the log has no sample of it", err)
        self.assertIn(f" requests, {len(out)} frames sent, ", err)
        self.assertIn("1 request refused", err)
        self.assertIn("1 request for what was not recorded", err)
        self.interrupt(sim)

    def test_samples_that_are_due_often_come_as_often(self):
        sim = self.start_sim("--without", "di_wheel_drive,light_ring,power_management")
        robot = self.start("replay", self.write_log((0, "608#000000000000"), (1, "608#010000000000")), "--on-command")
        for line in robot.stderr:
            if "waiting for requests" in line:
                break
        listener = self.recording("out.log")
        self.run_tool("publish", "gyro", "20ms", "--priority", "high")
        self.recorded("out.log", 40)
        self.interrupt(listener)
        self.interrupt(robot)
        times = [time for time, frame in self.lines("out.log") if frame.startswith("508#")]
        self.assertLess(statistics.median(later - earlier for earlier, later in zip(times, times[1:])), 0.05)
        self.interrupt(sim)

    def test_a_simulator_that_goes(self):
        sim = self.start_sim()
        log = self.write_log(*[(i / 10, "608#00") for i in range(100)])
        self.recording("out.log")
        replay = self.start("replay", log)
        self.recorded("out.log", 2)
        self.interrupt(sim)
        _, err = replay.communicate(timeout=60)
        self.assertEqual(replay.returncode, 1)
        self.assertIn("sent ", err)
        self.assertIn("was ended", err)

    def test_a_damaged_log_is_played_and_told_of(self):
        self.start_sim()
        log = self.write_log((1, "608#01"), (1.01, "608#zz"), (1.02, "608#02"))
        out, err = self.replayed(log, code=1)
        self.assertEqual([frame for _, frame in out], ["608#01", "608#02"])
        self.assertIn("line 2", err)

    def test_a_drive_in_a_log_that_is_damaged_ends_with_zero(self):
        self.start_sim()
        log = self.write_log(*((1 + i / 1000, "201#50C3000000000000") for i in range(4000)))
        with open(log, "rb") as file:
            packed = gzip.compress(file.read())
        with open(self.path("cut.log.gz"), "wb") as file:
            file.write(packed[:len(packed) // 2])
        out, err = self.replayed(self.path("cut.log.gz"), "--speed", "max", code=1)
        self.assertEqual([frame for _, frame in out][-2:], ["201#50C3000000000000", "201#0000000000000000"])
        self.assertIn("cannot be read beyond", err)
        self.assertIn("the motors were set to zero", err)

    def test_a_travel_that_is_cut_short_is_ended(self):
        """A board travels without the program that has sent the set point."""
        self.start_sim()
        travel, end = "20B#50C300000000E803", "20B#0000000000000000"
        log = self.write_log((1, travel), (1.1, "608#01"), (9, "603#0000000000000000"))
        frames, err = self.replayed(log, "--until", "500ms")
        self.assertEqual([frame for _, frame in frames if frame.startswith("20B")], [travel, end])
        self.assertIn("travel was ended: the log goes on behind this", err)
        # One that the log itself ends, or that is played whole, is left as it is.
        log = self.write_log((1, travel), (1.1, end), (1.2, "608#01"), (9, "608#01"))
        frames, err = self.replayed(log, "--until", "500ms")
        self.assertEqual([frame for _, frame in frames if frame.startswith("20B")], [travel, end])
        self.assertNotIn("was ended", err)
        frames, err = self.replayed(self.write_log((1, travel), (1.1, "608#01")))
        self.assertEqual([frame for _, frame in frames if frame.startswith("20B")], [travel])
        self.run_tool("behave", "none")

    def test_a_drive_that_was_held_up_ends_with_zero_and_a_pause_goes_on(self):
        self.start_sim()
        drive = self.write_log(*((1 + i / 10, "201#50C3000000000000") for i in range(600)))
        recorder = self.recording("held.log")
        replay = self.start("replay", drive, "--loop", "2")  # the second pass is out of date, too
        self.recorded("held.log", 2)
        replay.send_signal(signal.SIGSTOP)
        time.sleep(2)  # longer than motors wait for a set point
        before = len(self.lines("held.log"))
        replay.send_signal(signal.SIGCONT)
        _, err = replay.communicate(timeout=60)
        self.settle()
        self.interrupt(recorder)
        self.assertEqual(replay.returncode, 1, err)
        self.assertRegex(err, r"sent \d+ frames in .*\namiroctl: replay: held up for \d+(\.\d+)?m?s, so it has ended\n {10}was it stopped")
        self.assertIn("the motors were set to zero: the log goes on behind this", err)
        behind = [frame for _, frame in self.lines("held.log")][before:]
        self.assertIn(behind, (["201#0000000000000000"], ["201#50C3000000000000", "201#0000000000000000"]))
        # What nothing commands goes on later.
        log = self.write_log((1, "608#01"), (2, "608#02"), (2.8, "608#03"))
        recorder = self.recording("paused.log")
        replay = self.start("replay", log)
        self.recorded("paused.log", 1)
        replay.send_signal(signal.SIGSTOP)
        time.sleep(2)  # the second is late
        replay.send_signal(signal.SIGCONT)
        _, err = replay.communicate(timeout=60)
        self.settle()
        self.interrupt(recorder)
        self.assertEqual(replay.returncode, 0, err)
        self.assertRegex(err, r"(?m)^sent 3 frames in \S+, [123] later than 1 ms, the latest by ([1-9]\d{2,}(\.\d+)?ms|[1-9]\d*(\.\d+)?s)$")
        times = [time for time, _ in self.lines("paused.log")]
        self.assertEqual(len(times), 3)
        self.assertGreater(times[2] - times[1], 0.79 - self.spare.slack)  # the second may have got there late

    def test_usage(self):
        log = self.write_log((1, "608#01"))
        for words, hint in ((("--speed", "0"), "max"), (("--speed", "fast"), "max"), (("--loop", "x"), "--loop 3"),
                            (("--interface", "can0"), "can0=vcan1"), (("gyrro",), "did you mean 'gyro'"),
                            (("--since", "2s", "--until", "1s"), "--until is before --since"),
                            (("--only", "both"), "sensors"), (("--dry-run", "--loop", "2"), "--loop")):
            _, err = self.run_tool("replay", log, *words, code=2)
            self.assertIn(hint, err)
        self.run_tool("replay", "-", "--loop", "2", code=2)
        _, err = self.run_tool("replay", self.path("none.log"), code=1)
        self.assertIn("none.log", err)
        _, err = self.run_tool("replay", log, "--on-command", code=1)
        self.assertIn("no sample of a sensor", err)


if __name__ == "__main__":
    main()
