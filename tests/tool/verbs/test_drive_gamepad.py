"""amiroctl drive --gamepad: devices that are none, and what is refused before anything moves. How a pad drives is in
tests/tool/clock/pad_drive.cpp, with pads that are played."""

import os

import harness


class Gamepad(harness.Case):
    def refused(self, *arguments, code=1):
        """What it said; nothing was sent."""
        self.start_sim("--frozen")
        listener = self.listen("motors", "--commands")
        _, said = self.run_tool("drive", *arguments, code=code)
        self.settle()
        out, _ = self.interrupt(listener)
        self.assertEqual(out, "")
        return said

    def test_a_build_without_libevdev_says_so(self):
        """And one with it names what it was given; either is a whole message."""
        said = self.run_tool("drive", "--gamepad", "/dev/null", code=1)[1]
        if "was built without libevdev" in said:
            self.assertIn("install libevdev-dev and build again", said)
        else:
            self.assertIn("/dev/null is no input device", said)

    def test_what_is_no_gamepad(self):
        if "was built without libevdev" in self.run_tool("drive", "--gamepad", "/dev/null", code=1)[1]:
            return
        said = self.refused("--gamepad", "/dev/input/event9999")
        self.assertIn("gamepad /dev/input/event9999: No such file or directory", said)
        self.assertRegex(said, "gamepads? (here|can be read)")
        plain = os.path.join(self.folder, "plain")
        with open(plain, "w", encoding="ascii") as file:
            file.write("no events")
        for path in (plain, self.folder, "/dev/zero"):
            self.assertIn("is no input device", self.run_tool("drive", "--gamepad", path, code=1)[1], path)

    def test_limits_and_usage(self):
        self.assertIn("out of range", self.refused("--gamepad", "/dev/null", "2m/s", code=2))
        self.assertIn("is no speed", self.run_tool("drive", "--gamepad", "/dev/null", "fast", code=2)[1])
        for other in (("--keys",), ("--for", "2s"), ("--once",), ("--dry-run",)):
            self.assertIn("--gamepad", self.run_tool("drive", "5cm/s", "--gamepad", "/dev/null", *other, code=2)[1], other)


if __name__ == "__main__":
    harness.main()
