// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundaryOperator.hpp"
#include "Harmos_FrontTree.hpp"

#include <memory>
#include <vector>

namespace Harmos::feti {

/// Memory that a factorisation needs while it goes on, for one after the other.
class FrontWorkspace {
 public:
  double* stack(std::size_t entries) { return enough(stack_, stackSize_, entries); }
  double* front(std::size_t entries) { return enough(front_, frontSize_, entries); }

 private:
  static double* enough(std::unique_ptr<double[]>& memory, std::size_t& size, std::size_t entries);
  std::unique_ptr<double[]> stack_, front_;
  std::size_t stackSize_ = 0, frontSize_ = 0;
};

/// A = LLᵀ of one rank's sparse symmetric positive definite matrix, or of a part of its rows, made for
/// solutions that take no longer than reading L does.
///
/// Direct solvers work with matrix-matrix products, for which a single right-hand side is an afterthought: a
/// solution by MUMPS takes several times as long as its factor takes to be read, and subdomains that differ
/// have one right-hand side each. Here L is kept in the order in which a solution goes through it, and what a
/// solution with loads at some rows alone, asked for there alone, does not need is left out.
///
/// Where rows b stay, S = A_bb − A_bi A_ii⁻¹ A_ib is made, and L is that of A_ii.
///
/// In single precision L is made in double and kept in float, sums are gathered in double: a relative error
/// of some 6e-8 κ in a solution.
///
/// Guarded by tests/unit/feti/local/test_multifrontal_cholesky.cpp.
class MultifrontalCholesky {
 public:
  /// @throws NumericalError if the matrix is not positive definite, naming a row. Local.
  MultifrontalCholesky(const LocalMatrix& matrix, std::shared_ptr<const FrontTree> tree, Precision precision,
                       FrontWorkspace& workspace);

  /// Solutions are those with L in single precision from now on; L itself stays until keep() or refactor().
  void round();
  /// Of the two that there are after round(), the one that is held from now on.
  void keep(Precision precision);

  /// Another matrix with the same pattern, in the precision of the constructor. @throws as that.
  void refactor(const LocalMatrix& matrix, FrontWorkspace& workspace);

  const FrontTree& tree() const { return *tree_; }

  /// S, whole, column after column; it is handed over once.
  std::vector<double> takeSchurComplement();

  /// X ← A⁻¹X for count vectors of all rows of the matrix, column after column; where rows stay or are absent
  /// X_i ← A_ii⁻¹X_i, and X_b is left as it is.
  void solve(double* x, int count) const;
  /// The same where x is zero but at rows of fronts that are reached, and only asked for there: other entries
  /// are undefined. @param reached of FrontTree::reachedFrom().
  void solveReached(double* x, int count, const std::vector<char>& reached) const;

  double bytes() const;

 private:
  void solve(double* x, int count, const std::vector<char>* reached) const;
  template<class T>
  void store(const FrontTree::Front& front, const double* dense, int height, T* factor);
  template<class T, class Work>
  void forward(const T* factor, const std::vector<char>* reached, double* x, int count, Work&& work) const;
  template<class T, class Work>
  void backward(const T* factor, const std::vector<char>* reached, double* x, int count, Work&& work) const;

  std::shared_ptr<const FrontTree> tree_;
  Precision precision_; ///< that L is made in
  // L, in one of the precisions; written once, and not before.
  std::unique_ptr<double[]> double_;
  std::unique_ptr<float[]> single_;
  std::vector<double> schur_;
  mutable std::vector<double> permuted_, work_;
};

} // namespace Harmos::feti
