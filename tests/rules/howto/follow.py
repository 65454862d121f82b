#!/usr/bin/env python3
"""Follows a page of docs/howto, or the README, word for word:
follow.py PAGE [--root DIR] [--build DIR] [--keep DIR] [--not-run N]

It copies the project's files to a scratch folder and applies the page's marked blocks there, in order. A mark is a
comment on the line above a fenced block; a reader of the page does not see it, so the text since the last other file must
name the file, by its whole path:

    <!-- file: PATH -->                     the block is a new file
    <!-- append: PATH -->                   the block goes to the end of a file
    <!-- insert: PATH after: "TEXT" -->     the block goes after the one line that contains TEXT
    <!-- insert: PATH after: "TEXT" +N -->  the same, N lines further down
    <!-- insert: PATH before: "TEXT" -->    the block goes before that line
    <!-- replace: PATH line: "TEXT" -->     the block replaces that line
    <!-- run [NAME=VALUE ...] -->           the block is commands, run by bash -e in the copy
    <!-- beside until: "TEXT" -->           the block is commands of another terminal: what comes next begins when they have
                                            printed TEXT, while they go on
    <!-- interrupt -->                      Ctrl-C in the newest of these terminals; at the end of the page in all that are left
    <!-- transcript -->                     the block is commands behind $, each with what it prints
    <!-- not run: REASON -->                the block is commands that need what a test does not have
    <!-- check                              the lines up to --> are commands that a reader does not see: what he does
    -->                                     with a full build, done at less cost

Blocks without a mark are for the reader only; with --not-run N every block of commands must have one, and N of them are not run.
Commands have a runtime folder and a configuration of their own, and nothing that the environment says to amiroctl. Programs of the build folder, and a few of its objects, are at build/ in
the copy. Exit status: 0 the page can be followed, 1 it cannot, 2 wrong usage. --keep leaves the copy at DIR, which must
not exist."""
import argparse
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "architecture"))
sys.path.insert(0, str(pathlib.Path(__file__).parents[2]))
import house  # noqa: E402
import waiting  # noqa: E402

MARK = re.compile(r"^ *<!-- *(?:(?P<word>file|append|insert|replace): *(?P<path>\S+)"
                  r"(?: +(?P<where>after|before|line): *\"(?P<text>.*)\"(?: *\+(?P<more>\d+))?)?"
                  r"|(?P<commands>run|transcript)(?P<variables>(?: +\w+=\S+)*)|(?P<beside>beside) until: *\"(?P<ready>.+)\""
                  r"|(?P<interrupt>interrupt)|(?P<left>not run): *\S.*?) *-->$")
PLACES = {"file": (None,), "append": (None,), "insert": ("after", "before"), "replace": ("line",)}
CHECK = re.compile(r"^<!-- check$")
LIKE_A_MARK = re.compile(r"^ *<!-- *(file|append|insert|replace|run|check|beside|interrupt|transcript|not run)\b")
FENCE = re.compile(r"^( *)```")
COMMANDS = re.compile(r"^ *```(sh|bash|console)\b")
INDENTED = re.compile(r"^    \S")
# What pages link to: Catch2's main, which costs most of a small test's time, and the generator but for what is new.
BUILT = ("tests/CMakeFiles/ocm_test_main.dir/main.cpp.o", "generator/CMakeFiles/ocm-generate.dir/main.cpp.o",
         "generator/*.a", "generator/dbc/*.a", "generator/spec/*.a")


class PageError(Exception):
    """The page cannot be followed; the text has page and line."""


def visible(line):
    """What a reader of the page sees of a line of prose."""
    return re.sub(r"\]\([^)]*\)", "]", re.sub(r"<!--.*?(-->|$)", "", line))


class Step:
    def __init__(self, line, text, match=None):
        self.line = line
        self.text = text
        words = match.group("word", "commands", "beside", "interrupt", "left") if match else ("run",)
        self.word = next(word for word in words if word)
        self.path, self.where, self.anchor = match.group("path", "where", "text") if match else (None, None, None)
        self.further = int(match["more"] or 0) if match else 0
        self.variables = dict(each.split("=", 1) for each in (match["variables"] or "").split()) if match else {}
        self.ready = match["ready"] if match else None


def steps(page, text):
    """The marked blocks of a page, in order."""
    lines = text.splitlines()
    found = []
    at = 0
    fenced = False
    prose, edited = "", None  # what a reader saw since the last other file; the file of the last mark
    while at < len(lines):
        line = lines[at]
        at += 1
        if FENCE.match(line):
            fenced = not fenced
        if fenced or not LIKE_A_MARK.match(line):
            prose += "" if fenced else visible(line) + "\n"
            continue
        number = at
        if CHECK.match(line):
            while at < len(lines) and lines[at].strip() != "-->":
                at += 1
            if at == len(lines):
                raise PageError(f"{page}:{number}: the block is not closed")
            found.append(Step(number, "".join(row + "\n" for row in lines[number:at])))
            continue
        match = MARK.match(line)
        if not match or (match["word"] and match["where"] not in PLACES[match["word"]])\
                or (match["more"] and match["where"] != "after"):
            raise PageError(f"{page}:{number}: unknown mark: {line.strip()}")
        if match["interrupt"]:
            found.append(Step(number, "", match))
            continue
        fence = FENCE.match(lines[at]) if at < len(lines) else None
        if not fence:
            raise PageError(f"{page}:{number}: no fenced block follows the mark")
        if match["path"] and match["path"] != edited:
            edited = match["path"]
            if not re.search(rf"(?<![\w./-]){re.escape(edited)}(?![\w/-]|\.\w)", prose):
                raise PageError(f"{page}:{number}: the text before the mark does not name {edited}")
            prose = ""
        indent = len(fence[1])
        end = at + 1
        while end < len(lines) and not re.match(rf" {{{indent}}}``` *$", lines[end]):
            end += 1
        if end == len(lines):
            raise PageError(f"{page}:{number}: the block is not closed")
        block = [row[indent:] if row[:indent].isspace() or not indent else row for row in lines[at + 1:end]]
        found.append(Step(number, "".join(row + "\n" for row in block), match))
        at = end + 1
    if not any(step.word in ("run", "transcript") for step in found):
        raise PageError(f"{page}:1: no block is marked with <!-- run -->, so nothing would be checked")
    return found


def edit(step, root, where):
    target = root / step.path
    if root not in target.resolve().parents:
        raise PageError(f"{where}: {step.path} is outside of the project")
    if step.word == "file":
        if target.exists():
            raise PageError(f"{where}: {step.path} exists already")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(step.text)
        if step.text.startswith("#!"):
            target.chmod(0o755)
        return
    if not target.is_file():
        raise PageError(f"{where}: there is no file {step.path}")
    lines = target.read_text().splitlines(keepends=True)
    if step.word == "append":
        target.write_text("".join(lines) + step.text)
        return
    hits = [number for number, line in enumerate(lines) if step.anchor in line]
    if len(hits) != 1:
        raise PageError(f'{where}: {len(hits)} lines of {step.path} contain "{step.anchor}"; expected 1')
    if step.word == "replace":
        lines[hits[0]] = step.text
    else:
        lines.insert(hits[0] + (step.where == "after") + step.further, step.text)
    target.write_text("".join(lines))


def unmarked(page, text):
    """The first block of commands without a mark, as an error."""
    before, fenced = "", False
    for number, line in enumerate(text.splitlines(), 1):
        if FENCE.match(line):
            if not fenced and COMMANDS.match(line) and not LIKE_A_MARK.match(before):
                raise PageError(f"{page}:{number}: the commands have no mark: run, beside, transcript or not run")
            fenced = not fenced
        elif not fenced and INDENTED.match(line) and not before.strip():
            raise PageError(f"{page}:{number}: commands are in a fenced block, ```sh, with a mark above it")
        before = line


class Terminals:
    """What runs the commands of a page: one bash after the other, and some beside it."""

    def __init__(self, root, home):
        self.root = root
        self.beside = []
        runtime = home / "run"
        runtime.mkdir(mode=0o700, parents=True)
        kept = {name: value for name, value in os.environ.items() if not name.startswith("AMIROCTL")}
        self.environment = dict(kept, PATH=f"{root / 'build'}{os.pathsep}{os.environ['PATH']}", LC_ALL="C.UTF-8",
                                PYTHONDONTWRITEBYTECODE="1", XDG_RUNTIME_DIR=str(runtime), XDG_CONFIG_HOME=str(home))

    def bash(self, text, where, variables=None, output=subprocess.STDOUT):
        """What the commands print."""
        try:
            done = subprocess.run(["bash", "-e", *(["-x"] if output else []), "-c", text], cwd=self.root, text=True, timeout=300,
                                  env={**self.environment, **(variables or {})}, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=output)
        except subprocess.TimeoutExpired:
            raise PageError(f"{where}: the commands did not end within 300 s") from None
        print(done.stdout, end="")
        if done.returncode != 0:
            raise PageError(f"{where}: the last command above failed with exit status {done.returncode}")
        return done.stdout

    def transcript(self, step, where):
        parts = re.split(r"^\$ (.*)\n", step.text, flags=re.MULTILINE)
        if len(parts) < 3 or parts[0]:
            raise PageError(f"{where}: a transcript is '$ COMMAND' and what it prints")
        for command, expected in zip(parts[1::2], parts[2::2]):
            print(f"$ {command}")
            printed = self.bash(command, where, step.variables, output=None)
            if printed != expected:
                raise PageError(f"{where}: {command} prints {printed!r}, not {expected!r}")

    def start(self, step, where):
        output = tempfile.TemporaryFile()
        # Of its own group, as in a terminal; and Ctrl-C counts, also where this program was started to ignore it.
        process = subprocess.Popen(["bash", "-e", "-c", step.text], cwd=self.root, env=self.environment, text=True,
                                   stdin=subprocess.DEVNULL, stdout=output, stderr=output, start_new_session=True,
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        self.beside.append((where, process, output))

        def ready():
            return step.ready in waiting.printed(output) or process.poll() is not None
        try:
            waiting.until(ready, step.ready)
        except AssertionError:
            pass
        if step.ready not in waiting.printed(output):
            raise PageError(f"{where}: '{step.ready}' was not printed, but: {waiting.printed(output)}")

    def interrupt(self, where="end"):
        if not self.beside:
            raise PageError(f"{where}: no commands go on, so there is nothing to interrupt")
        begun, process, output = self.beside.pop()
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGINT)
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        print(f"--- Ctrl-C: what {begun} printed\n" + "".join(waiting.printed(output).splitlines(True)[-20:]), end="")
        output.close()
        if process.returncode not in (0, 128 + signal.SIGINT, -signal.SIGINT):
            raise PageError(f"{begun}: the commands ended with {process.returncode}, not as Ctrl-C ends them")

    def close(self):
        """Ends all that go on, and raises the first failure."""
        failure = None
        while self.beside:
            try:
                self.interrupt()
            except PageError as error:
                failure = failure or error
        if failure:
            raise failure


def copy(source, build, root):
    """The project's files, and the programs that were built, as links: what a page writes does not reach the original."""
    for name in house.files(source):
        target = root / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source / name, target)
    (root / "build").mkdir()
    built = [file for file in build.iterdir() if file.is_file() and os.access(file, os.X_OK)] if build else []
    for file in built + [file for pattern in BUILT for file in (build.glob(pattern) if build else ())]:
        target = root / "build" / file.relative_to(build)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.symlink_to(file.resolve())


def follow(page, source, build, root, not_run=None):
    """Applies the page in `root`; raises PageError."""
    wanted = steps(page.name, page.read_text())
    if not_run is not None:
        unmarked(page.name, page.read_text())
        left = sum(step.word == "not run" for step in wanted)
        if left != not_run:
            raise PageError(f"{page.name}:1: {left} blocks are not run; expected {not_run}")
    copy(source, build, root)
    with tempfile.TemporaryDirectory(prefix="ocm-home-") as home:
        terminals = Terminals(root, pathlib.Path(home))
        try:
            for step in wanted:
                where = f"{page.name}:{step.line}"
                print(f"--- {where}: {step.word} {step.path or ''}", flush=True)
                if step.word == "run":
                    terminals.bash(step.text, where, step.variables)
                elif step.word == "transcript":
                    terminals.transcript(step, where)
                elif step.word == "beside":
                    terminals.start(step, where)
                elif step.word == "interrupt":
                    terminals.interrupt(where)
                elif step.word != "not run":
                    edit(step, root, where)
        finally:
            terminals.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[3],
                        help="the project (default: the one that this program belongs to)")
    parser.add_argument("--build", type=pathlib.Path, help="where its programs were built (default: ROOT/build)")
    parser.add_argument("--not-run", type=int, metavar="N", help="every block of commands has a mark, and N are not run")
    parser.add_argument("--keep", type=pathlib.Path, metavar="DIR", help="leave the copy at DIR")
    arguments = parser.parse_args()
    build = arguments.build or arguments.root / "build"
    try:
        with tempfile.TemporaryDirectory(prefix="ocm-howto-") as scratch:
            root = arguments.keep or pathlib.Path(scratch, "ocm")
            root.mkdir(parents=True)
            follow(arguments.page, arguments.root.resolve(), build.resolve() if build.is_dir() else None, root.resolve(),
                   arguments.not_run)
    except (PageError, OSError) as error:
        print(f"follow: {error}", file=sys.stderr)
        return 1
    print(f"{arguments.page.name} can be followed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
