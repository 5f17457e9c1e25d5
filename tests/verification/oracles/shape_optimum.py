#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""Best gap profiles of blocks in contact, computed without decomposition and without an optimiser that walks.

Problem
-------
Scenes are those of shape_scene.py.  Of given gaps c at the contact points r,

    J(c) = min 1/2 u'Ku - f'u   subject to   Bu <= c   and prescribed displacements;

its multipliers l >= 0 are the contact forces, l_r / a_r the pressures.  Condensed to the contact, w = Bu,

    J(c) = J_0 + min 1/2 w'Sw - g'w   subject to   w <= c,      l = g - Sw.

Method
------
(a) pressures()   y = c - w >= 0 solves the linear complementarity problem of the matrix S: the active-set method of Lawson
    and Hanson, which is finite.
(b) softest()   c = c_0 + Phi x.  J is convex in x, and min J over x between bounds with a limited volume sum_r a_r (Phi x)_r
    is one convex quadratic program in w and x together: an interior-point method (Mehrotra), then Newton steps on its set.
    With h the multiplier of the volume, sum_r l_r Phi_rk = h sum_r a_r Phi_rk for every x_k that is at no bound: with one
    number a point the pressure is h there.
(c) uniform_profile()   Of a given resultant the peak pressure cannot fall below its mean.  Forces p a_r leave a linear
    problem, whose w is the profile that has the same pressure everywhere.

Nothing rests on how these are found: conditions of optimality are looked at in the end, and all programs are convex.

Sources
-------
C. L. Lawson, R. J. Hanson, "Solving least squares problems", Prentice-Hall 1974, chapter 23.
S. Mehrotra, "On the implementation of a primal-dual interior point method", SIAM J. Optim. 2 (1992) 575-601.
"""

import sys
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from contact_oracle import OracleError

TOLERANCE = 1e-9  # of residuals of the conditions of optimality, all relative
LIFTED = 1e-9  # relative, of a pivot of S: a motion that the closed points leave free
MAX_INTERIOR = 200
POLISHING = 8  # Newton steps on the active set at most


@dataclass
class Pressed:
    """Contact of given gaps."""

    gaps: np.ndarray  # c
    motion: np.ndarray  # w = Bu
    forces: np.ndarray  # l
    pressures: np.ndarray  # l over areas
    energy: float  # J(c)

    @property
    def peak(self):
        return float(self.pressures.max())

    @property
    def open(self):
        return self.gaps - self.motion


def lifts_off():
    return OracleError("shape: the load lifts a body off; no closed contact carries it")


def pressures(contact, gaps=None):
    """The contact of these gaps, those of the meshes by default.

    @raises OracleError where a body lifts off
    """
    c = contact.gaps if gaps is None else np.broadcast_to(np.asarray(gaps, dtype=float), len(contact.load)).copy()
    s, q = contact.stiffness, contact.load - contact.stiffness @ c
    force = max(np.abs(contact.load).max(), np.abs(s @ c).max()) or 1.0
    y, opened = np.zeros(len(q)), np.zeros(len(q), dtype=bool)
    largest = s.diagonal().max()

    def solve():
        at = np.flatnonzero(opened)
        try:
            factor = scipy.linalg.cholesky(s[np.ix_(at, at)], lower=True)
        except scipy.linalg.LinAlgError as error:
            raise lifts_off() from error
        if (factor.diagonal() ** 2).min() <= LIFTED * largest:
            raise lifts_off()
        z = np.zeros(len(q))
        z[at] = scipy.linalg.cho_solve((factor, True), -q[at])
        return z

    for _ in range(10 * len(q) + 10):
        forces = np.where(opened, 0.0, q + s @ y)
        worst = int(forces.argmin())
        if forces[worst] >= -1e-13 * force:
            break
        opened[worst] = True
        z = solve()
        while (z[opened] <= 0).any():
            # As far as the first of them closes again.
            falls = opened & (z <= 0)
            ratio = y[falls] / np.maximum(y[falls] - z[falls], 1e-300)
            y = y + ratio.min() * (z - y)
            opened[np.flatnonzero(falls)[ratio.argmin()]] = False
            y = np.where(opened, y, 0.0)
            z = solve() if opened.any() else np.zeros(len(q))
        y = z
    forces = q + s @ y
    length = max(np.abs(c).max(), np.abs(c - y).max()) or 1.0
    residuals = {
        "sign": -forces.min() / force, "penetration": -y.min() / length,
        "complementarity": np.abs(forces * y).max() / (force * length),
    }
    trust("pressures", residuals)
    forces = np.where(opened, 0.0, forces)
    return Pressed(c, c - y, forces, forces / contact.areas, float(contact.energy(c - y)))


def trust(what, residuals):
    worst = max(residuals, key=residuals.get)
    if not residuals[worst] <= TOLERANCE:
        raise OracleError(
            f"shape: {what}: the {worst} residual {residuals[worst]:.1e} exceeds {TOLERANCE:.0e}; "
            "the solution is not to be used as a reference"
        )


def hats(x, knots):
    """Piecewise linear functions of the knots at coordinates x: (points, knots); constant beyond the ends."""
    return np.stack([np.interp(x, knots, unit) for unit in np.eye(len(knots))], axis=1)


def polynomials(x, degree):
    """Chebyshev polynomials on the range of x: (points, degree + 1)."""
    low, high = np.min(x), np.max(x)
    return np.polynomial.chebyshev.chebvander((2 * np.asarray(x) - low - high) / (high - low), degree)


@dataclass
class Optimum:
    """Of the energy over a design."""

    design: np.ndarray  # x; where several are as good, one among them
    pressed: Pressed  # with its gaps
    gradient: np.ndarray  # dJ/dx = -Phi'l
    volume: float
    volume_multiplier: float  # h; zero without a limit
    residuals: dict  # of the conditions of optimality


def quadratic_program(hessian, linear, rows, bounds, equal):
    """min 1/2 x'Hx + h'x with Gx <= d, = d where `equal`; x and multipliers. Well scaled, feasible, convex."""
    e, g = rows[equal], rows[~equal]
    d_e, d_g = bounds[equal], bounds[~equal]
    n, m, k = len(linear), len(d_g), len(d_e)
    x, z, s, y = np.zeros(n), np.ones(m), np.maximum(d_g, 1.0), np.zeros(k)

    def longest(values, step):
        falling = step < 0
        return min(1.0, (-values[falling] / step[falling]).min(initial=np.inf))

    for _ in range(MAX_INTERIOR):
        r_x = -(hessian @ x + linear + g.T @ z + e.T @ y)
        r_g, r_e = d_g - g @ x - s, d_e - e @ x
        mean = s @ z / max(m, 1)
        error = max(np.abs(r).max(initial=0.0) for r in (r_x, r_g, r_e))
        # Beyond that rounding errors rule, and the set is known.
        if mean < 1e-14 and error < 1e-10 or mean < 1e-20:
            break
        ratio = z / s
        system = np.block([[hessian + (g.T * ratio) @ g, e.T], [e, np.zeros((k, k))]])

        def direction(product):
            # S dz + Z ds = product and G dx + ds = r_g, eliminated.
            right = np.concatenate([r_x - g.T @ ((product - z * r_g) / s), r_e])
            found = scipy.linalg.lstsq(system, right, cond=1e-17)[0]
            ds = r_g - g @ found[:n]
            return found[:n], found[n:], ds, (product - z * ds) / s

        dx, dy, ds, dz = direction(-s * z)
        reach = min(longest(s, ds), longest(z, dz))
        ahead = (s + reach * ds) @ (z + reach * dz) / max(m, 1)
        dx, dy, ds, dz = direction((ahead / mean) ** 3 * mean - s * z - ds * dz)
        reach = min(1.0, 0.995 * min(longest(s, ds), longest(z, dz)))
        x, y, s, z = x + reach * dx, y + reach * dy, s + reach * ds, z + reach * dz
        if reach < 1e-10:
            break

    return polished(hessian, linear, rows, bounds, equal, x, z, y, z > s)


def polished(hessian, linear, rows, bounds, equal, x, z, y, active):
    """Newton steps with the rows of the set as equations; the multipliers of the others vanish."""
    n, multipliers = len(x), np.zeros(len(bounds))
    multipliers[equal], multipliers[~equal] = y, np.where(active, z, 0.0)
    closed = equal.copy()
    closed[~equal] = active
    a = rows[closed]
    system = np.block([[hessian, a.T], [a, np.zeros((len(a), len(a)))]])
    for _ in range(POLISHING):
        right = np.concatenate([-(hessian @ x + linear + rows.T @ multipliers), bounds[closed] - a @ x])
        if np.abs(right).max() < 1e-15:
            break
        # The least step: what nothing determines stays where it is.
        step = scipy.linalg.lstsq(system, right, cond=1e-13)[0]
        x = x + step[:n]
        multipliers[closed] += step[n:]
    return x, multipliers


def softest(contact, design=None, lower=-np.inf, upper=np.inf, volume=(-np.inf, np.inf), gaps=None):
    """The gaps c_0 + Phi x of least energy: those that let the load do the most work.

    design   Phi (points, numbers); None: a number a point
    lower    of the numbers; upper likewise
    volume   least and largest sum of area times change of gap, sum_r a_r (Phi x)_r; equal: it has that value
    gaps     c_0; None: those of the meshes
    @raises OracleError where the volume contradicts the bounds, the energy has no minimum, or the conditions of
            optimality do not hold to 1e-9
    """
    m = len(contact.load)
    phi = np.eye(m) if design is None else np.asarray(design, dtype=float)
    c_0 = contact.gaps if gaps is None else np.broadcast_to(np.asarray(gaps, dtype=float), m)
    n = phi.shape[1]
    lower, upper = (np.broadcast_to(np.asarray(b, dtype=float), n) for b in (lower, upper))
    weights = phi.T @ contact.areas
    check_design(lower, upper, weights, volume)

    # The program in (w, x), in lengths of `length` and forces of `force`.
    scale = np.abs(contact.stiffness).max()
    force = np.abs(contact.load).max() or 1.0
    length = force / scale
    hessian = np.zeros((m + n, m + n))
    hessian[:m, :m] = contact.stiffness / scale
    linear = np.concatenate([-contact.load / force, np.zeros(n)])
    unit = np.eye(m + n)[m:]
    total = contact.areas.sum()
    row = np.concatenate([np.zeros(m), weights / total])[None]
    rows, bounds, equal = [np.hstack([np.eye(m), -phi])], [c_0], [np.zeros(m, dtype=bool)]
    for chosen, sign, limit in ((np.isfinite(upper), 1.0, upper), (np.isfinite(lower), -1.0, lower)):
        rows.append(sign * unit[chosen])
        bounds.append(sign * limit[chosen])
        equal.append(np.zeros(chosen.sum(), dtype=bool))
    if volume[0] == volume[1]:
        rows.append(row)
        bounds.append([volume[0] / total])
        equal.append([True])
    else:
        for sign, limit in ((1.0, volume[1]), (-1.0, volume[0])):
            if np.isfinite(limit):
                rows.append(sign * row)
                bounds.append([sign * limit / total])
                equal.append([False])
    rows, bounds, equal = np.concatenate(rows), np.concatenate(bounds) / length, np.concatenate(equal)
    found, multipliers = quadratic_program(hessian, linear, rows, bounds, equal)
    return judged(contact, phi, c_0, (lower, upper), volume, length * found[m:])


def check_design(lower, upper, weights, volume):
    if (lower > upper).any() or volume[0] > volume[1]:
        raise OracleError("shape: bounds that cross")
    ends = np.where(weights >= 0, lower, upper), np.where(weights >= 0, upper, lower)
    least, largest = (
        float((weights[weights != 0] * end[weights != 0]).sum()) for end in ends
    )
    if volume[0] > largest or volume[1] < least:
        raise OracleError(
            f"shape: no design between the bounds has a volume within {volume[0]:g} and {volume[1]:g}: they are "
            f"{least:g} to {largest:g}"
        )


def judged(contact, phi, c_0, bounds, volume, x):
    """The optimum, if x is one: looked at by pressures of its gaps, which the program has not seen."""
    lower, upper = bounds
    weights = phi.T @ contact.areas
    x = np.clip(x, lower, upper)
    pressed = pressures(contact, c_0 + phi @ x)
    gradient, v = -phi.T @ pressed.forces, float(weights @ x)
    force = np.abs(phi).T @ pressed.forces  # of each number, what its gradient is small against
    length = max(np.abs(phi @ x).max(), np.abs(pressed.motion).max()) or 1.0
    size = contact.areas.sum() * length
    near = 1e-7 * length
    low, high = x <= lower + near, x >= upper - near
    # The multiplier of the volume from the numbers at no bound; where all are, any between what they say will do.
    inside = ~low & ~high
    h = 0.0
    limits = [at for at in volume if np.isfinite(at) and abs(v - at) <= TOLERANCE * size]
    if limits:
        h = volume_multiplier(gradient, weights, inside, low, high)
    reduced = gradient + h * weights
    wrong = np.where(inside, np.abs(reduced), 0.0)
    wrong = np.maximum(wrong, np.where(low & ~high, -reduced, 0.0))
    wrong = np.maximum(wrong, np.where(high & ~low, reduced, 0.0))
    residuals = {
        "stationarity": float(wrong.max() / (force.max() or 1.0)),
        "volume": max(volume[0] - v, v - volume[1], 0.0) / size,
    }
    if volume[0] != volume[1]:
        # More room makes things softer, if the upper limit is what holds.
        at_upper = abs(v - volume[1]) <= TOLERANCE * size
        residuals["sign"] = max(-h if at_upper else h, 0.0) / (pressed.peak or 1.0)
    trust("softest", residuals)
    return Optimum(x, pressed, gradient, v, float(h), residuals)


def volume_multiplier(gradient, weights, inside, low, high):
    use = inside & (weights != 0)
    if use.any():
        return -float(gradient[use] @ weights[use] / (weights[use] @ weights[use]))
    # At a lower bound gradient + h weight >= 0, at an upper one <= 0.
    some = weights != 0
    ratio = -gradient[some] / weights[some]
    from_below = np.where(weights[some] > 0, low[some], high[some])
    least = ratio[from_below].max(initial=-np.inf)
    most = ratio[~from_below].min(initial=np.inf)
    ends = [value for value in (least, most) if np.isfinite(value)]
    return float(np.mean(ends))


def uniform_profile(contact, pressure=None, volume=None):
    """Gaps of which the pressure is the same everywhere, and that pressure.

    pressure  None: the resultant's mean, where contact alone carries a body
    volume    sum of area times gap; where contact alone carries a body, gaps are known up to a motion of it: so that
              this is their volume; None: the least one is zero
    @raises OracleError where the pressure does not balance the load, or the load does not determine it
    """
    a, free = contact.areas, contact.free
    if free.shape[1] > 1:
        raise OracleError("shape: contact alone carries several motions; hold the bodies along their sides")
    if free.shape[1]:
        motion = free[:, 0] * np.sign(free[:, 0] @ a)  # of eigenvectors any sign comes
        mean = (motion @ contact.load) / (motion @ a)
        if pressure is None:
            pressure = mean
        elif abs(pressure - mean) > TOLERANCE * abs(mean):
            raise OracleError(f"shape: a pressure of {pressure:g} does not balance the load, whose mean is {mean:g}")
    elif pressure is None:
        raise OracleError("shape: a body is held across the contact: the load does not tell the pressure; give it")
    right = contact.load - pressure * a
    gaps = np.linalg.lstsq(contact.stiffness, right, rcond=LIFTED)[0]
    trust("uniform_profile", {"balance": float(np.abs(contact.stiffness @ gaps - right).max() / np.abs(contact.load).max())})
    if free.shape[1]:
        if volume is None:
            gaps = gaps - (gaps / motion).min() * motion
        else:
            gaps = gaps + (volume - a @ gaps) / (a @ motion) * motion
    return gaps, float(pressure)


if __name__ == "__main__":
    import shape_optimum_checks

    sys.exit(1 if shape_optimum_checks.self_test() else 0)
