# SPDX-License-Identifier: BSD-3-Clause
"""A deck and a mesh of Harmos, made from the model of another program's input."""

import re
from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np
from inp_file import InpError, number_of
from inp_model import GMSH_SIDES, TYPES

AXES = "xyz"


@dataclass
class Body:
    """Elements that hang together by nodes."""

    name: str
    type: str
    blocks: list  # (numbers, nodes) of its elements
    regions: dict = field(default_factory=dict)  # section -> elements
    groups: list = field(default_factory=list)  # of the mesh file, one for each region

    @property
    def reduced(self):
        return TYPES[self.type].reduced


@dataclass
class Mesh:
    """Named groups of the mesh file: cells, sides by their nodes, and nodes."""

    cells: dict = field(default_factory=dict)  # group -> (type, elements' nodes)
    sides: dict = field(default_factory=dict)  # group -> list of nodes of faces
    points: dict = field(default_factory=dict)  # group -> nodes
    fields: dict = field(default_factory=dict)  # name -> {node: value}


def safe(name):
    """A name that decks admit."""
    return re.sub(r"[^A-Za-z0-9_.+-]", "_", name)


def labels_of(count, elements):
    """A label for each node: the same for nodes that elements connect."""
    labels = np.arange(count)
    while True:
        before = labels.copy()
        for nodes in elements:
            least = labels[nodes].min(axis=1)
            np.minimum.at(labels, nodes, least[:, None])
        labels = labels[labels]
        if np.array_equal(labels, before):
            return labels


class Conversion:
    """Collects bodies, parts and effects; faults are told all at once."""

    def __init__(self, model, name):
        self.model, self.name = model, name
        self.faults, self.notes = [], list(model.notes)
        self.mesh, self.bodies, self.effects = Mesh(), [], defaultdict(dict)
        self.materials, self.histories, self.material_names = {}, {}, {}
        self.body_of_element, self.body_of_node = {}, {}
        self.part_names, self.members = {}, {}
        self.sharers = None  # of faces
        self.cuts = {}  # node of a pretension -> (direction, pairs of nodes)
        self.thickness = 1.0
        for make in (
            self.make_cuts,
            self.make_bodies,
            self.make_materials,
            self.make_supports,
            self.make_forces,
            self.make_distributed,
            self.make_temperatures,
            self.make_equations,
            self.make_contacts,
        ):
            try:
                make()
            except ValueError as error:
                self.faults += str(error).split("\n")
            if self.faults and make in (self.make_cuts, self.make_bodies, self.make_materials):
                break  # what follows needs them
        if self.faults:
            raise InpError(self.faults)

    # Pretension: bolts are cut, and the sides held together but for a shift along the bolt.

    def make_cuts(self):
        model = self.model
        for pretension in model.pretensions:
            surface = model.surfaces.get(pretension.surface)
            if surface is None or not surface.faces:
                raise ValueError(f"{pretension.place}: there is no surface of faces \"{pretension.surface}\"")
            faces = {element for element, _ in surface.faces}
            nodes = sorted({n for face in surface.faces for n in model.face_nodes(*face)})
            places = np.array([model.nodes[n] for n in nodes])
            normal, sign = self.direction_of(pretension, surface, places)
            twins = dict(zip(nodes, range(max(model.nodes) + 1, max(model.nodes) + 1 + len(nodes))))
            self.add_twins(twins)
            # The elements of the surface get the new nodes, as in CalculiX.
            for block in model.blocks:
                for row, number in enumerate(block.numbers.tolist()):
                    members = block.nodes[row].tolist()
                    if not twins.keys() & set(members):
                        continue
                    middle = np.mean([model.nodes[n] for n in members], axis=0)
                    if number in faces or (middle - places.mean(axis=0)).dot(normal) < 0.0:
                        block.nodes[row] = [twins.get(n, n) for n in members]
            self.cuts[pretension.node] = (normal, sign, [(twin, node) for node, twin in twins.items()])

    def add_twins(self, twins):
        """New nodes at the places of others, as warm as they."""
        model = self.model
        for node, twin in twins.items():
            model.nodes[twin] = model.nodes[node]
            if node in model.initial:
                model.initial[twin] = model.initial[node]
        for step in model.steps:
            step.temperature += [
                (place, twins[node], *rest) for place, node, *rest in step.temperature if node in twins
            ]

    def direction_of(self, pretension, surface, places):
        """Unit normal of a cut, away from the elements whose faces it is; −1: the model has the other one."""
        model = self.model
        block, row = model.typeOf[surface.faces[0][0]]
        inside = np.mean([model.nodes[int(n)] for n in block.nodes[row]], axis=0)
        away = places.mean(axis=0) - inside
        if pretension.direction is not None and any(pretension.direction):
            normal = np.array(pretension.direction)
        else:
            normal = np.linalg.svd(places - places.mean(axis=0))[2][-1]
        normal = normal / np.linalg.norm(normal)
        if normal.dot(away) > 0.0:
            return normal, 1.0
        return -normal, -1.0 if pretension.direction is not None and any(pretension.direction) else 1.0

    def hold_cut(self, node, shift):
        """Rows of a cut: the same jump everywhere, along the bolt or none; shift: that along it, if given."""
        normal, sign, pairs = self.cuts[node]
        dimension = 3 if self.physics == "solid" else 2
        frame = np.linalg.svd(normal[None, :dimension])[2]
        name = f"pretension_{node}"
        for k, direction in enumerate(frame):
            for low, high in pairs:
                terms = [(low, c, float(x)) for c, x in enumerate(direction) if abs(x) > 1e-14]
                terms += [(high, c, -float(x)) for c, x in enumerate(direction) if abs(x) > 1e-14]
                if k > 0:
                    self.add_equation(terms, 0.0, name)
                elif shift is not None:
                    self.add_equation(terms, sign * shift * float(np.sign(direction.dot(normal[:dimension]))), name)
                elif low != pairs[0][0]:
                    first, last = pairs[0]
                    less = [(n, c, -x) for n, c, x in terms]
                    same = [(first if n == low else last, c, x) for n, c, x in less]
                    self.add_equation(terms + same, 0.0, name)

    # Bodies.

    def make_bodies(self):
        model = self.model
        physics = {TYPES[block.type].physics for block in model.blocks}
        if len(physics) > 1:
            raise ValueError(f"elements of {' and '.join(sorted(physics))} in one model are not supported")
        self.physics = physics.pop()
        used = sorted({n for block in model.blocks for n in block.nodes.ravel().tolist()})
        place = {n: k for k, n in enumerate(used)}
        tables = [np.array([[place[n] for n in row] for row in b.nodes.tolist()]) for b in model.blocks]
        labels = labels_of(len(used), tables)
        groups = defaultdict(list)
        for block, table in zip(model.blocks, tables):
            of_element = labels[table[:, 0]]
            for label in np.unique(of_element):
                chosen = of_element == label
                groups[label].append((block.type, block.numbers[chosen], block.nodes[chosen]))
        for label in sorted(groups):
            self.add_body(groups[label], len(groups))
        self.make_regions()

    def add_body(self, pieces, count):
        types = {TYPES[type_].gmsh for type_, _, _ in pieces}
        reduced = {TYPES[type_].reduced for type_, _, _ in pieces}
        elements = np.concatenate([numbers for _, numbers, _ in pieces])
        if len(types) > 1 or len(reduced) > 1:
            names = ", ".join(sorted({type_ for type_, _, _ in pieces}))
            raise ValueError(f"elements of several types ({names}) share nodes, which is not supported")
        name = self.body_name(set(elements.tolist()), count)
        body = Body(name, pieces[0][0], [(numbers, nodes) for _, numbers, nodes in pieces])
        for number in elements.tolist():
            self.body_of_element[number] = body
        for _, _, nodes in pieces:
            for node in nodes.ravel().tolist():
                self.body_of_node[node] = body
        self.bodies.append(body)

    def body_name(self, elements, count):
        taken = {body.name for body in self.bodies}
        for name, members in self.model.elsets.items():
            if count > 1 and len(members) >= len(elements) and set(members) == elements:
                if safe(name) not in taken:
                    return safe(name)
        return "body" if count == 1 else f"body_{len(self.bodies) + 1}"

    def make_regions(self):
        section_of = {}
        for section in self.model.sections:
            if section.elset not in self.model.elsets:
                self.faults.append(f"{section.place}: there is no element set \"{section.elset}\"")
                continue
            for element in self.model.elsets[section.elset]:
                section_of[element] = section
        for body in self.bodies:
            for numbers, nodes in body.blocks:
                for number, row in zip(numbers.tolist(), nodes.tolist()):
                    section = section_of.get(number)
                    if section is None:
                        raise ValueError(f"element {number} has no *SOLID SECTION")
                    body.regions.setdefault(section.place, (section, []))[1].append(row)
            for k, (section, rows) in enumerate(body.regions.values(), 1):
                group, taken = body.name if len(body.regions) == 1 else f"{body.name}_{k}", self.mesh.cells
                while group in taken or group != body.name and group in {b.name for b in self.bodies}:
                    group += "_"
                self.mesh.cells[group] = (body.type, rows)
                body.groups.append(group)
        thickness = {s.thickness for body in self.bodies for s, _ in body.regions.values()}
        if self.physics in ("plane strain", "plane stress"):
            if len(thickness) > 1:
                raise ValueError("plane sections of several thicknesses are not supported")
            self.thickness = thickness.pop()
            if self.thickness != 1.0:
                self.notes.append(
                    f"thickness {self.thickness:g}: forces are divided by it, since Harmos' plane bodies have "
                    "the thickness 1"
                )

    # Materials.

    def make_materials(self):
        for body in self.bodies:
            for section, _ in body.regions.values():
                key = self.material_name(section)
                if key in self.materials:
                    continue
                material = self.model.materials.get(section.material)
                if material is None or material.elastic is None:
                    self.faults.append(f"{section.place}: \"{section.material}\" is no elastic material")
                    continue
                self.materials[key] = self.material(material, section)

    def material_name(self, section):
        """One for each material and orientation."""
        key = (section.material, section.orientation)
        if key not in self.material_names:
            name = safe(section.material) + (f"_{safe(section.orientation)}" if section.orientation else "")
            while name in self.material_names.values():
                name += "_"
            self.material_names[key] = name
        return self.material_names[key]

    def material(self, material, section):
        kind, numbers = material.elastic["kind"], material.elastic["numbers"]
        values = {}
        uneven = len(set(material.expansion or ())) > 1
        if kind == "ISOTROPIC" and section.orientation and uneven:
            young, ratio = numbers
            shear = 0.5 * young / (1.0 + ratio)
            values.update({"Type": "orthotropic", "Young's moduli": [young] * 3})
            values.update({"Poisson's ratios": [ratio] * 3, "Shear moduli": [shear] * 3})
        elif kind == "ISOTROPIC":
            values["Young's modulus"], values["Poisson's ratio"] = numbers
            if numbers[1] > 0.4:
                self.notes.append(
                    f"{material.place}: nearly incompressible; \"Dilatation\" = \"projected\" of the bodies keeps "
                    "elements of full integration from locking"
                )
        elif kind == "ANISOTROPIC":
            values.update({"Type": "anisotropic", "Stiffness": list(numbers)})
        else:
            values["Type"] = "orthotropic"
            try:
                values.update(self.engineering(kind, numbers))
            except np.linalg.LinAlgError:
                raise ValueError(f"{material.elastic['place']}: the moduli make a singular matrix") from None
        if section.orientation and (kind != "ISOTROPIC" or uneven):
            values.update(self.axes_of_material(section))
        if material.expansion:
            values["Thermal expansion"] = list(material.expansion)
        return values

    def engineering(self, kind, numbers):
        if kind == "ENGINEERING CONSTANTS":
            young, poisson, shear = numbers[:3], numbers[3:6], numbers[6:]
        else:
            d11, d12, d22, d13, d23, d33, *shear = numbers
            s = np.linalg.inv(np.array([[d11, d12, d13], [d12, d22, d23], [d13, d23, d33]]))
            young = [1.0 / s[k, k] for k in range(3)]
            poisson = [-s[0, 1] / s[0, 0], -s[0, 2] / s[0, 0], -s[1, 2] / s[1, 1]]
        return {"Young's moduli": young, "Poisson's ratios": poisson, "Shear moduli": list(shear)}

    def axes_of_material(self, section):
        numbers = self.model.orientations.get(section.orientation)
        if numbers is None:
            raise ValueError(f"{section.place}: there is no orientation \"{section.orientation}\"")
        return {"Axis 1": numbers[:3], "Axis 2": numbers[3:]}

    # What steps change, over time.

    def step_ends(self):
        return np.cumsum([step.period for step in self.model.steps])

    def series(self, kind):
        """key -> [(time, value)] of one kind of entries (place, ..., value, amplitude).

        Loads that a step gives again add up, and take the place of those of the step before; what is prescribed is
        that of the last line.
        """
        result, current, ends = defaultdict(list), {}, self.step_ends()
        for step, end in zip(self.model.steps, ends):
            begin, fresh = end - step.period, self.fresh(step, kind)
            gone = set(current) - set(fresh) if kind in step.resets else set()
            if kind == "boundary" and gone:
                raise ValueError(f"{step.place}: supports that are released (OP=NEW) are not supported")
            for key in gone:
                fresh[key] = (0.0, "", step.place)
            for key, (_, amplitude) in current.items():
                if key not in fresh and amplitude and self.model.amplitudes[amplitude][2]:
                    fresh[key] = (*current[key][0], amplitude, step.place)  # total time goes on
            for key, (value, amplitude, place) in fresh.items():
                points = result[key]
                if not points and begin > 0.0 and kind == "boundary":
                    raise ValueError(f"{place}: a support that begins in a later step is not supported")
                before = points[-1][1] if points else self.at_rest(kind, key)
                points += self.follow(amplitude, value, begin, end) if amplitude else [(begin, before), (end, value)]
                current[key] = ((value,), amplitude)
        return result

    def at_rest(self, kind, key):
        return self.model.initial.get(key[0], 0.0) if kind == "temperature" else 0.0

    def fresh(self, step, kind):
        """key -> (value, amplitude, place) of a step."""
        fresh = {}
        for place, *key, value, amplitude in getattr(step, kind):
            key = self.key_of(key)
            if key in fresh and kind in ("cload", "dload"):
                if fresh[key][1] != amplitude:
                    raise ValueError(f"{place}: a load with two amplitudes in one step is not supported")
                value += fresh[key][0]
            fresh[key] = (value, amplitude, place)
        return fresh

    @staticmethod
    def key_of(key):
        return tuple(tuple(part) if isinstance(part, list) else part for part in key)

    def follow(self, amplitude, value, begin, end):
        times, values, is_total = self.model.amplitudes[amplitude]
        shift = 0.0 if is_total else begin
        inside = sorted({begin, end, *(t + shift for t in times if begin < t + shift < end)})
        return [(t, float(np.interp(t - shift, times, values)) * value) for t in inside]

    def is_one_state(self):
        rough = any(i.friction for i in self.model.interactions.values())
        return len(self.model.steps) == 1 and not (rough and self.model.amplitudes)

    def history(self, points):
        """Magnitude and name of the history of scalars over time; "" in one state: the last value counts."""
        values = [float(value) for _, value in points]
        if self.is_one_state():
            return values[-1], ""
        magnitude = max(values, key=abs)
        if magnitude == 0.0:
            return 0.0, ""
        shape = tuple((float(t), value / magnitude) for (t, _), value in zip(points, values))
        jump, unique = 1e-9 * float(self.step_ends()[-1]), []
        for time, factor in shape:
            if unique and time <= unique[-1][0]:
                if factor == unique[-1][1]:
                    continue
                time = unique[-1][0] + jump  # the step before ends with another value
            unique.append((time, factor))
        name = self.histories.setdefault(tuple(unique), f"history_{len(self.histories) + 1}")
        return magnitude, name

    # Parts.

    def node_part(self, nodes, hint):
        """{body: part} of a set of nodes."""
        return self.part(self.mesh.points, sorted(set(nodes)), lambda n: self.body_of_node.get(n), hint)

    def side_part(self, faces, hint):
        """{body: part} of faces (element, face)."""
        sides = sorted({self.model.face_nodes(*face): face for face in faces}.items())
        owner = {nodes: self.body_of_element[face[0]] for nodes, face in sides}
        return self.part(self.mesh.sides, [nodes for nodes, _ in sides], owner.get, hint)

    def part(self, groups, members, body_of, hint):
        by_body = defaultdict(list)
        for member in members:
            body = body_of(member)
            if body is None:
                raise ValueError(f"node {member} belongs to no element, which is not supported here")
            by_body[body.name].append(member)
        result = {}
        for body, own in by_body.items():
            key = (id(groups), body, tuple(own))
            if key not in self.part_names:
                taken = set(self.part_names.values())
                name, k = safe(hint), 2
                while (body, name) in taken or name in self.mesh.cells:
                    name, k = f"{safe(hint)}_{k}", k + 1
                self.part_names[key] = (body, name)
                self.members[body, name] = own
                groups.setdefault(name, []).extend(own)
            result[body] = self.part_names[key][1]
        return result

    def add_effect(self, kind, name, **parameters):
        effects, k, unique = self.effects[kind], 2, safe(name)
        while unique in effects:
            unique, k = f"{safe(name)}_{k}", k + 1
        effects[unique] = {key.replace("_", " "): value for key, value in parameters.items() if value != ""}
        return unique

    # Local axes of nodes.

    def axes(self, node):
        """Rows are the directions of the dofs of a node; None: those of the coordinates."""
        found = None
        for nodes, kind, numbers in self.model.transforms:
            if node in nodes:
                found = (kind, numbers)
        if found is None:
            return None
        kind, numbers = found
        a, b = np.array(numbers[:3]), np.array(numbers[3:])
        if kind == "R":
            first = a / np.linalg.norm(a)
            third = np.cross(first, b)
            third /= np.linalg.norm(third)
            return np.array([first, np.cross(third, first), third])
        axis = (b - a) / np.linalg.norm(b - a)
        out = np.array(self.model.nodes[node]) - a
        out -= out.dot(axis) * axis
        if np.linalg.norm(out) == 0.0:
            raise ValueError(f"node {node} lies on the axis of its *TRANSFORM")
        out /= np.linalg.norm(out)
        return np.array([out, np.cross(axis, out), axis])

    def terms(self, node, dof, factor=1.0):
        """Terms (node, component, coefficient) of a displacement in the direction of a dof."""
        axes = self.axes(node)
        if axes is None:
            return [(node, dof - 1, factor)]
        return [(node, c, factor * axes[dof - 1, c]) for c in range(3) if abs(axes[dof - 1, c]) > 1e-14]

    # Effects.

    def make_supports(self):
        held = defaultdict(dict)  # node -> {dof: series}
        dofs = 3 if self.physics == "solid" else 2
        self.free_nodes = {}
        for (node, dof), points in self.series("boundary").items():
            if node not in self.body_of_node:
                self.free_nodes[node, dof] = points  # of equations
            elif dof <= dofs:
                held[node][dof] = points
        groups = defaultdict(list)
        for node, values in held.items():
            if self.axes(node) is not None:
                self.hold_along(node, values)
                continue
            known = {dof: self.history(points) for dof, points in values.items()}
            for history in {h for _, h in known.values()}:
                chosen = tuple(sorted((d, v) for d, (v, h) in known.items() if h == history))
                groups[chosen, history].append(node)
        for (chosen, history), nodes in groups.items():
            value = [0.0, 0.0, 0.0]
            for dof, size in chosen:
                value[dof - 1] = size
            components = "".join(AXES[dof - 1] for dof, _ in chosen)
            for body, part in self.node_part(nodes, "held_" + components).items():
                self.add_effect(
                    "Prescribed displacement",
                    f"held_{components}",
                    Part=f"{body}/{part}",
                    Components=list(components),
                    Displacement=value,
                    History=history,
                )

    def hold_along(self, node, values):
        for dof, points in values.items():
            size, history = self.history(points)
            if history and size != 0.0:
                raise ValueError(f"node {node}: prescribed motion over steps in local axes is not supported")
            self.add_equation(self.terms(node, dof), size, "local_axes")

    def add_equation(self, terms, value, name):
        texts = []
        for node, component, factor in terms:
            (body, part), *_ = self.node_part([node], f"n{node}").items()
            texts.append(f"{factor!r} {body}/{part} {AXES[component]}")
        effect = self.effects["Linear constraint"].setdefault(name, {"Equations": [], "Values": []})
        effect["Equations"].append("; ".join(texts))
        effect["Values"].append(value)

    def make_forces(self):
        loads = defaultdict(dict)
        for (node, dof), points in self.series("cload").items():
            if node in self.cuts and dof == 1:
                self.pull_cut(node, points)
                continue
            if not 1 <= dof <= 3:
                raise ValueError(f"node {node}: a moment (*CLOAD on dof {dof}) is not supported")
            loads[node][dof] = points
        groups = defaultdict(list)
        for node, values in loads.items():
            axes = self.axes(node)
            by_history = defaultdict(lambda: np.zeros(3))
            for dof, points in values.items():
                size, history = self.history(points)
                direction = axes[dof - 1] if axes is not None else np.eye(3)[dof - 1]
                by_history[history] = by_history[history] + size / self.thickness * direction
            for history, force in by_history.items():
                if np.any(force):
                    groups[tuple(force.tolist()), history].append(node)
        for (force, history), nodes in groups.items():
            for body, part in self.node_part(nodes, "loaded").items():
                self.add_effect(
                    "Force", "force", Part=f"{body}/{part}", Force=list(force), History=history
                )

    def pull_cut(self, node, points):
        """A force that pulls both sides of a cut together, at a pair of nodes, since all jumps are the same."""
        normal, turn, pairs = self.cuts[node]
        size, history = self.history(points)
        for part, sign in zip(pairs[0], (1.0, -1.0)):
            force = (turn * sign * size / self.thickness * normal).tolist()
            for body, name in self.node_part([part], f"n{part}").items():
                self.add_effect("Force", f"pretension_{node}", Part=f"{body}/{name}", Force=force, History=history)

    def make_distributed(self):
        pressures, turning = defaultdict(list), {}
        for key, points in self.series("dload").items():
            if key[0] == "P":
                size, history = self.history(points)
                if size != 0.0:
                    pressures[size, history].append(key[1])
                    self.require_outer(key[1])
                continue
            for body in self.add_volume_force(key, points):
                if key[0] == "CENTRIF" and turning.setdefault(body, key) != key:
                    raise ValueError(f"body {body} has two CENTRIF loads, which is not supported")
        for (size, history), faces in pressures.items():
            for body, part in self.side_part(faces, "pressed").items():
                self.add_effect(
                    "Traction", "pressure", Part=f"{body}/{part}", Pressure=size, History=history
                )

    def require_outer(self, face):
        """Faces inside of a body have no pressure in Harmos."""
        if self.sharers is None:
            self.sharers = defaultdict(int)
            for element in self.body_of_element:
                block, _ = self.model.typeOf[element]
                for number in range(len(TYPES[block.type].sides)):
                    self.sharers[frozenset(self.model.face_nodes(element, number))] += 1
        if self.sharers[frozenset(self.model.face_nodes(*face))] > 1:
            raise ValueError(f"element {face[0]}, face {face[1] + 1}: a pressure inside of a body is not supported")

    def add_volume_force(self, key, points):
        """GRAV or CENTRIF on the bodies of a set of elements; their names."""
        label, elements, bodies = key[0], set(key[1]), []
        size, history = self.history(points)
        for body in self.bodies:
            own = {int(n) for numbers, _ in body.blocks for n in numbers}
            if not own & elements or size == 0.0:
                continue
            densities = {self.model.materials[s.material].density for s, _ in body.regions.values()}
            if not own <= elements or len(densities) > 1 or None in densities:
                raise ValueError(
                    f"{label} on a part of body {body.name}, or on several densities or none, is not supported"
                )
            density = densities.pop()
            bodies.append(body.name)
            if label == "GRAV":
                pull = [density * size * x for x in key[2]]
                self.add_effect("Body force", "weight", Body=body.name, Density=pull, History=history)
                continue
            if history:
                raise ValueError("CENTRIF in several steps is not supported")
            self.add_effect(
                "Centrifugal force",
                "rotation",
                Body=body.name,
                Mass_density=density,
                Angular_velocity=float(np.sqrt(size)),
                Point=list(key[2][:3]),
                Axis=list(key[2][3:]),
            )
        return bodies

    def make_temperatures(self):
        rises = self.series("temperature")
        for body in self.bodies:
            if not any(self.model.materials[s.material].expansion for s, _ in body.regions.values()):
                continue
            nodes = {int(n) for _, rows in body.blocks for n in rows.ravel()}
            known = set()
            for node in nodes:
                start = self.model.initial.get(node, 0.0)
                points = rises.get((node,), [(0.0, start)])
                known.add(tuple((float(t), float(value) - start) for t, value in points))
            if len({points[-1][1] for points in known}) > 1 and self.is_one_state():
                self.add_temperature_field(body, nodes, rises)
                continue
            if len(known) > 1 and not self.is_one_state():
                raise ValueError(f"body {body.name}: temperatures that vary within a body and over steps are not supported")
            points = [(0.0, 0.0)] + [p for p in known.pop() if p[0] > 0.0]
            size, history = self.history(points)
            if size != 0.0:
                self.add_effect(
                    "Thermal strain", f"temperature_{body.name}", Body=body.name, Temperature=size, History=history
                )

    def add_temperature_field(self, body, nodes, rises):
        values = self.mesh.fields.setdefault("temperature", {})
        for node in nodes:
            start = self.model.initial.get(node, 0.0)
            points = rises.get((node,))
            values[node] = float(points[-1][1]) - start if points else 0.0
        self.add_effect("Thermal strain", f"temperature_{body.name}", Body=body.name, Field="temperature")

    def make_equations(self):
        for node in self.cuts:
            points = self.free_nodes.get((node, 1))
            shift, history = self.history(points) if points is not None else (None, "")
            if history and shift:
                raise ValueError(f"node {node}: the shift of a pretension over steps is not supported")
            self.hold_cut(node, shift)
        for equation in self.model.equations:
            terms, value = [], 0.0
            for node, dof, factor in equation.terms:
                if node in self.body_of_node:
                    terms += self.terms(node, dof, factor)
                    continue
                points = self.free_nodes.get((node, dof))
                if points is None:
                    raise ValueError(
                        f"{equation.place}: node {node} belongs to no element and is not prescribed, which is "
                        "not supported"
                    )
                size, history = self.history(points)
                if history and size != 0.0:
                    raise ValueError(f"{equation.place}: a value over steps is not supported")
                value -= factor * size
            if terms:
                self.add_equation(terms, value, "equations")

    def make_contacts(self):
        for pair in self.model.ties:
            self.couple("Tie", "tie", pair)
        for pair in self.model.contacts:
            interaction = self.model.interactions.get(pair.interaction)
            if interaction is None:
                raise ValueError(f"{pair.place}: there is no interaction \"{pair.interaction}\"")
            if interaction.behaviour == "TIED":
                self.couple("Tie", "tie", pair)
                continue
            soft = interaction.stiffness if interaction.behaviour == "LINEAR" else ""
            for name in self.couple("Contact", "contact", pair, Stiffness=soft, Adjust=self.adjust(pair)):
                if interaction.friction:
                    self.add_effect("Friction", name, Contact=name, Coefficient=interaction.friction)

    def adjust(self, pair):
        """Distances up to this are zero; "": they stay."""
        text = pair.options.get("ADJUST", "")
        try:
            return max(float(text), 1e-300) if text else ""
        except ValueError:
            self.notes.append(f"{pair.place}: ADJUST of a node set is not supported; gaps stay as they are")
            return ""

    def couple(self, kind, name, pair, **more):
        slaves, masters = (self.surface(text, pair.place) for text in (pair.slave, pair.master))
        reach = pair.options.get("POSITION TOLERANCE", "")
        if kind == "Tie" and reach:
            more["Reach"] = number_of(reach, pair.place)
        names, pairs, left = [], len(slaves) * len(masters), []
        for slave, first in slaves.items():
            for master, second in masters.items():
                sides = {"First": f"{slave}/{first}", "Second": f"{master}/{second}"}
                if pairs > 1 and not self.are_near((slave, first), (master, second)):
                    left.append(" and ".join(sides.values()))
                    continue
                names.append(self.add_effect(kind, name, **sides, **more))
        if not names:
            raise ValueError(f"{pair.place}: no part of {pair.slave} is near to one of {pair.master}")
        if left:
            self.notes.append(f"{pair.place}: too far apart to meet, and left out: {', '.join(left)}")
        return names

    def are_near(self, first, second):
        """Whether two parts, each (body, part), may meet: boxes around them, wider by a tenth."""
        boxes = []
        for part in (first, second):
            places = np.array([self.model.nodes[n] for face in self.members[part] for n in face])
            margin = 0.1 * np.ptp(places, axis=0).max()
            boxes.append((places.min(axis=0) - margin, places.max(axis=0) + margin))
        (low, high), (least, most) = boxes
        return bool(np.all(low <= most) and np.all(least <= high))

    def surface(self, name, place):
        surface = self.model.surfaces.get(name)
        if surface is None:
            raise ValueError(f"{place}: there is no surface \"{name}\"")
        faces = surface.faces
        if surface.nodes is not None:
            faces = self.faces_within(set(surface.nodes))
            if not faces:
                raise ValueError(f"{place}: no face has all of its nodes in the surface \"{name}\"")
        return self.side_part(faces, name)

    def faces_within(self, nodes):
        """Faces on the boundary, all of whose nodes are among these."""
        sharers = defaultdict(list)
        for element in self.body_of_element:
            block, _ = self.model.typeOf[element]
            for face in range(len(TYPES[block.type].sides)):
                members = self.model.face_nodes(element, face)
                if nodes.issuperset(members):
                    sharers[frozenset(members)].append((element, face))
        return [faces[0] for faces in sharers.values() if len(faces) == 1]


def write_mesh(conversion, path):
    """Gmsh's format 2.2: each group an entity of its own; an element of two groups is there twice."""
    mesh, model = conversion.mesh, conversion.model
    groups, elements = [], []

    def add(dimension, name, rows):
        tag = len(groups) + 1
        groups.append(f'{dimension} {tag} "{name}"')
        for type_, nodes in rows:
            members = " ".join(map(str, nodes))
            elements.append(f"{len(elements) + 1} {type_} 2 {tag} {tag} {members}")

    dimension = 3 if conversion.physics == "solid" else 2
    for name, (type_, rows) in mesh.cells.items():
        kind = TYPES[type_]
        add(dimension, name, [(kind.gmsh, [row[k] for k in kind.order]) for row in rows])
    for name, faces in mesh.sides.items():
        add(dimension - 1, name, [(side_type(dimension, face), face) for face in faces])
    for name, nodes in mesh.points.items():
        add(0, name, [(15, [node]) for node in nodes])
    used = sorted(conversion.body_of_node)
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
        "Materials": conversion.materials,
        "Bodies": {},
    }
    for body in conversion.bodies:
        sections = [section for section, _ in body.regions.values()]
        entry = {"Materials": [conversion.material_name(section) for section in sections]}
        if len(sections) > 1:
            entry["Groups"] = body.groups
        entry["Expert"] = {"Dilatation": "full"}  # as the model's elements have it
        if body.reduced:
            entry["Expert"]["Integration"] = "reduced"
            entry["Subdomains"] = 1
        deck["Bodies"][body.name] = entry
    if conversion.histories or len(conversion.model.steps) > 1:
        ends = conversion.step_ends()
        times = set(ends.tolist())
        for points in conversion.histories:  # but for those of jumps, next to the end of a step
            times |= {t for t, _ in points if t > 0.0 and np.abs(ends - t).min() > 1e-8 * ends[-1]}
        deck["Steps"] = {"Times": sorted(times), "Histories": {}}
        for points, name in conversion.histories.items():
            deck["Steps"]["Histories"][name] = {
                "Times": [t for t, _ in points],
                "Values": [value for _, value in points],
            }
    deck["Effects"] = dict(conversion.effects)
    return {"harmos": deck}


def write_deck(conversion, path, mesh_file):
    name = conversion.name.replace("--", "- -")  # which no comment may have
    head = f"<!-- From the model {name}, by harmos-inp. -->"
    lines = [head, *_lines(deck_of(conversion, mesh_file), 0), ""]
    path.write_text("\n".join(lines), encoding="utf-8")
