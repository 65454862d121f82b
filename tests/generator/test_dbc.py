"""The DBC file, as canmatrix reads it. Needs python3-canmatrix (Debian)."""
import re
import unittest
from decimal import Decimal

import canmatrix
import canmatrix.formats

from peers import Case, SPECS, generate, samples, is_near, real

PRIORITIES = ("urgent", "high", "medium", "low")


def pascal(name):
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


class Dbc(Case):
    def load(self, robot, *options):
        path = self.folder / f"{robot}.dbc"
        generate(SPECS[robot], "--to", "dbc", *options, "-o", path)
        return canmatrix.formats.loadp_flat(str(path))

    def by_id(self, matrix):
        frames = {frame.arbitration_id.id: frame for frame in matrix.frames}
        self.assertEqual(len(frames), len(matrix.frames))
        return frames

    def test_every_field_of_every_frame_has_the_value_of_the_catalogue(self):
        for robot in SPECS:
            frames = self.by_id(self.load(robot))
            seen = set()
            for sample in samples(robot, 50):
                frame = frames[sample["id"]]
                self.assertEqual(frame.name, pascal(sample["topic"]) + pascal(sample["frame"]) + "_" + sample["priority"])
                seen.add(frame.arbitration_id.id)
                self.assertEqual(frame.size, len(sample["data"]) // 2)
                self.assertEqual({s.name for s in frame.signals}, set(sample["fields"]))
                if not sample["fields"]:
                    continue
                decoded = frame.decode(bytes.fromhex(sample["data"]))
                for name, field in sample["fields"].items():
                    self.assertEqual(decoded[name].signal.unit, field["unit"])
                    if "float" in field:
                        self.assertTrue(is_near(decoded[name].raw_value, real(field), 1e-14), (sample, name))
                        self.assertTrue(is_near(decoded[name].phys_value, field["value"], 1e-14), (sample, name))
                        continue
                    self.assertEqual(decoded[name].raw_value, field["raw"], (sample, name))
                    self.assertEqual(Decimal(decoded[name].phys_value), field["value"], (sample, name))
            self.assertGreater(len(seen), len(frames) // 3)

    def test_a_request_of_the_thesis(self):
        # [Thesis 4.2] 205#01840302: the magnetometer every 900 us, medium
        frame = self.by_id(self.load("amiro"))[0x205]
        self.assertEqual((frame.name, frame.transmitters, frame.size), ("MagnetometerRequest_medium", ["operator"], 4))
        decoded = frame.decode(bytes.fromhex("01840302"))
        self.assertEqual({n: s.raw_value for n, s in decoded.items()}, {"mode": 1, "period": 900, "unit": 2})
        self.assertEqual(decoded["mode"].named_value, "publish")
        self.assertEqual(decoded["unit"].named_value, "us")
        self.assertEqual(frame.signal_by_name("mode").receivers, ["di_wheel_drive"])

    def test_senders_receivers_periods_ranges_values_and_sources(self):
        matrix = self.load("amiro")
        frames = self.by_id(matrix)
        self.assertEqual([ecu.name for ecu in matrix.ecus],
                         ["operator", "di_wheel_drive", "power_management", "light_ring"])
        self.assertEqual(matrix.attributes["Baudrate"].strip('"'), "500000")
        gyroscope = frames[0x608]
        self.assertEqual(gyroscope.transmitters, ["di_wheel_drive"])
        # The period stands at the topic's own priority only: the others are not sent besides.
        self.assertEqual([frames[id].cycle_time for id in (0x408, 0x508, 0x608, 0x708)], [0, 0, 50, 0])
        x = gyroscope.signal_by_name("x")
        # +-500 deg/s are 28571 digits of 0.0175.
        self.assertEqual((x.receivers, x.min, x.max, x.factor, x.unit),
                         (["operator"], Decimal("-499.9925"), Decimal("499.9925"), Decimal("0.0175"), "deg/s"))
        self.assertIn("L3G4200D data sheet", gyroscope.comment)
        self.assertEqual(frames[0x201].transmitters, ["operator"])
        self.assertEqual(frames[0x201].signal_by_name("x").receivers, ["di_wheel_drive"])
        self.assertIn("0.5 s", frames[0x201].comment)
        self.assertEqual(frames[0x61E].signal_by_name("minutes").values, {65535: "unknown"})
        self.assertEqual(frames[0x20A].signal_by_name("action").values, {0: "none", 1: "measure", 2: "forget"})
        self.assertIn("Bit 1: charging", frames[0x61E].signal_by_name("flags").comment)
        force = self.by_id(self.load("probe"))[0x230].signal_by_name("force")  # a float
        self.assertEqual((force.min, force.max), (Decimal("-2.5"), Decimal(40)))
        celsius = self.by_id(self.load("ferry"))[0x7B1].signal_by_name("temperature")
        self.assertEqual((celsius.unit, celsius.offset), ("\u00b0C", -40))

    def test_one_priority(self):
        frames = self.by_id(self.load("amiro", "--priority", "high"))
        self.assertEqual({id >> 8 & 3 for id in frames}, {1})
        self.assertEqual(frames[0x508].name, "Gyroscope")

    def test_names_are_short_identifiers_and_the_long_ones_come_back(self):
        for robot in SPECS:
            path = self.folder / "names.dbc"
            generate(SPECS[robot], "--to", "dbc", "-o", path)
            text = path.read_text("latin-1")
            names = re.findall(r"^BO_ \d+ (\S+):", text, re.M) + re.findall(r"^ SG_ (\S+) ", text, re.M)
            self.assertTrue(names)
            for name in names:
                self.assertRegex(name, r"^[A-Za-z_][A-Za-z0-9_]{0,31}$")
        frames = self.by_id(self.load("amiro"))
        self.assertEqual(frames[0x43B].name, "PowerManagementRefusal_urgent")
        self.assertEqual(frames[0x03B].name, "PowerManagementRefusalRequest_urgent")  # 36 characters

    def test_analyse_reads_it(self):
        path = self.folder / "amiro.dbc"
        generate(SPECS["amiro"], "--to", "dbc", "-o", path)
        cyclic = re.findall(r'^BA_ "GenMsgCycleTime" BO_ \d+ (\d+);', path.read_text("latin-1"), re.M)
        self.assertEqual(set(cyclic), {"50", "100", "500", "1000"})


if __name__ == "__main__":
    unittest.main()
