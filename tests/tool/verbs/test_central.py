"""amiroctl central: this machine as the central of mappers. The robots are played here on ptys, without a line of
the library."""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import threading
import time
import tty

from harness import AMIROCTL, Case, main, waiting


class Robot:
    """One end of a serial line. `heard` is all that has come."""

    def __init__(self):
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.path = os.ttyname(self.slave)
        os.close(self.slave)
        os.set_blocking(self.master, False)
        self.heard = b""

    def say(self, text):
        data = text.encode() if isinstance(text, str) else text
        while data:
            select.select([], [self.master], [], 5)
            try:
                data = data[os.write(self.master, data):]
            except BlockingIOError:
                time.sleep(0.01)

    def hear(self, until=None, limit=60):
        give_up = time.monotonic() + limit
        while time.monotonic() < give_up:
            try:
                if select.select([self.master], [], [], 0.05)[0]:
                    self.heard += os.read(self.master, 4096)
            except OSError:  # no program has the line open
                time.sleep(0.02)
            if until is not None and until.encode() in self.heard:
                break
        return self.heard.decode()

    def waits(self):
        """How many bytes the kernel has ready for it; more may be on their way through its buffers."""
        return struct.unpack("i", fcntl.ioctl(self.master, termios.FIONREAD, b"0000"))[0]

    def unplug(self):
        if self.master is not None:
            os.close(self.master)
        self.master = None


class Talk:
    """A central and what it says, read by a thread."""

    def __init__(self, case, *arguments, **options):
        self.process = waiting.Program([AMIROCTL, "central", *arguments], env=case.environment, text=True,
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                       errors="replace", bufsize=1, **options)
        case.centrals = (*case.centrals, self.process)
        case.addCleanup(self.close)
        self.said = ""
        self.news = threading.Condition()
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        while True:
            data = os.read(self.process.stdout.fileno(), 65536)
            if not data:
                return
            with self.news:
                self.said += data.decode("latin-1")
                self.news.notify_all()

    def type(self, text):
        self.process.stdin.write(text)
        self.process.stdin.flush()

    def wait_for(self, text, limit=60):
        with self.news:
            if not self.news.wait_for(lambda: text in self.said, limit):
                raise AssertionError(f"{text!r} does not come; there is {self.said[-1000:]!r}")

    def end(self, code=0, number=None):
        """The summary; by the end of its input, or by a signal."""
        if number is None:
            self.process.stdin.close()
        else:
            self.process.send_signal(number)
        got = self.process.wait(timeout=60)
        error = self.process.stderr.read()
        self.reader.join(timeout=60)
        if got != code:
            raise AssertionError(f"exit code {got}: {error}")
        return error

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        self.reader.join(timeout=60)
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            try:
                stream.close()
            except BrokenPipeError:
                pass


class OnSerialLines(Case):
    centrals = ()

    def programs(self):
        return (*super().programs(), *self.centrals)

    def robot(self):
        robot = Robot()
        self.addCleanup(robot.unplug)
        return robot

    def central(self, *robots, more=()):
        arguments = []
        for name, robot in robots:
            arguments += ["--robot", f"{name}={robot if isinstance(robot, str) else robot.path}"]
        return Talk(self, *arguments, *more)

    def test_a_session(self):
        robot = self.robot()
        talk = self.central(("AVR", robot))
        talk.type("start\nlist\nstop\nconn 0\n{S,CON}\n")
        talk.wait_for("connected 0\n")
        self.assertIn("scanning\n0:020000000000:AVR\nend of list\nfound 1\nconnecting 0\nconnected 0\n", talk.said)
        self.assertEqual(robot.hear("{S,CON}\n"), "{S,CON}\n")
        robot.say("{U,-177,-61,-68,49,0,0,0,0}\n{S,IDL}\n")
        talk.wait_for("{S,IDL}\n")
        self.assertTrue(talk.said.endswith("[0]:AVR:{U,-177,-61,-68,49,0[0]:AVR:,0,0,0}\n[0]:AVR:{S,IDL}\n"), talk.said)
        talk.type("*drop 0\n")
        talk.wait_for("closed 0\n")
        error = talk.end()
        self.assertIn("AVR     links 1, packets from it 3, to it 1\n", error)
        self.assertIn("server  nothing was lost\n", error)

    def test_it_refuses_as_a_central_does_and_counts(self):
        talk = self.central(("AVR", self.robot()))
        talk.type("conn 0\nhello\nswitch 0\ndrop 0\nstart\nconn 7\n")
        talk.wait_for("error: not in the list; see list\n")
        talk.wait_for("error: start, list, stop, conn i, switch i, drop i, *, reset\n")
        error = talk.end()
        self.assertEqual(talk.said.count("error: "), 5)
        self.assertIn("5 commands refused", error)

    def test_two_robots_interleaved(self):
        robots = [self.robot(), self.robot()]
        talk = self.central(("AVR", robots[0]), ("Arduino", robots[1]))
        talk.type("start\nconn 0\n*conn 1\n")
        talk.wait_for("connected 1\n")
        lines = 300
        def chatter(number):
            for i in range(lines):
                robots[number].say(f"{{U,{i},{number},0,0,0,0,0,0}}\n")
        threads = [threading.Thread(target=chatter, args=(n,)) for n in (0, 1)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for number in (0, 1):
            talk.type(f"*switch {number}\n{{U,{number},1}}\n")
        talk.wait_for("data 1\n")
        self.assertEqual(robots[0].hear("\n"), "{U,0,1}\n")
        self.assertEqual(robots[1].hear("\n"), "{U,1,1}\n")

        def whole(number):
            """The numbers of a robot's lines, of which any may come in pieces."""
            pieces = re.findall(r"\[%d\]:(?:AVR|Arduino):([^\[]*)" % number, talk.said)
            stream = re.sub(r"(command|data \d)\n", "", "".join(pieces))
            return [int(i) for i in re.findall(r"\{U,(\d+),%d,0,0,0,0,0,0\}\n" % number, stream)]
        for number in (0, 1):
            waiting.until(lambda: len(whole(number)) >= lines, f"all lines of robot {number}")
        talk.end()
        for number in (0, 1):
            self.assertEqual(whole(number), list(range(lines)))

    def test_unplugged_while_it_sends_and_back_again(self):
        robot = self.robot()
        link = os.path.join(self.folder, "avr")
        os.symlink(robot.path, link)
        talk = self.central(("AVR", link))
        talk.type("start\nconn 0\n")
        talk.wait_for("connected 0\n")
        robot.say("{U,1,2,3")
        talk.wait_for("{U,1,2,3")
        robot.unplug()
        talk.wait_for("lost 0\n")
        talk.type("{U,90,50}\n")  # still data mode: it goes nowhere
        again = self.robot()
        os.unlink(link)
        os.symlink(again.path, link)
        talk.type("*start\nconn 0\n{U,1,1}\n")
        self.assertEqual(again.hear("{U,1,1}\n"), "{U,1,1}\n")
        again.say("{S,IDL}\n")
        talk.wait_for("[0]:AVR:{S,IDL}\n")
        error = talk.end()
        self.assertIn("links 2", error)
        self.assertIn(f"AVR: '{link}' is gone: unplugged", error)
        self.assertIn("10 bytes for links that were gone or full", error)

    def test_what_is_not_there_appears_later(self):
        link = os.path.join(self.folder, "avr")
        talk = self.central(("AVR", link))
        talk.type("start\nlist\n")
        talk.wait_for("end of list\n")
        self.assertNotIn("AVR", talk.said)
        robot = self.robot()
        os.symlink(robot.path, link)

        def listed():
            talk.type("list\n")
            return "0:020000000000:AVR" in talk.said
        waiting.until(listed, "it is listed", 60)
        self.assertIn(f"no {link} yet; AVR is looked for while the central scans\n", talk.end())

    def test_garbage_and_all_bytes(self):
        robot = self.robot()
        talk = self.central(("AVR", robot))
        talk.type("start\nconn 0\n")
        talk.wait_for("connected 0\n")
        robot.say(bytes(range(256)))

        def stream():
            return talk.said[talk.said.index("connected 0\n") + len("connected 0\n"):].replace("[0]:AVR:", "")
        waiting.until(lambda: len(stream()) >= 256, "all bytes")
        talk.end()
        self.assertEqual(stream().encode("latin-1"), bytes(range(256)))

    def test_a_hundred_kilobytes_without_a_line_feed(self):
        robot = self.robot()
        talk = self.central(("AVR", robot))
        talk.type("start\nconn 0\n")
        talk.wait_for("connected 0\n")

        def stream():
            return talk.said[talk.said.index("connected 0\n") + len("connected 0\n"):]
        for sent in range(10_000, 110_000, 10_000):  # what is not read yet must fit the central's queue
            robot.say("x" * 10_000)
            waiting.until(lambda sent=sent: stream().count("x") >= sent, "what was sent so far")
        robot.say("end\n")
        talk.wait_for("end\n")
        self.assertEqual(stream().replace("[0]:AVR:", ""), "x" * 100_000 + "end\n")
        self.assertLessEqual(max(len(part) for part in stream().split("[0]:AVR:")), 20)
        talk.end()

    def test_silence_ends_a_packet(self):
        robot = self.robot()
        talk = self.central(("AVR", robot))
        talk.type("start\nconn 0\n")
        talk.wait_for("connected 0\n")
        robot.say("no end")
        talk.wait_for("[0]:AVR:no end")
        robot.say(" yet\n")
        talk.wait_for("[0]:AVR:no end[0]:AVR: yet\n")
        talk.end()

    def test_a_server_that_does_not_read(self):
        """A full pipe: the central stays alive, keeps whole packets only, and counts the others."""
        robot = self.robot()
        process = waiting.Program([AMIROCTL, "central", "--robot", f"AVR={robot.path}"], env=self.environment,
                                  stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(process.kill)
        process.stdin.write(b"start\nconn 0\n")
        process.stdin.flush()
        waiting.until_asleep(process.pid, looks=20)
        for _ in range(100):
            robot.say("{S,IDL}\n" * 500)
        process.send_signal(signal.SIGINT)
        out, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        lost = int(re.search(r", (\d+) lost: the server did not read", error.decode())[1])
        kept = out.decode().count("[0]:AVR:{S,IDL}\n")
        self.assertGreater(lost, 1000)
        self.assertGreater(kept, 1000)
        self.assertLessEqual(kept + lost, 50_000)

    def test_a_robot_that_does_not_read(self):
        robot = self.robot()
        talk = self.central(("AVR", robot))
        talk.type("start\nconn 0\n")
        talk.wait_for("connected 0\n")
        talk.type("{U,90,50}\n" * 20_000)
        talk.type("*list\n")  # and yet it obeys
        talk.wait_for("end of list\n")
        error = talk.end()
        self.assertRegex(error, r"\d+ bytes for links that were gone or full")

    def test_signals(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)):
            talk = self.central(("AVR", self.robot()))
            talk.type("start\n")
            talk.wait_for("scanning\n")
            self.assertIn("server  nothing was lost", talk.end(code, number))

    def test_the_reader_of_its_output_goes(self):
        robot = self.robot()
        process = waiting.Program([AMIROCTL, "central", "--robot", f"AVR={robot.path}"], env=self.environment,
                                  stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(process.kill)
        process.stdout.close()
        process.stdin.write(b"start\n")
        process.stdin.flush()
        self.assertEqual(process.wait(timeout=60), 0)
        process.stdin.close()
        process.stderr.close()

    def test_the_reader_of_its_output_goes_while_nothing_is_said(self):
        process = waiting.Program([AMIROCTL, "central", "--robot", f"AVR={self.robot().path}"], env=self.environment,
                                  stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(process.kill)
        process.stdin.write(b"list\n")
        process.stdin.flush()
        self.assertEqual(process.stdout.readline(), b"end of list\n")
        process.stdout.close()
        self.assertEqual(process.wait(timeout=60), 0)  # its input goes on
        process.stdin.close()
        process.stderr.close()

    def test_what_comes_in_one_piece_is_answered_line_by_line(self):
        """A link is there before the next word is obeyed, also where that is the * behind a line."""
        talk = self.central(("AVR", self.robot()))
        talk.type("start\nconn 0\n*drop 0\nlist\nconn 0\n*list\n")
        talk.wait_for("command\n0:020000000000:AVR\nend of list\n")
        self.assertEqual(talk.said, "scanning\nconnecting 0\nconnected 0\ncommand\nclosing 0\nclosed 0\n0:020000000000:AVR\nend of list\n"
                                    "connecting 0\nconnected 0\ncommand\n0:020000000000:AVR\nend of list\n")
        self.assertIn("links 2", talk.end())

    def test_a_full_disk(self):
        with open("/dev/full", "wb") as full:
            process = subprocess.run([AMIROCTL, "central", "--robot", "AVR=/dev/null"], env=self.environment,
                                     input=b"start\n", stdout=full, stderr=subprocess.PIPE, timeout=60, check=False)
        self.assertEqual(process.returncode, 1)
        self.assertIn(b"cannot write to the standard output: No space left", process.stderr)

    def test_lines_that_are_none(self):
        for path, words in (("/dev/null", "'/dev/null' is no serial device"),):
            talk = self.central(("AVR", path))
            talk.type("start\nconn 0\n")
            talk.wait_for("error: no link to 0\n")
            self.assertIn(words, talk.end())
        talk = self.central(("AVR", "/etc/passwd"), ("B", "/dev/no-such-line"))
        talk.type("start\nlist\n")
        talk.wait_for("end of list\n")
        self.assertEqual(talk.said, "scanning\nend of list\n")
        talk.end()

    def test_a_line_in_use(self):
        robot = self.robot()
        first = self.central(("AVR", robot))
        first.type("start\nconn 0\n")
        first.wait_for("connected 0\n")
        second = self.central(("AVR", robot))
        second.type("start\nconn 0\n")
        second.wait_for("error: no link to 0\n")
        self.assertIn("in use by another program", second.end())
        first.end()

    def test_reset(self):
        robot = self.robot()
        talk = self.central(("AVR", robot))
        talk.type("start\nconn 0\n")
        talk.wait_for("connected 0\n")
        talk.type("*reset\nlist\n")
        talk.wait_for("reset\nend of list\n")
        talk.type("start\nconn 0\n{}\n")
        self.assertEqual(robot.hear("{}\n"), "{}\n")
        self.assertIn("links 2", talk.end())

    def test_no_robots(self):
        _, error = self.run_tool("central")
        self.assertIn("no robots in " + os.path.join(self.folder, "ocm", "line") + " yet", error)

    def flooded(self):
        """A central whose robot has a link, does not read, and was sent more than can wait."""
        robot = self.robot()
        talk = self.central(("AVR", robot))
        talk.type("start\nconn 0\n")
        talk.wait_for("connected 0\n")
        for full in (False, True):
            for _ in range(100):
                talk.type("{U,90,50}\n" * 200)
                time.sleep(0.001)
            if not full:  # the kernel, which may be late, has made the last room that there is without a reader
                waiting.until(lambda: robot.waits() >= 4095, "the robot's buffer is full")
        self.settle()
        talk.robot = robot
        return talk

    def test_packets_that_a_robot_did_not_take_are_told_at_the_end(self):
        talk = self.flooded()
        self.assertIn("64 packets not sent at the end", talk.end(130, signal.SIGINT))

    def test_packets_that_waited_for_a_link_that_is_dropped_are_told_at_the_end(self):
        talk = self.flooded()
        talk.type("*drop 0\n")
        talk.wait_for("closed 0\n")
        self.assertRegex(talk.end(), r"server .*\b64 packets dropped with a link")

    def test_what_waits_at_the_end_of_the_input_still_goes_to_a_robot_that_reads_late(self):
        """It has a second for that, which on a busy machine may pass without it: once is enough."""
        def all_went():
            talk = self.flooded()
            talk.process.stdin.close()
            time.sleep(0.1)  # it is late

            def over():
                talk.robot.hear(limit=0.05)
                return talk.process.poll() is not None
            waiting.until(over, "the end")
            self.assertEqual(talk.process.returncode, 0)
            return "not sent" not in talk.process.stderr.read()
        self.assertTrue(any(all_went() for _ in range(5)))

    def test_a_robot_that_never_reads_holds_up_no_end(self):
        self.assertIn("64 packets not sent at the end", self.flooded().end())

    def test_the_end_of_the_input_is_the_end_where_nothing_waits(self):
        """At once: in the second that packets have it looks each 5 ms, and would sleep 200 times."""
        def sleeps():
            process = self.start("central", "--robot", f"AVR={self.robot().path}", stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL)
            waiting.until(process.has_ended, "the end")
            _, process.returncode, usage = os.wait4(process.pid, 0)
            self.assertEqual(process.returncode, 0)
            return usage.ru_nvcsw
        self.assertLess(min(sleeps() for _ in range(3)), 100)

    def test_wrong_usage(self):
        for arguments, words in ((["--robot", "AVR"], "is not NAME=PATH"),
                                 (["--robot", "=x"], "is not NAME=PATH"),
                                 (["--robot", "A:B=/dev/null"], "a robot cannot be called 'A:B'"),
                                 (["--robot", "x" * 21 + "=/dev/null"], "a robot cannot be called"),
                                 (["--robot", "A=/dev/null", "--robot", "A=/dev/zero"], "two robots are called 'A'"),
                                 (["--robot", "A=/dev/null", "--robot", "B=/dev/null"], "two robots on '/dev/null'"),
                                 (["--baud", "12345"], "has no speed 12345")):
            _, error = self.run_tool("central", *arguments, code=2)
            self.assertIn(words, error)


class Many(Case):
    def test_as_many_robots_as_it_takes(self):
        """The speed is one that no line has, so that it ends."""
        def refused(count):
            robots = [word for number in range(count) for word in ("--robot", f"R{number}=/nowhere/{number}")]
            return self.run_tool("central", *robots, "--baud", "38401", code=2)[1]
        self.assertIn("a serial line has no speed 38401 here", refused(64))
        self.assertIn("central: 65 robots\n          it takes at most 64\n", refused(65))


    def test_of_a_folder_as_many_lines_as_it_takes_each_once_and_by_their_names(self):
        folder = os.path.join(self.folder, "ocm", "line")
        os.makedirs(folder)
        for number in reversed(range(70)):
            for ending in ("", ".lock"):
                open(os.path.join(folder, f"R{number:02}{ending}"), "w", encoding="ascii").close()
        _, error = self.run_tool("central", stdin="start\nstop\nstart\n")
        robots = [line.split()[0] for line in error.splitlines() if " links 0, " in line]
        self.assertEqual(robots, [f"R{number:02}" for number in range(64)])


class OnAPseudoTerminal(Case):
    """The server is a program that opens the central's line, such as the one of thesis 2."""

    def begin(self, *arguments):
        self.robot = Robot()
        self.addCleanup(self.robot.unplug)
        self.link = os.path.join(self.folder, "ocm", "central")
        self.process = self.start("central", "--robot", f"AVR={self.robot.path}", "--pty", *arguments)
        self.assertIn("Ctrl-C ends it", self.process.stderr.readline())

    def open(self, path=None):
        line = os.open(path or self.link, os.O_RDWR | os.O_NOCTTY)
        self.assertFalse(termios.tcgetattr(line)[3] & termios.ECHO)
        self.addCleanup(lambda: self.forget(line))
        return line

    @staticmethod
    def forget(line):
        try:
            os.close(line)
        except OSError:
            pass

    @staticmethod
    def read(line, until, limit=60):
        text = b""
        give_up = time.monotonic() + limit
        while until not in text and time.monotonic() < give_up:
            if select.select([line], [], [], 0.1)[0]:
                text += os.read(line, 4096)
        return text

    def bytes_read(self):
        """By the central, so far: what a robot says is on its way in the kernel while both of them sleep. [man 5 proc: io]"""
        with open(f"/proc/{self.process.pid}/io", encoding="ascii") as file:
            return int(file.readline().split()[1])

    def test_programs_come_and_go(self):
        self.begin()
        line = self.open()
        os.write(line, b"start\nconn 0\n")
        self.assertEqual(self.read(line, b"connected 0\n"), b"scanning\nconnecting 0\nconnected 0\n")
        os.close(line)
        self.settle()
        before = self.bytes_read()
        self.robot.say("{S,IDL}\n")  # no program hears it
        waiting.until(lambda: self.bytes_read() >= before + len("{S,IDL}\n"), "the central has heard it")
        self.settle()
        line = self.open()
        self.robot.say("{U,1,2,3,4,5,6,7,8}\n")
        self.assertEqual(self.read(line, b"8}\n"), b"[0]:AVR:{U,1,2,3,4,5,6,7,8}\n")
        os.write(line, b"{U,90,50}\n")  # its link and its mode are as they were
        self.assertEqual(self.robot.hear("{U,90,50}\n"), "{U,90,50}\n")
        _, error = self.interrupt(self.process)
        self.assertEqual(self.process.returncode, 130)
        self.assertIn("16 bytes sent with no server connected", error)
        self.assertEqual(os.listdir(os.path.dirname(self.link)), ["line"])

    def test_words_of_a_program_that_has_gone_already(self):
        self.begin()
        line = self.open()
        os.write(line, b"start\nconn 0\n{S,PAU}\n")
        os.close(line)
        self.assertEqual(self.robot.hear("{S,PAU}\n"), "{S,PAU}\n")

    def test_a_second_central_is_refused(self):
        self.begin()
        _, error = self.run_tool("central", "--pty", code=1)
        self.assertIn(f"another program serves '{self.link}'", error)

    def test_a_link_of_choice(self):
        path = os.path.join(self.folder, "mine")
        self.begin(path)
        line = self.open(path)
        os.write(line, b"list\n")
        self.assertEqual(self.read(line, b"end of list\n"), b"end of list\n")

    def test_pyserial(self):
        program = """if True:
            import serial, sys
            with serial.Serial(sys.argv[1], 38400, timeout=60) as line:
                line.write(b"start\\nlist\\n")
                sys.stdout.buffer.write(line.read_until(b"end of list\\n"))
        """
        python = next((python for python in (sys.executable, "/usr/bin/python3")
                       if subprocess.run([python, "-c", "import serial"], capture_output=True, check=False).returncode == 0),
                      None)
        if python is None:
            self.skipTest("no pyserial here")
        self.begin()
        for _ in range(2):
            result = subprocess.run([python, "-c", program, self.link], capture_output=True, timeout=90, check=True)
            self.assertTrue(result.stdout.endswith(b"0:020000000000:AVR\nend of list\n"), result.stdout)


class AtATerminal(Case):
    def test_a_person_types(self):
        robot = Robot()
        self.addCleanup(robot.unplug)
        master, slave = pty.openpty()
        process = waiting.Program([AMIROCTL, "central", "--robot", f"AVR={robot.path}"], env=self.environment,
                                  stdin=slave, stdout=slave, stderr=subprocess.PIPE, start_new_session=True)
        self.addCleanup(process.kill)
        os.close(slave)
        os.write(master, b"start\nlist\n")
        text = OnAPseudoTerminal.read(master, b"end of list\r\n").decode()
        for words in ("start\r\n", "scanning\r\n", "0:020000000000:AVR\r\n"):  # the first by the terminal's own echo
            self.assertIn(words, text)
        os.write(master, b"\x04")  # Ctrl-D
        self.assertEqual(process.wait(timeout=60), 0)
        process.stderr.close()
        os.close(master)


if __name__ == "__main__":
    main()
