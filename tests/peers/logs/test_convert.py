"""amiroctl convert as its user meets it: formats by name and content, pipes, packed and damaged files, signals."""

import gzip
import os
import select
import signal
import stat
import subprocess
import time
import unittest

from harness import AMIROCTL, Case, random_messages

LOG = "(1436509052.249713) can0 605#00D20000\n(1436509052.250713) can1 1F334455##1DEAD T\n"


class Convert(Case):
    def file(self, name, content=LOG):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def test_by_ending_and_by_content(self):
        misnamed = self.file("drive.csv")  # a candump log, whatever its name
        self.run_tool("convert", misnamed, self.path("out.log"), "--force", "--strict")
        self.assertEqual(self.text(self.path("out.log")), LOG)
        out, _ = self.run_tool("convert", "-", "-", "--to", "candump", stdin=LOG.encode())
        self.assertEqual(out.decode(), LOG)

    def test_usage(self):
        log = self.file("in.log")
        for arguments, word in (((log, "-"), "--to"), ((log, "x.nothing"), "ending"), ((log, "x", "--to", "nope"), "nope"),
                                ((log, "x.log", "--from", "nope"), "nope"), ((log,), "OUT")):
            _, err = self.run_tool("convert", *arguments, code=2)
            self.assertIn(word, err)
            self.assertFalse(os.path.exists("x.log"))
        out, _ = self.run_tool("convert", "--help")
        self.assertIn(b"candump-ns", out)

    def test_the_same_file_is_refused_before_it_is_emptied(self):
        log = self.file("in.log")
        os.link(log, self.path("link.log"))
        for name in ("in.log", "link.log"):
            _, err = self.run_tool("convert", log, self.path(name), code=2)
            self.assertIn("same file", err)
        with open(log) as stdin:
            result = subprocess.run([AMIROCTL, "convert", "-", log], stdin=stdin, env=self.environment, capture_output=True)
        self.assertEqual(result.returncode, 2)
        self.assertEqual(self.text(log), LOG)

    def test_a_file_that_is_there_stays(self):
        log, out = self.file("in.log"), self.file("out.log", "precious")
        for arguments in (("convert", log, out), ("encode", "-o", out)):
            _, err = self.run_tool(*arguments, code=1)
            self.assertIn("out.log is there already", err)
            self.assertIn("--force", err)
            self.assertEqual(self.text(out), "precious")
        self.run_tool("convert", log, out, "--force")
        self.assertEqual(self.text(out), LOG)

    def test_who_may_read_and_write_it_the_umask_says(self):
        log = self.file("in.log")
        before = os.umask(0)
        try:
            for umask in (0o000, 0o027, 0o077):
                os.umask(umask)
                out = self.path(f"{umask}.log")
                self.run_tool("convert", log, out)
                self.assertEqual(stat.S_IMODE(os.stat(out).st_mode), 0o666 & ~umask)
        finally:
            os.umask(before)

    def test_what_cannot_be_read(self):
        for name, content, word in (("empty.log", "", "is empty"), ("x.bin", "\x01\x02 rubbish", "no known log format")):
            _, err = self.run_tool("convert", self.file(name, content), self.path("out.log"), "--force", code=1)
            self.assertIn(word, err)
            self.assertFalse(os.path.exists(self.path("out.log")))
        _, err = self.run_tool("convert", self.path("none.log"), self.path("out.log"), "--force", code=1)
        self.assertIn("No such file", err)
        _, err = self.run_tool("convert", self.folder, self.path("out.log"), "--force", code=1)
        self.assertIn("directory", err)

    def test_damaged_lines_are_told_and_the_rest_is_kept(self):
        log = self.file("in.log", "(1.0) can0 123#0\n" + LOG + "(2.0) can0 12#00\n\n(3.0) can0 123#00\n")
        _, err = self.run_tool("convert", log, self.path("out.log"), "--force")
        for word in ("line 1", "line 4", "3 frames", "2 places"):
            self.assertIn(word, err)
        self.run_tool("convert", log, self.path("out.log"), "--force", "--strict", code=1)
        self.assertEqual(self.text(self.path("out.log")).count("\n"), 3)
        only_bad = self.file("bad.log", "(1.0) can0 123#0\n")
        self.run_tool("convert", only_bad, self.path("out.log"), "--force", code=1)

    def test_losses(self):
        _, err = self.run_tool("convert", self.file("in.log"), self.path("out.csv"), "--force")
        self.assertIn("the direction of 1 frame", err)
        self.run_tool("convert", self.file("in.log"), self.path("out.csv"), "--force", "--strict", code=1)

    def test_packed(self):
        whole = self.file("in.log", "".join(map(self.candump_line, random_messages(1, 20_000))))
        for ending, unpack in ((".gz", ["gzip", "-dc"]), (".zst", ["zstd", "-dc"])):
            packed = self.path("out.log" + ending)
            self.run_tool("convert", whole, packed, "--strict")
            self.assertLess(os.path.getsize(packed), os.path.getsize(whole))
            self.assertEqual(subprocess.run([*unpack, packed], capture_output=True, check=True).stdout.decode(),
                             self.text(whole))
            self.run_tool("convert", packed, self.path("again.log"), "--force", "--strict")
            self.assertEqual(self.text(self.path("again.log")), self.text(whole))

    def test_packed_by_others(self):
        members = self.file("members", gzip.compress(LOG.encode()) + gzip.compress(LOG.encode()) + b"\0" * 512)
        out, _ = self.run_tool("convert", members, "-", "--to", "candump", "--strict")
        self.assertEqual(out.decode(), LOG * 2)
        frame = subprocess.run(["zstd", "-c"], input=LOG.encode(), capture_output=True, check=True).stdout
        out, _ = self.run_tool("convert", "-", "-", "--to", "candump", "--strict", stdin=frame + frame)
        self.assertEqual(out.decode(), LOG * 2)

    def test_packed_and_damaged(self):
        text = "".join(map(self.candump_line, random_messages(1, 5000)))
        zstd = subprocess.run(["zstd", "-c"], input=text.encode(), capture_output=True, check=True).stdout
        for packed in (gzip.compress(text.encode()), zstd):
            for size in (len(packed) // 2, len(packed) - 1):
                _, err = self.run_tool("convert", self.file("cut", packed[:size]), self.path("out.log"), "--force", code=1)
                self.assertIn("ends in the middle", err)
                kept = self.text(self.path("out.log"))
                self.assertTrue(text.startswith(kept) and (kept == "" or kept.endswith("\n")))
            flipped = bytearray(packed)
            flipped[len(packed) // 2] ^= 0xFF
            _, err = self.run_tool("convert", self.file("flipped", bytes(flipped)), self.path("out.log"), "--force", code=1)
            self.assertIn("damaged", err)

    def test_a_pipe_from_a_live_bus(self):
        """Each line comes out when it went in, the first one, too."""
        process = subprocess.Popen([AMIROCTL, "convert", "-", "-", "--to", "candump"], env=self.environment,
                                   stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for line in LOG.encode().splitlines(keepends=True):
            process.stdin.write(line)
            process.stdin.flush()
            self.assertTrue(select.select([process.stdout], [], [], 10)[0], "nothing came out")
            self.assertEqual(os.read(process.stdout.fileno(), 1000), line)
        process.communicate()
        self.assertEqual(process.returncode, 0)

    def test_interrupted(self):
        """What was read so far is in the file, whole lines only."""
        for number in (signal.SIGINT, signal.SIGTERM):
            out = self.path(f"out{number}.log")
            process = subprocess.Popen([AMIROCTL, "convert", "-", out], env=self.environment, stdin=subprocess.PIPE,
                                       stderr=subprocess.PIPE)
            process.stdin.write(LOG.encode() + b"(1436509053.000000) can0 605#00D2")
            process.stdin.flush()
            for _ in range(1000):
                if os.path.exists(out) and self.text(out) == LOG:
                    break
                time.sleep(0.01)
            process.send_signal(number)
            _, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 128 + number)
            self.assertEqual(self.text(out), LOG)
            self.assertIn(b"beginning only", err)

    def test_killed(self):
        """A file whose writer was killed holds a prefix of what it wrote: only the last line may be cut off, for Linux ends
        a write(2) of a killed process at a page."""
        out = self.path("out.log")
        process = subprocess.Popen([AMIROCTL, "convert", "-", out], env=self.environment, stdin=subprocess.PIPE,
                                   stderr=subprocess.DEVNULL)
        process.stdin.write((LOG * 20_000).encode())
        process.stdin.flush()
        for _ in range(1000):
            if os.path.exists(out) and os.path.getsize(out) > 0:
                break
            time.sleep(0.01)
        process.kill()
        process.wait()
        process.stdin.close()
        written = self.text(out)
        self.assertGreater(len(written), 0)
        self.assertTrue((LOG * 20_000).startswith(written))
        self.run_tool("convert", out, self.path("again.log"), "--force")
        again = self.text(self.path("again.log"))
        whole = written[:written.rfind("\n") + 1]
        self.assertEqual(again[:len(whole)], whole)
        self.assertLessEqual(again.count("\n"), whole.count("\n") + 1)

    def test_a_last_line_that_is_cut_off(self):
        """What test_killed may leave, at each place of the line: all before it is read, and it is named for what it is."""
        frames = 2 * 1000
        for size in range(1, len("(1436509052.249713) can0 605#")):
            torn = self.file("torn.log", LOG * 1000 + LOG[:size])
            _, err = self.run_tool("convert", torn, self.path("out.log"), "--force")
            self.assertEqual(self.text(self.path("out.log")), LOG * 1000)
            self.assertIn(f"line {frames + 1}: last line cut off: its writer was ended: {LOG[:size]}\n", err)
            self.assertIn("1 place could not be read, 1 last line cut off: its writer was ended\n", err)
        self.run_tool("convert", torn, self.path("out.log"), "--force", "--strict", code=1)
        out, err = self.run_tool("decode", torn, "--raw")
        self.assertEqual(out.count(b"\n"), frames)
        self.assertIn("last line cut off", err)
        _, err = self.run_tool("analyse", "trace", torn, code=1)
        self.assertNotIn("nothing was analysed", err)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full")
    def test_a_full_disk(self):
        log = self.file("in.log", LOG * 10_000)
        _, err = self.run_tool("convert", log, "/dev/full", "--to", "candump", code=1)
        self.assertIn("No space left", err)
        self.assertIn(" read, candump to candump: nothing of it was written\n", err)
        _, err = self.run_tool("convert", log, self.path("no/such/folder.log"), code=1)
        self.assertIn("folder", err)


if __name__ == "__main__":
    unittest.main()
