#!/usr/bin/env python3
"""What scripts/test asks of ctest.

    runs.py select BUILD PARTS NAME...   the tests that the names mean, each a test's name or a regular expression of all of it:
                                   on stdout a regular expression for `ctest -R`, then the targets that they run, a line each.
                                   Exit 2 where a name means none, with the nearest ones, of the PARTS of scripts/test,
                                   "release style", too.
    runs.py programs BUILD LABELS TESTS
                                   the targets that tests run whose name the regular expression TESTS finds and none of whose
                                   labels LABELS does, as `ctest -LE LABELS -R TESTS` chooses them: on stdout, a line each.
    runs.py without BUILD LABELS TESTS
                                   all but these tests: on stdout a regular expression of them for `ctest -E`, then the
                                   targets of `all`, a line each, without the programs that only these tests run.
    runs.py report [--left-out FILE]... JUNIT...
                                   of ctest's --output-junit: how many tests passed, which failed, which were skipped, whole
                                   or in part, which took longest; of the FILEs, which CMake has left out because a program is
                                   missing. Exit 1 where one was skipped that may not be, or left out: scripts/setup has
                                   installed what all of them need.
"""

import difflib
import fnmatch
import json
import os
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree


# Tests in which a case may be skipped, and why a machine may have to.
MAY_SKIP = {"logs_durability": "not every user may mount the small disk that it fills"}


def known(build):
    shown = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], check=True, capture_output=True, text=True)
    return {test["name"]: test for test in json.loads(shown.stdout)["tests"]}


def properties(test):
    return {entry["name"]: entry["value"] for entry in test.get("properties", [])}


def matching(names, pattern):
    try:
        return [name for name in names if re.fullmatch(pattern, name)]
    except re.error:
        return []


def with_set_up(tests, chosen):
    """The chosen tests and those that set up what they need: ctest runs these, too."""
    needed = set(chosen)
    fixtures = {fixture for name in chosen for fixture in properties(tests[name]).get("FIXTURES_REQUIRED", [])}
    needed |= {name for name, test in tests.items() if fixtures & set(properties(test).get("FIXTURES_SETUP", []))}
    return needed


def paths(build, names):
    """Every path that the command or the environment of one of these tests names: as ctest's own files say it, for of a
    program that is not built yet it shows nothing."""
    found = set()
    for file in pathlib.Path(build).rglob("CTestTestfile.cmake"):
        for line in file.read_text(encoding="utf-8").splitlines():
            name = re.match(r"(?:add_test|set_tests_properties)\((?:\[=\[)?([\w.-]+)", line)
            if name and name[1] in names:
                quoted = [part for text in re.findall(r'"([^"]*)"', line) for part in re.split("[:;=]", text)]
                words = re.findall(r"/[^\s:;=\"]+", line)
                found |= {os.path.normpath(path) for path in quoted + words if path.startswith("/")}
    return found


def near(word, known):
    """What a misspelt word may have meant: the nearest, then those that hold it."""
    found = difflib.get_close_matches(word, known, n=3, cutoff=0.4)
    return found + [name for name in known if word in name and name not in found][:3]


def select(build, parts, wanted):
    tests = known(build)
    chosen = set()
    for pattern in wanted:
        found = matching(tests, pattern)
        if not found:
            for names, reason in left_out(os.path.join(build, "left_out.txt")):
                if fnmatch.fnmatchcase(pattern, names):
                    print(f"test: '{pattern}' is left out: {reason}; scripts/setup installs what the tests need", file=sys.stderr)
                    return 1
            found = [f"the part {name}" for name in near(pattern, parts)] + near(pattern, tests)
            print(f"test: no part and no test '{pattern}'" + (f"; near it: {', '.join(found)}" if found else "") +
                  f"; parts: {', '.join(parts)}; all tests: ctest --preset release -N", file=sys.stderr)
            return 2
        chosen.update(found)
    print(f"^({'|'.join(sorted(map(re.escape, chosen)))})$")
    print_programs(build, tests, chosen)
    return 0


def executables(build):
    listed = subprocess.run(["ninja", "-C", build, "-t", "targets", "all"], check=True, capture_output=True, text=True).stdout
    return {os.path.normpath(os.path.join(os.path.abspath(build), line.split(":")[0]))
            for line in listed.splitlines() if "EXECUTABLE_LINKER" in line}


def programs_of(build, tests, chosen):
    """The programs of this build that the chosen tests run, as targets."""
    used = executables(build) & paths(build, with_set_up(tests, chosen))
    return sorted(os.path.relpath(path, os.path.abspath(build)) for path in used)


def print_programs(build, tests, chosen):
    for target in programs_of(build, tests, chosen):
        print(target)


def those(tests, labels, names):
    return {name for name, test in tests.items() if re.search(names, name) and
            not any(re.search(labels, label) for label in properties(test).get("LABELS", []))}


def programs(build, labels, names):
    tests = known(build)
    print_programs(build, tests, those(tests, labels, names))
    return 0


def inputs(build, target):
    """What ninja makes before `target`, which only stands for it."""
    shown = subprocess.run(["ninja", "-C", build, "-t", "query", target], check=True, capture_output=True, text=True).stdout
    between = shown.partition("input:")[2].partition("outputs:")[0]
    return [line.strip().lstrip("| ") for line in between.splitlines()[1:] if line.strip()]


def everything(build, target="all"):
    """The targets that `all` stands for: each folder has an `all` of its own."""
    return [one for name in inputs(build, target)
            for one in (everything(build, name) if name.endswith("/all") else [name])]


def all_without(build, labels, names):
    tests = known(build)
    left = those(tests, labels, names)
    theirs = set(programs_of(build, tests, left)) - set(programs_of(build, tests, set(tests) - left))
    gone = {pathlib.PurePath(program).name for program in theirs}
    print(f"^({'|'.join(sorted(map(re.escape, left)))})$")
    for target in everything(build):
        if pathlib.PurePath(target).name not in gone:
            print(target)
    return 0


def skipped_in(case):
    """How many of a test's own cases were skipped, by what unittest says of them at the end."""
    return sum(map(int, re.findall(r"^(?:OK|FAILED) \(.*?skipped=(\d+)", case.findtext("system-out") or "", re.MULTILINE)))


def left_out(path):
    """What tests/CMakeLists.txt has not registered: [(names, with * for any characters, the reason)]."""
    if not os.path.exists(path):
        return []
    return [tuple(line.split("\t", 1)) for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines()]


def report(files, left_out_files=()):
    cases = [case for path in files if os.path.exists(path)
             for case in xml.etree.ElementTree.parse(path).getroot().iter("testcase")]
    by = {}
    for case in cases:
        by.setdefault(case.get("status"), []).append(case)
    failed = by.get("fail", [])
    skipped = [case for status in ("notrun", "disabled") for case in by.get(status, [])]
    within = [case for case in by.get("run", []) + failed if skipped_in(case)]
    slowest = sorted(cases, key=lambda case: -float(case.get("time")))[:10]
    print(f"tests: {len(by.get('run', []))} passed, {len(failed)} failed, {len(skipped)} skipped")
    for title, some in (("failed", failed), ("skipped", skipped)):
        for case in some:
            print(f"  {title}: {case.get('name')}")
    for case in within:
        print(f"  skipped: {skipped_in(case)} cases of {case.get('name')}")
    missing = sorted({entry for path in left_out_files for entry in left_out(path)})
    for names, reason in missing:
        print(f"  left out: {names}: {reason}")
    print("slowest: " + ", ".join(f"{case.get('name')} {float(case.get('time')):.0f} s" for case in slowest))
    unwanted = [case.get("name") for case in skipped + within if case.get("name") not in MAY_SKIP]
    if unwanted:
        print(f"FAILED: skipped, though all that they need is installed: {', '.join(unwanted)}; their output says why")
    if missing:
        print("FAILED: tests are left out because a program is missing; scripts/setup installs it, then configure again")
    return 1 if unwanted or missing else 0


def main(arguments):
    if len(arguments) >= 4 and arguments[0] == "select":
        return select(arguments[1], arguments[2].split(), arguments[3:])
    if len(arguments) == 4 and arguments[0] == "programs":
        return programs(*arguments[1:])
    if len(arguments) == 4 and arguments[0] == "without":
        return all_without(*arguments[1:])
    if arguments and arguments[0] == "report":
        files, without = arguments[1:], []
        while len(files) > 2 and files[0] == "--left-out":
            without.append(files[1])
            files = files[2:]
        return report(files, without)
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
