"""The JSON schema of a DBC file, on what `amiroctl decode --json` prints of random files and frames: every line fits, and what no line
can be does not."""

import copy
import json
import os
import pathlib
import random
import subprocess
import unittest

import jsonschema

import random_dbc
import second_reader
import test_transport
import write_dbc
from test_decode import EXPLORE, FOLDER, FRAMES, Case, Tool, data_of, frames_of_file, log_of

GENERATE = os.environ["OCM_GENERATE"]
SEEDS = range(3 * EXPLORE)


class Schema(Case):
    def validator(self, spec):
        done = subprocess.run([GENERATE, spec, "--to", "json-schema", "-o", "-"], check=True, capture_output=True, timeout=60)
        schema = json.loads(done.stdout)
        jsonschema.Draft7Validator.check_schema(schema)
        return jsonschema.Draft7Validator(schema)

    def check(self, where, validator, text):
        """The lines, each of which fits."""
        lines = [json.loads(line) for line in text.splitlines()]
        for line in lines:
            if not validator.is_valid(line):  # is_valid is quick, what is wrong is found slowly
                self.fail(f"{where}: {line}: {[e.message for e in validator.iter_errors(line)]}")
        return lines

    def test_random_files(self):
        for seed in SEEDS:
            spec, log = self.folder / f"{seed}.dbc", self.folder / f"{seed}.log"
            database = random_dbc.database(seed)
            spec.write_text(write_dbc.write(database, seed), encoding="utf-8")
            log.write_text(log_of(random_dbc.frames(seed, database, FRAMES)))
            lines = self.check(f"seed {seed}", self.validator(spec), Tool(self, self.folder, spec).run("decode", "--json", log))
            self.assertGreater(sum("fields" in line for line in lines), FRAMES // 2)
            self.assertGreater(sum("error" in line for line in lines), 0)

    def test_several_frames_of_j1939(self):
        whole = 0
        for seed in SEEDS[:2 * EXPLORE]:
            found = test_transport.database(seed)
            spec, log = self.folder / f"{seed}.dbc", self.folder / f"{seed}.log"
            spec.write_text(write_dbc.write(found, seed), encoding="utf-8")
            log.write_text("".join("(%d.%06d) can%d %08X#%s\n" % (*divmod(micros, 1_000_000), bus, number, data.hex().upper())
                                   for micros, bus, number, data in test_transport.traffic(seed, found)))
            lines = self.check(f"seed {seed}", self.validator(spec), Tool(self, self.folder, spec).run("decode", "--json", log))
            whole += sum("fields" in line.get("message", {}) for line in lines)
        self.assertGreater(whole, 20 * EXPLORE)

    def test_files_of_a_folder(self):
        """Random bytes of each of their messages; a file without messages has no schema."""
        for spec in sorted(pathlib.Path(FOLDER).glob("*.dbc")):
            database = second_reader.read(spec.read_bytes())
            if not database.messages:
                refused = subprocess.run([GENERATE, spec, "--to", "json-schema", "-o", "-"], capture_output=True, text=True, timeout=60,
                                         check=False)
                self.assertEqual(refused.returncode, 1, spec)
                self.assertIn("has neither topics nor messages", refused.stderr)
                continue
            frames = frames_of_file(spec.name, database)
            frames += [(2_000_000 + index, message, message.number, True, False, data_of(random.Random(index), message))
                       for index, message in enumerate(database.messages) if message.j1939 and 0 < message.length <= 8]
            log = self.folder / f"{spec.stem}.log"
            log.write_text(log_of(frames))
            lines = self.check(spec, self.validator(spec), Tool(self, self.folder, spec).run("decode", "--json", log))
            self.assertEqual(sum("fields" in line for line in lines), len(frames), spec)

    def test_what_no_line_can_be(self):
        car, truck = (pathlib.Path(os.environ["OCM_SOURCE_DIR"]) / "examples" / name for name in ("small_car.dbc", "truck.dbc"))
        log = self.folder / "drive.log"
        log.write_text("(0.0) can0 100#00112233445566FF\n(0.1) can0 400#0302030405060708\n(0.2) can0 310#0000C07F0000807F\n"
                       "(0.3) can0 310#00\n(0.4) can0 500##1" + "00" * 32 + "\n")
        validator = self.validator(car)
        engine, page, trip, short, cells = self.check("car", validator, Tool(self, self.folder, car).run("decode", "--json", log))
        self.assertEqual((trip["fields"], cells["fd"]["brs"], "error" in short),
                         ({"Distance": "NaN", "Consumption": "Infinity"}, True, True))
        for line, change in ((engine, {"topic": "Motor"}), (engine, {"id": "101"}), (engine, {"id": "00000100"}), (engine, {"frame": "x"}),
                             (engine, {"fields": {"Speed": 16383.8}}), (engine, {"fields": {"Speed": -1}}), (engine, {"fields": {"x": 1}}),
                             (engine, {"names": {"Running": "perhaps"}}), (engine, {"names": {"Speed": "stopped"}}), (trip, {"names": {}}),
                             (engine, {"fields": {"Coolant": "NaN"}}), (engine, {"units": {"Speed": "1/s"}}), (engine, {"error": "both"}),
                             (engine, {"priority": 3}), (engine, {"pgn": "00001"}), (page, {"fields": {"Page": 256}}),
                             (trip, {"fields": {"Distance": "far"}}), (trip, {"fields": {"Distance": None}}), (short, {"fields": {}})):
            self.assertFalse(validator.is_valid({**copy.deepcopy(line), **change}), (line, change))
        log.write_text("(0.0) can0 0CF00417#0011223344556677\n")
        validator = self.validator(truck)
        line, = self.check("truck", validator, Tool(self, self.folder, truck).run("decode", "--json", log))
        self.assertEqual((line["topic"], line["priority"], line["source"]), ("EEC1", 3, 0x17))
        for change in ({"priority": "high"}, {"priority": 8}, {"pgn": "0F005"}, {"source": 256}, {"transport": "packet"},
                       {"message": {}}, {"topic": "TSC1"}):
            self.assertFalse(validator.is_valid({**copy.deepcopy(line), **change}), change)
        for key in ("pgn", "priority", "source", "destination", "topic", "fields", "units", "data"):
            self.assertFalse(validator.is_valid({k: v for k, v in line.items() if k != key}), key)


if __name__ == "__main__":
    unittest.main()
