// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SurfacePair.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace Harmos::effects {

std::vector<scene::Effect::BoundaryPart> SurfacePair::parts() const {
  return {{first.body, first.set, true}, {second.body, second.set, true}};
}

std::vector<contact::ContactPoint> SurfacePair::points(scene::ConstraintCollector& collector) const {
  const contact::Surface one = collector.surface(first.body, first.set, normal);
  const contact::Surface other = collector.surface(second.body, second.set);
  std::optional<std::vector<contact::ContactPoint>> matched;
  if (coupling == Coupling::Automatic)
    matched = contact::matchNodesIfAll(one, other);
  else if (coupling == Coupling::Nodes)
    matched = contact::matchNodes(one, other);
  std::vector<contact::ContactPoint> points =
      matched ? std::move(*matched) : contact::mortarPoints(one, other, reach);
  if (normal) // exact where it is known, not averaged with the other side's facets
    for (contact::ContactPoint& point : points) {
      const auto at = std::lower_bound(one.numbers.begin(), one.numbers.end(), point.node);
      point.normal = one.normals[static_cast<std::size_t>(at - one.numbers.begin())];
    }
  const long long found = globalSum(*one.comm, static_cast<long long>(points.size()));
  if (found < one.wholeNodes)
    collector.note(std::to_string(one.wholeNodes - found) + " of the " + std::to_string(one.wholeNodes) +
                   " nodes of " + one.name + " have no counterpart on " + other.name +
                   " within reach and may move freely through it");
  return points;
}

void SurfacePair::addTo(ParameterSpec& spec) {
  spec.text("First", "",
            "\"body/boundary part\" that carries the multipliers: the finer or softer one. Required.");
  spec.text("Second", "", "\"body/boundary part\" opposite to it. Required.");
  spec.choice("Coupling", "automatic",
              {{"automatic", "nodes where they match, else mortar"},
               {"nodes", "node to node; the nodes have to match"},
               {"mortar", "dual Lagrange multipliers; the meshes need not match"}},
              "How the two meshes are brought together.");
  spec.real("Reach", 0.0, Range::atLeast(0.0),
            "Mortar: counterparts farther than this are none; 0: a tenth of the smaller surface's extent.");
}

SurfacePair SurfacePair::fromList(const Teuchos::ParameterList& list, const std::string& path,
                                  const scene::Scene& scene) {
  SurfacePair pair;
  pair.first = partIn(scene, list, "First", path);
  pair.second = partIn(scene, list, "Second", path);
  if (pair.first.body == pair.second.body && pair.first.set == pair.second.set)
    throw InputError("\"" + path +
                         "\": \"First\" and \"Second\" are the same boundary part; name two that face "
                         "each other",
                     {{"path", path}});
  const std::string coupling = list.get<std::string>("Coupling");
  pair.coupling = coupling == "nodes"    ? Coupling::Nodes
                  : coupling == "mortar" ? Coupling::Mortar
                                         : Coupling::Automatic;
  pair.reach = list.get<double>("Reach");
  return pair;
}

} // namespace Harmos::effects
