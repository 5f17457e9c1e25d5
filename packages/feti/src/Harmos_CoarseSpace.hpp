// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Constraints.hpp"
#include "Harmos_PivotedCholesky.hpp"

#include <Tpetra_Operator.hpp>

#include <vector>

namespace Harmos::feti {

/// The natural coarse space: G̃ = RᵀBᵀ, its orthonormalised form G = L⁻¹G̃ with LLᵀ = G̃G̃ᵀ, and P = I − GᵀG.
///
/// G̃G̃ᵀ is dense and held on every rank; its Cholesky factorisation with complete pivoting reveals the rank.
/// Rows of G̃ that depend on the others are left out: G then has the same kernel and orthonormal rows all the
/// same. A product with G costs one reduction of the coarse dimension, one with Gᵀ none.
///
/// Guarded by tests/unit/feti/test_coarse_space.cpp (P² = P, GGᵀ = I, rank deficiency).
class CoarseSpace {
 public:
  /// @note Collective.
  CoarseSpace(const SubdomainSystem& system, const Constraints& constraints);

  /// Rows of G; less than the kernel dimension if G̃ is rank deficient.
  int dimension() const { return factor_.rank(); }
  /// Rows of G̃.
  int kernelDimension() const { return kernelDimension_; }
  /// Estimated smallest over largest pivot of G̃G̃ᵀ among those kept.
  double smallestPivotRatio() const { return factor_.smallestPivotRatio(); }
  /// Columns of R left out because of rank deficiency.
  std::vector<int> dependentColumns() const;

  /// w = Gλ, the same on all ranks. @note Collective, one reduction.
  std::vector<double> applyG(const MultiVector& lambda, std::size_t column = 0) const;
  /// λ ← λ + factor·Gᵀw. Local.
  void addGt(double factor, const std::vector<double>& w, MultiVector& lambda, std::size_t column = 0) const;
  /// v ← Pv. @note Collective.
  void project(MultiVector& v) const;

  /// G̃λ, indexed by the columns of R. @note Collective.
  std::vector<double> applyUnscaled(const MultiVector& lambda, std::size_t column = 0) const;
  /// L⁻¹ of a vector indexed by the columns of R.
  std::vector<double> solveL(const std::vector<double>& e) const { return factor_.solveL(e); }
  /// L⁻ᵀw, indexed by the columns of R; zero at dependent ones.
  std::vector<double> solveLt(const std::vector<double>& w) const { return factor_.solveLt(w); }

  /// G̃ of an owned row: pairs (column of R, value).
  const std::vector<std::pair<int, double>>& row(int ownedRow) const {
    return rows_[static_cast<std::size_t>(ownedRow)];
  }

  /// Map of vectors w = Gλ: replicated on all ranks.
  const Teuchos::RCP<const Map>& coarseMap() const { return coarseMap_; }

 private:
  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  std::vector<std::vector<std::pair<int, double>>> rows_;
  PivotedCholesky factor_; // of G̃G̃ᵀ
  Teuchos::RCP<const Map> coarseMap_;
  int kernelDimension_ = 0;
};

/// G as a Tpetra operator from dual vectors to the replicated coarse map, and its transpose.
class CoarseOperator : public Operator {
 public:
  CoarseOperator(const CoarseSpace& coarse, Teuchos::RCP<const Map> dualMap)
      : coarse_(coarse), dualMap_(std::move(dualMap)) {}
  Teuchos::RCP<const Map> getDomainMap() const override { return dualMap_; }
  Teuchos::RCP<const Map> getRangeMap() const override { return coarse_.coarseMap(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

 private:
  const CoarseSpace& coarse_;
  Teuchos::RCP<const Map> dualMap_;
};

/// PFP as a Tpetra operator.
class ProjectedOperator : public Operator {
 public:
  ProjectedOperator(const Operator& inner, const CoarseSpace& coarse) : inner_(inner), coarse_(coarse) {}
  Teuchos::RCP<const Map> getDomainMap() const override { return inner_.getDomainMap(); }
  Teuchos::RCP<const Map> getRangeMap() const override { return inner_.getRangeMap(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

 private:
  const Operator& inner_;
  const CoarseSpace& coarse_;
};

} // namespace Harmos::feti
