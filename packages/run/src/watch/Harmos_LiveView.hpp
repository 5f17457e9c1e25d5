// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualStages.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_QpTypes.hpp"

#include <chrono>
#include <deque>
#include <fstream>
#include <optional>
#include <string>

namespace Harmos::run {

/// How long a solver will take to get from its residuals to its targets, if these go on falling as they did
/// over the last iterations: the line through the logarithm of the larger of ‖g^P‖/target and ‖Gλ‖/target, by
/// least squares.
/// Guarded by tests/unit/run/test_live_view.cpp.
class RemainingTime {
 public:
  static constexpr std::size_t window = 50;

  void add(const qp::IterationRecord& record, const feti::DualTargets& targets);
  /// Seconds; nothing as long as they do not fall, or are not known well enough.
  std::optional<double> seconds() const;

 private:
  struct Point {
    double inner, seconds, logarithm;
  };
  std::deque<Point> points_;
};

/// What people see of a run that is not finished: iterations.csv as it grows, and a line on the terminal.
///
/// Only rank 0 writes, at most every quarter of a second. A file that cannot be written is no reason to stop:
/// the run says so when it writes its results.
class LiveView {
 public:
  /// @param path of iterations.csv, or "" on a rank that writes none. @param method shown first.
  /// @param before the row that this solve's are counted on from. @param appends to a file that is there.
  LiveView(const std::string& path, const std::string& method, const Log& log,
           const qp::IterationRecord& before = {}, bool appends = false);
  /// Takes the line off the terminal.
  ~LiveView();

  /// Rows of a run that this one goes on from.
  void begin(const std::vector<qp::IterationRecord>& rows);
  void add(const qp::IterationRecord& record, const feti::DualTargets& targets);

 private:
  const Log& log_;
  std::string method_;
  std::ofstream history_;
  qp::IterationRecord before_;
  RemainingTime remaining_;
  std::chrono::steady_clock::time_point last_;
};

/// "PDAS 3/120  41 s, 12 s left  |g^P| 2.1e-03/1.0e-06  |G l| 3.4e-09/2.0e-05": outer and inner iteration,
/// times, ‖g^P‖ and ‖Gλ‖ against their targets.
std::string statusLine(const std::string& method, const qp::IterationRecord& record,
                       const feti::DualTargets& targets, const std::optional<double>& remaining);

} // namespace Harmos::run
