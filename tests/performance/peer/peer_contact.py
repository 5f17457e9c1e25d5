# SPDX-License-Identifier: BSD-3-Clause
"""Contact of the peer: with a rigid plane, or node-to-facet with a body whose face is that plane.

With the outward normal n of its body a closed node s keeps n·u_s = n·Σ N_m u_m + gap: no masters m over a rigid plane,
the three corners of a facet over a face. Solved for u_s along z, that eliminates a row, and what is left stays
symmetric and positive definite.
"""

import dataclasses

import numpy as np

PLANE = -1.0  # of the rigid obstacle, or of the face before it is loaded
CHUNK = 256  # nodes that are looked up in all facets at once


@dataclasses.dataclass
class Candidates:
    """What may touch on this rank: closed, the displacement of `rows` is Σ weights u[columns] + lifts."""

    rows: np.ndarray
    lifts: np.ndarray
    columns: np.ndarray  # none over a rigid plane
    weights: np.ndarray
    number: int  # over all ranks, those that are held included

    def begin(self, press):
        """Closed at first: what the body penetrates when it moves as a rigid one."""
        return -self.lifts < press


def normals(mesh, group):
    """Of each node, away from the pressed surface: those of its facets, weighted by their areas."""
    facets = mesh.groups[group][:, :3]
    a, b, c = (mesh.points[facets[:, k]] for k in range(3))
    sums = np.zeros_like(mesh.points)
    for k in range(3):
        np.add.at(sums, facets[:, k], np.cross(b - a, c - a))
    middle = mesh.points[mesh.nodes("top")].mean(axis=0)
    inward = np.einsum("na,na->n", sums, mesh.points - middle) < 0.0
    sums[inward] *= -1.0
    lengths = np.linalg.norm(sums, axis=1)
    return sums / np.where(lengths > 0.0, lengths, 1.0)[:, None]


def below(points, corners):
    """The facet that each point lies on and its weights there; -1 for none. Seen along z."""
    facet = np.full(len(points), -1)
    weights = np.zeros((len(points), 3))
    a, b, c = (corners[:, k, :2] for k in range(3))
    area = np.cross(b - a, c - a)
    for begin in range(0, len(points), CHUNK):
        x = points[begin : begin + CHUNK, None, :2]
        parts = np.stack([np.cross(b - x, c - x), np.cross(c - x, a - x), np.cross(a - x, b - x)], axis=2)
        parts /= area[None, :, None]
        least = parts.min(axis=2)
        best = least.argmax(axis=1)
        rows = np.arange(len(best))
        inside = least[rows, best] > -1e-10
        facet[begin : begin + CHUNK][inside] = best[inside]
        weights[begin : begin + CHUNK][inside] = parts[rows, best][inside]
    return facet, weights


def over_plane(mesh):
    """Nodes, lifts, columns and weights over a rigid plane."""
    nodes = mesh.nodes("skin")
    return nodes, PLANE - mesh.points[nodes, 2], np.empty((len(nodes), 0), int), np.empty((len(nodes), 0))


def over_face(mesh):
    """The same over the face of another body, within a tenth of the smaller surface along the normals."""
    nodes, face = mesh.nodes("skin"), mesh.groups["face"]
    extents = [np.ptp(mesh.points[mesh.nodes(name)], axis=0).max() for name in ("skin", "face")]
    normal = normals(mesh, "skin")[nodes]
    down = normal[:, 2] < -0.1
    nodes, normal = nodes[down], normal[down]
    gaps = (PLANE - mesh.points[nodes, 2]) / normal[:, 2]
    facet, shares = below(mesh.points[nodes] + gaps[:, None] * normal, mesh.points[face])
    kept = (facet >= 0) & (gaps <= 0.1 * min(extents))
    nodes, normal, gaps, facet, shares = (x[kept] for x in (nodes, normal, gaps, facet, shares))
    slopes = normal / normal[:, 2:]
    own = 3 * nodes[:, None] + np.arange(2)
    masters = 3 * face[facet][:, :, None] + np.arange(3)
    of_masters = shares[:, :, None] * slopes[:, None, :]
    columns = np.hstack([own, masters.reshape(len(nodes), -1)])
    weights = np.hstack([-slopes[:, :2], of_masters.reshape(len(nodes), -1)])
    return nodes, gaps / normal[:, 2], columns, weights


def candidates(mesh, first, last):
    """Of the nodes from `first` to `last`."""
    nodes, lifts, columns, weights = over_face(mesh) if "face" in mesh.groups else over_plane(mesh)
    mine = (nodes >= first) & (nodes < last) & ~np.isin(nodes, mesh.nodes("top"))
    return Candidates(3 * nodes[mine] + 2, lifts[mine], columns[mine], weights[mine], len(nodes))


def prescribed(mesh, press, first, last):
    """Rows of this rank whose displacement is given, and the displacement."""
    rows, values = [], []
    for name, value in (("top", (0, 0, -press)), ("bottom", (0, 0, 0))):
        nodes = mesh.nodes(name)
        nodes = nodes[(nodes >= first) & (nodes < last)]
        rows.append((3 * nodes[:, None] + np.arange(3)).ravel())
        values.append(np.tile(np.asarray(value, float), len(nodes)))
    return np.concatenate(rows), np.concatenate(values)


def pressed(mesh, first, last):
    """Rows along z of the body above the plane."""
    return 3 * (first + np.flatnonzero(mesh.points[first:last, 2] > PLANE)) + 2
