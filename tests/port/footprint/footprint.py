#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the library costs on the targets.

footprint.py [PRESET...]            build what is needed and print the tables
footprint.py --write [PRESET...]    print them, put them into baseline/, and what was asked for into docs/footprint.md
footprint.py --check PRESET [BUILD] measure one built preset; fail if a figure has grown by more than 5 % over the tables,
                                    or is over what was asked for (budgets.py)
"""
import array
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from budgets import BUDGETS
from call_graph import CallGraph
from target import MACHINES, ROOT, Target, run

PRESETS = [*MACHINES, "armhf", "aarch64", "host"]
USER_MODE = {"armhf": ["qemu-arm", "-L", "/usr/arm-linux-gnueabihf"],
             "aarch64": ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"], "host": ["qemu-x86_64"]}
DOCUMENT = ROOT / "docs/footprint.md"
BASELINE = pathlib.Path(__file__).parent / "baseline"
GROWTH = 1.05
COSTS = ["function", "precision", "inputs", "count", "min", "median", "max", "stack painted"]
ASKED = ["on", "what", "asserted, at most", "measured"]
SIZES = ["function", "code and constants", "stack bound"]


def short(name, preset):
    """A demangled signature without what all of them share."""
    size, word = {"armhf": ("", "int"), "aarch64": ("long", "int"), "host": ("long", "int")}.get(preset, ("int", "long"))
    name = re.sub(r"mdhcal::| const\b|[&*]| \(\)", "", name).replace("unsigned char", "uint8_t")
    name = name.replace(f"unsigned {word}", "uint32_t")
    return name.replace(f"unsigned {size}", "size_t") if size else name


def costs(target):
    program = target.build / "bin/footprint"
    if target.bare_metal:
        environment = {**os.environ, "MDHCAL_QEMU_OPTIONS": "-icount shift=10,sleep=off"}
        output = run(ROOT / "port/cortex_m/run.sh", MACHINES[target.preset], program, env=environment)
    else:
        output, counts = run_counted(target, program)
    problems = [line for line in output.splitlines() if not line.startswith("cost ")]
    if problems:
        raise SystemExit(f"{target.preset}: " + "\n".join(problems))
    rows = [line.split()[1:] for line in output.splitlines()]
    if not target.bare_metal:
        fill_in(rows, counts)
    return rows


def run_counted(target, program):
    """What the program prints in QEMU's user mode, and what it counted at every mark."""
    emulator = USER_MODE[target.preset]
    with tempfile.TemporaryDirectory() as folder:
        plugin, out = pathlib.Path(folder) / "count.so", pathlib.Path(folder) / "counts"
        run("cc", "-O2", "-fPIC", "-shared", pathlib.Path(__file__).parent / "count_plugin.c", "-o", plugin)
        output = run(*emulator, "-plugin", f"{plugin},out={out}", program)
        counts = array.array("Q")
        counts.frombytes(out.read_bytes())
    return output, counts


def fill_in(rows, counts):
    """Minimum, median and maximum of each row, from pairs of marks: the overhead's, then one for every input."""
    spent = [end - begin for begin, end in zip(counts[::2], counts[1::2])]
    for row in rows:
        count = int(row[3])
        overhead, inputs, spent = spent[0], sorted(spent[1:count + 1]), spent[count + 1:]
        row[4:7] = [str(inputs[at] - overhead) for at in (0, count // 2, count - 1)]
    if spent:
        raise SystemExit(f"{len(spent)} measurements that no row accounts for")


def sizes(target):
    rows = []
    functions = target.public_functions()
    with tempfile.TemporaryDirectory() as folder:
        image = pathlib.Path(folder) / "image"
        everything = target.link(image, [mangled for mangled, _ in functions])
        graph = CallGraph(target, image) if target.preset != "host" else None
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
    return [(f"### {target.preset}: instructions and painted stack [bytes]", COSTS, costs(target)),
            (f"### {target.preset}: code and constants, stack bound [bytes]", SIZES, sizes(target))]


def text_of(parts):
    return "\n".join(f"{heading}\n\n{markdown(header, rows)}" for heading, header, rows in parts)


def is_number(cell):
    return re.match(r"\d+\b|-$", cell) is not None


def names(row):
    return tuple(cell for cell in row if not is_number(cell))


def recorded(preset, heading):
    """Rows of one table of the baseline, by their names."""
    text = (BASELINE / f"{preset}.md").read_text()
    if heading not in text:
        return {}
    rows = {}
    for line in text[text.index(heading) + len(heading):].lstrip().splitlines()[2:]:
        if not line.startswith("|"):
            break
        cells = [cell.strip() for cell in line.strip("|\n").split(" | ")]
        rows[names(cells)] = cells
    return rows


def measured(budget, parts):
    """The largest figure of the budget's rows."""
    found = []
    for _, header, rows in parts:
        if budget.column in header:
            found += [int(re.match(r"\d+", row[header.index(budget.column)]).group()) for row in rows
                      if all(wanted in (None, cell) for wanted, cell in zip(budget.row, row))]
    if not found:
        raise SystemExit(f"{budget.preset}: nothing was measured for: {budget.what}")
    return max(found)


def check(target):
    failures = 0
    parts = tables(target)
    for heading, header, rows in parts:
        old = recorded(target.preset, heading)
        for row in rows:
            if names(row) not in old:
                print(f"{target.preset}: {' '.join(names(row))} is not in the baseline")
                failures += 1
                continue
            for title, before, now in zip(header, old[names(row)], row):
                was, is_now = re.match(r"\d+", before), re.match(r"\d+", now)
                if title in ("function", "count") or not was or not is_now:
                    continue
                if int(is_now.group()) > GROWTH * int(was.group()):
                    print(f"{target.preset}: {' '.join(names(row))}: {title} has grown from {before} to {now}")
                    failures += 1
        print(f"{heading}: {len(rows)} rows compared")
    if failures:
        print("If this is meant: python3 tests/port/footprint/footprint.py --write")
    for budget in BUDGETS:
        if budget.preset == target.preset:
            figure = measured(budget, parts)
            print(f"{target.preset}: {budget.what}: {figure} {budget.unit} of {budget.bound}")
            failures += figure > budget.bound
    return failures


def write(texts, asked):
    """Puts the tables of some presets into the baseline, and what was asked for into the document."""
    for preset, text in texts.items():
        (BASELINE / f"{preset}.md").write_text(text)
    head, rest = DOCUMENT.read_text().split("<!-- asked -->\n")
    old, tail = rest.split("<!-- end of asked -->")
    rows = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in old.splitlines() if line.startswith("|")]
    kept = {preset: [row for row in rows[2:] if row[0] == preset] for preset in PRESETS}
    table = markdown(ASKED, sum({**kept, **asked}.values(), []))
    DOCUMENT.write_text(f"{head}<!-- asked -->\n\n{table}\n<!-- end of asked -->{tail}")


def build(preset):
    if not (ROOT / "build" / preset / "CMakeCache.txt").exists():
        subprocess.run(["cmake", "--preset", preset], cwd=ROOT, check=True, stdout=sys.stderr)
    subprocess.run(["cmake", "--build", f"build/{preset}", "-j2", "--target", "mdhcal_rt", "mdhcal_port", "footprint"],
                   cwd=ROOT, check=True, stdout=sys.stderr)


def main(arguments):
    if arguments[:1] == ["--check"]:
        return 1 if check(Target(*arguments[1:3])) else 0
    presets = [argument for argument in arguments if not argument.startswith("--")] or PRESETS
    texts, asked = {}, {}
    for preset in presets:
        build(preset)
        parts = tables(Target(preset))
        texts[preset] = text_of(parts)
        asked[preset] = [[preset, budget.what, f"{budget.bound} {budget.unit}", str(measured(budget, parts))]
                         for budget in BUDGETS if budget.preset == preset]
        print(texts[preset], markdown(ASKED, asked[preset]), sep="\n", flush=True)
    if "--write" in arguments:
        write(texts, asked)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
