"""Whole outputs, word for word, of verbs that need no bus: those of one log, and of specs that are no robot's of ours.

With OCM_WRITE_GOLDEN=1 the files in golden/ are written again, to be read in review.
"""

import os

from harness import SOURCE, Case, main

CAR = ("--spec", os.path.join(SOURCE, "examples", "small_car.dbc"))
TRUCK = ("--spec", os.path.join(SOURCE, "examples", "truck.dbc"))
PROBE = ("--spec", os.path.join(SOURCE, "tests", "generator", "probe.json"))

# Each thing that a frame can be, once: requests, samples of one and of two frames, set points, wrong lengths, strangers.
ROBOT_LOG = """\
(1700000000.000000) can0 208#01F40100
(1700000000.010000) can0 605#00D20000
(1700000000.011000) can0 606#F0FFFFFF
(1700000000.012000) can0 607#01000000
(1700000000.020000) can0 608#010203040506
(1700000000.030000) can0 201#50C3000000000000
(1700000000.040000) can0 605#0000
(1700000000.050000) can0 605#R
(1700000000.060000) can0 7FF#DEAD
(1700000000.070000) can0 18FF1234#01
(1700000000.080000) can0 20000004#000D000000000000
(1700000000.090000) can1 123##1AABBCCDDEEFF001122334455
(1700000000.520000) can0 608#FFFFFFFFFFFF
(1700000001.523000) can0 208#02
(1700000002.020000) can0 608#000000000080
"""


def car_log():
    """20 rounds of 10 ms, one of which is late, and at the end a frame that is too short."""
    lines = []
    for i in range(20):
        at = 1700000000 + i / 100
        engine = bytes([i * 12, 0x1F, i * 10, 0x50 + i % 4, 2 * i, 60 + i, i % 4, i % 16 << 4])
        lines.append(f"({at + (0.002 if i == 7 else 0):.6f}) can0 100#{engine.hex().upper()}\n")
        if i % 2 == 0:
            lines.append(f"({at + 0.001:.6f}) can0 110#{bytes([i, 90 + i, i, 16]).hex().upper()}\n")
    return "".join(lines) + "(1700000000.300000) can0 120#0102\n"


CAR_LOG = car_log()

# The golden file's name, what is typed, what is read.
ROWS = [
    ("help_operator.txt", ("operator", "--help"), ""),
    ("list_car.txt", (*CAR, "list"), ""),
    ("list_truck.txt", (*TRUCK, "list"), ""),
    ("list_probe.txt", (*PROBE, "list"), ""),
    ("list_probe.jsonl", (*PROBE, "list", "--json"), ""),
    *((f"info_{topic.lower()}.txt", (*spec, "info", topic), "")
      for spec, topic in ((CAR, "Engine"), (CAR, "Battery"), (CAR, "LockCommand"), (TRUCK, "TSC1"), (PROBE, "depth"), (PROBE, "position"), (PROBE, "thrust"))),
    *((f"robot_decode_{kind}.txt", ("decode", f"--{kind}", "-"), ROBOT_LOG) for kind in ("pretty", "json", "csv", "raw")),
    *((f"car_decode_{kind}.txt", (*CAR, "decode", f"--{kind}", "-"), CAR_LOG) for kind in ("pretty", "json", "csv")),
    *((f"robot_stats{option}.txt", ("stats", "-", *filter(None, [option])), ROBOT_LOG) for option in ("", "--json", "--csv")),
    *((f"car_stats{option}.txt", (*CAR, "stats", "-", *filter(None, [option])), CAR_LOG) for option in ("", "--json", "--csv")),
    *((f"robot_{kind}.txt", ("convert", "-", "-", "--to", kind), ROBOT_LOG) for kind in ("candump", "candump-ns", "asc", "csv", "json")),
    ("car_plot.txt", (*CAR, "plot", "--script", "-", "Engine.Speed", "Engine.Torque", "Engine.Counter"), CAR_LOG),
    ("car_plot_pair.txt", (*CAR, "plot", "--script", "-", "Engine.Speed:Engine.Torque"), CAR_LOG),
    ("robot_replay.txt", ("replay", "-", "--dry-run", "--speed", "2"), ROBOT_LOG),
    ("run.txt", ("run", os.path.join(SOURCE, "examples", "standalone.script"), "--dry-run"), ""),
]


class Whole(Case):
    def test_outputs(self):
        self.environment["TZ"] = "UTC"
        for name, words, text in ROWS:
            out, err = self.run_tool(*words, stdin=text)
            path = os.path.join(SOURCE, "tests", "tool", "verbs", "golden", name)
            whole = out + (f"--- stderr\n{err}" if err else "")
            if os.environ.get("OCM_WRITE_GOLDEN"):
                with open(path, "w", encoding="utf-8") as file:
                    file.write(whole)
            with self.subTest(name):
                with open(path, encoding="utf-8") as file:
                    self.assertEqual(whole, file.read())


if __name__ == "__main__":
    main()
