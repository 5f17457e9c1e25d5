# SPDX-License-Identifier: BSD-3-Clause
"""A square or a cube of two materials whose regions cross the cuts of the subdomains, as a mesh file and a deck.

`count` subdomains a side, of `elements` elements a side each, cut by METIS; moduli 1 and `jump`. The bottom is held, the
top moves by u = (5e-3, -1e-2).

    channels    two thin layers (in space: bundles of bars) through each row of subdomains, along x
    crossing    the same along y too (plane)
    inclusions  squares or cubes, a few in each subdomain and on its cuts
    scattered   two of seven elements, without order
"""

import itertools
from pathlib import Path

import harmos_decks

POISSON = 0.3
PATTERNS = {2: ("channels", "crossing", "inclusions", "scattered"), 3: ("channels", "inclusions", "scattered")}
GMSH = {1: 1, 2: 3, 3: 5}  # lines, quadrilaterals, hexahedra
CORNERS = {1: ((0,), (1,)), 2: ((0, 0), (1, 0), (1, 1), (0, 1))}
CORNERS[3] = tuple((*c, z) for z in (0, 1) for c in CORNERS[2])


class Inclusions:
    def __init__(self, dimension, count, elements, jump, pattern):
        self.dimension, self.count, self.elements, self.jump, self.pattern = dimension, count, elements, jump, pattern

    @property
    def cells(self):
        return self.count * self.elements

    def is_stiff(self, cell):
        """Of the element with these numbers along the axes."""
        n = self.elements
        lanes = (n // 4, 3 * n // 4) if self.dimension == 2 else (n // 4,)
        if self.pattern == "channels":
            return all(x % n in lanes for x in cell[1:])
        if self.pattern == "crossing":
            return cell[1] % n in lanes or cell[0] % n == n // 2
        if self.pattern == "inclusions":
            size = max(2, n // 3)
            return all((x + size // 2) % size < size // 2 for x in cell)
        i, j, k = (*cell, 0)[:3]
        return ((i * 2654435761 + j * 40503 + k * 69069) ^ (i * j)) % 7 < 2

    def mesh(self):
        """Gmsh's format 2.2."""
        d, m = self.dimension, self.cells
        number = lambda node: 1 + sum(x * (m + 1) ** axis for axis, x in enumerate(node))
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "4"]
        lines += [f'{d - 1} 1 "bottom"', f'{d - 1} 2 "top"', f'{d} 10 "soft"', f'{d} 11 "stiff"', "$EndPhysicalNames"]
        lines += ["$Nodes", str((m + 1) ** d)]
        for node in itertools.product(range(m + 1), repeat=d):
            node = node[::-1]
            place = [*(x / self.elements for x in node), *[0.0] * (3 - d)]
            lines.append(f"{number(node)} " + " ".join(map(repr, place)))
        found = []
        for facet in itertools.product(range(m), repeat=d - 1):
            for group, height in ((1, 0), (2, m)):
                corners = [(*(x + c for x, c in zip(facet, corner)), height) for corner in CORNERS[d - 1]]
                found.append((GMSH[d - 1], group, corners))
        for cell in itertools.product(range(m), repeat=d):
            corners = [tuple(x + c for x, c in zip(cell, corner)) for corner in CORNERS[d]]
            found.append((GMSH[d], 11 if self.is_stiff(cell) else 10, corners))
        lines += ["$EndNodes", "$Elements", str(len(found))]
        for place, (kind, group, corners) in enumerate(found):
            lines.append(f"{place + 1} {kind} 2 {group} {group} " + " ".join(str(number(c)) for c in corners))
        return "\n".join([*lines, "$EndElements", ""])

    @property
    def top_displacement(self):
        return [5e-3, *[0.0] * (self.dimension - 2), -1e-2]

    def write(self, directory):
        """@return the path of the deck."""
        directory = Path(directory)
        directory.mkdir(parents=True, exist_ok=True)
        (directory / "inclusions.msh").write_text(self.mesh(), encoding="utf-8")
        axes = list("xyz"[: self.dimension])
        material = lambda modulus: {"Young's modulus": float(modulus), "Poisson's ratio": POISSON}
        deck = {
            "Model": {"Physics": "solid" if self.dimension == 3 else "plane strain", "Mesh file": "inclusions.msh"},
            "Materials": {"soft": material(1.0), "stiff": material(self.jump)},
            "Bodies": {
                "block": {
                    "Groups": ["soft", "stiff"],
                    "Subdomains": self.count**self.dimension,
                    "Materials": ["soft", "stiff"],
                }
            },
            "Effects": {
                "Prescribed displacement": {
                    "floor": {"Part": "block/bottom", "Components": axes},
                    "top": {
                        "Part": "block/top",
                        "Components": axes,
                        "Displacement": [*self.top_displacement, *[0.0] * (3 - self.dimension)],
                    },
                }
            },
        }
        path = directory / "inclusions.xml"
        path.write_text(harmos_decks.xml("harmos", deck), encoding="utf-8")
        return path
