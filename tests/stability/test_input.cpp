// SPDX-License-Identifier: BSD-3-Clause

/// Hard cases of what comes in: units, sizes that are too small to be torn, numbers that are none.
///
///  - Units scaled by 1e±9: thresholds that are not relative to the problem (of contact search, kernels,
///    stopping, rank detection) take small things for nothing and large ones for errors.
///  - One subdomain, more ranks than subdomains: ranks without a share must take part in every reduction.
///  - NaN or zero in material or load: comparisons with NaN are false, so that checks written the wrong way
///    round pass; a NaN that gets through poisons every rank's sums. Refused before anything is factorised.

#include "Harmos_HardCase.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

using namespace Harmos;
using fem::Point;
using scene::Physics;

namespace {

// Of the solver. Answers may be wrong by it times the condition of the dual problem, some hundreds here.
constexpr double tolerance = 1e-10;
constexpr double bound = 1e3 * tolerance;

double products(const scene::RunReport& report) {
  return report.result.counters.hessianApplications;
}

// A valley and a floating block in it; lengths and moduli in any units, and so many subdomains.
scene::Scene valley(int subdomains = 2, double length = 1.0, double modulus = 1.0) {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.size = {length, length, 0.0};
  options.subdomains = {subdomains, subdomains, 1};
  options.elements = {4 / subdomains, 4 / subdomains, 1};
  options.map = [length](const Point& x) {
    const double bend = x[1] <= length ? x[1] : 2.0 * length - x[1];
    return Point{x[0], x[1] + 0.5 * std::abs(x[0] / length - 0.5) * bend, 0.0};
  };
  scene.bodies.push_back(blockBody("valley", options, fem::Material::isotropic(modulus, 0.3)));
  options.origin[1] = length;
  scene.bodies.push_back(blockBody("floating", options, fem::Material::isotropic(2.0 * modulus, 0.25)));
  for (int component : {0, 1})
    prescribe(scene, {0, "bottom"}, component);
  addForce(scene, 1, {0.007 * modulus / length, -0.02 * modulus / length, 0.0});
  addContact(scene, {0, "top"}, {1, "bottom"}, 1e-3 * length);
  return scene;
}

} // namespace

TEST(Stability, units_scaled_by_1e_9) {
  const ReferenceSolution plain = referenceSolution(valley());
  ASSERT_TRUE(plain.solvable);
  const double least = products(runScene(valley(), tolerance).report);
  for (double length : {1e-9, 1.0, 1e9})
    for (double modulus : {1e-9, 1.0, 1e9}) {
      const scene::Scene scene = valley(2, length, modulus);
      const ReferenceSolution reference = referenceSolution(scene);
      ASSERT_TRUE(reference.solvable);
      const double energy = length * length * modulus;
      EXPECT_NEAR(reference.energy, plain.energy * energy, 1e-10 * std::abs(plain.energy) * energy);
      for (const char* form : {"primal", "dual"}) {
        const TestRun run = runScene(scene, tolerance, {std::string("Decomposition/Dirichlet=") + form});
        std::ostringstream name;
        name << "length " << length << ", modulus " << modulus << ", " << form;
        expectReference(reference, run, bound, name.str());
        tellFigure("products, " + name.str(), products(run.report));
        tellFigure("deviation, " + name.str(), deviation(reference, run).largest());
        if (std::string(form) == "primal")
          EXPECT_NEAR(products(run.report), least, 2) << name.str();
      }
    }
}

TEST(Stability, one_subdomain) {
  // One body, held and loaded: nothing to glue, no dual problem at all.
  scene::Scene alone;
  alone.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.elements = {4, 4, 1};
  alone.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
  for (int component : {0, 1})
    prescribe(alone, {0, "bottom"}, component);
  addTraction(alone, {0, "top"}, {0.003, -0.01, 0.0});
  scene::Scene onFloor = alone;
  contact::Obstacle ceiling;
  ceiling.point = {0.0, 1.0, 0.0};
  ceiling.direction = {0.2, -1.0, 0.0};
  addObstacle(onFloor, {0, "top"}, ceiling);
  for (const scene::Scene& scene : {alone, onFloor}) {
    const ReferenceSolution reference = referenceSolution(scene);
    ASSERT_TRUE(reference.solvable);
    for (const char* form : {"primal", "dual"}) {
      const TestRun run = runScene(scene, tolerance, {std::string("Decomposition/Dirichlet=") + form});
      expectReference(reference, run, bound, form);
      EXPECT_EQ(run.report.subdomains, 1);
      tellFigure("products", products(run.report));
      tellFigure("dual dimension", static_cast<double>(run.report.dualDimension));
      tellFigure("deviation", deviation(reference, run).largest());
    }
  }
}

TEST(Stability, ranks_exceed_subdomains) {
  // Two bodies of one subdomain each: on four ranks two have none. And the same bodies cut into eight.
  double first = 0.0;
  for (int cut : {1, 2}) {
    const scene::Scene scene = valley(cut);
    const ReferenceSolution reference = referenceSolution(scene);
    ASSERT_TRUE(reference.solvable);
    for (const char* form : {"primal", "dual"})
      for (const char* method : {"PDAS", "SMALBE"}) {
        const TestRun run = runScene(
            scene, tolerance,
            {std::string("Decomposition/Dirichlet=") + form, std::string("Solver/Method=") + method});
        expectReference(reference, run, bound, method);
        EXPECT_EQ(run.report.ranks, testComm()->getSize());
        tellFigure(std::string("products, ") + form + " " + method, products(run.report));
      }
    if (cut == 1)
      first = reference.energy;
    else
      EXPECT_NEAR(reference.energy, first, 1e-13 * std::abs(first)); // however they are cut
  }
}

TEST(Stability, NaN_or_zero_in_material_or_load) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const auto told = [](const std::string& what, const scene::Scene& scene) {
    const std::string text = failureOf(scene);
    if (testComm()->getRank() == 0)
      std::cout << what << ": " << text << std::endl;
    return text;
  };
  for (double bad : {nan, infinity, 0.0, -1.0})
    for (int which : {0, 1}) {
      scene::Scene scene = valley();
      scene.bodies[static_cast<std::size_t>(which)].materials = {fem::Material::isotropic(bad, 0.3)};
      told("modulus", scene);
    }
  for (double bad : {nan, 0.5, -1.0, 1e300}) {
    scene::Scene scene = valley();
    scene.bodies[1].materials = {fem::Material::isotropic(1.0, bad)};
    told("Poisson", scene);
  }
  for (double bad : {nan, infinity}) {
    scene::Scene scene = valley();
    addForce(scene, 1, {0.0, bad, 0.0});
    told("force", scene);
    scene = valley();
    addTraction(scene, {1, "top"}, {bad, 0.0, 0.0});
    told("traction", scene);
    scene = valley();
    prescribe(scene, {1, "top"}, 0, bad);
    told("prescribed", scene);
    scene = valley();
    addTemperature(scene, 1, bad);
    told("temperature", scene);
    scene = valley();
    addContact(scene, {0, "top"}, {1, "bottom"}, bad);
    told("gap", scene);
    scene = valley();
    contact::Obstacle floor;
    floor.direction = {0.0, bad, 0.0};
    addObstacle(scene, {1, "top"}, floor);
    told("obstacle", scene);
    scene = valley();
    floor.direction = {0.0, -1.0, 0.0};
    floor.point = {0.0, bad, 0.0};
    addObstacle(scene, {1, "top"}, floor);
    told("obstacle's point", scene);
  }
  // No load at all is no fault: nothing moves.
  scene::Scene idle = valley();
  addForce(idle, 1, {-0.007, 0.02, 0.0});
  told("no load", idle);
}
