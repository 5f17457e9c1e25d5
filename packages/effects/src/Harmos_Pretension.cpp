// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Pretension.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Loads.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_PointAlgebra.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace Harmos::effects {
namespace {

constexpr double notGiven = -1.0;

std::shared_ptr<const scene::Effect> makePretension(const Teuchos::ParameterList& list,
                                                    const std::string& path, const scene::Scene& scene) {
  requireElastic(scene, "\"" + path + "\"");
  Pretension::Options options;
  const double force = list.get<double>("Force"), shift = list.get<double>("Shift"),
               from = list.get<double>("Locked from");
  if ((force != 0.0) == (shift != 0.0))
    throw InputError("\"" + path + "\" has " +
                         (force != 0.0 ? "both \"Force\" and \"Shift\"" : "neither \"Force\" nor \"Shift\"") +
                         "; give one of them",
                     {{"path", path}});
  if (from != notGiven && force == 0.0)
    throw InputError("\"" + path +
                         "/Locked from\" is given with \"Shift\", which is its length already; remove it",
                     {{"path", path + "/Locked from"}});
  (force != 0.0 ? options.force : options.shift) = force != 0.0 ? force : shift;
  if (from != notGiven)
    options.lockedFrom = from;
  return std::make_shared<Pretension>(partIn(scene, list, "First", path), partIn(scene, list, "Second", path),
                                      options, scene::nameIn(path));
}

// Two directions at right angles to n and each other, along axes where n is along one; one in the plane.
std::vector<fem::Point> tangentsOf(const fem::Point& n, int components) {
  if (components == 2)
    return {{-n[1], n[0], 0.0}};
  std::size_t least = 0;
  for (std::size_t d = 1; d < 3; ++d)
    if (std::abs(n[d]) < std::abs(n[least]))
      least = d;
  fem::Point axis{};
  axis[least] = 1.0;
  const fem::Point across = cross(n, axis), t = scaled(1.0 / norm(across), across);
  return {t, cross(n, t)};
}

} // namespace

scene::EffectKind kindOfPretension() {
  ParameterSpec spec("<bolt>", "A bolt is cut and pulled together: by a force, or by a shift of both sides.");
  spec.text("First", "", "\"body/boundary part\": one side of a plane cut through the bolt. Required.");
  spec.text(
      "Second", "",
      "\"body/boundary part\": the other side, with the same nodes. Mesh the bolt in two volumes, each a "
      "body: their common surface is a part of both. Required.");
  spec.real("Force", 0.0, Range(), "Force of the bolt, positive in tension; 0: not given.");
  spec.real("Shift", 0.0, Range(), "Length by which the bolt is shorter; 0: not given.");
  spec.real("Locked from", notGiven, Range(),
            "With \"Force\": time, the end of a step, from which on the bolt keeps its length; -1: never.");
  return {Pretension::kindName, spec, makePretension, true};
}

Pretension::Pretension(Part first, Part second, const Options& options, std::string name)
    : Effect(kindName, std::move(name)),
      first_(std::move(first)),
      second_(std::move(second)),
      options_(options) {}

std::vector<scene::Effect::BoundaryPart> Pretension::boundaryParts() const {
  return {{first_.body, first_.set, true, false, true}, {second_.body, second_.set, true, false, true}};
}

std::vector<int> Pretension::bodies() const {
  if (!options_.force)
    return {};
  return first_.body == second_.body ? std::vector<int>{first_.body}
                                     : std::vector<int>{first_.body, second_.body};
}

void Pretension::check(const scene::Scene& scene) const {
  if (!options_.lockedFrom)
    return;
  const std::vector<double>& ends = scene.timeline.ends();
  const bool isEnd = std::any_of(ends.begin(), ends.end(), [&](double end) {
    return std::abs(end - *options_.lockedFrom) <= 1e-12 * std::abs(end);
  });
  if (!scene.timeline.hasSteps() || !isEnd)
    throw InputError(label() + " is locked from time " + scientific(*options_.lockedFrom) +
                     ", which is not the end of a step; name one of \"Steps/Times\"");
}

std::optional<scene::Effect::Key> Pretension::loadKey(const scene::Scene&,
                                                      const scene::OwnedSubdomain& subdomain) const {
  const auto has = [&](const Part& part) {
    return subdomain.body == part.body && subdomain.mesh.sides.count(part.set) > 0;
  };
  return options_.force && (has(first_) || has(second_)) ? std::optional<Key>(ownKey(subdomain))
                                                         : std::nullopt;
}

// Outwards, on either side, evenly over the area at rest.
void Pretension::pull(const Part& part, const scene::OwnedSubdomain& atRest, const scene::OwnedSubdomain& now,
                      std::vector<double>& load) const {
  const auto sides = atRest.mesh.sides.find(part.set);
  if (atRest.body != part.body || sides == atRest.mesh.sides.end())
    return;
  const double area = atRest.measures.at(part.set).area;
  const fem::Point& normal = now.measures.at(part.set).normal;
  const fem::Point traction = scaled(*options_.force / area / norm(normal), normal);
  const fem::PlacedMesh& placed = atRest.mesh;
  addTo(load, fem::assembleTraction(*placed.mesh, placed.anchor, sides->second,
                                    [&](const fem::Point&, const fem::Point&) { return traction; }));
}

void Pretension::addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                         std::vector<double>& load) const {
  if (scene.isFinite())
    return;
  pull(first_, subdomain, subdomain, load);
  pull(second_, subdomain, subdomain, load);
}

namespace {

// Around an axis the mean normal of a ring is that of rest.
const scene::OwnedSubdomain& directed(const scene::Scene& scene,
                                      const scene::FiniteBehaviour::Deformed& subdomain) {
  return scene.physics == scene::Physics::Axisymmetric ? subdomain.rest : subdomain.now;
}

} // namespace

void Pretension::addFollowingLoad(const scene::Scene& scene, const Deformed& subdomain,
                                  std::vector<double>& load) const {
  pull(first_, subdomain.rest, directed(scene, subdomain), load);
  pull(second_, subdomain.rest, directed(scene, subdomain), load);
}

void Pretension::addForce(const scene::Scene& scene, const Deformed& subdomain,
                          std::vector<double>& load) const {
  pull(first_, subdomain.rest, directed(scene, subdomain), load);
}

void Pretension::requirePlane(const scene::ConstraintCollector& collector) const {
  const scene::PartMeasure first = collector.measureAtRest(first_.body, first_.set),
                           second = collector.measureAtRest(second_.body, second_.set);
  constexpr double flat = 1e-6; // cosine of a tenth of a degree
  const double length = norm(first.normal);
  if (!(length >= (1.0 - flat) * first.area) ||
      !(-dot(first.normal, second.normal) >= (1.0 - flat) * length * second.area))
    throw InputError(label() +
                     ": the cut is not plane, or its sides do not face each other; cut the bolt along "
                     "a plane between two volumes");
}

namespace {

using Node = scene::ConstraintCollector::Node;

// Outward on a side. An axis is one to the last bit: rows of what is held on a plane of symmetry are told by
// their dofs.
fem::Point directionOf(const scene::PartMeasure& measure) {
  constexpr double rounding = 1e-12;
  fem::Point n = scaled(1.0 / norm(measure.normal), measure.normal);
  for (double& component : n)
    component = std::abs(component) <= rounding ? 0.0 : component;
  return scaled(1.0 / norm(n), n);
}

// Nodes of both sides that are at the same place at rest, and where the first one is now.
struct NodePair {
  Node first, second;
  fem::Point now;
};

std::vector<NodePair> pairsOf(scene::ConstraintCollector& collector, const Part& onFirst,
                              const Part& onSecond, const std::string& label) {
  const std::vector<Node> first = collector.allNodesAtRest(onFirst.body, onFirst.set),
                          second = collector.allNodesAtRest(onSecond.body, onSecond.set),
                          now = collector.allNodesOf(onFirst.body, onFirst.set);
  collector.allNodesOf(onSecond.body, onSecond.set); // which asks for what is held there
  double extent = 0.0;
  for (const Node& node : first)
    extent = std::max(extent, norm(difference(node.position, first.front().position)));
  constexpr double tolerance = 1e-6;
  std::vector<NodePair> pairs;
  for (std::size_t k = 0; k < first.size(); ++k) {
    const Node& node = first[k];
    const Node* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const Node& other : second)
      if (const double distance = norm(difference(node.position, other.position)); distance < least) {
        least = distance;
        nearest = &other;
      }
    if (!(least <= tolerance * extent))
      throw InputError(label + ": the node at " + placeText(node.position) +
                       " of the first side has no counterpart on the second one; both sides need the same "
                       "nodes, as of one surface between two volumes");
    pairs.push_back({node, *nearest, now[k].position});
  }
  if (first.size() != second.size())
    throw InputError(label + ": its sides have " + std::to_string(first.size()) + " and " +
                     std::to_string(second.size()) + " nodes; both need the same ones");
  return pairs;
}

using Equation = scene::ConstraintCollector::Equation;

// Jumps of pairs of nodes, u¹ − u², along a direction.
class JumpRows {
 public:
  JumpRows(scene::ConstraintCollector& collector, std::vector<NodePair> pairs, const fem::Point& along)
      : collector_(collector), pairs_(std::move(pairs)), along_(along) {}

  void addEach(double value) const {
    for (const NodePair& pair : pairs_) {
      Equation row;
      add(row, pair, 1.0);
      row.value = value;
      collector_.addEquation(row);
    }
  }

  // All are the same: the mean jump of one half of the nodes is that of the other one, and likewise within
  // the halves. These rows are orthogonal (Haar 1910), so that they cost no more iterations than addEach().
  void addEqual() { split(0, pairs_.size()); }

  // Their mean, which keeps its value from a time on.
  void addLocked(double from) const {
    Equation row;
    for (const NodePair& pair : pairs_)
      add(row, pair, 1.0 / static_cast<double>(pairs_.size()));
    row.resultant = Equation::Resultant{middle(0, pairs_.size()), along_, std::nullopt};
    row.lockedFrom = from;
    collector_.addEquation(row);
  }

 private:
  void add(Equation& row, const NodePair& pair, double factor) const {
    for (int c = 0; c < collector_.components(); ++c)
      if (const double coefficient = factor * along_[static_cast<std::size_t>(c)]; coefficient != 0.0) {
        row.terms.push_back({pair.first, c, coefficient});
        row.terms.push_back({pair.second, c, -coefficient});
      }
  }

  fem::Point middle(std::size_t begin, std::size_t end) const {
    fem::Point sum{};
    for (std::size_t k = begin; k < end; ++k)
      for (std::size_t d = 0; d < 3; ++d)
        sum[d] += pairs_[k].now[d] / static_cast<double>(end - begin);
    return sum;
  }

  // Along the axis on which they reach farthest.
  void split(std::size_t begin, std::size_t end) {
    if (end - begin < 2)
      return;
    std::vector<fem::Point> places;
    for (std::size_t k = begin; k < end; ++k)
      places.push_back(pairs_[k].first.position);
    const fem::Box box = fem::boxAround(places);
    std::size_t axis = 0;
    for (std::size_t d = 1; d < 3; ++d)
      if (box.high[d] - box.low[d] > box.high[axis] - box.low[axis])
        axis = d;
    const auto place = [&](std::size_t k) { return pairs_.begin() + static_cast<std::ptrdiff_t>(k); };
    std::sort(place(begin), place(end), [&](const NodePair& a, const NodePair& b) {
      return std::tie(a.first.position[axis], a.first.number) <
             std::tie(b.first.position[axis], b.first.number);
    });
    const std::size_t centre = begin + (end - begin) / 2;
    const auto low = static_cast<double>(centre - begin), high = static_cast<double>(end - centre);
    const double size = std::sqrt(low * high / (low + high)); // for rows of length one
    Equation row;
    for (std::size_t k = begin; k < end; ++k)
      add(row, pairs_[k], k < centre ? size / low : -size / high);
    row.resultant = Equation::Resultant{middle(begin, centre), scaled(size, along_), middle(centre, end)};
    collector_.addEquation(row);
    split(begin, centre);
    split(centre, end);
  }

  scene::ConstraintCollector& collector_;
  std::vector<NodePair> pairs_;
  fem::Point along_;
};

} // namespace

// The mean normal of the deformed cut; of half a bolt, which a plane of symmetry holds, or around an axis it
// does not leave the plane, or the axis.
fem::Point Pretension::directionNow(scene::ConstraintCollector& collector, const fem::Point& atRest) const {
  if (collector.isAroundAxis())
    return atRest;
  fem::Point n = directionOf(collector.measureOf(first_.body, first_.set));
  for (int c = 0; c < collector.components(); ++c)
    if (atRest[static_cast<std::size_t>(c)] == 0.0 &&
        (collector.isHeldAnywhere(first_.body, first_.set, c) ||
         collector.isHeldAnywhere(second_.body, second_.set, c)))
      n[static_cast<std::size_t>(c)] = 0.0;
  return scaled(1.0 / norm(n), n);
}

void Pretension::addConstraints(scene::ConstraintCollector& collector) const {
  requirePlane(collector);
  const fem::Point atRest = directionOf(collector.measureAtRest(first_.body, first_.set)),
                   n = collector.isOfMoved() ? directionNow(collector, atRest) : atRest;
  const std::vector<NodePair> pairs = pairsOf(collector, first_, second_, label());
  for (const fem::Point& t : tangentsOf(atRest, collector.components()))
    JumpRows(collector, pairs, turned(atRest, n, t)).addEach(0.0);
  JumpRows along(collector, pairs, n);
  if (options_.shift)
    return along.addEach(*options_.shift);
  along.addEqual();
  if (options_.lockedFrom)
    along.addLocked(*options_.lockedFrom);
}

} // namespace Harmos::effects
