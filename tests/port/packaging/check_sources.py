#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check_sources.py [--write]: the PlatformIO library compiles each source through a file of two lines, because that build
system compiles a file once and the kinematics are compiled once a precision. Checks that those files are the ones that
lib/CMakeLists.txt asks for, or writes them."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
FOLDER = ROOT / "cmake/packaging/platformio/src"


def wanted():
    text = (ROOT / "lib/CMakeLists.txt").read_text()
    lists = {name: re.search(rf"set\({name} ([^)]*)\)", text).group(1).split() for name in ("per_precision", "once")}
    head = "// SPDX-License-Identifier: MIT\n"
    files = {}
    for source in lists["once"]:
        files[f"rt_{pathlib.Path(source).name}"] = f'{head}#include "../../../../lib/{source}"\n'
    for source in lists["per_precision"]:
        for real in ("double", "float"):
            name = f"rt_{pathlib.Path(source).stem}_{real}.cpp"
            files[name] = f'{head}#define MDHCAL_REAL {real}\n#include "../../../../lib/{source}"\n'
    files["port_store.cpp"] = f'{head}#include "../../../../port/src/store.cpp"\n'
    return files


def main():
    files = wanted()
    if "--write" in sys.argv:
        for old in FOLDER.glob("*.cpp"):
            old.unlink()
        for name, text in files.items():
            (FOLDER / name).write_text(text)
    there = {path.name: path.read_text() for path in FOLDER.glob("*.cpp")}
    if there != files:
        print("cmake/packaging/platformio/src is not what lib/CMakeLists.txt asks for; run "
              "python3 tests/port/packaging/check_sources.py --write. Different: "
              + ", ".join(sorted(name for name in {*there, *files} if there.get(name) != files.get(name))))
        return 1
    print(f"{len(files)} files as lib/CMakeLists.txt asks")
    return 0


if __name__ == "__main__":
    sys.exit(main())
