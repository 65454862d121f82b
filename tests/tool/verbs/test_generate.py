"""amiroctl generate: the same bytes as ocm-generate, from the compiled-in spec or another."""

import os
import subprocess

import harness

TARGETS = ("cpp", "dbc", "c", "markdown", "wireshark", "json-schema")
SPEC = os.path.join(harness.SOURCE, "spec", "topics.json")
OTHER = os.path.join(harness.SOURCE, "examples", "other-robot", "topics.json")


class Generate(harness.Case):
    def bytes_of(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, check=True, timeout=30).stdout

    def test_the_same_bytes_as_ocm_generate(self):
        tool = os.path.join(os.path.dirname(harness.AMIROCTL), "ocm-generate")
        for target, *options in [(name,) for name in TARGETS] + [("dbc", "--priority", "low")]:
            own = self.bytes_of(harness.AMIROCTL, "generate", target, *options)
            self.assertEqual(own, self.bytes_of(tool, SPEC, "--to", target, *options, "-o", "-"), target)
            other = self.bytes_of(harness.AMIROCTL, "--spec", OTHER, "generate", target, *options)
            self.assertEqual(other, self.bytes_of(tool, OTHER, "--to", target, *options, "-o", "-"), target)
            self.assertNotEqual(own, other)

    def test_a_file_is_replaced(self):
        path = os.path.join(self.folder, "amiro.dbc")
        with open(path, "w", encoding="utf-8") as file:
            file.write("the old one")
        self.assertEqual(self.run_tool("generate", "dbc", "-o", path), ("", ""))
        with open(path, encoding="utf-8") as file:
            self.assertTrue(file.read().startswith("VERSION"))
        self.assertEqual(os.listdir(self.folder), ["amiro.dbc"])

    def test_mistakes(self):
        for arguments, code, words in ((("pdf",), 2, "one of: cpp, dbc, c, markdown, wireshark, json-schema"),
                                       (("dbc", "--priority", "big"), 2, "urgent, high, medium or low"),
                                       (("c", "--priority", "high"), 2, "--priority is for dbc"),
                                       ((), 2, "missing TARGET"), (("dbc", "-o", "/no/such/folder/x"), 1, "a folder that exists"),
                                       (("dbc", "-o", "/dev/full"), 1, "No space left")):
            out, err = self.run_tool("generate", *arguments, code=code)
            self.assertEqual(out, "")
            self.assertIn(words, err)
        _, err = self.run_tool("--spec", "/no/such/spec.json", "generate", "dbc", code=1)
        self.assertIn("/no/such/spec.json: there is no such file", err)

    def test_messages_are_not_left_out_without_a_word(self):
        car = os.path.join(harness.SOURCE, "examples", "small_car.dbc")
        out, err = self.run_tool("--spec", car, "generate", "c", code=1)
        self.assertEqual((out, err), ("", "amiroctl: generate c: small_car.dbc has no topics, only messages\n"
                                          "          files are made from topics; messages cannot be written yet\n"))
        robot = os.path.join(harness.SOURCE, "spec", "topics.json")
        out, err = self.run_tool("--spec", robot, "--spec", car, "generate", "c")
        self.assertIn("gyroscope", out)
        self.assertEqual(err, "generate c: the messages of the spec are left out, 11 of them: files are made from topics\n")


if __name__ == "__main__":
    harness.main()
