# SPDX-License-Identifier: BSD-3-Clause
"""Where petsc4py is: on Python's path, or where Debian keeps it, beside the library that it was made for."""

import importlib.util
import sys
from pathlib import Path

PACKAGE = "python3-petsc4py"  # of Debian


def directory(roots=Path("/usr/lib/petscdir")):
    """What to add to Python's path, "" for nothing; None where there is no petsc4py.

    Of several the one of real numbers with indices of 32 bits, and of these the newest.
    """
    if importlib.util.find_spec("petsc4py"):
        return ""
    found = [path.parent for path in roots.glob("*/*/lib/python3/dist-packages/petsc4py")]
    found = [path for path in found if "complex" not in str(path)]
    plain = [path for path in found if path.parents[2].name.endswith("-real")]
    return str(max(plain or found)) if found else None


def load():
    """The module PETSc, begun without words of a command line."""
    place = directory()
    if place is None:
        raise ImportError(f"petsc4py is missing; Debian's package is {PACKAGE}")
    if place:
        sys.path.insert(0, place)
    import petsc4py

    petsc4py.init([])
    from petsc4py import PETSc

    return PETSc
