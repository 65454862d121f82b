"""Real files, those of the folder that OCM_DBC_FILES names, else the project's own: each is loaded, or refused with file and line where
canmatrix refuses it, too; and what is decoded is encoded to the same bits."""

import json
import os
import pathlib
import random
import re
import unittest

import dbc_bits
import random_dbc
import second_reader
from test_decode import FOLDER, Case, Tool, canmatrix, frames_of_file, log_of, number_of

FILES = sorted({*pathlib.Path(FOLDER).rglob("*.dbc"), *pathlib.Path(os.environ["OCM_SOURCE_DIR"], "examples").glob("*.dbc")})


class Folder(Case):
    def test_every_file_is_loaded(self):
        """With all messages, signals and senders that the second reader finds. A doubt has its line."""
        reader = canmatrix()
        for spec in FILES:
            with self.subTest(spec.name):
                tool = Tool(self, self.folder, spec)
                try:
                    listed = [json.loads(line) for line in tool.run("list", "--json").splitlines()]
                except AssertionError:  # refused: then others refuse it, too, and it is said where
                    tool.run("list", code=1)
                    self.assertRegex(tool.errors, rf"(?m)^amiroctl: {re.escape(str(spec))}:[0-9]+: ")
                    with self.assertRaises(Exception):
                        reader.formats.loadp_flat(str(spec), dbcImportEncoding="cp1252")
                    continue
                for line in tool.errors.splitlines():
                    self.assertRegex(line, rf"^{re.escape(str(spec))}(:[0-9]+: \S|: the file has no message|: [0-9]+ more doubtful place)")
                database = second_reader.read(spec.read_bytes())
                self.assertEqual([(each["topic"], int(each["id"], 16), each["board"]) for each in listed],
                                 [(m.name, m.number, "" if m.sender == "Vector__XXX" else m.sender) for m in database.messages])
                for message in database.messages:
                    if database.message(message.name) is message:  # `info` takes a name
                        text = tool.run("info", message.name)
                        for signal in message.signals:
                            self.assertRegex(text, rf"(?m)^    {re.escape(signal.name)}\s")

    def test_encode_of_decode(self):
        """Without data, so that the fields alone make the frame. Where fields lie over one another, all of them are given."""
        checked = 0
        for spec in FILES:
            database = second_reader.read(spec.read_bytes())
            frames = frames_of_file(spec.name, database)
            frames += [(2_000_000 + index, message, message.number, True, False, random_dbc.data_of(random.Random(index), message))
                       for index, message in enumerate(database.messages) if message.j1939 and message.signals and 0 < message.length <= 8]
            if not frames:
                continue
            log = self.folder / "real.log"
            log.write_text(log_of(frames))
            with self.subTest(spec.name):
                tool = Tool(self, self.folder, spec)
                lines = [json.loads(line, parse_int=Number, parse_float=Number) for line in tool.run("decode", "--json", log).splitlines()]
                for line in lines:
                    self.assertIn("fields", line)
                    line.pop("data")
                back = tool.run("encode", "--force", stdin="".join(written(line) + "\n" for line in lines).encode()).splitlines()
                self.assertEqual(len(back), len(frames))
                for text, (_, message, identifier, extended, fd, data) in zip(back, frames):
                    number, _, hexadecimal = text.split()[2].partition("##" if fd else "#")
                    self.assertEqual(number, number_of(identifier, extended), text)
                    found = bytes.fromhex(hexadecimal[1:] if fd else hexadecimal)
                    self.assertEqual(len(found), len(data), text)
                    present = second_reader.decode(message, data[:message.length])
                    exact = [name for name, (raw, _) in present.items() if not is_inexact(message.signal(name), raw)]
                    used = dbc_bits.mask(len(data), [message.signal(name).bits() for name in exact])
                    self.assertEqual([byte & bits for byte, bits in zip(found, used)], [byte & bits for byte, bits in zip(data, used)],
                                     (spec.name, message.name, text))
                    checked += len(exact)
        self.assertGreater(checked, 100)


class Number(str):
    """A number as it is typed."""


def written(value):
    """As JSON; numbers with the digits that they came with."""
    if isinstance(value, Number):
        return str(value)
    if isinstance(value, dict):
        return "{" + ",".join(json.dumps(key) + ":" + written(each) for key, each in value.items()) + "}"
    return json.dumps(value)


def is_inexact(signal, raw):
    """A float of which not every bit comes back from the text of its value: scaled, or not a number."""
    return signal.floating and (signal.scale != 1 or signal.offset != 0 or raw != raw)


if __name__ == "__main__":
    unittest.main()
