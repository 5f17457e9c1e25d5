// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PartsOfRank.hpp"

namespace Harmos::scene {
namespace {

template<class Subdomains>
const Subdomains& partOrNone(const std::map<PartsOfRank::Part, Subdomains>& all,
                             const PartsOfRank::Part& part) {
  static const Subdomains none;
  const auto found = all.find(part);
  return found == all.end() ? none : found->second;
}

} // namespace

PartsOfRank::PartsOfRank(const std::vector<OwnedSubdomain>& owned) : owned_(owned) {
  for (const OwnedSubdomain& item : owned) {
    for (const auto& set : item.mesh.sides)
      sides_[{item.body, set.first}].push_back(&item.mesh);
    for (const auto& set : item.mesh.sets)
      nodes_[{item.body, set.first}].push_back(&item);
  }
}

const std::vector<const fem::PlacedMesh*>& PartsOfRank::withSides(const Part& part) const {
  return partOrNone(sides_, part);
}

const std::vector<const OwnedSubdomain*>& PartsOfRank::withNodes(const Part& part) const {
  return partOrNone(nodes_, part);
}

std::vector<const fem::PlacedMesh*> PartsOfRank::of(int body) const {
  std::vector<const fem::PlacedMesh*> result;
  for (const OwnedSubdomain& item : owned_)
    if (item.body == body)
      result.push_back(&item.mesh);
  return result;
}

} // namespace Harmos::scene
