// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ReferenceSolution.hpp"
#include "Harmos_TestFeti.hpp"
#include "Harmos_TestScene.hpp"

#include <array>
#include <string>
#include <vector>

namespace Harmos {

/// Two blocks with a valley between them, in which the upper one, "floating", lies on the lower one,
/// "valley", that is held at its bottom; plane strain, matching meshes. The upper one is pulled down and
/// aside by a force per volume; it bears on the valley's two slopes, but not with all of its nodes.
struct Valley {
  int subdomains = 2; ///< a side of each block
  int elements = 2;   ///< a side of each subdomain
  double length = 1.0;
  double modulus = 1.0; ///< of the lower block; twice that for the upper one
  double load = 0.02;   ///< downwards, a part of modulus / length
  double aside = 0.007; ///< likewise
  double gap = 0.0;     ///< a part of the length
  std::array<std::string, 2> held = {"bottom", "bottom"}; ///< where each component is
};
scene::Scene valley(const Valley& options = {});

/// A rigid half-space below all points with direction · (x − point) = 0.
contact::Obstacle halfSpace(const fem::Point& point, const fem::Point& direction);

/// Products with F from the first iterate to the stop.
double products(const run::RunReport& report);

/// The raw input of the feti package that a scene gives.
TestModel modelOf(const scene::Scene& scene);

/// What solveTorn() finds.
struct TornRun {
  feti::TornSolution torn;
  std::vector<double> mu;    ///< multiplier of Gλ = 0
  std::vector<double> force; ///< of each inequality, by its number, on every rank
  run::RunReport report;     ///< audited
};

/// The stages of a run from torn bodies on, so that tests can change what goes in: matrices, kernels, rows.
/// @param assignments as with --set. @throws as the stages do. @note Collective.
TornRun solveTorn(const TestModel& model, double tolerance, const std::vector<std::string>& assignments = {});

/// The same of a dual problem that is already there.
TornRun solveTorn(const TestFeti& feti, double tolerance, const std::vector<std::string>& assignments = {});

/// Converged, borne out by the audit, and as far from the reference as the bound at most; contact forces not
/// below minus the bound.
void expectReference(const ReferenceSolution& reference, const TestRun& run, double bound,
                     const std::string& what = "");
void expectReference(const ReferenceSolution& reference, const TornRun& run, double bound,
                     const std::string& what = "");

Deviation deviation(const ReferenceSolution& reference, const TornRun& run);

/// Prints a measured figure for docs/stability.md, on rank 0, and records it with the test.
void tellFigure(const std::string& name, double value);

/// How each copy of a dof becomes a dof of its own, with rows that the caller gives in the place of the
/// gluing rows of feti::Constraints.
enum class Gluing {
  Orthonormal, ///< (1, …, 1, −k, 0, …)/√(k(k + 1)): as feti::Constraints makes them
  Chain,       ///< (1, −1) from each copy to the next
  AllPairs     ///< (1, −1) of every two copies
};
/// Which copies of a dof a given row takes.
enum class Copies { Mean, First };

/// The same problem with rows of another kind: what the rules of feti::Constraints are there for. Primal
/// Dirichlet conditions only.
/// @note Collective.
TestModel withRows(const TestModel& model, Gluing gluing, Copies copies = Copies::Mean);

/// Largest over smallest eigenvalue of BBᵀ, rows of length one; a smallest one of rounding errors is none:
/// infinity.
/// @note Collective, dense.
double conditionOfRows(const TestModel& model);

} // namespace Harmos
