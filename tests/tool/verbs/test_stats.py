"""amiroctl stats: figures of logs whose periods, gaps and losses are typed by hand; assertions; the live bus."""

import gzip
import json
import os
import signal
import struct

from harness import Case, main

START = 1436509052  # 2015-07-10T06:17:32Z


class Stats(Case):
    def log(self, frames, name="drive.log"):
        """(milliseconds, frame) or (milliseconds, frame, interface) in candump's form."""
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="ascii") as file:
            for ms, frame, *interface in frames:
                us = round(ms * 1000)
                file.write(f"({START + us // 1000000}.{us % 1000000:06}) {interface[0] if interface else 'can0'} {frame}\n")
        return path

    def report(self, *arguments, code=0):
        out, err = self.run_tool("stats", "--json", *arguments, code=code)
        report = json.loads(out)
        return report, err

    def topic(self, path, name):
        report, _ = self.report(path)
        return {t["topic"]: t for t in report["buses"][0]["topics"]}[name]

    GYRO = "508#3E001E00FCFF"

    def test_period_jitter_and_gap_by_hand(self):
        # Distances 500, 503, 497, 1000 ms, one sample missing; a request for 500 ms a millisecond before.
        path = self.log([(0, "108#01F40100")] + [(ms, self.GYRO) for ms in (1, 501, 1004, 1501, 2501)])
        gyro = self.topic(path, "gyroscope")
        self.assertEqual(gyro["count"], 5)
        self.assertEqual(gyro["by_priority"], {"high": 5})
        self.assertEqual(gyro["period_ns"], 500_000_000)
        self.assertEqual(gyro["period_from"], "request")
        self.assertEqual(gyro["mean_ns"], 625e6)
        self.assertEqual(gyro["rate_hz"], 1.6)
        # Off their mean of 625: (125^2 + 122^2 + 128^2 + 375^2) / 4 = 46879.5
        self.assertAlmostEqual(gyro["jitter_ns"], 46879.5 ** 0.5 * 1e6, delta=1)
        self.assertEqual(gyro["spread_ns"], 503_000_000)
        self.assertEqual(gyro["lateness_ns"], 3_000_000)
        self.assertEqual(gyro["gap_ns"], 1_000_000_000)
        self.assertEqual(gyro["gap_from_ns"], str(START * 10**9 + 1_501_000_000))
        self.assertEqual(gyro["missing"], 1)
        self.assertEqual(gyro["requests"], 1)

    def test_all_distances_count_and_a_stop_is_no_gap(self):
        frames = [(0, "208#01F40100")] + [(1 + 500 * i, "608#000000000000") for i in range(4)]
        frames += [(1600, "208#00"), (60000, "208#01140000")]
        frames += [(60000.5 + 20 * i, "608#000000000000") for i in range(101)]
        gyro = self.topic(self.log(frames), "gyroscope")
        self.assertEqual(gyro["count"], 105)
        self.assertAlmostEqual(gyro["mean_ns"], (3 * 500e6 + 100 * 20e6) / 103, delta=1)
        self.assertEqual(gyro["jitter_ns"], 0)
        self.assertEqual(gyro["period_ns"], 20_000_000)
        self.assertEqual(gyro["missing"], 0)
        self.assertEqual(gyro["gap_ns"], 500_000_000)

    def test_silence_at_the_end_is_a_gap(self):
        frames = [(0, "208#01640000"), (1, "608#000000000000"), (101, "608#000000000000")]
        gyro = self.topic(self.log(frames + [(1101, "655#")]), "gyroscope")
        self.assertEqual(gyro["missing"], 9)
        self.assertEqual(gyro["gap_ns"], 1_000_000_000)
        self.assertEqual(gyro["rate_hz"], 10)

    def test_without_a_request_the_samples_say_the_period(self):
        path = self.log([(20 * i, "608#000000000000") for i in range(40) if i != 20])
        gyro = self.topic(path, "gyroscope")
        self.assertEqual((gyro["period_ns"], gyro["period_from"], gyro["missing"]), (20_000_000, "measured", 1))
        self.assertIsNone(gyro["lateness_ns"])
        path = self.log([(50 * i, "608#000000000000") for i in range(40) if i != 20])
        gyro = self.topic(path, "gyroscope")
        self.assertEqual((gyro["period_ns"], gyro["period_from"], gyro["missing"]), (50_000_000, "spec", 1))

    def test_faults_of_the_bus(self):
        path = self.log([(0, "608#00"), (1, "655#01"), (2, "1F334455#"), (3, "655#02"), (4, "605#00000000"),
                         (5, "20000040#0000000000000000"), (6, "20000004#0001000000000000"), (7, "655##1AA"),
                         (8, "208#09")])
        report, _ = self.report(path)
        bus = report["buses"][0]
        self.assertEqual(bus["bus"], "can0")
        self.assertEqual((bus["frames"], bus["errors"], bus["overflows"], bus["fd_frames"]), (7, 2, 1, 1))
        self.assertEqual((bus["unknown"], bus["wrong_length"], bus["commands"]), (4, 1, 1))
        self.assertEqual(bus["unknown_ids"], [{"id": "655", "count": 3}, {"id": "1F334455", "count": 1}])
        gyro = bus["topics"][1]
        self.assertEqual((gyro["topic"], gyro["wrong_length"], gyro["requests"], gyro["bad_requests"]),
                         ("gyroscope", 1, 1, 1))
        out, _ = self.run_tool("stats", path)
        self.assertIn("2 error frames, 1 overflow of the CAN controller, 1 CAN FD frame, not in the "
                      "load without --data-bitrate, 4 frames that no topic or message has (655 3, 1F334455 1)", out)

    def test_load_is_of_exact_bits(self):
        # 205#01840302 has 44 + 32 + 5 bits and 3 of intermission: tests/unit/can/length.cpp. Ten of them in
        # 9 ms at 500 kbit/s, the first of which had begun before.
        path = self.log([(i, "205#01840302") for i in range(10)])
        report, _ = self.report(path)
        bus = report["buses"][0]
        self.assertAlmostEqual(bus["load_percent"], 100 * 9 * 84 / 500e3 / 0.009)
        self.assertAlmostEqual(bus["request_load_percent"], bus["load_percent"])
        self.assertAlmostEqual(bus["worst_100ms_load_percent"], 100 * 840 / 50e3)
        report, _ = self.report(path, "--bitrate", "125k")
        self.assertAlmostEqual(report["buses"][0]["load_percent"], 4 * bus["load_percent"])
        self.assertEqual(report["buses"][0]["bit_rate"], 125000)

    def test_the_table_says_what_the_figures_are(self):
        # The log of test_period_jitter_and_gap_by_hand. A gyroscope's frame is 44 + 48 bits, 8 stuff bits and 3 between frames;
        # the request 44 + 32 + 5 + 3. 5 * 103 bits of 500 kbit/s in 2.501 s are 0.0412 %, 103 + 84 in 100 ms 0.374 %.
        path = self.log([(0, "108#01F40100")] + [(ms, self.GYRO) for ms in (1, 501, 1004, 1501, 2501)])
        out, _ = self.run_tool("stats", path)
        rows = out.splitlines()
        self.assertEqual(rows[1].split(), "gyroscope high 5 1.6 Hz 500 ms 625 ms 216.5 ms 3 ms 1 1.000 s at 1.501 s 0.0412 %".split())
        self.assertEqual(rows[2], "can0: 6 frames in 2.501 s (1.999 Hz); load 0.0412 % at 500 kbit/s, 0.374 % in the worst "
                                  "100 ms, until 1 ms")
        out, _ = self.run_tool("stats", path, "--bitrate", "83333")
        self.assertIn(" at 83.333 kbit/s, ", out)

    def test_faults_and_strangers_in_the_table(self):
        strangers = ["6F0#", "6F1#", "6F2#", "6F2#", "6F3#", "6F4#", "6F5#R", "6F0#", "6F0#"]
        path = self.log([(0, "608#00"), (1, "208#03"), (2, self.GYRO), (52, "708#000000000000"), (102, "708#000000000000")]
                        + [(103 + i, frame) for i, frame in enumerate(strangers)])
        out, _ = self.run_tool("stats", path)
        rows = out.splitlines()
        self.assertTrue(rows[1].startswith("gyroscope  high 1, low 2        3  20 Hz  50 ms (spec)  50 ms"), rows[1])
        self.assertTrue(rows[1].endswith("  1 of wrong length, 1 bad request"), rows[1])
        self.assertEqual(rows[3], "  9 frames that no topic or message has (6F0 3, 6F2 2, 6F1 1, 6F3 1, 6F4 1, ...)")
        out, _ = self.run_tool("stats", self.log([(0, self.GYRO), (1, "6F5#R"), (2, "6F5#")], "remote.log"))
        self.assertIn("2 frames that no topic or message has (6F5#R 1, 6F5 1)", out)

    CAR = os.path.join(os.environ["OCM_SOURCE_DIR"], "examples", "small_car.dbc")

    def test_messages_have_the_period_that_the_file_states(self):
        """Engine, stated at 10 ms, comes every 20 ms: 299 of 599 are missing."""
        path = self.log([(20 * i, "100#0000000000000000") for i in range(300)] + [(6000, "110#00000000")])
        report, _ = self.report("--spec", self.CAR, path)
        engine = report["buses"][0]["topics"][0]
        self.assertEqual((engine["topic"], engine["period_ns"], engine["period_from"]), ("Engine", 10_000_000, "spec"))
        self.assertEqual((engine["missing"], engine["mean_ns"]), (300, 20e6))  # the last one before the end, too
        out, _ = self.run_tool("--spec", self.CAR, "stats", path, "Engine")
        self.assertEqual(out.splitlines()[1].split()[2:9], "300 50 Hz 10 ms (spec)".split() + ["20"])

    def test_messages_that_never_came(self):
        frames = [(10 * i, "100#0000000000000000") for i in range(30)] + [(20 * i, "110#00000000") for i in range(15)]
        path = self.log(sorted(frames))  # 290 ms: shorter than the periods of Trip and BatteryCells
        out, _ = self.run_tool("--spec", self.CAR, "stats", path)
        never = "never came: Wheels (20 ms), Driving (20 ms), Doors (100 ms), Lights (100 ms), Battery (100 ms), Service (200 ms)"
        self.assertEqual(out.splitlines()[-1], never)
        report, _ = self.report("--spec", self.CAR, path)
        self.assertEqual(report["never_came"][:2], [{"topic": "Wheels", "period_ns": 20_000_000}, {"topic": "Driving", "period_ns": 20_000_000}])
        _, err = self.run_tool("--spec", self.CAR, "stats", path, "--csv")
        self.assertIn(never, err)
        # Of what is shown, and without anything of it an error.
        out, _ = self.run_tool("--spec", self.CAR, "stats", path, "Engine", "Driving")
        self.assertEqual(out.splitlines()[-1], "never came: Driving (20 ms)")
        out, err = self.run_tool("--spec", self.CAR, "stats", path, "Driving", "LockCommand", code=1)
        self.assertEqual(out.splitlines()[-1], "never came: Driving (20 ms)")
        self.assertIn("amiroctl: stats: nothing came of Driving, LockCommand\n", err)
        report, _ = self.report(self.log([(0, self.GYRO), (500, self.GYRO)]))
        self.assertEqual(report["never_came"], [])  # a topic comes when it is asked for

    def test_a_message_of_the_transport_protocol_came(self):
        """SAE J1939-21: 16 bytes of VI, announced to all and sent in three packets."""
        truck = os.path.join(self.folder, "truck.dbc")
        with open(truck, "w", encoding="ascii") as file:
            file.write(f'BO_ {0x98FEECFE} VI: 16 Motor\n SG_ First : 0|8@1+ (1,0) [0|0] "" Dash\n'
                       'BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";\n'
                       'BA_DEF_DEF_ "VFrameFormat" "J1939PG";\nBA_DEF_ "Baudrate" INT 0 1000000;\nBA_DEF_DEF_ "Baudrate" 250000;\n'
                       'BA_ "Baudrate" 250000;\n')
        packets = ["1CECFF00#20100003FFECFE00", "1CEBFF00#0100000000000000", "1CEBFF00#0200000000000000", "1CEBFF00#030000FFFFFFFFFF"]
        path = self.log([(1000 * turn + 50 * i, frame) for turn in range(3) for i, frame in enumerate(packets)])
        report, _ = self.report("--spec", truck, path)
        bus = report["buses"][0]
        self.assertEqual([(topic["topic"], topic["count"]) for topic in bus["topics"]], [("VI", 3)])
        self.assertEqual((bus["transport"], bus["unknown"]), (9, 0))
        out, _ = self.run_tool("--spec", truck, "stats", path)
        self.assertIn("  9 frames of the transport protocol of J1939\n", out)
        path = self.log([(50 * i, frame.replace("ECFE00", "ECFA00")) for i, frame in enumerate(packets)])
        report, _ = self.report("--spec", truck, path)
        self.assertEqual(report["buses"][0]["unknown_ids"], [{"id": "1CFAEC00", "count": 1}])

    CONTRADICTIONS = ("5 of 8 frames contradict the spec of AMiRo (2 of no topic, 3 of wrong length, such as 605 with 2 bytes in "
                      "place of 4): the others may be of another robot, too, and mean something else. --spec FILE names its topics\n")

    def test_frames_of_another_robot(self):
        """As decode and listen have it."""
        frames = [(i, frame) for i, frame in enumerate(["608#112233445566"] * 3 + ["7FF#11"] * 2 + ["605#1122"] * 3)]
        path = self.log(frames)
        for form in ((), ("--json",), ("--csv",)):
            _, err = self.run_tool("stats", *form, path)
            self.assertEqual(err, self.CONTRADICTIONS)
        _, err = self.run_tool("stats", self.log([(i, "7FF#11") for i in range(9)], "foreign.log"))
        self.assertEqual(err, "9 of 9 frames are of no topic of AMiRo: a log of another bus? --spec FILE names the topics of "
                              "another robot\n")
        _, err = self.run_tool("stats", self.log([(i, "608#112233445566") for i in range(19)] + [(19, "7FF#11")], "few.log"))
        self.assertEqual(err, "")
        # Of several interfaces that one is named.
        two = [(ms, frame, "can1") for ms, frame in frames] + [(9 + i, "608#112233445566", "can0") for i in range(200)]
        _, err = self.run_tool("stats", self.log(two, "two.log"))
        self.assertEqual(err, "can1: " + self.CONTRADICTIONS)

    def test_frames_of_another_robot_live(self):
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        stats = self.start("stats", "--json", "-n", "8")
        self.assertIn("bus: sim", stats.stderr.readline())
        self.settle()
        self.run_tool("send", "--stdin", stdin="608#112233445566\n" * 3 + "7FF#11\n" * 2 + "605#1122\n" * 3)
        _, err = stats.communicate(timeout=20)
        self.assertEqual(err, self.CONTRADICTIONS)

    def test_assertions(self):
        path = self.log([(0, "108#01F40100")] + [(1 + 500 * i, self.GYRO) for i in range(5)])
        holds = ["gyro.rate>1.9", "gyro.rate == 2Hz", "gyroscope.count==5", "gyro.period<=500ms", "gyro.jitter<1us",
                 "gyro.gap<0.6s", "gyro.missing==0", "gyro.incomplete=0", "gyro.lateness<=0", "gyro.load<1%",
                 "bus.errors==0", "bus.unknown==0", "bus.drops==0", "bus.frames==6", "bus.load<1%", "bus.peak<1%",
                 "bus.rate!=7", "mag.count==0"]
        arguments = [word for each in holds for word in ("--assert", each)]
        out, err = self.run_tool("stats", path, "--json", *arguments)
        self.assertEqual([a["holds"] for a in json.loads(out)["assertions"]], [True] * len(holds))
        self.assertNotIn("does not hold", err)

    def test_assertions_that_do_not_hold_say_what_was_measured(self):
        path = self.log([(0, "108#01F40100")] + [(1 + 500 * i, self.GYRO) for i in range(5)])
        for expression, measured in (("gyro.rate>2", "it is 2 Hz"), ("gyro.period<500ms", "it is 500 ms"),
                                     ("gyro.count!=5", "it is 5"), ("bus.frames>6", "it is 6"),
                                     ("bus.load==0", "it is 0.0"),
                                     # No data is no success.
                                     ("mag.rate>=0", "nothing was measured"),
                                     ("mag.missing==0", "nothing was measured"),
                                     ("motors.gap<1h", "nothing was measured")):
            out, err = self.run_tool("stats", path, "--assert", expression, code=1)
            self.assertIn(f"does not hold: {expression}: {measured}", err)
            self.assertIn("gyroscope", out)

    def test_a_log_without_times_has_no_rate(self):
        path = os.path.join(self.folder, "screen.log")
        with open(path, "w", encoding="ascii") as file:
            file.write("  can0  608   [6]  00 11 22 33 44 55\n" * 3)
        for expression in ("gyro.rate<1", "bus.rate<1"):
            _, err = self.run_tool("stats", path, "--assert", expression, code=1)
            self.assertIn(f"does not hold: {expression}: nothing was measured", err)

    def test_a_gap_is_measured_from_a_request_on(self):
        path = self.log([(0, "208#01640000"), (1000, "655#")])
        self.run_tool("stats", path, "--assert", "gyro.gap==1s", "--assert", "gyro.missing==9")
        _, err = self.run_tool("stats", path, "--assert", "gyro.rate>=0", code=1)
        self.assertIn("does not hold: gyro.rate>=0: nothing was measured", err)

    def test_a_bad_expression_is_wrong_usage_with_a_remedy(self):
        path = self.log([(0, self.GYRO)])
        for expression, what, remedy in (
                ("gyro", "compares nothing", "TOPIC.QUANTITY>NUMBER"),
                ("gyro>1", "has no quantity", "TOPIC.QUANTITY>NUMBER"),
                ("gyroscoope.rate>1", "no topic 'gyroscoope'", "did you mean 'gyroscope'?"),
                ("gyro.rat>1", "no quantity 'rat'", "did you mean 'rate'?"),
                ("bus.gap>1s", "no quantity 'gap' of the bus", "one of: rate"),
                ("gyro.rate>fast", "'fast' is nothing to compare a rate with", "1.9Hz"),
                ("gyro.gap<100", "'100' is nothing to compare a gap with", "50ms"),
                ("bus.load<0.4", "'0.4' is nothing to compare a load with", "40%"),
                ("gyro.count==5ms", "'5ms' is nothing", "plain number"),
                ("gyro.rate!1", "'!' compares nothing", "!=")):
            _, err = self.run_tool("stats", path, "--assert", expression, code=2)
            self.assertIn(what, err)
            self.assertIn(remedy, err)

    def test_interfaces_have_a_table_each_and_assertions_hold_on_all(self):
        frames = [(10 * i, self.GYRO, f"can{i % 2}") for i in range(20)] + [(400, self.GYRO, "can1")]
        path = self.log(frames)
        report, _ = self.report(path)
        self.assertEqual([(b["bus"], b["topics"][0]["count"]) for b in report["buses"]], [("can0", 10), ("can1", 11)])
        self.run_tool("stats", path, "--assert", "gyro.count>=10")
        _, err = self.run_tool("stats", path, "--assert", "gyro.gap<100ms", code=1)
        self.assertIn("it is 210 ms on can1", err)
        # One bus is enough not to hold, also if the next one does.
        _, err = self.run_tool("stats", path, "--assert", "gyro.count>=11", code=1)
        self.assertIn("it is 10 on can0", err)
        _, err = self.run_tool("stats", path, "--assert", "bus.frames==11", code=1)
        self.assertIn("it is 10 on can0", err)
        _, err = self.run_tool("stats", path, "--assert", "bus.frames==10", code=1)
        self.assertIn("it is 11 on can1", err)

    def test_several_logs_go_on(self):
        first = self.log([(i, self.GYRO) for i in (0, 100)], "1.log")
        second = self.log([(i, self.GYRO) for i in (200, 300)], "2.log")
        report, _ = self.report(first, second)
        self.assertEqual(report["buses"][0]["topics"][0]["count"], 4)
        self.assertEqual(report["buses"][0]["topics"][0]["spread_ns"], 0)
        self.assertEqual(report["source"], "2 logs")

    def test_limits_and_topics(self):
        path = self.log([(100 * i, self.GYRO) for i in range(10)] + [(2000, "605#00000000")])
        report, _ = self.report(path, "--duration", "300ms")
        self.assertEqual(report["buses"][0]["frames"], 4)
        report, _ = self.report(path, "-n", "7")
        self.assertEqual(report["buses"][0]["frames"], 7)
        long = self.log([(i, self.GYRO) for i in range(1000)], "long.log")
        report, _ = self.report(long, "-n", "600")  # a log is read in pieces
        self.assertEqual(report["buses"][0]["frames"], 600)
        report, _ = self.report(path, "mag")
        self.assertEqual([t["topic"] for t in report["buses"][0]["topics"]], ["magnetometer"])

    def test_table_and_csv(self):
        path = self.log([(0, "108#01F40100")] + [(1 + 500 * i, self.GYRO) for i in range(5)])
        out, _ = self.run_tool("hz", path)
        rows = out.splitlines()
        self.assertEqual(rows[0].split(), ["TOPIC", "PRIORITY", "SAMPLES", "RATE", "PERIOD", "MEAN", "JITTER", "LATE",
                                           "MISSING", "LONGEST", "GAP", "LOAD", "FAULTS"])
        self.assertEqual(rows[1].split()[:5], ["gyroscope", "high", "5", "2", "Hz"])
        self.assertIn("500 ms at 1 ms", rows[1])
        self.assertTrue(rows[2].startswith("can0: 6 frames in 2.001 s"), rows[2])
        out, _ = self.run_tool("stats", "--csv", path)
        head, row = out.splitlines()
        values = dict(zip(head.split(","), row.split(",")))
        self.assertEqual((values["bus"], values["topic"], values["priority"], values["count"], values["period_ns"]),
                         ("can0", "gyroscope", "high", "5", "500000000"))
        self.assertEqual(values["rate_hz"], "2.0")

    def test_frames_that_the_log_says_were_lost(self):
        """By interface: statistics blocks of pcapng [draft-ietf-opsawg-pcapng, 4.6], of which the last of each counts."""
        def block(kind, body):
            return struct.pack("<II", kind, len(body) + 12) + body + struct.pack("<I", len(body) + 12)

        def option(code, value):
            return struct.pack("<HH", code, len(value)) + value + bytes(-len(value) % 4)

        def interface(name):
            return block(1, struct.pack("<HHI", 227, 0, 0) + option(2, name) + option(9, b"\x09") + option(0, b""))  # CAN, of nanoseconds

        def packet(number, ns):
            frame = struct.pack(">IB3x", 0x608, 6) + bytes(6)
            return block(6, struct.pack("<IIIII", number, ns >> 32, ns & 0xFFFFFFFF, len(frame), len(frame)) + frame + bytes(-len(frame) % 4))

        def statistics(number, dropped):
            return block(5, struct.pack("<III", number, 0, 0) + option(5, struct.pack("<Q", dropped)) + option(0, b""))
        path = os.path.join(self.folder, "lossy.pcapng")
        with open(path, "wb") as file:
            file.write(block(0x0A0D0D0A, struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1)) + b"".join(interface(name) for name in (b"can0", b"can1", b"can2"))
                       + b"".join(packet(number, START * 10**9 + number) for number in range(3))
                       + statistics(0, 3) + statistics(2, 4) + statistics(0, 5))
        report, _ = self.report(path)
        self.assertEqual([(bus["bus"], bus["frames"], bus["drops"]) for bus in report["buses"]], [("can0", 1, 5), ("can1", 1, 0), ("can2", 1, 4)])
        out, _ = self.run_tool("stats", path)
        self.assertEqual([line for line in out.splitlines() if "lost" in line], ["  5 frames lost", "  4 frames lost"])
        _, err = self.run_tool("stats", path, "--assert", "bus.drops==0", code=1)
        self.assertIn("does not hold: bus.drops==0: it is 5 on can0", err)

    def test_a_log_whose_end_cannot_be_read_is_an_error_behind_its_figures(self):
        """Of several logs any of them is."""
        with open(self.log([(10 * i, f"608#{i % 256:02X}{i * 7 % 256:02X}00000000") for i in range(2000)], "all.log"), "rb") as file:
            packed = gzip.compress(file.read())
        paths = {}
        for name, content in (("whole.log.gz", packed), ("cut.log.gz", packed[: len(packed) // 2])):
            paths[name] = os.path.join(self.folder, name)
            with open(paths[name], "wb") as file:
                file.write(content)
        whole, cut = paths["whole.log.gz"], paths["cut.log.gz"]
        report, err = self.report(whole)
        self.assertEqual((report["buses"][0]["topics"][0]["count"], err), (2000, ""))
        for logs in ((cut,), (cut, whole), (whole, cut)):
            report, err = self.report(*logs, code=1)
            self.assertGreater(report["buses"][0]["topics"][0]["count"], 500)
            self.assertIn("cut.log.gz", err)
        # What is not read of it is not missed.
        self.report(cut, "-n", "10")

    def test_wrong_words(self):
        _, err = self.run_tool("stats", "gyroscop", code=2)
        self.assertIn("did you mean 'gyroscope'?", err)
        _, err = self.run_tool("stats", os.path.join(self.folder, "none.log"), code=1)
        self.assertIn("none.log", err)
        for word in ("nofile.log", "nofile.log.gz", "drive.pcapng", "no/such"):  # here is no simulator: no bus is looked for
            _, err = self.run_tool("stats", word, code=1)
            self.assertIn(f"cannot read {word}: No such file", err)
            self.assertNotIn("one of:", err)
        for verb in ("listen", "record"):
            _, err = self.run_tool(verb, "drive.log", code=2)
            self.assertIn(f"{verb}: no topic 'drive.log', which names a file", err)
            self.assertNotIn("one of:", err)
            self.assertIn("decode, stats and plot read logs, record -o drive.log writes one", err)
        path = self.log([(0, self.GYRO)])
        _, err = self.run_tool("stats", path, "live", code=2)
        self.assertIn("live is the bus", err)
        _, err = self.run_tool("stats", path, "--bitrate", "0", code=2)
        self.assertIn("--bitrate 0", err)
        _, err = self.run_tool("stats", path, "--duration", "soon", code=2)
        self.assertIn("--duration soon", err)

    def test_a_log_without_frames_is_an_error(self):
        path = os.path.join(self.folder, "junk.log")
        with open(path, "w", encoding="ascii") as file:
            file.write("(1.000000) can0 nothing\n")
        _, err = self.run_tool("stats", path, "--from", "candump", code=1)
        self.assertIn("no frame came from junk.log", err)

    def test_live(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "20ms")
        self.run_tool("publish", "odom", "100ms")
        out, err = self.run_tool("stats", "live", "--json", "--duration", "2s", "--assert", "gyro.rate>30",
                                 "--assert", "odom.rate>5", "--assert", "bus.errors==0", "--assert", "bus.unknown==0")
        bus = json.loads(out)["buses"][0]
        topics = {t["topic"]: t for t in bus["topics"]}
        self.assertIn("bus: sim", err)
        self.assertEqual(bus["bus"], "sim")
        self.assertEqual(topics["odometry"]["incomplete"], 0)
        self.assertGreater(bus["load_percent"], 0.5)
        self.assertGreater(topics["gyroscope"]["rate_hz"], 30)

    def test_live_sees_requests_and_ends_with_ctrl_c(self):
        self.start_sim()
        stats = self.start("stats", "--json")
        self.assertIn("bus: sim", stats.stderr.readline())
        self.settle()
        self.run_tool("publish", "gyro", "50ms", "--priority", "high")
        self.run_tool("listen", "gyro", "-n", "8", "--timeout", "20s")
        self.settle()  # it has read what the other has
        out, _ = self.interrupt(stats)
        self.assertEqual(stats.returncode, 128 + signal.SIGINT)
        gyro = json.loads(out)["buses"][0]["topics"][0]
        self.assertEqual((gyro["period_ns"], gyro["period_from"]), (50_000_000, "request"))
        self.assertGreater(gyro["by_priority"]["high"], 5)

    def test_live_in_a_pipe_is_told_every_second(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "100ms")
        stats = self.start("stats", "gyro")
        lines = [stats.stdout.readline() for _ in range(6)]  # two tables
        self.assertEqual([line.split()[0] for line in lines], ["TOPIC", "gyroscope", "sim:"] * 2)
        self.assertNotIn("\x1b", "".join(lines))
        self.interrupt(stats)
        self.assertEqual(stats.returncode, 128 + signal.SIGINT)

    def test_live_on_a_silent_bus(self):
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        _, err = self.run_tool("stats", "--duration", "300ms", code=1)
        self.assertIn("no frame came from sim\na sensor is silent until it is asked, as by `amiroctl publish odometry 500ms`\n", err)
        _, err = self.run_tool("stats", "--duration", "300ms", "--assert", "gyro.rate>0", code=1)
        self.assertIn("does not hold: gyro.rate>0: nothing was measured", err)

    def test_without_a_bit_rate_all_but_the_load(self):
        spec, log = os.path.join(self.folder, "car.dbc"), os.path.join(self.folder, "in.log")
        with open(spec, "w", encoding="ascii") as file:
            file.write('BU_: A\nBO_ 256 Engine: 8 A\n SG_ Speed : 0|16@1+ (1,0) [0|0] "rpm" A\n')
        with open(log, "w", encoding="ascii") as file:
            file.writelines(f"({1 + number / 10:.1f}) can0 100#0000000000000000\n" for number in range(11))
        out, _ = self.run_tool("--spec", spec, "stats", log)
        self.assertRegex(out, r"can0: 11 frames in 1\S* s \(10 Hz\); for its load: --bitrate 500k")
        out, _ = self.run_tool("--spec", spec, "stats", log, "--json")
        bus, = json.loads(out)["buses"]
        self.assertEqual([bus[key] for key in ("bit_rate", "load_percent", "request_load_percent", "unknown_load_percent",
                                               "worst_100ms_load_percent")], [None] * 5)
        self.assertEqual((bus["topics"][0]["load_percent"], bus["topics"][0]["mean_ns"]), (None, 100000000))
        out, _ = self.run_tool("--spec", spec, "stats", log, "--csv")
        self.assertTrue(out.splitlines()[1].endswith(","), out)
        for wanted in ("bus.load<90%", "bus.peak<90%", "Engine.load<90%"):
            _, err = self.run_tool("--spec", spec, "stats", log, "--assert", wanted, code=1)
            self.assertIn(wanted, err)
        self.run_tool("--spec", spec, "stats", log, "--assert", "Engine.rate>9")
        out, _ = self.run_tool("--spec", spec, "stats", log, "--bitrate", "500k", "--assert", "bus.load<1%")
        self.assertIn("load", out)


if __name__ == "__main__":
    main()
