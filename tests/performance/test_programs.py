# SPDX-License-Identifier: BSD-3-Clause
"""The performance programs run, write what their README says, and converge. No time is judged.

Guards against: a benchmark that rots; a document whose fields are not those described; counts that
grow with the mesh where the users' guide says that they do not.
"""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

README = Path(__file__).parent / "README.md"


def run(program, *arguments, np=2):
    output = runs.scratch(program)
    binary = runs.BINARY / "tests/bin" / program
    status, _, errors = runs.execute([*runs.launcher(np), binary, *arguments, "--output", output])
    assert status == 0, errors
    return json.loads(output.read_text(encoding="utf-8"))


def described(program):
    """Fields of a run that the README's table names."""
    section = README.read_text(encoding="utf-8").split(f"## {program}\n")[1].split("\n## ")[0]
    names = set()
    for row in re.findall(r"^\| (`[^|]*`) \|", section, re.M):
        names.update(re.findall(r"`([^`]*)`", row))
    return names


class Programs(unittest.TestCase):
    def test_qp_kernels(self):
        document = run("qp_kernels", "--sizes", "1000,10000", "--repetitions", "1")
        self.assertEqual([r["entries"] for r in document["runs"]], [1000, 10000])
        for item in document["runs"]:
            self.assertEqual(set(item), described("qp_kernels"))
            self.assertTrue(item["results_agree"])
            self.assertGreater(item["fused_seconds"], 0)

    def test_journal_bearing(self):
        document = run("journal_bearing", "--sizes", "64,128", "--repetitions", "1")
        counts = []
        for item in document["runs"]:
            self.assertEqual(set(item) - {"n"}, described("journal_bearing"))
            finest = item["levels"][-1]
            self.assertEqual((finest["n"], finest["method"]), (item["n"], "PDAS"))
            for level in item["levels"]:
                self.assertEqual(level["reason"], "converged")
            self.assertLessEqual(finest["relative_projected_gradient"], 1e-6)
            counts.append(finest["hessian_applications"])
        # The bracket of the users' guide: 1.5 from one mesh to others.
        self.assertLessEqual(counts[1], 1.5 * counts[0])


if __name__ == "__main__":
    runs.main()
