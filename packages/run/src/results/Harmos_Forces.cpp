// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Forces.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_MovedSubdomains.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>
#include <unordered_map>

namespace Harmos::run {
namespace {

using fem::Point;

// A force at each node of a subdomain, by component, as a vector in space.
Point vectorOf(const double* components, int count) {
  Point result{};
  for (int c = 0; c < count; ++c)
    result[count == 1 ? 2 : static_cast<std::size_t>(c)] = components[c];
  return result;
}

double length(const Point& v) {
  return std::hypot(v[0], v[1], v[2]);
}

// Sums on this rank; all of them meet in one reduction.
class Sums {
 public:
  Sums(const scene::Scene& scene, const scene::ContactSetup& contact)
      : scene_(scene), values_(6 * scene.effects.size() + 5, 0.0) {
    for (std::size_t k = 0; k < scene.effects.size(); ++k)
      place_[scene.effects[k].get()] = k;
    for (const auto& effect : scene.effects)
      if (contact.tangential.count(effect.get()) > 0) {
        tangential_.emplace(effect.get(), values_.size());
        values_.resize(values_.size() + 3, 0.0);
      }
  }

  void addTangential(const scene::Effect& effect, const Point& force) {
    for (std::size_t d = 0; d < 3; ++d)
      values_[tangential_.at(&effect) + d] += force[d];
  }

  void add(const scene::Effect& effect, const Point& position, const Point& force) {
    double* sum = values_.data() + 6 * place_.at(&effect);
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t e = (d + 1) % 3, g = (d + 2) % 3;
      sum[d] += force[d];
      sum[3 + d] += position[e] * force[g] - position[g] * force[e];
    }
  }
  // Of the outside on the bodies, with what is to be counted as its size.
  void addOuter(const Point& force, double size) {
    double* sum = values_.data() + 6 * scene_.effects.size();
    for (std::size_t d = 0; d < 3; ++d)
      sum[d] += force[d];
    sum[3] += size;
  }
  void addOuter(const Point& force) { addOuter(force, length(force)); }
  // The same, of what is no reaction.
  void addKnown(const Point& force, double size) {
    addOuter(force, size);
    values_[6 * scene_.effects.size() + 4] += size;
  }

  Forces total(const Teuchos::Comm<int>& comm) {
    globalSum(comm, values_);
    Forces forces;
    const std::vector<std::string> paths = scene_.effectPaths();
    for (std::size_t k = 0; k < scene_.effects.size(); ++k) {
      if (!scene_.effects[k]->exertsForce())
        continue;
      const double* sum = values_.data() + 6 * k;
      Forces::Of& of = forces.effects.emplace_back();
      of.path = paths[k];
      of.resultant = {{sum[0], sum[1], sum[2]}, {sum[3], sum[4], sum[5]}};
      if (const auto part = tangential_.find(scene_.effects[k].get()); part != tangential_.end()) {
        of.hasFriction = true;
        for (std::size_t d = 0; d < 3; ++d) {
          of.tangential[d] = values_[part->second + d];
          of.normal[d] = of.resultant.force[d] - of.tangential[d];
        }
      }
    }
    const double* outer = values_.data() + 6 * scene_.effects.size();
    forces.size = outer[3];
    forces.known = outer[4];
    if (outer[3] > 0.0)
      // Radial forces are in equilibrium around the axis.
      forces.balance =
          length({scene_.physics == scene::Physics::Axisymmetric ? 0.0 : outer[0], outer[1], outer[2]}) /
          outer[3];
    return forces;
  }

 private:
  const scene::Scene& scene_;
  std::vector<double> values_; // force and moment of each effect; all outer forces, their sizes, known
  std::unordered_map<const scene::Effect*, std::size_t> place_, tangential_;
};

// Loads; congruent subdomains share them.
void addLoads(const scene::Scene& scene, const std::vector<std::shared_ptr<const std::vector<double>>>& loads,
              Sums& sums) {
  struct Load {
    Point force{};
    double size = 0.0;
  };
  const auto components = static_cast<std::size_t>(scene.components());
  std::map<const std::vector<double>*, Load> known;
  for (const auto& shared : loads) {
    const std::vector<double>& f = *shared;
    const auto [place, isNew] = known.try_emplace(&f);
    Load& load = place->second;
    for (std::size_t k = 0; isNew && k < f.size(); k += components) {
      const Point force = vectorOf(f.data() + k, static_cast<int>(components));
      for (std::size_t d = 0; d < 3; ++d)
        load.force[d] += force[d];
      load.size += length(force);
    }
    sums.addKnown(load.force, load.size);
  }
}

// Where a node is: of small displacements, where it was.
Point placeOf(const scene::Scene& scene, const scene::OwnedSubdomain& item, const std::vector<double>& u,
              int node) {
  Point x = item.mesh.position(node);
  const auto components = static_cast<std::size_t>(scene.components());
  for (std::size_t d = 0; d < components && scene.isFinite(); ++d)
    x[d] += u[static_cast<std::size_t>(node) * components + d];
  return x;
}

// Of loads that are forces of effects, see scene::Effect::addForce().
void addGivenForces(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                    const std::vector<scene::OwnedSubdomain>& owned, const feti::TornVector& displacement,
                    double time, Sums& sums) {
  if (std::none_of(scene.effects.begin(), scene.effects.end(),
                   [](const auto& effect) { return effect->loadsWithItsForce(); }))
    return;
  std::vector<scene::OwnedSubdomain> moved;
  if (scene.isFinite()) {
    moved = scene::moved(owned, displacement);
    scene::measureParts(comm, scene, moved);
  }
  const auto components = static_cast<std::size_t>(scene.components());
  for (const auto& effect : scene.effects) {
    const std::vector<int> bodies = effect->bodies();
    if (!effect->loadsWithItsForce())
      continue;
    const double factor = scene.timeline.factor(*effect, time);
    for (std::size_t i = 0; i < owned.size(); ++i) {
      const scene::OwnedSubdomain& item = owned[i];
      if (std::find(bodies.begin(), bodies.end(), item.body) == bodies.end())
        continue;
      std::vector<double> load(static_cast<std::size_t>(item.mesh.mesh->numberOfNodes()) * components, 0.0);
      effect->addForce(scene, {item, scene.isFinite() ? moved[i] : item}, load);
      for (std::size_t k = 0; k < load.size(); k += components) {
        Point force = vectorOf(load.data() + k, static_cast<int>(components));
        for (double& component : force)
          component *= factor;
        if (length(force) > 0.0)
          sums.add(*effect, placeOf(scene, item, displacement[i], static_cast<int>(k / components)), force);
      }
    }
  }
}

// What holds prescribed dofs. Effects are asked in the order in which the system was made.
void addReactions(const scene::Scene& scene, const std::vector<scene::OwnedSubdomain>& owned,
                  const feti::SubdomainSystem& system, const feti::TornVector& displacement,
                  const std::vector<std::vector<double>>& reactions, Sums& sums) {
  const int components = scene.components();
  for (std::size_t i = 0; i < owned.size(); ++i) {
    if (reactions[i].empty())
      continue;
    const std::vector<feti::FixedDof>& fixed = system.subdomain(static_cast<int>(i)).fixed;
    std::set<int> counted;
    std::vector<feti::FixedDof> part;
    std::size_t next = 0;
    for (const auto& effect : scene.effects) {
      const std::vector<int> bodies = effect->bodies();
      if (std::find(bodies.begin(), bodies.end(), owned[i].body) == bodies.end())
        continue;
      part.clear();
      effect->addPrescribed(scene, owned[i], part);
      for (std::size_t k = 0; k < part.size(); ++k, ++next) {
        HARMOS_REQUIRE(next < fixed.size() && fixed[next].dof == part[k].dof,
                       "an effect prescribes other dofs than when the run began");
        if (!counted.insert(part[k].dof).second)
          continue;
        Point force = scene::directionOf(scene, part[k].dof % components);
        for (double& component : force)
          component *= reactions[i][next];
        sums.add(*effect, placeOf(scene, owned[i], displacement[i], part[k].dof / components), force);
        sums.addOuter(force);
      }
    }
  }
}

// Foundations and whatever else is in the matrix of a subdomain: −Au.
void addSprings(const scene::Scene& scene, const std::vector<scene::OwnedSubdomain>& owned,
                const feti::TornVector& displacement, Sums& sums) {
  const int components = scene.components();
  for (const auto& effect : scene.effects) {
    const std::vector<int> bodies = effect->bodies();
    for (std::size_t i = 0; i < owned.size(); ++i) {
      if (std::find(bodies.begin(), bodies.end(), owned[i].body) == bodies.end() ||
          !effect->stiffnessKey(scene, owned[i]))
        continue;
      std::vector<MatrixEntry> entries;
      effect->addStiffness(scene, owned[i], entries);
      std::map<int, std::array<double, 3>> atNode;
      for (const MatrixEntry& entry : entries)
        atNode[entry.row / components][static_cast<std::size_t>(entry.row % components)] -=
            entry.value * displacement[i][static_cast<std::size_t>(entry.column)];
      for (const auto& [node, values] : atNode) {
        const Point force = vectorOf(values.data(), components);
        sums.add(*effect, placeOf(scene, owned[i], displacement[i], node), force);
        sums.addKnown(force, length(force));
      }
    }
  }
}

// Contacts, ties and obstacles. A row whose coefficients do not sum to zero is one with the outside.
void addRows(const scene::Scene& scene, const scene::ContactSetup& contact,
             const std::vector<double>& multipliers, Sums& sums) {
  const int components = scene.components();
  for (std::size_t k = 0; k < contact.rows.size(); ++k) {
    const scene::ContactSetup::Origin& origin = contact.origins[k];
    Point force{}, outer{};
    for (std::size_t d = 0; d < 3; ++d)
      force[d] = -multipliers[k] * origin.direction[d];
    sums.add(*origin.effect, origin.position, force);
    if (origin.counter)
      sums.add(*origin.effect, *origin.counter, {-force[0], -force[1], -force[2]});
    if (origin.isTangential)
      sums.addTangential(*origin.effect, force);
    for (const ConstraintRow::Term& term : contact.rows[k].terms) {
      const Point along = scene::directionOf(scene, static_cast<int>(term.dof % components));
      for (std::size_t d = 0; d < 3; ++d)
        outer[d] -= multipliers[k] * term.coefficient * along[d];
    }
    sums.addOuter(outer);
  }
}

} // namespace

Forces forcesOf(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                const std::vector<scene::OwnedSubdomain>& owned, const feti::SubdomainSystem& system,
                const scene::ContactSetup& contact, const feti::TornVector& displacement,
                const std::vector<std::vector<double>>& reactions, const std::vector<double>& multipliers,
                std::optional<double> time,
                const std::vector<std::shared_ptr<const std::vector<double>>>* loads) {
  std::vector<std::shared_ptr<const std::vector<double>>> own;
  for (int i = 0; i < system.size() && loads == nullptr; ++i)
    own.push_back(system.subdomain(i).load);
  Sums sums(scene, contact);
  addGivenForces(comm, scene, owned, displacement, time.value_or(scene.timeline.ends().front()), sums);
  addLoads(scene, loads != nullptr ? *loads : own, sums);
  addReactions(scene, owned, system, displacement, reactions, sums);
  addSprings(scene, owned, displacement, sums);
  addRows(scene, contact, multipliers, sums);
  return sums.total(comm);
}

std::string forcesText(const Forces& forces) {
  constexpr std::size_t most = 20;
  if (forces.effects.empty())
    return "";
  std::size_t width = 0;
  const std::size_t shown = std::min(most, forces.effects.size());
  for (std::size_t k = 0; k < shown; ++k)
    width = std::max(width, forces.effects[k].path.size());
  std::ostringstream text;
  text << "Forces on the bodies (contacts and ties: of the second body on the first)\n"
       << "  " << std::left << std::setw(static_cast<int>(width)) << "" << std::right;
  for (const char* name : {"x", "y", "z", "moment x", "moment y", "moment z"})
    text << std::setw(12) << name;
  if (std::any_of(forces.effects.begin(), forces.effects.begin() + static_cast<std::ptrdiff_t>(shown),
                  [](const Forces::Of& effect) { return effect.error.has_value(); }))
    text << std::setw(12) << "est. error";
  for (std::size_t k = 0; k < shown; ++k) {
    const Forces::Of& effect = forces.effects[k];
    const auto tell = [&](const std::string& name, const std::vector<const Point*>& vectors) {
      text << "\n  " << std::left << std::setw(static_cast<int>(width)) << name << std::right;
      for (const Point* vector : vectors)
        for (double component : *vector)
          text << std::setw(12) << scientific(component, 3);
    };
    tell(effect.path, {&effect.resultant.force, &effect.resultant.moment});
    if (effect.error)
      text << std::setw(12) << scientific(*effect.error, 1);
    if (effect.hasFriction) {
      tell("  normal", {&effect.normal});
      tell("  tangential", {&effect.tangential});
    }
  }
  if (forces.effects.size() > shown)
    text << "\n  and " << forces.effects.size() - shown << " more, see summary.json";
  return text.str();
}

} // namespace Harmos::run
