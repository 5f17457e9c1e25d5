// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_NonsmoothBlock.hpp"

#include <cstddef>
#include <vector>

namespace Harmos::qp {

/// An entry that may leave its interval against a curvature: ψ = ½κ dist(x, [l, u])².
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
  /// Whether all of them are numbers, with l ≤ u and κ ≥ 0.
  bool areSound() const;

 private:
  std::vector<SoftBound> bounds_;
  std::size_t length_;
};

/// Entries with soft bounds: nothing is held, and outside of their intervals they are springs, by the side
/// where they are (Newton's method for a gradient that bends there).
///
/// Guarded by tests/unit/qp/test_blocks.cpp and test_soft_bounds.cpp.
class SoftIntervals : public NonsmoothBlock {
 public:
  /// @param bounds to be kept by whoever made them.
  explicit SoftIntervals(const LocalSoftBounds& bounds) : bounds_(bounds.bounds()) {}

  Kind kind() const override { return {false, true, true}; }
  void mark(char* entries) const override;
  void project(double* /*x*/) const override {}
  void project(const double* /*x*/, double* /*g*/) const override {}
  void addForces(const double* x, double* y) const override;
  /// An entry that is at an end to xNoise stays what it was.
  void update(const double* x, const double* g, const FaceUpdate& how, const ActiveFace& before,
              ActiveFace& face, FaceTally& tally) const override;
  void moveToFace(const ActiveFace& /*face*/, double* /*x*/) const override {}
  double recede(double* d) const override;

 private:
  const std::vector<SoftBound>& bounds_;
};

} // namespace Harmos::qp
