# SPDX-License-Identifier: BSD-3-Clause
"""The fibre composite against an undecomposed solve, against bounds, and against itself.

    test_composite.py [-v] [CLASS]...

What each class guards against:

    Sample      another size or another cost than the default deck promises
    Oracle      the solution of another problem: every interface and load against the energy of an
                undecomposed primal-dual active set solve that shares no code with the library
    Ranks       an answer that depends on the number of ranks or on how bodies are cut
    Conditioning  a method that loses itself in rounding errors: products that multiply, or none
                that suffice, where matrices are ill-conditioned
    Stiffness   contact that glues, ties that slip: inequalities between effective stiffnesses, and
                the bounds of Hashin and Shtrikman
    Adhesive    springs that are not those of the deck: stiff ones against ties, broken ones against
                contact, and what lies between
"""

import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parent / "oracles"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py  # noqa: F401
    import elastic_oracle
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

MATERIALS = ((1.0, 0.3), (10.0, 0.3))  # of matrix and fibre in the default deck
STRAIN = 0.01


def solved(case, sets=None, np=runs.RANKS, **more):
    return runs.solved(case, runs.COMPOSITE, sets, np, program="fiber_composite", **more)


class Sample(unittest.TestCase):
    def test_default_deck(self):
        """The paper: 6176/990, 591 CG steps, 4 outer iterations."""
        summary = solved(self).summary
        self.assertGreaterEqual(summary["primal_dimension"], 5500)
        self.assertLessEqual(summary["primal_dimension"], 7000)
        self.assertEqual(summary["inequalities"], 16 * 20)
        self.assertEqual(summary["subdomains"], 32)
        # Each fibre moves in three ways, of which one, its rotation, nothing holds.
        self.assertEqual(summary["kernel_dimension"] - summary["coarse_dimension"], 16)
        # 57 measured, 52 on four ranks; twice of that would be another method. 591 is what is asked.
        self.assertGreaterEqual(summary["hessian_applications"], 25)
        self.assertLessEqual(summary["hessian_applications"], 115)

    def test_cells_without_scatter_share_their_factors(self):
        summary = solved(self, {"Model/Columns": 8, "Model/Rows": 8, "Output/Fields": False}).summary
        self.assertLessEqual(summary["distinct_local_factorizations"], 8)


class Oracle(unittest.TestCase):
    def check(self, interface, load, sets=None):
        run = solved(
            self,
            {
                "Model/Interface": interface,
                "Model/Load": load,
                "Solver/Tolerance": 1e-8,
                **(sets or {}),
            },
        )
        strain = -STRAIN if load == "compression" else STRAIN
        energy = elastic_oracle.composite_energy(
            run.directory / "result.vtkhdf", strain, MATERIALS, interface
        )
        # Errors of the energy are of the second order in those of the solution at the solver's
        # tolerance; what is asked is 1e-6.
        self.assertLessEqual(abs(run.summary["energy"] / energy - 1.0), 1e-6, (interface, load))

    def test_contact(self):
        for load in ("stretch", "compression"):
            self.check("contact", load)

    def test_linear(self):
        for interface in ("tie", "holes", "homogeneous"):
            self.check(interface, "stretch")

    def test_scattered_fibres(self):
        scatter = {"Model/Radius scatter": 0.1, "Model/Offset scatter": 0.05, "Model/Seed": 7}
        for load in ("stretch", "compression"):
            self.check("contact", load, scatter)

    def test_nearly_incompressible_matrix(self):
        """With projected dilatation, cell by cell onto constants; the oracle projects in all bodies."""
        run = solved(self, {"Materials/Matrix/Poisson's ratio": 0.4999, "Model/Expert/Dilatation": "projected",
                            "Solver/Tolerance": 1e-8})
        energy = elastic_oracle.composite_energy(
            run.directory / "result.vtkhdf", STRAIN, ((1.0, 0.4999), MATERIALS[1]), "contact",
            dilatation="projected")
        self.assertLessEqual(abs(run.summary["energy"] / energy - 1.0), 1e-6)

    def test_biquadratic_elements(self):
        self.check("contact", "compression", {"Model/Element order": 2, "Model/Columns": 2, "Model/Rows": 2})


class Ranks(unittest.TestCase):
    def test_energy(self):
        """At 1e-4 to 1e-6, on 1, 2 and 4 ranks, and with bodies cut further by METIS."""
        for load in ("stretch", "compression"):
            energies = [solved(self, {"Model/Load": load}, np).summary["energy"] for np in (1, 2, 4)]
            for energy in energies[1:]:
                self.assertLessEqual(abs(energy / energies[0] - 1.0), 1e-6)
        pieces = {"Model/Expert/Subdomains per fibre": 2, "Model/Expert/Subdomains per matrix cell": 3}
        cut = solved(self, {**pieces, "Solver/Tolerance": 1e-8}, 4).summary
        whole = solved(self, {"Solver/Tolerance": 1e-8}).summary
        self.assertEqual(cut["subdomains"], 16 * 5)
        self.assertLessEqual(abs(cut["energy"] / whole["energy"] - 1.0), 1e-7)


class Conditioning(unittest.TestCase):
    def test_nearly_incompressible_second_order(self):
        """Thin subdomains of second order: 542 steps with short recurrences, for 616 multipliers."""
        sets = {
            "Model/Columns": 3,
            "Model/Rows": 1,
            "Model/Elements per side": 3,
            "Model/Expert/Fibre layers": 1,
            "Model/Expert/Matrix layers": 3,
            "Model/Element order": 2,
            "Model/Load": "compression",
            "Model/Expert/Subdomains per fibre": 2,
            "Model/Expert/Subdomains per matrix cell": 5,
            "Materials/Matrix/Poisson's ratio": 0.4999,
            "Output/Fields": False,
        }
        # Of which adaptive vectors would take most.
        short = {"Solver/Expert/PCPG/Reorthogonalisation": "none", "Dual operator/Expert/Adaptive coarse vectors": "none"}
        tied = solved(self, {**sets, "Model/Interface": "tie"}).summary
        # 89 measured.
        self.assertLessEqual(tied["hessian_applications"], 180)
        slow = solved(self, {**sets, "Model/Interface": "tie", **short}).summary
        self.assertGreaterEqual(slow["hessian_applications"], 3 * tied["hessian_applications"])
        # Both to a relative 1e-4 in the gradient, which enters squared.
        self.assertLess(abs(tied["energy"] / slow["energy"] - 1), 1e-4)
        # 1483 measured: many active sets are tried.
        contact = solved(self, {**sets, "Model/Interface": "contact"}).summary
        self.assertLessEqual(contact["hessian_applications"], 3000)


class Stiffness(unittest.TestCase):
    def modulus(self, **model):
        sets = {f"Model/{name.replace('_', ' ')}": value for name, value in model.items()}
        summary = solved(self, {**sets, "Output/Fields": False, "Solver/Tolerance": 1e-6}).summary
        return summary["results"]

    def test_order(self):
        stretch = self.modulus(Load="stretch")["effective_modulus"]
        compression = self.modulus(Load="compression")["effective_modulus"]
        tie = self.modulus(Interface="tie")["effective_modulus"]
        holes = self.modulus(Interface="holes")["effective_modulus"]
        print(f"effective moduli: holes {holes:.4f}, stretch {stretch:.4f}, "
              f"compression {compression:.4f}, tie {tie:.4f}")
        # Ten times the solver's tolerance apart at least.
        apart = 1 + 1e-5
        self.assertLess(apart * holes, stretch)
        self.assertLess(apart * stretch, compression)
        self.assertLess(apart * compression, tie)

    def test_contact_opens(self):
        stretch = self.modulus(Load="stretch")["closed_fraction"]
        compression = self.modulus(Load="compression")["closed_fraction"]
        self.assertLess(stretch, compression)
        self.assertLess(compression, 1.0)

    def test_hashin_shtrikman(self):
        """Plane-strain bulk modulus of the tied sample, from biaxial stretching of a square array.

        The bounds on it need no isotropy of the array (Hashin: Analysis of composite materials,
        J. Appl. Mech. 50, 1983, equations 3.2). Polygons for circles and elements that are too
        stiff both shift it by less than the distance to the bounds allows: the mesh is fine.
        """
        for fraction in (0.05, 0.1):
            # A body of area V under equal strains e: energy = 2 k e^2 V, and the application
            # reports 2 energy / (e^2 V).
            k = 0.25 * self.modulus(
                Interface="tie", Load="biaxial", Volume_fraction=fraction, Columns=1, Rows=1,
                Elements_per_side=20, Fibre_layers=10, Matrix_layers=30,
            )["effective_modulus"]
            (em, nm), (ef, nf) = MATERIALS
            gm, gf = em / (2 * (1 + nm)), ef / (2 * (1 + nf))
            km, kf = gm / (1 - 2 * nm), gf / (1 - 2 * nf)
            around = 80  # sides of the polygon that stands for the circle
            v = fraction * math.sin(2 * math.pi / around) / (2 * math.pi / around)
            lower = km + v / (1 / (kf - km) + (1 - v) / (km + gm))
            upper = kf + (1 - v) / (1 / (km - kf) + v / (kf + gf))
            print(f"volume fraction {v:.4f}: {lower:.6f} <= {k:.6f} <= {upper:.6f}")
            self.assertLessEqual(lower, k)
            self.assertLessEqual(k, upper)


class Adhesive(unittest.TestCase):
    TOLERANCE = 1e-6  # of the solver; energies, of which moduli are made, are known to its square
    STIFFNESSES = (1e-4, 1e-2, 1.0, 1e1, 1e2, 1e3, 1e4, 1e5)  # in moduli of the matrix a cell
    NEVER = 1e3  # a strength
    RADIUS = math.sqrt(0.4 / math.pi)

    def solve(self, load, interface, sets=None):
        own = {"Model/Load": load, "Model/Interface": interface, "Output/Fields": False}
        return solved(self, {**own, "Solver/Tolerance": self.TOLERANCE, **(sets or {})}).summary

    def modulus(self, load, interface, sets=None):
        return self.solve(load, interface, sets)["results"]["effective_modulus"]

    def glue(self, stiffness, strength):
        """Brittle: linear up to the strength."""
        law = "Model/Adhesion/"
        ways = ("Normal", "Tangential")
        return {
            f"{law}Law": "brittle",
            **{f"{law}{way} stiffness": stiffness for way in ways},
            **{f"{law}{way} strength": strength for way in ways},
        }

    def test_whole(self):
        """From contact to ties: monotone, and the last with 1/k.

        What is missing to the tied modulus is c/k (1 - a/k + ...) for springs stiff beside bodies; a is how
        stiff the matrix is about a fibre, E/r times what shape and neighbours make of it, three at most. A
        line through the logarithms at four decades of k, of which only the first sees a, has its slope
        changed by 3/10 of log10(1 - a/k) there.
        """
        for load in ("stretch", "compression"):
            moduli = [self.modulus(load, "adhesive", self.glue(k, self.NEVER)) for k in self.STIFFNESSES]
            contact, tie = self.modulus(load, "contact"), self.modulus(load, "tie")
            apart = 1 + 10 * self.TOLERANCE
            for softer, stiffer in zip((contact, *moduli), (*moduli, tie)):
                self.assertLess(apart * softer, stiffer, load)
            missing = [(math.log10(k), math.log10(tie - e)) for k, e in zip(self.STIFFNESSES, moduli) if k >= 1e2]
            self.assertEqual(len(missing), 4)
            middle = sum(x for x, _ in missing) / 4
            rate = sum((x - middle) * y for x, y in missing) / sum((x - middle) ** 2 for x, _ in missing)
            print(f"{load}: contact {contact:.6f}, springs {' '.join(f'{e:.6f}' for e in moduli)}, tie {tie:.6f}, "
                  f"rate {rate:.4f}")
            a = 3 / self.RADIUS
            self.assertLess(abs(rate + 1), -0.3 * math.log10(1 - a / 1e2), load)

    def test_broken(self):
        """Pulled and pressed until all is broken: the modulus falls from that of springs to that of contact."""
        times = {"stretch": "{0.02,0.05,0.1,1}", "compression": "{0.05,0.08,0.2,1}"}
        strain = 0.1
        for load in ("stretch", "compression"):
            intact = self.modulus(load, "adhesive", self.glue(1e2, self.NEVER))
            path = {"Model/Strain": strain, "Steps/Times": times[load]}
            summary = self.solve(load, "adhesive", self.glue(1e2, 1e-2) | path)
            steps = summary["steps"]
            moduli = []
            for step in steps:
                stretch = step["time"] * strain
                moduli.append(2.0 * step["energy"] / (stretch**2 * 16))
                force = abs(step["Prescribed displacement/right/fx"])
                self.assertAlmostEqual(force / (4 * stretch * moduli[-1]), 1.0, delta=10 * self.TOLERANCE)
            print(f"{load}: moduli {' '.join(f'{e:.6f}' for e in moduli)}, broken "
                  f"{' '.join(str(step['broken']) for step in steps)}")
            self.assertEqual(steps[0]["broken"], 0)
            self.assertEqual(steps[-1]["broken"], summary["inequalities"])
            self.assertGreaterEqual(len({step["broken"] for step in steps}), 4, "nothing in between")
            near = 10 * self.TOLERANCE
            self.assertAlmostEqual(moduli[0] / intact, 1.0, delta=near)
            self.assertAlmostEqual(moduli[-1] / self.modulus(load, "contact"), 1.0, delta=near)
            for before, after, left, right in zip(steps, steps[1:], moduli, moduli[1:]):
                self.assertLessEqual(right, left * (1 + near))
                self.assertLessEqual(before["broken"], after["broken"])
                if before["broken"] < after["broken"]:
                    self.assertLess(right, left)


if __name__ == "__main__":
    runs.main()
