"""A log that is longer than what is packed, or unpacked, at once."""

import os

from harness import Case, main


class Packed(Case):
    def test_a_long_log_comes_back_whole(self):
        chance, lines = 1, []  # hard to pack
        for n in range(40_000):
            chance = chance * 6364136223846793005 + 1442695040888963407 & 2**64 - 1
            lines.append(f"({1700000000 + n // 1000}.{n % 1000:03}000) can0 {chance >> 53:03X}#{chance:016X}\n")
        text = "".join(lines)
        path = os.path.join(self.folder, "long.log")
        with open(path, "w", encoding="ascii") as file:
            file.write(text)
        for ending in ("gz", "zst"):
            self.run_tool("convert", path, f"{path}.{ending}")
            out, err = self.run_tool("convert", f"{path}.{ending}", "-", "--to", "candump")
            self.assertTrue(out == text, ending)
            self.assertEqual(err, "40000 frames, candump to candump\n")
            self.assertLess(os.path.getsize(f"{path}.{ending}"), 0.6 * len(text))


if __name__ == "__main__":
    main()
