// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StageTimers.hpp"

#include "Harmos_Errors.hpp"

#include <Teuchos_CommHelpers.hpp>

namespace Harmos {

StageTimers::StageTimers(const std::vector<std::string>& stages) : stages_(stages) {
  for (const std::string& stage : stages) {
    const std::string name = "Harmos: " + stage;
    Teuchos::RCP<Teuchos::Time> time = Teuchos::TimeMonitor::lookupCounter(name);
    if (time.is_null())
      time = Teuchos::TimeMonitor::getNewCounter(name);
    counters_[stage] = Counter{time, time->totalElapsedTime()};
  }
}

StageTimers::Scope StageTimers::scope(const std::string& stage) const {
  const auto found = counters_.find(stage);
  HARMOS_REQUIRE(found != counters_.end(), "the stage \"" + stage + "\" has no timer");
  return Scope(*found->second.time);
}

std::vector<double> StageTimers::ownSeconds() const {
  std::vector<double> mine;
  for (const std::string& stage : stages_) {
    const Counter& counter = counters_.at(stage);
    mine.push_back(counter.time->totalElapsedTime() - counter.before);
  }
  return mine;
}

std::vector<double> StageTimers::seconds(const Teuchos::Comm<int>& comm) const {
  const std::vector<double> mine = ownSeconds();
  std::vector<double> result(mine.size(), 0.0);
  if (!mine.empty())
    Teuchos::reduceAll<int, double>(comm, Teuchos::REDUCE_MAX, static_cast<int>(mine.size()), mine.data(),
                                    result.data());
  return result;
}

} // namespace Harmos
