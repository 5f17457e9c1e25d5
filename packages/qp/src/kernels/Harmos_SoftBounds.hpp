// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace Harmos::qp {

/// An entry that may leave its interval against a curvature: ½κ dist(x, [l, u])² is added to the cost.
struct SoftBound {
  int entry;           ///< local
  double lower, upper; ///< l ≤ u, ∓∞ where there is none; equal: a spring to both sides
  double curvature;    ///< κ ≥ 0
};

/// Those of one rank, by rising entries.
class LocalSoftBounds {
 public:
  /// @param length entries of this rank. @throws InternalError for indices out of range or used twice.
  LocalSoftBounds(std::vector<SoftBound> bounds, std::size_t length);

  const std::vector<SoftBound>& bounds() const { return bounds_; }
  std::size_t length() const { return length_; }

 private:
  std::vector<SoftBound> bounds_;
  std::size_t length_;
};

/// An entry on one side of its interval: its cost is ½κ(x − c)² there, c the end that it is beyond.
struct Spring {
  int entry; ///< local
  double centre;
  double curvature; ///< κ
};

/// What a look at springs yields; global.
struct SpringChange {
  long long changed = 0;            ///< entries that are on another side, or within their intervals
  double wrong2 = 0.0;              ///< Σ(κ dist − force of the springs as they were)²
  double signature[2] = {0.0, 0.0}; ///< the same for the same springs; differs with all but certainty else
};

namespace Kernels {

/// Springs of the entries that are beyond their intervals. One that is at an end to `noise` stays what it
/// was. @param random a number in (−1, 1) for each entry of the vector, for the signature.
SpringChange updateSprings(const std::vector<SoftBound>& bounds, const double* x, double noise,
                           const double* random, std::vector<Spring>& springs);

/// y ← y + fκx of springs; with fromCentre x − c in the place of x.
void addSprings(const std::vector<Spring>& springs, double f, const double* x, bool fromCentre, double* y);

/// v ← q/(q + κ)·v at springs, at least `least`·v.
void soften(const std::vector<Spring>& springs, double q, double least, double* v);

/// z ← z + κ/(q + κ)²·v at springs.
void addStiff(const std::vector<Spring>& springs, double q, const double* v, double* z);

/// y ← y + κ(x − Π(x)) − κ(x − c) of springs: what gradients that know springs lack.
void correctSprings(const std::vector<SoftBound>& bounds, const std::vector<Spring>& springs, const double* x,
                    double* y);

/// x ← c + q/(q + κ)(x − c) at springs that were none before: where x would go if A were q.
void moveToSprings(const std::vector<Spring>& before, const std::vector<Spring>& springs, double q,
                   double* x);

/// −1 or 1 at springs at lower and at upper ends, and back.
void springsToSides(const std::vector<SoftBound>& bounds, const std::vector<Spring>& springs, double* sides);
std::vector<Spring> springsOfSides(const std::vector<SoftBound>& bounds, const double* sides);

/// Σ d·κ(x − Π(x)).
double softPower(const std::vector<SoftBound>& bounds, const double* x, const double* d);

/// Σd² over what leads from intervals for ever.
double opposed2(const std::vector<SoftBound>& bounds, const double* d);

} // namespace Kernels
} // namespace Harmos::qp
