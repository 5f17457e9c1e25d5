# SPDX-License-Identifier: BSD-3-Clause
"""The mutation check is ready to run: every fault that it plants still has its place in the sources.

Guards against faults that rot when the sources change, and against a check that does not notice.
Faults are planted and tests run by hand, see docs/stability_checks.md: that takes half an hour.
"""

import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True

import harmos_runs as runs  # noqa: E402
import mutation_check  # noqa: E402

SCRIPT = Path(mutation_check.__file__)


class MutationCheck(unittest.TestCase):
    def test_every_fault_has_its_place(self):
        done = subprocess.run([sys.executable, SCRIPT, "--list"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertGreaterEqual(len(done.stdout.splitlines()), 10)

    def test_faults_are_spread_over_the_packages(self):
        packages = {Path(item.file).parts[1] for item in mutation_check.FAULTS}
        self.assertEqual(packages, {"qp", "feti", "fem", "contact", "scene", "effects", "run", "rol",
                                    "sensitivity"})

    def test_texts_that_are_not_there_or_not_once_are_refused(self):
        item = mutation_check.FAULTS[0]
        for text in ("no such text", "const "):
            wrong = mutation_check.fault("planted", item.file, text, "other", item.tests)
            faults, mutation_check.FAULTS = mutation_check.FAULTS, (wrong,)
            try:
                self.assertEqual(len(mutation_check.misfits(mutation_check.SOURCE)), 1, text)
            finally:
                mutation_check.FAULTS = faults

    def test_numbers_beyond_the_list_are_refused(self):
        done = subprocess.run([sys.executable, SCRIPT, "--only", "99"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("numbered 1 to", done.stderr)


if __name__ == "__main__":
    runs.main()
