"""What amiroctl says of frames by a DBC file is what the second reader says, and canmatrix where it reads the file: random
databases and random frames of them, and the files of a folder, which OCM_DBC_FILES may name."""

import collections
import csv
import io
import json
import os
import pathlib
import random
import re
import struct
import subprocess
import sys
import tempfile
import unittest
from fractions import Fraction

import dbc_bits
import random_dbc
import second_reader
import second_transport
import write_dbc

AMIROCTL = os.environ["AMIROCTL"]
EXPLORE = int(os.environ.get("OCM_EXPLORE", "1"))
FOLDER = os.environ.get("OCM_DBC_FILES") or os.path.join(os.environ["OCM_SOURCE_DIR"], "examples")
SEEDS = range(12 * EXPLORE)
FRAMES = 300


def canmatrix():
    """canmatrix prints to the standard output which formats it lacks."""
    import contextlib
    with contextlib.redirect_stdout(io.StringIO()):
        import canmatrix.formats
    return __import__("canmatrix")


def number_of(identifier, extended):
    return "%08X" % identifier if extended else "%03X" % identifier


def is_decoded(frame):
    """Of a message, and long enough for it."""
    return frame[1] is not None and len(frame[5]) >= frame[1].length


def log_of(frames):
    return "".join("(%d.%06d) can0 %s%s%s\n" % (micros // 1_000_000, micros % 1_000_000, number_of(identifier, extended),
                                               "##1" if fd else "#", data.hex().upper())
                   for micros, _, identifier, extended, fd, data in frames)


def is_near(signal, raw, physical, text):
    """Whether this text is the value: exact where 63 bits of decimal digits hold it, and else the nearest that a double holds."""
    if physical != physical or physical in (float("inf"), float("-inf")):
        return text == {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}[str(physical)]
    if signal.floating and text in ("Infinity", "-Infinity"):  # beyond the largest double
        return abs(physical) > sys.float_info.max and (physical < 0) == text.startswith("-")
    try:
        printed = Fraction(text)
    except ValueError:
        return False
    plain = signal.scale == 1 and signal.offset == 0
    product = abs(Fraction(raw) * signal.scale)
    if signal.floating and plain:  # the shortest decimal number that is this float again
        kind = "<f" if signal.length == 32 else "<d"
        return struct.pack(kind, float(text)) == struct.pack(kind, raw)
    if signal.floating:
        least = Fraction(1, 1 << 1074)  # the smallest double
        return abs(printed - physical) <= (product / (1 << (24 if signal.length == 32 else 52)) + (product + abs(signal.offset)) / (1 << 51)
                                           + (2 + abs(signal.scale)) * least)
    if plain or digits(physical) < 1 << 63 and digits(Fraction(raw) * signal.scale) < 1 << 63:
        return printed == physical
    return abs(printed - physical) <= (product + abs(signal.offset)) / (1 << 52)


def digits(value):
    """The decimal digits of a number, as an integer without its point."""
    value = abs(value)
    while value.denominator != 1:
        value *= 10
    return value.numerator


def data_of(chance, message):
    """Random bytes; where a signal is beyond the message's length nothing is put into one."""
    fits = all(max(signal.bits()) < 8 * message.length for signal in message.signals)
    return random_dbc.data_of(chance, message) if fits else chance.randbytes(message.length)


def sent_by_j1939(chance, database, message):
    """Frames (identifier, data, the message's bytes where it is whole) with a random priority, source and destination: one, or
    the broadcast of a message that is longer [SAE J1939-21, 5.10]. None: the file has another message for each of them."""
    data = data_of(chance, message)
    number = random_dbc.sent_as(chance, message)
    if message.length > 8:
        group = second_reader.group(number)
        number = 7 << 26 | group << 8 | (0xFF00 if (group >> 8 & 0xFF) < 240 else 0) | number & 0xFF
    elif database.find(number, True) is not message:
        number = message.number
    if database.find(number, True) is not message or second_transport.is_transport(number):
        return None
    if message.length <= 8:
        return [(number, data, data)]
    packets = [data[at:at + 7].ljust(7, b"\xff") for at in range(0, len(data), 7)]
    begin = bytes((second_transport.BAM, len(data) & 0xFF, len(data) >> 8, len(packets), 0xFF)) + group.to_bytes(3, "little")
    source = number & 0xFF
    return [(7 << 26 | 0xECFF00 | source, begin, None),
            *((7 << 26 | 0xEBFF00 | source, bytes((index + 1,)) + packet, data if index + 1 == len(packets) else None)
              for index, packet in enumerate(packets))]


def frames_of_file(name, database):
    """Five random frames of each message of a real file, but of J1939; no frame where it has no such message."""
    messages = [message for message in database.messages if message.signals and message.length and not message.j1939]
    chance = random.Random(name)
    frames = []
    for index in range(5 * len(messages)):
        message = messages[index % len(messages)]
        length = next(size for size in (*range(9), *random_dbc.FD_LENGTHS) if size >= message.length)
        data = data_of(chance, message)
        frames.append((1_000_000 + index, message, message.number, message.extended, length > 8, data.ljust(length, b"\0")))
    return frames


class Tool:
    def __init__(self, case, folder, spec):
        self.case, self.folder, self.spec = case, pathlib.Path(folder), spec

    def run(self, *arguments, stdin=b"", code=0):
        result = subprocess.run([AMIROCTL, *map(str, arguments), "--spec", str(self.spec)], input=stdin, capture_output=True, timeout=120,
                                env={"PATH": os.environ["PATH"], "HOME": str(self.folder), "XDG_RUNTIME_DIR": str(self.folder)})
        self.errors = result.stderr.decode()
        self.case.assertEqual(result.returncode, code, (arguments, result.stderr.decode()[-2000:]))
        return result.stdout.decode()


class Case(unittest.TestCase):
    """A folder, and what a log must decode to."""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="ocm-test-")
        self.folder = pathlib.Path(self._folder.name)

    def tearDown(self):
        self._folder.cleanup()

    def assert_values(self, where, message, data, fields):
        """The fields, texts by name, are what the second reader finds: no more, no less, in the file's order."""
        expected = second_reader.decode(message, data)
        self.assertEqual(sorted(fields), sorted(expected), where)
        for name, (raw, physical) in expected.items():
            self.assertTrue(is_near(message.signal(name), raw, physical, fields[name]),
                            f"{where}: {message.name}.{name} of {data.hex()}: {fields[name]} in place of "
                            f"{physical}, raw {raw}, {message.signal(name)}")

    def lines(self, text):
        return [json.loads(line, parse_int=str, parse_float=str) for line in text.splitlines()]

    def unselected(self, frames):
        """How many have a selector that chooses no field."""
        count = 0
        for frame in filter(is_decoded, frames):
            present, message = second_reader.decode(frame[1], frame[5]), frame[1]
            for selector in {signal.selector for signal in message.signals} & set(present):
                bits = present[selector][0] % (1 << message.signal(selector).length)
                if not any(low <= bits <= high for signal in message.signals if signal.selector == selector for low, high in signal.ranges):
                    count += 1
                    break
        return count

    def check_json(self, tool, where, frames, log, *options):
        text = tool.run("decode", "--json", *options, log)
        lines = self.lines(text)
        self.assertEqual(len(lines), len(frames), where)
        for line, (micros, message, identifier, extended, fd, data) in zip(lines, frames):
            self.assertEqual((line["id"], line["time_ns"], line["data"]),
                             (number_of(identifier, extended), str(micros * 1000), data.hex().upper()), where)
            self.assertEqual("fd" in line, fd, where)
            if message is None or len(data) < message.length:
                self.assertIn("error", line)
                self.assertNotIn("fields", line)
                self.assertEqual(line.get("topic"), message and message.name, line)
                continue
            self.assertEqual(line.get("topic"), message.name, line)
            self.assert_values(where, message, data, line["fields"])
            self.assertEqual(line["units"], {name: message.signal(name).unit for name in line["fields"]}, where)
            names = {name: message.signal(name).names[raw] for name, (raw, _) in second_reader.decode(message, data).items()
                     if raw in message.signal(name).names}
            self.assertEqual(line.get("names"), names or None, (where, line))
        count = self.unselected(frames)
        said = f", {count} frame{'' if count == 1 else 's'} whose selector chooses no field\n"
        self.assertIn(said if count else "\n", tool.errors, where)
        self.assertEqual("whose selector" in tool.errors, count != 0, (where, tool.errors))
        return text, lines


class Decode(Case):
    def written(self, seed):
        """A random database, its file, and random frames in a log."""
        database = random_dbc.database(seed)
        text = write_dbc.write(database, seed)
        spec, log = self.folder / f"{seed}.dbc", self.folder / f"{seed}.log"
        spec.write_bytes(text.encode("cp1252" if seed % 3 == 0 else "utf-8"))
        frames = random_dbc.frames(seed, database, FRAMES)
        log.write_text(log_of(frames))
        return database, frames, spec, log

    def test_all_signals_of_random_frames(self):
        for seed in SEEDS:
            _, frames, spec, log = self.written(seed)
            self.check_json(Tool(self, self.folder, spec), f"seed {seed}", frames, log, "--strict-spec")

    def test_csv(self):
        """Long, a line a field; wide, a line a frame with the columns that were asked for."""
        for seed in SEEDS:
            database, frames, spec, log = self.written(seed)
            tool = Tool(self, self.folder, spec)
            frames = list(filter(is_decoded, frames))
            expected = [(micros, message, name, data) for micros, message, *_, data in frames
                        for name in sorted(second_reader.decode(message, data))]
            rows = list(csv.DictReader(io.StringIO(tool.run("decode", "--csv", log))))
            self.assertEqual([(row["time"], row["topic"], row["field"]) for row in sorted(rows, key=lambda row: (row["time"], row["field"]))],
                             [("%d.%09d" % (micros // 1_000_000, micros % 1_000_000 * 1000), message.name, name)
                              for micros, message, name, _ in expected], f"seed {seed}")
            by_place = {(row["time"], row["field"]): row for row in rows}
            for micros, message, name, data in expected:
                row = by_place["%d.%09d" % (micros // 1_000_000, micros % 1_000_000 * 1000), name]
                signal = message.signal(name)
                self.assertTrue(is_near(signal, *second_reader.decode(message, data)[name], row["value"]), (seed, row))
                self.assertEqual(row["unit"], signal.unit)
            message = next(message for message in database.messages if any(message is frame[1] for frame in frames))
            signal = random.Random(seed).choice(message.signals)
            wide = list(csv.DictReader(io.StringIO(tool.run("decode", "--csv", log, "--field", f"{message.name}.{signal.name}"))))
            values = [second_reader.decode(message, frame[5]).get(signal.name) for frame in frames if frame[1] is message]
            texts = [row[f"{message.name}.{signal.name}"] for row in wide]
            self.assertEqual([text for text in texts if text] == [], all(value is None for value in values))
            if len(texts) == len(values):  # a frame without the field is an empty cell, or no line
                pairs = zip(texts, values)
            else:
                pairs = zip([text for text in texts if text], [value for value in values if value is not None], strict=True)
            for text, value in pairs:
                self.assertTrue(text == "" if value is None else is_near(signal, *value, text), (seed, signal, text, value))

    def test_encode_gives_the_used_bits_back(self):
        """Fields alone, without data: with the identifier, and with the message's name in its place."""
        checked = 0
        for seed in SEEDS:
            _, frames, spec, log = self.written(seed)
            tool = Tool(self, self.folder, spec)
            plain = []
            for line, frame in zip(tool.run("decode", "--json", log).splitlines(), frames):
                if is_decoded(frame):
                    values = json.loads(line, parse_int=str, parse_float=str)
                    line = line.replace(f',"data":"{values["data"]}"', "")
                    if seed % 2 and not frame[1].j1939:  # the name of a parameter group leaves the identifier open
                        line = line.replace(f'"id":"{values["id"]}",', "")
                    plain.append((line, frame))
            back = tool.run("encode", "--force", stdin="\n".join(line for line, _ in plain).encode()).splitlines()
            self.assertEqual(len(back), len(plain), f"seed {seed}")
            for text, (line, (_, message, identifier, extended, fd, data)) in zip(back, plain):
                frame = text.split()[2]
                number, _, hexadecimal = frame.partition("##" if fd else "#")
                self.assertEqual(number, number_of(identifier, extended), (seed, line))
                found = bytes.fromhex(hexadecimal[1:] if fd else hexadecimal)
                data = data[:message.length]
                self.assertEqual(len(found), len(data), (seed, line))
                present = second_reader.decode(message, data)
                self.assertEqual(list(second_reader.decode(message, found)), list(present), (seed, line, text))
                for name, (raw, physical) in present.items():
                    signal = message.signal(name)
                    again, value = second_reader.decode(message, found)[name]
                    if not signal.floating:
                        self.assertEqual(again, raw, f"seed {seed}: {signal}: {line} {text}")
                    elif raw - raw != 0:
                        self.assertEqual(str(again), str(raw), (seed, signal, line, text))
                    else:  # within what a double keeps of the value, and the float of the scaled one
                        width = abs(Fraction(raw) * signal.scale) / (1 << (23 if signal.length == 32 else 50)) + abs(signal.offset) / (1 << 49)
                        self.assertLessEqual(abs(value - physical), width + signal.scale.__abs__() * Fraction(2)**-148, (seed, signal, line, text))
                    checked += 1
                used = dbc_bits.mask(len(data), [message.signal(name).bits() for name in present])
                self.assertEqual(bytes(byte & ~bits & 0xFF for byte, bits in zip(found, used)), bytes(len(data)), (seed, line, text))
        self.assertGreater(checked, 1000)

    def test_encode_keeps_data_to_the_byte(self):
        for seed in SEEDS:
            _, _, spec, log = self.written(seed)
            tool = Tool(self, self.folder, spec)
            self.assertEqual(tool.run("encode", stdin=tool.run("decode", "--json", log).encode()), log.read_text(), f"seed {seed}")

    def test_encode_passes_names_over(self):
        """Also names that contradict the numbers, which someone edited."""
        spec = pathlib.Path(os.environ["OCM_SOURCE_DIR"]) / "examples" / "small_car.dbc"
        tool = Tool(self, self.folder, spec)
        line = json.loads(tool.run("decode", "--json", "-", stdin=b"(1.000000) can0 110#F1000000\n"))
        self.assertEqual((line["fields"]["Gear"], line["names"]["Gear"]), (-1, "Reverse"), line)
        line["fields"]["Gear"] = 0
        self.assertEqual(tool.run("encode", stdin=json.dumps(line).encode()).split()[2], "110#01000000")
        self.assertEqual(tool.run("encode", stdin=json.dumps({**line, "names": 7}).encode()).split()[2], "110#01000000")

    def test_stats(self):
        for seed in SEEDS:
            _, frames, spec, log = self.written(seed)
            found = json.loads(Tool(self, self.folder, spec).run("stats", "--json", "--bitrate", "500k", log))
            times = collections.defaultdict(list)
            for frame in frames:
                if frame[1] is None or is_decoded(frame):
                    times[frame[1].name if frame[1] else None].append(frame[0])
            bus = found["buses"][0]
            self.assertEqual((bus["frames"], bus["unknown"], bus["wrong_length"], bus["fd_frames"]),
                             (len(frames), len(times.pop(None, [])), sum(len(frame[5]) < frame[1].length for frame in frames if frame[1]), sum(frame[4] for frame in frames)), f"seed {seed}")
            topics = {topic["topic"]: topic for topic in bus["topics"] if topic["count"]}
            self.assertEqual({name: topic["count"] for name, topic in topics.items()}, {name: len(seen) for name, seen in times.items()})
            for name, seen in times.items():
                if len(seen) > 1:
                    self.assertAlmostEqual(topics[name]["mean_ns"], 1000 * (seen[-1] - seen[0]) / (len(seen) - 1), delta=1, msg=(seed, name))

    def test_canmatrix_agrees(self):
        """A third opinion: raw numbers of messages without selectors. Its decoder takes one selector, and shows what is absent."""
        reader = canmatrix()
        compared = 0
        for seed in SEEDS:
            database, frames, spec, log = self.written(seed)
            # It leaves out a type whose colon is missing.
            spec.write_bytes(re.sub(rb"(SIG_VALTYPE_ \d+ \w+) ?:? ?", rb"\1 : ", spec.read_bytes()))
            theirs = {(frame.arbitration_id.id, bool(frame.arbitration_id.extended)): frame for frame in reader.formats.loadp_flat(
                str(spec), dbcImportEncoding="cp1252" if seed % 3 == 0 else "utf-8").frames}
            for line, frame in zip(self.lines(Tool(self, self.folder, spec).run("decode", "--json", log)), frames):
                message, data = frame[1], frame[5]
                if not is_decoded(frame) or any(signal.is_selector for signal in message.signals):
                    continue
                for name, value in theirs[message.number, message.extended].decode(data[:message.length]).items():
                    signal = message.signal(name)
                    if signal.floating and value.raw_value != value.raw_value:
                        self.assertEqual(line["fields"][name], "NaN")
                    elif signal.floating and value.raw_value - value.raw_value != 0:
                        self.assertIn("Infinity", line["fields"][name])
                    else:
                        self.assertTrue(is_near(signal, value.raw_value, Fraction(value.raw_value) * signal.scale + signal.offset,
                                                line["fields"][name]), (seed, message.name, name, value.raw_value, line))
                    compared += 1
        self.assertGreater(compared, 500)

    def test_files_of_a_folder(self):
        """Real files: those that amiroctl takes are decoded as the second reader decodes them. Without a folder of them
        it is the project's own."""
        taken = 0
        for spec in sorted(pathlib.Path(FOLDER).rglob("*.dbc")):
            database = second_reader.read(spec.read_bytes())
            frames = frames_of_file(spec.name, database)
            if not frames:
                continue
            log = self.folder / "real.log"
            log.write_text(log_of(frames))
            tool = Tool(self, self.folder, spec)
            with self.subTest(spec.name):
                for line, frame in zip(self.lines(tool.run("decode", "--json", log)), frames):
                    self.assertEqual(line.get("topic"), frame[1].name, line)
                    self.assert_values(spec.name, frame[1], frame[5][:frame[1].length], line["fields"])
                taken += 1
        self.assertGreater(taken, 0)

    def test_j1939_of_a_folder(self):
        """The parameter groups of real files and of the project's own, as any node may send them; one of 30 bytes, which comes in
        several frames, is random."""
        builder = random_dbc.Builder("long")
        message = second_reader.Message(0x18FEEC00, True, "Long", 30, "Node", frame_format="J1939PG", j1939=True)
        builder.fill(message, ["Node", "Other"])
        own = self.folder / "long.dbc"
        own.write_text(write_dbc.write(second_reader.Database(nodes=["Node", "Other"], messages=[message]), "long"), encoding="utf-8")
        specs = {own, *pathlib.Path(FOLDER).rglob("*.dbc"), *pathlib.Path(os.environ["OCM_SOURCE_DIR"], "examples").glob("*.dbc")}
        short = long = 0
        for spec in sorted(specs):
            database = second_reader.read(spec.read_bytes())
            messages = [message for message in database.messages if message.j1939 and message.signals and 0 < message.length <= 1785]
            chance = random.Random(spec.name)
            sent = [(message, frame) for message in messages * 5 for frame in sent_by_j1939(chance, database, message) or ()]
            if not sent:
                continue
            log = self.folder / "real.log"
            log.write_text(log_of((1_000_000 + 100 * index, None, number, True, False, data) for index, (_, (number, data, _)) in enumerate(sent)))
            with self.subTest(spec.name):
                lines = self.lines(Tool(self, self.folder, spec).run("decode", "--json", log))
                self.assertEqual(len(lines), len(sent))
                for line, (message, (number, data, whole)) in zip(lines, sent):
                    self.assertEqual(line["id"], number_of(number, True), spec.name)
                    if second_transport.is_transport(number):
                        self.assertEqual((line["transport"], "message" in line), ("packet" if number >> 16 & 1 else "control", whole is not None), line)
                        line = line.get("message")
                        long += whole is not None
                    else:
                        self.assertEqual((line["source"], line["priority"]), (str(number & 0xFF), str(number >> 26)), line)
                        short += 1
                    if whole is not None:
                        self.assertEqual((line["topic"], line["pgn"], line["data"]),
                                         (message.name, "%05X" % second_reader.group(message.number), whole.hex().upper()), spec.name)
                        self.assert_values(spec.name, message, whole, line["fields"])
        self.assertGreater(short, 0)
        self.assertGreater(long, 0)


if __name__ == "__main__":
    unittest.main()
