"""An option means the same in every verb, and what it was called before works for one version; pages name options that exist."""

import collections
import os
import pathlib
import re

from harness import SOURCE, Case, main

OPTION = re.compile(r" +(?:-\w,)?(--[a-z-]+(?:,--[a-z-]+)*)(.*?)(?:  |$)")
# The same thing in more than one form: a speed that may be max, a bit rate beyond CAN's; robots by number and by name; what is
# shown on the terminal, of a simulation in the form that is said.
FORMS = {"--bitrate", "--data-bitrate", "--robots", "--show", "--speed"}
INNER = {"analyse": ("bus", "tasks", "chain", "trace"), "operator": ("status", "why", "switch", "hold", "resume")}
LOG = "".join(f"({i / 10 + 1}) can0 608#{i:02X}\n" for i in range(20))


class Options(Case):
    def verbs(self):
        for line in self.run_tool("completion", "--words", "--", "")[0].splitlines()[1:]:
            yield [line.split("\t")[0]]
        for verb, inner in INNER.items():
            for name in inner:
                yield [verb, name]

    def options(self, verb):
        """Names and the values that they take, as --help has them."""
        text = self.run_tool(*verb, "--help")[0].split("\nExamples:")[0]
        for match in filter(None, map(OPTION.match, text.splitlines())):
            for name in match[1].split(","):
                yield name, re.split(r" \(|=", match[2])[0].strip()


class OneMeaning(Options):
    def test_values(self):
        values = collections.defaultdict(lambda: collections.defaultdict(list))
        for verb in self.verbs():
            for name, value in self.options(verb):
                values[name][value].append(" ".join(verb))
        self.assertGreater(len(values), 60)
        for name, found in values.items():
            self.assertTrue(len(found) == 1 or name in FORMS, f"{name}: {dict(found)}")
        for name, value in (("--from", "FORMAT"), ("--to", "FORMAT"), ("--since", "T"), ("--until", "T"), ("--listen", "T"),
                            ("--watch", "")):
            self.assertEqual(list(values[name]), [value], name)
        self.assertEqual(dict(values["--show"]), {"": ["run", "calibrate"], "page|text": ["sim"]})


class Offers(Options):
    def test_formats(self):
        """Wherever one is named, a shell completes it."""
        found = collections.Counter()
        for verb in self.verbs():
            for name, value in self.options(verb):
                if value != "FORMAT" or verb == ["replay"]:  # whose --from takes a time, too
                    continue
                found[name] += 1
                offered = self.run_tool("completion", "--words", "--", *verb, name, "")[0].splitlines()
                self.assertLessEqual({"candump", "csv", "pcapng"}, set(offered), (verb, name))
        self.assertGreater(found["--from"], 4)
        self.assertGreater(found["--to"], 2)


class Suggestions(Options):
    def test_a_time_by_the_name_of_another_verb(self):
        times = ("--duration", "--timeout", "--for")
        found = 0
        for verb in self.verbs():
            own = {name for name, _ in self.options(verb)}
            has = [name for name in times if name in own]
            for typed in times:
                if typed in own or not has:
                    continue
                found += 1
                _, err = self.run_tool(*verb, typed, "2s", code=2)
                self.assertIn(f"unknown option '{typed}'", err, verb)
                self.assertIn(f"did you mean '{has[0]}'?", err, verb)
        self.assertGreater(found, 12)


class Pages(Options):
    """What docs/ says of options: each one exists, and the page of a verb leaves none out."""

    def setUp(self):
        super().setUp()
        self.common = {name for name, _ in self.options([])}
        self.own = collections.defaultdict(set)
        for verb in self.verbs():
            self.own[verb[0]] |= {name for name, _ in self.options(verb)}
        self.own["analyze"], self.own["hz"] = self.own["analyse"], self.own["stats"]

    def test_command_lines(self):
        verbs = "|".join(self.own)
        command = re.compile(rf"(?<![\w-])amiroctl((?: +--[\w-]+(?: \S+)?)*?) +({verbs})\b([^`|;&\n]*)")
        found = 0
        for page in sorted(pathlib.Path(SOURCE).rglob("*.md")):
            name = str(page.relative_to(SOURCE))
            if name.startswith(("build", "docs/decisions", "docs/howto")) or name == "CHANGELOG.md":  # made or past; followed
                continue
            for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
                for before, verb, after in command.findall(line):
                    found += 1
                    for option in re.findall(r"(?<![\w-])--[a-z][a-z-]*", before + after.split(" #")[0]):
                        self.assertIn(option, self.own[verb] | self.common, f"{name}:{number}: amiroctl {verb} has no {option}")
        self.assertGreater(found, 200)

    def test_the_page_of_a_verb_names_its_options(self):
        for verb in self.verbs():
            page = os.path.join(SOURCE, "docs", "verbs", f"{verb[0]}.md")
            with open(page, encoding="utf-8") as file:
                text = file.read()
            helped = self.run_tool(*verb, "--help")[0].split("\nExamples:")[0]
            for line in helped.splitlines():
                match = re.match(r" +((?:-\w,)?--[a-z-]+(?:,--[a-z-]+)*)", line)
                names = match[1].split(",") if match else []
                if names and not self.common & set(names):
                    self.assertTrue(any(re.search(rf"(?<![\w-]){name}(?![\w-])", text) for name in names),
                                    f"docs/verbs/{verb[0]}.md does not name {match[1]}")


class OldNames(Case):
    def setUp(self):
        super().setUp()
        self.log = os.path.join(self.folder, "a.log")
        with open(self.log, "w", encoding="utf-8") as file:
            file.write(LOG)

    def replay(self, *arguments):
        return self.run_tool("replay", self.log, "--dry-run", *arguments)

    def test_no_help_and_no_completion_shows_them(self):
        for verb, names in (("doctor", ["--watch"]), ("robots", ["--watch"]), ("run", ["--listen"]), ("replay", ["--from-format"])):
            for name in names:
                self.assertNotIn(name, self.run_tool(verb, "--help")[0])
                self.assertNotIn(name, self.run_tool("completion", "--words", "--", verb, "--")[0].split())
                self.assertNotIn(name, self.run_tool("man", verb)[0].replace("\\-", "-"))

    def test_replay(self):
        whole = self.replay()
        self.assertEqual(len(whole[0].splitlines()), 20)
        for formats in (("--from", "candump"), ("--from-format", "candump")):
            self.assertEqual(self.replay(*formats), whole)
        self.assertIn("no log format 'wav'", self.run_tool("replay", self.log, "--from", "wav", code=2)[1])
        part = self.replay("--since", "1s", "--until", "1500ms")
        self.assertEqual(len(part[0].splitlines()), 6)
        self.assertEqual(self.replay("--from", "1s", "--until", "1500ms"), part)

    def test_times_to_listen(self):
        for verb, what, remedy in (("doctor", "not a time", "500ms, 2s or 1.5s"), ("robots", "not a time above zero", "2s, 500ms or 1min")):
            _, err = self.run_tool(verb, "--watch", "soon", code=2)
            self.assertEqual(err, f"amiroctl: {verb}: --listen soon: {what}\n          write {remedy}\n")
        self.start_sim()
        for name in ("--listen", "--watch"):
            self.run_tool("doctor", name, "100ms")

    def test_run(self):
        script = os.path.join(self.folder, "a.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s publish gyro 100ms\n500ms stop gyro\n")
        self.start_sim()
        self.assertEqual(self.run_tool("run", script)[0], "")
        for name in ("--show", "--listen"):
            self.assertIn('"topic":"gyroscope"', self.run_tool("run", script, name)[0])

    def test_config_and_environment(self):
        """An old name that other verbs have in another meaning by now stays out of their way."""
        config = os.path.join(self.folder, "config.toml")
        with open(config, "w", encoding="utf-8") as file:
            file.write('listen = "150ms"\n')
        script = os.path.join(self.folder, "a.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s stop gyro\n")
        self.run_tool("--config", config, "run", "--dry-run", script)
        self.environment["AMIROCTL_LISTEN"] = "150ms"
        self.run_tool("run", "--dry-run", script)
        del self.environment["AMIROCTL_LISTEN"]
        with open(config, "w", encoding="utf-8") as file:
            file.write('[doctor]\nwatch = "soon"\n')
        self.assertIn(f"{config}:2: watch soon: not a time", self.run_tool("--config", config, "doctor", code=2)[1])
        with open(config, "w", encoding="utf-8") as file:
            file.write('[run]\nlisten = "150ms"\n')
        self.assertIn(f"{config}:2: listen 150ms: neither true nor false", self.run_tool("--config", config, "run", script, code=2)[1])


if __name__ == "__main__":
    main(together=True)
