// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTypes.hpp"
#include "Harmos_FeasibleSet.hpp"

#include <vector>

namespace Harmos::qp {

/// A limit that follows the solution: the radius of an interval about a centre, or of a disc, is a multiple
/// of how far another entry is from its lower bound,
///
///     |x_i − c| ≤ r,  or  |(x_i, x_j) − c| ≤ r,   r = f·(x_k − l_k)⁺,
///
/// as friction's is of pressure by Coulomb's law. What is solved is no optimisation any more but a
/// quasi-variational inequality: x is the minimum over the set that belongs to x itself.
struct FollowingLimit {
  int place;           ///< local index of x_i; of a disc its place in LocalDiscs::discs()
  bool isDisc;         ///
  int source;          ///< local index of x_k
  double factor;       ///< f ≥ 0
  double centre = 0.0; ///< of an interval
};

using FollowingLimits = std::vector<FollowingLimit>;

/// An entry, or a pair, that is held at a limit on a face, where that follows a free entry: it goes along,
/// dx = f·dx_k e.
struct FollowingEntry {
  int first, second; ///< second −1 for an interval
  double along[2];   ///< e: the sign of the side; the normal of the rim
  double centre[2];
  int source;
  double factor;
};

namespace Kernels {

/// r ← r + s(f·(x_k − αg_k − l_k)⁺ − r). @param g null: zeros. @param upper null without intervals; discs
/// null without discs.
void follow(const FollowingLimits& limits, const double* x, const double* g, const FollowUpdate& how,
            double* lower, double* upper, LocalDiscs* discs);

/// See FollowingOps::updateFollowing(); local sums.
FollowChange update(const FollowingLimits& limits, const double* x, const double* g, const double* lower,
                    const double* upper, const LocalDiscs* discs, double stepLength, double gradientNoise,
                    const LocalActiveSet& before, LocalActiveSet& set);

/// On the face of an active set.
std::vector<FollowingEntry> followingEntries(const FollowingLimits& limits, const LocalDiscs* discs,
                                             const LocalActiveSet& active);
/// Takes what has limits that follow out of a set.
void leaveOut(const FollowingLimits& limits, const LocalDiscs* discs, LocalActiveSet& active);

/// See FollowingOps.
void addFollowing(const std::vector<FollowingEntry>& following, const double* x, double* y);
void moveToFollowing(const std::vector<FollowingEntry>& following, const double* lower, double* x);

/// Active entries, and slipping pairs along their radii.
void moveToLimits(const FollowingLimits& limits, const double* lower, const double* upper,
                  const LocalDiscs* discs, const LocalActiveSet& active, double* x);

/// What belongs to each limit: x_k and (x_i, x_j), the last zero for intervals.
struct Cone {
  double source, arm[2];
};
using Cones = std::vector<Cone>;
Cones conesOf(const FollowingLimits& limits, const double* x, const LocalDiscs* discs);

/// See FollowingOps. @param points as they were before other bounds had their say.
void projectOntoCones(const Cones& points, const FollowingLimits& limits, const double* lower,
                      const LocalDiscs* discs, double* x);

/// Takes the entries of limits from w. @param sums receives the infimum, the square of what falls without
/// end, and that of the corners' distances.
void takeConeInfimum(const FollowingLimits& limits, const double* lower, const LocalDiscs* discs, double* w,
                     double* sums);

/// The radii, at the first entry that each is of; and back.
void limitsToArray(const FollowingLimits& limits, const double* upper, const LocalDiscs* discs,
                   double* radii);
void arrayToLimits(const FollowingLimits& limits, const double* radii, double* lower, double* upper,
                   LocalDiscs* discs);

} // namespace Kernels

} // namespace Harmos::qp
