"""The second reader itself, on vectors that are typed by hand; and that it reads what write_dbc writes of random databases."""

import os
import random
import struct
import unittest
from fractions import Fraction

import dbc_bits
import random_dbc
import second_reader
import write_dbc

EXPLORE = int(os.environ.get("OCM_EXPLORE", "1"))


def only(signal, more=""):
    """A file of one message of 8 bytes with these lines in it."""
    return second_reader.read(f"BO_ 1 M: 8 N\n{signal}\n{more}").messages[0]


def value(message, data):
    return {name: physical for name, (_, physical) in second_reader.decode(message, bytes.fromhex(data)).items()}


class Bits(unittest.TestCase):
    def test_places(self):
        self.assertEqual(dbc_bits.positions(12, 12, False), list(range(12, 24)))
        # Nibble B of byte 4 is bits 35 to 32, and byte 5 follows from its bit 7, number 47.
        self.assertEqual(dbc_bits.positions(35, 12, True), [40, 41, 42, 43, 44, 45, 46, 47, 32, 33, 34, 35])
        self.assertEqual(dbc_bits.positions(7, 8, True), list(range(8)))

    def test_a_word_is_what_struct_says(self):
        data = bytes(range(1, 9))
        self.assertEqual(dbc_bits.take(data, dbc_bits.positions(8, 32, False)), struct.unpack_from("<I", data, 1)[0])
        self.assertEqual(dbc_bits.take(data, dbc_bits.positions(15, 32, True)), struct.unpack_from(">I", data, 1)[0])

    def test_put_and_take(self):
        chance = random.Random(1)
        for _ in range(200 * EXPLORE):
            big, length = chance.random() < 0.5, chance.randrange(1, 65)
            start = chance.randrange(512 - 64 - 8)
            bits, data = dbc_bits.positions(start, length, big), bytearray(chance.randbytes(64))
            before, number = bytes(data), chance.randrange(1 << length)
            dbc_bits.put(data, bits, number)
            self.assertEqual(dbc_bits.take(data, bits), number)
            rest = [bit for bit in range(512) if bit not in bits]
            self.assertEqual(dbc_bits.take(data, rest), dbc_bits.take(before, rest))

    def test_signs(self):
        self.assertEqual([dbc_bits.signed(n, 1) for n in (0, 1)], [0, -1])
        self.assertEqual(dbc_bits.signed(0xCDA, 12), -806)


class Vectors(unittest.TestCase):
    def test_both_byte_orders(self):
        message = only(' SG_ le : 12|12@1- (0.5,10) [0|0] "" N\n SG_ be : 35|12@0- (0.5,10) [0|0] "" N')
        self.assertEqual(value(message, "00A0CD000BCD0000"), {"le": Fraction(-393), "be": Fraction("-527.5")})

    def test_floats(self):
        message = only(' SG_ a : 7|32@0- (1,0) [0|0] "" N\n SG_ b : 32|32@1- (2,1) [0|0] "" N',
                       "SIG_VALTYPE_ 1 a : 1;\nSIG_VALTYPE_ 1 b 1;")
        self.assertEqual(value(message, "3FC00000" "0000C03F"), {"a": Fraction("1.5"), "b": Fraction(4)})
        message = only(' SG_ a : 0|64@1- (1,0) [0|0] "" N', "SIG_VALTYPE_ 1 a : 2;")
        self.assertEqual(value(message, "9A9999999999B93F"), {"a": Fraction(0.1)})

    def test_64_bits_are_exact(self):
        message = only(' SG_ a : 0|64@1+ (0.1,0) [0|0] "" N')
        self.assertEqual(value(message, "FF" * 8), {"a": Fraction("1844674407370955161.5")})

    def test_pages(self):
        message = only(' SG_ b m1 : 8|8@1+ (1,0) [0|0] "" N\n SG_ s M : 0|8@1- (1,-3) [0|0] "" N\n SG_ c m255 : 8|16@1+ (1,0) [0|0] "" N')
        self.assertEqual(value(message, "0102030000000000"), {"b": 2, "s": -2})
        self.assertEqual(value(message, "FF02030000000000"), {"s": -4, "c": 0x302})  # raw 255, although it is -1
        self.assertEqual(value(message, "0702030000000000"), {"s": 4})

    def test_ranges_and_a_selector_under_a_selector(self):
        message = only(' SG_ s M : 0|8@1+ (1,0) [0|0] "" N\n SG_ t m2M : 8|8@1+ (1,0) [0|0] "" N\n SG_ v m9 : 16|8@1+ (1,0) [0|0] "" N',
                       "SG_MUL_VAL_ 1 t s 2-5, 7-7;\nSG_MUL_VAL_ 1 v t 9-10;")
        self.assertEqual(value(message, "0709550000000000"), {"s": 7, "t": 9, "v": 0x55})
        self.assertEqual(value(message, "060A550000000000"), {"s": 6})
        self.assertEqual(value(message, "050A550000000000"), {"s": 5, "t": 10, "v": 0x55})
        self.assertEqual(value(message, "050B550000000000"), {"s": 5, "t": 11})

    def test_ids_names_and_formats(self):
        found = second_reader.read(b'\xef\xbb\xbfVERSION ""\r\nNS_ :\r\n\tCM_\r\n\tBA_\r\nBS_:\r\nBU_: A B\r\n'
                                   b'BO_ 2364540158 EEC1: 8 A\r\n\tSG_ short : 7|1@0- (1.5E-003,+127) [-1|.25] "\xc2\xb0" A, B\r\n'
                                   b'BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\r\n SG_ x : 0|1@1+ (1,0) [0|0] "" A\r\n'
                                   b'CM_ SG_ 2364540158 short "one \\"word\\";\r\nBO_ 5 Not: 8 A";\r\n'
                                   b'BA_DEF_ BO_ "VFrameFormat" ENUM "a","J1939PG";\r\nBA_DEF_DEF_ "VFrameFormat" "J1939PG";\r\n'
                                   b'BA_ "SystemSignalLongSymbol" SG_ 2364540158 short "a_long_name";\r\nVAL_ 2364540158 short -1 "on" 0 "off" ;\r\n'
                                   b'VAL_ 77 nothing 1 "x" ;')
        self.assertEqual([(m.name, m.number, m.extended, m.j1939) for m in found.messages], [("EEC1", 0xCF004FE, True, True)])
        signal = found.messages[0].signals[0]
        self.assertEqual((signal.name, signal.scale, signal.offset, signal.unit, signal.receivers, signal.names, signal.maximum),
                         ("a_long_name", Fraction("0.0015"), 127, "°", ["A", "B"], {-1: "on", 0: "off"}, Fraction("0.25")))
        self.assertEqual(signal.comment, 'one "word";\r\nBO_ 5 Not: 8 A')
        self.assertEqual(found.nodes, ["A", "B"])

    def test_parameter_groups(self):
        self.assertEqual(second_reader.group(0x0CF00400), 0xF004)
        self.assertEqual(second_reader.group(0x18EAFF00), 0xEA00)
        found = second_reader.read('BO_ 2364540158 EEC1: 8 N\nBO_ 2565537536 Request: 3 N\nBO_ 2364539920 Exact: 8 N\n'
                                   'BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";\n'
                                   'BA_DEF_DEF_ "VFrameFormat" "J1939PG";\nBA_ "VFrameFormat" BO_ 2364539920 1;')
        named = lambda number, extended=True: getattr(found.find(number, extended), "name", None)
        self.assertEqual([named(0x0CF004FE), named(0x18F00400), named(0x18F00500)], ["EEC1", "EEC1", None])
        self.assertEqual([named(0x18EA21F9), named(0x0CF00410), named(0x410, False)], ["Request", "Exact", None])

    def test_cp1252(self):
        self.assertEqual(second_reader.read(b'BO_ 1 M: 8 N\n SG_ s : 0|8@1+ (1,0) [0|0] "\xba/s" N').messages[0].signals[0].unit, "º/s")


class Random(unittest.TestCase):
    def test_what_is_written_is_read(self):
        extended = nested = floats = fd = long = j1939 = 0
        for seed in range(30 * EXPLORE):
            database = random_dbc.database(seed)
            found = second_reader.read(write_dbc.write(database, seed).encode())
            self.assertEqual([m.name for m in found.messages], [m.name for m in database.messages])
            for message, other in zip(database.messages, found.messages):
                for part in (other, *other.signals):
                    part.comment = part.comment.replace("\r\n", "\n")
                    part.attributes = {key: kept for key, kept in part.attributes.items()
                                       if key not in ("VFrameFormat", "SystemMessageLongSymbol", "SystemSignalLongSymbol")}
                self.assertEqual(other, message, seed)
                extended += message.extended
                nested += any(s.selector and s.is_selector for s in message.signals)
                floats += any(s.floating for s in message.signals)
                fd += message.frame_format.endswith("FD")
                long += len(message.name) > 32
                j1939 += message.j1939
        for count in (extended, nested, floats, fd, long, j1939):
            self.assertGreater(count, 5)  # the databases have what they are for

    def test_pages_may_lie_over_one_another_and_nothing_else(self):
        for seed in range(30 * EXPLORE):
            for message in random_dbc.database(seed).messages:
                for data in (random_dbc.data_of(random.Random(seed), message) for _ in range(5)):
                    present = [s for s in message.signals if second_reader.selected(message, s, data)]
                    bits = [bit for signal in present for bit in signal.bits()]
                    self.assertEqual(len(bits), len(set(bits)), (seed, message.name))


if __name__ == "__main__":
    unittest.main()
