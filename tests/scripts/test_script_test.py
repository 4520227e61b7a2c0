# SPDX-License-Identifier: MIT
"""cmake/test.sh: whichever step fails, it fails; it never says "Passed" of tests that did not run.

The script runs on a copy of the project's scripts, with programs in the PATH that only note their call and end with the
status that the test wants."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIST = 'Available test presets:\n\n  "host"\n  "cortex-m7" - lib and port\n'


class TestScript(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        shutil.copytree(ROOT / "cmake", self.folder / "cmake")
        self.bin = self.folder / "bin"
        self.bin.mkdir()
        # A program fails if the variable FAIL is the first letters of its call.
        for program in ("cmake", "ctest", "dpkg-query", "apt-get"):
            path = self.bin / program
            path.write_text('#!/bin/sh\ncall="${0##*/} $*"\necho "$call" >>"$CALLS"\n'
                            'case "$call" in "$FAIL"*) echo "broken" >&2; exit 7;; esac\n'
                            'case "$call" in "cmake --list-presets"*) printf "%s" "$LIST";;\n'
                            'dpkg-query*) printf "install ok installed";; esac\n')
            path.chmod(0o755)

    def run_script(self, *presets, fail="no call begins so", listed=LIST):
        calls = self.folder / "calls"
        calls.write_text("")
        environment = {"PATH": f"{self.bin}:{os.environ['PATH']}", "CALLS": str(calls), "FAIL": fail, "LIST": listed}
        done = subprocess.run(["bash", self.folder / "cmake/test.sh", *presets], env=environment, capture_output=True, text=True,
                              timeout=60)
        return done, calls.read_text().splitlines()

    def expect_failure(self, *presets, **how):
        done, calls = self.run_script(*presets, **how)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        self.assertNotIn("Passed", done.stdout + done.stderr)
        self.assertNotEqual(done.stderr, "")
        return done, calls

    def test_every_listed_preset_is_configured_built_and_tested(self):
        done, calls = self.run_script()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(done.stdout.endswith("Passed: host cortex-m7\n"), done.stdout)
        for preset in ("host", "cortex-m7"):
            self.assertTrue(any(call.startswith(f"cmake --preset {preset}") for call in calls))
            self.assertTrue(any(call.startswith(f"cmake --build build/{preset}") for call in calls))
            # Zero tests are an error, whatever a preset says.
            self.assertTrue(any(call.startswith(f"ctest --preset {preset} --no-tests=error") for call in calls))

    def test_a_step_that_fails_is_a_failure(self):
        self.expect_failure(fail="cmake --list-presets")
        for preset in ("host", "cortex-m7"):
            for step in (f"cmake --preset {preset}", f"cmake --build build/{preset}", f"ctest --preset {preset}"):
                with self.subTest(step):
                    done, _ = self.expect_failure(fail=step)
                    self.assertIn(f"Failed: {preset}\n", done.stderr)
        self.expect_failure("host", fail="ctest")

    def test_no_preset_is_a_failure(self):
        for listed in ("", "Available test presets:\n"):
            self.expect_failure(listed=listed)

    def test_a_list_of_packages_that_is_missing_or_empty_is_a_failure(self):
        packages = self.folder / "cmake/packages.txt"
        packages.write_text("# nothing\n")
        self.expect_failure()
        packages.unlink()
        self.expect_failure("host")

    def test_a_package_that_cannot_be_installed_is_a_failure(self):
        (self.bin / "sudo").write_text("#!/bin/sh\nexec \"$@\"\n")
        (self.bin / "sudo").chmod(0o755)
        (self.bin / "dpkg-query").write_text("#!/bin/sh\nexit 1\n")
        self.expect_failure("host", fail="apt-get install")


if __name__ == "__main__":
    unittest.main()
