// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_NextMesh.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_Solution.hpp"

#include <Teuchos_ParameterList.hpp>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace Harmos::app {

/// The list Adaptivity of a deck.
void addAdaptivityTo(ParameterSpec& deck);

/// Runs of a scene on meshes of its geometry that follow the estimated error, round after round: what is
/// known of them, rounds.csv, and what the next mesh is to be. The results of a round that another one
/// follows are in round_1 and so on, those of the last one in the output directory.
///
/// Members are collective but for those that say otherwise.
/// Guarded by tests/verification/accuracy/test_adaptivity.py.
class AdaptiveRounds {
 public:
  /// @param deck validated; without the list there is one round.
  AdaptiveRounds(const Teuchos::Comm<int>& comm, const Teuchos::ParameterList& deck);

  /// Whether meshes are to be adapted. Local.
  bool isAsked() const { return most_ > 0; }
  /// Before the first round. @throws InputError for what does not go with it: meshes that are no geometries,
  /// a restart, bodies in motion, at finite displacements or that yield. Local.
  void check(const scene::Scene& scene, const run::RunOptions& options) const;
  /// Sizes of the cells of the next round; null: as the geometry has them. Local.
  std::shared_ptr<const fem::SizeField> sizes() const { return sizes_; }
  /// A round begins. Local.
  void begin() { begin_ = std::chrono::steady_clock::now(); }
  /// After the run of a round: estimates the error, puts it among the report's results, and decides on the
  /// next mesh. @return a sentence on the round.
  std::string judge(const scene::Scene& scene, const run::Solution& solution, run::RunReport& report);
  bool isOver() const { return isOver_; }
  /// Writes rounds.csv; where a round follows, puts the results aside. @throws InputError on all ranks.
  void write(const std::string& directory) const;

 private:
  struct Row {
    double cells, dofs, error, energy, products, seconds;
  };

  const Teuchos::Comm<int>& comm_;
  std::string meshFile_;
  int most_ = 0; // rounds after the first
  double target_ = 0.0, maximumCells_ = 0.0;
  std::vector<Row> rows_;
  std::shared_ptr<const fem::SizeField> sizes_;
  bool isOver_ = false;
  std::chrono::steady_clock::time_point begin_;
};

} // namespace Harmos::app
