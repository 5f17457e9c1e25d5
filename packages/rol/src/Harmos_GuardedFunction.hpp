// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DesignProblem.hpp"

#include <array>
#include <exception>
#include <string>
#include <vector>

namespace Harmos::rol {

/// A function of designs as ROL may ask for it: what is known is not computed again, and what is thrown is not
/// lost.
///
/// ROL asks for the value of a trial, then for the gradient of the same design, and some of its methods ask again
/// where they begin anew: answers of the last two designs are kept. ROL 13.2 catches std::exception where it looks for
/// a scaling of constraints (TypeG::AugmentedLagrangianAlgorithm::initialize()): after an error each further call
/// throws the same one, and error() has it. Guarded by tests/unit/rol/test_adapters.cpp.
class GuardedFunction {
 public:
  /// @param function must outlive this.
  explicit GuardedFunction(sensitivity::DesignFunction& function) : function_(&function) {}

  /// A design that is refused (sensitivity::RefusedDesign) has a value that is far above all so far, but finite:
  /// line searches and trust regions of ROL then take a shorter step; they do not stand infinities and NaN.
  /// @param tolerance relative; 0: as usual.
  /// @throws sensitivity::RefusedDesign while no design has a value; what the function throws. @note Collective.
  double value(const std::vector<double>& design, double tolerance);
  /// @throws what the function throws. @note Collective.
  const std::vector<double>& gradient(const std::vector<double>& design, double tolerance);

  /// Whether this design was refused lately.
  bool isRefused(const std::vector<double>& design) const;

  int values() const { return values_; }
  int gradients() const { return gradients_; }
  int refused() const { return refused_; }
  const std::string& refusal() const { return refusal_; } ///< the last one's message
  std::exception_ptr error() const { return error_; }     ///< null for none

 private:
  struct Answer {
    std::vector<double> design;
    bool hasValue = false, hasGradient = false, isRefused = false;
    double value = 0.0, valueTolerance = 0.0, gradientTolerance = 0.0;
    std::vector<double> gradient;
  };

  Answer& answer(const std::vector<double>& design);
  void rethrow() const;

  sensitivity::DesignFunction* function_;
  std::array<Answer, 2> answers_; // the one that was asked for last comes first
  double largest_ = 0.0;          // magnitude of values
  int values_ = 0, gradients_ = 0, refused_ = 0;
  bool isKnown_ = false; // some value
  std::string refusal_;
  std::exception_ptr error_;
};

} // namespace Harmos::rol
