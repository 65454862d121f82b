"""The C header: it compiles wherever C99 or C++ does, says what the thesis says, and agrees with the catalogue."""
import json
import math
import pathlib
import re
import shutil
import subprocess
import unittest

from peers import Case, SPECS, generate, is_near, real, samples

HERE = pathlib.Path(__file__).resolve().parent
WARNINGS = "-Wall -Wextra -Wconversion -Wsign-conversion -Wshadow -pedantic -Werror".split()
COMPILERS = {
    "gcc": ["gcc", "-std=c99"],
    "clang": ["clang-14", "-std=c99"],
    "C++": ["g++", "-std=c++11", "-x", "c++", "-Wno-missing-field-initializers"],
    "Cortex-M0": ["arm-none-eabi-gcc", "-std=c99", "-mcpu=cortex-m0", "-mthumb"],
}


def spec_topics(robot):
    """Topics of the spec, those that are like another written out."""
    topics = {}
    for topic in json.loads(SPECS[robot].read_text())["topics"]:
        topics[topic["name"]] = {**topics.get(topic.get("like"), {}), **topic}
    return topics


def driver(robot, header, frames):
    """A program that reads `number id data` and prints the raw numbers, the physical values, the raw numbers that
    these give again, and the frame made from the struct."""
    text = f'#include "{header.name}"\n#include <inttypes.h>\n#include <stdio.h>\n'
    body = ""
    source = header.read_text()
    topics = spec_topics(robot)
    for number, sample in enumerate(frames):
        name, index = sample["topic"], 0
        if name not in topics:
            name, index = name.rsplit("_", 1)
            index = int(index) - 1
        frame_name, member = sample["frame"], ""
        declared = topics[name]["frames"]
        if frame_name:
            if not any(frame.get("name") == frame_name for frame in declared):
                frame_name, element = frame_name.rsplit("_", 1)
                member = f"[{int(element) - 1}]"
            member = f"value.{frame_name}{member}"
        member = member or "value"
        stem = f"{robot}_{name}" + (f"_{frame_name}" if frame_name else "")
        body += f"  case {number}: {{\n    {robot}_{name}_t value;\n    const int at = {robot}_{name}_take(&value, &frame);\n    (void)at;\n"
        for field, facts in sample["fields"].items():
            def shown(value):
                form, kind = ('"%.17g "', "double") if "float" in facts else ('"%" PRId64 " "', "int64_t")
                return f"printf({form}, ({kind}){value});"
            body += f"    {shown(f'{member}.{field}')}\n"
            accessor = re.search(rf"double ({stem}_{field}_\w+)\(const", source)
            if accessor:
                setter = accessor[1].replace(f"{stem}_{field}_", f"{stem}_set_{field}_")
                body += f'    {{ const double physical = {accessor[1]}(&{member});\n      {stem}_t again = {member};\n'
                body += f'      {setter}(&again, physical);\n'
                body += f"""      printf("%.17g ", physical); {shown(f'again.{field}')} }}\n"""
            else:
                body += '    printf("- - ");\n'
        extra = f", (uint8_t)at" if len(declared) > 1 or "count" in declared[0] or "count" in topics[name] else ""
        body += f"    frame = {robot}_{name}_frame(&value{extra}, {robot}_priority_of(frame.id));\n    break;\n  }}\n"
    return text + """
int main(void) {
  int number;
  unsigned id, length;
  char data[17];
  while (scanf("%d %u %u %16s", &number, &id, &length, data) == 4) {
    unsigned i;
    unsigned byte;
    """ + f"{robot}_frame frame" + """ = {0, 0, {0, 0, 0, 0, 0, 0, 0, 0}};
    frame.id = (uint16_t)id;
    frame.dlc = (uint8_t)length;
    for (i = 0; i < length && sscanf(data + 2 * i, "%2x", &byte) == 1; ++i) frame.data[i] = (uint8_t)byte;
    switch (number) {
""" + body + """    default: return 1;
    }
    printf("%u %u ", (unsigned)frame.id, (unsigned)frame.dlc);
    for (i = 0; i < 8; ++i) printf("%02X", (unsigned)frame.data[i]);
    printf("\\n");
  }
  return 0;
}
"""


class C(Case):
    def test_each_field_has_its_unit_and_range(self):
        header = generate(SPECS["amiro"], "--to", "c", "-o", "-")
        self.assertIn("typedef struct amiro_odometry_velocity_t {\n"
                      "  // forwards; 0.000001 m/s a bit, [-2147.483648, 2147.483647] m/s\n  int32_t x;\n"
                      "  // counter-clockwise seen from above; 0.000001 rad/s a bit, [-2147.483648, 2147.483647] rad/s\n  int32_t z;\n"
                      "} amiro_odometry_velocity_t;\n", header)

    def test_members_with_named_values_say_so_and_the_names_follow(self):
        named = others = 0
        for robot in SPECS:
            header = generate(SPECS[robot], "--to", "c", "-o", "-")
            for name, topic in spec_topics(robot).items():
                for frame in topic["frames"]:
                    stem = "_".join(filter(None, (robot, name, frame.get("name"))))
                    members = re.search(rf"typedef struct {stem}_t {{\n(.*?)\n}}", header, re.S)[1]
                    for field in frame["fields"]:
                        with self.subTest(struct=stem, member=field["name"]):
                            comment = re.search(rf"((?:  //[^\n]*\n)*)  \w+ {field['name']};", members)[1]
                            numbers = field.get("values") or {flag: 1 << bit for flag, bit in field.get("flags", {}).items()}
                            self.assertEqual(comment.endswith("see below\n"), bool(numbers), comment)
                            for value, number in numbers.items():
                                macro = f"{stem}_{field['name']}_{value}".upper()
                                said = re.search(rf"^#define {macro} (.*)$", header, re.M)
                                self.assertEqual(int(said[1].strip("()").rstrip("uUlL"), 0), number)
                        named, others = named + bool(numbers), others + (not numbers)
        self.assertGreater(named, 10)
        self.assertGreater(others, 50)

    def header(self, robot):
        path = self.folder / f"{robot}.h"
        generate(SPECS[robot], "--to", "c", "-o", path)
        return path

    def compile(self, compiler, source, *options):
        self.assertIsNotNone(shutil.which(compiler[0]), f"{compiler[0]} is missing: scripts/setup")
        done = subprocess.run([*compiler, *WARNINGS, "-I", self.folder, source, *options], capture_output=True,
                              encoding="utf-8", timeout=120)
        self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""), compiler)

    def test_compiles_everywhere_without_a_warning(self):
        self.header("amiro")
        self.header("ferry")
        source = self.folder / "both.c"
        source.write_text('#include "amiro.h"\n#include "ferry.h"\n#include "amiro.h"\nint main(void) { return 0; }\n')
        for compiler in COMPILERS.values():
            self.compile(compiler, source, "-c", "-o", self.folder / "both.o")

    def test_names_that_meet_are_told_apart(self):
        """load's field mass in tonnes is read by r_load_mass_t, which is the type of load_mass, too; and so on."""
        def topic(number, name, frames):
            return {"name": name, "id": number, "board": "b", "deadline": "50ms", "source": "s", "frames": frames}
        field = {"name": "mass", "byte": 0, "type": "u8", "unit": "t", "scale": 0.5}
        topics = [topic(1, "load", [{"fields": [field]}]), topic(2, "load_mass", [{"fields": [field]}]),
                  topic(3, "crane", [{"name": "hook", "id": 3, "fields": [field]}, {"name": "arm", "id": 4, "fields": [field]}]),
                  topic(5, "crane_hook_mass", [{"fields": [field]}]),
                  topic(6, "a", [{"fields": [{"name": "b", "byte": 0, "type": "u8", "unit": "x", "unit_name": "encode", "scale": 0.5}]}]),
                  topic(7, "a_b", [{"fields": [field]}])]
        source = self.folder / "met.c"
        source.write_text('#include "met.h"\nint main(void) { return 0; }\n')
        for order in (topics, topics[::-1]):
            spec = {"robot": "r", "namespace": "r", "bus": {"bit_rate": 500000, "source": "s"},
                    "boards": [{"name": "b", "mcu": "m", "source": "s"}], "topics": order}
            (self.folder / "met.json").write_text(json.dumps(spec))
            generate(self.folder / "met.json", "--to", "c", "-o", self.folder / "met.h")
            text = (self.folder / "met.h").read_text()
            self.assertIn("} r_load_mass_t;", text)
            self.assertIn("double r_load_mass_t_(const r_load_t* value)", text)
            for compiler in (COMPILERS["gcc"], COMPILERS["C++"]):
                self.compile(compiler, source, "-c", "-o", self.folder / "met.o")

    def test_the_frames_of_the_thesis(self):
        self.header("amiro")
        for name in ("gcc", "clang", "C++"):
            program = self.folder / "vectors"
            self.compile(COMPILERS[name], HERE / "vectors.c", "-o", program)
            done = subprocess.run([program], capture_output=True, encoding="utf-8", timeout=60)
            self.assertEqual((done.returncode, done.stdout), (0, ""), name)

    def test_random_frames_agree_with_the_catalogue(self):
        for robot in SPECS:
            header = self.header(robot)
            expected = list(samples(robot, 40))
            kinds = {(s["topic"], s["frame"]): i for i, s in reversed(list(enumerate(expected)))}
            frames = expected[:max(kinds.values()) + 1]
            source = self.folder / "driver.c"
            source.write_text(driver(robot, header, frames))
            # -O1: what is not initialised would be reported.
            self.compile(COMPILERS["gcc"], source, "-O1", "-Wno-maybe-uninitialized", "-o", self.folder / "driver")
            lines = [f'{kinds[s["topic"], s["frame"]]} {s["id"]} {len(s["data"]) // 2} {s["data"] or "-"}' for s in expected]
            done = subprocess.run([self.folder / "driver"], input="\n".join(lines), capture_output=True, encoding="utf-8",
                                  timeout=60, check=True)
            printed = done.stdout.splitlines()
            self.assertEqual(len(printed), len(expected))
            for sample, line in zip(expected, printed):
                words = line.split()
                for i, (name, field) in enumerate(sample["fields"].items()):
                    raw, physical, again = words[3 * i:3 * i + 3]
                    if "float" in field:
                        self.check_float((sample, name), field, raw, physical, again)
                        continue
                    self.assertEqual(int(raw), field["raw"], (sample, name))
                    if field["unit"]:
                        if field["width"] <= 32:
                            self.assertEqual(float(physical), float(field["value"]), (sample, name))
                        self.assertEqual(int(again), min(max(field["raw"], field["low"]), field["high"]), (sample, name))
                id, dlc, data = words[-3:]
                self.assertEqual((int(id), int(dlc)), (sample["id"], len(sample["data"]) // 2))
                self.assertEqual(self.fields_of(robot, sample, data), sample["data"].ljust(16, "0"), sample)

    def check_float(self, where, field, raw, physical, again):
        self.assertTrue(is_near(raw, real(field), 0), (where, raw))
        if not field["unit"]:
            return
        self.assertTrue(is_near(physical, field["value"], 1e-14), (where, physical))
        value, low, high = float(field["value"]), field["low"], field["high"]
        if low == high:
            expected = real(field)
        else:  # the ranges of these specs have zero in them, and scales of 1
            expected = 0 if math.isnan(value) else min(max(value, low), high)
        if abs(expected) < 1e-12:  # an offset takes the last digits
            self.assertLess(abs(float(again)), 2e-12, (where, again, expected))
        else:
            self.assertTrue(is_near(again, expected, 1e-6 if field["float"] == 32 else 1e-2 if abs(expected) < 1 else 1e-12),
                            (where, again, expected))

    @staticmethod
    def fields_of(robot, sample, data):
        """What was encoded, with the bits that no field has as they came."""
        if robot == "amiro":
            return data  # every bit is a field's
        covered = 0
        topics = spec_topics(robot)
        usual = json.loads(SPECS[robot].read_text()).get("byte_order", "little")
        name = sample["topic"] if sample["topic"] in topics else sample["topic"].rsplit("_", 1)[0]
        frame_name = re.sub(r"_\d+$", "", sample["frame"])
        frame = next(f for f in topics[name]["frames"] if f.get("name", "") == frame_name)
        for field in frame["fields"]:
            width = int(field["type"][1:])
            order = field.get("byte_order", frame.get("byte_order", topics[name].get("byte_order", usual)))
            bit = field["bit"] if "bit" in field else 8 * field["byte"] + (7 if order == "big" else 0)
            for _ in range(width):
                covered |= 1 << 8 * (7 - bit // 8) + bit % 8
                bit += 1 if order == "little" else -1 if bit % 8 else 15
        came = int(sample["data"].ljust(16, "0"), 16)
        return f"{(int(data, 16) & covered) | (came & ~covered):016X}"


if __name__ == "__main__":
    unittest.main()
