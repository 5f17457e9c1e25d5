# SPDX-License-Identifier: BSD-3-Clause
"""Contacts that are found by distance and direction, against the same ones by name.

Three blocks on each other with gaps, and one aside that touches nothing. What it guards against: pairs that are missed or
made twice, parts of other sides than those that face each other, parameters that do not reach the contact, answers that
depend on ranks.
"""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import harmos_runs as runs  # noqa: E402

GAP = 0.01


def block(name, origin, elements, parts):
    return f"""<ParameterList name="{name}">
      <Parameter name="Source" type="string" value="block"/>
      <Parameter name="Origin" type="Array(double)" value="{{{origin[0]}, {origin[1]}, 0}}"/>
      <Parameter name="Elements a side" type="Array(int)" value="{{{elements}, {elements}, 1}}"/>
      <Parameter name="Subdomains a side" type="Array(int)" value="{{{parts}, 1, 1}}"/>
      <Parameter name="Materials" type="Array(string)" value="{{steel}}"/></ParameterList>
"""


BODIES = (block("base", (0.0, 0.0), 4, 2) + block("middle", (0.0, 1.0 + GAP), 5, 1) + block("top", (0.0, 2.0 + GAP), 3, 2)
          + block("aside", (1.5, 0.0), 2, 1))
HELD = "".join(f"""<ParameterList name="{part.replace('/', ' ')}"><Parameter name="Part" type="string" value="{part}"/>
      <Parameter name="Components" type="Array(string)" value="{components}"/></ParameterList>
""" for part, components in (("base/bottom", "{x, y}"), ("aside/bottom", "{x, y}"), ("middle/left", "{x}"), ("top/left", "{x}")))
DECK = f"""<ParameterList>
  <ParameterList name="Model"><Parameter name="Physics" type="string" value="plane strain"/></ParameterList>
  <ParameterList name="Materials"><ParameterList name="steel">
    <Parameter name="Young's modulus" type="double" value="100"/></ParameterList></ParameterList>
  <ParameterList name="Bodies">
{BODIES}  </ParameterList>
  <ParameterList name="Effects">
    <ParameterList name="Prescribed displacement">{HELD}</ParameterList>
    <ParameterList name="Traction"><ParameterList name="load">
      <Parameter name="Part" type="string" value="top/top"/>
      <Parameter name="Pressure" type="double" value="2"/></ParameterList></ParameterList>
    CONTACTS
  </ParameterList>
</ParameterList>
"""


# First is the side of more sides.
PARTS = {"base-middle": ("base/top", "middle/bottom"), "middle-top": ("top/bottom", "middle/top")}


def by_name(names=PARTS, more="", kind="Contact"):
    lists = "".join(f"""<ParameterList name="{name}"><Parameter name="First" type="string" value="{PARTS[name][0]}"/>
      <Parameter name="Second" type="string" value="{PARTS[name][1]}"/>{more}</ParameterList>
""" for name in names)
    return f'<ParameterList name="{kind}">{lists}</ParameterList>'


def automatic(**values):
    return ('<ParameterList name="Automatic contact"><ParameterList name="all">' + "".join(
        f'<Parameter name="{name.replace("_", " ")}" type="{"Array(string)" if isinstance(value, str) else "double"}" '
        f'value="{value}"/>' for name, value in values.items()) + "</ParameterList></ParameterList>")


FRICTION = '<ParameterList name="Friction">' + "".join(f"""<ParameterList name="{name}">
      <Parameter name="Contact" type="string" value="Contact/{name}"/>
      <Parameter name="Coefficient" type="double" value="0.2"/></ParameterList>""" for name in PARTS) + "</ParameterList>"


class Automatic(unittest.TestCase):
    def solve(self, *contacts, np_=2, status=0, name="automatic"):
        directory = runs.scratch(name)
        directory.mkdir(parents=True, exist_ok=True)
        text = DECK.replace("CONTACTS", "".join(contacts))
        (directory / "deck.xml").write_text(text, encoding="utf-8")
        run = runs.run(directory / "deck.xml", {"Solver/Tolerance": 1e-10}, np=np_, output=directory / "out", program="harmos")
        self.assertEqual(run.returncode, status, f"{run}")
        return run

    def compare(self, run, other):
        self.assertEqual(set(run.summary["forces"]), set(other.summary["forces"]))
        for path, entry in run.summary["forces"].items():
            for one, two in zip(entry["force"], other.summary["forces"][path]["force"]):
                self.assertAlmostEqual(one, two, delta=1e-8, msg=path)
        self.assertAlmostEqual(run.summary["energy"], other.summary["energy"], delta=1e-9)

    def test_pairs_are_found(self):
        other = self.solve(by_name())
        self.assertAlmostEqual(abs(other.summary["forces"]["Contact/base-middle"]["force"][1]), 2.0, delta=1e-8)
        for np_ in (1, 2, 4):
            with self.subTest(ranks=np_):
                run = self.solve(automatic(), np_=np_)
                self.assertIn('Automatic contact "base-middle": "base" (8 sides) and "middle" (5 sides)', run.stdout)
                self.assertIn('Automatic contact "middle-top": "middle" (5 sides) and "top" (6 sides)', run.stdout)
                self.compare(run, other)

    def test_parameters_reach_the_contact(self):
        run = self.solve(automatic(Adjust=2 * GAP, Friction_coefficient=0.2))
        more = f'<Parameter name="Adjust" type="double" value="{2 * GAP}"/>'
        self.compare(run, self.solve(by_name(more=more) + FRICTION))
        self.assertGreater(abs(run.summary["forces"]["Contact/base-middle"]["tangential"][0]), 0.01)

    def test_pairs_that_are_coupled_are_left_out(self):
        run = self.solve(automatic(), by_name(["middle-top"], kind="Tie"))
        self.assertEqual([path for path in run.summary["forces"] if path.startswith("Contact")], ["Contact/base-middle"])

    def test_names_of_the_deck_stay(self):
        # A contact that the deck calls "base-middle" is another one.
        own = by_name(["middle-top"]).replace('"middle-top"', '"base-middle"')
        run = self.solve(automatic(), own)
        self.assertIn('Automatic contact "base-middle-2"', run.stdout)
        forces = run.summary["forces"]
        for name in ("base-middle", "base-middle-2"):
            self.assertAlmostEqual(abs(forces[f"Contact/{name}"]["force"][1]), 2.0, delta=1e-8)

    def test_frictions_of_the_deck_stay(self):
        # The deck's friction "base-middle" acts on a contact of another name.
        own = by_name(["middle-top"]).replace('"middle-top"', '"joint"')
        friction = FRICTION[: FRICTION.index("</ParameterList>") + len("</ParameterList>")] + "</ParameterList>"
        run = self.solve(automatic(), own, friction.replace("Contact/base-middle", "joint"))
        other = self.solve(by_name().replace('"middle-top"', '"joint"'), friction.replace("Contact/base-middle", "joint"))
        expected = other.summary["forces"]["Contact/joint"]["tangential"]
        self.assertGreater(abs(expected[0]), 1e-4)
        self.assertAlmostEqual(run.summary["forces"]["Contact/joint"]["tangential"][0], expected[0], delta=1e-8)
        self.assertNotIn("tangential", run.summary["forces"]["Contact/base-middle-2"])

    def test_a_contact_on_a_thick_body_is_refused(self):
        thick = '<ParameterList name="Expert"><Parameter name="Thickness" type="Array(double)" value="{2}"/></ParameterList>'
        deck = DECK.replace('<ParameterList name="base">', '<ParameterList name="base">' + thick)
        directory = runs.scratch("thick")
        directory.mkdir(parents=True)
        (directory / "deck.xml").write_text(deck.replace("CONTACTS", automatic()), encoding="utf-8")
        run = runs.run(directory / "deck.xml", np=2, output=directory / "out", program="harmos")
        self.assertEqual(run.returncode, 2, f"{run}")
        self.assertIn('acts on body "base", which has a "Thickness" other than 1', run.stderr)

    def test_bodies_are_chosen(self):
        run = self.solve(automatic(Bodies="{middle, base}"), by_name(["middle-top"]))
        self.compare(run, self.solve(by_name()))
        run = self.solve(automatic(Bodies="{midle}"), by_name(), status=2)
        self.assertIn('did you mean "middle"', run.stderr)

    def test_nothing_near_is_told(self):
        # Near are those that the deck couples.
        run = self.solve(automatic(Distance=0.5 * GAP), by_name())
        self.assertIn("no two of its bodies have sides that face each other", run.stdout + run.stderr)


if __name__ == "__main__":
    runs.main()
