// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ErrorNorms.hpp"
#include "Harmos_StressPatches.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

namespace test_recovery_error {

using namespace Harmos;
using fem::CellType;
using fem::Kinematics;
using fem::Material;
using fem::Point;

namespace {

Point smooth(const Point& x) {
  return {std::sin(2.0 * x[0]) * std::cos(x[1]), std::cos(x[0] + 0.5 * x[1]), std::sin(x[2] + x[0] * x[1])};
}

std::array<Point, 3> gradient(const Point& x) {
  const double s = std::sin(x[0] + 0.5 * x[1]), c = std::cos(x[2] + x[0] * x[1]);
  return {Point{2.0 * std::cos(2.0 * x[0]) * std::cos(x[1]), -std::sin(2.0 * x[0]) * std::sin(x[1]), 0.0},
          Point{-s, -0.5 * s, 0.0}, Point{c * x[1], c * x[0], c}};
}

fem::PlacedMesh block(CellType type, int n) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.elements = {n, n, n};
  return fem::StructuredBlock(options).subdomain(0);
}

// Estimated over true energy norm of the error, of the interpolant of a smooth field.
double effectivity(CellType type, int n, const fem::Elasticity& elasticity) {
  const fem::PlacedMesh placed = block(type, n);
  const int dimension = placed.mesh->dimension();
  std::vector<double> u;
  for (int node = 0; node < placed.mesh->numberOfNodes(); ++node)
    for (int d = 0; d < dimension; ++d)
      u.push_back(smooth(placed.position(node))[static_cast<std::size_t>(d)]);
  const fem::StressPatches patches = fem::stressPatches(*placed.mesh, elasticity, {{&u}}).front();
  const fem::RecoveryError estimate = fem::recoveryError(*placed.mesh, elasticity, {{&u}}, {&patches});
  const fem::SquaredErrors exact = fem::squaredErrors(
      *placed.mesh, placed.anchor, elasticity, u,
      [&](const Point& x) {
        Point v = smooth(x);
        if (dimension == 2)
          v[2] = 0.0;
        return v;
      },
      [&](const Point& x) {
        std::array<Point, 3> g = gradient(x);
        if (dimension == 2)
          g[2] = {0.0, 0.0, 0.0};
        return g;
      });
  return std::sqrt(estimate.error / exact.energy);
}

} // namespace

// The estimator is asymptotically exact where the recovered stresses are superconvergent: on regular meshes,
// but for a layer at the boundary, whose share falls like h. Interpolants share that with finite element
// solutions on rectangles (Zlámal); triangles in pairs of the first order less so.
TEST(RecoveryError, tends_to_the_error) {
  const fem::Elasticity plane{
      Kinematics::PlaneStrain, fem::Dilatation::Full, {Material::isotropic(3.0, 0.3)}};
  const fem::Elasticity stress{
      Kinematics::PlaneStress, fem::Dilatation::Full, {Material::isotropic(3.0, 0.3)}};
  const fem::Elasticity solid{Kinematics::Solid, fem::Dilatation::Full, {Material::isotropic(3.0, 0.3)}};
  for (const auto& [type, elasticity, finest] : {std::make_tuple(CellType::Quadrilateral4, plane, 64),
                                                 std::make_tuple(CellType::Quadrilateral4, stress, 64),
                                                 std::make_tuple(CellType::Hexahedron8, solid, 24)}) {
    double previous = 1.0;
    for (int n = finest / 4; n <= finest; n *= 2) {
      const double off = std::abs(effectivity(type, n, elasticity) - 1.0);
      std::cout << fem::shapeOf(type).name << ", n = " << n << ": off by " << off << "\n";
      EXPECT_LT(off, n == finest / 4 ? 0.2 : 0.75 * previous) << fem::shapeOf(type).name << ", n = " << n;
      previous = off;
    }
  }
  for (const auto& [type, elasticity, least] :
       {std::make_tuple(CellType::Triangle3, plane, 0.65),
        std::make_tuple(CellType::Tetrahedron4, solid, 0.75),
        std::make_tuple(CellType::Triangle6, plane, 0.9),
        std::make_tuple(CellType::Quadrilateral8, plane, 0.9),
        std::make_tuple(CellType::Quadrilateral9, plane, 0.9),
        std::make_tuple(CellType::Tetrahedron10, solid, 0.85),
        std::make_tuple(CellType::Hexahedron20, solid, 0.85), std::make_tuple(CellType::Wedge15, solid, 0.85),
        std::make_tuple(CellType::Hexahedron27, solid, 0.85)}) {
    const double index = effectivity(type, 8, elasticity);
    std::cout << fem::shapeOf(type).name << ": " << index << "\n";
    EXPECT_GT(index, least) << fem::shapeOf(type).name;
    EXPECT_LT(index, 1.1) << fem::shapeOf(type).name;
  }
}

// Of a membrane: u = x² on squares of side h has the error ∫|∇(u − u_h)|² = h²/3 on the unit square, and the
// estimate is exact inside; at the two sides where x is 0 and 1 the mean is that of one cell.
TEST(RecoveryError, membranes) {
  constexpr int n = 32;
  constexpr double h = 1.0 / n;
  const fem::PlacedMesh placed = block(CellType::Quadrilateral4, n);
  std::vector<double> u;
  for (int node = 0; node < placed.mesh->numberOfNodes(); ++node)
    u.push_back(std::pow(placed.position(node)[0], 2));
  // Two congruent meshes at once: the second solution is twice the first.
  std::vector<double> v = u;
  for (double& entry : v)
    entry *= 2.0;
  const std::vector<fem::StressPatches> patches = fem::fluxPatches(*placed.mesh, {{&u}, {&v}});
  const fem::RecoveryError both =
      fem::fluxRecoveryError(*placed.mesh, {{&u}, {&v}}, {&patches[0], &patches[1]});
  const fem::RecoveryError one = fem::fluxRecoveryError(*placed.mesh, {{&u}}, {&patches[0]});
  EXPECT_NEAR(both.error, 5.0 * one.error, 1e-13);
  EXPECT_NEAR(both.energy, 5.0 * one.energy, 1e-13);
  // In the outer columns q* − u_h' runs from 0 to h instead of −h to h: a quarter of (2h)²/12.
  const double inside = (n - 2) * h * h * h / 3.0, outside = 2.0 * h * h * h / 3.0;
  EXPECT_NEAR(one.error, inside + outside, 1e-13);
  // ∫ (u_h')² = ∫ (2x)² − h²/3.
  EXPECT_NEAR(one.energy, 4.0 / 3.0 - h * h / 3.0, 1e-12);
}

// Stresses that jump from region to region are no error: a bar of two materials, with constant strains in
// each. With one material the same displacements are as far from equilibrium as the strains jump.
TEST(RecoveryError, regions_are_recovered_apart) {
  const fem::Elasticity elasticity{Kinematics::PlaneStress,
                                   fem::Dilatation::Full,
                                   {Material::isotropic(1.0, 0.3), Material::isotropic(100.0, 0.0)}};
  for (CellType type :
       {CellType::Quadrilateral4, CellType::Triangle3, CellType::Triangle6, CellType::Quadrilateral9}) {
    const fem::PlacedMesh placed = block(type, 8);
    fem::Mesh mesh = *placed.mesh;
    std::vector<double> u;
    for (int node = 0; node < mesh.numberOfNodes(); ++node) {
      const double x = placed.position(node)[0];
      u.push_back(std::min(x, 0.5) + 0.01 * std::max(x - 0.5, 0.0));
      u.push_back(0.1 * placed.position(node)[1]);
    }
    const int corners = fem::shapeOf(type).corners;
    for (int c = 0; c < mesh.numberOfCells(); ++c) {
      double x = 0.0;
      for (int i = 0; i < corners; ++i)
        x += placed.position(mesh.cell(c)[i])[0] / corners;
      mesh.regions.push_back(x < 0.5 ? 0 : 1);
    }
    const fem::StressPatches patches = fem::stressPatches(mesh, elasticity, {{&u}}).front();
    const fem::RecoveryError apart = fem::recoveryError(mesh, elasticity, {{&u}}, {&patches});
    // What the little weights take from polynomials that are constants is rounding.
    EXPECT_LT(apart.error, 1e-24 * apart.energy) << fem::shapeOf(type).name;
    EXPECT_EQ(apart.cells.front().size(), static_cast<std::size_t>(mesh.numberOfCells()));
    mesh.regions.assign(mesh.regions.size(), 0);
    const fem::StressPatches one = fem::stressPatches(mesh, elasticity, {{&u}}).front();
    const fem::RecoveryError mixed = fem::recoveryError(mesh, elasticity, {{&u}}, {&one});
    EXPECT_GT(mixed.error, 1e-3 * mixed.energy) << fem::shapeOf(type).name;
  }
}

} // namespace test_recovery_error
