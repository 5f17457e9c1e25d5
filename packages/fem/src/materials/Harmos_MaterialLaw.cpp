// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MaterialLaw.hpp"

#include "Harmos_ElasticLaw.hpp"
#include "Harmos_PlaneStressLaw.hpp"
#include "Harmos_PlasticLaw.hpp"

namespace Harmos::fem {

MaterialLaw::~MaterialLaw() = default;

std::unique_ptr<MaterialLaw> makeMaterialLaw(const Material& material, Kinematics kinematics,
                                             Strains strains) {
  if (!material.plasticity)
    return std::make_unique<ElasticLaw>(material, kinematics, strains);
  auto law = std::make_unique<PlasticLaw>(material, strains);
  if (kinematics == Kinematics::PlaneStress)
    return std::make_unique<PlaneStressLaw>(std::move(law));
  return law;
}

} // namespace Harmos::fem
