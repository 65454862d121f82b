#!/usr/bin/env python3
"""The images of the real boards, and the check itself: each fault is made once, and must be found."""

import os
import pathlib
import unittest

import images

IMAGES = pathlib.Path(os.environ["OCM_IMAGES"])
OBEYED = {"di_wheel_drive": {**images.OBEYED, **images.OF_HOST_LINE}}
BOARDS = {"di_wheel_drive": "stm32f103", "light_ring": "stm32f103", "power_management": "stm32f405"}


def load(board):
    path = IMAGES / f"{board}_{BOARDS[board]}.elf"
    return images.read_elf(path.read_bytes()), images.CHIPS[BOARDS[board]], path


class Boards(unittest.TestCase):
    def test_lie_behind_the_bootloader(self):
        for board in BOARDS:
            with self.subTest(board):
                image, chip, _ = load(board)
                self.assertEqual(images.faults(image, chip, OBEYED.get(board)), [])

    def test_s_records_say_the_same_as_the_elf(self):
        for board in BOARDS:
            with self.subTest(board):
                image, _, path = load(board)
                with open(path.with_suffix(".srec"), encoding="ascii") as lines:
                    records = images.read_srec(lines)
                self.assertTrue(records.items() <= image.memory.items())
                # A segment of the ELF also has what fills the gaps between its sections.
                gaps = {a: byte for a, byte in image.memory.items() if a not in records}
                self.assertLess(len(gaps), 32)
                self.assertFalse(any(gaps.values()))

    def test_checksum_changes_no_vector_of_the_chip(self):
        for board in BOARDS:
            with self.subTest(board):
                image, chip, _ = load(board)
                flashed = images.with_checksum(image.memory, chip)
                self.assertTrue(images.starts(flashed, chip))
                self.assertFalse(images.starts(image.memory, chip))
                used = range(chip.application, chip.application + 64 + 4 * chip.interrupts)
                self.assertEqual([flashed[a] for a in used], [image.memory[a] for a in used])


class Check(unittest.TestCase):
    """On the image of DiWheelDrive, with something wrong."""

    def setUp(self):
        self.image, self.chip, _ = load("di_wheel_drive")

    def expect(self, text, **changes):
        found = images.faults(self.image._replace(**changes), self.chip, OBEYED["di_wheel_drive"])
        self.assertTrue(any(text in fault for fault in found), found)

    def memory(self, address, value, size=4):
        return {**self.image.memory, **dict(enumerate(value.to_bytes(size, "little"), address))}

    def test_bootloader_overwritten(self):
        self.expect("of the bootloader", memory=self.memory(0x08005FFF, 0, 1))

    def test_beyond_the_flash(self):
        self.expect("beyond the flash", memory=self.memory(0x08080000, 0, 1))

    def test_vectors_elsewhere(self):
        self.expect("instead of", symbols={**self.image.symbols, "_vectors": (0x08000000, 0x160)})

    def test_code_in_the_block(self):
        self.expect("end of the bootloader's block", memory=self.memory(0x080061F0, 0x4770, 2))

    def test_stack(self):
        for stack in (0x20010008, 0x20000404, 0x08006000, 0):
            self.expect("stack pointer", memory=self.memory(0x08006000, stack))

    def test_reset(self):
        for reset in (self.image.entry - 1, 0x08000101, 0x08070001, 0xFFFFFFFF):
            self.expect("reset vector", memory=self.memory(0x08006004, reset))

    def test_interrupt_without_a_handler(self):
        unhandled = self.image.symbols["_unhandled_exception"][0] | 1
        for name, number in OBEYED["di_wheel_drive"].items():
            self.expect(f"no handler for {name}", memory=self.memory(0x08006040 + 4 * number, unhandled))

    def test_fault_without_a_handler(self):
        unhandled = self.image.symbols["_unhandled_exception"][0] | 1
        for name, number in images.FAULTS.items():
            self.expect(f"no handler for {name}", memory=self.memory(0x08006000 + 4 * number, unhandled))

    def test_note_on_the_restart(self):
        self.expect("is elsewhere", symbols={**self.image.symbols, "ocm_restart_note": (0x20000000, 0)})
        for address in (images.NOTE - 4, images.NOTE, images.NOTE + 15):
            section = images.Section(".bss", address, 5, True, False)
            self.expect("over the note", sections=[*self.image.sections, section])

    def test_vector_in_the_slot(self):
        self.expect("no such interrupt", memory=self.memory(0x08006150, self.image.entry))

    def test_vtor(self):
        start, length = self.image.symbols["chSysInit"]
        start &= ~3
        wrong = dict(self.image.memory)
        for a in range(start, start + length, 4):
            if images.word(wrong, a) == 0x08006000:
                wrong[a + 1] = 0
        self.expect("VTOR", memory=wrong)

    def test_ram(self):
        section = images.Section(".bss", 0x2000FFF0, 0x20, True, False)
        self.expect("outside of RAM", sections=[*self.image.sections, section])
        section = images.Section(".data", 0x08007000, 0x20, True, True)
        self.expect("variables in flash", sections=[*self.image.sections, section])

    def test_image_for_the_other_chip(self):
        self.assertNotEqual(images.faults(self.image, images.CHIPS["stm32f405"]), [])

    def test_damaged_records(self):
        for line in ("S3150800600000040020016200", "S309080060000000000000", "X30908006000000000008E"):
            with self.assertRaises(ValueError):
                images.read_srec([line])


if __name__ == "__main__":
    unittest.main()
