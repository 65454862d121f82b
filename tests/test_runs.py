"""What scripts/test says of a run: a test that was skipped is seen, and fails it."""

import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import runs  # noqa: E402

RUNS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "runs.py")


class Report(unittest.TestCase):
    def report(self, *cases):
        """(exit code, text) for cases of (name, status, output)."""
        with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
            file.write("<testsuite>" + "".join(f'<testcase name="{name}" status="{status}" time="1.5"><system-out>{output}'
                                               "</system-out></testcase>" for name, status, output in cases) + "</testsuite>")
            file.flush()
            done = subprocess.run([sys.executable, "-B", RUNS, "report", file.name], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout

    def test_all_passed(self):
        code, text = self.report(("unit_can", "run", "All tests passed"), ("cli_bus", "run", "Ran 3 tests in 1s\n\nOK\n"))
        self.assertEqual(code, 0)
        self.assertIn("tests: 2 passed, 0 failed, 0 skipped", text)

    def test_a_failure_is_named(self):
        code, text = self.report(("cli_bus", "fail", "FAILED (failures=1)"))
        self.assertEqual(code, 0)  # ctest has said so
        self.assertIn("failed: cli_bus", text)

    def test_a_skipped_test_fails_the_run(self):
        code, text = self.report(("compile_host", "notrun", "skipped: not installed: clang++-14"))
        self.assertEqual(code, 1)
        self.assertIn("  skipped: compile_host", text)

    def test_a_skipped_case_fails_the_run(self):
        for ended in ("OK (skipped=2)", "FAILED (failures=1, skipped=2)"):
            code, text = self.report(("logs_text", "run", f"..ss\nRan 4 tests in 1s\n\n{ended}\n"))
            self.assertEqual(code, 1)
            self.assertIn("  skipped: 2 cases of logs_text", text)

    def test_what_may_be_skipped(self):
        code, text = self.report(("logs_durability", "run", "OK (skipped=1)"))
        self.assertEqual(code, 0)
        self.assertIn("  skipped: 1 cases of logs_durability", text)


class Programs(unittest.TestCase):
    def test_paths_may_have_blanks(self):
        with tempfile.TemporaryDirectory(prefix="a tree ") as folder:
            with open(os.path.join(folder, "CTestTestfile.cmake"), "w", encoding="utf-8") as file:
                file.write(f'add_test(unit_can "{folder}/unit_can")\n'
                           f'set_tests_properties(unit_can PROPERTIES  ENVIRONMENT "AMIROCTL={folder}/amiroctl;N=1")\n'
                           f'add_test(unit_base "{folder}/unit_base")\n')
            found = runs.programs(folder, {"unit_can"})
        self.assertLessEqual({f"{folder}/unit_can", f"{folder}/amiroctl"}, found)
        self.assertNotIn(f"{folder}/unit_base", found)


if __name__ == "__main__":
    unittest.main()
