// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_EquilibriumLoop.hpp"

#include "Harmos_AnswerJudge.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_LeastStiffness.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_Recovery.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace Harmos::run {
namespace {

constexpr int mostIterations = 60;
// A tangent is made anew where changes come down more slowly than by this, and what it says of the force
// along a change is wrong by more than that share; and where bodies are stiffer along it than so many times
// that, as a beam is that has been bent too far.
constexpr double contraction = 0.3, wrong = 0.1, stiffening = 2.0;
// Of √(uᵀdiag(K)u): rounding errors of strains.
constexpr double roundoff = 1e-12;
// Of the change that errors of a solve may be, at most.
constexpr double share = 0.01;
// Of a solve: less is rounding errors.
constexpr double leastTolerance = 1e-13, firstTolerance = 1e-2;

// a + factor · b.
feti::TornVector sum(const feti::TornVector& a, double factor, const feti::TornVector& b) {
  feti::TornVector result = a;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < a[i].size(); ++k)
      result[i][k] += factor * b[i][k];
  return result;
}

DeformedBodies::Tangent tangentOf(const feti::SubdomainSystem& system) {
  DeformedBodies::Tangent result;
  for (int i = 0; i < system.size(); ++i) {
    result.matrices.push_back(system.subdomain(i).stiffness);
    result.kernels.push_back(system.subdomain(i).motions);
  }
  return result;
}

// Numbers of each rank's own; nothing on another number of ranks. Collective.
void exchangeOfRanks(const Teuchos::Comm<int>& comm, qp::StateArchive<MultiVector>& archive,
                     const std::string& name, std::vector<double>& numbers) {
  std::vector<double> counts, all;
  if (!archive.isReading()) {
    counts = gatherAll(comm, std::vector<double>{static_cast<double>(numbers.size())});
    all = gatherAll(comm, numbers);
  }
  archive.numbers(name + ", counts", counts);
  archive.numbers(name, all);
  if (!archive.isReading())
    return;
  numbers.clear();
  if (counts.size() != static_cast<std::size_t>(comm.getSize()))
    return;
  const auto own = counts.begin() + comm.getRank();
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(std::accumulate(counts.begin(), own, 0.0));
  numbers.assign(first, first + static_cast<std::ptrdiff_t>(*own));
}

// Of a solve within an iteration: what is kept is where the next one begins, not where the solver is.
class WatchedIteration : public feti::DualMonitor {
 public:
  WatchedIteration(RunMonitor& monitor, bool& isSaveDue) : monitor_(monitor), isSaveDue_(isSaveDue) {}

  void begins(const feti::DualRun& run) override { monitor_.begins(run); }
  void recorded(const qp::IterationRecord& record) override { monitor_.recorded(record); }
  Wish ask(const qp::IterationState<MultiVector>& state) override {
    const Wish wish = monitor_.ask(state);
    isSaveDue_ = isSaveDue_ || wish == Wish::Save;
    return wish == Wish::Save ? Wish::GoOn : wish;
  }
  void save(const Exchange&) override {}
  bool hasState() const override { return false; }
  bool holds(const std::string&) const override { return false; }
  void restore(const Exchange&) override {}

 private:
  RunMonitor& monitor_;
  bool& isSaveDue_;
};

} // namespace

EquilibriumLoop::EquilibriumLoop(const RunContext& context, RunStages& run, Motion* motion)
    : context_(context),
      run_(run),
      bodies_(*context.comm, context.scene, run.owned()),
      balance_(context, run, bodies_, motion),
      mixing_(*context.comm, norm_.weights),
      committed_{
          run.pipeline().system().zeroVector(), CarriedForces(context.scene), PointSlips(context.scene), {}},
      trial_(committed_),
      tangent_(bodies_, motion != nullptr ? motion->ofStressesAtRest() : tangentOf(run.pipeline().system()),
               committed_.displacement) {
  const feti::SubdomainSystem& system = run.pipeline().system();
  for (int i = 0; i < system.size(); ++i)
    norm_.weights.push_back(system.diagonal(i));
  feti::TornVector places = norm_.weights;
  const auto components = static_cast<std::size_t>(context.scene.components());
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t k = 0; k < places[i].size(); ++k)
      places[i][k] = run.owned()[i].mesh.position(static_cast<int>(k / components))[k % components];
  norm_.ofPlaces = weighed(places);
  norm_.largestPlace = largestOf(*context.comm, places);
}

// At finite displacements of all bodies, where it has become wrong; of those that yield.
void EquilibriumLoop::renewTangent(const DeformedBodies::Forces& forces) {
  tangent_.renew(trial_.displacement, trial_.time, forces.yields,
                 progress_.isSlow && context_.scene.isFinite());
  // Changes of other tangents say nothing of those to come; with consistent tangents of small displacements
  // they are Newton's own, and nothing is to be mixed.
  constexpr double same = 0.02;
  const bool isOther = std::abs(forces.yielding - progress_.yielding) > same * forces.yielding;
  if (isOther || (forces.yielding > 0.0 && !context_.scene.isFinite()))
    mixing_.restart();
  progress_.yielding = forces.yielding;
  progress_.isSlow = false;
}

// Of the tangent, which turns with the bodies. With rows that are weighted by stiffness, dof by dof, or
// clusters it stays as it is.
std::vector<std::optional<feti::Frame>> EquilibriumLoop::frames() const {
  if (run_.pipeline().constraints()->hasWeights() || run_.pipeline().inverses()->joined() != nullptr)
    return {};
  return tangent_.frames(trial_.displacement);
}

Balance::Loads EquilibriumLoop::forcesAtRest() {
  const feti::TornVector rest = run_.pipeline().system().zeroVector();
  const feti::TornVector internal = bodies_.forces(rest, 0.0).internal,
                         following = bodies_.followingLoads(rest, 0.0);
  const Loads dead = run_.loads().loads(0.0);
  Loads result;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    auto load = std::make_shared<std::vector<double>>(*dead[i]);
    for (std::size_t k = 0; k < load->size(); ++k)
      (*load)[k] += (following.empty() ? 0.0 : following[i][k]) - internal[i][k];
    result.push_back(load);
  }
  return result;
}

void EquilibriumLoop::begin(double from) {
  committed_.time = from;
  trial_ = committed_;
  tangent_.begin(committed_.displacement, committed_.time);
  mixing_.restart();
  progress_ = {};
  progress_.tolerance = firstTolerance;
  static_cast<feti::SolveReport&>(context_.report) = {};
  iterations_ = 0;
  isSaveDue_ = false;
  failure_.clear();
}

void EquilibriumLoop::goOn() {
  mixing_.restart();
  const double tolerance = progress_.tolerance, scale = progress_.scale;
  progress_ = {};
  progress_.tolerance = tolerance;
  progress_.scale = scale;
  progress_.before = iterations_;
}

void EquilibriumLoop::commit() {
  bodies_.setStates(std::move(trial_.states));
  trial_.states.clear();
  committed_ = trial_;
}

// To what made a step fail.
void EquilibriumLoop::blameFault(const feti::TornVector& displacement) {
  const std::string fault = balance_.faultOf(displacement);
  if (!fault.empty() && failure_.find(fault) == std::string::npos)
    failure_ += "; " + fault;
}

// Of loads that go with the bodies, on the way of the step: by the trapezoidal rule.
double EquilibriumLoop::followingWork(double time, const feti::TornVector& answer) {
  trial_.following = bodies_.followingLoads(answer, time);
  double work = 0.0;
  for (std::size_t i = 0; i < trial_.following.size(); ++i)
    for (std::size_t k = 0; k < answer[i].size(); ++k)
      work += 0.5 *
              (trial_.following[i][k] + (committed_.following.empty() ? 0.0 : committed_.following[i][k])) *
              (answer[i][k] - committed_.displacement[i][k]);
  return globalSum(*context_.comm, work);
}

// ∫∂W/∂θ dθ: what energies would change by at the displacements that the step began and ended with, in the
// mean. @param energy of the answer, stored and dissipated.
double EquilibriumLoop::thermalWork(const feti::TornVector& answer, double energy) const {
  if (!context_.scene.hasTemperatures(committed_.time) && !context_.scene.hasTemperatures(trial_.time))
    return 0.0;
  const auto at = [this](const feti::TornVector& displacement, double time) {
    const DeformedBodies::Forces forces = bodies_.forces(displacement, time);
    return forces.energy + forces.dissipated;
  };
  return 0.5 * (at(committed_.displacement, trial_.time) - at(committed_.displacement, committed_.time) +
                energy - at(answer, committed_.time));
}

void EquilibriumLoop::pose(double time, const DeformedBodies::Forces& forces) {
  const feti::TornVector& internal = forces.internal;
  const Loads loads = balance_.loadsAt(trial_.displacement);
  const feti::SubdomainSystem& system = run_.pipeline().system();
  RunStages::Iterate iterate;
  iterate.time = time;
  iterate.prescribed = run_.loads().prescribed(time);
  {
    const auto scope = context_.timers.scope("assembly");
    renewTangent(forces);
    iterate.tangent =
        balance_.motion() != nullptr ? balance_.motion()->tangentOf(tangent_.tangent()) : tangent_.tangent();
    iterate.frames = frames();
    for (std::size_t i = 0; i < internal.size(); ++i) {
      auto load = std::make_shared<std::vector<double>>(*loads[i]);
      for (std::size_t k = 0; k < load->size(); ++k)
        (*load)[k] -= internal[i][k];
      iterate.loads.push_back(load);
      const std::vector<feti::FixedDof>& fixed = system.subdomain(static_cast<int>(i)).fixed;
      for (std::size_t k = 0; k < fixed.size(); ++k)
        iterate.prescribed[i][k] -= trial_.displacement[i][static_cast<std::size_t>(fixed[k].dof)];
    }
  }
  {
    const auto scope = context_.timers.scope("dual_operator");
    iterate.contact = balance_.contactAt(trial_.displacement);
    iterate.slipsBefore = committed_.slips.of(iterate.contact);
    balance_.bonds().addSlipsBefore(iterate.contact, iterate.slipsBefore);
  }
  posed_ = iterate.loads;
  run_.prepare(std::move(iterate));
}

// @param start or null.
EquilibriumLoop::Outcome EquilibriumLoop::solveOnce(const feti::WarmStart* start, const Log& log,
                                                    RunMonitor& monitor, feti::DualSolution& solution) {
  feti::SolverOptions options = solverOptions(context_.scene, context_.options);
  options.progressFrequency = 0;
  options.tolerance = progress_.tolerance;
  const qp::Result before = context_.report.result;
  const bool goesOn = context_.report.solved;
  static_cast<feti::SolveReport&>(context_.report) = {};
  {
    const auto scope = context_.timers.scope("solve");
    solution = feti::solveDualProblem(run_.pipeline().stages(), options, start, {}, log, context_.report,
                                      Teuchos::rcp(new WatchedIteration(monitor, isSaveDue_)));
  }
  run_.pipeline().rethrowFailures();
  monitor.goesOnAfter(context_.report.result.lastRecord());
  if (goesOn)
    context_.report.result.goesOnAfter(before);
  if (context_.report.isInterrupted())
    return Outcome::Interrupted;
  if (context_.report.converged)
    return Outcome::Converged;
  failure_ =
      context_.report.reason + (solution.isEscaping ? "; unconstrained rigid-body mode under load" : "");
  return Outcome::Failed;
}

// Solves until what rows leave is small beside the change, or beside what is asked for.
EquilibriumLoop::Outcome EquilibriumLoop::solveProblem(const Log& log, RunMonitor& monitor, Change& change) {
  const feti::DualStages stages = run_.pipeline().stages();
  std::optional<feti::WarmStart> start;
  if (!trial_.forces.isEmpty())
    start = feti::WarmStart{trial_.forces.on(*stages.constraints, run_.contact()), trial_.motions, true};
  const Outcome outcome = solveTo(start, log, monitor, change);
  if (outcome == Outcome::Converged) {
    trial_.forces.keep(*stages.constraints, run_.contact(), *change.torn.multiplier);
    trial_.motions = change.motions;
  }
  return outcome;
}

// Of the change that errors of a solve may be: no more than what the next change will be where changes come
// down quadratically, as they do with consistent tangents, m₊/m = (m/m₋)² (Eisenstat and Walker, SIAM J. Sci.
// Comput. 17, 1996, choice 2).
double EquilibriumLoop::forcing(double merit) const {
  if (!(progress_.last > 0.0))
    return share;
  const double ratio = merit / progress_.last;
  return std::min(share, ratio * ratio);
}

// To errors that are small beside the change.
EquilibriumLoop::Outcome EquilibriumLoop::solveTo(const std::optional<feti::WarmStart>& given, const Log& log,
                                                  RunMonitor& monitor, Change& change) {
  const feti::DualStages stages = run_.pipeline().stages();
  std::optional<feti::WarmStart> start = given;
  double last = std::numeric_limits<double>::infinity();
  while (true) {
    feti::DualSolution solution;
    if (const Outcome outcome = solveOnce(start ? &*start : nullptr, log, monitor, solution);
        outcome != Outcome::Converged)
      return outcome;
    const auto scope = context_.timers.scope("recovery");
    change.torn = feti::recover(*stages.system, *stages.constraints, *stages.inverses, *stages.coarse,
                                *stages.problem, *solution.lambda, solution.mu);
    change.motions = solution.mu;
    change.joined = change.torn.displacement;
    stages.system->leaveFrames(change.joined);
    change.jump = bodies_.joinCopies(change.joined);
    change.merit = meritOf(change.joined);
    const double error = feti::energyError(stages, run_.pipeline().scaling(), change.torn),
                 allowed = std::max(forcing(change.merit) * change.merit,
                                    share * context_.options.tolerance * progress_.scale);
    constexpr double further = 0.5; // or errors are those of rounding
    if (error <= allowed || progress_.tolerance <= leastTolerance || error > further * last)
      break;
    last = error;
    progress_.tolerance =
        std::max(leastTolerance, std::min(0.5, 0.5 * allowed / error) * progress_.tolerance);
    start = feti::WarmStart{change.torn.multiplier, solution.mu, true};
  }
  return Outcome::Converged;
}

// K̂du, without frames.
feti::TornVector EquilibriumLoop::image(const feti::TornVector& change) const {
  const feti::SubdomainSystem& system = run_.pipeline().system();
  feti::TornVector inFrames = change, result = change;
  system.enterFrames(inFrames);
  for (std::size_t i = 0; i < inFrames.size(); ++i)
    system.subdomain(static_cast<int>(i)).stiffness->multiply(inFrames[i].data(), result[i].data());
  system.leaveFrames(result);
  return result;
}

// ‖du‖_K̂.
double EquilibriumLoop::meritOf(const feti::TornVector& change) const {
  return std::sqrt(std::max(0.0, workOf(image(change), change)));
}

// u + s du, s = 1 or as much of it as leaves all cells as they should be, and as is of use. @param stiffness
// of bodies along du, over that of the tangent. @return whether s = 1.
bool EquilibriumLoop::advance(const Change& change, feti::TornVector& answer, DeformedBodies::Forces& forces,
                              double& stiffness) {
  const double before = workOf(forces.internal, change.joined),
               ofInertia =
                   balance_.motion() != nullptr ? balance_.motion()->stiffnessAlong(change.joined) : 0.0;
  // Bodies in motion turn by as much as they do in a step, most of it in the first iteration.
  bool turns =
      balance_.motion() != nullptr && context_.scene.isFinite() && iterations_ == progress_.before + 1;
  const auto go = [&](double part) {
    answer = turns ? bodies_.turned(trial_.displacement, change.joined)
                   : sum(trial_.displacement, part, change.joined);
    forces = balance_.forcesAt(answer);
    const double work = workOf(forces.internal, change.joined) - before + part * ofInertia;
    stiffness = change.merit > 0.0 ? work / (change.merit * change.merit) : 0.0;
    return forces.isSound;
  };
  if (turns && go(1.0)) {
    stiffness = 1.0; // of another way than that of the change
    return true;
  }
  turns = false;
  constexpr double least = 1e-3;
  for (double part = 1.0; part > least; part *= 0.5)
    if (go(part))
      return part == 1.0 && !isShortened(go, stiffness);
  failure_ = "cells turn inside out";
  return false;
}

// Searches along du at small displacements, where bodies and contacts have a convex potential: beyond where
// bodies resist du as the tangent says that they resist all of it, duᵀ(f_int(u + s du) − f_int(u)) = ‖du‖²_K̂,
// the potential rises (contacts and springs only take from its slope there). Not on the first way of a solve,
// which leads to what is prescribed. @param go to a part of du. @return whether the answer is short of all.
bool EquilibriumLoop::isShortened(const std::function<bool(double)>& go, double& stiffness) const {
  if (context_.scene.isFinite() || iterations_ <= progress_.before + 1 || !(stiffness > stiffening))
    return false;
  constexpr int most = 8;
  constexpr double enough = 0.3;
  double low = 0.0, atLow = -1.0, high = 1.0, atHigh = stiffness - 1.0, last = atHigh;
  for (int i = 0; i < most; ++i) { // regula falsi, Illinois' rule
    const double part = (low * atHigh - high * atLow) / (atHigh - atLow);
    go(part);
    const double value = stiffness - 1.0;
    if (std::abs(value) < enough)
      break;
    const double stale = value * last > 0.0 ? 0.5 : 1.0;
    if (value < 0.0) {
      low = part;
      atLow = value;
      atHigh *= stale;
    } else {
      high = part;
      atHigh = value;
      atLow *= stale;
    }
    last = value;
  }
  return true;
}

// Whether changes have not come down, from so many iterations to as many, in the geometric mean: one by one
// they go up and down.
bool EquilibriumLoop::isStuck(double merit) {
  constexpr std::size_t window = 8;
  constexpr double less = 0.9;
  progress_.logarithms.push_back(std::log(std::max(merit, std::numeric_limits<double>::min())));
  if (progress_.logarithms.size() > 2 * window)
    progress_.logarithms.erase(progress_.logarithms.begin());
  const auto middle = progress_.logarithms.begin() + window;
  const bool isStuck = iterations_ - progress_.before >= mostIterations || !std::isfinite(merit) ||
                       (progress_.logarithms.size() == 2 * window &&
                        std::accumulate(middle, progress_.logarithms.end(), 0.0) >
                            std::accumulate(progress_.logarithms.begin(), middle, window * std::log(less)));
  if (isStuck)
    failure_ = "Newton's iterations do not converge: the last of " + std::to_string(iterations_) +
               " changes displacements by " + scientific(merit / progress_.scale, 1) + " in the energy norm";
  return isStuck;
}

EquilibriumLoop::Outcome EquilibriumLoop::solve(double time, const Log& log, RunMonitor& monitor,
                                                const std::function<void()>& save) {
  const auto fail = [this](const Error& error) {
    failure_ = error.what();
    tangent_.reset(committed_.displacement, committed_.time); // it may be what was wrong
    return Outcome::Failed;
  };
  try {
    const Outcome outcome = iterate(time, log, monitor, save);
    if (outcome == Outcome::Failed)
      blameFault(trial_.displacement);
    return outcome;
  } catch (const NumericalError& error) { // on all ranks: of a state on the way, which smaller steps avoid
    return fail(error);
  } catch (const InputError& error) { // of matrices, which are right at rest
    if (!error.isAgreed())
      throw;
    return fail(error);
  }
}

EquilibriumLoop::Outcome EquilibriumLoop::iterate(double time, const Log& log, RunMonitor& monitor,
                                                  const std::function<void()>& save) {
  balance_.begin(time, committed_.displacement);
  if (balance_.motion() != nullptr)
    balance_.motion()->beginStep(time - committed_.time);
  trial_.time = time;
  DeformedBodies::Forces forces = balance_.forcesAt(trial_.displacement);
  if (!forces.isSound) {
    failure_ = "cells turn inside out where the step begins";
    return Outcome::Failed;
  }
  while (true) {
    ++iterations_;
    pose(time, forces);
    Change change;
    if (const Outcome outcome = solveProblem(log, monitor, change); outcome != Outcome::Converged) {
      --iterations_;
      return outcome;
    }
    feti::TornVector answer;
    double stiffness = 0.0;
    const bool isWhole = advance(change, answer, forces, stiffness);
    if (!failure_.empty())
      return Outcome::Failed;
    progress_.scale = scaleOf(answer, forces.energy);
    tell(change.merit);
    if (isWhole && change.merit <= context_.options.tolerance * progress_.scale &&
        hasConverged(time, answer, forces, change, log, monitor))
      return failure_.empty() ? Outcome::Converged : Outcome::Failed;
    const bool isWrong = isWhole && std::abs(stiffness - 1.0) > wrong,
               isSlow = iterations_ > progress_.before + 1 && change.merit > contraction * progress_.last;
    progress_.isSlow = (isSlow && isWrong) || stiffness > stiffening;
    progress_.last = change.merit;
    if (isStuck(change.merit)) {
      blameFault(answer); // it may be in every other iterate
      return Outcome::Failed;
    }
    moveOn(answer, isWhole, forces);
    if (isSaveDue_)
      save();
    isSaveDue_ = false;
  }
}

bool EquilibriumLoop::hasConverged(double time, const feti::TornVector& answer,
                                   const DeformedBodies::Forces& forces, const Change& change, const Log& log,
                                   RunMonitor& monitor) {
  const Loads loads = balance_.loadsAt(answer);
  const Balance::Answer given = {answer, forces, loads, trial_.forces, change.torn, change.jump};
  const feti::KktAudit audited = balance_.audit(given);
  if (!agrees(audited, answer))
    return false;
  failure_ = balance_.faultOf(answer);
  if (failure_.empty())
    failure_ = instability(answer, change, log, monitor);
  if (!failure_.empty())
    return true;
  trial_.displacement = answer;
  tangent_.noteYielding(forces.yields);
  trial_.energy = forces.energy;
  trial_.dissipated = forces.dissipated;
  trial_.states = bodies_.statesAfter(answer, time);
  trial_.forceSize = audited.forces;
  work_ = followingWork(time, answer) + thermalWork(answer, forces.energy + forces.dissipated);
  if (balance_.motion() != nullptr)
    balance_.motion()->reach(answer);
  run_.take({change.torn, answer, loads, balance_.reactions(given), audited, &trial_.states});
  trial_.slips.keep(run_.contact(), context_.report.contact);
  return true;
}

// K_T v, by central differences. @param share of strains.
feti::TornVector EquilibriumLoop::wholeStiffness(const feti::TornVector& answer,
                                                 const feti::TornVector& motion, double share) const {
  const double step = share * progress_.scale;
  feti::TornVector result = balance_.at(sum(answer, -step, motion), trial_.forces);
  const feti::TornVector beyond = balance_.at(sum(answer, step, motion), trial_.forces);
  for (std::size_t i = 0; i < result.size(); ++i)
    for (std::size_t k = 0; k < result[i].size(); ++k)
      result[i][k] = (result[i][k] - beyond[i][k]) / (2.0 * step);
  return result;
}

// By how much more bodies move under a force, however large.
std::optional<feti::TornVector> EquilibriumLoop::motionUnder(const feti::TornVector& force,
                                                             const Change& change, const Log& log,
                                                             RunMonitor& monitor) {
  double square = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i)
    for (std::size_t k = 0; k < force[i].size(); ++k)
      square += norm_.weights[i][k] > 0.0 ? force[i][k] * force[i][k] / norm_.weights[i][k] : 0.0;
  constexpr double share = 1e-6; // what contacts that are closed stay so under, and soft motions are large by
  const double factor = share * progress_.scale / std::sqrt(globalSum(*context_.comm, square));
  if (!std::isfinite(factor))
    return std::nullopt;
  Loads loads;
  for (std::size_t i = 0; i < force.size(); ++i) {
    auto load = std::make_shared<std::vector<double>>(*posed_[i]);
    for (std::size_t k = 0; k < load->size(); ++k)
      (*load)[k] += factor * force[i][k];
    loads.push_back(load);
  }
  Change more;
  run_.pipeline().setLoads(loads);
  try {
    if (solveTo(feti::WarmStart{change.torn.multiplier, trial_.motions, true}, log, monitor, more) ==
        Outcome::Converged)
      return sum(more.joined, -1.0, change.joined);
  } catch (const NumericalError&) { // on all ranks: the force is on a motion that nothing holds
  }
  return std::nullopt;
}

// Whether energy comes free along a motion that contacts allow: a sentence, or nothing.
std::string EquilibriumLoop::instability(const feti::TornVector& answer, const Change& change, const Log& log,
                                         RunMonitor& monitor) {
  // Forces of what yields have a kink at each state.
  // Bodies in motion that buckle do so in time.
  if (!(progress_.scale > 0.0) || !context_.scene.isFinite() || context_.scene.yields() ||
      balance_.motion() != nullptr)
    return {};
  const feti::SolveReport before = context_.report;
  feti::TornVector force = norm_.weights; // to all sides, as hard as bodies are stiff
  for (std::size_t i = 0; i < force.size(); ++i) {
    std::minstd_rand random(static_cast<unsigned>(run_.owned()[i].number + 1));
    for (double& entry : force[i])
      entry = std::sqrt(entry) * (2.0 * static_cast<double>(random()) / std::minstd_rand::max() - 1.0);
  }
  constexpr double step = 1e-5, less = 0.125;
  const StiffnessActions actions = {
      [&](const feti::TornVector& f) { return motionUnder(f, change, log, monitor); },
      [&](const feti::TornVector& v) { return image(v); },
      [&](const feti::TornVector& v) { return wholeStiffness(answer, v, step); },
      [&](const feti::TornVector& v, const feti::TornVector& f) { return workOf(f, v); }};
  const std::optional<LeastStiffness> least = leastStiffness(actions, std::move(force));
  run_.pipeline().setLoads(posed_);
  failure_.clear();
  const qp::Result counted = context_.report.result;
  static_cast<feti::SolveReport&>(context_.report) = before;
  context_.report.result.counters = counted.counters;
  if (!least || !least->isBelowZero())
    return {};
  // Forces that jump, as where contacts end at edges, have differences that grow as steps become smaller.
  const double again = workOf(wholeStiffness(answer, least->motion, less * step), least->motion);
  if (!(again < 0.5 * least->value && again > 2.0 * least->value))
    return {};
  return "the equilibrium is not stable: bodies that are moved a little buckle, most of all at " +
         placeText(bodies_.placeOfLargest(least->motion)) + " (stiffness along this " +
         scientific(least->value) + " of that without stresses)";
}

double EquilibriumLoop::workOf(const feti::TornVector& forces, const feti::TornVector& displacement) const {
  double work = 0.0;
  for (std::size_t i = 0; i < forces.size(); ++i)
    for (std::size_t k = 0; k < forces[i].size(); ++k)
      work += forces[i][k] * displacement[i][k];
  return globalSum(*context_.comm, work);
}

// √(vᵀdiag(K)v).
double EquilibriumLoop::weighed(const feti::TornVector& values) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t k = 0; k < values[i].size(); ++k)
      sum += norm_.weights[i][k] * values[i][k] * values[i][k];
  return std::sqrt(globalSum(*context_.comm, sum));
}

// √(2W) here and √(ΔvᵀMΔv), or √(2W) where the step began: what bodies that let go of all their strains come
// down from. Of bodies that but move, or nothing does, the scale of rounding errors by which strains, and
// gaps, are known, over the tolerance.
double EquilibriumLoop::scaleOf(const feti::TornVector& answer, double energy) const {
  return std::max({std::sqrt(2.0 * energy), std::sqrt(2.0 * committed_.energy),
                   balance_.motion() != nullptr ? balance_.motion()->velocityChange(answer) : 0.0,
                   roundoff * weighed(answer) / context_.options.tolerance,
                   std::numeric_limits<double>::epsilon() * norm_.ofPlaces / context_.options.tolerance});
}

void EquilibriumLoop::tell(double merit) const {
  const double share = progress_.scale > 0.0 ? merit / progress_.scale : 0.0;
  context_.log.info("  Newton iteration " + std::to_string(iterations_) + ": change " + scientific(share, 1) +
                    ", " + std::to_string(context_.report.result.counters.hessianApplications) +
                    " applications of F" +
                    (context_.report.inequalities > 0
                         ? ", " + std::to_string(context_.report.inequalities) + " contact points"
                         : ""));
}

// Of materials.
void EquilibriumLoop::exchangeStates(TornArchive& torn) {
  DeformedBodies::States states = bodies_.states();
  feti::TornVector numbers;
  for (const fem::MaterialStates& of : states)
    numbers.push_back(of.numbers);
  torn.exchangeNumbers("states of materials", numbers);
  for (std::size_t i = 0; i < states.size(); ++i)
    states[i].numbers = numbers[i];
  bodies_.setStates(std::move(states));
}

void EquilibriumLoop::exchange(qp::StateArchive<MultiVector>& archive, bool isWithinStep) {
  TornArchive torn(archive, run_.pipeline().system());
  const feti::Constraints& constraints = *run_.pipeline().constraints();
  torn.exchange("displacement", committed_.displacement);
  committed_.forces.exchange(archive, "forces", constraints);
  committed_.slips.exchange(*context_.comm, archive);
  archive.number("time committed", committed_.time);
  exchangeOfRanks(*context_.comm, archive, "motions", committed_.motions);
  archive.number("energy", committed_.energy);
  archive.number("dissipated by materials", committed_.dissipated);
  exchangeStates(torn);
  archive.number("size of forces", committed_.forceSize);
  bool follows = !committed_.following.empty();
  archive.number("loads follow", follows);
  if (follows)
    torn.exchange("following loads", committed_.following);
  tangent_.exchange(torn, archive.isReading());
  if (!isWithinStep)
    return;
  archive.number("time of the iteration", trial_.time);
  torn.exchange("displacement of the iteration", trial_.displacement);
  trial_.forces.exchange(archive, "forces of the iteration", constraints);
  exchangeOfRanks(*context_.comm, archive, "motions of the iteration", trial_.motions);
  archive.number("Newton iterations", iterations_);
  archive.number("tolerance of solves", progress_.tolerance);
  archive.number("scale of the merit", progress_.scale);
  archive.numbers("logarithms of merits", progress_.logarithms);
  archive.number("last merit", progress_.last);
  archive.number("tangent is to be made anew", progress_.isSlow);
  archive.number("Newton iterations of solves before", progress_.before);
  archive.number("points that yield", progress_.yielding);
  std::size_t entries = mixing_.size();
  archive.number("iterates mixed", entries);
  int place = 0;
  mixing_.visit(entries,
                [&](feti::TornVector& values) { torn.exchange("mixed " + std::to_string(place++), values); });
  archive.number("Newton solved", context_.report.solved);
  qp::exchangeResult(archive, "Newton ", context_.report.result);
}

// To where the next iteration begins.
void EquilibriumLoop::moveOn(const feti::TornVector& answer, bool isWhole, DeformedBodies::Forces& forces) {
  const feti::TornVector change = sum(answer, -1.0, trial_.displacement);
  trial_.displacement = answer;
  if (!isWhole) {
    mixing_.restart();
    return;
  }
  const feti::TornVector mixed = mixing_.next(answer, change);
  DeformedBodies::Forces ofMixed = balance_.forcesAt(mixed);
  if (!ofMixed.isSound)
    return;
  trial_.displacement = mixed;
  forces = std::move(ofMixed);
}

// Forces in balance, and nothing that penetrates, to the share that answers of small displacements are
// allowed; of penetrations as a share of how far bodies have moved in the step.
bool EquilibriumLoop::agrees(const feti::KktAudit& audited, const feti::TornVector& answer) const {
  const double allowed = feti::auditShare(context_.options.tolerance);
  const double moved = largestOf(*context_.comm, sum(answer, -1.0, committed_.displacement));
  constexpr double rounding = 1e-12, ofPlaces = 4.0 * std::numeric_limits<double>::epsilon();
  const double places = ofPlaces * norm_.largestPlace; // to which gaps are known
  // Forces of bodies that nothing strains any more are beside those that the step began with, and rounding
  // errors of stiffness times displacement.
  return audited.equilibrium * audited.forces <=
             allowed * std::max(audited.forces, committed_.forceSize) +
                 audited.unitForce * (rounding * audited.largestDisplacement + places) &&
         audited.penetration <= allowed * moved + rounding * audited.largestDisplacement + places;
}

} // namespace Harmos::run
