#!/usr/bin/env python3
"""The sweep, checked: what it takes for a failure, and what for a success."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import sweep

BAD = (1, "error: no match for 'operator+'")
REFUSED = "// Why.\n// expect: no match\nint a;\n#ifdef OCM_MUST_FAIL\n#endif\n"


class Refused(unittest.TestCase):
    def judged(self, text=REFUSED, said=BAD, compiler="g++"):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "case.cpp")
            path.write_text(text)
            return sweep.judge(path, sweep.phrase(path, compiler), *said)

    def test_is_refused_as_announced(self):
        self.assertIsNone(self.judged())

    def test_nothing_is_refused(self):
        self.assertIn("must not compile, and it does", self.judged(said=(0, "")))

    def test_refused_for_another_reason(self):
        self.assertIn("without the words 'no match'", self.judged(said=(1, "error: expected ';'")))

    def test_no_phrase(self):
        self.assertIn("no '// expect: '", self.judged(REFUSED.replace("expect", "hope")))

    def test_no_twin(self):
        self.assertIn("no #ifdef OCM_MUST_FAIL", self.judged(REFUSED.replace("OCM_MUST_FAIL", "NDEBUG")))

    def test_a_phrase_for_each_compiler(self):
        text = REFUSED.replace("// expect: no match", "// expect g++: no match\n// expect clang++: invalid operands")
        self.assertIsNone(self.judged(text))
        self.assertIn("'invalid operands'", self.judged(text, compiler="clang++-14"))
        self.assertIsNone(self.judged(text, said=(1, "error: invalid operands to"), compiler="clang++-14"))


class Symbols(unittest.TestCase):
    def test_what_a_board_cannot_have(self):
        for name in ("_Znwj", "_Znaj", "_ZdlPvj", "malloc", "free", "abort", "__cxa_throw", "__cxa_guard_acquire",
                     "_Unwind_Resume", "__dynamic_cast", "_ZTISt9exception", "_ZSt20__throw_length_errorPKc",
                     "__gxx_personality_v0", "_ZNSo3putEc", "printf"):
            self.assertTrue(sweep.FORBIDDEN.search(name), name)

    def test_what_it_can(self):
        for name in ("memcpy", "memset", "__aeabi_lmul", "__aeabi_dadd", "__gnu_thumb1_case_uqi", "cos", "fmod",
                     "__cxa_pure_virtual", "_ZN3Can4sendERKN3ocm3can5FrameE", "_ZN6Bottom9gyroscopeEv"):
            self.assertFalse(sweep.FORBIDDEN.search(name), name)


class Commands(unittest.TestCase):
    """Through ninja and a real compiler: one header that needs another, one file that allocates."""

    def alone(self, header, text):
        """Two headers compiled alone; what each compiler says, in words where it complains."""
        for compiler in (sweep.GCC, sweep.CLANG):
            with tempfile.TemporaryDirectory() as folder:
                ninja = sweep.Ninja(pathlib.Path(folder), "-Wall", [pathlib.Path(folder)])
                ninja.source("count.hpp", "#pragma once\n#include <cstdint>\nusing Count = std::uint8_t;\n")
                ninja.source(header, text)
                ninja.alone("alone", compiler, ["count.hpp", header])
                (ninja.folder / "build.ninja").write_text("\n".join(ninja.lines) + "\n")
                done = subprocess.run(["ninja", "-C", folder, "--quiet", "-k", "0"], capture_output=True, text=True)
                yield done.stdout if done.returncode else ""

    def test_a_header_that_does_not_bring_what_it_uses(self):
        for said in self.alone("bad.hpp", "#pragma once\nCount number;\n"):
            self.assertIn("bad.hpp:2:", said)

    def test_a_header_without_guard(self):
        for said in self.alone("bad.hpp", "struct S {};\n"):
            self.assertIn("bad.hpp:1:", said)

    def test_a_good_header(self):
        for said in self.alone("good.hpp", '#pragma once\n#include "count.hpp"\nstruct S {\n  Count all;\n  std::uint8_t one;\n};\n'):
            self.assertEqual(said, "")

    @unittest.skipUnless(sweep.shutil.which(sweep.ARM), "arm-none-eabi-g++ is not installed")
    def test_an_object_that_allocates(self):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "heap.cpp")
            source.write_text("int* make() { return new int; }\n")
            made = source.with_suffix(".o")
            subprocess.run([*sweep.CORES["m0"].split(), "-c", str(source), "-o", str(made)], check=True)
            done = subprocess.run([sys.executable, "-B", str(sweep.HERE / "sweep.py"), "symbols", "--object", str(made)],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn("needs _Znwj", done.stdout)


class Lists(unittest.TestCase):
    def test_the_lists_come_from_the_tree(self):
        self.assertIn("ocm/can/frame.hpp", list(sweep.library()))
        self.assertNotIn("ocm/transport/bus.hpp", list(sweep.library(sweep.on_board())))
        self.assertLessEqual({"base", "can", "protocol", "topics", "scheduling", "controller"}, sweep.on_board())


if __name__ == "__main__":
    unittest.main()
