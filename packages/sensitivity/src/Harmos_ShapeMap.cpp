// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ShapeMap.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"

#include <cmath>
#include <memory>

namespace Harmos::sensitivity {

ShapeMap::ShapeMap(TensorSplineBasis basis, const fem::Point& direction, double level, double depth)
    : basis_(std::move(basis)), direction_(direction), level_(level), depth_(depth) {
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  if (!(length > 0.0) || !std::isfinite(length))
    throw InputError("the direction in which a design moves nodes is a zero vector; give the outward normal "
                     "of the surface");
  if (!(depth > 0.0) || !std::isfinite(level))
    throw InputError("a design moves nodes down to a depth of " + scientific(depth) +
                     " below the surface; give a positive depth, such as the thickness of the body");
  for (double& component : direction_)
    component /= length;
}

std::vector<std::pair<std::size_t, double>> ShapeMap::functions(const fem::Point& X) const {
  const double along = X[0] * direction_[0] + X[1] * direction_[1] + X[2] * direction_[2];
  const double t = std::abs(level_ - along) / depth_;
  std::vector<std::pair<std::size_t, double>> result;
  if (t >= 1.0)
    return result;
  const double fading = (1.0 - t) * (1.0 - t) * (1.0 + 2.0 * t);
  const TensorSplineBasis::Values at = basis_.at(X);
  for (std::size_t k = 0; k < at.count; ++k)
    if (at.values[k] != 0.0)
      result.emplace_back(static_cast<std::size_t>(at.functions[k]), at.values[k] * fading);
  return result;
}

fem::PlacedMesh ShapeMap::moved(const fem::PlacedMesh& mesh, const std::vector<double>& design) const {
  fem::PlacedMesh result = mesh;
  const auto moved = std::make_shared<fem::Mesh>(*mesh.mesh);
  const auto dimension = static_cast<std::size_t>(moved->dimension());
  for (int node = 0; node < moved->numberOfNodes(); ++node) {
    double amount = 0.0;
    for (const auto& [k, value] : functions(mesh.position(node)))
      amount += design[k] * value;
    for (std::size_t d = 0; d < dimension && amount != 0.0; ++d)
      moved->coordinates[static_cast<std::size_t>(node) * dimension + d] += amount * direction_[d];
  }
  result.mesh = moved;
  return result;
}

} // namespace Harmos::sensitivity
