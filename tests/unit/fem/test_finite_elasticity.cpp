// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ElasticLaw.hpp"
#include "Harmos_FiniteElasticity.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_finite_elasticity {

using namespace Harmos;
using fem::CellType;
using fem::Kinematics;
using fem::Material;
using fem::Point;
using fem::Voigt;

namespace {

const std::vector<CellType> types = {
    CellType::Triangle3,      CellType::Triangle6,     CellType::Quadrilateral4, CellType::Quadrilateral9,
    CellType::Tetrahedron4,   CellType::Tetrahedron10, CellType::Hexahedron8,    CellType::Hexahedron27,
    CellType::Quadrilateral8, CellType::Hexahedron20,  CellType::Wedge6,         CellType::Wedge15,
    CellType::Wedge18};

Material materialOf(Material::Law law) {
  Material material = Material::isotropic(3.0, 0.3);
  material.law = law;
  material.expansion = {0.2, 0.2, 0.2};
  return material;
}

Material orthotropic() {
  Material material;
  material.young = {10.0, 2.0, 1.0};
  material.poisson = {0.3, 0.2, 0.25};
  material.shear = {1.5, 0.8, 0.6};
  material.angle = 0.5;
  material.expansion = {0.3, 0.1, -0.2};
  return material;
}

// Temperatures of which free expansions are large.
constexpr std::array<double, 3> rises = {0.0, 0.8, -0.5};

fem::TemperatureRise warm(const fem::Mesh& mesh, double rise) {
  if (rise == 0.0)
    return {};
  auto nodal = std::make_shared<std::vector<double>>();
  for (int node = 0; node < mesh.numberOfNodes(); ++node)
    nodal->push_back(0.3 * rise * mesh.local(node)[0]);
  return {0.5 * rise, nodal};
}

// Off the axis, so that it can go around one.
fem::Mesh meshOf(CellType type, bool isAxisymmetric) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.elements = {2, 2, 1};
  options.size = {1.0, 1.0, 0.5};
  options.map = [](const Point& x) {
    return Point{1.0 + x[0] + 0.1 * std::sin(2.0 * x[1]), x[1] - 0.1 * std::sin(3.0 * x[0]),
                 x[2] + 0.02 * x[0] * x[2]};
  };
  const fem::PlacedMesh placed = fem::StructuredBlock(options).subdomain(0);
  fem::Mesh mesh = *placed.mesh;
  for (int node = 0; node < mesh.numberOfNodes(); ++node)
    for (int d = 0; d < mesh.dimension(); ++d)
      mesh.coordinates[static_cast<std::size_t>(node * mesh.dimension() + d)] =
          placed.position(node)[static_cast<std::size_t>(d)];
  mesh.isAxisymmetric = isAxisymmetric;
  return mesh;
}

// A kinematics for a mesh, and whether its dilatation is projected.
struct Case {
  CellType type;
  Kinematics kinematics;
  fem::Dilatation dilatation;
  Material material;
  std::string name() const {
    return fem::shapeOf(type).name + ", kinematics " + std::to_string(static_cast<int>(kinematics)) +
           (dilatation == fem::Dilatation::Projected ? ", projected" : "") +
           (material.law == Material::Law::NeoHookean ? ", neo-Hookean" : "");
  }
  bool isAxisymmetric() const { return kinematics == Kinematics::Axisymmetric; }
  fem::Elasticity elasticity() const {
    fem::Elasticity result;
    result.kinematics = kinematics;
    result.dilatation = dilatation;
    result.materials = {material};
    result.strains = fem::Strains::Finite;
    return result;
  }
};

std::vector<Case> allCases() {
  std::vector<Case> cases;
  for (const CellType type : types)
    for (const Kinematics kinematics :
         fem::shapeOf(type).dimension == 3
             ? std::vector<Kinematics>{Kinematics::Solid}
             : std::vector<Kinematics>{Kinematics::PlaneStrain, Kinematics::PlaneStress,
                                       Kinematics::Axisymmetric})
      for (const fem::Dilatation dilatation : {fem::Dilatation::Full, fem::Dilatation::Projected})
        for (const Material& material :
             {materialOf(Material::Law::Linear), materialOf(Material::Law::NeoHookean), orthotropic()})
          cases.push_back({type, kinematics, dilatation, material});
  return cases;
}

std::vector<double> nodal(const fem::Mesh& mesh, const std::function<Point(const Point&)>& field) {
  std::vector<double> u;
  for (int node = 0; node < mesh.numberOfNodes(); ++node) {
    const Point value = field(mesh.local(node));
    u.insert(u.end(), value.begin(), value.begin() + mesh.dimension());
  }
  return u;
}

Point large(const Point& x) {
  return {0.2 * x[0] + 0.3 * std::sin(x[1]), 0.25 * x[0] * x[1] - 0.1 * x[1], 0.1 * x[0] * x[2] - 0.2 * x[1]};
}

std::vector<std::pair<Kinematics, double>> withRises(const std::vector<Kinematics>& all) {
  std::vector<std::pair<Kinematics, double>> result;
  for (const Kinematics kinematics : all)
    for (const double rise : rises)
      result.emplace_back(kinematics, rise);
  return result;
}

double largest(const std::vector<double>& values) {
  double result = 0.0;
  for (const double value : values)
    result = std::max(result, std::abs(value));
  return result;
}

} // namespace

// S = ∂W/∂E and its tangent, by central differences of steps h: errors ε/h, 1e-11, and h² times the third
// derivatives, which grow with (2/C)³: some hundred times the tangent.
TEST(ElasticLaw, stress_and_tangent_are_derivatives) {
  constexpr double h = 1e-5, share = 1e-8;
  const Voigt strain = {0.3, -0.2, 0.1, 0.25, -0.15, 0.2};
  for (const Material& material :
       {materialOf(Material::Law::Linear), materialOf(Material::Law::NeoHookean), orthotropic()})
    for (const auto& [kinematics, rise] : withRises({Kinematics::Solid, Kinematics::PlaneStrain,
                                                     Kinematics::PlaneStress, Kinematics::Axisymmetric})) {
      const fem::ElasticLaw law(material, kinematics);
      Voigt at = strain;
      if (kinematics != Kinematics::Solid)
        at[4] = at[5] = 0.0;
      const fem::MaterialResponse response = law.at(at, rise);
      for (std::size_t r = 0; r < (kinematics == Kinematics::Solid ? 6U : 4U); ++r) {
        if (kinematics == Kinematics::PlaneStress && r == 2)
          continue; // not its own
        Voigt more = at, less = at;
        more[r] += h;
        less[r] -= h;
        const fem::MaterialResponse above = law.at(more, rise), below = law.at(less, rise);
        EXPECT_NEAR(response.stress[r], (above.energy - below.energy) / (2.0 * h),
                    share * (1.0 + std::abs(response.stress[r])))
            << r;
        for (std::size_t s = 0; s < 4; ++s)
          EXPECT_NEAR(response.tangent[s][r], (above.stress[s] - below.stress[s]) / (2.0 * h),
                      share * (1.0 + std::abs(response.tangent[s][r])))
              << s << r;
      }
      if (kinematics == Kinematics::PlaneStress) {
        Voigt whole = at;
        whole[2] = response.across;
        EXPECT_NEAR(fem::ElasticLaw(material, Kinematics::Solid).at(whole, rise).stress[2], 0.0, 1e-13);
      }
    }
}

// What is warm and held by nothing has no stress, and is as large as it expands; around it the stiffness that
// it has at rest.
TEST(ElasticLaw, free_expansion_has_no_stress) {
  for (const Material& material :
       {materialOf(Material::Law::Linear), materialOf(Material::Law::NeoHookean), orthotropic()})
    for (const double rise : rises) {
      const fem::ElasticLaw law(material, Kinematics::Solid);
      const double c = std::cos(material.angle), d = std::sin(material.angle);
      const double first = std::pow(1.0 + rise * material.expansion[0], 2),
                   second = std::pow(1.0 + rise * material.expansion[1], 2),
                   third = std::pow(1.0 + rise * material.expansion[2], 2);
      const fem::MaterialResponse response =
          law.at({0.5 * (c * c * first + d * d * second - 1.0), 0.5 * (d * d * first + c * c * second - 1.0),
                  0.5 * (third - 1.0), c * d * (first - second), 0.0, 0.0},
                 rise);
      EXPECT_NEAR(response.energy, 0.0, 1e-28);
      for (std::size_t r = 0; r < 6; ++r)
        EXPECT_NEAR(response.stress[r], 0.0, 1e-14);
    }
}

// A bar of neo-Hookean material stretched by λ along x, in plane strain held along y: P = ∂W/∂F, in closed
// form.
TEST(ElasticLaw, neo_hookean_uniaxial) {
  const double e = 3.0, nu = 0.3, mu = e / 2.6, lame = e * nu / (1.3 * 0.4);
  const fem::ElasticLaw law(materialOf(Material::Law::NeoHookean), Kinematics::Solid);
  for (const double stretch : {0.2, 0.9, 1.0, 1.7, 4.0}) {
    const fem::MaterialResponse response = law.at({0.5 * (stretch * stretch - 1.0), 0, 0, 0, 0, 0});
    const double first = mu * (stretch - 1.0 / stretch) + lame * std::log(stretch) / stretch;
    EXPECT_NEAR(stretch * response.stress[0], first, 1e-13 * (1.0 + std::abs(first)));
  }
}

// Forces are the derivatives of the energy: by central differences along a direction, errors h² and ε/h of
// energies of the order of one.
TEST(FiniteElasticity, forces_are_derivatives_of_the_energy) {
  constexpr double h = 1e-5;
  for (const Case& c : allCases())
    for (const double degrees : {rises[0], rises[1]}) {
      SCOPED_TRACE(c.name() + ", rise " + std::to_string(degrees));
      const fem::Mesh mesh = meshOf(c.type, c.isAxisymmetric());
      const fem::TemperatureRise rise = warm(mesh, degrees);
      const std::vector<double>
          u = nodal(mesh, large),
          direction = nodal(mesh, [](const Point&x) {
            return Point{std::cos(3.0 * x[1]), std::sin(2.0 * x[0] + x[1]), x[0] * x[1]};
          });
      std::vector<double> more = u, less = u;
      for (std::size_t k = 0; k < u.size(); ++k) {
        more[k] += h * direction[k];
        less[k] -= h * direction[k];
      }
      const fem::FiniteForces forces = fem::finiteForces(mesh, c.elasticity(), u, rise);
      ASSERT_GT(forces.leastJacobian, 0.0);
      double work = 0.0;
      for (std::size_t k = 0; k < u.size(); ++k)
        work += forces.internal[k] * direction[k];
      const double difference = (fem::finiteForces(mesh, c.elasticity(), more, rise).energy -
                                 fem::finiteForces(mesh, c.elasticity(), less, rise).energy) /
                                (2.0 * h);
      EXPECT_NEAR(work, difference, 1e-7 * std::abs(forces.energy));
      EXPECT_GT(std::abs(work), 1e-2 * forces.energy); // it says something
    }
}

// A body that is turned by 90° about z, in space by half a turn about another axis too, and moved has no
// stress; around an axis, moved along it.
TEST(FiniteElasticity, rigid_motions_have_no_forces) {
  for (const Case& c : allCases()) {
    SCOPED_TRACE(c.name());
    const fem::Mesh mesh = meshOf(c.type, c.isAxisymmetric());
    const auto requireNoForces = [&](const std::vector<double>& u) {
      const fem::FiniteForces forces = fem::finiteForces(mesh, c.elasticity(), u);
      EXPECT_GT(forces.leastJacobian, 0.999);
      // Rounding errors of strains of coordinates of ten, times moduli of ten.
      EXPECT_LT(largest(forces.internal), 1e-12);
    };
    requireNoForces(nodal(mesh, [&](const Point& x) {
      return c.isAxisymmetric() ? Point{0.0, 3.0, 0.0} : Point{-x[1] - x[0] + 5.0, x[0] - x[1] - 7.0, 1.0};
    }));
    if (mesh.dimension() < 3)
      continue;
    requireNoForces(nodal(mesh, [](const Point& x) { return Point{-2.0 * x[0] + 1.0, 3.0, -2.0 * x[2]}; }));
    requireNoForces(nodal(mesh, [](const Point& x) { return Point{1.0, -2.0 * x[1], -2.0 * x[2] + 4.0}; }));
  }
}

// The tangent of the body at rest is the stiffness of small displacements.
TEST(FiniteElasticity, tangent_at_rest) {
  for (const Case& c : allCases()) {
    SCOPED_TRACE(c.name());
    const fem::Mesh mesh = meshOf(c.type, c.isAxisymmetric());
    const std::vector<double> rest(static_cast<std::size_t>(mesh.numberOfNodes() * mesh.dimension()), 0.0);
    const LocalMatrix tangent = fem::assembleStrainTangent(mesh, c.elasticity(), rest),
                      stiffness = fem::assembleElasticity(mesh, c.elasticity());
    ASSERT_EQ(tangent.columns, stiffness.columns);
    const double roundoff = 1e-13 * stiffness.maxNorm(); // of sums of some dozens of products
    for (std::size_t k = 0; k < tangent.values.size(); ++k)
      ASSERT_NEAR(tangent.values[k], stiffness.values[k], roundoff);
  }
}

// Kernel: rigid motions of the deformed body, and nothing else. And along any direction it is the change of
// forces less that of turning the stresses: at a state without stress all of it.
TEST(FiniteElasticity, tangent_of_a_deformed_body) {
  for (const Case& c : allCases()) {
    SCOPED_TRACE(c.name());
    const fem::Mesh mesh = meshOf(c.type, c.isAxisymmetric());
    const std::vector<double> u = nodal(mesh, large);
    const LocalMatrix tangent = fem::assembleStrainTangent(mesh, c.elasticity(), u);
    std::vector<double> image(u.size());
    const auto atDeformed = [&](const std::function<Point(const Point&)>& field) {
      std::vector<double> values;
      const auto dimension = static_cast<std::size_t>(mesh.dimension());
      for (int node = 0; node < mesh.numberOfNodes(); ++node) {
        Point x = mesh.local(node);
        for (std::size_t d = 0; d < dimension; ++d)
          x[d] += u[static_cast<std::size_t>(node) * dimension + d];
        const Point value = field(x);
        values.insert(values.end(), value.begin(), value.begin() + mesh.dimension());
      }
      return values;
    };
    std::vector<std::vector<double>> motions = {atDeformed([](const Point&) { return Point{0, 1, 0}; })};
    if (!c.isAxisymmetric()) {
      motions.push_back(atDeformed([](const Point&) { return Point{1, 0, 0}; }));
      motions.push_back(atDeformed([](const Point& x) { return Point{-x[1], x[0], 0}; }));
    }
    if (mesh.dimension() == 3)
      motions.push_back(atDeformed([](const Point& x) { return Point{0, -x[2], x[1]}; }));
    for (const std::vector<double>& motion : motions) {
      tangent.multiply(motion.data(), image.data());
      EXPECT_LT(largest(image), 1e-13 * tangent.infinityNorm() * largest(motion));
    }
    const std::vector<double> strained = atDeformed([](const Point& x) { return Point{x[1], x[0], 0}; });
    tangent.multiply(strained.data(), image.data());
    EXPECT_GT(largest(image), 1e-3 * tangent.infinityNorm());
  }
}

// Without stress the material part is the whole tangent: that of a turned body is the change of its forces,
// by central differences: errors h², and ε/h of strains of displacements of ten.
TEST(FiniteElasticity, tangent_of_a_turned_body) {
  constexpr double h = 1e-5;
  for (const Case& c : allCases()) {
    if (c.isAxisymmetric())
      continue;
    SCOPED_TRACE(c.name());
    const fem::Mesh mesh = meshOf(c.type, false);
    const std::vector<double> turned = nodal(mesh, [](const Point& x) {
      return Point{-x[1] - x[0], x[0] - x[1], 0.0};
    });
    const std::vector<double> direction = nodal(mesh, large);
    std::vector<double> more = turned, less = turned, image(turned.size());
    for (std::size_t k = 0; k < turned.size(); ++k) {
      more[k] += h * direction[k];
      less[k] -= h * direction[k];
    }
    const std::vector<double> above = fem::finiteForces(mesh, c.elasticity(), more).internal,
                              below = fem::finiteForces(mesh, c.elasticity(), less).internal;
    fem::assembleStrainTangent(mesh, c.elasticity(), turned).multiply(direction.data(), image.data());
    for (std::size_t k = 0; k < image.size(); ++k)
      ASSERT_NEAR(image[k], (above[k] - below[k]) / (2.0 * h), 1e-7 * largest(image));
  }
}

TEST(FiniteElasticity, cells_inside_out_are_told) {
  const Case c = {CellType::Quadrilateral4, Kinematics::PlaneStrain, fem::Dilatation::Full,
                  materialOf(Material::Law::NeoHookean)};
  const fem::Mesh mesh = meshOf(c.type, false);
  const std::vector<double> u = nodal(mesh, [](const Point& x) { return Point{-2.0 * x[0], 0.0, 0.0}; });
  EXPECT_LT(fem::finiteForces(mesh, c.elasticity(), u).leastJacobian, 0.0);
}

} // namespace test_finite_elasticity
