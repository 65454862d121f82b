"""For tests in which emulated boards keep real time: a failure counts when this machine had the time to emulate them.

An emulator that gets half of a processor falls behind the clock, and a board in it is late through no fault of its own. So
a test that fails while other programs took the processors, or held one up for long, is run again, three times in all; what
fails on a machine with time to spare fails at once."""

import threading
import time
import unittest

MOST_LATE = 0.05  # s, of a thread that wants to wake
LEAST_IDLE = 0.4  # of all processors; three emulated boards at full load leave about half of two


def processor_times():
    """(idle, all) in ticks since the start of the machine. [proc(5): /proc/stat]"""
    with open("/proc/stat", encoding="ascii") as stat:
        ticks = [int(word) for word in stat.readline().split()[1:]]
    return ticks[3] + ticks[4], sum(ticks)


class Spare:
    """Whether the machine had time to spare between `with` and its end."""

    def __enter__(self):
        self.late = 0.0
        self.done = threading.Event()
        self.begin = processor_times()
        self.thread = threading.Thread(target=self.watch, daemon=True)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.done.set()
        self.thread.join()
        idle, total = (end - begin for begin, end in zip(self.begin, processor_times()))
        self.idle = idle / total if total else 1.0

    def watch(self):
        while not self.done.is_set():
            begin = time.monotonic()
            time.sleep(0.01)
            self.late = max(self.late, time.monotonic() - begin - 0.01)

    def enough(self):
        return self.late < MOST_LATE and self.idle > LEAST_IDLE


class RealTime(unittest.TestCase):
    """A test case whose failures count as said above."""

    tries = 3

    def run(self, result=None):
        if result is None:
            result = self.defaultTestResult()
        for attempt in range(self.tries):
            trial = unittest.TestResult()
            with Spare() as spare:
                super().run(trial)
            if trial.wasSuccessful() or spare.enough():
                break
            print(f"{self.id()} failed while this machine was busy ({spare.idle:.0%} idle, a thread woke "
                  f"{spare.late * 1000:.0f} ms late), try {attempt + 1} of {self.tries}:", flush=True)
            for _, text in trial.failures + trial.errors:
                print(text, flush=True)
        result.startTest(self)
        if trial.wasSuccessful() and not trial.skipped:
            result.addSuccess(self)
        for test, reason in trial.skipped:
            result.addSkip(test, reason)
        result.failures.extend((self, text) for _, text in trial.failures)
        result.errors.extend((self, text) for _, text in trial.errors)
        result.stopTest(self)
        return result
