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
  std::ostringstream text;
  text << "Active effects                      number      rows   seconds       MiB" << std::fixed
       << std::setprecision(3);
  for (const EffectCost& cost : costs)
    text << "\n  " << std::left << std::setw(30) << cost.kind << std::right << std::setw(10) << cost.effects
         << std::setw(10) << cost.rows << std::setw(10) << cost.seconds << std::setw(10)
         << cost.bytes / 1048576.0;
  return text.str();
}

} // namespace Harmos::scene
