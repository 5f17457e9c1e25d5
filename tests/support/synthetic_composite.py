# SPDX-License-Identifier: BSD-3-Clause
"""Meshes of fibre composites made in Python, and result files written from them.

A composite consists of nx times ny square cells, of side one, with a circular hole each, filled
by a fibre. The matrix is body 0, the fibres are 1, 2, ... row by row. A cell has nine blocks of
quadrilaterals, each a subdomain of its own: the core of the fibre, the four parts around it and
the four parts of the matrix. Blocks have their own copies of the nodes on their edges.

For tests of readers and of pictures, and for the elastic oracle's test of itself; no run of the
program is needed.
"""

import csv
import json

import numpy as np

QUAD = 9  # VTK_QUAD
COLUMNS = (
    "outer,inner,step,projected_gradient,equality_residual,penalty,M,active,"
    "hessian_applications,seconds"
)


def grid(first, last, count):
    """Points between two curves, (count + 1) rows from the first to the last."""
    t = np.linspace(0.0, 1.0, count + 1)[:, None, None]
    return (1 - t) * first + t * last


def cell_blocks(centre, radius, side, rings, layers):
    """The blocks of one cell as (is_fibre, points (a, b, 2)), counter-clockwise.

    side elements along a quarter of the circle, rings of them in the fibre around its core,
    layers of them in the matrix.
    """
    half = 0.45 * radius
    s = np.linspace(-1.0, 1.0, side + 1)
    core = np.stack(np.meshgrid(half * s, half * s, indexing="ij"), axis=2)
    blocks = [(True, centre + core)]
    for quarter in range(4):
        turn = np.array([[1, 0], [0, 1]])
        for _ in range(quarter):
            turn = np.array([[0, -1], [1, 0]]) @ turn
        angle = s * np.pi / 4
        inner = np.stack([np.full_like(s, half), half * s], axis=1)
        circle = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        outer = np.stack([np.full_like(s, 0.5), 0.5 * s], axis=1)
        blocks.append((True, centre + grid(inner, circle, rings) @ turn.T))
        blocks.append((False, centre + grid(circle, outer, layers) @ turn.T))
    return blocks


def quads(rows, columns):
    number = np.arange(rows * columns).reshape(rows, columns)
    corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    return np.stack([c.ravel() for c in corners], axis=1)


def composite(nx=1, ny=1, radius=0.3, side=4, rings=2, layers=3):
    """The parts of a composite as (body, points (n, 2), cells (m, 4)); the centres by fibre."""
    parts, centres = [], []
    for j in range(ny):
        for i in range(nx):
            centre = np.array([i + 0.5, j + 0.5])
            centres.append(centre)
            for is_fibre, points in cell_blocks(centre, radius, side, rings, layers):
                body = len(centres) if is_fibre else 0
                cells = quads(*points.shape[:2])
                parts.append((body, points.reshape(-1, 2), cells))
    return parts, np.array(centres)


def write_vtkhdf(path, parts, point_data, kind=QUAD):
    """One part a subdomain; point_data are arrays by name for all points, part after part."""
    import h5py

    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([1, 0], dtype=np.int64)
        root.attrs["Type"] = np.bytes_("UnstructuredGrid")
        points = np.concatenate([p for _, p, _ in parts])
        cells = [len(c) for _, _, c in parts]
        width = parts[0][2].shape[1]
        bodies = [body for body, _, _ in parts]
        padded = np.zeros((len(points), 3))
        padded[:, : points.shape[1]] = points
        root["NumberOfPoints"] = np.array([len(p) for _, p, _ in parts], dtype=np.int64)
        root["NumberOfCells"] = np.array(cells, dtype=np.int64)
        root["NumberOfConnectivityIds"] = width * np.array(cells, dtype=np.int64)
        root["Points"] = padded
        root["Connectivity"] = np.concatenate([c.ravel() for _, _, c in parts])
        root["Offsets"] = np.concatenate([width * np.arange(n + 1) for n in cells])
        root["Types"] = np.full(sum(cells), kind, dtype=np.uint8)
        for name, values in point_data.items():
            root[f"PointData/{name}"] = values
        for name, values in (
            ("subdomain", np.arange(len(parts))), ("body", bodies), ("region", bodies)
        ):
            root[f"CellData/{name}"] = np.repeat(np.array(values, dtype=np.int32), cells)


def write_run(directory, parts, point_data, kind=QUAD, **summary):
    """A directory with all that a finished run leaves behind."""
    directory.mkdir(parents=True)
    write_vtkhdf(directory / "result.vtkhdf", parts, point_data, kind)
    with open(directory / "summary.json", "w", encoding="utf-8") as file:
        json.dump({"subdomains": len(parts), "converged": True, **summary}, file)
    with open(directory / "iterations.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS.split(","))
        for k in range(8):
            writer.writerow([0, k, "cg" if k else "start", 10.0**-k, 2.0**-k, 1, 1, k, k, k])
