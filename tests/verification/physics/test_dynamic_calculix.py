# SPDX-License-Identifier: BSD-3-Clause
"""*DYNAMIC with contact against CalculiX, on the same mesh from the same file: a stamp on a plate that is pressed in a
short time, and let go.

What it guards against: densities, increments or amplitudes that the converter loses; another rule of time integration;
contacts of bodies in motion that are not those of another program.
"""

import re
import shutil
import sys
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TESTS / "support"), str(TESTS / "verification/finite"), str(TESTS / "verification/physics")]

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np
    from finite_scenes import field
    from test_plastic_calculix import FACES, box, mesh_lines
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

# Waves take a time of one through the plate. Masses are lumped here and not there: with a load that comes up within a
# time of one displacements differ by 9 % on four cells through the plate, 2.5 on eight and 2.2 on twelve.
INCREMENT, END, PRESSURE = 0.05, 3.0, 0.01
CELLS = 12


def bodies(order):
    """A stamp that lies on a plate, of one layer of cells, nodes at the same places."""
    return (
        box((0.0, 0.0), (4.0, 1.0), (4 * CELLS, CELLS), order, 1),
        box((1.5, 1.0), (1.0, 0.5), (CELLS, CELLS // 2), order, 100001),
    )


def model(element, amplitude):
    """Both of the same material; the pressure on the stamp goes with the amplitude."""
    plate, stamp = bodies(2 if "20" in element else 1)
    lines = mesh_lines(plate, stamp, element)
    lines += ["*NSET, NSET=AXIS"] + [f"{node}," for node, place in stamp[0].items() if place[0] == 2.0]
    lines += ["*SURFACE, NAME=LOWER"] + [f"{e}, {FACES['above']}" for e, _, j in plate[1] if j == CELLS - 1]
    lines += ["*SURFACE, NAME=UPPER"] + [f"{e}, {FACES['below']}" for e, _, j in stamp[1] if j == 0]
    lines += ["*SURFACE, NAME=LOADED"] + [f"{e}, {FACES['above']}" for e, _, j in stamp[1] if j == CELLS // 2 - 1]
    lines += ["*MATERIAL, NAME=SOFT", "*ELASTIC", "1., 0.3", "*DENSITY", "1."]
    lines += ["*SOLID SECTION, ELSET=PLATE, MATERIAL=SOFT", "*SOLID SECTION, ELSET=STAMP, MATERIAL=SOFT"]
    lines += ["*SURFACE INTERACTION, NAME=SI", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "50., 1e-3"]
    lines += ["*CONTACT PAIR, INTERACTION=SI, TYPE=SURFACE TO SURFACE", "UPPER, LOWER"]
    lines += ["*BOUNDARY", "ALL, 3, 3", "GROUND, 1, 2", "AXIS, 1, 1", "*AMPLITUDE, NAME=PRESS", ", ".join(map(str, amplitude))]
    lines += ["*STEP, INC=100000", "*DYNAMIC, ALPHA=-0.05, DIRECT", f"{INCREMENT}, {END}", "*DSLOAD, AMPLITUDE=PRESS"]
    lines += [f"LOADED, P, {PRESSURE}", "*NODE PRINT, NSET=ALL", "U", "*END STEP", ""]
    return "\n".join(lines)


@unittest.skipUnless(shutil.which("ccx"), "ccx is not installed (Debian: calculix-ccx)")
class Stamp(unittest.TestCase):
    def compare(self, element, amplitude, most):
        directory = runs.scratch("stamp")
        directory.mkdir()
        (directory / "stamp.inp").write_text(model(element, amplitude), encoding="utf-8")
        status, out, errors = runs.execute(["ccx", "-i", "stamp"], cwd=directory)
        self.assertEqual(status, 0, out + errors)
        printed = (directory / "stamp.dat").read_text(encoding="utf-8")
        theirs = [
            np.array([[float(word) for word in line.split()[1:]] for line in block.strip().split("\n")])
            for block in re.findall(r"displacements.*\n\n((?:.+\n)+)", printed)
        ]
        converter = runs.application("harmos-inp")
        status, out, errors = runs.execute([converter, directory / "stamp.inp", "--output", directory / "deck"])
        self.assertEqual(status, 0, out + errors)
        run = runs.solved(self, directory / "deck/stamp.xml", {"Output/Every": 1}, np=runs.RANKS, program="harmos")
        plate, stamp = bodies(2 if "20" in element else 1)
        places = plate[0] | stamp[0]
        above = np.array([place[1] >= 1.0 and number > 100000 for number, place in sorted(places.items())])
        differences, scale, count = [], 0.0, round(END / INCREMENT)
        self.assertEqual(len(theirs), count)
        order = np.array([place for _, place in sorted(places.items())])
        x, _, _ = field(run.directory, "displacement", 1)
        # Of nodes at one place those of the stamp come last, in both.
        at = [np.flatnonzero(np.abs(x - place).max(axis=1) < 1e-6) for place in order]
        rows = np.array([found[-1] if of_stamp else found[0] for found, of_stamp in zip(at, above)])
        for step, known in enumerate(theirs, 1):
            ours = field(run.directory, "displacement", step)[1][rows]
            differences.append(np.abs(ours - known).max())
            scale = max(scale, np.abs(known).max())
        print(element, amplitude, "largest displacement", scale, "differs by at most", max(differences) / scale, flush=True)
        self.assertLess(max(differences) / scale, most)

    def test_pressed(self):
        self.compare("C3D8", (0.0, 0.0, 2.0, 1.0, 100.0, 1.0), 0.02)

    def test_let_go(self):
        """As fast as it came the pressure goes, and the stamp comes off."""
        self.compare("C3D8", (0.0, 0.0, 1.0, 1.0, 2.0, 0.0, 100.0, 0.0), 0.03)


if __name__ == "__main__":
    runs.main()
