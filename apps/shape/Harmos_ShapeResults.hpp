// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_DesignProblem.hpp"
#include "Harmos_Functional.hpp"
#include "Harmos_RunReport.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::shape {

/// A row of history.csv: an iterate that was accepted.
struct HistoryRow {
  int iteration = 0, evaluations = 0;
  double cost = 0.0, gradientNorm = 0.0, violation = 0.0, step = 0.0;
  int refused = 0;
  double seconds = 0.0;
};
/// With its first line. Infinite and missing numbers are left empty.
std::string historyText(const std::vector<HistoryRow>& rows);

/// A contact point in one state.
struct PointState {
  fem::Point position{};
  double gap = 0.0, pressure = 0.0, area = 0.0;
};
/// Of the contact points of some surfaces, of this rank.
struct SurfaceState {
  std::vector<long long> numbers, nodes;
  std::vector<int> surfaces;
  std::vector<PointState> points;
};
/// @param rows with their gaps at rest. @param forces of each. Local.
SurfaceState surfaceState(const scene::ContactSetup& contact, const std::vector<ConstraintRow>& rows,
                          const sensitivity::RowGeometry& geometry, const std::vector<double>& forces);

/// shape.csv as text: all points of all ranks before and after, by their numbers. @note Collective; empty but
/// on rank 0.
std::string shapeText(const Teuchos::Comm<int>& comm, const scene::Scene& scene, const SurfaceState& before,
                      const SurfaceState& after);

/// design.csv as text. @param places of the numbers, or none.
std::string designText(const sensitivity::DesignSpace& space, const std::vector<double>& best,
                       const std::vector<fem::Point>& places);

/// An answer, as all that writes it takes it. All to outlive this.
struct Answer {
  const Teuchos::Comm<int>& comm;
  const scene::Scene& scene;
  const std::vector<scene::OwnedSubdomain>& owned;
  const scene::ContactSetup& contact;
  const feti::FetiSolver& solver;
};
/// The fields of an answer, as a run of harmos writes them. @throws InputError on all ranks. @note
/// Collective.
void writeFields(const Answer& answer, const std::string& path, bool withStresses);
/// What a report tells of an answer: dimensions, audit, contact, forces. @note Collective.
void tell(const Answer& answer, const feti::SolveReport& solve, run::RunReport& report);

} // namespace Harmos::shape
