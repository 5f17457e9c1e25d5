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
  /// √(Σ d²/weights), d the derivatives of the cost without what bounds and linear constraints hold, as ROL measures
  /// it: the projected step along the negative gradient. In units of cost/design.
  double gradientNorm = 0.0;
  /// The most by which a constraint is missed, as part of what it changes over the whole of the design space.
  double violation = 0.0;
  double step = 0.0; ///< √(Σ weights·step²); 0 for the first
  int values = 0, gradients = 0; ///< of the cost, until now
  /// An iterate of the method that the one for constraints that are not linear calls: iteration, gradientNorm and step
  /// are those of the last outer one.
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
Outcome minimise(const sensitivity::DesignProblem& problem, const Teuchos::ParameterList& options = {},
                 const Monitor& monitor = {}, double firstStep = 0.1);

} // namespace Harmos::rol
