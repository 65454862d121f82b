"""amiroctl set with the messages of a DBC file: what arrives is what was meant, at its time."""

import json
import os
import re
import signal
import time

from harness import Case, main

CAR = os.path.join(os.environ["OCM_SOURCE_DIR"], "examples", "small_car.dbc")


class Set(Case):
    def listening(self, *arguments):
        listener = self.start("--spec", CAR, "listen", "--json", "--timeout", "60s", *arguments)
        self.assertIn("bus: sim", listener.stderr.readline())
        self.settle()  # it is subscribed
        return listener

    def heard(self, listener):
        self.settle()  # what was sent last is on its way to it
        out, _ = self.interrupt(listener)
        return [json.loads(line) for line in out.splitlines()]

    def test_a_message_arrives_with_its_values(self):
        self.start_sim()
        listener = self.listening("-n", "1")
        self.run_tool("--spec", CAR, "set", "Engine", "Speed=2500", "Torque=-20.5Nm", "Running=1")
        out, _ = listener.communicate(timeout=30)
        heard = json.loads(out)
        self.assertEqual((heard["id"], heard["topic"]), ("100", "Engine"))
        self.assertEqual((heard["fields"]["Speed"], heard["fields"]["Torque"], heard["fields"]["Running"]),
                         (2500, -20.5, 1))

    def test_again_and_again_at_its_times(self):
        self.start_sim()
        listener = self.listening()
        started = time.monotonic()
        _, err = self.run_tool("--spec", CAR, "set", "Engine", "Speed=1000", "--every", "10ms", "--for", "1s")
        self.assertGreaterEqual(time.monotonic() - started, 1.0)
        times = [int(line["time_ns"]) for line in self.heard(listener)]
        # At 0, 10, ... 990 ms; on a busy machine some turns are left out, and said.
        left_out = sum(int(count) for count in re.findall(r"(\d+) frames? w(?:as|ere) not sent", err))
        self.assertEqual(len(times) + left_out, 100, err)
        self.assertGreater(len(times), 50)
        # No drift: the last one is near to its turn, whatever came between; turns at the end may be left out.
        lasted = (times[-1] - times[0]) / 1e9
        self.assertLess(lasted, 0.99 + 0.2 + self.spare.slack, err)
        self.assertGreater(lasted, 0.99 - 0.2 - 0.01 * left_out - self.spare.slack, err)

    def test_without_an_end_until_it_is_interrupted(self):
        self.start_sim()
        listener = self.listening("-n", "3")
        sender = self.start("--spec", CAR, "set", "Lights", "Beam=1", "--every", "20ms")
        listener.communicate(timeout=30)
        self.interrupt(sender)
        self.assertEqual(sender.returncode, 130)

    def test_several_at_once_in_a_script_and_each_replaces_its_own(self):
        self.start_sim()
        script = os.path.join(self.folder, "several.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s set Engine Speed=1000 --every 20ms --for 600ms\n"
                       "0s set Lights Beam=1 --every 50ms\n"
                       "300ms set Engine Speed=2000 --every 20ms --for 300ms\n"
                       "500ms set Lights Beam=0\n")
        listener = self.listening()
        _, err = self.run_tool("--spec", CAR, "run", script)
        lines = self.heard(listener)
        speeds = [line["fields"]["Speed"] for line in lines if line["topic"] == "Engine"]
        self.assertEqual(speeds, sorted(speeds))  # none of the old ones after the new
        left_out = sum(int(count) for count in re.findall(r"(\d+) frames? w(?:as|ere) not sent", err))
        # 15 turns each, and one that is due together with the line that replaces it; fewer where some are left out. On a
        # busy machine that line comes late, and the first goes on, at most for its own 600 ms.
        for speed, most in ((1000, 31), (2000, 16)):
            self.assertGreaterEqual(speeds.count(speed), 15 - left_out, err)
            self.assertLessEqual(speeds.count(speed), most, err)
        beams = [line["data"] for line in lines if line["topic"] == "Lights"]
        self.assertEqual(set(beams), {"0100", "0000"})
        self.assertEqual(beams.index("0000"), len(beams) - 1)  # once, and last

    def test_an_interrupted_script_says_what_it_leaves(self):
        """Of a bus without motors nothing is said of motors; what was sent last holds there."""
        self.start_sim()
        for text, said, left in (("0s set Engine Speed=1000 --every 20ms\n", "run: Engine is sent until Ctrl-C; --for ends that",
                                  "interrupted: Engine is no longer sent, and what was sent last holds\n"),
                                 ("0s set Engine Speed=1000 --every 20ms\n0s set Lights Beam=1 --every 20ms\n"
                                  "0s set Engine Speed=0\n0s set Engine Speed=1 --every 50ms\n",
                                  "run: Lights, Engine are sent until Ctrl-C; --for ends that",
                                  "interrupted: Lights, Engine are no longer sent, and what was sent last holds\n"),
                                 ("0s set Lights Beam=1 --every 20ms --for 60s\n", "0s  set Lights", "interrupted\n")):
            sender = self.start("--spec", CAR, "run", self.script(text))
            lines = []
            while said not in (lines[-1] if lines else ""):
                lines.append(sender.stderr.readline())
                self.assertTrue(lines[-1], lines)
            _, err = self.interrupt(sender)
            self.assertEqual(sender.returncode, 130)
            self.assertTrue(err.endswith(left), err)
            self.assertNotIn("motors", err)

    def test_a_bus_that_goes_ends_it_in_words(self):
        sim = self.start_sim()
        listener = self.listening("-n", "3")
        sender = self.start("--spec", CAR, "set", "Engine", "Speed=1", "--every", "20ms")
        listener.communicate(timeout=30)
        self.interrupt(sim)
        _, err = sender.communicate(timeout=30)
        self.assertEqual(sender.returncode, 1, err)
        self.assertRegex(err, r"amiroctl: .+\n")

    def test_what_a_stopped_bus_did_not_take_is_counted_before_the_error(self):
        sim = self.start_sim()
        listener = self.listening("-n", "3")
        sender = self.start("--spec", CAR, "set", "Engine", "Speed=1", "--every", "20ms")
        listener.communicate(timeout=30)
        sim.send_signal(signal.SIGSTOP)
        try:
            _, err = sender.communicate(timeout=30)
        finally:
            sim.send_signal(signal.SIGCONT)
        self.assertEqual(sender.returncode, 1, err)
        self.assertRegex(err, r"set: \d+ frames? w(?:as|ere) not sent, because sim had not taken those before\n"
                              r"amiroctl: set: sim has taken no frame for .+\n")

    def test_a_message_of_several_frames_is_broadcast(self):
        """And another value while one is under way waits until that one is whole."""
        spec = os.path.join(os.environ["OCM_SOURCE_DIR"], "tests/sim/messages/bus.dbc")
        self.start_sim()
        listener = self.start("--spec", spec, "listen", "--json", "--timeout", "60s")
        self.assertIn("bus: sim", listener.stderr.readline())
        self.settle()  # it is subscribed
        self.run_tool("--spec", spec, "set", "Parts", "Part=7")
        out, _ = self.run_tool("--spec", spec, "set", "Parts", "Part=7", "--dry-run")
        frames = ["1CECFFFE#20140003FFECFE00", "1CEBFFFE#0107000000000000", "1CEBFFFE#0200000000000000",
                  "1CEBFFFE#03000000000000FF"]
        self.assertEqual(out.split(), frames)
        script = self.script("0s set Parts Part=1\n100ms set Parts Part=2 --every 200ms --for 400ms\n")
        self.run_tool("--spec", spec, "run", script)
        self.settle()  # what was sent last is on its way to it
        out, err = self.interrupt(listener)
        rows = [json.loads(line) for line in out.splitlines()]
        self.assertEqual([row["id"] + "#" + row["data"] for row in rows[:4]], frames)
        values = [row["message"]["fields"]["Part"] for row in rows if "message" in row]
        self.assertEqual(values[:3], [7, 1, 2])
        self.assertRegex(err, r"\d messages put together, \d+ other frames\n")

    def test_a_broadcast_that_is_cut_off_says_so(self):
        spec = os.path.join(os.environ["OCM_SOURCE_DIR"], "tests/sim/messages/bus.dbc")
        self.start_sim()
        listener = self.start("--spec", spec, "listen", "--json", "-n", "2", "--timeout", "20s")
        self.assertIn("bus: sim", listener.stderr.readline())
        sender = self.start("--spec", spec, "set", "Parts", "--every", "200ms")
        listener.communicate(timeout=30)
        sender.send_signal(signal.SIGHUP)
        _, err = sender.communicate(timeout=30)
        self.assertEqual(sender.returncode, 128 + signal.SIGHUP)
        self.assertIn(err.partition("\n")[2], ("set: Parts was not sent to its end\n", ""))  # or behind its last frame
        _, err = self.run_tool("--spec", spec, "set", "Parts", "--every", "100ms", code=2)
        self.assertIn("--every 100ms is shorter than a broadcast of Parts takes", err)

    def messages_of_a_node(self):
        """A spec with messages of source 00: two of four frames, the first of which every 200 ms, and one of 256."""
        path = f"{self.folder}/node.dbc"
        with open(path, "w", encoding="utf-8") as file:
            file.write('BU_: N\nBO_ 2566838528 Parts: 20 N\n SG_ Part : 0|8@1+ (1,0) [0|0] "" N\n'
                       'BO_ 2566838784 Others: 20 N\n SG_ Other : 0|8@1+ (1,0) [0|0] "" N\n'
                       'BO_ 2566839040 Long: 1785 N\n SG_ Byte : 0|8@1+ (1,0) [0|0] "" N\n'
                       'BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";\n'
                       'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\nBA_DEF_DEF_ "VFrameFormat" "J1939PG";\n'
                       'BA_DEF_DEF_ "GenMsgCycleTime" 0;\nBA_ "GenMsgCycleTime" BO_ 2566838528 200;\n')
        return path

    def test_another_node_that_broadcasts_from_the_same_source_is_reported(self):
        """The simulator plays it, in at least a third of the time."""
        spec = self.messages_of_a_node()
        self.start_sim("--spec", spec)
        _, err = self.run_tool("--spec", spec, "set", "Others", "--every", "300ms", "--for", "3s", code=1)
        self.assertIn("set: another node broadcasts from source 00 during Others, so listeners may drop both\n", err)
        self.assertRegex(err, r"\nset: \d+ broadcasts met others of the same source\n")

    def test_a_broadcast_that_waited_for_its_source_is_named(self):
        spec = self.messages_of_a_node()
        self.start_sim()
        process = self.start("--spec", spec, "run", self.script("0s set Long\n0s set Parts\n0s set Others --every 1s\n"))
        while "set Others" not in process.stderr.readline():
            pass
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130)
        self.assertIn("run: Long was not sent to its end\nrun: Parts was not sent\n", err)

    def test_beyond_its_range(self):
        _, err = self.run_tool("--spec", CAR, "set", "Engine", "Speed=9000", "--dry-run", code=2)
        self.assertEqual(err, "amiroctl: set: '9000' is beyond the stated range: Speed takes 0 to 8000 rpm\n"
                              "          many stated ranges are wrong: --force takes what the bits can hold\n")
        out, _ = self.run_tool("--spec", CAR, "set", "Engine", "Speed=9000", "--dry-run", "--force")
        self.assertTrue(out.startswith("100#A08C"), out)  # 36000 quarters
        _, err = self.run_tool("--spec", CAR, "set", "Engine", "Speed=1", "--for", "1s", code=2)
        self.assertIn("--every", err)


if __name__ == "__main__":
    main()
