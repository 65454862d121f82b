"""Every verb that reads a spec says at once what is wrong with a broken one, before it looks for a bus: file, place and remedy, exit
code 1. At once is 100 ms of processor time: a machine that does other work as well takes longer."""

import os
import resource
import subprocess

from harness import AMIROCTL, SOURCE, Case, main, sanitized

DBC = 'BU_: A\nBO_ 256 Engine: 8 A\n SG_ Speed : 0|16@1+ (1,0) [0|0] "rpm" A\nBO_ x Gear: 1 A\n'
JSON = '{"robot": "x", "messages": [{"name": "Engine", "id": "0x100", "fields": [{"name": "Speed", "byte": 0, "type": "u99"}]}]}'
OPERATOR = os.path.join(SOURCE, "examples", "guard.operator.json")

# LOG is a log, PICTURE a file that a picture would go to.
WORDS = [
    ("list",), ("info", "Engine"), ("listen",), ("decode", "LOG"), ("encode", "LOG"), ("record", "-o", "PICTURE"), ("replay", "LOG"),
    ("replay", "LOG", "--on-command"), ("stats", "LOG"), ("stats",), ("plot", "LOG", "Engine.Speed", "-o", "PICTURE"),
    ("analyse", "bus"), ("analyse", "trace", "LOG"), ("generate", "spec"), ("generate", "dbc"), ("generate", "cpp"), ("generate", "c"),
    ("generate", "wireshark"), ("generate", "markdown"), ("generate", "json-schema"), ("set", "Engine", "Speed=1"), ("sim",),
    ("run", "SCRIPT"), ("publish", "gyro"), ("once", "gyro"), ("stop",), ("convert", "LOG", "OUT"), ("operate", "OPERATOR"),
    ("operate", "OPERATOR", "--check"), ("serve",), ("doctor",), ("drive", "1m/s"),
]


class BrokenSpec(Case):
    def setUp(self):
        super().setUp()
        names = {"LOG": ("in.log", "(1.0) can0 100#0102000000000000\n"), "SCRIPT": ("in.script", "0s set Engine Speed=1\n")}
        self.paths = {"PICTURE": os.path.join(self.folder, "out.svg"), "OUT": os.path.join(self.folder, "out.mcap"), "OPERATOR": OPERATOR}
        for word, (name, text) in names.items():
            self.paths[word] = os.path.join(self.folder, name)
            with open(self.paths[word], "w", encoding="ascii") as file:
                file.write(text)

    def processor_time(self, spec, words):
        """Of the tool, which must refuse, the least of some runs if the first takes long: what else runs slows a processor. With what it said."""
        err, seconds = self.refused(spec, words)
        if seconds >= 0.1 and not sanitized():
            seconds = min(self.refused(spec, words)[1] for _ in range(4))
        return err, seconds

    def refused(self, spec, words):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([AMIROCTL, "--spec", spec, *(self.paths.get(word, word) for word in words)], env=self.environment, text=True,
                              stdin=subprocess.DEVNULL, capture_output=True, timeout=120, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.assertEqual(done.returncode, 1, (words, done.stdout, done.stderr))
        self.assertEqual(done.stdout, "", words)
        return done.stderr, (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)

    def test_every_verb_names_the_place_at_once(self):
        for name, text, place in (("broken.dbc", DBC, "broken.dbc:4: BO_"), ("broken.json", JSON, "broken.json:1:")):
            path = os.path.join(self.folder, name)
            with open(path, "w", encoding="ascii") as file:
                file.write(text)
            for words in WORDS:
                with self.subTest(words, spec=name):
                    err, seconds = self.processor_time(path, words)
                    self.assertIn(place, err)
                    self.assertNotIn("no bus", err)
                    if not sanitized():
                        self.assertLess(seconds, 0.1)

    def test_a_large_file_that_breaks_at_its_end(self):
        """7,000 signals, and the last statement is cut off."""
        path = os.path.join(self.folder, "large.dbc")
        with open(path, "w", encoding="ascii") as file:
            file.write("BU_: A\n")
            for number in range(875):
                file.write(f"BO_ {number + 1} Message_{number}: 8 A\n")
                file.writelines(f' SG_ Signal_{number}_{i} : {8 * i}|8@1+ (0.5,-40) [0|0] "V" A\n' for i in range(8))
            file.write('CM_ "never ends')
        for words in (("decode", "LOG"), ("list",), ("sim",)):
            err, seconds = self.processor_time(path, words)
            self.assertIn("large.dbc:", err)
            if not sanitized():
                self.assertLess(seconds, 0.1)

    def test_selectors_in_a_circle(self):
        """They lie over one another, too: whether they exclude each other has no answer."""
        path = os.path.join(self.folder, "circle.dbc")
        with open(path, "w", encoding="ascii") as file:
            file.write('BU_: A\nBO_ 257 M: 8 A\n SG_ S M : 0|4@1+ (1,0) [0|0] "" A\n SG_ T m1M : 4|4@1+ (1,0) [0|0] "" A\n'
                       ' SG_ U m1 : 8|32@1- (1,0) [0|0] "" A\n SG_ W m1 : 39|16@0+ (1,0) [0|0] "" A\nSG_MUL_VAL_ 257 S T 1-2;\n')
        for words in (("list",), ("decode", "LOG")):
            err, _ = self.processor_time(path, words)
            self.assertIn("go in a circle", err)


if __name__ == "__main__":
    main()
