#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""porting_test.py BUILD PRESET: the code of docs/porting.md, as it stands there, compiles with the house's warnings and links
with the library to an image that needs nothing else."""
import pathlib
import re
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "footprint"))
from target import ROOT, Target, run

target = Target(sys.argv[2], sys.argv[1])
warnings = re.search(r"set\(common ([^)]*)\)", (ROOT / "cmake/warnings.cmake").read_text()).group(1).split()
blocks = re.findall(r"```cpp\n// (\w+\.cpp)\n(.*?)```", (ROOT / "docs/porting.md").read_text(), re.S)
assert len(blocks) == 2, f"{len(blocks)} blocks of code found, expected 2"
with tempfile.TemporaryDirectory() as folder:
    objects = []
    for name, text in blocks:
        source = pathlib.Path(folder) / name
        source.write_text(text)
        objects.append(source.with_suffix(".o"))
        run(target.compiler, *target.flags, "-std=c++17", "-O2", "-fno-exceptions", "-fno-rtti", "-ffunction-sections",
            *warnings, "-Wold-style-cast", "-Werror", f"-I{ROOT}/lib/include", f"-I{ROOT}/port/include", "-c", source, "-o",
            objects[-1])
    roots = ["_Z5startv", "_Z4takePKhjR11Calibration"]
    run(target.compiler, *target.flags, "-nostartfiles", "-nostdlib", "-Wl,--gc-sections", f"-Wl,-e,{roots[0]}",
        *[f"-Wl,-u,{root}" for root in roots], *objects, "-Wl,--start-group", *target.archives, "-lc", "-lgcc",
        "-Wl,--end-group", "-o", pathlib.Path(folder) / "image")
    print(f"{len(blocks)} files compiled and linked: {target.sections(pathlib.Path(folder) / 'image')}")
