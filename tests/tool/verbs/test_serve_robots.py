"""amiroctl serve robots: mappers behind a central as viewers meet them, on a central that is played on a pseudo terminal."""

import base64
import fcntl
import glob
import json
import math
import os
import re
import resource
import signal
import socket
import sys
import time

import websocket
from harness import Case, main, sanitized, waiting
from played_central import Central, Owner, Robot

STARTS = ("--start", "AVR=0.4,0.5,0", "--start", "Arduino=0.8,0.5,90")


class Robots(Case):
    """Two robots in a room of 1.2 m x 1 m, at places that the options say."""

    def setUp(self):
        super().setUp()
        self.avr = Robot("AVR", pose=(0.4, 0.5, 0.0))
        self.arduino = Robot("Arduino", pose=(0.8, 0.5, math.pi / 2))
        self.central = Central(self.folder, [self.avr, self.arduino], link="ocm/central")
        self.addCleanup(self.central.close)

    def serve(self, *arguments, words=("robots",), starts=STARTS, scan=("--scan", "200ms")):
        server = self.start("serve", *words, "--port", "0", *scan, *starts, *arguments)
        line = server.stdout.readline()
        self.assertRegex(line, r"^http://127.0.0.1:\d+/(#[0-9a-f]{32})?\n$", server.poll())
        address, _, token = line.strip().partition("#")
        return server, int(re.search(r":(\d+)/", address)[1]), token

    def viewer(self, port, token="", *topics):
        viewer = websocket.Viewer(port, f"/?token={token}" if token else "/", timeout=30)
        self.addCleanup(viewer.close)
        if topics:
            viewer.subscribe(*topics)
        return viewer

    def state(self, viewer, test, what, topic="/ocm/fleet"):
        end = time.monotonic() + 60
        while time.monotonic() < end:
            message = viewer.message(topic)
            self.assertIsNotNone(message, what)
            if test(message.fields):
                return message.fields
        return self.fail(f"{what}: not within 60 s")

    def robot(self, viewer, name, test, what):
        def found(state):
            return next((robot for robot in state["robots"] if robot["robot"] == name), None)

        return found(self.state(viewer, lambda state: found(state) and test(found(state)), what))

    def both(self, *arguments):
        """A server that takes orders, and a viewer that gives them; both robots are there."""
        server, port, token = self.serve("--allow-commands", *arguments)
        viewer = self.viewer(port, token, "/ocm/fleet")
        self.state(viewer, lambda s: len(s["robots"]) == 2 and all(robot["at"] for robot in s["robots"]), "two robots with places")
        return server, port, token, viewer

    def says(self, viewer, words):
        while True:
            status = viewer.text("status")
            self.assertIsNotNone(status, words)
            if words in status["message"]:
                return status

    @staticmethod
    def cells(grid):
        data = base64.b64decode(grid["data"])
        return grid["column_count"], data

    # --- what is seen ---

    def assert_origins_are_told(self):
        """To a program that joins the line."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as caller:
            caller.settimeout(30)
            caller.connect(glob.glob(os.path.join(self.folder, "ocm", "line-*.sock"))[0])
            caller.send(b"hello 1 stranger")
            self.assertEqual(caller.recv(65536), b"ok\nserve")
            caller.send(b"robots 0")
            rows = [row for row in caller.recv(65536).decode().splitlines() if row.startswith("index=")]
        robots = [dict(field.split("=", 1) for field in row.split("\t")) for row in rows]
        self.assertEqual([(robot["name"], robot["origin_known"]) for robot in robots], [("AVR", "1"), ("Arduino", "1")])
        for robot, start in zip(robots, ((0.4, 0.5, 0), (0.8, 0.5, math.pi / 2))):
            for value, expected in zip(robot["origin"].split(","), start):
                self.assertAlmostEqual(float(value), expected, delta=0.02)

    def test_robots_and_their_map(self):
        self.avr.room = self.arduino.room = (0.0, 0.0, 2.4, 1.0)
        _, port, token = self.serve()
        self.assertEqual(token, "")
        viewer = self.viewer(port, "", "/ocm/robot", "/ocm/fleet", "/ocm/map")
        robot = viewer.message("/ocm/robot").fields
        self.assertEqual((robot["topics"], robot["boards"], robot["live"]), ([], [], True))
        avr = self.robot(viewer, "AVR", lambda r: r["at"], "a place")
        self.assertEqual((avr["state"], avr["quality"], avr["linked"], avr["body"]["width_cm"]), ("idle", 1.0, True, 20))
        self.assertAlmostEqual(avr["at"]["x_m"], 0.4, delta=0.02)
        self.assertAlmostEqual(avr["at"]["y_m"], 0.5, delta=0.02)
        arduino = self.robot(viewer, "Arduino", lambda r: r["at"], "a place")
        self.assertAlmostEqual(arduino["at"]["x_m"], 0.8, delta=0.02)
        self.assertAlmostEqual(arduino["at"]["heading_rad"], math.pi / 2, delta=0.03)
        schema = viewer.channels["/ocm/map"]
        self.assertEqual((schema["schemaName"], json.loads(schema["schema"])["title"]), ("foxglove.Grid", "foxglove.Grid"))

        def walls(grid):
            """Along the left wall something is occupied, and the robot stands on what is free."""
            columns, cells = self.cells(grid)
            side, left, low = grid["cell_size"]["x"], grid["pose"]["position"]["x"], grid["pose"]["position"]["y"]

            def cell(x, y):
                return cells[int((y - low) / side) * columns + int((x - left) / side)]

            return cell(0.4, 0.5) == 1 and any(cell(x, 0.3 + y * side) == 2 for x in (-0.02, 0.02) for y in range(10))

        first = self.state(viewer, walls, "the wall", "/ocm/map")
        self.assertEqual(set(first), {"timestamp", "frame_id", "pose", "column_count", "cell_size", "row_stride", "cell_stride", "fields", "data"})
        free = self.cells(first)[1].count(1)
        self.run_tool("goto", "AVR", "0", "100")  # which sees more from there
        grid = self.state(viewer, lambda grid: self.cells(grid)[1].count(1) > free + 100, "more of the map", "/ocm/map")
        self.assertTrue(walls(grid))
        # Who comes later has the newest at once.
        late = self.viewer(port, "", "/ocm/map")
        self.assertGreater(self.cells(late.message().fields)[1].count(1), 0)

    def test_a_bad_link_is_seen(self):
        self.avr.bad_beyond_cm = -1
        _, port, _ = self.serve()
        viewer = self.viewer(port, "", "/ocm/fleet")
        robot = self.robot(viewer, "AVR", lambda r: r["call_back"] and r["quality"] < 0.7, "the bad link")
        self.assertEqual(robot["call_back"], "bad_link")

    def test_a_world_says_where_robots_began_and_how_far_the_central_reaches(self):
        """From 0.8 m, 0.5 m it reaches 0.4 m: less far than where the first robot began, and than the map's beginning."""
        world = os.path.join(self.folder, "box.json")
        with open(world, "w", encoding="utf-8") as file:
            json.dump({"name": "box", "walls": [[[0, 0], [1.2, 0], [1.2, 1.0], [0, 1.0], [0, 0]]], "central": {"at": [0.8, 0.5], "range": 0.4},
                       "robots": [{"name": "AVR", "model": "avr", "at": [0.4, 0.5], "heading": 0},
                                  {"name": "Arduino", "model": "arduino", "at": [0.8, 0.5], "heading": 90}]}, file)
        _, port, _ = self.serve("--world", world, starts=())
        viewer = self.viewer(port, "", "/ocm/fleet")
        self.state(viewer, lambda s: [robot["call_back"] for robot in s["robots"]] == ["far_away", None] and all(robot["at"] for robot in s["robots"]),
                   "that the first is too far away, and the second is not")

    def test_where_robots_began_must_be_known(self):
        _, port, token = self.serve("--allow-commands", starts=())
        viewer = self.viewer(port, token, "/ocm/fleet")
        state = self.state(viewer, lambda s: len(s["robots"]) == 2, "two robots")
        self.assertEqual(state["unplaced"], ["AVR", "Arduino"])
        self.assertIsNone(state["robots"][0]["at"])
        self.robot(viewer, "AVR", lambda r: r["pose"], "its own place")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 1, "y_m": 0})
        self.says(viewer, "--start AVR=X,Y,DEG")
        # Nothing can be drawn, and there is no map, though one is looked for each second.
        late = self.viewer(port, "", "/ocm/map", "/ocm/fleet")
        self.assertEqual({late.message().topic for _ in range(8)}, {"/ocm/fleet"})

    def test_one_robot_needs_no_start(self):
        self.central.robots = [self.avr]
        _, port, _ = self.serve(starts=())
        viewer = self.viewer(port, "", "/ocm/fleet", "/ocm/map")
        robot = self.robot(viewer, "AVR", lambda r: r["at"], "a place")
        self.assertAlmostEqual(robot["at"]["x_m"], 0, delta=0.02)
        self.state(viewer, lambda grid: 1 in self.cells(grid)[1], "a map", "/ocm/map")

    def test_a_look_finds_a_robot_that_was_switched_on_later(self):
        self.central.robots = [self.avr]
        _, port, token = self.serve("--allow-commands", starts=(), scan=("--scan", "1s"))
        viewer = self.viewer(port, token, "/ocm/fleet")
        state = self.state(viewer, lambda s: len(s["robots"]) == 1 and s["robots"][0]["at"], "one robot, whose start need not be known")
        self.assertEqual((state["unplaced"], state["scans"]), ([], False))
        self.central.robots = [self.avr, self.arduino]
        viewer.publish("/ocm/fleet", {"order": "look"})
        self.robot(viewer, "Arduino", lambda r: r["linked"], "a link to it")
        state = self.state(viewer, lambda s: not s["scans"] and len(s["unplaced"]) == 2, "that of two robots the starts must be known")
        self.assertEqual(state["unplaced"], ["AVR", "Arduino"])

    def test_where_a_robot_began_that_a_look_finds_is_told_to_who_joins(self):
        self.central.robots = [self.avr]
        _, port, token = self.serve("--allow-commands")
        viewer = self.viewer(port, token, "/ocm/fleet")
        self.robot(viewer, "AVR", lambda r: r["linked"], "a link to the first")
        self.central.robots = [self.avr, self.arduino]
        viewer.publish("/ocm/fleet", {"order": "look"})
        self.robot(viewer, "Arduino", lambda r: r["linked"], "a link to the second")
        self.assert_origins_are_told()

    def test_a_robot_that_begins_again_is_where_it_stands(self):
        """Its start was that of its first handshake; from another one on its pose begins at 0 there."""
        _, _, _, viewer = self.both()
        self.run_tool("goto", "AVR", "0", "20")
        self.robot(viewer, "AVR", lambda r: r["at"]["x_m"] > 0.55, "its new place")
        self.avr.start = (self.avr.x, self.avr.y, self.avr.heading)
        self.avr.confirmed = False
        waiting.until(lambda: self.avr.confirmed, "an answer to its handshake")
        for _ in range(10):
            self.assertGreater(self.robot(viewer, "AVR", lambda r: r["at"], "its place")["at"]["x_m"], 0.55)

    def test_a_robot_that_a_look_finds_and_that_cannot_be_linked_is_named(self):
        self.central.robots = [self.avr]
        _, port, token = self.serve("--allow-commands", starts=())
        viewer = self.viewer(port, token, "/ocm/fleet")
        self.state(viewer, lambda s: len(s["robots"]) == 1 and s["robots"][0]["at"], "one robot")
        self.arduino.reachable = False
        self.central.robots = [self.avr, self.arduino]
        viewer.publish("/ocm/fleet", {"order": "look"})
        self.says(viewer, "the central refuses Arduino: no link to 1")

    def test_a_look_takes_three_seconds_unless_told_otherwise(self):
        """The program that has the line is played: it hears for how long the central is to look."""
        owner = Owner(os.path.join(self.folder, "ocm"), self.central.path)
        self.addCleanup(owner.close)
        for scan, look in (((), "scan 3000"), (("--scan", "700ms"), "scan 700")):
            owner.heard.clear()
            server, port, token = self.serve("--allow-commands", scan=scan)
            viewer = self.viewer(port, token, "/ocm/fleet")
            self.state(viewer, lambda state: state["line"].startswith("played ") and not state["scans"], "it has joined")
            self.assertEqual(owner.looks(), [])
            viewer.publish("/ocm/fleet", {"order": "look"})
            waiting.until(owner.looks, "it looks")
            self.assertEqual(owner.looks(), [look])
            self.interrupt(server)

    # --- what is asked ---

    def test_a_click_sends_a_robot(self):
        _, _, _, viewer = self.both()
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.6, "y_m": 0.5})
        robot = self.robot(viewer, "AVR", lambda r: r["target"], "its target")
        self.assertEqual(robot["target"], {"x_m": 0.6000000238418579, "y_m": 0.5} if robot["target"]["x_m"] != 0.6 else {"x_m": 0.6, "y_m": 0.5})
        self.says(viewer, "AVR is there")
        robot = self.robot(viewer, "AVR", lambda r: r["target"] is None, "the end")
        self.assertAlmostEqual(robot["at"]["x_m"], 0.6, delta=0.03)
        self.assertIn("{U,0,20}", self.avr.heard)
        self.assertFalse(any(line.startswith("{U,") for line in self.arduino.heard))
        # By its index, in its own frame turned by 90 degrees.
        viewer.publish("/ocm/fleet", {"robot": 1, "x_m": 0.8, "y_m": 0.6})
        self.says(viewer, "Arduino is there")
        self.assertIn("{U,0,10}", self.arduino.heard)

    def test_another_place_on_the_way(self):
        _, _, _, viewer = self.both()
        self.avr.speed = 5
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.7, "y_m": 0.5})
        waiting.until(lambda: "{U,0,29}" in self.avr.heard or "{U,0,30}" in self.avr.heard, "it drives")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.7, "y_m": 0.6})
        waiting.until(lambda: "{U,0,0}" in self.avr.heard, "it is stopped")
        self.avr.busy_until = 0
        self.says(viewer, "AVR is there")
        self.assertAlmostEqual(self.avr.y, 0.6, delta=0.04)

    def test_pause_go_on_call_back_stop(self):
        _, _, _, viewer = self.both()
        viewer.publish("/ocm/fleet", {"robot": "AVR", "order": "pause"})
        self.says(viewer, "AVR is paused")
        self.assertTrue(self.avr.paused)
        self.robot(viewer, "AVR", lambda r: r["state"] == "paused", "the pause")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "order": "go_on"})
        self.says(viewer, "AVR goes on")
        self.assertFalse(self.avr.paused)
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.6, "y_m": 0.6})
        self.says(viewer, "AVR is there")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "order": "call_back"})
        self.says(viewer, "AVR is there")
        self.assertAlmostEqual(self.avr.x, 0.4, delta=0.04)
        self.assertAlmostEqual(self.avr.y, 0.5, delta=0.04)
        self.avr.speed = 1
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.6, "y_m": 0.5})
        waiting.until(lambda: self.avr.heard[-1] not in ("{U,0,0}",) and self.avr.busy_until > time.monotonic() + 2, "it drives")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "order": "stop"})
        waiting.until(lambda: self.avr.heard[-1] == "{U,0,0}", "the stop")

    def test_what_is_wrong_is_said(self):
        _, port, token, viewer = self.both()
        for order, words in (({"robot": "Missing", "order": "stop"}, "no robot 'Missing'; it has AVR, Arduino"), ({"robot": "AVR"}, "expected a robot with a place"),
                             ({"robot": "AVR", "order": "fly"}, "unknown order 'fly'"), ({"robot": "AVR", "x_m": 5000, "y_m": 0}, "is no place")):
            viewer.publish("/ocm/fleet", order)
            self.says(viewer, words)
        only_looks = self.viewer(port, "")
        only_looks.publish("/ocm/fleet", {"robot": "AVR", "order": "stop"})
        self.assertIn("may only look", only_looks.text("status")["message"])
        viewer.publish("/motors", {"x": 1})
        self.says(viewer, "there is no bus")

    def test_a_page_that_goes_away_stops_what_it_sent(self):
        _, port, token, viewer = self.both()
        self.avr.speed = self.arduino.speed = 1
        second = self.viewer(port, token)
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.7, "y_m": 0.5})
        second.publish("/ocm/fleet", {"robot": "Arduino", "x_m": 0.8, "y_m": 0.7})
        for robot in (self.avr, self.arduino):
            waiting.until(lambda: any(line.startswith("{U,") for line in robot.heard), "they drive")
        before = len(self.arduino.heard)
        viewer.close()
        waiting.until(lambda: self.avr.heard[-1] == "{U,0,0}", "its robot is stopped")
        self.assertNotIn("{U,0,0}", self.arduino.heard[before:])

    def test_a_page_whose_computer_is_off_stops_what_it_sent(self):
        """Nothing closes its connection, and nothing answers. The other page only looks, and answers."""
        _, port, token, viewer = self.both()
        self.avr.speed = self.arduino.speed = 1
        off = self.viewer(port, token)
        off.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.7, "y_m": 0.5})
        viewer.publish("/ocm/fleet", {"robot": "Arduino", "x_m": 0.8, "y_m": 0.7})
        sent = time.monotonic()
        self.says(viewer, "does not answer: what it sent is stopped")  # it answers meanwhile
        self.assertGreater(time.monotonic() - sent, 1.9)
        waiting.until(lambda: self.avr.heard[-1] == "{U,0,0}", "its robot is stopped")
        self.assertLess(time.monotonic() - sent, 8)
        self.assertTrue(any(line.startswith("{U,") for line in self.arduino.heard))
        self.assertNotIn("{U,0,0}", self.arduino.heard)

    def test_the_end_of_the_server_stops_them(self):
        server, _, _, viewer = self.both()
        self.avr.speed = 1
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.7, "y_m": 0.5})
        waiting.until(lambda: any(line.startswith("{U,") for line in self.avr.heard), "it drives")
        self.robot(viewer, "AVR", lambda r: r["state"] == "moving", "that it is on its way")
        self.interrupt(server)
        self.assertEqual(server.returncode, 130)
        self.assertEqual(self.avr.heard[-1], "{U,0,0}")

    def test_a_robot_with_a_bad_link_is_called_back(self):
        _, _, _, viewer = self.both("--call-back")
        self.avr.room = (-2.0, -2.0, 4.0, 4.0)
        self.avr.bad_beyond_cm, self.avr.speed = 20, 5
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.9, "y_m": 0.5})
        self.says(viewer, "; it is called back")
        waiting.until(lambda: abs(self.avr.x - 0.4) < 0.06, "it is sent back")
        self.says(viewer, "the link to AVR is well again")

    # --- many viewers ---

    @staticmethod
    def used(process):
        """Seconds of CPU time, and memory in KiB."""
        with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
            memory = int(re.search(r"VmRSS:\s+(\d+) kB", file.read())[1])
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), memory

    def test_it_takes_little(self):
        """Two robots with twenty updates a second each, and a viewer of all that the page asks for."""
        server, port, _ = self.serve()
        viewer = self.viewer(port)
        viewer.subscribe(*viewer.channels)
        self.state(viewer, lambda s: len(s["robots"]) == 2 and all(robot["at"] for robot in s["robots"]), "two robots with places")
        shares = []
        while len(shares) < 4 and min(shares, default=1) >= 0.04:  # the least: on a busy machine the same work takes longer
            (before, _), begin = self.used(server), time.monotonic()
            for _ in range(25):
                viewer.message("/ocm/fleet")
            shares.append((self.used(server)[0] - before) / (time.monotonic() - begin))
        share = min(shares)
        print(f"serve of two robots: {share * 100:.1f} % of a core", file=sys.stderr)
        if not sanitized():
            self.assertLess(share, 0.04)

    def test_a_hundred_viewers(self):
        server, port, _ = self.serve()
        viewers = [self.viewer(port, "", "/ocm/fleet", "/ocm/map") for _ in range(100)]
        self.state(viewers[0], lambda s: len(s["robots"]) == 2 and all(robot["at"] for robot in s["robots"]), "two robots with places")
        before, memory = self.used(server)
        begin = time.monotonic()
        for _ in range(25):
            for viewer in viewers:
                self.assertIn(len(viewer.message("/ocm/fleet").fields["robots"]), (0, 2))  # none before they are linked
        used, now = self.used(server)
        print(f"serve of two robots to a hundred viewers: {(used - before) / (time.monotonic() - begin) * 100:.1f} % of a core", file=sys.stderr)
        self.assertEqual([viewer.statuses for viewer in viewers if any(s.get("id") == "loss" for s in viewer.statuses)], [])
        if not sanitized():
            self.assertLess(now - memory, 20_000)

    # --- beside other programs ---

    def test_others_join_it(self):
        _, _, _, viewer = self.both()
        self.assert_origins_are_told()
        out, err = self.run_tool("goto", "AVR", "0", "20")
        self.assertEqual((out, err), ("AVR: x 20 cm, y 0 cm, heading 0 deg\n", ""))
        robot = self.robot(viewer, "AVR", lambda r: r["at"]["x_m"] > 0.55, "its new place")
        self.assertIn("goto (process", robot["by"])
        # Its drives are not taken from it, and a stop is.
        self.avr.speed = 1
        tool = self.start("goto", "AVR", "180", "15")
        waiting.until(lambda: "{U,180,15}" in self.avr.heard, "it drives")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.4, "y_m": 0.5})
        self.says(viewer, "AVR is driven by goto (process")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "order": "stop"})
        tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 1)

    def test_beside_a_map(self):
        """It shows the map of the program that explores, and a robot that is sent by hand is held until it goes on."""
        picture = os.path.join(self.folder, "room.svg")
        mapper = self.start("map", picture, "--scan", "200ms", "--start", "AVR=0.4,0.5,0", "--start", "Arduino=0.8,0.5,90")
        waiting.until(lambda: any(line.startswith("{U,") for line in self.avr.heard), "the map sends a robot")
        _, port, token = self.serve("--allow-commands", starts=())
        viewer = self.viewer(port, token, "/ocm/fleet", "/ocm/map")
        state = self.state(viewer, lambda s: s["map_by"] and all(r["at"] for r in s["robots"]), "the map's robots, which it has placed")
        self.assertRegex(state["map_by"], r"map \(process \d+\)")
        self.assertFalse(state["own"])
        self.state(viewer, lambda grid: 1 in self.cells(grid)[1] and 2 in self.cells(grid)[1], "the map", "/ocm/map")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.6, "y_m": 0.5})
        self.robot(viewer, "AVR", lambda r: r["state"] == "held", "that it is held")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "order": "go_on"})
        self.robot(viewer, "AVR", lambda r: r["state"] != "held", "that it goes on")
        # The end of the map does not wait for who only looks on; then the server has the line.
        begin = time.monotonic()
        out, err = self.interrupt(mapper)
        self.assertNotIn("it serves the central's line", err)
        self.assertEqual(mapper.returncode, 130, out + err)
        self.assertLess(time.monotonic() - begin, 40)
        self.state(viewer, lambda s: s["own"] and len(s["robots"]) == 2 and not s["map_by"], "that it has the line, and draws the map itself")

    def test_an_owner_that_is_killed(self):
        owner = self.start("central", "--own", "--scan", "200ms")
        waiting.until(lambda: self.avr.confirmed and self.arduino.confirmed, "its robots")
        server, port, token = self.serve("--allow-commands")
        viewer = self.viewer(port, token, "/ocm/fleet")
        state = self.state(viewer, lambda s: len(s["robots"]) == 2, "its robots")
        self.assertEqual((state["own"], state["gone"]), (False, ""))
        self.assertRegex(state["line"], r"central \(process \d+\)")
        owner.send_signal(signal.SIGKILL)
        owner.wait()
        self.assertIn("waiting for it", self.state(viewer, lambda s: s["gone"], "that it is gone")["gone"])
        state = self.state(viewer, lambda s: s["own"] and len(s["robots"]) == 2 and all(robot["at"] for robot in s["robots"]),
                           "that it has the line itself, and hears both")
        self.assertEqual(state["gone"], "")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "x_m": 0.6, "y_m": 0.5})
        self.says(viewer, "AVR is there")

    def test_the_central_goes_and_comes_back(self):
        _, port, _, viewer = self.both()
        self.central.close()
        os.unlink(self.central.path)
        self.state(viewer, lambda s: s["gone"] and not s["robots"], "that it is gone")
        self.avr.linked = self.avr.confirmed = self.arduino.linked = self.arduino.confirmed = False
        self.central = Central(self.folder, [self.avr, self.arduino], link="ocm/central")
        self.addCleanup(self.central.close)
        self.state(viewer, lambda s: s["own"] and not s["gone"] and len(s["robots"]) == 2, "that it is back")

    def test_it_looks_for_its_central_less_and_less_often(self):
        """Half a second after it has gone, and a second after that; another program has its place, and nothing is there."""
        server, _, _, _ = self.both()
        begin = time.monotonic()
        self.central.close()
        os.unlink(self.central.path)
        place = os.open(self.central.path + ".lock", os.O_RDWR)
        self.addCleanup(os.close, place)
        fcntl.flock(place, fcntl.LOCK_EX)
        tries = 0
        while tries < 3:  # the first of these words is no try
            line = server.stderr.readline()
            self.assertTrue(line, server.poll())
            tries += "the central's line is gone" in line
        self.assertGreaterEqual(time.monotonic() - begin, 1.5)

    def test_a_map_with_its_page(self):
        picture = os.path.join(self.folder, "room.svg")
        mapper = self.start("map", picture, "--live", "--port", "0", "--allow-commands", "--scan", "200ms", *STARTS)
        address, _, behind = mapper.stdout.readline().strip().partition("#")
        token, shows = behind.split("&")
        self.assertEqual(shows, "map")
        viewer = self.viewer(int(re.search(r":(\d+)/", address)[1]), token, "/ocm/fleet", "/ocm/map")
        state = self.state(viewer, lambda s: s["map_by"] and len(s["robots"]) == 2, "its robots")
        self.assertIn(f"map (process {mapper.pid})", state["map_by"])
        self.state(viewer, lambda grid: 1 in self.cells(grid)[1], "its map", "/ocm/map")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "order": "pause"})
        self.robot(viewer, "AVR", lambda r: r["state"] in ("held", "paused"), "that it is held")
        out, err = self.interrupt(mapper)
        self.assertEqual(mapper.returncode, 130, out + err)
        self.assertTrue(os.path.exists(picture))
        self.assertNotIn("does not answer", err)

    # --- from a log ---

    def test_a_drive_that_was_recorded(self):
        """central --own --record while robots drive; then the same page from the file, with a time bar."""
        log = os.path.join(self.folder, "room.line")
        owner = self.start("central", "--own", "--scan", "200ms", "--record", log)
        waiting.until(lambda: self.avr.confirmed and self.arduino.confirmed, "its robots")
        self.run_tool("goto", "AVR", "0", "20")
        self.run_tool("goto", "Arduino", "0", "10")
        self.interrupt(owner)
        self.assertIn("--record", self.run_tool("central", "--own", "--record", log, code=1)[1])  # is there already
        self.central.close()  # a log needs none
        server, port, token = self.serve(words=(log,), scan=())
        self.assertEqual(token, "")
        viewer = self.viewer(port, "", "/ocm/robot", "/ocm/playback", "/ocm/fleet", "/ocm/map")
        self.assertFalse(viewer.message("/ocm/robot").fields["live"])
        viewer.publish("/ocm/playback", {"speed": 64})
        self.state(viewer, lambda s: s["ended"], "its end", "/ocm/playback")
        avr = self.robot(viewer, "AVR", lambda r: r["at"] and r["at"]["x_m"] > 0.55, "its place at the end")
        self.assertAlmostEqual(avr["at"]["y_m"], 0.5, delta=0.03)
        arduino = self.robot(viewer, "Arduino", lambda r: r["at"], "its place")
        self.assertAlmostEqual(arduino["at"]["y_m"], 0.6, delta=0.04)
        self.state(viewer, lambda grid: self.cells(grid)[1].count(1) > 100, "the map", "/ocm/map")
        viewer.publish("/ocm/playback", {"at_s": 0, "paused": True})
        self.state(viewer, lambda s: s["jumps"] == 1 and s["at_s"] == 0 and s["paused"], "its beginning", "/ocm/playback")
        self.state(viewer, lambda s: not any(robot["at"] for robot in s["robots"]), "that nothing is known yet")
        self.assertEqual(self.cells(self.state(viewer, lambda grid: True, "the map", "/ocm/map"))[1].count(2), 0)
        viewer.publish("/ocm/playback", {"speed": 0})
        self.says(viewer, "a time bar takes")
        viewer.publish("/ocm/fleet", {"robot": "AVR", "order": "stop"})
        self.says(viewer, "may only look")
        out, err = self.interrupt(server)
        self.assertEqual((out, len(err.splitlines())), ("", 1), err)
        self.assertIn("plays from the moment that the page is opened", err)

    def test_logs_that_are_none(self):
        log = os.path.join(self.folder, "room.line")
        for text, words in (("", "is no log of a central's line"), ("# line of a central, version 1\n", "nothing that a central has said"),
                            ("# line of a central, version 1\n(1.000000) a\nrubbish\n", None)):
            with open(log, "w", encoding="ascii") as file:
                file.write(text)
            if words:
                self.assertIn(words, self.run_tool("serve", "robots", log, "--port", "0", code=1)[1])
        server, _, _ = self.serve(words=("robots", log), scan=())
        self.assertIn("1 line could not be read, the first is line 3", self.interrupt(server)[1])
        for option in (("--central", "x"), ("--call-back",), ("--scan", "1s")):
            self.assertIn(f"{option[0]} and a log", self.run_tool("serve", log, *option, code=2)[1])
        self.assertIn("No such file", self.run_tool("central", "--own", "--record", os.path.join(self.folder, "no", "room.line"), code=1)[1])

    def test_what_a_full_disk_does_not_take_ends_the_record_alone(self):
        log = os.path.join(self.folder, "room.line")

        def small():
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        owner = self.start("central", "--own", "--scan", "200ms", "--record", log, preexec_fn=small)
        waiting.until(lambda: os.path.exists(log) and os.path.getsize(log) == 1000, "that it is full")
        self.run_tool("goto", "AVR", "0", "20")
        said = self.interrupt(owner)[1]
        self.assertEqual(owner.returncode, 130)
        self.assertEqual(said.count("is not recorded"), 1)
        self.assertIn("File too large", said)
        server, _, _ = self.serve(words=(log,), scan=())
        self.assertIn("1 line could not be read", self.interrupt(server)[1])  # its last one is cut off

    # --- wrong usage ---

    def test_wrong_usage(self):
        for arguments, words in ((("--start", "AVR=0,0,0"), "--start without robots"), (("--call-back",), "--call-back without robots"),
                                 (("robots", "--start", "x"), "no start"), (("robots", "--open", "--allow-commands"), "would see the token")):
            self.assertIn(words, self.run_tool("serve", *arguments, code=2)[1])
        self.assertIn("add --live", self.run_tool("map", "a.svg", "--open", code=2)[1])
        self.central.close()
        os.unlink(self.central.path)
        self.central = Central(self.folder, [], link="elsewhere")
        self.assertIn("there is no central at", self.run_tool("serve", "robots", "--port", "0", code=1)[1])


if __name__ == "__main__":
    main()
