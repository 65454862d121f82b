"""Topics with floating-point numbers: on every verb that reads or makes their frames they are numbers like others."""

import json
import os
import pathlib

import harness

PROBE = ("--spec", os.path.join(harness.SOURCE, "tests", "generator", "probe.json"))
# 1.5 m and -2 (big-endian); 44 deg; 1 with scale 0.5 and offset -10; 1.0 from bit 3 on; a set point.
FRAMES = ("610#0000C03FC0000000", "620#0000000000004640", "621#3FF0000000000000", "622#010000FC01FFFFFF", "230#0000C03F0000807F")
VALUES = ({"depth": 1.5, "ratio": -2}, {"value": 44}, {"value": -9.5}, {"valid": 1, "voltage": 0.001, "number": -1},
          {"force": 1.5, "gain": "Infinity"})


class FloatTopics(harness.Case):
    def log(self):
        path = pathlib.Path(self.folder) / "dive.log"
        path.write_text("".join(f"({i}.000000) can0 {frame}\n" for i, frame in enumerate(FRAMES)), encoding="ascii")
        return str(path)

    def test_decode_and_encode(self):
        out, _ = self.run_tool(*PROBE, "decode", self.log(), "--json")
        self.assertEqual([line["fields"] for line in self.objects(out)], list(VALUES))
        # Of the values alone the same bytes.
        lines = "".join(json.dumps({key: value for key, value in line.items() if key != "data"}) + "\n" for line in self.objects(out))
        back, _ = self.run_tool(*PROBE, "encode", stdin=lines)
        self.assertEqual([line.split()[2] for line in back.splitlines()], list(FRAMES))
        out, _ = self.run_tool(*PROBE, "decode", self.log(), "--csv", "--where", "depth.depth>1.4m", "--where", "depth.depth<1.6m")
        self.assertIn("depth,depth,1.5,m", out)

    def test_set(self):
        for words, frame in ((("force=1.5N", "gain=2"), "230#0000C03F00000040"), (("gain=-0.1",), "230#00000000CDCCCCBD")):
            out, _ = self.run_tool(*PROBE, "set", "thrust", *words, "--dry-run")
            self.assertEqual(out.strip(), frame)
        # The range of a topic is no advice: motors have one.
        for value, options in (("41N", ()), ("-2.6N", ("--force",)), ("nan", ()), ("inf", ())):
            _, err = self.run_tool(*PROBE, "set", "thrust", f"force={value}", "--dry-run", *options, code=2)
            self.assertIn(f"'{value}' is beyond the stated range: force takes -2.5 to 40 N\n          a value within it", err)

    def test_listen(self):
        """On the bus of another robot's simulator."""
        self.start_sim()
        listener = self.listen(*PROBE, "--commands", "-n", str(len(FRAMES)))
        for frame in FRAMES:
            self.run_tool("send", frame)
        out, _ = listener.communicate(timeout=60)
        self.assertEqual([line["fields"] for line in self.objects(out)], list(VALUES))


if __name__ == "__main__":
    harness.main()
