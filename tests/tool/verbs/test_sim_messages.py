"""amiroctl sim --spec: the messages of a DBC file play on the virtual bus, as declared, and what cannot is said."""

import json
import os

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

    def test_listen_and_stats_find_what_is_declared(self):
        sim, said = self.play("--seed", "7")
        self.assertIn("no period: Button", said)
        self.assertIn("no classic CAN frame holds them: Long", said)
        out, _ = self.run_tool("listen", "--spec", SPEC, "--bus", "sim", "--json", "--timeout", "2s")
        rows = self.objects(out)
        text = json.dumps(rows)
        for name in ("Fast", "Pages", "Group"):
            self.assertIn(f'"{name}"', text)
        for name in ("Button", "Long"):
            self.assertNotIn(f'"{name}"', text)
        out, _ = self.run_tool("stats", "--spec", SPEC, "--bus", "sim", "--json", "--duration", "3s",
                               "--bitrate", "500k")
        seen = {t["topic"]: t for t in json.loads(out)["buses"][0]["topics"]}
        for name, period in (("Fast", 10e6), ("Pages", 50e6), ("Group", 20e6)):
            self.assertEqual(seen[name]["period_ns"], period)
            self.assertAlmostEqual(seen[name]["mean_ns"], period, delta=period / 50)
            self.assertEqual(seen[name]["missing"], 0)
        _, err = self.interrupt(sim)
        self.assertRegex(err, r"Engine +sent \d+\n")
        self.assertNotIn("found the bus full", err)

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
