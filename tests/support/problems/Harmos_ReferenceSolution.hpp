// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_SubdomainSystem.hpp"
#include "Harmos_TestScene.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos {

/// The answer to min ½uᵀKu − fᵀu, Cu ≤ g, Eu = e of the glued bodies, without domain decomposition.
struct ReferenceSolution {
  bool solvable = true;             ///< false: no forces can hold the bodies
  feti::TornVector displacement;    ///< of this rank's subdomains
  std::vector<double> force;        ///< of each inequality, by its number, on every rank
  std::vector<double> gap;          ///< that is left, likewise
  double energy = 0.0;              ///< ½uᵀKu − fᵀu
  double largestDisplacement = 0.0; ///< over all ranks
  /// A basis of the motions that neither K nor any row resists, orthonormal over all ranks: u is one answer
  /// of many.
  std::vector<feti::TornVector> freeMotions;
};

/// Solves a problem of up to some five hundred unknowns in 64-bit mantissas, on every rank by itself.
///
/// Prescribed values are eliminated. With slacks s ≥ 0, Cu + s = g, the saddle-point matrix of (u, λ, ν),
/// scaled to a unit diagonal, is factored once by Gaussian elimination with complete pivoting, which reveals
/// free motions; what remains, λ = q + Hs, λ ≥ 0, s ≥ 0, λᵀs = 0 with H positive semidefinite, is solved by
/// Lemke's algorithm, whose ray proves that there is no solution (Cottle, Pang, Stone: The Linear
/// Complementarity Problem, 1992, section 4.4). The optimality conditions of the answer are verified.
///
/// Shared with what is tested: meshes, element matrices and loads, prescribed values, and the rows of contact
/// and ties on physical dofs. Not shared: gluing, kernels, generalised inverses, duality, quadratic
/// programming, recovery, audit.
///
/// @param subdomains of this rank. @param rows this rank's share; inequalities are to be independent.
/// @throws InternalError if the answer misses its optimality conditions, relative to the terms they are made
///         of, by more than 1e-12: rounding of K, given in 53 bits.
/// @note Collective.
ReferenceSolution referenceSolution(const Teuchos::Comm<int>& comm,
                                    const std::vector<feti::Subdomain>& subdomains,
                                    const std::vector<ConstraintRow>& rows);

/// Of a scene: its subdomains and rows as a run would make them.
ReferenceSolution referenceSolution(const scene::Scene& scene);

/// How far another answer is from the reference, each relative to the largest value of its kind.
struct Deviation {
  double displacement = 0.0; ///< up to free motions
  double force = 0.0;
  double energy = 0.0;
  double largest() const;
};

/// @param force of each inequality, by its number. @note Collective.
Deviation deviation(const ReferenceSolution& reference, const feti::TornVector& displacement,
                    const std::vector<double>& force, double energy);
Deviation deviation(const ReferenceSolution& reference, const TestRun& run);
/// The energy is that of the bodies, without what rows that give way store.
Deviation deviation(const ReferenceSolution& reference, const feti::FetiSolver& solver);

} // namespace Harmos
