"""Whole files that ocm-generate writes, of specs that use all that it reads: golden/whole.json and golden/bus.dbc; and of
one that says little, golden/small.json. What other programs make of such files, test_c.py, test_dbc.py and the like compare; here
nothing changes unseen: not a comment, not a blank.

Usage: test_golden.py OCM_GENERATE            compares
       test_golden.py OCM_GENERATE --write    writes them again; read the difference before you commit it
"""
import difflib
import pathlib
import subprocess
import sys
import unittest

GOLDEN = pathlib.Path(__file__).resolve().parent / "golden"
TOOL = ""

# The file, and the options that make it.
FILES = {
    "whole.hpp": ["whole.json"],
    "whole.h": ["whole.json", "--to", "c"],
    "whole.dbc": ["whole.json", "--to", "dbc"],
    "whole.low.dbc": ["whole.json", "--to", "dbc", "--priority", "low"],
    "whole.markdown": ["whole.json", "--to", "markdown"],
    "whole.lua": ["whole.json", "--to", "wireshark"],
    "whole.schema": ["whole.json", "--to", "json-schema"],
    "whole.spec": ["whole.json", "--to", "spec"],
    "small.hpp": ["small.json"],
    "small.h": ["small.json", "--to", "c"],
    "small.dbc": ["small.json", "--to", "dbc"],
    "small.markdown": ["small.json", "--to", "markdown"],
    "small.lua": ["small.json", "--to", "wireshark"],
    "small.schema": ["small.json", "--to", "json-schema"],
    "small.spec": ["small.json", "--to", "spec"],
    "bus.spec": ["bus.dbc", "--to", "spec"],
    "bus.dbc.again": ["bus.dbc", "--to", "dbc"],
    "bus.hpp": ["bus.dbc"],
    "bus.markdown": ["bus.dbc", "--to", "markdown"],
    "help.txt": ["--help"],
    "tasks.golden": ["--tasks", "tasks.json"],
    "sentences.golden": ["--sentences", "sentences.json"],
}


def made(arguments):
    """The file, and what is said of it."""
    output = [] if arguments == ["--help"] else ["-o", "-"]
    done = subprocess.run([TOOL, *arguments, *output], capture_output=True, timeout=60, cwd=GOLDEN, check=True)
    return done.stdout, done.stderr.decode()


def told():
    """All that is doubtful in the specs, and what each target leaves out."""
    text = ""
    for spec in ("whole.json", "small.json", "bus.dbc"):
        text += subprocess.run([TOOL, spec, "--check"], capture_output=True, timeout=60, cwd=GOLDEN, check=True).stderr.decode()
    for name, arguments in FILES.items():
        text += "".join(f"{name}: {line}\n" for line in made(arguments)[1].splitlines() if "leaves out" in line or "more doubtful" in line)
    return text.encode()


class Golden(unittest.TestCase):
    maxDiff = None

    def check(self, name, text):
        expected = (GOLDEN / name).read_bytes()
        if text != expected:
            lines = difflib.unified_diff(*(each.decode(errors="replace").splitlines() for each in (expected, text)), name, "made", lineterm="")
            self.fail("\n".join(lines))

    def test_files(self):
        for name, arguments in FILES.items():
            with self.subTest(name):
                self.check(name, made(arguments)[0])

    def test_what_is_told(self):
        self.check("told.txt", told())


if __name__ == "__main__":
    TOOL = str(pathlib.Path(sys.argv.pop(1)).resolve())
    if sys.argv[1:] == ["--write"]:
        for name, arguments in FILES.items():
            (GOLDEN / name).write_bytes(made(arguments)[0])
        (GOLDEN / "told.txt").write_bytes(told())
    else:
        unittest.main()
