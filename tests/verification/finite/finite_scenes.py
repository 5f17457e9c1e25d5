# SPDX-License-Identifier: BSD-3-Clause
"""Decks of finite displacements, and what their runs wrote."""

import csv
import math
from pathlib import Path

import h5py
import harmos_runs as runs
import numpy as np


def text_of(value):
    if isinstance(value, (list, tuple)):
        kind = {str: "string", int: "int"}.get(type(value[0]), "double")
        return f"Array({kind})", "{" + ", ".join(map(str, value)) + "}"
    kind = {str: "string", int: "int"}.get(type(value), "double")
    return kind, str(value)


def lists(tree):
    for name, value in tree.items():
        if isinstance(value, dict):
            yield f'<ParameterList name="{name}">'
            yield from lists(value)
            yield "</ParameterList>"
        else:
            kind, text = text_of(value)
            yield f'<Parameter name="{name}" type="{kind}" value="{text}"/>'


def deck(tree):
    path = runs.scratch("deck").with_suffix(".xml")
    path.write_text("\n".join(lists({"harmos": tree})), encoding="utf-8")
    return path


def block(origin, size, parts, elements, element, material):
    return {
        "Source": "block", "Origin": [*origin, 0.0], "Size": [*size, 1.0], "Subdomains a side": [*parts, 1],
        "Elements a side": [*elements, 1], "Element": element, "Materials": [material],
    }


def geometry(text):
    """A file of Gmsh's geometry."""
    path = runs.scratch("mesh").with_suffix(".geo")
    path.write_text(text, encoding="utf-8")
    return str(path)


def rotation(vector):
    """About it, by its length."""
    angle = np.linalg.norm(vector)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = np.array(vector) / angle
    spin = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * spin + (1.0 - math.cos(angle)) * spin @ spin


def corner_parts(places):
    """Boundary parts of one node, in a file of Gmsh's geometry: "body/part" and place of each."""
    return "".join(
        f'{part}() = Point In BoundingBox{{{x - 0.1}, {y - 0.1}, {z - 0.1}, {x + 0.1}, {y + 0.1}, {z + 0.1}}}; '
        f'Physical Point("{part}") = {{{part}()}};\n'
        for part, (x, y, z) in ((name.split("/")[1], place) for name, place in places.items())
    )


def carried(places, steps, where):
    """Histories and prescribed displacements of such parts: where(name, place, k) they are after k steps of length 1."""
    times = [float(k) for k in range(steps + 1)]
    histories, held = {}, {}
    for name, place in places.items():
        part = name.split("/")[1]
        ways = [where(name, place, k) - place for k in range(steps + 1)]
        for c, axis in enumerate("xyz"):
            histories[part + axis] = {"Times": times, "Values": [way[c] for way in ways]}
            held[part + axis] = {
                "Part": name, "Components": [axis], "Displacement": list(np.eye(3)[c]), "History": part + axis,
            }
    return histories, held


def field(directory, name, step=None):
    """Places and values of all nodes in the last result, or that of a step, and its cells."""
    files = sorted(Path(directory).glob("result*.vtkhdf"))
    path = files[-1] if step is None else next(file for file in files if int(file.stem.split("_")[-1]) == step)
    with h5py.File(path, "r") as file:
        group = file["VTKHDF"]
        points, values = group["Points"][:], group["PointData"][name][:]
        first = np.concatenate([[0], np.cumsum(group["NumberOfPoints"][:])[:-1]])
        cells = group["Connectivity"][:] + np.repeat(first, group["NumberOfConnectivityIds"][:])
    return points, values, cells


def steps_of(directory):
    with open(Path(directory) / "steps.csv", newline="", encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
