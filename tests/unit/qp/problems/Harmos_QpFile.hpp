// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_TestQp.hpp"

#include <string>

namespace Harmos {

/// Reads min ½xᵀAx − bᵀx, l ≤ x ≤ u, Cx = c from a text file: n, m and the number of entries of A; these as
/// row, column, value; b; l; u; the number of entries of C; these; c. Numbers are separated by blanks or line
/// ends; "inf" and "-inf" are such.
/// @throws std::runtime_error with the file's name where it ends early or holds something else.
SmallQp readQp(const std::string& path);

} // namespace Harmos
