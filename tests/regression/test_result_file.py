# SPDX-License-Identifier: BSD-3-Clause
"""The result file, result.vtkhdf, from the reader's side.

What each class guards against:

    Raw        a file that is no VTKHDF, has wrong or missing arrays, or holds another solution
               than the monolithic oracle's
    VtkReader  a file that h5py reads and VTK, hence ParaView, does not, or not as it was meant
    SameFile   a file that depends on the number of ranks
    Variants   arrays or files that the deck does not call for, files half written
    Pictures   harmos-plot falling behind the file format
"""

import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "verification" / "oracles"))

import harmos_runs as runs  # noqa: E402

try:
    import h5py  # noqa: F401
    import numpy as np
    import oracle
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

# 1/H, H/h and their product: eight subdomains, which three ranks do not share evenly.
S, N = 2, 16
n = S * N
SETS = {
    "Model/Subdomains per side": S,
    "Model/Elements per subdomain side": N,
    "Solver/Tolerance": 1e-8,
}

VTK_QUAD = 9
OFF, OPEN, CLOSED = 0, 1, 2  # active_set

MESH = {
    "NumberOfPoints",
    "NumberOfCells",
    "NumberOfConnectivityIds",
    "Points",
    "Connectivity",
    "Offsets",
    "Types",
    "CellData/subdomain",
    "CellData/body",
    "CellData/region",
}
CONTACT = {"PointData/contact_pressure", "PointData/gap", "PointData/active_set"}
ALL = MESH | CONTACT | {"PointData/displacement"}


def read(run, elements=n):
    return runs.Result(run.directory / "result.vtkhdf", elements)


_default = None


def default_run(case):
    """The run on two ranks that several classes look at; made once."""
    global _default
    if _default is None:
        _default = runs.solved(case, runs.MODEL, SETS)
        # The bounds below follow what the summary says of the tolerance.
        case.assertEqual(_default.summary["tolerance"], SETS["Solver/Tolerance"])
    return _default


def jump(summary):
    """What the forces at the stop leave of jumps, in the norm of the dual problem.

    Free components of the gradient, jumps of the displacement, are at most the tolerance of the
    projected gradient; forces that are out of balance by the tolerance of the equality residual
    move the displacements by that times |F|.
    """
    return (
        summary["tolerance_projected_gradient"]
        + summary["hessian_norm"] * summary["tolerance_equality_residual"]
    )


def force_bound(summary):
    """Bound on the error of a nodal force.

    The active set is the exact one (tested below), so the error is F^-1 times the jump, in the
    free components. With BB' = I, F >= 1 / |K| on balanced forces: take v = B'l in l'Fl =
    sup_v (l'Bv)^2 / v'Kv. And |K| <= 4 for Q1 squares: the element matrix has the norm 1, a node
    belongs to four. What is out of balance comes on top.
    """
    return 4 * jump(summary) + summary["tolerance_equality_residual"]


def displacement_bound(summary):
    """Bound on the error of a displacement or of a gap.

    In the energy norm the error is at most the jump / sqrt(least eigenvalue of F), twice the jump
    by force_bound(). The maximum of a Q1 function is bounded by its energy norm times
    sqrt(1 + log(1/h)) / 2 or so, here 1.1; and rigid motions of the subdomains add up to a jump
    for each of the 2S subdomains on the way from the support. 10 covers the sum.
    """
    return 10 * jump(summary)


class Raw(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = default_run(cls())
        cls.result = read(cls.run_)
        cls.arrays = cls.result.arrays
        cls.interface = cls.result.x[:, 0] == 1.0
        # The part of the interface that belongs to a node.
        ends = (cls.result.j == 0) | (cls.result.j == n)
        cls.length = np.where(ends, 0.5, 1.0) / n
        cls.oracle = oracle.solve(n)

    def side(self, body):
        """The nodes of one side of the interface, one copy each, by j."""
        chosen = np.flatnonzero(self.interface & (self.result.body == body))
        _, where = np.unique(self.result.j[chosen], return_index=True)
        return chosen[where]

    def test_files(self):
        names = tuple(sorted(path.name for path in self.run_.directory.iterdir()))
        self.assertEqual(names, runs.RESULTS)

    def test_kind_and_version(self):
        self.assertEqual(self.result.attributes["Type"], b"UnstructuredGrid")
        self.assertEqual(list(self.result.attributes["Version"]), [1, 0])

    def test_arrays(self):
        self.assertEqual(set(self.arrays), ALL)

    def test_mesh(self):
        a = self.arrays
        parts = 2 * S * S
        self.assertEqual(a["NumberOfPoints"].tolist(), parts * [(N + 1) ** 2])
        self.assertEqual(a["NumberOfCells"].tolist(), parts * [N * N])
        self.assertEqual(a["NumberOfConnectivityIds"].tolist(), parts * [4 * N * N])
        self.assertEqual(a["Points"].shape, (parts * (N + 1) ** 2, 3))
        self.assertEqual(len(a["Points"]), self.run_.summary["primal_dimension"])
        self.assertTrue((a["Types"] == VTK_QUAD).all())
        self.assertEqual(len(a["Types"]), parts * N * N)
        self.assertEqual(a["Offsets"].tolist(), parts * list(range(0, 4 * N * N + 1, 4)))
        self.assertEqual(a["Points"].min(axis=0).tolist(), [0, 0, 0])
        self.assertEqual(a["Points"].max(axis=0).tolist(), [2, 1, 0])
        # Counter-clockwise squares of side h, whose numbers are local to their part.
        corners = a["Connectivity"].reshape(parts, N * N, 4)
        for part in range(parts):
            xy = a["Points"][part * (N + 1) ** 2 :][corners[part]][..., :2]
            d1, d2 = xy[:, 2] - xy[:, 0], xy[:, 3] - xy[:, 1]
            area = 0.5 * (d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0])
            # Coordinates up to 2 are rounded to 2.2e-16.
            np.testing.assert_allclose(area, 1 / n**2, rtol=0, atol=1e-15)
        np.testing.assert_array_equal(
            a["CellData/subdomain"], np.repeat(np.arange(parts), N * N)
        )
        np.testing.assert_array_equal(
            a["CellData/body"], np.repeat([0, 1], S * S * N * N)
        )

    def test_displacement_is_the_oracle_s(self):
        error = self.result.displacement_error(self.oracle)
        self.assertLess(error, displacement_bound(self.run_.summary))

    def test_dirichlet_condition_is_exact_to_rounding(self):
        u = self.result.u[self.result.x[:, 0] == 0.0]
        self.assertEqual(len(u), S * (N + 1))
        # The condition stays in the subdomain matrices, so that only rounding is left; the
        # largest displacement is about one, the condition number of a subdomain below 1e4.
        self.assertLess(np.abs(u).max(), 1e-12)

    def test_contact_fields_vanish_off_the_interface(self):
        for name in CONTACT:
            self.assertFalse(self.arrays[name][~self.interface].any(), name)

    def test_contact_fields_are_those_of_the_oracle(self):
        summary = self.run_.summary
        for body in (0, 1):
            side = self.side(body)
            self.assertEqual(len(side), n + 1)
            pressure = self.arrays["PointData/contact_pressure"][side]
            gap = self.arrays["PointData/gap"][side]
            active = self.arrays["PointData/active_set"][side]
            force = pressure * self.length[side]
            error = np.abs(force - self.oracle.multipliers).max()
            self.assertLess(error, force_bound(summary))
            self.assertLess(np.abs(gap - self.oracle.gap).max(), displacement_bound(summary))
            # The least force and the least gap of the oracle are above 1e-3 here, so that the
            # sets are the same, not only nearly.
            np.testing.assert_array_equal(active, np.where(self.oracle.active, CLOSED, OPEN))

    def test_copies_of_a_node_agree(self):
        for name in CONTACT:
            values = self.arrays[name][self.interface]
            j = self.result.j[self.interface]
            first = dict(zip(j[::-1].tolist(), values[::-1].tolist()))
            self.assertEqual([first[k] for k in j.tolist()], values.tolist(), name)

    def test_signs(self):
        self.assertGreaterEqual(self.arrays["PointData/contact_pressure"].min(), 0.0)
        bound = displacement_bound(self.run_.summary)
        self.assertGreater(self.arrays["PointData/gap"].min(), -bound)
        found = set(np.unique(self.arrays["PointData/active_set"]).tolist())
        self.assertEqual(found, {OFF, OPEN, CLOSED})

    def test_gap_is_the_difference_of_the_displacements(self):
        u = self.result.u
        first, second = self.side(0), self.side(1)
        gap = self.arrays["PointData/gap"][first]
        # At the cross points the row takes the mean of the copies: their jumps are left.
        bound = displacement_bound(self.run_.summary)
        self.assertLess(np.abs(u[second] - u[first] - gap).max(), bound)

    def test_complementarity(self):
        pressure = self.arrays["PointData/contact_pressure"]
        gap = self.arrays["PointData/gap"]
        # Where there is pressure the gap is an error; elsewhere the pressure is exactly zero.
        bound = pressure.max() * displacement_bound(self.run_.summary)
        self.assertLess(np.abs(pressure * gap).max(), bound)

    def test_contact_force_holds_the_floating_body(self):
        side = self.side(0)
        force = self.arrays["PointData/contact_pressure"][side] @ self.length[side]
        # Its load is -1 on (1,2) x (0,1/4). What is missing is the sum over its S^2 subdomains of
        # the balances R'(f - B'lambda) = L G lambda, each times N+1 since R'R = I: at most
        # (N+1) S |L| |G lambda|, and |L| = |R'B'| <= 1 since BB' = I as well.
        bound = (N + 1) * S * self.run_.summary["tolerance_equality_residual"]
        self.assertLess(abs(force - 0.25), bound)


def in_one_piece(grid):
    """VTK 9.1 reads the parts of the ranks as one grid, VTK 9.6 as a set of grids."""
    if grid.GetClassName() != "vtkPartitionedDataSet":
        return grid
    from vtkmodules.vtkFiltersCore import vtkAppendFilter

    append = vtkAppendFilter()
    for k in range(grid.GetNumberOfPartitions()):
        append.AddInputData(grid.GetPartition(k))
    append.Update()
    return append.GetOutput()


class VtkReader(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        try:
            from vtkmodules.util.numpy_support import vtk_to_numpy
            from vtkmodules.vtkIOHDF import vtkHDFReader
        except ImportError as error:
            raise unittest.SkipTest(f"the Python module {error.name} is missing") from error
        cls.to_numpy = staticmethod(vtk_to_numpy)
        run = default_run(cls())
        cls.arrays = read(run).arrays
        path = run.directory / "result.vtkhdf"
        reader = vtkHDFReader()
        reader.SetFileName(str(path))
        cls.can_read = reader.CanReadFile(str(path))
        reader.Update()
        cls.grid = in_one_piece(reader.GetOutputDataObject(0))

    def test_reader_takes_the_file(self):
        self.assertEqual(self.can_read, 1)
        self.assertEqual(self.grid.GetClassName(), "vtkUnstructuredGrid")

    def test_mesh(self):
        self.assertEqual(self.grid.GetNumberOfPoints(), 2 * S * S * (N + 1) ** 2)
        self.assertEqual(self.grid.GetNumberOfCells(), 2 * S * S * N * N)
        types = {self.grid.GetCellType(k) for k in range(self.grid.GetNumberOfCells())}
        self.assertEqual(types, {VTK_QUAD})
        # Multiples of 1/32, which are exact.
        self.assertEqual(self.grid.GetBounds(), (0.0, 2.0, 0.0, 1.0, 0.0, 0.0))

    def test_arrays(self):
        for data, group, names in (
            (self.grid.GetPointData(), "PointData", ("displacement", *CONTACT)),
            (self.grid.GetCellData(), "CellData", ("subdomain", "body")),
        ):
            for name in names:
                name = name.split("/")[-1]
                array = data.GetArray(name)
                self.assertIsNotNone(array, name)
                self.assertEqual(array.GetNumberOfComponents(), 1)
                raw = self.arrays[f"{group}/{name}"]
                np.testing.assert_array_equal(self.to_numpy(array), raw, name)

    def test_integral_of_the_displacement(self):
        # Over VTK's cells, whose corners VTK has numbered through all parts ...
        cells = self.to_numpy(self.grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
        points = self.to_numpy(self.grid.GetPoints().GetData())
        u = self.to_numpy(self.grid.GetPointData().GetArray("displacement"))
        d1 = points[cells[:, 2]] - points[cells[:, 0]]
        d2 = points[cells[:, 3]] - points[cells[:, 1]]
        areas = 0.5 * (d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0])
        found = (areas * u[cells].mean(axis=1)).sum()
        # ... and part by part from the raw grids of nodes, with the weights of the trapezoidal
        # rule.
        weights = np.ones(N + 1)
        weights[[0, -1]] = 0.5
        weights = np.outer(weights, weights) / n**2
        raw = self.arrays["PointData/displacement"].reshape(-1, (N + 1) ** 2)
        # Row by row or column by column: the weights are the same.
        expected = (raw * weights.ravel()).sum()
        # A sum of 2048 terms of one sign, rounded: 2048 * 1.1e-16 relative, rounded up.
        self.assertLess(abs(found - expected), 1e-12 * abs(expected))


class Elastic(unittest.TestCase):
    """Vectors, stresses and the node order of each cell, as VTK sees them."""

    def grid(self, sets):
        try:
            from vtkmodules.util.numpy_support import vtk_to_numpy
            from vtkmodules.vtkIOHDF import vtkHDFReader
        except ImportError as error:
            raise unittest.SkipTest(f"the Python module {error.name} is missing") from error
        run = runs.solved(self, runs.MODEL, {"Model/Problem": "block", "Model/Elements per subdomain side": 2,
                                             "Model/Subdomains per side": 2, **sets})
        reader = vtkHDFReader()
        reader.SetFileName(str(run.directory / "result.vtkhdf"))
        reader.Update()
        return in_one_piece(reader.GetOutputDataObject(0)), vtk_to_numpy

    def test_nodes_are_where_vtk_expects_them(self):
        for dimension in (2, 3):
            for order in (1, 2):
                grid, _ = self.grid({"Model/Dimension": dimension, "Model/Element order": order})
                for k in range(grid.GetNumberOfCells()):
                    cell = grid.GetCell(k)
                    bounds = np.reshape(cell.GetBounds(), (3, 2))[:dimension]
                    places = np.reshape(cell.GetParametricCoords(), (-1, 3))
                    self.assertEqual(len(places), cell.GetNumberOfPoints())
                    for i, place in enumerate(places):
                        point = cell.GetPoints().GetPoint(i)
                        expected = bounds[:, 0] + place[:dimension] * (bounds[:, 1] - bounds[:, 0])
                        np.testing.assert_allclose(point[:dimension], expected, atol=1e-14)

    def test_vectors_and_stresses(self):
        grid, to_numpy = self.grid({"Model/Dimension": 3})
        data = grid.GetPointData()
        self.assertEqual(data.GetArray("displacement").GetNumberOfComponents(), 3)
        stress = to_numpy(data.GetArray("stress"))
        self.assertEqual(stress.shape[1], 6)
        xx, yy, zz, xy, yz, xz = stress.T
        equivalent = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2)
                             + 3.0 * (xy**2 + yz**2 + xz**2))
        np.testing.assert_allclose(to_numpy(data.GetArray("von_mises")), equivalent, rtol=1e-12)
        # Copies of a node have the same stress: it is averaged over subdomains.
        points = to_numpy(grid.GetPoints().GetData())
        order = np.lexsort(np.round(points, 9).T)
        same = np.all(np.abs(np.diff(points[order], axis=0)) < 1e-9, axis=1)
        self.assertTrue(same.any())
        np.testing.assert_allclose(stress[order[1:][same]], stress[order[:-1][same]], atol=1e-15)
        # Weight below, lifted at the right: pressed together at the lower left.
        corner = np.argmin(points.sum(axis=1))
        self.assertLess(zz[corner], 0.0)

    def test_stresses_can_be_left_out(self):
        grid, _ = self.grid({"Output/Stresses": False})
        self.assertIsNone(grid.GetPointData().GetArray("stress"))


class SameFile(unittest.TestCase):
    def test_on_one_two_and_three_ranks(self):
        runs_ = {
            ranks: default_run(self) if ranks == 2 else runs.solved(self, runs.MODEL, SETS, ranks)
            for ranks in (1, 2, 3)
        }
        reference = read(runs_[1]).arrays
        # Each run is within the bound of the exact solution.
        summary = runs_[1].summary
        bounds = {
            "PointData/displacement": 2 * displacement_bound(summary),
            "PointData/gap": 2 * displacement_bound(summary),
            # Force per length; at the ends of the interface h/2 belongs to a node.
            "PointData/contact_pressure": 2 * force_bound(summary) * 2 * n,
        }
        for ranks in (2, 3):
            arrays = read(runs_[ranks]).arrays
            self.assertEqual(set(arrays), set(reference))
            for name, expected in reference.items():
                with self.subTest(ranks=ranks, dataset=name):
                    found = arrays[name]
                    self.assertEqual(found.dtype, expected.dtype)
                    self.assertEqual(found.shape, expected.shape)
                    if name in bounds:
                        self.assertLess(np.abs(found - expected).max(), bounds[name])
                    else:
                        np.testing.assert_array_equal(found, expected)


class Variants(unittest.TestCase):
    QUICK = {"Model/Subdomains per side": 2, "Model/Elements per subdomain side": 4}

    def test_tie_has_no_contact_arrays(self):
        result = runs.solved(self, runs.MODEL, {**self.QUICK, "Model/Interface": "tie"})
        arrays = read(result, 8).arrays
        self.assertEqual(set(arrays), ALL - CONTACT)
        names = tuple(sorted(path.name for path in result.directory.iterdir()))
        self.assertEqual(names, runs.RESULTS)

    def test_no_file_without_fields(self):
        result = runs.solved(self, runs.MODEL, {**self.QUICK, "Output/Fields": False})
        names = {path.name for path in result.directory.iterdir()}
        self.assertEqual(names, {"iterations.csv", "summary.json"})
        self.assertNotIn("result.vtkhdf", result.stdout)

    def test_file_of_an_earlier_run_is_replaced(self):
        first = runs.solved(self, runs.MODEL, SETS)
        second = runs.solved(self, runs.MODEL, self.QUICK, output=first.directory)
        names = tuple(sorted(path.name for path in second.directory.iterdir()))
        self.assertEqual(names, runs.RESULTS)
        arrays = read(second, 8).arrays
        self.assertEqual(len(arrays["Types"]), 2 * 8 * 8)

    def test_no_file_of_an_earlier_run_beside_a_new_summary(self):
        first = runs.solved(self, runs.MODEL, self.QUICK)
        sets = {**self.QUICK, "Model/Interface": "tie", "Output/Fields": False}
        second = runs.solved(self, runs.MODEL, sets, output=first.directory)
        # A reader would take the fields of one run for those of the other.
        self.assertFalse((second.directory / "result.vtkhdf").exists())

    def test_total_feti_has_the_same_arrays(self):
        sets = {**self.QUICK, "Decomposition/Dirichlet": "dual"}
        result = runs.solved(self, runs.MODEL, sets)
        arrays = read(result, 8).arrays
        self.assertEqual(set(arrays), ALL)

    def test_run_that_did_not_converge_has_its_fields(self):
        # To see where it went wrong.
        result = runs.run(runs.MODEL, {**self.QUICK, "Solver/Maximum iterations": 3})
        self.assertEqual(result.returncode, 1, result)
        arrays = read(result, 8).arrays
        self.assertEqual(set(arrays), ALL)
        self.assertTrue(np.isfinite(arrays["PointData/displacement"]).all())


class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        try:
            import matplotlib  # noqa: F401
        except ImportError as error:
            raise unittest.SkipTest(f"the Python module {error.name} is missing") from error

    def draw(self, directory):
        script = runs.application("harmos-plot")
        self.pictures = runs.scratch("pictures")
        return subprocess.run(
            [sys.executable, script, directory, "--output", self.pictures],
            capture_output=True,
            text=True,
            timeout=120,
        )

    def assert_drawn(self, result, *names):
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual({path.name for path in self.pictures.iterdir()}, set(names))
        for name in names:
            data = (self.pictures / name).read_bytes()
            self.assertTrue(data.startswith(b"\x89PNG\r\n\x1a\n"), name)
            # An empty pair of axes has less.
            self.assertGreater(len(data), 10_000, name)

    def test_both_pictures(self):
        result = self.draw(default_run(self).directory)
        self.assert_drawn(result, "solution.png", "convergence.png")

    def test_tied_run(self):
        run = runs.solved(self, runs.MODEL, {**Variants.QUICK, "Model/Interface": "tie"})
        self.assert_drawn(self.draw(run.directory), "solution.png", "convergence.png")

    def test_run_without_fields(self):
        run = runs.solved(self, runs.MODEL, {**Variants.QUICK, "Output/Fields": False})
        self.assert_drawn(self.draw(run.directory), "convergence.png")

    def test_not_a_run(self):
        result = self.draw(runs.scratch("nowhere"))
        self.assertEqual(result.returncode, 2)
        self.assertIn("no such directory", result.stderr)


if __name__ == "__main__":
    runs.main()
