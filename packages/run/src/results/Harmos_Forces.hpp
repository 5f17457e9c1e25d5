// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactSetup.hpp"
#include "Harmos_Reactions.hpp"

#include <Teuchos_Comm.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::run {

/// A force and its moment about the origin, in space. In the plane both are per thickness, and the moment is
/// about z; membranes have forces along z alone.
struct Resultant {
  fem::Point force{}, moment{};
};

/// With what force each effect of a scene presses, holds or pulls.
struct Forces {
  struct Of {
    std::string path; ///< of the effect, see scene::Scene::effectPaths()
    Resultant resultant;
    bool hasFriction = false;
    fem::Point normal{}, tangential{}; ///< what the force is made of, with friction
    /// How wrong the forces at the nodes are, as a share of them, by estimate: of contacts, obstacles and
    /// ties.
    std::optional<double> error{};
  };
  /// Of each effect that exerts a force, in the order of the scene: by a prescribed displacement, an obstacle
  /// or a foundation on the body; by the second body of a contact or tie on the first.
  std::vector<Of> effects;
  /// |Σ of all loads and reactions| / Σ of their sizes, node by node; moments take no part.
  double balance = 0.0;
  double size = 0.0;  ///< Σ of their sizes
  double known = 0.0; ///< of it loads and springs, which are no differences of large numbers
};

/// Resultants of a solution, from the rows of B in full: what they are at prescribed values, too. A dof that
/// two effects hold, and a row that two effects ask for, counts for the first of them.
/// @param system, contact of the scene and this rank's subdomains. @param reactions see feti::reactions().
/// @param multipliers see feti::Constraints::givenMultipliers(), of the rows of the contact.
/// @param time of loads; none: of the first step. @param loads of each subdomain, where they are not those of
/// the system; of finite displacements forces act at the places where nodes are now. @return the same on
/// every rank.
/// @note Collective.
/// Guarded by tests/unit/run/test_forces.cpp.
Forces forcesOf(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                const std::vector<scene::OwnedSubdomain>& owned, const feti::SubdomainSystem& system,
                const scene::ContactSetup& contact, const feti::TornVector& displacement,
                const std::vector<std::vector<double>>& reactions, const std::vector<double>& multipliers,
                std::optional<double> time = std::nullopt,
                const std::vector<std::shared_ptr<const std::vector<double>>>* loads = nullptr);

/// A table for people; of many effects the first ones. "" without any.
std::string forcesText(const Forces& forces);

} // namespace Harmos::run
