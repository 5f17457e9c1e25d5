# SPDX-License-Identifier: BSD-3-Clause
"""Reads what a run leaves behind: summary.json, iterations.csv, result.vtkhdf.

Membranes (a scalar displacement) become a Field, elastic bodies (a vector) a Solid.

File layout: "VTKHDF file format", VTK documentation, version 1.0, UnstructuredGrid with one part a
subdomain.
"""

import csv
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from command_line import PlotError, missing

VTK_CORNERS = {5: 3, 9: 4}  # VTK_TRIANGLE, VTK_QUAD

# For elastic bodies: what is drawn of each type of cell, as flat pieces in the plane and as faces
# in space. A triangle repeats its last corner. Cells with nodes between the corners are cut up.
TRIANGLE_6 = ((0, 3, 5, 5), (3, 1, 4, 4), (5, 4, 2, 2), (3, 4, 5, 5))
QUAD_8 = ((0, 4, 7, 7), (4, 1, 5, 5), (5, 2, 6, 6), (6, 3, 7, 7), (4, 5, 6, 7))
QUAD_9 = ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3))
TETRA_FACES = ((0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (2, 0, 3, 6, 7, 9), (0, 2, 1, 6, 5, 4))
HEX_FACES = (
    (0, 4, 7, 3, 16, 15, 19, 11, 20),
    (1, 2, 6, 5, 9, 18, 13, 17, 21),
    (0, 1, 5, 4, 8, 17, 12, 16, 22),
    (3, 7, 6, 2, 19, 14, 18, 10, 23),
    (0, 3, 2, 1, 11, 10, 9, 8, 24),
    (4, 5, 6, 7, 12, 13, 14, 15, 25),
)


WEDGE_ENDS = ((0, 1, 2, 6, 7, 8), (3, 5, 4, 11, 10, 9))
WEDGE_SIDES = ((0, 3, 4, 1, 12, 9, 13, 6, 15), (1, 4, 5, 2, 13, 10, 14, 7, 16), (2, 5, 3, 0, 14, 11, 12, 8, 17))
TRIANGLE, QUAD = ((0, 1, 2, 2),), ((0, 1, 2, 3),)
QUADS = (QUAD, QUAD_8, QUAD_9)


def _faces(sides, pieces):
    return tuple((side, pieces) for side in sides)


# By type: dimension, nodes, faces (the cell itself in the plane), each with its pieces.
VTK_PIECES = {
    5: (2, 3, _faces((range(3),), TRIANGLE)),
    9: (2, 4, _faces((range(4),), QUAD)),
    22: (2, 6, _faces((range(6),), TRIANGLE_6)),
    23: (2, 8, _faces((range(8),), QUAD_8)),
    28: (2, 9, _faces((range(9),), QUAD_9)),
    10: (3, 4, _faces(TETRA_FACES, TRIANGLE)),
    12: (3, 8, _faces(HEX_FACES, QUAD)),
    13: (3, 6, _faces(WEDGE_ENDS, TRIANGLE) + _faces(WEDGE_SIDES, QUAD)),
    24: (3, 10, _faces(TETRA_FACES, TRIANGLE_6)),
    25: (3, 20, _faces(HEX_FACES, QUAD_8)),
    26: (3, 15, _faces(WEDGE_ENDS, TRIANGLE_6) + _faces(WEDGE_SIDES, QUAD_8)),
    29: (3, 27, _faces(HEX_FACES, QUAD_9)),
    32: (3, 18, _faces(WEDGE_ENDS, TRIANGLE_6) + _faces(WEDGE_SIDES, QUAD_9)),
}

STEPS = ("start", "cg", "expansion", "proportioning", "pcpg", "active set")

COLUMNS = (
    "outer",
    "inner",
    "step",
    "projected_gradient",
    "equality_residual",
    "penalty",
    "M",
    "active",
    "hessian_applications",
    "seconds",
)


@dataclass
class Field:
    """The drawn part of a result; parts are the subdomains, points are not shared by parts."""

    xy: np.ndarray  # (points, 2)
    displacement: np.ndarray  # (points,)
    pressure: np.ndarray  # (points,)
    active: np.ndarray  # (points,) 0 off the interface, 1 open, 2 closed
    part_of_point: np.ndarray
    body_of_point: np.ndarray
    cells: np.ndarray  # (cells, 4) point numbers; a triangle repeats its last corner
    part_of_cell: np.ndarray
    parts: int


@dataclass
class Solid:
    """The drawn part of elastic bodies; parts are the subdomains, which share no points."""

    dimension: int
    xyz: np.ndarray  # (points, 3)
    displacement: np.ndarray  # (points, 3)
    von_mises: np.ndarray  # (points,); None if the result has no stresses
    pressure: np.ndarray  # (points,)
    gap: np.ndarray  # (points,)
    active: np.ndarray  # (points,) 0 off the interface, 1 open, 2 closed
    part_of_point: np.ndarray
    body_of_point: np.ndarray
    place: np.ndarray  # (points,) the same number for all copies of a node within its body
    cells: np.ndarray  # (cells, 4) pieces of the cells in the plane, in space of their outer faces
    face_of_cell: np.ndarray  # (cells,) the same number for all pieces of a face
    part_of_cell: np.ndarray
    parts: int
    volumes: dict  # in space, by type: the cells' nodes (cells, nodes)
    # With friction, else None: (points, 3), (points, 3), (points,) 0 none, 1 sticks, 2 slips.
    traction: np.ndarray = None
    slip: np.ndarray = None
    friction: np.ndarray = None
    damage: np.ndarray = None  # (points,) with adhesion, else None
    bound: np.ndarray = None  # (points,) whether adhesion acts there, broken or not, likewise
    is_finite: bool = False  # displacements are of any size, and drawn as they are

    @property
    def xy(self):
        return self.xyz[:, :2]

    @property
    def extent(self):
        return float(np.ptp(self.xyz, axis=0).max())


def numbered(*columns):
    """A number for each row of integer columns: equal rows have one, in the order of the rows."""
    order = np.lexsort(columns[::-1])
    fresh = np.zeros(len(order), dtype=bool)
    for column in columns:
        fresh[1:] |= np.diff(column[order]) != 0
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.cumsum(fresh)
    return number


def places(xyz, body):
    """Number of the node of which each point is a copy."""
    extent = np.ptp(xyz, axis=0).max() or 1.0
    # Shifted by an odd amount: multiples of simple fractions lie on no border of the boxes.
    box = np.floor((xyz / extent + 0.2718281828459) * 2**26).astype(np.int64)
    return numbered(body, *box.T)


def outer_faces(corners):
    """Bool for each face whether it belongs to one cell only.

    corners  (faces, 4) places of the corners, -1 as a triangle's last one; is sorted by row
    """
    corners.sort(axis=1)
    # Two in one: half as many columns to sort by.
    pairs = [corners[:, k].astype(np.int64) << 32 | corners[:, k + 1] for k in (0, 2)]
    number = numbered(*pairs)
    return np.bincount(number)[number] == 1


def read_summary(path):
    try:
        with open(path, encoding="utf-8") as file:
            summary = json.load(file)
    except OSError as error:
        raise PlotError(
            f"{path}: {error.strerror}; name the directory of a finished run"
        ) from error
    except ValueError as error:
        raise PlotError(f"{path}: not valid JSON ({error}); repeat the run") from error
    if not isinstance(summary, dict):
        raise PlotError(f"{path}: the top level is not an object; repeat the run")
    return summary


def running(counts):
    """Counts that begin anew, as at each step of a load, on top of those before."""
    return counts + np.concatenate([[0], np.cumsum(np.where(np.diff(counts) < 0, counts[:-1], 0))])


def read_iterations(path, growing=False):
    """The columns as arrays by name; an empty cell becomes NaN.

    growing     of a file that is being written: what follows the last end of a line is left out,
                and None is returned where there is no row yet
    """
    try:
        with open(path, newline="", encoding="utf-8") as file:
            text = file.read()
        if growing:
            text = text[: text.rfind("\n") + 1]
            if text.count("\n") < 2:
                return None
        rows = [row for row in csv.reader(text.splitlines()) if row]
    except OSError as error:
        if growing and isinstance(error, FileNotFoundError):
            return None
        raise PlotError(
            f"{path}: {error.strerror}; name the directory of a finished run"
        ) from error
    if len(rows) < 2:
        raise PlotError(f"{path}: no steps in the file; repeat the run")
    header = [name.strip() for name in rows[0]]
    missing = [name for name in COLUMNS if name not in header]
    if missing:
        raise PlotError(
            f"{path}:1: missing column(s) {', '.join(missing)}; the header must be "
            f"{','.join(COLUMNS)}"
        )
    table = {name: [] for name in COLUMNS}
    for number, row in enumerate(rows[1:], start=2):
        if len(row) != len(header):
            raise PlotError(
                f"{path}: row {number} has {len(row)} cells for {len(header)} columns; "
                "the file is cut short or damaged, repeat the run"
            )
        cells = dict(zip(header, (cell.strip() for cell in row)))
        for name in COLUMNS:
            if name == "step":
                table[name].append(cells[name])
                continue
            try:
                table[name].append(float(cells[name]) if cells[name] else math.nan)
            except ValueError as error:
                raise PlotError(
                    f"{path}: row {number}, column {name}: {cells[name]!r} is not a number; "
                    "repeat the run"
                ) from error
    unknown = sorted(set(table["step"]) - set(STEPS))
    if unknown:
        raise PlotError(
            f"{path}: unknown kind of step {', '.join(map(repr, unknown))}; "
            f"known are {', '.join(STEPS)}"
        )
    table = {name: np.array(values) for name, values in table.items()}
    for name in ("outer", "active", "hessian_applications"):
        bad = np.flatnonzero(~np.isfinite(table[name]))
        if len(bad):
            raise PlotError(
                f"{path}: row {bad[0] + 2}, column {name}: not a finite number; repeat the run"
            )
    table["hessian_applications"] = running(table["hessian_applications"])
    return table


def read_field(path):
    """The membranes of a VTKHDF UnstructuredGrid with one part a subdomain."""
    return read_with(path, parse_field)


def read_result(path):
    """A Field or a Solid, as the displacement is a scalar or a vector."""
    result = read_with(path, parse_result)
    summary = Path(path).parent / "summary.json"
    if isinstance(result, Solid) and summary.is_file():
        result.is_finite = read_summary(summary).get("kinematics") == "finite"
    return result


def read_with(path, parse):
    try:
        import h5py
    except ImportError as error:
        raise PlotError(f"{path}: {missing('h5py', error)}") from error
    try:
        with h5py.File(path, "r") as file:
            return parse(Source(path, file))
    except OSError as error:
        raise PlotError(f"{path}: not a readable HDF5 file ({error}); repeat the run") from error


class Source:
    """The arrays of an open file, and its points and cells."""

    def __init__(self, path, file):
        self.path = path
        if "VTKHDF" not in file:
            self.fail("no group /VTKHDF")
        self.root = file["VTKHDF"]
        kind = self.root.attrs.get("Type", b"")
        kind = kind.decode() if isinstance(kind, bytes) else str(kind)
        if kind != "UnstructuredGrid":
            self.fail(f"/VTKHDF is of type {kind!r}, not 'UnstructuredGrid'")

        self.points = self.dataset("NumberOfPoints").astype(np.int64)
        self.parts = len(self.points)
        self.cells = self.dataset("NumberOfCells", self.parts).astype(np.int64)
        self.ids = self.dataset("NumberOfConnectivityIds", self.parts).astype(np.int64)
        self.n_points, self.n_cells = int(self.points.sum()), int(self.cells.sum())
        if self.n_cells == 0:
            self.fail("the result has no cells")
        self.part_of_cell = np.repeat(np.arange(self.parts), self.cells)
        self.part_of_point = np.repeat(np.arange(self.parts), self.points)

    def fail(self, what, remedy="the file is not a result of this version, repeat the run"):
        raise PlotError(f"{self.path}: {what}; {remedy}")

    def __contains__(self, name):
        return name in self.root

    def dataset(self, name, length=None):
        if name not in self.root:
            self.fail(f"dataset /VTKHDF/{name} is missing")
        values = self.root[name][()]
        if length is not None and len(values) != length:
            self.fail(f"/VTKHDF/{name} has {len(values)} entries instead of {length}")
        return values

    def column(self, name, length):
        values = self.dataset(name, length)
        if values.ndim == 2 and values.shape[1] == 1:
            values = values[:, 0]
        return values

    def point_data(self, name):
        """Values at the points, all zero if the scene did not call for them."""
        if f"PointData/{name}" not in self:
            return np.zeros(self.n_points)
        return self.column(f"PointData/{name}", self.n_points)

    def require_finite(self, **arrays):
        for name, values in arrays.items():
            if not np.isfinite(values).all():
                self.fail(
                    f"{name} has values that are not finite", "look at the run, it has failed"
                )

    def corners(self, sizes, types):
        """The cells' numbers and their nodes' numbers, (cells, nodes), by type.

        sizes  nodes by type
        """
        # Every part has one offset more than cells, and counts its points and ids from zero.
        part = self.part_of_cell
        offsets = self.dataset("Offsets", self.n_cells + self.parts)
        begin = offsets[np.arange(self.n_cells) + part]
        end = offsets[np.arange(self.n_cells) + part + 1]
        connectivity = self.dataset("Connectivity", int(self.ids.sum()))
        first_id = (np.cumsum(self.ids) - self.ids)[part]
        begin, end = begin + first_id, end + first_id
        first_point = (np.cumsum(self.points) - self.points)[part]
        result = {}
        for kind in np.unique(types).tolist():
            chosen = np.flatnonzero(types == kind)
            if (end[chosen] - begin[chosen] != sizes[kind]).any():
                self.fail("Offsets do not fit the cell types")
            nodes = connectivity[begin[chosen, None] + np.arange(sizes[kind])].astype(np.int64)
            if nodes.min() < 0 or (nodes >= self.points[part[chosen], None]).any():
                self.fail("Connectivity names points outside their part")
            result[kind] = (chosen, nodes + first_point[chosen, None])
        return result

    def types(self, known, words):
        types = self.dataset("Types", self.n_cells)
        strange = sorted(set(np.unique(types).tolist()) - set(known))
        if strange:
            self.fail(
                f"cell type(s) {strange}; {words} can be drawn", "use ParaView for this result"
            )
        return types


def components(source):
    displacement = source.column("PointData/displacement", source.n_points)
    return displacement.shape[1] if displacement.ndim == 2 else 1


def parse_result(source):
    return parse_field(source) if components(source) == 1 else parse_solid(source)


def parse_field(source):
    xyz = source.dataset("Points", source.n_points)
    if components(source) > 1:
        source.fail(
            f"displacement has {components(source)} components; these are no membranes",
            "use read_result(), which also reads elastic bodies",
        )
    displacement = source.column("PointData/displacement", source.n_points)
    pressure, active = source.point_data("contact_pressure"), source.point_data("active_set")
    body = source.column("CellData/body", source.n_cells)
    source.require_finite(displacement=displacement, contact_pressure=pressure)

    types = source.types(VTK_CORNERS, "triangles (5) and quadrilaterals (9)")
    corners = np.empty((source.n_cells, 4), dtype=np.int64)
    for chosen, nodes in source.corners(VTK_CORNERS, types).values():
        corners[chosen] = nodes[:, np.minimum(np.arange(4), nodes.shape[1] - 1)]

    body_of_point = np.zeros(source.n_points, dtype=np.int64)
    body_of_point[corners] = body[:, None]
    return Field(
        xy=xyz[:, :2].astype(float),
        displacement=displacement.astype(float),
        pressure=pressure.astype(float),
        active=active.astype(int),
        part_of_point=source.part_of_point,
        body_of_point=body_of_point,
        cells=corners,
        part_of_cell=source.part_of_cell,
        parts=source.parts,
    )


def parse_solid(source):
    xyz = source.dataset("Points", source.n_points).astype(float)
    displacement = np.zeros((source.n_points, 3))
    displacement[:, : components(source)] = source.dataset("PointData/displacement")
    pressure, gap = source.point_data("contact_pressure"), source.point_data("gap")
    stress = source.point_data("von_mises") if "PointData/von_mises" in source else None
    body = source.column("CellData/body", source.n_cells)
    source.require_finite(displacement=displacement, contact_pressure=pressure, gap=gap)
    if stress is not None:
        source.require_finite(von_mises=stress)
    rubs = {}
    if "PointData/friction_state" in source:
        rubs = {
            "traction": source.column("PointData/friction_traction", source.n_points).astype(float),
            "slip": source.column("PointData/slip", source.n_points).astype(float),
            "friction": source.point_data("friction_state").astype(int),
        }
        source.require_finite(friction_traction=rubs["traction"], slip=rubs["slip"])
    damage = source.point_data("damage").astype(float) if "PointData/damage" in source else None
    if damage is not None:
        source.require_finite(damage=damage)
    bound = None
    if damage is not None:
        name = "bound" if "PointData/bound" in source else "active_set"  # of results before 0.3
        bound = source.point_data(name).astype(int) > 0

    types = source.types(VTK_PIECES, f"the types {sorted(VTK_PIECES)}")
    dimensions = {VTK_PIECES[kind][0] for kind in np.unique(types).tolist()}
    if len(dimensions) > 1:
        source.fail("cells of the plane and of space in one result", "use ParaView for this result")
    dimension = dimensions.pop()
    volumes = source.corners({kind: entry[1] for kind, entry in VTK_PIECES.items()}, types)
    body_of_point = np.zeros(source.n_points, dtype=np.int64)
    for chosen, nodes in volumes.values():
        body_of_point[nodes] = body[chosen, None]
    place = places(xyz, body_of_point)
    volumes = {kind: nodes for kind, (_, nodes) in volumes.items()}
    pieces, face, parts = drawn_pieces(
        volumes, source.part_of_point, xyz, place if dimension == 3 else None
    )
    return Solid(
        dimension=dimension,
        xyz=xyz,
        displacement=displacement,
        von_mises=stress,
        pressure=pressure.astype(float),
        gap=gap.astype(float),
        active=source.point_data("active_set").astype(int),
        part_of_point=source.part_of_point,
        body_of_point=body_of_point,
        place=place,
        cells=pieces,
        face_of_cell=face,
        part_of_cell=parts,
        parts=source.parts,
        volumes=volumes if dimension == 3 else {},
        damage=damage,
        bound=bound,
        **rubs,
    )


def outwards(pieces, xyz, inside):
    """Flat pieces of faces, (faces, pieces, 4), turned so that their normals lead away from points inside.

    Cells of a mesh file may have either orientation.
    """
    corner = xyz[pieces[:, 0]]
    normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    inward = np.einsum("ij,ij->i", normal, corner.mean(axis=1) - inside) < 0
    turn = [0, 2, 1, 1] if (pieces[..., 2] == pieces[..., 3]).all() else [0, 3, 2, 1]
    return np.where(inward[:, None, None], pieces[..., turn], pieces)


def drawn_pieces(volumes, part_of_point, xyz, place):
    """Flat pieces (pieces, 4) of cells, or given the points' places of outer faces; face and part of each."""
    faces = []
    for kind, nodes in volumes.items():
        parts = part_of_point[nodes[:, 0]]
        faces += [(nodes, np.array(side), pieces, parts) for side, pieces in VTK_PIECES[kind][2]]
    count = sum(len(nodes) for nodes, *_ in faces)
    drawn = np.ones(count, dtype=bool)
    if place is not None:
        # A triangle lacks the last: which corner its pieces repeat differs between the cells of a face.
        corners, first = np.full((count, 4), -1, dtype=np.int32), 0
        for nodes, side, pieces, _ in faces:
            ends = 4 if pieces in QUADS else 3
            for k in range(ends):
                corners[first : first + len(nodes), k] = place[nodes[:, side[k]]]
            first += len(nodes)
        drawn = outer_faces(corners)
    cut, numbers, parts, first = [], [], [], 0
    for nodes, side, pieces, part in faces:
        chosen = np.flatnonzero(drawn[first : first + len(nodes)])
        flat = nodes[chosen[:, None, None], side[np.array(pieces)]]
        if place is not None:
            flat = outwards(flat, xyz, xyz[nodes[chosen]].mean(axis=1))
        cut.append(flat.reshape(-1, 4))
        numbers.append(np.repeat(first + chosen, len(pieces)))
        parts.append(np.repeat(part[chosen], len(pieces)))
        first += len(nodes)
    return np.concatenate(cut), np.concatenate(numbers), np.concatenate(parts)
