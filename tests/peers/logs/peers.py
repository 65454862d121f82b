"""What tests against other people's tools share, beyond harness.py: runs of theirs, and logs of all kinds of frames."""

import os
import random
import shutil
import subprocess
import time
import unittest

import harness
from harness import FD_LENGTHS

os.environ["TZ"] = "UTC"  # python-can takes dates to be in the zone of its process
time.tzset()


def needs(*tools):
    """Leaves a class of tests out where a tool is not installed."""
    missing = [tool for tool in tools if shutil.which(tool) is None]
    return unittest.skipIf(missing, f"not installed: {', '.join(missing)}")


class Case(harness.Case):
    """A test case in a folder of its own; files are named without it."""

    def setUp(self):
        super().setUp()
        self.environment["TZ"] = "UTC"

    def save(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())

    def load(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def run_peer(self, *command, code=0):
        """Runs a tool to its end in the folder; returns its standard output."""
        done = subprocess.run(command, cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, code, f"{command}: {done.stdout}{done.stderr}")
        return done.stdout

    def convert(self, source, target, *options):
        """amiroctl convert; returns what it remarks."""
        return self.run_tool("convert", self.path(source), self.path(target), "--force", *options)[1]

    def candump_of(self, source):
        """The lines of a log in the notation of candump, with nine digits of a second."""
        self.convert(source, "as-candump.log", "--to", "candump-ns")
        return self.text(self.path("as-candump.log")).splitlines()


def random_lines(count, seed, digits=9, errors=True, directions=("", " R", " T"), raw_dlc=True, fd=True,
                 interfaces=("can0", "can1")):
    """Lines of a candump log: classic and FD, both formats, remote and error frames."""
    chance = random.Random(seed)
    second, lines = 1_700_000_000, []
    for _ in range(count):
        second += chance.randrange(2)
        stamp = f"{second}.{chance.randrange(10 ** digits):0{digits}d}"
        frame = f"{chance.randrange(0x800):03X}" if chance.randrange(2) else f"{chance.randrange(1 << 29):08X}"
        kind = chance.randrange(8)
        if kind == 0 and errors:
            frame = f"{0x20000000 | 1 << chance.randrange(9):08X}#" + chance.randbytes(8).hex().upper()
        elif kind == 1:
            length = chance.randrange(9)
            frame += "#R" + (str(length) if length else "")
        elif kind in (2, 3) and fd:
            frame += f"##{chance.randrange(4)}" + chance.randbytes(chance.choice(FD_LENGTHS)).hex().upper()
        else:
            length = chance.randrange(9)
            frame += "#" + chance.randbytes(length).hex().upper()
            if length == 8 and raw_dlc and chance.randrange(2):
                frame += "_" + chance.choice("9ABCDEF")
        lines.append(f"({stamp}) {chance.choice(interfaces)} {frame}{chance.choice(directions)}")
    return lines

