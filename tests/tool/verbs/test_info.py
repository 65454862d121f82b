"""amiroctl info of a message: all that its spec says, which the catalogue of frames does not need."""

import json
import os

from harness import Case, main

DBC = """BU_: Gearbox Dash Logger

BO_ 256 Transmission: 8 Gearbox
 SG_ Gear : 0|4@1- (1,0) [-1|5] "" Dash,Logger
 SG_ Oil : 8|8@1+ (1,-40) [-40|150] "°C" Dash
 SG_ Ratio : 32|32@1- (1,0) [0|0] "" Vector__XXX
BO_ 257 Bare: 1 Gearbox

BO_TX_BU_ 256 : Gearbox,Logger;
CM_ BO_ 256 "says \\"so\\",
in two lines";
CM_ SG_ 256 Gear "of the lever";
BA_DEF_ BO_ "GenMsgSendType" ENUM "Cyclic","OnChange";
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 10000;
BA_DEF_ BO_ "Safety" STRING;
BA_DEF_ SG_ "GenSigStartValue" FLOAT 0 100000;
BA_DEF_ SG_ "Display" INT 0 9;
BA_DEF_DEF_ "GenMsgSendType" "Cyclic";
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_DEF_DEF_ "Safety" "";
BA_DEF_DEF_ "GenSigStartValue" 0;
BA_DEF_DEF_ "Display" 0;
BA_ "GenMsgSendType" BO_ 256 1;
BA_ "Safety" BO_ 256 "QM";
BA_ "GenSigStartValue" SG_ 256 Gear -1;
BA_ "GenSigStartValue" SG_ 256 Oil 60;
BA_ "GenSigStartValue" SG_ 256 Ratio 0.1;
BA_ "Display" SG_ 256 Oil 7;
VAL_ 256 Gear -1 "Reverse" 0 "Neutral" ;
SIG_VALTYPE_ 256 Ratio : 1;
"""


class Info(Case):
    def spec(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return "--spec", path

    def test_identifiers_are_those_of_its_own_priority(self):
        out, _ = self.run_tool("info", "batteries")
        self.assertIn("priority   low unless asked otherwise\n", out)
        self.assertIn("id 0x2B, on the bus 72B at low priority, DLC 8\n", out)
        self.assertIn("on the bus 608 at medium priority", self.run_tool("info", "gyro")[0])

    def test_what_topic_and_fields_are_for(self):
        out, _ = self.run_tool("info", "home")
        self.assertIn("\n  comment    drives to the nearest wall and stands before it, head on: ", out)
        self.assertRegex(out, r"\n    distance .*\n      comment   from the wall to the robot's edge, from 0.03 m; 0 with speed 0, its end\n")
        # Of equal topics and frames, each; of its equal frames a topic says it once.
        for word, name in (("led", "led_1"), ("led_8", "led_8")):
            out, _ = self.run_tool("info", word)
            self.assertTrue(out.startswith(f"{name} (actuator of light_ring"), out)
            self.assertIn("\n  group      led_1 to led_8, which are alike\n", out)
            self.assertIn("\n  comment    colour of one of the eight lights of the ring\n", out)
        out, _ = self.run_tool("info", "di_wheel_drive_status")
        for text in ("since the start; stays at its end", "of the CPU, over the last second"):
            self.assertEqual(out.count(f"      comment   {text}\n"), 1)
        out, _ = self.run_tool("info", "light_ring_status")  # like that of another board
        self.assertIn("\n      comment   since the start", out)

    def test_an_identifier_of_the_bus_is_no_number_of_a_topic(self):
        for word, what in (("0x608", "a sample of gyroscope"), ("608", "a sample of gyroscope"), ("0x208", "a request to gyroscope"),
                           ("0x201", "a set point of motors"), ("0x603", "a sample of odometry"), ("0x61F", "a sample of proximity_ring")):
            _, err = self.run_tool("info", word, code=2)
            self.assertIn(f"info: no topic '{word}'\n          it is the identifier of {what}\n", err)
        for word in ("0x2FF", "0x888", "0x201 "):
            self.assertNotIn("identifier of", self.run_tool("info", word, code=2)[1])

    def test_what_is_derived(self):
        out, _ = self.run_tool("info", "ring")
        lines = [" ".join(line.split()) for line in out.splitlines()]
        self.assertIn("distance derived: root of 0.942693757 / (proximity - 2350) [0.0038, 0.2] m", lines)
        self.assertIn("distance_uncertainty standard deviation of distance by the noise of proximity, 4.57 [0, 0.019] m", lines)

    def test_of_two_quantities_each_has_its_comment(self):
        """Behind its own line, in the first of equal frames; of their uncertainties nothing is said."""
        out, _ = self.run_tool("--spec", os.path.join(os.environ["OCM_SOURCE_DIR"], "tests", "generator", "golden", "whole.json"), "info", "ring")
        lines = out.splitlines()
        for name, comment in (("distance", "dark things seem far away"), ("glow", "rough. Very.")):
            first = next(i for i, line in enumerate(lines) if line.startswith(f"    {name} "))
            self.assertEqual(lines[first + 1], f"      comment   {comment}", out)
        self.assertEqual(out.count("\n      comment "), 2, out)
        # Without noise there is no uncertainty behind it.
        with open(os.path.join(os.environ["OCM_SOURCE_DIR"], "tests", "generator", "golden", "whole.json"), encoding="utf-8") as file:
            spec = json.load(file)
        for topic in spec["topics"]:
            for frame in topic.get("frames", []):
                for derived in frame.get("derived", []):
                    if derived["name"] == "distance":
                        derived["noise"] = 0
        out, _ = self.run_tool(*self.spec("exact.json", json.dumps(spec)), "info", "ring")
        lines = out.splitlines()
        for name, comment in (("distance", "dark things seem far away"), ("glow", "rough. Very.")):
            first = next(i for i, line in enumerate(lines) if line.startswith(f"    {name} "))
            self.assertEqual(lines[first + 1], f"      comment   {comment}", out)

    def test_a_message_by_its_number_and_a_field_by_its_name(self):
        car = ("--spec", os.path.join(os.environ["OCM_SOURCE_DIR"], "examples", "small_car.dbc"))
        self.assertIn("Engine (message of EngineControl, id 0x100)", self.run_tool(*car, "info", "0x100")[0])
        _, err = self.run_tool(*car, "info", "Torque", code=2)
        self.assertIn("it is a field of Engine: Engine.Torque", err)
        _, err = self.run_tool(*car, "decode", "--field", "Torque", code=2)
        self.assertIn("it is a field of Engine: Engine.Torque", err)
        _, err = self.run_tool("info", "red", code=2)
        self.assertIn("it is a field of led_1, led_2, led_3 and 5 more: led_1.red", err)
        both = self.spec("both.dbc", "BU_: A\nBO_ 2147484160 Wide: 8 A\nBO_ 512 Narrow: 8 A\nBO_ 2566844926 Long: 8 A\n")
        self.assertIn("Narrow (message", self.run_tool(*both, "info", "0x200")[0])
        self.assertIn("Long (message", self.run_tool(*both, "info", "0x18FEF1FE")[0])

    def test_what_a_dbc_file_says(self):
        out, err = self.run_tool(*self.spec("car.dbc", DBC), "info", "Transmission")
        self.assertEqual(err, "")
        lines = out.splitlines()
        self.assertIn("Transmission (message of Gearbox, id 0x100)", lines[0])
        for line in ('  comment    says "so",', "             in two lines", "  senders    Gearbox, Logger", "  send type  OnChange",
                     "  attribute  Safety = QM"):
            self.assertIn(line, lines, out)
        gear, oil, ratio = (next(i for i, line in enumerate(lines) if line.startswith("    " + name + " ")) for name in ("Gear", "Oil", "Ratio"))
        self.assertLessEqual({"      start     -1 (Reverse)", "      receivers Dash, Logger", "      comment   of the lever"}, set(lines[gear:oil]))
        self.assertLessEqual({"      start     20 °C", "      receivers Dash", "      attribute Display = 7"}, set(lines[oil:ratio]))
        self.assertIn("      start     0.1", lines[ratio:])
        self.assertNotIn("receivers", "".join(lines[ratio:]))

    def test_what_is_not_said_is_not_shown(self):
        out, _ = self.run_tool(*self.spec("car.dbc", DBC), "info", "Bare")
        self.assertFalse([word for word in ("comment", "senders", "attribute", "receivers", "start") if word in out], out)

    def test_all_of_64_bits(self):
        """From 2^63 on a word without sign is no negative number: neither a value with a name nor the start."""
        spec = self.spec("word.dbc", 'BO_ 1 M: 8 N\n SG_ S : 0|64@1+ (1,0) [0|0] "" N\nVAL_ 1 S 18446744073709551615 "none" 7 "some" ;\n'
                                     'BA_DEF_ SG_ "GenSigStartValue" INT 0 0;\nBA_ "GenSigStartValue" SG_ 1 S 18446744073709551615;\n')
        out, err = self.run_tool(*spec, "info", "M")
        self.assertEqual(err, "")
        self.assertIn("= 18446744073709551615 none\n", out)
        self.assertRegex(out, "= 7 +some\n")
        self.assertIn("      start     18446744073709551615 (none)\n", out)
        self.assertEqual(self.run_tool(*spec, "set", "M", "--dry-run"), ("001#FFFFFFFFFFFFFFFF\n", ""))

    def test_json_and_the_right_message(self):
        """Topics before it, and messages of its name and of others around it."""
        robot = self.spec("robot.json", json.dumps({"robot": "robot", "boards": [{"name": "Dash"}], "messages": [
            {"name": "First", "id": "0x608", "description": "of the first", "fields": [
                {"name": "Level", "byte": 0, "type": "u8", "scale": 0.5, "unit": "%", "start": 9, "description": "of the lamp"}]},
            {"name": "Second", "id": "0x609", "description": "of the second\u001b[2J", "fields": []}]}))
        out, _ = self.run_tool(*robot, *self.spec("car.dbc", DBC), "info", "First")
        self.assertIn("  comment    of the first\n", out)
        self.assertIn("      start     4.5 %\n", out)
        self.assertIn("      comment   of the lamp\n", out)
        out, _ = self.run_tool(*robot, "info", "Second")
        self.assertIn("of the second\\x1b[2J\n", out)  # no text commands the terminal


if __name__ == "__main__":
    main()
