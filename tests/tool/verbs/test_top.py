"""amiroctl top on a real terminal, tmux: its keys, its sizes, and how it leaves the terminal."""

import fcntl
import gzip
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
        # What comes meanwhile is shown when it goes on.
        self.press(100, "Escape")
        self.shows(100, "odometry")  # else the next key may come in one piece with it, and mean another
        self.run_tool("send", "7F0#01")
        self.press(100, "?", "x")
        self.assertNotIn("7F0", "\n".join(self.shows(100, "PAUSED", "odometry")))
        self.press(100, "p")
        self.shows(100, "7F0")
        self.assertNotIn("PAUSED", "\n".join(self.screen(100)))
        self.run_tool("send", "7F1#01")
        self.shows(100, "7F1")
        self.press(100, "F1")
        self.shows(100, "Any key leaves this page.")
        self.press(100, "x")
        self.shows(100, "odometry")
        self.press(100, "F10")
        self.assertEqual(self.ended(100)[-1], "END 0")

    def test_keys_that_move(self):
        self.start_bus("gyro", "odom", "power")
        self.open(100, "--bus", "sim", "top", rows=24)
        self.shows(100, "gyroscope", "odometry", "power_status")
        self.press(100, "p")  # a row that is late would change its place
        self.shows(100, "PAUSED")

        def opened():
            """The row with lines of its fields below it."""
            lines = self.screen(100, joined=False)
            return [above.split()[0] for above, below in zip(lines, lines[1:]) if below.startswith("  ") and above[:1].isalpha()]
        first, second, last = (line.split()[0] for line in self.screen(100, joined=False) if line.startswith(("gyro", "odom", "power")))
        for keys, chosen in ((("End",), last), (("Up",), second), (("Home",), first), (("NPage",), last), (("PPage",), first), (("Down",), second)):
            self.press(100, *keys, "Enter")
            harness.waiting.until(lambda name=chosen: opened() == [name], f"{chosen} opens")
            self.press(100, "Enter")
            harness.waiting.until(lambda: not opened(), "it closes")
        self.press(100, "/", "o", "x", "BSpace", "d", "Enter")
        harness.waiting.until(lambda: not self.row(100, "gyroscope"), "the filter")
        self.shows(100, "odometry", "/od")
        # Ctrl-H and Ctrl-J are what other terminals send of Backspace and Enter.
        self.press(100, "/", "p", "x", "C-h", "o", "w", "C-j")
        self.shows(100, "power_status", "  /pow", "? help")
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

    def test_the_wheel_of_a_mouse_moves_as_the_arrows_do(self):
        log = self.log(1)
        with open(log, "a", encoding="ascii") as file:
            file.write("(1000.950000) can0 7F0#01\n")
        self.open(100, "top", log, "--mouse", rows=24)
        self.shows(100, "gyroscope", "7F0", " end")
        chosen = [30, 46]  # black on cyan
        self.press(100, "Home")
        harness.waiting.until(lambda: self.look_of(100, "gyroscope") == chosen, "the first row")
        for button, row in (("a", "7F0"), ("`", "gyroscope")):
            self.tmux("send-keys", "-t", "of100", "-l", f"\x1b[M{button}!%")
            harness.waiting.until(lambda row=row: self.look_of(100, row) == chosen, row)
        self.press(100, "q")
        self.assertEqual(self.ended(100)[-1], "END 0")

    def test_any_key_leaves_the_help(self):
        """Also F12, which means nothing elsewhere."""
        self.open(100, "top", self.log(1), rows=24)
        self.shows(100, "gyroscope", " end")
        for key in ("F12", "x"):
            self.press(100, "?")
            self.shows(100, "Any key leaves this page.")
            self.press(100, key)
            self.shows(100, "gyroscope")
        self.press(100, "q")
        self.assertEqual(self.ended(100)[-1], "END 0")

    def test_no_more_than_twenty_pictures_a_second(self):
        """Keys come forty times a second. A picture is what comes in one piece: 10 ms after the one before it, at least."""
        self.start_bus("gyro", "odom")
        primary, secondary = pty.openpty()
        self.addCleanup(os.close, primary)
        fcntl.ioctl(secondary, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 100, 0, 0))
        top = harness.waiting.Program([harness.AMIROCTL, "--bus", "sim", "top"], stdin=secondary, stdout=secondary, stderr=subprocess.DEVNULL,
                                      env={**self.environment, "TERM": "xterm"}, start_new_session=True)
        self._started.append(top)
        os.close(secondary)
        self.assertTrue(select.select([primary], [], [], 30)[0])
        begin = last = time.monotonic()
        pictures = keys = 0
        while (now := time.monotonic()) - begin < 3:
            if now - begin > keys * 0.025:
                os.write(primary, b"jk"[keys % 2:keys % 2 + 1])
                keys += 1
            if select.select([primary], [], [], 0.005)[0]:
                os.read(primary, 65536)
                now = time.monotonic()
                pictures += now - last > 0.01
                last = now
        span = time.monotonic() - begin
        os.write(primary, b"q")
        self.assertEqual(top.wait(timeout=30), 0)
        self.assertGreater(keys, 100)  # of 120
        self.assertGreater(pictures, 10)  # more than the ten a second that there are without keys, if the machine has time
        self.assertLessEqual(pictures, 20 * span + 2)

    def test_from_one_picture_to_the_next(self):
        """Of a log that is played: each picture says how far it is. A key makes one, too."""
        pid = os.path.join(self.folder, "pid")
        self.open(100, "top", self.log(), "--interval", "1h", rows=24, before=f"echo $$ > {pid}; ")

        def at():
            found = re.search(r"([\d.]+) of 29\.9 s", "\n".join(self.screen(100)))
            return found and found[1]
        harness.waiting.until(at, "the first picture")
        top = subprocess.run(["pgrep", "-P", self.read(pid).strip(), "amiroctl"], capture_output=True, text=True, check=True).stdout.strip()

        def looks():
            """How often it has waited. [man 5 proc: voluntary_ctxt_switches]"""
            return int(re.search(r"^voluntary_ctxt_switches:\s*(\d+)", self.read(f"/proc/{top}/status"), re.M)[1])
        first, seen, begin = at(), looks(), time.monotonic()
        harness.waiting.until(lambda: looks() >= seen + 20, "it plays for some time")
        self.assertGreater(time.monotonic() - begin, 0.2)  # 20 ms from one look to the next
        self.assertEqual(at(), first)
        self.press(100, "p")
        self.shows(100, "paused")
        self.assertNotEqual(at(), first)
        self.press(100, "q")
        self.assertEqual(self.ended(100)[-1], "END 0")

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
        self.press(80, "Left")
        self.shows(80, " 9.0 of 29.9 s")
        self.press(80, "[")
        self.shows(80, " x0.5 paused")
        self.press(80, "]", "]")
        self.shows(80, " x2 paused")
        self.press(80, "]", "p")
        self.shows(80, " end")
        # A graph that is asked for now shows what came before.
        self.press(80, "Down", "Enter", "Down", "Space")
        self.shows(80, "▁▂")
        self.press(80, "q")
        self.assertEqual(self.ended(80)[-1], "END 0")

    def test_topics_that_are_named_are_shown_alone(self):
        log = self.log(1)
        with open(log, "a", encoding="ascii") as file:
            file.write("(1000.950000) can0 7F0#01\n")
        self.open(100, "top", log, "gyro", rows=24)
        self.shows(100, "gyroscope", " end")
        self.assertEqual(self.row(100, "7F0"), "")
        self.press(100, "q")
        self.assertEqual(self.ended(100)[-1], "END 0")
        self.assertIn("top: no topic 'gyroo'\n", self.run_tool("top", log, "gyroo", code=2)[1])

    def test_a_log_that_is_wound_back_is_counted_anew(self):
        self.open(130, "top", self.log(), rows=24)
        self.shows(130, "gyroscope", "of 29.9 s")
        self.press(130, "p", "0", "Right", "Right")
        for keys, at, frames in (((), "20.0", 201), (("Left",), "10.0", 101), ((",",), " 9.0", 91), (("0",), " 0.0", 1), ((".",), " 1.0", 11),
                                 (("Left",), " 0.0", 1), (("Right",) * 3, "29.9", 300)):  # no further than its ends
            self.press(130, *keys)
            self.shows(130, f"{at} of 29.9 s", f"{frames} frame{'' if frames == 1 else 's'}")
            harness.waiting.until(lambda frames=frames: re.search(rf" 0 +{frames} x ", self.row(130, "gyroscope")), f"{frames} samples, no fault")
        self.press(130, "q")
        self.assertEqual(self.ended(130)[-1], "END 0")

    def test_a_value_that_stays_is_a_flat_graph(self):
        self.open(100, "top", self.log(), rows=24, before="export LC_ALL=C.UTF-8; ")
        self.shows(100, "gyroscope", "of 29.9 s")
        self.press(100, "p", "0", "Right", "Home", "Space")  # graphs of all its fields
        self.shows(100, "10.0 of 29.9 s", "  x ", "  y ", "  z ", "▇█")
        for name in ("  y ", "  z "):
            self.assertRegex(self.row(100, name), r" ▁{20,} 0\.\.0$")
        self.press(100, "q")
        self.assertEqual(self.ended(100)[-1], "END 0")

    def test_characters_that_a_terminal_does_not_have(self):
        spec, log = (os.path.join(self.folder, name) for name in ("car.dbc", "car.log"))
        with open(spec, "w", encoding="utf-8") as file:
            file.write('BU_: ECU\nBO_ 291 Engine: 1 ECU\n SG_ Oil : 0|8@1+ (1,0) [0|255] "°C" ECU\n')
        with open(log, "w", encoding="ascii") as file:
            file.write("(1.0) can0 123#19\n")
        for name, locale, unit in (("70", "C", "?C"), ("71", "C.UTF-8", "°C")):
            self.open(name, "--spec", spec, "top", log, rows=24, before=f"export LC_ALL={locale}; ")
            self.shows(name, f"Oil 25 {unit}", "for its load: --bitrate 500k")
            self.press(name, "q")
            self.assertEqual(self.ended(name)[-1], "END 0")

    def test_a_log_of_any_dbc(self):
        spec, log = (os.path.join(self.folder, name) for name in ("car.dbc", "car.log"))
        with open(spec, "w", encoding="ascii") as file:
            file.write('VERSION ""\nNS_ :\nBS_:\nBU_: ECU\nBO_ 291 Engine: 8 ECU\n SG_ Speed : 0|16@1+ (0.25,0) [0|16000] "rpm" Vector__XXX\n'
                       ' SG_ Gear : 16|4@1+ (1,0) [0|6] "" Vector__XXX\n\nVAL_ 291 Gear 0 "neutral" 1 "first" ;\n')
        with open(log, "w", encoding="ascii") as file:
            file.writelines(f"({10 + i / 10:.6f}) can0 123#{i:02X}0F010000000000\n({10.01 + i / 10:.6f}) can0 124#FF\n" for i in range(40))
        self.open(100, "--spec", spec, "top", log, "--bitrate", "500k", rows=24)
        self.shows(100, "Engine", "of 3.9 s", "  worst ")
        self.press(100, "p", "0", "Right", "Down", "Enter")
        value = next(event["fields"]["Speed"] for event in reversed(self.objects(self.run_tool("--spec", spec, "decode", "--json", log)[0]))
                     if "fields" in event)
        self.shows(100, f"{value:g} rpm", "first", "124", "FF")
        self.press(100, "q")
        self.assertEqual(self.ended(100)[-1], "END 0")

    def test_can_fd_is_in_the_load_where_its_bit_rate_is_given(self):
        log = os.path.join(self.folder, "fd.log")
        with open(log, "w", encoding="ascii") as file:
            file.writelines(f"({1000 + i / 10:.6f}) can0 7F0##1DEADBEEF\n" for i in range(5))
        for name, options in ((100, ()), (101, ("--data-bitrate", "2M"))):
            self.open(name, "top", log, *options, rows=24)
            lines = self.shows(name, " end", "5 frames  5 unknown", "DE AD BE EF")
            self.assertEqual([line for line in lines if "frames  " in line and "unknown" in line],
                             ["5 frames  5 unknown" + ("" if options else "  5 CAN FD, not in the load")])
            self.press(name, "q")
            self.assertEqual(self.ended(name)[-1], "END 0")

    def test_a_log_that_is_cut_while_it_is_played(self):
        log = self.log(seconds=300)
        self.open(120, "top", log, rows=24)
        self.shows(120, "of 299.9 s")
        with open(log, encoding="ascii") as file:
            kept = "".join(file.readlines()[:2000])
        os.truncate(log, len(kept))
        self.press(120, "0", *"]" * 10)
        self.shows(120, "1000 of 3000 frames are not there any more")
        self.press(120, "q")
        lines = self.ended(120)
        self.assertEqual(lines[-1], "END 1")
        self.assertRegex(" ".join(lines), r"drive\.log: 1000 of 3000 frames are not there any more: was it cut, or replaced\?")

    def test_a_log_whose_end_cannot_be_read(self):
        with open(self.log(seconds=60), "rb") as file:
            packed = gzip.compress(file.read())
        log = os.path.join(self.folder, "cut.log.gz")
        with open(log, "wb") as file:
            file.write(packed[: len(packed) // 2])
        self.open(120, "top", log, rows=24)
        self.shows(120, "gyroscope")
        self.press(120, "q")
        lines = self.ended(120)
        self.assertEqual(lines[-1], "END 1")
        self.assertIn("cut.log.gz: 1 place could not be read", " ".join(lines))

    def test_stopped_and_continued(self):
        """Ctrl-Z gives the shell its terminal back, and fg brings the table again."""
        self.start_bus("gyro")
        shell = "bash --norc --noprofile -i"
        self.tmux("new-session", "-d", "-s", "of90", "-x", "90", "-y", "24", f"PS1='ready> ' {shell}; printf 'END %d' $?; sleep 100")
        self.shows(90, "ready>")
        self.press(90, f"{shlex.quote(harness.AMIROCTL)} --bus sim top", "Enter")
        self.shows(90, "gyroscope", "frames/s")
        self.press(90, "C-z")
        self.shows(90, "Stopped")
        self.assertNotIn("frames/s", "\n".join(self.screen(90)))
        self.press(90, "stty -a | grep -o '.icanon'", "Enter")
        harness.waiting.until(lambda: any(line.strip() == "icanon" for line in self.screen(90)), "lines, as before")
        self.press(90, "fg", "Enter")
        self.shows(90, "gyroscope", "frames/s")
        harness.waiting.until(lambda: re.search(r"gyros\w* +(9\.\d\d|10\.\d)", self.row(90, "gyros")), "its rate")
        self.press(90, "q")
        # What is typed before it has left the terminal is its own, or lost.
        harness.waiting.until(lambda: "\n".join(self.screen(90)).rstrip().endswith("ready>"), "the shell's prompt")
        # Not its screen alone: LeakSanitizer looks at it when that is gone, and a terminal that hangs up then hangs it.
        self.press(90, "echo LEFT=$?", "Enter")
        self.assertNotIn("frames/s", "\n".join(self.shows(90, "LEFT=0")))

    def drawn(self, *arguments, **environment):
        """What it writes to the terminal, which has one character for a while."""
        primary, secondary = pty.openpty()
        self.addCleanup(os.close, primary)
        fcntl.ioctl(secondary, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 100, 0, 0))
        top = harness.waiting.Program([harness.AMIROCTL, *arguments], stdin=secondary, stdout=secondary, stderr=subprocess.DEVNULL,
                                      env={**self.environment, "TERM": "xterm-256color", **environment}, start_new_session=True)
        self._started.append(top)
        shown = b""

        def until(test):
            nonlocal shown
            end = time.monotonic() + 30
            while not test():
                self.assertLess(time.monotonic(), end, shown[-1000:])
                if select.select([primary], [], [], 0.1)[0]:
                    shown += os.read(primary, 65536)
        until(lambda: b"gyroscope" in shown)
        for rows, columns in ((1, 1), (1, 100), (24, 1), (2, 2), (24, 100)):
            fcntl.ioctl(secondary, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
            top.send_signal(signal.SIGWINCH)
            before = len(shown)
            os.write(primary, b"G?xg")
            until(lambda: len(shown) > before)
        os.close(secondary)
        os.write(primary, b"q")
        while top.poll() is None:
            if select.select([primary], [], [], 0.1)[0]:
                try:
                    shown += os.read(primary, 65536)
                except OSError:  # the terminal is closed
                    break
        self.assertEqual(top.wait(timeout=30), 0)
        return shown.decode(errors="replace")

    def test_a_terminal_that_is_closed_ends_it(self):
        """One that is not its own, so that no signal says so."""
        primary, secondary = pty.openpty()
        fcntl.ioctl(secondary, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 100, 0, 0))
        top = harness.waiting.Program([harness.AMIROCTL, "top", self.log()], stdin=secondary, stdout=secondary, stderr=subprocess.DEVNULL,
                                      env={**self.environment, "TERM": "xterm"}, start_new_session=True)
        self._started.append(top)
        os.close(secondary)
        shown = b""
        while b"gyroscope" not in shown:
            self.assertTrue(select.select([primary], [], [], 30)[0], shown[-1000:])
            shown += os.read(primary, 65536)
        os.close(primary)
        self.assertEqual(top.wait(timeout=30), 0)

    def test_colours_and_none(self):
        log = self.log(seconds=1)
        colour = re.compile(r"\x1b\[(?:\d+;)*(?:3[0-8]|4[0-8]|9[0-7]|10[0-7])(?:;\d+)*m")
        self.assertRegex(self.drawn("top", log), colour)
        for arguments, environment in ((("top", "--no-color", log), {}), (("top", log), {"NO_COLOR": "1"})):
            shown = self.drawn(*arguments, **environment)
            self.assertNotRegex(shown, colour)
            self.assertRegex(shown, r"\x1b\[(?:\d+;)*[17](?:;\d+)*m")  # bold and reverse are left

    def look_of(self, columns, word):
        """Colours and weight of the first character of a word on the screen, as numbers of SGR [ECMA-48, 8.3.117]."""
        now = set()  # tmux says what changes, also from one line to the next
        for line in self.tmux("capture-pane", "-p", "-e", "-t", f"of{columns}").splitlines():
            plain, looks = "", []
            for codes, character in re.findall(r"\x1b\[([\d;]*)m|(.)", line):
                if character and character != "\x0f":
                    plain += character
                    looks.append(sorted(now))
                for code in [] if character else map(int, (codes or "0").split(";")):
                    if code in (0, 39, 49):
                        now = {each for each in now if code and each // 10 != code // 10}
                    else:
                        now = {each for each in now if each < 30 or each // 10 != code // 10} | {code}
            if word in plain:
                return looks[plain.index(word)]
        return None

    def test_colours_of_what_is_late_chosen_and_well(self):
        log = os.path.join(self.folder, "late.log")
        with open(log, "w", encoding="ascii") as file:
            file.write("(1000.000000) can0 208#01640000\n")  # the gyroscope is asked for, and does not come
            file.writelines(f"({1000.01 + i / 10:.6f}) can0 7F0#01\n" for i in range(40))
        black, green, yellow, red, cyan = 30, 32, 33, 31, 36
        background, bold, dim, reverse = 10, 1, 2, 7
        coloured = (("late.log", [bold]), ("AMiRo", [dim]), ("PAUSED", [yellow]), ("1 missing", [bold, red]), ("gyroscope", [bold, red]),
                    ("NAME", [black, cyan + background]), ("HZ", [black, green + background]), ("7F0", [black, cyan + background]),
                    ("===", [green]), ("x1 paused", [bold]), ("? help", [dim]), ("2.0 of", []))
        plain = (("late.log", [bold]), ("AMiRo", []), ("PAUSED", [bold]), ("1 missing", [bold]), ("gyroscope", [bold]),
                 ("NAME", [bold, reverse]), ("HZ", [reverse]), ("7F0", [reverse]),
                 ("===", []), ("x1 paused", [bold]), ("? help", []), ("2.0 of", []))
        for name, options, looks in ((100, (), coloured), (101, ("--no-color",), plain)):
            self.open(name, "top", *options, log, rows=24)
            self.shows(name, "7F0")
            self.press(name, "p", "0", ".", ".", ">", "End")
            self.shows(name, "2.0 of 3.9 s", "PAUSED", "1 missing", "by name")
            for word, look in looks:
                harness.waiting.until(lambda name=name, word=word, look=look: self.look_of(name, word) == look,
                                      f"{word}: {look}, not {self.look_of(name, word)}")
            self.press(name, "q")
            self.assertEqual(self.ended(name)[-1], "END 0")

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
        for before, what, remedy in (("export TERM=dumb", "cannot move its cursor", "amiroctl stats and listen write to anything"),
                                     ("export TERM=unheard-of", "nothing is known here", "TERM=xterm-256color amiroctl top, or install ncurses-term"),
                                     ("export TERM=", "TERM is not set", "TERM=xterm-256color amiroctl top"),
                                     ("exec < /dev/null", "top draws on a terminal, and standard input is none", "amiroctl stats and listen")):
            self.open(80, "--bus", "sim", "top", before=f"{before}; ")
            lines = self.ended(80)
            self.assertIn(what, "\n".join(lines))
            self.assertIn(remedy, "\n".join(lines))
            self.assertEqual(lines[-1], "END 2")
            self.tmux("kill-session", "-t", "of80")
        _, refused = self.run_tool("top", code=2)
        self.assertIn("top draws on a terminal, and standard output is none", refused)
        self.assertIn("amiroctl stats", refused)
        self.assertNotIn("bus:", refused)  # before it looks for one

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
