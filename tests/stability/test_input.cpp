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
#include <limits>
#include <sstream>

using namespace Harmos;
using scene::Physics;

namespace {

// Of the solver. Answers may be wrong by it times the condition of the dual problem, some hundreds here.
constexpr double tolerance = 1e-10;
constexpr double bound = 1e3 * tolerance;

scene::Scene inUnits(double length, double modulus) {
  Valley options;
  options.length = length;
  options.modulus = modulus;
  options.gap = 1e-3;
  return valley(options);
}

} // namespace

TEST(Stability, units_scaled_by_1e_9) {
  const ReferenceSolution plain = referenceSolution(inUnits(1.0, 1.0));
  ASSERT_TRUE(plain.solvable);
  for (const char* form : {"primal", "dual"}) {
    const std::string how = std::string("Decomposition/Dirichlet=") + form;
    const double usual = products(runScene(inUnits(1.0, 1.0), tolerance, {how}).report);
    double least = usual, most = usual, worst = 0.0;
    for (double length : {1e-9, 1.0, 1e9})
      for (double modulus : {1e-9, 1.0, 1e9}) {
        std::ostringstream name;
        name << "length " << length << ", modulus " << modulus << ", " << form;
        const scene::Scene scene = inUnits(length, modulus);
        const ReferenceSolution reference = referenceSolution(scene);
        ASSERT_TRUE(reference.solvable);
        const double energy = plain.energy * length * length * modulus;
        EXPECT_NEAR(reference.energy, energy, 1e-10 * std::abs(energy)) << name.str();
        const TestRun run = runScene(scene, tolerance, {how});
        expectReference(reference, run, bound, name.str());
        least = std::min(least, products(run.report));
        most = std::max(most, products(run.report));
        worst = std::max(worst, deviation(reference, run).largest());
      }
    EXPECT_LE(most - least, 2.0) << form; // rounding may turn a step
    tellFigure(std::string(form) + ": least products", least);
    tellFigure(std::string(form) + ": most products", most);
    tellFigure(std::string(form) + ": deviation", worst);
  }
}

TEST(Stability, one_subdomain) {
  // One body, held and loaded: nothing to glue, in FETI no dual problem at all. And beneath a ceiling.
  scene::Scene alone;
  alone.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.elements = {4, 4, 1};
  alone.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
  for (int component : {0, 1})
    prescribe(alone, {0, "bottom"}, component);
  addTraction(alone, {0, "top"}, {0.003, 0.05, 0.0});
  scene::Scene beneath = alone;
  addObstacle(beneath, {0, "top"}, halfSpace({0.0, 1.01, 0.0}, {0.02, -1.0, 0.0}));
  for (const scene::Scene* scene : {&alone, &beneath}) {
    const ReferenceSolution reference = referenceSolution(*scene);
    ASSERT_TRUE(reference.solvable);
    for (const char* form : {"primal", "dual"}) {
      const std::string name = std::string(scene == &alone ? "alone, " : "beneath a ceiling, ") + form;
      const TestRun run = runScene(*scene, tolerance, {std::string("Decomposition/Dirichlet=") + form});
      expectReference(reference, run, bound, name);
      EXPECT_EQ(run.report.subdomains, 1);
      if (scene == &alone && form[0] == 'p')
        EXPECT_EQ(run.report.dualDimension, 0);
      tellFigure(name + ": products", products(run.report));
      tellFigure(name + ": deviation", deviation(reference, run).largest());
    }
  }
}

TEST(Stability, ranks_exceed_subdomains) {
  // Two bodies of one subdomain each: on four ranks two have none. And the same bodies cut into eight.
  Valley whole;
  whole.subdomains = 1;
  whole.elements = 4;
  double first = 0.0;
  for (const Valley& options : {whole, Valley()}) {
    const scene::Scene scene = valley(options);
    const ReferenceSolution reference = referenceSolution(scene);
    ASSERT_TRUE(reference.solvable);
    for (const char* form : {"primal", "dual"})
      for (const char* method : {"PDAS", "SMALBE"}) {
        const TestRun run = runScene(
            scene, tolerance,
            {std::string("Decomposition/Dirichlet=") + form, std::string("Solver/Method=") + method});
        expectReference(reference, run, bound, method);
        EXPECT_EQ(run.report.ranks, testComm()->getSize());
        if (method[0] == 'P')
          tellFigure(std::to_string(run.report.subdomains) + " subdomains, " + form + ": products",
                     products(run.report));
      }
    if (options.subdomains == 1)
      first = reference.energy;
    else
      EXPECT_NEAR(reference.energy, first, 1e-13 * std::abs(first)); // however they are cut
  }
}

TEST(Stability, NaN_or_zero_in_material_or_load) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const auto expectRefused = [](const scene::Scene& scene, const std::string& what) {
    const std::string text = inputErrorOf([&] { runScene(scene, tolerance); });
    EXPECT_TRUE(contains(text, what)) << what << ": " << text;
  };
  for (double bad : {nan, infinity, 0.0, -1.0})
    for (int which : {0, 1}) {
      scene::Scene scene = valley();
      scene::Body& body = scene.bodies[static_cast<std::size_t>(which)];
      body.materials = {fem::Material::isotropic(bad, 0.3)};
      expectRefused(scene, "body " + body.name + "\": Young's modulus 1 is");
    }
  for (double bad : {nan, 0.5, -1.0, 1e300}) {
    scene::Scene scene = valley();
    scene.bodies[1].materials = {fem::Material::isotropic(1.0, bad)};
    expectRefused(scene, "body floating\": Poisson's ratio");
  }
  for (double bad : {nan, infinity}) {
    const auto refused = [&](const std::string& what, const auto& change) {
      scene::Scene scene = valley();
      change(scene);
      expectRefused(scene, what);
    };
    refused("the load of subdomain 4 is not finite", [&](scene::Scene& scene) {
      addForce(scene, 1, {0.0, bad, 0.0});
    });
    refused("the load of subdomain 6 is not finite", [&](scene::Scene& scene) {
      addTraction(scene, {1, "top"}, {bad, 0.0, 0.0});
    });
    refused("the load of subdomain 4 is not finite",
            [&](scene::Scene& scene) { addTemperature(scene, 1, bad); });
    refused("is not finite", [&](scene::Scene& scene) { prescribe(scene, {1, "top"}, 0, bad); });
    refused("is a zero vector", [&](scene::Scene& scene) {
      addObstacle(scene, {1, "top"}, halfSpace({}, {0.0, bad, 0.0}));
    });
    refused("not finite; check its coefficients and its gap", [&](scene::Scene& scene) {
      addObstacle(scene, {1, "top"}, halfSpace({0.0, bad, 0.0}, {0.0, -1.0, 0.0}));
    });
  }
  Valley options;
  options.gap = nan;
  expectRefused(valley(options), "not finite; check its coefficients and its gap");

  // What an embedding application may hand over: a stiffness of zeros.
  TestModel model = modelOf(valley());
  for (feti::Subdomain& s : model.subdomains)
    if (s.number == 5) {
      auto zeros = std::make_shared<LocalMatrix>(*s.stiffness);
      std::fill(zeros->values.begin(), zeros->values.end(), 0.0);
      s.stiffness = zeros;
    }
  std::string text;
  try {
    solveTorn(model, tolerance);
  } catch (const Error& error) {
    text = error.what();
  }
  EXPECT_TRUE(contains(text, "subdomain 5")) << text;

  // No load at all is no fault: nothing moves, nothing presses.
  options = Valley();
  options.load = options.aside = 0.0;
  const TestRun idle = runScene(valley(options), tolerance);
  EXPECT_TRUE(idle.report.converged) << idle.report.reason;
  EXPECT_EQ(idle.report.audit.largestDisplacement, 0.0);
  EXPECT_EQ(idle.report.audit.largestMultiplier, 0.0);
}
