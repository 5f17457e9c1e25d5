// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_EffectCosts.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Scene.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace Harmos::scene {
namespace {

std::string timerOf(const std::string& kind) {
  return "effect " + kind;
}

std::vector<std::string> timersOf(const Scene& scene) {
  std::vector<std::string> names;
  for (const std::string& kind : scene.effectKinds())
    names.push_back(timerOf(kind));
  return names;
}

} // namespace

EffectCosts::EffectCosts(const Scene& scene) : timers_(timersOf(scene)) {
  for (const std::string& kind : scene.effectKinds()) {
    mine_.emplace_back();
    mine_.back().kind = kind;
  }
  for (const auto& effect : scene.effects)
    ++entry(effect->kind()).effects;
}

StageTimers::Scope EffectCosts::scope(const Effect& effect) const {
  return timers_.scope(timerOf(effect.kind()));
}

EffectCost& EffectCosts::entry(const std::string& kind) {
  const auto found =
      std::find_if(mine_.begin(), mine_.end(), [&](const EffectCost& cost) { return cost.kind == kind; });
  HARMOS_REQUIRE(found != mine_.end(), "an effect of the kind \"" + kind + "\" is not on, but costs");
  return *found;
}

void EffectCosts::countPrescribedAsRows() {
  for (const auto& [kind, dofs] : prescribed_)
    addRows(kind, dofs);
  prescribed_.clear();
}

std::vector<EffectCost> EffectCosts::total(const Teuchos::Comm<int>& comm) const {
  std::vector<EffectCost> result = mine_;
  const std::vector<double> seconds = timers_.seconds(comm);
  for (std::size_t k = 0; k < result.size(); ++k) {
    result[k].rows = globalSum(comm, mine_[k].rows);
    result[k].bytes = globalSum(comm, mine_[k].bytes);
    result[k].seconds = seconds[k];
  }
  return result;
}

std::string costText(const std::vector<EffectCost>& costs) {
  std::size_t width = 0;
  for (const EffectCost& cost : costs)
    width = std::max(width, cost.kind.size());
  std::ostringstream text;
  for (const EffectCost& cost : costs)
    text << (text.tellp() > 0 ? "\n" : "Effects: how many, rows of the dual problem, seconds, MiB\n") << "  "
         << std::left << std::setw(static_cast<int>(width)) << cost.kind << std::right << std::setw(8)
         << cost.effects << std::setw(10) << cost.rows << std::fixed << std::setprecision(3) << std::setw(10)
         << cost.seconds << std::setw(10) << cost.bytes / 1048576.0;
  return text.str();
}

} // namespace Harmos::scene
