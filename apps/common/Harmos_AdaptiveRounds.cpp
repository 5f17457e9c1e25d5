// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AdaptiveRounds.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_RunPlan.hpp"
#include "Harmos_StressRecovery.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <limits>
#include <sstream>

namespace Harmos::app {
namespace {

constexpr const char* listName = "Adaptivity";

std::string percent(double share) {
  std::ostringstream text;
  text << std::setprecision(3) << 100.0 * share << " %";
  return text.str();
}

std::shared_ptr<const run::Quantity> quantityOf(const Teuchos::ParameterList& list) {
  const std::string kind = list.get<std::string>("Quantity");
  if (kind == "energy")
    return nullptr;
  const auto direction = list.get<Teuchos::Array<double>>("Direction");
  run::Quantity quantity = {kind == "displacement" ? run::Quantity::Kind::Displacement
                            : kind == "force"      ? run::Quantity::Kind::Force
                                                   : run::Quantity::Kind::PeakPressure,
                            list.get<std::string>("Of"),
                            {}};
  std::copy_n(direction.begin(), std::min<std::size_t>(3, static_cast<std::size_t>(direction.size())),
              quantity.direction.begin());
  const auto need = [&](const std::string& name, const std::string& what) {
    const std::string path = std::string(listName) + "/" + name;
    throw InputError("\"" + path + "\" has to say " + what + " for \"Quantity\" = \"" + kind + "\"",
                     {{"path", path}});
  };
  if (quantity.of.empty())
    need("Of", kind == "displacement" ? "of which boundary part (\"body/part\")"
                                      : "of which effect (\"Contact/joint\")");
  if (kind != "peak pressure" && quantity.direction == fem::Point{})
    need("Direction", "along what");
  return std::make_shared<const run::Quantity>(std::move(quantity));
}

} // namespace

void addAdaptivityTo(ParameterSpec& deck) {
  ParameterSpec list(listName, "Meshes of a geometry (.geo, .step) that follow the estimated error.");
  list.integer("Rounds", 0, 0, 100, "Most meshes after the first, which is as the geometry has it. 0: none.");
  list.real("Target error", 0.05, Range::within(1e-6, 1.0),
            "Estimated error at which rounds end, relative: in the energy norm, or of the quantity.");
  list.choice(
      "Quantity", "energy",
      {{"energy", "in the energy norm"},
       {"displacement", "the mean of a boundary part along a direction"},
       {"force", "of an effect along a direction"},
       {"peak pressure", "of a contact or obstacle, the mean weighted by the pressure's eighth power"}},
      "Whose error it is. Others than the energy need the answer of a linear problem besides.");
  list.text("Of", "",
            "\"body/boundary part\" of a displacement, which is its mean; effect of a force or pressure.");
  list.reals("Direction", {0.0, 0.0, 0.0}, Range(), "Of a displacement or force.");
  list.integer("Maximum cells", 0, 0, std::numeric_limits<int>::max(),
               "Cells that a mesh may have, about. 0: no limit.");
  list.real("Maximum seconds", 0.0, Range::atLeast(0.0),
            "No round begins that is expected to end later, by its plan. 0: no limit.");
  list.real("Maximum memory", 0.0, Range::atLeast(0.0),
            "MiB of a rank; no round begins that is expected to need more, by its plan. 0: no limit.");
  deck.list(std::move(list));
}

bool isAdaptive(const Teuchos::ParameterList& deck) {
  return deck.isSublist(listName) && deck.sublist(listName).get<int>("Rounds") > 0;
}

AdaptiveRounds::AdaptiveRounds(const Teuchos::RCP<const Teuchos::Comm<int>>& comm,
                               const Teuchos::ParameterList& deck)
    : comm_(comm) {
  if (!deck.isSublist(listName))
    return;
  const Teuchos::ParameterList& list = deck.sublist(listName);
  limits_ = {list.get<int>("Rounds"), static_cast<double>(list.get<int>("Maximum cells")),
             list.get<double>("Maximum seconds"), list.get<double>("Maximum memory")};
  if (!isAsked())
    return;
  target_ = list.get<double>("Target error");
  quantity_ = quantityOf(list);
  // That of a quantity goes with the square of errors in the energy norm.
  aim_.emplace(quantity_ != nullptr ? std::sqrt(target_) : target_, limits_.cells);
  meshFile_ = deck.sublist("Model").get<std::string>("Mesh file");
}

void AdaptiveRounds::setOptions(run::RunOptions& options) const {
  constexpr double share = 0.01;
  options.quantity = quantity_;
  options.cellFields.error = isAsked();
  if (isAsked())
    options.tolerance = std::min(options.tolerance, share * target_);
}

void AdaptiveRounds::check(const scene::Scene& scene, const run::RunOptions& options) const {
  if (!isAsked())
    return;
  const auto refuse = [](const std::string& what) {
    throw InputError("\"Adaptivity/Rounds\" " + what, {{"path", "Adaptivity/Rounds"}});
  };
  const std::string ending = std::filesystem::path(meshFile_).extension();
  const std::vector<std::string> geometries = {".geo", ".step", ".stp", ".iges", ".igs", ".brep"};
  if (!meshFile_.empty() && std::find(geometries.begin(), geometries.end(), ending) == geometries.end())
    refuse("needs blocks, or a geometry that is meshed anew (.geo, .step, .iges, .brep) as \"Model/Mesh "
           "file\"; it "
           "is \"" +
           meshFile_ + "\"");
  if (scene.isTransient())
    refuse("does not go with bodies in motion (\"Steps/Time integration\" = \"Newmark\")");
  if (scene.isFinite())
    refuse("does not go with \"Model/Kinematics\" = \"finite\": the estimate is that of small displacements");
  if (scene.yields())
    refuse("does not go with materials that yield: the estimate does not know plastic strains");
  if (!options.checkpoint.restart.empty())
    refuse("does not go with --restart: begin anew, or restart the round in its own directory without the "
           "list");
  if (quantity_ != nullptr)
    quantity_->check(scene);
}

double AdaptiveRounds::secondsSoFar() const {
  double sum = 0.0;
  for (const Row& row : rows_)
    sum += row.seconds;
  return sum;
}

bool AdaptiveRounds::mayGoOn(const scene::Scene& scene, const run::RunOptions& options, const Log& log,
                             double programMiB) {
  const std::string name = "Round " + std::to_string(rows_.size() + 1);
  if (limits_.seconds > 0.0 || limits_.MiB > 0.0) {
    plan::PlanRequest request;
    request.ranks = {comm_->getSize()};
    request.programMiB = programMiB;
    const plan::PlanRow plan = plan::makeRunPlan(comm_, scene, options, request).rows.front();
    expected_ = 0.5 * (plan.least + plan.most);
    const double end = secondsSoFar() + slowness_ * expected_, MiB = plan.memory.sum() / 1048576.0;
    const bool isLate = limits_.seconds > 0.0 && end > limits_.seconds;
    const bool isLarge = limits_.MiB > 0.0 && MiB > limits_.MiB;
    if (!rows_.empty() && (isLate || isLarge)) {
      std::ostringstream text;
      text << name << " is expected to " << std::setprecision(3);
      if (isLate)
        text << "end after " << end << " s, \"Adaptivity/Maximum seconds\" is " << limits_.seconds;
      else
        text << "need " << MiB << " MiB a rank, \"Adaptivity/Maximum memory\" is " << limits_.MiB;
      log.warning(text.str() + ": the answer is that of round " + std::to_string(rows_.size()));
      isOver_ = true;
      return false;
    }
  }
  if (rows_.empty())
    return true;
  const std::string& directory = options.outputDirectory;
  agree(*comm_, [&] {
    if (comm_->getRank() != 0)
      return;
    namespace fs = std::filesystem;
    std::error_code failure;
    const fs::path aside = fs::path(directory) / ("round_" + std::to_string(rows_.size()));
    fs::remove_all(aside, failure);
    fs::create_directory(aside, failure);
    for (const fs::directory_entry& item : fs::directory_iterator(directory, failure))
      if (item.is_regular_file(failure) && item.path().filename() != "rounds.csv")
        fs::rename(item.path(), aside / item.path().filename(), failure);
    if (failure)
      throw InputError("cannot put results aside in \"" + aside.string() + "\": " + failure.message());
  });
  return true;
}

/// What is estimated of a round.
struct AdaptiveRounds::Judgement {
  std::vector<run::CellError> cells;
  feti::DiscretisationError energy;
  double square = 0.0, scale = 1.0; // of what is aimed at: Σ of the cells, and what it is a share of
  double error() const { return std::sqrt(square / scale); }
};

AdaptiveRounds::Judgement AdaptiveRounds::estimate(const scene::Scene& scene,
                                                   const run::Solution& solution) const {
  std::vector<std::vector<double>> squares, adjoint;
  Judgement result;
  result.energy = run::estimateDiscretisationError(*comm_, scene, solution.owned, solution.displacement,
                                                   scene.timeline.end(), &squares);
  if (!solution.quantity) {
    result.square = result.energy.error * result.energy.error;
    result.scale = result.energy.norm * result.energy.norm;
  } else {
    run::estimateDiscretisationError(*comm_, scene, solution.owned, solution.quantity->adjoint, std::nullopt,
                                     &adjoint);
    for (std::size_t i = 0; i < squares.size(); ++i)
      for (std::size_t c = 0; c < squares[i].size(); ++c) {
        squares[i][c] = std::sqrt(squares[i][c] * adjoint[i][c]);
        result.square += squares[i][c];
      }
    result.square = globalSum(*comm_, result.square);
    result.scale = std::abs(solution.quantity->value);
  }
  if (result.scale <= 0.0) // nothing to be a share of
    result.scale = result.square > 0.0 ? result.square : 1.0;
  result.cells = run::cellErrors(*comm_, solution.owned, squares);
  return result;
}

namespace {

// Nothing is deformed, beyond errors of the solver: bodies that may touch do not, on this mesh.
bool isAtRest(const run::RunReport& report) {
  constexpr double share = 0.3; // above one where there is nothing, 1e-3 where there is
  return report.converged &&
         (report.audit.energyNorm <= 0.0 || report.solverError >= share * report.audit.energyNorm);
}

// Where bodies are nearest to each other: those of the next mesh may touch there.
std::vector<fem::Point> nearestPlaces(const Teuchos::Comm<int>& comm, const run::RunReport& report) {
  const run::WholeContact whole = run::gatherContact(comm, report.contactPoints, report.contact);
  double least = std::numeric_limits<double>::max();
  for (const run::ContactState& state : whole.states)
    least = std::min(least, state.gap);
  std::vector<fem::Point> places;
  for (std::size_t k = 0; k < whole.points.size(); ++k)
    if (whole.states[k].gap <= 2.0 * std::max(least, 0.0))
      places.push_back(whole.points[k].position);
  return places;
}

} // namespace

std::string AdaptiveRounds::judge(const scene::Scene& scene, const run::Solution& solution,
                                  run::RunReport& report) {
  const Judgement round = estimate(scene, solution);
  const bool isResting = isAtRest(report);
  const std::vector<fem::Point> nearest =
      isResting ? nearestPlaces(*comm_, report) : std::vector<fem::Point>{};
  // Without stress, as of a body that expands freely, there is nothing to be a share of.
  const double share = round.energy.norm > 0.0 ? round.energy.error / round.energy.norm : 0.0;
  const double relative = !isResting ? share : nearest.empty() ? 0.0 : 1.0;
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin_;
  const auto present = static_cast<double>(round.cells.size());
  rows_.push_back({present, static_cast<double>(report.primalDimension), relative, round.energy.norm,
                   report.audit.energy, static_cast<double>(report.result.counters.hessianApplications),
                   globalMax(*comm_, taken.count())});
  report.results["estimated_error"] = relative;
  if (expected_ > 0.0)
    slowness_ = rows_.back().seconds / expected_;
  std::string text =
      "Round " + std::to_string(rows_.size()) + ": " + std::to_string(round.cells.size()) + " cells, " +
      (isResting ? "nothing is deformed" : "estimated error " + percent(relative) + " in the energy norm");
  double reached = relative;
  if (solution.quantity) {
    reached = round.square / round.scale;
    rows_.back().value = report.results["quantity"] = solution.quantity->value;
    rows_.back().bound = report.results["quantity_error"] = reached;
    std::ostringstream value;
    value << ", " << std::setprecision(7) << solution.quantity->value << " within " << percent(reached);
    text += value.str();
  }
  const bool isReached = reached <= target_ && nearest.empty(),
             isLast = static_cast<int>(rows_.size()) > limits_.rounds;
  const bool isFull = limits_.cells > 0.0 && present > 0.9 * limits_.cells;
  isOver_ = isReached || isLast || isFull || !report.converged;
  if (isOver_)
    return text + (isReached ? ": reached"
                   : isLast  ? "; no more rounds are allowed"
                   : isFull  ? "; a finer mesh would have more cells than \"Adaptivity/Maximum cells\" allows"
                             : "");
  const int dimension = scene.physics == scene::Physics::Solid ? 3 : 2;
  if (isResting) {
    const run::NextMesh next = aim_->nextAtRest(round.cells, nearest, dimension);
    sizes_ = next.sizes;
    return text + ": finer where bodies are nearest to each other, some " +
           std::to_string(std::llround(next.cells)) + " next";
  }
  long long order = 1;
  for (const scene::OwnedSubdomain& item : solution.owned)
    order = std::max(order, static_cast<long long>(fem::shapeOf(item.mesh.mesh->cellType).order));
  const run::NextMesh next = aim_->next(round.cells, {round.error(), std::sqrt(round.scale),
                                                      static_cast<int>(globalMax(*comm_, order)), dimension});
  sizes_ = next.sizes;
  return text + "; some " + std::to_string(std::llround(next.cells)) + " next";
}

void AdaptiveRounds::write(const std::string& directory) const {
  agree(*comm_, [&] {
    if (comm_->getRank() != 0)
      return;
    std::ostringstream text;
    text << "round,cells,dofs,estimated_error,energy_norm,energy,products,seconds,seconds_so_far"
         << (quantity_ != nullptr ? ",quantity,quantity_error\n" : "\n") << std::setprecision(9);
    double sum = 0.0;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const Row& row = rows_[k];
      sum += row.seconds;
      text << k + 1 << ',' << row.cells << ',' << row.dofs << ',' << row.error << ',' << row.norm << ','
           << row.energy << ',' << row.products << ',' << row.seconds << ',' << sum;
      if (quantity_ != nullptr) {
        text << ',';
        if (row.value)
          text << *row.value << ',' << *row.bound;
        else
          text << ',';
      }
      text << '\n';
    }
    io::writeAtomically(directory + "/rounds.csv", text.str());
  });
}

} // namespace Harmos::app
