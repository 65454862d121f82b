"""The page that ocm-generate makes of a DBC file says of each signal what the second reader finds there, whatever the texts have in them."""

import os
import pathlib
import re
import subprocess
import tempfile
import unittest
from fractions import Fraction

import random_dbc
import second_reader
import write_dbc

GENERATE = os.environ["OCM_GENERATE"]
SOURCE = pathlib.Path(os.environ["OCM_SOURCE_DIR"])
EXPLORE = int(os.environ.get("OCM_EXPLORE", "1"))
FOLDER = os.environ.get("OCM_DBC_FILES") or SOURCE / "examples"
HEAD = "| field | place | type | scale | range | |"


def plain(text):
    """What a reader of Markdown sees."""
    return re.sub(r"\\([\\`*<\[\]|~_+=>#-])", r"\1", text)


def cells(row):
    """Of a table's row: at each | without a backslash before it ends one."""
    found = re.split(r"(?<!\\)\|", row)
    return [cell.strip() for cell in found[1:-1]]


def sections(page):
    """By message the text before its table, and the rows."""
    found = {}
    for part in page.split("\n### ")[1:]:
        part = part.split("\n## ")[0]
        name, _, rest = part.partition("\n")
        before, _, table = rest.partition(HEAD)
        found[plain(name)] = before, [cells(line) for line in table.split("\n")[2:] if line.startswith("|")]
    return found


def place_of(text):
    """(start bit, big-endian where it is said)."""
    number = int(re.search(r"\d+", text)[0])
    big = text.endswith("big-endian")
    return (number if text.startswith("bit ") else 8 * number + (7 if big else 0)), big


class Markdown(unittest.TestCase):
    def page(self, spec):
        return subprocess.run([GENERATE, spec, "--to", "markdown", "-o", "-"], check=True, capture_output=True, encoding="utf-8",
                              timeout=60).stdout

    def check(self, where, database, page):
        found = sections(page)
        self.assertEqual(set(found), {message.name for message in database.messages}, where)
        for message in database.messages:
            before, rows = found[message.name]
            number = f"group 0x{second_reader.group(message.number):05X}" if message.j1939 else \
                f"identifier 0x{message.number:0{8 if message.extended else 3}X}"
            self.assertIn(number, before, where)
            self.assertIn(f"{message.length} byte", before, where)
            is_fd = "FD" in message.frame_format or (message.length > 8 and not message.j1939)
            self.assertEqual("of CAN FD" in before, is_fd, (where, message.name))
            self.assertIn(" ".join(message.comment.split()), " ".join(plain(before).split()), where)
            self.assertEqual([plain(row[0]) for row in rows], [signal.name for signal in message.signals], where)
            for row, signal in zip(rows, message.signals):
                self.check_row(f"{where}: {message.name}.{signal.name}: {row}", row, signal)

    def check_row(self, where, row, signal):
        self.assertEqual(len(row), 6, where)
        start, big = place_of(row[1])
        if signal.length > 8:
            self.assertEqual((start, big), (signal.start, signal.big_endian), where)
        elif row[1].startswith("bit "):
            self.assertEqual(start, signal.start, where)
        else:
            self.assertEqual((start, signal.length), (signal.start - signal.start % 8, 8), where)
        self.assertEqual(row[2], f"{'f' if signal.floating else 'i' if signal.signed else 'u'}{signal.length}", where)
        scale, _, offset = plain(row[3]).partition(", from ")
        unit = " " + signal.unit if signal.unit else ""
        self.assertEqual(Fraction(scale.removesuffix(unit) or 1), signal.scale, where)
        self.assertEqual(Fraction(offset.removesuffix(unit) or 0), signal.offset, where)
        self.check_range(where, plain(row[4]).removesuffix(unit), signal)
        text = row[5]
        self.assertEqual("Where " in text and f"`{signal.selector}` is" in text, signal.selector is not None, where)
        if signal.selector is not None:
            said = re.search(r"`[^`]*` is ([^.]*)\.", text)[1]
            ranges = [tuple(map(int, part.split(" to "))) * (1 if " to " in part else 2) for part in said.split(", ")]
            self.assertEqual(ranges, list(signal.ranges), where)
        for number, name in signal.names.items():
            self.assertRegex(text, rf"(^|[ ]){number} `{re.escape(name)}`", where)
        text = " ".join(plain(text).split())
        self.assertIn(" ".join(signal.comment.split()), text, where)
        receivers = [receiver for receiver in signal.receivers if receiver != "Vector__XXX"]
        self.assertEqual("To " + ", ".join(receivers) in text, bool(receivers), where)

    def check_range(self, where, said, signal):
        """What the file says; else what the bits hold, as far as 64 bits of digits print it; of names alone and of floats nothing."""
        low, high = signal.minimum, signal.maximum
        if low > high or low == high == 0:
            lowest, highest = (-1 << signal.length - 1, (1 << signal.length - 1) - 1) if signal.signed else (0, (1 << signal.length) - 1)
            low, high = sorted(raw * signal.scale + signal.offset for raw in (lowest, highest))
            unsaid = signal.floating or (signal.length == 64 and not signal.signed)
            if unsaid or (not said and signal.length > 32):
                low = high = None
        if signal.names and not signal.unit:
            low = high = None
        self.assertEqual([Fraction(number) for number in said.split(" to ")] if said else [None, None], [low, high], where)

    def test_random_files(self):
        with tempfile.TemporaryDirectory(prefix="ocm-test-") as folder:
            for seed in range(20 * EXPLORE):
                database = random_dbc.database(seed)
                spec = pathlib.Path(folder) / "bus.dbc"
                spec.write_text(write_dbc.write(database, seed), encoding="utf-8")
                self.check(f"seed {seed}", database, self.page(spec))

    def test_examples(self):
        for name in ("small_car", "truck"):
            spec = SOURCE / "examples" / f"{name}.dbc"
            database = second_reader.read(spec.read_bytes())
            page = self.page(spec)
            self.check(name, database, page)
            # The table of contents leads to each message, once.
            links = re.findall(r"^\| \[([^\]]*)\]\(#([^)]*)\)", page, re.M)
            self.assertEqual([plain(text) for text, _ in links], [message.name for message in database.messages])
            self.assertEqual(len({anchor for _, anchor in links}), len(links))

    def test_files_of_a_folder(self):
        for spec in sorted(pathlib.Path(FOLDER).rglob("*.dbc")):
            database = second_reader.read(spec.read_bytes())
            if database.messages:
                with self.subTest(spec.name):
                    self.check(spec.name, database, self.page(spec))

    def test_a_message_that_is_called_as_its_sender(self):
        with tempfile.TemporaryDirectory(prefix="ocm-test-") as folder:
            spec = pathlib.Path(folder) / "bus.dbc"
            spec.write_text('VERSION ""\nBU_: Engine\nBO_ 1 Engine: 1 Engine\n SG_ a : 0|8@1+ (1,0) [0|0] "" Vector__XXX\n'
                            'BO_ 2 Other: 1 Vector__XXX\n SG_ c : 0|8@1+ (1,0) [0|0] "|" Vector__XXX\n'
                            'CM_ BO_ 2 "# not a heading | `code` <b>";\n')
            page = self.page(spec)
            self.assertIn("[Engine](#engine-1)", page)
            self.assertIn("## Of no stated sender\n\n### Other\n\n\\# not a heading \\| \\`code\\` \\<b>.\n", page)
            self.assertIn("| c | byte 0 | u8 | 1 \\| |", page)


if __name__ == "__main__":
    unittest.main()
