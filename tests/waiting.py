"""Waits for events, never for a time: what a test may wait for in place of a sleep."""

import contextlib
import os
import subprocess
import threading
import time


def until(holds, what, limit=30):
    """Returns when `holds()` is true; what it is, is said when it does not become so."""
    end = time.monotonic() + limit
    while not holds():
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not within {limit} s")
        time.sleep(0.01)


def thread_states(pid):
    """Of each thread of a process the letter of its state. [man 5 proc: stat] Without those that have ended."""
    tasks = f"/proc/{pid}/task"
    states = {}
    try:
        for task in os.listdir(tasks):
            with open(f"{tasks}/{task}/stat", encoding="utf-8") as file:
                states[task] = file.read().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        pass
    return states


def asleep(pid):
    """Whether all threads of a process wait, or are stopped. One that has something to do, and gets no processor, does not."""
    return all(state in "SZT" for state in thread_states(pid).values())


def blocked_threads(pid):
    """The threads of a process that the kernel holds now, where no signal comes through: for the disk, or for a worker of its own,
    which on a busy machine moves the bytes of a terminal a second late."""
    return {task for task, state in thread_states(pid).items() if state == "D"}


def starved_threads(pid):
    """Of each thread of a process: for how many seconds it could have worked so far, and had no processor. [Linux,
    Documentation/scheduler/sched-stats: schedstat] Without those that have ended."""
    tasks = f"/proc/{pid}/task"
    seconds = {}
    try:
        for task in os.listdir(tasks):
            with open(f"{tasks}/{task}/schedstat", encoding="utf-8") as file:
                seconds[task] = int(file.read().split()[1]) / 1e9
    except (FileNotFoundError, ProcessLookupError):
        pass
    return seconds


class Talk(threading.Thread):
    """Reads all of a stream, or writes a text to it, and closes it."""

    def __init__(self, stream, input):
        super().__init__(daemon=True)
        self.stream, self.input, self.text, self.error = stream, input, None, None
        self.start()

    def run(self):
        try:
            with contextlib.suppress(BrokenPipeError), self.stream:
                if self.stream.readable():
                    self.text = self.stream.read()
                elif self.input:
                    self.stream.write(self.input)
        except Exception as error:  # for who waits: bytes that are no text
            self.error = error


class Program(subprocess.Popen):
    """A program of which it is known after its end, too, how long its threads had no processor: the kernel counts a wait once
    it is over, and who was held up for too long may end within the next millisecond."""

    at_end = {}
    talks = {}

    def starved_threads(self):
        """As above; after its end what was known then, of the threads that it had left."""
        return self.at_end if self.returncode is not None else starved_threads(self.pid)

    def blocked_threads(self):
        return set() if self.returncode is not None else blocked_threads(self.pid)

    def communicate(self, input=None, timeout=None):
        """As that of the base class, which leaves out what a stream has read ahead while lines were read from it."""
        if not self.talks:
            self.talks = {stream: Talk(stream, input) for stream in (self.stdin, self.stdout, self.stderr) if stream and not stream.closed}
        end = None if timeout is None else time.monotonic() + timeout
        for talk in self.talks.values():
            talk.join(end and max(0, end - time.monotonic()))
            if talk.is_alive():  # it goes on, for who asks again
                raise subprocess.TimeoutExpired(self.args, timeout)
            if talk.error:
                raise talk.error
        self.wait(end and max(0, end - time.monotonic()))
        return tuple(talk and talk.text for talk in (self.talks.get(self.stdout), self.talks.get(self.stderr)))

    def has_ended(self, patience=os.WNOHANG):
        """It is still there, to be looked at, until `poll` or `wait` has taken its exit code."""
        ended = os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOWAIT | patience) is not None
        if ended:
            self.at_end = starved_threads(self.pid)
        return ended

    def poll(self):
        return super().poll() if self.returncode is not None or self.has_ended() else None

    def wait(self, timeout=None):
        if self.returncode is None and timeout is None:
            self.has_ended(0)
        elif self.returncode is None:
            end = time.monotonic() + timeout
            while not self.has_ended():
                if time.monotonic() >= end:
                    raise subprocess.TimeoutExpired(self.args, timeout)
                time.sleep(0.001)
        return super().wait()


def starved(pid):
    """The same of all its threads together."""
    return sum(starved_threads(pid).values())


def until_asleep(*pids, looks=5, limit=30):
    """Returns when all of them wait at the same time, look after look: each has read and handed on what there was.
    For processes on one bus: those that write to it are named, too. [man 5 proc: stat]"""
    seen = 0

    def all_asleep():
        nonlocal seen
        seen = seen + 1 if all(map(asleep, pids)) else 0
        return seen >= looks
    until(all_asleep, f"processes {pids} come to rest", limit)


def printed(file):
    """All that a running program has printed into a file that was handed to it. Read by position: the program writes at
    the offset that it shares with us, and over what it has written when that is set back for reading."""
    text = b""
    while piece := os.pread(file.fileno(), 1 << 20, len(text)):
        text += piece
    return text.decode(errors="replace")
