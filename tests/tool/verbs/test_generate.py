"""amiroctl generate: the same bytes as ocm-generate, from the compiled-in spec or another."""

import json
import os
import pathlib
import subprocess

import harness

TARGETS = ("cpp", "dbc", "c", "markdown", "wireshark", "json-schema")
TOPICS_ONLY = ()  # of these
SPEC = os.path.join(harness.SOURCE, "spec", "topics.json")
CAR = os.path.join(harness.SOURCE, "examples", "small_car.dbc")
TOOL = os.path.join(os.path.dirname(harness.AMIROCTL), "ocm-generate")
OTHER = os.path.join(harness.SOURCE, "examples", "other-robot", "topics.json")


class Generate(harness.Case):
    def bytes_of(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, check=True, timeout=30).stdout

    def test_the_same_bytes_as_ocm_generate(self):
        for target, *options in [(name,) for name in TARGETS] + [("dbc", "--priority", "low")]:
            own = self.bytes_of(harness.AMIROCTL, "generate", target, *options)
            self.assertEqual(own, self.bytes_of(TOOL, SPEC, "--to", target, *options, "-o", "-"), target)
            other = self.bytes_of(harness.AMIROCTL, "--spec", OTHER, "generate", target, *options)
            self.assertEqual(other, self.bytes_of(TOOL, OTHER, "--to", target, *options, "-o", "-"), target)
            self.assertNotEqual(own, other)

    def test_a_file_is_replaced(self):
        path = os.path.join(self.folder, "amiro.dbc")
        with open(path, "w", encoding="utf-8") as file:
            file.write("the old one")
        self.assertEqual(self.run_tool("generate", "dbc", "-o", path), ("", ""))
        with open(path, encoding="utf-8") as file:
            self.assertTrue(file.read().startswith("VERSION"))
        self.assertEqual(os.listdir(self.folder), ["amiro.dbc"])

    def test_no_output_replaces_the_spec(self):
        path = os.path.join(self.folder, "car.dbc")
        with open(CAR, "rb") as file:
            text = file.read()
        with open(path, "wb") as file:
            file.write(text)
        log = os.path.join(self.folder, "drive.log")
        with open(log, "w", encoding="ascii") as file:
            file.write("(1.000000) can0 123#11\n")
        for words in (("generate", "dbc", "-o", path), ("convert", log, path, "--to", "candump", "--force"),
                      ("encode", log, "-o", path, "--to", "candump", "--force"),
                      ("record", "-o", path, "--to", "candump", "--force")):
            for spec in (path,) if words[0] == "generate" else (path, f"can0={path}"):  # which is about no bus
                _, err = self.run_tool("--spec", spec, "--bus", "can0", *words, code=2)
                self.assertIn(f"amiroctl: {words[0]}: {path} and {path} are the same file\n", err, words)
        with open(path, "rb") as file:
            self.assertEqual(file.read(), text)

    def test_mistakes(self):
        for arguments, code, words in ((("pdf",), 2, "one of: cpp, spec, dbc, c, markdown, wireshark, json-schema"),
                                       (("dbc", "--priority", "big"), 2, "urgent, high, medium or low"),
                                       (("c", "--priority", "high"), 2, "--priority is for dbc"),
                                       ((), 2, "missing TARGET"), (("dbc", "-o", "/no/such/folder/x"), 1, "a folder that exists"),
                                       (("dbc", "-o", "/dev/full"), 1, "No space left")):
            out, err = self.run_tool("generate", *arguments, code=code)
            self.assertEqual(out, "")
            self.assertIn(words, err)
        _, err = self.run_tool("--spec", "/no/such/spec.json", "generate", "dbc", code=1)
        self.assertIn("/no/such/spec.json: there is no such file", err)

    def test_every_target_has_the_messages(self):
        for target in TOPICS_ONLY:
            _, err = self.run_tool("--spec", CAR, "generate", target, code=1)
            self.assertIn("has only messages, which it has no place for", err)
        for target in sorted(set(TARGETS) - set(TOPICS_ONLY)):
            path = os.path.join(self.folder, "file")
            self.assertEqual(self.run_tool("--spec", CAR, "generate", target, "-o", path), ("", ""))
            text = pathlib.Path(path).read_bytes()
            self.assertIn(b"Transmission", text)
            self.assertEqual(text, self.bytes_of(TOOL, CAR, "--to", target, "-o", "-"))
            self.assertEqual(self.run_tool("--spec", SPEC, "--spec", CAR, "generate", target, "-o", path), ("", ""))
            for word in (b"Transmission", b"Gyroscope" if target in ("cpp", "dbc") else b"gyroscope"):
                self.assertIn(word, pathlib.Path(path).read_bytes(), target)

    def test_headers_of_both_compile(self):
        for target, compiler, name in (("c", ["gcc", "-std=c99"], "both.h"), ("cpp", ["g++", "-std=c++20", f"-I{harness.SOURCE}/include"], "both.hpp")):
            path = os.path.join(self.folder, name)
            self.run_tool("--spec", SPEC, "--spec", CAR, "generate", target, "-o", path)
            main = os.path.join(self.folder, f"main{'.c' if target == 'c' else '.cpp'}")
            pathlib.Path(main).write_text(f'#include "{name}"\nint main(void) {{ return 0; }}\n', encoding="ascii")
            subprocess.run([*compiler, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", main], check=True, timeout=120)

    def test_topics_are_not_left_out_without_a_word(self):
        out, err = self.run_tool("--spec", SPEC, "--spec", CAR, "generate", "spec")
        self.assertIn("Transmission", out)
        self.assertRegex(err, "^generate spec: left out: all [0-9]+ topics\n$")
        _, err = self.run_tool("--spec", SPEC, "generate", "spec", code=1)
        self.assertIn("generate spec: topics.json has only topics, which it has no place for\n          topics are in the spec already", err)

    def test_a_dbc_file_becomes_a_spec_that_every_verb_takes_for_it(self):
        spec, back = os.path.join(self.folder, "small_car.json"), os.path.join(self.folder, "small_car.dbc")
        self.assertEqual(self.run_tool("--spec", CAR, "generate", "spec", "-o", spec), ("", ""))
        self.assertEqual(self.run_tool("--spec", spec, "generate", "dbc", "-o", back), ("", ""))
        self.assertEqual(self.bytes_of(TOOL, CAR, "--to", "spec", "-o", "-"), pathlib.Path(spec).read_bytes())
        frames = "(0.0) can0 100#00112233445566FF\n(0.1) can0 200#0102030405060708\n(0.2) can0 1A0#0102030405060708\n"
        log = os.path.join(self.folder, "drive.log")
        pathlib.Path(log).write_text(frames, encoding="ascii")
        for arguments in (("list",), ("list", "--json"), ("decode", log), ("decode", log, "--json")):
            with self.subTest(arguments=arguments):
                as_dbc = self.run_tool("--spec", CAR, *arguments)
                self.assertEqual(self.run_tool("--spec", spec, *arguments), as_dbc)
                self.assertEqual(self.run_tool("--spec", back, *arguments), as_dbc)

    def test_topics_and_messages_in_one_dbc_file(self):
        both = os.path.join(self.folder, "both.dbc")
        self.run_tool("--spec", SPEC, "--spec", CAR, "generate", "dbc", "--priority", "medium", "-o", both)
        listed = json.loads("[" + ",".join(self.run_tool("--spec", both, "list", "--json")[0].splitlines()) + "]")
        names = {each.get("topic") or each.get("name") for each in listed}
        self.assertIn("Gyroscope", names)
        self.assertIn("Wheels", names)


if __name__ == "__main__":
    harness.main()
