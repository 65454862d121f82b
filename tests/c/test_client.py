"""include/ocm/c/client.h: the example's model is compiled as its page says, and drives the simulated robot."""

import os
import re
import signal
import subprocess
import sys

sys.path.insert(0, os.path.join(os.environ["OCM_SOURCE_DIR"], "tests", "tool", "verbs"))
from harness import SOURCE, Case, main  # noqa: E402
from realtime import RealTime  # noqa: E402
import waiting  # noqa: E402

MODEL = os.path.join(SOURCE, "examples", "6_model.c")
LOOP = os.path.join(SOURCE, "examples", "7_loop.c")
WARNINGS = "-Wall -Wextra -Wconversion -Wsign-conversion -Wshadow -pedantic -Werror".split()
COMPILERS = {
    "gcc": ["gcc", "-std=c99"],
    "clang": ["clang-14", "-std=c99"],
    "C++": ["g++", "-std=c++11", "-x", "c++"],
    "Cortex-A8": ["arm-linux-gnueabihf-gcc", "-std=c99", "-mcpu=cortex-a8", "-static"],
}


class OnTheRobot(Case):
    """The examples end where an input is 200 or 300 ms old: a busy machine may make it so."""
    had_time = RealTime.had_time


    def build(self, compiler="gcc", source=MODEL):
        header, program = os.path.join(self.folder, "amiro.h"), os.path.join(self.folder, f"{os.path.basename(source)}-{compiler}")
        self.run_tool("generate", "c", "-o", header)
        result = subprocess.run([*COMPILERS[compiler], *WARNINGS, "-O1", "-D_GNU_SOURCE", "-I" + self.folder,
                                 "-I" + os.path.join(SOURCE, "include"), source, "-lm", "-o", program],
                                text=True, capture_output=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stderr)
        return ["qemu-arm-static", program] if compiler == "Cortex-A8" else [program]

    def launch(self, command):
        process = waiting.Program(command, env=self.environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self._started.append(process)
        return process

    def set_points(self, listener):
        out, _ = self.interrupt(listener)
        return [sample["fields"] for sample in self.objects(out) if sample["topic"] == "motors"]

    def test_each_compiler_makes_a_model_that_drives(self):
        self.start_sim()
        for compiler in COMPILERS:
            with self.subTest(compiler):
                model = self.build(compiler)
                listener = self.listen("motors")
                out, err = self.launch([*model, "sim", "20"]).communicate(timeout=60)
                self.assertEqual(err, "")
                heading, received, lost = re.fullmatch(r"heading (\S+) rad, (\d+) frames received, (\d+) lost\n", out).groups()
                self.assertLess(abs(float(heading)), 0.1)
                self.assertGreaterEqual(int(received), 40)
                self.assertEqual(lost, "0")
                self.settle()
                points = self.set_points(listener)
                self.assertEqual(len(points), 21)
                self.assertEqual({point["x"] for point in points[:-1]}, {0.05})
                self.assertEqual((points[-1]["x"], points[-1]["z"]), (0, 0))
                # The stream is stopped, too.
                self.run_tool("listen", "odometry", "-n", "1", "--timeout", "200ms", code=1)

    def test_a_loop_at_its_own_pace_drives_by_each_compiler(self):
        self.start_sim()
        for compiler in COMPILERS:
            with self.subTest(compiler):
                loop = self.build(compiler, LOOP)
                listener = self.listen("motors")
                out, err = self.launch([*loop, "sim", "12"]).communicate(timeout=60)
                self.assertEqual(err, "")
                self.assertRegex(out, r"^ended after 12 steps, \d+ of them late, 0 frames lost\n$")
                self.settle()
                speeds = [point["x"] for point in self.set_points(listener)]
                self.assertEqual(len(speeds), 13)
                self.assertEqual(speeds[-1], 0)
                for before, after in zip([0] + speeds[:-1], speeds[:-1]):
                    self.assertLessEqual(abs(after - before), 0.05 + 1e-9)
                if speeds[0] > 0:  # nothing is near
                    self.assertEqual(speeds[:3], [0.02, 0.04, 0.06])
                self.run_tool("listen", "proximity_ring", "-n", "1", "--timeout", "200ms", code=1)

    def test_a_loop_comes_to_rest_before_a_wall(self):
        loop = self.build(source=LOOP)
        self.start_sim()
        listener = self.listen("motors")
        out, err = self.launch([*loop, "sim", "600"]).communicate(timeout=90)
        self.assertEqual(err, "")
        self.assertRegex(out, r"^arrived after \d+ steps")
        self.settle()
        speeds = [point["x"] for point in self.set_points(listener)]
        self.assertEqual(max(speeds), 0.2)
        self.assertEqual(speeds[-1], 0)

    def test_a_loop_does_not_drive_by_old_inputs(self):
        loop = self.build(source=LOOP)
        for topic in ("proximity_ring", "odometry"):
            sim = self.start_sim()
            process = self.launch([*loop, "sim"])
            listener = self.listen("motors")
            listener.stdout.readline()
            self.run_tool("stop", topic, "--priority", "high")
            _, err = process.communicate(timeout=30)
            self.assertEqual(process.returncode, 1)
            self.assertIn("no ring or no odometry for 300 ms", err)
            self.settle()
            self.assertEqual(self.set_points(listener)[-1]["x"], 0)
            self.interrupt(sim)

    def test_every_end_leaves_the_motors_at_rest(self):
        model = self.build()
        sim = self.start_sim()
        for number in (signal.SIGINT, signal.SIGTERM):
            listener = self.listen("motors")
            process = self.launch([*model, "sim"])
            listener.stdout.readline()
            process.send_signal(number)
            process.communicate(timeout=30)
            self.assertEqual(process.returncode, 0)
            self.settle()
            self.assertEqual(self.set_points(listener)[-1]["x"], 0)
        process = self.launch([*model, "sim"])
        listener = self.listen("motors")
        listener.stdout.readline()
        self.interrupt(sim)
        _, err = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 1)
        self.assertIn("the simulator has ended", err)
        self.assertIn("THE ROBOT MAY STILL MOVE", err)

    def test_a_robot_that_falls_silent_is_not_driven(self):
        model = self.build()
        self.start_sim()
        process = self.launch([*model, "sim"])
        listener = self.listen("motors")
        listener.stdout.readline()
        self.run_tool("stop", "odometry", "--priority", "high")
        _, err = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 1)
        self.assertIn("no odometry for 200 ms", err)
        self.settle()
        self.assertEqual(self.set_points(listener)[-1]["x"], 0)

    def test_no_bus(self):
        model = self.build()
        for bus, what in (("sim", "no simulator is running"), ("can99", "no such interface: can99")):
            _, err = (process := self.launch([*model, bus])).communicate(timeout=30)
            self.assertEqual(process.returncode, 1)
            self.assertIn(what, err)


if __name__ == "__main__":
    main()
