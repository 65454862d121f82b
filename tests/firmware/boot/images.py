"""Whether an image may be flashed behind the robot's bootloader. Reads ELF and S-records by itself; what it knows of
the chips and of the bootloader is written here once more, from the sources, and not taken from the linker scripts."""

import struct
from collections import namedtuple

# Flash begins at 0x08000000 on both. Interrupts: how many the chip has [RM0008 table 63, RM0090 table 62].
# Slot: where the bootloader writes its checksum, after the vectors [OpenBLT flash.c of either chip].
Chip = namedtuple("Chip", "application flash_end ram_end interrupts slot")
CHIPS = {
    "stm32f103": Chip(0x08006000, 0x08080000, 0x20010000, 60, 0x150),
    "stm32f405": Chip(0x08008000, 0x08100000, 0x20020000, 82, 0x188),
}
RAM = 0x20000000
NOTE, NOTE_SIZE = 0x20008000, 16  # why the program restarts: read by the next one, so nothing else may be there
# Exceptions that must lead to rest and a restart: their numbers. [ARMv7-M B1.5.2]
FAULTS = {"NMI": 2, "HardFault": 3, "MemManage": 4, "BusFault": 5, "UsageFault": 6}
BLOCK = 512  # the bootloader writes its checksum together with the rest of this first block

# Interrupts that must not be the start-up code's endless loop: CAN1 transmit, receive, status change; lines 9 to 5
# and 15 to 10 (SYS_PD_N is on one of them); USART1, on which the flashing tool knocks. The same on both chips.
# WWDG's early interrupt is the watchdog's.
OBEYED = {"WWDG": 0, "CAN1_TX": 19, "CAN1_RX0": 20, "CAN1_SCE": 22, "EXTI9_5": 23, "EXTI15_10": 40, "USART1": 37}

Section = namedtuple("Section", "name address size writable loaded")
Image = namedtuple("Image", "memory sections symbols entry")  # memory: address -> byte, as flashed


# On DiWheelDrive also CAN1's second FIFO: what a host on the serial line overhears.
OF_HOST_LINE = {"CAN1_RX1": 21}


def read_elf(data):
    if data[:7] != b"\x7fELF\x01\x01\x01":
        raise ValueError("not a 32-bit little-endian ELF")
    entry, phoff, shoff = struct.unpack_from("<III", data, 24)
    phentsize, phnum, shentsize, shnum, shstrndx = struct.unpack_from("<HHHHH", data, 42)
    memory = {}
    for i in range(phnum):
        kind, offset, _, physical, size = struct.unpack_from("<IIIII", data, phoff + i * phentsize)
        if kind == 1:  # PT_LOAD
            memory.update(enumerate(data[offset:offset + size], physical))
    headers = [struct.unpack_from("<IIIIIIIIII", data, shoff + i * shentsize) for i in range(shnum)]

    def text(table, index):
        start = headers[table][4] + index
        return data[start:data.index(b"\0", start)].decode()

    sections, symbols = [], {}
    for name, kind, flags, address, offset, size, link, *_ in headers:
        if flags & 2 and size:  # SHF_ALLOC
            sections.append(Section(text(shstrndx, name), address, size, bool(flags & 1), kind != 8))
        if kind == 2:  # SHT_SYMTAB
            for at in range(offset, offset + size, 16):
                string, value, length, _, _, _ = struct.unpack_from("<IIIBBH", data, at)
                symbols[text(link, string)] = (value, length)
    return Image(memory, sections, symbols, entry)


def read_srec(lines):
    """address -> byte; ValueError for a line that is no S-record."""
    memory = {}
    for number, line in enumerate(lines, 1):
        line = line.strip()
        raw = bytes.fromhex(line[2:])
        if line[0] != "S" or raw[0] != len(raw) - 1 or sum(raw) & 0xFF != 0xFF:
            raise ValueError(f"line {number} is damaged")
        width = {"1": 2, "2": 3, "3": 4}.get(line[1])
        if width:
            memory.update(enumerate(raw[1 + width:-1], int.from_bytes(raw[1:1 + width], "big")))
    return memory


def word(memory, address):
    return sum(memory.get(address + i, 0xFF) << 8 * i for i in range(4))


def with_checksum(memory, chip):
    """What is in the flash when the bootloader is done: its checksum makes the first seven words and the slot 0."""
    total = sum(word(memory, chip.application + 4 * i) for i in range(7))
    flashed = dict(memory)
    for i, byte in enumerate(struct.pack("<I", -total & 0xFFFFFFFF)):
        flashed[chip.application + chip.slot + i] = byte
    return flashed


def starts(memory, chip):
    """The bootloader's own question before it starts a program."""
    words = [word(memory, chip.application + 4 * i) for i in range(7)] + [word(memory, chip.application + chip.slot)]
    return sum(words) & 0xFFFFFFFF == 0


def faults(image, chip, obeyed=None):
    """In words, what would go wrong; an empty list when nothing. `obeyed`: interrupts that must have a handler."""
    found = []
    low = [a for a in image.memory if a < chip.application]
    if low:
        found.append(f"programs {len(low)} bytes of the bootloader, from {min(low):#x}")
    high = [a for a in image.memory if a >= chip.flash_end]
    if high:
        found.append(f"programs {len(high)} bytes beyond the flash")
    for section in image.sections:
        if section.address < chip.flash_end:
            if section.writable and section.name != "vectors":
                found.append(f"{section.name}: variables in flash")
        elif not RAM <= section.address <= section.address + section.size <= chip.ram_end:
            found.append(f"{section.name}: outside of RAM")

    base = chip.application
    vectors, size = image.symbols.get("_vectors", (0, 0))
    if vectors != base:
        found.append(f"vectors at {vectors:#x} instead of {base:#x}")
        return found
    stray = [a for a in image.memory if base + size <= a < base + BLOCK]
    if stray:
        found.append(f"{len(stray)} bytes between the vectors and the end of the bootloader's block")

    def vector(interrupt):
        return word(image.memory, base + 64 + 4 * interrupt)

    unhandled = image.symbols["_unhandled_exception"][0] | 1
    for interrupt in range(chip.interrupts, (size - 64) // 4):
        if vector(interrupt) != unhandled:
            found.append(f"vector {interrupt} is used, and this chip has no such interrupt")
    if chip.slot < 64 + 4 * chip.interrupts:
        found.append("the checksum overwrites a vector of this chip")
    for name, interrupt in (obeyed or OBEYED).items():
        if vector(interrupt) == unhandled:
            found.append(f"no handler for {name}")

    for name, number in FAULTS.items():
        if word(image.memory, base + 4 * number) in (unhandled, 0):
            found.append(f"no handler for {name}")
    if image.symbols.get("ocm_restart_note", (0, 0))[0] != NOTE:
        found.append("the note on the restart is elsewhere")
    found += [f"{section.name}: over the note on the restart" for section in image.sections
              if section.address < NOTE + NOTE_SIZE and section.address + section.size > NOTE]

    stack, reset = word(image.memory, base), word(image.memory, base + 4)
    if not RAM < stack <= chip.ram_end or stack % 8:
        found.append(f"stack pointer {stack:#x}")
    if not (reset & 1 and base + BLOCK <= reset < chip.flash_end and reset - 1 in image.memory):
        found.append(f"reset vector {reset:#x}")
    if image.entry != reset:
        found.append(f"entry {image.entry:#x} is not the reset vector")

    # The kernel sets VTOR from a constant, which stands behind its code.
    start, length = image.symbols["chSysInit"]
    start &= ~1
    pool = [word(image.memory, a) for a in range(start - start % 4, start + length, 4)]
    if base not in pool:
        found.append("the kernel does not point VTOR to these vectors")

    if not starts(with_checksum(image.memory, chip), chip):
        found.append("the bootloader would not start it")
    return found
