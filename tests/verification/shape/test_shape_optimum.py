# SPDX-License-Identifier: BSD-3-Clause
"""What the program shape finds, against optima of the oracle, which has neither subdomains nor an optimiser that walks.

What each class guards against:

    Uniform    a peak pressure that is not the least one, which the mean is; a profile that depends on the mesh, or is
               another one than that of uniform pressure
    Softest    an optimum of the energy that is none, or depends on how bodies are cut and on ranks; multipliers of the
               wrong sign: pressures that are not uniform where no bound holds
    Stiffest   a sign that is the other way round; a design worse than what chance finds
    Moved      a displacement that is not that of the boundary part
"""

import csv
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "oracles"))

import harmos_decks  # noqa: E402
import harmos_runs as runs  # noqa: E402

try:
    import numpy as np
    from shape_optimum import hats, pressures, softest, uniform_profile
    from shape_optimum_checks import on_plane, punch, stacked
    from shape_scene import Block, Part, Scene, condense, deck
except ImportError as error:
    runs.skip(f"{error.name} is not installed")
if not runs.is_built("shape"):
    runs.skip("the program shape was not built: it needs ROL")

TOLERANCE = 1e-10
PUNCH = runs.SOURCE / "apps" / "shape" / "decks" / "punch.xml"
PRESSURE = 0.05  # of its load
MESHES = (4, 8, 16, 32)  # cells a side of a subdomain, of which the punch has two by one
CUTS = {"upper": (2, 2), "lower": (4, 2)}
TIGHT = {"Status Test": {"Gradient Tolerance": 1e-6, "Step Tolerance": 1e-12}}


def table(run, name):
    with open(run.directory / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def column(run, file, name):
    return np.array([float(row[name]) for row in table(run, file)])


class Profile:
    """Gaps and pressures along x."""

    def __init__(self, run):
        order = np.argsort(column(run, "shape.csv", "x_after"))
        self.x, self.gaps, self.pressures, self.areas = (
            column(run, "shape.csv", name)[order] for name in ("x_after", "gap_after", "pressure_after", "area")
        )
        self.results = run.summary["results"]
        self.energy = run.summary["energy"]


def lifted(gaps):
    """Gaps of a body that contact alone carries are known up to its motion."""
    return gaps - gaps.min()


def ended(case, run):
    case.assertIn(run.returncode, (0, 1), run)
    # Below its own tolerance the optimiser may say that steps are as short as they get.
    if run.returncode == 1:
        case.assertIn("steps became shorter", run.summary["reason"], run)
    return Profile(run)


class Case(unittest.TestCase):
    def found(self, scene, shape, subdomains=None, np_=1, **sets):
        path = runs.scratch("deck").with_suffix(".xml")
        tree = deck(scene, subdomains, Shape=shape, Solver={"Tolerance": TOLERANCE})
        path.write_text(harmos_decks.xml("shape", tree), encoding="utf-8")
        return ended(self, runs.run(path, sets, np_, program="shape"))


def punch_scene(n):
    """That of the deck, on n by n cells a subdomain."""
    bodies = {
        "punch": Block((0.0, 1.0), (1.0, 0.5), (2 * n, n), 5.0, 0.2),
        "ground": Block((0.0, 0.0), (2.0, 1.0), (4 * n, 2 * n), 1.0, 0.3),
    }
    held = [(Part("ground", "bottom"), {"x": 0.0, "y": 0.0}), (Part("ground", "left"), {"x": 0.0})]
    held += [(Part("punch", "left"), {"x": 0.0})]
    load = [(Part("punch", "top"), (0.0, -PRESSURE))]
    return Scene(bodies, Part("punch", "bottom"), Part("ground", "top", 0.0, 1.0), held, load)


class Uniform(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.profiles, cls.exact = [], []
        for n in MESHES:
            cells = f"{{{n}, {n}, 1}}"
            sets = {f"Bodies/{body}/Elements a side": cells for body in ("punch", "ground")}
            # The deck as it is; and to a gradient that lets profiles of meshes be told from each other.
            for found, more in ((cls.profiles, {}), (cls.exact, {"Shape/Optimiser/Status Test/Gradient Tolerance": 1e-4})):
                run = runs.run(PUNCH, sets | more, 2 if n == 8 else 1, program="shape")
                assert run.returncode == 0, run
                found.append(Profile(run))
        cls.contacts = [condense(punch_scene(n)) for n in MESHES]
        cls.uniform = [uniform_profile(contact)[0] for contact in cls.contacts]

    def test_peak_is_the_mean(self):
        rows = []
        for n, profile in zip(MESHES, self.profiles):
            peak, mean = profile.results["peak_pressure"], profile.results["mean_pressure"]
            self.assertAlmostEqual(mean / PRESSURE, 1.0, delta=100 * TOLERANCE)
            # No profile has less.
            self.assertGreater(peak, mean * (1 - 100 * TOLERANCE))
            self.assertLessEqual(peak / mean, 1.02)
            before = profile.results["peak_pressure_before"] / mean
            self.assertGreater(before, 1.9)
            rows.append((n, f"{before:.3f}", f"{peak / mean:.5f}", int(profile.results["evaluations"])))
        runs.table("Peak over mean pressure of a punch", ("cells", "flat", "designed", "evaluations"), rows)
        # What is made even is a peak that grows with each mesh.
        self.assertTrue(all(float(a[1]) < float(b[1]) for a, b in zip(rows, rows[1:])))

    def test_start_is_that_of_the_oracle(self):
        for contact, profile in zip(self.contacts, self.profiles):
            peak = pressures(contact).peak
            self.assertAlmostEqual(profile.results["peak_pressure_before"] / peak, 1.0, delta=1e3 * TOLERANCE)

    def test_profile_is_that_of_uniform_pressure(self):
        """Gaps differ by what pressures that are not wholly uniform move the surface: S g = load - forces."""
        rows = []
        for contact, gaps, profile in zip(self.contacts, self.uniform, self.exact):
            np.testing.assert_allclose(profile.x, contact.x[:, 0], atol=1e-12)
            forces = profile.pressures * profile.areas
            # As forces determine the profile, so do those of the program: its own gaps, but for tolerances.
            right = contact.load - forces
            expected = np.linalg.lstsq(contact.stiffness, right, rcond=1e-9)[0]
            size = gaps.max()
            difference = (profile.gaps - expected) - np.mean(profile.gaps - expected)
            # Errors of forces, of first order in the tolerance, over the least stiffness: a hundred for the most.
            np.testing.assert_allclose(difference, 0.0, atol=1e4 * TOLERANCE * size)
            # And from that of uniform pressure by as much as a load of the largest deviation could move it.
            deviation = np.abs(forces - PRESSURE * profile.areas)
            values, vectors = np.linalg.eigh(contact.stiffness)
            moved = vectors[:, 1:] / values[1:] @ vectors[:, 1:].T
            bound = np.abs(moved) @ deviation
            distance = np.abs((profile.gaps - gaps) - (profile.gaps - gaps).mean())
            self.assertTrue((distance <= bound + bound.mean() + 1e-9 * size).all(), (distance / size, bound / size))
            self.assertLess(distance.max(), 1e-3 * size)
            rows.append((len(gaps) // 2, f"{profile.results['peak_pressure'] / PRESSURE:.6f}", f"{distance.max() / size:.1e}"))
        runs.table("Profiles to a gradient of 1e-4", ("cells", "peak over mean", "from the oracle's"), rows)

    def test_profiles_converge(self):
        """Away from the edge; the oracle's own do, with factors below 0.7."""
        at = np.linspace(0.0, 0.75, 4)
        profiles = []
        for profile in self.exact:
            profiles.append(np.interp(at, profile.x, lifted(profile.gaps)))
        changes = [np.abs(b - a).max() for a, b in zip(profiles, profiles[1:])]
        size = profiles[-1].max()
        runs.table("Changes of the profile", ("from", "to", "share"),
                   [(a, b, f"{c / size:.2e}") for a, b, c in zip(MESHES, MESHES[1:], changes)])
        for before, after in zip(changes, changes[1:]):
            self.assertLess(after, 0.7 * before)
        self.assertLess(changes[-1], 0.01 * size)


class Softest(Case):
    """Between bounds, with a volume that is given. The optimiser stops where its gradient is 10⁻⁶ of the first."""

    LOWER, UPPER, VOLUME = -0.002, 0.003, 0.0004

    def shape(self, functions, **more):
        return {
            "Design": {"Contacts": [more.pop("of", "Contact/joint")], "Functions": functions, "Lower": [self.LOWER], "Upper": [self.UPPER], **more},
            "Cost": {"Quantity": "softest"}, "Constraints": {"Volume": [self.VOLUME]}, "Optimiser": TIGHT,
        }

    def compare(self, contact, profile, design=None):
        best = softest(contact, design, self.LOWER, self.UPPER, (self.VOLUME, self.VOLUME))
        energy = best.pressed.energy
        # J is convex: what the program finds is above the optimum, by no more than the gradient times the distance
        # within the bounds.
        room = (self.UPPER - self.LOWER) * np.sqrt(contact.areas.sum())
        excess = profile.energy - energy
        self.assertGreaterEqual(excess, -10 * TOLERANCE * abs(energy))
        self.assertLessEqual(excess, profile.results["gradient_norm"] * room + 100 * TOLERANCE * abs(energy))
        self.assertLess(excess, 1e-9 * abs(energy))
        self.assertAlmostEqual(profile.results["volume"], self.VOLUME, delta=1e-9 * room)
        return best, excess / abs(energy)

    def test_by_nodes(self):
        """The multiplier of the volume is the pressure where no bound holds."""
        rows = []
        for name, scene, cuts, of in (
            ("carried", punch(), CUTS, "Contact/joint"), ("held", punch(down=0.03), CUTS, "Contact/joint"),
            ("stacked", stacked(4), {"upper": (2, 1), "lower": (2, 4)}, "Contact/joint"),
            ("on a plane", on_plane(), {"block": (2, 2)}, "Obstacle/joint"),
        ):
            with self.subTest(name):
                contact = condense(scene)
                profile = self.found(scene, self.shape("nodes", of=of), cuts, 2)
                best, excess = self.compare(contact, profile)
                change = profile.gaps - contact.gaps
                inside = (change > self.LOWER + 1e-3 * self.UPPER) & (change < self.UPPER * (1 - 1e-3))
                inside &= profile.pressures > 0
                self.assertGreater(inside.sum(), 1)
                # The gradient without what constraints hold has the norm that is told, weighted with areas: no point
                # deviates by more than that over the root of its area.
                allowed = profile.results["gradient_norm"] / np.sqrt(profile.areas[inside].min())
                level = best.volume_multiplier
                self.assertGreater(level, 0.0)
                deviation = np.abs(profile.pressures[inside] - level).max()
                self.assertLessEqual(deviation, 2 * allowed + 1e3 * TOLERANCE * level)
                rows.append((name, f"{excess:.1e}", f"{deviation / level:.1e}", int(inside.sum()), len(change),
                             int(profile.results["evaluations"])))
        runs.table("Softest profiles by nodes", ("scene", "J above the optimum", "pressure from h", "inside", "of", "evaluations"), rows)

    def test_profile(self):
        """Where bounds leave it free it is that of the oracle."""
        contact = condense(punch())
        profile = self.found(punch(), self.shape("nodes"), CUTS, 2)
        best, _ = self.compare(contact, profile)
        # J falls off by at least half the least eigenvalue of S times the squared distance of closed points.
        excess = max(profile.energy - best.pressed.energy, 0.0) + 1e-10 * abs(best.pressed.energy)
        least = np.linalg.eigvalsh(contact.stiffness)[1]
        closed = profile.pressures > 0
        distance = np.linalg.norm((profile.gaps - contact.gaps - best.design)[closed])
        runs.table("Softest profile", ("from the oracle's", "allowed"), [(f"{distance:.1e}", f"{2 * np.sqrt(2 * excess / least):.1e}")])
        self.assertLess(distance, 2 * np.sqrt(2 * excess / least))

    def test_cuts_and_ranks(self):
        """One optimum, however bodies are cut, on any number of ranks."""
        scene = punch()
        contact = condense(scene)
        energies = []
        for cuts, np_ in ((None, 1), (CUTS, 1), (CUTS, 2), ({"upper": (3, 2), "lower": (6, 3)}, 4)):
            profile = self.found(scene, self.shape("nodes"), cuts, np_)
            self.compare(contact, profile)
            energies.append(profile.energy)
        np.testing.assert_allclose(energies, energies[0], rtol=1e-9)

    def test_by_hats(self):
        scene = punch()
        contact = condense(scene)
        phi = hats(contact.x[:, 0], np.linspace(0, 1, 5))
        profile = self.found(scene, self.shape("splines", Pieces=[4, 1], Degree=1), CUTS, 2)
        best, _ = self.compare(contact, profile, phi)
        change = np.linalg.lstsq(phi, profile.gaps - contact.gaps, rcond=None)[0]
        # What it found is a sum of hats, and nearly the oracle's.
        np.testing.assert_allclose(phi @ change, profile.gaps - contact.gaps, atol=1e-15)
        np.testing.assert_allclose(change, best.design, atol=1e-3 * self.UPPER)


class Stiffest(Case):
    """−J is concave along profiles: optima are vertices, and of many of them the program finds one nearby."""

    def test_against_many(self):
        scene, lower, upper = on_plane(2), -0.002, 0.003
        contact = condense(scene)
        design = {"Lower": [lower], "Upper": [upper]}
        shape = {"Design": design, "Constraints": {"Volume": [0.0]}, "Optimiser": TIGHT}
        found = {}
        for quantity in ("softest", "stiffest"):
            found[quantity] = self.found(scene, shape | {"Cost": {"Quantity": quantity}}, {"block": (2, 1)})
        stiff = found["stiffest"]
        self.assertAlmostEqual(stiff.results["cost"] / stiff.energy, -1.0, delta=1e-9)
        self.assertGreater(stiff.energy, found["softest"].energy)
        # Its gaps have the energy that it tells.
        again = pressures(contact, stiff.gaps)
        self.assertAlmostEqual(again.energy / stiff.energy, 1.0, delta=100 * TOLERANCE)
        rng = np.random.default_rng(3)
        weights, energies = contact.areas, []
        for _ in range(300):
            x = rng.uniform(lower, upper, len(weights)) if rng.random() < 0.5 else rng.choice([lower, upper], len(weights))
            for _ in range(60):  # onto the volume, within the bounds
                x = np.clip(x - (weights @ x) / weights.sum(), lower, upper)
            energies.append(pressures(contact, contact.gaps + x).energy)
        flat = pressures(contact).energy
        rows = [(f"{flat:.6e}", f"{np.max(energies):.6e}", f"{stiff.energy:.6e}", f"{found['softest'].energy:.6e}")]
        runs.table("J of stiff designs", ("flat", "best of 300", "stiffest", "softest"), rows)
        self.assertGreater(stiff.energy, flat)
        # A local optimum: above what nearly all have.
        self.assertGreater(np.mean(np.array(energies) <= stiff.energy), 0.9)
        # None near it is better: steps within bounds and volume, as small as the optimiser's last ones are not.
        for _ in range(100):
            x = np.clip(stiff.gaps - contact.gaps + 1e-5 * rng.standard_normal(len(weights)), lower, upper)
            for _ in range(60):
                x = np.clip(x - (weights @ x) / weights.sum(), lower, upper)
            self.assertLessEqual(pressures(contact, contact.gaps + x).energy, stiff.energy + 1e-6 * abs(stiff.energy))


class Moved(Case):
    """The displacement of the upper block's top, along −y: for gaps between 0 and 1e-3."""

    def test_displacement(self):
        scene = stacked(3, stiffer=4.0)
        contact = condense(scene)
        top = {"Quantity": "displacement", "Part": "upper/top", "Direction": [0.0, 1.0, 0.0]}
        design = {"Functions": "splines", "Degree": 1, "Pieces": [1, 1], "Lower": [0.0], "Upper": [1e-3], "Start": [5e-4]}
        shape = {"Design": design, "Cost": top, "Optimiser": TIGHT}
        cuts = {"upper": (2, 1), "lower": (2, 3)}
        mesh_nodes = np.abs(contact_nodes(scene, "upper", 1.5))

        def mean_of(gaps):
            pressed = pressures(contact, gaps)
            u = (contact.at_rest + contact.motions @ pressed.motion).reshape(-1, 2)
            return u[mesh_nodes, 1].mean()

        phi = hats(contact.x[:, 0], np.array([0.2, 1.2]))
        for np_ in (1, 2):
            profile = self.found(scene, shape, cuts, np_)
            before, after = profile.results["cost_before"], profile.results["cost"]
            self.assertAlmostEqual(before / mean_of(contact.gaps + phi @ [5e-4, 5e-4]), 1.0, delta=1e3 * TOLERANCE)
            self.assertAlmostEqual(after / mean_of(profile.gaps), 1.0, delta=1e3 * TOLERANCE)
            # The lower the top is to be, the wider the gaps.
            np.testing.assert_allclose(profile.gaps, 1e-3, rtol=1e-6)
        # The other direction closes them.
        shape = {"Design": design, "Cost": top | {"Direction": [0.0, -1.0, 0.0]}, "Optimiser": TIGHT}
        profile = self.found(scene, shape, cuts)
        np.testing.assert_allclose(profile.gaps, 0.0, atol=1e-9)
        self.assertAlmostEqual(profile.results["cost"] / -mean_of(0.0 * contact.areas), 1.0, delta=1e3 * TOLERANCE)

    def test_first_derivative(self):
        """What the first row of the history tells of the gradient is that of differences."""
        scene = stacked(3, stiffer=4.0)
        contact = condense(scene)
        nodes = contact_nodes(scene, "upper", 1.5)
        phi = hats(contact.x[:, 0], np.array([0.2, 1.2]))

        def mean_of(x):
            pressed = pressures(contact, contact.gaps + phi @ x)
            return (contact.at_rest + contact.motions @ pressed.motion).reshape(-1, 2)[nodes, 1].mean()

        design = {"Functions": "splines", "Degree": 1, "Pieces": [1, 1], "Lower": [-1.0], "Upper": [1.0], "Start": [1e-4]}
        top = {"Quantity": "displacement", "Part": "upper/top", "Direction": [0.0, 1.0, 0.0]}
        profile_path = runs.scratch("deck").with_suffix(".xml")
        tree = deck(scene, {"upper": (2, 1), "lower": (2, 3)}, Shape={"Design": design, "Cost": top}, Solver={"Tolerance": TOLERANCE})
        profile_path.write_text(harmos_decks.xml("shape", tree), encoding="utf-8")
        run = runs.run(profile_path, {"Shape/Limits/Evaluations": 1}, 1, program="shape")
        self.assertEqual(run.returncode, 1, run)
        step, at = 1e-6, np.array([1e-4, 1e-4])
        slope = np.array([(mean_of(at + step * e) - mean_of(at - step * e)) / (2 * step) for e in np.eye(2)])
        # √(Σ d²/weights), where no bound is near.
        norm = np.sqrt((slope**2 / (phi.T @ contact.areas)).sum())
        told = float(table(run, "history.csv")[0]["gradient_norm"])
        # Second differences vanish while the same points are closed; rounding over the step, 1e-16/1e-6 of the length.
        self.assertAlmostEqual(told / norm, 1.0, delta=1e-7)


def contact_nodes(scene, body, height):
    """Of a body's top."""
    from shape_scene import Mesh

    mesh = Mesh(scene.bodies)
    return np.flatnonzero((mesh.body == mesh.number[body]) & (np.abs(mesh.mesh.nodes[:, 1] - height) < 1e-9))


if __name__ == "__main__":
    runs.main()
