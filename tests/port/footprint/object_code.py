#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""object_code.py PRESET [BUILD]: what the firmware engineer reads in the object code of a built preset.

Data and bss are empty, nothing runs before main, nothing is fused, the float objects hold no double, and a link of
everything in which a heap, an exception, RTTI, stdio or libm reference is an error succeeds.
"""
import pathlib
import re
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from target import Target, run

FUSED = {"arm": r"\bvfn?m[as]", "aarch64": r"\bfn?m(add|sub)\b|\bfml[as]\b", "x86": r"\bvfn?m(add|sub)"}
# What a compiler may call by itself: copies, and arithmetic of libgcc that the processor lacks.
ALLOWED = r"mem(cpy|set|move|cmp)|__aeabi_\w+|__\w+[sdt]f\w*|__gnu_\w+|_GLOBAL_OFFSET_TABLE_|__stack_chk_fail"
POSIX = r"open|close|pread\w*|pwrite\w*|fsync|flock|f?stat\w*|link|unlink|getrandom|snprintf|strrchr|__errno_location|__\w+_chk|strlen"
POISON = ["malloc", "free", "calloc", "realloc", "_malloc_r", "_free_r", "_Znwj", "_Znwm", "_ZdlPv", "_ZdlPvj", "_ZdlPvm",
          "__cxa_throw", "__cxa_allocate_exception", "__cxa_guard_acquire", "__cxa_pure_virtual", "__cxa_atexit",
          "__dynamic_cast", "printf", "puts", "abort", "exit", "__errno", "sin", "cos", "atan2", "sqrt", "sqrtf"]
FLAT = r"\.(data|bss|tdata|tbss|init_array|ctors|fini_array|preinit_array)\b(?!\.rel\.ro)"


def problems(target):
    rt = target.archives[1]
    for archive in target.archives:
        for line in target.tool("size", "-A", archive).splitlines():
            found = re.match(rf"({FLAT}\S*)\s+(\d+)", line)
            if found and int(found.groups()[-1]) > 0:
                yield f"{archive.name} has {found.groups()[-1]} bytes of {found.group(1)}"
    name = pathlib.Path(target.compiler).name
    kind = next((kind for kind in ("aarch64", "arm") if kind in name), "x86")
    for archive in target.archives:
        for line in target.tool("objdump", "-d", archive).splitlines():
            if re.search(FUSED[kind], line):
                yield f"{archive.name} has a fused operation: {line.strip()}"
    for item in (target.build / "lib/CMakeFiles/mdhcal_rt_float.dir").rglob("*.o*"):
        if item.suffix not in (".o", ".obj"):
            continue
        if target.bare_metal:
            for line in target.tool("objdump", "-dr", item).splitlines():
                if re.search(r"\.f64|__aeabi_(d\w+|\w+2d\b)", line):
                    yield f"{item.name} of the float build has double: {line.strip()}"
    roots = [mangled for mangled, _ in target.symbols()]
    with tempfile.TemporaryDirectory() as folder:
        image = pathlib.Path(folder) / "image"
        # Partially linked, so that what is missing stays to be seen; then every name must be an allowed one.
        run(target.compiler, *target.flags, "-nostdlib", "-r", "-Wl,--gc-sections", f"-Wl,-e,{roots[0]}",
            *[f"-Wl,-u,{root}" for root in roots], "-Wl,--start-group", *target.archives, "-Wl,--end-group", "-o", image)
        for line in target.tool("nm", "-u", image).splitlines():
            name = line.split()[-1]
            if not re.fullmatch(ALLOWED if target.bare_metal else f"{ALLOWED}|{POSIX}", name):
                yield f"the archives need {name}"
        if target.bare_metal:
            # The poison link: a wrapped name that anything refers to is undefined, and the link fails.
            try:
                total = target.sections(target.link(image, roots, *[f"-Wl,--wrap={name}" for name in POISON]))
                if total["data"] or total["bss"]:
                    yield f"the image of everything has {total['data']} bytes of data and {total['bss']} of bss"
            except SystemExit as error:
                missing = [line for line in str(error).splitlines() if "undefined reference" in line]
                yield from (f"poison link: {line}" for line in missing or [str(error)])
    weak = [line for line in target.tool("nm", "-C", rt).splitlines() if re.search(r" [WVu] ", line)]
    for line in weak:
        yield f"{rt.name} has a weak symbol: {line}"


def main(arguments):
    target = Target(*arguments)
    found = list(dict.fromkeys(problems(target)))
    print(f"{target.preset}: data 0, bss 0, no constructor, nothing fused, no double in float, no heap, no exception: "
          + ("holds" if not found else "does not hold"))
    print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
