# SPDX-License-Identifier: BSD-3-Clause
"""Square or cubic blocks side by side, of two materials whose moduli differ by any factor, as a deck.

    press    u = (5e-3, -1e-2) on the top, (0, 0) on the bottom, of blocks that are all tied
    contact  the upper half lies on the lower one: pressed down by 1e-2 at one side of the top, drawn up by 5e-3 at the
             other, with two free blocks between; nothing moves sideways at the left, in space also at the front
"""

import itertools
import random

import harmos_decks

SIDES = {2: (("right", "left"), ("top", "bottom")), 3: (("right", "left"), ("back", "front"), ("top", "bottom"))}
PATTERNS = ("checkerboard", "random")
POISSON = 0.3


class Blocks:
    """`count` blocks a side of `elements` elements a side each."""

    def __init__(self, dimension, count, elements, jump, pattern, has_contact=False):
        self.dimension, self.count, self.elements, self.jump = dimension, count, elements, jump
        self.has_contact = has_contact
        self.places = list(itertools.product(range(count), repeat=dimension))
        draw = random.Random(7)
        self.is_stiff = [
            sum(place) % 2 == 1 if pattern == "checkerboard" else draw.random() < 0.5 for place in self.places
        ]

    @property
    def up(self):
        return self.dimension - 1

    @property
    def joint(self):
        """Height of the contacts."""
        return self.count // 2

    @property
    def materials(self):
        """(E, nu) by body."""
        return [(self.jump if stiff else 1.0, POISSON) for stiff in self.is_stiff]

    def top_displacement(self, place):
        """By component; None where it is free."""
        if not self.has_contact:
            return [5e-3, *[0.0] * (self.up - 1), -1e-2]
        middle = self.count // 2
        vertical = -1e-2 if place[0] < middle - 1 else 5e-3 if place[0] > middle else None
        return [*[None] * self.up, vertical]

    def deck(self):
        name = lambda place: "b" + "_".join(map(str, place))
        whole = lambda values, rest: [*values, *[rest] * (3 - len(values))]
        bodies, ties, contacts, prescribed = {}, {}, {}, {}
        for place, stiff in zip(self.places, self.is_stiff):
            bodies[name(place)] = {
                "Source": "block",
                "Origin": whole([float(x) for x in place], 0.0),
                "Size": [1.0, 1.0, 1.0],
                "Subdomains a side": [1, 1, 1],
                "Elements a side": whole([self.elements] * self.dimension, 1),
                "Materials": ["stiff" if stiff else "soft"],
            }
            for axis, (mine, other) in enumerate(SIDES[self.dimension]):
                beside = tuple(x + (k == axis) for k, x in enumerate(place))
                if beside[axis] == self.count:
                    continue
                pair = {"First": f"{name(place)}/{mine}", "Second": f"{name(beside)}/{other}"}
                is_contact = self.has_contact and axis == self.up and beside[axis] == self.joint
                (contacts if is_contact else ties)[f"{name(place)} {mine}"] = pair
            self.prescribe(prescribed, place, name(place))
        effects = {"Tie": ties, "Prescribed displacement": prescribed}
        if contacts:
            effects["Contact"] = contacts
        material = lambda modulus: {"Young's modulus": modulus, "Poisson's ratio": POISSON}
        return {
            "Model": {"Physics": "solid" if self.dimension == 3 else "plane strain"},
            "Materials": {"soft": material(1.0), "stiff": material(float(self.jump))},
            "Bodies": bodies,
            "Effects": effects,
        }

    def prescribe(self, prescribed, place, name):
        axes = "xyz"[: self.dimension]
        if place[self.up] == 0:
            prescribed[f"{name} floor"] = {"Part": f"{name}/bottom", "Components": list(axes)}
        values = self.top_displacement(place)
        if place[self.up] == self.count - 1 and values[self.up] is not None:
            prescribed[f"{name} top"] = {
                "Part": f"{name}/top",
                "Components": [axis for axis, value in zip(axes, values) if value is not None],
                "Displacement": [*(value or 0.0 for value in values), *[0.0] * (3 - self.dimension)],
            }
        if self.has_contact:
            for axis, part in (("x", "left"), ("y", "front"))[: self.dimension - 1]:
                if place["xy".index(axis)] == 0:
                    prescribed[f"{name} {part}"] = {"Part": f"{name}/{part}", "Components": [axis]}

    def write(self, path):
        path.write_text(harmos_decks.xml("harmos", self.deck()), encoding="utf-8")
        return path
