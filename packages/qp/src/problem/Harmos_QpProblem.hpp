// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTypes.hpp"
#include "Harmos_FaceGram.hpp"
#include "Harmos_FacePreconditioner.hpp"
#include "Harmos_FollowingLimits.hpp"
#include "Harmos_NonsmoothBlock.hpp"
#include "Harmos_SoftBounds.hpp"

#include <Teuchos_RCP.hpp>

#include <memory>
#include <string>

namespace Harmos::qp {

/// What is known of the equality rows; what is not known is not assumed.
enum class EqualityStructure {
  General,
  /// CCᵀ = I, on the range of C at least: of rows that are given as C = GᵀG, with GGᵀ = I, in place of G. All
  /// vectors of the rows are to be in that range then.
  Orthonormal,
  /// The same, and ACᵀ = 0: images of CᵀC and of I − CᵀC are invariant subspaces of A + ρCᵀC, as in FETI with
  /// the natural coarse space, where A = PFP and C = G (Dostál, Horák, Vlach, eq. 3.6).
  OrthonormalInvariant
};

/// The quadratic program
///
///     min ½ xᵀAx − bᵀx   subject to   l ≤ x ≤ u,  |(x_i, x_j) − m| ≤ r,  Cx = c,
///
/// A symmetric positive semidefinite, (i, j) pairs of entries without bounds; entries may have soft bounds
/// instead, which add ½κ dist(x_i, [l_i, u_i])² to the cost, or nonsmooth terms of any kind (NonsmoothBlock;
/// all of these are such). Mirrors Belos::LinearProblem: every setter takes the "set" mark away, setProblem()
/// checks and gives it, and no solver accepts a problem without it.
///
/// Operators are applied through Belos::OperatorTraits, C also transposed. The multiplier vector lives in the
/// range of C, which may be a locally replicated map. Nothing is copied: the solution vector is the initial
/// guess before and the answer after solve(), and so is the multiplier.
///
/// Guarded by tests/unit/qp/test_solvers.cpp.
template<class Scalar, class MV, class OP>
class Problem {
 public:
  Problem() = default;
  Problem(Teuchos::RCP<const OP> hessian, Teuchos::RCP<MV> solution, Teuchos::RCP<const MV> rhs);

  void setHessian(Teuchos::RCP<const OP> hessian);
  void setRhs(Teuchos::RCP<const MV> rhs);
  void setSolution(Teuchos::RCP<MV> solution);
  /// Null: no lower bound.
  void setLowerBound(Teuchos::RCP<const MV> lower);
  /// Null: no upper bound.
  void setUpperBound(Teuchos::RCP<const MV> upper);
  /// Pairs of entries that stay in discs. Null on all ranks: none; else given on all, if empty.
  void setDiscs(std::shared_ptr<const LocalDiscs> discs);
  /// Limits that follow the solution: intervals and discs among those that were set, whose radii are of no
  /// account, and whose sources have lower bounds. Null on all ranks: none; else given on all, if empty. The
  /// problem works with copies of bounds and discs then.
  void setFollowingLimits(std::shared_ptr<const FollowingLimits> limits);
  /// Entries, without bounds of other kinds, that may leave their intervals against a curvature. Null on all
  /// ranks: none; else given on all, if empty. Not all solvers take them: SolverManager::takesAllBlocks().
  void setSoftBounds(std::shared_ptr<const LocalSoftBounds> bounds);
  /// Nonsmooth terms of another kind, on entries that nothing else is about. On all ranks, if empty; they
  /// stay for good. Not all solvers take them, as with soft bounds.
  void addBlock(std::shared_ptr<NonsmoothBlock> block);
  /// @param multiplier μ in the range of C: initial value before, answer after solve().
  void setEquality(Teuchos::RCP<const OP> rows, Teuchos::RCP<const MV> values, Teuchos::RCP<MV> multiplier,
                   EqualityStructure structure = EqualityStructure::General);
  /// A quick way to C_FC_Fᵀ on faces, for orthonormal rows. Null: the general way.
  void setFaceGram(Teuchos::RCP<const FaceGramMaker<MV>> maker) { known_.faceGram = std::move(maker); }
  /// An estimate of ‖A‖ from above that is already known; 0 (the default) lets a solver estimate it.
  void setHessianNorm(double norm);
  /// An operator that equals A on the kernel of the rows and is cheaper, such as PF where A = PFP. Null:
  /// none.
  void setHessianOnKernel(Teuchos::RCP<const OP> hessian) { known_.hessianOnKernel = std::move(hessian); }
  /// F, where A = PFP, P = I − CᵀC, of rows that are OrthonormalInvariant: for solvers that
  /// have projected vectors, and project images together with what they do on a face. Null: none.
  void setUnprojectedHessian(Teuchos::RCP<const OP> hessian);
  /// An approximation of A⁻¹, symmetric positive definite, built once: on a face, its restriction to the free
  /// entries is used (the approximate preconditioning in face of Kružík & Horák). Null: none.
  void setPreconditioner(Teuchos::RCP<const OP> preconditioner);
  /// Makes a preconditioner for each face: exact preconditioning in face. It has precedence. Null: none.
  void setFacePreconditioner(Teuchos::RCP<FacePreconditioner<MV, OP>> maker);
  /// Columns that span a part of ker A or all of it. A load on it along which the cost falls without end is
  /// then found before the first iteration. Verified: ‖AR‖ must vanish. Null: nothing is known.
  void setNullSpace(Teuchos::RCP<const MV> kernel);
  void setLabel(const std::string& label) { label_ = label; }

  /// Checks the problem: Hessian, solution and right-hand side are there, one column each, of equal length,
  /// and the bounds are numbers. Bounds with l > u are a problem without a solution, which solve() tells.
  /// @return whether it is ready to be solved; whyNotSet() tells the reason if not.
  /// @note Collective.
  bool setProblem();
  bool isProblemSet() const { return set_; }
  const std::string& whyNotSet() const { return fault_; }

  Teuchos::RCP<const OP> hessian() const { return hessian_; }
  Teuchos::RCP<const OP> hessianOnKernel() const { return known_.hessianOnKernel; }
  Teuchos::RCP<const OP> unprojectedHessian() const { return known_.unprojectedHessian; }
  Teuchos::RCP<const MV> rhs() const { return rhs_; }
  Teuchos::RCP<MV> solution() const { return solution_; }
  Teuchos::RCP<const MV> lowerBound() const { return terms_.lower; }
  Teuchos::RCP<const MV> upperBound() const { return terms_.upper; }
  Teuchos::RCP<const OP> equalityRows() const { return equalities_.rows; }
  Teuchos::RCP<const MV> equalityValues() const { return equalities_.values; }
  Teuchos::RCP<MV> multiplier() const { return equalities_.multiplier; }
  Teuchos::RCP<const OP> preconditioner() const { return known_.preconditioner; }
  Teuchos::RCP<FacePreconditioner<MV, OP>> facePreconditioner() const { return known_.facePreconditioner; }
  Teuchos::RCP<const FaceGramMaker<MV>> faceGram() const { return known_.faceGram; }
  Teuchos::RCP<const MV> nullSpace() const { return known_.nullSpace; }
  bool hasPreconditioner() const { return !preconditioner().is_null() || !facePreconditioner().is_null(); }
  EqualityStructure equalityStructure() const { return equalities_.structure; }
  double hessianNorm() const { return known_.hessianNorm; }
  const std::string& label() const { return label_; }
  bool hasEqualities() const { return !equalities_.rows.is_null(); }

  /// All nonsmooth terms, of a problem that is set; intervals and discs come first.
  const Blocks& blocks() const { return blocks_; }
  /// What all of them are: sets, as gradient projection needs them; of piecewise linear proxes, so that faces
  /// do not turn; terms of a cost, which the solution minimises.
  NonsmoothBlock::Kind kind() const;

  /// Intervals and discs. To be used while this lives and is not changed.
  FeasibleSet<MV> feasibleSet() const { return {terms_.lower.get(), terms_.upper.get(), terms_.discs.get()}; }
  bool hasDiscs() const { return terms_.discs != nullptr; }
  bool hasFollowingLimits() const { return terms_.following != nullptr; }
  /// Local.
  const FollowingLimits& followingLimits() const { return *terms_.following; }
  /// The problem with limits as they are, and as they will be when this one lets them follow; to be solved
  /// while this lives.
  Teuchos::RCP<Problem> frozen() const;
  /// Limits go to where the present solution has them. Local.
  void follow();
  /// x goes to the limits that it follows: held entries, and pairs that slip along their radii. Local.
  void moveToLimits(const ActiveFace& face);
  /// What limits depend on, a number an entry: the radii, each at the first entry it is of. Local.
  void limits(MV& radii) const;
  void setLimits(const MV& radii);

 private:
  // What is added to the cost, as it was given.
  struct Terms {
    Teuchos::RCP<const MV> lower, upper;
    std::shared_ptr<const LocalDiscs> discs;
    std::shared_ptr<const LocalSoftBounds> soft;
    std::shared_ptr<const FollowingLimits> following;
    Blocks others;
  };
  struct Equalities {
    Teuchos::RCP<const OP> rows;
    Teuchos::RCP<const MV> values;
    Teuchos::RCP<MV> multiplier;
    EqualityStructure structure = EqualityStructure::General;
  };
  // What need not be told, and helps.
  struct Knowledge {
    Teuchos::RCP<const OP> hessianOnKernel, unprojectedHessian, preconditioner;
    Teuchos::RCP<FacePreconditioner<MV, OP>> facePreconditioner;
    Teuchos::RCP<const FaceGramMaker<MV>> faceGram;
    Teuchos::RCP<const MV> nullSpace;
    double hessianNorm = 0.0;
  };
  // Where limits follow: what the bounds point to.
  struct OwnLimits {
    Teuchos::RCP<MV> lower, upper;
    std::shared_ptr<LocalDiscs> discs;
  };

  bool refuse(const std::string& fault);
  std::string faultOfVectors() const;
  std::string faultOfTerms() const;
  std::string faultOfLimits() const;
  std::string faultOfEqualities() const;
  bool isOnAnyRank(bool is) const;
  bool areFollowable() const;
  bool areDisjoint() const;
  void ownLimits();
  void makeBlocks();

  Teuchos::RCP<const OP> hessian_;
  Teuchos::RCP<const MV> rhs_;
  Teuchos::RCP<MV> solution_;
  Terms terms_;
  Equalities equalities_;
  Knowledge known_;
  OwnLimits own_;
  Blocks blocks_;
  bool set_ = false;
  std::string fault_ = "setProblem() was not called after the last change";
  std::string label_;
};

} // namespace Harmos::qp
