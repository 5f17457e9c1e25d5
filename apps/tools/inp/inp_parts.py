# SPDX-License-Identifier: BSD-3-Clause
"""Boundary parts of the bodies: groups of the mesh file, with names of their own."""

import re
from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np
from inp_model import TYPES


@dataclass
class Mesh:
    """Named groups of the mesh file: cells, sides by their nodes, and nodes."""

    cells: dict = field(default_factory=dict)  # group -> list of (type, nodes)
    sides: dict = field(default_factory=dict)  # group -> list of nodes of faces
    points: dict = field(default_factory=dict)  # group -> nodes
    fields: dict = field(default_factory=dict)  # name -> {node: value}


def safe(name):
    """A name that decks admit."""
    return re.sub(r"[^A-Za-z0-9_.+-]", "_", name)


class Parts:
    """Names sets of nodes and faces, by body."""

    def __init__(self, model):
        self.model, self.mesh = model, Mesh()
        self.body_of_element, self.body_of_node = {}, {}
        self.names, self.members = {}, {}  # by their members; members by (body, name)
        self.sharers = None  # of faces

    def add_body(self, body):
        for _, numbers, nodes in body.blocks:
            self.body_of_element.update((number, body) for number in numbers.tolist())
            self.body_of_node.update((node, body) for node in nodes.ravel().tolist())

    def of_nodes(self, nodes, hint):
        """{body: part} of a set of nodes."""
        return self.named(self.mesh.points, sorted(set(nodes)), lambda n: self.body_of_node.get(n), hint)

    def of_faces(self, faces, hint):
        """{body: part} of faces (element, face)."""
        sides = sorted({self.model.face_nodes(*face): face for face in faces}.items())
        owner = {nodes: self.body_of_element[face[0]] for nodes, face in sides}
        return self.named(self.mesh.sides, [nodes for nodes, _ in sides], owner.get, hint)

    def named(self, groups, members, body_of, hint):
        by_body = defaultdict(list)
        for member in members:
            body = body_of(member)
            if body is None:
                raise ValueError(f"node {member} belongs to no element, which is not supported here")
            by_body[body.name].append(member)
        result = {}
        for body, own in by_body.items():
            key = (id(groups), body, tuple(own))
            if key not in self.names:
                taken = set(self.names.values())
                name, k = safe(hint), 2
                while (body, name) in taken or name in self.mesh.cells:
                    name, k = f"{safe(hint)}_{k}", k + 1
                self.names[key] = (body, name)
                self.members[body, name] = own
                groups.setdefault(name, []).extend(own)
            result[body] = self.names[key][1]
        return result

    def require_outer(self, face):
        """Faces inside of a body have no pressure in Harmos."""
        if self.sharers is None:
            self.sharers = defaultdict(int)
            for element in self.body_of_element:
                block, _ = self.model.block_of[element]
                for number in range(len(TYPES[block.type].sides)):
                    self.sharers[frozenset(self.model.face_nodes(element, number))] += 1
        if self.sharers[frozenset(self.model.face_nodes(*face))] > 1:
            raise ValueError(f"element {face[0]}, face {face[1] + 1}: a pressure inside of a body is not supported")

    def are_near(self, first, second):
        """Whether two parts, each (body, part), may meet: boxes around them, wider by a tenth."""
        boxes = []
        for part in (first, second):
            places = np.array([self.model.nodes[n] for face in self.members[part] for n in face])
            margin = 0.1 * np.ptp(places, axis=0).max()
            boxes.append((places.min(axis=0) - margin, places.max(axis=0) + margin))
        (low, high), (least, most) = boxes
        return bool(np.all(low <= most) and np.all(least <= high))

    def faces_within(self, nodes):
        """Faces on the boundary, all of whose nodes are among these."""
        sharers = defaultdict(list)
        for element in self.body_of_element:
            block, _ = self.model.block_of[element]
            for face in range(len(TYPES[block.type].sides)):
                members = self.model.face_nodes(element, face)
                if nodes.issuperset(members):
                    sharers[frozenset(members)].append((element, face))
        return [faces[0] for faces in sharers.values() if len(faces) == 1]
