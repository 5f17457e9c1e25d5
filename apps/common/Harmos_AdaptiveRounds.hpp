// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Log.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_Quantity.hpp"
#include "Harmos_RoundAim.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_Solution.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_ParameterList.hpp>
#include <Teuchos_RCP.hpp>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::app {

/// The list Adaptivity of a deck.
void addAdaptivityTo(ParameterSpec& deck);

/// Whether a deck asks for meshes that follow the error. Local.
bool isAdaptive(const Teuchos::ParameterList& deck);

/// Runs of a scene on meshes of its geometry that follow the estimated error, round after round: what is
/// known of them, rounds.csv, and what the next mesh is to be. The results of a round that another one
/// follows are in round_1 and so on, those of the last one in the output directory.
///
/// Members are collective but for those that say otherwise.
/// Guarded by tests/verification/accuracy/test_adaptivity.py.
class AdaptiveRounds {
 public:
  /// @param deck validated; without the list there is one round.
  /// @throws InputError for a quantity without a direction, or what it is of. Local.
  AdaptiveRounds(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const Teuchos::ParameterList& deck);

  /// Whether meshes are to be adapted. Local.
  bool isAsked() const { return limits_.rounds > 0; }
  /// Whether a round has been made, and its results are there. Local.
  bool hasResults() const { return !rows_.empty(); }
  /// Quantity that runs are asked for, and a tolerance of at most a hundredth of the target. Local.
  void setOptions(run::RunOptions& options) const;
  /// Before the first round. @throws InputError for what does not go with it: meshes that are no geometries,
  /// a restart, bodies in motion, at finite displacements or that yield. Local.
  void check(const scene::Scene& scene, const run::RunOptions& options) const;
  /// Sizes of the cells of the next round; null: as the geometry has them. Local.
  std::shared_ptr<const fem::SizeField> sizes() const { return sizes_; }

  /// A round begins, before its scene is made. Local.
  void begin() { begin_ = std::chrono::steady_clock::now(); }
  /// Whether seconds and memory that are expected of it, by the plan of such a run (plan::makeRunPlan()),
  /// are within the limits; if so results of the round before are put aside.
  /// @param programMiB before there was a scene. @throws InputError on all ranks where files cannot be moved.
  bool mayGoOn(const scene::Scene& scene, const run::RunOptions& options, const Log& log, double programMiB);
  /// After the run of a round: estimates the error, puts it among the report's results, and decides on the
  /// next mesh. @return a sentence on the round.
  std::string judge(const scene::Scene& scene, const run::Solution& solution, run::RunReport& report);
  bool isOver() const { return isOver_; }
  /// rounds.csv. @throws InputError on all ranks.
  void write(const std::string& directory) const;

 private:
  struct Row {
    double cells, dofs, error, norm, energy, products, seconds;
    std::optional<double> value = std::nullopt, bound = std::nullopt; // of the quantity; relative
  };
  struct Limits {
    int rounds = 0;                               // after the first
    double cells = 0.0, seconds = 0.0, MiB = 0.0; // 0: none; MiB of a rank
  };
  struct Judgement; // of a round
  Judgement estimate(const scene::Scene& scene, const run::Solution& solution) const;
  double secondsSoFar() const;

  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  std::string meshFile_;
  Limits limits_;
  double target_ = 0.0;
  std::shared_ptr<const run::Quantity> quantity_; // null: the energy
  std::optional<run::RoundAim> aim_;
  std::vector<Row> rows_;
  std::shared_ptr<const fem::SizeField> sizes_;
  bool isOver_ = false;
  double expected_ = 0.0, slowness_ = 1.0; // seconds of a round by its plan; what they were, over that
  std::chrono::steady_clock::time_point begin_;
};

} // namespace Harmos::app
