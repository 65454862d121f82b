"""What a person sees: on a terminal the pretty view, in colour where it is asked for."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import termios

from harness import AMIROCTL, SOURCE, Case, main, waiting


class Terminal(Case):
    def on_terminal(self, *arguments, columns=0, rows=50, errors=False, code=0, **environment):
        """Runs the tool on a pseudo terminal of its own; returns what it showed. 0 columns: it does not say."""
        primary, secondary = pty.openpty()
        fcntl.ioctl(secondary, termios.TIOCSWINSZ, struct.pack("HHHH", rows if columns else 0, columns, 0, 0))
        process = waiting.Program([AMIROCTL, *arguments], env={**self.environment, "TERM": "xterm", **environment},
                                  stdin=secondary, stdout=secondary, stderr=secondary if errors else subprocess.DEVNULL)
        os.close(secondary)
        shown = b""
        while True:
            try:
                piece = os.read(primary, 4096)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            shown += piece
        os.close(primary)
        self.assertEqual(process.wait(timeout=60), code)
        return shown.decode()

    def setUp(self):
        super().setUp()
        self.start_sim("--frozen")
        self.run_tool("publish", "gyro", "50ms")
        self.run_tool("publish", "mag", "50ms", "--priority", "low")

    def test_pretty_and_in_colour(self):
        shown = self.on_terminal("listen", "-n", "4", "--timeout", "5s")
        self.assertIn("\033[", shown)
        plain = re.sub(r"\033\[[0-9;]*m", "", shown).replace("\r\n", "\n")
        lines = plain.splitlines()
        self.assertEqual(len(lines), 4)
        for line in lines:
            self.assertRegex(line, r"^ +\d+\.\d{6}  (medium|low) +(gyroscope|magnetometer) +x +-?[\d.]+  y +-?[\d.]+"
                                   r"  z +-?[\d.]+ (deg/s|G)$")
        # Columns: all lines of a topic are as long as each other.
        for topic in ("gyroscope", "magnetometer"):
            self.assertEqual(len({len(line) for line in lines if topic in line}), 1)

    def test_the_severity_of_what_doctor_finds_is_in_colour(self):
        self.run_tool("send", "208#03")  # the board says that it has refused it: a note
        with open(os.path.join(SOURCE, "spec", "topics.json"), encoding="utf-8") as file:
            other = file.read().replace('"scale": 0.0175', '"scale": 0.035')  # of another robot: a problem
        spec = os.path.join(self.folder, "spec.json")
        with open(spec, "w", encoding="utf-8") as file:
            file.write(other)
        for environment, marks in (({}, ("\033[2mnote    \033[0m", "\033[31mproblem \033[0m")), ({"NO_COLOR": "1"}, ("note    ", "problem "))):
            shown = self.on_terminal("--spec", spec, "doctor", "--listen", "200ms", code=1, **environment)
            for mark in marks:
                self.assertRegex(shown, r"(?m)^" + re.escape(mark) + " di_wheel_drive: ")

    def test_no_colour(self):
        for arguments, environment in ((["--no-color"], {}), ([], {"NO_COLOR": "1"})):
            shown = self.on_terminal("listen", "-n", "2", "--timeout", "5s", *arguments, **environment)
            self.assertNotIn("\033[", shown)
            self.assertIn("gyroscope", shown)

    def test_live_stats_fit_the_width(self):
        """What is drawn again in place has no line that breaks, and what matters is in sight."""
        for columns in (40, 80, 120, 200):
            rows = 4 if columns == 200 else 50  # its last one is left free, so that nothing scrolls
            shown = self.on_terminal("stats", "--duration", "1500ms", "--no-color", columns=columns, rows=rows)
            live, _, last = shown.replace("\r\n", "\n").partition("\r\033[")  # up to where it is drawn again
            up, _, last = last.partition("\033[J")
            live, last = live.splitlines(), last.splitlines()
            self.assertEqual(up, f"{len(live)}A", shown)
            if rows == 4:
                self.assertEqual((len(live), len(last)), (3, 4), shown)
            self.assertTrue(live, shown)
            self.assertTrue(last, shown)
            self.assertLessEqual(max(map(len, live + last)), columns)
            self.assertIn("TOPIC", last[0])
            for word in ("TOPIC", "MISSING", "GAP", "LOAD", "FAULTS"):
                self.assertIn(word, live[0])
            if columns in (40, 200):
                self.assertEqual("JITTER" in live[0], columns == 200)
            self.assertRegex("\n".join(live), r"(?m)^gyro")

    def test_tables_fit_the_width_and_break_no_word(self):
        operator = os.path.join(os.environ["OCM_SOURCE_DIR"], "examples", "guard.operator.json")
        commands = [["list"], ["info", "gyro"], ["info", "motors"], ["analyse", "bus", "--no-color"], ["operate", "--check", operator]]
        for arguments in commands:
            whole = self.run_tool(*arguments)[0]
            self.assertGreater(max(map(len, whole.splitlines())), 80)
            for columns in (40, 80, 120):
                with self.subTest(arguments=arguments, columns=columns):
                    shown = self.on_terminal(*arguments, columns=columns).replace("\r\n", "\n")
                    self.assertEqual(shown.split(), whole.split())
                    for line in shown.splitlines():  # a word that is wider than the terminal has a line of its own
                        self.assertTrue(len(line) <= columns or len(line.split()) == 1, line)

    def test_of_a_topic_what_is_broken_goes_on_below_its_text(self):
        lines = self.on_terminal("info", "gyro", columns=60).splitlines()
        indents = {len(line) - len(line.lstrip()) for line in lines}
        self.assertEqual(indents, {0, 2, 13, 4, 8})  # of its facts, and of its fields

    def test_what_was_heard_fits_the_width_and_breaks_no_word(self):
        self.run_tool("send", "208#03")  # the board says that it has refused it
        for arguments, code in ((("doctor", "--listen", "300ms"), 0), (("publish", "mag", "900us", "--dry-run", "--explain"), 0)):
            whole = self.on_terminal(*arguments, "--no-color", code=code).split()
            for columns in (40, 80):
                with self.subTest(arguments=arguments, columns=columns):
                    shown = self.on_terminal(*arguments, "--no-color", columns=columns, code=code).replace("\r\n", "\n")
                    for line in shown.splitlines():
                        self.assertTrue(len(line) <= columns or len(line.split()) == 1, line)
                    words = [word for word in whole if word.isalpha()]
                    self.assertEqual(sorted(set(words) - set(shown.split())), [])

    def test_of_a_list_only_aliases_leave_their_row(self):
        rows = [line for line in self.on_terminal("list", columns=80).splitlines() if line.startswith("    ")]
        self.assertEqual({row.strip() for row in rows}, {"battery", "ambient"})

    def test_errors_break_no_word(self):
        whole = self.run_tool("publish", "mag", "900us", "--force", code=1)[1]
        self.assertGreater(max(map(len, whole.splitlines())), 80)
        for columns in (40, 60, 80):
            shown = self.on_terminal("publish", "mag", "900us", "--force", columns=columns, errors=True, code=1).replace("\r\n", "\n")
            self.assertEqual(shown.split(), whole.split())
            self.assertLessEqual(max(map(len, shown.splitlines())), columns)
            error = shown[shown.index("amiroctl: "):].splitlines()
            self.assertTrue(all(line.startswith(" " * 10) for line in error[1:]), shown)
        # Of several lines, and where only stdout is a terminal.
        missing = self.run_tool("analyse", "bus", os.path.join(self.folder, "none.csv"), code=1)[1]
        shown = self.on_terminal("analyse", "bus", os.path.join(self.folder, "none.csv"), columns=40, errors=True, code=1)
        self.assertEqual(shown.split(), missing.split())

    def test_a_table_that_just_fits_stays_as_it_is(self):
        """Whatever the width: on a terminal as wide as a table is, the table is the same."""
        log = os.path.join(self.folder, "gyro.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("".join(f"({i / 10:.6f}) can0 608#0300FFFF0000\n" for i in range(20) if i not in (7, 8)))
        tables = {}

        def table(columns):
            if columns not in tables:
                shown = self.on_terminal("stats", log, "--no-color", columns=columns).replace("\r\n", "\n")
                tables[columns] = shown.splitlines()[:2]
                self.assertLessEqual(max(map(len, shown.splitlines())), columns)
            return tables[columns]

        columns = 400
        forms = []
        while columns >= 40:
            forms.append(table(columns))
            width = max(map(len, table(columns)))
            self.assertEqual(table(width), table(columns))
            self.assertNotEqual(table(width - 1), table(columns))
            columns = width - 1
        self.assertGreater(len(forms), 9)
        # The least important goes first.
        names = ["PRIORITY", "LATE", "JITTER", "MEAN", "PERIOD", "SAMPLES", "RATE"]
        gone = [[name for name in names if name not in form[0]] for form in forms]
        self.assertEqual([each for i, each in enumerate(gone) if i == 0 or each != gone[i - 1]],
                         [names[:i] for i in range(len(names) + 1)])

    def test_progress_of_a_recording_fits_the_width(self):
        for columns in (40, 200):
            shown = self.on_terminal("record", "-o", os.path.join(self.folder, f"{columns}.log"), "--duration", "1500ms",
                                     columns=columns, errors=True)
            progress = re.findall(r"\r\033\[K(\d+ frames?, [^\r\n\033]*)", shown)
            self.assertTrue(progress, shown)
            self.assertLess(max(map(len, progress)), columns)
            self.assertEqual("free" in progress[0], columns == 200)

    def test_only_on_a_terminal_a_line_is_drawn_again(self):
        """Neither in a file nor where TERM says that it cannot be."""
        def recorded(**environment):
            return self.on_terminal("record", "-o", os.path.join(self.folder, "a.log"), "--force", "--duration", "2500ms", errors=True,
                                    **environment)
        for shown in (recorded(TERM="dumb"), self.run_tool("record", "-o", os.path.join(self.folder, "b.log"), "--duration", "1200ms")[1]):
            self.assertIn("recording to ", shown)
            self.assertNotIn("\033", shown)
        self.assertIn("\r\033[K", recorded())

    def test_a_terminal_of_two_rows_has_its_own_width(self):
        """Of fewer rows there is none: it does not say how large it is."""
        for rows, shows in ((2, 1), (3, 2), (1, 3)):  # its last one is left free; there are three, and the load
            shown = self.on_terminal("stats", "--duration", "2500ms", "--no-color", columns=90, rows=rows)
            live = shown.replace("\r\n", "\n").partition("\r\033[")[0].splitlines()
            self.assertEqual(len(live) if rows != 1 else min(len(live), 3), shows, shown)

    def test_json_when_asked_for(self):
        shown = self.on_terminal("listen", "--json", "-n", "2", "--timeout", "5s")
        self.assertEqual(len(self.objects(shown)), 2)


if __name__ == "__main__":
    main()
