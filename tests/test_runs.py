"""What scripts/test says of a run: a test that was skipped is seen, and fails it."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import runs  # noqa: E402

# Programs without which the same tests are registered.
NOT_NEEDED = {"OCM_CCACHE", "OCM_SYSTEM_PYTHON"}
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


    def test_what_is_left_out_fails_the_run(self):
        with tempfile.TemporaryDirectory() as folder:
            left_out, junit = os.path.join(folder, "left_out.txt"), os.path.join(folder, "junit.xml")
            with open(junit, "w", encoding="utf-8") as file:
                file.write('<testsuite><testcase name="unit_can" status="run" time="1"/></testsuite>')
            for text, code in (("qemu_*\tno qemu-system-arm\nreadme\tno jq\n", 1), ("", 0)):
                with open(left_out, "w", encoding="utf-8") as file:
                    file.write(text)
                done = subprocess.run([sys.executable, "-B", RUNS, "report", "--left-out", left_out, "--left-out", left_out, junit],
                                      capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, code, done.stdout + done.stderr)
                self.assertEqual(done.stdout.count("  left out: qemu_*: no qemu-system-arm\n  left out: readme: no jq\n"), code)
                self.assertEqual("tests are left out because a program is missing" in done.stdout, bool(code))


class Registered(unittest.TestCase):
    """A suite that needs a program which may be missing says so: tests/CMakeLists.txt collects what is left out."""

    def test_each_program_that_is_not_required(self):
        root = pathlib.Path(__file__).resolve().parent
        seen = 0
        for file in sorted(root.rglob("CMakeLists.txt")):
            text = file.read_text(encoding="utf-8")
            for variable, options in re.findall(r"\bfind_(?:program|path|library)\((\w+)([^)]*)\)", text):
                if "REQUIRED" in options or variable in NOT_NEEDED:
                    continue
                seen += 1
                with self.subTest(file=str(file.relative_to(root)), variable=variable):
                    guard = re.search(rf"\bif\([^)]*\b{variable}\b[^)]*\)(.*?)\nendif\(\)", text, re.DOTALL)
                    self.assertTrue(guard and "ocm_leave_out(" in guard[1])
        self.assertGreaterEqual(seen, 15)


class Programs(unittest.TestCase):
    def programs(self, labels, tests):
        done = subprocess.run([sys.executable, "-B", RUNS, "programs", os.environ["BUILD"], labels, tests], capture_output=True, text=True,
                              check=True)
        return done.stdout.split()

    def test_a_program_that_only_the_environment_names(self):
        self.assertEqual(self.programs("no such label", "^cli_bus$"),
                         ["amiroctl", "examples/example_5_board_on_sim", "examples/example_5_operator"])

    def test_tests_are_chosen_as_ctest_does(self):
        self.assertEqual(self.programs("no such label", "^unit_ca|^unit_base$"), ["unit_base", "unit_can"])
        self.assertEqual(self.programs("lon", "^(unit_can|unit_log)$"), ["unit_can"])  # unit_log has the label long
        self.assertEqual(self.programs("long", "^no test$"), [])

    def test_all_without_some(self):
        def shown(tests):
            done = subprocess.run([sys.executable, "-B", RUNS, "without", os.environ["BUILD"], "^slow$", tests], capture_output=True,
                                  text=True, check=True)
            return done.stdout.splitlines()
        pattern, *targets = shown("^(unit_can|cli_bus|cli_goto_radio)$")  # the last one is slow, and stays
        self.assertEqual(pattern, "^(cli_bus|unit_can)$")
        self.assertNotIn("unit_can", targets)
        self.assertIn("unit_base", targets)
        self.assertIn("amiroctl", targets, "other tests run it, too")
        self.assertIn("examples/example_1_frames", targets, "no test runs it, and it is compiled")

    def test_what_runs_once_runs_with_sanitizers(self):
        text = pathlib.Path(RUNS).parent.parent.joinpath("scripts", "test").read_text(encoding="utf-8")
        variables = dict(re.findall(r"^(others|in_sanitize|once)='(.*)'$", text, re.MULTILINE))
        once = runs.those(runs.known(os.environ["BUILD"]), variables["others"], variables["once"])
        self.assertGreater(len(once), 20)
        self.assertEqual({name for name in once if not re.search(variables["in_sanitize"], name)}, set())

    def test_paths_may_have_blanks(self):
        with tempfile.TemporaryDirectory(prefix="a tree ") as folder:
            with open(os.path.join(folder, "CTestTestfile.cmake"), "w", encoding="utf-8") as file:
                file.write(f'add_test(unit_can "{folder}/unit_can")\n'
                           f'set_tests_properties(unit_can PROPERTIES  ENVIRONMENT "AMIROCTL={folder}/amiroctl;N=1")\n'
                           f'add_test(unit_base "{folder}/unit_base")\n')
            found = runs.paths(folder, {"unit_can"})
        self.assertLessEqual({f"{folder}/unit_can", f"{folder}/amiroctl"}, found)
        self.assertNotIn(f"{folder}/unit_base", found)


if __name__ == "__main__":
    unittest.main()
