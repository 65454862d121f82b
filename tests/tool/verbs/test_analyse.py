"""amiroctl analyse: the figures of the literature, other people's files, and mistakes in them."""

import json
import os
import random
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

from harness import SOURCE, Case, main

BUS = "name,id,dlc,period_ns,deadline_ns,jitter_ns\n"
TASKS = "name,priority,C_ns,T_ns,D_ns,J_ns,B_ns\n"

# Three messages of 7 bytes at 125 kbit/s, 1 ms each: the third is late in its second release only.
# [Davis, Burns, Bril, Lukkien 2007, section 3.3]
DAVIS = BUS + "a,0x101,7,2500000,,\nb,0x102,7,3500000,3250000,0\nc,0x103,7,3500000,3250000,\n"

# What is printed, word for word; its figures are those of the paper.
DAVIS_LATE = """\
MESSAGE  ID            LENGTH    C      T       D  J    B      R   SLACK  VERDICT  LEAST T
a        0x101  7 B, 125 bits  1ms  2.5ms   2.5ms  -  1ms    2ms   500us  ok       2.504ms
b        0x102  7 B, 125 bits  1ms  3.5ms  3.25ms  -  1ms    3ms   250us  ok       4.008ms
c        0x103  7 B, 125 bits  1ms  3.5ms  3.25ms  -    -  3.5ms  -250us  MISSES    3.75ms

1 of 3 may miss its deadline: 97.14 % of the bus (125 kbit/s, generic lengths, exact test)
  c: misses its deadline by 250us: takes 1ms, 5ms for more urgent ones (3ms of that a); the 2nd of 2 releases in a row is the worst, its wait counted from the first
Any one of these would make all meet their deadlines:
  - a every 2.504ms instead of every 2.5ms
  - b every 4.008ms instead of every 3.5ms
  - c every 3.75ms instead of every 3.5ms
  - a bit rate of 250 kbit/s
  - all periods 1.002 times as long
LEAST T: the shortest period of that message, others as they are, with which all meet their deadlines.
"""
DAVIS_CSV = """\
name,id,cost_ns,period_ns,deadline_ns,jitter_ns,blocking_ns,interference_ns,response_ns,slack_ns,schedulable,why
a,0x101,1000000,2500000,2500000,0,1000000,0,2000000,500000,true,"ends 500us before its deadline: takes 1ms, waits 1ms for b, which is less urgent"
b,0x102,1000000,3500000,3250000,0,1000000,1000000,3000000,250000,true,"ends 250us before its deadline: takes 1ms, waits 1ms for c, which is less urgent, 1ms for more urgent ones (1ms of that a)"
c,0x103,1000000,3500000,3250000,0,0,5000000,3500000,-250000,false,"misses its deadline by 250us: takes 1ms, 5ms for more urgent ones (3ms of that a); the 2nd of 2 releases in a row is the worst, its wait counted from the first"
"""
DAVIS_IN_TIME = """\
MESSAGE  ID            LENGTH      C      T       D  J      B      R   SLACK  VERDICT   LEAST T
a        0x101  7 B, 125 bits  500us  2.5ms   2.5ms  -  500us    1ms   1.5ms  ok            1ms
b        0x102  7 B, 125 bits  500us  3.5ms  3.25ms  -  500us  1.5ms  1.75ms  ok       760.87us
c        0x103  7 B, 125 bits  500us  3.5ms  3.25ms  -      -  1.5ms  1.75ms  ok       760.87us

All meet their deadlines: 48.57 % of the bus (250 kbit/s, generic lengths, exact test)
  The tightest is b: ends 1.75ms before its deadline: takes 500us, waits 500us for c, which is less urgent, 500us for more urgent ones (500us of that a)
LEAST T: the shortest period of that message, others as they are, with which all meet their deadlines.
"""

# a has 12 + 2 * 10 + 2 * 10 = 52 of 50; 3 (2^(1/3) - 1) = 0.7798, 1.24 * 1.25 * 1.3333 = 2.0667.
LATE = TASKS + "a,1,12,50,,,\nb,2,10,40,,,\nc,3,10,30,,,\n"
LATE_TABLE = """\
TASK  PRIORITY     C     T     D  J  B     R  SLACK  VERDICT  LEAST T  MOST C
c            3  10ns  30ns  30ns  -  -  10ns   20ns  ok          32ns     9ns
b            2  10ns  40ns  40ns  -  -  20ns   20ns  ok          42ns     9ns
a            1  12ns  50ns  50ns  -  -  52ns   -2ns  MISSES      52ns    10ns

1 of 3 may miss its deadline: 82.33 % of the processor (fixed priorities, preemptive)
  a: misses its deadline by 2ns: takes 12ns, 40ns for more urgent ones (20ns of that c)
Any one of these would make all meet their deadlines:
  - c every 32ns instead of every 30ns
  - c in 9ns instead of 10ns
  - b every 42ns instead of every 40ns
  - b in 9ns instead of 10ns
  - a every 52ns instead of every 50ns
  - a in 10ns instead of 12ns
  - all costs at 90.00 %
LEAST T, MOST C: the shortest period and the greatest cost of that task, others as they are, with which all meet their deadlines.
Tests of the utilisation alone (sufficient, not necessary; R above is exact):
  Liu and Layland, sum of C/T: 0.8233, bound 0.7798: beyond the bound, which proves nothing: see the response times
  hyperbolic, product of C/T + 1: 2.0667, bound 2.0000: beyond the bound, which proves nothing: see the response times
"""
ROOMY = TASKS + "a,1,12000,500000,,100,\nb,2,10000,400000,,,50\nc,3,10,300000,,,\n"
ROOMY_TABLE = """\
TASK  PRIORITY     C      T      D      J     B        R     SLACK  VERDICT   LEAST T    MOST C
c            3  10ns  300us  300us      -     -     10ns  299.99us  ok           11ns     278us
b            2  10us  400us  400us      -  50ns  10.06us  389.94us  ok       10.251us  387.98us
a            1  12us  500us  500us  100ns     -  22.11us  477.89us  ok        22.11us  479.88us

All meet their deadlines: 4.90 % of the processor (fixed priorities, preemptive)
  The tightest is a: ends 477.89us before its deadline: takes 12us, comes 100ns late, 10.01us for more urgent ones (10us of that b)
There is room:
  - all costs could be 1816.52 %
LEAST T, MOST C: the shortest period and the greatest cost of that task, others as they are, with which all meet their deadlines.
Tests of the utilisation alone (sufficient, not necessary; R above is exact):
  Liu and Layland, sum of C/T: 0.0490, bound 0.7798: does not apply: jitter, blocking, or a deadline before the period
  hyperbolic, product of C/T + 1: 1.0496, bound 2.0000: does not apply: jitter, blocking, or a deadline before the period
"""
ROOMY_CSV = """\
name,priority,cost_ns,period_ns,deadline_ns,jitter_ns,blocking_ns,interference_ns,response_ns,slack_ns,schedulable,why
c,3,10,300000,300000,0,0,0,10,299990,true,ends 299.99us before its deadline: takes 10ns
b,2,10000,400000,400000,0,50,10,10060,389940,true,"ends 389.94us before its deadline: takes 10us, waits 50ns for less urgent ones, 10ns for more urgent ones (10ns of that c)"
a,1,12000,500000,500000,100,0,10010,22110,477890,true,"ends 477.89us before its deadline: takes 12us, comes 100ns late, 10.01us for more urgent ones (10us of that b)"
"""


class Analyse(Case):
    def file(self, text, name="set.csv"):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def bus(self, text, *options, code=0, name="set.csv"):
        out, _ = self.run_tool("analyse", "bus", self.file(text, name), "--json", *options, code=code)
        return json.loads(out)

    def tasks(self, text, *options, code=0):
        out, _ = self.run_tool("analyse", "tasks", self.file(text), "--json", *options, code=code)
        return json.loads(out)

    @staticmethod
    def column(rows, key):
        return {row["name"]: row[key] for row in rows}


class Bus(Analyse):
    def test_the_second_release_is_the_worst(self):
        found = self.bus(DAVIS, "--bitrate", "125k", code=1)
        self.assertEqual(list(found), ["utilisation", "messages", "left_out"])
        self.assertEqual(list(found["messages"][0]),
                         ["name", "response_ns", "deadline_ns", "schedulable", "instances_ns", "why", "id", "period_ns",
                          "sporadic", "bits", "data_bits"])
        self.assertEqual(self.column(found["messages"], "response_ns"), {"a": 2000000, "b": 3000000, "c": 3500000})
        self.assertEqual(self.column(found["messages"], "deadline_ns"), {"a": 2500000, "b": 3250000, "c": 3250000})
        self.assertEqual(self.column(found["messages"], "schedulable"), {"a": True, "b": True, "c": False})
        self.assertEqual(self.column(found["messages"], "instances_ns")["c"], [3000000, 3500000])
        self.assertAlmostEqual(found["utilisation"], 1 / 2.5 + 2 / 3.5, places=9)
        self.assertIn("250us", found["messages"][2]["why"])

    def test_a_release_in_the_first_bit_of_an_arbitration(self):
        """Frames of 55, 55 and 65 us: b waits for c and a, 120 us. A release of a after exactly that time wins once
        more, since it is there in the first bit; one bit later it does not. [Davis et al. 2007: tau_bit]"""
        for period, response in ((120000, 230000), (121000, 175000)):
            found = self.bus(BUS + f"a,1,0,{period},,\nb,2,0,1000000,,\nc,3,1,1000000,,\n", "--bitrate", "1M")
            self.assertEqual(found["messages"][1]["response_ns"], response)

    def test_sufficient(self):
        found = self.bus(DAVIS, "--bitrate", "125000", "--test", "sufficient", code=1)
        self.assertEqual(self.column(found["messages"], "response_ns")["c"], 7000000)

    def test_exact_lengths_are_shorter(self):
        generic = self.column(self.bus(DAVIS, "--bitrate", "125k", "--lengths", "generic", code=1)["messages"],
                              "response_ns")
        exact = self.column(self.bus(DAVIS, "--bitrate", "125k", "--lengths", "exact")["messages"], "response_ns")
        for name in "abc":
            self.assertLess(exact[name], generic[name])

    def test_errors_add_to_each_response(self):
        # One fault: 31 bits and the longest frame again. a: 1 ms + 1 ms + 156 bits of 8 us.
        found = self.bus(BUS + "a,1,7,100000000,,\nb,2,7,100000000,,\n", "--bitrate", "125k", "--errors",
                         "burst=1,every=1s")
        self.assertEqual(self.column(found["messages"], "response_ns"),
                         {"a": 2000000 + 156 * 8000, "b": 2000000 + 156 * 8000})

    def test_most_errors_at_once(self):
        path = self.file(BUS + "a,0x101,8,1000000000000,,\n")
        report = json.loads(self.run_tool("analyse", "bus", path, "--json", "--errors", "burst=1000000,every=1000s")[0])
        self.assertGreater(report["messages"][0]["response_ns"], 1000000 * 135 * 2000)
        for wrong in ("burst=1000001", "every=0ns", "burst=1,every=0s"):
            self.assertIn("--errors " + wrong, self.run_tool("analyse", "bus", path, "--errors", wrong, code=2)[1])

    def test_jitter_adds_to_its_own(self):
        found = self.bus(BUS + "a,1,7,100000000,,250000\nb,2,7,100000000,,\n", "--bitrate", "125k")
        self.assertEqual(self.column(found["messages"], "response_ns")["a"], 2250000)

    def test_of_a_long_busy_period_the_first_1000_releases_are_listed(self):
        """Frames of 135 us: each period of b makes up for 0.1 us of what c has blocked."""
        found = self.bus(BUS + "a,1,8,270000,,\nb,2,8,270100,1000000,\nc,3,8,1000000000,1000000000,\n", "--bitrate", "1M")
        listed = self.column(found["messages"], "instances_ns")["b"]
        self.assertEqual(len(listed), 1000)
        self.assertEqual(max(listed), found["messages"][1]["response_ns"])

    def test_overload_has_no_bound(self):
        found = self.bus(BUS + "a,1,8,150000,,\nb,2,8,150000,,\nc,3,8,1000000,,\n", "--bitrate", "1M", code=1)
        self.assertEqual(self.column(found["messages"], "response_ns"), {"a": 270000, "b": None, "c": None})
        self.assertEqual(self.column(found["messages"], "instances_ns")["c"], [])
        self.assertIn("180.00 %", found["messages"][1]["why"])
        self.assertAlmostEqual(found["utilisation"], 2 * 135 / 150 + .135)

    def test_identifiers_decide(self):
        # 0x40x is of 29 bits and shares its first eleven with 0: it loses to 0 and wins against 1.
        text = BUS + "low,2047,0,1000000,,\nwide,0x40x,0,1000000,,\nfirst,0,0,1000000,,\nbig,0x18FF0102,8,1000000,,\n"
        found = self.bus(text)
        self.assertEqual([m["name"] for m in found["messages"]], ["first", "wide", "big", "low"])
        # B of the last is none; 55 + 80 + 160 + 55 bits of 2 us.
        self.assertEqual(found["messages"][-1]["response_ns"], 2000 * (55 + 80 + 160 + 55))

    def test_identifiers_of_11_and_of_29_bits(self):
        rows = "base,2047,0\nwide,2048,0\nlast,0x1FFFFFFF,0\nmarked,5X,0\nhex,0X6x,0\n".replace("\n", ",10000000,,\n")
        self.assertEqual(self.column(self.bus(BUS + rows)["messages"], "id"),
                         {"base": "0x7FF", "wide": "0x00000800", "last": "0x1FFFFFFF", "marked": "0x00000005", "hex": "0x00000006"})

    def test_extremes(self):
        largest = 2**63 - 1
        found = self.bus(BUS + f"a,1,8,{largest},,\nb,2,8,{largest},1,{largest}\nc,3,8,{largest},,\n", code=1)
        self.assertEqual(self.column(found["messages"], "response_ns")["b"], None)
        full = BUS + "".join(f"m{i},{i},8,1000000000,,\n" for i in range(2048))
        found = self.bus(full, "--bitrate", "1M")
        self.assertEqual(len(found["messages"]), 2048)
        self.assertEqual(found["messages"][-1]["response_ns"], 2048 * 135000)

    def test_spreadsheets(self):
        text = "\ufeff" + 'id , name,period_ns,dlc\r\n# a remark\r\n\r\n0x101,"a, the ""first""",1000000,8\r\n'
        self.assertEqual(self.bus(text)["messages"][0]["name"], 'a, the "first"')

    def test_table_and_csv(self):
        path = self.file(DAVIS)
        for options, whole, code in ((("--bitrate", "125k"), DAVIS_LATE, 1), (("--bitrate", "125k", "--csv"), DAVIS_CSV, 1),
                                     (("--bitrate", "250k"), DAVIS_IN_TIME, 0)):
            self.assertEqual(self.run_tool("analyse", "bus", path, *options, code=code)[0], whole)

    def test_the_shortest_periods_are_the_edge(self):
        """What the table says of a period holds, and one nanosecond less does not."""
        out, _ = self.run_tool("analyse", "bus", self.file(DAVIS), "--bitrate", "125k", code=1)
        change = next(line for line in out.splitlines() if line.startswith("  - a every"))
        self.assertTrue(change.split()[3].endswith("ms"), change)
        edge = round(float(change.split()[3][:-2]) * 1e6)
        self.assertGreater(edge, 2500000)
        self.bus(DAVIS.replace("a,0x101,7,2500000", f"a,0x101,7,{edge}"), "--bitrate", "125k")
        self.bus(DAVIS.replace("a,0x101,7,2500000", f"a,0x101,7,{edge - 1}"), "--bitrate", "125k", code=1)

    def test_the_usual_bit_rates(self):
        """A frame of 135 bits every 140 bits is in time at one of them, and not at the one before."""
        usual = ("5 kbit/s", "10 kbit/s", "20 kbit/s", "50 kbit/s", "125 kbit/s", "250 kbit/s", "500 kbit/s", "800 kbit/s", "1 Mbit/s")
        for slower, faster in zip(usual, usual[1:]):
            rate = faster.replace(" kbit/s", "k").replace(" Mbit/s", "M")
            period = 140 * 10 ** 9 // (int(rate[:-1]) * (1000 if rate[-1] == "k" else 10 ** 6))
            path = self.file(BUS + f"a,0x101,8,{period}\n")
            out, _ = self.run_tool("analyse", "bus", path, "--bitrate", slower.replace(" kbit/s", "k"), code=1)
            self.assertIn(f"a bit rate of {faster}", out)
            out, _ = self.run_tool("analyse", "bus", path, "--bitrate", "1M")
            self.assertEqual(f"{faster} would do, too" in out, faster != "1 Mbit/s", out)

    def test_how_long_a_file_may_be(self):
        """What begins another piece of 64 KiB counts, be it a single byte; and a byte beyond 16 MiB is too much."""
        self.assertIn("set.csv:1: unknown column 'x'", self.run_tool("analyse", "bus", self.file("x"), code=2)[1])
        text = BUS + "a,1,8,1000000,,\n#"
        text += "x" * (2**24 - len(text))
        self.assertEqual(len(self.bus(text)["messages"]), 1)
        self.assertIn("set.csv is larger than 16 MiB", self.run_tool("analyse", "bus", self.file(text + "x"), code=1)[1])

    def test_another_order(self):
        # Deadline monotonic order is not optimal. Here from the top: 125, 95 and 125 bits do not fit as a, c, b.
        text = BUS + "a,1,7,2240000,2200000,\nb,2,7,2880000,2760000,\nc,3,4,4400000,3400000,\n"
        out, _ = self.run_tool("analyse", "bus", self.file(text), "--bitrate", "125k", code=1)
        self.assertIn("identifiers in this order: a, c, b", out)
        out = self.bus(text.replace("b,2", "b,4"), "--bitrate", "125k")
        self.assertEqual(self.column(out["messages"], "response_ns"), {"a": 2000000, "b": 2760000, "c": 2760000})

    NODES = BUS.strip() + ",node,offset_ns\n"

    def test_fifo(self):
        """a waits for whatever is queued before it in its node, as if it were as urgent as c. [Davis et al. 2011]"""
        text = (self.NODES + "a,1,0,10000000,,,left,\nb,2,0,10000000,,,right,\nc,3,0,10000000,,,left,\n")
        plain = self.column(self.bus(text, "--bitrate", "1M")["messages"], "response_ns")
        self.assertEqual(plain, {"a": 110000, "b": 165000, "c": 165000})
        found = self.bus(text, "--bitrate", "1M", "--queue", "left=fifo")
        # a: b, c and itself; b: c, and a which c's queue can hold up; the order of arbitration stays.
        self.assertEqual(self.column(found["messages"], "response_ns"), {"a": 165000, "b": 165000, "c": 165000})
        self.assertEqual(found["queues"], [{"node": "left", "frames": 2}])
        out, _ = self.run_tool("analyse", "bus", self.file(text), "--bitrate", "1M", "--queue", "left=fifo")
        self.assertIn("left has 2 frames waiting", out)

    def test_mailboxes(self):
        """One mailbox: a waits for c, which is in it and is held up by b."""
        text = self.NODES + "a,1,0,10000000,,,left,\nb,2,0,10000000,,,right,\nc,3,0,10000000,,,left,\n"
        one = self.bus(text, "--bitrate", "1M", "--queue", "left=mailboxes:1")
        self.assertEqual(self.column(one["messages"], "response_ns")["a"], 165000)
        two = self.bus(text, "--bitrate", "1M", "--queue", "left=mailboxes:2")
        self.assertEqual(self.column(two["messages"], "response_ns")["a"], 110000)

    def test_offsets(self):
        """Two of one clock, half a period apart, never delay a third one both; of two clocks they may."""
        text = self.NODES + "a,1,0,1000000,,,left,\nb,2,0,1000000,,,{},500000\nc,3,0,1000000,,,right,\n"
        self.assertEqual(self.bus(text.format("left"), "--bitrate", "1M")["messages"][2]["response_ns"], 110000)
        self.assertEqual(self.bus(text.format("other"), "--bitrate", "1M")["messages"][2]["response_ns"], 165000)
        out, _ = self.run_tool("analyse", "bus", self.file(text.format("left")), "--bitrate", "1M")
        self.assertIn("with offsets", out)

    def test_an_offset_beyond_63_bits_is_left_out(self):
        """J and the offset are 9.5e18 ns together, for which there is no place in a pattern. Without the offset there is a bound: J and C."""
        text = self.NODES + "a,1,8,2200000000000000000,,8000000000000000000,left,1500000000000000000\n"
        found = self.bus(text, "--bitrate", "500k", code=1)
        self.assertEqual(found["messages"][0]["response_ns"], 8_000_000_000_000_270_000)
        self.assertEqual(found["messages"][0]["instances_ns"], [8_000_000_000_000_270_000])

    def test_most_clocks_of_offsets(self):
        def text(count):
            return self.NODES + "".join(f"m{i},{i},0,1000000000,,,n{i},{5 if i == 1 else 0}\n" for i in range(1, count + 1))

        self.assertIn("with offsets", self.run_tool("analyse", "bus", self.file(text(64)))[0])
        out, err = self.run_tool("analyse", "bus", self.file(text(65)), code=2)
        self.assertEqual(out, "")
        self.assertIn("offsets by more than 64 clocks", err)
        self.assertIn("name the nodes, or leave out the offsets", err)

    def test_a_queue_without_a_bound(self):
        text = self.NODES + "a,1,8,150000,,,left,\nb,2,8,150000,,,left,\n"
        found = self.bus(text, "--bitrate", "1M", "--queue", "left=fifo", code=1)
        self.assertEqual(found["queues"], [{"node": "left", "frames": None}])
        out, _ = self.run_tool("analyse", "bus", self.file(text), "--bitrate", "1M", "--queue", "left=fifo", code=1)
        self.assertIn("There is no bound on how many frames of left wait.\n", out)

    def test_identifiers_given_anew(self):
        """The set of test_another_order: a, c, b do, and nothing else."""
        text = BUS + "a,1,7,2240000,2200000,\nb,2,7,2880000,2760000,\nc,3,4,4400000,3400000,\n"
        found = self.bus(text, "--bitrate", "125k", "--assign", "identifiers")
        self.assertEqual(self.column(found["messages"], "id"), {"a": "0x001", "c": "0x002", "b": "0x003"})
        none = text.replace("3400000", "1500000")
        out, _ = self.run_tool("analyse", "bus", self.file(none), "--bitrate", "125k", "--assign", "identifiers", code=1)
        self.assertIn("No order of identifiers", out)

    def test_options_that_mean_nothing(self):
        nodes = self.file(self.NODES + "a,1,0,1000000,,,left,\n")
        for options, word in ((["--queue", "left"], "NODE=fifo"), (["--queue", "left=mailboxes:0"], "mailboxes:0"),
                              (["--queue", "top=fifo"], "one of left"), (["--assign", "priorities"], "identifiers"),
                              (["--queue", "left=fifo", "--test", "sufficient"], "--test"),
                              (["--assign", "identifiers", "--lengths", "exact"], "generic")):
            _, err = self.run_tool("analyse", "bus", nodes, *options, code=2)
            self.assertIn(word, err)
        _, err = self.run_tool("analyse", "bus", self.file(self.NODES + "a,1,0,1000000,,,,5\n"), code=2)
        self.assertIn("no node", err)

    def test_mistakes_name_the_line(self):
        for text, *words in (
                ("", "set.csv", "header"),
                (BUS, "set.csv:1"),
                ("name,id,dlc\na,1,8\n", "set.csv:1", "period_ns"),
                (BUS + "a,1,8,1000\n\nb,zwei,8,1000\n", "set.csv:4", "'zwei'"),
                (BUS + "a,0x20000000,8,1000\n", "set.csv:2", "29 bits"),
                (BUS + "a,99999999999999999999,8,1000\n", "set.csv:2", "has more than 29 bits"),
                (BUS + "a,1,9,1000\n", "set.csv:2", "12, 16"),
                (BUS.strip() + ",fd\na,1,16,1000,,,no\n", "set.csv:2", "above 8"),
                (BUS.strip() + ",fd\na,1,8,1000,,,slow\n", "set.csv:2", "'slow'"),
                (BUS + "a,1,8,0\n", "set.csv:2", "period_ns '0'"),
                (BUS + "a,1,8,-5\n", "set.csv:2", "'-5'"),
                (BUS + "a,1,8,1e6\n", "set.csv:2", "'1e6'"),
                (BUS + "a,1,8,99999999999999999999\n", "set.csv:2", "63 bits"),
                (BUS + "a,1,8,1000,0\n", "set.csv:2", "deadline_ns '0'"),
                (BUS + "a,1,8,1000,,-1\n", "set.csv:2", "jitter_ns '-1'"),
                (BUS + "a,1,8,1000\nb,0x1,8,1000\n", "set.csv:3", "'a' in line 2"),
                (BUS + "a,1,8,1000,1,1,1\n", "set.csv:2", "7 cells"),
                (BUS.replace("dlc", "DLC") + "a,1,8,1000\n", "set.csv:1", "'DLC'")):
            with self.subTest(text):
                out, err = self.run_tool("analyse", "bus", self.file(text), code=2)
                self.assertEqual(out, "")
                for word in words:
                    self.assertIn(word, err)
        self.assertIn("1 error, nothing", self.run_tool("analyse", "bus", self.file(BUS + "a,1,8,0\n"), code=2)[1])
        many = self.run_tool("analyse", "bus", self.file(BUS + "a,1,8,0\n" * 22), code=2)[1]
        self.assertEqual(many.count("period_ns '0'"), 20)
        self.assertIn("\nand 2 more\n", many)
        self.assertIn("22 errors, nothing", many)
        self.assertNotIn("more\n", self.run_tool("analyse", "bus", self.file(BUS + "a,1,8,0\n" * 20), code=2)[1])
        least = self.run_tool("analyse", "bus", self.file(BUS + "a,1,0,1000000,1,0\n"), "--json", code=1)[0]  # late, and no mistake
        self.assertIn('"deadline_ns":1,', least.replace(" ", ""))
        _, err = self.run_tool("analyse", "bus", os.path.join(self.folder, "none.csv"), code=1)
        self.assertIn("none.csv", err)
        path = self.file(DAVIS)
        for options in (["--bitrate", "0"], ["--bitrate", "2M"], ["--bitrate", "fast"], ["--errors", "some"],
                        ["--errors", "burst=0,every=1s"], ["--data-bitrate", "17M"],
                        ["--bitrate", "500k", "--data-bitrate", "250k"], ["--test", "rough"], ["--json", "--csv"]):
            self.run_tool("analyse", "bus", path, *options, code=2)
        self.run_tool("analyse", code=2)


class Tables(Analyse):
    def test_which_columns_a_set_needs(self):
        self.file(TASKS + "a,1,10,100,,,\n", "cpu.csv")
        for verb, needed, others in (
                ("bus", {"name": "a", "id": "1", "dlc": "8", "period_ns": "10000000"},
                 {"deadline_ns": "10000000", "jitter_ns": "0", "node": "left", "offset_ns": "0", "fd": "no"}),
                ("tasks", {"name": "a", "priority": "1", "C_ns": "10", "T_ns": "100"}, {"D_ns": "100", "J_ns": "0", "B_ns": "0"}),
                ("chain", {"hop": "a", "set": "cpu.csv", "activation": "sampled"}, {"response_ns": "", "best_ns": "0", "period_ns": ""})):
            for column in needed | others:
                cells = {name: cell for name, cell in (needed | others).items() if name != column}
                path = self.file(",".join(cells) + "\n" + ",".join(cells.values()) + "\n")
                with self.subTest(verb=verb, column=column):
                    _, err = self.run_tool("analyse", verb, path, code=2 if column in needed else 0)
                    self.assertEqual(f"set.csv:1: no column '{column}'\n" in err, column in needed, err)

    def test_the_largest_sets(self):
        def messages(count):
            return BUS + "".join(f"m{i},{i}x,0,1000000000,,\n" for i in range(1, count + 1))

        self.assertEqual(self.bus(messages(4096), "--bitrate", "1M")["messages"][-1]["response_ns"], 4096 * 80_000)
        _, err = self.run_tool("analyse", "bus", self.file(messages(4097)), code=2)
        self.assertIn("set.csv: 4097 messages\n    at most 4096\n", err)
        tasks = TASKS + "".join(f"t{i},{i},1,1000000000,,,\n" for i in range(4097))
        _, err = self.run_tool("analyse", "tasks", self.file(tasks), code=2)
        self.assertIn("set.csv: 4097 tasks\n    at most 4096\n", err)

    def test_up_to_which_size_a_set_is_looked_at_for_room(self):
        for verb, most, header, row in (("bus", 128, BUS, "m{0},{0},0,1000000000,16000000,\n"), ("tasks", 40, TASKS, "t{0},{0},1000,1000000000,45000,,\n")):
            for count in (most, most + 1):
                path = self.file(header + "".join(row.format(i) for i in range(1, count + 1)))
                out, _ = self.run_tool("analyse", verb, path)
                self.assertEqual("LEAST T" in out, count == most, out)


class Robot(Analyse):
    def names(self, *options, code=0):
        out, _ = self.run_tool("analyse", "bus", "--json", *options, code=code)
        return json.loads(out)

    def test_as_it_is_sent_by_default(self):
        found = self.names()
        names = self.column(found["messages"], "schedulable")
        self.assertIn("odometry.velocity", names)
        self.assertIn("gyroscope.x" if "gyroscope.x" in names else "gyroscope", names)
        self.assertTrue(all(names.values()))

    def test_everything_at_900_us_does_not_fit(self):
        topics = [t for t in self.objects(self.run_tool("list", "--json")[0]) if t["kind"] == "sensor"]
        rates = [f"{t['topic']}=900us" for t in topics]
        found = self.names("--rates", *rates, "--bitrate", "500k", code=1)
        self.assertGreater(found["utilisation"], 3)
        out, _ = self.run_tool("analyse", "bus", "--rates", *rates, code=1)
        self.assertIn("all periods", out)

    def test_rates_from_a_file(self):
        path = self.file("# what runs\ngyro=10ms@urgent\nring=off\n", "rates.txt")
        found = self.names("--rates", path)
        by_name = {m["name"]: m for m in found["messages"]}
        self.assertTrue(any(m["deadline_ns"] == 10000000 for name, m in by_name.items() if "gyro" in name))
        self.assertFalse(any(name.startswith("proximity_ring") for name in by_name))
        for text, *words in (("gyr=1s", "rates.txt:1", "'gyr'"), ("\ngyro=soon", "rates.txt:2", "soon"),
                             ("gyro", "rates.txt:1"), ("gyro=1s@top", "top")):
            _, err = self.run_tool("analyse", "bus", "--rates", self.file(text, "rates.txt"), code=2)
            for word in words:
                self.assertIn(word, err)

    def test_priorities_given_anew(self):
        """The ring every 4 ms is late at low, and so goes up; nothing goes higher than it must."""
        rates = ["ring=4ms@low", "odometry=off"]
        before = self.names("--rates", *rates, code=1)
        found = self.names("--rates", *rates, "--assign", "priorities")
        self.assertTrue(all(m["schedulable"] for m in found["messages"]))
        level = {m["name"]: int(m["id"], 16) >> 8 & 3 for m in found["messages"]}
        self.assertEqual((level["gyroscope"], level["proximity_ring.sensor_8"]), (3, 2))
        self.assertEqual(len(before["messages"]), len(found["messages"]))
        fast = [f"{t}=1ms" for t in ("ring", "gyroscope", "accelerometer", "floor_proximity", "magnetometer")]
        out, _ = self.run_tool("analyse", "bus", "--rates", *fast, "--assign", "priorities", code=1)
        self.assertIn("No choice of priorities", out)

    def test_a_board_with_a_fifo(self):
        plain = self.column(self.names()["messages"], "response_ns")
        fifo = self.names("--queue", "di_wheel_drive=fifo")
        self.assertGreater(self.column(fifo["messages"], "response_ns")["odometry.pose"], plain["odometry.pose"])
        self.assertGreater(fifo["queues"][0]["frames"], 8)

    def test_british_and_american(self):
        self.assertEqual(self.run_tool("analyze", "bus")[0], self.run_tool("analyse", "bus")[0])


class Tasks(Analyse):
    def test_which_release_of_many_is_the_worst(self):
        """Of sets chosen at random; the recurrence of the busy period was solved for them by hand-written Python."""
        for urgent, period, cost, own, worst, which in ((127, 239, 111, 237, 348, "111th of 112"), (247, 386, 36, 100, 342, "112th of 139"),
                                                        (203, 325, 149, 397, 590, "113th of 122"), (164, 286, 121, 284, 405, "121st of 122")):
            low = self.tasks(TASKS + f"a,2,{urgent},{period},,,\nb,1,{cost},{own},9000,,\n")["tasks"][1]
            self.assertEqual(low["response_ns"], worst)
            self.assertIn(f"the {which} releases in a row is the worst", low["why"])

    def responses(self, rows, code=0, *options):
        text = TASKS + "".join(f"{','.join(str(cell) for cell in row)}\n" for row in rows)
        found = self.tasks(text, *options, code=code)
        self.assertEqual(list(found), ["utilisation", "tasks", "utilisation_tests"])
        return self.column(found["tasks"], "response_ns"), found

    def test_text_books(self):
        found, _ = self.responses([("a", 1, 12, 50), ("b", 2, 10, 40), ("c", 3, 10, 30)], 1)
        self.assertEqual(found, {"a": 52, "b": 20, "c": 10})
        found, whole = self.responses([("a", 1, 40, 80), ("b", 2, 10, 40), ("c", 3, 5, 20)])
        self.assertEqual(found, {"a": 80, "b": 15, "c": 5})
        self.assertEqual(whole["utilisation"], 1)
        found, _ = self.responses([("a", 4, 3, 20, 5), ("b", 3, 3, 15, 7), ("c", 2, 4, 10, 10), ("d", 1, 3, 20, 20)])
        self.assertEqual(found, {"a": 3, "b": 6, "c": 10, "d": 20})

        found, _ = self.responses([("a", 1, 32, 80), ("b", 2, 5, 40), ("c", 3, 4, 16)])
        self.assertEqual(found, {"a": 58, "b": 9, "c": 4})
        found, _ = self.responses([("a", 3, 3, 7), ("b", 2, 3, 12), ("c", 1, 5, 20)])
        self.assertEqual(found, {"a": 3, "b": 6, "c": 20})

    def test_all_releases_of_the_busy_period(self):
        found, whole = self.responses([("a", 2, 26, 70), ("b", 1, 62, 100, 118)])
        self.assertEqual(found["b"], 118)
        self.assertEqual(self.column(whole["tasks"], "instances_ns")["b"], [114, 102, 116, 104, 118, 106, 94])

    def test_a_task_without_a_bound_has_no_responses(self):
        found, whole = self.responses([("a", 2, 60, 100), ("b", 1, 50, 100)], 1)  # 110 %
        self.assertEqual(found, {"a": 60, "b": None})
        self.assertEqual(self.column(whole["tasks"], "instances_ns"), {"a": [60], "b": []})

    def test_the_robots(self):
        avr = [("A", 15, 1700), ("B", 15, 1640), ("C", 103, 2960), ("D", 30, 1700000), ("E", 20, 43000),
               ("F", 103, 140000), ("G", 30, 255000), ("H", 200, 7300000)]
        rows = [(name, 8 - i, cost, period * 1000000) for i, (name, period, cost) in enumerate(avr)]
        found, whole = self.responses(rows)
        self.assertEqual(list(found.values()),
                         [1700, 3340, 6300, 1706300, 1749300, 1889300, 2144300, 9444300])
        self.assertAlmostEqual(whole["utilisation"], .1054, places=4)
        arduino = [("A", .8, 610), ("B", .8, 610), ("C", 103, 3400), ("D", 30, 1660000), ("E", 20, 41000),
                   ("F", 103, 130000), ("G", 30, 187000), ("H", 200, 5880000)]
        rows = [(name, 8 - i, cost, int(period * 1000000)) for i, (name, period, cost) in enumerate(arduino)]
        found, whole = self.responses(rows)
        self.assertEqual(list(found.values()), [610, 1220, 4620, 1667060, 1708060, 1838060, 2025060, 7913600])
        self.assertAlmostEqual(whole["utilisation"], .0958, places=4)

    def test_sets_that_have_a_name(self):
        """The thesis's robots, as spec/tasks.json has them; its table 9.2 with its errors mended."""
        report = json.loads(self.run_tool("analyse", "tasks", "thesis_avr", "--json")[0])
        self.assertEqual([task["response_ns"] for task in report["tasks"]],
                         [1_700, 3_340, 6_300, 1_706_300, 1_749_300, 1_889_300, 2_144_300, 9_444_300])
        report = json.loads(self.run_tool("analyse", "tasks", "thesis_arduino", "--json")[0])
        self.assertEqual([task["response_ns"] for task in report["tasks"]],
                         [610, 1_220, 4_620, 1_667_060, 1_708_060, 1_838_060, 2_025_060, 7_913_600])
        for board in ("di_wheel_drive", "power_management", "light_ring"):
            report = json.loads(self.run_tool("analyse", "tasks", board, "--json")[0])
            self.assertTrue(all(task["schedulable"] for task in report["tasks"]))
        _, err = self.run_tool("analyse", "tasks", "di_wheel_driver", code=1)
        self.assertIn("di_wheel_driver", err)

    def test_priorities_of_a_named_set(self):
        """A greater number is more urgent, as in a CSV file; none is below 1."""
        report = json.loads(self.run_tool("analyse", "tasks", "thesis_avr", "--json")[0])
        self.assertEqual([task["priority"] for task in report["tasks"]], ["8", "7", "6", "5", "4", "3", "2", "1"])
        report = json.loads(self.run_tool("analyse", "tasks", "di_wheel_drive", "--json")[0])
        self.assertEqual([task["priority"] for task in report["tasks"]], list("432222221111"))

    def test_tasks_of_one_priority_stay_in_their_order(self):
        with open(os.path.join(SOURCE, "spec", "tasks.json"), encoding="utf-8") as file:
            sets = json.load(file)["sets"]
        for each in sets:
            report = json.loads(self.run_tool("analyse", "tasks", each["name"], "--json")[0])
            by_level = sorted(each["tasks"], key=lambda task: task["level"])
            self.assertEqual([task["name"] for task in report["tasks"]], [task["name"] for task in by_level])

    def test_tests_of_the_utilisation(self):
        """[Liu, Layland 1973] n(2^(1/n) - 1), 0.8284 of two tasks; [Bini, Buttazzo, Buttazzo 2003] product of U + 1."""
        def tests(rows, code, *options):
            _, whole = self.responses(rows, code, *options)
            return {test["name"]: test for test in whole["utilisation_tests"]}

        both = tests([("a", 2, 40, 100), ("b", 1, 80, 200)], 0)
        self.assertAlmostEqual(both["liu_layland"]["bound"], 2 * (2 ** .5 - 1), places=5)
        self.assertAlmostEqual(both["liu_layland"]["value"], .8)
        self.assertTrue(both["liu_layland"]["proven"])
        one = tests([("a", 2, 60, 100), ("b", 1, 50, 200)], 0)  # 0.85; 1.6 * 1.25 = 2
        self.assertEqual([one[name]["proven"] for name in ("liu_layland", "hyperbolic")], [False, True])
        self.assertAlmostEqual(one["hyperbolic"]["value"], 2)
        for options in (("--context-switch", "1ns"), ("--lock", "1ns"), ("--interrupt", "1ns"), ("--tick", "50ns")):
            for test in tests([("a", 2, 10, 100), ("b", 1, 20, 200)], 0, *options).values():
                self.assertFalse(test["proven"])
                self.assertIn("does not apply", test["verdict"])
        out, _ = self.run_tool("analyse", "tasks", "thesis_avr")
        self.assertIn("Liu and Layland, sum of C/T: 0.1054, bound 0.7241: does not apply: a task of a shorter period", out)
        self.assertIn("hyperbolic, product of C/T + 1: 1.1", out)
        self.assertNotIn("utilisation_tests", self.run_tool("analyse", "bus", "--json")[0])

    def test_blocking_and_jitter(self):
        found, _ = self.responses([("a", 2, 10, 100, "", 5, 7), ("b", 1, 20, 200, "", "", "")])
        self.assertEqual(found, {"a": 10 + 5 + 7, "b": 30})

    def test_equal_priorities_delay_each_other(self):
        found, _ = self.responses([("a", 1, 10, 100), ("b", 1, 20, 100)])
        self.assertEqual(found, {"a": 30, "b": 30})

    def test_context_switches(self):
        found, _ = self.responses([("a", 1, 10, 100)], 0, "--context-switch", "1ns")
        self.assertEqual(found, {"a": 12})

    def test_what_the_system_takes(self):
        """Tasks of 10 and 20 of 100 and 200 ns, a tick of 1 each 50, 2 an interrupt, 3 with interrupts off."""
        rows = [("a", 2, 10, 100), ("b", 1, 20, 200)]
        one = self.responses(rows, 0, "--tick", "50ns", "--tick-cost", "1ns")[0]
        self.assertEqual(one, {"a": 11, "b": 31})
        self.assertEqual(self.responses(rows, 0, "--interrupt", "2ns")[0], {"a": 14, "b": 34})
        self.assertEqual(self.responses(rows, 0, "--lock", "3ns")[0], {"a": 13, "b": 33})
        self.assertEqual(self.responses(rows, 0, "--tick", "50ns", "--released-by-tick")[0], {"a": 60, "b": 80})
        path = self.file(TASKS + "a,1,10,100,,,\n")
        self.run_tool("analyse", "tasks", path, "--tick-cost", "1ns", code=2)
        self.run_tool("analyse", "tasks", path, "--tick", "0s", "--tick-cost", "1ns", code=2)
        out, _ = self.run_tool("analyse", "tasks", path, "--lock", "3ns", "--interrupt", "2ns")
        self.assertIn("interrupts off for 3ns", out)

    def test_whether_the_tick_releases_is_said(self):
        path = self.file(TASKS + "a,1,10,100,,,\n")
        for options, said in (((), ")"), (("--released-by-tick",), " that releases)")):
            out, _ = self.run_tool("analyse", "tasks", path, "--tick", "50ns", "--tick-cost", "1ns", *options)
            self.assertIn("(fixed priorities, preemptive, a tick of 1ns every 50ns" + said, out)

    def test_overload(self):
        found, whole = self.responses([("a", 2, 60, 100), ("b", 1, 41, 100)], 1)
        self.assertEqual(found, {"a": 60, "b": None})
        self.assertEqual(self.column(whole["tasks"], "schedulable"), {"a": True, "b": False})
        self.assertIn("101.00 %", whole["tasks"][1]["why"])

    def test_an_overload_by_tasks_of_one_priority(self):
        found, whole = self.responses([("a", 1, 60, 100), ("b", 1, 50, 100)], 1)
        self.assertEqual(found, {"a": None, "b": None})
        for task in whole["tasks"]:
            self.assertIn("ask for 110.00 % of the processor", task["why"])

    def test_table_says_what_to_change(self):
        self.assertEqual(self.run_tool("analyse", "tasks", self.file(LATE), code=1)[0], LATE_TABLE)
        path = self.file(ROOMY)
        self.assertEqual(self.run_tool("analyse", "tasks", path)[0], ROOMY_TABLE)
        self.assertEqual(self.run_tool("analyse", "tasks", path, "--csv")[0], ROOMY_CSV)

    def test_mistakes(self):
        for text, *words in ((TASKS + "a,1,0,10\n", "set.csv:2", "C_ns '0'"), (TASKS + "a,,1,10\n", "no priority"),
                             (TASKS + "a,1,1,0\n", "T_ns '0'"), (TASKS + "a,1,1,10,0\n", "D_ns '0'"), (TASKS + "a,1,1,10,,-1\n", "J_ns '-1'"),
                             (TASKS + "a,1,1,10,,,-1\n", "B_ns '-1'"), ("name,C_ns\n", "T_ns")):
            out, err = self.run_tool("analyse", "tasks", self.file(text), code=2)
            self.assertEqual(out, "")
            for word in words:
                self.assertIn(word, err)


    def test_the_least_of_each(self):
        rows = self.tasks(TASKS + "a,-5,1,1,1,0,0\n")["tasks"]
        self.assertEqual(self.column(rows, "response_ns"), {"a": 1})


class Chain(Analyse):
    HOPS = "hop,set,activation,response_ns,best_ns,period_ns\n"

    def chain(self, text, *options, code=0):
        out, _ = self.run_tool("analyse", "chain", self.file(text, "chain.csv"), "--json", *options, code=code)
        return json.loads(out)

    def test_hops_add_up(self):
        """From the sensor to the motor: R, + R of the frame with the jitter of the task, + T + R where one samples."""
        self.file(TASKS + "read,2,1000,1000000,,,\nother,1,500,1000000,,,\nact,3,2000,2000000,,,\n", "cpu.csv")
        self.file(BUS + "pose,1,7,1000000000,,\nset,2,7,1000000000,,\n", "bus.csv")
        hops = (self.HOPS + "read,cpu.csv,sampled\npose,bus.csv,triggered\nplan,,sampled,5000000,,10000000\n"
                "set,bus.csv,triggered\nact,cpu.csv,sampled\n")
        found = self.chain(hops, "--bitrate", "125k", "--deadline", "1s")
        # read: after act, 3000. pose: 1 ms and 1 ms of set. plan: 10 + 5 ms. set: 2 ms. act: 2 ms and 2000.
        until = [3000, 2003000, 17003000, 19003000, 21005000]
        self.assertEqual([hop["until_ns"] for hop in found["hops"]], until)
        self.assertEqual(found["latency_ns"], until[-1])
        self.assertEqual(found["age_ns"], until[-1] + 1000000)
        self.assertTrue(found["schedulable"])
        self.assertIn("plan takes the longest", found["why"])
        self.chain(hops, "--bitrate", "125k", "--deadline", "22ms", code=1)
        out, _ = self.run_tool("analyse", "chain", self.file(hops, "chain.csv"), "--bitrate", "125k")
        self.assertIn("22.005ms at most", out)
        out, _ = self.run_tool("analyse", "chain", self.file(hops, "chain.csv"), "--bitrate", "125k", "--deadline", "22ms", code=1)
        self.assertEqual(out, """\
HOP   SET      ACTIVATION        JITTER         WAITS      RESPONDS         UNTIL
read  cpu.csv  sampled               0s            0s           3us           3us
pose  bus.csv  triggered            3us            0s           2ms       2.003ms
plan  -        sampled               0s          10ms           5ms      17.003ms
set   bus.csv  triggered            5ms            0s           2ms      19.003ms
act   cpu.csv  sampled               0s           2ms           2us      21.005ms

From the sensor's release to the end of the last hop: 0s to 21.005ms. From an event to the end of the reaction: 22.005ms at most.
  5us after its deadline; plan takes the longest: 15ms, 10ms of it until it looks
""")
        out, _ = self.run_tool("analyse", "chain", self.file(hops, "chain.csv"), "--bitrate", "125k", "--csv")
        self.assertEqual(out, """\
hop,activation,waits_ns,responds_ns,until_ns
read,sampled,0,3000,3000
pose,triggered,0,2000000,2003000
plan,sampled,10000000,5000000,17003000
set,triggered,0,2000000,19003000
act,sampled,2000000,2000,21005000
""")

    def test_a_slowest_hop_that_waits_for_nothing(self):
        self.file(TASKS + "read,2,1000,1000000,,,\n", "cpu.csv")
        self.file(BUS + "pose,1,7,1000000000,,\n", "bus.csv")
        found = self.chain(self.HOPS + "read,cpu.csv,sampled\npose,bus.csv,triggered\n", "--bitrate", "125k")
        self.assertEqual(found["why"], "pose takes the longest: 1ms")

    def test_all_that_a_program_reads(self):
        hops = self.HOPS + "sense,,sampled,300000,100000,5000000\nact,,triggered,200000,50000,\n"
        whole = {"latency_ns": 500_000, "shortest_ns": 150_000, "age_ns": 5_500_000, "deadline_ns": None, "schedulable": True,
                 "hops": [{"name": "sense", "activation": "sampled", "waits_ns": 0, "responds_ns": 300_000, "until_ns": 300_000},
                          {"name": "act", "activation": "triggered", "waits_ns": 0, "responds_ns": 200_000, "until_ns": 500_000}],
                 "why": "sense takes the longest: 300us"}
        self.assertEqual(self.chain(hops), whole)
        self.assertEqual(self.chain(hops, "--deadline", "5500us"),
                         whole | {"deadline_ns": 5_500_000, "why": "0s before its deadline; sense takes the longest: 300us"})
        self.assertEqual(self.chain(hops, "--deadline", "5499999ns", code=1),
                         whole | {"deadline_ns": 5_499_999, "schedulable": False, "why": "1ns after its deadline; sense takes the longest: 300us"})

    def test_an_age_beyond_63_bits(self):
        """It is no hop's fault: each of them has a bound."""
        self.assertEqual(self.chain(self.HOPS + f"a,,sampled,1,,{2**63 - 1}\n", code=1), {
            "latency_ns": None, "shortest_ns": None, "age_ns": None, "deadline_ns": None, "schedulable": False,
            "hops": [{"name": "a", "activation": "sampled", "waits_ns": None, "responds_ns": None, "until_ns": None}],
            "why": "no bound found: its busy period is longer than the limits of the analysis"})

    def test_what_samples_has_the_jitter_of_its_set(self):
        self.file(TASKS + "read,2,1000,1000000,,250,\n", "cpu.csv")
        self.file(BUS + "pose,1,7,1000000000,,250000\n", "bus.csv")
        found = self.chain(self.HOPS + "read,cpu.csv,sampled\npose,bus.csv,sampled\n", "--bitrate", "125k")
        self.assertEqual([hop["responds_ns"] for hop in found["hops"]], [1250, 1_250_000])
        self.assertEqual(found["latency_ns"], 1250 + 1_000_000_000 + 1_250_000)

    def test_frames_of_the_robot_have_their_exact_lengths(self):
        """The hop before always takes 2 ms, and hands on no jitter; on the bus alone the frame has one of 1 ms."""
        rows = json.loads(self.run_tool("analyse", "bus", "--json")[0])["messages"]
        found = self.chain(self.HOPS + "estimate,,sampled,2000000,2000000,30000000\nodometry.pose,robot,triggered\n")
        self.assertEqual(found["hops"][1]["responds_ns"], self.column(rows, "response_ns")["odometry.pose"] - 1_000_000)

    def test_over_the_robots_own_bus(self):
        found = self.chain(self.HOPS + "estimate,,sampled,2000000,,30000000\nodometry.pose,robot,triggered\n")
        self.assertGreater(found["latency_ns"], 2000000 + 111 * 2000)

    def test_rates_are_of_the_robots_bus(self):
        """What looks at its own period waits for one of them: 10 ms less with 40 ms in place of 50."""
        hops = self.HOPS + "estimate,,sampled,2000000,,30000000\ngyroscope,robot,sampled\n"
        waits = [self.chain(hops, "--rates", f"gyro={period}")["hops"][1]["waits_ns"] for period in ("50ms", "40ms")]
        self.assertEqual(waits[0] - waits[1], 10_000_000)
        self.file(BUS + "pose,1,7,1000000000,,\n", "bus.csv")
        for text in ("pose,bus.csv,sampled\n", "plan,,sampled,5000000,,10000000\n"):
            out, err = self.run_tool("analyse", "chain", self.file(self.HOPS + text, "chain.csv"), "--rates", "pose=5ms", code=2)
            self.assertEqual(out, "")
            self.assertIn("--rates pose=5ms: no hop of ", err)
            self.assertIn("is on the robot's bus, which it changes\n    the period in the set's file", err)

    def test_mistakes(self):
        self.file(BUS + "pose,1,7,1000000000,,\n", "bus.csv")
        for text, *words in (("a,bus.csv,sampled\n", "chain.csv:2", "'a' is not in bus.csv"),
                             ("pose,bus.csv,triggered\n", "chain.csv:2", "first hop"),
                             ("pose,bus.csv,often\n", "'often'"), ("x,,sampled,5\n", "no period_ns"),
                             ("pose,bus.csv,sampled,5\n", "beside a set")):
            _, err = self.run_tool("analyse", "chain", self.file(self.HOPS + text, "chain.csv"), code=2)
            for word in words:
                self.assertIn(word, err)


class Trace(Analyse):
    SET = BUS + "a,0x101,2,10000000,,500000\nb,0x102,2,20000000,,\n"

    def log(self, frames):
        """(time in us, frame) as candump -l writes it."""
        lines = sorted(frames)
        return self.file("".join(f"({1000 + t // 1000000}.{t % 1000000:06}) can0 {frame}\n" for t, frame in lines), "x.log")

    def trace(self, frames, *options, code=0):
        out, _ = self.run_tool("analyse", "trace", self.log(frames), "--set", self.file(self.SET), "--json", *options,
                               code=code)
        found = json.loads(out)
        return {row["name"]: row for row in found["messages"]}, found

    @staticmethod
    def regular(count=300):
        frames = [(i * 10000 + 300 + i % 3 * 100, "101#0102") for i in range(count)]
        return frames + [(i * 20000 + 900, "102#0102") for i in range(count // 2)]

    def test_what_keeps_to_its_bounds(self):
        found, whole = self.trace(self.regular())
        self.assertEqual(whole["broken"], [])
        a = found["a"]
        self.assertEqual((a["count"], a["shortest_ns"], a["longest_ns"], a["lateness_ns"]), (300, 9800000, 10100000, 200000))
        # The frame itself on top, its stuff bits as they are: 47 + 16 and at least no stuff bit, of 2 us.
        self.assertGreaterEqual(a["measured_ns"], 200000 + 63 * 2000)
        self.assertLess(a["measured_ns"], a["response_ns"])
        self.assertTrue(a["within"])
        # Two frames a 20 ms and one: 3 of 63 bits and some stuff bits of 2 us.
        self.assertAlmostEqual(whole["measured_utilisation"], 3 * 67 * 2e-6 / 20e-3, delta=1e-3)

    def test_tables(self):
        frames = self.regular(30) + [(150050, "300#01"), (150400, "101#0102")]
        path, set_file = self.log(frames), self.file(self.SET)
        out, _ = self.run_tool("analyse", "trace", path, "--set", set_file, code=1)
        self.assertEqual(out, """\
MESSAGE   FRAMES           T      SHORTEST          MEAN       LONGEST      MEASURED             R  VERDICT
a             31        10ms         100us    9.673333ms        10.1ms             -         800us  OTHER PERIOD
b             15        20ms          20ms          20ms          20ms         136us         300us  ok

47 frames in 290.2ms; load 2.13 % measured, 2.25 % at most (500 kbit/s, generic lengths, exact test)
Assumptions that the log contradicts:
  - period: a came every 9.673333ms on average, every 10ms was assumed; --rates NAME=PERIOD says what was meant
  - set: 1 frame of 0x300, which is not in the set
  - bit rate: 1 frame came sooner after the one before than 500000 bit/s allow: the bit rate is higher, or the times are those of \
a host and not of a CAN controller
""")
        out, _ = self.run_tool("analyse", "trace", path, "--set", set_file, "--csv", code=1)
        self.assertEqual(out, """\
name,count,period_ns,shortest_ns,mean_ns,longest_ns,lateness_ns,measured_ns,response_ns,within
a,31,10000000,100000,9673333,10100000,,,800000,false
b,15,20000000,20000000,20000000,20000000,0,136000,300000,true
""")

    def test_remarks_are_about_topics_without_a_given_rate(self):
        frames = [(0, "208#01140000"), (1000, "208#01320000"), (2000, "23C#FF0000")]
        frames += [(3000 + i * 20000, "608#000000000000") for i in range(50)]
        frames += [(5000 + i * 100000, "201#1027000000000000") for i in range(10)]
        log = self.log(frames)
        remarks = ("gyroscope was asked for every 20ms and every 50ms: the shorter one counts.\n",
                   "motors has no period of its own: the shortest distance in the log, 100ms, counts.\n",
                   "led_1 has no period of its own, and came once: 1s counts.\n")
        out, _ = self.run_tool("analyse", "trace", log)
        for remark in remarks:
            self.assertIn(remark, out)
        out, _ = self.run_tool("analyse", "trace", log, "--rates", "gyro=20ms", "--rates", "motors=100ms", "--rates", "led_1=1s")
        for remark in remarks:
            self.assertNotIn(remark, out)

    def test_a_given_rate_has_the_priority_that_it_says_or_that_of_the_log(self):
        log = self.log([(i * 100_000, "101#1027000000000000") for i in range(10)])  # motors, at high priority
        for rate, count, broken in (("motors=100ms", 10, []), ("motors=100ms@high", 10, []),
                                    ("motors=100ms@low", 0, ["set: 10 frames of 0x101, which is not in the set"])):
            out, _ = self.run_tool("analyse", "trace", log, "--json", "--rates", rate, code=1 if broken else 0)
            found = json.loads(out)
            self.assertEqual(([row["count"] for row in found["messages"]], found["broken"]), ([count], broken), rate)

    def test_messages_of_a_spec_are_the_set(self):
        car = os.path.join(os.environ["OCM_SOURCE_DIR"], "examples", "small_car.dbc")
        log = self.log([(i * 10000, "100#0000000000000000") for i in range(100)] + [(5000 + i * 20000, "110#00000000") for i in range(50)])
        by_spec = json.loads(self.run_tool("--spec", car, "analyse", "trace", log, "--lengths", "exact", "--json")[0])
        by_set = json.loads(self.run_tool("analyse", "trace", log, "--set", car, "--lengths", "exact", "--json")[0])
        self.assertEqual(by_spec["messages"], by_set["messages"])
        counts = {row["name"]: row["count"] for row in by_spec["messages"]}
        self.assertEqual((counts["Engine"], counts["Transmission"], counts["Driving"]), (100, 50, 0))

    def test_a_pause_is_no_lateness(self):
        frames = [(t if t < 1000000 else t + 123456, f) for t, f in self.regular()]
        self.assertEqual(self.trace(frames)[1]["broken"], [])

    def test_a_lost_frame_is_no_lateness(self):
        frames = [frame for frame in self.regular() if frame[0] // 10000 != 50]
        self.assertEqual(self.trace(frames)[1]["broken"], [])

    def broken(self, frames, word, *options):
        _, whole = self.trace(frames, *options, code=1)
        self.assertEqual([text.split(":")[0] for text in whole["broken"]], [word], whole["broken"])
        return whole["broken"][0]

    def test_each_broken_assumption_has_its_name(self):
        regular = self.regular()
        late = [(t + (4000 if f.startswith("102") and 500000 < t < 520000 else 0), f) for t, f in regular]
        self.assertIn("b came up to 4ms behind", self.broken(late, "jitter"))
        fast = [(t * 4 // 5 if f.startswith("102") else t, f) for t, f in self.regular()]
        found, whole = self.trace(fast, code=1)
        self.assertIn("b came every 16ms", whole["broken"][0])
        self.assertEqual((found["b"]["measured_ns"], found["b"]["within"]), (None, False))
        self.assertIn("0x7FF", self.broken(regular + [(5000, "7FF#")], "set"))
        self.assertIn("8 bytes", self.broken([(t, f + "030405060708" if t == 500900 else f) for t, f in regular], "length"))
        self.assertIn("1 error frame", self.broken(regular + [(5000, "20000004#0000000000000000")], "errors"))
        self.trace(regular + [(5000, "20000004#0000000000000000")], "--errors", "burst=1")
        close = regular + [(t + 20, "102#0102") for t, f in regular if f.startswith("102") and t == 500900]
        self.assertIn("bit rate", " ".join(self.trace(close, code=1)[1]["broken"]))

    def test_more_errors_than_assumed(self):
        """The log is of 2.99 s: with one at once and one more every second there may be three."""
        def log(count):
            return self.regular() + [(5000 + i * 1000, "20000004#0000000000000000") for i in range(count)]

        for model, most, said in (("burst=1", 1, "1 was"), ("burst=2", 2, "2 were"), ("burst=1,every=1s", 3, "3 were")):
            self.assertEqual(self.trace(log(most), "--errors", model)[1]["broken"], [])
            self.assertEqual(self.broken(log(most + 1), "errors", "--errors", model), f"errors: {most + 1} error frames, {said} assumed")

    def test_more_load_than_assumed(self):
        """Frames of 136 us, beside a set of 2.25 %: 2.34 % may be, 2.39 % may not."""
        def broken(distance):
            return self.trace([(i * distance, "102#0102") for i in range(50)], code=1)[1]["broken"]

        period = "period: b came every {} on average, every 20ms was assumed; --rates NAME=PERIOD says what was meant"
        self.assertEqual(broken(5800), [period.format("5.8ms")])
        self.assertEqual(broken(5700), [period.format("5.7ms"), "load: 2.39 % measured, 2.25 % at most were assumed"])

    def test_more_bytes_than_assumed(self):
        log = self.log([(0, "101#0102"), (10000, "102#01")])
        path = self.file(BUS + "one,0x101,1,10000000,,\nnone,0x102,0,10000000,,\n")
        found = json.loads(self.run_tool("analyse", "trace", log, "--set", path, "--json", code=1)[0])
        self.assertEqual(found["broken"], ["length: one came with 2 bytes, 1 was assumed", "length: none came with 1 byte, 0 were assumed"])

    def test_times_of_a_log_are_no_finer_than_a_microsecond(self):
        """b takes 136 us, 300 us at most, and comes every 20 ms: what is a microsecond beside that contradicts nothing, two do."""
        def frames(*times):
            return [(300 + i * 10000, "101#0102") for i in range(10)] + [(t, "102#0102") for t in times]
        rounded = [frames(300 + 135, 20300 + 135, 40300 + 135),  # behind a, sooner than the bit rate allows
                   frames(5000, 5000 + 19979, 5000 + 2 * 19979),  # a tenth of a percent sooner on average
                   frames(5000, 25000 + 165, 45000)]  # later than the bound
        for log in rounded:
            self.assertEqual(self.trace(log)[1]["broken"], [])
        self.assertIn("bit rate: 3 frames came sooner", self.broken(frames(300 + 134, 20300 + 134, 40300 + 134), "bit rate"))
        self.assertIn("b came every 19.978ms", self.broken(frames(5000, 5000 + 19978, 5000 + 2 * 19978), "period"))
        self.assertIn("b came up to 166us behind", self.broken(frames(5000, 25000 + 166, 45000), "jitter"))

    def test_the_robot(self):
        """Requests in the log say the periods; what was not requested is not in the set."""
        frames = [(0, "208#01320000")] + [(1000 + i * 50000, "608#000000000000") for i in range(50)]
        out, _ = self.run_tool("analyse", "trace", self.log(frames), "--json")
        found = json.loads(out)
        self.assertEqual([(row["name"], row["period_ns"]) for row in found["messages"]], [("gyroscope", 50000000)])
        self.assertEqual(found["broken"], [])
        out, _ = self.run_tool("analyse", "trace", os.path.join(self.folder, "x.log"))
        self.assertIn("1 request", out)

    @staticmethod
    def driven():
        """Set points in us of three runs of a drive, as a host sends them, each with rest behind it, and of a person's keys."""
        moves, rest = "201#A086010000000000", "201#0000000000000000"
        frames = []
        for begin in (0, 1_950_000, 3_890_000):
            frames += [(begin + i * 100_000 + (i % 3) * 150, moves) for i in range(10)] + [(begin + 1_000_000, rest)]
        for begin in (6_000_000, 6_160_000, 6_500_000):  # pressed, held or not, released; and again before a period is over
            frames += [(begin, moves), (begin + 40_000, rest)]
        frames += [(7_000_000, moves), (7_100_000, moves), (7_140_000, "201#50C3000000000000"), (7_240_000, "201#50C3000000000000")]
        return frames + [(7_300_000, rest)]

    def test_set_points_of_a_drive(self):
        """Each run has a grid of its own, as has each change: what a person does is no lateness of the bus."""
        def motors(frames, *options, code=0):
            found = json.loads(self.run_tool("analyse", "trace", self.log(frames), "--json", *options, code=code)[0])
            return found["messages"][0], found["broken"]

        row, broken = motors(self.driven())
        self.assertEqual((row["name"], broken), ("motors", []))
        self.assertEqual(row["lateness_ns"], 300_000)
        self.assertLess(row["measured_ns"], row["response_ns"])
        self.assertEqual(row["period_ns"], row["shortest_ns"])
        # One that is late within a run is found.
        late = [(t + (30_000 if t == 300_000 else 0), frame) for t, frame in self.driven()]
        row, broken = motors(late, code=1)
        self.assertEqual(row["lateness_ns"], 30_000_000)
        self.assertIn("jitter: motors", broken[0])
        # Of a program that repeats them at another period, the period is not known; --rates says it.
        fast = [(i * 20_000 + (5_000 if i == 30 else 0), "201#A086010000000000") for i in range(60)]
        row, broken = motors(fast)
        self.assertEqual((row["lateness_ns"], broken), (0, []))
        row, _ = motors(fast, "--rates", "motors=20ms", code=1)
        self.assertEqual(row["lateness_ns"], 5_000_000)

    def test_set_points_of_a_log_that_begins_at_zero(self):
        """As a simulation in virtual time writes it: a frame at time zero is one as any other."""
        def motors(*times, code=0):
            path = self.file("".join(f"({time:.6f}) can0 201#A086010000000000\n" for time in times), "zero.log")
            return json.loads(self.run_tool("analyse", "trace", path, "--json", code=code)[0])["messages"][0]

        self.assertEqual(motors(0, 0.02)["period_ns"], 20_000_000)
        # What comes first has no distance, also where a drive's would fit: one of these two is as a drive repeats it.
        self.assertEqual(motors(0.04, 0.14, 0.26, code=1)["lateness_ns"], 20_000_000)

    def test_which_set_points_are_repeated_as_those_of_a_drive(self):
        """Every 100 ms, a quarter more or less: if most are, there is a grid to be behind of. What is farther apart is a pause."""
        for times, lateness in (((0, 0.075, 0.195), 20_000_000), ((0, 0.074999, 0.195), 0),
                                ((0, 0.125, 0.225, 0.275), 25_000_000), ((0, 0.125001, 0.225001, 0.275001), 0)):
            path = self.file("".join(f"({1000 + time:.6f}) can0 201#A086010000000000\n" for time in times), "x.log")
            found = json.loads(self.run_tool("analyse", "trace", path, "--json", code=1 if lateness else 0)[0])
            self.assertEqual(found["messages"][0]["lateness_ns"], lateness, times)

    def test_a_refused_request_asks_for_nothing(self):
        frames = [(0, "208#01320000")] + [(1000 + i * 50000, "608#000000000000") for i in range(50)]
        refusal = "71D#080F010000000000"  # of the gyroscope, not_schedulable, the first
        path = self.log(frames + [(500_000, "208#01010000"), (502_000, refusal)])
        out, _ = self.run_tool("analyse", "trace", path, "--json")
        found = json.loads(out)
        self.assertEqual({row["name"]: row["period_ns"] for row in found["messages"]}["gyroscope"], 50_000_000)
        self.assertEqual(found["broken"], [])

    def test_other_set_points_are_sent_on_events(self):
        frames = [(t, "23C#FF0000") for t in (0, 100_000, 230_000, 340_000)]
        found = json.loads(self.run_tool("analyse", "trace", self.log(frames), "--json")[0])
        self.assertEqual((found["messages"][0]["lateness_ns"], found["broken"]), (0, []))

    def test_mistakes(self):
        for text, word in (("nonsense\n", "x.log:1"), ("\n", "no frame"), ("(1.0) can0 101#01\n\n(2.0) can0 1#01\n", "x.log:3")):
            _, err = self.run_tool("analyse", "trace", self.file(text, "x.log"), code=2)
            self.assertIn(word, err)
        self.run_tool("analyse", "trace", os.path.join(self.folder, "none.log"), code=1)
        self.run_tool("analyse", "trace", self.file("", "x.log"), code=1)


class Picture(Analyse):
    def test_svg(self):
        path = os.path.join(self.folder, "worst.svg")
        self.run_tool("analyse", "bus", self.file(DAVIS.replace("\nc,", '\n"<c>",')), "--bitrate", "125k", "--svg", path,
                      code=1)
        root = ElementTree.parse(path).getroot()
        texts = [text.text for text in root.iter("{http://www.w3.org/2000/svg}text")]
        self.assertIn("<c>", texts)
        self.assertIn("3.5ms of 3.25ms, 250us late", texts)
        out, _ = self.run_tool("analyse", "bus", "--svg", "-")
        ElementTree.fromstring(out)
        with open(os.path.join(SOURCE, "docs", "images", "worst_case.svg"), encoding="utf-8") as picture:
            self.assertEqual(out, picture.read(), "the picture of the docs is another: scripts/pictures worst_case")
        self.run_tool("analyse", "bus", "--svg", os.path.join(self.folder, "none", "x.svg"), code=1)

    def test_a_picture_has_room_for_sixty_rows(self):
        for count, left_out in ((60, ""), (61, "; the first 60 of 61")):
            rows = "".join(f"task_{i},{i + 1},1000,1000000,,,\n" for i in range(count))
            out, _ = self.run_tool("analyse", "tasks", self.file(TASKS + rows), "--svg", "-")
            texts = [text.text or "" for text in ElementTree.fromstring(out).iter("{http://www.w3.org/2000/svg}text")]
            self.assertEqual(len({text for text in texts if text.startswith("task_")}), 60)
            head, = (text for text in texts if "% of the processor" in text)
            self.assertEqual(head.partition("preemptive")[2], left_out)

    def test_releases_that_are_later_than_a_period(self):
        """The first one comes 25 ns late, and each next one as soon as it may: 1 ns behind it, and every 10 ns from there."""
        out, _ = self.run_tool("analyse", "tasks", self.file(TASKS + "a,1,1,10,,25,\n"), "--svg", "-", code=1)
        arrows = [float(path.get("d")[1:].split()[0]) for path in ElementTree.fromstring(out).iter("{http://www.w3.org/2000/svg}path")]
        first, nanosecond = arrows[0], arrows[1] - arrows[0]
        self.assertEqual(len(arrows), 4)
        self.assertAlmostEqual((arrows[2] - first) / nanosecond, 11, places=1)
        self.assertAlmostEqual((arrows[3] - first) / nanosecond, 21, places=1)

    def test_all_the_time_that_there_is(self):
        """Its grid is the line at zero, as the next one would be beyond 63 bits."""
        most = 2**63 - 1
        rows = f"a,1,8,{most},,\nb,2,8,{most},1,{most}\nc,3,8,{most},,\n"
        out, _ = self.run_tool("analyse", "bus", self.file(BUS + rows), "--svg", "-", code=1)
        self.assertIn("Worst case of b<", out)
        self.assertEqual(out.count('text-anchor="middle" fill="#555" font-size="10">'), 1)
        self.assertIn('font-size="10">0s</text>', out)

    def test_what_waits_for_its_own_release_is_behind_nothing_less_urgent(self):
        out, _ = self.run_tool("analyse", "bus", self.file(DAVIS), "--bitrate", "125k", "--test", "sufficient", "--svg", "-", code=1)
        self.assertIn("Worst case of c<", out)
        self.assertIn("7ms of 3.25ms, 3.75ms late", out)
        self.assertNotIn('fill="#bbb"', out)
        # a is behind b, the longest that is less urgent.
        out, _ = self.run_tool("analyse", "bus", self.file(DAVIS.replace("2500000,,", "2500000,2000000,")), "--bitrate", "250k", "--svg", "-")
        self.assertEqual(out.count('fill="#bbb"'), 1)


class Dbc(Analyse):
    TEXT = '''VERSION ""
NS_ :
BS_:
BU_: Engine Dash
BO_ 257 Speed: 7 Engine
 SG_ Rpm : 0|16@1+ (0.25,0) [0|16383] "rpm" Dash
BO_ 2566844672 Wide: 8 Engine
BO_ 1024 Rare: 2 Dash
BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX
CM_ BO_ 257 "says
BO_ 1 is not a message; nor is BA_ ""GenMsgCycleTime""";
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "GenMsgCycleTime" BO_ 257 10;
BA_ "GenMsgCycleTime" BO_ 2566844672 100;
'''

    def test_cycle_times(self):
        found = self.bus(self.TEXT, "--bitrate", "125k", name="car.dbc")
        self.assertEqual(self.column(found["messages"], "deadline_ns"), {"Speed": 10000000, "Wide": 100000000})
        self.assertEqual(found["messages"][0]["response_ns"], (160 + 125) * 8000)
        out, _ = self.run_tool("analyse", "bus", os.path.join(self.folder, "car.dbc"))
        self.assertIn("Not counted: 1 message,", out)
        self.assertIn("no cycle time and no shortest distance (1): Rare", out)
        self.assertEqual(found["left_out"], [{"name": "Rare", "reason": "no_period",
                                              "why": "no cycle time and no shortest distance"}])
        out, err = self.run_tool("analyse", "bus", os.path.join(self.folder, "car.dbc"), "--csv")
        self.assertEqual(len(out.splitlines()), 3)
        self.assertIn("no cycle time and no shortest distance (1): Rare", err)

    def test_a_rate_for_what_has_none(self):
        found = self.bus(self.TEXT, "--bitrate", "125k", "--rates", "Rare=50ms", "Speed=off", name="car.dbc")
        self.assertEqual(self.column(found["messages"], "period_ns"), {"Rare": 50000000, "Wide": 100000000})
        self.assertEqual(found["left_out"], [])
        for rates, word in (("Rar=50ms", "'Rar'"), ("Rare=50ms@high", "priority of its identifier")):
            _, err = self.run_tool("analyse", "bus", os.path.join(self.folder, "car.dbc"), "--rates", rates, code=2)
            self.assertIn(word, err)

    def test_a_message_is_overwritten_by_the_next_one(self):
        """A deadline beyond the period is the period."""
        text = json.dumps({"robot": "car", "bus": {"bit_rate": 125000}, "messages": [
            {"name": "Slow", "id": "0x101", "period": "10ms", "deadline": "25ms", "fields": []},
            {"name": "Soon", "id": "0x102", "period": "20ms", "deadline": "15ms", "fields": []},
            {"name": "Usual", "id": "0x103", "period": "20ms", "fields": []}]})
        for rates, soon in (((), 15), (("--rates", "Soon=15ms"), 15), (("--rates", "Soon=5ms"), 5)):
            found = self.bus(text, *rates, name="car.json")
            self.assertEqual(self.column(found["messages"], "deadline_ns"), {"Slow": 10000000, "Soon": soon * 1000000, "Usual": 20000000})

    def test_a_spec_is_known_by_what_is_in_it(self):
        message = {"name": "Speed", "id": "0x101", "period": "10ms", "fields": []}
        text = json.dumps({"robot": "car", "bus": {"bit_rate": 125000}, "messages": [message]})
        for spec in (text, " \t\r\n" + text, self.TEXT, "\n" + self.TEXT):
            self.assertEqual(self.bus(spec, name="car.txt")["messages"][0]["name"], "Speed")

    def test_what_another_reader_sees(self):
        """Names, identifiers, cycle times and senders of canmatrix are those that were analysed."""
        reader = ("import sys, canmatrix.formats\n"
                  "for m in canmatrix.formats.loadp(sys.argv[1])[''].frames:\n"
                  "    print(m.name, hex(m.arbitration_id.id), m.size, m.effective_cycle_time, *m.transmitters)\n")
        path = self.file(self.TEXT, "car.dbc")
        for python in ("/usr/bin/python3", sys.executable):
            read = subprocess.run([python, "-c", reader, path], capture_output=True, text=True, check=False)
            if read.returncode == 0:
                break
        else:
            self.skipTest("no canmatrix")
        rows = [line.split() for line in read.stdout.splitlines()]
        seen = {row[0]: row for row in rows if row[3] not in ("0", "None")}
        self.assertEqual(set(seen), {"Speed", "Wide"}, read.stdout)
        found = self.bus(self.TEXT, "--queue", "Engine=fifo", name="car.dbc")
        for message in found["messages"]:
            other = seen[message["name"]]
            self.assertEqual(int(message["id"], 16), int(other[1], 16))
            self.assertEqual(message["deadline_ns"], int(float(other[3]) * 1e6))
            self.assertEqual(other[4], "Engine")

    def test_mistakes(self):
        for text, word in (("BO_ 1 A: 8 X\n", "car.dbc: no message has a cycle time"), ("\nBO_ A 8\n", ":2: BO_"), ("", "no statement of DBC"), ("BU_: A\n", "no message"),
                           ('BO_ 1 A: 8 X\nBA_ "GenMsgCycleTime" BO_ 1 soon;', "cycle time")):
            _, err = self.run_tool("analyse", "bus", self.file(text, "car.dbc"), code=2)
            self.assertIn(word, err)

    def test_what_is_doubtful_is_said(self):
        """Up to five places; the set is analysed all the same."""
        text = 'BO_ 2048 A: 8 X\nBA_ "GenMsgCycleTime" BO_ 2048 10;\n' + 'CM_ BO_ 9 "of nothing";\n' * 6
        out, _ = self.run_tool("analyse", "bus", self.file(text, "car.dbc"))
        self.assertIn("car.dbc:1: the identifier 2048 of A has more than 11 bits", out)
        self.assertEqual(out.count("which is not in the file"), 4)
        self.assertIn("car.dbc: 2 more doubtful places.", out)


class FlexibleData(Analyse):
    """CAN FD: figures by hand. 500 kbit/s and 2 Mbit/s, so 2 us and 500 ns a bit."""
    TEXT = '''VERSION ""
BU_: Engine Dash
BO_ 256 Fast: 64 Engine
BO_ 257 Slow: 8 Dash
BO_ 258 Odd: 10 Dash
BO_ 259 Plain: 2 Dash
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 10;
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","StandardCAN_FD";
BA_DEF_DEF_ "VFrameFormat" "StandardCAN";
BA_DEF_ BO_ "CANFD_BRS" ENUM "0","1";
BA_DEF_DEF_ "CANFD_BRS" "1";
BA_DEF_ "Baudrate" INT 0 1000000;
BA_DEF_ "BaudrateCANFD" INT 0 16000000;
BA_ "Baudrate" 500000;
BA_ "BaudrateCANFD" 2000000;
BA_ "VFrameFormat" BO_ 259 1;
BA_ "CANFD_BRS" BO_ 259 0;
'''

    def rows(self, *options, text=None, name="fd.dbc"):
        return {row["name"]: row for row in self.bus(text or self.TEXT, *options, name=name)["messages"]}

    def test_by_hand(self):
        rows = self.rows()
        # Any identifier: 17 bits to BRS and 3 stuff bits, ACK 2, EOF 7, intermission 3. Behind BRS: ESI, DLC 4, the data
        # and a stuff bit for each four of its bits, CRC field 27 or 32, delimiter 1.
        self.assertEqual((rows["Fast"]["bits"], rows["Fast"]["data_bits"]), (32, 5 + 512 + 128 + 32 + 1))
        self.assertEqual((rows["Slow"]["bits"], rows["Slow"]["data_bits"]), (135, 0))
        # 10 bytes are sent in a frame of 12. DLC 1001 ends with a run of one: the fifth bit of the data is stuffed first.
        self.assertEqual((rows["Odd"]["bits"], rows["Odd"]["data_bits"]), (32, 5 + 96 + 23 + 27 + 1))
        # No switch: all at one rate. DLC 0010 behind res, BRS and ESI 000: a stuff bit behind five zeros. It ends with a run of
        # one: three stuff bits in 16 bits, before the fifth, the ninth and the thirteenth.
        self.assertEqual((rows["Plain"]["bits"], rows["Plain"]["data_bits"]), (20 + 5 + 1 + 16 + 3 + 27 + 1 + 12, 0))
        cost = {"Fast": 64000 + 339000, "Slow": 270000, "Odd": 64000 + 76000, "Plain": 2000 * 85}
        responses = {name: row["response_ns"] for name, row in rows.items()}
        self.assertEqual(responses["Fast"], cost["Fast"] + cost["Slow"])
        self.assertEqual(responses["Slow"], cost["Fast"] + cost["Slow"] + cost["Plain"])
        self.assertEqual(responses["Odd"], sum(cost.values()))
        self.assertEqual(responses["Plain"], sum(cost.values()))

    def test_its_own_identifier(self):
        # 00100000000 behind SOF: five zeros behind the 1, a stuff bit, then three, RRS and IDE: another one.
        self.assertEqual(self.rows("--lengths", "exact")["Fast"]["bits"], 17 + 2 + 12)

    def test_a_parameter_group_comes_from_any_source(self):
        """Any identifier: 36 bits to BRS, 7 stuff bits, 12 behind the data. That of the other has two runs of five ones."""
        head = {"length": 16, "fd": True, "period": "100ms", "fields": []}
        text = json.dumps({"robot": "truck", "bus": {"bit_rate": 500000, "data_bit_rate": 2000000}, "messages": [
            {"name": "Group", "pgn": "0xFEF1", **head}, {"name": "Other", "id": "0x18FEF2FE", "format": "extended", **head}]})
        rows = self.rows("--lengths", "exact", text=text, name="truck.json")
        data = 5 + 128 + 31 + 27 + 1
        self.assertEqual({name: (row["bits"], row["data_bits"]) for name, row in rows.items()}, {"Group": (55, data), "Other": (50, data)})

    def test_other_rates(self):
        fast = self.rows("--data-bitrate", "5M")["Fast"]
        self.assertEqual(fast["response_ns"], 64000 + 678 * 200 + 270000)
        self.assertEqual(self.rows("--data-bitrate", "500k")["Fast"]["response_ns"], (32 + 678 + 32 + 152) * 2000)
        out, _ = self.run_tool("analyse", "bus", os.path.join(self.folder, "fd.dbc"))
        for word in ("500 kbit/s and 2 Mbit/s for data", "64 B FD, 32 + 678 bits"):
            self.assertIn(word, out)
        # No rate for the data: safe, and said. Odd is the longest below.
        text = self.TEXT.replace('BA_ "BaudrateCANFD" 2000000;', "")
        self.assertEqual(self.rows(text=text)["Fast"]["response_ns"], (32 + 678 + 32 + 152) * 2000)
        out, _ = self.run_tool("analyse", "bus", os.path.join(self.folder, "fd.dbc"))
        self.assertIn("No data bit rate", out)

    def test_errors_are_at_the_rate_of_arbitration(self):
        # 31 bits of 2 us and the longest frame again.
        fast = self.rows("--errors", "burst=1")["Fast"]
        self.assertEqual(fast["response_ns"], 270000 + 403000 + 62000 + 403000)

    def test_table(self):
        text = ("name,id,dlc,period_ns,fd\nFast,0x100,64,10000000,\nSlow,0x101,8,10000000,no\n"
                "Odd,0x102,12,10000000,brs\nPlain,0x103,2,10000000,nobrs\n")
        rows = self.rows("--bitrate", "500k", "--data-bitrate", "2M", text=text, name="fd.csv")
        for name, row in self.rows().items():
            self.assertEqual((row["bits"], row["data_bits"], row["response_ns"]),
                             (rows[name]["bits"], rows[name]["data_bits"], rows[name]["response_ns"]), name)

    def test_every_way_to_a_spec(self):
        """The DBC file, as FILE and by --spec, and the JSON that it becomes, which keeps the data bit rate; and back."""
        dbc = self.file(self.TEXT, "fd.dbc")
        json_file = os.path.join(self.folder, "fd.json")
        self.run_tool("--spec", dbc, "generate", "spec", "-o", json_file)
        with open(json_file, encoding="utf-8") as file:
            self.assertEqual(json.load(file)["bus"], {"bit_rate": 500000, "data_bit_rate": 2000000})
        back = os.path.join(self.folder, "back.dbc")
        self.run_tool("--spec", json_file, "generate", "dbc", "-o", back)
        wanted, _ = self.run_tool("analyse", "bus", dbc, "--json")
        for arguments in (["analyse", "bus", json_file], ["--spec", dbc, "analyse", "bus"],
                          ["--spec", json_file, "analyse", "bus"], ["analyse", "bus", back]):
            self.assertEqual(self.run_tool(*arguments, "--lengths", "generic", "--json")[0], wanted, arguments)
        for rate, word in ((400000, "at least"), (17000000, "16000000")):
            path = self.file(json.dumps({"robot": "x", "bus": {"bit_rate": 500000, "data_bit_rate": rate},
                                         "messages": [{"name": "A", "id": 1, "fields": []}]}), "bad.json")
            _, err = self.run_tool("analyse", "bus", path, code=2)
            self.assertIn("data_bit_rate", err)
            self.assertIn(word, err)

    def test_a_log(self):
        """FD frames of a log are measured at both rates, and are in its load."""
        self.file(self.TEXT, "fd.dbc")
        data = "55" * 64
        log = self.file("".join(f"(1000.{i * 10000 + 403:06}) can0 100##1{data}\n" for i in range(90)), "x.log")
        out, _ = self.run_tool("analyse", "trace", log, "--set", os.path.join(self.folder, "fd.dbc"), "--json")
        found = json.loads(out)
        row = next(row for row in found["messages"] if row["name"] == "Fast")
        self.assertEqual((found["broken"], found["frames"], row["count"]), ([], 90, 90))
        # 0x55 has no stuff bits; BRS 1, ESI 0 and DLC 1111 with a zero behind it neither.
        self.assertEqual(row["measured_ns"], 31 * 2000 + (5 + 512 + 32 + 1) * 500)
        self.assertAlmostEqual(found["measured_utilisation"], row["measured_ns"] / 1e7, places=4)
        # Where no rate of the data is known, they took at least what they take at the highest: 62.5 ns a bit.
        self.file(self.TEXT.replace('BA_ "BaudrateCANFD" 2000000;', ""), "fd.dbc")
        out, _ = self.run_tool("analyse", "trace", log, "--set", os.path.join(self.folder, "fd.dbc"), "--json")
        row = next(row for row in json.loads(out)["messages"] if row["name"] == "Fast")
        self.assertEqual(row["measured_ns"], 31 * 2000 + (5 + 512 + 32 + 1) * 1000 // 16)


class Sporadic(Analyse):
    """What a DBC file says of when a message is sent, by the attributes of Vector's interaction layer."""
    TEXT = '''VERSION ""
BU_: Engine Dash
BO_ 1 Cyclic: 8 Engine
 SG_ a : 0|8@1+ (1,0) [0|0] "" Dash
BO_ 2 Event: 8 Engine
BO_ 3 Unbound: 8 Engine
BO_ 4 Both: 8 Dash
BO_ 5 BothUnbound: 8 Dash
BO_ 6 Active: 8 Dash
BO_ 7 Silent: 8 Dash
BO_ 8 Changes: 8 Dash
 SG_ b : 0|8@1+ (1,0) [0|0] "" Engine
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_ BO_ "GenMsgCycleTimeFast" INT 0 65535;
BA_DEF_ BO_ "GenMsgDelayTime" INT 0 65535;
BA_DEF_ BO_ "GenMsgStartDelayTime" INT 0 65535;
BA_DEF_ BO_ "GenMsgSendType" ENUM "Cyclic","spontaneous","CyclicAndSpontaneous","CyclicIfActive","NoMsgSendType";
BA_DEF_ SG_ "GenSigSendType" ENUM "Cyclic","OnChange","NoSigSendType";
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_DEF_DEF_ "GenMsgSendType" "NoMsgSendType";
BA_DEF_DEF_ "GenSigSendType" "NoSigSendType";
BA_ "GenMsgSendType" BO_ 1 0;
BA_ "GenMsgCycleTime" BO_ 1 20;
BA_ "GenMsgSendType" BO_ 2 1;
BA_ "GenMsgDelayTime" BO_ 2 30;
BA_ "GenMsgSendType" BO_ 3 1;
BA_ "GenMsgSendType" BO_ 4 2;
BA_ "GenMsgCycleTime" BO_ 4 100;
BA_ "GenMsgDelayTime" BO_ 4 15;
BA_ "GenMsgSendType" BO_ 5 2;
BA_ "GenMsgCycleTime" BO_ 5 100;
BA_ "GenMsgSendType" BO_ 6 3;
BA_ "GenMsgCycleTime" BO_ 6 200;
BA_ "GenMsgCycleTimeFast" BO_ 6 40;
BA_ "GenMsgCycleTime" BO_ 8 60;
BA_ "GenSigSendType" SG_ 8 b 1;
'''

    def test_the_shortest_distance(self):
        found = self.bus(self.TEXT, name="car.dbc")
        self.assertEqual(self.column(found["messages"], "period_ns"),
                         {"Cyclic": 20000000, "Event": 30000000, "Both": 15000000, "BothUnbound": 100000000,
                          "Active": 40000000, "Changes": 60000000})
        self.assertEqual(self.column(found["messages"], "sporadic"),
                         {"Cyclic": False, "Event": True, "Both": True, "BothUnbound": True, "Active": True, "Changes": True})
        self.assertEqual({entry["name"]: entry["reason"] for entry in found["left_out"]},
                         {"Unbound": "no_distance", "BothUnbound": "events", "Silent": "no_period", "Changes": "events"})
        out, _ = self.run_tool("analyse", "bus", os.path.join(self.folder, "car.dbc"))
        for word in ("Not counted: 4 messages", "without a shortest distance (1): Unbound", "(2): BothUnbound, Changes",
                     "30ms+", "T with a +"):
            self.assertIn(word, out)

    def test_defaults_count(self):
        """An attribute that a message does not give has its default, in the JSON of the file, too."""
        text = self.TEXT.replace('"GenSigSendType" "NoSigSendType"', '"GenSigSendType" "OnChange"')
        found = self.bus(text, name="car.dbc")
        self.assertIn({"name": "Cyclic", "reason": "events",
                       "why": "in the set by the cycle, not with what they send on events"}, found["left_out"])
        path = os.path.join(self.folder, "car.json")
        self.run_tool("--spec", os.path.join(self.folder, "car.dbc"), "generate", "spec", "-o", path)
        out, _ = self.run_tool("analyse", "bus", path, "--bitrate", "500k", "--json")
        self.assertEqual(json.loads(out), found)

    def test_start_delays_are_offsets(self):
        """Two of one node, half a period apart, never delay a third one both; one that is also sent on events may."""
        text = ('BU_: Left Right\nBO_ 1 a: 0 Left\nBO_ 2 b: 0 Left\nBO_ 3 c: 0 Right\n'
                'BA_DEF_ BO_ "GenMsgSendType" ENUM "Cyclic","CyclicAndEvent";\n' +
                "".join(f'BA_ "GenMsgCycleTime" BO_ {i} 1;\n' for i in (1, 2, 3)) +
                'BA_ "GenMsgStartDelayTime" BO_ 2 0.5;\n')
        found = self.bus(text, "--bitrate", "1M", name="car.dbc")
        self.assertEqual(found["messages"][2]["response_ns"], 110000)
        out, _ = self.run_tool("analyse", "bus", os.path.join(self.folder, "car.dbc"), "--bitrate", "1M")
        self.assertIn("with offsets", out)
        text += 'BA_ "GenMsgSendType" BO_ 2 1;\nBA_ "GenMsgDelayTime" BO_ 2 1;\n'
        self.assertEqual(self.bus(text, "--bitrate", "1M", name="car.dbc")["messages"][2]["response_ns"], 165000)
        # More clocks than can be counted from: without offsets, and said.
        many = "BU_: " + " ".join(f"N{i}" for i in range(1, 80)) + "\n"
        many += "".join(f"BO_ {i} m{i}: 0 N{i}\n" for i in range(1, 80))
        many += "".join(f'BA_ "GenMsgCycleTime" BO_ {i} 1000;\nBA_ "GenMsgStartDelayTime" BO_ {i} 5;\n'
                        for i in range(1, 80))
        out, _ = self.run_tool("analyse", "bus", self.file(many, "many.dbc"))
        self.assertIn("79 clocks, of 64", out)
        out, err = self.run_tool("analyse", "bus", self.file(many.replace(' 5;\n', ' 0;\n'), "none.dbc"))
        self.assertNotIn("clocks", out + err)  # nothing is left out of account

    def test_start_delays_by_the_most_clocks(self):
        for count, counts in ((64, True), (65, False)):
            text = "BU_: " + " ".join(f"N{i}" for i in range(1, count + 1)) + "\n"
            text += "".join(f"BO_ {i} m{i}: 0 N{i}\n" for i in range(1, count + 1))
            text += "".join(f'BA_ "GenMsgCycleTime" BO_ {i} 1000;\nBA_ "GenMsgStartDelayTime" BO_ {i} 5;\n' for i in range(1, count + 1))
            out, _ = self.run_tool("analyse", "bus", self.file(text, "clocks.dbc"))
            self.assertEqual(("with offsets" in out, "The start delays do not count: there are 65 clocks, of 64 at most." in out), (counts, not counts))

    def test_what_has_a_clock_of_its_own(self):
        """A message of no node, and one that is also sent on events, whichever node sends it: 70 of either beside the one that is delayed."""
        for sender, sent_on_events in (("Vector__XXX", False), ("Engine", True)):
            text = "BU_: Engine\nBO_ 1 m1: 0 Engine\n" + "".join(f"BO_ {i} m{i}: 0 {sender}\n" for i in range(2, 72))
            text += 'BA_DEF_ BO_ "GenMsgSendType" ENUM "Cyclic","CyclicAndEvent";\n'
            text += "".join(f'BA_ "GenMsgCycleTime" BO_ {i} 1000;\n' for i in range(1, 72))
            text += 'BA_ "GenMsgStartDelayTime" BO_ 1 5;\n'
            if sent_on_events:
                text += "".join(f'BA_ "GenMsgSendType" BO_ {i} 1;\nBA_ "GenMsgDelayTime" BO_ {i} 1000;\n' for i in range(2, 72))
            out, _ = self.run_tool("analyse", "bus", self.file(text, "clocks.dbc"))
            self.assertIn("The start delays do not count: there are 71 clocks, of 64 at most.", out)
            self.assertNotIn("with offsets", out)

    def test_no_message_is_dropped_in_silence(self):
        """Whatever a file says: each message is in the set, or left out with a reason; J1939's long ones, too."""
        chance = random.Random(14)
        types = ["Cyclic", "spontaneous", "CyclicAndSpontaneous", "IfActive", "NoMsgSendType", "BAF"]
        reasons = set()
        for _ in range(15):
            lines, names = ["BU_: X"], []
            attributes = ['BA_DEF_ BO_ "GenMsgSendType" ENUM ' + ",".join(f'"{each}"' for each in types) + ";",
                          'BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","StandardCAN_FD","J1939PG";']
            for i in range(chance.randrange(5, 60)):
                length = chance.choice([0, 1, 8, 8, 9, 12, 33, 64, 65, 100, 1785])
                wide = chance.random() < .4
                number = 0x98FE0000 + 256 * i if wide else i + 1
                names.append(f"M{i}")
                lines.append(f"BO_ {number} M{i}: {length} X")
                for name, top in (("GenMsgCycleTime", 400), ("GenMsgDelayTime", 40), ("GenMsgStartDelayTime", 9)):
                    if chance.random() < .4:
                        attributes.append(f'BA_ "{name}" BO_ {number} {chance.randrange(top)};')
                if chance.random() < .7:
                    attributes.append(f'BA_ "GenMsgSendType" BO_ {number} {chance.randrange(len(types))};')
                if wide and chance.random() < .5:
                    attributes.append(f'BA_ "VFrameFormat" BO_ {number} 3;')
            lines.append("BO_ 2000 Last: 8 X")
            names.append("Last")
            attributes.append('BA_ "GenMsgCycleTime" BO_ 2000 1000;')
            path = self.file("\n".join(lines + attributes) + "\n", "any.dbc")
            ran = subprocess.run([os.environ["AMIROCTL"], "analyse", "bus", path, "--json", "--bitrate", "1M"],
                                 capture_output=True, text=True, check=False)
            self.assertIn(ran.returncode, (0, 1), ran.stderr)
            found = json.loads(ran.stdout)
            counted = {row["name"] for row in found["messages"]}
            left = [entry["name"] for entry in found["left_out"]]
            self.assertEqual(len(left), len(set(left)))
            self.assertEqual(counted | set(left), set(names))
            self.assertEqual(counted & set(left),
                             {entry["name"] for entry in found["left_out"] if entry["reason"] == "events"})
            reasons |= {entry["reason"] for entry in found["left_out"]}
        self.assertEqual(reasons, {"no_period", "no_distance", "events", "transport_protocol", "too_long"})

    def test_parameter_groups(self):
        """Exact: the longest of any source. 0x18FEF1FE with the source that makes it longest, found by trying them all."""
        text = ('BO_ 2566844926 Group: 8 X\nBA_DEF_ BO_ "VFrameFormat" ENUM "a","b","c","J1939PG";\n'
                'BA_ "VFrameFormat" BO_ 2566844926 3;\nBA_ "GenMsgCycleTime" BO_ 2566844926 100;\n')
        group = self.bus(text, "--lengths", "exact", name="truck.dbc")["messages"][0]["bits"]
        table = BUS + "".join(f"m{i},{0x18FEF100 + i},8,1000000000,,\n" for i in range(256))
        each = [row["bits"] for row in self.bus(table, "--lengths", "exact")["messages"]]
        self.assertEqual(group, max(each))
        self.assertLess(min(each), group)
        out, _ = self.run_tool("analyse", "bus", os.path.join(self.folder, "truck.dbc"))
        self.assertIn("parameter group of J1939 counts once", out)


if __name__ == "__main__":
    main()
