// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"

namespace Harmos::fem {

/// Basis functions of a cell at one point, and their gradients; entries beyond the cell's nodes are unused.
struct CellBasis {
  std::array<double, 27> values;
  std::array<Point, 27> gradients;
};

/// Basis of any cell type at any point of its reference cell, without memory or tables: for places
/// that are not known beforehand. Where they are, ReferenceElement is faster.
/// Guarded by tests/unit/fem/test_point_locator.cpp.
void cellBasis(const CellShape& shape, const Point& reference, CellBasis& basis);

} // namespace Harmos::fem
