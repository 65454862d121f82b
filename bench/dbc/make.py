#!/usr/bin/env python3
"""A DBC file like a car's, and a candump log of its frames in random order with random data:
make.py DBC MESSAGES SIGNALS [LOG FRAMES]

Signals are 1 to 16 bits wide, of both byte orders, six in ten with a scale, one in six with names of values. One message in ten has
29 bits, one in twenty a selector with two pages. All have eight bytes."""
import random
import sys

UNITS = ("", "", "km/h", "rpm", "%", "V", "A", "Nm", "deg/s", "bar")
SCALES = ("1", "1", "1", "1", "0.1", "0.01", "0.5", "0.25", "0.0625", "0.001")
WIDTHS = (1, 1, 1, 1, 2, 2, 3, 4, 4, 5, 8, 8, 12, 16)


def widths(chance, count):
    """So many signals in 64 bits, in an order in which they fit one after another."""
    while True:
        chosen = [chance.choice(WIDTHS) for _ in range(count)]
        if sum(chosen) <= 64:
            return chosen


def signal(chance, name, mark, at, width, big):
    """Bits `at` to `at + width - 1`; big-endian ones are counted from the highest bit of byte 0."""
    start = at // 8 * 8 + 7 - at % 8 if big else at
    offset = chance.choice(("0", "0", "0", "-40"))
    return (f' SG_ {name}{mark} : {start}|{width}@{0 if big else 1}{chance.choice("++-")} ({chance.choice(SCALES)},{offset}) [0|0] '
            f'"{chance.choice(UNITS)}" Receiver')


def main():
    path, messages, signals = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    chance = random.Random(7)
    lines, values, frames, made = ['VERSION ""', "", "BU_: Sender Receiver"], [], [], 0
    base, wide = chance.sample(range(0x800), messages), chance.sample(range(0x20000000), messages)
    for index in range(messages):
        extended = index % 10 == 3
        number = wide[index] if extended else base[index]
        written = number | (0x80000000 if extended else 0)
        count = signals * (index + 1) // messages - made
        made += count
        big = chance.random() < 0.5  # a message is of one order, as most are
        lines += ["", f"BO_ {written} Message_{index}: 8 Sender"]
        paged = index % 20 == 5 and count >= 8
        at = 0
        for place, width in enumerate(widths(chance, count if not paged else count // 2 + 1)):
            mark = "" if not paged else " M" if place == 0 else " m0"
            name = f"Signal_{index}_{place}"
            if paged and place == 0:
                width = 1
            lines.append(signal(chance, name, mark, at, width, big))
            if paged and 0 < place < count - count // 2:  # the other page has the same places
                lines.append(signal(chance, f"Signal_{index}_{place + 50}", " m1", at, width, big))
            at += width
            if chance.random() < 1 / 6:
                values.append(f'VAL_ {written} {name} 0 "off" 1 "on" ;' if width == 1 else f'VAL_ {written} {name} 0 "idle" 1 "active" 2 "fault" ;')
        frames.append(f"{number:08X}" if extended else f"{number:03X}")
    with open(path, "w") as out:
        out.write("\n".join(lines + [""] + values) + "\n")
    if len(sys.argv) > 4:
        us = 1_436_509_052_249_713
        with open(sys.argv[4], "w") as out:
            for _ in range(int(sys.argv[5])):
                us += chance.randrange(50, 500)
                out.write(f"({us // 1_000_000}.{us % 1_000_000:06}) can0 {chance.choice(frames)}#{chance.randbytes(8).hex().upper()}\n")


main()
