// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ShapeRun.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_BoundaryParts.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_GapProfile.hpp"
#include "Harmos_ProcessMemory.hpp"
#include "Harmos_Rendezvous.hpp"
#include "Harmos_RunMonitor.hpp"
#include "Harmos_ShapeModel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace Harmos::shape {
namespace {

// What ends an optimisation from within.
struct Halt {
  bool isSignal;
  std::string reason;
};

// Of a deck, what the solver knows; the rest is the run's.
Teuchos::ParameterList solverParameters(const Teuchos::ParameterList& deck, const scene::Scene& scene,
                                        const run::RunOptions& options) {
  Teuchos::ParameterList list = feti::FetiSolver::parameters().commonPart(deck);
  list.sublist("Decomposition")
      .set("Dirichlet", run::dirichletForm(scene, options) == feti::DirichletForm::Dual ? "dual" : "primal");
  list.sublist("Solver").set("Progress frequency", 0);
  const feti::SolverOptions solver = run::solverOptions(scene, options);
  if (solver.methodLists.isSublist("PDAS") &&
      solver.methodLists.sublist("PDAS").isParameter("First active set"))
    list.sublist("Solver").sublist("Expert").sublist("PDAS").set(
        "First active set", solver.methodLists.sublist("PDAS").get<std::string>("First active set"));
  return list;
}

} // namespace

ShapeRun::ShapeRun(Teuchos::RCP<const Teuchos::Comm<int>> comm, const scene::Scene& scene,
                   const Teuchos::ParameterList& deck, const run::RunOptions& options, const Log& log,
                   std::chrono::steady_clock::time_point begin, run::RunReport& report)
    : comm_(std::move(comm)),
      scene_(scene),
      deckList_(deck),
      deck_(ShapeDeck::fromDeck(deck, scene)),
      options_(options),
      log_(log),
      begin_(begin),
      report_(report),
      directory_(*comm_, options) {}

double ShapeRun::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void ShapeRun::go() {
  report_.restartedFrom = directory_.restartedFrom();
  directory_.checkDeck();
  directory_.prepare(log_);
  agree(*comm_, [&] {
    if (comm_->getRank() == 0)
      for (const char* name : {"history.csv", "shape.csv", "design.csv", "before.vtkhdf"})
        io::removeFile(directory_.place(name));
  });
  setUp();
  solveFirst();
  restore();
  optimise();
}

void ShapeRun::setUp() {
  report_.ranks = comm_->getSize();
  report_.scene = scene_.name;
  for (const scene::Body& body : scene_.bodies)
    report_.bodies.push_back(body.name);
  report_.effects = scene_.effectKinds();
  report_.tolerance = options_.tolerance;
  report_.toleranceRule = "fixed";
  report_.stoppingRule = feti::toString(options_.stoppingRule);
  owned_ =
      scene::decompose(*comm_, scene_,
                       feti::mayJoin(options_.dual.clusters, comm_->getSize()) ? scene::Numbering::Compact
                                                                               : scene::Numbering::AsMade);
  scene::checkBoundaryParts(*comm_, scene_, owned_);
  deck_.checkParts(scene_, scene::gatherPartNames(*comm_, scene_.bodies.size(), owned_));
  std::vector<feti::Subdomain> subdomains;
  agree(*comm_, [&] { subdomains = scene::assemble(scene_, owned_); });
  contact_ = scene::setUpContact(*comm_, scene_, owned_);
  for (const std::string& note : contact_.notes)
    log_.info(note);
  if (deck_.kind == ShapeDeck::Kind::Position)
    sensitivity::completeRows(contact_, scene_.components());
  solver_ =
      std::make_unique<feti::FetiSolver>(comm_, std::move(subdomains), contact_.rows,
                                         solverParameters(deckList_, scene_, options_), log_.withoutInfo());
  makeModel();
  space_ = deck_.space(model_->weights());
  best_ = space_.start;
  makeFunctional();
  cost_ = std::make_unique<sensitivity::ContactCost>(*solver_, *model_, *functional_, deck_.sign);
  volume_ = std::make_unique<sensitivity::DesignVolume>(*model_);
  record_ = std::make_unique<DesignRecord>(*cost_, [this] { askBefore(); });
  setUpSeconds_ = elapsed();
  std::ostringstream text;
  text << "Scene \"" << scene_.name << "\": " << solver_->system().globalSubdomains() << " subdomains on "
       << comm_->getSize() << (comm_->getSize() == 1 ? " rank" : " ranks") << ", "
       << solver_->system().primalDimension() << " unknowns, " << solver_->constraints()->inequalities()
       << " contact points\nDesign of " << space_.size()
       << (deck_.kind == ShapeDeck::Kind::Gap ? " numbers: gaps" : " numbers: positions of nodes")
       << "; cost: "
       << (deck_.quantity == "softest"    ? "J = min u'Ku/2 - f'u (softest)"
           : deck_.quantity == "stiffest" ? "-J = -min (u'Ku/2 - f'u) (stiffest)"
                                          : deck_.quantity);
  log_.info(text.str());
}

sensitivity::ShapeMap ShapeRun::shapeMap() const {
  constexpr double far = std::numeric_limits<double>::infinity();
  const double length = std::hypot(deck_.direction[0], deck_.direction[1], deck_.direction[2]);
  std::vector<double> most(7, -far);  // of x, −x and level on the surface
  std::vector<double> reach(2, -far); // of ±X·d over the bodies
  for (const scene::OwnedSubdomain& item : owned_) {
    const auto along = [&](int node) {
      const fem::Point x = item.mesh.position(node);
      return (x[0] * deck_.direction[0] + x[1] * deck_.direction[1] + x[2] * deck_.direction[2]) / length;
    };
    if (deck_.bodies.count(item.body) > 0)
      for (int node = 0; node < item.mesh.mesh->numberOfNodes(); ++node) {
        reach[0] = std::max(reach[0], along(node));
        reach[1] = std::max(reach[1], -along(node));
      }
    const auto part = item.mesh.sets.find(deck_.part);
    if (item.body != deck_.body || part == item.mesh.sets.end())
      continue;
    for (int node : part->second) {
      const fem::Point x = item.mesh.position(node);
      for (std::size_t d = 0; d < 3; ++d) {
        most[d] = std::max(most[d], x[d]);
        most[3 + d] = std::max(most[3 + d], -x[d]);
      }
      most[6] = std::max(most[6], along(node));
    }
  }
  globalMax(*comm_, most);
  globalMax(*comm_, reach);
  const double depth = deck_.depth > 0.0 ? deck_.depth : std::max(reach[0] - most[6], reach[1] + most[6]);
  return {deck_.basis(scene_, {-most[3], -most[4], -most[5]}, {most[0], most[1], most[2]}), deck_.direction,
          most[6], depth};
}

void ShapeRun::makeModel() {
  const sensitivity::RowGeometry geometry = sensitivity::geometryOf(contact_, scene_);
  std::optional<sensitivity::TensorSplineBasis> basis;
  if (deck_.kind == ShapeDeck::Kind::Position) {
    sensitivity::ShapeMap map = shapeMap();
    basis = map.basis();
    auto moved = std::make_unique<sensitivity::ShapeModel>(*solver_, scene_, owned_, contact_, std::move(map),
                                                           deck_.bodies, deck_.leastQuality);
    moved_ = moved.get();
    model_ = std::move(moved);
  } else if (deck_.byNodes) {
    auto profile =
        std::make_unique<sensitivity::GapProfile>(*solver_, contact_.rows, geometry, deck_.surfaces);
    profile_ = profile.get();
    model_ = std::move(profile);
  } else {
    const auto [low, high] = sensitivity::extentOfPoints(*comm_, geometry, deck_.surfaces);
    basis = deck_.basis(scene_, low, high);
    model_ =
        std::make_unique<sensitivity::GapProfile>(*solver_, contact_.rows, geometry, deck_.surfaces, *basis);
  }
  for (int k = 0; basis && k < basis->size(); ++k)
    places_.push_back(basis->abscissa(k));
}

// A share for each node of the part, and each copy of it, in every subdomain.
feti::TornVector ShapeRun::meanDisplacement() const {
  std::vector<std::pair<long long, int>> known;
  std::vector<long long> asked;
  for (const scene::OwnedSubdomain& item : owned_)
    if (const auto part = item.mesh.sets.find(deck_.displacedPart);
        item.body == deck_.displacedBody && part != item.mesh.sets.end())
      for (int node : part->second) {
        known.emplace_back(item.mesh.number(node), 1);
        asked.push_back(item.mesh.number(node));
      }
  const std::vector<std::optional<int>> copies =
      lookUpMerged(*comm_, known, asked, [](int& present, int next) { present += next; });
  double nodes = 0.0;
  for (const std::optional<int>& count : copies)
    nodes += 1.0 / *count;
  nodes = globalSum(*comm_, nodes);
  feti::TornVector weights = solver_->system().zeroVector();
  const auto components = static_cast<std::size_t>(scene_.components());
  std::size_t next = 0;
  for (std::size_t i = 0; i < owned_.size(); ++i)
    if (const auto part = owned_[i].mesh.sets.find(deck_.displacedPart);
        owned_[i].body == deck_.displacedBody && part != owned_[i].mesh.sets.end())
      for (int node : part->second) {
        const double share = 1.0 / (nodes * *copies[next++]);
        for (std::size_t c = 0; c < components; ++c)
          weights[i][static_cast<std::size_t>(node) * components + c] =
              share * deck_.displacedDirection[components == 1 ? 2 : c];
      }
  return weights;
}

void ShapeRun::makeFunctional() {
  if (deck_.quantity == "peak pressure")
    functional_ = std::make_unique<sensitivity::PressureNorm>(deck_.pressed, deck_.exponent);
  else if (deck_.quantity == "pressure spread")
    functional_ = std::make_unique<sensitivity::PressureSpread>(deck_.pressed);
  else if (deck_.quantity == "displacement")
    functional_ = std::make_unique<sensitivity::LinearDisplacement>(meanDisplacement());
  else
    functional_ = std::make_unique<sensitivity::Energy>();
}

Answer ShapeRun::answer() const {
  if (moved_ != nullptr)
    return {*comm_, scene_, moved_->owned(), moved_->contact(), *solver_};
  return {*comm_, scene_, owned_, contact_, *solver_};
}

SurfaceState ShapeRun::state() const {
  return surfaceState(answer().contact, model_->rows(), model_->geometry(), cost_->forces());
}

// The design with which it begins has to have an answer; with --restart, too, for pictures of before.
void ShapeRun::solveFirst() {
  const double begin = elapsed();
  costBefore_ = cost_->value(space_.start, 0.0);
  firstValueSeconds_ = elapsed() - begin;
  before_ = state();
  const sensitivity::PressureSummary pressure =
      sensitivity::pressureSummary(*comm_, cost_->forces(), model_->geometry(), deck_.pressed);
  report_.results["cost_before"] = costBefore_;
  report_.results["peak_pressure_before"] = pressure.peak;
  report_.results["mean_pressure_before"] = pressure.mean;
  const double writing = elapsed();
  if (options_.writeFields)
    writeFields(answer(), directory_.place("before.vtkhdf"), options_.writeStresses);
  outputSeconds_ += elapsed() - writing;
}

void ShapeRun::restore() {
  const run::CheckpointReader* checkpoint = directory_.checkpoint();
  if (checkpoint == nullptr)
    return;
  checkpoint->restore(run::rowBasis(*solver_->problem()),
                      [&](qp::StateArchive<MultiVector>& archive) { exchange(archive); });
  record_->setRefusals(checkpoint->text("refusals"));
  log_.info("Restart from \"" + report_.restartedFrom + "\": stored results are reused");
}

// Answers, and where the next solution starts: without that it would differ from that of a run that was not
// interrupted, within the tolerance.
void ShapeRun::exchange(qp::StateArchive<MultiVector>& archive) {
  record_->exchange(archive);
  bool hasStarts = !solver_->problem().is_null();
  archive.number("starts are known", hasStarts);
  if (hasStarts)
    solver_->exchangeStarts(archive);
}

// Before a solution: the last moment to stop without losing one.
void ShapeRun::askBefore() {
  const auto told = static_cast<run::Told>(globalMax(
      *comm_,
      static_cast<long long>(options_.checkpoint.told ? options_.checkpoint.told() : run::Told::Nothing)));
  const double now = globalMax(*comm_, elapsed());
  const bool isDue =
      options_.checkpoint.minutes > 0.0 && now - lastSave_ >= 60.0 * options_.checkpoint.minutes;
  if (told == run::Told::Stop)
    throw Halt{true, qp::toString(qp::Reason::Interrupted) + ": stop requested"};
  if (told == run::Told::Save || isDue) {
    save();
    lastSave_ = now;
  }
  if (deck_.mostEvaluations > 0 && record_->values() >= deck_.mostEvaluations)
    throw Halt{false,
               "\"Shape/Limits/Evaluations\", " + std::to_string(deck_.mostEvaluations) + ", are used up"};
  if (deck_.mostSeconds > 0.0 && now > deck_.mostSeconds)
    throw Halt{false, "\"Shape/Limits/Seconds\", " + scientific(deck_.mostSeconds) + ", are used up"};
}

// Iterates of the method that the one for constraints that are not linear calls have no gradient norm of
// their own.
void ShapeRun::accepted(const rol::Iterate& iterate) {
  const double norm = iterate.isInner ? std::numeric_limits<double>::quiet_NaN() : iterate.gradientNorm;
  history_.push_back({static_cast<int>(history_.size()), record_->values(), iterate.cost, norm,
                      iterate.violation, iterate.step, record_->refused(), elapsed()});
  // Where constraints are met by the end alone, a cost that is less says nothing.
  if (!model_->hasLinearVolume() || iterate.cost <= history_[bestRow_].cost) {
    best_ = iterate.design;
    bestRow_ = history_.size() - 1;
  }
  std::ostringstream text;
  text << "Iterate " << history_.back().iteration << ": cost " << scientific(iterate.cost, 6);
  if (!iterate.isInner)
    text << ", |gradient| " << scientific(norm);
  text << ", " << record_->values() << " evaluations";
  if (!deck_.volume.empty())
    text << ", constraint violation " << scientific(iterate.violation, 0);
  log_.info(text.str());
  if (!record_->isRecalling()) {
    writeHistory();
    writeDesign();
  }
}

void ShapeRun::writeHistory() const {
  agree(*comm_, [&] {
    if (comm_->getRank() == 0)
      io::writeAtomically(directory_.place("history.csv"), historyText(history_));
  });
}

void ShapeRun::writeDesign() const {
  agree(*comm_, [&] {
    if (comm_->getRank() == 0)
      io::writeAtomically(directory_.place("design.csv"), designText(space_, best_, places_));
  });
}

void ShapeRun::save() {
  const std::string path = run::checkpointPath(options_.outputDirectory);
  try {
    std::string assignments;
    for (const std::string& assignment : options_.checkpoint.assignments)
      assignments += assignment + '\0'; // which none of them contains
    run::StateSize size;
    exchange(size);
    const std::string refusals = record_->refusals();
    const std::size_t texts = options_.checkpoint.deck.size() + options_.checkpoint.deckFile.size() +
                              assignments.size() + refusals.size();
    const Teuchos::RCP<const feti::DualProblem> problem = solver_->problem();
    const run::RowBasis basis = problem.is_null() ? run::RowBasis() : run::rowBasis(*problem);
    run::CheckpointWriter writer(*comm_, path, basis, size.bytes() + static_cast<long long>(texts));
    writer.text("deck", options_.checkpoint.deck);
    writer.text("deck file", options_.checkpoint.deckFile);
    writer.text("assignments", assignments);
    writer.text("refusals", refusals);
    exchange(writer);
    writer.commit();
  } catch (const InputError& error) {
    report_.checkpointFault = error.what();
    log_.warning(std::string("no checkpoint: ") + error.what());
    return;
  }
  report_.checkpointFault.clear();
  report_.checkpoint = path;
  ++report_.checkpoints;
}

sensitivity::DesignProblem ShapeRun::problem() {
  sensitivity::DesignProblem problem;
  problem.space = space_;
  problem.cost = record_.get();
  if (!deck_.volume.empty())
    problem.constraints.push_back(
        {"volume", volume_.get(), deck_.volume.front(), deck_.volume.back(), model_->hasLinearVolume()});
  return problem;
}

// A design by nodes in which points are open is stationary in their gaps, and may be far from the best: where
// pressures are the cost such points are closed, and the optimiser begins again from there, as long as that
// pays.
std::vector<double> ShapeRun::reclosed(const std::vector<double>& design) {
  if (profile_ == nullptr || (deck_.quantity != "peak pressure" && deck_.quantity != "pressure spread"))
    return {};
  return record_->derived(design, [&] {
    cost_->value(design, 0.0);
    return profile_->reclosed(design, cost_->response(), space_).value_or(std::vector<double>());
  });
}

rol::Outcome ShapeRun::minimised() {
  constexpr int mostRounds = 20;
  rol::Outcome best;
  std::vector<double> start = space_.start;
  int iterations = 0;
  for (int round = 0; round < mostRounds && !start.empty(); ++round) {
    if (round > 0)
      log_.info("Points of this design are open: they are closed and the optimiser restarts");
    std::vector<double> closed;
    const rol::Outcome outcome = minimisedFrom(start, round + 1 < mostRounds ? &closed : nullptr);
    iterations += outcome.iterations;
    if (round == 0 || outcome.cost < best.cost)
      best = outcome;
    start = closed.empty() ? reclosed(outcome.design) : closed;
  }
  best.iterations = iterations;
  return best;
}

rol::Outcome ShapeRun::minimisedFrom(const std::vector<double>& start, std::vector<double>* closed) {
  sensitivity::DesignProblem here = problem();
  here.space.start = start;
  return rol::minimise(here, deck_.optimiser, [&](const rol::Iterate& iterate) {
    accepted(iterate);
    if (closed != nullptr && iterate.iteration > 0)
      *closed = reclosed(iterate.design);
    return closed == nullptr || closed->empty();
  });
}

void ShapeRun::optimise() {
  rol::Outcome outcome;
  try {
    outcome = minimised();
    best_ = outcome.design;
    report_.converged = outcome.isConverged();
    report_.reason = outcome.reason;
  } catch (const Halt& halt) {
    outcome.design = best_;
    outcome.cost = history_.empty() ? costBefore_ : history_[bestRow_].cost;
    outcome.gradientNorm =
        history_.empty() ? std::numeric_limits<double>::quiet_NaN() : history_[bestRow_].gradientNorm;
    outcome.violation = history_.empty() ? 0.0 : history_[bestRow_].violation;
    outcome.iterations = history_.empty() ? 0 : history_.back().iteration;
    report_.reason = halt.reason + "; continue with --restart \"" + options_.outputDirectory + "\"";
    report_.solved = true;
    save();
    if (halt.isSignal) {
      report_.result.reason = qp::Reason::Interrupted;
      if (!report_.checkpointFault.empty())
        report_.reason = halt.reason + "; no checkpoint: " + report_.checkpointFault;
    }
  } catch (const Error&) { // the best design so far, and all that was computed, stay
    writeHistory();
    writeDesign();
    save();
    throw;
  }
  if (record_->forgotten() > 0)
    log_.info("Different designs than before the restart: " + std::to_string(record_->forgotten()) +
              " solutions of the checkpoint not used");
  conclude(outcome);
}

void ShapeRun::conclude(const rol::Outcome& outcome) {
  const bool isInterrupted = report_.isInterrupted();
  const bool wasConverged = report_.converged;
  const std::string reason = report_.reason;
  writeHistory();
  writeDesign();
  const auto& spent = cost_->spent();
  std::map<std::string, double>& results = report_.results;
  results["cost"] = outcome.cost;
  results["gradient_norm"] = outcome.gradientNorm;
  results["constraint_violation"] = outcome.violation;
  results["iterations"] = outcome.iterations;
  results["evaluations"] = record_->values();
  results["solutions"] = spent.values;
  results["adjoints"] = spent.gradients;
  results["products_of_solutions"] = spent.products;
  results["products_of_adjoints"] = spent.adjointProducts;
  results["refused_designs"] = record_->refused();
  results["design_variables"] = static_cast<double>(space_.size());
  if (!isInterrupted) { // there may be little time left
    cost_->value(best_, 0.0);
    const sensitivity::PressureSummary pressure =
        sensitivity::pressureSummary(*comm_, cost_->forces(), model_->geometry(), deck_.pressed);
    results["peak_pressure"] = pressure.peak;
    results["mean_pressure"] = pressure.mean;
    results["volume"] = model_->volume(best_);
    if (deck_.quantity != "softest" &&
        deck_.quantity != "stiffest") { // one-sided derivatives have a say there
      cost_->gradient(best_, 0.0);
      results["weak_contacts"] = static_cast<double>(cost_->sensitivities()->weakContacts());
    }
    finish();
  }
  report_.converged = wasConverged;
  report_.reason = reason;
  if (isInterrupted)
    report_.result.reason = qp::Reason::Interrupted;
  else if (wasConverged)
    directory_.removeCheckpoint(report_.checkpoints > 0);
  report_.seconds["set_up"] = globalMax(*comm_, setUpSeconds_);
  report_.seconds["first_value"] = globalMax(*comm_, firstValueSeconds_);
  report_.seconds["values"] = globalMax(*comm_, spent.valueSeconds);
  report_.seconds["gradients"] = globalMax(*comm_, spent.gradientSeconds);
  report_.seconds["output"] = globalMax(*comm_, outputSeconds_);
  report_.seconds["total"] = globalMax(*comm_, elapsed());
  report_.peakMemoryMiB = globalSum(*comm_, run::peakMemoryMiB());
}

void ShapeRun::finish() {
  const double begin = elapsed();
  const std::string text = shapeText(*comm_, scene_, before_, state());
  agree(*comm_, [&] {
    if (comm_->getRank() == 0)
      io::writeAtomically(directory_.place("shape.csv"), text);
  });
  if (options_.writeFields)
    writeFields(answer(), directory_.place("result.vtkhdf"), options_.writeStresses);
  tell(answer(), cost_->report(), report_);
  outputSeconds_ += elapsed() - begin;
}

} // namespace Harmos::shape
