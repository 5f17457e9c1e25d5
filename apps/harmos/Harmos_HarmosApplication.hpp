// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"

namespace Harmos::app {

/// Any scene that a deck describes: bodies from mesh files or generators, materials, effects, output, by
/// name.
/// @param kinematics whether displacements may be finite.
enum class KinematicsChoice { Offered, Small };
Application harmosApplication(KinematicsChoice kinematics = KinematicsChoice::Offered);

} // namespace Harmos::app
