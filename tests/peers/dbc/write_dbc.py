"""Writes a Database of second_reader as a DBC file, in one of the ways in which such files come."""

import random
import re
from fractions import Fraction

from second_reader import EXTENDED

FORMATS = ["StandardCAN", "ExtendedCAN", "reserved", "J1939PG"] + ["reserved"] * 10 + ["StandardCAN_FD", "ExtendedCAN_FD"]


def number(value, chance=None):
    """A fraction whose denominator is of twos and fives, as decimal digits; sometimes with an exponent."""
    value = Fraction(value)
    exponent = 0
    while value.denominator != 1:
        value, exponent = value * 10, exponent - 1
    digits = str(value.numerator)
    if chance is not None and chance.random() < 0.2:
        return digits + ("E-%03d" % -exponent if exponent else "E0")
    if exponent == 0:
        return digits
    sign, digits = ("-", digits[1:]) if digits[0] == "-" else ("", digits)
    digits = digits.rjust(1 - exponent, "0")
    return f"{sign}{digits[:exponent]}.{digits[exponent:]}"


def quoted(text):
    return '"' + text.replace('"', '\\"') + '"'


def short(name):
    """What a name of more than 32 characters is called where only 32 fit; the full one goes into an attribute."""
    return name if len(name) <= 32 else name[:24] + "_%07X" % (sum(map(ord, name)) * 31 + len(name))


def write(database, seed=0):
    """The seed chooses what means the same: line ends, blanks, exponents, numbers of an enumeration or its names."""
    chance = random.Random(seed)
    indent = chance.choice((" ", "  ", "\t"))
    lines = ['VERSION ""', "", "NS_ :", "\tCM_", "\tBA_DEF_", "\tBA_", "\tVAL_", "\tSG_MUL_VAL_", "", "BS_:", "",
             "BU_: " + " ".join(database.nodes)]
    for name, table in database.tables.items():
        lines.append(f"VAL_TABLE_ {name} " + " ".join(f"{key} {quoted(text)}" for key, text in table.items()) + " ;")
    comments, values, floats, ranges = [], [], [], []
    attributes = ['BA_DEF_ BO_ "VFrameFormat" ENUM ' + ",".join(map(quoted, FORMATS)) + ";",
                  'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;', 'BA_DEF_ BO_ "SystemMessageLongSymbol" STRING ;',
                  'BA_DEF_ SG_ "SystemSignalLongSymbol" STRING ;', 'BA_DEF_ SG_ "GenSigStartValue" INT 0 0;',
                  'BA_DEF_DEF_ "VFrameFormat" "StandardCAN";', 'BA_DEF_DEF_ "GenMsgCycleTime" 0;',
                  'BA_DEF_DEF_ "SystemMessageLongSymbol" "";', 'BA_DEF_DEF_ "SystemSignalLongSymbol" "";',
                  'BA_DEF_DEF_ "GenSigStartValue" 0;']
    if database.comment:
        comments.append(f"CM_ {quoted(database.comment)};")
    for node, text in database.node_comments.items():
        comments.append(f"CM_ BU_ {node} {quoted(text)};")
    for message in database.messages:
        written = message.number | (EXTENDED if message.extended else 0)
        lines += ["", f"BO_ {written} {short(message.name)}: {message.length} {message.sender}"]
        if message.frame_format:
            place = FORMATS.index(message.frame_format)
            attributes.append(f'BA_ "VFrameFormat" BO_ {written} {place};')
        if len(message.name) > 32:
            attributes.append(f'BA_ "SystemMessageLongSymbol" BO_ {written} {quoted(message.name)};')
        for name, value in message.attributes.items():
            if name not in ("VFrameFormat", "SystemMessageLongSymbol"):
                attributes.append(f'BA_ "{name}" BO_ {written} {number(value) if isinstance(value, Fraction) else quoted(value)};')
        if message.comment:
            comments.append(f"CM_ BO_ {written} {quoted(message.comment)};")
        selectors = sum(signal.is_selector for signal in message.signals)
        extended = selectors > 1 or any(signal.selector and signal.ranges != [(signal.page, signal.page)]
                                        for signal in message.signals)
        for signal in message.signals:
            name = short(signal.name)
            mark = "" if signal.page is None else f"m{signal.page}"
            mark = (" " + mark + "M" * signal.is_selector).rstrip()
            lines.append(f"{indent}SG_ {name}{mark} : {signal.start}|{signal.length}@{0 if signal.big_endian else 1}"
                         f"{'-' if signal.signed else '+'} ({number(signal.scale, chance)},{number(signal.offset, chance)}) "
                         f"[{number(signal.minimum)}|{number(signal.maximum)}] {quoted(signal.unit)} "
                         + (", " if chance.random() < 0.1 else ",").join(signal.receivers))
            if signal.comment:
                comments.append(f"CM_ SG_ {written} {name} {quoted(signal.comment)};")
            if signal.names:
                values.append(f"VAL_ {written} {name} " + " ".join(f"{key} {quoted(text)}" for key, text in signal.names.items()) + " ;")
            if signal.floating:
                colon = chance.choice((" :", ":", ""))
                floats.append(f"SIG_VALTYPE_ {written} {name}{colon} {1 if signal.length == 32 else 2};")
            if extended and signal.selector:
                text = ", ".join(f"{low}-{high}" for low, high in signal.ranges)
                ranges.append(f"SG_MUL_VAL_ {written} {name} {short(signal.selector)} {text};")
            if len(signal.name) > 32:
                attributes.append(f'BA_ "SystemSignalLongSymbol" SG_ {written} {name} {quoted(signal.name)};')
            for key, value in signal.attributes.items():
                if key != "SystemSignalLongSymbol":
                    attributes.append(f'BA_ "{key}" SG_ {written} {name} {number(value) if isinstance(value, Fraction) else quoted(value)};')
    text = "\n".join(lines + [""] + comments + attributes + values + floats + ranges)
    end = chance.choice(("\n", "\r\n"))
    text = re.sub("\n", lambda _: end, text)
    return text if chance.random() < 0.2 else text + end
