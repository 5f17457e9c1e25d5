# SPDX-License-Identifier: BSD-3-Clause
"""Subdomains that averages join to clusters change the way to an answer, and not the answer.

On 1, 2, 4 and 8 ranks; with the word Many each case on all of these and on 16 (a long test, on any
number of cores). What each class guards against:

    Answers     another energy, or a coarse problem of another size than that of the clusters' motions
    Forms       an option that clusters forget: forms of the dual operator, preconditioners, joins, coarse problems
    Diagnoses   motions that are named wrongly, or no more, where clusters move and not subdomains
    Restarts    a rank that dies and leaves others waiting; a checkpoint that is taken up with other clusters as if
                they were the same
"""

import os
import shutil
import signal
import sys
import unittest
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parent))
import harmos_runs as runs
import test_coarse_forms as forms

APPS = runs.SOURCE / "apps"
CLUSTERS = "Decomposition/Clusters"

# Energies are told of displacements that jump by the tolerance, of unit size, between subdomains; jumps times forces
# change them in the first order. A tenth of what they are compared to leaves a factor of ten for forces that are
# larger than the energy is.
ENERGY = 1e-10
TOLERANCE = 1e-11


@dataclass
class Case:
    program: str
    deck: str
    sets: dict = field(default_factory=dict)
    # Clusters "rank" on one rank: its bodies are clusters, and the coarse problem has their motions, less those that
    # are held in the matrices or by nothing.
    whole: int = None
    # Besides: (ranks, clusters, coarse dimension where it is known).
    others: tuple = ()
    isSlow: bool = False  # on several ranks


# Floating and held; membranes, in the plane and in space; structured, cut by METIS from .geo meshes (pushed_ball,
# punch, tied_inclusion, shrink_fit, beam_on_roller); ties, contact, friction, adhesion, and steps with warm starts.
CASES = {
    "membranes": Case("harmos", "harmos/decks/membranes.xml", whole=1),
    "model": Case("signorini", "signorini/decks/model.xml", whole=1, others=((1, "4", 6),)),
    "floating": Case(
        "signorini",
        "signorini/decks/model.xml",
        {"Decomposition/Dirichlet": "dual"},
        whole=2,
        others=((2, "4", 8), (4, "rank", 4), (8, "2", 16)),
    ),
    "solid": Case("signorini", "signorini/decks/block.xml", whole=1, others=((2, "rank", None),)),
    "composite": Case(
        "fiber_composite", "fiber_composite/decks/composite.xml", {"Dual operator/Expert/Weights": "stiffness"},
        others=((4, "rank", None),),
    ),
    "adaptive vectors": Case(
        "fiber_composite", "fiber_composite/decks/composite.xml", {"Dual operator/Expert/Adaptive coarse vectors": "all"},
        others=((2, "2", None),),
    ),
    "greco plate": Case("harmos", "harmos/decks/greco_plate.xml", whole=1, others=((2, "rank", None),)),
    "lifted beam": Case("harmos", "harmos/decks/lifted_beam.xml", whole=0, isSlow=True),
    "two blocks": Case("harmos", "harmos/decks/two_blocks.xml", whole=1, others=((2, "2", None),)),
    "stack": Case("harmos", "harmos/decks/stack.xml", whole=2, others=((2, "2", None),)),
    "dragged block": Case("harmos", "harmos/decks/dragged_block.xml", whole=3, others=((2, "rank", None),)),
    "debonding": Case("fiber_composite", "fiber_composite/decks/debonding.xml", whole=12, isSlow=True),
    "pushed ball": Case("harmos", "harmos/decks/pushed_ball.xml", whole=6, isSlow=True),
    "punch": Case("harmos", "harmos/decks/punch.xml", whole=6, others=((2, "2", 24),)),
    "tied inclusion": Case("harmos", "harmos/decks/tied_inclusion.xml", whole=3, others=((4, "rank", None),)),
    "shrink fit": Case("harmos", "harmos/decks/shrink_fit.xml", whole=6, others=((2, "8", 6),)),
    "beam on a roller": Case("harmos", "harmos/decks/beam_on_roller.xml", whole=3, others=((2, "4", None),)),
}


def solved(case, item, clusters, np, sets=None):
    done = runs.run(
        APPS / item.deck,
        {
            "Solver/Maximum iterations": 20000,
            "Solver/Tolerance": TOLERANCE,
            "Output/Fields": False,
            CLUSTERS: clusters,
            **item.sets,
            **(sets or {}),
        },
        np,
        program=item.program,
    )
    case.assertEqual(done.returncode, 0, done)
    case.assertTrue(done.summary["converged"], done)
    return done


def difference(done, plain):
    return abs(done.summary["energy"] / plain.summary["energy"] - 1.0)


class Answers(unittest.TestCase):
    maxDiff = None

    def settings(self, item):
        return ((1, "rank", item.whole), *item.others)

    def test_energies(self):
        rows = []
        for name, item in CASES.items():
            with self.subTest(case=name):
                plain = solved(self, item, "none", 1)
                for np, clusters, dimension in self.settings(item):
                    with self.subTest(ranks=np, clusters=clusters):
                        done = solved(self, item, clusters, np)
                        off = difference(done, plain)
                        figures = [d.summary[k] for k in ("coarse_dimension", "hessian_applications")
                                   for d in (plain, done)]
                        rows.append([name, np, clusters, *figures, f"{off:.1e}"])
                        self.assertLess(off, ENERGY, done)
                        self.assertEqual(done.summary["kernel_dimension"], plain.summary["kernel_dimension"])
                        # A cluster has no more motions than its subdomains.
                        self.assertLessEqual(done.summary["coarse_dimension"], plain.summary["coarse_dimension"])
                        if dimension is not None:
                            self.assertEqual(done.summary["coarse_dimension"], dimension, done)
        runs.table(
            "Subdomains joined to clusters",
            ("case", "ranks", "clusters", "dimension", "of clusters", "products", "with clusters", "energies differ"),
            rows,
        )


class Many(Answers):
    """Each case on all numbers of ranks, and with other sizes of clusters."""

    def settings(self, item):
        known = {(np, clusters): dimension for np, clusters, dimension in super().settings(item)}
        several = ((4, "rank"), (4, "2"), (8, "rank"), (16, "rank"))
        for np, clusters in ((1, "rank"), (1, "2"), (1, "8"), (2, "rank"), (2, "4"), *(() if item.isSlow else several)):
            yield np, clusters, known.get((np, clusters))


class Forms(unittest.TestCase):
    ITEMS = (CASES["solid"], CASES["greco plate"])
    OPTIONS = (
        {"Dual operator/Form": "condensed"},
        {"Dual operator/Form": "implicit"},
        {"Dual operator/Form": "implicit", "Dual operator/Local solver": "MUMPS"},
        {"Dual operator/Expert/Share identical subdomains": False},
        {"Dual operator/Preconditioner": "lumped"},
        {"Dual operator/Preconditioner": "none"},
        {"Dual operator/Expert/Scaling": "multiplicity"},
        {"Dual operator/Expert/Weights": "stiffness"},
        {"Decomposition/Dirichlet": "dual"},
        {"Decomposition/Expert/Cluster joins": "corners"},
        {"Decomposition/Expert/Cluster joins": "all"},
        {"Decomposition/Coarse problem": "distributed"},
        {"Solver/Method": "SMALBE", "Solver/Tolerance": 1e-8},
    )

    def test_energies(self):
        for item in self.ITEMS[:1]:
            plain = solved(self, item, "none", 1)
            for sets in self.OPTIONS:
                with self.subTest(deck=item.deck, **sets):
                    np = 2 if "Decomposition/Coarse problem" in sets else 1
                    done = solved(self, item, "4", np, sets)
                    # By its tolerance, as above.
                    tolerance = max(ENERGY, 10.0 * sets.get("Solver/Tolerance", 0.0))
                    self.assertLess(difference(done, plain), tolerance, done)
                    if "Decomposition/Coarse problem" in sets:
                        self.assertEqual(done.summary["coarse_problem"], "distributed")

    def test_friction(self):
        item = self.ITEMS[1]
        plain = solved(self, item, "none", 1)
        for sets in ({"Dual operator/Preconditioner": "lumped"}, {"Dual operator/Form": "implicit"}):
            with self.subTest(**sets):
                self.assertLess(difference(solved(self, item, "4", 1, sets), plain), ENERGY)

    def test_an_integer_of_a_deck(self):
        """Of type int, in the deck itself."""
        text = forms.BLOCK.format(load="{0, -0.02, 0}").replace(
            "</ParameterList>\n  <ParameterList name=\"Materials\">",
            "</ParameterList>\n  <ParameterList name=\"Decomposition\"><Parameter name=\"Clusters\" type=\"int\""
            " value=\"4\"/></ParameterList>\n  <ParameterList name=\"Materials\">",
        )
        deck = runs.scratch("deck").with_suffix(".xml")
        deck.write_text(text, encoding="utf-8")
        done = runs.run(deck, {}, 1, program="harmos")
        self.assertEqual(done.returncode, 0, done)
        # Sixteen subdomains in fours, of three motions each; but one motion that no constraint holds, sideways.
        self.assertEqual(done.summary["coarse_dimension"], 11, done)


class Diagnoses(unittest.TestCase):
    def test_motions(self):
        """What cannot be held or is pulled away is so with clusters; the subdomain that is named is of that body."""
        for load, said in (("{1e-4, -0.02, 0}", "unbalanced load"), ("{0, 0.02, 0}", "pulled away")):
            deck = runs.scratch("deck").with_suffix(".xml")
            deck.write_text(forms.BLOCK.format(load=load), encoding="utf-8")
            for np, clusters in ((1, "none"), (1, "rank"), (2, "rank"), (2, "4"), (4, "rank")):
                for form in forms.FORMS:
                    with self.subTest(load=load, ranks=np, clusters=clusters, form=form):
                        sets = {CLUSTERS: clusters, "Decomposition/Coarse problem": form}
                        done = runs.run(deck, sets, np, program="harmos")
                        self.assertNotEqual(done.returncode, 0, done)
                        text = " ".join(forms.motions(done.stdout + done.stderr))
                        self.assertIn(said, text, done)
                        if said == "unbalanced load":
                            self.assertRegex(text, r"unbalanced load on subdomain \d+")


class Restarts(unittest.TestCase):
    CUT = {"Solver/Maximum iterations": 8, "Solver/Tolerance": 1e-9, CLUSTERS: "rank"}

    def restarted(self, directory, np, sets=None):
        copy = runs.scratch("restart")
        shutil.copytree(directory, copy)
        words = ["--restart", copy]
        for path, value in {"Solver/Maximum iterations": 10000, **(sets or {})}.items():
            words += ["--set", f"{path}={value}"]
        done = runs.start(words, np=np)
        done.directory = copy
        path = copy / "summary.json"
        done.summary = runs.json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None
        return done

    def test_the_same_clusters_go_on(self):
        plain = runs.run(runs.MODEL, {**self.CUT, "Solver/Maximum iterations": 10000})
        cut = runs.run(runs.MODEL, self.CUT)
        self.assertEqual(cut.returncode, 1, cut)
        # Of the model's two bodies each rank has one, and so has the one rank of a restart: the same clusters.
        for np in (2, 1):
            with self.subTest(ranks=np):
                done = self.restarted(cut.directory, np)
                self.assertEqual(done.returncode, 0, done)
                self.assertLess(difference(done, plain), 1e-8)
                self.assertEqual(
                    done.summary["hessian_applications"], plain.summary["hessian_applications"], done
                )

    def test_other_clusters_are_no_wrong_answer(self):
        """Ranks that cut the bodies further: an answer, or the words that it is another problem."""
        plain = runs.run(runs.MODEL, {**self.CUT, "Solver/Maximum iterations": 10000})
        cut = runs.run(runs.MODEL, self.CUT)
        done = self.restarted(cut.directory, 4)
        if done.returncode == 0:
            self.assertLess(difference(done, plain), 1e-8)
        else:
            self.assertEqual(done.returncode, 2, done)
            self.assertIn("belongs to another problem", done.errors[0])
        # Asked for by name it is another deck.
        done = self.restarted(cut.directory, 2, {CLUSTERS: "none"})
        self.assertEqual(done.returncode, 2, done)
        self.assertRegex(done.errors[0], f'"{CLUSTERS}" was rank, is none')

    def test_a_rank_is_killed(self):
        sets = {
            CLUSTERS: "4",
            "Model/Subdomains per side": 4,
            "Model/Elements per subdomain side": 24,
            "Solver/Method": "SMALBE",
            "Solver/Tolerance": 1e-8,
            "Dual operator/Preconditioner": "none",
            "Dual operator/Form": "implicit",
            "Dual operator/Expert/Share identical subdomains": False,
            "Output/Fields": False,
        }
        plain = runs.run(runs.MODEL, sets)
        run = runs.Background(runs.MODEL, sets | {"Output/Checkpoint/Outer iterations": 1})
        self.assertTrue(run.wait_for("checkpoint.h5"), run.text())
        os.kill(run.ranks()[-1], signal.SIGKILL)
        self.assertNotEqual(run.end(60), 0, run.text())
        self.assertEqual(run.ranks(), [])
        done = self.restarted(run.directory, 2)
        self.assertEqual(done.returncode, 0, done)
        # Ten tolerances of both, as for restarts without clusters.
        self.assertLess(difference(done, plain), 1e-7)


if __name__ == "__main__":
    runs.main()
