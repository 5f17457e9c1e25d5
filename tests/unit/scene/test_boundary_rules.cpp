// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundaryParts.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_OuterSides.hpp"
#include "Harmos_TestBodies.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_boundary_rules {

using namespace Harmos;
using fem::BoundaryRule;
using fem::CellType;
using fem::Point;

namespace {

constexpr double pi = 3.14159265358979323846;

// A block, or a quarter of a ring of it: x is the radius, y the angle in quarters.
fem::BodyMesh blockMesh(CellType type, bool isRing = false) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.origin = {1.0, 0.0, -0.5};
  options.elements = {4, 5, 3};
  if (isRing)
    options.map = [](const Point& x) {
      return Point{x[0] * std::cos(0.5 * pi * x[1]), x[0] * std::sin(0.5 * pi * x[1]), x[2]};
    };
  return wholeBlock(options);
}

// Two bodies in four subdomains each; of simplices, two touch the face "right" by nodes alone.
scene::Scene sceneOf(CellType type, bool isRing = false) {
  scene::Scene scene;
  scene.physics = fem::shapeOf(type).dimension == 3 ? scene::Physics::Solid : scene::Physics::PlaneStrain;
  const fem::BodyMesh mesh = blockMesh(type, isRing);
  const auto isRight = [&](int node) {
    const Point x = mesh.mesh.local(node);
    return (isRing ? std::hypot(x[0], x[1]) : x[0]) > 2.0 - 1e-9;
  };
  std::vector<int> part;
  for (int c = 0; c < mesh.mesh.numberOfCells(); ++c) {
    const fem::CellShape& shape = fem::shapeOf(type);
    const auto corners = std::count_if(mesh.mesh.cell(c), mesh.mesh.cell(c) + shape.corners, isRight);
    part.push_back((corners < fem::shapeOf(shape.sideTypes.front()).corners ? 0 : 2) +
                   (centreOf(mesh.mesh, c)[1] < 0.5 ? 0 : 1));
  }
  long long firstNode = 0;
  for (const char* name : {"one", "two"}) {
    scene.bodies.push_back(tornBody(mesh, part, firstNode, {fem::Material()}));
    scene.bodies.back().name = name;
  }
  return scene;
}

BoundaryRule named(const std::string& name) {
  BoundaryRule rule;
  rule.name = name;
  return rule;
}

// Of each subdomain of this rank, two parts have the same sides and nodes; returns how many subdomains, of
// all ranks, have nodes of them alone.
long long expectSamePart(const std::vector<scene::OwnedSubdomain>& owned, const std::string& a,
                         const std::string& b, int body = -1) {
  SCOPED_TRACE(a + " and " + b);
  long long sides = 0, touched = 0;
  for (const scene::OwnedSubdomain& item : owned) {
    fem::PlacedMesh first = item.mesh, second = item.mesh;
    if (body >= 0 && item.body != body) {
      EXPECT_EQ(first.sets.count(b), 0u);
      EXPECT_EQ(first.sides.count(b), 0u);
      continue;
    }
    first.sets = {{"", first.sets[a]}};
    first.sides = {{"", first.sides[a]}};
    second.sets = {{"", second.sets[b]}};
    second.sides = {{"", second.sides[b]}};
    sides += static_cast<long long>(first.sides[""].size());
    touched += first.sides[""].empty() && !first.sets[""].empty() ? 1 : 0;
    const auto before = [](const fem::Side& x, const fem::Side& y) {
      return std::tie(x.cell, x.side) < std::tie(y.cell, y.side);
    };
    std::sort(first.sides[""].begin(), first.sides[""].end(), before);
    expectSame(first, second);
  }
  EXPECT_GT(globalSum(*testComm(), sides), 0);
  return globalSum(*testComm(), touched);
}

// What a scene without effects is refused for.
std::string refusal(const scene::Scene& scene) {
  return inputErrorOf([&] { scene::decompose(*testComm(), scene); });
}

} // namespace

TEST(BoundaryRules, planes_boxes_and_normals_find_the_faces_of_blocks) {
  for (CellType type :
       {CellType::Triangle3, CellType::Quadrilateral9, CellType::Tetrahedron10, CellType::Hexahedron8}) {
    SCOPED_TRACE(fem::shapeOf(type).name);
    scene::Scene scene = sceneOf(type);
    BoundaryRule plane = named("by plane"), box = named("by box"), normal = named("by normal"),
                 whole = named("whole"), among = named("among");
    plane.plane = BoundaryRule::Plane{{2.0, 7.0, 7.0}, {-2.0, 0.0, 0.0}};
    plane.bodies = {"two"};
    const double far = std::numeric_limits<double>::infinity();
    box.box = fem::Box{{-far, -far, -far}, {1.0, far, far}};
    normal.direction = BoundaryRule::Direction{{3.0, 1.0, 0.0}, 30.0};
    among.of = {"by normal", "left"};
    among.box = fem::Box{{1.5, -1.0, -1.0}, {3.0, 2.0, 2.0}};
    scene.boundaryRules = {plane, box, normal, whole, among};
    const auto owned = scene::decompose(*testComm(), scene);
    const long long touching = expectSamePart(owned, "right", "by plane", 1);
    if (type == CellType::Tetrahedron10)
      EXPECT_GT(touching, 0);
    expectSamePart(owned, "left", "by box");
    expectSamePart(owned, "right", "by normal");
    expectSamePart(owned, "right", "among");
    // All of the boundary is all that is outside, and as large as the block's.
    const auto outer = scene::outerSides(*testComm(), owned);
    long long sides = 0, all = 0;
    for (std::size_t i = 0; i < owned.size(); ++i) {
      sides += static_cast<long long>(outer[i].size());
      if (const auto found = owned[i].mesh.sides.find("whole"); found != owned[i].mesh.sides.end())
        all += static_cast<long long>(found->second.size());
    }
    EXPECT_EQ(sides, all);
    for (const scene::PartSummary& part : scene::boundaryPartsOf(*testComm(), scene, owned)) {
      if (part.part == "whole")
        EXPECT_NEAR(part.geometry.area, fem::shapeOf(type).dimension == 3 ? 6.0 : 4.0, 1e-12);
      if (part.part != "by normal")
        continue;
      const std::optional<Point> common = part.geometry.commonNormal();
      ASSERT_TRUE(common.has_value());
      EXPECT_NEAR((*common)[0], 1.0, 1e-12);
      EXPECT_NEAR(part.geometry.box->low[0], 2.0, 1e-12);
    }
  }
}

TEST(BoundaryRules, cylinders_find_the_round_faces_of_a_ring) {
  for (CellType type : {CellType::Triangle6, CellType::Tetrahedron4, CellType::Hexahedron27}) {
    SCOPED_TRACE(fem::shapeOf(type).name);
    scene::Scene scene = sceneOf(type, true);
    BoundaryRule inner = named("inner"), outer = named("outer");
    inner.cylinder = BoundaryRule::Cylinder{{0.0, 0.0, 5.0}, {0.0, 0.0, -3.0}, 1.0};
    outer.cylinder = BoundaryRule::Cylinder{{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 2.0};
    scene.boundaryRules = {inner, outer};
    const auto owned = scene::decompose(*testComm(), scene);
    expectSamePart(owned, "left", "inner");
    expectSamePart(owned, "right", "outer");
  }
}

// A cap's corners may all be on the rim.
TEST(BoundaryRules, caps_of_a_cylinder_are_not_its_mantle) {
  BoundaryRule rule;
  rule.cylinder = BoundaryRule::Cylinder{{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 1.0};
  fem::SideGeometry cap;
  for (double angle : {0.0, 2.0, 4.0})
    cap.corners.push_back({std::cos(angle), std::sin(angle), 2.0});
  cap.normal = {0.0, 0.0, 1.0};
  EXPECT_FALSE(rule.judge(cap, 1e-6)[3]);
  cap.normal = {1.0, 0.0, 0.1};
  EXPECT_TRUE(rule.judge(cap, 1e-6)[3]);
  cap.corners[1][0] += 1e-3;
  EXPECT_FALSE(rule.judge(cap, 1e-6)[3]);
  EXPECT_TRUE(rule.judge(cap, 1e-3)[3]);
}

TEST(BoundaryRules, what_chooses_nothing_is_refused) {
  scene::Scene scene = sceneOf(CellType::Quadrilateral4);
  BoundaryRule rule = named("seat");
  rule.direction = BoundaryRule::Direction{{0.0, 1.0, 0.0}, 10.0};
  rule.plane = BoundaryRule::Plane{{1.01, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  rule.bodies = {"two"};
  scene.boundaryRules = {rule};
  EXPECT_TRUE(contains(refusal(scene),
                       "\"Boundary parts/seat\" selects no side of body \"two\": of 18 on its "
                       "boundary 4 are of that normal, 0 are on the plane, none meets all conditions"))
      << refusal(scene);
  rule.bodies.clear();
  rule.tolerance = 0.01;
  scene.boundaryRules = {rule};
  EXPECT_TRUE(contains(refusal(scene), "selects no side of any body: of 36")) << refusal(scene);
  rule.direction.reset();
  scene.boundaryRules = {rule};
  EXPECT_EQ(refusal(scene), ""); // within the tolerance
  rule.name = "left";
  scene.boundaryRules = {rule};
  EXPECT_TRUE(contains(refusal(scene), "has a part of this name in its mesh")) << refusal(scene);
  rule.name = "seat";
  rule.of = {"lefft"};
  scene.boundaryRules = {rule};
  EXPECT_TRUE(contains(refusal(scene), "did you mean \"left\"?")) << refusal(scene);
}

} // namespace test_boundary_rules
