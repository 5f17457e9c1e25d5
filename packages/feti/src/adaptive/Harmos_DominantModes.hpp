// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundaryOperator.hpp"

#include <cstdint>
#include <vector>

namespace Harmos::feti {

/// The modes Nv = μSv with the largest μ.
struct DominantModes {
  std::vector<double> values;  ///< μ, falling
  std::vector<double> vectors; ///< v with vᵀNv = 1, column after column
};

/// Those with μ above a threshold, by block Krylov sequences of S⁺N with Rayleigh–Ritz (Golub, Van Loan,
/// Matrix Computations, 4th ed., section 10.3): values far above it are exact to some digits, those near it
/// are found or not.
/// @param energy N, n × n, whole and positive semidefinite; it is taken apart. @param inverse S⁺, a
/// generalised inverse.
/// @param kernel of S, n × kernelColumns: the modes are orthogonal to it in N.
/// @param most of them. @param seed of the first block.
/// @throws NumericalError, InternalError. Local. Guarded by tests/unit/feti/test_adaptive_space.cpp.
DominantModes dominantModes(const std::vector<double>& energy, const BoundaryOperator& inverse,
                            const std::vector<double>& kernel, int kernelColumns, double threshold, int most,
                            std::uint64_t seed);

} // namespace Harmos::feti
