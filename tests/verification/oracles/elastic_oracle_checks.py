# SPDX-License-Identifier: BSD-3-Clause
"""The elastic oracle's test of itself: elastic_oracle.py --self-test.

What each part guards against:

    elements     wrong basis functions, quadrature or moduli: constant strains are reproduced
                 exactly, rigid motions cost nothing
    programs     a contact problem solved wrongly: all active sets are tried on small problems,
                 and problems of distance go to the method of Lawson and Hanson
    blocks       a body that nothing but contact holds
    composites   wrong pairs or normals, wrong treatment of fibres that may turn
"""

import itertools
import math
import sys
import tempfile
from pathlib import Path

import contact_oracle
import elastic_oracle as oracle
import numpy as np
import scipy.optimize
from contact_oracle import OracleError, solve_contact

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

import synthetic_composite  # noqa: E402

MATERIALS = ((1.0, 0.3), (10.0, 0.3))


class Checks:
    def __init__(self):
        self.failures = 0

    def __call__(self, what, error, bound):
        good = bool(error <= bound)
        self.failures += not good
        print(f"{'ok  ' if good else 'FAIL'} {what}: {error:.2e} (at most {bound:.0e})")

    def raises(self, what, call):
        try:
            call()
        except OracleError:
            self(what, 0, 0)
        else:
            self(f"{what} (nothing was raised)", 1, 0)


def exact_density(gradient, young, nu, plane):
    """Energy per volume of a constant gradient, from Hooke's law for the stresses."""
    strain = np.zeros((3, 3))
    d = len(gradient)
    strain[:d, :d] = (gradient + gradient.T) / 2
    if d == 2 and plane == "stress":
        strain[2, 2] = -nu / (1 - nu) * np.trace(strain)
    spherical = nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3)
    return young / (2 * (1 + nu)) * np.sum((strain + spherical) * strain)


def block(counts, low, high):
    """A grid of a box: points, and cells in VTK's order."""
    axes = [np.linspace(a, b, n + 1) for n, a, b in zip(counts, low, high)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(counts))
    number = np.arange(len(points)).reshape([n + 1 for n in counts])
    corners = oracle.SQUARE if len(counts) == 2 else oracle.CUBE
    cells = [
        number[tuple(slice(c, c + n) for c, n in zip(corner, counts))].ravel()
        for corner in corners
    ]
    return points, np.stack(cells, axis=1)


def single(kind, nodes):
    """A mesh of one cell."""
    cells = oracle.Cells(kind, np.arange(len(nodes))[None], np.zeros(1, dtype=int))
    return oracle.Mesh(nodes, np.zeros(len(nodes), dtype=int), [cells])


def check_elements(check):
    rng = np.random.default_rng(1)
    try:
        from vtkmodules import vtkCommonDataModel as vtk
    except ImportError:
        vtk = None
    if vtk:
        error = 0.0
        for kind, name in (
            (12, "Hexahedron"), (22, "QuadraticTriangle"), (28, "BiQuadraticQuad"),
            (24, "QuadraticTetra"), (29, "TriQuadraticHexahedron"),
        ):
            cell = getattr(vtk, f"vtk{name}")()
            count = cell.GetNumberOfPoints()
            theirs = np.reshape(cell.GetParametricCoords()[: 3 * count], (count, 3))
            ours = np.array(oracle.NODES[kind])
            error = max(error, np.abs(theirs[:, : ours.shape[1]] - ours).max())
        check("order of the nodes against VTK", error, 0)
    for kind, nodes in oracle.NODES.items():
        nodes = np.array(nodes, dtype=float)
        d = nodes.shape[1]
        shape = np.eye(d) + 0.4 * rng.standard_normal((d, d)) / d
        volume = abs(np.linalg.det(shape))
        if kind in oracle.IS_SIMPLEX:
            volume /= math.factorial(d)
        mesh = single(kind, nodes @ shape.T)
        gradient = rng.standard_normal((d, d))
        u = (mesh.nodes @ gradient.T).ravel()
        error = 0.0
        for plane in ("strain", "stress"):
            for dilatation in ("full", "projected"):
                if kind in (28, 29) and dilatation == "projected":
                    continue
                k = oracle.assemble(mesh, [(2.0, 0.3)], plane, dilatation)
                exact = volume * exact_density(gradient, 2.0, 0.3, plane)
                error = max(error, abs(0.5 * u @ (k @ u) - exact) / exact, abs(k - k.T).max())
        check(f"energy of a constant strain, cell type {kind}", error, 1e-13)
        # Distorted, so that the gradients vary.
        mesh.nodes += 0.03 * rng.standard_normal(nodes.shape)
        k = oracle.assemble(mesh, [(2.0, 0.3)])
        check(f"rigid motions, cell type {kind}", abs(k @ oracle.rigid_modes(mesh)).max(), 1e-13)
    mesh = single(9, np.array(oracle.SQUARE, dtype=float))
    full, mean = (
        oracle.assemble(mesh, [(1.0, 0.4999)], dilatation=d).toarray()
        for d in ("full", "projected")
    )
    least = np.linalg.eigvalsh(full - mean)[0]
    check("a projected dilatation never stiffens", -least / abs(full).max(), 1e-14)
    # Bending modes of Q1, which change no mean volume, must not feel the bulk modulus.
    hourglass = np.kron([1.0, -1.0, 1.0, -1.0], [1.0, 0.0])
    check("and it frees bending", hourglass @ mean @ hourglass, 10.0)


def brute_force(k, f, b, c):
    """Least energy over all active sets whose systems have an admissible solution."""
    best = math.inf
    for choice in itertools.product((False, True), repeat=len(c)):
        closed = b[np.array(choice)]
        m = len(closed)
        matrix = np.block([[k, closed.T], [closed, np.zeros((m, m))]])
        right = np.concatenate([f, c[np.array(choice)]])
        x = np.linalg.lstsq(matrix, right, rcond=None)[0]
        u = x[: len(f)]
        if np.abs(matrix @ x - right).max() < 1e-10 and (b @ u - c).max() < 1e-10:
            best = min(best, 0.5 * u @ k @ u - f @ u)
    return best


def least_distance(k, f, b, c):
    """The energy for a definite K: the point of a polyhedron closest to the origin.

    C. Lawson, R. Hanson, "Solving least squares problems", 1974, chapter 23.
    """
    lower = np.linalg.cholesky(k)
    start = np.linalg.solve(lower, f)
    g = -np.linalg.solve(lower, b.T).T
    h = -(c - b @ np.linalg.solve(lower.T, start))
    system = np.vstack([g.T, h])
    right = np.zeros(len(f) + 1)
    right[-1] = 1.0
    residual = system @ scipy.optimize.nnls(system, right)[0] - right
    y = -residual[:-1] / residual[-1]
    return 0.5 * y @ y - 0.5 * start @ start


def chains(rng, first=5, second=6, rows=5):
    """Two chains of springs, the first held; the second leans on it by some unilateral rows."""
    size = first + second
    k = np.zeros((size, size))
    for a in range(size - 1):
        if a != first - 1:
            e = np.zeros(size)
            e[a], e[a + 1] = -1.0, 1.0
            k += rng.uniform(0.5, 2) * np.outer(e, e)
    b = np.zeros((rows, size))
    b[np.arange(rows), rng.permutation(first)[:rows]] = -1.0
    b[np.arange(rows), first + rng.permutation(second)[:rows]] = 1.0
    f = 0.3 * rng.standard_normal(size)
    f[first:] += 0.5 - min(0.0, f[first:].sum() / second)  # towards the first, in total
    modes = np.zeros((size, 2))
    modes[:first, 0] = modes[first:, 1] = 1.0
    return k, f, b, 0.2 * rng.uniform(-1, 1, rows), modes


def check_programs(check):
    rng = np.random.default_rng(2)
    worst = {"sets": 0.0, "distance": 0.0, "interior": 0.0, "held": 0.0}
    for _ in range(12):
        size, count = 9, 6
        root = rng.standard_normal((size, size))
        k = root @ root.T + 0.1 * np.eye(size)
        f, b = rng.standard_normal(size), rng.standard_normal((count, size))
        c = rng.uniform(-0.5, 1.0, count)
        energy = solve_contact(k, f, {}, b, c).energy
        worst["sets"] = max(worst["sets"], abs(energy - brute_force(k, f, b, c)))
        worst["distance"] = max(worst["distance"], abs(energy - least_distance(k, f, b, c)))
    for _ in range(12):
        k, f, b, c, modes = chains(rng)
        held = {0: 0.1}
        found = solve_contact(k, f, held, b, c, modes)
        # The prescribed dof, eliminated by hand.
        rest = np.arange(1, len(f))
        moved = f[rest] - 0.1 * k[rest, 0]
        offset = 0.5 * k[0, 0] * 0.1**2 - 0.1 * f[0]
        energy = brute_force(k[np.ix_(rest, rest)], moved, b[:, rest], c - 0.1 * b[:, 0]) + offset
        worst["held"] = max(worst["held"], abs(found.energy - energy))
        problem = contact_oracle.Problem(
            contact_oracle.sp.csr_matrix(k), f, held, contact_oracle.sp.csr_matrix(b), c, modes,
            np.zeros(len(c), dtype=bool),
        )
        u, active, _ = problem.interior()
        start = problem.newton(active, u)[0]
        full = np.concatenate([[0.1], start[0]])
        error = abs(0.5 * full @ k @ full - f @ full - energy)
        worst["interior"] = max(worst["interior"], error)
    check("random programs against all active sets", worst["sets"], 1e-11)
    check("random programs against the least distance", worst["distance"], 1e-10)
    check("a chain held by contact alone against all active sets", worst["held"], 1e-11)
    check("the same by interior points", worst["interior"], 1e-11)
    k, f, b, c, modes = chains(rng)
    f[5:] = -1.0

    def fall():
        solve_contact(k, f, {0: 0.0}, b, c, modes)

    def contradict():
        solve_contact(k, -f, {0: 0.0}, np.vstack([b[0], -b[0]]), [-1.0, -1.0], modes)

    check.raises("a body that falls for ever is refused", fall)
    check.raises("bounds that contradict each other are refused", contradict)


def check_blocks(check):
    """A block laid on another and pressed: uniaxial stress, for Poisson's ratio zero."""
    for d in (2, 3):
        side = [2, 3, 2][: d - 1]
        points, cells, body = [], [], []
        for k, low in enumerate((0.0, 1.0)):
            p, c = block([*side, 3 - k], [0.0] * (d - 1) + [low], [1.0] * (d - 1) + [low + 1.0 + k])
            c += sum(map(len, points))
            cells.append(oracle.Cells(9 if d == 2 else 12, c, np.full(len(c), k)))
            points.append(p)
            body.append(np.full(len(p), k))
        mesh = oracle.build_mesh(np.concatenate(points), np.concatenate(body), cells)
        stiffness = oracle.assemble(mesh, {0: (1.0, 0.0), 1: (4.0, 0.0)})
        top = mesh.at(d - 1, 3.0)
        # Weights of the trapezoidal rule.
        ends = (mesh.nodes[top, : d - 1] == 0) | (mesh.nodes[top, : d - 1] == 1)
        load = np.zeros(mesh.size)
        pressure = 0.1
        area = (np.where(ends, 0.5, 1.0) / side).prod(axis=1)
        load[mesh.dof(top, d - 1)] = -pressure * area
        bottom = mesh.at(d - 1, 0.0)
        dirichlet = {dof: 0.0 for k in range(d) for dof in mesh.dof(bottom, k).tolist()}
        first, second = oracle.contact_pairs(mesh, 0, 1)
        check(f"pairs between blocks, dimension {d}", abs(len(first) - len(top)), 0)
        up = np.eye(d)[d - 1]
        rows = oracle.contact_rows(mesh, first, second, up)
        zero = np.zeros(len(first))
        found = solve_contact(stiffness, load, dirichlet, rows, zero, oracle.rigid_modes(mesh))
        exact = -0.5 * pressure**2 * (1.0 / 1.0 + 2.0 / 4.0)
        check(f"a block held by contact alone, dimension {d}", abs(found.energy - exact), 1e-14)
        free = found.free_motions - (1 if d == 2 else 3)
        check(f"its motions along the contact, dimension {d}", abs(free), 0)
        # On a rigid floor a gap below, the lower block left out.
        upper = oracle.part_of(mesh, [1])
        shift = upper.at(d - 1, 1.0)
        rows = oracle.obstacle_rows(upper, shift, -up)
        k = oracle.assemble(upper, {1: (4.0, 0.0)})
        f = load.reshape(-1, d)[mesh.body == 1].ravel()
        found = solve_contact(k, f, {}, rows, np.full(len(shift), 0.25), oracle.rigid_modes(upper))
        exact = -0.5 * pressure**2 * 2.0 / 4.0 - 0.25 * pressure
        error = abs(found.energy - exact)
        check(f"a block that falls on a rigid floor, dimension {d}", error, 1e-14)


def check_composites(check, directory):
    parts, centres = synthetic_composite.composite(2, 2)
    path = Path(directory) / "composite.vtkhdf"
    synthetic_composite.write_vtkhdf(path, parts, {})
    mesh = oracle.read_mesh(path)
    around = 16
    fibre = 5 * 5 + 2 * around  # core, ring, circle
    matrix = 4 * 3 * around + 6 * 9 - 9  # circles and two layers, sides of the cells
    check("nodes without copies", abs(len(mesh.nodes) - 4 * fibre - matrix), 0)
    position = np.concatenate([p for _, p, _ in parts])
    check("places of the nodes", np.abs(mesh.nodes[mesh.node_of_point] - position).max(), 1e-14)

    solved = {
        (strain, name): oracle.solve_composite(mesh, strain, MATERIALS, name)
        for strain in (0.01, -0.01, -0.02)
        for name in ("contact", "tie", "holes", "homogeneous")
    }
    energy = {key: found.energy for key, found in solved.items()}
    exact = 0.5 * 0.01**2 * 4 / (1 - 0.3**2)
    check("homogeneous: exact energy", abs(energy[0.01, "homogeneous"] - exact) / exact, 1e-12)
    for strain in (0.01, -0.01):
        kinds = [energy[strain, name] for name in ("holes", "contact", "tie")]
        check(f"holes, contact, tie in this order, strain {strain}", -min(np.diff(kinds)), -1e-7)
    ratio = energy[0.01, "contact"] / energy[-0.01, "contact"]
    check("stretch is softer than compression", ratio, 0.9)
    for name in ("tie", "holes"):
        error = abs(energy[0.01, name] / energy[-0.01, name] - 1)
        check(f"stretch is compression without contact, {name}", error, 1e-12)
    error = abs(energy[-0.02, "contact"] / (4 * energy[-0.01, "contact"]) - 1)
    check("without gaps the energy is quadratic in the strain", error, 1e-12)
    energy_of_file = oracle.composite_energy(path, 0.01, MATERIALS, "contact")
    check("energy from the file", abs(energy_of_file - energy[0.01, "contact"]), 0)

    # Tied by equations instead of shared nodes.
    found, grown = solved[0.01, "contact"], solved[0.01, "tie"]
    inside, outside = found.pairs
    rows = contact_oracle.sp.vstack(
        [oracle.contact_rows(mesh, inside, outside, np.eye(2)[k]) for k in range(2)]
    )
    materials = {0: MATERIALS[0], **{b: MATERIALS[1] for b in range(1, 5)}}
    dirichlet = {}
    for component, value, shift in ((0, 0.0, 0.0), (0, 2.0, 0.02), (1, 0.0, 0.0)):
        dofs = mesh.dof(mesh.at(component, value, 0), component)
        dirichlet |= dict.fromkeys(dofs.tolist(), shift)
    k = oracle.assemble(mesh, materials)
    bounds = np.zeros(rows.shape[0])
    equality = np.ones(len(bounds), dtype=bool)
    modes, load = oracle.rigid_modes(mesh), np.zeros(mesh.size)
    glued = solve_contact(k, load, dirichlet, rows, bounds, modes, equality)
    check("tied by equations", abs(glued.energy / energy[0.01, "tie"] - 1), 1e-11)
    number = grown.mesh.node_of_point[:, None] * 2 + np.arange(2)
    ours = mesh.node_of_point[:, None] * 2 + np.arange(2)
    error = np.abs(glued.u[ours] - grown.solution.u[number]).max()
    check("and its displacements", error, 1e-12)

    rows = oracle.contact_rows(mesh, inside, outside, found.normals)
    for strain in (0.01, -0.01):
        found = solved[strain, "contact"]
        s = found.solution
        check(f"fibres that may turn, strain {strain}", abs(s.free_motions - 4), 0)
        check(f"KKT residuals, strain {strain}", s.worst_residual, 1e-11)
        fewest = min(s.active.sum(), (~s.active).sum())
        check(f"some pairs closed, some open, strain {strain}", -fewest, -1)
        force = s.multipliers[:, None] * found.normals
        fibres = [mesh.body[inside] == body for body in range(1, 5)]
        total = max(np.abs(force[chosen].sum(axis=0)).max() for chosen in fibres)
        check(f"forces on each fibre, strain {strain}", total / np.abs(force).max(), 1e-10)
        # The same energy from points inside the bounds, without any choice of a set.
        sign = {dof: value * np.sign(strain) for dof, value in dirichlet.items()}
        problem = contact_oracle.Problem(
            k, load, sign, rows, np.zeros(len(inside)), modes, np.zeros(len(inside), dtype=bool)
        )
        full = problem.u_full.copy()
        full[problem.free] = problem.interior()[0]
        error = abs(0.5 * full @ (k @ full) / s.energy - 1)
        check(f"energy by interior points, strain {strain}", error, 1e-7)
    x, y = (mesh.nodes[inside[mesh.body[inside] == 1]] - centres[0]).T
    step = np.diff(np.sort(np.arctan2(y, x))).max()
    check("contact nodes go round the fibre", abs(step - 2 * np.pi / around), 1e-12)


def self_test():
    """Check the parts and the whole; returns the number of failures."""
    check = Checks()
    check_elements(check)
    check_programs(check)
    check_blocks(check)
    with tempfile.TemporaryDirectory() as directory:
        check_composites(check, directory)
    failures = check.failures
    print("self-test passed" if failures == 0 else f"self-test FAILED: {failures} checks")
    return failures
