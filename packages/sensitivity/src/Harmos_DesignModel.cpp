// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DesignModel.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <chrono>

namespace Harmos::sensitivity {
namespace {

class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds), begin_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point begin_;
};

bool isUnheld(const feti::FetiSolver& solver, const feti::SolveReport& report) {
  const qp::Reason reason = report.result.reason;
  return !solver.hasSolution() || reason == qp::Reason::Infeasible || reason == qp::Reason::Unbounded;
}

} // namespace

ContactCost::ContactCost(feti::FetiSolver& solver, DesignModel& model, const Functional& functional,
                         double sign)
    : solver_(solver), model_(model), functional_(functional), sign_(sign) {}

double ContactCost::tolerated(double tolerance) const {
  return std::max(tolerance, solver_.tolerance());
}

void ContactCost::solve(const std::vector<double>& design, double tolerance) {
  if (design == design_ && reached_ <= tolerance)
    return;
  const Stopwatch stopwatch(spent_.valueSeconds);
  design_.clear();
  sensitivities_.reset();
  model_.apply(design);
  report_ = solver_.solve(tolerance);
  ++spent_.values;
  spent_.products += report_.result.counters.hessianApplications;
  if (!report_.converged && isUnheld(solver_, report_))
    throw RefusedDesign("with this design the bodies have an unconstrained rigid-body mode: " +
                        report_.reason);
  if (!report_.converged)
    throw NumericalError("the solver did not converge for a design: " + report_.reason);
  forces_ = solver_.rowForces();
  design_ = design;
  reached_ = tolerance;
}

double ContactCost::value(const std::vector<double>& design, double tolerance) {
  solve(design, tolerated(tolerance));
  return sign_ * functional_.value(response());
}

std::vector<double> ContactCost::gradient(const std::vector<double>& design, double tolerance) {
  solve(design, tolerated(tolerance));
  const Stopwatch stopwatch(spent_.gradientSeconds);
  if (!sensitivities_)
    sensitivities_ = std::make_unique<Sensitivities>(solver_, model_.rows());
  const int before = sensitivities_->products();
  const Functional::Adjoint adjoint =
      sensitivities_->adjoint(functional_, response(), tolerated(tolerance), model_.needsDisplacement());
  ++spent_.gradients;
  spent_.adjointProducts += sensitivities_->products() - before;
  std::vector<double> gradient = model_.gradient(functional_, response(), adjoint);
  for (double& entry : gradient)
    entry *= sign_;
  return gradient;
}

} // namespace Harmos::sensitivity
