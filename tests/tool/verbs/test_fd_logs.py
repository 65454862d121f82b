"""Logs with CAN FD in every format that is written, with a DBC file's message of 32 bytes: what comes back, what each
verb makes of it, and what a format has no room for is counted."""

import json
import os
import random
import struct

from harness import SOURCE, Case, main

CAR = ("--spec", os.path.join(SOURCE, "examples", "small_car.dbc"))
FORMATS = ("pcapng", "pcap", "mcap", "mcap-raw", "asc", "candump", "candump-ns", "csv", "json")
START = 1436509052


def cells(chance):
    """BatteryCells as CAN FD with any flags: the frame, and the values that a reader of the DBC file's text expects."""
    volt = [chance.randrange(1 << 16) for _ in range(4)]
    ohm, hours = (chance.uniform(-100, 100) for _ in range(2))
    cycles, number = chance.randrange(1 << 16), chance.randrange(1 << 40)
    data = struct.pack("<4H", *volt) + bytes(4) + struct.pack("<fd", ohm, hours) + struct.pack(">H", cycles) + number.to_bytes(5, "big")
    data = data.ljust(32, b"\xA5")
    flags = chance.randrange(4)
    fields = {f"Cell_{i + 1}": value / 10000 for i, value in enumerate(volt)} | {
        "Throughput": hours, "Cycles": cycles, "SerialNumber": number}
    return f"500##{flags}{data.hex().upper()}", flags, fields


class FdLogs(Case):
    def setUp(self):
        super().setUp()
        chance = random.Random(11)
        self.expected = []  # of BatteryCells, in their order: time, flags, fields
        self.lines = []
        self.flagged = 0

        def add(ms, frame, interface="can0"):
            self.lines.append(f"({START + ms // 1000}.{ms % 1000:03}000) {interface} {frame} {chance.choice('RT')}")

        for i in range(50):
            add(100 * i, "100#" + chance.randbytes(8).hex().upper())
            frame, flags, fields = cells(chance)
            add(100 * i + 1, frame)
            self.expected.append((100 * i + 1, flags, fields))
            self.flagged += flags != 0
        add(5000, "500##1" + "00" * 8)  # too short
        add(5001, "500##1" + "77" * 64)  # longer than its message: the same fields
        add(5002, "12345678##2" + "11" * 12)  # of no message
        self.flagged += 3
        self.log = os.path.join(self.folder, "fd.log")
        with open(self.log, "w", encoding="ascii") as file:
            file.write("\n".join(self.lines) + "\n")

    def test_every_format_and_back(self):
        reference = self.objects(self.run_tool(*CAR, "decode", self.log, "--json")[0])
        for name in FORMATS:
            with self.subTest(name):
                path = os.path.join(self.folder, "log." + name)
                _, err = self.run_tool(*CAR, "convert", self.log, path, "--to", name)
                lost = {"csv": ("direction", "bus", "fd"), "pcap": ("direction", "bus")}.get(name, ())
                self.assertEqual("has no room for" in err, bool(lost), err)
                if name == "csv":
                    self.assertIn(f"flags of CAN FD of {self.flagged} frames", err)
                self.run_tool("convert", self.log, path + "2", "--to", name, "--strict", code=1 if lost else 0)
                seen = self.objects(self.run_tool(*CAR, "decode", path, "--json")[0])
                self.assertEqual(len(seen), len(reference))
                for row, same in zip(seen, reference):
                    for key in lost:
                        row.pop(key, None)
                        same.pop(key, None)
                    self.assertEqual(row, same)
                back, _ = self.run_tool(*CAR, "convert", path, "-", "--to", "candump")
                if not lost:
                    self.assertEqual(back.splitlines(), self.lines)
                reference = self.objects(self.run_tool(*CAR, "decode", self.log, "--json")[0])

    def test_values(self):
        rows = [row for row in self.objects(self.run_tool(*CAR, "decode", self.log, "--json")[0])
                if row.get("topic") == "BatteryCells" and "fields" in row]
        self.assertEqual(len(rows), len(self.expected) + 1)
        for row, (ms, flags, fields) in zip(rows, self.expected):
            self.assertEqual(int(row["time_ns"]), START * 10**9 + ms * 10**6)
            self.assertEqual(row["fd"], {"brs": flags & 1 != 0, "esi": flags & 2 != 0})
            for name, value in fields.items():
                self.assertEqual(row["fields"][name], value, name)
        out, _ = self.run_tool(*CAR, "decode", self.log, "--csv", "--field", "BatteryCells.Throughput")
        self.assertEqual([float(line.split(",")[1]) for line in out.splitlines()[1:-1]],
                         [fields["Throughput"] for _, _, fields in self.expected])
        out, err = self.run_tool(*CAR, "decode", self.log, "--pretty", "--topic", "BatteryCells")
        self.assertIn("8 bytes instead of 32", out)
        self.assertEqual(out.count("SerialNumber"), len(self.expected) + 1)

    def test_back_from_json_and_edited(self):
        line = next(row for row in self.objects(self.run_tool(*CAR, "decode", self.log, "--json")[0]) if "fd" in row)
        line["fields"]["Cell_2"] = 3.3
        out, _ = self.run_tool(*CAR, "encode", stdin=json.dumps(line))
        data = out.split()[2][6:]
        self.assertEqual(data[4:8], "E880")  # 33000
        self.assertEqual((data[:4], data[8:]), (line["data"][:4], line["data"][8:]))

    def test_stats_info_and_plot(self):
        def bus(*arguments, spec=CAR[1]):
            report = json.loads(self.run_tool("--spec", spec, "stats", self.log, "--json", *arguments)[0])
            return report["buses"][0]

        silent = os.path.join(self.folder, "car.dbc")  # says nothing of the data's bit rate
        with open(CAR[1], encoding="utf-8") as car, open(silent, "w", encoding="utf-8") as file:
            file.writelines(line for line in car if "BaudrateCANFD" not in line)
        seen = bus(spec=silent)
        slow = sum(flags & 1 for _, flags, _ in self.expected) + 2  # with bit-rate switch
        self.assertEqual((seen["frames"], seen["fd_frames"], seen["fd_frames_not_in_load"]), (103, 53, slow))
        self.assertEqual((seen["unknown"], seen["wrong_length"], seen["data_bit_rate"]), (1, 1, None))
        cell = next(topic for topic in seen["topics"] if topic["topic"] == "BatteryCells")
        self.assertEqual((cell["count"], cell["wrong_length"]), (51, 1))
        self.assertIn(f"{slow} CAN FD frames, not in the load without --data-bitrate",
                      self.run_tool("--spec", silent, "stats", self.log)[0])
        fast, same = bus(), bus("--data-bitrate", "500k")
        self.assertEqual((fast["fd_frames_not_in_load"], fast["data_bit_rate"]), (0, 2_000_000))
        self.assertLess(seen["load_percent"], fast["load_percent"])
        self.assertLess(fast["load_percent"], same["load_percent"])
        # All of it at 500 kbit/s: at least the bits without stuffing, at most a fifth more.
        bits = 50 * (111 + 3) + 51 * 8 * 32 + 64 * 8 + 12 * 8 + 8 * 8 + 53 * 70
        self.assertTrue(bits < same["load_percent"] / 100 * 5.002 * 500e3 < 1.3 * bits)
        self.assertEqual(bus("--data-bitrate", "2M", spec=silent)["load_percent"], fast["load_percent"])
        out, _ = self.run_tool(*CAR, "stats", self.log)
        self.assertIn("at 500 and 2000 kbit/s", out)
        self.assertNotIn("not in the load", out)
        out, _ = self.run_tool(*CAR, "info", "BatteryCells")
        self.assertIn("frame      32 bytes, CAN FD", out)
        out, _ = self.run_tool(*CAR, "list")
        self.assertIn("BatteryCells", out)
        _, err = self.run_tool(*CAR, "plot", self.log, "BatteryCells.Cell_1", "BatteryCells.Throughput", "-o",
                               os.path.join(self.folder, "cells.svg"))
        self.assertIn("102 points of 2 curves", err)


if __name__ == "__main__":
    main()
