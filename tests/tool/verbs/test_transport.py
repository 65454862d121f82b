"""listen and decode put messages of J1939's transport protocol together. The frames are typed by hand: layouts of TP.CM and TP.DT by
[SAE J1939-21, 5.10.3 and 5.10.4], the courses by its figures C1 (a connection), C2 (packets asked for again) and C3 (a broadcast)."""

import csv
import io
import json
import os
import re
import time

from harness import Case, main

SPEC = f'''BU_: Engine Cab
BO_ {0x98FEECFE} VI: 20 Engine
 SG_ First : 0|8@1+ (1,0) [0|255] "" Cab
 SG_ Middle : 55|16@0+ (1,0) [0|65535] "" Cab
 SG_ Last : 128|8@1+ (0.5,-1) [0|127] "km" Cab
 SG_ Absent : 136|8@1+ (1,0) [0|255] "" Cab
BO_ {0x98FEEBFE} CI: 23 Engine
 SG_ Make : 0|40@1+ (1,0) [0|0] "" Cab
 SG_ End : 176|8@1+ (1,0) [0|255] "" Cab
BO_ {0x8CF004FE} EEC1: 8 Engine
 SG_ EngineSpeed : 24|16@1+ (0.125,0) [0|8031.875] "rpm" Cab
BO_ {0x98EFFFFE} Whole: 1785 Cab
 SG_ Begin : 0|64@1+ (1,0) [0|0] "" Engine
 SG_ Odd : 14207|64@1- (1,0) [0|0] "" Engine
 SG_ Tail : 14272|8@1+ (1,0) [0|255] "" Engine
BA_DEF_ "ProtocolType" STRING ;
BA_DEF_DEF_ "ProtocolType" "J1939";
BA_ "ProtocolType" "J1939";
'''

# Figure C3: 17 bytes in three packets to all, group 65260 (FEEC). The text is WDB9634031L123456.
BROADCAST = """\
(10.000000) can0 1CECFF00#20110003FFECFE00
(10.050000) can0 1CEBFF00#0157444239363334
(10.060000) can0 0CF00400#FFFFFFE02E0000FF
(10.100000) can0 1CEBFF00#023033314C313233
(10.150000) can0 1CEBFF00#03343536FFFFFFFF
"""
# Figure C1: 23 bytes in four packets to one, group 65259 (FEEB), two packets at a time.
CONNECTION = """\
(20.000000) can0 18ECF900#10170004FFEBFE00
(20.001000) can0 18EC00F9#110201FFFFEBFE00
(20.002000) can0 18EBF900#0141424344452A47
(20.003000) can0 18EBF900#0248494A4B4C4D4E
(20.004000) can0 18EC00F9#110203FFFFEBFE00
(20.005000) can0 18EBF900#034F505152535455
(20.006000) can0 18EBF900#045657FFFFFFFFFF
(20.007000) can0 18EC00F9#13170004FFEBFE00
"""
# Figure C2: of the first two packets the second is asked for again.
AGAIN = """\
(30.000000) can0 18ECF900#10170004FFEBFE00
(30.001000) can0 18EC00F9#110201FFFFEBFE00
(30.002000) can0 18EBF900#0141424344452A47
(30.003000) can0 18EBF900#0200000000000000
(30.004000) can0 18EC00F9#110102FFFFEBFE00
(30.005000) can0 18EBF900#0248494A4B4C4D4E
(30.006000) can0 18EC00F9#110203FFFFEBFE00
(30.007000) can0 18EBF900#034F505152535455
(30.008000) can0 18EBF900#045657FFFFFFFFFF
(30.009000) can0 18EC00F9#13170004FFEBFE00
"""
VIN = b"WDB9634031L123456"
COMPONENT = b"ABCDE*GHIJKLMNOPQRSTUVW"


class Transport(Case):
    def setUp(self):
        super().setUp()
        self.spec = os.path.join(self.folder, "truck.dbc")
        with open(self.spec, "w", encoding="utf-8") as file:
            file.write(SPEC)

    def decode(self, log, *arguments, code=0):
        return self.run_tool("--spec", self.spec, "decode", *arguments, stdin=log, code=code)

    def messages(self, log, *arguments, code=0):
        """The messages that were put together: (time, priority, group, source, destination, bytes)."""
        return [(event["time_ns"], found["priority"], found["pgn"], found["source"], found["destination"], bytes.fromhex(found["data"]))
                for event in self.objects(self.decode(log, "--json", *arguments, code=code)[0])
                if (found := event.get("message"))]

    def summary(self, log, *arguments, code=0):
        err = self.decode(log, "--json", *arguments, code=code)[1]
        return next((line for line in err.splitlines() if line.startswith("transport protocol of J1939")), None)

    def test_a_broadcast(self):
        out, err = self.decode(BROADCAST, "--json", "--strict")
        announcement, first, plain, second, last = self.objects(out)
        self.assertEqual(announcement, {"time_ns": "10000000000", "bus": "can0", "id": "1CECFF00", "priority": 7, "pgn": "0EC00", "source": 0,
                                        "destination": 255, "transport": "control", "data": "20110003FFECFE00"})
        self.assertEqual((first["transport"], second["transport"], last["transport"]), ("packet", "packet", "packet"))
        self.assertEqual((plain["topic"], plain["priority"], plain["pgn"], plain["source"], plain["fields"]),
                         ("EEC1", 3, "0F004", 0, {"EngineSpeed": 1500}))
        self.assertNotIn("message", first | second)
        self.assertEqual(last["message"], {
            "priority": 7, "pgn": "0FEEC", "source": 0, "destination": 255, "topic": "VI",
            "fields": {"First": ord("W"), "Middle": ord("4") << 8 | ord("0"), "Last": ord("6") / 2 - 1},  # byte 17 did not come
            "units": {"First": "", "Middle": "", "Last": "km"}, "data": VIN.hex().upper()})
        self.assertIn("5 frames, 2 samples\n", err)
        self.assertIn("transport protocol of J1939: 1 message put together, 3 other frames\n", err)

    def test_a_connection(self):
        whole = (7 - 1, "0FEEB", 0, 0xF9, COMPONENT)
        self.assertEqual(self.messages(CONNECTION), [("20006000000", *whole)])
        self.assertEqual(self.messages(AGAIN, "--strict"), [("30008000000", *whole)])
        self.assertEqual(self.summary(CONNECTION + AGAIN), "transport protocol of J1939: 2 messages put together, 16 other frames")

    def test_the_longest(self):
        """1785 bytes in 255 packets, from 2 to 1 [SAE J1939-21, 5.10.1.1]."""
        data = bytes(i * 7 % 251 for i in range(1785))
        log = "(0.0) can0 18EC0102#10F906FFFF00EF00\n(0.0) can0 18EC0201#11FF01FFFF00EF00\n"
        for number in range(255):
            log += f"(0.{number + 1:03}) can0 18EB0102#{number + 1:02X}{data[7 * number:7 * number + 7].hex()}\n"
        self.assertEqual(self.messages(log), [("255000000", 6, "0EF00", 2, 1, data)])
        out, _ = self.decode(log, "--csv", "--topic", "Whole")
        value = int.from_bytes(data, "little")
        odd = value >> 14207 & (1 << 64) - 1
        self.assertEqual([(row["field"], row["value"]) for row in csv.DictReader(io.StringIO(out))],
                         [("Begin", str(value & (1 << 64) - 1)), ("Odd", str(odd - (odd >> 63 << 64))), ("Tail", str(data[-1]))])

    def test_words_and_csv(self):
        log = BROADCAST + CONNECTION
        out, _ = self.decode(log, "--pretty")
        lines = [" ".join(line.split()) for line in out.splitlines()]
        self.assertEqual(len(lines), 3)
        for line, words in zip(lines, (("3 00>FF", "EEC1", "EngineSpeed 1500 rpm"), ("7 00>FF", "VI", "First 87", "Last 26 km"),
                                       ("6 00>F9", "CI", "End 87"))):
            for word in words:
                self.assertIn(word, line)
        self.assertNotIn("Absent", out)
        out, _ = self.decode(log, "--csv")
        self.assertEqual(out.splitlines()[:5], [
            "time,topic,field,value,unit,priority,pgn,source,destination",
            "10.060000000,EEC1,EngineSpeed,1500,rpm,3,0F004,0,255",
            "10.150000000,VI,First,87,,7,0FEEC,0,255",
            "10.150000000,VI,Middle,13360,,7,0FEEC,0,255",
            "10.150000000,VI,Last,26,km,7,0FEEC,0,255"])
        self.assertEqual(out.splitlines()[-1], "20.006000000,CI,End,87,,6,0FEEB,0,249")
        out, _ = self.decode(log, "--csv", "--field", "VI.Absent", "--field", "CI.End", "--field", "VI.Last")
        self.assertEqual(out.splitlines(), ["time,VI.Absent,CI.End,VI.Last,priority,pgn,source,destination",
                                            "10.150000000,,,26,7,0FEEC,0,255", "20.006000000,,87,,6,0FEEB,0,249"])

    def test_a_plain_frame_has_no_group(self):
        """A bus has frames of 11 bits beside those of J1939."""
        with open(self.spec, "a", encoding="utf-8") as file:
            file.write('BO_ 3 Own: 1 Cab\n SG_ Level : 0|8@1+ (1,0) [0|255] "" Engine\n')
        out, _ = self.decode("(1.0) can0 003#07\n(2.0) can0 0CF00400#FFFFFFE02E0000FF\n", "--csv")
        self.assertEqual(out.splitlines()[1:], ["1.000000000,Own,Level,7,,,,,", "2.000000000,EEC1,EngineSpeed,1500,rpm,3,0F004,0,255"])

    def test_a_long_group_in_one_frame(self):
        """What fits into one is sent in one: of trouble codes (DM1) there is one, or there are many."""
        log = "(1.0) can0 18FEEC05#5742\n"
        event, = self.objects(self.decode(log, "--json", "--strict")[0])
        self.assertEqual((event["topic"], event["fields"], event["units"], event["data"]), ("VI", {"First": 0x57}, {"First": ""}, "5742"))
        self.assertEqual(self.decode(log, "--csv")[0].splitlines()[1:], ["1.000000000,VI,First,87,,6,0FEEC,5,255"])
        self.assertNotIn("Middle", self.decode(log, "--pretty")[0])
        self.assertEqual(self.objects(self.decode(log, "--json", "--where", "VI.First=87")[0]), [event])
        self.decode("(1.0) can0 0CF00400#5742\n", "--json", "--strict", code=1)  # a short one has its length

    def test_choices(self):
        log = BROADCAST + CONNECTION

        def groups(*arguments, code=0):
            return [message[2] for message in self.messages(log, *arguments, code=code)]

        def count(*arguments, code=0):
            return len(self.decode(log, "--json", *arguments, code=code)[0].splitlines())

        self.assertEqual((groups("--topic", "VI"), count("--topic", "VI")), (["0FEEC"], 1))
        self.assertEqual((groups("--pgn", "FEEB"), count("--pgn", "FEEB")), (["0FEEB"], 1))
        self.assertEqual((groups("--pgn", "EC00"), count("--pgn", "EC00")), ([], 5))  # the protocol's own frames
        self.assertEqual(groups("--pgn", "EB00"), ["0FEEC", "0FEEB"])
        self.assertEqual(groups("--sender", "Engine"), ["0FEEC", "0FEEB"])
        self.assertEqual(groups("--where", "VI.Last>25"), ["0FEEC"])
        self.assertEqual(count("--where", "VI.Last>26", code=1), 0)
        self.assertEqual(groups("--topic", "CI", "--where", "VI.Last=26"), ["0FEEB"])
        self.assertEqual(groups("--topic", "CI", "--where", "VI.Last=27", code=1), [])
        self.assertEqual(groups("--where", "VI.Absent>=0", code=1), [])
        fields = [event["message"]["fields"] for event in self.objects(self.decode(log, "--json", "--field", "CI.End")[0])]
        self.assertEqual(fields, [{"End": 87}])

    def test_a_message_of_eight_bytes_that_comes_in_several_frames(self):
        """Longer than its file says: all its fields are there, in one frame and in several."""
        out, _ = self.decode(BROADCAST.replace("ECFE00", "04F000"), "--json")
        events = self.objects(out)
        self.assertEqual(events[-1]["message"]["topic"], "EEC1")
        self.assertEqual(events[-1]["message"]["fields"], {"EngineSpeed": 0x3639 * 0.125})
        self.assertEqual(events[-1]["message"]["units"], {"EngineSpeed": "rpm"})
        self.assertEqual(events[-1]["message"]["data"], VIN.hex().upper())
        self.assertEqual(events[2]["fields"], {"EngineSpeed": 1500})

    def test_a_group_of_no_message(self):
        log = BROADCAST.replace("ECFE00", "EDFE00")
        out, err = self.decode(log, "--json")
        self.assertEqual(self.objects(out)[-1]["message"], {"priority": 7, "pgn": "0FEED", "source": 0, "destination": 255,
                                                            "error": "unknown identifier", "data": VIN.hex().upper()})
        self.assertIn("1 of unknown identifier", err)
        self.decode(log, "--strict", code=1)
        out, _ = self.decode(log, "--pretty")
        self.assertIn("7 00>FF unknown group 0FEED: " + VIN.hex(" ").upper(), out)

    def test_losses_are_counted_by_their_cause(self):
        def without(log, *lines):
            return "".join(line + "\n" for number, line in enumerate(log.splitlines()) if number not in lines)

        start, announced = CONNECTION.splitlines(True)[0], BROADCAST.splitlines(True)[0]
        later = "(50.000000) can0 0CF00400#FFFFFFE02E0000FF\n"
        for log, words in (
                (without(BROADCAST, 3), "1 message lost a packet"),
                (without(CONNECTION, 3), "1 message lost a packet"),
                (BROADCAST.replace("#02", "#01"), "1 had a packet of a wrong number"),
                (BROADCAST.replace("#02", "#04"), "1 had a packet of a wrong number"),
                (start + "(20.1) can0 18EC00F9#FF01FFFFFFEBFE00\n", "1 aborted"),  # by its receiver
                (start + "(20.1) can0 18ECF900#FF03FFFFFFEBFE00\n", "1 aborted"),  # by its sender
                (start + later, "1 timed out"),
                (without(BROADCAST, 3, 4) + later, "1 timed out"),
                (start + CONNECTION, "1 followed by the next before the end"),
                ("".join(f"(1.0) can0 1CECFF{source:02X}#20110003FFECFE00\n" for source in range(33)), "1 too many at a time"),
                (announced.replace("201100", "200800"), "1 of an impossible size"),
                (announced.replace("20110003", "20110004"), "1 of an impossible size"),
                (announced.replace("20110003", "20FA06FF"), "1 of an impossible size"),  # 1786
                (announced.replace("FFECFE00", "FFECFE04"), "1 frame of another form"),
                (announced.replace("FFECFE00", "FFECFE"), "1 frame of another form")):
            with self.subTest(words, log=log):
                text = self.summary(log + later)
                self.assertIn(", " + words, text)
                self.assertIsNotNone(self.summary(log + later, "--strict", code=1))
        self.assertIn(", 1 not at the end yet", self.summary(start, code=1))
        self.assertIn(", 2 packets of no message", self.summary("".join(BROADCAST.splitlines(True)[2:]), "--strict"))

    def test_sources_destinations_and_buses_do_not_mix(self):
        other = bytes(255 - byte for byte in VIN)
        second = ""
        for line in BROADCAST.splitlines(True):
            if "1CEBFF00" in line:
                head, _, data = line.strip().partition("#")
                line = f"{head}#{data[:2]}{bytes(255 - byte for byte in bytes.fromhex(data[2:])).hex()}\n"
            second += line
        mixed = "".join(a + b + c for a, b, c in zip(BROADCAST.splitlines(True), second.replace("FF00#", "FF01#").splitlines(True),
                                                     second.replace("can0", "can1").splitlines(True)))
        self.assertEqual([message[2:] for message in self.messages(mixed)],
                         [("0FEEC", 0, 255, VIN), ("0FEEC", 1, 255, other), ("0FEEC", 0, 255, other)])

    def curve(self, log, field):
        """What `plot` draws: pairs of seconds since the log's first frame and values, over all pieces."""
        path = os.path.join(self.folder, "in.log")
        with open(path, "w", encoding="ascii") as file:
            file.write(log)
        out, _ = self.run_tool("--spec", self.spec, "plot", path, field, "--script")
        return [(float(time), float(value)) for time, value in re.findall(r"^(\S+) (\S+)$", out.split("<< EOD", 1)[1].split("EOD")[0], re.MULTILINE)]

    def test_plot_draws_fields_of_messages_of_several_frames(self):
        self.assertEqual(self.curve(BROADCAST, "VI.First"), [(0.15, 87)])
        self.assertEqual(self.curve(BROADCAST, "VI.Last"), [(0.15, 26)])  # in the third packet
        self.assertEqual(self.curve(CONNECTION + AGAIN, "CI.End"), [(0.006, 87), (10.008, 87)])
        self.assertEqual(self.curve(BROADCAST, "EEC1.EngineSpeed"), [(0.06, 1500)])  # between the packets

    def test_stats_and_plot_count_what_was_not_put_together(self):
        log = "".join(line for line in BROADCAST.splitlines(True) if "#02" not in line) + BROADCAST.replace("(", "(1")
        path = os.path.join(self.folder, "in.log")
        with open(path, "w", encoding="ascii") as file:
            file.write(log)
        out, _ = self.run_tool("--spec", self.spec, "stats", path)
        self.assertIn("1 message of it that was not put together", out)
        out, _ = self.run_tool("--spec", self.spec, "stats", path, "--json")
        bus = json.loads(out)["buses"][0]
        self.assertEqual((bus["transport_lost"], bus["transport_stray"], bus["unselected"]), (1, 0, 0))
        _, err = self.run_tool("--spec", self.spec, "plot", path, "VI.First", "--script")
        self.assertIn("1 message of J1939 was not put together, so the curves may lack values; `amiroctl decode` says why\n", err)
        with open(path, "w", encoding="ascii") as file:
            file.write("".join(line for line in log.splitlines(True) if "#02" not in line) + BROADCAST.replace("(", "(2"))
        _, err = self.run_tool("--spec", self.spec, "plot", path, "VI.First", "--script")
        self.assertIn("2 messages of J1939 were not put together, so the curves may lack values; `amiroctl decode` says why\n", err)
        with open(path, "w", encoding="ascii") as file:
            file.write(BROADCAST)
        _, err = self.run_tool("--spec", self.spec, "plot", path, "VI.First", "--script")
        self.assertNotIn("put together", err)

    def test_back_to_the_byte(self):
        log = (BROADCAST + CONNECTION).replace("(", "(14365090")
        again, _ = self.run_tool("--spec", self.spec, "encode", stdin=self.decode(log, "--json")[0])
        self.assertEqual(again, log)
        self.assertEqual(self.decode(log, "--raw")[0], log)

    def test_a_robot_has_no_such_protocol(self):
        out, err = self.run_tool("decode", "--json", stdin=BROADCAST, code=1)
        self.assertEqual([event.get("error") for event in self.objects(out)], ["unknown identifier"] * 5)
        self.assertNotIn("transport", err)

    def test_live(self):
        self.start_sim()
        listener = self.listen("--spec", self.spec, "VI", "-n", "1", "--timeout", "60s")
        self.run_tool("send", "--stdin", stdin=BROADCAST)
        out, err = listener.communicate(timeout=60)
        self.assertEqual(listener.returncode, 0, err)
        self.assertEqual([event["message"]["data"] for event in self.objects(out)], [VIN.hex().upper()])
        listener = self.listen("--spec", self.spec, "--timeout", "60s")
        self.run_tool("send", "--stdin", stdin="".join(BROADCAST.splitlines(True)[:-1]))
        self.settle()
        time.sleep(1)  # T1, in which the next packet would have had to come, is 750 ms [SAE J1939-21]
        _, err = self.interrupt(listener)
        self.assertIn("0 messages put together, 3 other frames, 1 timed out", err)  # nothing came behind it

    def test_its_packets_go_with_a_message_that_is_recorded_or_replayed(self):
        self.start_sim()
        path = os.path.join(self.folder, "vi.log")
        recorder = self.start("--spec", self.spec, "record", "VI", "-o", path, "-n", "4")
        self.assertIn("bus: sim", recorder.stderr.readline())
        self.settle()
        self.run_tool("send", "--stdin", stdin=BROADCAST)
        _, err = recorder.communicate(timeout=60)
        self.assertEqual(recorder.returncode, 0, err)
        with open(path, encoding="utf-8") as file:
            self.assertEqual([line.split()[2][:8] for line in file], ["1CECFF00", "1CEBFF00", "1CEBFF00", "1CEBFF00"])
        both = os.path.join(self.folder, "both.log")
        with open(both, "w", encoding="utf-8") as file:
            file.write(BROADCAST)
        for words, count in ((("VI",), 4), (("EEC1",), 1)):
            out, _ = self.run_tool("--spec", self.spec, "replay", both, *words, "--dry-run")
            self.assertEqual(len(out.splitlines()), count, out)
        out, err = self.run_tool("--spec", self.spec, "replay", both, "VI", "--only", "commands", "--dry-run", code=1)
        self.assertEqual(out, "")
        self.assertIn(f"no frame of {both} was chosen", err)

    def test_doctor_hears_the_messages_and_names_those_that_are_missing(self):
        spec = os.path.join(self.folder, "due.dbc")
        with open(spec, "w", encoding="utf-8") as file:
            file.write(SPEC + 'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 60000;\nBA_DEF_DEF_ "GenMsgCycleTime" 0;\n'
                       + "".join(f'BA_ "GenMsgCycleTime" BO_ {number} {period};\n'
                                 for number, period in ((0x98FEECFE, 300), (0x98FEEBFE, 300), (0x8CF004FE, 10), (0x98EFFFFE, 2500))))
        self.start_sim()
        doctor = self.start("--spec", spec, "doctor", "--json", "--listen", "7s")
        self.assertIn("bus: sim", doctor.stderr.readline())
        self.settle()
        self.run_tool("send", "--stdin", stdin=BROADCAST)
        out, _ = doctor.communicate(timeout=60)
        self.assertEqual(doctor.returncode, 1)
        self.assertEqual([(each["severity"], each["board"], each["what"]) for each in json.loads(out)["findings"]],
                         [("warning", "Engine", "of 3 messages due in 7s nothing came of CI")])
        plain = os.path.join(self.folder, "plain.dbc")
        with open(plain, "w", encoding="utf-8") as file:
            file.write(SPEC)
        out, _ = self.run_tool("--spec", plain, "doctor")
        self.assertTrue(out.endswith("nothing came, and nothing was due: --listen T listens longer\n"), out)

    def test_a_trace_knows_messages_by_their_group(self):
        log = os.path.join(self.folder, "trace.log")
        spec = os.path.join(self.folder, "due.dbc")
        with open(spec, "w", encoding="utf-8") as file:
            file.write(SPEC + 'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 60000;\nBA_DEF_DEF_ "GenMsgCycleTime" 0;\n'
                       f'BA_ "GenMsgCycleTime" BO_ {0x8CF004FE} 50;\nBA_DEF_ "Baudrate" INT 0 1000000;\nBA_DEF_DEF_ "Baudrate" 250000;\n')
        with open(log, "w", encoding="utf-8") as file:
            for i in range(40):  # source 0x17, priority 6: neither is the spec's
                file.write(f"({10 + i * 0.05:.6f}) can0 18F00417#FFFFFFE02E0000FF\n")
            file.write(BROADCAST.replace("(10.0000", "(12.0100").replace("(10.", "(12.").replace("12.060000) can0 0CF00400", "12.000000) can0 18F00417"))
        out, _ = self.run_tool("--spec", spec, "analyse", "trace", log, "--json")
        study = json.loads(out)
        self.assertEqual([(row["name"], row["count"]) for row in study["messages"]], [("EEC1", 41)])
        self.assertEqual(study["broken"], [])
        out, _ = self.run_tool("--spec", spec, "analyse", "trace", log)
        self.assertIn("4 packets of J1939's transport protocol, not in the set", out)


if __name__ == "__main__":
    main()
