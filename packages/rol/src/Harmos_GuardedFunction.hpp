// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DesignProblem.hpp"

#include <array>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::rol {

/// Designs that were refused, by one function or by several of one problem: each counts once.
struct Refusals {
  int count = 0;
  std::string message; ///< of the last
  std::vector<double> design;
};

/// A function of designs as ROL may ask for it: what is known is not computed again, and what is thrown is
/// not lost.
///
/// ROL asks for the value of a trial, then for the gradient of the same design, and some of its methods ask
/// again where they begin anew: answers of the last two designs are kept. ROL 13.2 catches std::exception
/// where it looks for a scaling of constraints (TypeG::AugmentedLagrangianAlgorithm::initialize()): after an
/// error each further call throws the same one, and error() has it. Guarded by
/// tests/unit/rol/test_adapters.cpp.
class GuardedFunction {
 public:
  /// @param function must outlive this. @param refusals where they are counted; null for a record of its own.
  explicit GuardedFunction(sensitivity::DesignFunction& function,
                           std::shared_ptr<Refusals> refusals = nullptr);

  /// A design that is refused (sensitivity::RefusedDesign) has a value that is far above all so far, but
  /// finite: line searches and trust regions of ROL then take a shorter step; they do not stand infinities
  /// and NaN.
  /// @param tolerance relative; 0: as usual.
  /// @throws sensitivity::RefusedDesign while no design has a value; InputError for a design that is no
  /// number; what the function throws. @note Collective.
  double value(const std::vector<double>& design, double tolerance);
  /// @throws what the function throws. @note Collective.
  const std::vector<double>& gradient(const std::vector<double>& design, double tolerance);

  /// The value, if it was asked for lately.
  std::optional<double> knownValue(const std::vector<double>& design) const;
  /// Whether this design is the last one that was refused, by a function with the same record.
  bool isRefused(const std::vector<double>& design) const {
    return refusals_->count > 0 && refusals_->design == design;
  }

  int values() const { return values_; } ///< times that the function was asked
  int gradients() const { return gradients_; }
  const Refusals& refusals() const { return *refusals_; }
  std::exception_ptr error() const { return error_; } ///< null for none

 private:
  struct Answer {
    std::vector<double> design;
    bool hasValue = false, hasGradient = false, isRefused = false;
    double value = 0.0, valueTolerance = 0.0, gradientTolerance = 0.0;
    std::vector<double> gradient;
  };

  Answer& answer(const std::vector<double>& design);
  void refuse(Answer& known, const std::string& message);
  void requireNumbers(const std::vector<double>& design);
  void rethrow() const;

  sensitivity::DesignFunction* function_;
  std::array<Answer, 2> answers_; // the one that was asked for last comes first
  double largest_ = 0.0;          // magnitude of values
  int values_ = 0, gradients_ = 0;
  bool isKnown_ = false; // some value
  std::shared_ptr<Refusals> refusals_;
  std::exception_ptr error_;
};

} // namespace Harmos::rol
