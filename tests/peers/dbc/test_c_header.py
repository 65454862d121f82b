"""The C header that ocm-generate makes of random DBC files, against the second reader: each field of random frames, read and put."""

import json
import os
import pathlib
import random
import shutil
import subprocess
import tempfile
import unittest

import random_dbc
import second_reader
import write_dbc
from headers import check, data_of, is_plain, of_folder, raw_spelled, selectors_first, spelled

SOURCE = pathlib.Path(os.environ["OCM_SOURCE_DIR"])
GENERATE = os.environ["OCM_GENERATE"]
WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Werror".split()
COMPILERS = {
    "gcc": ["gcc", "-std=c99"],
    "clang": ["clang-14", "-std=c99"],
    "C++": ["g++", "-std=c++11", "-x", "c++"],
    "Cortex-M0": ["arm-none-eabi-gcc", "-std=c99", "-mcpu=cortex-m0", "-mthumb", "-Os"],
}
FRAMES = 40  # of each message

PROGRAM = r"""
#include "bus.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static void bytes(const char* name, const uint8_t* data, unsigned length) {
  unsigned i;
  printf("%s ", name);
  for (i = 0; i < length; ++i) printf("%02x", (unsigned)data[i]);
  printf("\n");
}

int main(void) {
  int which;
  char text[200];
  while (scanf("%d %199s", &which, text) == 2) {
    uint8_t data[64];
    unsigned byte, length = 0;
    while (length < sizeof data && sscanf(text + 2 * length, "%2x", &byte) == 1) data[length++] = (uint8_t)byte;
    switch (which) {
CASES
      default: return 1;
    }
    printf(".\n");
  }
  return 0;
}
"""


def types(signal):
    """Of the raw number, and of what it means."""
    width = next(width for width in (8, 16, 32, 64) if signal.length <= width)
    raw = f"{'uint' if signal.floating or not signal.signed else 'int'}{width}_t"
    return raw, raw if is_plain(signal) else "double"


def shown(value, signal, raw):
    """A statement that prints it."""
    if not raw and not is_plain(signal):
        return f'printf("%.17g", (double){value});'
    signed = signal.signed and not signal.floating
    return f'printf("%" PRI{"d" if signed else "u"}64, ({"int64_t" if signed else "uint64_t"}){value});'


def limits(message, signal, of, put, get):
    """Raw numbers beyond the width become the nearest that it holds."""
    raw, _ = types(signal)
    width = int(raw.removesuffix("_t").lstrip("uint"))
    if signal.floating or signal.length == width:
        return []
    low, high = (-(1 << signal.length - 1), (1 << signal.length - 1) - 1) if signal.signed else (0, (1 << signal.length) - 1)
    return [f"{of}_{put}(&limits, ({raw}){'' if signal.signed else 'U'}INT{width}_MAX); if ({get} != {high}) abort();",
            *([f"{of}_{put}(&limits, INT{width}_MIN); if ({get} != {low}) abort();"] if signal.signed else [])]


def case(index, message, bus="bus"):
    type_of = f"{bus}_{spelled(message.name)}"
    of = type_of.removesuffix("_")
    lines = [f"case {index}: {{", f"{type_of} message, raw, physical;", "unsigned i;",
             f'if (!{of}_decode(&message, data, length)) {{ printf("short\\n"); break; }}',
             "for (i = 0; i < sizeof raw.bytes; ++i) raw.bytes[i] = physical.bytes[i] = 0;"]
    for signal in selectors_first(message):
        name, (raw_type, type_) = spelled(signal.name), types(signal)
        raw_name = name if is_plain(signal) else raw_spelled(signal.name)
        body = []
        if signal.selector is None:
            body.append(f"const {raw_type} number = {of}_{raw_name}(&message); const {type_} value = {of}_{name}(&message);")
        elif is_plain(signal):
            body += [f"{raw_type} number; const {raw_type}* const value_ = &number; {raw_type} value;",
                     f"if (!{of}_{name}(&message, &number)) abort();", "value = *value_;"]
        else:
            body += [f"const {raw_type} number = {of}_{raw_name}(&message); {type_} value;"]
            if signal.floating and signal.length == 32 and signal.scale == 1 and signal.offset == 0:
                body += [f"float real; if (!{of}_{name}(&message, &real)) abort();", "value = (double)real;"]
            else:
                body += [f"if (!{of}_{name}(&message, &value)) abort();"]
        body += [f'printf("{name} ");', shown("number", signal, True), 'printf(" ");', shown("value", signal, False), 'printf("\\n");']
        single = signal.floating and signal.length == 32 and signal.scale == 1 and signal.offset == 0
        given = "(float)value" if single else "value"
        if signal.selector is None:
            body += [f"{of}_set_{raw_name}(&raw, number);", f"{of}_set_{name}(&physical, {given});",
                     f"{{ {type_of} limits = message;", *limits(message, signal, of, f"set_{raw_name}", f"{of}_{raw_name}(&limits)"),
                     "(void)limits; }"]
            lines += ["{", *body, "}"]
        else:
            put = f"if (!{of}_set_{name}(&raw, number)) abort();" if is_plain(signal) else f"{of}_set_{raw_name}(&raw, number);"
            body += [put, f"if ({of}_has_{name}(&physical) && !{of}_set_{name}(&physical, {given})) abort();"]
            none = "float" if single else type_
            lines += [f"if ({of}_has_{name}(&message)) {{", *body, "} else {", f"{none} none = 0; {type_of} same = message; unsigned j;",
                      f"if ({of}_{name}(&message, &none) || {of}_set_{name}(&same, none)) abort();",
                      "for (j = 0; j < sizeof same.bytes; ++j) if (same.bytes[j] != message.bytes[j]) abort();", "}"]
    return "\n".join([*lines, f'bytes("raw:", raw.bytes, {message.length}); bytes("physical:", physical.bytes, {message.length});',
                      "break; }"])


class CHeader(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="ocm-test-")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def compile(self, name, *options):
        compiler = COMPILERS[name]
        self.assertIsNotNone(shutil.which(compiler[0]), f"{compiler[0]} is missing: scripts/setup")
        done = subprocess.run([*compiler, *WARNINGS, "-I", self.folder, self.folder / "main.c", *options], capture_output=True,
                              encoding="utf-8", timeout=300)
        if done.returncode != 0 or done.stderr:
            self.fail(f"{name}: {done.stderr[:3000]}")

    def generate(self, seed):
        database = random_dbc.database(seed, messages=10)
        (self.folder / "bus.dbc").write_bytes(write_dbc.write(database, seed).encode())
        subprocess.run([GENERATE, self.folder / "bus.dbc", "--to", "c", "-o", self.folder / "bus.h"], check=True)
        cases = "\n".join(case(index, message) for index, message in enumerate(database.messages))
        (self.folder / "main.c").write_text(PROGRAM.replace("CASES", cases))
        return database

    def answers(self, lines):
        done = subprocess.run([self.folder / "main"], input="".join(line + "\n" for line in lines), check=True, capture_output=True,
                              text=True, timeout=60)
        return done.stdout.split("\n.\n")

    def check_frames(self, where, messages, seed, count):
        chance = random.Random(seed)
        frames = [(index, message, data_of(chance, message)) for index, message in enumerate(messages) for _ in range(count)]
        answers = self.answers([f"{index} {data.hex()}" for index, _, data in frames])
        self.assertEqual(len(answers), len(frames) + 1)
        for (index, message, data), answer in zip(frames, answers):
            check(self, f"{where}, message {index}", message, data, answer.split("\n"))

    def test_files_of_a_folder(self):
        """Every real file that has messages: its header compiles without a warning, and has the values of random frames."""
        files = 0
        for spec, messages in of_folder():
            with self.subTest(spec.name):
                subprocess.run([GENERATE, spec, "--to", "c", "-o", self.folder / "bus.h"], check=True, capture_output=True)
                bus = spelled(spec.stem)
                cases = "\n".join(case(index, message, bus) for index, message in enumerate(messages))
                (self.folder / "main.c").write_text(PROGRAM.replace("CASES", cases))
                self.compile("gcc", "-o", self.folder / "main")
                self.check_frames(spec.name, messages, spec.name, 10)
            files += 1
        self.assertGreater(files, 0)

    def check_compiler(self, compiler, seed):
        database = self.generate(seed)
        self.compile(compiler, "-O1", "-o", self.folder / "main")
        self.check_frames(f"seed {seed}", database.messages, seed, FRAMES)
        index = next(i for i, message in enumerate(database.messages) if message.length > 1)
        self.assertEqual(self.answers([f"{index} {'00' * (database.messages[index].length - 1)}"]), ["short", ""])

    def test_gcc(self):
        self.check_compiler("gcc", 1)

    def test_clang(self):
        self.check_compiler("clang", 2)

    def test_cpp(self):
        self.check_compiler("C++", 3)

    def test_cortex_m0(self):
        """All of random files compiles; what it calls is in the compiler's own library, and what that needs of the C library."""
        self.generate(4)
        # Without the program: there is no stdio on a board.
        functions = [line for line in (self.folder / "bus.h").read_text().splitlines() if line.startswith("static inline")]
        self.assertGreater(len(functions), 100)
        header = (self.folder / "bus.h").read_text().replace("static inline", "extern")
        (self.folder / "main.c").write_text("#pragma GCC diagnostic ignored \"-Wmissing-prototypes\"\n" + header)
        self.compile("Cortex-M0", "-c", "-o", self.folder / "main.o")
        names = subprocess.run(["arm-none-eabi-nm", "-u", self.folder / "main.o"], capture_output=True, text=True, check=True).stdout
        foreign = [word for word in names.split() if not word.startswith("__aeabi_") and word not in ("U", "memcpy", "memset")]
        self.assertEqual(foreign, [])

    def test_which_frames_and_start_values(self):
        truck = second_reader.read((SOURCE / "examples" / "truck.dbc").read_bytes())
        for name in ("small_car", "truck"):
            subprocess.run([GENERATE, SOURCE / "examples" / f"{name}.dbc", "--to", "c", "-o", self.folder / f"{name}.h"], check=True)
        group = next(message for message in truck.messages if message.j1939 and (message.number >> 16 & 0xFF) >= 240)
        of = f"truck_{spelled(group.name)}_is"
        (self.folder / "main.c").write_text(f"""
#include "small_car.h"
#include "truck.h"
#include <stdio.h>
int main(void) {{
  small_car_Engine engine;
  small_car_Engine_init(&engine);
  printf("%g %g\\n", small_car_Engine_Coolant(&engine), small_car_Engine_Speed(&engine));
  printf("%d%d%d\\n", small_car_Engine_is(0x100u, 0), small_car_Engine_is(0x100u, 1), small_car_Engine_is(0x101u, 0));
  printf("%d%d%d\\n", {of}({group.number & 0x1FFFFFFF}u, 1), {of}({group.number & 0x03FFFF00 | 0x0C000017}u, 1),
         {of}({group.number ^ 0x100}u, 1));
  printf("%u %u %d\\n", SMALL_CAR_ENGINE_ID, SMALL_CAR_ENGINE_PERIOD_US, SMALL_CAR_BATTERYCELLS_FD);
  return 0;
}}
""")
        for compiler in ("gcc", "C++"):
            self.compile(compiler, "-o", self.folder / "main")
            said = subprocess.run([self.folder / "main"], capture_output=True, text=True, check=True).stdout
            self.assertEqual(said, "20 0\n100\n110\n256 10000 1\n")

    def test_odd_names(self):
        """Names that meet: of fields, of values, of the header's own functions; nothing that no message needs is written."""
        spec = {"robot": "7 odd/names", "messages": [
            {"name": "class", "id": 1, "description": "ends in a backslash\\", "fields": [
                {"name": "init", "byte": 0, "type": "u8", "values": {"int": 0, "a b": 1, "a-b": 2, "\u00e4": 3}},
                {"name": "X", "byte": 2, "type": "u8", "scale": 2}, {"name": "X_raw", "byte": 3, "type": "u8"},
                {"name": "decode", "byte": 4, "type": "u8"}, {"name": "set_X", "byte": 5, "type": "u8"},
                {"name": "lamps", "byte": 6, "type": "u8", "flags": {"left": 0, "new": 7}}]},
            {"name": "class", "id": 2, "length": 1, "fields": [{"name": "none", "byte": 0, "type": "u4", "scale": 0, "offset": 5}]},
            {"name": "nearest", "id": 3, "fields": [{"name": "M", "byte": 0, "type": "u64", "scale": 0.5}]},
            {"name": "class_X", "id": 5, "fields": [{"name": "raw", "byte": 0, "type": "i64"}]},
            {"name": "Empty", "id": 4, "fields": []}]}
        (self.folder / "bus.json").write_text(json.dumps(spec))
        subprocess.run([GENERATE, self.folder / "bus.json", "--to", "c", "-o", self.folder / "bus.h"], check=True)
        header = (self.folder / "bus.h").read_text()
        for absent in ("string.h", "_float_of(", "_held_i64(", "_at_most_u64("):
            self.assertNotIn(absent, header)
        (self.folder / "main.c").write_text("""
#include "bus.h"
int main(void) {
  n7_odd_names_class_ m;
  n7_odd_names_class_init(&m);
  return n7_odd_names_class_lamps(&m) == N7_ODD_NAMES_CLASS_LAMPS_NEW_ ? 1 : 0;
}
""")
        for compiler in COMPILERS:
            self.compile(compiler, "-c", "-o", self.folder / "main.o")


if __name__ == "__main__":
    unittest.main()
