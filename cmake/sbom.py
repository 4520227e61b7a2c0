#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sbom.py [DATE]: the software bill of materials, SPDX 2.3 JSON on standard output.

What the project depends on is read from docs/dependencies.md, versions from the packages that are installed. DATE is the time of
making, as 2026-11-29T12:00:00Z; SOURCE_DATE_EPOCH or the last commit's if it is left out, so that one commit gives one document.
Fails where a package of cmake/packages.txt has no row, or a row has no licence.
"""
import datetime
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
RELATION = {"linked": "DEPENDS_ON", "run": "DEPENDS_ON", "tests": "TEST_TOOL_OF", "build": "BUILD_TOOL_OF"}


def rows():
    """(what, packages, licence, how) of every row of the table; packages are words that the list has, too."""
    found = []
    known = dict(listed())
    for line in (ROOT / "docs/dependencies.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split(" | ")] if line.startswith("| ") else []
        if len(cells) == 6 and cells[0] != "what":
            if cells[3] not in RELATION or not cells[2]:
                raise SystemExit(f"docs/dependencies.md: found \"{cells[3]}\" and the licence \"{cells[2]}\" of {cells[0]}; expected "
                                 f"a licence and one of {', '.join(RELATION)}.")
            packages = [word for word in re.findall(r"[a-z][a-z0-9+.-]+", cells[1]) if word in known]
            if "group `cross`" in cells[1]:
                packages += [package for package, group in known.items() if group == "cross"]
            found.append((cells[0], packages, cells[2], cells[3]))
    return found


def version_of(package):
    done = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], capture_output=True, text=True)
    return done.stdout if done.returncode == 0 and done.stdout else None


def listed():
    """Package and group of every line of cmake/packages.txt."""
    lines = (ROOT / "cmake/packages.txt").read_text().splitlines()
    return [(words[0], words[1] if len(words) > 1 else "tool") for words in map(str.split, lines) if words and words[0] != "#"]


def made_at(arguments):
    if arguments:
        return arguments[0]
    seconds = os.environ.get("SOURCE_DATE_EPOCH")
    if seconds is None:
        seconds = subprocess.run(["git", "log", "-1", "--format=%ct"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return datetime.datetime.fromtimestamp(int(seconds), datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def identity(name):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]+", "-", name).strip("-")


def main(arguments):
    table = rows()
    named = {package for _, packages, _, _ in table for package in packages}
    missing = [package for package, group in listed() if package not in named]
    if missing:
        raise SystemExit(f"docs/dependencies.md has no row for {', '.join(missing)}, which cmake/packages.txt lists.")
    version = re.search(r"project\(mdhcal VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    date = made_at(arguments)
    own = {"SPDXID": "SPDXRef-mdhcal", "name": "mdhcal", "versionInfo": version, "downloadLocation": "NOASSERTION",
           "filesAnalyzed": False, "licenseConcluded": "MIT", "licenseDeclared": "MIT", "copyrightText": "NOASSERTION"}
    packages, relations = [own], [("SPDXRef-DOCUMENT", "DESCRIBES", own["SPDXID"])]
    for what, names, licence, how in table:
        version_here = next((v for v in map(version_of, names) if v), "NOASSERTION")
        spoken = licence if re.match(r"[A-Z]", licence) else "NOASSERTION"
        packages.append({"SPDXID": identity(what), "name": what, "versionInfo": version_here, "downloadLocation": "NOASSERTION",
                         "filesAnalyzed": False, "licenseConcluded": spoken, "licenseDeclared": spoken,
                         "copyrightText": "NOASSERTION", "comment": f"{how}; Debian: {', '.join(names)}; licence: {licence}"})
        relation = RELATION[how]
        pair = (own["SPDXID"], identity(what)) if relation == "DEPENDS_ON" else (identity(what), own["SPDXID"])
        relations.append((pair[0], relation, pair[1]))
    document = {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"mdhcal-{version}",
                "documentNamespace": f"https://spdx.org/spdxdocs/mdhcal-{version}-{date}",
                "creationInfo": {"created": date, "creators": ["Tool: mdhcal cmake/sbom.py"]}, "packages": packages,
                "relationships": [{"spdxElementId": a, "relationshipType": kind, "relatedSpdxElement": b} for a, kind, b in relations]}
    print(json.dumps(document, indent=1))


if __name__ == "__main__":
    main(sys.argv[1:])
