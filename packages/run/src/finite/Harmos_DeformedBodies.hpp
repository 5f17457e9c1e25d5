// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_LocalMatrix.hpp"
#include "Harmos_MaterialStates.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_Comm.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace Harmos::run {

/// The bodies of a scene, at small or finite displacements: what they answer, by the states of their
/// materials when the step began, with the springs that effects add to them. Displacements are of all nodes
/// of this rank's subdomains, dof = node · components + component.
///
/// Members are collective. Guarded by tests/unit/run/test_finite_displacements.cpp.
class DeformedBodies {
 public:
  /// All of these have to outlive it.
  DeformedBodies(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                 const std::vector<scene::OwnedSubdomain>& atRest);

  struct Forces {
    feti::TornVector internal; ///< of each subdomain
    double energy = 0.0;       ///< stored, of all ranks
    double dissipated = 0.0;   ///< by materials since the run began, of all ranks
    std::vector<char> yields;  ///< of each subdomain of this rank, whether its tangent is one of going on
    double yielding = 0.0;     ///< points where it is, of all ranks
    bool isSound = true;       ///< no cell is turned inside out, on any rank; else nothing else is of use
  };
  /// @param time of temperatures. @throws NumericalError on all ranks for cells that are inverted at rest.
  Forces forces(const feti::TornVector& displacement, double time) const;

  /// Loads that go with the deformed bodies at a time, of each subdomain; nothing without any.
  /// @throws InputError on all ranks.
  feti::TornVector followingLoads(const feti::TornVector& displacement, double time) const;

  /// What a Newton iteration takes for the derivative of forces, with its kernel.
  struct Tangent {
    std::vector<std::shared_ptr<const LocalMatrix>> matrices;
    std::vector<std::shared_ptr<const feti::Kernel>> kernels;
  };
  /// The material part, see fem::assembleStrainTangent(), of sound displacements.
  /// @param times of temperatures of each subdomain. @param which of them: others keep what is there.
  void makeTangent(const feti::TornVector& displacement, const std::vector<double>& times,
                   const std::vector<char>& which, Tangent& tangent) const;
  /// States of the materials of each subdomain. Empty where none has any.
  using States = std::vector<fem::MaterialStates>;
  /// Those of an answer.
  States statesAfter(const feti::TornVector& displacement, double time) const;
  /// When the last step was accepted.
  const States& states() const { return states_; }
  void setStates(States states) { states_ = std::move(states); }

  /// By how each subdomain has turned on the way from one displacement to another, in the mean (the rotation
  /// nearest to how its nodes have moved: Kabsch 1976); none of those that have not, and where nodes lie in a
  /// line. Local.
  std::vector<std::optional<feti::Frame>> frames(const feti::TornVector& from,
                                                 const feti::TornVector& to) const;

  /// u + du, where each body turns by what is linear in du: the mean W of the skew parts of ∂du/∂x gives way
  /// to Q − I, Q = (I − W/2)⁻¹(I + W/2), by which the trapezoidal rule turns a rigid body.
  feti::TornVector turned(const feti::TornVector& displacement, const feti::TornVector& change) const;

  /// Of each node.
  int components() const { return scene_.components(); }

  /// Gives copies of a node their mean. @return the largest change of a component, of all ranks.
  double joinCopies(feti::TornVector& displacement) const;

  /// Where at rest the node is that moves most. Collective.
  fem::Point placeOfLargest(const feti::TornVector& motion) const;

  /// Bu of this rank's rows of friction, ties and equations, of joined copies; of inequalities, whose gaps
  /// are those of deformed bodies, zero, but at small displacements.
  std::vector<double> products(const std::vector<ConstraintRow>& rows,
                               const feti::TornVector& displacement) const;

 private:
  std::vector<fem::TemperatureRise> risesAt(double time) const;
  fem::TemperatureRise riseAt(std::size_t subdomain, double time) const;
  fem::Elasticity elasticityAt(std::size_t subdomain) const;

  const Teuchos::Comm<int>& comm_;
  const scene::Scene& scene_;
  const std::vector<scene::OwnedSubdomain>& atRest_;
  std::vector<std::shared_ptr<const LocalMatrix>> springs_; // of each subdomain; null: none
  States states_;
};

} // namespace Harmos::run
