"""The repository's own DBC files, examples/small_car.dbc and truck.dbc: without doubts, decoded as the second reader decodes
them, and taken by the verbs that read a spec."""

import json
import os
import pathlib
import re
import unittest

import random_dbc
import second_reader
import test_decode

EXAMPLES = pathlib.Path(os.environ["OCM_SOURCE_DIR"]) / "examples"
FILES = ("small_car.dbc", "truck.dbc")
MULTIPLEXED = {"small_car.dbc": "Service", "truck.dbc": "TrailerService"}


class Examples(test_decode.Case):
    def each(self):
        """A tool with this file, the second reader's database, and a log of random frames of it."""
        for name in FILES:
            spec = EXAMPLES / name
            database = second_reader.read(spec.read_bytes())
            frames = random_dbc.frames(name, database, 500 * test_decode.EXPLORE)
            log = self.folder / "example.log"
            log.write_text(test_decode.log_of(frames))
            yield test_decode.Tool(self, self.folder, spec), database, frames, log

    def test_they_tell_a_bus(self):
        for tool, database, _, _ in self.each():
            signals = [signal for message in database.messages for signal in message.signals]
            self.assertTrue(any(signal.big_endian for signal in signals) and any(signal.signed for signal in signals))
            self.assertIsNotNone(database.message(MULTIPLEXED[tool.spec.name]))
            self.assertTrue(all(message.j1939 == (tool.spec.name == "truck.dbc") for message in database.messages))
            self.assertTrue(all(set(signal.receivers + [message.sender]) <= set(database.nodes)
                                for message in database.messages for signal in message.signals))

    def test_list_has_every_message_and_no_doubt(self):
        for tool, database, _, _ in self.each():
            listed = [json.loads(line) for line in tool.run("list", "--json", "--strict-spec").splitlines()]
            self.assertEqual([(entry["topic"], int(entry["id"], 16), entry["board"]) for entry in listed],
                             [(message.name, message.number, message.sender) for message in database.messages])
            self.assertEqual(tool.errors, "")

    def test_info_has_every_signal(self):
        for tool, database, _, _ in self.each():
            for message in database.messages:
                text = tool.run("info", message.name)
                for signal in message.signals:
                    self.assertRegex(text, rf"(?m)^\s+{signal.name}\s")
                    for number, name in signal.names.items():
                        self.assertRegex(text, rf"= {number}\s+{re.escape(name)}")

    def test_decode_and_encode(self):
        for tool, _, frames, log in self.each():
            text, _ = self.check_json(tool, tool.spec.name, frames, log)
            self.assertEqual(tool.run("encode", stdin=text.encode()), log.read_text())

    def test_value_names_are_shown(self):
        for tool, _, frames, log in self.each():
            shown = tool.run("decode", "--pretty", log).splitlines()
            self.assertEqual(len(shown), len(frames))
            names = 0
            for line, frame in zip(shown, frames):
                if test_decode.is_decoded(frame):
                    for name, (raw, _) in second_reader.decode(frame[1], frame[5]).items():
                        if raw in frame[1].signal(name).names:
                            self.assertRegex(line, rf"\b{name} +{re.escape(frame[1].signal(name).names[raw])} \(-?[0-9.]+[^()]*\)")
                            names += 1
            self.assertGreater(names, 50)

    def test_other_verbs(self):
        for tool, database, frames, log in self.each():
            message = database.message(MULTIPLEXED[tool.spec.name])
            signal = next(signal for signal in message.signals if signal.selector)
            field = f"{message.name}.{signal.name}"
            sent = sum(frame[1] is message and len(frame[5]) >= message.length for frame in frames)
            found = json.loads(tool.run("stats", "--json", log))["buses"][0]
            self.assertEqual([topic["count"] for topic in found["topics"] if topic["topic"] == message.name], [sent])
            tool.run("stats", log, "--assert", f"{message.name}.count=={sent}")
            tool.run("stats", log, "--assert", f"{message.name}.count>{sent}", code=1)
            self.assertIn(signal.name, tool.run("plot", log, field, "--script"))
            only = [json.loads(line) for line in tool.run("decode", "--json", "--topic", message.name, log).splitlines()]
            self.assertEqual({line["topic"] for line in only}, {message.name})
            self.assertGreaterEqual(len(only), sent)
            self.assertEqual(len(tool.run("replay", "--dry-run", log).splitlines()), len(frames))
            analysed = json.loads(tool.run("analyse", "bus", "--json"))
            # Each message is in the set, CAN FD too, or is left out with a reason.
            counted = {entry["name"] for entry in analysed["messages"]}
            left_out = {entry["name"] for entry in analysed["left_out"]}
            self.assertEqual(counted | left_out, {message.name for message in database.messages})
            self.assertLessEqual({message.name for message in database.messages if message.attributes.get("GenMsgCycleTime")
                                  and not (message.j1939 and message.length > 8)}, counted)
            shown = tool.run("analyse", "bus")
            for name in left_out:
                self.assertRegex(shown, rf"\(\d+\): .*\b{name}\b")
            self.assertIn(message.name, tool.run("info", message.name))
            tool.run("info", message.name + "x", code=2)
            self.assertIn("did you mean", tool.errors)


if __name__ == "__main__":
    unittest.main()
