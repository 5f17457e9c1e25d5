// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundViews.hpp"
#include "Harmos_DiscKernels.hpp"

#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

namespace Harmos::qp {

/// Active sets of vectors with bounds and discs: which entries are held where, and what that means for a
/// vector. Collective where a sum is returned.
///
/// Guarded by tests/unit/qp/test_bound_ops.cpp and test_discs.cpp.
template<class Scalar, class MV>
struct ActiveSetOps {
  using BT = BoundTraits<Scalar, MV>;
  using Set = FeasibleSet<MV>;

  /// v_i ← 0 where the entry is active; slipping pairs keep their part along the tangent. Local.
  static void maskActive(MV& v, const LocalActiveSet& active) {
    double* const vs = BT::write(v);
    for (std::size_t i = 0; i < active.size(); ++i)
      if (active[i] != 0 && active[i] != LocalActiveSet::slips)
        vs[i] = 0.0;
    Kernels::maskSlips(active.slipping, vs);
  }

  /// v_i ← −1, 0, 1 or 2, and back: an active set as a vector. An empty set comes back as one without active
  /// entries. Local.
  static void activeToVector(const LocalActiveSet& active, MV& v) {
    double* const vs = BT::write(v);
    for (std::size_t i = 0; i < BT::length(v); ++i)
      vs[i] = i < active.size() ? active[i] : 0;
  }
  static void vectorToActive(const MV& v, LocalActiveSet& active) {
    const double* const vs = BT::read(v);
    active.resize(BT::length(v));
    for (std::size_t i = 0; i < active.size(); ++i)
      active[i] = static_cast<signed char>(vs[i]);
  }

  /// y ← y + f κt(tᵀx) of slipping pairs; with fromCentre x − c in the place of x. Local.
  static void addCurvature(const LocalActiveSet& active, double f, const MV& x, bool fromCentre, MV& y) {
    if (!active.slipping.empty())
      Kernels::addCurvature(active.slipping, f, BT::read(x), fromCentre, BT::write(y));
  }

  /// y ← y + f(κ) x at the entries of slipping pairs. Local.
  static void addAtSlips(const LocalActiveSet& active, const std::function<double(double)>& f, const MV& x,
                         MV& y) {
    const double* const xs = BT::read(x);
    double* const ys = BT::write(y);
    for (const Slip& slip : active.slipping)
      for (int entry : {slip.first, slip.second})
        ys[entry] += f(slip.curvature) * xs[entry];
  }

  /// @param w along the tangents of slipping pairs, and at springs.
  static SlipSums slipSums(const LocalActiveSet& active, double q, const MV& w) {
    double sums[5] = {0.0, 0.0, 0.0, 0.0, 0.0};
    const double* const ws = BT::read(w);
    for (const Slip& slip : active.slipping) {
      const double along = slip.normal[0] * ws[slip.second] - slip.normal[1] * ws[slip.first];
      sums[0] += along * along;
      sums[1] += std::pow(q / (q + slip.curvature) * along, 2);
      sums[2] += std::pow((q + slip.curvature) * slip.radius, 2);
    }
    for (const Spring& spring : active.springs) {
      const double entry = ws[spring.entry];
      sums[3] += entry * entry;
      sums[4] += std::pow(q / (q + spring.curvature) * entry, 2);
    }
    BT::sum(w, sums, 5);
    return {sums[0], sums[1], sums[3], sums[4], sums[2]};
  }

  /// Slipping pairs as vectors, and back: their normals; κ at their first entry and r at the second, which
  /// may be older than what the disc has. Local.
  static void slipsToVectors(const LocalActiveSet& active, MV& normals, MV& curvatures) {
    double *const ns = BT::write(normals), *const ks = BT::write(curvatures);
    std::fill_n(ns, BT::length(normals), 0.0);
    std::fill_n(ks, BT::length(curvatures), 0.0);
    for (const Slip& slip : active.slipping) {
      ns[slip.first] = slip.normal[0];
      ns[slip.second] = slip.normal[1];
      ks[slip.first] = slip.curvature;
      ks[slip.second] = slip.radius;
    }
  }
  static void vectorsToSlips(const Set& feasible, const MV& normals, const MV& curvatures,
                             LocalActiveSet& active) {
    const double *const ns = BT::read(normals), *const ks = BT::read(curvatures);
    active.slipping.clear();
    for (const Disc& disc : discsOf(feasible))
      if (active[static_cast<std::size_t>(disc.first)] == LocalActiveSet::slips)
        active.slipping.push_back({disc.first,
                                   disc.second,
                                   {disc.centre[0], disc.centre[1]},
                                   ks[disc.second],
                                   {ns[disc.first], ns[disc.second]},
                                   ks[disc.first]});
  }

  /// x_i ← its bound where the entry is active, to the rim along its radius or to the tangent. Local.
  static void moveToBounds(MV& x, const Set& feasible, const LocalActiveSet& active) {
    if (feasible.isEverything() || active.empty())
      return;
    double* const xs = BT::write(x);
    const BoxView<Scalar, MV> box(feasible);
    if (feasible.anyBound() != nullptr)
      for (std::size_t i = 0; i < active.size(); ++i)
        if (active[i] == -1 || active[i] == 1)
          xs[i] = active[i] < 0 ? box.lower(i) : box.upper(i);
    Kernels::moveToRims(discsOf(feasible), active.data(), xs);
    Kernels::moveToTangents(active.slipping, xs);
  }

  /// The update of a primal-dual active set method: an active entry is freed where its multiplier has the
  /// wrong sign by more than gradientNoise, a free one becomes active where it violates its bound by more
  /// than xNoise. Entries with l = u stay active. A pair in a disc slips where z = x − c − αg lies outside,
  /// along the tangent at n = z/|z| and with κ = (|z| − r)/(αr): Newton's method for x = Π(x − αg), symmetric
  /// since the radius is given (Alart, Curnier, Comput. Methods Appl. Mech. Engrg. 92, 1991).
  /// @param set to be updated; sized here if empty.
  static ActiveSetChange updateActiveSet(const MV& x, const MV& gradient, const Set& feasible, double xNoise,
                                         double gradientNoise, LocalActiveSet& set,
                                         const DiscUpdate& discs = {}) {
    const std::size_t n = BT::length(x);
    const double *const xs = BT::read(x), *const gs = BT::read(gradient);
    const BoxView<Scalar, MV> box(feasible);
    if (set.size() != n)
      set.assign(n, 0);
    Tally tally;
    const auto update = [&](std::size_t i) {
      const signed char before = set[i];
      set[i] = updated(before, xs[i], gs[i], box.lower(i), box.upper(i), xNoise, gradientNoise, tally);
      tally.changed += set[i] != before ? 1.0 : 0.0;
      if (set[i] != 0) {
        tally.active += 1.0;
        tally.sign(mix(2 * static_cast<std::uint64_t>(BT::globalIndex(x, i)) + (set[i] < 0 ? 0 : 1)));
      }
    };
    overOthers(feasible, n, [&](std::size_t k, std::size_t count) {
      for (std::size_t i = k; i < k + count; ++i)
        update(i);
    });
    const Kernels::DiscChange change =
        Kernels::update(discsOf(feasible), xs, gs, discs, xNoise, gradientNoise, set);
    return total(x, set, change, tally);
  }

  /// Entries whose states differ. @param before empty: all do. @param like any vector of their length.
  static long long changed(const MV& like, const LocalActiveSet& before, const LocalActiveSet& set) {
    double sum = 0.0;
    for (std::size_t i = 0; i < set.size(); ++i)
      sum += before.size() != set.size() || before[i] != set[i] ? 1.0 : 0.0;
    BT::sum(like, &sum, 1);
    return std::llround(sum);
  }

 private:
  // Of ActiveSetChange the parts of this rank.
  struct Tally {
    double active = 0.0, changed = 0.0, violation2 = 0.0, wrong2 = 0.0, signature[2] = {0.0, 0.0};
    // 32 bits an entry, so that sums over two million entries are exact.
    void sign(std::uint64_t first, std::uint64_t second) {
      signature[0] += static_cast<double>(first >> 32);
      signature[1] += static_cast<double>(second & 0xffffffffULL);
    }
    void sign(std::uint64_t bits) { sign(bits, bits); }
  };

  // The state of an entry in no disc.
  static signed char updated(signed char state, double x, double g, double l, double u, double xNoise,
                             double gradientNoise, Tally& tally) {
    if (l == u)
      return -1;
    if (state != 0) {
      // The multiplier of a lower bound is to be positive, that of an upper one negative.
      const double wrong = std::max(state < 0 ? -g : g, 0.0);
      tally.wrong2 += wrong * wrong;
      return wrong > gradientNoise ? 0 : state;
    }
    const double below = std::max(l - x, 0.0), above = std::max(x - u, 0.0);
    tally.violation2 += below * below + above * above;
    return below > xNoise ? -1 : above > xNoise ? 1 : 0;
  }

  static ActiveSetChange total(const MV& x, const LocalActiveSet& set, const Kernels::DiscChange& change,
                               Tally& tally) {
    for (const Slip& slip : set.slipping) {
      std::uint64_t turned[2];
      std::memcpy(turned, slip.normal, sizeof turned);
      const auto entry = static_cast<std::uint64_t>(BT::globalIndex(x, static_cast<std::size_t>(slip.first)));
      const std::uint64_t bits = mix(2 * entry + 1 + turned[0]);
      tally.sign(bits, mix(bits + turned[1]));
    }
    double sums[] = {tally.active + 2.0 * static_cast<double>(change.active),
                     tally.changed + static_cast<double>(change.changed),
                     tally.violation2 + change.violation2,
                     tally.wrong2 + change.wrong2,
                     tally.signature[0],
                     tally.signature[1],
                     static_cast<double>(set.slipping.size())};
    BT::sum(x, sums, 7);
    return {static_cast<long long>(sums[0]),
            static_cast<long long>(sums[1]),
            sums[2],
            sums[3],
            {sums[4], sums[5]},
            static_cast<long long>(sums[6])};
  }
};

} // namespace Harmos::qp
