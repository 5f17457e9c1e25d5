// SPDX-License-Identifier: BSD-3-Clause

/// Forces at nodes: torn bodies against the same body in one piece, and resultants.

#include "Harmos_Exchange.hpp"
#include "Harmos_Force.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace test_force {

using namespace Harmos;
using fem::CellType;
using fem::Point;

namespace {

// Of the solver. Errors of the answer are by the condition of the problem larger, here below 1e3.
constexpr double tolerance = 1e-13, allowed = 1e-9;
const Point load = {0.01, -0.02, 0.03};

// A block that stands on its bottom, cut into the given subdomains; forces act at all nodes of its top.
scene::Scene loaded(CellType type, const std::array<int, 3>& subdomains, const std::array<int, 3>& elements) {
  const bool isSpace = fem::shapeOf(type).dimension == 3;
  scene::Scene scene;
  scene.physics = isSpace ? scene::Physics::Solid : scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.subdomains = subdomains;
  options.elements = elements;
  scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
  for (int c = 0; c < scene.components(); ++c)
    prescribe(scene, {0, "bottom"}, c);
  scene.effects.push_back(std::make_shared<effects::Force>(effects::Part{0, "top"}, load));
  return scene;
}

// Of each place its displacement, on all ranks; copies agree.
std::map<std::array<long long, 3>, Point> field(const TestRun& run, int components) {
  struct Entry {
    std::array<long long, 3> place;
    Point value;
  };
  std::vector<Entry> mine;
  for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
    for (int node = 0; node < run.solution.owned[i].mesh.mesh->numberOfNodes(); ++node) {
      const Point x = run.solution.owned[i].mesh.position(node);
      Entry entry{{std::llround(x[0] * 1e6), std::llround(x[1] * 1e6), std::llround(x[2] * 1e6)}, {}};
      for (int c = 0; c < components; ++c)
        entry.value[static_cast<std::size_t>(c)] =
            run.solution.displacement[i][static_cast<std::size_t>(node * components + c)];
      mine.push_back(entry);
    }
  std::map<std::array<long long, 3>, Point> result;
  for (const Entry& entry : gatherAll(*testComm(), mine))
    result[entry.place] = entry.value;
  return result;
}

} // namespace

TEST(Force, acts_once_at_nodes_of_several_subdomains) {
  for (CellType type :
       {CellType::Quadrilateral4, CellType::Triangle6, CellType::Hexahedron8, CellType::Hexahedron20}) {
    SCOPED_TRACE(fem::shapeOf(type).name);
    const bool isSpace = fem::shapeOf(type).dimension == 3;
    const scene::Scene torn = loaded(type, {2, 2, 2}, {2, 2, 2}), whole = loaded(type, {1, 1, 1}, {4, 4, 4});
    const TestRun first = runScene(torn, tolerance), second = runScene(whole, tolerance);
    ASSERT_TRUE(first.report.converged && second.report.converged);
    const auto a = field(first, torn.components()), b = field(second, torn.components());
    ASSERT_EQ(a.size(), b.size());
    double size = 0.0, apart = 0.0;
    std::size_t nodes = 0;
    for (const auto& [place, u] : b) {
      nodes += place[isSpace ? 2 : 1] == 1000000 ? 1 : 0;
      for (std::size_t c = 0; c < 3; ++c) {
        size = std::max(size, std::abs(u[c]));
        apart = std::max(apart, std::abs(u[c] - a.at(place)[c]));
      }
    }
    EXPECT_GT(size, 0.01);
    EXPECT_LE(apart, allowed * size);
    // The supports bear what all nodes of the top do, each counted once.
    Point reaction{};
    for (const run::Forces::Of& effect : first.report.forces.effects)
      for (std::size_t c = 0; c < 3; ++c)
        reaction[c] += effect.resultant.force[c];
    for (std::size_t c = 0; c < static_cast<std::size_t>(torn.components()); ++c)
      EXPECT_NEAR(reaction[c], -static_cast<double>(nodes) * load[c], allowed * static_cast<double>(nodes));
  }
}

} // namespace test_force
