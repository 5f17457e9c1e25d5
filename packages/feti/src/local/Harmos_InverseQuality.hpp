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

/// What rounding errors leave of K: bounds for InverseQuality::defect.
struct DefectLimit {
  double rounding;   ///< what rounding errors explain, given the condition number
  double acceptable; ///< the smaller of it and what an answer can bear: above, the inverse is refused
};
/// Products with a generalised inverse that is formed explicitly leave ‖KK⁺Kx − Kx‖ ≤ c ε κ ‖Kx‖, with ε the
/// unit roundoff of the precision and κ the condition number of K on the complement of its kernel (Higham:
/// Accuracy and Stability of Numerical Algorithms, 2002, section 14.1). κ is known from below only, through
/// slow motions: with it, elastic strips of 1:1 to 1000:1 and ν up to 0.49999 show c up to 30 as far as
/// single precision is of use, and in double up to 20, but 2500 where thin cells are nearly incompressible.
DefectLimit defectLimit(const InverseQuality& quality, const LocalInverseSettings& settings);

/// Number of null pivots that MUMPS finds in K (LDLᵀ, threshold 1e-8): to compare with the kernel's
/// dimension. A cross-check only, which can miscount where materials vary much.
int countNullPivots(const LocalMatrix& matrix);

/// Why a matrix may have a kernel that was not expected: in words for an error message, and whether rounding
/// errors may be all there is to it, as where it hangs together.
struct HiddenMotion {
  std::string cause;
  bool mayBeRounding;
};
HiddenMotion causeOfHiddenMotion(const LocalMatrix& matrix, const Kernel& kernel);

} // namespace Harmos::feti
