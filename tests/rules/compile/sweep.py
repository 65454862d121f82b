#!/usr/bin/env python3
"""Compiles what must compile, and what must not: sweep.py PART --build DIR [--warnings FLAGS] [--jobs N].

    host      all headers of include/ocm together with GCC and with Clang; and each alone with Clang, but for those that `board`
              compiles alone: a header that brings what it uses for one compiler does for the other
    board     what runs on a board, firmware/boards and firmware/drivers with it, without exceptions and RTTI: each header
              alone for Cortex-M0, and all together for Cortex-M0, M3, M4 and with the host's GCC and Clang
              (Alone, but for the standard library, of which most is at hand, parsed once: that takes most of the time. That a header
              includes what it uses of it is a rule of tests/rules/architecture, which knows what each name needs.)
    closure   each generated header in a tree that holds nothing but the floors below it
    vectors   vectors.cpp (the wire as static_asserts) with all five; boards.cpp and parts.cpp as object code for the three
              Cortex-M, in which no symbol of a heap, of exceptions, RTTI or streams may be missing
    refused   the files of refused/ with GCC and with Clang: together they must compile, each in a namespace of its own, and each with
              -DOCM_MUST_FAIL must not, with the phrase of its `// expect:` line (`// expect g++:`, `// expect clang++:` where
              they differ)

Headers and floors come from the tree and from the table in docs/architecture.md. The commands are handed to ninja, which
repeats only those whose files have changed. Exit 77 (skipped, for ctest) when a compiler is not installed."""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path.insert(0, str(ROOT / "tests/rules/architecture"))
import house
import standard

GCC, CLANG, ARM = "g++", "clang++-14", "arm-none-eabi-g++"
STANDARD = "-std=c++20"
BARE = "-fno-exceptions -fno-rtti"
BOARD = f"-mthumb -ffreestanding -fno-threadsafe-statics {BARE}"
CORES = {
    "m0": f"{ARM} -mcpu=cortex-m0 {BOARD}",
    "m3": f"{ARM} -mcpu=cortex-m3 {BOARD}",
    "m4": f"{ARM} -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16 {BOARD}",
}
# What must not be called on a board: heap, exceptions, RTTI, streams.
FORBIDDEN = re.compile(r"_Zn[wa]|_Zd[la]|^(?:malloc|calloc|realloc|free|abort|_sbrk)$|__cxa_(?!pure)|_Unwind|__dynamic_cast|_ZTI|"
                       r"_ZSt\d+__throw|__gxx_personality|_ZNSo|^printf$|_impure_ptr")


class Ninja:
    """A build.ninja and the files that it compiles."""

    def __init__(self, folder, warnings, roots=(ROOT / "include", ROOT)):
        self.folder = folder
        self.roots = roots
        self.warnings = warnings
        self.lines = ["ninja_required_version = 1.8", "rule run", "  command = $command", "  description = $out",
                      "  depfile = $out.d", "  deps = gcc"]
        self.outputs = []
        folder.mkdir(parents=True, exist_ok=True)

    def source(self, name, text):
        """A file to compile, written only when it differs."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file() or path.read_text() != text:
            path.write_text(text)
        return path

    def add(self, output, source, command, implicit=()):
        """A command that makes `output`, with the names of what it reads in `output`.d."""
        self.outputs.append(output)
        (self.folder / output).parent.mkdir(parents=True, exist_ok=True)
        escaped = command.replace("$", "$$")
        self.lines += [f"build {output}: run {source} | {HERE / 'sweep.py'} {' '.join(map(str, implicit))}",
                       f"  command = {escaped}"]

    def syntax(self, output, source, compiler, include=None, flags="", implicit=()):
        include = include or " ".join(f"-I{root}" for root in self.roots)
        self.add(output, source, f"{compiler} {STANDARD} {include} {self.warnings} -Werror {flags} -fsyntax-only -MD "
                                 f"-MF {output}.d -MT {output} {source} && touch {output}", implicit)

    def path(self, header):
        """The file that is included by this name."""
        return next(path for path in (root / header for root in self.roots) if path.is_file())

    def alone(self, name, compiler, headers):
        """Each header by itself, after what all of them use of the standard library, which is parsed once."""
        used = {what for header in headers for _, quoted, what in house.includes(self.path(header).read_text()) if not quoted}
        at_hand = self.source("standard.hpp", "".join(f"#include <{header}>\n" for header in sorted(used & set(standard.HEADERS))))
        parsed = at_hand.name + (".pch" if compiler == CLANG else ".gch")
        self.add(parsed, at_hand, f"{compiler} {STANDARD} {self.warnings} -x c++-header -MD -MF {parsed}.d -MT {parsed} "
                                  f"-o {parsed} {at_hand}")
        flags = f"-include-pch {parsed}" if compiler == CLANG else f"-Winvalid-pch -include {at_hand.name}"
        for header in headers:
            # Twice: it must guard itself, too.
            source = self.source(f"alone/{header.replace('/', '_')}.cpp", f'#include "{header}"\n#include "{header}"\n')
            self.syntax(f"{name}/{header}", source, compiler, flags=flags, implicit=[parsed])

    def run(self, jobs):
        (self.folder / "build.ninja").write_text("\n".join(self.lines) + "\n")
        return subprocess.run(["nice", "-n", "10", "ninja", "-C", str(self.folder), "--quiet", "-k", "0", "-j", str(jobs)]).returncode


def library(floors=None):
    """The headers of the library as they are included; of these floors only."""
    for path in sorted((ROOT / "include/ocm").rglob("*.hpp")):
        name = path.relative_to(ROOT / "include").as_posix()
        if floors is None or house.floor_of(house.read_floors(ROOT), name.removeprefix("ocm/")) in floors:
            yield name


def on_board():
    return {floor.name for floor in house.read_floors(ROOT).values() if floor.board}


def host(ninja):
    ninja.alone(CLANG, CLANG, sorted(set(library()) - set(library(on_board()))))
    together = ninja.source("together.cpp", "".join(f'#include "{header}"\n' for header in library()))
    for compiler in (GCC, CLANG):
        ninja.syntax(f"{compiler}/together", together, compiler)


def board(ninja):
    boards = [path.relative_to(ROOT).as_posix() for folder in ("firmware/boards", "firmware/drivers")
              for path in sorted((ROOT / folder).rglob("*.hpp"))]
    headers = list(library(on_board())) + boards
    ninja.alone("m0", CORES["m0"], headers)
    # Whether a header brings what it uses does not depend on the core: one file for the other compilers.
    together = ninja.source("together.cpp", "".join(f'#include "{header}"\n' for header in headers))
    for name, compiler in {GCC: f"{GCC} {BARE}", CLANG: f"{CLANG} {BARE}", **CORES}.items():
        ninja.syntax(f"{name}/together", together, compiler)


def closure(ninja):
    """A generated header needs the floors that the table allows it, and nothing else of the project."""
    floors = house.read_floors(ROOT)
    below = ninja.folder / "below/ocm"
    shutil.rmtree(below, ignore_errors=True)
    below.mkdir(parents=True)
    for floor in floors["topics"].reach - {"topics"}:
        (below / floor).symlink_to(ROOT / "include/ocm" / floor)
    generated = [path for folder in ("include/ocm/topics", "tests/generator/golden") for path in sorted((ROOT / folder).glob("*.hpp"))]
    for path in generated:
        source = ninja.source(f"closure/{path.stem}.cpp", f'#include "{path}"\n#include "{path}"\n')
        for name, compiler in ((GCC, GCC), (CLANG, CLANG), ("m0", CORES["m0"])):
            ninja.syntax(f"{name}/{path.stem}", source, compiler, include=f"-I{below.parent}")


def vectors(ninja):
    for name, compiler in ((GCC, f"{GCC} {BARE}"), (CLANG, f"{CLANG} {BARE}"), *CORES.items()):
        ninja.syntax(f"{name}/vectors", HERE / "vectors.cpp", compiler)
    for name, compiler in CORES.items():
        for unit in ("boards", "parts"):
            output, source = f"{name}/{unit}.o", HERE / f"{unit}.cpp"
            ninja.add(output, source,
                      f"{compiler} {STANDARD} -Os -I{ROOT / 'include'} -I{ROOT} {ninja.warnings} -Werror -c -MD -MF {output}.d "
                      f"-MT {output} {source} -o {output} && {sys.executable} -B {HERE / 'sweep.py'} symbols --object {output}")


def refused(ninja):
    files = sorted((HERE / "refused").glob("*.cpp"))
    # All that they include is parsed once a compiler; what is refused is in the files themselves.
    includes = {line for path in files for line in re.findall(r"^#include .+$", path.read_text(), re.MULTILINE)}
    common = ninja.source("common.hpp", "\n".join(sorted(includes)) + "\n")
    without = ninja.source("without.cpp", "".join(f'namespace {path.stem} {{\n#include "{path}"\n}}\n' for path in files))
    for compiler, precompiled, use in ((GCC, "common.hpp.gch", f"-include {common}"),
                                       (CLANG, "common.pch", f"-include-pch {ninja.folder / 'common.pch'}")):
        ninja.add(precompiled, common, f"{compiler} {STANDARD} -I{ROOT / 'include'} -I{ROOT} {ninja.warnings} -Werror -x c++-header "
                                       f"-MD -MF {precompiled}.d -MT {precompiled} {common} -o {precompiled}")
        ninja.syntax(f"{compiler}/without", without, compiler, flags=use, implicit=[precompiled])
        for path in files:
            output = f"{compiler}/{path.stem}"
            ninja.add(output, path, f"{sys.executable} -B {HERE / 'sweep.py'} refuse --file {path} --compiler {compiler} "
                                    f"'--warnings={ninja.warnings}' '--common={use}' --output {output}", [precompiled])


# --- steps that ninja calls ----------------------------------------------------------------------------------

def symbols(arguments):
    """No undefined symbol of the object is one that a board cannot have."""
    listed = subprocess.run(["arm-none-eabi-nm", "--undefined-only", arguments.object], capture_output=True, text=True,
                            check=True)
    needed = [line.split()[-1] for line in listed.stdout.splitlines()]
    bad = [name for name in needed if FORBIDDEN.search(name)]
    for name in bad:
        print(f"{arguments.object}: needs {name}: a board has no heap, exceptions, RTTI or streams")
    return 1 if bad else 0


def phrase(path, compiler):
    """What the compiler must say, from the head of the file."""
    kind = "clang++" if compiler.startswith("clang++") else "g++"
    found = {who.strip(): text for who, text in re.findall(r"^// expect( [\w+]+)?: (.+)$", path.read_text(), re.MULTILINE)}
    return found.get(kind) or found.get("")


def judge(path, expected, code, said):
    """What is wrong with how a compiler ended when it must refuse, or None."""
    if not expected:
        return f"{path}:1: no '// expect: ' line that says what the compiler must complain about"
    if "OCM_MUST_FAIL" not in path.read_text():
        return f"{path}:1: no #ifdef OCM_MUST_FAIL: nothing of it is refused"
    if code == 0:
        return f"{path}:1: with OCM_MUST_FAIL it must not compile, and it does"
    if expected not in said:
        return f"{path}:1: it is refused, but without the words '{expected}':\n{said}"
    return None


def refuse(arguments):
    path = pathlib.Path(arguments.file)
    done = subprocess.run([arguments.compiler, STANDARD, f"-I{ROOT / 'include'}", f"-I{ROOT}", *arguments.warnings.split(), "-Werror",
                           *arguments.common.split(), "-DOCM_MUST_FAIL", "-fsyntax-only", str(path)], capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
    wrong = judge(path, phrase(path, arguments.compiler), done.returncode, done.stderr)
    if wrong:
        print(f"{arguments.compiler}: {wrong}")
        return 1
    pathlib.Path(arguments.output).touch()
    return 0


PARTS = {part.__name__: part for part in (host, board, closure, vectors, refused)}
NEEDS = {"host": (GCC, CLANG), "board": (GCC, CLANG, ARM), "closure": (GCC, CLANG, ARM), "vectors": (GCC, CLANG, ARM),
         "refused": (GCC, CLANG)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", choices=[*PARTS, "symbols", "refuse"])
    parser.add_argument("--build", type=pathlib.Path, help="folder for what is made; kept between runs")
    parser.add_argument("--warnings", default="-Wall -Wextra")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    for step in ("--object", "--file", "--compiler", "--output", "--common"):
        parser.add_argument(step, default="", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.part == "symbols":
        return symbols(arguments)
    if arguments.part == "refuse":
        return refuse(arguments)
    if arguments.build is None:
        parser.error("--build DIR is missing")
    missing = [tool for tool in (*NEEDS[arguments.part], "ninja") if shutil.which(tool) is None]
    if missing:
        print(f"skipped: not installed: {', '.join(missing)}")
        return 77
    # What the project's own targets turn off (-Wno-...) for the sake of one compiler, a header does not need.
    warnings = " ".join(flag for flag in arguments.warnings.split() if not flag.startswith("-Wno-"))
    ninja = Ninja(arguments.build.resolve() / arguments.part, warnings)
    PARTS[arguments.part](ninja)
    if not ninja.outputs:
        print(f"{arguments.part}: nothing to compile: the tree is not where it is looked for")
        return 1
    failed = ninja.run(arguments.jobs)
    print(f"{arguments.part}: {len(ninja.outputs)} compilations, {'some failed' if failed else 'all as they must be'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
