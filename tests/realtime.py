"""For tests in which emulated boards keep real time: a failure counts when this machine had the time to emulate them.

An emulator that gets half of a processor falls behind the clock, and a board in it is late through no fault of its own. So
a test that fails while other programs took the processors, or the machine below this one did, or a thread was held up for
long, is run again, three times in all; what fails on a machine with time to spare fails at once. `had_time` says what that is
for a case."""

import collections
import os
import select
import threading
import time
import tty
import unittest

import waiting

MOST_LATE = 0.05  # s, of a thread that wants to wake
MOST_SLACK = 0.3  # s
WINDOW = 1.0  # s, over which a program's waits for a processor, and in the kernel, are added up
LOOKS = 30
MOST_TAKEN = 0.05  # of all processors, by what this test did not start; 0.01 on an idle machine


def processor_times():
    """(idle, all) in s since the start of the machine; time that the machine below took is in all. [proc(5): /proc/stat]"""
    with open("/proc/stat", encoding="ascii") as stat:
        ticks = [int(word) for word in stat.readline().split()[1:9]]
    return (ticks[3] + ticks[4]) / os.sysconf("SC_CLK_TCK"), sum(ticks) / os.sysconf("SC_CLK_TCK")


def own_time():
    """What this program took, and what it started and saw the end of, in s of a processor."""
    return sum(os.times()[:4])


def until_calm(limit=20):
    """Returns when a thread has woken, and a terminal has moved a byte, in time for two seconds, or after `limit` s: what failed on
    a busy machine fails there again."""
    terminal = Terminal()
    now = calm = time.monotonic()
    end = now + limit
    while now < end and now - calm < 2:
        begin = now
        time.sleep(0.01)  # how late it wakes is what counts
        now = time.monotonic()
        if now - begin - 0.01 >= MOST_LATE or terminal.late() >= MOST_LATE:
            calm = now
    terminal.close()


class Terminal:
    """How late the kernel moves the bytes of a pseudo terminal, which a worker of its own does: who waits for them sleeps, and
    does not look starved."""

    def __init__(self):
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.sent = None

    def close(self):
        os.close(self.master)
        os.close(self.slave)

    def late(self):
        """The byte that is under way, in s; then the next one goes."""
        now = time.monotonic()
        late = 0.0 if self.sent is None else now - self.sent
        arrived = self.sent is not None and select.select([self.slave], [], [], 0)[0]
        if arrived:
            os.read(self.slave, 1)
        if arrived or self.sent is None:
            os.write(self.master, b".")
            self.sent = now
        return late


class Spare:
    """Whether the machine had time to spare between `with` and its end, at which all that the test started has ended.
    `programs()`: of waiting.Program, those whose lateness counts as well; they may have ended."""

    def __init__(self, programs=tuple):
        self.programs = programs

    def __enter__(self):
        self.late = 0.0
        self.held_up = []  # (from, to) of each wait that ended later than it should have, by time.monotonic()
        self.terminal_late = 0.0
        self.blocked = collections.Counter()
        self.done = threading.Event()
        self.begin = (*processor_times(), own_time())
        self.thread = threading.Thread(target=self.watch, daemon=True)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.done.set()
        self.thread.join()
        self.look()

    def look(self):
        """The same up to now."""
        idle, total, own = (end - begin for begin, end in zip(self.begin, (*processor_times(), own_time())))
        self.taken = max(0.0, total - idle - own) / total if total else 0.0
        return self

    def watch(self):
        looks = collections.deque(maxlen=LOOKS)
        terminal = Terminal()
        over = False
        while not over:
            begin = time.monotonic()
            over = self.done.wait(0.01)  # then once more: what ended just now was late, too
            if not over:
                woken = time.monotonic()
                self.late = max(self.late, woken - begin - 0.01)
                if woken - begin > 0.02:
                    self.held_up.append((begin + 0.01, woken))
            if over or not looks or begin - looks[-1][0] >= WINDOW / LOOKS:
                looks.append((begin, self.waits(begin - looks[-1][0] if looks else 0.0)))
                before = looks[0][1]
                self.late = max(self.late, *(now - before.get(task, 0.0) for task, now in looks[-1][1].items()), 0.0)
            self.terminal_late = max(self.terminal_late, terminal.late())
        terminal.close()

    def waits(self, since):
        """Of each thread of the programs, in s so far; who is held by the kernel now was since the last look."""
        waits = {}
        for program in self.programs():
            self.blocked.update({(program.pid, task): since for task in program.blocked_threads()})
            waits |= {(program.pid, task): wait for task, wait in program.starved_threads().items()}
        return {thread: wait + self.blocked[thread] for thread, wait in waits.items()}

    def held_up_between(self, begin, end):
        """For how long, of this time, the machine let nothing run that waited for it."""
        return sum(max(0.0, min(end, late_end) - max(begin, late_begin)) for late_begin, late_end in self.held_up)

    @property
    def slack(self):
        """By how much what is timed here may be late through no fault of its own, s; what was held up for longer runs again."""
        return min(self.late, MOST_SLACK)

    def enough(self):
        return self.late < MOST_LATE and self.taken < MOST_TAKEN


class RealTime(unittest.TestCase):
    """A test case whose failures count as said above."""

    tries = 3

    def had_time(self, spare):
        return spare.enough()

    def programs(self):
        return ()

    def run(self, result=None):
        if result is None:
            result = self.defaultTestResult()
        for attempt in range(self.tries):
            trial = unittest.TestResult()
            with Spare(self.programs) as spare:
                self.spare = spare
                super().run(trial)
            if trial.wasSuccessful() or self.had_time(spare):
                break
            print(f"{self.id()} failed while this machine was busy (others took {spare.taken:.0%} of it, a thread "
                  f"or program was {spare.late * 1000:.0f} ms late, a terminal {spare.terminal_late * 1000:.0f} ms), try {attempt + 1} of {self.tries}:", flush=True)
            for _, text in trial.failures + trial.errors:
                print(text, flush=True)
            if attempt + 1 < self.tries:
                until_calm()
        result.startTest(self)
        if trial.wasSuccessful() and not trial.skipped:
            result.addSuccess(self)
        for test, reason in trial.skipped:
            result.addSkip(test, reason)
        result.failures.extend((self, text) for _, text in trial.failures)
        result.errors.extend((self, text) for _, text in trial.errors)
        result.stopTest(self)
        return result
