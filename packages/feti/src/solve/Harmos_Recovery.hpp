// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualProblem.hpp"

#include <vector>

namespace Harmos::feti {

/// The solution of the torn problem.
struct TornSolution {
  TornVector displacement;                    ///< u
  Teuchos::RCP<const MultiVector> multiplier; ///< λ + λ̃, of the scaled rows
  std::vector<double> rigidMotion; ///< α, the coefficients of R: a vector of motions, see CoarseSpace
};

/// u = K⁺(f − Bᵀλ) + Rα from the shifted dual solution λ and the multiplier μ of Gλ = 0.
///
/// α = L⁻ᵀ(G(Fλ − d) − μ) + δ, where δ is the least-squares correction of least norm on the equality rows and
/// the rows with λ_I > 0: those must hold as equations. Those rows alone do not always fix α (an unloaded
/// body in initial penetration has λ = 0), hence the first part.
/// @throws NumericalError, InternalError on all ranks.
/// @note Collective. One product with the local inverses.
/// Guarded by tests/unit/feti/test_recovery.cpp.
TornSolution recover(const SubdomainSystem& system, const Constraints& constraints,
                     const LocalInverses& inverses, const CoarseSpace& coarse, const DualProblem& dual,
                     const MultiVector& lambda, const std::vector<double>& mu);

} // namespace Harmos::feti
