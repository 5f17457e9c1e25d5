// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Elasticity.hpp"
#include "Harmos_MaterialStates.hpp"

#include <array>
#include <memory>
#include <vector>

namespace Harmos::fem {

/// A solution on a mesh. Several meshes that are congruent, and so one, are gone through once for all theirs.
struct NodalSolution {
  const std::vector<double>* values; ///< displacements; one value a node of a membrane
  double temperature = 0.0;          ///< rise
  /// Rises at nodes, besides; see TemperatureField. Null: none.
  std::shared_ptr<const std::vector<double>> temperatures = nullptr;
  const MaterialStates* states = nullptr; ///< of materials with these displacements, where they have any
};

/// Stresses at nodes, to be averaged over subdomains: sums over the cells around each node of size times
/// stress, and of size.
struct StressSums {
  std::vector<Voigt> weighted;
  std::vector<double> size;
  std::vector<std::array<int, 2>> regions; ///< the least and the largest around the node
  std::vector<double> states = {};         ///< size times MaterialLaw::shownState(), where materials have any
};

/// In each cell, stresses at the points of the rule one order lower (where they are superconvergent: Barlow
/// 1976) are fitted by a polynomial one degree lower than the element and taken at the nodes.
/// σ = C(ε̄ − ε_T); in plane strain σ_zz is among them.
std::vector<StressSums> stressSums(const Mesh& mesh, const Elasticity& elasticity,
                                   const std::vector<NodalSolution>& solutions);

/// The mean over each cell of the stresses that its element has, by the quadrature of the stiffness; of each
/// solution. Not recovered: they jump from cell to cell.
std::vector<std::vector<Voigt>> cellStresses(const Mesh& mesh, const Elasticity& elasticity,
                                             const std::vector<NodalSolution>& solutions);

/// Like stressSums() for −Δ: the gradient of u, in the first two entries.
std::vector<StressSums> fluxSums(const Mesh& mesh, const std::vector<NodalSolution>& solutions);

/// Squared, over a mesh and all its solutions. What the recovered stresses σ* (continuous, by the basis
/// functions from their nodal values) differ from those of the elements estimates the error of the latter
/// (Zienkiewicz, Zhu: A simple error estimator and adaptive procedure for practical engineering analysis,
/// Int. J. Numer. Meth. Engng. 24, 1987).
struct RecoveryError {
  double error = 0.0;  ///< ∫ (σ* − σ_h) : C⁻¹ : (σ* − σ_h)
  double energy = 0.0; ///< ∫ σ_h : C⁻¹ : σ_h
  /// Of each cell of each solution the error; less than zero: it counts nothing, and is not known.
  std::vector<std::vector<double>> cells = {};
};
/// @param recovered of each solution: the mean stresses, in the place of the sums. Cells at nodes where
/// regions meet count nothing towards the error: stresses jump there, and the mean is no better than they
/// are.
/// Guarded by tests/unit/fem/test_recovery_error.cpp.
RecoveryError recoveryError(const Mesh& mesh, const Elasticity& elasticity,
                            const std::vector<NodalSolution>& solutions,
                            const std::vector<const StressSums*>& recovered);
/// The same for −Δ: ∫ |q* − ∇u|² and ∫ |∇u|².
RecoveryError fluxRecoveryError(const Mesh& mesh, const std::vector<NodalSolution>& solutions,
                                const std::vector<const StressSums*>& recovered);

} // namespace Harmos::fem
