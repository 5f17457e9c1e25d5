// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DiscKernels.hpp"
#include "Harmos_FollowingLimits.hpp"
#include "Harmos_SecondOrderCones.hpp"
#include "Harmos_TpetraViews.hpp"

#include <cmath>

namespace Harmos::qp {

// BoundTraits for Tpetra: what sets and limits that follow the solution need.

using Traits = BoundTraits<Scalar, MultiVector>;

void Traits::projectSmoothly(const MultiVector& v, const FeasibleSet<MultiVector>& feasible, double width,
                             MultiVector& x, MultiVector& slope, std::vector<Slip>& rims) {
  x.assign(v);
  slope.putScalar(1.0);
  rims.clear();
  const Writer xs(x), slopes(slope);
  if (feasible.hasDiscs())
    Kernels::projectSmoothly(feasible.discs->discs(), width, xs.data(), slopes.data(), rims);
  const MultiVector* bound = feasible.anyBound();
  if (bound == nullptr)
    return;
  const BoxReader box(feasible, *bound);
  overOthers(feasible, xs.size(), [&](std::size_t k, std::size_t n) {
    for (std::size_t i = k; i < k + n; ++i) {
      const Kernels::Smoothed smoothed = Kernels::projectSmoothly(xs[i], box.l[i], box.u[i], width);
      xs[i] = smoothed.x;
      slopes[i] = smoothed.slope;
    }
  });
}

void Traits::multiply(const MultiVector& w, MultiVector& v) {
  const Reader ws(w);
  const Writer vs(v);
  for (std::size_t i = 0; i < vs.size(); ++i)
    vs[i] *= ws[i];
}

void Traits::follow(const MultiVector& x, const MultiVector* gradient, const FollowUpdate& how,
                    const FollowingLimits& limits, MultiVector& lower, MultiVector* upper,
                    LocalDiscs* discs) {
  const Reader xs(x), gs(gradient != nullptr ? *gradient : x);
  const Writer ls(lower), us(upper != nullptr ? *upper : lower);
  Kernels::follow(limits, xs.data(), gradient != nullptr ? gs.data() : nullptr, how, ls.data(), us.data(),
                  discs);
}

FollowChange Traits::updateFollowing(const MultiVector& x, const MultiVector& gradient, const Set& feasible,
                                     const FollowingLimits& limits, double stepLength, double gradientNoise,
                                     const LocalActiveSet& before, LocalActiveSet& set) {
  double sums[3] = {0, 0, 0};
  {
    const Reader xs(x), gs(gradient);
    const BoxReader box(feasible, x);
    const FollowChange change = Kernels::update(limits, xs.data(), gs.data(), box.l.data(), box.u.data(),
                                                feasible.discs, stepLength, gradientNoise, before, set);
    sums[0] = static_cast<double>(change.changed);
    sums[1] = static_cast<double>(change.active);
    sums[2] = change.distance2;
  }
  reduce(x, sums, 3);
  return {static_cast<long long>(sums[0]), static_cast<long long>(sums[1]), sums[2]};
}

void Traits::addFollowing(const std::vector<FollowingEntry>& following, const MultiVector& x,
                          MultiVector& y) {
  Kernels::addFollowing(following, Reader(x).data(), Writer(y).data());
}

void Traits::moveToFollowing(const std::vector<FollowingEntry>& following, const MultiVector& lower,
                             MultiVector& x) {
  Kernels::moveToFollowing(following, Reader(lower).data(), Writer(x).data());
}

void Traits::moveToLimits(MultiVector& x, const Set& feasible, const FollowingLimits& limits,
                          const LocalActiveSet& active) {
  const BoxReader box(feasible, x);
  Kernels::moveToLimits(limits, box.l.data(), box.u.data(), feasible.discs, active, Writer(x).data());
}

void Traits::limitsToVector(const FollowingLimits& limits, const Set& feasible, MultiVector& radii) {
  radii.putScalar(0.0);
  const Writer rs(radii);
  const BoxReader box(feasible, radii);
  Kernels::limitsToArray(limits, box.u.data(), feasible.discs, rs.data());
}

void Traits::vectorToLimits(const FollowingLimits& limits, const MultiVector& radii, MultiVector& lower,
                            MultiVector* upper, LocalDiscs* discs) {
  const Reader rs(radii);
  const Writer ls(lower), us(upper != nullptr ? *upper : lower);
  Kernels::arrayToLimits(limits, rs.data(), ls.data(), us.data(), discs);
}

void Traits::projectOntoCones(MultiVector& x, const Set& feasible, const FollowingLimits& limits) {
  const BoxReader box(feasible, x);
  const Writer xs(x);
  const Kernels::Cones before = Kernels::conesOf(limits, xs.data(), feasible.discs);
  overOthers(feasible, xs.size(), [&](std::size_t k, std::size_t n) {
    for (std::size_t i = k; i < k + n; ++i)
      xs[i] = std::max(box.l[i], std::min(box.u[i], xs[i]));
  });
  Kernels::projectOntoCones(before, limits, box.l.data(), feasible.discs, xs.data());
}

BoxInfimum Traits::coneInfimum(const MultiVector& w, const Set& feasible, const FollowingLimits& limits) {
  MultiVector others(w, Teuchos::Copy);
  double sums[3] = {0, 0, 0};
  {
    const Writer ws(others);
    const BoxReader box(feasible, w);
    Kernels::takeConeInfimum(limits, box.l.data(), feasible.discs, ws.data(), sums);
  }
  reduce(w, sums, 3);
  BoxInfimum result = boxInfimum(others, feasible);
  result.value += sums[0];
  result.openNorm = std::hypot(result.openNorm, std::sqrt(sums[1]));
  result.boundNorm = std::hypot(result.boundNorm, std::sqrt(sums[2]));
  return result;
}

long long Traits::changed(const MultiVector& like, const LocalActiveSet& before, const LocalActiveSet& set) {
  double sum = 0.0;
  for (std::size_t i = 0; i < set.size(); ++i)
    sum += before.size() != set.size() || before[i] != set[i] ? 1.0 : 0.0;
  reduce(like, &sum, 1);
  return std::llround(sum);
}

Kernels::SecondOrderCones Traits::conesOf(const Set& feasible, const MultiVector& like,
                                          const FollowingLimits* limits) {
  const BoxReader box(feasible, like);
  return {like.getLocalLength(), box.l.data(), box.u.data(),
          feasible.discs != nullptr ? &feasible.discs->discs() : nullptr, limits};
}

std::vector<double> Traits::localEntries(const MultiVector& v) {
  const Reader entries(v);
  return {entries.data(), entries.data() + entries.size()};
}

void Traits::setLocalEntries(const std::vector<double>& entries, MultiVector& v) {
  std::copy(entries.begin(), entries.end(), Writer(v).data());
}

} // namespace Harmos::qp
