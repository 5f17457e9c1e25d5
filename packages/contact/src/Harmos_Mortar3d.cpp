// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_MortarSamples.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <algorithm>
#include <limits>

namespace Harmos::contact {
namespace {

using fem::Point;
using Place = std::array<double, 2>; // in the auxiliary plane
using Polygon = std::vector<Place>;  // counter-clockwise

// The plane in which facets are clipped: through the centre of a facet of the first surface.
struct Plane {
  Point origin, normal, first, second;

  explicit Plane(const Facet::State& centre)
      : origin(centre.position),
        normal(scaled(1.0 / norm(centre.areaNormal), centre.areaNormal)),
        first(scaled(1.0 / norm(centre.tangents[0]), centre.tangents[0])),
        second(cross(normal, first)) {}

  Place components(const Point& vector) const { return {dot(vector, first), dot(vector, second)}; }
  Place project(const Point& x) const { return components(difference(x, origin)); }
};

double turn(const Place& a, const Place& b, const Place& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double area(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t k = 2; k < polygon.size(); ++k)
    twice += turn(polygon[0], polygon[k - 1], polygon[k]);
  return 0.5 * twice;
}

Polygon cornersOf(const Facet& facet, const Plane& plane) {
  Polygon polygon;
  for (std::size_t k = 0; k < facet.corners(); ++k)
    polygon.push_back(plane.project(facet.position(k)));
  return polygon;
}

// The part of a polygon inside of another, convex one (Sutherland & Hodgman 1974).
Polygon clipped(Polygon polygon, const Polygon& by) {
  for (std::size_t k = 0; k < by.size() && !polygon.empty(); ++k) {
    const Place &a = by[k], &b = by[(k + 1) % by.size()];
    Polygon inside;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Place &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
      const double fromTurn = turn(a, b, from), toTurn = turn(a, b, to);
      if (fromTurn >= 0.0)
        inside.push_back(from);
      if ((fromTurn > 0.0 && toTurn < 0.0) || (fromTurn < 0.0 && toTurn > 0.0)) {
        const double t = fromTurn / (fromTurn - toTurn);
        inside.push_back({from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])});
      }
    }
    polygon = inside;
  }
  return polygon;
}

// Place on the reference facet of the point that is projected to p, by Newton's method: one step for straight
// triangles and parallelograms.
FacetPlace placeOf(const Surface& surface, const Facet& facet, const Plane& plane, const Place& p,
                   double size) {
  FacetPlace place = facetCentre(surface.facetType);
  double error = 0.0;
  // Coordinates have rounding errors of ε times their size, whatever that of the facet.
  const fem::Point corner = facet.position(0);
  const double rounding = 1e2 * std::numeric_limits<double>::epsilon() *
                          std::max({std::abs(corner[0]), std::abs(corner[1]), std::abs(corner[2])});
  for (int k = 0; k < 30; ++k) {
    const Facet::State state = facet.at(place);
    const Place at = plane.project(state.position);
    const Place residual = {p[0] - at[0], p[1] - at[1]};
    error = std::hypot(residual[0], residual[1]);
    const Place a = plane.components(state.tangents[0]), b = plane.components(state.tangents[1]);
    const double determinant = a[0] * b[1] - a[1] * b[0];
    const FacetPlace step = {(residual[0] * b[1] - residual[1] * b[0]) / determinant,
                             (a[0] * residual[1] - a[1] * residual[0]) / determinant};
    if (!std::isfinite(step[0]) || !std::isfinite(step[1]))
      break;
    place = {place[0] + step[0], place[1] + step[1]};
    // Convergence is quadratic: after a step this small nothing but rounding is left.
    if (std::hypot(step[0], step[1]) < 1e-9)
      return place;
  }
  // Negated, so that it holds for a residual that is not a number.
  if (!(error < std::max(1e-9 * size, rounding)))
    throw InputError("surface " + surface.name + ": the facet at " + placeText(facet.position(0)) +
                     " is too distorted or too steep relative to its counterpart: the projection of a point "
                     "failed; repair the mesh there or choose a smaller part");
  return place;
}

// Quadrature on a polygon, cut into triangles from its first corner.
std::vector<std::pair<Place, double>> quadrature(const Polygon& polygon, const fem::Quadrature& rule) {
  std::vector<std::pair<Place, double>> points;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Place &a = polygon[0], &b = polygon[k - 1], &c = polygon[k];
    const double measure = turn(a, b, c);
    if (!(measure > 0.0))
      continue;
    for (std::size_t q = 0; q < rule.points.size(); ++q) {
      const double x = rule.points[q][0], y = rule.points[q][1];
      points.push_back(
          {{a[0] + x * (b[0] - a[0]) + y * (c[0] - a[0]), a[1] + x * (b[1] - a[1]) + y * (c[1] - a[1])},
           measure * rule.weights[q]});
    }
  }
  return points;
}

// Of products of two basis functions: the sum of the exponents counts on triangles.
int degree(fem::CellType first, fem::CellType second) {
  const auto total = [](fem::CellType type) {
    const fem::CellShape& shape = fem::shapeOf(type);
    return shape.isSimplex ? shape.order : 2 * shape.order;
  };
  const int sum = total(first) + std::max(total(first), total(second));
  return sum + sum % 2; // even ones have positive weights
}

} // namespace

std::vector<MortarSample> spaceSamples(const Surface& first, int f, const Surface& second,
                                       const std::vector<int>& candidates, double reach) {
  const Facet facet(first, f);
  const Plane plane(facet.at(facetCentre(first.facetType)));
  const Polygon own = cornersOf(facet, plane);
  const double whole = area(own), size = std::sqrt(std::abs(whole));
  const fem::Quadrature rule =
      fem::quadratureOn(fem::CellType::Triangle3, degree(first.facetType, second.facetType));
  std::vector<MortarSample> samples;
  for (int c : candidates) {
    const Facet opposite(second, c);
    Polygon other = cornersOf(opposite, plane);
    std::reverse(other.begin(), other.end()); // facing surfaces have opposite orientations
    const Point away = opposite.at(facetCentre(second.facetType)).areaNormal;
    if (!(dot(away, plane.normal) < -leastFacing * norm(away)) || !(area(other) > 0.0))
      continue;
    const Polygon common = clipped(own, other);
    if (common.size() < 3 || area(common) < 1e-14 * whole)
      continue;
    std::vector<MortarSample> here;
    for (const auto& [p, weight] : quadrature(common, rule)) {
      MortarSample sample;
      sample.place = placeOf(first, facet, plane, p, size);
      sample.opposite = c;
      sample.oppositePlace = placeOf(second, opposite, plane, p, size);
      const Facet::State state = facet.at(sample.place);
      // The measure of the facet, not of its projection.
      sample.weight = weight * norm(state.areaNormal) / std::abs(dot(state.areaNormal, plane.normal));
      sample.gap = dot(difference(opposite.at(sample.oppositePlace).position, state.position),
                       facet.smoothNormal(state.basis));
      here.push_back(sample);
    }
    const auto isNear = [&](const MortarSample& sample) { return std::abs(sample.gap) <= reach; };
    if (std::any_of(here.begin(), here.end(), isNear))
      samples.insert(samples.end(), here.begin(), here.end());
  }
  return samples;
}

} // namespace Harmos::contact
