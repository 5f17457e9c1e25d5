# SPDX-License-Identifier: BSD-3-Clause
"""Every deck under apps/*/decks prints what the log beside it says.

    test_decks.py [--update] [CLASS...]

A log (NAME.log beside NAME.xml) holds what a run on two ranks prints, but for what differs from run
to run: version, paths, seconds, memory, the table of progress. --update writes the logs anew; look
at the difference before you commit it.

What is compared, and how closely:

    words                       equal
    dimensions and other counts equal
    iteration counts            within 30 % and 3: the path may differ by rounding, not by a method
    energy                      1e-6, relative: of second order in the error, and the tolerance of all
                                decks is 1e-4 or less; 1e-5 where bonds are damaged, for it is of first
                                order in what damage is agreed on to (1.1e-6 seen)
    audit                       at most ten times as large: where an iteration stops short of a
                                tolerance is chance, but not its order
    condition, named results    factor of two; 1 %, of first order in the tolerance
    walk of an optimiser        not compared; what it spent as iteration counts, its gradient ten times as large at most
    forces                      1 % of the largest in the line, their errors ten times as large; energies of steps 1e-3, one contact point
    estimates of the cost model not compared

Meshes made from .geo files are those of Debian 12's Gmsh 4.8; another version makes others.

What it guards against: decks that no longer run, answers that change without anyone's intention, answers
that depend on the number of ranks.
"""

import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

# Those of study are run by test_study.py.
DECKS = sorted(
    deck
    for deck in (runs.SOURCE / "apps").glob("*/decks/*.xml")
    if deck.parents[1].name != "study" and runs.is_built(deck.parents[1].name)
)
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]\d+)?(?![\w.]*[A-Za-z_])")
# Of an optimiser: its walk, and what it has spent, which rounding changes as it does iteration counts.
WALK = ("Iterate ", "Points of this design are open")
SPENT = re.compile(r"(adjoints|evaluations|iterations|solutions|refused_designs|products_of_\w+): ")
# A line of the table of effects: kind, number, rows; seconds, MiB.
EFFECT = re.compile(r"(?m)^(  [A-Z][a-z ]+\d+ +\d+) +\d+\.\d+ +\d+\.\d+$")
# A line of the table of forces, and one of a step: number, of, time, applications, energy, closed, of.
FORCE = re.compile(r"  [A-Z][a-z ]+/|    (normal|tangential) ")
STEP = re.compile(r"Step \d+ of \d+, time ")
AUDIT = (
    "  equilibrium", "  balance", "  gluing jump", "  penetration", "  least contact", "  complementarity",
    "  slip  ", "  friction beyond",
)


def normalised(text, deck, directory):
    """The lines of a log that two runs of the same deck have in common, but for their numbers."""
    lines = []
    skipping = False
    for line in text.splitlines():
        if line.startswith("Converged"):
            skipping = False
        if not skipping and not line.startswith("Peak memory"):
            lines.append(line)
        if line.startswith("  Newton iteration"):
            lines.pop()
        if line.startswith(WALK):
            lines[-1] = "  ..."
            if lines[-2] == "  ...":
                lines.pop()
        elif line.startswith("  outer  inner"):
            lines.append("  ...")
            skipping = True
        elif line.startswith("Seconds"):
            lines.pop()
            skipping = True
        elif line.startswith("Peak memory"):
            skipping = False
    result = "\n".join(lines) + "\n"
    result = EFFECT.sub(r"\1       ...", result)
    result = re.sub(r"^Harmos \S+ \(\S+\)", "Harmos VERSION (COMMIT)", result)
    return result.replace(str(deck), str(deck.relative_to(runs.SOURCE))).replace(
        str(directory), "DIRECTORY"
    )


def allowed(line, position, value, energy=1e-6):
    """The least and the most that a number of a line may be, or None: anything. @param energy relative."""
    if line.startswith("Dual operator: "):
        return None
    if line.startswith(("Converged: ", "NOT converged: ")):
        spread = 0.3 * value + 3
        return value - spread, value + spread
    if "local factorisations" in line:
        if position < 2:
            return value, value
        return (value / 2, value * 2) if "condition" in line and position == 3 else (0, value + 1)
    if line.startswith("  work of friction"):
        return value - 0.02 * abs(value), value + 0.02 * abs(value)
    if line.startswith("  energy"):
        return value - energy * abs(value), value + energy * abs(value)
    if line.startswith(AUDIT):
        # A zero may become a rounding error, 1e-9 of quantities of order one at most.
        return min(10 * value, 0) - 1e-9, max(10 * value, 0) + 1e-9
    if FORCE.match(line):
        # Forces that are none are rounding errors of those of order one at most.
        found = NUMBER.findall(line)
        components = sum("e" not in x for x in found) + 6  # with digits of names
        if position == components:  # the estimate of its error
            return 0.0, 10 * value + 1e-9
        spread = 0.01 * max(abs(float(x)) for x in found[:components]) + 1e-12
        return value - spread, value + spread
    if STEP.match(line):
        # Step, steps, time, applications, energy, closed points of all, those that slip, or bonds damaged, of all, broken.
        applications = value + 20 if "bonds" in line else 0.3 * value + 3  # of some solves more or less
        spread = (0.0, 0.0, 0.0, applications, 1e-3 * abs(value), 1.0, 0.0, 1.0, 0.0, 1.0)[position]
        return value - spread, value + spread
    if SPENT.match(line):
        return value - 0.3 * value - 3, value + 0.3 * value + 3
    if line.startswith("gradient_norm: "):
        return 0.0, 10 * value  # where it stops short of its tolerance is chance
    if line.startswith(("constraint_violation: ", "volume: ")):
        return value - 0.01 * abs(value) - 1e-9, value + 0.01 * abs(value) + 1e-9
    if re.match(r"\w+: ", line):
        return value - 0.01 * abs(value), value + 0.01 * abs(value)
    return value, value


def split(line):
    """A line's words with a mark for each number, and the numbers."""
    return NUMBER.sub("#", re.sub(r" +", " ", line)), [float(x) for x in NUMBER.findall(line)]


def differences(expected, found):
    """What is not as expected, line by line."""
    result = []
    energy = 1e-5 if "bonds damaged" in expected else 1e-6
    expected, found = expected.splitlines(), found.splitlines()
    for line, other in zip(expected, found):
        (words, numbers), (other_words, others) = split(line), split(other)
        if words != other_words:
            result.append(f"expected: {line}\n   found: {other}")
            continue
        for position, (value, other_value) in enumerate(zip(numbers, others)):
            limits = allowed(line, position, value, energy)
            if limits is not None and not limits[0] <= other_value <= limits[1]:
                result.append(
                    f"{other_value} is not in [{limits[0]}, {limits[1]}]\n"
                    f"expected: {line}\n   found: {other}"
                )
    if len(expected) != len(found):
        result.append(f"{len(expected)} lines expected, {len(found)} found")
    return result


def log_of(deck):
    return deck.with_suffix(".log")


def program_of(deck):
    return deck.parents[1].name


def printed(case, deck, np):
    """A run of a deck, converged without a warning, and its normalised log."""
    done = runs.solved(case, deck, np=np, program=program_of(deck))
    return done, normalised(done.stdout, deck, done.directory)


class Comparison(unittest.TestCase):
    """The comparison sees what it is meant to see."""

    LOG = (
        "Primal dimension 162, dual dimension 9 (9 inequalities), kernel dimension 2\n"
        "Converged: 3 outer iterations, 20 applications of F (10 cg)\n"
        "  Contact/joint    -8.600e-03   0.000e+00   2.450e-02\n"
        "  penetration    max (B_I u - c_I)+          1.00e-07\n"
        "  energy  u'Ku/2 - f'u + lambda'(Bu - c)     -1.000000000000e-03\n"
    )

    def test_same(self):
        self.assertEqual(differences(self.LOG, self.LOG), [])

    def test_within_and_beyond(self):
        for old, new, good in (
            ("162", "163", False),
            ("Primal", "Dual", False),
            ("20 applications", "29 applications", True),
            ("20 applications", "30 applications", False),
            ("1.00e-07", "0.00e+00", True),
            ("1.00e-07", "9.00e-07", True),
            ("1.00e-07", "1.10e-06", False),
            ("-1.000000000000e-03", "-1.000000900000e-03", True),
            ("-1.000000000000e-03", "-1.000001100000e-03", False),
            ("-1.000000000000e-03", "1.000000000000e-03", False),
            ("-8.600e-03   0.000e+00", "-8.800e-03   2.000e-04", True),
            ("-8.600e-03   0.000e+00", "-8.900e-03   0.000e+00", False),
            ("Converged: 3", "Converged: 3\nmore", False),
        ):
            with self.subTest(old=old, new=new):
                found = differences(self.LOG, self.LOG.replace(old, new))
                self.assertEqual(found == [], good, found)


class Logs(unittest.TestCase):
    def test_every_deck_has_a_log(self):
        self.assertGreater(len(DECKS), 9)
        for deck in DECKS:
            self.assertTrue(log_of(deck).exists(), f"{log_of(deck)}: make it with --update")

    def test_every_log_has_a_deck(self):
        for log in (runs.SOURCE / "apps").glob("*/decks/*.log"):
            self.assertTrue(log.with_suffix(".xml").exists(), log)

    def test_logs(self):
        for deck in DECKS:
            with self.subTest(deck=deck.name):
                expected = log_of(deck).read_text(encoding="utf-8")
                found = differences(expected, printed(self, deck, 2)[1])
                self.assertEqual(found, [], "\n".join(["", *found]))


class Ranks(unittest.TestCase):
    """The scenes of the application harmos have one answer on any number of ranks."""

    def test_energies(self):
        for deck in DECKS:
            if program_of(deck) != "harmos":
                continue
            log = log_of(deck).read_text(encoding="utf-8")
            energy = float(re.findall(r"(?m)^  energy .* (\S+)$", log)[-1])  # of the last round
            for np in (1, 4):
                with self.subTest(deck=deck.name, ranks=np):
                    done = printed(self, deck, np)[0]
                    self.assertAlmostEqual(done.summary["energy"] / energy, 1.0, delta=1e-6)


def update():
    for deck in DECKS:
        log_of(deck).write_text(printed(unittest.TestCase(), deck, 2)[1], encoding="utf-8")
        print(log_of(deck))


if __name__ == "__main__":
    if "--update" in sys.argv:
        update()
    else:
        runs.main()
