# SPDX-License-Identifier: BSD-3-Clause
"""Bolts under pretension: cut, and the sides held together but for a shift along the bolt."""

from dataclasses import dataclass

import numpy as np


@dataclass
class Cut:
    """A cut through a bolt."""

    normal: np.ndarray  # of length one, away from the elements whose faces it is
    sign: float  # -1: the model gives the opposite direction
    pairs: list  # (node of these elements, node of the other side)

    def equations(self, dimension, shift):
        """(terms, value) of its rows: no jump across the bolt, and along it the shift, or the same everywhere (None).

        Terms are (node, component, coefficient).
        """
        frame = np.linalg.svd(self.normal[None, :dimension])[2]
        for k, direction in enumerate(frame):
            turn = float(np.sign(direction.dot(self.normal[:dimension])))
            jumps = [self.jump(pair, direction) for pair in self.pairs]
            for jump in jumps:
                if k > 0:
                    yield jump, 0.0
                elif shift is not None:
                    yield jump, self.sign * shift * turn
                elif jump is not jumps[0]:
                    yield jump + [(node, c, -x) for node, c, x in jumps[0]], 0.0

    @staticmethod
    def jump(pair, direction):
        along = [(c, float(x)) for c, x in enumerate(direction) if abs(x) > 1e-14]
        return [(node, c, sign * x) for node, sign in zip(pair, (1.0, -1.0)) for c, x in along]

    def forces(self, size):
        """(node, force) that pull both sides together: at one pair, since all jumps are the same."""
        return [(node, sign * self.sign * size * self.normal) for node, sign in zip(self.pairs[0], (1.0, -1.0))]


def cut_bolt(model, pretension):
    """Separates the elements of the surface from those on its other side, by new nodes; the Cut."""
    surface = model.surfaces.get(pretension.surface)
    if surface is None or not surface.faces:
        raise ValueError(f"{pretension.place}: there is no surface of faces \"{pretension.surface}\"")
    elements = {element for element, _ in surface.faces}
    nodes = sorted({n for face in surface.faces for n in model.face_nodes(*face)})
    places = np.array([model.nodes[n] for n in nodes])
    normal, sign = direction_of(model, pretension, surface, places)
    twins = dict(zip(nodes, range(max(model.nodes) + 1, max(model.nodes) + 1 + len(nodes))))
    add_twins(model, twins)
    # The elements of the surface get the new nodes, as in CalculiX.
    for block in model.blocks:
        for row, number in enumerate(block.numbers.tolist()):
            members = block.nodes[row].tolist()
            if not twins.keys() & set(members):
                continue
            middle = np.mean([model.nodes[n] for n in members], axis=0)
            if number in elements or (middle - places.mean(axis=0)).dot(normal) < 0.0:
                block.nodes[row] = [twins.get(n, n) for n in members]
    return Cut(normal, sign, [(twin, node) for node, twin in twins.items()])


def add_twins(model, twins):
    """New nodes at the places of others, as warm as they."""
    for node, twin in twins.items():
        model.nodes[twin] = model.nodes[node]
        if node in model.initial:
            model.initial[twin] = model.initial[node]
    for step in model.steps:
        step.temperature += [
            (place, twins[node], *rest) for place, node, *rest in step.temperature if node in twins
        ]


def direction_of(model, pretension, surface, places):
    """Unit normal of a cut, away from the elements whose faces it is; -1: the model has the other one."""
    block, row = model.block_of[surface.faces[0][0]]
    inside = np.mean([model.nodes[int(n)] for n in block.nodes[row]], axis=0)
    away = places.mean(axis=0) - inside
    is_given = pretension.direction is not None and any(pretension.direction)
    normal = np.array(pretension.direction) if is_given else np.linalg.svd(places - places.mean(axis=0))[2][-1]
    normal = normal / np.linalg.norm(normal)
    if normal.dot(away) > 0.0:
        return normal, 1.0
    return -normal, -1.0 if is_given else 1.0
