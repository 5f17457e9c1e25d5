// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace Harmos::feti::PackedSymmetric {

/// The lower triangle of a dense symmetric matrix in panels of four columns, each from its diagonal block on,
/// in tiles of four rows, each by columns. The last panel and the last tiles are filled up with zeros;
/// diagonal blocks are whole. A product so reads one stream, in the order of storage.
template<class T>
std::vector<T> pack(const std::vector<double>& matrix, int n);

/// The whole matrix that was packed, column after column.
template<class T>
std::vector<double> unpack(const std::vector<T>& packed, int n);

/// y = Ax, reading A once; sums in double. @param x, y of n entries, rounded up to a multiple of four; the
/// entries of x beyond n are zero, those of y are overwritten.
void multiply(const double* packed, int n, const double* x, double* y);
void multiply(const float* packed, int n, const double* x, double* y);

/// n rounded up to the length of x and y in multiply().
int paddedLength(int n);

} // namespace Harmos::feti::PackedSymmetric
