// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DeformedBodies.hpp"
#include "Harmos_GeneralisedAlpha.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_SubdomainSystem.hpp"
#include "Harmos_TornArchive.hpp"

#include <Teuchos_Comm.hpp>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace Harmos::run {

/// Bodies in motion: velocities, accelerations and forces of inertia of a transient run, from step to step. A
/// step is the quadratic program of a static one,
///
///     min ½uᵀ(K + κM)u − f̂ᵀu   over   B_I u ≤ c_I,  B_E u = c_E,
///     f̂ = f₁ + κβΔt²M(c₂(u₀ + Δt v₀) + c₃a₀) − (α_m Ma₀ − α_f i₀)/(1 − α_f),
///
/// c₂ = 1/(βΔt²), c₃ = 1/(2β) − 1, see GeneralisedAlpha. M is lumped, and nodes in contact are without mass
/// (fem::lumpedMasses()). Forces of inertia i are each subdomain's own, with those of its multipliers.
///
/// Where bodies iterate to equilibrium (EquilibriumLoop), at finite displacements or as materials yield, the
/// same rule has f_int(u) in the place of Ku, and the tangent is K̂ + κM: M is the same however bodies turn.
///
/// Where values are prescribed v₁ = (u₁ − u₀)/Δt and a₁ = (v₁ − v₀)/Δt, i₁ = Ma₁, with 1/Δt² in the place of
/// κ: those of the method would alternate from step to step, and reactions with them.
///
/// Guarded by tests/verification/physics/test_transient.py.
class Motion {
 public:
  /// Both to outlive it.
  Motion(const Teuchos::Comm<int>& comm, const scene::Scene& scene);

  /// Adds κM to the stiffness of subdomains, and takes the motions that have mass from their kernels.
  /// @param owned to outlive this. @throws InputError for a subdomain all of whose nodes are in contact.
  /// Local.
  void addMasses(const std::vector<scene::OwnedSubdomain>& owned, std::vector<feti::Subdomain>& subdomains,
                 double step);
  /// At rest, but for initial velocities; accelerations are those of the loads. @note Collective.
  void begin(const std::vector<std::shared_ptr<const std::vector<double>>>& loads);

  /// Steps to come are by GeneralisedAlpha::damped(), or by the timeline's own rule.
  void damp(bool isDamped) { isDamped_ = isDamped; }
  bool isDamped() const { return isDamped_; }
  /// Of forces where a step begins, α_f.
  double weightBefore() const { return rule().alphaF; }
  /// (β − 1/6)Δt‖a₁ − a₀‖_M of what was reached: the error of the displacement (Zienkiewicz, Xie, Earthq.
  /// Eng. Struct. Dyn. 20, 1991) over Δt. Over ‖v‖_M it is (ωΔt)²(β − 1/6) of a vibration, with β = ¼ the
  /// relative error of its period. @note Collective.
  double error() const;

  /// K + κM of steps of another length or rule than before; nothing where it is the same. Local.
  std::optional<std::vector<std::shared_ptr<const LocalMatrix>>> matricesOf(double step);
  using Loads = std::vector<std::shared_ptr<const std::vector<double>>>;
  /// The step to loads f₁ begins. @return f̂. Local.
  Loads pose(const Loads& loads);
  /// A step of an equilibrium that is iterated to, and its tangent: K̂ + κM, which nothing is in the kernel
  /// of. Those of a K̂ that was there before are the same. Local.
  void beginStep(double step) { step_ = step; }
  DeformedBodies::Tangent tangentOf(const DeformedBodies::Tangent& ofStresses);
  /// That at rest, of stresses alone.
  DeformedBodies::Tangent ofStressesAtRest() const { return {stiffness_, {}}; }
  /// i₁ of displacements with equal copies. Local.
  feti::TornVector inertiaOf(const feti::TornVector& displacement) const;
  /// duᵀκM du. @note Collective.
  double stiffnessAlong(const feti::TornVector& change) const;
  /// ‖v₁ − v₀‖_M of displacements. @note Collective.
  double velocityChange(const feti::TornVector& displacement) const;
  /// What a step has come to; nothing is committed. @param copies of nodes in several subdomains that differ
  /// by what the solver left are joined. @note Collective.
  void reach(const feti::TornVector& displacement);
  void commit();

  /// ½uᵀKu − fᵀu + λᵀ(Bu − c), by that of the step's program, of what was reached. @note Collective.
  double lagrangian(double ofStep) const;
  /// f₁ − i₁, which Ku + Bᵀλ balances, of what was reached. Local.
  Loads loadsAndInertia() const;
  /// ½vᵀMv, Mv, of what was reached. @note Collective.
  double kineticEnergy() const;
  std::array<double, 3> momentum() const;
  /// Of nodes without mass the mean one of the step. Of what was reached.
  const feti::TornVector& velocities() const { return reached_.velocity; }

  /// What was committed. @note Collective.
  void exchange(TornArchive& torn);

 private:
  struct State {
    feti::TornVector displacement, velocity, acceleration, inertia; // M a of each subdomain: i
  };
  GeneralisedAlpha rule() const;
  std::vector<char> nodesInContact(const scene::OwnedSubdomain& subdomain) const;
  std::vector<double> addedTo(std::size_t subdomain) const;
  std::vector<std::shared_ptr<const LocalMatrix>>
  matrices(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness);
  // What the rule says of a dof that has gone a way in the step.
  struct Moved {
    double velocity, acceleration, inertia;
  };
  Moved moved(std::size_t subdomain, std::size_t dof, double way) const;
  double weighed(const feti::TornVector& a, const feti::TornVector& b) const;

  const Teuchos::Comm<int>& comm_;
  const scene::Scene& scene_;
  bool isDamped_ = false;
  const std::vector<scene::OwnedSubdomain>* owned_ = nullptr;
  feti::TornVector masses_;
  std::vector<std::shared_ptr<const LocalMatrix>> stiffness_;
  std::vector<std::vector<char>> isHeld_;                    // of each dof: values prescribed
  std::vector<std::shared_ptr<const feti::Kernel>> kernels_; // empty
  // K + κM that were made last, by K and κM.
  std::map<std::pair<std::shared_ptr<const LocalMatrix>, std::vector<double>>,
           std::shared_ptr<const LocalMatrix>>
      made_;
  double step_ = 0.0, factor_ = 0.0; // Δt, κ of the matrices that were made last
  Loads loads_, posed_;              // f₁, f̂
  State committed_, reached_;
};

} // namespace Harmos::run
