"""amiroctl top on a real terminal, tmux: its keys, its sizes, and how it leaves the terminal."""

import fcntl
import os
import pty
import re
import select
import shlex
import signal
import struct
import subprocess
import termios
import time

import harness
import played_adapter
import screens


class Top(played_adapter.WithAdapter, screens.Screens):
    def start_bus(self, *topics):
        self.start_sim("--frozen")
        for topic in topics:
            self.run_tool("publish", topic, "100ms")

    def log(self, seconds=30):
        """Gyroscope every 100 ms, whose x counts up."""
        path = os.path.join(self.folder, "drive.log")
        with open(path, "w", encoding="ascii") as file:
            for i in range(seconds * 10):
                file.write(f"({1000 + i / 10:.6f}) can0 608#{i % 256:02X}0000000000\n")
        return path

    @staticmethod
    def read(path):
        with open(path, encoding="ascii") as file:
            return file.read()

    def row(self, columns, name):
        return next((line for line in self.screen(columns) if line.startswith(name)), "")

    def test_widths(self):
        self.start_bus("gyro", "odom")
        for columns in (40, 80, 120, 200):
            self.open(columns, "--bus", "sim", "top", rows=20)
        for columns in (40, 80, 120, 200):
            lines = self.shows(columns, "gyroscope", "odometry", "frames/s")
            self.fits(columns, lines)
            harness.waiting.until(lambda: re.search(r"gyros\w* +(9\.\d\d|10\.\d)", self.row(columns, "gyros")), "its rate")
            self.press(columns, "q")
            self.assertEqual(self.ended(columns)[-1], "END 0")

    def test_another_size(self):
        self.start_bus("gyro")
        self.open(80, "--bus", "sim", "top", rows=24)
        self.shows(80, "gyroscope")
        for columns, rows in ((40, 10), (150, 40), (20, 4), (100, 24)):
            self.tmux("resize-window", "-t", "of80", "-x", str(columns), "-y", str(rows))
            harness.waiting.until(lambda: self.fitted(columns, rows), "a picture of the new size")
        self.press(80, "q")
        self.assertEqual(self.ended(80)[-1], "END 0")

    def fitted(self, columns, rows):
        lines = self.screen(80, joined=False)
        return len(lines) <= rows and max(map(len, lines)) <= columns and ("HZ" in "\n".join(lines) or rows < 5)

    def test_keys(self):
        self.start_bus("gyro", "odom")
        self.open(100, "--bus", "sim", "top", rows=24)
        self.shows(100, "gyroscope", "odometry")
        self.press(100, "/", "g", "y", "r", "Enter")
        harness.waiting.until(lambda: not self.row(100, "odometry"), "the filter")
        self.press(100, "Down", "Enter", "Down", "Space")
        self.shows(100, "  x ", "..")
        self.press(100, "p")
        self.shows(100, "PAUSED")
        self.press(100, "p", "?")
        self.shows(100, "Any key leaves this page.")
        self.press(100, "x", "Escape")
        self.shows(100, "odometry")
        self.press(100, "q")
        self.assertEqual(self.ended(100)[-1], "END 0")

    def click(self, columns, line):
        """As a terminal of xterm's kind says it: button, column and line, each 32 more, from 1; then the release."""
        for button in " #":
            self.tmux("send-keys", "-t", f"of{columns}", "-l", f"\x1b[M{button}!{chr(33 + line)}")

    def test_a_mouse_chooses_a_row(self):
        self.start_bus("gyro", "odom")
        for options, chosen in ((("--mouse",), True), ((), False)):
            name = 100 + chosen
            self.open(name, "--bus", "sim", "top", *options, rows=24)
            self.shows(name, "gyroscope", "odometry")
            lines = self.screen(name, joined=False)
            self.click(name, next(i for i, line in enumerate(lines) if line.startswith("gyroscope")))
            self.press(name, "Enter")
            # The row that was clicked opens; without a mouse the first one does.
            self.shows(name, *(("  x ", "  y ") if chosen else ("  velocity.x",)))
            self.press(name, "q")
            self.assertEqual(self.ended(name)[-1], "END 0")

    def test_no_more_than_twenty_pictures_a_second(self):
        """However many keys come: each picture is one write, so that a reader that is slow counts fewer."""
        self.start_bus("gyro", "odom")
        primary, secondary = pty.openpty()
        self.addCleanup(os.close, primary)
        fcntl.ioctl(secondary, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 100, 0, 0))
        top = subprocess.Popen([harness.AMIROCTL, "--bus", "sim", "top"], stdin=secondary, stdout=secondary, stderr=subprocess.DEVNULL,
                               env={**self.environment, "TERM": "xterm"}, start_new_session=True)
        self._started.append(top)
        os.close(secondary)
        self.assertTrue(select.select([primary], [], [], 30)[0])
        begin, pictures, keys = time.monotonic(), 0, 0
        while time.monotonic() - begin < 3:
            os.write(primary, b"jk"[keys % 2:keys % 2 + 1])
            keys += 1
            if select.select([primary], [], [], 0.005)[0]:
                os.read(primary, 65536)
                pictures += 1
        span = time.monotonic() - begin
        os.write(primary, b"q")
        self.assertEqual(top.wait(timeout=30), 0)
        self.assertGreater(keys, 100)
        self.assertGreater(pictures, 10)  # more than the ten a second that there are without keys, if the machine has time
        self.assertLessEqual(pictures, 20 * span + 2)

    def test_what_is_missing_comes_first(self):
        self.start_sim("--frozen")
        self.run_tool("publish", "gyro", "100ms")
        self.open(100, "--bus", "sim", "top", rows=24)
        self.shows(100, "gyroscope")
        self.run_tool("publish", "power", "200ms")
        self.shows(100, "power")
        self.run_tool("send", "23C#0000")  # of a wrong length
        self.shows(100, "1 of a wrong length")

    def test_the_terminal_is_as_it_was(self):
        self.start_bus("gyro")
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            name = f"{60 + number}"
            pid = os.path.join(self.folder, "pid")
            state = os.path.join(self.folder, "state")
            self.open(name, "--bus", "sim", "top", before=f"stty -g > {state}.before; echo $$ > {pid}; ",
                      after=f"stty -g > {state}.after; ")
            self.shows(name, "gyroscope")
            parent = self.read(pid).strip()
            child = subprocess.run(["pgrep", "-P", parent, "amiroctl"], capture_output=True, text=True, check=True)
            os.kill(int(child.stdout), number)
            lines = self.ended(name)
            self.assertEqual(lines[-1], f"END {128 + number}", number)
            self.assertNotIn("gyroscope", "\n".join(lines))  # the picture has gone
            harness.waiting.until(lambda: os.path.exists(f"{state}.after") and os.path.getsize(f"{state}.after"), "stty")
            before, after = (self.read(f"{state}.{when}") for when in ("before", "after"))
            self.assertEqual(before, after)
            os.remove(f"{state}.after")

    def test_a_bus_that_goes_away(self):
        simulator = self.start_sim("--frozen")
        self.run_tool("publish", "gyro", "100ms")
        self.open(80, "--bus", "sim", "top", rows=24)
        self.shows(80, "gyroscope")
        self.interrupt(simulator)
        lines = self.ended(80)
        self.assertEqual(lines[-1], "END 1")
        self.assertRegex("\n".join(lines), r"amiroctl: .*sim")

    def test_a_log(self):
        self.open(80, "top", self.log(), rows=24, before="export NO_COLOR=1 LC_ALL=C.UTF-8; ")
        self.shows(80, "gyroscope", "of 29.9 s", "drive.log")
        self.press(80, "p")
        self.shows(80, "paused")
        self.press(80, "0")
        self.shows(80, " 0.0 of 29.9 s")
        self.press(80, "Right", "Right")
        self.shows(80, "20.0 of 29.9 s", " 3.5 deg/s")  # sample 200, in steps of 17.5 mdeg/s
        self.press(80, ",")
        self.shows(80, "19.0 of 29.9 s", " 3.325 deg/s")
        self.press(80, "]", "]", "p")
        self.shows(80, " end")
        # A graph that is asked for now shows what came before.
        self.press(80, "Down", "Enter", "Down", "Space")
        self.shows(80, "▁▂")
        self.press(80, "q")
        self.assertEqual(self.ended(80)[-1], "END 0")

    def test_a_serial_adapter(self):
        adapter = self.adapter()
        self.open(100, "--bus", f"slcan:{adapter.path}@250k", "top", rows=24)
        self.shows(100, "slcan:", "nothing came yet")
        self.assertEqual(adapter.rate, 250)
        for value in (1, 2, 3):
            adapter.say(f"t6086{value:02X}0000000000" + f"{value * 100:04X}\r")
        adapter.say("t1232DEAD0200\r")
        self.shows(100, "gyroscope", " 0.0525 deg/s", "123", "DE AD")
        adapter.unplug()
        lines = self.ended(100)
        self.assertEqual(lines[-1], "END 1")
        self.assertIn("slcan:", "\n".join(lines))

    def test_a_terminal_that_it_cannot_use(self):
        self.start_bus("gyro")
        for name, what in (("dumb", "cannot move its cursor"), ("unheard-of", "nothing is known here"), ("", "TERM is not set")):
            self.open(80, "--bus", "sim", "top", before=f"export TERM={shlex.quote(name)}; ")
            self.assertIn(what, "\n".join(self.ended(80)))
            self.assertEqual(self.ended(80)[-1], "END 2")
            self.tmux("kill-session", "-t", "of80")
        _, refused = self.run_tool("top", code=2)
        self.assertIn("top draws on a terminal, and standard output is none", refused)
        self.assertIn("amiroctl stats", refused)

    def test_logs_that_it_cannot_wind(self):
        log = self.log()
        self.assertIn("two logs", self.run_tool("top", log, log, code=2)[1])
        self.assertIn("cannot be wound", self.run_tool("top", "-", code=2)[1])
        empty = os.path.join(self.folder, "empty.log")
        open(empty, "w", encoding="ascii").close()
        self.assertIn("empty.log", self.run_tool("top", empty, code=1)[1])
        self.assertIn("--from candump", self.run_tool("top", "--from", "candump", code=2)[1])


if __name__ == "__main__":
    harness.main()
