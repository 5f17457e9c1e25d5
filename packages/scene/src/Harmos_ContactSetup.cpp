// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactSetup.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

namespace Harmos::scene {
namespace {

// The subdomains of this rank by body and boundary part: scenes may have thousands of parts.
class Parts {
 public:
  explicit Parts(const std::vector<OwnedSubdomain>& owned) {
    for (const OwnedSubdomain& item : owned)
      for (const auto& set : item.mesh.sides)
        parts_[{item.body, set.first}].push_back(&item.mesh);
  }
  const std::vector<const fem::PlacedMesh*>& of(int body, const std::string& set) const {
    static const std::vector<const fem::PlacedMesh*> none;
    const auto found = parts_.find({body, set});
    return found == parts_.end() ? none : found->second;
  }

 private:
  std::map<std::pair<int, std::string>, std::vector<const fem::PlacedMesh*>> parts_;
};

// Dofs of both surfaces of an interface that have prescribed values; the same on every rank. Collective.
std::set<long long> heldDofs(const Teuchos::Comm<int>& comm, const Scene& scene,
                             const std::vector<OwnedSubdomain>& owned, const Interface& interface) {
  const int components = scene.components();
  std::vector<long long> mine;
  for (const OwnedSubdomain& item : owned)
    for (const auto& [body, name] : {std::make_pair(interface.firstBody, interface.firstSet),
                                     std::make_pair(interface.secondBody, interface.secondSet)}) {
      const auto surface = item.mesh.sets.find(name);
      if (item.body != body || surface == item.mesh.sets.end())
        continue;
      for (const Body::PrescribedDisplacement& prescribed :
           scene.bodies[static_cast<std::size_t>(body)].prescribed)
        if (const auto set = item.mesh.sets.find(prescribed.set); set != item.mesh.sets.end()) {
          std::vector<int> both;
          std::set_intersection(surface->second.begin(), surface->second.end(), set->second.begin(),
                                set->second.end(), std::back_inserter(both));
          for (int node : both)
            mine.push_back(item.mesh.number(node) * components + prescribed.component);
        }
    }
  const std::vector<long long> all = gatherAll(comm, mine);
  return {all.begin(), all.end()};
}

std::vector<contact::ContactPoint> pointsOf(const Interface& interface, const contact::Surface& first,
                                            const contact::Surface& second) {
  using Coupling = Interface::Coupling;
  const bool nodes = interface.coupling == Coupling::Nodes ||
                     (interface.coupling == Coupling::Automatic && contact::nodesMatch(first, second));
  std::vector<contact::ContactPoint> points =
      nodes ? contact::matchNodes(first, second) : contact::mortarPoints(first, second, interface.reach);
  for (contact::ContactPoint& point : points) {
    point.gap += interface.gap;
    if (interface.normal) { // exact where it is known, not averaged with the other side's facets
      const auto at = std::lower_bound(first.numbers.begin(), first.numbers.end(), point.node);
      point.normal = first.normals[static_cast<std::size_t>(at - first.numbers.begin())];
    }
  }
  return points;
}

} // namespace

ContactSetup setUpContact(const Teuchos::Comm<int>& comm, const Scene& scene,
                          const std::vector<OwnedSubdomain>& owned) {
  ContactSetup setup;
  const Parts parts(owned);
  const auto surface = [&](int body, const std::string& set, const contact::NormalField& normal) {
    return contact::gatherSurface(comm, parts.of(body, set), set,
                                  scene.bodies[static_cast<std::size_t>(body)].name + "/" + set, normal);
  };
  const auto append = [&](std::vector<ConstraintRow> more) {
    setup.rows.insert(setup.rows.end(), std::make_move_iterator(more.begin()),
                      std::make_move_iterator(more.end()));
  };
  const int components = scene.components();
  long long equalities = 0;
  const auto addContact = [&](const std::vector<contact::ContactPoint>& points) {
    append(contact::contactRows(comm, points, components, static_cast<long long>(setup.points.size())));
    setup.points.insert(setup.points.end(), points.begin(), points.end());
  };
  for (const Interface& interface : scene.interfaces) {
    const contact::Surface first = surface(interface.firstBody, interface.firstSet, interface.normal);
    const contact::Surface second = surface(interface.secondBody, interface.secondSet, nullptr);
    const std::vector<contact::ContactPoint> points = pointsOf(interface, first, second);
    if (interface.kind == Interface::Kind::Contact) {
      addContact(points);
    } else {
      const contact::TieRows ties =
          contact::tieRows(comm, points, components, equalities, heldDofs(comm, scene, owned, interface));
      append(ties.rows);
      equalities += ties.count;
    }
  }
  for (const ObstacleContact& contact : scene.obstacles)
    addContact(contact::obstaclePoints(surface(contact.body, contact.set, nullptr), contact.obstacle));
  return setup;
}

} // namespace Harmos::scene
