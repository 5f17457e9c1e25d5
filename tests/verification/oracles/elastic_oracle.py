#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
r"""Monolithic reference solutions of linear elasticity with contact without friction.

Purpose
-------
An independent answer for the tests to compare with.  The mesh comes from a result file, whose
copies of a node are merged body by body; the bodies are assembled as a whole, by formulas written
here once more, and the variational inequality is solved by contact_oracle.py.  No code is shared
with the library.

Problem
-------
    minimise   E(u) = 1/2 int sigma(u) : eps(u) - f'u
    subject to prescribed displacements, and at the contact nodes to
               (u_first - u_second) . n <= gap,   n outward from the first body,

for bodies that meet at nodes of the same position, or n . u <= gap at a rigid plane.

Elements: every cell type of the result files; basis functions come from the monomials and the
reference coordinates of VTK's nodes, and Gauss quadrature has p + 1 points a direction for degree
p on quadrilaterals and hexahedra (2 x 2 for Q1), as many as the library's; on triangles and
tetrahedra it is exact for straight sides.  With dilatation "projected" the divergence on each
cell is replaced by its mean (B-bar; elements of one degree in each variable, and P2).

Composite
---------
Circular fibres (bodies 1, 2, ...) lie without adhesion in the holes of a matrix (body 0), which
is stretched or compressed: u_x = 0 on its left side, u_x = strain * width on the right, u_y = 0
on the bottom.  Interfaces: `contact`, radial and without gap; `tie`, the nodes are shared;
`holes`, no fibres; `homogeneous`, tied and everything of the material of the matrix.
"""

import argparse
import functools
import itertools
import sys
from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from contact_oracle import OracleError, solve_contact
from scipy.spatial import cKDTree

TOLERANCE = 1e-9  # of the extent: nodes at the same place

# Coordinates of VTK's nodes on the reference cell.
RING = ((0, 1), (1, 2), (2, 3), (3, 0))
EDGES = (*RING, (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
SQUARE = ((0, 0), (1, 0), (1, 1), (0, 1))
CUBE = tuple((*p, z) for z in (0, 1) for p in SQUARE)
SIMPLEX = {2: ((0, 0), (1, 0), (0, 1)), 3: ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))}
FACES = ((0, 0.5, 0.5), (1, 0.5, 0.5), (0.5, 0, 0.5), (0.5, 1, 0.5), (0.5, 0.5, 0), (0.5, 0.5, 1))
TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))


def middles(corners, edges):
    return tuple(tuple((np.array(corners[a]) + corners[b]) / 2) for a, b in edges)


NODES = {
    5: SIMPLEX[2],
    9: SQUARE,
    10: SIMPLEX[3],
    12: CUBE,
    22: SIMPLEX[2] + middles(SIMPLEX[2], TET_EDGES[:3]),
    28: SQUARE + middles(SQUARE, RING) + ((0.5, 0.5),),
    24: SIMPLEX[3] + middles(SIMPLEX[3], TET_EDGES),
    29: CUBE + middles(CUBE, EDGES) + FACES + ((0.5, 0.5, 0.5),),
}
DEGREE = {5: 1, 9: 1, 10: 1, 12: 1, 22: 2, 28: 2, 24: 2, 29: 2}
IS_SIMPLEX = (5, 10, 22, 24)


@dataclass
class Cells:
    """Cells of one type."""

    kind: int
    nodes: np.ndarray  # (m, k)
    body: np.ndarray  # (m,) which names the material


@dataclass
class Mesh:
    nodes: np.ndarray  # (n, 2) or (n, 3)
    body: np.ndarray  # (n,) of each node
    cells: list
    node_of_point: np.ndarray = field(default=None, repr=False)  # of the points of the file

    @property
    def dimension(self):
        return self.nodes.shape[1]

    @property
    def size(self):
        return self.nodes.size

    @property
    def extent(self):
        return float(np.ptp(self.nodes, axis=0).max())

    def dof(self, nodes, component):
        return self.dimension * np.asarray(nodes) + component

    def at(self, component, value, body=None):
        """The nodes with this coordinate."""
        near = np.abs(self.nodes[:, component] - value) <= TOLERANCE * self.extent
        return np.flatnonzero(near if body is None else near & (self.body == body))


def merged(points, body):
    """Number of the place of each point; points of different bodies are never merged."""
    extent = float(np.ptp(points, axis=0).max())
    # Bodies are moved apart in one direction more.
    apart = np.column_stack([points, 2.0 * extent * body])
    pairs = cKDTree(apart).query_pairs(TOLERANCE * extent, output_type="ndarray")
    graph = sp.coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points), len(points)))
    return sp.csgraph.connected_components(graph, directed=False)[1]


def build_mesh(points, body, cells):
    """A mesh whose copies of nodes are merged; `cells` number the points."""
    number = merged(points, body)
    _, first = np.unique(number, return_index=True)
    groups = [Cells(group.kind, number[group.nodes], group.body) for group in cells]
    return Mesh(points[first], body[first], groups, number)


def read_mesh(path):
    """The mesh of a result file, with one node for all copies of it within a body."""
    import h5py

    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        points = root["Points"][()].astype(float)
        counts, cells, ids = (
            root[f"NumberOf{name}"][()].astype(np.int64)
            for name in ("Points", "Cells", "ConnectivityIds")
        )
        connectivity = root["Connectivity"][()].astype(np.int64)
        offsets = root["Offsets"][()].astype(np.int64)
        types = root["Types"][()].astype(np.int64)
        body = root["CellData/body"][()].astype(np.int64).ravel()
    part = np.repeat(np.arange(len(counts)), cells)
    begin = offsets[np.arange(len(types)) + part] + (np.cumsum(ids) - ids)[part]
    shift = (np.cumsum(counts) - counts)[part]
    body_of_point = np.full(len(points), -1)
    groups = []
    for kind in np.unique(types).tolist():
        if kind not in NODES:
            raise OracleError(f"{path}: cells of the type {kind}; known are {sorted(NODES)}")
        chosen = np.flatnonzero(types == kind)
        places = begin[chosen, None] + np.arange(len(NODES[kind]))
        nodes = connectivity[places] + shift[chosen, None]
        body_of_point[nodes] = body[chosen, None]
        groups.append(Cells(kind, nodes, body[chosen]))
    if (body_of_point < 0).any():
        raise OracleError(f"{path}: points that belong to no cell")
    if len(NODES[groups[0].kind][0]) == 2:
        points = points[:, :2]
    return build_mesh(points, body_of_point, groups)


def tied(mesh):
    """The mesh with all bodies grown together; cells keep their materials."""
    one = build_mesh(mesh.nodes, np.zeros_like(mesh.body), mesh.cells)
    if mesh.node_of_point is not None:
        one.node_of_point = one.node_of_point[mesh.node_of_point]
    return one


def part_of(mesh, bodies):
    """The mesh of some of the bodies."""
    keep = np.isin(mesh.body, bodies)
    number = np.cumsum(keep) - 1
    cells = []
    for group in mesh.cells:
        chosen = np.isin(group.body, bodies)
        if chosen.any():
            cells.append(Cells(group.kind, number[group.nodes[chosen]], group.body[chosen]))
    return Mesh(mesh.nodes[keep], mesh.body[keep], cells)


@functools.lru_cache(maxsize=None)
def reference(kind):
    """Weights of the quadrature, and there the basis functions' gradients (q, k, d)."""
    nodes = np.array(NODES[kind], dtype=float)
    dimension, degree = nodes.shape[1], DEGREE[kind]
    exponents = np.array(list(itertools.product(range(degree + 1), repeat=dimension)))
    if kind in IS_SIMPLEX:
        exponents = exponents[exponents.sum(axis=1) <= degree]
    x, w = np.polynomial.legendre.leggauss(degree + (2 if kind in IS_SIMPLEX else 1))
    x, w = (x + 1) / 2, w / 2
    points = np.array(list(itertools.product(x, repeat=dimension)))
    weights = np.array(list(itertools.product(w, repeat=dimension))).prod(axis=1)
    if kind in IS_SIMPLEX:
        # The cube collapsed onto the simplex: each coordinate shrinks what is left for the next.
        for k in range(1, dimension):
            left = 1 - points[:, :k].sum(axis=1)
            weights = weights * left
            points[:, k] *= left
    coefficients = np.linalg.inv((nodes[:, None, :] ** exponents).prod(axis=2))
    gradients = np.empty((len(points), len(nodes), dimension))
    for d in range(dimension):
        lower = exponents.copy()
        lower[:, d] = np.maximum(lower[:, d] - 1, 0)
        values = exponents[:, d] * (points[:, None, :] ** lower).prod(axis=2)
        gradients[:, :, d] = values @ coefficients
    return weights, gradients


def lame(materials, body, plane):
    """lambda and mu of each cell, from (E, nu) by body."""
    try:
        pairs = np.array([materials[b] for b in body.tolist()], dtype=float)
    except (KeyError, IndexError) as error:
        raise OracleError(f"assemble: no material for body {error}") from error
    young, nu = pairs.T
    first, shear = young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))
    if plane == "stress":
        first = 2 * first * shear / (first + 2 * shear)
    return first, shear


def assemble(mesh, materials, plane="strain", dilatation="full"):
    """The stiffness without boundary conditions; dof = dimension * node + component.

    materials  (E, nu) by body
    plane      strain or stress; without meaning in space
    dilatation full, or projected onto the mean of each cell (without effect in plane stress)
    """
    if plane not in ("strain", "stress") or dilatation not in ("full", "projected"):
        raise OracleError(f"assemble: unknown plane {plane!r} or dilatation {dilatation!r}")
    in_plane_stress = mesh.dimension == 2 and plane == "stress"
    total = sp.csr_matrix((mesh.size, mesh.size))
    for group in mesh.cells:
        first, shear = lame(materials, group.body, "stress" if in_plane_stress else "strain")
        weights, reference_gradients = reference(group.kind)
        corners = mesh.nodes[group.nodes]
        m, k, d = corners.shape
        projected = dilatation == "projected" and not in_plane_stress
        if projected and group.kind in (28, 29):
            raise OracleError("assemble: the projection onto linear functions (Q2) is not here")
        stiffness = np.zeros((m, k * d, k * d))
        mean, volume = np.zeros((m, k * d)), np.zeros(m)
        for weight, gradient in zip(weights, reference_gradients):
            jacobian = np.einsum("mki,kj->mij", corners, gradient)
            size = np.linalg.det(jacobian)
            if size.min() <= 0:
                raise OracleError("assemble: an inverted cell")
            size = weight * size
            g = np.einsum("kj,mji->mki", gradient, np.linalg.inv(jacobian))
            products = np.einsum("mai,mbi->mab", g, g)
            block = np.einsum("maj,mbi->maibj", g, g)
            for i in range(d):
                block[:, :, i, :, i] += products
            stiffness += (size * shear)[:, None, None] * block.reshape(m, k * d, k * d)
            divergence = g.reshape(m, k * d)
            factor = -2 * shear / 3 if projected else first
            stiffness += np.einsum("m,ma,mb->mab", size * factor, divergence, divergence)
            mean += size[:, None] * divergence
            volume += size
        if projected:
            bulk = (first + 2 * shear / 3) / volume
            stiffness += np.einsum("m,ma,mb->mab", bulk, mean, mean)
        dofs = (d * group.nodes[:, :, None] + np.arange(d)).reshape(m, k * d)
        rows = np.repeat(dofs, k * d, axis=1).ravel()
        columns = np.tile(dofs, (1, k * d)).ravel()
        entries = (stiffness.ravel(), (rows, columns))
        total = total + sp.coo_matrix(entries, shape=total.shape).tocsr()
    return total


def rigid_modes(mesh):
    """Translations and rotations of each body, (dofs, motions), columns of the norm one."""
    d = mesh.dimension
    axes = ((0, 1),) if d == 2 else ((0, 1), (1, 2), (2, 0))
    columns = []
    for body in np.unique(mesh.body):
        nodes = np.flatnonzero(mesh.body == body)
        x = mesh.nodes[nodes] - mesh.nodes[nodes].mean(axis=0)
        motions = [np.eye(d)[k] * np.ones((len(nodes), 1)) for k in range(d)]
        for a, b in axes:
            turn = np.zeros_like(x)
            turn[:, a], turn[:, b] = -x[:, b], x[:, a]
            motions.append(turn)
        dofs = (d * nodes[:, None] + np.arange(d)).ravel()
        for motion in motions:
            values = motion.ravel() / np.linalg.norm(motion)
            zeros = np.zeros(len(dofs), dtype=int)
            columns.append(sp.coo_matrix((values, (dofs, zeros)), shape=(mesh.size, 1)))
    return sp.hstack(columns, format="csc")


def contact_pairs(mesh, first, second=None):
    """Nodes of the body `first` and of another (default: any) at the same place."""
    one = np.flatnonzero(mesh.body == first)
    others = mesh.body != first if second is None else mesh.body == second
    two = np.flatnonzero(others)
    if len(two) == 0:
        return one[:0], two
    near = cKDTree(mesh.nodes[one]).query_ball_point(mesh.nodes[two], TOLERANCE * mesh.extent)
    counts = [len(found) for found in near]
    return one[np.array(list(itertools.chain(*near)), dtype=int)], np.repeat(two, counts)


def contact_rows(mesh, first, second, normals):
    """(u_first - u_second) . n as a matrix; n points out of the first body."""
    return obstacle_rows(mesh, first, normals) - obstacle_rows(mesh, second, normals)


def obstacle_rows(mesh, nodes, normals):
    """u . n at some nodes; n points into the rigid obstacle."""
    d, count = mesh.dimension, len(nodes)
    normals = np.broadcast_to(np.asarray(normals, dtype=float), (count, d))
    columns = d * np.asarray(nodes, dtype=int)[:, None] + np.arange(d)
    rows = np.repeat(np.arange(count), d)
    entries = (normals.ravel(), (rows, columns.ravel()))
    return sp.coo_matrix(entries, shape=(count, mesh.size)).tocsr()


def circle(points):
    """Centre and radius of the circle through points, by least squares."""
    origin = points.mean(axis=0)
    x = points - origin
    system = np.column_stack([2 * x, np.ones(len(x))])
    centre = np.linalg.lstsq(system, (x**2).sum(axis=1), rcond=None)[0]
    return origin + centre[:2], float(np.sqrt(centre[2] + centre[:2] @ centre[:2]))


def radial(points, centre):
    away = points - centre
    return away / np.linalg.norm(away, axis=1, keepdims=True)


@dataclass
class Composite:
    """A solved composite."""

    mesh: Mesh  # of what was solved: without fibres, grown together, or as it was
    solution: object
    pairs: tuple  # nodes of the fibres, nodes of the matrix
    normals: np.ndarray

    @property
    def energy(self):
        return self.solution.energy


def solve_composite(mesh, strain, materials, interface="contact", plane="strain", **options):
    """Solve a composite; materials are (E, nu) of the matrix and of the fibres.

    More options are those of assemble().
    """
    if interface not in ("contact", "tie", "holes", "homogeneous"):
        raise OracleError(f"composite: unknown interface {interface!r}")
    matrix, fibre = materials
    by_body = {int(body): fibre for body in np.unique(mesh.body)}
    by_body[0] = matrix
    if interface == "homogeneous":
        by_body = dict.fromkeys(by_body, matrix)
    left, bottom = mesh.nodes.min(axis=0)
    right = mesh.nodes[:, 0].max()
    if interface == "holes":
        mesh = part_of(mesh, [0])
    elif interface in ("tie", "homogeneous"):
        mesh = tied(mesh)

    dirichlet = dict.fromkeys(mesh.dof(mesh.at(0, left, 0), 0).tolist(), 0.0)
    moved = mesh.dof(mesh.at(0, right, 0), 0)
    dirichlet |= dict.fromkeys(moved.tolist(), strain * (right - left))
    dirichlet |= dict.fromkeys(mesh.dof(mesh.at(1, bottom, 0), 1).tolist(), 0.0)

    inside, outside = contact_pairs(mesh, 0)[::-1]
    normals = np.zeros((len(inside), 2))
    for body in np.unique(mesh.body[inside]):
        chosen = mesh.body[inside] == body
        points = mesh.nodes[inside[chosen]]
        centre, radius = circle(points)
        if np.ptp(np.linalg.norm(points - centre, axis=1)) > 1e-8 * radius:
            raise OracleError(f"composite: the contact nodes of body {body} form no circle")
        normals[chosen] = radial(points, centre)
    rows = contact_rows(mesh, inside, outside, normals)
    stiffness = assemble(mesh, by_body, plane, **options)
    load = np.zeros(mesh.size)
    bounds = np.zeros(len(inside))
    solution = solve_contact(stiffness, load, dirichlet, rows, bounds, rigid_modes(mesh))
    return Composite(mesh, solution, (inside, outside), normals)


def composite_energy(path, strain, materials, interface="contact", **options):
    """The energy of the composite whose mesh is in a result file; see solve_composite()."""
    return solve_composite(read_mesh(path), strain, materials, interface, **options).energy


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Reference energies of fibre composites.")
    parser.add_argument("file", metavar="FILE", nargs="?", help="result.vtkhdf: its mesh is used")
    parser.add_argument("--strain", type=float, default=0.01, help="(default: 0.01)")
    parser.add_argument("--matrix", type=float, nargs=2, default=(1, 0.3), metavar=("E", "NU"))
    parser.add_argument("--fibre", type=float, nargs=2, default=(10, 0.3), metavar=("E", "NU"))
    parser.add_argument("--plane", choices=("strain", "stress"), default="strain")
    parser.add_argument("--dilatation", choices=("full", "projected"), default="full")
    parser.add_argument("--self-test", action="store_true", help="check the oracle itself")
    options = parser.parse_args(arguments)
    if options.self_test:
        import elastic_oracle_checks

        return 1 if elastic_oracle_checks.self_test() else 0
    if not options.file:
        parser.error("no FILE given; name a result file, or --self-test")
    try:
        mesh = read_mesh(options.file)
        for interface in ("contact", "tie", "holes", "homogeneous"):
            found = solve_composite(
                mesh, options.strain, (options.matrix, options.fibre), interface, options.plane,
                dilatation=options.dilatation,
            )
            s = found.solution
            closed = f"{int(s.active.sum())} of {len(s.active)} pairs closed"
            print(f"{interface:>12} {s.energy:24.16e} {closed}, residual {s.worst_residual:.1e}")
    except (OSError, OracleError) as error:
        print(f"elastic_oracle.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
