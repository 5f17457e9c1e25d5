// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Agreement.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Facet.hpp"
#include "Harmos_PointAlgebra.hpp"

#include <algorithm>
#include <map>

namespace Harmos::contact {
namespace {

using fem::Point;

struct Separation {
  Point normal; // towards the obstacle
  double gap;
};

Point direction(const Obstacle& obstacle, int dimension, const std::string& name) {
  Point given = obstacle.direction;
  if (dimension == 2)
    given =
        obstacle.shape == Obstacle::Shape::Cylinder ? Point{0.0, 0.0, 1.0} : Point{given[0], given[1], 0.0};
  const double length = norm(given);
  if (!(length > 0.0) || !std::isfinite(length))
    throw InputError(
        "obstacle of surface " + name + ": direction " + placeText(obstacle.direction) +
        " is a zero vector; give the outward normal of the half-space or the axis of the cylinder");
  return scaled(1.0 / length, given);
}

Separation roundSeparation(const Point& fromCentre, double radius, const Surface& surface, std::size_t i) {
  const double distance = norm(fromCentre);
  if (!(distance > 1e-12 * std::abs(radius)))
    throw InputError("obstacle of surface " + surface.name + ": node " + std::to_string(surface.numbers[i]) +
                         " at " + placeText(surface.positions[i]) +
                         " lies at its centre, where the contact direction is undefined; move the obstacle",
                     {{"node", std::to_string(surface.numbers[i])}});
  if (radius > 0.0)
    return {scaled(-1.0 / distance, fromCentre), distance - radius};
  return {scaled(1.0 / distance, fromCentre), -radius - distance};
}

// Where a constant pressure does not push at all corners (hasCarrierRows()) points are those of the
// carriers (Carriers), which are positive. That of an edge node is (u_e − s(u_a + u_b))/(1 − 2s).
void useCarriers(const Surface& surface, const std::vector<Point>& towards, const std::vector<double>& gaps,
                 std::vector<ContactPoint>& points) {
  if (!hasCarrierRows(surface))
    return;
  const Carriers carriers(surface.facetType, surface.isAxisymmetric);
  std::map<long long, ContactPoint*> pointOf;
  for (ContactPoint& point : points)
    pointOf[point.node] = &point;
  for (int f = 0; f < surface.numberOfFacets(); ++f) {
    const Facet facet(surface, f);
    for (std::size_t k = facet.corners(); k < facet.size(); ++k) {
      const auto found = pointOf.find(surface.numbers[facet.node(k)]);
      if (found == pointOf.end() || found->second->terms.size() > 1)
        continue;
      ContactPoint& point = *found->second;
      point.terms.clear();
      point.gap = 0.0;
      for (const auto& [place, weight] : carriers.coefficient(k)) {
        const std::size_t i = facet.node(place);
        point.terms.push_back({surface.numbers[i], weight});
        point.gap += weight * gaps[i] * dot(point.normal, towards[i]);
      }
      std::sort(point.terms.begin(), point.terms.end(),
                [](const ContactPoint::Term& a, const ContactPoint::Term& b) { return a.node < b.node; });
    }
  }
}

std::vector<ContactPoint> pointsOf(const Surface& surface, const Obstacle& obstacle) {
  const bool isRound = obstacle.shape != Obstacle::Shape::HalfSpace;
  if (isRound && (obstacle.radius == 0.0 || !std::isfinite(obstacle.radius)))
    throw InputError("obstacle of surface " + surface.name + ": invalid radius " +
                     std::to_string(obstacle.radius) +
                     "; give a positive radius, or a negative one for a hollow obstacle");
  const Point axis = obstacle.shape == Obstacle::Shape::Sphere
                         ? Point{}
                         : direction(obstacle, surface.dimension, surface.name);
  std::vector<ContactPoint> points;
  std::vector<Point> towards; // the obstacle, of all nodes
  std::vector<double> gaps;
  for (std::size_t i = 0; i < surface.numbers.size(); ++i) {
    Point offset = difference(surface.positions[i], obstacle.point);
    if (surface.dimension == 2)
      offset[2] = 0.0;
    Separation separation{};
    switch (obstacle.shape) {
    case Obstacle::Shape::HalfSpace:
      separation = {scaled(-1.0, axis), dot(offset, axis)};
      break;
    case Obstacle::Shape::Cylinder:
      separation =
          roundSeparation(difference(offset, scaled(dot(offset, axis), axis)), obstacle.radius, surface, i);
      break;
    case Obstacle::Shape::Sphere:
      separation = roundSeparation(offset, obstacle.radius, surface, i);
      break;
    }
    towards.push_back(separation.normal);
    gaps.push_back(separation.gap);
    if (surface.isOwnNode[i] == 0)
      continue;
    ContactPoint point;
    point.node = surface.numbers[i];
    point.position = surface.positions[i];
    point.terms = {{point.node, 1.0}};
    point.normal = separation.normal;
    point.gap = separation.gap;
    points.push_back(point);
  }
  const std::vector<double> areas = tributaryAreas(surface, towards);
  std::size_t next = 0;
  for (std::size_t i = 0; i < surface.numbers.size(); ++i)
    if (surface.isOwnNode[i] != 0)
      points[next++].area = areas[i];
  useCarriers(surface, towards, gaps, points);
  setPressures(surface, towards, points);
  return points;
}

} // namespace

std::vector<ContactPoint> obstaclePoints(const Surface& surface, const Obstacle& obstacle) {
  std::vector<ContactPoint> points;
  agree(*surface.comm, [&] { points = pointsOf(surface, obstacle); });
  return points;
}

} // namespace Harmos::contact
