#!/usr/bin/env python3
"""Says what is wrong with amiroctl for the operator's board.

    binary.py FILE

It must be an ARM program for an ARMv7-A with hard float, ask for no library and no loader, hold no symbols, and be
smaller than 3 MiB. Exit code: 0 all so, 1 not, 2 usage."""

import pathlib
import struct
import sys

LIMIT = 3 * 1024 * 1024
ARM, EXECUTABLE = 40, 2                # [ELF for the Arm Architecture, 5.1]
HARD_FLOAT = 0x400                     # [the same, table 5-2: EF_ARM_ABI_FLOAT_HARD]
DYNAMIC, INTERPRETER = 2, 3            # types of segments
SYMBOLS, ATTRIBUTES = 2, 0x70000003    # types of sections
CPU_ARCH, CPU_ARCH_PROFILE, FP_ARGUMENTS = 6, 7, 28  # [Addenda to the ABI for the Arm Architecture, 3.3.5]
TEXTS = {4, 5, 32, 65, 67}             # the tags whose values are texts


def uleb128(data, at):
    value = shift = 0
    while True:
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            return value, at


def attributes(section):
    """Tag -> value of the whole file, by vendor "aeabi"."""
    found = {}
    assert section[:1] == b"A"
    size = struct.unpack_from("<I", section, 1)[0]
    at = section.index(b"\0", 5) + 1        # behind the vendor's name
    assert section[at] == 1, "not of the file"
    at += 5
    while at < 1 + size:
        tag, at = uleb128(section, at)
        if tag in TEXTS:
            end = section.index(b"\0", at)
            found[tag], at = section[at:end].decode(), end + 1
        else:
            found[tag], at = uleb128(section, at)
    return found


def problems(image):
    if image[:6] != b"\x7fELF\x01\x01":
        yield "no ELF file of 32 bits, little endian"
        return
    (kind, machine, _, _, segments_at, sections_at, flags, _, segment_size, segments, section_size,
     sections, _) = struct.unpack_from("<HHIIIIIHHHHHH", image, 16)
    if machine != ARM:
        yield f"made for machine {machine}, not for ARM"
        return
    if kind != EXECUTABLE:
        yield "no program with a fixed place"
    if not flags & HARD_FLOAT:
        yield "passes floating point numbers in integer registers"
    types = {struct.unpack_from("<I", image, segments_at + i * segment_size)[0] for i in range(segments)}
    if types & {DYNAMIC, INTERPRETER}:
        yield "not static: it asks for libraries or a loader"
    tags = {}
    for i in range(sections):
        _, section, _, _, offset, size = struct.unpack_from("<6I", image, sections_at + i * section_size)
        if section == SYMBOLS:
            yield "not stripped"
        if section == ATTRIBUTES:
            tags = attributes(image[offset:offset + size])
    if tags.get(CPU_ARCH) != 10 or tags.get(CPU_ARCH_PROFILE) != ord("A"):
        yield f"made for architecture {tags.get(CPU_ARCH)}, profile {tags.get(CPU_ARCH_PROFILE)}, not for ARMv7-A (10, 65)"
    if tags.get(FP_ARGUMENTS) != 1:
        yield "its attributes do not say that floating point arguments travel in registers of their own"
    if len(image) >= LIMIT:
        yield f"{len(image)} bytes: not under {LIMIT}"


def main(arguments):
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    image = pathlib.Path(arguments[0]).read_bytes()
    wrong = list(problems(image))
    print("\n".join(wrong) or f"{len(image)} bytes, {LIMIT - len(image)} under the limit")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
