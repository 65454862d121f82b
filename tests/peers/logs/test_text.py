"""candump's text and CSV against python-can and can-utils, both ways, on random frames."""

import re
import shutil
import subprocess
import unittest

import can

from harness import Case, frames_of, random_messages


class CandumpText(Case):
    def filter(self, command, path):
        with open(path) as file:
            return subprocess.run(command, stdin=file, capture_output=True, text=True, check=True).stdout

    def test_ours_in_python_can(self):
        """Everything arrives but the names that python-can has no place for; times to a half of a microsecond."""
        messages = random_messages(1, 2000)
        log = self.path("ours.log")
        self.write_candump(log, messages)
        again = self.path("again.log")
        self.run_tool("convert", log, again)
        self.assertEqual(self.text(again), self.text(log))
        for ours, theirs in zip(messages, can.CanutilsLogReader(again), strict=True):
            self.assert_same(ours, theirs)

    def test_python_can_in_ours(self):
        messages = random_messages(2, 2000)
        theirs = self.path("theirs.log")
        writer = can.CanutilsLogWriter(theirs)
        for message in messages:
            writer.on_message_received(message)
        writer.stop()
        ours = self.path("ours.log")
        self.run_tool("convert", theirs, ours, "--strict")
        self.assertEqual([line.lower() for line in self.text(ours).splitlines()],
                         [line.lower() for line in self.text(theirs).splitlines()])

    @unittest.skipUnless(shutil.which("log2long"), "can-utils is not installed")
    def test_ours_in_can_utils(self):
        """log2long prints each frame apart: as many as we wrote, with their bytes."""
        log = self.path("ours.log")
        self.write_candump(log, random_messages(3, 500))
        again = self.path("again.log")
        self.run_tool("convert", log, again, "--strict")
        before, after = (self.filter(["log2long"], path) for path in (log, again))
        self.assertEqual(len(before.splitlines()), 500)
        self.assertEqual(after, before)

    @unittest.skipUnless(shutil.which("log2long"), "can-utils is not installed")
    def test_what_candump_shows_in_ours(self):
        """log2long prints with candump's own function: all but directions and flags of CAN FD comes back."""
        log = self.path("ours.log")
        self.write_candump(log, random_messages(6, 2000))
        screen = self.path("screen.txt")
        with open(screen, "w", encoding="ascii") as file:
            file.write(self.filter(["log2long"], log))
        again = self.path("again.log")
        self.run_tool("convert", screen, again, "--strict")
        expected = [re.sub("##.", "##0", line[:-2]) for line in self.text(log).splitlines()]
        self.assertEqual(self.text(again).splitlines(), expected)

    @unittest.skipUnless(shutil.which("log2asc"), "can-utils is not installed")
    def test_nine_digits_are_for_us_only(self):
        """Why six digits are the default: can-utils takes a fraction of nine for microseconds."""
        log = self.path("ns.log")
        with open(log, "w") as file:
            file.write("(1436509052.000000000) can0 123#\n(1436509052.000249713) can0 123#\n")
        out = self.filter(["log2asc", "can0"], log)
        self.assertIn("   0.249713 1  123", out)  # and not 0.000249713
        _, err = self.run_tool("convert", log, self.path("six.log"))
        self.assertIn("candump has no room for digits of the time of 1 frame\n", err)
        self.assertIn("candump-ns", err)
        self.run_tool("convert", log, self.path("six.log"), "--strict", code=1)
        self.run_tool("convert", log, self.path("nine.log"), "--to", "candump-ns", "--strict")
        self.assertEqual(self.text(self.path("nine.log")), self.text(log))


class Csv(Case):
    def test_ours_in_python_can(self):
        messages = random_messages(4, 2000, fd=False)
        log, csv = self.path("in.log"), self.path("out.csv")
        self.write_candump(log, messages)
        self.run_tool("convert", log, csv)
        for ours, theirs in zip(messages, can.CSVReader(csv), strict=True):
            theirs.channel, theirs.is_rx = ours.channel, ours.is_rx  # CSV has neither
            self.assert_same(ours, theirs, error_detail=True)

    def test_python_can_in_ours(self):
        messages = random_messages(5, 2000, fd=False)
        csv, log = self.path("theirs.csv"), self.path("ours.log")
        writer = can.CSVWriter(csv)
        for message in messages:
            writer.on_message_received(message)
        writer.stop()
        self.run_tool("convert", csv, log)
        # Python prints a float's 17 digits, of which the last two are not the time's.
        for ours, theirs in zip(messages, frames_of(self.text(log)), strict=True):
            expected = frames_of(self.candump_line(ours))[0]
            self.assertEqual(theirs[2], expected[2])
            self.assertAlmostEqual(float(theirs[0]), float(expected[0]), delta=1.1e-6)


if __name__ == "__main__":
    unittest.main()
