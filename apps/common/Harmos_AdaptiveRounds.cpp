// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AdaptiveRounds.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
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

} // namespace

void addAdaptivityTo(ParameterSpec& deck) {
  ParameterSpec list(listName, "Meshes of a geometry (.geo, .step) that follow the estimated error.");
  list.integer("Rounds", 0, 0, 100, "Most meshes after the first, which is as the geometry has it. 0: none.");
  list.real("Target error", 0.05, Range::within(1e-6, 1.0),
            "Estimated error in the energy norm, relative, at which rounds end.");
  list.integer("Maximum cells", 0, 0, std::numeric_limits<int>::max(),
               "Cells that a mesh may have, about. 0: no limit.");
  deck.list(std::move(list));
}

AdaptiveRounds::AdaptiveRounds(const Teuchos::Comm<int>& comm, const Teuchos::ParameterList& deck)
    : comm_(comm) {
  if (!deck.isSublist(listName))
    return;
  const Teuchos::ParameterList& list = deck.sublist(listName);
  most_ = list.get<int>("Rounds");
  target_ = list.get<double>("Target error");
  maximumCells_ = list.get<int>("Maximum cells");
  meshFile_ = deck.sublist("Model").get<std::string>("Mesh file");
}

void AdaptiveRounds::check(const scene::Scene& scene, const run::RunOptions& options) const {
  if (!isAsked())
    return;
  const auto refuse = [](const std::string& what) {
    throw InputError("\"Adaptivity/Rounds\" " + what, {{"path", "Adaptivity/Rounds"}});
  };
  const std::string ending = std::filesystem::path(meshFile_).extension();
  const std::vector<std::string> geometries = {".geo", ".step", ".stp", ".iges", ".igs", ".brep"};
  if (std::find(geometries.begin(), geometries.end(), ending) == geometries.end())
    refuse(
        "needs a geometry that is meshed anew (.geo, .step, .iges, .brep) as \"Model/Mesh file\"; it is \"" +
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
}

std::string AdaptiveRounds::judge(const scene::Scene& scene, const run::Solution& solution,
                                  run::RunReport& report) {
  std::vector<std::vector<double>> squares;
  const feti::DiscretisationError estimate = run::estimateDiscretisationError(
      comm_, scene, solution.owned, solution.displacement, scene.timeline.end(), &squares);
  const std::vector<run::CellError> cells = run::cellErrors(comm_, solution.owned, squares);
  const double relative = estimate.norm > 0.0 ? estimate.error / estimate.norm : 0.0;
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin_;
  rows_.push_back({static_cast<double>(cells.size()), static_cast<double>(report.primalDimension), relative,
                   report.audit.energy, static_cast<double>(report.result.counters.hessianApplications),
                   globalMax(comm_, taken.count())});
  report.results["estimated_error"] = relative;
  std::string text = "Round " + std::to_string(rows_.size()) + ": " + std::to_string(cells.size()) +
                     " cells, estimated error " + percent(relative) + " in the energy norm";
  const bool isReached = relative <= target_, isLast = static_cast<int>(rows_.size()) > most_;
  if (isReached || isLast || !report.converged) {
    isOver_ = true;
    return text + (isReached ? ": reached" : isLast ? "; no more rounds are allowed" : "");
  }
  if (maximumCells_ > 0.0 && static_cast<double>(cells.size()) > 0.9 * maximumCells_) {
    isOver_ = true;
    return text + "; a finer mesh would have more cells than \"Adaptivity/Maximum cells\" allows";
  }
  // What is aimed at, over what is asked for, and over what there is: what cells far from a singularity are
  // to be is known once those at it are small.
  constexpr double margin = 0.95, least = 0.5;
  long long order = 1;
  for (const scene::OwnedSubdomain& item : solution.owned)
    order = std::max(order, static_cast<long long>(fem::shapeOf(item.mesh.mesh->cellType).order));
  const int dimension = scene.physics == scene::Physics::Solid ? 3 : 2;
  const run::NextMesh next =
      run::nextMesh(cells, {std::max(margin * target_ * estimate.norm, least * estimate.error),
                            static_cast<int>(globalMax(comm_, order)), dimension, maximumCells_});
  sizes_ = next.sizes;
  return text + "; some " + std::to_string(std::llround(next.cells)) + " next";
}

void AdaptiveRounds::write(const std::string& directory) const {
  agree(comm_, [&] {
    if (comm_.getRank() != 0)
      return;
    namespace fs = std::filesystem;
    std::ostringstream text;
    text << "round,cells,dofs,estimated_error,energy,products,seconds,seconds_so_far\n"
         << std::setprecision(9);
    double sum = 0.0;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const Row& row = rows_[k];
      sum += row.seconds;
      text << k + 1 << ',' << row.cells << ',' << row.dofs << ',' << row.error << ',' << row.energy << ','
           << row.products << ',' << row.seconds << ',' << sum << '\n';
    }
    io::writeAtomically(directory + "/rounds.csv", text.str());
    if (isOver_)
      return;
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
}

} // namespace Harmos::app
