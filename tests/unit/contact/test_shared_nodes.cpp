// SPDX-License-Identifier: BSD-3-Clause

/// Mortar coupling where some nodes of the first surface have no multiplier: a constant pressure is passed on
/// exactly all the same, and linear displacements that are equal on both sides are seen as equal.

#include "Harmos_ContactTestSupport.hpp"
#include "Harmos_FacetMultipliers.hpp"

#include <gtest/gtest.h>

namespace test_shared_nodes {

using namespace Harmos;
using namespace Harmos::contact;
using fem::CellType;
using fem::Point;

namespace {

struct Pair {
  Surface lower, upper;
};

Pair pairOf(CellType lower, CellType upper, const std::array<int, 3>& lowerElements,
            const std::array<int, 3>& upperElements) {
  const bool isSpace = fem::shapeOf(lower).dimension == 3;
  const Point above = isSpace ? Point{0, 0, 1} : Point{0, 1, 0};
  const fem::StructuredBlock one = block(lower, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, lowerElements);
  const fem::StructuredBlock other =
      block(upper, above, {1, 1, 1}, {1, 1, 1}, upperElements, one.numberOfNodes());
  return {surfaceOf(one, "top"), surfaceOf(other, "bottom")};
}

// Nodal forces of the pressure one by all points, on the nodes of a surface.
std::vector<double> forcesOn(const Surface& surface, const std::vector<ContactPoint>& points) {
  std::map<long long, double> force;
  for (const ContactPoint& point : points)
    for (const ContactPoint::Term& term : point.terms)
      force[term.node] += point.area * term.weight;
  std::vector<double> result;
  for (const long long number : surface.numbers)
    result.push_back(force[number]);
  return result;
}

void expectConstantPressure(const Surface& first, const Surface& second,
                            const std::vector<ContactPoint>& points, const std::string& what) {
  const std::vector<double> own = forcesOn(first, points), others = forcesOn(second, points);
  for (std::size_t i = 0; i < own.size(); ++i)
    EXPECT_NEAR(own[i], first.areas[i], rounding) << what << ", first, " << placeText(first.positions[i]);
  for (std::size_t k = 0; k < others.size(); ++k)
    EXPECT_NEAR(others[k], -second.areas[k], rounding)
        << what << ", second, " << placeText(second.positions[k]);
  for (const std::array<double, 3>& slope : {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}})
    EXPECT_LT(rowError(points, first, second, [&](const Point& x) { return 2.0 + dot(slope, x); }), rounding)
        << what;
}

const std::vector<CellType> inPlane = {CellType::Triangle3, CellType::Triangle6, CellType::Quadrilateral4,
                                       CellType::Quadrilateral9};
const std::vector<CellType> inSpace = {CellType::Tetrahedron4, CellType::Tetrahedron10, CellType::Hexahedron8,
                                       CellType::Hexahedron27};

using Where = std::function<bool(const Point&)>;

MortarOptions withoutNodes(const Surface& first, const Where& where) {
  MortarOptions options;
  for (std::size_t i = 0; i < first.numbers.size(); ++i)
    if (where(first.positions[i]))
      options.without.push_back(first.numbers[i]);
  return options;
}

} // namespace

TEST(SharedNodes, constant_pressure_passes) {
  const std::vector<std::pair<std::string, Where>> places = {
      {"one end", [](const Point& x) { return x[0] < 1e-9; }},
      {"both ends", [](const Point& x) { return x[0] < 1e-9 || x[0] > 1.0 - 1e-9; }},
      {"a corner", [](const Point& x) { return x[0] < 1e-9 || x[1] < 1e-9; }},
      {"a frame", [](const Point& x) { return std::abs(x[0] - 0.5) + std::abs(x[1] - 0.5) > 0.49; }},
      {"the rim",
       [](const Point& x) {
         return std::abs(x[0] - 0.5) > 0.499 || (x[2] > 0.9 && std::abs(x[1] - 0.5) > 0.499);
       }},
      {"inside", [](const Point& x) { return std::abs(x[0] - 0.5) < 0.01; }}};
  for (const auto& types : {inPlane, inSpace})
    for (CellType lower : types)
      for (CellType upper : types)
        for (const auto& elements :
             {std::array<int, 3>{4, 2, 2}, std::array<int, 3>{3, 5, 2}, std::array<int, 3>{2, 2, 2}})
          for (const auto& [name, where] : places) {
            if (fem::shapeOf(lower).dimension == 2 && (name == "a corner" || name == "a frame"))
              continue;
            const Pair pair = pairOf(lower, upper, elements, {4, 3, 2});
            const MortarOptions options = withoutNodes(pair.lower, where);
            const std::vector<ContactPoint> points = mortarPoints(pair.lower, pair.upper, options);
            const std::string what =
                fem::shapeOf(lower).name + " on " + fem::shapeOf(upper).name + ", " + name;
            for (const ContactPoint& point : points)
              EXPECT_FALSE(std::binary_search(options.without.begin(), options.without.end(), point.node))
                  << what;
            EXPECT_EQ(points.size() + options.without.size(), pair.lower.numbers.size()) << what;
            expectConstantPressure(pair.lower, pair.upper, points, what);
          }
}

} // namespace test_shared_nodes
