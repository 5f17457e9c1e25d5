// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseModel.hpp"
#include "Harmos_CoarseOptions.hpp"
#include "Harmos_CoarseSpace.hpp"
#include "Harmos_DistributedFactor.hpp"

#include <memory>
#include <string>
#include <vector>

namespace Harmos::feti {

/// The coarse space with A in shares: a projection costs messages to neighbours, one all-gather and a product
/// with this rank's rows of A⁻; see DistributedFactor.
///
/// Equality rows are GᵀG in place of G: a vector of theirs is a dual one in the range of Gᵀ, and as G has
/// orthonormal rows its norm is that of Gλ. The transpose is the identity there. On a face
///
///     y with G_F G_Fᵀ y = r     becomes     Gᵀy = G̃ᵀA_F⁻G̃ Gᵀr,     A_F = G̃M_FG̃ᵀ.
///
/// A is factored without pivoting for size, by MUMPS, and what it leaves out is judged by its own pivots: how
/// well A⁻ does is measured on one vector, and A⁻ refined where that is not enough.
/// Guarded by tests/unit/feti/coarse/test_coarse_space.cpp.
class DistributedCoarse : public CoarseSpace {
 public:
  /// @throws NumericalError on all ranks if A is conditioned so badly that refinement does not help.
  /// @note Collective.
  DistributedCoarse(const RigidMotions& motions, const Constraints& constraints,
                    const CoarseOptions& options);

  int dimension() const override { return kernelDimension() - static_cast<int>(factor_->leftOut().size()); }
  double smallestPivotRatio() const override { return smallestPivotRatio_; }
  std::vector<char> dependentMotions() const override;
  bool isDistributed() const override { return true; }
  std::string description() const override;
  const DistributedFactor& factor() const { return *factor_; }
  /// ‖P(I − P)‖ as measured, before refinement.
  double inaccuracy() const { return inaccuracy_; }

  std::vector<double> solve(const std::vector<double>& e) const override;
  /// @param sums of the ranks, to be added up over them with the same all-gather.
  std::vector<double> solve(const std::vector<double>& e, std::vector<double>& sums) const;
  void project(MultiVector& v) const override;
  Teuchos::RCP<const Operator> equalityRows() const override;
  Teuchos::RCP<const qp::FaceGramMaker<MultiVector>> faceGram() const override;
  std::vector<double> minimumNormSolution(const MultiVector& mask,
                                          const std::vector<double>& r) const override;

  /// A_F⁻ of a face. @param slipping, q see qp::FaceGramMaker. @note Collective.
  DistributedFactor faceFactor(const MultiVector& mask, const std::vector<qp::Slip>& slipping, double q,
                               double threshold) const;
  /// s ← A_F⁻s with such a factor. @note Collective.
  std::vector<double> solveWith(const DistributedFactor& factor, const std::vector<double>& e,
                                std::vector<double>& sums) const;
  std::vector<double> solveWith(const DistributedFactor& factor, const std::vector<double>& e) const {
    std::vector<double> none;
    return solveWith(factor, e, none);
  }

 private:
  std::vector<double> gram(const double* mask, const std::vector<qp::Slip>& slipping, double q) const;
  std::vector<double> product(const std::vector<double>& s, const MultiVector* mask) const;
  DistributedFactor::Form formOf(bool isFace) const;
  double measuredInaccuracy() const;
  double estimatedPivotRatio() const;

  Teuchos::RCP<const Map> dualMap_;
  CoarseShape shape_;
  bool isScaled_; // where rows of B have weights; a rank without motions has no scale_ even so
  CoarseOptions::Inverse inverse_;
  std::vector<double> scale_, touchedScale_;  // √ of the diagonal of A
  std::vector<std::size_t> rowAt_, columnAt_; // of the places of rows(): where they are among touched columns
  std::unique_ptr<DistributedGraph> graph_;
  std::unique_ptr<DistributedFactor> factor_;
  bool isRefined_ = false;
  double inaccuracy_ = 0.0, smallestPivotRatio_ = 1.0;
};

} // namespace Harmos::feti
