// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"

#include <vector>

namespace Harmos::qp::Kernels {

/// The passes of BoundTraits over the discs of one rank, beside those of Harmos_BoundKernels.hpp over all
/// other entries: local sums are added to, and arrays are those of all entries.
///
/// Discs are few; their passes are not made for wide registers.

/// What LocalActiveSet says of both entries of a disc whose rim x is on.
constexpr signed char onRim = 2;

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

/// To the rim, along the radius, where the state says so.
void moveToRims(const Discs& discs, const signed char* active, double* x);

/// The infimum of wᵀx over the discs, and the square of where it is attained.
void addInfimum(const Discs& discs, const double* w, double& value, double& boundNorm2);

/// d ← 0; the square of what that takes away.
double clear(const Discs& discs, double* d);

} // namespace Harmos::qp::Kernels
