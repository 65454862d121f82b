"""Requests, samples, set points and signals over a running simulator."""

import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import time

from harness import AMIROCTL, SOURCE, Case, main, waiting
from realtime import MOST_LATE

sys.path.insert(0, os.path.join(SOURCE, "tests", "peers", "logs"))
from virtual_bus import FRAME, GOODBYE, HELLO, MAGIC, OVERRUN, VERSION  # noqa: E402


class OnTheBus(Case):
    def test_the_main_job(self):
        self.start_sim()
        listener = self.listen("gyro", "-n", "3", "--timeout", "60s")
        _, err = self.run_tool("publish", "gyro", "100ms")
        self.assertEqual(err.splitlines(), ["bus: sim (the only one there is; --bus chooses)"])
        out, err = listener.communicate(timeout=60)
        self.assertEqual(listener.returncode, 0, err)
        samples = self.objects(out)
        self.assertEqual(len(samples), 3)
        for sample in samples:
            self.assertEqual(list(sample), "time_ns bus id priority topic frame fields units data".split())
            self.assertEqual(sample["topic"], "gyroscope")
            self.assertEqual(sample["id"], "608")
            self.assertEqual(sample["priority"], "medium")
            self.assertEqual(sample["units"], {"x": "deg/s", "y": "deg/s", "z": "deg/s"})
            raw = bytes.fromhex(sample["data"])
            x = int.from_bytes(raw[0:2], "little", signed=True)
            self.assertAlmostEqual(sample["fields"]["x"], x * 0.0175, places=9)
        times = [int(sample["time_ns"]) for sample in samples]
        # Bus time, not this machine's scheduling: the grid is exact up to the frames before.
        for earlier, later in zip(times, times[1:]):
            self.assertAlmostEqual(later - earlier, 100_000_000, delta=20_000_000)
        self.assertLess(abs(times[0] / 1e9 - time.time()), 60)

    def test_once_waits_and_shows(self):
        self.start_sim()
        sample, = self.objects(self.run_tool("once", "power")[0])
        self.assertEqual(sample["topic"], "power_status")
        frames = self.objects(self.run_tool("once", "ring", "--wait", "5s")[0])
        self.assertEqual(len(frames), 8)

    def test_once_in_each_format(self):
        self.start_sim("--frozen")
        out, _ = self.run_tool("once", "odom", "--csv")
        head, *lines = out.splitlines()
        self.assertEqual(head, "time,topic,field,value,unit")
        self.assertEqual([line.split(",")[1:] for line in lines],
                         [["odometry", *rest] for rest in (("velocity.x", "0", "m/s"), ("velocity.z", "0", "rad/s"), ("pose.x", "0", "m"),
                                                           ("pose.y", "0", "m"), ("pose.orientation", "0", "rad"))])
        for form in ("--json", "--pretty", "--csv"):  # nothing is near
            out, err = self.run_tool("once", "ring", form, "--field", "ring.sensor_4.distance", code=1)
            self.assertIn("once: proximity_ring came, and no field that was chosen has a value\n", err)
            self.assertLessEqual(len(out.splitlines()), 1 if form == "--csv" else 0)
        self.run_tool("publish", "ring", "100ms")
        _, err = self.run_tool("listen", "ring", "--field", "ring.sensor_4.distance", "--timeout", "2500ms")
        self.assertIn("listen: proximity_ring comes, and no field that was chosen has a value; ", err)
        out, _ = self.run_tool("once", "odom", "--csv", "--field", "odom.pose.x", "--field", "odom.pose.y")
        self.assertRegex(out, r"^time,odometry\.pose\.x,odometry\.pose\.y\n[0-9.]+,0,0\n$")
        out, _ = self.run_tool("once", "odom", "--raw")
        self.assertRegex(out, r"^\([0-9.]+\) sim 602#0{16}\n\([0-9.]+\) sim 603#0{16}\n$")
        out, _ = self.run_tool("once", "odom", "--pretty", "--field", "odom.pose")
        self.assertRegex(out, "medium +odometry +pose.x +0 m  pose.y +0 m  pose.orientation +0 rad\n$")
        velocity, = self.objects(self.run_tool("once", "odom", "--json", "--field", "odom.velocity")[0])
        self.assertEqual(velocity["fields"], {"x": 0, "z": 0})

    def test_once_asks_nothing_where_its_options_are_wrong(self):
        for options, words in ((("--field", "gyro.x"), "once: --field gyroscope.x, and what is asked is odometry\n          `amiroctl info odometry`"),
                               (("--field", "odom.speed"), "once: no field 'odom.speed'\n          one of: odom.velocity.x"),
                               (("--field", "odom.speed", "--dry-run"), "once: no field 'odom.speed'"),
                               (("--raw", "--field", "odom.pose"), "once: --field with --raw"),
                               (("--csv", "--json"), "once: --json and --csv exclude each other")):
            out, err = self.run_tool("once", "odom", *options, code=2)  # no bus is needed for that
            self.assertIn(words, err)
            self.assertEqual(out, "")

    def test_wait_fails_in_time_and_says_what_to_check(self):
        self.start_sim("--without", "power_management")
        begin = time.monotonic()
        _, err = self.run_tool("once", "power", "--wait", "300ms", code=1)
        self.assertLess(time.monotonic() - begin, 5)
        for word in ("no power_status within 300ms", "power_management", "500000"):
            self.assertIn(word, err)

    def test_a_sample_that_is_never_whole_or_of_another_length(self):
        self.start_sim("--without", "power_management")
        for frame, words in (("61F#0102", "of it came, and never all of a sample: does the bus lose frames? See `amiroctl doctor`"),
                             ("61F#01", "of it came in another length: does the robot run another protocol version?")):
            # It prints each frame, more than a pipe holds where programs start fast.
            asked = self.start("once", "ring", "--wait", "2s", "--no-confirm", stdout=subprocess.DEVNULL)
            while asked.poll() is None:
                self.run_tool("send", frame)
            _, err = asked.communicate(timeout=60)
            self.assertEqual(asked.returncode, 1)
            self.assertRegex(err, r"amiroctl: once: no proximity_ring within 2s\n +\d+ frames? " + re.escape(words))

    def test_formats(self):
        self.start_sim()
        self.run_tool("publish", "odom", "50ms")
        out, _ = self.run_tool("listen", "--csv", "-n", "4", "--timeout", "5s")
        lines = out.splitlines()
        self.assertEqual(lines[0], "time,topic,field,value,unit")
        self.assertIn(",odometry,velocity.x,", out)
        self.assertRegex(lines[1], r"^\d{10}\.\d{9},odometry,velocity\.x,-?[\d.]+,m/s$")
        out, _ = self.run_tool("listen", "--raw", "-n", "2", "--timeout", "5s")
        self.assertRegex(out.splitlines()[0], r"^\(\d{10}\.\d{6}\) sim 60[23]#[0-9A-F]{16}$")
        out, _ = self.run_tool("listen", "--pretty", "-n", "2", "--timeout", "5s")
        self.assertRegex(out.splitlines()[0], r"^ +0\.000000  medium  odometry +velocity\.x +-?[\d.]+ m/s")

    def test_commands_are_shown_when_asked_for(self):
        self.start_sim()
        listener = self.listen("--commands", "-n", "3", "--timeout", "60s")
        self.run_tool("stop", "mag")
        self.run_tool("publish", "gyro", "5s", "--priority", "high")
        out, _ = listener.communicate(timeout=60)
        stop, publish, sample = self.objects(out)
        self.assertEqual((stop["id"], stop["fields"]["mode"]), ("205", "stop"))
        self.assertEqual((publish["id"], publish["fields"]), ("108", {"mode": "publish", "period": 5}))
        self.assertEqual((sample["id"], sample["priority"]), ("508", "high"))

    def test_strict_tells_unknown_frames(self):
        self.start_sim()
        for strict, code in ((["--strict"], 1), ([], 0)):
            listener = self.listen("-n", "2", "--timeout", "60s", *strict)
            self.run_tool("send", "6F0#00")
            self.run_tool("send", "608#0000")
            _, err = listener.communicate(timeout=60)
            self.assertEqual(listener.returncode, code, err)
            self.assertIn("1 of unknown identifier", err)
            self.assertIn("1 of wrong length", err)

    def test_timeouts(self):
        self.start_sim()
        self.run_tool("listen", "--timeout", "200ms")
        self.run_tool("listen", "--idle-timeout", "200ms")
        self.run_tool("listen", "-n", "1", "--timeout", "200ms", code=1)

    def test_a_sensor_that_nobody_asked(self):
        self.start_sim()
        # Of a bus on which nothing comes the first one is named, but not where an identifier chooses.
        for words, hints in (((), ["a sensor is silent until it is asked, as by `amiroctl publish odometry 500ms`"]), (("--filter", "600:700"), [])):
            _, err = self.run_tool("listen", *words, "--timeout", "2100ms")
            self.assertEqual([line for line in err.splitlines() if "silent" in line], hints, err)
        self.run_tool("publish", "odom", "100ms")
        hint = "a sensor is silent until it is asked, as by `amiroctl publish gyroscope 500ms`"
        for words, told in ((("gyro",), True), (("--field", "gyro.z"), True), (("gyro", "--filter", "600:700"), True),
                            (("--sender", "di_wheel_drive", "--field", "gyro.z"), True), (("--field", "odom.x"), False), ((), False),
                            (("--filter", "600:700"), False), (("--where", "odom.velocity.x>100"), False)):
            with self.subTest(words=words):
                _, err = self.run_tool("listen", *words, "--timeout", "2100ms")
                self.assertEqual(hint in err, told, err)
                self.assertEqual("silent until it is asked" in err, told, err)  # nor of another sensor, that comes every 100 ms

    def test_after_two_seconds_of_silence_it_says_who_has_to_be_asked(self):
        self.start_sim()

        def heard_after():
            begin = time.monotonic()
            listener = self.listen("gyro")
            self.assertEqual(listener.stderr.readline(), "a sensor is silent until it is asked, as by `amiroctl publish gyroscope 500ms`\n")
            lasted = time.monotonic() - begin
            self.interrupt(listener)
            return lasted
        times = [heard_after()]
        while times[-1] >= 3 and len(times) < 5:  # a busy machine began late
            times.append(heard_after())
        self.assertGreaterEqual(times[-1], 2)
        self.assertLess(times[-1], 3, times)

    def test_ctrl_c_ends_listen_cleanly(self):
        self.start_sim()
        for number in (signal.SIGINT, signal.SIGTERM):
            listener = self.listen()
            _, err = self.interrupt(listener, number)
            self.assertEqual(listener.returncode, 128 + number)
            self.assertIn("0 frames, 0 samples", err)

    def test_ctrl_c_ends_send_of_lines_cleanly(self):
        self.start_sim()
        lines = "(1.000000) can0 6F0#00\n(4000.000000) can0 6F0#01\n"
        for arguments, text, sent in ((["--timed"], lines, "1 frame sent"), ([], "", "0 frames sent")):
            for number in (signal.SIGINT, signal.SIGTERM):
                with self.subTest(arguments=arguments, number=number):
                    sender = self.start("send", "--stdin", *arguments, stdin=subprocess.PIPE)
                    self.assertIn("bus: sim", sender.stderr.readline())
                    sender.stdin.write(text)
                    sender.stdin.flush()  # and stays open: there could be more
                    self.settle()
                    _, err = self.interrupt(sender, number)
                    self.assertEqual(sender.returncode, 128 + number, err)
                    self.assertIn(sent, err)

    def test_listen_survives_the_simulator_by_telling(self):
        sim = self.start_sim()
        listener = self.listen()
        self.interrupt(sim)
        _, err = listener.communicate(timeout=60)
        self.assertEqual(listener.returncode, 1)
        self.assertIn("sim", err)

    def test_a_reader_that_goes_away_ends_listen(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "10ms")
        pipe = subprocess.Popen(f"'{AMIROCTL}' listen --json | head -2", shell=True, text=True, env=self.environment,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        out, _ = pipe.communicate(timeout=60)
        self.assertEqual(len(self.objects(out)), 2)

    def test_a_full_disk_is_told(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "10ms")
        with open("/dev/full", "w", encoding="utf-8") as full:
            result = subprocess.run([AMIROCTL, "listen", "--json"], env=self.environment, stdout=full, text=True,
                                    stderr=subprocess.PIPE, timeout=60)
        self.assertEqual(result.returncode, 1)
        self.assertIn("No space left", result.stderr)

    def test_ctrl_c_stops_the_motors(self):
        self.start_sim()
        listener = self.listen("motors", "--timeout", "20s")
        drive = self.start("drive", "5cm/s")
        self.assertIn("50C3000000000000", listener.stdout.readline())
        self.interrupt(drive)
        self.assertEqual(drive.returncode, 130)
        self.settle()
        out, _ = self.interrupt(listener)
        self.assertEqual(self.objects(out)[-1]["data"], "0000000000000000")

    def test_every_end_of_a_drive_stops_the_motors(self):
        """A terminal that is closed, ssh that is gone, Ctrl-\\: as Ctrl-C."""
        self.start_sim()
        script = os.path.join(self.folder, "drive.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s drive 5cm/s\n20s stop\n")
        for command in (("drive", "5cm/s"), ("run", script)):
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
                listener = self.listen("motors", "--timeout", "20s")
                drive = self.start(*command)
                self.assertIn("50C3000000000000", listener.stdout.readline())
                _, err = self.interrupt(drive, number)
                self.assertEqual(drive.returncode, 128 + number, (command, number, err))
                self.settle()
                out, _ = self.interrupt(listener)
                self.assertEqual(self.objects(out)[-1]["data"], "0000000000000000", (command, number))

    def test_a_drive_that_was_stopped_does_not_go_on(self):
        self.start_sim()
        # A second or more: what is done while it is stopped takes as long as it takes.
        did_not_run = r"drive: this program did not run for ([1-9]\d*(\.\d+)?s|\d{4,}ms), so the drive has ended; the motors were set to zero"
        for stopped, words in ((False, did_not_run), (True, "another program has set the motors to zero|" + did_not_run)):
            listener = self.listen("motors", "--timeout", "20s")
            drive = self.start("drive", "5cm/s")
            self.assertIn("50C3000000000000", listener.stdout.readline())
            drive.send_signal(signal.SIGSTOP)
            time.sleep(1.2)  # longer than a drive may be stopped
            if stopped:
                self.run_tool("stop")
            drive.send_signal(signal.SIGCONT)
            _, err = drive.communicate(timeout=60)
            self.assertEqual(drive.returncode, 1)
            self.assertRegex(err, words)
            self.settle()
            out, _ = self.interrupt(listener)
            frames = [line["data"] for line in self.objects(out)]
            rest = frames.index("0000000000000000")
            self.assertEqual(set(frames[rest:]), {"0000000000000000"}, "it drove on")

    def test_a_bus_that_stands_still(self):
        """The simulator is stopped: its socket takes frames that are never read."""
        sim = self.start_sim()
        listener = self.listen("motors", "--timeout", "20s")
        drive = self.start("drive", "5cm/s")
        self.assertIn("50C3000000000000", listener.stdout.readline())
        self.settle()
        sim.send_signal(signal.SIGSTOP)
        _, err = drive.communicate(timeout=60)
        self.assertEqual(drive.returncode, 1)
        self.assertIn("no set point has left sim for ", err)
        self.assertIn("the simulator takes none: was it stopped (Ctrl-Z; `fg` lets it go on)", err)
        self.assertIn("THE ROBOT MAY STILL MOVE", err)
        sim.send_signal(signal.SIGCONT)

    def test_a_simulator_that_is_stopped_is_no_quiet_bus(self):
        sim = self.start_sim()
        log = os.path.join(self.folder, "a.log")
        # So long that none of them ends before all have begun.
        verbs = [self.start(*verb) for verb in (["listen", "--timeout", "10s"], ["stats", "--duration", "10s"],
                                                ["record", "-o", log, "--duration", "10s"])]
        for verb in verbs:
            self.assertIn("bus: sim", verb.stderr.readline())
        self.settle()
        sim.send_signal(signal.SIGSTOP)
        for verb in verbs:
            _, err = verb.communicate(timeout=60)
            self.assertEqual(verb.returncode, 1, err)
            self.assertRegex(err, r"amiroctl: the simulator( \(process \d+\))? does not answer")
            self.assertIn("it may be stopped (Ctrl-Z)", err)
        sim.send_signal(signal.SIGCONT)
        self.run_tool("listen", "--timeout", "100ms")

    def test_what_listen_was_too_slow_for_is_counted(self):
        """The simulator is played: it says of how many frames it had no room."""
        os.makedirs(os.path.join(self.folder, "ocm"), mode=0o700)
        path = os.path.join(self.folder, "ocm", "sim.sock")
        server = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.addCleanup(server.close)
        server.bind(path)
        os.chmod(path, 0o600)
        server.listen()
        server.settimeout(60)
        listener = self.start("--bus", "sim", "listen", "--raw")
        node, _ = server.accept()
        self.addCleanup(node.close)
        node.send(struct.pack("<B3xIIII12s", HELLO, MAGIC, VERSION, 500_000, 64, b"sim"))
        self.assertEqual(listener.stderr.readline(), "bus: sim\n")
        self.settle()
        for lost in (3, 4):
            node.send(struct.pack("<BBBxIq8s8x", FRAME, 0, 2, 0x7FF, time.time_ns(), b"\xDE\xAD"))
            node.send(struct.pack("<B7xQ16x", OVERRUN, lost))
        node.send(struct.pack("<BB2xI24x", GOODBYE, 1, VERSION))
        out, err = listener.communicate(timeout=60)
        self.assertEqual(listener.returncode, 1)
        self.assertEqual([line.split()[2] for line in out.splitlines()], ["7FF#DEAD"] * 2)
        self.assertIn("2 frames, 0 samples, 2 of unknown identifier, 7 lost in the receive queue\n", err)
        self.assertIn("\n2 of 2 frames are of no topic of AMiRo: another robot? --spec FILE names the topics of another robot\n", err)

    def test_the_robot_moves_and_its_watchdog_stops_it(self):
        self.start_sim()
        self.run_tool("publish", "odom", "50ms")
        listener = self.listen("odom", "--timeout", "20s")
        self.run_tool("drive", "10cm/s", "--once")
        seen = []
        for line in listener.stdout:
            fields = json.loads(line)["fields"]
            if "x" in fields:  # the second of its two frames has the pose
                seen.append(fields["x"])
            if len(seen) > 7 and seen[-1] > 0.02 and seen[-1] - seen[-7] < 0.001:  # it rests for 0.3 s
                break
        self.interrupt(listener)
        self.assertGreater(seen[-1], 0.02)
        self.assertLess(seen[-1], 0.1)

    def test_a_second_simulator_is_refused(self):
        first = self.start_sim()
        _, err = self.run_tool("sim", code=1)
        self.assertIn(str(first.pid), err)
        self.run_tool("once", "gyro", "--wait")

    def test_a_killed_simulator_leaves_nothing_in_the_way(self):
        first = self.start_sim()
        first.kill()
        first.wait()
        self.refused = self.run_tool("once", "gyro", code=1)
        self.start("sim")
        waiting.until(lambda: subprocess.run([AMIROCTL, "once", "gyro"], env=self.environment, capture_output=True).returncode == 0,
                      "a new simulator can be reached", 60)

    def test_the_same_seed_gives_the_same_robot(self):
        values = []
        for seed in ("7", "7", "8"):
            sim = self.start_sim("--seed", seed, "--frozen")
            out, _ = self.run_tool("once", "gyro", "--wait")
            values.append(self.objects(out)[0]["data"])
            self.interrupt(sim)
        self.assertEqual(values[0], values[1])

    def test_interference_costs_time_and_no_sample(self):
        """Frames that are disturbed come again; listeners get each error frame."""
        sim = self.start_sim("--bus-errors", "400", "--seed", "3")
        self.run_tool("publish", "gyro", "5ms")  # some ten of 200 frames are hit
        out, err = self.run_tool("listen", "--json", "--timeout", "1s")
        errors = [frame for frame in self.objects(out) if frame.get("error", "").startswith("error frame")]
        self.assertGreater(len(errors), 100)
        times = [int(sample["time_ns"]) for sample in self.objects(out) if sample.get("topic") == "gyroscope"]
        self.assertGreater(len(times), 100)  # of 200, and of more where it ran for longer
        self.assertAlmostEqual((times[-1] - times[0]) / 5e6, len(times) - 1, delta=2 + self.spare.slack / 5e-3)  # the first or the last one held up
        self.assertNotIn("incomplete", err)
        self.interrupt(sim)
        told = re.search(r"(\d+) error frames, (\d+) frames repeated", sim.communicate()[1])
        self.assertGreater(int(told[1]), len(errors))
        self.assertGreater(int(told[2]), 0)

    def test_a_real_bus_has_errors_of_its_own(self):
        for option, value in (("--bus-errors", "1"), ("--speed", "10"), ("--bitrate", "500k"), ("--data-bitrate", "2M")):
            _, err = self.run_tool("sim", "--bus", "can0", option, value, code=2)
            self.assertIn(f"sim: {option} with --bus can0\n          leave one out: it is for the virtual bus\n", err)


class InTime(Case):
    """What is repeated each 100 ms, and what comes within 100 ms of its time: who was held up for so long was late."""

    most_late = MOST_LATE

    def test_drive_repeats_and_ends_with_zero(self):
        self.start_sim()
        listener = self.listen("motors", "odom", "--timeout", "20s")
        self.run_tool("drive", "5cm/s", "--for", "550ms")
        self.settle()
        out, _ = self.interrupt(listener)
        frames = [line["data"] for line in self.objects(out)]
        self.assertEqual(frames[-1], "0000000000000000")
        self.assertEqual(set(frames[:-1]), {"50C3000000000000"})
        self.assertIn(len(frames), (5, 6, 7))  # at 0, 100, ... 500 ms, and the zero; fewer only under load

    def test_without_a_speed_steps_come_as_they_are_written(self):
        self.start_sim()
        listener = self.listen("--commands", "led", "--timeout", "20s")
        self.run_tool("run", self.script("0s led 1 red\n300ms led 2 red\n"), "--no-confirm")
        self.settle()
        out, _ = self.interrupt(listener)
        first, second = (int(frame["time_ns"]) for frame in self.objects(out))
        self.assertAlmostEqual((second - first) / 1e9, 0.3, delta=0.1)

    def test_steps_come_at_their_times(self):
        self.start_sim()
        listener = self.listen("--commands", "led", "motors", "--timeout", "20s")
        path = self.script("0s led 1 red\n5s led 2 red\n10s drive 5cm/s\n13s drive stop\n15s led 3 red\n")
        self.run_tool("run", path, "--speed", "10")
        self.settle()
        out, _ = self.interrupt(listener)
        frames = self.objects(out)
        start = int(frames[0]["time_ns"])
        at = {frame["topic"]: (int(frame["time_ns"]) - start) / 1e9 for frame in frames if frame["topic"] != "motors"}
        self.assertAlmostEqual(at["led_2"], 0.5, delta=0.1)
        self.assertAlmostEqual(at["led_3"], 1.5, delta=0.1)
        motors = [frame["data"] for frame in frames if frame["topic"] == "motors"]
        # Repeated at 100 and 200 ms; a machine under load may be too late for one, and for the stop, on which a third
        # repeat falls.
        self.assertIn(motors.count("50C3000000000000"), (2, 3, 4))
        self.assertEqual(motors[-1], "0000000000000000")
        self.assertEqual(motors.count("0000000000000000"), 1)


class Library(Case):
    def test_the_operator_of_the_examples(self):
        self.start_sim()
        listener = self.listen("gyro", "--commands", "--timeout", "20s")
        result = subprocess.run([os.environ["EXAMPLE_OPERATOR"]], env=self.environment, text=True, capture_output=True,
                                timeout=60)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(result.stdout.splitlines()), 5)
        self.settle()
        out, _ = self.interrupt(listener)
        ids = [frame["id"] for frame in self.objects(out)]
        self.assertEqual((ids[0], ids.count("508"), ids[-1]), ("108", 5, "208"))

    def test_the_board_of_the_examples_takes_the_place_of_a_simulated_one(self):
        sim = self.start_sim("--without", "di_wheel_drive")
        board = waiting.Program([os.environ["EXAMPLE_BOARD"]], env=self.environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self._started.append(board)
        self.settle()  # it is on the bus
        self.run_tool("publish", "accel", "20ms")
        listener = self.listen("accel", "-n", "1", "--where", "accel.x>0")
        drive = self.start("drive", "5cm/s")
        out, _ = listener.communicate(timeout=60)
        self.interrupt(drive)
        self.assertEqual([sample["data"][:4] for sample in self.objects(out)], ["3200"])  # 50, from the set point
        _, err = self.run_tool("publish", "gyro", "20ms", code=1)
        self.assertIn("di_wheel_drive refuses gyroscope: not_served", err)
        self.interrupt(sim)
        out, err = board.communicate(timeout=60)  # it sees that the bus is gone
        self.assertEqual((board.returncode, err), (0, ""))
        speeds = out.split("\n")
        self.assertEqual((speeds[0], speeds[-2:]), ("0.050 m/s", ["0.000 m/s", ""]))

    def test_the_examples_say_what_to_do_without_a_robot(self):
        for program in ("EXAMPLE_OPERATOR", "EXAMPLE_BOARD"):
            result = subprocess.run([os.environ[program]], env=self.environment, text=True, capture_output=True, timeout=20)
            self.assertEqual(result.returncode, 1)
            self.assertIn("no simulator is running", result.stderr)


class Several(Case):
    def test_several_buses_are_for_record(self):
        for buses in ("can0,can1", "sim,sim:/nowhere"):
            _, err = self.run_tool("--bus", buses, "listen", code=1)
            self.assertIn(f"amiroctl: '{buses}' are several buses\n          only record takes several: name one\n", err)


class Scripts(Case):
    def test_a_script_is_checked_whole_before_anything_is_sent(self):
        self.start_sim()
        listener = self.listen("--commands", "--timeout", "20s")
        path = self.script("0s publish gyro 1s\n1s publish gyr 1s\n2s led 9 red\n")
        _, err = self.run_tool("run", path, code=2)
        self.assertIn(f"{path}:2:12: no topic 'gyr'", err)
        self.assertIn(f"{path}:3:8: no LED '9'", err)
        out, _ = self.interrupt(listener)
        self.assertEqual(out, "")

    def test_dry_run(self):
        out, _ = self.run_tool("run", os.path.join(SOURCE, "examples", "standalone.script"), "--dry-run")
        self.assertEqual(len(out.splitlines()), 21)
        self.assertEqual(out.splitlines()[0].split(), ["1s", "209#01F40100"])

    def test_standard_input_and_interrupt(self):
        self.start_sim()
        listener = self.listen("motors", "--timeout", "20s")
        self.run_tool("run", "-", stdin="0s drive 5cm/s --for 200ms\n")
        path = self.script("0s drive 5cm/s\n60s drive stop\n")
        while "0000000000000000" not in listener.stdout.readline():  # the first has ended
            pass
        run = self.start("run", path)
        self.assertIn("50C3000000000000", listener.stdout.readline())
        self.interrupt(run)
        self.assertEqual(run.returncode, 130)
        self.settle()
        out, _ = self.interrupt(listener)
        self.assertEqual(self.objects(out)[-1]["data"], "0000000000000000")

    def test_a_step_in_centuries_is_waited_for(self):
        self.start_sim()
        for speed, late in (("0.001", "3000h"), ("0.5", f"{1 << 62}ns")):  # 2^63 ns are the first that no clock has
            listener = self.listen("--commands", "--timeout", "60s")
            run = self.start("run", "--speed", speed, self.script(f"0s led 1 red\n{late} led 2 green\n"))
            self.assertIn("FF0000", listener.stdout.readline())
            self.settle()  # it waits
            _, err = self.interrupt(run)
            self.assertEqual(run.returncode, 130, err)
            self.assertNotIn("green", err)
            self.interrupt(listener)

    def test_what_was_sent_is_counted_also_where_the_bus_goes(self):
        sim = self.start_sim()
        listener = self.listen("--commands", "--timeout", "60s")
        send = self.start("send", "--stdin", "--timed", stdin=subprocess.PIPE)
        send.stdin.write("(1.0) sim 201#0100000000000000\n(2.5) sim 201#0000000000000000\n")
        send.stdin.flush()
        self.assertIn("0100000000000000", listener.stdout.readline())
        self.interrupt(sim)
        _, err = send.communicate(timeout=60)
        self.assertEqual(send.returncode, 1, err)
        self.assertIn("\n1 frame sent\n", err)

    def test_it_shows_what_sensors_answer_and_no_commands(self):
        self.start_sim()
        run = self.start("run", self.script("0s publish gyro 100ms\n60s stop\n"), "--show")
        shown = [run.stdout.readline()]
        # Of another program: a request, and a set point of an LED.
        self.run_tool("publish", "odom", "100ms")
        self.run_tool("led", "1", "red", "--no-confirm")
        while len(shown) < 100 and '"odometry"' not in shown[-1]:
            shown.append(run.stdout.readline())
        shown += self.interrupt(run)[0].splitlines()
        topics = {line["topic"] for line in self.objects("\n".join(line.strip() for line in shown))}
        self.assertEqual(topics, {"gyroscope", "odometry"})

    def test_a_script_ends_at_once_where_all_answers_are_shown(self):
        """The reader of its output has a second for what waits, and nothing does."""
        self.start_sim()
        script = self.script("0s led 1 red\n")

        def lasts():
            begin = time.monotonic()
            self.run_tool("run", script, "--show", "--no-confirm")
            return time.monotonic() - begin
        self.assertLess(min(lasts() for _ in range(3)), 1)

    def test_a_script_of_16_mib_and_one_byte_more(self):
        line, most = "0s led 1 red\n#", 16 << 20
        out, _ = self.run_tool("run", self.script(line + "x" * (most - len(line))), "--dry-run")
        self.assertEqual(out.split(), ["0s", "23C#FF0000"])
        _, err = self.run_tool("run", self.script(line + "x" * (most + 1 - len(line))), "--dry-run", code=1)
        self.assertIn("larger than 16 MiB", err)

    def test_what_is_no_script(self):
        _, err = self.run_tool("run", self.script("0s led 1 red\n0s led\0 1 red\n"), "--dry-run", code=2)
        self.assertRegex(err, r"^amiroctl: run: \S* is no text: line 2 has a byte of zero\n +a script has one command a line\n$")

        _, err = self.run_tool("run", "-", "--dry-run", stdin="\0", code=2)
        self.assertIn("amiroctl: run: the standard input is no text: line 1", err)

    def test_a_missing_script(self):
        _, err = self.run_tool("run", os.path.join(self.folder, "none.script"), code=1)
        self.assertIn("none.script", err)
        _, err = self.run_tool("run", self.folder, code=1)
        self.assertIn(f"cannot read {self.folder}: Is a directory", err)
        folder = os.open(self.folder, os.O_RDONLY)
        self.addCleanup(os.close, folder)
        run = subprocess.run([AMIROCTL, "run", "-"], stdin=folder, env=self.environment, text=True, timeout=30, check=False, capture_output=True)
        self.assertEqual((run.returncode, run.stderr), (1, "amiroctl: cannot read the standard input: Is a directory\n"
                                                           "          give the name of a script, or - for standard input\n"))
        _, err = self.run_tool("run", "/dev/zero", code=1)
        self.assertIn("larger than 16 MiB", err)


if __name__ == "__main__":
    main()
