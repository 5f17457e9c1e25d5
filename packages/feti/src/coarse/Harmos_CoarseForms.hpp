// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseOptions.hpp"
#include "Harmos_CoarseSpace.hpp"

#include <memory>

namespace Harmos::feti {

/// The coarse space in the form that was asked for, or by the cost model. Where the form is left open and a
/// distributed one proves too inaccurate, it is the replicated one.
/// @throws NumericalError on all ranks if a distributed one was asked for and proves so. @note Collective.
std::unique_ptr<CoarseSpace> makeCoarseSpace(const RigidMotions& motions, const Constraints& constraints,
                                             const CoarseOptions& options = {});

} // namespace Harmos::feti
