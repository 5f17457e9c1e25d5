# SPDX-License-Identifier: BSD-3-Clause
"""Doxygen reads the public headers without a warning. Skipped where Doxygen is not installed.

Guards against: comments on parameters that are no longer there, references that lead nowhere,
headers that Doxygen no longer reads, and this test finding nothing because it looks at nothing.
"""

import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

DOXYGEN = shutil.which("doxygen")

# A header with each kind of fault, and what Doxygen says of it. Of functions as well as of members:
# those of a namespace are read only where all is extracted.
PLANTED = """#pragma once
namespace Harmos {
/// @param nothing is not there.
int one(int a);
/// See @ref Nowhere.
int two(int a);
/// @thrown by nobody.
int three(int a);
class Four {
 public:
  /// @param nobody is not there.
  void run(int a);
};
} // namespace Harmos
"""
SAID = (
    "argument 'nothing' of command @param is not found",
    "unable to resolve reference to 'Nowhere'",
    "unknown command '@thrown'",
    "argument 'nobody' of command @param is not found",
)


def doxygen(top):
    """Reads the headers below a directory; exit status, what was printed, where the pages are."""
    output = runs.scratch("doxygen")
    output.mkdir()
    done = subprocess.run(
        [DOXYGEN, "docs/Doxyfile"],
        cwd=top,
        env={**os.environ, "HARMOS_DOXYGEN_OUTPUT": str(output)},
        capture_output=True,
        text=True,
    )
    return done.returncode, done.stdout + done.stderr, output / "html"


class Doxygen(unittest.TestCase):
    def test_headers_without_a_warning(self):
        status, printed, html = doxygen(runs.SOURCE)
        self.assertEqual((status, printed), (0, ""))
        pages = "\n".join(page.read_text(encoding="utf-8") for page in html.glob("*.html"))
        for header in sorted(runs.SOURCE.glob("packages/*/src/**/*.hpp")):
            if not header.stem.endswith("_def"):
                self.assertRegex(pages, rf"\b{header.name}\b")
        # A class, a function of a namespace, and a namespace that has a text.
        for name in ("classHarmos_1_1feti_1_1FetiSolver", "namespaceHarmos_1_1qp"):
            self.assertTrue((html / f"{name}.html").exists(), name)
        contact = (html / "namespaceHarmos_1_1contact.html").read_text(encoding="utf-8")
        self.assertIn("gatherSurface", contact)

    def test_namespaces_have_a_text(self):
        text = (runs.SOURCE / "docs/namespaces.dox").read_text(encoding="utf-8")
        described = set(re.findall(r"@namespace ([\w:]+)", text))
        opened = re.compile(r"^namespace (Harmos(?:::[a-z]\w*)?) \{", re.M)
        found = set()
        for header in runs.SOURCE.glob("packages/*/src/**/*.hpp"):
            found.update(opened.findall(header.read_text(encoding="utf-8")))
        self.assertEqual(described, found)

    def test_planted_faults_are_found(self):
        top = runs.scratch("copy")
        (top / "docs").mkdir(parents=True)
        (top / "packages").mkdir()
        shutil.copyfile(runs.SOURCE / "docs/Doxyfile", top / "docs/Doxyfile")
        (top / "docs/namespaces.dox").write_text("/// @mainpage Planted\n", encoding="utf-8")
        (top / "packages/Harmos_Planted.hpp").write_text(PLANTED, encoding="utf-8")
        status, printed, _ = doxygen(top)
        self.assertNotEqual(status, 0)
        for said in SAID:
            self.assertIn(said, printed)


if __name__ == "__main__":
    if DOXYGEN is None:
        runs.skip("doxygen is not installed")
    runs.main()
