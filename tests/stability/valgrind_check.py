# SPDX-License-Identifier: BSD-3-Clause
"""Valgrind's memory check of one small run: no error in Harmos' own code.

Guards against reads of memory that was never written or is no longer owned, which sanitizers do not
see, for they do not know what uninstrumented libraries write. The run is the model problem with
2 x 4 subdomains of 4 x 4 elements, on one rank.

An error is Harmos' own if the innermost frame of its stack that is not of the C or C++ runtime, of
valgrind's replacements for it or of the standard library, is a function of namespace Harmos; what
happens deeper in MPI, BLAS, MUMPS or HDF5 is theirs. What these libraries are known for is left
out by valgrind.supp, or every report would be full of it.

    python3 tests/stability/valgrind_check.py          needs valgrind; without it exit status 77
"""

import os
import shutil
import subprocess
import sys
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

SUPPRESSIONS = Path(__file__).resolve().parent / "valgrind.supp"
RUNTIME = ("libc.so", "libstdc++", "libm.so", "libgcc_s", "ld-linux", "libpthread", "vgpreload")
STANDARD = ("std::", "__gnu_cxx::", "operator new", "operator delete", "malloc", "calloc", "free",
            "realloc", "memcpy", "memmove", "void std::", "__")
SECONDS = 1500


def is_own(stack):
    """Whether the innermost frame that says something is one of Harmos."""
    for frame in stack.findall("frame"):
        library = Path(frame.findtext("obj", "")).name
        function = frame.findtext("fn", "")
        if library.startswith(RUNTIME) or function.startswith(STANDARD):
            continue
        return "Harmos" in function
    return False


def own_errors(report):
    """The errors of Harmos' own code in a report, as text."""
    texts = []
    for error in ElementTree.parse(report).getroot().findall("error"):
        stack = error.find("stack")
        if stack is None or not is_own(stack):
            continue
        lines = [error.findtext("what") or error.findtext("xwhat/text", "")]
        lines += [f"    {f.findtext('fn', '?')} ({f.findtext('file', '')}:{f.findtext('line', '')})"
                  for f in stack.findall("frame")]
        texts.append("\n".join(lines))
    return texts


class Memory(unittest.TestCase):
    def setUp(self):
        self.valgrind = shutil.which("valgrind")
        if self.valgrind is None:
            self.skipTest("valgrind is not installed")
        self.directory = runs.scratch("valgrind")
        self.directory.mkdir()

    def check(self, program):
        report = self.directory / "report.xml"
        command = [
            self.valgrind, "--tool=memcheck", "--leak-check=full", "--show-leak-kinds=definite",
            "--error-limit=no", "--num-callers=40", f"--suppressions={SUPPRESSIONS}", "--xml=yes",
            f"--xml-file={report}", *map(str, program)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS,
                              cwd=self.directory, env=dict(os.environ, OMPI_MCA_btl="self"))
        return done, own_errors(report)

    def test_small_run(self):
        output = self.directory / "run"
        done, errors = self.check(
            [runs.BINARY / "bin" / "signorini", runs.MODEL,
             "--set", "Model/Subdomains per side=2", "--set", "Model/Elements per subdomain side=4",
             "--output", output])
        self.assertEqual(done.returncode, 0, done.stdout[-3000:] + done.stderr[-3000:])
        self.assertTrue((output / "summary.json").exists())
        self.assertEqual(errors, [], "\n\n".join(errors))

    def test_an_error_would_be_found(self):
        """A program that reads what it never wrote, in a function of namespace Harmos."""
        compiler = os.environ.get("CXX") or shutil.which("c++")
        if compiler is None:
            self.skipTest("no C++ compiler to plant an error with")
        source = self.directory / "planted.cpp"
        source.write_text(
            "#include <cstdlib>\n#include <vector>\n"
            "namespace Harmos { __attribute__((noinline)) int branch(const int* x) {"
            " return *x > 3 ? 1 : 2; } }\n"
            "int main() { int* x = static_cast<int*>(std::malloc(8)); int y = Harmos::branch(x + 1);\n"
            "  std::free(x); return y == 7; }\n", encoding="utf-8")
        program = self.directory / "planted"
        subprocess.run([compiler, "-O0", "-g", source, "-o", program], check=True)
        _, errors = self.check([program])
        self.assertEqual(len(errors), 1, errors)
        self.assertIn("Harmos::branch", errors[0])


if __name__ == "__main__":
    runs.main()
