# SPDX-License-Identifier: BSD-3-Clause
"""Scenes of bodies without structure: tetrahedra and triangles, cut into many parts, in contact and not.

What counts of products are measured on, and what the matrix of runs is made of.
"""

import dataclasses

import harmos_runs as runs

GEOMETRIES = runs.SOURCE / "tests/performance/decks"


@dataclasses.dataclass(frozen=True)
class Body:
    """A mesh, what lies around it, and what it is loaded by."""

    title: str
    physics: str
    geometry: str
    bodies: tuple
    contact: str  # the effect's XML
    held: tuple  # parts without displacement, in the linear problem and where nothing presses
    scale: float = 1.0  # of the elements
    order: int = 1


def entry(name, kind, value):
    return f'<Parameter name="{name}" type="{kind}" value="{value}"/>\n'


def group(name, *items):
    return f'<ParameterList name="{name}">\n{"".join(items)}</ParameterList>\n'


def vector(*values):
    return "{" + ", ".join(str(value) for value in values) + "}"


def plane(axis):
    point, direction = [0, 0, 0], [0, 0, 0]
    point[axis], direction[axis] = -1, 1
    return group(
        "Obstacle",
        group(
            "plane",
            entry("Part", "string", "ball/skin"),
            entry("Point", "Array(double)", vector(*point)),
            entry("Direction", "Array(double)", vector(*direction)),
        ),
    )


TOUCHING = group(
    "Contact",
    group(
        "touching",
        entry("First", "string", "ball/skin"),
        entry("Second", "string", "block/face"),
    ),
)

REVERSED = TOUCHING.replace("ball/skin", "").replace("block/face", "ball/skin").replace('value=""', 'value="block/face"')

BODIES = {
    "half-ball": Body(
        "half a ball of linear tetrahedra on a rigid plane",
        "solid",
        "half_ball.geo",
        ("ball",),
        plane(2),
        (),
    ),
    "half-ball-quadratic": Body(
        "half a ball of quadratic tetrahedra on a rigid plane",
        "solid",
        "half_ball.geo",
        ("ball",),
        plane(2),
        (),
        1.75,
        2,
    ),
    "half-disc": Body(
        "half a disc of linear triangles on a rigid line",
        "plane strain",
        "half_disc.geo",
        ("ball",),
        plane(1),
        (),
    ),
    "ball-on-block": Body(
        "half a ball on a block, both of linear tetrahedra, in mortar contact",
        "solid",
        "ball_on_block.geo",
        ("ball", "block"),
        TOUCHING,
        ("block/bottom",),
    ),
}

# Two bodies of quadratic tetrahedra, either one first; not in the matrix of runs.
QUADRATIC_PAIRS = {
    "ball-on-block-quadratic": Body(
        "half a ball on a block, both of quadratic tetrahedra, in mortar contact",
        "solid",
        "ball_on_block.geo",
        ("ball", "block"),
        TOUCHING,
        ("block/bottom",),
        1.75,
        2,
    ),
    "block-under-ball-quadratic": Body(
        "the same, multipliers on the block",
        "solid",
        "ball_on_block.geo",
        ("ball", "block"),
        REVERSED,
        ("block/bottom",),
        1.75,
        2,
    ),
}


def displaced(name, part, value):
    return group(
        name, entry("Part", "string", part), entry("Displacement", "Array(double)", vector(*value))
    )


def write_deck(directory, key, contact, press=0.03, scale=1.0, force=None, drag=0.0, friction=None):
    """The deck of a scene, in `directory`.

    @param drag displacement of the top along x, where it is pressed. @param friction what a deck says of it, such as
    {"Coefficient": 0.3}; None: none.

    @param contact pressed onto what it lies on by `press` from above, or by `force` per area on top where
    that is given; else no contact, and the bodies hang by their weight.
    """
    body = (BODIES | QUADRATIC_PAIRS)[key]
    solid = body.physics == "solid"
    mesh = directory / f"{key}.geo"
    mesh.write_text(
        f"scale = {body.scale * scale:g};\n"
        f'Include "{GEOMETRIES / body.geometry}";\n'
        + ("Mesh.ElementOrder = 2;\n" if body.order == 2 else ""),
        encoding="utf-8",
    )
    held = [displaced(f"hold {part.replace('/', ' ')}", part, (0, 0, 0)) for part in body.held]
    down = (0, 0, -1) if solid else (0, -1, 0)
    effects = []
    if contact:
        effects.append(body.contact)
        if friction is not None:
            name = "plane" if "Obstacle" in body.contact else "touching"
            rough = group(
                "rough",
                entry("Contact", "string", name),
                *(
                    entry(key, "string" if isinstance(value, str) else "double", str(value))
                    for key, value in friction.items()
                ),
            )
            effects.append(group("Friction", rough))
        if force is None:
            held.append(displaced("press", "ball/top", [drag, *(press * x for x in down[1:])]))
        else:
            sideways = "{x, y}" if solid else "{x}"
            held.append(
                group(
                    "guide",
                    entry("Part", "string", "ball/top"),
                    entry("Components", "Array(string)", sideways),
                )
            )
            density = entry("Density", "Array(double)", vector(*[force * x for x in down]))
            effects.append(
                group("Traction", group("load", entry("Part", "string", "ball/top"), density))
            )
    else:
        held.append(displaced("hang", "ball/top", (0, 0, 0)))
        weight = (0.3, 0.2, -1) if solid else (0.3, -1, 0)
        effects.append(
            group(
                "Body force",
                *(
                    group(
                        f"weight of {name}",
                        entry("Body", "string", name),
                        entry("Density", "Array(double)", vector(*weight)),
                    )
                    for name in body.bodies
                ),
            )
        )
    effects.append(group("Prescribed displacement", *held))
    material = group(
        "elastic",
        entry("Young's modulus", "double", 1),
        entry("Poisson's ratio", "double", 0.3),
    )
    deck = directory / f"{key}-{'contact' if contact else 'linear'}.xml"
    deck.write_text(
        group(
            "harmos",
            group(
                "Model",
                entry("Physics", "string", body.physics),
                entry("Mesh file", "string", mesh.name),
            ),
            group("Materials", material),
            group(
                "Bodies",
                *(
                    group(name, entry("Materials", "Array(string)", "{elastic}"))
                    for name in body.bodies
                ),
            ),
            group("Effects", *effects),
            group("Output", entry("Fields", "bool", "false")),
        ),
        encoding="utf-8",
    )
    return deck


def cut(key, parts, partition="compact", seed=1):
    """Settings that cut a scene into so many parts in all."""
    bodies = BODIES[key].bodies
    settings = {}
    for name in bodies:
        settings[f"Bodies/{name}/Subdomains"] = parts // len(bodies)
        settings[f"Bodies/{name}/Expert/Partition"] = partition
        settings[f"Bodies/{name}/Expert/Partition seed"] = seed
    return settings
