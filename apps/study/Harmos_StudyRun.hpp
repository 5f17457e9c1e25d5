// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_RunReport.hpp"
#include "Harmos_SolutionComparison.hpp"
#include "Harmos_StudyPlan.hpp"

#include <memory>

namespace Harmos::study {

/// How often a setting is run: as the plan says, or for its solution alone.
enum class Repetition { Planned, Once };

/// What became of a setting.
struct Outcome {
  run::RunReport report;                       ///< of the first repetition
  std::shared_ptr<run::FinishedRun> run;       ///< null if it threw
  std::shared_ptr<const fem::SizeField> sizes; ///< of the last mesh; null: as the geometry has it
  std::string reason;                          ///< "converged", or why not
  std::map<std::string, double> seconds;       ///< medians over the repetitions; "total" is without output
  int repetitions = 0;
  double memoryMiB = 0.0; ///< growth of the resident memory of all ranks during the run, at its peak
  std::vector<std::string>
      localSolver; ///< assignments that make it inexact; none of exact ones in double precision
};

/// Runs the application with these assignments, nothing written but for scratch files. Of a deck with
/// Adaptivity all rounds, whose seconds count, and the last one's solution.
/// @param sizes of the cells of geometries: no rounds are made; null: as the deck has it.
///
/// Memory: VmHWM is reset before the run (/proc/self/clear_refs), what is resident then is taken off. Pages
/// that an earlier run left to the heap are given back first, as far as the C library does so.
/// @throws InternalError if a rank fails alone; any other failure is an outcome. @note Collective.
Outcome runSetting(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const Plan& plan,
                   const std::vector<std::string>& assignments, Repetition repetition,
                   const std::shared_ptr<const fem::SizeField>& sizes = nullptr);

/// The middle one, or the mean of the two in the middle. @pre not empty.
double median(std::vector<double> values);

} // namespace Harmos::study
