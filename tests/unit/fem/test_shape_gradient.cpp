// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ShapeGradient.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>

namespace test_shape_gradient {

using namespace Harmos;
using fem::CellType;
using fem::Dilatation;
using fem::Elasticity;
using fem::Kinematics;
using fem::Material;
using fem::Point;

namespace {

const std::vector<CellType> types = {
    CellType::Triangle3,      CellType::Triangle6,     CellType::Quadrilateral4, CellType::Quadrilateral9,
    CellType::Tetrahedron4,   CellType::Tetrahedron10, CellType::Hexahedron8,    CellType::Hexahedron27,
    CellType::Quadrilateral8, CellType::Hexahedron20,  CellType::Wedge6,         CellType::Wedge15,
    CellType::Wedge18};

class RandomNumbers {
 public:
  std::vector<double> between(double low, double high, std::size_t count) {
    std::vector<double> values(count);
    for (double& value : values)
      value = low + (high - low) * static_cast<double>(generator_()) / 4294967296.0;
    return values;
  }

 private:
  std::mt19937 generator_{7};
};

void add(double factor, const std::vector<double>& x, std::vector<double>& y) {
  for (std::size_t i = 0; i < x.size(); ++i)
    y[i] += factor * x[i];
}

double dot(const std::vector<double>& x, const std::vector<double>& y) {
  return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
}

double dotOfModuli(const std::vector<double>& x, const std::vector<double>& y) {
  return std::inner_product(x.begin(), x.end(), y.begin(), 0.0, std::plus<>(),
                            [](double a, double b) { return std::abs(a * b); });
}

// Cells that are bent and none like another, in two regions.
fem::Mesh distorted(CellType type, RandomNumbers& random) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.elements = {2, 2, 1};
  options.size = {1.2, 1.0, 0.6};
  options.map = [](const Point& x) {
    return Point{x[0] + 0.1 * std::sin(2.0 * x[1]), x[1] - 0.1 * std::sin(3.0 * x[0]),
                 x[2] + 0.1 * x[0] * x[2]};
  };
  fem::Mesh mesh = *fem::StructuredBlock(options).subdomain(0).mesh;
  // By a twelfth of the distance of nodes of the second order: by more, some simplices get nearly flat.
  add(1.0, random.between(-0.02, 0.02, mesh.coordinates.size()), mesh.coordinates);
  for (int c = 0; c < mesh.numberOfCells(); ++c)
    mesh.regions.push_back(c % 2);
  return mesh;
}

Material orthotropic() {
  Material material;
  material.young = {10.0, 2.0, 1.0};
  material.poisson = {0.3, 0.2, 0.25};
  material.shear = {1.5, 0.8, 0.6};
  material.angle = 0.4;
  return material;
}

std::vector<Elasticity> laws(CellType type, const std::vector<Material>& materials) {
  if (fem::shapeOf(type).dimension == 3)
    return {{Kinematics::Solid, Dilatation::Full, materials},
            {Kinematics::Solid, Dilatation::Projected, materials}};
  return {{Kinematics::PlaneStrain, Dilatation::Full, materials},
          {Kinematics::PlaneStrain, Dilatation::Projected, materials},
          {Kinematics::PlaneStress, Dilatation::Full, materials},
          {Kinematics::PlaneStress, Dilatation::Projected, materials}};
}

double product(const fem::Mesh& mesh, const Elasticity& law, const std::vector<double>& v,
               const std::vector<double>& u) {
  std::vector<double> image(u.size());
  fem::assembleElasticity(mesh, law).multiply(u.data(), image.data());
  return dot(v, image);
}

// Of fourth order: with steps of 1/1000 of the distance of nodes the error is some 120 · 1e-12 of the
// derivative, and of rounding some 1e-16 · 1e4.
double differenceQuotient(const std::function<double(const fem::Mesh&)>& f, const fem::Mesh& mesh,
                          const std::vector<double>& direction) {
  constexpr double h = 2e-4;
  const auto at = [&](double factor) {
    fem::Mesh moved = mesh;
    add(factor * h, direction, moved.coordinates);
    return f(moved);
  };
  return (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
}

// Tolerance of differences: what is said there, and a hundred terms that cancel.
constexpr double byDifferences = 1e-9;

std::string nameOf(CellType type, const Elasticity& law) {
  return fem::shapeOf(type).name + ", kinematics " + std::to_string(static_cast<int>(law.kinematics)) +
         (law.dilatation == Dilatation::Projected ? ", projected" : "");
}

// ω × x of each node.
std::vector<double> turned(const std::vector<double>& x, int dimension, const Point& omega) {
  std::vector<double> result;
  for (std::size_t i = 0; i < x.size(); i += static_cast<std::size_t>(dimension))
    if (dimension == 2)
      result.insert(result.end(), {-omega[2] * x[i + 1], omega[2] * x[i]});
    else
      result.insert(result.end(),
                    {omega[1] * x[i + 2] - omega[2] * x[i + 1], omega[2] * x[i] - omega[0] * x[i + 2],
                     omega[0] * x[i + 1] - omega[1] * x[i]});
  return result;
}

} // namespace

TEST(ShapeGradient, is_the_derivative_of_the_matrix) {
  RandomNumbers random;
  for (CellType type : types)
    for (const Elasticity& law : laws(type, {orthotropic(), Material::isotropic(2.0, 0.49)})) {
      const fem::Mesh mesh = distorted(type, random);
      const std::size_t n = mesh.coordinates.size();
      const std::vector<double> u = random.between(-1.0, 1.0, n), v = random.between(-1.0, 1.0, n);
      const std::vector<double> gradient = fem::shapeGradient(mesh, law, v, u);
      const auto value = [&](const fem::Mesh& moved) { return product(moved, law, v, u); };
      for (int trial = 0; trial < 3; ++trial) {
        const std::vector<double> motion = random.between(-1.0, 1.0, n);
        EXPECT_NEAR(dot(gradient, motion), differenceQuotient(value, mesh, motion),
                    byDifferences * dotOfModuli(gradient, motion))
            << nameOf(type, law);
      }
    }
}

// Of one node at a time, so that no error of another hides it: on one cell of those with most to project.
TEST(ShapeGradient, of_each_node_of_a_cell) {
  RandomNumbers random;
  for (CellType type : {CellType::Quadrilateral9, CellType::Hexahedron8}) {
    fem::Mesh mesh = distorted(type, random);
    mesh.cells.resize(static_cast<std::size_t>(mesh.nodesPerCell()));
    const Elasticity law = laws(type, {Material::isotropic(2.0, 0.4)})[1];
    const std::size_t n = mesh.coordinates.size();
    const std::vector<double> u = random.between(-1.0, 1.0, n), v = random.between(-1.0, 1.0, n);
    const std::vector<double> gradient = fem::shapeGradient(mesh, law, v, u);
    const auto value = [&](const fem::Mesh& moved) { return product(moved, law, v, u); };
    double most = 0.0;
    for (double s : gradient)
      most = std::max(most, std::abs(s));
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<double> motion(n, 0.0);
      motion[i] = 1.0;
      EXPECT_NEAR(gradient[i], differenceQuotient(value, mesh, motion), byDifferences * most)
          << fem::shapeOf(type).name << " " << i;
    }
  }
}

TEST(ShapeGradient, exchange_of_the_fields_changes_nothing) {
  RandomNumbers random;
  const fem::Mesh mesh = distorted(CellType::Quadrilateral9, random);
  const std::size_t n = mesh.coordinates.size();
  const std::vector<double> u = random.between(-1.0, 1.0, n), v = random.between(-1.0, 1.0, n);
  for (const Elasticity& law : laws(mesh.cellType, {orthotropic(), orthotropic()})) {
    const std::vector<double> one = fem::shapeGradient(mesh, law, v, u),
                              other = fem::shapeGradient(mesh, law, u, v);
    double most = 0.0;
    for (double s : one)
      most = std::max(most, std::abs(s));
    // Rounding in sums of some hundreds of products.
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(one[i], other[i], 1e-13 * most) << nameOf(mesh.cellType, law);
  }
}

// K does not change when a mesh is moved as a whole; v·Ku not when mesh and fields are turned alike; and K
// grows with the length to the power d − 2. To rounding of some thousands of terms.
TEST(ShapeGradient, rigid_motions_and_scaling) {
  constexpr double roundoff = 1e-12;
  RandomNumbers random;
  const Point omega = {0.3, -0.5, 0.8};
  for (CellType type : types)
    for (const Elasticity& law :
         laws(type, {Material::isotropic(1.0, 0.3), Material::isotropic(2.0, 0.45)})) {
      const fem::Mesh mesh = distorted(type, random);
      const int d = mesh.dimension();
      const std::size_t n = mesh.coordinates.size();
      const std::vector<double> u = random.between(-1.0, 1.0, n), v = random.between(-1.0, 1.0, n);
      const std::vector<double> gradient = fem::shapeGradient(mesh, law, v, u);
      for (int k = 0; k < d; ++k) {
        std::vector<double> shift(n, 0.0);
        for (std::size_t i = static_cast<std::size_t>(k); i < n; i += static_cast<std::size_t>(d))
          shift[i] = 1.0;
        EXPECT_NEAR(dot(gradient, shift), 0.0, roundoff * dotOfModuli(gradient, shift)) << nameOf(type, law);
      }
      const std::vector<double> turn = turned(mesh.coordinates, d, omega);
      EXPECT_NEAR(dot(gradient, turn) + product(mesh, law, turned(v, d, omega), u) +
                      product(mesh, law, v, turned(u, d, omega)),
                  0.0, roundoff * dotOfModuli(gradient, turn))
          << nameOf(type, law);
      EXPECT_NEAR(dot(gradient, mesh.coordinates), (d - 2) * product(mesh, law, v, u),
                  roundoff * dotOfModuli(gradient, mesh.coordinates))
          << nameOf(type, law);
    }
}

// A square of side 1, a brick, one whose upper side is bent to a parabola; and what is within moves for
// nothing.
TEST(ShapeGradient, measures_and_their_derivatives) {
  RandomNumbers random;
  for (CellType type : types) {
    const fem::CellShape& shape = fem::shapeOf(type);
    fem::StructuredBlock::Options options;
    options.cellType = type;
    options.elements = {2, 2, 2};
    options.size = {1.5, 1.0, 0.5};
    fem::Mesh mesh = *fem::StructuredBlock(options).subdomain(0).mesh;
    const double size = shape.dimension == 2 ? 1.5 : 0.75;
    EXPECT_NEAR(fem::measureOf(mesh), size, 1e-14) << shape.name;
    if (shape.order == 2) {
      // y grows by y x (1.5 − x), whose mean over x is 1.5² / 6: the second order has all of that.
      const auto d = static_cast<std::size_t>(shape.dimension);
      for (std::size_t i = 0; i < mesh.coordinates.size(); i += d)
        if (!shape.isSimplex) // products of three are no polynomials of degree 2
          mesh.coordinates[i + 1] *= 1.0 + mesh.coordinates[i] * (1.5 - mesh.coordinates[i]);
      if (!shape.isSimplex) {
        EXPECT_NEAR(fem::measureOf(mesh), size * (1.0 + 1.5 * 1.5 / 6.0), 1e-14) << shape.name;
      }
    }
    mesh = distorted(type, random);
    const std::vector<double> gradient = fem::shapeGradientOfMeasure(mesh);
    const std::vector<double> motion = random.between(-1.0, 1.0, mesh.coordinates.size());
    EXPECT_NEAR(dot(gradient, motion), differenceQuotient(fem::measureOf, mesh, motion),
                byDifferences * dotOfModuli(gradient, motion))
        << shape.name;
    // Euler's theorem: the size is of degree d in the coordinates.
    EXPECT_NEAR(dot(gradient, mesh.coordinates), shape.dimension * fem::measureOf(mesh), 1e-13) << shape.name;
    for (int node = 0; node < mesh.numberOfNodes(); ++node)
      if (!std::binary_search(mesh.boundary.begin(), mesh.boundary.end(), node))
        for (int k = 0; k < shape.dimension; ++k)
          EXPECT_NEAR(gradient[static_cast<std::size_t>(node * shape.dimension + k)], 0.0, 1e-14)
              << shape.name << " " << node;
  }
}

TEST(ShapeGradient, errors_are_named) {
  fem::Mesh mesh = *fem::makeRectangle({}, {1.0, 1.0}, {1, 1}, {1, 1}, 0).subdomain(0).mesh;
  const Elasticity law{Kinematics::PlaneStrain, Dilatation::Full, {Material::isotropic(1.0, 0.3)}};
  const std::vector<double> u(8, 1.0);
  EXPECT_THROW(fem::shapeGradient(mesh, law, u, std::vector<double>(7, 1.0)), InternalError);
  EXPECT_THROW(fem::shapeGradient(mesh, law, std::vector<double>(4, 1.0), u), InternalError);
  EXPECT_THROW(fem::shapeGradient(mesh, {Kinematics::PlaneStrain, Dilatation::Full, {}}, u, u),
               InternalError);
  mesh.coordinates[0] = 2.0; // the first corner beyond the opposite side
  for (const auto& call : std::vector<std::function<void()>>{[&] { fem::shapeGradient(mesh, law, u, u); },
                                                             [&] { fem::measureOf(mesh); },
                                                             [&] { fem::shapeGradientOfMeasure(mesh); }})
    EXPECT_TRUE(contains(numericalErrorOf(call), "cell 0 (quadrilateral of 4 nodes) is inverted"))
        << numericalErrorOf(call);
}

} // namespace test_shape_gradient
