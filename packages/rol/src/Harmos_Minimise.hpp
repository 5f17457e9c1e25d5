// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DesignProblem.hpp"

#include <Teuchos_ParameterList.hpp>

#include <functional>
#include <string>
#include <vector>

namespace Harmos::rol {

/// Where a minimisation is: a design that ROL has accepted.
struct Iterate {
  int iteration = 0; ///< ROL's; steps that it took back are counted, too
  double cost = 0.0;
  /// √(Σ d²/weights), d the derivatives of the cost without what bounds and linear constraints hold, as ROL
  /// measures it: the projected step along the negative gradient. In units of cost/design.
  double gradientNorm = 0.0;
  /// The most by which a constraint is missed, as part of what it changes over the whole of the design space.
  double violation = 0.0;
  double step = 0.0;             ///< √(Σ weights·step²); 0 for the first
  int values = 0, gradients = 0; ///< of the cost, until now
  /// An iterate of the method that the one for constraints that are not linear calls: iteration, gradientNorm
  /// and step are those of the last outer one.
  bool isInner = false;
  std::vector<double> design;
};

/// Told of each accepted iterate, the first included; false stops. The same answer on all ranks.
using Monitor = std::function<bool(const Iterate&)>;

enum class Ending {
  Converged,
  StepTolerance,
  IterationLimit,
  Refused, ///< all steps from the last design led to designs that are refused
  Missed,  ///< a constraint that is said to be linear, and is not
  Stopped, ///< by the monitor
  NoNumber ///< a cost, gradient or step that is no number
};

struct Outcome {
  std::vector<double> design;
  double cost = 0.0, gradientNorm = 0.0, violation = 0.0; ///< as in Iterate
  std::vector<double> constraints;                        ///< values, in their order
  int iterations = 0, values = 0, gradients = 0;
  int refused = 0;     ///< designs that had no answer
  std::string refusal; ///< the last one's message
  Ending ending = Ending::Converged;
  std::string reason; ///< a sentence: why it ended, and what to do

  bool isConverged() const { return ending == Ending::Converged; }
};

/// Minimises the cost of a design between its bounds, under constraints, by ROL (ROL::Problem, ROL::Solver).
///
/// Bounds and linear constraints are met by each design that is asked for (polyhedral projections);
/// constraints that are not linear by the end alone. ROL works without dimensions: designs in units of the
/// diagonal of the box, √(Σ weights (upper − lower)²), constraints in units of what they change over it, and
/// the cost such that the first step along its gradient is `firstStep` of the diagonal: radii and first steps
/// of ROL are lengths of steps, and what it is given does not depend on units. Numbers of a design that lack
/// a bound count there by where they begin.
///
/// Linear functions are asked for their value and gradient at the start, and for their value at the end.
/// The cost of a trial is asked for once, its gradient only where ROL accepts it. All is the same, to the
/// last bit, in two runs whose functions give the same answers. ROL prints nothing.
///
/// A design that is refused (sensitivity::RefusedDesign) counts as far worse than all before: ROL takes a
/// shorter step. If it is the first one that is asked for, the error goes through. So do all other errors of
/// functions and monitor, unchanged.
/// @param options ROL's parameters (Step, General, Status Test), over those of defaultOptions().
/// @param firstStep see above; a start that is nearly optimal wants less.
/// @throws InputError for options that ROL does not have, a problem that makes no sense, linear constraints
/// that no design between the bounds meets (alone or together), and methods that ROL has, but not for such a
/// problem.
/// @note Collective, if the functions are. Guarded by tests/unit/rol/test_minimise.cpp, test_constraints.cpp
/// and test_refusals.cpp.
Outcome minimise(const sensitivity::DesignProblem& problem, const Teuchos::ParameterList& options = {},
                 const Monitor& monitor = {}, double firstStep = 0.1);

} // namespace Harmos::rol
