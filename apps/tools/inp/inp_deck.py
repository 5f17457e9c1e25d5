# SPDX-License-Identifier: BSD-3-Clause
"""A deck and a mesh of Harmos, made from the model of another program's input."""

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np
from inp_cuts import cut_bolt
from inp_file import InpError, number_of
from inp_history import History
from inp_materials import Materials
from inp_model import TYPES
from inp_parts import Parts, safe

AXES = "xyz"
TOUCHING = 1e-300  # ADJUST=0: of surfaces that overlap alone; 0 is none for Harmos


@dataclass
class Body:
    """Elements that hang together by nodes."""

    name: str
    blocks: list  # (type, numbers, nodes) of its elements
    regions: dict = field(default_factory=dict)  # section -> elements
    groups: list = field(default_factory=list)  # of the mesh file, one for each region

    @property
    def elements(self):
        """The types of its elements."""
        return [TYPES[type_] for type_, _, _ in self.blocks]


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
        self.bodies, self.effects = [], defaultdict(dict)
        self.parts, self.materials, self.history = Parts(model), Materials(model), History(model)
        self.cuts, self.free_nodes = {}, {}  # by node of a pretension; series of (node, dof) without elements
        self.physics, self.thickness, self.kinematics = "", 1.0, "small"
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
            self.make_velocities,
            self.choose_kinematics,
        ):
            try:
                make()
            except ValueError as error:
                self.faults += str(error).split("\n")
            if self.faults and make in (self.make_cuts, self.make_bodies, self.make_materials):
                break  # what follows needs them
        if self.faults:
            raise InpError(self.faults)

    def make_cuts(self):
        for pretension in self.model.pretensions:
            self.cuts[pretension.node] = cut_bolt(self.model, pretension)

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
        elements = np.concatenate([numbers for _, numbers, _ in pieces])
        if len({TYPES[type_].reduced for type_, _, _ in pieces if TYPES[type_].has_choice}) > 1:
            names = ", ".join(sorted({type_ for type_, _, _ in pieces if TYPES[type_].has_choice}))
            raise ValueError(f"elements of full and of reduced integration ({names}) share nodes, which is not supported")
        body = Body(self.body_name(set(elements.tolist()), count), pieces)
        self.parts.add_body(body)
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
            for type_, numbers, nodes in body.blocks:
                for number, row in zip(numbers.tolist(), nodes.tolist()):
                    section = section_of.get(number)
                    if section is None:
                        raise ValueError(f"element {number} has no *SOLID SECTION")
                    body.regions.setdefault(section.place, (section, []))[1].append((type_, row))
            for k, (section, rows) in enumerate(body.regions.values(), 1):
                group, taken = body.name if len(body.regions) == 1 else f"{body.name}_{k}", self.parts.mesh.cells
                while group in taken or group != body.name and group in {b.name for b in self.bodies}:
                    group += "_"
                self.parts.mesh.cells[group] = rows
                body.groups.append(group)
        thickness = {s.thickness for body in self.bodies for s, _ in body.regions.values()}
        if self.physics in ("plane strain", "plane stress"):
            if len(thickness) > 1 and (self.model.contacts or self.model.ties):
                raise ValueError("plane sections of several thicknesses, and contacts, are not supported")
            if len(thickness) == 1:
                self.thickness = thickness.pop()
            if self.thickness != 1.0:
                self.notes.append(
                    f"thickness {self.thickness:g}: forces are divided by it, since Harmos' plane bodies have "
                    "the thickness 1"
                )

    def make_materials(self):
        for body in self.bodies:
            for section, _ in body.regions.values():
                try:
                    self.materials.add(section)
                except ValueError as error:
                    self.faults.append(str(error))
        self.notes += self.materials.notes

    def add_effect(self, kind, name, **parameters):
        effects, k, unique = self.effects[kind], 2, safe(name)
        while unique in effects:
            unique, k = f"{safe(name)}_{k}", k + 1
        effects[unique] = {key.replace("_", " "): value for key, value in parameters.items() if value != ""}
        return unique

    # Local axes of nodes.

    def axes(self, node):
        """Rows are the directions of the dofs of a node; None: those of the coordinates."""
        if node not in self.model.transforms:
            return None
        kind, numbers = self.model.transforms[node]
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
        for (node, dof), points in self.history.series("boundary").items():
            if node not in self.parts.body_of_node:
                self.free_nodes[node, dof] = points  # of equations
            elif dof <= dofs:
                held[node][dof] = points
        groups = defaultdict(list)
        for node, values in held.items():
            if self.axes(node) is not None:
                self.hold_along(node, values)
                continue
            known = {dof: self.history.of(points) for dof, points in values.items()}
            for history in {h for _, h in known.values()}:
                chosen = tuple(sorted((d, v) for d, (v, h) in known.items() if h == history))
                groups[chosen, history].append(node)
        for (chosen, history), nodes in groups.items():
            value = [0.0, 0.0, 0.0]
            for dof, size in chosen:
                value[dof - 1] = size
            components = "".join(AXES[dof - 1] for dof, _ in chosen)
            for body, part in self.parts.of_nodes(nodes, "held_" + components).items():
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
            self.add_equation(self.terms(node, dof), *self.history.of(points), "local_axes")

    def add_equation(self, terms, value, history, name):
        """With a history, equations of each are an effect of its own."""
        texts = []
        for node, component, factor in terms:
            (body, part), *_ = self.parts.of_nodes([node], f"n{node}").items()
            texts.append(f"{factor!r} {body}/{part} {AXES[component]}")
        name = f"{name}_{history}" if history else name
        effect = self.effects["Linear constraint"].setdefault(name, {"Equations": [], "Values": []})
        if history:
            effect["History"] = history
        effect["Equations"].append("; ".join(texts))
        effect["Values"].append(value)

    def make_forces(self):
        loads = defaultdict(dict)
        for (node, dof), points in self.history.series("cload").items():
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
                size, history = self.history.of(points)
                direction = axes[dof - 1] if axes is not None else np.eye(3)[dof - 1]
                by_history[history] = by_history[history] + size / self.thickness * direction
            for history, force in by_history.items():
                if np.any(force):
                    groups[tuple(force.tolist()), history].append(node)
        for (force, history), nodes in groups.items():
            for body, part in self.parts.of_nodes(nodes, "loaded").items():
                self.add_effect(
                    "Force", "force", Part=f"{body}/{part}", Force=list(force), History=history
                )

    def pull_cut(self, node, points):
        size, history = self.history.of(points)
        for part, force in self.cuts[node].forces(size / self.thickness):
            for body, name in self.parts.of_nodes([part], f"n{part}").items():
                self.add_effect(
                    "Force", f"pretension_{node}", Part=f"{body}/{name}", Force=force.tolist(), History=history
                )

    def make_distributed(self):
        pressures, turning = defaultdict(list), {}
        for key, points in self.history.series("dload").items():
            if key[0] == "P":
                size, history = self.history.of(points)
                if size != 0.0:
                    pressures[size, history].append(key[1])
                    self.parts.require_outer(key[1])
                continue
            for body in self.add_volume_force(key, points):
                if key[0] == "CENTRIF" and turning.setdefault(body, key) != key:
                    raise ValueError(f"body {body} has two CENTRIF loads, which is not supported")
        for (size, history), faces in pressures.items():
            for body, part in self.parts.of_faces(faces, "pressed").items():
                self.add_effect(
                    "Traction", "pressure", Part=f"{body}/{part}", Pressure=size, History=history
                )

    def add_volume_force(self, key, points):
        """GRAV or CENTRIF on the bodies of a set of elements; their names."""
        label, elements, bodies = key[0], set(key[1]), []
        size, history = self.history.of(points)
        for body in self.bodies:
            own = {int(n) for _, numbers, _ in body.blocks for n in numbers}
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
        rises = self.history.series("temperature")
        for body in self.bodies:
            if not any(self.model.materials[s.material].expansion for s, _ in body.regions.values()):
                continue
            nodes = {int(n) for _, _, rows in body.blocks for n in rows.ravel()}
            known = set()
            for node in nodes:
                start = self.model.initial.get(node, 0.0)
                points = rises.get((node,), [(0.0, start)])
                known.add(tuple((float(t), float(value) - start) for t, value in points))
            if len({points[-1][1] for points in known}) > 1 and self.history.is_one_state():
                self.add_temperature_field(body, nodes, rises)
                continue
            if len(known) > 1 and not self.history.is_one_state():
                raise ValueError(f"body {body.name}: temperatures that vary within a body and over steps are not supported")
            points = [(0.0, 0.0)] + [p for p in known.pop() if p[0] > 0.0]
            size, history = self.history.of(points)
            if size != 0.0:
                self.add_effect(
                    "Thermal strain", f"temperature_{body.name}", Body=body.name, Temperature=size, History=history
                )

    def add_temperature_field(self, body, nodes, rises):
        values = self.parts.mesh.fields.setdefault("temperature", {})
        for node in nodes:
            start = self.model.initial.get(node, 0.0)
            points = rises.get((node,))
            values[node] = float(points[-1][1]) - start if points else 0.0
        self.add_effect("Thermal strain", f"temperature_{body.name}", Body=body.name, Field="temperature")

    def make_equations(self):
        for node, cut in self.cuts.items():
            points = self.free_nodes.get((node, 1))
            shift, history = self.history.of(points) if points is not None else (None, "")
            for terms, value in cut.equations(3 if self.physics == "solid" else 2, shift):
                self.add_equation(terms, value, history if value != 0.0 else "", f"pretension_{node}")
        for equation in self.model.equations:
            terms, prescribed = [], []
            for node, dof, factor in equation.terms:
                if node in self.parts.body_of_node:
                    terms += self.terms(node, dof, factor)
                    continue
                points = self.free_nodes.get((node, dof))
                if points is None:
                    raise ValueError(
                        f"{equation.place}: node {node} belongs to no element and is not prescribed, which is "
                        "not supported"
                    )
                prescribed.append((-factor, points))
            if terms:
                self.add_equation(terms, *self.history.of_sum(prescribed), "equations")

    def name_sets(self):
        """All node sets and surfaces become boundary parts, whether something acts on them or not."""
        for name, nodes in self.model.nsets.items():
            self.parts.of_nodes([node for node in nodes if node in self.parts.body_of_node], name)
        for name, surface in self.model.surfaces.items():
            self.parts.of_faces(surface.faces, name)

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
            gaps = {"Stiffness": soft, "Adjust": self.adjust(pair)}
            if (pair.slave, pair.master) in self.model.clearances:  # whatever the distance is
                gaps |= {"Adjust": self.extent(), "Gap": self.model.clearances[pair.slave, pair.master]}
            for name in self.couple("Contact", "contact", pair, **gaps):
                if interaction.friction:
                    self.add_effect("Friction", name, Contact=name, Coefficient=interaction.friction)

    def make_velocities(self):
        for body in self.bodies:
            nodes = {int(n) for _, _, rows in body.blocks for n in rows.ravel()}
            velocity = self.model.motion.of_body(body.name, nodes)
            if velocity is not None:
                self.add_effect("Initial velocity", body.name, Body=body.name, Velocity=velocity)

    def choose_kinematics(self):
        """NLGEOM of any step is that of all."""
        if not self.model.nlgeom:
            return
        self.kinematics = "finite"
        if self.model.pretensions:
            self.notes.append(
                f"{self.model.nlgeom}: NLGEOM beside a pretension: bolts keep the direction that they have at rest"
            )

    def extent(self):
        return float(np.linalg.norm(np.ptp(list(self.model.nodes.values()), axis=0)))

    def adjust(self, pair):
        """Distances up to this are zero; "": they stay."""
        text = pair.options.get("ADJUST", "")
        try:
            return max(float(text), TOUCHING) if text else ""
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
                if pairs > 1 and not self.parts.are_near((slave, first), (master, second)):
                    left.append(" and ".join(sides.values()))
                    continue
                names.append(self.add_effect(kind, name, **sides, **more))
        if not names:
            raise ValueError(f"{pair.place}: no part of {pair.slave} is near to one of {pair.master}")
        if left:
            self.notes.append(f"{pair.place}: too far apart to meet, and left out: {', '.join(left)}")
        return names

    def surface(self, name, place):
        surface = self.model.surfaces.get(name)
        if surface is None:
            raise ValueError(f"{place}: there is no surface \"{name}\"")
        faces = surface.faces
        if surface.nodes is not None:
            faces = self.parts.faces_within(set(surface.nodes))
            if not faces:
                raise ValueError(f"{place}: no face has all of its nodes in the surface \"{name}\"")
        return self.parts.of_faces(faces, name)
