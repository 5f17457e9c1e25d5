// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_StudyErrors.hpp"
#include "Harmos_StudyTable.hpp"

#include <string>
#include <vector>

namespace Harmos::study {

/// A finished run, as the evaluation sees it.
struct Point {
  Setting setting;
  const Row* row;
  double seconds;
  bool converged;
  Errors error;                        ///< total, relative
  std::array<bool, measures> isJudged; ///< the reference is ten times better
  std::array<bool, measures> onFront{};
  /// Seconds over those of the cheapest point that is judged and has no larger error; NaN if not judged.
  Errors ratioToFront;
};

/// What a study has found.
///
/// A point is on the Pareto front if it is judged and no other such point is both as fast and as accurate.
/// Runs that did not converge, and errors that the reference is not ten times better than, take no part.
struct Result {
  std::vector<Point> points;
  std::vector<std::string> sentences;

  /// Of all settings of the plan that the table has on so many ranks.
  Result(const Plan& plan, const Table& table, int ranks);
};

/// study.json as text.
std::string toJson(const Plan& plan, const Table& table, const Result& result, int ranks);

} // namespace Harmos::study
