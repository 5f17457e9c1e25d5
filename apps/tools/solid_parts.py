# SPDX-License-Identifier: BSD-3-Clause
"""What pictures of bodies in space show of them: edges, the contact surface, a cut through the contact.

Torn meshes are joined first, so that sides between subdomains are none. All is computed on the undeformed bodies and
moved with them: a cut is made before the load, as with a saw, and drawn where the load has taken it.
"""

import dataclasses
from dataclasses import dataclass

import numpy as np
from plot_solution import CANDIDATE_CLOSED, boundary_edges
from run_results import numbered

SHARP = 35.0  # degrees between faces that meet in an edge of the body
CUT_OFF = 0.8  # of the peak; colours go to the peak where few values are above the others by less
FACING = 0.1  # cosine; faces of the contact surface that are steeper are not seen along its normal
ASIDE = 0.01  # of the body's width; a cut keeps that far from its sides
STRAIGHT = 0.96  # cosine; a normal that near to an axis is taken for the axis


def joined(solid):
    """The solid with one node for all copies of it; the others are in no cell."""
    first = np.unique(solid.place, return_index=True)[1]
    state = np.zeros(len(first), dtype=int)
    np.maximum.at(state, solid.place, solid.active)
    keep = first[solid.place]
    return dataclasses.replace(
        solid,
        active=state[solid.place],
        cells=keep[solid.cells],
        volumes={kind: keep[nodes] for kind, nodes in solid.volumes.items()},
    )


def normals(points, cells):
    """Normals of flat pieces, as long as twice their area."""
    a, b, c, d = (points[cells[:, k]] for k in range(4))
    return np.cross(c - a, d - b)


def unit(vectors):
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length == 0, 1, length)


def node_areas(points, cells):
    """The share of the pieces' area that belongs to each point."""
    area = np.linalg.norm(normals(points, cells), axis=1) / 8
    return np.bincount(cells.ravel(), np.repeat(area, 4), len(points))


def top_colour(values, weights, share=0.99):
    """Where colours end: at the peak, or where the values on `share` of the weight do if that is far below."""
    if weights.sum() <= 0:
        return float(values.max(initial=0.0))
    order = np.argsort(values)
    sums = np.cumsum(weights[order])
    top = float(values[order[np.searchsorted(sums, share * sums[-1])]])
    peak = float(values[weights > 0].max())
    return top if top < CUT_OFF * peak else peak


@dataclass
class Edges:
    """Pairs of points, by why they are drawn."""

    sharp: np.ndarray  # edges of the bodies, and what hides what behind it
    mesh: np.ndarray  # the other edges of faces


def edges(solid, points, back):
    """Edges as seen from `back`; points are the deformed ones."""
    cells = solid.cells
    pairs = np.concatenate([cells[:, [k, (k + 1) % 4]] for k in range(4)])
    owner = np.tile(np.arange(len(cells)), 4)
    proper = pairs[:, 0] != pairs[:, 1]
    pairs, owner = np.sort(pairs[proper], axis=1), owner[proper]
    number = numbered(*pairs.T)
    order = np.argsort(number, kind="stable")
    begin = np.flatnonzero(np.diff(number[order], prepend=-1))
    count = np.diff(np.append(begin, len(order)))
    ends = pairs[order[begin]]
    first, last = owner[order[begin]], owner[order[begin + np.minimum(count, 2) - 1]]

    still = unit(normals(solid.xyz, cells))
    bent = np.einsum("ij,ij->i", still[first], still[last]) < np.cos(np.radians(SHARP))
    facing = unit(normals(points, cells)) @ back
    hides = (facing[first] > 0) != (facing[last] > 0)
    hides &= np.maximum(np.abs(facing[first]), np.abs(facing[last])) > 1e-3
    sharp = (count != 2) | bent | hides
    mesh = ~sharp & (solid.face_of_cell[first] != solid.face_of_cell[last])
    return Edges(ends[sharp], ends[mesh])


def contact_faces(solid, body):
    """Bool by cell: faces of the body's contact surface."""
    return (solid.active[solid.cells] > 0).all(axis=1) & (solid.body_of_point[solid.cells[:, 0]] == body)


@dataclass
class Peak:
    """The point of the highest contact pressure, or where the bodies come closest."""

    pressure: float
    place: np.ndarray
    body: int
    normal: np.ndarray  # of the body there, outward
    extent: np.ndarray  # of the closed zone along the coordinate axes


def peak_of(solid):
    """The Peak of a joined solid; None where no face can come into contact."""
    nodes = np.unique(solid.cells[(solid.active[solid.cells] > 0).all(axis=1)])
    if not len(nodes):
        return None
    pressure = solid.pressure[nodes]
    node = nodes[pressure.argmax() if pressure.max() > 0 else solid.gap[nodes].argmin()]
    body = int(solid.body_of_point[node])
    cells = solid.cells[contact_faces(solid, body)]
    normal = unit(normals(solid.xyz, cells[(cells == node).any(axis=1)]).sum(axis=0))
    # Faces beside a node lie on one side of it where the model ends in a plane of symmetry.
    if np.abs(normal).max() > STRAIGHT:
        normal = np.where(np.abs(normal) > STRAIGHT, np.sign(normal), 0.0)
    closed = nodes[(solid.active[nodes] == CANDIDATE_CLOSED) & (solid.body_of_point[nodes] == body)]
    extent = np.ptp(solid.xyz[closed], axis=0) if len(closed) else np.zeros(3)
    return Peak(float(pressure.max()), solid.xyz[node], body, normal, extent)


def picture_axes(normal):
    """Unit vectors (right, up) across a normal, as near as can be to x, y, z in the usual order."""
    axes = np.eye(3)
    right, up = np.delete(np.arange(3), np.abs(normal).argmax())
    second = unit(axes[up] - (axes[up] @ normal) * normal)
    first = np.cross(second, normal)
    return first * (1.0 if first[right] > 0 else -1.0), second


@dataclass
class Plane:
    origin: np.ndarray
    normal: np.ndarray


def cutting_plane(solid, peak):
    """The plane through the peak along the normal there, across the longer way of the closed zone.

    A plane that would be a side of the body, as in models of a quarter, is moved inside.
    """
    # The two coordinate axes that lie best in the surface; y before x before z where it does not matter.
    slanted = np.abs(peak.normal)
    steepest = int(slanted.argmax())
    choices = [k for k in (1, 0, 2) if k != steepest]
    longest = max(choices, key=lambda k: peak.extent[k])
    k = choices[0] if peak.extent[choices[0]] > 0.8 * peak.extent[longest] else longest
    axis = np.eye(3)[k]
    normal = unit(axis - (axis @ peak.normal) * peak.normal)
    own = solid.body_of_point[solid.cells[:, 0]] == peak.body
    along = solid.xyz[np.unique(solid.cells[own])] @ normal
    low, high = along.min(), along.max()
    # A plane through nodes would cut cells on either side of it, or none.
    aside = 1e-7 * solid.extent
    place = np.clip(peak.place @ normal, low + ASIDE * (high - low), high - ASIDE * (high - low)) + aside
    return Plane(peak.place + (place - peak.place @ normal) * normal, normal)


@dataclass
class Section:
    points: np.ndarray  # undeformed
    displacement: np.ndarray
    triangles: np.ndarray
    values: np.ndarray
    outline: np.ndarray  # pairs of points
    touching: np.ndarray  # by pair: on the contact surface
    closed: np.ndarray  # by pair

    def deformed(self, scale=1.0):
        return self.points + scale * self.displacement


def section(solid, values, plane):
    """The section of a joined solid, body by body: bodies in contact may have nodes in the same places."""
    import vtk_scene

    columns = np.column_stack(
        [values, solid.displacement, solid.active > 0, solid.active == CANDIDATE_CLOSED]
    )
    side = (solid.xyz - plane.origin) @ plane.normal
    volumes = {}
    for kind, nodes in solid.volumes.items():
        across = side[nodes]
        volumes[kind] = nodes[(across.min(axis=1) < 0) & (across.max(axis=1) >= 0)]
    bodies = {kind: solid.body_of_point[nodes[:, 0]] for kind, nodes in volumes.items()}
    points, triangles, found, outline, first = [], [], [], [], 0
    for body in np.unique(np.concatenate(list(bodies.values()))):
        one = {kind: nodes[bodies[kind] == body] for kind, nodes in volumes.items()}
        one = {kind: nodes for kind, nodes in one.items() if len(nodes)}
        at, cells, data = vtk_scene.cut(solid.xyz, one, columns, plane.origin, plane.normal)
        if not len(cells):
            continue
        points.append(at)
        triangles.append(cells + first)
        outline.append(boundary_edges(cells[:, [0, 1, 2, 2]]) + first)
        found.append(data)
        first += len(at)
    if not points:
        none = np.zeros(0)
        flat = np.zeros((0, 3))
        return Section(flat, flat, flat.astype(int), none, np.zeros((0, 2), int), none > 0, none > 0)
    found, outline = np.concatenate(found), np.concatenate(outline)
    # Between nodes of which one is off the contact surface the value is less than one.
    touching = (found[outline, 4] > 1 - 1e-9).all(axis=1)
    closed = touching & (found[outline, 5].mean(axis=1) >= 0.5)
    return Section(
        np.concatenate(points), found[:, 1:4], np.concatenate(triangles), found[:, 0], outline, touching,
        closed,
    )


@dataclass
class Patch:
    """A contact surface; a node stands for the parts of the faces next to it, up to their middles."""

    points: np.ndarray  # nodes, then middles of edges and faces; undeformed
    pressure: np.ndarray
    gap: np.ndarray
    closed: np.ndarray  # pieces (cells, 4)
    open: np.ndarray
    boundary: np.ndarray  # pairs of points between closed and open ones


def patch(solid, body, direction):
    """The part of a body's contact surface that is seen along the direction."""
    chosen = contact_faces(solid, body)
    chosen[chosen] = unit(normals(solid.xyz, solid.cells[chosen])) @ direction > FACING
    cells = solid.cells[chosen]
    triangle = cells[:, 2] == cells[:, 3]
    kinds = [k for k in (cells[triangle][:, :3], cells[~triangle]) if len(k)]
    data = np.column_stack([solid.xyz, solid.pressure, np.maximum(solid.gap, 0)])
    state = solid.active == CANDIDATE_CLOSED
    rows, pieces, states, border, first = [], [], [], [], 0
    for faces in kinds:
        count, ends = faces.shape
        corner = data[faces]
        middle = (corner + np.roll(corner, -1, axis=1)) / 2
        centre = corner.mean(axis=1, keepdims=True)
        rows.append(np.concatenate([corner, middle, centre], axis=1).reshape(-1, 5))
        number = first + np.arange(count * (2 * ends + 1)).reshape(count, -1)
        for k in range(ends):
            before = (k - 1) % ends
            pieces.append(number[:, [k, ends + k, 2 * ends, ends + before]])
            states.append(state[faces[:, k]])
            changes = state[faces[:, k]] != state[faces[:, (k + 1) % ends]]
            border.append(number[changes][:, [ends + k, 2 * ends]])
        first += count * (2 * ends + 1)
    if not kinds:
        none = np.zeros((0, 4), dtype=int)
        return Patch(np.zeros((0, 3)), np.zeros(0), np.zeros(0), none, none, none[:, :2])
    rows, pieces, states = np.concatenate(rows), np.concatenate(pieces), np.concatenate(states)
    return Patch(
        rows[:, :3], rows[:, 3], rows[:, 4], pieces[states], pieces[~states], np.concatenate(border)
    )


