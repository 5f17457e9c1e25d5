// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Elasticity.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace Harmos::fem {

/// The laws of the materials of a mesh, of each region, and how many numbers the state of a point has: those
/// of the law that has most.
class MaterialLaws {
 public:
  explicit MaterialLaws(const Elasticity& elasticity);

  /// @throws InternalError if the region has no material.
  const MaterialLaw& of(int region) const;
  std::size_t stateSize() const { return stateSize_; }

 private:
  std::vector<std::unique_ptr<MaterialLaw>> laws_;
  std::size_t stateSize_ = 0;
};

/// States of the points of integration of a mesh's stiffness, cell by cell; empty where no material has any.
struct MaterialStates {
  std::size_t size = 0;   ///< numbers of a point
  std::size_t points = 0; ///< of a cell
  std::vector<double> numbers;

  double* at(int cell, int point) { return numbers.data() + place(cell, point); }
  const double* at(int cell, int point) const { return numbers.data() + place(cell, point); }

 private:
  std::size_t place(int cell, int point) const {
    return size == 0 ? 0 : (static_cast<std::size_t>(cell) * points + static_cast<std::size_t>(point)) * size;
  }
};

/// Of a body that nothing has happened to.
MaterialStates initialStates(const Mesh& mesh, const Elasticity& elasticity);

} // namespace Harmos::fem
