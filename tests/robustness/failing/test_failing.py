"""Each write of `convert`, `record` and ocm-generate fails once, and each allocation: never a crash, a silent loss, or an older file destroyed."""

import contextlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.environ["OCM_SOURCE_DIR"], "tests", "tool", "verbs"))
from harness import AMIROCTL, Case, main  # noqa: E402

FAILING = os.environ["FAILING"]
EXPLORE = int(os.environ.get("OCM_EXPLORE", "1"))
NEVER = 10**9
ENDINGS = ("log", "csv", "asc", "pcap", "pcapng", "mcap", "jsonl", "log.gz", "csv.zst")
OLDER = b"an older file\n"


class Base(Case):
    def setUp(self):
        super().setUp()
        self.log = self.path("in.log")
        with open(self.log, "w") as log:
            for i in range(60):
                log.write(f"(1700000000.{i * 1000:06d}) can0 {0x600 + i % 16:03X}#1122334455667788\n")

    def path(self, name):
        return os.path.join(self.folder, name)

    def clean(self):
        for name in os.listdir(self.folder):
            if name.startswith("out"):
                os.unlink(self.path(name))

    program = AMIROCTL

    def failing(self, plan, *arguments):
        """Runs the program by the plan; the result, and how many calls of the plan's kind it made."""
        calls = self.path("calls")
        environment = self.environment | {"OCM_FAIL": plan, "OCM_FAIL_CALLS": calls, "LD_PRELOAD": FAILING}
        result = subprocess.run([self.program, *arguments], env=environment, cwd=self.folder, capture_output=True,
                                stdin=subprocess.DEVNULL, timeout=30)
        if result.returncode < 0:
            self.fail(f"{arguments}, {plan}: signal {-result.returncode}: {result.stderr.decode()}")
        with open(calls) as file:
            return result, int(file.read())

    def judge(self, what, result):
        """An error is said in one line that begins with the program's name, and only an error is."""
        words = result.stderr.decode()
        if result.returncode == 0:
            return
        self.assertEqual(result.returncode, 1, f"{what}: {words}")
        self.assertRegex(words, rf"(?m)^{os.path.basename(self.program)}: \w.{{8}}", what)
        self.assertNotIn("std::", words, what)
        self.assertNotIn("terminate", words, what)

    def frames(self, name, whole=True):
        """How many frames can be read back; a file that is not whole may end with an error."""
        result = subprocess.run([AMIROCTL, "convert", self.path(name), "-", "--to", "candump"], env=self.environment,
                                capture_output=True, text=True, timeout=30)
        if whole:
            self.assertEqual(result.returncode, 0, result.stderr)
        return len(result.stdout.splitlines())

    def walk_files(self, run, whole, broken=lambda *_: None, prepare=lambda: None):
        """Fails call after call until the program makes fewer."""
        for error in ("ENOSPC", "EIO"):
            number, calls = 0, 0
            while number <= calls or number == 0:
                number += 1
                self.clean()
                prepare()
                result, calls = self.failing(f"file:{error}:{number}", *run)
                what = f"{run}, file call {number} of {calls}: {error}"
                self.judge(what, result)
                if result.returncode == 0:
                    whole(what, result)
                else:
                    self.assertLessEqual(number, calls, what)
                    broken(what, result)
            self.assertGreater(number, 3, run)

    def memory_numbers(self, run):
        """All that come with the log, some of the many before it: building the verbs takes most of them."""
        _, least = self.failing(f"memory:ENOMEM:{NEVER}", "convert", "--help")
        self.clean()
        _, all_of_them = self.failing(f"memory:ENOMEM:{NEVER}", *run)
        chosen = random.Random(run[-1])
        early = {chosen.randrange(1, least) for _ in range(3 * EXPLORE)}
        late = range(max(1, min(least, all_of_them) - 20), all_of_them + 1)
        return sorted(early | set(chosen.sample(late, min(len(late), 20 * EXPLORE))))

    def walk_memory(self, run, whole):
        for number in self.memory_numbers(run):
            for more in ("", "+"):
                self.clean()
                result, calls = self.failing(f"memory:ENOMEM:{number}{more}", *run)
                what = f"{run}, allocation {number}{more} of {calls}"
                self.judge(what, result)
                if result.returncode == 0:
                    whole(what, result)


class Failing(Base):
    # --- convert ---

    def expect_all(self, name):
        def whole(what, _):
            self.assertEqual(self.frames(name), 60, what)
        return whole

    def expect_no_empty(self, name):
        def broken(what, _):
            self.assertFalse(os.path.exists(self.path(name)) and os.path.getsize(self.path(name)) == 0, what)
        return broken

    def test_convert_says_each_failing_write(self):
        for ending in ENDINGS:
            with self.subTest(ending):
                self.walk_files(("convert", "in.log", f"out.{ending}"), self.expect_all(f"out.{ending}"), self.expect_no_empty(f"out.{ending}"))

    def test_convert_says_each_failing_allocation(self):
        for ending in ENDINGS:
            with self.subTest(ending):
                self.walk_memory(("convert", "in.log", f"out.{ending}"), self.expect_all(f"out.{ending}"))

    def test_convert_leaves_an_older_file(self):
        def prepare():
            with open(self.path("out.log"), "wb") as file:
                file.write(OLDER)

        def still_there(*_):
            with open(self.path("out.log"), "rb") as file:
                self.assertEqual(file.read(), OLDER)

        for plan in ("file:EIO:1", "file:ENOSPC:2", f"memory:ENOMEM:{NEVER}"):
            prepare()
            result, _ = self.failing(plan, "convert", "in.log", "out.log")
            self.assertEqual(result.returncode, 1, plan)
            still_there()
        # Where it may be overwritten, it goes once there is room for what takes its place.
        run = ("convert", "in.log", "out.log", "--force")
        for plan in ("file:ENOSPC:2", "file:ENOSPC:3"):  # opens it, asks for room
            prepare()
            result, _ = self.failing(plan, *run)
            self.assertEqual(result.returncode, 1, plan)
            self.judge(f"{run}, {plan}", result)
            still_there()
        # Memory fails before it is emptied, or once there is something to write.
        for number in self.memory_numbers(run):
            prepare()
            result, _ = self.failing(f"memory:ENOMEM:{number}", *run)
            self.judge(f"{run}, allocation {number}", result)

    def test_a_spec_says_each_failing_allocation(self):
        """Its JSON takes memory while it is destroyed, too: where there is none, that is no crash."""
        shutil.copy(os.path.join(os.environ["OCM_SOURCE_DIR"], "spec", "topics.json"), self.path("in.json"))
        self.walk_memory(("--spec", "in.json", "list"), lambda *_: None)
        _, calls = self.failing(f"memory:ENOMEM:{NEVER}", "--spec", "in.json", "list")
        for number in random.Random(1).sample(range(1, calls), 60 * EXPLORE):  # reading the spec takes most of them
            result, _ = self.failing(f"memory:ENOMEM:{number}+", "--spec", "in.json", "list")
            self.judge(f"allocation {number}+ of {calls}", result)

    # --- what prints ---

    def sample_of(self, run, most=30):
        """Some of all its allocations, the last ones among them."""
        _, calls = self.failing(f"memory:ENOMEM:{NEVER}", *run)
        chosen = random.Random(" ".join(run))
        return sorted({*chosen.sample(range(1, calls), min(calls - 1, most * EXPLORE)), *range(max(1, calls - 5), calls + 1)})

    def test_what_prints_json_says_each_failing_allocation(self):
        """It is whole, or exit code 1 and words on stderr."""
        for run in (("list", "--json"), ("stats", "in.log", "--json"), ("analyse", "bus", "--json"),
                    ("analyse", "tasks", "di_wheel_drive", "--json")):
            whole, _ = self.failing(f"memory:ENOMEM:{NEVER}", *run)
            with self.subTest(run):
                self.assertEqual(whole.returncode, 0, whole.stderr.decode())
                for document in whole.stdout.splitlines() if run[0] == "list" else [whole.stdout]:
                    json.loads(document)
                for number in self.sample_of(run):
                    for more in ("", "+"):
                        result, calls = self.failing(f"memory:ENOMEM:{number}{more}", *run)
                        what = f"{run}, allocation {number}{more} of {calls}"
                        self.judge(what, result)
                        if result.returncode == 0:
                            self.assertEqual(result.stdout, whole.stdout, what)

    def test_a_simulator_says_each_failing_allocation(self):
        """Of a fleet in a world of its own: it ends with words, or serves until a signal ends it."""
        shutil.copy(os.path.join(os.environ["OCM_SOURCE_DIR"], "sim", "worlds", "square.json"), self.path("here.json"))
        run = ("sim", "--robots", "2", "--world", "here.json")
        calls = self.simulate(f"memory:ENOMEM:{NEVER}", run)[1]
        chosen = random.Random(7)
        for number in sorted(chosen.sample(range(1, calls), 25 * EXPLORE)):
            for more in ("", "+"):
                (code, words), _ = self.simulate(f"memory:ENOMEM:{number}{more}", run)
                what = f"{run}, allocation {number}{more} of {calls}: {words}"
                self.assertIn(code, (1, 128 + signal.SIGTERM), what)
                self.assertNotIn("terminate", words, what)
                if code == 1:
                    self.assertRegex(words, r"(?m)^amiroctl: \w.{8}", what)

    def simulate(self, plan, run):
        """Until it serves, and then until SIGTERM; its exit code and words, and how many calls it made."""
        calls = self.path("calls")
        environment = self.environment | {"OCM_FAIL": plan, "OCM_FAIL_CALLS": calls, "LD_PRELOAD": FAILING}
        with subprocess.Popen([AMIROCTL, *run], env=environment, cwd=self.folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as sim:
            try:
                said = sim.stdout.readline()  # what it serves, or why not
                if b"Ctrl-C ends it" in said:
                    time.sleep(0.1)
                else:  # it ends by itself; a signal would end it before it has said how many calls it made
                    with contextlib.suppress(subprocess.TimeoutExpired):
                        sim.wait(timeout=10)
                sim.terminate()
                rest, _ = sim.communicate(timeout=30)
            finally:
                sim.kill()
        with open(calls) as file:
            return (sim.returncode, (said + rest).decode()), int(file.read())

    # --- record ---

    def start_traffic(self):
        """A frame each millisecond."""
        self.start_sim()
        self.run_tool("publish", "gyro", "1ms", "--no-confirm")

    def all_frames(self, whole=True):
        names = [name for name in os.listdir(self.folder) if name.startswith("out")]
        return sum(self.frames(name, whole) for name in names if os.path.getsize(self.path(name)) > 0)

    def expect_what_it_said(self, what, result):
        """What it says to be readable is."""
        told = re.search(r"(\d+) frames can be read", result.stderr.decode())
        if told is not None:
            self.assertEqual(self.all_frames(whole=False), int(told[1]), what)

    def expect_recorded(self, count):
        def whole(what, _):
            self.assertEqual(self.all_frames(), count, what)
        return whole

    def test_record_says_each_failing_write(self):
        self.start_traffic()
        for ending in ENDINGS:
            with self.subTest(ending):
                self.walk_files(("record", "-n", "10", "-o", f"out.{ending}"), self.expect_recorded(10),
                                self.expect_what_it_said)

    def test_record_in_several_files_says_each_failing_write(self):
        self.start_traffic()
        self.walk_files(("record", "-n", "60", "-o", "out.log", "--split", "20ms"), self.expect_recorded(60),
                        self.expect_what_it_said)

    def test_record_says_that_the_disk_did_not_take_it(self):
        """fdatasync alone fails, at the end and between the files of a split: what was written is not safe, and that is an error."""
        self.start_traffic()
        for run, least in ((("record", "-n", "10", "-o", "out.log"), 1),
                           (("record", "-n", "60", "-o", "out.log", "--split", "20ms"), 3)):
            for error, words in (("ENOSPC", "No space left on device"), ("EIO", "Input/output error")):
                with self.subTest(run=run, error=error):
                    self.clean()
                    result, calls = self.failing(f"sync:{error}:{NEVER}", *run)
                    self.assertEqual(result.returncode, 0, result.stderr.decode())
                    self.assertGreaterEqual(calls, least, "the disk is waited for")
                    for number in range(1, least + 1):
                        self.clean()
                        result, _ = self.failing(f"sync:{error}:{number}", *run)
                        what = f"{run}, wait {number} of {calls}: {error}: {result.stderr.decode()}"
                        self.assertEqual(result.returncode, 1, what)
                        self.assertRegex(result.stderr.decode(), rf"(?m)^amiroctl: .*out\S*\.log.*{words}", what)
                        self.expect_what_it_said(what, result)

    def test_a_ring_keeps_what_it_has_until_there_is_something_new(self):
        self.start_traffic()

        def prepare():
            for number in (1, 2):
                with open(self.path(f"out_00{number}.log"), "wb") as file:
                    file.write(OLDER)

        def enough(what, _):
            names = sorted(name for name in os.listdir(self.folder) if name.startswith("out"))
            self.assertGreaterEqual(len(names), 2, what)

        self.walk_files(("record", "-n", "60", "-o", "out.log", "--split", "20ms", "--ring", "2"), enough, enough, prepare)

    def test_record_says_each_failing_allocation(self):
        self.start_traffic()
        for ending in ("log", "mcap", "csv.zst"):
            with self.subTest(ending):
                self.walk_memory(("record", "-n", "10", "-o", f"out.{ending}"), self.expect_recorded(10))


class Generate(Base):
    """The same of ocm-generate, whose file is replaced in one step: the older one stays, and no other one is left."""

    program = os.environ["OCM_GENERATE"]
    run_of = ("in.json", "-o", "out.hpp")

    def setUp(self):
        super().setUp()
        shutil.copy(os.path.join(os.environ["OCM_SOURCE_DIR"], "spec", "topics.json"), self.path("in.json"))

    def older(self):
        self.clean()
        with open(self.path("out.hpp"), "wb") as file:
            file.write(OLDER)

    def judge_file(self, what, result, whole):
        with open(self.path("out.hpp"), "rb") as file:
            self.assertEqual(file.read(), whole if result.returncode == 0 else OLDER, what)
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("out")], ["out.hpp"], what)

    def whole(self):
        """What it writes, and how many allocations that takes."""
        self.older()
        _, calls = self.failing(f"memory:ENOMEM:{NEVER}", *self.run_of)
        with open(self.path("out.hpp"), "rb") as file:
            return file.read(), calls

    def test_it_says_each_failing_allocation(self):
        whole, calls = self.whole()
        self.assertGreater(len(whole), 1000)
        chosen = random.Random(1)
        numbers = {*range(1, 21), *range(calls - 20, calls + 1), *chosen.sample(range(1, calls), 40 * EXPLORE)}
        for number in sorted(numbers):
            for more in ("", "+"):
                self.older()
                result, _ = self.failing(f"memory:ENOMEM:{number}{more}", *self.run_of)
                what = f"allocation {number}{more} of {calls}"
                if result.returncode != 0:
                    self.assertEqual(result.returncode, 1, what)
                    self.assertEqual(result.stderr.decode(),
                                     "ocm-generate: out of memory; what it was doing is not complete\n"
                                     "              end other programs, or raise the limit (ulimit -v), and try again\n", what)
                self.judge_file(what, result, whole)


if __name__ == "__main__":
    main()
