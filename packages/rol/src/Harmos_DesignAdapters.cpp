// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DesignAdapters.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace Harmos::rol {

namespace {

// ROL's tolerances are absolute, ours relative.
double relativeTolerance(Tolerances tolerances, double asked, double scale) {
  if (tolerances == Tolerances::AsUsual || !(asked > 0.0) || !(asked < scale))
    return 0.0;
  return asked / scale;
}

double norm(const std::vector<double>& vector) {
  double sum = 0.0;
  for (const double number : vector)
    sum += number * number;
  return std::sqrt(sum);
}

ROL::Ptr<std::vector<double>> copied(const std::vector<double>& values) {
  return ROL::makePtr<std::vector<double>>(values);
}

// With ROL's infinities.
ROL::Ptr<std::vector<double>> copiedBounds(const std::vector<double>& values) {
  auto result = copied(values);
  for (double& number : *result)
    number = std::clamp(number, ROL::ROL_NINF<double>(), ROL::ROL_INF<double>());
  return result;
}

} // namespace

ROL::Ptr<ROL::Vector<double>> makeDesign(const std::vector<double>& values,
                                         const std::vector<double>& weights) {
  return ROL::makePtr<ROL::PrimalScaledStdVector<double>>(copied(values), copied(weights));
}

ROL::Ptr<ROL::Vector<double>> makeDerivative(const std::vector<double>& values,
                                             const std::vector<double>& weights) {
  return ROL::makePtr<ROL::DualScaledStdVector<double>>(copied(values), copied(weights));
}

ROL::Ptr<ROL::Vector<double>> makeNumber(double value) {
  return ROL::makePtr<ROL::StdVector<double>>(copied({value}));
}

const std::vector<double>& numbersOf(const ROL::Vector<double>& vector) {
  return *dynamic_cast<const ROL::StdVector<double>&>(vector).getVector();
}

std::vector<double>& numbersOf(ROL::Vector<double>& vector) {
  return *dynamic_cast<ROL::StdVector<double>&>(vector).getVector();
}

ROL::Ptr<ROL::BoundConstraint<double>> makeBounds(const std::vector<double>& lower,
                                                  const std::vector<double>& upper,
                                                  const std::vector<double>& weights) {
  const auto bound = [&](const std::vector<double>& values) -> ROL::Ptr<ROL::Vector<double>> {
    return ROL::makePtr<ROL::PrimalScaledStdVector<double>>(copiedBounds(values), copied(weights));
  };
  return ROL::makePtr<ROL::Bounds<double>>(bound(lower), bound(upper));
}

ROL::Ptr<ROL::BoundConstraint<double>> makeLimits(double lower, double upper) {
  const auto limit = [](double value) -> ROL::Ptr<ROL::Vector<double>> {
    return ROL::makePtr<ROL::StdVector<double>>(copiedBounds({value}));
  };
  return ROL::makePtr<ROL::Bounds<double>>(limit(lower), limit(upper));
}

DesignObjective::DesignObjective(sensitivity::DesignFunction& function, Tolerances tolerances,
                                 std::shared_ptr<Refusals> refusals)
    : function_(function, std::move(refusals)), tolerances_(tolerances) {}

double DesignObjective::value(const ROL::Vector<double>& design, double& tolerance) {
  const double result =
      function_.value(numbersOf(design), relativeTolerance(tolerances_, tolerance / factor_, firstValue_));
  if (firstValue_ == 0.0)
    firstValue_ = std::abs(result);
  return factor_ * result;
}

void DesignObjective::gradient(ROL::Vector<double>& derivative, const ROL::Vector<double>& design,
                               double& tolerance) {
  const double asked = relativeTolerance(tolerances_, tolerance / factor_, firstGradient_);
  numbersOf(derivative) = function_.gradient(numbersOf(design), asked);
  if (firstGradient_ == 0.0)
    firstGradient_ = derivative.norm();
  derivative.scale(factor_);
}

DesignLimit::DesignLimit(sensitivity::DesignFunction& function, Tolerances tolerances, double factor,
                         double origin, std::shared_ptr<Refusals> refusals)
    : function_(function, std::move(refusals)), tolerances_(tolerances), factor_(factor), origin_(origin) {}

void DesignLimit::value(ROL::Vector<double>& result, const ROL::Vector<double>& design, double& tolerance) {
  const double value =
      function_.value(numbersOf(design), relativeTolerance(tolerances_, tolerance / factor_, firstValue_));
  if (firstValue_ == 0.0)
    firstValue_ = std::abs(value);
  numbersOf(result)[0] = factor_ * (value - origin_);
}

const std::vector<double>& DesignLimit::gradient(const std::vector<double>& design, double tolerance) {
  const auto& result =
      function_.gradient(design, relativeTolerance(tolerances_, tolerance / factor_, firstGradient_));
  if (firstGradient_ == 0.0)
    firstGradient_ = norm(result);
  return result;
}

void DesignLimit::applyJacobian(ROL::Vector<double>& result, const ROL::Vector<double>& step,
                                const ROL::Vector<double>& design, double& tolerance) {
  const auto& derivative = gradient(numbersOf(design), tolerance);
  const auto& along = numbersOf(step);
  double sum = 0.0;
  for (std::size_t k = 0; k < along.size(); ++k)
    sum += derivative[k] * along[k];
  numbersOf(result)[0] = factor_ * sum;
}

void DesignLimit::applyAdjointJacobian(ROL::Vector<double>& derivative, const ROL::Vector<double>& multiplier,
                                       const ROL::Vector<double>& design, double& tolerance) {
  numbersOf(derivative) = gradient(numbersOf(design), tolerance);
  derivative.scale(factor_ * numbersOf(multiplier)[0]);
}

} // namespace Harmos::rol
