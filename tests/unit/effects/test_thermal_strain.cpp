// SPDX-License-Identifier: BSD-3-Clause

/// Temperatures that vary within a body: where they are linear, a free body has no stress.

#include "Harmos_Exchange.hpp"
#include "Harmos_PlateMesh.hpp"
#include "Harmos_StressRecovery.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"
#include "Harmos_ThermalStrain.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_thermal_strain {

using namespace Harmos;
using fem::CellType;
using fem::Point;

namespace {

constexpr double alpha = 1e-3, base = 20.0, slope = 8.0;

// Of a body that nothing holds.
Point free(const Point& x) {
  return {alpha * (base * x[0] + slope * x[0] * x[1]),
          alpha * (base * x[1] + slope * (x[1] * x[1] - x[0] * x[0] - x[2] * x[2]) / 2.0),
          alpha * (base * x[2] + slope * x[1] * x[2])};
}

// A unit square or cube with T = base + slope y at its nodes, cut into four; what holds it admits
//   u = α (T₀ x + g x y, T₀ y + g (y² − x² − z²)/2, T₀ z + g y z).
scene::Scene warm(CellType type, const std::string& field) {
  const bool isSpace = fem::shapeOf(type).dimension == 3;
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.elements = {4, 4, isSpace ? 2 : 1};
  fem::BodyMesh body = wholeBlock(options);
  for (int node = 0; node < body.mesh.numberOfNodes(); ++node)
    body.fields["heat"].push_back(base + slope * body.mesh.local(node)[1]);
  const std::vector<int> part =
      cellsBy(body.mesh, [](const Point& x) { return (x[0] < 0.5 ? 0 : 1) + (x[1] < 0.5 ? 0 : 2); });
  scene::Scene scene;
  scene.physics = isSpace ? scene::Physics::Solid : scene::Physics::PlaneStress;
  fem::Material material = fem::Material::isotropic(200.0, 0.3);
  material.expansion = {alpha, alpha, alpha};
  long long first = 0;
  scene.bodies.push_back(tornBody(body, part, first, {material}));
  for (int c = 0; c < scene.components(); ++c)
    prescribe(scene, {0, "left"}, c, [c](const Point& x) { return free(x)[static_cast<std::size_t>(c)]; });
  scene.effects.push_back(std::make_shared<effects::ThermalStrain>(0, field, ""));
  return scene;
}

} // namespace

TEST(ThermalStrain, linear_temperatures_cause_no_stress) {
  for (CellType type :
       {CellType::Triangle6, CellType::Quadrilateral8, CellType::Quadrilateral9, CellType::Tetrahedron10,
        CellType::Hexahedron20, CellType::Hexahedron27, CellType::Wedge15})
    for (fem::Integration integration : {fem::Integration::Full, fem::Integration::Reduced}) {
      SCOPED_TRACE(fem::shapeOf(type).name);
      scene::Scene scene = warm(type, "heat");
      scene.bodies[0].integration = integration;
      const TestRun run = runScene(scene, 1e-13);
      ASSERT_TRUE(run.report.converged) << run.report.reason;
      double worst = 0.0;
      const auto stresses =
          run::recoverStress(*testComm(), scene, run.solution.owned, run.solution.displacement, 1.0).stress;
      for (const auto& subdomain : stresses)
        for (const fem::Voigt& stress : subdomain)
          for (double entry : stress)
            worst = std::max(worst, std::abs(entry));
      // Of E α T = 5.6, and of α T = 0.028: ten tolerances times condition numbers below 1e3.
      EXPECT_LE(globalMax(*testComm(), worst), 1e-8);
      double largest = 0.0;
      for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
        for (std::size_t k = 0; k < run.solution.displacement[i].size(); ++k) {
          const auto components = static_cast<std::size_t>(scene.components());
          const Point u = free(run.solution.owned[i].mesh.position(static_cast<int>(k / components)));
          largest = std::max(largest, std::abs(run.solution.displacement[i][k] - u[k % components]));
        }
      EXPECT_LE(globalMax(*testComm(), largest), 1e-10);
    }
}

TEST(ThermalStrain, a_field_that_is_not_there_is_named) {
  const std::string text = failureOf(warm(CellType::Quadrilateral9, "cold"));
  EXPECT_TRUE(contains(text, "no field \"cold\"") && contains(text, "\"heat\"")) << text;
}

} // namespace test_thermal_strain
