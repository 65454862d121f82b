"""Screens of a real terminal: tmux, of any size. Needs tmux."""

import os
import shlex
import shutil
import subprocess

import harness


class Screens(harness.Case):
    def setUp(self):
        super().setUp()
        self.addCleanup(self.end_terminal)
        self.assertIsNotNone(shutil.which("tmux"), "tmux is missing: scripts/setup")
        # Its server would end with its last session, while the next one is opened.
        self.tmux("start-server", ";", "set-option", "-g", "exit-empty", "off")

    def end_terminal(self):
        """With what runs in it: LeakSanitizer looks at a program that ends, and a terminal that hangs up meanwhile hangs it, busy."""
        listed = subprocess.run(self.command("list-panes", "-a", "-F", "#{pane_pid}"), env=self.environment, capture_output=True, text=True, check=False)
        for shell in listed.stdout.split():
            programs = subprocess.run(["pgrep", "-P", shell], capture_output=True, text=True, check=False).stdout.split()
            for program in programs:
                subprocess.run(["pkill", "-KILL", "-P", program], check=False)
            subprocess.run(["pkill", "-KILL", "-P", shell], check=False)
        subprocess.run(self.command("kill-server"), env=self.environment, stderr=subprocess.DEVNULL, check=False)

    def command(self, *words):
        return ["tmux", "-u", "-f", "/dev/null", "-S", os.path.join(self.folder, "tmux"), *words]

    def tmux(self, *words):
        done = subprocess.run(self.command(*words), env={**self.environment, "TERM": "xterm"}, capture_output=True,
                              text=True, timeout=20)
        self.assertEqual((done.returncode, done.stderr), (0, ""), words)
        return done.stdout

    def open(self, columns, *arguments, rows=60, before="", after=""):
        """Runs the tool on a screen of its own, which stays when it ends, and ends with the word END. `before` and `after`
        are commands of the shell."""
        line = before + shlex.join([harness.AMIROCTL, *arguments]) + "; printf 'END %d' $?; " + after + "sleep 100"
        self.tmux("new-session", "-d", "-s", f"of{columns}", "-x", str(columns), "-y", str(rows), line)

    def press(self, columns, *keys):
        self.tmux("send-keys", "-t", f"of{columns}", *keys)

    def shows(self, columns, *parts):
        """Waits until each part is somewhere on the screen; its lines."""
        harness.waiting.until(lambda: all(part in "\n".join(self.screen(columns)) for part in parts),
                              f"{parts} on the screen")
        return self.screen(columns)

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
