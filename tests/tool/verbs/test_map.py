"""amiroctl map: what its files hold, how it agrees with true walls, and what is said when it fails."""

import contextlib
import fcntl
import json
import os
import pty
import re
import resource
import signal
import struct
import termios
import time
import xml.etree.ElementTree as ElementTree

from harness import Case, main
from played_central import Central, Robot

# The played robots' room as a world.
WORLD = {"name": "box", "walls": [[[0, 0], [1.2, 0], [1.2, 1.0], [0, 1.0], [0, 0]]],
         "central": {"at": [0.6, 0.5], "range": 8},
         "robots": [{"name": "AVR", "model": "avr", "at": [0.4, 0.5], "heading": 0}]}


class Map(Case):
    def setUp(self):
        super().setUp()
        self.avr = Robot("AVR", pose=(0.4, 0.5, 0.0))
        self.central = Central(self.folder, [self.avr], link="ocm/central")
        self.addCleanup(self.central.close)

    def path(self, name):
        return os.path.join(self.folder, name)

    def map(self, *arguments, code=0, duration="6s"):
        return self.run_tool("map", *arguments, "--duration", duration, "--scan", "200ms", code=code)

    def start_map(self, *arguments):
        """Until the robot has been sent somewhere: then there is something to draw."""
        tool = self.start("map", *arguments, "--scan", "200ms")
        self.wait_until(lambda: any(line.startswith("{U,") for line in self.avr.heard))
        return tool

    def wait_until(self, done, seconds=10):
        end = time.monotonic() + seconds
        while not done():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)

    def test_a_box_as_picture_and_for_ros(self):
        world = self.path("box.json")
        with open(world, "w", encoding="utf-8") as file:
            json.dump(WORLD, file)
        svg, png, pgm = self.path("box.svg"), self.path("box.png"), self.path("box.pgm")
        out, err = self.map(svg, png, pgm, "--world", world, "--json", duration="12s")  # enough on a busy machine, too
        figures = json.loads(out)
        self.assertEqual((figures["done"], figures["ended"]), (False, "duration"))
        # These robots know exactly where they are; what is left are the corners, which a second place would show.
        self.assertGreater(figures["agreement"]["precision"], 0.97)
        self.assertGreater(figures["agreement"]["recall"], 0.9)
        self.assertGreater(figures["agreement"]["explored"], 0.8)
        self.assertGreater(figures["free_m2"], 0.9)
        self.assertGreater(figures["updates"], 50)
        self.assertEqual(set(figures), {"seconds", "done", "ended", "robots", "border_known", "free_m2", "updates", "turning", "beams", "goals", "calls_back",
                                        "agreement"})
        self.assertEqual((figures["robots"], figures["calls_back"], figures["agreement"]["tolerance_m"]), (1, 0, 0.06))
        self.assertGreaterEqual(figures["seconds"], 12)
        self.assertTrue(0 < figures["border_known"] <= 1, figures)
        self.assertLess(figures["free_m2"], 1.3)  # of 1.2 square metres
        self.assertGreaterEqual(figures["goals"], 1)
        self.assertEqual(figures["beams"], 4 * figures["updates"], figures)  # of four sensors
        for file in (svg, png, pgm):
            self.assertIn(f"map: {file}", err)
        texts = ["".join(element.itertext()).strip() for element in
                 ElementTree.parse(svg).getroot().iter("{http://www.w3.org/2000/svg}text")]
        for text in ("map by AVR", "true walls", "AVR", "x [m]", "y [m]"):
            self.assertIn(text, texts)
        with open(png, "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
        self.check_ros(pgm)
        # The free area is that of the free cells of the picture.
        with open(pgm, "rb") as file:
            self.assertAlmostEqual(figures["free_m2"], re.sub(rb"^P5\n.*\n.*\n255\n", b"", file.read()).count(254) * 0.04**2, delta=1e-4)
        # No other program has joined, and none has removed the socket.
        self.assertNotIn("it serves the central's line", err)
        self.assertNotIn("was removed", err)

    def check_ros(self, pgm):
        with open(pgm, "rb") as file:
            data = file.read()
        head = re.match(rb"P5\n#[^\n]*\n(\d+) (\d+)\n255\n", data)
        width, height = int(head[1]), int(head[2])
        cells = data[head.end():]
        self.assertEqual(len(cells), width * height)
        self.assertLessEqual(set(cells), {0, 205, 254})
        with open(pgm.replace(".pgm", ".yaml"), encoding="ascii") as file:
            yaml = dict(line.strip().split(": ", 1) for line in file)
        self.assertEqual(yaml["image"], os.path.basename(pgm))
        self.assertEqual(float(yaml["resolution"]), 0.04)
        x, y, _ = map(float, yaml["origin"].strip("[]").split(","))
        # The lower left corner of the picture, a cell outside of the walls.
        self.assertAlmostEqual(x, 0, delta=0.4)
        self.assertAlmostEqual(y, 0, delta=0.4)
        self.assertAlmostEqual(width * 0.04, 1.2, delta=0.4)
        self.assertAlmostEqual(height * 0.04, 1.0, delta=0.4)
        # Where the robot began it is free; the row counts from the top.
        row = height - 1 - int((0.5 - y) / 0.04)
        self.assertEqual(cells[row * width + int((0.4 - x) / 0.04)], 254)
        # The left wall is black somewhere near x = 0, at the same height.
        near = [cells[row * width + int((edge - x) / 0.04)] for edge in (-0.04, 0.0, 0.04)]
        self.assertIn(0, near)

    def test_only_watched(self):
        begin = time.monotonic()
        file = self.path("a.pgm")
        out, _ = self.map(file, "--watch", duration="1s")
        self.assertRegex(out, r"^what was seen before --duration was over, in 1 s: [01]\.\d\d m2 free, \d+ % of their border known; "
                              r"[1-9]\d* updates? drawn, \d+ not, because a robot turned; 0 goals\n$")
        self.assertLess(time.monotonic() - begin, 11)
        self.assertNotIn("{U,", "".join(self.avr.heard))
        self.check_drawn(file)

    def test_only_watched_it_says_nothing_of_robots_that_are_held(self):
        """For it sends none."""
        tool = self.start("map", self.path("a.pgm"), "--watch", "--scan", "200ms")
        self.wait_until(lambda: self.avr.confirmed)
        self.run_tool("goto", "AVR", "0", "0")
        self.assertEqual(self.run_tool("unpause", "AVR")[0], "AVR: goes on\n")
        _, err = self.interrupt(tool)
        self.assertNotIn("held", err)
        self.assertNotIn("goes on", err)

    def test_a_robot_that_is_lost_and_is_back_is_said_once_each(self):
        tool = self.start("map", self.path("a.pgm"), "--watch", "--scan", "200ms")

        def said():
            return next(line for line in tool.stderr if "AVR" in line)
        self.wait_until(lambda: self.avr.confirmed)
        self.avr.silent = True  # for longer than its deadline
        self.assertEqual(said(), "map: AVR is lost\n")
        self.avr.silent = False
        self.assertEqual(said(), "map: AVR is back\n")
        self.central.drop(self.avr)
        self.assertEqual(said(), "map: AVR is lost\n")
        self.interrupt(tool)

    def test_of_two_robots_that_are_lost_each_is_said_once_and_none_is_back(self):
        arduino = Robot("Arduino", pose=(0.8, 0.5, 0.0))
        self.central.robots.append(arduino)
        tool = self.start("map", self.path("a.pgm"), "--watch", "--scan", "200ms", "--start", "AVR=0.4,0.5,0", "--start", "Arduino=0.8,0.5,0")

        def said():
            return next(line for line in tool.stderr if "is lost" in line or "is back" in line)
        self.wait_until(lambda: self.avr.confirmed and arduino.confirmed)
        self.avr.silent = True  # for longer than its deadline
        self.assertEqual(said(), "map: AVR is lost\n")
        self.central.drop(arduino)
        self.assertEqual(said(), "map: Arduino is lost\n")
        _, err = self.interrupt(tool)
        self.assertNotIn("is lost", err)
        self.assertNotIn("is back", err)

    def test_a_beam_that_ends_at_another_robot_is_one_of_its_four(self):
        # What it sees at its right is too near to be measured, and is one of the four, too.
        self.avr.x, self.avr.y = 0.5, 0.08
        self.avr.start = (0.5, 0.08, 0.0)
        self.central.robots.append(Robot("Arduino", pose=(1.1, 0.08, 0.0)))  # before the wall that the AVR sees ahead
        out, _ = self.map(self.path("a.pgm"), "--watch", "--json", "--start", "AVR=0.5,0.08,0", "--start", "Arduino=1.1,0.08,0", duration="3s")
        figures = json.loads(out)
        self.assertEqual(figures["robots"], 2)
        self.assertGreater(figures["updates"], 0)
        self.assertEqual(figures["beams"], 4 * figures["updates"], figures)

    def test_on_a_terminal_it_says_each_ten_seconds_how_far_it_is(self):
        terminal, end = pty.openpty()
        self.addCleanup(os.close, terminal)
        # Cells of such a size that what is free ahead of it ends in the last one that is stored, 32 of them from the first.
        self.avr.x = 0.2
        self.avr.start = (0.2, 0.5, 0.0)
        file = self.path("a.pgm")
        tool = self.start("map", file, "--watch", "--duration", "12s", "--scan", "200ms", "--resolution", "1.967", "--json", stderr=end)
        os.close(end)
        out, _ = tool.communicate(timeout=60)
        said = self.read_to_the_end(terminal)
        self.assertEqual(tool.returncode, 0, said)
        told = re.findall(rb"map: (\d+) s: [01]\.\d\d m2 free, [1-9]\d* updates\r\n", said)
        self.assertEqual(len(told), 1, said)
        self.assertIn(int(told[0]), range(10, 100))
        # The outermost cells count, too.
        with open(file, "rb") as picture:
            free = re.sub(rb"^P5\n.*\n.*\n255\n", b"", picture.read()).count(254)
        self.assertAlmostEqual(json.loads(out)["free_m2"], free * 0.01967**2, delta=1e-4)

    def read_to_the_end(self, terminal):
        """What a program has written there, which has ended."""
        said = b""
        with contextlib.suppress(OSError):  # its end
            while piece := os.read(terminal, 4096):
                said += piece
        return said

    def check_drawn(self, file):
        """Some of the room is free."""
        with open(file, "rb") as picture:
            data = picture.read()
        head = re.match(rb"P5\n#[^\n]*\n(\d+) (\d+)\n255\n", data)
        self.assertGreater(data[head.end():].count(254), 100)

    def test_interrupted_it_draws_what_it_has_and_stops_the_robot(self):
        self.avr.speed = 1
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            with self.subTest(number=number):
                self.avr.heard.clear()
                svg, pgm = self.path(f"{code}.svg"), self.path(f"{code}.pgm")
                tool = self.start_map(svg, pgm, "--title", "a 'room'")
                self.avr.loses = 3
                out, err = self.interrupt(tool, number)
                self.assertEqual(self.avr.heard[-4:], ["{U,0,0}"] * 4)
                self.assertEqual(tool.returncode, code, err)
                self.assertIn("what was seen before it was interrupted", out)
                self.assertIn(f"map: {svg}", err)
                texts = ["".join(element.itertext()).strip() for element in
                         ElementTree.parse(svg).getroot().iter("{http://www.w3.org/2000/svg}text")]
                self.assertIn("a 'room'", texts)
                self.assertRegex("\n".join(texts), r"(?m)^\d+ s, \d\.\d\d m² free$")
                self.check_drawn(pgm)
                self.assertEqual(self.avr.heard[-1], "{U,0,0}")

    def test_a_place_that_is_not_known_is_a_failure_and_says_why(self):
        world = self.path("box.json")
        with open(world, "w", encoding="utf-8") as file:
            json.dump(WORLD | {"central": {"at": [0.6, 0.5], "range": 0.45}}, file)
        out, _ = self.map(self.path("a.pgm"), "--world", world, "--json", code=1, duration="60s")
        figures = json.loads(out)
        self.assertEqual((figures["done"], figures["ended"]), (False, "out_of_range"))
        self.assertLess(figures["border_known"], 0.9)
        # So is one beyond the range that is typed, which goes before that of the world.
        with open(world, "w", encoding="utf-8") as file:
            json.dump(WORLD, file)
        # On a terminal lines are broken; those that go on begin with four blanks.
        terminal, end = pty.openpty()
        self.addCleanup(os.close, terminal)
        fcntl.ioctl(end, termios.TIOCSWINSZ, struct.pack("4H", 24, 80, 0, 0))
        tool = self.start("map", self.path("a.pgm"), "--world", world, "--range", "0.45", "--duration", "60s", "--scan", "200ms", stdout=end)
        os.close(end)
        _, err = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 1, err)
        broken = self.read_to_the_end(terminal).decode().replace("\r\n", "\n")
        self.assertLessEqual(max(map(len, broken.splitlines())), 80, broken)
        self.assertRegex(broken, r"\nagreement .*\n    \S.*\n$")
        out = broken.replace("\n    ", " ")
        self.assertRegex(out, r"not all: the rest is out of the radio's range, in \d+ s: .* m2 free, \d\d? % of their border known; "
                              r"\d+ updates? drawn, \d+ not, because a robot turned; \d+ goals?\n")
        self.assertRegex(out, r"\nagreement with the true walls within 6 cm: precision [01]\.\d{3}, recall [01]\.\d{3}; explored [01]\.\d{3}\n$")

    def test_the_robot_is_lost(self):
        file = self.path("a.pgm")
        tool = self.start_map(file)
        self.central.drop(self.avr)
        out, err = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 1)
        self.assertIn("AVR is lost", err)
        self.assertIn("what was seen before every robot was lost", out)
        self.check_drawn(file)

    def test_a_record_that_has_not_all(self):
        """The map is drawn, and the exit code says that something is missing."""
        def small():
            resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))  # of the record; the map is smaller
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        file = self.path("a.pgm")
        tool = self.start("map", file, "--duration", "4s", "--scan", "200ms", "--resolution", "4", "--record", self.path("room.line"),
                          preexec_fn=small)
        out, err = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 1, out + err)
        self.assertEqual(err.count("is not recorded"), 1)
        self.assertIn("before --duration was over,", out)
        self.check_drawn(file)

    def test_the_central_is_gone(self):
        svg, pgm = self.path("a.svg"), self.path("a.pgm")
        tool = self.start_map(svg, pgm, "--json")
        self.central.unplug()
        out, err = tool.communicate(timeout=60)
        self.assertEqual(tool.returncode, 1)
        self.assertIn("is gone", err)
        self.assertIn(f"map: {svg}", err)
        figures = json.loads(out)
        self.assertEqual(figures["ended"], "central_gone")
        self.assertGreater(figures["seconds"], 0)
        self.assertEqual(ElementTree.parse(svg).getroot().tag, "{http://www.w3.org/2000/svg}svg")
        self.check_drawn(pgm)

    def test_the_central_is_gone_before_anything_was_seen(self):
        self.avr.mumbles = True
        file = self.path("a.pgm")
        tool = self.start("map", file, "--scan", "200ms")
        self.wait_until(lambda: "{S,UNP}" in self.avr.heard)
        self.central.unplug()
        out, err = tool.communicate(timeout=60)
        self.assertEqual((tool.returncode, out), (1, ""))
        self.assertIn("is gone", err)
        self.assertIn("map: no update came that could be drawn\n", err)
        self.assertFalse(os.path.exists(file))

    def test_a_robot_that_was_connected_before_is_asked_for_its_size(self):
        for knows, drawn_as_usual in ((True, False), (False, True)):
            with self.subTest(knows=knows):
                self.avr.knows_who = knows
                self.run_tool("robots", "--scan", "200ms", "--listen", "200ms")
                self.avr.heard.clear()
                _, err = self.map(self.path("a.pgm"), duration="4s")
                self.assertEqual("the usual one is taken" in err, drawn_as_usual, err)
                if not knows:
                    self.assertEqual(self.avr.heard.count("{S,WHO}"), 6)

    def test_a_robot_is_given_time_to_say_its_size(self):
        self.run_tool("robots", "--scan", "200ms", "--listen", "200ms")
        self.avr.who_late = 0.7
        _, err = self.map(self.path("a.pgm"), duration="1s")
        self.assertNotIn("the usual one is taken", err)

    def test_two_robots_need_their_starts(self):
        self.central.robots.append(Robot("Arduino", pose=(0.8, 0.5, 0.0)))
        _, err = self.map(self.path("a.pgm"), code=2)
        self.assertIn("no start pose for AVR", err)
        self.assertIn("--start AVR=", err)
        self.map(self.path("a.pgm"), "--start", "AVR=0.4,0.5,0", "--start", "Arduino=0.8,0.5,0", duration="1s")
        self.map(self.path("b.pgm"), "--robots", "AVR", duration="500ms")

    def test_names_that_no_robot_has(self):
        for words in (["--robots", "avr"], ["--start", "avr=0,0,0"]):
            with self.subTest(words=words):
                _, err = self.map(self.path("a.pgm"), *words, code=1)
                self.assertIn("no robot 'avr'", err)
                self.assertIn("AVR (index 0, address C00000000000)", err)
        self.assertNotIn("{U,", "".join(self.avr.heard))

    def test_wrong_words(self):
        for words, text in ((["a.gif"], "no kind of map"), (["a.svg", "--resolution", "0"], "no size of a cell"),
                            (["a.svg", "--range", "0"], "0.1 to 10000"), (["a.svg", "--range", "nan"], "0.1 to 10000"),
                            (["a.svg", "--start", "AVR"], "NAME=X,Y,DEG"), (["a.svg", "--start", "AVR=1,2"], "no start"),
                            (["a.svg", "--start", "AVR=1,2,3x"], "no start"),
                            (["a.svg", "--start", "AVR=nan,2,3"], "no start"),
                            (["a.svg", "--start", "AVR=1e9,2,3"], "no start"),
                            (["a.svg", "--duration", "soon"], "soon"), ([], "file")):
            with self.subTest(words=words):
                _, err = self.run_tool("map", *words, code=2)
                self.assertIn(text.lower(), err.lower())
        _, err = self.run_tool("map", "a.svg", "--world", self.path("none.json"), code=1)
        self.assertIn("none.json", err)

    def test_nothing_is_written_where_it_cannot_be(self):
        # The others are written all the same.
        file, full = self.path("a.pgm"), self.path("full.pgm")
        os.symlink("/dev/full", full)
        _, err = self.map(full, file, duration="1s", code=1)
        self.assertIn(full, err)
        self.assertIn(f"map: {file}", err)
        self.check_drawn(file)

    def test_where_nothing_can_be_written_no_robot_drives(self):
        for name, why in ((self.path("none/a.pgm"), "cannot be written: No such file or directory"), (self.path("folder.pgm"), "it is a folder")):
            os.makedirs(self.path("folder.pgm"), exist_ok=True)
            _, err = self.run_tool("map", name, code=1)  # there is no central either
            self.assertIn(f"amiroctl: map: {name}: {why}", err.replace("it cannot", "cannot"))

    def test_without_gnuplot(self):
        """Said before any robot drives for it: here there is none, and none is looked for."""
        self.environment["PATH"] = self.folder
        _, err = self.run_tool("map", self.path("a.pgm"), self.path("a.svg"), code=1)
        self.assertIn("a.svg: gnuplot is missing", err)
        self.assertIn("gnuplot-nox; or write a .pgm", err)
        self.assertFalse(os.path.exists(self.path("a.pgm")))

    def test_a_pgm_needs_no_gnuplot(self):
        self.environment["PATH"] = self.folder
        file = self.path("a.pgm")
        self.map(file, duration="1s")
        self.check_drawn(file)


if __name__ == "__main__":
    main(together=True)
