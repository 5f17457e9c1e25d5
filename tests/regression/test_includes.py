# SPDX-License-Identifier: BSD-3-Clause
"""Headers of Trilinos that cost seconds in each source: who includes them, directly or through others.

A heavy header belongs to Tpetra, Belos, Kokkos, Amesos2, Thyra, MueLu, Xpetra or Intrepid2 and does
not end with _fwd.hpp or _config.h. Harmos_TrilinosVersion.hpp declares Tpetra's classes without them on
Trilinos 13; elsewhere it includes Tpetra's own declarations, which is not counted. The seam is the list of our headers that include one, directly or through other
headers of the tree. The list and the number of sources only shrink.

What each class guards against:

    Includes   a header outside of the seam that reaches a heavy header, a header of the seam that
               reaches none any more, more sources that reach one; an installed header that includes
               one that is not
    Planted    a check that finds nothing: one fault each of a small tree must be found
"""

import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402
import test_layout as layout  # noqa: E402

LIBRARIES = "Tpetra|Belos|Kokkos|Amesos2|Thyra|MueLu|Xpetra|Intrepid2"
HEAVY = re.compile(rf"(?:.*/)?(?:{LIBRARIES})(?!\w*(?:_fwd\.hpp|_config\.h)$)\w*\.\w+")
FORWARD = "Harmos_TrilinosVersion.hpp"

# Sources of packages and apps that reach a heavy header, at most.
MOST_SOURCES = 60

# Headers that reach one, without "Harmos_" and ".hpp".
SEAM = {
    "qp": """
        AutoSolver AutoSolver_def BalancedActiveSet BalancedFaces BlockOps BoundedLagrangian
        BoundedLagrangian_def BoundedSolver BoundedSolver_def ConeProbe ConjugateDirections ConjugateGradients
        ConjugateResiduals CurvatureTerms DescentOfSets DualPenaltySolver DualPenaltySolver_def EqualityRows
        EqualityRows_def FaceArchive FaceDescent FaceIterate FaceSolver FaceSolver_def FaceSystem FaceSystem_def
        FeasibilityProbe FirstActiveSet FirstFace FixedPointSolver FixedPointSolver_def FrozenSides
        Globalization InFacePreconditioner InteriorPath InteriorRestart KeptDirections MprgpIteration_def
        MprgpSolver MprgpSolver_def NearestFeasible NewtonState NormEstimate_def PcpgSolver PcpgSolver_def
        PdasSolver PdasSolver_def Qp QpProblem_def ResidualDirections RowBasis SmalbeSolver SmalbeSolver_def
        SolverFactory SolverFactory_def SolverManager SolverManager_def StatusTest Strategy VectorOps
    """,
    "feti": """
        DeflatedOperators DualOperator DualPreconditioner DualSystem EndomorphicOperator Feti FetiSolver MumpsSolver
        ProjectedOperator StoppingTest SubdomainSum TornOperator
    """,
    "thyra": """
        FetiPreconditioner Thyra
    """,
    "sensitivity": """
        DesignModel Functional GapProfile Sensitivities ShapeModel
    """,
    "apps": """
        ShapeDeck ShapeResults ShapeRun
    """,
}


def files_of(source):
    return [f for top in ("packages", "apps") for f in source.below(top, suffixes=(".hpp", ".inc", ".cpp"))]


def ways(source):
    """For each file that reaches a heavy header, the names on the shortest way to one."""
    files = files_of(source)
    place = {Path(file).name: file for file in files if Path(file).suffix != ".cpp"}
    includes = {file: [name for _, name in layout.INCLUDE.findall(source.text(file))] for file in files if Path(file).name != FORWARD}
    users = {file: [] for file in files}
    for file, names in includes.items():
        for name in names:
            if Path(name).name in place:
                users[place[Path(name).name]].append(file)
    result = {}
    for file in files:
        heavy = sorted(filter(HEAVY.fullmatch, includes.get(file, [])))
        if heavy:
            result[file] = [heavy[0]]
    reached = list(result)
    for file in reached:  # grows
        for user in users[file]:
            if user not in result:
                result[user] = [Path(file).name, *result[file]]
                reached.append(user)
    return result


def seam_names(seam):
    return {f"Harmos_{name}.hpp" for names in seam.values() for name in names.split()}


def seam_faults(source, seam):
    """Headers that reach a heavy one and are not in the seam, and those that need not be in it."""
    found, names = ways(source), seam_names(seam)
    faults = [
        f"{file}: reaches {' -> '.join(way)} and is not in the seam"
        for file, way in sorted(found.items())
        if Path(file).suffix == ".hpp" and Path(file).name not in names
    ]
    reached = {Path(file).name for file in found}
    for name in sorted(names - reached):
        faults.append(f"{name}: reaches no heavy header; remove it from the seam")
    return faults


def source_faults(source, most):
    """All sources that reach a heavy header, with the way, if they are too many."""
    found = {file: way for file, way in ways(source).items() if Path(file).suffix == ".cpp"}
    if len(found) <= most:
        return []
    return [
        f"{len(found)} sources reach a heavy header, more than {most}:",
        *(f"{file}: {' -> '.join(way)}" for file, way in sorted(found.items())),
    ]


INTERNAL = re.compile(r"\bINTERNAL ([\w\s]+?)\n  [A-Z]")


def internal_faults(source, lists):
    """Installed headers that include one that is not, and names of the lists that are no headers."""
    internal = {f"Harmos_{name}.hpp" for text in lists for names in INTERNAL.findall(text) for name in names.split()}
    headers = [file for file in files_of(source) if Path(file).suffix == ".hpp"]
    faults = [f"{name}: is to be internal, and is no header"
              for name in sorted(internal - {Path(file).name for file in headers})]
    for file in headers:
        if Path(file).name in internal:
            continue
        for _, name in layout.INCLUDE.findall(source.text(file)):
            if name in internal:
                faults.append(f"{file}: is installed, and includes {name}, which is not")
    return faults


class Includes(layout.Checks):
    def test_internal_headers(self):
        lists = [path.read_text(encoding="utf-8") for path in sorted(Path(__file__).resolve().parents[2].glob("packages/*/CMakeLists.txt"))]
        self.assertGreaterEqual(sum(len(INTERNAL.findall(text)) for text in lists), 3)
        self.assert_none(internal_faults(self.source, lists))

    def test_seam(self):
        self.assert_none(seam_faults(self.source, SEAM))

    def test_number_of_sources(self):
        self.assert_none(source_faults(self.source, MOST_SOURCES))


class Planted(unittest.TestCase):
    def tree(self, **texts):
        """packages/qp/src/Harmos_<A>.hpp and .cpp with includes, by name: A_hpp="<b.hpp>"."""
        top = runs.scratch("tree")
        (top / "packages/qp/src").mkdir(parents=True)
        files = []
        for name, included in texts.items():
            files.append(f"packages/qp/src/Harmos_{name.replace('_', '.')}")
            text = "".join(f"#include {one}\n" for one in included.split())
            (top / files[-1]).write_text(text, encoding="utf-8")
        return layout.Source(top, files)

    def test_heavy_headers(self):
        heavy = "Tpetra_Map BelosTypes Kokkos_Core Amesos2 Thyra_VectorBase MueLu Xpetra_Map Intrepid2_Basis x/Tpetra_Map"
        for name in heavy.split():
            self.assertTrue(HEAVY.fullmatch(f"{name}.hpp"), name)
        for name in "Tpetra_Map_fwd Teuchos_RCP Teuchos_DefaultMpiComm vector Harmos_BoundTraitsTpetra".split():
            self.assertFalse(HEAVY.fullmatch(f"{name}.hpp"), name)

    def test_header_outside_of_the_seam(self):
        source = self.tree(A_hpp="<Tpetra_Map.hpp>", B_hpp='<vector> "Harmos_A.hpp"', C_hpp="<Tpetra_Map_fwd.hpp>",
                           D_hpp='"Harmos_B.hpp" "Harmos_C.hpp"')
        faults = seam_faults(source, {"qp": "A"})
        found = (("B", "Harmos_A.hpp"), ("D", "Harmos_B.hpp -> Harmos_A.hpp"))
        self.assertEqual(faults, [
            f"packages/qp/src/Harmos_{name}.hpp: reaches {way} -> Tpetra_Map.hpp and is not in the seam"
            for name, way in found
        ])
        self.assertEqual(seam_faults(source, {"qp": "A B", "feti": "D"}), [])

    def test_seam_that_is_too_large(self):
        source = self.tree(A_hpp="<Tpetra_Map.hpp>", B_hpp="<vector>")
        faults = seam_faults(source, {"qp": "A B C"})
        fault = "reaches no heavy header; remove it from the seam"
        self.assertEqual(faults, [f"Harmos_{name}.hpp: {fault}" for name in "BC"])

    def test_sources(self):
        source = self.tree(A_hpp="<Kokkos_Core.hpp>", A_cpp='"Harmos_A.hpp"', B_inc="<Amesos2.hpp>",
                           C_cpp='"Harmos_B.inc"', D_cpp="<Teuchos_RCP.hpp>")
        self.assertEqual(source_faults(source, 2), [])
        self.assertEqual(source_faults(source, 1), [
            "2 sources reach a heavy header, more than 1:",
            "packages/qp/src/Harmos_A.cpp: Harmos_A.hpp -> Kokkos_Core.hpp",
            "packages/qp/src/Harmos_C.cpp: Harmos_B.inc -> Amesos2.hpp",
        ])

    def test_installed_header_that_includes_an_internal_one(self):
        source = self.tree(A_hpp='"Harmos_B.hpp"', B_hpp='"Harmos_C.hpp"', C_hpp="<vector>")
        lists = ["harmos_add_package(\n  qp\n  INTERNAL B C\n           D\n  PUBLIC Harmos::core)\n"]
        self.assertEqual(internal_faults(source, lists), [
            "Harmos_D.hpp: is to be internal, and is no header",
            "packages/qp/src/Harmos_A.hpp: is installed, and includes Harmos_B.hpp, which is not",
        ])

    def test_headers_that_include_each_other(self):
        source = self.tree(A_hpp='"Harmos_B.hpp"', B_hpp='"Harmos_A.hpp" <MueLu.hpp>')
        self.assertEqual(len(seam_faults(source, {})), 2)


if __name__ == "__main__":
    runs.main()
