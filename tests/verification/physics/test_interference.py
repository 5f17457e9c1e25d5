# SPDX-License-Identifier: BSD-3-Clause
"""An interference of two bars that goes with a history, against bars.

Bars of lengths L and stiffnesses E, without sideways contraction, are held at their outer ends and overlap by δh(t):

    p = E δ h/2L,  stored energy = ½ p δ h A, all of it from outside, and none is left where h goes back to zero.

What it guards against: gaps of another time, of half a step that was tried again, on other ranks; work that is lost.
"""

import csv
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import harmos_runs as runs  # noqa: E402

YOUNG, LENGTH, WIDTH, OVERLAP = 200.0, 2.0, 1.5, 0.01
FORCE = YOUNG * OVERLAP / (2 * LENGTH) * WIDTH
TIMES, VALUES = (1.0, 2.0, 3.0, 4.0), (0.5, 1.0, 0.25, 0.0)
HISTORY = {
    "Steps/Times": "{1,2,3,4}", "Steps/Histories/h/Times": "{0,1,2,3,4}", "Steps/Histories/h/Values": "{0,0.5,1,0.25,0}",
    "Effects/Contact/joint/History": "h",
}


def bar(name, bottom, elements, parts):
    return f"""    <ParameterList name="{name}">
      <Parameter name="Source" type="string" value="block"/>
      <Parameter name="Origin" type="Array(double)" value="{{0, {bottom}, 0}}"/>
      <Parameter name="Size" type="Array(double)" value="{{{WIDTH}, {LENGTH}, 1}}"/>
      <Parameter name="Elements a side" type="Array(int)" value="{{{elements}, 1}}"/>
      <Parameter name="Subdomains a side" type="Array(int)" value="{{1, {parts}, 1}}"/>
      <Parameter name="Materials" type="Array(string)" value="{{steel}}"/>
    </ParameterList>
"""


DECK = f"""<ParameterList>
  <ParameterList name="Model"><Parameter name="Physics" type="string" value="plane strain"/></ParameterList>
  <ParameterList name="Materials"><ParameterList name="steel">
    <Parameter name="Young's modulus" type="double" value="{YOUNG}"/>
    <Parameter name="Poisson's ratio" type="double" value="0"/>
  </ParameterList></ParameterList>
  <ParameterList name="Bodies">
{bar("lower", 0.0, "3, 2", 2)}{bar("upper", LENGTH, "5, 3", 1)}  </ParameterList>
  <ParameterList name="Effects">
    <ParameterList name="Prescribed displacement">
      <ParameterList name="bottom"><Parameter name="Part" type="string" value="lower/bottom"/></ParameterList>
      <ParameterList name="top"><Parameter name="Part" type="string" value="upper/top"/></ParameterList>
    </ParameterList>
    <ParameterList name="Contact"><ParameterList name="joint">
      <Parameter name="First" type="string" value="lower/top"/>
      <Parameter name="Second" type="string" value="upper/bottom"/>
      <Parameter name="Interference" type="double" value="{OVERLAP}"/>
    </ParameterList></ParameterList>
  </ParameterList>
</ParameterList>
"""


class Interference(unittest.TestCase):
    def solve(self, sets=None, np_=2, name="bars"):
        directory = runs.scratch(name)
        directory.mkdir(parents=True, exist_ok=True)
        (directory / "deck.xml").write_text(DECK, encoding="utf-8")
        run = runs.run(directory / "deck.xml", {"Solver/Tolerance": 1e-10} | (sets or {}), np=np_,
                       output=directory / "out", program="harmos")
        self.assertEqual(run.returncode, 0, f"{run}")
        return run

    def expect(self, forces, factor):
        """Of the contact and both supports, by their path; ten times the tolerance."""
        exact = FORCE * factor
        for path, sign in (("Contact/joint", -1), ("Prescribed displacement/bottom", 1), ("Prescribed displacement/top", -1)):
            self.assertAlmostEqual(forces[path][1], sign * exact, delta=1e-9 * FORCE, msg=path)

    def test_one_state(self):
        summary = self.solve().summary
        self.expect({path: entry["force"] for path, entry in summary["forces"].items()}, 1.0)
        for column in ("energy", "external_work"):
            self.assertAlmostEqual(summary["steps"][0][column], 0.5 * FORCE * OVERLAP, delta=1e-9 * FORCE * OVERLAP)

    def test_history(self):
        for np_ in (1, 2, 4):
            run = self.solve(HISTORY, np_)
            with open(Path(run.directory) / "steps.csv", newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual([float(row["time"]) for row in rows], list(TIMES))
            for row, factor in zip(rows, VALUES):
                with self.subTest(ranks=np_, time=row["time"]):
                    self.expect({path: [float(row[f"{path}/f{c}"]) for c in "xyz"] for path in run.summary["forces"]}, factor)
                    energy = 0.5 * FORCE * OVERLAP * factor**2
                    for column in ("energy", "external_work"):
                        self.assertAlmostEqual(float(row[column]), energy, delta=1e-9 * FORCE * OVERLAP, msg=column)

    def test_it_adds_to_the_gap(self):
        # The meshes are apart by δ/2: that is closed first.
        run = self.solve(HISTORY | {"Effects/Contact/joint/Gap": OVERLAP / 2})
        with open(Path(run.directory) / "steps.csv", newline="", encoding="utf-8") as file:
            forces = [-float(row["Contact/joint/fy"]) for row in csv.DictReader(file)]
        for force, factor in zip(forces, VALUES):
            self.assertAlmostEqual(force, FORCE * max(0.0, factor - 0.5), delta=1e-9 * FORCE)

    def test_glue_binds_what_touches_at_the_beginning(self):
        # h goes below zero: the joint opens by −δh, against bars and glue of k in series.
        glue, values = 1000.0, (0.5, 1.0, -0.5, -1.0)
        kind = "Effects/Adhesion/glue"
        run = self.solve(HISTORY | {
            "Steps/Histories/h/Values": "{0,0.5,1,-0.5,-1}", f"{kind}/Contact": "joint",
            f"{kind}/Normal stiffness": glue, f"{kind}/Tangential stiffness": glue, f"{kind}/Normal strength": 100.0,
            f"{kind}/Tangential strength": 100.0, f"{kind}/Law": "brittle",
        })
        soft = WIDTH / (2 * LENGTH / YOUNG + 1 / glue)
        with open(Path(run.directory) / "steps.csv", newline="", encoding="utf-8") as file:
            for row, factor in zip(csv.DictReader(file), values):
                exact = FORCE * factor if factor > 0 else OVERLAP * factor * soft
                self.assertAlmostEqual(-float(row["Contact/joint/fy"]), exact, delta=1e-8 * FORCE)

    def test_two_contacts_at_a_point_are_refused(self):
        other = "Effects/Contact/other"
        directory = runs.scratch("two")
        directory.mkdir(parents=True, exist_ok=True)
        (directory / "deck.xml").write_text(DECK, encoding="utf-8")
        sets = HISTORY | {f"{other}/First": "lower/top", f"{other}/Second": "upper/bottom"}
        run = runs.run(directory / "deck.xml", sets, np=runs.RANKS, output=directory / "out", program="harmos")
        self.assertEqual(run.returncode, 2, f"{run}")
        self.assertIn('contact "joint" has an interference where contact "other" has the same point', run.stderr)


if __name__ == "__main__":
    runs.main()
