// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_PointAlgebra.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace Harmos::contact {
namespace {

using fem::Point;

// Rounding errors of a position grow with its distance from the origin, which is why that counts too.
double magnitude(const Surface& surface) {
  double result = 1e-100;
  for (std::size_t d = 0; d < 3; ++d) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const Point& x : surface.positions) {
      least = std::min(least, x[d]);
      most = std::max(most, x[d]);
    }
    if (least <= most)
      result = std::max({result, most - least, std::abs(least), std::abs(most)});
  }
  return result;
}

// Cells of twice the tolerance; a partner lies in the same or in a neighbouring cell.
using Cell = std::array<long long, 3>;
Cell cellOf(const Point& x, double size) {
  return {std::llround(x[0] / size), std::llround(x[1] / size), std::llround(x[2] / size)};
}

// Places on the other surface; its number of nodes where there is no partner.
struct Matching {
  std::vector<std::size_t> partners; // of each node of the first surface
  std::vector<bool> taken;           // each node of the second surface
};

Matching match(const Surface& first, const Surface& second, double tolerance) {
  const double size = 2.0 * tolerance * std::max(magnitude(first), magnitude(second));
  std::map<Cell, std::vector<std::size_t>> cells;
  for (std::size_t k = 0; k < second.positions.size(); ++k)
    cells[cellOf(second.positions[k], size)].push_back(k);
  Matching matching;
  matching.taken.assign(second.positions.size(), false);
  for (const Point& x : first.positions) {
    const Cell centre = cellOf(x, size);
    std::size_t partner = second.positions.size();
    for (long long dx = -1; dx <= 1; ++dx)
      for (long long dy = -1; dy <= 1; ++dy)
        for (long long dz = -1; dz <= 1; ++dz) {
          const auto found = cells.find({centre[0] + dx, centre[1] + dy, centre[2] + dz});
          if (found == cells.end())
            continue;
          for (std::size_t k : found->second)
            if (!matching.taken[k] && norm(difference(x, second.positions[k])) <= 0.5 * size)
              partner = k;
        }
    matching.partners.push_back(partner);
    if (partner < second.positions.size())
      matching.taken[partner] = true;
  }
  return matching;
}

[[noreturn]] void throwUnmatched(const Surface& first, const Surface& second, bool isFirst, std::size_t k) {
  const Surface& surface = isFirst ? first : second;
  const std::string number = std::to_string(surface.numbers[k]);
  throw InputError(first.name + " and " + second.name + ": the surfaces do not match: node " + number +
                       " at " + placeText(surface.positions[k]) + " of the " +
                       (isFirst ? "first surface has no partner on the second one"
                                : "second surface has no partner on the first one") +
                       "; mesh both alike, or couple them by mortar",
                   {{"node", number}});
}

} // namespace

bool nodesMatch(const Surface& first, const Surface& second, double tolerance) {
  if (first.numberOfNodes() != second.numberOfNodes())
    return false;
  const Matching matching = match(first, second, tolerance);
  return std::find(matching.taken.begin(), matching.taken.end(), false) == matching.taken.end();
}

std::vector<ContactPoint> matchNodes(const Surface& first, const Surface& second, double tolerance) {
  const Matching matching = match(first, second, tolerance);
  const std::vector<double> areas = tributaryAreas(first);
  std::vector<ContactPoint> points;
  for (std::size_t i = 0; i < first.numbers.size(); ++i) {
    const std::size_t k = matching.partners[i];
    if (k == second.numbers.size())
      throwUnmatched(first, second, true, i);
    ContactPoint point;
    point.node = first.numbers[i];
    point.position = first.positions[i];
    point.terms = {{first.numbers[i], 1.0}, {second.numbers[k], -1.0}};
    std::sort(point.terms.begin(), point.terms.end(),
              [](const ContactPoint::Term& a, const ContactPoint::Term& b) { return a.node < b.node; });
    const Point normal = difference(first.normals[i], second.normals[k]);
    const double length = norm(normal); // 2 where the surfaces face each other
    if (!(length > 1e-8))
      throw InputError(first.name + " and " + second.name + ": at node " + std::to_string(point.node) +
                           " at " + placeText(first.positions[i]) +
                           " both surfaces look the same way; contact needs surfaces that face each other",
                       {{"node", std::to_string(point.node)}});
    point.normal = scaled(1.0 / length, normal);
    point.gap = dot(difference(second.positions[k], first.positions[i]), point.normal);
    point.area = areas[i];
    points.push_back(point);
  }
  const auto left = std::find(matching.taken.begin(), matching.taken.end(), false);
  if (left != matching.taken.end())
    throwUnmatched(first, second, false, static_cast<std::size_t>(left - matching.taken.begin()));
  return points;
}

} // namespace Harmos::contact
