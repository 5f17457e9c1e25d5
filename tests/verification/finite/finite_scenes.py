# SPDX-License-Identifier: BSD-3-Clause
"""Decks of finite displacements, and what their runs wrote."""

import csv
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


def field(directory, name):
    """Places and values of all nodes in the last result, and its cells."""
    with h5py.File(sorted(Path(directory).glob("result*.vtkhdf"))[-1], "r") as file:
        group = file["VTKHDF"]
        points, values = group["Points"][:], group["PointData"][name][:]
        first = np.concatenate([[0], np.cumsum(group["NumberOfPoints"][:])[:-1]])
        cells = group["Connectivity"][:] + np.repeat(first, group["NumberOfConnectivityIds"][:])
    return points, values, cells


def steps_of(directory):
    with open(Path(directory) / "steps.csv", newline="", encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
