# SPDX-License-Identifier: BSD-3-Clause
"""Delamination specimens: what beam theory says of them, and decks.

Double cantilever beam: two arms of height h and width b, one beyond a crack of length a, opened by ±P at its mouth. Corrected
beam theory lengthens the crack by χh, for the shear of the arms and the turn of their roots (Hashemi, Kinloch, Williams: Proc.
R. Soc. Lond. A 427, 1990):

    opening = 8P(a + χh)³/(bh³E₁),   G = 12P²(a + χh)²/(b²E₁h³),
    χ² = (E₁/11G₁₃)(3 − 2(Γ/(1 + Γ))²),   Γ = 1.18√(E₁E₂)/G₁₃.

End-notched flexure: the beam on two supports 2L apart, pressed in the middle, with the crack from one of them. The moment at a
distance x from that support is Px/2; arms share it where x < a, where the second moment of area is bh³/6, and bend as one beyond,
2bh³/3. Twice the energy over P², with what shear adds to it, and its derivative by the crack are

    C = (2L³ + 3a³)/(8E₁bh³) + 3L/(10G₁₃bh),   G = P²/(2b) dC/da = 9P²a²/(16E₁b²h³),

a lengthened by 0.42χh there (Wang, Williams: Compos. Sci. Technol. 43, 1992).
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Specimen:
    """N, mm; Alfano, Crisfield: Int. J. Numer. Meth. Engng. 50, 2001."""

    along: float = 135300.0
    across: float = 9000.0
    shear: float = 5200.0
    poisson: float = 0.24
    arm: float = 1.5
    width: float = 20.0
    crack: float = 30.0
    energy: float = 0.28
    half_span: float = 50.0  # of the end-notched flexure; a double cantilever beam is as long as both halves
    # Of the interface.
    strength: float = 57.0
    stiffness: float = 1e5

    def root(self):
        """χh."""
        gamma = 1.18 * math.sqrt(self.along * self.across) / self.shear
        return self.arm * math.sqrt(self.along / (11 * self.shear) * (3 - 2 * (gamma / (1 + gamma)) ** 2))

    def opened_stiffness(self):
        """P over the opening."""
        return self.width * self.arm**3 * self.along / (8 * (self.crack + self.root()) ** 3)

    def opened_load(self):
        """At which the crack of a double cantilever beam grows."""
        a = self.crack + self.root()
        return math.sqrt(self.energy * self.width**2 * self.along * self.arm**3 / 12) / a

    def bent_stiffness(self):
        """P over the deflection."""
        a = self.crack + 0.42 * self.root()
        bending = (2 * self.half_span**3 + 3 * a**3) / (8 * self.along * self.width * self.arm**3)
        return 1 / (bending + 3 * self.half_span / (10 * self.shear * self.width * self.arm))

    def bent_load(self):
        """At which the crack of an end-notched flexure beam grows."""
        a = self.crack + 0.42 * self.root()
        return 4 * self.width * self.arm / (3 * a) * math.sqrt(self.along * self.arm * self.energy)


def _parameter(name, kind, value):
    return f'<Parameter name="{name}" type="{kind}" value="{value}"/>'


def _list(name, *content):
    return f'<ParameterList name="{name}">' + "".join(content) + "</ParameterList>"


def _body(name, origin, length, s, across, element):
    pieces = max(1, round(length / 12))
    return _list(
        name,
        _parameter("Source", "string", "block"),
        _parameter("Origin", "Array(double)", f"{{{origin[0]}, {origin[1]}, 0}}"),
        _parameter("Size", "Array(double)", f"{{{length}, {s.arm}, 1}}"),
        _parameter("Subdomains a side", "Array(int)", f"{{{pieces}, 1, 1}}"),
        _parameter("Elements a side", "Array(int)", f"{{{round(across[0] * length / pieces)}, {across[1]}, 1}}"),
        _parameter("Element", "string", element),
        _parameter("Materials", "Array(string)", "{laminate}"),
    )


def _pair(name, first, second):
    return _list(
        name,
        _parameter("First", "string", first),
        _parameter("Second", "string", second),
        _parameter("Coupling", "string", "nodes"),
    )


def _hold(name, part, components, value=0.0):
    return _list(
        name,
        _parameter("Part", "string", part),
        _parameter("Components", "Array(string)", components),
        *([_parameter("Displacement", "Array(double)", f"{{0, {value}, 0}}")] if value else []),
    )


def _deck(s, lengths, bonded_from, holds, steps, per_length, through, element, *others):
    """Pieces of these lengths, one after the other, tied; above and below the interface."""
    bodies, ties, contacts, adhesions, x = [], [], [], [], 0.0
    for k, length in enumerate(lengths):
        for row, y in (("lower", 0.0), ("upper", s.arm)):
            bodies.append(_body(f"{row} {k}", (x, y), length, s, (per_length, through), element))
            if k > 0:
                ties.append(_pair(f"{row} {k}", f"{row} {k - 1}/right", f"{row} {k}/left"))
        contacts.append(_pair(f"face {k}", f"upper {k}/bottom", f"lower {k}/top"))
        if x >= bonded_from:
            adhesions.append(
                _list(
                    f"face {k}",
                    _parameter("Contact", "string", f"face {k}"),
                    _parameter("Law", "string", "bilinear"),
                    _parameter("Normal stiffness", "double", s.stiffness),
                    _parameter("Tangential stiffness", "double", s.stiffness),
                    _parameter("Normal strength", "double", s.strength),
                    _parameter("Tangential strength", "double", s.strength),
                    _parameter("Fracture energy", "double", s.energy),
                    _parameter("Fracture energy II", "double", s.energy),
                )
            )
        x += length
    across_shear = s.across / (2 * (1 + 0.46))
    return _list(
        "harmos",
        _list("Model", _parameter("Physics", "string", "plane stress"), _parameter("Name", "string", "delamination")),
        _list(
            "Materials",
            _list(
                "laminate",
                _parameter("Type", "string", "orthotropic"),
                _parameter("Young's moduli", "Array(double)", f"{{{s.along}, {s.across}, {s.across}}}"),
                _parameter("Poisson's ratios", "Array(double)", f"{{{s.poisson}, {s.poisson}, 0.46}}"),
                _parameter("Shear moduli", "Array(double)", f"{{{s.shear}, {s.shear}, {across_shear}}}"),
            ),
        ),
        _list("Bodies", *bodies),
        _list("Steps", _parameter("Number", "int", steps)),
        _list(
            "Effects",
            _list("Contact", *contacts),
            _list("Adhesion", *adhesions),
            _list("Tie", *ties),
            _list("Prescribed displacement", *holds),
            *others,
        ),
    )


def double_cantilever(s, opening, steps, per_length=2, through=2, element="Q2"):
    """A deck; forces in its plane are those of a unit of width."""
    holds = [
        _hold("end above", "upper 1/right", "{x, y}"),
        _hold("end below", "lower 1/right", "{x, y}"),
        _hold("mouth above", "upper 0/left", "{y}", 0.5 * opening),
        _hold("mouth below", "lower 0/left", "{y}", -0.5 * opening),
    ]
    lengths = (s.crack, 2 * s.half_span - s.crack)
    return _deck(s, lengths, s.crack, holds, steps, per_length, through, element)


def end_notched(s, deflection, steps, per_length=2, through=2, element="Q2"):
    holds = [
        _hold("support", "lower 0/left", "{y}"),
        _hold("other support", "lower 2/right", "{y}"),
        _hold("press", "upper 2/left", "{y}", -deflection),
    ]
    # So that ends turn, and nothing moves along the beam as a whole.
    soft = _list(
        "Elastic foundation",
        _list(
            "end",
            _parameter("Part", "string", "lower 2/right"),
            _parameter("Normal stiffness", "double", 1e-3),
        ),
    )
    lengths = (s.crack, s.half_span - s.crack, s.half_span)
    return _deck(s, lengths, s.crack, holds, steps, per_length, through, element, soft)
