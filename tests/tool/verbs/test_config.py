"""Where options come from: the command line, the environment, the config file, in this order."""

import os

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
                ('bus = "sim"\nbuss = "sim"\n', 2, "unknown key buss", "did you mean bus?"),
                ('[lissten]\npretty = true\n', 2, "[lissten] is not a verb", "did you mean listen?"),
                ('[list]\nzzzzz = true\n', 2, "unknown key zzzzz", "a key is the long name of an option"),
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
                ('help = true\n', 1, "unknown key help", "")):
            self.write(text)
            out, err = self.run_tool("list", code=2)
            self.assertEqual(out, "")
            self.assertIn(f"{self.file}:{line}: ", err)
            self.assertIn(what, err)
            self.assertIn(remedy, err)

    def test_a_key_in_a_table_where_it_has_no_effect(self):
        for text, what, remedy in (
                ('[publish]\nbus = "sim"\n', "bus has no effect in [publish]", "write it above the first table"),
                ('[analyse.bus]\nbus = "sim"\n', "bus has no effect in [analyse.bus]", "write it above the first table"),
                ('[list]\npretty = true\n', "pretty has no effect in [list]", "in [listen], [decode]"),
                ('[analyse]\nbitrate = "500k"\n', "bitrate has no effect in [analyse]", "[analyse.bus]")):
            self.write(text)
            _, err = self.run_tool("list", code=2)
            self.assertIn(f"{self.file}:2: {what}\n", err)
            self.assertIn(remedy, err)

    def test_values_that_an_option_does_not_take(self):
        """Whatever verb is called: the whole file is judged."""
        for text, what, remedy in (
                ('priority = "hihg"', "priority: invalid value 'hihg'", "did you mean high? expected urgent, high, medium or low"),
                ("priority = 4", "priority: invalid value 4", "expected urgent, high, medium or low, or 0 to 3"),
                ("bus = 5", "bus: invalid value 5", "expected a text, in quotes"),
                ("bus = true", "bus: invalid value true", "expected a text, in quotes"),
                ('bus = ["sim", "can0"]', "bus: 2 values", "expected one"),
                ("bus = []", "bus: an array without a value", "leave the line out"),
                ('no-color = "yes"', "no-color: invalid value 'yes'", "expected true or false, without quotes"),
                ("dry-run = 1", "dry-run: invalid value 1", "expected true or false, without quotes"),
                ('[sim]\nboards = "paper"', "boards: invalid value 'paper'", "expected host or qemu"),
                ("[sim]\nrobots = 0", "robots: invalid value 0", "expected a whole number from 1 to 128"),
                ('[sim]\nrobots = "2"', "robots: invalid value '2'", "a whole number from 1 to 128, without quotes"),
                ("[sim]\nradio-loss = 1.5", "radio-loss: invalid value 1.5", "expected a number from 0 to 1"),
                ("[listen]\ncount = -1", "count: invalid value -1", "at least 1"),
                ("[listen]\ncount = 1.5", "count: invalid value 1.5", "a whole number"),
                ('[listen]\ntimeout = "5"', "timeout: invalid value '5'", "expected a time such as 500ms"),
                ("[listen]\ntimeout = 5", "timeout: invalid value 5", "expected a time such as 500ms, 2s or 1.5s, in quotes"),
                ('[publish]\nwait = "soon"', "wait: invalid value 'soon'", "expected a time"),
                ('[replay]\nspeed = "fast"', "speed: invalid value 'fast'", "or max"),
                ("[replay]\nloop = 0", "loop: invalid value 0", "how many times, at least 1"),
                ('[convert]\nto = "candum"', "to: invalid value 'candum'", "did you mean candump?"),
                ('[convert]\nto = "blf"', "to: invalid value 'blf'", "expected pcapng"),
                ('[record]\nsplit = "nonsense"', "split: invalid value 'nonsense'", "expected a size or a time, such as 100MB"),
                ('[plot]\nsize = "200"', "size: invalid value '200'", "expected WIDTHxHEIGHT in pixels, 200 to 16384 each"),
                ('[stats]\nassert = "gyro>1"', "assert: invalid value 'gyro>1'", "expected TOPIC.QUANTITY>NUMBER, such as gyro.rate>1.9"),
                ('[stats]\nassert = ["gyro.rate>1", "bus.load<fast"]', "assert: invalid value 'bus.load<fast'", "bus.load<40%"),
                ('[stats]\nbitrate = "5G"', "bitrate: invalid value '5G'", "500k or 125000")):
            self.write(text + "\n")
            for verb in (["list"], ["publish", "mag", "900us", "--dry-run"]):
                out, err = self.run_tool(*verb, code=2)
                self.assertEqual(out, "")
                self.assertIn(f"{self.file}:{text.count(chr(10)) + 1}: {what}\n", err)
                self.assertIn(remedy, err)

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

    def test_a_value_for_all_verbs_that_only_some_take(self):
        self.write('bitrate = "500k"\n')
        self.run_tool("analyse", "bus")
        _, err = self.run_tool("sim", code=2)
        self.assertIn(f"{self.file}:1: bitrate: invalid value '500k'\n", err)
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
        self.assertIn("AMIROCTL_BOARDS=paper: invalid value 'paper'", self.run_tool("sim", code=2)[1])
        self.environment["AMIROCTL_PRIORITY"] = "hihg"
        _, err = self.run_tool("publish", "mag", "900us", "--dry-run", code=2)
        self.assertIn("AMIROCTL_PRIORITY=hihg: invalid value 'hihg'", err)
        self.assertIn("did you mean high? expected urgent, high, medium or low", err)
        del self.environment["AMIROCTL_PRIORITY"]
        self.environment["AMIROCTL_DRY_RUN"] = "1"
        self.assertEqual(self.run_tool("publish", "mag", "900us")[0].strip(), "205#01840302")
        self.environment["AMIROCTL_DRY_RUN"] = "maybe"
        self.assertIn("AMIROCTL_DRY_RUN=maybe: ", self.run_tool("publish", "mag", "900us", code=2)[1])

    def test_an_option_of_the_environment_without_its_value(self):
        log = os.path.join(self.folder, "a.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("(1.0) can0 605#00D20000\n")
        self.environment["AMIROCTL_LOOP"] = "true"
        self.assertIn("plays once", self.run_tool("replay", log, "--dry-run", code=2)[1])
        self.environment["AMIROCTL_LOOP"] = "false"
        self.run_tool("replay", log, "--dry-run")

    def test_a_table_without_a_key(self):
        for text in ("[lisen]", "lisen = {}", "[lisen.deeper]"):
            self.write("# a comment\n" + text + "\n")
            _, err = self.run_tool("list", code=2)
            self.assertIn(f"{self.file}:2: [lisen", err)
            self.assertIn("is not a verb", err)

    def test_a_table_without_a_name(self):
        """TOML has it, in quotes. It is not what stands above all tables."""
        self.write('[""]\nbus = "sim"\n')
        _, err = self.run_tool("list", code=2)
        self.assertIn(f"{self.file}:2: ", err)
        self.assertIn('""', err)

    def test_a_pipe_to_which_no_program_writes(self):
        os.mkfifo(os.path.join(self.folder, "pipe"))
        _, err = self.run_tool("--config", os.path.join(self.folder, "pipe"), "list", code=2)
        self.assertIn("it is a pipe, and no program writes to it", err)
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
        self.assertIn(":1: unknown key a", err)
        self.assertIn(":2: unknown key b", err)

    def test_garbage_is_a_mistake_and_no_crash(self):
        for text in ("\0\1\2", "[[[[", "=" * 1000, "a=" + "[" * 500, '"', "\u00e9 = 1", "x = [1,,2]", "x = [1"):
            self.write(text)
            self.run_tool("list", code=2)
        for text in (".".join(["a"] * 30_000) + " = 1", "[" + ".".join(["a"] * 45_000) + "]"):
            self.write("list = 1\n" + text)
            self.assertIn(":2: tables within tables, more than 1000 deep", self.run_tool("list", code=2)[1])
        self.write("#" * 200_000)
        self.assertIn("larger than", self.run_tool("list", code=2)[1])


if __name__ == "__main__":
    harness.main()
