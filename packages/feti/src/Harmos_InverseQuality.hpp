// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalInverse.hpp"

#include <string>

namespace Harmos::feti {

/// How well an inverse does, found with two fixed pseudo-random vectors.
struct InverseQuality {
  /// ‖KK⁺Kx − Kx‖/‖Kx‖
  double defect = 0.0;
  /// ‖D⁻¹Kv‖/‖v‖ in the maximum norm, v = (I − RRᵀ)K⁺b, D the diagonal of K: rounding errors if K has a
  /// kernel that R misses.
  double resistance = 0.0;
  /// An estimate from below of the condition number of D⁻¹K on the complement of the kernel of K.
  double condition() const { return 1.0 / resistance; }
};
InverseQuality inverseQuality(const LocalMatrix& matrix, const Kernel& kernel, const LocalInverse& inverse);

/// Number of null pivots that MUMPS finds in K (LDLᵀ, threshold 1e-8): to compare with the kernel's
/// dimension. A cross-check only, which can miscount where materials vary much.
int countNullPivots(const LocalMatrix& matrix);

/// Why a matrix may have a kernel that was not expected, in words for an error message.
std::string causeOfHiddenMotion(const LocalMatrix& matrix, const Kernel& kernel);

} // namespace Harmos::feti
