// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseSpace.hpp"
#include "Harmos_FeasibleSet.hpp"
#include "Harmos_FollowingLimits.hpp"
#include "Harmos_LocalInverses.hpp"
#include "Harmos_SoftBounds.hpp"

#include <Teuchos_RCP.hpp>

#include <memory>
#include <vector>

namespace Harmos::feti {

class DualOperator;

/// The dual quadratic program in shifted and projected form (Dostál, Horák, Vlach, eq. 3.5):
///
///     min ½λᵀPFPλ − λᵀPd   subject to   Gλ = 0,  λ_I ≥ −λ̃_I
///
/// and, of limited rows, |λ + λ̃| ≤ limit: intervals and discs about −λ̃, or limits that follow λ_I + λ̃_I,
///
/// with d̃ = BK⁺f − c, ẽ = Rᵀf, λ̃ = G̃ᵀ(G̃G̃ᵀ)⁻¹ẽ, d = d̃ − Fλ̃; the multiplier of the torn problem is λ + λ̃.
/// Without a kernel there is no G and P = I. Immutable.
///
/// Guarded by tests/unit/feti/test_mixed_inverses.cpp and test_recovery.cpp.
class DualProblem {
 public:
  /// Two products with the local inverses: one for d̃, one for Fλ̃ (none without a
  /// kernel).
  /// @throws NumericalError on all ranks if a load on a rigid motion that no constraint can hold is not zero,
  /// naming
  ///         the subdomain.
  /// @note Collective.
  DualProblem(const SubdomainSystem& system, const Constraints& constraints, const LocalInverses& inverses,
              const DualOperator& dualOperator, const CoarseSpace& coarse);

  /// PFP, or F without a kernel.
  Teuchos::RCP<const Operator> hessian() const { return hessian_; }
  /// PF, equal to PFP where Gλ = 0; null without a kernel.
  Teuchos::RCP<const Operator> hessianOnKernel() const { return hessianOnKernel_; }
  /// F; null without a kernel.
  Teuchos::RCP<const Operator> unprojectedHessian() const { return unprojectedHessian_; }
  /// Pd.
  Teuchos::RCP<const MultiVector> rhs() const { return projectedD_; }
  const MultiVector& d() const { return *d_; }
  /// −λ̃_I on inequality rows that are not soft, −λ̃ − limit on limited ones in no disc, −∞ elsewhere; null
  /// without any.
  Teuchos::RCP<const MultiVector> lowerBound() const { return lowerBound_; }
  /// −λ̃ + limit on limited rows in no disc, ∞ elsewhere; null without any.
  Teuchos::RCP<const MultiVector> upperBound() const { return upperBound_; }
  /// Of limited rows; null without any on all ranks.
  std::shared_ptr<const qp::LocalDiscs> discs() const { return discs_; }
  /// Null without any on all ranks. Intervals and discs of them are
  /// open: what sticks everywhere is where solvers begin.
  std::shared_ptr<const qp::FollowingLimits> followingLimits() const { return following_; }
  /// Of soft rows, which have no others: [−λ̃, ∞) of inequalities, −λ̃ of limited rows. Null without any on all
  /// ranks.
  std::shared_ptr<const qp::LocalSoftBounds> softBounds() const { return soft_; }
  /// See CoarseSpace::equalityRows(); null without a kernel.
  Teuchos::RCP<const Operator> equalityRows() const { return equalityRows_; }
  /// λ̃.
  Teuchos::RCP<const MultiVector> shift() const { return shift_; }
  /// λ + λ̃.
  Teuchos::RCP<MultiVector> total(const MultiVector& lambda) const;
  /// ‖(G̃G̃ᵀ)⁻¹ẽ‖.
  double scaledLoadNorm() const { return scaledLoadNorm_; }
  /// Clusters::fingerprint() of those that it was made with; 0: none. λ and d are those of one set of
  /// clusters.
  double clusters() const { return clusters_; }
  /// Products with F spent on making d.
  int setupApplications() const { return setupApplications_; }

 private:
  void makeBounds(const Constraints& constraints);

  Teuchos::RCP<const Operator> hessian_;
  Teuchos::RCP<const Operator> hessianOnKernel_;
  Teuchos::RCP<const Operator> unprojectedHessian_;
  Teuchos::RCP<const Operator> equalityRows_;
  Teuchos::RCP<MultiVector> d_;
  Teuchos::RCP<MultiVector> projectedD_;
  Teuchos::RCP<MultiVector> shift_;
  Teuchos::RCP<MultiVector> lowerBound_, upperBound_;
  std::shared_ptr<const qp::LocalDiscs> discs_;
  std::shared_ptr<const qp::FollowingLimits> following_;
  std::shared_ptr<const qp::LocalSoftBounds> soft_;
  double scaledLoadNorm_ = 0.0;
  int setupApplications_ = 0;
  double clusters_ = 0.0;
};

} // namespace Harmos::feti
