"""Databases of random messages, and random frames of them. What comes out depends on the seed alone."""

import math
import random
import struct
from fractions import Fraction

import dbc_bits
from second_reader import Database, Message, Signal, group

FD_LENGTHS = (12, 16, 20, 24, 32, 48, 64)
UNITS = ("", "", "km/h", "%", "°C", "rpm", "m/s^2", "º/s")
WORDS = ("Off", "On", "Park", "not available", "SNA", "+5 V", "\"quoted\"", "Ä", "2nd", "true")


def decimal(chance, digits=5, places=6):
    """A number that is not zero, of so many digits at most, a few of them behind the point."""
    return Fraction(chance.choice((-1, 1, 1, 1, 1)) * chance.randrange(1, 10**chance.randrange(1, digits + 1)),
                    10**chance.randrange(places + 1))


class Builder:
    def __init__(self, seed):
        self.chance = random.Random(seed)
        self.names = set()

    def name(self, first):
        """Names of a database differ by more than case; one in ten is long."""
        while True:
            length = self.chance.randrange(33, 60) if self.chance.random() < 0.1 else self.chance.randrange(1, 12)
            name = first + "".join(self.chance.choice("abcdefgh_XYZ0123456789") for _ in range(length))
            if name.lower().replace("_", "") not in self.names:
                self.names.add(name.lower().replace("_", ""))
                return name

    def database(self, messages=12):
        chance = self.chance
        database = Database(nodes=[self.name("N") for _ in range(3)], comment=chance.choice(("", "of\nlines")))
        database.node_comments = {database.nodes[0]: 'says "so"'}
        taken = set()
        while len(database.messages) < messages:
            extended = chance.random() < 0.4
            number = chance.randrange(1 << (29 if extended else 11))
            if (number, extended) in taken or (extended and group(number) in taken):
                continue
            taken.update({(number, extended), group(number) if extended else None})
            database.messages.append(self.message(number, extended, database.nodes))
        return database

    def message(self, number, extended, nodes):
        chance = self.chance
        fd = chance.random() < 0.3
        length = chance.choice(FD_LENGTHS) if fd else chance.randrange(1, 9)
        message = Message(number, extended, self.name("M"), length, chance.choice(nodes))
        message.frame_format = ("Extended" if extended else "Standard") + ("CAN_FD" if fd else "CAN")
        if extended and not fd and chance.random() < 0.3:
            message.frame_format, message.j1939 = "J1939PG", True
        if chance.random() < 0.5:
            message.attributes["GenMsgCycleTime"] = Fraction(chance.randrange(1, 1000))
        message.comment = chance.choice(("", "", 'a "word"', "two\nlines"))
        self.fill(message, nodes)
        return message

    def place(self, free, length):
        """A place for so many bits among the free ones, in either byte order; None if a few attempts find none."""
        for _ in range(30):
            big = self.chance.random() < 0.5
            start = self.chance.choice(sorted(free))
            bits = dbc_bits.positions(start, length, big)
            if free.issuperset(bits):
                return start, big, bits
        return None

    def signal(self, free, nodes, length=None):
        chance = self.chance
        floating = length is None and chance.random() < 0.15
        if floating:
            length = chance.choice((32, 64))
        if length is None:
            length = chance.choice((1, 2, chance.randrange(1, 17), chance.randrange(1, 65), 8, 16, chance.choice((63, 64, 64))))
        place = self.place(free, length)
        if place is None:
            return None
        signal = Signal(self.name("S"), place[0], length, place[1], floating or chance.random() < 0.5, floating=floating)
        free.difference_update(place[2])
        if chance.random() < 0.6:
            signal.scale = decimal(chance)
        if chance.random() < 0.4:
            signal.offset = decimal(chance)
        signal.unit = chance.choice(UNITS)
        signal.receivers = chance.sample(nodes, chance.randrange(1, 3))
        if not floating and chance.random() < 0.25:
            low = -(1 << (length - 1)) if signal.signed else 0
            numbers = {chance.randrange(low, low + (1 << length)) for _ in range(chance.randrange(1, 6))}
            signal.names = {number: chance.choice(WORDS) for number in sorted(numbers)}
        signal.comment = chance.choice(("", "", "", 'has "quotes" and; signs', "lines\nof it"))
        return signal

    def fill(self, message, nodes):
        """Plain signals in part of the message; selectors and their pages in the rest, pages over one another, up to three deep."""
        chance = self.chance
        free = set(range(8 * message.length))
        if chance.random() < 0.4 and message.length > 1:
            single = chance.random() < 0.4
            self.multiplex(message, nodes, free, None, 0, 1 if single else chance.randrange(1, 4), single)
        for _ in range(chance.randrange(1, 3 + message.length)):
            signal = self.signal(free, nodes) if free else None
            if signal is not None:
                message.signals.append(signal)
        if not message.signals:
            message.signals.append(self.signal(free, nodes, 1))
        chance.shuffle(message.signals)  # a selector may be behind what it selects

    def multiplex(self, message, nodes, free, under, page, depth, single):
        """`under`: (selector, ranges) that this selector is itself under, or None."""
        chance = self.chance
        length = chance.randrange(1, 9)
        selector = self.signal(free, nodes, length)
        if selector is None:
            return
        selector.is_selector = True
        selector.names = {}
        if under is not None:
            selector.selector, selector.ranges, selector.page = under[0], under[1], under[1][0][0]
        message.signals.append(selector)
        values = sorted(chance.sample(range(1 << length), min(1 << length, 2 * chance.randrange(1, 4))))
        pages, used = [], set()
        for low, high in zip(values[::2], values[1::2]):
            if single:  # m<n> alone says it
                pages += [[(low, low)], [(high, high)]]
            elif chance.random() < 0.3 and pages:
                pages[-1].append((low, high))  # a list of ranges
            else:
                pages.append([(low, high)])
        for ranges in pages:
            own = set(free)
            if depth > 1 and chance.random() < 0.5:
                self.multiplex(message, nodes, own, (selector.name, ranges), ranges[0][0], depth - 1, single)
            for _ in range(chance.randrange(1, 4)):
                signal = self.signal(own, nodes) if own else None
                if signal is not None:
                    signal.selector, signal.ranges, signal.page = selector.name, ranges, ranges[0][0]
                    message.signals.append(signal)
            used |= free - own
        free -= used


def database(seed, messages=12):
    return Builder(seed).database(messages)


def data_of(chance, message):
    """Random bytes, or all zeros or ones; selectors often with a value that selects something; floats that people use."""
    data = bytearray(chance.choice((bytes(message.length), b"\xff" * message.length, *[chance.randbytes(message.length)] * 8)))
    for signal in message.signals:
        if signal.floating and chance.random() < 0.8:
            number = chance.choice((0.0, -0.0, 1.5, math.inf, -math.inf, math.nan, 0.1, -3.25e-20, 1e30, chance.gauss(0, 1000)))
            image = struct.pack("<f" if signal.length == 32 else "<d", number)
            dbc_bits.put(data, signal.bits(), int.from_bytes(image, "little"))
    for signal in message.signals:
        if signal.selector is not None and chance.random() < 0.3:
            low, high = chance.choice(signal.ranges)
            dbc_bits.put(data, message.signal(signal.selector).bits(), chance.randint(low, high))
    return bytes(data)


def sent_as(chance, message):
    """An identifier that a message may have: one of J1939 has any priority, source and, where it has one, destination."""
    number = message.number
    if message.j1939 and chance.random() < 0.7:
        number = number & 0x03FFFF00 | chance.randrange(8) << 26 | chance.randrange(256)
        if (number >> 16 & 0xFF) < 240:
            number = number & ~0xFF00 | chance.randrange(256) << 8
    return number


def frames(seed, database, count):
    """(micros, message or None, identifier, extended, fd, data); one in twenty is of no message, and a few classic ones are
    longer than their message, or too short for it."""
    chance = random.Random(seed)
    micros = 1_436_509_052_249_713
    found = []
    while len(found) < count:
        micros += chance.randrange(1, 20_000)
        if chance.random() < 0.05:
            extended = chance.random() < 0.5
            number = chance.randrange(1 << (29 if extended else 11))
            if database.find(number, extended) is None:
                found.append((micros, None, number, extended, False, chance.randbytes(chance.randrange(9))))
            continue
        message = chance.choice(database.messages)
        fd = message.frame_format.endswith("FD")
        data = data_of(chance, message)
        if not fd and chance.random() < 0.1:
            data += chance.randbytes(chance.randrange(9 - message.length))
        elif not fd and chance.random() < 0.05:
            data = data[:chance.randrange(message.length)]
        found.append((micros, message, sent_as(chance, message), message.extended, fd, data))
    return found
