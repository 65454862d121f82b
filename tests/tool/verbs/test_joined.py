"""Many programs on one central's line: the first has it, the others join; who stops what, and what each says when one
of them dies, hangs, or says nonsense."""

import fcntl
import glob
import json
import os
import re
import signal
import socket
import stat
import time

from harness import Case, main, waiting
from played_central import Owner
from test_fleet import Line


class Joined(Line):
    """A program has the line, and its robots are linked."""

    def setUp(self):
        super().setUp()
        self.avr.room = self.arduino.room = (-2.0, -2.0, 4.0, 4.0)

    def own(self, *arguments):
        owner = self.start(*(arguments or ("robots", "--listen", "100s")), "--scan", "200ms")
        waiting.until(lambda: self.avr.linked and self.avr.confirmed, "the owner has linked its robots")
        return owner

    def line_socket(self):
        found = glob.glob(os.path.join(self.folder, "ocm", "line-*.sock"))
        self.assertEqual(len(found), 1)
        return found[0]

    def call(self, greet=True, owner="robots"):
        """A connection to the program that has the line, as other programs have one."""
        caller = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.addCleanup(caller.close)
        caller.settimeout(30)
        caller.connect(self.line_socket())
        if greet:
            self.assertEqual(self.ask(caller, b"hello 1 stranger"), b"ok\n" + owner.encode())
        return caller

    @staticmethod
    def ask(caller, request):
        caller.send(request)
        return caller.recv(65536)

    def drive(self, *arguments):
        """A slow drive that has begun."""
        self.avr.speed = 1
        before = self.avr.heard.count("{U,90,50}")
        tool = self.start("goto", "AVR", "90", "50", *arguments)
        waiting.until(lambda: self.avr.heard.count("{U,90,50}") > before, "it drives")
        return tool

    def stopped(self):
        waiting.until(lambda: self.avr.heard[-1] == "{U,0,0}", "the robot is stopped")

    def ended(self, tool, code):
        out, err = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, code, out + err)
        return out, err


class TogetherOnALine(Joined):
    def test_robots_and_goto_while_another_has_the_line(self):
        self.own()
        linked = self.avr.heard.count("{S,CON}")  # more than once where the machine was late
        out, err = self.tool("robots", "--json")
        self.assertEqual(err, "")
        robots = [json.loads(line) for line in out.splitlines()]
        self.assertEqual([(robot["robot"], robot["state"], robot["held"]) for robot in robots],
                         [("AVR", "idle", False), ("Arduino", "idle", False)])
        self.assertEqual(robots[0]["body"]["width_cm"], 20)
        out, err = self.tool("goto", "AVR", "90", "25")
        self.assertEqual((out, err), ("AVR: x 0 cm, y 25 cm, heading 90 deg\n", ""))
        self.assertEqual(self.tool("pause", "all")[0], "AVR: paused\nArduino: paused\n")
        self.assertTrue(self.avr.paused and self.arduino.paused)
        self.assertEqual(self.tool("unpause", "AVR")[0], "AVR: goes on\n")
        out, _ = self.tool("calibrate", "AVR")
        self.assertIn("AVR: good: within 1 deg", out)
        self.assertIn("AVR: good: within 1 deg", self.tool("calibrate", "AVR", "--show")[0])
        _, err = self.tool("goto", "Missing", "0", "0", code=1)
        self.assertIn("it finds AVR (index 0, address C00000000000)", err)
        self.assertEqual(self.avr.heard.count("{S,CON}"), linked, "who joins links no robot again")

    def test_only_this_user_can_join(self):
        self.own()
        self.assertEqual(stat.S_IMODE(os.stat(self.line_socket()).st_mode), 0o600)
        self.assertEqual(stat.S_IMODE(os.stat(os.path.dirname(self.line_socket())).st_mode), 0o700)

    def test_the_line_by_another_name_of_it(self):
        owner = self.own()
        out, _ = self.tool("robots", "--central", os.path.realpath(self.central.path))
        self.assertRegex(out, r"AVR .* idle")
        self.interrupt(owner)
        self.assertEqual(glob.glob(os.path.join(self.folder, "ocm", "line-*.sock")), [])

    def test_a_robot_that_cannot_be_reached(self):
        self.arduino.reachable = False
        self.own()
        out, err = self.tool("goto", "Arduino", "0", "5", code=1)
        self.assertEqual((out, err), ("", "amiroctl: goto: the central refuses Arduino: no link to 1\n"
                                          "          is it near enough? `amiroctl robots` lists robots\n"))

    def test_programs_that_start_together(self):
        tools = [self.start("robots", "--scan", "200ms", "--listen", "3s") for _ in range(6)]
        for tool in tools:
            out, _ = self.ended(tool, 0)
            self.assertRegex(out, r"AVR .* idle")

    def test_a_lossy_radio(self):
        self.own()
        self.avr.loses = 3
        out, err = self.tool("goto", "AVR", "90", "25")
        self.assertEqual((out, err), ("AVR: x 0 cm, y 25 cm, heading 90 deg\n", ""))
        self.assertEqual(self.avr.heard[-4:], ["{U,90,25}"] * 4)
        self.avr.loses = 1000
        _, err = self.tool("goto", "AVR", "90", "25", "--timeout", "3s", code=1)
        self.assertRegex(err, r"AVR has not heard it after 3s \(said \d+ times; 100 % of its sentences come whole\)")

    def test_does_not_wait(self):
        self.own()
        self.avr.speed = 5
        self.tool("goto", "AVR", "90", "20", "--no-wait")
        time.sleep(1)  # a stop would be said at once
        self.assertEqual(self.avr.heard[-1], "{U,90,20}")

    def test_a_map_has_the_line_for_itself(self):
        self.own()
        _, err = self.tool("map", os.path.join(self.folder, "a.svg"), code=1)
        self.assertRegex(err, r"map: robots \(process \d+\) has the central's line")
        _, err = self.tool("map", os.path.join(self.folder, "a.svg"), "--watch", code=1)
        self.assertRegex(err, r"robots \(process \d+\) draws no map")


class HowLongALookTakes(Line):
    def test_three_seconds_unless_told_otherwise(self):
        """The program that has the line is played: it hears for how many milliseconds the central is to look for robots."""
        owner = Owner(os.path.join(self.folder, "ocm"), self.central.path)
        self.addCleanup(owner.close)
        for options, look in (((), "scan 3000"), (("--scan", "700ms"), "scan 700")):
            for verb in (("robots",), ("robots", "--list"), ("goto", "AVR", "90", "50")):
                owner.heard.clear()
                _, err = self.run_tool(*verb, *options, code=1)
                self.assertIn(f"{verb[0]}: the central finds no robot", err)
                # What is listed already is asked for first, without a look.
                self.assertEqual(owner.looks(), [look] if "--list" in verb else ["scan 0", look], verb)


class WhetherARobotIsPaused(Line):
    def test_it_has_said_for_a_second_only_that_it_stands_or_lives(self):
        """One of which nothing comes any more may just have gone out of reach. The program that has the line is played; sent somewhere its
        robot is there at once, and paused it is lost."""
        owner = Owner(os.path.join(self.folder, "ocm"), self.central.path)
        self.addCleanup(owner.close)

        def row(heard, last, later):
            sent = any(request.startswith("go ") for request in heard)
            values = {"index": 0, "address": "C00000000000", "name": "AVR", "linked": 1, "confirmed": 1, "idle": 1, "located": 1,
                      "lost": int("pause 0" in heard), "update": "0,0,0,0,0,0,0,0", "updated": 5_000_000_000, "heard": 5_000_000_000 + later,
                      "last": last, "progress": "reached" if sent else "none", "order": int(sent)}
            return "\t".join(f"{key}={value}" for key, value in values.items()) + "\n"
        for last, later, paused in (("idle", 999_999_999, False), ("pong", 1_000_000_000, True), ("handshake", 2_000_000_000, False)):
            with self.subTest(last=last, later=later):
                owner.heard.clear()
                owner.robot = lambda heard, last=last, later=later: row(heard, last, later)
                out, err = self.run_tool("goto", "AVR", "90", "50")
                self.assertEqual(out, "AVR: x 0 cm, y 0 cm, heading 0 deg\n")
                self.assertEqual(err, "goto: AVR was paused, and sends updates now\n" if paused else "")
                self.assertEqual("pause 0" in owner.heard, paused)


class HowLongARobotMayBeSilent(Line):
    def test_eight_seconds_behind_its_link(self):
        """It measures its gyro first. The program that has the line is played; its robot has a link, and says nothing."""
        owner = Owner(os.path.join(self.folder, "ocm"), self.central.path)
        self.addCleanup(owner.close)
        owner.robot = lambda heard: "index=0\taddress=C00000000000\tname=AVR\tlinked=1\n"
        begin = time.monotonic()
        _, err = self.run_tool("goto", "AVR", "90", "50", code=1)
        self.assertGreaterEqual(time.monotonic() - begin, 8)
        self.assertEqual(err, "amiroctl: goto: AVR has a link, but says nothing\n          switch it off and on: its program may hang\n")


class AMapIsAskedForAtTheEnd(Joined):
    """The line is served until it is closed, and then what draws the map may be gone."""

    def test_of_a_map(self):
        # Drawing its file holds it after the last robot has stopped and before it leaves the line.
        hold, held = os.path.join(self.folder, "hold"), os.path.join(self.folder, "held")
        programs = os.path.join(self.folder, "bin")
        os.mkdir(programs)
        with open(os.path.join(programs, "gnuplot"), "w", encoding="ascii") as file:
            file.write("#!/bin/sh\ncat >/dev/null\n"
                       f"while [ -e {hold} ]; do touch {held}; sleep 0.02; done\necho '<svg/>'\n")
        os.chmod(file.name, 0o755)
        self.environment["PATH"] = programs + ":" + self.environment["PATH"]
        tool = self.start("map", os.path.join(self.folder, "a.svg"), "--robots", "AVR", "--scan", "200ms")
        waiting.until(lambda: self.avr.linked and self.avr.confirmed, "the map has linked its robot")
        caller = self.call(owner="map")
        waiting.until(lambda: b"P5" in self.ask(caller, b"map pgm"), "there is a map")
        open(hold, "w", encoding="ascii").close()
        tool.send_signal(signal.SIGINT)
        waiting.until(lambda: os.path.exists(held), "it draws its file")
        caller.send(b"map pgm")
        os.remove(hold)
        self.assertEqual(caller.recv(65536), b"ok\n0\n")  # none any more
        self.ended(tool, 130)

    def test_of_a_page(self):
        page = self.start("serve", "robots", "--port", "0", "--scan", "200ms", "--start", "AVR=0,0,0",
                          "--start", "Arduino=0.6,0.5,90")
        self.assertIn("http://", page.stdout.readline())
        tool = self.drive()
        caller = self.call(owner="serve")
        waiting.until(lambda: b"P5" in self.ask(caller, b"map pgm"), "there is a map")
        self.avr.loses = 1000  # as long as it has not heard the stop, the line is served
        page.send_signal(signal.SIGINT)
        waiting.until(lambda: self.avr.heard[-1] == "{U,0,0}", "its robot is stopped")
        for form in (b"pgm", b"svg", b"grid"):
            with self.subTest(form=form):
                self.assertEqual(self.ask(caller, b"map " + form), b"ok\n0\n")
        self.avr.loses = 0
        self.ended(page, 130)
        self.ended(tool, 1)


class WhoStopsWhat(Joined):
    def test_interrupted_it_stops_the_robot(self):
        self.own()
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number=number):
                tool = self.drive()
                self.avr.loses = 3
                self.interrupt(tool, number)
                self.assertEqual(tool.returncode, 128 + number)
                self.assertEqual(self.avr.loses, 0)
                self.assertEqual(self.avr.heard[-4:], ["{U,0,0}"] * 4)

    def test_killed_it_leaves_no_robot_that_drives(self):
        self.own()
        tool = self.drive()
        self.avr.loses = 3
        tool.kill()
        self.stopped()
        waiting.until(lambda: self.avr.loses == 0, "the stop is repeated")
        self.assertRegex(self.tool("robots", "--listen", "1s")[0], r"AVR .* idle")

    def test_stopped_it_leaves_no_robot_that_drives(self):
        self.own()
        tool = self.drive()
        tool.send_signal(signal.SIGSTOP)
        self.stopped()
        tool.send_signal(signal.SIGCONT)
        _, err = self.ended(tool, 1)
        self.assertRegex(err, r"another program has stopped AVR or sent it: robots \(process \d+\): "
                              r"goto \(process \d+\) said nothing for 2 s")

    def test_another_program_stops_it(self):
        self.own()
        tool = self.drive()
        self.assertEqual(self.tool("goto", "AVR", "0", "0")[1], "")
        _, err = self.ended(tool, 1)
        self.assertRegex(err, r"goto: another program has stopped AVR or sent it: goto \(process \d+\)")

    def test_another_program_stops_what_the_owner_drives(self):
        self.avr.speed = 1
        owner = self.own("goto", "AVR", "90", "50")
        waiting.until(lambda: "{U,90,50}" in self.avr.heard, "it drives")
        self.assertEqual(self.tool("goto", "AVR", "0", "0")[1], "")
        _, err = self.ended(owner, 1)
        self.assertRegex(err, r"goto: another program has stopped AVR or sent it: goto \(process \d+\)")

    def test_two_programs_do_not_send_one_robot(self):
        self.own()
        tool = self.drive()
        _, err = self.tool("goto", "AVR", "0", "5", code=1)
        self.assertRegex(err, r"goto: AVR is driven by goto \(process \d+\)\s+wait until that is over, or stop it: "
                              "amiroctl goto AVR 0 0")
        _, err = self.tool("calibrate", "AVR", code=1)
        self.assertIn("AVR is driven by goto", err)
        self.assertEqual(self.tool("goto", "Arduino", "0", "5")[1], "")
        self.assertEqual(self.avr.heard[-1], "{U,90,50}")
        self.interrupt(tool)


class TheOwnerEnds(Joined):
    def test_done_it_serves_the_others_until_they_are(self):
        owner = self.own("robots", "--listen", "4s")  # until goto has joined; its way takes longer
        self.avr.speed = 8
        tool = self.start("goto", "AVR", "90", "50")
        out, _ = self.ended(tool, 0)
        self.assertEqual(out, "AVR: x 0 cm, y 50 cm, heading 90 deg\n")
        out, err = self.ended(owner, 0)
        self.assertRegex(out, "AVR .* (idle|moving)")
        self.assertRegex(err, r"robots: done; it serves the central's line until goto \(process \d+\) has ended")

    def test_no_more_programs_join_one_that_is_done(self):
        owner = self.own("robots", "--listen", "4s")  # until goto has joined
        tool = self.drive()
        waiting.until(lambda: "done; it serves" in owner.stderr.readline(), "the owner is done")
        late = self.start("robots", "--listen", "100ms", "--scan", "100ms")
        time.sleep(0.5)  # it would have ended by then
        self.assertIsNone(late.poll())
        self.interrupt(tool)
        self.assertRegex(self.ended(late, 0)[0], r"AVR .* (idle|moving)")
        self.ended(owner, 0)

    def test_interrupted_it_stops_their_robots(self):
        owner = self.own()
        tool = self.drive()
        self.avr.loses = 3
        self.interrupt(owner)
        self.assertEqual(owner.returncode, 130)
        self.assertEqual(self.avr.loses, 0)
        self.assertEqual(self.avr.heard[-4:], ["{U,0,0}"] * 4)
        _, err = self.ended(tool, 1)
        self.assertRegex(err, r"another program has stopped AVR or sent it: robots \(process \d+\)")

    def test_killed(self):
        owner = self.own()
        tool = self.drive()
        owner.kill()
        _, err = self.ended(tool, 1)
        self.assertRegex(err, r"goto: robots \(process \d+\) (has ended|is gone)\s+AVR may still drive: at the latest it "
                              "stops after 60 cm; to stop it: amiroctl goto AVR 0 0")
        self.assertEqual(self.tool("goto", "AVR", "0", "0")[1], "")
        self.assertEqual(self.avr.heard[-1], "{U,0,0}")

    def test_stopped(self):
        owner = self.own()
        tool = self.drive()
        owner.send_signal(signal.SIGSTOP)
        _, err = self.ended(tool, 1)
        self.assertRegex(err, r"robots \(process \d+\) does not answer\s+AVR may still drive")
        _, err = self.tool("robots", code=1)
        self.assertRegex(err, r"robots: the program that has '.*' \(process \d+\) does not answer\s+was it stopped")
        owner.send_signal(signal.SIGCONT)
        self.stopped()
        self.assertRegex(self.tool("robots", "--listen", "1s")[0], r"AVR .* idle")

    def test_the_dongle_is_unplugged(self):
        owner = self.own()
        tool = self.drive()
        self.central.unplug()
        self.assertIn("is gone", self.ended(owner, 1)[1])
        self.assertRegex(self.ended(tool, 1)[1], r"robots \(process \d+\) (has ended|is gone)")


class AnOwnerThatOnlyKeepsTheLine(Joined):
    def keep(self, *arguments):
        keeper = self.start("central", "--own", "--scan", "200ms", *arguments)
        said = ""
        for line in keeper.stderr:
            said += line
            if "Ctrl-C ends it" in line:
                self.said = said
                return keeper
        return self.fail(f"it ended with {keeper.wait()}: {said}")

    def test_keeps_links_for_many_commands(self):
        keeper = self.keep()
        self.assertTrue(self.avr.linked and self.arduino.linked)
        before = len(self.central.commands)
        for _ in range(3):
            self.tool("goto", "AVR", "0", "5")
        self.assertRegex(self.run_tool("robots", "--listen", "100ms")[0], "AVR .* idle")
        self.assertNotIn("start", self.central.commands[before:])  # no scan
        _, err = self.interrupt(keeper)
        self.assertEqual(keeper.returncode, 130)
        self.assertIn("central: 4 programs joined", err)
        waiting.until(lambda: self.central.target is None, "command mode")

    def test_a_paused_robot_is_paused_again_behind_a_drive(self):
        self.keep()
        self.assertRegex(self.run_tool("robots", "--listen", "3s")[0], "AVR .* idle")  # the owner has heard its updates
        self.assertEqual(self.tool("pause", "AVR")[0], "AVR: paused\n")
        self.tool("goto", "AVR", "0", "5")
        self.assertTrue(self.avr.paused)
        self.tool("unpause", "AVR")
        self.tool("goto", "AVR", "0", "0")
        self.assertFalse(self.avr.paused)

    def test_another_one_is_refused(self):
        self.keep()
        _, err = self.run_tool("central", "--own", code=1)
        self.assertRegex(err, r"central: central \(process \d+\) has the central's line")
        _, err = self.tool("map", os.path.join(self.folder, "a.svg"), code=1)
        self.assertRegex(err, r"map: central \(process \d+\) has the central's line")

    def test_calls_a_robot_back(self):
        keeper = self.keep("--call-back")
        self.avr.bad_beyond_cm = 20
        tool = self.start("goto", "AVR", "0", "50")
        self.avr.speed = 5
        _, err = self.ended(tool, 1)
        self.assertRegex(err, r"another program has stopped AVR or sent it: central \(process \d+\)")
        waiting.until(lambda: abs(self.avr.x) < 0.06, "it is sent back")
        _, err = self.interrupt(keeper)
        self.assertRegex(err, r"central: the link to AVR is bad: [1-6]\d % of its sentences come whole; it is called back\n")

    def test_says_who_is_lost(self):
        keeper = self.keep()
        self.central.drop(self.avr)
        waiting.until(lambda: "AVR is lost" in keeper.stderr.readline(), "it says so")
        self.assertEqual(self.tool("goto", "AVR", "0", "5")[1], "")  # which links it again

    def test_without_robots(self):
        self.central.robots = []
        keeper = self.keep()
        self.assertEqual(self.said, "central: no robots yet: `amiroctl robots --scan 3s` looks again\n"
                                    f"central: has {self.central.path}; robots, goto and others join it; Ctrl-C ends it\n")
        self.central.robots = [self.avr]
        self.assertRegex(self.tool("robots", "--listen", "1s")[0], "AVR .* idle")
        self.assertEqual(self.ask(self.call(greet=False), b"hello 2 goto"), b"")
        _, err = self.interrupt(keeper)
        self.assertEqual(keeper.returncode, 130)
        self.assertRegex(err, r"central: 1 program joined, [1-9]\d* turned away\n")

    def test_its_socket_is_removed(self):
        keeper = self.keep()
        caller = self.call(owner="central")
        os.remove(self.line_socket())
        waiting.until(lambda: glob.glob(os.path.join(self.folder, "ocm", "line-*.sock")), "it is there again")
        self.assertEqual(stat.S_IMODE(os.stat(self.line_socket()).st_mode), 0o600)
        self.assertEqual(self.tool("goto", "AVR", "0", "5")[1], "")
        self.assertTrue(self.ask(caller, b"robots").startswith(b"ok\n"))  # who had joined stays so
        _, err = self.interrupt(keeper)
        self.assertIn("central: the socket for other programs was removed, and is there again\n", err)
        self.assertEqual(glob.glob(os.path.join(self.folder, "ocm", "line-*.sock")), [])

    def test_its_socket_cannot_be_there_again(self):
        keeper = self.keep()
        os.remove(self.line_socket())
        os.chmod(os.path.join(self.folder, "ocm"), 0o750)
        for line in keeper.stderr:
            if "the socket for other programs was removed: " in line:
                break
        os.chmod(os.path.join(self.folder, "ocm"), 0o700)
        waiting.until(lambda: glob.glob(os.path.join(self.folder, "ocm", "line-*.sock")), "it is there again")
        _, err = self.interrupt(keeper)
        self.assertEqual(err.count("was removed"), 1)

    def test_whose_messages_are_not_read(self):
        """A pager, or a terminal after Ctrl-S: the line is served all the same, and nothing of them is lost."""
        reader, writer = os.pipe()
        self.addCleanup(os.close, reader)
        fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)
        keeper = self.start("central", "--own", "--scan", "200ms", stderr=writer)
        waiting.until(lambda: self.avr.confirmed and self.arduino.confirmed, "its robots are linked")
        waiting.until_asleep(keeper.pid)
        filler = os.open(f"/proc/self/fd/{writer}", os.O_WRONLY | os.O_NONBLOCK)  # the program's end waits
        os.close(writer)
        self.addCleanup(os.close, filler)

        def fill():
            try:
                while True:
                    os.write(filler, b"\n")
            except BlockingIOError:
                pass
        fill()
        self.central.drop(self.arduino)
        robots = [json.loads(line) for line in self.tool("robots", "--json", "--listen", "500ms")[0].splitlines()]
        self.assertEqual([robot["robot"] for robot in robots], ["AVR", "Arduino"])
        self.assertEqual(self.tool("goto", "AVR", "0", "5")[1], "")
        said = b""
        while b"Arduino is lost\n" not in said:
            said += os.read(reader, 4096)
        fill()
        keeper.send_signal(signal.SIGINT)
        self.assertEqual(keeper.wait(timeout=60), 130)

    def test_wrong_usage(self):
        for words in (["--own", "--pty"], ["--own", "--robot", "A=/dev/null"], ["--call-back"], ["--central", "/dev/null"],
                      ["--flow", "rtscts"]):
            with self.subTest(words=words):
                self.run_tool("central", *words, code=2)


class Hostile(Joined):
    def setUp(self):
        super().setUp()
        self.own()

    def goto_works(self):
        self.assertEqual(self.tool("goto", "Arduino", "10", "5")[1], "")

    def test_words_that_are_no_request(self):
        caller = self.call()
        for words in (b"no such", b"go", b"go 0", b"go 0 90", b"go 0 361 5", b"go 0 90 40000", b"go 128 1 1", b"go -1 1 1",
                      b"go 0 1 1 1", b"go  0 1 1", b"go AVR 1 1", b"scan", b"scan 60001", b"scan -1", b"stop 0 ", b" stop 0",
                      b"stop 0\n", b"map", b"map exe", b"more -1", b"\0", b"robots 999999999999999999999", b"GO 0 1 1"):
            with self.subTest(words=words):
                self.assertTrue(self.ask(caller, words).startswith(b"no\nthat is no request"), words)
        self.assertEqual([line for line in self.avr.heard if line.startswith("{U")], [])
        self.assertTrue(self.ask(caller, b"robots").startswith(b"ok\nidle\n"))
        self.assertIn(b'"robot":"AVR"', self.ask(caller, b"json"))
        self.goto_works()

    def test_who_does_not_greet_is_turned_away(self):
        for words in (b"go 0 90 50", b"robots", b"hello 2 goto", b"hello 1 ", b"hello 1 a\tb", b"hello 1 \x1b[2J", b"x" * 60000):
            with self.subTest(words=words):
                self.assertEqual(self.ask(self.call(greet=False), words), b"")
        caller = self.call()
        self.assertEqual(self.ask(caller, b"hello 1 another"), b"")  # one name each
        self.assertEqual([line for line in self.avr.heard if line.startswith("{U")], [])
        self.goto_works()

    def test_too_long_is_not_taken_for_its_beginning(self):
        caller = self.call()
        self.assertEqual(self.ask(caller, b"go 0 90 50" + b" " * 60000), b"")
        self.assertEqual(self.ask(self.call(), b"")[:0], b"")
        self.assertEqual([line for line in self.avr.heard if line.startswith("{U")], [])
        self.goto_works()

    def test_endless_requests_hold_up_nothing(self):
        callers = [self.call() for _ in range(8)]
        for caller in callers:
            caller.setblocking(False)
        end = time.monotonic() + 3
        tool = self.start("goto", "Arduino", "10", "5")
        while time.monotonic() < end:  # answers are not read
            for caller in callers:
                try:
                    caller.send(b"robots")
                except OSError:
                    pass
        _, err = self.ended(tool, 0)
        self.assertEqual(err, "")
        self.goto_works()

    def test_a_dongle_that_never_stops(self):
        caller = self.call()
        self.central.babble()
        for _ in range(20):
            self.assertTrue(self.ask(caller, b"robots").startswith(b"ok\n"))
        owner = self._started[0]
        self.interrupt(owner)
        self.assertEqual(owner.returncode, 130)

    def test_more_callers_than_there_is_room_for(self):
        callers = []
        for _ in range(70):
            caller = self.call(greet=False)
            try:
                if self.ask(caller, b"hello 1 many") == b"ok\nrobots":
                    callers.append(caller)
            except OSError:
                pass
        self.assertLessEqual(len(callers), 64)
        self.assertGreater(len(callers), 60)
        for caller in callers:
            caller.close()
        self.goto_works()

    def test_who_sends_a_robot_and_is_gone(self):
        caller = self.call()
        self.avr.speed = 1
        self.assertRegex(self.ask(caller, b"go 0 90 50"), rb"ok\n\d+")
        waiting.until(lambda: "{U,90,50}" in self.avr.heard, "it drives")
        caller.close()
        self.stopped()


class BesideAMap(Case):
    """Simulated robots draw a map while others watch it and stop robots by hand."""

    def setUp(self):
        super().setUp()
        self.start_sim("--robots", "2", "--world", "labyrinth")
        self.map = self.start("map", self.path("room.pgm"), "--world", "labyrinth")
        waiting.until(lambda: self.moving() == {"AVR", "Arduino"}, "both explore", 120)

    def path(self, name):
        return os.path.join(self.folder, name)

    def states(self):
        if not glob.glob(os.path.join(self.folder, "ocm", "line-*.sock")):
            return {}
        out, _ = self.run_tool("robots", "--json", "--listen", "100ms")
        return {robot["robot"]: robot for robot in self.objects(out)}

    def moving(self):
        """Those that are not where they began."""
        return {name for name, robot in self.states().items() if robot["pose"] and
                any(abs(value) > 2 for value in robot["pose"].values())}

    def place(self, name):
        return self.states()[name]["pose"]

    def rested(self, name):
        """Where it is once it is there twice in a row."""
        places = [self.place(name)]
        waiting.until(lambda: places.append(self.place(name)) or places[-1] == places[-2], f"{name} is at rest")
        return places[-1]

    def test_a_robot_is_stopped_by_hand_and_held_and_the_other_goes_on(self):
        self.run_tool("goto", "AVR", "0", "0")
        states = self.states()
        self.assertEqual(states["AVR"]["state"], "held")
        self.assertTrue(states["AVR"]["held"] and not states["Arduino"]["held"])
        other = states["Arduino"]["pose"]
        place = self.rested("AVR")
        for what in ("x_cm", "y_cm"):
            self.assertLessEqual(abs(states["AVR"]["pose"][what] - place[what]), 15)  # it has rolled out
        waiting.until(lambda: self.place("Arduino") != other, "the other goes on", 60)
        time.sleep(3)  # the explorer asks once a second
        for what, value in self.place("AVR").items():
            self.assertLessEqual(abs(value - place[what]), 3)
        # By hand it goes where it is sent; then it is held still.
        out, _ = self.run_tool("goto", "AVR", "90", "0")
        self.assertRegex(out, r"AVR: x -?\d+ cm, y -?\d+ cm, heading -?\d+ deg")
        self.assertEqual(self.states()["AVR"]["state"], "held")
        self.assertEqual(self.run_tool("unpause", "AVR")[0], "AVR: goes on\n")
        self.assertNotEqual(self.states()["AVR"]["state"], "held")
        place = self.place("AVR")
        waiting.until(lambda: self.place("AVR") != place, "it explores again", 60)
        _, err = self.interrupt(self.map)
        self.assertEqual(self.map.returncode, 130)
        self.assertRegex(err, r"map: AVR is held by goto \(process \d+\); the others go on. To let it go on: "
                              r"amiroctl unpause AVR\n")
        self.assertEqual(err.count("map: AVR is held by "), 1)
        self.assertEqual(err.count("map: AVR goes on\n"), 1)

    def test_a_program_that_dies_stops_its_robot_only(self):
        self.run_tool("goto", "AVR", "0", "0")
        tool = self.start("goto", "AVR", "180", "50")
        waiting.until(lambda: self.states()["AVR"]["idle"] is False, "it drives")
        tool.kill()
        waiting.until(lambda: self.states()["AVR"]["idle"], "it is stopped")
        other = self.place("Arduino")
        waiting.until(lambda: self.place("Arduino") != other, "the other goes on", 60)
        self.assertEqual(self.states()["AVR"]["state"], "held")

    def test_watched_for_a_time(self):
        seen = self.path("seen.pgm")
        begin = time.monotonic()
        out, _ = self.run_tool("map", seen, "--watch", "--duration", "3s", "--json")
        (watched,) = self.objects(out)
        self.assertEqual(watched.keys(), {"watched", "seconds", "drawn"})
        self.assertGreaterEqual(watched["seconds"], 3)
        self.assertLessEqual(watched["seconds"], time.monotonic() - begin)
        self.assertIn(watched["drawn"], range(2, int(watched["seconds"] / 2) + 2))  # each 2 s, from the beginning

    def test_watched_it_grows(self):
        seen = self.path("seen.pgm")
        watch = self.start("map", seen, self.path("seen.svg"), "--watch")
        known = []

        def grown():
            try:
                with open(seen, "rb") as file:
                    data = file.read()
                with open(seen.replace(".pgm", ".yaml"), encoding="ascii") as file:
                    self.assertEqual(file.readline(), "image: seen.pgm\n")
            except FileNotFoundError:
                return False
            head = re.match(rb"P5\n#[^\n]*\n(\d+) (\d+)\n255\n", data)
            if not head:
                return False  # it is just being written
            known.append(len(data) - head.end() - data[head.end():].count(205))
            return known[-1] > known[0] + 50
        waiting.until(grown, "the picture grows", 60)
        self.interrupt(self.map)
        self.assertEqual(self.map.returncode, 130)
        out, err = watch.communicate(timeout=60)
        self.assertEqual(watch.returncode, 0, err)
        self.assertRegex(out, r"what map \(process \d+\) drew in \d+ s, drawn \d+ times\n")
        self.assertRegex(err, r"map \(process \d+\) (has ended|is gone)")
        with open(self.path("seen.svg"), encoding="utf-8") as file:
            drawn = file.read()
        self.assertIn("map by AVR, Arduino", drawn)
        took = re.search(r"(\d+) s, \d+\.\d\d m", drawn)  # until it was drawn
        self.assertTrue(took, drawn[:2000])
        self.assertIn(int(took[1]), range(1, 1000))


if __name__ == "__main__":
    main(together=True)
