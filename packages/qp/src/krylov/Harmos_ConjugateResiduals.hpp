// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FaceIterate.hpp"
#include "Harmos_FaceSystem.hpp"
#include "Harmos_Krylov.hpp"
#include "Harmos_ResidualDirections.hpp"

namespace Harmos::qp {

/// Generalised conjugate residuals on a face whose matrix is not symmetric, since what is held at limits
/// follows what is free: the Newton step of the coupled problem (Alart, Curnier, Comput. Methods Appl. Mech.
/// Engrg. 92, 1991). Directions take the preconditioner and the projector of the face without what follows
/// for their own; equalities are a part of the residual.
///
/// Cost of a step: one product with A, one with the preconditioner, and some with the rows. Guarded by
/// tests/unit/qp/test_following_limits.cpp.
template<class Scalar, class MV, class OP>
class ConjugateResiduals : public Krylov<MV> {
 public:
  using Iterate = FaceIterate<Scalar, MV, OP>;
  using Outcome = typename Krylov<MV>::Outcome;

  ConjugateResiduals(const Problem<Scalar, MV, OP>& problem, EqualityRows<Scalar, MV, OP>& rows,
                     FaceSystem<Scalar, MV, OP>& system, Iterate& iterate, Counters& counters)
      : problem_(problem), rows_(rows), system_(system), iterate_(iterate), counters_(counters) {}

  void forget() override { directions_.clear(); }
  void begin() override {
    directions_.setRowWeight(iterate_.level.curvatureBound);
    sumResidual();
  }

  Outcome step() override;

  void exchange(StateArchive<MV>& archive) override {
    directions_.exchange(archive, *iterate_.w, iterate_.removed.get());
    if (rows_.isPresent())
      archive.rowVector("cg rows", *iterate_.rowResidual);
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;

  void sumResidual() {
    const MV* const rows = iterate_.rowResidual.get();
    iterate_.residual2 = directions_.product(*iterate_.w, rows, *iterate_.w, rows);
  }
  ResidualDirection<MV> direction();
  void advance(const ResidualDirection<MV>& d, double length);

  const Problem<Scalar, MV, OP>& problem_;
  EqualityRows<Scalar, MV, OP>& rows_;
  FaceSystem<Scalar, MV, OP>& system_;
  Iterate& iterate_;
  Counters& counters_;
  ResidualDirections<Scalar, MV> directions_;
};

// What the face would need without T, so that the equalities are met with it; and what that does.
template<class Scalar, class MV, class OP>
ResidualDirection<MV> ConjugateResiduals<Scalar, MV, OP>::direction() {
  ResidualDirection<MV> d;
  d.p = MVT::Clone(*iterate_.w, 1);
  const Teuchos::RCP<MV> rowWork = rows_.isPresent() ? rows_.makeVector() : Teuchos::null;
  system_.precondition(*iterate_.w, *d.p, rowWork.get());
  system_.letFollow(*d.p);
  if (rows_.isPresent()) {
    d.removed = rows_.makeVector();
    d.rows = rows_.makeVector();
    const Teuchos::RCP<MV> correction = MVT::Clone(*d.p, 1);
    rows_.apply(*d.p, *d.rows);
    MVT::MvAddMv(1.0, *iterate_.rowResidual, -1.0, *d.rows, *d.rows);
    system_.solveRowsThatFollow(*d.rows, *correction);
    MVT::MvAddMv(1.0, *d.p, 1.0, *correction, *d.p);
    rows_.apply(*d.p, *d.rows);
    MVT::MvInit(*d.removed, 0.0);
  }
  d.image = MVT::Clone(*d.p, 1);
  ++counters_.hessianApplications;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), *d.p, *d.image);
  iterate_.level.raiseCurvatureBound(norm<Scalar>(*d.image) / norm<Scalar>(*d.p));
  system_.addCurvatures(*d.p, false, *d.image);
  d.onFace = MVT::CloneCopy(*d.image);
  system_.mask(*d.onFace);
  if (rows_.isPresent()) {
    std::vector<double> none;
    system_.project(*d.onFace, *d.removed, none);
  }
  return d;
}

template<class Scalar, class MV, class OP>
typename Krylov<MV>::Outcome ConjugateResiduals<Scalar, MV, OP>::step() {
  // Images of rounding errors, or that take nothing from the residual.
  constexpr double nothing = 1e-12;
  if (directions_.rowWeight() == 0.0) // nothing was known of A
    directions_.setRowWeight(1.0);
  ResidualDirection<MV> d = direction();
  const double before = directions_.product(*d.onFace, d.rows.get(), *d.onFace, d.rows.get());
  directions_.orthogonalise(d);
  const double norm2 = directions_.product(*d.onFace, d.rows.get(), *d.onFace, d.rows.get());
  const double along = directions_.product(*iterate_.w, iterate_.rowResidual.get(), *d.onFace, d.rows.get());
  if (!std::isfinite(norm2) || !std::isfinite(along))
    return Outcome::Breakdown;
  if (!(norm2 > nothing * nothing * before) || along * along <= nothing * norm2 * iterate_.residual2)
    return Outcome::Flat;
  advance(d, along / norm2);
  directions_.add(d, norm2);
  sumResidual();
  iterate_.distance.look(*iterate_.x);
  ++counters_.cgSteps;
  ++iterate_.level.staleness;
  iterate_.level.raise(dot<Scalar>(*iterate_.x, *iterate_.x));
  return Outcome::Step;
}

template<class Scalar, class MV, class OP>
void ConjugateResiduals<Scalar, MV, OP>::advance(const ResidualDirection<MV>& d, double length) {
  MVT::MvAddMv(1.0, *iterate_.x, -length, *d.p, *iterate_.x);
  MVT::MvAddMv(1.0, *iterate_.gradient, -length, *d.image, *iterate_.gradient);
  MVT::MvAddMv(1.0, *iterate_.w, -length, *d.onFace, *iterate_.w);
  if (rows_.isPresent()) {
    MVT::MvAddMv(1.0, *iterate_.rowResidual, -length, *d.rows, *iterate_.rowResidual);
    MVT::MvAddMv(1.0, *iterate_.removed, -length, *d.removed, *iterate_.removed);
  }
}

} // namespace Harmos::qp
