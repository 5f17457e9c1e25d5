// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MovedSubdomains.hpp"

#include "Harmos_Errors.hpp"

namespace Harmos::scene {

std::vector<OwnedSubdomain> moved(const std::vector<OwnedSubdomain>& atRest,
                                  const feti::TornVector& displacement) {
  std::vector<OwnedSubdomain> result = atRest;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const auto mesh = std::make_shared<fem::Mesh>(*atRest[i].mesh.mesh);
    HARMOS_REQUIRE(mesh->coordinates.size() == displacement[i].size(),
                   "displacements have as many components as positions");
    for (std::size_t k = 0; k < displacement[i].size(); ++k)
      mesh->coordinates[k] += displacement[i][k];
    result[i].mesh.mesh = mesh;
  }
  return result;
}

} // namespace Harmos::scene
