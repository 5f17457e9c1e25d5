// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Effect.hpp"
#include "Harmos_StageTimers.hpp"

#include <Teuchos_Comm.hpp>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace Harmos::scene {

/// What the effects of one kind cost in a run.
struct EffectCost {
  std::string kind;
  long long effects = 0; ///< of this kind
  long long rows = 0;    ///< of the dual problem that they ask for
  double seconds = 0.0;  ///< in what they add to the discrete problem: the maximum over the ranks
  double bytes = 0.0; ///< of what the run keeps for it: rows, contact points, loads, matrices; of all ranks
};

/// Gathers the cost of the effects that are on in a scene. There is a timer, the Teuchos::TimeMonitor counter
/// "Harmos: effect <kind>", for each kind that is on, and for no other.
///
/// Guarded by tests/unit/effects/test_absence.cpp.
class EffectCosts {
 public:
  explicit EffectCosts(const Scene& scene);

  /// Times an effect while it lives; not within itself.
  StageTimers::Scope scope(const Effect& effect) const;
  /// Of this rank.
  void addRows(const std::string& kind, long long rows) { entry(kind).rows += rows; }
  void addBytes(const std::string& kind, std::size_t bytes) {
    entry(kind).bytes += static_cast<double>(bytes);
  }
  /// Dofs with prescribed values: rows where the Dirichlet conditions are dual.
  void addPrescribed(const std::string& kind, long long dofs) { prescribed_[kind] += dofs; }
  void countPrescribedAsRows();

  /// By kind, in the order of the scene. @note Collective.
  std::vector<EffectCost> total(const Teuchos::Comm<int>& comm) const;

 private:
  EffectCost& entry(const std::string& kind);

  std::vector<EffectCost> mine_;
  std::map<std::string, long long> prescribed_;
  StageTimers timers_;
};

/// A line a kind, for people.
std::string costText(const std::vector<EffectCost>& costs);

} // namespace Harmos::scene
