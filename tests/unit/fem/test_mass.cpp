// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Mass.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace test_mass {

using namespace Harmos;
using fem::CellType;
using fem::Point;

namespace {

const std::vector<CellType> types = {
    CellType::Triangle3,      CellType::Triangle6,     CellType::Quadrilateral4, CellType::Quadrilateral9,
    CellType::Tetrahedron4,   CellType::Tetrahedron10, CellType::Hexahedron8,    CellType::Hexahedron27,
    CellType::Quadrilateral8, CellType::Hexahedron20,  CellType::Wedge6,         CellType::Wedge15,
    CellType::Wedge18};

constexpr double pi = 3.141592653589793;

fem::PlacedMesh block(CellType type) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.elements = {3, 3, 2};
  options.size = {1.5, 1.0, 0.5};
  // The shear keeps volumes.
  options.map = [](const Point& x) { return Point{x[0] + 0.2 * x[1], x[1], x[2]}; };
  return fem::StructuredBlock(options).subdomain(0);
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

} // namespace

// Positive at every node, the body's mass in all, with its centre where it is.
TEST(LumpedMasses, every_element) {
  for (CellType type : types) {
    const fem::PlacedMesh placed = block(type);
    const std::vector<double> masses = fem::lumpedMasses(*placed.mesh, {3.0});
    const double size = fem::shapeOf(type).dimension == 2 ? 1.5 : 0.75;
    EXPECT_NEAR(sum(masses), 3.0 * size, 1e-13) << static_cast<int>(type);
    Point moment{};
    for (std::size_t node = 0; node < masses.size(); ++node) {
      EXPECT_GT(masses[node], 0.0) << static_cast<int>(type);
      for (std::size_t d = 0; d < 3; ++d)
        moment[d] += masses[node] * placed.position(static_cast<int>(node))[d];
    }
    const Point centre = {0.85, 0.5, fem::shapeOf(type).dimension == 2 ? 0.0 : 0.25};
    for (std::size_t d = 0; d < 3; ++d) // simplices are not symmetric: their centre is exact all the same
      EXPECT_NEAR(moment[d] / sum(masses), centre[d], 1e-13) << static_cast<int>(type);
  }
}

// Nodes of a surface without mass: the others take it; the centre stays where it is, and so do moments of
// inertia where there are layers of nodes enough.
TEST(LumpedMasses, massless_surface) {
  for (CellType type : types) {
    const fem::PlacedMesh placed = block(type);
    std::vector<char> massless(static_cast<std::size_t>(placed.mesh->numberOfNodes()), 0);
    for (std::size_t node = 0; node < massless.size(); ++node)
      massless[node] = placed.position(static_cast<int>(node))[1] < 1e-9;
    const std::vector<double> masses = fem::lumpedMasses(*placed.mesh, {3.0}, massless);
    const double size = fem::shapeOf(type).dimension == 2 ? 1.5 : 0.75;
    EXPECT_NEAR(sum(masses), 3.0 * size, 1e-13) << static_cast<int>(type);
    const std::vector<double> lumped = fem::lumpedMasses(*placed.mesh, {3.0});
    const int order = fem::shapeOf(type).order;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        double first = 0.0, second = 0.0;
        for (std::size_t node = 0; node < masses.size(); ++node) {
          const Point x = placed.position(static_cast<int>(node));
          first += (masses[node] - lumped[node]) * x[a];
          second += (masses[node] - lumped[node]) * x[a] * x[b];
        }
        EXPECT_NEAR(first, 0.0, 1e-13) << static_cast<int>(type);
        if (order == 2)
          EXPECT_NEAR(second, 0.0, 1e-13) << static_cast<int>(type);
      }
    for (std::size_t node = 0; node < masses.size(); ++node)
      EXPECT_EQ(massless[node] == 0, masses[node] > 0.0) << static_cast<int>(type);
  }
}

// Of two layers of nodes with mass the far one would have to have none: masses stay with the neighbours.
TEST(LumpedMasses, few_layers) {
  fem::StructuredBlock::Options options;
  options.cellType = CellType::Quadrilateral4;
  options.elements = {2, 2, 1};
  const fem::PlacedMesh placed = fem::StructuredBlock(options).subdomain(0);
  std::vector<char> massless(static_cast<std::size_t>(placed.mesh->numberOfNodes()), 0);
  for (std::size_t node = 0; node < massless.size(); ++node)
    massless[node] = placed.position(static_cast<int>(node))[1] < 1e-9;
  const std::vector<double> masses = fem::lumpedMasses(*placed.mesh, {1.0}, massless);
  EXPECT_NEAR(sum(masses), 1.0, 1e-14);
  for (std::size_t node = 0; node < masses.size(); ++node)
    EXPECT_EQ(massless[node] == 0, masses[node] > 0.0);
}

// A cell all of whose nodes are in contact gives its mass to the nearest that are not.
TEST(LumpedMasses, corner_cell) {
  const fem::PlacedMesh placed = block(CellType::Triangle3);
  std::vector<char> massless(static_cast<std::size_t>(placed.mesh->numberOfNodes()), 1);
  massless.back() = 0;
  const std::vector<double> masses = fem::lumpedMasses(*placed.mesh, {2.0}, massless);
  EXPECT_NEAR(masses.back(), 2.0 * 1.5, 1e-13);
  massless.back() = 1;
  EXPECT_TRUE(
      contains(inputErrorOf([&] { fem::lumpedMasses(*placed.mesh, {2.0}, massless); }), "fewer subdomains"));
}

// Of each region by its density; of bodies of revolution all around.
TEST(LumpedMasses, regions_and_revolution) {
  fem::Mesh mesh = *block(CellType::Quadrilateral4).mesh;
  for (int cell = 0; cell < mesh.numberOfCells(); ++cell)
    mesh.regions.push_back(cell % 3 == 0 ? 1 : 0);
  // A third of the cells, all of the same size, is three times as heavy.
  EXPECT_NEAR(sum(fem::lumpedMasses(mesh, {1.0, 3.0})), 1.5 * (2.0 / 3.0 + 1.0), 1e-13);
}

} // namespace test_mass
