#!/usr/bin/env python3
"""Computes what a CAN bus does with a trace of frames, by other means than the library.

Frames are strings of bits: the CRC is a long division of polynomials, stuffing replaces runs in the string, and
arbitration is played bit by bit on a wired AND. Times are exact fractions. Nothing here knows arbitration keys,
bit counters or the library's clock. [ISO 11898-1; Bosch CAN 2.0]

    schedule.py > schedule.txt        writes the trace and its schedule (the same at every run)
    schedule.py --check schedule.txt  exit code 1 if the file says something else
"""
import difflib
import itertools
import math
import random
import re
import sys
from fractions import Fraction

CRC_POLYNOMIAL = "1100010110011001"  # x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1
FORMATS = ("base", "base_remote", "extended", "extended_remote")


class Frame:
    def __init__(self, form, ident, dlc, data):
        self.form, self.ident, self.dlc, self.data = form, ident, dlc, data
        remote = form.endswith("remote")
        rtr = "1" if remote else "0"
        if form.startswith("base"):
            self.arbitration = "0" + format(ident, "011b") + rtr + "0"  # SOF, identifier, RTR, IDE
            control = "0"  # r0
        else:
            bits = format(ident, "029b")
            self.arbitration = "0" + bits[:11] + "11" + bits[11:] + rtr  # SRR and IDE in between
            control = "00"  # r1, r0
        payload = "" if remote else "".join(format(byte, "08b") for byte in data)
        checked = self.arbitration + control + format(dlc, "04b") + payload
        self.wire = stuff(checked + crc(checked)) + "1" + "0" + "1" + "1111111"  # delimiter, ACK, delimiter, EOF

    def __str__(self):
        return f"{self.form} {self.ident:x} {self.dlc} {''.join(f'{byte:02X}' for byte in self.data) or '-'}"


def crc(bits):
    """Remainder of bits * x^15 by the polynomial, by long division."""
    rest = list(bits + "0" * 15)
    for i in range(len(bits)):
        if rest[i] == "1":
            for j, coefficient in enumerate(CRC_POLYNOMIAL):
                rest[i + j] = "1" if rest[i + j] != coefficient else "0"
    return "".join(rest[-15:])


def stuff(bits):
    """After five equal bits, stuff bits included, one of the other level."""
    done = ""
    rest = bits
    while True:
        # Search again from the last stuff bit, which counts for the next run.
        run = re.search("00000|11111", rest)
        if run is None:
            return done + rest
        done += rest[: run.end()]
        other = "1" if run.group()[0] == "0" else "0"
        rest = other + rest[run.end():]
        if len(rest) == 1:
            return done + rest


def arbitrate(offers):
    """The sender left over when each drops out that sends recessive (1) while the bus is dominant (0)."""
    left = dict(offers)
    for position in itertools.count():
        if len(left) == 1:
            return next(iter(left))
        level = min(frame.wire[position] for frame in left.values())
        left = {sender: frame for sender, frame in left.items() if frame.wire[position] == level}


class Sender:
    """A host's socket (fifo) or a board's mailboxes (by_identifier)."""

    def __init__(self, policy):
        self.policy, self.waiting = policy, []

    def offer(self, boundary):
        ready = [entry for entry in self.waiting if entry[0] <= boundary]
        if not ready:
            return None
        if self.policy == "fifo":
            return ready[0]
        # What would win if each mailbox were a node; of equal ones the oldest.
        oldest = {}
        for entry in ready:
            oldest.setdefault(entry[1].arbitration, entry)
        return oldest[arbitrate({field: entry[1] for field, entry in oldest.items()})]


def schedule(bit_rate, policies, trace):
    """[(sender, frame, start, end)] in bits, from [(handed over in ns, sender, frame)]."""
    senders = [Sender(policy) for policy in policies]
    for handed_over, sender, frame in trace:
        boundary = math.ceil(Fraction(handed_over * bit_rate, 10**9))
        senders[sender].waiting.append((boundary, frame))
    done, free = [], 0
    while any(sender.waiting for sender in senders):
        start = max(free, min(entry[0] for sender in senders for entry in sender.waiting))
        offers = {index: sender.offer(start) for index, sender in enumerate(senders)}
        offers = {index: entry for index, entry in offers.items() if entry is not None}
        winner = arbitrate({index: entry[1] for index, entry in offers.items()})
        entry = offers[winner]
        senders[winner].waiting.remove(entry)
        end = start + len(entry[1].wire)
        free = end + 3  # intermission
        done.append((winner, entry[1], start, end))
    return done


def make_trace(seed, count, senders):
    """Bursts and pauses; each sender has identifiers of its own, as the standard demands."""
    random_source = random.Random(seed)
    trace, now = [], 1000
    while len(trace) < count:
        burst = random_source.choice((1, 1, 1, 2, 3, 5, 8, 20))
        for _ in range(min(burst, count - len(trace))):
            sender = random_source.randrange(senders)
            form = random_source.choice(FORMATS[:1] * 5 + FORMATS)
            # The low bits of the first 11 tell the senders apart; few values, so that long common prefixes occur.
            ident = random_source.choice((0x000, 0x008, 0x100, 0x1F8, 0x3F0, 0x400, 0x600, 0x7F0)) + sender
            if form.startswith("extended"):
                ident = ident << 18 | random_source.choice((0, 1, 0x3FFFF, random_source.randrange(1 << 18)))
            dlc = random_source.randrange(9)
            fill = random_source.choice(("random", "zeros", "ones"))
            data = [{"random": random_source.randrange(256), "zeros": 0, "ones": 255}[fill] for _ in range(dlc)]
            if form.endswith("remote"):
                data = []
            trace.append((now, sender, Frame(form, ident, dlc, data)))
            # Mostly within one bit time, at times within one frame, at times to the nanosecond together.
            now += random_source.choice((0, 0, 1, 333, 1999, 2000, 2001, 50_000))
        now += random_source.choice((0, 10_000, 200_000, 400_000, 3_000_000)) * burst
    return trace


def report():
    yield "# Written by schedule.py: what was handed over, and what the bus made of it.\n"
    yield "# send: ns since the epoch, sender, format, identifier, DLC, data. bus: sender, the same, start and end in bits.\n"
    policies = ("fifo", "by_identifier", "fifo", "by_identifier", "fifo")
    for bit_rate, seed, count in ((500_000, 2018, 1000), (666_667, 7, 200)):
        trace = make_trace(seed, count, len(policies))
        yield f"trace {bit_rate} {' '.join(policies)}\n"
        for handed_over, sender, frame in trace:
            yield f"send {handed_over} {sender} {frame}\n"
        for sender, frame, start, end in schedule(bit_rate, policies, trace):
            yield f"bus {sender} {frame} {start} {end}\n"


def main():
    text = list(report())
    if len(sys.argv) == 3 and sys.argv[1] == "--check":
        with open(sys.argv[2], encoding="ascii") as file:
            found = file.readlines()
        difference = list(difflib.unified_diff(found, text, sys.argv[2], "computed"))
        sys.stdout.writelines(difference[:40])
        return 1 if difference else 0
    if len(sys.argv) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    sys.stdout.writelines(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
