// SPDX-License-Identifier: BSD-3-Clause

/// Equations between nodes: against a dense solution of the whole body with multipliers, in one piece.

#include "Harmos_Elasticity.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_LinearConstraint.hpp"
#include "Harmos_PlateMesh.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <Teuchos_LAPACK.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace test_linear_constraint {

using namespace Harmos;
using effects::LinearConstraint;
using fem::CellType;
using fem::Point;

namespace {

// Of the solver. Errors of the answer are by the condition of the problem larger, here below 1e3.
constexpr double tolerance = 1e-13, allowed = 1e-9;
const fem::Material material = fem::Material::isotropic(1.0, 0.3);

struct Named {
  std::string name;
  Point place;
};
const std::vector<Named> named = {
    {"a", {1.0, 1.0, 0.0}}, {"b", {1.0, 0.0, 0.0}}, {"c", {0.5, 1.0, 0.0}}, {"held", {0.0, 0.5, 0.0}}};

fem::BodyMesh square() {
  fem::StructuredBlock::Options options;
  options.cellType = CellType::Quadrilateral8;
  options.elements = {4, 4, 1};
  fem::BodyMesh body = wholeBlock(options);
  for (const Named& point : named)
    for (int node = 0; node < body.mesh.numberOfNodes(); ++node)
      if (std::hypot(body.mesh.local(node)[0] - point.place[0], body.mesh.local(node)[1] - point.place[1]) <
          1e-9)
        body.nodes[point.name] = {node};
  body.nodes["two"] = {body.nodes.at("a")[0], body.nodes.at("b")[0]};
  return body;
}

LinearConstraint::Term term(const std::string& part, int component, double coefficient) {
  return {{0, part}, component, coefficient};
}

// Corners move along together, one of them by a given amount more; the middle of the top follows both.
std::vector<LinearConstraint::Equation> equations() {
  return {{{term("a", 0, 1.0), term("b", 0, -2.0), term("a", 1, 0.25)}, 0.0},
          {{term("a", 1, 1.0), term("b", 1, -1.0)}, 0.05},
          {{term("c", 1, 3.0), term("a", 1, -1.0), term("b", 0, 0.5), term("held", 1, 7.0)}, 0.01}};
}

scene::Scene constrained(const std::vector<LinearConstraint::Equation>& rows) {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  const fem::BodyMesh body = square();
  const std::vector<int> part =
      cellsBy(body.mesh, [](const Point& x) { return (x[0] < 0.5 ? 0 : 1) + (x[1] < 0.5 ? 0 : 2); });
  long long first = 0;
  scene.bodies.push_back(tornBody(body, part, first, {material}));
  for (int c = 0; c < 2; ++c)
    prescribe(scene, {0, "left"}, c, c == 1 ? 0.02 : 0.0);
  addTraction(scene, {0, "top"}, Point{0.01, -0.03, 0.0});
  scene.effects.push_back(std::make_shared<LinearConstraint>(rows));
  return scene;
}

struct Dense {
  std::vector<double> u, lambda; ///< of the equations
};

// K u + Bᵀλ = f, Bu = g by LU, Dirichlet conditions among the rows.
Dense denseSolution() {
  const fem::BodyMesh body = square();
  fem::Elasticity elasticity;
  elasticity.materials = {material};
  const LocalMatrix k = fem::assembleElasticity(body.mesh, elasticity);
  const std::vector<double> f =
      fem::assembleTraction(body.mesh, {}, body.sides.at("top"), [](const Point&, const Point&) {
        return Point{0.01, -0.03, 0.0};
      });
  struct Row {
    std::vector<std::pair<int, double>> terms;
    double value;
  };
  std::vector<Row> rows;
  for (int node : nodesOf(body.mesh, body.sides.at("left")))
    for (int c = 0; c < 2; ++c)
      rows.push_back({{{2 * node + c, 1.0}}, c == 1 ? 0.02 : 0.0});
  for (const LinearConstraint::Equation& equation : equations()) {
    rows.push_back({{}, equation.value});
    for (const LinearConstraint::Term& t : equation.terms)
      rows.back().terms.emplace_back(2 * body.nodes.at(t.part.set)[0] + t.component, t.coefficient);
  }
  const int n = k.rows(), size = n + static_cast<int>(rows.size());
  const auto at = [size](int i, int j) { return static_cast<std::size_t>(i + j * size); };
  std::vector<double> a(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), 0.0), x = f;
  for (int i = 0; i < n; ++i)
    for (std::size_t e = k.offsets[static_cast<std::size_t>(i)];
         e < k.offsets[static_cast<std::size_t>(i) + 1]; ++e)
      a[at(i, k.columns[e])] = k.values[e];
  for (int r = 0; r < static_cast<int>(rows.size()); ++r) {
    for (const auto& [dof, coefficient] : rows[static_cast<std::size_t>(r)].terms)
      a[at(n + r, dof)] = a[at(dof, n + r)] = coefficient;
    x.push_back(rows[static_cast<std::size_t>(r)].value);
  }
  std::vector<int> pivots(static_cast<std::size_t>(size));
  int info = 0;
  Teuchos::LAPACK<int, double>().GESV(size, 1, a.data(), size, pivots.data(), x.data(), size, &info);
  EXPECT_EQ(info, 0);
  return {{x.begin(), x.begin() + n}, {x.end() - static_cast<std::ptrdiff_t>(equations().size()), x.end()}};
}

} // namespace

TEST(LinearConstraint, agrees_with_a_dense_solution) {
  const scene::Scene scene = constrained(equations());
  const auto [exact, lambda] = denseSolution();
  const fem::BodyMesh body = square();
  for (const char* form : {"implicit", "condensed"}) {
    const TestRun run = runScene(scene, tolerance, {std::string("Dual operator/Form=") + form});
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    double worst = 0.0;
    for (std::size_t i = 0; i < run.solution.owned.size(); ++i) {
      const fem::PlacedMesh& mesh = run.solution.owned[i].mesh;
      for (int node = 0; node < mesh.mesh->numberOfNodes(); ++node)
        for (int whole = 0; whole < body.mesh.numberOfNodes(); ++whole)
          if (std::hypot(mesh.position(node)[0] - body.mesh.local(whole)[0],
                         mesh.position(node)[1] - body.mesh.local(whole)[1]) < 1e-9)
            for (int c = 0; c < 2; ++c)
              worst = std::max(worst,
                               std::abs(run.solution.displacement[i][static_cast<std::size_t>(2 * node + c)] -
                                        exact[static_cast<std::size_t>(2 * whole + c)]));
    }
    EXPECT_LE(globalMax(*testComm(), worst), allowed) << form;
    // −λ c of all terms at the node of each equation's first one.
    std::array<double, 2> force{};
    const std::vector<LinearConstraint::Equation> all = equations();
    for (std::size_t k = 0; k < all.size(); ++k)
      for (const LinearConstraint::Term& t : all[k].terms)
        if (t.part.set == all[k].terms.front().part.set)
          force[static_cast<std::size_t>(t.component)] -= lambda[k] * t.coefficient;
    for (const run::Forces::Of& effect : run.report.forces.effects)
      if (effect.path.rfind("Linear constraint", 0) == 0)
        for (std::size_t d = 0; d < 2; ++d)
          EXPECT_NEAR(effect.resultant.force[d], force[d], allowed) << form;
  }
}

TEST(LinearConstraint, of_prescribed_displacements_alone_is_left_out_or_contradicts_them) {
  scene::Scene scene = constrained({{{term("held", 1, 1.0)}, 0.02}, {{term("held", 0, 2.0)}, 0.0}});
  const TestRun run = runScene(scene, tolerance);
  EXPECT_TRUE(run.report.converged);
  scene = constrained({{{term("held", 1, 1.0)}, 0.03}});
  EXPECT_TRUE(contains(failureOf(scene), "contradicts prescribed displacements"));
}

TEST(LinearConstraint, refuses_parts_of_several_nodes_and_components_that_are_not_there) {
  EXPECT_TRUE(contains(failureOf(constrained({{{term("two", 0, 1.0)}, 0.0}})), "has several nodes"));
  EXPECT_TRUE(contains(failureOf(constrained({{{term("a", 2, 1.0)}, 0.0}})), "names component 2"));
  EXPECT_TRUE(contains(failureOf(constrained({{{term("nowhere", 0, 1.0)}, 0.0}})), "\"nowhere\""));
}

} // namespace test_linear_constraint
