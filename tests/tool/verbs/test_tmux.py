"""What stays on the screen of a real terminal: tmux, of several widths. Needs tmux."""

import harness
import screens

COLUMNS = (40, 80, 120, 200)


class Screens(screens.Screens):
    def setUp(self):
        super().setUp()
        self.start_sim("--frozen")
        for topic in ("gyro", "odom", "power"):
            self.run_tool("publish", topic, "100ms")

    def open(self, columns, *arguments):
        super().open(columns, "--bus", "sim", *arguments)

    def test_listen(self):
        for columns in COLUMNS:
            self.open(columns, "listen", "--pretty", "-n", "6", "--no-color")
        for columns in COLUMNS:
            lines = self.ended(columns)
            self.fits(columns, lines)
            # A sample says all of its numbers, whole.
            text = " ".join(" ".join(lines).split())
            self.assertRegex(text, r" gyroscope x -?[\d.]+ y -?[\d.]+ z -?[\d.]+ deg/s ")
            self.assertRegex(text, r" odometry velocity\.x -?[\d.]+ m/s .* pose\.orientation -?[\d.]+ rad ")
            self.assertRegex(lines[-1], r"^END 0$")

    def test_help(self):
        for columns in COLUMNS:
            self.open(columns, "stats", "--help")
        words = [" ".join(self.ended(columns)).split() for columns in COLUMNS]
        for columns, found in zip(COLUMNS, words):
            self.fits(columns, self.screen(columns))
            self.assertEqual(found, words[-1])
        self.assertIn("--duration", words[0])

    def test_nothing_half_stays_of_a_table_after_ctrl_c(self):
        for columns in COLUMNS:
            self.open(columns, "stats", "--no-color")
        for columns in COLUMNS:
            harness.waiting.until(lambda: any(line.startswith("TOPIC") for line in self.screen(columns)), "a table")
            self.tmux("send-keys", "-t", f"of{columns}", "C-c")
        for columns in COLUMNS:
            lines = self.ended(columns)
            self.fits(columns, lines)
            screen = "\n".join(lines)
            self.assertEqual(lines[-1], "END 130", screen)
            self.assertEqual([line.split()[0] for line in lines if "TOPIC" in line], ["TOPIC"], screen)
            self.assertEqual(len([line for line in lines if line.startswith("sim: ")]), 1, screen)
            self.assertNotIn("^C", screen)
            self.assertEqual(sorted(line[:4] for line in lines if line[:4] in ("gyro", "odom", "powe")),
                             ["gyro", "odom", "powe"], screen)

    def test_nothing_half_stays_of_listen_after_ctrl_c(self):
        self.open(80, "listen", "gyro", "--no-color")
        harness.waiting.until(lambda: any("deg/s" in line for line in self.screen(80)), "a sample")
        self.tmux("send-keys", "-t", "of80", "C-c")
        lines = self.ended(80)
        self.assertNotIn("^C", "\n".join(lines))
        self.assertRegex(lines[-2], r"^\d+ frames?, \d+ samples?$")


if __name__ == "__main__":
    harness.main()
