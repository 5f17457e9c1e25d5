# SPDX-License-Identifier: BSD-3-Clause
"""Effects from outside: what the programs say about them, and the programs that document them.

What each class guards against:

    Listing   --list-effects that leaves an effect out, or is offered where decks name none
    Costs     a log or a summary that says of an effect that it is on when it is not, or keeps silent of
              what it costs
    Warnings  an interface whose points are too far apart for the zone that softens, without a word, or with one where
              they are not; results that do not tell glued points from others
    Pages     generated pages of the documentation that no longer can be generated
"""

import json
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
            table = done.stdout.split("Active effects")[1].split("\n")[1 : len(costs) + 1]
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


class Warnings(unittest.TestCase):
    GLUE = {
        "Contact": "joint", "Normal stiffness": 1e3, "Tangential stiffness": 1e3, "Normal strength": 1.0,
        "Tangential strength": 1.0,
    }

    def run_with(self, energy):
        glue = {**self.GLUE, "Fracture energy": energy, "Fracture energy II": energy}
        sets = {f"Effects/Adhesion/glue/{name}": value for name, value in glue.items()}
        done = runs.run(TWO_BLOCKS, sets, np=2, program="harmos")
        self.assertEqual(done.returncode, 0, done)
        return done

    def test_process_zone(self):
        """E = 1: the zone is as long as the energy says; points are a sixteenth apart."""
        for energy, is_told in ((0.01, True), (1.0, False)):
            with self.subTest(energy=energy):
                said = "process zone of its interface, E G/σ², about 1.00e-02 long"
                self.assertEqual(said in self.run_with(energy).stdout, is_told)

    def test_glued_points_are_told(self):
        try:
            import h5py
        except ImportError:
            self.skipTest("the Python module h5py is missing")
        done = self.run_with(1.0)
        with h5py.File(done.directory / "result.vtkhdf") as file:
            data = file["VTKHDF/PointData"]
            bound, active = data["bound"][:].ravel(), data["active_set"][:].ravel()
        # All of the contact is glued, and nothing else.
        self.assertEqual(bound.tolist(), (active > 0).astype(int).tolist())
        self.assertGreater(bound.sum(), 0)


class Pages(unittest.TestCase):
    def test_table_of_costs(self):
        """docs/effects.md is generated by this program; here on tiny meshes, once each."""
        program = runs.SOURCE / "tests/performance/effects_table.py"
        output, page = runs.scratch("effects.json"), runs.scratch("effects.md")
        words = ["--elements", "2", "--repetitions", "1", "--output", output, "--page", page]
        status, _, errors = runs.execute([sys.executable, program, *words])
        self.assertEqual(status, 0, errors)
        document = json.loads(output.read_text(encoding="utf-8"))
        published = (runs.SOURCE / "docs/effects.md").read_text(encoding="utf-8")
        kinds = set(re.findall(r"(?m)^([^/\n]+)  -- ", listed()))
        shown = {item["effect"] for item in document["runs"]}
        self.assertLessEqual(shown, kinds)
        self.assertGreaterEqual(len(shown), 7)
        for item in document["runs"]:
            self.assertNotIn(item["effect"], item["off"]["effects"])
            self.assertIn(item["effect"], item["on"]["effects"])
            self.assertIn(f"| {item['effect']} |", published)
        # Friction is where it is asked for, and nowhere else.
        rubs = [item for item in document["runs"] if item["effect"] == "Friction"]
        self.assertEqual([item["where"] for item in rubs], 2 * ["contact", "obstacle", "both"])
        for item in document["runs"]:
            for run in (item["off"], item["on"]) if item not in rubs else (item["off"],):
                self.assertNotIn("Friction", run["effects"])
        for item in rubs:
            costs = {cost["kind"]: cost for cost in item["on"]["effect_costs"]}
            more = item["on"]["dual_dimension"] - item["off"]["dual_dimension"]
            self.assertEqual(costs["Friction"]["rows"], more)
            self.assertEqual(item["on"]["inequalities"], item["off"]["inequalities"])
            self.assertGreater(more, 0)
        # The same words: only figures differ between machines and sizes.
        words = [text.split("\nSeconds are")[0] for text in (page.read_text("utf-8"), published)]
        self.assertEqual(*words)


if __name__ == "__main__":
    runs.main()
