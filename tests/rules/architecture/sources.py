"""Rules of sources: what includes what, what a board can have, which header has its test, what a test waits for."""
import html
import pathlib
import re

import house
import standard
from tree import SOURCE

LAYERS = ("controller", "reflective", "cognitive")

BANNED_HEADERS = set("""any condition_variable deque exception filesystem format forward_list fstream functional future
    iomanip ios iosfwd iostream istream list locale map memory memory_resource mutex ostream queue random regex set
    shared_mutex sstream stack stdexcept string strstream syncstream thread typeindex typeinfo unordered_map
    unordered_set vector cstdio stdio.h ctime time.h clocale locale.h cstdlib stdlib.h""".split())

BANNED_WORDS = {
    r"\bthrow\b": "throw: return a base::Result",
    r"\btry\b": "try: there are no exceptions on a board",
    r"\bcatch\b": "catch: there are no exceptions on a board",
    r"\bdynamic_cast\b": "dynamic_cast: there is no RTTI on a board",
    r"\btypeid\b": "typeid: there is no RTTI on a board",
    r"\bnew\b(?!\s*\()": "new: there is no heap on a board (placement new is allowed)",
    r"(?<!=)(?<!= )\bdelete\b": "delete: there is no heap on a board",
    r"\b(?:malloc|calloc|realloc|free)\s*\(": "malloc and free: there is no heap on a board",
    r"\bstd::(?:string|vector|function|map|set|list|deque|shared_ptr|unique_ptr)\b": "a type that uses the heap",
    r"\b(?:steady|system|high_resolution)_clock\b": "a clock: time is handed in",
    r"\bassert\s*\(": "assert: return a base::Result, or prove it with static_assert",
}

# Written so that no pattern is found in this file itself.
MACHINE_PATHS = re.compile(r"(?<![\w.$}/-])/(?:wor[k]|roo[t])(?=[/\s`'\")\]]|$)|/hom[e]/\w|/tm[p]/(?:build|bash_jobs)"
                           r"|/User[s]/\w")

INTERNAL_NAMES = re.compile(r"\bfar[m]-\w|\bshare[d]/(?:facts|tools|theses|hooks)|\bissue[s] (?:show|close)\b")

# Headers that take seconds to compile, and the files that may.
COSTLY = {
    "CLI/": ("cli/shared/arguments.cpp",),
    "toml++/": ("cli/shared/config_file.cpp",),
    "nlohmann/": ("generator/text/json.cpp", "generator/spec/json.cpp", "generator/spec/schema.cpp"),
    "valijson/": ("generator/spec/schema.cpp",),
}

# A sleep, and the number where it is one. What is at most a tenth of a second is between two looks at a condition.
SLEEP = re.compile(r"\btime\.sleep\((?P<seconds>[\d.]+\))?|\bthis_thread::sleep_(?:for|until)\((?:\w+ \+= )?(?P<ms>\d+ms\))?")

SLEEPS_HERE = re.compile(r"(?m)^(?:#|//) Sleeps: \w")

# Folders around the library, and what each reaches in no way.
APART = {
    "firmware/": ("cli/", "generator/", "sim/"),
    "generator/": ("cli/", "firmware/", "sim/"),
    "sim/": ("cli/",),
    "sim/amiro/": ("sim/mapper/",),
    "sim/mapper/": ("sim/amiro/",),
}


# --- the library ---------------------------------------------------------------------------------------------

def floors_have_rows(tree):
    """Every folder of include/ocm with headers is a row of the table, and every row a folder."""
    seen = set()
    for name, floor in tree.headers():
        if floor not in tree.floors:
            yield f"{name}:1: floor '{floor}' has no row in docs/architecture.md; give it one"
        seen.add(floor)
    for floor in tree.floors:
        if floor not in seen:
            yield f"docs/architecture.md:1: floor '{floor}' has a row, but no header in include/ocm/{floor}/"


def house_is_drawn(tree):
    """docs/images/house.svg shows the floors of the table, and the arrows between them."""
    picture = "docs/images/house.svg"
    if picture not in tree.known:
        return
    drawn = {html.unescape(match[1]) for _, match in tree.find(picture, r"<title>([^<]*)</title>")} - {"house"}
    wanted = set(tree.floors) | {f"{below}->{floor.name}" for floor in tree.floors.values() for below in house.direct(tree.floors, floor)}
    for what in sorted(drawn ^ wanted):
        yield f"{picture}:1: {'lacks' if what in wanted else 'still has'} {what}; draw it: scripts/pictures house"


def includes_go_down(tree):
    """Includes of the library are full paths to what the table allows."""
    for name, floor in tree.headers():
        for line, quoted, what in tree.includes(name):
            if not quoted:
                if what.startswith("ocm/"):
                    yield f'{name}:{line}: <{what}>: the library includes itself with quotes: "{what}"'
                continue
            target = tree.floor("include/" + what)
            if not target or "include/" + what not in tree.known:
                yield f'{name}:{line}: "{what}" is not the full path of a header, such as "ocm/base/result.hpp"'
            elif floor in tree.floors and target not in tree.floors[floor].reach:
                allowed = ", ".join(sorted(tree.floors[floor].reach))
                yield f'{name}:{line}: "{what}": floor \'{floor}\' may include {allowed}; not \'{target}\''


def layers_are_apart(tree):
    """Controller, Reflective and Cognitive Operator never reach each other, by whatever way."""
    for name, floor in tree.headers():
        if floor not in LAYERS:
            continue
        for reached, way in closure(tree, name).items():
            other = tree.floor(reached)
            if other in LAYERS and other != floor:
                yield f"{name}:1: OCM layer '{floor}' reaches layer '{other}': {' -> '.join(way)}"


def library_knows_no_tool(tree):
    """No sentence of the library names amiroctl or an option: other programs use it too."""
    token = r'//[^\n]*|/\*[\s\S]*?\*/|"(?:\\.|[^"\\\n])*"'
    for name, _ in tree.headers():
        for line, match in tree.find(name, token):
            found = re.search(r"amiroctl|(?<![\w-])--[a-z]", match.group(0))
            if match.group(0).startswith('"') and found:
                yield f"{name}:{line}: '{found.group(0)}': the library says a cause and facts; cli/ says what to do"


def mapper_knows_no_can(tree):
    """The mapper has no CAN bus: nothing of it reaches a header of CAN or of its protocol."""
    for name in tree.below("include/ocm/mapper/", ends=(".hpp", ".h")):
        for reached, way in closure(tree, name).items():
            if reached.startswith(("include/ocm/can/", "include/ocm/protocol/")):
                yield f"{name}:1: the mapper reaches CAN: {' -> '.join(way)}"


def closure(tree, start):
    """Every file of the project that `start` includes, with the way to it."""
    ways = {}
    todo = [(start, (start,))]
    while todo:
        name, way = todo.pop()
        for _, _, what in tree.includes(name):
            target = tree.resolve(what)
            if target and target not in ways and target != start:
                ways[target] = way + (target,)
                todo.append((target, ways[target]))
    return ways


def no_circles(tree):
    """No header reaches itself."""
    state = {}

    def visit(name, way):
        state[name] = "open"
        for _, _, what in tree.includes(name):
            target = tree.resolve(what)
            if target is None:
                continue
            if state.get(target) == "open":
                circle = way[way.index(target):] + [target]
                yield f"{name}:1: a circle of includes: {' -> '.join(circle)}"
            elif target not in state:
                yield from visit(target, way + [target])
        state[name] = "done"

    for name in tree.below("include/", "cli/", "firmware/", "generator/", "sim/"):
        if name not in state:
            yield from visit(name, [name])


def namespace_is_folder(tree):
    """ocm::<floor> in include/ocm/<floor>; the robot's own, which is the file's name, in a generated header."""
    for name, floor in tree.headers():
        if name.endswith(".h"):
            continue  # in C
        expected = pathlib.PurePosixPath(name).stem if floor == "topics" else "ocm::" + floor.replace("/", "::")
        opened = list(tree.find(name, r"(?m)^(?:inline )?namespace\s+([\w:]+)\s*\{",
                                house.without_comments(tree.text(name))))
        if not opened:
            yield f"{name}:1: no namespace: expected {expected}"
            continue
        if not any((match.group(1) + "::").startswith(expected + "::") for _, match in opened):
            yield f"{name}:1: its namespace is {opened[0][1].group(1)}: expected {expected}"
            continue
        for line, match in opened:
            allowed = match.group(1) == expected or match.group(1).startswith(expected + "::")
            # Inside a generated header, names like `detail` are opened within the robot's namespace.
            if not allowed and (match.group(1).startswith("ocm") or match.group(1) == "std"):
                yield f"{name}:{line}: namespace {match.group(1)}: expected {expected}"


def board_headers(tree):
    """What runs on a board: the floors of which the table says so, and the boards themselves."""
    for name, floor in tree.headers():
        if floor in tree.floors and tree.floors[floor].board:
            yield name
    yield from tree.below("firmware/boards/", "firmware/drivers/")


def no_banned_headers(tree):
    """No standard header on a board that brings a heap, exceptions, streams, threads or a clock."""
    for name in board_headers(tree):
        for line, quoted, what in tree.includes(name):
            if not quoted and (what in BANNED_HEADERS or re.match(r"(?:linux|sys|net|netinet)/|unistd\.h|poll\.h", what)):
                yield f"{name}:{line}: <{what}> is not for boards: no heap, exceptions, streams, threads, clocks"


def no_banned_words(tree):
    """No exceptions, RTTI, heap or clock on a board."""
    for name in board_headers(tree):
        code = house.without_comments(tree.text(name))
        code = re.sub(r"(?m)^[ \t]*#.*$", "", code)  # <new> is a header, not an allocation
        for pattern, why in BANNED_WORDS.items():
            for line, _ in tree.find(name, pattern, code):
                yield f"{name}:{line}: {why}"


def standard_headers_are_included(tree):
    """What a header uses of std comes by its own includes, or by those of the project's headers that it includes: it can be
    included first (tests/rules/compile compiles each alone, with all of std at hand)."""
    for name in dict.fromkeys([name for name, _ in tree.headers()] + list(board_headers(tree))):
        brought = {what for reached in (name, *closure(tree, name)) for _, quoted, what in tree.includes(reached) if not quoted}
        missing = {}
        for line, match in tree.find(name, standard.USE, house.without_comments(tree.text(name))):
            by = standard.BROUGHT_BY.get(match.group(1), ())
            if not brought.intersection(by):
                missing.setdefault(match.group(1), (line, by))
        for what, (line, by) in missing.items():
            yield (f"{name}:{line}: std::{what} needs <{sorted(by)[0]}>, which nothing here includes" if by else
                   f"{name}:{line}: std::{what} is not known: give it a line in tests/rules/architecture/standard.py")


def headers_open_with_a_comment(tree):
    """The first line of a header says what it is."""
    for name in tree.below("include/", "cli/", "firmware/", "generator/", "sim/", ends=(".hpp", ".h")):
        first = tree.text(name).split("\n", 1)[0]
        if not re.match(r"///? ?\S.{15,}", first):
            yield f"{name}:1: a header opens with a comment that says what it is"


def headers_have_tests(tree):
    """tests/unit mirrors include/ocm, both ways; codec_sweep.cpp is a further test of codec.hpp."""
    tested = {name[len("include/ocm/"):].rsplit(".", 1)[0] for name, _ in tree.headers()}
    for name, _ in tree.headers():
        test = "tests/unit/" + name[len("include/ocm/"):].rsplit(".", 1)[0] + ".cpp"
        if test not in tree.known:
            yield f"{name}:1: it has no test: {test} is missing"
    for name in tree.below("tests/unit/", ends=(".cpp",)):
        stem = name[len("tests/unit/"):-len(".cpp")]
        if stem not in tested and not any(stem.startswith(header + "_") for header in tested):
            yield f"{name}:1: it tests no header: include/ocm/{stem}.hpp is missing"


def tests_have_their_namespace(tree):
    """Several files of tests/unit are compiled at once, so each has a namespace of its own, named for its path."""
    for name in tree.below("tests/unit/", ends=(".cpp",)):
        wanted = name[len("tests/unit/"):-len(".cpp")].replace("/", "_") + "_test"
        spaces = list(tree.find(name, r"(?m)^namespace ?(\w*) \{"))
        for line, match in spaces:
            if match.group(1) != wanted:
                yield f"{name}:{line}: what it declares belongs into namespace {wanted}"
        if not spaces and "TEST_CASE" in tree.text(name):
            yield f"{name}:1: what it declares belongs into namespace {wanted}"


# --- around the library --------------------------------------------------------------------------------------

def own_includes_are_full_paths(tree):
    """The tool and the firmware include their own files from the repository's root."""
    for name in tree.below("cli/", "firmware/", "generator/", "sim/"):
        for line, quoted, what in tree.includes(name):
            if quoted and tree.resolve(what) is None:
                yield f'{name}:{line}: "{what}" is not a full path, such as "cli/shared/session.hpp" or "ocm/base/time.hpp"'


def generator_is_independent(tree):
    """The generator reaches no generated header."""
    for name in tree.below("generator/"):
        for reached, way in closure(tree, name).items():
            if tree.text(reached).startswith("// Made by ocm-generate"):
                yield f"{name}:1: the generator reaches what it generates: {' -> '.join(way)}"


def firmware_is_for_boards(tree):
    """Firmware reaches what runs on a board only; boards and drivers, which run on any hardware, no system either."""
    for name in tree.below("firmware/"):
        own = name.startswith(("firmware/boards/", "firmware/drivers/"))
        for reached, way in closure(tree, name).items():
            floor = tree.floor(reached)
            if floor in tree.floors and not tree.floors[floor].board:
                yield f"{name}:1: firmware reaches what runs on the host only: {' -> '.join(way)}"
            elif own and not reached.startswith(("include/ocm/", "firmware/boards/", "firmware/drivers/")):
                yield f"{name}:1: a board reaches what is not on every hardware: {' -> '.join(way)}"


def rooms_are_apart(tree):
    """Neither simulators nor firmware know the tool; firmware knows no simulator, and no simulated robot another."""
    for room, others in APART.items():
        for name in tree.below(room):
            for reached, way in closure(tree, name).items():
                if reached.startswith(others):
                    yield f"{name}:1: {room} reaches {reached.rsplit('/', 1)[0]}/: {' -> '.join(way)}"


def folders_make_no_circle(tree):
    """The folders of firmware, generator and simulators include each other in one direction only."""
    graph = {}  # folder -> {folder: an include that leads there}
    for name in tree.below("firmware/", "generator/", "sim/"):
        folder = name.rsplit("/", 1)[0]
        for line, _, what in tree.includes(name):
            target = tree.resolve(what)
            if target and not target.startswith("include/") and target.rsplit("/", 1)[0] != folder:
                graph.setdefault(folder, {}).setdefault(target.rsplit("/", 1)[0], f"{name}:{line}")
    done = set()

    def visit(folder, way):
        for other, where in sorted(graph.get(folder, {}).items()):
            if other in way:
                yield f"{where}: a circle of folders: {' -> '.join(way[way.index(other):] + [other])}"
            elif other not in done:
                yield from visit(other, way + [other])
        done.add(folder)

    for folder in sorted(graph):
        if folder not in done:
            yield from visit(folder, [folder])


def rooms(tree):
    """(file, room, line, what it includes, that one's room) of the tool; main.cpp is in the room ''."""
    for name in tree.below("cli/"):
        parts = name.split("/")
        room = parts[1] if len(parts) > 2 else ""
        for line, quoted, what in tree.includes(name):
            if quoted and what.startswith("cli/"):
                yield name, room, line, what, what.split("/")[1]


def verbs_are_seen_by_main_only(tree):
    """Nothing stands on a verb: what two verbs share is in a room behind them."""
    for name, room, line, what, other in rooms(tree):
        if other == "verbs" and room not in ("", "verbs"):
            yield f'{name}:{line}: "{what}": only main.cpp and verbs/ see verbs; what is shared goes to a room behind them'
    for name in tree.below("sim/", "generator/", "firmware/"):
        for line, _, what in tree.includes(name):
            if what.startswith("cli/verbs/"):
                yield f'{name}:{line}: "{what}": only main.cpp and verbs/ see verbs'


def no_circles_of_rooms(tree):
    """The rooms of cli/ include each other in one direction."""
    ways = {}
    for name, room, line, what, other in rooms(tree):
        if room and room != other:
            ways.setdefault(room, {}).setdefault(other, f'{name}:{line}: "{what}"')

    def visit(room, way):
        for other, where in sorted(ways.get(room, {}).items()):
            if other in way:
                yield f"{where}: a circle of rooms: {' -> '.join(way[way.index(other):] + [other])}"
            else:
                yield from visit(other, way + [other])

    for room in sorted(ways):
        # Each circle once, from the first of its rooms.
        for found in visit(room, [room]):
            if found.endswith(f"-> {room}") and min(found.split(": ")[-1].split(" -> ")) == room:
                yield found


def costly_headers_are_seen_by_few(tree):
    """What takes seconds to compile is behind a layer of ours."""
    for name in tree.below("cli/", "generator/", "sim/", "include/"):
        for line, quoted, what in tree.includes(name):
            few = next((files for start, files in COSTLY.items() if what.startswith(start)), None)
            if not quoted and few is not None and name not in few:
                yield f"{name}:{line}: <{what}> takes seconds to compile; only {', '.join(few)} includes it"


def generated_files_are_reproducible(tree):
    """No date, no time in what is generated: the same spec gives the same file."""
    for name in tree.below("include/", "tests/generator/golden/"):
        if "Made by ocm-generate" not in tree.text(name)[:300]:
            continue
        for line, match in tree.find(name, r"\b(?:19|20)\d\d-\d\d-\d\d\b|\b\d\d:\d\d:\d\d\b|__DATE__|__TIME__"):
            yield f"{name}:{line}: generated, with a date or time: {match.group(0)}"


def no_machine_paths(tree):
    """No path of one machine, and no name of tools that are not of the project."""
    for name in tree.files:
        for line, match in tree.find(name, MACHINE_PATHS):
            yield f"{name}:{line}: a path of one machine: {match.group(0).strip()}"
        for line, match in tree.find(name, INTERNAL_NAMES):
            yield f"{name}:{line}: a name that is not of the project: {match.group(0)}"


# --- tests ---------------------------------------------------------------------------------------------------

def sleeps_say_why(tree):
    """A sleep of more than 0.1 s in a test has its reason behind it, or the file has: '# Sleeps: ...'."""
    for name in tree.below("tests/", ends=SOURCE + (".py",)):
        if SLEEPS_HERE.search(tree.text(name)) or name.startswith("tests/rules/architecture/"):  # this rule
            continue
        lines = tree.text(name).splitlines()
        for line, match in tree.find(name, SLEEP):
            seconds = float((match["seconds"] or "9)")[:-1]) if match["ms"] is None else int(match["ms"][:-3]) / 1000
            if seconds > 0.1 and not re.search(r"sleep.*(?:#|//) \w", lines[line - 1]):
                yield f"{name}:{line}: a sleep: wait for an event (tests/waiting.py), or say behind it why the time itself is under test"


RULES = (floors_have_rows, house_is_drawn, includes_go_down, layers_are_apart, library_knows_no_tool, mapper_knows_no_can, no_circles,
         namespace_is_folder, no_banned_headers, no_banned_words, standard_headers_are_included, headers_open_with_a_comment,
         headers_have_tests, tests_have_their_namespace, own_includes_are_full_paths, generator_is_independent, firmware_is_for_boards,
         rooms_are_apart, folders_make_no_circle, verbs_are_seen_by_main_only, no_circles_of_rooms, costly_headers_are_seen_by_few,
         generated_files_are_reproducible, no_machine_paths, sleeps_say_why)
