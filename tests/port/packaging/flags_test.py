#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""flags_test.py LIBRARY: -ffast-math and each flag that it stands for, given to the library by either compiler in either precision,
is refused when compiling, or noticed by the self-test, or is one that changes no code. The file with the self-test alone is
compiled with the flag: it has to notice by itself."""
import pathlib
import platform
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parents[3]
BLOB = max((ROOT / "tests/blob/golden").glob("written-arithmetic-*.blob"), key=lambda path: int(path.name.split("-")[2]))
BASE = ["-std=c++17", "-O2", "-ffp-contract=off", "-fno-tree-vectorize", "-fno-tree-slp-vectorize", "-fno-math-errno",
        "-fno-exceptions", "-fno-rtti", f"-I{ROOT}/lib/include", f"-I{ROOT}/lib/src"]
# What GCC's and clang's manuals list under -ffast-math, alone and together.
FLAGS = [[], ["-ffast-math"], ["-Ofast"], ["-funsafe-math-optimizations"], ["-fassociative-math"],
         ["-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math"], ["-freciprocal-math"], ["-fno-signed-zeros"],
         ["-fno-trapping-math"], ["-ffinite-math-only"], ["-fno-math-errno"], ["-fno-rounding-math"]]
OF_ONE = {"g++": [["-fno-signaling-nans"], ["-fcx-limited-range"], ["-fexcess-precision=fast"]],
          "clang++": [["-fno-honor-nans"], ["-fno-honor-infinities"], ["-fapprox-func"], ["-ffp-model=fast"]]}
FUSED = ["-ffp-contract=fast", "-march=haswell"]
if platform.machine() == "x86_64" and " fma " in pathlib.Path("/proc/cpuinfo").read_text():
    FLAGS.append(FUSED)
else:
    print(f"left out: {' '.join(FUSED)}: the processor fuses nothing")
PROGRAM = """
#include <stdio.h>
#include "mdhcal.h"
static uint8_t bytes[8161];
static PREFIX(calibrated_arm) arm;
int main(int count, char** arguments) {
  FILE* file = count == 2 ? fopen(arguments[1], "rb") : NULL;
  const size_t size = file != NULL ? fread(bytes, 1, sizeof bytes, file) : 0;
  printf("%d", (int)PREFIX(load)(&arm, sizeof arm, MDHCAL_ABI_VERSION, bytes, size, NULL));
  return 0;
}
"""


def run(*command):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True)


def code(compiler, real, flags, folder):
    item = folder / "code.o"
    run(compiler, *BASE, f"-DMDHCAL_REAL={real}", *flags, "-c", ROOT / "lib/src/arm/kinematics.cpp", "-o", item)
    listing = run("objdump", "-dr", "--no-show-raw-insn", item).stdout
    return listing.partition("Disassembly")[2]


def outcome(case):
    compiler, real, flags, folder = case
    item = folder / "self_test.o"
    options = [*BASE, f"-DMDHCAL_REAL={real}", *flags]
    made = run(compiler, *options, "-c", ROOT / "lib/src/blob/self_test.cpp", "-o", item)
    if made.returncode != 0:
        return "refused" if "compile mdhcal without -ffast-math" in made.stderr else f"FAILED: {made.stderr}"
    (folder / "main.c").write_text(PROGRAM)
    prefix = "mdhcal_" if real == "double" else "mdhcalf_"
    linked = run("gcc", f"-DPREFIX(name)={prefix}##name", f"-I{ROOT}/lib/include", folder / "main.c", item, LIBRARY, "-o", folder / "main")
    if linked.returncode != 0:
        return f"FAILED: {linked.stderr}"
    status = run(folder / "main", BLOB).stdout
    if status == "28":
        return "noticed"
    if status != "0":
        return f"FAILED: status {status}"
    made = code(compiler, real, flags, folder)
    if not flags:
        PLAIN[compiler, real] = made
    same = made and made == PLAIN[compiler, real]
    return "no other code" if same else "FAILED: neither refused nor noticed, and other code"


PLAIN = {}
LIBRARY = pathlib.Path(sys.argv[1])
with tempfile.TemporaryDirectory() as top:
    cases = []
    for compiler, more in OF_ONE.items():
        for flags in FLAGS + more:
            for real in ("double", "float"):
                folder = pathlib.Path(top, str(len(cases)))
                folder.mkdir()
                cases.append((compiler, real, flags, folder))
    cases.sort(key=lambda case: len(case[2]) > 0)  # the plain code first: the others are held against it
    plain = [outcome(case) for case in cases if not case[2]]
    with ThreadPoolExecutor(2) as pool:
        outcomes = plain + list(pool.map(outcome, cases[len(plain):]))
for (compiler, real, flags, _), result in zip(cases, outcomes):
    print(f"{compiler} {real} {' '.join(flags) or '(none)'}: {result}")
assert all(result == "no other code" for (_, _, flags, _), result in zip(cases, outcomes) if not flags)
bent = [result for (_, _, flags, _), result in zip(cases, outcomes) if flags]
print(f"{len(bent)} of {len(cases)} with a flag: {bent.count('refused')} refused, {bent.count('noticed')} noticed, "
      f"{bent.count('no other code')} change no code")
sys.exit(1 if any(result.startswith("FAILED") for result in outcomes) else 0)
