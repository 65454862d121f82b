"""Exit codes and messages: every error names the input, the place and the remedy."""

import json
import os
import resource
import signal
import subprocess

from harness import AMIROCTL, SOURCE, Case, main


class Usage(Case):
    def refused(self, arguments, *words, code=2):
        out, err = self.run_tool(*arguments, code=code)
        self.assertEqual(out, "")
        for word in words:
            self.assertIn(word, err)

    def test_wrong_words_are_usage_errors(self):
        self.refused(["publish", "gyr", "1s"], "'gyr'", "did you mean 'gyro'?")
        self.refused(["publish", "gyro", "65.536s"], "65.536s", "nearest: 65.535s")
        self.refused(["publish", "gyro", "0s"], "nearest: 1us")
        self.refused(["publish", "gyro", "1.5us"], "1.5us", "nearest: 1us")
        self.refused(["publish"], "publish TOPIC [PERIOD]")
        self.refused(["led", "9", "red"], "1 to 8")
        self.refused(["drive", "5cm"], "m/s")
        self.refused(["drive", "500"], "'500' needs a unit: x takes -1 to 1 m/s", "50000um/s")
        self.refused(["set", "motors", "x=1"], "'1' needs a unit: x takes -1 to 1 m/s", "x=1m/s")
        self.refused(["drive", "2000m/s"], "'2000m/s' is out of range: x takes -1 to 1 m/s")
        self.refused(["send", "205"], "205#01840302")
        self.refused(["listen", "gyr"], "did you mean 'gyro'?")
        self.refused(["info", "nope"], "one of")
        self.refused(["listen", "--timeout", "soon"], "--timeout soon")
        self.refused(["listen", "--json", "--csv"])
        self.refused(["listen", "-n", "-3"])
        self.refused([])
        self.refused(["frobnicate"])
        self.refused(["help", "frobnicate"], "unknown verb 'frobnicate'")
        self.refused(["hlep"], "did you mean 'help'?")
        self.refused(["map", "--cell"], "`amiroctl map --help` lists the options")  # and not: did you mean '--help'
        self.refused(["map", "--hlep"], "did you mean '--help'?")
        self.refused(["publish", "gyro", "--wat"])

    def test_help_and_version(self):
        out, _ = self.run_tool("--help")
        for heading in ("Ask sensors", "Command actuators", "Watch the bus", "Exit codes"):
            self.assertIn(heading, out)
        for verb in "list info publish once stop drive led set send listen decode run sim central line".split():
            out, _ = self.run_tool(verb, "--help")
            usage, examples = out.split("Examples:")
            self.assertIn(f"amiroctl {verb} ", usage)
            self.assertRegex(examples, rf"\bamiroctl (--?\S+ )*{verb}\b")
            self.assertEqual(out.count("--help"), 1)
            self.assertNotRegex(out, r"(?i)option group|are allowed")  # words of the parser, not ours
        self.assertEqual(self.run_tool("help"), self.run_tool("--help"))
        self.assertEqual(self.run_tool("help", "help"), self.run_tool("--help"))
        self.assertEqual(self.run_tool("help", "drive"), self.run_tool("drive", "--help"))
        self.assertIn("amiroctl ", self.run_tool("--version")[0])
        for verb in ("listen", "decode"):
            self.assertIn("\n\nFormat, at most one (default: pretty on a terminal, JSON lines otherwise):\n  --pretty ",
                          self.run_tool(verb, "--help")[0])

    def test_no_bus_says_how_to_get_one(self):
        self.refused(["once", "gyro"], "amiroctl sim", "ip link set can0 up", code=1)
        self.refused(["--bus", "sim", "once", "gyro"], "amiroctl sim", code=1)
        self.refused(["--bus", "can7", "once", "gyro"], code=1)
        self.refused(["--bus", "slcan", "once", "gyro"], "name the adapter's line: slcan:/dev/ttyACM0", code=1)
        self.refused(["--bus", "sim:/tmp/none", "once", "gyro"], "start one with `amiroctl sim --bus sim:/tmp/none`", code=1)
        for typed, meant in (("simm", "sim"), ("sin:/tmp/x", "sim:/tmp/x"), ("scan:/dev/ttyACM0", "slcan:/dev/ttyACM0")):
            self.refused(["--bus", typed, "once", "gyro"], f"did you mean '{meant}'?", code=1)
        self.environment["AMIROCTL_BUS"] = "sim"
        self.refused(["once", "gyro"], "amiroctl sim", code=1)

    def test_lines_that_no_mapper_serves_are_no_mappers(self):
        """Links and files that a simulator has left behind, and a terminal that no program holds."""
        lines = os.path.join(self.folder, "ocm", "line")
        os.makedirs(lines, 0o700)
        ours, theirs = os.openpty()
        for name, target in (("AVR", "/nowhere"), ("Arduino", "/dev/null"), ("Nano", os.ttyname(theirs))):
            os.symlink(target, os.path.join(lines, name))
        with open(os.path.join(lines, "plain"), "w", encoding="ascii"):
            pass
        os.close(ours)
        os.close(theirs)
        self.refused(["once", "gyro"], "amiroctl: no bus: no CAN interface is up and no simulator runs\n", code=1)
        self.refused(["--bus", "sim", "once", "gyro"], "amiroctl: no simulator is running: ", code=1)
        self.assertNotIn("mappers run", self.run_tool("--bus", "sim", "once", "gyro", code=1)[1])

    def test_the_flag_goes_before_the_environment(self):
        self.environment["AMIROCTL_BUS"] = "sim"
        _, err = self.run_tool("--bus", "a-name-of-over-15-characters", "once", "gyro", code=1)
        self.assertIn("a-name-of-over-15-characters", err)

    def test_another_spec(self):
        self.refused(["--spec", os.path.join(self.folder, "none.json"), "list"], "none.json", code=1)
        # Whatever kind of bus it is for.
        none = os.path.join(self.folder, "none.json")
        for bus in ("can0", "sim", "sim:lab", "slcan:/dev/ttyACM0", "slcan:/dev/ttyACM0@500000"):
            _, err = self.run_tool("--spec", f"{bus}={none}", "list", code=1)
            self.assertIn(none, err)
            self.assertNotIn("cannot be an interface", err)
        for bus in ("slcan:", "can:0", "can/0", "."):
            self.refused(["--spec", f"{bus}={none}", "list"], f"there is no such file, and '{bus}' cannot be an interface")
        bad = os.path.join(self.folder, "bad.json")
        with open(bad, "w", encoding="utf-8") as file:
            file.write('{ "robot": "x",\n  oops }')
        self.refused(["--spec", bad, "list"], "bad.json:2", code=1)
        own = os.path.join(SOURCE, "spec", "topics.json")
        self.assertEqual(self.run_tool("--spec", own, "list")[0], self.run_tool("list")[0])


class FullDisk(Case):
    def test_what_was_not_written_is_no_success(self):
        for arguments in (["list"], ["info", "gyro"], ["publish", "gyro", "1s", "--dry-run"], ["analyse", "bus"], ["--help"]):
            with self.subTest(arguments=arguments), open("/dev/full", "w", encoding="utf-8") as full:
                done = subprocess.run([AMIROCTL, *arguments], env=self.environment, stdin=subprocess.DEVNULL, stdout=full,
                                      stderr=subprocess.PIPE, text=True, timeout=30, check=False)
                self.assertEqual(done.returncode, 1)
                # Of what is longer than a buffer an earlier write fails, and its reason is not kept.
                self.assertRegex(done.stderr, "No space left on device|an earlier write failed")


class Streams(Case):
    def ended(self, *arguments, **options):
        done = subprocess.run([AMIROCTL, *arguments], env=self.environment, cwd=self.folder, text=True, timeout=30, check=False,
                              **({"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options))
        return done.returncode, done.stderr

    def test_a_disk_that_is_full_at_the_end(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            self.assertEqual(self.ended("publish", "gyro", "1s", "--dry-run", stdout=full),
                             (1, "amiroctl: cannot write to the standard output: No space left on device\n"))

    def test_a_reader_that_has_gone(self):
        """It is killed, as other programs are; where the signal is ignored, it says why it ends."""
        for ignored, end in ((False, (-signal.SIGPIPE, "")), (True, (1, "amiroctl: cannot write to the standard output: Broken pipe\n"))):
            reader, writer = os.pipe()
            os.close(reader)
            ignore = (lambda: signal.signal(signal.SIGPIPE, signal.SIG_IGN)) if ignored else None
            self.assertEqual(self.ended("list", stdout=writer, preexec_fn=ignore), end)
            os.close(writer)

    def test_one_that_was_closed_is_no_other_file(self):
        self.assertEqual(self.ended("list", preexec_fn=lambda: os.close(1)), (1, "amiroctl: cannot write to the standard output: Bad file descriptor\n"))
        self.assertEqual(self.ended("decode", preexec_fn=lambda: os.close(0)),
                         (1, "amiroctl: cannot read the standard input: Bad file descriptor\n          expected a log\n"))
        log = os.path.join(self.folder, "a.log")
        with open(log, "w", encoding="ascii") as file:
            file.write("(1.0) can0 608#0A0000000000\n")
        with open(log, encoding="ascii") as file:
            code, remarks = self.ended("convert", "-", "a.csv", stdin=file)
        self.assertEqual((code, remarks.splitlines()[0]), (0, "1 frame, candump to csv"))
        with open(log, encoding="ascii") as file:  # the file that is written is the next that is opened
            self.assertEqual(self.ended("convert", "-", "b.csv", stdin=file, preexec_fn=lambda: os.close(2)), (0, ""))
        texts = []
        for name in ("a.csv", "b.csv"):
            with open(os.path.join(self.folder, name), encoding="ascii") as file:
                texts.append(file.read())
        self.assertEqual(texts[1], texts[0])  # and not what was to be said


class Look(Case):
    def test_list(self):
        out, _ = self.run_tool("list")
        for alias in "gyro accel mag floor odom power ring motors".split():
            self.assertIn(alias, out)
        topics = self.objects(self.run_tool("list", "--json")[0])
        with open(os.path.join(SOURCE, "spec", "topics.json"), encoding="utf-8") as file:
            spec = json.load(file)["topics"]
        expected = {topic["name"] for topic in spec if "count" not in topic} | {f"led_{number}" for number in range(1, 9)}
        self.assertEqual(sorted(topic["topic"] for topic in topics), sorted(expected))
        gyroscope = next(topic for topic in topics if topic["topic"] == "gyroscope")
        self.assertEqual(gyroscope["id"], "0x08")
        self.assertIn("gyro", gyroscope["aliases"])

    def test_a_robot_that_the_tool_was_not_compiled_for(self):
        ferry = ["--spec", os.path.join(SOURCE, "examples", "other-robot", "topics.json")]
        self.assertIn("fork_status", self.run_tool(*ferry, "list")[0])
        for words, frame in (("publish lidar 20ms", "1A0#01140000"),  # its own priority: high
                             ("publish lidar 20ms --priority low", "3A0#01140000"),
                             ("drive 1m/s", "010#03E80000"),  # urgent; big-endian, 1 mm/s a bit
                             ("led 2 red", "121#F000")):
            self.assertEqual(self.run_tool(*ferry, *words.split(), "--dry-run")[0].split(), [frame])
        _, err = self.run_tool(*ferry, "publish", "gyro", code=2)
        self.assertIn("no topic 'gyro'", err)

    def test_a_topic_by_its_number(self):
        log = os.path.join(self.folder, "a.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("(1.0) can0 608#0A0000000000\n(1.1) can0 61E#000000000000\n(1.2) can0 608#0B0000000000\n")
        for by_name, by_number in ((["decode", log, "--topic", "gyro"], ["decode", log, "--topic", "0x08"]),
                                   (["decode", log, "--csv", "--field", "gyro.x"], ["decode", log, "--csv", "--field", "0x8.x"]),
                                   (["stats", log, "gyro", "--json"], ["stats", log, "0x08", "--json"]),
                                   (["replay", log, "gyro", "--dry-run"], ["replay", log, "0x08", "--dry-run"]),
                                   (["plot", log, "gyro.x", "--script"], ["plot", log, "0x08.x", "--script"]),
                                   (["analyse", "bus", "--rates", "ring=50ms@high"], ["analyse", "bus", "--rates", "0x1f=50ms@1"])):
            with self.subTest(by_number=by_number):
                out, _ = self.run_tool(*by_number)
                self.assertTrue(out)
                self.assertEqual(out, self.run_tool(*by_name)[0])
        self.run_tool("stats", log, "--assert", "0x08.rate>1", code=0)
        self.run_tool("stats", log, "--assert", "0x08.rate>1000", code=1)

    def test_info(self):
        out, _ = self.run_tool("info", "gyro")
        for word in ("0x08", "di_wheel_drive", "deg/s", "0.0175", "608", "bytes 0..1", "Thesis"):
            self.assertIn(word.lower(), out.lower())
        self.assertEqual(self.run_tool("info", "0x08")[0], out)
        self.assertIn("500ms", self.run_tool("info", "motors")[0])
        self.assertIn("red", self.run_tool("info", "led")[0])


class Messages(Case):
    def test_control_characters_do_not_reach_the_terminal(self):
        _, err = self.run_tool("run", "-", stdin="0s \x1b[31mnope\x07 \u009b2J\n", code=2)
        for control in "\x1b\x07\u009b":
            self.assertNotIn(control, err)
        self.assertIn("\\x1b[31mnope\\x07", err)
        _, err = self.run_tool("convert", "no\x1b]0;title\x07.log", "-", "--to", "csv", code=1)
        self.assertNotIn("\x1b", err)
        self.assertIn("\\x1b]0;title\\x07", err)

    def test_eight_bit_controls_do_not_reach_the_terminal(self):
        """A terminal that is set to eight bits takes 0x9b for the beginning of a sequence."""
        result = subprocess.run([AMIROCTL, "info", b"a\x9b2Jb\xc2\xffc\xc3\xa9"], env=self.environment, capture_output=True)
        self.assertEqual(result.returncode, 2)
        self.assertIn(rb"no topic 'a\x9b2Jb\xc2\xffc" + b"\xc3\xa9'", result.stderr)

    def test_an_empty_word_is_a_mistake(self):
        """As a variable of the shell leaves it that is not set: no command does then what it does without the word."""
        for words, what in ((["stop", ""], "word behind 'stop'"), (["", "listen"], "word"), (["decode", ""], "word behind 'decode'"),
                            (["listen", "odom", "", "gyro"], "word behind 'odom'"), (["analyse", "bus", ""], "word behind 'bus'"),
                            (["--bus", "", "drive", "5cm/s"], "value for --bus"), (["--bus=", "listen"], "value for --bus"),
                            (["record", "-o", ""], "value for -o"), (["publish", "gyro", "--wait="], "value for --wait"),
                            (["drive", "-", ""], "word behind '-'"), (["help", ""], "word behind 'help'"), ([""], "word")):
            out, err = self.run_tool(*words, code=2)
            self.assertEqual((out, err), ("", f"amiroctl: an empty {what}\n          is a variable of the shell not set?\n"))
        # Behind -- a word is what it is; a value may have an equals sign at its end.
        for words in (["info", "--", ""], ["listen", "--", "", "odom"]):
            self.assertIn("no topic ''", self.run_tool(*words, code=2)[1])
        self.assertIn("'' is not a number", self.run_tool("set", "motors", "x=", code=2)[1])

    def test_what_is_overwritten_stays_where_nothing_could_be_read(self):
        """--force overwrites with something, also with a log of no frames, and not with nothing."""
        bad, none, out = (os.path.join(self.folder, name) for name in ("bad.log", "none.json", "out.csv"))
        for path, text in ((bad, "garbage\n"), (none, "\n"), (out, "mine")):
            with open(path, "w", encoding="ascii") as file:
                file.write(text)

        def content():
            with open(out, encoding="ascii") as file:
                return file.read()

        self.run_tool("convert", bad, out, "--from", "candump", "--force", code=1)
        self.run_tool("encode", bad, "-o", out, "--force", code=1)
        self.assertEqual(content(), "mine")
        self.run_tool("convert", none, out, "--from", "json", "--force")
        self.assertRegex(content(), r"\A[^\n]*\n\Z")  # the header

    def test_a_link_to_no_file_is_there_already(self):
        log, link, target = (os.path.join(self.folder, name) for name in ("a.log", "link.csv", "target.csv"))
        with open(log, "w", encoding="ascii") as file:
            file.write("(1.000000) can0 608#000000000000\n")
        os.symlink(target, link)
        self.run_tool("convert", log, link, code=1)
        self.assertFalse(os.path.exists(target))
        self.run_tool("convert", log, link, "--force")
        self.assertTrue(os.path.exists(target))

    def test_a_file_that_may_not_grow_is_a_full_disk(self):
        log, out = os.path.join(self.folder, "a.log"), os.path.join(self.folder, "b.csv")
        with open(log, "w", encoding="ascii") as file:
            file.writelines(f"({i}.000000) can0 608#000000000000\n" for i in range(9999))
        result = subprocess.run([AMIROCTL, "convert", log, out], env=self.environment, text=True, capture_output=True, timeout=60,
                                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)))
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("File too large", result.stderr)

    def test_many_errors_of_a_script_are_counted(self):
        _, err = self.run_tool("run", "-", stdin="nonsense\n" * 100_000, code=2)
        self.assertEqual(err.count("is not a time from the start"), 20)
        self.assertIn("... and 99980 more", err)
        self.assertIn("100000 errors, nothing was sent", err)

    def test_listen_says_how_many_it_expected(self):
        self.start_sim()
        _, err = self.run_tool("listen", "-n", "1000", "--timeout", "100ms", code=1)
        self.assertIn("expected 1000 frames, only 0 came in time", err)


if __name__ == "__main__":
    main()
