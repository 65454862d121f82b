"""ocm-generate as a person or a build calls it: exit status, messages, and what becomes of the header.

Usage: test_program.py OCM_GENERATE
"""
import json
import os
import pathlib
import resource
import socket
import stat
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TOOL = ""
GOOD = (HERE / "good.json").read_text()


def run(*arguments, **options):
    return subprocess.run([TOOL, *map(str, arguments)], capture_output=True, text=True, timeout=60, **options)


class Program(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)
        self.spec = self.folder / "good.json"
        self.spec.write_text(GOOD)
        self.header = self.folder / "pair.hpp"

    def test_writes_a_header(self):
        done = run(self.spec, "-o", self.header)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        self.assertIn("struct Gyroscope {", self.header.read_text())
        self.assertEqual(sorted(os.listdir(self.folder)), ["good.json", "pair.hpp"])

    def test_without_a_standard_input_a_file_takes_its_number(self):
        done = run(self.spec, "-o", self.header, preexec_fn=lambda: os.close(0))
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        self.assertIn("struct Gyroscope {", self.header.read_text())

    def test_what_is_doubtful_is_named_with_its_line(self):
        """A header is written all the same. Three places, and how many more: --check names all."""
        spec = self.folder / "bus.dbc"
        spec.write_text("BU_: N\nBO_ 1 M: 1 N\n" + "".join(f' SG_ S{i} : {8 + i}|1@1+ (1,0) [0|0] "" N\n' for i in range(5)))
        doubts = [f"{spec}:{3 + i}: S{i} ends in byte 1 of M, which has 1 bytes; it is there in longer frames only" for i in range(5)]
        done = run(spec, "-o", self.header)
        self.assertEqual((done.returncode, done.stderr.splitlines()), (0, [*doubts[:3], f"{spec}: 2 more doubtful places; --check shows all"]))
        self.assertTrue(self.header.exists())
        for target in ("c", "spec"):
            self.assertIn(doubts[0], run(spec, "--to", target, "-o", self.header).stderr)
        done = run(spec, "--check")
        self.assertEqual((done.returncode, done.stdout, done.stderr.splitlines()), (0, "", doubts))
        spec.write_text(spec.read_text().replace(" SG_ S4", "").replace(' : 12|1@1+ (1,0) [0|0] "" N\n', ""))
        self.assertIn(f"{spec}: 1 more doubtful place; --check shows all\n", run(spec, "-o", self.header).stderr)

    def test_as_many_boards_as_eight_bits_hold(self):
        spec = json.loads(GOOD)
        for count, said in ((255, []), (256, ["256 boards"])):
            spec["boards"] += [{"name": f"board_{i}", "mcu": "none", "source": "a test"} for i in range(len(spec["boards"]), count)]
            self.spec.write_text(json.dumps(spec))
            done = run(self.spec, "--check")
            self.assertEqual(done.returncode, 1 if said else 0, done.stderr)
            for words in said:
                self.assertIn(words, done.stderr)

    def test_the_same_spec_gives_the_same_bytes_wherever_it_lies(self):
        run(self.spec, "-o", self.header)
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        (elsewhere / "good.json").write_text(GOOD)
        done = run("good.json", "-o", "-", cwd=elsewhere, env={"LC_ALL": "de_DE.UTF-8", "TZ": "Asia/Tokyo"})
        self.assertEqual(done.returncode, 0)
        self.assertEqual(done.stdout, self.header.read_text())

    def test_every_bad_spec_leaves_the_old_header_alone(self):
        bad = self.folder / "bad.json"
        for row in json.loads((HERE / "bad_specs.json").read_text()):
            with self.subTest(replace=row["replace"], by=row["by"]):
                bad.write_text(GOOD.replace(row["replace"], row["by"], 1))
                self.header.write_text("the old header")
                before = self.header.stat()
                done = run("bad.json", "-o", self.header, cwd=self.folder)
                self.assertEqual(done.returncode, 1)
                self.assertEqual(done.stdout, "")
                self.assertEqual(done.stderr.splitlines(), row["problems"])
                self.assertEqual(self.header.read_text(), "the old header")
                after = self.header.stat()
                self.assertEqual((after.st_ino, after.st_mtime_ns), (before.st_ino, before.st_mtime_ns))
        self.assertEqual(sorted(os.listdir(self.folder)), ["bad.json", "good.json", "pair.hpp"])

    def test_a_bad_spec_makes_no_header(self):
        self.spec.write_text("{")
        self.assertEqual(run(self.spec, "-o", self.header).returncode, 1)
        self.assertFalse(self.header.exists())

    def test_control_characters_of_a_spec_do_not_reach_the_terminal(self):
        self.spec.write_text(GOOD.replace('"0x08"', '"\\u001b[2J"'))
        done = run(self.spec, "--check")
        self.assertEqual(done.returncode, 1)
        self.assertIn("\\x1B[2J", done.stderr)
        self.assertNotIn("\x1b", done.stderr)

    def test_check_says_what_is_wrong_and_writes_nothing(self):
        self.assertEqual(run(self.spec, "--check").returncode, 0)
        self.spec.write_text(GOOD.replace('"0x08"', '"0x108"'))
        done = run(self.spec, "--check")
        self.assertEqual(done.returncode, 1)
        self.assertIn('/topics/0/id: "0x108" is wider than 8 bits', done.stderr)

    def test_keeps_the_mode_of_a_header_and_a_link_to_it(self):
        real = self.folder / "real.hpp"
        real.write_text("old")
        real.chmod(0o640)
        self.header.symlink_to(real)
        self.assertEqual(run(self.spec, "-o", self.header).returncode, 0)
        self.assertTrue(self.header.is_symlink())
        self.assertIn("namespace pair", real.read_text())
        self.assertEqual(stat.S_IMODE(real.stat().st_mode), 0o640)
        # Also to one that is not there yet, through another link.
        real.unlink()
        (self.folder / "deep").mkdir()
        (self.folder / "deep" / "link.hpp").symlink_to(os.path.join("..", "real.hpp"))
        self.header.unlink()
        self.header.symlink_to(os.path.join("deep", "link.hpp"))
        self.assertEqual(run(self.spec, "-o", self.header).returncode, 0)
        self.assertTrue(self.header.is_symlink() and (self.folder / "deep" / "link.hpp").is_symlink())
        self.assertIn("namespace pair", real.read_text())
        # Links in a circle lead nowhere, and stay.
        self.header.unlink()
        self.header.symlink_to(self.header.name)
        done = run(self.spec, "-o", self.header)
        self.assertEqual(done.returncode, 1)
        self.assertIn("it cannot be written: Too many levels of symbolic links; a link that leads to a file", done.stderr)
        self.assertTrue(self.header.is_symlink())

    def test_a_new_header_has_the_mode_of_any_new_file(self):
        subprocess.run(["sh", "-c", f'umask 027; exec "$0" "$1" -o "$2"', TOOL, self.spec, self.header], check=True)
        self.assertEqual(stat.S_IMODE(self.header.stat().st_mode), 0o640)

    def test_what_is_no_file_is_written_through(self):
        expected = run(self.spec, "-o", "-").stdout
        self.assertEqual(run(self.spec, "-o", "/dev/stdout").stdout, expected)
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        with subprocess.Popen(["cat", pipe], stdout=subprocess.PIPE, text=True) as reader:
            self.assertEqual(run(self.spec, "-o", pipe).returncode, 0)
            self.assertEqual(reader.communicate(timeout=60)[0], expected)
        self.assertTrue(stat.S_ISFIFO(pipe.stat().st_mode))
        done = run(self.spec, "-o", "/dev/null")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_where_no_header_can_be_written(self):
        for output, words in ((self.folder / "no" / "x.hpp", "a folder that exists"), (self.folder, "it is a folder")):
            done = run(self.spec, "-o", output)
            self.assertEqual(done.returncode, 1)
            self.assertIn(words, done.stderr)
        done = run(self.spec, "-o", "/dev/full")
        self.assertEqual(done.returncode, 1)
        self.assertIn("No space left", done.stderr)

    def test_what_is_said_of_each_place_that_takes_no_header(self):
        for output, said in (("no/x.hpp", "no/x.hpp: it cannot be written: No such file or directory; a folder that exists and that you may write to\n"),
                             (".", ".: it is a folder; the path of the file within it\n"),
                             ("/dev/full", "/dev/full: No space left on device; a file that you may write\n")):
            done = run("good.json", "-o", output, cwd=self.folder)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (1, "", said))
        for arguments in ((self.spec, "-o", "-"), ("--version",)):
            with open("/dev/full", "w") as full:
                done = subprocess.run([TOOL, *map(str, arguments)], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (1, "the standard output: No space left on device; somewhere that takes the file\n"))
        self.assertEqual(os.listdir(self.folder), ["good.json"])

    def test_a_header_for_which_there_is_too_little_room(self):
        """The old one stays as it is, and nothing lies beside it."""
        def little():
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
        for old in (None, "the old header"):
            if old is not None:
                self.header.write_text(old)
            done = run("good.json", "-o", "pair.hpp", cwd=self.folder, preexec_fn=little)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertEqual(done.stderr, "pair.hpp: it cannot be written: File too large; the old one, if there was one, is as it was\n")
            self.assertEqual(sorted(os.listdir(self.folder)), ["good.json"] if old is None else ["good.json", "pair.hpp"])
        self.assertEqual(self.header.read_text(), "the old header")

    def test_what_is_no_file_and_cannot_be_opened(self):
        with socket.socket(socket.AF_UNIX) as end:
            end.bind(str(self.folder / "socket"))
            done = run("good.json", "-o", "socket", cwd=self.folder)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr, "socket: No such device or address; a file that you may write\n")

    def test_task_sets(self):
        sets = self.folder / "tasks.json"
        task = {"name": "control", "cost": "120us", "period": "10ms", "level": 0}
        def made(**changes):
            sets.write_text(json.dumps({"sets": [{"name": "board", "source": "s", "tasks": [task | changes]}]}))
            return run("--tasks", sets, "-o", "-")
        done = made(deadline="2ms", jitter="3ns", own=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("Task task{.cost = 120'000, .period = 10'000'000, .deadline = 2'000'000, .jitter = 3, .level = 0}",
                      done.stdout)
        self.assertIn("own = true", done.stdout)
        self.assertIn(".level = 0, .waits = 119'999}", made(waits="119999ns").stdout)
        for changes, said in (({"cost": "0us"}, "'0us' is not a valid time"), ({"cost": 120}, "'120' is not a valid time"),
                              ({"period": "10 ms"}, "'10 ms' is not a valid time"), ({"period": "-1s"}, "'-1s'"),
                              ({"period": "99999999999999s"}, "is not a valid time"), ({"level": -1}, "level is out of range"),
                              ({"level": 1.5}, "level is out of range"), ({"name": "Control"}, "'Control' is not a valid name"),
                              ({"own": 1}, "own is not true or false"), ({"waits": "120us"}, "waits is not less than the cost"), ({"prio": 1}, "unknown member prio")):
            done = made(**changes)
            self.assertEqual((done.returncode, done.stdout), (1, ""), changes)
            self.assertIn(said, done.stderr)
        # What is just within each bound, and what is just beyond it.
        for changes in ({"name": "a9_"}, {"level": 1000000}, {"cost": "1ns"}, {"deadline": "1ns"}, {"jitter": "0ns"}, {"waits": "0ns"},
                        {"period": "4611686018s"}):
            self.assertEqual((made(**changes).returncode, made(**changes).stderr), (0, ""), changes)
        for changes, said in (({"name": "_a"}, "'_a' is not a valid name"), ({"name": "9a"}, "'9a' is not a valid name"),
                              ({"name": "a-b"}, "'a-b' is not a valid name"), ({"level": 1000001}, "level is out of range"),
                              ({"deadline": "0ns"}, "'0ns' is not a valid time"), ({"jitter": "-1ns"}, "'-1ns' is not a valid time"),
                              ({"waits": "-1ns"}, "'-1ns' is not a valid time"), ({"period": "4611686019s"}, "is not a valid time"),
                              ({"source": 1}, "source is not a text")):
            done = made(**changes)
            self.assertEqual((done.returncode, done.stdout), (1, ""), changes)
            self.assertIn(said, done.stderr)
        # All that is said of a set.
        for tasks, more, said in (([task], {"bus_percent": 0}, []), ([task], {"bus_percent": 100}, []),
                                  ([task], {"bus_percent": 101}, ["bus_percent is out of range; a whole number from 0 to 100"]),
                                  ([task], {"blocking": "0ns"}, []), ([task, task], {}, ["'control' is there twice; another name"]),
                                  ([task, task | {"name": "con_trol"}, task | {"name": "control_"}], {}, ["'control_' has the type Control, which is there already; another name"]),
                                  ([task | {"name": "task_list"}], {}, ["'task_list' has the type TaskList, which is there already; another name"]),
                                  ([{"name": "a"}], {}, ["no cost; a time such as 120us", "no period; a time such as 120us", "no level; a whole number"]),
                                  ([{"name": "a", "period": "1ms", "level": 0, "waits": "0ns"}], {}, ["no cost; a time such as 120us"])):
            sets.write_text(json.dumps({"sets": [{"name": "board", "source": "s", "tasks": tasks, **more}]}))
            done = run("--tasks", "tasks.json", "--check", cwd=self.folder)
            self.assertEqual((done.returncode, done.stdout), (1 if said else 0, ""), done.stderr)
            self.assertEqual(done.stderr.splitlines(), [f"tasks.json:1: {line}" for line in said])
        for name, said in (("class", True), ("std", True), ("for_each_set", True), ("classes", False)):
            sets.write_text(json.dumps({"sets": [{"name": name, "source": "s", "tasks": [task | {"name": "class"}]}]}))
            done = run("--tasks", "tasks.json", "--check", cwd=self.folder)
            self.assertEqual((done.returncode, done.stderr), (1, f"tasks.json:1: '{name}' is a word of the header; another name\n") if said else (0, ""))
        for text in ("", "[]", "{}", '{"sets": []}', '{"sets": [{"name": "a", "tasks": []}]}', '{"sets": [1]}'):
            sets.write_text(text)
            done = run("--tasks", sets, "-o", "-")
            self.assertEqual((done.returncode, done.stdout), (1, ""), text)
            self.assertNotEqual(done.stderr, "")
        self.assertEqual(run("--tasks", self.folder / "none", "-o", "-").returncode, 1)

    def test_sentences(self):
        text = (ROOT / "spec" / "sentences.json").read_text()
        sentences = self.folder / "sentences.json"
        sentences.write_text(text)
        done = run("--sentences", sentences, "-o", "-")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("struct SetPoint {", done.stdout)
        self.assertEqual(run("--sentences", sentences, "--check").returncode, 0)
        sentences.write_text(text.replace('"distance"', '"angle"'))
        done = run("--sentences", "sentences.json", "-o", self.header, cwd=self.folder)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        line = 1 + text[:text.index('"distance"')].count("\n")
        self.assertEqual(done.stderr.splitlines(), [f'sentences.json:{line}: /sentences/1/fields/1/name: a second integer "angle"; another name'])
        self.assertFalse(self.header.exists())
        done = run("--sentences", self.folder / "none", "-o", "-")
        self.assertEqual(done.returncode, 1)
        self.assertIn("there is no such file; the path of a file of sentences", done.stderr)

    def test_every_target(self):
        begins = {"cpp": "// Made by", "dbc": "VERSION", "c": "// Made by", "markdown": "# Topics of Pair",
                  "wireshark": "-- Made by", "json-schema": "{"}
        for target, begin in begins.items():
            done = run(self.spec, "--to", target, "-o", "-")
            self.assertEqual((done.returncode, done.stderr), (0, ""), target)
            self.assertTrue(done.stdout.startswith(begin), target)
            self.assertEqual(run(self.spec, "--to", target, "-o", "-").stdout, done.stdout)
        self.assertEqual(run(self.spec, "--to", "cpp", "-o", "-").stdout, run(self.spec, "-o", "-").stdout)
        self.assertIn("--to", run("--help").stdout)
        self.assertEqual({t for t in begins if f"  {t} " in run("--help").stdout}, set(begins))

    def test_wrong_usage_is_2(self):
        for arguments in ((self.spec, "--to", "pdf", "-o", "a"), (self.spec, "--to"), (self.spec, "--priority", "low", "-o", "a"),
                          (self.spec, "--to", "dbc", "--priority", "big", "-o", "a"), ("--tasks", self.spec, "--to", "c", "-o", "a"),
                          ("--sentences", self.spec, "--to", "c", "-o", "a"), ("--sentences", "--tasks", self.spec, "-o", "a"),
                          (), (self.spec,), (self.spec, "-o"), (self.spec, "-o", "a", "-o", "b"), ("-x",),
                          (self.spec, "second", "-o", "a"), (self.spec, "-o", "a", "--check"), (self.spec, "-o", "")):
            with self.subTest(arguments=arguments):
                done = run(*arguments)
                self.assertEqual(done.returncode, 2)
                self.assertTrue(done.stderr.startswith("ocm-generate: "))

    def test_each_wrong_usage_is_named(self):
        spec, out = self.spec, self.header
        targets = "one of cpp, spec, dbc, c, markdown, wireshark, json-schema"
        for arguments, said in (
                ((), "no spec"), ((spec,), "no header: -o HEADER, or --check"), ((spec, "-o", out, "--check"), "--check writes no header"),
                ((spec, "-o", ""), "the header has no name"), (("--tasks", "--sentences", spec, "-o", out), "--tasks or --sentences, not both"),
                (("--tasks", spec, "--to", "c", "-o", out), "--tasks makes a C++ header, and no other target"),
                (("--sentences", spec, "--to", "c", "-o", out), "--sentences makes a C++ header, and no other target"),
                ((spec, "--priority", "high", "-o", out), "--priority is for --to dbc"),
                ((spec, "--to", "c", "--priority", "high", "-o", out), "--priority is for --to dbc"),
                ((spec, "--to", "dbc", "--priority", "first", "-o", out), "--priority is urgent, high, medium or low"),
                ((spec, "--to", "dbc", "--priority"), "--priority is urgent, high, medium or low"),
                ((spec, "-o"), "-o without a header"), ((spec, "--output"), "--output without a header"),
                ((spec, "-o", "a", "--output", "b"), "two headers: a and b"), ((spec, "--to"), f"--to without a target: {targets}"),
                ((spec, "--to", "p\x1bdf", "-o", out), f"unknown target p\\x1Bdf: {targets}"), (("-q", spec), "unknown option -q"),
                (("--q\x7f", spec), "unknown option --q\\x7F"), ((spec, "second", "-o", out), f"two specs: {spec} and second"),
                (("", "-o", out), "the spec has no name"), ((spec, "", "-o", out), "the spec has no name"), ((spec, "--", "-o", out), f"two specs: {spec} and -o")):
            with self.subTest(arguments=arguments):
                done = run(*arguments)
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertEqual(done.stderr, f"ocm-generate: {said}\nocm-generate SPEC -o HEADER; --help says more\n")
        self.assertFalse(out.exists())

    def test_options_in_any_order_and_names_that_begin_with_a_hyphen(self):
        for arguments in (("-o", "x.hpp", "good.json"), ("--output", "x.hpp", "--", "good.json"), ("good.json", "--output", "x.hpp"),
                          ("--to", "cpp", "-o", "x.hpp", "good.json")):
            self.assertEqual(run(*arguments, cwd=self.folder).returncode, 0, arguments)
        hyphen = self.folder / "-s.json"
        hyphen.write_text(GOOD)
        self.assertEqual(run("-s.json", "--check", cwd=self.folder).returncode, 2)
        self.assertEqual(run("--check", "--", "-s.json", cwd=self.folder).returncode, 0)
        self.assertIn("there is no such file", run("--check", "-", cwd=self.folder).stderr)
        self.assertEqual(run("-h").stdout, run("--help").stdout)
        high, low = (run(self.spec, "--to", "dbc", "--priority", each, "-o", "-").stdout for each in ("high", "low"))
        self.assertIn("BO_ 1288 Gyroscope: 6", high)
        self.assertIn("BO_ 1800 Gyroscope: 6", low)

    def test_a_file_without_what_the_target_is_of(self):
        nodes = self.folder / "nodes.dbc"
        nodes.write_text("BU_: A B\n")
        doubt = "nodes.dbc: the file has no message; BO_ 257 Engine: 8 Gateway begins one\n"
        done = run("nodes.dbc", "--to", "c", "-o", "-", cwd=self.folder)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr, f"{doubt}nodes.dbc: it has neither topics nor messages; a file that has some\n")
        self.assertEqual(run("nodes.dbc", "--check", cwd=self.folder).returncode, 0)
        done = run("good.json", "--to", "spec", "-o", "-", cwd=self.folder)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertEqual(done.stderr, "good.json: it has only topics, which --to spec has no place for; topics are in the spec already\n")
        self.assertEqual(run("good.json", "--to", "spec", "--check", cwd=self.folder).returncode, 0)

    def test_up_to_two_thousand_fields_are_compared(self):
        """The last one lies over the first; of more than 2000 that is not looked for, as it would take long."""
        for count in (2000, 2001):
            fields = [{"name": f"f{i}", "bit": i, "type": "u1"} for i in range(count - 1)] + [{"name": "last", "bit": 0, "type": "u1"}]
            self.spec.write_text(json.dumps({"robot": "x", "messages": [{"name": "M", "pgn": "0xFEEC", "length": 1785, "fields": fields}]}))
            done = run(self.spec, "--check")
            self.assertEqual(done.returncode, 0)
            said = f'{self.spec}:1: /messages/0/fields/1999: "f0" and "last" have bits in common; each is read by itself\n' if count == 2000 else ""
            self.assertEqual(done.stderr, said)

    def test_text_that_would_mean_something_in_markdown(self):
        """An underscore within a word means nothing; one beside it, and what begins a list or a heading, does."""
        fields = [{"name": "f", "byte": 0, "type": "u8"}]
        for text, shown in (("0_0 9_9 a_z A_Z z_0 é_é ŀ_ŀ", None), ("_a", r"\_a"), ("a_", r"a\_"), ("a _ b", r"a \_ b"), ("-_a", r"\-\_a"), ("a_-", r"a\_-"),
                            ("- a + b = c > d # e", r"\- a \+ b \= c \> d \# e"), ("a-b a+b a=b a>b a#b", None),
                            ("*a* `b` <c> [d] |e| ~f~", r"\*a\* \`b\` \<c> \[d\] \|e\| \~f\~"),
                            ("{a} (b) !c 1.d", None), ("a\tb\n\nc", "a b c"), ("\x7fa\x7f\x1fb", "a b"), ("a  b", None)):
            self.spec.write_text(json.dumps({"robot": "x", "messages": [{"name": "M", "id": 1, "length": 1, "description": text, "fields": fields}]}))
            done = run(self.spec, "--to", "markdown", "-o", "-")
            self.assertEqual((done.returncode, done.stderr), (0, ""), text)
            row = next(line for line in done.stdout.splitlines() if line.startswith("| [M](#m) |"))
            self.assertEqual(row.split(" |  |  | ")[1], (text if shown is None else shown) + " |", text)

    def test_names_of_values_and_of_messages_in_markdown(self):
        """In code only what ends it means something; the place that a heading is found at has letters, digits, hyphens and underscores."""
        for name, shown in (("on", "`on`"), ("a|b", r"`a\|b`"), ("a\x7f b\x1f~", "`a b~`"), ("`|*", r"`` `\|* ``")):
            field = {"name": "f", "byte": 0, "type": "u8", "values": {name: 1}}
            self.spec.write_text(json.dumps({"robot": "x", "messages": [{"name": "AZ.az+09_-ŀ", "id": 1, "length": 1, "fields": [field]}]}))
            done = run(self.spec, "--to", "markdown", "-o", "-")
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)
            self.assertIn(f"| f | byte 0 | u8 |  |  | 1 {shown}. |\n", done.stdout)
            self.assertIn("](#azaz09_-ŀ) | ", done.stdout)

    def test_start_values_in_markdown(self):
        """Of the upper half of 64 bits the page has none: there is no decimal number for it here."""
        for kind, more, start, said in (("u8", {}, 0, None), ("u8", {}, 255, "255"), ("i64", {}, -1, "-1"), ("i64", {}, 1, "1"), ("u64", {}, 1, "1"),
                                        ("u64", {}, 9223372036854775807, "9223372036854775807"), ("u64", {}, 9223372036854775808, None),
                                        ("u64", {}, 18446744073709551615, None), ("u8", {"scale": 0.5, "unit": "V"}, 7, "3.5 V"),
                                        ("i8", {"offset": 3}, -3, "0"), ("f32", {"scale": 2}, 1.5, "3"), ("f64", {}, -0.25, "-0.25")):
            field = {"name": "f", "byte": 0, "type": kind, "start": start, **more}
            self.spec.write_text(json.dumps({"robot": "x", "messages": [{"name": "M", "id": 1, "fields": [field]}]}))
            done = run(self.spec, "--to", "markdown", "-o", "-")
            self.assertEqual((done.returncode, done.stderr), (0, ""), field)
            if said is None:
                self.assertNotIn("Starts at", done.stdout, field)
            else:
                self.assertIn(f"| Starts at {said}. |\n", done.stdout, field)

    def test_a_range_of_which_an_end_is_no_decimal_number(self):
        """Of 19 digits and more there is none: a page then states no range, a JSON schema the other end."""
        for kind, more, shown, ends in (("u62", {}, "0 to 4611686018427387903", [0, 4611686018427387903]), ("u62", {"scale": 3}, "", [0, None]),
                                        ("i63", {"offset": -5000000000000000000}, "", [None, -388313981572612097]),
                                        ("i63", {"offset": 5000000000000000000}, "", [388313981572612096, None]), ("i63", {"scale": 3}, "", [None, None]),
                                        ("i64", {}, "-9223372036854775808 to 9223372036854775807", [None, None]), ("i64", {"scale": -1}, "", [None, None]),
                                        ("u64", {}, "", [None, None])):
            field = {"name": "f", "byte": 0, "type": kind, **more}
            self.spec.write_text(json.dumps({"robot": "x", "messages": [{"name": "M", "id": 1, "fields": [field]}]}))
            done = run(self.spec, "--to", "markdown", "-o", "-")
            self.assertEqual((done.returncode, done.stderr), (0, ""), field)
            row = next(line for line in done.stdout.splitlines() if line.startswith("| f |"))
            self.assertEqual(row.split(" | ")[2], kind)
            self.assertTrue(row.endswith(f" | {shown} |  |"), row)
            self.assertEqual(row.split(" | ")[3], {5000000000000000000: "1, from 5000000000000000000", -5000000000000000000: "1, from -5000000000000000000"}
                             .get(more.get("offset"), str(more.get("scale", ""))), field)
            done = run(self.spec, "--to", "json-schema", "-o", "-")
            self.assertEqual((done.returncode, done.stderr), (0, ""), field)
            rule = json.loads(done.stdout)["oneOf"][0]["properties"]["fields"]["properties"]["f"]
            self.assertEqual([rule.get("minimum"), rule.get("maximum")], ends, field)

    def test_a_number_of_c_has_the_digits_and_the_suffix_of_its_size(self):
        def made(*fields):
            self.spec.write_text(json.dumps({"robot": "x", "messages": [{"name": "M", "id": 1, "fields": fields}]}))
            done = run(self.spec, "--to", "c", "-o", "-")
            self.assertEqual((done.returncode, done.stderr), (0, ""), fields)
            return done.stdout
        for number, shown in ((0, "0"), (-1, "(-1)"), (2**31 - 1, "2147483647"), (2**31, "2147483648u"), (2**32 - 1, "4294967295u"),
                              (2**32, "INT64_C(4294967296)"), (2**63 - 1, "INT64_C(9223372036854775807)"), (-2**31 + 1, "(-2147483647)"),
                              (-2**31, "(INT32_MIN)"), (-2**31 - 1, "(INT64_C(-2147483649))"), (-2**63 + 1, "(INT64_C(-9223372036854775807))"),
                              (-2**63, "(INT64_MIN)")):
            self.assertIn(f"\n#define X_M_F_V {shown}\n", made({"name": "f", "byte": 0, "type": "i64", "values": {"v": number}}))
        for kind, number, shown in (("u8", 0, "0x00u"), ("u8", 255, "0xFFu"), ("u16", 255, "0xFFu"), ("u16", 256, "0x0100u"), ("u16", 65535, "0xFFFFu"),
                                    ("u32", 65535, "0xFFFFu"), ("u32", 65536, "0x00010000u"), ("u32", 2**32 - 1, "0xFFFFFFFFu"),
                                    ("u40", 255, "UINT64_C(0xFF)"), ("u40", 2**32 - 1, "UINT64_C(0xFFFFFFFF)"), ("u40", 2**32, "UINT64_C(0x0000000100000000)")):
            header = made({"name": "s", "byte": 0, "type": kind}, {"name": "f", "byte": 6, "type": "u8", "selector": "s", "selected": [number]})
            self.assertIn(f"\n  return bits == {shown};\n", header, kind)

    def test_a_number_has_the_narrowest_type_that_holds_it(self):
        robot = {"robot": "x", "namespace": "x", "bus": {"bit_rate": 500000, "source": "s"}, "boards": [{"name": "b", "mcu": "m", "source": "s"}]}
        for width, bits in ((1, 8), (8, 8), (9, 16), (16, 16), (17, 32), (32, 32), (33, 64), (63, 64)):
            fields = [{"name": "f", "byte": 0, "type": f"u{width}"}]
            narrow = "" if width == bits else f", {width}"
            for spec, target, words in (
                    ({"messages": [{"name": "M", "id": 1, "fields": fields}]}, "c", [f"static inline uint{bits}_t x_M_f(const x_M* message) {{"]),
                    ({"messages": [{"name": "M", "id": 1, "fields": fields}]}, "cpp", [f"constexpr std::uint{bits}_t f() const noexcept"]),
                    ({"topics": [{"name": "t", "id": 1, "board": "b", "source": "s", "frames": [{"fields": fields}]}]}, "c", [f"  uint{bits}_t f;\n"]),
                    ({"topics": [{"name": "t", "id": 1, "board": "b", "source": "s", "frames": [{"fields": fields}]}]}, "cpp",
                     [f"  std::uint{bits}_t f = 0;", f"using FBits = ocm::protocol::Bits<std::uint{bits}_t, 0{narrow}>;"])):
                self.spec.write_text(json.dumps({**robot, **spec} if "topics" in spec else {"robot": "x", **spec}))
                done = run(self.spec, "--to", target, "-o", "-")
                self.assertEqual((done.returncode, done.stderr), (0, ""), (width, target))
                for each in words:
                    self.assertIn(each, done.stdout, (width, target))

    def test_a_line_of_c_may_be_full(self):
        """One letter more, and it is broken."""
        for size in (12, 13):
            name = "a" * size
            self.spec.write_text(json.dumps({
                "robot": "x", "namespace": "x", "bus": {"bit_rate": 500000, "source": "s"}, "boards": [{"name": "b", "mcu": "m", "source": "s"}],
                "topics": [{"name": "t", "id": 1, "board": "b", "source": "s", "frames": [{"fields": [{"name": name, "byte": 0, "type": "u24"}]}]}]}))
            done = run(self.spec, "--to", "c", "-o", "-")
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            line = f"  const uint32_t {name}_bits = (uint32_t)data[0] | ((uint32_t)data[1] << 8) | ((uint32_t)data[2] << 16);"
            self.assertEqual(len(line), 98 + size)
            lines = done.stdout.splitlines()
            self.assertEqual((line in lines, f"  const uint32_t {name}_bits =" in lines), (size == 12, size == 13))

    def test_messages_of_the_names_of_the_helpers_of_c(self):
        helpers = ("at_most_u32", "at_most_u64", "held_i32", "held_i64", "nearest", "within", "nearest_u64", "float_of", "bits_of_float",
                   "double_of", "bits_of_double")
        messages = [{"name": name, "id": i, "fields": []} for i, name in enumerate((*helpers, "azAZ09", "near"))]
        self.spec.write_text(json.dumps({"robot": "x", "messages": messages}))
        done = run(self.spec, "--to", "c", "-o", "-")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for name in helpers:
            self.assertIn(f"typedef struct x_{name}_2 {{", done.stdout)
        for name in ("azAZ09", "near"):
            self.assertIn(f"typedef struct x_{name} {{", done.stdout)
        self.assertIn("#define X_AZAZ09_ID 0x00Bu\n", done.stdout)

    def test_messages_of_the_names_that_every_header_of_topics_has(self):
        """Those of frames and requests. Without topics there are none."""
        names = ("frame", "priority", "mode", "unit", "command_id", "sample_id", "is_sample", "priority_of", "topic_of", "request_of_mode", "stop",
                 "once", "publish", "publish_every", "request", "period_us", "read_request")
        messages = [{"name": name, "id": 0x100 + i, "format": "extended", "fields": []} for i, name in enumerate((*names, "wrong", "other"))]
        robot = {"robot": "x", "namespace": "x", "bus": {"bit_rate": 500000, "source": "s"}, "boards": [{"name": "b", "mcu": "m", "source": "s"}]}
        topic = {"name": "t", "id": 1, "board": "b", "source": "s", "frames": [{"dlc": 0, "fields": []}]}
        for spec, number, mark in (({**robot, "topics": [topic], "messages": messages}, "_2", "_"), ({"robot": "x", "messages": messages}, "", "")):
            self.spec.write_text(json.dumps(spec))
            done = run(self.spec, "--to", "c", "-o", "-")
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            for name in names:
                self.assertIn(f"\ntypedef struct x_{name}{number} {{ uint8_t bytes[8]; }} x_{name}{number};\n", done.stdout)
            for name in ("wrong", "other"):
                self.assertIn(f"\ntypedef struct x_{name} {{ uint8_t bytes[8]; }} x_{name};\n", done.stdout)
            self.assertIn(f"\n#define X_WRONG_LENGTH{mark} 0u\n", done.stdout)  # "wrong length" is an answer of the request part
            self.assertIn("\n#define X_OTHER_LENGTH 0u\n", done.stdout)

    def test_a_message_without_a_sender_where_there_are_as_many_boards_as_there_may_be(self):
        bus = self.folder / "bus.dbc"
        bus.write_text("".join(f"BO_ {i} M{i}: 8 N{i}\n" for i in range(256)))
        for target, words in (("cpp", 'sender = "";\n'), ("spec", '"name": "M255", "id": "0x0FF", "length": 8,\n'), ("dbc", "\nBO_ 255 M255: 8 Vector__XXX\n"),
                              ("c", "#define BUS_M255_ID 0x0FFu\n"), ("markdown", "| [M255](#m255) | `0x0FF` | 8 |  |  |  |\n"),
                              ("wireshark", '[0x0FF] = { name = "M255", abbreviation = "M255", length = 8, fields = {} }\n'), ("json-schema", '"M255"')):
            done = run(bus, "--to", target, "-o", "-")
            self.assertEqual(done.returncode, 0, target)
            self.assertIn(words, done.stdout, target)
            if target == "cpp":
                self.assertEqual(done.stdout.count(words), 1)

    def test_any_text_is_a_string_of_lua(self):
        for text, shown in (("V", "V"), ("\x01\x1b[2J \x1f", r"\001\027[2J \031"), ("\t~\x7f", r"\009~\127"), ("a\nb", r"a\010b"),
                            ("say \"a\" \\", r"say \"a\" \\"), ("°\u0080À", "°\u0080À")):
            field = {"name": "f", "byte": 0, "type": "u8", "unit": text}
            self.spec.write_text(json.dumps({"robot": "x", "messages": [{"name": "M", "id": 1, "length": 1, "fields": [field]}]}))
            done = run(self.spec, "--to", "wireshark", "-o", "-")
            self.assertEqual((done.returncode, done.stderr), (0, ""), text)
            self.assertIn(f'  {{ name = "f", start = 0, width = 8, unit = "{shown}" }},\n', done.stdout)

    def test_without_a_standard_input(self):
        """The files that it opens then have the number 0."""
        def closed(*arguments):
            return subprocess.run(["sh", "-c", 'exec "$0" "$@" <&-', TOOL, *map(str, arguments)], capture_output=True, text=True, timeout=60)
        expected = run(self.spec, "-o", "-").stdout
        for output, text in ((self.header, ""), ("-", expected), ("/dev/null", "")):
            done = closed(self.spec, "-o", output)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, text, ""), output)
        self.assertEqual(self.header.read_text(), expected)

    def test_help_version_and_schema(self):
        for option in ("--help", "--version", "--schema"):
            done = run(option)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
        project = (ROOT / "CMakeLists.txt").read_text()
        self.assertRegex(run("--version").stdout, r"^ocm-generate [0-9]+\.[0-9]+\.[0-9]+\n$")
        self.assertIn(run("--version").stdout.split()[1], project)
        self.assertEqual(run("--schema").stdout, (ROOT / "spec" / "topics.schema.json").read_text())
        done = run("--schema", "-o", "schema.json")  # it would not be written
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("--schema prints it, and takes nothing else: --schema > FILE", done.stderr)

    def test_the_page_on_specs_names_every_member(self):
        page = (ROOT / "docs" / "spec.md").read_text()
        schema = json.loads((ROOT / "spec" / "topics.schema.json").read_text())

        def members(rule):
            if isinstance(rule, dict):
                yield from rule.get("properties", {})
                for value in rule.values():
                    yield from members(value)
            elif isinstance(rule, list):
                for value in rule:
                    yield from members(value)

        self.assertEqual({m for m in members(schema) if f"`{m}`" not in page} - {"$schema"}, set())

    def test_the_spec_that_the_page_begins_with_is_good(self):
        page = (ROOT / "docs" / "spec.md").read_text()
        self.spec.write_text(page.split("```json\n")[1].split("```")[0])
        done = run(self.spec, "--check")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_the_messages_of_the_page_are_good(self):
        page = (ROOT / "docs" / "spec.md").read_text().split("## Plain messages")[1]
        self.spec.write_text(page.split("```json\n")[1].split("```")[0])
        done = run(self.spec, "--check")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_spec_that_is_missing(self):
        done = run(self.folder / "nothing.json", "-o", self.header)
        self.assertEqual(done.returncode, 1)
        self.assertIn("nothing.json: there is no such file; ", done.stderr)


if __name__ == "__main__":
    TOOL = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
