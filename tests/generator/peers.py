"""What the tests of ocm-generate's targets share: the programs, the specs, and frames with their exact values."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest
from decimal import Decimal

ROOT = pathlib.Path(os.environ["OCM_SOURCE_DIR"])
SPECS = {"amiro": ROOT / "spec" / "topics.json", "ferry": ROOT / "examples" / "other-robot" / "topics.json"}


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


def full_name(sample):
    return sample["topic"] + ("." + sample["frame"] if sample["frame"] else "")


class Case(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="ocm-test-")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
