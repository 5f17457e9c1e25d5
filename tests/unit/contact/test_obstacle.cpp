// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactTestSupport.hpp"

#include <gtest/gtest.h>

namespace test_obstacle {

using namespace Harmos;
using namespace Harmos::contact;
using fem::CellType;
using fem::Point;

namespace {

Obstacle make(Obstacle::Shape shape, const Point& point, const Point& direction, double radius) {
  Obstacle obstacle;
  obstacle.shape = shape;
  obstacle.point = point;
  obstacle.direction = direction;
  obstacle.radius = radius;
  return obstacle;
}

using Shape = Obstacle::Shape;

// What a gap along a normal means: a displacement of normal · gap brings a node to the obstacle.
template<class Distance>
void expectTouching(const Surface& surface, const Obstacle& obstacle, Distance&& distance) {
  const auto points = obstaclePoints(surface, obstacle);
  ASSERT_EQ(points.size(), surface.numbers.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points[i].node, surface.numbers[i]);
    ASSERT_EQ(points[i].terms.size(), 1u);
    EXPECT_EQ(points[i].terms[0].node, surface.numbers[i]);
    EXPECT_EQ(points[i].terms[0].weight, 1.0);
    EXPECT_NEAR(norm(points[i].normal), 1.0, 1e-15);
    EXPECT_EQ(points[i].area, surface.areas[i]);
    EXPECT_NEAR(points[i].gap, distance(surface.positions[i]), 1e-14);
    EXPECT_NEAR(distance(sum(surface.positions[i], scaled(points[i].gap, points[i].normal))), 0.0, 1e-14);
  }
}

} // namespace

TEST(Obstacle, gap_and_normal_lead_to_it) {
  const Surface plane =
      surfaceOf(block(CellType::Quadrilateral4, {0, 1, 0}, {2, 1, 0}, {2, 1, 1}, {3, 2, 1}), "bottom");
  // Nodes at y = 1; the plane through (0, 1.2) lies above its left end: penetration.
  expectTouching(plane, make(Shape::HalfSpace, {0, 1.2, 0}, {1, 2, 0}, 0.0),
                 [](const Point& x) { return (x[0] + 2.0 * (x[1] - 1.2)) / std::sqrt(5.0); });
  // The direction of the axis plays no part in the plane.
  expectTouching(plane, make(Shape::Cylinder, {1, -1, 5}, {0, 1, 0}, 1.9),
                 [](const Point& x) { return std::hypot(x[0] - 1.0, x[1] + 1.0) - 1.9; });
  expectTouching(plane, make(Shape::Cylinder, {1, 1.5, 0}, {}, -2.0),
                 [](const Point& x) { return 2.0 - std::hypot(x[0] - 1.0, x[1] - 1.5); });

  expectTouching(plane, make(Shape::Sphere, {1, -1, 5}, {}, 1.9),
                 [](const Point& x) { return std::hypot(x[0] - 1.0, x[1] + 1.0) - 1.9; });

  const Surface space =
      surfaceOf(block(CellType::Hexahedron8, {0, 0, 1}, {1, 1, 1}, {2, 1, 1}, {2, 2, 2}), "bottom");
  expectTouching(space, make(Shape::HalfSpace, {0, 0, 0.5}, {0, 0, 2}, 0.0),
                 [](const Point& x) { return x[2] - 0.5; });
  expectTouching(space, make(Shape::Cylinder, {3, 0.4, -1}, {-2, 0, 0}, 1.5),
                 [](const Point& x) { return std::hypot(x[1] - 0.4, x[2] + 1.0) - 1.5; });
  expectTouching(space, make(Shape::Sphere, {0.5, 0.5, -1}, {}, 2.1),
                 [](const Point& x) { return std::hypot(x[0] - 0.5, x[1] - 0.5, x[2] + 1.0) - 2.1; });
  expectTouching(space, make(Shape::Sphere, {0.5, 0.5, 2}, {}, -3.0),
                 [](const Point& x) { return 3.0 - std::hypot(x[0] - 0.5, x[1] - 0.5, x[2] - 2.0); });
}

TEST(Obstacle, contact_points_towards_the_body_that_is_touched) {
  const Surface bottom =
      surfaceOf(block(CellType::Quadrilateral4, {0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {2, 1, 1}), "bottom");
  const auto ground = obstaclePoints(bottom, make(Shape::HalfSpace, {0, 0, 0}, {0, 3, 0}, 0.0));
  const auto cylinder = obstaclePoints(bottom, make(Shape::Cylinder, {0.5, -1, 0}, {}, 1.0));
  const auto hollow = obstaclePoints(bottom, make(Shape::Cylinder, {0.5, 2, 0}, {}, -2.0));
  for (const auto* points : {&ground, &cylinder, &hollow}) {
    EXPECT_LT(norm(difference((*points)[1].normal, {0, -1, 0})), 1e-15);
    EXPECT_NEAR((*points)[1].gap, 1.0, 1e-15);
  }
}

TEST(Obstacle, senseless_ones_are_refused) {
  const Surface bottom =
      surfaceOf(block(CellType::Quadrilateral4, {0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {2, 1, 1}), "bottom");
  const auto text = [&](const Obstacle& obstacle) {
    return messageOf([&] { obstaclePoints(bottom, obstacle); });
  };
  const auto has = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  has(text(make(Shape::HalfSpace, {}, {}, 0.0)), "obstacle of surface body/bottom: direction");
  has(text(make(Shape::HalfSpace, {}, {0, 0, 1}, 0.0)), "is a zero vector");
  has(text(make(Shape::Cylinder, {}, {0, 0, 1}, 0.0)), "invalid radius 0.000000; give a positive radius");
  has(text(make(Shape::Sphere, {0.5, 1, 0}, {}, 1.0)),
      "node 1 at (0.500000, 1.000000, 0.000000) lies at its centre");
}

} // namespace test_obstacle
