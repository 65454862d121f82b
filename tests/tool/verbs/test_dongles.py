"""amiroctl at dongles that are not our central: each kind is found out, spoken to, and left as the next program needs it."""

import json
import time

from harness import Case, main, waiting
from played_central import Central, Robot
from played_dongles import BaseFirmware, Noise, Silent, Thesis
from realtime import MOST_LATE


class Dongles(Case):
    # Each answer has its time, in which the tool, the terminal and the dongle that is played are late one after the other.
    most_late = MOST_LATE

    def play(self, kind, *names):
        self.robots = [Robot(name, pose=(0.4 + 0.3 * i, 0.5, 0.0)) for i, name in enumerate(names or ["AVR"])]
        self.dongle = kind(self.folder, self.robots, link="dongle")
        self.addCleanup(self.dongle.close)
        return self.robots[0]

    def tool(self, verb, *arguments, code=0):
        for _ in range(5):  # a dongle that is played on a busy machine may say its list too late to be heard
            tool = self.start(verb, *arguments, "--central", self.dongle.path, "--scan", "200ms")
            out, err = tool.communicate(timeout=60)
            if "the central finds no robot" not in err:
                break
        dongle = self.dongle
        self.assertEqual(tool.returncode, code, f"{verb} {arguments}: {out}{err}\nthe dongle has obeyed {dongle.commands[-12:]}, and holds "
                                                f"{dongle.line!r} and {dongle.typed!r} for {dongle.target}; it runs: {dongle.thread.is_alive()}")
        return out, err

    def check_verbs(self, *options):
        robot = {}

        def stands():  # it has said so
            out, _ = self.tool("robots", "--json", "--listen", "500ms", *options)
            robot.update(json.loads(out.splitlines()[0]))
            return robot["state"] == "idle"

        waiting.until(stands, "the robot is idle")
        self.assertEqual((robot["robot"], robot["index"], robot["address"]), ("AVR", 0, "C00000000000"))
        self.assertEqual((robot["linked"], robot["confirmed"]), (True, True))
        self.assertEqual(robot["body"]["width_cm"], 20)
        out, _ = self.tool("goto", "AVR", "90", "20", *options)
        self.assertRegex(out, r"^AVR: x -?\d+ cm, y -?\d+ cm, heading -?\d+ deg\n$")
        self.assertIn("{U,90,20}", self.robots[0].heard)
        self.robots[0].heard.clear()
        self.assertEqual(self.tool("pause", "AVR", *options)[0], "AVR: paused\n")
        self.assertEqual(self.tool("unpause", "AVR", *options)[0], "AVR: goes on\n")
        waiting.until(lambda: self.dongle.target is None, "command mode")

    def check_the_base_firmware(self, prefixes):
        self.play(BaseFirmware)
        self.dongle.prefixes = prefixes
        self.check_verbs()
        self.assertEqual(self.dongle.commands.count("AT+CONN=0"), 1)  # the next verb takes the link over
        self.check_verbs("--dongle", "at")

    def test_the_base_firmware(self):
        self.check_the_base_firmware(prefixes=False)

    def test_the_base_firmware_with_prefixes(self):
        self.check_the_base_firmware(prefixes=True)

    def test_the_base_firmware_with_two_robots(self):
        self.play(BaseFirmware, "AVR", "Arduino")
        self.dongle.prefixes = True
        out, _ = self.tool("robots", "--json")
        self.assertEqual([json.loads(line)["robot"] for line in out.splitlines()], ["AVR", "Arduino"])
        self.tool("goto", "Arduino", "0", "10")
        self.assertIn("{U,0,10}", self.robots[1].heard)
        self.assertNotIn("{U,0,10}", self.robots[0].heard)

    def test_the_base_firmware_was_left_in_data_mode(self):
        self.play(BaseFirmware)
        self.tool("robots", "--listen", "100ms")
        self.dongle.target = self.robots[0]
        self.check_verbs()

    def check_left_in_data_mode(self, kind, word):
        """By a program that was killed; which kind it is, is said, and not asked."""
        self.play(kind)
        self.tool("robots", "--listen", "100ms", "--dongle", word)
        waiting.until(lambda: self.dongle.target is None, "command mode")
        self.dongle.target = self.robots[0]
        self.tool("pause", "AVR", "--dongle", word)

    def test_the_base_firmware_that_is_known_was_left_in_data_mode(self):
        self.check_left_in_data_mode(BaseFirmware, "at")

    def test_the_thesiss_own_that_is_known_was_left_in_data_mode(self):
        self.check_left_in_data_mode(Thesis, "thesis")

    def test_ours_that_is_known_was_left_in_data_mode(self):
        self.check_left_in_data_mode(Central, "ours")

    def test_the_base_firmware_cannot_reach_a_robot(self):
        robot = self.play(BaseFirmware)
        robot.reachable = False
        _, err = self.tool("goto", "AVR", "0", "10", code=1)
        self.assertIn("no link to", err)

    def test_the_thesiss_own(self):
        self.play(Thesis)
        self.check_verbs()
        self.assertNotIn("HANGS", self.dongle.commands)
        self.assertNotIn(".AT?.list", self.dongle.commands)  # a line end has gone before
        self.check_verbs("--dongle", "thesis")
        self.assertNotIn("HANGS", self.dongle.commands)

    def test_the_thesiss_own_cannot_reach_a_robot(self):
        robot = self.play(Thesis)
        robot.reachable = False
        _, err = self.tool("goto", "AVR", "0", "10", code=1)
        self.assertIn("no link to", err)

    def test_ours(self):
        self.play(Central)
        self.check_verbs()
        self.check_verbs("--dongle", "ours")

    def test_ours_answers_late(self):
        self.play(Central)
        self.dongle.slow = 1.5  # when it was asked last, for what the thesis's own would answer
        self.assertIn("AVR", self.tool("robots", "--listen", "500ms")[0])
        self.assertGreater(self.dongle.commands.count("stop"), 2, self.dongle.commands)  # settled as ours is

    def check_asked_no_further(self, kind, slow, word):
        """A dongle that answers so many s after the first question, in time: it never gets this word."""
        self.play(kind)
        heard = []
        for _ in range(5):  # a dongle that is played on a busy machine may answer too late
            self.dongle.slow = slow
            self.dongle.commands.clear()
            self.tool("robots", "--listen", "100ms")
            heard.append([command for command in self.dongle.commands if word in command])
            if not heard[-1]:
                break
        self.assertEqual(heard[-1], [], heard)

    def test_ours_is_not_asked_what_the_base_firmware_would_answer(self):
        self.check_asked_no_further(Central, 0.3, "AT?")

    def test_the_base_firmware_is_not_asked_what_the_thesiss_own_would_answer(self):
        self.check_asked_no_further(BaseFirmware, 0.9, "list")  # its own question comes after 0.7 s

    def test_noise_is_no_answer(self):
        self.play(Noise)
        _, err = self.run_tool("robots", "--central", self.dongle.path, "--baud", "9600", code=1)
        self.assertIn(f"nothing at {self.dongle.path} answers as a central does, at 9600 baud", err)

    def test_one_that_answers_nothing(self):
        self.play(Silent)
        begin = time.monotonic()
        _, err = self.tool("robots", code=1)
        self.assertLess(time.monotonic() - begin, 15)
        self.assertIn(f"nothing at {self.dongle.path} answers as a central does, at 38400 or 115200 baud", err)
        for remedy in ("--baud N", "--flow rtscts", "--dongle thesis"):
            self.assertIn(remedy, err)
        _, err = self.tool("robots", "--baud", "9600", "--flow", "rtscts", code=1)
        self.assertIn("at 9600 baud with RTS/CTS", err)
        self.assertIn("--flow none", err)

    def test_wrong_words(self):
        self.play(Central)
        for option in ("--flow", "--dongle"):
            _, err = self.tool("robots", option, "perhaps", code=2)
            self.assertIn(option, err)
        for baud in ("0", "4000001"):
            self.tool("robots", "--baud", baud, code=2)
        _, err = self.tool("robots", "--baud", "1", code=1)
        self.assertIn("no speed 1", err)


if __name__ == "__main__":
    main(together=True)
