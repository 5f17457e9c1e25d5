# SPDX-License-Identifier: BSD-3-Clause
"""Reads what a run leaves behind: summary.json, iterations.csv, result.vtkhdf.

File layout: "VTKHDF file format", VTK documentation, version 1.0, UnstructuredGrid with one part a
subdomain.
"""

import csv
import json
import math
from dataclasses import dataclass

import numpy as np

VTK_CORNERS = {5: 3, 9: 4}  # VTK_TRIANGLE, VTK_QUAD

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


class PlotError(Exception):
    """Input that cannot be drawn; the message says what, where and how to mend it."""


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


def read_iterations(path):
    """The columns as arrays by name; an empty cell becomes NaN."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file) if row]
    except OSError as error:
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
                f"{path}: row {bad[0] + 2}, column {name}: no finite number; repeat the run"
            )
    return table


def read_field(path):
    """Read a VTKHDF UnstructuredGrid with one part a subdomain."""
    try:
        import h5py
    except ImportError as error:
        raise PlotError(
            f"{path}: reading it needs the Python package h5py (Debian: python3-h5py)"
        ) from error
    try:
        with h5py.File(path, "r") as file:
            return parse_field(path, file)
    except OSError as error:
        raise PlotError(f"{path}: not a readable HDF5 file ({error}); repeat the run") from error


def parse_field(path, file):
    def fail(what, remedy="the file is not a result of this version, repeat the run"):
        raise PlotError(f"{path}: {what}; {remedy}")

    def dataset(name, length=None):
        if name not in file["VTKHDF"]:
            fail(f"dataset /VTKHDF/{name} is missing")
        values = file["VTKHDF"][name][()]
        if length is not None and len(values) != length:
            fail(f"/VTKHDF/{name} has {len(values)} entries where {length} belong")
        return values

    def scalar(name, length):
        values = dataset(name, length)
        if values.ndim == 2 and values.shape[1] == 1:
            values = values[:, 0]
        return values

    if "VTKHDF" not in file:
        fail("no group /VTKHDF")
    kind = file["VTKHDF"].attrs.get("Type", b"")
    kind = kind.decode() if isinstance(kind, bytes) else str(kind)
    if kind != "UnstructuredGrid":
        fail(f"/VTKHDF is of type {kind!r}, not 'UnstructuredGrid'")

    points = dataset("NumberOfPoints").astype(np.int64)
    parts = len(points)
    cells = dataset("NumberOfCells", parts).astype(np.int64)
    ids = dataset("NumberOfConnectivityIds", parts).astype(np.int64)
    n_points, n_cells = int(points.sum()), int(cells.sum())
    if n_cells == 0:
        fail("the result has no cells")

    xyz = dataset("Points", n_points)
    displacement = scalar("PointData/displacement", n_points)
    if displacement.ndim != 1:
        fail(
            f"displacement has {displacement.shape[1]} components; vector displacements "
            "(elasticity) are not supported yet",
            "only membranes can be drawn, use ParaView for this result",
        )
    # A scene without contact writes neither.
    if "contact_pressure" in file["VTKHDF/PointData"]:
        pressure = scalar("PointData/contact_pressure", n_points)
        active = scalar("PointData/active_set", n_points)
    else:
        pressure = np.zeros(n_points)
        active = np.zeros(n_points, dtype=np.uint8)
    body = scalar("CellData/body", n_cells)

    for name, values in (("displacement", displacement), ("contact_pressure", pressure)):
        if not np.isfinite(values).all():
            fail(f"{name} has values that are not finite", "look at the run, it has failed")

    types = dataset("Types", n_cells)
    strange = sorted(set(np.unique(types).tolist()) - set(VTK_CORNERS))
    if strange:
        fail(
            f"cell type(s) {strange}; triangles (5) and quadrilaterals (9) can be drawn",
            "use ParaView for this result",
        )
    sizes = np.where(types == 5, 3, 4)

    # Every part has one offset more than cells, and counts its points and ids from zero.
    part_of_cell = np.repeat(np.arange(parts), cells)
    first_id = np.concatenate([[0], np.cumsum(ids)[:-1]])
    first_point = np.concatenate([[0], np.cumsum(points)[:-1]])
    offsets = dataset("Offsets", n_cells + parts)
    begin = offsets[np.arange(n_cells) + part_of_cell]
    end = offsets[np.arange(n_cells) + part_of_cell + 1]
    if not np.array_equal(end - begin, sizes):
        fail("Offsets do not fit the cell types")
    connectivity = dataset("Connectivity", int(ids.sum()))
    begin = begin + first_id[part_of_cell]
    corners = np.empty((n_cells, 4), dtype=np.int64)
    for k in range(4):
        corners[:, k] = connectivity[begin + np.minimum(k, sizes - 1)]
    if corners.min() < 0 or (corners >= points[part_of_cell][:, None]).any():
        fail("Connectivity names points outside their part")
    corners += first_point[part_of_cell][:, None]

    body_of_point = np.zeros(n_points, dtype=np.int64)
    body_of_point[corners] = body[:, None]
    return Field(
        xy=xyz[:, :2].astype(float),
        displacement=displacement.astype(float),
        pressure=pressure.astype(float),
        active=active.astype(int),
        part_of_point=np.repeat(np.arange(parts), points),
        body_of_point=body_of_point,
        cells=corners,
        part_of_cell=part_of_cell,
        parts=parts,
    )
