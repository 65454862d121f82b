"""What the tests of generated headers share: how names are spelled there, and what a program says of random frames beside the second
reader."""

import math
import re

import dbc_bits
import second_reader


def spelled(name):
    """As docs/generate.md says."""
    return re.sub("[^A-Za-z0-9]+", "_", name)


def raw_spelled(name):
    """Two underscores in a row are one."""
    return spelled(name).removesuffix("_") + "_raw"


def is_plain(signal):
    """The raw number is what it means."""
    return not signal.floating and signal.scale == 1 and signal.offset == 0


def selectors_first(message):
    def depth(signal):
        return 0 if signal.selector is None else 1 + depth(message.signal(signal.selector))
    return sorted(message.signals, key=depth)


def check(test, where, message, data, lines):
    """`lines`: of each field its name, the raw number and the physical value; `raw:` and `physical:`, the bytes of a message in which
    these were put."""
    found = {words[0]: words[1:] for words in (line.split() for line in lines)}
    expected = {spelled(name): (name, *values) for name, values in second_reader.decode(message, data).items()}
    test.assertEqual(set(found) - {"raw:", "physical:"}, set(expected), where)
    put, back = bytes.fromhex(found["raw:"][0]), bytes.fromhex(found["physical:"][0])
    used = sum(1 << bit for name, *_ in expected.values() for bit in message.signal(name).bits())
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
