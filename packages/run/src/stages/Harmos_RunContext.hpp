// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Log.hpp"
#include "Harmos_RankTable.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_StageTimers.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_RCP.hpp>

namespace Harmos::run {

/// What a run is of, and whom it tells; what it refers to outlives the run.
struct RunContext {
  Teuchos::RCP<const Teuchos::Comm<int>> comm;
  const scene::Scene& scene;
  const RunOptions& options;
  const Log& log;
  const StageTimers& timers;
  RunReport& report; ///< filled as far as the run gets
  RankShare& share;  ///< likewise
};

} // namespace Harmos::run
