// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"
#include "Harmos_Tensors.hpp"

#include <Teuchos_Comm.hpp>

#include <optional>
#include <vector>

namespace Harmos::run {

/// How bodies turn, as wholes, where nodes at x go by du: of each how many there are, Σx, Σxxᵀ, Σdu xᵀ, Σdu.
/// Guarded by tests/verification/physics/test_transient_finite.py.
class RigidTurns {
 public:
  RigidTurns(std::size_t bodies, std::size_t components)
      : components_(components), sums_(bodies * width, 0.0) {}

  /// @param from by which displacements nodes are at x. Local.
  void add(int body, const fem::PlacedMesh& mesh, const std::vector<double>& from,
           const std::vector<double>& change);
  /// Of all ranks. @note Collective.
  void sumUp(const Teuchos::Comm<int>& comm);

  fem::Point centreOf(int body) const;
  /// Q − I − W = (I − W/2)⁻¹W²/2: W the mean of the skew parts of ∂du/∂x, Q = (I − W/2)⁻¹(I + W/2) the
  /// rotation by which the trapezoidal rule turns what moves on by du. None of nodes in a plane, or a line of
  /// it.
  std::optional<fem::Tensor> excessOf(int body) const;

 private:
  static constexpr std::size_t width = 25;
  std::size_t components_;
  std::vector<double> sums_;
};

} // namespace Harmos::run
