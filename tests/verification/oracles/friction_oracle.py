#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""A body on a rigid plane with Coulomb's friction, step by step, solved without decomposition.

Problem
-------
The plane is z = 0 below the points that may touch.  With the displacement v and the force p of such a point on the body,
g its height before, and s = v_t - v_t' its slip, v_t' from the step before, at the end of each step

    d = g + v_n >= 0,   p_n >= 0,   p_n d = 0,   |p_t| <= mu p_n,   mu p_n |s| + p_t . s = 0;

the last says that a point slips where its force is at the limit alone, and against it.

Method
------
The body is factored once; v = v_0 + Cp with the dense compliance C of the points, v_0 from what is prescribed.  The law
is one inclusion in the second-order cone (de Saxce, Feng), and so a fixed point without sets, limits or programs:

    p = P(p - R (s, d + mu |s|)),   P the projection onto |p_t| <= mu p_n,

R a number a point.  It is iterated until nothing moves.  Nothing rests on that, since the law itself is looked at in the end,
each of its five parts; but a law with several solutions would show but one of them.

Source
------
G. de Saxce, Z.-Q. Feng, "The bipotential method: a constructive approach to design the complete contact law with friction
and improved numerical algorithms", Math. Comput. Modelling 28 (1998) 225-245.
"""

import sys
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from contact_oracle import OracleError
from elastic_oracle_checks import Checks

LAW_TOLERANCE = 1e-11  # of the residuals of the law, all relative
STILL = 1e-13  # relative change of the forces at which the iteration ends
MAX_ITERATIONS = 100000


@dataclass
class State:
    forces: np.ndarray  # (points, 3), on the body
    displacements: np.ndarray  # (points, 3)
    slips: np.ndarray  # (points, 2), of this step
    distances: np.ndarray  # (points,)
    residuals: dict  # of the law by name
    iterations: int


class Points:
    """Points that may touch, by their compliance (3 points, 3 points) and their heights."""

    def __init__(self, compliance, heights, coefficient):
        self.count = len(heights)
        self.heights = np.asarray(heights, dtype=float)
        self.coefficient = float(coefficient)
        compliance = np.asarray(compliance, dtype=float)
        if compliance.shape != (3 * self.count, 3 * self.count):
            raise OracleError(f"friction: a compliance of {compliance.shape} of {self.count} points")
        error = np.abs(compliance - compliance.T).max()
        if error > 1e-10 * np.abs(compliance).max():
            raise OracleError(f"friction: the compliance is not symmetric, by {error:.1e}")
        self.compliance = (compliance + compliance.T) / 2
        # With R the inverse of the largest sum of a row, of each point, RC has no eigenvalue above one.
        sums = np.abs(self.compliance).sum(axis=1).reshape(-1, 3)
        self.steps = 1.0 / sums.max(axis=1)

    def onto_cones(self, p):
        mu, normal, across = self.coefficient, p[:, 2], p[:, :2]
        size = np.linalg.norm(across, axis=1)
        height = (normal + mu * size) / (1 + mu**2)
        result = np.empty_like(p)
        result[:, 2] = height
        result[:, :2] = across * (mu * height / np.where(size > 0, size, 1.0))[:, None]
        inside, below = size <= mu * normal, mu * size <= -normal
        result[inside] = p[inside]
        result[below] = 0.0
        return result

    def motion(self, p, free, before):
        """Displacements, slips and distances under these forces."""
        v = free + (self.compliance @ p.ravel()).reshape(-1, 3)
        return v, v[:, :2] - before, self.heights + v[:, 2]

    def step(self, free, before, start=None):
        """The state at the end of a step.

        free    displacements without forces of contact
        before  tangential displacements at the end of the step before
        start   forces to begin with
        """
        p = np.zeros((self.count, 3)) if start is None else start.copy()
        for iteration in range(1, MAX_ITERATIONS + 1):
            _, slips, distances = self.motion(p, free, before)
            towards = distances + self.coefficient * np.linalg.norm(slips, axis=1)
            after = self.onto_cones(p - self.steps[:, None] * np.column_stack([slips, towards]))
            change, p = np.abs(after - p).max(), after
            if change <= STILL * np.abs(p).max():
                break
        v, slips, distances = self.motion(p, free, before)
        residuals = self.residuals(p, slips, distances)
        worst = max(residuals, key=residuals.get)
        if not residuals[worst] <= LAW_TOLERANCE:
            raise OracleError(
                f"friction: the {worst} residual {residuals[worst]:.1e} exceeds {LAW_TOLERANCE:.0e} after "
                f"{iteration} iterations; the solution is not to be used as a reference"
            )
        return State(p, v, slips, distances, residuals, iteration)

    def residuals(self, p, slips, distances):
        """Of the five parts of the law, all zero at a solution.

        Relative to the largest force, to the largest height or motion by forces, or to both.
        """
        normal, across = p[:, 2], np.linalg.norm(p[:, :2], axis=1)
        size = np.linalg.norm(slips, axis=1)
        force = np.abs(p).max() or 1.0
        length = max(np.abs(self.heights).max(), np.abs(self.compliance @ p.ravel()).max()) or 1.0
        limit = self.coefficient * normal
        found = {
            "penetration": -distances.min() / length,
            "tension": -normal.min() / force,
            "contact": np.abs(normal * distances).max() / (force * length),
            "limit": (across - limit).max() / force,
            "slip": (limit * size + (p[:, :2] * slips).sum(axis=1)).max() / (force * length),
        }
        return {name: max(float(value), 0.0) for name, value in found.items()}


class Body:
    """A body whose dofs `held` are prescribed; made for many loads and points."""

    def __init__(self, stiffness, held):
        self.stiffness = sp.csr_matrix(stiffness, dtype=float)
        size = self.stiffness.shape[0]
        self.held = np.asarray(held, dtype=np.int64)
        self.free = np.setdiff1d(np.arange(size), self.held)
        self.place = np.full(size, -1)
        self.place[self.free] = np.arange(len(self.free))
        self.factors = spla.splu(self.stiffness[self.free][:, self.free].tocsc())

    def displacements(self, values, dofs=(), forces=()):
        """All of them, with these values of the held dofs and forces at others."""
        u = np.zeros(len(self.place))
        u[self.held] = values
        load = -(self.stiffness @ u)
        np.add.at(load, np.asarray(dofs, dtype=np.int64), forces)
        u[self.free] = self.factors.solve(load[self.free])
        return u

    def compliance(self, dofs):
        at = self.place[np.asarray(dofs)]
        if (at < 0).any():
            raise OracleError("friction: a point that may touch is held")
        unit = np.zeros((len(self.free), len(at)))
        unit[at, np.arange(len(at))] = 1.0
        return self.factors.solve(unit)[at]


def self_test():
    """The law at one point in closed form, and what the residuals see; returns the number of failures."""
    check = Checks()
    mu, zero = 0.3, np.zeros((1, 2))
    one = Points(np.diag([2.0, 2.0, 1.0]), [0.1], mu)
    state = one.step(np.array([[0.5, 0.0, -0.05]]), zero)
    check("a point above the plane bears nothing", np.abs(state.forces).max(), 0)
    # Pressed by 0.2 with a compliance of one: 0.2 bears; a drag of x with a compliance of two: x/2 below 0.06 sticks.
    state = one.step(np.array([[0.0, 0.1, -0.3]]), zero)
    check("a point that sticks", np.abs(state.forces - [[0, -0.05, 0.2]]).max(), 1e-12)
    check("and its slip", np.abs(state.slips).max(), 1e-12)
    state = one.step(np.array([[0.3, 0.4, -0.3]]), zero)
    check("a point that slips", np.abs(state.forces - [[-0.036, -0.048, 0.2]]).max(), 1e-12)
    slip = np.array([[0.3 - 0.072, 0.4 - 0.096]])
    check("and its slip, against the force", np.abs(state.slips - slip).max(), 1e-12)
    # From there back by less than twice the limit's motion it sticks: its force follows from where it was left.
    back = one.step(np.array([[0.24, 0.32, -0.3]]), state.displacements[:, :2])
    expected = (np.array([0.24, 0.32]) - slip) / -2
    check("a point that is drawn back", np.abs(back.forces[:, :2] - expected).max(), 1e-12)
    # One point whose normal and tangents are coupled, against all directions of slip.
    rng = np.random.default_rng(7)
    worst = 0.0
    for _ in range(20):
        root = rng.normal(size=(3, 3))
        c = root @ root.T + np.eye(3)
        free = np.append(rng.normal(size=2), -1.0)
        state = Points(c, [0.0], mu).step(free[None], zero)
        worst = max(worst, distance_to_scan(c, free, mu, state.forces[0]))
    check("one point of any compliance, against all directions", worst, 1e-4)
    right = one.step(np.array([[0.3, 0.4, -0.3]]), zero)
    for name, force, slips, height in (
        ("limit", 1.001 * right.forces * [1, 1, 0] + right.forces * [0, 0, 1], right.slips, 0.0),
        ("slip", 0.999 * right.forces * [1, 1, 0] + right.forces * [0, 0, 1], right.slips, 0.0),
        ("slip", right.forces, -right.slips, 0.0),
        ("contact", right.forces, right.slips, 1e-3),
        ("penetration", right.forces, right.slips, -1e-3),
        ("tension", -right.forces, 0 * right.slips, 0.0),
    ):
        found = one.residuals(force, slips, np.array([height]))
        check(f"the residual of the {name} sees a fault", -found[name], -1e-5)
    failures = check.failures
    print("self-test passed" if failures == 0 else f"self-test FAILED: {failures} checks")
    return failures


def distance_to_scan(c, free, mu, force):
    """Of a pressed point's force from the nearest that the law allows; slips are looked for in all directions."""
    candidates = [np.zeros(3)] if free[2] >= 0 else []
    stuck = -np.linalg.solve(c, free)
    if np.hypot(*stuck[:2]) <= mu * stuck[2]:
        candidates.append(stuck)
    angles = np.linspace(0, 2 * np.pi, 200001)
    direction = np.column_stack([mu * np.cos(angles), mu * np.sin(angles), np.ones_like(angles)])
    normal = -free[2] / (direction @ c[2])
    forces = normal[:, None] * direction
    slips = (free + forces @ c)[:, :2]
    cross = slips[:, 0] * direction[:, 1] - slips[:, 1] * direction[:, 0]
    along = (slips * direction[:, :2]).sum(axis=1)
    turns = np.flatnonzero((np.sign(cross[1:]) != np.sign(cross[:-1])) & (along[1:] <= 0) & (normal[1:] >= 0))
    candidates += list(forces[turns])
    return min(np.abs(force - each).max() for each in candidates)


if __name__ == "__main__":
    sys.exit(1 if self_test() else 0)
