// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_BoundTypes.hpp"
#include "Harmos_Discs.hpp"
#include "Harmos_Intervals.hpp"
#include "Harmos_MixedBits.hpp"

#include <BelosMultiVecTraits.hpp>
#include <Teuchos_RCP.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <memory>
#include <numeric>
#include <vector>

namespace Harmos::qp {

/// Blocks of a problem and its vectors. Collective where a sum is returned.
///
/// Guarded by tests/unit/qp/test_blocks.cpp.
template<class Scalar, class MV>
struct BlockOps {
  using BT = BoundTraits<Scalar, MV>;
  using MVT = Belos::MultiVecTraits<Scalar, MV>;

  /// Intervals and discs of a set, while that is there. Local.
  static Blocks setsOf(const FeasibleSet<MV>& set) {
    Blocks result;
    if (set.anyBound() != nullptr)
      result.push_back(std::make_shared<Intervals<Scalar, MV>>(set));
    if (set.hasDiscs())
      result.push_back(std::make_shared<Discs>(set.discs));
    return result;
  }

  /// The face at x: Newton's method for the nonsmooth equation of all blocks. Slips and springs are made
  /// anew, where there are blocks that may have some.
  /// @param face in: that which x was found on, sized here if empty.
  static FaceChange update(const Blocks& blocks, const MV& x, const MV& g, const FaceUpdate& how,
                           ActiveFace& face) {
    if (face.size() != BT::length(x))
      face.assign(BT::length(x), 0);
    const double *const xs = BT::read(x), *const gs = BT::read(g);
    for (const auto& block : blocks)
      block->follow(xs, gs, {how.stepLength, 1.0});
    return updated(blocks, x, xs, gs, how, face);
  }

  /// The same with intervals and discs alone; springs stay what they are.
  static FaceChange update(const FeasibleSet<MV>& set, const MV& x, const MV& g, const FaceUpdate& how,
                           ActiveFace& face) {
    if (face.size() != BT::length(x))
      face.assign(BT::length(x), 0);
    return updated(setsOf(set), x, BT::read(x), BT::read(g), how, face);
  }

  /// Those of them that bend, and are no sets.
  static Blocks withForces(const Blocks& blocks) {
    Blocks result;
    std::copy_if(blocks.begin(), blocks.end(), std::back_inserter(result),
                 [](const auto& block) { return !block->kind().isSet; });
    return result;
  }

  /// x ← where the face holds it. Local.
  static void moveToFace(const Blocks& blocks, const ActiveFace& face, MV& x) {
    if (face.empty() || blocks.empty())
      return;
    double* const xs = BT::write(x);
    for (const auto& block : blocks)
      block->moveToFace(face, xs);
  }
  static void moveToFace(const FeasibleSet<MV>& set, const ActiveFace& face, MV& x) {
    if (!set.isEverything())
      moveToFace(setsOf(set), face, x);
  }

  /// x ← the nearest point where all terms are finite. Local.
  static void project(const Blocks& blocks, MV& x) {
    if (blocks.empty())
      return;
    double* const xs = BT::write(x);
    for (const auto& block : blocks)
      block->project(xs);
  }

  /// y ← y + ∇ψ(x). Local.
  static void addForces(const Blocks& blocks, const MV& x, MV& y) {
    for (const auto& block : withForces(blocks))
      block->addForces(BT::read(x), BT::write(y));
  }

  /// The same where y knows the springs of a face already. Local.
  static void correctForces(const Blocks& blocks, const ActiveFace& face, const MV& x, MV& y) {
    if (withForces(blocks).empty())
      return;
    const Teuchos::RCP<MV> forces = MVT::Clone(x, 1);
    MVT::MvInit(*forces, 0.0);
    addForces(blocks, x, *forces);
    if (!face.springs.empty())
      Kernels::addSprings(face.springs, -1.0, BT::read(x), true, BT::write(*forces));
    MVT::MvAddMv(1.0, y, 1.0, *forces, y);
  }

  /// ‖g^P‖ at a point where all terms are finite. @param set the intervals and discs of the blocks, which
  /// come first.
  static double projectedGradientNorm(const FeasibleSet<MV>& set, const Blocks& blocks, const MV& x,
                                      const MV& g) {
    const std::size_t sets = setsOf(set).size();
    if (blocks.size() == sets)
      return BoundOps<Scalar, MV>::projectedGradientNorm(x, g, set);
    const Teuchos::RCP<MV> projected = MVT::CloneCopy(g);
    for (std::size_t k = sets; k < blocks.size(); ++k)
      blocks[k]->project(BT::read(x), BT::write(*projected));
    return BoundOps<Scalar, MV>::projectedGradientNorm(x, *projected, set);
  }

  /// d ← its projection onto what no term grows along for ever; the norm of what is taken away.
  static double recede(const Blocks& blocks, MV& d) {
    double removed2 = 0.0;
    for (const auto& block : blocks)
      removed2 += block->recede(BT::write(d));
    BT::sum(d, &removed2, 1);
    return std::sqrt(removed2);
  }

  /// 1 at entries of blocks.
  static std::vector<char> marked(const Blocks& blocks, std::size_t length) {
    std::vector<char> result(length, 0);
    for (const auto& block : blocks)
      block->mark(result.data());
    return result;
  }

 private:
  static FaceChange updated(const Blocks& blocks, const MV& x, const double* xs, const double* gs,
                            const FaceUpdate& how, ActiveFace& face) {
    FaceTally tally;
    const ActiveFace before = face;
    const bool mayPull = !withForces(blocks).empty();
    if (std::any_of(blocks.begin(), blocks.end(), [](const auto& block) { return block->kind().isSet; }))
      face.slipping.clear();
    if (mayPull)
      face.springs.clear();
    for (const auto& block : blocks)
      block->update(xs, gs, how, before, face, tally);
    std::sort(face.springs.begin(), face.springs.end(),
              [](const Spring& a, const Spring& b) { return a.entry < b.entry; });
    double sums[9] = {0.0,
                      tally.turned,
                      tally.violation2,
                      tally.wrong2,
                      0.0,
                      0.0,
                      mayPull && !how.keepsSprings ? wrongForces2(blocks, before, x) : 0.0,
                      tally.distance2,
                      static_cast<double>(face.slipping.size())};
    count(x, before, face, sums);
    BT::sum(x, sums, 9);
    return {static_cast<long long>(sums[0]),
            static_cast<long long>(sums[1]),
            sums[2],
            sums[3],
            {sums[4], sums[5]},
            static_cast<long long>(sums[8]),
            sums[6],
            sums[7]};
  }

  // Of ∇ψ(x) from what the springs of a face make of it, squared.
  static double wrongForces2(const Blocks& blocks, const ActiveFace& before, const MV& x) {
    const Teuchos::RCP<MV> forces = MVT::Clone(x, 1);
    MVT::MvInit(*forces, 0.0);
    addForces(blocks, x, *forces);
    Kernels::addSprings(before.springs, -1.0, BT::read(x), true, BT::write(*forces));
    const double* const fs = BT::read(*forces);
    return std::inner_product(fs, fs + BT::length(*forces), fs, 0.0);
  }

  // Held entries; entries whose state or side is another one; the signature.
  static void count(const MV& x, const ActiveFace& before, const ActiveFace& face, double* sums) {
    const auto number = [&x](std::size_t entry) {
      return static_cast<std::uint64_t>(BT::globalIndex(x, entry));
    };
    // 32 bits an entry, so that sums over two million entries are exact.
    const auto sign = [sums](std::uint64_t first, std::uint64_t second) {
      sums[4] += static_cast<double>(first >> 32);
      sums[5] += static_cast<double>(second & 0xffffffffULL);
    };
    const auto isPaired = [](signed char state) {
      return state == ActiveFace::onRim || state == ActiveFace::slips;
    };
    for (std::size_t i = 0; i < face.size(); ++i) {
      sums[0] += face[i] != 0 ? 1.0 : 0.0;
      sums[1] += face[i] != before[i] && !isPaired(face[i]) && !isPaired(before[i]) ? 1.0 : 0.0;
      if (face[i] == 0 || isPaired(face[i]))
        continue;
      const std::uint64_t bits = mix(2 * number(i) + (face[i] < 0 ? 0 : 1));
      sign(bits, bits);
    }
    for (const Slip& slip : face.slipping) {
      std::uint64_t turned[2];
      std::memcpy(turned, slip.normal, sizeof turned);
      const std::uint64_t bits = mix(2 * number(static_cast<std::size_t>(slip.first)) + 1 + turned[0]);
      sign(bits, mix(bits + turned[1]));
    }
    Kernels::SpringOf last(before.springs), next(face.springs);
    for (const Spring& spring : face.springs) {
      const Spring* const was = last(spring.entry);
      sums[1] += was == nullptr || was->side != spring.side ? 1.0 : 0.0;
      const std::uint64_t bits =
          mix(mix(2 * number(static_cast<std::size_t>(spring.entry)) + 1) + (spring.side < 0 ? 0 : 1));
      sign(bits, bits);
    }
    for (const Spring& spring : before.springs)
      sums[1] += next(spring.entry) == nullptr ? 1.0 : 0.0;
  }
};

} // namespace Harmos::qp
