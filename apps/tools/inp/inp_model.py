# SPDX-License-Identifier: BSD-3-Clause
"""The model that an input of CalculiX or Abaqus describes: nodes, elements, sets, sections, steps."""

from dataclasses import dataclass, field

import numpy as np
from inp_file import InpError, number_of
from inp_motion import Motion


@dataclass(frozen=True)
class ElementType:
    """An element of a keyword's TYPE, and what it is here."""

    dimension: int
    nodes: int
    gmsh: int  # its number in Gmsh's files
    order: tuple  # Gmsh's node k is this node
    sides: tuple  # of each face S1, S2, ...: its nodes, corners first
    physics: str = "solid"
    reduced: bool = False

    @property
    def has_choice(self):
        """Whether Harmos' element of these nodes knows a reduced integration."""
        return self.nodes in (6, 15, 20) and self.dimension == 3 or self.nodes == 8 and self.dimension == 2

    @property
    def has_mechanisms(self):
        """Whether single elements have motions without energy that are not rigid."""
        return self.reduced and self.nodes != 15


TETRA = ((0, 1, 2, 4, 5, 6), (0, 3, 1, 7, 8, 4), (1, 3, 2, 8, 9, 5), (2, 3, 0, 9, 7, 6))
HEXA = (
    (0, 1, 2, 3, 8, 9, 10, 11),
    (4, 7, 6, 5, 15, 14, 13, 12),
    (0, 4, 5, 1, 16, 12, 17, 8),
    (1, 5, 6, 2, 17, 13, 18, 9),
    (2, 6, 7, 3, 18, 14, 19, 10),
    (3, 7, 4, 0, 19, 15, 16, 11),
)
WEDGE = (
    (0, 1, 2, 6, 7, 8),
    (3, 5, 4, 11, 10, 9),
    (0, 3, 4, 1, 12, 9, 13, 6),
    (1, 4, 5, 2, 13, 10, 14, 7),
    (2, 5, 3, 0, 14, 11, 12, 8),
)
WEDGE_15 = (0, 1, 2, 3, 4, 5, 6, 8, 12, 7, 13, 14, 9, 11, 10)
TRIANGLE = ((0, 1, 3), (1, 2, 4), (2, 0, 5))
QUADRILATERAL = ((0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7))
HEXA_20 = (0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14)
GMSH_SIDES = {2: 1, 3: 8, (3, 3): 2, (3, 6): 9, (4, 4): 3, (4, 8): 16}


def _corners(sides, count):
    return tuple(side[:count] for side in sides)


def _types():
    tetra4, hexa8 = _corners(TETRA, 3), _corners(HEXA, 4)
    types = {
        "C3D4": ElementType(3, 4, 4, tuple(range(4)), tetra4),
        "C3D10": ElementType(3, 10, 11, (0, 1, 2, 3, 4, 5, 6, 7, 9, 8), TETRA),
        "C3D6": ElementType(3, 6, 6, tuple(range(6)), tuple(side[: len(side) // 2] for side in WEDGE), reduced=True),
        "C3D15": ElementType(3, 15, 18, WEDGE_15, WEDGE, reduced=True),  # 9 points
        "C3D8": ElementType(3, 8, 5, tuple(range(8)), hexa8),
        "C3D20": ElementType(3, 20, 17, HEXA_20, HEXA),
        "C3D20R": ElementType(3, 20, 17, HEXA_20, HEXA, reduced=True),
    }
    for prefix, physics in (("CPE", "plane strain"), ("CPS", "plane stress"), ("CAX", "axisymmetric")):
        types[prefix + "3"] = ElementType(2, 3, 2, (0, 1, 2), _corners(TRIANGLE, 2), physics)
        types[prefix + "6"] = ElementType(2, 6, 9, tuple(range(6)), TRIANGLE, physics)
        types[prefix + "4"] = ElementType(2, 4, 3, (0, 1, 2, 3), _corners(QUADRILATERAL, 2), physics)
        types[prefix + "8"] = ElementType(2, 8, 16, tuple(range(8)), QUADRILATERAL, physics)
        types[prefix + "8R"] = ElementType(
            2, 8, 16, tuple(range(8)), QUADRILATERAL, physics, reduced=True
        )
    return types


TYPES = _types()


@dataclass
class Block:
    """Elements of one *ELEMENT."""

    type: str
    numbers: np.ndarray
    nodes: np.ndarray  # (elements, nodes)


@dataclass
class Surface:
    faces: list = field(default_factory=list)  # (element, face from 0)
    nodes: list = None  # where it is made of nodes


@dataclass
class Material:
    place: str
    elastic: dict = None
    expansion: tuple = None
    density: float = None
    plastic: dict = None


@dataclass
class Section:
    place: str
    elset: str
    material: str
    orientation: str = ""
    thickness: float = 1.0


@dataclass
class Interaction:
    behaviour: str = "HARD"
    stiffness: float = 0.0
    friction: float = None


@dataclass
class Pair:
    place: str
    interaction: str
    slave: str
    master: str
    options: dict = field(default_factory=dict)


@dataclass
class Pretension:
    """A cut through a bolt at faces of elements; the force or the shift is that of dof 1 of a node."""

    place: str
    surface: str
    node: int
    direction: tuple = None


@dataclass
class Step:
    """What a step changes: lists of (place, what)."""

    place: str
    period: float = 1.0
    is_static: bool = False
    boundary: list = field(default_factory=list)
    cload: list = field(default_factory=list)
    dload: list = field(default_factory=list)
    temperature: list = field(default_factory=list)
    resets: set = field(default_factory=set)  # kinds of loads that OP=NEW removes
    seen: set = field(default_factory=set)  # kinds of loads that the step has


@dataclass
class Equation:
    place: str
    terms: list  # (node, dof from 1, coefficient)


@dataclass
class Model:
    nodes: dict = field(default_factory=dict)  # number -> (x, y, z)
    blocks: list = field(default_factory=list)
    nsets: dict = field(default_factory=dict)
    elsets: dict = field(default_factory=dict)
    surfaces: dict = field(default_factory=dict)
    materials: dict = field(default_factory=dict)
    sections: list = field(default_factory=list)
    orientations: dict = field(default_factory=dict)
    interactions: dict = field(default_factory=dict)
    contacts: list = field(default_factory=list)
    clearances: dict = field(default_factory=dict)  # (slave, master) -> gap
    ties: list = field(default_factory=list)
    pretensions: list = field(default_factory=list)
    equations: list = field(default_factory=list)
    transforms: dict = field(default_factory=dict)  # node -> (type, six numbers)
    amplitudes: dict = field(default_factory=dict)
    initial: dict = field(default_factory=dict)  # temperature of nodes
    motion: Motion = field(default_factory=Motion)
    steps: list = field(default_factory=list)
    notes: list = field(default_factory=list)
    nlgeom: str = ""  # where it is asked for first
    block_of: dict = field(default_factory=dict)  # number of an element -> (block, row)

    def node_list(self, text, place):
        """Nodes of a set, or the one of a number."""
        if text.isdigit() and int(text) in self.nodes:
            return [int(text)]
        if text in self.nsets:
            return self.nsets[text]
        raise ValueError(f"{place}: there is no node {'' if text.isdigit() else 'set '}\"{text}\"")

    def element_list(self, text, place):
        if text.isdigit() and int(text) in self.block_of:
            return [int(text)]
        if text in self.elsets:
            return [e for e in self.elsets[text] if e in self.block_of]  # others are faults already
        raise ValueError(f"{place}: there is no element {'' if text.isdigit() else 'set '}\"{text}\"")

    def face_nodes(self, element, face):
        """Nodes of a face, corners first."""
        block, row = self.block_of[element]
        return tuple(int(n) for n in block.nodes[row][list(TYPES[block.type].sides[face])])


# Keywords that change nothing of what is computed here.
IGNORED = (
    "HEADING NODEPRINT ELPRINT NODEFILE ELFILE CONTACTFILE CONTACTPRINT NODEOUTPUT ELEMENTOUTPUT CONTACTOUTPUT "
    "OUTPUT SECTIONPRINT FACEPRINT PREPRINT PHYSICALCONSTANTS TIMEPOINTS CONTROLS SPECIFICHEAT CONDUCTIVITY ENDSTEP"
).split()

# Options that are taken, or change nothing here; others are faults, for they may change the model.
OPTIONS = {
    "NODE": "NSET SYSTEM",
    "ELEMENT": "TYPE ELSET",
    "NSET": "NSET GENERATE ELSET",
    "ELSET": "ELSET GENERATE",
    "SURFACE": "NAME TYPE",
    "MATERIAL": "NAME",
    "ELASTIC": "TYPE",
    "EXPANSION": "TYPE ZERO",
    "PLASTIC": "HARDENING",
    "DENSITY": "",
    "SOLIDSECTION": "ELSET MATERIAL ORIENTATION OFFSET",  # OFFSET: of shells
    "ORIENTATION": "NAME SYSTEM DEFINITION",
    "SURFACEINTERACTION": "NAME",
    "SURFACEBEHAVIOR": "PRESSURE-OVERCLOSURE",
    "FRICTION": "",
    "CONTACTPAIR": "INTERACTION TYPE ADJUST SMALLSLIDING",
    "CLEARANCE": "MASTER SLAVE VALUE",
    "TIE": "NAME POSITIONTOLERANCE ADJUST TYPE CYCLICSYMMETRY MULTISTAGE",
    "PRETENSIONSECTION": "SURFACE NODE",
    "EQUATION": "",
    "TRANSFORM": "NSET TYPE",
    "AMPLITUDE": "NAME TIME TOTALTIME DEFINITION",
    "INITIALCONDITIONS": "TYPE",
    "STEP": "NAME NLGEOM INC INCF PERTURBATION",
    "STATIC": "SOLVER DIRECT",
    "DYNAMIC": "SOLVER DIRECT ALPHA EXPLICIT",
    "BOUNDARY": "OP AMPLITUDE FIXED USER SUBMODEL",
    "CLOAD": "OP AMPLITUDE USER SECTOR",
    "DLOAD": "OP AMPLITUDE",
    "DSLOAD": "OP AMPLITUDE",
    "TEMPERATURE": "AMPLITUDE FILE USER",
}


class Reader:
    """Makes a model of keywords; what it does not take is a fault with its line."""

    def __init__(self):
        self.model = Model()
        self.faults = []
        self.material = None
        self.interaction = None
        self.step = None
        self.before = []  # prescribed before the first step
        self.takers = {
            name[5:].replace("_", "").upper(): getattr(self, name) for name in dir(self) if name.startswith("take_")
        }

    def read(self, keywords):
        for keyword in keywords:
            method = self.takers.get(keyword.key)
            try:
                if method is not None:
                    self.check_options(keyword)
                    method(keyword)
                elif keyword.key not in IGNORED:
                    self.faults.append(f"{keyword.place}: *{keyword.name} is not supported")
            except (ValueError, OverflowError) as error:
                self.faults.append(str(error))
        if not self.model.blocks and not self.faults:
            self.faults.append("the input has no elements")
        if not self.model.steps and not self.faults:
            self.faults.append("the input has no *STEP")
        if self.faults:
            raise InpError(self.faults)
        return self.model

    @staticmethod
    def check_options(keyword):
        for option in keyword.options:
            if option.replace(" ", "") not in OPTIONS[keyword.key].split():
                raise ValueError(f"{keyword.place}: the option {option} of *{keyword.name} is not supported")

    # Geometry.

    def take_node(self, keyword):
        if keyword.option("SYSTEM", "R") != "R":
            raise ValueError(f"{keyword.place}: *NODE with SYSTEM={keyword.option('SYSTEM')} is not supported")
        numbers = []
        for row in keyword.rows:
            number = row.integer(0)
            if number < 1:
                raise ValueError(f"{row.place}: nodes have numbers from 1 on")
            self.model.nodes[number] = tuple(row.number(k, 0.0) for k in (1, 2, 3))
            numbers.append(number)
        if keyword.option("NSET"):
            self.model.nsets.setdefault(keyword.option("NSET"), []).extend(numbers)

    def take_element(self, keyword):
        name = keyword.option("TYPE")
        if name not in TYPES:
            raise ValueError(f"{keyword.place}: element type {name or '(none)'} is not supported")
        size = TYPES[name].nodes
        values = []
        for row in keyword.rows:
            values += [row.integer(k) for k in range(len(row.texts)) if row.texts[k] != ""]
        if len(values) % (size + 1) != 0:
            raise ValueError(
                f"{keyword.place}: {len(values)} numbers are no whole number of elements {name}, each of "
                f"which has {size + 1}"
            )
        if not values:
            raise ValueError(f"{keyword.place}: *ELEMENT without elements")
        table = np.array(values, dtype=np.int64).reshape(-1, size + 1)
        block = Block(name, table[:, 0], table[:, 1:])
        unknown = set(block.nodes.ravel().tolist()) - set(self.model.nodes)
        if unknown:
            raise ValueError(f"{keyword.place}: elements have the node {min(unknown)}, which does not exist")
        for row, number in enumerate(block.numbers.tolist()):
            if len(set(block.nodes[row].tolist())) < size:
                raise ValueError(f"{keyword.place}: element {number} has a node twice, which is not supported")
            if number in self.model.block_of:
                raise ValueError(f"{keyword.place}: element {number} is there twice")
            self.model.block_of[number] = (block, row)
        self.model.blocks.append(block)
        if keyword.option("ELSET"):
            self.model.elsets.setdefault(keyword.option("ELSET"), []).extend(block.numbers.tolist())

    def _set(self, keyword, name, sets, known):
        if not name:
            raise ValueError(f"{keyword.place}: *{keyword.name} has no name")
        members = sets.setdefault(name, [])
        for row in keyword.rows:
            if "GENERATE" in keyword.options:
                first, last, by = row.integer(0), row.integer(1), row.integer(2, 1)
                members += [k for k in range(first, last + 1, max(1, by)) if k in known]
                continue
            for k, text in enumerate(row.texts):
                if text in sets and text != name:
                    members += sets[text]
                elif text:
                    members.append(row.integer(k))
        missing = [k for k in members if k not in known]
        if missing:
            raise ValueError(f"{keyword.place}: the set {name} has the member {missing[0]}, which does not exist")

    def take_nset(self, keyword):
        if keyword.option("ELSET"):
            elements = self.model.element_list(keyword.option("ELSET"), keyword.place)
            nodes = {int(n) for e in elements for n in self.model.block_of[e][0].nodes[self.model.block_of[e][1]]}
            self.model.nsets.setdefault(keyword.option("NSET"), []).extend(sorted(nodes))
            return
        self._set(keyword, keyword.option("NSET"), self.model.nsets, self.model.nodes)

    def take_elset(self, keyword):
        self._set(keyword, keyword.option("ELSET"), self.model.elsets, self.model.block_of)

    def take_surface(self, keyword):
        surface = Surface()
        if keyword.option("TYPE", "ELEMENT") == "NODE":
            surface.nodes = []
            for row in keyword.rows:
                surface.nodes += self.model.node_list(row.text(0), row.place)
        elif keyword.option("TYPE", "ELEMENT") == "ELEMENT":
            for row in keyword.rows:
                surface.faces += self._faces(row.text(0), row.text(1), row.place)
        else:
            raise ValueError(f"{keyword.place}: *SURFACE of TYPE={keyword.option('TYPE')} is not supported")
        self.model.surfaces[keyword.option("NAME")] = surface

    def _faces(self, elements, label, place):
        if len(label) != 2 or label[0] not in "SP" or not label[1].isdigit():
            raise ValueError(f"{place}: \"{label}\" is no face of an element; expected S1, S2, ...")
        faces = []
        for element in self.model.element_list(elements, place):
            count = len(TYPES[self.model.block_of[element][0].type].sides)
            if not 1 <= int(label[1]) <= count:
                raise ValueError(f"{place}: element {element} has no face {label}")
            faces.append((element, int(label[1]) - 1))
        return faces

    # Materials and sections.

    def take_material(self, keyword):
        self.material = Material(keyword.place)
        self.model.materials[keyword.option("NAME")] = self.material

    def _of_material(self, keyword):
        if self.material is None:
            raise ValueError(f"{keyword.place}: *{keyword.name} before the first *MATERIAL")
        if not keyword.rows:
            raise ValueError(f"{keyword.place}: *{keyword.name} without a line of data")
        if len({row.text(len(row.texts) - 1) for row in keyword.rows}) > 1 and keyword.name not in ("ELASTIC", "PLASTIC"):
            raise ValueError(f"{keyword.place}: *{keyword.name} that depends on temperature is not supported")
        return self.material

    def take_elastic(self, keyword):
        material = self._of_material(keyword)
        kind = keyword.option("TYPE", "ISOTROPIC")
        numbers = [row.number(k) for row in keyword.rows for k in range(len(row.texts)) if row.texts[k]]
        names = {"ISO": "ISOTROPIC", "ORTHO": "ORTHOTROPIC", "ANISO": "ANISOTROPIC"}
        kind = names.get(kind, kind)
        size = {"ISOTROPIC": 2, "ORTHOTROPIC": 9, "ENGINEERING CONSTANTS": 9, "ANISOTROPIC": 21}.get(kind)
        if size is None:
            raise ValueError(f"{keyword.place}: *ELASTIC of TYPE={kind} is not supported")
        if len(keyword.rows) > 1 + size // 8 or not size <= len(numbers) <= size + 1:
            raise ValueError(
                f"{keyword.place}: *ELASTIC has {len(numbers)} numbers, expected {size}; moduli that depend on "
                "temperature are not supported"
            )
        material.elastic = {"kind": kind, "numbers": numbers[:size], "place": keyword.place}

    def take_expansion(self, keyword):
        material = self._of_material(keyword)
        kind = keyword.option("TYPE", "ISO")
        row = keyword.rows[0]
        if kind not in ("ISO", "ORTHO") or len(keyword.rows) > 1:
            raise ValueError(
                f"{keyword.place}: *EXPANSION that is anisotropic or depends on temperature is not supported"
            )
        material.expansion = tuple(row.number(k if kind == "ORTHO" else 0) for k in range(3))
        number_of(keyword.option("ZERO") or "0", keyword.place)  # of no effect where expansion is constant

    def take_plastic(self, keyword):
        material = self._of_material(keyword)
        kind = keyword.option("HARDENING", "ISOTROPIC")
        temperatures = {row.text(2) for row in keyword.rows}
        if kind not in ("ISOTROPIC", "KINEMATIC") or len(temperatures) > 1:
            raise ValueError(
                f"{keyword.place}: *PLASTIC that is no curve of isotropic or linear kinematic hardening, or depends on "
                "temperature, is not supported"
            )
        points = [(row.number(1, 0.0), row.number(0)) for row in keyword.rows]
        if kind == "KINEMATIC" and len(points) > 2:
            raise ValueError(f"{keyword.place}: kinematic hardening by more than two points is not supported")
        material.plastic = {"kind": kind, "points": points, "place": keyword.place}

    def take_density(self, keyword):
        material = self._of_material(keyword)
        material.density = keyword.rows[0].number(0)

    def take_solid_section(self, keyword):
        row = keyword.rows[0] if keyword.rows else None
        self.model.sections.append(
            Section(
                keyword.place,
                keyword.option("ELSET"),
                keyword.option("MATERIAL"),
                keyword.option("ORIENTATION"),
                row.number(0, 1.0) if row is not None else 1.0,
            )
        )

    def take_orientation(self, keyword):
        known = keyword.option("SYSTEM", "RECTANGULAR") in ("RECTANGULAR", "R")
        if not known or len(keyword.rows) != 1 or keyword.option("DEFINITION", "COORDINATES") != "COORDINATES":
            raise ValueError(
                f"{keyword.place}: *ORIENTATION that is not rectangular, or turned besides, is not supported"
            )
        self.model.orientations[keyword.option("NAME")] = [keyword.rows[0].number(k) for k in range(6)]

    # Interactions.

    def take_surface_interaction(self, keyword):
        self.interaction = Interaction()
        self.model.interactions[keyword.option("NAME")] = self.interaction

    def take_surface_behavior(self, keyword):
        if self.interaction is None:
            raise ValueError(f"{keyword.place}: *SURFACE BEHAVIOR before *SURFACE INTERACTION")
        kind = keyword.option("PRESSURE-OVERCLOSURE", "HARD")
        if kind not in ("HARD", "LINEAR", "TIED"):
            raise ValueError(f"{keyword.place}: PRESSURE-OVERCLOSURE={kind} is not supported")
        self.interaction.behaviour = kind
        if kind == "LINEAR" and keyword.rows:
            self.interaction.stiffness = keyword.rows[0].number(0)

    def take_friction(self, keyword):
        if self.interaction is None or not keyword.rows:
            raise ValueError(f"{keyword.place}: *FRICTION without an interaction or without a coefficient")
        self.interaction.friction = keyword.rows[0].number(0)

    def take_contact_pair(self, keyword):
        for row in keyword.rows:
            self.model.contacts.append(
                Pair(row.place, keyword.option("INTERACTION"), row.text(0), row.text(1), keyword.options)
            )

    def take_clearance(self, keyword):
        pair = (keyword.option("SLAVE"), keyword.option("MASTER"))
        if pair not in {(known.slave, known.master) for known in self.model.contacts}:
            raise ValueError(f"{keyword.place}: there is no contact pair before of {pair[0]} and {pair[1]}")
        self.model.clearances[pair] = number_of(keyword.option("VALUE"), keyword.place)

    def take_tie(self, keyword):
        if keyword.option("TYPE", "SURFACETOSURFACE") not in ("SURFACETOSURFACE", "NODETOSURFACE"):
            raise ValueError(f"{keyword.place}: *TIE of TYPE={keyword.option('TYPE')} is not supported")
        if "CYCLIC SYMMETRY" in keyword.options or "MULTISTAGE" in keyword.options:
            raise ValueError(f"{keyword.place}: *TIE of cyclic symmetry is not supported")
        for row in keyword.rows:
            self.model.ties.append(Pair(row.place, "", row.text(0), row.text(1), keyword.options))

    def take_pre_tension_section(self, keyword):
        if not keyword.option("SURFACE") or not keyword.option("NODE"):
            raise ValueError(f"{keyword.place}: *PRE-TENSION SECTION needs SURFACE and NODE")
        direction = tuple(keyword.rows[0].number(k, 0.0) for k in range(3)) if keyword.rows else None
        node = (self.model.node_list(keyword.option("NODE"), keyword.place) or [0])[0]
        self.model.pretensions.append(Pretension(keyword.place, keyword.option("SURFACE"), node, direction))

    def take_equation(self, keyword):
        rows = iter(keyword.rows)
        for row in rows:
            count, terms = row.integer(0), []
            while len(terms) < count:
                data = next(rows, None)
                if data is None:
                    raise ValueError(f"{row.place}: an equation of {count} terms ends early")
                for k in range(0, len(data.texts) - 2, 3):
                    node = self.model.node_list(data.text(k), data.place)
                    if len(node) != 1:
                        raise ValueError(f"{data.place}: a term of an equation names a set of several nodes")
                    dof = data.integer(k + 1)
                    if not 1 <= dof <= 3:
                        raise ValueError(f"{data.place}: an equation of dof {dof} is not supported")
                    terms.append((node[0], dof, data.number(k + 2)))
            self.model.equations.append(Equation(row.place, terms[:count]))

    def take_transform(self, keyword):
        kind = keyword.option("TYPE", "R")
        if kind not in ("R", "C") or not keyword.rows:
            raise ValueError(f"{keyword.place}: *TRANSFORM of TYPE={kind} is not supported")
        nodes = self.model.node_list(keyword.option("NSET"), keyword.place)
        numbers = [keyword.rows[0].number(k) for k in range(6)]
        a, b = np.array(numbers[:3]), np.array(numbers[3:])
        if np.linalg.norm(np.cross(a, b) if kind == "R" else b - a) == 0.0:
            raise ValueError(f"{keyword.place}: *TRANSFORM has points that make no axes")
        self.model.transforms.update((node, (kind, numbers)) for node in nodes)

    def take_amplitude(self, keyword):
        numbers = [row.number(k) for row in keyword.rows for k in range(len(row.texts))]
        if keyword.option("DEFINITION", "TABULAR") != "TABULAR":
            raise ValueError(f"{keyword.place}: *AMPLITUDE of DEFINITION={keyword.option('DEFINITION')} is not supported")
        if "USER" in keyword.options or len(numbers) % 2 or not numbers:
            raise ValueError(f"{keyword.place}: *AMPLITUDE needs pairs of time and value")
        is_total = keyword.option("TIME") == "TOTALTIME" or "TOTAL TIME" in keyword.options
        # CalculiX keeps the first of two that have one name.
        self.model.amplitudes.setdefault(keyword.option("NAME"), (numbers[0::2], numbers[1::2], is_total))

    def take_initial_conditions(self, keyword):
        if keyword.option("TYPE") == "VELOCITY":
            self.model.motion.take_velocities(keyword, self.model)
            return
        if keyword.option("TYPE") != "TEMPERATURE":
            raise ValueError(
                f"{keyword.place}: *INITIAL CONDITIONS of TYPE={keyword.option('TYPE')} is not supported"
            )
        for row in keyword.rows:
            for node in self.model.node_list(row.text(0), row.place):
                self.model.initial[node] = row.number(1)

    # Steps.

    def take_step(self, keyword):
        self.step = Step(keyword.place)
        if "PERTURBATION" in keyword.options:
            raise ValueError(f"{keyword.place}: *STEP, PERTURBATION is not supported")
        if "NLGEOM" in keyword.options and keyword.option("NLGEOM") != "NO":
            self.model.nlgeom = self.model.nlgeom or keyword.place
        self.model.steps.append(self.step)

    def _of_step(self, keyword):
        if self.step is None:
            raise ValueError(f"{keyword.place}: *{keyword.name} outside of a step")
        return self.step

    def take_static(self, keyword):
        step = self._of_step(keyword)
        step.is_static = True
        if keyword.rows and len(keyword.rows[0].texts) > 1:
            step.period = keyword.rows[0].number(1, 1.0)

    def take_dynamic(self, keyword):
        self.model.motion.take(keyword, self._of_step(keyword))

    def reset(self, kind, keyword):
        """OP=NEW of the first keyword of a kind in a step counts alone."""
        step = self.step
        if step is not None and kind not in step.seen and keyword.option("OP") == "NEW":
            step.resets.add(kind)
        if step is not None:
            step.seen.add(kind)

    def _amplitude_of(self, keyword):
        name = keyword.option("AMPLITUDE")
        if name and name not in self.model.amplitudes:
            raise ValueError(f"{keyword.place}: there is no amplitude \"{name}\"")
        return name

    def take_boundary(self, keyword):
        for option in ("FIXED", "USER", "SUBMODEL"):
            if option in keyword.options:
                raise ValueError(f"{keyword.place}: *BOUNDARY, {option} is not supported")
        amplitude = self._amplitude_of(keyword)
        self.reset("boundary", keyword)
        entries = self.step.boundary if self.step is not None else self.before
        for row in keyword.rows:
            nodes = self.model.node_list(row.text(0), row.place)
            first = row.integer(1)
            if first < 1:
                raise ValueError(f"{row.place}: there is no dof {first}")
            for dof in range(first, row.integer(2, first) + 1):
                if dof <= 3:
                    entries += [(row.place, node, dof, row.number(3, 0.0), amplitude) for node in nodes]
                elif dof == 11:
                    raise ValueError(f"{row.place}: prescribed temperatures (dof 11) are not supported")

    def take_cload(self, keyword):
        step, amplitude = self._of_step(keyword), self._amplitude_of(keyword)
        if "USER" in keyword.options or "SECTOR" in keyword.options:
            raise ValueError(f"{keyword.place}: *CLOAD of a user or a sector is not supported")
        self.reset("cload", keyword)
        for row in keyword.rows:
            for node in self.model.node_list(row.text(0), row.place):
                step.cload.append((row.place, node, row.integer(1), row.number(2), amplitude))

    def take_dload(self, keyword):
        step, amplitude = self._of_step(keyword), self._amplitude_of(keyword)
        self.reset("dload", keyword)
        for row in keyword.rows:
            label = row.text(1)
            if label == "GRAV":
                elements = self.model.element_list(row.text(0), row.place)
                direction = np.array([row.number(k, 0.0) for k in (3, 4, 5)])
                direction = tuple((direction / (np.linalg.norm(direction) or 1.0)).tolist())
                step.dload.append((row.place, "GRAV", tuple(elements), direction, row.number(2), amplitude))
            elif label == "CENTRIF":
                elements = self.model.element_list(row.text(0), row.place)
                turning = tuple(row.number(k, 0.0) for k in range(3, 9))
                if row.number(2) < 0.0:
                    raise ValueError(f"{row.place}: the square of a speed is negative")
                step.dload.append((row.place, "CENTRIF", tuple(elements), turning, row.number(2), amplitude))
            elif len(label) == 2 and label[0] == "P" and label[1].isdigit():
                for face in self._faces(row.text(0), label, row.place):
                    step.dload.append((row.place, "P", face, row.number(2), amplitude))
            else:
                raise ValueError(f"{row.place}: the distributed load {label} is not supported")

    def take_dsload(self, keyword):
        step, amplitude = self._of_step(keyword), self._amplitude_of(keyword)
        self.reset("dload", keyword)
        for row in keyword.rows:
            surface = self.model.surfaces.get(row.text(0))
            if surface is None or surface.nodes is not None or row.text(1) != "P":
                raise ValueError(f"{row.place}: *DSLOAD needs a surface of faces and the load P")
            step.dload += [(row.place, "P", face, row.number(2), amplitude) for face in surface.faces]

    def take_temperature(self, keyword):
        step, amplitude = self._of_step(keyword), self._amplitude_of(keyword)
        if "FILE" in keyword.options or "USER" in keyword.options:
            raise ValueError(f"{keyword.place}: *TEMPERATURE from a file is not supported")
        for row in keyword.rows:
            for node in self.model.node_list(row.text(0), row.place):
                step.temperature.append((row.place, node, row.number(1), amplitude))


def read_model(keywords):
    """Raises InpError with every fault."""
    reader = Reader()
    model = reader.read(keywords)
    model.steps[0].boundary = reader.before + model.steps[0].boundary
    faults = [
        f"{step.place}: only steps of *STATIC and *DYNAMIC are supported"
        for step in model.steps
        if not step.is_static and not model.motion.there()
    ]
    faults += model.motion.faults(model)
    if faults:
        raise InpError(faults)
    return model
