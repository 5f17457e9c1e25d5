# SPDX-License-Identifier: BSD-3-Clause
"""Dual operator/Local solver: each solver gives the same answer, and one that cannot do its part is rejected.

    test_local_solvers.py [Names]          without a class: Names; "Decks" is long

Decks runs every deck with MUMPS, and every one that may with KLU2, beside the default.

What it guards against: a solver that is accepted and not used; a name or a precision that is ignored; answers that
depend on the solver.
"""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

SOLVER = "Dual operator/Local solver"
BLOCK = runs.DECKS / "block.xml"


def deck_list():
    return sorted(
        deck
        for deck in (runs.SOURCE / "apps").glob("*/decks/*.xml")
        if deck.parents[1].name not in ("study", "shape")
    )


def converged(test, deck, sets, program="signorini", np=2):
    result = runs.run(deck, sets, np=np, program=program)
    test.assertEqual(result.returncode, 0, result)
    return result


def compare_forces(test, expected, found, share):
    """Resultants of all effects, relative to the largest component."""
    test.assertEqual(expected.keys(), found.keys())
    largest = max((abs(f) for e in expected.values() for f in e["force"]), default=0.0)
    for name, effect in expected.items():
        for a, b in zip(effect["force"], found[name]["force"]):
            test.assertAlmostEqual(a, b, delta=share * largest, msg=name)


class Names(unittest.TestCase):
    def test_each_solver_in_each_form_that_it_has(self):
        """Energies are of second order in the error, 1e-8 of them at a tolerance of 1e-6; forces of first order:
        ten tolerances."""
        reference = converged(self, BLOCK, {"Solver/Tolerance": 1e-6}).summary
        self.assertEqual(reference["local_solver"], "multifrontal")
        for solver, forms in (
            ("multifrontal", ("implicit",)),
            ("MUMPS", ("condensed", "implicit")),
            ("KLU2", ("implicit",)),
        ):
            for form in forms:
                with self.subTest(solver=solver, form=form):
                    sets = {SOLVER: solver, "Dual operator/Form": form, "Solver/Tolerance": 1e-6}
                    result = converged(self, BLOCK, sets)
                    energy = reference["energy"]
                    self.assertAlmostEqual(result.summary["energy"], energy, delta=1e-8 * abs(energy))
                    compare_forces(self, reference["forces"], result.summary["forces"], 1e-5)
                    self.assertEqual(result.summary["local_solver"], solver)
                    self.assertTrue(result.summary["dual_operator"].startswith(form), result.summary)
                    self.assertIn(f"local factorisations ({solver})", result.stdout)

    def test_auto_takes_the_form_that_the_solver_has(self):
        summary = converged(self, BLOCK, {SOLVER: "KLU2"}).summary
        self.assertTrue(summary["dual_operator"].startswith("implicit, double"), summary)

    def test_compression_is_by_mumps(self):
        summary = converged(self, BLOCK, {"Dual operator/Expert/Block low rank tolerance": 1e-12}).summary
        self.assertEqual(summary["local_solver"], "MUMPS")

    def test_the_old_name_is_read_with_a_note(self):
        result = converged(self, BLOCK, {"Dual operator/Implicit solver": "MUMPS"})
        self.assertEqual(result.summary["local_solver"], "MUMPS")
        self.assertIn(
            '"Dual operator/Implicit solver" is now "Dual operator/Local solver"; '
            "this version still reads the old name",
            result.stdout,
        )

    def test_what_cannot_be_is_rejected(self):
        for sets, text in (
            (
                {"Local solver": "multifrontl", "Form": "condensed"},
                '"Dual operator/Local solver" = "multifrontl" is not available in this Trilinos; did you mean "multifrontal"?',
            ),
            (
                {"Local solver": "Tacho", "Form": "implicit"},
                '"Dual operator/Local solver" = "Tacho" is not available in this Trilinos',
            ),
            (
                {"Local solver": "KLU2", "Form": "condensed"},
                'has no Schur complements, which "Dual operator/Form" = "condensed" needs; use "multifrontal" or '
                '"MUMPS", or the form "implicit"',
            ),
            (
                {"Local solver": "KLU2", "Precision": "single"},
                'has no factors in single precision; use "multifrontal" or "MUMPS", or double precision',
            ),
            (
                {"Local solver": "KLU2", "Expert/Block low rank tolerance": 1e-9},
                'has no block low rank factors; use "MUMPS"',
            ),
        ):
            with self.subTest(sets=sets):
                result = runs.run(BLOCK, {f"Dual operator/{k}": v for k, v in sets.items()})
                self.assertEqual(result.returncode, 2, result)
                self.assertIn(text, result.errors[0])


class Decks(unittest.TestCase):
    """Energies to ten tolerances; forces to a hundred, which is what the solver promises of each contact."""

    def test_all(self):
        for deck in deck_list():
            program = deck.parents[1].name
            reference = converged(self, deck, {}, program)
            tolerance = 1e-4
            for solver in ("MUMPS", "KLU2"):
                with self.subTest(deck=deck.name, solver=solver):
                    summary = converged(self, deck, {SOLVER: solver}, program).summary
                    self.assertEqual(summary["local_solver"], solver)
                    energy = reference.summary["energy"]
                    self.assertAlmostEqual(summary["energy"], energy, delta=10 * tolerance * abs(energy))
                    expected, found = reference.summary.get("forces", {}), summary.get("forces", {})
                    compare_forces(self, expected, found, 100 * tolerance)


if __name__ == "__main__":
    runs.main()
