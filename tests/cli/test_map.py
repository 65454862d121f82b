"""amiroctl map: what its files hold, how it agrees with true walls, and what is said when it fails."""

import json
import os
import re
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

    def test_a_box_as_picture_and_for_ros(self):
        world = self.path("box.json")
        with open(world, "w", encoding="utf-8") as file:
            json.dump(WORLD, file)
        svg, png, pgm = self.path("box.svg"), self.path("box.png"), self.path("box.pgm")
        out, err = self.map(svg, png, pgm, "--world", world, "--json", duration="15s")
        figures = json.loads(out)
        self.assertGreater(figures["agreement"]["precision"], 0.9)
        self.assertGreater(figures["agreement"]["recall"], 0.9)
        self.assertGreater(figures["agreement"]["explored"], 0.9)
        self.assertGreater(figures["free_m2"], 0.9)
        self.assertGreater(figures["updates"], 50)
        for file in (svg, png, pgm):
            self.assertIn(f"map: {file}", err)
        texts = ["".join(element.itertext()).strip() for element in
                 ElementTree.parse(svg).getroot().iter("{http://www.w3.org/2000/svg}text")]
        for text in ("map by AVR", "true walls", "AVR", "x [m]", "y [m]"):
            self.assertIn(text, texts)
        with open(png, "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
        self.check_ros(pgm)

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

    def test_until_all_is_known(self):
        begin = time.monotonic()
        out, _ = self.run_tool("map", self.path("a.pgm"), "--scan", "200ms", "--watch", "--duration", "2s")
        self.assertIn("what was seen", out)
        self.assertLess(time.monotonic() - begin, 12)
        self.assertNotIn("{U,", "".join(self.avr.heard))  # it only watched

    def test_interrupted_it_draws_what_it_has(self):
        file = self.path("a.pgm")
        tool = self.start("map", file, "--scan", "200ms")
        time.sleep(4)
        _, err = self.interrupt(tool)
        self.assertEqual(tool.returncode, 130, err)
        self.check_header(file)

    def check_header(self, file):
        with open(file, "rb") as picture:
            self.assertEqual(picture.read(2), b"P5")

    def test_the_robot_is_lost(self):
        file = self.path("a.pgm")
        tool = self.start("map", file, "--scan", "200ms")
        time.sleep(4)
        self.central.drop(self.avr)
        _, err = tool.communicate(timeout=20)
        self.assertEqual(tool.returncode, 1)
        self.assertIn("AVR is lost", err)
        self.check_header(file)

    def test_two_robots_need_their_starts(self):
        self.central.robots.append(Robot("Arduino", pose=(0.8, 0.5, 0.0)))
        _, err = self.map(self.path("a.pgm"), code=2)
        self.assertIn("nobody said where AVR began", err)
        self.assertIn("--start AVR=", err)
        self.map(self.path("a.pgm"), "--start", "AVR=0.4,0.5,0", "--start", "Arduino=0.8,0.5,0", duration="2s")
        self.map(self.path("b.pgm"), "--robots", "AVR", duration="1s")

    def test_wrong_words(self):
        for words, text in ((["a.gif"], "no kind of map"), (["a.svg", "--resolution", "0"], "no size of a cell"),
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
        _, err = self.map("/proc/a.pgm", duration="1s", code=1)
        self.assertIn("/proc/a.pgm", err)

    def test_without_gnuplot(self):
        self.environment["PATH"] = self.folder
        _, err = self.map(self.path("a.svg"), duration="1s", code=1)
        self.assertIn("gnuplot-nox; or write a .pgm", err)
        self.map(self.path("a.pgm"), duration="1s")


if __name__ == "__main__":
    main()
