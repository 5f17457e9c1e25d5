// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Scene.hpp"

#include <Teuchos_ParameterList.hpp>

namespace Harmos::signorini {

/// The semicoercive model problem of Dostál, Horák, Vlach (section 2): two membranes over (0,1)×(0,1) and
/// (1,2)×(0,1),
///
///     min Σ ½∫|∇uⁱ|² − ∫fuⁱ   subject to   u¹ = 0 at x = 0,   u² − u¹ ≥ 0 at x = 1,
///
/// f = −3 on (0,1)×[0.75,1), −1 on (1,2)×[0,0.25), 0 elsewhere. The second membrane is held by the contact
/// alone.
scene::Scene membranes(const Teuchos::ParameterList& model);

} // namespace Harmos::signorini
