"""Manual pages: one a verb, without a warning of mandoc, with what --help says. Needs mandoc."""

import os
import re
import shutil
import subprocess
import unittest

import harness


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

    def test_ocm_generate(self):
        tool = os.path.join(os.path.dirname(harness.AMIROCTL), "ocm-generate")
        page = subprocess.run([tool, "--man"], capture_output=True, text=True, check=True).stdout
        self.assertEqual(self.lint(page), [])

    def test_mistakes(self):
        self.assertIn("unknown verb no_such", self.run_tool("man", "no_such", code=2)[1])
        self.run_tool("man", "--all", "/dev/null/man1", code=1)


if __name__ == "__main__":
    harness.main()
