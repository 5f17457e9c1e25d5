// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_GuardedFunction.hpp"
#include "Harmos_RolVersion.hpp"

#include <memory>
#include <vector>

namespace Harmos::rol {

/// A design as ROL's vector, in the inner product Σ weights·a·b. Its dual is that of derivatives, Σ
/// a·b/weights: ROL's gradient of f is (df/da)/weights. Local; the same on all ranks.
ROL::Ptr<ROL::Vector<double>> makeDesign(const std::vector<double>& values,
                                         const std::vector<double>& weights);
/// The same for derivatives.
ROL::Ptr<ROL::Vector<double>> makeDerivative(const std::vector<double>& values,
                                             const std::vector<double>& weights);
/// The numbers of a vector of makeDesign(), makeDerivative() or makeNumber(). @throws std::bad_cast for
/// others.
const std::vector<double>& numbersOf(const ROL::Vector<double>& vector);
std::vector<double>& numbersOf(ROL::Vector<double>& vector);
/// What a constraint's value, multiplier and limits are.
ROL::Ptr<ROL::Vector<double>> makeNumber(double value);

/// Bounds of designs as ROL has them, in whom 0.1 of the largest number stands for infinity.
ROL::Ptr<ROL::BoundConstraint<double>> makeBounds(const std::vector<double>& lower,
                                                  const std::vector<double>& upper,
                                                  const std::vector<double>& weights);
/// Limits of a constraint; either may be infinite.
ROL::Ptr<ROL::BoundConstraint<double>> makeLimits(double lower, double upper);

/// What becomes of the tolerances that ROL asks for.
enum class Tolerances {
  AsUsual, ///< the function's own: ROL says √ε where its parameters do not ask for inexact values
  AsAsked, ///< ROL's, relative to the first value or gradient; those above 1 as usual
};

/// A number that depends on a design as ROL's objective: times a factor, in the inner product of the weights.
///
/// Values, gradients and errors as in GuardedFunction. Second derivatives are ROL's differences of gradients,
/// which cost a gradient at another design each: use a secant. Guarded by tests/unit/rol/test_adapters.cpp.
class DesignObjective : public ROL::Objective<double> {
 public:
  explicit DesignObjective(sensitivity::DesignFunction& function, Tolerances tolerances = Tolerances::AsAsked,
                           std::shared_ptr<Refusals> refusals = nullptr);

  /// The objective is the function times this. Above zero.
  void setFactor(double factor) { factor_ = factor; }

  double value(const ROL::Vector<double>& design, double& tolerance) override;
  void gradient(ROL::Vector<double>& derivative, const ROL::Vector<double>& design,
                double& tolerance) override;

  const GuardedFunction& function() const { return function_; }

 private:
  GuardedFunction function_;
  Tolerances tolerances_;
  double factor_ = 1.0, firstValue_ = 0.0, firstGradient_ = 0.0;
};

/// A number that depends on a design as a constraint of ROL, with one number as its value: factor (function −
/// origin). Guarded by tests/unit/rol/test_adapters.cpp.
class DesignLimit : public ROL::Constraint<double> {
 public:
  explicit DesignLimit(sensitivity::DesignFunction& function, Tolerances tolerances = Tolerances::AsAsked,
                       double factor = 1.0, double origin = 0.0,
                       std::shared_ptr<Refusals> refusals = nullptr);

  void value(ROL::Vector<double>& result, const ROL::Vector<double>& design, double& tolerance) override;
  void applyJacobian(ROL::Vector<double>& result, const ROL::Vector<double>& step,
                     const ROL::Vector<double>& design, double& tolerance) override;
  using ROL::Constraint<double>::applyAdjointJacobian;
  void applyAdjointJacobian(ROL::Vector<double>& derivative, const ROL::Vector<double>& multiplier,
                            const ROL::Vector<double>& design, double& tolerance) override;

  GuardedFunction& function() { return function_; }

 private:
  const std::vector<double>& gradient(const std::vector<double>& design, double tolerance);

  GuardedFunction function_;
  Tolerances tolerances_;
  double factor_, origin_, firstValue_ = 0.0, firstGradient_ = 0.0;
};

} // namespace Harmos::rol
