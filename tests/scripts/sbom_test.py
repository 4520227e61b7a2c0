#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The bill of materials as a reader of SPDX 2.3 takes it, and that it refuses a package without a row."""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATE = "2026-01-02T03:04:05Z"


def run(root):
    return subprocess.run([sys.executable, root / "cmake/sbom.py", DATE], capture_output=True, text=True)


class BillOfMaterials(unittest.TestCase):
    def test_names_everything_once_and_relates_it(self):
        first = run(ROOT)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertEqual(first.stdout, run(ROOT).stdout)
        document = json.loads(first.stdout)
        self.assertEqual(document["spdxVersion"], "SPDX-2.3")
        self.assertEqual(document["creationInfo"]["created"], DATE)
        ids = [package["SPDXID"] for package in document["packages"]]
        self.assertEqual(len(ids), len(set(ids)))
        self.assertGreater(len(ids), 10)
        for package in document["packages"]:
            self.assertRegex(package["SPDXID"], r"^SPDXRef-[A-Za-z0-9.-]+$")
            self.assertTrue(package["licenseDeclared"])
        related = {end for relation in document["relationships"] for end in (relation["spdxElementId"], relation["relatedSpdxElement"])}
        self.assertEqual(related, {"SPDXRef-DOCUMENT", *ids})
        for copyleft in [package for package in document["packages"] if re.search(r"\bL?GPL", package["licenseDeclared"])]:
            kinds = {r["relationshipType"] for r in document["relationships"] if copyleft["SPDXID"] in r.values()}
            self.assertNotIn("DEPENDS_ON", kinds, copyleft["name"])

    def test_a_package_without_a_row_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name in ("cmake/sbom.py", "cmake/packages.txt", "docs/dependencies.md", "CMakeLists.txt"):
                (root / name).parent.mkdir(exist_ok=True)
                shutil.copy(ROOT / name, root / name)
            with open(root / "cmake/packages.txt", "a") as listed:
                listed.write("libnew-dev\n")
            done = run(root)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("libnew-dev", done.stderr)


if __name__ == "__main__":
    unittest.main()
