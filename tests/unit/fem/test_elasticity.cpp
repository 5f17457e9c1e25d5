// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Elasticity.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Loads.hpp"
#include "Harmos_StrainOperator.hpp"
#include "Harmos_StressSums.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace test_elasticity {

using namespace Harmos;
using fem::CellType;
using fem::Kinematics;
using fem::Material;
using fem::Point;
using fem::Voigt;
using fem::VoigtMatrix;

namespace {

// Rounding in sums of some dozens of products of numbers of order one.
constexpr double roundoff = 1e-13;

const std::vector<CellType> types = {
    CellType::Triangle3,      CellType::Triangle6,     CellType::Quadrilateral4, CellType::Quadrilateral9,
    CellType::Tetrahedron4,   CellType::Tetrahedron10, CellType::Hexahedron8,    CellType::Hexahedron27,
    CellType::Quadrilateral8, CellType::Hexahedron20,  CellType::Wedge6,         CellType::Wedge15,
    CellType::Wedge18};

Kinematics kinematicsOf(CellType type) {
  return fem::shapeOf(type).dimension == 2 ? Kinematics::PlaneStrain : Kinematics::Solid;
}

fem::PlacedMesh bent(CellType type) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.elements = {3, 2, 2};
  options.size = {1.5, 1.0, 0.5};
  options.map = [](const Point& x) {
    return Point{x[0] + 0.1 * std::sin(2.0 * x[1]), x[1] - 0.1 * std::sin(3.0 * x[0]),
                 x[2] + 0.02 * x[0] * x[2]};
  };
  return fem::StructuredBlock(options).subdomain(0);
}

std::vector<double> nodal(const fem::PlacedMesh& mesh, const fem::VectorField& field) {
  std::vector<double> u;
  for (int node = 0; node < mesh.mesh->numberOfNodes(); ++node)
    for (int c = 0; c < mesh.mesh->dimension(); ++c)
      u.push_back(field(mesh.position(node))[static_cast<std::size_t>(c)]);
  return u;
}

Material orthotropic(double angle) {
  Material material;
  material.young = {10.0, 2.0, 1.0};
  material.poisson = {0.3, 0.2, 0.25};
  material.shear = {1.5, 0.8, 0.6};
  material.angle = angle;
  material.expansion = {1e-3, 3e-3, 2e-3};
  return material;
}

} // namespace

// λ and μ of an isotropic material; plane stress E/(1 − ν²).
TEST(Material, isotropic_stiffness) {
  const double e = 3.0, nu = 0.3, lambda = e * nu / ((1 + nu) * (1 - 2 * nu)), mu = e / (2 * (1 + nu));
  const Material material = Material::isotropic(e, nu);
  for (double angle : {0.0, 0.7}) {
    Material turned = material;
    turned.angle = angle;
    const VoigtMatrix c = turned.stiffness(Kinematics::Solid);
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t b = 0; b < 6; ++b) {
        const double expected = a < 3 && b < 3 ? lambda + (a == b ? 2 * mu : 0.0) : a == b ? mu : 0.0;
        EXPECT_NEAR(c[a][b], expected, 10 * roundoff) << a << b;
      }
  }
  const VoigtMatrix plane = material.stiffness(Kinematics::PlaneStress);
  EXPECT_NEAR(plane[0][0], e / (1 - nu * nu), roundoff);
  EXPECT_NEAR(plane[0][1], nu * e / (1 - nu * nu), roundoff);
  EXPECT_NEAR(plane[3][3], mu, roundoff);
  EXPECT_EQ(plane[2][2], 0.0);
}

// A quarter turn exchanges the axes; uniaxial stress along axis 1 gives strains σ/E_1 and −ν_12 σ/E_1.
TEST(Material, orthotropic_axes) {
  const double quarter = std::acos(0.0);
  const VoigtMatrix c = orthotropic(0.0).stiffness(Kinematics::Solid),
                    t = orthotropic(quarter).stiffness(Kinematics::Solid);
  EXPECT_NEAR(c[0][0], t[1][1], 100 * roundoff);
  EXPECT_NEAR(c[1][1], t[0][0], 100 * roundoff);
  EXPECT_NEAR(c[0][2], t[1][2], 100 * roundoff);
  EXPECT_NEAR(c[4][4], t[5][5], 100 * roundoff);
  EXPECT_NEAR(c[3][3], t[3][3], 100 * roundoff);
  // C ε for the strain of uniaxial stress.
  const Voigt strain = {0.1, -0.03, -0.02, 0.0, 0.0, 0.0}; // ν_12 = 0.3, ν_13 = 0.2
  for (std::size_t r = 0; r < 6; ++r) {
    double s = 0.0;
    for (std::size_t q = 0; q < 6; ++q)
      s += c[r][q] * strain[q];
    EXPECT_NEAR(s, r == 0 ? 1.0 : 0.0, roundoff) << r;
  }
}

// Energy ½ εᵀCε does not depend on the axes it is computed in.
TEST(Material, turning_the_material_is_turning_the_strain_back) {
  const double a = 0.3, c = std::cos(a), s = std::sin(a);
  const double e[2][2] = {{0.3, 0.1}, {0.1, -0.2}};
  double turned[2][2] = {};
  const double q[2][2] = {{c, s}, {-s, c}}; // to the material's axes
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l)
          turned[i][j] += q[i][k] * e[k][l] * q[j][l];
  const auto energy = [](const VoigtMatrix& m, const double(&x)[2][2]) {
    const Voigt v = {x[0][0], x[1][1], 0.0, 2 * x[0][1], 0.0, 0.0};
    double sum = 0.0;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j)
        sum += 0.5 * v[i] * m[i][j] * v[j];
    return sum;
  };
  for (Kinematics kinematics : {Kinematics::Solid, Kinematics::PlaneStress})
    EXPECT_NEAR(energy(orthotropic(a).stiffness(kinematics), e),
                energy(orthotropic(0.0).stiffness(kinematics), turned), roundoff);
}

TEST(Material, values_out_of_range_are_named) {
  const auto failure = [](Material material) { return inputErrorOf([&] { material.check("steel"); }); };
  EXPECT_EQ(failure(Material::isotropic(1.0, 0.3)), "");
  EXPECT_NE(failure(Material::isotropic(-1.0, 0.3)).find("material \"steel\": Young's modulus 1 is"),
            std::string::npos);
  EXPECT_NE(failure(Material::isotropic(1.0, 0.5)).find("Poisson's ratio is 5"), std::string::npos);
  EXPECT_NE(failure(Material::isotropic(1.0, -1.0)), "");
  EXPECT_NE(failure(Material::isotropic(std::nan(""), 0.3)), "");
  Material material = orthotropic(0.0);
  EXPECT_EQ(failure(material), "");
  material.poisson[0] = 2.3; // |ν_12| < √(E_1/E_2) = 2.236
  EXPECT_NE(failure(material).find("positive definite"), std::string::npos);
}

TEST(Elasticity, rigid_motions_are_free_and_linear_fields_have_their_energy) {
  for (CellType type : types)
    for (fem::Dilatation dilatation : {fem::Dilatation::Full, fem::Dilatation::Projected}) {
      const fem::PlacedMesh mesh = bent(type);
      const fem::Elasticity elasticity{kinematicsOf(type), dilatation, {orthotropic(0.4)}};
      const LocalMatrix k = fem::assembleElasticity(*mesh.mesh, elasticity);
      const bool isSpace = mesh.mesh->dimension() == 3;
      const std::vector<double> turn = nodal(mesh, [&](const Point& x) {
        return Point{0.3 - 0.7 * x[1] + (isSpace ? 0.4 * x[2] : 0.0),
                     0.1 + 0.7 * x[0] - (isSpace ? 0.2 * x[2] : 0.0), -0.4 * x[0] + 0.2 * x[1]};
      });
      std::vector<double> image(turn.size());
      k.multiply(turn.data(), image.data());
      for (double value : image)
        EXPECT_NEAR(value, 0.0, 1e-12 * k.maxNorm()) << fem::shapeOf(type).name;
      // ½∫ε:C:ε of a linear field: the size of the mesh, from a body force of one, times the density.
      const std::vector<double> u = nodal(mesh, [](const Point& x) {
        return Point{0.2 * x[0] + 0.1 * x[1], 0.3 * x[1] - 0.1 * x[2], 0.4 * x[2]};
      });
      const Voigt strain =
          isSpace ? Voigt{0.2, 0.3, 0.4, 0.1, -0.1, 0.0} : Voigt{0.2, 0.3, 0.0, 0.1, 0.0, 0.0};
      const VoigtMatrix c = elasticity.materials[0].stiffness(elasticity.kinematics);
      double density = 0.0, size = 0.0;
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t q = 0; q < 6; ++q)
          density += strain[r] * c[r][q] * strain[q];
      for (double f : fem::assembleBodyForce(*mesh.mesh, mesh.anchor, [](const Point&) {
             return Point{1.0, 0, 0};
           }))
        size += f;
      k.multiply(u.data(), image.data());
      const double energy = std::inner_product(u.begin(), u.end(), image.begin(), 0.0);
      EXPECT_NEAR(energy, density * size, 1e-11 * density * size) << fem::shapeOf(type).name;
      // Stresses of a linear field are constant.
      const fem::StressSums sums = fem::stressSums(*mesh.mesh, elasticity, {{&u}}).front();
      for (std::size_t node = 0; node < sums.size.size(); ++node)
        for (std::size_t r = 0; r < (isSpace ? 6u : 4u); ++r) {
          double expected = 0.0;
          for (std::size_t q = 0; q < 6; ++q)
            expected += c[r][q] * strain[q];
          EXPECT_NEAR(sums.weighted[node][r] / sums.size[node], expected, 1e-10) << fem::shapeOf(type).name;
        }
    }
}

// A closed surface under constant pressure is in equilibrium, and so is one under any constant traction with
// the volume force that balances it: ∫∂ x·n = d · volume.
TEST(Elasticity, tractions_over_closed_surfaces) {
  for (CellType type : types) {
    const fem::PlacedMesh mesh = bent(type);
    const std::vector<fem::Side> sides = fem::boundarySides(*mesh.mesh);
    const int d = mesh.mesh->dimension();
    Point force{};
    const std::vector<double> pressure =
        fem::assembleTraction(*mesh.mesh, mesh.anchor, sides, [](const Point&, const Point& n) {
          return Point{-n[0], -n[1], -n[2]};
        });
    for (std::size_t k = 0; k < pressure.size(); ++k)
      force[k % static_cast<std::size_t>(d)] += pressure[k];
    for (double component : force)
      EXPECT_NEAR(component, 0.0, roundoff) << fem::shapeOf(type).name;
    double flux = 0.0, size = 0.0;
    const std::vector<double> outward =
        fem::assembleTraction(*mesh.mesh, mesh.anchor, sides, [](const Point& x, const Point& n) {
          return Point{x[0] * n[0] + x[1] * n[1] + x[2] * n[2], 0.0, 0.0};
        });
    for (double f : outward)
      flux += f;
    for (double f : fem::assembleBodyForce(*mesh.mesh, mesh.anchor, [](const Point&) {
           return Point{1.0, 0, 0};
         }))
      size += f;
    EXPECT_NEAR(flux, d * size, 1e-11) << fem::shapeOf(type).name;
  }
}

// Free expansion: K u = f_T for u = the thermal strain times x, without stress.
TEST(Elasticity, free_thermal_expansion_is_without_stress) {
  for (CellType type : types) {
    const fem::PlacedMesh mesh = bent(type);
    const bool isSpace = mesh.mesh->dimension() == 3;
    // In plane strain the expansion along z is held back; plane stress leaves it free.
    const fem::Elasticity elasticity{
        isSpace ? Kinematics::Solid : Kinematics::PlaneStress, fem::Dilatation::Full, {orthotropic(0.4)}};
    const Voigt e = elasticity.materials[0].thermalStrain();
    const std::vector<double> u = nodal(mesh, [&](const Point& x) {
      return Point{20 * (e[0] * x[0] + 0.5 * e[3] * x[1]), 20 * (0.5 * e[3] * x[0] + e[1] * x[1]),
                   20 * e[2] * x[2]};
    });
    const LocalMatrix k = fem::assembleElasticity(*mesh.mesh, elasticity);
    std::vector<double> image(u.size());
    k.multiply(u.data(), image.data());
    const std::vector<double> f = fem::assembleThermalLoad(*mesh.mesh, elasticity, 20.0);
    for (std::size_t i = 0; i < f.size(); ++i)
      EXPECT_NEAR(image[i], f[i], 1e-12) << fem::shapeOf(type).name;
    const fem::StressSums sums = fem::stressSums(*mesh.mesh, elasticity, {{&u, 20.0}}).front();
    for (const Voigt& s : sums.weighted)
      for (double component : s)
        EXPECT_NEAR(component, 0.0, 1e-12) << fem::shapeOf(type).name;
  }
}

// Bars of two materials in a row: regions have stiffnesses of their own.
TEST(Elasticity, regions_have_their_materials) {
  fem::StructuredBlock::Options options;
  options.elements = {2, 1, 1};
  fem::Mesh mesh = *fem::StructuredBlock(options).subdomain(0).mesh;
  mesh.regions = {0, 1};
  const fem::Elasticity both{Kinematics::PlaneStress,
                             fem::Dilatation::Full,
                             {Material::isotropic(1.0, 0.0), Material::isotropic(3.0, 0.0)}};
  const LocalMatrix k = fem::assembleElasticity(mesh, both);
  // u_x = x in the left cell, constant in the right one; force on the middle line = −E_1 · 1.
  std::vector<double> u, image(12);
  for (int node = 0; node < 6; ++node) {
    u.push_back(std::min(0.5, mesh.local(node)[0]));
    u.push_back(0.0);
  }
  k.multiply(u.data(), image.data());
  EXPECT_NEAR(image[2] + image[8], 1.0, roundoff);
  EXPECT_NEAR(image[4] + image[10], 0.0, roundoff);
}

// Axes anywhere: about z they are what the angle is; a strain that turns with the axes keeps its energy.
TEST(Material, axes_in_space) {
  const double angle = 0.4;
  const Material about = orthotropic(angle);
  const Material same =
      orthotropic(0.0).turnedTo({2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.0}, {-1.0, 5.0, 0.0});
  for (Kinematics kinematics : {Kinematics::Solid, Kinematics::PlaneStrain, Kinematics::PlaneStress}) {
    const VoigtMatrix a = about.stiffness(kinematics), b = same.stiffness(kinematics);
    for (std::size_t r = 0; r < 6; ++r)
      for (std::size_t s = 0; s < 6; ++s)
        EXPECT_NEAR(a[r][s], b[r][s], roundoff * 10.0) << r << s;
  }
  // Uniaxial stress along axis 1 strains by 1/E_1 along it and −ν_12/E_1 across, wherever it points.
  const Point first = {2.0 / 3, 1.0 / 3, 2.0 / 3}, second = {-2.0 / 3, 2.0 / 3, 1.0 / 3};
  const Material turned = orthotropic(0.0).turnedTo(first, second);
  const auto along = [](const Voigt& e, const Point& d) {
    return e[0] * d[0] * d[0] + e[1] * d[1] * d[1] + e[2] * d[2] * d[2] + e[3] * d[0] * d[1] +
           e[4] * d[1] * d[2] + e[5] * d[0] * d[2];
  };
  std::vector<double> c;
  for (const Voigt& row : turned.stiffness(Kinematics::Solid))
    c.insert(c.end(), row.begin(), row.end());
  Voigt strain = {first[0] * first[0], first[1] * first[1], first[2] * first[2],
                  first[0] * first[1], first[1] * first[2], first[0] * first[2]};
  fem::solveSmall(6, c, 1, strain.data());
  EXPECT_NEAR(along(strain, first), 1.0 / turned.young[0], roundoff);
  EXPECT_NEAR(along(strain, second), -turned.poisson[0] / turned.young[0], roundoff);
  EXPECT_TRUE(contains(inputErrorOf([&] { orthotropic(0.0).turnedTo({1, 0, 0}, {2, 0, 0}); }), "parallel"));
}

// By its stiffness an orthotropic material is the same; moduli come from the inverse.
TEST(Material, anisotropic) {
  const Material given = orthotropic(0.0);
  Material same = Material::anisotropic(given.stiffness(Kinematics::Solid));
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(same.young[k], given.young[k], roundoff * 10.0);
    EXPECT_NEAR(same.poisson[k], given.poisson[k], roundoff);
    EXPECT_NEAR(same.shear[k], given.shear[k], roundoff);
  }
  same.angle = 0.7;
  const VoigtMatrix a = orthotropic(0.7).stiffness(Kinematics::PlaneStress),
                    b = same.stiffness(Kinematics::PlaneStress);
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t s = 0; s < 6; ++s)
      EXPECT_NEAR(a[r][s], b[r][s], roundoff * 10.0) << r << s;
  VoigtMatrix indefinite = given.stiffness(Kinematics::Solid);
  indefinite[3][3] = -1.0;
  EXPECT_TRUE(contains(inputErrorOf([&] { Material::anisotropic(indefinite); }), "positive definite"));
}

} // namespace test_elasticity
