// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactSetup.hpp"
#include "Harmos_Forces.hpp"
#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <Teuchos_Comm.hpp>

#include <memory>
#include <string>
#include <vector>

namespace Harmos::run {

/// A number of an answer, Φ(u, λ), that somebody is after.
struct Quantity {
  enum class Kind {
    Displacement, ///< along a direction, the mean over a boundary part; of one without sides over its nodes
    Force,        ///< along a direction, of an effect, see Forces
    /// Of a contact or an obstacle ∫pⁿ⁺¹/∫pⁿ, the mean of the pressure weighted by its n-th power, n = 8.
    PeakPressure
  };
  Kind kind;
  std::string of; ///< "body/boundary part", or the path of an effect: "Contact/joint"
  fem::Point direction;

  /// @throws InputError for what is not in the scene, or has no such quantity, and for scenes whose answers
  /// have no derivative of this kind: friction, adhesion. Local.
  void check(const scene::Scene& scene) const;
};

/// What there is of it, in the solution of a scene.
struct QuantityValue {
  double value = 0.0;
  /// Its adjoint z, which solves the problem that is linear at the answer (what bears force is closed, what
  /// does not open) with the loads Φ_u and the gaps Φ_λ; the reaction of what is prescribed is that of z = 1
  /// there. What the quantity is wrong by is then |a(u − u_h, z − z_h)| ≤ Σ η_u η_z over the cells (Becker,
  /// Rannacher: An optimal control approach to a posteriori error estimation, Acta Numerica 10, 2001).
  feti::TornVector adjoint;
};

/// The linear problem of an adjoint, without what is known of it.
struct AdjointProblem {
  double value = 0.0; ///< Φ(u, λ)
  std::vector<std::shared_ptr<const std::vector<double>>> loads;
  std::vector<ConstraintRow> rows;
  feti::TornVector known; ///< what of it is known, to be added; empty: nothing
};

/// What an adjoint is made from; subdomains and rows of this rank.
struct AnswerParts {
  const scene::Scene& scene;
  const std::vector<scene::OwnedSubdomain>& owned;
  const feti::SubdomainSystem& system;
  const scene::ContactSetup& contact;
  const feti::TornVector& displacement;
  const std::vector<double>& multipliers; ///< of the rows of the contact, as they were given
  const Forces& forces;
};

/// The quantity PeakPressure of forces at points with areas, and its derivatives by the forces; zero where
/// nothing bears. @note Collective. Guarded by tests/unit/run/test_next_mesh.cpp.
struct PeakOfPressure {
  double value = 0.0;
  std::vector<double> derivatives;
};
PeakOfPressure peakOfPressure(const Teuchos::Comm<int>& comm, const std::vector<double>& forces,
                              const std::vector<double>& areas);

/// @throws InputError on all ranks for a boundary part that is not there, and a pressure where nothing bears.
/// @note Collective. Guarded by tests/verification/accuracy/test_quantities.py.
AdjointProblem adjointProblem(const Teuchos::Comm<int>& comm, const Quantity& quantity,
                              const AnswerParts& answer);

} // namespace Harmos::run
