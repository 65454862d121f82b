"""Mappers behind a central: robots, goto, pause, unpause, on a central that is played on a pseudo terminal."""

import fcntl
import json
import os
import re
import signal
import subprocess
import termios
import time

from harness import AMIROCTL, Case, main, waiting
from played_central import Central, Owner, Robot, row
from realtime import MOST_LATE


class Line(Case):
    """With a central and two robots at the place where the verbs look for one. What a robot has not heard is said again after a
    moment, in which the tool, the terminal and the central that is played are late one after the other."""

    most_late = MOST_LATE

    def setUp(self):
        super().setUp()
        self.avr = Robot("AVR")
        self.arduino = Robot("Arduino", pose=(0.6, 0.5, 1.5))
        self.central = Central(self.folder, [self.avr, self.arduino], link="ocm/central")
        self.addCleanup(self.central.close)

    def tool(self, *arguments, code=0):
        out, err = self.run_tool(*arguments, "--scan", "200ms", code=code)
        return out, err


class Robots(Line):
    def test_all_that_are_there(self):
        out, _ = self.tool("robots", "--json", "--listen", "3s")
        robots = [json.loads(line) for line in out.splitlines()]
        self.assertEqual([robot["robot"] for robot in robots], ["AVR", "Arduino"])
        for robot in robots:
            self.assertEqual(robot["state"], "idle")
            self.assertTrue(robot["linked"] and robot["confirmed"])
            self.assertEqual(robot["quality"], 1.0)
            self.assertEqual(robot["pose"], {"x_cm": 0, "y_cm": 0, "heading_deg": 0})
            self.assertEqual(robot["body"]["width_cm"], 20)
        linked = self.avr.heard.count("{S,CON}")  # more than once where the machine was late
        self.assertGreater(linked, 0)
        # The link stays; the next program takes it over, and asks for the handshake.
        # On a busy machine a second may bring where a robot is, and not yet that it stands.
        stands = re.compile(r"AVR +0 +C00000000000 +idle +0 0 0 +100 %")
        waiting.until(lambda: stands.search(self.tool("robots", "--listen", "1s")[0]), "the AVR is idle")
        self.assertEqual(self.avr.heard.count("{S,CON}"), linked)
        self.assertNotIn("drop 0", self.central.commands)
        out, _ = self.tool("robots", "--json")
        self.assertEqual([json.loads(line)["body"]["width_cm"] for line in out.splitlines()], [20, 20])
        # A robot with a program that does not know the question.
        self.avr.knows_who = False
        out, _ = self.tool("robots", "--json", "--listen", "1s")
        self.assertEqual([json.loads(line)["body"] is None for line in out.splitlines()], [True, False])

    def test_a_list_connects_no_robot(self):
        out, err = self.tool("robots", "--list")
        self.assertEqual((out, err), (
            "ROBOT    INDEX  ADDRESS       STATE          X Y [cm] DEG  QUALITY\n"
            "AVR      0      C00000000000  no link                   -        -\n"
            "Arduino  1      C00000000001  no link                   -        -\n", ""))
        self.assertFalse(self.avr.linked)

    def test_a_program_that_died_left_the_central_in_data_mode(self):
        port = os.open(self.central.path, os.O_RDWR | os.O_NOCTTY)
        os.write(port, b"start\n")
        waiting.until(lambda: "start" in self.central.commands, "it looks for robots")
        os.write(port, b"conn 0\n{U,9")
        waiting.until(lambda: self.central.target is not None, "data mode")
        os.close(port)
        out, _ = self.tool("robots", "--listen", "3s")
        self.assertRegex(out, r"AVR .* idle")
        self.assertEqual([line for line in self.avr.heard if line not in ("{S,CON}", "{S,WHO}")], [])

    def test_no_robot_is_there(self):
        self.central.robots = []
        for words in ((), ("--list",), ("--list", "--json")):
            _, err = self.tool("robots", *words, code=1)
            self.assertIn("amiroctl: robots: the central finds no robot\n", err)

    def test_a_robot_that_cannot_be_reached_is_told_and_the_others_are_shown(self):
        self.arduino.reachable = False
        out, err = self.tool("robots", "--listen", "3s")
        self.assertEqual(err, "robots: the central refuses Arduino: no link to 1\n")
        self.assertRegex(out, r"AVR .* idle")
        self.assertRegex(out, r"Arduino .* no link")
        # The only one that is meant: that is a failure.
        out, err = self.tool("goto", "Arduino", "0", "0", code=1)
        self.assertEqual((out, err), ("", "amiroctl: goto: the central refuses Arduino: no link to 1\n"
                                          "          is it near enough? `amiroctl robots` lists robots\n"))

    def test_a_central_that_does_not_answer(self):
        self.central.mute = True
        _, err = self.tool("robots", code=1)
        self.assertIn("does not answer", err)


    def test_looks_for_a_minute_at_most(self):
        _, err = self.run_tool("robots", "--scan", "61s", code=2)
        self.assertIn("robots: --scan 61s: a central that looks for robots says nothing to those that it has\n          write at most 60s", err)


class Goto(Line):
    def test_turns_drives_and_says_where_it_came_to(self):
        self.avr.x = self.avr.y = 0.5
        self.avr.start = (0.5, 0.5, 0.0)
        out, _ = self.tool("goto", "AVR", "90", "25cm")
        self.assertEqual(out, "AVR: x 0 cm, y 25 cm, heading 90 deg\n")
        self.assertEqual(self.avr.heard[-1], "{U,90,25}")
        out, _ = self.tool("goto", "0", "-90", "10")  # by its index
        self.assertEqual(out, "AVR: x 10 cm, y 25 cm, heading 0 deg\n")

    def test_something_in_front_of_it(self):
        self.avr.blocked_cm = 10
        self.avr.x = self.avr.y = 0.5
        self.avr.start = (0.5, 0.5, 0.0)
        out, err = self.tool("goto", "AVR", "0", "30", code=1)
        self.assertEqual(out, "AVR: x 10 cm, y 0 cm, heading 0 deg\n")
        self.assertEqual(err, "goto: AVR heard it, but stopped 20 cm and 0 deg away from there: is something in front of it?\n")

    def test_a_program_that_did_not_run_blames_no_obstacle(self):
        self.avr.blocked_cm, self.avr.speed = 20, 10
        tool = self.start("goto", "AVR", "0", "50", "--scan", "200ms")
        waiting.until(lambda: "{U,0,50}" in self.avr.heard, "it drives")
        tool.send_signal(signal.SIGSTOP)
        time.sleep(1.2)  # longer than a robot may have stood for want of a word
        tool.send_signal(signal.SIGCONT)
        _, err = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 1, err)
        self.assertRegex(err, r"goto: AVR heard it, but stopped 30 cm and 0 deg away from there: this program did not run for "
                              r"[1-9][.0-9]*s meanwhile; give the command again")
        self.assertNotIn("in front of it", err)

    def test_what_was_not_heard_is_said_again(self):
        self.avr.x = self.avr.y = 0.5
        self.avr.start = (0.5, 0.5, 0.0)
        self.avr.loses = 3
        out, err = self.tool("goto", "AVR", "90", "25")
        self.assertEqual((out, err), ("AVR: x 0 cm, y 25 cm, heading 90 deg\n", ""))
        self.assertEqual(self.avr.heard[1:], ["{U,90,25}"] * 4)

    def test_a_long_way_is_driven_in_legs(self):
        self.avr.room = (0.0, 0.0, 4.0, 1.0)
        self.avr.y = 0.5
        self.avr.start = (0.0, 0.5, 0.0)
        out, _ = self.tool("goto", "AVR", "0", "150")
        self.assertEqual(out, "AVR: x 150 cm, y 0 cm, heading 0 deg\n")
        self.assertEqual(self.avr.heard[1:], ["{U,0,50}"] * 3)

    def test_not_heard_is_no_obstacle(self):
        self.avr.loses = 1000
        out, err = self.tool("goto", "AVR", "90", "25", "--timeout", "3s", code=1)
        self.assertEqual(out, "")
        self.assertRegex(err, r"AVR has not heard it after 3s \(said \d+ times; 100 % of its sentences come whole\); "
                              "it was stopped\n          bring the central nearer, or give it more time: --timeout 120s\n")
        self.assertNotIn("in front of it", err)

    def test_a_robot_that_does_not_say_where_it_is_goes_nowhere(self):
        self.avr.mumbles = True
        out, err = self.tool("goto", "AVR", "90", "25", "--timeout", "2s", code=1)
        self.assertEqual(out, "")
        self.assertIn("does not say where it is, so it was not sent anywhere", err)
        self.assertNotIn("{U,90,25}", self.avr.heard)

    def test_a_stop_is_said_until_it_is_heard(self):
        self.avr.speed = 1
        self.tool("goto", "AVR", "90", "50", "--no-wait")
        self.avr.loses = 5
        self.tool("goto", "AVR", "0", "0")
        self.assertEqual(self.avr.loses, 0)
        begin = self.avr.heard.index("{U,0,0}")  # the set point before it may be said twice, too
        self.assertEqual(self.avr.heard[begin:], ["{U,0,0}"] * 6)

    def test_a_stop_says_where_the_robot_came_to_rest(self):
        """It says so behind its idle, and what it has said before is of where it was."""
        self.avr.x = self.avr.y = 0.5
        self.avr.start = (0.5, 0.5, 0.0)
        self.avr.speed = 1
        self.tool("goto", "AVR", "0", "20", "--no-wait")
        self.avr.slides_cm = 7
        out, _ = self.tool("goto", "AVR", "0", "0")
        self.assertEqual(out, "AVR: x 27 cm, y 0 cm, heading 0 deg\n")

    def test_a_stop_that_no_robot_hears_fails(self):
        self.tool("robots", "--listen", "100ms")
        self.avr.silent = True
        _, err = self.run_tool("goto", "AVR", "0", "0", "--timeout", "1s", "--scan", "200ms", code=1)
        self.assertIn("says nothing", err)

    def test_does_not_wait_longer_than_until_it_is_heard(self):
        self.avr.speed = 1
        self.avr.loses = 1
        begin = time.monotonic()
        out, _ = self.tool("goto", "AVR", "90", "50", "--no-wait")
        self.assertEqual(out, "")
        self.assertLess(time.monotonic() - begin, 12)
        self.assertEqual(self.avr.heard[1:], ["{U,90,50}"] * 2)
        self.avr.loses = 1000
        _, err = self.tool("goto", "AVR", "0", "20", "--no-wait", "--timeout", "2s", code=1)
        self.assertIn("has not heard it", err)

    def test_does_not_leave_a_robot_alone_for_longer_than_a_leg(self):
        for distance in ("61", "-61"):
            _, err = self.run_tool("goto", "AVR", "0", distance, "--no-wait", code=2)
            self.assertIn("at most 60 cm", err)

    def test_does_not_arrive_in_time_and_is_stopped(self):
        self.avr.speed = 1
        _, err = self.tool("goto", "AVR", "0", "50", "--timeout", "3s", code=1)  # time enough to be heard
        self.assertTrue(err.endswith("amiroctl: goto: AVR has not arrived after 3s; it was stopped\n"
                                     "          give it more time: --timeout 120s\n"), err)
        waiting.until(lambda: self.avr.heard[-1] == "{U,0,0}", "the robot is stopped")

    def on_the_way(self):
        tool = self.start("goto", "AVR", "0", "50", "--scan", "200ms")
        waiting.until(lambda: "{U,0,50}" in self.avr.heard, "the set point")
        return tool

    def test_interrupted_it_stops_the_robot(self):
        self.avr.speed = 1
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            with self.subTest(number=number):
                self.avr.heard.clear()
                tool = self.on_the_way()
                self.avr.loses = 3
                self.interrupt(tool, number)
                self.assertEqual(tool.returncode, 128 + number)
                self.assertEqual(self.avr.loses, 0)
                self.assertEqual(self.avr.heard[-4:], ["{U,0,0}"] * 4)

    def test_a_second_signal_ends_the_stop_loudly(self):
        self.avr.speed = 1
        tool = self.on_the_way()
        self.avr.loses = 1000
        tool.send_signal(signal.SIGINT)
        waiting.until(lambda: self.avr.heard[-1] == "{U,0,0}", "the robot is stopped")
        _, err = self.interrupt(tool)
        self.assertEqual(tool.returncode, 130)
        self.assertRegex(err, r"AVR may still drive: nothing shows that it has heard the stop, which was said \d+ times?; "
                              "its leg ends after 60 cm")

    def test_the_link_is_lost_on_the_way(self):
        self.avr.speed = 1
        tool = self.on_the_way()
        self.central.drop(self.avr)
        _, err = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 1)
        self.assertIn("AVR is lost: its link is gone\n"
                      "          a robot without a link stops; it can be connected again once it is near enough\n", err)

    def test_a_robot_that_falls_silent(self):
        self.avr.speed = 1
        tool = self.on_the_way()
        self.avr.silent = True
        _, err = tool.communicate(timeout=60)  # the stop is said for 20 s
        self.assertEqual(tool.returncode, 1)
        self.assertIn("said nothing for its deadline; it may still drive", err)
        self.assertGreater(self.avr.heard.count("{U,0,0}"), 20)

    def test_wrong_words(self):
        for words, text in ((["AVR", "north", "5"], "ANGLE 'north'"), (["AVR", "361", "5"], "-360 to 360"),
                            (["AVR", "90", "4e9"], "DISTANCE '4e9'"), (["AVR", "90", "5.5"], "DISTANCE '5.5'"),
                            (["AVR", "90", "99999999999999999999"], "DISTANCE"), (["AVR", "90", ""], "an empty word behind '90'"),
                            (["AVR", "90"], "distance"), (["AVR", "90", "5", "--timeout", "soon"], "soon")):
            with self.subTest(words=words):
                _, err = self.run_tool("goto", *words, code=2)
                self.assertIn(text.lower(), err.lower())

    def test_an_unknown_robot(self):
        _, err = self.tool("goto", "Ghost", "0", "0", code=1)
        self.assertIn("no robot 'Ghost'", err)
        self.assertIn("it finds AVR (index 0, address C00000000000), Arduino (index 1, address C00000000001)", err)
        _, err = self.tool("pause", "AVR", "Ghost", code=1)
        self.assertIn("it finds AVR (index 0", err)
        self.assertFalse(self.avr.paused)

    def test_two_robots_of_one_name(self):
        self.arduino.name = "AVR"
        _, err = self.tool("goto", "AVR", "0", "0", code=2)
        self.assertIn("2 robots are called 'AVR'", err)
        self.assertIn("AVR (index 0, address C00000000000), AVR (index 1, address C00000000001)", err)
        self.tool("goto", "C00000000001", "10", "0")
        self.assertEqual(self.arduino.heard[-1], "{U,10,0}")


class Pause(Line):
    def test_pauses_and_goes_on(self):
        self.assertEqual(self.tool("pause", "AVR", "AVR"), ("AVR: paused\n", ""))  # named twice it is one
        self.assertTrue(self.avr.paused)
        self.assertFalse(self.arduino.paused)
        # It says where it came to, for it goes on while it drives; then it is paused again.
        out, _ = self.tool("goto", "AVR", "0", "5")
        self.assertEqual(out, "AVR: x 5 cm, y 0 cm, heading 0 deg\n")
        self.assertTrue(self.avr.paused)
        # It is asked behind each pause what it does, so that no more are said than it needs.
        self.assertNotIn(("{S,PAU}", "{S,PAU}"), list(zip(self.avr.heard, self.avr.heard[1:])))
        self.tool("goto", "AVR", "0", "0")  # a stop ends no pause
        self.assertTrue(self.avr.paused)
        self.assertRegex(self.tool("robots", "--listen", "1s")[0], r"AVR .* paused")
        self.assertEqual(self.tool("unpause", "all")[0], "AVR: goes on\nArduino: goes on\n")
        self.assertFalse(self.avr.paused)

    def test_a_robot_that_says_where_it_is_is_not_paused_behind_a_drive(self):
        self.avr.repeats_idle = True
        out, _ = self.tool("goto", "AVR", "0", "5")
        self.assertEqual(out, "AVR: x 5 cm, y 0 cm, heading 0 deg\n")
        self.assertNotIn("{S,PAU}", self.avr.heard)

    def test_a_robot_that_cannot_be_reached_is_a_failure_and_the_others_are_held(self):
        self.arduino.reachable = False
        for words in (["AVR", "Arduino"], ["all"]):
            self.assertEqual(self.tool("pause", *words, code=1), ("AVR: paused\n", "pause: the central refuses Arduino: no link to 1\npause: 1 robot not reached\n"))
            self.assertTrue(self.avr.paused)
            self.assertEqual(self.tool("unpause", *words, code=1), ("AVR: goes on\n", "unpause: the central refuses Arduino: no link to 1\nunpause: 1 robot not reached\n"))
        self.assertEqual(self.tool("pause", "AVR"), ("AVR: paused\n", ""))

    def test_a_robot_that_does_not_listen(self):
        self.tool("robots")
        self.avr.deaf = True
        _, err = self.tool("pause", "AVR", code=1)
        self.assertIn("sends updates still", err)
        self.assertGreater(self.avr.heard.count("{S,PAU}"), 2)


class OnALineOfAnotherProgram(Line):
    """That program is played, and what it says of the robot. An update comes each time that it is asked: the robot is not paused."""

    def setUp(self):
        super().setUp()
        self.owner = Owner(os.path.join(self.folder, "ocm"), self.central.path)
        self.addCleanup(self.owner.close)

    def test_a_robot_on_a_bad_link_goes_on_and_is_warned_about(self):
        for values, said in (({}, ""),
                             ({"advice": "bad_link", "quality": 419}, "unpause: the link to AVR is bad: 41 % of its sentences come whole; "
                              "bring the central or the robot nearer\n"),
                             ({"advice": "far_away"}, "unpause: AVR is almost out of the radio's range; bring the central or the robot nearer\n")):
            with self.subTest(values=values):
                self.owner.robot = lambda heard, values=values: row(updated=len(heard), **values)
                self.assertEqual(self.run_tool("unpause", "AVR"), ("AVR: goes on\n", said))

    def test_a_robot_that_is_lost_neither_pauses_nor_goes_on(self):
        self.owner.robot = lambda heard: row(lost=1)
        for verb in ("pause", "unpause"):
            self.assertEqual(self.run_tool(verb, "AVR", code=1), ("", f"{verb}: AVR is lost\n"))

    def test_a_robot_whose_link_was_gone_for_a_while_is_sent_nowhere(self):
        self.owner.robot = lambda heard: row(updated=len(heard), order=int("go 0 90 50" in heard))
        out, err = self.run_tool("goto", "AVR", "90", "50", code=1)
        self.assertEqual((out, err), ("", "amiroctl: goto: the link to AVR was gone for a while; a robot without a link stops\n"
                                          "          say it again\n"))

    def test_a_stop_that_nothing_shows_in_time(self):
        """It is said once more at the end, and heard then."""
        self.owner.robot = lambda heard: row(order=int("stop 0" in heard), progress=("none", "stopping", "stopped")[min(2, heard.count("stop 0"))])
        out, err = self.run_tool("goto", "AVR", "0", "0", "--timeout", "1ms", code=1)
        self.assertEqual((out, err), ("", "amiroctl: goto: nothing shows within 1ms that AVR has heard the stop\n"
                                          "          bring the central nearer, or switch the robot off\n"))


class BadLinks(Line):
    """Beyond 20 cm half of the packets of a robot are lost."""

    def setUp(self):
        super().setUp()
        self.avr.room = (-2.0, -2.0, 4.0, 4.0)
        self.avr.bad_beyond_cm = 20

    def test_are_warned_about(self):
        self.avr.speed = 10
        out, err = self.tool("goto", "AVR", "0", "50")
        self.assertEqual(out, "AVR: x 50 cm, y 0 cm, heading 0 deg\n")
        self.assertRegex(err, r"^goto: the link to AVR is bad: [1-6]\d % of its sentences come whole; bring the central or the "
                              r"robot nearer\n$")
        out, err = self.tool("robots", "--listen", "3s", "--json")
        self.assertEqual([json.loads(line)["call_back"] for line in out.splitlines()], ["bad_link", None])
        self.assertRegex(err, r"^robots: the link to AVR is bad")
        self.avr.bad_beyond_cm = None
        out, err = self.tool("robots", "--listen", "3s", "--json")
        self.assertEqual([json.loads(line)["call_back"] for line in out.splitlines()], [None, None])
        self.assertEqual(err, "")

    def test_call_back(self):
        self.avr.speed = 5
        out, err = self.tool("goto", "AVR", "0", "50", "--call-back", code=1)
        self.assertRegex(err, r"goto: the link to AVR is bad: [1-6]\d % of its sentences come whole; it is called back\n")
        self.assertRegex(err, r"of its sentences come whole: it was called back\n"
                              "          bring the central nearer; or drop --call-back: then only a message says so\n")
        x, y = map(int, re.match(r"AVR: x (-?\d+) cm, y (-?\d+) cm", out).groups())
        self.assertLess(abs(x) + abs(y), 6)
        drives = [words for words in self.avr.heard if words.startswith("{U,")]
        self.assertEqual(drives[0], "{U,0,50}")
        self.assertEqual(drives[1], "{U,0,0}")  # in the middle of the leg
        self.assertIn(drives[-1], ("{U,0,0}", "{U,180,50}", "{U,-180,50}"))

    def test_a_robot_is_not_sent_on_a_bad_link(self):
        self.avr.x = self.avr.y = 0.5  # an update from there takes two packets: one that is lost is missed
        keeper = self.start("central", "--own", "--scan", "200ms")
        waiting.until(lambda: "Ctrl-C ends it" in keeper.stderr.readline(), "it has the line")
        waiting.until(lambda: '"call_back":"bad_link"' in self.tool("robots", "--listen", "100ms", "--json")[0], "it is bad")
        _, err = self.tool("goto", "AVR", "0", "50", "--call-back", code=1)
        self.assertRegex(err, "the link to AVR is bad: .* so it was not sent")
        self.assertNotIn("{U,0,50}", self.avr.heard)
        _, err = self.tool("goto", "AVR", "0", "0", "--call-back")  # a stop is said
        self.assertRegex(err, r"(?m)^goto: the link to AVR is bad: ")

    def test_nobody_would_watch(self):
        _, err = self.run_tool("goto", "AVR", "0", "20", "--no-wait", "--call-back", code=2)
        self.assertIn("no program would watch the link", err)


class TheLine(Line):
    def test_a_program_of_others_has_the_line(self):
        port = os.open(self.central.path, os.O_RDWR | os.O_NOCTTY)
        fcntl.ioctl(port, termios.TIOCEXCL)
        fcntl.flock(port, fcntl.LOCK_EX)
        _, err = self.tool("robots", code=1)
        self.assertIn("in use by another program", err)
        os.close(port)
        self.tool("robots", "--listen", "100ms")

    def test_the_dongle_is_unplugged(self):
        tool = self.start("robots", "--listen", "30s", "--scan", "200ms")
        waiting.until(lambda: self.avr.linked, "a link")
        self.central.unplug()
        _, err = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 1)
        self.assertIn("is gone", err)

    def test_another_path(self):
        self.tool("robots", "--central", os.path.realpath(self.central.path), "--listen", "100ms")
        _, err = self.run_tool("robots", "--central", "/dev/null", code=1)
        self.assertIn("no serial device", err)
        _, err = self.run_tool("robots", "--baud", "7", "--central", self.central.path, code=1)
        self.assertIn("no speed 7", err)

    def test_a_link_that_a_killed_program_has_left(self):
        # It may lead to a terminal of another user by now: not a byte goes there.
        self.central.abandon()
        for words in (["robots"], ["goto", "AVR", "0", "0"], ["pause", "AVR"], ["unpause", "AVR"], ["map", "a.svg"]):
            _, err = self.tool(*words, code=1)
            self.assertIn("there is no central at", err)
            self.assertIn("amiroctl sim --robots 2", err)
        self.assertEqual(self.central.commands, [])
        # A user who names it means it.
        self.tool("robots", "--central", self.central.path, "--listen", "100ms")
        self.assertIn("list", self.central.commands)

    def test_the_central_is_left_in_command_mode(self):
        self.tool("goto", "AVR", "0", "0")
        waiting.until(lambda: self.central.target is None, "command mode")

    def test_a_full_disk(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([AMIROCTL, "robots", "--listen", "100ms", "--scan", "200ms"], env=self.environment,
                                  stdin=subprocess.DEVNULL, stdout=full, stderr=subprocess.PIPE, text=True, timeout=30,
                                  check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("No space left on device", done.stderr)

    def test_terminated(self):
        tool = self.start("robots", "--listen", "30s", "--scan", "200ms")
        waiting.until(lambda: self.avr.linked, "a link")
        self.interrupt(tool, signal.SIGTERM)
        self.assertEqual(tool.returncode, 143)


class NoCentral(Case):
    def test_says_how_to_get_one(self):
        for words in (["robots"], ["robots", "--scan", "60s"], ["goto", "AVR", "0", "0"], ["pause", "AVR"], ["unpause", "AVR"], ["map", "a.svg"]):
            _, err = self.run_tool(*words, code=1)
            self.assertIn("there is no central", err)
            self.assertIn("amiroctl sim --robots 2", err)


if __name__ == "__main__":
    main(together=True)
