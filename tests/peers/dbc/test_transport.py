"""Messages of J1939's transport protocol: random databases with messages of up to 1785 bytes, traffic of several nodes at once, in
part of which something goes wrong. What amiroctl puts together and counts is what the second reader does, and every value in it."""

import collections
import os
import random
import re
import unittest

import random_dbc
import second_reader
import second_transport
import write_dbc
from second_reader import Database, Message
from test_decode import Case, Tool

EXPLORE = int(os.environ.get("OCM_EXPLORE", "1"))
SEEDS = range(10 * EXPLORE)
TRANSFERS = 120
# How the summary names what the second reader counts.
WORDS = {"messages lost a packet": "lost packet", "had a packet of a wrong number": "wrong number", "aborted": "aborted", "timed out": "timed out",
         "followed by the next before the end": "replaced", "of an impossible size": "bad size", "not at the end yet": "open",
         "packets of no message": "stray", "frames of another form": "malformed"}
SUMMARY = re.compile(r"transport protocol of J1939: (\d+) messages? put together, (\d+) other frames?(.*)")


def database(seed):
    """Messages of J1939, most of them longer than a frame."""
    builder = random_dbc.Builder(seed)
    chance = builder.chance
    found = Database(nodes=[builder.name("N") for _ in range(3)])
    groups = set()
    for length in (8, 9, 14, 15, 17, 64, 65, chance.randrange(66, 250), 1785):
        while True:
            number = chance.randrange(1 << 29)
            if second_reader.group(number) not in groups and not second_transport.is_transport(number):
                break
        groups.add(second_reader.group(number))
        message = Message(number, True, builder.name("M"), length, found.nodes[0], frame_format="J1939PG", j1939=True)
        if length < 40:
            builder.fill(message, found.nodes)
        else:
            free = set(range(8 * length))
            message.signals = [signal for _ in range(12) if (signal := builder.signal(free, found.nodes))]
            # The very last bits, over the end of eight bytes.
            tail = set(range(8 * length - 65, 8 * length)) & free
            message.signals += [signal for _ in range(3) if tail and (signal := builder.signal(tail, found.nodes))]
        found.messages.append(message)
    return found


class Sender:
    """One node's transfers, one after another."""

    def __init__(self, chance, address, bus, start):
        self.chance, self.address, self.bus, self.now, self.frames = chance, address, bus, start, []

    def put(self, group, source, destination, data, least=500, most=90_000):
        self.now += self.chance.randrange(least, most)
        priority = self.chance.choice((6, 7, 7))
        self.frames.append((self.now, self.bus, priority << 26 | group << 8 | destination << 8 | source, bytes(data)))

    def control(self, source, destination, kind, a, b, c, group):
        self.put(0xEC00, source, destination, bytes((kind, a, b, c, 0xFF)) + group.to_bytes(3, "little"))

    def packets(self, destination, data, numbers):
        for number in numbers:
            self.put(0xEB00, self.address, destination, bytes((number,)) + data[7 * number - 7:7 * number].ljust(7, b"\xff"))

    def transfer(self, group, destination, data):
        chance, me = self.chance, self.address
        count = -(-len(data) // 7)
        size = len(data) & 0xFF, len(data) >> 8
        begin = len(self.frames)
        if destination == 0xFF:
            self.control(me, destination, 32, *size, count, group)
            self.packets(destination, data, range(1, count + 1))
        else:
            self.control(me, destination, 16, *size, count, group)
            at = 1
            while at <= count:
                if chance.random() < 0.2:
                    self.control(destination, me, 17, 0, 0xFF, 0xFF, group)  # wait
                window = chance.randrange(1, min(count - at + 1, 255) + 1)
                self.control(destination, me, 17, window, at, 0xFF, group)
                self.packets(destination, data, range(at, at + window))
                # What the receiver missed it asks for again.
                at = at + window if chance.random() < 0.8 else chance.randrange(at, at + window)
            self.control(destination, me, 19, *size, count, group)
        if chance.random() < 0.35:
            self.frames[begin:] = self.spoiled(self.frames[begin:], destination, group)
        self.now = max(self.now, self.frames[-1][0]) + chance.choice((1_000, 100_000, 3_000_000))

    def spoiled(self, frames, destination, group):
        chance = self.chance
        at = chance.randrange(len(frames)) if chance.random() < 0.8 else 0  # often the announcement
        now, bus, number, data = frames[at]
        way = chance.randrange(9)
        if way == 0:
            return frames[:at] + frames[at + 1:] or frames
        if way == 1:
            return frames[:at + 1] + frames[at:]
        if way == 2 and at + 1 < len(frames):
            after = frames[at + 1]
            return frames[:at] + [(now, *after[1:]), (after[0], bus, number, data)] + frames[at + 2:]
        if way == 3:  # late, around each of the limits
            late = chance.choice((700_000, 749_000, 760_000, 1_000_000, 1_060_000, 1_240_000, 1_260_000, 3_000_000))
            return frames[:at] + [(frame[0] + late, *frame[1:]) for frame in frames[at:]]
        if way == 4:
            return frames[:at + 1]
        if way == 5:
            ends = (self.address, destination) if destination == 0xFF or chance.random() < 0.5 else (destination, self.address)
            abort = (now + 100, bus, 7 << 26 | 0xEC0000 | ends[1] << 8 | ends[0], bytes((255, 3, 255, 255, 255)) + group.to_bytes(3, "little"))
            return frames[:at + 1] + [abort] + (frames[at + 1:] if chance.random() < 0.5 else [])
        spoiled = bytearray(data)
        if way == 6:
            spoiled[chance.choice((0, 0, 1, 2, 3, 7))] = chance.choice((0, 1, 255, chance.randrange(256)))
        elif way == 7:
            spoiled[0] = (spoiled[0] + chance.choice((-1, 1, 2))) % 256
        else:
            del spoiled[chance.randrange(8):]
        return frames[:at] + [(now, bus, number, bytes(spoiled))] + frames[at + 1:]


def traffic(seed, found):
    """(micros, bus, identifier, data), in their order."""
    chance = random.Random(seed)
    start = 1_436_509_052_000_000
    addresses = chance.sample(range(254), 4)
    senders = [Sender(chance, address, bus, start + chance.randrange(10**6)) for bus in (0, 1) for address in addresses]
    for _ in range(TRANSFERS):
        sender = chance.choice(senders)
        message = chance.choice(found.messages)
        data = random_dbc.data_of(chance, message)
        if message.length < 9 or chance.random() < 0.2:  # in one frame
            sender.now += 1000
            data = data[:8 if message.length < 9 else chance.randrange(9)]
            sender.frames.append((sender.now, sender.bus, message.number & 0x1FFFFF00 | sender.address, data))
            continue
        if chance.random() < 0.3:  # shorter or longer than its message: many of J1939 have no fixed length
            data = (data + chance.randbytes(20))[:chance.randrange(9, min(message.length + 20, 1785) + 1)]
        group = second_reader.group(message.number) if chance.random() < 0.9 else 0x0FFFE
        to_one = chance.random() < 0.5
        sender.transfer(group, chance.choice([other for other in addresses if other != sender.address]) if to_one else 0xFF, data)
    frames = sorted((frame for sender in senders for frame in sender.frames), key=lambda frame: frame[0])
    return frames[:len(frames) * 9 // 10]  # a log may end anywhere


class Transport(Case):
    def test_random_traffic(self):
        seen = collections.Counter()
        for seed in SEEDS:
            found = database(seed)
            spec, log = self.folder / f"{seed}.dbc", self.folder / f"{seed}.log"
            spec.write_text(write_dbc.write(found, seed), encoding="utf-8")
            frames = traffic(seed, found)
            log.write_text("".join("(%d.%06d) can%d %08X#%s\n" % (*divmod(micros, 1_000_000), bus, number, data.hex().upper())
                                   for micros, bus, number, data in frames))
            whole, ends = second_transport.read(frames, frames[-1][0])
            tool = Tool(self, self.folder, spec)
            lines = self.lines(tool.run("decode", "--json", log))
            self.assertEqual(len(lines), len(frames))
            for index, (line, frame) in enumerate(zip(lines, frames)):
                self.check(f"seed {seed}, frame {index}", found, line, frame, whole.get(index))
            complete, others, causes = SUMMARY.search(tool.errors).groups()
            counted = {WORDS[words]: int(count) for count, words in re.findall(r", (\d+) ([^,]+)", causes)}
            self.assertEqual(counted, {how: count for how, count in ends.items() if how != "whole"}, f"seed {seed}")
            self.assertEqual(int(complete), len(whole))
            self.assertEqual(int(others), sum(second_transport.is_transport(number) for _, _, number, _ in frames) - len(whole))
            seen.update(ends)
            rows = tool.run("decode", "--csv", log).splitlines()
            self.assertEqual(len(rows) - 1, sum(len(line.get("message", line).get("fields", ())) for line in lines), f"seed {seed}")
        self.assertEqual(set(WORDS.values()) | {"whole"}, set(seen), "every end came")
        self.assertGreater(seen["whole"], 30 * len(SEEDS))

    def check(self, where, found, line, frame, whole):
        micros, bus, number, data = frame
        self.assertEqual((line["time_ns"], line["bus"], line["id"], line["data"]),
                         (str(micros * 1000), f"can{bus}", "%08X" % number, data.hex().upper()), where)
        self.assertEqual("transport" in line, second_transport.is_transport(number), where)
        if not second_transport.is_transport(number):
            message = found.find(number, True)
            self.assertEqual(line["topic"], message.name, where)
            self.assert_values(where, message, data, line["fields"])
            return
        self.assertEqual((int(line["priority"]), int(line["pgn"], 16), int(line["source"]), int(line["destination"])),
                         (number >> 26, number >> 8 & 0x3FF00, number & 0xFF, number >> 8 & 0xFF), where)
        self.assertEqual("message" in line, whole is not None, where)
        if whole is None:
            return
        said = line["message"]
        priority, group, destination, source, text = whole
        self.assertEqual((int(said["priority"]), int(said["pgn"], 16), int(said["source"]), int(said["destination"]), said["data"]),
                         (priority, group, source, destination, text.hex().upper()), where)
        message = found.find(group << 8, True)
        self.assertEqual(said.get("topic"), message and message.name, where)
        if message is None:
            self.assertEqual(said["error"], "unknown identifier", where)
        else:
            self.assert_values(where, message, text, said["fields"])
            self.assertEqual(said["units"], {name: message.signal(name).unit for name in said["fields"]}, where)


if __name__ == "__main__":
    unittest.main()
