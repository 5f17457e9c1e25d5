// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_StressSums.hpp"

#include <vector>

namespace Harmos::fem {

/// Stresses around the corners of cells, by polynomials of the order of the elements: sums of the least
/// squares over the points, in the cells around a corner, where stresses are superconvergent (Zienkiewicz,
/// Zhu: The superconvergent patch recovery and a posteriori error estimates, Part 1, Int. J. Numer. Meth.
/// Engng. 33, 1992). Elements of the first order have one point a cell, which counts by its size: the
/// polynomial is the mean. Stresses jump where regions meet; each has polynomials of its own there.
///
/// Sums add up over the subdomains around a corner.
struct StressPatches {
  /// Of the cells of a region around a node. All of a mesh, rising.
  struct Place {
    int node, region;
  };
  std::vector<Place> places;
  int functions = 1;           ///< m: 1; or 1, x, y(, z) and their products, from the node
  std::vector<double> gram;    ///< Σ φ_a φ_b, of each place m × m
  std::vector<double> moments; ///< Σ φ_a σ, of each place m × 6

  std::size_t gramSize() const { return static_cast<std::size_t>(functions * functions); }
  std::size_t momentSize() const { return static_cast<std::size_t>(6 * functions); }
};

/// Of each solution. σ = C(ε̄ − ε_T); in plane strain σ_zz is among them.
std::vector<StressPatches> stressPatches(const Mesh& mesh, const Elasticity& elasticity,
                                         const std::vector<NodalSolution>& solutions);
/// Like stressPatches() for −Δ: the gradient of u, in the first two entries.
std::vector<StressPatches> fluxPatches(const Mesh& mesh, const std::vector<NodalSolution>& solutions);

/// Squared, over a mesh and all its solutions. What the recovered stresses σ* (by the basis functions from
/// their values at nodes: at corners of the polynomial there, at others the mean of those of the nearest
/// corners) differ from those of the elements estimates the error of the latter (Zienkiewicz, Zhu: A simple
/// error estimator and adaptive procedure for practical engineering analysis, Int. J. Numer. Meth. Engng. 24,
/// 1987).
struct RecoveryError {
  double error = 0.0;                          ///< ∫ (σ* − σ_h) : C⁻¹ : (σ* − σ_h)
  double energy = 0.0;                         ///< ∫ σ_h : C⁻¹ : σ_h
  std::vector<std::vector<double>> cells = {}; ///< of each cell of each solution the error
};
/// @param patches of each solution. Guarded by tests/unit/fem/test_recovery_error.cpp.
RecoveryError recoveryError(const Mesh& mesh, const Elasticity& elasticity,
                            const std::vector<NodalSolution>& solutions,
                            const std::vector<const StressPatches*>& patches);
/// The same for −Δ: ∫ |q* − ∇u|² and ∫ |∇u|².
RecoveryError fluxRecoveryError(const Mesh& mesh, const std::vector<NodalSolution>& solutions,
                                const std::vector<const StressPatches*>& patches);

} // namespace Harmos::fem
