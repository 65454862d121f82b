"""amiroctl operate on plain messages: DBC files, J1939, several interfaces."""

import json
import os

from harness import SOURCE, main
from operate_cases import Operating

SMALL_CAR = os.path.join(SOURCE, "examples", "small_car.dbc")


CAR = {
    "name": "car", "initial": "watching", "fall_back": "alarm", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
    "configurations": [{"name": "watching", "streams": [{"topic": "Driving"}]},
                       {"name": "alarm", "streams": [{"topic": "Driving"}]}],
    "monitors": [{"name": "fast", "when": "Driving.Speed>50km/h"},
                 {"name": "silent", "when": {"age": "Driving", "above": "10s"}},
                 {"name": "slow", "when": "Driving.Speed<50km/h", "for": "100ms"}],
    "transitions": [{"from": "watching", "to": "alarm", "when": "fast"}, {"from": "watching", "to": "alarm", "when": "silent"},
                    {"from": "alarm", "to": "watching", "when": "slow"}],
}


class OfPlainMessages(Operating):
    """A bus without requests, of which a DBC file is known: messages come by themselves."""

    def test_the_messages_of_the_spec_count_in_the_proof(self):
        out, _ = self.run_tool("operate", self.write(CAR), "--check", "--json", "--spec", SMALL_CAR)
        watching = json.loads(out)["configurations"][0]
        periods = {each["topic"]: each["period_ns"] for each in watching["others"]}
        self.assertEqual((periods["Engine"], periods["Trip"]), (10_000_000, 500_000_000))
        self.assertNotIn("Driving", periods)      # a stream of its own
        self.assertIsNone(watching["streams"][0]["on_board_ns"])  # of its board nothing is known
        self.assertEqual(json.loads(out)["sampling_not_counted"], ["Driving"])
        table, _ = self.run_tool("operate", self.write(CAR), "--check", "--spec", SMALL_CAR)
        self.assertIn("NOT COUNTED, as the tasks of its board are not known: the sampling of Driving\n", table)
        self.assertNotIn("recoveries", table)  # nothing is asked for
        self.assertNotIn("LockCommand", periods)  # sent on events
        self.assertGreater(watching["streams"][0]["response_ns"], 2 * 130_000)  # Engine, Transmission and Wheels go first

    def test_a_field_that_only_some_frames_have_is_no_condition(self):
        """Its condition would be unknown at each other frame, and the bound that is proved would be too short."""
        path = self.write(of_field("Service.FaultCode", "10", "10"))
        _, err = self.run_tool("operate", path, "--check", "--spec", SMALL_CAR, code=1)
        self.assertIn('"Service.FaultCode" is in some frames of Service only: when it comes is not known\n'
                      "          a field that is in all of them\n", err)
        self.write(of_field("Service.Page", "1", "1"))
        self.run_tool("operate", path, "--check", "--spec", SMALL_CAR)

    def test_it_follows_what_they_say_and_sends_nothing(self):
        self.start_sim()  # a bus on which nothing comes by itself
        listener = self.listen()
        car = self.start("set", "Driving", "Speed=30km/h", "--every", "20ms", "--spec", SMALL_CAR)
        document = CAR | {"monitors": [*CAR["monitors"][:2], CAR["monitors"][2] | {"when": {"not": "Driving.Speed>50km/h"}}]}
        operator = self.start("operate", self.write(document), "--json", "--spec", SMALL_CAR)
        self.assertEqual(self.event(operator)["event"], "started")
        self.interrupt(car)
        car = self.start("set", "Driving", "Speed=70km/h", "--every", "20ms", "--spec", SMALL_CAR)
        event = self.event(operator, "switched")
        self.assertEqual(event["to"], "alarm")
        self.assertEqual(event["conditions"], ["Driving.Speed>50km/h"])
        self.interrupt(car)
        car = self.start("set", "Driving", "Speed=30km/h", "--every", "20ms", "--spec", SMALL_CAR)
        event = self.event(operator, "switched")
        self.assertEqual((event["from"], event["to"], event["cause"]), ("alarm", "watching", "slow"))
        self.assertEqual(event["conditions"], ["not Driving.Speed>50km/h"])
        _, err = self.interrupt(car)  # silence
        self.assertRegex(err, r"set: operator car \(process [0-9]+\) watches the bus; messages do not go through it\n")
        self.assertEqual(self.event(operator, "switched")["conditions"], ["age of Driving above 10s"])
        _, err = self.interrupt(operator)
        self.assertEqual(operator.returncode, 130)
        self.assertIn("3 changes, 0 frames sent", err)
        out, _ = self.interrupt(listener)
        self.assertEqual({json.loads(line)["id"] for line in out.splitlines()}, {"130"})


def of_field(field, low, high):
    """CAR with this field above `high` as the event, and below `low` as its end."""
    text = json.dumps(CAR).replace("Driving.Speed>50km/h", f"{field}>{high}").replace("Driving.Speed<50km/h", f"{field}<{low}")
    text = text.replace('"10s"', '"60s"').replace('"Driving"', json.dumps(field.split(".")[0]))
    return json.loads(text) | {"settle": "400ms"}


TRUCK = os.path.join(SOURCE, "examples", "truck.dbc")
# A group of twelve bytes, of which no frame has all.


LONG = """BU_: Trailer
BO_ 2566843646 Cargo: 12 Trailer
 SG_ First : 0|16@1+ (1,0) [0|0] "kg" Trailer
 SG_ Last : 80|16@1+ (1,0) [0|0] "kg" Trailer
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "VFrameFormat" "J1939PG";
BA_DEF_DEF_ "GenMsgCycleTime" 1000;
"""


class OfJ1939(Operating):
    """A message is known by its parameter group: whatever priority, source and destination its frames have, and in one frame or several."""

    def send(self, *frames):
        self.run_tool("send", "--stdin", stdin="".join(frame + "\n" for frame in frames))

    def send_for_a_second(self, *frames):
        """Every 20 ms: a value is not known once its stream has been silent for three periods, nor is there a change before the last is over."""
        lines = (f"({0.02 * index:.6f}) can0 {frame}\n" for index in range(50) for frame in frames)
        self.run_tool("send", "--stdin", "--timed", stdin="".join(lines))

    def test_a_parameter_group_of_any_priority_and_source(self):
        self.start_sim()
        operator = self.start("operate", self.write(of_field("EEC1.EngineSpeed", "2500rpm", "2500rpm")), "--json", "--spec", TRUCK)
        self.assertEqual(self.event(operator)["event"], "started")
        fast, above, slow = "FFFFFF204EFFFFFF", "FFFFFF214EFFFFFF", "FFFFFF1027FFFFFF"  # 20000, 20001 and 10000 eighths of a rpm
        self.send_for_a_second("0CF00400#" + fast, "18F00500#" + above, "004#" + above)  # as fast as that, another group, another format
        status = json.loads(self.run_tool("operator", "status", "--json")[0])
        self.assertEqual((status["configuration"], status["streams"][0]["topic"]), ("watching", "EEC1"))
        self.send_for_a_second("18F00421#" + above)
        event = self.event(operator, "switched")
        self.assertEqual((event["to"], event["conditions"]), ("alarm", ["EEC1.EngineSpeed>2500rpm"]))
        self.send_for_a_second("00F004F9#" + slow)
        self.assertEqual(self.event(operator, "switched")["to"], "watching")
        _, err = self.interrupt(operator)
        self.assertIn("2 changes, 0 frames sent", err)

    def test_a_message_that_comes_in_several_frames(self):
        self.start_sim()
        spec = self.write(LONG, "long.dbc")
        document = of_field("Cargo.Last", "500kg", "500kg")
        operator = self.start("operate", self.write(document), "--json", "--spec", spec, "--bitrate", "250k")
        self.assertEqual(self.event(operator)["event"], "started")

        def broadcast(last, packets=2):  # BAM of 12 bytes and its packets [SAE J1939-21]
            data = (bytes(10) + last.to_bytes(2, "little")).ljust(14, b"\xff")
            self.send("1CECFF21#200C0002FFECFE00",
                      *(f"1CEBFF21#{n + 1:02X}{data[7 * n:7 * n + 7].hex().upper()}" for n in range(packets)))

        broadcast(501, packets=1)  # not at its end
        broadcast(501)
        event = self.event(operator, "switched")
        self.assertEqual((event["to"], event["conditions"]), ("alarm", ["Cargo.Last>500kg"]))
        broadcast(499)
        self.assertEqual(self.event(operator, "switched")["to"], "watching")
        self.interrupt(operator)

    def test_groups_count_in_the_proof(self):
        document = of_field("EEC1.EngineSpeed", "2500rpm", "2500rpm")
        study = json.loads(self.run_tool("operate", self.write(document), "--check", "--json", "--spec", TRUCK)[0])
        watching = study["configurations"][0]
        self.assertEqual({each["topic"]: each["period_ns"] for each in watching["others"]},
                         {"TSC1": 50_000_000, "CCVS1": 100_000_000, "ET1": 1_000_000_000, "LFE1": 100_000_000, "TrailerService": 500_000_000})
        # At 250 kbit/s with 29 bits: behind TSC1 of a higher priority and one of a lower that had begun, 640 us each with all stuff bits.
        self.assertEqual(watching["streams"][0]["response_ns"], 3 * 640_000)
        twice = json.loads(self.run_tool("operate", self.write(document), "--check", "--json", "--spec", TRUCK, "--bitrate", "500k")[0])
        self.assertEqual(twice["configurations"][0]["streams"][0]["response_ns"], 3 * 320_000)


class OfAnInterface(Operating):
    """--spec can0=FILE: an operator is about one bus, and of specs for interfaces that of its bus counts."""

    def test_the_spec_of_the_bus_is_the_one_that_counts(self):
        car, truck = self.write(CAR, "car.operator.json"), self.write(of_field("EEC1.EngineSpeed", "2500rpm", "2500rpm"))
        both = ("--spec", f"can0={SMALL_CAR}", "--spec", f"can1={TRUCK}")
        for words in ((car, "--spec", f"can0={SMALL_CAR}"), (car, *both, "--bus", "can0")):
            study = json.loads(self.run_tool("operate", *words, "--check", "--json")[0])
            self.assertEqual(study["sampling_not_counted"], ["Driving"], words)
            self.assertIn("Engine", [each["topic"] for each in study["configurations"][0]["others"]])
        study = json.loads(self.run_tool("operate", truck, *both, "--bus", "can1", "--check", "--json")[0])
        self.assertEqual(study["sampling_not_counted"], ["EEC1"])
        self.assertNotIn("Engine", [each["topic"] for each in study["configurations"][0]["others"]])
        _, err = self.run_tool("operate", car, *both, "--bus", "can1", "--check", code=1)
        self.assertIn('/configurations/0/streams/0/topic: there is no topic "Driving"', err)

    def test_which_bus_must_be_said(self):
        path = self.write(CAR)
        for words, expected in ((("--spec", f"can0={SMALL_CAR}", "--spec", f"can1={TRUCK}"),
                                 "operate: it is about one bus, and --spec names can0, can1\n          choose one with --bus NAME"),
                                (("--spec", f"can0={SMALL_CAR}", "--bus", "can1"),
                                 f"operate: no --spec is for can1, only for can0\n          --spec can1={SMALL_CAR}, or --bus can0")):
            for check in (("--check",), ()):
                _, err = self.run_tool("operate", path, *words, *check, code=2)
                self.assertIn(expected, err)
        _, err = self.run_tool("operate", path, "--check", "--spec", f"can0={SMALL_CAR}", "--spec", TRUCK, code=1)
        self.assertIn(f"{TRUCK}: its bus has 250000 bit/s, that of small_car 500000", err)

    def test_it_runs_on_its_bus_with_its_spec(self):
        self.start_sim()
        operator = self.start("operate", self.write(CAR), "--json", "--bus", "sim", "--spec", f"can0={TRUCK}", "--spec", f"sim={SMALL_CAR}")
        self.assertEqual(self.event(operator)["event"], "started")
        car = self.start("set", "Driving", "Speed=70km/h", "--every", "20ms", "--spec", SMALL_CAR)
        event = self.event(operator, "switched")
        self.assertEqual((event["to"], event["conditions"]), ("alarm", ["Driving.Speed>50km/h"]))
        self.interrupt(car)
        _, err = self.interrupt(operator)
        self.assertIn("1 change, 0 frames sent", err)


if __name__ == "__main__":
    main()
