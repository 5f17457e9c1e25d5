# SPDX-License-Identifier: BSD-3-Clause
"""Scenes of the application harmos against theory and against an undecomposed solve.

What it guards against: effects that decks name and scenes do not have, or have with another sign;
materials, regions and bodies that are mixed up on the way from the mesh file to the subdomains;
parts of METIS that are glued wrongly; obstacles in the wrong place.
"""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parent / "oracles"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py
    import numpy as np
    from contact_oracle import solve_contact
    from elastic_oracle import assemble, obstacle_rows, read_mesh, rigid_modes, tied
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

DECKS = runs.SOURCE / "apps" / "harmos" / "decks"


def solved(case, name, **sets):
    return runs.solved(case, DECKS / f"{name}.xml", sets.get("sets"), program="harmos")


def fields(run):
    """Point data and points, by name."""
    with h5py.File(run.directory / "result.vtkhdf", "r") as file:
        group = file["VTKHDF/PointData"]
        return {name: group[name][()] for name in group} | {"x": file["VTKHDF/Points"][()]}


class Theory(unittest.TestCase):
    def test_greco_plate(self):
        """What Code_Aster's SSNV128 publishes for such elements, to the last digit, and averages of codes within 5 %."""
        data = fields(solved(self, "greco_plate"))
        floor = np.abs(data["x"][:, 1]) < 1e-9
        x, u = data["x"][floor, 0], data["displacement"][floor, 0]
        for place, published, average in (
            (0.0, 2.84594e-5, 2.86e-5), (0.00125, 2.70792e-5, 2.72e-5), (0.005, 2.27403e-5, 2.28e-5),
            (0.0075, 1.97271e-5, 1.98e-5), (0.01125, 1.53642e-5, 1.50e-5),
        ):
            there = u[np.abs(x - place) < 1e-9]
            self.assertGreater(len(there), 0)
            # Half of the last digit, and the tolerance, 1e-8, times the condition: 1e-12.
            np.testing.assert_allclose(there, published, atol=0.5e-10 + 1e-12, rtol=0)
            np.testing.assert_allclose(there, average, rtol=0.05)

    def test_shrink_fit(self):
        """Lame's thick ring on a solid shaft of the same material, in plane stress."""
        run = solved(self, "shrink_fit", sets={"Solver/Tolerance": 1e-8})
        young, strain, a, b = 1.0, 1e-3 * 10, 1.0, 2.0
        pressure = young * strain * (b**2 - a**2) / (2 * b**2)
        data = fields(run)
        joint = data["active_set"] > 0
        self.assertTrue((data["active_set"][joint] == 2).all(), "the joint is open somewhere")
        # Second-order elements of a tenth of the radius: 0.3 % at single nodes, whose pressures are
        # those of dual functions, first-order accurate; a tenth of that on average.
        first = data["contact_pressure"][joint]
        first = first[first > 0]
        print(f"pressure / theory - 1: {first.min() / pressure - 1:.1e}, {first.max() / pressure - 1:.1e}")
        np.testing.assert_allclose(first, pressure, rtol=5e-3)
        self.assertAlmostEqual(first.mean() / pressure, 1.0, delta=1e-3)
        # The shaft is under the same pressure from all sides, uniformly.
        inside = np.linalg.norm(data["x"], axis=1) < 0.5 * a
        stress = data["stress"][inside]
        np.testing.assert_allclose(stress[:, :2], -pressure, rtol=2e-3)
        # At the outer rim 2 p a^2 / (b^2 - a^2), around the ring; half an element of second order
        # leaves a per cent.
        rim = data["von_mises"][np.linalg.norm(data["x"], axis=1) > b - 1e-9]
        np.testing.assert_allclose(rim, 2 * pressure * a**2 / (b**2 - a**2), rtol=2e-2)

    def test_membranes(self):
        """A line of constant slope and a parabola."""
        run = solved(self, "membranes", sets={"Solver/Tolerance": 1e-8})
        # The minimum lies between that of all functions and the energy of the interpolant; it would be
        # this one but for the forces on four corners, which triangles share out unevenly: h^2/12 too
        # much or too little each, whose energy is of the order of (h^2/12)^2.
        h = 1 / 16
        interpolant = -2 / 3 + h**2 / 24
        energy = run.summary["energy"]
        self.assertLess(energy, interpolant + 1e-12)
        self.assertAlmostEqual(energy, interpolant, delta=8 * (h**2 / 12) ** 2)
        data = fields(run)
        x, u = data["x"][:, 0], data["displacement"]
        left = np.minimum(x, 1.0)
        right = np.maximum(x - 1.0, 0.0)
        # The same forces, next to where they act.
        np.testing.assert_allclose(u, -left - right + right**2 / 2, atol=4 * h**2 / 12)


class Same(unittest.TestCase):
    def test_regions_of_a_body_and_tied_bodies(self):
        """One body of two regions, cut across them, is the same as two bodies glued together where
        their nodes match."""
        energies = []
        for groups in (None, "{plate, inclusion}"):
            deck = (DECKS / "tied_inclusion.xml").read_text(encoding="utf-8")
            deck = deck.replace("tied_inclusion.geo", str(DECKS / "tied_inclusion.geo"))
            sets = {"Solver/Tolerance": 1e-8}
            if groups:
                deck = self.without(self.without(deck, "inclusion"), "Tie")
                sets |= {
                    "Bodies/plate/Groups": groups,
                    "Bodies/plate/Materials": "{laminate, rubber}",
                    "Bodies/plate/Expert/Dilatation": "projected",
                }
            else:
                sets |= {f"Bodies/{body}/Expert/Dilatation": "projected" for body in ("plate", "inclusion")}
            path = runs.scratch("deck").with_suffix(".xml")
            path.write_text(deck, encoding="utf-8")
            energies.append(runs.solved(self, path, sets, program="harmos").summary["energy"])
        # Of second order in the tolerance; room for rounding, which the bulk modulus magnifies.
        self.assertAlmostEqual(energies[0] / energies[1], 1.0, delta=1e-10)

    @staticmethod
    def without(deck, name):
        """The deck without the list of this name."""
        lines = deck.splitlines()
        begin = next(k for k, line in enumerate(lines) if f'<ParameterList name="{name}">' in line)
        indent = lines[begin][: lines[begin].index("<")]
        end = lines.index(f"{indent}</ParameterList>", begin)
        return "\n".join(lines[:begin] + lines[end + 1 :])


class Oracle(unittest.TestCase):
    """Energies, of second order in a tolerance of 1e-8: 1e-9 leaves room for sums of rounding."""

    def test_tied_inclusion(self):
        materials = {"laminate": (3.0, 0.3), "rubber": (0.2, 0.4999)}
        stretch = "Effects/Prescribed displacement/stretch"
        sets = {
            "Solver/Tolerance": 1e-8,
            "Materials/laminate/Type": "isotropic",
            "Materials/laminate/Young's modulus": materials["laminate"][0],
            "Materials/laminate/Poisson's ratio": materials["laminate"][1],
            "Bodies/plate/Expert/Dilatation": "projected",
            "Effects/Traction/pull/Density": "{0, 0, 0}",
            f"{stretch}/Part": "plate/right",
            f"{stretch}/Components": "x",
            f"{stretch}/Displacement": "{0.1, 0, 0}",
        }
        # With straight sides, on which the quadratures of both are exact: on the bent ones of the deck's
        # own mesh the energies differ by 2e-8.
        straight = runs.scratch("straight").with_suffix(".geo")
        geometry = (DECKS / "tied_inclusion.geo").read_text(encoding="utf-8")
        straight.write_text(geometry + "Mesh.SecondOrderLinear = 1;\n", encoding="utf-8")
        sets["Model/Mesh file"] = straight
        run = solved(self, "tied_inclusion", sets=sets)
        mesh = tied(read_mesh(run.directory / "result.vtkhdf"))
        stiffness = assemble(mesh, list(materials.values()), dilatation="projected")
        held = {}
        for component in (0, 1):
            held |= dict.fromkeys(mesh.dof(mesh.at(0, -1.0), component).tolist(), 0.0)
        held |= dict.fromkeys(mesh.dof(mesh.at(0, 1.0), 0).tolist(), 0.1)
        none = np.zeros((0, mesh.size))
        oracle = solve_contact(stiffness, np.zeros(mesh.size), held, none, np.zeros(0))
        self.assertAlmostEqual(run.summary["energy"] / oracle.energy, 1.0, delta=1e-9)

    def test_punch(self):
        sets = {
            "Solver/Tolerance": 1e-8,
            "Bodies/block/Expert/Dilatation": "full",
            "Effects/Body force/weight/Density": "{0, 0, 0}",
        }
        run = solved(self, "punch", sets=sets)
        mesh = read_mesh(run.directory / "result.vtkhdf")
        stiffness = assemble(mesh, [(1.0, 0.45)])
        held = {}
        for component in (0, 1):
            held |= dict.fromkeys(mesh.dof(mesh.at(component, 0.0), component).tolist(), 0.0)
        held |= dict.fromkeys(mesh.dof(mesh.at(2, 0.8), 2).tolist(), -0.05)
        nodes = mesh.at(2, 0.0)
        towards = np.array([0.0, 0.0, -1.0]) - mesh.nodes[nodes]
        distance = np.linalg.norm(towards, axis=1)
        rows = obstacle_rows(mesh, nodes, towards / distance[:, None])
        modes = rigid_modes(mesh)
        oracle = solve_contact(stiffness, np.zeros(mesh.size), held, rows, distance - 1.0, modes)
        self.assertAlmostEqual(run.summary["energy"] / oracle.energy, 1.0, delta=1e-9)
        closed = np.zeros(mesh.nodes.shape[0], dtype=bool)
        closed[nodes[oracle.active]] = True
        data = fields(run)
        np.testing.assert_array_equal(data["active_set"] == 2, closed[mesh.node_of_point])


if __name__ == "__main__":
    runs.main()
