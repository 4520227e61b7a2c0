#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""amalgamate.py FOLDER: the libraries in files that stand alone, for build systems without CMake, in a folder that
PlatformIO takes as a library and ESP-IDF as a component:
  include/mdhcal.h          the C header, and mdhcal_port.h for the blob store
  src/mdhcal.cpp            what both precisions share, and the blob store
  src/mdhcal_double.cpp     the kinematics in double
  src/mdhcal_float.cpp      and in float: leave out what is not used
  include/mdhcal/...        the C++ headers, for programs in C++; the four files do not need them
The sources say themselves how they have to be computed, so that `g++ -std=c++17 -O2 -c` gives the bits; with -fno-exceptions and
-fno-math-errno besides they need nothing but memcpy and its kin."""
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEADERS = [ROOT / "lib/include", ROOT / "port/include"]
LICENCE = "// SPDX-License-Identifier: MIT\n// Made by cmake/packaging/amalgamate.py of mdhcal: change the sources, not this file.\n"
# The options of lib/CMakeLists.txt that decide the bits, for a compiler that was not given them.
OPTIONS = """#if defined(__clang__)
#pragma clang fp contract(off)
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off", "no-tree-vectorize", "no-tree-slp-vectorize")
#endif
"""
INCLUDE = re.compile(r'^#include "([^"]+)"\n', re.M)
FLAGS = ["-std=c++17", "-O2", "-ffp-contract=off", "-fno-tree-vectorize", "-fno-tree-slp-vectorize", "-fno-math-errno",
         "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics", "-ffunction-sections", "-fdata-sections"]
ABOUT = {"version": re.search(r"project\(mdhcal VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text()).group(1),
         "description": "Corrected kinematics of a calibrated robot arm, and the store for its parameter blob", "license": "MIT"}


def find(name, beside):
    for folder in (beside, ROOT / "lib/src", *HEADERS):
        if (folder / name).exists():
            return folder / name
    raise SystemExit(f"{name}: included, and nowhere to be found.")


# What a file declares at its outermost level: types, functions, constants.
DECLARED = re.compile(r"^(?:struct|class|using) (\w+)|^(?:[\w:<>,&*]+ )+[&*]?(\w+)(?:\(| = |\[)", re.M)


def body(path, done, names):
    """The text of a file, what it includes in its place, once each. A private name of a source that stands in an earlier one as
    well gets the source's name behind it."""
    if path in done:
        return ""
    done.add(path)
    text = re.sub(r"\A// SPDX[^\n]*\n", "", path.read_text()).replace("#pragma once\n", "")
    private = re.search(r"^namespace \{$(.*?)^\}  // namespace$", text, re.M | re.S) if path.suffix == ".cpp" else None
    for name in sorted({a or b for a, b in DECLARED.findall(private.group(1))} if private else ()):
        if names.setdefault(name, path) != path:
            text = re.sub(rf"\b{name}\b", f"{name}_{path.stem}", text)
    if path.is_relative_to(ROOT / "lib/src") and path.suffix == ".hpp":
        for name, _ in DECLARED.findall(text):  # types; functions of a header overload
            names.setdefault(name, path)
    return INCLUDE.sub(lambda match: body(find(match.group(1), path.parent), done, names), text)


def c_header():
    text = (ROOT / "lib/include/mdhcal.h").read_text()
    functions = (ROOT / "lib/include/mdhcal/c_functions.h").read_text()
    return text.replace('#include "mdhcal/c_functions.h"\n', functions)


def unit(sources, define=""):
    done = {ROOT / "lib/include/mdhcal.h"}  # included, as a caller does
    names = {}
    text = "".join(f"\n{body(source, done, names)}" for source in sources)
    return f'{LICENCE}{define}{OPTIONS}#include "mdhcal.h"\n{text}'


def lists():
    text = (ROOT / "lib/CMakeLists.txt").read_text()
    found = {name: re.search(rf"set\({name} ([^)]*)\)", text).group(1).split() for name in ("per_precision", "once")}
    return {name: [ROOT / "lib" / source for source in sources] for name, sources in found.items()}


def main():
    if len(sys.argv) != 2:
        raise SystemExit("usage: amalgamate.py FOLDER")
    folder = pathlib.Path(sys.argv[1])
    sources = lists()
    files = {"include/mdhcal.h": c_header(),
             "src/mdhcal.cpp": unit([*sources["once"], *(ROOT / "port/src" / name for name in ("store.cpp", "store_c.cpp"))])}
    for real in ("double", "float"):
        files[f"src/mdhcal_{real}.cpp"] = unit(sources["per_precision"], f"#define MDHCAL_REAL {real}\n")
    files["include/mdhcal_port.h"] = (ROOT / "port/include/mdhcal_port.h").read_text()
    for top in HEADERS:
        for path in sorted((top / "mdhcal").rglob("*.hpp")):
            files[f"include/{path.relative_to(top)}"] = path.read_text()
    files["library.json"] = json.dumps({"name": "mdhcal", **ABOUT, "frameworks": "*", "platforms": "*",
                                        "build": {"flags": FLAGS}}, indent=2) + "\n"
    files["idf_component.yml"] = "".join(f'{key}: "{value}"\n' for key, value in ABOUT.items())
    files["CMakeLists.txt"] = ("# SPDX-License-Identifier: MIT\n"
                               "idf_component_register(SRCS src/mdhcal.cpp src/mdhcal_double.cpp src/mdhcal_float.cpp "
                               "INCLUDE_DIRS include)\n"
                               f"target_compile_options(${{COMPONENT_LIB}} PRIVATE {' '.join(FLAGS)})\n")
    files["LICENSE"] = (ROOT / "LICENSE").read_text()
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    print(f"{len(files)} files in {folder}")


if __name__ == "__main__":
    main()
