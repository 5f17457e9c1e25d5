#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""Monolithic reference solution of the two-membrane contact problem.

Purpose
-------
An independent answer for the tests to compare with.  Nothing here is decomposed, dualised or
parallel, and no code is shared with the library: the two bodies are assembled as a whole and the
variational inequality is solved by an active-set method with a sparse direct solver.

Problem
-------
Omega^1 = (0,1)x(0,1) and Omega^2 = (1,2)x(0,1);

    minimise   E(u) = sum_i 1/2 int_{Omega^i} |grad u^i|^2 - int_{Omega^i} f u^i
    subject to u^1 = 0 on x = 0    and    u^2 - u^1 >= 0 on x = 1,

    f = -3 on (0,1)x[0.75,1),   f = -1 on (1,2)x[0,0.25),   f = 0 elsewhere.

Omega^2 has no Dirichlet condition (the problem is semicoercive): it is held up by the contact
alone, and balance of forces makes the contact forces add up to 1/4.  The variant `tie` replaces
the inequality by u^2 = u^1 on x = 1.

Discretisation: Q1 elements on a uniform square grid with n elements a unit side, h = 1/n.  The
load is integrated exactly also where it jumps inside an element (n not divisible by 4).

Conditions of optimality, with the gap g = u^2 - u^1 at the n+1 node pairs on x = 1:

    K^1 u^1 = f^1 - lambda,   K^2 u^2 = f^2 + lambda   (lambda acts at the interface nodes),
    g >= 0,   lambda >= 0,   lambda . g = 0.

Method
------
The primal-dual active-set method, which is a semismooth Newton method:

    A_0 = all pairs;   solve with g = 0 on A_k and lambda = 0 off A_k;
    A_{k+1} = { i : lambda_i - c g_i > 0 };   stop when A_{k+1} = A_k.

For a pair in A_k the gap is zero and for any other the multiplier is, so every c > 0 gives the
same sets and c = 1 is taken.  The empty set, for which Omega^2 would float and the matrix would
be singular, cannot occur: the multipliers on A_k add up to 1/4, hence one of them is positive
and its pair stays.  The method comes without a proof of global convergence here (the source has
one for bound constraints and M-matrices); none is needed, since the problem is convex and a
solution that passes the test of the conditions above is the solution.

Rounding: stiffness times six is a matrix of small integers, assembled without rounding error;
each linear solve is followed by iterative refinement with extended-precision residuals; and the
quadratic form is summed from differences of nodal values, in which nothing cancels.

Sources
-------
Model problem: Z. Dostal, D. Horak, O. Vlach, "Toward scalable FETI algorithm for variational
inequalities with applications to composites", eq. (2.1).
Method: M. Hintermueller, K. Ito, K. Kunisch, "The primal-dual active set strategy as a semismooth
Newton method", SIAM J. Optim. 13 (2002) 865-888.
"""

import argparse
import itertools
import json
import math
import sys
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

# Six times the Q1 Laplace stiffness of any square element (in 2D the side length cancels); the
# nodes go round the element, so that 0-2 and 1-3 are its diagonals.
SIX_KE = np.array([[4, -1, -2, -1], [-1, 4, -1, -2], [-2, -1, 4, -1], [-1, -2, -1, 4]])

# (value, y0, y1): each body's load is constant in x and vanishes outside the strip.
LOADS = ((-3.0, 0.75, 1.0), (-1.0, 0.0, 0.25))

MAX_ITERATIONS = 100
KKT_TOLERANCE = 1e-11
REFINEMENTS = 2

# 80 bits on x86, plain double on platforms that have nothing wider; both are accurate enough for
# the tolerance above, the former leaves a comfortable margin.
extended = np.longdouble


class OracleError(Exception):
    """A request that makes no sense, or a solution that cannot be trusted."""


@dataclass
class Solution:
    """A solution on the grid; every nodal array [i, j] has i along x and j along y."""

    n: int
    interface: str
    energy: float  # 1/2 u^T K u - f^T u
    u: tuple  # two (n+1, n+1) arrays; the interface is u[0][n, :] and u[1][0, :]
    multipliers: np.ndarray  # (n+1,) nodal contact forces; >= 0 for contact, any sign for tie
    active: np.ndarray  # (n+1,) bool: the pairs held together
    iterations: int  # linear systems solved
    kkt: dict  # relative residuals by name, see kkt_residuals()

    @property
    def gap(self):
        """u^2 - u^1 at the n+1 pairs of interface nodes."""
        return self.u[1][0, :] - self.u[0][self.n, :]

    @property
    def worst_residual(self):
        return max(self.kkt.values())


def node_numbers(n):
    """Node numbers in the vector of both bodies, as an array [body, i, j]."""
    return np.arange(2 * (n + 1) ** 2).reshape(2, n + 1, n + 1)


def corners(array):
    """The four corner values of all elements of a grid, in the order of SIX_KE."""
    return array[..., :-1, :-1], array[..., 1:, :-1], array[..., 1:, 1:], array[..., :-1, 1:]


def assemble_six_stiffness(n):
    """6 K of both bodies, without any boundary condition: integer entries, hence exact."""
    elements = np.stack([c.ravel() for c in corners(node_numbers(n))], axis=1)
    rows = np.repeat(elements, 4, axis=1).ravel()
    columns = np.tile(elements, (1, 4)).ravel()
    values = np.tile(SIX_KE.ravel().astype(float), len(elements))
    size = 2 * (n + 1) ** 2
    return sp.coo_matrix((values, (rows, columns)), shape=(size, size)).tocsr()


def strip_load(n, y0, y1):
    """Integrals over [y0, y1] of the n+1 hat functions on a uniform grid of [0, 1]; exact."""
    left = np.arange(n, dtype=extended)
    # The part of each element inside the strip, in the element's own coordinate 0 <= s <= 1.
    s0 = np.clip(n * extended(y0) - left, 0, 1)
    s1 = np.clip(n * extended(y1) - left, 0, 1)
    rising = (s1**2 - s0**2) / 2
    load = np.zeros(n + 1, dtype=extended)
    load[:-1] += (s1 - s0) - rising
    load[1:] += rising
    return load / n


def assemble_load(n):
    """Nodal loads [body, i, j]: the load does not depend on x, so the integral is a product."""
    along_x = strip_load(n, 0.0, 1.0)
    return np.stack([value * np.outer(along_x, strip_load(n, y0, y1)) for value, y0, y1 in LOADS])


def apply_stiffness(u):
    """K u in the precision of u, from differences (the rows of K add up to zero)."""
    out = np.zeros_like(u)
    c = corners(u)
    target = corners(out)
    for k in range(4):
        side1, diagonal, side2 = (c[k] - c[(k + m) % 4] for m in (1, 2, 3))
        target[k][...] += (side1 + 2 * diagonal + side2) / 6
    return out


def energy(u, load):
    """1/2 u^T K u - f^T u, with u^T K u = sum_{k<l} -K_kl (u_k - u_l)^2 over each element."""
    a, b, c, d = corners(u)
    sides = (a - b) ** 2 + (b - c) ** 2 + (c - d) ** 2 + (d - a) ** 2
    diagonals = (a - c) ** 2 + (b - d) ** 2
    return (sides + 2 * diagonals).sum() / 12 - (load * u).sum()


def solve_tied(six_k, load, active):
    """Minimise E with the gap closed on `active`, no condition on the other pairs.

    Returns u [body, i, j] and the multipliers (n+1), in extended precision.
    """
    n = load.shape[1] - 1
    number = node_numbers(n)

    # Tied pairs share one unknown, Dirichlet nodes have none (-1).
    unknown = np.arange(number.size)
    unknown[number[1, 0, active]] = number[0, n, active]
    used = np.unique(np.delete(unknown, number[0, 0, :]))
    position = np.full(number.size, -1)
    position[used] = np.arange(len(used))
    column = position[unknown]
    free = np.flatnonzero(column >= 0)

    expand = sp.csr_matrix(
        (np.ones(len(free)), (free, column[free])), shape=(number.size, len(used))
    )
    # The matrix is symmetric positive definite: an ordering of A + A^T and pivots on the diagonal
    # keep the factors sparse.
    factors = spla.splu(
        (expand.T @ six_k @ expand).tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )

    u = np.zeros(number.size, dtype=extended)
    residual = load
    for _ in range(1 + REFINEMENTS):
        # The forces of a tied pair cancel, so they must be added before they are rounded.
        reduced = np.zeros(len(used), dtype=extended)
        np.add.at(reduced, column[free], residual.ravel()[free])
        u[free] += factors.solve(6 * reduced.astype(float))[column[free]]
        residual = load - apply_stiffness(u.reshape(load.shape))

    multipliers = np.where(active, residual[0, n, :], 0)
    return u.reshape(load.shape), multipliers


def kkt_residuals(u, multipliers, load, interface):
    """Relative residuals of the conditions of optimality, all zero at the solution.

    stationarity     largest unbalanced nodal force, over the largest load or contact force
    feasibility      largest penetration (tie: largest gap), over the largest displacement
    sign             largest pulling contact force, over the largest contact force (contact only)
    complementarity  work of the contact forces on the gap, over the work of the load
    """
    n = load.shape[1] - 1
    unbalanced = apply_stiffness(u) - load
    unbalanced[0, n, :] += multipliers
    unbalanced[1, 0, :] -= multipliers
    unbalanced[0, 0, :] = 0  # the reaction of the support
    gap = u[1, 0, :] - u[0, n, :]
    largest = np.abs(multipliers).max()
    residuals = {
        "stationarity": np.abs(unbalanced).max() / max(np.abs(load).max(), largest),
        "feasibility": (-gap if interface == "contact" else np.abs(gap)).max() / np.abs(u).max(),
        "sign": (-multipliers).max() / largest if interface == "contact" else 0,
        "complementarity": abs(multipliers @ gap) / abs((load * u).sum()),
    }
    # Adding zero turns a negative zero into a plain one.
    return {name: max(float(value), 0.0) + 0.0 for name, value in residuals.items()}


def solve(n, interface="contact"):
    """Solve the model problem with n elements a unit side; interface is contact or tie."""
    if not isinstance(n, (int, np.integer)) or n < 1:
        raise OracleError(f"solve: n = {n!r} is not a positive whole number; give n = 1/h >= 1")
    if interface not in ("contact", "tie"):
        raise OracleError(f"solve: unknown interface {interface!r}; use 'contact' or 'tie'")
    n = int(n)
    six_k = assemble_six_stiffness(n)
    load = assemble_load(n)

    active = np.ones(n + 1, dtype=bool)
    seen = set()
    for iterations in range(1, MAX_ITERATIONS + 1):
        seen.add(active.tobytes())
        u, multipliers = solve_tied(six_k, load, active)
        if interface == "tie":
            break
        # Exactly zero gaps and multipliers where the conditions say so, hence no scaling by c.
        following = multipliers - (u[1, 0, :] - u[0, n, :]) > 0
        if np.array_equal(following, active):
            break
        if following.tobytes() in seen:
            # A pair with neither gap nor force belongs to either set and may flip for ever by
            # rounding; both sets are then right.  Any other cycle is a failure.
            worst = max(kkt_residuals(u, multipliers, load, interface).values())
            if worst <= KKT_TOLERANCE:
                break
            raise OracleError(
                f"solve: the active sets cycle for n = {n} (iteration {iterations}, KKT residual "
                f"{worst:.1e}); the assembly is wrong or n is too large for double precision"
            )
        active = following
    else:
        raise OracleError(
            f"solve: no convergence for n = {n} in {MAX_ITERATIONS} iterations; "
            "raise MAX_ITERATIONS in oracle.py"
        )

    # What is returned is what is measured: the values rounded to double.
    rounded = u.astype(float)
    forces = multipliers.astype(float)
    kkt = kkt_residuals(rounded.astype(extended), forces.astype(extended), load, interface)
    solution = Solution(
        n=n,
        interface=interface,
        energy=float(energy(u, load)),
        u=(rounded[0], rounded[1]),
        multipliers=forces,
        active=active,
        iterations=iterations,
        kkt=kkt,
    )
    if not solution.worst_residual <= KKT_TOLERANCE:
        name = max(kkt, key=kkt.get)
        raise OracleError(
            f"solve: the {name} residual {kkt[name]:.1e} for n = {n} exceeds {KKT_TOLERANCE:.0e}; "
            "the solution is not to be used as a reference"
        )
    return solution


def dense_problem(n):
    """Dense K and f without the Dirichlet nodes, and the matrix of the gaps."""
    number = node_numbers(n)
    keep = np.setdiff1d(number.ravel(), number[0, 0, :])
    gaps = np.zeros((n + 1, number.size))
    gaps[np.arange(n + 1), number[1, 0, :]] = 1
    gaps[np.arange(n + 1), number[0, n, :]] = -1
    stiffness = (assemble_six_stiffness(n) / 6).toarray()[np.ix_(keep, keep)]
    return stiffness, assemble_load(n).astype(float).ravel()[keep], gaps[:, keep]


def brute_force(n):
    """Least energy over all 2^(n+1) active sets, from dense saddle-point systems.

    The solution minimises E with the gap closed on its own active set, and every such minimiser
    without penetration is admissible; so the best of the admissible ones is the solution.  The
    empty set is left out: Omega^2 is loaded and would fall without end.
    """
    stiffness, load, gaps = dense_problem(n)
    size = len(load)
    best = (math.inf, None, None)
    for choice in itertools.product((False, True), repeat=n + 1):
        closed = gaps[np.array(choice)]
        m = len(closed)
        if m == 0:
            continue
        saddle = np.block([[stiffness, closed.T], [closed, np.zeros((m, m))]])
        u = np.linalg.solve(saddle, np.concatenate([load, np.zeros(m)]))[:size]
        value = 0.5 * u @ stiffness @ u - load @ u
        # A set without some force-free pair of the true one gives the same energy; the margin
        # in the energy then keeps the first set found.
        if (gaps @ u).min() >= -1e-13 and value < best[0] - 1e-14:
            best = (value, np.array(choice), u)
    return best


def quadrature_element():
    """The element matrix from 2x2 Gauss points on the unit square, exact for this integrand."""
    points = 0.5 + np.array([-0.5, 0.5]) / math.sqrt(3)
    total = np.zeros((4, 4))
    for x, y in itertools.product(points, points):
        gradient = np.array([[y - 1, x - 1], [1 - y, -x], [y, x], [-y, 1 - x]])
        total += gradient @ gradient.T / 4
    return total


def self_test():
    """Check the parts and the whole; returns the number of failures."""
    failures = 0

    def check(what, error, bound):
        nonlocal failures
        good = bool(error <= bound)
        failures += not good
        print(f"{'ok  ' if good else 'FAIL'} {what}: {error:.2e} (at most {bound:.0e})")

    error = np.abs(quadrature_element() - SIX_KE / 6).max()
    check("element matrix against quadrature", error, 1e-15)
    for n in (1, 2, 3, 4, 5, 7, 16):
        load = assemble_load(n)
        x, y = np.meshgrid(np.arange(n + 1) / n, np.arange(n + 1) / n, indexing="ij")
        error = 0.0
        for body, (value, y0, y1) in enumerate(LOADS):
            # Q1 functions reproduce 1, x and y, so these moments of the load are known exactly.
            total = value * (y1 - y0)
            moments = ((1, total), (x, total / 2), (y, value * (y1**2 - y0**2) / 2))
            for weight, exact in moments:
                error = max(error, abs(float((load[body] * weight).sum()) - exact))
        check(f"moments of the load, n = {n}", error, 1e-15)
    rng = np.random.default_rng(0)
    u = rng.standard_normal((2, 8, 8))
    load = assemble_load(7).astype(float)
    product = (assemble_six_stiffness(7) @ u.ravel() / 6).reshape(u.shape)
    check("matrix against stencil", np.abs(product - apply_stiffness(u)).max(), 1e-14)
    check(
        "energy from differences",
        abs(energy(u, load) - (0.5 * (u * product).sum() - (load * u).sum())),
        1e-12,
    )
    for n in (2, 3, 4, 5):
        found = solve(n)
        value, active, reference = brute_force(n)
        nodal = np.concatenate([found.u[0][1:, :].ravel(), found.u[1].ravel()])
        where = f"against all active sets, n = {n}"
        check(f"energy {where}", abs(found.energy - value), 1e-14)
        check(f"displacement {where}", np.abs(nodal - reference).max(), 1e-13)
        check(f"active set {where}", (found.active != active).sum(), 0)
    for interface in ("contact", "tie"):
        # Grids that halve h are nested, also in their admissible sets: the energy must fall.
        # The tied set is contained in the admissible one: its energy lies above.
        runs = [solve(n, interface) for n in (2, 4, 8, 16, 32)]
        energies = [run.energy for run in runs]
        check(f"energy falls on nested grids, {interface}", max(np.diff(energies)), 0)
        balance = max(abs(math.fsum(run.multipliers) - 0.25) for run in runs)
        check(f"contact forces add up to 1/4, {interface}", balance, 1e-14)
        check(f"KKT residuals, {interface}", max(run.worst_residual for run in runs), KKT_TOLERANCE)
    excess = max(solve(n).energy - solve(n, "tie").energy for n in (2, 8, 32))
    check("tie lies above contact", excess, 0)
    print("self-test passed" if failures == 0 else f"self-test FAILED: {failures} checks")
    return failures


def main(arguments=None):
    parser = argparse.ArgumentParser(
        description="Reference solution of the two-membrane contact problem, undecomposed."
    )
    parser.add_argument("n", metavar="N", type=int, nargs="*", help="elements a unit side, 1/h")
    parser.add_argument("--interface", choices=("contact", "tie"), default="contact")
    parser.add_argument("--json", action="store_true", help="print a JSON list, with nodal forces")
    parser.add_argument("--self-test", action="store_true", help="check the oracle itself")
    options = parser.parse_args(arguments)
    if options.self_test:
        if options.n:
            parser.error("--self-test has its own sizes; leave out N")
        return 1 if self_test() else 0
    if not options.n:
        parser.error("no N given; name at least one number of elements a side, or --self-test")

    try:
        solutions = [solve(n, options.interface) for n in options.n]
    except OracleError as error:
        print(f"oracle.py: {error}", file=sys.stderr)
        return 2
    if options.json:
        rows = [
            {
                "n": s.n,
                "interface": s.interface,
                "energy": s.energy,
                "active_count": int(s.active.sum()),
                "iterations": s.iterations,
                "kkt": s.kkt,
                "active": s.active.tolist(),
                "multipliers": s.multipliers.tolist(),
            }
            for s in solutions
        ]
        print(json.dumps(rows, indent=1))
        return 0
    names = list(solutions[0].kkt)
    titles = " ".join(f"{name:>15}" for name in names)
    print(f"{'n':>5} {'energy':>24} {'active':>6} {'its':>4} {titles}")
    for s in solutions:
        residuals = " ".join(f"{s.kkt[name]:15.2e}" for name in names)
        print(f"{s.n:5d} {s.energy:24.16e} {s.active.sum():6d} {s.iterations:4d} {residuals}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
