// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_QpTypes.hpp"

#include <Teuchos_ParameterList.hpp>
#include <Teuchos_RCP.hpp>

#include <functional>

namespace Harmos::qp {

/// How MPRGP leaves a face whose conjugate gradient step would leave the feasible set.
enum class Expansion {
  /// Dostál & Schöberl 2005: step to the boundary, then x ← Π(x − ᾱφ).
  FixedStep,
  /// x ← Π(x − α_cg p), undone in favour of FixedStep if the cost rises.
  ProjectedConjugateGradient
};

/// Parameters of MPRGP; parameterSpec() is their description, this its values.
struct MprgpOptions {
  double gamma = 1.0;       ///< Γ of the proportioning test ‖β‖² ≤ Γ² φ̃ᵀφ
  double stepFactor = 1.95; ///< ᾱ‖H‖, in (0, 2]
  Expansion expansion = Expansion::ProjectedConjugateGradient;
  int normApplications = 12; ///< most products with the Hessian spent on the estimate of its norm
  double normSafety = 1.05;  ///< factor on that estimate

  static ParameterSpec parameterSpec();
  static MprgpOptions fromList(const Teuchos::ParameterList& list);
};

/// Modified proportioning with reduced gradient projections for min ½xᵀHx − bᵀx, l ≤ x ≤ u, a step at a time.
///
/// The iterate is proportional if ‖β‖² ≤ Γ²φ̃ᵀφ. Proportional: a conjugate gradient step in the face, or an
/// expansion step if that is not feasible. Otherwise: a proportioning step along the chopped gradient β.
/// For fixed steps ᾱ ∈ (0, 2/‖H‖] the cost falls R-linearly with a rate given by the bounds of the spectrum
/// alone (Dostál & Schöberl, Comput. Optim. Appl. 30, 2005; Dostál, Optimal Quadratic Programming Algorithms,
/// 2009, section 5.8). Cost: a product with H for a conjugate gradient or proportioning step, two for an
/// expansion, three if it falls back; one pass and one reduction for the splitting.
///
/// ‖H‖ is an estimate: a larger curvature met along a search direction, or a cost that rises over a fixed
/// step, corrects it.
///
/// Guarded by tests/unit/qp/test_solvers.cpp (brute force, monotone cost).
template<class Scalar, class MV>
class MprgpIteration {
 public:
  using Apply = std::function<void(const MV&, MV&)>;

  enum class Outcome { ConjugateGradient, Expansion, Proportioning, Unbounded, Breakdown };

  /// @param apply y = Hx, counted by the caller; @param lower, upper null where absent, to outlive this.
  MprgpIteration(Apply apply, const MV* lower, const MV* upper, const MprgpOptions& options,
                 Counters& counters);

  /// Starts at a feasible x with gradient g = Hx − b; both are updated in place by step().
  void start(Teuchos::RCP<MV> x, Teuchos::RCP<MV> gradient, Teuchos::RCP<const MV> rhs, double hessianNorm);

  /// To be called after the gradient, b or H were changed from outside: splits anew and drops the direction.
  void restart(double hessianNorm);

  /// One step; the splitting is that of the new iterate afterwards.
  /// @note Collective.
  Outcome step();

  /// g ← Hx − b.
  void refreshGradient();

  const SplitSums& sums() const { return sums_; }
  double hessianNorm() const { return hessianNorm_; }
  /// Steps since the gradient was computed from x itself; rounding errors grow with it.
  int staleness() const { return staleness_; }

 private:
  void split(const MV* image);
  void expandFixed(double longestStep);
  bool expandProjected(double cgStep);
  double costChange(const MV& xOld, const MV& gOld);

  Apply apply_;
  const MV* lower_;
  const MV* upper_;
  MprgpOptions options_;
  Counters& counters_;
  Teuchos::RCP<MV> x_, g_, p_, image_, phi_, xOld_, gOld_, work_;
  Teuchos::RCP<const MV> b_;
  LocalActiveSet active_;
  SplitSums sums_;
  double hessianNorm_ = 0.0;
  int staleness_ = 0;
};

} // namespace Harmos::qp
