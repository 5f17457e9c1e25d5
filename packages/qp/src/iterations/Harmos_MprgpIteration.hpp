// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTypes.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_QpTypes.hpp"
#include "Harmos_SolverMonitor.hpp"

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
/// For fixed steps ᾱ ∈ (0, 2/‖H‖) and no preconditioner each step reduces the distance to the minimal cost:
///
///     f(x_{k+1}) − f* ≤ η (f(x_k) − f*),   η = 1 − α̂ λ_min / (ϑ + ϑΓ̂²),
///     Γ̂ = max(Γ, 1/Γ),  α̂ = min(ᾱ, 2/‖H‖ − ᾱ),  ϑ = 2 max(ᾱ‖H‖, 1)
///
/// (Dostál & Schöberl, Comput. Optim. Appl. 30, 2005, for ᾱ ≤ 1/‖H‖; Dostál, Optimal Quadratic Programming
/// Algorithms, 2009, section 5.8 up to 2/‖H‖). In all variants the cost never rises.
///
/// With discs a step along β would have no length on a rim: x ← Π(x − ᾱg) takes its place (MPGP: Dostál,
/// Kozubek, Math. Program. 135, 2012), at the price of another product. The same η holds.
///
/// With a preconditioner the conjugate gradients work with z = (M⁻¹φ)_F (preconditioning in face); expansion
/// by the fixed step and proportioning are left as they are, so that convergence does not depend on it.
///
/// Cost: a product with H for a conjugate gradient or proportioning step, two for an expansion, three if it
/// falls back. Apart from the product and its pᵀHp, an unpreconditioned step is one pass over the vectors
/// and one reduction: ‖Hp‖² and φᵀHp over the free entries give the β of the next direction,
/// β = (φᵀHp − α‖Hp‖²)/pᵀHp, before the new gradient is there (Chronopoulos & Gear, J. Comput. Appl. Math.
/// 25, 1989), so that x, g and p are updated and split in the same pass.
///
/// ‖H‖ is an estimate: a larger curvature met along a search direction, or a cost that rises over a fixed
/// step, corrects it.
///
/// Guarded by tests/unit/qp/test_theory.cpp (proven decrease), test_random_problems.cpp and
/// test_serial_reference.cpp.
template<class Scalar, class MV>
class MprgpIteration {
 public:
  using Apply = std::function<void(const MV&, MV&)>;
  /// z = (M⁻¹φ)_F on the face given; null without a preconditioner. The flag tells whether the face is
  /// another than at the last call.
  using Precondition = std::function<void(const MV&, const ActiveFace&, bool, MV&)>;

  enum class Outcome { ConjugateGradient, Expansion, Proportioning, Unbounded, Breakdown };

  /// @param apply y = Hx, counted by the caller. @param feasible what it points to has to outlive this.
  MprgpIteration(Apply apply, Precondition precondition, const FeasibleSet<MV>& feasible,
                 const MprgpOptions& options, Counters& counters);

  /// Starts at a feasible x with gradient g = Hx − b; both are updated in place by step().
  /// @param curvatureScale ‖A‖ where H = A + ρC̄ᵀC̄: curvatures are told from zero relative to it.
  void start(Teuchos::RCP<MV> x, Teuchos::RCP<MV> gradient, Teuchos::RCP<const MV> rhs, double hessianNorm,
             double curvatureScale);

  /// To be called after the gradient, b or H were changed from outside: splits anew and drops the direction.
  void restart(double hessianNorm);

  /// Direction, splitting and all else but x, g and b, which are their owners'. Reading: after start() at the
  /// iterate that was written.
  void exchange(StateArchive<MV>& archive);

  /// One step; the splitting is that of the new iterate afterwards.
  /// @note Collective.
  Outcome step();

  /// g ← Hx − b.
  void refreshGradient();

  const SplitSums& sums() const { return sums_; }
  const ActiveFace& active() const { return active_; }
  double hessianNorm() const { return hessian_.norm; }
  /// Steps since the gradient was computed from x itself; rounding errors grow with it.
  int staleness() const { return staleness_; }
  /// f(x_k) − f(x_{k+1}) of the last step.
  double decrease() const { return decrease_; }
  /// After Outcome::Unbounded: the direction p, along −p the cost falls without end, and Hp.
  const MV& direction() const { return *along_.p; }

 private:
  // What is known of p for the next step in the face.
  enum class Next {
    Ready,    // p is the direction
    Fresh,    // p is to be made of φ alone
    Conjugate // p is to be made of φ and the last p
  };

  double stepLength() const { return options_.stepFactor / hessian_.norm; }
  // Where a pass writes φ: the next direction itself, or what the preconditioner is applied to.
  MV& freeGradient() { return hessian_.precondition ? *work_.phi : *along_.p; }
  void countFace();
  void begin();
  void completeDirection();
  void expandFixed(const CurvatureSums& along);
  void goDown(const MV& direction);
  Outcome proportionBySteps();
  bool expandProjected(double cgStep);
  double roundingOfCurvature() const;

  // H, and what is known of it.
  struct Hessian {
    Apply apply;
    Precondition precondition;
    double norm = 0.0;
    double curvatureScale = 0.0;
  };
  // The last direction, or the next one.
  struct Direction {
    Teuchos::RCP<MV> p, image;
    Next next = Next::Ready;
    double longestStep = 0.0; // along p
    double dotImage = 0.0;
  };
  struct Work {
    Teuchos::RCP<MV> xOld, gOld, phi, z;
  };

  Hessian hessian_;
  FeasibleSet<MV> feasible_;
  MprgpOptions options_;
  Counters& counters_;
  Teuchos::RCP<MV> x_, g_;
  Teuchos::RCP<const MV> b_;
  Direction along_;
  Work work_;
  ActiveFace active_;
  SplitSums sums_;
  double discSize_ = 0.0; // the largest there is; none: 0
  double decrease_ = 0.0;
  bool faceChanged_ = true; // since the preconditioner was last asked
  int staleness_ = 0;
};

} // namespace Harmos::qp
