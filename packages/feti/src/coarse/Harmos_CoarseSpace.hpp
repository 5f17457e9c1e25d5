// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"
#include "Harmos_CoarseFactor.hpp"
#include "Harmos_Constraints.hpp"

#include <Tpetra_Operator.hpp>

#include <vector>

namespace Harmos::feti {

/// The natural coarse space: G̃ = RᵀBᵀ, its orthonormalised form G = L⁻¹G̃ with LLᵀ = G̃G̃ᵀ, and P = I − GᵀG.
///
/// G̃G̃ᵀ and its factor are held by every rank: a product with G costs one reduction of the coarse dimension,
/// one with Gᵀ none. Rows of G̃ that depend on the others are left out: G then has the same kernel and
/// orthonormal rows all the same. Rank 0 decides the rank for all: sums over ranks need not be equal to the
/// last bit.
///
/// Guarded by tests/unit/feti/test_coarse_space.cpp (P² = P, GGᵀ = I, rank deficiency, dense and sparse).
class CoarseSpace {
 public:
  /// @param mostDense see CoarseFactor. @note Collective.
  CoarseSpace(const SubdomainSystem& system, const Constraints& constraints,
              int mostDense = CoarseFactor::mostDense);

  /// Rows of G; less than the kernel dimension if G̃ is rank deficient.
  int dimension() const { return factor_.rank(); }
  /// Rows of G̃.
  int kernelDimension() const { return kernelDimension_; }
  /// Estimated smallest over largest pivot of G̃G̃ᵀ among those kept.
  double smallestPivotRatio() const { return factor_.smallestPivotRatio(); }
  /// Columns of R left out because of rank deficiency.
  std::vector<int> dependentColumns() const { return factor_.dependent(); }
  const CoarseFactor& factor() const { return factor_; }

  /// G_F G_Fᵀ for the rows of B with mask 1, factored in a form of its own: solveOnFace() solves with it.
  /// @param mask 1 or 0 for each dual row. @note Collective, one reduction.
  CoarseFactor faceFactor(const MultiVector& mask) const;
  /// The same, with a row tᵀB of the two of each pair that slips beside those of the mask, weighted by q/(q +
  /// κ), or one where q = 0.
  /// @param slipping of pairs of Constraints::discs(), with mask 0.
  CoarseFactor faceFactor(const MultiVector& mask, const std::vector<qp::Slip>& slipping, double q) const;
  /// y with G_F G_Fᵀ y = r: y = Lᵀ(G̃_F G̃_Fᵀ)⁻Lr. Local.
  std::vector<double> solveOnFace(const CoarseFactor& face, const std::vector<double>& r) const;

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

  /// G̃ of an owned row: calls visit(column of R, value) for each entry.
  template<class Visit>
  void forRow(int ownedRow, Visit&& visit) const {
    for (std::size_t k = offsets_[static_cast<std::size_t>(ownedRow)];
         k < offsets_[static_cast<std::size_t>(ownedRow) + 1]; ++k)
      visit(columns_[k], values_[k]);
  }

  /// The solution of least norm of G̃_F G̃_Fᵀ δ = r, for r in its range, rows of B with mask 1; indexed by the
  /// columns of R. @note Collective, one reduction.
  std::vector<double> minimumNormSolution(const MultiVector& mask, const std::vector<double>& r) const;

  /// Map of vectors w = Gλ: replicated on all ranks.
  const Teuchos::RCP<const Map>& coarseMap() const { return coarseMap_; }

 private:
  void padPairs(const Constraints& constraints);
  void makePattern();
  void makeScale();
  template<class Real>
  std::vector<Real> gram(const double* mask, const std::vector<qp::Slip>& slipping, double q) const;
  CoarseFactor factorOf(const double* mask, double threshold, const std::vector<qp::Slip>& slipping = {},
                        double q = 0.0) const;

  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  // G̃ᵀ by owned rows.
  std::vector<std::size_t> offsets_ = {0};
  std::vector<int> columns_;
  std::vector<double> values_;
  // Lower triangle of G̃G̃ᵀ; and its places that pairs of entries of a row fill, for each pattern of a row,
  // with their begin for each owned row.
  std::vector<int> gramRows_, gramColumns_, gramPlaces_;
  std::vector<std::size_t> firstPlace_;
  std::vector<double> scale_; // of the columns of R, where rows of B have weights: √ of the diagonal of G̃G̃ᵀ
  CoarseFactor factor_;       // of G̃G̃ᵀ
  Teuchos::RCP<const Map> coarseMap_;
  int kernelDimension_ = 0;
  int mostDense_;
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

/// PFP as a Tpetra operator; or PF, which is the same on vectors with Gλ = 0 and saves a reduction.
class ProjectedOperator : public Operator {
 public:
  ProjectedOperator(const Operator& inner, const CoarseSpace& coarse, bool onKernel = false)
      : inner_(inner), coarse_(coarse), onKernel_(onKernel) {}
  Teuchos::RCP<const Map> getDomainMap() const override { return inner_.getDomainMap(); }
  Teuchos::RCP<const Map> getRangeMap() const override { return inner_.getRangeMap(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

 private:
  const Operator& inner_;
  const CoarseSpace& coarse_;
  bool onKernel_;
};

} // namespace Harmos::feti
