# SPDX-License-Identifier: BSD-3-Clause
"""A disc between two plates, without friction: decks and meshes, and what their answers have to be.

Nothing holds the upper plate sideways, nor the disc, but what rounding and the polygon make of normals. Pressed straight
down forces are right, and whoever drifts is told; pushed sideways nothing holds the plate, and the plate is told.
"""

import math
import random

RADIUS, PRESSURE, WIDTH = 1.0, 1.0, 1.5


class Rollers:
    """One of them."""

    def __init__(self, seed):
        pick = random.Random(seed).choice
        self.sectors = pick([24, 32, 33, 48, 64])
        self.rings = pick([4, 6, 8])
        self.angle = pick([0.0, 0.0, 0.3, 0.5]) * 2.0 * math.pi / self.sectors
        self.isRollerFirst = pick([True, True, False])
        self.push = pick([0.0, 0.0, 0.0, 1e-2, 1e-4])
        self.isHeld = pick([True, False])
        self.subdomains = pick([1, 2, 3])
        self.coupling = pick(["automatic", "mortar"])
        self.thickness = pick([0.5, 1.0])
        self.young = pick([1e2, 1e4])
        self.size = 2.0 * RADIUS + 2.0 * self.thickness
        self.areas = dict.fromkeys(("Contact/below", "Contact/above"), WIDTH)
        self.words = [
            f"{self.sectors} sectors, {self.rings} rings, turned {self.angle:.3f}, roller first {self.isRollerFirst}, "
            f"push {self.push}, held {self.isHeld}, {self.subdomains} parts, {self.coupling}, E {self.young}"
        ]

    def write_mesh(self, path):
        nodes, cells = [(0.0, 0.0)], []
        for ring in range(1, self.rings + 1):
            radius = RADIUS * ring / self.rings
            for k in range(self.sectors):
                phi = self.angle + 2.0 * math.pi * k / self.sectors
                nodes.append((radius * math.cos(phi), radius * math.sin(phi)))

        def number(ring, k):
            return 1 if ring == 0 else 2 + (ring - 1) * self.sectors + k % self.sectors

        for k in range(self.sectors):
            cells.append((number(0, 0), number(1, k), number(1, k + 1)))
            for ring in range(1, self.rings):
                a, b = number(ring, k), number(ring, k + 1)
                c, d = number(ring + 1, k), number(ring + 1, k + 1)
                cells += [(a, c, d), (a, d, b)]
        sides = [(number(self.rings, k), number(self.rings, k + 1)) for k in range(self.sectors)]
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '2 1 "roll"', '1 2 "round"']
        lines += ["$EndPhysicalNames", "$Nodes", str(len(nodes))]
        lines += [f"{k + 1} {x!r} {y!r} 0.0" for k, (x, y) in enumerate(nodes)]
        lines += ["$EndNodes", "$Elements", str(len(cells) + len(sides))]
        rows = [(2, 1, cell) for cell in cells] + [(1, 2, side) for side in sides]
        lines += [f"{k + 1} {kind} 2 {tag} {tag} " + " ".join(map(str, row)) for k, (kind, tag, row) in enumerate(rows)]
        path.write_text("\n".join([*lines, "$EndElements", ""]), encoding="utf-8")

    def plate(self, level):
        return {
            "Source": "block", "Origin": [-WIDTH / 2.0, level, 0.0], "Size": [WIDTH, self.thickness, 1.0],
            "Subdomains a side": [self.subdomains, 1, 1], "Elements a side": [12 // self.subdomains, 4, 1],
            "Materials": ["m"],
        }

    def force(self, name):
        """Upward per area, of the second body on the first."""
        return PRESSURE if (name == "Contact/below") == self.isRollerFirst else -PRESSURE

    def tree(self):
        def pair(side):
            names = ["roll/round", side]
            if not self.isRollerFirst:
                names.reverse()
            return {"First": names[0], "Second": names[1], "Coupling": self.coupling, "Reach": 0.5}

        held = {"ground": {"Part": "low/bottom"}}
        if self.isHeld:
            held["guide"] = {"Part": "up/top", "Components": ["x"]}
        density = [self.push, -PRESSURE, 0.0]
        return {
            "Model": {"Physics": "plane strain", "Mesh file": "roll.msh"},
            "Materials": {"m": {"Young's modulus": self.young, "Poisson's ratio": 0.3}},
            "Bodies": {
                "roll": {"Subdomains": self.subdomains, "Materials": ["m"]},
                "low": self.plate(-RADIUS - self.thickness), "up": self.plate(RADIUS),
            },
            "Effects": {
                "Contact": {"below": pair("low/top"), "above": pair("up/bottom")},
                "Traction": {"press": {"Part": "up/top", "Density": density}},
                "Prescribed displacement": held,
            },
        }
