# SPDX-License-Identifier: BSD-3-Clause
"""The linear system of an active set: what is prescribed and closed is eliminated from the whole matrix.

u = T v + g, with T the identity but for the rows of closed contacts with a body, which follow other displacements. The
system of a set is Tᵀ K T, its rows of eliminated displacements replaced by those of a diagonal.
"""

import numpy as np


class System:
    """K, and its reduced form for one set after the other, on the rows of this rank."""

    def __init__(self, PETSc, matrix, modes, prescribed, candidates, tied):
        """@param tied closed contacts follow others; else they lie on a rigid plane."""
        self.PETSc, self.matrix, self.modes = PETSc, matrix, modes
        self.fixed, self.values = prescribed
        self.candidates, self.tied = candidates, tied
        self.low = matrix.getOwnershipRange()[0]
        self.reduced = self.ties = self.gone = None
        self.diagonal = matrix.getDiagonal()
        self.work = matrix.createVecLeft()
        if tied:
            self._gather()

    def _gather(self):
        columns = self.candidates.columns.ravel().astype(self.PETSc.IntType)
        self.gathered = self.PETSc.Vec().createSeq(len(columns))
        source = self.PETSc.IS().createGeneral(columns, comm=self.PETSc.COMM_SELF)
        self.scatter = self.PETSc.Scatter().create(self.work, source, self.gathered, None)

    def total(self, value):
        """The sum over all ranks."""
        vector = self.PETSc.Vec().createMPI((1, None), comm=self.PETSc.COMM_WORLD)
        vector.getArray()[:] = value
        return vector.sum()

    def count(self, marked):
        return round(self.total(float(np.count_nonzero(marked))))

    def at(self, vector, rows):
        return vector.getArray(readonly=True)[rows - self.low]

    def touching(self, u):
        """What every candidate of this rank would be displaced by, were it closed."""
        c = self.candidates
        if not self.tied:
            return c.lifts
        self.scatter.scatter(u, self.gathered, mode="forward")
        values = self.gathered.getArray(readonly=True).reshape(c.columns.shape)
        return c.lifts + (c.weights * values).sum(axis=1)

    def _tie(self, closed):
        """T. Open candidates have zeros where closed ones have weights: the pattern is that of all."""
        PETSc, c = self.PETSc, self.candidates
        rows, width = c.rows - self.low, c.columns.shape[1]
        lengths = np.ones(self.work.getLocalSize(), PETSc.IntType)
        lengths[rows] += width
        starts = np.concatenate([[0], np.cumsum(lengths)]).astype(PETSc.IntType)
        own = starts[:-1]
        columns, values = np.empty(starts[-1], PETSc.IntType), np.ones(starts[-1])
        columns[own] = self.low + np.arange(len(own))
        slots = own[rows][:, None] + 1 + np.arange(width)
        columns[slots] = c.columns
        values[slots] = c.weights * closed[:, None]
        values[own[rows]] = ~closed
        if self.ties is None:
            sizes, csr = self.matrix.getSizes(), (starts, columns, values)
            self.ties = PETSc.Mat().createAIJ(sizes, csr=csr, comm=PETSc.COMM_WORLD)
        else:
            self.ties.setValuesCSR(starts, columns, values)
            self.ties.assemble()

    def reduce(self, closed, keep):
        """The matrix of this set in `reduced`, with `keep` in the place of the last one and with its pattern."""
        PETSc = self.PETSc
        if self.tied:
            self._tie(closed)
        if self.reduced is None or not keep:
            if self.reduced is not None:
                self.reduced.destroy()
            self.reduced = self.matrix.ptap(self.ties) if self.tied else self.matrix.copy()
            self.reduced.setBlockSize(3)
            self.reduced.setOption(PETSc.Mat.Option.SPD, True)
            self.reduced.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
            self.reduced.setNearNullSpace(self.modes)
        elif self.tied:
            self.matrix.ptap(self.ties, result=self.reduced)
        else:
            self.matrix.copy(self.reduced, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        rows = np.concatenate([self.fixed, self.candidates.rows[closed]])
        self.gone = rows.astype(PETSc.IntType)
        self.reduced.zeroRowsColumns(self.gone, diag=1.0)
        # As large as before, for a hierarchy that outlives the set.
        diagonal = self.reduced.getDiagonal()
        diagonal.getArray()[self.gone - self.low] = self.at(self.diagonal, self.gone)
        self.reduced.setDiagonal(diagonal)

    def impose(self, u, closed):
        """Prescribed displacements and closed gaps."""
        taken = self.touching(u)[closed]
        array = u.getArray()
        array[self.fixed - self.low] = self.values
        array[self.candidates.rows[closed] - self.low] = taken

    def residual(self, u):
        """−Tᵀ K u in the rows that are left: the right-hand side for a step from u."""
        self.matrix.mult(u, self.work)
        self.work.scale(-1.0)
        right = self.work.duplicate()
        if self.tied:
            self.ties.multTranspose(self.work, right)
        else:
            self.work.copy(right)
        right.getArray()[self.gone - self.low] = 0.0
        return right

    def advance(self, u, step):
        """u + T step."""
        if self.tied:
            self.ties.multAdd(step, u, u)
        else:
            u.axpy(1.0, step)

    def next_set(self, u, closed):
        """A closed contact stays where it is pressed, an open one closes where it is penetrated."""
        self.matrix.mult(u, self.work)
        rows = self.candidates.rows
        return np.where(closed, self.at(self.work, rows) > 0.0, self.at(u, rows) < self.touching(u))

    def energy(self, u):
        self.matrix.mult(u, self.work)
        return 0.5 * u.dot(self.work)

    def force(self, u, closed):
        """Of all closed contacts, along z."""
        self.matrix.mult(u, self.work)
        return self.total(float(self.at(self.work, self.candidates.rows[closed]).sum()))
