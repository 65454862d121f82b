"""The JSON schema, on what `amiroctl listen --json` really prints. Needs python3-jsonschema (Debian)."""
import copy
import json
import os
import sys
import unittest

import jsonschema

from peers import ROOT, SPECS, generate, samples

sys.path.insert(0, str(ROOT / "tests" / "tool" / "verbs"))
os.environ.setdefault("AMIROCTL", "amiroctl")
import harness  # noqa: E402


def line_of(sample):
    """As `listen --json` prints it."""
    fields = {name: float(field["value"]) for name, field in sample["fields"].items()}
    words = {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}  # JSON has no numbers for these
    fields = {name: words.get(str(value), value) for name, value in fields.items()}
    return {"time_ns": "1", "bus": "sim", "id": f'{sample["id"]:03X}', "priority": sample["priority"],
            "topic": sample["topic"], "frame": sample["frame"] or sample["topic"], "fields": fields,
            "units": {name: field["unit"] for name, field in sample["fields"].items()}, "data": sample["data"]}


class Schema(unittest.TestCase):
    def validator(self, robot):
        schema = json.loads(generate(SPECS[robot], "--to", "json-schema", "-o", "-"))
        jsonschema.Draft7Validator.check_schema(schema)
        return jsonschema.Draft7Validator(schema)

    def test_is_indented_as_people_write_it(self):
        for robot in SPECS:
            text = generate(SPECS[robot], "--to", "json-schema", "-o", "-")
            self.assertEqual(text.splitlines(), json.dumps(json.loads(text), indent=2, ensure_ascii=False).splitlines())

    def test_takes_every_frame_at_every_value(self):
        for robot in SPECS:
            validator = self.validator(robot)
            for sample in samples(robot, 6):
                self.assertEqual([e.message for e in validator.iter_errors(line_of(sample))], [], sample)

    def test_refuses_what_no_line_can_be(self):
        validator = self.validator("amiro")
        good = line_of(next(s for s in samples("amiro", 1) if s["topic"] == "gyroscope"))
        self.assertTrue(validator.is_valid(good))
        for change in ({"topic": "gyro"}, {"frame": "x"}, {"id": "005"}, {"time_ns": 1}, {"priority": "big"},
                       {"data": "0"}, {"fields": {"w": 1}}, {"fields": {"x": "1"}}, {"fields": {"x": 573.44}},
                       {"units": {"x": "rad/s"}}, {"error": "both"}, {"more": 1}, {"fd": {"x": True}},
                       {"direction": "up"}):
            self.assertFalse(validator.is_valid({**copy.deepcopy(good), **change}), change)
        for key in ("time_ns", "bus", "id", "data", "topic", "fields"):
            self.assertFalse(validator.is_valid({k: v for k, v in good.items() if k != key}), key)


class RealLines(harness.Case):
    def schema(self, *specs):
        """Of several specs it is amiroctl that makes it."""
        text, _ = self.run_tool(*specs, "generate", "json-schema")
        return jsonschema.Draft7Validator(json.loads(text))

    def check(self, schema, lines):
        for line in lines:
            self.assertEqual([e.message for e in schema.iter_errors(line)], [], line)

    def test_a_bound_beyond_64_bits(self):
        spec = os.path.join(self.folder, "far.dbc")
        with open(spec, "w", encoding="utf-8") as file:
            file.write('BU_: A\nBO_ 1 Far: 8 A\n SG_ X : 0|56@1+ (1000,0) [0|0] "" A\n')
        out, _ = self.run_tool("--spec", spec, "decode", "-", "--from", "candump", "--json", stdin="(1.0) can0 001#FFFFFFFFFFFFFF00\n")
        lines = self.objects(out)
        self.assertEqual([line["fields"]["X"] for line in lines], [(2**56 - 1) * 1000])
        self.check(self.schema("--spec", spec), lines)

    def test_of_simulated_messages(self):
        """Those of a car and of a truck, each alone, and beside the AMiRo's topics."""
        car, truck, fast = ROOT / "examples" / "small_car.dbc", ROOT / "examples" / "truck.dbc", os.path.join(self.folder, "fast.dbc")
        with open(fast, "w", encoding="utf-8") as file:  # at the others' bit rate
            file.write(truck.read_text(encoding="utf-8").replace("250000", "500000"))
        for files in ((car,), (truck,), (SPECS["amiro"], fast, car)):
            specs = [word for file in files for word in ("--spec", str(file))]
            schema = self.schema(*specs)
            sim = self.start_sim(*specs)
            listener = self.start("listen", "--json", "-n", "60", *specs)
            out, _ = listener.communicate(timeout=60)
            self.check(schema, self.objects(out))
            topics = {line.get("topic") for line in self.objects(out)}
            self.assertTrue({"Engine", "EEC1"} & topics, topics)
            self.interrupt(sim)

    def test_of_a_simulated_robot(self):
        schema = jsonschema.Draft7Validator(json.loads(generate(SPECS["amiro"], "--to", "json-schema", "-o", "-")))
        self.start_sim()
        listener = self.listen("--commands")
        # Requests good and bad, set points, samples of every sensor, a wrong length, a stranger, a remote frame.
        sent = ["205#01140000", "205#01", "205#03", "205#00", "204#02", "21E#02", "203#02", "21F#02", "31B#02",
                "201#0000000000000000", "240#643278", "608#00", "6FF#01", "1F334455#DEAD", "608#R"]
        for frame in sent:
            self.run_tool("send", frame)
        self.settle()
        out, _ = self.interrupt(listener)
        lines = self.objects(out)
        topics = {line.get("topic") for line in lines if "fields" in line}
        self.assertLessEqual({"magnetometer", "power_status", "proximity_ring", "motors", "led_5"}, topics)
        self.assertTrue(any("error" in line for line in lines))
        self.check(schema, lines)


if __name__ == "__main__":
    unittest.main()
