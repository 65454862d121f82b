"""Specs for one interface only: --spec can0=car.dbc --spec can1=radar.dbc --spec robot.json."""

import json
import os

from harness import SOURCE, Case, main
from realtime import MOST_LATE

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
    # Who begins to drive listens for 150 ms to others, which repeat what they command each 100 ms.
    most_late = MOST_LATE

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

    def test_json_lines_are_read_by_the_catalogue_of_their_interface(self):
        """Else the identifier 100 of can1 and its topic would contradict each other."""
        events, _ = self.run_tool(*self.specs, "decode", "--json", stdin=LOG)
        self.assertEqual(self.run_tool(*self.specs, "decode", "--json", stdin=events)[0], events)

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
            self.assertEqual("none of the topics is on sim: of it error frames alone are recorded\n" in told, topics == ("Gear",), told)
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
        out, _ = self.run_tool(*self.specs, "stats", "--json", path)
        unknown, = (bus for bus in json.loads(out)["buses"] if bus["bus"] == "can2")
        self.assertEqual((unknown["bit_rate"], unknown["load_percent"], unknown["frames"]), (None, None, 2))
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

    def test_generate_is_about_no_interface(self):
        _, err = self.run_tool(*self.specs, "generate", "spec", code=2)
        self.assertIn("can0=" + self.path("car.dbc") + ": it is about one bus", err)

    def test_analyse_is_about_the_bus_that_is_chosen(self):
        _, err = self.run_tool(*self.specs, "analyse", "bus", code=2)
        self.assertIn("amiroctl: analyse bus: it is about one bus, and --spec names can0, can1", err)
        self.assertIn("--bus NAME", err)
        for bus, names, rate in (("can0", ["Engine", "Gear"], 500000), ("can1", ["Target", "Engine"], 250000)):
            out, _ = self.run_tool(*self.specs, "--bus", bus, "analyse", "bus", "--json", "--rates",
                                   *(f"{name}=10ms" for name in names))
            study = json.loads(out)
            self.assertEqual([message["name"] for message in study["messages"]], names)
            self.assertAlmostEqual(study["utilisation"], sum(message["bits"] for message in study["messages"]) / rate / 0.01, places=6)
        # The only one that is named needs no --bus; what is merged for all is there, too.
        out, _ = self.run_tool(*self.specs[:2], *self.robot, "analyse", "bus", "--json", "--rates", "Gear=10ms", "Lamp=20ms", "Engine=1s")
        self.assertEqual([message["name"] for message in json.loads(out)["messages"]], ["Engine", "Gear", "Lamp"])
        _, err = self.run_tool(*self.specs, "--bus", "can7", "analyse", "bus", code=2)
        self.assertIn("analyse bus: no --spec is for can7, only for can0, can1", err)
        self.assertIn("--spec can7=" + self.path("car.dbc") + ", or --bus can0", err)

    def test_sim_plays_the_bus_that_is_chosen(self):
        _, err = self.run_tool(*self.specs, "sim", code=2)
        self.assertIn("sim: it is about one bus, and --spec names can0, can1", err)
        _, err = self.run_tool(*self.specs, "--bus", "vcan7", "sim", code=2)
        self.assertIn("no --spec is for vcan7", err)
        # The virtual bus is the interface `sim`.
        self.start_sim("--spec", "can0=" + self.path("car.dbc"), "--spec", "sim=" + self.path("radar.dbc"), "--sporadic", "20ms")
        listener = self.start("listen", "--bus", "sim", "--spec", self.path("radar.dbc"), "--json", "-n", "20", "--timeout", "30s")
        events = self.objects(listener.communicate(timeout=60)[0])
        self.assertEqual({event.get("topic") for event in events}, {"Engine", "Target"})

    def test_sim_of_another_interface_says_where_it_plays(self):
        sim = self.start("sim", "--spec", "can0=" + self.path("car.dbc"), "--sporadic", "20ms")
        line = sim.stderr.readline()
        self.assertIn("what --spec has for can0 is played on the bus sim: for other verbs, --spec sim=" + self.path("car.dbc"), line)

    def test_a_log_stands_in_for_the_robot_of_its_interface(self):
        """An identifier that the robot's topic has on can0 is another's on can1."""
        self.start_sim("--without", "di_wheel_drive,light_ring,power_management")
        topics = os.path.join(SOURCE, "spec", "topics.json")
        with open(self.path("other.dbc"), "w", encoding="ascii") as file:
            file.write(HEAD + f'BO_ {0x608} Other: 8 Sender\n SG_ Value : 0|8@1+ (1,0) [0|0] "" Sender\n')
        with open(self.path("two.log"), "w", encoding="ascii") as file:
            for number in range(4):
                file.write(f"({1 + number / 10}) can1 608#FF0000000000\n({1 + number / 10}) can0 608#0{number}0000000000\n")
        robot = self.start("--spec", "can0=" + topics, "--spec", "can1=" + self.path("other.dbc"), "--bus", "sim",
                           "replay", self.path("two.log"), "--on-command")
        for line in robot.stderr:
            if "waiting for requests" in line:
                break
        self.assertIn("samples: 4 gyroscope;", line)
        self.run_tool("--bus", "sim", "once", "gyro", "--wait", "20s")  # ends well when its sample came
        self.interrupt(robot)
        for option in (("--interface", "can0=sim"), ("--dry-run",), ("--only", "sensors"), ("--loop",)):
            _, err = self.run_tool("replay", self.path("two.log"), "--on-command", *option, code=2)
            self.assertIn(f"replay: {option[0]} with --on-command", err)

    def test_of_two_robots_the_one_on_the_bus_is_commanded(self):
        """On can1 the identifier of this robot's motors is a lamp's, and other wheels have another."""
        topics = os.path.join(SOURCE, "spec", "topics.json")
        with open(topics, encoding="utf-8") as file:
            other = json.load(file)
        motors, = (topic for topic in other["topics"] if topic["name"] == "motors")
        other["topics"] = [motors | {"name": "wheels", "id": "0x70"}, {name: motors[name] for name in motors if name != "role"} | {"name": "lamp"}]
        with open(self.path("other.json"), "w", encoding="utf-8") as file:
            json.dump(other | {"robot": "Other", "namespace": "other"}, file)
        specs = ("--bus", "sim", "--spec", "sim=" + topics, "--spec", "can1=" + self.path("other.json"))
        self.start_sim()
        listener = self.listen("motors", "--commands", "--timeout", "60s")
        drive = self.start(*specs, "drive", "5cm/s")
        self.assertIn("50C3000000000000", listener.stdout.readline())
        for verb in (("drive", "-5cm/s"), ("behave", "avoid"), ("travel", "10cm")):
            _, err = self.run_tool(*specs, *verb, code=1)
            self.assertIn(f"amiroctl: {verb[0]}: another program commands motors: 201#50C3000000000000, ", err)
        self.interrupt(drive)
        self.run_tool(*specs, "set", "motors", "x=1cm/s")
        # A script, too: what is on can1 only is checked with --dry-run alone.
        with open(self.path("lamp.script"), "w", encoding="ascii") as file:
            file.write("0s set wheels x=0\n")
        _, err = self.run_tool(*specs, "run", self.path("lamp.script"), code=2)
        self.assertIn("wheels", err)
        self.run_tool(*specs[2:], "run", "--dry-run", self.path("lamp.script"))

    def test_words_that_are_no_spec(self):
        car = self.path("car.dbc")
        for word, what, remedy in (("can0=", "--spec can0=: no file behind the '='", "--spec can0=FILE"),
                                   ("=" + car, "no interface before the '='", "--spec can0=" + car),
                                   ("interface_of_seventeen=" + car, "'interface_of_seventeen' cannot be an interface", "1 to 15 characters"),
                                   ("a b=" + car, "'a b' cannot be an interface", "without blanks and '/'"),
                                   ("/tmp/a=" + car, "there is no such file, and '/tmp/a' cannot be an interface", "--spec can0=" + car)):
            for verb in (("list",), ("analyse", "bus"), ("sim",), ("decode",)):
                _, err = self.run_tool("--spec", word, *verb, code=2)
                self.assertIn(what, err)
                self.assertIn(remedy, err)
        self.run_tool("--spec", "interface_of_15=" + car, "list")
        self.run_tool("--spec", "slcan:/dev/ttyACM0@500k=" + car, "list")

    def test_a_serial_adapter_is_one_interface_whatever_its_rates(self):
        car = self.path("car.dbc")
        for interface in ("slcan:/dev/ttyACM0", "slcan:/dev/ttyACM0@500k"):
            specs = ("--spec", f"{interface}={car}", "--spec", "can0=" + self.path("radar.dbc"))
            for bus in ("slcan:/dev/ttyACM0", "slcan:/dev/ttyACM0@250k"):
                out, _ = self.run_tool(*specs, "--bus", bus, "set", "Gear", "Step=1", "--dry-run")
                self.assertEqual(out.strip()[:6], "101#01")
            self.assertEqual(self.meanings(specs=specs, stdin="(1.0) slcan:/dev/ttyACM0 101#0100000000000000\n"),
                             [("slcan:/dev/ttyACM0", "Gear")])

    def test_a_file_whose_name_has_an_equals_sign(self):
        with open(self.path("a=b.dbc"), "w", encoding="ascii") as file:
            file.write(CAR)
        self.assertIn("Gear", self.run_tool("--spec", self.path("a=b.dbc"), "list")[0])
        _, err = self.run_tool("--spec", "can0=" + self.path("none.dbc"), "list", code=1)
        self.assertIn("none.dbc: there is no such file", err)


if __name__ == "__main__":
    main()
