# SPDX-License-Identifier: BSD-3-Clause
"""A body with a slit under uniform compression: decks and meshes, and what their answers have to be.

The lips share the nodes at the tip of the slit, in space at its whole front, or the slit comes out at a side. Closed by
contact, with or without friction, or glued by a tie, it must not show. Nodes of the upper lip may be moved along it, so
that the lips do not match.
"""

import itertools
import random

from pressed_blocks import POISSON, PRESSURE, YOUNG, Blocks

# Gmsh's numbers of types: cells and sides by dimension, order, and whether they are simplices.
TYPES = {
    (2, 1, True): (2, 1), (2, 2, True): (9, 8), (2, 1, False): (3, 1), (2, 2, False): (10, 8),
    (3, 1, True): (4, 2), (3, 2, True): (11, 9), (3, 1, False): (5, 3),
}
# Nodes of cells on a lattice of halves of a cell, in Gmsh's order.
QUADRILATERAL = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)]
EDGES = {3: [(0, 1), (1, 2), (2, 0)], 4: [(0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1)]}


def middle(a, b):
    return tuple((x + y) // 2 for x, y in zip(a, b))


class Slits:
    """One of them."""

    displacement = Blocks.displacement

    def __init__(self, seed):
        pick = random.Random(seed).choice
        self.dimension = pick([2, 2, 3])
        self.up = self.dimension - 1
        self.order, self.isSimplex = pick([key[1:] for key in TYPES if key[0] == self.dimension])
        self.cells = pick([4, 8]) if self.dimension == 2 else 4
        half = self.cells // 2
        ends = [(0, half), (1, self.cells - 1), (half, self.cells)]
        self.slit = [tuple(2 * end for end in pick(ends))]  # on the lattice, in x and y
        if self.dimension == 3:
            across = [(0, 2 * self.cells), (2, 2 * self.cells - 2), (0, self.cells)]
            # At corners of a slit triangles have all corners at its rim, and edges of second order inside: sides are
            # told apart by their corners.
            self.slit.append(pick(across[: 1 if self.order == 2 else None]))
        self.shift = pick([0.0, 0.0, 0.2]) if self.order == 1 else 0.0
        self.kind = pick(["Contact", "Contact", "Friction", "Tie"])
        self.coupling = pick(["automatic", "mortar"] + (["nodes"] if self.shift == 0.0 else []))
        self.isUpperFirst = pick([True, False])
        self.subdomains = pick([1, 2, 3])
        # Node to node the forces at the tips are the body's own.
        self.areas = {}
        self.hasPressure = self.kind != "Tie"
        self.words = [
            f"{self.dimension}D order {self.order} {'simplices' if self.isSimplex else 'tensor cells'}, {self.cells} cells, "
            f"slit {self.slit}, shift {self.shift}, {self.kind} {self.coupling}, upper first {self.isUpperFirst}, "
            f"{self.subdomains} parts"
        ]

    def force(self, _):
        return PRESSURE if self.isUpperFirst else -PRESSURE

    # The mesh.

    def isInside(self, x):
        """Of the slit, not at its rim inside of the body: there are two nodes."""
        size = 2 * self.cells
        return x[self.up] == self.cells and all(
            (low < v or low == 0 == v) and (v < high or v == high == size) for v, (low, high) in zip(x, self.slit)
        )

    def cell_nodes(self):
        """Lattice points of each cell, of first order corners alone."""
        d = self.dimension
        for index in itertools.product(range(self.cells), repeat=d):
            base = tuple(2 * i for i in index)
            if not self.isSimplex:
                shape = QUADRILATERAL if self.order == 2 else QUADRILATERAL[:4]
                if d == 3:
                    shape = [(*p, z) for z in (0, 2) for p in QUADRILATERAL[:4]]
                yield [tuple(b + s for b, s in zip(base, step)) for step in shape]
                continue
            for axes in itertools.permutations(range(d)):  # Kuhn's
                corners = [base]
                for axis in axes:
                    corners.append(tuple(v + (2 if k == axis else 0) for k, v in enumerate(corners[-1])))
                if sum(1 for a, b in itertools.combinations(axes, 2) if a > b) % 2:
                    corners[-1], corners[-2] = corners[-2], corners[-1]
                edges = EDGES[d + 1] if self.order == 2 else []
                yield corners + [middle(corners[a], corners[b]) for a, b in edges]

    def sides_on_slit(self, nodes, upper):
        """Sides of a cell on the slit, as lists of its nodes, once each."""
        d = self.dimension
        corners = nodes[: d + 1] if self.isSimplex else nodes[: 2**d]
        level = [x for x in corners if x[self.up] == self.cells]
        if len(level) != (d if self.isSimplex else 2 ** (d - 1)):
            return None
        centre = [sum(x[k] for x in level) / len(level) for k in range(d - 1)]
        if not all(low < c < high for c, (low, high) in zip(centre, self.slit)):
            return None
        side = level
        if d == 3 and not self.isSimplex:
            side = [level[k] for k in (0, 1, 2, 3)]
        if self.order == 2:
            side = side + [middle(a, b) for a, b in ([side] if d == 2 else [(side[i], side[j]) for i, j in EDGES[3]])]
        # A side all of whose nodes are at the tip is no side of the slit: the body hangs together there.
        return side if any(map(self.isInside, side)) else None

    def area(self, side):
        corners = side[:2] if self.dimension == 2 else side[: 3 if self.isSimplex else 4]
        x, y = ([corner[k] for corner in corners] for k in (0, 1))
        if self.dimension == 2:
            return abs(x[1] - x[0]) / (2 * self.cells)
        around = sum(x[k - 1] * y[k] - x[k] * y[k - 1] for k in range(len(corners)))
        return abs(around) / 2 / (2 * self.cells) ** 2

    def write_mesh(self, path):
        numbers, cells, lips, area = {}, [], {"low": [], "up": []}, 0.0

        def number(x, upper):
            return numbers.setdefault((x, upper and self.isInside(x)), len(numbers) + 1)

        for nodes in self.cell_nodes():
            upper = sum(x[self.up] for x in nodes) > self.cells * len(nodes)
            cells.append([number(x, upper) for x in nodes])
            if side := self.sides_on_slit(nodes, upper):
                lips["up" if upper else "low"].append([number(x, upper) for x in side])
                area += 0.0 if upper else self.area(side)
        if self.coupling != "nodes":
            self.areas["Tie/lips" if self.kind == "Tie" else "Contact/lips"] = area
        types = TYPES[self.dimension, self.order, self.isSimplex]
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "3", f'{self.dimension} 1 "body"']
        lines += [f'{self.dimension - 1} {11 + k} "{name}"' for k, name in enumerate(lips)]
        lines += ["$EndPhysicalNames", "$Nodes", str(len(numbers))]
        for (x, isCopy), k in numbers.items():
            place = [v / (2 * self.cells) for v in x] + [0.0] * (3 - self.dimension)
            if isCopy and 0 < x[0] < 2 * self.cells:
                place[0] += self.shift / self.cells
            lines.append(f"{k} " + " ".join(map(repr, map(float, place))))
        lines += ["$EndNodes", "$Elements", str(len(cells) + sum(map(len, lips.values())))]
        rows = [(types[0], 1, cell) for cell in cells]
        rows += [(types[1], 11 + k, side) for k, sides in enumerate(lips.values()) for side in sides]
        lines += [f"{k + 1} {kind} 2 {tag} {tag} " + " ".join(map(str, nodes)) for k, (kind, tag, nodes) in enumerate(rows)]
        path.write_text("\n".join([*lines, "$EndElements", ""]), encoding="utf-8")

    def tree(self):
        axes = ["x", "y", "z"][: self.dimension]
        planes = {f"{axis} {end}": (k, end) for k, axis in enumerate(axes) for end in (0.0, 1.0)}
        parts = {}
        for name, (k, end) in planes.items():
            normal = [0.0] * 3
            normal[k] = 1.0
            parts[name] = {"Plane point": [end * n for n in normal], "Plane normal": normal}
        names = ["body/up", "body/low"] if self.isUpperFirst else ["body/low", "body/up"]
        pair = {"First": names[0], "Second": names[1], "Coupling": self.coupling}
        effects = {"Tie" if self.kind == "Tie" else "Contact": {"lips": pair}}
        if self.kind == "Friction":
            effects["Friction"] = {"lips": {"Contact": "lips", "Coefficient": 0.5}}
        effects["Traction"] = {"press": {"Part": f"body/{axes[-1]} 1.0", "Pressure": PRESSURE}}
        effects["Prescribed displacement"] = {axis: {"Part": f"body/{axis} 0.0", "Components": [axis]} for axis in axes}
        return {
            "Model": {"Physics": "plane strain" if self.dimension == 2 else "solid", "Mesh file": "slit.msh"},
            "Materials": {"m": {"Young's modulus": YOUNG, "Poisson's ratio": POISSON}},
            "Bodies": {"body": {"Subdomains": self.subdomains, "Materials": ["m"]}},
            "Boundary parts": parts,
            "Effects": effects,
            "Solver": {"Tolerance": 1e-10},
        }
