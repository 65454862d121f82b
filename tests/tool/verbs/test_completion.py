"""Completion as a shell asks for it, in real shells. Needs bash, zsh and fish."""

import os
import shutil
import subprocess
import unittest

import harness
import operate_cases
from realtime import MOST_LATE

OTHER = os.path.join(harness.SOURCE, "examples", "other-robot", "topics.json")


class Words(harness.Case):
    def words(self, *line):
        out, _ = self.run_tool("completion", "--words", "--", *line)
        kind, *candidates = out.splitlines()
        return kind, [candidate.split("\t")[0] for candidate in candidates]

    def candidates(self, *line):
        kind, candidates = self.words(*line)
        self.assertEqual(kind, "words")
        return candidates

    def test_verbs(self):
        self.assertEqual(self.candidates("pub"), ["publish"])
        self.assertLessEqual({"list", "publish", "listen", "generate", "completion"}, set(self.candidates("")))
        self.assertLessEqual({"bus", "tasks", "chain"}, set(self.candidates("analyse", "")))
        self.assertEqual(self.candidates("help", "tr"), ["travel"])
        self.assertEqual(self.candidates("help", "travel", "tr"), [])
        # Every verb that --help lists.
        help_text, _ = self.run_tool("--help")
        listed = {line.split()[0].rstrip(",") for line in help_text.split("[Options]")[-1].splitlines()
                  if line.startswith("  ") and line[2].islower()}
        self.assertEqual(set(self.candidates("")), listed)

    def test_topics_and_aliases(self):
        self.assertEqual(self.candidates("publish", "gy"), ["gyroscope", "gyro"])
        self.assertNotIn("motors", self.candidates("publish", ""))
        self.assertIn("motors", self.candidates("info", ""))
        self.assertIn("led_8", self.candidates("listen", "gyro", "led"))
        self.assertEqual(self.candidates("stop", "a"), ["all", "accelerometer", "accel", "avoid", "ambient"])
        self.assertEqual(self.candidates("publish", "gyro", ""), [])
        self.assertEqual(self.candidates("send", ""), [])

    def test_fields_and_their_values(self):
        self.assertEqual(self.candidates("set", "motors", ""), ["x=", "z="])
        self.assertEqual(self.candidates("set", "floor_calibration", "action=m"), ["action=measure"])
        self.assertEqual(self.candidates("led", "1", "ma"), ["magenta"])
        self.assertIn("8", self.candidates("led", ""))

    def test_fields_by_their_names(self):
        self.assertEqual(self.candidates("listen", "--field", "odometry.v"), ["odometry.velocity.x", "odometry.velocity.z"])
        self.assertEqual(self.words("plot", "a.log", "gyroscope.z"), ("files", ["gyroscope.z"]))
        self.assertEqual(self.candidates("listen", "--where", "gyroscope.z"), ["gyroscope.z"])

    def test_words_of_which_there_is_a_list(self):
        self.assertEqual(self.candidates("convert", "a.log", "b.csv", "--to", "pcap"), ["pcapng", "pcap"])
        self.assertEqual(self.candidates("record", "--to=csv"), ["--to=csv"])
        self.assertEqual(self.words("sim", "--world", "la"), ("files", ["labyrinth"]))
        self.assertEqual(self.candidates("man", "pub"), ["publish"])

    def test_options_and_their_values(self):
        self.assertEqual(self.candidates("publish", "--prio"), ["--priority"])
        self.assertEqual(self.candidates("--b"), ["--bus"])
        self.assertIn("--bus", self.candidates("publish", "--"))
        self.assertIn("--pretty", self.candidates("listen", "--"))
        self.assertEqual(self.candidates("publish", "--priority", "h"), ["high"])
        self.assertEqual(self.candidates("publish", "--priority=h"), ["--priority=high"])
        self.assertIn("sim", self.candidates("--bus", ""))
        self.assertEqual(self.candidates("analyse", "bus", "--lengths", ""), ["generic", "exact"])
        self.assertEqual(self.candidates("sim", "--without", "li"), ["light_ring"])
        self.assertEqual(self.candidates("generate", "d"), ["dbc"])
        # The topic is that, whatever stands before it.
        self.assertEqual(self.candidates("--bus", "sim", "publish", "--priority", "high", "gyros"), ["gyroscope"])
        self.assertEqual(self.candidates("publish", "--", "gyros"), ["gyroscope"])

    def test_files(self):
        for line in (("--spec", ""), ("run", ""), ("generate", "dbc", "-o", ""), ("analyse", "chain", "")):
            self.assertEqual(self.words(*line)[0], "files", line)

    def test_another_robot(self):
        self.assertEqual(self.candidates("--spec", OTHER, "publish", "fo"), ["fork_status", "fork"])
        self.assertEqual(self.candidates("--spec=" + OTHER, "publish", "fo"), ["fork_status", "fork"])
        self.environment["AMIROCTL_SPEC"] = OTHER
        self.assertEqual(self.candidates("set", "wh"), ["wheels"])

    def test_fields_of_a_condition(self):
        car = os.path.join(os.environ["OCM_SOURCE_DIR"], "examples", "small_car.dbc")
        self.assertEqual(self.candidates("--spec", car, "decode", "--where", "Engine.To"), ["Engine.Torque"])
        self.assertIn("odometry.velocity.x", self.candidates("listen", "--where", "odometry."))

    def test_unknown_shells_are_refused(self):
        for arguments in ((), ("tcsh",), ("bash", "zsh")):
            out, err = self.run_tool("completion", *arguments, code=2)
            self.assertEqual(out, "")
            self.assertRegex(err, r"bash\|zsh\|fish|one of: bash, zsh, fish")


class Requests(operate_cases.Operating, Words):
    # An operator that does not answer within 300 ms is left out.
    most_late = MOST_LATE

    def test_where_a_request_leads(self):
        """Asked of the operator that runs, of the bus that is named or of any; there may be none."""
        self.start_sim()
        switch = ("completion", "--words", "--", "operator", "switch")
        self.assertEqual(self.run_tool(*switch, ""), ("words\n", ""))
        halt = operate_cases.HALT
        document = {**halt, "configurations": halt["configurations"] + [{"name": "slow", "streams": [operate_cases.ODOMETRY]}],
                    "transitions": halt["transitions"] + [{"from": start, "to": end, "on_request": True}
                                                          for start, end in (("driving", "slow"), ("driving", "halted"), ("slow", "halted"))]}
        self.operate(document=document)
        self.assertEqual(self.run_tool(*switch, "")[0], "words\nhalted\tfrom driving\nslow\tfrom driving\n")
        self.assertEqual(self.run_tool(*switch, "--bus", "sim", "s")[0], "words\nslow\tfrom driving\n")
        self.assertEqual(self.run_tool(*switch, "--bus=vcan7", "")[0], "words\n")


class Shells(harness.Case):
    def setUp(self):
        super().setUp()
        # Called by its name, as users call it.
        self.bin = os.path.join(self.folder, "bin")
        os.mkdir(self.bin)
        os.symlink(harness.AMIROCTL, os.path.join(self.bin, "amiroctl"))
        self.environment["PATH"] = self.bin + ":" + self.environment["PATH"]
        self.environment["TERM"] = "dumb"

    def shell(self, program, script):
        self.assertIsNotNone(shutil.which(program), f"{program} is missing: scripts/setup")
        done = subprocess.run([program, "-c", script] if program != "zsh" else ["zsh", "-f", "-c", script],
                              env=self.environment, capture_output=True, text=True, timeout=60, cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        return done.stdout.splitlines()

    def bash(self, line):
        """What bash would offer behind `line`: the function is called as readline does."""
        return self.shell("bash", f"""
            source <(amiroctl completion bash)
            complete -p amiroctl >/dev/null || exit 1
            compopt() {{ echo "compopt $*"; }}
            COMP_LINE='{line}'; COMP_POINT=${{#COMP_LINE}}
            _amiroctl
            printf '%s\\n' "${{COMPREPLY[@]}}"
        """)

    def test_bash(self):
        self.assertEqual(self.bash("amiroctl publish gy"), ["gyroscope", "gyro"])
        self.assertEqual(self.bash("amiroctl pub"), ["publish"])
        # bash replaces only what follows = or :
        self.assertEqual(self.bash("amiroctl publish gyro --priority=h"), ["high"])
        self.assertEqual(self.bash("amiroctl --bus slc"), ["compopt -o nospace", "slcan:"])
        self.assertEqual(self.bash("amiroctl set floor_calibration action=me"), ["measure"])
        self.assertEqual(self.bash("amiroctl run "), ["compopt -o default", ""])
        self.assertEqual(self.bash(f"amiroctl --spec {OTHER} publish fo"), ["fork_status", "fork"])

    def test_bash_after_quotes_a_tilde_and_redirections(self):
        shutil.copy(OTHER, os.path.join(self.folder, "my robot.json"))
        for line in ("--spec ~/my\\ robot.json publish fo", '--spec "my robot.json" publish fo', "stop --spec my\\ robot.json fo",
                     '--spec "' + self.folder + '/my robot.json" publish fo'):
            self.assertEqual(self.bash("amiroctl " + line), ["fork_status", "fork"], line)
        for line in ('publish "gy', "listen 2>errors gy", "listen >lines.txt 2>&1 gy", "listen < lines.txt gy", "listen &>both gy"):
            self.assertEqual(self.bash("amiroctl " + line), ["gyroscope", "gyro"], line)
        for line in ("listen > dr", "listen gyro >", "listen 2>dr", "listen >> "):
            self.assertEqual(self.bash("amiroctl " + line), ["compopt -o default", ""], line)
        self.assertEqual(self.bash('amiroctl publish gyro --priority="h'), ["high"])
        self.assertEqual(self.bash('amiroctl publish gyro "--priority=h'), ["--priority=high"])
        self.assertEqual(self.bash("~/bin/amiroctl publish gy"), ["gyroscope", "gyro"])

    def test_zsh(self):
        # compadd and _files as the completion system would have them: only they are put in place of the real ones.
        script = """
            compdef() { print -r -- "compdef $*" }
            compadd() { local -a given; given=("${(@P)@[-1]}"); print -rl -- "${given[@]}" }
            _files() { print -r -- files }
            source <(amiroctl completion zsh)
            words=(%s); CURRENT=${#words}; PREFIX=$words[-1]
            _amiroctl
        """
        self.assertEqual(self.shell("zsh", script % "amiroctl publish gy"),
                         ["compdef _amiroctl amiroctl", "gyroscope", "gyro"])
        self.assertEqual(self.shell("zsh", script % "amiroctl set motors ''")[1:], ["x=", "z="])
        self.assertEqual(self.shell("zsh", script % "amiroctl run ''")[1:], ["files"])
        # zsh gives words as they are typed.
        shutil.copy(OTHER, os.path.join(self.folder, "my robot.json"))
        for spec in (r"'~/my\ robot.json'", "'\"my robot.json\"'", r"'my\ robot.json'"):
            self.assertEqual(self.shell("zsh", script % f"amiroctl --spec {spec} publish fo")[1:], ["fork_status", "fork"], spec)
        self.assertEqual(self.shell("zsh", script % "'~/bin/amiroctl' publish gy")[1:], ["gyroscope", "gyro"])

    def test_zsh_loads_it(self):
        self.assertEqual(self.shell("zsh", """
            autoload -Uz compinit && compinit -u -D
            source <(amiroctl completion zsh)
            print -r -- $_comps[amiroctl]
        """), ["_amiroctl"])

    def test_fish(self):
        def offered(line):
            return [word.split("\t")[0] for word in
                    self.shell("fish", f"amiroctl completion fish | source; complete --do-complete '{line}'")]
        self.assertEqual(offered("amiroctl publish gy"), ["gyro", "gyroscope"])
        self.assertEqual(offered("amiroctl pub"), ["publish"])
        self.assertEqual(offered("amiroctl publish gyro --priority h"), ["high"])
        self.assertEqual(offered(f"amiroctl --spec {OTHER} publish fo"), ["fork", "fork_status"])
        open(os.path.join(self.folder, "tour.script"), "w").close()
        self.assertIn("tour.script", offered("amiroctl run to"))


if __name__ == "__main__":
    harness.main()
