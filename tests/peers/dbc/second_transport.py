"""J1939's transport protocol as a listener hears it, a second time: made from [SAE J1939-21, 5.10] alone, and shares nothing with
amiroctl's. `read(frames)` gives the messages that came whole, and how the others ended.

TP.CM is group EC00, its first byte says what it is, the last three the group of the message, lowest first:
  32 BAM  size (2), packets, FF                       16 RTS  size (2), packets, most packets of a CTS
  17 CTS  packets that may be sent, the first, FF FF  19 EndOfMsgACK  size (2), packets, FF     255 Abort  reason, FF FF FF
TP.DT is group EB00: the packet's number, from 1, and seven bytes. Times: T1 750 ms between packets, T2 and T3 1250 ms from a CTS to
the packet and from the last packet to the next CTS, T4 1050 ms after a CTS of no packets, by which the receiver keeps it waiting."""

import collections
import dataclasses

T1, T2, T3, T4 = 750_000, 1_250_000, 1_250_000, 1_050_000  # microseconds
BAM, RTS, CTS, END, ABORT = 32, 16, 17, 19, 255


@dataclasses.dataclass
class Transfer:
    """What was announced, and what came of it."""
    group: int
    size: int
    packets: int
    connected: bool
    until: int  # when the next frame must have come
    expected: int = 1
    asked: int = 0  # the last packet that the receiver asked for
    came: dict = dataclasses.field(default_factory=dict)
    end: str = ""  # how it ended; empty while it goes on


def is_transport(number):
    return number >> 16 & 0x3FF in (0xEB, 0xEC)


def group_of(data):
    number = int.from_bytes(data[5:8], "little")
    return number & 0x3FF00 if (number >> 8 & 0xFF) < 240 else number


def read(frames, last):
    """frames: (micros, bus, identifier of 29 bits, data). `last`: when the listener stopped.
    Returns {index of a frame: (priority, group, destination, source, data)} and a Counter of ends."""
    transfers = {}  # the latest of a (bus, source, destination)
    whole, ends = {}, collections.Counter()

    def over(transfer, how):
        if not transfer.end:
            transfer.end = how
            ends[how] += 1

    def alive(key, now):
        transfer = transfers.get(key)
        if transfer is not None and now > transfer.until:
            over(transfer, "timed out")
            del transfers[key]
            return None
        return transfer

    for index, (now, bus, number, data) in enumerate(frames):
        if not is_transport(number):
            continue
        source, destination = number & 0xFF, number >> 8 & 0xFF
        there, back = (bus, source, destination), (bus, destination, source)
        if len(data) != 8:
            ends["malformed"] += 1
        elif number >> 16 & 0xFF == 0xEB:
            transfer = alive(there, now)
            if transfer is None:
                ends["stray"] += 1
                continue
            packet = data[0]
            transfer.until = now + (T3 if packet == transfer.asked else T1)
            if transfer.end:
                pass
            elif not transfer.expected <= packet <= transfer.packets:
                over(transfer, "wrong number")
            elif not transfer.connected and packet > transfer.expected:
                over(transfer, "lost packet")
            else:
                transfer.came[packet] = data[1:]
                transfer.expected = packet + 1
                if len(transfer.came) == transfer.packets:
                    over(transfer, "whole")
                    text = b"".join(transfer.came[each + 1] for each in range(transfer.packets))
                    whole[index] = number >> 26 & 7, transfer.group, destination, source, text[:transfer.size]
            if transfer.end and not transfer.connected and packet == transfer.packets:
                del transfers[there]
        elif int.from_bytes(data[5:8], "little") > 0x3FFFF:
            ends["malformed"] += 1
        elif data[0] in (BAM, RTS) and (data[0] == BAM) == (destination == 0xFF):
            if (transfer := alive(there, now)) is not None:
                over(transfer, "replaced")
            transfers.pop(there, None)
            size, packets = int.from_bytes(data[1:3], "little"), data[3]
            if not 9 <= size <= 1785 or packets != -(-size // 7):
                ends["bad size"] += 1
                continue
            connected = data[0] == RTS
            transfers[there] = Transfer(group_of(data), size, packets, connected, now + (T3 if connected else T1),
                                        asked=0 if connected else packets)
        elif data[0] == CTS:
            transfer = alive(back, now)
            if transfer is None or transfer.group != group_of(data):
                continue
            count, first = data[1], data[2]
            transfer.until = now + (T2 if count else T4)
            if count and not 1 <= first <= transfer.packets:
                over(transfer, "wrong number")
            elif count:
                transfer.expected, transfer.asked = first, min(first + count - 1, transfer.packets)
                for packet in range(first, transfer.asked + 1):
                    transfer.came.pop(packet, None)
        elif data[0] == END:
            transfer = alive(back, now)
            if transfer is not None and transfer.group == group_of(data):
                over(transfer, "lost packet")
                del transfers[back]
        elif data[0] == ABORT:
            for key in (back, there):
                transfer = alive(key, now)
                if transfer is not None and transfer.group == group_of(data):
                    over(transfer, "aborted")
                    del transfers[key]
                    break
        else:
            ends["malformed"] += 1
    for key in list(transfers):
        transfer = alive(key, last)
        if transfer is not None and not transfer.end:
            ends["open"] += 1
    return whole, ends
