// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundKernels.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_BoundTypes.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_MixedBits.hpp"

#include <limits>
#include <vector>

namespace Harmos::qp {

// What BoundOps and its like share.

/// The bounds of a set as arrays; −∞ and +∞ where there are none.
template<class Scalar, class MV>
class BoxView {
 public:
  explicit BoxView(const FeasibleSet<MV>& set)
      : lower_(set.lower != nullptr ? BoundTraits<Scalar, MV>::read(*set.lower) : nullptr),
        upper_(set.upper != nullptr ? BoundTraits<Scalar, MV>::read(*set.upper) : nullptr) {}

  double lower(std::size_t i) const {
    return lower_ != nullptr ? lower_[i] : -std::numeric_limits<double>::infinity();
  }
  double upper(std::size_t i) const {
    return upper_ != nullptr ? upper_[i] : std::numeric_limits<double>::infinity();
  }
  /// Null without them.
  const double* lower() const { return lower_; }
  const double* upper() const { return upper_; }
  /// From an entry on.
  Kernels::Bounds at(std::size_t begin) const {
    return {lower_ == nullptr ? nullptr : lower_ + begin, upper_ == nullptr ? nullptr : upper_ + begin};
  }

 private:
  const double* lower_;
  const double* upper_;
};

template<class MV>
const std::vector<Disc>& discsOf(const FeasibleSet<MV>& set) {
  static const std::vector<Disc> none;
  return set.hasDiscs() ? set.discs->discs() : none;
}

/// The entries in no disc, in ranges: pass(begin, length).
template<class MV, class Pass>
void overOthers(const FeasibleSet<MV>& set, std::size_t n, Pass&& pass) {
  if (!set.hasDiscs())
    return pass(std::size_t{0}, n);
  HARMOS_REQUIRE(set.discs->length() == n, "discs are those of another vector");
  for (const auto& [begin, end] : set.discs->others())
    pass(begin, end - begin);
}

} // namespace Harmos::qp
