// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GuardedFunction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace Harmos::rol {

namespace {

// Far above all values, but its square is still a number: methods interpolate and penalise.
constexpr double farAbove = 1e20;

// Whether what is known with one tolerance will do where another is asked for; 0 is what the function does as
// usual.
bool suffices(double known, double asked) {
  return known == asked || asked == 0.0 || (known > 0.0 && known < asked);
}

} // namespace

GuardedFunction::GuardedFunction(sensitivity::DesignFunction& function, std::shared_ptr<Refusals> refusals)
    : function_(&function), refusals_(refusals ? std::move(refusals) : std::make_shared<Refusals>()) {}

GuardedFunction::Answer& GuardedFunction::answer(const std::vector<double>& design) {
  if (answers_[0].design != design)
    std::swap(answers_[0], answers_[1]);
  if (answers_[0].design != design) {
    answers_[0] = Answer();
    answers_[0].design = design;
  }
  return answers_[0];
}

void GuardedFunction::rethrow() const {
  if (error_)
    std::rethrow_exception(error_);
}

void GuardedFunction::requireNumbers(const std::vector<double>& design) {
  if (std::all_of(design.begin(), design.end(), [](double number) { return std::isfinite(number); }))
    return;
  error_ = std::make_exception_ptr(InputError(
      "ROL requested a design with a non-finite number: its method (Step/Type) fails for this problem, as an "
      "interior-point method does for a start on a bound. Choose another method or another start"));
  rethrow();
}

double GuardedFunction::value(const std::vector<double>& design, double tolerance) {
  rethrow();
  requireNumbers(design);
  Answer& known = answer(design);
  if (known.isRefused || (known.hasValue && suffices(known.valueTolerance, tolerance)))
    return known.value;
  try {
    ++values_;
    known.value = function_->value(design, tolerance);
    known.hasValue = isKnown_ = true;
    known.valueTolerance = tolerance;
    largest_ = std::max(largest_, std::abs(known.value));
  } catch (const sensitivity::RefusedDesign& error) {
    refuse(known, error.what());
    if (!isKnown_) {
      error_ = std::current_exception();
      throw;
    }
  } catch (...) {
    error_ = std::current_exception();
    throw;
  }
  return known.value;
}

void GuardedFunction::refuse(Answer& known, const std::string& message) {
  if (!isRefused(known.design))
    ++refusals_->count;
  refusals_->message = message;
  refusals_->design = known.design;
  known.isRefused = true;
  known.value = farAbove * (1.0 + largest_);
}

const std::vector<double>& GuardedFunction::gradient(const std::vector<double>& design, double tolerance) {
  rethrow();
  requireNumbers(design);
  Answer& known = answer(design);
  if (known.hasGradient && suffices(known.gradientTolerance, tolerance))
    return known.gradient;
  try {
    ++gradients_;
    known.gradient = function_->gradient(design, tolerance);
    HARMOS_REQUIRE(known.gradient.size() == design.size(), "a gradient has other numbers than the design");
    known.hasGradient = true;
    known.gradientTolerance = tolerance;
  } catch (...) {
    error_ = std::current_exception();
    throw;
  }
  return known.gradient;
}

std::optional<double> GuardedFunction::knownValue(const std::vector<double>& design) const {
  for (const Answer& known : answers_)
    if (known.hasValue && known.design == design)
      return known.value;
  return std::nullopt;
}

} // namespace Harmos::rol
