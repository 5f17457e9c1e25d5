// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Log.hpp"
#include "Harmos_PlanCosts.hpp"

#include <string>
#include <vector>

namespace Harmos::plan {

/// What a plan is asked for.
struct PlanRequest {
  std::vector<int>
      ranks; ///< of the table; none: powers of two up to the number of subdomains, and that itself
  double memoryMiB = 0.0;  ///< what a rank may take; 0: no limit
  std::string ratesFile;   ///< "": rates as they stand in the sources
  double programMiB = 0.0; ///< peak of this process before it had a scene
};

/// Advice on how many ranks to run a scene with.
struct RunPlan {
  PlanSurvey survey;
  feti::Rates rates;
  ProductRange products{0, 0};
  std::vector<PlanRow> rows;
  int recommended = -1;        ///< place in rows; -1 if no row fits into the memory
  std::string reason;          ///< a sentence
  bool isTransient = false;    ///< steps are of bodies in motion; seconds are those of a static solve
  bool isOfIterations = false; ///< a step is several solves, at finite displacements; seconds are of one
};

/// Surveys the scene and predicts what runs on so many ranks take, from the cost model of the dual operator
/// (feti::predict()), that of a step (feti::predictStep()), and seconds of set-up measured by the survey
/// itself. Nothing is factored but the coarse matrix; it takes any number of ranks and finds the same table.
///
/// Recommended is the largest number of ranks that fits into the memory, leaves no rank idle and is expected
/// to use at least half of its ranks' time as well as the smallest number in the table that fits.
/// @throws InputError on all ranks for counts below one and for rates that cannot be read; as survey().
/// @note Collective. Guarded by tests/regression/test_plan.py.
RunPlan makeRunPlan(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
                    const run::RunOptions& options, const PlanRequest& request);

/// For the terminal.
std::string planText(const RunPlan& plan);
/// plan.json as text.
std::string planJson(const RunPlan& plan, const std::string& deck);

} // namespace Harmos::plan
