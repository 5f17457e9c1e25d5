// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"

namespace Harmos::shape {

/// "shape": the best shape of a contact surface. A deck is one of harmos with the list "Shape" besides.
app::Program shapeProgram();

} // namespace Harmos::shape
