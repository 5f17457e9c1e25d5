# SPDX-License-Identifier: BSD-3-Clause
"""Meshes of the scenes in real_bodies.py as files: for decks, and for programs that do not read Gmsh's."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import real_bodies

PACKAGE = "python3-gmsh"  # of Debian

TETRAHEDRA, TRIANGLES = {4: 4, 11: 10}, {2: 3, 9: 6}  # nodes, by Gmsh's number of the type


def available():
    return importlib.util.find_spec("gmsh") is not None


def elements(model, dimension, tag, kinds):
    """Nodes of a physical group's elements by Gmsh's numbers, a row each."""
    import numpy as np

    found = []
    for entity in model.getEntitiesForPhysicalGroup(dimension, tag):
        types, _, nodes = model.mesh.getElements(dimension, entity)
        found += [block.reshape(-1, kinds[kind]) for kind, block in zip(types, nodes)]
    return np.vstack(found).astype(np.int64)


def arrays(model):
    """`points`, `cells`, and facets of each physical surface by name; nodes without a cell are left out."""
    import numpy as np

    tags, points, _ = model.mesh.getNodes()
    cells, facets = [], {}
    for dimension, tag in model.getPhysicalGroups():
        if dimension == 3:
            cells.append(elements(model, dimension, tag, TETRAHEDRA))
        elif dimension == 2:
            name = model.getPhysicalName(dimension, tag)
            facets[name] = elements(model, dimension, tag, TRIANGLES)
    cells = np.vstack(cells)
    used = np.unique(cells)
    place = np.empty(int(tags.max()) + 1, np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    number = np.full(int(tags.max()) + 1, -1, np.int64)
    number[used] = np.arange(len(used))
    return {
        "points": points.reshape(-1, 3)[place[used]],
        "cells": number[cells],
        **{name: number[found] for name, found in facets.items()},
    }


READER = """
import sys, time
sys.path.insert(0, sys.argv[1])
import gmsh, gmsh_meshes, numpy
gmsh.initialize()
gmsh.option.setNumber("General.Verbosity", 1)
begin = time.perf_counter()
gmsh.open(sys.argv[2])
gmsh_meshes.arrays(gmsh.model)
print(time.perf_counter() - begin)
"""


def seconds_to_read(mesh):
    """Seconds to read a file of Gmsh into arrays of points, cells and facets, in a process of its own."""
    command = [sys.executable, "-c", READER, str(Path(__file__).resolve().parent), str(mesh)]
    return float(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()[-1])


def write(directory, key, scale, press):
    """Mesh a scene in contact into KEY.msh (binary, format 4.1) and KEY.npz.

    @return the deck that names the former, the path of the latter, and the numbers of nodes and cells.
    """
    import gmsh
    import numpy as np

    deck = real_bodies.write_deck(directory, key, True, press=press, scale=scale)
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Verbosity", 1)
        gmsh.open(str(directory / f"{key}.geo"))
        gmsh.model.mesh.generate(3)
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.option.setNumber("Mesh.Binary", 1)
        gmsh.write(str(directory / f"{key}.msh"))
        found = arrays(gmsh.model)
    finally:
        gmsh.finalize()
    np.savez(directory / f"{key}.npz", **found)
    text = deck.read_text(encoding="utf-8").replace(f"{key}.geo", f"{key}.msh")
    deck.write_text(text, encoding="utf-8")
    return deck, directory / f"{key}.npz", len(found["points"]), len(found["cells"])
