"""What Python tests wait with: what a program prints is whole, however often it is looked at meanwhile."""

import os
import select
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

import realtime
import waiting


class Printed(unittest.TestCase):
    def test_looking_at_it_changes_nothing(self):
        text = "import os\nfor i in range(20000): os.write(1, b'%d\\n' % i)"
        with tempfile.TemporaryFile() as file, subprocess.Popen([sys.executable, "-c", text], stdout=file) as program:
            looks = 0
            while program.poll() is None:
                self.assertTrue("".join(f"{i}\n" for i in range(20000)).startswith(waiting.printed(file)))
                looks += 1
            self.assertEqual(waiting.printed(file), "".join(f"{i}\n" for i in range(20000)))
        self.assertGreater(looks, 3)


class Lines(unittest.TestCase):
    def test_what_was_read_ahead_is_not_lost(self):
        with waiting.Program(["seq", "2000"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program:
            program.has_ended(0)  # so that the first line is read with those behind it
            first = program.stdout.readline()
            self.assertEqual((first + program.communicate()[0], program.returncode), ("".join(f"{i}\n" for i in range(1, 2001)), 0))

    def test_a_program_that_reads_nothing(self):
        with waiting.Program(["true"], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as program:
            self.assertEqual((program.communicate(b"x" * (1 << 20)), program.returncode), ((b"", None), 0))

    def test_bytes_that_are_no_text(self):
        with waiting.Program(["printf", "\\377"], stdout=subprocess.PIPE, encoding="utf-8") as program:
            self.assertRaises(UnicodeDecodeError, program.communicate)

    def test_one_that_does_not_end_in_time(self):
        with waiting.Program(["sleep", "60"], stdout=subprocess.PIPE) as program:
            self.assertRaises(subprocess.TimeoutExpired, program.communicate, timeout=0.1)
            program.kill()
            self.assertEqual((program.communicate(), program.returncode), ((b"", None), -9))


class Played:
    """A program whose only thread is held by the kernel, from its third look on."""
    pid = 1

    def __init__(self):
        self.looks = 0

    def blocked_threads(self):
        self.looks += 1
        return {"1"} if self.looks > 2 else set()

    def starved_threads(self):
        return {"1": 0.0}


class HeldUp(unittest.TestCase):
    def test_who_is_held_by_the_kernel_is_late(self):
        program = Played()
        with realtime.Spare(lambda: [program]) as spare:
            waiting.until(lambda: program.looks > 20, "it is looked at")
        self.assertGreater(spare.late, 0.3)
        with realtime.Spare(lambda: [Played()]) as spare:  # each of which is looked at once
            waiting.until(lambda: spare.begin[1] + 1 < realtime.processor_times()[1], "the machine has run")
        self.assertLess(spare.late, 0.3)

    def test_when_the_machine_was_held_up(self):
        spare = realtime.Spare()
        spare.held_up = [(1.0, 1.5), (3.0, 4.0)]
        for begin, end, held_up in ((0.0, 9.0, 1.5), (1.25, 3.25, 0.5), (1.5, 3.0, 0.0), (3.1, 3.2, 0.1), (8.0, 9.0, 0.0)):
            self.assertAlmostEqual(spare.held_up_between(begin, end), held_up, msg=(begin, end))

    def test_a_byte_that_stays_away_is_late(self):
        terminal = realtime.Terminal()
        self.addCleanup(terminal.close)
        self.assertEqual(terminal.late(), 0.0)
        for _ in range(3):  # it arrives, and the next one goes
            waiting.until(lambda: select.select([terminal.slave], [], [], 0)[0], "it has arrived")
            begin = terminal.sent
            self.assertGreater(terminal.late(), 0.0)
            self.assertGreater(terminal.sent, begin)
        waiting.until(lambda: select.select([terminal.slave], [], [], 0)[0], "it has arrived")
        os.read(terminal.slave, 1)  # as if it had not
        sent = terminal.sent
        waiting.until(lambda: time.monotonic() - sent > 0.1, "a while is over")
        self.assertGreater(terminal.late(), 0.1)
        self.assertEqual(terminal.sent, sent)

    def test_calm_is_waited_for_and_not_for_ever(self):
        for late, least in ((1e9, 2.0), (-1.0, 0.2)):  # how late a thread may wake: always in time; never
            with unittest.mock.patch.object(realtime, "MOST_LATE", late):
                begin = time.monotonic()
                realtime.until_calm(limit=20 if late > 0 else 0.2)
                self.assertGreaterEqual(time.monotonic() - begin, least)

    def test_states_of_threads(self):
        with subprocess.Popen(["sleep", "60"]) as program:
            waiting.until(lambda: list(waiting.thread_states(program.pid).values()) == ["S"], "it sleeps")
            self.assertEqual(waiting.blocked_threads(program.pid), set())
            self.assertTrue(waiting.asleep(program.pid))
            program.kill()
        self.assertEqual(waiting.thread_states(program.pid), {})


if __name__ == "__main__":
    unittest.main()
