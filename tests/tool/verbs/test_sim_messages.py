"""amiroctl sim --spec: the messages of a DBC file play on the virtual bus, as declared, and what cannot is said."""

import json
import os
import re
import signal

from harness import Case, SOURCE, main

SPEC = os.path.join(SOURCE, "tests/sim/messages/bus.dbc")


class SimMessages(Case):
    def play(self, *arguments):
        sim = self.start("sim", "--spec", SPEC, *arguments)
        said = []
        for line in sim.stderr:
            said.append(line)
            if "Ctrl-C ends it" in line:
                return sim, "".join(said)
        self.fail("".join(said))

    def test_listen_shows_what_is_chosen(self):
        """The bus leaves out what is not looked at; what it cannot tell apart, the tool does."""
        car = os.path.join(SOURCE, "examples", "small_car.dbc")
        self.start_sim("--spec", car)
        for arguments, topics in ((("Engine",), {"Engine"}), (("--sender", "Brakes"), {"Wheels", "Driving"}),
                                  (("--filter", "100:7FF"), {"Engine"}), (("--filter", "100:7FF", "Wheels"), {"Engine", "Wheels"}),
                                  (("--where", "Engine.Speed>=0"), {"Engine"}),
                                  (("Wheels", "--where", "Engine.Speed>=0"), {"Wheels"})):
            out, err = self.run_tool("listen", "--spec", car, "--bus", "sim", "--json", "-n", "50", "--timeout", "25s", *arguments)
            self.assertEqual({event["topic"] for event in self.objects(out)}, topics, arguments)
            self.assertNotIn("unknown", err)

    def test_listen_and_stats_find_what_is_declared(self):
        sim, said = self.play("--seed", "7")
        self.assertIn("no period: Button", said)
        self.assertNotIn("Parts", said)
        out, _ = self.run_tool("listen", "--spec", SPEC, "--bus", "sim", "--json", "--timeout", "2s")
        rows = self.objects(out)
        text = json.dumps(rows)
        for name in ("Fast", "Pages", "Group", "Long", "Odd"):
            self.assertIn(f'"{name}"', text)
        self.assertNotIn('"Button"', text)
        parts = [row["message"] for row in rows if "message" in row]  # in several frames, a second apart
        self.assertEqual({part["topic"] for part in parts}, {"Parts"})
        out, _ = self.run_tool("stats", "--spec", SPEC, "--bus", "sim", "--json", "--duration", "3s",
                               "--bitrate", "500k")
        seen = {t["topic"]: t for t in json.loads(out)["buses"][0]["topics"]}
        for name, period in (("Fast", 10e6), ("Pages", 50e6), ("Group", 20e6)):
            self.assertEqual(seen[name]["period_ns"], period)
            late = self.spare.slack * 1e9  # of the first or the last one
            self.assertAlmostEqual(seen[name]["mean_ns"], period, delta=period / 50 + late / (seen[name]["count"] - 1))
            # A machine that pauses makes a gap, and all comes late; that none is left out is tests/sim/messages's to show.
            self.assertLessEqual(seen[name]["missing"], 3 if name == "Fast" else 1)
        _, err = self.interrupt(sim)
        self.assertRegex(err, r"Engine +sent \d+\n")
        self.assertNotIn("found the bus full", err)

    def test_messages_of_can_fd_are_played_decoded_and_set(self):
        self.play()
        out, _ = self.run_tool("listen", "--spec", SPEC, "--bus", "sim", "--json", "--timeout", "2s")
        rows = [row for row in self.objects(out) if "fd" in row]
        self.assertEqual({row["topic"] for row in rows}, {"Long", "Odd"})
        for row in rows:
            self.assertEqual(row["fd"], {"brs": row["topic"] == "Long", "esi": False})  # Odd: CANFD_BRS is 0
            self.assertEqual(len(row["data"]), 64 if row["topic"] == "Long" else 24)
        listener = self.listen("--spec", SPEC, "--timeout", "60s")
        _, err = self.run_tool("set", "--spec", SPEC, "--bus", "sim", "Odd", "End=77", "--every", "20ms", "--for", "200ms")
        # On a busy machine some turns are left out, and said.
        sent = 10 - sum(int(count) for count in re.findall(r"(\d+) frames? w(?:as|ere) not sent", err))
        self.assertGreaterEqual(sent + self.spare.slack / 0.02, 9)
        ours = []
        while len(ours) < min(9, sent):  # what was sent last is on its way to the listener
            row = json.loads(listener.stdout.readline())
            ours += [row] if row.get("fields", {}).get("End") == 77 else []
        self.interrupt(listener)
        self.assertEqual(ours[0]["data"], "00" * 9 + "4D" + "0000")
        self.assertEqual(ours[0]["fd"], {"brs": False, "esi": False})

    def test_the_bit_rate_of_data(self):
        _, said = self.play("--bitrate", "250000", "--data-bitrate", "1000000")
        self.assertIn("250000 bit/s", said)
        _, err = self.run_tool("sim", "--bus", "sim:" + os.path.join(self.folder, "s"), "--spec", SPEC, "--data-bitrate",
                               "750000", code=1)
        self.assertIn("750000 bit/s", err)
        self.assertIn("such as 2000000", err)

    def test_the_bit_rates_of_the_spec(self):
        """With the AMiRo's topics in it as well, which are at another bit rate there."""
        with open(os.path.join(SOURCE, "spec", "topics.json"), encoding="utf-8") as file:
            both = json.load(file)
        both["bus"] |= {"bit_rate": 250000, "data_bit_rate": 1000000}
        both["messages"] = [{"name": "Extra", "id": "0x7F0", "length": 1, "period": "20ms", "fields": []}]
        path = os.path.join(self.folder, "both.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(both, file)
        for arguments, rate in (((), 250000), (("--bitrate", "500000"), 500000)):
            sim = self.start("sim", "--spec", path, *arguments)
            said = next(line for line in sim.stderr if "Ctrl-C ends it" in line)
            self.assertIn("simulated AMiRo on --bus sim", said)
            self.assertIn(f", {rate} bit/s", said)
            self.interrupt(sim)
        _, err = self.run_tool("--spec", path, "--bus", "vcan77", "sim", code=2)
        self.assertIn("amiroctl: sim: a robot and messages with --bus vcan77\n          both play on a virtual bus only: leave --bus out, or one of "
                      "the specs\n", err)

    def test_a_closed_terminal_ends_it_as_ctrl_c_does(self):
        sim, _ = self.play()
        listener = self.listen("--spec", SPEC)
        _, err = self.interrupt(sim, signal.SIGHUP)
        self.assertEqual(sim.returncode, 128 + signal.SIGHUP)
        self.assertRegex(err, r"Engine +sent \d+\n")
        _, err = listener.communicate(timeout=30)
        self.assertIn("was ended", err)
        self.assertNotIn("crashed", err)

    def test_the_rest_of_the_bus_around_a_real_node(self):
        car = os.path.join(SOURCE, "examples", "small_car.dbc")
        sim = self.start("sim", "--spec", car, "--without", "EngineControl,Brakes")
        said = ""
        while "Ctrl-C ends it" not in said:
            said = sim.stderr.readline()
            if "switched off" in said:
                self.assertTrue(said.endswith("not sent, since switched off: Engine, Transmission, Wheels, Driving\n"), said)
        out, _ = self.run_tool("listen", "--spec", car, "--bus", "sim", "--json", "--timeout", "1500ms")
        heard = {event["topic"] for event in self.objects(out)}
        self.assertIn("Doors", heard)
        self.assertFalse(heard & {"Engine", "Transmission", "Wheels", "Driving"}, heard)
        self.interrupt(sim)
        _, err = self.run_tool("sim", "--spec", car, "--without", "EngineControll", code=2)
        self.assertIn("sim: no node 'EngineControll'", err)
        self.assertIn("did you mean 'EngineControl'?", err)
        _, err = self.run_tool("sim", "--spec", car, "--without", "EngineControl,Brakes,BodyControl,BatteryManager,Dashboard", code=2)
        self.assertIn("switch fewer nodes off", err)

    def test_sporadic_messages_on_request(self):
        _, said = self.play("--sporadic", "100ms")
        self.assertNotIn("Button", said)
        out, _ = self.run_tool("listen", "--spec", SPEC, "--bus", "sim", "--json", "--timeout", "2s")
        self.assertIn('"Button"', out)

    def test_without_any_period(self):
        path = os.path.join(self.folder, "none.dbc")
        with open(path, "w", encoding="ascii") as file:
            file.write('BU_: A\nBO_ 1 Alone: 1 A\n SG_ X : 0|8@1+ (1,0) [0|0] "" A\n')
        _, err = self.run_tool("sim", "--spec", path, code=2)
        self.assertIn("has a period that could be played", err)
        self.assertIn("--sporadic", err)

    def test_a_broken_spec_and_options_of_boards(self):
        path = os.path.join(self.folder, "broken.dbc")
        with open(path, "w", encoding="ascii") as file:
            file.write("BU_: A\nBO_ x Alone: 1 A\n")
        result = self.start("sim", "--spec", path)
        _, err = result.communicate(timeout=20)
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("broken.dbc", err)
        _, err = self.run_tool("sim", "--spec", SPEC, "--frozen", code=2)
        self.assertIn("--frozen with the messages of a spec", err)
        _, err = self.run_tool("sim", "--sporadic", "1s", code=2)
        self.assertIn("--sporadic without messages", err)


if __name__ == "__main__":
    main()
