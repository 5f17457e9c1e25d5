# SPDX-License-Identifier: BSD-3-Clause
"""Does the suite notice when the library is wrong? Plants known faults, one at a time, and sees.

    python3 tests/stability/mutation_check.py                   all faults
    python3 tests/stability/mutation_check.py --list            what they are; nothing is built
    python3 tests/stability/mutation_check.py --only 3 --only 7

Faults go into a copy of the sources (of the files that git knows, as they are now) with a build
tree of its own; the sources themselves are never touched. Of each fault only the tests named with
it are built; then they are run until one fails. A table tells which did, and the exit status is 1
if a fault survives, or if the tests fail without any.

Each fault is an exact piece of text and what takes its place; a piece that is not there exactly
once is refused (exit status 2), also by --list, which a test runs: so the faults cannot rot.

The first build takes a quarter of an hour on two cores, less with ccache, each fault about a
minute. --build-dir keeps the copy and its build tree for the next time. --lock names a file that
is locked while all of this is built, for machines that are shared.
"""

import argparse
import contextlib
import fcntl
import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

SOURCE = Path(__file__).resolve().parents[2]
TEST_SECONDS = 600
CONTACT = ("unit_contact", "verification_contact_patch")
FETI = ("unit_feti", "verification_contact_patch")
FRICTION = ("unit_feti", "verification_friction")


@dataclass
class Fault:
    """A fault: what is wrong, where, by which replacements, and the tests that are to see it."""

    what: str
    file: str
    replacements: tuple
    tests: tuple


def fault(what, file, old, new, tests):
    return Fault(what, file, ((old, new),), tests)


FAULTS = (
    fault(
        "sign of a contact row", "packages/contact/src/Harmos_ContactRows.cpp",
        "row.terms.push_back({term.node * components + c, term.weight * along});",
        "row.terms.push_back({term.node * components + c, -term.weight * along});", CONTACT),
    fault(
        "weights of both signs hold a prescribed edge", "packages/contact/src/Harmos_ContactRows.cpp",
        "row.follows += term.weight;", "row.follows += std::abs(term.weight);", ("unit_contact",)),
    Fault(
        "a dropped gluing row where four subdomains meet",
        "packages/feti/src/torn/Harmos_BuiltRows.cpp",
        (("for (std::size_t k = 0; k < rows.count(); ++k) {",
          "for (std::size_t k = 0; k < std::min<std::size_t>(rows.count(), 2); ++k) {"),
         ("DirichletForm::Dual ? copies : copies - 1;",
          "DirichletForm::Dual ? copies : std::min(copies - 1, 2LL);")), FETI),
    fault(
        "wrong kernel: a rotation that is none", "packages/feti/src/torn/Harmos_Kernel.cpp",
        "at(point, a, column) = -scale *", "at(point, a, column) = scale *", FETI),
    fault(
        "too long step of MPRGP", "packages/qp/src/iterations/Harmos_MprgpIteration.hpp",
        "return options_.stepFactor / hessian_.norm;",
        "return 4.0 * options_.stepFactor / hessian_.norm;",
        ("unit_qp", "unit_qp_random")),
    fault(
        "curvatures below the norm's rounding are none", "packages/qp/src/iterations/Harmos_MprgpIteration_def.hpp",
        "curvature <= flat && curvature <= roundingOfCurvature();", "curvature <= flat;", ("unit_qp_problems",)),
    fault(
        "b = 0 is measured by nothing", "packages/qp/src/solvers/Harmos_SolverManager_def.hpp",
        "if (tests_.load.is_null() || tests_.load->scale() > 0.0)", "if (true)", ("unit_qp_problems",)),
    fault(
        "cells that cover each other are no fold", "packages/fem/src/mesh/Harmos_CellSides.cpp",
        "return cornerOf(b, (k + 1) % corners) == cornerOf(a, 1) &&",
        "return cornerOf(b, k) != cornerOf(a, 0) &&", ("unit_fem",)),
    fault(
        "sign of the multiplier's update in SMALBE",
        "packages/qp/src/iterations/Harmos_BoundedLagrangian_def.hpp",
        "MvAddMv(1.0, *mu_, factor * penalty_, *residual_.vector, *mu_);",
        "MvAddMv(1.0, *mu_, -factor * penalty_, *residual_.vector, *mu_);",
        ("unit_qp_serial", "unit_qp")),
    fault(
        "swapped scaling of the preconditioner",
        "packages/feti/src/dual/Harmos_DualPreconditioner.cpp",
        "const double weight = scaling == PreconditionerScaling::Stiffness\n",
        "const double weight = scaling == PreconditionerScaling::Multiplicity\n", FETI),
    fault(
        "rows that depend on others are unseen by M", "packages/feti/src/dual/Harmos_DualPreconditioner.cpp",
        "isByDiagonal[static_cast<std::size_t>(factor.pivots()[k])] = 1;",
        "isByDiagonal[static_cast<std::size_t>(factor.pivots()[k])] = 0;", FETI),
    fault(
        "terms of a dof that cancel leave rounding errors", "packages/feti/src/torn/Harmos_GivenRows.cpp",
        "if (std::abs(sum.coefficient) <= rounding * size)", "if (size == 0.0)", FETI),
    fault(
        "deformation is taken for drift", "packages/run/src/results/Harmos_Drift.cpp",
        "left -= m[i] * rhs[i];", "left -= m[i] * m[i];", ("unit_run",)),
    fault(
        "half of the projector", "packages/feti/src/coarse/Harmos_ReplicatedCoarse.cpp",
        "addGt(-1.0, applyG(v, c), v, c);", "addGt(-0.5, applyG(v, c), v, c);", FETI),
    fault(
        "sign of the gap in the dual load", "packages/feti/src/dual/Harmos_DualProblem.cpp",
        "view(r, 0) -= constraints.bound(", "view(r, 0) += constraints.bound(", FETI),
    fault(
        "prescribed values added to bounds", "packages/feti/src/torn/Harmos_GivenRows.cpp",
        "bound -= result.prescribed.back();", "bound += result.prescribed.back();", FETI),
    fault(
        "rigid motion of the wrong sign in the recovery",
        "packages/feti/src/solve/Harmos_Recovery.cpp",
        "values[j] += factor * column[j];", "values[j] -= factor * column[j];", FETI),
    fault(
        "a side of an average of the wrong sign", "packages/feti/src/torn/Harmos_Clusters.cpp",
        "[&](const Copies& dof) { return dof.values[level][copy]; }",
        "[&](const Copies& dof) { return std::abs(dof.values[level][copy]); }", FETI),
    fault(
        "motions of a cluster in other bases than those that they are used with",
        "packages/feti/src/torn/Harmos_Clusters.cpp",
        "return system_.kernel(bases_[static_cast<std::size_t>(subdomain)]);",
        "return system_.kernel(subdomain);", FETI),
    Fault(
        "motions of a cluster that open its joins", "packages/feti/src/torn/Harmos_Clusters.cpp",
        (("constexpr double zero = 1e-10;", "constexpr double zero = 1e-1;"),
         ("constexpr double closed = 1e-9;", "constexpr double closed = 1e9;")), FETI),
    fault(
        "averages over what is prescribed", "packages/feti/src/torn/Harmos_Clusters.cpp",
        "if (isPrescribed[static_cast<std::size_t>(entry.dof)] != 0)",
        "if (isPrescribed[static_cast<std::size_t>(entry.dof)] > 1)", FETI),
    fault(
        "motions of a whole cluster left in S₀", "packages/feti/src/local/Harmos_ClusterInverse.cpp",
        "s[j * rows + i] += mean * t[c + i] * t[c + j];",
        "s[j * rows + i] += 0.0 * mean * t[c + i] * t[c + j];", FETI),
    fault(
        "forces of averages not recovered", "packages/feti/src/solve/Harmos_Recovery.cpp",
        "joined->clusters().addJoined(answer.averages, *total);", "joined->clusters();", FETI),
    fault(
        "faces of clusters that move apart in the preconditioner",
        "packages/feti/src/torn/Harmos_Clusters.cpp",
        "move.sides.push_back(sideOf(dofs, copy, columns, one));",
        "move.sides.push_back(sideOf(dofs, copy, columns,\n                                "
        "[&](const Copies&) { return copy == 0 ? 1.0 : -1.0; }));", FETI),
    fault(
        "rounding errors of S hold the kernel", "packages/feti/src/local/Harmos_LocalInverse.cpp",
        "const double least = std::sqrt(std::numeric_limits<double>::epsilon());",
        "const double least = 0.0;", FETI),
    fault(
        "rounding errors of G hold a motion", "packages/feti/src/coarse/Harmos_CoarseRows.cpp",
        "constexpr double unit = 1e2 * std::numeric_limits<double>::epsilon();",
        "constexpr double unit = 0.0;", ("unit_run",)),
    fault(
        "gap of mortar contact reversed", "packages/contact/src/Harmos_Mortar.cpp",
        "point.gap = sum.gap / sum.area;", "point.gap = -sum.gap / sum.area;", CONTACT),
    fault(
        "a node without a multiplier keeps its carrier", "packages/contact/src/Harmos_FacetMultipliers.cpp",
        "result[j] += shares_[x][j] * carriers[x];", "result[j] += 0.0 * carriers[x];", CONTACT),
    fault(
        "sharp edges are averaged over", "packages/contact/src/Harmos_SurfaceSides.cpp",
        "dot(corners[a].normal, corners[b].normal) > least", "dot(corners[a].normal, corners[b].normal) > -2.0",
        CONTACT),
    fault(
        "pressures of six-node triangles by tributary areas", "packages/contact/src/Harmos_Pressures.cpp",
        "if (surface.facetType != fem::CellType::Triangle6)", "if (surface.dimension > 0)", CONTACT),
    fault(
        "gap of an obstacle reversed", "packages/contact/src/Harmos_Obstacle.cpp",
        "point.gap = separation.gap;", "point.gap = -separation.gap;", CONTACT),
    fault(
        "thermal load of the wrong sign", "packages/fem/src/integrals/Harmos_Elasticity.cpp",
        "stress += material[r][s] * expansion[s] * rise(c, q);",
        "stress -= material[r][s] * expansion[s] * rise(c, q);",
        ("unit_fem", "verification_elements")),
    fault(
        "outward normal that looks inward", "packages/fem/src/integrals/Harmos_Loads.cpp",
        "normal = {tangent[0][1], -tangent[0][0], 0.0};",
        "normal = {-tangent[0][1], tangent[0][0], 0.0};",
        ("unit_fem", "verification_elements")),
    fault(
        "the audit forgets penetration", "packages/feti/src/solve/Harmos_KktAudit.cpp",
        "audit.penetration <= length + limits.boundRounding",
        "audit.penetration <= 1e9 * length + limits.boundRounding", ("unit_run",)),
    fault(
        "sign of the bound in residuals of rows", "packages/feti/src/torn/Harmos_Constraints.cpp",
        "view(r, 0) -= bound(static_cast<int>(r)) + ",
        "view(r, 0) -= -bound(static_cast<int>(r)) + ", ("unit_feti",)),
    fault(
        "gaps of open contacts in the solver's error", "packages/feti/src/solve/Harmos_RowErrors.cpp",
        "view(r, 0) = std::max(view(r, 0), 0.0);",
        "view(r, 0) = std::min(view(r, 0), 0.0);", ("unit_run",)),
    fault(
        "sign of the shift in intervals of friction", "packages/feti/src/dual/Harmos_DualProblem.cpp",
        "return constraints.isInterval(row) ? -shift + limitOf(row) : none;",
        "return constraints.isInterval(row) ? shift + limitOf(row) : none;", FRICTION),
    fault(
        "sign of the shift in discs", "packages/feti/src/dual/Harmos_DualProblem.cpp",
        "{-shift(static_cast<std::size_t>(first), 0),", "{shift(static_cast<std::size_t>(first), 0),",
        FRICTION),
    fault(
        "limits scaled the other way", "packages/feti/src/torn/Harmos_BuiltRows.cpp",
        "row.limit / scale", "row.limit * scale", FRICTION),
    fault(
        "sign of slips of the step before", "packages/effects/src/Harmos_Friction.cpp",
        "bounds[k] += state.get<SlipState>(rows[k].place).begun[t];",
        "bounds[k] -= state.get<SlipState>(rows[k].place).begun[t];", ("verification_friction",)),
    fault(
        "slips against their force in the audit", "packages/feti/src/solve/Harmos_RowErrors.cpp",
        "view(r, 0) * lambda(r, 0) > 0.0;", "view(r, 0) * lambda(r, 0) != 0.0;", ("unit_feti",)),
    fault(
        "work of friction among what is stored", "packages/run/src/steps/Harmos_EnergyAccount.cpp",
        "answer.freeStrainEnergy - answer.frictionWork", "answer.freeStrainEnergy",
        ("verification_friction",)),
    fault(
        "a limit that is no force",
        "packages/scene/src/discretisation/Harmos_ConstraintCollector.cpp",
        "slip.follows ? value : value * points[k].area", "value", ("verification_friction",)),
    fault(
        "a coefficient of scaled forces", "packages/feti/src/torn/Harmos_RowConditions.cpp",
        "row.coefficient * rows[static_cast<std::size_t>(normal)].scale / row.scale",
        "row.coefficient * row.scale / rows[static_cast<std::size_t>(normal)].scale", ("unit_feti",)),
    fault(
        "forces that do not take friction along", "packages/qp/src/kernels/Harmos_ActiveFace.cpp",
        "const double moved = coupling.factor * x[coupling.source];",
        "const double moved = 0.0 * x[coupling.source];",
        ("unit_qp_serial",)),
    fault(
        "friction that knows no sides", "packages/qp/src/blocks/Harmos_FollowingLimits.cpp",
        "was != 0 && -was * g[i] > how.gradientNoise", "was != 0 && was * g[i] > how.gradientNoise", ("unit_qp",)),
    fault(
        "cones that are wider", "packages/qp/src/blocks/Harmos_FollowingLimits.cpp",
        "std::max(0.0, (n + f * length) / (1.0 + f * f))", "std::max(0.0, (n + f * length))", ("unit_qp",)),
    fault(
        "a refused design that is not far worse", "packages/rol/src/Harmos_GuardedFunction.cpp",
        "known.value = farAbove * (1.0 + largest_);", "known.value = largest_;", ("unit_rol",)),
    fault(
        "an error that an optimiser keeps to itself", "packages/rol/src/Harmos_GuardedFunction.cpp",
        "known.gradientTolerance = tolerance;\n  } catch (...) {\n    error_ = std::current_exception();",
        "known.gradientTolerance = tolerance;\n  } catch (...) {", ("unit_rol",)),
    fault(
        "a cost whose size decides of the first step", "packages/rol/src/Harmos_Minimise.cpp",
        "factor_ = firstStep_ / norm;", "factor_ = 1.0;", ("unit_rol",)),
    fault(
        "open contacts that count in derivatives",
        "packages/sensitivity/src/Harmos_Sensitivities.cpp",
        "isClosed ? Status::Closed : Status::Open;", "Status::Closed;", ("unit_sensitivity",)),
    fault(
        "rates in which weak contacts are decided",
        "packages/sensitivity/src/Harmos_Sensitivities.cpp",
        "if (isWeak_[r] != 0 && !isAdjoint)", "if (isWeak_[r] > 1 && !isAdjoint)",
        ("unit_sensitivity",)),
    fault(
        "increments that move what is held", "packages/feti/src/pipeline/Harmos_DualPipeline.cpp",
        "  system->setPrescribed(held);\n", "", ("unit_feti",)),
    fault(
        "rounding errors of gaps in adjoints", "packages/feti/src/torn/Harmos_RowConditions.cpp",
        "  boundRounding_ = std::sqrt(sums[1]);\n", "", ("unit_sensitivity",)),
    fault(
        "factors of shapes that moved", "packages/feti/src/pipeline/Harmos_DualPipeline.cpp",
        "!before.empty() && now[i] == before[i] ? 1 : 0", "!before.empty() ? 1 : 0", ("unit_feti",)),
    fault(
        "factors of subdomains in which other dofs are constrained",
        "packages/feti/src/local/Harmos_LocalInverses.hpp",
        "return members == other.members && boundary == other.boundary;", "return members == other.members;",
        ("unit_feti",)),
    fault(
        "bounds of the prescribed values of before", "packages/feti/src/pipeline/Harmos_DualPipeline.cpp",
        "  areBoundsStale_ = true;\n", "", ("unit_feti",)),
    fault(
        "single precision that is never enough", "packages/feti/src/pipeline/Harmos_JudgedSolve.cpp",
        "  if (roundingIsSeen_)\n    solveInDoublePrecision(monitor);\n", "", ("unit_run",)),
)


def misfits(source):
    """Sentences about replacements whose text is not in its file exactly once."""
    result = []
    for number, item in enumerate(FAULTS, 1):
        text = (source / item.file).read_text(encoding="utf-8")
        for old, new in item.replacements:
            if text.count(old) != 1:
                result.append(f"fault {number} ({item.what}): {item.file} has "
                              f"{text.count(old)} times {old!r}")
            if old == new:
                result.append(f"fault {number} ({item.what}): nothing is replaced")
    return result


class Copy:
    """A copy of the sources, where faults are planted, and its build tree."""

    def __init__(self, directory, jobs, lock):
        self.source = Path(directory) / "source"
        self.build = self.source / "build"
        self.jobs, self.lock = jobs, lock
        self.log = Path(directory) / "mutation_check.log"
        self.source.mkdir(parents=True, exist_ok=True)
        files = subprocess.run(["git", "ls-files", "-z"], cwd=SOURCE, check=True,
                               capture_output=True, text=True).stdout
        for name in filter(None, files.split("\0")):
            self.take_over(name)

    def take_over(self, name):
        """A file as it is in the sources; unchanged ones keep their time and are not rebuilt."""
        there, here = SOURCE / name, self.source / name
        if not there.is_file():
            return
        here.parent.mkdir(parents=True, exist_ok=True)
        if not here.exists() or here.read_bytes() != there.read_bytes():
            shutil.copyfile(there, here)
            shutil.copymode(there, here)

    @contextlib.contextmanager
    def planted(self, item):
        """With the fault in its file, which afterwards is as it was before."""
        path = self.source / item.file
        before = path.read_text(encoding="utf-8")
        text = before
        for old, new in item.replacements:
            text = text.replace(old, new)
        path.write_text(text, encoding="utf-8")
        try:
            yield
        finally:
            path.write_text(before, encoding="utf-8")

    def call(self, command, timeout=None):
        with open(self.log, "a", encoding="utf-8") as log:
            log.write("$ " + " ".join(map(str, command)) + "\n")
            log.flush()
            try:
                return subprocess.run(
                    command, stdout=log, stderr=log, timeout=timeout, env=runs.environment()).returncode
            except subprocess.TimeoutExpired:
                log.write("timed out\n")
                return -1

    def configure(self):
        if self.call(["cmake", "-S", self.source, "-B", self.build, "-DCMAKE_BUILD_TYPE=Release",
                      "-DHARMOS_ENABLE_GMSH=ON", "-DHARMOS_ENABLE_ROL=ON", "-DHARMOS_ENABLE_TESTS=ON"]) != 0:
            raise SystemExit(f"cannot be configured; see {self.log}")

    def make(self, targets):
        return self.call(["cmake", "--build", self.build, f"-j{self.jobs}", "--target",
                          *targets]) == 0

    def put_aside(self, number, tests):
        """Programs as they are now; they hold the packages in themselves."""
        directory = self.programs(number)
        directory.mkdir(parents=True, exist_ok=True)
        for test in tests:
            shutil.copy2(self.build / "tests" / "bin" / test, directory / test)

    def programs(self, number):
        return self.source / "build" / "mutants" / str(number)

    def passes(self, number, test):
        """On two ranks where the test knows them, which shows faults of the exchange; then on one, which has clusters of
        more subdomains."""
        program = self.programs(number) / test
        return all(
            self.call([os.environ.get("HARMOS_MPIEXEC", "mpirun"), "-np", ranks, program], timeout=TEST_SECONDS) == 0
            for ranks in (("1",) if test in ("unit_fem", "unit_qp_serial") else ("2", "1"))
        )


@contextlib.contextmanager
def locked(path):
    if path is None:
        yield
        return
    with open(path, "w", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def build_all(copy, numbers):
    """Builds the tests of each fault, and those without any (0), and puts them aside: all builds in
    one go, so that a lock is waited for once. Returns the numbers that do not compile."""
    failing = []
    with locked(copy.lock):
        for number in [0, *numbers]:
            item = FAULTS[number - 1] if number else None
            tests = item.tests if item else all_tests(numbers)
            with copy.planted(item) if item else contextlib.nullcontext():
                if copy.make(tests):
                    copy.put_aside(number, tests)
                else:
                    failing.append(number)
    return failing


def all_tests(numbers):
    return sorted({test for number in numbers for test in FAULTS[number - 1].tests})


def check(copy, numbers):
    """Plants the faults; the exit status."""
    copy.configure()
    not_compiled = build_all(copy, numbers)
    failing = ["the build"] if 0 in not_compiled else [
        test for test in all_tests(numbers) if not copy.passes(0, test)]
    if failing:
        print(f"without any fault: {', '.join(failing)} fails; see {copy.log}")
        return 1
    print(f"| {'':>2} {'fault':<49} | {'caught by':<28} | seconds |", flush=True)
    survivors = 0
    for number in numbers:
        item = FAULTS[number - 1]
        begin = time.monotonic()
        if number in not_compiled:
            name = "NOT COMPILED"  # no fault of the kind that is meant
        else:
            name = next((test for test in item.tests if not copy.passes(number, test)), "SURVIVES")
        survivors += 1 if name in ("NOT COMPILED", "SURVIVES") else 0
        seconds = time.monotonic() - begin
        print(f"| {number:>2} {item.what:<49} | {name:<28} | {seconds:7.0f} |", flush=True)
    return 1 if survivors else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--list", action="store_true", help="list the faults and check their texts")
    parser.add_argument("--only", type=int, action="append", metavar="N",
                        help="this fault; may be repeated")
    parser.add_argument("--jobs", type=int, default=2, help="of the build [2]")
    parser.add_argument("--build-dir",
                        help="where the copy and its build are kept [a temporary directory]")
    parser.add_argument("--lock", help="a file that is locked while building")
    arguments = parser.parse_args()
    numbers = arguments.only or list(range(1, len(FAULTS) + 1))
    if any(not 1 <= number <= len(FAULTS) for number in numbers):
        parser.error(f"faults are numbered 1 to {len(FAULTS)}")
    wrong = misfits(SOURCE)
    if wrong:
        print("\n".join(wrong))
        return 2
    if arguments.list:
        for number, item in enumerate(FAULTS, 1):
            print(f"{number:>2} {item.what} ({item.file}): {', '.join(item.tests)}")
        return 0
    if arguments.build_dir:
        return check(Copy(arguments.build_dir, arguments.jobs, arguments.lock), numbers)
    with tempfile.TemporaryDirectory(prefix="harmos_mutations_") as directory:
        return check(Copy(directory, arguments.jobs, arguments.lock), numbers)


if __name__ == "__main__":
    sys.exit(main())
