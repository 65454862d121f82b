"""A recording that is killed, or whose disk is full: the file opens in the tools that others use, and holds a prefix of
what was on the bus, less at most the last second."""

import contextlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, os.path.join(os.environ["OCM_SOURCE_DIR"], "tests"))
import can
import mcap_core
import waiting
from virtual_bus import Client

AMIROCTL = os.environ["AMIROCTL"]
KILLS = int(os.environ.get("OCM_KILLS", "20"))  # for each format, 20 at once; 100 take some minutes
AT_ONCE = 20
IDENTIFIER = 0x123
LEAST_S = 1.0  # docs/verbs/record.md: what is older is in the file
SLACK_S = 1.0  # of a machine that runs twenty recorders
# In memory: a recorder waits for its disk, for seconds where others write to the same one, and a kill loses nothing that the kernel has.
MEMORY = "/dev/shm"


def numbers_of_python_can(path):
    """Its readers know no half line, which a killed writer or a full disk leaves at the end: Linux ends a write(2) of a
    killed process at a page."""
    with open(path, "rb+") as file:
        file.truncate(file.read().rfind(b"\n") + 1)
    if os.path.getsize(path) == 0:
        return []
    with can.LogReader(path) as reader:
        return [int.from_bytes(message.data, "big") for message in reader if message.arbitration_id == IDENTIFIER]


def numbers_of_tshark(path):
    out = subprocess.run(["tshark", "-r", path, "-T", "fields", "-e", "can.id", "-e", "data.data"], text=True,
                         stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    # A file that ends within a block is read up to there, and exit code 2 says so.
    if out.returncode not in (0, 2):
        raise AssertionError(f"tshark on {path}: {out.stderr}")
    lines = [line.split("\t") for line in out.stdout.splitlines()]
    return [int(data, 16) for number, data in lines if int(number) == IDENTIFIER]


def numbers_of_mcap_core(path):
    messages = [json.loads(text) for *_, text in mcap_core.run("streamed", path)["messages"]]
    return [int(frame["data"], 16) for frame in messages if frame.get("id") == IDENTIFIER]


def numbers_of_ours(path):
    out = subprocess.run([AMIROCTL, "convert", path, "-", "--to", "candump"], text=True, stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, check=False)
    lines = [line.split()[2] for line in out.stdout.splitlines()]
    return [int(line.split("#")[1], 16) for line in lines if line.startswith("123#")]


def numbers_of_unpacked_text(path, *tool):
    out = subprocess.run([*tool, path], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    lines = out.stdout.decode().rpartition("\n")[0].splitlines()
    return [int(line.split("#")[1].split()[0], 16) for line in lines if " 123#" in line]


def numbers_of_gzip(path):
    return numbers_of_unpacked_text(path, "gzip", "-dcq")


def numbers_of_zstd(path):
    """The tool throws away what it had not written yet when a file ends early: up to 128 KiB of text."""
    theirs, ours = numbers_of_unpacked_text(path, "zstd", "-dcq"), numbers_of_ours(path)
    if ours[:len(theirs)] != theirs or len(ours) - len(theirs) > (128 << 10) / 36:
        raise AssertionError(f"{path}: zstd has {len(theirs)} frames, we have {len(ours)}")
    return ours


FORMATS = {
    ".log": numbers_of_python_can,
    ".pcapng": numbers_of_tshark,
    ".pcap": numbers_of_tshark,
    ".asc": numbers_of_python_can,
    ".csv": numbers_of_python_can,
    ".mcap": numbers_of_mcap_core,
    ".blf": numbers_of_ours,
    ".log.zst": numbers_of_zstd,
    ".log.gz": numbers_of_gzip,
}


class Traffic(threading.Thread):
    """Numbered frames, 400 a second at most, and when they were handed over: twenty recorders keep up on a slow machine, beside
    other work. Where they could not, the frames would wait in the simulator's socket, and no thread would have starved."""

    def __init__(self, folder):
        super().__init__(daemon=True)
        self.client = Client(folder)
        self.sent = 0
        self.history = []  # time, number of the next frame
        self.ends = False

    def run(self):
        while not self.ends:
            if self.sent % 16 == 0:
                self.history.append((time.monotonic(), self.sent))
                time.sleep(0.04)
            self.client.send(IDENTIFIER, self.sent.to_bytes(4, "big"))
            self.sent += 1

    def before(self, moment):
        """How many frames had been sent at that time."""
        return max((number for when, number in self.history if when <= moment), default=0)


class OnTheBus(unittest.TestCase):
    bit_rate = 500_000

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="ocm-durability-", dir=MEMORY if os.access(MEMORY, os.W_OK) else None)
        self.addCleanup(shutil.rmtree, self.folder, True)
        self.environment = {"PATH": os.environ["PATH"], "XDG_RUNTIME_DIR": self.folder, "HOME": self.folder}
        self.sim = self.start("sim", "--bitrate", str(self.bit_rate), "--without",
                              "di_wheel_drive,power_management,light_ring")
        self.wait_for(self.sim, "Ctrl-C ends it")

    def start(self, *arguments, **options):
        process = waiting.Program([AMIROCTL, *arguments], env=self.environment, text=True, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **options)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def wait_for(self, process, words):
        for line in process.stderr:
            if words in line:
                return
        self.fail(f"{process.args}: ended with {process.wait()}")

    def writes(self, ending):
        """Whether this amiroctl has the format, and what it needs to be packed."""
        path = os.path.join(self.folder, "try" + ending)
        done = subprocess.run([AMIROCTL, "record", "-o", path, "--duration", "1ms"], env=self.environment,
                              stderr=subprocess.PIPE, text=True, check=False)
        return done.returncode == 0


class Killed(OnTheBus):
    def killed(self, ending, traffic, dice):
        """Recordings of this format that were killed: path, number of the first frame, number of the frames that must
        be there."""
        recorders = []
        for _ in range(AT_ONCE):
            path = os.path.join(self.folder, f"{dice.randrange(1 << 60):x}{ending}")
            recorder = self.start("record", "-o", path)
            recorders.append((recorder, path))
        running = []
        for recorder, path in recorders:
            self.wait_for(recorder, "Ctrl-C ends")
            running.append((recorder, path, time.monotonic(), self.starved(recorder)))
        kills = sorted((time.monotonic() + dice.uniform(0, 3), recorder, path, since, before)
                       for recorder, path, since, before in running)
        result = []
        for moment, recorder, path, since, before in kills:
            time.sleep(max(0, moment - time.monotonic()))  # at any instant
            now = time.monotonic()  # of the kill at the latest: this program may have no processor either
            recorder.send_signal(signal.SIGKILL)
            recorder.wait()
            starved = self.starved(recorder) - before  # the wait in which it was killed is counted once it is over
            old = now - LEAST_S - SLACK_S - starved
            result.append((path, since, traffic.before(old)))
        return result

    def starved(self, recorder):
        """For how long a frame could not come to the recorder's file for want of a processor, in seconds."""
        return sum(recorder.starved_threads().values()) + sum(self.sim.starved_threads().values())

    def test_killed_at_any_instant(self):
        traffic = Traffic(self.folder)
        traffic.start()
        dice = random.Random(1)
        seen = 0
        for ending, numbers_of in FORMATS.items():
            if not self.writes(ending):
                continue
            seen += 1
            frames = 0
            for _ in range(max(1, KILLS // AT_ONCE)):
                for path, since, least in self.killed(ending, traffic, dice):
                    with self.subTest(format=ending, file=path):
                        if os.path.getsize(path) == 0:
                            numbers = []  # killed before anything was written
                        else:
                            numbers = numbers_of(path)
                        if numbers:
                            self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))))
                            self.assertLessEqual(numbers[0], traffic.before(since + SLACK_S))
                        if least > traffic.before(since):
                            self.assertTrue(numbers and numbers[-1] >= least - 1,
                                            f"frames up to {least} were sent over a second before the end, "
                                            f"up to {numbers[-1] if numbers else None} are in the file")
                        frames += len(numbers)
                    os.unlink(path)
            self.assertGreater(frames, 100, f"{ending}: hardly a frame was recorded")
        traffic.ends = True
        traffic.join(5)
        traffic.client.socket.close()
        self.assertGreaterEqual(seen, 1)


class FullDisk(OnTheBus):
    bit_rate = 2_000_000

    def small_disk(self):
        disk = os.path.join(self.folder, "disk")
        os.mkdir(disk)
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=600k", "tmpfs", disk], check=False,
                                 stderr=subprocess.DEVNULL).returncode == 0
        if not mounted:
            self.skipTest("no right to mount a small disk")
        self.addCleanup(subprocess.run, ["umount", disk], check=False)
        return disk

    def test_what_has_no_room_replaces_nothing(self):
        disk = self.small_disk()
        log = os.path.join(disk, "in.log")
        with open(log, "w") as file:
            file.writelines(f"({1e9 + i:.6f}) can0 605#00D20000\n" for i in range(3000))
        old = os.path.join(disk, "old.csv")
        with open(old, "w") as file:
            file.write("# an older file\n")
        with contextlib.suppress(OSError), open(os.path.join(disk, "fill"), "wb", buffering=0) as fill:
            while fill.write(bytes(1024)):
                pass
        for verb in (["convert", log], ["convert", log, "--to", "pcapng"]):
            with self.subTest(verb):
                _, err = self.start(verb[0], verb[1], old, "--force", *verb[2:]).communicate(timeout=60)
                self.assertIn("No space left on device\n          free some space; nothing of it was kept\n", err)
                with open(old) as file:
                    self.assertEqual(file.read(), "# an older file\n")

    def test_a_full_disk(self):
        disk = self.small_disk()
        for ending, numbers_of in FORMATS.items():
            if not self.writes(ending):
                continue
            with self.subTest(format=ending):
                path = os.path.join(disk, "full" + ending)
                recorder = self.start("record", "-o", path)
                self.wait_for(recorder, "Ctrl-C ends")
                client = Client(self.folder)
                i = 0
                while recorder.poll() is None and i < 400_000:
                    # Bytes that do not pack well.
                    client.send(IDENTIFIER, i.to_bytes(4, "big") + random.randbytes(4))
                    i += 1
                client.close()
                err = recorder.communicate(timeout=60)[1]
                self.assertEqual(recorder.returncode, 1, err)
                self.assertIn("No space left", err)
                self.assertRegex(err, r"\d+ frames? can be read, [1-9]\d* (was|were) not written")
                said = int(err.split(" frames can be read")[0].split()[-1])
                numbers = [number >> 32 for number in numbers_of(path)]
                self.assertEqual(numbers, list(range(len(numbers))))
                self.assertGreater(len(numbers), 500)
                self.assertEqual(len(numbers), said)
            os.unlink(path)


if __name__ == "__main__":
    unittest.main(verbosity=1)
