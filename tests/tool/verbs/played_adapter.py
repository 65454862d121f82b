"""A serial CAN adapter (SLCAN), played on a pty by the manual of LAWICEL's CAN232 and without a line of the library."""

import os
import pty
import re
import select
import threading
import time
import tty

import waiting  # the harness has put its folder on the path
from realtime import RealTime

FRAME = re.compile(r"^(?:t([0-7][0-9A-Fa-f]{2})|T([01][0-9A-Fa-f]{7}))([0-8])((?:[0-9A-Fa-f]{2})*)$")
BAD_LENGTH, BAD_PERIOD, NOT_SERVED, NOT_SCHEDULABLE = 3, 6, 8, 15
DI_WHEEL_DRIVE, POWER_MANAGEMENT, LIGHT_RING = 0x1D, 0x3B, 0x59


def refusal(number, reason, board=DI_WHEEL_DRIVE, count=1):
    """What the board says, as the adapter passes it on."""
    return f"t7{board:02X}8{number:02X}{reason:02X}{count:02X}000000000000" + "10\r"


class Adapter:
    """An adapter with a robot behind it: `script` maps a frame that the host sends, in candump's notation, to the
    lines that go up after it."""

    def __init__(self, script=None, refuse=(), mute=False, stamps=True):
        self.script, self.refuse, self.mute, self.with_stamps = script or {}, set(refuse), mute, stamps
        self.frames, self.commands = [], []
        self.open, self.rate, self.stamped = False, None, False
        self.full = 0  # so many frames are refused
        self.events = 0  # bits of the next answer to F
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.path = os.ttyname(self.slave)
        self.quiet_looks = 0  # so many times there was nothing to read, one after another
        self.ended = threading.Event()
        self.asleep = threading.Event()  # reads nothing and answers nothing
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        line = b""
        while not self.ended.is_set():
            if self.asleep.is_set():
                self.quiet_looks = 0
                time.sleep(0.01)
                continue
            if not select.select([self.master], [], [], 0.02)[0]:
                self.quiet_looks += 1
                continue
            self.quiet_looks = 0
            for byte in os.read(self.master, 4096):
                if byte != 13:
                    line += bytes([byte])
                    continue
                answer, up = self.obey(line.decode("latin-1"))
                line = b""
                if not self.mute:
                    self.say(answer)
                for text in up:
                    self.say(text)

    def obey(self, command):
        ok, refused = "\r", "\a"
        letter = command[:1]
        self.commands.append(command)
        if letter in self.refuse:
            return refused, []
        if letter == "":
            return ok, []
        if letter in "tT":
            match = FRAME.match(command)
            if not self.open or not match or len(match[4]) != 2 * int(match[3]):
                return refused, []
            if self.full:
                self.full -= 1
                return refused, []
            text = f"{match[1] or match[2]}#{match[4]}".upper()
            self.frames.append(text)
            return ("z" if letter == "t" else "Z") + "\r", self.script.get(text, [])
        if command == "V":
            return "V1013\r", []
        if command == "C":
            was, self.open = self.open, False
            return ok if was else refused, []
        if command == "O":
            if self.open or self.rate is None:
                return refused, []
            self.open = True
            return ok, []
        if command == "F":
            events, self.events = self.events, 0
            return f"F{events:02X}\r" if self.open else refused, []
        if re.fullmatch("S[0-8]", command) and not self.open:
            self.rate = [10, 20, 50, 100, 125, 250, 500, 800, 1000][int(command[1])]
            return ok, []
        if re.fullmatch("Z[01]", command) and not self.open and self.with_stamps:
            self.stamped = command == "Z1"
            return ok, []
        return refused, []

    def read_all(self):
        """Returns when it has obeyed all that was on the line, and nothing more comes for 0.2 s."""
        self.quiet_looks = -1  # the look that is under way may have been before the last byte
        waiting.until(lambda: self.quiet_looks >= 10, "the adapter has read all of the line")

    def say(self, text):
        os.write(self.master, text.encode("latin-1"))

    def unplug(self):
        self.ended.set()
        self.thread.join()
        os.close(self.master)
        os.close(self.slave)


class WithAdapter(RealTime):
    """For test cases: adapters that are unplugged at the end. They answer in time where the machine has the time: the tool
    takes one that says nothing for a second for one that never does. On a busy machine a terminal may be later than that, again
    and again."""
    tries = 6
    had_time = RealTime.had_time

    def adapter(self, **options):
        adapter = Adapter(**options)
        self.addCleanup(lambda: adapter.ended.is_set() or adapter.unplug())
        return adapter
