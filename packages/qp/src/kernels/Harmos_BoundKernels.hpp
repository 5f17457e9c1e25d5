// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTypes.hpp"

#include <cstddef>

namespace Harmos::qp::Kernels {

/// The passes of BoundOps over one rank's entries of plain arrays, for vector types that can show them.
///
/// Sums are local; a caller reduces them. Absent bounds are null. Each function reads and writes every array
/// once.
struct Bounds {
  const double* lower;
  const double* upper;
};

SplitSums split(std::size_t n, const double* x, const double* g, Bounds bounds, double stepLength,
                double* direction, signed char* active, bool fresh);

/// @param active null: all entries are free.
CurvatureSums curvature(std::size_t n, const double* g, const double* p, const double* image,
                        const signed char* active);

ResidualSums residualSums(std::size_t n, const double* w, const double* z, const double* image,
                          const double* x);

SplitSums advance(std::size_t n, double* x, double* g, const double* p, const double* image, double step,
                  double beta, bool toBoundary, Bounds bounds, double stepLength, double* next,
                  signed char* active);

double conjugate(std::size_t n, const double* x, const double* z, double beta, Bounds bounds, double* p);

double choppedDirection(std::size_t n, const double* x, const double* g, Bounds bounds, double* p);

void projectedStep(std::size_t n, double* x, double* xOld, const double* p, double step, Bounds bounds);

ChangeSums change(std::size_t n, const double* x, const double* xOld, const double* g, const double* gOld);

/// See BoundOps::projectSmoothly().
struct Smoothed {
  double x, slope;
};
Smoothed projectSmoothly(double v, double lower, double upper, double width);

} // namespace Harmos::qp::Kernels
