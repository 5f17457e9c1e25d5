// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunPlan.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_ProcessMemory.hpp"
#include "Harmos_Version.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Harmos::plan {
namespace {

constexpr double mebi = 1048576.0;

std::vector<int> rankCounts(const PlanRequest& request, long long subdomains) {
  if (!request.ranks.empty()) {
    for (int ranks : request.ranks)
      if (ranks < 1)
        throw InputError("command line: --plan-ranks: " + std::to_string(ranks) +
                         " is not a valid number of ranks; give positive integers, as in --plan-ranks 1,2,4");
    std::vector<int> counts = request.ranks;
    std::sort(counts.begin(), counts.end());
    counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
    return counts;
  }
  std::vector<int> counts;
  for (long long ranks = 1; ranks < subdomains; ranks *= 2)
    counts.push_back(static_cast<int>(ranks));
  counts.push_back(static_cast<int>(subdomains));
  return counts;
}

double typicalSeconds(const PlanRow& row) {
  return std::sqrt(row.least * row.most);
}

// Seconds without more digits than a model has.
std::string seconds(double value) {
  std::ostringstream text;
  text << std::setprecision(2) << value;
  return text.str();
}

std::string ranksText(int ranks) {
  return std::to_string(ranks) + (ranks == 1 ? " rank" : " ranks");
}

void recommend(RunPlan& plan, double memoryMiB) {
  const auto fits = [&](const PlanRow& row) {
    return memoryMiB <= 0.0 || row.memory.sum() <= memoryMiB * mebi;
  };
  constexpr double worthwhile = 0.5; // of a rank's time
  const PlanRow* first = nullptr;
  double efficiency = 1.0;
  for (std::size_t k = 0; k < plan.rows.size(); ++k) {
    const PlanRow& row = plan.rows[k];
    if (!fits(row))
      continue;
    if (first == nullptr)
      first = &row;
    const double now = typicalSeconds(*first) * first->ranks / (typicalSeconds(row) * row.ranks);
    if (&row == first || (now >= worthwhile && row.leastSubdomains > 0)) {
      plan.recommended = static_cast<int>(k);
      efficiency = now;
    }
  }
  if (plan.recommended < 0) {
    plan.reason = "no option fits into " + std::to_string(static_cast<long long>(memoryMiB)) +
                  " MiB per rank; use more ranks (--plan-ranks), smaller subdomains or \"Dual "
                  "operator/Precision\" = \"single\"";
    return;
  }
  const PlanRow& row = plan.rows[static_cast<std::size_t>(plan.recommended)];
  std::ostringstream text;
  text << ranksText(row.ranks) << ": ";
  if (&row == first)
    text << "larger numbers of ranks are predicted to lose more than half of their time";
  else
    text << "the largest number of ranks with a predicted parallel efficiency of at least 0.5 relative to "
         << ranksText(first->ranks) << " (" << std::fixed << std::setprecision(2) << efficiency << ")";
  if (plan.rows.size() == 1)
    text.str(ranksText(row.ranks) + ": the only number requested");
  else if (static_cast<std::size_t>(plan.recommended) + 1 == plan.rows.size() && &row == first)
    text.str(ranksText(row.ranks) + ": the smallest number that fits into the memory");
  plan.reason = text.str();
}

const char* coarseForm(const PlanRow& row) {
  return row.shape.isCoarseDistributed ? "distributed" : "replicated";
}

// What a step says to other ranks.
std::string messagesText(const PlanRow& row) {
  if (row.ranks == 1)
    return "none";
  const feti::StepCounts& counts = row.counts;
  constexpr double kilo = 1e3;
  std::ostringstream text;
  text << std::fixed << std::setprecision(0) << counts.messages << " messages to " << row.shape.neighbours
       << " neighbours, " << counts.reductions << " reductions and " << counts.gathers << " all-gathers, "
       << std::setprecision(1) << counts.messageBytes / kilo << " and " << counts.collectiveBytes / kilo
       << " kB";
  return text.str();
}

// What the coarse problem of a row is made of.
std::string coarseText(const PlanRow& row) {
  if (row.clusters == 0)
    return std::string("the coarse problem is ") + coarseForm(row);
  std::ostringstream text;
  text << std::fixed << std::setprecision(0) << "the coarse problem, of dimension "
       << row.shape.coarseDimension << ", is " << coarseForm(row) << ". " << row.clusters
       << (row.clusters == 1 ? " cluster" : " clusters") << " of about " << row.shape.clusterSize
       << " subdomains: " << std::setprecision(1) << row.productsGrowth << " times as many applications of F";
  return text.str();
}

std::string number(double value, int width) {
  std::ostringstream text;
  text << std::setw(width) << std::setprecision(2) << value;
  return text.str();
}

nlohmann::ordered_json shapeJson(const feti::StepShape& shape) {
  return {{"ranks", shape.ranks},
          {"rows", shape.rows},
          {"shared_rows", shape.sharedRows},
          {"neighbours", shape.neighbours},
          {"coarse_dimension", shape.coarseDimension},
          {"coarse_entries", shape.coarseEntries},
          {"own_motions", shape.ownMotions},
          {"motions", shape.motions},
          {"shared_motions", shape.sharedMotions},
          {"cluster_size", shape.clusterSize},
          {"join_bytes", shape.joinBytes},
          {"join_entries", shape.joinEntries}};
}

nlohmann::ordered_json ratesJson(const feti::Rates& rates) {
  nlohmann::ordered_json json = {{"source", rates.source}};
  for (const auto& [name, value] : feti::namedRates(rates))
    json[name] = value;
  return json;
}

// What the seconds do not tell.
std::string remarksOn(const RunPlan& plan) {
  std::string text;
  if (plan.isOfIterations)
    text +=
        "Finite displacements: a step has several iterations, each with a search for contacts, constraints "
        "and a solve. The seconds are those of one iteration a step: a run takes a multiple.\n";
  if (plan.isTransient)
    text +=
        "Bodies in motion: seconds are those of a static solve. A step takes 2 to 20 applications of F where "
        "it is as long as a wave through a cell; more, growing with the parts, where it is longer.\n";
  return text;
}

} // namespace

RunPlan makeRunPlan(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
                    const run::RunOptions& options, const PlanRequest& request) {
  RunPlan plan;
  // The survey takes time: what is wrong with the request is told before.
  std::vector<int> counts;
  plan.rates = options.dual.rates;
  agree(*comm, [&] {
    counts = rankCounts(request, scene.subdomains());
    if (!request.ratesFile.empty())
      plan.rates = feti::ratesFromFile(request.ratesFile);
  });
  const double program = globalMax(*comm, request.programMiB) * mebi;
  // What reading and cutting of meshes took stays resident on rank 0.
  const double scenery = std::max(0.0, globalMax(*comm, run::peakMemoryMiB()) * mebi - program);
  plan.survey = survey(comm, scene, options);
  plan.survey.steps = static_cast<long long>(scene.timeline.ends().size());
  plan.isOfIterations = scene.iterates();
  plan.survey.secondsOfMeshes += globalMax(*comm, scene.secondsToMake);
  plan.isTransient = scene.isTransient();
  plan.products = expectedProducts(scene, options);
  for (int ranks : counts)
    plan.rows.push_back(planRow(plan.survey, options, scene.physics != scene::Physics::Membrane,
                                !scene.hasSeveralMaterials(), plan.products, plan.rates, program, scenery,
                                ranks));
  recommend(plan, request.memoryMiB);
  return plan;
}

std::string planText(const RunPlan& plan) {
  const PlanSurvey& s = plan.survey;
  std::ostringstream text;
  text << "Primal dimension " << s.primalDimension << ", dual dimension " << s.dualDimension << " ("
       << s.inequalities << " inequalities"
       << (s.limited > 0 ? ", " + std::to_string(s.limited) + " of friction" : std::string())
       << "), kernel dimension " << s.kernelDimension << ", coarse dimension " << s.coarseDimension << "\n"
       << s.subdomains.size() << " subdomains with " << s.matrices.size() << " distinct matrices; "
       << plan.products.least << " to " << plan.products.most << " applications of F are typical"
       << (plan.isTransient ? " of a static solve with as many parts" : "")
       << (s.steps > 1 && !plan.isTransient ? " in the first of " + std::to_string(s.steps) + " steps"
                                            : std::string())
       << "\n\n"
       << "    ranks  subdomains  imbalance  MiB per rank: factors   dense  meshes  coarse  | seconds: "
          "set-up  apply F  coarse                 run";
  const bool hasClusters =
      std::any_of(plan.rows.begin(), plan.rows.end(), [](const PlanRow& row) { return row.clusters > 0; });
  if (hasClusters)
    text << "   clusters  coarse dimension";
  for (std::size_t k = 0; k < plan.rows.size(); ++k) {
    const PlanRow& row = plan.rows[k];
    const RankMemory& m = row.memory;
    const std::string subdomains =
        row.leastSubdomains == row.mostSubdomains
            ? std::to_string(row.mostSubdomains)
            : std::to_string(row.leastSubdomains) + "-" + std::to_string(row.mostSubdomains);
    text << "\n"
         << (static_cast<int>(k) == plan.recommended ? "  * " : "    ") << std::setw(5) << row.ranks
         << std::setw(12) << subdomains << std::fixed << std::setprecision(2) << std::setw(11)
         << row.imbalance << std::setprecision(0) << std::setw(14) << m.sum() / mebi << std::setw(9)
         << m.factors / mebi << std::setw(8) << m.dense / mebi << std::setw(8) << m.mesh / mebi
         << std::setw(8) << m.coarse / mebi << std::defaultfloat << "  |" << number(row.setup(), 16)
         << number(row.product, 9) << number(row.step.coarse, 8) << std::setw(13) << coarseForm(row) << "   "
         << std::setw(hasClusters ? 18 : 0) << std::left << seconds(row.least) + " to " + seconds(row.most)
         << std::right;
    if (hasClusters)
      text << std::setw(11) << row.clusters << std::setw(18) << std::llround(row.shape.coarseDimension);
  }
  const PlanRow& row = plan.rows[plan.recommended < 0 ? 0 : static_cast<std::size_t>(plan.recommended)];
  text << "\n\n"
       << (plan.recommended < 0 ? "No recommendation: " : "Recommended: ") << plan.reason << ".\n"
       << "Threads: one BLAS thread per rank (OPENBLAS_NUM_THREADS=1, OMP_NUM_THREADS=1). Harmos runs one "
          "thread per rank; more BLAS threads pay off at most if there are more cores than the "
       << s.subdomains.size() << " subdomains. Ranks beyond that number stay idle.\n"
       << std::fixed << std::setprecision(0) << "Memory: request "
       << std::ceil(1.25 * row.memory.sum() / mebi) << " MiB per rank on " << ranksText(row.ranks)
       << ", a quarter more than predicted; of this " << std::fixed << std::setprecision(0)
       << row.memory.program / mebi << " MiB for the program and reading the scene, "
       << row.memory.directions / mebi << " MiB for stored directions, " << row.memory.temporary / mebi
       << " MiB temporarily.\n"
       << "Communication per step on " << ranksText(row.ranks) << ": " << messagesText(row) << "; "
       << coarseText(row) << ".\n"
       << remarksOn(plan) << "Rates: " << plan.rates.source
       << ". Seconds exclude the writing of fields. Set-up times are measured here and scaled, factorisation "
          "times predicted.";
  return text.str();
}

std::string planJson(const RunPlan& plan, const std::string& deck) {
  const PlanSurvey& s = plan.survey;
  nlohmann::ordered_json json;
  json["harmos"] = {{"version", version()}, {"git", gitHash()}};
  json["deck"] = deck;
  json["ranks_of_the_survey"] = s.ranks;
  json["primal_dimension"] = s.primalDimension;
  json["dual_dimension"] = s.dualDimension;
  json["inequalities"] = s.inequalities;
  if (s.limited > 0)
    json["friction_rows"] = s.limited;
  json["kernel_dimension"] = s.kernelDimension;
  json["coarse_dimension"] = s.coarseDimension;
  json["coarse_factor_entries"] = s.coarseFactorEntries;
  json["subdomains"] = s.subdomains.size();
  json["distinct_matrices"] = s.matrices.size();
  json["steps"] = s.steps;
  if (plan.isOfIterations)
    json["kinematics"] = "finite"; // seconds are of one iteration a step
  json["products"] = {plan.products.least, plan.products.most};
  json["rates"] = ratesJson(plan.rates);
  json["rows"] = nlohmann::ordered_json::array();
  for (const PlanRow& row : plan.rows) {
    const RankMemory& m = row.memory;
    json["rows"].push_back({{"ranks", row.ranks},
                            {"subdomains", {row.leastSubdomains, row.mostSubdomains}},
                            {"imbalance", row.imbalance},
                            {"factorizations", row.factorizations},
                            {"form", feti::toString(row.forms.form)},
                            {"coarse_problem", coarseForm(row)},
                            {"clusters", row.clusters},
                            {"cluster_aspect", row.clusterAspect},
                            {"products_growth", row.productsGrowth},
                            {"shape", shapeJson(row.shape)},
                            {"messages",
                             {{"messages", row.counts.messages},
                              {"message_bytes", row.counts.messageBytes},
                              {"reductions", row.counts.reductions},
                              {"gathers", row.counts.gathers},
                              {"collective_bytes", row.counts.collectiveBytes}}},
                            {"memory_mib",
                             {{"program", m.program / mebi},
                              {"mesh", m.mesh / mebi},
                              {"factors", m.factors / mebi},
                              {"dense", m.dense / mebi},
                              {"joins", m.joins / mebi},
                              {"coarse", m.coarse / mebi},
                              {"directions", m.directions / mebi},
                              {"temporary", m.temporary / mebi},
                              {"rank", m.sum() / mebi},
                              {"all_ranks", row.totalMemory / mebi}}},
                            {"seconds",
                             {{"mesh", row.mesh},
                              {"assembly", row.assembly},
                              {"constraints", row.constraints},
                              {"factorization", row.factorization},
                              {"coarse", row.coarseSetup},
                              {"recovery", row.recovery},
                              {"setup", row.setup()},
                              {"face", row.face},
                              {"product", row.product},
                              {"step",
                               {{"vectors", row.step.vectors},
                                {"exchange", row.step.exchange},
                                {"reductions", row.step.reductions},
                                {"coarse", row.step.coarse},
                                {"joins", row.step.joins}}},
                              {"run", {row.least, row.most}}}}});
  }
  json["recommended_ranks"] =
      plan.recommended < 0
          ? nlohmann::ordered_json(nullptr)
          : nlohmann::ordered_json(plan.rows[static_cast<std::size_t>(plan.recommended)].ranks);
  json["reason"] = plan.reason;
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

} // namespace Harmos::plan
