// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Constraints.hpp"

#include <vector>

namespace Harmos::feti {

// What rows of an answer that holds only to a tolerance say. Limited rows whose force is the limit slip along
// it.

/// Of each owned row whether it holds as an equation: not open contacts and what slips. Local.
std::vector<char> holdAsEquations(const Constraints& constraints, const MultiVector& multiplier);

/// What is wrong with Bu − c − Cλ: of open contacts penetrations, of what slips anything but slips along the
/// force. Local.
void keepErrors(const Constraints& constraints, const MultiVector& multiplier, MultiVector& residual);

} // namespace Harmos::feti
