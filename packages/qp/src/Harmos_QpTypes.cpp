// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_QpTypes.hpp"

#include <iomanip>
#include <ostream>

namespace Harmos::qp {

std::string toString(Reason reason) {
  switch (reason) {
  case Reason::Converged:
    return "converged";
  case Reason::IterationLimit:
    return "iteration limit";
  case Reason::TimeLimit:
    return "time limit";
  case Reason::Infeasible:
    return "infeasible";
  case Reason::Stagnation:
    return "stagnation at attainable accuracy";
  case Reason::Unbounded:
    return "unbounded";
  case Reason::Breakdown:
    return "breakdown";
  }
  return "";
}

std::string toString(StepKind kind) {
  switch (kind) {
  case StepKind::Start:
    return "start";
  case StepKind::ConjugateGradient:
    return "cg";
  case StepKind::Expansion:
    return "expansion";
  case StepKind::Proportioning:
    return "proportioning";
  case StepKind::Projected:
    return "pcpg";
  case StepKind::ActiveSet:
    return "active set";
  }
  return "";
}

Counters& Counters::operator+=(const Counters& other) {
  for (int Counters::*field :
       {&Counters::outerIterations, &Counters::hessianApplications, &Counters::setupApplications,
        &Counters::cgSteps, &Counters::expansionSteps, &Counters::proportioningSteps, &Counters::faces,
        &Counters::fallbacks, &Counters::stepCuts, &Counters::confirmations, &Counters::activeSetUpdates,
        &Counters::safeguards, &Counters::preconditionerApplications, &Counters::preconditionerSetups})
    this->*field += other.*field;
  return *this;
}

void writeHistory(std::ostream& out, const std::vector<IterationRecord>& history) {
  out << "outer,inner,step,projected_gradient,equality_residual,penalty,M,active,hessian_applications,"
         "seconds\n"
      << std::setprecision(17);
  for (const IterationRecord& record : history)
    out << record.outer << ',' << record.inner << ',' << toString(record.step) << ','
        << record.projectedGradient << ',' << record.equalityResidual << ',' << record.penalty << ','
        << record.precision << ',' << record.active << ',' << record.hessianApplications << ','
        << std::setprecision(6) << record.seconds << std::setprecision(17) << '\n';
}

} // namespace Harmos::qp
