"""Programs beside an operator: amiroctl operator, and commands that go through it."""

import json
import math
import os
import random
import shutil
import signal
import socket
import time

from harness import SOURCE, main, waiting
from operate_cases import HALT, ODOMETRY, Operating, REST
from played_adapter import WithAdapter

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


class Asked(WithAdapter, Operating):
    """amiroctl operator, and other programs that command the robot while an operator runs."""

    def test_the_shell_completes_where_a_request_leads(self):
        self.start_sim()
        switch = ("completion", "--words", "--", "operator", "switch")
        self.assertEqual(self.run_tool(*switch, "")[0], "words\n")
        operator = self.operate(document=GUARDED)
        self.assertEqual(self.run_tool(*switch, "")[0], "words\nslow\tfrom driving\nhalted\tfrom driving\n")
        self.run_tool("operator", "switch", "slow")
        self.event(operator, "switched")  # it may follow when the start is over
        self.assertEqual(self.run_tool(*switch, "d")[0], "words\ndriving\tfrom slow\n")
        self.assertEqual(self.run_tool(*switch, "--bus", "vcan7", "")[0], "words\n")

    def test_it_says_what_it_does_and_why(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        status = json.loads(self.run_tool("operator", "status", "--json")[0])
        self.assertEqual((status["operator"], status["configuration"], status["on_hold"]), ("halt", "driving", False))
        self.assertEqual(status["streams"][0]["topic"], "odometry")
        self.assertEqual(status["set_points"], {"passed": 0, "limited": 0, "refused": 0, "beyond_proof": 0})
        out, _ = self.run_tool("operator", "status")
        self.assertRegex(out, "^operator halt is in driving since [0-9]+")
        self.assertRegex(out, "(?m)^  odometry +every 50ms +last (under )?[0-9]+ms ago$")
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
        self.assertRegex(err, r"drive: operator halt \(process [0-9]+\) limits motors\.x to at most 0\.02 m/s\n")
        self.assertEqual(self.event(operator, "commanded")["by"], "drive")
        self.assertEqual(self.event(operator, "limited")["fields"], "motors.x")
        _, err = self.run_tool("set", "motors", "x=1cm/s")
        self.assertNotIn("limits", err)
        frames = [frame for _, frame in self.frames(listener)]
        self.assertEqual({x_of(frame) for frame in frames}, {20_000, 10_000, 0})
        limited = len([frame for frame in frames if x_of(frame) == 20_000])
        self.assertLess(limited, 8, frames)
        self.assertGreaterEqual(limited + self.spare.slack / 0.1, 4, frames)  # one that is held up leaves out a turn
        _, err = self.interrupt(operator)
        self.assertRegex(err, "[0-9]+ set points? passed on, [0-9]+ set points? limited")

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
        self.assertRegex(err, r"replay: operator halt \(process [0-9]+\) limits motors\.x to at most 0\.02 m/s\n")
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
        operator = self.operate(document=GUARDED)
        for command, topic in ((("travel", "1cm"), "travel"), (("behave", "follow", "--for", "1s"), "follow")):
            _, err = self.run_tool(*command, code=1)
            self.assertIn(f"operator halt is in driving, where {command[0]} may not command {topic}", err)
        _, err = self.run_tool("behave", "none")
        self.assertRegex(err, r"behave: operator halt \(process [0-9]+\) guards the robot")
        self.run_tool("operator", "switch", "slow")
        self.event(operator, "switched")  # it may follow when the start is over
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
            # By the clock of the bus: of two, the first may have got there late.
            self.assertLessEqual(x_of(b) - x_of(a), 20_000 * (after - before + self.spare.slack) + 1500)
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
                why = "does not answer" if number == signal.SIGSTOP else "has ended"
                self.assertRegex(err, rf"operator halt \(process [0-9]+\) {why}")
                self.assertEqual(x_of(self.frames(listener)[-1][1]), 0)
                if number == signal.SIGSTOP:
                    _, err = self.run_tool("operator", "status", code=1)
                    self.assertIn("does not answer", err)
                    _, err = self.run_tool("drive", "stop", code=1)
                    self.assertRegex(err, r"operator on \S+ \(process [0-9]+\) does not answer\n +`amiroctl stop` reaches the robot past it; was it stopped")
                    self.run_tool("stop")
                    operator.kill()
                operator.wait()

    def test_a_request_that_waits_is_met_replaced_or_said_to_be_dropped(self):
        """The guard of the examples leaves `stopped` as soon as the way is clear, which goes before a request."""
        self.start_sim()
        with open(os.path.join(SOURCE, "examples", "guard.operator.json"), encoding="utf-8") as file:
            document = json.load(file)
        begin = time.monotonic()
        self.run_tool("list")
        # In s. The tool starts three times in it; with a longer one the guard's streams cannot be admitted.
        change = min(8, 1 + math.ceil(8 * (time.monotonic() - begin)))
        document["settle"] = f"{change}s"
        document["monitors"][0]["when"]["any"][4]["above"] = f"{2 * change}s"  # a change takes so long
        operator = self.operate(document=document)
        time.sleep(change)  # of a change
        self.run_tool("operator", "switch", "driving")
        self.assertIn("in driving already", self.run_tool("operator", "switch", "driving")[0])
        self.assertRegex(self.run_tool("operator", "switch", "idle")[0], "^idle follows when the last change is over, unless another")
        self.run_tool("operator", "switch", "driving")
        self.assertIsNone(json.loads(self.run_tool("operator", "status", "--json")[0])["requested"])
        self.run_tool("operator", "switch", "stopped")
        self.assertEqual(self.event(operator, "switched")["to"], "driving")
        self.assertEqual(self.event(operator, "switched")["to"], "stopped")
        self.assertIn("idle follows", self.run_tool("operator", "switch", "idle")[0])
        self.assertEqual(self.event(operator, "switched")["to"], "driving")
        self.assertEqual(self.event(operator, "request_dropped")["configuration"], "idle")

    def test_an_operator_that_is_slow_is_waited_for(self):
        self.start_sim()
        operator = self.operate(document=GUARDED)
        operator.send_signal(signal.SIGSTOP)
        asked = self.start("operator", "status")
        time.sleep(0.3)  # of a second
        operator.send_signal(signal.SIGCONT)
        out, err = asked.communicate(timeout=30)
        self.assertEqual(asked.returncode, 0, err)
        self.assertIn("halt", out)

    def test_an_operator_that_is_stopped_or_killed_leaves_no_travel_behind(self):
        self.start_sim()
        document = json.loads(json.dumps(GUARDED))
        document["configurations"][0]["commanders"] = ["travel"]
        for number in (signal.SIGSTOP, signal.SIGKILL):
            with self.subTest(signal=number):
                operator = self.operate(document=document)
                listener = self.raw_frames("travel")
                travel = self.start("travel", "90cm", "--speed", "2cm/s")
                self.event(operator, "commanded")
                operator.send_signal(number)
                _, err = self.interrupt(travel)
                self.assertEqual([frame for _, frame in self.frames(listener)][-1], "20B#0000000000000000", err)
                waiting.until(lambda: json.loads(self.run_tool("once", "behaviour")[0])["fields"]["active"] in (0, "none"), "it has ended")
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

    def test_on_an_adapter_it_is_found_by_every_name_of_the_device(self):
        played = self.adapter()
        operator = self.operate(bus=f"slcan:{played.path}")
        link = os.path.join(self.folder, "adapter")
        os.symlink(played.path, link)
        for name in (played.path, f"{played.path}@500k", link, f"{link}@500k"):
            out, _ = self.run_tool("--bus", f"slcan:{name}", "operator", "status", "--json")
            self.assertEqual(json.loads(out)["operator"], "halt", name)
        other = os.path.join(self.folder, "other")
        _, err = self.run_tool("--bus", f"slcan:{other}", "operator", "status", code=1)
        self.assertIn(f"no operator of yours runs on slcan:{other}", err)
        self.interrupt(operator)

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
            client.settimeout(60)
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


if __name__ == "__main__":
    main()
