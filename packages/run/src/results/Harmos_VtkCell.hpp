// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"

#include <vector>

namespace Harmos::run {

/// A cell as VTK's files have it.
struct VtkCell {
  unsigned char type;     ///< VTK's number
  std::vector<int> nodes; ///< our node at each place of VTK's order
};

/// VTK's number of a point by itself.
constexpr unsigned char vtkVertex = 1;

/// Local.
VtkCell vtkCell(fem::CellType type);

} // namespace Harmos::run
