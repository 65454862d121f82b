"""amiroctl doctor: what it finds on a simulated robot, and that it leaves the robot as it was."""

import contextlib
import fcntl
import json
import os
import signal
import struct
import termios
import time

from harness import Case, main

QUICK = ("--listen", "200ms", "--patience", "2s")  # boards that all answer are not waited for


class Doctor(Case):
    def examine(self, *arguments, code):
        out, _ = self.run_tool("doctor", "--json", *QUICK, *arguments, code=code)
        return json.loads(out)

    def what(self, report):
        return [(f["severity"], f["board"], f["what"]) for f in report["findings"]]

    def test_it_listens_for_a_second(self):
        self.start_sim()
        begin = time.monotonic()
        self.run_tool("doctor", "--patience", "2s")
        self.assertGreaterEqual(time.monotonic() - begin, 1)
        self.assertRegex(self.run_tool("doctor", "--help")[0], "--listen T=1s +.*\n +--patience T=500ms ")

    def test_a_robot_that_is_well(self):
        self.start_sim()
        out, _ = self.run_tool("doctor", *QUICK)
        rows = out.splitlines()
        self.assertEqual([row.split()[0] for row in rows[1:4]], ["di_wheel_drive", "power_management", "light_ring"])
        for row in rows[1:4]:
            self.assertIn("power", row)
            self.assertIn("same", row)
            self.assertIn("active", row)
        self.assertEqual(rows[4:7], ["battery 90 %", "battery_1 4.020 V, -0.116 A, 502 mAh left, 25.1 degC",
                                     "battery_2 4.020 V, -0.116 A, 502 mAh left, 25.1 degC"])
        self.assertEqual(rows[-1], "all is well")

    def test_a_board_that_is_off(self):
        self.start_sim("--without", "power_management")
        report = self.examine(code=1)
        self.assertEqual(self.what(report), [("problem", "power_management", "does not answer")])
        self.assertEqual([b["answers"] for b in report["boards"]], [True, False, True])
        self.assertIsNone(report["battery_percent"])
        self.assertEqual(report["batteries"], [])

    def test_a_board_that_does_not_answer_is_asked_twice(self):
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        listener = self.listen("--commands", "--timeout", "60s")
        self.run_tool("doctor", "--listen", "1ms", "--patience", "1ms", code=1)
        self.run_tool("send", "123#")  # behind all that was asked
        asked = []
        while not asked or asked[-1] != "123":
            asked.append(json.loads(listener.stdout.readline())["id"])
        self.assertEqual(asked, ["31B", "339", "357"] * 2 + ["123"])

    def test_it_ends_when_all_that_can_answer_have(self):
        """It waits for no board of a spec without statuses."""
        sim = self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        car = os.path.join(os.environ["OCM_SOURCE_DIR"], "examples", "small_car.dbc")
        out, _ = self.run_tool("--spec", car, "doctor", "--listen", "1ms", "--patience", "1h")
        self.assertEqual(out.splitlines()[-1], "nothing came, and nothing was due: --listen T listens longer")
        self.interrupt(sim)
        self.start_sim()
        out, _ = self.run_tool("doctor", "--listen", "200ms", "--patience", "1h")
        self.assertEqual(out.splitlines()[-1], "all is well")

    def test_no_board_answers(self):
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        report = self.examine(code=1)
        self.assertEqual(self.what(report), [("problem", "", "no board answers")])
        self.assertIn("500000 bit/s", report["findings"][0]["remedy"])

    def test_another_spec(self):
        self.start_sim()
        spec = os.path.join(self.folder, "spec.json")
        with open(os.path.join(os.environ["OCM_SOURCE_DIR"], "spec/topics.json"), encoding="utf-8") as source:
            text = source.read()
        with open(spec, "w", encoding="utf-8") as file:
            file.write(text.replace('"scale": 0.0175', '"scale": 0.035'))
        out, _ = self.run_tool("--spec", spec, "doctor", "--json", *QUICK, code=1)
        report = json.loads(out)
        self.assertEqual([w[:2] for w in self.what(report)],
                         [("problem", b["board"]) for b in report["boards"]])
        self.assertIn("another spec", report["findings"][0]["what"])

    def test_refusals_and_their_reason(self):
        self.start_sim()
        self.run_tool("send", "208#03")
        self.run_tool("send", "208#01000000")
        report = self.examine(code=0)  # a note is no illness
        self.assertEqual(self.what(report), [
            ("note", "di_wheel_drive", "2 requests refused so far, the last for gyroscope: bad_period")])

    def test_a_refusal_is_told_unasked(self):
        self.start_sim()
        listener = self.listen("di_wheel_drive_refusal", "-n", "1")
        self.run_tool("send", "201#01")
        out, _ = listener.communicate(timeout=60)
        self.assertEqual(json.loads(out)["fields"],
                         {"topic": 1, "reason": 3, "refused": 1, "not_sampled": 0, "line_lost": 0})

    def test_what_is_published_goes_on(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "20ms")
        self.run_tool("publish", "di_wheel_drive_status", "100ms")
        self.run_tool("publish", "power", "100ms")
        report = self.examine(code=0)
        publishing = {b["board"]: b["publishing"] for b in report["boards"]}
        self.assertEqual(publishing["di_wheel_drive"], "gyroscope, di_wheel_drive_status")
        self.assertEqual(report["battery_percent"], 90)
        self.assertEqual(report["batteries"][1], {"battery": "battery_2", "present": True, "voltage_v": 4.02, "current_a": -0.116,
                                                  "remaining_mah": 502, "temperature_celsius": 25.05})
        publishing = {b["board"]: b["publishing"] for b in self.examine(code=0)["boards"]}
        self.assertEqual(publishing["di_wheel_drive"], "gyroscope, di_wheel_drive_status")
        self.assertEqual(publishing["power_management"], "power_status")

    def test_strangers_on_the_bus(self):
        self.start_sim()
        doctor = self.start("doctor", "--json", "--listen", "10s", "--patience", "5s")  # while two programs start
        self.assertIn("bus: sim", doctor.stderr.readline())
        self.settle()
        self.run_tool("send", "7FF#00")
        self.run_tool("send", "608#00")
        out, _ = doctor.communicate(timeout=60)
        self.assertEqual(doctor.returncode, 1)
        self.assertEqual([w[2] for w in self.what(json.loads(out))],
                         ["1 frame that the spec does not know", "1 frame of a wrong length"])

    def hash_of_spec(self):
        return json.loads(self.run_tool("doctor", "--json", "--listen", "1ms", "--patience", "1ms", code=1)[0])["wire_hash"]

    def statuses(self, wire_hash, boards):
        """What boards say of themselves, and a battery: lines for `send --stdin`."""
        number = bytes.fromhex(wire_hash[2:])[::-1].hex()
        lines = []
        for identity, (uptime, reset, load, bus, publishing) in zip((0x71B, 0x739, 0x757), boards):
            lines += [f"{identity:03X}#{uptime.to_bytes(3, 'little').hex()}{reset:02x}{number}", f"{identity + 1:03X}#{load:02x}{bus:02x}{publishing:02x}0000000000",
                      f"{identity + 2:03X}#0000000000000000"]
        battery = struct.pack("<HhHH", 4020, 116, 502, 2982).hex()
        return "\n".join((*lines, "61E#01570000FF00", f"72B#{battery}", "72C#0000000000000000")) + "\n"

    def test_a_whole_page(self):
        """Boards that are played: how long each is up, why it started, and what it does; a battery, and the place of one."""
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        wire_hash = self.hash_of_spec()
        for boards, rows in (
                (((119, 1, 0, 0, 0), (7199, 4, 89, 1, 1), (172_799, 9, 255, 2, 0)),
                 ("di_wheel_drive    119 s       power      same       0 %  active   -",
                  "power_management  119 min     watchdog   same      89 %  warning  power_status",
                  "light_ring        47 h 59 min  usage_fault  same         -  passive  -")),
                (((120, 77, 5, 3, 0), (7200, 0, 5, 77, 0), (172_800, 2, 5, 0, 0)),
                 ("di_wheel_drive    2 min       ?          same       5 %  off      -",
                  "power_management  2 h 0 min   unknown    same       5 %  ?        -",
                  "light_ring        2 d 0 h     pin        same       5 %  active   -"))):
            doctor = self.start("doctor", "--listen", "1ms", "--patience", "30s")
            self.assertIn("bus: sim", doctor.stderr.readline())
            self.settle()
            self.run_tool("send", "--stdin", stdin=self.statuses(wire_hash, boards))
            lines = doctor.communicate(timeout=60)[0].splitlines()
            self.assertEqual(lines[:7], ["BOARD             UP          RESET      SPEC      LOAD  BUS      PUBLISHES", *rows, "battery 87 %, charger plugged in",
                                         "battery_1 4.020 V, +0.116 A, 502 mAh left, 25.1 degC", "battery_2 not inserted"])
            self.assertEqual(lines[7], "")

    def test_what_does_not_answer_is_named_in_json(self):
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        doctor = self.start("doctor", "--json", "--listen", "1ms", "--patience", "30s")
        self.assertIn("bus: sim", doctor.stderr.readline())
        self.settle()
        text = self.statuses(self.hash_of_spec(), ((1, 1, 0, 0, 0), (1, 1, 0, 0, 2), (1, 1, 0, 0, 0)))
        # Bit 0 and 1 of power_management: the first of its sensors is published, the second does not answer.
        self.run_tool("send", "--stdin", stdin=text.replace("73A#0000020000000000", "73A#0000010200000000"))
        out, _ = doctor.communicate(timeout=60)
        boards = {board["board"]: (board["publishing"], board["faults"]) for board in json.loads(out)["boards"]}
        self.assertEqual(boards["di_wheel_drive"], ("", ""))
        self.assertEqual(boards["power_management"], ("power_status", "proximity_ring"))

    def test_messages_that_are_due(self):
        """Of a spec without statuses: what came, of what should have come three times."""
        spec = os.path.join(os.environ["OCM_SOURCE_DIR"], "examples", "small_car.dbc")
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        for listen, code, last in (("29ms", 0, "nothing came, and nothing was due: --listen T listens longer"),
                                   ("30ms", 1, "is the sender switched on and on this bus? `amiroctl stats` measures every period")):
            out, _ = self.run_tool("--spec", spec, "doctor", "--listen", listen, code=code)
            self.assertEqual(out.splitlines()[-1].strip(), last)
        self.assertIn("warning  EngineControl: of 1 message due in 30ms nothing came of Engine\n", out)
        out, _ = self.run_tool("--spec", spec, "doctor", "--listen", "60ms", code=1)
        self.assertIn("warning  Brakes: of 2 messages due in 60ms nothing came of Wheels, Driving\n", out)
        self.assertRegex(out, r"(?m)^Brakes +has no status in this spec$")

    def on_a_terminal(self, columns, *arguments, code=0):
        """The lines that it shows on one that is so wide."""
        ours, theirs = os.openpty()
        self.addCleanup(os.close, ours)
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
        doctor = self.start(*arguments, stdout=theirs)
        os.close(theirs)
        shown = b""
        with contextlib.suppress(OSError):  # the other end is closed
            while piece := os.read(ours, 4096):
                shown += piece
        _, err = doctor.communicate(timeout=60)
        self.assertEqual(doctor.returncode, code, err)
        return shown.decode().replace("\r\n", "\n").splitlines()

    def test_what_a_terminal_has_no_room_for_goes_on_below_its_text(self):
        spec = os.path.join(os.environ["OCM_SOURCE_DIR"], "examples", "small_car.dbc")
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        doctor = ("--no-color", "--spec", spec, "doctor", "--listen")
        lines = self.on_a_terminal(40, *doctor, "1ms")
        self.assertEqual(lines[:2], [f"{'BOARD':<14}  {'UP':<10}  RESET", "    SPEC      LOAD  BUS      PUBLISHES"])
        self.assertEqual(lines[-2:], ["nothing came, and nothing was due:", "--listen T listens longer"])
        lines = self.on_a_terminal(40, *doctor, "30ms", code=1)
        self.assertEqual(lines[-5:], ["warning  EngineControl: of 1 message due", "         in 30ms nothing came of Engine", "         is the sender switched on and",
                                      "         on this bus? `amiroctl stats`", "         measures every period"])

    def test_rows_of_boards_and_batteries_go_on_below_them(self):
        self.start_sim()
        lines = self.on_a_terminal(40, "--no-color", "doctor", *QUICK)
        for row, board in ((2, "di_wheel_drive"), (4, "power_management"), (6, "light_ring")):
            self.assertRegex(lines[row], rf"^{board} +\d+ s +power$")
            self.assertRegex(lines[row + 1], "^    same .* active   -$")
        self.assertEqual(lines[8:11], ["battery 90 %", "battery_1 4.020 V, -0.116 A, 502 mAh", "    left, 25.1 degC"])

    def many(self):
        """A spec of six messages that a board sends every 10 ms."""
        path = os.path.join(self.folder, "many.dbc")
        with open(path, "w", encoding="utf-8") as file:
            file.write("BU_: A\n" + "".join(f'BO_ {number} M{number}: 8 A\n SG_ X : 0|8@1+ (1,0) [0|0] "" A\n' for number in range(1, 7)) +
                       '\nBA_DEF_ BO_ "GenMsgCycleTime" INT 0 10000;\nBA_DEF_DEF_ "GenMsgCycleTime" 10;\n')
        return path

    def test_of_many_messages_the_first_are_named(self):
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        out, _ = self.run_tool("--spec", self.many(), "doctor", "--listen", "30ms", code=1)
        self.assertIn("warning  A: of 6 messages due in 30ms nothing came of M1, M2, M3, M4 and 2 more\n", out)

    def test_a_message_that_comes_is_not_missing(self):
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        many = self.many()
        for number in (1, 2, 4):
            sender = self.start("--spec", many, "set", f"M{number}", "--every", "2ms")
            self.assertIn("bus: sim", sender.stderr.readline())
        for _ in range(5):  # on a busy machine one of them may not run for so long
            report = json.loads(self.run_tool("--spec", many, "doctor", "--json", "--listen", "300ms", code=1)[0])
            if self.what(report) == [("warning", "A", "of 6 messages due in 300ms nothing came of M3, M5, M6")]:
                return
        self.fail(report)

    def test_a_message_of_can_fd_that_comes_is_not_missing(self):
        spec = os.path.join(self.folder, "fd.dbc")
        with open(spec, "w", encoding="utf-8") as file:
            file.write('BU_: A\nBO_ 1 Long: 64 A\n SG_ X : 0|8@1+ (1,0) [0|0] "" A\n\n'
                       'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 10000;\nBA_DEF_DEF_ "GenMsgCycleTime" 10;\n')
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        sender = self.start("--spec", spec, "set", "Long", "--every", "10ms")
        self.assertIn("bus: sim", sender.stderr.readline())
        self.run_tool("--spec", spec, "listen", "Long", "-n", "1", "--timeout", "60s", timeout=90)  # it sends
        out, _ = self.run_tool("--spec", spec, "doctor", "--listen", "500ms", "--json")
        self.assertEqual(self.what(json.loads(out)), [])
        for _ in range(50):  # on a busy machine it may not come in so short a time
            out, _ = self.run_tool("--spec", spec, "doctor", "--listen", "29ms")  # it is due three times in 30 ms
            if "nothing came" not in out:
                break
        self.assertEqual(out.splitlines()[-1], "no message was due meanwhile: --listen T listens longer; of the boards this spec says nothing")
        for _ in range(20):
            process = self.start("--spec", spec, "doctor", "--listen", "200ms")
            out, _ = process.communicate(timeout=60)
            if process.returncode == 0:
                break
        self.assertEqual(out.splitlines()[-1], "all messages came that were due; of the boards this spec says nothing")

    def test_a_board_that_sends_and_does_not_say_how_it_is(self):
        self.start_sim("--without", "di_wheel_drive,power_management,light_ring")
        for _ in range(20):  # on a busy machine the frame may come too late
            doctor = self.start("doctor", "--listen", "300ms", "--patience", "1ms")
            self.assertIn("bus: sim", doctor.stderr.readline())
            self.run_tool("send", "608#000000000000")
            out, _ = doctor.communicate(timeout=60)
            self.assertEqual(doctor.returncode, 1)
            if "no board answers" not in out:
                break
        self.assertEqual(out.splitlines()[1:4], ["di_wheel_drive    sends, but has no status", "power_management  -", "light_ring        -"])
        self.assertIn("warning  di_wheel_drive: sends, and does not say how it is\n         it runs a firmware without a status; flash the present one\n", out)

    def test_ctrl_c_ends_it(self):
        self.start_sim()
        doctor = self.start("doctor", "--listen", "1h")
        self.assertIn("bus: sim", doctor.stderr.readline())
        self.settle()
        out, _ = self.interrupt(doctor)
        self.assertEqual(doctor.returncode, 128 + signal.SIGINT)
        self.assertEqual(out, "")

    def test_wrong_usage(self):
        _, err = self.run_tool("doctor", "--listen", "soon", code=2)
        self.assertIn("--listen soon: not a time", err)


if __name__ == "__main__":
    main()
