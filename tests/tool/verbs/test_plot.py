"""amiroctl plot: the points and axes of an SVG, PNG and PDF by their ending, words, and what is said when it fails."""

import os
import re
import signal
import struct
import xml.etree.ElementTree as ElementTree

from harness import Case, main

START = 1436509052  # 2015-07-10T06:17:32Z


def i16(*values):
    return "".join(f"{value & 0xFF:02X}{value >> 8 & 0xFF:02X}" for value in values)


def i24(value):
    return f"{value & 0xFF:02X}{value >> 8 & 0xFF:02X}{value >> 16 & 0xFF:02X}"


class Plot(Case):
    def log(self, frames, name="drive.log"):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="ascii") as file:
            for ms, frame in frames:
                us = round(ms * 1000)
                file.write(f"({START + us // 1000000}.{us % 1000000:06}) can0 {frame}\n")
        return path

    def gyro(self, count=50):
        return self.log([(100 * i, "608#" + i16(i, 2 * i, -i)) for i in range(count)])

    def script(self, *arguments):
        out, _ = self.run_tool("plot", *arguments, "--script")
        return out

    def blocks(self, script):
        """The data blocks of a script: lists of pieces, pieces are lists of pairs of numbers."""
        return [[[tuple(map(float, line.split())) for line in piece.splitlines()] for piece in block.split("\n\n")]
                for block in re.findall(r"<< EOD\n(.*?)\n?EOD\n", script, re.DOTALL)]

    def texts(self, svg):
        """What is written in a picture, without the tags."""
        return ["".join(element.itertext()).strip() for element in
                ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")]

    def test_a_picture_does_not_replace_its_log(self):
        path = self.log([(0, "608#" + i16(0, 0, 0))], "drive.svg")
        _, err = self.run_tool("plot", path, "gyro.z", "-o", path, "--from", "candump", code=2)
        self.assertIn(f"plot: {path} and {path} are the same file\n", err)
        self.assertGreater(os.path.getsize(path), 0)

    def test_points_and_labels_of_an_svg(self):
        svg, _ = self.run_tool("plot", self.gyro(), "gyro.z")
        texts = self.texts(svg)
        self.assertIn("gyroscope.z [deg/s]", texts)
        self.assertIn("time [s]", texts)
        self.assertIn("AMiRo: drive.log", texts)
        self.assertIn("2015-07-10 06:17:32 UTC, 4.9 s", texts)
        # Each point is marked; the definition of the mark is not a point.
        self.assertEqual(len(re.findall(r"<use xlink:href='#gpPt6' transform", svg)), 50)

    def test_values_are_physical_and_times_from_the_beginning(self):
        path = self.log([(0, "208#02"), (250, "608#" + i16(3, 0, -1))])
        self.assertEqual(self.blocks(self.script(path, "gyro.x", "gyro.z")), [[[(0.25, 0.0525)]], [[(0.25, -0.0175)]]])

    def test_a_panel_for_each_unit(self):
        frames = [(100 * i, "608#" + i16(i, i, i)) for i in range(9)]
        frames += [(100 * i + 1, "609#" + i16(i, i, i)) for i in range(9)]
        path = self.log(sorted(frames))
        script = self.script(path, "gyro.*", "accel.z")
        self.assertEqual(len(re.findall(r"^plot ", script, re.MULTILINE)), 2)
        self.assertEqual(len(self.blocks(script)), 4)
        svg, _ = self.run_tool("plot", path, "gyro.*", "accel.z")
        texts = self.texts(svg)
        for text in ("gyroscope.x", "gyroscope.y", "gyroscope.z", "[deg/s]", "accelerometer.z [g]"):
            self.assertIn(text, texts)
        self.assertEqual(texts.count("time [s]"), 1)

    def test_a_path(self):
        # Two frames a sample: velocity on 0x602, pose on 0x603. Poses in 24 bits each.
        frames = []
        for i in range(20):
            frames += [(100 * i, "602#" + "00" * 8), (100 * i + 1, "603#" + i24(1000 * i) + i24(-500 * i) + "0000")]
        path = self.log(frames)
        (piece,), = self.blocks(self.script(path, "odometry.x:odometry.y"))
        self.assertEqual(len(piece), 20)
        (x0, y0), (x1, y1) = piece[0], piece[1]
        self.assertEqual((x0, y0), (0, 0))
        self.assertEqual(x1, -2 * y1)
        self.assertGreater(x1, 0)
        svg, _ = self.run_tool("plot", path, "odometry.x:odometry.y")
        texts = self.texts(svg)
        self.assertIn("odometry.pose.x [m]", texts)
        self.assertIn("odometry.pose.y [m]", texts)
        # A name that several frames have means each of them.
        self.assertEqual(len(self.blocks(self.script(path, "odometry.x"))), 2)

    def test_png_has_its_size_and_pdf_is_one(self):
        png = os.path.join(self.folder, "a picture.png")
        _, err = self.run_tool("plot", self.gyro(), "gyro.z", "-o", png, "--size", "640x480")
        self.assertIn("a picture.png: 50 points of 1 curve", err)
        with open(png, "rb") as file:
            head = file.read(24)
        self.assertEqual(head[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", head[16:24]), (640, 480))
        pdf = os.path.join(self.folder, "it's.pdf")
        self.run_tool("plot", self.gyro(), "gyro.z", "-o", pdf)
        with open(pdf, "rb") as file:
            self.assertEqual(file.read(5), b"%PDF-")

    def test_a_huge_log_is_thinned_and_its_peaks_stay(self):
        frames = [(i, "608#" + i16(0, 0, 30000 if i == 17123 else -30000 if i == 23456 else i % 7))
                  for i in range(40000)]
        (piece,), = self.blocks(self.script(self.log(frames), "gyro.z"))
        self.assertLess(len(piece), 4 * 2048 + 1)
        self.assertGreater(len(piece), 2000)
        self.assertIn((17.123, 525), piece)
        self.assertIn((23.456, -525), piece)
        self.assertEqual(piece, sorted(piece))

    def test_points_are_marked_where_there_are_two_hundred_at_most(self):
        for count, kind in ((199, "linespoints"), (200, "linespoints"), (201, "lines")):
            script = self.script(self.log([(i, "608#" + i16(0, 0, i)) for i in range(count)]), "gyro.z")
            (piece,), = self.blocks(script)
            self.assertEqual(len(piece), count)
            marks = " pt 7 ps 0.5" if kind == "linespoints" else ""
            self.assertIn(f"with {kind} lc rgb '#0072B2' lw 1.5{marks} notitle\n", script)

    def test_a_pause_parts_the_curve(self):
        frames = [(100 * i, "608#" + i16(0, 0, i)) for i in range(10)]
        frames += [(10_000 + 100 * i, "608#" + i16(0, 0, i)) for i in range(10)]
        pieces, = self.blocks(self.script(self.log(frames), "gyro.z"))
        self.assertEqual([len(piece) for piece in pieces], [10, 10])

    def test_wrong_frames_are_no_data(self):
        path = self.log([(0, "608#" + i16(1, 1, 1)), (1, "608#00"), (2, "608#R"), (3, "00000608#" + i16(2, 2, 2)),
                         (4, "608##0" + i16(3, 3, 3)), (5, "20000608#" + "00" * 8), (100, "508#" + i16(4, 4, 4))])
        (piece,), = self.blocks(self.script(path, "gyro.z"))
        self.assertEqual(piece, [(0, 0.0175), (0.1, 0.07)])

    def test_a_wrong_field_is_told_with_the_nearest(self):
        path = self.gyro()
        for word, what, remedy in (("gyroscope.xx", "no field 'gyroscope.xx'", "did you mean 'gyroscope.x'?"),
                                   ("gyroscop.x", "no topic 'gyroscop'", "did you mean 'gyroscope'?"),
                                   ("odom.x:ring.*", "may mean several paths", "odometry.velocity.x")):
            _, err = self.run_tool("plot", path, word, code=2)
            self.assertIn(what, err)
            self.assertIn(remedy, err)

    def test_wrong_usage(self):
        path = self.gyro()
        for arguments, what in ((["gyro.z", "-o", "x.jpeg"], "x.jpeg: no kind of picture"),
                                (["gyro.z", "--size", "10x10"], "--size 10x10: no size"),
                                (["gyro.z", "--size", "800"], "--size 800: no size"),
                                ([], "no field to draw"),
                                (["odom.x:odom.y", "gyro.x:gyro.y"], "paths of other units"),
                                (["gyro.z", "gyro.x:gyro.y"], "a path and curves over time")):
            _, err = self.run_tool("plot", path, *arguments, code=2)
            self.assertIn(what, err)

    def test_a_log_that_is_missing(self):
        _, err = self.run_tool("plot", "nofile.log", "gyro.z", code=1)
        self.assertIn("cannot read nofile.log: No such file", err)

    def test_nothing_to_draw_is_an_error(self):
        picture = os.path.join(self.folder, "none.svg")
        _, err = self.run_tool("plot", self.gyro(), "accel.x", "-o", picture, code=1)
        self.assertIn("no accelerometer.x came", err)
        self.assertIn("nothing to draw came from drive.log", err)
        self.assertFalse(os.path.exists(picture))
        _, err = self.run_tool("plot", self.gyro(), "accel.x", "gyro.x", "-o", picture)
        self.assertIn("no accelerometer.x came", err)
        self.assertTrue(os.path.exists(picture))

    def test_without_gnuplot(self):
        self.environment["PATH"] = self.folder
        picture = os.path.join(self.folder, "old.svg")
        with open(picture, "w", encoding="ascii") as file:
            file.write("old")
        _, err = self.run_tool("plot", self.gyro(), "gyro.z", "-o", picture, code=1)
        self.assertIn("gnuplot is missing", err)
        self.assertIn("sudo apt install gnuplot-nox", err)
        with open(picture, encoding="ascii") as file:
            self.assertEqual(file.read(), "old")
        self.assertIn("$d0 << EOD", self.script(self.gyro(), "gyro.z"))

    def test_a_gnuplot_that_draws_nothing(self):
        self.environment["PATH"] = self.folder + ":/usr/bin:/bin"
        for commands, what in (("kill -INT $$", "gnuplot was ended by signal 2"), ("echo 'no font' >&2; exit 1", "no font")):
            with open(os.path.join(self.folder, "gnuplot"), "w", encoding="ascii") as file:
                file.write(f"#!/bin/sh\n{commands}\n")
            os.chmod(os.path.join(self.folder, "gnuplot"), 0o755)
            _, err = self.run_tool("plot", self.gyro(), "gyro.z", "-o", os.path.join(self.folder, "a.svg"), code=1)
            self.assertIn(what, err)
            self.assertIn("--script prints what it would draw", err)
            _, err = self.run_tool("map", os.path.join(self.folder, "a.svg"), code=1)
            self.assertIn(what, err)
            self.assertIn("write a .pgm", err)
            self.assertNotIn("--script", err)

    def test_what_gnuplot_says_is_in_the_message_alone(self):
        """Its lines without empty ones and marks, in one."""
        self.environment["PATH"] = self.folder + ":/usr/bin:/bin"
        with open(os.path.join(self.folder, "gnuplot"), "w", encoding="ascii") as file:
            file.write("#!/bin/sh\nprintf 'plot x\\n     ^\\n\\n\\tline 2: no font\\nend' >&2; exit 1\n")
        os.chmod(os.path.join(self.folder, "gnuplot"), 0o755)
        out, err = self.run_tool("plot", self.gyro(), "gyro.z", code=1)
        self.assertEqual((out, err.split("\n")[0]), ("", "amiroctl: gnuplot draws nothing: plot x; \tline 2: no font; end"))
        # Of much of it the first lines, up to the one with the 300th character.
        for length, more in ((299, "; next"), (300, "")):
            with open(os.path.join(self.folder, "gnuplot"), "w", encoding="ascii") as file:
                file.write(f"#!/bin/sh\nprintf '%s\\nnext\\nlast\\n' {'x' * length} >&2; exit 1\n")
            _, err = self.run_tool("plot", self.gyro(), "gyro.z", code=1)
            self.assertEqual(err.split("\n")[0], f"amiroctl: gnuplot draws nothing: {'x' * length}{more}")

    def test_the_address_of_the_live_page(self):
        """Fields as an address has them, in their order."""
        self.start_sim("--frozen")
        spec = os.path.join(self.folder, "edges.dbc")
        with open(spec, "w", encoding="ascii") as file:
            file.write('BU_: N\nBO_ 256 azAZ09: 8 N\n SG_ zZaA9_0 : 0|8@1+ (1,0) [0|0] "" N\n')
        other = os.path.join(self.folder, "other.dbc")  # names as no C program has them
        with open(other, "w", encoding="ascii") as file:
            file.write('BU_: N\nBO_ 256 Pump: 8 N\n SG_ Oil-T% : 0|8@1+ (1,0) [0|0] "" N\n')
        for words, shows in ((("gyro.z", "ring.sensor_1"), "/gyroscope.z,/proximity_ring.sensor_1.proximity"),
                             (("--spec", other, "Pump.*"), "/Pump.Oil%2DT%25"),
                             (("odom.velocity.x",), "/odometry.velocity.x"), (("--spec", spec, "azAZ09.*"), "/azAZ09.zZaA9_0")):
            out, _ = self.run_tool("plot", "--live", *words, "--port", "0", "--duration", "100ms")
            self.assertRegex(out, rf"^http://127\.0\.0\.1:[0-9]+/#plot={re.escape(shows)}\n$")

    def test_a_day_is_named_where_the_clock_of_the_log_knows_it(self):
        """Times of the first year are no days: they count from the start of a machine, or of a recording."""
        path = os.path.join(self.folder, "clock.log")
        for second, when in ((1, "0 s"), (365 * 24 * 3600, "0 s"), (365 * 24 * 3600 + 1, "1971-01-01 00:00:01 UTC, 0 s")):
            with open(path, "w", encoding="ascii") as file:
                file.write(f"({second}.000000) can0 608#{i16(0, 0, 0)}\n")
            self.assertIn(f"set label 2 '{when}' at ", self.script(path, "gyro.z"))

    def test_specs_of_one_interface_each(self):
        """The same identifier is another message on each interface, and none on a third one."""
        specs = []
        for interface, name in (("can0", "Engine"), ("can1", "Target")):
            path = os.path.join(self.folder, f"{interface}.dbc")
            with open(path, "w", encoding="ascii") as file:
                file.write(f'BU_: N\nBO_ 256 {name}: 8 N\n SG_ Value : 0|8@1+ (1,0) [0|0] "m" N\n')
            specs += ["--spec", f"{interface}={path}"]
        log = os.path.join(self.folder, "two.log")
        with open(log, "w", encoding="ascii") as file:
            file.writelines(f"({START}.{i}00000) can{i % 3} 100#{i:02X}00000000000000\n" for i in range(9))
        out, _ = self.run_tool(*specs, "plot", log, "Engine.Value", "Target.Value", "--script")
        self.assertEqual([[point for piece in block for point in piece] for block in self.blocks(out)],
                         [[(0.0, 0.0), (0.3, 3.0), (0.6, 6.0)], [(0.1, 1.0), (0.4, 4.0), (0.7, 7.0)]])

    def test_names_that_mean_something_to_gnuplot_or_xml(self):
        path = self.log([(100 * i, "608#" + i16(i, i, i)) for i in range(3)], "a'b<c>&{}_^`!.log")
        self.assertIn("set label 1 '?a b?' at", self.script(path, "gyro.z", "--title", "\x1fa b\x7f"))  # no controls of a terminal
        svg, _ = self.run_tool("plot", path, "gyro.z", "--title", "it's `date` <b> {x_1} \\n @home ~a")
        self.assertIn("it's `date` <b> {x_1} \\n @home ~a", self.texts(svg))
        svg, _ = self.run_tool("plot", path, "gyro.z")
        self.assertIn("AMiRo: a'b<c>&{}_^`!.log", self.texts(svg))

    def test_a_single_point_and_a_constant(self):
        self.run_tool("plot", self.log([(0, "608#" + i16(1, 2, 3))]), "gyro.*")
        self.run_tool("plot", self.log([(i, "608#" + i16(0, 0, 0)) for i in range(5)]), "gyro.*", "gyro")
        self.run_tool("plot", self.log([(i, "608#" + i16(0, 0, 0)) for i in range(5)]), "gyro.x:gyro.y")

    def test_where_it_cannot_be_written(self):
        link = os.path.join(self.folder, "full.svg")
        os.symlink("/dev/full", link)
        for output in (link, os.path.join(self.folder, "none/x.svg")):
            _, err = self.run_tool("plot", self.gyro(), "gyro.z", "-o", output, code=1)
            self.assertIn(output, err)

    def test_live(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "20ms")
        picture = os.path.join(self.folder, "live.svg")
        self.run_tool("plot", "live", "gyro.*", "--duration", "3s", "-o", picture)
        with open(picture, encoding="utf-8") as file:
            texts = self.texts(file.read())
        self.assertIn("AMiRo: sim", texts)

    def test_ctrl_c_draws_what_came(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "20ms")
        picture = os.path.join(self.folder, "live.svg")
        plot = self.start("plot", "gyro.z", "-o", picture)
        self.assertIn("bus: sim", plot.stderr.readline())
        self.settle()
        self.run_tool("listen", "gyro", "-n", "5", "--timeout", "20s")  # so many came while it listens
        self.interrupt(plot)
        self.assertEqual(plot.returncode, 128 + signal.SIGINT)
        self.assertTrue(os.path.exists(picture))

    def test_many_points_are_a_line_alone(self):
        for count, marked in ((200, True), (201, False)):
            self.assertEqual("with linespoints" in self.script(self.gyro(count), "gyro.x"), marked)


if __name__ == "__main__":
    main()
