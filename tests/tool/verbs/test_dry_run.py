"""What each command sends, in candump notation, without a bus. [Thesis 4.2]"""

from harness import Case, main


class DryRun(Case):
    def check(self, arguments, *frames):
        out, err = self.run_tool(*arguments.split(), "--dry-run")
        self.assertEqual(out.split(), list(frames))
        self.assertEqual(err, "")

    def test_requests(self):
        self.check("publish mag 900us", "205#01840302")
        self.check("publish gyro 500ms", "208#01F40100")
        self.check("publish mag", "205#01")
        self.check("once floor", "204#02")
        self.check("stop magnetometer", "205#00")
        self.check("publish ring 1s --priority low", "31F#01E80300")
        self.check("once power --wait", "21E#02")

    def test_set_points(self):
        self.check("drive 0.05m/s 0.2rad/s", "201#50C30000400D0300")
        self.check("drive -.1m/s", "201#6079FEFF00000000")
        self.check("drive -0.1m/s", "201#6079FEFF00000000")
        self.check("drive -50000um/s", "201#B03CFFFF00000000")
        self.check("drive 0 0.2rad/s", "201#00000000400D0300")
        self.check("drive 1m/s -28.985507rad/s", "201#40420F005DB745FE")
        self.check("drive 5cm/s -.2rad/s --for 2s", "201#50C30000C0F2FCFF")
        self.check("drive stop", "201#0000000000000000")
        self.check("led 5 100,50,120", "240#643278")
        self.check("led 5 #643278", "240#643278")
        self.check("set motors x=5cm/s", "201#50C3000000000000")
        self.check("set led_1 red=255", "23C#FF0000")

    def test_frames_as_they_are(self):
        self.check("send 205#01840302", "205#01840302")
        self.check("send 1F334455#DE.AD.BE.EF", "1F334455#DEADBEEF")
        self.check("send 123#R", "123#R")

    def test_stop_brings_motors_to_rest_first(self):
        out, _ = self.run_tool("stop", "--dry-run")
        self.assertEqual(out.split()[0], "201#0000000000000000")
        self.assertEqual(out, self.run_tool("stop", "all", "--dry-run")[0])
        self.assertEqual(len(out.split()), 1 + 4 + 10 + 2 * 3)  # motors, behaviours, sensors, and each board's two reports
        self.assertEqual(out.split()[1:4], ["20B#0000000000000000", "20C#0000", "229#0000"])

    def test_options_may_stand_before_the_verb_or_behind_it(self):
        self.check("--bus nowhere publish gyro 1s", "208#01E80300")
        self.check("publish gyro 1s --bus nowhere", "208#01E80300")


if __name__ == "__main__":
    main()
