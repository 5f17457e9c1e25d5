// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BlockOps.hpp"
#include "Harmos_EqualityRows.hpp"
#include "Harmos_FaceOps.hpp"
#include "Harmos_InFacePreconditioner.hpp"
#include "Harmos_SolverMonitor.hpp"

#include <Teuchos_RCP.hpp>

#include <vector>

namespace Harmos::qp {

/// The linear problem on a face: min ½xᵀAx − bᵀx + ½κ|x − c|² on { x : C̄x = c̄, x on the face }, as what
/// applies, projects and preconditions; it has no iterate.
///
/// P_F = I − C_Fᵀ(C_FC_Fᵀ)⁻C_F is the projector onto ker C_F, C_F = C̄ with the columns of held entries set to
/// zero; C_FC_Fᵀ = I where nothing is held, else it is dense and factored for each face.
///
/// Curvatures κ, of tangents and springs, are a part of the matrix. However stiff they are, they cost few
/// steps: preconditioner and projector know them by their share T = q/(q + κ), q for the diagonal of A.
///
/// Where limits follow the solution (ActiveFace::couplings), what is held at one goes along with what it
/// follows: x = x_0 + Tv, T = I + Σ f e_i e_kᵀ, and the equations, tested on what is free alone, are not
/// symmetric.
///
/// Guarded by tests/unit/qp/test_projected_cg.cpp; messages by tests/unit/feti/test_communication.cpp.
template<class Scalar, class MV, class OP>
class FaceSystem {
 public:
  FaceSystem(const Problem<Scalar, MV, OP>& problem, EqualityRows<Scalar, MV, OP>& rows, Counters& counters);

  /// x ← onto the face, equalities aside. @note Collective.
  void setFace(const ActiveFace& face, MV& x);
  /// The face of a state that x belongs to.
  void resume(const ActiveFace& face);
  /// Springs of the next setFace() that are none of these let x go; see Kernels::moveToSprings(). Those of
  /// the last one, unless told.
  void knowSprings(const ActiveFace& face) { face_.springs = face.springs; }
  const ActiveFace& face() const { return face_; }

  // On any rank.
  bool isCoupled() const { return isCoupled_; }
  bool hasSprings() const { return hasSprings_; }
  /// Whether preconditioner and projector know curvatures.
  bool isSoftened() const { return isSoftened_; }
  /// q, about that of the solution: bᵀb/bᵀM⁻¹b; 0: not asked for yet, or not known.
  double stiffness() const { return stiffness_; }
  void exchangeStiffness(StateArchive<MV>& archive) { archive.number("face stiffness", stiffness_); }

  /// v ← its part along the face.
  void mask(MV& v) const {
    if (!problem_.blocks().empty())
      FaceOps<Scalar, MV>::mask(v, face_);
  }
  /// y ← y + κx; with fromCentre κ(x − c). Local.
  void addCurvatures(const MV& x, bool fromCentre, MV& y) const;
  /// κx of springs.
  Teuchos::RCP<MV> springForces(const MV& x) const;

  /// v ← P_F v, for v that is zero at held entries; `removed` ← what C̄ᵀ took away. `sums` of the ranks are
  /// added up on the way. @note Collective.
  void project(MV& v, MV& removed, std::vector<double>& sums) const;

  bool hasPreconditioner() const { return preconditioner_.isPresent(); }
  /// z = P_F M⁻¹ w, M with curvatures. @param rowWork a vector of the rows. @note Collective.
  void precondition(const MV& w, MV& z, MV* rowWork);
  /// z = M⁻¹ w, to be projected. Needs a preconditioner, and no curvatures.
  void preconditionAlone(const MV& w, MV& z) { preconditioner_.apply(w, face_, z); }

  // Of the rows.

  const FaceGram<MV>* gram() const { return faceGram_.get(); }
  /// Factors C_FC_Fᵀ. @note Collective.
  void factorRows();
  /// x ← C̄_Fᵀ(C̄_FC̄_Fᵀ)⁻r; from pairs that slip, and springs, by their share. @note Collective.
  void solveRows(const MV& residual, MV& x) const;
  /// x = TC̄_Fᵀη with C̄x = r, where there is one: the matrix of rows is not symmetric, and (C̄_FC̄_Fᵀ)⁻, which
  /// knows nothing of T, makes the directions. @note Collective.
  void solveRowsThatFollow(const MV& residual, MV& x) const;
  /// x ← Tx. Local.
  void letFollow(MV& x) const;
  /// Whether forces of the face act on all motions, or on some not at all, or on some hardly: the least
  /// eigenvalue of C̄_FC̄_Fᵀ, about, as the share of all forces of equalities and bounds that are there.
  /// @note Collective.
  double hold() const;
  /// The part of rows' multipliers on which no force of the face acts. @note Collective.
  void keepMotions(MV& multiplier) const;

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Faces = FaceOps<Scalar, MV>;

  bool isAnywhere(bool isHere) const {
    return BoundTraits<Scalar, MV>::maximum(*problem_.solution(), isHere ? 1.0 : 0.0) > 0.0;
  }
  void findCurvatures();
  void findStiffness();
  void couple();
  void soften(MV& v) const;
  void preconditionSoftened(const MV& w, MV& z, MV* rowWork);

  const Problem<Scalar, MV, OP>& problem_;
  EqualityRows<Scalar, MV, OP>& rows_;
  Counters& counters_;
  InFacePreconditioner<Scalar, MV, OP> preconditioner_;
  ActiveFace face_;
  // C̄C̄ᵀ on the face, and C̄TC̄ᵀ where there are curvatures.
  Teuchos::RCP<const FaceGram<MV>> faceGram_, softGram_;
  double stiffness_ = 0.0;
  bool isCoupled_ = false, hasSprings_ = false, isSoftened_ = false;
};

} // namespace Harmos::qp
