// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"

namespace Harmos::app {

/// The fibre composite of Dostál, Horák, Vlach (section 5, figure 5.1): a sample of square cells, each a
/// circular fibre inserted into its hole in the matrix without adhesion, stretched or compressed.
Application fiberCompositeApplication();

} // namespace Harmos::app
