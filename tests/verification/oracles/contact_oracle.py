# SPDX-License-Identifier: BSD-3-Clause
r"""Convex quadratic programs of contact problems, solved without decomposition.

Problem
-------
    minimise  1/2 u'Ku - f'u    subject to    Bu <= c  (rows marked as equalities: Bu = c)

and to given values of some dofs.  K is symmetric positive semidefinite; its kernel consists of
rigid motions of bodies, which the caller names.

Conditions of optimality, on the dofs that are not prescribed:

    Ku + B'l = f,    Bu <= c,    l >= 0,    l'(Bu - c) = 0.

Method
------
The primal-dual active-set method (a semismooth Newton method), with a sparse direct solution of
the saddle-point system of each set:

    A_0 = all rows;   solve with Bu = c on A_k and l = 0 off A_k;
    A_{k+1} = { i in A_k : l_i > 0 } with { i not in A_k : (Bu)_i > c_i }.

It has no proof of convergence for these constraints.  If the sets cycle, or if a set leaves a
loaded body without support, an interior-point method gives the set to go on with: that one
converges whenever there is a solution.  Nothing rests on either, as the conditions of optimality
are checked in the end and the problem is convex.

Motions that nothing determines: the combinations of the rigid motions that the prescribed dofs
and the rows of A_k leave free are found from a small eigenvalue problem, and as many dofs, chosen
by a pivoted factorisation, keep their values.  The reactions at these dofs vanish if and only if
the load does no work on the motions; nothing is added to K, and the energy is that of the
problem.  A circular fibre without friction may always be turned: of all solutions that differ by
such motions, free on all rows together, the one without a share of them is returned.

Sources
-------
M. Hintermueller, K. Ito, K. Kunisch, "The primal-dual active set strategy as a semismooth Newton
method", SIAM J. Optim. 13 (2002) 865-888.
S. Mehrotra, "On the implementation of a primal-dual interior point method", SIAM J. Optim. 2
(1992) 575-601.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg as spla

KKT_TOLERANCE = 1e-9
MAX_ITERATIONS = 60
MAX_INTERIOR = 100
REFINEMENTS = 2
ROUNDING = 1e-12  # relative; forces and gaps below are taken to be zero
FREE = 1e-14  # square of the part of a motion that must be held for it to count as held


class OracleError(Exception):
    """A request that makes no sense, or a solution that cannot be trusted."""


class Unsupported(OracleError):
    """The load does work on a motion that the present constraints leave free."""


@dataclass
class ContactSolution:
    u: np.ndarray
    multipliers: np.ndarray  # of the rows; >= 0 except on equalities
    energy: float  # 1/2 u'Ku - f'u
    active: np.ndarray  # bool
    iterations: int  # active sets tried
    interior_iterations: int  # zero unless the active sets failed to converge
    free_motions: int  # motions that no constraint determines
    kkt: dict  # relative residuals by name, see kkt_residuals()

    @property
    def worst_residual(self):
        return max(self.kkt.values())


def null_space(gram):
    """Of a small Gram matrix C'C: an orthonormal basis of what C maps to zero, and the rest."""
    if len(gram) == 0:
        return np.zeros((0, 0))
    values, vectors = np.linalg.eigh(gram)
    return vectors[:, values <= FREE * max(values.max(), 1e-300)]


def kkt_residuals(stiffness, load, free, rows, bounds, equality, u, multipliers):
    """Relative residuals of the conditions of optimality, all zero at the solution.

    stationarity     largest unbalanced force on a free dof, over the largest force
    feasibility      largest violation of a row, over the largest displacement or bound
    sign             largest multiplier of the wrong sign, over the largest force
    complementarity  work of the forces on the distances from the bounds, over the work of all
    """
    inner = stiffness @ u
    contact = rows.T @ multipliers
    slack = rows @ u - bounds
    inequality = ~equality

    def largest(*arrays):
        return max((np.abs(a).max() for a in arrays if len(a)), default=0.0) or 1.0

    force = largest(load, inner, multipliers)
    length = largest(u, bounds)
    work = abs(u @ inner) + abs(load @ u) or 1.0
    violation = np.where(equality, np.abs(slack), slack)
    residuals = {
        "stationarity": np.abs((inner + contact - load)[free]).max(initial=0.0) / force,
        "feasibility": violation.max(initial=0.0) / length,
        "sign": (-multipliers[inequality]).max(initial=0.0) / force,
        "complementarity": np.abs(multipliers @ slack) / work,
    }
    return {name: float(value) for name, value in residuals.items()}


class Problem:
    """The program on the dofs that are not prescribed."""

    def __init__(self, stiffness, load, dirichlet, rows, bounds, modes, equality):
        size = len(load)
        self.fixed = np.array(sorted(dirichlet), dtype=np.int64)
        self.free = np.setdiff1d(np.arange(size), self.fixed)
        self.u_full = np.zeros(size)
        self.u_full[self.fixed] = [dirichlet[dof] for dof in self.fixed.tolist()]
        self.k = stiffness[self.free][:, self.free].tocsc()
        self.f = load[self.free] - stiffness[self.free] @ self.u_full
        self.b = rows[:, self.free].tocsr()
        self.c = bounds - rows @ self.u_full
        self.equality = equality
        # A row of prescribed dofs alone decides nothing and would make the systems singular.
        self.usable = np.asarray(abs(self.b).sum(axis=1)).ravel() > 0
        self.motions = self.free_motions(modes)
        self.held = self.b @ self.motions  # rows times motions
        self.always_free = self.motions @ null_space(self.held.T @ self.held)
        # Of the size of the stiffness, so that the saddle-point systems are balanced.
        self.weight = float(np.abs(self.k.diagonal()).max(initial=0.0)) or 1.0

    def free_motions(self, modes):
        """Orthonormal basis of the motions that the prescribed dofs leave free."""
        if modes is None:
            return np.zeros((len(self.free), 0))
        modes = sp.csc_matrix(modes)
        held = modes[self.fixed].toarray()
        motions = modes[self.free] @ null_space(held.T @ held)
        return np.linalg.qr(motions)[0] if motions.shape[1] else motions

    def split(self, motions):
        """As many dofs to hold as there are motions, and the others."""
        count = motions.shape[1]
        held = np.zeros(len(self.free), dtype=bool)
        if count:
            pivots = scipy.linalg.qr(motions.T, mode="r", pivoting=True)[-1]
            held[pivots[:count]] = True
        return np.flatnonzero(held), np.flatnonzero(~held)

    def saddle(self, rows, others, diagonal):
        """A solver for K u + B'l = r, B u - D l = s on the dofs `others`."""
        k = self.k[others][:, others]
        b = self.weight * rows[:, others]
        d = sp.diags(-(self.weight**2) * diagonal)
        matrix = sp.bmat([[k, b.T], [b, d]], format="csc") if rows.shape[0] else k.tocsc()
        try:
            factors = spla.splu(matrix)
        except RuntimeError as error:
            raise OracleError(f"solve_contact: {error}; are rows repeated, or motions not named?")

        def solve(r, s):
            right = np.concatenate([r, self.weight * s])
            x = factors.solve(right)
            for _ in range(REFINEMENTS):
                x += factors.solve(right - matrix @ x)
            return x[: len(others)], self.weight * x[len(others) :]

        return solve

    def solve_set(self, active, u):
        """Displacements and multipliers with the rows of the set closed, from the values u."""
        chosen = self.held[active]
        motions = self.motions @ null_space(chosen.T @ chosen)
        pins, others = self.split(motions)
        rows = self.b[np.flatnonzero(active)]
        solve = self.saddle(rows, others, np.zeros(rows.shape[0]))
        u = np.where(np.isin(np.arange(len(u)), pins), u, 0.0)
        step, forces = solve((self.f - self.k @ u)[others], self.c[active] - rows @ u)
        u[others] = step
        multipliers = np.zeros(len(active))
        multipliers[active] = forces
        # A load on a free motion is met by the dofs that were held: no equilibrium.
        scale = max(np.abs(self.f).max(), np.abs(forces).max(initial=0.0), self.force_of(u))
        if motions.shape[1]:
            work = motions.T @ (self.f - self.k @ u - self.b.T @ multipliers)
            if np.abs(work).max() > 1e-9 * scale:
                raise Unsupported(
                    "solve_contact: the load does work on a motion that no closed contact resists"
                )
        return u, multipliers

    def force_of(self, u):
        return float(np.abs(self.k @ u).max(initial=0.0))

    def following(self, active, u, multipliers):
        """The next set; on the set gaps vanish and off it forces do, up to rounding."""
        force = max(np.abs(multipliers).max(initial=0.0), ROUNDING * self.force_of(u))
        length = max(np.abs(u).max(initial=0.0), np.abs(self.c).max(initial=0.0))
        violation = self.b @ u - self.c
        # A row without a force stays where it is.
        stay = multipliers >= -ROUNDING * force
        enter = violation > ROUNDING * length
        return np.where(active, stay | self.equality, enter) & self.usable

    def newton(self, active, u):
        """The active-set method; the solution, or None and the last set if the sets cycle."""
        seen = set()
        for iteration in range(1, MAX_ITERATIONS + 1):
            seen.add(active.tobytes())
            try:
                u, multipliers = self.solve_set(active, u)
            except Unsupported:
                return None, iteration
            after = self.following(active, u, multipliers)
            if np.array_equal(after, active):
                return (u, multipliers, active), iteration
            if after.tobytes() in seen:
                return None, iteration
            active = after
        return None, MAX_ITERATIONS

    def interior(self):
        """Mehrotra's predictor and corrector; (u, set) near the solution, and the steps."""
        pins, others = self.split(self.always_free)
        use = np.flatnonzero(self.usable)
        b, c = self.b[use], self.c[use]
        free = ~self.equality[use]  # the inequalities
        count = max(int(free.sum()), 1)
        length = max(np.abs(c).max(initial=0.0), np.abs(self.u_full).max(initial=0.0)) or 1.0
        force = max(np.abs(self.f).max(initial=0.0), 1e-3 * self.weight * length)
        u = np.zeros(len(self.f))
        slack, multipliers = np.where(free, length, 0.0), np.where(free, force, 0.0)

        def longest(values, step):
            falling = free & (step < 0)
            return min(1.0, (-values[falling] / step[falling]).min(initial=np.inf))

        for iteration in range(1, MAX_INTERIOR + 1):
            ratio = np.where(free, slack / np.where(free, multipliers, 1.0), 0.0)
            solve = self.saddle(b, others, ratio)
            r = self.f - self.k @ u - b.T @ multipliers
            s = c - b @ u - slack
            mean = slack @ multipliers / count

            def direction(product):
                # S l + L s = product, eliminated for the slack.
                part = np.where(free, product / np.where(free, multipliers, 1.0), 0.0)
                du, dl = solve(r[others], s - part)
                return du, dl, part - ratio * dl

            du, dl, ds = direction(-slack * multipliers)
            reach = min(longest(slack, ds), longest(multipliers, dl))
            ahead = (slack + reach * ds) @ (multipliers + reach * dl) / count
            centring = (ahead / mean) ** 3 if mean > 0 else 0.0
            du, dl, ds = direction(centring * mean - slack * multipliers - ds * dl)
            reach = min(longest(slack, ds), longest(multipliers, dl))
            reach = min(1.0, 0.995 * reach) if reach < 1 else 0.995 if free.any() else 1.0
            u[others] += reach * du
            multipliers, slack = multipliers + reach * dl, slack + reach * ds
            mean = slack @ multipliers / count
            error = np.abs(self.f - self.k @ u - b.T @ multipliers)[others].max(initial=0.0)
            if mean < 1e-13 * force * length and error < 1e-9 * force:
                active = np.zeros(len(self.c), dtype=bool)
                active[use] = ~free | (multipliers / force > slack / length)
                return u, active, iteration
        raise OracleError(
            "solve_contact: the interior-point method does not converge; the constraints "
            "contradict each other, or a loaded body is held by nothing"
        )


def solve_contact(stiffness, load, dirichlet, rows, bounds, modes=None, equality=None):
    """Minimise 1/2 u'Ku - f'u with Bu <= c and given values of some dofs.

    dirichlet  values by dof
    modes      (dofs, motions): rigid motions of all bodies; None if K and B leave none free
    equality   bool for each row: Bu = c there
    """
    stiffness = sp.csr_matrix(stiffness, dtype=float)
    load = np.asarray(load, dtype=float)
    rows = sp.csr_matrix(rows, dtype=float)
    bounds = np.broadcast_to(np.asarray(bounds, dtype=float), rows.shape[0]).copy()
    if equality is None:
        equality = np.zeros(len(bounds), dtype=bool)
    equality = np.asarray(equality, dtype=bool)
    if stiffness.shape != (len(load), len(load)) or rows.shape[1] != len(load):
        raise OracleError("solve_contact: the sizes of K, f and B do not agree")
    problem = Problem(stiffness, load, dirichlet, rows, bounds, modes, equality)

    start = problem.usable.copy()
    found, iterations = problem.newton(start, np.zeros(len(problem.free)))
    interior_iterations = 0
    if found is None:
        near, active, interior_iterations = problem.interior()
        found, more = problem.newton(active, near.copy())
        iterations += more
        if found is None:
            # Rows with neither distance nor force flip by rounding; both sets are then right.
            try:
                u, multipliers = problem.solve_set(active, near)
            except Unsupported as error:
                raise OracleError(str(error)) from error
            found = (u, multipliers, active)
    u, multipliers, active = found

    neutral = problem.always_free
    if neutral.shape[1]:
        neutral = np.linalg.qr(neutral)[0]
        u = u - neutral @ (neutral.T @ u)
    full = problem.u_full.copy()
    full[problem.free] = u
    kkt = kkt_residuals(
        stiffness, load, problem.free, rows, bounds, equality, full, multipliers
    )
    solution = ContactSolution(
        u=full,
        multipliers=multipliers,
        energy=float(0.5 * full @ (stiffness @ full) - load @ full),
        active=active,
        iterations=iterations,
        interior_iterations=interior_iterations,
        free_motions=neutral.shape[1],
        kkt=kkt,
    )
    if not solution.worst_residual <= KKT_TOLERANCE:
        name = max(kkt, key=kkt.get)
        raise OracleError(
            f"solve_contact: the {name} residual {kkt[name]:.1e} exceeds {KKT_TOLERANCE:.0e}; "
            "the solution is not to be used as a reference"
        )
    return solution
