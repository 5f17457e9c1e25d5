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
  std::vector<double> states = {}; ///< size times MaterialLaw::shownState(), where materials have any
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

} // namespace Harmos::fem
