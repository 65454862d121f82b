"""amiroctl record on a virtual bus: what is sent is in the file, whatever ends the recording."""

import contextlib
import fcntl
import os
import re
import resource
import signal
import socket
import struct
import subprocess
import sys
import termios
import threading
import time

from harness import AMIROCTL, SOURCE, Case, main, waiting
from played_adapter import WithAdapter

sys.path.insert(0, os.path.join(SOURCE, "tests", "peers", "logs"))
from virtual_bus import FRAME, GOODBYE, HELLO, MAGIC, OVERRUN, VERSION, Client  # noqa: E402

LINE = re.compile(r"^\((\d+\.\d+)\) (\S+) (\S+)#(\S*)(?: ([RT]))?$")


def open_files(pid):
    names = set()
    for entry in os.scandir(f"/proc/{pid}/fd"):
        with contextlib.suppress(FileNotFoundError):  # closed meanwhile
            names.add(os.readlink(entry.path))
    return names


class Recording(Case):
    def record(self, *arguments, **options):
        """Starts `record` in the test's folder and returns when it records."""
        process = self.start("record", *arguments, cwd=self.folder, **options)
        for line in process.stderr:
            if "Ctrl-C ends" in line:
                return process
        self.fail(f"record ended with {process.wait()}")

    def path(self, name):
        return os.path.join(self.folder, name)

    def frames(self, name):
        """Identifier and data of each line of a candump log."""
        with open(self.path(name)) as file:
            whole = file.read().rpartition("\n")[0].splitlines()  # while it is recorded the last line may be a part
        lines = [LINE.match(line) for line in whole]
        self.assertNotIn(None, lines)
        return [(line[3], line[4]) for line in lines]

    def wait_for_frames(self, name, count):
        waiting.until(lambda: os.path.exists(self.path(name)) and len(self.frames(name)) >= count,
                      f"{count} frames in {name}")

    def send_numbered(self, count, first=0):
        client = Client(self.folder)
        for i in range(first, first + count):
            client.send(0x123, i.to_bytes(4, "big"))
        client.close()
        return [("123", f"{i:08X}") for i in range(first, first + count)]

    def test_what_is_sent_is_recorded_in_order(self):
        self.start_sim()
        recorder = self.record("-o", "a.log")
        sent = self.send_numbered(3000)
        client = Client(self.folder)
        client.send(0x18FF1234, b"\x01", form=1)
        client.send(0x321, b"", form=2)
        client.close()
        sent += [("18FF1234", "01"), ("321", "R")]
        self.wait_for_frames("a.log", len(sent))
        _, err = self.interrupt(recorder)
        self.assertEqual(recorder.returncode, 130, err)
        self.assertEqual(self.frames("a.log"), sent)
        self.assertRegex(err, r"recorded 3002 frames in [0-9.]+m?s to a\.log, ")
        self.assertNotIn("lost in the receive queue", err)

    def test_can_fd_is_recorded_in_every_format_and_replayed(self):
        self.start_sim()
        sent = ["123##1DEAD", "1F334455##0" + "5A" * 64, "123#DEAD", "7FF##3", "123##2" + "00" * 12]
        formats = ("log", "pcapng", "pcap", "mcap", "asc", "jsonl", "csv")
        recorders = [self.record("-o", f"a.{ending}", "-n", str(len(sent))) for ending in formats]
        self.run_tool("send", "--stdin", stdin="\n".join(sent) + "\n")
        said = {ending: recorder.communicate(timeout=60)[1] for ending, recorder in zip(formats, recorders)}

        def kept(name):
            out, _ = self.run_tool("convert", name, "-", "--to", "candump")
            return [line.split()[2] for line in out.splitlines()]

        for ending in formats[:-1]:
            self.assertEqual(kept(self.path(f"a.{ending}")), sent, ending)
        # CSV as python-can has it knows the data alone: flags and a CAN FD frame of a classic length are lost, and counted.
        self.assertIn("flags of CAN FD of 3 frames", said["csv"])
        recorder = self.record("-o", "b.log", "-n", str(len(sent)))
        self.run_tool("replay", self.path("a.pcapng"))
        self.assertEqual(recorder.wait(timeout=60), 0)
        self.assertEqual(kept(self.path("b.log")), sent)

    def test_the_time_of_the_bus_is_recorded(self):
        self.start_sim()
        recorder = self.record("-o", "a.log", "-n", "20")
        self.run_tool("publish", "gyro", "50ms")
        self.assertEqual(recorder.wait(timeout=60), 0)
        with open(self.path("a.log")) as file:
            stamps = [float(LINE.match(line)[1]) for line in file if "608#" in line]
        self.assertEqual(len(stamps), 19)  # and the request
        for earlier, later in zip(stamps, stamps[1:]):
            self.assertAlmostEqual(later - earlier, 0.05, delta=0.01)

    def test_every_signal_finishes_the_file(self):
        self.start_sim()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            name = f"{number}.log"
            recorder = self.record("-o", name)
            sent = self.send_numbered(10)
            self.settle()
            _, err = self.interrupt(recorder, number)
            self.assertEqual(recorder.returncode, 128 + number, err)
            self.assertEqual(self.frames(name), sent)

    def test_nohup_is_respected(self):
        self.start_sim()
        recorder = self.record("-o", "a.log", preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        recorder.send_signal(signal.SIGHUP)
        sent = self.send_numbered(10)
        self.wait_for_frames("a.log", 10)
        self.interrupt(recorder)
        self.assertEqual(self.frames("a.log"), sent)

    def test_default_names_never_overwrite(self):
        self.start_sim()
        # Several in the same second, surely: all at once.
        recorders = [self.record() for _ in range(3)]
        for recorder in recorders:
            self.interrupt(recorder)
        names = [name for name in os.listdir(self.folder) if name.endswith(".log")]
        self.assertEqual(len(names), 3, names)
        for name in names:
            self.assertRegex(name, r"^amiro-\d{4}-\d\d-\d\d_\d{6}(-\d)?\.log$")

    def test_a_file_that_is_there_stays(self):
        self.start_sim()
        with open(self.path("a.log"), "w") as file:
            file.write("precious")
        _, err = self.run_tool("record", "-o", self.path("a.log"), code=1)
        self.assertIn("a.log is there already", err)
        self.assertIn("--force", err)
        with open(self.path("a.log")) as file:
            self.assertEqual(file.read(), "precious")
        self.run_tool("record", "-o", self.path("a.log"), "--force", "--duration", "100ms")
        self.assertEqual(os.path.getsize(self.path("a.log")), 0)

    def test_topics_and_filters(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "20ms")
        self.run_tool("publish", "accel", "20ms")
        topic = self.record("-o", "topic.log", "gyro", "-n", "5")
        raw = self.record("-o", "raw.log", "--filter", "609:7FF", "-n", "5")
        others = self.record("-o", "others.log", "--raw-ids", "608~7FF", "-n", "5")
        for recorder in (topic, raw, others):
            self.assertEqual(recorder.wait(timeout=60), 0)
        self.assertEqual({number for number, _ in self.frames("topic.log")}, {"608"})
        self.assertEqual({number for number, _ in self.frames("raw.log")}, {"609"})
        self.assertEqual({number for number, _ in self.frames("others.log")}, {"609"})
        commands = self.record("-o", "commands.log", "gyro", "--commands")
        self.run_tool("stop", "gyro")
        self.run_tool("stop", "accel")
        self.settle()
        self.interrupt(commands)
        self.assertIn(("208", "00"), self.frames("commands.log"))
        self.assertNotIn(("209", "00"), self.frames("commands.log"))

    def test_split_by_size_loses_nothing(self):
        self.start_sim()
        recorder = self.record("-o", "part.log", "--split", "20kB")
        sent = self.send_numbered(4000)
        self.settle()
        _, err = self.interrupt(recorder)
        names = sorted(name for name in os.listdir(self.folder) if name.startswith("part_"))
        self.assertGreater(len(names), 5)
        self.assertEqual(names, [f"part_{i:03}.log" for i in range(1, len(names) + 1)])
        self.assertEqual([frame for name in names for frame in self.frames(name)], sent)
        for name in names[:-1]:
            self.assertGreaterEqual(os.path.getsize(self.path(name)), 20_000)
            self.assertLess(os.path.getsize(self.path(name)), 20_000 + 256 * 50)
        self.assertIn(f"({len(names)} files)", err)

    def test_split_by_time_and_ring(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "10ms")
        recorder = self.record("-o", "part.log", "--split", "300ms", "--ring", "3")
        self.wait_for_frames("part_007.log", 1)
        _, err = self.interrupt(recorder)
        names = sorted(name for name in os.listdir(self.folder) if name.startswith("part_"))
        self.assertEqual(len(names), 3)
        self.assertGreaterEqual(names[0], "part_004.log")
        stamps = []
        for name in names:
            with open(self.path(name)) as file:
                own = [float(LINE.match(line)[1]) for line in file]
            self.assertLess(own[-1] - own[0], 0.3)
            stamps += own
        for earlier, later in zip(stamps, stamps[1:]):
            self.assertLess(later - earlier, 0.02)
        self.assertIn("of the files deleted again", err)

    def test_split_by_time_while_the_clock_is_set(self):
        os.makedirs(self.path("ocm"), mode=0o700)
        server = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        server.bind(self.path("ocm/sim.sock"))
        os.chmod(self.path("ocm/sim.sock"), 0o600)
        server.listen()
        server.settimeout(10)

        def serve():
            node, _ = server.accept()
            node.recv(32)
            node.send(struct.pack("<B3xIIII12s", HELLO, MAGIC, VERSION, 500_000, 64, b"sim"))
            begin = time.monotonic()
            while (passed := time.monotonic() - begin) < 2:
                unix = 1_700_000_000 + passed - (3600 if passed > 0.5 else 0)  # set back after half a second
                node.send(struct.pack("<BBBxIq8s8x", FRAME, 0, 0, 0x123, int(unix * 1e9), b""))
                time.sleep(0.01)
            node.send(struct.pack("<BB2xI24x", GOODBYE, 1, VERSION))
            node.close()

        player = threading.Thread(target=serve)
        player.start()
        recorder = self.record("--bus", "sim", "-o", "part.log", "--split", "300ms")
        recorder.communicate(timeout=60)
        player.join()
        server.close()
        self.assertGreaterEqual(len(self.ring("part_")), 5)

    def test_a_simulator_that_takes_no_more_programs_is_no_quiet_bus(self):
        """Behind --duration it is asked, unless as many frames have come as there should be. It is played."""
        os.makedirs(self.path("ocm"), mode=0o700)
        server = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.addCleanup(server.close)
        server.bind(self.path("ocm/sim.sock"))
        os.chmod(self.path("ocm/sim.sock"), 0o600)
        server.listen()
        server.settimeout(30)
        for name, most in (("quiet.log", ("--duration", "100ms")), ("one.log", ("--duration", "60s", "-n", "1"))):
            recorder = self.start("--bus", "sim", "record", "-o", self.path(name), *most)
            node, _ = server.accept()
            self.addCleanup(node.close)
            node.send(struct.pack("<B3xIIII12s", HELLO, MAGIC, VERSION, 500_000, 64, b"sim"))
            if name == "one.log":
                node.send(struct.pack("<BBBxIq8s8x", FRAME, 0, 0, 0x123, time.time_ns(), b""))
            else:
                asks, _ = server.accept()
                asks.recv(32)
                asks.close()
            _, err = recorder.communicate(timeout=60)
            self.assertEqual(recorder.returncode, 0 if name == "one.log" else 1, err)
        self.assertEqual(self.frames("one.log"), [("123", "")])

    def test_what_was_lost_is_counted_and_a_failure_where_it_is_strict(self):
        """In the simulator, which is played, and in a controller, which says so in a frame of errors."""
        os.makedirs(self.path("ocm"), mode=0o700)
        server = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.addCleanup(server.close)
        server.bind(self.path("ocm/sim.sock"))
        os.chmod(self.path("ocm/sim.sock"), 0o600)
        server.listen()
        server.settimeout(30)
        error = 4  # its format; in its second byte it says that there was no room
        for overflows, overrun, said in ((0, 7, ", 3 error frames, 7 lost in the receive queue\n"),
                                         (2, 0, ", 3 error frames, 2 times frames lost in the controller\n"),
                                         (2, 7, ", 3 error frames, 7 lost in the receive queue, 2 times frames lost in the controller\n"),
                                         (0, 0, ", 3 error frames\n")):
            for strict in ((), ("--strict",)):
                recorder = self.start("--bus", "sim", "record", "-o", self.path("errors.log"), "--force", "-n", "4", *strict)
                node, _ = server.accept()
                self.addCleanup(node.close)
                node.send(struct.pack("<B3xIIII12s", HELLO, MAGIC, VERSION, 500_000, 64, b"sim"))
                for number in range(3):
                    node.send(struct.pack("<BBBxIq8s8x", FRAME, error, 8, 4, time.time_ns(), b"\0\x01" if number < overflows else b""))
                if overrun:
                    node.send(struct.pack("<B7xQ16x", OVERRUN, overrun))
                node.send(struct.pack("<BBBxIq8s8x", FRAME, 0, 0, 0x123, time.time_ns(), b""))
                _, err = recorder.communicate(timeout=60)
                self.assertEqual(recorder.returncode, 1 if strict and overflows + overrun else 0, err)
                self.assertIn(said, err)

    def test_a_ring_is_a_budget_over_restarts(self):
        self.start_sim()
        for _ in range(4):
            self.run_ring("bb.log")
        self.assertEqual(self.ring("bb_"), ["bb_003.log", "bb_004.log"])
        for _ in range(3):
            self.run_ring()
        self.assertEqual(self.ring("amiro-ring_"), ["amiro-ring_002.log", "amiro-ring_003.log"])

    def test_a_ring_whose_disk_is_full_keeps_what_it_has(self):
        """A service that is restarted until there is room must not empty its black box."""
        self.start_sim()
        for _ in range(2):
            self.run_ring("bb.log")
        for _ in range(3):
            recorder = self.record("-o", "bb.log", "--split", "1h", "--ring", "2",
                                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)))
            self.send_numbered(1)
            self.assertIn("cannot write bb_003.log: File too large", recorder.communicate(timeout=60)[1])
        self.assertEqual(self.ring("bb_"), ["bb_001.log", "bb_002.log"])

    def test_a_ring_on_a_silent_bus_keeps_what_it_has(self):
        self.start_sim()
        for _ in range(2):
            self.run_ring("bb.log")
        for ending in ("log", "pcapng", "log.gz"):
            for _ in range(3):
                recorder = self.record("-o", "bb." + ending, "--split", "1h", "--ring", "2")
                if ending == "pcapng":  # it begins its file without a frame
                    time.sleep(1.2)  # it writes once a second
                _, err = self.interrupt(recorder)
                self.assertRegex(err, r" 0 frames .*, not kept: a ring keeps no file without a frame\n")
        self.assertEqual(self.ring("bb_"), ["bb_001.log", "bb_002.log"])

    def test_a_ring_that_is_killed_on_a_silent_bus_keeps_what_it_has(self):
        self.start_sim()
        for ending in ("log", "pcapng"):
            for _ in range(2):
                self.run_ring("bb." + ending)
            kept = self.ring("bb_")
            for _ in range(4):
                recorder = self.record("-o", "bb." + ending, "--split", "1h", "--ring", "2")
                time.sleep(1.2)  # it writes once a second
                recorder.kill()
                recorder.communicate(timeout=60)
            self.run_ring("bb." + ending)
            self.assertEqual(self.ring("bb_"), kept[1:] + [f"bb_007.{ending}"])
            for name in self.ring("bb_"):
                os.unlink(self.path(name))

    def test_a_ring_leaves_alone_what_is_not_its_own(self):
        self.start_sim()
        for number in range(1, 6):
            with open(self.path(f"bb_{number:03}.log"), "w") as file:
                file.write("(1.000000) can0 123#\n")
        open(self.path("bb_006.log"), "w").close()
        before = self.ring("bb_")
        self.run_tool("record", "-o", self.path("bb.log"), "--split", "1h", "--ring", "2", "-n", "1", code=1)
        self.assertEqual(self.ring("bb_"), before)  # what is refused deletes nothing
        recorder = self.record("-o", "own.log", "--split", "1h", "--ring", "2")
        os.rename(self.path("own_001.log"), self.path("moved.log"))
        with open(self.path("own_001.log"), "w") as file:
            file.write("of another program")
        _, err = self.interrupt(recorder)
        self.assertIn("own_001.log was moved while it was recorded", err)
        with open(self.path("own_001.log")) as file:
            self.assertEqual(file.read(), "of another program")

    def test_a_pipe_without_a_reader_is_waited_for_in_words(self):
        self.start_sim()
        pipe = self.path("live.log")
        os.mkfifo(pipe)
        recorder = self.start("record", "-o", pipe, "-n", "1")
        self.assertIn("bus: ", recorder.stderr.readline())
        self.assertEqual(recorder.stderr.readline(), f"{pipe} is a pipe without a reader: one is waited for\n")
        with open(pipe, encoding="ascii") as reader:
            self.assertIn("recording to ", recorder.stderr.readline())
            self.send_numbered(1)
            self.assertRegex(reader.read(), r"^\(.*#.*\n$")
        self.assertEqual((recorder.communicate(timeout=60), recorder.returncode)[1], 0)

    def test_pipes_and_dead_links_with_the_next_number_are_passed_over(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "10ms")
        os.mkfifo(self.path("part_002.log"))
        os.symlink("nowhere", self.path("part_003.log"))
        recorder = self.record("-o", "part.log", "--split", "200ms")
        self.wait_for_frames("part_004.log", 1)
        _, err = self.interrupt(recorder)
        self.assertEqual(recorder.returncode, 130, err)

    def run_ring(self, *name):
        recorder = self.record(*(("-o", *name) if name else ()), "--split", "1h", "--ring", "2", "-n", "1")
        self.send_numbered(1)
        self.assertEqual((recorder.communicate(timeout=60), recorder.returncode)[1], 0)

    def ring(self, beginning):
        return sorted(name for name in os.listdir(self.folder) if name.startswith(beginning))

    def test_a_ring_does_not_delete_other_recordings(self):
        self.start_sim()
        for number in range(1, 6):
            with open(self.path(f"bb_{number:03}.log"), "w") as file:
                file.write("(1.000000) can0 123#\n")
        self.run_tool("publish", "gyro", "5ms")
        words = ("record", "-o", self.path("bb.log"), "--split", "1h", "--ring", "2", "-n", "1")
        _, err = self.run_tool(*words, code=1)
        self.assertIn("--ring 2 would delete 4 of them", err)
        self.assertEqual(len(self.ring("bb_")), 5)
        self.run_tool(*words, "--force")
        self.assertEqual(self.ring("bb_"), ["bb_005.log", "bb_006.log"])

    def test_a_ring_takes_over_one_file_more_than_it_keeps_and_no_more(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "5ms")
        words = ("record", "-o", self.path("bb.log"), "--split", "1h", "--ring", "2", "-n", "1")
        for count, code in ((3, 0), (4, 1), (1, 0)):
            for name in self.ring("bb_"):
                os.unlink(self.path(name))
            for number in range(1, count + 1):
                with open(self.path(f"bb_{number:03}.log"), "w", encoding="ascii") as file:
                    file.write("(1.000000) can0 123#\n")
            _, err = self.run_tool(*words, code=code)
            files = f"{count} file{'' if count == 1 else 's'}"
            if code == 0:
                self.assertIn(f"the ring holds {files} of earlier recordings, {self.path('bb')}_*.log; the oldest go first\n", err)
                self.assertEqual(self.ring("bb_"), [f"bb_{number:03}.log" for number in (count, count + 1)])
            else:
                self.assertIn(f"{files} {self.path('bb')}_*.log are there, and --ring 2 would delete 3 of them now\n"
                              "          give another name, or --force to delete them\n", err)
                self.assertEqual(len(self.ring("bb_")), count)

    def test_a_file_that_is_deleted_is_an_error(self):
        self.start_sim()
        recorder = self.record("-o", "a.log")
        self.send_numbered(10)
        os.unlink(self.path("a.log"))
        _, err = recorder.communicate(timeout=60)
        self.assertEqual(recorder.returncode, 1, err)
        self.assertIn("a.log was deleted while it was recorded", err)
        self.assertIn("0 frames can be read, 10 were not written", err)

    def test_a_file_that_another_program_empties_is_an_error(self):
        self.start_sim()
        recorder = self.record("-o", "a.log")
        self.send_numbered(10)
        waiting.until(lambda: os.path.getsize(self.path("a.log")) > 0, "the first frames are in the file")
        os.truncate(self.path("a.log"), 0)
        _, err = recorder.communicate(timeout=60)
        self.assertEqual(recorder.returncode, 1, err)
        self.assertIn("a.log was emptied by another program while it was recorded", err)

    def test_a_file_that_is_emptied_while_frames_come_is_an_error(self):
        self.start_sim()
        for name in ("a.log", "a.pcapng", "a.log.gz"):
            recorder = self.record("-o", name)
            self.send_numbered(10)
            waiting.until(lambda name=name: os.path.getsize(self.path(name)) > 0, "the first frames are in the file")
            recorder.send_signal(signal.SIGSTOP)
            os.truncate(self.path(name), 0)
            self.send_numbered(10)  # they are written before the file is looked at again
            recorder.send_signal(signal.SIGCONT)
            _, err = recorder.communicate(timeout=60)
            self.assertEqual(recorder.returncode, 1, err)
            self.assertIn(f"{name} was emptied by another program while it was recorded", err)

    def test_a_ring_that_is_recorded_to_is_not_joined(self):
        self.start_sim()
        recorder = self.record("-o", "bb.log", "--split", "1h", "--ring", "2")
        _, err = self.run_tool("record", "-o", self.path("bb.log"), "--split", "1h", "--ring", "2", "--duration", "100ms", code=1)
        self.assertRegex(err, "another program records to .*bb_001.log now\n +end it, or give another name")
        self.assertEqual(self.ring("bb_"), ["bb_001.log"])
        self.interrupt(recorder)

    def test_of_two_rings_that_begin_at_once_one_records(self):
        self.start_sim()
        ring = ("record", "-o", "bb.log", "--split", "1h", "--ring", "2")
        turn = os.open(self.folder, os.O_RDONLY | os.O_DIRECTORY)
        fcntl.flock(turn, fcntl.LOCK_EX)
        both = [self.start(*ring, cwd=self.folder) for _ in range(2)]
        folder = os.path.realpath(self.folder)
        waiting.until(lambda: all(folder in open_files(each.pid) for each in both), "both wait for their turn")
        os.close(turn)
        waiting.until(lambda: any(each.poll() is not None for each in both), "one has ended")
        ended, recorder = sorted(both, key=lambda each: each.poll() is None)
        self.assertRegex(ended.communicate()[1], "another program records to bb_001.log now")
        self.assertEqual(ended.returncode, 1)
        self.send_numbered(3)
        self.wait_for_frames("bb_001.log", 3)
        self.interrupt(recorder)
        self.assertEqual(self.ring("bb_"), ["bb_001.log"])

    def test_a_ring_does_not_wait_for_ever_for_another_that_begins(self):
        self.start_sim()
        turn = os.open(self.folder, os.O_RDONLY | os.O_DIRECTORY)
        fcntl.flock(turn, fcntl.LOCK_EX)
        _, err = self.run_tool("record", "-o", self.path("bb.log"), "--split", "1h", "--ring", "2", code=1)
        self.assertRegex(err, f"another program begins a recording in {self.folder}, .*\n +is it stopped")
        waits = self.start("record", "-o", "bb.log", "--split", "1h", "--ring", "2", cwd=self.folder)
        waiting.until(lambda: os.path.realpath(self.folder) in open_files(waits.pid), "it waits")
        self.interrupt(waits)
        self.assertEqual(waits.returncode, 130)
        os.close(turn)
        self.assertEqual(self.ring("bb_"), [])

    def test_a_file_that_is_moved_is_recorded_to_the_end(self):
        self.start_sim()
        recorder = self.record("-o", "a.log")
        sent = self.send_numbered(10)
        os.rename(self.path("a.log"), self.path("b.log"))
        sent += self.send_numbered(10, 10)
        self.wait_for_frames("b.log", 20)
        _, err = self.interrupt(recorder)
        self.assertIn("a.log was moved while it was recorded", err)
        self.assertIn("20 frames can be read, 0 were not written", err)
        self.assertEqual(self.frames("b.log"), sent)

    def test_one_recorder_a_file(self):
        self.start_sim()
        first = self.record("-o", "a.log")
        sent = self.send_numbered(10)
        self.wait_for_frames("a.log", 10)
        _, err = self.run_tool("record", "-o", self.path("a.log"), "--force", code=1)
        self.assertIn("another program writes", err)
        self.interrupt(first)
        self.assertEqual(self.frames("a.log"), sent)

    def test_to_standard_output_at_once(self):
        self.start_sim()
        recorder = self.record("-o", "-")
        sent = self.send_numbered(1)
        line = recorder.stdout.readline()
        self.assertEqual(LINE.match(line.rstrip("\n")).group(3, 4), sent[0])
        self.interrupt(recorder)

    def test_a_frame_that_is_read_live_does_not_wait_for_the_next_look_at_the_file(self):
        """Each is sent when the one before has come: 20 seconds if each took the second in which a file is written."""
        self.start_sim()
        recorder = self.record("-o", "-")
        begin = time.monotonic()
        for number in range(20):
            sent = self.send_numbered(1, number)
            self.assertEqual(LINE.match(recorder.stdout.readline().rstrip("\n")).group(3, 4), sent[0])
        self.assertLess(time.monotonic() - begin, 10)
        self.interrupt(recorder)

    def test_what_a_format_begins_with_is_in_a_file_before_the_first_frame_but_not_in_one_of_a_ring(self):
        self.start_sim()
        ring = self.record("-o", "ring.pcapng", "--split", "1h", "--ring", "1")
        plain = self.record("-o", "plain.pcapng")
        waiting.until(lambda: os.path.getsize(self.path("plain.pcapng")) > 0, "the beginning of the format")
        self.assertEqual(os.path.getsize(self.path("ring_001.pcapng")), 0)  # it has had its second, too
        self.interrupt(plain)
        self.interrupt(ring)

    def test_two_buses_in_one_file(self):
        other = "sim:" + self.path("other.sock")
        self.start_sim()
        self.start_sim("--bus", other, "--bus-errors", "400", "--seed", "3")
        recorder = self.record("-o", "both.log", "--bus", "sim," + other)
        for bus in ("sim", other):
            self.run_tool("publish", "gyro", "2ms", "--bus", bus)
        self.wait_for_frames("both.log", 800)

        def recorded(bus):
            with open(self.path("both.log")) as file:
                return sum(f" {bus} " in line for line in file)
        # The second may begin when the first has sent that many.
        waiting.until(lambda: min(map(recorded, ("sim", other))) > 200, "frames of both")
        _, err = self.interrupt(recorder)
        self.assertRegex(err, rf"\d error frames on {re.escape(other)}")
        self.assertNotRegex(err, "error frames on sim[,\n]")
        with open(self.path("both.log")) as file:
            lines = [LINE.match(line.rstrip("\n")) for line in file]
        self.assertEqual(sorted({line[2] for line in lines}), ["sim", other])
        # Between two simulators the order is that in which they hand frames over, which is theirs to be late with;
        # between two interfaces it is exact (tests/peers/socketcan).
        for bus in ("sim", other):
            stamps = [line[1] for line in lines if line[2] == bus]
            self.assertEqual(stamps, sorted(stamps))
            self.assertGreater(len(stamps), 200)

    def test_a_simulator_that_ends(self):
        sim = self.start_sim()
        recorder = self.record("-o", "a.log")
        sent = self.send_numbered(50)
        self.settle()
        self.interrupt(sim)
        _, err = recorder.communicate(timeout=60)
        self.assertEqual(recorder.returncode, 1)
        self.assertIn("was ended", err)
        self.assertEqual(self.frames("a.log"), sent)

    def test_a_simulator_that_ends_while_we_are_behind(self):
        sim = self.start_sim("--bitrate", "1000000")
        recorder = self.record("-o", "a.log")
        recorder.send_signal(signal.SIGSTOP)
        sent = self.send_numbered(12_000)  # more than the kernel and the simulator keep for a program
        waiting.until_asleep(sim.pid)
        _, said_sim = self.interrupt(sim)
        recorder.send_signal(signal.SIGCONT)
        _, err = recorder.communicate(timeout=60)
        self.assertEqual(recorder.returncode, 1)
        self.assertIn("was ended", err)
        written = self.frames("a.log")
        self.assertEqual(written, sent[:len(written)])
        lost = len(sent) - len(written)
        self.assertGreater(lost, 0)
        self.assertIn(f", {lost} lost in the receive queue\n", err)  # of one bus its name says nothing
        self.assertIn(f"{lost} frames lost by slow ones", said_sim)

    def test_a_file_that_may_not_grow_keeps_what_it_has(self):
        self.start_sim()
        limit = 20_000
        recorder = self.record("-o", "a.log", "--no-sync",
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        sent = self.send_numbered(100)
        waiting.until(lambda: os.path.getsize(self.path("a.log")) != 0, "what has come is in the file")
        sent += self.send_numbered(3000, first=100)
        _, err = recorder.communicate(timeout=60)
        self.assertEqual(recorder.returncode, 1, err)
        written = self.frames("a.log")
        self.assertEqual(written, sent[:len(written)])
        self.assertGreater(len(written), 0)
        said = re.search(r"(\d+) frames? can be read, (\d+) (?:was|were) not written", err)
        self.assertEqual(int(said[1]), len(written))
        received = int(re.search(r"recorded (\d+) frames?", err)[1])
        self.assertEqual(int(said[2]), received - len(written))
        self.assertIn("cannot write a.log", err)
        # Where it takes nothing, what was there stays, and nothing stands in the way of the next try.
        with open(self.path("old.log"), "w") as file:
            file.write("# an older file\n")
        recorder = self.record("-o", "old.log", "--force", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)))
        self.send_numbered(1)
        self.assertIn("cannot write old.log: File too large", recorder.communicate(timeout=60)[1])
        with open(self.path("old.log")) as file:
            self.assertEqual(file.read(), "# an older file\n")
        recorder = self.record("-o", "b.log", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)))
        self.send_numbered(1)
        _, err = recorder.communicate(timeout=60)
        self.assertEqual(recorder.returncode, 1, err)
        self.assertIn("0 frames can be read, 1 was not written", err)
        self.assertFalse(os.path.exists(self.path("b.log")))

    def test_usage(self):
        self.start_sim()
        for words, hint in ((("-o", "x"), "--to one of: "),
                            (("-o", "x.log", "--to", "xml"), "no format 'xml'"),
                            (("--split", "soon"), "100MB"),
                            (("--ring", "3"), "--split"),
                            (("--split", "1MB", "-o", "-"), "-o"),
                            (("--filter", "zz"), "id:mask"),
                            (("--filter", "20000000:7FF"), "id:mask"),
                            (("gyrro",), "did you mean 'gyro'"),
                            (("--duration", "soon"), "500ms")):
            _, err = self.run_tool("record", *words, code=2)
            self.assertIn(hint, err)
        for buses in ("sim,", ",sim", ","):
            _, err = self.run_tool("--bus", buses, "record", "-o", self.path("x.log"), "--duration", "1ms", code=2)
            self.assertEqual(err, f"amiroctl: record: --bus {buses} has an empty name\n          a comma stands between two names\n")
        self.assertEqual([name for name in os.listdir(self.folder) if name.endswith(".log")], [])
        _, err = self.run_tool("record", "-o", self.path("no/such/folder.log"), code=1)
        self.assertIn("cannot create", err)

    def record_on_a_terminal(self, name, columns=0):
        """Records for 2.5 s, with messages to a terminal; and where they are read. 0 columns: it does not say how many it has."""
        ours, theirs = os.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        recorder = waiting.Program([AMIROCTL, "record", "-o", self.path(name), "--duration", "2500ms"],
                                   env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=theirs)
        os.close(theirs)
        self._started.append(recorder)
        return recorder, ours

    def said_on_a_terminal(self, recorder, ours):
        text = b""
        try:
            while piece := os.read(ours, 4096):
                text += piece
        except OSError:
            pass  # the end of a terminal
        os.close(ours)
        self.assertEqual(recorder.wait(timeout=60), 0)
        return text.decode()

    def test_progress_on_a_terminal(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "5ms")
        wide, narrow = self.record_on_a_terminal("a.log"), self.record_on_a_terminal("b.log", columns=40)
        said = self.said_on_a_terminal(*wide)
        self.assertRegex(said, r"\d+ frames, [12]\d\d/s, sim [3-6] % full, 0 lost, [0-9.]+ (bytes|kB), "
                               r"[0-9.]+ \S+ free")
        lasted = float(re.search(r"recorded \d+ frames in ([0-9.]+)s to", said)[1])
        self.assertLessEqual(said.count(" free"), int(lasted))  # once a second
        # No error frame came, so none is counted.
        self.assertRegex(said, r"recorded \d+ frames in [2-9]\.\d+s to \S+a\.log, \d+\.\d kB\r\n$")
        # A line that breaks could not be erased; the last column is left free.
        lines = [line for line in self.said_on_a_terminal(*narrow).split("\r\x1b[K") if re.match(r"\d+ frames?, ", line)]
        self.assertEqual({len(line) for line in lines}, {39}, lines)


class OnASerialLine(WithAdapter, Case):
    def test_frames_that_were_lost_are_a_failure_where_it_is_strict(self):
        """An adapter says of itself, as it is opened, that it had no room, or that its controller warns: a frame of the recording."""
        log = os.path.join(self.folder, "a.log")
        for events, strict, code in ((0x01, ("--strict",), 1), (0x01, (), 0), (0x04, ("--strict",), 0)):
            with self.subTest(events=events, strict=strict):
                adapter = self.adapter()
                adapter.events = events
                _, err = self.run_tool("--bus", f"slcan:{adapter.path}", "record", "-o", log, "--force", "-n", "1", *strict, code=code)
                self.assertRegex(err, r"\nrecorded 1 frame in ")
                self.assertEqual("lost in the controller" in err, events == 0x01, err)


if __name__ == "__main__":
    main()
