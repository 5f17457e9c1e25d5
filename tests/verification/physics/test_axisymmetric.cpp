// SPDX-License-Identifier: BSD-3-Clause

/// Bodies of revolution in their meridian plane: patch tests, Lamé's cylinder and sphere, press fit, contact
/// of meshes that do not match, Hertz' sphere on a rigid plane, a spherical indenter.

#include "Harmos_AxisOfSymmetry.hpp"
#include "Harmos_ErrorNorms.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace Harmos;
using fem::CellType;
using fem::Point;
using scene::Physics;

namespace {

constexpr double pi = 3.14159265358979323846, young = 2.0, nu = 0.3;
const std::vector<CellType> types = {CellType::Triangle3, CellType::Triangle6, CellType::Quadrilateral4,
                                     CellType::Quadrilateral8, CellType::Quadrilateral9};

scene::Scene emptyScene() {
  scene::Scene scene;
  scene.physics = Physics::Axisymmetric;
  return scene;
}

int addBlock(scene::Scene& scene, fem::StructuredBlock::Options& options, double poisson = nu) {
  scene.bodies.push_back(blockBody("body " + std::to_string(scene.bodies.size()), options,
                                   fem::Material::isotropic(young, poisson)));
  return static_cast<int>(scene.bodies.size()) - 1;
}

void addAxis(scene::Scene& scene) {
  scene.effects.push_back(std::make_shared<effects::AxisOfSymmetry>(scene.bodies.size()));
}

double largestError(const scene::Scene& scene, const TestRun& run, const fem::VectorField& exact) {
  double worst = 0.0;
  for (std::size_t i = 0; i < run.solution.owned.size(); ++i)
    for (std::size_t k = 0; k < run.solution.displacement[i].size(); ++k) {
      const Point x = run.solution.owned[i].mesh.position(static_cast<int>(k / 2));
      worst = std::max(worst, std::abs(run.solution.displacement[i][k] - exact(x)[k % 2]));
    }
  EXPECT_EQ(scene.components(), 2);
  return globalMax(*testComm(), worst);
}

fem::SquaredErrors errorsOf(const scene::Scene& scene, const TestRun& run, const fem::VectorField& exact,
                            const std::function<std::array<Point, 3>(const Point&)>& gradient) {
  std::vector<double> sums(2, 0.0);
  for (std::size_t i = 0; i < run.solution.owned.size(); ++i) {
    const fem::PlacedMesh& mesh = run.solution.owned[i].mesh;
    const fem::SquaredErrors errors =
        fem::squaredErrors(*mesh.mesh, mesh.anchor, scene::elasticityOf(scene, scene.bodies[0]),
                           run.solution.displacement[i], exact, gradient);
    sums[0] += errors.l2;
    sums[1] += errors.energy;
  }
  globalSum(*testComm(), sums);
  return {std::sqrt(sums[0]), std::sqrt(sums[1])};
}

// Of a scene on several meshes.
class Errors {
 public:
  void add(int n, const scene::Scene& scene, const fem::VectorField& exact,
           const std::function<std::array<Point, 3>(const Point&)>& gradient) {
    const TestRun run = runScene(scene, 1e-11);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    const fem::SquaredErrors errors = errorsOf(scene, run, exact, gradient);
    h_.push_back(1.0 / n);
    l2_.push_back(errors.l2);
    energy_.push_back(errors.energy);
  }

  void expectRates(CellType type) const {
    const int order = fem::shapeOf(type).order;
    if (testComm()->getRank() == 0)
      std::cout << fem::shapeOf(type).name << ": rates " << fittedRate(h_, l2_) << " in L2, "
                << fittedRate(h_, energy_) << " in energy\n";
    EXPECT_NEAR(fittedRate(h_, l2_), order + 1, 0.25) << fem::shapeOf(type).name;
    EXPECT_NEAR(fittedRate(h_, energy_), order, 0.15) << fem::shapeOf(type).name;
  }

 private:
  std::vector<double> h_, l2_, energy_;
};

} // namespace

// u = (a x, b y + c) on cells that are no rectangles, with and without the axis, several subdomains: those of
// one mesh at several distances have matrices of their own.
TEST(Axisymmetric, constant_strain) {
  const auto exact = [](const Point& x) { return Point{0.2 * x[0], 0.5 - 0.3 * x[1], 0.0}; };
  for (CellType type : types)
    for (double inner : {0.0, 0.7})
      for (bool isBent : {false, true}) {
        scene::Scene scene = emptyScene();
        fem::StructuredBlock::Options options;
        options.cellType = type;
        options.origin = {inner, -0.4, 0.0};
        options.subdomains = {2, 2, 1};
        options.elements = {2, 2, 1};
        if (isBent) // bilinear: the axis stays straight
          options.map = [](const Point& x) {
            return Point{x[0] + 0.15 * x[0] * x[1], x[1] + 0.1 * x[0] + 0.1 * x[0] * x[1], 0.0};
          };
        addBlock(scene, options);
        addAxis(scene);
        for (const char* side : {"right", "bottom", "top"})
          for (int c = 0; c < 2; ++c)
            prescribe(scene, {0, side}, c,
                      [=](const Point& x) { return exact(x)[static_cast<std::size_t>(c)]; });
        for (int c = 0; c < 2 && inner > 0.0; ++c) // the axis is free along itself: there is no shear on it
          prescribe(scene, {0, "left"}, c,
                    [=](const Point& x) { return exact(x)[static_cast<std::size_t>(c)]; });
        const TestRun run = runScene(scene, 1e-13);
        ASSERT_TRUE(run.report.converged) << run.report.reason;
        // Of the solver, times condition numbers below 1e3.
        EXPECT_LE(largestError(scene, run, exact), 1e-10) << fem::shapeOf(type).name << inner << isBent;
      }
}

// A disc under a pressure along its axis, free around: uniaxial stress. It floats on its support but for the
// one rigid-body mode; the force is the pressure times π R².
TEST(Axisymmetric, pressed_disc) {
  const double p = 0.01, radius = 1.5;
  for (CellType type : types) {
    scene::Scene scene = emptyScene();
    fem::StructuredBlock::Options options;
    options.cellType = type;
    options.size = {radius, 1.0, 1.0};
    options.subdomains = {3, 2, 1};
    options.elements = {2, 2, 1};
    addBlock(scene, options);
    addAxis(scene);
    prescribe(scene, {0, "bottom"}, 1);
    addTraction(scene, {0, "top"}, Point{0.0, -p, 0.0});
    for (const char* form : {"implicit", "condensed"}) {
      const TestRun run = runScene(scene, 1e-13, {std::string("Dual operator/Form=") + form});
      ASSERT_TRUE(run.report.converged) << run.report.reason;
      EXPECT_LE(largestError(scene, run,
                             [&](const Point& x) {
                               return Point{nu * p / young * x[0], -p / young * x[1], 0.0};
                             }),
                1e-9 * p);
      EXPECT_EQ(run.report.kernelDimension, 3); // of the upper three subdomains
      EXPECT_LE(run.report.audit.equilibrium, 1e-9);
      EXPECT_LE(run.report.forces.balance, 1e-10);
      double support = 0.0;
      for (const run::Forces::Of& effect : run.report.forces.effects)
        support += effect.resultant.force[1];
      EXPECT_NEAR(support, p * pi * radius * radius, 1e-9 * p);
    }
  }
}

// Lamé: a thick cylinder under inner pressure, held along its axis (plane strain).
TEST(Axisymmetric, thick_cylinder) {
  const double a = 1.0, b = 2.0, p = 0.1;
  const double scale = (1.0 + nu) / young * p * a * a / (b * b - a * a);
  const auto exact = [=](const Point& x) {
    return Point{scale * ((1.0 - 2.0 * nu) * x[0] + b * b / x[0]), 0.0, 0.0};
  };
  const auto gradient = [=](const Point& x) {
    return std::array<Point, 3>{Point{scale * ((1.0 - 2.0 * nu) - b * b / (x[0] * x[0])), 0, 0}, Point{},
                                Point{0, 0, exact(x)[0] / x[0]}};
  };
  for (CellType type : types) {
    Errors errors;
    for (int n : {4, 8, 16, 32}) {
      scene::Scene scene = emptyScene();
      fem::StructuredBlock::Options options;
      options.cellType = type;
      options.origin = {a, 0.0, 0.0};
      options.size = {b - a, 0.5, 1.0};
      options.subdomains = {2, 1, 1};
      options.elements = {n / 2, n / 2, 1};
      addBlock(scene, options);
      prescribe(scene, {0, "bottom"}, 1);
      prescribe(scene, {0, "top"}, 1);
      addTraction(scene, {0, "left"}, Point{p, 0.0, 0.0});
      errors.add(n, scene, exact, gradient);
    }
    errors.expectRates(type);
  }
}

// Lamé: a hollow sphere under inner pressure; half of it, from the axis to the equator.
TEST(Axisymmetric, hollow_sphere) {
  const double a = 1.0, b = 2.0, p = 0.1, a3 = a * a * a, b3 = b * b * b;
  // u_ρ = A ρ + B/ρ².
  const double factor = p * a3 / (young * (b3 - a3)), first = factor * (1.0 - 2.0 * nu),
               second = factor * (1.0 + nu) * b3 / 2.0;
  const auto exact = [=](const Point& x) {
    const double rho = std::hypot(x[0], x[1]), u = first + second / (rho * rho * rho);
    return Point{u * x[0], u * x[1], 0.0};
  };
  const auto gradient = [=](const Point& x) {
    const double rho = std::hypot(x[0], x[1]), u = first + second / (rho * rho * rho),
                 slope = -3.0 * second / std::pow(rho, 5);
    return std::array<Point, 3>{Point{u + slope * x[0] * x[0], slope * x[0] * x[1], 0},
                                Point{slope * x[0] * x[1], u + slope * x[1] * x[1], 0}, Point{0, 0, u}};
  };
  for (CellType type : {CellType::Triangle6, CellType::Quadrilateral4, CellType::Quadrilateral9}) {
    Errors errors;
    for (int n : {4, 8, 12, 16}) {
      scene::Scene scene = emptyScene();
      fem::StructuredBlock::Options options;
      options.cellType = type;
      options.origin = {a, 0.0, 0.0};
      options.size = {b - a, pi / 2.0, 1.0};
      options.subdomains = {1, 2, 1};
      options.elements = {n, n / 2, 1};
      options.map = [](const Point& x) { // "top" on the axis, exactly
        const double angle = x[1];
        return Point{angle >= pi / 2.0 ? 0.0 : x[0] * std::cos(angle), x[0] * std::sin(angle), 0.0};
      };
      addBlock(scene, options);
      addAxis(scene);
      prescribe(scene, {0, "bottom"}, 1);
      addTraction(scene, {0, "left"}, [p](const Point&, const Point& normal) {
        return Point{-p * normal[0], -p * normal[1], 0.0};
      });
      errors.add(n, scene, exact, gradient);
    }
    errors.expectRates(type);
  }
}

// Two discs on top of each other, meshes that do not match, all pairs: the pressure is constant.
TEST(Axisymmetric, contact_patch) {
  const double p = 0.01;
  for (CellType lower : types)
    for (CellType upper : types) {
      scene::Scene scene = emptyScene();
      fem::StructuredBlock::Options options;
      options.cellType = lower;
      options.subdomains = {2, 1, 1};
      options.elements = {2, 2, 1};
      addBlock(scene, options);
      options.cellType = upper;
      options.elements = {3, 2, 1};
      options.origin[1] = 1.0;
      addBlock(scene, options);
      addAxis(scene);
      prescribe(scene, {0, "bottom"}, 1);
      addTraction(scene, {1, "top"}, Point{0.0, -p, 0.0});
      addContact(scene, {0, "top"}, {1, "bottom"});
      const TestRun run = runScene(scene, 1e-13);
      const std::string what = fem::shapeOf(lower).name + " under " + fem::shapeOf(upper).name;
      ASSERT_TRUE(run.report.converged) << what << ": " << run.report.reason;
      EXPECT_LE(largestError(scene, run,
                             [&](const Point& x) {
                               return Point{nu * p / young * x[0], -p / young * x[1], 0.0};
                             }),
                1e-9 * p)
          << what;
      for (const run::ContactState& state : run.report.contact)
        EXPECT_NEAR(state.pressure, p, 1e-9 * p) << what;
    }
}

// A ring is pressed onto another one: overlap δ at radius b. Lamé's rings without axial force (thin): for
// equal materials p = E δ (b² − a²)(c² − b²)/(2 b³ (c² − a²)). Meshes do not match along the joint.
TEST(Axisymmetric, press_fit) {
  const double a = 1.0, b = 1.5, c = 2.5, overlap = 0.001;
  const double exact =
      young * overlap * (b * b - a * a) * (c * c - b * b) / (2.0 * b * b * b * (c * c - a * a));
  for (CellType type : {CellType::Quadrilateral4, CellType::Quadrilateral8, CellType::Triangle6}) {
    std::vector<double> h, errors;
    for (int n : {4, 8, 12, 16}) {
      scene::Scene scene = emptyScene();
      fem::StructuredBlock::Options options;
      options.cellType = type;
      options.origin = {a, 0.0, 0.0};
      options.size = {b - a, 0.2, 1.0};
      options.elements = {n, 2, 1};
      addBlock(scene, options);
      options.origin[0] = b;
      options.size[0] = c - b;
      options.elements = {n, 3, 1};
      addBlock(scene, options);
      for (int body : {0, 1})
        prescribe(scene, {body, "bottom"}, 1);
      addContact(scene, {0, "right"}, {1, "left"}, -overlap);
      const TestRun run = runScene(scene, 1e-11);
      ASSERT_TRUE(run.report.converged) << run.report.reason;
      double error = 0.0;
      for (const run::ContactState& state : run.report.contact)
        error = std::max(error, std::abs(state.pressure - exact) / exact);
      h.push_back(1.0 / n);
      errors.push_back(globalMax(*testComm(), error));
    }
    // The largest error of a node's pressure; rates of stresses are those of the order, in smooth solutions
    // more.
    if (testComm()->getRank() == 0)
      std::cout << fem::shapeOf(type).name << ": pressure wrong by " << errors.back() << ", rate "
                << fittedRate(h, errors) << "\n";
    const int order = fem::shapeOf(type).order;
    EXPECT_LE(errors.back(), order == 1 ? 4e-3 : 2e-4) << fem::shapeOf(type).name;
    EXPECT_GE(fittedRate(h, errors), order - 0.1);
    EXPECT_LE(fittedRate(h, errors), order + 1.5);
  }
}

namespace {

// A body of n/2 × n/2 cells of second order, whose bottom is moved towards an obstacle at its top.
scene::Scene pressed(int n, const std::function<Point(const Point&)>& map,
                     const contact::Obstacle& obstacle) {
  scene::Scene scene = emptyScene();
  fem::StructuredBlock::Options options;
  options.cellType = CellType::Quadrilateral9;
  options.subdomains = {2, 2, 1};
  options.elements = {n / 4, n / 4, 1};
  options.map = map;
  addBlock(scene, options);
  addAxis(scene);
  prescribe(scene, {0, "bottom"}, 1, 0.006);
  addObstacle(scene, {0, "top"}, obstacle);
  return scene;
}

// Of a contact with an obstacle around the axis: p₀ and a that follow from its force F, p₀³ = 6FE*²/π³R²,
// a³ = 3FR/4E*, and those that were found: 2a²/5 is the second moment of the pressure over F.
struct Hertz {
  double peak, wide, largest, found;
};

Hertz hertzOf(const TestRun& run, double radius) {
  const double effective = young / (1.0 - nu * nu);
  double force = 0.0, second = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < run.report.contact.size(); ++k) { // all points are on each rank
    const double r = run.report.contactPoints[k].position[0];
    force += run.report.contact[k].force;
    second += run.report.contact[k].force * r * r;
    largest = std::max(largest, run.report.contact[k].pressure);
  }
  return {std::cbrt(6.0 * force * effective * effective / (pi * pi * pi * radius * radius)),
          std::cbrt(3.0 * force * radius / (4.0 * effective)), largest, std::sqrt(2.5 * second / force)};
}

} // namespace

// Hertz: half a ball pressed onto a rigid plane by its equator. The peak pressure and the radius of the
// contact follow from the force, p₀³ = 6FE*²/π³R², a³ = 3FR/4E*, up to (a/R)² of what Hertz leaves out.
TEST(Axisymmetric, ball_on_a_rigid_plane) {
  const double radius = 1.0;
  std::vector<double> peaks, widths;
  for (int n : {16, 32, 64, 96}) {
    contact::Obstacle plane;
    plane.point = {0.0, radius, 0.0};
    plane.direction = {0.0, -1.0, 0.0};
    const auto quarter = [radius](const Point& s) { // of a disc, fine near the pole
      const double x = s[0] * s[0], y = 1.0 - (1.0 - s[1]) * (1.0 - s[1]);
      return Point{radius * x * std::sqrt(1.0 - y * y / 2.0), radius * y * std::sqrt(1.0 - x * x / 2.0), 0.0};
    };
    const TestRun run = runScene(pressed(n, quarter, plane), 1e-9);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    const Hertz hertz = hertzOf(run, radius);
    if (testComm()->getRank() == 0)
      std::cout << n << ": a/R " << hertz.wide / radius << ", radius " << hertz.found / hertz.wide
                << ", peak pressure " << hertz.largest / hertz.peak << " of Hertz'\n";
    peaks.push_back(std::abs(hertz.largest / hertz.peak - 1.0));
    widths.push_back(std::abs(hertz.found / hertz.wide - 1.0));
  }
  // (a/R)² is 0.006, and the edge of the contact lies between two nodes.
  EXPECT_LE(widths.back(), 0.01);
  EXPECT_LE(peaks.back(), 0.01);
}

// Hertz' pressure under a rigid sphere, p₀√(1 − r²/a²) with p₀³ = 6FE*²/π³R², a³ = 3FR/4E*, on a cylinder a
// dozen times as wide as the contact. Compared in the inner part: at the edge, between two nodes, the slope
// is infinite.
TEST(Axisymmetric, spherical_indenter) {
  const double radius = 1.0;
  std::vector<double> widths, errors;
  for (int n : {24, 32, 48, 64}) {
    contact::Obstacle sphere;
    sphere.shape = contact::Obstacle::Shape::Sphere;
    sphere.point = {0.0, radius, 0.0};
    sphere.radius = radius;
    const auto cylinder = [](const Point& s) { // fine below the sphere
      const auto graded = [](double x) { return x * (0.15 + 0.85 * x); };
      return Point{graded(s[0]), -graded(1.0 - s[1]), 0.0};
    };
    const TestRun run = runScene(pressed(n, cylinder, sphere), 1e-9);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    const Hertz hertz = hertzOf(run, radius);
    double worst = 0.0;
    for (std::size_t k = 0; k < run.report.contact.size(); ++k) {
      const double r = run.report.contactPoints[k].position[0] / hertz.wide;
      if (r < 0.5)
        worst =
            std::max(worst, std::abs(run.report.contact[k].pressure / hertz.peak - std::sqrt(1.0 - r * r)));
    }
    if (testComm()->getRank() == 0)
      std::cout << n << ": a/R " << hertz.wide / radius << ", radius " << hertz.found / hertz.wide
                << ", peak pressure " << hertz.largest / hertz.peak << " of Hertz', pressure wrong by "
                << worst << "\n";
    errors.push_back(worst);
    widths.push_back(std::abs(hertz.found / hertz.wide - 1.0));
  }
  EXPECT_LE(widths.back(), 0.01);
  EXPECT_LE(errors.back(), 0.006); // (a/R)², and on a block of finite size
  EXPECT_LE(errors.back(), 0.5 * errors.front());
}

TEST(Axisymmetric, bodies_beyond_the_axis_are_rejected) {
  scene::Scene scene = emptyScene();
  fem::StructuredBlock::Options options;
  options.origin = {-0.5, 0.0, 0.0};
  addBlock(scene, options);
  EXPECT_TRUE(contains(failureOf(scene), "beyond the axis"));
}
