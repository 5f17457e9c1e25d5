// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ClusterChoice.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Map.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Harmos::feti {
namespace {

using Kind = ClusterOptions::Kind;

// What makes the joining: K⁺B₀ᵀ of each operator, a column of which takes as long as a product of one
// subdomain at most.
double setupSeconds(const UnjoinedRun& run, const ClusterShape& shape) {
  const ClusterShape alone{shape.size,       shape.share,    shape.subdomains,
                           shape.subdomains, shape.boundary, shape.motions};
  const double columns = 2.0 * joinCosts(alone).averages / shape.size;
  return columns * shape.distinct * run.productSeconds / shape.subdomains;
}

std::string inWords(const ClusterPrediction& prediction) {
  std::ostringstream text;
  text << std::setprecision(2);
  if (prediction.clusters > 0)
    text << prediction.clusters << " clusters of about " << std::round(prediction.shape.size)
         << " subdomains, " << prediction.growth << " times as many applications of F";
  else
    text << "none";
  text << ", " << prediction.seconds << " s";
  return text.str();
}

} // namespace

ClusterPrediction predictClusters(const UnjoinedRun& run, Kind kind, int size, const CoarseOptions& coarse,
                                  const StepRates& rates) {
  ClusterPrediction result;
  result.kind = kind;
  result.size = kind == Kind::Size ? size : 0;
  result.shape = run.clusters;
  if (kind == Kind::Rank || kind == Kind::Size) {
    const auto clustersOf = [&](double subdomains) {
      return kind == Kind::Rank ? 1.0 : std::max(1.0, std::round(subdomains / std::max(1, size)));
    };
    const double ranks = std::min(static_cast<double>(run.step.ranks), run.subdomains);
    const double clusters = ranks * clustersOf(run.subdomains / ranks);
    result.clusters = static_cast<long long>(clusters);
    result.shape.share = std::min(1.0, clusters / run.subdomains);
    result.shape.size = std::max(1.0, run.clusters.subdomains / clustersOf(run.clusters.subdomains));
    const bool isInSpace = result.shape.isInSpace();
    if (run.sides.longest > 1.0)
      result.shape.aspect = aspectOfClusters(run.sides, run.clusters.subdomains,
                                             clustersOf(run.clusters.subdomains), isInSpace);
    result.growth = growthOfProducts(result.shape.size, isInSpace, result.shape.aspect);
  }
  result.step = withClusters(run.step, result.shape);
  CoarseShape asked = result.step.coarse();
  asked.factorEntries = 0.0; // a run decides before there is a factor
  asked.neighbours = -1.0;
  result.step.isCoarseDistributed = takesDistributed(coarse, asked);
  result.seconds =
      run.products * result.growth * (run.productSeconds + predictStep(result.step, rates).sum());
  if (result.shape.size > 1.0)
    result.setupSeconds = setupSeconds(run, result.shape);
  result.seconds += result.setupSeconds;
  return result;
}

ClusterPrediction chooseClusters(const UnjoinedRun& run, const CoarseOptions& coarse,
                                 const StepRates& rates) {
  constexpr double worthWhile = 0.5; // models are no better than that
  constexpr double nearTie = 1.1;
  const ClusterPrediction none = predictClusters(run, Kind::None, 0, coarse, rates);
  if (run.step.ranks < fewestRanksOfClusters || run.clusters.subdomains < 2.0)
    return none;
  std::vector<ClusterPrediction> candidates;
  for (int size = 2; size < run.clusters.subdomains; size *= 2)
    candidates.push_back(predictClusters(run, Kind::Size, size, coarse, rates));
  candidates.push_back(predictClusters(run, Kind::Rank, 0, coarse, rates));
  const auto isFaster = [](const ClusterPrediction& a, const ClusterPrediction& b) {
    return a.seconds < b.seconds;
  };
  const double fastest = std::min_element(candidates.begin(), candidates.end(), isFaster)->seconds;
  if (!(fastest < worthWhile * none.seconds))
    return none;
  return *std::find_if(candidates.begin(), candidates.end(), [&](const ClusterPrediction& candidate) {
    return candidate.seconds <= nearTie * fastest && candidate.seconds < worthWhile * none.seconds;
  });
}

UnjoinedRun unjoinedRun(const SubdomainSystem& system, const Constraints& constraints,
                        const LocalInverseOptions& inverses, const DualForms& forms, const Rates& rates,
                        int products) {
  const Teuchos::Comm<int>& comm = *system.comm();
  double boundaries = 0.0, distinct = 0.0, motions = 1.0;
  std::vector<std::array<double, 3>> centres;
  agree(comm, [&] {
    for (const CongruenceClass& item :
         congruenceClasses(system, constraints, inverses.share, inverses.fixingPlaces)) {
      boundaries += static_cast<double>(item.members.size() * item.boundary.size());
      distinct += 1.0;
    }
    for (int i = 0; i < system.size(); ++i) {
      motions = std::max(motions, static_cast<double>(system.subdomain(i).motions->columns));
      if (system.subdomain(i).centre)
        centres.push_back(*system.subdomain(i).centre);
    }
  });
  FormLimits limits;
  limits.form = forms.form;
  limits.preconditioner = forms.preconditioner;
  limits.products = products;
  FactorizationContext analyses; // where the decision has left none
  FactorizationContext& context = inverses.context ? *inverses.context : analyses;
  const RigidMotions ofSubdomains(system);
  const CoarseShape coarse = shapeOf(ofSubdomains);
  UnjoinedRun run;
  run.subdomains = static_cast<double>(std::max(1LL, system.globalSubdomains()));
  run.productSeconds =
      chooseForm(system, constraints, inverses, limits, context, rates.local).of(forms).productSeconds;
  run.products = products;
  run.clusters.subdomains = globalMax(comm, static_cast<double>(system.size()));
  run.clusters.distinct = globalMax(comm, distinct);
  run.clusters.boundary = globalSum(comm, boundaries) / run.subdomains;
  run.clusters.motions = globalMax(comm, motions);
  const ShareSides sides = sidesOf(centres, run.clusters.isInSpace());
  run.sides.longest = globalMax(comm, sides.longest);
  run.sides.shortest = -globalMax(comm, -sides.shortest);
  const auto rows = static_cast<double>(localSize(*constraints.rowMap()));
  const auto touched = static_cast<double>(localSize(*constraints.overlapMap()));
  run.step.ranks = comm.getSize();
  run.step.rows = globalMax(comm, rows);
  run.step.sharedRows = 2.0 * globalMax(comm, touched - rows); // those of others, and its own with others
  run.step.neighbours = static_cast<int>(likelyNeighbours(coarse));
  run.step.coarseDimension = coarse.dimension;
  run.step.ownMotions = coarse.mostOwn;
  run.step.motions = coarse.motions;
  return run;
}

ClusterOptions decideClusters(const SubdomainSystem& system, const Constraints& constraints,
                              const ClusterOptions& options, const LocalInverseOptions& inverses,
                              PreconditionerKind preconditioner, const CoarseOptions& coarse,
                              const Rates& rates, int products, const Log& log) {
  if (options.kind != Kind::Auto)
    return options;
  ClusterOptions result = options;
  result.kind = Kind::None;
  if (system.comm()->getSize() < fewestRanksOfClusters)
    return result;
  const UnjoinedRun run =
      unjoinedRun(system, constraints, inverses, {inverses.form, preconditioner}, rates, products);
  const ClusterPrediction best = chooseClusters(run, coarse, rates.step);
  result.kind = best.kind;
  result.size = best.size;
  if (best.kind != Kind::None)
    log.info("Clusters: " + inWords(best) + "; predicted without clusters: " +
             inWords(predictClusters(run, Kind::None, 0, coarse, rates.step)));
  return result;
}

std::string describeClusters(const SubdomainSystem& system, const LocalInverses& inverses) {
  const ClusterInverse& joined = *inverses.joined();
  const Teuchos::Comm<int>& comm = *system.comm();
  const long long clusters = joined.clusters().total();
  const auto averages = static_cast<long long>(joined.clusters().averagePlaces().back());
  const std::string all = std::to_string(globalSum(comm, averages)),
                    distinct =
                        std::to_string(globalSum(comm, static_cast<long long>(joined.distinctFactors())));
  const double size =
      static_cast<double>(system.globalSubdomains()) / static_cast<double>(std::max(1LL, clusters));
  return std::to_string(clusters) + (clusters == 1 ? " cluster" : " clusters") + " of about " +
         std::to_string(std::llround(size)) + " subdomains, joined by " + all + " averages; F₀ and S₀ of " +
         distinct + " of them";
}

} // namespace Harmos::feti
