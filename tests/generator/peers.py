"""What the tests of ocm-generate's targets share: the programs, the specs, and frames with their exact values."""
import json
import math
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest
from decimal import Decimal

ROOT = pathlib.Path(os.environ["OCM_SOURCE_DIR"])
SPECS = {"amiro": ROOT / "spec" / "topics.json", "ferry": ROOT / "examples" / "other-robot" / "topics.json",
         "probe": ROOT / "tests" / "generator" / "probe.json"}


def generate(*arguments):
    return subprocess.run([os.environ["OCM_GENERATE"], *map(str, arguments)], check=True, capture_output=True,
                          encoding="utf-8", timeout=60).stdout


def samples(robot, rounds):
    """Frames with the values that the catalogue gives them, as exact decimals."""
    done = subprocess.run([os.environ["GENERATE_SAMPLES"], SPECS[robot], str(rounds)], check=True, capture_output=True,
                          encoding="utf-8", timeout=60)
    for line in done.stdout.splitlines():
        sample = json.loads(line)
        for field in sample["fields"].values():
            field["value"] = Decimal(field["value"])
        yield sample


def real(field):
    """The floating-point number in a field's bits."""
    size, letter = (4, "f") if field["float"] == 32 else (8, "d")
    return struct.unpack("<" + letter, (field["raw"] % (1 << 8 * size)).to_bytes(size, "little"))[0]


def is_near(shown, value, slack):
    """Floating-point numbers: none, without end, or within so much of the value."""
    shown, value = float(shown), float(value)
    if math.isnan(value) or math.isinf(value):
        return str(abs(shown)) == str(abs(value)) and (math.isnan(value) or (shown < 0) == (value < 0))
    return abs(shown - value) <= abs(value) * slack + 1e-300


def full_name(sample):
    return sample["topic"] + ("." + sample["frame"] if sample["frame"] else "")


class Case(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="ocm-test-")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
