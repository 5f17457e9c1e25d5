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
// Applications of a transient step above which coarse vectors are made, for all steps to come. The modes of
// K + κM that they are made of, rigid ones at long steps, bring applications down to some 20 for steps of any
// length, but each costs more. Seconds of 40 steps without and with them, on two ranks: a square of 256 parts
// with 80 applications a step 3.6, 16.8; with 360 9.5, 11.3; a cube of 64 with 39 19, 36; with 97 24.6, 23.9;
// with 205 33.7, 22.1.
constexpr long long manyApplications = 200;
// Where less than this of what may break in a step did, one of twice the length is tried.
constexpr double calm = 0.2;

using TornLoads = Motion::Loads;

double secondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// For solves to come, if they may be made and are not.
void makeVectors(feti::DualPipeline& pipeline, const Log& log) {
  const Teuchos::RCP<feti::AdaptiveSpace> space = pipeline.stages().adaptive;
  if (!space.is_null() && space->isPossible() && !space->isMade())
    space->make(log);
}

std::string timeText(double time) {
  std::ostringstream text;
  text << std::setprecision(6) << time;
  return text.str();
}

} // namespace

StepSequence::StepSequence(const RunContext& context, RunStages& run)
    : context_(context), quiet_(context.log.withoutInfo()), run_(run), clock_(context.scene.timeline) {}

Solution StepSequence::go() {
  begin();
  Outcome outcome = Outcome::Accepted;
  while (outcome == Outcome::Accepted && !clock_.isOver()) {
    outcome = attempt();
    if (outcome == Outcome::Accepted)
      outcome = accept();
    else if (outcome == Outcome::Failed && !isOutOfTime() && clock_.halve()) {
      context_.log.info("Step " + std::to_string(clock_.step()) + " of " + std::to_string(clock_.steps()) +
                        ": halved, new end time " + timeText(clock_.to()) + ": " +
                        attempt_.failure.substr(0, attempt_.failure.find(':')));
      outcome = Outcome::Accepted;
    }
  }
  return end(outcome);
}

void StepSequence::begin() {
  if (context_.scene.isTransient())
    inertia_.emplace(Inertia{{*context_.comm, context_.scene}});
  run_.setUp(inertia_ ? &inertia_->motion : nullptr);
  if (context_.scene.iterates())
    equilibrium_.emplace(context_, run_, inertia_ ? &inertia_->motion : nullptr);
  // Where the loop finds equilibrium slips are its own, and points of contact may change.
  states_.emplace(*context_.comm, context_.scene,
                  equilibrium_ ? equilibrium_->bonds().points() : run_.contact());
  if (equilibrium_)
    equilibrium_->bonds().follow(*states_);
  bounds_.emplace(Bounds{{context_.scene, run_.contact()},
                         {*context_.comm, run_.contact(), run_.owned(), context_.scene.components()}});
  if (equilibrium_)
    equilibrium_->follow(bounds_->locks);
  energy_.emplace(run_.loads().cases(),
                  run_.contact().limitedRows > 0 ||
                      (context_.scene.iterates() && context_.scene.hasInterfaceLaws()),
                  context_.scene.breaks());
  if (inertia_) {
    inertia_->motion.begin(equilibrium_ ? equilibrium_->forcesAtRest() : run_.loads().loads(0.0));
    energy_->beginWith(run_.loads().factors(0.0));
    inertia_->judge.emplace(*context_.comm, context_.scene, inertia_->motion);
    if (context_.scene.isFinite() && context_.scene.timeline.spectralRadius() == 1.0)
      context_.log.warning("\"Steps/Spectral radius\" = 1 at finite displacements: what vibrates too fast "
                           "for the steps may take "
                           "energy from bodies that turn, or gain it; 0.9 or less damps it");
  }
  prescribesMotion_ = globalMax(*context_.comm, run_.loads().prescribesMotion() ? 1LL : 0LL) > 0;
  requireConsistent();
  if (hasSteps())
    context_.log.info(std::to_string(clock_.steps()) + " steps to time " +
                      timeText(context_.scene.timeline.end()));
  const bool goesOn = restore();
  run_.directory().removeOtherResults(done_.written);
  if (hasSteps())
    run_.directory().writeSteps(done_.rows, context_.scene.forcePaths(), furtherColumns(context_.scene));
  if (!done_.written.empty())
    run_.directory().writeSeries(done_.written);
  run_.directory().writeIterations(work_.iterations);
  if (goesOn)
    context_.log.info("Restart after " + std::to_string(done_.rows.size()) + " accepted steps of \"" +
                      context_.report.restartedFrom + "\"");
}

// At all times of the run, before the first step: what several subdomains say of a dof, and rows that hold
// prescribed values alone. Between corners of the histories they are linear in time.
void StepSequence::requireConsistent() {
  if (!prescribesMotion_)
    return;
  for (double time : context_.scene.timeline.corners())
    try {
      run_.checkBounds(run_.loads().prescribed(time));
    } catch (const InputError& error) {
      throw InputError("at time " + timeText(time) + ": " + error.what(), error.data());
    }
  run_.checkBounds(run_.loads().prescribed(clock_.to()));
}

// Less of the step would take more time, not less.
bool StepSequence::isOutOfTime() const {
  return context_.report.solved && context_.report.result.reason == qp::Reason::TimeLimit;
}

std::string StepSequence::placeText() const {
  return "step " + std::to_string(clock_.step()) + "/" + std::to_string(clock_.steps()) + " t " +
         timeText(clock_.to()) + "  ";
}

// Whether a transient step may stand; else it is done again, damped or in parts.
StepSequence::Outcome StepSequence::attempt() {
  if (inertia_ && watch_.within == nullptr)
    inertia_->motion.damp(false);
  const Outcome outcome = attemptOnce();
  if (!inertia_ || outcome != Outcome::Accepted)
    return outcome;
  inertia_->judge->look(run_.contact(), context_.report.contact);
  if (inertia_->judge->isTooLong() && clock_.mayHalve()) {
    attempt_.failure = "too long for what moves in it";
    return Outcome::Failed;
  }
  if (inertia_->motion.isDamped() || !inertia_->judge->gains())
    return outcome;
  context_.log.info(placeText() + "damped: bodies would part with more energy than they met with");
  inertia_->motion.damp(true);
  const Outcome damped = attemptOnce();
  if (damped == Outcome::Accepted)
    inertia_->judge->look(run_.contact(), context_.report.contact);
  return damped;
}

StepSequence::Outcome StepSequence::attemptOnce() {
  if (watch_.within == nullptr) {
    states_->begin(advance());
    if (equilibrium_)
      equilibrium_->begin(clock_.from());
    attempt_.updates = 0;
    attempt_.counters = {};
    attempt_.factorisationsBefore = context_.report.factorisations;
  }
  const int most = mostUpdates + static_cast<int>(run_.contact().bondCount);
  while (true) {
    const Outcome outcome = solve();
    if (outcome != Outcome::Accepted)
      return outcome;
    const double asked = context_.options.toleranceRule == ToleranceRule::Balanced
                             ? context_.report.tolerance
                             : context_.options.tolerance;
    const bool again = updateStates(asked);
    // On the way there more may be broken for a while, and where much breaks for good that takes its time.
    constexpr int manyUpdates = 25;
    if ((!again || attempt_.updates == manyUpdates) && states_->haste() > 1.0 && clock_.mayHalve()) {
      attempt_.failure = "too much breaks at once";
      return Outcome::Failed;
    }
    if (!again)
      return outcome;
    if (++attempt_.updates > most) {
      attempt_.failure = "the states of effects have not settled in " + std::to_string(most) + " solutions";
      return Outcome::Failed;
    }
  }
}

// Whether the step is to be solved again.
bool StepSequence::updateStates(double tolerance) {
  if (!equilibrium_)
    return states_->update(context_.report.contact, context_.report.slips, tolerance, lastSolution(),
                           residualAtStart());
  const MovedBonds::Answer answer =
      equilibrium_->bonds().answer(run_.contact(), context_.report.contact, context_.report.slips);
  const bool again = states_->update(answer.states, answer.slips, tolerance);
  if (again)
    equilibrium_->goOn();
  return again;
}

void StepSequence::prepare(double time) {
  const std::vector<std::vector<double>> prescribed = run_.loads().prescribed(time);
  const bool changesBounds = prescribesMotion_ || states_->any() || bounds_->any();
  std::vector<ConstraintRow> rows = changesBounds ? states_->rows() : std::vector<ConstraintRow>();
  bounds_->moving.move(rows, time);
  if (changesBounds)
    bounds_->locks.apply(run_.contact(), rows, time);
  TornLoads loads = run_.loads().loads(time);
  if (inertia_) {
    if (const auto matrices = inertia_->motion.matricesOf(time - clock_.from()))
      run_.pipeline().setMatrices(*matrices);
    loads = inertia_->motion.pose(loads);
  }
  run_.prepare({time, loads, prescribesMotion_ ? &prescribed : nullptr, changesBounds ? &rows : nullptr});
}

// Of the factors of loads in the step, in terms of what it was in the last one: they go on as they did, slow
// down or turn back.
std::optional<double> StepSequence::advance() const {
  if (done_.rows.empty())
    return std::nullopt;
  const std::vector<double> before = run_.loads().factors(
                                done_.rows.size() > 1 ? done_.rows[done_.rows.size() - 2].time : 0.0),
                            now = run_.loads().factors(done_.rows.back().time),
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
  const std::vector<qp::IterationRecord>& records = context_.report.result.history;
  return records.empty() || !(context_.report.gradientScale > 0.0)
             ? 1.0
             : records.front().projectedGradient / context_.report.gradientScale;
}

feti::WarmStart StepSequence::lastSolution() const {
  return {run_.torn().multiplier, run_.dualSolution().mu};
}

// After an update of states what differs are some rows: the last solution is the nearest one.
std::optional<feti::WarmStart> StepSequence::startOfSolve() const {
  if (!states_->start().multiplier.is_null())
    return states_->start();
  if (attempt_.updates > 0 && watch_.within == nullptr && context_.report.solved)
    return lastSolution();
  return history_.start(run_.dualProblem(), context_.options.tolerance);
}

StepSequence::Outcome StepSequence::solveFinite() {
  const qp::IterationRecord before =
      work_.iterations.empty() ? qp::IterationRecord{} : work_.iterations.back();
  watch_.monitor = run_.monitor(nullptr, quiet_, {placeText(), before, watch_.clock, true});
  watch_.within = nullptr;
  const auto saveWithin = [this] {
    watch_.monitor->saveBetween([this](Archive& archive) { exchange(archive, true); });
  };
  const EquilibriumLoop::Outcome outcome =
      equilibrium_->solve(clock_.to(), quiet_, *watch_.monitor, saveWithin);
  if (outcome == EquilibriumLoop::Outcome::Interrupted) {
    saveWithin();
    context_.report.converged = false;
    return Outcome::Interrupted;
  }
  work_.counters += context_.report.result.counters;
  attempt_.counters += context_.report.result.counters;
  for (const qp::IterationRecord& row : context_.report.result.history)
    work_.iterations.push_back(qp::countedOn(row, before));
  context_.report.converged = outcome == EquilibriumLoop::Outcome::Converged;
  attempt_.failure = equilibrium_->failure();
  return context_.report.converged ? Outcome::Accepted : Outcome::Failed;
}

StepSequence::Outcome StepSequence::solve() {
  if (equilibrium_)
    return solveFinite();
  try {
    prepare(clock_.to());
  } catch (const NumericalError& error) { // on all ranks: loads on a motion that nothing can hold
    static_cast<feti::SolveReport&>(context_.report) = {};
    attempt_.failure = error.what();
    return Outcome::Failed;
  }
  const std::optional<feti::WarmStart> start = startOfSolve();
  const qp::IterationRecord before =
      work_.iterations.empty() ? qp::IterationRecord{} : work_.iterations.back();
  watch_.monitor = run_.monitor(watch_.within, quiet_, {placeText(), before, watch_.clock, true});
  watch_.monitor->addState([this](Archive& archive) { exchange(archive, true); });
  watch_.within = nullptr;
  if (work_.wantsVectors)
    makeVectors(run_.pipeline(), quiet_);
  run_.solve(start ? &*start : nullptr, watch_.monitor, quiet_, before.seconds - work_.secondsBefore,
             states_->tolerance(context_.options.tolerance));
  work_.counters += context_.report.result.counters;
  attempt_.counters += context_.report.result.counters;
  for (const qp::IterationRecord& row : context_.report.result.history)
    work_.iterations.push_back(qp::countedOn(row, before));
  if (context_.report.isInterrupted())
    return Outcome::Interrupted;
  run_.recover();
  attempt_.failure = context_.report.reason;
  if (isOutOfTime())
    attempt_.failure =
        "time limit: \"Solver/Maximum seconds\", " + timeText(context_.options.maximumSeconds) + ", are over";
  return context_.report.converged ? Outcome::Accepted : Outcome::Failed;
}

void StepSequence::reachEnergy() {
  scene::TimedLoads::Products products =
      run_.loads().products(*context_.comm, run_.torn().displacement, run_.reactions());
  bounds_->moving.addProducts(*context_.comm, run_.multipliers(), run_.loads().cases(), products);
  energy_->reach({run_.loads().factors(clock_.to()), products, context_.report.audit.energy,
                  scene::freeStrainEnergy(*context_.comm, context_.scene, run_.owned(), clock_.to()),
                  context_.report.audit.frictionWork, states_->dissipated(),
                  equilibrium_ ? equilibrium_->furtherWork() : 0.0,
                  equilibrium_ ? equilibrium_->dissipated() : 0.0});
}

StepSequence::Outcome StepSequence::accept() {
  const auto scope = context_.timers.scope("output");
  reachEnergy();
  if (equilibrium_)
    run_.tellBonds(equilibrium_->bonds());
  else
    states_->tell(context_.report.slips, context_.report.contact);
  context_.report.contactCounts = countContact(*context_.comm, context_.report.contact);
  StepRow row = stepRow(context_.report, *energy_);
  row.step = clock_.step();
  row.time = clock_.to();
  if (equilibrium_) {
    run_.countFactorisations();
    row.newton = equilibrium_->iterations();
    row.factorisations = context_.report.factorisations - attempt_.factorisationsBefore;
  }
  if (inertia_) {
    row.kinetic = inertia_->motion.kineticEnergy();
    row.isDamped = inertia_->motion.isDamped();
    row.momentum = inertia_->motion.momentum();
  }
  tellFurther(context_.scene, done_.rows.empty() ? nullptr : &done_.rows.back(), row);
  row.products = attempt_.counters.hessianApplications;
  row.activeSets = attempt_.counters.faces;
  const bool writes = writesFields();
  if (writes) {
    run_.writeFields(hasSteps() ? RunDirectory::resultOf(row.step) : "result.vtkhdf");
    if (hasSteps())
      done_.written.push_back({row.step, row.time});
  }
  if (states_->hasSoftened()) // what loads come to is another matter from here on
    history_.clear();
  if (equilibrium_)
    equilibrium_->commit();
  else
    history_.add(run_.dualProblem(), run_.torn().multiplier, run_.dualSolution().mu);
  if (inertia_) {
    inertia_->judge->commit(energy_->stored());
    inertia_->motion.commit();
    work_.wantsVectors = work_.wantsVectors || row.products > manyApplications;
  }
  const double snapped = energy_->snapped();
  states_->commit();
  if (const std::string text = bounds_->locks.commit(clock_.to(), run_.torn().displacement); !text.empty())
    context_.log.info(text);
  energy_->commit();
  const bool endsStep = clock_.endsStep();
  const bool isCalm = states_->haste() < calm && (!inertia_ || inertia_->judge->isCalm());
  clock_.accept(context_.scene.timeline.timeError() > 0.0);
  if (isCalm && (context_.scene.breaks() || context_.scene.timeline.timeError() > 0.0))
    clock_.join();
  done_.rows.push_back(row);
  context_.report.steps.push_back(row);
  if (hasSteps())
    run_.directory().appendStep(row);
  if (writes && hasSteps())
    run_.directory().writeSeries(done_.written);
  tell(row, snapped);
  return clock_.isOver() ? Outcome::Accepted : look(endsStep);
}

// Between two steps: the solver may have had no time to look.
StepSequence::Outcome StepSequence::look(bool endsStep) {
  using Wish = RunMonitor::Wish;
  const Wish wish = watch_.monitor->askBetween();
  const int every = context_.options.checkpoint.steps;
  const bool isDue = endsStep && every > 0 && done_.rows.back().step % every == 0 && !savingTakesLong();
  if (isDue || wish != Wish::GoOn)
    saveBetweenSteps();
  if (wish != Wish::SaveAndStop)
    return Outcome::Accepted;
  context_.report.converged = false;
  context_.report.result.reason = qp::Reason::Interrupted;
  context_.report.reason = qp::toString(qp::Reason::Interrupted) + ": stop requested";
  return Outcome::Interrupted;
}

// Steps of transient runs are many and short: checkpoints are to take no more than a tenth of all seconds.
bool StepSequence::savingTakesLong() const {
  constexpr double most = 0.1;
  return inertia_ &&
         globalMax(*context_.comm, watch_.saving > most * secondsSince(watch_.begin) ? 1LL : 0LL) > 0;
}

bool StepSequence::writesFields() const {
  return context_.options.writeFields && clock_.endsStep() &&
         (clock_.step() % context_.options.every == 0 || clock_.step() == clock_.steps());
}

void StepSequence::tell(const StepRow& row, double snapped) const {
  std::ostringstream text;
  text << "Step " << row.step << " of " << clock_.steps() << ", time " << timeText(row.time) << ": "
       << row.products << " applications of F, energy " << scientific(row.energy, 6);
  if (context_.report.inequalities > 0)
    text << ", " << row.closed << " of " << row.closed + row.open << " contact points closed";
  if (row.sticking + row.slipping > 0)
    text << ", " << row.slipping << " of " << row.sticking + row.slipping << " slipping";
  if (const long long bound = equilibrium_ ? equilibrium_->bondCount() : run_.contact().bondCount;
      bound > 0) {
    text << ", " << context_.report.contactCounts.damaged << " of " << bound << " bonds damaged, "
         << row.broken << " broken";
    constexpr double known = 10.0; // tolerances of forces
    if (snapped > known * context_.report.tolerance * std::abs(row.externalWork))
      text << ", snap-through released " << scientific(snapped, 3);
  }
  context_.log.info(text.str());
}

void StepSequence::exchange(Archive& archive, bool isWithinSolve) {
  archive.number("within a solve", isWithinSolve);
  clock_.exchange(archive);
  energy_->exchange(archive);
  states_->exchange(archive);
  bounds_->locks.exchange(archive);
  states_->exchangeAnswers(archive, run_.dualProblem());
  archive.number("updates of states", attempt_.updates);
  run::exchange(archive, done_.rows, context_.scene.forcePaths());
  RunDirectory::exchange(archive, done_.written);
  std::vector<double> counts = qp::toNumbers(work_.counters), table = qp::toNumbers(work_.iterations),
                      attempt = qp::toNumbers(attempt_.counters);
  archive.numbers("counters of the steps", counts);
  archive.numbers("counters of the attempt", attempt);
  archive.numbers("iterations of the steps", table);
  archive.number("wants coarse vectors", work_.wantsVectors);
  if (archive.isReading()) {
    work_.counters = qp::countersOf(counts);
    attempt_.counters = qp::countersOf(attempt);
    work_.iterations = qp::historyOf(table);
    const StepRow* before = nullptr;
    for (StepRow& row : done_.rows) {
      tellFurther(context_.scene, before, row);
      before = &row;
    }
  }
  history_.exchange(archive, run_.dualProblem());
  if (equilibrium_)
    equilibrium_->exchange(archive, isWithinSolve);
  if (inertia_) {
    TornArchive torn(archive, run_.pipeline().system());
    inertia_->motion.exchange(torn);
    inertia_->judge->exchange(archive);
    bool isDamped = inertia_->motion.isDamped();
    archive.number("damped", isDamped);
    inertia_->motion.damp(isDamped);
  }
}

void StepSequence::saveBetweenSteps() {
  const auto begin = std::chrono::steady_clock::now();
  watch_.monitor->saveBetween([this](Archive& archive) { exchange(archive, false); });
  watch_.saving += secondsSince(begin);
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
  watch_.within = isWithinSolve ? checkpoint : nullptr;
  // The solver would look by itself; loads of a step go on with motions.
  if (!isWithinSolve && !equilibrium_ && !inertia_) {
    prepare(done_.rows.back().time);
    requireSameProblem(*checkpoint, run_.dualProblem(), context_.report.localCondition);
  }
  work_.secondsBefore = work_.iterations.empty() ? 0.0 : work_.iterations.back().seconds;
  context_.report.steps = done_.rows;
  return true;
}

// Of the whole run, for the report.
void StepSequence::sumUp() {
  run_.countFactorisations();
  context_.report.result.counters = work_.counters;
  context_.report.result.history = work_.iterations;
  run_.directory().writeIterations(work_.iterations);
}

Solution StepSequence::end(Outcome outcome) {
  sumUp();
  if (outcome == Outcome::Interrupted) {
    context_.report.audited = false;
    context_.report.forces = {};
    context_.report.reason += context_.report.checkpointFault.empty()
                                  ? "; continue with --restart \"" + context_.options.outputDirectory + "\""
                                  : "; no checkpoint: " + context_.report.checkpointFault;
    return run_.hand();
  }
  if (outcome == Outcome::Failed) {
    context_.report.converged = false;
    context_.report.reason =
        "step " + std::to_string(clock_.step()) + " of " + std::to_string(clock_.steps()) + ", from time " +
        timeText(clock_.from()) + " to " + timeText(clock_.to()) +
        (clock_.isPart() ? " (the smallest part allowed)" : "") + ": " + attempt_.failure +
        "; results up to time " + timeText(done_.rows.empty() ? 0.0 : done_.rows.back().time) +
        " are complete; continue with --restart and other limits or a smaller \"Steps/Smallest step\"";
    return run_.hand();
  }
  run_.tellResult();
  run_.directory().removeCheckpoint(context_.report.checkpoints > 0);
  return run_.hand();
}

} // namespace Harmos::run
