# SPDX-License-Identifier: BSD-3-Clause
"""A mesh of tetrahedra and the rows of its stiffness matrix that a rank owns, in numpy alone."""

import dataclasses

import numpy as np

YOUNG, POISSON = 1.0, 0.3
LAME = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
SHEAR = YOUNG / (2 * (1 + POISSON))
EDGES = ((0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3))  # Gmsh's order of second-order nodes
LEAF = 32  # nodes; below that their order does not matter


@dataclasses.dataclass
class Mesh:
    """Nodes are numbered such that each rank owns a range, and neighbours are near each other in memory."""

    points: np.ndarray
    cells: np.ndarray
    groups: dict  # facets of boundary parts, by name
    first: np.ndarray  # node of each rank, and the number of nodes

    def nodes(self, group):
        return np.unique(self.groups[group]) if group in self.groups else np.empty(0, int)


def bisected(points, numbers, parts):
    """Nodes in the order of recursive coordinate bisection, and how many each part has.

    Parts are cut further for the order within; the same on all ranks.
    """
    if parts == 1 and len(numbers) <= LEAF:
        return [numbers], [len(numbers)]
    x = points[numbers]
    numbers = numbers[np.argsort(x[:, np.argmax(np.ptp(x, axis=0))], kind="stable")]
    left = max(1, parts // 2)
    middle = len(numbers) * left // parts if parts > 1 else len(numbers) // 2
    low, low_sizes = bisected(points, numbers[:middle], left)
    high, high_sizes = bisected(points, numbers[middle:], max(1, parts - left))
    sizes = low_sizes + high_sizes if parts > 1 else [len(numbers)]
    return low + high, sizes


def read(path, ranks):
    """A mesh as gmsh_meshes.py writes it, renumbered for so many ranks."""
    with np.load(path) as file:
        arrays = dict(file)
    points, cells = arrays.pop("points"), arrays.pop("cells")
    pieces, sizes = bisected(points, np.arange(len(points)), ranks)
    order = np.concatenate(pieces)
    number = np.empty(len(points), np.int64)
    number[order] = np.arange(len(points))
    return Mesh(
        points[order],
        number[cells],
        {name: number[facets] for name, facets in arrays.items()},
        np.concatenate([[0], np.cumsum(sizes)]),
    )


def quadrature(order):
    """Points and weights on the reference tetrahedron, exact for the stiffness of cells with straight sides.

    Of second order it is P. Keast's rule of degree 4 with 11 points, "Moderate-degree tetrahedral quadrature
    formulas", 1986, which Harmos takes too: cells at the skin are curved.
    """
    if order == 1:
        return np.full((1, 3), 0.25), np.full(1, 1 / 6)
    a, b = (1 + np.sqrt(5 / 14)) / 4, (1 - np.sqrt(5 / 14)) / 4
    corners = np.full((4, 4), 1 / 14) + np.eye(4) * 10 / 14
    edges = np.array([[a if k in edge else b for k in range(4)] for edge in EDGES])
    barycentric = np.vstack([np.full((1, 4), 0.25), corners, edges])
    return barycentric[:, 1:], np.array([-74 / 5625] + 4 * [343 / 45000] + 6 * [56 / 2250])


def reference_gradients(points, order):
    """Of the basis functions, by point, function and direction."""
    slopes = np.vstack([-np.ones(3), np.eye(3)])
    if order == 1:
        return np.broadcast_to(slopes, (len(points), 4, 3))
    values = np.column_stack([1 - points.sum(axis=1), points])
    corners = [(4 * values[:, k] - 1)[:, None] * slopes[k] for k in range(4)]
    edges = [4 * (values[:, [i]] * slopes[j] + values[:, [j]] * slopes[i]) for i, j in EDGES]
    return np.stack(corners + edges, axis=1)


def gradients(mesh, cells):
    """Of the basis functions, by cell, direction, function and point; and the measures of the points."""
    order = 1 if cells.shape[1] == 4 else 2
    points, weights = quadrature(order)
    reference = reference_gradients(points, order)
    physical = np.empty((len(cells), 3, cells.shape[1], len(points)))
    measures = np.empty((len(cells), len(points)))
    for q, slopes in enumerate(reference):
        jacobian = np.einsum("cna,nb->cab", mesh.points[cells], slopes)
        measures[:, q] = weights[q] * np.linalg.det(jacobian)
        physical[..., q] = np.einsum("nb,cba->can", slopes, np.linalg.inv(jacobian))
    return physical, measures


def stiffness_rows(mesh, first, last):
    """Rows of the nodes from `first` to `last` in blocks of three by three: starts, columns, values."""
    cells = mesh.cells[np.any((mesh.cells >= first) & (mesh.cells < last), axis=1)]
    slopes, measures = gradients(mesh, cells)
    rows = np.repeat(cells, cells.shape[1], axis=1).ravel()
    columns = np.tile(cells, (1, cells.shape[1])).ravel()
    mine = (rows >= first) & (rows < last)
    keys, place = np.unique(
        (rows[mine] - first) * len(mesh.points) + columns[mine], return_inverse=True
    )
    starts = np.searchsorted(keys, np.arange(last - first + 1) * len(mesh.points))
    values = np.empty((len(keys), 3, 3))
    weighted = slopes * measures[:, None, None, :]

    def product(a, b):
        """∫ ∂N_i/∂x_a ∂N_j/∂x_b, by cell, i and j."""
        return weighted[:, a] @ slopes[:, b].transpose(0, 2, 1)

    trace = product(0, 0) + product(1, 1) + product(2, 2)
    for a in range(3):
        for b in range(3):
            here = product(a, b)
            block = LAME * here + SHEAR * here.transpose(0, 2, 1)
            if a == b:
                block += SHEAR * trace
            values[:, a, b] = np.bincount(place, block.ravel()[mine], len(keys))
    return starts, keys % len(mesh.points), values
