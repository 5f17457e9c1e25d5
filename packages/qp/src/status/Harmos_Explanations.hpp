// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_QpTypes.hpp"

#include <string>

namespace Harmos::qp::Explanations {

/// The sentences of Result::explanation: what happened, the likely causes, and what helps.
std::string converged();
std::string breakdown();
std::string interrupted();
/// @param what "the right-hand side", ...
std::string notFinite(const std::string& what);
/// @param limit "500 inner iterations", "3 s", ...
/// Of limits that follow the solution.
std::string limitsDoNotSettle(int updates);
std::string limit(const std::string& limit);
/// @param attainable the level of rounding errors that the projected gradient has reached.
std::string stagnation(double projectedGradient, double attainable, double equalityDistance);
/// Where there is no successor. @param why it got no further.
std::string noOtherMethod(const std::string& why);
/// Of a test of the caller's.
std::string stoppedByTest(Reason reason);
std::string infeasible(const Certificate& certificate);
std::string unbounded(const Certificate& certificate);

} // namespace Harmos::qp::Explanations
