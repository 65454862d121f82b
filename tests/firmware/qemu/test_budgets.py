"""The check of the images' sizes finds what it is there for."""

import importlib.util
import os
import unittest

spec = importlib.util.spec_from_file_location("budgets", os.path.join(os.environ["OCM_SOURCE_DIR"], "firmware/budgets.py"))
budgets = importlib.util.module_from_spec(spec)
spec.loader.exec_module(budgets)

LISTING = """image.elf  :
section      size        addr
.mstack      1024   536870912
vectors       448   134217728
.text       20000   134218176
.data          16   536872960
.bss         6000   536872976
.heap      100000   536878952
.comment       38           0
.debug_line 57441           0
Total      184967
"""


AVR_LISTING = """image.elf  :
section                     size      addr
.data                        886   8388864
.text                      17334         0
.bss                         136   8389750
.note.gnu.avr.deviceinfo      64         0
.debug_info                 1938         0
"""


class Budgets(unittest.TestCase):
    def test_figures(self):
        self.assertEqual(budgets.figures(LISTING), {"flash": 448 + 20000 + 16, "ram": 1024 + 16 + 6000})

    def test_figures_of_an_avr(self):
        self.assertEqual(budgets.figures(AVR_LISTING), {"flash": 17334 + 886, "ram": 886 + 136})

    def test_within(self):
        same = {"a": {"flash": 100, "ram": 10}}
        self.assertEqual(list(budgets.compare(same, same)), [])
        self.assertEqual(list(budgets.compare(same, {"a": {"flash": 101, "ram": 10}})), [])

    def test_over(self):
        for over in ({"flash": 101, "ram": 10}, {"flash": 100, "ram": 11}):
            problems = list(budgets.compare({"a": over}, {"a": {"flash": 100, "ram": 10}}))
            self.assertEqual(len(problems), 1)
            self.assertIn("1 over its budget", problems[0])

    def test_unknown_on_either_side(self):
        self.assertEqual(len(list(budgets.compare({"a": {"flash": 1, "ram": 1}}, {"b": {"flash": 1, "ram": 1}}))), 2)


if __name__ == "__main__":
    unittest.main()
