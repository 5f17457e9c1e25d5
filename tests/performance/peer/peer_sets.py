# SPDX-License-Identifier: BSD-3-Clause
"""Primal-dual active sets on the whole matrix: CG with GAMG solves for the displacements of each set.

In every set the solver works on the increment of an iterate that has the prescribed displacements and closed gaps, so
that its right-hand side is the residual.

plain   each set begins with a copy of the matrix, a new hierarchy and displacements of zero, and is solved to the end
reused  the pattern, the interpolation of the first hierarchy and the displacements are kept; a set that will change is
        solved coarsely, and only the last one to the end
best    the same, with the whole hierarchy of the first set, of aggregates that are not smoothed
"""

import time

import numpy as np

MOST_SETS = 50
MOST_ITERATIONS = 2000
PATIENCE = 30  # iterations in a set after which `best` makes a new hierarchy
# Of the tolerance, for sets that will change: were it reached at once, they would go on changing by its noise.
BELOW = 0.1

COMMON = {"ksp_type": "cg", "ksp_norm_type": "unpreconditioned", "pc_type": "gamg"}
# Those of `best` were the fastest on small meshes of the same scenes: a hierarchy of aggregates that are not
# smoothed costs a fourth of GAMG's default, and with W cycles of symmetric SOR it takes few iterations more. The
# shift is for basis functions that an aggregate of few nodes does not have; nodes of one row's pattern taken
# together (inodes) would fail at these.
WAYS = {
    "plain": {},
    "reused": {"pc_gamg_reuse_interpolation": "true"},
    "best": {
        "pc_gamg_agg_nsmooths": "0",
        "pc_gamg_recompute_esteig": "false",
        "pc_mg_cycle_type": "w",
        "mg_levels_ksp_type": "richardson",
        "mg_levels_ksp_max_it": "1",
        "mg_levels_pc_type": "sor",
        "mg_levels_pc_sor_diagonal_shift": "1e-10",
        "mat_no_inode": "true",
    },
}


class NoSolution(RuntimeError):
    """CG that did not converge, or sets that did not settle."""


class ActiveSets:
    def __init__(self, system, given):
        """@param given `way`, `press`, `rtol` of the right-hand side, `loose` of a step before the last set."""
        self.system, self.given, self.PETSc = system, given, system.PETSc
        self.keeps = given.way != "plain"
        self.keeps_hierarchy = given.way == "best"
        self.solver, self.last = None, 0
        self.seconds = {"operator": 0.0, "setup": 0.0, "solve": 0.0, "update": 0.0}

    def timed(self, stage, begin):
        now = time.perf_counter()
        self.seconds[stage] += now - begin
        return now

    def prepare(self, closed):
        """Operator and hierarchy of a set."""
        begin = time.perf_counter()
        self.system.reduce(closed, self.keeps)
        begin = self.timed("operator", begin)
        kept = self.keeps and self.solver is not None
        if not kept:
            if self.solver is not None:
                self.solver.destroy()
            self.solver = self.PETSc.KSP().create(self.PETSc.COMM_WORLD)
            self.solver.setFromOptions()
        self.solver.setOperators(self.system.reduced)
        self.solver.getPC().setReusePreconditioner(
            kept and self.keeps_hierarchy and self.last <= PATIENCE
        )
        self.solver.setUp()
        self.timed("setup", begin)

    def solve(self, u, closed, relative, absolute):
        """One set, from u on."""
        begin = time.perf_counter()
        self.system.impose(u, closed)
        right = self.system.residual(u)
        step = right.duplicate()
        self.solver.setTolerances(rtol=relative, atol=absolute, max_it=MOST_ITERATIONS)
        self.solver.solve(right, step)
        reason = self.solver.getConvergedReason()
        if reason <= 0:
            raise NoSolution(f"CG ended with reason {reason}")
        self.system.advance(u, step)
        self.last = self.solver.getIterationNumber()
        self.timed("solve", begin)

    def begin(self, u, closed, body):
        """The iterate of the first set, and the norm of the residual from zero, what tolerances refer to."""
        u.zeroEntries()
        self.system.impose(u, closed)
        whole = self.system.residual(u).norm()
        u.zeroEntries()
        if self.keeps:
            u.getArray()[body - self.system.low] = -self.given.press
        return whole

    def tolerances(self, exact, whole):
        """Relative to the first residual of a set, and absolute."""
        if not self.keeps:
            return self.given.rtol, 0.0
        absolute = self.given.rtol * whole
        return (0.0, absolute) if exact else (self.given.loose, BELOW * absolute)

    def run(self, u, body):
        """The solution in u; entries of what each set took, and what is closed.

        @param body rows that move with what is pressed, by as much, where `best` begins.
        """
        system, entries, whole = self.system, [], None
        closed, changed, exact = system.candidates.begin(self.given.press), 1, not self.keeps
        while changed or not exact:
            if len(entries) == MOST_SETS:
                raise NoSolution(f"the sets have not settled after {MOST_SETS}")
            begin = time.perf_counter()
            if changed:
                self.prepare(closed)
            exact = not self.keeps or not changed
            if whole is None:
                whole = self.begin(u, closed, body)
            elif not self.keeps:
                u.zeroEntries()
            self.solve(u, closed, *self.tolerances(exact, whole))
            before = time.perf_counter()
            found = system.next_set(u, closed)
            changed = system.count(found != closed)
            entry = {"closed": system.count(closed), "changed": changed, "iterations": self.last}
            closed = found
            entries.append({**entry, "seconds": self.timed("update", before) - begin})
        return entries, closed
