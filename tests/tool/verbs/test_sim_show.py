"""amiroctl sim --show=text on a real terminal, tmux: what it draws, its keys, its sizes, and how it leaves the terminal."""

import http.client
import os
import re
import shlex
import signal
import socket
import subprocess

import harness
import screens


class Show(screens.Screens):
    def socket(self):
        return "sim:" + os.path.join(self.folder, "show.sock")

    def test_a_robot_that_drives(self):
        self.open(80, "--bus", self.socket(), "sim", "--show=text", rows=24)
        lines = self.shows(80, "AMiRo", "heading", "q quit", "  0.000 m/s")
        self.fits(80, lines)
        place = re.search(r"x +(-?\d+\.\d+) m", "\n".join(lines))[1]
        # On a busy machine either may end with words: frames that left too late, a program that did not run.
        drives = []

        def driven():
            if not drives or drives[-1].poll() is not None:
                drives.append(self.start("--bus", self.socket(), "drive", "10cm/s", "20deg/s"))
            return re.search(r"right +0\.1\d\d m/s", "\n".join(self.screen(80)))

        harness.waiting.until(lambda: self.start("--bus", self.socket(), "led", "all", "green").wait() == 0, "its lights")
        lines = self.shows(80, "g g g g g g g g")
        harness.waiting.until(driven, "its wheels")
        harness.waiting.until(lambda: not re.search(rf"x +{re.escape(place)} m", "\n".join(self.screen(80))), "another place")
        self.interrupt(drives[-1])
        self.press(80, "q")
        ended = self.ended(80)
        self.assertEqual(ended[-1], "END 0")
        self.assertIn("di_wheel_drive", "\n".join(ended))  # what it prints at its end anyway
        self.assertNotIn("heading", "\n".join(ended))  # the picture has gone

    def test_sizes(self):
        self.open(80, "--bus", self.socket(), "sim", "--frozen", "--show=text", rows=24)
        self.shows(80, "heading")
        for columns, rows in ((40, 12), (150, 45), (20, 4), (80, 24)):
            self.tmux("resize-window", "-t", "of80", "-x", str(columns), "-y", str(rows))

            def fitted(columns=columns, rows=rows):
                lines = self.screen(80, joined=False)
                wide = [line for line in lines if len(line) > 64]
                return len(lines) <= rows and max(map(len, lines)) <= columns and (columns < 100 or wide) and "AMiRo" in "\n".join(lines)
            harness.waiting.until(fitted, f"a picture of {columns} x {rows}")
        self.press(80, "q")
        self.assertEqual(self.ended(80)[-1], "END 0")

    def test_mappers(self):
        self.open(80, "sim", "--world", "labyrinth", "--show=text", rows=24, before="export LC_ALL=C.UTF-8; ")
        self.shows(80, "labyrinth", "1 AVR  of 2", "2 Arduino", "→1", "↑2")
        self.press(80, "Tab")
        self.shows(80, "2 Arduino  of 2", "1 AVR ")
        for key, chosen in (("Up", "1 AVR"), ("Up", "2 Arduino"), ("Right", "1 AVR"), ("Left", "2 Arduino"), ("Down", "1 AVR")):
            self.press(80, key)
            self.shows(80, f"{chosen}  of 2")
        self.press(80, "F10")
        self.assertEqual(self.ended(80)[-1], "END 0")

    def test_each_on_its_line(self):
        self.open(80, "sim", "--robots", "2", "--lines", "--show=text", rows=24)
        self.shows(80, "square", "1 AVR  of 2")
        self.press(80, "q")
        self.assertEqual(self.ended(80)[-1], "END 0")

    def test_each_of_three_is_reached_in_both_directions(self):
        self.open(80, "sim", "--world", "square", "--robots", "3", "--show=text", rows=24)
        self.shows(80, "1 AVR  of 3")
        for key, chosen in (("Tab", "2 robot_2"), ("Tab", "3 robot_3"), ("Tab", "1 AVR"), ("Up", "3 robot_3"),
                            ("Left", "2 robot_2"), ("Up", "1 AVR")):
            self.press(80, key)
            self.shows(80, f"{chosen}  of 3")
        self.press(80, "q")
        self.assertEqual(self.ended(80)[-1], "END 0")

    def test_without_unicode(self):
        self.open(80, "--bus", self.socket(), "sim", "--frozen", "--show=text", rows=24, before="export LC_ALL=C NO_COLOR=1; ")
        lines = self.shows(80, "heading", "####")
        self.assertTrue("\n".join(lines).isascii())

        def beams():
            return sum(line[:54].count("-") for line in self.screen(80, joined=False)[1:])  # below the line that names the bus
        self.assertGreater(beams(), 0)
        self.press(80, "b")
        harness.waiting.until(lambda: beams() == 0, "no beams")
        self.press(80, "b")
        harness.waiting.until(beams, "beams again")
        self.press(80, "q")
        self.assertEqual(self.ended(80)[-1], "END 0")

    def test_the_terminal_is_as_it_was(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            name = f"{80 + number}"
            pid, state = os.path.join(self.folder, "pid"), os.path.join(self.folder, "state")
            self.open(name, "--bus", self.socket(), "sim", "--show=text", before=f"stty -g > {state}.before; echo $$ > {pid}; ",
                      after=f"stty -g > {state}.after; ")
            self.shows(name, "heading")
            with open(pid, encoding="ascii") as file:
                parent = file.read().strip()
            child = subprocess.run(["pgrep", "-P", parent, "amiroctl"], capture_output=True, text=True, check=True)
            os.kill(int(child.stdout), number)
            lines = self.ended(name)
            self.assertEqual(lines[-1], f"END {128 + number}", number)
            self.assertNotIn("heading", "\n".join(lines))
            harness.waiting.until(lambda: os.path.exists(f"{state}.after") and os.path.getsize(f"{state}.after"), "stty")
            before, after = (subprocess.run(["cat", f"{state}.{when}"], capture_output=True, text=True, check=True).stdout
                             for when in ("before", "after"))
            self.assertEqual(before, after)
            os.remove(f"{state}.after")

    def test_what_keeps_it_from_running_is_said_on_the_terminal(self):
        self.start_sim("--frozen")
        self.open(80, "--bus", "sim", "sim", "--show=text", rows=24)
        lines = self.ended(80)
        self.assertEqual(lines[-1], "END 1")
        self.assertRegex("\n".join(lines), r"amiroctl: .*sim")

    def test_a_terminal_that_it_cannot_use(self):
        for name, what in (("dumb", "cannot move its cursor"), ("unheard-of", "nothing is known here"), ("", "TERM is not set")):
            self.open(80, "--bus", self.socket(), "sim", "--show=text", before=f"export TERM={shlex.quote(name)}; ")
            self.assertIn(what, "\n".join(self.ended(80)))
            self.assertEqual(self.ended(80)[-1], "END 2")
            self.tmux("kill-session", "-t", "of80")
        _, refused = self.run_tool("sim", "--show=text", code=2)
        self.assertIn("sim --show=text draws on a terminal, and standard output is none", refused)
        self.assertIn("leave --show out", refused)

    def test_the_page_of_a_simulation(self):
        """Its address is printed once there is something to look at, and it ends with the simulation, which ends as without it."""
        for options, shown in (((), ""), (("--world", "square", "--robots", "1"), "map"), (("--allow-commands",), "[0-9a-f]{32}")):
            process = self.start("sim", "--show=page", "--port", "0", *options)
            line = process.stdout.readline()
            self.assertRegex(line, rf"^http://127\.0\.0\.1:\d+/{'#' + shown if shown else ''}\n$")
            port = int(re.search(r":(\d+)/", line)[1])
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
            connection.request("GET", "/")
            self.assertEqual(connection.getresponse().status, 200)
            connection.close()
            _, err = self.interrupt(process)
            self.assertEqual(process.returncode, 130)
            self.assertNotIn("amiroctl:", err)
            with self.assertRaises(OSError):
                socket.create_connection(("127.0.0.1", port), timeout=5).close()

    def test_the_page_of_a_simulation_in_a_browser(self):
        """xdg-open is played; without --open it is not called."""
        opened = os.path.join(self.folder, "opened")
        browser = os.path.join(self.folder, "xdg-open")
        with open(browser, "w", encoding="ascii") as file:
            file.write(f'#!/bin/sh\necho "$@" > {opened}.part; mv {opened}.part {opened}\n')
        os.chmod(browser, 0o755)
        self.environment |= {"PATH": f"{self.folder}:{self.environment['PATH']}", "DISPLAY": ":7"}
        for options in ((), ("--open",)):
            process = self.start("sim", "--show=page", "--port", "0", *options)
            address = process.stdout.readline()
            if options:
                harness.waiting.until(lambda: os.path.exists(opened), "that the browser is opened")
                with open(opened, encoding="ascii") as file:
                    self.assertEqual(file.read(), address)
            self.interrupt(process)
            self.assertEqual(process.returncode, 130)
            self.assertEqual(os.path.exists(opened), bool(options))

    def test_wrong_usage(self):
        self.assertIn("--show", self.run_tool("sim", "--show=colour", code=2)[1])
        spec = os.path.join(self.folder, "car.dbc")
        with open(spec, "w", encoding="ascii") as file:
            file.write('VERSION ""\nBU_: ECU\nBO_ 291 Engine: 8 ECU\n SG_ Speed : 0|16@1+ (1,0) [0|100] "" Vector__XXX\n')
        self.assertIn("no room and no robot", self.run_tool("--spec", spec, "sim", "--show=text", code=2)[1])


if __name__ == "__main__":
    harness.main()
