// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Errors.hpp"

#include <string>
#include <vector>

namespace Harmos::sensitivity {

/// A design that has no answer: it tangles a mesh, or lifts a body off. Optimisers take a smaller step; where
/// it is the first design, the run ends. On all ranks.
class RefusedDesign : public InputError {
 public:
  using InputError::InputError;
};

/// The numbers of a design: where they begin, and between what.
struct DesignSpace {
  std::vector<double> start, lower, upper; ///< bounds may be infinite
  /// Diagonal of the inner product in which gradients are measured and steps are made: of a profile, the area
  /// of each number. All above zero.
  std::vector<double> weights;

  std::size_t size() const { return start.size(); }
  /// @throws InputError for lists of different lengths, bounds that cross, a start that is not between them,
  /// and weights that are not above zero. Local.
  void check() const;
};

/// A number that depends on a design, and its derivatives.
///
/// Designs and answers are the same, to the last bit, on all ranks: optimisers run on each of them.
class DesignFunction {
 public:
  virtual ~DesignFunction() = default;

  /// @param tolerance with which it is to be known, relative; 0: as usual.
  /// @throws RefusedDesign, and other errors that end the run, on all ranks. @note Collective.
  virtual double value(const std::vector<double>& design, double tolerance) = 0;
  /// dvalue/ddesign. Cheap right after value() of the same design. @throws likewise. @note Collective.
  virtual std::vector<double> gradient(const std::vector<double>& design, double tolerance) = 0;
};

/// A function that is kept between limits: of equal ones, at a value.
struct DesignConstraint {
  std::string name; ///< for messages: "volume"
  DesignFunction* function = nullptr;
  double lower = 0.0, upper = 0.0; ///< may be infinite
  bool isLinear = false;           ///< its gradient is the same for all designs

  bool isEquality() const { return lower == upper; }
};

/// What an optimiser is given. What it points to is to outlive the work.
struct DesignProblem {
  DesignSpace space;
  DesignFunction* cost = nullptr;
  std::vector<DesignConstraint> constraints;
};

} // namespace Harmos::sensitivity
