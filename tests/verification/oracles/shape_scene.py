# SPDX-License-Identifier: BSD-3-Clause
r"""Blocks in contact for shape_optimum.py: their assembly, condensed to the contact, and the deck of the same scene.

Rectangles of quadrilaterals (Q1, plane strain, 2 x 2 points) that meet at nodes of the same place, or one on a rigid
half-plane, without friction.  With n outward from the first body the rows of B are (u_first - u_second) . n, at a rigid
half-plane u . n; a_r, the area of a contact point, is half of each edge beside it.

All dofs but the contact's are eliminated: with w = Bu

    min { 1/2 u'Ku - f'u : Bu = w } = J_0 + 1/2 w'Sw - g'w,

S symmetric and positive semidefinite, its kernel the motions of bodies that contact alone carries.  The multipliers of
Bu = w are the forces g - Sw.  S and g come from solves with the saddle-point matrix of Bu = w, one a contact point.
"""

from dataclasses import dataclass, field

import elastic_oracle
import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from contact_oracle import OracleError

SAME = 1e-9  # relative: coordinates of the same place
STILL = 1e-12  # square of the part of a rigid motion that is prescribed or moves the contact
FREE = 1e-9  # relative: eigenvalues of S that are those of its kernel

SIDES = {"left": (0, 0), "right": (0, 1), "bottom": (1, 0), "top": (1, 1)}  # axis across, which end
AXES = "xy"


@dataclass(frozen=True)
class Block:
    """A rectangle. cells along x and y: of all its subdomains together."""

    origin: tuple
    size: tuple
    cells: tuple
    young: float = 1.0
    poisson: float = 0.3  # at most 0.4: the program projects dilatation above

    def grid(self):
        """Points (n, 2), x slowest, and cells (m, 4) in VTK's order."""
        axes = [o + s * np.arange(n + 1) / n for o, s, n in zip(self.origin, self.size, self.cells)]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        number = np.arange(len(points)).reshape([n + 1 for n in self.cells])
        corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
        return points, np.stack([corner.ravel() for corner in corners], axis=1)


@dataclass(frozen=True)
class Part:
    """A side of a block, or of that side what lies between two coordinates along it, whole edges."""

    body: str
    side: str
    low: float = -np.inf
    high: float = np.inf

    @property
    def whole(self):
        return self.low == -np.inf and self.high == np.inf

    @property
    def name(self):
        return self.side if self.whole else f"{self.body} {self.side} {self.low:g} to {self.high:g}"


@dataclass(frozen=True)
class HalfPlane:
    """Rigid; direction is its outward normal, towards the body."""

    point: tuple
    direction: tuple = (0.0, 1.0)


@dataclass
class Scene:
    """What is pressed onto what.

    bodies    Block by name
    first     Part with the contact points
    second    Part opposite, whose nodes are at the same places, or a HalfPlane
    held      pairs of a Part and its prescribed displacements by axis, as {"x": 0.0}
    loads     pairs of a Part and the force per area along x and y
    gap       added to the distance of all contact points, of two bodies
    """

    bodies: dict
    first: Part
    second: object
    held: list = field(default_factory=list)
    loads: list = field(default_factory=list)
    gap: float = 0.0


class Mesh:
    """All blocks of a scene on one list of nodes."""

    def __init__(self, bodies):
        self.number = {name: k for k, name in enumerate(bodies)}
        self.blocks = bodies
        points, cells, body, shift = [], [], [], 0
        for name, block in bodies.items():
            p, c = block.grid()
            cells.append(elastic_oracle.Cells(9, c + shift, np.full(len(c), self.number[name])))
            points.append(p)
            body.append(np.full(len(p), self.number[name]))
            shift += len(p)
        self.body = np.concatenate(body)
        self.mesh = elastic_oracle.Mesh(np.concatenate(points), self.body, cells)
        self.extent = float(np.ptp(self.mesh.nodes, axis=0).max())

    def nodes_of(self, part):
        """In the order along the side, which has to begin and to end at nodes."""
        if part.body not in self.blocks or part.side not in SIDES:
            raise OracleError(f"shape: no part {part.body}/{part.side}; sides are {', '.join(SIDES)}")
        block, (axis, end) = self.blocks[part.body], SIDES[part.side]
        across = block.origin[axis] + end * block.size[axis]
        x, near = self.mesh.nodes, SAME * self.extent
        on = (self.body == self.number[part.body]) & (np.abs(x[:, axis] - across) <= near)
        on &= (x[:, 1 - axis] >= part.low - near) & (x[:, 1 - axis] <= part.high + near)
        nodes = np.flatnonzero(on)
        nodes = nodes[np.argsort(x[nodes, 1 - axis])]
        if len(nodes) < 2:
            raise OracleError(f"shape: no edge of {part.body}/{part.side} between {part.low:g} and {part.high:g}")
        return nodes

    def areas_of(self, part, nodes):
        """Half of each edge beside the node, of the edges in the part."""
        edges = np.diff(self.mesh.nodes[nodes, 1 - SIDES[part.side][0]])
        return 0.5 * (np.append(edges, 0.0) + np.append(0.0, edges))


def normal_of(part):
    axis, end = SIDES[part.side]
    return np.eye(2)[axis] * (2 * end - 1)


@dataclass
class Contact:
    """A scene condensed to the motions w of its m contact points, in the order along the contact.

    J(w) = constant + 1/2 w'Sw - g'w, forces g - Sw, displacements u_0 + Uw.
    """

    x: np.ndarray  # (m, 2) positions
    areas: np.ndarray  # (m,)
    gaps: np.ndarray  # (m,) of the meshes as they are
    stiffness: np.ndarray  # S (m, m)
    load: np.ndarray  # g (m,)
    constant: float
    free: np.ndarray  # (m, k) orthonormal: motions that cost nothing, of bodies that contact alone carries
    at_rest: np.ndarray  # u_0 (dofs,)
    motions: np.ndarray  # U (dofs, m)
    program: tuple  # K, f, prescribed values by dof, B: for contact_oracle.solve_contact()

    def energy(self, w):
        return self.constant + 0.5 * w @ (self.stiffness @ w) - self.load @ w

    def forces(self, w):
        return self.load - self.stiffness @ w


def contact_rows(scene, mesh):
    """B, gaps and nodes of the contact points."""
    normal, first = normal_of(scene.first), mesh.nodes_of(scene.first)
    x = mesh.mesh.nodes
    if isinstance(scene.second, HalfPlane):
        direction = np.asarray(scene.second.direction, dtype=float)
        normal = -direction / np.linalg.norm(direction)
        gaps = (np.asarray(scene.second.point) - x[first]) @ normal
        return elastic_oracle.obstacle_rows(mesh.mesh, first, normal), gaps, first
    second = mesh.nodes_of(scene.second)
    along = 1 - SIDES[scene.first.side][0]
    apart = np.abs(x[first, along] - x[second, along]).max() if len(first) == len(second) else np.inf
    if not apart <= SAME * mesh.extent:
        raise OracleError("shape: the two sides of the contact do not have the same nodes; cut them alike")
    gaps = (x[second] - x[first]) @ normal
    rows = elastic_oracle.contact_rows(mesh.mesh, first, second, normal)
    return rows, gaps + scene.gap, first


def boundary_conditions(scene, mesh):
    """The load f, and prescribed values by dof."""
    load, prescribed = np.zeros(mesh.mesh.size), {}
    for part, density in scene.loads:
        nodes = mesh.nodes_of(part)
        areas = mesh.areas_of(part, nodes)
        for k in range(2):
            # Densities are constant: consistent forces are those of the areas.
            np.add.at(load, mesh.mesh.dof(nodes, k), density[k] * areas)
    for part, values in scene.held:
        for axis, value in values.items():
            dofs = mesh.mesh.dof(mesh.nodes_of(part), AXES.index(axis))
            prescribed |= dict.fromkeys(dofs.tolist(), float(value))
    return load, prescribed


def condense(scene):
    """@raises OracleError where contact that is closed everywhere leaves a body a motion, as sliding on the plane."""
    mesh = Mesh(scene.bodies)
    materials = {mesh.number[name]: (b.young, b.poisson) for name, b in scene.bodies.items()}
    stiffness = elastic_oracle.assemble(mesh.mesh, materials).tocsr()
    rows, gaps, nodes = contact_rows(scene, mesh)
    load, prescribed = boundary_conditions(scene, mesh)
    held = np.array(sorted(prescribed), dtype=int)
    free = np.setdiff1d(np.arange(len(load)), held)
    count = rows.shape[0]
    modes = elastic_oracle.rigid_modes(mesh.mesh)
    kept = sp.vstack([modes[held], rows @ modes]).toarray()
    if np.linalg.eigvalsh(kept.T @ kept)[0] <= STILL:
        raise OracleError("shape: contact that is closed everywhere leaves a body free to move; hold it along the contact")

    # Saddle-point systems of B u = w: for w = 0 with the load, and for each w alone without it.
    start = np.zeros(len(load))
    start[held] = [prescribed[dof] for dof in held.tolist()]
    weight = float(stiffness.diagonal().max())  # of the size of the stiffness: a balanced system
    b = weight * rows[:, free]
    system = sp.bmat([[stiffness[free][:, free], b.T], [b, None]], format="csc")
    right = np.zeros((len(free) + count, count + 1))
    right[: len(free), 0] = (load - stiffness @ start)[free]
    right[len(free) :, 0] = -weight * (rows @ start)
    right[len(free) :, 1:] = weight * np.eye(count)
    factors = spla.splu(system)
    found = factors.solve(right)
    found += factors.solve(right - system @ found)

    displacements = np.zeros((len(load), count + 1))
    displacements[free] = found[: len(free)]
    displacements[:, 0] += start
    forces = weight * found[len(free) :]
    s = -0.5 * (forces[:, 1:] + forces[:, 1:].T)
    values, vectors = np.linalg.eigh(s)
    u = displacements[:, 0]
    return Contact(
        x=mesh.mesh.nodes[nodes], areas=mesh.areas_of(scene.first, nodes), gaps=gaps, stiffness=s, load=forces[:, 0],
        constant=float(0.5 * u @ (stiffness @ u) - load @ u), free=vectors[:, values <= FREE * values[-1]],
        at_rest=u, motions=displacements[:, 1:], program=(stiffness, load, prescribed, rows),
    )


def deck(scene, subdomains=None, **lists):
    """The scene as a deck for harmos_decks.xml(), by nested dicts.

    subdomains  of each body along x and y by its name, which divide its cells; none: (1, 1)
    lists       more lists of the deck
    """
    subdomains = subdomains or {}
    bodies, materials = {}, {}
    for name, block in scene.bodies.items():
        cut = subdomains.get(name, (1, 1))
        if any(n % k for n, k in zip(block.cells, cut)):
            raise OracleError(f"shape: {cut} subdomains do not divide the {block.cells} cells of {name}")
        materials[f"of {name}"] = {"Young's modulus": float(block.young), "Poisson's ratio": float(block.poisson)}
        bodies[name] = {
            "Source": "block", "Origin": [*map(float, block.origin), 0.0], "Size": [*map(float, block.size), 1.0],
            "Subdomains a side": [*cut, 1], "Elements a side": [*(n // k for n, k in zip(block.cells, cut)), 1],
            "Element": "Q1", "Expert": {"Dilatation": "full"}, "Materials": [f"of {name}"],
        }
    rules = boundary_parts(scene)
    return {
        "Model": {"Physics": "plane strain"}, "Materials": materials, "Bodies": bodies,
        **({"Boundary parts": rules} if rules else {}), "Effects": effects(scene), **lists,
    }


def boundary_parts(scene):
    """Rules for parts of sides."""
    parts, rules = [scene.first], {}
    if isinstance(scene.second, Part):
        parts.append(scene.second)
    parts += [part for part, _ in scene.held] + [part for part, _ in scene.loads]
    for part in parts:
        if not part.whole:
            block, (axis, end) = scene.bodies[part.body], SIDES[part.side]
            along = 1 - axis
            low, high = block.origin[along], block.origin[along] + block.size[along]
            corners = np.zeros((2, 3))
            corners[:, axis] = block.origin[axis] + end * block.size[axis]
            corners[:, along] = max(part.low, low), min(part.high, high)
            box = {"Box from": corners[0].tolist(), "Box to": corners[1].tolist()}
            rules[part.name] = {"Bodies": [part.body], "Of": [part.side], **box}
    return rules


def effects(scene):
    def where(part):
        return f"{part.body}/{part.name}"

    if isinstance(scene.second, HalfPlane):
        plane = {"Point": [*map(float, scene.second.point), 0.0], "Direction": [*map(float, scene.second.direction), 0.0]}
        tree = {"Obstacle": {"joint": {"Part": where(scene.first), **plane}}}
    else:
        pair = {"First": where(scene.first), "Second": where(scene.second), "Coupling": "nodes"}
        tree = {"Contact": {"joint": {**pair, "Gap": float(scene.gap)}}}
    if scene.loads:
        tree["Traction"] = {
            f"load {k}": {"Part": where(part), "Density": [*map(float, density), 0.0]}
            for k, (part, density) in enumerate(scene.loads)
        }
    if scene.held:
        tree["Prescribed displacement"] = {
            f"hold {k}": {
                "Part": where(part), "Components": list(values),
                "Displacement": [float(values.get(axis, 0.0)) for axis in "xyz"],
            }
            for k, (part, values) in enumerate(scene.held)
        }
    return tree
