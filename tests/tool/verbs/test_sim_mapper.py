"""amiroctl sim --robots: mappers in real time, spoken to as a server does."""

import json
import os
import re
import select
import signal
import time

from harness import Case, main


class Line:
    """A serial line as a program has it open."""

    def __init__(self, case, path):
        self.line = os.open(path, os.O_RDWR | os.O_NOCTTY)
        self.text = ""
        case.addCleanup(self.close)

    def close(self):
        if self.line is not None:
            os.close(self.line)
        self.line = None

    def write(self, text):
        os.write(self.line, text.encode())

    def read(self, limit=0.1):
        if select.select([self.line], [], [], limit)[0]:
            self.text += os.read(self.line, 65536).decode("latin-1")
        return self.text

    def wait_for(self, pattern, limit=30):
        """What matches; of what has not been waited for yet."""
        give_up = time.monotonic() + limit
        while time.monotonic() < give_up:
            match = re.search(pattern, self.read())
            if match:
                self.text = self.text[match.end():]
                return match
        raise AssertionError(f"{pattern!r} does not come; there is {self.text[-500:]!r}")

    def find(self, robots, limit=30):
        """Returns when the central that scans has found so many."""
        give_up = time.monotonic() + limit
        while time.monotonic() < give_up:
            self.write("list\n")
            if self.wait_for(r"((?:\d+:\S+\n)*)end of list\n")[1].count("\n") >= robots:
                return
        raise AssertionError(f"{robots} robots are not found; there is {self.text[-500:]!r}")


UPDATE = r"\{U,(-?\d+),(-?\d+),(-?\d+),\d+,\d+,\d+,\d+,\d+\}"


class Simulated(Case):
    def sim(self, *arguments):
        sim = self.start("sim", *arguments)
        for line in sim.stderr:
            if "Ctrl-C ends it" in line:
                self.told = line
                return sim
        self.fail(f"the simulator ended with {sim.wait()}")

    def central(self):
        return Line(self, os.path.join(self.folder, "ocm", "central"))

    def test_a_robot_drives_where_it_is_told(self):
        sim = self.sim("--robots", "1", "--speed", "10")
        self.assertIn("simulated 1 mapper in 'square'", self.told)
        line = self.central()
        line.write("start\n")
        line.wait_for("scanning\n")
        line.find(1)
        line.write("list\n")
        line.wait_for("0:C00000000000:AVR\nend of list\n")
        line.write("conn 0\n")
        line.wait_for("connected 0\n")
        line.wait_for(r"\[0\]:AVR:\{H,")
        line.write("{S,CON}\n")
        line.wait_for(r"\[0\]:AVR:\{U,")
        line.write("{U,90,50}\n")
        # An idle may still be one of before the set point: it has arrived when its updates say so, and it is idle.
        give_up = time.monotonic() + 30
        x = y = heading = 0
        while time.monotonic() < give_up:
            text = line.read().replace("[0]:AVR:", "")
            updates = re.findall(UPDATE, text)
            x, y, heading = map(int, updates[-1]) if updates else (0, 0, 0)
            near = [match.end() for match in re.finditer(UPDATE, text) if abs(int(match[2]) - 50) < 15]
            if near and abs(heading - 90) < 10 and "{S,IDL}" in text[near[0]:]:
                break
        self.assertIn("{S,IDL}", text[near[0]:])
        self.assertLess(abs(x), 15)
        self.assertLess(abs(y - 50), 15)
        self.assertLess(abs(heading - 90), 10)
        line.close()
        _, error = self.interrupt(sim)
        self.assertEqual(sim.returncode, 130)
        self.assertRegex(error, r"AVR +links 1, handshakes \d+, updates \d+, idles \d+, set points 1, arrived 1, stops 0")
        self.assertRegex(error, r"packets to it 2; from it \d+\n")
        self.assertEqual(os.listdir(os.path.join(self.folder, "ocm")), ["line"])

    def test_verbs_one_after_the_other_know_the_robots_bodies(self):
        """In the README's order: the first verb hears the handshakes, and the links stay up."""
        self.sim("--robots", "2", "--world", "labyrinth", "--speed", "10")
        for attempt in range(2):
            out, _ = self.run_tool("robots", "--json", "--listen", "2s")
            for line in out.splitlines():
                body = json.loads(line)["body"]
                self.assertIsNotNone(body, f"{attempt}: {line}")
                self.assertEqual(body["sensor_out_cm"], 3)
        before = json.loads(self.run_tool("robots", "--json")[0].splitlines()[0])["pose"]
        self.run_tool("goto", "AVR", "0", "20")
        file = os.path.join(self.folder, "labyrinth.pgm")
        _, error = self.run_tool("map", file, "--world", "labyrinth", "--duration", "3s")
        self.assertNotIn("usual", error)
        # Its frame is still that of where it was switched on.
        after = json.loads(self.run_tool("robots", "--json")[0].splitlines()[0])["pose"]
        self.assertNotEqual(before, after)

    def test_a_program_that_stops_reading_loses_what_there_is_no_room_for_and_that_is_told(self):
        sim = self.sim("--robots", "1", "--speed", "1000")
        line = self.central()
        line.write("start\n")
        line.find(1)
        line.write("stop\nconn 0\n")
        line.wait_for("connected 0\n")
        line.wait_for(r"\{H,")
        for _ in range(3):
            line.write("{S,CON}\n")
        line.wait_for(r"\{U,")
        # Five updates of some 28 bytes in each of its seconds, a thousand of which pass in one: the room is for 64 KiB.
        time.sleep(3)  # in which more comes than there is room for
        line.close()
        _, error = self.interrupt(sim)
        self.assertRegex(error, r"\d+ bytes that the program did not read")

    def test_lost_packets_are_told(self):
        sim = self.sim("--robots", "2", "--speed", "10", "--radio-loss", "0.2", "--seed", "3")
        line = self.central()
        line.write("start\n")
        line.find(2)
        line.write("stop\nconn 0\n")
        line.wait_for("found 2\n")
        line.wait_for("connected 0\n")
        line.wait_for(r"\{H,")
        for _ in range(3):
            line.write("{S,CON}\n")
            time.sleep(0.1)
        time.sleep(1)  # packets go, and are lost
        _, error = self.interrupt(sim)
        self.assertRegex(error, r"from it \d+, \d+ lost in the air")

    def test_worlds(self):
        for world, robots in (("labyrinth", 2), ("range", 2)):
            sim = self.sim("--world", world)
            self.assertRegex(self.told, f"simulated {robots} mappers? in '{world}'")
            self.interrupt(sim)
        path = os.path.join(self.folder, "mine.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"name": "mine", "walls": [[[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]],
                       "robots": [{"name": "A", "model": "arduino", "at": [0, 0], "heading": 0}]}, file)
        sim = self.sim("--world", path, "--robots", "3")
        self.assertIn("simulated 3 mappers in 'mine'", self.told)
        self.interrupt(sim)
        with open(path, "w", encoding="utf-8") as file:
            file.write('{"name": "mine", "walls": 7}')
        _, error = self.run_tool("sim", "--world", path, code=1)
        self.assertIn(path, error)
        _, error = self.run_tool("sim", "--world", "nowhere", code=1)
        self.assertIn("there is no world 'nowhere'", error)
        self.assertIn("labyrinth", error)

    def test_sim_and_map_say_the_same_of_a_world_that_is_not_there(self):
        for world in ("nowhere", "/tmp", self.folder + "/none.json"):
            said = [self.run_tool(*words, "--world", world, code=1)[1].replace(words[0] + ": ", "", 1)
                    for words in (["sim"], ["map", "a.svg"])]
            self.assertEqual(said[0], said[1])
            self.assertIn(f"amiroctl: there is no world '{world}'", said[0])

    def test_a_verb_for_a_bus_says_that_mappers_run(self):
        for words in (["--robots", "1"], ["--robots", "1", "--lines"]):
            sim = self.sim(*words)
            for verb in (["listen"], ["publish", "gyro", "1s"], ["listen", "--bus", "sim"]):
                _, error = self.run_tool(*verb, code=1)
                self.assertIn("mappers run, but have no CAN bus", error)
                self.assertIn("mappers take `amiroctl robots`", error)
                self.assertNotIn("and no simulator runs", error)
            self.interrupt(sim)
        self.assertIn("no simulator runs", self.run_tool("listen", code=1)[1])

    def test_a_verb_for_mappers_says_that_an_amiro_runs(self):
        self.start_sim()
        self.assertIn("the simulator that runs is an AMiRo", self.run_tool("robots", code=1)[1])

    def test_too_many_links(self):
        self.sim("--robots", "2", "--links", "1", "--speed", "10")
        line = self.central()
        line.write("start\n")
        line.find(2)
        line.write("conn 0\n")
        line.wait_for("connected 0\n")
        line.write("*conn 1\n")
        line.wait_for("error: no link to 1\n")

    def test_each_on_a_line_of_its_own_and_a_wired_central(self):
        sim = self.sim("--robots", "2", "--lines", "--speed", "10")
        self.assertEqual(sorted(name for name in os.listdir(os.path.join(self.folder, "ocm", "line"))
                                if not name.endswith(".lock")), ["AVR", "robot_2"])
        own = Line(self, os.path.join(self.folder, "ocm", "line", "AVR"))
        own.wait_for(r"^\{H,[^}]*\}\n")
        own.write("{S,CON}\n")
        own.wait_for(UPDATE)
        own.close()
        time.sleep(0.2)  # the simulator sees that the line was closed
        central = self.start("central", "--pty")
        self.assertIn("Ctrl-C ends it", central.stderr.readline())
        line = self.central()
        line.write("start\nlist\n")
        line.wait_for("0:020000000000:AVR\n1:020000000001:robot_2\nend of list\n")
        line.write("conn 1\n")
        line.wait_for(r"\[1\]:robot_2:\{H,")
        line.write("{S,CON}\n")
        line.wait_for(r"\[1\]:robot_2:\{U,")
        line.close()
        _, error = self.interrupt(central)
        self.assertRegex(error, r"robot_2 +links 1, ")
        _, error = self.interrupt(sim)
        self.assertRegex(error, r"AVR +links 1, ")
        self.assertEqual(os.listdir(os.path.join(self.folder, "ocm", "line")), [])

    def test_what_a_killed_one_has_left_leads_nowhere(self):
        sim = self.sim("--robots", "1", "--lines")
        sim.kill()
        sim.wait()
        links = os.path.join(self.folder, "ocm", "line")
        self.assertEqual(sorted(os.listdir(links)), ["AVR", "AVR.lock"])
        other, mine = os.openpty()  # a terminal of another user, which may have got the number
        os.unlink(os.path.join(links, "AVR"))
        os.symlink(os.ttyname(mine), os.path.join(links, "AVR"))
        out, _ = self.run_tool("central", stdin="start\nlist\n")
        self.assertEqual(out, "scanning\nend of list\n")
        os.close(mine)
        os.close(other)
        self.sim("--robots", "1", "--lines")
        out, _ = self.run_tool("central", stdin="start\nlist\n")
        self.assertEqual(out, "scanning\n0:020000000000:AVR\nend of list\n")

    def test_one_central_at_a_time(self):
        self.sim("--robots", "1")
        _, error = self.run_tool("sim", "--robots", "1", code=1)
        self.assertIn("another program serves", error)

    def test_wrong_usage(self):
        for arguments, words in ((["--robots", "1", "--boards", "qemu"], "sim: --boards with mappers"),
                                 (["--robots", "1", "--bus-errors", "3"], "sim: --bus-errors with mappers"),
                                 (["--robots", "1", "--frozen"], "sim: --frozen with mappers"),
                                 (["--world", "square", "--without", "light_ring"], "sim: --without with mappers"),
                                 (["--lines"], "sim: --lines without --robots"),
                                 (["--radio-loss", "0.1"], "sim: --radio-loss without --robots"),
                                 (["--robots", "1", "--lines", "--links", "1"], "sim: --links with --lines")):
            _, error = self.run_tool("sim", *arguments, code=2)
            self.assertIn(words, error)
        _, error = self.run_tool("--bus", "vcan0", "sim", "--robots", "1", code=2)
        self.assertIn("sim: --bus with mappers", error)
        _, error = self.run_tool("--spec", "/nowhere.json", "sim", "--robots", "1", code=2)
        self.assertIn("sim: --spec with mappers", error)
        for arguments in (["--robots", "0"], ["--robots", "129"], ["--robots", "1", "--radio-loss", "2"]):
            self.run_tool("sim", *arguments, code=2)

    def test_signals(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)):
            sim = self.sim("--robots", "1")
            self.interrupt(sim, number)
            self.assertEqual(sim.returncode, code)


if __name__ == "__main__":
    main()
