// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ElasticSignorini.hpp"

#include "Harmos_BodyForce.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_PrescribedDisplacement.hpp"
#include "Harmos_RigidObstacle.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_Traction.hpp"

#include <cmath>
#include <memory>

namespace Harmos::signorini {
namespace {

using fem::Point;

constexpr double radius = 1.0;

fem::Material materialOf(const Teuchos::ParameterList& deck) {
  const Teuchos::ParameterList& list = deck.sublist("Material");
  return fem::Material::isotropic(list.get<double>("Young's modulus"), list.get<double>("Poisson's ratio"));
}

scene::Body bodyOf(const fem::StructuredBlock::Options& options, const std::string& name,
                   const fem::Material& material) {
  const auto block = std::make_shared<const fem::StructuredBlock>(options);
  scene::Body body;
  body.name = name;
  body.subdomains = block->numberOfSubdomains();
  body.subdomain = [block](int k) { return block->subdomain(k); };
  body.materials = {material};
  return body;
}

fem::StructuredBlock::Options optionsOf(const Teuchos::ParameterList& model, bool isSpace) {
  const int s = model.get<int>("Subdomains per side"), n = model.get<int>("Elements per subdomain side");
  const bool linear = model.get<int>("Element order") == 1;
  fem::StructuredBlock::Options options;
  options.cellType = isSpace ? (linear ? fem::CellType::Hexahedron8 : fem::CellType::Hexahedron27)
                             : (linear ? fem::CellType::Quadrilateral4 : fem::CellType::Quadrilateral9);
  options.subdomains = {s, s, s};
  options.elements = {n, n, n};
  return options;
}

std::shared_ptr<const scene::Effect> planeAt(double height, bool isSpace) {
  contact::Obstacle plane;
  plane.shape = contact::Obstacle::Shape::HalfSpace;
  const std::size_t up = isSpace ? 2 : 1;
  plane.point[up] = height;
  plane.direction[up] = 1.0;
  return std::make_shared<effects::RigidObstacle>(effects::Part{0, "bottom"}, plane, "plane");
}

// From 0 to 1, slowly at first: the spacing at 0 is a fourteenth of an even one.
double graded(double x) {
  constexpr double growth = 4.0;
  return std::expm1(growth * x) / std::expm1(growth);
}

// A square onto a disc and a cube onto a ball, of which concentric squares become circles (Nowell: Mapping a
// cube to a sphere, 2005; Fong: Analytical methods for squaring the disc, 2014).
Point toBall(const Point& p) {
  const double x = p[0] * p[0], y = p[1] * p[1], z = p[2] * p[2];
  return {radius * p[0] * std::sqrt(1.0 - y / 2 - z / 2 + y * z / 3),
          radius * p[1] * std::sqrt(1.0 - x / 2 - z / 2 + x * z / 3),
          radius * p[2] * std::sqrt(1.0 - x / 2 - y / 2 + x * y / 3)};
}

} // namespace

scene::Scene block(const Teuchos::ParameterList& deck) {
  const Teuchos::ParameterList& model = deck.sublist("Model");
  const bool isSpace = model.get<int>("Dimension") == 3;
  const double weight = model.get<double>("Weight");
  const std::size_t up = isSpace ? 2 : 1;
  scene::Scene scene;
  scene.name = "block on a plane";
  scene.physics = isSpace ? scene::Physics::Solid : scene::Physics::PlaneStrain;
  scene.bodies.push_back(bodyOf(optionsOf(model, isSpace), "block", materialOf(deck)));
  Point down{}, pull{};
  down[up] = -weight;
  pull[up] = 0.25 * weight;
  scene.effects.push_back(planeAt(0.0, isSpace));
  scene.effects.push_back(std::make_shared<effects::BodyForce>(0, down));
  scene.effects.push_back(std::make_shared<effects::Traction>(
      effects::Part{0, "right"}, [pull](const Point&, const Point&) { return pull; }));
  scene.effects.push_back(effects::hold({0, "left"}, 0));
  if (isSpace)
    scene.effects.push_back(effects::hold({0, "front"}, 1));
  return scene;
}

scene::Scene hertz(const Teuchos::ParameterList& deck, bool isBall) {
  const Teuchos::ParameterList& model = deck.sublist("Model");
  const std::size_t up = isBall ? 2 : 1;
  fem::StructuredBlock::Options options = optionsOf(model, isBall);
  options.map = [up](const Point& x) {
    Point p{};
    for (std::size_t d = 0; d < up; ++d)
      p[d] = graded(x[d]);
    p[up] = graded(x[up]) - 1.0;
    return toBall(p);
  };
  scene::Scene scene;
  scene.name = isBall ? "Hertz ball" : "Hertz cylinder";
  scene.physics = isBall ? scene::Physics::Solid : scene::Physics::PlaneStrain;
  scene.bodies.push_back(bodyOf(options, isBall ? "ball" : "cylinder", materialOf(deck)));
  scene.effects.push_back(planeAt(-radius, isBall));
  scene.effects.push_back(effects::hold({0, "left"}, 0));
  if (isBall)
    scene.effects.push_back(effects::hold({0, "front"}, 1));
  scene.effects.push_back(effects::hold({0, "top"}, static_cast<int>(up), -model.get<double>("Approach")));
  return scene;
}

void evaluateHertz(const Teuchos::Comm<int>& comm, const Teuchos::ParameterList& deck, bool isBall,
                   run::RunReport& report) {
  const double pi = std::acos(-1.0);
  const fem::Material material = materialOf(deck);
  const double modulus = material.young[0] / (1.0 - material.poisson[0] * material.poisson[0]);
  const double approach = deck.sublist("Model").get<double>("Approach");
  double load = 0.0, moment = 0.0, peak = 0.0;
  for (std::size_t k = 0; k < report.contact.size(); ++k) {
    const Point& x = report.contactPoints[k].position;
    load += report.contact[k].force;
    moment += report.contact[k].force * (x[0] * x[0] + (isBall ? x[1] * x[1] : 0.0));
    peak = std::max(peak, report.contact[k].pressure);
  }
  load = globalSum(comm, load);
  moment = globalSum(comm, moment);
  peak = globalMax(comm, peak);
  const double halfWidth = load > 0.0 ? std::sqrt((isBall ? 2.5 : 4.0) * moment / load) : 0.0;
  load *= isBall ? 4.0 : 2.0; // of the whole body
  const double a =
      isBall ? std::cbrt(0.75 * load * radius / modulus) : std::sqrt(4.0 * load * radius / (pi * modulus));
  report.results["load"] = load;
  report.results["half_width"] = halfWidth;
  report.results["half_width_theory"] = a;
  report.results["peak_pressure"] = peak;
  report.results["peak_pressure_theory"] =
      load > 0.0 ? (isBall ? 1.5 * load / (pi * a * a) : 2.0 * load / (pi * a)) : 0.0;
  report.results["approach"] = approach;
  double theory = load / (pi * modulus) * (2.0 * std::log(4.0 * radius / a) - 1.0);
  if (isBall) {
    // Each plate moves the other's contact too: on a half-space it would be a²/R alone.
    const double nu = material.poisson[0], far = a * a + 4.0 * radius * radius;
    theory = a * a / radius -
             load / (pi * material.young[0]) *
                 (2.0 * (1.0 + nu) * radius * radius / std::pow(far, 1.5) + (1.0 - nu * nu) / std::sqrt(far));
  }
  report.results["approach_theory"] = load > 0.0 ? theory : 0.0;
}

} // namespace Harmos::signorini
