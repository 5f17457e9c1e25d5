// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Minimise.hpp"

#include "Harmos_DesignAdapters.hpp"
#include "Harmos_LinearLimits.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_RolOptions.hpp"

#include <ROL_ConstraintStatusTest.hpp>
#include <ROL_Solver.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <utility>

namespace Harmos::rol {

namespace {

using sensitivity::DesignConstraint;
using sensitivity::DesignProblem;
using sensitivity::DesignSpace;

// Ends a run from within; no error.
struct Ended {
  Ending ending;
};

// Tells of the designs that a method accepts: its state lacks those of the methods that it calls.
class WatchedObjective : public DesignObjective {
 public:
  using DesignObjective::DesignObjective;
  using DesignObjective::update;

  // ROL projects the start anew, which turns its last bits: for that nothing is computed again.
  void watch(const ROL::Vector<double>& start, std::function<void(const std::vector<double>&)> accepted) {
    start_ = start.clone();
    start_->set(start);
    difference_ = start.clone();
    accepted_ = std::move(accepted);
  }

  double value(const ROL::Vector<double>& design, double& tolerance) override {
    return DesignObjective::value(isStart(design) ? *start_ : design, tolerance);
  }

  void update(const ROL::Vector<double>& design, ROL::UpdateType type, int) override {
    const bool isAccepted = type == ROL::UpdateType::Initial || type == ROL::UpdateType::Accept;
    if (accepted_ && isAccepted && !function().isRefused(numbersOf(design)))
      accepted_(numbersOf(isStart(design) ? *start_ : design));
  }

  void gradient(ROL::Vector<double>& derivative, const ROL::Vector<double>& design,
                double& tolerance) override {
    // Line searches take the last trial where none was good enough.
    if (function().isRefused(numbersOf(design)))
      throw Ended{Ending::Refused};
    DesignObjective::gradient(derivative, isStart(design) ? *start_ : design, tolerance);
  }

 private:
  bool isStart(const ROL::Vector<double>& design) {
    if (start_ == ROL::nullPtr)
      return false;
    difference_->set(design);
    difference_->axpy(-1.0, *start_);
    return difference_->norm() < 1e-12;
  }

  ROL::Ptr<ROL::Vector<double>> start_, difference_;
  std::function<void(const std::vector<double>&)> accepted_;
};

class CallbackTest : public ROL::StatusTest<double> {
 public:
  explicit CallbackTest(std::function<bool(ROL::AlgorithmState<double>&)> check) : check_(std::move(check)) {}
  bool check(ROL::AlgorithmState<double>& state) override { return check_(state); }

 private:
  std::function<bool(ROL::AlgorithmState<double>&)> check_;
};

// What a design may change by: the diagonal of the box. Numbers without two bounds count by where they begin.
double extentOf(const DesignSpace& space) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t k = 0; k < space.size(); ++k) {
    const double width = space.upper[k] - space.lower[k];
    const double extent = std::isfinite(width) ? width : space.start[k];
    sum += space.weights[k] * extent * extent;
    weights += space.weights[k];
  }
  return std::sqrt(sum > 0.0 ? sum : weights);
}

double dualNorm(const std::vector<double>& derivative, const std::vector<double>& weights) {
  double sum = 0.0;
  for (std::size_t k = 0; k < derivative.size(); ++k)
    sum += derivative[k] * derivative[k] / weights[k];
  return std::sqrt(sum);
}

void checkProblem(const DesignProblem& problem) {
  problem.space.check();
  HARMOS_REQUIRE(problem.cost != nullptr, "a design problem without a cost");
  std::set<std::string> names;
  for (const auto& constraint : problem.constraints) {
    HARMOS_REQUIRE(constraint.function != nullptr,
                   "the constraint \"" + constraint.name + "\" has no function");
    if (!names.insert(constraint.name).second)
      throw InputError("two constraints have the name \"" + constraint.name + "\"");
    if (!(constraint.lower <= constraint.upper))
      throw InputError("constraint \"" + constraint.name + "\": its lower limit, " +
                       scientific(constraint.lower) + ", exceeds the upper limit, " +
                       scientific(constraint.upper));
  }
}

// A constraint as ROL has it, in units of what it changes over the whole of the design space.
struct Limit {
  const DesignConstraint* constraint;
  std::unique_ptr<AffineFunction> affine; // where it is linear
  ROL::Ptr<DesignLimit> limit;
  double factor = 1.0;
};

// One minimisation. ROL works in units without dimension: designs in those of the box's diagonal, the cost so
// that the first step along its gradient has a given length; its radii, first steps and tolerances then mean
// the same for all problems.
class Search {
 public:
  Search(const DesignProblem& problem, const Teuchos::ParameterList& options, const Monitor& monitor,
         double firstStep);
  Outcome run();

 private:
  void makeLimits();
  void addLimit(Limit& limit);
  void makeProblem();
  void project(ROL::Vector<double>& design);
  void start();
  void scaleCost();
  void scaleTolerances();
  bool check(ROL::AlgorithmState<double>& state);
  void accept(const std::vector<double>& design);
  bool tell(Iterate iterate);
  Iterate iterateOf(const ROL::AlgorithmState<double>& state);
  double violation(const std::vector<double>& design);
  void solve();
  void rethrowErrors() const;
  Outcome outcome();
  std::string reason() const;

  const DesignProblem& problem_;
  const Monitor& monitor_;
  double firstStep_, extent_;
  bool isNonlinear_;
  Teuchos::ParameterList options_;
  Tolerances tolerances_;
  std::vector<double> weights_; // of the inner product in units of the box
  std::vector<Limit> limits_;
  std::shared_ptr<Refusals> refusals_ = std::make_shared<Refusals>();
  ROL::Ptr<WatchedObjective> cost_;
  ROL::Ptr<ROL::Vector<double>> design_;
  ROL::Ptr<ROL::Problem<double>> rol_;
  ROL::nullstream silence_;
  double factor_ = 1.0; // of the cost
  ROL::Ptr<ROL::StatusTest<double>> test_;
  std::vector<double> accepted_;
  bool isNew_ = false;    // accepted_, since the last check
  int refusedBefore_ = 0; // until the last step that was not too short
  Iterate last_, best_;
  Ending ending_ = Ending::NoNumber;
  std::exception_ptr error_; // the monitor's
};

Search::Search(const DesignProblem& problem, const Teuchos::ParameterList& options, const Monitor& monitor,
               double firstStep)
    : problem_(problem),
      monitor_(monitor),
      firstStep_(firstStep),
      isNonlinear_(std::any_of(problem.constraints.begin(), problem.constraints.end(),
                               [](const DesignConstraint& constraint) { return !constraint.isLinear; })),
      options_(completeOptions(options, isNonlinear_)) {
  checkProblem(problem);
  if (!(firstStep > 0.0))
    throw InputError("the first step of a minimisation must be positive, not " + scientific(firstStep));
  extent_ = extentOf(problem.space);
  weights_ = problem.space.weights;
  for (double& weight : weights_)
    weight /= extent_ * extent_;
  auto& general = options_.sublist("General");
  tolerances_ = general.get("Inexact Objective Function", false) || general.get("Inexact Gradient", false)
                    ? Tolerances::AsAsked
                    : Tolerances::AsUsual;
}

void Search::makeLimits() {
  const auto& space = problem_.space;
  for (const auto& constraint : problem_.constraints) {
    Limit limit;
    limit.constraint = &constraint;
    auto* function = constraint.function;
    if (constraint.isLinear) {
      limit.affine = std::make_unique<AffineFunction>(*function, space.start);
      checkReach(constraint, *limit.affine, space);
      function = limit.affine.get();
    }
    const double slope = dualNorm(function->gradient(space.start, 0.0), weights_);
    if (slope == 0.0 && constraint.isLinear)
      throw InputError("the constraint \"" + constraint.name + "\" does not depend on the design");
    limit.factor = slope > 0.0 ? 1.0 / slope : 1.0;
    const double origin = std::isfinite(constraint.lower) ? constraint.lower : constraint.upper;
    limit.limit =
        ROL::makePtr<DesignLimit>(*function, constraint.isLinear ? Tolerances::AsUsual : tolerances_,
                                  limit.factor, std::isfinite(origin) ? origin : 0.0, refusals_);
    limits_.push_back(std::move(limit));
  }
}

void Search::addLimit(Limit& limit) {
  const auto& constraint = *limit.constraint;
  const auto multiplier = makeNumber(0.0);
  const double origin = std::isfinite(constraint.lower) ? constraint.lower : constraint.upper;
  if (!std::isfinite(constraint.lower) && !std::isfinite(constraint.upper))
    return; // nothing to keep
  if (constraint.isEquality()) {
    if (constraint.isLinear)
      rol_->addLinearConstraint(constraint.name, limit.limit, multiplier);
    else
      rol_->addConstraint(constraint.name, limit.limit, multiplier);
    return;
  }
  const auto bounds =
      rol::makeLimits(limit.factor * (constraint.lower - origin), limit.factor * (constraint.upper - origin));
  if (constraint.isLinear)
    rol_->addLinearConstraint(constraint.name, limit.limit, multiplier, bounds);
  else
    rol_->addConstraint(constraint.name, limit.limit, multiplier, bounds);
}

void Search::makeProblem() {
  const auto& space = problem_.space;
  cost_ = ROL::makePtr<WatchedObjective>(*problem_.cost, tolerances_, refusals_);
  design_ = makeDesign(space.start, weights_);
  rol_ = ROL::makePtr<ROL::Problem<double>>(cost_, design_,
                                            makeDerivative(std::vector<double>(space.size(), 0.0), weights_));
  rol_->addBoundConstraint(makeBounds(space.lower, space.upper, weights_));
  for (auto& limit : limits_)
    addLimit(limit);
  auto& projection = options_.sublist("General").sublist("Polyhedral Projection");
  if (!projection.isParameter("Type")) {
    const auto linear = std::count_if(limits_.begin(), limits_.end(),
                                      [](const Limit& limit) { return limit.constraint->isLinear; });
    projection.set("Type", linear == 1 ? "Dai-Fletcher" : "Semismooth Newton");
  }
  rol_->setProjectionAlgorithm(options_);
  rol_->finalize(false, false, silence_);
}

void Search::project(ROL::Vector<double>& design) {
  const auto& projection = rol_->getPolyhedralProjection();
  if (projection != ROL::nullPtr)
    projection->project(design, silence_);
  else
    rol_->getBoundConstraint()->project(design);
}

void Search::start() {
  project(*rol_->getPrimalOptimizationVector());
  for (const auto& limit : limits_)
    if (limit.constraint->isLinear && violation(numbersOf(*design_)) > 1e-6)
      throw InputError("no design within the bounds satisfies all constraints: the design nearest to the "
                       "start violates \"" +
                       limit.constraint->name + "\"");
  scaleCost();
}

void Search::scaleCost() {
  auto& design = *rol_->getPrimalOptimizationVector();
  auto& objective = *rol_->getObjective();
  double tolerance = std::sqrt(ROL::ROL_EPSILON<double>());
  objective.value(design, tolerance);
  const auto derivative = rol_->getDualOptimizationVector()->clone();
  objective.gradient(*derivative, design, tolerance);
  const double norm = derivative->norm();
  if (!(norm > 0.0) || !std::isfinite(norm))
    return;
  factor_ = firstStep_ / norm;
  // Bounds and constraints may hold the most of that step. At an optimum they hold all of it: not beyond 1e4.
  const auto step = design.clone();
  for (int k = 0; k < 4; ++k) {
    step->set(design);
    step->axpy(-factor_, derivative->dual());
    project(*step);
    step->axpy(-1.0, design);
    const double length = step->norm();
    if (length > 0.5 * firstStep_ || !(length > 0.0))
      break;
    factor_ *= std::min(10.0, firstStep_ / length);
  }
  cost_->setFactor(factor_);
}

void Search::scaleTolerances() {
  auto& status = options_.sublist("Status Test");
  const bool isRelative = status.get<bool>("Use Relative Tolerances");
  status.set("Gradient Tolerance",
             status.get<double>("Gradient Tolerance") * (isRelative ? firstStep_ : factor_ * extent_));
  status.set("Step Tolerance", status.get<double>("Step Tolerance") / (isRelative ? 1.0 : extent_));
  status.set("Use Relative Tolerances", false);
  if (isNonlinear_)
    test_ = ROL::makePtr<ROL::ConstraintStatusTest<double>>(options_);
  else
    test_ = ROL::makePtr<ROL::StatusTest<double>>(options_);
}

double Search::violation(const std::vector<double>& design) {
  double result = 0.0;
  for (const auto& limit : limits_) {
    const auto& constraint = *limit.constraint;
    const auto known = limit.limit->function().knownValue(design);
    const double value = limit.affine ? limit.affine->value(design)
                         : known      ? *known
                                      : limit.limit->function().value(design, 0.0);
    result = std::max(result, limit.factor * std::max(constraint.lower - value, value - constraint.upper));
  }
  return result;
}

Iterate Search::iterateOf(const ROL::AlgorithmState<double>& state) {
  Iterate result;
  result.iteration = state.iter;
  result.cost = state.value / factor_;
  result.gradientNorm = state.gnorm / (factor_ * extent_);
  result.violation = violation(accepted_);
  result.step = state.iter == 0 ? 0.0 : state.snorm * extent_;
  result.design = accepted_;
  return result;
}

bool Search::tell(Iterate iterate) {
  iterate.values = cost_->function().values();
  iterate.gradients = cost_->function().gradients();
  try {
    return !monitor_ || monitor_(iterate);
  } catch (...) {
    error_ = std::current_exception();
    throw;
  }
}

void Search::accept(const std::vector<double>& design) {
  accepted_ = design;
  isNew_ = true;
  const auto cost = cost_->function().knownValue(design);
  if (!isNonlinear_ || !cost || last_.design.empty() || last_.design == design)
    return; // the test after each iteration tells of it
  Iterate inner = last_;
  inner.isInner = true;
  inner.design = design;
  inner.cost = *cost;
  inner.violation = violation(design);
  if (!tell(inner)) {
    last_ = inner;
    throw Ended{Ending::Stopped};
  }
}

bool Search::check(ROL::AlgorithmState<double>& state) {
  const bool isNumber = std::isfinite(state.value) && std::isfinite(state.gnorm) && !std::isnan(state.snorm);
  const bool isNew = isNew_;
  if (isNew || last_.design.empty()) {
    last_ = iterateOf(state);
    if (!isNumber)
      throw Ended{Ending::NoNumber};
    if (best_.design.empty() || last_.cost < best_.cost)
      best_ = last_;
    isNew_ = false;
    if (!tell(last_))
      throw Ended{Ending::Stopped};
  }
  last_.iteration = state.iter;
  if (test_->check(state)) {
    if (isNew)
      refusedBefore_ = refusals_->count;
    return true;
  }
  ending_ = state.statusFlag == ROL::EXITSTATUS_CONVERGED ? Ending::Converged
            : state.statusFlag == ROL::EXITSTATUS_STEPTOL ? Ending::StepTolerance
            : state.statusFlag == ROL::EXITSTATUS_MAXITER ? Ending::IterationLimit
                                                          : Ending::NoNumber;
  if (ending_ == Ending::StepTolerance && refusals_->count > refusedBefore_)
    ending_ = Ending::Refused;
  return false;
}

void Search::rethrowErrors() const {
  std::exception_ptr error = error_ ? error_ : cost_->function().error();
  for (const auto& limit : limits_)
    if (!error)
      error = limit.limit->function().error();
  if (error)
    std::rethrow_exception(error);
}

Outcome Search::run() {
  makeLimits();
  makeProblem();
  start();
  scaleTolerances();
  cost_->watch(*design_, [this](const std::vector<double>& design) { accept(design); });
  solve();
  return outcome();
}

void Search::solve() {
  try {
    ROL::Solver<double> solver(rol_, options_);
    solver.solve(silence_, ROL::makePtr<CallbackTest>([this](auto& state) { return check(state); }), false);
  } catch (const Ended& ended) {
    ending_ = ended.ending;
  } catch (const std::exception& error) {
    rethrowErrors();
    throw InputError(
        std::string("ROL cannot solve this problem with this method (Step/Type and its parameters): ") +
        error.what());
  } catch (...) {
    rethrowErrors();
    throw;
  }
  rethrowErrors(); // one that ROL kept to itself
}

Outcome Search::outcome() {
  // Methods may go uphill for a while; where constraints are met by the end alone, the end it is.
  const Iterate& end = ending_ == Ending::Converged || isNonlinear_ || best_.design.empty() ? last_ : best_;
  Outcome result;
  result.design = end.design;
  result.cost = end.cost;
  result.gradientNorm = end.gradientNorm;
  for (const auto& limit : limits_) {
    const auto& constraint = *limit.constraint;
    const auto known = limit.affine ? std::nullopt : limit.limit->function().knownValue(end.design);
    const double value = known ? *known : constraint.function->value(end.design, 0.0);
    result.constraints.push_back(value);
    result.violation = std::max(result.violation,
                                limit.factor * std::max(constraint.lower - value, value - constraint.upper));
    // Rounding and projections stay far below.
    if (limit.affine && limit.factor * std::abs(value - limit.affine->value(end.design)) > 1e-6)
      ending_ = Ending::Missed;
  }
  result.iterations = last_.iteration;
  result.values = cost_->function().values();
  result.gradients = cost_->function().gradients();
  result.refused = refusals_->count;
  result.refusal = refusals_->message;
  result.ending = ending_;
  result.reason = reason();
  return result;
}

std::string Search::reason() const {
  switch (ending_) {
  case Ending::Converged:
    return "the gradient is below its tolerance";
  case Ending::StepTolerance:
    return "steps became shorter than \"Step Tolerance\" before the gradient reached its tolerance: the cost "
           "is not smooth here or its derivatives are too inaccurate. Use a smaller solver tolerance or "
           "raise \"Gradient Tolerance\" (Status Test)";
  case Ending::IterationLimit:
    return "the limit of " + std::to_string(options_.sublist("Status Test").get<int>("Iteration Limit")) +
           " iterations was reached; raise \"Iteration Limit\" (Status Test) or start from the design found";
  case Ending::Refused:
    return "each step from here leads to a rejected design (" + refusals_->message +
           "); tighten the bounds of the design to exclude such designs";
  case Ending::Missed:
    return "a constraint declared linear is nonlinear; declare it nonlinear";
  case Ending::Stopped:
    return "stopped from outside; start from the design found to continue";
  case Ending::NoNumber:
    break;
  }
  return "a cost, gradient or step is not a number; check the function at the design";
}

} // namespace

Outcome minimise(const sensitivity::DesignProblem& problem, const Teuchos::ParameterList& options,
                 const Monitor& monitor, double firstStep) {
  return Search(problem, options, monitor, firstStep).run();
}

} // namespace Harmos::rol
