#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""more_targets_test.py [TARGET...]: the amalgamation on processors that have no preset of their own: the golden hashes, and a blob of
the host tool whose self-test has to come out bit for bit, in either precision. User-mode QEMU."""
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parents[3]
BLOB = max((ROOT / "tests/blob/golden").glob("written-arithmetic-*.blob"), key=lambda path: int(path.name.split("-")[2]))
TARGETS = {"riscv64": ("riscv64-linux-gnu-g++", [], "qemu-riscv64"),
           "s390x, big-endian": ("s390x-linux-gnu-g++", [], "qemu-s390x"),
           "i686 with SSE": ("i686-linux-gnu-g++", ["-march=pentium4", "-mfpmath=sse"], "qemu-i386"),
           "Cortex-R5F": ("arm-linux-gnueabihf-g++", ["-mcpu=cortex-r5", "-mfloat-abi=hard", "-Wl,--no-warn-mismatch"], "qemu-arm")}


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}"


def outcome(name, here):
    compiler, flags, emulator = TARGETS[name]
    program = here / name.replace(" ", "_")
    # Contraction is on where the processor can: the sources forbid it themselves.
    made = run(compiler, *flags, "-std=c++17", "-O2", "-static", "-ffp-contract=fast", f"-I{here}/arm/include", f"-I{ROOT}",
               ROOT / "tests/port/packaging/golden_loop.cpp", *sorted(here.glob("arm/src/*.cpp")), "-o", program)
    return (made or run(emulator, program, BLOB)).strip()


wanted = sys.argv[1:] or list(TARGETS)
with tempfile.TemporaryDirectory() as folder:
    here = pathlib.Path(folder)
    print(run(sys.executable, ROOT / "cmake/packaging/amalgamate.py", here / "arm").strip())
    with ThreadPoolExecutor(2) as pool:
        outcomes = dict(zip(wanted, pool.map(lambda name: outcome(name, here), wanted)))
for name, result in outcomes.items():
    print(f"{name}: {result}", flush=True)
sys.exit(0 if set(outcomes.values()) == {"golden, double: ok, float: ok"} else 1)
