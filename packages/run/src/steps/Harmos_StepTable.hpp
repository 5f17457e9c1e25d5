// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Forces.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Types.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace Harmos::run {

/// What is told of a step that was accepted, or of a part of one: a row of steps.csv.
struct StepRow {
  int step = 1; ///< of the deck
  double time = 0.0;
  bool converged = false;
  int products = 0;          ///< with F, by the solver
  int activeSets = 0;        ///< that it examined
  double energy = 0.0;       ///< stored
  double externalWork = 0.0; ///< since the beginning, like the next two
  double dissipated = 0.0;
  double released = 0.0;                                                  ///< of jumps at constant load
  long long closed = 0, open = 0, sticking = 0, slipping = 0, broken = 0; ///< contact points
  long long newton = 0, factorisations = 0; ///< of finite displacements: iterations; on all ranks
  bool isDamped = false;                    ///< of transient runs, see StepJudge
  double kinetic = 0.0;                     ///< energy, of transient runs
  std::array<double, 3> momentum = {};      ///< of all bodies, of transient runs
  std::vector<Forces::Of> forces;
  std::vector<std::pair<std::string, double>> further; ///< see tellFurther()

  /// Columns and what stands in them, in their order, without those of the forces and further ones.
  std::vector<std::pair<std::string, double>> numbers() const;
};

/// Further columns of a scene: "history/<name>", the factor of each of the deck's histories, its measures,
/// "newton" and "factorisations" of finite displacements; of transient runs "kinetic", "damped", momenta, and
/// "impulse/<path>" of obstacles and contacts, ∫F dt by the trapezoidal rule, of damped steps by
/// the force at the end.
std::vector<std::string> furtherColumns(const scene::Scene& scene);
/// What stands there. @param before the row before, null: none. @param row whose time and forces are known.
void tellFurther(const scene::Scene& scene, const StepRow* before, StepRow& row);

/// steps.csv as text: all columns always.
/// @param paths of the effects that exert forces, in their order. @param further columns.
/// Guarded by tests/regression/test_steps.py.
std::string toCsv(const std::vector<StepRow>& rows, const std::vector<std::string>& paths,
                  const std::vector<std::string>& further = {});
/// One of its lines, with the end of the line.
std::string csvLine(const StepRow& row);

/// For checkpoints. Further columns follow from the rest, and are not kept.
/// @param paths of the forces' effects, which are not kept either.
void exchange(qp::StateArchive<MultiVector>& archive, std::vector<StepRow>& rows,
              const std::vector<std::string>& paths);

} // namespace Harmos::run
