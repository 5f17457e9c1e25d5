// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FeasibleSet.hpp"
#include "Harmos_NonsmoothBlock.hpp"

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

namespace Kernels {

/// r ← r + s(f·(x_k − αg_k − l_k)⁺ − r). @param g null: zeros. @param upper null without intervals; discs
/// null without discs.
void follow(const FollowingLimits& limits, const double* x, const double* g, const FollowUpdate& how,
            double* lower, double* upper, LocalDiscs* discs);

/// See CoulombLimits::update().
void update(const FollowingLimits& limits, const double* x, const double* g, const double* lower,
            const double* upper, const LocalDiscs* discs, const FaceUpdate& how, const ActiveFace& before,
            ActiveFace& face, FaceTally& tally);

/// What is held at limits that follow free entries.
std::vector<Coupling> couplings(const FollowingLimits& limits, const LocalDiscs* discs,
                                const ActiveFace& face);
/// Takes what has limits that follow out of a face.
void leaveOut(const FollowingLimits& limits, const LocalDiscs* discs, ActiveFace& face);

/// x goes to where it follows; along tangents it stays.
void moveToFollowing(const std::vector<Coupling>& couplings, const double* lower, double* x);

/// Held entries, and slipping pairs along their radii.
void moveToLimits(const FollowingLimits& limits, const double* lower, const double* upper,
                  const LocalDiscs* discs, const ActiveFace& face, double* x);

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
