// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveSetOps.hpp"
#include "Harmos_ConjugateDirections.hpp"
#include "Harmos_CoupledDirections.hpp"
#include "Harmos_EqualityRows.hpp"
#include "Harmos_FollowingOps.hpp"
#include "Harmos_InFacePreconditioner.hpp"
#include "Harmos_KeptDirections.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_StatusTest.hpp"

#include <Teuchos_RCP.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos::qp {

/// Preconditioned conjugate gradients for min ½xᵀAx − bᵀx on { x : C̄x = c̄, x_i = bound_i for active i }, a
/// step at a time. What PCPG (no active entries) and PDAS have in common.
///
/// Works with w = P_F(Ax − b), P_F = I − C_Fᵀ(C_FC_Fᵀ)⁻C_F the projector onto ker C_F, C_F = C̄ with the
/// columns of active entries set to zero; C_FC_Fᵀ = I without active entries, else it is dense and factored
/// for each face. The gradient is carried along projected: the part that is projected away stays large while
/// the rest vanishes, and would spoil it by cancellation. What is removed adds up to −μ̄.
///
/// Where limits follow the solution (FollowingLimit), what is held at one goes along with what it follows: x
/// = x_0
/// + Tv, T = I + Σ f e_i e_kᵀ, and the equations of a face, tested on what is free alone, are not symmetric.
/// They are solved by directions of least residuals, which take the preconditioner and the projector of the
/// face without T for their own; equalities are a part of the residual there. This is the Newton step of the
/// coupled problem (Alart, Curnier, Comput. Methods Appl. Mech. Engrg. 92, 1991).
///
/// Springs of soft bounds (SpringOps) are a part of A and b on a face. However stiff they are, they cost few
/// steps: the preconditioner and what meets the equalities know them.
///
/// Cost of a step: one product with A, one with the preconditioner, and a projection after each of them, with
/// which scalars travel where the rows know how (FaceGram::solveFor()): what they are products with lies in
/// the kernel already. So there are two reductions a step; without a preconditioner w is projected in the
/// place of z. With one, rounding errors of w out of the kernel add up, which are of what was projected away
/// in each step, and are taken out in each tenth; left in, they end in a breakdown (of such errors: Gould,
/// Hribar, Nocedal, SIAM J. Sci. Comput. 23, 2001). What full conjugation adds see ConjugateDirections.
///
/// Where A = PFP is given by F (Problem::setUnprojectedHessian()), P and P_F are one projection: P_FP = P_F.
/// On faces gradients are then known up to the range of C̄ᵀ until they are asked for, see settle().
///
/// Guarded by tests/unit/qp/test_solvers.cpp, test_projected_cg.cpp; messages by
/// tests/unit/feti/test_communication.cpp.
template<class Scalar, class MV, class OP>
class ProjectedCg {
 public:
  enum class Outcome { Step, Flat, Breakdown };

  ProjectedCg(const Problem<Scalar, MV, OP>& problem, EqualityRows<Scalar, MV, OP>& rows,
              const CgOptions& options, Counters& counters);

  /// Moves the problem's solution onto the face and the equalities, and begins there; a product with A.
  /// @param active empty for none. @param leastHold of what forces of the face do to motions, where limits
  /// follow.
  /// @return false if the equalities cannot be met on the face, or motions are held by less.
  bool start(const LocalActiveSet& active, double leastHold = 0.0);

  /// Springs of the next start() that are none of these let x go; see Kernels::moveToSprings(). Those of the
  /// last one, unless told.
  void knowSprings(const LocalActiveSet& set) { active_.springs = set.springs; }

  /// Begins again where it is, with gradients computed anew.
  void restart();

  /// Looks how far the solution is from the equalities, for evaluate(): steps stay in the kernel of the rows,
  /// so that start() knows, until rounding errors of many of them count. To be done where the solution was
  /// moved, and before an end is believed. @note Collective, a product with C.
  void lookAtRows();
  /// Whether no step was taken since it was looked.
  bool hasLooked() const { return hasLooked_ || !rows_.isPresent(); }

  /// Begins again from the equalities where the steps have left them by more than rounding errors of the
  /// iterate, and by more than is left of the gradient, each relative to its size: the error of a direction
  /// grows with what was projected away, times the condition of the rows.
  /// @param distance from the equalities, see EqualityRows. @return whether it did.
  bool returnToRows(double distance);

  /// Keeps what the steps since the last beginning have found of outlying eigenvalues, for all faces to come:
  /// see KeptDirections. To be followed by start(). @return how many directions are new.
  int keepOutliers(int most);
  KeptDirections<Scalar, MV, OP>& kept() { return kept_; }

  /// Iterate, gradients and directions. Reading takes the place of start(), without a product with A.
  void exchange(StateArchive<MV>& archive);

  Outcome step();

  /// ‖w‖.
  double residualNorm() const;
  /// What w says of slipping pairs.
  struct Slipping {
    /// ‖w‖ with tᵀw multiplied by q/(q + κ): their equations are 1 + κ/q times those of x = Π(x − g/q), whose
    /// Newton steps faces are.
    double residual;
    double overshoot; ///< by which they may be off along their tangents, in radii
  };
  /// @note Collective, with discs.
  Slipping slipping() const;
  /// Level of its rounding errors: ε(‖A‖‖x‖ + ‖b‖) of the largest x since it was computed anew.
  double attainable() const;
  /// Whether x has lost so much since then that start() would bring the level down by the most of it: springs
  /// make large forces of what is to become nothing. @note Collective, with springs.
  bool isRefinable() const;
  int staleness() const { return staleness_; }
  /// About that of the solution, bᵀb/bᵀM⁻¹b; without a preconditioner that of the last beginning, xᵀAx/xᵀx.
  double stiffness() const {
    return stiffness_ > 0.0 && std::isfinite(stiffness_) ? stiffness_
           : rayleigh_ > 0.0 && std::isfinite(rayleigh_) ? rayleigh_
                                                         : curvatureBound_;
  }
  /// The largest curvature pᵀAp/pᵀp met so far: a lower bound of ‖A‖.
  double curvatureBound() const { return curvatureBound_; }

  /// ½xᵀAx − bᵀx, with springs. @note Needs a face.
  double cost();
  /// Ax − b + C̄ᵀμ̄: w at free entries, the multipliers of the bounds at active ones. Springs are a part of A
  /// and b. @note Needs a face.
  void lagrangianGradient(MV& y);
  /// The same with soft bounds as they are where x is now.
  void trueGradient(MV& y);
  /// μ̄.
  void multiplier(MV& mu);
  /// Gives μ̄ to the problem.
  void storeMultiplier();
  /// The problem's present solution for the tests, with what is known of the equalities: see lookAtRows().
  /// @param gradientNorm ‖g^P‖ there.
  IterationState<MV> evaluate(double gradientNorm, int outer, int inner);
  /// After Outcome::Flat: A vanishes along p, and the cost falls along −p.
  const MV& direction() const { return *p_; }
  const MV& image() const { return *onFace_; }

 private:
  using BT = BoundTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  using Sets = ActiveSetOps<Scalar, MV>;
  using Limits = FollowingOps<Scalar, MV>;

  // wᵀp, pᵀp, pᵀAp, and that of A without curvatures and springs; global.
  struct DirectionSums {
    double dotGradient, norm2, dotImage, dotHessian;
  };
  static constexpr int lookInterval = 10; // steps

  void makeFaceVectors();
  void project(MV& v, std::vector<double>& sums);
  void project(MV& v, MV* removed = nullptr);
  DirectionSums applyToDirection();
  bool isFlatAlongDirection(double curvature);
  ResidualSums preconditionAndSum();
  void settle();
  void watchRows();
  void precondition();
  void preconditionSoftened();
  void raiseLevel(double iterateNorm2);
  // What overflows says nothing of A, and would be believed on all faces to come.
  void raiseCurvatureBound(double curvature) {
    if (std::isfinite(curvature))
      curvatureBound_ = std::max(curvatureBound_, curvature);
  }
  void findSlips();
  void soften(MV& v) const;
  void addSprings(const MV& x);
  Teuchos::RCP<MV> springForces(const MV& x) const;
  bool isAnywhere(bool isHere) const;
  void makeFaceGram();
  void findFollowing();
  double hold();
  void keepMotions(const MV& before);
  void solveRows(const MV& residual, MV& x);
  void solveRowsThatFollow(const MV& residual, MV& x);
  void letFollow(MV& x) const;
  Outcome coupledStep();
  CoupledDirection<MV> coupledDirection();
  void sumResidual();
  void keepRowResidual();

  const Problem<Scalar, MV, OP>& problem_;
  EqualityRows<Scalar, MV, OP>& rows_;
  Counters& counters_;
  InFacePreconditioner<Scalar, MV, OP> preconditioner_;
  ConjugateDirections<Scalar, MV> directions_;
  KeptDirections<Scalar, MV, OP> kept_;
  LocalActiveSet active_;
  bool hasFace_ = false;
  // Where limits follow.
  std::vector<FollowingEntry> following_;
  bool isCoupled_ = false;   // on any rank
  bool isDeficient_ = false; // motions on which no force of the face acts
  CoupledDirections<Scalar, MV> coupled_;
  Teuchos::RCP<MV> rowResidual_; // C̄x − c̄
  Teuchos::RCP<const FaceGram<MV>> faceGram_;
  // Where pairs slip: C̄TC̄ᵀ on the face, T = q/(q + κ) there; see InFacePreconditioner. q of A's diagonal.
  // And springs.
  Teuchos::RCP<const FaceGram<MV>> softGram_;
  double stiffness_ = 0.0;
  double rayleigh_ = 0.0; // without a preconditioner, where limits follow or there are discs
  bool isSoftened_ = false, hasSprings_ = false; // on any rank
  double springNorm_ = 0.0;                      // ‖κx‖
  Teuchos::RCP<MV> w_, z_, p_, image_, gradient_, rowWork_, removed_, unused_;
  Teuchos::RCP<MV> onFace_;     // P_F of the image, which it is itself where there is no face
  bool isUnprojected_ = false;  // images are those of F
  bool isSettled_ = true;       // gradient_ is Ax − b
  Teuchos::RCP<MV> rowsOfLoad_; // C̄b; on faces, with F
  double residual2_ = 0.0;
  double directionDotImage_ = 0.0;
  double curvatureBound_ = 0.0;
  double rhsNorm_ = 0.0;
  double iterateNorm_ = 0.0;
  double level_ = 0.0;
  int staleness_ = 0;
  // ‖Cx − c‖ and the distance, when it was looked.
  double equalityResidual_ = 0.0, equalityDistance_ = 0.0;
  bool hasLooked_ = false;
};

} // namespace Harmos::qp
