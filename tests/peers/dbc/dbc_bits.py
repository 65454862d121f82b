"""The bits of a signal. A bit's number is byte * 8 + bit, bit 0 the least of its byte, in both byte orders.

Little-endian (@1): the start is the least significant bit, and the next is one number higher. Big-endian (@0): the start is the
most significant bit; the next lower one is one number lower, or bit 7 of the next byte where a byte ends. Bit by bit and slow:
that it is right must be seen by reading it."""

import struct


def positions(start, length, big_endian):
    """The numbers of a signal's bits, the least significant first."""
    if not big_endian:
        return list(range(start, start + length))
    falling = []
    for _ in range(length):
        falling.append(start)
        start = start + 15 if start % 8 == 0 else start - 1
    return falling[::-1]


def take(data, bits):
    """The unsigned number in these bits."""
    return sum((data[bit // 8] >> bit % 8 & 1) << weight for weight, bit in enumerate(bits))


def put(data, bits, number):
    """Writes the lowest bits of a number; a negative one is in two's complement."""
    for weight, bit in enumerate(bits):
        data[bit // 8] = data[bit // 8] & ~(1 << bit % 8) | (number >> weight & 1) << bit % 8


def signed(number, length):
    return number - (1 << length) if number >> (length - 1) else number


def floating(number, length):
    return struct.unpack("<f" if length == 32 else "<d", number.to_bytes(length // 8, "little"))[0]


def mask(size, many):
    """Which bits of so many bytes belong to any of these lists of bits."""
    data = bytearray(size)
    for bits in many:
        put(data, bits, -1)
    return bytes(data)
