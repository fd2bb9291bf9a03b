"""Runs the examples of docs/python.md, and compares the code in docs/plugins.md with the file it is."""

import contextlib
import io
import os
import pathlib
import re
import tempfile
import unittest

import tri

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Guides(unittest.TestCase):
    @unittest.skipUnless(hasattr(tri, "Model"), "built without OpenCASCADE")
    def test_python(self):
        examples = re.findall(r"```python\n(.*?)```", (ROOT / "docs/python.md").read_text(), re.S)
        self.assertGreater(len(examples), 4)
        names, before = {}, os.getcwd()
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            os.chdir(folder)
            try:
                for example in examples:
                    exec(compile(example, "docs/python.md", "exec"), names)
            finally:
                os.chdir(before)

    def test_plugins(self):
        code = re.search(r"```cpp\n(.*?)```", (ROOT / "docs/plugins.md").read_text(), re.S).group(1)
        self.assertEqual(code, (ROOT / "tests/plugin/scale.cpp").read_text())


if __name__ == "__main__":
    unittest.main()
