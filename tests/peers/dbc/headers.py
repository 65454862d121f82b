"""What the tests of generated headers share: how names are spelled there, and what a program says of random frames beside the second
reader."""

import math
import os
import pathlib
import re

import dbc_bits
import random_dbc
import second_reader


def spelled(name):
    """As docs/generate.md says."""
    name = re.sub("[^A-Za-z0-9]+", "_", name)
    return "n" + name if name[0].isdigit() else name


def raw_of(spelling):
    """Two underscores in a row are one."""
    return spelling.removesuffix("_") + "_raw"


def raw_spelled(name):
    return raw_of(spelled(name))


def is_plain(signal):
    """The raw number is what it means."""
    return not signal.floating and signal.scale == 1 and signal.offset == 0


def selectors_first(message):
    """Of what lies beyond the message's length there is no function."""
    def depth(signal):
        return 0 if signal.selector is None else 1 + depth(message.signal(signal.selector))
    return sorted((signal for signal in message.signals if max(signal.bits()) < 8 * message.length), key=depth)


def of_folder():
    """(file, its messages with signals that fit into a frame) of each real file that has some."""
    folder = os.environ.get("OCM_DBC_FILES") or os.path.join(os.environ["OCM_SOURCE_DIR"], "examples")
    for spec in sorted(pathlib.Path(folder).rglob("*.dbc")):
        messages = [message for message in second_reader.read(spec.read_bytes()).messages if 0 < message.length <= 64 and selectors_first(message)]
        if messages:
            yield spec, messages


def data_of(chance, message):
    """Random bytes; floats that people use only where all signals lie within the message."""
    fits = len(selectors_first(message)) == len(message.signals)
    return random_dbc.data_of(chance, message) if fits else chance.randbytes(message.length)


def member_of(message, name):
    """In C++ no member of a struct has the struct's own name."""
    return spelled(name) + ("_2" if spelled(name) == spelled(message.name) else "")


def check(test, where, message, data, lines, spell=lambda _, name: spelled(name)):
    """`lines`: of each field its name, the raw number and the physical value; `raw:` and `physical:`, the bytes of a message in which
    these were put."""
    found = {words[0]: words[1:] for words in (line.split() for line in lines)}
    expected = {spell(message, name): (name, *values) for name, values in second_reader.decode(message, data).items()}
    test.assertEqual(set(found) - {"raw:", "physical:"}, set(expected), where)
    put, back = bytes.fromhex(found["raw:"][0]), bytes.fromhex(found["physical:"][0])
    used = sum(1 << bit for bit in {bit for name, *_ in expected.values() for bit in message.signal(name).bits()})
    test.assertEqual(int.from_bytes(put, "little") & used, int.from_bytes(data[:message.length], "little") & used, where)
    for spelling, (name, raw, physical) in expected.items():
        signal = message.signal(name)
        place = f"{where}: {message.name}.{name} of {data.hex()}: {found[spelling]}, {signal}"
        bits = dbc_bits.take(data, signal.bits())
        test.assertEqual(int(found[spelling][0]), bits if signal.floating else raw, place)
        value = float(found[spelling][1])
        if isinstance(physical, float):  # not a number, or infinite
            test.assertEqual(str(value), str(physical), place)
            continue
        if math.isinf(value):  # a product in between is beyond what a double holds
            test.assertGreater(abs(physical), 1e300, place)
            continue
        # Rounded once a step: the division is by a whole number.
        scale = max(abs(physical), abs(signal.offset), abs(physical - signal.offset))
        test.assertLessEqual(abs(second_reader.Fraction(value) - physical), scale * second_reader.Fraction(2) ** -50, place)
        if not signal.floating and signal.length <= 40:
            test.assertEqual(dbc_bits.take(back, signal.bits()), bits, place)
