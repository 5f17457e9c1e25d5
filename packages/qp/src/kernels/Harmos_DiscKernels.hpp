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

/// The infimum of wᵀx over the discs, and the square of where it is attained.
void addInfimum(const Discs& discs, const double* w, double& value, double& boundNorm2);

} // namespace Harmos::qp::Kernels
