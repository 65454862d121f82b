#!/usr/bin/env python3
"""The follower of how-to pages against planted pages: good ones change the copy only, bad ones are found."""
import os
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import follow  # noqa: E402

LIST = "first\nsecond\nthird\nsecond to last\n"


class Follow(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        top = pathlib.Path(self.scratch.name)
        self.project, self.root, self.build = top / "project", top / "copy", top / "built"
        self.project.mkdir()
        self.root.mkdir()
        self.build.mkdir()
        (self.project / "list.txt").write_text(LIST)
        (self.build / "tool").write_text("#!/bin/sh\necho tool > said.txt\n")
        (self.build / "tool").chmod(0o755)

    def follow(self, text, not_run=None):
        page = pathlib.Path(self.scratch.name, "page.md")
        page.write_text(text)
        follow.follow(page, self.project, self.build, self.root, not_run)

    def fails(self, text, line, message, not_run=None):
        """Of a page that names its files in its first line."""
        with self.assertRaises(follow.PageError) as failure:
            self.follow("`list.txt`, `away.txt` and `../out.txt`:\n" + text, not_run)
        self.assertIn(f"page.md:{line + 1}: ", str(failure.exception))
        self.assertIn(message, str(failure.exception))

    def test_a_good_page(self):
        self.follow("""# A page with `new/a.txt`
<!-- file: new/a.txt -->
```text
one
<!-- run -->
```
In [list.txt](elsewhere.txt):
<!-- insert: list.txt after: "third" -->
```
3b
```
<!-- insert: list.txt before: "third" -->
```
3a
```
<!-- replace: list.txt line: "first" -->
```
1
```
<!-- insert: list.txt after: "3a" +2 -->
```
3c
```
<!-- append: list.txt -->
```
last
```
1. Indented:
   <!-- run -->
   ```sh
   grep -q '^one$' new/a.txt
   tool
   build/tool
   ```

```sh
exit 1  # for the reader only
```
<!-- check
grep -q '^1$' list.txt
touch checked
-->
""")
        self.assertEqual((self.root / "list.txt").read_text(), "1\nsecond\n3a\nthird\n3b\n3c\nsecond to last\nlast\n")
        self.assertEqual((self.root / "new/a.txt").read_text(), "one\n<!-- run -->\n")
        self.assertEqual((self.root / "said.txt").read_text(), "tool\n")
        self.assertTrue((self.root / "checked").exists())
        self.assertEqual((self.project / "list.txt").read_text(), LIST)
        self.assertFalse((self.project / "new").exists())

    def test_a_missing_insertion_point(self):
        self.fails('<!-- insert: list.txt after: "fourth" -->\n```\nx\n```\n<!-- run -->\n```\ntrue\n```\n', 1,
                   '0 lines of list.txt contain "fourth"')

    def test_an_ambiguous_insertion_point(self):
        self.fails('\n<!-- insert: list.txt after: "second" -->\n```\nx\n```\n<!-- run -->\n```\ntrue\n```\n', 2,
                   '2 lines of list.txt contain "second"')

    def test_a_failing_command(self):
        self.fails("<!-- run -->\n```\ntrue\nfalse\ntouch after\n```\n", 1, "exit status 1")
        self.assertFalse((self.root / "after").exists())

    def test_a_failing_check(self):
        self.fails("\n<!-- check\nfalse\n-->\n", 2, "exit status 1")

    def test_a_file_that_exists(self):
        self.fails("<!-- file: list.txt -->\n```\nx\n```\n<!-- run -->\n```\ntrue\n```\n", 1, "exists already")

    def test_a_file_that_is_missing(self):
        self.fails("<!-- append: away.txt -->\n```\nx\n```\n<!-- run -->\n```\ntrue\n```\n", 1, "no file away.txt")

    def test_a_file_outside_of_the_project(self):
        self.fails("<!-- file: ../out.txt -->\n```\nx\n```\n<!-- run -->\n```\ntrue\n```\n", 1, "outside")

    def test_a_file_that_the_text_does_not_name(self):
        mark = "<!-- append: list.txt -->\n```\nlist.txt\n```\n"
        run = "<!-- run -->\n```\ntrue\n```\n"
        other = "\n`new.txt`\n<!-- file: new.txt -->\n```\nx\n```\n"
        for before in ("", "In [the list](list.txt):\n", "<!-- list.txt -->\n", "```\nlist.txt\n```\n", "In `my-list.txt`:\n",
                       "In `list.txt.old`:\n", "In `a/list.txt`:\n", "In `list.txt`" + other):
            with self.assertRaises(follow.PageError) as failure:
                self.follow(before + mark + run)
            self.assertIn(f"page.md:{before.count(chr(10)) + 1}: the text before the mark does not name list.txt",
                          str(failure.exception))
        for before in ("In `list.txt`:\n", "In list.txt.\n", other + "In `list.txt`:\n", "In `list.txt`:\n" + mark + run):
            self.follow(before + mark + run)
            self.setUp()

    def test_a_mark_without_a_block(self):
        self.fails("<!-- run -->\n\n```\ntrue\n```\n", 1, "no fenced block follows")

    def test_a_block_without_an_end(self):
        self.fails("<!-- run -->\n```\ntrue\n", 1, "not closed")
        self.fails("<!-- check\ntrue\n", 1, "not closed")

    def test_a_mark_with_a_mistake(self):
        for mark in ('<!-- insert: list.txt -->', '<!-- insert: list.txt line: "a" -->', "<!-- run: x -->", "<!-- check -->", "<!-- run x -->",
                     "<!-- beside -->", "<!-- not run -->", "<!-- not run: -->", "<!-- interrupt all -->",
                     '<!-- file: a after: "x" -->', '<!-- replace: a after: "x" -->', '<!-- insert: a before: "x" +1 -->'):
            self.fails(f"{mark}\n```\ntrue\n```\n", 1, "unknown mark")

    BESIDE = """<!-- beside until: "ready" -->
```sh
trap 'echo interrupted >> said.txt; exit {code}' INT
echo ready
while :; do sleep 0.01; done
```
"""

    def test_commands_of_another_terminal_go_on_until_they_are_interrupted(self):
        self.follow(self.BESIDE.format(code=130) + """
<!-- run NAME=value -->
```
test ! -e said.txt
test $NAME = value
```
<!-- interrupt -->
<!-- run -->
```
grep -q interrupted said.txt
test -z "$NAME"
```
""" + self.BESIDE.format(code=0))
        self.assertEqual((self.root / "said.txt").read_text(), "interrupted\n" * 2)  # at the end those that are left

    def test_commands_of_another_terminal_that_go_wrong(self):
        run = "<!-- run -->\n```\ntrue\n```\n"
        self.fails(self.BESIDE.format(code=3) + run, 1, "ended with 3")
        self.setUp()
        self.fails('<!-- beside until: "ready" -->\n```\necho not yet\n```\n' + run, 1, "'ready' was not printed, but: not yet")
        self.setUp()
        self.fails(run + "<!-- interrupt -->\n", 5, "nothing to interrupt")

    def test_a_page_that_fails_leaves_nothing_running(self):
        self.fails(self.BESIDE.format(code=130) + "<!-- run -->\n```\nfalse\n```\n", 7, "exit status 1")
        self.assertEqual((self.root / "said.txt").read_text(), "interrupted\n")

    def test_a_transcript(self):
        self.follow("<!-- transcript -->\n```console\n$ echo a; echo b\na\nb\n$ true\n```\n")
        for text, what in (("$ echo a\nb\n", "prints 'a"), ("$ false\n", "exit status 1"), ("echo a\n", "a transcript is")):
            self.setUp()
            self.fails(f"<!-- transcript -->\n```console\n{text}```\n", 1, what)

    def test_nothing_of_the_user_reaches_the_commands(self):
        os.environ["AMIROCTL_BUS"] = "can0"
        self.addCleanup(os.environ.pop, "AMIROCTL_BUS")
        self.follow('<!-- run -->\n```\ntest -z "$AMIROCTL_BUS"\ntest -d "$XDG_RUNTIME_DIR"\n'
                    f'test "$XDG_RUNTIME_DIR" != "{os.environ.get("XDG_RUNTIME_DIR")}"\n```\n')

    def test_every_block_of_commands_has_a_mark(self):
        good = "<!-- run -->\n```sh\ntrue\n```\n<!-- not run: needs a robot -->\n```sh\nfalse\n```\n```json\n{}\n```\n"
        self.follow(good, 1)
        self.fails(good, 0, "1 blocks are not run; expected 2", 2)
        for left in (good.replace("<!-- not run: needs a robot -->\n", "\n"), good + "\n```console\n$ true\n```\n"):
            self.fails(left, left[:left.rfind("\n\n")].count("\n") + 3, "no mark", 1)
        self.fails(good + "\n    false\n", 13, "fenced block", 1)

    def test_a_page_that_checks_nothing(self):
        self.fails("<!-- append: list.txt -->\n```\nx\n```\n", 0, "nothing would be checked")


if __name__ == "__main__":
    unittest.main()
