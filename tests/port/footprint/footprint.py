#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the library costs on the targets.

footprint.py                        build what is needed and print the tables of docs/footprint.md
footprint.py --write                print them, and put them into docs/footprint.md
footprint.py --check PRESET [BUILD] measure one built preset; fail if a figure has grown by more than 5 % over the tables
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from call_graph import CallGraph
from target import MACHINES, ROOT, Target, run

PRESETS = [*MACHINES, "armhf", "aarch64", "host"]
DOCUMENT = ROOT / "docs/footprint.md"
GROWTH = 1.05
COSTS = ["function", "precision", "inputs", "min", "median", "max", "stack painted"]
SIZES = ["function", "code and constants", "stack bound"]


def short(name, preset):
    """A demangled signature without what all of them share."""
    size, word = {"armhf": ("", "int"), "aarch64": ("long", "int"), "host": ("long", "int")}.get(preset, ("int", "long"))
    name = re.sub(r"mdhcal::| const\b|[&*]| \(\)", "", name).replace("unsigned char", "uint8_t")
    name = name.replace(f"unsigned {word}", "uint32_t")
    return name.replace(f"unsigned {size}", "size_t") if size else name


def costs(target):
    environment = {**os.environ, "MDHCAL_QEMU_OPTIONS": "-icount shift=10,sleep=off"}
    output = run(ROOT / "port/cortex_m/run.sh", MACHINES[target.preset], target.build / "bin/footprint", env=environment)
    # QEMU ends with status 0 when it is terminated from outside.
    if "complete" not in output.splitlines():
        raise SystemExit(f"{target.preset}: the measurement was cut off; the last line was {output.splitlines()[-1:]}")
    return [line.split()[1:] for line in output.splitlines() if line.startswith("cost ")]


def sizes(target):
    rows = []
    functions = target.public_functions()
    with tempfile.TemporaryDirectory() as folder:
        image = pathlib.Path(folder) / "image"
        everything = target.link(image, [mangled for mangled, _ in functions])
        graph = CallGraph(target, image) if target.bare_metal else None
        whole = target.sections(everything)["code"]
        one = {}
        for real, other in (("double", r"<float>|^mdhcalf_"), ("float", r"<double>|^mdhcal_(?!text)")):
            roots = [mangled for mangled, name in functions if not re.search(other, name)]
            one[real] = target.sections(target.link(image, roots))["code"]
        for mangled, name in functions:
            code = target.sections(target.link(image, [mangled]))["code"]
            bound = "-"
            if graph:
                depth, unknown = graph.bound(mangled)
                bound = f"{depth}" + ("" if not unknown else " + " + ", ".join(unknown))
            rows.append([f"`{short(name, target.preset)}`", str(code), bound])
    return [*sorted(rows), ["everything in double", str(one["double"]), "-"],
            ["everything in float", str(one["float"]), "-"], ["everything", str(whole), "-"]]


def markdown(header, rows):
    line = lambda cells: "| " + " | ".join(cells) + " |"
    return "\n".join([line(header), line(["---"] * len(header)), *map(line, rows)]) + "\n"


def tables(target):
    """The text of one preset, and its tables as (heading, header, rows)."""
    parts = []
    if target.bare_metal:
        parts.append((f"### {target.preset}: instructions and painted stack [bytes]", COSTS, costs(target)))
    parts.append((f"### {target.preset}: code and constants, stack bound [bytes]", SIZES, sizes(target)))
    return parts


def text_of(parts):
    return "\n".join(f"{heading}\n\n{markdown(header, rows)}" for heading, header, rows in parts)


def recorded(heading):
    """Rows of one table of the document, by their names."""
    text = DOCUMENT.read_text()
    if heading not in text:
        return {}
    rows = {}
    for line in text[text.index(heading) + len(heading):].lstrip().splitlines()[2:]:
        if not line.startswith("|"):
            break
        cells = [cell.strip() for cell in line.strip("|\n").split(" | ")]
        names = tuple(cell for cell in cells if not re.match(r"\d+\b|-$", cell))
        rows[names] = cells
    return rows


def check(target):
    failures = 0
    for heading, header, rows in tables(target):
        old = recorded(heading)
        for row in rows:
            names = tuple(cell for cell in row if not re.match(r"\d+\b|-$", cell))
            if names not in old:
                print(f"{target.preset}: {' '.join(names)} is not in docs/footprint.md")
                failures += 1
                continue
            for title, before, now in zip(header, old[names], row):
                was, is_now = re.match(r"\d+", before), re.match(r"\d+", now)
                if title in header[:1] or not was or not is_now:
                    continue
                if int(is_now.group()) > GROWTH * int(was.group()):
                    print(f"{target.preset}: {' '.join(names)}: {title} has grown from {before} to {now}")
                    failures += 1
        print(f"{heading}: {len(rows)} rows compared")
    if failures:
        print("If this is meant: python3 tests/port/footprint/footprint.py --write")
    return failures


def build(preset):
    if not (ROOT / "build" / preset / "CMakeCache.txt").exists():
        subprocess.run(["cmake", "--preset", preset], cwd=ROOT, check=True, stdout=sys.stderr)
    targets = ["mdhcal_rt", "mdhcal_port"] + (["footprint"] if preset in MACHINES else [])
    subprocess.run(["cmake", "--build", f"build/{preset}", "-j2", "--target", *targets], cwd=ROOT, check=True,
                   stdout=sys.stderr)


def main(arguments):
    if arguments[:1] == ["--check"]:
        return 1 if check(Target(*arguments[1:3])) else 0
    presets = [argument for argument in arguments if not argument.startswith("--")] or PRESETS
    texts = []
    for preset in presets:
        build(preset)
        texts.append(text_of(tables(Target(preset))))
        print(texts[-1], flush=True)
    if "--write" in arguments:
        begin, end = "<!-- tables -->\n", "<!-- end of tables -->"
        text = DOCUMENT.read_text()
        head, rest = text.split(begin)
        DOCUMENT.write_text(head + begin + "\n" + "\n".join(texts) + "\n" + end + rest.split(end)[1])
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
