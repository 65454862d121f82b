"""Runs amiroctl on files of a folder of its own; random frames, and candump's line of each, independent of ours."""

import os
import random
import subprocess
import tempfile
import unittest

import can

AMIROCTL = os.environ["AMIROCTL"]

FD_LENGTHS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64)


def random_messages(seed, count, fd=True):
    """Times are whole microseconds that go up. Remote frames ask for nothing: python-can does not write how much."""
    chance = random.Random(seed)
    micros = 1436509052_249713
    messages = []
    for _ in range(count):
        micros += chance.randrange(1, 100_000)
        common = dict(timestamp=micros / 1e6, channel=chance.choice(("can0", "vcan1")), is_rx=chance.random() < 0.5)
        extended = chance.random() < 0.5
        number = chance.randrange(0x20000000 if extended else 0x800)
        kind = chance.random()
        if kind < 0.1:
            message = can.Message(is_remote_frame=True, is_extended_id=extended, arbitration_id=number, dlc=0, **common)
        elif fd and kind < 0.4:
            data = chance.randbytes(chance.choice(FD_LENGTHS))
            message = can.Message(is_fd=True, bitrate_switch=chance.random() < 0.5, is_extended_id=extended,
                                  error_state_indicator=chance.random() < 0.5, arbitration_id=number, data=data, **common)
        else:
            message = can.Message(is_extended_id=extended, arbitration_id=number, data=chance.randbytes(chance.randrange(9)),
                                  **common)
        messages.append(message)
    return messages


def frames_of(log):
    """Time, interface, frame and direction of each line."""
    return [(words[0].strip("()"), *words[1:]) for words in (line.split() for line in log.splitlines())]


class Case(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="ocm-test-")
        self.folder = self._folder.name
        self.environment = {"PATH": os.environ["PATH"], "HOME": self.folder, "XDG_RUNTIME_DIR": self.folder}

    def tearDown(self):
        self._folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder, name)

    def text(self, path):
        with open(path) as file:
            return file.read()

    def run_tool(self, *arguments, code=0, stdin=b"", timeout=60):
        """Runs to the end and checks the exit code; returns (stdout as bytes, stderr as text)."""
        result = subprocess.run([AMIROCTL, *arguments], env=self.environment, input=stdin, capture_output=True,
                                timeout=timeout)
        self.assertEqual(result.returncode, code, f"{arguments}: {result.stderr.decode()}")
        return result.stdout, result.stderr.decode()

    def candump_line(self, message):
        micros = round(message.timestamp * 1e6)
        number = "%08X" % message.arbitration_id if message.is_extended_id else "%03X" % message.arbitration_id
        data = "R" if message.is_remote_frame else message.data.hex().upper()
        if message.is_fd:
            data = "#%d" % (message.bitrate_switch + 2 * message.error_state_indicator) + data
        return "(%010d.%06d) %s %s#%s %s\n" % (micros // 1_000_000, micros % 1_000_000, message.channel, number,
                                               data, "R" if message.is_rx else "T")

    def write_candump(self, path, messages):
        with open(path, "w") as file:
            file.writelines(map(self.candump_line, messages))

    def assert_same(self, ours, theirs, error_detail=False):
        for name in ("arbitration_id", "is_extended_id", "is_remote_frame", "is_error_frame", "is_fd", "is_rx",
                     "bitrate_switch", "error_state_indicator", "dlc", "data", "channel"):
            self.assertEqual(getattr(ours, name), getattr(theirs, name), (name, ours, theirs))
        self.assertAlmostEqual(ours.timestamp, theirs.timestamp, delta=0.6e-6)
