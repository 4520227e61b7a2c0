#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""integrating_test.py PYTHON_PACKAGE PYTHON: docs/integrating.md as it stands: its commands make its programs run in a fresh folder,
its programs are those of lib/examples, and its table of statuses is the whole of them."""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs/integrating.md").read_text()
BLOB = max((ROOT / "tests/blob/golden").glob("written-arithmetic-*.blob"), key=lambda path: int(path.name.split("-")[2]))


def block(language):
    return re.search(rf"```{language}\n(.*?)```", PAGE, re.S).group(1)


class Integrating(unittest.TestCase):
    def run_(self, command, folder, **options):
        done = subprocess.run(command, shell=True, cwd=folder, capture_output=True, text=True, **options)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}{done.stderr}")
        return done.stdout

    def test_programs_are_the_examples(self):
        self.assertEqual(block("cpp"), (ROOT / "lib/examples/loop.cpp").read_text())
        self.assertEqual(block("c"), (ROOT / "lib/examples/loop.c").read_text())
        for language in ("cpp", "c"):  # of the body, braces and blank lines aside
            lines = [line for line in block(language).partition("int main")[2].splitlines()[1:] if line.strip(" }")]
            self.assertLessEqual(len(lines), 15, language)

    def test_commands_make_a_loop_that_runs(self):
        text = re.sub(r"```.*?```", "", PAGE.partition("## Other ways in")[0], flags=re.S)
        commands = re.findall(r"^    (\S.*)$", text, re.M)
        self.assertEqual(len(commands), 5)
        with tempfile.TemporaryDirectory() as folder:
            here = pathlib.Path(folder)
            (here / "mdhcal").symlink_to(ROOT)
            (here / "calibration.blob").write_bytes(BLOB.read_bytes())
            for language in ("cpp", "c"):
                (here / f"loop.{language}").write_text(block(language))
            output = [self.run_(command, here, timeout=300) for command in commands]
            self.assertRegex(output[2], r"^joint 1 at 0\.\d{6} rad\n$")
            self.assertEqual(self.run_(commands[2], here), output[2])  # the one in C, linked last
            self.run_(f"{PYTHON} - <<'END'\n{block('python')}\nassert (every.count > 0).all() and (path.status == 0).all()\n"
                      "assert (there.status == 0).all()\nEND\n", here, env={"PYTHONPATH": PACKAGE})

    def test_table_of_statuses_is_whole(self):
        text = (ROOT / "lib/include/mdhcal/status.hpp").read_text()
        wanted = re.findall(r"^  (\w+) = (\d+),", text, re.M)
        self.assertGreater(len(wanted), 25)
        self.assertEqual([(name, number) for number, name in re.findall(r"^\| (\d+) \| `(\w+)` \|", PAGE, re.M)], wanted)


if __name__ == "__main__":
    PACKAGE, PYTHON = sys.argv[1:3]
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
