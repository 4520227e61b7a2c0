#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A test image that is killed must not count as passed: run_test.py MACHINE IMAGE_OF_A_TEST"""
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]


def family(process):
    children = pathlib.Path(f"/proc/{process}/task/{process}/children").read_text()
    return [process, *map(int, children.split())]


class Run(unittest.TestCase):
    def start(self, *arguments):
        """The runner and its emulator, in the middle of a test that goes on for minutes."""
        runner = subprocess.Popen([ROOT / "port/cortex_m/run.sh", MACHINE, IMAGE, *arguments], stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True, start_new_session=True)
        self.addCleanup(runner.stdout.close)
        self.addCleanup(runner.wait)
        self.addCleanup(runner.kill)
        for line in runner.stdout:
            if "RUN" in line:
                break
        emulator = [pid for pid in family(runner.pid) if "qemu" in pathlib.Path(f"/proc/{pid}/comm").read_text()]
        self.assertEqual(len(emulator), 1)
        return runner, emulator[0]

    def expect_gone(self, pid):
        for _ in range(100):
            if not pathlib.Path(f"/proc/{pid}").exists():
                return
            time.sleep(0.05)
        os.kill(pid, signal.SIGKILL)
        self.fail("the emulator outlived its runner")

    def test_an_image_that_ends_passes_its_status_on(self):
        run = lambda *arguments: subprocess.run([ROOT / "port/cortex_m/run.sh", MACHINE, IMAGE, *arguments], timeout=60,
                                                stdout=subprocess.DEVNULL).returncode
        self.assertEqual(run("--gtest_list_tests"), 0)
        self.assertEqual(run("--gtest_flagfile=none"), 1)

    def test_a_signal_to_the_emulator_is_a_failure(self):
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGKILL):
            runner, emulator = self.start("--gtest_repeat=-1")
            os.kill(emulator, number)
            self.assertNotEqual(runner.wait(timeout=30), 0, number)

    def test_a_signal_to_the_runner_ends_both(self):
        for number in (signal.SIGTERM, signal.SIGKILL):
            runner, emulator = self.start("--gtest_repeat=-1")
            os.kill(runner.pid, number)
            self.assertNotEqual(runner.wait(timeout=30), 0, number)
            self.expect_gone(emulator)

    def test_a_signal_to_all_of_them_is_a_failure(self):
        runner, emulator = self.start("--gtest_repeat=-1")
        os.killpg(runner.pid, signal.SIGTERM)
        self.assertNotEqual(runner.wait(timeout=30), 0)
        self.expect_gone(emulator)


if __name__ == "__main__":
    MACHINE, IMAGE = sys.argv[1:3]
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
