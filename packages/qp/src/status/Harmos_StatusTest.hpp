// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"
#include "Harmos_QpTypes.hpp"

#include <BelosMultiVecTraits.hpp>
#include <Teuchos_RCP.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iosfwd>
#include <ostream>
#include <string>
#include <vector>

namespace Harmos::qp {

/// What a status test may look at: an iterate and what is known of it.
template<class MV>
struct IterationState {
  const MV* x = nullptr;
  /// ‖g^P(x, μ⁺, 0)‖ of the Lagrangian, with the multiplier μ⁺ = μ + ρ(Cx − c) that the iterate implies; the
  /// same as ‖g^P(x, μ, ρ)‖ of what the inner loop minimises.
  double projectedGradient = 0.0;
  double equalityResidual = 0.0; ///< ‖Cx − c‖
  /// Distance of x from what the equalities allow: ‖C̄x − c̄‖ in orthonormal rows, the rows' own units aside.
  double equalityDistance = 0.0;
  double decrease = 0.0; ///< of the cost over the last step, NaN where it is not known
  int outer = 0;
  int inner = 0; ///< all inner iterations so far
  const Counters* counters = nullptr;
};

enum class Status { Passed, Failed, Undefined };

/// A stopping criterion; mirrors Belos::StatusTest. Tests are composed by StatusTestCombo; an application
/// derives its own. A solver stops when its test passes, for the reason that the test gives.
///
/// checkStatus() is collective if the test computes norms; every rank gets the same answer.
/// Guarded by tests/unit/qp/test_status_tests.cpp.
template<class MV>
class StatusTest {
 public:
  virtual ~StatusTest() = default;
  virtual Status checkStatus(const IterationState<MV>& state) = 0;
  virtual Status getStatus() const = 0;
  virtual void reset() = 0;
  virtual void print(std::ostream& out, int indent = 0) const = 0;
  /// What it means for the solver that the test has passed.
  virtual Reason reason() const { return Reason::Converged; }
};

/// Common part of tests of one number against a limit.
template<class MV>
class StatusTestValue : public StatusTest<MV> {
 public:
  Status getStatus() const override { return status_; }
  void reset() override { status_ = Status::Undefined; }
  void print(std::ostream& out, int indent = 0) const override {
    out << std::string(static_cast<std::size_t>(indent), ' ') << name_ << " = " << value_
        << (status_ == Status::Passed ? " <= " : " > ") << limit_ << "\n";
  }
  double value() const { return value_; }
  double limit() const { return limit_; }

 protected:
  explicit StatusTestValue(std::string name) : name_(std::move(name)) {}
  Status judge(double value, double limit) {
    value_ = value;
    limit_ = limit;
    // A NaN never passes.
    status_ = value <= limit ? Status::Passed : Status::Failed;
    return status_;
  }

 private:
  std::string name_;
  double value_ = 0.0;
  double limit_ = 0.0;
  Status status_ = Status::Undefined;
};

/// ‖g^P(x, μ⁺, 0)‖ ≤ tolerance · scale: relative to a number, ‖b‖ for instance; absolute with scale 1.
template<class MV>
class StatusTestProjectedGradient : public StatusTestValue<MV> {
 public:
  StatusTestProjectedGradient(double tolerance, double scale)
      : StatusTestValue<MV>("projected gradient"), tolerance_(tolerance), scale_(scale) {}
  Status checkStatus(const IterationState<MV>& state) override {
    return this->judge(state.projectedGradient, tolerance_ * scale_);
  }
  double scale() const { return scale_; }
  void raiseScale(double scale) { scale_ = std::max(scale_, scale); }
  void setTolerance(double tolerance) { tolerance_ = tolerance; }

 private:
  double tolerance_;
  double scale_;
};

/// Distance from the equalities ≤ tolerance · max(number, ‖x‖): independent of the rows' units.
template<class MV, class Scalar = double>
class StatusTestEqualityDistance : public StatusTestValue<MV> {
 public:
  StatusTestEqualityDistance(double tolerance, double scale)
      : StatusTestValue<MV>("distance from the equalities"), tolerance_(tolerance), scale_(scale) {}
  Status checkStatus(const IterationState<MV>& state) override {
    std::vector<double> norm(1);
    Belos::MultiVecTraits<Scalar, MV>::MvNorm(*state.x, norm);
    return this->judge(state.equalityDistance, tolerance_ * std::max(scale_, norm[0]));
  }

 private:
  double tolerance_;
  double scale_;
};

/// ‖g^P‖ ≤ tolerance · ‖g^P‖ of the first iterate it is asked about after reset().
template<class MV>
class StatusTestInitialGradient : public StatusTestValue<MV> {
 public:
  explicit StatusTestInitialGradient(double tolerance)
      : StatusTestValue<MV>("projected gradient"), tolerance_(tolerance) {}
  Status checkStatus(const IterationState<MV>& state) override {
    if (this->getStatus() == Status::Undefined)
      initial_ = state.projectedGradient;
    return this->judge(state.projectedGradient, tolerance_ * initial_);
  }

 private:
  double tolerance_;
  double initial_ = 0.0;
};

/// Passes when the cost has fallen by no more than tolerance times its whole decrease so far over the last
/// `window` steps: the solver stops for stagnation. Steps whose decrease is not known end a window.
template<class MV>
class StatusTestCostStagnation : public StatusTestValue<MV> {
 public:
  StatusTestCostStagnation(double tolerance, int window)
      : StatusTestValue<MV>("decrease of the cost"), tolerance_(tolerance), window_(window) {}
  Status checkStatus(const IterationState<MV>& state) override {
    if (state.inner <= lastInner_)
      return this->getStatus() == Status::Undefined ? this->judge(1.0, 0.0) : this->getStatus();
    lastInner_ = state.inner;
    if (!std::isfinite(state.decrease)) {
      recent_.clear();
      return this->judge(1.0, 0.0);
    }
    total_ += state.decrease;
    recent_.push_back(state.decrease);
    if (static_cast<int>(recent_.size()) < window_)
      return this->judge(1.0, 0.0);
    double sum = 0.0;
    for (auto k = recent_.size() - static_cast<std::size_t>(window_); k < recent_.size(); ++k)
      sum += recent_[k];
    return this->judge(sum, tolerance_ * total_);
  }
  void reset() override {
    StatusTestValue<MV>::reset();
    recent_.clear();
    total_ = 0.0;
    lastInner_ = 0;
  }
  Reason reason() const override { return Reason::Stagnation; }

 private:
  double tolerance_;
  int window_;
  int lastInner_ = 0;
  double total_ = 0.0;
  std::vector<double> recent_;
};

/// ‖Cx − c‖ ≤ tolerance · scale, where scale is a number or, with a shift s, max(number, ‖x + s‖).
///
/// The second form measures the residual against the unknown itself and so also works when c = 0. Where ‖x +
/// s‖ is negligible, rounding errors of zero, so is a residual of that size.
template<class MV, class Scalar = double>
class StatusTestEqualityResidual : public StatusTestValue<MV> {
 public:
  StatusTestEqualityResidual(double tolerance, double scale, Teuchos::RCP<const MV> shift = Teuchos::null,
                             double negligible = 0.0)
      : StatusTestValue<MV>("equality residual"),
        tolerance_(tolerance),
        least_(scale),
        scale_(scale),
        negligible_(negligible),
        shift_(shift) {}
  Status checkStatus(const IterationState<MV>& state) override {
    if (!shift_.is_null()) {
      using MVT = Belos::MultiVecTraits<Scalar, MV>;
      if (sum_.is_null())
        sum_ = MVT::Clone(*shift_, 1);
      MVT::MvAddMv(1.0, *state.x, 1.0, *shift_, *sum_);
      std::vector<double> norm(1);
      MVT::MvNorm(*sum_, norm);
      scale_ = std::max(least_, norm[0]);
    }
    if (scale_ <= negligible_)
      return this->judge(state.equalityResidual, negligible_);
    return this->judge(state.equalityResidual, tolerance_ * scale_);
  }
  double scale() const { return scale_; }
  void setTolerance(double tolerance) { tolerance_ = tolerance; }

 private:
  double tolerance_;
  double least_;
  double scale_;
  double negligible_;
  Teuchos::RCP<const MV> shift_;
  Teuchos::RCP<MV> sum_;
};

/// Passes when a number of iterations is reached: it stops the solver, it does not make it converged.
template<class MV>
class StatusTestMaxIterations : public StatusTestValue<MV> {
 public:
  explicit StatusTestMaxIterations(int most) : StatusTestValue<MV>("iterations left"), most_(most) {}
  Status checkStatus(const IterationState<MV>& state) override {
    return this->judge(static_cast<double>(most_ - state.inner), 0.0);
  }
  Reason reason() const override { return Reason::IterationLimit; }

 private:
  int most_;
};

/// Passes when so many seconds have gone by since the first check after reset(), on the slowest rank.
template<class MV, class Scalar = double>
class StatusTestMaxTime : public StatusTestValue<MV> {
 public:
  explicit StatusTestMaxTime(double seconds) : StatusTestValue<MV>("seconds left"), most_(seconds) {}
  Status checkStatus(const IterationState<MV>& state) override {
    const auto now = std::chrono::steady_clock::now();
    if (this->getStatus() == Status::Undefined)
      start_ = now;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    return this->judge(most_ - BoundTraits<Scalar, MV>::maximum(*state.x, elapsed), 0.0);
  }
  Reason reason() const override { return Reason::TimeLimit; }

 private:
  double most_;
  std::chrono::steady_clock::time_point start_;
};

/// Composition of tests.
template<class MV>
class StatusTestCombo : public StatusTest<MV> {
 public:
  /// And: all pass. Or: one passes; all are evaluated. Sequence: all pass, evaluated in order up to the first
  /// that fails, which spares the cost of the rest.
  enum class Type { And, Or, Sequence };

  StatusTestCombo(Type type, std::vector<Teuchos::RCP<StatusTest<MV>>> tests)
      : type_(type), tests_(std::move(tests)) {}

  Status checkStatus(const IterationState<MV>& state) override {
    bool all = true, any = false;
    for (const auto& test : tests_) {
      const bool passed = test->checkStatus(state) == Status::Passed;
      all = all && passed;
      any = any || passed;
      if (type_ == Type::Sequence && !passed)
        break;
    }
    status_ = (type_ == Type::Or ? any : all) ? Status::Passed : Status::Failed;
    return status_;
  }
  Status getStatus() const override { return status_; }
  /// Converged if a passed test of an Or, or all of an And, say so; else the first other reason.
  Reason reason() const override {
    Reason other = Reason::Converged;
    for (const auto& test : tests_) {
      if (test->getStatus() != Status::Passed)
        continue;
      if (type_ == Type::Or && test->reason() == Reason::Converged)
        return Reason::Converged;
      if (other == Reason::Converged)
        other = test->reason();
    }
    return other;
  }
  void reset() override {
    status_ = Status::Undefined;
    for (const auto& test : tests_)
      test->reset();
  }
  void print(std::ostream& out, int indent = 0) const override {
    static const char* const names[] = {"all of:", "any of:", "all in turn of:"};
    out << std::string(static_cast<std::size_t>(indent), ' ') << names[static_cast<int>(type_)] << "\n";
    for (const auto& test : tests_)
      test->print(out, indent + 2);
  }

 private:
  Type type_;
  std::vector<Teuchos::RCP<StatusTest<MV>>> tests_;
  Status status_ = Status::Undefined;
};

} // namespace Harmos::qp
