#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""same_tests.py HOST_BUILD BUILD EMULATOR...: a target runs the host's tests of lib, blob and port, but for those that
left_out.txt names with a reason."""
import fnmatch
import pathlib
import subprocess
import sys

host, build = map(pathlib.Path, sys.argv[1:3])
emulator = sys.argv[3:]


def tests_of(program, prefix=()):
    listing = subprocess.run([*prefix, program, "--gtest_list_tests"], capture_output=True, text=True, check=True).stdout
    found, suite = set(), ""
    for line in listing.splitlines():
        line = line.split("#")[0].rstrip()
        if line.endswith(".") and not line.startswith(" "):
            suite = line
        elif line.startswith("  ") and suite:
            found.add(suite + line.strip())
    return found


left_out = [line.split(": ", 1) for line in (build / "left_out.txt").read_text().splitlines()]
rooms = sorted(path.name for path in (host / "bin").iterdir() if path.name.startswith(("test_lib", "test_blob", "test_port")))
ours = sorted(path.name for path in (build / "bin").iterdir() if path.name.startswith("test_"))
on_host = set().union(*(tests_of(host / "bin" / name) for name in rooms))
here = set().union(*(tests_of(build / "bin" / name, emulator) for name in ours))
excused = {test for test in on_host for pattern, _ in left_out if fnmatch.fnmatchcase(test, pattern)}
for pattern, reason in left_out:
    print(f"left out: {pattern}: {reason}")
print(f"{len(on_host)} tests on the host, {len(here)} here, {len(excused)} left out by name")
missing, extra = sorted(on_host - here - excused), sorted(here - on_host)
for test in missing:
    print(f"not here and not left out by name: {test}")
for test in extra:
    print(f"here only: {test}")
sys.exit(1 if missing or not here else 0)
