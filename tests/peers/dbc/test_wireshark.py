"""The dissector that ocm-generate makes of a DBC file, in tshark on captures of random frames, against the second reader. Needs tshark."""

import json
import math
import os
import pathlib
import random
import struct
import subprocess
import tempfile
import unittest
from fractions import Fraction

import random_dbc
import second_reader
import write_dbc
from headers import data_of, of_folder, spelled

SOURCE = pathlib.Path(os.environ["OCM_SOURCE_DIR"])
GENERATE = os.environ["OCM_GENERATE"]
EXPLORE = int(os.environ.get("OCM_EXPLORE", "1"))
SEEDS = range(6 * EXPLORE)
FRAMES = 300


def pcap(frames):
    """A capture of SocketCAN frames: (identifier with its flags, fd, data). [tcpdump.org: link type 227; linux/can.h]"""
    out = struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 227)
    for number, (identifier, fd, data) in enumerate(frames):
        packet = struct.pack(">IBBBB", identifier, len(data), 4 if fd else 0, 0, 0) + data.ljust(64 if fd else 8, b"\0")
        out += struct.pack("<IIII", number, 0, len(packet), len(packet)) + packet
    return out


def can_length(message):
    """Of the frame that the message is sent in."""
    return next(length for length in (*range(9), *random_dbc.FD_LENGTHS) if length >= message.length)


class Wireshark(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="ocm-test-")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def tshark(self, spec, frames, *options):
        script, capture = self.folder / "script.lua", self.folder / "capture.pcap"
        subprocess.run([GENERATE, spec, "--to", "wireshark", "-o", script], check=True, timeout=60)
        capture.write_bytes(pcap(frames))
        done = subprocess.run(["tshark", "-X", f"lua_script:{script}", "-r", capture, *options], capture_output=True, encoding="utf-8",
                              timeout=120, check=True, env={"PATH": "/usr/bin:/bin", "HOME": str(self.folder), "LC_ALL": "C.UTF-8"})
        self.assertNotIn("Lua:", done.stderr)
        return done.stdout

    def dissect(self, bus, spec, frames):
        """Per frame the protocol's fields by name; None where the dissector left it alone."""
        packets = [json.loads(line) for line in self.tshark(spec, frames, "-T", "ek").splitlines() if '"layers"' in line]
        self.assertEqual(len(packets), len(frames))
        found = []
        for packet in packets:
            fields = packet["layers"].get(bus)
            found.append(fields and {name.removeprefix(f"{bus}_{bus}_"): value for name, value in fields.items()})
        return found

    def check(self, where, message, identifier, data, fields):
        self.assertIsNotNone(fields, where)
        self.assertEqual((fields["message"], fields.get("sender", "Vector__XXX")), (message.name, message.sender), where)
        if message.j1939:
            group, low = second_reader.group(identifier), (identifier >> 16 & 0xFF) < 240
            self.assertEqual([int(str(fields[name]), 0) for name in ("pgn", "source", "destination")],
                             [group, identifier & 0xFF, identifier >> 8 & 0xFF if low else 255], where)
        before = spelled(message.name) + "_"
        shown = {name.removeprefix(before): value for name, value in fields.items() if name.startswith(before)}
        if len(data) < message.length:
            self.assertEqual(shown, {}, where)
            return 0
        expected = {spelled(name): (message.signal(name), *values) for name, values in second_reader.decode(message, data).items()}
        self.assertEqual(set(shown), set(expected), where)
        for name, (signal, raw, physical) in expected.items():
            place = f"{where}: {signal} of {data.hex()}: {shown[name]}, not {physical}"
            if isinstance(physical, float):
                self.assertEqual(str(shown[name]).lower().replace("-nan", "nan").replace("infinity", "inf"), str(physical), place)
                continue
            value = float(shown[name])
            if math.isinf(value):  # a product in between is beyond what a double holds
                self.assertGreater(abs(physical), 1e300, place)
            elif not signal.floating and signal.scale == 1 and signal.offset == 0:
                self.assertEqual(int(shown[name]), physical, place)
            else:  # fifteen digits are shown
                scale = max(abs(physical), abs(signal.offset), abs(physical - signal.offset))
                self.assertLessEqual(abs(Fraction(value) - physical), scale * Fraction(6, 10**15), place)
        return len(expected)

    def test_random_files(self):
        fields = 0
        for seed in SEEDS:
            database = random_dbc.database(seed)
            spec = self.folder / "bus.dbc"
            spec.write_text(write_dbc.write(database, seed), encoding="utf-8")
            frames = [frame for frame in random_dbc.frames(seed, database, FRAMES) if frame[5]]  # of empty ones no dissector is asked
            sent = [(identifier | (0x80000000 if extended else 0), fd, data) for _, _, identifier, extended, fd, data in frames]
            for index, (frame, found) in enumerate(zip(frames, self.dissect("bus", spec, sent))):
                _, message, identifier, _, _, data = frame
                if message is None:
                    self.assertIsNone(found, (seed, index))
                else:
                    fields += self.check(f"seed {seed}, frame {index}", message, identifier, data, found)
        self.assertGreater(fields, 500 * len(SEEDS))

    def test_examples(self):
        for name in ("small_car", "truck"):
            spec = SOURCE / "examples" / f"{name}.dbc"
            database = second_reader.read(spec.read_bytes())
            chance = random.Random(1)
            frames = [(message, random_dbc.sent_as(chance, message), random_dbc.data_of(chance, message))
                      for message in database.messages for _ in range(20)]
            sent = [(number | (0x80000000 if message.extended else 0), "FD" in message.frame_format, data)
                    for message, number, data in frames]
            for (message, number, data), found in zip(frames, self.dissect(name, spec, sent)):
                self.check(message.name, message, number, data, found)

    def test_files_of_a_folder(self):
        """Frames of each message that is there in one frame."""
        fields = 0
        for spec, messages in of_folder():
            chance = random.Random(spec.name)
            frames = [(message, data_of(chance, message).ljust(can_length(message), b"\0")) for message in messages for _ in range(5)
                      if message.length <= 8 or not message.j1939]
            sent = [(message.number | (0x80000000 if message.extended else 0), message.length > 8 or "FD" in message.frame_format, data)
                    for message, data in frames]
            with self.subTest(spec.name):
                name = spelled(spec.stem)
                shown = self.dissect(name + "_bus" if name in ("can", "j1939", "uds") else name, spec, sent)
                for (message, data), found in zip(frames, shown):
                    fields += self.check(f"{spec.name}: {message.name}", message, message.number, data[:message.length], found)
        self.assertGreater(fields, 100)

    def test_words(self):
        """Names of values, units, what is too short; and of strangers nothing."""
        frames = [(0x110, False, bytes.fromhex("F4640000")), (0x100, False, bytes(3)), (0x400, False, bytes.fromhex("01000000FFFFFFFF")),
                  (0x80000100, False, bytes(8)), (0x40000100, False, b""), (0x20000004, False, bytes(8)), (0x101, False, b"\0")]
        text = self.tshark(SOURCE / "examples" / "small_car.dbc", frames, "-V")
        for part in ("small_car, Transmission", "Gear: Reverse (-1)", "Lever: Sport (4)", "OilTemperature: 60 °C", "Sender: EngineControl",
                     "3 bytes, fewer than 8", "Page: faults (1)", "FaultActive: 1"):
            self.assertIn(part, text)
        self.assertNotIn("OperatingTime", text)
        self.assertEqual(text.count("Message: "), 3)
        for fields in self.dissect("truck", SOURCE / "examples" / "truck.dbc", [(0x80000000 | 0x18FFFF00, False, bytes(8)),
                                                                              (0x40000004, False, b""), (0x20000004, False, bytes(8)),
                                                                              (0x004, False, bytes(8)), (0xC0000003, False, b"")]):
            self.assertIsNone(fields)

    def test_names_that_wireshark_has(self):
        for name in ("can", "j1939", "uds"):
            spec = self.folder / f"{name}.dbc"
            spec.write_bytes((SOURCE / "examples" / "small_car.dbc").read_bytes())
            fields, = self.dissect(f"{name}_bus", spec, [(0x200, False, bytes((1, 0)))])
            self.assertEqual(str(fields["Doors_DriverOpen"]), "1")

    def test_odd_names(self):
        spec = self.folder / "bus.json"
        spec.write_text(json.dumps({"robot": "7 odd/\"names\" of", "messages": [
            {"name": "a-b", "id": 1, "description": "in \"quotes\"", "fields": [
                {"name": "x.y", "byte": 0, "type": "u8", "unit": "\u00b0\\"},
                {"name": "x-y", "byte": 1, "type": "u8", "values": {"quoted \"": 1, "back\\": 2, "two\nlines": 3}},
                {"name": "lamps", "byte": 2, "type": "u8", "flags": {"left": 0, "a new": 7}}]},
            {"name": "a.b", "id": 2, "length": 8, "fields": [{"name": "u", "byte": 0, "type": "u64"}]}]}))
        first, second = self.dissect("n7_odd_names_of", spec, [(1, False, bytes((5, 2, 0x81))), (2, False, b"\xff" * 8)])
        self.assertEqual([str(first[name]) for name in ("a_b_x_y", "a_b_x_y_2", "a_b_lamps")], ["5", "2", "129"])
        self.assertEqual(str(second["a_b_2_u"]), str((1 << 64) - 1))


if __name__ == "__main__":
    unittest.main()
