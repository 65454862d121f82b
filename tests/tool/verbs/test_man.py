"""Manual pages: one a verb, without a warning of mandoc, with what --help says. Needs mandoc."""

import os
import re
import shutil
import subprocess
import unittest

import harness


# What a page shows as its synopsis, line by line.
SYNOPSES = """
amiroctl [OPTION ...] VERB ...
amiroctl list [OPTION ...]
amiroctl info TOPIC [OPTION ...]
amiroctl analyse bus [FILE] [OPTION ...]
amiroctl analyse tasks FILE|BOARD [OPTION ...]
amiroctl analyse chain FILE [OPTION ...]
amiroctl analyse trace LOG [OPTION ...]
amiroctl generate TARGET [OPTION ...]
amiroctl publish TOPIC [PERIOD] [OPTION ...]
amiroctl once TOPIC [OPTION ...]
amiroctl stop [TOPIC|all] [OPTION ...]
amiroctl drive X|stop [Z] [OPTION ...]
amiroctl travel [DISTANCE] [OPTION ...]
amiroctl behave follow|avoid|home|none [OPTION ...]
amiroctl led N|all COLOUR|off [OPTION ...]
amiroctl set ACTUATOR|MESSAGE [FIELD=VALUE ...] [OPTION ...]
amiroctl send FRAME [OPTION ...]
amiroctl listen [TOPIC ...] [OPTION ...]
amiroctl doctor [OPTION ...]
amiroctl record [TOPIC ...] [OPTION ...]
amiroctl replay FILE|- [TOPIC ...] [OPTION ...]
amiroctl decode [FILE ...] [OPTION ...]
amiroctl encode [FILE] [OPTION ...]
amiroctl convert IN OUT [OPTION ...]
amiroctl stats [FILE ...|live] [TOPIC ...] [OPTION ...]
amiroctl top [FILE|live] [TOPIC ...] [OPTION ...]
amiroctl serve [FILE|live] [robots] [OPTION ...]
amiroctl plot [FILE ...|live] FIELD ... [OPTION ...]
amiroctl run SCRIPT|- [OPTION ...]
amiroctl operate FILE [OPTION ...]
amiroctl operator status [OPTION ...]
amiroctl operator why [OPTION ...]
amiroctl operator switch CONFIGURATION [OPTION ...]
amiroctl operator hold [OPTION ...]
amiroctl operator resume [OPTION ...]
amiroctl sim [OPTION ...]
amiroctl central [OPTION ...]
amiroctl robots [OPTION ...]
amiroctl goto ROBOT ANGLE DISTANCE [OPTION ...]
amiroctl calibrate ROBOT [OPTION ...]
amiroctl pause ROBOT ... [OPTION ...]
amiroctl unpause ROBOT ... [OPTION ...]
amiroctl map FILE ... [OPTION ...]
amiroctl line [FILE] [OPTION ...]
amiroctl completion bash|zsh|fish [OPTION ...]
amiroctl man [VERB] [OPTION ...]
""".split("\n")[1:-1]


def rendered(page):
    """A page as man shows it, by section: its lines without the indentation."""
    text = subprocess.run(["mandoc", "-Tutf8", "-Owidth=200"], input=page, capture_output=True, text=True, check=True).stdout
    sections = {}
    heading = None
    for line in re.sub(".\b", "", text).splitlines():  # bold and underlined are typed twice
        if re.match(r"[A-Z][A-Z ]+|OPTIONS OF .*", line) and not line.startswith("AMIROCTL"):
            heading = line
            sections[heading] = []
        elif heading is not None and line.startswith(" "):
            sections[heading].append(line.strip())
    return sections


class Man(harness.Case):
    def lint(self, page):
        self.assertIsNotNone(shutil.which("mandoc"), "mandoc is missing: scripts/setup")
        done = subprocess.run(["mandoc", "-Tlint", "-Wwarning"], input=page, capture_output=True, text=True, timeout=60)
        # A date would make two builds differ.
        return [line for line in done.stdout.splitlines() if "missing date" not in line]

    def test_every_page(self):
        folder = os.path.join(self.folder, "man1")
        self.run_tool("man", "--all", folder)
        words = self.run_tool("completion", "--words", "--", "")[0].splitlines()[1:]
        verbs = [word.split("\t")[0] for word in words]
        self.assertEqual(set(os.listdir(folder)), {"amiroctl.1"} | {f"amiroctl-{verb}.1" for verb in verbs})
        for name in os.listdir(folder):
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                page = file.read()
            self.assertEqual(self.lint(page), [], name)
            sections = re.findall(r'^\.SH "(.*)"$', page, re.M)
            self.assertEqual(sections[:3], ["NAME", "SYNOPSIS", "OPTIONS"], name)

    def test_a_page_says_what_help_says(self):
        page, _ = self.run_tool("man", "publish")
        text = subprocess.run(["mandoc", "-Tutf8"], input=page, capture_output=True, text=True, check=True).stdout
        text = re.sub(".\b", "", text)  # bold and underlined are typed twice
        self.assertIn("amiroctl-publish - ", text)
        help_text, _ = self.run_tool("publish", "--help")
        for option in re.findall(r"--[a-z-]+", help_text):
            self.assertIn(option, text)
        for line in help_text.split("Examples:\n")[1].splitlines():
            self.assertIn(" ".join(line.split()), " ".join(text.split()))

    def test_synopses(self):
        verbs = [word.split("\t")[0] for word in self.run_tool("completion", "--words", "--", "")[0].splitlines()[1:]]
        shown = []
        for verb in [None, *verbs]:
            shown += filter(None, rendered(self.run_tool("man", *([verb] if verb else []))[0])["SYNOPSIS"])
            if verb:
                usage = re.search(r"^Usage: (.*)$", self.run_tool(verb, "--help")[0], re.M)[1]
                self.assertTrue(verb in ("analyse", "operator") or shown[-1] == usage, usage)
        self.assertEqual(shown, SYNOPSES)

    def test_the_program(self):
        page = rendered(self.run_tool("man")[0])
        self.assertEqual(list(page), ["NAME", "SYNOPSIS", "OPTIONS", "VERBS", "ENVIRONMENT", "FILES", "EXIT STATUS", "SEE ALSO"])
        self.assertEqual(page["NAME"][0], "amiroctl - Ask a robot's sensors, command its actuators, watch its CAN bus.")
        for option in ("--bus NAME", "--spec FILE", "--config FILE", "--no-color", "--version", "--help"):
            self.assertTrue(any(option in line for line in page["OPTIONS"]), option)
        verbs = dict(word.split("\t") for word in self.run_tool("completion", "--words", "--", "")[0].splitlines()[1:])
        listed = dict(re.split(r"(?:, \w+)?  +", line, maxsplit=1) for line in page["VERBS"] if "  " in line)
        self.assertEqual(listed, verbs)
        for word in ("AMIROCTL_BUS", "AMIROCTL_SPEC", "AMIROCTL_CONFIG", "NO_COLOR", "XDG_CONFIG_HOME", "XDG_RUNTIME_DIR"):
            self.assertTrue(any(line.startswith(word) for line in page["ENVIRONMENT"]), word)
        self.assertIn("~/.config/amiroctl/config.toml", page["FILES"])
        self.assertIn("2 wrong usage", page["EXIT STATUS"][0])
        self.assertNotIn("amiroctl-amiroctl(1)", " ".join(page["SEE ALSO"]))
        self.assertEqual(self.run_tool("man")[0], self.all_pages()["amiroctl.1"])

    def all_pages(self):
        folder = os.path.join(self.folder, "all")
        self.run_tool("man", "--all", folder)
        pages = {}
        for name in os.listdir(folder):
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                pages[name] = file.read()
        return pages

    def test_options_begin_where_those_of_help_do(self):
        for words in ((), ("list",), ("pause",)):
            page = rendered(self.run_tool("man", *words)[0])
            behind_usage = self.run_tool(*words, "--help")[0].split("\n\n")[1]
            self.assertEqual(page["OPTIONS"][0], behind_usage.splitlines()[0].strip())

    def test_options_of_inner_verbs(self):
        page = rendered(self.run_tool("man", "analyse")[0])
        self.assertTrue(any(line.startswith("--queue QUEUE") for line in page["OPTIONS OF analyse bus"]))
        self.assertTrue(any(line.startswith("--tick T") for line in page["OPTIONS OF analyse tasks"]))
        self.assertTrue(any("amiroctl(1)" in line for line in page["OPTIONS"]))

    def test_a_page_names_all_the_others(self):
        verbs = [word.split("\t")[0] for word in self.run_tool("completion", "--words", "--", "")[0].splitlines()[1:]]
        for page in (None, verbs[0], verbs[-1], "publish"):
            shown = "".join("".join(rendered(self.run_tool("man", *([page] if page else []))[0])["SEE ALSO"]).split())
            others = [f"amiroctl-{verb}(1)" for verb in verbs if verb != page]
            self.assertEqual(sorted(shown.split(",")), sorted((["amiroctl(1)"] if page else []) + others + ["ocm-generate(1)"]), page)

    def test_ocm_generate(self):
        tool = os.path.join(os.path.dirname(harness.AMIROCTL), "ocm-generate")
        page = subprocess.run([tool, "--man"], capture_output=True, text=True, check=True).stdout
        self.assertEqual(self.lint(page), [])

    def test_mistakes(self):
        self.assertIn("unknown verb 'no_such'", self.run_tool("man", "no_such", code=2)[1])
        self.run_tool("man", "--all", "/dev/null/man1", code=1)
        self.assertIn("--all", self.run_tool("man", "publish", "--all", self.folder, code=2)[1])


if __name__ == "__main__":
    harness.main()
