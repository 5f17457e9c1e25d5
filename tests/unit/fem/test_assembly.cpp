// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Assembly.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace test_assembly {

using namespace Harmos;
using fem::makeRectangle;
using fem::StructuredBlock;

namespace {

double entry(const LocalMatrix& a, int i, int j) {
  for (std::size_t k = a.offsets[static_cast<std::size_t>(i)]; k < a.offsets[static_cast<std::size_t>(i) + 1];
       ++k)
    if (a.columns[k] == j)
      return a.values[k];
  return 0.0;
}

// Rounding in sums of a few products of numbers of order one.
constexpr double roundoff = 1e-14;

fem::PlacedMesh single(double width, double height, int n) {
  return makeRectangle({0, 0, 0}, {width, height}, {1, 1}, {n, n}, 0).subdomain(0);
}

std::vector<double> load(const fem::PlacedMesh& mesh, const fem::BoxLoad& box) {
  return fem::assembleLoad(*mesh.mesh, fem::localLoads(mesh, {box}));
}

} // namespace

// Closed form for the square: 2/3 on the diagonal, −1/6 along edges, −1/3 across.
TEST(Assembly, element_matrix_of_the_square) {
  const LocalMatrix k = fem::assembleLaplace(*single(0.37, 0.37, 1).mesh);
  EXPECT_NEAR(entry(k, 0, 0), 2.0 / 3.0, roundoff);
  EXPECT_NEAR(entry(k, 0, 1), -1.0 / 6.0, roundoff);
  EXPECT_NEAR(entry(k, 0, 2), -1.0 / 6.0, roundoff);
  EXPECT_NEAR(entry(k, 0, 3), -1.0 / 3.0, roundoff);
}

// Closed form for a rectangle of sides a, b: K_00 = (b/a + a/b)/3.
TEST(Assembly, element_matrix_of_a_rectangle) {
  const double a = 2.0, b = 0.5;
  const LocalMatrix k = fem::assembleLaplace(*single(a, b, 1).mesh);
  EXPECT_NEAR(entry(k, 0, 0), (b / a + a / b) / 3.0, 1e-13);
  EXPECT_NEAR(entry(k, 0, 1), (-2.0 * b / a + a / b) / 6.0, 1e-13);
  EXPECT_NEAR(entry(k, 0, 2), (b / a - 2.0 * a / b) / 6.0, 1e-13);
}

TEST(Assembly, inner_stencil_and_kernel) {
  const LocalMatrix k = fem::assembleLaplace(*single(1.0, 1.0, 4).mesh);
  const int centre = 2 * 5 + 2;
  EXPECT_NEAR(entry(k, centre, centre), 8.0 / 3.0, roundoff);
  for (int neighbour : {-6, -5, -4, -1, 1, 4, 5, 6})
    EXPECT_NEAR(entry(k, centre, centre + neighbour), -1.0 / 3.0, roundoff);
  std::vector<double> ones(25, 1.0), image(25);
  k.multiply(ones.data(), image.data());
  for (double value : image)
    EXPECT_NEAR(value, 0.0, roundoff);
}

// uᵀKu is the Dirichlet integral of any bilinear function, on a distorted mesh too (patch test): ∫|∇(2x +
// 3y)|² = 13.
TEST(Assembly, linear_functions_on_a_distorted_mesh) {
  fem::Mesh mesh = *single(1.0, 1.0, 2).mesh;
  mesh.coordinates[8] += 0.11; // the centre
  mesh.coordinates[9] -= 0.07;
  const LocalMatrix k = fem::assembleLaplace(mesh);
  std::vector<double> u, image(9);
  for (int node = 0; node < 9; ++node)
    u.push_back(2.0 * mesh.coordinates[static_cast<std::size_t>(2 * node)] +
                3.0 * mesh.coordinates[static_cast<std::size_t>(2 * node + 1)]);
  k.multiply(u.data(), image.data());
  EXPECT_NEAR(std::inner_product(u.begin(), u.end(), image.begin(), 0.0), 13.0, 1e-13);
  EXPECT_NEAR(image[4], 0.0, 1e-13); // no force inside
}

TEST(Assembly, inverted_cell_is_named) {
  fem::Mesh mesh = *single(1.0, 1.0, 2).mesh;
  std::swap(mesh.cells[13], mesh.cells[15]);
  try {
    fem::assembleLaplace(mesh);
    FAIL() << "nothing was thrown";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("cell 3 (quadrilateral of 4 nodes) is inverted"),
              std::string::npos);
  }
}

// The load of a box that cuts cells: total force and both first moments, which Q1 functions reproduce, are
// exact for every mesh, resolved jump or not. A one-point or nodal rule fails this.
TEST(Assembly, load_is_exact_whether_or_not_the_mesh_resolves_the_jump) {
  for (int n : {1, 2, 3, 4, 5, 7}) {
    const fem::PlacedMesh mesh = makeRectangle({1, 0, 0}, {1, 1}, {1, 1}, {n, n}, 0).subdomain(0);
    const std::vector<double> f = load(mesh, {-3.0, {1.0, 0.75}, {2.0, 1.0}});
    double force = 0.0, mx = 0.0, my = 0.0, mxy = 0.0;
    for (int node = 0; node < mesh.mesh->numberOfNodes(); ++node) {
      const fem::Point x = mesh.position(node);
      const double value = f[static_cast<std::size_t>(node)];
      force += value;
      mx += value * x[0];
      my += value * x[1];
      mxy += value * x[0] * x[1];
    }
    EXPECT_NEAR(force, -3.0 * 0.25, roundoff) << n;
    EXPECT_NEAR(mx, -3.0 * 0.25 * 1.5, roundoff) << n;
    EXPECT_NEAR(my, -3.0 * 0.25 * 0.875, roundoff) << n;
    EXPECT_NEAR(mxy, -3.0 * 0.25 * 1.5 * 0.875, roundoff) << n;
  }
}

// Nodal values of a cut element: ∫₀¹∫_{3/4}¹ of the bilinear functions of the unit square.
TEST(Assembly, load_of_one_cut_cell) {
  const std::vector<double> f = load(single(1.0, 1.0, 1), {1.0, {0.0, 0.75}, {1.0, 1.0}});
  const double low = 0.5 * (0.25 - 0.5 * (1.0 - 0.5625)), high = 0.5 * 0.5 * (1.0 - 0.5625);
  EXPECT_NEAR(f[0], low, roundoff);
  EXPECT_NEAR(f[1], low, roundoff);
  EXPECT_NEAR(f[2], high, roundoff);
  EXPECT_NEAR(f[3], high, roundoff);
}

TEST(Assembly, box_outside_gives_nothing) {
  EXPECT_TRUE(fem::localLoads(single(1.0, 1.0, 3), {{1.0, {2.0, 0.0}, {3.0, 1.0}}}).empty());
  for (double value : load(single(1.0, 1.0, 3), {1.0, {2.0, 0.0}, {3.0, 1.0}}))
    EXPECT_EQ(value, 0.0);
}

// What a load looks like from within does not depend on where the subdomain lies, if the box covers it.
TEST(Assembly, covered_subdomains_see_the_same_load) {
  const StructuredBlock rectangle = makeRectangle({0, 0, 0}, {1, 1}, {3, 3}, {2, 2}, 0);
  const std::vector<fem::BoxLoad> loads = {{2.0, {-1.0, -1.0}, {5.0, 5.0}}};
  const fem::BoxLoad first = fem::localLoads(rectangle.subdomain(0), loads).front();
  for (int s = 1; s < 9; ++s) {
    const fem::BoxLoad other = fem::localLoads(rectangle.subdomain(s), loads).front();
    EXPECT_EQ(first.least, other.least);
    EXPECT_EQ(first.most, other.most);
  }
}

// f_i = ∫ f φ_i: the sum is the whole force, the first moment that of the force, whatever the cells are.
TEST(Assembly, load_on_all_of_a_body_of_any_cells) {
  for (const fem::CellType type : {fem::CellType::Triangle3, fem::CellType::Triangle6,
                                   fem::CellType::Quadrilateral4, fem::CellType::Quadrilateral9}) {
    StructuredBlock::Options options;
    options.cellType = type;
    options.origin = {3.0, -1.0, 0.0};
    options.size = {2.0, 0.5, 1.0};
    options.elements = {3, 2, 1};
    const fem::PlacedMesh mesh = StructuredBlock(options).subdomain(0);
    const double all = 1e300, density = -1.5;
    const std::vector<double> f = load(mesh, {density, {-all, -all}, {all, all}});
    double force = 0.0, moment = 0.0;
    for (std::size_t i = 0; i < f.size(); ++i) {
      force += f[i];
      moment += f[i] * mesh.position(static_cast<int>(i))[0];
    }
    EXPECT_NEAR(force, density * 1.0, 1e-13) << fem::shapeOf(type).name;
    EXPECT_NEAR(moment, density * 1.0 * 4.0, 1e-12) << fem::shapeOf(type).name;
  }
}

} // namespace test_assembly
