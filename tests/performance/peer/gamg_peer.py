# SPDX-License-Identifier: BSD-3-Clause
"""A scene of real_bodies.py in contact, by PETSc: CG and GAMG in active sets on the undecomposed matrix.

    mpirun -np 2 python3 gamg_peer.py MESH.npz --way best --press 0.03 [--rtol 1e-5] [--loose 0.1] [--options NAME=VALUE...]

Prints what was measured as JSON. Rows are distributed by recursive bisection of the nodes. What counts is all after
the matrix and the candidates are there (`seconds`); assembly in numpy and search have times of their own.
"""

import argparse
import contextlib
import gc
import json
import re
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import numpy as np  # noqa: E402
import peer_contact  # noqa: E402
import peer_elasticity  # noqa: E402
import peer_petsc  # noqa: E402
import peer_sets  # noqa: E402
from peer_system import System  # noqa: E402


def assembled(PETSc, mesh, first, last):
    """The stiffness matrix and rigid body modes."""
    starts, columns, values = peer_elasticity.stiffness_rows(mesh, first, last)
    csr = (starts.astype(PETSc.IntType), columns.astype(PETSc.IntType), values.ravel())
    own = 3 * (last - first)
    sizes = ((own, 3 * len(mesh.points)),) * 2
    matrix = PETSc.Mat().createBAIJ(sizes, bsize=3, csr=csr, comm=PETSc.COMM_WORLD)
    matrix = matrix.convert("aij")
    matrix.setBlockSize(3)
    places = PETSc.Vec().createMPI((own, None), bsize=3, comm=PETSc.COMM_WORLD)
    places.getArray()[:] = mesh.points[first:last].ravel()
    return matrix, PETSc.NullSpace().createRigidBody(places)


def peak_mib():
    """Of this rank, since reset_peak()."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return int(re.search(r"^VmHWM:\s*(\d+)", status, re.M).group(1)) / 1024.0


def reset_peak():
    """The peak up to here; from here on it is that of the solution, where the system lets us begin anew."""
    peak = peak_mib()
    gc.collect()
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    return peak


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("mesh")
    parser.add_argument("--way", choices=list(peer_sets.WAYS), default="best")
    parser.add_argument("--press", type=float, default=0.03)
    parser.add_argument("--rtol", type=float, default=1e-5)
    parser.add_argument("--loose", type=float, default=0.1)
    parser.add_argument("--options", nargs="+", default=[], metavar="NAME=VALUE", help="of PETSc")
    return parser.parse_args()


def solved(PETSc, given, mesh_file):
    """What is printed of the mesh and of the solution."""
    comm = PETSc.COMM_WORLD
    begin = time.perf_counter()
    mesh = peer_elasticity.read(mesh_file, comm.getSize())
    first, last = mesh.first[comm.getRank()], mesh.first[comm.getRank() + 1]
    matrix, modes = assembled(PETSc, mesh, first, last)
    comm.barrier()
    assembled_at = time.perf_counter()
    candidates = peer_contact.candidates(mesh, first, last)
    prescribed = peer_contact.prescribed(mesh, given.press, first, last)
    body = peer_contact.pressed(mesh, first, last)
    unknowns, tied = 3 * len(mesh.points), "face" in mesh.groups
    del mesh
    peak = reset_peak()
    comm.barrier()
    ready = time.perf_counter()
    system = System(PETSc, matrix, modes, prescribed, candidates, tied)
    sets = peer_sets.ActiveSets(system, given)
    u = matrix.createVecRight()
    entries, closed = sets.run(u, body)
    comm.barrier()
    end = time.perf_counter()
    solution_peak = peak_mib()
    return {
        "unknowns": unknowns,
        "candidates": candidates.number,
        "closed": entries[-1]["closed"],
        "iterations": sum(entry["iterations"] for entry in entries),
        "energy": system.energy(u),
        "force": system.force(u, closed),
        "seconds": end - ready,
        "assembly_seconds": assembled_at - begin,
        "search_seconds": ready - assembled_at,
        "stages": sets.seconds,
        "sets": entries,
        "peak_memory_mib": system.total(max(peak, solution_peak)),
        "solution_memory_mib": system.total(solution_peak),
    }


def main():
    given = arguments()
    PETSc = peer_petsc.load()
    options = {**peer_sets.COMMON, **peer_sets.WAYS[given.way]}
    options |= dict(word.split("=", 1) for word in given.options)
    for name, value in options.items():
        PETSc.Options()[name] = value
    found = {
        "ranks": PETSc.COMM_WORLD.getSize(),
        "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        "way": given.way,
        "options": options,
        **solved(PETSc, given, given.mesh),
    }
    if PETSc.COMM_WORLD.getRank() == 0:
        print(json.dumps(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
