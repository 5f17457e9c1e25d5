// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Teuchos_Comm.hpp>
#include <Teuchos_Time.hpp>
#include <Teuchos_TimeMonitor.hpp>

#include <map>
#include <string>
#include <vector>

namespace Harmos {

/// Seconds spent in the named stages of one run, on top of Teuchos::TimeMonitor.
///
/// Each stage is the TimeMonitor counter "Harmos: <stage>", so that an application's own summary shows it.
/// Counters are global to the process and grow over several runs; this object reports only what was added
/// since it was made.
class StageTimers {
 public:
  /// @param stages names, in the order of reporting.
  explicit StageTimers(const std::vector<std::string>& stages);

  /// Times the scope it lives in. A stage may be entered again later, but not within itself.
  class Scope {
   public:
    explicit Scope(Teuchos::Time& time) : monitor_(time) {}

   private:
    Teuchos::TimeMonitor monitor_;
  };

  /// @throws InternalError for a stage that was not named at construction.
  Scope scope(const std::string& stage) const;

  const std::vector<std::string>& stages() const { return stages_; }

  /// Seconds of each stage on this rank, in the order of stages(). Local.
  std::vector<double> ownSeconds() const;

  /// Seconds of each stage, in the order of stages(): the maximum over the ranks. @note Collective.
  std::vector<double> seconds(const Teuchos::Comm<int>& comm) const;

 private:
  struct Counter {
    Teuchos::RCP<Teuchos::Time> time;
    double before;
  };
  std::vector<std::string> stages_;
  std::map<std::string, Counter> counters_;
};

} // namespace Harmos
