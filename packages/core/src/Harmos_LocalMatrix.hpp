// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace Harmos {

/// Square sparse matrix of one subdomain in compressed rows, on one rank.
///
/// The currency between assembly, domain decomposition and embedding applications. The types of the arrays
/// are those of a Tpetra::CrsMatrix on the host, which can therefore be a view of it. Columns are sorted in a
/// row. Symmetric matrices are stored whole.
struct LocalMatrix {
  std::vector<std::size_t> offsets = {0}; ///< rows + 1 entries
  std::vector<int> columns;
  std::vector<double> values;

  int rows() const { return static_cast<int>(offsets.size()) - 1; }
  std::size_t entries() const { return values.size(); }

  /// y = A x.
  void multiply(const double* x, double* y) const;

  std::vector<double> diagonal() const;

  /// max_ij |a_ij|.
  double maxNorm() const;

  /// ‖A‖_∞, the largest row sum of absolute values; an upper bound of the spectral norm of a symmetric
  /// matrix.
  double infinityNorm() const;
};

/// Hash of the sparsity pattern.
std::size_t patternHash(const LocalMatrix& matrix);

/// Whether two matrices with positive diagonals have the same pattern, and entries that differ by at most
/// tolerance · √(a_ii a_jj): soft parts are compared as sharply as stiff ones.
bool sameContent(const LocalMatrix& a, const LocalMatrix& b, double tolerance);

/// The lower triangle, entry by entry, with row and column numbers counted from `base`.
struct Triplets {
  std::vector<int> rows, columns;
  std::vector<double> values;
};
Triplets lowerTriangle(const LocalMatrix& matrix, int base);

/// A matrix entry for makeLocalMatrix().
struct MatrixEntry {
  int row;
  int column;
  double value;
};

/// Sums entries at equal places into a LocalMatrix of the given order.
/// @throws InternalError if an entry lies outside.
LocalMatrix makeLocalMatrix(int rows, std::vector<MatrixEntry> entries);

/// A + B of the same order.
LocalMatrix sum(const LocalMatrix& a, const LocalMatrix& b);

} // namespace Harmos
