"""amiroctl operate: operator files, what is wrong with them, what is proved of them, and what happens when they run."""

import configparser
import json
import os
import random
import re
import resource
import shutil
import signal
import socket
import subprocess
import time
import unittest
import xml.etree.ElementTree

from harness import AMIROCTL, SOURCE, Case, main, waiting
from played_adapter import NOT_SCHEDULABLE, WithAdapter, refusal

GUARD = os.path.join(SOURCE, "examples", "guard.operator.json")


def guard():
    with open(GUARD, encoding="utf-8") as file:
        return json.load(file)


class Operate(Case):
    def write(self, document, name="test.operator.json"):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(document if isinstance(document, str) else json.dumps(document, indent=1))
        return path

    def refused(self, change, *expected, code=1, document=None):
        """What is wrong once `change` was made to the guard: each text, and the line of a place in the file."""
        document = guard() if document is None else document
        change(document)
        path = self.write(document)
        _, err = self.run_tool("operate", path, "--check", code=code)
        for text in expected:
            self.assertIn(text, err)
        self.assertRegex(err, r"test\.operator\.json:\d+")
        return err

    def line_of(self, text, document):
        return next(i for i, line in enumerate(json.dumps(document, indent=1).splitlines(), 1) if text in line)


class Checked(Operate):
    def test_the_example_is_in_time_and_every_sum_is_that_of_its_parts(self):
        out, err = self.run_tool("operate", GUARD, "--check", "--json")
        self.assertEqual(err, "")
        study = json.loads(out)
        self.assertTrue(study["in_time"])
        self.assertEqual([each["name"] for each in study["configurations"]], ["idle", "driving", "stopped"])
        for reaction in study["reactions"]:
            self.assertEqual(reaction["at_most_ns"], sum(reaction["parts_ns"].values()), reaction)
            for each in reaction.get("conditions", []):
                self.assertEqual(each["at_most_ns"], sum(each["parts_ns"].values()), each)
            if "conditions" in reaction:
                self.assertEqual(reaction["at_most_ns"], max(each["at_most_ns"] for each in reaction["conditions"]))
        for change in study["changes"]:
            self.assertLessEqual(change["over_after_ns"], study["settle_ns"])
        near = next(r for r in study["reactions"] if r["cause"] == "obstacle")
        self.assertEqual(near["condition"], "age of ring above 250ms")
        sensor = next(c for c in near["conditions"] if c["condition"] == "ring.sensor_4>3000")
        self.assertEqual(sensor["parts_ns"]["period"], 50_000_000)
        self.assertEqual(sensor["parts_ns"]["jitter"], 1_000_000)
        ring = study["configurations"][1]["streams"][0]
        self.assertEqual(sensor["parts_ns"]["sampling"], ring["on_board_ns"])
        self.assertEqual(ring["response_ns"], sum(sensor["parts_ns"][part] for part in ("jitter", "sampling", "bus")))
        self.assertEqual(study["sampling_not_counted"], [])

    def test_a_table_for_people_shows_the_sums(self):
        out, _ = self.run_tool("operate", GUARD, "--check")
        self.assertIn("operator guard: 3 configurations, 4 monitors, 8 transitions, at 500000 bit/s", out)
        self.assertRegex(out, r"ring\.sensor_4>3000\n +[0-9.]+ ms = 50 period \+ 1 jitter \+ 21.742 sampling \+ [0-9.]+ bus \+ 5 reading \+ ")
        self.assertIn("[Real, Crespo 2004", out)
        self.assertTrue(out.endswith("\nin time\n"))

    def test_a_slower_bus_is_not_in_time_and_says_why_with_a_place(self):
        out, err = self.run_tool("operate", GUARD, "--check", "--bitrate", "50k", code=1)
        self.assertIn("NOT IN TIME", out)
        with open(GUARD, encoding="utf-8") as file:
            document = file.read().splitlines()
        settle = next(i for i, line in enumerate(document, 1) if '"settle"' in line)
        self.assertIn(f"guard.operator.json:{settle}: /settle: the change", err)
        self.assertRegex(err, r'"settle": "\d+ms" or longer')
        longer = guard()
        longer["settle"] = "400ms"
        for monitor in longer["monitors"]:
            if monitor["name"] == "obstacle":
                monitor["when"]["any"][-1]["above"] = "2s"
        longer["configurations"][1]["streams"][0]["period"] = "200ms"
        longer["configurations"][1]["streams"][1]["period"] = "200ms"
        longer["configurations"][2]["streams"][0]["period"] = "200ms"
        _, err = self.run_tool("operate", self.write(longer), "--check", "--bitrate", "50k", code=1)
        self.assertNotIn("/settle", err)
        self.assertIn("its deadline is 50 ms", err)

    def test_a_healthy_stream_that_reaches_an_age_is_restless(self):
        def change(document):
            document["monitors"][0]["when"]["any"][-1]["above"] = "51ms"
        err = self.refused(change, "in \"driving\" the samples of proximity_ring may be", "holds although nothing is wrong",
                           "\"above\": \"")
        least = max(map(int, re.findall(r'"above": "(\d+)ms"', err)))  # of all configurations with the ring

        def mended(document):
            document["monitors"][0]["when"]["any"][-1]["above"] = f"{least}ms"
        document = guard()
        mended(document)
        self.run_tool("operate", self.write(document), "--check")

    def test_values_that_go_stale_at_the_longest_period_of_an_adaptation(self):
        def change(document):
            document["configurations"][1]["streams"][0]["adapt"] = {
                "field": "odometry.velocity.x", "from": "0m/s", "to": "0.1m/s", "at_from": "250ms", "at_to": "50ms"}
        self.refused(change, "go stale after three periods", "\"at_from\" and \"at_to\" nearer to each other")

    def test_what_others_send_counts(self):
        alone = json.loads(self.run_tool("operate", GUARD, "--check", "--json")[0])
        document = guard()
        document["others"] = [{"topic": "gyro", "period": "5ms", "priority": "high"}, {"topic": "motors", "period": "100ms"}]
        among = json.loads(self.run_tool("operate", self.write(document), "--check", "--json")[0])
        for before, after in zip(alone["configurations"], among["configurations"]):
            self.assertGreater(after["load_per_mille"], before["load_per_mille"])


    def test_what_a_board_cannot_serve_is_an_error_with_its_place(self):
        study = json.loads(self.run_tool("operate", GUARD, "--check", "--json")[0])
        ring, odometry, power = study["configurations"][1]["streams"]
        self.assertGreater(ring["on_board_ns"], 8_000_000)  # the measured cost of a sample alone
        self.assertLess(odometry["on_board_ns"], 1_000_000)
        self.assertGreater(power["on_board_ns"], ring["on_board_ns"])  # it waits for the ring, on the same board

        def too_often(document):  # on the bus eight short frames each 9 ms are no matter
            document["configurations"][1]["streams"][0]["period"] = "9ms"
            document["monitors"][0]["when"]["any"][-1]["above"] = "300ms"
        document = guard()
        too_often(document)
        line = self.line_of('"9ms"', document) - 2
        err = self.refused(too_often, f"test.operator.json:{line}: /configurations/1/streams/0: in \"driving\" the processor of power_management ",
                           "proximity_ring", "longer periods or fewer streams of that board")
        self.assertIn("in the change from \"idle\" to \"driving\" the processor of power_management", err)
        self.assertNotIn("in \"driving\" proximity_ring takes up to", err)  # said once, where it is

        def together(document):  # 21 ms on the board and a few on the bus
            document["configurations"][1]["streams"][0]["period"] = "22ms"
            document["monitors"][0]["when"]["any"][-1]["above"] = "300ms"
        self.refused(together, "in \"driving\" proximity_ring takes up to 2", "21.742 ms of it on its board), its deadline is 22 ms")

        document["configurations"][1]["streams"][0]["period"] = "40ms"  # in a change two samples, and the bus
        self.run_tool("operate", self.write(document), "--check")

    def test_what_programs_may_command_counts_where_they_may(self):
        def studied(document):
            out, _ = self.run_tool("operate", self.write(document), "--check", "--json")
            return {each["name"]: each for each in json.loads(out)["configurations"]}
        study = studied(guard())
        motors = {"topic": "motors", "period_ns": 100_000_000, "priority": "medium"}
        self.assertEqual([study[name]["others"] for name in ("idle", "driving", "stopped")], [[motors], [motors], []])
        self.assertIn("led_1", study["driving"]["not_counted"])
        self.assertEqual(study["stopped"]["not_counted"], [])
        out, _ = self.run_tool("operate", GUARD, "--check")
        self.assertIn("  driving: motors every 100ms\n", out)
        self.assertRegex(out, "driving: NOT COUNTED, as no period of theirs is known: set points of led_1")

        document = guard()
        document["configurations"][1]["commanders"] = []
        without = studied(document)["driving"]
        self.assertEqual((without["others"], without["not_counted"]), ([], []))
        self.assertLess(without["load_per_mille"], study["driving"]["load_per_mille"])
        ring = [each["streams"][0]["response_ns"] for each in (without, study["driving"])]
        self.assertLess(ring[0], ring[1])  # a set point can be on the bus just before

        document["configurations"][1]["commanders"] = ["led"]
        self.assertEqual((studied(document)["driving"]["others"], "floor_calibration" in studied(document)["driving"]["not_counted"]),
                         ([], False))
        document = guard()
        document["others"] = [{"topic": "motors", "period": "10ms"}]  # as the file states it, and not twice
        stated = studied(document)["driving"]
        self.assertEqual(stated["others"], [])
        self.assertGreater(stated["load_per_mille"], study["driving"]["load_per_mille"])


    def test_when_streams_are_back_after_a_reset_is_a_sum(self):
        study = json.loads(self.run_tool("operate", GUARD, "--check", "--json")[0])
        for configuration in study["configurations"]:
            for stream in configuration["streams"]:
                recovery, parts = stream["recovery"], stream["recovery"]["parts_ns"]
                self.assertEqual(recovery["at_most_ns"], sum(parts.values()), stream)
                self.assertEqual(recovery["while_changing_ns"], recovery["at_most_ns"] + study["settle_ns"])
                self.assertEqual(parts["retry"], 1_000_000_000 if stream["period_ns"] < 300_000_000 else 0)
                self.assertEqual(parts["silence"], 0 if parts["retry"] else 3 * stream["period_ns"])
                self.assertLessEqual(parts["jitter"] + parts["sampling"] + parts["bus"], stream["response_ns"])
        out, _ = self.run_tool("operate", GUARD, "--check")
        self.assertRegex(out, r"recoveries: .*\n(  .*\n)*  driving: proximity_ring\n      [0-9.]+ ms = 1000 retry \+ 5 timer \+ "
                              r"[0-9.]+ request \+ 1 handling \+ 1 jitter \+ 21.742 sampling \+ [0-9.]+ bus\n")
        document = guard()
        del document["retry"]
        out, _ = self.run_tool("operate", self.write(document), "--check")
        self.assertIn("never: without \"retry\" a silent stream is not asked for again", out)
        study = json.loads(self.run_tool("operate", self.write(document), "--check", "--json")[0])
        self.assertEqual({stream["recovery"] for each in study["configurations"] for stream in each["streams"]}, {None})

    def test_frames_of_one_topic_are_one_reason(self):
        _, err = self.run_tool("operate", GUARD, "--check", "--bitrate", "20k", code=1)
        reasons = [line for line in err.splitlines() if " takes up to " in line and "processor" not in line]
        self.assertGreater(len(reasons), 3)
        of_what = [line.split(" takes up to ")[0] for line in reasons]
        self.assertEqual(len(of_what), len(set(of_what)), of_what)

    def test_limits_that_boards_do_not_keep_by_themselves_are_a_caution(self):
        def cautions(change):
            document = guard()
            change(document)
            out, err = self.run_tool("operate", self.write(document), "--check", "--json")
            self.assertEqual(err, "")
            found = json.loads(out)["cautions"]
            table, _ = self.run_tool("operate", self.write(document), "--check")
            self.assertEqual(table.count("CAUTION: "), len(found))
            return [each["what"] for each in found], found

        def free(document):
            driving = document["configurations"][1]
            driving["limits"], driving["entry"] = driving["limits"][:1], []
        self.assertEqual(cautions(lambda document: None), ([], []))  # the example
        what, found = cautions(free)
        self.assertEqual(what, ['in "driving" the limits of motors do not hold for what boards do by themselves: travel, follow, avoid, '
                                'home (by replay, run, set)',
                                'a travel that was begun in "idle" goes on in "driving", where the limits of motors do not hold for it'])
        document = guard()
        free(document)
        line = self.line_of('"motors.x"', document) - 1
        self.assertIn(f"test.operator.json:{line}: /configurations/1/limits/0", found[0]["place"])
        self.assertIn('"travel.speed"', found[0]["remedy"])

        def only_drive(document):
            free(document)
            document["configurations"][1]["commanders"] = ["drive", "led"]
        self.assertEqual(len(cautions(only_drive)[0]), 1)  # the travel that goes on

        def verbs(document):
            free(document)
            document["configurations"][1]["commanders"] = ["behave"]
            document["configurations"][1]["entry"] = [{"topic": "travel"}]
        self.assertEqual(cautions(verbs)[0], ['in "driving" the limits of motors do not hold for what boards do by themselves: follow, '
                                              'avoid, home (by behave)'])

        def by_itself(document):
            free(document)
            document["configurations"][1]["commanders"] = []
            document["configurations"][1]["entry"] = [{"topic": "travel"}, {"topic": "avoid", "values": {"speed": "0.1m/s"}}]
        self.assertEqual(cautions(by_itself)[0], ['in "driving" the limits of motors do not hold for what boards do by themselves: avoid '
                                                  '(by "entry")'])

        def not_the_motors(document):
            free(document)
            document["configurations"][1]["limits"] = [{"field": "travel.speed", "min": "0m/s", "max": "0.1m/s"}]
        self.assertEqual(cautions(not_the_motors)[0], [])


class Mistakes(Operate):
    def test_unknown_words_are_named_with_the_one_that_was_meant(self):
        def topic(document):
            document["configurations"][1]["streams"][0]["topic"] = "rnig"
        document = guard()
        topic(document)
        line = self.line_of('"rnig"', document)
        self.refused(topic, f"test.operator.json:{line}: /configurations/1/streams/0/topic: there is no topic \"rnig\"",
                     "did you mean 'ring'?")

        def field(document):
            document["monitors"][1]["when"] = "odometry.velocity.xx>0.15m/s"
        self.refused(field, "/monitors/1/when: no field 'odometry.velocity.xx'", "did you mean 'odometry.velocity.x'?")

        def configuration(document):
            document["transitions"][0]["to"] = "stoped"
        self.refused(configuration, "/transitions/0/to: there is no configuration \"stoped\"", "did you mean \"stopped\"?")

        def monitor(document):
            document["transitions"][0]["when"] = "obstacl"
        self.refused(monitor, "/transitions/0/when: there is no monitor \"obstacl\"", "did you mean \"obstacle\"?")

        def member(document):
            document["configurations"][1]["stream"] = []
        self.refused(member, "/configurations/1/stream: unknown member \"stream\"", "did you mean \"streams\"?")

        def several(document):
            document["monitors"][1]["when"] = "ring>3000"
        self.refused(several, "\"ring\" has 8 fields", "name one, such as")

    def test_limits_and_set_points_outside_the_spec(self):
        def limit(document):
            document["configurations"][1]["limits"][0]["max"] = "2m/s"
        self.refused(limit, "/configurations/1/limits/0/max: '2m/s' is out of range", "x takes -1 to 1 m/s")

        def turned_round(document):
            document["configurations"][1]["limits"][0].update(min="0.1m/s", max="-0.1m/s")
        self.refused(turned_round, "/configurations/1/limits/0: a limit is outside the range of its field, or is empty")

        def unit(document):
            document["configurations"][0]["entry"][0]["values"]["x"] = "3"
        self.refused(unit, "/configurations/0/entry/0/values/x: '3' needs a unit")

        def beyond(document):
            document["configurations"][1]["entry"] = [{"topic": "motors", "values": {"x": "0.2m/s"}}]
        self.refused(beyond, "/configurations/1/entry/0: a set point is beyond the limit", "\"limits\" of \"driving\"")

        def still(document):  # 0 would be no limit at all
            document["configurations"][1]["limits"][0]["per_second"] = "0m/s"
        self.refused(still, "/configurations/1/limits/0/per_second: \"0m/s\" is no distance of two values", "above 0")

    def test_times_that_no_clock_has_room_for_or_that_take_hours_to_analyse(self):
        for member in ("settle", "reaction", "handling"):
            for time in ("61s", "3000000s", "9223372036854775807ns"):
                def long(document):
                    document[member] = time
                self.refused(long, f"/{member}: \"{time}\" is too long", "at most \"60s\"")

        def lasting(document):
            document["monitors"][2]["for"] = "9223372036s"
        self.refused(lasting, "/monitors/2/for: \"9223372036s\" is too long", "at most \"86400s\"")

        def age(document):
            document["monitors"][0]["when"]["any"][4]["above"] = "86401s"
        self.refused(age, "/monitors/0/when/any/4/above: \"86401s\" is too long")

    def test_what_it_repeats_no_verb_of_its_own_may_command(self):
        def both(document):
            document["configurations"][2]["commanders"] = ["led", "drive"]
        self.refused(both, "/configurations/2/commanders: \"drive\" may command \"motors\", of which \"entry\" repeats a set point",
                     "leave out \"drive\"")

    def test_ways_between_configurations(self):
        def unreachable(document):
            document["configurations"].append({"name": "dancing"})
            document["transitions"].append({"from": "dancing", "to": "stopped", "on_request": True, "cause": "enough"})
        self.refused(unreachable, "/configurations/3: nothing leads to \"dancing\"", "add a transition to it")

        def trapped(document):
            document["configurations"].append({"name": "trapped"})
            document["transitions"] = [{"from": "driving", "to": "stopped", "when": "obstacle"},
                                       {"from": "stopped", "to": "driving", "when": "clear"},
                                       {"from": "idle", "to": "driving", "on_request": True},
                                       {"from": "idle", "to": "trapped", "on_request": True}]
        self.refused(trapped, "/configurations/3: nothing leads from \"trapped\" to the fall-back",
                     "add a transition to \"stopped\"")

        def at_once(document):
            document["transitions"].append({"from": "driving", "to": "idle", "when": "too_fast"})
        err = self.refused(at_once, "in \"driving\" it can fire at once with the transition of line", "\"precedence\"")
        self.assertIn("which leads to \"idle\"", err)

        def in_order(document):
            at_once(document)
            document["transitions"][-1]["precedence"] = 1
        document = guard()
        in_order(document)
        self.run_tool("operate", self.write(document), "--check")

        def apart(document):
            document["monitors"].append({"name": "slow", "when": "odometry.velocity.x<0.05m/s"})
            document["transitions"] = [t for t in document["transitions"] if t.get("when") not in ("obstacle", "bad_bus")]
            document["transitions"].append({"from": "driving", "to": "idle", "when": "slow"})
        document = guard()
        apart(document)
        self.run_tool("operate", self.write(document), "--check")  # no value is above the one and below the other

        def unseen(document):
            document["configurations"][1]["streams"].pop(1)
        self.refused(unseen, "its monitor looks at \"odometry\", which \"driving\" does not ask for", "add the stream")

    def test_conditions_that_say_nothing(self):
        for when, what in (("ring.sensor_1>70000", "is no condition on values"),
                           ("ring.sensor_1", "is not a condition"),
                           ("ring.sensor_1>fast", "is no condition on values"),
                           ("motors.x>0m/s", "is an actuator, which sends no samples"),
                           ({"age": "ring"}, "no \"above\""),
                           ({"age": "ring", "gap": "ring", "above": "1s"}, "both \"age\" and \"gap\""),
                           ({"above": "1s"}, "it says nothing of what is watched"),
                           ({"rate": "ring", "window": "1s"}, "neither \"above\" nor \"below\""),
                           ({"bus_state": "warning", "above": 3}, "\"above\" means nothing beside \"bus_state\""),
                           ({"bus_load": True, "window": "1s", "above": "170%"}, "is no load of a bus"),
                           ({"all": []}, "an empty list"),
                           (7, "7 is not an object")):
            def change(document):
                document["monitors"][1]["when"] = when
            self.refused(change, "/monitors/1/when", what)

    def test_any_file_is_a_problem_at_worst(self):
        for text in ("", "{", "[]", "null", '{"name": 3}', '{"name": "a", "name": "b"}', "\x00"):
            _, err = self.run_tool("operate", self.write(text), "--check", code=1)
            self.assertIn("test.operator.json:1", err)
        _, err = self.run_tool("operate", os.path.join(self.folder, "none.json"), "--check", code=1)
        self.assertIn("there is no such file", err)
        _, err = self.run_tool("operate", self.write(guard()), "--bitrate", "0", "--check", code=2)

    def test_every_member_of_the_guard_may_be_missing_or_wrong(self):
        """No change of one value makes the program fall: it says what is wrong, or takes it."""
        changes = 0

        def visit(node, path):
            keys = list(node) if isinstance(node, dict) else range(len(node)) if isinstance(node, list) else []
            for key in keys:
                yield path + [key]
                yield from visit(node[key], path + [key])
        for path in visit(guard(), []):
            for value in (None, "none", -1):
                document = guard()
                at = document
                for step in path[:-1]:
                    at = at[step]
                if value is None:
                    del at[path[-1]]
                else:
                    at[path[-1]] = value
                file = self.write(document, "changed.json")
                result = self.run_any("operate", file, "--check", "--json")
                self.assertIn(result.returncode, (0, 1), f"{path}: {result.stderr}")
                if result.returncode == 1:
                    self.assertIn("changed.json:", result.stderr)
                changes += 1
        self.assertGreater(changes, 300)

    def run_any(self, *arguments):
        return subprocess.run([AMIROCTL, *arguments], env=self.environment, text=True, capture_output=True, timeout=60)


ODOMETRY = {"topic": "odometry", "period": "50ms", "priority": "high"}
HALT = {
    "name": "halt", "initial": "driving", "fall_back": "halted",
    "settle": "100ms", "retry": "500ms", "reaction": "30ms", "handling": "5ms",
    "configurations": [
        {"name": "driving", "streams": [ODOMETRY], "limits": [{"field": "motors.x", "min": "-0.1m/s", "max": "0.1m/s"}]},
        {"name": "halted", "streams": [ODOMETRY], "entry": [{"topic": "motors", "repeat": "100ms"}]},
    ],
    "monitors": [
        {"name": "too_fast", "when": {"any": ["odometry.velocity.x>0.03m/s", {"age": "odometry", "above": "400ms"}]}},
        {"name": "still", "when": "odometry.velocity.x<0.01m/s", "for": "300ms"},
    ],
    "transitions": [
        {"from": "driving", "to": "halted", "when": "too_fast"},
        {"from": "halted", "to": "driving", "when": "still"},
    ],
}
REST = "001#0000000000000000"


class Operating(Operate):
    def operate(self, *options, document=None, bus=None):
        """An operator that has begun."""
        operator = self.start(*(("--bus", bus) if bus else ()), "operate", self.write(document or HALT), "--json", *options)
        self.assertEqual(self.event(operator)["event"], "started")
        return operator

    def event(self, operator, name=None):
        """The next event, of that name."""
        for line in operator.stdout:
            event = json.loads(line)
            if name is None or event["event"] == name:
                return event
        self.fail(f"the operator ended with {operator.wait()}: {operator.stderr.read()}")

    def raw_frames(self, *topics):
        listener = self.start("listen", "--raw", "--commands", *topics)
        self.assertIn("bus: sim", listener.stderr.readline())
        self.settle()
        return listener

    def frames(self, listener):
        out, _ = self.interrupt(listener)
        found = []
        for line in out.splitlines():
            time, _, frame = line.split()[:3]
            found.append((float(time.strip("()")), frame))
        return found


class Running(Operating):
    def test_it_halts_what_is_too_fast_and_lets_it_go_on(self):
        self.start_sim()
        operator = self.operate()
        listener = self.raw_frames("motors", "odometry")
        drive = self.start("drive", "5cm/s", "--for", "700ms", "--force")
        event = self.event(operator, "switched")
        self.assertEqual((event["from"], event["to"], event["cause"]), ("driving", "halted", "too_fast"))
        self.assertEqual(event["conditions"], ["odometry.velocity.x>0.03m/s"])
        drive.communicate(timeout=30)
        event = self.event(operator, "switched")
        self.assertEqual((event["from"], event["to"], event["cause"]), ("halted", "driving", "still"))
        frames = self.frames(listener)
        self.assertIn("201#50C3000000000000", [frame for _, frame in frames])
        rest = [time for time, frame in frames if frame == REST]
        self.assertGreater(len(rest), 3)
        for before, after in zip(rest, rest[1:]):
            self.assertGreater(after - before, 0.02)
        # From the frame that showed it to the set point: what the proof says without the sampling, unless it was late.
        shown = next(time for time, frame in frames if frame.startswith("502#") and
                     int.from_bytes(bytes.fromhex(frame[4:12]), "little", signed=True) > 30_000)
        _, err = self.interrupt(operator)
        self.assertEqual(operator.returncode, 130)
        if "later than" not in err:
            study = json.loads(self.run_tool("operate", self.write(HALT), "--check", "--json")[0])
            parts = study["reactions"][0]["conditions"][0]["parts_ns"]
            self.assertLess(rest[0] - shown, (parts["reading"] + parts["command"]) * 1e-9)

    def test_it_ends_with_all_at_rest_and_its_streams_stopped(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(signal=number):
                sim = self.start_sim()
                operator = self.operate()
                listener = self.raw_frames()
                out, err = self.interrupt(operator, number)
                self.assertEqual(operator.returncode, 128 + number)
                self.assertEqual(json.loads(out.splitlines()[-1])["event"], "ended")
                self.assertIn("0 changes", err)
                frames = [frame for _, frame in self.frames(listener)]
                self.assertIn(REST, frames)
                self.assertIn("103#00", frames)  # stop, at the stream's priority
                _, err = self.run_tool("listen", "odometry", "--timeout", "300ms", "-n", "1", code=1)
                self.interrupt(sim)

    def test_a_late_step_is_told_in_as_many_digits_as_say_something(self):
        self.start_sim()
        document = json.loads(json.dumps(HALT))
        document["initial"] = "halted"  # where a step is due each 100 ms
        document["transitions"] = [HALT["transitions"][0], {"from": "halted", "to": "driving", "on_request": True}]
        operator = self.start("operate", self.write(document))
        self.assertIn("operator halt is in halted\n", operator.stdout.readline())
        for _ in range(3):  # on a busy machine the first may come before there is a step
            operator.send_signal(signal.SIGSTOP)
            time.sleep(0.3)  # longer than its "reaction"
            operator.send_signal(signal.SIGCONT)
            time.sleep(0.3)  # a step or more
        late = next(line for line in operator.stdout if line.startswith("a step took"))
        _, err = self.interrupt(operator)
        self.assertRegex(late, r"a step took [0-9.]{1,5}m?s, which is longer than \"reaction\"")
        self.assertRegex(err, r"steps later than \"reaction\", up to [0-9.]{1,5}m?s\b")

    def test_a_silent_board_is_noticed_and_asked_again(self):
        self.start_sim()
        operator = self.operate()
        self.run_tool("stop", "odometry", "--priority", "high", "--no-confirm")
        event = self.event(operator, "switched")
        self.assertEqual(event["conditions"], ["age of odometry above 400ms"])
        self.assertEqual(self.event(operator, "asked_again")["topic"], "odometry")
        self.assertEqual(self.event(operator, "switched")["cause"], "still")
        _, err = self.interrupt(operator)
        self.assertRegex(err, r"2 changes, .*1 silent streams asked for again")

    def test_the_seconds_before_a_fall_back_are_kept_and_bounded(self):
        self.start_sim()
        box = os.path.join(self.folder, "box")
        operator = self.operate("--black-box", box, "--black-box-time", "2s", "--black-box-files", "2")
        kept = []
        for _ in range(3):
            drive = self.start("drive", "5cm/s", "--for", "300ms", "--force")
            recorded = self.event(operator, "recorded")
            kept.append(recorded)
            drive.communicate(timeout=30)
            self.event(operator, "switched")
        self.interrupt(operator)
        self.assertEqual(sorted(os.listdir(box)), sorted(os.path.basename(each["file"]) for each in kept[1:]))
        for each in kept[1:]:
            out, _ = self.run_tool("decode", each["file"])
            samples = self.objects(out)
            velocities = [sample["fields"]["x"] for sample in samples if sample["frame"] == "velocity"]
            self.assertGreater(velocities[-1], 0.03)
            self.assertLess(min(velocities), 0.03)
            with open(each["file"], encoding="utf-8") as file:
                lines = file.read().splitlines()
            self.assertEqual(len(lines), each["frames"])
            self.assertTrue(any("201#50C3" in line for line in lines))
            times = [float(line.split()[0].strip("()")) for line in lines]
            self.assertLess(max(times) - min(times), 2.1)

    def test_what_a_killed_operator_saw_is_kept_by_the_next_one(self):
        self.start_sim()
        box = os.path.join(self.folder, "box")
        operator = self.operate("--black-box", box, "--black-box-time", "1s")
        second = os.path.join(box, "halt.running-1.log")
        waiting.until(lambda: os.path.exists(second) and os.path.getsize(second) > 0, "a second file is begun")
        killed_at = time.time()
        operator.kill()
        operator.wait()
        self.assertEqual(len(os.listdir(box)), 2)
        operator = self.start("operate", self.write(HALT), "--json", "--black-box", box)
        event = self.event(operator, "recovered")
        self.assertEqual(os.listdir(box), [os.path.basename(event["file"])])
        with open(event["file"], encoding="utf-8") as file:
            times = [float(line.split()[0].strip("()")) for line in file]
        self.assertEqual(times, sorted(times))
        self.assertGreater(times[-1], killed_at - 1)
        self.assertGreater(times[-1] - times[0], 0.9)
        self.assertLess(times[-1] - times[0], 3)
        out, _ = self.run_tool("decode", event["file"])
        self.assertIn("velocity", {sample["frame"] for sample in self.objects(out)})
        self.event(operator, "started")
        self.interrupt(operator)
        self.assertEqual(os.listdir(box), [os.path.basename(event["file"])])  # it ended by itself

    def test_what_a_killed_operator_saw_is_kept_on_a_full_disk_too(self):
        self.start_sim()
        box = os.path.join(self.folder, "box")
        os.mkdir(box)
        lines = {0: "(1700000001.000000) sim 201#0000000000000000\n" * 9, 1: "(1700000000.000000) sim 103#00\n" * 9}
        for number, text in lines.items():
            path = os.path.join(box, f"halt.running-{number}.log")
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            os.utime(path, (1700000001 - number, 1700000001 - number))
        operator = self.start("operate", self.write(HALT), "--json", "--black-box", box,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500)))
        for number in (1, 0):  # in the order of time, neither joined nor cut
            with open(self.event(operator, "recovered")["file"], encoding="utf-8") as file:
                self.assertEqual(file.read(), lines[number])
        self.event(operator, "started")
        self.interrupt(operator)
        self.assertEqual(operator.returncode, 130)
        self.assertEqual(len([name for name in os.listdir(box) if name.endswith("black-box.log")]), 2)

    def test_streams_that_a_killed_operator_has_left_are_stopped(self):
        self.start_sim()
        document = json.loads(json.dumps(HALT))
        document["configurations"].append({"name": "idle", "streams": [{"topic": "power", "period": "1s"}]})
        document["transitions"] += [{"from": "idle", "to": "driving", "on_request": True},
                                    {"from": "halted", "to": "idle", "on_request": True}]
        document["initial"] = "idle"
        operator = self.operate(document=document)
        self.run_tool("operator", "switch", "driving")
        self.event(operator, "switched")
        operator.kill()
        operator.wait()
        listener = self.raw_frames("odometry")
        for line in listener.stdout:  # it goes on
            if " 502#" in line or " 503#" in line:
                break
        self.operate(document=document)
        time.sleep(0.5)  # ten periods, in which nothing must come
        frames = self.frames(listener)
        stopped = next(at for at, frame in frames if frame == "103#00")
        self.assertEqual([frame for at, frame in frames if at > stopped + 0.1], [])

    def test_of_two_operators_with_one_name_the_second_gets_another_black_box(self):
        self.start_sim()
        other = os.path.join(self.folder, "other.sock")
        self.start_sim("--bus", f"sim:{other}")
        box = os.path.join(self.folder, "box")
        self.operate("--black-box", box)
        waiting.until(lambda: os.listdir(box), "the black box is begun")
        _, err = self.run_tool("--bus", f"sim:{other}", "operate", self.write(HALT), "--black-box", box, code=1)
        self.assertIn(f"an operator with the name halt keeps its black box in {box}", err)

    def test_a_black_box_on_a_full_disk_is_counted_and_the_operator_goes_on(self):
        self.start_sim()
        operator = self.start("operate", self.write(HALT), "--json", "--black-box", os.path.join(self.folder, "box"),
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500)))
        self.event(operator, "started")
        drive = self.start("drive", "5cm/s", "--for", "300ms", "--force")
        self.event(operator, "switched")
        self.event(operator, "switched")
        drive.communicate(timeout=30)
        _, err = self.interrupt(operator)
        self.assertRegex(err, r"[0-9]+ frames that a kill would have lost from the black box")
        self.assertRegex(err, r"1 recordings")
        self.assertIn("File too large", err)

    def test_a_bus_that_is_gone_ends_it_and_says_so(self):
        sim = self.start_sim()
        box = os.path.join(self.folder, "box")
        operator = self.operate("--black-box", box)
        self.interrupt(sim)
        _, err = operator.communicate(timeout=30)
        self.assertEqual(operator.returncode, 1)
        self.assertIn("0 changes", err)
        self.assertEqual(len(os.listdir(box)), 1)

    def test_its_output_is_not_read_and_it_goes_on(self):
        self.start_sim()
        reader, writer = os.pipe()
        os.set_blocking(writer, False)
        try:  # full, before it begins
            while True:
                os.write(writer, b" " * 4096)
        except BlockingIOError:
            os.set_blocking(writer, True)
        operator = self.start("operate", self.write(HALT), stdout=writer)
        os.close(writer)
        listener = self.raw_frames("motors")
        self.assertIn("bus: sim", operator.stderr.readline())
        self.settle()
        drive = self.start("drive", "5cm/s", "--for", "400ms", "--force")
        drive.communicate(timeout=30)
        self.assertIn(REST, [frame for _, frame in self.frames(listener)])
        self.interrupt(operator)
        self.assertEqual(operator.returncode, 130)
        os.close(reader)

    def test_lines_that_cannot_be_printed_are_counted_and_it_goes_on(self):
        """A full disk behind the standard output, and a reader that has left."""
        for what, error in (("full", "No space left on device"), ("left", "Broken pipe"), ("closed", "Bad file descriptor")):
            with self.subTest(what):
                sim = self.start_sim()
                if what == "full":
                    out = os.open("/dev/full", os.O_WRONLY)
                else:
                    reader, out = os.pipe()
                    os.close(reader)
                operator = self.start("operate", self.write(HALT), "--json", stdout=out,
                                      preexec_fn=(lambda: os.close(1)) if what == "closed" else None)
                os.close(out)
                waiting.until(lambda: self.status() and self.status()["lines_not_printed"] == 1, "it has begun")
                self.assertIn("event lines not printed: 1\n", self.run_tool("operator", "status")[0])
                listener = self.raw_frames("motors")
                drive = self.start("drive", "5cm/s", "--for", "400ms", "--force")
                drive.communicate(timeout=30)
                waiting.until(lambda: self.status()["lines_not_printed"] >= 3, "it has switched")
                self.assertIn(REST, [frame for _, frame in self.frames(listener)])
                lines = self.status()["lines_not_printed"]
                self.assertIsNone(operator.poll())
                _, err = self.interrupt(operator)
                self.assertEqual(operator.returncode, 130)
                self.assertEqual(err.count(error), 1, err)  # said once
                counted = int(re.search("([0-9]+) event lines not printed", err)[1])
                self.assertGreater(counted, lines)  # that it has ended, too
                self.interrupt(sim)

    def status(self):
        """Of the operator that runs; none: it does not answer yet."""
        result = subprocess.run([AMIROCTL, "operator", "status", "--json"], env=self.environment, text=True, capture_output=True,
                                timeout=60)
        return json.loads(result.stdout) if result.returncode == 0 else None

    def test_what_may_be_late_is_not_run(self):
        self.start_sim()
        document = json.loads(json.dumps(HALT))
        document["settle"] = "10ms"
        listener = self.raw_frames()
        _, err = self.run_tool("operate", self.write(document), code=1)
        self.assertIn("may act too late on this bus, and is not run", err)
        self.assertIn("/settle", err)
        self.assertEqual(self.frames(listener), [])
        document["initial"] = "drivin"
        _, err = self.run_tool("operate", self.write(document), code=1)
        self.assertIn("did you mean \"driving\"?", err)


GUARDED = json.loads(json.dumps(HALT)) | {
    "configurations": [
        {"name": "driving", "streams": [ODOMETRY], "commanders": ["drive", "set"],
         "limits": [{"field": "motors.x", "min": "-0.02m/s", "max": "0.02m/s"}]},
        {"name": "slow", "streams": [ODOMETRY],
         "limits": [{"field": "motors.x", "min": "-0.01m/s", "max": "0.01m/s", "per_second": "0.02m/s"}]},
        {"name": "halted", "streams": [ODOMETRY], "commanders": [], "entry": [{"topic": "motors", "repeat": "100ms"}]},
    ],
    "transitions": HALT["transitions"] + [{"from": ["driving", "halted"], "to": "slow", "on_request": True},
                                          {"from": ["slow"], "to": "driving", "on_request": True},
                                          {"from": ["slow", "driving"], "to": "halted", "on_request": True},
                                          {"from": "slow", "to": "halted", "when": "too_fast"}],
}


def x_of(frame):
    """Of a set point of the motors, in um/s."""
    return int.from_bytes(bytes.fromhex(frame[4:12]), "little", signed=True)


class Asked(Operating):
    """amiroctl operator, and other programs that command the robot while an operator runs."""

    def test_it_says_what_it_does_and_why(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        status = json.loads(self.run_tool("operator", "status", "--json")[0])
        self.assertEqual((status["operator"], status["configuration"], status["on_hold"]), ("halt", "driving", False))
        self.assertEqual(status["streams"][0]["topic"], "odometry")
        self.assertEqual(status["set_points"], {"passed": 0, "limited": 0, "refused": 0, "beyond_proof": 0})
        out, _ = self.run_tool("operator", "status")
        self.assertRegex(out, "^operator halt is in driving since [0-9]+")
        self.assertRegex(out, "(?m)^  odometry +every 50ms +last [0-9]+(us|ms) ago$")
        out, _ = self.run_tool("operator", "switch", "slow")
        self.assertRegex(out, "driving -> slow|slow follows when the last change is over")
        self.assertEqual(self.event(operator, "switched")["to"], "slow")
        why = json.loads(self.run_tool("operator", "why", "--json")[0])
        self.assertEqual([(change["from"], change["to"]) for change in why["changes"]],
                         [(None, "driving"), ("driving", "slow")])
        self.assertEqual({way["to"] for way in why["leaves"]}, {"driving", "halted"})
        out, _ = self.run_tool("operator", "why")
        self.assertRegex(out, "driving -> slow: ")
        for change, line in zip(why["changes"], out.splitlines()):  # by the clock on the wall, cut to milliseconds
            at_ms = int(change["time_ns"]) // 1_000_000
            self.assertEqual(line.split()[0], time.strftime("%H:%M:%S", time.localtime(at_ms // 1000)) + f".{at_ms % 1000:03}")
        self.assertIn("to halted by too_fast, now no (odometry.velocity.x>0.03m/s: no, age of odometry above 400ms: no)", out)
        _, err = self.run_tool("operator", "switch", "slwo", code=1)
        self.assertIn('operator halt has no configuration "slwo"', err)
        self.assertIn("one of driving, slow, halted", err)
        self.interrupt(operator)
        _, err = self.run_tool("operator", "status", code=1)
        self.assertIn("no operator of yours runs on sim", err)

    def test_on_hold_it_guards_and_does_not_go_on_by_itself(self):
        self.start_sim()
        document = json.loads(json.dumps(HALT))
        operator = self.operate(document=document)
        self.assertIn("is on hold", self.run_tool("operator", "hold")[0])
        self.event(operator, "held")
        drive = self.start("--bus", "sim", "send", "201#50C3000000000000")  # past the operator
        drive.communicate(timeout=30)
        self.assertEqual(self.event(operator, "switched")["to"], "halted")
        self.settle()
        waiting.until(lambda: json.loads(self.run_tool("operator", "status", "--json")[0])["monitors"]["still"] == "yes",
                      "the robot is still")
        for _ in range(10):  # it answers for as long as it is on hold, beyond the 300 ms of "still", too
            time.sleep(0.05)
            status = json.loads(self.run_tool("operator", "status", "--json")[0])
        self.assertEqual((status["configuration"], status["on_hold"]), ("halted", True))
        self.assertIn("goes on", self.run_tool("operator", "resume")[0])
        self.assertEqual(self.event(operator, "switched")["to"], "driving")

    def test_set_points_of_other_programs_are_held_within_its_limits(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        listener = self.raw_frames("motors")
        _, err = self.run_tool("drive", "5cm/s", "--for", "500ms")
        self.assertRegex(err, r"drive: operator halt \(process [0-9]+\) guards the robot")
        self.assertRegex(err, r"drive: operator halt \(process [0-9]+\) limits motors\.x")
        self.assertEqual(self.event(operator, "commanded")["by"], "drive")
        self.assertEqual(self.event(operator, "limited")["fields"], "motors.x")
        _, err = self.run_tool("set", "motors", "x=1cm/s")
        self.assertNotIn("limits", err)
        frames = [frame for _, frame in self.frames(listener)]
        self.assertEqual({x_of(frame) for frame in frames}, {20_000, 10_000, 0})
        self.assertEqual(len([frame for frame in frames if x_of(frame) == 20_000]) in range(4, 8), True, frames)
        _, err = self.interrupt(operator)
        self.assertRegex(err, "[0-9]+ set points passed on, [0-9]+ set points limited")

    def test_a_replay_and_lights_go_through_it(self):
        self.start_sim()
        document = json.loads(json.dumps(GUARDED))
        document["configurations"][0]["commanders"] = ["led", "replay"]
        operator = self.operate(document=document)
        log = os.path.join(self.folder, "fast.log")
        with open(log, "w", encoding="utf-8") as file:
            file.write("(1.000000) can0 201#50C3000000000000\n(1.100000) can0 23C#FFFFFF\n(1.200000) can0 201#0000000000000000\n")
        listener = self.raw_frames("motors", "led_1")
        _, err = self.run_tool("replay", log)
        self.assertRegex(err, r"replay: operator halt \(process [0-9]+\) guards the robot")
        self.assertRegex(err, r"replay: operator halt \(process [0-9]+\) limits motors\.x")
        self.assertEqual(self.event(operator, "commanded")["by"], "replay")
        self.run_tool("led", "1", "red")
        frames = [frame for _, frame in self.frames(listener)]
        self.assertEqual([x_of(frame) for frame in frames if frame.startswith("201#")], [20_000, 0])
        self.assertEqual([frame for frame in frames if frame.startswith("23C#")], ["23C#FFFFFF", "23C#FF0000"])
        _, err = self.run_tool("drive", "1cm/s", "--for", "200ms", code=1)
        self.assertIn("where drive may not command motors", err)
        status = json.loads(self.run_tool("operator", "status", "--json")[0])
        self.assertEqual(status["set_points"], {"passed": 4, "limited": 1, "refused": 1, "beyond_proof": 0})

    def test_behaviours_of_boards_need_its_leave_and_their_end_does_not(self):
        self.start_sim()
        self.operate(document=GUARDED)
        for command, topic in ((("travel", "1cm"), "travel"), (("behave", "follow", "--for", "1s"), "follow")):
            _, err = self.run_tool(*command, code=1)
            self.assertIn(f"operator halt is in driving, where {command[0]} may not command {topic}", err)
        _, err = self.run_tool("behave", "none")
        self.assertRegex(err, r"behave: operator halt \(process [0-9]+\) guards the robot")
        self.run_tool("operator", "switch", "slow")
        self.settle()
        out, _ = self.run_tool("travel", "5mm", "--speed", "1cm/s")
        self.assertIn("arrived", out)

    def test_a_drive_comes_up_as_fast_as_it_may(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        self.run_tool("operator", "switch", "slow")
        self.event(operator, "switched")
        listener = self.raw_frames("motors")
        self.run_tool("drive", "5cm/s", "--for", "1s")
        frames = self.frames(listener)
        values = [x_of(frame) for _, frame in frames]
        self.assertEqual(max(values), 10_000)
        for (before, a), (after, b) in zip(frames, frames[1:]):
            self.assertLessEqual(x_of(b) - x_of(a), 20_000 * (after - before) + 1500)
        self.assertEqual(values[-1], 0)

    def test_who_may_not_command_is_refused_and_rest_never_is(self):
        self.start_sim()
        document = json.loads(json.dumps(GUARDED))
        document["transitions"] = [each for each in document["transitions"] if each.get("when") != "still"]
        operator = self.operate(document=document)
        script = os.path.join(self.folder, "a.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s drive 1cm/s\n1s stop\n")
        _, err = self.run_tool("run", script, code=1)
        self.assertIn("operator halt is in driving, where run may not command motors", err)
        self.run_tool("operator", "switch", "halted")
        while self.event(operator, "switched")["to"] != "halted":  # it may wait for the last change to be over
            pass
        _, err = self.run_tool("set", "motors", "x=1cm/s", code=1)
        self.assertIn("operator halt is in halted, where set may not command motors", err)
        self.run_tool("set", "motors", "x=0m/s")
        self.run_tool("stop")

    def test_what_it_repeats_itself_no_program_commands(self):
        """HALT's halted repeats rest and names no commanders: two that command take turns."""
        self.start_sim()
        document = json.loads(json.dumps(HALT))
        document["transitions"].append({"from": "driving", "to": "halted", "on_request": True})
        document["transitions"] = [each for each in document["transitions"] if each.get("when") != "still"]
        operator = self.operate(document=document)
        self.run_tool("operator", "switch", "halted")
        self.event(operator, "switched")
        listener = self.raw_frames("motors")
        _, err = self.run_tool("drive", "5cm/s", "--for", "500ms", code=1)
        self.assertRegex(err, r"drive: operator halt \(process [0-9]+\) is in halted, where it commands motors itself")
        self.assertNotIn("another program", err)
        for command in (("drive", "5cm/s", "--for", "500ms", "--force"), ("set", "motors", "x=5cm/s")):
            _, err = self.run_tool(*command, code=1)
            self.assertIn("operator halt is in halted, where it commands motors itself", err)
        self.run_tool("led", "1", "red")
        self.run_tool("stop")
        frames = [frame for _, frame in self.frames(listener)]
        self.assertGreater(len(frames), 3)
        self.assertEqual({x_of(frame) for frame in frames}, {0})
        _, err = self.interrupt(operator)
        self.assertIn("2 set points refused", err)

    def test_frames_of_a_script_hold_up_none_of_its_set_points(self):
        self.start_sim()
        self.operate(document=HALT)
        script = os.path.join(self.folder, "a.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s drive 1cm/s\n" + "".join(f"{n}00ms led {n} red\n" for n in range(1, 8)) + "800ms drive stop\n")
        for _ in range(3):
            _, err = self.run_tool("run", script)
            self.assertNotIn("were not sent", err)

    def test_a_drive_that_the_operator_ends_rests_and_says_so(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        listener = self.raw_frames("motors")
        drive = self.start("drive", "1cm/s")
        self.event(operator, "commanded")
        self.run_tool("operator", "switch", "halted")
        _, err = drive.communicate(timeout=30)
        self.assertEqual(drive.returncode, 1)
        self.assertRegex(err, "operator halt is in halted, where drive may not command motors|"
                              r"operator halt \(process [0-9]+\) is in halted and has set the motors to zero, which ends this drive")
        frames = [frame for _, frame in self.frames(listener)]
        self.assertEqual({x_of(frame) for frame in frames[frames.index(REST):]}, {0})

    def test_an_operator_that_is_stopped_or_killed_leaves_no_drive_moving(self):
        self.start_sim()
        for number in (signal.SIGSTOP, signal.SIGKILL):
            with self.subTest(signal=number):
                operator = self.operate(document=GUARDED)
                drive = self.start("drive", "1cm/s")
                self.event(operator, "commanded")
                listener = self.raw_frames("motors")
                operator.send_signal(number)
                _, err = drive.communicate(timeout=30)
                self.assertEqual(drive.returncode, 1)
                self.assertRegex(err, r"operator halt \(process [0-9]+\) (does not answer|has ended|is gone)")
                self.assertEqual(x_of(self.frames(listener)[-1][1]), 0)
                if number == signal.SIGSTOP:
                    _, err = self.run_tool("operator", "status", code=1)
                    self.assertIn("does not answer", err)
                    operator.kill()
                operator.wait()

    def test_a_request_of_a_program_that_has_left_is_not_met(self):
        # It was in a hurry, found the operator stopped, and has set the motors to zero past it.
        self.start_sim()
        operator = self.operate(document=GUARDED)
        listener = self.raw_frames("motors")
        client = self.client("drive")
        gone = self.client("operator")
        operator.send_signal(signal.SIGSTOP)
        client.send(b"send 201#1027000000000000")
        gone.send(b"switch slow")
        client.close()
        gone.close()
        operator.send_signal(signal.SIGCONT)
        out, _ = self.run_tool("operator", "status", "--json")
        self.assertEqual(json.loads(out)["set_points"]["passed"], 0)
        self.assertNotEqual(json.loads(out)["configuration"], "slow")
        self.assertEqual({x_of(frame) for _, frame in self.frames(listener)} - {0}, set())
        _, err = self.interrupt(operator)
        self.assertIn("2 programs turned away", err)

    def test_who_says_nothing_keeps_no_other_program_away(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        path = os.path.join(self.environment["XDG_RUNTIME_DIR"], "ocm", "operator-sim.sock")
        for _ in range(70):
            silent = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            self.addCleanup(silent.close)
            silent.connect(path)
        self.run_tool("operator", "switch", "slow")
        greeted = [self.client("drive") for _ in range(64)]
        _, err = self.run_tool("operator", "switch", "halted", code=1)
        self.assertIn("64 programs are connected already", err)
        greeted[0].close()
        self.run_tool("operator", "switch", "halted")
        self.interrupt(operator)
        self.assertEqual(operator.returncode, 130)

    def client(self, verb):
        client = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.addCleanup(client.close)
        client.settimeout(20)
        client.connect(os.path.join(self.environment["XDG_RUNTIME_DIR"], "ocm", "operator-sim.sock"))
        client.send(f"hello 1 {verb}".encode())
        self.assertEqual(client.recv(100), b"ok\nhalt")
        return client

    def test_set_points_beyond_what_the_proof_counts_are_said_and_counted(self):
        self.start_sim()
        document = json.loads(json.dumps(GUARDED))
        document["monitors"][0]["when"] = "odometry.velocity.x>0.5m/s"
        operator = self.operate(document=document)
        client = self.client("set")

        def command(frame):
            client.send(b"send " + frame)
            self.assertEqual(client.recv(1000).split(b"\n")[0], b"ok")

        def beyond():
            out, _ = self.run_tool("operator", "status", "--json")
            return json.loads(out)["set_points"]["beyond_proof"]
        command(b"201#0100000000000000")  # as often as a drive, with its jitter
        command(b"201#0100000000000000")
        self.assertEqual(beyond(), 0)
        time.sleep(0.3)  # of the operator's own clock
        command(b"101#0100000000000000")  # more urgent
        event = self.event(operator, "beyond_proof")
        self.assertEqual((event["topic"], event["by"]), ("motors", "set"))
        self.assertEqual(beyond(), 1)
        for _ in range(10):
            command(b"201#0100000000000000")
        self.assertGreater(beyond(), 1)
        out, _ = self.run_tool("operator", "status")
        self.assertRegex(out, "[0-9]+ of them more often, or more urgent, than the proof counts")
        _, err = self.interrupt(operator)
        self.assertRegex(err, "[0-9]+ set points more often, or more urgent, than the proof counts")

    def test_it_is_found_from_another_environment(self):
        # As those of cron, sudo and the system's services: without it they would command past the operator.
        bus = "sim:" + os.path.join(self.folder, "other.sock")
        self.start_sim("--bus", bus)
        mine = self.environment
        self.environment = {name: mine[name] for name in mine if name != "XDG_RUNTIME_DIR"}
        operator = self.operate(bus=bus)
        self.environment = mine
        out, _ = self.run_tool("--bus", bus, "operator", "status", "--json")
        self.assertEqual(json.loads(out)["operator"], "halt")
        _, err = self.run_tool("--bus", bus, "operate", self.write(HALT, "second.json"), code=1)
        self.assertIn(f"operator halt (process {operator.pid}) has {bus} already, which was started in another environment", err)
        self.interrupt(operator)
        self.assertEqual(operator.returncode, 130)

    def test_its_socket_is_removed_and_comes_back(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        folder = os.path.join(self.environment["XDG_RUNTIME_DIR"], "ocm")
        os.remove(os.path.join(folder, "operator-sim.sock"))
        self.assertEqual(self.event(operator, "socket")["found"], True)
        self.run_tool("operator", "status")
        _, err = self.run_tool("operate", self.write(HALT, "second.json"), code=1)
        self.assertIn("has sim already", err)
        # With its directory, as that of a user who logs out; here it cannot be made again at first.
        away = self.environment["XDG_RUNTIME_DIR"] + ".away"
        os.rename(folder, away)
        self.addCleanup(shutil.rmtree, away, True)
        with open(folder, "w", encoding="utf-8"):
            pass
        event = self.event(operator, "socket")
        self.assertEqual(event["found"], False)
        self.assertIn("is not a directory", event["problem"])
        os.remove(folder)
        self.assertEqual(self.event(operator, "socket")["found"], True)
        self.run_tool("operator", "status", "--bus", "sim")
        self.interrupt(operator)
        self.assertEqual(operator.returncode, 130)
        self.assertEqual(os.listdir(folder), [])

    def test_a_second_operator_is_refused_by_name(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        _, err = self.run_tool("operate", self.write(HALT, "second.json"), code=1)
        self.assertIn(f"operate: operator halt (process {operator.pid}) has sim already", err)
        other = os.path.join(self.folder, "other.sock")
        self.start_sim("--bus", f"sim:{other}")
        self.operate(bus=f"sim:{other}")  # another robot

    def test_what_is_said_to_its_socket_is_a_refusal_at_worst(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        path = os.path.join(self.environment["XDG_RUNTIME_DIR"], "ocm", "operator-sim.sock")
        self.assertEqual(os.stat(path).st_mode & 0o777, 0o600)
        chance = random.Random(5)
        words = [b"status", b"why json", b"switch ", b"switch halted", b"send ", b"send 201#", b"send 201#50C3000000000000",
                 b"send 201#R", b"send 12345678#00", b"send 605#00", b"delivery", b"hold", b"resume", b"", b"\0", b"hello 1 x"]
        for _ in range(300):
            client = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            client.connect(path)
            client.settimeout(5)
            if chance.random() < 0.8:
                client.send(b"hello 1 drive")
                self.assertEqual(client.recv(100), b"ok\nhalt")
            word = chance.choice(words) + bytes(chance.randrange(256) for _ in range(chance.choice((0, 0, 5, 5000))))
            if word:
                client.send(word)
                if chance.random() < 0.8:
                    answer = client.recv(60_000)
                    self.assertIn(answer.split(b"\n")[0], (b"ok", b"no", b"wait", b""), word[:50])
            client.close()
        greedy = [socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) for _ in range(70)]
        for client in greedy:
            client.connect(path)
        self.assertEqual(self.interrupt(operator) and operator.returncode, 130)
        for client in greedy:
            client.close()
        self.assertFalse(os.path.exists(path))

    def test_a_program_that_reads_no_answer_holds_up_nothing(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        path = os.path.join(self.environment["XDG_RUNTIME_DIR"], "ocm", "operator-sim.sock")
        client = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        client.connect(path)
        client.send(b"hello 1 drive")
        with self.assertRaises(OSError):
            while True:
                client.send(b"why json")
        drive = self.start("send", "201#50C3000000000000")
        drive.communicate(timeout=30)
        self.assertEqual(self.event(operator, "switched")["to"], "halted")
        client.close()


class Monitored(WithAdapter, Operating):
    """What a file may watch, and a period that follows a value, on real processes."""

    def watching(self, when, back, *streams):
        """HALT with other monitors; it streams these besides."""
        document = json.loads(json.dumps(HALT))
        for configuration in document["configurations"]:
            configuration["streams"] = [dict(ODOMETRY), *streams]
        document["monitors"] = [{"name": "event", "when": when}, {"name": "over", "when": back, "for": "100ms"}]
        document["transitions"] = [{"from": "driving", "to": "halted", "when": "event"}, {"from": "halted", "to": "driving", "when": "over"}]
        return document

    def samples(self, played, times, every=0.05, x=0):
        """Of odometry, from the board that the adapter plays."""
        velocity = x.to_bytes(4, "little", signed=True).hex().upper()
        for _ in range(times):
            for frame in (f"t5028{velocity}00000000", "t50380000000000000000"):
                played.say(frame + f"{int(time.time() * 1000) % 60000:04X}\r")
            time.sleep(every)  # the period of the stream

    def test_the_status_of_a_board(self):
        """A bit each topic: odometry 1, gyroscope 8, accelerometer 16, status 32."""
        self.start_sim()
        field = "di_wheel_drive_status.health.publishing"
        operator = self.operate(document=self.watching(f"{field}>50", f"{field}<50", {"topic": "di_wheel_drive_status", "period": "200ms"}))
        self.run_tool("publish", "gyro", "100ms")
        self.run_tool("publish", "accelerometer", "100ms")
        event = self.event(operator, "switched")
        self.assertEqual((event["to"], event["conditions"]), ("halted", [f"{field}>50"]))
        self.run_tool("stop", "accelerometer")
        self.assertEqual(self.event(operator, "switched")["to"], "driving")

    def test_the_load_of_the_bus(self):
        self.start_sim()
        document = self.watching({"bus_load": True, "above": "60%", "window": "500ms"},
                                 {"bus_load": True, "below": "50%", "window": "500ms"})
        for configuration in document["configurations"]:
            configuration["streams"][0]["period"] = "100ms"
            configuration["commanders"] = []
        document["settle"] = "400ms"
        # Judged as one of 25 kbit/s, which it is not: so little fills it.
        operator = self.operate("--bitrate", "25k", document=document)
        self.run_tool("publish", "gyro", "5ms")
        event = self.event(operator, "switched")
        self.assertEqual((event["to"], event["conditions"]), ("halted", ["bus load above 60%"]))
        self.run_tool("stop", "gyro")
        self.assertEqual(self.event(operator, "switched")["conditions"], ["bus load below 50%"])

    def test_how_many_samples_come_and_how_far_apart(self):
        for when, text in (({"rate": "odometry", "below": 3, "window": "400ms"}, "rate of odometry below 3 in 400ms"),
                           ({"gap": "odometry", "above": "400ms"}, "gap of odometry above 400ms")):
            with self.subTest(text):
                played = self.adapter()
                operator = self.operate(document=self.watching(when, {"not": when}), bus=f"slcan:{played.path}")
                self.assertEqual(self.event(operator, "switched")["conditions"], [text])  # nothing came yet
                self.samples(played, 30)
                self.assertEqual(self.event(operator, "switched")["to"], "driving")
                self.assertEqual(self.event(operator, "switched")["conditions"], [text])
                self.interrupt(operator)

    def test_a_period_follows_a_value(self):
        document = json.loads(json.dumps(HALT))
        document["configurations"][0]["streams"] = [ODOMETRY | {"period": "100ms", "adapt": {
            "field": "odometry.velocity.x", "magnitude": True, "from": "0m/s", "at_from": "100ms", "to": "0.02m/s", "at_to": "50ms",
            "every": "300ms"}}]
        document["monitors"][0]["when"]["any"][-1]["above"] = "2s"
        played = self.adapter()
        operator = self.operate(document=document, bus=f"slcan:{played.path}")
        requests = lambda: [frame for frame in played.frames if frame.startswith("103#01")]
        waiting.until(lambda: requests() == ["103#01640000"], "a request of 100 ms")
        self.samples(played, 10)
        self.assertEqual(requests(), ["103#01640000"])  # as it is
        self.samples(played, 10, x=-10_000)
        self.assertEqual(requests(), ["103#01640000", "103#014B0000"])  # half of the way: 75 ms
        self.samples(played, 10, x=25_000)
        self.assertEqual(requests()[2:], ["103#01320000"])
        self.samples(played, 10)
        self.assertEqual(requests()[3:], ["103#01640000"])
        _, err = self.interrupt(operator)
        self.assertIn("3 periods adapted", err)


SMALL_CAR = os.path.join(SOURCE, "examples", "small_car.dbc")
CAR = {
    "name": "car", "initial": "watching", "fall_back": "alarm", "settle": "60ms", "reaction": "20ms", "handling": "1ms",
    "configurations": [{"name": "watching", "streams": [{"topic": "Driving"}]},
                       {"name": "alarm", "streams": [{"topic": "Driving"}]}],
    "monitors": [{"name": "fast", "when": "Driving.Speed>50km/h"},
                 {"name": "silent", "when": {"age": "Driving", "above": "2s"}},
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
        operator = self.start("operate", self.write(CAR), "--json", "--spec", SMALL_CAR)
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
        self.interrupt(car)  # silence
        self.assertEqual(self.event(operator, "switched")["conditions"], ["age of Driving above 2s"])
        _, err = self.interrupt(operator)
        self.assertEqual(operator.returncode, 130)
        self.assertIn("3 changes, 0 frames sent", err)
        out, _ = self.interrupt(listener)
        self.assertEqual({json.loads(line)["id"] for line in out.splitlines()}, {"130"})


def of_field(field, low, high):
    """CAR with this field above `high` as the event, and below `low` as its end."""
    text = json.dumps(CAR).replace("Driving.Speed>50km/h", f"{field}>{high}").replace("Driving.Speed<50km/h", f"{field}<{low}")
    text = text.replace('"2s"', '"60s"').replace('"Driving"', json.dumps(field.split(".")[0]))
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
        self.run_tool("send", "130#1B58000000000000")  # Driving.Speed of 70 km/h
        event = self.event(operator, "switched")
        self.assertEqual((event["to"], event["conditions"]), ("alarm", ["Driving.Speed>50km/h"]))
        _, err = self.interrupt(operator)
        self.assertIn("1 changes, 0 frames sent", err)


class AsAService(Operating):
    def test_systemd_is_told_what_it_does_and_that_it_runs(self):
        self.start_sim()
        path = os.path.join(self.folder, "notify")
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as notify:
            notify.bind(path)
            notify.settimeout(30)
            self.environment |= {"NOTIFY_SOCKET": path, "WATCHDOG_USEC": "400000"}
            operator = self.operate()
            said = []
            while said.count("WATCHDOG=1") < 3:
                said.append(notify.recv(1000).decode())
            self.assertIn("READY=1\nSTATUS=operator halt on sim", said)
            self.assertIn("STATUS=operator halt is in driving", said)
            operator.send_signal(signal.SIGTERM)
            while said[-1] != "STOPPING=1":
                said.append(notify.recv(1000).decode())
            operator.communicate(timeout=30)

    def test_the_unit_file_is_one(self):
        unit = configparser.ConfigParser(strict=False, interpolation=None)
        unit.optionxform = str
        unit.read(os.path.join(SOURCE, "examples", "amiroctl-operator.service"))
        self.assertEqual(unit["Service"]["Type"], "notify")
        self.assertEqual((unit["Service"]["Restart"], unit["Unit"]["StartLimitIntervalSec"]), ("always", "0"))
        verify = shutil.which("systemd-analyze")
        if verify:
            file = os.path.join(self.folder, "amiroctl-operator@.service")
            with open(os.path.join(SOURCE, "examples", "amiroctl-operator.service"), encoding="utf-8") as text:
                content = text.read().replace("/usr/bin/amiroctl", AMIROCTL)
            with open(file, "w", encoding="utf-8") as text:
                text.write(content)
            result = subprocess.run([verify, "verify", "--man=no", file], text=True, capture_output=True, timeout=60)
            self.assertEqual(result.stderr, "")


class OnAnAdapter(WithAdapter, Operating):
    def test_a_refused_request_is_named_and_can_be_a_cause(self):
        document = json.loads(json.dumps(HALT))
        document["monitors"].append({"name": "refused", "when": {"refusals": True}})
        document["transitions"].append({"from": "driving", "to": "halted", "when": "refused", "precedence": 1})
        played = self.adapter(script={"103#01320000": [refusal(0x03, NOT_SCHEDULABLE)]})
        operator = self.operate(document=document, bus=f"slcan:{played.path}")
        event = self.event(operator, "refused")
        self.assertEqual((event["topic"], event["board"], event["reason"]), ("odometry", "di_wheel_drive", "not_schedulable"))
        event = self.event(operator, "switched")
        self.assertEqual((event["cause"], event["conditions"]), ("refused", ["refusals above 0"]))
        self.interrupt(operator)
        self.assertEqual(operator.returncode, 130)
        self.assertEqual(played.frames[-2:], [REST, "103#00"])

    def test_an_adapter_that_is_pulled_ends_it_and_the_next_run_goes_on(self):
        box = os.path.join(self.folder, "box")
        played = self.adapter()
        operator = self.operate("--black-box", box, bus=f"slcan:{played.path}")
        waiting.until(lambda: any(frame.startswith("103#01") for frame in played.frames), "a request")
        self.assertEqual(self.event(operator, "switched")["to"], "halted")
        waiting.until(lambda: played.frames.count(REST) > 2, "set points of rest")
        played.unplug()
        _, err = operator.communicate(timeout=60)
        self.assertEqual(operator.returncode, 1, err)
        self.assertIn(played.path, err)
        self.assertIn("1 changes", err)
        kept = [name for name in os.listdir(box) if name.endswith(".black-box.log")]
        self.assertEqual(len(kept), 2, kept)  # before the fall-back, and before the end
        sent = int(re.search("([0-9]+) frames sent", err)[1])
        with_rest = 0
        for name in kept:
            with open(os.path.join(box, name), encoding="utf-8") as file:
                with_rest += sum(" T" in line for line in file)
        self.assertEqual(with_rest, sent)  # each frame that was sent is in one of them

        # Back again, and started again, as systemd does.
        again = self.adapter()
        operator = self.operate("--black-box", box, bus=f"slcan:{again.path}")
        waiting.until(lambda: any(frame.startswith("103#01") for frame in again.frames), "a request")
        self.interrupt(operator)
        self.assertEqual(operator.returncode, 130)
        self.assertEqual(again.frames[-2:], [REST, "103#00"])

    def test_a_board_that_was_reset_is_asked_again_within_the_bound(self):
        """The adapter plays the board: it has lost its streams, and sends again when it is asked. What is measured is when the
        request is there; that the program is late where the machine is busy is reported, and then not judged."""
        document = json.loads(json.dumps(HALT))
        document["retry"] = "200ms"
        study = json.loads(self.run_tool("operate", self.write(document), "--check", "--json")[0])
        parts = study["configurations"][0]["streams"][0]["recovery"]["parts_ns"]
        asked = ("silence", "last sample", "retry", "timer", "request")
        bound = sum(parts[part] for part in asked) * 1e-9
        played = self.adapter()
        operator = self.operate(document=document, bus=f"slcan:{played.path}")
        requests = lambda: [frame for frame in played.frames if frame.startswith("103#01")]
        waiting.until(lambda: requests(), "a request")
        sample = ["t50280000000000000000", "t50380000000000000000"]

        def publish(times):
            """The longest time without a sample, in seconds."""
            longest, last = 0, time.monotonic()
            for _ in range(times):
                for frame in sample:
                    played.say(frame + f"{int(time.time() * 1000) % 60000:04X}\r")
                longest, last = max(longest, time.monotonic() - last), time.monotonic()
                time.sleep(0.05)
            return max(longest, time.monotonic() - last)
        before, gap = len(requests()), publish(10)
        known = len(requests())
        if gap < parts["silence"] * 1e-9 / 2:  # else this test was the silent one
            self.assertEqual(known, before)
        back = time.monotonic()  # the board is reset and back in no time
        waiting.until(lambda: len(requests()) > known, "another request")
        measured = time.monotonic() - back
        self.assertEqual(self.event(operator, "asked_again")["topic"], "odometry")
        publish(20)
        _, err = self.interrupt(operator)
        self.assertRegex(err, "[1-9][0-9]* silent streams asked for again")
        if "later than" not in err:
            self.assertLess(measured, bound + 0.1)  # how often this test looks, and how fast

    def test_a_robot_that_says_nothing_is_stopped(self):
        played = self.adapter()
        document = json.loads(json.dumps(HALT))
        operator = self.operate(document=document, bus=f"slcan:{played.path}")
        self.event(operator, "switched")  # nothing comes: the stream is too old
        _, err = self.interrupt(operator)
        self.assertIn("1 changes", err)
        self.assertEqual(played.frames[-2:], [REST, "103#00"])


class Drawn(Operate):
    @unittest.skipUnless(shutil.which("dot"), "Graphviz is not installed")
    def test_the_state_machine_is_drawn_with_its_bounds(self):
        picture = os.path.join(self.folder, "guard.svg")
        self.run_tool("operate", GUARD, "--check", "--svg", picture)
        text = "".join(xml.etree.ElementTree.parse(picture).getroot().itertext())
        study = json.loads(self.run_tool("operate", GUARD, "--check", "--json")[0])
        for configuration in study["configurations"]:
            self.assertIn(configuration["name"], text)
        for reaction in study["reactions"]:
            self.assertIn(f"{reaction['at_most_ns'] / 1e6:.6f}".rstrip("0").rstrip(".") + " ms", text)
        self.assertIn("21.742 sampling", text)
        out, _ = self.run_tool("operate", GUARD, "--check", "--svg", "-")
        xml.etree.ElementTree.fromstring(out)

    def test_without_graphviz_it_says_what_to_install(self):
        self.environment["PATH"] = self.folder
        _, err = self.run_tool("operate", GUARD, "--check", "--svg", os.path.join(self.folder, "a.svg"), code=1)
        self.assertIn("a.svg: dot is missing", err)
        self.assertIn("sudo apt install graphviz", err)

    def test_without_graphviz_what_is_proved_is_shown_all_the_same(self):
        self.environment["PATH"] = self.folder
        whole, _ = self.run_tool("operate", GUARD, "--check")
        out, _ = self.run_tool("operate", GUARD, "--check", "--svg", os.path.join(self.folder, "a.svg"), code=1)
        self.assertEqual(out, whole)
        _, err = self.run_tool("operate", GUARD, "--check", "--bitrate", "50k", "--svg", os.path.join(self.folder, "a.svg"), code=1)
        self.assertIn("/settle: the change", err)


if __name__ == "__main__":
    main()
