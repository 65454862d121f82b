"""amiroctl goto with simulated mappers behind a radio that loses packets: what the robot itself did is what was said."""

import json
import os
import re
import signal
import time

from harness import Case, main, waiting


class Radio(Case):
    def sim(self, loss, seed):
        world = os.path.join(self.folder, "hall.json")
        with open(world, "w", encoding="utf-8") as file:
            json.dump({"name": "hall", "walls": [[[-9, -9], [9, -9], [9, 9], [-9, 9], [-9, -9]]],
                       "central": {"at": [0, 0], "range": 100},
                       "robots": [{"name": "AVR", "model": "avr", "at": [0, 0], "heading": 0}]}, file)
        sim = self.start("sim", "--world", world, "--radio-loss", str(loss), "--seed", str(seed))
        for line in sim.stderr:
            if "Ctrl-C ends it" in line:
                return sim
        self.fail(f"the simulator ended with {sim.wait()}")

    def place(self, listening="4s"):
        """Where the robot stands, and in which state. On a busy machine a central is late, and is asked again."""
        end = time.monotonic() + 60
        while time.monotonic() < end:
            out, err = self.start("robots", "--json", "--listen", listening).communicate(timeout=60)
            robots = [json.loads(line) for line in out.splitlines()]
            if robots and robots[0]["pose"]:
                return robots[0]
        return self.fail(f"the robot is not heard: {err}")

    def stands(self):
        before = self.place()["pose"]
        time.sleep(1)  # it would have moved by then
        after = self.place()["pose"]
        for name, now in after.items():  # 1: as its noise is rounded
            self.assertLessEqual(abs(now - before[name]), 1, f"{before}, {after}")

    def test_arrives_at_every_loss(self):
        for loss in (0, 0.2, 0.4):
            with self.subTest(loss=loss):
                sim = self.sim(loss, 3)
                out, err = self.run_tool("goto", "AVR", "45", "25", "--timeout", "100s", timeout=120)
                x, y, heading = map(int, re.fullmatch(r"AVR: x (-?\d+) cm, y (-?\d+) cm, heading (-?\d+) deg\n", out).groups())
                self.assertLess(abs(x - 18) + abs(y - 18), 8, err)
                self.assertLess(abs(heading - 45), 9)
                _, told = self.interrupt(sim)
                self.assertRegex(told, r"set points [1-9]\d*, arrived [1-9]")

    def test_an_end_of_any_kind_stops_the_robot(self):
        for number, seed in ((signal.SIGINT, 1), (signal.SIGTERM, 2)):
            with self.subTest(number=number):
                sim = self.sim(0.4, seed)
                out, _ = self.run_tool("goto", "AVR", "0", "60", "--no-wait", timeout=120)
                self.assertEqual(out, "")
                goto = self.start("goto", "AVR", "0", "500")
                time.sleep(6)  # it drives, with packets lost
                goto.send_signal(number)
                _, err = goto.communicate(timeout=60)
                self.assertEqual(goto.returncode, 128 + number)
                self.assertNotIn("may still drive", err)
                self.stands()
                self.interrupt(sim)

    def check_end_of_a_drive(self, victim, number, most_cm):
        """Of a joined `goto`, and the program that has the line."""
        sim = self.sim(0, 5)
        owner = self.start("central", "--own")
        for line in owner.stderr:
            if "Ctrl-C ends it" in line:
                break
        goto = self.start("goto", "AVR", "0", "500")

        def x():
            return self.place("100ms")["pose"]["x_cm"]
        waiting.until(lambda: x() > 5, "it drives", 60)
        before = x()
        (goto if victim == "goto" else owner).send_signal(number)
        if victim == "central":
            _, err = goto.communicate(timeout=60)
            self.assertEqual(goto.returncode, 1)
            self.assertIn("AVR may still drive: at the latest it stops after 60 cm", err)
        time.sleep(8)  # the rest of a leg takes 6 s
        after = self.place()["pose"]
        self.assertLessEqual(after["x_cm"] - before, most_cm)
        self.stands()
        if victim == "goto":
            goto.send_signal(signal.SIGCONT)
            _, err = goto.communicate(timeout=60)
            self.assertEqual(goto.returncode, 1)
            self.assertRegex(err, r"goto \(process \d+\) said nothing for 2 s")
            self.interrupt(owner)
        self.interrupt(sim)

    def test_the_program_that_sends_it_hangs(self):
        """It is stopped for when it has said nothing for 2 s."""
        self.check_end_of_a_drive("goto", signal.SIGSTOP, 35)

    def test_the_program_that_has_the_line_is_killed(self):
        """Without an owner the robot ends its leg of 60 cm."""
        self.check_end_of_a_drive("central", signal.SIGKILL, 65)


if __name__ == "__main__":
    main(together=True)
