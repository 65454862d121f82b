"""The boards' images in QEMU, on the virtual bus, beside the same boards compiled for the host: both robots get the
same requests, and must say the same.

What the emulated lines cannot carry is left out: above about 1000 frames a second of one board (the magnetometer every
900 us makes 3333) a serial line in QEMU falls behind, and the board's frames wait or are counted as overruns.
"""
# Sleeps: emulated boards run in real time, and drive, publish or are silent for so long.

import collections
import itertools
import json
import os
import pathlib
import re
import signal
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests" / "tool" / "verbs"))
sys.path.insert(0, str(ROOT / "tests"))
import screens  # noqa: E402
import waiting  # noqa: E402
from harness import Case, main  # noqa: E402
from realtime import RealTime  # noqa: E402

IMAGES = os.environ["OCM_IMAGES"]
BOARDS = {"di_wheel_drive": ["odometry", "floor_proximity", "magnetometer", "gyroscope", "accelerometer"],
          "power_management": ["power_status", "proximity_ring"], "light_ring": []}
SENSORS = [topic for topics in BOARDS.values() for topic in topics]
SLOW_SENSORS = ["batteries", "ring_light"]
PRIORITIES = ["urgent", "high", "medium", "low"]


class Robots(Case):
    """Two robots, each on its own bus: "host" and "qemu"."""
    had_time = RealTime.had_time


    def start_robots(self, *arguments):
        self.sims = {}
        self.addCleanup(self.end_robots)
        for name, more in (("host", ()), ("qemu", ("--boards", "qemu", "--images", IMAGES))):
            self.sims[name] = self.start_sim("--bus", self.bus(name), *more, *arguments)
        # An emulated board needs a moment until it knows its parts.
        self.until(lambda: self.asked("qemu", "odometry") is not None)

    def end_robots(self):
        for sim in self.sims.values():  # in order, so that it sees the end of its emulators
            if sim.poll() is None:
                sim.terminate()
                sim.communicate(timeout=60)

    def bus(self, name):
        return f"sim:{self.folder}/{name}.sock"

    def until(self, condition, seconds=90):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, "it did not come about in time")
            time.sleep(0.1)

    def tool(self, name, *arguments, code=0):
        return self.run_tool("--bus", self.bus(name), *arguments, code=code)[0]

    def asked(self, name, topic, priority="medium"):
        """The frames that one request brings, as (identifier, data); None when there is no answer."""
        listener = self.start("--bus", self.bus(name), "listen", "--json", "--timeout", "6s", topic)
        self.assertIn("bus: sim", listener.stderr.readline())
        waiting.until_asleep(listener.pid)  # it is subscribed
        self.tool(name, "once", topic, "--priority", priority, "--no-confirm")
        frames, count = [], self.frames_of(topic)
        for line in listener.stdout:
            event = json.loads(line)
            frames.append((event["id"], event["data"]))
            if len(frames) == count:
                break
        listener.send_signal(signal.SIGINT)
        listener.communicate(timeout=60)
        return frames if len(frames) == count else None

    def record(self, name, *arguments):
        """Listens into a file: what is not read must not hold the listener up. `recorded` ends it."""
        path = f"{self.folder}/{name}.json"
        with open(path, "wb") as file:
            listener = waiting.Program([os.environ["AMIROCTL"], "--bus", self.bus(name), "listen", "--json", *arguments],
                                       env=self.environment, stdin=subprocess.DEVNULL, stdout=file,
                                       stderr=subprocess.PIPE, text=True)
        self._started.append(listener)
        self.assertIn("bus: sim", listener.stderr.readline())
        waiting.until_asleep(listener.pid, looks=10)  # it is subscribed
        return listener, path

    def so_far(self, path):
        """What has been recorded in a file that is still written; its last line may be a part."""
        with open(path, encoding="utf-8") as file:
            return self.objects(file.read().rpartition("\n")[0])

    @staticmethod
    def count(path, frame):
        """How often a frame of that name has been recorded in a file that is still written."""
        with open(path, encoding="utf-8") as file:
            return file.read().count(f'"frame":"{frame}"')

    def recorded(self, recording):
        listener, path = recording
        _, err = self.interrupt(listener)
        self.assertNotIn("lost", err)
        with open(path, encoding="utf-8") as file:
            return self.objects(file.read())

    @staticmethod
    def frames_of(topic):
        return {"odometry": 2, "magnetometer": 3, "proximity_ring": 8, "batteries": 2, "ring_light": 8}.get(topic, 1)

    def summaries(self):
        """Ends both robots; what each said."""
        texts = {}
        for name, sim in self.sims.items():
            _, texts[name] = self.interrupt(sim)
            self.assertEqual(sim.returncode, 128 + signal.SIGINT, texts[name])
        return texts


class Frozen(Robots):
    """With the world's time standing still every value is the same."""

    def setUp(self):
        super().setUp()
        self.start_robots("--frozen", "--seed", "3")

    def test_every_sensor_at_every_priority(self):
        # The emulated ring has measured light, too.
        self.until(lambda: self.asked("qemu", "ring_light") is not None)
        for topic in SENSORS + SLOW_SENSORS:
            for priority in PRIORITIES:
                with self.subTest(topic=topic, priority=priority):
                    expected = self.asked("host", topic, priority)
                    self.assertIsNotNone(expected)
                    self.assertEqual(self.asked("qemu", topic, priority), expected)
        texts = self.summaries()
        self.assertNotIn("against a data sheet", texts["qemu"])
        self.assertIn("garbage 0", texts["qemu"])

    def test_what_is_refused_and_how_it_is_told(self):
        refused = ["208#03", "208#FF", "208#", "208#0000", "208#01F401", "208#01F40103", "208#01000000", "201#00",
                   "21F#03", "23C#FF"]
        heard = {}
        for name in self.sims:
            recording = self.record(name)
            for number, frame in enumerate(refused, 1):
                self.tool(name, "send", frame)
                # One refusal, one frame; it may say one word of two that it hears at once.
                self.until(lambda: sum(int(e["id"], 16) & 0x400 != 0 for e in self.so_far(recording[1])) >= number)
            self.tool(name, "once", "gyro")  # and all else goes on
            time.sleep(0.3)
            # Topic, reason and how many were refused; not how often an emulated part had nothing to say, which depends on
            # how fast this machine emulates it.
            heard[name] = [(e["id"], e["data"][:8] if e["id"] == "71D" else e["data"])
                           for e in self.recorded(recording) if int(e["id"], 16) & 0x400]
        self.assertEqual(len(heard["host"]), len(refused) + 1)
        self.assertEqual(heard["qemu"], heard["host"])

    def test_the_vectors_of_the_protocol(self):
        """The requests that the thesis's protocol is known by; and one that is beyond an emulated line."""
        heard = {}
        for name in self.sims:
            recording = self.record(name)
            # By one program: how long another takes to start is how long a stream runs.
            frames = ("205#01", "205#00", "204#02", "208#01F40100", "108#01C80000", "208#00", "205#01840302")
            self.run_tool("--bus", self.bus(name), "send", "--stdin", "--timed",
                          stdin="".join(f"({0.12 * turn:.6f}) can0 {frame}\n" for turn, frame in enumerate(frames)))
            time.sleep(0.12)
            self.tool(name, "send", "205#00")
            time.sleep(1)
            ends = time.time_ns()
            time.sleep(0.3)
            events = self.recorded(recording)
            self.assertLess(max(int(e["time_ns"]) for e in events), ends)  # the stop was heeded
            heard[name] = [(e["id"], e["data"]) for e in events]
        # All but the last, every 900 us, which the host's board keeps and the emulated one does not.
        first = {name: list(dict.fromkeys(frames)) for name, frames in heard.items()}
        self.assertEqual(sorted(first["qemu"]), sorted(first["host"]))
        for identifier in ("604", "508"):
            self.assertEqual([f for f in heard["qemu"] if f[0] == identifier],
                             [f for f in heard["host"] if f[0] == identifier])
        self.assertGreater(len(heard["host"]), 300)
        report = json.loads(self.tool("qemu", "doctor", "--json", "--listen", "100ms", code=1))
        self.assertIn("came late or not at all", report["findings"][0]["what"])  # told, not hidden

    def test_calibration_of_the_floor_is_forgotten_and_measured(self):
        before = self.asked("qemu", "floor_proximity")
        for name in self.sims:
            self.tool(name, "set", "floor_calibration", "action=forget")
        raw = self.asked("host", "floor_proximity")
        self.assertNotEqual(raw, before)
        self.until(lambda: self.asked("qemu", "floor_proximity") == raw)
        self.tool("qemu", "set", "floor_calibration", "action=measure")
        self.until(lambda: self.asked("qemu", "floor_proximity") == [("604", "0000000000000000")])


class Moving(Robots):
    def pose(self, name):
        data = bytes.fromhex(self.asked(name, "odometry")[1][1])
        return [int.from_bytes(data[:3], "little", signed=True) * 256e-6, int.from_bytes(data[3:6], "little", signed=True) * 256e-6,
                int.from_bytes(data[6:], "little") * 256e-6]

    def test_behaviours(self):
        """The line is followed, a way is travelled, and obstacles are avoided: by the images as by the boards of this machine."""
        self.start_robots("--seed", "1")
        for name in self.sims:
            self.tool(name, "behave", "follow", "--for", "1s")
            self.until(lambda: self.asked(name, "odometry")[0][1] == "0000000000000000")
            followed = self.pose(name)
            self.assertGreater(followed[0], 0.03, name)
            self.assertAlmostEqual(followed[1], 0, delta=0.01)
            self.assertIn("arrived", self.tool(name, "travel", "10cm", "--turn", "90deg"))
            travelled = self.pose(name)
            self.assertAlmostEqual(travelled[0] - followed[0], 0.1, delta=0.005)
            self.assertAlmostEqual((travelled[2] - followed[2]) % 6.2832, 1.571, delta=0.05)
            self.tool(name, "behave", "avoid", "--for", "1500ms")
            self.until(lambda: self.asked(name, "odometry")[0][1] == "0000000000000000")
            self.assertGreater(self.pose(name)[1] - travelled[1], 0.05, name)

    def test_home(self):
        """From three places the images come to stand before a wall, as the boards of this machine do."""
        self.start_robots("--seed", "1")
        for way in ((), ("-60cm", "--turn", "100deg"), ("-30cm", "--turn", "-110deg")):
            for name in self.sims:
                if way:
                    self.tool(name, "travel", *way, "--speed", "20cm/s")
            homing = {name: self.start("--bus", self.bus(name), "behave", "home", "--distance", "6cm", "--speed", "20cm/s",
                                       "--for", "20s") for name in self.sims}
            for name, each in homing.items():
                _, err = each.communicate(timeout=60)
                self.assertEqual(each.returncode, 0, err)
                self.until(lambda: self.asked(name, "odometry")[0][1] == "0000000000000000")
                self.assertAlmostEqual(self.nearest(name), 0.06, delta=0.02)

    def nearest(self, name):
        """What the ring's sensors say of the nearest thing, m."""
        listener = self.start("--bus", self.bus(name), "listen", "ring", "--json", "--count", "8", "--timeout", "30s")
        self.assertIn("bus: sim", listener.stderr.readline())
        waiting.until_asleep(listener.pid)  # it is subscribed
        self.tool(name, "once", "ring")
        out, err = listener.communicate(timeout=60)
        self.assertEqual(listener.returncode, 0, err)
        return min(event["fields"]["distance"] for event in self.objects(out) if event["fields"].get("distance") is not None)

    def test_the_standalone_script(self):
        """The thesis's run of 40 s, on both robots at once: same frames, in the same order, as often."""
        self.start_robots("--seed", "1")
        recordings = {name: self.record(name, "--commands") for name in self.sims}
        runs = {}
        for name in self.sims:
            runs[name] = self.start("--bus", self.bus(name), "run", str(ROOT / "examples" / "standalone.script"))
        for name, run in runs.items():
            run.communicate(timeout=120)
            self.assertEqual(run.returncode, 0)
        time.sleep(0.5)
        output = {name: self.recorded(recording) for name, recording in recordings.items()}

        samples = {name: self.samples(events) for name, events in output.items()}
        # Three stops of the script fall on the very grid point of a release: which is first is not specified.
        on_the_edge = {"accelerometer", "proximity_ring", "odometry"}
        for topic in SENSORS:
            host, qemu = samples["host"][topic], samples["qemu"][topic]
            self.assertGreater(len(host), 0, topic)
            self.assertLessEqual(abs(len(host) - len(qemu)), 1 if topic in on_the_edge else 0, topic)
            # The frames of a sample: same identifiers and lengths, in the same order.
            self.assertEqual(set(map(self.shape, host)), set(map(self.shape, qemu)), topic)
        # A set point of the motors is repeated as long as it holds: how often is a matter of microseconds.
        commands = {name: [key for key, _ in itertools.groupby((e["id"], e["data"]) for e in events
                                                               if int(e["id"], 16) < 0x400)]
                    for name, events in output.items()}
        self.assertEqual(commands["qemu"], commands["host"])
        # The order of first samples is that of the requests.
        first = {name: list(dict.fromkeys(e["topic"] for e in events if e["topic"] in SENSORS
                                          and int(e["id"], 16) >= 0x400)) for name, events in output.items()}
        self.assertEqual(first["qemu"], first["host"])
        # Nothing drifts: the thesis's own publisher had 640 ms for 500 ms.
        for topic, period in (("accelerometer", 0.5), ("magnetometer", 0.8), ("gyroscope", 5)):
            times = [sample[-1][2] for sample in samples["qemu"][topic]]
            mean = (times[-1] - times[0]) / (len(times) - 1)
            self.assertAlmostEqual(mean, period, delta=0.01 + self.spare.slack / (len(times) - 1), msg=topic)  # of the first or the last one
        texts = self.summaries()
        self.assertNotIn("against a data sheet", texts["qemu"])

    @staticmethod
    def shape(sample):
        return tuple((identifier, len(data)) for identifier, data, _ in sample)

    def samples(self, events):
        """Topic -> samples, each a list of (identifier, data, time in s)."""
        result, current = collections.defaultdict(list), collections.defaultdict(list)
        for event in events:
            if int(event["id"], 16) < 0x400 or event["topic"] not in SENSORS:
                continue
            topic = event["topic"]
            current[topic].append((event["id"], event["data"], int(event["time_ns"]) / 1e9))
            if len(current[topic]) == self.frames_of(topic):
                result[topic].append(current.pop(topic))
        self.assertFalse({t: f for t, f in current.items() if f}, "half a sample")
        return result

    def test_the_firmware_drives_and_its_watchdog_stops_it(self):
        self.start_robots("--seed", "1")
        recording = self.record("qemu", "odometry")
        self.tool("qemu", "publish", "odometry", "100ms")
        self.tool("qemu", "set", "motors", "x=0.2m/s")  # once: it is not repeated

        def rests():
            seen = [e["fields"]["x"] for e in self.so_far(recording[1]) if e["frame"] == "velocity"]
            return len(seen) > 4 and max(seen) > 0.15 and not any(seen[-4:])
        self.until(rests)
        events = self.recorded(recording)
        speeds = [e["fields"]["x"] for e in events if e["frame"] == "velocity"]
        path = [e["fields"]["x"] for e in events if e["frame"] == "pose"]
        self.assertGreater(max(speeds), 0.15)
        self.assertLess(max(speeds), 0.3)
        self.assertEqual(speeds[-1], 0)
        self.assertEqual(path[-1], path[-3])
        self.assertGreater(path[-1], 0.05)  # 0.5 s at 0.2 m/s, and the way up and down
        self.assertLess(path[-1], 0.15)

    def test_a_board_that_ends_is_told(self):
        self.start_robots()
        boards = subprocess.run(["pgrep", "-P", str(self.sims["qemu"].pid), "qemu"], capture_output=True, text=True,
                                check=True).stdout.split()
        self.assertEqual(len(boards), 3)
        os.kill(int(boards[2]), signal.SIGKILL)
        _, err = self.sims["qemu"].communicate(timeout=60)
        self.assertEqual(self.sims["qemu"].returncode, 1)
        self.assertIn("light_ring: QEMU was ended by signal Killed", err)
        self.assertEqual(subprocess.run(["pgrep", "-P", str(self.sims["qemu"].pid)], check=False).returncode, 1)

    def test_all_at_50_ms_without_a_loss(self):
        """17 sensor frames every 50 ms, the thesis's own full load."""
        self.start_robots("--seed", "1")
        recording = self.record("qemu")
        for topic in SENSORS:
            self.tool("qemu", "publish", topic, "50ms")
        expected = 100 * sum(map(self.frames_of, SENSORS))
        with open(f"{self.folder}/qemu.json", "rb") as file:  # ends by what came: an emulator may fall behind for a while
            seen = 0

            def enough():
                nonlocal seen
                seen += file.read().count(b"\n")
                return seen >= expected

            self.until(enough, seconds=60)
        for topic in SENSORS:
            self.tool("qemu", "stop", topic)
        for board in BOARDS:
            self.tool("qemu", "once", f"{board}_status")
        self.until(lambda: self.count(f"{self.folder}/qemu.json", "health") == len(BOARDS))
        events = self.recorded(recording)
        # No line and no queue lost a frame: each is on the bus with all of its sample.
        text = self.summaries()["qemu"]
        self.assertEqual(text.count("lost on its line 0, garbage 0"), len(BOARDS), text)
        self.assertIn("0 frames lost by slow ones", text)
        counts = collections.Counter(e["topic"] for e in events if int(e["id"], 16) >= 0x400)
        for topic in SENSORS:
            self.assertEqual(counts[topic] % self.frames_of(topic), 0, topic)
        overload = {e["topic"].removesuffix("_status"): e["fields"]["overload"] for e in events if e["frame"] == "health"}
        times = {topic: [int(e["time_ns"]) for e in events if e["topic"] == topic and int(e["id"], 16) >= 0x400]
                 for topic in SENSORS}
        for board, topics in BOARDS.items():
            if not topics:
                continue
            # While all of them were published: the tool asks for one after the other, and may be slow at it.
            begin, end = max(times[topic][0] for topic in topics), min(times[topic][-1] for topic in topics)
            samples = {topic: sum(begin <= time <= end for time in times[topic]) / self.frames_of(topic)
                       for topic in topics}
            with self.subTest(board=board, samples=samples, overload=overload[board]):
                # The topics of one board have one period and one clock, so what one has less than the others was not
                # released, and the board has counted it: an emulator that falls behind comes late, but not in silence.
                # Each may have one sample more or less at the beginning and at the end.
                self.assertGreater(min(samples.values()), 10)
                missing = sum(max(samples.values()) - count for count in samples.values())
                self.assertLessEqual(missing, overload[board] + 2 * len(topics))
        if self.spare.look().enough():  # else the emulators fell behind, as the boards said above
            for topic in SENSORS:
                first = next(e["id"] for e in events if e["topic"] == topic)
                arrived = [int(e["time_ns"]) for e in events if e["id"] == first]
                period = statistics.median(later - earlier for earlier, later in itertools.pairwise(arrived))
                self.assertAlmostEqual(period / 1e6, 50, delta=2, msg=topic)


class Usage(Case):
    def test_no_image(self):
        _, err = self.run_tool("sim", "--boards", "qemu", "--images", self.folder, code=1)
        self.assertIn("di_wheel_drive_qemu_m3.elf: No such file or directory", err)
        self.assertIn("scripts/build firmware", err)

    def test_no_qemu(self):
        self.environment["PATH"] = self.folder
        _, err = self.run_tool("sim", "--boards", "qemu", "--images", IMAGES, code=1)
        self.assertIn("cannot start qemu-system-arm", err)
        self.assertIn("apt-get install qemu-system-arm", err)

    def test_what_does_not_go_together(self):
        self.run_tool("sim", "--boards", "qemu", "--speed", "2", code=2)
        self.run_tool("sim", "--images", ".", code=2)
        self.run_tool("sim", "--boards", "paper", code=2)


class Shown(screens.Screens):
    def test_emulated_boards_on_a_terminal(self):
        """The world is the simulator's, the wheels are those that the emulated board commands."""
        bus = f"sim:{self.folder}/show.sock"
        self.open(80, "--bus", bus, "sim", "--boards", "qemu", "--images", IMAGES, "--show=text", rows=24)
        place = re.search(r"x +(-?\d+\.\d+) m", "\n".join(self.shows(80, "AMiRo", "heading", "  0.000 m/s")))[1]
        drive = self.start("--bus", bus, "drive", "10cm/s")
        waiting.until(lambda: re.search(r"right +0\.(09|1[01])\d m/s", "\n".join(self.screen(80))), "its wheels")
        waiting.until(lambda: not re.search(rf"x +{re.escape(place)} m", "\n".join(self.screen(80))), "another place")
        self.interrupt(drive)
        self.shows(80, "  0.000 m/s")
        self.press(80, "q")
        ended = self.ended(80)
        self.assertEqual(ended[-1], "END 0")
        self.assertNotIn("heading", "\n".join(ended))  # the picture has gone


if __name__ == "__main__":
    main()
