# SPDX-License-Identifier: BSD-3-Clause
"""The parameters of decks as users see them.

    Printed     --print-parameters that prints too much to be read, or not what decks may hold
    Misspelt    expert parameters that are not offered, or contradict each other
    OldPlaces   decks of version 0.1 that are refused, or run to another answer
"""

import re
import sys
from pathlib import Path
from xml.etree import ElementTree

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import harmos_runs as runs  # noqa: E402
from test_command_line import TINY, Case, deck, parameter, sublist  # noqa: E402


class Printed(Case):
    # Names that may not change: users' decks hold them.
    NAMES = [
        path.split("/")
        for path in (
            "Model/Subdomains per side",
            "Model/Elements per subdomain side",
            "Model/Interface",
            "Decomposition/Dirichlet",
            "Dual operator/Form",
            "Dual operator/Preconditioner",
            "Solver/Tolerance",
            "Solver/Stopping rule",
            "Solver/Method",
            "Output/Fields",
        )
    ]

    def printed(self, *words, np=2):
        result = self.start(words, np)
        self.assertEqual(result.returncode, 0, result)
        self.assertEqual(result.errors, [], result)
        self.assertEqual(list(self.place.iterdir()), [])
        return result.stdout

    def test_public_parameters_on_two_screens(self):
        for program in ("signorini", "harmos", "fiber_composite", "shape", "study"):
            if not runs.is_built(program):
                continue
            lines = runs.start(["--print-parameters"], np=0, program=program).stdout.splitlines()
            with self.subTest(program=program):
                # Each kind of effect has a line, besides.
                effects = sum(re.match(r"  [^ /][^/]*/<", line) is not None for line in lines)
                self.assertLessEqual(len(lines) - effects, 90)
                self.assertLessEqual(max(map(len, lines)), 118)

    def test_public_parameters_as_text(self):
        text = self.printed("--print-parameters")
        self.assertEqual(text, self.printed("--print-parameters", "text", np=0))
        self.assertEqual(text, self.printed("--print-parameters", runs.MODEL, np=0))
        for path, name in self.NAMES:
            section = text[text.index(f"\n{path}  -- ") :]
            self.assertRegex(section, rf"\n  {name} = \S")
        self.assertEqual(text.count("Subdomains per side = "), 1)  # once, so that no rank repeats it
        self.assertNotIn("Initial guess", text)
        self.assertRegex(text, r"Preconditioner = \"auto\" .*\[auto \| none \| lumped \| Dirichlet\]")
        self.assertIn("in Solver/Expert)", text)

    def test_one_list_or_parameter(self):
        text = self.printed("--print-parameters", "Solver")
        self.assertTrue(text.startswith("Solver  -- "), text)
        self.assertIn("Tolerance = 0.0001   [real in (0, 1)]", text)
        self.assertIn('"half load": λ⁰ = ½Bf', text)
        for words in ("Dual operator", "Output  --"):
            self.assertNotIn(f"\n{words}", text)
        # With the path of a list in "Expert", with or without it.
        pdas = self.printed("--print-parameters", "Solver/Expert/PDAS", np=0)
        self.assertTrue(pdas.startswith("Solver/Expert/PDAS  -- "), pdas)
        self.assertEqual(self.printed("--print-parameters", "Solver/PDAS", np=0), pdas)
        form = self.printed("--print-parameters", "Dual operator/Form", np=0)
        self.assertRegex(form, r"\A.*\n  Form = \"auto\"   \[choice\]\n")
        self.refuse(["--print-parameters", "Solver/Tolerence"], 'did you mean "Tolerance"?', checked=False)

    def test_all_parameters_as_text(self):
        text = self.printed("--print-parameters", "all")
        self.assertIn("\nSolver/Expert/PDAS  -- ", text)
        for path, name in self.NAMES:
            # Name, default, type; once, so that no rank repeats it.
            section = text[text.index(f"\n{path}  -- ") :]
            self.assertRegex(section, rf"\n  {name} = \S.*\[(integer|real|boolean|choice)")
        self.assertEqual(text.count("Subdomains per side = "), 1)
        self.assertIn("Tolerance = 0.0001   [real in (0, 1)]", text)

    def test_parameters_as_markdown(self):
        text = self.printed("--print-parameters", "markdown")
        for path, name in self.NAMES:
            section = text[text.index(f"## signorini/{path}\n") :]
            self.assertIn(f"\n* `{name}`: ", section)
            self.assertEqual(text.count(f"## signorini/{path}\n"), 1)
        self.assertIn("\n* `Tolerance`: real in (0, 1), default `0.0001`. ", text)
        self.assertIn("\n  * `lumped`: ", text)
        for line in text.splitlines():
            self.assertLessEqual(len(line), 118, line)
            # Each line is a heading, an item, its continuation or a paragraph, and none begins as something else.
            self.assertNotRegex(line, r"^\s*([-+|>]|\*(?! `)|\d+\.) ", line)

    def test_parameters_as_a_deck(self):
        text = self.printed("--print-parameters", "xml")
        root = ElementTree.fromstring(text)
        for path, name in self.NAMES:
            entry = root.find(f'ParameterList[@name="{path}"]/Parameter[@name="{name}"]')
            self.assertIsNotNone(entry, f"{path}/{name}")
            self.assertTrue(entry.get("docString"), f"{path}/{name}")
        # It is itself a deck.
        path = self.write(text)
        result = self.start([path, "--check"], 0)
        self.assertEqual(result.returncode, 0, result)

    def test_parameters_in_an_unknown_form(self):
        self.refuse(["--print-parameters", "pdf"], "--print-parameters: pdf not in ")


class Misspelt(Case):
    def test_expert_parameter(self):
        self.refuse_setting("Solver/Inital guess=zero", 'did you mean "Expert/Initial guess"?')
        self.refuse_deck(
            deck(sublist("Dual operator", parameter("Weigths", "string", "none"))),
            'unknown parameter "Dual operator/Weigths"; did you mean "Expert/Weights"?',
        )

    def test_expert_parameter_at_both_places(self):
        weights = parameter("Weights", "string", "none"), parameter("Weights", "string", "stiffness")
        self.refuse_deck(
            deck(sublist("Dual operator", weights[0] + sublist("Expert", weights[1]))),
            '"Dual operator/Weights" is a string ("none"), but "Dual operator/Expert/Weights" is a string '
            '("stiffness")',
        )


class OldPlaces(Case):
    """Expert parameters directly in their list, their place in version 0.1: they are read, with a note."""

    OLD = {
        "Solver": '<Parameter name="Method" type="string" value="SMALBE"/>'
        '<ParameterList name="SMALBE"><Parameter name="M" type="double" value="5"/></ParameterList>',
        "Dual operator": '<Parameter name="Weights" type="string" value="stiffness"/>',
    }

    def deck(self, inner):
        model = [parameter(name.split("/")[1], "int", value) for name, value in TINY.items()
                 if name.startswith("Model/")]
        lists = (sublist(name, inner(name, text)) for name, text in self.OLD.items())
        return self.write(deck(sublist("Model", *model), *lists), f"{inner.__name__}.xml")

    def test_a_deck_of_version_0_1(self):
        def old(name, text):
            return text

        def new(name, text):
            method, bracket, rest = text.partition("/>") if name == "Solver" else ("", "", text)
            return method + bracket + sublist("Expert", rest)

        results = {}
        for inner in (old, new):
            run = runs.run(self.deck(inner), np=2)
            self.assertEqual(run.returncode, 0, run)
            self.assertEqual(run.errors, [])
            results[inner.__name__] = run
        notes = re.findall(r"(?m)^Note: (.* is now .*)$", results["old"].stdout)
        self.assertEqual(notes, [
            '"Solver/SMALBE" is now "Solver/Expert/SMALBE"; this version still reads the old place',
            '"Dual operator/Weights" is now "Dual operator/Expert/Weights"; this version still reads the old place',
        ])
        self.assertNotIn(" is now ", results["new"].stdout)
        one, other = (results[name].summary for name in ("old", "new"))
        for key in ("energy", "cg_steps", "hessian_applications", "relative_projected_gradient"):
            self.assertEqual(one[key], other[key], key)

    def test_assignments_to_old_places(self):
        sets = {**TINY, "Solver/Method": "SMALBE"}
        outcomes = []
        for places in ("Solver/SMALBE/M", "Solver/Expert/SMALBE/M"):
            run = runs.solved(self, runs.MODEL, {**sets, places: 5}, np=0)
            self.assertEqual(f'Note: "{places}" is now' in run.stdout, "Expert" not in places, run)
            outcomes.append((run.summary["energy"], run.summary["hessian_applications"]))
        self.assertEqual(*outcomes)


if __name__ == "__main__":
    runs.main()
