# SPDX-License-Identifier: BSD-3-Clause
"""Effects from outside: what the programs say about them, and the programs that document them.

What each class guards against:

    Listing   --list-effects that leaves an effect out, or is offered where decks name none
    Costs     a log or a summary that says of an effect that it is on when it is not, or keeps silent of
              what it costs
"""

import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

DECKS = runs.SOURCE / "apps/harmos/decks"
TWO_BLOCKS = DECKS / "two_blocks.xml"


def listed():
    done = runs.start(["--list-effects"], np=2, program="harmos")
    assert done.returncode == 0 and not done.errors, done
    return done.stdout


class Listing(unittest.TestCase):
    def test_kinds_with_what_they_are_and_their_parameters(self):
        text = listed()
        for kind in (
            "Tie",
            "Contact",
            "Obstacle",
            "Body force",
            "Traction",
            "Prescribed displacement",
            "Thermal strain",
        ):
            # Once: no rank repeats it.
            self.assertEqual(len(re.findall(rf"(?m)^{kind}  -- ", text)), 1, text)
        self.assertRegex(text, r"(?m)^Contact/<contact>  -- Two boundary parts do not penetrate")
        self.assertRegex(text, r'(?m)^  Coupling = "automatic"   \[choice\]$')

    def test_listed_effects_are_those_of_the_reference(self):
        pages = {
            re.match(r"# Parameters of the effect (.*)\n", page.read_text(encoding="utf-8")).group(1)
            for page in (runs.SOURCE / "docs/parameters/effects").glob("*.md")
        }
        self.assertEqual(set(re.findall(r"(?m)^([^/\n]+)  -- ", listed())), pages)

    def test_only_where_decks_name_effects(self):
        done = runs.start(["--list-effects"], np=0)
        self.assertEqual(done.returncode, 2, done)
        self.assertEqual(len(done.errors), 1, done)


class Costs(unittest.TestCase):
    def test_log_and_summary_tell_of_those_that_are_on(self):
        for dirichlet in ("primal", "dual"):
            done = runs.solved(
                self, TWO_BLOCKS, {"Decomposition/Dirichlet": dirichlet}, np=2, program="harmos"
            )
            costs = done.summary["effect_costs"]
            self.assertEqual([cost["kind"] for cost in costs], done.summary["effects"])
            table = done.stdout.split("Effects that are on")[1].split("\n")[1 : len(costs) + 1]
            for cost, line in zip(costs, table):
                kind, number, rows, seconds, mib = re.fullmatch(
                    r"  (\S.*?)  +(\d+) +(\d+) +([\d.]+) +([\d.]+)", line
                ).groups()
                self.assertEqual(
                    (kind, int(number), int(rows)), (cost["kind"], cost["effects"], cost["rows"])
                )
                self.assertAlmostEqual(float(seconds), cost["seconds"], delta=0.0006)
                self.assertAlmostEqual(float(mib), cost["bytes"] / 2**20, delta=0.0006)
                self.assertGreater(cost["bytes"], 0)
            by_kind = {cost["kind"]: cost for cost in costs}
            self.assertEqual(by_kind["Contact"]["rows"], done.summary["inequalities"])
            self.assertEqual(by_kind["Traction"]["rows"], 0)
            held = by_kind["Prescribed displacement"]["rows"]
            (self.assertGreater if dirichlet == "dual" else self.assertEqual)(held, 0)

    def test_failed_run_has_the_list_too(self):
        wrong = {"Effects/Obstacle/floor/Part": "lower/botom"}
        done = runs.run(TWO_BLOCKS, wrong, np=2, program="harmos")
        self.assertEqual(done.returncode, 2, done)
        self.assertEqual(done.summary["effect_costs"], [])


if __name__ == "__main__":
    runs.main()
