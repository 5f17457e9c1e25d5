// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactSetup.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <unordered_map>

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
std::map<long long, double> heldDofs(const Teuchos::Comm<int>& comm, const Scene& scene,
                                     const std::vector<OwnedSubdomain>& owned, const Interface& interface) {
  const int components = scene.components();
  struct Held {
    long long dof;
    double value;
  };
  std::vector<Held> mine;
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
            mine.push_back(
                {item.mesh.number(node) * components + prescribed.component,
                 prescribed.field ? prescribed.field(item.mesh.position(node)) : prescribed.value});
        }
    }
  std::map<long long, double> held;
  for (const Held& item : gatherAll(comm, mine))
    held.emplace(item.dof, item.value);
  return held;
}

// Points whose rows differ. Effects that overlap give the same row twice, perhaps with the surfaces
// exchanged; two of them would be dependent, and of contacts the one with the smaller gap is enough.
class DistinctPoints {
 public:
  // Ties have rows in every direction: their normals do not matter.
  explicit DistinctPoints(bool normalsMatter) : normalsMatter_(normalsMatter) {}

  void add(const std::vector<contact::ContactPoint>& more) {
    for (const contact::ContactPoint& point : more) {
      std::vector<std::size_t>& here = withNode_[point.terms.front().node];
      const auto twin =
          std::find_if(here.begin(), here.end(), [&](std::size_t k) { return sameRow(all_[k], point); });
      if (twin != here.end()) {
        all_[*twin].gap = std::min(all_[*twin].gap, point.gap);
        continue;
      }
      here.push_back(all_.size());
      all_.push_back(point);
    }
  }
  std::vector<contact::ContactPoint>& all() { return all_; }

 private:
  bool sameRow(const contact::ContactPoint& a, const contact::ContactPoint& b) const {
    constexpr double rounding = 1e-12;
    if (a.terms.size() != b.terms.size())
      return false;
    for (double sign : {1.0, -1.0}) {
      bool same = true;
      for (std::size_t d = 0; d < 3 && normalsMatter_; ++d)
        same = same && std::abs(a.normal[d] - sign * b.normal[d]) <= rounding;
      for (std::size_t k = 0; same && k < a.terms.size(); ++k)
        same = a.terms[k].node == b.terms[k].node &&
               std::abs(a.terms[k].weight - sign * b.terms[k].weight) <= rounding;
      if (same)
        return true;
    }
    return false;
  }

  bool normalsMatter_;
  std::vector<contact::ContactPoint> all_;
  std::unordered_map<long long, std::vector<std::size_t>> withNode_; // by the lowest node
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
  DistinctPoints contacts(scene.physics != Physics::Membrane), ties(false);
  std::map<long long, double> held; // dofs at ties
  for (const Interface& interface : scene.interfaces) {
    const contact::Surface first = surface(interface.firstBody, interface.firstSet, interface.normal);
    const contact::Surface second = surface(interface.secondBody, interface.secondSet, nullptr);
    const std::vector<contact::ContactPoint> points = pointsOf(interface, first, second);
    if (points.size() < first.numbers.size())
      setup.notes.push_back(std::to_string(first.numbers.size() - points.size()) + " of the " +
                            std::to_string(first.numbers.size()) + " nodes of " + first.name +
                            " have no counterpart on " + second.name +
                            " within reach and may move freely through it");
    if (interface.kind == Interface::Kind::Contact) {
      contacts.add(points);
    } else {
      ties.add(points);
      held.merge(heldDofs(comm, scene, owned, interface));
    }
  }
  for (const ObstacleContact& contact : scene.obstacles)
    contacts.add(contact::obstaclePoints(surface(contact.body, contact.set, nullptr), contact.obstacle));
  setup.points = std::move(contacts.all());
  setup.rows = contact::contactRows(comm, setup.points, scene.components(), 0);
  const std::vector<ConstraintRow> equalities =
      contact::tieRows(comm, ties.all(), scene.components(), 0, held).rows;
  setup.rows.insert(setup.rows.end(), equalities.begin(), equalities.end());
  return setup;
}

} // namespace Harmos::scene
