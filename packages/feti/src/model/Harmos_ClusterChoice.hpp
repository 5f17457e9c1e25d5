// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ClusterModel.hpp"
#include "Harmos_Clusters.hpp"
#include "Harmos_CoarseOptions.hpp"
#include "Harmos_FormChoice.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_Rates.hpp"

#include <string>
#include <vector>

namespace Harmos::feti {

/// A run without clusters, as far as they matter to it.
struct UnjoinedRun {
  StepShape step;
  ClusterShape clusters;   ///< but for size, share and aspect
  ShareSides sides;        ///< the longest and the shortest of any rank; 1 and 1: those of squares and cubes
  double subdomains = 1.0; ///< of all ranks
  double productSeconds = 0.0; ///< of F, and of the preconditioner with it, on the busiest rank
  double products = 0.0;       ///< expected
};

/// What a run takes with some clusters, or with none.
struct ClusterPrediction {
  ClusterOptions::Kind kind = ClusterOptions::Kind::None; ///< None, Rank or Size
  int size = 0;                                           ///< of Kind Size
  long long clusters = 0;                                 ///< of all ranks; 0: none
  StepShape step;
  ClusterShape shape;
  double growth = 1.0;       ///< products over those without clusters
  double setupSeconds = 0.0; ///< of what joins the subdomains
  double seconds = 0.0;      ///< of all steps, and of that
};

/// As asked for, Auto excepted: of about so many subdomains within a rank, the ranks having equally many.
/// @param coarse decides for the smaller coarse problem as for the whole.
ClusterPrediction predictClusters(const UnjoinedRun& run, ClusterOptions::Kind kind, int size,
                                  const CoarseOptions& coarse, const StepRates& rates);

/// What is to be taken: none; or of clusters of 2, 4, 8, … subdomains and whole ranks the smallest that
/// take at most 10 per cent longer than the fastest, if they take half as long as none at most.
///
///     seconds = products · growth (product + step) + set-up of the joining
///
/// where the set-up is that of as many products as a subdomain's averages have columns, for each operator.
/// What the smaller coarse problem saves when it is factored is not counted, so that none stays where it is
/// close. Below `fewestRanks` none, whatever is expected: local work outweighs the coarse problem there, and
/// runs are to stay as they are to the last bit.
ClusterPrediction chooseClusters(const UnjoinedRun& run, const CoarseOptions& coarse, const StepRates& rates);

/// Ranks from which on the model is asked.
constexpr int fewestRanksOfClusters = 32;

/// Whether there may be clusters on so many ranks, whose shares of subdomains should be compact then.
inline bool mayJoin(const ClusterOptions& options, int ranks) {
  using Kind = ClusterOptions::Kind;
  return options.kind == Kind::Rank || options.kind == Kind::Size ||
         (options.kind == Kind::Auto && ranks >= fewestRanksOfClusters);
}

/// Of what there is before anything is factored: numbers of the busiest rank, the same on all.
/// @param inverses, forms as decided. @param products expected. @note Collective.
UnjoinedRun unjoinedRun(const SubdomainSystem& system, const Constraints& constraints,
                        const LocalInverseOptions& inverses, const DualForms& forms, const Rates& rates,
                        int products);

/// What Auto comes to in a run; all else stays. The same on all ranks and, for the same rates, in every run:
/// nothing is measured. Says what was chosen and why.
/// @note Collective from fewestRanksOfClusters on. Guarded by
/// tests/unit/feti/clusters/test_cluster_choice.cpp, tests/unit/feti/clusters/test_cluster_decision.cpp.
ClusterOptions decideClusters(const SubdomainSystem& system, const Constraints& constraints,
                              const ClusterOptions& options, const LocalInverseOptions& inverses,
                              PreconditionerKind preconditioner, const CoarseOptions& coarse,
                              const Rates& rates, int products, const Log& log);

/// "42 clusters of about 16 subdomains, joined by 1008 averages; F₀ and S₀ of 3 of them".
/// @note Collective.
std::string describeClusters(const SubdomainSystem& system, const LocalInverses& inverses);

} // namespace Harmos::feti
