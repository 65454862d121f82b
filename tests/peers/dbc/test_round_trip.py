"""A DBC file that becomes our JSON, and a DBC file again, is for the second reader what it was: numbers, names, comments, attributes and
their definitions; what is not is listed with its number. Random files and those of the folder that OCM_DBC_FILES names."""

import collections
import dataclasses
import json
import pathlib
import random
import re
import unittest

import random_dbc
import second_reader
import write_dbc
from test_decode import EXPLORE, FOLDER, FRAMES, Case, Tool, frames_of_file, log_of

SEEDS = range(6 * EXPLORE)
# Attributes that have a member of their own in our JSON: what they say is kept, given or by default, and not how the file defines them.
MEMBERS = {("BO_", "GenMsgCycleTime"), ("BO_", "GenMsgDelayTime"), ("BO_", "GenMsgSendType"), ("BO_", "VFrameFormat"),
           ("BO_", "SystemMessageLongSymbol"), ("SG_", "GenSigStartValue"), ("SG_", "SystemSignalLongSymbol"),
           ("BU_", "SystemNodeLongSymbol")}
# Those whose default becomes one of each object, since it says when messages are sent.
GIVEN = {"GenMsgStartDelayTime", "GenMsgCycleTimeFast", "CANFD_BRS", "GenSigSendType"}


def is_node(name):
    return name not in ("", "Vector__XXX")


def plain(attributes):
    """All that have no member of their own."""
    return {name: value for name, value in attributes.items() if name not in GIVEN and not any(name == known for _, known in MEMBERS)}


def is_fd(message):
    return message.frame_format.endswith("FD") or (message.length > 8 and not message.j1939)


class RoundTrip(Case):
    def assert_same(self, where, before, after):
        self.assertEqual(before.comment.replace("\r\n", "\n"), after.comment.replace("\r\n", "\n"), where)
        self.assertEqual(after.nodes[:len(before.nodes)], before.nodes, where)
        named = {name for message in before.messages for name in (message.sender, *message.other_senders)}
        named |= {receiver for message in before.messages for signal in message.signals for receiver in signal.receivers}
        self.assertEqual(set(after.nodes), set(before.nodes) | set(filter(is_node, named)), where)
        self.assertEqual({node: text for node, text in after.node_comments.items() if text},
                         {node: text for node, text in before.node_comments.items() if text and node in before.nodes}, where)
        for node in before.nodes:
            self.assertEqual(plain(after.node_attributes.get(node, {})), plain(before.node_attributes.get(node, {})), (where, node))
        self.assertEqual(after.attributes, before.attributes, where)
        for key, definition in before.definitions.items():
            if key not in MEMBERS:
                self.assertEqual(after.definitions.get(key), definition, (where, key))
                self.assertEqual(after.defaults.get(key[1]), before.defaults.get(key[1]), (where, key))
        self.assertEqual([(m.name, m.number, m.extended, m.length, m.j1939, is_fd(m), m.sender, m.other_senders, m.comment.replace("\r\n", "\n"))
                          for m in after.messages],
                         [(m.name, m.number, m.extended, m.length, m.j1939, is_fd(m), m.sender, m.other_senders, m.comment.replace("\r\n", "\n"))
                          for m in before.messages], where)
        for message, other in zip(before.messages, after.messages):
            place = f"{where}: {message.name}"
            self.assertEqual(plain(other.attributes), plain(message.attributes), place)
            for name in ("GenMsgCycleTime", "GenMsgDelayTime", "GenMsgSendType", "GenMsgStartDelayTime", "GenMsgCycleTimeFast", "CANFD_BRS"):
                values = [database.attribute("BO_", each.attributes, name) for database, each in ((before, message), (after, other))]
                # Nothing, and zero: the same; the rate is switched where nothing says so.
                usual = "1" if name == "CANFD_BRS" else None
                self.assertEqual(*[usual if value in (None, 0, "") else value for value in values], (place, name))
            self.assertEqual([signal.name for signal in other.signals], [signal.name for signal in message.signals], place)
            for signal, again in zip(message.signals, other.signals):
                self.assert_same_signal(f"{place}.{signal.name}", before, message, signal, after, again)

    def assert_same_signal(self, place, before, message, signal, after, again):
        self.assertEqual(plain(again.attributes), plain(signal.attributes), place)
        starts, send_types = ([database.attribute("SG_", each.attributes, name) for database, each in ((before, signal), (after, again))]
                              for name in ("GenSigStartValue", "GenSigSendType"))
        self.assertEqual(*send_types, place)
        if None not in starts and not signal.floating:  # as bits: 255 is -1 of 8
            starts = [start % (1 << signal.length) for start in starts]
        self.assertEqual(*starts, place)
        low, high = (signal.minimum, signal.maximum) if signal.minimum <= signal.maximum else (0, 0)  # upside down: none
        selects = any(each.selector == signal.name for each in message.signals)  # an M that selects nothing says nothing
        expected = dataclasses.replace(signal, minimum=low, maximum=high, receivers=list(filter(is_node, signal.receivers)), attributes={},
                                       page=None, is_selector=selects, comment=signal.comment.replace("\r\n", "\n"),
                                       ranges=signal.ranges if signal.selector else [])
        found = dataclasses.replace(again, receivers=list(filter(is_node, again.receivers)), attributes={}, page=None,
                                    comment=again.comment.replace("\r\n", "\n"))
        self.assertEqual(found, expected, place)

    def not_kept(self, database):
        """What must be listed, with its number."""
        left = collections.Counter({keyword: count for keyword, count in database.unused.items() if count})
        for name, count in (("VAL_TABLE_, the values of which are with their signals", len(database.tables)),
                            ("signals of VECTOR__INDEPENDENT_SIG_MSG", left.pop("VECTOR__INDEPENDENT_SIG_MSG", 0))):
            if count:
                left[name] = count
        return left

    def check(self, where, spec, database, frames):
        """There and back twice; and a log means the same by all four files."""
        first, back, second, last = (self.folder / name for name in ("first.json", "back.dbc", "second.json", "last.dbc"))
        tool = Tool(self, self.folder, spec)
        tool.run("generate", "spec", "-o", first)
        listed = re.findall(r"^generate spec: left out: (\d+) (.*)$", tool.errors, re.M)
        self.assertEqual({name: int(number) for number, name in listed}, self.not_kept(database), where)
        of_json = Tool(self, self.folder, first)
        of_json.run("generate", "dbc", "-o", back)
        self.assertNotIn("left out: ", of_json.errors, where)
        self.assert_same(where, database, second_reader.read(back.read_bytes()))
        of_back = Tool(self, self.folder, back)
        of_back.run("generate", "spec", "-o", second)
        self.assertNotIn("left out: ", of_back.errors, where)
        Tool(self, self.folder, second).run("generate", "dbc", "-o", last)
        self.assertEqual(last.read_bytes(), back.read_bytes(), where)
        models = [json.loads(file.read_text(encoding="utf-8"), parse_float=str) for file in (first, second)]
        for model in models:
            model.pop("robot")  # both are called as their files are
            for message in model["messages"]:
                message.pop("source")
        self.assertEqual(*models, where)
        log = self.folder / "random.log"
        log.write_text(log_of(frames))
        lines = tool.run("decode", "--json", log)
        for other in (of_json, of_back):
            self.assertEqual(other.run("decode", "--json", log), lines, (where, other.spec))

    def test_random_files(self):
        for seed in SEEDS:
            database = random_dbc.database(seed)
            spec = self.folder / f"{seed}.dbc"
            spec.write_bytes(write_dbc.write(database, seed).encode("cp1252" if seed % 3 == 0 else "utf-8"))
            self.check(f"seed {seed}", spec, second_reader.read(spec.read_bytes()), random_dbc.frames(seed, database, FRAMES))

    def test_files_of_a_folder(self):
        taken = 0
        for spec in sorted(pathlib.Path(FOLDER).rglob("*.dbc")):
            database = second_reader.read(spec.read_bytes())
            if not database.messages:
                Tool(self, self.folder, spec).run("generate", "spec", code=1)
                continue
            with self.subTest(spec.name):
                frames = frames_of_file(spec.name, database)
                frames += [(2_000_000 + index, message, message.number, True, False, random_dbc.data_of(random.Random(index), message))
                           for index, message in enumerate(database.messages) if message.j1939 and 0 < message.length <= 8]
                self.check(spec.name, spec, database, frames)
            taken += 1
        self.assertGreater(taken, 0)

    def test_names_that_fit_are_kept(self):
        """A long name that begins with one does not take it, wherever it is in the file."""
        short, long = "S1234567890123456789012345678901", "S12345678901234567890123456789012"
        spec = self.folder / "names.json"
        spec.write_text(json.dumps({"robot": "x", "boards": [{"name": long}, {"name": short}], "messages": [
            {"name": long, "id": 1, "sender": short, "fields": [{"name": long, "byte": 0, "type": "u8"}, {"name": short, "byte": 1, "type": "u8"}]},
            {"name": short, "id": 2, "sender": long, "fields": [{"name": "x", "byte": 0, "type": "u8", "receivers": [short]}]}]}))
        text = Tool(self, self.folder, spec).run("generate", "dbc")
        self.assertIn(f"\nBO_ 2 {short}: 1 ", text)
        self.assertIn(f" SG_ {short} : 8|8@1+ ", text)
        self.assertRegex(text, rf"BU_: \S+ {short}\n")
        self.assertEqual(len(re.findall(rf'LongSymbol" .* "{long}";', text)), 3)
        self.assertNotIn(f'"{short}"', text)


if __name__ == "__main__":
    unittest.main()
