"""BLF as python-can writes it."""

import random
import unittest

import can
import peers
from test_asc import START, candump_line, messages


class PythonCan(peers.Case):
    def write(self, made, **options):
        with can.BLFWriter(self.path("theirs.blf"), **options) as writer:
            for message in made:
                writer.on_message_received(message)

    def check(self, made):
        self.assertEqual(self.candump_of("theirs.blf"), [candump_line(message) for message in made])

    def test_each_kind_of_frame(self):
        made = messages()
        for level in (0, 1, -1):
            self.write(made, compression_level=level)
            self.check(made)

    def test_objects_that_go_over_to_the_next_container(self):
        chance = random.Random(1)
        made = [can.Message(timestamp=START + number / 512, channel=0, arbitration_id=chance.randrange(1 << 29),
                            is_fd=True, data=chance.randbytes(chance.choice(peers.FD_LENGTHS)))
                for number in range(5000)]
        for size in (120, 1000, 128 * 1024):  # below an object's size it loses the last ones
            self.write(made, max_container_size=size)
            self.check(made)

    def test_markers_are_passed_over(self):
        with can.BLFWriter(self.path("theirs.blf")) as writer:
            writer.on_message_received(can.Message(timestamp=START, channel=0, arbitration_id=0x123,
                                                   is_extended_id=False))
            for length in range(8):
                writer.log_event("x" * length, START)
            writer.on_message_received(can.Message(timestamp=START, channel=0, arbitration_id=0x124,
                                                   is_extended_id=False))
        read = self.candump_of("theirs.blf")
        self.assertEqual([line.split()[2] for line in read], ["123#", "124#"])

    def test_damage_is_said(self):
        made = messages()
        self.write(made)
        whole = bytearray(self.load("theirs.blf"))
        self.save("cut.blf", bytes(whole[:-20]))
        done = self.convert("cut.blf", "cut.log")
        self.assertIn("ends in the middle", done)
        whole[300] ^= 0xFF
        self.save("damaged.blf", bytes(whole))
        done = self.convert("damaged.blf", "damaged.log", "--from", "blf")
        self.assertIn("cannot be unpacked", done)


if __name__ == "__main__":
    unittest.main()
