// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Decomposition.hpp"
#include "Harmos_FacingSides.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

namespace test_facing_sides {

using namespace Harmos;
using fem::CellType;
using fem::Point;

namespace {

constexpr double gap = 0.05;

void addBody(scene::Scene& scene, const std::string& name, CellType type, const Point& origin,
             std::array<int, 3> elements, std::array<int, 3> subdomains) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.origin = origin;
  options.elements = elements;
  options.subdomains = subdomains;
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

Found pairsOf(const scene::Scene& scene, double distance) {
  return scene::facingPairs(*testComm(), scene.bodies.size(), scene::decompose(*testComm(), scene), distance);
}

} // namespace

// In the plane sides of the lower body from 1/4 to 1 reach below one of the upper body, whose first side is
// at 0.27, and its last but one ends at 1.07; in space each stands for two, and for three.
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
