// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_ErrorNorms.hpp"
#include "Harmos_PointLocator.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_Solution.hpp"

#include <Teuchos_Comm.hpp>

#include <functional>
#include <map>
#include <vector>

namespace Harmos::run {

/// Norms of a solution or of a difference of two.
struct SolutionNorms {
  double energy = 0.0;       ///< (∫ ε : C : ε)^{1/2}, of membranes (∫ |∇u|²)^{1/2}
  double displacement = 0.0; ///< (∫ |u|²)^{1/2}
  double pressure = 0.0;     ///< of the contact pressure, (Σ A_k p_k²)^{1/2} over the contact points
  double contactArea = 0.0;  ///< Σ A_k over the closed points; of two solutions the difference, unsigned
  /// Of the slips since the beginning, (Σ A_k |s_k|²)^{1/2} over the points that bear friction; of two
  /// solutions over those that do in the reference.
  double slip = 0.0;
  double stickArea = 0.0; ///< Σ A_k over the points that stick; of two solutions the difference, unsigned
};

/// A finished run as comparisons need it: the scene for its materials, meshes and displacements of this
/// rank, contact on every rank.
struct FinishedRun {
  scene::Scene scene;
  Solution solution;
  std::vector<contact::ContactPoint> points; ///< none without contact
  std::vector<ContactState> states;          ///< of each point
};

/// Norms of one run. @note Collective.
SolutionNorms normsOf(const Teuchos::Comm<int>& comm, const FinishedRun& run);

/// Norms of the difference of two runs on the same meshes, cut in the same way: node by node. The second is
/// the reference.
/// @throws InternalError if they are not. @note Collective.
SolutionNorms differenceOnSameMesh(const Teuchos::Comm<int>& comm, const FinishedRun& first,
                                   const FinishedRun& second);

/// Differences between a reference and runs on another mesh, cut in whatever way.
///
/// Integrals go over the cells of the reference, distributed as it is, with the rule of its stiffness
/// matrix (fem::errorDegree()) and its materials; the other solution is evaluated at the quadrature points,
/// body by body (fem::PointLocator) and as torn as it is, which loses nothing where cells of the reference
/// lie within those of the other mesh. Dilatation counts in full, also where the stiffness projects it.
/// Contact pressures and slips are compared at the contact points of the reference with their areas; between
/// its nodes the other pressure, and the other slip, go like the trace of the displacement.
///
/// Points are located once, at construction; the other mesh is gathered on every rank. Memory: 32 bytes a
/// quadrature point of the reference, and the other mesh.
/// Guarded by tests/unit/run/test_solution_comparison.cpp.
class SolutionComparison {
 public:
  /// @param reference has to outlive this. @param other any run on the other mesh.
  /// @throws InputError on all ranks if they have not the same bodies. @note Collective.
  SolutionComparison(const Teuchos::Comm<int>& comm, const FinishedRun& reference, const FinishedRun& other);

  /// Norms of (run − reference), for a run on the same meshes, cut in the same way, as at construction.
  /// @throws InternalError on all ranks if it is on others. @note Collective.
  SolutionNorms difference(const FinishedRun& run) const;

 private:
  /// On the other mesh: which of its body's locators, and the place on that.
  struct Place {
    std::size_t locator;
    int cell;
    fem::Point reference;
  };
  /// Where a contact point of the reference is on the surface of the other mesh.
  struct SurfacePlace {
    const fem::PointLocator* surface = nullptr; ///< null: nowhere, all is zero there
    const std::vector<int>* pointOfNode = nullptr;
    fem::PointLocator::Place place;
  };
  struct Surface {
    fem::PointLocator locator;
    std::vector<int> pointOfNode; ///< place in the run's contact points
  };
  void locateSurface(const FinishedRun& other);
  /// What the states of a run say at the contact points of the reference.
  std::vector<fem::Point> onSurface(const FinishedRun& run, int components,
                                    const std::function<fem::Point(const ContactState&)>& valueOf) const;

  const Teuchos::Comm<int>& comm_;
  const FinishedRun& reference_;
  std::vector<std::vector<fem::PointLocator>>
      bodies_;                             ///< of each one for each type of cells, all nodes in it
  std::vector<std::vector<Place>> places_; ///< of each owned subdomain: cell by cell, point by point
  std::vector<Surface> surfaces_;
  std::vector<SurfacePlace> surfacePlaces_; ///< of the reference's contact points
};

} // namespace Harmos::run
