"""What Python tests wait with: what a program prints is whole, however often it is looked at meanwhile."""

import subprocess
import sys
import tempfile
import unittest

import waiting


class Printed(unittest.TestCase):
    def test_looking_at_it_changes_nothing(self):
        text = "import os\nfor i in range(20000): os.write(1, b'%d\\n' % i)"
        with tempfile.TemporaryFile() as file, subprocess.Popen([sys.executable, "-c", text], stdout=file) as program:
            looks = 0
            while program.poll() is None:
                self.assertTrue("".join(f"{i}\n" for i in range(20000)).startswith(waiting.printed(file)))
                looks += 1
            self.assertEqual(waiting.printed(file), "".join(f"{i}\n" for i in range(20000)))
        self.assertGreater(looks, 3)


if __name__ == "__main__":
    unittest.main()
