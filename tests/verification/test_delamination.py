#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Cracks that grow along an interface, against beam theory and published finite elements.

    test_delamination.py [-v] [CLASS]...

    Opened    the double cantilever beam of Alfano and Crisfield (Int. J. Numer. Meth. Engng. 50, 2001) with both of their
              strengths: stiffness, peak load on four meshes, energies
    Bent      an end-notched flexure beam: a crack in shear, between faces that press on each other
"""

import csv
import sys
import unittest
from dataclasses import replace
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "oracles"), str(HERE.parent / "support")]

import beams  # noqa: E402
import harmos_runs as runs  # noqa: E402


class Case(unittest.TestCase):
    def solve(self, deck, steps, sets=None):
        """Rows of steps.csv, those of parts of a step too."""
        path = runs.scratch("delamination").with_suffix(".xml")
        path.write_text(deck, encoding="utf-8")
        run = runs.solved(self, path, {"Output/Fields": False, **(sets or {})}, program="harmos")
        with open(run.directory / "steps.csv", encoding="utf-8") as file:
            rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
        self.assertEqual(rows[-1]["step"], steps)
        self.check_energies(rows)
        return rows

    def check_energies(self, rows):
        """Work under prescribed displacements is stored, dissipated or released; damage does not heal."""
        for before, row in zip(rows, rows[1:]):
            self.assertGreaterEqual(row["dissipated"], before["dissipated"])
            self.assertGreaterEqual(row["broken"], before["broken"])
        last = rows[-1]
        rest = last["external_work"] - last["energy"] - last["dissipated"] - last["released"]
        self.assertLessEqual(abs(rest), 1e-3 * last["external_work"])
