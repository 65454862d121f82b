"""Runs amiroctl and a simulator in a folder of their own, so that tests never meet each other or the user's bus."""

import concurrent.futures
import faulthandler
import json
import os
import signal
import subprocess
import sys
import tempfile
import unittest

AMIROCTL = os.environ["AMIROCTL"]
SOURCE = os.environ["OCM_SOURCE_DIR"]
sys.path.insert(0, os.path.join(SOURCE, "tests"))
import waiting
from realtime import RealTime

# What commands a robot ends when it did not run for half a second. [docs/verbs/drive.md]
STOOD_STILL_S = 0.3


def sanitized():
    """Whether the tool has the address sanitizer in it, which takes memory and time of its own."""
    with open(AMIROCTL, "rb") as program:
        return b"__asan_init" in program.read()


class Case(RealTime):
    """A test case with its own runtime folder; nothing is inherited from the user's environment. A failure counts unless this
    machine did not run meanwhile: programs that command a robot then end, as they have to."""

    most_late = STOOD_STILL_S  # of a test that passes all the same

    def had_time(self, spare):
        return max(spare.late, spare.terminal_late) < self.most_late

    def programs(self):
        return tuple(getattr(self, "_started", ()))

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="ocm-test-")
        self.folder = self._folder.name
        self.environment = {"PATH": os.environ["PATH"], "XDG_RUNTIME_DIR": self.folder, "HOME": self.folder}
        self._started = []
        self.addCleanup(self._end)

    def _end(self):
        """Also where setUp fails, after which no tearDown is called: nothing stays behind."""
        for process in self._started:
            if process.poll() is None:
                # LeakSanitizer looks at a program that ends from a child, which a signal may hang; it keeps the streams open.
                subprocess.run(["pkill", "-KILL", "-P", str(process.pid)], check=False)
                process.kill()
            if process.stderr is not None and process.stderr.closed:  # by a test
                process.stderr = None
            process.communicate()
        self._folder.cleanup()

    def script(self, text):
        """The path of a file with these lines, for `run`."""
        path = os.path.join(self.folder, "steps.script")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def start(self, *arguments, **options):
        streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        process = waiting.Program([AMIROCTL, *arguments], env=self.environment, text=True, **(streams | options))
        self._started.append(process)
        return process

    def run_tool(self, *arguments, code=0, stdin="", timeout=30):
        """Runs to the end and checks the exit code; returns (stdout, stderr)."""
        process = self.start(*arguments, stdin=subprocess.PIPE)
        out, err = process.communicate(stdin, timeout=timeout)
        self.assertEqual(process.returncode, code, f"{arguments}: {out}{err}")
        return out, err

    def start_sim(self, *arguments):
        """Starts a simulator and returns when it can be reached: it says so when its socket listens."""
        sim = self.start("sim", *arguments)
        for line in sim.stderr:
            if "Ctrl-C ends it" in line:
                return sim
        self.fail(f"the simulator ended with {sim.wait()}")

    def listen(self, *arguments):
        """Starts `listen --json` and returns when it is subscribed: it says which bus it uses before it listens."""
        listener = self.start("listen", "--json", *arguments)
        self.assertIn("bus: sim", listener.stderr.readline())
        self.settle()
        return listener

    def settle(self):
        """Returns when every program that was started has read and handed on what there was, and waits for more."""
        waiting.until_asleep(*(process.pid for process in self._started if process.poll() is None))

    def interrupt(self, process, number=signal.SIGINT):
        process.send_signal(number)
        return process.communicate(timeout=60)

    @staticmethod
    def objects(text):
        return [json.loads(line) for line in text.splitlines()]


class Together(unittest.TestSuite):
    """Four cases at a time."""

    def run(self, result, debug=False):
        def alone(case):
            own = unittest.TestResult()
            case.run(own)
            return own

        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            for own in pool.map(alone, cases(self)):
                result.testsRun += own.testsRun
                for outcome in ("failures", "errors", "skipped", "expectedFailures", "unexpectedSuccesses"):
                    getattr(result, outcome).extend(getattr(own, outcome))
        return result


def cases(suite):
    for test in suite:
        if isinstance(test, unittest.TestSuite):
            yield from cases(test)
        else:
            yield test


class TogetherRunner(unittest.TextTestRunner):
    def run(self, test):
        return super().run(Together(cases(test)))


def main(together=False):
    """`together`: for cases that wait for the clock more than they work."""
    # A case that hangs is ended by ctest after 1200 s, without a word; this says where it hangs.
    faulthandler.dump_traceback_later(1180)
    unittest.main(verbosity=1, testRunner=TogetherRunner if together else None)
