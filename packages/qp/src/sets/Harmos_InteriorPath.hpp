// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_ConjugateDirections.hpp"
#include "Harmos_EqualityRows.hpp"
#include "Harmos_FollowingOps.hpp"
#include "Harmos_InFacePreconditioner.hpp"
#include "Harmos_KeptDirections.hpp"
#include "Harmos_QpProblem.hpp"
#include "Harmos_SecondOrderCones.hpp"
#include "Harmos_VectorOps.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

namespace Harmos::qp {

/// Interior points that lead to the neighbourhood of the solution, for active sets that wander: bounds, discs
/// and limits that follow are cones (SecondOrderCones), and with y = Ax − b + C̄ᵀμ
///
///     y = z,   C̄x = c̄,   s∘z = τe,   s, z ∈ K,
///
/// has a solution for each τ > 0, however badly A is conditioned, where there are points within. Newton's
/// steps for a falling τ, with the scaling of Nesterov and Todd,
///
///     (A + W⁻²)dx + C̄ᵀδ = −y + στs⁻¹,   C̄dx = c̄ − C̄x,
///
/// are some twenty to forty, found by conjugate gradients with the preconditioner D(M⁻¹D + (1 − D)/q),
/// D = (1 + W⁻²/q)⁻¹, within 1 − DC̄ᵀ(C̄DC̄ᵀ)⁻¹C̄. All of friction's cone is there from the beginning: what its
/// normal has too much of follows with each step (as in Acary, Cadoux 2013, with interior points: Kleinert,
/// Simeon, Obermayr, J. Comput. Appl. Math. 2014). Where that does not contract the path breaks off; that of
/// a program with given limits does not, until rounding errors of s_0 − |s_1| end it.
///
/// Cost: some hundred products; C̄DC̄ᵀ takes a product with C̄ and C̄ᵀ a row for each step. Guarded by
/// tests/unit/qp/test_following_limits.cpp.
template<class Scalar, class MV, class OP>
class InteriorPath {
 public:
  /// @param springs of soft bounds; they stay what they are. @param kept directions of outlying eigenvalues;
  /// more of them are added, up to `mostKept`.
  InteriorPath(const Problem<Scalar, MV, OP>& problem, const EqualityRows<Scalar, MV, OP>& rows,
               const CgOptions& options, KeptDirections<Scalar, MV, OP>& kept, int mostKept,
               Counters& counters, ActiveFace springs = {})
      : problem_(problem),
        rows_(rows),
        kept_(kept),
        mostKept_(mostKept),
        directions_(options),
        springs_(std::move(springs)),
        counters_(counters),
        preconditioner_(problem, counters),
        x_(MVT::Clone(*problem.rhs(), 1)),
        y_(MVT::Clone(*x_, 1)),
        cones_(Limits::conesOf(problem.feasibleSet(), *x_,
                               problem.hasFollowingLimits() ? &problem.followingLimits() : nullptr)) {
    if (rows_.isPresent()) {
      mu_ = rows_.makeVector();
      MVT::MvInit(*mu_, 0.0);
    }
  }

  /// @param start where to begin, within limits or not. @param q a stiffness, about that of the solution.
  /// @param end of the path, as part of the distances from bounds where it begins. @param ends is asked at
  /// each point, whether to break off.
  /// @return whether the end of the path was reached. @note Collective.
  bool run(const MV& start, double q, double end, int mostSteps, const std::function<bool()>& ends) {
    q_ = q;
    most_ = mostSteps;
    const auto entries = static_cast<double>(MVT::GetGlobalLength(*x_));
    const double load = norm<Scalar>(*problem_.rhs());
    const double size = std::max(norm<Scalar>(start), load / q) / std::sqrt(entries);
    if (!(size > 0.0))
      return false;
    MVT::Assign(start, *x_);
    onEntries([&](double* x) { cones_.begin(size, q * size * size, x); }, *x_);
    findGradient();
    count_ = countCones();
    constexpr int mostPoints = 80, mostStuck = 4;
    double last = 1.0;
    int stuck = 0;
    for (int k = 0; k < mostPoints && stuck < mostStuck && !ends(); ++k) {
      const double tau = complementarity() / count_;
      const double dual = dualResidual();
      findRowResidual();
      if (!std::isfinite(tau) || !std::isfinite(dual))
        return false;
      if (std::sqrt(tau / q) <= end * size)
        return true;
      // What is wrong with the gradient is to fall with τ.
      constexpr double much = 3.0, tooMuch = 30.0;
      const double behind = dual / std::sqrt(tau * q * entries);
      accuracy_ = behind > much && k > 0 ? std::max(1e-4, 0.1 * accuracy_) : std::min(0.1, 3.0 * accuracy_);
      const double sigma = last > 0.9 && behind < tooMuch ? 0.1 : last > 0.5 ? 0.3 : 0.8;
      if (!advance(sigma * tau, last))
        return false;
      // No accuracy of steps that are better than the first ones makes them longer.
      constexpr double coarsest = 0.1;
      if (last < 0.02 && accuracy_ < coarsest)
        return false;
      stuck = last < 0.02 ? stuck + 1 : 0;
    }
    return false;
  }

  const MV& x() const { return *x_; }
  /// The gradient of the Lagrangian there.
  const MV& y() const { return *y_; }
  int steps() const { return steps_; }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  using Limits = FollowingOps<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  using Vector = Teuchos::RCP<MV>;

  Vector like() const { return MVT::Clone(*x_, 1); }

  template<class Function>
  void onEntries(const Function& function, MV& v) const {
    std::vector<double> entries = Bounds::localEntries(v);
    function(entries.data());
    Bounds::setLocalEntries(entries, v);
  }
  // @param length receives the longest step within the cones.
  bool advance(double sigmaTau, double& length) {
    cones_.scale(q_);
    const int before = steps_;
    if (!findStep(sigmaTau) || steps_ >= most_)
      return false;
    keepOutliers(steps_ - before);
    double longest = 1.0;
    onEntries([&](double* dx) { longest = cones_.findStep(dx, sigmaTau); }, *step_);
    length = -BT::maximum(*x_, -longest);
    const double step = length < 1.0 ? 0.95 * length : 1.0;
    cones_.advance(step);
    MVT::MvAddMv(1.0, *x_, step, *step_, *x_);
    MVT::MvAddMv(1.0, *y_, step, *stepImage_, *y_);
    if (rows_.isPresent()) {
      MVT::MvAddMv(1.0, *mu_, step, *muStep_, *mu_);
      rows_.addTransposed(step, *muStep_, *y_);
    }
    return true;
  }

  void findGradient() {
    ++counters_.hessianApplications;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), *x_, *y_);
    MVT::MvAddMv(1.0, *y_, -1.0, *problem_.rhs(), *y_);
    FaceOps<Scalar, MV>::addSprings(springs_, 1.0, *x_, true, *y_);
    if (rows_.isPresent())
      rows_.addTransposed(1.0, *mu_, *y_);
  }

  double sumOf(void (Kernels::SecondOrderCones::*put)(double*) const) const {
    const Vector values = like(), ones = like();
    MVT::MvInit(*values, 0.0);
    MVT::MvInit(*ones, 1.0);
    onEntries([&](double* v) { (cones_.*put)(v); }, *values);
    return dot<Scalar>(*values, *ones);
  }
  double complementarity() const { return sumOf(&Kernels::SecondOrderCones::putProducts); }
  double countCones() const { return std::max(1.0, sumOf(&Kernels::SecondOrderCones::putOnes)); }

  double dualResidual() const {
    const Vector r = MVT::CloneCopy(*y_);
    onEntries([&](double* v) { cones_.subtractDual(v); }, *r);
    return norm<Scalar>(*r);
  }

  void findRowResidual() {
    if (!rows_.isPresent())
      return;
    e_ = rows_.makeVector();
    rows_.apply(*x_, *e_);
    MVT::MvAddMv(1.0, *e_, -1.0, rows_.values(), *e_);
  }

  // y = Ap; the same with W⁻²p is returned.
  Vector imageOf(const MV& p, const OP& hessian, MV& image) {
    ++counters_.hessianApplications;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(hessian, p, image);
    FaceOps<Scalar, MV>::addSprings(springs_, 1.0, p, false, image);
    const Vector whole = MVT::CloneCopy(image);
    const std::vector<double> entries = Bounds::localEntries(p);
    onEntries([&](double* y) { cones_.addCurvature(entries.data(), y); }, *whole);
    return whole;
  }

  void weigh(MV& v) const {
    onEntries([&](double* entries) { cones_.weigh(entries); }, v);
    FaceOps<Scalar, MV>::share(springs_, q_, v);
  }

  // w ← (C̄DC̄ᵀ)⁻C̄Dv.
  Vector rowPart(const MV& v) const {
    const Vector weighted = MVT::CloneCopy(v), w = rows_.makeVector();
    weigh(*weighted);
    rows_.apply(*weighted, *w);
    gram_->solve(*w);
    return w;
  }

  bool findStep(double sigmaTau) {
    if (rows_.isPresent()) {
      gram_ = rows_.gramWith([this](MV& v) { weigh(v); });
      muStep_ = rows_.makeVector();
      MVT::MvInit(*muStep_, 0.0);
    }
    step_ = like();
    stepImage_ = like();
    MVT::MvInit(*step_, 0.0);
    MVT::MvInit(*stepImage_, 0.0);
    const Vector rho = like(), z = like(), p = like(), image = like();
    MVT::MvAddMv(-1.0, *y_, 0.0, *y_, *rho);
    onEntries([&](double* r) { cones_.addCentring(sigmaTau, r); }, *rho);
    if (rows_.isPresent() && norm<Scalar>(*e_) > 0.0) {
      const Vector w = rows_.makeVector();
      MVT::Assign(*e_, *w);
      gram_->solve(*w);
      rows_.addTransposed(-1.0, *w, *step_);
      weigh(*step_);
      const Vector whole = imageOf(*step_, *problem_.hessian(), *stepImage_);
      MVT::MvAddMv(1.0, *rho, -1.0, *whole, *rho);
    }
    const Vector before = like();
    MVT::MvAddMv(-1.0, *rho, 0.0, *rho, *rho);
    MVT::Assign(*rho, *before);
    kept_.minimise(*step_, *rho);
    MVT::MvAddMv(1.0, *rho, -1.0, *before, *before);
    MVT::MvAddMv(1.0, *stepImage_, 1.0, *before, *stepImage_);
    MVT::MvAddMv(-1.0, *rho, 0.0, *rho, *rho);
    directions_.clear();
    double first = 0.0, last = 0.0;
    for (int k = 0; steps_ < most_; ++k) {
      if (rows_.isPresent()) {
        const Vector eta = rowPart(*rho);
        rows_.addTransposed(-1.0, *eta, *rho);
        MVT::MvAddMv(1.0, *muStep_, 1.0, *eta, *muStep_);
      }
      precondition(*rho, *z);
      const double now = dot<Scalar>(*rho, *z);
      if (!std::isfinite(now))
        return false;
      if (k == 0)
        first = now;
      if (!(now > accuracy_ * accuracy_ * first))
        return true;
      MVT::MvAddMv(1.0, *z, k == 0 ? 0.0 : now / last, k == 0 ? *z : *p, *p);
      directions_.conjugate(*p);
      last = now;
      const Teuchos::RCP<const OP> onKernel = problem_.hessianOnKernel();
      const Vector whole = imageOf(*p, onKernel.is_null() ? *problem_.hessian() : *onKernel, *image);
      const double curvature = dot<Scalar>(*p, *whole);
      ++steps_;
      ++counters_.cgSteps;
      if (!(curvature > 0.0))
        return k > 0;
      const double length = dot<Scalar>(*rho, *p) / curvature;
      directions_.add(*p, *whole, curvature, length);
      MVT::MvAddMv(1.0, *step_, length, *p, *step_);
      MVT::MvAddMv(1.0, *stepImage_, length, *image, *stepImage_);
      MVT::MvAddMv(1.0, *rho, -length, *whole, *rho);
    }
    return false;
  }

  // Steps that took so long have outlying eigenvalues, and so have the others.
  void keepOutliers(int taken) {
    constexpr int slow = 20;
    constexpr double outlying = 30.0;
    if (taken < slow || kept_.size() >= mostKept_)
      return;
    const Vector vectors = directions_.ritzVectors(mostKept_ - kept_.size(), outlying);
    if (!vectors.is_null())
      kept_.add(*vectors, counters_);
  }

  void precondition(const MV& rho, MV& z) {
    preconditionAlone(rho, z);
    kept_.conjugate(z);
  }

  void preconditionAlone(const MV& rho, MV& z) {
    const Vector weighted = MVT::CloneCopy(rho);
    weigh(*weighted);
    if (preconditioner_.isPresent()) {
      preconditioner_.apply(*weighted, ActiveFace{}, z);
      MVT::MvAddMv(1.0, z, 1.0 / q_, rho, z);
      MVT::MvAddMv(1.0, z, -1.0 / q_, *weighted, z);
    } else {
      MVT::MvAddMv(1.0 / q_, rho, 0.0, rho, z);
    }
    weigh(z);
    if (!rows_.isPresent())
      return;
    const Vector w = rows_.makeVector(), part = like();
    rows_.apply(z, *w);
    gram_->solve(*w);
    MVT::MvInit(*part, 0.0);
    rows_.addTransposed(1.0, *w, *part);
    weigh(*part);
    MVT::MvAddMv(1.0, z, -1.0, *part, z);
  }

  const Problem<Scalar, MV, OP>& problem_;
  const EqualityRows<Scalar, MV, OP>& rows_;
  KeptDirections<Scalar, MV, OP>& kept_;
  int mostKept_;
  ConjugateDirections<Scalar, MV> directions_;
  ActiveFace springs_;
  Counters& counters_;
  InFacePreconditioner<Scalar, MV, OP> preconditioner_;
  Vector x_, y_, mu_;
  Kernels::SecondOrderCones cones_;
  Teuchos::RCP<const FaceGram<MV>> gram_;
  Vector step_, stepImage_, muStep_; // dx, A dx, δ
  Vector e_;                         // C̄x − c̄
  double q_ = 1.0, count_ = 1.0;
  double accuracy_ = 0.1; // of steps, in their energy
  int steps_ = 0, most_ = 0;
};

} // namespace Harmos::qp
