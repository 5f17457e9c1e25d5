# SPDX-License-Identifier: BSD-3-Clause
"""Bodies in space made in Python, torn into subdomains, for tests of pictures; no program is run."""

from itertools import permutations

import numpy as np

TETRA, HEXAHEDRON, WEDGE, TETRA_10, HEXAHEDRON_20, WEDGE_15 = 10, 12, 13, 24, 25, 26
MIDDLES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
CUBE = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


# Edges in VTK's order: of the lower end, of the upper one, between them.
HEXAHEDRON_EDGES = [*((k, (k + 1) % 4) for k in range(4)), *((4 + k, 4 + (k + 1) % 4) for k in range(4)),
                    *((k, k + 4) for k in range(4))]
WEDGE_EDGES = [*((k, (k + 1) % 3) for k in range(3)), *((3 + k, 3 + (k + 1) % 3) for k in range(3)),
               *((k, k + 3) for k in range(3))]


def with_middles(cell, edges):
    return np.concatenate([cell, [(cell[a] + cell[b]) // 2 for a, b in edges]])


def corners_of(kind):
    """The cells that fill a cube of side two, as lattice points (nodes, 3)."""
    cube = 2 * np.array(CUBE)
    if kind in (HEXAHEDRON, HEXAHEDRON_20):
        return [cube if kind == HEXAHEDRON else with_middles(cube, HEXAHEDRON_EDGES)]
    if kind in (WEDGE, WEDGE_15):
        cells = [cube[[0, 2, 1, 4, 6, 5]], cube[[2, 0, 3, 6, 4, 7]]]
        return [cell if kind == WEDGE else with_middles(cell, WEDGE_EDGES) for cell in cells]
    cells = []
    for k, order in enumerate(permutations(range(3))):
        cell = np.cumsum([np.zeros(3, dtype=int), *np.eye(3, dtype=int)[list(order)] * 2], axis=0)
        # Neither do all have one orientation nor do neighbours begin at one corner, as in mesh files.
        cell = np.roll(cell, k, axis=0)
        if kind == TETRA_10:
            cell = with_middles(cell, MIDDLES)
        cells.append(cell)
    return cells


def block(kind, count, subdomains, body=0, origin=(0.0, 0.0, 0.0), size=1.0):
    """A cube of count^3 cubes of cells a subdomain, of which it has subdomains^3.

    Parts (body, points, cells) as synthetic_composite.write_run() takes them.
    """
    side = 2 * count + 1
    lattice = np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    first = 2 * np.stack(np.meshgrid(*[np.arange(count)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    nodes = np.concatenate([first[:, None] + cell for cell in corners_of(kind)])
    used, cells = np.unique(nodes @ [side * side, side, 1], return_inverse=True)
    cells = cells.reshape(nodes.shape[:2])
    parts = []
    for place in np.ndindex(subdomains, subdomains, subdomains):
        points = (lattice[used] / (side - 1) + place) * (size / subdomains) + origin
        parts.append((body, points, cells))
    return parts


def ball(kind, count, subdomains):
    """A ball of radius one about the origin: the cube, each of its shells blown up to a sphere."""
    parts = block(kind, count, subdomains, origin=(-1.0, -1.0, -1.0), size=2.0)
    result = []
    for body, points, cells in parts:
        length = np.linalg.norm(points, axis=1, keepdims=True)
        shell = np.abs(points).max(axis=1, keepdims=True)
        result.append((body, points * shell / np.where(length == 0, 1, length), cells))
    return result


def all_points(parts):
    return np.concatenate([points for _, points, _ in parts])


def stack(kind, peak=(0.4, 0.5), radius=0.3, load=1.0):
    """Two cubes on each other, the upper one pressed onto the lower around the peak; their fields."""
    parts = block(kind, 3, 2) + block(kind, 3, 2, body=1, origin=(0.0, 0.0, 1.0))
    x = all_points(parts)
    body = np.concatenate([np.full(len(points), b) for b, points, _ in parts])
    distance = np.hypot(x[:, 0] - peak[0], x[:, 1] - peak[1])
    touching = (body == 1) & (np.abs(x[:, 2] - 1) < 1e-12)
    pressure = np.where(touching, load * np.maximum(0.0, radius - distance), 0.0)
    gap = np.where(touching & (pressure == 0), 0.05 * np.maximum(0.0, distance - radius), 0.0)
    displacement = np.zeros_like(x)
    displacement[:, 2] = -0.01 * load * x[:, 2]
    return parts, {
        "displacement": displacement,
        "von_mises": load * np.exp(-3 * distance) * (1.0 + body),
        "contact_pressure": pressure,
        "gap": gap,
        "active_set": np.where(touching, np.where(pressure > 0, 2, 1), 0).astype(np.uint8),
    }
