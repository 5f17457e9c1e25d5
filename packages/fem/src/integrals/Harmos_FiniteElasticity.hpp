// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Elasticity.hpp"
#include "Harmos_MaterialStates.hpp"

#include <vector>

namespace Harmos::fem {

/// What a mesh answers to displacements, small or finite (Elasticity::strains; total Lagrangian: all
/// integrals over the body at rest).
struct FiniteForces {
  std::vector<double> internal; ///< ∫B(u)ᵀS, by dof = node · dimension + component
  double energy = 0.0;          ///< ∫W
  double dissipated = 0.0;      ///< since the run began
  int yielding = 0;             ///< points that do
  /// The least det F at the points of integration; not positive where a cell is turned inside out, and
  /// nothing else is of use.
  double leastJacobian = 1.0;
};

/// Forces and energy. @param displacement of all nodes. @param rise of temperatures. @param before states of
/// materials when the step began, see initialStates(); null where they have none. @param after gets those of
/// these displacements, if it is not null. @throws NumericalError for cells that are inverted at rest. Local.
FiniteForces finiteForces(const Mesh& mesh, const Elasticity& elasticity,
                          const std::vector<double>& displacement, const TemperatureRise& rise = {},
                          const MaterialStates* before = nullptr, MaterialStates* after = nullptr);

/// The tangent as far as strains alone feel it, ∫B(u)ᵀDB(u), D of strainTangent(): symmetric, positive
/// semidefinite as far as ∂S/∂E is, its kernel the rigid motions of the deformed mesh (FiniteStrain); graph
/// as of assembleElasticity(), and without stress the same. What stresses do to turning cells is not in it.
/// Of small strains D = ∂σ/∂ε.
/// @throws InternalError where a cell is turned inside out. Local.
/// Guarded by tests/unit/fem/test_finite_elasticity.cpp and test_plasticity.cpp.
LocalMatrix assembleStrainTangent(const Mesh& mesh, const Elasticity& elasticity,
                                  const std::vector<double>& displacement, const TemperatureRise& rise = {},
                                  const MaterialStates* before = nullptr);

} // namespace Harmos::fem
