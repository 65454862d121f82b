"""A reader of DBC files that shares nothing with amiroctl's: it is what amiroctl is judged against.

`read(text or bytes)` gives a Database, `decode(message, data)` the signals that a frame carries. Scales are fractions, so that
values are exact. It is for files that are right: what is doubtful in them it reads as it can, without a word."""

import collections
import dataclasses
import re
from fractions import Fraction

import dbc_bits

EXTENDED = 0x80000000
INDEPENDENT = ("VECTOR__INDEPENDENT_SIG_MSG", 0x40000000)
KEYWORDS = {"VERSION", "NS_", "BS_", "BU_", "BO_", "SG_", "CM_", "BA_DEF_", "BA_DEF_DEF_", "BA_", "VAL_", "VAL_TABLE_", "SIG_VALTYPE_",
            "SG_MUL_VAL_", "SIG_GROUP_", "BO_TX_BU_", "EV_", "ENVVAR_DATA_", "EV_DATA_", "SGTYPE_", "SIG_TYPE_REF_", "BA_DEF_REL_",
            "BA_REL_", "BA_DEF_DEF_REL_", "BU_SG_REL_", "BU_EV_REL_", "BU_BO_REL_", "BA_DEF_SGTYPE_", "BA_SGTYPE_", "CAT_DEF_", "CAT_",
            "FILTER", "SIGTYPE_VALTYPE_", "SGTYPE_VAL_"}
FRAME_FORMATS = {0: "StandardCAN", 1: "ExtendedCAN", 3: "J1939PG", 14: "StandardCAN_FD", 15: "ExtendedCAN_FD"}


@dataclasses.dataclass
class Signal:
    name: str
    start: int
    length: int
    big_endian: bool = False
    signed: bool = False
    scale: Fraction = Fraction(1)
    offset: Fraction = Fraction(0)
    minimum: Fraction = Fraction(0)
    maximum: Fraction = Fraction(0)
    unit: str = ""
    receivers: list = dataclasses.field(default_factory=list)
    is_selector: bool = False
    page: int = None  # of m<page>
    selector: str = None  # which signal selects this one, and by which of its raw values
    ranges: list = dataclasses.field(default_factory=list)
    floating: bool = False
    names: dict = dataclasses.field(default_factory=dict)
    comment: str = ""
    attributes: dict = dataclasses.field(default_factory=dict)

    def bits(self):
        return dbc_bits.positions(self.start, self.length, self.big_endian)


@dataclasses.dataclass
class Message:
    number: int
    extended: bool
    name: str
    length: int
    sender: str = "Vector__XXX"
    signals: list = dataclasses.field(default_factory=list)
    comment: str = ""
    attributes: dict = dataclasses.field(default_factory=dict)
    frame_format: str = ""
    j1939: bool = False
    other_senders: list = dataclasses.field(default_factory=list)

    def signal(self, name):
        return next((signal for signal in self.signals if signal.name == name), None)


@dataclasses.dataclass
class Database:
    nodes: list = dataclasses.field(default_factory=list)
    messages: list = dataclasses.field(default_factory=list)
    comment: str = ""
    node_comments: dict = dataclasses.field(default_factory=dict)
    attributes: dict = dataclasses.field(default_factory=dict)
    tables: dict = dataclasses.field(default_factory=dict)
    node_attributes: dict = dataclasses.field(default_factory=dict)
    definitions: dict = dataclasses.field(default_factory=dict)  # (what it is of, name) -> (type, bounds, names)
    defaults: dict = dataclasses.field(default_factory=dict)
    unused: collections.Counter = dataclasses.field(default_factory=collections.Counter)  # what means nothing for frames, by keyword

    def message(self, name):
        return next((message for message in self.messages if message.name == name), None)

    def attribute(self, of, attributes, name):
        """Given, or by default where it is defined for such an object."""
        return attributes.get(name, self.defaults.get(name) if (of, name) in self.definitions else None)

    def find(self, number, extended):
        """Whose frame this is: the exact identifier counts first, and then the parameter group of J1939."""
        for message in self.messages:
            if (message.number, message.extended) == (number, extended):
                return message
        for message in self.messages:
            if extended and message.j1939 and group(message.number) == group(number):
                return message
        return None


def group(number):
    """The PGN of 29 bits: below format 240 the byte behind the format is a destination. [SAE J1939-21]"""
    return number >> 8 & (0x3FF00 if (number >> 16 & 0xFF) < 240 else 0x3FFFF)


class Text(str):
    """What stands in quotation marks; other tokens are plain words."""


TOKEN = re.compile(r'"((?:\\"|[^"])*)"|([:;,|@()\[\]])|([^\s:;,|@()\[\]"]+)')


def tokens_of(text):
    """(token, line, whether it is the first of its line)."""
    found, line, at, last = [], 1, 0, 0
    for match in TOKEN.finditer(text):
        line += text.count("\n", at, match.start())
        at = match.start()
        quoted, mark, word = match.groups()
        found.append((Text(quoted.replace('\\"', '"')) if quoted is not None else mark or word, line, line != last))
        last = line + text.count("\n", at, match.end())
    return found


class Parser:
    def __init__(self, text):
        self.tokens = tokens_of(text)
        self.at = 0
        self.database = Database()
        self.by_id = {}
        self.defined = {}  # attribute -> (type, its names)
        self.defaults = self.database.defaults
        self.multiplexed = set()  # ids that have SG_MUL_VAL_

    def more(self):
        return self.at < len(self.tokens)

    def peek(self, ahead=0):
        return self.tokens[self.at + ahead][0] if self.at + ahead < len(self.tokens) else ""

    def next(self):
        self.at += 1
        return self.tokens[self.at - 1][0]

    def expect(self, mark):
        if self.next() != mark:
            raise ValueError(f"line {self.tokens[self.at - 1][1]}: expected {mark}")

    def is_statement(self):
        token, _, first = self.tokens[self.at]
        return first and not isinstance(token, Text) and token in KEYWORDS

    def rest_of_line(self):
        """The words up to the next line, or to the next keyword at the start of one."""
        line = self.tokens[self.at - 1][1]
        words = []
        while self.more() and self.tokens[self.at][1] == line:
            words.append(self.next())
        return words

    def rest(self):
        """The tokens up to the semicolon."""
        words = []
        while self.more() and self.peek() != ";":
            if self.is_statement() and self.peek() != "SG_" and words:
                return words
            words.append(self.next())
        if self.more():
            self.next()
        return words

    def run(self):
        while self.more():
            word = self.next()
            if isinstance(word, Text):
                continue
            if word == "NS_":
                while self.more() and self.peek() not in ("BS_", "BU_", "BO_"):
                    self.next()
            elif word == "BU_":
                self.expect(":")
                while self.more() and not self.is_statement():
                    self.database.nodes.append(self.next())
            elif word == "BO_":
                self.message()
            elif word in ("CM_", "VAL_", "VAL_TABLE_", "SIG_VALTYPE_", "SG_MUL_VAL_", "BA_DEF_", "BA_DEF_DEF_", "BA_"):
                words = self.rest()
                try:
                    getattr(self, word.strip("_").lower())(words)
                except (IndexError, KeyError, AttributeError):
                    pass  # of a signal or message that the file does not have
            elif word == "BO_TX_BU_":
                number, _, *senders = self.rest()
                if int(number) in self.by_id:
                    found = self.by_id[int(number)]
                    found.other_senders = [sender for sender in senders if sender not in (",", found.sender)]
            elif word == "VERSION":
                self.database.unused[word] += bool(self.next())
            elif word in KEYWORDS and word != "BS_":
                self.database.unused[word] += 1
                self.rest()
        self.finish()
        return self.database

    def message(self):
        written = int(self.next())
        name = self.next()
        self.expect(":")
        length = int(self.next())
        extended = bool(written & EXTENDED) or written > 0x7FF
        message = Message(written & 0x1FFFFFFF, extended, name, length)
        sender = self.rest_of_line()
        message.sender = sender[0] if sender else ""
        while self.more() and self.peek() == "SG_":
            self.next()
            message.signals.append(self.signal())
        if name != INDEPENDENT[0] and written & ~EXTENDED != INDEPENDENT[1]:
            self.database.messages.append(message)
            self.by_id[written] = message
        else:
            self.database.unused[INDEPENDENT[0]] += len(message.signals)

    def signal(self):
        signal = Signal(self.next(), 0, 0)
        if self.peek() != ":":
            mark = self.next()
            signal.is_selector = mark.endswith("M")
            number = mark.strip("mM")
            signal.page = int(number) if number else None
        self.expect(":")
        signal.start = int(self.next())
        self.expect("|")
        signal.length = int(self.next())
        self.expect("@")
        order = self.next()
        signal.big_endian, signal.signed = order[0] == "0", order[1] == "-"
        self.expect("(")
        signal.scale = Fraction(self.next())
        self.expect(",")
        signal.offset = Fraction(self.next())
        self.expect(")")
        self.expect("[")
        signal.minimum = Fraction(self.next())
        self.expect("|")
        signal.maximum = Fraction(self.next())
        self.expect("]")
        signal.unit = str(self.next())
        signal.receivers = [word for word in self.rest_of_line() if word != ","]
        return signal

    def find(self, written, name):
        return self.by_id[int(written)].signal(name)

    def cm(self, words):
        if isinstance(words[0], Text):
            self.database.comment = str(words[0])
        elif words[0] == "BU_":
            self.database.node_comments[words[1]] = str(words[2])
        elif words[0] == "BO_":
            self.by_id[int(words[1])].comment = str(words[2])
        elif words[0] == "SG_":
            self.find(*words[1:3]).comment = str(words[3])

    def val_table(self, words):
        self.database.tables[words[0]] = pairs(words[1:])

    def val(self, words):
        names = words[2:]
        self.find(*words[:2]).names = (self.database.tables[names[0]] if len(names) == 1 else pairs(names))

    def sig_valtype(self, words):
        self.find(*words[:2]).floating = words[-1] in ("1", "2")

    def sg_mul_val(self, words):
        signal = self.find(*words[:2])
        self.multiplexed.add(int(words[0]))
        signal.selector = words[2]
        signal.ranges = [tuple(map(int, re.fullmatch(r"(\d+)-(\d+)", word).groups())) for word in words[3:] if word != ","]

    def ba_def(self, words):
        name = next(word for word in words if isinstance(word, Text))
        after = words[words.index(name) + 1:]
        names = [str(word) for word in after[1:] if isinstance(word, Text)]
        bounds = [Fraction(word) for word in after[1:] if not isinstance(word, Text) and word != ","]
        self.defined[name] = after[0], names
        if words[0] == "EV_":
            self.database.unused["BA_DEF_ EV_"] += 1
        else:
            self.database.definitions[words[0] if words[0] != name else "", str(name)] = after[0], bounds, names

    def ba_def_def(self, words):
        self.defaults[words[0]] = self.value(words[0], words[1])

    def ba(self, words):
        value = self.value(words[0], words[-1])
        if words[1] == "BO_":
            self.by_id[int(words[2])].attributes[str(words[0])] = value
        elif words[1] == "SG_":
            self.find(*words[2:4]).attributes[str(words[0])] = value
        elif words[1] == "BU_":
            self.database.node_attributes.setdefault(words[2], {})[str(words[0])] = value
        elif words[1] != "EV_":
            self.database.attributes[str(words[0])] = value

    def value(self, name, word):
        """An enumeration's value is written as its name or as its place in the list."""
        kind, names = self.defined.get(name, ("STRING", []))
        if isinstance(word, Text):
            return str(word)
        if kind == "ENUM":
            return names[int(word)]
        return Fraction(word)

    def finish(self):
        long = {node: kept["SystemNodeLongSymbol"] for node, kept in self.database.node_attributes.items() if "SystemNodeLongSymbol" in kept}
        self.database.nodes = [long.get(node, node) for node in self.database.nodes]
        self.database.node_comments = {long.get(node, node): text for node, text in self.database.node_comments.items()}
        self.database.node_attributes = {long.get(node, node): kept for node, kept in self.database.node_attributes.items()}
        protocol = self.database.attributes.get("ProtocolType", self.defaults.get("ProtocolType"))
        for written, message in self.by_id.items():
            frame_format = message.attributes.get("VFrameFormat", self.defaults.get("VFrameFormat"))
            if isinstance(frame_format, Fraction):
                frame_format = FRAME_FORMATS.get(int(frame_format), "")
            message.frame_format = frame_format or ""
            message.j1939 = message.extended and (message.frame_format == "J1939PG" or
                                                  (frame_format is None and protocol == "J1939"))
            message.name = message.attributes.get("SystemMessageLongSymbol", message.name)
            message.sender = long.get(message.sender, message.sender)
            message.other_senders = [long.get(sender, sender) for sender in message.other_senders]
            selectors = [signal.name for signal in message.signals if signal.is_selector]
            if written not in self.multiplexed and len(selectors) == 1:
                for signal in message.signals:
                    if signal.page is not None:
                        signal.selector, signal.ranges = selectors[0], [(signal.page, signal.page)]
            renamed = {signal.name: signal.attributes.get("SystemSignalLongSymbol", signal.name) for signal in message.signals}
            for signal in message.signals:
                signal.name = renamed[signal.name]
                signal.receivers = [long.get(receiver, receiver) for receiver in signal.receivers]
                signal.selector = renamed.get(signal.selector)


def pairs(words):
    return {int(number): str(name) for number, name in zip(words[::2], words[1::2])}


def read(data):
    if isinstance(data, bytes):
        try:
            data = data.decode()
        except UnicodeDecodeError:
            data = data.decode("cp1252", errors="replace")
    return Parser(data.lstrip("\ufeff")).run()


def selected(message, signal, data):
    """Whether a frame has this signal: its selector is there, too, and has one of the values. Raw bits count, without sign."""
    if signal.selector is None:
        return True
    by = message.signal(signal.selector)
    if max(by.bits()) >= 8 * len(data):
        return False
    return selected(message, by, data) and any(low <= dbc_bits.take(data, by.bits()) <= high for low, high in signal.ranges)


def raw(signal, data):
    """The number in the bits; of a float the float."""
    number = dbc_bits.take(data, signal.bits())
    if signal.floating:
        return dbc_bits.floating(number, signal.length)
    return dbc_bits.signed(number, signal.length) if signal.signed else number


def physical(signal, number):
    """Exact; but NaN and infinity are floats."""
    if isinstance(number, float) and number - number != 0:
        return number if number != number or signal.scale > 0 else -number
    return Fraction(number) * signal.scale + signal.offset


def decode(message, data):
    """The signals that the frame has, in the order of the file: name -> (raw, physical)."""
    found = {}
    for signal in message.signals:
        if max(signal.bits()) < 8 * len(data) and selected(message, signal, data):
            number = raw(signal, data)
            found[signal.name] = number, physical(signal, number)
    return found
