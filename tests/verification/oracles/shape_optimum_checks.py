# SPDX-License-Identifier: BSD-3-Clause
"""The test of shape_optimum.py and shape_scene.py of themselves: shape_optimum.py without arguments.

What each part guards against:

    patches   a uniform load that does not arrive as a uniform pressure; energies of uniaxial stress
    contact   a condensation that is not the program it was made of, which contact_oracle.py solves whole, by another
              method; forces that are not the derivative of the energy by gaps
    softest   optima that are none: against the whole program of displacements and design in one, against an optimiser that
              walks over designs alone, against random designs
    uniform   a profile whose pressure is not uniform, and peaks below the mean
    refused   answers where there are none
"""

import dataclasses

import numpy as np
import scipy.optimize
import scipy.sparse as sp
from contact_oracle import OracleError, Problem, solve_contact
from elastic_oracle import rigid_modes
from elastic_oracle_checks import Checks
from shape_optimum import hats, polynomials, pressures, softest, uniform_profile
from shape_scene import Block, HalfPlane, Mesh, Part, Scene, condense, deck

PRESSURE = 0.05


def stacked(n=3, stiffer=1.0, down=None):
    """Two blocks of one width; the upper one pressed by a force, or moved down."""
    bodies = {
        "upper": Block((0.2, 1.0), (1.0, 0.5), (2 * n, n), stiffer, 0.3),
        "lower": Block((0.2, 0.0), (1.0, 1.0), (2 * n, 2 * n), 1.0, 0.3),
    }
    held = [(Part("lower", "bottom"), {"y": 0.0}), (Part("lower", "left"), {"x": 0.0}), (Part("upper", "left"), {"x": 0.0})]
    top = Part("upper", "top")
    if down is not None:
        return Scene(bodies, Part("upper", "bottom"), Part("lower", "top"), [*held, (top, {"y": -down})])
    return Scene(bodies, Part("upper", "bottom"), Part("lower", "top"), held, [(top, (0.0, -PRESSURE))])


def punch(n=3, down=None):
    """Half of a block on a wider one: pressures rise at its edge, without bounds on finer grids."""
    bodies = {
        "upper": Block((0.0, 1.0), (1.0, 0.5), (4 * n, 2 * n), 5.0, 0.2),
        "lower": Block((0.0, 0.0), (2.0, 1.0), (8 * n, 4 * n), 1.0, 0.3),
    }
    ground, top = Part("lower", "bottom"), Part("upper", "top")
    held = [(ground, {"x": 0.0, "y": 0.0}), (Part("lower", "left"), {"x": 0.0}), (Part("upper", "left"), {"x": 0.0})]
    held += [] if down is None else [(top, {"y": -down})]
    loads = [(top, (0.0, -PRESSURE))] if down is None else []
    return Scene(bodies, Part("upper", "bottom"), Part("lower", "top", 0.0, 1.0), held, loads)


def on_plane(n=4):
    """A block on a rigid half-plane a little below, with more load on one half."""
    bodies = {"block": Block((0.0, 0.25), (1.0, 0.5), (2 * n, n), 2.0, 0.3)}
    top = Part("block", "top")
    loads = [(top, (0.0, -PRESSURE)), (Part("block", "top", 0.0, 0.5), (0.0, -PRESSURE))]
    return Scene(bodies, Part("block", "bottom"), HalfPlane((0.0, 0.2)), [(Part("block", "left"), {"x": 0.0})], loads)


def check_patches(check):
    for stiffer in (1.0, 4.0):
        contact = condense(stacked(stiffer=stiffer))
        found = pressures(contact)
        # Rounding, over the condition of some dozens of points.
        check(f"uniform pressure, stiffer {stiffer:g} times", np.abs(found.pressures / PRESSURE - 1).max(), 1e-11)
        exact = -0.5 * PRESSURE**2 * (1 - 0.3**2) * (1.0 + 0.5 / stiffer)
        check("and its energy", abs(found.energy / exact - 1), 1e-11)
        check("the punch carries itself by contact alone", abs(contact.free.shape[1] - 1), 0)
    scene = on_plane()
    scene.loads.pop()
    found = pressures(condense(scene))
    check("a block on a plane", np.abs(found.pressures / PRESSURE - 1).max(), 1e-11)
    exact = -0.5 * PRESSURE**2 * (1 - 0.3**2) * 0.5 / 2.0 - PRESSURE * 0.05
    check("and its energy, with what it falls", abs(found.energy / exact - 1), 1e-11)
    areas = condense(punch(2)).areas
    check("areas of points: half at the ends", np.abs(areas - np.array([0.5, *[1.0] * 7, 0.5]) / 8).max(), 1e-15)


def some_gaps(contact, rng):
    """Of which some close and some do not."""
    return contact.gaps + 0.02 * rng.random(len(contact.load))


def whole(scene):
    """The arguments of solve_contact() before the bounds, and the rigid motions."""
    return condense(scene).program, rigid_modes(Mesh(scene.bodies).mesh)


def check_contact(check):
    rng = np.random.default_rng(3)
    for name, scene in (("carried", punch()), ("held", punch(down=0.03)), ("on a plane", on_plane())):
        contact, (program, modes) = condense(scene), whole(scene)
        for _ in range(3):
            gaps = some_gaps(contact, rng)
            found, reference = pressures(contact, gaps), solve_contact(*program, gaps, modes)
            force = reference.multipliers.max()
            check(f"forces, {name}", np.abs(found.forces - reference.multipliers).max() / force, 1e-9)
            check(f"energy, {name}", abs(found.energy / reference.energy - 1), 1e-11)
            closed = int((found.forces > 0).sum())
            check("some points closed, some open", -min(closed, len(gaps) - closed), -1)
            u = contact.at_rest + contact.motions @ found.motion
            check("displacements", np.abs(u - reference.u).max() / np.abs(reference.u).max(), 1e-9)
        # Strictly complementary: differences of a step that changes no set are exact but for rounding, eps J / step.
        step = 1e-4 * min(found.forces[found.forces > 0].min() / contact.stiffness.max(), found.open[found.forces == 0].min())
        way = rng.standard_normal(len(gaps))
        ahead, behind = (pressures(contact, gaps + sign * step * way).energy for sign in (1, -1))
        slope = (ahead - behind) / (2 * step)
        bound = 1e-14 * abs(found.energy) / step / abs(slope) + 1e-9
        check(f"the energy's derivative by gaps, {name}", abs(slope / (-found.forces @ way) - 1), bound)


def in_one(scene, contact, phi, lower, upper, volume):
    """The least energy by the whole program of (u, x), and its multipliers."""
    (stiffness, load, prescribed, rows), modes = whole(scene)
    count = phi.shape[1]
    # Bounds are rows; a number that nothing holds is a motion without cost.
    k = sp.block_diag([stiffness, sp.csr_matrix((count, count))], format="csr")
    unit = sp.hstack([sp.csr_matrix((count, len(load))), sp.eye(count)])
    weights = sp.csr_matrix(np.concatenate([np.zeros(len(load)), phi.T @ contact.areas]))
    b = sp.vstack([sp.hstack([rows, -sp.csr_matrix(phi)]), unit, -unit, weights], format="csr")
    c = np.concatenate([contact.gaps, np.full(count, upper), np.full(count, -lower), [volume]])
    equality = np.zeros(len(c), dtype=bool)
    motions, load = sp.block_diag([modes, sp.eye(count)]), np.concatenate([load, np.zeros(count)])
    problem = Problem(k, load, prescribed, b, c, motions, equality)
    near, active, _ = problem.interior()
    solution, _ = problem.newton(active, near.copy())
    if solution is None:
        raise OracleError("checks: the active sets do not converge from an interior point")
    u, multipliers, _ = solution
    full = problem.u_full.copy()
    full[problem.free] = u
    return 0.5 * full @ (k @ full) - load @ full, multipliers


def by_walking(contact, phi, lower, upper, volume):
    """The least energy that an optimiser over designs finds from -Phi'l, and the volume by which it is too large."""
    weights, scale, unit = phi.T @ contact.areas, 1.0 / abs(pressures(contact).energy), upper - lower
    bounds = [(lower / unit, upper / unit)] * phi.shape[1]

    def energy(x):
        found = pressures(contact, contact.gaps + unit * (phi @ x))
        return scale * found.energy, -scale * unit * (phi.T @ found.forces)

    limit = {"type": "ineq", "fun": lambda x: volume / unit - weights @ x, "jac": lambda x: -weights}
    options = {"ftol": 1e-13, "maxiter": 1000}
    found = scipy.optimize.minimize(
        energy, np.zeros(phi.shape[1]), jac=True, method="SLSQP", bounds=bounds, constraints=[limit], options=options
    )
    return found.fun / scale, unit * (weights @ found.x) - volume


def check_softest(check):
    rng = np.random.default_rng(5)
    lower, upper, volume = -0.002, 0.003, 0.0004
    for name, scene in (("carried", punch()), ("held", punch(down=0.03)), ("on a plane", on_plane())):
        contact = condense(scene)
        along = contact.x[:, 0]
        designs = {
            "nodes": np.eye(len(along)), "hats": hats(along, np.linspace(0, 1, 5)), "polynomials": polynomials(along, 3),
        }
        for kind, phi in designs.items():
            found = softest(contact, phi, lower, upper, (-np.inf, volume))
            what = f"{kind}, {name}"
            check(f"conditions of optimality, {what}", max(found.residuals.values()), 1e-9)
            energy = found.pressed.energy
            reference, multipliers = in_one(scene, contact, phi, lower, upper, volume)
            check(f"energy by displacements and design in one, {what}", abs(energy / reference - 1), 1e-10)
            forces = multipliers[: len(along)]
            check("and forces", np.abs(found.pressed.forces - forces).max() / forces.max(), 1e-8)
            check("and the volume's multiplier", abs(found.volume_multiplier - multipliers[-1]) / PRESSURE, 1e-8)
            # It is asked for 1e-13 of the energy; where its line search fails it ends before.
            walked, excess = by_walking(contact, phi, lower, upper, volume)
            check("an optimiser gets there", (walked - energy) / abs(energy), 1e-6)
            # The energy is convex: beyond the limit by an excess it falls by at most so much.
            allowed = found.volume_multiplier * max(excess, 0.0)
            check("and not below", (energy - allowed - walked) / abs(energy), 1e-12)
            check_others(check, contact, phi, found, (lower, upper, volume), rng)
    contact = condense(punch())
    found = softest(contact, lower=lower, upper=upper, volume=(volume, volume))
    inside = (found.design > lower + 1e-9) & (found.design < upper - 1e-9)
    spread = np.abs(found.pressed.pressures[inside] / found.volume_multiplier - 1).max()
    check("uniform pressure where a profile by nodes is at no bound", spread, 1e-9)
    check("and some points at bounds, some not", -min(inside.sum(), (~inside).sum()), -1)


def check_others(check, contact, phi, found, limits, rng):
    lower, upper, volume = limits
    weights, best = phi.T @ contact.areas, np.inf
    for _ in range(20):
        other = np.clip(found.design + 0.001 * rng.standard_normal(len(weights)), lower, upper)
        excess = weights @ other - volume
        if excess > 0:
            # Towards a design with room to spare.
            inner = np.full(len(weights), lower) if (weights >= 0).all() else np.zeros(len(weights))
            room = volume - weights @ inner
            other = inner + (other - inner) * room / (room + excess)
        best = min(best, pressures(contact, contact.gaps + phi @ other).energy)
    check("no other design is softer", (found.pressed.energy - best) / abs(best), 0)


def check_uniform(check):
    contact = condense(punch())
    gaps, pressure = uniform_profile(contact)
    check("its pressure is the mean", abs(pressure / PRESSURE - 1), 1e-11)
    check("its least gap is zero", abs(gaps.min()), 1e-16)
    turned = uniform_profile(dataclasses.replace(contact, free=-contact.free))[0]
    check("whatever the sign of the motion that is free", np.abs(turned - gaps).max(), 1e-15)
    found = pressures(contact, gaps)
    check("the pressure of the profile", np.abs(found.pressures / pressure - 1).max(), 1e-10)
    flat = pressures(contact)
    check("that of a flat punch is far from it", -flat.peak / pressure, -2)
    total = contact.areas @ contact.gaps + 0.001
    gaps, _ = uniform_profile(contact, volume=total)
    found = softest(contact, volume=(0.001, 0.001))
    check("by nodes and without bounds it is the softest profile", np.abs(contact.gaps + found.design - gaps).max(), 1e-12)
    rng = np.random.default_rng(9)
    least = min(pressures(contact, gaps + 1e-4 * rng.random(len(gaps))).peak for _ in range(20))
    check("no profile has a peak below the mean", pressure - least, 0)
    contact = condense(punch(down=0.03))
    gaps, pressure = uniform_profile(contact, PRESSURE)
    check("of a body that is held", np.abs(pressures(contact, gaps).pressures / PRESSURE - 1).max(), 1e-10)
    # Profiles of finer grids approach one: errors shrink where the next grid halves its cells.
    ends = []
    for n in (1, 2, 4, 8):
        contact = condense(punch(n))
        ends.append(uniform_profile(contact, volume=0.0)[0][:: 2 * n])
    changes = [np.abs(b - a)[:2].max() for a, b in zip(ends, ends[1:])]
    check("profiles of four grids converge away from the edge", max(b / a for a, b in zip(changes, changes[1:])), 0.7)


def check_refused(check):
    contact = condense(punch())
    check.raises("a volume that no bounds allow", lambda: softest(contact, lower=0, upper=0.1, volume=(0.2, 0.3)))
    check.raises("bounds that cross", lambda: softest(contact, lower=1, upper=0))
    check.raises("an energy without a least one", lambda: softest(contact))
    check.raises("a pressure that does not balance", lambda: uniform_profile(contact, 2 * PRESSURE))
    check.raises("a pressure that nothing tells", lambda: uniform_profile(condense(punch(down=0.1))))
    scene = punch()
    scene.loads = [(Part("upper", "top"), (0.0, PRESSURE))]
    check.raises("a body that lifts off", lambda: pressures(condense(scene)))
    scene = on_plane()
    scene.held = []
    check.raises("a body that slides", lambda: condense(scene))
    scene = stacked()
    scene.bodies["lower"] = Block((0.2, 0.0), (1.0, 1.0), (5, 5))
    check.raises("grids that do not match", lambda: condense(scene))
    check.raises("subdomains that do not divide the cells", lambda: deck(stacked(), {"upper": (4, 1)}))


def self_test():
    """Returns the number of failures."""
    check = Checks()
    for part in (check_patches, check_contact, check_softest, check_uniform, check_refused):
        try:
            part(check)
        except OracleError as error:
            print(error)
            check(f"{part.__name__} comes to its end", 1, 0)
    print("self-test passed" if check.failures == 0 else f"self-test FAILED: {check.failures} checks")
    return check.failures
