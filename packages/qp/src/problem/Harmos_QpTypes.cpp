// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_QpTypes.hpp"

#include <iomanip>
#include <ostream>
#include <utility>

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
  case Reason::Interrupted:
    return "interrupted";
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

namespace {

constexpr int Counters::*counterFields[] = {&Counters::outerIterations,
                                            &Counters::hessianApplications,
                                            &Counters::setupApplications,
                                            &Counters::cgSteps,
                                            &Counters::expansionSteps,
                                            &Counters::proportioningSteps,
                                            &Counters::faces,
                                            &Counters::fallbacks,
                                            &Counters::stepCuts,
                                            &Counters::confirmations,
                                            &Counters::activeSetUpdates,
                                            &Counters::descents,
                                            &Counters::safeguards,
                                            &Counters::preconditionerApplications,
                                            &Counters::preconditionerSetups};

constexpr std::size_t recordLength = 11;

} // namespace

Counters& Counters::operator+=(const Counters& other) {
  for (int Counters::*field : counterFields)
    this->*field += other.*field;
  return *this;
}

std::vector<double> toNumbers(const Counters& counters) {
  std::vector<double> numbers;
  for (int Counters::*field : counterFields)
    numbers.push_back(counters.*field);
  return numbers;
}

Counters countersOf(const std::vector<double>& numbers) {
  Counters counters;
  std::size_t k = 0;
  for (int Counters::*field : counterFields)
    counters.*field = static_cast<int>(numbers.at(k++));
  return counters;
}

std::vector<double> toNumbers(const std::vector<IterationRecord>& history) {
  std::vector<double> numbers;
  numbers.reserve(recordLength * history.size());
  for (const IterationRecord& r : history)
    for (double value :
         {static_cast<double>(r.outer), static_cast<double>(r.inner), static_cast<double>(r.step),
          r.projectedGradient, r.equalityResidual, r.penalty, r.precision, static_cast<double>(r.active),
          static_cast<double>(r.hessianApplications), r.seconds, r.decrease})
      numbers.push_back(value);
  return numbers;
}

std::vector<IterationRecord> historyOf(const std::vector<double>& numbers) {
  std::vector<IterationRecord> history;
  for (std::size_t k = 0; k + recordLength <= numbers.size(); k += recordLength) {
    const double* v = numbers.data() + k;
    history.push_back({static_cast<int>(v[0]), static_cast<int>(v[1]),
                       static_cast<StepKind>(static_cast<int>(v[2])), v[3], v[4], v[5], v[6],
                       static_cast<long long>(v[7]), static_cast<int>(v[8]), v[9], v[10]});
  }
  return history;
}

void writeHistoryHeader(std::ostream& out) {
  out << "outer,inner,step,projected_gradient,equality_residual,penalty,M,active,hessian_applications,"
         "seconds\n";
}

void writeHistoryRow(std::ostream& out, const IterationRecord& record) {
  out << std::setprecision(17) << record.outer << ',' << record.inner << ',' << toString(record.step) << ','
      << record.projectedGradient << ',' << record.equalityResidual << ',' << record.penalty << ','
      << record.precision << ',' << record.active << ',' << record.hessianApplications << ','
      << std::setprecision(6) << record.seconds << '\n';
}

IterationRecord countedOn(const IterationRecord& row, const IterationRecord& before) {
  IterationRecord result = row;
  result.outer += before.outer;
  result.inner += before.inner;
  result.hessianApplications += before.hessianApplications;
  result.seconds += before.seconds;
  return result;
}

void Result::goesOnAfter(const Result& before) {
  std::vector<IterationRecord> all = before.history;
  for (const IterationRecord& row : history)
    all.push_back(countedOn(row, before.lastRecord()));
  history = std::move(all);
  counters += before.counters;
}

void writeHistory(std::ostream& out, const std::vector<IterationRecord>& history) {
  writeHistoryHeader(out);
  for (const IterationRecord& record : history)
    writeHistoryRow(out, record);
}

} // namespace Harmos::qp
