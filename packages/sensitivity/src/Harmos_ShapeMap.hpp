// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"
#include "Harmos_SplineBasis.hpp"

#include <utility>
#include <vector>

namespace Harmos::sensitivity {

/// Nodes that follow a design,
///
///     x = X + Σ_k α_k φ_k(X) ψ(X) d,   ψ = (1 − t)²(1 + 2t),   t = |h − X·d|/H below 1, else 0:
///
/// splines along a surface near the plane X·d = h, which fade to nothing at a distance H from it. A function
/// of the position at rest alone, so that copies of a node in several subdomains and bodies stay together,
/// and as smooth as splines are. Linear in the design. Local.
///
/// Guarded by tests/unit/sensitivity/test_shape_gradients.cpp.
class ShapeMap {
 public:
  /// @param direction d, of any length but zero. @param level h. @param depth H.
  /// @throws InputError for a direction without length, and a depth that is not above zero.
  ShapeMap(TensorSplineBasis basis, const fem::Point& direction, double level, double depth);

  std::size_t size() const { return static_cast<std::size_t>(basis_.size()); }
  const TensorSplineBasis& basis() const { return basis_; }
  const fem::Point& direction() const { return direction_; }

  /// φ_k(X) ψ(X) of the numbers k that move a point.
  std::vector<std::pair<std::size_t, double>> functions(const fem::Point& X) const;
  /// A mesh with its nodes moved; all else as it was.
  fem::PlacedMesh moved(const fem::PlacedMesh& mesh, const std::vector<double>& design) const;

 private:
  TensorSplineBasis basis_;
  fem::Point direction_;
  double level_, depth_;
};

} // namespace Harmos::sensitivity
