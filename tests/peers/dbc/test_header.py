"""The C++ header that ocm-generate makes of random DBC files, against the second reader: each field of random frames, read and put."""

import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import tempfile
import unittest

import random_dbc
import write_dbc
from headers import check, data_of, member_of, of_folder, raw_of, selectors_first, spelled

SOURCE = pathlib.Path(os.environ["OCM_SOURCE_DIR"])
GENERATE = os.environ["OCM_GENERATE"]
FLAGS = ["-std=c++20", "-O1", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror", f"-I{SOURCE / 'include'}"]
FRAMES = 40  # of each message

PROGRAM = r"""
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <type_traits>
#include <vector>
#include "bus.hpp"

template <class T>
void show(const char* name, auto raw, const T& value) {
  if constexpr (std::is_enum_v<T>) {
    std::cout << name << ' ' << +raw << ' ' << +static_cast<std::underlying_type_t<T>>(value) << '\n';
  } else if constexpr (std::is_floating_point_v<T>) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", static_cast<double>(value));
    std::cout << name << ' ' << +raw << ' ' << text << '\n';
  } else {
    std::cout << name << ' ' << +raw << ' ' << +value << '\n';
  }
}
template <class T>
void bytes(const char* name, const T& message) {
  std::cout << name << ' ';
  for (std::size_t i = 0; i < T::length; ++i) std::printf("%02x", message.bytes[i]), std::fflush(stdout);
  std::cout << '\n' << std::flush;
}

// Of a field x that is plain there is no raw number r beside it.
#define RAW(x, r) [&](const auto& m) { if constexpr (requires { m.r(); }) return m.r(); else return m.x(); }(message)
#define ALWAYS(x, r) show(#x, RAW(x, r), message.x());
#define SOMETIMES(x, r) if (message.has_##x() != message.x().has_value()) std::abort(); \
  if (message.has_##x()) show(#x, RAW(x, r), *message.x());
#define PUT_RAW(x, r) [&](auto& to) { \
  if constexpr (requires { to.r(); }) to.set_##r(RAW(x, r)); else to.set_##x(message.x()); }(raw);
#define PUT(x) physical.set_##x(message.x());
#define PUT_SOMETIMES(x) if (message.has_##x() && !physical.set_##x(*message.x())) std::abort(); \
  if (!physical.has_##x() && physical.set_##x({})) std::abort();

int main() {
  std::string line;
  while (std::getline(std::cin, line)) {
    const std::size_t index = std::stoul(line);
    std::vector<std::uint8_t> data;
    for (std::size_t i = line.find(' ') + 1; i + 1 < line.size(); i += 2)
      data.push_back(static_cast<std::uint8_t>(std::stoi(line.substr(i, 2), nullptr, 16)));
    std::cout << std::flush;
    switch (index) {
CASES
    }
    std::cout << ".\n" << std::flush;
  }
}
"""


def case(index, message, space="bus"):
    lines = [f"case {index}: {{", f"const auto read = {space}::{spelled(message.name)}::decode(std::span<const std::uint8_t>{{data}});",
             "if (!read) { std::cout << \"short\\n\"; break; }", "const auto message = *read;",
             f"{space}::{spelled(message.name)} raw, physical;", "raw.bytes = physical.bytes = {};"]
    for signal in selectors_first(message):
        name = member_of(message, signal.name)
        both = f"{name}, {raw_of(name)}"
        lines.append(f"{'ALWAYS' if signal.selector is None else 'SOMETIMES'}({both})")
        lines.append(f"PUT_RAW({both})" if signal.selector is None else f"if (message.has_{name}()) {{ PUT_RAW({both}) }}")
        lines.append(f"{'PUT' if signal.selector is None else 'PUT_SOMETIMES'}({name})")
    return "\n".join([*lines, 'bytes("raw:", raw);', 'bytes("physical:", physical);', "break; }"])


class Header(unittest.TestCase):
    def compiled(self, compiler, seed, folder):
        database = random_dbc.database(seed, messages=10)
        spec = folder / "bus.dbc"
        spec.write_bytes(write_dbc.write(database, seed).encode())
        subprocess.run([GENERATE, spec, "-o", folder / "bus.hpp"], check=True)
        cases = "\n".join(case(index, message) for index, message in enumerate(database.messages))
        (folder / "main.cpp").write_text(PROGRAM.replace("CASES", cases))
        subprocess.run([compiler, *FLAGS, f"-I{folder}", folder / "main.cpp", "-o", folder / "main"], check=True)
        return database, folder / "main"

    def check_frames(self, where, messages, program, seed, count):
        chance = random.Random(seed)
        frames = [(index, message, data_of(chance, message)) for index, message in enumerate(messages) for _ in range(count)]
        done = subprocess.run([program], input="".join(f"{index} {data.hex()}\n" for index, _, data in frames), check=True,
                              capture_output=True, text=True)
        answers = done.stdout.split("\n.\n")
        self.assertEqual(len(answers), len(frames) + 1)
        for (index, message, data), answer in zip(frames, answers):
            check(self, f"{where}, message {index}", message, data, answer.split("\n"), member_of)

    def test_files_of_a_folder(self):
        """Every real file that has messages: its header compiles without a warning, and has the values of random frames."""
        files = 0
        for spec, messages in of_folder():
            with self.subTest(spec.name), tempfile.TemporaryDirectory(prefix="ocm-test-") as name:
                folder = pathlib.Path(name)
                subprocess.run([GENERATE, spec, "-o", folder / "bus.hpp"], check=True, capture_output=True)
                space = re.search(r"^namespace (\w+) \{", (folder / "bus.hpp").read_text(encoding="utf-8"), re.M)[1]
                cases = "\n".join(case(index, message, space) for index, message in enumerate(messages))
                (folder / "main.cpp").write_text(PROGRAM.replace("CASES", cases))
                subprocess.run(["g++", *FLAGS, "-O0", f"-I{folder}", folder / "main.cpp", "-o", folder / "main"], check=True)
                self.check_frames(spec.name, messages, folder / "main", spec.name, 10)
            files += 1
        self.assertGreater(files, 0)

    def check_compiler(self, compiler, seed):
        if shutil.which(compiler) is None:
            self.fail(f"{compiler} is missing")
        with tempfile.TemporaryDirectory(prefix="ocm-test-") as name:
            database, program = self.compiled(compiler, seed, pathlib.Path(name))
            self.check_frames(f"seed {seed}", database.messages, program, seed, FRAMES)
            short = subprocess.run([program], input=f"0 {'00' * (database.messages[0].length - 1)}\n", check=True,
                                   capture_output=True, text=True)
            self.assertEqual(short.stdout, "short\n.\n")

    def test_gcc(self):
        self.check_compiler("g++", 1)

    def test_clang(self):
        self.check_compiler("clang++-14", 2)

    def test_cortex_m0(self):
        """Without heap and exceptions: what it calls is in the compiler's own library."""
        with tempfile.TemporaryDirectory(prefix="ocm-test-") as name:
            folder = pathlib.Path(name)
            subprocess.run([GENERATE, SOURCE / "examples" / "small_car.dbc", "-o", folder / "bus.hpp"], check=True)
            (folder / "main.cpp").write_text("""#include "bus.hpp"
double torque(const ocm::can::Frame& frame) {
  const auto engine = small_car::Engine::decode(frame);
  return engine ? engine->Torque() : 0;
}
ocm::can::Frame ask(double speed) {
  small_car::Engine engine;
  engine.set_Speed(speed);
  return ocm::protocol::message_frame(engine);
}
""")
            subprocess.run(["arm-none-eabi-g++", *FLAGS, "-Os", "-mcpu=cortex-m0", "-mthumb", "-fno-exceptions", "-fno-rtti",
                            f"-I{folder}", "-c", folder / "main.cpp", "-o", folder / "main.o"], check=True)
            names = subprocess.run(["arm-none-eabi-nm", "-u", folder / "main.o"], capture_output=True, text=True, check=True).stdout
            foreign = [word for word in names.split() if word != "U" and not word.startswith("__aeabi_") and word != "memcpy"]
            self.assertEqual(foreign, [])

    def test_odd_names(self):
        """Words of C++, other characters, names that others are derived from: documented spellings, and it compiles."""
        spec = {"robot": "7 odd/names", "messages": [
            {"name": "class", "id": 1, "description": "ends in a backslash\\", "fields": [
                {"name": "class", "byte": 0, "type": "u8", "values": {"int": 0, "a b": 1, "a-b": 2, "\u00e4": 3, "1st": 4}},
                {"name": "1st", "byte": 1, "type": "u8", "unit": "\u00b0\\", "values": {"SNA": 255}},
                {"name": "X", "byte": 2, "type": "u8", "scale": 2}, {"name": "X_raw", "byte": 3, "type": "u8"},
                {"name": "value", "byte": 4, "type": "u8"}, {"name": "name", "byte": 5, "type": "u8"},
                {"name": "lamps", "byte": 6, "type": "u8", "flags": {"left": 0, "new": 7}},
                {"name": "a.b", "byte": 7, "type": "i8", "values": {"x": -128}}]},
            {"name": "class", "id": 2, "length": 1, "fields": [
                {"name": "beyond", "byte": 1, "type": "u8"}, {"name": "none", "byte": 0, "type": "u4", "scale": 0, "offset": 5}]},
            {"name": "M", "id": 3, "fields": [{"name": "M", "byte": 0, "type": "u64", "scale": 0.5}]},
            {"name": "Empty", "id": 4, "fields": []}]}
        main = r"""
#include "bus.hpp"
using namespace n7_odd_names;
constexpr class_ first = [] {
  class_ m;
  m.set_class_2(class_::class_2Value::n1st);
  m.set_n1st(7);
  m.set_X(9);
  m.set_X_raw_2(3);
  return m;
}();
static_assert(first.bytes[0] == 4 && first.bytes[1] == 7 && first.bytes[2] == 5 && first.bytes[3] == 3);
static_assert(first.class_2() == class_::class_2Value::n1st);
static_assert(class_::lampsValue::new_ == 0x80 && class_::lampsValue::left == 0x01);
static_assert(class_2{}.none() == 5.0);
static_assert(M{}.M_2() == 0.0);
static_assert(Empty::length == 0);
int main() {}
"""
        with tempfile.TemporaryDirectory(prefix="ocm-test-") as name:
            folder = pathlib.Path(name)
            (folder / "bus.json").write_text(json.dumps(spec))
            subprocess.run([GENERATE, folder / "bus.json", "-o", folder / "bus.hpp"], check=True)
            (folder / "main.cpp").write_text(main)
            subprocess.run(["g++", *FLAGS, "-fsyntax-only", f"-I{folder}", folder / "main.cpp"], check=True)


if __name__ == "__main__":
    unittest.main()
