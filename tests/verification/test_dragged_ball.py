# SPDX-License-Identifier: BSD-3-Clause
"""Half a ball of tetrahedra, pressed onto a plane with friction, dragged until it slips and then aside: against an
undecomposed dense solution.

What it guards against: forces of friction that are right by the audit, which knows the law and equilibrium, and yet those of
another history; slips that are measured from anywhere but where the last step left them; coefficients, areas and compliances
that are not those of the body; answers that depend on cuts and ranks.
"""

import csv
import functools
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parent / "oracles"))

import harmos_decks  # noqa: E402
import harmos_runs as runs  # noqa: E402
import real_bodies  # noqa: E402

try:
    import h5py
    import numpy as np
    from elastic_oracle import assemble, read_mesh
    from friction_oracle import Body, Points
except ImportError as error:
    runs.skip(f"{error.name} is not installed")

YOUNG, POISSON = 1.0, 0.3
SCALE = 3.5  # of the elements: 4000 unknowns, some fifty points in contact
PRESS = 0.03

# Factors of the displacements of the top by time. Steps end at whole times.
HISTORIES = {
    "press": ((0.0, 2.0), (0.0, 1.0)),
    "drag": ((2.0, 8.0), (0.0, 1.0)),
    "turn": ((8.0, 10.0), (0.0, 1.0)),
}
STEPS = 10
AXES = {"drag": 0, "turn": 1, "press": 2}
# By the coefficient: along x until all slips, then along y.
DISTANCES = {0.3: {"drag": 0.02, "turn": 0.01}, 0.8: {"drag": 0.05, "turn": 0.02}}

TOLERANCE = 1e-6
# Forces are of first order in the tolerance. Asked for are 1e-4.
FORCES = 10.0 * TOLERANCE
# Of single points: slips relative to the press, directions of forces times shares in the largest. Errors of points without a
# common direction add up to that of a resultant as the root of their number, seven here.
POINTS = 10.0 * FORCES


def distance(coefficient, name):
    return -PRESS if name == "press" else DISTANCES[coefficient][name]


def deck(directory, coefficient):
    mesh = directory / "half_ball.geo"
    mesh.write_text(
        f'scale = {SCALE:g};\nInclude "{real_bodies.GEOMETRIES / "half_ball.geo"}";\n',
        encoding="utf-8",
    )
    prescribed = {}
    for name, axis in AXES.items():
        prescribed[name] = {
            "Part": "ball/top",
            "Components": ["xyz"[axis]],
            "Displacement": [distance(coefficient, name) if k == axis else 0.0 for k in range(3)],
            "History": name,
        }
    tree = {
        "Model": {"Physics": "solid", "Mesh file": mesh.name},
        "Materials": {"elastic": {"Young's modulus": YOUNG, "Poisson's ratio": POISSON}},
        "Bodies": {"ball": {"Materials": ["elastic"]}},
        "Steps": {
            "Number": STEPS,
            "End time": float(STEPS),
            "Histories": {
                name: {"Times": list(times), "Values": list(values)}
                for name, (times, values) in HISTORIES.items()
            },
        },
        "Effects": {
            "Obstacle": {
                "plane": {"Part": "ball/skin", "Point": [0.0, 0.0, -1.0], "Direction": [0.0, 0.0, 1.0]}
            },
            "Friction": {"rough": {"Contact": "plane", "Coefficient": coefficient}},
            "Prescribed displacement": prescribed,
        },
        "Output": {"Every": STEPS},
    }
    path = directory / "dragged.xml"
    path.write_text(harmos_decks.xml("harmos", tree), encoding="utf-8")
    return path


def solved(case, coefficient, parts, ranks):
    """A run's steps as a list of dicts of numbers, and its last result file."""
    with tempfile.TemporaryDirectory() as place:
        sets = {"Solver/Tolerance": TOLERANCE, "Bodies/ball/Subdomains": parts}
        run = runs.solved(case, deck(Path(place), coefficient), sets, np=ranks, program="harmos")
    with open(run.directory / "steps.csv", newline="", encoding="utf-8") as file:
        steps = [{name: float(text) for name, text in row.items()} for row in csv.DictReader(file)]
    case.assertEqual([step["time"] for step in steps], list(range(1, STEPS + 1)), run)
    return steps, run.directory / f"result_{STEPS:04d}.vtkhdf"


class Reference:
    """States of the dense solution, step by step, from the mesh of a result file alone."""

    def __init__(self, file, coefficient):
        self.mesh = mesh = read_mesh(file)
        self.coefficient = coefficient
        stiffness = assemble(mesh, [(YOUNG, POISSON)])
        top = mesh.at(2, 0.0)
        held = np.concatenate([mesh.dof(top, k) for k in range(3)])
        body = Body(stiffness, held)
        height = mesh.nodes[:, 2] + 1.0
        # Dense for those that may come down; of all others it is looked at that they do not.
        self.points = np.flatnonzero(height < 1.3 * PRESS)
        dofs = (3 * self.points[:, None] + np.arange(3)).ravel()
        law = Points(body.compliance(dofs), height[self.points], coefficient)
        self.states = []
        before, forces = np.zeros((len(self.points), 2)), None
        for time in range(1, STEPS + 1):
            factors = {name: np.interp(time, *history) for name, history in HISTORIES.items()}
            values = np.concatenate([
                np.full(len(top), factors[name] * distance(coefficient, name))
                for name in sorted(AXES, key=AXES.get)
            ])
            free = body.displacements(values)[dofs].reshape(-1, 3)
            state = law.step(free, before, forces)
            u = body.displacements(values, dofs, state.forces.ravel())
            self.check(stiffness, body, height, u, dofs, state)
            self.states.append(state)
            before, forces = state.displacements[:, :2], state.forces

    @staticmethod
    def check(stiffness, body, height, u, dofs, state):
        """Equilibrium of the whole body, and that nothing is below the plane."""
        force = stiffness @ u
        np.subtract.at(force, dofs, state.forces.ravel())
        assert np.abs(force[body.free]).max() <= 1e-11 * np.abs(state.forces).max()
        assert np.abs(u[dofs] - state.displacements.ravel()).max() <= 1e-11 * PRESS
        assert (height + u[2::3]).min() >= -1e-11 * PRESS

    def counts(self, state):
        """Points that certainly stick, that certainly slip, and all that touch."""
        size = np.linalg.norm(state.forces[:, :2], axis=1)
        limit = self.coefficient * state.forces[:, 2]
        slips = np.linalg.norm(state.slips, axis=1)
        touching = limit > POINTS * limit.max()
        sticking = touching & (size < limit - POINTS * limit.max())
        slipping = touching & (slips > POINTS * PRESS)
        return sticking.sum(), slipping.sum(), touching.sum()


@functools.cache
def first_run(coefficient):
    """A run on two ranks, and the reference on its mesh: that of all runs, whatever their cut."""
    steps, file = solved(unittest.TestCase(), coefficient, 12, 2)
    return steps, file, Reference(file, coefficient)


class Dragged(unittest.TestCase):
    def compare(self, coefficient, steps, reference, what):
        worst = 0.0
        for step, state in zip(steps, reference.states):
            expected = state.forces.sum(axis=0)
            found = [step[f"Obstacle/plane/f{axis}"] for axis in "xyz"]
            errors = np.abs(found - expected) / expected[2]
            worst = max(worst, errors.max())
            with self.subTest(what, step=step["step"]):
                self.assertLessEqual(errors.max(), FORCES, f"{found}, expected {expected}")
                sticking, slipping, touching = reference.counts(state)
                self.assertGreaterEqual(step["sticking"], sticking)
                self.assertGreaterEqual(step["slipping"], slipping)
                self.assertGreaterEqual(step["closed"], touching)
        print(f"coefficient {coefficient}, {what}: forces of {len(steps)} steps differ by {worst:.1e}")

    def go(self, coefficient):
        steps, file, reference = first_run(coefficient)
        counts = [reference.counts(state) for state in reference.states]
        iterations = [state.iterations for state in reference.states]
        residual = max(max(state.residuals.values()) for state in reference.states)
        print(
            f"coefficient {coefficient}: {len(reference.points)} points, at most {max(iterations)} iterations, "
            f"residuals of the law {residual:.1e}; sticking, slipping, touching by steps: "
            f"{[tuple(map(int, c)) for c in counts]}"
        )
        # From stick to full slip, or it would not be tested.
        self.assertGreater(counts[1][0], counts[1][2] / 2)
        self.assertEqual([c[0] for c in counts[6:8]], [0, 0])
        self.assertEqual(counts[7][1], counts[7][2])
        self.compare(coefficient, steps, reference, "12 parts on 2 ranks")
        self.compare_points(file, reference)
        return reference

    def compare_points(self, file, reference):
        """Slips since the beginning and tractions of the last step, point by point."""
        with h5py.File(file, "r") as data:
            group = data["VTKHDF/PointData"]
            slip, traction, pressure = (
                group[name][()] for name in ("slip", "friction_traction", "contact_pressure")
            )
        state = reference.states[-1]
        place = np.full(len(reference.mesh.nodes), -1)
        place[reference.points] = np.arange(len(reference.points))
        at = place[reference.mesh.node_of_point]
        touching = (at >= 0) & (state.forces[at, 2] > 0.0)
        self.assertGreater(touching.sum(), 40)
        at = at[touching]
        difference = np.abs(slip[touching, :2] - state.displacements[at, :2]).max() / PRESS
        # Ratios of forces: areas are the library's own. Of a point that bears little the ratio is known less.
        forces = state.forces[at]
        ratio = traction[touching, :2] / pressure[touching, None] - forces[:, :2] / forces[:, 2:]
        turned = (np.abs(ratio).max(axis=1) * forces[:, 2]).max() / forces[:, 2].max()
        print(f"slips and forces of points differ by {difference:.1e} and {turned:.1e}")
        self.assertLessEqual(max(difference, turned), POINTS)

    def test_a_small_coefficient_on_any_ranks(self):
        reference = self.go(0.3)
        for parts, ranks in ((8, 1), (20, 2)):
            steps, _ = solved(self, 0.3, parts, ranks)
            self.compare(0.3, steps, reference, f"{parts} parts on {ranks} ranks")

    def test_a_large_coefficient(self):
        self.go(0.8)


if __name__ == "__main__":
    runs.main()
