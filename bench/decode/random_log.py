#!/usr/bin/env python3
"""A candump log of the AMiRo's six sensors, all their frames in random order with random data: random_log.py FRAMES FILE"""
import random
import sys

LENGTHS = {0x602: 8, 0x603: 8, 0x604: 8, 0x605: 4, 0x606: 4, 0x607: 4, 0x608: 6, 0x609: 6, 0x61E: 6,
           **{0x61F + i: 2 for i in range(8)}}


def main():
    count, path = int(sys.argv[1]), sys.argv[2]
    random.seed(7)
    frames = list(LENGTHS.items())
    us = 1_436_509_052_249_713
    with open(path, "w") as out:
        for _ in range(count):
            us += random.randrange(50, 500)
            number, length = random.choice(frames)
            data = random.randbytes(length).hex().upper()
            out.write(f"({us // 1_000_000}.{us % 1_000_000:06}) can0 {number:03X}#{data}\n")


main()
