# SPDX-License-Identifier: BSD-3-Clause
"""The files of a conversion: a mesh in Gmsh's format, and a deck of Harmos."""

import numpy as np
from inp_model import GMSH_SIDES, TYPES


def write_mesh(conversion, path):
    """Gmsh's format 2.2: each group an entity of its own; an element of two groups is there twice."""
    mesh, model = conversion.parts.mesh, conversion.model
    groups, elements = [], []

    def add(dimension, name, rows):
        tag = len(groups) + 1
        groups.append(f'{dimension} {tag} "{name}"')
        for type_, nodes in rows:
            members = " ".join(map(str, nodes))
            elements.append(f"{len(elements) + 1} {type_} 2 {tag} {tag} {members}")

    dimension = 3 if conversion.physics == "solid" else 2
    for name, cells in mesh.cells.items():
        kinds = [(TYPES[type_], row) for type_, row in cells]
        add(dimension, name, [(kind.gmsh, [row[k] for k in kind.order]) for kind, row in kinds])
    for name, faces in mesh.sides.items():
        add(dimension - 1, name, [(side_type(dimension, face), face) for face in faces])
    for name, nodes in mesh.points.items():
        add(0, name, [(15, [node]) for node in nodes])
    used = sorted(conversion.parts.body_of_node)
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups))]
    lines += [*groups, "$EndPhysicalNames", "$Nodes", str(len(used))]
    lines += [f"{n} " + " ".join(map(repr, model.nodes[n])) for n in used]
    lines += ["$EndNodes", "$Elements", str(len(elements)), *elements, "$EndElements"]
    for name, values in mesh.fields.items():
        lines += ["$NodeData", "1", f'"{name}"', "1", "0.0", "3", "0", "1", str(len(values))]
        lines += [f"{node} {value!r}" for node, value in sorted(values.items())] + ["$EndNodeData"]
    lines.append("")
    path.write_text("\n".join(lines), encoding="utf-8")


def side_type(dimension, face):
    if dimension == 2:
        return GMSH_SIDES[len(face)]
    return GMSH_SIDES[4 if len(face) in (4, 8) else 3, len(face)]


def _text(value):
    return str(value).replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")


def _parameter(name, value):
    if isinstance(value, list):
        kind = "string" if value and isinstance(value[0], str) else "double"
        text = "{" + ", ".join(v if kind == "string" else repr(float(v)) for v in value) + "}"
        return f'<Parameter name="{_text(name)}" type="Array({kind})" value="{_text(text)}"/>'
    kind = {bool: "bool", int: "int", float: "double"}.get(type(value), "string")
    text = repr(float(value)) if kind == "double" else str(value).lower() if kind == "bool" else value
    return f'<Parameter name="{_text(name)}" type="{kind}" value="{_text(text)}"/>'


def _lines(tree, depth):
    for name, value in tree.items():
        indent = "  " * depth
        if isinstance(value, dict):
            yield f'{indent}<ParameterList name="{_text(name)}">'
            yield from _lines(value, depth + 1)
            yield f"{indent}</ParameterList>"
        else:
            yield indent + _parameter(name, value)


def deck_of(conversion, mesh_file):
    """The deck as lists within lists."""
    deck = {
        "Model": {"Name": conversion.name, "Physics": conversion.physics, "Mesh file": mesh_file},
        "Materials": conversion.materials.lists,
        "Bodies": {},
    }
    if conversion.kinematics != "small":
        deck["Model"]["Kinematics"] = conversion.kinematics
    for body in conversion.bodies:
        sections = [section for section, _ in body.regions.values()]
        entry = {"Materials": [conversion.materials.name_of(section) for section in sections]}
        if len(sections) > 1:
            entry["Groups"] = body.groups
        entry["Expert"] = {"Dilatation": "full"}  # as the model's elements have it
        if len({section.thickness for body in conversion.bodies for section, _ in body.regions.values()}) > 1:
            entry["Expert"]["Thickness"] = [section.thickness for section in sections]
        if any(element.reduced for element in body.elements):
            entry["Expert"]["Integration"] = "reduced"
        if any(element.has_mechanisms for element in body.elements):
            entry["Subdomains"] = 1
        deck["Bodies"][body.name] = entry
    if conversion.model.motion.there():
        deck["Steps"] = conversion.model.motion.steps(float(conversion.history.step_ends()[-1]))
        add_histories(conversion, deck["Steps"])
    elif conversion.history.names or len(conversion.model.steps) > 1:
        ends = conversion.history.step_ends()
        times = set(ends.tolist())
        for points in conversion.history.names:  # but for those of jumps, next to the end of a step
            times |= {t for t, _ in points if t > 0.0 and np.abs(ends - t).min() > 1e-8 * ends[-1]}
        deck["Steps"] = {"Times": sorted(times)}
        add_histories(conversion, deck["Steps"])
    deck["Effects"] = dict(conversion.effects)
    return {"harmos": deck}


def add_histories(conversion, steps):
    steps["Histories"] = {
        name: {"Times": [t for t, _ in points], "Values": [value for _, value in points]}
        for points, name in conversion.history.names.items()
    }


def write_deck(conversion, path, mesh_file):
    name = conversion.name.replace("--", "- -")  # which no comment may have
    head = f"<!-- From the model {name}, by harmos-inp. -->"
    lines = [head, *_lines(deck_of(conversion, mesh_file), 0), ""]
    path.write_text("\n".join(lines), encoding="utf-8")
