"""An emulated board's CAN controller: what waits goes out by identifier, each level has its places."""

import harness


class Bus(harness.Case):
    def test_order(self):
        board = harness.Board("bus_test", harness.Parts(), "qemu_m3")
        self.addCleanup(board.end, code=0)
        board.say("t1230")
        board.wait(lambda: len(board.frames) >= 7, 5, "seven frames")
        board.say("t1240")
        heard = [f"{identifier:03X}" for _, identifier, _ in board.frames]
        self.assertEqual(heard, ["7F0", "4FF", "601", "7F1", "7EF", "7F2", "7F3"])


if __name__ == "__main__":
    harness.main()
