// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Decomposition.hpp"
#include "Harmos_FacingSides.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_facing_sides {

using namespace Harmos;
using fem::CellType;
using fem::Point;

namespace {

constexpr double gap = 0.05;

void addBody(scene::Scene& scene, const std::string& name, CellType type, const Point& origin,
             std::array<int, 3> elements, std::array<int, 3> subdomains,
             std::array<double, 3> size = {1.0, 1.0, 1.0}) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.origin = origin;
  options.elements = elements;
  options.subdomains = subdomains;
  options.size = size;
  options.firstNode = static_cast<long long>(scene.bodies.size()) * 100000;
  const auto block = std::make_shared<const fem::StructuredBlock>(options);
  scene::Body body;
  body.name = name;
  body.subdomains = block->numberOfSubdomains();
  body.subdomain = [block](int k) { return block->subdomain(k); };
  body.materials = {fem::Material()};
  scene.bodies.push_back(body);
}

// Two unit blocks on each other, moved aside by 0.27, and one far away. Sides of 1/8 and 1/5 of a length.
scene::Scene stack(CellType type) {
  const bool isSpace = fem::shapeOf(type).dimension == 3;
  scene::Scene scene;
  scene.physics = isSpace ? scene::Physics::Solid : scene::Physics::PlaneStrain;
  const auto above = [&](double x, double height) {
    return isSpace ? Point{x, 0.0, height} : Point{x, height, 0.0};
  };
  addBody(scene, "lower", type, above(0.0, 0.0), {4, isSpace ? 1 : 2, 2}, {2, 2, isSpace ? 2 : 1});
  addBody(scene, "far", type, above(3.0, 0.0), {2, 2, 2}, {1, 1, 1});
  addBody(scene, "upper", type, above(0.27, 1.0 + gap), {5, 3, 3}, {1, 1, 1});
  return scene;
}

using Found = std::map<std::pair<int, int>, std::pair<long long, long long>>;

// Of lines, or of quadrilaterals.
Found pairsOf(const scene::Scene& scene, double distance) {
  Found found;
  for (const auto& [pair, counts] :
       scene::facingPairs(*testComm(), scene.bodies.size(), scene::decompose(*testComm(), scene), distance)) {
    EXPECT_LE(counts.first.size(), 1u);
    EXPECT_LE(counts.second.size(), 1u);
    found[pair] = {counts.first.empty() ? 0 : counts.first.begin()->second,
                   counts.second.empty() ? 0 : counts.second.begin()->second};
  }
  return found;
}

} // namespace

// In the plane sides of the lower body from 1/4 to 1 reach below one of the upper body, whose first side is
// at 0.27, and its last but one ends at 1.07.
TEST(FacingSides, pairs_and_their_sides_are_those_by_hand) {
  const std::pair<int, int> pair = {0, 2};
  EXPECT_EQ(pairsOf(stack(CellType::Quadrilateral4), 0.0), (Found{{pair, {6, 4}}}));
  EXPECT_EQ(pairsOf(stack(CellType::Triangle6), 1.01 * gap), (Found{{pair, {6, 4}}}));
  const Found space = pairsOf(stack(CellType::Hexahedron8), 0.0);
  ASSERT_EQ(space.size(), 1u);
  EXPECT_EQ(space.begin()->first, pair);
  EXPECT_GE(space.begin()->second.first, 12);
  EXPECT_GE(space.begin()->second.second, 12);
}

TEST(FacingSides, what_is_further_away_does_not_face) {
  EXPECT_TRUE(pairsOf(stack(CellType::Quadrilateral4), 0.99 * gap).empty());
  // The walls of "lower" and "far" look at each other over a length of 2.
  EXPECT_EQ(pairsOf(stack(CellType::Quadrilateral4), 2.01).count({0, 1}), 1u);
}

// Sheets of 1 × thickness, one on the other with gaps; the far sides of two look at each other through both.
scene::Scene sheets(int count, double thickness, double apart) {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  for (int k = 0; k < count; ++k)
    addBody(scene, "sheet" + std::to_string(k), CellType::Quadrilateral4, {0.0, k * (thickness + apart), 0.0},
            {5 + k, 1, 1}, {2, 1, 1}, {1.0, thickness, 1.0});
  return scene;
}

TEST(FacingSides, far_sides_of_thin_bodies_do_not_face) {
  for (double apart : {0.0, 0.001, -0.004})
    for (double distance : {0.0, 0.5, 10.0}) {
      SCOPED_TRACE(std::to_string(apart) + " " + std::to_string(distance));
      EXPECT_EQ(pairsOf(sheets(2, 0.01, apart), distance), (Found{{{0, 1}, {10, 12}}}));
    }
}

TEST(FacingSides, a_body_between_hides_what_is_behind) {
  for (double distance : {0.0, 0.5})
    EXPECT_EQ(pairsOf(sheets(3, 0.01, 0.001), distance), (Found{{{0, 1}, {10, 12}}, {{1, 2}, {12, 14}}}));
}

// A side that touches with its middle alone: half a circle of four arcs above a plane.
TEST(FacingSides, nodes_in_the_middle_count) {
  scene::Scene scene = sheets(1, 0.01, 0.0);
  constexpr double top = 0.01, radius = 0.4, sagitta = radius * 0.0096; // over 16 degrees at the least
  fem::StructuredBlock::Options options;
  options.cellType = CellType::Quadrilateral9;
  options.elements = {9, 2, 1};
  options.firstNode = 500000;
  options.map = [&](const Point& x) {
    const double angle = (x[0] - 0.5) * 1.0, r = radius * (1.0 - 0.5 * x[1]);
    return Point{0.5 + r * std::sin(angle), top + radius - r * std::cos(angle), 0.0};
  };
  const auto block = std::make_shared<const fem::StructuredBlock>(options);
  scene::Body body;
  body.name = "arc";
  body.subdomains = 1;
  body.subdomain = [block](int k) { return block->subdomain(k); };
  body.materials = {fem::Material()};
  scene.bodies.push_back(body);
  // The corners of the lowest side are a sagitta of 18 degrees' half above the plane.
  const Found found = pairsOf(scene, 0.05 * sagitta);
  ASSERT_EQ(found.count({0, 1}), 1u);
  EXPECT_EQ(found.at({0, 1}).second, 1);
}

TEST(FacingSides, rules_choose_them) {
  scene::Scene scene = stack(CellType::Quadrilateral4);
  fem::BoundaryRule rule;
  rule.name = "towards upper";
  rule.bodies = {"lower"};
  rule.facing = fem::BoundaryRule::Facing{{"upper"}, 0.0};
  scene.boundaryRules = {rule};
  long long sides = 0;
  for (const scene::OwnedSubdomain& item : scene::decompose(*testComm(), scene))
    if (const auto part = item.mesh.sides.find(rule.name); part != item.mesh.sides.end())
      for (const fem::Side& side : part->second) {
        EXPECT_GT(fem::geometryOf(item.mesh, side).normal[1], 0.99);
        ++sides;
      }
  EXPECT_EQ(globalSum(*testComm(), sides), 6);
  scene.boundaryRules.front().facing->bodies = {"far"};
  const std::string text = inputErrorOf([&] { scene::decompose(*testComm(), scene); });
  EXPECT_NE(text.find("0 are facing these bodies"), std::string::npos) << text;
}

} // namespace test_facing_sides
