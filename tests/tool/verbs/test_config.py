"""Where options come from: the command line, the environment, the config file, in this order."""

import os
import re
import subprocess
import time

import harness


class Config(harness.Case):
    def setUp(self):
        super().setUp()
        self.file = os.path.join(self.folder, "config", "amiroctl", "config.toml")
        os.makedirs(os.path.dirname(self.file))
        self.environment["XDG_CONFIG_HOME"] = os.path.join(self.folder, "config")

    def write(self, text):
        with open(self.file, "w", encoding="utf-8") as file:
            file.write(text)

    def frame(self, *options):
        """The frame of a publish request: its priority tells which option won. [Thesis 4.2]"""
        return self.run_tool("publish", "mag", "900us", "--dry-run", *options)[0].strip()

    def test_no_file_is_no_error(self):
        self.assertEqual(self.frame(), "205#01840302")

    def test_the_command_line_goes_before_the_environment_and_that_before_the_file(self):
        self.write('# for every verb\npriority = "low"\n')
        self.assertEqual(self.frame(), "305#01840302")
        self.environment["AMIROCTL_PRIORITY"] = "high"
        self.assertEqual(self.frame(), "105#01840302")
        self.assertEqual(self.frame("--priority", "urgent"), "005#01840302")

    def test_a_table_is_for_its_verb(self):
        self.write('priority = "low"\n\n[publish]\npriority = "urgent"  # only here\n')
        self.assertEqual(self.frame(), "005#01840302")
        self.assertEqual(self.run_tool("once", "mag", "--dry-run")[0].strip(), "305#02")

    def test_a_default_for_what_drives_keeps_no_stop_from_being_sent(self):
        self.write('[drive]\nfor = "2s"\n[behave]\nspeed = "15cm/s"\nfor = "2s"\ndistance = "6cm"\n')
        for name in ("", "AMIROCTL_FOR"):
            if name:
                self.environment[name] = "3s"
            self.assertEqual(self.run_tool("drive", "stop", "--dry-run")[0].strip(), "201#0000000000000000")
            self.assertEqual(len(self.run_tool("behave", "none", "--dry-run")[0].splitlines()), 4)
            self.run_tool("behave", "follow", "--dry-run")
        _, err = self.run_tool("drive", "stop", "--for", "2s", "--dry-run", code=2)
        self.assertIn("drive stop takes no velocity and no --for", err)
        _, err = self.run_tool("behave", "none", "--speed", "5cm/s", code=2)
        self.assertIn("none takes no --speed", err)

    def test_a_default_for_one_kind_of_plot_or_replay_is_none_for_another(self):
        log = os.path.join(self.folder, "a.log")
        with open(log, "w", encoding="ascii") as file:
            file.write("(1.0) can0 608#FF0000000000\n(2.0) can0 608#000000000000\n")
        self.write('[plot]\nport = 9000\n[replay]\nspeed = 2\nmax-gap = "1s"\n')
        self.run_tool("plot", log, "gyro.x", "-o", os.path.join(self.folder, "a.svg"))
        _, err = self.run_tool("plot", log, "gyro.x", "--port", "9000", code=2)
        self.assertIn("--port is of the page", err)
        _, err = self.run_tool("replay", log, "--on-command", code=1)
        self.assertNotIn("with --on-command", err)

    def test_flags_and_spec(self):
        other = os.path.join(harness.SOURCE, "examples", "other-robot", "topics.json")
        self.write(f"spec = '{other}'\n[publish]\ndry-run = true\n")
        self.assertEqual(self.run_tool("publish", "fork", "1s")[0].strip(), "3B0#01E80300")
        self.assertIn("fork_status", self.run_tool("list")[0])
        self.write("[list]\njson = true\n")
        self.assertEqual(self.objects(self.run_tool("list")[0])[0]["topic"], "odometry")
        self.write("[list]\njson = false\n")
        self.assertTrue(self.run_tool("list")[0].startswith("TOPIC"))

    def test_the_bus(self):
        first, second, third = (os.path.join(self.folder, name) for name in ("first", "second", "third"))
        self.write(f'bus = "sim:{first}"\n')
        self.assertIn(first, self.run_tool("stop", code=1)[1])
        self.environment["AMIROCTL_BUS"] = "sim:" + second
        self.assertIn(second, self.run_tool("stop", code=1)[1])
        self.assertIn(third, self.run_tool("stop", "--bus", "sim:" + third, code=1)[1])

    def test_any_toml(self):
        """Dotted keys, quoted keys, inline tables, arrays of several lines, other ways to write a number or a text."""
        for text in ('publish.priority = "low"', 'publish = { priority = "low" }', '[publish]\n"priority" = """low"""',
                     "[publish]\npriority = [\n  'low',  # only one\n]"):
            self.write(text + "\n")
            self.assertEqual(self.frame(), "305#01840302")
        self.write("[listen]\ncount = 0x1\n")
        self.assertIn("no simulator", self.run_tool("listen", "--bus", "sim:" + self.folder + "/none", code=1)[1])

    def test_one_of_a_group_on_the_command_line_is_enough(self):
        self.write("[analyse.bus]\njson = true\n")
        self.assertTrue(self.run_tool("analyse", "bus")[0].startswith("{"))
        self.assertFalse(self.run_tool("analyse", "bus", "--csv")[0].startswith("{"))

    def test_another_file(self):
        other = os.path.join(self.folder, "mine.toml")
        with open(other, "w", encoding="utf-8") as file:
            file.write('priority = "high"\n')
        self.write('priority = "low"\n')
        self.assertEqual(self.frame("--config", other), "105#01840302")
        self.assertEqual(self.frame("--config", "/dev/null"), "205#01840302")
        self.environment["AMIROCTL_CONFIG"] = other
        self.assertEqual(self.frame(), "105#01840302")
        _, err = self.run_tool("list", "--config", other + ".not", code=2)
        self.assertIn("there is no such file", err)

    def test_mistakes_are_told_with_file_line_and_remedy(self):
        for text, line, what, remedy in (
                ('bus = "sim"\nbuss = "sim"\n', 2, "unknown option 'buss'", "did you mean 'bus'?"),
                ('priorty = "low"\n', 1, "unknown option 'priorty'", "did you mean 'priority'?"),  # of verbs only
                ('[lissten]\npretty = true\n', 2, "[lissten]: unknown verb 'lissten'", "did you mean 'listen'?"),
                ('[list]\nzzzzz = true\n', 2, "unknown option 'zzzzz'", "`amiroctl list --help` lists the options"),
                ("\nbus = sim\n", 2, "could not determine value type", 'bus = "can0"'),
                ('bus = "sim\n', 1, "Error while parsing string", "a text is written in quotes"),
                ("bus\n", 1, "expected '='", 'key = value'),
                ("bus =\n", 1, "expected value", "quotes"),
                ("[list\n", 1, "expected ']'", "[verb]"),
                ('bus = "a" "b"\n', 1, "expected a comment or whitespace", "key = value"),
                ('bus = "a"\nbus = "b"\n', 2, "cannot redefine existing string 'bus'", ""),
                ('bus = 2020-01-01\n', 1, "bus: a date or a time cannot be a value", "a text in quotes"),
                ('bus = ["a",\n  ["b"]]\n', 2, "bus: an array within an array cannot be a value", ""),
                ('[[list]]\npretty = true\n', 1, "list: a table cannot be a value", ""),
                ('help = true\n', 1, "unknown option 'help'", "`amiroctl --help` lists the options")):
            self.write(text)
            out, err = self.run_tool("list", code=2)
            self.assertEqual(out, "")
            self.assertIn(f"{self.file}:{line}: ", err)
            self.assertIn(what, err)
            self.assertIn(remedy, err)

    def test_the_same_mistake_has_the_words_of_the_command_line(self):
        """All of the message: but for file and line in place of the verb, and names without --."""
        for text, words, sentence in (
                ('priority = "hihg"', "publish mag 1s --priority hihg", "priority hihg: not a priority\n          did you mean 'high'?"),
                ("[sim]\nrobots = 0", "sim --robots 0", "robots 0: out of range\n          write a number from 1 to 128"),
                ("[sim]\nradio-loss = 1.5", "sim --radio-loss 1.5", "radio-loss 1.5: out of range\n          write a number from 0 to 1"),
                ("[listen]\ncount = -1", "listen --count -1", "count -1: not above zero\n          write a number above zero, such as 10"),
                ("[listen]\ncount = 1.5", "listen --count 1.5",
                 "count 1.5: not a whole number\n          write a whole number, such as 10"),
                ('[listen]\ntimeout = "soon"', "listen --timeout soon", "timeout soon: not a time above zero\n          write 2s, 500ms or 1min"),
                ('[publish]\nwait = "soon"', "publish mag 1s --wait soon", "wait soon: not a time above zero\n          write 2s, 500ms or 1min"),
                ('[sim]\nboards = "qmeu"', "sim --boards qmeu", "boards qmeu: unknown value\n          did you mean 'qemu'?"),
                ('[sim]\nboards = "paper"', "sim --boards paper", "boards paper: unknown value\n          one of: host, qemu"),
                ('[stats]\nbitrate = "5G"', "stats --bitrate 5G",
                 "bitrate 5G: no bit rate of CAN\n          1 to 1000000 bits a second, such as 500k or 125000"),
                ('bus = ["a", "b"]', "list --bus a --bus b", "bus is given more than once\n          give it once"),
                ("[list]\njsn = true", "list --jsn", "unknown option 'jsn'\n          did you mean 'json'?"),
                ("[list]\nzzzzz = true", "list --zzzzz", "unknown option 'zzzzz'\n          `amiroctl list help` lists the options"),
                ("[lisen]\njson = true", "lisen", "unknown verb 'lisen'\n          did you mean 'listen'?"),
                ("[analyse.buss]\njson = true", "analyse buss", "unknown verb 'buss'\n          did you mean 'bus'?")):
            self.write("")
            _, typed = self.run_tool(*words.split(), code=2)
            self.write(text + "\n")
            _, err = self.run_tool("list", code=2)
            line = text.count("\n") + 1
            self.assertEqual(re.sub(r": \[[a-z.]*\]: ", ": ", err).replace("--", ""), f"amiroctl: {self.file}:{line}: {sentence}\n")
            self.assertTrue(typed.replace("--", "").endswith(f": {sentence}\n"), typed)

    def test_a_key_in_a_table_where_it_has_no_effect(self):
        for text, what, remedy in (
                ('[publish]\nbus = "sim"\n', "bus has no effect in [publish]", "write it above the first table"),
                ('[analyse.bus]\nbus = "sim"\n', "bus has no effect in [analyse.bus]", "write it above the first table"),
                ('[list]\npretty = true\n', "pretty has no effect in [list]", "in [once], [listen], [decode]"),
                ('[analyse]\nbitrate = "500k"\n', "bitrate has no effect in [analyse]", "[analyse.bus]")):
            self.write(text)
            _, err = self.run_tool("list", code=2)
            self.assertIn(f"{self.file}:2: {what}\n", err)
            self.assertIn(remedy, err)

    def test_values_that_an_option_does_not_take(self):
        """Whatever verb is called: the whole file is judged."""
        for text, what, remedy in (
                ('priority = "hihg"', "priority hihg: not a priority", "did you mean 'high'?"),
                ('priority = 4', "priority 4: not a priority", "write urgent, high, medium or low, or 0 to 3"),
                ('bus = 5', "bus 5: not a text", "write a text, in quotes"),
                ('bus = true', "bus true: not a text", "write a text, in quotes"),
                ('bus = ["sim", "can0"]', "bus is given more than once", "give it once"),
                ('bus = []', "bus is an array without a value", "leave the line out"),
                ('bus = ""', "bus is empty", "give it a value, or leave the line out"),
                ('no-color = "yes"', "no-color 'yes': neither true nor false", "write true or false, without quotes"),
                ('dry-run = 1', "dry-run 1: neither true nor false", "write true or false, without quotes"),
                ('[sim]\nboards = "paper"', "boards paper: unknown value", "one of: host, qemu"),
                ('[sim]\nrobots = 0', "robots 0: out of range", "write a number from 1 to 128"),
                ('[sim]\nrobots = "2"', "robots '2': not a number", "write a whole number from 1 to 128, without quotes"),
                ('[sim]\nrobots = "08"', "robots '08': not a number", "write a whole number from 1 to 128, without quotes"),
                ('[sim]\nradio-loss = 1.5', "radio-loss 1.5: out of range", "write a number from 0 to 1"),
                ('[listen]\ncount = -1', "count -1: not above zero", "write a number above zero, such as 10"),
                ('[listen]\ncount = 1.5', "count 1.5: not a whole number", "write a whole number, such as 10"),
                ('[listen]\ntimeout = "5"', "timeout 5: a time without a unit", "write 2s, 500ms or 1min"),
                ('[listen]\ntimeout = "0s"', "timeout 0s: not a time above zero", "write 2s, 500ms or 1min"),
                ('[set]\nevery = "50us"', "every 50us: not a time of 100us or more", "write 10ms, 1s or 500us"),
                ('[listen]\ntimeout = 5', "timeout 5: a time without a unit", "write 2s, 500ms or 1min, in quotes"),
                ('[publish]\nwait = "soon"', "wait soon: not a time above zero", "write 2s, 500ms or 1min"),
                ('[replay]\nspeed = "fast"', "speed fast: invalid value", "write how many times faster, 0.000001 to 1000000, or max"),
                ('[replay]\nloop = 0', "loop 0: invalid value", "write how many times, at least 1"),
                ('[replay]\nfrom = "rubbish"', "from rubbish: invalid value",
                 "write pcapng, pcap, mcap, blf, asc, candump, candump-ns, candump-screen, csv or json"),
                ('[convert]\nto = "candum"', "to candum: unknown value", "did you mean 'candump'?"),
                ('[convert]\nto = "blf"', "to blf: unknown value", "one of: pcapng, pcap, mcap, mcap-raw, asc, candump, candump-ns, csv, json"),
                ('[record]\nsplit = "nonsense"', "split nonsense: invalid value", "write a size or a time, such as 100MB, 64MiB, 10min or 1h"),
                ('[plot]\nsize = "200"', "size 200: invalid value", "write WIDTHxHEIGHT in pixels, 200 to 16384 each, such as 1200x600"),
                ('[stats]\nassert = "gyro>1"', "assert gyro>1: invalid value", "write TOPIC.QUANTITY>NUMBER, such as gyro.rate>1.9 or bus.load<40%"),
                ('[stats]\nassert = ["gyro.rate>1", "bus.load<fast"]', "assert bus.load<fast: invalid value", "write TOPIC.QUANTITY>NUMBER, such as gyro.rate>1.9 or bus.load<40%"),
                ('[stats]\nbitrate = "5G"', "bitrate 5G: no bit rate of CAN", "1 to 1000000 bits a second, such as 500k or 125000")):
            self.write(text + "\n")
            for verb in (["list"], ["publish", "mag", "900us", "--dry-run"]):
                out, err = self.run_tool(*verb, code=2)
                self.assertEqual(out, "")
                self.assertEqual(err, f"amiroctl: {self.file}:{text.count(chr(10)) + 1}: {what}\n          {remedy}\n")

    def test_values_that_are_taken(self):
        for text in ("[stats]\nbitrate = 125000", "priority = 2", 'priority = "normal"', '[stats]\nbitrate = "125k"', "[replay]\nspeed = 2.5", '[replay]\nspeed = "max"',
                     "[replay]\nloop = true", "[replay]\nloop = 3", '[record]\nsplit = "10min"', "[record]\nsplit = 100000",
                     '[stats]\nassert = ["gyro.rate>1.9", "of_another_robot.gap<=120ms"]', '[plot]\nsize = "200x200"', "[listen]\n[analyse.bus]", '[publish]\nwait = "1s"', "[publish]\nwait = false",
                     '[sim]\nwithout = ["light_ring", "power_management"]', "[sim]\nspeed = 10", "[sim]\nseed = 0"):
            self.write(text + "\n")
            self.run_tool("list")

    def test_an_option_that_needs_no_value(self):
        log = os.path.join(self.folder, "a.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("(1.0) can0 605#00D20000\n")
        for value in ("true", "3"):
            self.write(f"[replay]\nloop = {value}\n")
            self.assertIn("plays once", self.run_tool("replay", log, "--dry-run", code=2)[1])
        self.write("[replay]\nloop = false\n")
        self.assertEqual(self.run_tool("replay", log, "--dry-run")[0].count("605#"), 1)

    def test_false_goes_before_what_is_for_all_verbs(self):
        log = os.path.join(self.folder, "a.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("(1.0) can0 605#00D20000\n")
        # One whose value may be left out, and a flag.
        self.write("loop = true\njson = true\n[replay]\nloop = false\n[list]\njson = false\n")
        self.assertEqual(self.run_tool("replay", log, "--dry-run")[0].count("605#"), 1)
        self.assertTrue(self.run_tool("list")[0].startswith("TOPIC"))
        self.write("[replay]\nloop = true\n[list]\njson = true\n")
        self.environment["AMIROCTL_LOOP"] = self.environment["AMIROCTL_JSON"] = "false"
        self.assertEqual(self.run_tool("replay", log, "--dry-run")[0].count("605#"), 1)
        self.assertTrue(self.run_tool("list")[0].startswith("TOPIC"))
        self.assertIn("plays once", self.run_tool("replay", log, "--dry-run", "--loop", code=2)[1])

    def test_false_does_not_exclude(self):
        log = os.path.join(self.folder, "a.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("(1.0) can0 605#00D20000\n(1.0) can0 606#00D20000\n(1.0) can0 607#00D20000\n")
        pretty = self.run_tool("decode", "--pretty", log)[0]
        self.assertNotIn('"time_ns"', pretty)
        for text in ("[decode]\njson = false\npretty = true\n", "pretty = true\n[decode]\njson = false\n"):
            self.write(text)
            self.assertEqual(self.run_tool("decode", log)[0], pretty, text)
        self.write("[decode]\npretty = true\n")
        self.environment["AMIROCTL_JSON"] = "0"
        self.assertEqual(self.run_tool("decode", log)[0], pretty)

    def test_a_value_for_all_verbs_that_only_some_take(self):
        self.write('bitrate = "500k"\n')
        self.run_tool("analyse", "bus")
        self.start_sim()
        self.write('bitrate = 900\n')
        self.run_tool("analyse", "bus", code=1)
        _, err = self.run_tool("sim", code=2)
        self.assertIn(f"{self.file}:1: bitrate 900: no bit rate of a simulated bus\n", err)
        self.assertIn("what is for another verb, write in its table", err)

    def test_what_is_for_all_verbs_does_not_stop_one_that_has_no_use_for_it(self):
        self.write('priority = "high"\n')
        self.run_tool("generate", "wireshark")
        self.assertIn("--priority is for dbc", self.run_tool("generate", "wireshark", "--priority", "low", code=2)[1])
        self.write('bus = "can7"\n')
        self.assertIn("/nowhere", self.run_tool("sim", "--world", "/nowhere/here.world", code=1)[1])
        self.assertIn("--bus with mappers", self.run_tool("sim", "--robots", "1", "--bus", "can7", code=2)[1])

    def test_values_from_the_environment(self):
        self.environment["AMIROCTL_BOARDS"] = "paper"
        self.assertIn("AMIROCTL_BOARDS=paper: unknown value", self.run_tool("sim", code=2)[1])
        self.environment["AMIROCTL_PRIORITY"] = "hihg"
        _, err = self.run_tool("publish", "mag", "900us", "--dry-run", code=2)
        self.assertEqual(err, "amiroctl: AMIROCTL_PRIORITY=hihg: not a priority\n          did you mean 'high'?\n")
        del self.environment["AMIROCTL_PRIORITY"]
        self.environment["AMIROCTL_DRY_RUN"] = "1"
        self.assertEqual(self.run_tool("publish", "mag", "900us")[0].strip(), "205#01840302")
        self.environment["AMIROCTL_DRY_RUN"] = "maybe"
        self.assertIn("AMIROCTL_DRY_RUN=maybe: ", self.run_tool("publish", "mag", "900us", code=2)[1])

    def test_a_variable_has_each_letter_of_its_option(self):
        self.environment["AMIROCTL_SIZE"] = "200"
        self.assertIn("amiroctl: AMIROCTL_SIZE=200: invalid value\n", self.run_tool("plot", "gyro.x", code=2)[1])

    def test_an_empty_variable_sets_nothing(self):
        self.environment["AMIROCTL_PRIORITY"] = self.environment["AMIROCTL_DRY_RUN"] = ""
        self.assertEqual(self.frame(), "205#01840302")

    def test_an_option_of_the_environment_without_its_value(self):
        log = os.path.join(self.folder, "a.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("(1.0) can0 605#00D20000\n")
        self.environment["AMIROCTL_LOOP"] = "true"
        self.assertIn("plays once", self.run_tool("replay", log, "--dry-run", code=2)[1])
        self.environment["AMIROCTL_LOOP"] = "false"
        self.run_tool("replay", log, "--dry-run")

    def test_a_variable_of_a_former_name_sets_nothing_where_the_option_does_not_take_it(self):
        """It may be meant for another verb, in which the name has another meaning by now."""
        log = os.path.join(self.folder, "a.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("(1.0) can0 605#00D20000\n")
        self.environment["AMIROCTL_FROM_FORMAT"] = "rubbish"
        self.assertEqual(self.run_tool("replay", log, "--dry-run")[0].count("605#"), 1)
        self.environment["AMIROCTL_FROM"] = "rubbish"
        self.assertIn("amiroctl: AMIROCTL_FROM=rubbish: invalid value\n", self.run_tool("replay", log, "--dry-run", code=2)[1])

    def test_a_table_without_a_key(self):
        for text in ("[lisen]", "lisen = {}", "[lisen.deeper]"):
            self.write("# a comment\n" + text + "\n")
            _, err = self.run_tool("list", code=2)
            self.assertIn(f"{self.file}:2: [lisen", err)
            self.assertIn("unknown verb 'lisen'", err)

    def test_a_table_without_a_name(self):
        """TOML has it, in quotes. It is not what stands above all tables."""
        self.write('[""]\nbus = "sim"\n')
        _, err = self.run_tool("list", code=2)
        self.assertIn(f"{self.file}:2: ", err)
        self.assertIn('""', err)

    def test_a_pipe_to_which_no_program_writes(self):
        os.mkfifo(os.path.join(self.folder, "pipe"))
        begin = time.monotonic()
        _, err = self.run_tool("--config", os.path.join(self.folder, "pipe"), "list", code=2)
        self.assertIn("it is a pipe, and no program writes to it", err)
        self.assertGreaterEqual(time.monotonic() - begin, 2)  # so long may a program take to begin
        self.environment["AMIROCTL_CONFIG"] = "/dev/stdin"
        self.assertIn('"topic"', self.run_tool("list", stdin="[list]\njson = true\n")[0])

    def test_variables_that_set_nothing_are_named(self):
        self.environment.update(AMIROCTL_PRIORTY="high", AMIROCTL_ZZZZZZZZZZ="1", AMIROCTL_DRY_RUN="true", AMIROCTL_BUS="sim",
                                AMIROCTL_CONFIG="/dev/null", AMIROCTL_HELP="1")
        _, err = self.run_tool("list")
        self.assertEqual(sorted(err.splitlines()),
                         ["AMIROCTL_HELP in the environment sets no option",
                          "AMIROCTL_PRIORTY in the environment sets no option; did you mean AMIROCTL_PRIORITY?",
                          "AMIROCTL_ZZZZZZZZZZ in the environment sets no option"])

    def test_all_mistakes_at_once(self):
        self.write('a = 1\nb = 2\n')
        _, err = self.run_tool("list", code=2)
        self.assertIn(":1: unknown option 'a'", err)
        self.assertIn(":2: unknown option 'b'", err)

    def test_garbage_is_a_mistake_and_no_crash(self):
        for text in ("\0\1\2", "[[[[", "=" * 1000, "a=" + "[" * 500, '"', "\u00e9 = 1", "x = [1,,2]", "x = [1"):
            self.write(text)
            self.run_tool("list", code=2)
        for text in (".".join(["a"] * 30_000) + " = 1", "[" + ".".join(["a"] * 45_000) + "]"):
            self.write("list = 1\n" + text)
            self.assertIn(":2: tables within tables, more than 1000 deep", self.run_tool("list", code=2)[1])
        self.write("#" * 200_000)
        self.assertIn("larger than", self.run_tool("list", code=2)[1])

    def test_a_file_has_so_many_bytes_and_no_more(self):
        self.write("#" * 100_000)
        self.run_tool("list")
        self.write("#" * 100_001)
        self.assertIn(f"amiroctl: {self.file}: larger than 100000 bytes\n", self.run_tool("list", code=2)[1])

    def test_the_folder_of_the_file(self):
        of_home = os.path.join(self.folder, ".config", "amiroctl", "config.toml")
        os.makedirs(os.path.dirname(of_home))
        with open(of_home, "w", encoding="utf-8") as file:
            file.write('priority = "high"\n')
        self.write('priority = "low"\n')
        self.assertEqual(self.frame(), "305#01840302")
        self.environment["XDG_CONFIG_HOME"] = ""
        self.assertEqual(self.frame(), "105#01840302")
        del self.environment["XDG_CONFIG_HOME"]
        self.assertEqual(self.frame(), "105#01840302")
        self.environment["HOME"] = ""
        self.assertEqual(self.frame(), "205#01840302")
        del self.environment["HOME"]
        self.assertEqual(self.frame(), "205#01840302")

    def test_so_many_points_in_a_line_and_no_more(self):
        """Points of texts are none, nor those of the lines before."""
        deep = "tables within tables, more than 1000 deep"

        def points(count):
            return ".".join(["a"] * (count + 1))
        for text, line in ((points(1000) + " = 1", 0), (points(1001) + " = 1", 1), (f"# a comment\n{points(1000)} = 1", 0),
                           (f"# a comment\n{points(1001)} = 1", 2), (f"{points(600)} = 1\nb.{points(600)} = 1", 0),
                           (f"bus = '{'.' * 2000}'", 0), (f'bus = "{"." * 2000}"', 0), (f"bus = '\"{'.' * 2000}'", 0),
                           (f"bus = '.' # {'.' * 999}", 0), (f"bus = '.' # {'.' * 1001}", 1)):
            with self.subTest(text=f"{text[:20]} of {text.count('.')}"):
                self.write(text + "\n")
                process = self.start("list")
                _, err = process.communicate(timeout=30)
                self.assertEqual(f"{self.file}:{line}: {deep}" in err, line != 0, err[:200])
                self.assertEqual(deep in err, line != 0, err[:200])

    def test_no_color_of_the_environment_is_not_empty(self):
        log = os.path.join(self.folder, "a.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("(1.0) can0 608#000000000000\n")

        def shown(*options):
            ours, theirs = os.openpty()
            process = harness.waiting.Program([harness.AMIROCTL, "decode", "--pretty", log, *options], env=self.environment,
                                              stdout=theirs, stderr=subprocess.DEVNULL)
            self.assertEqual(process.wait(timeout=30), 0)
            os.close(theirs)
            text = os.read(ours, 4096)
            os.close(ours)
            self.assertIn(b"gyroscope", text)
            return b"\x1b[" in text
        self.assertTrue(shown())
        self.assertFalse(shown("--no-color"))
        for value in ("", "1", "0"):
            self.environment["NO_COLOR"] = value
            self.assertEqual(shown(), value == "", value)


if __name__ == "__main__":
    harness.main()
