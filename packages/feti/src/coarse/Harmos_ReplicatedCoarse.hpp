// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTypes.hpp"
#include "Harmos_CoarseFactor.hpp"
#include "Harmos_CoarseSpace.hpp"

#include <vector>

namespace Harmos::feti {

/// The coarse space with A and its factor whole on every rank: a product with G costs one reduction of the
/// coarse dimension, one with Gᵀ none, and neither gets cheaper with more ranks. Rank 0 decides the rank of A
/// for all: sums over ranks need not be equal to the last bit. Equality rows are those of G, and their
/// vectors the same on all ranks.
///
/// Vectors of length kernelDimension() are indexed by the columns of R, all of them.
/// Guarded by tests/unit/feti/coarse/test_coarse_space.cpp.
class ReplicatedCoarse : public CoarseSpace {
 public:
  /// @param mostDense see CoarseFactor. @note Collective.
  ReplicatedCoarse(const RigidMotions& motions, const Constraints& constraints,
                   int mostDense = CoarseFactor::mostDense);

  int dimension() const override { return factor_.rank(); }
  double smallestPivotRatio() const override { return factor_.smallestPivotRatio(); }
  std::vector<char> dependentMotions() const override;
  bool isDistributed() const override { return false; }
  std::string description() const override {
    return factor_.isDense() ? "replicated, dense" : "replicated, sparse";
  }
  /// Columns of R left out because of rank deficiency.
  std::vector<int> dependentColumns() const { return factor_.dependent(); }
  const CoarseFactor& factor() const { return factor_; }

  std::vector<double> solve(const std::vector<double>& e) const override;
  void project(MultiVector& v) const override;
  Teuchos::RCP<const Operator> equalityRows() const override;
  Teuchos::RCP<const qp::FaceGramMaker<MultiVector>> faceGram() const override;
  std::vector<double> minimumNormSolution(const MultiVector& mask,
                                          const std::vector<double>& r) const override;

  /// G_F G_Fᵀ for the rows of B with mask 1, factored in a form of its own: solveOnFace() solves with it.
  /// @param mask 1 or 0 for each dual row. @note Collective, one reduction.
  CoarseFactor faceFactor(const MultiVector& mask) const;
  /// The same, with a row tᵀB of the two of each pair that slips beside those of the mask, weighted by q/(q +
  /// κ), or one where q = 0.
  /// @param slipping of pairs of Constraints::discs(), with mask 0.
  CoarseFactor faceFactor(const MultiVector& mask, const std::vector<qp::Slip>& slipping, double q) const;
  /// y with G_F G_Fᵀ y = r: y = Lᵀ(G̃_F G̃_Fᵀ)⁻Lr. Local.
  std::vector<double> solveOnFace(const CoarseFactor& face, const std::vector<double>& r) const;

  /// The same, r = Gλ. @param sums of the ranks, to be added up over them. @note Collective, one reduction.
  std::vector<double> solveOnFace(const CoarseFactor& face, const MultiVector& lambda,
                                  std::vector<double>& sums) const;

  /// w = Gλ, the same on all ranks. @note Collective, one reduction.
  std::vector<double> applyG(const MultiVector& lambda, std::size_t column = 0) const;
  /// @param sums of the ranks, to be added up over them in the same reduction.
  std::vector<double> applyG(const MultiVector& lambda, std::vector<double>& sums) const;
  /// λ ← λ + factor·Gᵀw. Local.
  void addGt(double factor, const std::vector<double>& w, MultiVector& lambda, std::size_t column = 0) const;

  /// G̃λ, all of it. @note Collective, one reduction.
  std::vector<double> applyUnscaled(const MultiVector& lambda, std::size_t column = 0) const;
  std::vector<double> applyUnscaled(const MultiVector& lambda, std::size_t column,
                                    std::vector<double>& sums) const;
  /// L⁻¹ of a vector indexed by the columns of R.
  std::vector<double> solveL(const std::vector<double>& e) const { return factor_.solveL(e); }
  /// L⁻ᵀw, indexed by the columns of R; zero at dependent ones.
  std::vector<double> solveLt(const std::vector<double>& w) const { return factor_.solveLt(w); }

  /// Map of vectors w = Gλ: replicated on all ranks.
  const Teuchos::RCP<const Map>& coarseMap() const { return coarseMap_; }

 private:
  std::vector<double> wholeOf(const std::vector<double>& own) const;
  std::vector<double> ownOf(const std::vector<double>& whole) const;
  void makePattern();
  void makeScale();
  template<class Real>
  std::vector<Real> gram(const double* mask, const std::vector<qp::Slip>& slipping, double q) const;
  CoarseFactor factorOf(const double* mask, double threshold, const std::vector<qp::Slip>& slipping = {},
                        double q = 0.0) const;

  Teuchos::RCP<const Map> dualMap_;
  std::vector<int> gramRows_, gramColumns_; // lower triangle of G̃G̃ᵀ
  std::vector<std::size_t> gramPlaces_;     // in it, of the places of rows()
  std::vector<double> scale_; // of the columns of R, where rows of B have weights: √ of the diagonal of G̃G̃ᵀ
  CoarseFactor factor_;       // of G̃G̃ᵀ
  Teuchos::RCP<const Map> coarseMap_;
  int mostDense_;
};

} // namespace Harmos::feti
