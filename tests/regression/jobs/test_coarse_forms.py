# SPDX-License-Identifier: BSD-3-Clause
"""A coarse problem that every rank has whole and one in shares have the same answers.

On 2 and 4 ranks, two of the cases on 1 and 8 too; with the word Many all on 1, 8, 16, 32 and 64 (a long test, on any number of cores). And a rank that is killed, there or in the search for contact, leaves no other waiting.
Energies agree to 1e-10, products with F to one, and what is said of rigid motions word for word.
"""

import os
import re
import signal
import sys
import time
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TESTS / folder) for folder in ("support", "performance", "performance/messages")]
import communication
import harmos_runs as runs

APPS = runs.SOURCE / "apps"
FORMS = ("replicated", "distributed")

# Of what is held and floating, held by contact alone, jumping in its materials, with adaptive
# vectors, and with rows of G that are left out (composite.xml: 16 of 74).
CASES = {
    "held bodies": ("signorini", "signorini/decks/block.xml", {}),
    "floating bodies": ("signorini", "signorini/decks/model.xml", {"Decomposition/Dirichlet": "dual"}),
    "rank-deficient G": ("fiber_composite", "fiber_composite/decks/composite.xml", {}),
    "friction": ("harmos", "harmos/decks/greco_plate.xml", {}),
    "adhesion": ("harmos", "harmos/decks/lifted_beam.xml", {}),
    "weights": (
        "fiber_composite",
        "fiber_composite/decks/composite.xml",
        {"Dual operator/Expert/Weights": "stiffness"},
    ),
    "adaptive vectors": (
        "signorini",
        "signorini/decks/block.xml",
        {"Dual operator/Expert/Adaptive coarse vectors": "all"},
    ),
}
# On one rank nothing is shared, and eight on few cores take their time.
EVERYWHERE = ("floating bodies", "friction")
# A block on a floor, which does not hold it sideways.
BLOCK = """<ParameterList name="harmos">
  <ParameterList name="Model"><Parameter name="Physics" type="string" value="plane strain"/></ParameterList>
  <ParameterList name="Materials"><ParameterList name="stuff">
    <Parameter name="Young's modulus" type="double" value="1"/>
    <Parameter name="Poisson's ratio" type="double" value="0.3"/>
  </ParameterList></ParameterList>
  <ParameterList name="Bodies"><ParameterList name="block">
    <Parameter name="Source" type="string" value="block"/>
    <Parameter name="Size" type="Array(double)" value="{{1, 1, 1}}"/>
    <Parameter name="Subdomains a side" type="Array(int)" value="{{4, 4, 1}}"/>
    <Parameter name="Elements a side" type="Array(int)" value="{{2, 2, 1}}"/>
    <Parameter name="Materials" type="Array(string)" value="{{stuff}}"/>
  </ParameterList></ParameterList>
  <ParameterList name="Effects">
    <ParameterList name="Obstacle"><ParameterList name="floor">
      <Parameter name="Part" type="string" value="block/bottom"/>
    </ParameterList></ParameterList>
    <ParameterList name="Traction"><ParameterList name="load">
      <Parameter name="Part" type="string" value="block/top"/>
      <Parameter name="Density" type="Array(double)" value="{load}"/>
    </ParameterList></ParameterList>
  </ParameterList>
</ParameterList>
"""


def motions(text):
    """What is said of rigid motions, without numbers of a residual's size."""
    lines = [line for line in text.splitlines() if re.search("rigid-body mode|pulled away|unbalanced load", line)]
    return [re.sub(r"[-\d.]+e[-+]\d+", "#", line) for line in lines]


class Forms(unittest.TestCase):
    ranks = (1, 2, 4, 8)
    few = (2, 4)  # of cases that are not EVERYWHERE
    maxDiff = None

    def both(self, program, deck, sets, np):
        sets = {"Solver/Maximum iterations": "10000", **sets}
        return [
            runs.run(deck, {"Decomposition/Coarse problem": form, **sets}, np, program=program)
            for form in FORMS
        ]

    def test_answers(self):
        rows = []
        for name, (program, deck, sets) in CASES.items():
            for np in self.ranks if name in EVERYWHERE else self.few:
                with self.subTest(case=name, ranks=np):
                    whole, shared = self.both(program, APPS / deck, sets, np)
                    for form, done in zip(FORMS, (whole, shared)):
                        self.assertEqual(done.returncode, 0, done)
                        self.assertTrue(done.summary["converged"], done)
                        self.assertEqual(done.summary["coarse_problem"], form)
                    for key in ("kernel_dimension", "coarse_dimension"):
                        self.assertEqual(whole.summary[key], shared.summary[key], shared)
                    difference = abs(shared.summary["energy"] / whole.summary["energy"] - 1.0)
                    self.assertLess(difference, 1e-10, shared)
                    products = [
                        done.summary["hessian_applications"]
                        for done in (whole, shared)
                    ]
                    rows.append([name, np, whole.summary["coarse_dimension"], *products, f"{difference:.1e}"])
                    self.assertLessEqual(abs(products[1] - products[0]), 1, shared)
                    self.assertEqual(motions(whole.stdout), motions(shared.stdout), shared)
        runs.table(
            "Coarse problem replicated and distributed",
            ("case", "ranks", "dimension", "products", "in shares", "energies differ"),
            rows,
        )

    def test_diagnoses(self):
        for load, said in (("{1e-4, -0.02, 0}", "unbalanced load"), ("{0, 0.02, 0}", "pulled away")):
            deck = runs.scratch("deck").with_suffix(".xml")
            deck.write_text(BLOCK.format(load=load), encoding="utf-8")
            for np in self.ranks:
                with self.subTest(load=load, ranks=np):
                    texts = []
                    for done in self.both("harmos", deck, {}, np):
                        self.assertNotEqual(done.returncode, 0, done)
                        texts.append(motions(done.stdout + done.stderr))
                    self.assertIn(said, " ".join(texts[0]))
                    self.assertEqual(texts[0], texts[1])


class Killed(unittest.TestCase):
    """A rank that is killed ends the run, whatever the ranks are at."""

    def kill(self, delay, start):
        with self.subTest(delay=delay):
            done = start()
            self.assertTrue(done.wait_until(lambda: len(done.ranks()) == 4), done.text())
            time.sleep(delay)
            ranks = done.ranks()
            self.assertEqual(len(ranks), 4, "the run is over already\n" + done.text())
            os.kill(ranks[-1], signal.SIGKILL)
            self.assertNotEqual(done.end(60), 0)

    def test_in_the_coarse_problem_and_the_iterations(self):
        sets = {"Decomposition/Coarse problem": "distributed", "Solver/Tolerance": "1e-9"}
        deck = APPS / "fiber_composite" / "decks" / "debonding.xml"
        for delay in (0.1, 0.3, 0.5, 0.7):
            self.kill(delay, lambda: runs.Background(deck, sets, np=4, program="fiber_composite"))

    def test_in_the_search_for_contact(self):
        """A program that does nothing else, on surfaces of which it has some seconds."""
        program = str(runs.BINARY / "tests" / "bin" / "contact_search")
        words = ("--side", "2", "--elements", "96")
        for delay in (0.2, 0.6, 1.0):
            self.kill(delay, lambda: runs.Background(None, {}, np=4, words=words, program=program))


class Many(Forms):
    ranks = few = (1, 8, 16, 32, 64)

    def test_clusters_by_auto(self):
        """From 32 ranks on the model is asked, which is told here that coarse solves take long."""
        deck, rates = (runs.scratch(name).with_suffix(end) for name, end in (("bar", ".xml"), ("rates", ".json")))
        # Consecutive subdomains are cubes of 2 x 2 x 2.
        deck.write_text(communication.deck_of("solid", (2, 2, 64), 3), encoding="utf-8")
        rates.write_text('{"coarse_entries": 1e6, "coarse_from_memory": 1e6}', encoding="utf-8")
        sets = {
            "Decomposition/Coarse problem": "replicated",
            "Decomposition/Dirichlet": "dual",
            "Solver/Tolerance": "1e-9",
        }
        slow = sets | {"Dual operator/Expert/Rates": rates}
        cases = ((16, slow, 0), (32, slow, 32), (32, sets, 0))
        energies = []
        for np, these, clusters in cases:
            with self.subTest(ranks=np, clusters=clusters):
                done = runs.run(deck, these, np, program="harmos")
                self.assertTrue(done.summary["converged"], done)
                self.assertEqual(done.summary["clusters"], clusters)
                self.assertEqual("32 clusters of about 8 subdomains, joined by" in done.stdout, clusters > 0)
                self.assertEqual(done.summary["coarse_dimension"], 6 * (clusters or 256))
                energies.append(done.summary["energy"])
        # Errors of the energy go with squares of the tolerance.
        self.assertLess(max(energies) - min(energies), 1e-10 * abs(energies[0]))


if __name__ == "__main__":
    runs.main()
