"""pcapng and pcap against Wireshark's tools: what we write they read, what they write we read."""

import struct
import unittest

import peers


@peers.needs("tshark", "editcap", "mergecap", "capinfos")
class Pcapng(peers.Case):
    def fields(self, name, *fields):
        """A row a packet, as tshark sees it."""
        options = [option for field in fields for option in ("-e", field)]
        text = self.run_peer("tshark", "-r", name, "-T", "fields", "-E", "separator=|", *options)
        return [line.split("|") for line in text.splitlines()]

    def random_log(self, count=400, seed=1):
        lines = peers.random_lines(count, seed)
        self.save("in.log", "\n".join(lines) + "\n")
        return lines

    def test_tshark_reads_each_frame(self):
        lines = self.random_log()
        self.convert("in.log", "out.pcapng", "--strict")
        rows = self.fields("out.pcapng", "frame.time_epoch", "frame.interface_name", "frame.packet_flags_direction",
                           "can.id", "can.flags.xtd", "can.flags.rtr", "can.flags.err", "can.len", "data",
                           "canfd.flags.brs", "canfd.flags.esi")
        self.assertEqual(len(rows), len(lines))
        for row, line in zip(rows, lines):
            stamp, interface, frame, *direction = line.split()
            time, name, flags, identifier, extended, remote, error, length, data, switch, state = row
            self.assertEqual((f"({time})", name), (stamp, interface), line)
            # Read back as it is printed, in hexadecimal: 0x1 inbound, 0x2 outbound.
            self.assertEqual(int(flags or "0", 0), {"R": 1, "T": 2}[direction[0]] if direction else 0, line)
            number, _, rest = frame.partition("#")
            if frame.startswith("2") and len(number) == 8 and error == "1":
                self.assertEqual(length, "8", line)
                continue
            self.assertEqual(int(identifier, 0), int(number, 16), line)
            self.assertEqual(extended, "1" if len(number) == 8 else "0", line)
            if rest.startswith("#"):
                self.assertEqual((switch, state), (str(int(rest[1]) & 1), str(int(rest[1]) >> 1)), line)
                rest = rest[2:]
            elif rest.startswith("R"):
                self.assertEqual((remote, length), ("1", rest[1:] or "0"), line)
                continue
            rest = rest.partition("_")[0]
            self.assertEqual((data.upper(), length), (rest, str(len(rest) // 2)), line)

    def test_what_error_frames_say(self):
        self.save("in.log", "(1.0) can0 20000004#0001000000000000\n(2.0) can0 20000040#0000000000000000\n")
        self.convert("in.log", "out.pcapng")
        self.assertEqual(self.fields("out.pcapng", "can.flags.err", "can.err.ctrl.rx_overflow", "can.err.busoff"),
                         [["1", "1", "0"], ["1", "", "1"]])

    def test_there_and_back(self):
        lines = self.random_log(seed=2)
        self.convert("in.log", "out.pcapng", "--strict")
        self.assertEqual(self.candump_of("out.pcapng"), lines)

    def test_what_editcap_and_mergecap_write(self):
        lines = self.random_log(seed=3)
        self.convert("in.log", "out.pcapng", "--strict")
        self.run_peer("editcap", "-F", "pcapng", "out.pcapng", "edited.pcapng")
        self.assertEqual(self.candump_of("edited.pcapng"), lines)
        self.run_peer("editcap", "-c", "100", "out.pcapng", "part.pcapng")
        # Two sources, one after the other: interfaces are described twice.
        self.run_peer("mergecap", "-a", "-w", "merged.pcapng", "out.pcapng", "edited.pcapng")
        self.assertEqual(self.candump_of("merged.pcapng"), lines + lines)

    def test_several_sections(self):
        self.random_log(seed=4, count=20)
        self.convert("in.log", "out.pcapng")
        self.save("two.pcapng", self.load("out.pcapng") * 2)
        self.assertEqual(len(self.candump_of("two.pcapng")), 40)
        self.assertEqual(len(self.fields("two.pcapng", "can.id")), 40)

    def test_drop_counts_of_others(self):
        # A statistics block as dumpcap writes it: isb_starttime, isb_endtime, isb_ifrecv, isb_ifdrop.
        self.save("in.log", "(1.0) can0 123#\n")
        self.convert("in.log", "out.pcapng")
        options = struct.pack("<HHIIHHIIHHQHHQI", 2, 8, 0, 0, 3, 8, 0, 0, 4, 8, 10, 5, 8, 3, 0)
        block = struct.pack("<IIIII", 5, 24 + len(options), 0, 0, 1) + options + struct.pack("<I", 24 + len(options))
        self.save("theirs.pcapng", self.load("out.pcapng") + block)
        self.convert("theirs.pcapng", "again.pcapng")
        text = self.run_peer("capinfos", "-I", "again.pcapng")
        self.assertIn("Number of stat entries = 1", text)
        self.assertIn(struct.pack("<HHQHHQ", 4, 8, 10, 5, 8, 3), self.load("again.pcapng"))

    def test_cut_off_it_still_opens(self):
        lines = self.random_log(seed=5, count=50)
        self.convert("in.log", "out.pcapng")
        self.save("cut.pcapng", self.load("out.pcapng")[:-30])
        done = self.convert("cut.pcapng", "cut.log", "--to", "candump-ns")
        self.assertIn("ends in the middle", done)
        read = self.load("cut.log").decode().splitlines()
        self.assertEqual(read, lines[:len(read)])
        self.assertGreaterEqual(len(read), len(lines) - 2)
        text = self.run_peer("tshark", "-r", "cut.pcapng", "-T", "fields", "-e", "frame.number", code=2)
        self.assertEqual(len(text.splitlines()), len(read))


@peers.needs("tshark", "editcap")
class Pcap(peers.Case):
    def setUp(self):
        super().setUp()
        self.lines = peers.random_lines(300, 6, directions=("",), interfaces=("can0",))
        self.save("in.log", "\n".join(self.lines) + "\n")

    def test_tshark_reads_each_frame(self):
        self.convert("in.log", "out.pcap", "--strict")
        text = self.run_peer("tshark", "-r", "out.pcap", "-T", "fields", "-e", "frame.time_epoch", "-e", "can.len")
        rows = [line.split("\t") for line in text.splitlines()]
        self.assertEqual([f"({row[0]})" for row in rows], [line.split()[0] for line in self.lines])

    def test_there_and_back(self):
        self.convert("in.log", "out.pcap", "--strict")
        self.assertEqual(self.candump_of("out.pcap"), self.lines)

    def test_what_editcap_writes(self):
        self.convert("in.log", "out.pcapng")
        self.run_peer("editcap", "-F", "nsecpcap", "out.pcapng", "nano.pcap")
        self.assertEqual(self.candump_of("nano.pcap"), self.lines)
        self.run_peer("editcap", "-F", "pcap", "out.pcapng", "micro.pcap")
        self.assertEqual(self.candump_of("micro.pcap"),
                         [line[:18] + "000" + line[21:] for line in self.lines])

    def test_a_capture_of_all_devices(self):
        # As tcpdump -i any writes it: LINKTYPE_LINUX_SLL, and the identifier in the byte order of the machine.
        packet = struct.pack(">HHHQH", 4, 280, 0, 0, 0x000C) + struct.pack("<IBBBB8s", 0x80000123, 2, 0, 0, 0, b"\x11\x22")
        self.save("any.pcap", struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 113) +
                  struct.pack("<IIII", 5, 7, len(packet), len(packet)) + packet)
        self.assertEqual(self.candump_of("any.pcap"), ["(0000000005.000007000) can0 00000123#1122 T"])
        text = self.run_peer("tshark", "-r", "any.pcap", "-T", "fields", "-e", "can.id", "-e", "sll.pkttype")
        self.assertEqual(text.split(), ["291", "4"])


if __name__ == "__main__":
    unittest.main()
