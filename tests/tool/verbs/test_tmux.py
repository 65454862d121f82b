"""What stays on the screen of a real terminal: tmux, of several widths. Needs tmux."""

import os
import shlex
import shutil
import subprocess

import harness

COLUMNS = (40, 80, 120, 200)


class Screens(harness.Case):
    def setUp(self):
        super().setUp()
        self.addCleanup(self.end_terminal)
        self.assertIsNotNone(shutil.which("tmux"), "tmux is missing: scripts/setup")
        self.start_sim("--frozen")
        for topic in ("gyro", "odom", "power"):
            self.run_tool("publish", topic, "100ms")

    def end_terminal(self):
        subprocess.run(self.command("kill-server"), env=self.environment, stderr=subprocess.DEVNULL, check=False)

    def command(self, *words):
        return ["tmux", "-f", "/dev/null", "-S", os.path.join(self.folder, "tmux"), *words]

    def tmux(self, *words):
        done = subprocess.run(self.command(*words), env={**self.environment, "TERM": "xterm"}, capture_output=True,
                              text=True, timeout=20)
        self.assertEqual((done.returncode, done.stderr), (0, ""), words)
        return done.stdout

    def open(self, columns, *arguments):
        """Runs the tool on a screen of its own, which stays when it ends, and ends with the word END."""
        line = shlex.join([harness.AMIROCTL, "--bus", "sim", *arguments]) + "; printf 'END %d' $?; sleep 100"
        self.tmux("new-session", "-d", "-s", f"of{columns}", "-x", str(columns), "-y", "60", line)

    def screen(self, columns, joined=True):
        """Lines as the program wrote them: one that it left to the terminal to break is longer than the screen."""
        lines = self.tmux("capture-pane", "-p", *(["-J"] if joined else []), "-t", f"of{columns}").splitlines()
        return [line.rstrip() for line in lines]

    def ended(self, columns):
        harness.waiting.until(lambda: any(line.startswith("END ") for line in self.screen(columns)), "its end")
        lines = self.screen(columns)
        while not lines[-1]:
            lines.pop()
        return lines

    def fits(self, columns, lines):
        self.assertTrue(lines)
        self.assertLessEqual(max(map(len, lines)), columns, "\n".join(lines))

    def test_listen(self):
        for columns in COLUMNS:
            self.open(columns, "listen", "--pretty", "-n", "6", "--no-color")
        for columns in COLUMNS:
            lines = self.ended(columns)
            self.fits(columns, lines)
            # A sample says all of its numbers, whole.
            text = " ".join(" ".join(lines).split())
            self.assertRegex(text, r" gyroscope x -?[\d.]+ y -?[\d.]+ z -?[\d.]+ deg/s ")
            self.assertRegex(text, r" odometry velocity\.x -?[\d.]+ m/s .* pose\.orientation -?[\d.]+ rad ")
            self.assertRegex(lines[-1], r"^END 0$")

    def test_help(self):
        for columns in COLUMNS:
            self.open(columns, "stats", "--help")
        words = [" ".join(self.ended(columns)).split() for columns in COLUMNS]
        for columns, found in zip(COLUMNS, words):
            self.fits(columns, self.screen(columns))
            self.assertEqual(found, words[-1])
        self.assertIn("--duration", words[0])

    def test_nothing_half_stays_of_a_table_after_ctrl_c(self):
        for columns in COLUMNS:
            self.open(columns, "stats", "--no-color")
        for columns in COLUMNS:
            harness.waiting.until(lambda: any(line.startswith("TOPIC") for line in self.screen(columns)), "a table")
            self.tmux("send-keys", "-t", f"of{columns}", "C-c")
        for columns in COLUMNS:
            lines = self.ended(columns)
            self.fits(columns, lines)
            screen = "\n".join(lines)
            self.assertEqual(lines[-1], "END 130", screen)
            self.assertEqual([line.split()[0] for line in lines if "TOPIC" in line], ["TOPIC"], screen)
            self.assertEqual(len([line for line in lines if line.startswith("sim: ")]), 1, screen)
            self.assertNotIn("^C", screen)
            self.assertEqual(sorted(line[:4] for line in lines if line[:4] in ("gyro", "odom", "powe")),
                             ["gyro", "odom", "powe"], screen)

    def test_nothing_half_stays_of_listen_after_ctrl_c(self):
        self.open(80, "listen", "gyro", "--no-color")
        harness.waiting.until(lambda: any("deg/s" in line for line in self.screen(80)), "a sample")
        self.tmux("send-keys", "-t", "of80", "C-c")
        lines = self.ended(80)
        self.assertNotIn("^C", "\n".join(lines))
        self.assertRegex(lines[-2], r"^\d+ frames, \d+ samples$")


if __name__ == "__main__":
    harness.main()
