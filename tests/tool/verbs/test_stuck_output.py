"""Where the output cannot go: a pipe whose reader has stopped, and a device that is full. A signal ends the command all
the same, with its exit code; a full device ends it by itself."""

import fcntl
import json
import os
import signal
import subprocess
import termios
import time

from harness import AMIROCTL, Case, main, waiting

LINES = "".join(f"({1000 + i / 100:.6f}) can0 608#{i % 100:02d}0000000000\n" for i in range(300))


class StuckOutput(Case):
    def setUp(self):
        super().setUp()
        self.log = os.path.join(self.folder, "a.log")
        self.json = os.path.join(self.folder, "a.json")
        with open(self.log, "w", encoding="utf-8") as file:
            file.write(LINES)
        with open(self.json, "w", encoding="utf-8") as file:
            file.write(self.run_tool("decode", self.log)[0])

    def start_to(self, stdout, *arguments, stderr=subprocess.PIPE):
        process = waiting.Program([AMIROCTL, *arguments], env=self.environment, stdin=subprocess.DEVNULL, stdout=stdout,
                                  stderr=stderr, text=True)
        self._started.append(process)
        return process

    def wait_for_handler(self, process):
        """Until SIGINT is caught: before that it kills, as it should."""
        def is_caught():
            self.assertIsNone(process.poll(), "it ended before the signal")
            with open(f"/proc/{process.pid}/status", encoding="utf-8") as status:
                caught = next(int(line.split()[1], 16) for line in status if line.startswith("SigCgt"))
            return caught >> (signal.SIGINT - 1) & 1
        waiting.until(is_caught, "SIGINT is caught")

    @staticmethod
    def full_pipe():
        reader, writer = os.pipe()
        fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)
        os.set_blocking(writer, False)
        try:
            while True:
                os.write(writer, b"\n" * 4096)
        except BlockingIOError:
            os.set_blocking(writer, True)
        return reader, writer

    def test_a_pipe_that_has_no_reader_yet(self):
        pipe = os.path.join(self.folder, "pipe.csv")
        os.mkfifo(pipe)
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start_to(subprocess.DEVNULL, "convert", self.log, pipe, "--force")
            self.wait_for_handler(process)
            waiting.until_asleep(process.pid)
            process.send_signal(number)
            said = f"{pipe} is a pipe without a reader: one is waited for\n"
            self.assertEqual((process.communicate(timeout=60)[1], process.returncode), (said, 128 + number))

    def test_a_reader_that_stands_still(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "2ms")
        for arguments in (["record", "-o", "-"], ["record", "-o", "-", "--to", "pcapng"], ["stats"], ["stats", self.log],
                          ["stats", self.log, "--json"], ["plot", self.log, "gyro.z", "-o", "-"],
                          ["plot", self.log, "gyro.z", "--script"], ["replay", self.log, "--dry-run"], ["decode", self.log],
                          ["decode", self.log, "--csv"], ["convert", self.log, "-", "--to", "csv"], ["encode", self.json],
                          ["listen"]):
            with self.subTest(arguments=arguments):
                reader, writer = self.full_pipe()
                process = self.start_to(writer, *arguments)
                os.close(writer)
                self.wait_for_handler(process)
                waiting.until_asleep(process.pid)
                process.send_signal(signal.SIGINT)
                self.assertEqual(process.wait(timeout=60), 128 + signal.SIGINT)
                os.close(reader)

    def test_a_travel_that_has_arrived(self):
        self.start_sim()
        reader, writer = self.full_pipe()
        listener = self.start("listen", "behaviour", "--field", "behaviour.ended", "--timeout", "60s")
        self.assertIn("bus: sim", listener.stderr.readline())
        process = self.start_to(writer, "--bus", "sim", "travel", "1cm")
        os.close(writer)
        waiting.until(lambda: '"arrived"' in listener.stdout.readline() or process.poll() is not None, "the end of the travel")
        waiting.until_asleep(process.pid)
        time.sleep(0.3)  # its last words to the board
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), 128 + signal.SIGINT)
        os.close(reader)

    def test_messages_that_cannot_go_hold_up_no_robot(self):
        script = os.path.join(self.folder, "tour.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s led 1 red\n100ms drive 5cm/s\n400ms stop\n")
        self.start_sim()
        listener = self.start("listen", "--commands", "motors", "--timeout", "20s")
        self.assertIn("bus: sim", listener.stderr.readline())
        reader, writer = self.full_pipe()
        process = self.start_to(subprocess.DEVNULL, "--bus", "sim", "run", script, stderr=writer)
        os.close(writer)
        for data in ("50C3000000000000", "0000000000000000"):
            waiting.until(lambda data=data: data in listener.stdout.readline(), data)
        self.assertEqual(process.wait(timeout=60), 0)
        os.close(reader)

    def test_answers_that_nobody_reads_hold_up_no_script(self):
        script = os.path.join(self.folder, "tour.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s publish gyro 10ms\n0s drive 5cm/s\n400ms stop\n")
        self.start_sim()
        listener = self.start("listen", "--commands", "motors", "--timeout", "20s")
        self.assertIn("bus: sim", listener.stderr.readline())
        reader, writer = self.full_pipe()
        process = self.start_to(writer, "--bus", "sim", "run", script, "--show")
        os.close(writer)
        for data in ("50C3000000000000", "0000000000000000"):
            waiting.until(lambda data=data: data in listener.stdout.readline(), data)
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, err)
        self.assertRegex(err, r"run: [1-9]\d* answers not shown: stdout took none\n")
        os.close(reader)

    def test_a_reader_that_is_slow_gets_the_last_answer(self):
        script = os.path.join(self.folder, "tour.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s once gyro\n200ms stop\n")
        self.start_sim()
        listener = self.start("listen", "--commands", "motors", "--timeout", "20s")
        self.assertIn("bus: sim", listener.stderr.readline())
        reader, writer = self.full_pipe()
        process = self.start_to(writer, "--bus", "sim", "run", script, "--show")
        os.close(writer)
        waiting.until(lambda: "0000000000000000" in listener.stdout.readline(), "the last step")
        time.sleep(0.3)  # of a second
        os.set_blocking(reader, True)
        os.read(reader, 1 << 20)
        self.assertEqual(process.wait(timeout=60), 0)
        self.assertNotIn("not shown", process.stderr.read())
        self.assertIn(b'"topic":"gyroscope"', os.read(reader, 1 << 20))
        os.close(reader)

    def test_a_terminal_that_nobody_reads_holds_up_no_script(self):
        """It says that it takes more while it takes one byte."""
        script = os.path.join(self.folder, "tour.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s publish proximity_ring 5ms\n0s publish gyro 2ms\n0s drive 5cm/s\n1500ms stop\n")
        self.start_sim()
        listener = self.start("listen", "--commands", "motors", "--timeout", "20s")
        self.assertIn("bus: sim", listener.stderr.readline())
        ours, theirs = os.openpty()
        process = self.start_to(theirs, "--bus", "sim", "run", script, "--show")
        os.close(theirs)
        for data in ("50C3000000000000", "0000000000000000"):
            waiting.until(lambda data=data: data in listener.stdout.readline(), data)
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, err)
        self.assertRegex(err, r"run: [1-9]\d* answers not shown: stdout took none\n")
        os.close(ours)

    def test_a_terminal_that_goes_ends_a_travel(self):
        """In the middle of a line that it had no room for."""
        script = os.path.join(self.folder, "tour.script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("0s publish gyro 2ms\n0s set travel distance=100cm angle=0rad speed=10cm/s\n60s stop\n")
        self.start_sim()
        listener = self.start("listen", "gyro", "-n", "600")
        self.assertIn("bus: sim", listener.stderr.readline())
        ours, theirs = os.openpty()
        process = self.start_to(theirs, "--bus", "sim", "run", script, "--show")
        os.close(theirs)
        listener.communicate(timeout=60)  # so many do not fit into a terminal that is not read
        os.close(ours)
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, err)
        self.assertIn("travel was ended\n", err)
        self.assertEqual(err.count("cannot write the output"), 1, err)

    def test_messages_that_nobody_reads_hold_up_no_recording(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "10ms")
        out = os.path.join(self.folder, "out.log")
        reader, writer = self.full_pipe()
        process = self.start_to(subprocess.DEVNULL, "record", "-o", out, "-n", "20", stderr=writer)
        os.close(writer)
        self.assertEqual(process.wait(timeout=60), 0)
        os.close(reader)
        with open(out, encoding="utf-8") as file:
            self.assertEqual(len(file.readlines()), 20)

    def test_a_reader_that_is_slow_gets_the_last_messages(self):
        """Of what was said while it did not read; it has a second for that, in which the program sleeps."""
        self.start_sim()
        self.run_tool("publish", "gyro", "10ms")
        reader, writer = self.full_pipe()
        process = self.start_to(subprocess.DEVNULL, "record", "-o", os.path.join(self.folder, "out.log"), "-n", "20", stderr=writer)
        os.close(writer)

        def is_over():
            with open(os.path.join(self.folder, "out.log"), encoding="utf-8") as file:
                return len(file.readlines()) == 20
        waiting.until(lambda: os.path.exists(os.path.join(self.folder, "out.log")) and is_over(), "all is recorded")
        with os.fdopen(reader, encoding="utf-8") as said:
            lines = said.read().lstrip("\n").splitlines()
        self.assertEqual(process.wait(timeout=60), 0)
        self.assertEqual([line.split()[0] for line in lines], ["bus:", "recording", "recorded"], lines)

    def test_a_terminal_that_is_held_holds_up_no_recording(self):
        """Ctrl-S, which a terminal obeys before any program reads it."""
        self.start_sim()
        self.run_tool("publish", "gyro", "5ms")
        out = os.path.join(self.folder, "out.log")
        ours, theirs = os.openpty()
        process = self.start_to(subprocess.DEVNULL, "record", "-o", out, "-n", "300", stderr=theirs)
        self.assertIn(b"bus: ", os.read(ours, 4096))
        termios.tcflow(theirs, termios.TCOOFF)
        os.close(theirs)
        self.assertEqual(process.wait(timeout=60), 0)
        os.close(ours)
        with open(out, encoding="utf-8") as file:
            self.assertEqual(len(file.readlines()), 300)

    def test_a_slow_reader_gets_whole_lines(self):
        with open(self.log, "a", encoding="utf-8") as file:
            file.write(LINES * 100)
        for arguments in (["decode", self.log], ["convert", self.log, "-", "--to", "json"]):
            with self.subTest(arguments=arguments):
                reader, writer = self.full_pipe()
                process = self.start_to(writer, *arguments)
                os.close(writer)
                self.wait_for_handler(process)
                waiting.until_asleep(process.pid)
                process.send_signal(signal.SIGINT)
                waiting.until_asleep(process.pid)
                with os.fdopen(reader, encoding="utf-8") as out:
                    lines = out.read().lstrip("\n").splitlines(keepends=True)
                self.assertEqual(process.wait(timeout=60), 128 + signal.SIGINT)
                self.assertGreater(len(lines), 0)
                self.assertTrue(lines[-1].endswith("}\n"))
                for line in lines:
                    json.loads(line)

    def test_a_full_device_ends_what_would_go_on(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "2ms")
        for arguments in (["stats"], ["stats", "--json", "--duration", "300ms"], ["record", "-o", "-"],
                          ["record", "-o", "/dev/full", "--force", "--to", "pcapng"],  # not read back: it has no end
                          ["replay", self.log, "--dry-run"], ["plot", self.log, "gyro.z", "-o", "-"], ["listen"]):
            with self.subTest(arguments=arguments), open("/dev/full", "w", encoding="utf-8") as full:
                process = self.start_to(full, *arguments)
                _, err = process.communicate(timeout=60)
                self.assertEqual(process.returncode, 1, err)
                self.assertIn("No space left on device", err)
                self.assertNotIn("sent ", err)


if __name__ == "__main__":
    main()
