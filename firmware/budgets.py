#!/usr/bin/env python3
"""Holds the images against firmware/budgets.json: flash and RAM of each, in bytes.

    budgets.py FOLDER             fails when an image is larger than its budget, or has none, or a budget no image
    budgets.py FOLDER --write     records what the images have now, rounded up: 1 KiB of flash, 256 bytes of RAM
    ... --budgets FILE            these instead: firmware/avr/budgets.json for what firmware/avr builds

Flash is what is programmed: vectors, code, constants, initial values. RAM is variables and all stacks; what is
left of a chip's RAM is unused. (An AVR's image has one stack, which takes what is left.) Images of tests have no
budget. Exit code: 0 all within, 1 not, 2 usage."""

import argparse
import json
import pathlib
import subprocess
import sys

GRAIN = {"flash": 1024, "ram": 256}
AVR_DATA = 0x800000  # where avr-gcc's linker scripts have the data space; flash is from 0 on
BUDGETS = pathlib.Path(__file__).with_name("budgets.json")


def sections(listing):
    """What `size -A` printed: name -> (size, address)."""
    found = {}
    for line in listing.splitlines():
        fields = line.split()
        if len(fields) == 3 and fields[1].isdigit() and fields[2].isdigit():
            found[fields[0]] = (int(fields[1]), int(fields[2]))
    return found


def figures(listing):
    """Flash and RAM of an image. `.heap` is what the linker had left over."""
    flash = ram = 0
    for name, (size, address) in sections(listing).items():
        if name.startswith((".debug", ".comment", ".note", ".ARM")):
            continue
        if address < AVR_DATA + 0x10000 and name in (".text", ".data", ".bss", ".noinit"):
            flash += size if name in (".text", ".data") else 0
            ram += size if address >= AVR_DATA else 0
        elif 0x08000000 <= address < 0x10000000:
            flash += size
        elif 0x10000000 <= address < 0x40000000 and name != ".heap":
            ram += size
            flash += size if name == ".data" else 0
    return {"flash": flash, "ram": ram}


def compare(images, budgets):
    """Sentences on what is wrong."""
    for name in sorted(images.keys() | budgets.keys()):
        if name not in budgets:
            yield f"{name}: no budget; record one with --write"
        elif name not in images:
            yield f"{name}: a budget without an image"
        else:
            for what in ("flash", "ram"):
                have, may = images[name][what], budgets[name][what]
                if have > may:
                    yield (f"{name}: {what} {have} bytes, {have - may} over its budget of {may}. "
                           "Make it smaller, or say in the change why it is worth it and record it with --write")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--budgets", type=pathlib.Path, default=BUDGETS)
    options = parser.parse_args()
    images = {}
    for image in sorted(options.folder.glob("*.elf")):
        if "_test_" in image.stem:
            continue
        size = "avr-size" if "_atmega" in image.stem else "arm-none-eabi-size"
        listing = subprocess.run([size, "-A", str(image)], check=True, capture_output=True, text=True)
        images[image.stem] = figures(listing.stdout)
        print(f"{image.stem:28} flash {images[image.stem]['flash']:6}   RAM {images[image.stem]['ram']:6}")
    if options.write:
        rounded = {name: {what: -(-size // GRAIN[what]) * GRAIN[what] for what, size in image.items()}
                   for name, image in images.items()}
        options.budgets.write_text(json.dumps(rounded, indent=2) + "\n", encoding="utf-8")
        return 0
    problems = list(compare(images, json.loads(options.budgets.read_text(encoding="utf-8"))))
    print("\n".join(problems))
    return 1 if problems or not images else 0


if __name__ == "__main__":
    sys.exit(main())
