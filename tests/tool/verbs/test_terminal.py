"""What a person sees: on a terminal the pretty view, in colour where it is asked for."""

import os
import pty
import re
import subprocess

from harness import AMIROCTL, Case, main


class Terminal(Case):
    def on_terminal(self, *arguments, **environment):
        """Runs the tool on a pseudo terminal of its own; returns what it showed."""
        primary, secondary = pty.openpty()
        process = subprocess.Popen([AMIROCTL, *arguments], env={**self.environment, "TERM": "xterm", **environment},
                                   stdin=secondary, stdout=secondary, stderr=subprocess.DEVNULL)
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
        self.assertEqual(process.wait(timeout=10), 0)
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

    def test_no_colour(self):
        for arguments, environment in ((["--no-color"], {}), ([], {"NO_COLOR": "1"})):
            shown = self.on_terminal("listen", "-n", "2", "--timeout", "5s", *arguments, **environment)
            self.assertNotIn("\033[", shown)
            self.assertIn("gyroscope", shown)

    def test_json_when_asked_for(self):
        shown = self.on_terminal("listen", "--json", "-n", "2", "--timeout", "5s")
        self.assertEqual(len(self.objects(shown)), 2)


if __name__ == "__main__":
    main()
