# SPDX-License-Identifier: BSD-3-Clause
"""Settings that must not show: decomposition, coarse problem, local solver and ranks, for all that acts between bodies.

    combinations.py        HARMOS_SCENES: how many runs; HARMOS_FIRST_SCENE: from which on

Energies of every step agree with those of whole bodies on one rank, solved a hundred times as far. It guards against
settings that work one by one and not together: a preconditioner that is blind to rows, a coarse problem that meets faces
it cannot take, local solvers that are told of as what they are not.
"""

import csv
import functools
import os
import random
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "support"), str(HERE.parents[1] / "apps" / "tools")]

import glued_blocks  # noqa: E402
import harmos_decks  # noqa: E402
import harmos_runs as runs  # noqa: E402

FIRST, SCENES = int(os.environ.get("HARMOS_FIRST_SCENE", "0")), int(os.environ.get("HARMOS_SCENES", "400"))
TOLERANCE = 1e-8
ALLOWED = 10.0 * TOLERANCE  # of energies, whose errors are the squares of those of residuals, times a condition


def energies(run, has_steps):
    """By time; those that the deck asks for, however steps were divided."""
    if not has_steps:
        return {0.0: run.summary["energy"]}
    with open(run.directory / "steps.csv", newline="", encoding="utf-8") as file:
        return {
            float(row["time"]): float(row["energy"])
            for row in csv.DictReader(file)
            if float(row["time"]) in (1.0, 2.0, 3.0)
        }


@functools.cache
def deck(scene, dimension, torn):
    path = runs.scratch("deck").with_suffix(".xml")
    tree = glued_blocks.tree(scene, dimension, torn)
    path.write_text(harmos_decks.xml("harmos", tree), encoding="utf-8")
    return path


@functools.cache
def whole(scene, dimension):
    """The energies of a block in one piece each."""
    sets = {"Solver/Tolerance": TOLERANCE / 100.0, "Decomposition/Clusters": "none"}
    run = runs.run(deck(scene, dimension, False), sets, np=1, program="harmos")
    return run, energies(run, scene[3]) if run.returncode == 0 else {}


class Combinations(unittest.TestCase):
    def test_energies(self):
        worst = 0.0
        for number in range(FIRST, FIRST + SCENES):
            dice = random.Random(number)
            scene = glued_blocks.SCENES[number % len(glued_blocks.SCENES)]
            dimension = dice.choice((2, 3))
            settings = glued_blocks.sample(dice)
            words = f"{number}: {dimension}D {glued_blocks.name_of(scene)}; {settings}"
            ranks = settings.pop("ranks")
            with self.subTest(words):
                reference, expected = whole(scene, dimension)
                self.assertEqual(reference.returncode, 0, reference)
                settings["Solver/Tolerance"] = TOLERANCE
                run = runs.run(deck(scene, dimension, True), settings, np=ranks, program="harmos")
                self.assertEqual(run.returncode, 0, run)
                found = energies(run, scene[3])
                self.assertEqual(sorted(found), sorted(expected), run)
                difference = max(abs(found[t] / expected[t] - 1.0) for t in expected)
                worst = max(worst, difference)
                self.assertLess(difference, ALLOWED, (found, expected))
        print(f"{SCENES} runs from {FIRST} on: the worst is {worst:.1e}, {ALLOWED:.0e} is allowed")


if __name__ == "__main__":
    runs.main()
