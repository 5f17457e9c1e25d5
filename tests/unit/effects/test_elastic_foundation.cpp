// SPDX-License-Identifier: BSD-3-Clause

/// The worked example of docs/adding_an_effect.md: an elastic foundation against exact solutions and against
/// an assembly of its own.

#include "Harmos_ElasticFoundation.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_elastic_foundation {

using namespace Harmos;
using fem::CellType;
using fem::Point;

namespace {

constexpr double young = 2.0, kn = 0.5, kt = 0.3;
// Of the solver. Errors of the answer are by the condition of the problem larger, here below 1e3.
constexpr double tolerance = 1e-13, allowed = 1e-9;

// A column of width one and height two (2 × 3 subdomains) without sideways contraction.
scene::Scene column(CellType type, double normal, double tangential) {
  const bool isSpace = fem::shapeOf(type).dimension == 3;
  scene::Scene scene;
  scene.physics = isSpace ? scene::Physics::Solid : scene::Physics::PlaneStress;
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.size = isSpace ? Point{1, 1, 2} : Point{1, 2, 1};
  options.subdomains = isSpace ? std::array<int, 3>{2, 1, 3} : std::array<int, 3>{2, 3, 1};
  options.elements = {2, 2, 2};
  scene.bodies.push_back(blockBody("column", options, fem::Material::isotropic(young, 0.0)));
  scene.effects.push_back(
      std::make_shared<effects::ElasticFoundation>(effects::Part{0, "bottom"}, normal, tangential));
  return scene;
}

double largestError(const TestRun& run, const scene::Scene& scene,
                    const std::function<Point(const Point&)>& exact) {
  double worst = 0.0;
  const auto m = static_cast<std::size_t>(scene.components());
  for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
    for (std::size_t k = 0; k < run.solution.displacement[i].size(); ++k) {
      const Point x = run.solution.owned[i].mesh.position(static_cast<int>(k / m));
      worst = std::max(worst, std::abs(run.solution.displacement[i][k] - exact(x)[k % m]));
    }
  return globalMax(*testComm(), worst);
}

} // namespace

// A pressure p on top: u = −p/k_n − p y/E, all elements reproduce it. The foundation alone holds the column:
// its lowest subdomains have no kernel, the others all rigid motions.
TEST(ElasticFoundation, compressed_column) {
  const double p = 0.01;
  for (CellType type : {CellType::Quadrilateral4, CellType::Triangle3, CellType::Triangle6,
                        CellType::Hexahedron8, CellType::Tetrahedron4}) {
    scene::Scene scene = column(type, kn, kt);
    const std::size_t up = scene.physics == scene::Physics::Solid ? 2 : 1;
    Point down{};
    down[up] = -p;
    addTraction(scene, {0, "top"}, down);
    EXPECT_FALSE(scene.hasFloatingBody());
    for (const char* form : {"implicit", "condensed"}) {
      const TestRun run = runScene(scene, tolerance, {std::string("Dual operator/Form=") + form});
      ASSERT_TRUE(run.report.converged) << run.report.reason;
      EXPECT_EQ(run.report.kernelDimension, up == 2 ? 4 * 6 : 4 * 3);
      EXPECT_LE(largestError(run, scene,
                             [&](const Point& x) {
                               Point u{};
                               u[up] = -p / kn - p * x[up] / young;
                               return u;
                             }),
                allowed * p)
          << fem::shapeOf(type).name << ", " << form;
    }
  }
}

// Pure bending by t = (0, c(x − ½)) on top: the foundation tilts by c/k_n and the column bends,
// u = c (−y²/2E − y/k_n, (x − ½)(y/E + 1/k_n)), which elements of the second order reproduce.
TEST(ElasticFoundation, tilted_column) {
  const double c = 0.01;
  scene::Scene scene = column(CellType::Quadrilateral9, kn, kt);
  addTraction(scene, {0, "top"}, [c](const Point& x, const Point&) {
    return Point{0.0, c * (x[0] - 0.5), 0.0};
  });
  const TestRun run = runScene(scene, tolerance);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  EXPECT_LE(largestError(run, scene,
                         [&](const Point& x) {
                           return Point{-c * (x[1] * x[1] / (2 * young) + x[1] / kn),
                                        c * (x[0] - 0.5) * (x[1] / young + 1 / kn), 0.0};
                         }),
            allowed * c);
}

// Without tangential stiffness each of the two lowest subdomains keeps sliding, which something else has to
// hold.
TEST(ElasticFoundation, foundation_without_friction_lets_slide) {
  scene::Scene scene = column(CellType::Quadrilateral4, kn, 0.0);
  addTraction(scene, {0, "top"}, Point{0.0, -0.01, 0.0});
  EXPECT_TRUE(scene.hasFloatingBody());
  const TestRun run = runScene(scene, tolerance);
  EXPECT_TRUE(run.report.converged) << run.report.reason;
  EXPECT_EQ(run.report.kernelDimension, 4 * 3 + 2);
  EXPECT_EQ(run.report.coarseDimension, 4 * 3 + 1); // sliding as a whole is held by nothing
}

// Against ∫ φ_i φ_j over a straight edge of length L: L/6 [2 1; 1 2], for edges that lean.
TEST(ElasticFoundation, assembly_on_leaning_edges) {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.elements = {3, 2, 1};
  options.map = [](const Point& x) { return Point{x[0], x[1] + 0.3 * x[0] + 0.2 * x[0] * x[0], 0.0}; };
  scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
  const effects::ElasticFoundation foundation({0, "bottom"}, kn, kt);
  const scene::OwnedSubdomain subdomain{0, 0, scene.bodies[0].subdomain(0)};
  std::vector<MatrixEntry> entries;
  foundation.addStiffness(scene, subdomain, entries);
  const fem::Mesh& mesh = *subdomain.mesh.mesh;
  std::vector<MatrixEntry> expected;
  for (const fem::Side& side : subdomain.mesh.sides.at("bottom")) {
    const std::vector<int> nodes = mesh.nodesOf(side);
    const Point a = mesh.local(nodes[0]), b = mesh.local(nodes[1]);
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    const double n[] = {(b[1] - a[1]) / length, -(b[0] - a[0]) / length};
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j)
        for (int r = 0; r < 2; ++r)
          for (int s = 0; s < 2; ++s)
            expected.push_back(
                {2 * nodes[i] + r, 2 * nodes[j] + s,
                 length / 6 * (i == j ? 2 : 1) * (kn * n[r] * n[s] + kt * ((r == s ? 1 : 0) - n[r] * n[s]))});
  }
  ASSERT_EQ(subdomain.mesh.sides.at("bottom").size(), 3u);
  const LocalMatrix found = makeLocalMatrix(2 * mesh.numberOfNodes(), entries);
  const LocalMatrix right = makeLocalMatrix(2 * mesh.numberOfNodes(), expected);
  ASSERT_EQ(found.columns, right.columns);
  ASSERT_EQ(found.offsets, right.offsets);
  for (std::size_t k = 0; k < found.values.size(); ++k) // some ten products and sums of numbers below one
    EXPECT_NEAR(found.values[k], right.values[k], 1e-15);
}

// Congruent subdomains on the same foundation share one matrix.
TEST(ElasticFoundation, congruent_subdomains_share) {
  const scene::Scene scene = column(CellType::Quadrilateral4, kn, kt);
  const auto owned = scene::decompose(*testComm(), scene);
  const auto subdomains = scene::assemble(scene, owned);
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (std::size_t j = 0; j < owned.size(); ++j) {
      const bool bothOnIt =
          owned[i].mesh.sides.count("bottom") > 0 && owned[j].mesh.sides.count("bottom") > 0;
      const bool noneOnIt =
          owned[i].mesh.sides.count("bottom") == 0 && owned[j].mesh.sides.count("bottom") == 0;
      EXPECT_EQ(subdomains[i].stiffness == subdomains[j].stiffness, bothOnIt || noneOnIt);
    }
}

TEST(ElasticFoundation, settings_that_make_no_sense_are_refused) {
  const auto refusal = [](double normal, double tangential) {
    return inputErrorOf([&] { runScene(column(CellType::Quadrilateral4, normal, tangential), tolerance); });
  };
  EXPECT_TRUE(contains(refusal(0.0, 0.0), "has zero stiffness"));
  EXPECT_TRUE(contains(refusal(1.0, -1.0), "has zero stiffness"));
}

} // namespace test_elastic_foundation
