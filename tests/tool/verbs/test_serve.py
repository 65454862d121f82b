"""amiroctl serve as browsers and Foxglove meet it: real sockets, real TLS, and viewers that stop or go."""

import http.client
import json
import os
import re
import signal
import socket
import ssl
import subprocess
import sys
import time

import harness
import websocket


class Serve(harness.Case):
    def serve(self, *arguments, tool=()):
        """Starts it on a free port; returns the process, the port and the token."""
        server = self.start(*tool, "serve", "--port", "0", *arguments)
        line = server.stdout.readline()
        self.assertRegex(line, r"^https?://[^/]+:\d+/(#[0-9a-f]{32})?\n$", server.poll())
        address, _, token = line.strip().partition("#")
        return server, int(re.search(r":(\d+)/", address)[1]), token

    def get(self, port, path="/", method="GET", **headers):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
        connection.request(method, path, headers={"Host": f"127.0.0.1:{port}", **headers})
        try:
            answer = connection.getresponse()
            body = answer.read()
        except http.client.RemoteDisconnected:  # such a request is not answered at all
            return 0, {}, b""
        finally:
            connection.close()
        return answer.status, dict((name.lower(), value) for name, value in answer.getheaders()), body

    def viewer(self, port, token="", **options):
        viewer = websocket.Viewer(port, f"/?token={token}" if token else "/", **options)
        self.addCleanup(viewer.close)
        return viewer

    def log(self, count=300):
        """Gyroscope every 100 ms, whose x counts up."""
        path = os.path.join(self.folder, "drive.log")
        with open(path, "w", encoding="ascii") as file:
            for i in range(count):
                file.write(f"({1000 + i / 10:.6f}) can0 608#{i % 256:02X}{i // 256:02X}00000000\n")
        return path

    def state(self, viewer, topic, test, what):
        """The first state on a topic that passes the test."""
        end = time.monotonic() + 30
        while time.monotonic() < end:
            message = viewer.message(topic)
            self.assertIsNotNone(message, what)
            if test(message.fields):
                return message.fields
        return self.fail(f"{what}: not within 30 s")

    # --- the page ---

    def test_the_page_and_nothing_else(self):
        self.start_sim("--frozen")
        _, port, token = self.serve()
        self.assertEqual(token, "")  # nothing to protect
        status, headers, body = self.get(port)
        self.assertEqual(status, 200)
        self.assertIn(b"<!doctype html>", body)
        policy = headers["content-security-policy"]
        for part in ("default-src 'none'", "script-src 'self'", "style-src 'self'", "connect-src 'self'", "frame-ancestors 'none'"):
            self.assertIn(part, policy)
        self.assertNotIn("unsafe", policy)
        self.assertEqual(headers["x-content-type-options"], "nosniff")
        files = set(re.findall(rb'(?:src|href)="([^":]+\.\w+)"', body))
        self.assertIn(b"dygraph.min.js", files)
        for name in files:
            status, headers, got = self.get(port, "/" + name.decode())
            self.assertEqual((status, len(got)), (200, int(headers["content-length"])), name)
        with open("/usr/share/javascript/dygraphs/dygraph.min.js", "rb") as file:
            self.assertEqual(self.get(port, "/dygraph.min.js")[2], file.read())
        for path in ("/etc/passwd", "/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/page", "/page.js/", "//page.js/x", "/index.html%00", "/x" * 500):
            self.assertIn(self.get(port, path)[0], (0, 403, 404), path)
        status, headers, body = self.get(port, "/page.css", "HEAD")
        self.assertEqual((status, body), (200, b""))
        self.assertGreater(int(headers["content-length"]), 1000)
        for method in ("POST", "PUT", "DELETE", "OPTIONS"):
            self.assertNotIn(self.get(port, "/", method)[0], range(100, 400), method)
        self.assertEqual(self.get(port)[0], 200)  # it goes on

    def test_host_origin_and_subprotocol(self):
        self.start_sim("--frozen")
        _, port, _ = self.serve("--name", "robot.example", "--allow-origin", "https://app.example.org")
        own = f"http://127.0.0.1:{port}"
        for host, status in ((f"localhost:{port}", 200), (f"robot.example:{port}", 200), ("evil.example", 403),
                             (f"evil.example:{port}", 403), (f"127.0.0.1.evil.example:{port}", 403)):
            self.assertEqual(self.get(port, Host=host)[0], status, host)
        for origin, host in ((own, None), (None, None), ("https://app.example.org", None),
                             (f"http://robot.example:{port}", f"robot.example:{port}")):
            self.assertIn("/gyroscope", self.viewer(port, origin=origin, host=host).channels)
        for options in ({"origin": "https://evil.example"}, {"origin": "null"}, {"origin": own + "1"}, {"origin": f"https://127.0.0.1:{port}"},
                        {"host": "evil.example", "origin": "http://evil.example"}, {"offer": None}, {"offer": "chat"}):
            with self.assertRaises(websocket.Refused, msg=options) as refused:
                websocket.Viewer(port, **options)
            self.assertNotEqual(refused.exception.status, 101)
        self.assertEqual(self.viewer(port, offer="chat, foxglove.sdk.v1").protocol, "foxglove.sdk.v1")

    def test_its_address_has_the_first_of_its_names(self):
        self.start_sim("--frozen")
        server = self.start("serve", "--port", "0", "--name", "robot.example", "--name", "other.example")
        self.assertRegex(server.stdout.readline(), r"^http://robot\.example:\d+/\n$")

    def answer_to(self, port, *lines):
        """Status and text of what a request gets that http.client would not send."""
        with socket.create_connection(("127.0.0.1", port), timeout=10) as connection:
            connection.sendall(("\r\n".join(("GET / HTTP/1.1", *lines)) + "\r\n\r\n").encode())
            answer = http.client.HTTPResponse(connection)
            answer.begin()
            return answer.status, answer.read().decode()

    def test_two_hosts_are_none(self):
        self.start_sim("--frozen")
        _, port, _ = self.serve()
        own = f"127.0.0.1:{port}"
        self.assertEqual(self.answer_to(port, f"Host: {own}")[0], 200)
        for other in ("evil.example", own, "", f"evil.example:{port}"):
            for hosts in ((own, other), (other, own)):
                status, text = self.answer_to(port, *(f"Host: {host}" for host in hosts))
                self.assertEqual(status, 403, (hosts, text))
        for host in (f"{own},evil.example", "127.0.0.1:80x", "127.0.0.1:", "[::1]x"):
            self.assertEqual(self.answer_to(port, f"Host: {host}")[0], 200 if host.endswith("1:") else 403, host)
        status, text = self.answer_to(port)
        self.assertEqual(status, 403)
        self.assertIn("without Host", text)

    def test_all_that_an_answer_says(self):
        self.start_sim("--frozen")
        _, port, _ = self.serve()
        same = {"x-content-type-options": "nosniff", "referrer-policy": "no-referrer", "cross-origin-resource-policy": "same-origin",
                "cross-origin-opener-policy": "same-origin", "cache-control": "no-cache"}
        pages = (("/", 200, "text/html; charset=utf-8"), ("/index.html", 200, "text/html; charset=utf-8"), ("/page.css", 200, "text/css; charset=utf-8"),
                 ("/dygraph.min.js", 200, "text/javascript; charset=utf-8"), ("/none", 404, "text/plain; charset=utf-8"))
        for path, expected, kind in pages:
            status, headers, body = self.get(port, path)
            self.assertEqual((status, headers["content-type"]), (expected, kind), path)
            self.assertEqual({name: headers.get(name) for name in same}, same, path)
            self.assertIn("default-src 'none'", headers["content-security-policy"])
            self.assertEqual(int(headers["content-length"]), len(body), path)
        own = f"Host: 127.0.0.1:{port}"
        refusals = (((own, "Content-Length: 2"), 413, "no request has a body here"), ((own, "Transfer-Encoding: chunked"), 413, "no request has a body here"),
                    ((f"Host: evil.example:{port}",), 403, "this server has no name 'evil.example'; --name gives it one"),
                    (("Host: 127.0.0.1:123456",), 403, "this server has no name '127.0.0.1:123456'; --name gives it one"),
                    ((own, "Origin: http://evil.example"), 403, "a page of http://evil.example may not connect; --allow-origin http://evil.example lets it"))
        for lines, status, text in refusals:
            self.assertEqual(self.answer_to(port, *lines), (status, text + "\n"), lines)
        for host in ("127.0.0.1", "127.0.0.1:12345", "localhost", f"[::1]:{port}", "[::1]"):
            self.assertEqual(self.answer_to(port, f"Host: {host}")[0], 200, host)
        status, _, body = self.get(port, "/", "POST")
        self.assertEqual((status, body), (405, b"only GET and HEAD are served\n"))
        # What was refused is counted: a page that is missing, the five, and the last.
        viewer = self.viewer(port)
        viewer.subscribe("/ocm/bus")
        self.assertEqual(viewer.message("/ocm/bus").fields["refused"], 2 + len(refusals))
        # One connection fetches one page after the other, until something is refused.
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
        self.addCleanup(connection.close)
        for method, path in (("GET", "/"), ("HEAD", "/page.css"), ("GET", "/page.css"), ("GET", "/none")):
            connection.request(method, path, headers={"Host": f"127.0.0.1:{port}"})
            answer = connection.getresponse()
            self.assertEqual(answer.status, 404 if path == "/none" else 200)
            self.assertEqual(bool(answer.read()), method == "GET")
            if path != "/none":
                self.assertIsNotNone(connection.sock, path)
        self.assertEqual(connection.sock.recv(1) if connection.sock else b"", b"")

    def test_no_other_protocol(self):
        """libwebsockets would go over to HTTP/2, in clear, and to a draft of WebSocket."""
        self.start_sim("--frozen")
        _, port, _ = self.serve()
        upgrade = (f"Host: 127.0.0.1:{port}", "Connection: Upgrade", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
                   "Sec-WebSocket-Protocol: foxglove.websocket.v1")
        for other in (("Upgrade: h2c", "HTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA"), ("Upgrade: websocket", "Sec-WebSocket-Version: 8"),
                      ("Upgrade: websocket",)):
            status, text = self.answer_to(port, *upgrade, *other)
            self.assertEqual(status, 400, other)
            self.assertIn("expected WebSocket, version 13", text)
        self.assertEqual(self.get(port)[0], 200)

    def test_an_origin_that_is_none(self):
        self.start_sim("--frozen")
        _, port, _ = self.serve()
        with self.assertRaises(websocket.Refused) as refused:
            websocket.Viewer(port, origin="null")
        self.assertIn("a page without an origin", refused.exception.body)
        self.assertNotIn("--allow-origin null", refused.exception.body)
        for origin in ("null", "*", "app.example.org", "https://app.example.org/", "https://app.example.org/page"):
            _, said = self.run_tool("serve", "--allow-origin", origin, code=2)
            self.assertIn(f"--allow-origin {origin} is no origin of a page", said)

    def test_without_its_address_it_ends(self):
        self.start_sim("--frozen")
        with open("/dev/full", "w", encoding="ascii") as full:
            server = subprocess.run([harness.AMIROCTL, "--bus", "sim", "serve", "--port", "0"], stdout=full, stderr=subprocess.PIPE,
                                    text=True, env=self.environment, timeout=30, check=False)
        self.assertEqual(server.returncode, 1)
        self.assertIn("cannot write the output: No space left on device", server.stderr)

    def test_messages_have_a_bound(self):
        self.start_sim("--frozen")
        _, port, _ = self.serve()
        viewer = self.viewer(port)
        viewer.send_frame(1, b"x" * 70_000)
        self.assertIsNone(viewer.text("none"))
        self.assertEqual(viewer.closed, 1009)
        longest = self.viewer(port)
        text = b'{"op":"nothing"}'
        longest.send_frame(1, text + b" " * (65_536 - len(text)))
        self.assertIn("'nothing' is nothing that this server does", longest.text("status")["message"])
        longest.send_frame(1, text + b" " * (65_537 - len(text)))
        self.assertIsNone(longest.text("none"))
        self.assertEqual(longest.closed, 1009)
        pieces = self.viewer(port)
        pieces.send_frame(1, b"{" + b" " * 40_000, final=False)
        try:
            for _ in range(8):
                pieces.send_frame(0, b" " * 40_000, final=False)
        except OSError:
            pass  # hung up meanwhile
        self.assertIsNone(pieces.text("none"))
        fine = self.viewer(port)
        fine.send_frame(1, b'{"op":"subscr', final=False)
        fine.send_frame(0, b'ibe","subscriptions":[{"id":1,"channelId":9999}]}')
        self.assertIn("there is no channel 9999", fine.text("status")["message"])
        not_text = self.viewer(port)
        not_text.send_frame(1, b"\xff\xfe")
        self.assertIsNone(not_text.text("none"))

    def test_it_opens_a_browser(self):
        """xdg-open is played: what it gets is the address, and that it stays or is missing keeps nothing waiting."""
        log = self.log()
        opened = os.path.join(self.folder, "opened")
        browser = os.path.join(self.folder, "xdg-open")
        with open(browser, "w", encoding="ascii") as file:
            file.write(f'#!/bin/sh\necho "$@" > {opened}.part; mv {opened}.part {opened}; exec sleep 60\n')
        os.chmod(browser, 0o755)
        path = self.environment["PATH"]
        for display in ("DISPLAY", "WAYLAND_DISPLAY"):
            self.environment |= {"PATH": f"{self.folder}:{path}", display: ":7"}
            server, port, _ = self.serve(log, "--open")
            harness.waiting.until(lambda: os.path.exists(opened), "that the browser is opened")
            with open(opened, encoding="ascii") as file:
                self.assertEqual(file.read(), f"http://127.0.0.1:{port}/\n")
            os.unlink(opened)
            children = subprocess.run(["pgrep", "-P", str(server.pid)], capture_output=True, text=True, check=True).stdout.split()
            out, err = self.interrupt(server)
            self.assertEqual((out, len(err.splitlines())), ("", 1), err)  # that the log waits for the page
            for child in children:
                os.kill(int(child), signal.SIGKILL)
            del self.environment[display]
        server, port, _ = self.serve(log, "--open")
        self.assertIn("there is no display", self.interrupt(server)[1])
        self.assertFalse(os.path.exists(opened))
        self.environment |= {"PATH": "/nonexistent", "DISPLAY": ":7"}
        server, port, _ = self.serve(log, "--open")
        self.assertEqual(self.get(port)[0], 200)
        self.assertIn("xdg-open cannot be started: No such file or directory", self.interrupt(server)[1])

    # --- values ---

    def test_values_are_those_of_listen(self):
        self.start_sim("--frozen")
        server, port, _ = self.serve()
        viewer = self.viewer(port)
        viewer.subscribe("/gyroscope", "/odometry")
        self.settle()
        listener = self.listen("--count", "12")
        for i in range(4):
            self.run_tool("send", f"608#{i:02X}FF0010{i:02X}7F")
            self.run_tool("send", f"602#{i:02X}00000000FFFFFF")
            self.run_tool("send", f"603#{i:02X}0000{i:02X}00800102")
        events = self.objects(listener.communicate(timeout=30)[0])
        expected = [("/gyroscope", event["fields"]) for event in events if event["topic"] == "gyroscope"]
        parts = [event for event in events if event["topic"] == "odometry"]
        expected_poses = [{first["frame"]: first["fields"], second["frame"]: second["fields"]} for first, second in zip(parts[::2], parts[1::2])]
        self.assertEqual((len(expected), len(expected_poses)), (4, 4))
        got = [viewer.message() for _ in range(8)]
        self.assertEqual([(each.topic, each.fields) for each in got if each.topic == "/gyroscope"], expected)
        self.assertEqual([each.fields for each in got if each.topic == "/odometry"], expected_poses)
        now = time.time_ns()
        self.assertTrue(all(0 <= now - each.time_ns < 60e9 for each in got))
        schema = json.loads(viewer.channels["/gyroscope"]["schema"])
        self.assertEqual(schema["properties"]["x"]["description"], "deg/s")
        out, _ = self.interrupt(server)
        self.assertEqual(out, "")

    def test_states(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "50ms")
        _, port, _ = self.serve()
        viewer = self.viewer(port)
        viewer.subscribe("/ocm/robot")
        robot = viewer.message().fields
        self.assertEqual((robot["robot"], robot["source"], robot["live"], robot["commands"]), ("AMiRo", "sim", True, False))
        gyro = next(topic for topic in robot["topics"] if topic["name"] == "gyroscope")
        self.assertEqual([field["unit"] for field in gyro["frames"][0]["fields"]], ["deg/s"] * 3)
        roles = {topic["name"]: topic["role"] for topic in robot["topics"]}
        self.assertEqual([roles[name] for name in ("motors", "led_1", "odometry", "proximity_ring", "floor_proximity", "gyroscope")],
                         ["drive", "light", "pose", "ring", "floor", ""])
        ring = next(topic["geometry"] for topic in robot["topics"] if topic["role"] == "ring")
        self.assertAlmostEqual(ring["step_rad"], -0.785398163)
        viewer.subscribe("/ocm/bus", "/ocm/boards", "/ocm/operator")
        def gyroscope(bus):
            return next((row for row in bus["buses"][0]["rows"] if row["name"] == "gyroscope"), {"rate_hz": None})

        row = gyroscope(self.state(viewer, "/ocm/bus", lambda bus: gyroscope(bus)["rate_hz"], "its rate"))
        self.assertAlmostEqual(row["rate_hz"], 20, delta=2)
        self.assertAlmostEqual(row["period_s"] or 0.05, 0.05)
        self.run_tool("doctor", "--json")
        boards = self.state(viewer, "/ocm/boards", lambda s: all(board["answers"] for board in s["boards"]), "all boards")["boards"]
        self.assertEqual(len(boards), 3)
        self.assertTrue(all(board["same_spec"] for board in boards))
        self.assertEqual(viewer.message("/ocm/operator").fields, {"running": False})
        # Response times, each below its bound.
        viewer.subscribe("/ocm/bounds")
        rows = self.state(viewer, "/ocm/bounds", lambda s: any(row["measured_ms"] for row in s["rows"]), "a response time")["rows"]
        row = next(row for row in rows if row["name"].startswith("gyroscope"))
        self.assertEqual((row["period_ms"], row["deadline_ms"]), (50, 50))
        self.assertGreater(row["bound_ms"], 0.2)  # a frame of six bytes at 500 kbit/s
        self.assertGreater(row["measured_ms"], 0.1)

    def test_only_boards_that_were_asked_are_found_silent(self):
        self.start_sim("--without", "light_ring")
        _, port, _ = self.serve()
        viewer = self.viewer(port)
        viewer.subscribe("/ocm/boards")
        self.assertEqual(viewer.message().fields["findings"], [])
        self.run_tool("publish", "gyro", "50ms")
        self.run_tool("stop", "light_ring_status")
        state = self.state(viewer, "/ocm/boards", lambda s: s["boards"][0]["heard"], "a board that sends")
        state = viewer.message().fields  # and a second later
        self.assertEqual((state["findings"], [board["asked"] for board in state["boards"]]), ([], [False] * 3))
        self.run_tool("doctor", "--json", code=1)
        state = self.state(viewer, "/ocm/boards", lambda s: s["findings"], "what was found")
        self.assertEqual([(found["board"], found["what"]) for found in state["findings"]], [("light_ring", "does not answer")])
        self.assertEqual([board["answers"] for board in state["boards"]], [True, True, False])

    def test_driving_by_hand_is_no_response_time(self):
        """Pressed, held for a while, released, and again before a period of set points is over."""
        moves, rest = "201#A086010000000000", "201#0000000000000000"
        path = os.path.join(self.folder, "pad.log")
        with open(path, "w", encoding="ascii") as file:
            for i in range(40):
                for ms, frame in ((0, moves), (100, moves), (140, moves[:4] + "50C3000000000000"), (240, rest), (360, moves), (400, rest)):
                    file.write(f"({1000 + i + ms / 1000:.6f}) can0 {frame}\n")
        _, port, _ = self.serve(path)
        viewer = self.viewer(port)
        viewer.subscribe("/ocm/bounds", "/ocm/playback")
        self.state(viewer, "/ocm/bounds", lambda s: s["rows"], "its row")
        viewer.publish("/ocm/playback", {"speed": 8})
        self.state(viewer, "/ocm/playback", lambda s: s["ended"], "the end")
        row = self.state(viewer, "/ocm/bounds", lambda s: s["rows"][0]["measured_ms"], "a response time")["rows"][0]
        self.assertEqual((row["name"], row["period_ms"], row["exceeds"]), ("motors", 100, False))
        self.assertLess(row["measured_ms"], row["bound_ms"])

    def test_a_topic_without_a_whole_sample(self):
        path = os.path.join(self.folder, "magnetometer.log")
        with open(path, "w", encoding="ascii") as file:
            for i in range(300):  # x and z, and no y
                file.write(f"({1000 + i / 10:.6f}) can0 605#00000000\n({1000 + i / 10 + 0.001:.6f}) can0 607#00000000\n")
        _, port, _ = self.serve(path)
        viewer = self.viewer(port)
        viewer.subscribe("/ocm/bus")
        bus = self.state(viewer, "/ocm/bus", lambda s: s["buses"] and s["buses"][0]["rows"] and s["buses"][0]["rows"][0]["incomplete"] > 1, "it")
        row = bus["buses"][0]["rows"][0]
        self.assertEqual((row["name"], row["count"]), ("magnetometer", 0))
        self.assertGreaterEqual(row["frames"], 2 * row["incomplete"])
        self.assertGreater(row["share"], 0)

    def test_any_dbc(self):
        spec = os.path.join(self.folder, "car.dbc")
        with open(spec, "w", encoding="ascii") as file:
            file.write('VERSION ""\nNS_ :\nBS_:\nBU_: ECU\nBO_ 291 Engine: 8 ECU\n SG_ Speed : 0|16@1+ (0.25,0) [0|16000] "rpm" Vector__XXX\n')
        log = os.path.join(self.folder, "car.log")
        with open(log, "w", encoding="ascii") as file:
            file.write("".join(f"({10 + i / 10:.6f}) can{i % 2} 123#{i:02X}00000000000000\n" for i in range(40)))
        _, port, _ = self.serve(log, tool=("--spec", spec))
        viewer = self.viewer(port)
        self.assertIn("/can1/Engine", viewer.channels)
        viewer.subscribe("/can1/Engine", "/ocm/robot")
        self.assertFalse(viewer.message("/ocm/robot").fields["live"])
        viewer.publish("/ocm/playback", {"at_s": 0, "speed": 4})
        got = [viewer.message("/can1/Engine") for _ in range(15)]
        expected = {event["time_ns"]: event["fields"] for event in self.objects(self.run_tool("--spec", spec, "decode", "--json", log)[0])
                    if event["bus"] == "can1"}
        for message in got:
            self.assertEqual(message.fields, expected[str(message.time_ns)])

    def test_a_log_waits_for_its_first_viewer(self):
        server, port, _ = self.serve(self.log())
        self.assertIn("the log plays from the moment that the page is opened", server.stderr.readline())
        time.sleep(1)  # in which it would play ten samples
        viewer = self.viewer(port)
        viewer.subscribe("/ocm/playback", "/gyroscope")
        self.assertEqual(viewer.message("/ocm/playback").fields["at_s"], 0)
        self.assertEqual([round(viewer.message("/gyroscope").fields["x"] / 0.0175) for _ in range(5)], [0, 1, 2, 3, 4])
        # Who subscribes to states alone has it played, too, and so has who winds it.
        _, port, _ = self.serve(self.log())
        viewer = self.viewer(port)
        viewer.subscribe("/ocm/playback")
        self.state(viewer, "/ocm/playback", lambda s: s["at_s"] > 0, "that it plays")
        _, port, _ = self.serve(self.log())
        viewer = self.viewer(port)
        viewer.publish("/ocm/playback", {"at_s": 20})
        viewer.subscribe("/ocm/playback")
        self.state(viewer, "/ocm/playback", lambda s: s["at_s"] > 20.2, "that it plays")

    def test_a_log_is_wound(self):
        _, port, _ = self.serve(self.log())
        viewer = self.viewer(port)
        viewer.subscribe("/ocm/playback", "/gyroscope")
        viewer.publish("/ocm/playback", {"paused": True, "at_s": 20})

        def where(test, what):
            return self.state(viewer, "/ocm/playback", test, what)

        state = where(lambda s: s["paused"] and s["jumps"] == 1, "the jump")
        self.assertAlmostEqual(state["at_s"], 20, delta=0.2)
        self.assertAlmostEqual(state["length_s"], 29.9)
        viewer.publish("/ocm/playback", {"speed": 0.5})
        where(lambda s: s["speed"] == 0.5, "half the speed")
        viewer.publish("/ocm/playback", {"at_s": 5})  # back: only the newest sample is sent
        where(lambda s: s["jumps"] == 2, "the jump back")
        self.assertEqual(viewer.message("/gyroscope").fields["x"], round(50 * 0.0175, 4))
        viewer.publish("/ocm/playback", {"speed": 16, "paused": False})
        where(lambda s: s["ended"], "the end")
        viewer.publish("/ocm/playback", {"speed": 0})
        self.assertIn("a time bar takes", viewer.text("status")["message"])

    def test_a_log_that_is_wound_back_has_no_second_commander(self):
        """One program that drives forwards and then back: a set point that comes again in the log that is read again is no other program's."""
        path = os.path.join(self.folder, "there_and_back.log")
        with open(path, "w", encoding="ascii") as file:
            for i in range(100):
                speed = "A0860100" if i < 50 else "607AFEFF"
                file.write(f"({1000 + i / 10:.6f}) can0 201#{speed}00000000\n")
        _, port, _ = self.serve(path)
        viewer = self.viewer(port)
        viewer.subscribe("/ocm/playback")
        for jump, at in enumerate([9.9, 0, 9.9, 0, 9.9, 0, 9.9], 1):
            viewer.publish("/ocm/playback", {"paused": True, "at_s": at})
            self.state(viewer, "/ocm/playback", lambda s, jumps=jump: s["jumps"] == jumps, f"jump {jump}")
        viewer.subscribe("/ocm/boards")
        findings = viewer.message("/ocm/boards").fields["findings"]
        self.assertEqual([each["what"] for each in findings if "two programs" in each["what"]], [])

    # --- commands ---

    def set_points(self, listener):
        return [event["fields"]["x"] for event in self.objects(listener.communicate(timeout=30)[0]) if event["topic"] == "motors" and "fields" in event]

    def test_no_command_without_the_token(self):
        self.start_sim("--frozen")
        _, port, token = self.serve("--allow-commands")
        for wrong in ("", "0" * 32, token[:-1], token + "0", token.upper() if token.upper() != token else "x"):
            viewer = self.viewer(port, wrong)
            self.assertEqual(viewer.info["capabilities"], [])
            if wrong:  # one without a token only wants to look
                status = viewer.text("status")
                self.assertIn("is not that of this server, so you only look", status["message"])
                self.assertEqual((status["level"], status["id"]), (1, "token"))
            viewer.publish("/motors", {"x": 0.1})
            self.assertIn("may only look", viewer.text("status")["message"])
            self.assertIn("was not advertised", viewer.text("status")["message"])
        _, other, none = self.serve()
        self.assertEqual(none, "")
        old = self.viewer(other, token)
        self.assertEqual(old.info["capabilities"], [])
        self.assertIn("without --allow-commands", old.text("status")["message"])

    def test_what_is_wrong_with_a_publish(self):
        self.start_sim("--frozen")
        _, port, token = self.serve("--allow-commands")
        viewer = self.viewer(port, token)
        for payload, what in ((b'{"x":null}', "x: expected a number in m/s"), (b"{}", "no field in it"), (b"", "an empty message"),
                              (b'{"x":0.1}\0{}', "no JSON: a NUL character")):
            viewer.publish_bytes("/motors", payload)
            self.assertIn(f"/motors: {what}", viewer.text("status")["message"])
        viewer.publish("/can0/motors", {"x": 0.1})  # of another server
        self.assertIn("/can0/motors takes nothing", viewer.text("status")["message"])

    def test_what_comes_back_is_bounded(self):
        """A viewer that does not read its answers: what waits for it is not what it has sent."""
        self.start_sim("--frozen")
        server, port, _ = self.serve()
        viewer = self.viewer(port, room=4096)
        unknown = b'{"op":"' + b"x" * 65_000 + b'"}'
        viewer.send_frame(1, unknown)
        viewer.text("status")  # what the server needs for one, and to begin, it has now
        before = self.memory(server)
        for _ in range(200):
            viewer.send_frame(1, unknown)
        status = viewer.text("status")
        self.assertIn("x ...", status["message"])
        self.assertLess(len(status["message"]), 1100)
        if not harness.sanitized():
            self.assertLess(self.memory(server) - before, 2_000)  # KiB, of 13,000 that it was sent

    def test_a_page_drives_and_its_going_stops(self):
        self.start_sim("--frozen")
        _, port, token = self.serve("--allow-commands")
        viewer = self.viewer(port, token)
        self.assertEqual(viewer.info["supportedEncodings"], ["json"])
        viewer.subscribe("/motors")
        viewer.publish("/motors", {"x": 0, "z": 0})  # it is one that can say rest
        self.assertEqual(viewer.message().fields, {"x": 0, "z": 0})
        # It goes on while set points come, and rests half a second after the last.
        listener = self.listen("motors")
        for _ in range(5):
            viewer.publish("/motors", {"x": 0.1, "z": 0})
            time.sleep(0.1)
        self.assertEqual(viewer.message().fields, {"x": 0.1, "z": 0})
        begin = time.monotonic()
        while viewer.message().fields["x"] != 0:
            self.assertLess(time.monotonic() - begin, 5)
        self.interrupt(listener)
        # It goes on as if nothing had been, as a page that was frozen: it must say rest before it drives again.
        listener = self.listen("motors")
        for _ in range(3):
            viewer.publish("/motors", {"x": 0.1, "z": 0})
        while "release first, then drive again" not in viewer.text("status")["message"]:
            pass
        viewer.publish("/motors", {"x": 0, "z": 0})
        self.assertEqual(viewer.message().fields, {"x": 0, "z": 0})
        self.settle()
        self.assertEqual([event["fields"]["x"] for event in self.objects(self.interrupt(listener)[0])], [0])
        # The connection is cut without a word.
        listener = self.listen("motors")
        viewer.publish("/motors", {"x": 0.05, "z": 0})
        viewer.message()
        other = self.viewer(port)
        other.subscribe("/motors")
        self.settle()
        cut = time.monotonic()
        viewer.close()
        while other.message().fields["x"] != 0:
            pass
        self.assertLess(time.monotonic() - cut, 1.5)
        self.settle()
        speeds = [event["fields"]["x"] for event in self.objects(self.interrupt(listener)[0])]
        self.assertEqual(speeds[0], 0.05)
        self.assertEqual(speeds[-1], 0)

    def test_the_end_of_the_server_is_rest(self):
        self.start_sim("--frozen")
        server, port, token = self.serve("--allow-commands")
        listener = self.listen("motors")
        viewer = self.viewer(port, token)
        viewer.subscribe("/motors")
        viewer.publish("/motors", {"x": 0.05, "z": 0})
        viewer.message()
        self.interrupt(server, signal.SIGTERM)
        self.assertEqual(server.returncode, 128 + signal.SIGTERM)
        self.assertIsNone(viewer.message("/none"))
        self.settle()
        self.assertEqual([event["fields"]["x"] for event in self.objects(self.interrupt(listener)[0])][-1], 0)

    def test_what_a_board_does_is_another_commander(self):
        self.start_sim()
        _, port, token = self.serve("--allow-commands")
        viewer = self.viewer(port, token)
        viewer.subscribe("/motors")

        def is_behaving():
            out, _ = self.run_tool("once", "behaviour", "--wait")
            return json.loads(out)["fields"]["active"] != 0
        travel = self.start("travel", "1m", "--speed", "1cm/s")
        harness.waiting.until(is_behaving, "the board travels")
        viewer.publish("/motors", {"x": 0.05, "z": 0})
        self.assertIn("di_wheel_drive drives the wheels by itself", viewer.text("status")["message"])
        self.interrupt(travel)
        harness.waiting.until(lambda: not is_behaving(), "the travel has ended")
        viewer.publish("/motors", {"x": 0.05, "z": 0})
        self.assertEqual(viewer.message().fields["x"], 0.05)  # the first one: what was refused was not sent

    def test_a_board_that_does_not_say_what_it_does_is_waited_for_no_longer_than_it_may_take(self):
        self.start_sim("--without", "di_wheel_drive")
        _, port, token = self.serve("--allow-commands")
        viewer = self.viewer(port, token)
        viewer.subscribe("/motors")
        viewer.publish("/motors", {"x": 0.05, "z": 0})
        self.assertEqual(viewer.message().fields["x"], 0.05)

    def test_two_pages_and_another_program(self):
        self.start_sim("--frozen")
        _, port, token = self.serve("--allow-commands")
        first, second = self.viewer(port, token), self.viewer(port, token)
        first.subscribe("/motors")
        first.publish("/motors", {"x": 0, "z": 0})  # it is one that can say rest
        self.assertEqual(first.message().fields["x"], 0)
        first.publish("/motors", {"x": 0.05, "z": 0})
        first.message()
        second.publish("/motors", {"x": 0.1, "z": 0})
        self.assertIn("another viewer drives", second.text("status")["message"])
        second.publish("/motors", {"x": 0, "z": 0})  # a stop is never refused
        while first.message().fields["x"] != 0:
            pass
        first.publish("/motors", {"x": 0.05, "z": 0})  # as a page that is still held: the stop holds
        while "release first" not in first.text("status")["message"]:
            pass
        other = self.start("drive", "5cm/s")
        while first.message().fields["x"] != 0.05:
            pass
        second.publish("/motors", {"x": 0.1, "z": 0})
        self.assertIn("another program commands the motors", second.text("status")["message"])
        self.interrupt(other)

    def test_lines_lights_and_parameters(self):
        self.start_sim()
        _, port, token = self.serve("--allow-commands")
        viewer = self.viewer(port, token)
        viewer.subscribe("/led_3", "/gyroscope")
        viewer.publish("/ocm/command", {"line": "led 3 red"})
        self.assertEqual(viewer.message().fields, {"red": 255, "green": 0, "blue": 0})
        viewer.publish("/led_3", {"blue": 7})
        self.assertEqual(viewer.message().fields, {"red": 0, "green": 0, "blue": 7})
        name = "/gyroscope/period_ms"
        confirmed = {"op": "parameterValues", "parameters": [{"name": name, "type": "float64", "value": 20}]}
        viewer.ask(op="setParameters", id="p", parameters=[{"name": name, "value": 20}])
        self.assertEqual(viewer.text("parameterValues"), {**confirmed, "id": "p"})
        times = [viewer.message("/gyroscope").time_ns for _ in range(20)]
        self.assertAlmostEqual((times[-1] - times[0]) / 19e6, 20, delta=5)
        viewer.ask(op="setParameters", id="q", parameters=[{"name": name, "value": 0.1}])
        self.assertIn("refuses gyroscope", viewer.text("status")["message"])
        self.assertEqual(viewer.text("parameterValues"), {**confirmed, "id": "q"})
        viewer.publish("/ocm/command", {"line": "publish gyro 1us"})
        self.assertRegex(viewer.text("status")["message"], "gyroscope|period")
        for fields, words in (({"line": "drive 0.1m/s"}, "sent once"), ({"line": "fly"}, "unknown command"), ({}, "takes a line")):
            viewer.publish("/ocm/command", fields)
            self.assertIn(words, viewer.text("status")["message"])
        viewer.publish("/motors", {"x": 99})
        self.assertEqual(viewer.text("status")["level"], 2)

    def test_what_came_before_is_there(self):
        """The newest sample and set point of before a viewer came, and periods as they are."""
        self.start_sim("--frozen")
        _, port, token = self.serve("--allow-commands")
        first = self.viewer(port, token)
        first.subscribe("/gyroscope", "/led_3")
        self.settle()
        self.run_tool("send", "608#100000000000")
        sent = first.message("/gyroscope")
        self.run_tool("led", "3", "red")
        first.message("/led_3")
        late = self.viewer(port, token)
        late.subscribe("/gyroscope", "/led_3", "/accelerometer")
        self.assertEqual(late.message("/gyroscope"), sent)
        again = self.viewer(port, token)
        again.subscribe("/led_3")
        self.assertEqual(again.message().fields, {"red": 255, "green": 0, "blue": 0})
        name = "/gyroscope/period_ms"
        again.ask(op="subscribeParameterUpdates", parameterNames=[name])

        def value():
            parameter, = again.text("parameterValues")["parameters"]
            self.assertEqual(parameter["name"], name)
            return parameter.get("value")

        value()
        self.run_tool("publish", "gyro", "50ms")  # by another program
        while value() != 50:
            pass
        self.run_tool("stop", "gyro")
        while value() != 0:
            pass
        again.ask(op="getParameters", parameterNames=[name], id="q")
        self.assertEqual(value(), 0)

    def test_with_an_operator(self):
        """Its state is shown; set points go through it, also where it starts after the server, and no longer when it has ended."""
        self.start_sim()
        _, before, old = self.serve("--allow-commands")
        watcher = self.viewer(before, old)  # before there is an operator: serve says once that it guards the robot
        watcher.subscribe("/ocm/operator")
        guard = self.start("operate", os.path.join(harness.SOURCE, "examples", "guard.operator.json"))
        state = self.state(watcher, "/ocm/operator", lambda s: s["running"], "the operator")
        self.assertEqual(state["status"]["operator"], json.loads(self.run_tool("operator", "status", "--json")[0])["operator"])
        self.assertTrue(state["why"]["changes"])
        watcher.is_told("guards the robot: set points go through it")
        passed = state["status"]["set_points"]["passed"]
        watcher.publish("/motors", {"x": 0.05, "z": 0})
        passed = self.state(watcher, "/ocm/operator", lambda s: s["status"]["set_points"]["passed"] > passed, "the set point")["status"]["set_points"]["passed"]
        watcher.publish("/motors", {"x": 0, "z": 0})
        _, port, token = self.serve("--allow-commands")
        viewer = self.viewer(port, token)
        viewer.subscribe("/motors")
        viewer.publish("/motors", {"x": 0.05, "z": 0})
        while viewer.message().fields != {"x": 0.05, "z": 0}:  # the rest of before may still come
            pass
        self.state(watcher, "/ocm/operator", lambda s: s["status"]["set_points"]["passed"] > passed, "the set point")
        viewer.publish("/motors", {"x": 0, "z": 0})
        self.interrupt(guard)
        watcher.is_told("no operator runs any more")
        time.sleep(0.5)  # what is still on its way is rest
        watcher.subscribe("/motors")
        watcher.publish("/motors", {"x": 0.04, "z": 0})
        while watcher.message("/motors").fields != {"x": 0.04, "z": 0}:
            pass

    # --- TLS ---

    def test_other_interfaces_need_tls(self):
        _, refused = self.run_tool("serve", "--address", "0.0.0.0", code=2)
        self.assertIn("--certificate", refused)
        key, certificate, other = (os.path.join(self.folder, name) for name in ("key.pem", "cert.pem", "other.pem"))
        for to, at in ((key, certificate), (other, os.path.join(self.folder, "other-cert.pem"))):
            subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-keyout", to,
                            "-out", at, "-days", "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost"],
                           check=True, capture_output=True)
        self.start_sim("--frozen")
        self.assertIn("--key", self.run_tool("serve", "--certificate", certificate, code=2)[1])
        self.assertIn("No such file", self.run_tool("serve", "--port", "0", "--certificate", "no.pem", "--key", key, code=1)[1])
        self.assertIn("cannot serve", self.run_tool("serve", "--port", "0", "--certificate", certificate, "--key", other, code=1)[1])
        _, port, token = self.serve("--address", "0.0.0.0", "--name", "localhost", "--certificate", certificate, "--key", key)
        self.assertEqual(len(token), 32)  # to look, too
        trusted = ssl.create_default_context(cafile=certificate)
        with self.assertRaises(websocket.Refused) as refused:
            websocket.Viewer(port, host=f"localhost:{port}", context=trusted)
        self.assertEqual(refused.exception.status, 403)
        viewer = self.viewer(port, token, host=f"localhost:{port}", origin=f"https://localhost:{port}", context=trusted)
        viewer.subscribe("/ocm/bus")
        self.assertEqual(viewer.message().fields["buses"][0]["name"], "sim")
        with self.assertRaises(ssl.SSLError):
            websocket.Viewer(port, context=ssl.create_default_context())

    # --- many viewers, slow ones ---

    def test_a_stopped_viewer_slows_nobody(self):
        self.start_sim("--frozen")
        server, port, _ = self.serve()
        reader = subprocess.Popen([sys.executable, "-B", "-c", f"""
import sys; sys.path.insert(0, {os.path.dirname(os.path.abspath(__file__))!r})
import websocket
viewer = websocket.Viewer({port}, timeout=60, room=4096)
viewer.subscribe("/gyroscope")
print("ready", flush=True)
lost = None
while lost is None:
    viewer.message()
    lost = next((s["message"] for s in viewer.statuses if s.get("id") == "loss"), None)
print(lost, flush=True)
"""], stdout=subprocess.PIPE, text=True)
        self.addCleanup(reader.stdout.close)
        self.addCleanup(reader.wait)
        self.addCleanup(reader.kill)
        self.assertEqual(reader.stdout.readline(), "ready\n")
        quick = self.viewer(port)
        quick.subscribe("/gyroscope")
        self.settle()
        reader.send_signal(signal.SIGSTOP)
        before = self.memory(server)
        path = os.path.join(self.folder, "flood.log")
        count = 60_000  # more than its socket and the queue hold
        with open(path, "w", encoding="ascii") as file:
            file.writelines(f"({10 + i / 10000:.6f}) sim 608#{i % 256:02X}{i // 256 % 128:02X}00000000\n" for i in range(count))
        replay = self.start("replay", path)
        got = lost = 0
        while got + lost < count:
            message = quick.message()
            self.assertIsNotNone(message)
            got += 1
            lost = max([lost, *(int(re.search(r"(\d+) messages", s["message"])[1]) for s in quick.statuses)])
            quick.statuses.clear()
            if replay.poll() is not None and message.fields["x"] == round((count - 1) % 256 * 0.0175, 4) and got + lost > count - 300:
                break
        self.assertGreater(got, 0.9 * count)
        if not harness.sanitized():
            self.assertLess(self.memory(server) - before, 40_000)  # KiB: the queue is 8 MiB of text
        reader.send_signal(signal.SIGCONT)
        self.assertRegex(reader.stdout.readline(), r"too slow for what it asks: it has lost [1-9]\d* messages")
        _, said = self.interrupt(server)
        self.assertRegex(said, r"viewers that were too slow have lost [1-9]\d* messages")

    @staticmethod
    def memory(process):
        with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
            return int(re.search(r"VmRSS:\s+(\d+) kB", file.read())[1])

    @staticmethod
    def cpu(process):
        """Seconds of CPU time; ticks of 10 ms are a fifth of what is measured."""
        spent = 0
        for task in os.scandir(f"/proc/{process.pid}/task"):
            with open(f"{task.path}/schedstat", encoding="ascii") as file:
                spent += int(file.read().split()[0])
        return spent / 1e9

    def test_what_has_come_goes_out_before_the_end(self):
        self.start_sim("--frozen")
        server, port, _ = self.serve()
        viewer = self.viewer(port)
        viewer.subscribe("/gyroscope")
        self.settle()
        self.run_tool("send", "--stdin", stdin="608#000100000000\n608#000200000000\n608#000300000000\n")
        self.settle()  # it has them, and a viewer has them up to 20 ms later
        server.send_signal(signal.SIGINT)
        self.assertEqual([round(viewer.message("/gyroscope").fields["x"] / 0.0175) for _ in range(3)], [256, 512, 768])
        server.communicate(timeout=60)

    def test_it_takes_little(self):
        """At 100 frames/s, with a viewer that asks for all that the page asks for: 2 % of a core, where `listen` takes 0.27 %.
        A machine whose cores are shared takes twice as long for the same work: there it is seven times what `listen` takes beside it."""
        self.start_sim()
        self.run_tool("publish", "gyro", "10ms")
        listener = self.start("listen", stdout=subprocess.DEVNULL)
        server, port, _ = self.serve()
        viewer = self.viewer(port)
        viewer.subscribe(*viewer.channels)
        viewer.message("/gyroscope")
        shares = []
        ratio = None
        listener_before, server_before = self.cpu(listener), self.cpu(server)
        for _ in range(4 if harness.sanitized() else 16):  # the least: on a busy machine the same work takes longer
            before, begin = self.cpu(server), time.monotonic()
            for _ in range(300):
                viewer.message("/gyroscope")
            shares.append((self.cpu(server) - before) / (time.monotonic() - begin))
            ratio = (self.cpu(server) - server_before) / (self.cpu(listener) - listener_before)
            if shares[-1] < 0.02:
                break
        print(f"serve at 100 frames/s: {min(shares) * 100:.1f} % of a core, {ratio:.1f} times what listen takes", file=sys.stderr)
        if not harness.sanitized() and min(shares) >= 0.02:
            self.assertLess(ratio, 7)

    def test_a_hundred_viewers(self):
        self.start_sim("--frozen")
        server, port, _ = self.serve()
        viewers = [self.viewer(port) for _ in range(100)]
        for viewer in viewers:
            viewer.subscribe("/gyroscope")
        self.settle()
        path = os.path.join(self.folder, "second.log")
        with open(path, "w", encoding="ascii") as file:
            file.writelines(f"({10 + i / 200:.6f}) sim 608#{i:02X}0000000000\n" for i in range(200))
        self.run_tool("replay", path)
        for viewer in viewers:
            self.assertEqual([viewer.message().fields["x"] for _ in range(200)], [round(i * 0.0175, 4) for i in range(200)])
            self.assertEqual(viewer.statuses, [])
        self.assertLess(self.cpu(server), 4)  # 20000 messages
        for viewer in viewers:
            viewer.close()
        fresh = self.viewer(port)
        fresh.subscribe("/ocm/bus")
        self.state(fresh, "/ocm/bus", lambda s: s["viewers"] == 1, "the others have gone")

    def test_as_many_viewers_as_there_may_be(self):
        self.start_sim("--frozen")
        _, port, _ = self.serve()
        viewers = []

        def close_all():
            for viewer in viewers:
                viewer.close()
        self.addCleanup(close_all)

        def is_let_in():
            try:
                viewers.append(websocket.Socket(port))
            except websocket.Refused as refused:
                self.assertEqual(refused.status, 403)
                self.assertIn("there are too many viewers", refused.body)
                return False
            return True

        begin = time.monotonic()
        while is_let_in():
            pass
        if time.monotonic() - begin < 40:  # then the first have not been silent for too long
            self.assertEqual(len(viewers), 256)
        self.assertEqual(self.get(port)[0], 200)  # who only fetches is no viewer
        viewers.pop().close()
        harness.waiting.until(is_let_in, "that the place of one that has gone is free")

    # --- wrong usage ---

    def test_wrong_usage(self):
        log = self.log()
        self.assertIn("one log at a time", self.run_tool("serve", log, log, code=2)[1])
        self.assertIn("nothing to command", self.run_tool("serve", log, "--allow-commands", code=2)[1])
        self.assertIn("--from candump", self.run_tool("serve", "--from", "candump", code=2)[1])
        self.assertIn("not an address", self.run_tool("serve", log, "--address", "127.0.0.x", "--port", "0", code=1)[1])
        self.assertIn("cannot be wound", self.run_tool("serve", "-", code=2)[1])
        _, port, _ = self.serve(log)
        self.assertIn("another program listens there", self.run_tool("serve", log, "--port", str(port), code=1)[1])

    def test_beside_a_simulation_it_ends_with_that(self):
        """The bus is still there then: nothing is lost, and nothing is complained of."""
        server = self.start("sim", "--show=page", "--port", "0", "--allow-commands")
        port, token = re.match(r"http://127\.0\.0\.1:(\d+)/#([0-9a-f]{32})\n$", server.stdout.readline()).groups()
        viewer = self.viewer(int(port), token)
        viewer.subscribe("/ocm/bus", "/motors")
        self.state(viewer, "/ocm/bus", lambda bus: bus["buses"], "figures of the bus")
        viewer.publish("/motors", {"x": 0.1, "z": 0})
        self.assertEqual(viewer.message("/motors").fields["x"], 0.1)
        _, err = self.interrupt(server)
        self.assertEqual(server.returncode, 130)
        self.assertNotIn("amiroctl:", err)

    def test_only_for_whom_robots_drive_is_asked_whether_it_is_there(self):
        """By a ping [RFC 6455, 5.5.2]; a viewer that looks on gets none, however much it is sent."""
        self.start_sim()
        self.run_tool("publish", "gyro", "10ms")
        _, port, _ = self.serve()
        viewer = self.viewer(port)
        viewer.subscribe("/gyroscope", "/ocm/bus")
        pings = []
        send = viewer.send_frame
        viewer.send_frame = lambda opcode, payload, final=True: (pings.append(payload) if opcode == 10 else None, send(opcode, payload, final))
        for _ in range(200):
            self.assertIsNotNone(viewer.message())
        self.assertEqual(pings, [])

    def test_the_bus_goes_away(self):
        simulator = self.start_sim("--frozen")
        server, port, _ = self.serve()
        viewer = self.viewer(port)
        self.interrupt(simulator)
        self.assertIsNone(viewer.text("none"))
        _, said = server.communicate(timeout=30)
        self.assertEqual(server.returncode, 1)
        self.assertIn("sim", said)


if __name__ == "__main__":
    harness.main()
