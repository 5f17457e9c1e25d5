// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"
#include "Harmos_Types.hpp"

namespace Harmos::qp {

/// Bounds on Tpetra vectors, on the host.
template<>
struct BoundTraits<Scalar, MultiVector> {
  static SplitSums split(const MultiVector& x, const MultiVector& gradient, const MultiVector* lower,
                         const MultiVector* upper, double stepLength, const MultiVector* image,
                         MultiVector& freeGradient, LocalActiveSet& active);
  static double projectedGradientNorm(const MultiVector& x, const MultiVector& gradient,
                                      const MultiVector* lower, const MultiVector* upper);
  static void choppedGradient(const MultiVector& x, const MultiVector& gradient, const MultiVector* lower,
                              const MultiVector* upper, MultiVector& chopped);
  static DirectionSums direction(const MultiVector& x, const MultiVector& gradient,
                                 const MultiVector& direction, const MultiVector& image,
                                 const MultiVector* lower, const MultiVector* upper);
  static void project(MultiVector& x, const MultiVector* lower, const MultiVector* upper);
  static void stepToBoundary(MultiVector& x, const MultiVector& direction, double step,
                             const MultiVector* lower, const MultiVector* upper);
  static bool boundsAreConsistent(const MultiVector* lower, const MultiVector* upper);
  static void setRandom(MultiVector& x);
};

} // namespace Harmos::qp
