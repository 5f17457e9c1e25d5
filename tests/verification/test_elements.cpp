// SPDX-License-Identifier: BSD-3-Clause

/// Patch tests and manufactured solutions of linear elasticity for each element, solved by the whole pipeline
/// on several subdomains.

#include "Harmos_ErrorNorms.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace Harmos;
using fem::CellType;
using fem::Point;
using scene::Physics;

namespace {

struct Case {
  CellType type;
  Physics physics;
  int order;
  bool isSpace;
};

const std::vector<Case> cases = {{CellType::Triangle3, Physics::PlaneStrain, 1, false},
                                 {CellType::Triangle6, Physics::PlaneStrain, 2, false},
                                 {CellType::Quadrilateral4, Physics::PlaneStrain, 1, false},
                                 {CellType::Quadrilateral9, Physics::PlaneStrain, 2, false},
                                 {CellType::Quadrilateral4, Physics::PlaneStress, 1, false},
                                 {CellType::Tetrahedron4, Physics::Solid, 1, true},
                                 {CellType::Tetrahedron10, Physics::Solid, 2, true},
                                 {CellType::Hexahedron8, Physics::Solid, 1, true},
                                 {CellType::Hexahedron27, Physics::Solid, 2, true},
                                 {CellType::Quadrilateral8, Physics::PlaneStrain, 2, false},
                                 {CellType::Hexahedron20, Physics::Solid, 2, true},
                                 {CellType::Wedge6, Physics::Solid, 1, true},
                                 {CellType::Wedge15, Physics::Solid, 2, true},
                                 {CellType::Wedge18, Physics::Solid, 2, true}};

std::string nameOf(const Case& c) {
  return fem::shapeOf(c.type).name + (c.physics == Physics::PlaneStress ? ", plane stress" : "");
}

const std::vector<std::string> planeSides = {"left", "right", "bottom", "top"};
const std::vector<std::string> spaceSides = {"left", "right", "front", "back", "bottom", "top"};

// Smooth, with sides of cells that are neither straight nor parallel.
Point bend(const Point& x) {
  return {x[0] + 0.07 * std::sin(3.0 * x[1] + 1.0) * std::cos(2.0 * x[2]),
          x[1] + 0.06 * std::sin(2.0 * x[0] + 2.0 * x[2]),
          x[2] == 0.0 ? 0.0 : x[2] + 0.05 * std::sin(2.0 * x[0] + x[1])};
}

// E_1 twice E_2, about turned axes: every entry of C that may differ from zero does.
fem::Material orthotropic() {
  fem::Material material;
  material.young = {2.0, 1.0, 1.5};
  material.poisson = {0.3, 0.25, 0.2};
  material.shear = {0.5, 0.6, 0.7};
  material.angle = 0.4;
  return material;
}

// u_i = a_i sin(k·x + p_i).
struct Wave {
  Point a = {0.7, -0.5, 0.4};
  Point k = {1.3, 1.7, 1.1};
  Point phase = {0.2, 0.9, 1.7};

  double argument(const Point& x, std::size_t i) const {
    return k[0] * x[0] + k[1] * x[1] + k[2] * x[2] + phase[i];
  }
  Point value(const Point& x) const {
    Point u{};
    for (std::size_t i = 0; i < 3; ++i)
      u[i] = a[i] * std::sin(argument(x, i));
    return u;
  }
  std::array<Point, 3> gradient(const Point& x) const {
    std::array<Point, 3> g{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        g[i][j] = a[i] * k[j] * std::cos(argument(x, i));
    return g;
  }
};

fem::Voigt strainOf(const std::array<Point, 3>& g) {
  return {g[0][0], g[1][1], g[2][2], g[0][1] + g[1][0], g[1][2] + g[2][1], g[0][2] + g[2][0]};
}

fem::Voigt times(const fem::VoigtMatrix& c, const fem::Voigt& e) {
  fem::Voigt s{};
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t q = 0; q < 6; ++q)
      s[r] += c[r][q] * e[q];
  return s;
}

// Row i of a symmetric tensor.
Point rowOf(const fem::Voigt& s, std::size_t i) {
  return i == 0 ? Point{s[0], s[3], s[5]} : i == 1 ? Point{s[3], s[1], s[4]} : Point{s[5], s[4], s[2]};
}

// A cube or square of side one, cut into two subdomains a side: u given on all sides but the right one, where
// the traction is.
scene::Scene waveScene(const Case& c, int elements, const Wave& wave, const fem::Material& material,
                       fem::Dilatation dilatation) {
  fem::StructuredBlock::Options options;
  options.cellType = c.type;
  options.subdomains = {2, 2, 2};
  options.elements = {elements / 2, elements / 2, elements / 2};
  scene::Scene scene;
  scene.physics = c.physics;
  scene.bodies.push_back(blockBody("block", options, material));
  scene.bodies[0].dilatation = dilatation;
  const fem::VoigtMatrix stiffness = material.stiffness(scene::kinematicsOf(c.physics));
  for (const std::string& side : c.isSpace ? spaceSides : planeSides)
    for (int component = 0; component < scene.components() && side != "right"; ++component)
      prescribe(scene, {0, side}, component, [wave, component](const Point& x) {
        return wave.value(x)[static_cast<std::size_t>(component)];
      });
  // ∂_j ε of the wave: derivatives of the cosine in its gradient.
  addForce(scene, 0, [wave, stiffness](const Point& x) {
    Point f{};
    for (std::size_t j = 0; j < 3; ++j) {
      std::array<Point, 3> second{};
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t l = 0; l < 3; ++l)
          second[i][l] = -wave.a[i] * wave.k[l] * wave.k[j] * std::sin(wave.argument(x, i));
      const fem::Voigt s = times(stiffness, strainOf(second));
      for (std::size_t i = 0; i < 3; ++i)
        f[i] -= rowOf(s, i)[j];
    }
    return f;
  });
  addTraction(scene, {0, "right"}, [wave, stiffness](const Point& x, const Point& normal) {
    const fem::Voigt s = times(stiffness, strainOf(wave.gradient(x)));
    Point t{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        t[i] += rowOf(s, i)[j] * normal[j];
    return t;
  });
  return scene;
}

Wave planeWave() {
  Wave wave;
  wave.a[2] = wave.k[2] = 0.0;
  return wave;
}

fem::SquaredErrors errorsOf(const scene::Scene& scene, const TestRun& run, const Wave& wave) {
  std::vector<double> sums(2, 0.0);
  const fem::Elasticity elasticity = scene::elasticityOf(scene, scene.bodies[0]);
  for (std::size_t i = 0; i < run.solution.owned.size(); ++i) {
    const fem::PlacedMesh& mesh = run.solution.owned[i].mesh;
    const fem::SquaredErrors errors = fem::squaredErrors(
        *mesh.mesh, mesh.anchor, elasticity, run.solution.displacement[i],
        [&](const Point& x) { return wave.value(x); }, [&](const Point& x) { return wave.gradient(x); });
    sums[0] += errors.l2;
    sums[1] += errors.energy;
  }
  globalSum(*testComm(), sums);
  return {std::sqrt(sums[0]), std::sqrt(sums[1])};
}

} // namespace

// Constant strain on bent meshes: the exact answer is in the space of each element, and the quadrature is
// exact for constant stress. Solver tolerance 1e-12, condition numbers of the subdomains below 1e3.
TEST(PatchTest, constant_strain_on_bent_meshes) {
  for (const Case& c : cases)
    for (fem::Dilatation dilatation : {fem::Dilatation::Full, fem::Dilatation::Projected}) {
      const Point slope[3] = {{0.3, 0.2, -0.1}, {-0.15, 0.25, 0.2}, {0.1, -0.3, 0.35}};
      const auto exact = [&](const Point& x, int i) {
        const Point& g = slope[i];
        return 0.5 + g[0] * x[0] + g[1] * x[1] + g[2] * x[2];
      };
      fem::StructuredBlock::Options options;
      options.cellType = c.type;
      options.subdomains = {2, 2, 1};
      options.elements = {2, 2, 3};
      options.map = bend;
      scene::Scene scene;
      scene.physics = c.physics;
      scene.bodies.push_back(blockBody("block", options, orthotropic()));
      scene.bodies[0].dilatation = dilatation;
      for (const std::string& side : c.isSpace ? spaceSides : planeSides)
        for (int component = 0; component < scene.components(); ++component)
          prescribe(scene, {0, side}, component,
                    [exact, component](const Point& x) { return exact(x, component); });
      const TestRun run = runScene(scene, 1e-12);
      EXPECT_TRUE(run.report.converged) << nameOf(c);
      double worst = 0.0;
      for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
        for (std::size_t k = 0; k < run.solution.displacement[i].size(); ++k) {
          const int m = scene.components(), node = static_cast<int>(k) / m;
          worst = std::max(
              worst, std::abs(run.solution.displacement[i][k] -
                              exact(run.solution.owned[i].mesh.position(node), static_cast<int>(k) % m)));
        }
      EXPECT_LE(globalMax(*testComm(), worst), 1e-10) << nameOf(c);
    }
}

// Theory: p + 1 in L2, p in energy, for smooth solutions and any elastic material.
TEST(ManufacturedSolution, rates_of_each_element) {
  for (const Case& c : cases) {
    const Wave wave = c.isSpace ? Wave() : planeWave();
    const std::vector<int> meshes = !c.isSpace                         ? std::vector<int>{4, 8, 16, 32}
                                    : c.order == 1                     ? std::vector<int>{4, 8, 12, 16}
                                    : c.type == CellType::Hexahedron20 ? std::vector<int>{4, 6, 8, 10}
                                                                       : std::vector<int>{2, 4, 6, 8};
    std::vector<double> h, l2, energy;
    for (int n : meshes) {
      const scene::Scene scene = waveScene(c, n, wave, orthotropic(), fem::Dilatation::Full);
      const TestRun run = runScene(scene, 1e-10);
      ASSERT_TRUE(run.report.converged) << nameOf(c) << ": " << run.report.reason;
      const fem::SquaredErrors errors = errorsOf(scene, run, wave);
      h.push_back(1.0 / n);
      l2.push_back(errors.l2);
      energy.push_back(errors.energy);
    }
    const double l2Rate = fittedRate(h, l2), energyRate = fittedRate(h, energy);
    RecordProperty(nameOf(c), std::to_string(l2Rate) + " " + std::to_string(energyRate));
    if (testComm()->getRank() == 0)
      std::cout << nameOf(c) << ": rates " << l2Rate << " in L2, " << energyRate << " in energy, L2 error "
                << l2.back() << "\n";
    EXPECT_NEAR(l2Rate, c.order + 1, 0.15) << nameOf(c);
    EXPECT_NEAR(energyRate, c.order, 0.15) << nameOf(c);
  }
}

// A wave without divergence stays the same as ν → 1/2, and so must the error. Quadrilaterals and hexahedra
// with projected dilatation; linear ones without it lock: the guard matters.
TEST(ManufacturedSolution, nearly_incompressible) {
  for (const Case& c : cases) {
    if (c.physics == Physics::PlaneStress || fem::shapeOf(c.type).isSimplex || fem::shapeOf(c.type).isWedge)
      continue;
    Wave wave = c.isSpace ? Wave() : planeWave();
    wave.phase = {0.4, 0.4, 0.4};
    wave.k = {1.3, 1.7, c.isSpace ? 1.1 : 0.0};
    wave.a = {1.7, -1.3, 0.0}; // across the wave's direction
    const std::vector<int> meshes =
        !c.isSpace ? std::vector<int>{4, 8, 16, 32} : std::vector<int>{4, 6, 8, 10};
    double reference = 0.0;
    for (double nu : {0.3, 0.49, 0.499, 0.4999}) {
      std::vector<double> h, l2;
      for (int n : meshes) {
        const scene::Scene scene =
            waveScene(c, n, wave, fem::Material::isotropic(1.0, nu), fem::Dilatation::Projected);
        const TestRun run = runScene(scene, 1e-9);
        ASSERT_TRUE(run.report.converged) << nameOf(c) << ", nu " << nu << ": " << run.report.reason;
        h.push_back(1.0 / n);
        l2.push_back(errorsOf(scene, run, wave).l2);
      }
      if (nu == 0.3)
        reference = l2.back();
      if (testComm()->getRank() == 0)
        std::cout << nameOf(c) << ", nu " << nu << ": rate " << fittedRate(h, l2) << ", L2 error "
                  << l2.back() << "\n";
      EXPECT_LE(l2.back(), 2.0 * reference) << nameOf(c) << ", nu " << nu;
      EXPECT_NEAR(fittedRate(h, l2), c.order + 1, 0.25) << nameOf(c) << ", nu " << nu;
    }
    if (c.order == 1) {
      const scene::Scene scene =
          waveScene(c, meshes.back(), wave, fem::Material::isotropic(1.0, 0.4999), fem::Dilatation::Full);
      EXPECT_GE(errorsOf(scene, runScene(scene, 1e-9), wave).l2, 3.0 * reference) << nameOf(c);
    }
  }
}
