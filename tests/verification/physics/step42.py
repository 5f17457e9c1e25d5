# SPDX-License-Identifier: BSD-3-Clause
"""The scene of deal.II's tutorial step-42 (Frohne, Heister, Bangerth: Int. J. Numer. Meth. Engng. 105, 2016): a rigid ball,
pressed 0.01 deep into a cube of metal that its mould keeps in shape.

The tutorial has total strains: |s| = (γ + (1 − γ)σ₀/(2μ|e|)) 2μ|e|. In one step from rest that is linear hardening with
σ_y = σ₀√(3/2), H = 3μγ/(1 − γ). Its cells have no B-bar, and its ball keeps nodes out along z, at the places where they
are at rest.
"""

YOUNG, POISSON, SIGMA, GAMMA = 200000.0, 0.3, 400.0, 0.01
RADIUS, DEPTH = 0.6, 0.01
PUBLISHED = {8: 37.3058}  # contact force of 8³ cells, from the tutorial's page of results
# Of Debian's deal.II 9.4.1 on a cube of 16³ cells, whose nine nodes in contact are the 3 × 3 in the middle.
MEASURED = {16: 62.3128}


def metal(hardening=None):
    """@param hardening H, of the tutorial if None; False: elastic."""
    shear = YOUNG / (2.0 * (1.0 + POISSON))
    flow = {
        "Yield stress": SIGMA * 1.5**0.5,
        "Isotropic hardening": 3.0 * shear * GAMMA / (1.0 - GAMMA) if hardening is None else hardening,
    }
    elastic = {"Young's modulus": YOUNG, "Poisson's ratio": POISSON}
    return elastic if hardening is False else {**elastic, "Plasticity": flow}


def scene(cells, parts, hardening=None, dilatation="full", tolerance=1e-6, radius=RADIUS, depth=DEPTH):
    """Of cells³ cells in parts³ subdomains, as nested dictionaries of a deck."""
    sides = {
        side: {"Part": f"cube/{side}", "Components": ["x", "y"]} for side in ("left", "right", "front", "back")
    }
    return {
        "Model": {"Physics": "solid"},
        "Materials": {"metal": metal(hardening)},
        "Bodies": {"cube": {
            "Source": "block", "Size": [1.0, 1.0, 1.0], "Subdomains a side": [parts] * 3,
            "Elements a side": [cells // parts] * 3, "Element": "Q1", "Materials": ["metal"],
            "Expert": {"Dilatation": dilatation},
        }},
        "Solver": {"Tolerance": tolerance},
        "Effects": {
            "Obstacle": {"ball": {
                "Part": "cube/top", "Shape": "sphere", "Point": [0.5, 0.5, 1.0 + radius - depth], "Radius": radius,
            }},
            "Prescribed displacement": {"bottom": {"Part": "cube/bottom"}, **sides},
        },
    }


def with_nodes_in_contact(cells, parts, directory, reach=1):
    """The same, with the (2 reach + 1)² nodes in the middle of the upper side moved along z to where the tutorial's ball
    is: a mesh file has them as parts.
    """
    middle, size = cells // 2, 1.0 / cells
    nodes = [(i, j) for i in range(middle - reach, middle + reach + 1) for j in range(middle - reach, middle + reach + 1)]
    tree = scene(cells, 1)
    held = tree["Effects"]["Prescribed displacement"] = {"bottom": {"Part": "cube/bottom"}}
    for side in ("sides_x", "sides_y"):
        held[side] = {"Part": f"cube/{side}", "Components": ["x", "y"]}
    for i, j in nodes:
        x, y = i * size - 0.5, j * size - 0.5
        way = RADIUS - DEPTH - (RADIUS**2 - x * x - y * y) ** 0.5
        held[f"node_{i}_{j}"] = {
            "Part": f"cube/node_{i}_{j}", "Components": ["z"], "Displacement": [0.0, 0.0, way],
        }
    del tree["Effects"]["Obstacle"]
    tree["Model"]["Mesh file"] = str(write_cube(directory / "cube.msh", cells, nodes))
    tree["Bodies"]["cube"] = {
        "Materials": ["metal"], "Subdomains": parts, "Expert": {"Dilatation": "full"},
    }
    return tree


def write_cube(path, cells, nodes):
    """A file of Gmsh, version 2.2. @param nodes of the upper side that are parts."""

    def number(i, j, k):
        return 1 + i + (cells + 1) * (j + (cells + 1) * k)

    def quadrangle(corner, u, v):
        ways = ((0, 0), (1, 0), (1, 1), (0, 1))
        return [number(*(c + a * p + b * q for c, p, q in zip(corner, u, v))) for a, b in ways]

    x, y, z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    groups = [(3, 1, "cube"), (2, 2, "bottom"), (2, 3, "sides_x"), (2, 4, "sides_y")]
    groups += [(0, 5 + at, f"node_{i}_{j}") for at, (i, j) in enumerate(nodes)]
    elements = [(15, 5 + at, [number(i, j, cells)]) for at, (i, j) in enumerate(nodes)]
    line = range(cells)
    for a in line:
        for b in line:
            elements.append((3, 2, quadrangle((a, b, 0), y, x)))
            for side in (0, cells):
                elements.append((3, 3, quadrangle((side, a, b), y, z)))
                elements.append((3, 4, quadrangle((a, side, b), x, z)))
    for k in line:
        for j in line:
            for i in line:
                elements.append((5, 1, quadrangle((i, j, k), x, y) + quadrangle((i, j, k + 1), x, y)))
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(groups)}\n")
        file.writelines(f'{dimension} {group} "{name}"\n' for dimension, group, name in groups)
        file.write(f"$EndPhysicalNames\n$Nodes\n{(cells + 1) ** 3}\n")
        every = range(cells + 1)
        file.writelines(
            f"{number(i, j, k)} {i / cells!r} {j / cells!r} {k / cells!r}\n" for k in every for j in every for i in every
        )
        file.write(f"$EndNodes\n$Elements\n{len(elements)}\n")
        file.writelines(
            f"{at + 1} {kind} 2 {group} {group} {' '.join(map(str, corners))}\n"
            for at, (kind, group, corners) in enumerate(elements)
        )
        file.write("$EndElements\n")
    return path
