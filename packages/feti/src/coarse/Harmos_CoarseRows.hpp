// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTypes.hpp"
#include "Harmos_Constraints.hpp"
#include "Harmos_RigidMotions.hpp"

#include <utility>
#include <vector>

namespace Harmos::feti {

/// G̃ᵀ = BR by the dual rows of this rank, and what they add to G̃M_FG̃ᵀ. Columns are those of R, by their
/// numbers over all ranks.
///
/// Guarded by tests/unit/feti/coarse/test_coarse_space.cpp.
class CoarseRows {
 public:
  /// @note Collective.
  CoarseRows(const RigidMotions& motions, const Constraints& constraints);

  /// Owned rows.
  std::size_t size() const { return offsets_.size() - 1; }
  /// Of each row, and the end: the begin of its entries.
  const std::vector<std::size_t>& offsets() const { return offsets_; }
  /// Of entries; those of a row rise.
  const std::vector<int>& columns() const { return columns_; }
  const std::vector<double>& values() const { return values_; }

  /// Places of the lower triangle of G̃G̃ᵀ that rows of this rank add to: rising, each once.
  const std::vector<std::pair<int, int>>& places() const { return places_; }
  /// What rows of this rank add to G̃M_FG̃ᵀ at each of places(). Local.
  /// @param mask a weight for each row, or null: 1. @param slipping, q see qp::FaceGramMaker.
  template<class Real>
  std::vector<Real> gram(const double* mask, const std::vector<qp::Slip>& slipping, double q) const;

 private:
  void padPairs(const Constraints& constraints);
  void makePattern();

  std::vector<std::size_t> offsets_ = {0};
  std::vector<int> columns_;
  std::vector<double> values_;
  std::vector<std::pair<int, int>> places_;
  // Places that pairs of entries of a row fill, for each pattern of a row, with their begin for each row.
  std::vector<int> gramPlaces_;
  std::vector<std::size_t> firstPlace_;
};

} // namespace Harmos::feti
