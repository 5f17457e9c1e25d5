// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FaceArchive.hpp"
#include "Harmos_FaceSolver.hpp"
#include "Harmos_FaceSystem_def.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
FaceSolver<Scalar, MV, OP>::FaceSolver(const Problem<Scalar, MV, OP>& problem,
                                       EqualityRows<Scalar, MV, OP>& rows, const CgOptions& options,
                                       Counters& counters)
    : problem_(problem),
      rows_(rows),
      counters_(counters),
      system_(problem, rows, counters),
      iterate_(makeIterate()),
      kept_(problem, rows),
      conjugate_(problem, rows, system_, iterate_, kept_, options, rows.isPresent() && isUnprojected(problem),
                 counters),
      residuals_(problem, rows, system_, iterate_, counters) {
  if (!rows_.isPresent() || !isUnprojected(problem) || problem.blocks().empty())
    return;
  rowsOfLoad_ = rows_.makeVector();
  rows_.apply(*problem.rhs(), *rowsOfLoad_);
}

// Curvatures would not be projected with F.
template<class Scalar, class MV, class OP>
bool FaceSolver<Scalar, MV, OP>::isUnprojected(const Problem<Scalar, MV, OP>& problem) {
  return !problem.unprojectedHessian().is_null() && problem.kind().isPiecewiseLinear &&
         problem.kind().isSet && problem.kind().isCost;
}

template<class Scalar, class MV, class OP>
FaceIterate<Scalar, MV, OP> FaceSolver<Scalar, MV, OP>::makeIterate() {
  const auto row = [this] { return rows_.isPresent() ? rows_.makeVector() : Teuchos::null; };
  const Teuchos::RCP<MV> x = problem_.solution();
  FaceIterate<Scalar, MV, OP> iterate{x,
                                      MVT::Clone(*x, 1),
                                      !problem_.blocks().empty() ? MVT::Clone(*x, 1) : Teuchos::null,
                                      row(),
                                      Teuchos::null,
                                      0.0,
                                      true,
                                      {},
                                      RowDistance<Scalar, MV, OP>(rows_)};
  if (!problem_.kind().isCost)
    iterate.rowResidual = row();
  iterate.level.curvatureBound = problem_.hessianNorm();
  iterate.level.rhsNorm = norm<Scalar>(*problem_.rhs());
  return iterate;
}

template<class Scalar, class MV, class OP>
bool FaceSolver<Scalar, MV, OP>::start(const ActiveFace& face, double leastHold) {
  system_.setFace(face, *iterate_.x);
  unheld_ = Teuchos::null;
  if (rows_.isPresent()) {
    system_.factorRows();
    const bool turns = !problem_.kind().isCost || !problem_.kind().isPiecewiseLinear;
    const double held = turns ? system_.hold() : 1.0;
    if (system_.isCoupled() && held < leastHold)
      return false;
    if (!moveToRows())
      return false;
    if (held == 0.0) {
      unheld_ = MVT::CloneCopy(*iterate_.removed);
      system_.keepMotions(*unheld_);
    }
  }
  restart();
  return true;
}

// Motions on which no force of the face acts have no multiplier; theirs is that of before: gradients at what
// slips tell slips with them.
template<class Scalar, class MV, class OP>
void FaceSolver<Scalar, MV, OP>::pinMotions() {
  if (unheld_.is_null())
    return;
  const Teuchos::RCP<MV> now = MVT::CloneCopy(*iterate_.removed);
  system_.keepMotions(*now);
  MVT::MvAddMv(1.0, *iterate_.removed, 1.0, *unheld_, *iterate_.removed);
  MVT::MvAddMv(1.0, *iterate_.removed, -1.0, *now, *iterate_.removed);
}

// x_F ← x_F − C_Fᵀ(C_FC_Fᵀ)⁻(C̄x − c̄), a second time for what rounding left.
template<class Scalar, class MV, class OP>
bool FaceSolver<Scalar, MV, OP>::moveToRows() {
  MV& x = *iterate_.x;
  const Teuchos::RCP<MV> correction = MVT::Clone(x, 1), residual = rows_.makeVector();
  double scale = norm<Scalar>(x) + rows_.valuesNorm(); // a guess may be nothing but what goes
  for (int pass = 0; pass < 2; ++pass) {
    rows_.residual(x, *residual);
    if (system_.isCoupled())
      system_.solveRowsThatFollow(*residual, *correction);
    else
      system_.solveRows(*residual, *correction);
    MVT::MvAddMv(1.0, x, -1.0, *correction, x);
  }
  rows_.residual(x, *residual);
  iterate_.distance.keep();
  if (system_.isCoupled()) {
    MVT::Assign(*residual, *iterate_.rowResidual);
    return true;
  }
  // A face that misses the equalities does so by more than rounding errors.
  scale = std::max(scale, norm<Scalar>(x));
  return norm<Scalar>(*residual) <= std::sqrt(std::numeric_limits<double>::epsilon()) * scale;
}

// w ← Ax − b. @return ‖Ax‖/‖x‖, where it is asked for.
template<class Scalar, class MV, class OP>
double FaceSolver<Scalar, MV, OP>::findGradient() {
  const MV &x = *iterate_.x, &b = *problem_.rhs();
  MV& w = *iterate_.w;
  const double length = norm<Scalar>(x);
  if (!(length > 0.0)) {
    MVT::MvAddMv(-1.0, b, 0.0, b, w);
    return 0.0;
  }
  ++counters_.hessianApplications;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), x, w);
  const double stretch = system_.isCoupled() ? norm<Scalar>(w) / length : 0.0;
  const bool turns = !problem_.kind().isCost || !problem_.kind().isPiecewiseLinear;
  if (!system_.hasPreconditioner() && turns)
    rayleigh_ = dot<Scalar>(x, w) / dot<Scalar>(x, x);
  MVT::MvAddMv(1.0, w, -1.0, b, w);
  return stretch;
}

template<class Scalar, class MV, class OP>
void FaceSolver<Scalar, MV, OP>::restart() {
  MV &x = *iterate_.x, &w = *iterate_.w;
  const double stretch = findGradient();
  if (!system_.isCoupled()) {
    kept_.minimise(x, w);
    if (kept_.size() > 0) // they are in the kernel to fewer digits
      lookAtRows();
  }
  if (!problem_.blocks().empty()) {
    system_.addCurvatures(x, true, w);
    if (system_.hasSprings()) // how large what cancels there is
      iterate_.level.springNorm = norm<Scalar>(*system_.springForces(x));
    MVT::Assign(w, *iterate_.gradient);
    iterate_.isSettled = true;
    system_.mask(w);
  }
  if (rows_.isPresent()) {
    const Teuchos::RCP<MV> part = rows_.makeVector();
    std::vector<double> none;
    MVT::MvInit(*iterate_.removed, 0.0);
    for (int pass = 0; pass < 2; ++pass) { // the first leaves rounding errors of the size of what it removes
      system_.project(w, *part, none);
      MVT::MvAddMv(1.0, *iterate_.removed, 1.0, *part, *iterate_.removed);
    }
  }
  iterate_.residual2 = dot<Scalar>(w, w);
  iterate_.level.raiseCurvatureBound(stretch);
  iterate_.level.staleness = 0;
  iterate_.level.value = 0.0;
  iterate_.level.raise(dot<Scalar>(x, x));
  conjugate_.forget();
  residuals_.forget();
  krylov().begin();
}

template<class Scalar, class MV, class OP>
void FaceSolver<Scalar, MV, OP>::exchange(StateArchive<MV>& archive) {
  archive.vector("x", *iterate_.x);
  archive.vector("cg gradient on the face", *iterate_.w);
  if (rows_.isPresent())
    archive.rowVector("cg projected away", *iterate_.removed);
  archive.number("cg residual", iterate_.residual2);
  archive.number("cg quotient", rayleigh_);
  bool hasUnheld = !unheld_.is_null();
  archive.number("cg has motions that nothing holds", hasUnheld);
  if (hasUnheld) {
    if (unheld_.is_null())
      unheld_ = rows_.makeVector();
    archive.rowVector("cg motions that nothing holds", *unheld_);
  }
  iterate_.distance.exchange(archive);
  iterate_.level.exchange(archive);
  system_.exchangeStiffness(archive);
  kept_.exchange(archive, *iterate_.w);
  if (!problem_.blocks().empty()) {
    archive.vector("cg gradient", *iterate_.gradient);
    ActiveFace face = system_.face();
    FaceArchive<Scalar, MV>(archive, "cg", *iterate_.w).exchange(face);
    if (archive.isReading()) {
      iterate_.isSettled = rowsOfLoad_.is_null();
      system_.resume(face);
      // Bounds that another number of ranks has rounded differently; limits that follow are where they were
      // when the face was left.
      if (problem_.kind().isCost)
        BlockOps<Scalar, MV>::moveToFace(problem_.blocks(), face, *iterate_.x);
      if (rows_.isPresent())
        system_.factorRows();
    }
  }
  krylov().exchange(archive);
}

template<class Scalar, class MV, class OP>
bool FaceSolver<Scalar, MV, OP>::returnToRows(double distance) {
  constexpr double rounding = 1e4 * std::numeric_limits<double>::epsilon();
  if (staleness() == 0 || distance == 0.0 || system_.isCoupled())
    return false;
  const double length = iterate_.level.iterateNorm + rows_.valuesNorm();
  if (distance <= rounding * length || distance * iterate_.level.rhsNorm <= residualNorm() * length)
    return false;
  ++counters_.confirmations;
  const ActiveFace face = system_.face();
  return start(face);
}

template<class Scalar, class MV, class OP>
int FaceSolver<Scalar, MV, OP>::keepOutliers(int most) {
  const int before = kept_.size();
  // The others are not far enough from the rest to be worth a product.
  constexpr double outlying = 30.0;
  const Teuchos::RCP<MV> vectors = system_.hasPreconditioner() && most > before
                                       ? conjugate_.directions().ritzVectors(most - before, outlying)
                                       : Teuchos::null;
  if (!vectors.is_null())
    kept_.add(*vectors, counters_);
  return kept_.size() - before;
}

template<class Scalar, class MV, class OP>
typename FaceSolver<Scalar, MV, OP>::Slipping FaceSolver<Scalar, MV, OP>::slipping() const {
  const double q = system_.stiffness() > 0.0 ? system_.stiffness() : curvatureBound();
  if ((problem_.kind().isPiecewiseLinear && !system_.hasSprings()) || !(q > 0.0))
    return {residualNorm(), 0.0};
  const SlipSums sums = FaceOps<Scalar, MV>::slipSums(system_.face(), q, *iterate_.w);
  return {std::sqrt(std::max(0.0, iterate_.residual2 - sums.along2 - sums.springs2) + sums.softened2 +
                    sums.softenedSprings2),
          sums.rims2 > 0.0 ? std::sqrt(sums.along2 / sums.rims2) : 0.0};
}

template<class Scalar, class MV, class OP>
bool FaceSolver<Scalar, MV, OP>::isRefinable() const {
  constexpr double most = 0.1;
  if (!system_.hasSprings() || staleness() == 0)
    return false;
  return iterate_.level.of(norm<Scalar>(*system_.springForces(*iterate_.x))) < most * attainable();
}

template<class Scalar, class MV, class OP>
double FaceSolver<Scalar, MV, OP>::stiffness() const {
  for (const double known : {system_.stiffness(), rayleigh_})
    if (known > 0.0 && std::isfinite(known))
      return known;
  return curvatureBound();
}

template<class Scalar, class MV, class OP>
double FaceSolver<Scalar, MV, OP>::cost() {
  const MV& x = *iterate_.x;
  if (rows_.isPresent() && rows_.valuesNorm() > 0.0) // else of no account
    settle();
  double ofSprings = 0.0; // ½κ(x − c)² − ½xκ(x − c)
  if (system_.hasSprings()) {
    const Teuchos::RCP<MV> forces = MVT::Clone(x, 1);
    MVT::MvInit(*forces, 0.0);
    FaceOps<Scalar, MV>::addSprings(system_.face(), 1.0, x, true, *forces);
    ofSprings = -0.5 * FaceOps<Scalar, MV>::atCentres(system_.face(), *forces);
  }
  return 0.5 * (dot<Scalar>(x, *iterate_.gradient) - dot<Scalar>(x, *problem_.rhs())) + ofSprings;
}

template<class Scalar, class MV, class OP>
void FaceSolver<Scalar, MV, OP>::lagrangianGradient(MV& y) {
  settle();
  pinMotions();
  MVT::Assign(*iterate_.gradient, y);
  FaceOps<Scalar, MV>::addCurvature(system_.face(), -1.0, *iterate_.x, true, y);
  if (rows_.isPresent())
    rows_.addTransposed(-1.0, *iterate_.removed, y);
}

template<class Scalar, class MV, class OP>
void FaceSolver<Scalar, MV, OP>::trueGradient(MV& y) {
  lagrangianGradient(y);
  BlockOps<Scalar, MV>::correctForces(problem_.blocks(), system_.face(), *iterate_.x, y);
}

// Fp in the place of Ap = PFp has brought parts in the range of C̄ᵀ to the gradient, which has none of its
// own: C̄(Ax − b) = −C̄b. They go to the multipliers, where what C̄_Fᵀ took away has them, too.
template<class Scalar, class MV, class OP>
void FaceSolver<Scalar, MV, OP>::settle() {
  if (iterate_.isSettled)
    return;
  iterate_.isSettled = true;
  std::vector<double> none;
  const Teuchos::RCP<MV> part = rows_.makeVector();
  rows_.solveFor(nullptr, *iterate_.gradient, *part, none);
  MVT::MvAddMv(1.0, *part, 1.0, *rowsOfLoad_, *part);
  rows_.addTransposed(-1.0, *part, *iterate_.gradient);
  if (system_.gram() != nullptr) {
    // As far as the face holds them: nothing was taken away for motions that it leaves free.
    const Teuchos::RCP<MV> held = MVT::Clone(*iterate_.x, 1);
    MVT::MvInit(*held, 0.0);
    rows_.addTransposed(1.0, *part, *held);
    system_.mask(*held);
    rows_.solveFor(system_.gram(), *held, *part, none);
  }
  MVT::MvAddMv(1.0, *iterate_.removed, -1.0, *part, *iterate_.removed);
}

template<class Scalar, class MV, class OP>
void FaceSolver<Scalar, MV, OP>::multiplier(MV& mu) {
  settle();
  pinMotions();
  MVT::MvAddMv(-1.0, *iterate_.removed, 0.0, *iterate_.removed, mu);
}

template<class Scalar, class MV, class OP>
void FaceSolver<Scalar, MV, OP>::storeMultiplier() {
  if (!rows_.isPresent())
    return;
  const Teuchos::RCP<MV> mu = rows_.makeVector();
  multiplier(*mu);
  rows_.toUser(*mu, *problem_.multiplier());
}

template<class Scalar, class MV, class OP>
IterationState<MV> FaceSolver<Scalar, MV, OP>::evaluate(double gradientNorm, int outer, int inner) {
  IterationState<MV> state;
  state.x = iterate_.x.get();
  state.projectedGradient = gradientNorm;
  state.equalityResidual = iterate_.distance.residual();
  state.equalityDistance = iterate_.distance.distance();
  state.decrease = std::numeric_limits<double>::quiet_NaN(); // not known
  state.outer = outer;
  state.inner = inner;
  state.counters = &counters_;
  return state;
}

} // namespace Harmos::qp
