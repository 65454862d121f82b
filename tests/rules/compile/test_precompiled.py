"""A header that is compiled once is compiled again when something that it includes has changed, with a compiler's cache too:
the cache had taken the header that is there for what it is made of."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE, COMPILER = pathlib.Path(os.environ["OCM_SOURCE_DIR"]), os.environ["OCM_COMPILER"]

PROJECT = f"""
cmake_minimum_required(VERSION 3.22)
project(one LANGUAGES CXX)
include({SOURCE}/cmake/OcmCompilerCache.cmake)
include({SOURCE}/cmake/OcmPrecompiled.cmake)
add_library(owner OBJECT owner.cpp)
add_executable(prints prints.cpp)
foreach(target owner prints)
  target_compile_options(${{target}} PRIVATE ${{OCM_PRECOMPILED_OPTIONS}})
endforeach()
ocm_precompile(owner parsed_once.hpp)
target_precompile_headers(prints REUSE_FROM owner)
"""


class Precompiled(unittest.TestCase):
    def test_what_a_precompiled_header_includes_may_change(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            environment = os.environ | {"CCACHE_DIR": str(folder / "cache")}

            def run(*command):
                return subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=300).stdout

            (folder / "CMakeLists.txt").write_text(PROJECT, encoding="utf-8")
            (folder / "parsed_once.hpp").write_text('#include "number.hpp"\n', encoding="utf-8")
            (folder / "owner.cpp").write_text("", encoding="utf-8")
            (folder / "prints.cpp").write_text("#include <cstdio>\nint main() { std::printf(\"%d\", number); }\n", encoding="utf-8")
            for number in (1, 22, 1, 333):  # as one goes from branch to branch
                (folder / "number.hpp").write_text(f"#pragma once\nconstexpr int number = {number};\n", encoding="utf-8")
                if number == 1:
                    shutil.rmtree(folder / "build", ignore_errors=True)
                    run("cmake", "-S", name, "-B", name + "/build", "-G", "Ninja", "-DCMAKE_CXX_COMPILER=" + COMPILER)
                run("cmake", "--build", name + "/build")
                self.assertEqual(run(name + "/build/prints"), str(number))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
