// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StepSequence.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Harmos::run {
namespace {

// Of states of effects in one step: more do not settle, unless there are so many points that break one by
// one.
constexpr int mostUpdates = 100;
// Where less than this of what may break in a step did, one of twice the length is tried.
constexpr double calm = 0.2;

std::string timeText(double time) {
  std::ostringstream text;
  text << std::setprecision(6) << time;
  return text.str();
}

} // namespace

StepSequence::StepSequence(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
                           const RunOptions& options, const Log& log, RunStages& run, RunReport& report)
    : comm_(comm),
      scene_(scene),
      options_(options),
      log_(log),
      quiet_(log.withoutInfo()),
      run_(run),
      report_(report),
      clock_(scene.timeline) {}

Solution StepSequence::go() {
  begin();
  Outcome outcome = Outcome::Accepted;
  while (outcome == Outcome::Accepted && !clock_.isOver()) {
    outcome = attempt();
    if (outcome == Outcome::Accepted)
      outcome = accept();
    else if (outcome == Outcome::Failed && !isOutOfTime() && clock_.halve()) {
      log_.info("Step " + std::to_string(clock_.step()) + " of " + std::to_string(clock_.steps()) +
                ": halved, new end time " + timeText(clock_.to()) + ": " +
                failure_.substr(0, failure_.find(':')));
      outcome = Outcome::Accepted;
    }
  }
  return end(outcome);
}

void StepSequence::begin() {
  run_.setUp();
  states_.emplace(*comm_, scene_, run_.contact());
  energy_.emplace(run_.loads().cases(), run_.contact().limitedRows > 0, scene_.breaks());
  prescribesMotion_ = globalMax(*comm_, run_.loads().prescribesMotion() ? 1LL : 0LL) > 0;
  requireConsistent();
  if (hasSteps())
    log_.info(std::to_string(clock_.steps()) + " steps to time " + timeText(scene_.timeline.end()));
  const bool goesOn = restore();
  run_.directory().removeOtherResults(written_);
  if (hasSteps())
    run_.directory().writeSteps(rows_, scene_.forcePaths(), furtherColumns(scene_));
  if (!written_.empty())
    run_.directory().writeSeries(written_);
  run_.directory().writeIterations(iterations_);
  if (goesOn)
    log_.info("Restart after " + std::to_string(rows_.size()) + " accepted steps of \"" +
              report_.restartedFrom + "\"");
}

// At all times of the run, before the first step: what several subdomains say of a dof, and rows that hold
// prescribed values alone. Between corners of the histories they are linear in time.
void StepSequence::requireConsistent() {
  if (!prescribesMotion_)
    return;
  for (double time : scene_.timeline.corners())
    try {
      run_.checkBounds(run_.loads().prescribed(time));
    } catch (const InputError& error) {
      throw InputError("at time " + timeText(time) + ": " + error.what(), error.data());
    }
  run_.checkBounds(run_.loads().prescribed(clock_.to()));
}

// Less of the step would take more time, not less.
bool StepSequence::isOutOfTime() const {
  return report_.solved && report_.result.reason == qp::Reason::TimeLimit;
}

std::string StepSequence::placeText() const {
  return "step " + std::to_string(clock_.step()) + "/" + std::to_string(clock_.steps()) + " t " +
         timeText(clock_.to()) + "  ";
}

StepSequence::Outcome StepSequence::attempt() {
  if (within_ == nullptr) {
    states_->begin(advance());
    updates_ = 0;
    attemptCounters_ = {};
  }
  const int most = mostUpdates + static_cast<int>(run_.contact().bondCount);
  while (true) {
    const Outcome outcome = solve();
    if (outcome != Outcome::Accepted)
      return outcome;
    const double asked =
        options_.toleranceRule == ToleranceRule::Balanced ? report_.tolerance : options_.tolerance;
    const bool again =
        states_->update(report_.contact, report_.slips, asked, lastSolution(), residualAtStart());
    // On the way there more may be broken for a while, and where much breaks for good that takes its time.
    constexpr int manyUpdates = 25;
    if ((!again || updates_ == manyUpdates) && states_->haste() > 1.0 && clock_.mayHalve()) {
      failure_ = "too much breaks at once";
      return Outcome::Failed;
    }
    if (!again)
      return outcome;
    if (++updates_ > most) {
      failure_ = "the states of effects have not settled in " + std::to_string(most) + " solutions";
      return Outcome::Failed;
    }
  }
}

void StepSequence::prepare(double time) {
  const std::vector<std::vector<double>> prescribed = run_.loads().prescribed(time);
  const bool changesBounds = prescribesMotion_ || states_->any();
  const std::vector<ConstraintRow> rows = changesBounds ? states_->rows() : std::vector<ConstraintRow>();
  run_.prepare({time, run_.loads().loads(time), prescribesMotion_ ? &prescribed : nullptr,
                changesBounds ? &rows : nullptr});
}

// Of the factors of loads in the step, in terms of what it was in the last one: they go on as they did, slow
// down or turn back.
std::optional<double> StepSequence::advance() const {
  if (rows_.empty())
    return std::nullopt;
  const std::vector<double> before =
                                run_.loads().factors(rows_.size() > 1 ? rows_[rows_.size() - 2].time : 0.0),
                            now = run_.loads().factors(rows_.back().time),
                            next = run_.loads().factors(clock_.to());
  double both = 0.0, last = 0.0;
  for (std::size_t k = 0; k < now.size(); ++k) {
    both += (next[k] - now[k]) * (now[k] - before[k]);
    last += (now[k] - before[k]) * (now[k] - before[k]);
  }
  return last > 0.0 ? std::optional<double>(both / last) : std::nullopt;
}

// As a share of the problem's; all of it where there was nothing to solve.
double StepSequence::residualAtStart() const {
  const std::vector<qp::IterationRecord>& records = report_.result.history;
  return records.empty() || !(report_.gradientScale > 0.0)
             ? 1.0
             : records.front().projectedGradient / report_.gradientScale;
}

feti::WarmStart StepSequence::lastSolution() const {
  return {run_.torn().multiplier, run_.dualSolution().mu};
}

// After an update of states what differs are some rows: the last solution is the nearest one.
std::optional<feti::WarmStart> StepSequence::startOfSolve() const {
  if (!states_->start().multiplier.is_null())
    return states_->start();
  if (updates_ > 0 && within_ == nullptr && report_.solved)
    return lastSolution();
  return history_.start(run_.dualProblem(), options_.tolerance);
}

StepSequence::Outcome StepSequence::solve() {
  try {
    prepare(clock_.to());
  } catch (const NumericalError& error) { // on all ranks: loads on a motion that nothing can hold
    static_cast<feti::SolveReport&>(report_) = {};
    failure_ = error.what();
    return Outcome::Failed;
  }
  const std::optional<feti::WarmStart> start = startOfSolve();
  const qp::IterationRecord before = iterations_.empty() ? qp::IterationRecord{} : iterations_.back();
  monitor_ = run_.monitor(within_, quiet_, {placeText(), before, watch_, true});
  monitor_->addState([this](Archive& archive) { exchange(archive, true); });
  within_ = nullptr;
  run_.solve(start ? &*start : nullptr, monitor_, quiet_, before.seconds - secondsBefore_,
             states_->tolerance(options_.tolerance));
  counters_ += report_.result.counters;
  attemptCounters_ += report_.result.counters;
  for (const qp::IterationRecord& row : report_.result.history)
    iterations_.push_back(qp::countedOn(row, before));
  if (report_.isInterrupted())
    return Outcome::Interrupted;
  run_.recover();
  failure_ = report_.reason;
  if (isOutOfTime())
    failure_ = "time limit: \"Solver/Maximum seconds\", " + timeText(options_.maximumSeconds) + ", are over";
  return report_.converged ? Outcome::Accepted : Outcome::Failed;
}

StepSequence::Outcome StepSequence::accept() {
  const auto scope = run_.outputScope();
  energy_->reach({run_.loads().factors(clock_.to()),
                  run_.loads().products(*comm_, run_.torn().displacement, run_.reactions()),
                  report_.audit.energy, scene::freeStrainEnergy(*comm_, scene_, run_.owned(), clock_.to()),
                  report_.audit.frictionWork, states_->dissipated()});
  states_->tell(report_.slips, report_.contact);
  report_.contactCounts = countContact(*comm_, report_.contact);
  StepRow row = stepRow(report_, *energy_);
  row.step = clock_.step();
  row.time = clock_.to();
  tellFurther(scene_, row);
  row.products = attemptCounters_.hessianApplications;
  row.activeSets = attemptCounters_.faces;
  const bool writes = writesFields();
  if (writes) {
    run_.writeFields(hasSteps() ? RunDirectory::resultOf(row.step) : "result.vtkhdf");
    if (hasSteps())
      written_.push_back({row.step, row.time});
  }
  if (states_->hasSoftened()) // what loads come to is another matter from here on
    history_.clear();
  history_.add(run_.dualProblem(), run_.torn().multiplier, run_.dualSolution().mu);
  const double snapped = energy_->snapped();
  states_->commit();
  energy_->commit();
  const bool endsStep = clock_.endsStep();
  const bool isCalm = states_->haste() < calm;
  clock_.accept();
  if (isCalm && scene_.breaks())
    clock_.join();
  rows_.push_back(row);
  report_.steps.push_back(row);
  if (hasSteps())
    run_.directory().appendStep(row);
  if (writes && hasSteps())
    run_.directory().writeSeries(written_);
  tell(row, snapped);
  return clock_.isOver() ? Outcome::Accepted : look(endsStep);
}

// Between two steps: the solver may have had no time to look.
StepSequence::Outcome StepSequence::look(bool endsStep) {
  using Wish = RunMonitor::Wish;
  const Wish wish = monitor_->askBetween();
  const int every = options_.checkpoint.steps;
  const bool isDue = endsStep && every > 0 && rows_.back().step % every == 0;
  if (isDue || wish != Wish::GoOn)
    saveBetweenSteps();
  if (wish != Wish::SaveAndStop)
    return Outcome::Accepted;
  report_.converged = false;
  report_.result.reason = qp::Reason::Interrupted;
  report_.reason = qp::toString(qp::Reason::Interrupted) + ": stop requested";
  return Outcome::Interrupted;
}

bool StepSequence::writesFields() const {
  return options_.writeFields && clock_.endsStep() &&
         (clock_.step() % options_.every == 0 || clock_.step() == clock_.steps());
}

void StepSequence::tell(const StepRow& row, double snapped) const {
  std::ostringstream text;
  text << "Step " << row.step << " of " << clock_.steps() << ", time " << timeText(row.time) << ": "
       << row.products << " applications of F, energy " << scientific(row.energy, 6);
  if (report_.inequalities > 0)
    text << ", " << row.closed << " of " << row.closed + row.open << " contact points closed";
  if (row.sticking + row.slipping > 0)
    text << ", " << row.slipping << " of " << row.sticking + row.slipping << " slipping";
  if (const long long bound = run_.contact().bondCount; bound > 0) {
    text << ", " << report_.contactCounts.damaged << " of " << bound << " bonds damaged, " << row.broken
         << " broken";
    constexpr double known = 10.0; // tolerances of forces
    if (snapped > known * report_.tolerance * std::abs(row.externalWork))
      text << ", snap-through released " << scientific(snapped, 3);
  }
  log_.info(text.str());
}

void StepSequence::exchange(Archive& archive, bool isWithinSolve) {
  archive.number("within a solve", isWithinSolve);
  clock_.exchange(archive);
  energy_->exchange(archive);
  states_->exchange(archive);
  states_->exchangeAnswers(archive, run_.dualProblem());
  archive.number("updates of states", updates_);
  run::exchange(archive, rows_, scene_.forcePaths());
  RunDirectory::exchange(archive, written_);
  std::vector<double> counts = qp::toNumbers(counters_), table = qp::toNumbers(iterations_),
                      attempt = qp::toNumbers(attemptCounters_);
  archive.numbers("counters of the steps", counts);
  archive.numbers("counters of the attempt", attempt);
  archive.numbers("iterations of the steps", table);
  if (archive.isReading()) {
    counters_ = qp::countersOf(counts);
    attemptCounters_ = qp::countersOf(attempt);
    iterations_ = qp::historyOf(table);
    for (StepRow& row : rows_)
      tellFurther(scene_, row);
  }
  history_.exchange(archive, run_.dualProblem());
}

void StepSequence::saveBetweenSteps() {
  monitor_->saveBetween([this](Archive& archive) { exchange(archive, false); });
}

// Whether there was something to go on from.
bool StepSequence::restore() {
  const CheckpointReader* checkpoint = run_.directory().checkpoint();
  if (checkpoint == nullptr)
    return false;
  bool isWithinSolve = false;
  checkpoint->restore(rowBasis(run_.dualProblem()), [&](Archive& archive) {
    archive.number("within a solve", isWithinSolve);
    exchange(archive, isWithinSolve);
  });
  within_ = isWithinSolve ? checkpoint : nullptr;
  if (!isWithinSolve) { // the solver would look by itself
    prepare(rows_.back().time);
    requireSameProblem(*checkpoint, run_.dualProblem(), report_.localCondition);
  }
  secondsBefore_ = iterations_.empty() ? 0.0 : iterations_.back().seconds;
  report_.steps = rows_;
  return true;
}

// Of the whole run, for the report.
void StepSequence::sumUp() {
  run_.countFactorisations();
  report_.result.counters = counters_;
  report_.result.history = iterations_;
  run_.directory().writeIterations(iterations_);
}

Solution StepSequence::end(Outcome outcome) {
  sumUp();
  if (outcome == Outcome::Interrupted) {
    report_.audited = false;
    report_.forces = {};
    report_.reason += report_.checkpointFault.empty()
                          ? "; continue with --restart \"" + options_.outputDirectory + "\""
                          : "; no checkpoint: " + report_.checkpointFault;
    return run_.hand();
  }
  if (outcome == Outcome::Failed) {
    report_.converged = false;
    report_.reason =
        "step " + std::to_string(clock_.step()) + " of " + std::to_string(clock_.steps()) + ", from time " +
        timeText(clock_.from()) + " to " + timeText(clock_.to()) +
        (clock_.isPart() ? " (the smallest part allowed)" : "") + ": " + failure_ + "; results up to time " +
        timeText(rows_.empty() ? 0.0 : rows_.back().time) +
        " are complete; continue with --restart and other limits or a smaller \"Steps/Smallest step\"";
    return run_.hand();
  }
  run_.tellResult();
  run_.directory().removeCheckpoint(report_.checkpoints > 0);
  return run_.hand();
}

} // namespace Harmos::run
