"""MCAP against Foxglove's own library, @mcap/core, which scripts/setup fetches."""

import json
import random
import subprocess
import unittest

import harness
import jsonschema
import mcap_core
import peers

START = 1_700_000_000_000_000_000

# Identifier at medium priority and DLC of each frame. [docs/protocol.md, spec/topics.json]
ODOMETRY, MAGNETOMETER = ((0x602, 8), (0x603, 8)), ((0x605, 4), (0x606, 4), (0x607, 4))
GYROSCOPE, RING = ((0x608, 6),), tuple((0x61F + i, 2) for i in range(8))
MOTORS, LED = ((0x201, 8),), ((0x23C, 3),)


def robot_lines(count, seed):
    """Whole samples, set points and a request of a robot on can0 and another on can1."""
    chance, time, lines = random.Random(seed), START, []
    for _ in range(count):
        interface = chance.choice(("can0", "can1"))
        for number, length in chance.choice((ODOMETRY, MAGNETOMETER, GYROSCOPE, RING, MOTORS, LED, ((0x208, 1),))):
            time += chance.randrange(1, 5_000_000)
            data = "02" if number == 0x208 else chance.randbytes(length).hex().upper()
            lines.append(f"({time // 10 ** 9}.{time % 10 ** 9:09d}) {interface} {number:03X}#{data}")
    return lines


@peers.needs("node", "zstd")
class Foxglove(peers.Case):
    def peer(self, verb, name, stdin=None):
        return mcap_core.run(verb, self.path(name), stdin)

    def written(self, lines, *options):
        self.save("ours.log", "".join(line + "\n" for line in lines))
        self.convert("ours.log", "ours.mcap", *options)
        return self.peer("indexed", "ours.mcap")

    def decoded(self):
        """What `decode --json` makes of the log: interface, topic, fields, for whole samples as a tree of frames."""
        text = self.run_peer(harness.AMIROCTL, "decode", "--json", self.path("ours.log"))
        frames_of = {"odometry": 2, "magnetometer": 3, "proximity_ring": 8}
        under_way, found = {}, []
        for line in map(json.loads, text.splitlines()):
            if "topic" not in line or line["frame"] == "request":
                continue
            key, fields = (line["bus"], line["topic"]), line["fields"]
            if line["topic"] in frames_of:
                sample = under_way.setdefault(key, {})
                sample[line["frame"]] = fields
                if len(sample) < frames_of[line["topic"]]:
                    continue
                fields = under_way.pop(key)
            found.append([*key, line["time_ns"], fields])
        return found

    def test_frames_of_every_kind_are_there_in_order(self):
        lines = peers.random_lines(400, seed=1)
        read = self.written(lines, "--to", "mcap-raw")
        streamed = self.peer("streamed", "ours.mcap")
        self.assertTrue(streamed["done"])
        by_time = sorted(streamed["messages"], key=lambda message: int(message[1]))
        self.assertEqual(sorted(read["messages"], key=lambda m: (int(m[1]), m[0], m[3])),
                         sorted(by_time, key=lambda m: (int(m[1]), m[0], m[3])))
        self.assertEqual([int(m[1]) for m in read["messages"]], sorted(int(m[1]) for m in read["messages"]))
        topics = {channel["id"]: channel["topic"] for channel in read["channels"]}
        self.assertEqual(set(topics.values()), {"/can0/raw", "/can1/raw"})
        schema = json.loads(read["schemas"][0]["data"])
        jsonschema.Draft202012Validator.check_schema(schema)
        self.assertEqual(len(streamed["messages"]), len(lines))
        for line, (channel, time, publish, _, text) in zip(lines, streamed["messages"]):
            message = json.loads(text)
            jsonschema.validate(message, schema)
            stamp, interface, frame, *direction = line.split()
            self.assertEqual(time, stamp.strip("()").replace(".", ""))
            self.assertEqual(publish, time)
            self.assertEqual(topics[channel], f"/{interface}/raw")
            self.assertEqual(self.candump_frame(message), frame)
            self.assertEqual({"received": ["R"], "sent": ["T"]}.get(message.get("direction"), []), direction)

    @staticmethod
    def candump_frame(message):
        """The notation of candump, from the message alone."""
        number = message["id"] | (0x20000000 if message.get("error") else 0)
        wide = message.get("extended") or message.get("error")
        frame, data = f"{number:08X}" if wide else f"{number:03X}", message["data"]
        if message.get("remote"):
            return frame + "#R" + (str(message["length"]) if "length" in message else "")
        if message.get("fd"):
            return frame + f"##{message.get('brs', False) + 2 * message.get('esi', False)}" + data
        return frame + "#" + data + (f"_{message['raw_dlc']:X}" if "raw_dlc" in message else "")

    def test_samples_are_what_decode_says(self):
        lines = robot_lines(300, seed=2)
        read = self.written(lines)
        channels = {channel["id"]: channel for channel in read["channels"]}
        schemas = {schema["id"]: schema for schema in read["schemas"]}
        for schema in schemas.values():
            self.assertEqual(schema["encoding"], "jsonschema")
            jsonschema.Draft202012Validator.check_schema(json.loads(schema["data"]))
        samples = []
        for channel, time, _, _, text in read["messages"]:
            of = channels[channel]
            message = json.loads(text)
            jsonschema.validate(message, json.loads(schemas[of["schemaId"]]["data"]))
            if not of["topic"].endswith("/raw"):
                samples.append([of["metadata"]["interface"], of["topic"].strip("/"), time, message])
        decoded = self.decoded()
        self.assertGreater(len({sample[1] for sample in samples}), 5)
        self.assertEqual(samples, decoded)
        gyroscope = json.loads(next(s["data"] for s in schemas.values() if s["name"] == "AMiRo.gyroscope"))
        self.assertEqual(gyroscope["properties"]["x"]["description"], "deg/s")
        self.assertEqual(len(read["messages"]), len(lines) + len(decoded))

    def test_the_summary_counts_and_says_of_what(self):
        lines = robot_lines(400, seed=3)
        read = self.written(lines)
        statistics = read["statistics"]
        self.assertEqual(int(statistics["messageCount"]), len(read["messages"]))
        self.assertEqual(statistics["channelCount"], len(read["channels"]))
        self.assertEqual(statistics["schemaCount"], len(read["schemas"]))
        self.assertEqual(statistics["chunkCount"], read["chunks"])
        self.assertGreater(read["chunks"], 1)
        self.assertEqual(statistics["messageStartTime"], lines[0].split()[0].strip("()").replace(".", ""))
        self.assertEqual(statistics["messageEndTime"], lines[-1].split()[0].strip("()").replace(".", ""))
        for channel in read["channels"]:
            count = sum(message[0] == channel["id"] for message in read["messages"])
            self.assertEqual(int(statistics["channelMessageCounts"][str(channel["id"])]), count)
        about = dict(read["metadata"])["ocm"]
        self.assertEqual(about["robot"], "AMiRo")
        self.assertRegex(about["wire_hash"], "^0x[0-9A-F]{8}$")
        self.assertRegex(about["tool"], r"^amiroctl \d")
        self.assertEqual(read["header"]["library"], about["tool"])

    def test_there_and_back_bit_by_bit(self):
        lines = peers.random_lines(2000, seed=4) + robot_lines(50, seed=4)
        for options in ((), ("--to", "mcap-raw")):
            self.written(lines, *options)
            self.assertEqual(self.candump_of("ours.mcap"), lines)

    def test_what_their_writer_writes(self):
        frames = [{"data": "0102", "id": 5}, {"id": 0x1ABCDEF0, "extended": True, "data": ""},
                  {"direction": "sent", "id": 6, "remote": True, "length": 4, "data": "", "mine": {"a": ["}", 1]}},
                  {"data": "ab" * 12, "id": 7, "fd": True, "brs": True, "esi": False, "direction": "received"},
                  {"error": True, "id": 4, "data": "0001000000000000"}] * 20
        messages = [["/can7/raw" if i % 3 else "/v%20/raw", str(START + i), frame] for i, frame in enumerate(frames)]
        for chunked in (False, True):
            for indented in (False, True):
                self.peer("write", "theirs.mcap",
                          json.dumps({"chunked": chunked, "indented": indented, "messages": messages}))
                read = self.candump_of("theirs.mcap")
                self.assertEqual(len(read), len(frames))
                for i, (line, frame) in enumerate(zip(read, frames)):
                    # An interface's blank is no blank of the line.
                    number = f"{frame['id'] | (0x20000000 if frame.get('error') else 0):X}"
                    self.assertTrue(line.startswith(f"(1700000000.{i:09d}) "), line)
                    self.assertIn(number, line)
                    self.assertIn(frame["data"].upper(), line)

    def test_cut_off_anywhere(self):
        lines = robot_lines(1200, seed=5)
        whole = self.written(lines)["messages"]
        with open(self.path("ours.mcap"), "rb") as file:
            content = file.read()
        chance, counts = random.Random(5), []
        for size in sorted(chance.randrange(5000, len(content) - 1) for _ in range(15)):
            self.save("cut.mcap", content[:size])
            theirs = self.peer("streamed", "cut.mcap")
            self.assertFalse(theirs["done"])
            self.assertEqual(theirs["messages"], whole[:len(theirs["messages"])])
            remarks = self.convert("cut.mcap", "cut.log", "--to", "candump-ns")
            self.assertIn("ends in the middle", remarks)
            ours = self.text(self.path("cut.log")).splitlines()
            self.assertEqual(ours, lines[:len(ours)])
            raw = sum('"id"' in message[4] for message in theirs["messages"])
            self.assertGreaterEqual(len(ours), raw)  # and of the chunk that is cut, what is there
            counts.append(raw)
        self.assertGreater(len(set(counts)), 5)

    def test_packed_chunks_of_others(self):
        """Our own file, with the records of each chunk packed by zstd as others do by default."""
        lines = robot_lines(100, seed=6)
        self.written(lines)
        with open(self.path("ours.mcap"), "rb") as file:
            content = file.read()
        out, at = content[:8], 8
        while at < len(content) - 8:
            size = 9 + int.from_bytes(content[at + 1:at + 9], "little")
            record = content[at:at + size]
            if record[0] == 6:
                packed = subprocess.run(["zstd", "-cq"], input=record[49:], stdout=subprocess.PIPE, check=True).stdout
                body = record[9:37] + (4).to_bytes(4, "little") + b"zstd" + len(packed).to_bytes(8, "little") + packed
                record = b"\x06" + len(body).to_bytes(8, "little") + body
            out, at = out + record, at + size
        self.save("packed.mcap", out + content[-8:])
        self.assertLess(len(out), len(content))
        self.assertEqual(self.candump_of("packed.mcap"), lines)
        self.save("lz4.mcap", out.replace(b"zstd", b"lz4!") + content[-8:])
        _, remarks = self.run_tool("convert", self.path("lz4.mcap"), self.path("lz4.log"), code=1)
        self.assertIn("a chunk in lz4!", remarks)


if __name__ == "__main__":
    unittest.main()
