// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SolutionComparison.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_CellIntegrator.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

namespace Harmos::run {
namespace {

using fem::CellType;
using fem::Point;

fem::EnergyDensity energyOf(const scene::Scene& scene, int body) {
  return scene.physics == scene::Physics::Membrane
             ? fem::membraneEnergy()
             : fem::elasticEnergy(scene::elasticityOf(scene, scene.bodies[static_cast<std::size_t>(body)]));
}

// The sums of all subdomains of this rank, each compared with a field of its own; then of all ranks.
SolutionNorms integrated(const Teuchos::Comm<int>& comm, const FinishedRun& run,
                         const std::function<const std::vector<double>&(std::size_t)>& displacement,
                         const std::function<fem::FieldSample(std::size_t)>& other) {
  std::vector<double> sums(2, 0.0);
  agree(comm, [&] {
    for (std::size_t i = 0; i < run.solution.owned.size(); ++i) {
      const scene::OwnedSubdomain& item = run.solution.owned[i];
      const fem::SquaredErrors errors = fem::squaredErrors(
          *item.mesh.mesh, item.mesh.anchor, fem::errorDegree(item.mesh.mesh->cellType),
          run.scene.components(), displacement(i), energyOf(run.scene, item.body), other(i));
      sums[0] += errors.energy;
      sums[1] += errors.l2;
    }
  });
  globalSum(comm, sums);
  SolutionNorms norms;
  norms.energy = std::sqrt(std::max(0.0, sums[0]));
  norms.displacement = std::sqrt(sums[1]);
  return norms;
}

fem::FieldValue nothing(int, int, const Point&) {
  return {};
}

double closedArea(const FinishedRun& run) {
  double area = 0.0;
  for (std::size_t k = 0; k < run.points.size(); ++k)
    area += run.states[k].closed ? run.points[k].area : 0.0;
  return area;
}

double stickArea(const FinishedRun& run) {
  double area = 0.0;
  for (std::size_t k = 0; k < run.points.size(); ++k)
    area += run.states[k].friction == Friction::Sticks ? run.points[k].area : 0.0;
  return area;
}

// Of the points whose slip counts: where nothing bears friction bodies move along each other as they please.
double areaOfFriction(const FinishedRun& run, std::size_t point) {
  return run.states[point].friction == Friction::None ? 0.0 : run.points[point].area;
}

double squareOf(const Point& a) {
  return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

Point between(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

// Locators of a body on every rank, one for each type of cells. All have all nodes: rank by rank, subdomain
// by subdomain. @note Collective.
std::vector<fem::PointLocator> locatorsOf(const Teuchos::Comm<int>& comm,
                                          const std::vector<scene::OwnedSubdomain>& owned, int body) {
  std::vector<Point> nodes;
  std::map<int, std::vector<int>> cells; // by type
  for (const scene::OwnedSubdomain& item : owned) {
    if (item.body != body)
      continue;
    const auto first = static_cast<int>(nodes.size());
    for (int node = 0; node < item.mesh.mesh->numberOfNodes(); ++node)
      nodes.push_back(item.mesh.position(node));
    std::vector<int>& ofType = cells[static_cast<int>(item.mesh.mesh->cellType)];
    for (int node : item.mesh.mesh->cells)
      ofType.push_back(first + node);
  }
  const auto before = static_cast<int>(exclusiveScan(comm, static_cast<long long>(nodes.size())));
  std::vector<int> types;
  for (auto& [type, ofType] : cells) {
    types.push_back(type);
    for (int& node : ofType)
      node += before;
  }
  nodes = gatherAll(comm, nodes);
  types = gatherAll(comm, types);
  std::vector<fem::PointLocator> locators;
  for (int type : std::set<int>(types.begin(), types.end()))
    locators.emplace_back(static_cast<CellType>(type), nodes, gatherAll(comm, cells[type]));
  agree(comm, [&] {
    if (locators.empty())
      throw InputError("a body without cells cannot be compared");
  });
  return locators;
}

std::vector<double> gatherValues(const Teuchos::Comm<int>& comm, const Solution& solution, int body) {
  std::vector<double> mine;
  for (std::size_t i = 0; i < solution.owned.size(); ++i)
    if (solution.owned[i].body == body)
      mine.insert(mine.end(), solution.displacement[i].begin(), solution.displacement[i].end());
  return gatherAll(comm, mine);
}

// A facet whose nodes are contact points all of them.
struct ContactFacet {
  int type;
  std::array<Point, 9> nodes;
  std::array<int, 9> points;
};

// Boundary sides between the nodes that carry contact points, each once.
std::vector<ContactFacet> contactFacets(const FinishedRun& run) {
  // A node of two contacts shows the one that bears.
  std::unordered_map<long long, int> pointOf;
  for (std::size_t k = 0; k < run.points.size(); ++k) {
    const auto [at, isNew] = pointOf.emplace(run.points[k].node, static_cast<int>(k));
    if (!isNew && run.states[k].force > run.states[static_cast<std::size_t>(at->second)].force)
      at->second = static_cast<int>(k);
  }
  std::vector<ContactFacet> facets;
  for (const scene::OwnedSubdomain& item : run.solution.owned) {
    const fem::Mesh& mesh = *item.mesh.mesh;
    std::set<std::pair<int, int>> taken;
    for (const auto& [name, sides] : item.mesh.sides)
      for (const fem::Side& side : sides) {
        const std::vector<int> nodes = mesh.nodesOf(side);
        ContactFacet facet{static_cast<int>(mesh.typeOf(side)), {}, {}};
        bool all = true;
        for (std::size_t k = 0; all && k < nodes.size(); ++k) {
          const auto found = pointOf.find(item.mesh.number(nodes[k]));
          all = found != pointOf.end();
          if (all) {
            facet.nodes[k] = item.mesh.position(nodes[k]);
            facet.points[k] = found->second;
          }
        }
        if (all && taken.insert({side.cell, side.side}).second)
          facets.push_back(facet);
      }
  }
  return facets;
}

} // namespace

SolutionNorms normsOf(const Teuchos::Comm<int>& comm, const FinishedRun& run) {
  SolutionNorms norms = integrated(
      comm, run, [&](std::size_t i) -> const std::vector<double>& { return run.solution.displacement[i]; },
      [](std::size_t) { return nothing; });
  double sum = 0.0, slips = 0.0;
  for (std::size_t k = 0; k < run.points.size(); ++k) {
    sum += run.points[k].area * std::pow(run.states[k].pressure, 2);
    slips += areaOfFriction(run, k) * squareOf(run.states[k].slip);
  }
  norms.pressure = std::sqrt(sum);
  norms.contactArea = closedArea(run);
  norms.slip = std::sqrt(slips);
  norms.stickArea = stickArea(run);
  return norms;
}

SolutionNorms differenceOnSameMesh(const Teuchos::Comm<int>& comm, const FinishedRun& first,
                                   const FinishedRun& second) {
  feti::TornVector difference = first.solution.displacement;
  agree(comm, [&] {
    const feti::TornVector& other = second.solution.displacement;
    HARMOS_REQUIRE(other.size() == difference.size() && first.points.size() == second.points.size(),
                   "two runs are not on the same meshes");
    for (std::size_t i = 0; i < other.size(); ++i) {
      HARMOS_REQUIRE(other[i].size() == difference[i].size(), "two runs are not on the same meshes");
      for (std::size_t k = 0; k < other[i].size(); ++k)
        difference[i][k] -= other[i][k];
    }
  });
  SolutionNorms norms = integrated(
      comm, first, [&](std::size_t i) -> const std::vector<double>& { return difference[i]; },
      [](std::size_t) { return nothing; });
  double sum = 0.0, slips = 0.0;
  for (std::size_t k = 0; k < first.points.size(); ++k) {
    sum += first.points[k].area * std::pow(first.states[k].pressure - second.states[k].pressure, 2);
    slips += areaOfFriction(second, k) * squareOf(between(first.states[k].slip, second.states[k].slip));
  }
  norms.pressure = std::sqrt(sum);
  norms.contactArea = std::abs(closedArea(first) - closedArea(second));
  norms.slip = std::sqrt(slips);
  norms.stickArea = std::abs(stickArea(first) - stickArea(second));
  return norms;
}

SolutionComparison::SolutionComparison(const Teuchos::Comm<int>& comm, const FinishedRun& reference,
                                       const FinishedRun& other)
    : comm_(comm), reference_(reference) {
  agree(comm, [&] {
    if (reference.scene.bodies.size() != other.scene.bodies.size() ||
        reference.scene.physics != other.scene.physics)
      throw InputError("scenes cannot be compared unless they have the same bodies and physics (bodies: " +
                       std::to_string(other.scene.bodies.size()) + " here, " +
                       std::to_string(reference.scene.bodies.size()) + " in the reference)");
  });
  for (std::size_t b = 0; b < reference.scene.bodies.size(); ++b)
    bodies_.push_back(locatorsOf(comm, other.solution.owned, static_cast<int>(b)));
  agree(comm, [&] {
    for (const scene::OwnedSubdomain& item : reference.solution.owned) {
      const fem::Mesh& mesh = *item.mesh.mesh;
      const std::vector<fem::PointLocator>& locators = bodies_[static_cast<std::size_t>(item.body)];
      const fem::ReferenceElement element(mesh.cellType, fem::errorDegree(mesh.cellType));
      fem::CellIntegrator cell(mesh, element);
      std::vector<Place> places;
      std::vector<int> hints(locators.size(), -1);
      for (int c = 0; c < mesh.numberOfCells(); ++c) {
        cell.turnTo(c);
        for (int q = 0; q < cell.points(); ++q) {
          Point x = cell.position(q);
          for (std::size_t d = 0; d < 3; ++d)
            x[d] += item.mesh.anchor[d];
          Place best{};
          double least = std::numeric_limits<double>::infinity();
          for (std::size_t k = 0; k < locators.size(); ++k) {
            const fem::PointLocator::Place place = locators[k].nearest(x, hints[k]);
            hints[k] = place.cell;
            if (place.distance < least)
              best = {k, place.cell, place.reference};
            least = std::min(least, place.distance);
          }
          places.push_back(best);
        }
      }
      places_.push_back(std::move(places));
    }
  });
  locateSurface(other);
}

void SolutionComparison::locateSurface(const FinishedRun& other) {
  std::map<int, std::vector<ContactFacet>> byType;
  for (const ContactFacet& facet : gatherAll(comm_, contactFacets(other)))
    byType[facet.type].push_back(facet);
  for (const auto& [type, facets] : byType) {
    const auto count = static_cast<std::size_t>(fem::shapeOf(static_cast<CellType>(type)).nodes);
    std::vector<Point> nodes;
    std::vector<int> cells, pointOfNode;
    for (const ContactFacet& facet : facets)
      for (std::size_t k = 0; k < count; ++k) {
        cells.push_back(static_cast<int>(nodes.size()));
        nodes.push_back(facet.nodes[k]);
        pointOfNode.push_back(facet.points[k]);
      }
    surfaces_.push_back({fem::PointLocator(static_cast<CellType>(type), std::move(nodes), std::move(cells)),
                         std::move(pointOfNode)});
  }
  agree(comm_, [&] {
    for (const contact::ContactPoint& point : reference_.points) {
      SurfacePlace best;
      best.place.distance = std::numeric_limits<double>::infinity();
      for (const Surface& surface : surfaces_) {
        const fem::PointLocator::Place place = surface.locator.nearest(point.position);
        if (place.distance < best.place.distance)
          best = {&surface.locator, &surface.pointOfNode, place};
      }
      surfacePlaces_.push_back(best);
    }
  });
}

std::vector<Point>
SolutionComparison::onSurface(const FinishedRun& run, int components,
                              const std::function<Point(const ContactState&)>& valueOf) const {
  std::map<const std::vector<int>*, std::vector<double>> nodal;
  for (const Surface& surface : surfaces_)
    for (int point : surface.pointOfNode) {
      const Point value = valueOf(run.states[static_cast<std::size_t>(point)]);
      nodal[&surface.pointOfNode].insert(nodal[&surface.pointOfNode].end(), value.begin(),
                                         value.begin() + components);
    }
  std::vector<Point> result;
  for (const SurfacePlace& at : surfacePlaces_)
    result.push_back(at.surface == nullptr ? Point{}
                                           : at.surface->value(at.place, nodal[at.pointOfNode], components));
  return result;
}

SolutionNorms SolutionComparison::difference(const FinishedRun& run) const {
  const int components = reference_.scene.components();
  std::vector<std::vector<double>> values;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    values.push_back(gatherValues(comm_, run.solution, static_cast<int>(b)));
  agree(comm_, [&] {
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      HARMOS_REQUIRE(values[b].size() ==
                         bodies_[b].front().numberOfNodes() * static_cast<std::size_t>(components),
                     "a run is not on the meshes that were located");
    for (const Surface& surface : surfaces_)
      for (int point : surface.pointOfNode)
        HARMOS_REQUIRE(static_cast<std::size_t>(point) < run.states.size(),
                       "a run has not the contact points that were located");
  });
  SolutionNorms norms = integrated(
      comm_, reference_,
      [&](std::size_t i) -> const std::vector<double>& { return reference_.solution.displacement[i]; },
      [&](std::size_t i) {
        const auto body = static_cast<std::size_t>(reference_.solution.owned[i].body);
        const std::vector<Place>& places = places_[i];
        std::size_t next = 0; // cells and points come in the order in which they were located
        return [&, body, next](int, int, const Point&) mutable {
          const Place& place = places[next++];
          return bodies_[body][place.locator].valueAndGradient({place.cell, place.reference, 0.0},
                                                               values[body], components);
        };
      });
  const std::vector<Point> pressures = onSurface(run, 1, [](const ContactState& state) {
    return Point{state.pressure, 0.0, 0.0};
  });
  const std::vector<Point> slips = onSurface(run, 3, [](const ContactState& state) { return state.slip; });
  double sum = 0.0, slipSum = 0.0;
  for (std::size_t k = 0; k < reference_.points.size(); ++k) {
    const ContactState& state = reference_.states[k];
    sum += reference_.points[k].area * std::pow(pressures[k][0] - state.pressure, 2);
    slipSum += areaOfFriction(reference_, k) * squareOf(between(slips[k], state.slip));
  }
  norms.pressure = std::sqrt(sum);
  norms.contactArea = std::abs(closedArea(run) - closedArea(reference_));
  norms.slip = std::sqrt(slipSum);
  norms.stickArea = std::abs(stickArea(run) - stickArea(reference_));
  return norms;
}

} // namespace Harmos::run
