// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundViews.hpp"
#include "Harmos_NonsmoothBlock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

/// What an interval l ≤ x ≤ u does in the update of a face: a held entry is freed where its multiplier has
/// the wrong sign by more than gradientNoise, a free one is held where it is beyond its end by more than
/// xNoise. Entries with l = u stay held. @return the state.
inline signed char updateInterval(signed char state, double x, double g, double l, double u,
                                  const FaceUpdate& how, FaceTally& tally) {
  if (l == u)
    return -1;
  if (state != 0) {
    // The multiplier of a lower bound is to be positive, that of an upper one negative.
    const double wrong = std::max(state < 0 ? -g : g, 0.0);
    tally.wrong2 += wrong * wrong;
    return wrong > how.gradientNoise ? 0 : state;
  }
  const double below = std::max(l - x, 0.0), above = std::max(x - u, 0.0);
  tally.violation2 += below * below + above * above;
  return below > how.xNoise ? -1 : above > how.xNoise ? 1 : 0;
}

/// Entries with bounds: ψ is zero within [l, u], infinite outside; those in discs are left out.
///
/// Guarded by tests/unit/qp/test_blocks.cpp.
template<class Scalar, class MV>
class Intervals : public NonsmoothBlock {
 public:
  /// Of the bounds of a set.
  explicit Intervals(const FeasibleSet<MV>& set) : set_(set) {}

  Kind kind() const override { return {}; }

  void mark(char* entries) const override {
    overEntries([&](std::size_t i, double, double) { entries[i] = 1; });
  }

  void project(double* x) const override {
    overEntries([&](std::size_t i, double l, double u) { x[i] = std::max(l, std::min(u, x[i])); });
  }

  void project(const double* x, double* g) const override {
    overEntries([&](std::size_t i, double l, double u) {
      if (x[i] <= l)
        g[i] = l == u ? 0.0 : std::min(g[i], 0.0);
      else if (x[i] >= u)
        g[i] = std::max(g[i], 0.0);
    });
  }

  void update(const double* x, const double* g, const FaceUpdate& how, const ActiveFace& /*before*/,
              ActiveFace& face, FaceTally& tally) const override {
    overEntries([&](std::size_t i, double l, double u) {
      face[i] = updateInterval(face[i], x[i], g[i], l, u, how, tally);
    });
  }

  void moveToFace(const ActiveFace& face, double* x) const override {
    overEntries([&](std::size_t i, double l, double u) {
      if (face[i] != 0)
        x[i] = face[i] < 0 ? l : u;
    });
  }

  double recede(double* d) const override {
    double removed2 = 0.0;
    overEntries([&](std::size_t i, double l, double u) {
      if ((d[i] < 0.0 && l > -infinity) || (d[i] > 0.0 && u < infinity)) {
        removed2 += d[i] * d[i];
        d[i] = 0.0;
      }
    });
    return removed2;
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  // visit(i, l, u) for the entries that have a bound.
  template<class Visit>
  void overEntries(const Visit& visit) const {
    if (set_.anyBound() == nullptr)
      return;
    const BoxView<Scalar, MV> box(set_);
    overOthers(set_, BoundTraits<Scalar, MV>::length(*set_.anyBound()), [&](std::size_t k, std::size_t n) {
      for (std::size_t i = k; i < k + n; ++i)
        if (const double l = box.lower(i), u = box.upper(i); l > -infinity || u < infinity)
          visit(i, l, u);
    });
  }

  FeasibleSet<MV> set_;
};

} // namespace Harmos::qp
