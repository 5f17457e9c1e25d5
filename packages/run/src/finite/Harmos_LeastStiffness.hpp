// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SubdomainSystem.hpp"

#include <functional>
#include <optional>

namespace Harmos::run {

/// What is asked of bodies in equilibrium, of displacements and forces of all subdomains. Collective.
struct StiffnessActions {
  /// How bodies would move under a small force if K̂ were their stiffness, and as contacts let them; copies of
  /// nodes move alike. Nothing where that is not to be had.
  std::function<std::optional<feti::TornVector>(const feti::TornVector& force)> motion;
  std::function<feti::TornVector(const feti::TornVector& motion)> reference; ///< K̂v
  /// K_T v, of all that forces depend on: stresses, contacts that turn, loads that follow.
  std::function<feti::TornVector(const feti::TornVector& motion)> whole;
  /// Of a motion and a force, of all ranks.
  std::function<double(const feti::TornVector&, const feti::TornVector&)> product;
};

/// The least vᵀK_T v / vᵀK̂v that few motions show, and the motion, of vᵀK̂v = 1. An equilibrium with one
/// below zero is not stable: there is a way along which energy comes free (Bažant, Cedolin: Stability of
/// Structures, 1991, chapter 4). Above zero nothing is proved, but that Lanczos' iteration for K̂⁻¹K_T, whose
/// first vectors show what is slender, has not found any.
struct LeastStiffness {
  /// Of motions that are found by solves to a hundredth, and of differences: to what values are known.
  static constexpr double errors = 1e-3;
  double value = 1.0;
  feti::TornVector motion;
  bool isBelowZero() const { return value < -errors; }
};
/// @param force that the first motion is of: of all of them a little. It stops where the value is below zero,
/// where all values are near one, and after six motions.
/// @return nothing where there is no motion. @note Collective.
/// Guarded by tests/unit/run/test_least_stiffness.cpp.
std::optional<LeastStiffness> leastStiffness(const StiffnessActions& actions, feti::TornVector force);

} // namespace Harmos::run
