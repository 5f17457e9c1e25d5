# SPDX-License-Identifier: BSD-3-Clause
"""Scenes under uniform compression, whatever lies between their blocks: decks, and what their answers have to be.

Blocks of one material, held sideways at their left (and front) sides, are pressed with a uniform pressure. Where they
meet each other or an obstacle there are contacts, contacts with friction and ties in any combination, on meshes that
match and that do not, by parts or by whole skins. None of it may show: stress is uniaxial, displacements are linear,
each contact has the pressure, each interface the pressure times its area.
"""

import random

ELEMENTS = {2: ("P1", "P2", "Q1", "Q2"), 3: ("P1", "P2", "Q1", "Q2")}
PRESSURE, YOUNG, POISSON = 1.5, 1000.0, 0.3


class Blocks:
    """A deck of blocks on top of each other, and the areas of what lies between them."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.seed = seed
        pick = self.random.choice
        self.dimension = pick([2, 2, 3])
        self.up = self.dimension - 1
        self.bodies, self.parts, self.areas = {}, {}, {}  # areas: of each interface by its key in summary.json
        self.effects = {"Contact": {}, "Tie": {}, "Friction": {}, "Obstacle": {}, "Prescribed displacement": {}, "Traction": {}}
        self.words = []
        self.build()

    # The blocks.

    def block(self, name, level, height, elements):
        pick = self.random.choice
        origin = [0.0] * 3
        origin[self.up] = level
        size = [1.0] * 3
        size[self.up] = height
        subdomains = [pick([1, 2]) if elements[0] % 2 == 0 else 1, 1, 1]
        counts = [elements[0] // subdomains[0], elements[1], 1]
        counts[self.up] = pick([1, 2])
        kind = pick(ELEMENTS[self.dimension])
        self.words.append(f"{name}: {kind} {[c * s for c, s in zip(counts, subdomains)]}")
        self.bodies[name] = {
            "Source": "block",
            "Origin": origin,
            "Size": size,
            "Subdomains a side": subdomains,
            "Elements a side": counts,
            "Element": kind,
            "Materials": ["m"],
        }
        for side, component in [("left", "x")] + ([("front", "y")] if self.dimension == 3 else []):
            self.hold(name, side, component)

    def hold(self, body, side, component):
        self.effects["Prescribed displacement"][f"{body} {side}"] = {"Part": f"{body}/{side}", "Components": [component]}

    def counts(self):
        """Elements along the interface; cuts at quarters are lines of the mesh where there are any."""
        along = [4, 8, 12] if self.hasCuts else [2, 3, 4, 5, 6]
        return [self.random.choice(along[: 2 if self.dimension == 3 else None]) for _ in range(2)]

    # What lies between two.

    def regions(self):
        """Boxes of the interface in x (and y), by quarters, that cover it."""
        pick = self.random.choice
        ends = sorted(self.random.sample([0.25, 0.5, 0.75], pick([1, 1, 2]))) if self.hasCuts else []
        lines = [0.0, *ends, 1.0]
        if self.dimension == 2:
            return [((x0,), (x1,)) for x0, x1 in zip(lines, lines[1:])]
        across = [0.0, pick([0.25, 0.5, 0.75]), 1.0] if ends and pick([True, False]) else [0.0, 1.0]
        return [((x0, y0), (x1, y1)) for x0, x1 in zip(lines, lines[1:]) for y0, y1 in zip(across, across[1:])]

    def part(self, body, side, region, number):
        name = f"{body} {side} {number}"
        low, high = region
        tolerance = 1e-6
        limits = {"low": [-9.0] * 3, "high": [9.0] * 3}
        for d, (a, b) in enumerate(zip(low, high)):
            limits["low"][d], limits["high"][d] = a - tolerance, b + tolerance
        self.parts[name] = {"Bodies": [body], "Of": [side], "Box from": limits["low"], "Box to": limits["high"]}
        return f"{body}/{name}"

    def join(self, upper, lower, regions):
        pick = self.random.choice
        skin = len(regions) == 1 and pick([True, False])
        coupling = pick(["automatic", "automatic", "mortar"])
        kinds = [pick(["Contact", "Contact", "Friction", "Tie"]) for _ in regions]
        if self.random.random() < 0.5:
            order = list(range(len(regions)))
            self.random.shuffle(order)
        else:
            order = range(len(regions))
        for k in order:
            name = f"{upper} on {lower} {k}"
            sides = [(upper, "bottom"), (lower, "top")]
            if skin:
                kinds[k] = pick(["Contact", "Friction"])
                one = pick([0, 1])
                sides[one] = (sides[one][0], "skin")
            if self.random.random() < 0.5:
                sides.reverse()
            names = [
                self.part(body, side, regions[k], k) if len(regions) > 1 else f"{body}/{side}" for body, side in sides
            ]
            effect = {"First": names[0], "Second": names[1], "Coupling": coupling}
            kind = "Tie" if kinds[k] == "Tie" else "Contact"
            self.effects[kind][name] = effect
            if kinds[k] == "Friction":
                self.effects["Friction"][name] = {"Contact": name, "Coefficient": pick([0.1, 0.5, 2.0])}
            low, high = regions[k]
            area = 1.0
            for a, b in zip(low, high):
                area *= b - a
            self.areas[f"{kind}/{name}"] = area
        self.words.append(f"{upper} on {lower}: {kinds}{' skin' if skin else ''} {coupling}")

    def build(self):
        pick = self.random.choice
        number = pick([1, 2, 2, 3])
        self.hasCuts = pick([True, False])
        level, counts = 0.0, None
        for k in range(number):
            counts = counts if k and pick([True, False]) else self.counts()
            height = pick([1.0, 0.5, 0.02]) if k == 1 and number == 3 else pick([1.0, 0.5])
            self.block(f"b{k}", level, height, counts)
            if k:
                self.join(f"b{k}", f"b{k - 1}", self.regions())
            level += height
        self.foot()
        self.effects["Traction"]["press"] = {"Part": f"b{number - 1}/top", "Pressure": PRESSURE}

    def foot(self):
        pick = self.random.choice
        if pick([True, False, False]) and len(self.bodies) > 1:
            self.hold("b0", "bottom", "xyz"[self.up])
            return
        normal = [0.0] * 3
        normal[self.up] = 1.0
        part = pick(["bottom", "skin"])
        self.effects["Obstacle"]["floor"] = {"Part": f"b0/{part}", "Point": [0.0] * 3, "Direction": normal}
        self.areas["Obstacle/floor"] = 1.0
        self.words.append(f"floor under {part}")  # without friction: blocks grow sideways on it

    def tree(self):
        parts = {"skin": {"Bodies": list(self.bodies)}} | self.parts
        return {
            "Model": {"Physics": "plane strain" if self.dimension == 2 else "solid"},
            "Materials": {"m": {"Young's modulus": YOUNG, "Poisson's ratio": POISSON}},
            "Bodies": self.bodies,
            "Boundary parts": parts,
            "Effects": {kind: effects for kind, effects in self.effects.items() if effects},
            "Solver": {"Tolerance": 1e-10},
        }

    @property
    def hasPressure(self):
        return any(not name.startswith("Tie/") for name in self.areas)

    def force(self, name):
        """Upward per area: of the obstacle, or of the second body on the first."""
        pair = self.effects.get("Contact", {}).get(name.partition("/")[2]) or self.effects["Tie"].get(name.partition("/")[2])
        isUpperFirst = pair is None or pair["First"].partition("/")[0] > pair["Second"].partition("/")[0]
        return PRESSURE if isUpperFirst else -PRESSURE

    def displacement(self, xyz):
        """Uniaxial stress upward, as a whole on the ground y (z) = 0."""
        import numpy as np

        u = np.zeros_like(xyz)
        if self.dimension == 2:
            aside, down = POISSON * (1 + POISSON) / YOUNG, (1 - POISSON**2) / YOUNG
        else:
            aside, down = POISSON / YOUNG, 1.0 / YOUNG
        u[:, : self.dimension] = PRESSURE * aside * xyz[:, : self.dimension]
        u[:, self.up] = -PRESSURE * down * xyz[:, self.up]
        return u


class Pulled(Blocks):
    """Pulled along by much more than they are pressed, and solved to the default tolerance."""

    def __init__(self, seed):
        super().__init__(seed)
        pull = PRESSURE * self.random.choice([10.0, 100.0, 1000.0])
        self.words.append(f"pulled by {pull}")
        for body in self.bodies:
            density = [pull, 0.0, 0.0]
            self.effects["Traction"][f"pull {body}"] = {"Part": f"{body}/right", "Density": density}

    def tree(self):
        tree = super().tree()
        del tree["Solver"]
        return tree
