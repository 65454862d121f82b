"""Topics with floating-point numbers on a Cortex-M0: no heap, no exceptions; what the header calls is in the compiler's own library."""
import shutil
import subprocess
import unittest

from peers import Case, ROOT, SPECS, generate

FLAGS = ("-std=c++20 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -Os -mcpu=cortex-m0 -mthumb -fno-exceptions "
         "-fno-rtti").split()
MAIN = """#include "probe.hpp"
float force(const ocm::can::Payload& data) { return probe::Thrust::decode(data).force; }
double north(const ocm::can::Payload& data) { return probe::PositionNorth::decode(data).value_deg(); }
ocm::can::Payload thrust(double newton) {
  probe::Thrust thrust;
  thrust.set_force_N(newton);
  return thrust.encode();
}
ocm::can::Payload east(double degrees) {
  probe::PositionEast east;
  east.set_value_deg(degrees);
  return east.encode();
}
"""


class CortexM0(Case):
    def test_floats(self):
        self.assertIsNotNone(shutil.which("arm-none-eabi-g++"), "arm-none-eabi-g++ is missing: scripts/setup")
        generate(SPECS["probe"], "-o", self.folder / "probe.hpp")
        (self.folder / "main.cpp").write_text(MAIN)
        subprocess.run(["arm-none-eabi-g++", *FLAGS, f"-I{ROOT / 'include'}", f"-I{self.folder}", "-c", self.folder / "main.cpp", "-o",
                        self.folder / "main.o"], check=True, timeout=120)
        names = subprocess.run(["arm-none-eabi-nm", "-u", self.folder / "main.o"], capture_output=True, text=True, check=True).stdout
        foreign = [word for word in names.split() if not word.startswith("__aeabi_") and word not in ("U", "memcpy", "memset")]
        self.assertEqual(foreign, [])


if __name__ == "__main__":
    unittest.main()
