// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunMonitor.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Rendezvous.hpp"
#include "Harmos_StatusTest.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

namespace Harmos::run {
namespace {

const char* const loadName = "right-hand side"; // Pd
const char* const clustersName = "clusters";
const char* const reachedName = "multiplier reached"; // λ + λ̃
constexpr double lookInterval = 0.25;                 // seconds between two reductions

double secondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double norm(const MultiVector& x) {
  std::vector<double> result(1);
  x.norm2(Teuchos::arrayViewFromVector(result));
  return result[0];
}

// Another number of ranks changes the right-hand side by rounding errors times the condition of the
// subdomains: c ε κ with c = 1e3 for sums of some ten thousand terms. Another mesh or load changes it by what
// was changed.
void requireSame(const CheckpointReader& checkpoint, MultiVector& kept, const feti::DualProblem& present,
                 double condition) {
  const MultiVector& load = *present.rhs();
  kept.update(-1.0, load, 1.0);
  const double known = 1e3 * std::numeric_limits<double>::epsilon() * std::max(condition, 1.0);
  // Of bodies that move as a whole Pd is nothing but rounding errors of d.
  if (norm(kept) > std::max(1e-6, known) * norm(load) + known * norm(present.d()))
    throw InputError("the checkpoint \"" + checkpoint.path() +
                         "\" belongs to another problem: the right-hand side of the dual problem has a "
                         "relative difference of " +
                         scientific(norm(kept) / norm(load), 0) +
                         "; restart with the deck and the meshes of the run that wrote it",
                     {{"file", checkpoint.path()}});
}

bool isOfOtherClusters(const CheckpointReader& checkpoint, const feti::DualProblem& present) {
  double before = 0.0;
  if (checkpoint.holds(clustersName))
    checkpoint.restore({},
                       [&](qp::StateArchive<MultiVector>& archive) { archive.number(clustersName, before); });
  return before != present.clusters();
}

} // namespace

void requireSameProblem(const CheckpointReader& checkpoint, const feti::DualProblem& present,
                        double condition) {
  if (isOfOtherClusters(checkpoint, present)) // Pd is another
    return;
  // Pd is the same for every choice of K⁺, which depends on the subdomains that a rank has; d is not.
  MultiVector kept(*present.rhs(), Teuchos::Copy);
  checkpoint.restore(rowBasis(present),
                     [&](qp::StateArchive<MultiVector>& archive) { archive.vector(loadName, kept); });
  requireSame(checkpoint, kept, present, condition);
}

RunMonitor::RunMonitor(const Teuchos::Comm<int>& comm, const RunOptions& options,
                       const CheckpointReader* checkpoint, const scene::ContactSetup& contact, const Log& log,
                       RunReport& report, SolvePlace place)
    : comm_(comm),
      options_(options),
      checkpoint_(checkpoint),
      contact_(contact),
      log_(log),
      report_(report),
      place_(std::move(place)),
      clock_(place_.clock ? place_.clock : std::make_shared<WatchClock>()) {}

RunMonitor::~RunMonitor() = default;

std::optional<feti::WarmStart> RunMonitor::startOfOtherClusters(const feti::DualProblem& problem) {
  if (checkpoint_ == nullptr || !isOfOtherClusters(*checkpoint_, problem))
    return std::nullopt;
  log_.info("Restart: the checkpoint has other clusters of subdomains; the solver starts again from the "
            "stored multipliers");
  const auto reached = Teuchos::rcp(new MultiVector(problem.d().getMap(), 1));
  checkpoint_->restore(rowBasis(problem), [&](Archive& archive) { archive.vector(reachedName, *reached); });
  checkpoint_ = nullptr;
  return feti::WarmStart{reached, {}};
}

void RunMonitor::goesOnAfter(const qp::IterationRecord& last) {
  place_.before = qp::countedOn(last, place_.before);
  place_.hasEarlier = true;
  place_.clock = clock_;
  rows_.clear();
  lastOuter_ = 1;
}

void RunMonitor::begins(const feti::DualRun& run) {
  run_.emplace(run);
  view_ = std::make_unique<LiveView>(comm_.getRank() == 0 ? options_.outputDirectory + "/iterations.csv"
                                                          : std::string(),
                                     place_.text + run.method, log_, place_.before, place_.hasEarlier);
  if (!place_.clock)
    *clock_ = {};
  if (checkpoint_ == nullptr)
    return;
  restore([&](Archive& archive) { exchangeProblem(archive); });
  for (const Exchange& state : states_)
    restore(state);
  view_->begin(rows_);
  if (!rows_.empty()) {
    lastOuter_ = rows_.back().outer;
    log_.info("Restart from iteration " + std::to_string(qp::countedOn(rows_.back(), place_.before).inner) +
              " of \"" + checkpoint_->path() + "\"");
  }
}

// What tells whether this is still the problem that was being solved.
void RunMonitor::exchangeProblem(Archive& archive) {
  // Pd is the same for every choice of K⁺, which depends on the subdomains that a rank has; d is not.
  const MultiVector& load = *run_->stages.problem->rhs();
  MultiVector kept(load, Teuchos::Copy);
  archive.vector(loadName, kept);
  std::vector<double> method(run_->method.begin(), run_->method.end());
  archive.numbers("method", method);
  std::vector<double> rows = qp::toNumbers(rows_);
  archive.numbers("rows shown", rows);
  rows_ = qp::historyOf(rows);
  if (!archive.isReading()) {
    double clusters = run_->stages.problem->clusters();
    archive.number(clustersName, clusters);
    MultiVector reached(reached_.is_null() ? *run_->stages.problem->shift() : *reached_, Teuchos::Copy);
    archive.vector(reachedName, reached);
  }
  if (!archive.isReading())
    return;
  const std::string before(method.begin(), method.end());
  if (before != run_->method)
    throw InputError("the checkpoint \"" + checkpoint_->path() + "\" belongs to the method " + before +
                         ", but this run uses " + run_->method +
                         "; restart with the deck of the run that wrote it",
                     {{"file", checkpoint_->path()}});
  requireSame(*checkpoint_, kept, *run_->stages.problem, report_.localCondition);
}

void RunMonitor::recorded(const qp::IterationRecord& record) {
  rows_.push_back(record);
  view_->add(record, run_->targets());
}

// The slowest rank's clock, and what any rank was told.
RunMonitor::Look RunMonitor::look() {
  const Told mine = options_.checkpoint.told ? options_.checkpoint.told() : Told::Nothing;
  const double elapsed = secondsSince(clock_->start);
  double values[2] = {elapsed, static_cast<double>(mine)}, most[2] = {0.0, 0.0};
  Teuchos::reduceAll<int, double>(comm_, Teuchos::REDUCE_MAX, 2, values, most);
  const double perIteration =
      (most[0] - pace_.lastElapsed) / static_cast<double>(std::max(1LL, pace_.asked - pace_.lastLook));
  const double steps = std::clamp(lookInterval / std::max(perIteration, 1e-9), 1.0, 1000.0);
  pace_.lastLook = pace_.asked;
  pace_.nextLook = pace_.asked + static_cast<long long>(steps);
  pace_.lastElapsed = most[0];
  return {most[0], static_cast<Told>(static_cast<int>(most[1]))};
}

RunMonitor::Wish RunMonitor::ask(const qp::IterationState<MultiVector>& state) {
  const Wish wish = wishAt(state);
  if (wish != Wish::GoOn)
    reached_ = run_->stages.problem->total(*state.x);
  return wish;
}

RunMonitor::Wish RunMonitor::wishAt(const qp::IterationState<MultiVector>& state) {
  checkpoint_ = nullptr; // the solver is beyond it
  ++pace_.asked;
  const CheckpointOptions& options = options_.checkpoint;
  Wish wish = Wish::GoOn;
  lastOuter_ = std::min(lastOuter_, state.outer); // a solver that took over counts from one
  if (options.outerIterations > 0 && state.outer - lastOuter_ >= options.outerIterations) {
    lastOuter_ = state.outer;
    wish = Wish::Save;
  }
  if (pace_.asked < pace_.nextLook)
    return wish;
  const Look now = look();
  if (options.minutes > 0.0 && now.elapsed - clock_->lastSave >= 60.0 * options.minutes)
    wish = Wish::Save;
  if (wish == Wish::Save)
    clock_->lastSave = now.elapsed;
  if (now.told == Told::Save)
    wish = Wish::Save;
  if (now.told == Told::Stop)
    wish = Wish::SaveAndStop;
  if (options_.liveSeconds > 0.0 && now.elapsed - clock_->lastShow >= options_.liveSeconds &&
      contact_.pointCount > 0) {
    clock_->lastShow = now.elapsed;
    showContact(*state.x);
  }
  return wish;
}

RowBasis rowBasis(const feti::DualProblem& problem) {
  const Teuchos::RCP<const Operator> rows = problem.equalityRows();
  return {[rows](const MultiVector& mu, MultiVector& dual) { rows->apply(mu, dual, Teuchos::TRANS); },
          [rows](const MultiVector& dual, MultiVector& mu) { rows->apply(dual, mu); }};
}

void RunMonitor::save(const Exchange& state) {
  write([&](Archive& archive) {
    exchangeProblem(archive);
    state(archive);
    for (const Exchange& other : states_)
      other(archive);
  });
}

RunMonitor::Wish RunMonitor::askBetween() {
  ++pace_.asked;
  const Look now = look();
  const double minutes = options_.checkpoint.minutes;
  if (now.told == Told::Stop)
    return Wish::SaveAndStop;
  if (now.told == Told::Save)
    return Wish::Save;
  return minutes > 0.0 && now.elapsed - clock_->lastSave >= 60.0 * minutes ? Wish::Save : Wish::GoOn;
}

void RunMonitor::saveBetween(const Exchange& state) {
  write([&](Archive& archive) {
    exchangeProblem(archive);
    state(archive);
  });
}

void RunMonitor::write(const Exchange& all) {
  const std::string path = checkpointPath(options_.outputDirectory);
  try {
    std::string assignments;
    for (const std::string& assignment : options_.checkpoint.assignments)
      assignments += assignment + '\0'; // which none of them contains
    std::string subdomains;
    for (const auto& [body, number] : options_.checkpoint.subdomains)
      subdomains += body + '\0' + std::to_string(number) + '\0';
    StateSize size;
    all(size);
    const std::size_t texts = subdomains.size() + options_.checkpoint.deck.size() +
                              options_.checkpoint.deckFile.size() + assignments.size() +
                              report_.dualForms.size();
    CheckpointWriter writer(comm_, path, rowBasis(*run_->stages.problem),
                            size.bytes() + static_cast<long long>(texts));
    writer.text("deck", options_.checkpoint.deck);
    writer.text("deck file", options_.checkpoint.deckFile);
    writer.text("assignments", assignments);
    writer.text("subdomains", subdomains);
    writer.text("dual forms", report_.dualForms);
    writer.text("products", report_.isSingle                    ? "single"
                            : report_.roundedFactorizations > 0 ? "rounded"
                                                                : "double");
    all(writer);
    writer.commit();
  } catch (const InputError& error) {
    // The run itself may still come to an end.
    report_.checkpointFault = error.what();
    log_.warning(std::string("no checkpoint: ") + error.what());
    return;
  }
  clock_->lastSave = pace_.lastElapsed;
  report_.checkpointFault.clear();
  report_.checkpoint = path;
  ++report_.checkpoints;
  log_.info("Checkpoint at iteration " + std::to_string(rows_.empty() ? 0 : rows_.back().inner) + ": \"" +
            path + "\"");
}

void RunMonitor::restore(const Exchange& state) {
  // Before the solver begins: numbers alone.
  const RowBasis basis = run_ ? rowBasis(*run_->stages.problem) : RowBasis();
  checkpoint_->restore(basis, [&](Archive& archive) { state(archive); });
}

namespace {

// A line of contact.csv.
struct ShownPoint {
  long long number;
  fem::Point position;
  double pressure;
};

} // namespace

// The forces that the present multipliers stand for, by row. Springs pull.
std::vector<std::pair<long long, double>> RunMonitor::contactForces(const MultiVector& lambda) const {
  const feti::Constraints& constraints = *run_->stages.constraints;
  std::vector<std::pair<long long, double>> forces;
  const auto free = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto shift = run_->stages.problem->shift()->getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t r = 0; r < free.extent(0); ++r) {
    const int row = static_cast<int>(r);
    if (constraints.rowType(row) != feti::RowType::Inequality)
      continue;
    const double force = (free(r, 0) + shift(r, 0)) * constraints.rowScale(row);
    forces.emplace_back(
        static_cast<long long>(constraints.rowMap()->getGlobalElement(static_cast<LocalOrdinal>(row))),
        constraints.isSoft(row) ? force : std::max(0.0, force));
  }
  return forces;
}

// contact.csv, of which the first rank sees all lines.
void RunMonitor::showContact(const MultiVector& lambda) const {
  std::vector<long long> asked;
  for (const contact::ContactPoint& point : contact_.points)
    asked.push_back(point.number);
  const std::vector<std::optional<double>> forces = lookUp(comm_, contactForces(lambda), asked);
  std::vector<std::vector<ShownPoint>> sends(static_cast<std::size_t>(comm_.getSize()));
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const contact::ContactPoint& point = contact_.points[k];
    sends.front().push_back({point.number, point.position, forces[k].value_or(0.0) / point.area});
  }
  std::vector<ShownPoint> all;
  for (const std::vector<ShownPoint>& part : exchangeItems(comm_, sends))
    all.insert(all.end(), part.begin(), part.end());
  if (comm_.getRank() != 0)
    return;
  std::sort(all.begin(), all.end(),
            [](const ShownPoint& a, const ShownPoint& b) { return a.number < b.number; });
  std::ostringstream text;
  text << "x,y,z,pressure,closed\n" << std::setprecision(9);
  for (const ShownPoint& point : all)
    text << point.position[0] << ',' << point.position[1] << ',' << point.position[2] << ',' << point.pressure
         << ',' << (point.pressure > 0.0 ? 1 : 0) << '\n';
  try {
    io::writeAtomically(options_.outputDirectory + "/contact.csv", text.str());
  } catch (const InputError&) {
    // A view of the run, not a result.
  }
}

} // namespace Harmos::run
