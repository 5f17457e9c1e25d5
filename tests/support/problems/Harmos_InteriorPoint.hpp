// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_TestQp.hpp"

#include <vector>

namespace Harmos {

/// The solution of a strictly convex QP with intervals, discs and equalities by logarithmic barriers,
/// Newton's method and elimination in 64-bit mantissas: shares nothing with the solvers. For intervals and
/// discs with an inside. Off by some 1e-10 at most where the solution is of size one.
/// @param multipliers receives those of the equalities.
std::vector<double> interiorPoint(const SmallQp& qp, std::vector<double>* multipliers = nullptr);

} // namespace Harmos
