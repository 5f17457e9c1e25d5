// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StudyErrors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::study {

const std::array<std::string, measures> measureNames = {"energy",       "displacement", "pressure",
                                                        "contact_zone", "slip",         "stick_zone"};
const std::array<std::string, measures> measureTitles = {"energy norm",
                                                         "displacement",
                                                         "contact pressure",
                                                         "size of the contact zone",
                                                         "slip",
                                                         "size of the zone that sticks"};

std::size_t measuresOf(const Plan& plan) {
  return plan.hasFriction ? measures : measures - 2;
}

namespace {

constexpr double notMeasured = std::numeric_limits<double>::quiet_NaN();

Errors arrayOf(const run::SolutionNorms& norms) {
  return {norms.energy, norms.displacement, norms.pressure, norms.contactArea, norms.slip, norms.stickArea};
}

Errors filled(double value) {
  Errors errors{};
  errors.fill(value);
  return errors;
}

// Half the largest point of a zone over its size; zero without a zone. Largest within the zone: graded
// surfaces are coarse far from it.
double grainOf(const run::FinishedRun& run, double area, bool (*isWithin)(const run::ContactState&)) {
  double largest = 0.0;
  for (std::size_t k = 0; k < run.points.size(); ++k)
    if (isWithin(run.states[k]))
      largest = std::max(largest, run.points[k].area);
  return area > 0.0 ? 0.5 * largest / area : 0.0;
}

} // namespace

ErrorJudge::ErrorJudge(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const Plan& plan, const Log& log)
    : comm_(comm), plan_(plan), log_(log) {}

Errors ErrorJudge::relative(const run::SolutionNorms& norms) const {
  const Errors values = arrayOf(norms), scales = arrayOf(norms_);
  Errors result{};
  for (std::size_t k = 0; k < measures; ++k)
    result[k] = scales[k] > 0.0 ? values[k] / scales[k] : notMeasured;
  return result;
}

ErrorJudge::Tight ErrorJudge::tightRun(std::vector<std::string> assignments, const std::string& what,
                                       const Sizes& sizes) const {
  if (plan_.hasToleranceRule)
    assignments.push_back("Solver/Tolerance rule=fixed");
  constexpr double loosest = 1e-4;
  std::string reason;
  for (double tolerance = plan_.tightTolerance; tolerance <= 1.001 * loosest; tolerance *= 10.0) {
    std::vector<std::string> all = assignments;
    all.push_back("Solver/Tolerance=" + scientific(tolerance, 6));
    const Outcome outcome = runSetting(comm_, plan_, all, Repetition::Once, sizes);
    if (outcome.run && outcome.report.converged)
      return {outcome.run, tolerance};
    reason = outcome.reason;
  }
  throw NumericalError(what + " did not converge even to a tolerance of " + scientific(loosest, 0) + ": " +
                       reason);
}

void ErrorJudge::makeReference() {
  if (reference_)
    return;
  const auto exact = [](std::vector<std::string> assignments) {
    assignments.push_back("Dual operator/Precision=double");
    assignments.push_back("Dual operator/Expert/Block low rank tolerance=0");
    return assignments;
  };
  const Tight finest = tightRun(exact(plan_.reference), "the reference", nullptr);
  const Tight coarser = tightRun(exact(plan_.coarser), "the coarser reference", nullptr);
  const Tight coarsest = tightRun(exact(plan_.coarsest), "the coarsest reference", nullptr);
  reference_ = finest.run;
  norms_ = run::normsOf(*comm_, *reference_);
  const Errors first =
      relative(run::SolutionComparison(*comm_, *finest.run, *coarser.run).difference(*coarser.run));
  const Errors second =
      relative(run::SolutionComparison(*comm_, *coarser.run, *coarsest.run).difference(*coarsest.run));
  for (std::size_t k = 0; k < measures; ++k) {
    const double ratio = first[k] > 0.0 ? second[k] / first[k] : 8.0;
    own_[k] = first[k] / (std::clamp(ratio, std::sqrt(2.0), 8.0) - 1.0);
  }
  own_[3] = std::max(own_[3], grainOf(*reference_, norms_.contactArea,
                                      [](const run::ContactState& state) { return state.closed; }));
  own_[5] = std::max(own_[5], grainOf(*reference_, norms_.stickArea, [](const run::ContactState& state) {
                       return state.friction == run::Friction::Sticks;
                     }));
  log_.info("Reference solved to tolerance " + scientific(finest.tolerance, 0) +
            ". Estimated relative errors of the reference:");
  for (std::size_t k = 0; k < measuresOf(plan_); ++k)
    if (std::isfinite(own_[k]))
      log_.info("  " + measureTitles[k] + ": " + scientific(own_[k], 1) + " (next coarser mesh: " +
                scientific(first[k], 1) + ", the one after: " + scientific(second[k], 1) + ")");
}

const Errors& ErrorJudge::referenceErrors() {
  makeReference();
  return own_;
}

void ErrorJudge::turnTo(const Setting& setting, const Sizes& sizes) {
  makeReference();
  const std::vector<std::string> scene = plan_.sceneAssignments(setting);
  if (comparison_ && scene == scene_ && sizes == sizes_)
    return;
  comparison_ = nullptr;
  inexact_.clear();
  std::vector<std::string> assignments = scene;
  assignments.push_back("Dual operator/Precision=double");
  assignments.push_back("Dual operator/Expert/Block low rank tolerance=0");
  tight_ = tightRun(assignments, "the tight run for " + plan_.label(setting), sizes);
  comparison_ = std::make_unique<const run::SolutionComparison>(*comm_, *reference_, *tight_.run);
  discretisation_ = relative(comparison_->difference(*tight_.run));
  scene_ = scene;
  sizes_ = sizes;
}

ErrorParts ErrorJudge::unknown() {
  return {filled(notMeasured), filled(notMeasured), filled(notMeasured), filled(notMeasured), notMeasured};
}

ErrorParts ErrorJudge::partsOf(const Setting& setting, const Outcome& outcome) {
  turnTo(setting, outcome.sizes);
  ErrorParts parts{filled(notMeasured), discretisation_, filled(notMeasured), filled(0.0), tight_.tolerance};
  if (!outcome.run)
    return parts;
  const Tight* tight = &tight_;
  if (!outcome.localSolver.empty()) {
    auto at = inexact_.find(outcome.localSolver);
    if (at == inexact_.end()) {
      std::vector<std::string> assignments = scene_;
      assignments.insert(assignments.end(), outcome.localSolver.begin(), outcome.localSolver.end());
      at = inexact_
               .emplace(outcome.localSolver,
                        tightRun(assignments,
                                 "the tight run with the local solver of " + plan_.label(setting), sizes_))
               .first;
    }
    tight = &at->second;
    parts.local = relative(run::differenceOnSameMesh(*comm_, *tight->run, *tight_.run));
  }
  parts.total = relative(comparison_->difference(*outcome.run));
  parts.solver = relative(run::differenceOnSameMesh(*comm_, *outcome.run, *tight->run));
  parts.tightTolerance = tight->tolerance;
  return parts;
}

} // namespace Harmos::study
