"""binary.py sees what is wrong with a program. argv[1]: arm-linux-gnueabihf-g++."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import binary

COMPILER = sys.argv.pop(1)
RIGHT = ("-mcpu=cortex-a8", "-mfpu=neon", "-mfloat-abi=hard", "-static", "-s")


class Binary(unittest.TestCase):
    def compile(self, *options, libraries=True):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "main.cpp")
            source.write_text("int main() {}\n" if libraries else 'extern "C" void _start() {}\n', encoding="utf-8")
            program = pathlib.Path(folder, "program")
            subprocess.run([COMPILER, *options, *(() if libraries else ("-nostdlib",)), source, "-o", program],
                           check=True)
            return program.read_bytes()

    def wrong(self, image):
        return "\n".join(binary.problems(image))

    def test_what_is_right(self):
        self.assertEqual(self.wrong(self.compile(*RIGHT)), "")

    def test_of_the_host(self):
        self.assertIn("ELF", self.wrong(pathlib.Path(sys.executable).resolve().read_bytes()))

    def test_dynamic(self):
        self.assertIn("not static", self.wrong(self.compile(*RIGHT[:3], "-s")))

    def test_with_symbols(self):
        self.assertIn("not stripped", self.wrong(self.compile(*RIGHT[:4])))

    def test_another_architecture(self):
        image = self.compile("-march=armv6", "-marm", "-mfloat-abi=soft", "-static", "-s", libraries=False)
        self.assertIn("not for ARMv7-A", self.wrong(image))

    def test_soft_float(self):
        image = self.compile("-mcpu=cortex-a8", "-mfloat-abi=soft", "-static", "-s", libraries=False)
        self.assertIn("integer registers", self.wrong(image))
        self.assertIn("attributes do not say", self.wrong(image))

    def test_large(self):
        image = self.compile(*RIGHT)
        self.assertEqual(self.wrong(image.ljust(binary.LIMIT - 1, b"\0")), "")
        self.assertIn("not under", self.wrong(image.ljust(binary.LIMIT, b"\0")))


if __name__ == "__main__":
    unittest.main()
