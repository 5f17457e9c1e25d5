# SPDX-License-Identifier: BSD-3-Clause
"""Linear triangles at finite displacements on a rigid floor, by other means than Harmos: the whole energy, its whole
Hessian by hand, and Newton's method over sets of nodes on the floor.

    W = ½ E:C:E of Green's strain, plane strain (St. Venant-Kirchhoff);  y + u_y ≥ floor at the given nodes

The floor is flat, so the constraints are bounds of displacements, and the deformed body plays no part in them.
Dense; for some hundred nodes. Run by itself it compares forces and Hessian with differences.
"""

import numpy as np


class Body:
    """points: n x 2; cells: m x 3, positively oriented."""

    def __init__(self, points, cells, young, poisson):
        self.points, self.cells = points, cells
        corners = points[cells]
        edges = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
        self.area = 0.5 * np.linalg.det(edges)
        inverse = np.linalg.inv(edges)
        self.gradients = np.stack([-inverse[:, 0] - inverse[:, 1], inverse[:, 0], inverse[:, 1]], axis=1)
        self.lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        self.shear = 0.5 * young / (1 + poisson)
        self.dofs = (2 * cells[:, :, None] + np.arange(2)).reshape(len(cells), 6)

    def forces(self, u):
        """Energy, forces and Hessian for displacements n x 2."""
        slope = np.einsum("cia,cib->cab", u[self.cells], self.gradients)  # ∂u_a/∂X_b
        f = np.eye(2) + slope
        strain = 0.5 * (np.einsum("cka,ckb->cab", f, f) - np.eye(2))
        trace = np.trace(strain, axis1=1, axis2=2)
        stress = self.lame * trace[:, None, None] * np.eye(2) + 2 * self.shear * strain
        energy = (self.area * 0.5 * np.einsum("cab,cab->c", stress, strain)).sum()
        force = np.zeros(u.size)
        first = np.einsum("cab,cbd->cad", f, stress)  # P
        np.add.at(force, self.dofs, (self.area[:, None, None] * np.einsum("cab,cib->cia", first, self.gradients)
                                     ).reshape(len(self.cells), 6))
        # δE of each dof, as tensors.
        change = np.einsum("cab,cid->ciabd", f, self.gradients)  # dof (i, a), entry (b, d) before symmetrisation
        change = 0.5 * (change + change.transpose(0, 1, 2, 4, 3)).reshape(len(self.cells), 6, 2, 2)
        traces = np.trace(change, axis1=2, axis2=3)
        hessian = self.lame * np.einsum("ci,cj->cij", traces, traces)
        hessian += 2 * self.shear * np.einsum("ciab,cjab->cij", change, change)
        turning = np.einsum("cia,cab,cjb->cij", self.gradients, stress, self.gradients)
        hessian += np.einsum("cij,ab->ciajb", turning, np.eye(2)).reshape(len(self.cells), 6, 6)
        matrix = np.zeros((u.size, u.size))
        for dofs, part in zip(self.dofs, self.area[:, None, None] * hessian):
            matrix[np.ix_(dofs, dofs)] += part
        return energy, force, matrix

    def solve(self, held, load, floor, on_floor, steps=10, tolerance=1e-12):
        """Displacements and forces of the floor for a load (n x 2), brought up in steps.

        held: nodes at rest; on_floor: nodes that may touch the floor."""
        u = np.zeros_like(self.points)
        fixed = {2 * node + a for node in held for a in range(2)}
        closed = set()
        for step in range(1, steps + 1):
            outer = load.ravel() * step / steps
            for _ in range(100):
                _, force, matrix = self.forces(u)
                bounds = {2 * node + 1: floor - self.points[node, 1] for node in closed}
                known = sorted(fixed | set(bounds))
                free = sorted(set(range(u.size)) - set(known))
                change = np.zeros(u.size)
                for dof, value in bounds.items():
                    change[dof] = value - u.ravel()[dof]
                rhs = (outer - force - matrix @ change)[free]
                change[free] = np.linalg.solve(matrix[np.ix_(free, free)], rhs)
                u = u + change.reshape(u.shape)
                _, force, _ = self.forces(u)
                pressed = (force - outer)[1::2]
                now = {node for node in on_floor if node not in held
                       and (pressed[node] > 0 if node in closed else self.points[node, 1] + u[node, 1] < floor)}
                if now == closed and np.abs(change).max() <= tolerance * np.abs(u).max():
                    break
                closed = now
            else:
                raise ArithmeticError(f"no equilibrium in step {step}")
        return u, {node: pressed[node] for node in closed}


def self_test():
    random = np.random.default_rng(1)
    points = np.array([[0.0, 0.0], [1.0, 0.1], [0.2, 0.9], [1.1, 1.2]])
    body = Body(points, np.array([[0, 1, 2], [1, 3, 2]]), 3.0, 0.3)
    u, direction, h = 0.2 * random.standard_normal((4, 2)), random.standard_normal((4, 2)), 1e-6
    above, below, here = body.forces(u + h * direction), body.forces(u - h * direction), body.forces(u)
    # Errors ε/h and h² of numbers of the order of one.
    assert abs((above[0] - below[0]) / (2 * h) - here[1] @ direction.ravel()) < 1e-8
    assert np.abs((above[1] - below[1]) / (2 * h) - here[2] @ direction.ravel()).max() < 1e-8


if __name__ == "__main__":
    self_test()
    print("forces and Hessian agree with differences")
