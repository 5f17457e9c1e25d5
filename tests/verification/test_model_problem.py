# SPDX-License-Identifier: BSD-3-Clause
"""The model problem, run as a whole and held against the monolithic oracle and against figures
that others have published.

Usage: test_model_problem.py [CLASS]... [-v]; without a class all of them run.

What each class guards against:

    Dimensions         a constraint too many or too few; a solver whose cost grows with the number
                       of subdomains; a run that calls itself converged and is not (audit)
    Energy             a solution that is another problem's, or that depends on the decomposition,
                       on how prescribed displacements are enforced, or on the number of ranks
    Tie                the machinery of contact in a run that does not call for it
    DualPenalty        a penalty method whose infeasibility depends on the mesh (Table 5.4)
    Paper              an Algorithm 4.1 that is not the printed one: outer iterations beyond the
                       "two to six" of the paper, or a wrong solution

with the costly cells apart: DimensionsLarge, DualPenaltyLarge, PaperLarge.

H is the side of a subdomain and h that of an element; S = 1/H and N = H/h are the parameters of
the deck, 1/h = S N.
"""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py  # noqa: F401
    import oracle
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

SIDES = (1, 2, 4, 8)  # S, in the order of the columns of the tables below

# Dual dimension, and so on, by N for S = 1, 2, 4, 8. The paper prints 10365 for the primal
# dimension of S = 8, N = 8; 2 S^2 (N+1)^2 is 10368.
PRIMAL = {
    8: (162, 648, 2592, 10368),
    32: (2178, 8712, 34848, 139392),
    128: (33282, 133128, 532512, 2130048),
}
DUAL = {8: (9, 87, 447, 1983), 32: (33, 327, 1695, 7551), 128: (129, 1287, 6687, 29823)}
PRIMAL_64, DUAL_64 = 540800, 14975  # S = 8, N = 64

# At the tolerance 1e-4. The paper: conjugate gradient iterations. PERMON 3.18, tuned, on two
# ranks: all Hessian applications.
PAPER_CG = {8: (10, 20, 23, 27), 32: (17, 33, 30, 37), 128: (28, 59, 36, 47)}
PERMON = {8: (17, 22, 28, 40), 32: (20, 29, 38, 54), 128: (24, 45, 56, 84)}

# Table 5.4 of the paper, |G lambda| / |d| for S = 8, by rho for N = 2, 8, 32, 128.
TABLE_5_4 = {
    10: (3.027e-03, 3.108e-03, 3.115e-03, 3.117e-03),
    1000: (3.144e-05, 3.213e-05, 3.222e-05, 3.225e-05),
    100000: (3.145e-07, 3.212e-07, 3.224e-07, None),
}
PENALTY_SIZES = (2, 8, 32, 128)

_cells = {}
_oracles = {}


def settings(s, n, **more):
    """The overrides of a deck; further ones with their path in a dict named more."""
    return {
        "Model/Subdomains per side": s,
        "Model/Elements per subdomain side": n,
        "Output/Fields": False,
        **more.get("more", {}),
    }


def cell(case, s, n, deck=runs.MODEL, np=2, more=None):
    """The run of one cell of a table, made once."""
    key = (deck, s, n, np, tuple(sorted((more or {}).items())))
    if key not in _cells:
        _cells[key] = runs.solved(case, deck, settings(s, n, more=more or {}), np=np)
    return _cells[key]


def reference(n, interface="contact"):
    if (n, interface) not in _oracles:
        _oracles[n, interface] = oracle.solve(n, interface)
    return _oracles[n, interface]


def relative_error(energy, solution):
    return abs(energy - solution.energy) / abs(solution.energy)


def gradient(summary):
    """|g^P| at the stop."""
    relative = summary["relative_projected_gradient"]
    return relative * summary["tolerance_projected_gradient"] / summary["tolerance"]


def jump(summary):
    """Bound on the jumps B u - c that a solver may leave, by its own residuals.

    The jumps are the gradient F lambda - d + (rigid motions). Its free part is |g^P|; forces out
    of balance by |G lambda| move the displacements by |F| times that, the rest is what no
    feasible direction can reduce.
    """
    return gradient(summary) + summary["hessian_norm"] * summary["equality_residual"]


def assert_audit(case, summary, n_elements, n_side):
    """The primal side agrees with what the solver says of its residuals."""
    audit = summary["audit"]
    # jump() is for rows of norm one. In physical units a gluing or contact row (1, -1) is
    # longer by sqrt(2).
    bound = 2**0.5 * jump(summary)
    case.assertLess(audit["gluing_jump"], bound)
    case.assertLess(audit["penetration"], bound)
    case.assertGreaterEqual(audit["penetration"], 0.0)
    # The bounds of the multipliers hold exactly: every iterate is projected onto them. One unit
    # in the last place of the shift is lost where it is added again.
    case.assertGreater(audit["min_contact_multiplier"], -1e-15)
    # Contact forces add up to 1/4; where there is a force the gap is an error.
    case.assertLess(audit["complementarity"], 0.25 * (1 + summary["tolerance"]) * bound)
    # What is out of balance in a subdomain sits at its fixing nodes after K K^+, not spread over
    # it: |R'(f - B'lambda)| = |L G lambda| <= 2/sqrt(N) |G lambda|, times (N+1)/2 for four
    # nodes instead of (N+1)^2; together sqrt(N), N+1 <= 9/8 N. Rounding comes on top. And
    # |f| = 1.58 h: -3 h^2 at a quarter of the nodes of a body, -h^2 at another quarter.
    load = 1.58 / n_side
    limit = 1.125 * n_elements**0.5 * summary["equality_residual"] / load + 1e-10
    case.assertLess(audit["equilibrium"], limit)


def name_of(s, n):
    return f"H1_{s}_N{n}"


def add_cells(cells):
    """Class decorator: a test method a cell, so that each is named in the log."""

    def decorate(cls):
        for s, n in cells:

            def method(self, s=s, n=n):
                self.check(s, n)

            name = f"test_cell_H_1_{s}_N_{n:03d}"
            method.__doc__ = None
            method.__name__ = name
            setattr(cls, name, method)
        cls.CELLS = list(cells)
        return cls

    return decorate


class TableCase(unittest.TestCase):
    """Cells that are checked one by one, and a table of those that ran."""

    def setUp(self):
        self.maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.rows = {}

    @classmethod
    def tearDownClass(cls):
        if cls.rows:
            rows = [cls.rows[key] for key in sorted(cls.rows, key=str)]
            runs.table(f"{cls.TITLE} ({cls.__name__})", cls.HEADER, rows, cls.NOTE)
