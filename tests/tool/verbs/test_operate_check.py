"""amiroctl operate --check: what is proved of a file, the mistakes in one, and its picture."""

import json
import os
import re
import shutil
import unittest
import xml.etree.ElementTree

from harness import SOURCE, main
from operate_cases import GUARD, guard, Operate


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
        self.assertRegex(out, r"ring\.sensor_4>3000\n +[0-9.]+ ms = 50 period \+ 1 jitter \+ 26.572 sampling \+ [0-9.]+ bus \+ 5 reading \+ ")
        self.assertRegex(out, r"clear: stopped -> driving\n(.*\n)*    not bus state passive\n")
        self.assertIn("[Real, Crespo 2004", out)
        self.assertTrue(out.endswith("\nin time\n"))
        with open("/dev/full", "w", encoding="utf-8") as full:  # more than a buffer: it fails before the end
            tool = self.start("operate", GUARD, "--check", stdout=full)
            _, err = tool.communicate(timeout=30)
        self.assertEqual((tool.returncode, err), (1, "amiroctl: cannot write to the standard output: No space left on device\n"))

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
        alone = study["configurations"][0]["streams"][0]
        self.assertGreater(power["on_board_ns"], alone["on_board_ns"])  # it waits for the ring, on the same board

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

        def together(document):  # 26 ms on the board and a few on the bus
            document["configurations"][1]["streams"][0]["period"] = "27ms"
            document["monitors"][0]["when"]["any"][-1]["above"] = "300ms"
        self.refused(together, "in \"driving\" proximity_ring takes up to 3", "26.572 ms of it on its board), its deadline is 27 ms")

        document["configurations"][1]["streams"][0]["period"] = "48ms"  # in a change two samples, and the bus
        self.refused(lambda _: None, "in the change from \"driving\" to \"stopped\" power_status takes up to 5", document=document)
        for configuration in document["configurations"][1:]:
            del configuration["streams"][-1]
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


    def test_of_another_robot_s_boards_no_task_is_known(self):
        """Also where they are called as the AMiRo's are."""
        path = os.path.join(self.folder, "other.json")
        with open(os.path.join(SOURCE, "spec", "topics.json"), encoding="utf-8") as file:
            text = file.read()
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace('"robot": "AMiRo"', '"robot": "Other"'))
        study = json.loads(self.run_tool("operate", GUARD, "--check", "--json", "--spec", path)[0])
        self.assertEqual(sorted(study["sampling_not_counted"]), ["odometry", "power_status", "proximity_ring"])
        self.assertEqual({stream["on_board_ns"] for each in study["configurations"] for stream in each["streams"]}, {None})

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
                              r"[0-9.]+ request \+ 1 handling \+ 1 jitter \+ 26.572 sampling \+ [0-9.]+ bus\n")
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

    def test_a_configuration_that_no_silence_ends_is_a_caution(self):
        def cautions(change):
            document = guard()
            change(document)
            out, err = self.run_tool("operate", self.write(document), "--check", "--json")
            self.assertEqual(err, "")
            return json.loads(out)["cautions"], document

        def obstacle(*silences):
            def change(document):
                values = document["monitors"][0]["when"]["any"]
                values[:] = [each for each in values if "age" not in each] + list(silences)
            return change
        found, document = cautions(obstacle())
        self.assertEqual([each["what"] for each in found], ['nothing leads from "driving" to "stopped" when proximity_ring falls silent: '
                                                            'what is not known fires no monitor'])
        line = self.line_of('"driving"', document) - 1
        self.assertIn(f"test.operator.json:{line}: /configurations/1", found[0]["place"])
        self.assertIn('{"age": "proximity_ring", "above": ...}', found[0]["remedy"])
        for silence in ({"age": "ring", "above": "250ms"}, {"gap": "ring", "above": "250ms"},
                        {"rate": "ring", "below": 15, "window": "1s"}):
            self.assertEqual(cautions(obstacle(silence))[0], [])

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

    def test_words_that_mean_nothing_beside_a_condition(self):
        """Each kind of condition has words of its own; what it takes besides is the remedy."""
        moves = "odometry.velocity.x>0.1m/s"
        window = {"window": "1s"}
        for when, word, remedy in (({"where": moves}, "above", "hysteresis"),
                                   ({"age": "ring", "above": "250ms"}, "below", "above"),
                                   ({"gap": "ring", "above": "250ms"}, "window", "above"),
                                   ({"refusals": True}, "window", "above"),
                                   ({"rate": "odometry", "below": 5} | window, "hysteresis", "above, below, window"),
                                   ({"bus_load": True, "above": "60%"} | window, "hysteresis", "above, below, window"),
                                   ({"bus_state": "off"}, "below", "leave it out"), ({"not": moves}, "hysteresis", "leave it out"),
                                   ({"all": [moves]}, "above", "leave it out"), ({"any": [moves]}, "window", "leave it out")):
            def change(document):
                document["monitors"][1]["when"] = when | {word: "1s"}
            with self.subTest(when=when):
                kind = next(iter(when))
                self.refused(change, f'/monitors/1/when/{word}: "{word}" means nothing beside "{kind}"\n          {remedy}\n')

    def test_any_file_is_a_problem_at_worst(self):
        for text in ("", "{", "[]", "null", '{"name": 3}', '{"name": "a", "name": "b"}', "\x00"):
            _, err = self.run_tool("operate", self.write(text), "--check", code=1)
            self.assertIn("test.operator.json:1", err)
        _, err = self.run_tool("operate", os.path.join(self.folder, "none.json"), "--check", code=1)
        self.assertIn("there is no such file", err)
        _, err = self.run_tool("operate", self.write(guard()), "--bitrate", "0", "--check", code=2)


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
        self.assertIn("26.572 sampling", text)
        out, _ = self.run_tool("operate", GUARD, "--check", "--svg", "-")
        xml.etree.ElementTree.fromstring(out)

    def test_a_picture_does_not_replace_what_is_drawn(self):
        path = os.path.join(self.folder, "own.json")
        with open(GUARD, encoding="utf-8") as file:
            text = file.read()
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        _, err = self.run_tool("operate", path, "--check", "--svg", path, code=2)
        self.assertIn(f"operate: {path} and {path} are the same file\n", err)
        with open(path, encoding="utf-8") as file:
            self.assertEqual(file.read(), text)

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
