"""amiroctl drive --gamepad: devices that are none, what is refused before anything moves, and each end of a drive. How a
pad drives is in tests/tool/clock/pad_drive.cpp, with pads that are played."""

import os
import signal
import subprocess

import harness
from realtime import MOST_LATE

REST = "0000000000000000"
PLAYED = os.environ.get("PLAYED_GAMEPAD")  # played_gamepad.cpp; none without libevdev, or in a build with sanitizers


class Gamepad(harness.Case):
    def refused(self, *arguments, code=1):
        """What it said; nothing was sent."""
        self.start_sim("--frozen")
        listener = self.listen("motors", "--commands")
        _, said = self.run_tool("drive", *arguments, code=code)
        self.settle()
        out, _ = self.interrupt(listener)
        self.assertEqual(out, "")
        return said

    def test_a_build_without_libevdev_says_so(self):
        """And one with it names what it was given; either is a whole message."""
        said = self.run_tool("drive", "--gamepad", "/dev/null", code=1)[1]
        if "was built without libevdev" in said:
            self.assertIn("install libevdev-dev and build again", said)
        else:
            self.assertIn("/dev/null is no input device", said)

    def test_what_is_no_gamepad(self):
        if "was built without libevdev" in self.run_tool("drive", "--gamepad", "/dev/null", code=1)[1]:
            return
        said = self.refused("--gamepad", "/dev/input/event9999")
        self.assertIn("gamepad /dev/input/event9999: No such file or directory", said)
        self.assertRegex(said, "gamepads? (here|can be read)")
        plain = os.path.join(self.folder, "plain")
        with open(plain, "w", encoding="ascii") as file:
            file.write("no events")
        for path in (plain, self.folder, "/dev/zero"):
            self.assertIn("is no input device", self.run_tool("drive", "--gamepad", path, code=1)[1], path)

    def test_limits_and_usage(self):
        self.assertIn("out of range", self.refused("--gamepad", "/dev/null", "2m/s", code=2))
        self.assertIn("is no speed", self.run_tool("drive", "--gamepad", "/dev/null", "fast", code=2)[1])
        for other in (("--keys",), ("--for", "2s"), ("--once",), ("--dry-run",)):
            self.assertIn("--gamepad", self.run_tool("drive", "5cm/s", "--gamepad", "/dev/null", *other, code=2)[1], other)


class Played(harness.Case):
    """What a person does with the pad is the word that its file begins with."""

    # Set points come each 100 ms.
    most_late = MOST_LATE

    def setUp(self):
        super().setUp()
        self.start_sim("--frozen")
        self.listener = self.listen("motors", "--commands")
        self.pad = os.path.join(self.folder, "pad")

    def does(self, word):
        file = os.open(self.pad, os.O_WRONLY | os.O_CREAT, 0o600)
        os.pwrite(file, word.ljust(8).encode(), 0)  # all of it at once
        os.close(file)

    def drive(self):
        """Returns as it has begun to move."""
        self.does("rest")
        process = harness.waiting.Program([harness.AMIROCTL, "drive", "--gamepad", self.pad], stdin=subprocess.DEVNULL,
                                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                          env={**self.environment, "LD_PRELOAD": PLAYED})
        self._started.append(process)
        self.assertEqual(process.stdout.readline(), "rests: hold a shoulder button to drive\n")
        self.does("drive")
        self.assertNotRegex(process.stdout.readline(), "^$|rests")
        return process

    def rests(self):
        """It has moved, and rests."""
        self.settle()
        out, _ = self.interrupt(self.listener)
        points = [each["data"] for each in self.objects(out)]
        self.assertNotEqual(points[0], REST)
        self.assertEqual(points[-1], REST)

    def ends(self, process, code):
        """What it said; with the motors at rest."""
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, code, said)
        self.rests()
        self.assertIn("gamepad: played\n", said)
        return said

    def test_start_quits(self):
        process = self.drive()
        self.does("rest")
        self.assertEqual(process.stdout.readline(), "rests: hold a shoulder button to drive\n")
        self.does("quit")
        self.assertNotIn("is gone", self.ends(process, 0))

    def test_a_pad_that_is_gone(self):
        process = self.drive()
        self.does("gone")
        said = self.ends(process, 1)
        self.assertTrue(said.endswith(f"amiroctl: drive: gamepad {self.pad} is gone; the motors rest\n"
                                      "          plug it in or switch it on again, and begin the drive again\n"), said)

    def test_a_signal(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(signal=number):
                self.listener = self.listen("motors", "--commands")
                process = self.drive()
                process.send_signal(number)
                self.assertNotIn("is gone", self.ends(process, 128 + number))

    def test_another_commander(self):
        """It is heard before the first set point, of zero or not."""
        other = self.start("drive", "5cm/s")
        harness.waiting.until(lambda: self.listener.stdout.readline(), "its set points")
        self.does("drive")
        refused = subprocess.run([harness.AMIROCTL, "drive", "--gamepad", self.pad], stdin=subprocess.DEVNULL, text=True,
                                 capture_output=True, env={**self.environment, "LD_PRELOAD": PLAYED}, timeout=60)
        self.assertEqual((refused.returncode, refused.stdout), (1, ""))
        self.assertIn("another program commands motors", refused.stderr)
        _, said = self.interrupt(other)
        self.assertNotIn("another program", said)

    def test_an_output_that_no_program_reads_any_more(self):
        process = self.drive()
        process.stdout.close()
        self.does("rest")  # a line that says so
        process.wait(timeout=60)
        self.assertEqual(process.returncode, 128 + signal.SIGPIPE)
        self.rests()


if not PLAYED:
    del Played

if __name__ == "__main__":
    harness.main()
