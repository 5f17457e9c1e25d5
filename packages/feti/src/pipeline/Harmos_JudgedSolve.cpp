// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_JudgedSolve.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>

namespace Harmos::feti {
namespace {

const char* const contradiction =
    "the residuals of the dual problem reached their rounding level, but the audit of displacements and "
    "forces contradicts them. Likely causes are single precision, material jumps of many orders of magnitude "
    "or slender bodies; use fewer subdomains or \"Dual operator/Precision\" = \"double\"";

} // namespace

JudgedSolve::JudgedSolve(DualPipeline& pipeline, Stages stages, const SolverOptions& options,
                         AnswerCriteria criteria, const Log& log, SolveReport& report, AnswerQuality& quality)
    : pipeline_(pipeline),
      makeStages_(std::move(stages)),
      options_(options),
      criteria_(std::move(criteria)),
      log_(log),
      report_(report),
      quality_(quality) {
  if (criteria_.rule == ToleranceRule::Balanced) {
    if (!criteria_.estimate)
      throw InputError("\"Solver/Tolerance rule\" = \"balanced\" needs an estimate of the discretisation "
                       "error; give one, or use \"fixed\"",
                       {{"path", "Solver/Tolerance rule"}});
    options_.tolerance = AnswerJudge::firstBalancedTolerance();
  }
  quality_.tolerance = options_.tolerance;
  stages_ = makeStages_();
}

const DualSolution& JudgedSolve::go(const WarmStart* start, const Teuchos::RCP<DualMonitor>& monitor) {
  solveOnce(start, monitor, {});
  if (roundingIsSeen_)
    solveInDoublePrecision(monitor);
  return solution_;
}

// Asked for less than what products were rounded to: more of the same brings nothing.
bool JudgedSolve::showsRounding(const Verdict& verdict) const {
  const double error = pipeline_.decided().inverses.productError;
  return (verdict.next && pipeline_.accuracy().roundedFactorizations > 0 && *verdict.next < 0.5 * error) ||
         (!verdict.next && pipeline_.decided().isSingle() &&
          (!auditAgrees(quality_) || forceExcess(quality_) > 1.0));
}

void JudgedSolve::solveOnce(const WarmStart* start, const Teuchos::RCP<DualMonitor>& monitor,
                            const qp::IterationRecord& spent) {
  roundingIsSeen_ = false;
  report_ = {};
  quality_.localDefect = pipeline_.accuracy().defect;
  const Precision precision = pipeline_.decided().inverses.precision;
  judge_.emplace(stages_, criteria_, pipeline_.scaling(), precision, log_, quality_);
  Acceptance acceptance;
  acceptance.judge = [&](const MultiVector& lambda, const std::vector<double>& mu, double tolerance) {
    const Verdict verdict = judge_->judge(lambda, mu, tolerance);
    roundingIsSeen_ = showsRounding(verdict);
    return roundingIsSeen_ ? Verdict() : verdict;
  };
  acceptance.iterationsBefore = spent.inner;
  acceptance.exchange = [&](qp::StateArchive<MultiVector>& archive) { judge_->exchange(archive); };
  SolverOptions options = options_;
  constexpr double leastSeconds = 1e-3; // 0 is no limit
  if (options.maximumSeconds > 0.0)
    options.maximumSeconds = std::max(leastSeconds, options.maximumSeconds - spent.seconds);
  {
    const auto scope = pipeline_.during(PipelineStage::Solve);
    solution_ = solveDualProblem(stages_, options, start, acceptance, log_, report_, monitor);
  }
  pipeline_.rethrowFailures();
}

// Slender bodies, whose pieces bend more when cut than the whole does, show rounding errors of products in
// the jumps that are left.
void JudgedSolve::solveInDoublePrecision(const Teuchos::RCP<DualMonitor>& monitor) {
  log_.info(std::string(pipeline_.decided().isSingle() ? "Single precision is"
                                                       : "Single-precision application of F is") +
            " too inaccurate for this problem: switch to double precision");
  const qp::Result first = report_.result;
  const WarmStart start = {stages_.problem->total(*solution_.lambda), solution_.mu};
  judge_.reset();
  stages_ = {};
  pipeline_.useDoublePrecision();
  stages_ = makeStages_();
  if (!monitor.is_null())
    monitor->goesOnAfter(first.lastRecord());
  solveOnce(&start, monitor, first.lastRecord());
  report_.result.goesOnAfter(first);
}

TornSolution JudgedSolve::go(SolutionHistory& history, double tolerance,
                             const Teuchos::RCP<DualMonitor>& monitor) {
  const std::optional<WarmStart> start = history.start(*stages_.problem, tolerance);
  go(start ? &*start : nullptr, monitor);
  if (solution_.isEscaping)
    report_.reason += "; unconstrained rigid-body mode under load: " + escapingSubdomains();
  TornSolution torn = recover();
  conclude();
  if (report_.converged)
    history.add(*stages_.problem, torn.multiplier, solution_.mu);
  return torn;
}

// "subdomains 4, 5, 6": whoever made them knows what bodies they are of.
std::string JudgedSolve::escapingSubdomains() const {
  constexpr std::size_t mostNamed = 20;
  const SubdomainSystem& system = *stages_.system;
  std::vector<long long> numbers;
  for (int i = 0; i < system.size(); ++i)
    numbers.push_back(system.subdomain(i).number);
  const std::vector<long long> parts =
      escapingParts(stages_.coarse->motions(), solution_.escape, numbers, system.globalSubdomains());
  std::string text = parts.size() == 1 ? "subdomain" : "subdomains";
  for (std::size_t k = 0; k < std::min(parts.size(), mostNamed); ++k)
    text += (k == 0 ? " " : ", ") + std::to_string(parts[k]);
  if (parts.size() > mostNamed)
    text += " and " + std::to_string(parts.size() - mostNamed) + " more";
  return text;
}

TornSolution JudgedSolve::recover() {
  return judge_->finish(*solution_.lambda, solution_.mu, report_.converged && !leavesJumps());
}

void JudgedSolve::conclude() {
  if (!report_.converged || leavesJumps())
    return;
  const std::string ofRows = rowForceText(quality_), ofGroups = wrongForcesText(quality_);
  if (!auditAgrees(quality_))
    report_.reason = ofRows.empty() ? contradiction : ofRows;
  else if (!ofGroups.empty())
    report_.reason = ofGroups;
  else
    return;
  report_.converged = false;
}

} // namespace Harmos::feti
