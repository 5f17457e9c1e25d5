// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverMonitor.hpp"
#include "Harmos_TimedLoads.hpp"
#include "Harmos_Types.hpp"

#include <vector>

namespace Harmos::run {

/// The energies of a run, from state to state.
///
/// Stored: ½uᵀKu − f_Tᵀu + ½∫ε_T:C:ε_T, f_T the loads of strains; ½uᵀKu is taken from the Lagrangian ½uᵀKu −
/// fᵀu + λᵀ(Bu − c), in whose error jumps are of second order, less what friction dissipates of it. From
/// outside, by the trapezoidal rule,
///
///     ΔW = Σ_h ½(h₀ + h₁)(f_hᵀu₁ − f_hᵀu₀) + Σ_h ½(g_hᵀr₀ + g_hᵀr₁)(h₁ − h₀)
///
/// of loads and of prescribed values with forces r on them; strains do the work −½(f_hᵀu₀ + f_hᵀu₁)(h₁ − h₀)
/// + Δ½∫ε_T:C:ε_T. A run begins without loads: h₀ = 0, but a transient one. Where forces are linear in time
/// ΔW is exact, else its error is of second order in the length of the steps.
///
/// All members are local. Guarded by tests/unit/run/test_step_sequence.cpp and
/// tests/regression/test_steps.py.
class EnergyAccount {
 public:
  /// What an answer contributes.
  struct Answer {
    std::vector<double> factors;          ///< h of each case
    scene::TimedLoads::Products products; ///< of each case
    double lagrangian = 0.0;              ///< feti::KktAudit::energy
    double freeStrainEnergy = 0.0;        ///< ½∫ε_T:C:ε_T
    double frictionWork = 0.0;            ///< of the step: feti::KktAudit::frictionWork
    double breaking = 0.0;                ///< dissipated by damage, since the run began
    double furtherWork = 0.0;             ///< in the step, of loads that are no cases: following ones
    double flow = 0.0;                    ///< dissipated by materials that yield, since the run began
  };

  /// @param dissipates whether there is friction. @param breaks whether there is damage.
  explicit EnergyAccount(std::vector<scene::TimedLoads::Case> cases, bool dissipates = false,
                         bool breaks = false);

  /// Loads have these factors when the run begins, at rest.
  void beginWith(std::vector<double> factors) { before_.factors = std::move(factors); }

  /// The step from the last committed answer to this one; nothing is committed.
  void reach(Answer answer);
  void commit();

  double stored() const { return stored_; }
  /// Since the beginning of the run.
  double externalWork() const { return work_; }
  /// By friction, Σλ_tᵀΔs, damage and flow, since the beginning of the run.
  double dissipated() const { return dissipated_ + reached_.breaking + reached_.flow; }
  /// What bodies have left over where points broke faster than loads went on, which would set them in motion:
  /// the external work of steps in which damage grew that is neither stored nor dissipated, where that is
  /// positive. Among it are errors of the trapezoidal rule in these steps.
  double released() const { return released_; }
  /// What the step released if no followed path would have: more than the rule can be wrong where forces and
  /// displacements go one way, half of what the ones change by times what the others do; else 0. Before the
  /// step is committed.
  double snapped() const;

  /// What was committed.
  void exchange(qp::StateArchive<MultiVector>& archive);

 private:
  std::vector<scene::TimedLoads::Case> cases_;
  Answer before_, reached_;
  bool dissipates_, breaks_;
  double committedWork_ = 0.0, work_ = 0.0, stored_ = 0.0;
  double committedDissipation_ = 0.0, dissipated_ = 0.0;
  double committedStored_ = 0.0, committedRelease_ = 0.0, released_ = 0.0;
};

} // namespace Harmos::run
