// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_ConjugateDirections.hpp"
#include "Harmos_CurvatureTerms.hpp"
#include "Harmos_FaceIterate.hpp"
#include "Harmos_FaceSystem.hpp"
#include "Harmos_KeptDirections.hpp"
#include "Harmos_Krylov.hpp"

#include <functional>
#include <vector>

namespace Harmos::qp {

/// Preconditioned conjugate gradients with w = P_F(Ax − b) on a face whose matrix is symmetric.
///
/// Cost of a step: one product with A, one with the preconditioner, and a projection after each of them, with
/// which scalars travel where the rows know how (FaceGram::solveFor()): what they are products with lies in
/// the kernel already. So there are two reductions a step; without a preconditioner w is projected in the
/// place of z. With one, rounding errors of w out of the kernel add up, which are of what was projected away
/// in each step, and are taken out in each tenth; left in, they end in a breakdown (of such errors: Gould,
/// Hribar, Nocedal, SIAM J. Sci. Comput. 23, 2001). What full conjugation adds see ConjugateDirections.
///
/// Where A = PFP is given by F (Problem::setUnprojectedHessian()), P and P_F are one projection: P_FP = P_F.
///
/// Guarded by tests/unit/qp/test_solvers.cpp, test_projected_cg.cpp; messages by
/// tests/unit/feti/test_communication.cpp.
template<class Scalar, class MV, class OP>
class ConjugateGradients : public Krylov<MV> {
 public:
  using Iterate = FaceIterate<Scalar, MV, OP>;
  using Outcome = typename Krylov<MV>::Outcome;

  /// @param isUnprojected images are those of F.
  ConjugateGradients(const Problem<Scalar, MV, OP>& problem, EqualityRows<Scalar, MV, OP>& rows,
                     FaceSystem<Scalar, MV, OP>& system, Iterate& iterate,
                     KeptDirections<Scalar, MV, OP>& kept, const CgOptions& options, bool isUnprojected,
                     Counters& counters);

  void forget() override { directions_.clear(); }
  void begin() override;
  Outcome step() override;
  void exchange(StateArchive<MV>& archive) override;

  const ConjugateDirections<Scalar, MV>& directions() const { return directions_; }
  /// After Outcome::Flat: A vanishes along p, and the cost falls along −p.
  const MV& direction() const { return *p_; }
  const MV& image() const { return *onFace_; }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;

  // wᵀp, pᵀp, pᵀAp, and that of A without curvatures; global.
  struct DirectionSums {
    double dotGradient, norm2, dotImage, dotHessian;
  };
  static constexpr int lookInterval = 10; // steps

  DirectionSums applyToDirection();
  bool isFlatAlongDirection(double curvature);
  void advance(double length);
  void watchRows();
  void precondition();
  ResidualSums preconditionAndSum();

  const Problem<Scalar, MV, OP>& problem_;
  EqualityRows<Scalar, MV, OP>& rows_;
  FaceSystem<Scalar, MV, OP>& system_;
  Iterate& iterate_;
  KeptDirections<Scalar, MV, OP>& kept_;
  Counters& counters_;
  ConjugateDirections<Scalar, MV> directions_;
  Teuchos::RCP<MV> p_, z_, image_;
  Teuchos::RCP<MV> onFace_; // P_F of the image, which it is itself where there is no face
  Teuchos::RCP<MV> rowWork_;
  double directionDotImage_ = 0.0;
  bool isUnprojected_;
};

template<class Scalar, class MV, class OP>
ConjugateGradients<Scalar, MV, OP>::ConjugateGradients(const Problem<Scalar, MV, OP>& problem,
                                                       EqualityRows<Scalar, MV, OP>& rows,
                                                       FaceSystem<Scalar, MV, OP>& system, Iterate& iterate,
                                                       KeptDirections<Scalar, MV, OP>& kept,
                                                       const CgOptions& options, bool isUnprojected,
                                                       Counters& counters)
    : problem_(problem),
      rows_(rows),
      system_(system),
      iterate_(iterate),
      kept_(kept),
      counters_(counters),
      directions_(options),
      p_(MVT::Clone(*iterate.w, 1)),
      z_(system.hasPreconditioner() || !problem.kind().isSet ? MVT::Clone(*iterate.w, 1) : iterate.w),
      image_(MVT::Clone(*iterate.w, 1)),
      onFace_(!problem.blocks().empty() ? MVT::Clone(*iterate.w, 1) : image_),
      rowWork_(rows.isPresent() ? rows.makeVector() : Teuchos::null),
      isUnprojected_(isUnprojected) {}

template<class Scalar, class MV, class OP>
void ConjugateGradients<Scalar, MV, OP>::begin() {
  precondition();
  MVT::Assign(*z_, *p_);
}

template<class Scalar, class MV, class OP>
void ConjugateGradients<Scalar, MV, OP>::exchange(StateArchive<MV>& archive) {
  archive.vector("cg direction", *p_);
  directions_.exchange(archive, *p_);
}

// z = P_F M⁻¹ w, conjugate to what is kept; without a preconditioner z is w.
template<class Scalar, class MV, class OP>
void ConjugateGradients<Scalar, MV, OP>::precondition() {
  system_.precondition(*iterate_.w, *z_, rowWork_.get());
  if (system_.hasPreconditioner() || system_.isSoftened())
    kept_.conjugate(*z_);
}

// z, and what a step ends with. w and the image lie in the kernel of the rows, so that products with them
// need not wait for the projection of z.
template<class Scalar, class MV, class OP>
ResidualSums ConjugateGradients<Scalar, MV, OP>::preconditionAndSum() {
  const MV& x = *iterate_.x;
  MV& w = *iterate_.w;
  if (system_.isSoftened() || kept_.size() > 0) {
    precondition();
    return Bounds::residualSums(w, *z_, *onFace_, x);
  }
  const bool isPreconditioned = system_.hasPreconditioner();
  if (isPreconditioned)
    system_.preconditionAlone(w, *z_);
  else if (z_ != iterate_.w)
    MVT::Assign(w, *z_);
  const ResidualSums local = Bounds::localResidualSums(w, *z_, *onFace_, x);
  std::vector<double> sums = {local.residualNorm2, local.preconditionedDotImage, local.iterateNorm2};
  if (rows_.isPresent())
    system_.project(*z_, *rowWork_, sums);
  else
    BoundTraits<Scalar, MV>::sum(*z_, sums.data(), static_cast<int>(sums.size()));
  if (!isPreconditioned && rows_.isPresent()) { // w itself
    MVT::MvAddMv(1.0, *iterate_.removed, 1.0, *rowWork_, *iterate_.removed);
    if (z_ != iterate_.w)
      MVT::Assign(*z_, w);
  }
  return {sums[0], sums[1], sums[2]};
}

template<class Scalar, class MV, class OP>
typename Krylov<MV>::Outcome ConjugateGradients<Scalar, MV, OP>::step() {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  RoundingLevel& level = iterate_.level;
  const DirectionSums sums = applyToDirection();
  const double curvature = sums.dotImage / sums.norm2;
  if (!std::isfinite(curvature) || !std::isfinite(sums.dotGradient))
    return Outcome::Breakdown;
  level.raiseCurvatureBound(sums.dotHessian / sums.norm2);
  if (curvature < -100.0 * epsilon * level.curvatureBound)
    return Outcome::Breakdown;
  if (curvature <= 100.0 * epsilon * level.curvatureBound && isFlatAlongDirection(curvature))
    return Outcome::Flat;
  directionDotImage_ = sums.dotImage;
  advance(sums.dotGradient / directionDotImage_);
  const ResidualSums after = preconditionAndSum();
  iterate_.residual2 = after.residualNorm2;
  level.raise(after.iterateNorm2);
  // Exactly conjugate to the last direction also with a preconditioner that is not quite symmetric.
  const double beta = after.preconditionedDotImage / directionDotImage_;
  MVT::MvAddMv(1.0, *z_, -beta, *p_, *p_);
  directions_.conjugate(*p_);
  return Outcome::Step;
}

template<class Scalar, class MV, class OP>
void ConjugateGradients<Scalar, MV, OP>::advance(double length) {
  const bool hasFace = !problem_.blocks().empty();
  MVT::MvAddMv(1.0, *iterate_.x, -length, *p_, *iterate_.x);
  directions_.add(*p_, *onFace_, directionDotImage_, length);
  MVT::MvAddMv(1.0, *iterate_.w, -length, *onFace_, *iterate_.w);
  if (hasFace) {
    MVT::MvAddMv(1.0, *iterate_.gradient, -length, *image_, *iterate_.gradient);
    iterate_.isSettled = !isUnprojected_;
  }
  // Without a face what F has in the range of C̄ᵀ is none of A's.
  if (rows_.isPresent() && (hasFace || !isUnprojected_))
    MVT::MvAddMv(1.0, *iterate_.removed, -length, *rowWork_, *iterate_.removed);
  ++counters_.cgSteps;
  ++iterate_.level.staleness;
  iterate_.distance.invalidate();
  watchRows();
}

// Whether a curvature along p is no more than what rounding leaves of the terms that it is a sum of.
template<class Scalar, class MV, class OP>
bool ConjugateGradients<Scalar, MV, OP>::isFlatAlongDirection(double curvature) {
  const std::function<void(const MV&, MV&)> apply = [this](const MV& in, MV& out) {
    ++counters_.hessianApplications;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), in, out);
  };
  return curvature <= 100.0 * std::numeric_limits<double>::epsilon() * curvatureTerms<Scalar, MV>(apply, *p_);
}

// In each tenth step the distance from the equalities is looked at, and what rounding errors have brought to
// w out of the kernel is taken out. Without a preconditioner that is done where z is made.
template<class Scalar, class MV, class OP>
void ConjugateGradients<Scalar, MV, OP>::watchRows() {
  if (!rows_.isPresent() || iterate_.level.staleness % lookInterval != 0)
    return;
  if (system_.hasPreconditioner() || system_.isSoftened()) {
    std::vector<double> none;
    system_.project(*iterate_.w, *rowWork_, none);
    MVT::MvAddMv(1.0, *iterate_.removed, 1.0, *rowWork_, *iterate_.removed);
  }
  iterate_.distance.look(*iterate_.x);
}

// image_ ← Ap, or Fp, and onFace_ ← P_F of it; rowWork_ ← what was taken away there. p lies in the kernel of
// the rows, so that products with it need not wait for the projection.
template<class Scalar, class MV, class OP>
typename ConjugateGradients<Scalar, MV, OP>::DirectionSums
ConjugateGradients<Scalar, MV, OP>::applyToDirection() {
  ++counters_.hessianApplications;
  Teuchos::RCP<const OP> a = isUnprojected_ ? problem_.unprojectedHessian() : problem_.hessianOnKernel();
  if (a.is_null())
    a = problem_.hessian();
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*a, *p_, *image_);
  const bool mayCurve = !problem_.kind().isPiecewiseLinear || !problem_.kind().isSet;
  std::vector<double> sums;
  if (mayCurve)
    sums.push_back(Bounds::localCurvature(*p_, *p_, *image_, {}).directionDotImage);
  system_.addCurvatures(*p_, false, *image_);
  if (!problem_.blocks().empty()) {
    MVT::Assign(*image_, *onFace_);
    system_.mask(*onFace_);
  }
  const CurvatureSums local = Bounds::localCurvature(*iterate_.w, *p_, *onFace_, system_.face());
  sums.insert(sums.end(), {local.gradientDotDirection, local.directionNorm2, local.directionDotImage});
  if (rows_.isPresent())
    system_.project(*onFace_, *rowWork_, sums);
  else
    BoundTraits<Scalar, MV>::sum(*onFace_, sums.data(), static_cast<int>(sums.size()));
  const std::size_t first = mayCurve ? 1 : 0;
  return {sums[first], sums[first + 1], sums[first + 2], sums[mayCurve ? 0 : 2]};
}

} // namespace Harmos::qp
