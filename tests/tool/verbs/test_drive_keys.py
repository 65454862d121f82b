"""amiroctl drive --keys: a person's keys on a pseudo terminal, and the set points that a listener hears."""

import fcntl
import json
import os
import pathlib
import pty
import select
import signal
import struct
import subprocess
import termios
import time

import harness
from realtime import MOST_LATE

REST = "0000000000000000"
UP, LEFT = b"\x1b[A", b"\x1b[D"


class Keys(harness.Case):
    # A key is held for 250 ms behind its last repetition, and set points come each 100 ms.
    most_late = MOST_LATE

    def setUp(self):
        super().setUp()
        self.start_sim("--frozen")
        self.listener = self.listen("motors", "--commands")

    def drive(self, *arguments, term="xterm", stdout=None, columns=100, begins=b"rests"):
        """Returns when it takes keys, if it shows them on the terminal."""
        primary, secondary = pty.openpty()
        fcntl.ioctl(secondary, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        self.before = termios.tcgetattr(secondary)
        process = harness.waiting.Program([harness.AMIROCTL, "drive", "--keys", *arguments], stdin=secondary,
                                          stdout=secondary if stdout is None else stdout, stderr=subprocess.PIPE, text=True,
                                          start_new_session=True, env={**self.environment, "TERM": term})
        self._started.append(process)
        self.process, self.secondary, self.primary = process, secondary, primary
        self.addCleanup(self.close)
        self.shown = b""
        if stdout is None:
            self.shows(begins)
        return process

    def close(self):
        for descriptor in (self.primary, self.secondary):
            if descriptor is not None:
                os.close(descriptor)
        self.primary = self.secondary = None

    def shows(self, text):
        while text not in self.shown:
            ended = self.process.poll() is not None
            if select.select([self.primary], [], [], 30 if ended else 0.1)[0]:  # what it wrote last may still be on its way
                self.shown += os.read(self.primary, 4096)
            elif ended:
                self.fail(f"{text} was not shown: {self.process.communicate()[1]}")
        before, _, self.shown = self.shown.partition(text)
        return before

    def next_line(self):
        """What it draws next, up to what it says of its keys."""
        return self.shows(b"   arrows drive").rpartition(b"\x1b[K")[2]

    def hold(self, key, seconds):
        """As a terminal does: at once, after half a second, and then 25 times a second."""
        end = time.monotonic() + seconds
        os.write(self.primary, key)
        time.sleep(min(0.5, seconds))  # what a terminal waits before it repeats a key
        while time.monotonic() < end:
            os.write(self.primary, key)
            time.sleep(0.04)

    def set_points(self, process, code=0):
        """All that were sent, once it has ended."""
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, code, said)
        self.settle()
        out, _ = self.interrupt(self.listener)
        return [(int(each["time_ns"]) / 1e9, each["data"]) for each in self.objects(out)], said

    def test_it_waits_between_two_looks_at_the_keys(self):
        process = self.drive()
        before, waits = self.processor_time(process), self.waits(process)
        time.sleep(1)  # over which its processor time is taken
        self.assertLess(self.processor_time(process) - before, 0.3)  # without a wait it is all there is
        self.assertLess(self.waits(process) - waits, 500)  # it looks fifty times a second
        while select.select([self.primary], [], [], 0)[0]:
            self.shown += os.read(self.primary, 4096)
        self.assertNotIn(b"\x1b[K", self.shown)  # nothing has changed, so that nothing is drawn
        os.write(self.primary, b"q")
        self.set_points(process)

    @staticmethod
    def processor_time(process):
        with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    @staticmethod
    def waits(process):
        """How often it has waited so far."""
        with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
            return next(int(line.split()[1]) for line in file if line.startswith("voluntary_ctxt_switches:"))

    def test_drives_while_a_key_is_held(self):
        process = self.drive()
        begin = time.time()
        self.hold(UP, 1.5)
        released = time.time()
        self.shows(b"forward")
        self.shows(b"rests")
        os.write(self.primary, b"q")
        points, _ = self.set_points(process)
        moving = [(at, data) for at, data in points if data != REST]
        self.assertEqual({data for _, data in moving}, {"A086010000000000"})  # 100,000 um/s
        self.assertLess(moving[0][0], begin + 0.3)
        self.assertGreater(moving[-1][0], released - 0.3)
        self.assertGreaterEqual(len(moving), 12)  # ten a second
        rest = next(at for at, data in points if data == REST)
        self.assertLess(rest, released + 0.7)  # 250 ms, on a machine that may be busy
        self.assertEqual(points[-1][1], REST)

    def test_many_keys_at_once(self):
        # What a slow line has held up: more than one look reads, so that a sequence is cut.
        process = self.drive()
        os.write(self.primary, UP * 40)
        self.shows(b"forward")
        self.shows(b"rests")
        os.write(self.primary, b"\x1b[1;2q" * 11)  # cut behind 64 bytes, within a sequence: its q is no key
        os.write(self.primary, LEFT[:2])  # its end never comes
        os.write(self.primary, LEFT)
        self.shows(b"left")
        self.assertIsNone(process.poll())
        os.write(self.primary, b"\x1b")  # the key itself quits
        points, _ = self.set_points(process)
        self.assertEqual(points[-1][1], REST)

    def test_the_terminal_is_set_back_while_it_was_stopped(self):
        # As a shell does behind Ctrl-Z and fg.
        process = self.drive()
        process.send_signal(signal.SIGSTOP)
        termios.tcsetattr(self.secondary, termios.TCSANOW, self.before)
        time.sleep(0.7)  # longer than the motors wait for a set point: while it rests that is no matter
        process.send_signal(signal.SIGCONT)
        self.hold(UP, 1)
        self.shows(b"forward")
        os.write(self.primary, b" ")
        self.shows(b"stop")
        os.write(self.primary, b"q")
        points, _ = self.set_points(process)
        self.assertEqual(points[-1][1], REST)

    def test_two_directions_and_space(self):
        process = self.drive("20cm/s", "90deg/s")
        os.write(self.primary, b"u")
        self.shows(b"forward, left")
        pressed = time.time()
        os.write(self.primary, b" ")
        self.shows(b"stop")
        os.write(self.primary, b"+")
        self.shows(b"25cm/s 112deg/s")
        os.write(self.primary, LEFT)
        self.shows(b"left")
        os.write(self.primary, b"\x04")
        points, _ = self.set_points(process)
        self.assertEqual([points[0][1][:8], points[-1][1]], ["400D0300", REST])
        rest = next(at for at, data in points if data == REST)
        self.assertLess(rest, pressed + 0.3)  # at once, not after the wait for a repetition
        self.assertTrue(any(data.startswith("00000000") and data != REST for _, data in points))

    def test_no_faster_than_the_spec_allows(self):
        process = self.drive("90cm/s")
        os.write(self.primary, b"+")
        self.shows(b"no faster")
        os.write(self.primary, b"-i")
        self.shows(b"72cm/s 36deg/s  forward")
        os.write(self.primary, b"q")
        points, _ = self.set_points(process)
        self.assertEqual({data[:8] for _, data in points if data != REST}, {"80FC0A00"})  # 720,000 um/s

    def test_speeds_up_to_the_limits_of_the_spec(self):
        """1 m/s and 28.985507 rad/s; what is typed is sent as it is."""
        process = self.drive("100cm/s", "28.9rad/s")
        os.write(self.primary, LEFT)
        self.shows(b"left")
        os.write(self.primary, b"q")
        process.communicate(timeout=60)
        for speeds in (("101cm/s",), ("10cm/s", "29rad/s")):
            _, err = self.run_tool("drive", "--keys", *speeds, code=2)
            self.assertIn(f"drive: --keys: '{speeds[-1]}' is out of range", err)

    def test_a_robot_that_goes_back_more_slowly(self):
        with open(os.path.join(harness.SOURCE, "spec", "topics.json"), encoding="utf-8") as file:
            spec = json.load(file)
        motors, = (topic for topic in spec["topics"] if topic["name"] == "motors")
        motors["frames"][0]["fields"][0]["range"] = [-0.2, 1]
        path = os.path.join(self.folder, "slow.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(spec, file)
        _, err = self.run_tool("--spec", path, "drive", "--keys", "50cm/s", code=2)
        self.assertIn("drive: --keys: '-50cm/s' is out of range: x takes -0.2 to 1 m/s", err)
        process = self.drive("18cm/s", "--spec", path)
        os.write(self.primary, b"+")
        self.shows(b"no faster")
        os.write(self.primary, b"q")
        process.communicate(timeout=60)

    def test_a_limit_of_one_direction_counts(self):
        with open(os.path.join(harness.SOURCE, "spec", "topics.json"), encoding="utf-8") as file:
            spec = json.load(file)
        motors, = (topic for topic in spec["topics"] if topic["name"] == "motors")
        fields = motors["frames"][0]["fields"]
        path = os.path.join(self.folder, "one_way.json")
        for field, limits, what in ((0, [-1, 0.2], "50cm/s"), (0, [-0.2, 1], "-50cm/s"),
                                    (1, [-1, 0.5], "45deg/s"), (1, [-0.5, 1], "-45deg/s")):
            with self.subTest(what=what):
                fields[0]["range"], fields[1]["range"] = [-1, 1], [-1, 1]
                fields[field]["range"] = limits
                with open(path, "w", encoding="utf-8") as file:
                    json.dump(spec, file)
                _, err = self.run_tool("--spec", path, "drive", "--keys", "50cm/s", "45deg/s", code=2)
                self.assertIn(f"drive: --keys: '{what}' is out of range", err)

    def test_what_a_key_has_done_is_shown_until_it_drives(self):
        process = self.drive()
        self.next_line()  # the end of the first one
        os.write(self.primary, b" ")
        self.assertEqual(self.next_line(), b"10cm/s 45deg/s  stop")
        os.write(self.primary, UP)
        self.assertEqual(self.next_line(), b"10cm/s 45deg/s  forward")
        self.assertEqual(self.next_line(), b"10cm/s 45deg/s  rests")
        os.write(self.primary, b"q")
        self.set_points(process)

    def test_its_last_line_says_that_it_rests(self):
        process = self.drive()
        os.write(self.primary, UP)
        self.shows(b"forward")
        os.write(self.primary, b"q")
        self.shows(b"  rests")
        process.communicate(timeout=60)

    def test_its_keys_are_shown_where_the_line_has_room_for_them(self):
        words = b"   arrows drive, space stops, + - speed, q quits"
        line = b"10cm/s 45deg/s  rests"
        needed = len(line + words) + 1  # the last column stays free
        for columns in (needed, needed - 1, len(line) + 1):
            with self.subTest(columns=columns):
                process = self.drive(columns=columns)
                if columns == needed:
                    self.shows(words)
                os.write(self.primary, b"q")
                while b"  rests\r\n" not in self.shown and select.select([self.primary], [], [], 30)[0]:
                    self.shown += os.read(self.primary, 4096)
                self.assertIn(b"  rests\r\n", self.shown)
                process.communicate(timeout=60)
                self.assertNotIn(b"arrows", self.shown)  # no more, or not at all
                self.close()

    def test_a_line_that_is_wider_than_the_terminal_is_cut(self):
        process = self.drive(columns=len("10cm/s 45deg/s  rests"), begins=b"10cm/s 45deg/s  rest")
        os.write(self.primary, b"q")
        self.shows(b"\x1b[K10cm/s 45deg/s  rest\r\n")  # the last column stays free
        process.communicate(timeout=60)

    def test_a_default_of_what_drives_keeps_no_stop_from_being_sent(self):
        for option, value in (("--keys", "true"), ("--gamepad", "/dev/null")):
            with self.subTest(option=option):
                name = "AMIROCTL_" + option[2:].upper()
                self.environment[name] = value
                self.listener = self.listen("motors", "--commands")
                self.run_tool("drive", "stop")
                self.settle()
                out, _ = self.interrupt(self.listener)
                self.assertEqual([sample["data"] for sample in self.objects(out)], [REST])
                del self.environment[name]
                # What is typed is meant.
                _, said = self.run_tool("drive", "stop", option, *(() if value == "true" else (value,)), code=2)
                self.assertIn("'stop' is no speed", said)

    def test_every_end_rests_the_motors(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            with self.subTest(signal=number):
                self.listener = self.listen("motors", "--commands")
                process = self.drive()
                os.write(self.primary, UP)
                self.shows(b"forward")
                process.send_signal(number)
                points, _ = self.set_points(process, 128 + number)
                self.assertEqual(termios.tcgetattr(self.secondary), self.before)
                self.assertEqual(points[-1][1], REST)
                # Its last line stays, but where the terminal is said to be gone.
                if number != signal.SIGHUP:
                    self.shows(b"  rests\r\n")
                else:
                    while select.select([self.primary], [], [], 0)[0]:
                        self.shown += os.read(self.primary, 4096)
                    self.assertNotIn(b"  rests\r\n", self.shown)
                self.close()

    def test_a_terminal_that_is_gone(self):
        process = self.drive()
        os.write(self.primary, UP)
        self.shows(b"forward")
        self.close()
        _, said = process.communicate(timeout=60)
        self.assertNotEqual(process.returncode, 0, said)
        self.settle()
        out, _ = self.interrupt(self.listener)
        self.assertEqual(self.objects(out)[-1]["data"], REST)

    def test_a_terminal_without_control_sequences_gets_lines(self):
        process = self.drive(term="dumb")
        os.write(self.primary, UP)
        self.shows(b"forward")
        os.write(self.primary, b"q")
        said = self.shown
        while process.poll() is None or select.select([self.primary], [], [], 0)[0]:
            if select.select([self.primary], [], [], 0.05)[0]:
                said += os.read(self.primary, 4096)
        self.assertEqual(process.returncode, 0, process.communicate()[1])
        self.assertNotIn(b"\x1b", said)
        self.assertNotIn(b"\r ", said)

    def test_a_file_gets_lines(self):
        path = os.path.join(self.folder, "keys.txt")
        with open(path, "wb") as file:
            process = self.drive(stdout=file)

        def lines():
            with open(path, encoding="utf-8") as file:
                return file.read()
        harness.waiting.until(lambda: "rests" in lines(), "its first line")
        os.write(self.primary, UP)
        harness.waiting.until(lambda: "forward" in lines(), "that it drives")
        os.write(self.primary, b"q")
        process.communicate(timeout=60)
        self.assertNotIn("\x1b", lines())
        self.assertNotIn("\r", lines())
        self.assertGreaterEqual(lines().count("\n"), 3)
        self.assertTrue(lines().endswith("rests\n"), lines())

    def test_a_terminal_that_is_gone_beside_a_file(self):
        """It is not told by a signal, and its output can still be written."""
        with open(os.path.join(self.folder, "keys.txt"), "wb") as file:
            process = self.drive(stdout=file)
        harness.waiting.until(lambda: os.path.getsize(file.name), "its first line")
        os.write(self.primary, UP)
        harness.waiting.until(lambda: "forward" in pathlib.Path(file.name).read_text(encoding="utf-8"), "that it drives")
        self.close()
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1)
        self.assertTrue(said.endswith("drive: the terminal is gone\n"), said)
        self.settle()
        out, _ = self.interrupt(self.listener)
        self.assertEqual(self.objects(out)[-1]["data"], REST)

    def test_an_output_that_no_program_reads_any_more(self):
        """It ends with the motors at rest, and the terminal is set back."""
        process = self.drive(stdout=subprocess.PIPE)
        self.assertIn("rests", process.stdout.readline())
        os.write(self.primary, UP)
        self.assertIn("forward", process.stdout.readline())
        process.stdout.close()
        os.write(self.primary, b"+")  # a line that says so
        process.wait(timeout=60)
        self.assertEqual(process.returncode, 128 + signal.SIGPIPE)
        self.assertEqual(termios.tcgetattr(self.secondary), self.before)
        self.settle()
        out, _ = self.interrupt(self.listener)
        self.assertEqual(self.objects(out)[-1]["data"], REST)

    def test_another_commander(self):
        other = self.start("drive", "5cm/s")
        harness.waiting.until(lambda: self.listener.stdout.readline(), "its set points")
        primary, secondary = pty.openpty()
        refused = subprocess.run([harness.AMIROCTL, "drive", "--keys"], stdin=secondary, stdout=secondary, text=True,
                                 stderr=subprocess.PIPE, env=self.environment, timeout=60)
        os.close(primary)
        os.close(secondary)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("another program commands motors", refused.stderr)
        self.interrupt(other)

    def test_refused(self):
        for arguments, what in (((), "--keys reads keys of a terminal"), (("fast",), "'fast' is no speed"),
                                (("2000m/s",), "out of range"), (("--for", "1s"), "--for"), (("--once",), "--once")):
            _, said = self.run_tool("drive", "--keys", *arguments, code=2)
            self.assertIn(what, said)


if __name__ == "__main__":
    harness.main()
