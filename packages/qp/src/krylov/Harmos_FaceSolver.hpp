// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConjugateGradients.hpp"
#include "Harmos_ConjugateResiduals.hpp"
#include "Harmos_StatusTest.hpp"

namespace Harmos::qp {

/// Solves the linear problem on a face (FaceSystem), a step at a time, by the Krylov method that its matrix
/// calls for; then that on the next face, from where it is. What PCPG (nothing held) and PDAS have in common.
///
/// On faces, where A = PFP is given by F, gradients are known up to the range of C̄ᵀ until they are asked for,
/// see settle().
///
/// Guarded by tests/unit/qp/test_solvers.cpp, test_projected_cg.cpp.
template<class Scalar, class MV, class OP>
class FaceSolver {
 public:
  using Outcome = typename Krylov<MV>::Outcome;

  FaceSolver(const Problem<Scalar, MV, OP>& problem, EqualityRows<Scalar, MV, OP>& rows,
             const CgOptions& options, Counters& counters);

  /// Moves the problem's solution onto the face and the equalities, and begins there; a product with A.
  /// @param leastHold of what forces of the face do to motions, where limits follow.
  /// @return false if the equalities cannot be met on the face, or motions are held by less.
  bool start(const ActiveFace& face, double leastHold = 0.0);
  /// See FaceSystem::knowSprings().
  void knowSprings(const ActiveFace& face) { system_.knowSprings(face); }
  /// Begins again where it is, with gradients computed anew.
  void restart();
  Outcome step() { return krylov().step(); }
  /// Iterate, gradients and directions. Reading takes the place of start(), without a product with A.
  void exchange(StateArchive<MV>& archive);

  /// Looks how far the solution is from the equalities, for evaluate(). To be done where the solution was
  /// moved, and before an end is believed. @note Collective, a product with C.
  void lookAtRows() { iterate_.distance.look(*iterate_.x); }
  bool hasLooked() const { return iterate_.distance.hasLooked(); }
  /// Begins again from the equalities where the steps have left them by more than rounding errors of the
  /// iterate, and by more than is left of the gradient, each relative to its size: the error of a direction
  /// grows with what was projected away, times the condition of the rows.
  /// @param distance from the equalities, see EqualityRows. @return whether it did.
  bool returnToRows(double distance);

  /// Keeps what the steps since the last beginning have found of outlying eigenvalues, for all faces to come:
  /// see KeptDirections. To be followed by start(). @return how many directions are new.
  int keepOutliers(int most);
  KeptDirections<Scalar, MV, OP>& kept() { return kept_; }

  /// ‖w‖.
  double residualNorm() const { return std::sqrt(iterate_.residual2); }
  /// What w says of curvatures.
  struct Slipping {
    /// ‖w‖ with tᵀw multiplied by q/(q + κ): their equations are 1 + κ/q times those of x = Π(x − g/q), whose
    /// Newton steps faces are.
    double residual;
    double overshoot; ///< by which pairs may be off along their tangents, in radii
  };
  /// @note Collective, with discs and springs.
  Slipping slipping() const;
  /// Level of the rounding errors of w.
  double attainable() const { return iterate_.level.value; }
  /// Whether x has lost so much since then that start() would bring the level down by the most of it: springs
  /// make large forces of what is to become nothing. @note Collective, with springs.
  bool isRefinable() const;
  int staleness() const { return iterate_.level.staleness; }
  /// About that of the solution, bᵀb/bᵀM⁻¹b; without a preconditioner that of the last beginning, xᵀAx/xᵀx.
  double stiffness() const;
  /// The largest curvature pᵀAp/pᵀp met so far: a lower bound of ‖A‖.
  double curvatureBound() const { return iterate_.level.curvatureBound; }

  /// ½xᵀAx − bᵀx, with springs. @note Needs a face.
  double cost();
  /// Ax − b + C̄ᵀμ̄: w at free entries, the multipliers of the bounds at held ones. Springs are a part of A
  /// and b. @note Needs a face.
  void lagrangianGradient(MV& y);
  /// The same with forces of blocks as they are where x is now.
  void trueGradient(MV& y);
  /// μ̄.
  void multiplier(MV& mu);
  /// Gives μ̄ to the problem.
  void storeMultiplier();
  /// The problem's present solution for the tests, with what is known of the equalities: see lookAtRows().
  /// @param gradientNorm ‖g^P‖ there.
  IterationState<MV> evaluate(double gradientNorm, int outer, int inner);
  /// After Outcome::Flat: A vanishes along p, and the cost falls along −p.
  const MV& direction() const { return conjugate_.direction(); }
  const MV& image() const { return conjugate_.image(); }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;

  Krylov<MV>& krylov() { return system_.isCoupled() ? static_cast<Krylov<MV>&>(residuals_) : conjugate_; }
  static bool isUnprojected(const Problem<Scalar, MV, OP>& problem);
  FaceIterate<Scalar, MV, OP> makeIterate();
  bool moveToRows();
  double findGradient();
  void settle();
  void pinMotions();

  const Problem<Scalar, MV, OP>& problem_;
  EqualityRows<Scalar, MV, OP>& rows_;
  Counters& counters_;
  FaceSystem<Scalar, MV, OP> system_;
  FaceIterate<Scalar, MV, OP> iterate_;
  KeptDirections<Scalar, MV, OP> kept_;
  ConjugateGradients<Scalar, MV, OP> conjugate_;
  ConjugateResiduals<Scalar, MV, OP> residuals_;
  Teuchos::RCP<MV> rowsOfLoad_; // C̄b, where gradients are those of F
  Teuchos::RCP<MV> unheld_;     // part of what is removed on which no force of the face acts; null: none
  double rayleigh_ = 0.0;       // of the last beginning
};

} // namespace Harmos::qp
