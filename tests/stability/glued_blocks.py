# SPDX-License-Identifier: BSD-3-Clause
"""Two blocks on each other with what a deck may put between them, and the settings that must not show.

The lower block is held at its bottom, the upper one is pressed and pushed sideways by its left side: with friction it
sticks and slips, with adhesion it tears. The edge where its held side meets the other block's surface has more rows than
dofs, if meshes do not match.
"""

import itertools

# name: (friction, adhesion, mortar, steps)
SCENES = list(itertools.product((False, True), repeat=4))
# By the path of the parameter. KLU2 takes no condensed form, clusters of a rank need several subdomains there.
SETTINGS = {
    "Decomposition/Clusters": ("none", "rank", "2"),
    "Decomposition/Coarse problem": ("replicated", "distributed"),
    "Dual operator/Form": ("condensed", "implicit"),
    "Dual operator/Local solver": ("multifrontal", "MUMPS", "KLU2"),
    "Decomposition/Dirichlet": ("primal", "dual"),
    "ranks": (1, 2, 3, 4),
}


def name_of(scene):
    words = [word for word, has in zip(("friction", "adhesion", "mortar", "steps"), scene) if has]
    return " ".join(words) or "contact"


def sample(random):
    settings = {path: random.choice(values) for path, values in SETTINGS.items()}
    if settings["Dual operator/Local solver"] == "KLU2":
        settings["Dual operator/Form"] = "implicit"
    return settings


def tree(scene, dimension, torn):
    """The deck. torn: into several subdomains, or each block whole."""
    friction, adhesion, mortar, steps = scene
    solid = dimension == 3
    up = ("bottom", "top")

    def block(origin, size, elements, material):
        parts = [2, 2 if solid else 1, 1] if torn else [1, 1, 1]
        counts = [n // p for n, p in zip(elements, parts)]
        return {
            "Source": "block", "Origin": origin, "Size": size, "Subdomains a side": parts,
            "Elements a side": counts, "Materials": [material],
        }

    def box(x, width, height, level):
        return ([x, 0.0, level], [width, 1.0, height]) if solid else ([x, level, 0.0], [width, height, 1.0])

    # Nodes that match, or a coarser and larger surface below.
    lower = [4, 4, 2] if solid else [8, 3, 1]
    low_box = box(0.0, 2.0, 1.0, 0.0)
    if mortar:
        upper, high_box = [4, 6, 3] if solid else [6, 3, 1], box(0.4, 1.2, 1.0, 1.0)
    else:
        upper, high_box = [4, 4, 3] if solid else [8, 2, 1], box(0.0, 2.0, 1.0, 1.0)
    effects = {
        "Contact": {"joint": {"First": f"upper/{up[0]}", "Second": f"lower/{up[1]}",
                              "Coupling": "mortar" if mortar else "nodes"}},
        "Traction": {"press": {"Part": f"upper/{up[1]}", "Pressure": 2.0}},
        "Prescribed displacement": {
            "ground": {"Part": f"lower/{up[0]}"},
            "guide": {"Part": "upper/left", "Components": ["x"], "Displacement": [0.01, 0.0, 0.0]},
        },
    }
    if solid:
        effects["Prescribed displacement"]["side"] = {"Part": "upper/front", "Components": ["y"]}
    if friction:
        effects["Friction"] = {"rough": {"Contact": "joint", "Coefficient": 0.3}}
    if adhesion:
        glue = {
            "Contact": "joint", "Law": "brittle" if steps and mortar else "bilinear",
            "Normal stiffness": 2e4, "Tangential stiffness": 2e4, "Normal strength": 3.0, "Tangential strength": 6.0,
        }
        if glue["Law"] == "bilinear":
            glue.update({"Fracture energy": 5e-3, "Fracture energy II": 1e-2})
        effects["Adhesion"] = {"glue": glue}
    result = {
        "Model": {"Physics": "solid" if solid else "plane strain"},
        "Materials": {
            "a": {"Young's modulus": 1000.0, "Poisson's ratio": 0.3},
            "b": {"Young's modulus": 2500.0, "Poisson's ratio": 0.25},
        },
        "Bodies": {"lower": block(*low_box, lower, "a"), "upper": block(*high_box, upper, "b")},
        "Effects": effects,
    }
    if steps:
        effects["Traction"]["press"]["History"] = "p"
        effects["Prescribed displacement"]["guide"]["History"] = "u"
        result["Steps"] = {
            "Times": [1.0, 2.0, 3.0],
            "Histories": {
                "p": {"Times": [0.0, 1.0, 3.0], "Values": [0.0, 1.0, 1.0]},
                "u": {"Times": [0.0, 1.0, 2.0, 3.0], "Values": [0.0, 0.2, 0.7, 0.3]},
            },
        }
    return result
