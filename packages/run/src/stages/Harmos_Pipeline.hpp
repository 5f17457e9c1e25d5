// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Log.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_Solution.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_RCP.hpp>

#include <chrono>
#include <string>

namespace Harmos::run {

/// Runs a scene from meshes to result files.
///
///     Scene → owned subdomains → SubdomainSystem {K, f, R} → Constraints {B, c} → LocalInverses
///       → DualProblem {F, G, d, e, bounds} → qp::Problem → solver → λ → recovery → u → audit → output
///
/// @param report filled as far as the run gets, so that a failed run can be reported too.
/// @param begin when the program began, for the total time.
/// @throws InputError, NumericalError, InternalError on all ranks.
/// @note Collective.
/// Guarded by tests/verification.
Solution runScene(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
                  const RunOptions& options, const Log& log, std::chrono::steady_clock::time_point begin,
                  RunReport& report);

/// What run() refuses before anything is factorised: boundary parts that are not there, cells of no size,
/// materials out of range, surfaces that never meet. Cost: meshes, assembly and contact search; nothing is
/// kept or written.
/// @throws InputError on all ranks.
/// @note Collective.
/// Guarded by tests/regression/test_scene_input.py.
void checkScene(const Teuchos::Comm<int>& comm, const scene::Scene& scene);

/// Names, sizes and places of the boundary parts that a scene has, and parts.vtkhdf in a directory: to be
/// looked at before effects name them, which are not looked at.
/// @param directory is made; "": no file.
/// @throws InputError on all ranks.
/// @note Collective.
void showParts(const Teuchos::Comm<int>& comm, const scene::Scene& scene, const std::string& directory,
               const Log& log);

/// summary.json, on rank 0. @throws InputError on all ranks. @note Collective.
void writeSummary(const Teuchos::Comm<int>& comm, const RunOptions& options, const RunReport& report);
/// The same by a rank that is alone with its fault. @throws InputError. Local.
void writeSummaryAlone(const RunOptions& options, const RunReport& report);

} // namespace Harmos::run
