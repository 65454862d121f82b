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
                ('[lissten]\npretty = true\n', 2, "[lissten] is no verb", "did you mean listen?"),
                ('[list]\npretty = true\n', 2, "unknown key pretty", "a key is the long name of an option"),
                ("\nbus = sim\n", 2, "could not determine value type", 'bus = "can0"'),
                ('bus = "sim\n', 1, "Error while parsing string", "a text stands in quotes"),
                ("bus\n", 1, "expected '='", 'key = value'),
                ("bus =\n", 1, "expected value", "quotes"),
                ("[list\n", 1, "expected ']'", "[verb]"),
                ('bus = "a" "b"\n', 1, "expected a comment or whitespace", "key = value"),
                ('bus = "a"\nbus = "b"\n', 2, "cannot redefine existing string 'bus'", ""),
                ('bus = 2020-01-01\n', 1, "bus: a date or a time is no option's value", "a text in quotes"),
                ('bus = ["a",\n  ["b"]]\n', 2, "bus: an array within an array is no option's value", ""),
                ('[[list]]\npretty = true\n', 1, "list: a table is no option's value", ""),
                ('help = true\n', 1, "unknown key help", "")):
            self.write(text)
            out, err = self.run_tool("list", code=2)
            self.assertEqual(out, "")
            self.assertIn(f"{self.file}:{line}: ", err)
            self.assertIn(what, err)
            self.assertIn(remedy, err)

    def test_values_that_an_option_does_not_take(self):
        self.write('[sim]\nboards = "paper"\n')
        _, err = self.run_tool("sim", code=2)
        self.assertIn(f"{self.file}:2: boards: ", err)
        self.write("")
        self.environment["AMIROCTL_BOARDS"] = "paper"
        self.assertIn("AMIROCTL_BOARDS=paper: ", self.run_tool("sim", code=2)[1])

    def test_all_mistakes_at_once(self):
        self.write('a = 1\nb = 2\n')
        _, err = self.run_tool("list", code=2)
        self.assertIn(":1: unknown key a", err)
        self.assertIn(":2: unknown key b", err)

    def test_garbage_is_a_mistake_and_no_crash(self):
        for text in ("\0\1\2", "[[[[", "=" * 1000, "a=" + "[" * 500, '"', "\u00e9 = 1", "x = [1,,2]", "x = [1"):
            self.write(text)
            self.run_tool("list", code=2)
        self.write("#" * 200_000)
        self.assertIn("larger than", self.run_tool("list", code=2)[1])


if __name__ == "__main__":
    harness.main()
