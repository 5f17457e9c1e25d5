// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace Harmos::qp {

/// Two entries of a vector that stay within a disc: (x_first − c_0)² + (x_second − c_1)² ≤ r².
struct Disc {
  int first, second; ///< local indices, on the rank that has both
  double centre[2];
  double radius; ///< zero: a point
};

/// The discs of one rank, and the ranges of entries [begin, end) that are in none.
class LocalDiscs {
 public:
  using Range = std::pair<std::size_t, std::size_t>;

  /// @param length entries of this rank. @throws InternalError for indices out of range or used twice.
  LocalDiscs(std::vector<Disc> discs, std::size_t length);

  const std::vector<Disc>& discs() const { return discs_; }
  const std::vector<Range>& others() const { return others_; }
  std::size_t length() const { return length_; }
  void setRadius(std::size_t disc, double radius) { discs_[disc].radius = radius; }
  /// The largest |c_0| + |c_1| + r: points on rims are where they are to rounding errors of it.
  double largest() const;

 private:
  std::vector<Disc> discs_;
  std::vector<Range> others_;
  std::size_t length_;
};

/// A product of intervals l ≤ x ≤ u and discs, as BoundOps take it: what it points to lives elsewhere.
///
/// A null bound is an absent one; entries of ∓∞ are absent bounds too, and entries in discs have no others.
/// Discs are null on all ranks, where there are none, or on no rank.
template<class MV>
struct FeasibleSet {
  const MV* lower = nullptr;
  const MV* upper = nullptr;
  const LocalDiscs* discs = nullptr;

  /// Null if there is none.
  const MV* anyBound() const { return lower != nullptr ? lower : upper; }
  bool hasDiscs() const { return discs != nullptr; }
  bool isTwoSided() const { return lower != nullptr && upper != nullptr; }
  bool isEverything() const { return lower == nullptr && upper == nullptr && discs == nullptr; }
};

} // namespace Harmos::qp
