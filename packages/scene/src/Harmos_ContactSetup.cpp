// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactSetup.hpp"

#include "Harmos_Errors.hpp"

#include <cmath>
#include <map>

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
      append(contact::tieRows(comm, points, components, equalities));
      equalities += static_cast<long long>(points.size()) * components;
    }
  }
  for (const ObstacleContact& contact : scene.obstacles)
    addContact(contact::obstaclePoints(surface(contact.body, contact.set, nullptr), contact.obstacle));
  return setup;
}

} // namespace Harmos::scene
