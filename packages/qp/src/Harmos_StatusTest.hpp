// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_QpTypes.hpp"

#include <BelosMultiVecTraits.hpp>
#include <Teuchos_RCP.hpp>

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
  int outer = 0;
  int inner = 0; ///< all inner iterations so far
  const Counters* counters = nullptr;
};

enum class Status { Passed, Failed, Undefined };

/// A stopping criterion; mirrors Belos::StatusTest. Tests are composed by StatusTestCombo.
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

/// ‖g^P(x, μ⁺, 0)‖ ≤ tolerance · scale.
template<class MV>
class StatusTestProjectedGradient : public StatusTestValue<MV> {
 public:
  StatusTestProjectedGradient(double tolerance, double scale)
      : StatusTestValue<MV>("projected gradient"), tolerance_(tolerance), scale_(scale) {}
  Status checkStatus(const IterationState<MV>& state) override {
    return this->judge(state.projectedGradient, tolerance_ * scale_);
  }
  double scale() const { return scale_; }

 private:
  double tolerance_;
  double scale_;
};

/// ‖Cx − c‖ ≤ tolerance · scale, where scale is a number or, with a shift s, max(number, ‖x + s‖).
///
/// The second form measures the residual against the unknown itself and so also works when c = 0.
template<class MV, class Scalar = double>
class StatusTestEqualityResidual : public StatusTestValue<MV> {
 public:
  StatusTestEqualityResidual(double tolerance, double scale, Teuchos::RCP<const MV> shift = Teuchos::null)
      : StatusTestValue<MV>("equality residual"),
        tolerance_(tolerance),
        least_(scale),
        scale_(scale),
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
    return this->judge(state.equalityResidual, tolerance_ * scale_);
  }
  double scale() const { return scale_; }

 private:
  double tolerance_;
  double least_;
  double scale_;
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

 private:
  int most_;
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
