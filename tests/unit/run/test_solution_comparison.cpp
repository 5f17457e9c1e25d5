// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Exchange.hpp"
#include "Harmos_SolutionComparison.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_solution_comparison {

using namespace Harmos;
using fem::CellType;
using fem::Point;

namespace {

using Field = std::function<Point(const Point&)>;

// Two blocks, one upon the other, with displacements that are given; not solved. The upper one bears on the
// lower one with a pressure that is given.
run::FinishedRun given(CellType type, int subdomains, int elements, const Field& displacement,
                       const std::function<double(double)>& pressure) {
  run::FinishedRun run;
  run.scene.physics = scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.subdomains = {subdomains, subdomains, 1};
  options.elements = {elements, elements, 1};
  run.scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(2.0, 0.3)));
  options.origin = {0.0, 1.0, 0.0};
  run.scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(1.0, 0.2)));
  run.solution.owned = scene::decompose(*testComm(), run.scene);
  std::vector<contact::ContactPoint> mine;
  for (const scene::OwnedSubdomain& item : run.solution.owned) {
    std::vector<double> values;
    for (int node = 0; node < item.mesh.mesh->numberOfNodes(); ++node)
      for (std::size_t d = 0; d < 2; ++d)
        values.push_back(displacement(item.mesh.position(node))[d]);
    run.solution.displacement.push_back(values);
  }
  const int n = subdomains * elements * (type == CellType::Quadrilateral9 ? 2 : 1);
  std::map<double, long long> numbers; // of the nodes at the bottom of the upper block
  struct Node {
    double x;
    long long number;
  };
  std::vector<Node> nodes;
  for (const scene::OwnedSubdomain& item : run.solution.owned)
    if (item.body == 1 && item.mesh.sets.count("bottom") > 0)
      for (int node : item.mesh.sets.at("bottom"))
        nodes.push_back({item.mesh.position(node)[0], item.mesh.number(node)});
  for (const Node& node : gatherAll(*testComm(), nodes))
    numbers[std::round(node.x * n)] = node.number;
  for (const auto& [place, number] : numbers) {
    contact::ContactPoint point;
    point.node = number;
    point.position = {place / n, 1.0, 0.0};
    point.area = (place == 0.0 || place == n ? 0.5 : 1.0) / n;
    run.points.push_back(point);
    const double p = pressure(place / n);
    run.states.push_back({p, p * point.area, 0.0, p > 0.0});
  }
  return run;
}

double linearPressure(double x) {
  return 1.0 + x;
}

Point linear(const Point& x) {
  return {0.1 + x[0] - 2.0 * x[1], 0.3 * x[1]};
}

} // namespace

TEST(SolutionComparison, linear_fields_are_the_same_on_any_two_meshes) {
  for (CellType type : {CellType::Quadrilateral4, CellType::Quadrilateral9, CellType::Triangle3}) {
    const run::FinishedRun fine = given(CellType::Quadrilateral4, 3, 4, linear, linearPressure);
    const run::FinishedRun coarse = given(type, 2, 3, linear, linearPressure);
    const run::SolutionNorms norms = run::SolutionComparison(*testComm(), fine, coarse).difference(coarse);
    // Rounding: eps times values of order one over h = 1/12.
    EXPECT_LE(norms.energy, 1e-12);
    EXPECT_LE(norms.displacement, 1e-13);
    EXPECT_LE(norms.pressure, 1e-13);
    EXPECT_LE(norms.contactArea, 1e-13);
  }
}

TEST(SolutionComparison, norms_of_known_fields) {
  const run::SolutionNorms norms =
      run::normsOf(*testComm(), given(CellType::Quadrilateral4, 3, 4, linear, linearPressure));
  double energy = 0.0;
  const std::array<Point, 3> g = {{{1.0, -2.0, 0.0}, {0.0, 0.3, 0.0}, {}}};
  for (const fem::Material& material :
       {fem::Material::isotropic(2.0, 0.3), fem::Material::isotropic(1.0, 0.2)})
    energy += fem::elasticEnergy({fem::Kinematics::PlaneStrain, fem::Dilatation::Full, {material}})(0, g);
  EXPECT_NEAR(norms.energy, std::sqrt(energy), 1e-13);
  // ∫ over (0,1)×(0,2) of (0.1 + x − 2y)² + 0.09y²: of x and y the means 1/2, 1, of the squares 1/3, 4/3.
  const double mean = 0.01 + 1.0 / 3.0 + 16.0 / 3.0 + 0.1 - 0.4 - 2.0 + 0.12;
  EXPECT_NEAR(norms.displacement, std::sqrt(2.0 * mean), 1e-13);
  EXPECT_NEAR(norms.contactArea, 1.0, 1e-14);
}

TEST(SolutionComparison, quadratic_field_against_its_linear_interpolant) {
  const Field quadratic = [](const Point& x) { return Point{x[0] * x[0], 0.0, 0.0}; };
  // The reference is exact: of second order, its cells within those of the other mesh.
  const run::FinishedRun exact = given(CellType::Quadrilateral9, 2, 6, quadratic, linearPressure);
  for (int s : {1, 2, 3}) { // 6 cells a side, cut in several ways
    const run::FinishedRun run =
        given(CellType::Quadrilateral4, s, 6 / s, quadratic, [](double x) { return x < 0.4 ? 1.0 : 0.0; });
    const run::SolutionNorms norms = run::SolutionComparison(*testComm(), exact, run).difference(run);
    const double h = 1.0 / 6.0; // ∫(2x − u_h')² = h²/3, ∫(x² − u_h)² = h⁴/30
    double modulus = 0.0;
    for (const auto& [e, nu] : {std::pair{2.0, 0.3}, std::pair{1.0, 0.2}})
      modulus += e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    EXPECT_NEAR(norms.energy, std::sqrt(modulus * h * h / 3.0), 1e-12);
    EXPECT_NEAR(norms.displacement, std::sqrt(2.0 * std::pow(h, 4) / 30.0), 1e-13);
    // Closed are the points at 0, 1/6 and 2/6: areas 1/12 + 1/6 + 1/6.
    EXPECT_NEAR(norms.contactArea, 1.0 - 5.0 / 12.0, 1e-13);
    // The pressure of the run goes linearly from 1 at 2/6 to 0 at 3/6.
    double sum = 0.0;
    for (std::size_t k = 0; k < exact.points.size(); ++k) {
      const double x = exact.points[k].position[0];
      const double p = std::clamp(3.0 - 6.0 * x, 0.0, 1.0);
      sum += exact.points[k].area * std::pow(1.0 + x - p, 2);
    }
    EXPECT_NEAR(norms.pressure, std::sqrt(sum), 1e-12);
  }
}

TEST(SolutionComparison, on_the_same_mesh_it_is_the_difference_of_the_nodes) {
  const Field other = [](const Point& x) { return Point{std::sin(x[0]), x[0] * x[1]}; };
  const run::FinishedRun first = given(CellType::Quadrilateral4, 2, 5, linear, linearPressure);
  const run::FinishedRun second =
      given(CellType::Quadrilateral4, 2, 5, other, [](double x) { return x > 0.5 ? x : 0.0; });
  const run::SolutionNorms same = run::differenceOnSameMesh(*testComm(), first, second);
  const run::SolutionNorms general = run::SolutionComparison(*testComm(), first, second).difference(second);
  EXPECT_NEAR(same.energy, general.energy, 1e-12 * same.energy);
  EXPECT_NEAR(same.displacement, general.displacement, 1e-12 * same.displacement);
  EXPECT_NEAR(same.pressure, general.pressure, 1e-12 * same.pressure);
  EXPECT_NEAR(same.contactArea, general.contactArea, 1e-12);
  EXPECT_GT(same.contactArea, 0.3);
}

namespace {

// Slips of x² along and x across, and what friction does from place to place.
void rub(run::FinishedRun& run, const std::function<run::Friction(double)>& friction) {
  for (std::size_t k = 0; k < run.points.size(); ++k) {
    const double x = run.points[k].position[0];
    run.states[k].slip = {x * x, 0.0, x};
    run.states[k].friction = friction(x);
  }
}

} // namespace

TEST(SolutionComparison, slips_and_zones_that_stick) {
  using run::Friction;
  run::FinishedRun fine = given(CellType::Quadrilateral4, 3, 4, linear, linearPressure);
  run::FinishedRun coarse = given(CellType::Quadrilateral4, 2, 3, linear, linearPressure);
  rub(fine, [](double x) {
    return x < 0.24 ? Friction::None : x < 0.51 ? Friction::Sticks : Friction::Slips;
  });
  rub(coarse, [](double x) { return x < 0.51 ? Friction::None : Friction::Sticks; });
  const double h = 1.0 / 12.0;
  double slips = 0.0, differences = 0.0; // where the reference bears friction, from 1/4 on
  for (int k = 3; k <= 12; ++k) {
    const double x = k * h, area = k < 12 ? h : 0.5 * h;
    slips += area * (std::pow(x, 4) + x * x);
    // x² is off by h² in the middle of the coarse cells, x nowhere.
    differences += k % 2 == 1 ? area * std::pow(h, 4) : 0.0;
  }
  const run::SolutionNorms norms = run::normsOf(*testComm(), fine);
  EXPECT_NEAR(norms.slip, std::sqrt(slips), 1e-13);
  EXPECT_NEAR(norms.stickArea, 4.0 * h, 1e-14); // 3/12 to 6/12
  const run::SolutionNorms off = run::SolutionComparison(*testComm(), fine, coarse).difference(coarse);
  EXPECT_NEAR(off.slip, std::sqrt(differences), 1e-13);
  // 4/6 and 5/6 have an area of 2h, the end one of h.
  EXPECT_NEAR(off.stickArea, 5.0 * h - 4.0 * h, 1e-14);

  run::FinishedRun other = fine;
  rub(other, [](double) { return Friction::Slips; });
  for (run::ContactState& state : other.states)
    state.slip[0] += 0.1;
  const run::SolutionNorms same = run::differenceOnSameMesh(*testComm(), other, fine);
  EXPECT_NEAR(same.slip, 0.1 * std::sqrt(9.5 * h), 1e-13);
  EXPECT_NEAR(same.stickArea, 4.0 * h, 1e-14);
  // Without friction there is nothing of it.
  rub(fine, [](double) { return Friction::None; });
  EXPECT_EQ(run::normsOf(*testComm(), fine).slip, 0.0);
  EXPECT_EQ(run::normsOf(*testComm(), fine).stickArea, 0.0);
}

TEST(SolutionComparison, scenes_that_differ_are_refused) {
  const run::FinishedRun first = given(CellType::Quadrilateral4, 2, 2, linear, linearPressure);
  run::FinishedRun second = first;
  second.scene.bodies.pop_back();
  const std::string message =
      inputErrorOf([&] { const run::SolutionComparison comparison(*testComm(), first, second); });
  EXPECT_TRUE(contains(message, "bodies: 1 here, 2 in the reference")) << message;
}

} // namespace test_solution_comparison
