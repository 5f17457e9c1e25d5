// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTypes.hpp"

#include <vector>

namespace Harmos::qp::Kernels {

/// The passes of BoundOps over the discs of one rank, beside those of Harmos_BoundKernels.hpp over all
/// other entries: local sums are added to, and arrays are those of all entries.
///
/// Discs are few; their passes are not made for wide registers.

using Discs = std::vector<Disc>;

/// @param direction null, or receives φ. @param fresh all entries count as changed.
void split(const Discs& discs, const double* x, const double* g, double stepLength, double* direction,
           signed char* active, bool fresh, SplitSums& sums);

/// Rounding may not carry x over a rim.
void advance(const Discs& discs, double* x, double* g, const double* p, const double* image, double step,
             double beta, double stepLength, double* next, signed char* active, SplitSums& sums);

/// p ← z − βp; its longest step.
double conjugate(const Discs& discs, const double* x, const double* z, double beta, double* p);

/// p ← the chopped gradient; its longest step, which is zero along a rim.
double choppedDirection(const Discs& discs, const double* x, const double* g, double* p);

void projectedStep(const Discs& discs, double* x, double* xOld, const double* p, double step);

void project(const Discs& discs, double* x);

/// See BoundOps::projectSmoothly().
void projectSmoothly(const Discs& discs, double width, double* x, double* slope, std::vector<Slip>& rims);

/// To the rim, along the radius, where the state says so.
void moveToRims(const Discs& discs, const signed char* active, double* x);

/// The part along the tangents is left.
void maskSlips(const std::vector<Slip>& slipping, double* v);

/// y ← y + f κt(tᵀx), x − c for x where fromCentre.
void addCurvature(const std::vector<Slip>& slipping, double f, const double* x, bool fromCentre, double* y);

/// nᵀ(x − c) ← r.
void moveToTangents(const std::vector<Slip>& slipping, double* x);

struct DiscChange {
  long long active = 0, changed = 0; ///< pairs
  double violation2 = 0.0;           ///< of the distance outside
  double wrong2 = 0.0;               ///< of what is left of the gradient at the nearest point of the rim
};

/// See ActiveSetOps::updateActiveSet().
DiscChange update(const Discs& discs, const double* x, const double* g, const DiscUpdate& how, double xNoise,
                  double gradientNoise, LocalActiveSet& set);

/// The infimum of wᵀx over the discs, and the square of where it is attained.
void addInfimum(const Discs& discs, const double* w, double& value, double& boundNorm2);

/// d ← 0; the square of what that takes away.
double clear(const Discs& discs, double* d);

} // namespace Harmos::qp::Kernels
