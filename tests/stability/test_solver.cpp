// SPDX-License-Identifier: BSD-3-Clause

/// Hard cases of the solver's own numbers.
///
///  - Penalty from 1e-3 to 1e9: a penalty without multiplier leaves ‖Gλ‖ = O(1/ρ), a large one drowns the
///    gradient in the rounding errors of ρGᵀGλ. Cure: augmented Lagrangians (SMALBE; Dostál 2009, chapter 6),
///    which converge with any ρ.
///  - Tolerance from 1e-2 to 1e-12: the residual that a solver carries along drifts away from the true one.
///    Cure: it is computed anew before anything is called converged.
///  - Stagnation: a tolerance below the level of rounding errors cannot be met, and is not to be iterated
///  for.

#include "Harmos_HardCase.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

using namespace Harmos;
using scene::Physics;

namespace {

double products(const scene::RunReport& report) {
  return report.result.counters.hessianApplications;
}

// Two blocks on top of each other, the upper one guided at its left, pressed down and tilted.
scene::Scene tower() {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.subdomains = {2, 2, 1};
  options.elements = {3, 3, 1};
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(1.0, 0.3)));
  options.origin[1] = 1.0;
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(1.0, 0.3)));
  for (int component : {0, 1})
    prescribe(scene, {0, "bottom"}, component);
  prescribe(scene, {1, "left"}, 0);
  addTraction(scene, {1, "top"}, {0.0, -0.01, 0.0});
  addForce(scene, 1, {0.01, 0.0, 0.0});
  addContact(scene, {0, "top"}, {1, "bottom"});
  return scene;
}

double norm(const std::vector<double>& v) {
  double sum = 0.0;
  for (double value : v)
    sum += value * value;
  return std::sqrt(sum);
}

// ‖g^P‖ and ‖Gλ‖ of the answer, from F, d and G by products of this function's own.
struct Residuals {
  double gradient;
  double equality;
};
Residuals residualsOf(const TestFeti& feti, const TornRun& run) {
  const auto map = feti.constraints.rowMap();
  MultiVector lambda(*run.torn.multiplier, Teuchos::Copy);
  lambda.update(-1.0, *feti.dual.shift(), 1.0);
  const std::vector<double> equality = feti.coarse.applyG(lambda);
  MultiVector g(map, 1);
  feti.dualOperator.apply(lambda, g);
  g.update(-1.0, feti.dual.d(), 1.0);
  feti.coarse.project(g);
  const std::vector<double> gradient = fromVector(g), x = fromVector(lambda),
                            lower = fromVector(*feti.dual.lowerBound());
  std::vector<double> projected;
  for (std::size_t k = 0; k < x.size(); ++k)
    projected.push_back(x[k] <= lower[k] ? std::min(gradient[k], 0.0) : gradient[k]);
  return {norm(projected), norm(equality)};
}

} // namespace

TEST(Stability, penalty_from_1e_3_to_1e9) {
  const scene::Scene scene = tower();
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  const double tolerance = 1e-8;
  for (double penalty : {1e-3, 1.0, 1e3, 1e6, 1e9}) {
    std::ostringstream text;
    text << penalty;
    for (const char* kind : {"none", "Dirichlet"}) {
      const TestRun run = runScene(scene, tolerance,
                                   {"Solver/Method=SMALBE", "Solver/SMALBE/Initial penalty=" + text.str(),
                                    std::string("Dual operator/Preconditioner=") + kind});
      const std::string name = std::string("SMALBE ") + kind + ", rho = " + text.str();
      tellFigure("products, " + name, products(run.report));
      tellFigure("deviation, " + name, deviation(reference, run).largest());
      tellFigure("converged, " + name, run.report.converged);
      if (!run.report.converged && testComm()->getRank() == 0)
        std::cout << run.report.reason << std::endl;
    }
    const TestRun off = runScene(scene, tolerance,
                                 {"Solver/Method=Dual Penalty", "Solver/Dual Penalty/Penalty=" + text.str()});
    const std::string name = "penalty alone, rho = " + text.str();
    tellFigure("products, " + name, products(off.report));
    tellFigure("deviation, " + name, deviation(reference, off).largest());
    tellFigure("converged, " + name, off.report.converged);
    tellFigure("agrees, " + name, scene::auditAgrees(off.report));
    if (!off.report.converged && testComm()->getRank() == 0)
      std::cout << off.report.reason << std::endl;
  }
}

TEST(Stability, tolerance_from_1e_2_to_1e_12) {
  const scene::Scene scene = tower();
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  for (const char* form : {"primal", "dual"})
    for (const char* method : {"PDAS", "SMALBE"})
      for (const char* kind : {"none", "Dirichlet"}) {
        const std::vector<std::string> how = {std::string("Decomposition/Dirichlet=") + form,
                                              std::string("Solver/Method=") + method,
                                              std::string("Dual operator/Preconditioner=") + kind};
        const scene::RunOptions options = testOptions(1e-2, how);
        const TestFeti feti(modelOf(scene), options.dirichlet, options.dual.inverses);
        for (double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
          const TornRun run = solveTorn(feti, tolerance, how);
          const Residuals true_ = residualsOf(feti, run);
          const std::string name =
              std::string(form) + ", " + method + ", " + kind + ", " + std::to_string(tolerance);
          tellFigure("products, " + name, products(run.report));
          tellFigure("deviation, " + name, deviation(reference, run).largest() / tolerance);
          tellFigure("gradient/allowed, " + name, true_.gradient / (tolerance * run.report.gradientScale));
          tellFigure("gradient/told, " + name, true_.gradient / run.report.result.projectedGradient);
          tellFigure("equality/allowed, " + name, true_.equality / (tolerance * run.report.equalityScale));
          tellFigure("converged, " + name, run.report.converged);
          if (!run.report.converged && testComm()->getRank() == 0)
            std::cout << run.report.reason << std::endl;
        }
      }
}

TEST(Stability, stagnation_detected) {
  const scene::Scene scene = tower();
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  for (const char* method : {"PDAS", "SMALBE"})
    for (const char* kind : {"none", "Dirichlet"})
      for (double tolerance : {1e-15, 1e-18}) {
        const TestRun run = runScene(
            scene, tolerance,
            {std::string("Solver/Method=") + method, std::string("Dual operator/Preconditioner=") + kind});
        const std::string name =
            std::string(method) + ", " + kind + (tolerance < 1e-16 ? ", 1e-18" : ", 1e-15");
        if (testComm()->getRank() == 0)
          std::cout << run.report.reason << std::endl;
        tellFigure("products, " + name, products(run.report));
        tellFigure("deviation, " + name, deviation(reference, run).largest());
      }
}
