#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""coverage.py [--missed]: lines, branches and MC/DC of lib/ and port/ that the host's tests run, with clang 19.

Builds what is needed in build/coverage (clang-19 and llvm-19 of Debian), runs the tests of lib and port, and prints a table by
file; --missed also prints each line that none of them runs. Double and float are one source, compiled twice: a line counts
where either runs it. Fails where a total is below BOUNDS.
"""
import collections
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build/coverage"
FLAGS = "-fprofile-instr-generate -fcoverage-mapping -fcoverage-mcdc"
PROGRAMS = ["test_lib", "test_blob", "test_blob_bounds", "test_port", "test_port_posix"]
ROOMS = ("lib/src/", "port/src/", "port/posix/")
BOUNDS = {"lines": 100.0, "branches": 98.0, "mcdc": 95.0}


def run(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, **options)


def build():
    if not (BUILD / "CMakeCache.txt").exists():
        run("cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_COMPILER=clang-19",
            "-DCMAKE_CXX_COMPILER=clang++-19", f"-DCMAKE_C_FLAGS={FLAGS}", f"-DCMAKE_CXX_FLAGS={FLAGS}", "-DMDHCAL_OFFLINE=OFF",
            stdout=sys.stderr)
    run("cmake", "--build", BUILD, "--target", *PROGRAMS, stdout=sys.stderr)


def profile():
    """Runs every program, and returns what llvm-cov says of the rooms' files."""
    for program in PROGRAMS:
        environment = {**os.environ, "LLVM_PROFILE_FILE": str(BUILD / f"{program}.profraw")}
        run(BUILD / "bin" / program, "--gtest_brief=1", env=environment, stdout=sys.stderr)
    merged = BUILD / "merged.profdata"
    run("llvm-profdata-19", "merge", "-o", merged, *(BUILD / f"{program}.profraw" for program in PROGRAMS))
    objects = [option for program in PROGRAMS[1:] for option in ("-object", BUILD / "bin" / program)]
    done = run("llvm-cov-19", "export", "-instr-profile", merged, BUILD / "bin" / PROGRAMS[0], *objects,
               *(ROOT / room for room in ROOMS), stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout)["data"][0]


def missed_lines(file):
    """Lines that a region without a count begins in, from the file's segments: [line, column, count, has_count, entry, gap]."""
    lines = {}
    for line, _, count, has_count, entry, gap in file["segments"]:
        if has_count and entry and not gap:
            lines[line] = max(lines.get(line, 0), count)
    return sorted(line for line, count in lines.items() if count == 0)


def main(arguments):
    build()
    data = profile()
    total = collections.defaultdict(lambda: [0, 0])
    print("| file | " + " | ".join(BOUNDS) + " |\n|---|" + "---|" * len(BOUNDS))
    for file in data["files"]:
        name = pathlib.Path(file["filename"]).relative_to(ROOT).as_posix()
        cells = []
        for kind in BOUNDS:
            covered, count = file["summary"][kind]["covered"], file["summary"][kind]["count"]
            total[kind][0] += covered
            total[kind][1] += count
            cells.append(f"{covered}/{count}")
        print(f"| {name} | " + " | ".join(cells) + " |")
        if "--missed" in arguments:
            for line in missed_lines(file):
                text = pathlib.Path(file["filename"]).read_text().splitlines()[line - 1].strip()
                print(f"    {name}:{line}: {text}", file=sys.stderr)
    share = {kind: 100.0 * covered / count for kind, (covered, count) in total.items()}
    print("| all | " + " | ".join(f"{share[kind]:.1f} %" for kind in BOUNDS) + " |")
    low = [f"{kind}: {share[kind]:.2f} %, asked {bound:.0f} %" for kind, bound in BOUNDS.items() if share[kind] < bound]
    print("\n".join(low))
    return 1 if low else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
