"""line: what mappers said, as JSON; damaged sentences are counted, and none is passed on."""

import binascii
import os
import pty
import select
import subprocess
import tty

from harness import AMIROCTL, Case, main, waiting

# What robot 0 said at the edge of the radio's reach, through a central. [Thesis 2, listing 15.1]
LISTING = (
    b"[0] :AVR:{U,-177,-61,-68,49,0[0]:AVR:,0,0,0}\n"
    b"[0] :AVR:{S,IDL}\n"
    b"[0] :AVR:{U,-177,-61,-68,47,0[0]:AVR:-68,46,0,0,0,0}\n"
    b",0,0[0]:AVR:,0}\n"
    b"{U,-177,-61,{U,-[0]:AVR:,0}\n"
    b"{U,-177,-61,-72,[0]:AVR:,-69,45,0,0,0{U,-177[0]:AVR:,0,43,0,0}\n"
    b"}\n"
    b"{U,-177,-[0]:AVR:,-63,39,0,34,0,0}\n"
    b",0[0]:AVR:,-74,41,0,36,0,0}\n"
    b"{U[0]:AVR:,-177,-61,-59,38,0,3[0]:AVR:77,-61,-60,37,0,32,0\n"
    b"[0]:AVR:{S,IDL}\n"
    b"{U,-1{U,-177[0]:AVR:0}\n"
    b",0}\n"
    b"61,-73,42{U,-[0]:AVR:,23,80,0}\n"
    b"[0]:AVR:4,0,22,70,0}\n"
    b"36,0,32[0]:AVR:40,0{U3,0,0}\n"
    b"2,0,0,0}\n"
    b"}\n"
    b"177,-61[0]:AVR:L}0,17,58,0,-177{U,-[0]:AVR:171,-6{S,IDL\n"
    b"[0]:AVR:{U,-177,-60,142,29,0[0]:AVR:,16,0,0}\n")
NAMES = ("x", "y", "heading", "servo", "s1", "s2", "s3", "s4")
IDLE = {"robot": 0, "name": "AVR", "type": "idle", "values": {}}


def update(*numbers, robot=0, name="AVR", **more):
    return {"robot": robot, "name": name, "type": "update", "values": dict(zip(NAMES, numbers)), **more}


def packed(sequence, *numbers):
    """An update in 20 bytes. [docs/mapper-link.md, packed updates]"""
    bits = f"{sequence:08b}"
    for number, width in zip(numbers, (16, 16, 16, 8, 12, 12, 12, 12)):
        bits += f"{number % (1 << width):0{width}b}"
    body = bytes([0xB1] + [0x80 | int(bits[i:i + 7], 2) for i in range(0, 112, 7)])
    check = f"{binascii.crc_hqx(body, 0xFFFF):021b}"
    return body + bytes(0x80 | int(check[i:i + 7], 2) for i in range(0, 21, 7))


class Line(Case):
    def line(self, said, *arguments, code=0):
        """(objects, what stderr says) of bytes on the standard input."""
        result = subprocess.run([AMIROCTL, "line", *arguments], env=self.environment, input=said, capture_output=True,
                                timeout=30)
        err = result.stderr.decode()
        self.assertEqual(result.returncode, code, err)
        return self.objects(result.stdout.decode()), err

    def file(self, content):
        path = os.path.join(self.folder, "central.log")
        with open(path, "wb") as file:
            file.write(content)
        return path

    def test_the_listing(self):
        heard, err = self.line(LISTING)
        self.assertEqual(heard, [update(-177, -61, -68, 49, 0, 0, 0, 0), IDLE, IDLE,
                                 update(-177, -60, 142, 29, 0, 16, 0, 0)])
        self.assertIn("[0] AVR: 4 whole sentences, 21 damaged (3 torn, 2 unclosed, 8 headless, 1 unknown, "
                      "5 with a bad number, 2 with a wrong count of integers)", err)
        self.assertEqual(self.line(b"", "--", self.file(LISTING)), (heard, err))
        self.assertEqual(list(heard[0]), ["robot", "name", "type", "values"])

    def test_every_sentence_of_a_robot_without_prefixes(self):
        heard, err = self.line(b"{H,20,30,-1,4,0,90,180,270,2000,20225,7,8}\n{H,15}\n\t!\n{S,IDL}{U,1,2,-3,4,5,6,7,8}"
                               b"{C,7,2,41,-57,152,1,2}\n")
        self.assertEqual({(line["robot"], line["name"]) for line in heard}, {(None, None)})
        self.assertEqual([line["type"] for line in heard], ["handshake", "handshake", "pong", "idle", "update", "calibration"])
        self.assertEqual(heard[0]["values"], {
            "width": 20, "length": 30, "axle_offset": -1, "tower_offset": 4, "sensor1": 0, "sensor2": 90,
            "sensor3": 180, "sensor4": 270, "deadline": 2000, "formats": 20225, "sensor_out": 7, "more": [8]})
        self.assertEqual(heard[1]["values"], {"width": 15})
        self.assertEqual(heard[4], update(1, 2, -3, 4, 5, 6, 7, 8, robot=None, name=None))
        self.assertEqual(heard[5]["values"],
                         {"number": 7, "verdict": 2, "x": 41, "y": -57, "field": 152, "error": 1, "use": 2})
        self.assertEqual(err, "6 whole sentences, 0 damaged; link quality 100 %\n")

    def test_what_is_said_to_a_robot(self):
        said = b"{S,CON}\n{U,90,-130}\n{S,PAU}\n{S,UNP}\n{S,BIN}\n{S,TXT}\n{S,WHO}\n{C,7}\n{}\n{ }\n[2]:B:{U,361,0}\n{S,IDL}\n"
        heard, err = self.line(said, "--to-robot")
        self.assertEqual([line["type"] for line in heard],
                         ["confirm", "set_point", "pause", "unpause", "packed", "text", "who", "calibrate",
                          "ping", "ping"])
        self.assertEqual(heard[1]["values"], {"angle": 90, "distance": -130})
        self.assertEqual(heard[7]["values"], {"number": 7})
        self.assertIn("10 whole sentences, 0 damaged\n", err)
        self.assertIn("[2] B: 0 whole sentences, 2 damaged (1 unknown, 1 out of range)\n", err)
        _, err = self.line(said[:-8], code=1)  # the other direction
        self.assertIn("--to-robot", err)

    def test_packed_updates(self):
        numbers = (-177, -61, -68, 49, 12, 30, 45, 80)
        good = packed(5, *numbers)
        # tests/unit/mapper/link/packed.cpp has the same bytes.
        self.assertEqual(good.hex(), "b182ffe9fffe8fffbc98c09881f08ba0d080aaf2")
        damaged = bytearray(packed(7, *numbers))
        damaged[9] ^= 1
        said = (b"[0]:AVR:" + good + b"[3]:B:{S,I[0]:AVR:" + packed(6, *numbers) + b"[3]:B:DL}\n[0]:AVR:" + damaged +
                b"[0]:AVR:" + packed(6, *numbers) + packed(9, *numbers) + good[:7] + b"{S,IDL}\n")
        heard, err = self.line(said)
        self.assertEqual(heard, [update(*numbers, sequence=5), update(*numbers, sequence=6),
                                 {"robot": 3, "name": "B", "type": "idle", "values": {}},
                                 update(*numbers, sequence=9), IDLE])
        self.assertIn("[0] AVR: 4 whole sentences, 5 damaged (1 packed and corrupt, 1 packed and torn, "
                      "2 packed and lost, 1 packed and repeated)", err)
        self.assertIn("[3] B: 1 whole sentence, 0 damaged; link quality 100 %", err)
        # One of before, and one of a tower that cannot stand so.
        heard, err = self.line(good + packed(4, *numbers) + packed(6, 0, 0, 0, 91, 0, 0, 0, 0))
        self.assertEqual([line["sequence"] for line in heard], [5])
        self.assertIn("1 whole sentence, 2 damaged (1 packed and late, 1 packed and out of range)", err)
        # What is said to a robot is never packed.
        heard, _ = self.line(good + b"{S,CON}", "--to-robot")
        self.assertEqual([line["type"] for line in heard], ["confirm"])

    def test_robots_are_kept_apart(self):
        heard, err = self.line(b'{S,I[0]:A:DL}[1]:B"\\:{U,1,2,[0]:A:{S,I[1]:B"\\:3,4,5,6,7,8}[0]:A:DL}\n[0]:C:{S,I[0]:D:DL}'
                               b"[300]:A:{S,IDL}[0:A:{S,IDL}\n[255]:Z:{S,IDL}\n")
        self.assertEqual(heard, [update(1, 2, 3, 4, 5, 6, 7, 8, robot=1, name='B"\\'),
                                 {"robot": 0, "name": "A", "type": "idle", "values": {}},
                                 {"robot": 255, "name": "Z", "type": "idle", "values": {}}])
        self.assertIn("0 whole sentences, 1 damaged (1 unclosed)", err)
        self.assertIn("broken prefixes: 2, and after them 23 characters", err)

    def test_exit_codes(self):
        self.line(b"{S,IDL}\n", "--strict")
        for said in (b"{S,IDL}\n}", b"{S,IDL}\nx", b"{S,IDL}\n[0:A:", b"{S,IDL}\n{S,IDL", LISTING):
            self.line(said)
            self.line(said, "--strict", code=1)
        for said in (b"", b"\n\n", b"{U,1,2,3}\n", bytes(range(256)) * 1000):
            _, err = self.line(said, code=1)
            self.assertIn("no whole sentence in the standard input", err)
        _, err = self.line(b"# line of a central, version 1\n1.0 > {S,IDL}\n", code=2)
        self.assertEqual(err, "amiroctl: line: the standard input is the recorded line of a central, with times and both directions\n"
                              "          `amiroctl serve FILE` plays it; line reads the bytes of one direction\n")
        self.assertEqual(len(self.line(b"{S,IDL}" * 5, "-n", "3")[0]), 3)
        for arguments, code, word in ((["/nowhere.log"], 1, "/nowhere.log"), ([self.folder], 1, "Is a directory"),
                                      (["-n", "0"], 2, "--count"), (["--what"], 2, "--what")):
            self.assertIn(word, self.line(b"", *arguments, code=code)[1])

    def test_noise_has_no_link_quality(self):
        for said, quality in ((b"\xff\x00" * 50 + b"x" * 200, "link quality unknown"), (b"{U,1,2,3}\n", "link quality 0 %")):
            _, err = self.line(said, code=1)
            self.assertIn(quality, err)
            self.assertNotIn("100 %", err)

    def test_a_long_stream_in_any_pieces(self):
        """Sentences across every border of the blocks that are read; and the order is kept."""
        count = 20000
        said = b"".join(b"[%d]:R:{U,%d,0,0,0,0[%d]:R:,0,0,0}\n" % (n % 3, n, n % 3) for n in range(count))
        heard, err = self.line(said)
        self.assertEqual([(line["robot"], line["values"]["x"]) for line in heard], [(n % 3, n) for n in range(count)])
        self.assertEqual(err.count(" 0 damaged"), 3)

    def test_a_live_pipe_is_shown_at_once_and_ended_by_a_signal(self):
        process = waiting.Program([AMIROCTL, "line"], env=self.environment, stdin=subprocess.PIPE,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self._started.append(process)
        for piece in (b"[0]:AVR:{S,I", b"DL}", b"{S,ID"):
            process.stdin.write(piece)
            process.stdin.flush()
            shown = select.select([process.stdout], [], [], 60 if piece == b"DL}" else 0.2)[0]
            self.assertEqual(bool(shown), piece == b"DL}")
            if shown:
                self.assertEqual(self.objects(process.stdout.readline().decode()), [IDLE])
        self.settle()  # it has read all of it
        _, err = self.interrupt(process)
        self.assertEqual(process.returncode, 130)
        self.assertIn(b"1 whole sentence, 1 damaged (1 unclosed)", err)

    def test_a_serial_line(self):
        """A line that hangs up is at its end."""
        robot, line = pty.openpty()
        tty.setraw(line)
        process = self.start("line", os.ttyname(line))
        os.write(robot, b"{S,IDL}\n")
        self.assertEqual(self.objects(process.stdout.readline())[0]["type"], "idle")
        os.close(line)
        os.close(robot)
        _, err = process.communicate(timeout=60)
        self.assertIn("1 whole sentence, 0 damaged", err)

    def test_a_reader_that_goes_away_and_a_full_disk(self):
        path = self.file(LISTING * 20000)
        pipe = subprocess.run(f"'{AMIROCTL}' line '{path}' | head -1; echo ${{PIPESTATUS[0]}}", shell=True, text=True,
                              executable="/bin/bash", capture_output=True, timeout=30)
        self.assertEqual((pipe.stdout.splitlines()[1], pipe.stderr), ("141", ""))
        with open("/dev/full", "w", encoding="utf-8") as full:
            result = subprocess.run([AMIROCTL, "line", path], stdout=full, text=True, stderr=subprocess.PIPE, timeout=30)
        self.assertEqual(result.returncode, 1)
        self.assertIn("cannot write", result.stderr)


if __name__ == "__main__":
    main()
