// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalMatrix.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace Harmos::feti {

/// K_bi of a matrix, i all but the boundary b: a row for each of b, columns numbered as those of K; not
/// square.
LocalMatrix couplingOf(const LocalMatrix& matrix, const std::vector<int>& boundary);

/// A symmetric operator on the boundary dofs of one subdomain matrix: (K⁺)_bb for the dual operator, the
/// Schur complement S or K_bb for the preconditioners.
class BoundaryOperator {
 public:
  virtual ~BoundaryOperator() = default;

  /// Number of boundary dofs.
  virtual int size() const = 0;

  /// U = A T for count vectors, column after column. @throws NumericalError, InternalError. Local.
  virtual void apply(const double* t, double* u, int count) const = 0;

  /// A itself, dense, column after column. @throws as apply().
  virtual std::vector<double> matrix() const;

  /// Memory held.
  virtual double bytes() const = 0;
  /// Memory that a product with count vectors has to read at least.
  virtual double bytesRead(int count) const = 0;
  /// Arithmetic operations of a product with one vector.
  virtual double flops() const = 0;
};

/// In which precision dense blocks are kept.
enum class Precision { Double, Single };

/// A dense symmetric matrix.
///
/// For several vectors at once it is kept whole and products are matrix-matrix products of BLAS. For single
/// vectors reading it is what takes the time: it is then kept packed, one triangle in panels of four columns,
/// so that each entry is read once and in the order of storage.
///
/// In single precision entries are rounded to float; sums are gathered in double: over all terms when packed,
/// over every 128 terms otherwise, where the vectors are rounded to float as well. Relative error of a
/// product: 6e-8 from rounding, some 1e-7 for the sums.
///
/// Guarded by tests/unit/feti/local/test_boundary_operator.cpp.
class DenseOperator : public BoundaryOperator {
 public:
  /// @param matrix n × n, both triangles. @param columns how many vectors a product usually has.
  DenseOperator(std::vector<double> matrix, int n, Precision precision, int columns);

  /// From now on in single precision, if it is packed: sums are gathered in double all the same.
  void roundIfPacked();

  int size() const override { return n_; }
  void apply(const double* t, double* u, int count) const override;
  std::vector<double> matrix() const override;
  double bytes() const override;
  double bytesRead(int count) const override;
  double flops() const override { return 2.0 * n_ * n_; }

 private:
  template<class T>
  void applyWhole(const std::vector<T>& matrix, const double* t, double* u, int count) const;

  int n_;
  bool packed_;
  std::vector<double> double_;
  std::vector<float> single_;
  mutable std::vector<float> operand_, product_;
  mutable std::vector<double> operandColumn_, productColumn_;
};

/// The rows and columns b of a sparse matrix: K_bb, the lumped approximation of S.
class SparseOperator : public BoundaryOperator {
 public:
  SparseOperator(const LocalMatrix& matrix, const std::vector<int>& boundary);

  int size() const override { return block_.rows(); }
  void apply(const double* t, double* u, int count) const override;
  double bytes() const override { return bytesRead(1); }
  double bytesRead(int) const override { return 12.0 * static_cast<double>(block_.entries()); }
  double flops() const override { return 2.0 * static_cast<double>(block_.entries()); }

 private:
  LocalMatrix block_;
};

} // namespace Harmos::feti
