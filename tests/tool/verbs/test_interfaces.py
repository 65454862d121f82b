"""Specs for one interface only: --spec can0=car.dbc --spec can1=radar.dbc --spec robot.json."""

import json
import os

from harness import SOURCE, Case, main

HEAD = "BU_: Sender\n"
RATE = 'BA_DEF_ "Baudrate" INT 0 1000000;\nBA_DEF_DEF_ "Baudrate" 0;\nBA_ "Baudrate" {};\n'
# Both have the identifier 100 and a message Engine, and can1 has one identifier of its own.
CAR = HEAD + ('BO_ 256 Engine: 8 Sender\n SG_ Speed : 0|16@1+ (1,0) [0|0] "rpm" Sender\n'
              'BO_ 257 Gear: 8 Sender\n SG_ Step : 0|8@1+ (1,0) [0|0] "" Sender\n')
RADAR = HEAD + ('BO_ 256 Target: 8 Sender\n SG_ Distance : 0|8@1+ (1,0) [0|0] "m" Sender\n'
                'BO_ 259 Engine: 8 Sender\n SG_ Speed : 0|8@1+ (10,0) [0|0] "rpm" Sender\n')
LOG = "".join(f"({1 + number / 10}) {frame}\n" for number, frame in enumerate((
    "can0 100#0102000000000000", "can1 100#0500000000000000", "can0 101#0300000000000000", "can1 101#0300000000000000",
    "can1 103#0400000000000000", "can0 103#0400000000000000", "can2 100#0102000000000000", "can2 608#3E001E00FCFF")))


class Interfaces(Case):
    def setUp(self):
        super().setUp()
        for name, text in (("car.dbc", CAR + RATE.format(500000)), ("radar.dbc", RADAR + RATE.format(250000))):
            with open(self.path(name), "w", encoding="ascii") as file:
                file.write(text)
        self.specs = ("--spec", "can0=" + self.path("car.dbc"), "--spec", "can1=" + self.path("radar.dbc"))
        with open(self.path("robot.json"), "w", encoding="ascii") as file:
            json.dump({"robot": "robot", "messages": [
                {"name": "Lamp", "id": "0x608", "fields": [{"name": "Brightness", "byte": 0, "type": "u8"}]}]}, file)
        self.robot = ("--spec", self.path("robot.json"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def meanings(self, *arguments, specs=None, stdin=LOG):
        out, _ = self.run_tool(*(specs or self.specs), "decode", "--json", *arguments, stdin=stdin)
        return [(event["bus"], event.get("topic")) for event in self.objects(out)]

    MEANINGS = [("can0", "Engine"), ("can1", "Target"), ("can0", "Gear"), ("can1", None), ("can1", "Engine"), ("can0", None),
                ("can2", None)]

    def test_decode_finds_a_frame_in_the_catalogue_of_its_interface(self):
        self.assertEqual(self.meanings(), self.MEANINGS + [("can2", None)])
        # What is merged for all is there on each.
        self.assertEqual(self.meanings(specs=self.specs + self.robot), self.MEANINGS + [("can2", "Lamp")])
        self.assertEqual(self.meanings("--topic", "Engine"), [("can0", "Engine"), ("can1", "Engine")])
        self.assertEqual(self.meanings("--where", "Gear.Step=3"), [("can0", "Gear")])
        out, _ = self.run_tool(*self.specs, "decode", "--csv", "--field", "Engine.Speed", stdin=LOG)
        self.assertEqual([line.split(",")[1:] for line in out.splitlines()][1:], [["513", ""], ["", "40"]])
        out, _ = self.run_tool(*self.specs, "decode", "--pretty", stdin=LOG)
        self.assertIn("Target", out.splitlines()[1])
        self.assertIn("unknown", out.splitlines()[3])

    def test_conditions_on_a_field_of_several_interfaces(self):
        """Each has its own: Engine.Speed of can0 is 513, of can1 40, in the frames that come."""
        engines = [("can0", "Engine"), ("can1", "Engine")]
        self.assertEqual(self.meanings("--where", "Engine.Speed>0"), engines)
        self.assertEqual(self.meanings("--where", "Engine.Speed>100"), engines[:1])
        self.assertEqual(self.meanings("--where", "Engine.Speed<100"), engines[1:])
        # Gear on can0 is shown while it holds there, Target on can1 before it has held there; can2 has no such field.
        later = LOG + "(9.0) can1 100#0600000000000000\n(9.1) can0 101#0300000000000000\n(9.2) can2 100#00\n"
        choice = ("--topic", "Gear", "--topic", "Target", "--filter", "100:7FF")
        self.assertEqual(self.meanings(*choice, "--where", "Engine.Speed=513", stdin=later),
                         [("can0", "Engine"), ("can0", "Gear"), ("can2", None), ("can0", "Gear"), ("can2", None)])
        self.assertEqual(self.meanings(*choice, "--where", "Engine.Speed=40", stdin=later), [("can2", None), ("can1", "Target"), ("can2", None)])
        # A value that is none on one of them.
        with open(self.path("radar.dbc"), "a", encoding="ascii") as file:
            file.write('VAL_ 259 Speed 0 "stopped" ;\n')
        _, err = self.run_tool(*self.specs, "decode", "--where", "Engine.Speed=stopped", stdin=LOG, code=2)
        self.assertIn("'stopped' is no value of it on can0", err)

    def test_listen_has_the_condition_of_its_interface(self):
        self.start_sim()
        specs = ("--spec", "sim=" + self.path("radar.dbc"), "--spec", "can0=" + self.path("car.dbc"), "--bus", "sim")
        listener = self.start(*specs, "listen", "--json", "-n", "1", "--timeout", "30s", "--where", "Engine.Speed>40")
        self.assertIn("bus: sim", listener.stderr.readline())
        self.settle()
        self.run_tool(*specs, "set", "Engine", "Speed=40")
        self.run_tool(*specs, "set", "Engine", "Speed=50")
        event, = self.objects(listener.communicate(timeout=60)[0])
        self.assertEqual(event["fields"], {"Speed": 50})

    def test_replay_takes_topics_of_the_frame_s_interface(self):
        path = self.path("drive.log")
        with open(path, "w", encoding="ascii") as file:
            file.write(LOG)

        def played(*topics):
            out, err = self.run_tool(*self.specs, "replay", path, "--dry-run", *topics)
            return [tuple(line.split()[1:]) for line in out.splitlines()], err

        frames, err = played("Engine")
        self.assertEqual(frames, [("can0", "100#0102000000000000"), ("can1", "103#0400000000000000")])
        self.assertIn("6 not chosen", err)
        self.assertEqual(played("Target")[0], [("can1", "100#0500000000000000")])
        self.assertEqual(played("Gear")[0], [("can0", "101#0300000000000000")])
        self.assertEqual(len(played()[0]), 8)

    def test_record_takes_topics_of_its_interface(self):
        """100 is Target on the virtual bus, and Engine on can0 alone."""
        self.start_sim()
        specs = ("--spec", "sim=" + self.path("radar.dbc"), "--spec", "can0=" + self.path("car.dbc"), "--bus", "sim")
        for topics, taken in ((("Engine",), ["103#07"]), (("Target",), ["100#05"]), (("Gear",), []), (("Gear", "--filter", "100:7FF"), ["100#05"]), ((), ["100#05", "103#07", "18FF1234#01"])):
            path = self.path("_".join(word.strip("-").replace(":", "") for word in topics) + "record.log")
            recorder = self.start(*specs, "record", "-o", path, *topics)
            told = ""
            while "Ctrl-C ends" not in told:
                line = recorder.stderr.readline()
                self.assertTrue(line, told)
                told += line
            self.assertEqual("none of the topics is on sim" in told, topics == ("Gear",), told)
            self.settle()
            for frame in ("100#05", "103#07", "18FF1234#01"):
                self.run_tool(*specs, "send", frame)
            self.settle()
            self.interrupt(recorder)
            with open(path, encoding="ascii") as file:
                frames = [line.split()[2] for line in file]
            # Beside what was sent: the robot on the virtual bus refuses 103, for it is a request there.
            self.assertEqual([frame for frame in frames if not frame.startswith("71D")], taken, topics)

    def test_and_back(self):
        out, _ = self.run_tool(*self.specs, "decode", "--json", stdin=LOG)
        fields = "\n".join(json.dumps({key: event[key] for key in ("time_ns", "bus", "id", "fields")})
                           for event in self.objects(out) if "fields" in event)
        out, _ = self.run_tool(*self.specs, "encode", stdin=fields)
        self.assertEqual([line.split()[1:] for line in out.splitlines()],
                         [line.split()[1:] for line in LOG.splitlines()[:3] + LOG.splitlines()[4:5]])

    def test_stats_and_plot(self):
        path = self.path("drive.log")
        with open(path, "w", encoding="ascii") as file:
            file.write(LOG)
        _, err = self.run_tool(*self.specs, "stats", "--json", path, code=2)
        self.assertIn("stats: the spec says no bit rate of can2", err)
        with open(path, "w", encoding="ascii") as file:
            file.writelines(line + "\n" for line in LOG.splitlines()[:6])
        out, _ = self.run_tool(*self.specs, "stats", "--json", path)
        buses = {bus["bus"]: bus for bus in json.loads(out)["buses"]}
        self.assertEqual((buses["can0"]["bit_rate"], buses["can1"]["bit_rate"]), (500000, 250000))
        self.assertEqual([topic["topic"] for topic in buses["can0"]["topics"]], ["Engine", "Gear"])
        self.assertEqual([topic["topic"] for topic in buses["can1"]["topics"]], ["Target", "Engine"])
        self.assertEqual((buses["can0"]["unknown"], buses["can1"]["unknown"]), (1, 1))
        out, _ = self.run_tool(*self.specs, "plot", path, "Target.Distance", "--script")
        self.assertEqual([line.split()[-1] for line in out.splitlines() if line and line[0].isdigit()], ["5"], out)

    def test_set_and_listen_on_one_of_them(self):
        """The virtual bus is the interface `sim`."""
        self.start_sim()
        specs = ("--spec", "sim=" + self.path("radar.dbc"), "--spec", "can0=" + self.path("car.dbc"), "--bus", "sim")
        listener = self.start(*specs, "listen", "--json", "-n", "2", "--timeout", "30s", "--filter", "100:7FC")
        self.assertIn("bus: sim", listener.stderr.readline())
        self.settle()
        self.run_tool(*specs, "set", "Engine", "Speed=50")
        self.run_tool(*specs, "set", "Target", "Distance=7")
        events = self.objects(listener.communicate(timeout=60)[0])
        self.assertEqual([(event["id"], event["topic"], event["fields"]) for event in events],
                         [("103", "Engine", {"Speed": 50}), ("100", "Target", {"Distance": 7})])
        _, err = self.run_tool(*specs, "set", "Gear", "Step=1", code=2)
        self.assertIn("no topic 'Gear'", err)

    def test_list_and_info(self):
        out, _ = self.run_tool(*self.specs, "list", "--json")
        self.assertEqual([(line["topic"], line["bus"]) for line in self.objects(out)],
                         [("Engine", "can0"), ("Gear", "can0"), ("Target", "can1"), ("Engine", "can1")])
        out, _ = self.run_tool(*self.specs, "list")
        self.assertTrue(out.splitlines()[0].endswith("PERIOD  BUS") and out.splitlines()[3].endswith("  can1"), out)
        out, _ = self.run_tool(*self.specs, "info", "Engine")
        self.assertEqual([line.split()[1] for line in out.splitlines() if line.startswith("  bus ")], ["can0", "can1"])

    def test_conflicts_where_catalogues_meet(self):
        car = self.path("car.dbc")
        for second in (self.path("radar.dbc"), "can0=" + self.path("radar.dbc")):
            _, err = self.run_tool("--spec", "can0=" + car, "--spec", second, "list", code=1)
            self.assertIn("Target has the identifier 100 of Engine in car", err)
            self.assertIn("--spec can0=FILE", err)
            self.assertIn("a second Engine: car has a message of that name", err)
            self.assertIn("its bus has 250000 bit/s" if second.startswith("can0=") else "a second Engine", err)

    def test_the_same_file_twice(self):
        car = os.path.join(SOURCE, "examples", "small_car.dbc")
        _, err = self.run_tool("--spec", car, "--spec", os.path.join(SOURCE, "examples", ".", "small_car.dbc"), "list", code=2)
        self.assertIn("the same file as --spec", err)
        self.assertEqual(len(err.splitlines()), 2)
        self.run_tool("--spec", "can0=" + car, "--spec", "can1=" + car, "list")
        # A copy: the first conflicts, and how many more there are.
        with open(car, "rb") as file, open(self.path("copy.dbc"), "wb") as copy:
            copy.write(file.read())
        _, err = self.run_tool("--spec", car, "--spec", self.path("copy.dbc"), "list", code=1)
        self.assertIn("16 more conflicts with small_car\n          is it the same file", err)
        self.assertEqual(len(err.splitlines()), 14)

    def test_verbs_of_one_bus(self):
        for verb in (("generate", "spec"), ("sim",), ("analyse", "bus")):
            _, err = self.run_tool(*self.specs, *verb, code=2)
            self.assertIn("can0=" + self.path("car.dbc") + ": it is about one bus", err)

    def test_a_file_whose_name_has_an_equals_sign(self):
        with open(self.path("a=b.dbc"), "w", encoding="ascii") as file:
            file.write(CAR)
        self.assertIn("Gear", self.run_tool("--spec", self.path("a=b.dbc"), "list")[0])
        _, err = self.run_tool("--spec", "can0=" + self.path("none.dbc"), "list", code=1)
        self.assertIn("none.dbc: there is no such file", err)


if __name__ == "__main__":
    main()
