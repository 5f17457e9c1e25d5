# SPDX-License-Identifier: BSD-3-Clause
"""Displacements and stresses of both programs, as tables by node and by element."""

import re

# Gauss' points on the line from -1 to 1, with their weights; of ccx, the first direction runs fastest.
LINE = {2: ((-(1 / 3) ** 0.5, 1.0), ((1 / 3) ** 0.5, 1.0)), 3: ((-(0.6**0.5), 5 / 9), (0.0, 8 / 9), (0.6**0.5, 5 / 9))}
CORNERS = ((-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1))
EDGES = tuple(
    tuple((CORNERS[a][d] + CORNERS[b][d]) // 2 for d in range(3))
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
)
WEDGE_15 = [weight / 3 for weight in (5 / 18, 4 / 9, 5 / 18) for _ in range(3)]


def serendipity(place):
    """Of the 20 functions of a hexahedron: (value, gradient)."""
    functions = []
    for node in CORNERS + EDGES:
        factors = [1 - x * x if n == 0 else (1 + n * x) / 2 for n, x in zip(node, place)]
        slopes = [-2 * x if n == 0 else n / 2 for n, x in zip(node, place)]
        is_corner = 0 not in node
        rest = sum(n * x for n, x in zip(node, place)) - 2 if is_corner else 1
        product = factors[0] * factors[1] * factors[2]
        gradient = [
            slopes[d] * factors[(d + 1) % 3] * factors[(d + 2) % 3] * rest + (product * node[d] if is_corner else 0)
            for d in range(3)
        ]
        functions.append((product * rest, gradient))
    return functions


def hexahedron_weights(places, count, is_axisymmetric):
    """Volumes at Gauss' points of a hexahedron of 20 nodes, over their sum. Bodies of revolution: times the radius."""
    import numpy as np

    line = LINE[round(count ** (1 / 3))]
    weights = []
    for z, weight_z in line:
        for y, weight_y in line:
            for x, weight_x in line:
                functions = serendipity((x, y, z))
                frame = sum(np.outer(gradient, place) for (_, gradient), place in zip(functions, places))
                radius = sum(value * place[0] for (value, _), place in zip(functions, places))
                size = abs(np.linalg.det(frame)) * weight_x * weight_y * weight_z
                weights.append(size * (radius if is_axisymmetric else 1.0))
    return [weight / sum(weights) for weight in weights]


def as_hexahedron(places):
    """The 20 nodes of a plane element of eight that has been given a thickness of one."""
    up = [(x, y, z + 1.0) for x, y, z in places]
    middle = [(x, y, z + 0.5) for x, y, z in places[:4]]
    return [*places[:4], *up[:4], *places[4:], *up[4:], *middle]


def weights_of(model, element, count):
    """Of the stresses that ccx prints of an element, for their mean."""
    block, row = model.block_of[element]
    places = [model.nodes[node] for node in block.nodes[row].tolist()]
    if count in (8, 27) and len(places) == 20 or len(places) == 8 and not block.type.startswith("C3D"):
        places = places if len(places) == 20 else as_hexahedron(places)
        return hexahedron_weights(places, count, block.type.startswith("CAX"))
    return WEDGE_15 if count == 9 else [1 / count] * count


def last_tables(text, title):
    """Rows of numbers of all tables with this title, of the last time that is printed."""
    heads = list(re.finditer(title + r" \(.*\) for set .* and time +(\S+)", text))
    result = []
    for head in heads:
        if head.group(1) != heads[-1].group(1):
            continue
        for line in text[head.end() :].splitlines()[1:]:
            if re.match(r"\s*\d+\s+[-+0-9.]", line):
                result.append([float(number) for number in line.split()])
            elif line.strip():
                break
    return result


def last_displacements(text):
    """{node: u} of ccx."""
    return {int(row[0]): row[1:4] for row in last_tables(text, "displacements")}


def last_stresses(text, model):
    """{element: mean stress} of ccx, in Harmos' order: xx, yy, zz, xy, yz, xz. Cells of first order are straight."""
    points = {}
    for element, _, xx, yy, zz, xy, xz, yz in last_tables(text, "stresses"):
        points.setdefault(int(element), []).append((xx, yy, zz, xy, yz, xz))
    means = {}
    for element, stresses in points.items():
        if element in model.block_of:
            weights = weights_of(model, element, len(stresses))
            means[element] = [sum(w * s for w, s in zip(weights, column)) for column in zip(*stresses)]
    return means


class Result:
    """A run of Harmos, at the nodes and in the elements of the model: places tell which they are."""

    def __init__(self, path, conversion):
        import h5py
        import numpy as np

        with h5py.File(path, "r") as file:
            root = file["VTKHDF"]
            points, self.displacement = root["Points"][()], root["PointData/displacement"][()]
            self.cell_stress = root["CellData/cell_stress"][()]
            counts, sizes = root["NumberOfCells"][()], root["NumberOfPoints"][()]
            bodies = root["CellData/body"][()].ravel()
            cells = cells_of(root)
        first = np.cumsum(counts) - counts
        names, extent = list(conversion.deck_bodies), float(np.ptp(points, axis=0).max())

        def key(name, x):
            # Shifted by an odd amount: multiples of simple fractions lie on no border of the boxes.
            return name, tuple(np.floor((np.asarray(x) / extent + 0.2718281828459) * 2**22).astype(int).tolist())

        model, places, middles = conversion.model, {}, {}
        for row, (x, b) in enumerate(zip(points, np.repeat(bodies[first], sizes))):
            places.setdefault(key(names[int(b)], x), []).append(row)
        for row, (nodes, b) in enumerate(zip(cells, bodies)):
            middles[key(names[int(b)], points[nodes].mean(axis=0))] = row
        self.rows = {
            node: places[key(owner.name, model.nodes[node])] for node, owner in conversion.parts.body_of_node.items()
        }
        self.cells = {}
        for element, owner in conversion.parts.body_of_element.items():
            block, row = model.block_of[element]
            middle = np.mean([model.nodes[node] for node in block.nodes[row].tolist()], axis=0)
            self.cells[element] = middles[key(owner.name, middle)]

    def displacements(self):
        """{node: [u]}: of all points at its place in its body, as on both sides of a slit."""
        return {node: self.displacement[rows].tolist() for node, rows in self.rows.items()}

    def stress(self, element):
        return self.cell_stress[self.cells[element]].tolist()


def cells_of(root):
    """Points of each cell, counted through the file."""
    offsets, links = root["Offsets"][()], root["Connectivity"][()]
    cells, begin, link, point = [], 0, 0, 0
    for count, points, ids in zip(
        root["NumberOfCells"][()], root["NumberOfPoints"][()], root["NumberOfConnectivityIds"][()]
    ):
        ends = offsets[begin : begin + count + 1]
        cells += [links[link + a : link + b] + point for a, b in zip(ends[:-1], ends[1:])]
        begin, link, point = begin + count + 1, link + ids, point + points
    return cells


def difference(ours, theirs):
    """Largest difference at a node that both have, over the largest displacement; the node."""
    size = max((abs(x) for u in theirs.values() for x in u), default=0.0)
    worst, where, compared = 0.0, None, 0
    for node, u in theirs.items():
        if node not in ours:
            continue
        compared += 1
        apart = min(max(abs(a - b) for a, b in zip(own, u)) for own in ours[node])
        if apart >= worst:
            worst, where = apart, node
    return (worst / size if size else worst), where, compared


def stress_difference(result, theirs):
    """Largest difference of a component of an element's mean, over the largest component; the element."""
    size = max((abs(x) for s in theirs.values() for x in s), default=0.0)
    apart = {
        element: max(abs(a - b) for a, b in zip(result.stress(element), s))
        for element, s in theirs.items()
    }
    worst = max(apart, key=apart.get, default=None)
    return (apart[worst] / size if size and worst is not None else 0.0), worst, len(apart)
