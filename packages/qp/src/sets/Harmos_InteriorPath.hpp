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
        effort_{mostKept},
        directions_(options),
        springs_(std::move(springs)),
        counters_(counters),
        preconditioner_(problem, counters),
        point_{MVT::Clone(*problem.rhs(), 1), MVT::Clone(*problem.rhs(), 1), Teuchos::null},
        cones_(Limits::conesOf(problem.feasibleSet(), *point_.x,
                               problem.hasFollowingLimits() ? &problem.followingLimits() : nullptr)) {
    if (rows_.isPresent()) {
      point_.mu = rows_.makeVector();
      MVT::MvInit(*point_.mu, 0.0);
    }
  }

  /// @param start where to begin, within limits or not. @param q a stiffness, about that of the solution.
  /// @param end of the path, as part of the distances from bounds where it begins. @param ends is asked at
  /// each point, whether to break off.
  /// @return whether the end of the path was reached. @note Collective.
  bool run(const MV& start, double q, double end, int mostSteps, const std::function<bool()>& ends) {
    q_ = q;
    effort_.most = mostSteps;
    const auto entries = static_cast<double>(MVT::GetGlobalLength(*point_.x));
    const double load = norm<Scalar>(*problem_.rhs());
    const double size = std::max(norm<Scalar>(start), load / q) / std::sqrt(entries);
    if (!(size > 0.0))
      return false;
    MVT::Assign(start, *point_.x);
    onEntries([&](double* x) { cones_.begin(size, q * size * size, x); }, *point_.x);
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
      effort_.accuracy = behind > much && k > 0 ? std::max(1e-4, 0.1 * effort_.accuracy)
                                                : std::min(0.1, 3.0 * effort_.accuracy);
      const double sigma = last > 0.9 && behind < tooMuch ? 0.1 : last > 0.5 ? 0.3 : 0.8;
      if (!advance(sigma * tau, last))
        return false;
      // No accuracy of steps that are better than the first ones makes them longer.
      constexpr double coarsest = 0.1;
      if (last < 0.02 && effort_.accuracy < coarsest)
        return false;
      stuck = last < 0.02 ? stuck + 1 : 0;
    }
    return false;
  }

  const MV& x() const { return *point_.x; }
  /// The gradient of the Lagrangian there.
  const MV& y() const { return *point_.y; }
  int steps() const { return effort_.steps; }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  using Limits = FollowingOps<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  using Vector = Teuchos::RCP<MV>;

  Vector like() const { return MVT::Clone(*point_.x, 1); }

  template<class Function>
  void onEntries(const Function& function, MV& v) const {
    std::vector<double> entries = Bounds::localEntries(v);
    function(entries.data());
    Bounds::setLocalEntries(entries, v);
  }
  // @param length receives the longest step within the cones.
  bool advance(double sigmaTau, double& length) {
    cones_.scale(q_);
    const int before = effort_.steps;
    if (!findStep(sigmaTau) || effort_.steps >= effort_.most)
      return false;
    keepOutliers(effort_.steps - before);
    double longest = 1.0;
    onEntries([&](double* dx) { longest = cones_.findStep(dx, sigmaTau); }, *step_.x);
    length = -BT::maximum(*point_.x, -longest);
    const double step = length < 1.0 ? 0.95 * length : 1.0;
    cones_.advance(step);
    MVT::MvAddMv(1.0, *point_.x, step, *step_.x, *point_.x);
    MVT::MvAddMv(1.0, *point_.y, step, *step_.image, *point_.y);
    if (rows_.isPresent()) {
      MVT::MvAddMv(1.0, *point_.mu, step, *step_.mu, *point_.mu);
      rows_.addTransposed(step, *step_.mu, *point_.y);
    }
    return true;
  }

  void findGradient() {
    ++counters_.hessianApplications;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), *point_.x, *point_.y);
    MVT::MvAddMv(1.0, *point_.y, -1.0, *problem_.rhs(), *point_.y);
    FaceOps<Scalar, MV>::addSprings(springs_, 1.0, *point_.x, true, *point_.y);
    if (rows_.isPresent())
      rows_.addTransposed(1.0, *point_.mu, *point_.y);
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
    const Vector r = MVT::CloneCopy(*point_.y);
    onEntries([&](double* v) { cones_.subtractDual(v); }, *r);
    return norm<Scalar>(*r);
  }

  void findRowResidual() {
    if (!rows_.isPresent())
      return;
    step_.rows = rows_.makeVector();
    rows_.apply(*point_.x, *step_.rows);
    MVT::MvAddMv(1.0, *step_.rows, -1.0, rows_.values(), *step_.rows);
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
    step_.gram->solve(*w);
    return w;
  }

  // dx that meets the rows and minimises over the kept directions; @return what is left, ρ.
  Vector beginStep(double sigmaTau) {
    if (rows_.isPresent()) {
      step_.gram = rows_.gramWith([this](MV& v) { weigh(v); });
      step_.mu = rows_.makeVector();
      MVT::MvInit(*step_.mu, 0.0);
    }
    step_.x = like();
    step_.image = like();
    MVT::MvInit(*step_.x, 0.0);
    MVT::MvInit(*step_.image, 0.0);
    const Vector rho = like();
    MVT::MvAddMv(-1.0, *point_.y, 0.0, *point_.y, *rho);
    onEntries([&](double* r) { cones_.addCentring(sigmaTau, r); }, *rho);
    if (rows_.isPresent() && norm<Scalar>(*step_.rows) > 0.0) {
      const Vector w = rows_.makeVector();
      MVT::Assign(*step_.rows, *w);
      step_.gram->solve(*w);
      rows_.addTransposed(-1.0, *w, *step_.x);
      weigh(*step_.x);
      const Vector whole = imageOf(*step_.x, *problem_.hessian(), *step_.image);
      MVT::MvAddMv(1.0, *rho, -1.0, *whole, *rho);
    }
    const Vector before = like();
    MVT::MvAddMv(-1.0, *rho, 0.0, *rho, *rho);
    MVT::Assign(*rho, *before);
    kept_.minimise(*step_.x, *rho);
    MVT::MvAddMv(1.0, *rho, -1.0, *before, *before);
    MVT::MvAddMv(1.0, *step_.image, 1.0, *before, *step_.image);
    MVT::MvAddMv(-1.0, *rho, 0.0, *rho, *rho);
    return rho;
  }

  bool findStep(double sigmaTau) {
    const Vector rho = beginStep(sigmaTau), z = like(), p = like(), image = like();
    directions_.clear();
    // Exact conjugate gradients end within the dimension; what takes longer is rounding errors.
    const auto dimension = static_cast<long long>(MVT::GetGlobalLength(*point_.x));
    double first = 0.0, last = 0.0;
    for (int k = 0; effort_.steps < effort_.most && k < dimension; ++k) {
      if (rows_.isPresent()) {
        const Vector eta = rowPart(*rho);
        rows_.addTransposed(-1.0, *eta, *rho);
        MVT::MvAddMv(1.0, *step_.mu, 1.0, *eta, *step_.mu);
      }
      precondition(*rho, *z);
      const double now = dot<Scalar>(*rho, *z);
      if (!std::isfinite(now))
        return false;
      if (k == 0)
        first = now;
      if (!(now > effort_.accuracy * effort_.accuracy * first))
        return true;
      MVT::MvAddMv(1.0, *z, k == 0 ? 0.0 : now / last, k == 0 ? *z : *p, *p);
      directions_.conjugate(*p);
      last = now;
      const Teuchos::RCP<const OP> onKernel = problem_.hessianOnKernel();
      const Vector whole = imageOf(*p, onKernel.is_null() ? *problem_.hessian() : *onKernel, *image);
      const double curvature = dot<Scalar>(*p, *whole);
      ++effort_.steps;
      ++counters_.cgSteps;
      if (!(curvature > 0.0))
        return k > 0;
      const double length = dot<Scalar>(*rho, *p) / curvature;
      directions_.add(*p, *whole, curvature, length);
      MVT::MvAddMv(1.0, *step_.x, length, *p, *step_.x);
      MVT::MvAddMv(1.0, *step_.image, length, *image, *step_.image);
      MVT::MvAddMv(1.0, *rho, -length, *whole, *rho);
    }
    return false;
  }

  // Steps that took so long have outlying eigenvalues, and so have the others.
  void keepOutliers(int taken) {
    constexpr int slow = 20;
    constexpr double outlying = 30.0;
    if (taken < slow || kept_.size() >= effort_.mostKept)
      return;
    const Vector vectors = directions_.ritzVectors(effort_.mostKept - kept_.size(), outlying);
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
    step_.gram->solve(*w);
    MVT::MvInit(*part, 0.0);
    rows_.addTransposed(1.0, *w, *part);
    weigh(*part);
    MVT::MvAddMv(1.0, z, -1.0, *part, z);
  }

  struct Point {
    Vector x, y, mu;
  };
  struct Step {
    Vector x, image, mu; // dx, A dx, δ
    Vector rows;         // C̄x − c̄
    Teuchos::RCP<const FaceGram<MV>> gram;
  };
  struct Effort {
    int mostKept;
    int steps = 0, most = 0;
    double accuracy = 0.1; // of steps, in their energy
  };

  const Problem<Scalar, MV, OP>& problem_;
  const EqualityRows<Scalar, MV, OP>& rows_;
  KeptDirections<Scalar, MV, OP>& kept_;
  Effort effort_;
  ConjugateDirections<Scalar, MV> directions_;
  ActiveFace springs_;
  Counters& counters_;
  InFacePreconditioner<Scalar, MV, OP> preconditioner_;
  Point point_;
  Kernels::SecondOrderCones cones_;
  Step step_;
  double q_ = 1.0, count_ = 1.0;
};

} // namespace Harmos::qp
