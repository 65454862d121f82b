"""The dissector, in tshark on captures that are made here. Needs tshark."""
import json
import struct
import subprocess
import unittest
from decimal import Decimal

from peers import Case, SPECS, full_name, generate, is_near, samples


def pcap(frames):
    """A capture of SocketCAN frames. [tcpdump.org: link type 227]"""
    out = struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 227)
    for number, (id, data) in enumerate(frames):
        packet = struct.pack(">IBBBB", id, len(data), 0, 0, 0) + data.ljust(8, b"\0")
        out += struct.pack("<IIII", number, 0, len(packet), len(packet)) + packet
    return out


class Wireshark(Case):
    def tshark(self, robot, frames, *options):
        """`robot`: of SPECS, or the path of another."""
        script, capture = self.folder / "robot.lua", self.folder / "capture.pcap"
        script.unlink(missing_ok=True)
        generate(SPECS.get(robot, robot), "--to", "wireshark", "-o", script)
        capture.write_bytes(pcap(frames))
        done = subprocess.run(["tshark", "-X", f"lua_script:{script}", "-r", capture, *options], capture_output=True,
                              encoding="utf-8", timeout=120, check=True,
                              env={"PATH": "/usr/bin:/bin", "HOME": str(self.folder), "LC_ALL": "C.UTF-8"})
        self.assertNotIn("Lua:", done.stderr)
        return done.stdout

    def dissect(self, robot, frames):
        """Per frame the protocol's fields by name; None where the dissector left it alone."""
        lines = self.tshark(robot, frames, "-T", "ek").splitlines()
        packets = [json.loads(line) for line in lines if '"layers"' in line]
        self.assertEqual(len(packets), len(frames))
        return [packet["layers"].get(robot) for packet in packets]

    def value(self, fields, robot, name):
        return fields[f"{robot}_{robot}_" + name.replace(".", "_")]

    def test_every_field_has_the_value_of_the_catalogue(self):
        for robot in SPECS:
            expected = list(samples(robot, 12))
            found = self.dissect(robot, [(s["id"], bytes.fromhex(s["data"])) for s in expected])
            for sample, fields in zip(expected, found):
                if not sample["data"]:
                    continue  # Wireshark passes frames without data to no dissector
                self.assertIsNotNone(fields, sample)
                self.assertEqual(self.value(fields, robot, "topic"), sample["topic"])
                self.assertEqual(int(self.value(fields, robot, "priority")),
                                 ["urgent", "high", "medium", "low"].index(sample["priority"]))
                for name, field in sample["fields"].items():
                    text = self.value(fields, robot, full_name(sample) + "." + name)
                    if "float" in field:  # fifteen digits are shown
                        self.assertTrue(is_near(str(text).replace("-nan", "nan"), field["value"], 1e-14), (sample, name, text))
                        continue
                    shown = Decimal(str(text))
                    slack = Decimal(abs(float(field["value"])) * 2e-15) if field["value"] % 1 or field["width"] > 53 else 0
                    self.assertLessEqual(abs(shown - field["value"]), slack, (sample, name, shown))

    def test_requests_units_names_and_flags(self):
        # [Thesis 4.2, 4.2.1; figure 6.3]
        text = self.tshark("amiro", [(0x205, bytes.fromhex("01840302")), (0x204, b"\x02"), (0x208, b"\x01"),
                                     (0x608, bytes.fromhex("3E001E00FCFF")), (0x61E, bytes.fromhex("0334FFFF5EFC"))], "-V")
        for part in ("magnetometer, request", "Mode: publish (1)", "Count: 900", "Unit: us (2)", "Period in s: 0.0009",
                     "floor_proximity, request", "Mode: once (2)", "Period in s: 0.05", "x: 1.085 deg/s", "z: -0.07 deg/s",
                     "minutes: 65535 min (unknown)", "charging: True", "power: -930 mW"):
            self.assertIn(part, text.replace("[", "").replace("]", ""))

    def test_flags_of_a_wide_field(self):
        spec = self.folder / "wide.json"
        spec.write_text(json.dumps({"robot": "wide", "messages": [{"name": "Wide", "id": "0x123", "fields": [
            {"name": "state", "byte": 0, "type": "u64", "flags": {"low": 0, "middle": 33, "top": 63}}]}]}))
        for bits in (1 << 33, 1 | 1 << 63, 0, (1 << 64) - 1):
            text = self.tshark(spec, [(0x123, bits.to_bytes(8, "little"))], "-V")
            for bit, name in ((0, "low"), (33, "middle"), (63, "top")):
                self.assertIn(f"{name}: {bool(bits >> bit & 1)}", text, hex(bits))

    def test_wrong_lengths_and_bad_requests_are_expert_info(self):
        frames = [(0x608, b"\0" * 5), (0x205, b"\x01\x01"), (0x205, b"\x03"), (0x205, bytes.fromhex("01000000")),
                  (0x205, bytes.fromhex("01010003"))]
        text = self.tshark("amiro", frames, "-V")
        for part in ("5 bytes instead of 6", "2 bytes: 1, or 4 with a period", "mode 3: 0 stop, 1 publish, 2 once",
                     "a period of zero", "unit 3: 0 ms, 1 s, 2 us"):
            self.assertIn(part, text)
        self.assertEqual(text.count("Error/Malformed"), len(frames))

    def test_a_request_of_each_mode_and_length(self):
        requests = [(mode, length) for mode in range(5) for length in range(1, 9)]
        frames = [(0x205, (bytes([mode]) + b"\x01" + b"\0" * 6)[:length]) for mode, length in requests]
        texts = self.tshark("amiro", frames, "-V").split("\nFrame ")
        self.assertEqual(len(texts), len(frames))
        for (mode, length), text in zip(requests, texts):
            with self.subTest(mode=mode, length=length):
                is_wrong = mode <= 2 and length != 1 and (mode, length) != (1, 4)
                self.assertEqual(f"{length} bytes: 1, or 4 with a period" in text, is_wrong)
                self.assertEqual(f"mode {mode}: 0 stop, 1 publish, 2 once" in text, mode > 2)
                self.assertEqual(text.count("Error/Malformed"), int(is_wrong or mode > 2))

    def test_strangers_are_left_alone(self):
        # An unknown number, an extended identifier, a remote frame, an error frame. [linux/can.h]
        for fields in self.dissect("amiro", [(0x6FF, b"\0"), (0x80000608, b"\0" * 6), (0x40000608, b""),
                                             (0x20000004, b"\0" * 8)]):
            self.assertIsNone(fields)


if __name__ == "__main__":
    unittest.main()
