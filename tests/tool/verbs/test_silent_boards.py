"""A board that is off: any other node acknowledges what is sent to it, so what sets something asks whether it is there."""

import json
import os
import time

from harness import SOURCE, Case, main
from played_adapter import WithAdapter

REST = "201#0000000000000000"
STATUS = "t71B80500000175B906B2\r"  # of di_wheel_drive, its identity
MOVES = "THE ROBOT MAY STILL MOVE"


def silent(verb, board):
    return f"amiroctl: {verb}: {board} does not answer, so nothing shows that it has done it"


class OnTheSimulatedRobot(Case):
    def test_each_verb_that_sets_something_names_the_board(self):
        self.start_sim("--without", "light_ring")
        for verb in (("led", "1", "red"), ("led", "all", "off"), ("set", "led_3", "red=1"),
                     ("set", "led_3", "red=1", "--every", "50ms", "--for", "100ms"),
                     ("run", self.script("0s led 1 red\n0s drive 1cm/s --for 100ms\n"))):
            _, err = self.run_tool(*verb, code=1)
            self.assertIn(silent(verb[0], "light_ring") + "\n          is it powered and on sim?", err, verb)
            self.run_tool(*verb, "--no-confirm")
        # What is for the others is done, and a board that is off is at rest.
        for verb in (("set", "motors", "x=1cm/s"), ("drive", "1cm/s", "--for", "100ms"), ("drive", "stop"), ("stop",),
                     ("run", self.script("0s stop\n"))):
            self.run_tool(*verb)

    def test_the_wheels(self):
        self.start_sim("--without", "di_wheel_drive")
        for verb in (("set", "motors", "x=1cm/s"), ("drive", "1cm/s", "--for", "100ms"), ("drive", "1cm/s", "--once", "--force"),
                     ("run", self.script("0s drive 1cm/s --for 100ms\n"))):
            _, err = self.run_tool(*verb, code=1)
            self.assertIn(silent(verb[0], "di_wheel_drive"), err, verb)
            self.assertNotIn(MOVES, err)
            self.assertNotIn("has not answered", err)  # which says the same
        for verb in (("stop",), ("drive", "stop"), ("stop", "motors")):
            _, err = self.run_tool(*verb, code=1)
            self.assertIn(f"{silent(verb[0], 'di_wheel_drive')}; {MOVES}", err, verb)
        self.run_tool("stop", "gyro")  # silent already
        self.run_tool("led", "1", "red")

    def test_a_published_status_goes_on(self):
        self.start_sim()
        self.run_tool("publish", "light_ring_status", "50ms")
        listener = self.listen("--commands", "--timeout", "20s")
        self.run_tool("led", "1", "red")
        self.run_tool("send", "123#")
        ids = []
        while not ids or ids[-1] != "123":
            ids.append(json.loads(listener.stdout.readline())["id"])
        self.assertIn("23C", ids)
        self.assertNotIn("357", ids)  # it was heard, and a question would have ended the stream

    def test_a_signal_during_the_wait(self):
        self.start_sim("--without", "light_ring")
        listener = self.listen("--commands", "--timeout", "60s")

        def ends(*verb):
            tool = self.start(*verb)
            while json.loads(listener.stdout.readline())["id"] != "357":  # it asks
                pass
            return self.interrupt(tool)[1], tool.returncode
        for verb in (("set", "led_1", "red=1", "--every", "50ms", "--for", "100ms"), ("set", "led_1", "red=1"), ("led", "1", "red")):
            err, code = ends(*verb)
            self.assertEqual(code, 130, verb)
            self.assertIn(f"{verb[0]}: interrupted before light_ring answered, so nothing shows that it has done it\n", err)
        err, code = ends("run", self.script("0s set travel distance=50cm angle=0rad speed=10cm/s\n0s led 1 red\n"))
        self.assertEqual(code, 130)
        self.assertIn("interrupted: travel was ended", err)
        frame = {"id": ""}
        while frame["id"] != "20B":
            frame = json.loads(listener.stdout.readline())
        self.assertEqual(frame["data"], "0000000000000000")

    def test_a_bus_that_goes_during_the_wait(self):
        sim = self.start_sim("--without", "light_ring")
        listener = self.listen("--commands", "--timeout", "60s")
        led = self.start("led", "1", "red")
        while json.loads(listener.stdout.readline())["id"] != "357":
            pass
        self.interrupt(sim)
        _, err = led.communicate(timeout=60)
        self.assertEqual(led.returncode, 1, err)
        self.assertIn("amiroctl: led: light_ring had not answered when the bus went: ", err)

    def test_a_stop_of_a_travel_says_what_it_means(self):
        self.start_sim("--without", "di_wheel_drive")
        _, err = self.run_tool("stop", "travel", code=1)
        self.assertIn(f"{silent('stop', 'di_wheel_drive')}; {MOVES}, to the end of its way", err)


class OnAPlayedRobot(WithAdapter, Case):
    def robot(self, script):
        self.played = self.adapter(script=script)
        return ("--bus", f"slcan:{self.played.path}")

    def test_it_is_asked_once_behind_the_command(self):
        bus = self.robot({"31B#02": [STATUS]})
        self.run_tool(*bus, "drive", "stop")
        self.assertEqual(self.played.frames, [REST, "31B#02"])

    def test_a_board_that_was_heard_is_not_asked(self):
        bus = self.robot({"208#01640000": ["t60860300FFFF00000010\r"]})
        self.run_tool(*bus, "run", self.script("0s publish gyro 100ms\n300ms set motors x=1cm/s\n"))
        self.assertNotIn("31B#02", self.played.frames)

    def test_a_board_that_has_no_status_is_not_asked(self):
        spec = os.path.join(self.folder, "old.json")
        with open(os.path.join(SOURCE, "spec", "topics.json"), encoding="utf-8") as file:
            text = file.read()
        self.assertIn('"role": "status"', text)
        with open(spec, "w", encoding="utf-8") as file:
            file.write(text.replace('"role": "status", ', "").replace(', "role": "status"', ""))
        bus = self.robot({})
        begin = time.monotonic()
        self.run_tool(*bus, "--spec", spec, "set", "motors", "x=1cm/s")
        self.assertEqual(len(self.played.frames), 1)
        self.assertLess(time.monotonic() - begin, 20)


if __name__ == "__main__":
    main()
