#!/usr/bin/env python3
"""The checker, checked: a small tree that keeps every rule, and one planted violation after the other."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import check
import house
import sources

ROW = "| 9 | `extra` | what is planted | {} | host |\n"

GOOD = {
    "README.md": "# A project\n\n[architecture](docs/architecture.md#floors)\n\n<!-- snippet: hello -->\n```cpp\n"
                 "greet();\nif (true) {\n  greet();\n}\n```\n",
    "docs/architecture.md": "# Architecture\n\n## Floors\n\n[home](../README.md), [pages](README.md)\n\n<!-- floors: read by a test -->\n\n"
                            "| floor | folder | what | may include | runs on |\n|---|---|---|---|---|\n"
                            "| 0 | `base` | | | board, host |\n"
                            "| 3 | `topics` | | `base` | board, host |\n"
                            "| 5 | `controller` | | `topics` | board, host |\n"
                            "| 5 | `reflective` | | `topics` | host |\n"
                            "| 5 | `skiff/oars` | | `base` | board, host |\n"
                            "| 6 | `transport` | | `base` | host |\n"
                            "\n<!-- end of floors -->\n\n`docs/`, `examples/`, `tests/`; `cli/`: `bell/`, `cli/horn/`, `shared/`, `verbs/`; `generator/`: `spec/`; "
                            "`firmware/`: `boards/`, `system/`; `sim/`: `amiro/`, `mapper/`, `physics/`\n",
    "docs/images/house.svg": "<title>house</title>" + "".join(f"<title>{what}</title>\n" for what in (
        "base", "topics", "controller", "reflective", "skiff/oars", "transport", "base&#45;&gt;topics", "topics&#45;&gt;controller",
        "topics&#45;&gt;reflective", "base&#45;&gt;skiff/oars", "base&#45;&gt;transport")),
    "docs/README.md": "# Pages\n\n[architecture](architecture.md)\n",
    "include/ocm/base/result.hpp": "/// A value or the reason why there is none.\n#pragma once\n#include <new>\n"
                                   "#include <string_view>\nnamespace ocm::base {\nstruct Result {};\n"
                                   "// a new word in a comment, and throw\n"
                                   "inline void put(void* p) { ::new (p) Result; }\nstruct A { A(const A&) = delete; };\n"
                                   "inline constexpr auto text = \"throw new\";\n}\n",
    "include/ocm/topics/ferry.hpp": "// Made by ocm-generate from topics.json. Do not edit.\n#pragma once\n"
                                    '#include "ocm/base/result.hpp"\nnamespace ferry {\nnamespace detail {\n}\n}\n',
    "include/ocm/controller/board.hpp": "/// One board of the robot, that is.\n#pragma once\n"
                                        '#include "ocm/topics/ferry.hpp"\nnamespace ocm::controller {}\n',
    "include/ocm/reflective/robot.hpp": "/// The robot as its operator sees it.\n#pragma once\n#include <vector>\n"
                                        '#include "ocm/topics/ferry.hpp"\nnamespace ocm::reflective {}\n',
    "include/ocm/transport/bus.hpp": "/// A bus of the host, and its sockets.\n#pragma once\n#include <sys/socket.h>\n"
                                     '#include "ocm/base/result.hpp"\nnamespace ocm::transport::detail {}\n'
                                     "namespace ocm::transport {}\n",
    "include/ocm/skiff/oars/left.hpp": "/// A floor below another folder, on the left.\n#pragma once\n"
                                       '#include "ocm/base/result.hpp"\nnamespace ocm::skiff::oars {}\n',
    "generator/main.cpp": '#include "generator/spec/spec.hpp"\nint main() {}\n',
    "generator/spec/spec.hpp": '/// Reads the spec of a robot.\n#pragma once\n#include "ocm/base/result.hpp"\n',
    "firmware/boards/deck/board.hpp": '/// The deck of the ferry, a board.\n#include "ocm/controller/board.hpp"\n',
    "sim/amiro/world.hpp": '/// The water and the quays, simulated.\n#include "firmware/boards/deck/board.hpp"\n',
    "sim/mapper/plough.hpp": '/// Another robot, on land, simulated.\n#include "sim/physics/body.hpp"\n',
    "sim/physics/body.hpp": "/// What falls, and what floats.\n",
    "cli/wait.hpp": "/// How the tool waits for its user.\n",
    "firmware/system/image.cpp": '#include "firmware/boards/deck/board.hpp"\n',
    "cli/main.cpp": '#include "cli/verbs/verbs.hpp"\n',
    "cli/verbs/verbs.hpp": "/// The verbs of the tool, one file each.\n#pragma once\n",
    "cli/verbs/ring.cpp": '#include "cli/verbs/verbs.hpp"\n#include "cli/horn/horn.hpp"\n',
    "cli/bell/bell.hpp": "/// The bell of the ferry, which is rung.\n#pragma once\n",
    "cli/horn/horn.hpp": '/// The horn of the ferry, with a bell.\n#pragma once\n#include "cli/bell/bell.hpp"\n',
    "cli/shared/arguments.cpp": "#include <CLI/CLI.hpp>\n",
    "examples/0_hello.cpp": "int main() {\n  // snippet: hello\n  greet();\n  if (true) {\n    greet();\n  }\n"
                            "  // endsnippet\n}\n",
    "tests/unit/base/result.cpp": "",
    "tests/unit/topics/ferry.cpp": "",
    "tests/unit/controller/board.cpp": "",
    "tests/unit/reflective/robot.cpp": "",
    "tests/unit/skiff/oars/left.cpp": "",
    "tests/unit/transport/bus.cpp": "",
}


def replaced(name, old, new):
    assert old in GOOD[name], (name, old)
    return {name: GOOD[name].replace(old, new)}


def added(name, text):
    return {name: GOOD[name] + text}


RESULT, BOARD, ROBOT = ("include/ocm/base/result.hpp", "include/ocm/controller/board.hpp",
                        "include/ocm/reflective/robot.hpp")
OARS = "include/ocm/skiff/oars/left.hpp"
BELL = "cli/bell/bell.hpp"
README, PAGE, FERRY = "README.md", "docs/architecture.md", "include/ocm/topics/ferry.hpp"

# rule, what is planted (None removes a file), where it must be found
PLANTED = [
    ("floor_table", {PAGE: None}, "docs/architecture.md: there is no such page"),
    ("floor_table", replaced(PAGE, "<!-- end of floors -->", ""), "no table between"),
    ("floor_table", replaced(PAGE, "| 3 | `topics` | | `base` |", "| 3 | `topics` | | `transport` |"), "not below it"),
    ("floor_table", replaced(PAGE, "| 3 | `topics` | | `base` |", "| 3 | `topics` | | `cellar` |"), "has no row"),
    ("floor_table", replaced(PAGE, "| 0 | `base` | | | board, host |", "| 0 | `base` | | | host |"),
     "runs on a board, 'base' does not"),
    ("floors_have_rows", replaced(PAGE, "<!-- end", ROW.format("`base`") + "<!-- end"), "docs/architecture.md:1:"),
    ("floors_have_rows", {"include/ocm/attic/a.hpp": "/// Nobody knows why this is here.\nnamespace ocm::attic {}\n",
                          "tests/unit/attic/a.cpp": ""}, "include/ocm/attic/a.hpp:1:"),
    ("house_is_drawn", replaced("docs/images/house.svg", "<title>transport</title>", ""), "house.svg:1: lacks transport; draw it"),
    ("house_is_drawn", replaced(PAGE, "| 6 | `transport` | | `base` |", "| 6 | `transport` | | `topics` |"), "house.svg:1: still has base->transport; draw it"),
    ("includes_go_down", added(RESULT, '#include "ocm/transport/bus.hpp"\n'), RESULT + ":12:"),
    ("includes_go_down", added("include/ocm/transport/bus.hpp", '#include "ocm/topics/ferry.hpp"\n'), "bus.hpp:7:"),
    ("includes_go_down", added(BOARD, '#include "result.hpp"\n'), BOARD + ":5:"),
    ("includes_go_down", added(BOARD, '#include "ocm/base/absent.hpp"\n'), BOARD + ":5:"),
    ("includes_go_down", added(BOARD, "#include <ocm/base/result.hpp>\n"), BOARD + ":5:"),
    ("includes_go_down", added(OARS, '#include "ocm/topics/ferry.hpp"\n'), OARS + ":5:"),
    ("namespace_is_folder", replaced(OARS, "ocm::skiff::oars", "ocm::skiff"), OARS + ":1:"),
    ("layers_are_apart", added(ROBOT, '#include "ocm/controller/board.hpp"\n'), ROBOT + ":1:"),
    ("layers_are_apart", {**added(FERRY, '#include "ocm/controller/board.hpp"\n')}, ROBOT + ":1:"),
    ("library_knows_no_tool", added(RESULT, 'auto s = "start one: amiroctl sim";\n'), RESULT + ":12:"),
    ("library_knows_no_tool", added(RESULT, 'auto s = "name it with --bus";\n'), RESULT + ":12:"),
    ("library_knows_no_tool", added(RESULT, '// amiroctl\nauto s = "\\" --verbose";\n'), RESULT + ":13:"),
    ("mapper_knows_no_can",
     {"include/ocm/mapper/app/a.hpp": '#include "ocm/mapper/app/b.hpp"\n',
      "include/ocm/mapper/app/b.hpp": '#include "ocm/can/frame.hpp"\n', "include/ocm/can/frame.hpp": ""},
     "include/ocm/mapper/app/a.hpp:1:"),
    ("no_circles", added(RESULT, '#include "ocm/topics/ferry.hpp"\n'), "a circle of includes"),
    ("namespace_is_folder", replaced(BOARD, "ocm::controller", "ocm::control"), BOARD + ":1:"),
    ("namespace_is_folder", added(BOARD, "namespace ocm::base {}\n"), BOARD + ":5:"),
    ("namespace_is_folder", replaced(FERRY, "namespace ferry", "namespace boat"), FERRY + ":1:"),
    ("namespace_is_folder", replaced(BOARD, "namespace ocm::controller {}", ""), BOARD + ":1:"),
    ("standard_headers_are_included", added(RESULT, "// std::array\nusing Size = std::size_t;\n"),
     RESULT + ":13: std::size_t needs <cstddef>"),
    ("standard_headers_are_included", added(BOARD, "#include <array>\n") | added(RESULT, "std::array<int, 2> a;\n"), RESULT + ":12:"),
    ("standard_headers_are_included", added("firmware/boards/deck/board.hpp", "std::span<int> s;\n"), "board.hpp:3:"),
    ("standard_headers_are_included", added(RESULT, "#include <span>\nstd::spam<int> s;\n"), "std::spam is not known"),
    ("headers_open_with_a_comment", replaced(BOARD, "/// One board of the robot, that is.\n", ""), BOARD + ":1:"),
    ("headers_have_tests", {"tests/unit/base/result.cpp": None}, RESULT + ":1:"),
    ("tests_have_their_namespace", {"tests/unit/base/result.cpp": "\nnamespace {\n}\n"}, "tests/unit/base/result.cpp:2:"),
    ("tests_have_their_namespace", {"tests/unit/base/result.cpp": 'TEST_CASE("a") {}\n'}, "tests/unit/base/result.cpp:1:"),
    ("headers_have_tests", {"tests/unit/base/ghost.cpp": ""}, "tests/unit/base/ghost.cpp:1:"),
    ("own_includes_are_full_paths", added("generator/spec/spec.hpp", '#include "json.hpp"\n'), "generator/spec/spec.hpp:4:"),
    ("generator_is_independent", added("generator/spec/spec.hpp", '#include "ocm/topics/ferry.hpp"\n'),
     "generator/main.cpp:1:"),
    ("firmware_is_for_boards", added("firmware/boards/deck/board.hpp", '#include "ocm/reflective/robot.hpp"\n'),
     "firmware/boards/deck/board.hpp:1:"),
    ("firmware_is_for_boards", added("firmware/boards/deck/board.hpp", '#include "sim/amiro/world.hpp"\n'),
     "firmware/boards/deck/board.hpp:1:"),
    ("firmware_is_for_boards", added("firmware/boards/deck/board.hpp", '#include "firmware/system/image.cpp"\n'),
     "firmware/boards/deck/board.hpp:1:"),
    ("firmware_is_for_boards", added("firmware/system/image.cpp", '#include "ocm/transport/bus.hpp"\n'),
     "firmware/system/image.cpp:1:"),
    ("rooms_are_apart", added("firmware/system/image.cpp", '#include "sim/physics/body.hpp"\n'),
     "firmware/system/image.cpp:1:"),
    ("rooms_are_apart", added("firmware/system/image.cpp", '#include "cli/wait.hpp"\n'),
     "firmware/system/image.cpp:1:"),
    ("rooms_are_apart", added("sim/amiro/world.hpp", '#include "cli/wait.hpp"\n'), "sim/amiro/world.hpp:1:"),
    ("rooms_are_apart", added("sim/physics/body.hpp", '#include "cli/wait.hpp"\n'), "sim/mapper/plough.hpp:1:"),
    ("rooms_are_apart", added("generator/main.cpp", '#include "cli/wait.hpp"\n'), "generator/main.cpp:1:"),
    ("rooms_are_apart", added("sim/mapper/plough.hpp", '#include "sim/amiro/world.hpp"\n'), "sim/mapper/plough.hpp:1:"),
    ("rooms_are_apart", added("sim/amiro/world.hpp", '#include "sim/mapper/plough.hpp"\n'), "sim/amiro/world.hpp:1:"),
    ("folders_make_no_circle", {"sim/physics/sea.hpp": '/// How deep it is.\n#include "sim/mapper/plough.hpp"\n'},
     "sim/mapper -> sim/physics -> sim/mapper"),
    ("verbs_are_seen_by_main_only", added(BELL, '#include "cli/verbs/verbs.hpp"\n'), BELL + ":3:"),
    ("verbs_are_seen_by_main_only", added("sim/amiro/world.hpp", '#include "cli/verbs/verbs.hpp"\n'), "world.hpp:3:"),
    ("no_circles_of_rooms", added(BELL, '#include "cli/horn/horn.hpp"\n'),
     "cli/horn/horn.hpp:3: \"cli/bell/bell.hpp\": a circle of rooms: bell -> horn -> bell"),
    ("costly_headers_are_seen_by_few", added("cli/verbs/ring.cpp", "#include <CLI/CLI.hpp>\n"), "ring.cpp:3:"),
    ("costly_headers_are_seen_by_few", added("generator/spec/spec.hpp", "#include <nlohmann/json.hpp>\n"), "spec.hpp:4:"),
    ("generated_files_are_reproducible", added(FERRY, "// 2024-05-01\n"), FERRY + ":8:"),
    ("no_machine_paths", {"cli/x.cpp": 'auto p = "/wor' 'k/main";\n'}, "cli/x.cpp:1:"),
    ("no_machine_paths", {"cli/x.cpp": "\n// see /hom" "e/jane/ocm\n"}, "cli/x.cpp:2:"),
    ("no_machine_paths", {"cli/x.cpp": "// built in /tm" "p/build-me\n"}, "cli/x.cpp:1:"),
    ("no_machine_paths", {"cli/x.cpp": "// as shar" "ed/facts says\n"}, "cli/x.cpp:1:"),
    ("links_resolve", added(README, "[gone](docs/gone.md)\n"), "README.md:12:"),
    ("links_resolve", added(README, "[gone](docs/architecture.md#ceilings)\n"), "README.md:12:"),
    ("named_files_exist", added(README, "see `include/ocm/base/gone.hpp`\n"), "README.md:12:"),
    ("named_files_exist", added(README, "see `cli/bells/*.hpp`\n"), "README.md:12:"),
    ("named_files_exist", added(README, "see `base/gone.hpp`\n"), "README.md:12:"),
    ("named_files_exist", added(README, "[gone.hpp](include/ocm/base/result.hpp)\n"), "README.md:12:"),
    ("named_files_exist", added(README, "    build/unit_gone '[times]'\n"), "README.md:12:"),
    ("tables_are_whole", added(README, "\n| a | b |\n|---|---|\n\n| 1 | 2 |\n"), "README.md:16:"),
    ("words_are_plain", added(README, "What is lost, nobody knows.\n"), "README.md:12:"),
    ("words_are_plain", added(README, "A bad line is\ntold.\n"), "README.md:12:"),
    ("words_are_plain", added("cli/main.cpp", 'auto text = "a log is wanted";\n'), "cli/main.cpp:2:"),
    ("words_are_plain", added("cli/main.cpp", "// Until somebody quits.\n"), "cli/main.cpp:2:"),
    ("words_are_plain", added("cli/main.cpp", "int nobody = 0;\n"), "cli/main.cpp:2:"),
    ("words_are_plain", {"tests/unit/base/a.cpp": 'TEST_CASE("a reader that nobody feeds") {}\n'}, "tests/unit/base/a.cpp:1:"),
    ("words_are_plain", {"tests/tool/test_a.py": "# It begins anew.\n"}, "tests/tool/test_a.py:1:"),
    ("words_are_plain", {"scripts/a": "#!/bin/sh\n# whoever runs it\n"}, "scripts/a:2:"),
    ("pages_are_linked", {"docs/island.md": "# Island\n\n[me](island.md)\n"}, "docs/island.md:1:"),
    ("indexes_are_complete", added("docs/README.md", "[again](architecture.md#floors)\n"), "docs/architecture.md:1:"),
    ("indexes_are_complete", {"docs/a/README.md": "", "docs/a/b.md": ""}, "docs/a/b.md:1:"),
    ("indexes_are_complete", {"docs/README.md": None}, "docs/architecture.md:1:"),
    ("test_folders_have_rows", {"tests/tool/bells/CMakeLists.txt": ""}, "tests/tool/bells/CMakeLists.txt:1:"),
    ("test_folders_have_rows", {"tests/bells/CMakeLists.txt": "", "tests/README.md": "`bells`, `tool/bells/`\n"},
     "tests/bells/CMakeLists.txt:1:"),
    ("folders_are_named", {"cli/gong/gong.hpp": "/// The gong of the ferry, beaten.\n#pragma once\n"}, "cli/gong/gong.hpp:1:"),
    ("folders_are_named", replaced(PAGE, "`examples/`", "examples"), "examples/0_hello.cpp:1:"),
    ("sleeps_say_why", {"tests/tool/test_a.py": "time.sleep(0.1)\ntime.sleep(1.5)  # the time itself\ntime.sleep(0.2)\n"}, "tests/tool/test_a.py:3:"),
    ("sleeps_say_why", {"tests/tool/test_a.py": "# for a while\ntime.sleep(wait)\n"}, "tests/tool/test_a.py:2:"),
    ("sleeps_say_why", {"tests/sim/a.cpp": "std::this_thread::sleep_for(100ms);\nstd::this_thread::sleep_for(101ms);\n"}, "tests/sim/a.cpp:2:"),
    ("sleeps_say_why", {"tests/sim/a.cpp": "std::this_thread::sleep_until(end);\n"}, "tests/sim/a.cpp:1:"),
    ("quotes_are_the_examples", replaced(README, "  greet();", "   greet();"), "README.md:5:"),
    ("quotes_are_the_examples", replaced(README, "snippet: hello", "snippet: goodbye"), "README.md:5:"),
    ("quotes_are_the_examples", added(README, "\n```cpp\nint unquoted;\n```\n"), "README.md:13:"),
    ("quotes_are_the_examples", added(README, "<!-- snippet: hello -->\nprose\n"), "README.md:12:"),
]
PLANTED += [("no_banned_headers", replaced(BOARD, "#pragma once\n", f"#pragma once\n#include <{header}>\n"), BOARD + ":3:")
            for header in sorted(sources.BANNED_HEADERS)]
PLANTED += [("no_banned_headers", added("firmware/boards/deck/board.hpp", "#include <iostream>\n"), "board.hpp:3:")]
PLANTED += [("no_banned_words", added(BOARD, f"{code}\n"), BOARD + ":5:")
            for code in ("void f() { throw 1; }", "auto p = new int;", "auto p = new int[3];", "void f(int* p) { delete p; }",
                         "auto d = dynamic_cast<D*>(b);", "auto& t = typeid(int);", "auto p = std::malloc(3);",
                         "void f() { try { g(); } catch (...) {} }", "std::string s;", "std::function<void()> f;",
                         "auto now = std::chrono::steady_clock::now();", "void f() { assert(true); }")]


def write(folder, contents):
    """Writes the files; None removes one."""
    for name, text in contents.items():
        path = pathlib.Path(folder, name)
        if text is None:
            path.unlink(missing_ok=True)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)


class Checker(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        write(cls.folder.name, GOOD)

    def violations(self, changes):
        write(self.folder.name, changes)
        try:
            return check.check(self.folder.name)
        finally:
            write(self.folder.name, {name: GOOD.get(name) for name in changes})

    def test_a_good_tree_has_no_violation(self):
        self.assertEqual(self.violations({}), [])

    def test_every_planted_violation_is_found_by_its_rule(self):
        for rule, changes, where in PLANTED:
            with self.subTest(rule=rule, planted=changes):
                found = [violation for by, violation in self.violations(changes) if by == rule]
                self.assertTrue(any(where in violation for violation in found), found)

    def test_every_rule_has_a_planted_violation(self):
        self.assertEqual({rule.__name__ for rule in check.RULES} | {"floor_table"}, {rule for rule, _, _ in PLANTED})

    def test_a_planted_header_is_found_once(self):
        found = self.violations(added(BOARD, "auto p = new int;\n"))
        self.assertEqual([rule for rule, _ in found], ["no_banned_words"])

    def test_what_git_ignores_is_no_file_of_the_project(self):
        with tempfile.TemporaryDirectory() as folder:
            write(folder, {"a.txt": "", "build/b.txt": "", ".gitignore": "/build/\n"})
            self.assertEqual(house.files(folder), [".gitignore", "a.txt"])  # not a repository: build folders by name
            subprocess.run(["git", "init", "-q", folder], check=True)
            self.assertEqual(house.files(folder), [".gitignore", "a.txt"])
            (pathlib.Path(folder) / ".gitignore").write_text("a.txt\n/build/\n", encoding="utf-8")
            self.assertEqual(house.files(folder), [".gitignore"])
            with unittest.mock.patch.dict(os.environ, PATH="/nonexistent"):  # git is not installed
                self.assertEqual(house.files(folder), [".gitignore", "a.txt"])

    def test_comments_and_strings_are_not_code(self):
        code = "a; // throw\n/* new\nnew */ b; \"throw \\\" new\"; c = 1'000'000; d = 'x';"
        blank = house.without_comments(code)
        self.assertEqual(len(blank.splitlines()), 3)
        self.assertFalse(re.search("throw|new", blank))
        self.assertIn("1'000'000", blank)


if __name__ == "__main__":
    unittest.main()
