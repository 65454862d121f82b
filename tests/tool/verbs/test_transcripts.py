"""Transcripts: commands of amiroctl, and all that they print, word for word. Those of each file of transcripts/ are run again, in their
order. With OCM_WRITE_GOLDEN=1 what they print now is written, to be read in review.

A line `$ amiroctl WORDS` is a command, its words quoted as for a shell; it may end with `< FILE` or `<<< TEXT`, which it reads. Behind it stands
what it prints, behind `--- stderr` its errors, behind `--- exit` its exit code where that is not 0. To add a case, type its line, and have the
rest written. The commands of a transcript run in a folder of their own, with those of transcripts/files/ in it, and the links below.
"""

import difflib
import os
import shlex
import shutil
import subprocess

from harness import AMIROCTL, SOURCE, Case, main

HERE = os.path.join(SOURCE, "tests", "tool", "verbs", "transcripts")
PROMPT = "$ amiroctl "
LINKS = {"car.dbc": "examples/small_car.dbc", "other_robot.json": "examples/other-robot/topics.json", "truck.dbc": "examples/truck.dbc", "probe.json": "tests/generator/probe.json",
         "standalone.script": "examples/standalone.script"}


def commands(text):
    """The lines of a transcript that are commands."""
    return [line[len(PROMPT):] for line in text.splitlines() if line.startswith(PROMPT)]


def parts(command):
    """Its words, and what it reads: a file, a text, or nothing."""
    words = shlex.split(command)
    for sign, is_file in (("<", True), ("<<<", False)):
        if len(words) > 1 and words[-2] == sign:
            return words[:-2], words[-1] if is_file else None, None if is_file else words[-1] + "\n"
    return words, None, ""


class Transcript(Case):
    def setUp(self):
        super().setUp()
        self.environment["TZ"] = "UTC"
        shutil.copytree(os.path.join(HERE, "files"), self.folder, dirs_exist_ok=True)
        for name, file in LINKS.items():
            os.symlink(os.path.join(SOURCE, file), os.path.join(self.folder, name))
        os.mkdir(os.path.join(self.folder, "other"))
        os.link(os.path.join(self.folder, "gyro.log"), os.path.join(self.folder, "link.log"))

    def printed(self, command):
        words, file, text = parts(command)
        if file is not None:
            with open(os.path.join(self.folder, file), encoding="utf-8") as read:
                text = read.read()
        done = subprocess.run([AMIROCTL, *words], env=self.environment, input=text, text=True, capture_output=True, cwd=self.folder, timeout=60, check=False)
        out = done.stdout if not done.stdout or done.stdout.endswith("\n") else done.stdout + " (no end of line)\n"
        err = f"--- stderr\n{done.stderr}" if done.stderr else ""
        code = f"--- exit {done.returncode}\n" if done.returncode else ""
        return f"{PROMPT}{command}\n" + (out + err + code).replace(SOURCE + "/", "").replace(self.folder, "FOLDER")

    def compare(self, name):
        path = os.path.join(HERE, name)
        with open(path, encoding="utf-8") as file:
            expected = file.read()
        now = "\n".join(self.printed(command) for command in commands(expected))
        if os.environ.get("OCM_WRITE_GOLDEN"):
            with open(path, "w", encoding="utf-8") as file:
                file.write(now)
        elif now != expected:
            self.fail("\n".join(difflib.unified_diff(expected.splitlines(), now.splitlines(), path, "now", lineterm="")))


def case(name):
    return lambda self: self.compare(name)


for transcript in os.listdir(HERE):
    if transcript.endswith(".txt"):
        setattr(Transcript, "test_" + transcript.removesuffix(".txt"), case(transcript))

if __name__ == "__main__":
    main(together=True)
