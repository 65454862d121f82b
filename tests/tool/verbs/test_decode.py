"""decode, encode and send --stdin: a log in words, back again, and onto a bus."""

import gzip
import json
import os
import re
import resource
import struct
import subprocess
import time

from harness import AMIROCTL, SOURCE, Case, main, sanitized, waiting

# One frame of every kind. [docs/verbs/listen.md; candump's notation: can-utils lib.h]
LOG = """\
(1436509052.249713) can0 608#0300FFFF0000
(1436509052.349713) can0 602#50C30000400D0300
(1436509052.350000) can1 603#0000000001000000 R
(1436509053.000000) can0 208#01F40100 T
(1436509053.500000) can0 201#50C30000400D0300
(1436509054.000000) can0 4FF#0011
(1436509054.100000) can0 608#01
(1436509054.200000) can0 12345678#DEADBEEF
(1436509054.300000) can0 123#R4
(1436509054.400000) can0 608##10300FFFF00001122
(1436509054.500000) can0 601#0011223344556677_C
(1436509054.600000) can0 20000040#0000000000000000
"""


class Decode(Case):
    def file(self, name, content):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return path

    def test_a_number_with_a_leading_zero_is_decimal(self):
        for number, count in (("010", 10), ("08", 8), ("0x3", 3), ("+010", 10)):
            self.assertEqual(len(self.run_tool("decode", "--json", "-n", number, stdin=LOG)[0].splitlines()), count)

    def test_back_to_the_byte(self):
        out, err = self.run_tool("decode", "--json", stdin=LOG)
        self.assertEqual(len(out.splitlines()), 12)
        self.assertIn("12 frames, 2 samples, 2 commands, 4 of unknown identifier, 1 of CAN FD, 1 of wrong length, "
                      "1 error frame", err)
        again, _ = self.run_tool("encode", stdin=out)
        self.assertEqual(again, LOG)
        converted, _ = self.run_tool("convert", "-", "-", "--to", "json", stdin=LOG)
        self.assertEqual(converted, out)
        again, _ = self.run_tool("convert", "-", "-", "--to", "candump", stdin=converted)
        self.assertEqual(again, LOG)

    def test_without_a_standard_input_a_file_takes_its_number(self):
        path = self.file("a.log", LOG)
        done = subprocess.run([AMIROCTL, "decode", "--raw", path], env=self.environment, capture_output=True, text=True, timeout=60,
                              preexec_fn=lambda: os.close(0))
        self.assertEqual((done.stdout, done.stderr), self.run_tool("decode", "--raw", path))

    def test_derived_fields(self):
        # Sensor 4 sees 377 counts above its offset, 2350, and so something 50 mm away; sensor 1 nothing.
        log = "(1.0) can0 61F#F108\n(1.1) can0 622#A70A\n"
        far, near = self.objects(self.run_tool("decode", stdin=log)[0])
        self.assertEqual(far["fields"], {"proximity": 2289})
        self.assertEqual(near["fields"], {"proximity": 2727, "distance": 0.05001, "distance_uncertainty": 0.0003})
        self.assertEqual(near["units"], {"proximity": "", "distance": "m", "distance_uncertainty": "m"})
        out, _ = self.run_tool("decode", "--csv", stdin=log)
        self.assertEqual([line.split(",")[2:5] for line in out.splitlines()[1:]],
                         [["sensor_1.proximity", "2289", ""], ["sensor_4.proximity", "2727", ""], ["sensor_4.distance", "0.05001", "m"],
                          ["sensor_4.distance_uncertainty", "0.0003", "m"]])
        # A frame's name alone is what is on the wire; derived fields have names of their own.
        out, _ = self.run_tool("decode", "--field", "ring.sensor_4", stdin=log)
        self.assertEqual([line["fields"] for line in self.objects(out)], [{"proximity": 2727}])
        out, _ = self.run_tool("decode", "--field", "ring.sensor_4.distance", stdin=log)
        self.assertEqual([line["fields"] for line in self.objects(out)], [{"distance": 0.05001}])
        for condition, lines in (("ring.sensor_4.distance<0.0501", 1), ("ring.sensor_4.distance<0.05m", 0), ("ring.sensor_4.distance>5", 0)):
            out, _ = self.run_tool("decode", "--where", condition, "--topic", "ring", stdin=log, code=0 if lines else 1)
            self.assertEqual(sum("sensor_4" in line for line in out.splitlines()), lines, condition)

    def test_derived_fields_in_words(self):
        # Eight frames are a sample; of all sensors but the fourth nothing is in sight.
        log = "".join(f"(1.{i}) can0 {0x61F + i:03X}#{'A70A' if i == 3 else 'D007'}\n" for i in range(8))
        out, _ = self.run_tool("decode", "--pretty", stdin=log)
        self.assertIn("sensor_4  2727  distance  0.05001 +-0.0003 m", out.replace("    ", " ").replace("   ", "  "))
        self.assertEqual(out.count("distance"), 1)

    def test_derived_fields_come_back(self):
        log = "(0000000001.000000) can0 61F#F108\n(0000000001.100000) can0 622#A70A\n"
        out, _ = self.run_tool("decode", stdin=log)
        self.assertEqual(self.run_tool("encode", stdin=out)[0], log)
        edited = out.replace('"proximity":2727', '"proximity":2726')  # what was derived before is no edit
        self.assertIn("622#A60A", self.run_tool("encode", stdin=edited)[0])
        _, err = self.run_tool("encode", stdin=out.replace("0.05001", "0.04"), code=1)
        self.assertIn('"distance" is not what proximity says, of which it is derived', err)
        _, err = self.run_tool("encode", stdin='{"topic":"ring","frame":"sensor_4","fields":{"distance":0.05}}\n', code=1)
        self.assertIn("edit proximity, and leave distance out", err)

    def test_json(self):
        out, _ = self.run_tool("decode", stdin=LOG)
        first, velocity, pose, request, motors = self.objects(out)[:5]
        self.assertEqual(first["fields"], {"x": 0.0525, "y": -0.0175, "z": 0})
        self.assertEqual(list(first), ["time_ns", "bus", "id", "priority", "topic", "frame", "fields", "units", "data"])
        self.assertEqual((velocity["frame"], pose["frame"]), ("velocity", "pose"))
        self.assertEqual((pose["bus"], pose["direction"]), ("can1", "received"))
        self.assertEqual(request["fields"], {"mode": "publish", "period": 0.5})
        # Without a period the topic's own holds: of the gyroscope 50 ms, of a status 1 s. [spec/topics.json]
        short = self.objects(self.run_tool("decode", "--json", stdin="(1.0) can0 208#01\n(2.0) can0 21B#01\n")[0])
        self.assertEqual([each["fields"]["period"] for each in short], [0.05, 1])
        self.assertEqual(motors["topic"], "motors")

    def test_a_selector_that_chooses_no_field(self):
        """The pages of Service are 0 to 3."""
        car = ("--spec", os.path.join(SOURCE, "examples", "small_car.dbc"), "decode", "--json")
        good, bad = "(1.0) can0 400#0102030405060708\n", "(2.0) can0 400#0902030405060708\n"
        _, err = self.run_tool(*car, "--strict", stdin=good)
        self.assertNotIn("selector", err)
        out, err = self.run_tool(*car, stdin=good + bad)
        self.assertEqual(self.objects(out)[1]["fields"], {"Page": 9})
        self.assertIn("2 frames, 2 samples, 1 frame whose selector chooses no field\n", err)
        _, err = self.run_tool(*car, "--strict", stdin=bad + bad, code=1)
        self.assertIn("2 frames whose selector chooses no field", err)

    def test_choices(self):
        def lines(*arguments):
            return self.run_tool("decode", *arguments, stdin=LOG)[0].splitlines()

        self.assertEqual(len(lines("--topic", "gyro")), 3)
        self.assertEqual(len(lines("--topic", "gyro", "--topic", "odom")), 5)
        self.assertEqual(lines("--csv", "--field", "gyroscope.y", "--field", "odom.velocity.x"), [
            "time,gyroscope.y,odometry.velocity.x", "1436509052.249713000,-0.0175,", "1436509052.349713000,,0.05"])
        self.assertEqual([json.loads(line)["fields"] for line in lines("--field", "gyro.y")], [{"y": -0.0175}])
        self.assertEqual(len(lines("-n", "3")), 3)
        self.assertEqual(len(lines("--since", "100ms", "--until", "1s")), 3)
        self.assertEqual(len(lines("--pretty")), 11)  # two frames of a sample are one line
        self.assertEqual("\n".join(lines("--raw")) + "\n", LOG)

    def test_frames_are_chosen_by_identifier_sender_group_and_condition(self):
        car = "".join(f"({number}.0) can0 {frame}\n" for number, frame in enumerate((
            "100#0019000000000000",  # Engine.Speed 1600
            "130#0000000000000000",  # Driving
            "100#E02E000000000000",  # Engine.Speed 3000
            "130#2710000000000000",  # Driving.Speed 100
            "400#0100030000000000",  # Service.FaultCode 3
            "400#0000000000000000",  # Service without it
            "100#E12E000000000000",  # Engine.Speed 3000.25
            "00000100#00",  # of no topic
            "130#4E20000000000000")))  # Driving.Speed 200

        def times(*arguments, spec="small_car.dbc", log=car, code=0):
            out, _ = self.run_tool("--spec", os.path.join(SOURCE, "examples", spec), "decode", "--json", *arguments, stdin=log, code=code)
            return [int(event["time_ns"]) // 10**9 for event in self.objects(out)]

        self.assertEqual(times("--topic", "Engine"), [0, 2, 6])
        self.assertEqual(times("--sender", "EngineControl"), [0, 2, 6])
        self.assertEqual(times("--sender", "EngineControl", "--topic", "Service"), [0, 2, 4, 5, 6])
        self.assertEqual(times("--filter", "100:7FF"), [0, 2, 6, 7])  # as candump: the format is not asked
        self.assertEqual(times("--filter", "00000100:9FFFFFFF", code=1), [7])
        self.assertEqual(times("--filter", "100~700"), [4, 5])
        self.assertEqual(times("--filter", "1FFFFFFF~0", code=1), [])  # the largest identifier there is
        self.assertIn("--filter 20000000~0: not a filter", self.run_tool("decode", "--filter", "20000000~0", stdin=car, code=2)[1])
        self.assertEqual(times("--where", "Engine.Speed>=3000"), [2, 6])
        self.assertEqual(times("--where", "Engine.Speed > 3000rpm"), [6])
        self.assertEqual(times("--where", "Engine.Speed=3000"), [2])
        self.assertEqual(times("--where", "Engine.Speed!=3000"), [0, 6])
        self.assertEqual(times("--where", "Service.FaultCode<=3"), [4])  # where it is there
        self.assertEqual(times("--where", "Service.FaultCode<3", code=1), [])
        # While it holds: others are shown by what it said last.
        self.assertEqual(times("--topic", "Driving", "--where", "Engine.Speed>=3000"), [3, 8])
        self.assertEqual(times("--topic", "Driving", "--where", "Engine.Speed>=3000", "--where", "Driving.Speed>150"), [8])
        self.assertEqual(times("--where", "Engine.Running=stopped", "--where", "Engine.Speed>2000"), [2, 6])
        truck = "(1.0) can0 0CF00400#FFFFFFE02E0000FF\n(2.0) can0 18FEF100#FFFFFFFFFFFFFFFF\n(3.0) can0 18F00403#FFFFFF00000000FF\n"
        self.assertEqual(times("--pgn", "F004", spec="truck.dbc", log=truck), [1, 3])
        self.assertEqual(times("--pgn", "0xFEF1", spec="truck.dbc", log=truck), [2])
        gyro = self.run_tool("decode", "--where", "gyro.x>0.05", stdin=LOG)[0]
        self.assertEqual([event["data"] for event in self.objects(gyro)], ["0300FFFF0000"])
        # Both frames of a sample are shown, and requests are none.
        odometry = self.run_tool("decode", "--where", "odom.velocity.x=0.05", stdin=LOG)[0]
        self.assertEqual([event["frame"] for event in self.objects(odometry)], ["velocity", "pose"])

    def samples_in_mcap(self, log, *words):
        """Schemas by name and samples, as JSON, of a log that is converted to MCAP."""
        path = os.path.join(self.folder, "samples.mcap")
        self.run_tool(*words, "convert", self.file("samples.log", log), path, "--force")
        schemas, channels, samples = {}, {}, []

        def text(content, at):
            end = at + 4 + struct.unpack_from("<I", content, at)[0]
            return content[at + 4:end].decode(), end

        def read(data):
            at = 0
            while at < len(data):
                kind, size = struct.unpack_from("<BQ", data, at)
                content, at = data[at + 9:at + 9 + size], at + 9 + size
                if kind == 3:  # a schema
                    name, end = text(content, 2)
                    schemas[struct.unpack_from("<H", content)[0]] = (name, json.loads(text(content, text(content, end)[1])[0]))
                elif kind == 4:  # a channel
                    channels[struct.unpack_from("<H", content)[0]] = text(content, 4)[0]
                elif kind == 5:  # a message
                    samples.append((channels[struct.unpack_from("<H", content)[0]], content[22:].decode()))
                elif kind == 6:  # a chunk
                    self.assertEqual(text(content, 28)[0], "")  # not packed
                    read(content[40:])

        with open(path, "rb") as file:
            read(file.read()[8:-8])
        return ({name: schema for name, schema in schemas.values() if name != "ocm.CanFrame"},
                [sample for sample in samples if not sample[0].endswith("/raw")])

    def test_samples_and_their_schemas_in_mcap(self):
        log = "".join(f"({number}.0) can0 {frame}\n" for number, frame in enumerate((
            "608#0300FFFF0000", "605#00D20000", "607#01000000", "606#F0FFFFFF", "605#00D20000", "606#F0FFFFFF", "607#01000000",
            "201#50C30000400D0300", "208#02", "608#00", "61E#03640AFF0A00")))
        schemas, samples = self.samples_in_mcap(log)
        self.assertEqual(samples, [
            ("/gyroscope", '{"x":0.0525,"y":-0.0175,"z":0}'),
            ("/magnetometer", '{"x":{"field":0.05376},"y":{"field":-0.000016},"z":{"field":0.000001}}'),
            ("/motors", '{"x":0.05,"z":0.2}'),
            ("/power_status", '{"flags":3,"state_of_charge":100,"minutes":65290,"power":10}')])

        def properties(**described):
            return {name: {"type": "number", "description": words} for name, words in described.items()}

        self.assertEqual({name: schema["properties"] for name, schema in schemas.items()}, {
            "AMiRo.gyroscope": properties(x="deg/s", y="deg/s", z="deg/s"),
            "AMiRo.magnetometer": {axis: {"type": "object", "properties": properties(field="G")} for axis in "xyz"},
            "AMiRo.motors": properties(x="m/s", z="rad/s"),
            "AMiRo.power_status": properties(flags="bit 0 plugged, bit 1 charging", state_of_charge="%", minutes="min, 65535 unknown", power="mW")})
        for name, schema in schemas.items():
            self.assertEqual((schema["$schema"], "AMiRo." + schema["title"], schema["type"]),
                             ("https://json-schema.org/draft/2020-12/schema", name, "object"))
            self.assertNotEqual(schema["description"], "")

    def test_a_sample_in_mcap_is_what_decode_prints(self):
        folder = os.path.join(SOURCE, "tests", "tool", "verbs", "transcripts", "files")
        with open(os.path.join(folder, "values.log"), encoding="ascii") as file:
            log = file.read()
        spec = ("--spec", os.path.join(folder, "values.dbc"))
        out, _ = self.run_tool(*spec, "decode", "--json", stdin=log)
        fields = re.findall(r'"topic":"(\w+)",.*?"fields":(\{.*?\}),"units"', out)
        self.assertGreater(len(fields), 60)
        schemas, samples = self.samples_in_mcap(log, *spec)
        self.assertEqual(samples, [("/" + topic, text) for topic, text in fields])
        self.assertEqual(set(schemas), {"values." + topic for topic, _ in fields})

    def test_a_condition_is_that_of_each_interface(self):
        """Level of can0 and of can1, which have an identifier each."""
        specs = []
        for number, bus in ((256, "can0"), (257, "can1")):
            path = self.file(f"{bus}.dbc", f'BU_: A\nBO_ {number} Tank: 1 A\n SG_ Level : 0|8@1+ (1,0) [0|0] "" A\nBO_ 258 Pump: 1 A\n')
            specs += ["--spec", f"{bus}={path}"]
        log = "".join(f"({number}.0) {frame}\n" for number, frame in enumerate((
            "can0 100#05", "can1 101#01", "can0 102#00", "can1 102#00", "can1 101#06", "can0 100#01", "can0 102#00", "can1 102#00",
            "can0 101#07", "can0 102#00")))  # the last but one is of no message on can0

        def shown(condition):
            events = self.objects(self.run_tool(*specs, "decode", "--json", "--topic", "Pump", "--where", condition, stdin=log)[0])
            return [(int(event["time_ns"]) // 10**9, event["bus"]) for event in events]

        self.assertEqual(shown("Tank.Level>=5"), [(2, "can0"), (7, "can1")])
        self.assertEqual(shown("Tank.Level<5"), [(3, "can1"), (6, "can0"), (9, "can0")])

    def test_strict_counts_what_was_lost_and_what_was_malformed(self):
        """Of J1939's transport protocol, each alone and one of each: a broadcast that has lost a packet, and an announcement of no form."""
        truck = ("--spec", os.path.join(SOURCE, "examples", "truck.dbc"), "decode", "--json", "--strict")
        good = "(1.0) can0 0CF00400#F07D7DE02E0000FF\n"
        lost = "(2.0) can0 1CECFF00#20110003FFECFE00\n(2.1) can0 1CEBFF00#0157444239363334\n(9.0) can0 0CF00400#F07D7DE02E0000FF\n"
        malformed = "(10.0) can0 1CECFF01#2011000300FFECFE\n"
        for log, code in ((good, 0), (good + lost, 1), (good + malformed, 1), (good + lost + malformed, 1)):
            _, err = self.run_tool(*truck, stdin=log, code=code)
            self.assertEqual("timed out" in err, lost in log, err)
            self.assertEqual("1 frame of another form" in err, malformed in log, err)

    def test_a_short_message_that_came_by_the_transport_protocol_has_all_its_fields(self):
        """Eight bytes of fields, and a ninth that means nothing."""
        truck = ("--spec", os.path.join(SOURCE, "examples", "truck.dbc"), "decode", "--json", "--strict")
        log = ("(1.0) can0 0CF00400#F17D8DE02E0503FF\n"
               "(2.0) can0 1CECFF00#20090002FF04F000\n(2.1) can0 1CEBFF00#01F17D8DE02E0503\n(2.2) can0 1CEBFF00#02FF55FFFFFFFFFF\n")
        frame, _, _, last = self.objects(self.run_tool(*truck, stdin=log)[0])
        message = last["message"]
        self.assertEqual(message["fields"], {"TorqueMode": 1, "DemandedTorque": 0, "ActualTorque": 16, "EngineSpeed": 1500,
                                             "ControllingDevice": 5, "StarterMode": 3})
        self.assertEqual((message["topic"], message["fields"], message["units"], message["data"]),
                         ("EEC1", frame["fields"], frame["units"], "F17D8DE02E0503FF55"))

    def test_strict_counts_each_fault(self):
        """Frames of an unknown identifier and those whose selector chooses no field, as many of each as of the other and not."""
        car = ("--spec", os.path.join(SOURCE, "examples", "small_car.dbc"), "decode", "--json", "--strict")
        good, unselected, unknown = "(1.0) can0 400#0102030405060708\n", "(2.0) can0 400#0902030405060708\n", "(3.0) can0 7FF#01\n"
        for some in range(3):
            for others in range(3):
                self.run_tool(*car, stdin=good + some * unselected + others * unknown, code=1 if some or others else 0)

    def test_a_choice_that_nothing_matches(self):
        car = os.path.join(SOURCE, "examples", "small_car.dbc")
        log = "(1.0) can0 100#0019000000000000\n" * 7
        for choice in (("--pgn", "F004"), ("--where", "Engine.Speed>7000"), ("--topic", "Driving"), ("--field", "Driving.Speed")):
            out, err = self.run_tool("--spec", car, "decode", "--json", *choice, stdin=log, code=1)
            self.assertEqual(out, "")
            self.assertIn("none of 7 frames matches\n", err)

    def test_a_frame_means_what_the_spec_of_its_interface_says(self):
        specs = []
        for interface, name in (("can0", "Engine"), ("can1", "Target")):
            path = self.file(interface + ".dbc", f'BU_: N\nBO_ 256 {name}: 8 N\n SG_ Speed : 0|8@1+ (1,0) [0|0] "" N\n')
            specs += ["--spec", f"{interface}={path}"]
        log = "".join(f"({i + 1}.0) {interface} 100#0{i}00000000000000\n" for i, interface in enumerate(("can0", "can1", "can0", "can2")))
        out, _ = self.run_tool(*specs, "decode", "--json", stdin=log)
        self.assertEqual([(event["bus"], event.get("topic"), event.get("fields")) for event in self.objects(out)],
                         [("can0", "Engine", {"Speed": 0}), ("can1", "Target", {"Speed": 1}), ("can0", "Engine", {"Speed": 2}), ("can2", None, None)])

    def test_remote_frames_of_known_identifiers(self):
        car = os.path.join(SOURCE, "examples", "small_car.dbc")
        log = "(1.0) can0 100#0019000000000000\n(1.1) can0 100#R8\n(1.2) can0 101#R\n"
        out, err = self.run_tool("--spec", car, "decode", "--json", stdin=log)
        events = self.objects(out)
        self.assertEqual((events[1]["topic"], events[1]["error"], events[1]["data"]), ("Engine", "remote frame", "R8"))
        self.assertEqual(events[2]["error"], "unknown identifier")
        self.assertIn("1 of unknown identifier, 1 remote\n", err)
        self.assertEqual(self.run_tool("--spec", car, "encode", "--to", "candump", stdin=out)[0].splitlines()[1].split()[-1], "100#R8")
        out, _ = self.run_tool("--spec", car, "decode", "--pretty", stdin=log)
        self.assertRegex(out.splitlines()[1], r"100 Engine +remote frame: 100#R8$")
        self.run_tool("--spec", car, "decode", "--strict", stdin=log, code=1)

    def test_unknown_groups_of_j1939_say_what_their_identifier_says(self):
        truck = os.path.join(SOURCE, "examples", "truck.dbc")
        log = "(1.0) can0 18FEED21#00\n(2.0) can0 123#00\n(3.0) can0 18EF2103##1AA\n"
        out, _ = self.run_tool("--spec", truck, "decode", "--json", stdin=log, code=1)
        events = self.objects(out)
        self.assertEqual({key: events[0][key] for key in ("priority", "pgn", "source", "destination", "error")},
                         {"priority": 6, "pgn": "0FEED", "source": 0x21, "destination": 255, "error": "unknown identifier"})
        self.assertNotIn("pgn", events[1])
        self.assertEqual(self.run_tool("--spec", truck, "encode", stdin="\n".join(out.splitlines()[:2]))[0].split()[2], "18FEED21#00")

    def test_contradictions_of_messages_speak_of_messages(self):
        car = os.path.join(SOURCE, "examples", "small_car.dbc")
        _, err = self.run_tool("--spec", car, "decode", stdin="(0.0) can0 7FF#11\n" * 9, code=1)
        self.assertIn("9 of 9 frames are of no message of small_car: a log of another bus? --spec FILE names the messages of "
                      "another bus\n", err)
        _, err = self.run_tool("--spec", car, "decode", stdin="(0.0) can0 7FF#11\n(0.1) can0 100#0019000000000000\n" * 4)
        self.assertIn("4 of 8 frames contradict the spec of small_car (4 of no message): the others may be of another bus, too, and "
                      "mean something else. --spec FILE names its messages\n", err)

    def test_what_a_log_says_that_it_lacks(self):
        drops = "DROPCOUNT: dropped {} CAN frame(s) on '{}' socket (total drops {})\n"
        log = (" can0  605   [4]  00 D2 00 00\n" + drops.format(3, "can0", 3) + " can1  605   [4]  00 D2 00 00\n" + drops.format(1, "can1", 1) +
               drops.format(2, "can0", 5))
        _, err = self.run_tool("decode", stdin=log)
        self.assertTrue(err.startswith("the standard input: 5 frames of can0 lost while it was recorded\n"
                                       "the standard input: 1 frame of can1 lost while it was recorded\n2 frames, 0 samples\n"), err)

    def test_contradictions_of_a_spec_that_has_topics_and_messages_speak_of_both(self):
        with open(os.path.join(SOURCE, "tests", "generator", "probe.json"), encoding="utf-8") as file:
            spec = json.load(file)
        fields = [{"name": "Speed", "byte": 0, "type": "u16"}]
        spec["messages"] = [{"name": "Engine", "id": "0x18FF1234", "format": "extended", "fields": fields}]
        both = self.file("both.json", json.dumps(spec).encode())
        _, err = self.run_tool("--spec", both, "decode", stdin="(0.0) can0 7FF#11\n" * 9, code=1)
        self.assertIn("9 of 9 frames are of no topic or message of Probe: a log of another bus? --spec FILE names the topics or messages of "
                      "another bus\n", err)
        _, err = self.run_tool("--spec", both, "decode", stdin="(0.0) can0 7FF#11\n(0.1) can0 18FF1234#0019\n" * 4)
        self.assertIn("4 of 8 frames contradict the spec of Probe (4 of no topic or message): the others may be of another bus, too, and "
                      "mean something else. --spec FILE names its topics or messages\n", err)

    def test_senders_that_a_dbc_file_does_not_declare(self):
        spec = self.file("f.dbc", b'BO_ 1 A: 1 XXX\n SG_ a : 0|8@1+ (1,0) [0|0] "" XXX\nBO_ 2 B: 1 Dash\n')
        out, _ = self.run_tool("--spec", spec, "decode", "--json", "--sender", "XXX", stdin="(1.0) can0 001#05\n(2.0) can0 002#05\n")
        self.assertEqual([event["topic"] for event in self.objects(out)], ["A"])
        self.assertIn("XXX", self.run_tool("--spec", spec, "list")[0])
        spec = self.file("g.dbc", b"BO_ 1 A: 1 Vector__XXX\n")
        _, err = self.run_tool("--spec", spec, "decode", "--sender", "XXX", code=2)
        self.assertIn("no such board\n          the spec names no board", err)

    def test_frames_without_a_chosen_field_are_passed_over(self):
        """One that is in some frames only: neither objects without fields nor lines without a number."""
        car = os.path.join(SOURCE, "examples", "small_car.dbc")
        log = "".join(f"({number}.0) can0 {frame}\n" for number, frame in enumerate((
            "400#0000000000000000",  # Service's other pages
            "400#0100030000000000",  # FaultCode 3, FaultCount 0
            "400#0200000000000000",
            "100#0019000000000000")))
        fields = ("--field", "Service.FaultCode", "--field", "Service.FaultCount")
        out, err = self.run_tool("--spec", car, "decode", "--json", *fields, stdin=log)
        self.assertEqual([event["fields"] for event in self.objects(out)], [{"FaultCode": 3, "FaultCount": 0}])
        out, _ = self.run_tool("--spec", car, "decode", "--csv", *fields, "--field", "Engine.Speed", stdin=log)
        self.assertEqual(out.splitlines(), ["time,Service.FaultCode,Service.FaultCount,Engine.Speed",
                                            "1.000000000,3,0,", "3.000000000,,,1600"])
        out, _ = self.run_tool("--spec", car, "decode", "--pretty", *fields, stdin=log)
        self.assertEqual(len(out.splitlines()), 1)
        self.assertIn("FaultCode", out)
        out, _ = self.run_tool("--spec", car, "decode", "--json", "-n", "1", "--field", "Service.OperatingTime", stdin=log)
        self.assertEqual([event["fields"] for event in self.objects(out)], [{"OperatingTime": 0}])

    def test_choices_that_cannot_be(self):
        for arguments, words in ((("--where", "Engine.Speed"), "'Engine.Speed': not a condition\n          write a field, =, !="),
                                 (("--where", "Engine.Sped>3"), "no field 'Engine.Sped'\n          did you mean 'Engine.Speed'?"),
                                 (("--where", "Engine>3"), "'Engine' has 7 fields\n          name one, such as Engine.Speed"),
                                 (("--where", "Engine.Speed>fast"), "'fast' is no value of it\n          Speed takes 0 to 8000 rpm"),
                                 (("--sender", "Brake"), "no such board\n          did you mean 'Brakes'?"),
                                 (("--filter", "100"), "decode: --filter 100: not a filter"),
                                 (("--pgn", "40000"), "--pgn 40000: not a parameter group"),
                                 (("--pgn", "EA21"), "write 0EA00")):
            _, err = self.run_tool("--spec", os.path.join(SOURCE, "examples", "small_car.dbc"), "decode", *arguments, stdin=LOG, code=2)
            self.assertIn(words, err)

    def test_several_files_packed_and_plain(self):
        plain = self.file("a.log", LOG)
        packed = self.file("b.log.gz", gzip.compress(LOG.encode()))
        out, err = self.run_tool("decode", plain, packed, "--json")
        self.assertEqual(len(out.splitlines()), 24)
        self.assertIn("24 frames", err)

    def test_what_cannot_be_decoded(self):
        good = LOG.splitlines()[0] + "\n"
        _, err = self.run_tool("decode", "--strict", stdin=good)
        _, err = self.run_tool("decode", "--strict", stdin=LOG, code=1)
        _, err = self.run_tool("decode", "--strict", stdin=good + "what\n", code=1)
        self.assertIn("line 2", err)
        self.run_tool("decode", stdin=good + "what\n")
        _, err = self.run_tool("decode", stdin="(0.0) can0 7FF#11\n" * 9, code=1)
        self.assertIn("9 of 9 frames are of no topic of AMiRo: a log of another bus? --spec", err)
        self.assertIn("1 of 1 frame is of no topic", self.run_tool("decode", stdin="(0.0) can0 7FF#11\n", code=1)[1])
        _, err = self.run_tool("decode", stdin="(0.0) can0 608#112233445566\n" * 3 + "(0.0) can0 7FF#11\n" * 2
                               + "(0.0) can0 605#1122\n" * 3)
        self.assertIn("5 of 8 frames contradict the spec of AMiRo (2 of no topic, 3 of wrong length, such as 605 with "
                      "2 bytes in place of 4)", err)
        fits, foreign = "(0.0) can0 608#112233445566\n", "(0.0) can0 7FF#11\n"
        for right, wrong, text in ((1, 9, "9 of 10 frames are of no topic of AMiRo: a log of another bus?"),
                                   (2, 8, "8 of 10 frames contradict the spec of AMiRo (8 of no topic): the others may be of another robot, too"),
                                   (9, 1, "1 of 10 frames contradicts the spec of AMiRo (1 of no topic): the others may be of another robot, too")):
            self.assertIn(text, self.run_tool("decode", stdin=fits * right + foreign * wrong)[1])
        for right, wrong in ((10, 1), (19, 1)):
            _, err = self.run_tool("decode", stdin=fits * right + foreign * wrong)
            self.assertNotIn("contradict", err)
            self.assertNotIn("of no topic", err)
        _, err = self.run_tool("decode", "--topic", "ring", stdin=LOG, code=1)
        self.assertIn("none of 12 frames matches", err)
        # A frame that means nothing is none that was not chosen, and none that was decoded.
        car = ("--spec", os.path.join(SOURCE, "examples", "small_car.dbc"), "decode")
        for form in ("--json", "--csv", "--pretty", "--raw"):
            for frame in ("100#01", "101##1AABB", "7FF#01", "100#R"):
                _, err = self.run_tool(*car, form, stdin=f"(1.0) can0 {frame}\n", code=1)
                self.assertNotIn("matches", err)

    def test_what_candump_shows_on_a_terminal(self):
        """As pasted, with the prompt and all. [can-utils candump.c]"""
        out, err = self.run_tool("decode", "--json", stdin="$ candump -t a -x can0\n"
                                 " (1436509052.249713)  can0  RX - -  608   [6]  03 00 FF FF 00 00\n"
                                 " (1436509052.349713)  can0  TX - -  208   [4]  01 F4 01 00\n^C\n")
        heard = self.objects(out)
        self.assertEqual([line["bus"] for line in heard], ["can0", "can0"])
        self.assertEqual(heard[0]["topic"], "gyroscope")
        self.assertEqual(heard[0]["time_ns"], "1436509052249713000")
        self.assertIn("line 1: not of the expected form: $ candump", err)
        self.assertIn("2 places could not be read", err)
        raw, _ = self.run_tool("decode", "--raw", stdin="  can0  605   [4]  00 D2 00 00\n")
        self.assertEqual(raw, "(0000000000.000000) can0 605#00D20000\n")

    def test_wrong_usage(self):
        for arguments, word in ((["--topic", "gyro", "--field", "odom.velocity.x"], "decode: --field odometry.velocity.x, and what is chosen is gyroscope"),
                                (["--where", "gyro.x>1", "--field", "power"], "and what is chosen is gyroscope"),
                                (["--field", "gyro.w"], "no field 'gyro.w'"), (["--field", "gyra"], "no topic 'gyra'"),
                                (["--topic", "gyra"], "no topic 'gyra'"), (["--json", "--csv"], "--"),
                                (["--raw", "--field", "gyro"], "--raw"), (["--since", "soon"], "--since soon"),
                                (["--from", "xml"], "xml")):
            _, err = self.run_tool("decode", *arguments, stdin=LOG, code=2)
            self.assertIn(word, err)
        _, err = self.run_tool("decode", "/nowhere.log", code=1)
        self.assertIn("/nowhere.log", err)

    def test_a_reader_that_goes_away(self):
        path = self.file("long.log", LOG * 20000)
        pipe = subprocess.run(f"'{AMIROCTL}' decode '{path}' | head -1; echo ${{PIPESTATUS[0]}}", shell=True, text=True,
                              executable="/bin/bash", capture_output=True, timeout=30)
        line, code = pipe.stdout.splitlines()
        self.assertEqual((json.loads(line)["topic"], code, pipe.stderr), ("gyroscope", "141", ""))

    def test_a_full_disk(self):
        with open("/dev/full", "w") as full:
            for verb, text in (("decode", LOG), ("encode", '{"id":"123","data":"11"}\n')):
                result = subprocess.run([AMIROCTL, verb], input=text, stdout=full, text=True, stderr=subprocess.PIPE)
                self.assertEqual(result.returncode, 1)
                self.assertIn("cannot write", result.stderr)

    def test_a_file_takes_the_place_of_another_where_it_may_have_so_much(self):
        """To the last byte; with one less the older file stays as it was."""
        log, old = self.file("a.log", LOG), "# an older file\n"
        new = os.path.join(self.folder, "new.log")
        self.run_tool("convert", log, new)
        with open(new, encoding="ascii") as file:
            text = file.read()
        for limit in (len(text), len(text) - 1):
            path = self.file("old.log", old)
            process = self.start("convert", log, path, "--force",
                                 preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
            _, err = process.communicate(timeout=60)
            enough = limit == len(text)
            self.assertEqual(process.returncode, 0 if enough else 1, err)
            self.assertEqual(f"cannot write {path}: File too large" in err, not enough, err)
            with open(path, encoding="ascii") as file:
                self.assertEqual(file.read(), text if enough else old)

    def test_memory_is_constant(self):
        process = waiting.Program([AMIROCTL, "decode", "-"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL)
        self._started.append(process)
        peaks = []
        for megabytes in (1, 25):
            for _ in range(4 * megabytes):
                process.stdin.write((LOG * 500).encode())
            process.stdin.flush()
            with open(f"/proc/{process.pid}/status") as status:
                peaks.append(int(re.search(r"VmHWM:\s*(\d+) kB", status.read())[1]))
        self.assertLess(peaks[1] - peaks[0], 4 * 1024)
        if not sanitized():
            self.assertLess(peaks[1], 32 * 1024)

    def test_a_live_pipe_is_shown_at_once(self):
        process = waiting.Program([AMIROCTL, "decode", "--json"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True, bufsize=1)
        self._started.append(process)
        for line in LOG.splitlines()[:3]:
            process.stdin.write(line + "\n")
            process.stdin.flush()
            self.assertIn("data", json.loads(process.stdout.readline()))
        self.interrupt(process)
        self.assertEqual(process.returncode, 130)

    def test_what_comes_through_a_live_pipe_is_converted_at_once(self):
        process = waiting.Program([AMIROCTL, "convert", "-", "-", "--to", "candump"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True, bufsize=1)
        self._started.append(process)
        for line in LOG.splitlines()[:3]:
            process.stdin.write(line + "\n")
            process.stdin.flush()
            self.assertEqual(process.stdout.readline(), line + "\n")
        self.interrupt(process)
        self.assertEqual(process.returncode, 130)


class Encode(Case):
    def test_edits(self):
        line = json.loads(self.run_tool("decode", stdin=LOG)[0].splitlines()[0])
        line["fields"]["x"] = 0.07
        out, _ = self.run_tool("encode", stdin=json.dumps(line))
        self.assertEqual(out, "(1436509052.249713) can0 608#0400FFFF0000\n")
        del line["data"], line["id"]
        line["priority"] = "urgent"
        out, _ = self.run_tool("encode", stdin=json.dumps(line))
        self.assertEqual(out, "(1436509052.249713) can0 408#0400FFFF0000\n")

    def test_fields_over_one_another(self):
        """The edited one counts, wherever it is in the file, and two that cannot both be so are refused."""
        spec = os.path.join(self.folder, "shared.json")
        with open(spec, "w", encoding="ascii") as file:
            json.dump({"robot": "x", "messages": [{"name": "M", "id": 1, "fields": [
                {"name": "low", "byte": 0, "type": "u4"}, {"name": "whole", "byte": 0, "type": "u8"}, {"name": "top", "bit": 7, "type": "u1"}]}]}, file)
        shared = ("--spec", spec)
        line = json.loads(self.run_tool(*shared, "decode", "--json", stdin="(1.0) can0 001#13\n")[0])
        self.assertEqual(line["fields"], {"low": 3, "whole": 19, "top": 0})
        for edits, data in (({"low": 4}, "14"), ({"whole": 200}, "C8"), ({"top": 1}, "93"), ({"low": 8, "whole": 200, "top": 1}, "C8"), ({}, "13"),
                            ({"low": 3.0, "whole": 200}, "C8")):  # what is there was not edited
            out, _ = self.run_tool(*shared, "encode", stdin=json.dumps(line | {"fields": line["fields"] | edits}))
            self.assertEqual(out.split()[-1], "001#" + data, edits)
        for edits, both in (({"low": 4, "whole": 200}, ("low", "whole")), ({"whole": 1, "top": 1}, ("whole", "top"))):
            _, err = self.run_tool(*shared, "encode", stdin=json.dumps(line | {"fields": line["fields"] | edits}), code=1)
            self.assertIn('fields "%s" and "%s" have bits in common, and cannot be what both are given' % both, err)
        for fields, data in (({"top": 1}, "80"), ({"low": 3, "whole": 131, "top": 1}, "83")):  # without data
            out, _ = self.run_tool(*shared, "encode", stdin=json.dumps({"topic": "M", "fields": fields}))
            self.assertEqual(out.split()[-1], "001#" + data, fields)
        self.run_tool(*shared, "encode", stdin='{"topic":"M","fields":{"low":3,"whole":0}}', code=1)

    def test_stated_ranges(self):
        """An edited value beyond the range that the spec states needs --force; what was on the bus does not."""
        car = ("--spec", os.path.join(SOURCE, "examples", "small_car.dbc"))
        seen = "(0000000001.000000) can0 100#FFFF000000FFB000\n"  # Speed 16383.75 of at most 8000
        line = self.run_tool(*car, "decode", "--json", stdin=seen)[0]
        self.assertEqual(self.run_tool(*car, "encode", stdin=line)[0], seen)
        edited = json.loads(line)
        edited["fields"]["Speed"] = 9000
        _, err = self.run_tool(*car, "encode", stdin=json.dumps(edited), code=1)
        self.assertIn("standard input:1: '9000' is beyond the stated range: Speed takes 0 to 8000 rpm\n"
                      "          many stated ranges are wrong: --force takes what the bits can hold", err)
        out, _ = self.run_tool(*car, "encode", "--force", stdin=json.dumps(edited))
        self.assertEqual(out, "(0000000001.000000) can0 100#A08C000000FFB000\n")
        _, err = self.run_tool(*car, "encode", "--force", stdin=line.replace("16383.75", "16384"), code=1)
        self.assertIn("'16384' is out of range", err)
        # A float that other programs print with other digits is the same number, and no edit.
        cells = '{"topic":"BatteryCells","fields":{"Cell_1":%s}}'
        trip = "(0000000001.000000) can0 310#0000C04700000000\n"  # Distance 98304 of at most 10000, a float
        line = self.run_tool(*car, "decode", "--json", stdin=trip)[0]
        self.assertIn('"Distance":98304', line)
        self.assertEqual(self.run_tool(*car, "encode", stdin=line.replace("98304", "98304.00000000001"))[0], trip)
        # Without data every value is one that was written.
        _, err = self.run_tool(*car, "encode", stdin=cells % "0", code=1)
        self.assertIn("Cell_1 takes 2 to 4.5 V", err)
        out, _ = self.run_tool(*car, "encode", stdin=cells % "3.7")
        self.assertTrue(out.split()[-1].startswith("500##1889000"), out)

    def test_keys_that_are_not_read(self):
        lines = '{"id":"123","data":"11","time":5}\n{"id":"123","data":"11","time":6,"who":"me","units":{},"error":"no"}\n'
        for verb in (["encode"], ["send", "--stdin", "--dry-run"]):
            _, err = self.run_tool(*verb, stdin=lines)
            self.assertIn("standard input: key 'time' is not read (2 lines); did you mean 'time_ns'?\n", err)
            self.assertIn("standard input: key 'who' is not read (1 line)\n", err)
            self.assertEqual(err.count("not read"), 2)
        _, err = self.run_tool("encode", stdin="".join(f'{{"id":"123","data":"11","key\\u001b{i}":0}}\n' for i in range(20)))
        self.assertEqual(err.count("is not read (1 line)"), 8)
        self.assertIn("standard input: other keys are not read, either (12 times)\n", err)
        self.assertNotIn("\x1b", err)
        # What may be meant for another one is named first, however late it comes.
        lines = "".join(f'{{"id":"123","data":"11","k{i}":0,"k{i}":1}}\n' for i in range(8)) + '{"id":"123","data":"11","time":5}\n'
        _, err = self.run_tool("encode", stdin=lines)
        self.assertIn("key 'time' is not read (1 line)", err)
        self.assertIn("key 'k0' is not read (1 line)", err)

    def test_a_topic_is_no_file_and_a_window_has_two_ends(self):
        log, _ = self.run_tool("encode", stdin='{"topic":"gyro","fields":{"x":0}}\n')
        path = os.path.join(self.folder, "a.log")
        with open(path, "w", encoding="ascii") as file:
            file.write(log)
        out, err = self.run_tool("decode", path, "gyro", code=2)
        self.assertEqual(out, "")
        self.assertIn("decode: 'gyro' is a topic, and no file\n          --topic gyro chooses it", err)
        _, err = self.run_tool("decode", path, "--since", "500ms", "--until", "300ms", code=2)
        self.assertIn("decode: --until is before --since", err)
        _, err = self.run_tool("decode", path, "--field", "x", code=2)
        self.assertIn("odometry.velocity.x", err)  # which --field takes
        self.run_tool("decode", path, "--field", "odometry.velocity.x", code=1)

    def test_a_byte_order_mark_is_passed_over(self):
        lines = '{"time_ns":"5000","bus":"can0","id":"608","data":"000000000000"}\n'
        log, _ = self.run_tool("encode", stdin=lines)
        for name in ("a.log", "a.csv", "a.asc", "a.jsonl"):
            path = os.path.join(self.folder, name)
            self.run_tool("encode", "-o", path, stdin=lines)
            with open(path, "rb") as file:
                content = file.read()
            with open(path, "wb") as file:
                file.write(b"\xef\xbb\xbf" + content)
            out, err = self.run_tool("decode", path)
            self.assertEqual(len(out.splitlines()), 1, name)
            self.assertNotIn("not of the expected form", err, name)
        # Another character that begins with the same byte is none, and stays.
        with open(path := os.path.join(self.folder, "b.log"), "w", encoding="utf-8") as file:
            file.write("\uff08(1.0) can0 608#000000000000\n(2.0) can0 608#000000000000\n")
        out, err = self.run_tool("decode", path)
        self.assertEqual(len(out.splitlines()), 1, out)
        self.assertIn("line 1: not of the expected form", err)
        self.assertEqual(self.run_tool("encode", stdin="\ufeff" + lines)[0], log)
        self.assertIn("608", self.run_tool("send", "--stdin", "--dry-run", stdin="\ufeff608#00\n")[0])

    def test_values_that_are_none(self):
        for line, what in [('{"id":"123","data":"11","fd":true}', '"fd" has no flags'),
                           ('{"id":"123","data":"11","fd":{"brs":5}}', '"fd" has no flags'),
                           ('{"topic":"motors","fields":null}', '"fields" is no object'),
                           ('{"topic":"motors","fields":{"x":true}}', 'field "x" has no value'),
                           ('{"topic":"motors","fields":{"x":0.1,"z":[1]}}', 'field "z" has no value'),
                           ('{"topic":"gyro","frame":"request","fields":{"mode":"once","period":1}}', "a period with mode once"),
                           ('{"topic":"motors","fields":{"x":5}}', "x takes -1 to 1 m/s\n          write a value in its range"),
                           ('{"id":"201","data":"0000000000000000","fields":{"x":5}}', "x takes -1 to 1 m/s\n          leave the field out"),
                           ('{"id":"123","data":"11"', "no JSON object in one line")]:
            _, err = self.run_tool("encode", stdin=line + "\n", code=1)
            self.assertIn("standard input:1: " if "x takes" not in what else "is out of range", err)
            self.assertIn(what, err)

    def test_what_is_appended_to_a_log_is_not_read_from_it(self):
        path = os.path.join(self.folder, "growing.log")
        with open(path, "w", encoding="ascii") as file:
            file.write(LOG)
        for words, verb in ((("decode", path), "decode"), (("decode", "--raw"), "decode"), (("replay", path, "--dry-run"), "replay"), (("line", path), "line")):
            with open(path, encoding="ascii") as source, open(path, "a", encoding="ascii") as sink:
                process = self.start(*words, stdin=source, stdout=sink)
                _, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 2, words)
            self.assertRegex(err, f"amiroctl: {verb}: (the standard input|{path}) and the standard output are the same file\n")
            with open(path, encoding="ascii") as file:
                self.assertEqual(file.read(), LOG)

    def test_encode_replaces_no_input_and_guesses_no_format(self):
        path = os.path.join(self.folder, "frames.jsonl")
        text = '{"id":"123","data":"11"}\n'
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        link = os.path.join(self.folder, "other.log")
        os.link(path, link)
        for out in (path, link):
            _, err = self.run_tool("encode", path, "-o", out, "--to", "candump", "--force", code=2)
            self.assertIn(f"encode: {path} and {out} are the same file\n", err)
        with open(path, encoding="utf-8") as file:
            self.assertEqual(file.read(), text)
        for name, what in [("m.foo", "the ending of m.foo is of no log format"), ("m.blf", "blf is read only")]:
            _, err = self.run_tool("encode", path, "-o", name, code=2)
            self.assertIn(f"encode: {what}\n          --to names a format: pcapng, ", err)
            self.assertFalse(os.path.exists(name))

    def test_bad_lines(self):
        lines = '{"id":"123","data":"11"}\n{"id":"123"}\n{"id":"124","data":"22"}\n'
        out, err = self.run_tool("encode", stdin=lines, code=1)
        self.assertIn("standard input:2: no data", err)
        self.assertEqual(out.split()[-1], "123#11")
        out, err = self.run_tool("encode", "--keep-going", stdin=lines, code=1)
        self.assertEqual(len(out.splitlines()), 2)
        _, err = self.run_tool("encode", "--to", "xml", code=2)
        self.assertIn("candump", err)
        _, err = self.run_tool("encode", "/nowhere.jsonl", code=1)
        self.assertIn("/nowhere.jsonl", err)

    def test_to_a_file_of_another_format(self):
        json_lines, _ = self.run_tool("decode", stdin=LOG)
        path = os.path.join(self.folder, "out.pcapng")
        self.run_tool("encode", "-o", path, stdin=json_lines)
        out, _ = self.run_tool("decode", path)
        self.assertEqual(out, json_lines)

    def test_what_comes_through_a_live_pipe_is_written_at_once(self):
        process = waiting.Program([AMIROCTL, "encode"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, bufsize=1)
        self._started.append(process)
        for data in ("11", "22", "33"):
            process.stdin.write(f'{{"time_ns":"1000000000","bus":"can0","id":"123","data":"{data}"}}\n')
            process.stdin.flush()
            self.assertEqual(process.stdout.readline(), f"(0000000001.000000) can0 123#{data}\n")
        self.interrupt(process)
        self.assertEqual(process.returncode, 130)


class Send(Case):
    def test_dry_run(self):
        lines = '605#01\n(1.5) can0 123#R\n{"topic":"motors","fields":{"x":0.05,"z":0.2}}\n'
        out, err = self.run_tool("send", "--stdin", "--dry-run", stdin=lines)
        self.assertEqual(out.split(), ["605#01", "123#R", "201#50C30000400D0300"])
        out, err = self.run_tool("send", "--stdin", "--dry-run", stdin=lines + "what\n", code=1)
        self.assertIn("standard input:4:", err)
        out, err = self.run_tool("send", "--stdin", "--dry-run", stdin=LOG)
        self.assertIn("608##10300FFFF00001122", out.split())
        self.assertIn("1 error frame left out, which only reports", err)
        self.run_tool("send", "--stdin", "605#01", code=2)
        self.run_tool("send", "--timed", "605#01", code=2)

    def test_a_line_without_a_time_follows_the_one_before(self):
        lines = ('605#01\n{"id":"605","data":"02"}\n(1700000000.000000) can0 605#03\n605#04\n{"id":"605","data":"05"}\n'
                 '{"time_ns":1700000000300000000,"id":"605","data":"06"}\n605#07\n')
        begin = time.monotonic()
        out, _ = self.run_tool("send", "--stdin", "--timed", "--dry-run", stdin=lines)
        self.assertEqual(out.split(), [f"605#0{i}" for i in range(1, 8)])
        self.assertGreaterEqual(time.monotonic() - begin, 0.3)

    def test_what_listen_prints_is_sent(self):
        self.start_sim()
        listener = self.listen("--commands", "--timeout", "20s")
        lines = "".join(line + "\n" for line in LOG.splitlines()[3:6])
        json_lines, _ = self.run_tool("decode", "-", "--from", "candump", stdin=lines)
        _, err = self.run_tool("send", "--stdin", "--timed", stdin=json_lines)
        self.assertIn("3 frames sent", err)
        self.settle()
        heard = self.objects(self.interrupt(listener)[0])
        heard = [line for line in heard if line["id"] in ("208", "201", "4FF")]
        sent = self.objects(json_lines)
        self.assertEqual([(line["id"], line["data"]) for line in heard], [(line["id"], line["data"]) for line in sent])
        times = [int(line["time_ns"]) for line in heard]
        self.assertGreaterEqual(times[2] - times[0], 950_000_000)  # 1 s in the log; how late the last comes is luck


if __name__ == "__main__":
    main()
