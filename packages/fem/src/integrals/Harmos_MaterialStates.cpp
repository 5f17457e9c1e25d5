// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MaterialStates.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <algorithm>

namespace Harmos::fem {

MaterialLaws::MaterialLaws(const Elasticity& elasticity) {
  for (const Material& material : elasticity.materials) {
    laws_.push_back(makeMaterialLaw(material, elasticity.kinematics, elasticity.strains));
    stateSize_ = std::max(stateSize_, laws_.back()->stateSize());
  }
}

const MaterialLaw& MaterialLaws::of(int region) const {
  HARMOS_REQUIRE(region >= 0 && region < static_cast<int>(laws_.size()), "a region has no material");
  return *laws_[static_cast<std::size_t>(region)];
}

MaterialStates initialStates(const Mesh& mesh, const Elasticity& elasticity) {
  MaterialStates states;
  states.size = MaterialLaws(elasticity).stateSize();
  if (states.size == 0)
    return states;
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh, elasticity.integration));
  states.points = static_cast<std::size_t>(element.points());
  states.numbers.assign(static_cast<std::size_t>(mesh.numberOfCells()) * states.points * states.size, 0.0);
  return states;
}

} // namespace Harmos::fem
