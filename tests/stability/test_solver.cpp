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
///  - Single precision asked for where it is not enough: materials jump by orders of magnitude. Cure: as
///  below.
///  - Products rounded to 32 bits: the pieces of a slender body bend more when cut than the whole does, and
///    rounding errors show in the jumps that are left. Cure: the run makes products in double precision and
///    goes on from where it is.

#include "Harmos_HardCase.hpp"
#include "Harmos_RandomScene.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

using namespace Harmos;

namespace {

double norm(const std::vector<double>& v) {
  double sum = 0.0;
  for (double value : v)
    sum += value * value;
  return std::sqrt(sum);
}

// ‖g^P‖ and ‖Gλ‖ of the answer, from F, d and G by products of this function's own, and from the multiplier
// that is returned.
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
  const std::vector<double> x = fromVector(lambda), lower = fromVector(*feti.dual.lowerBound());
  feti.coarse.project(lambda);
  feti.dualOperator.apply(lambda, g);
  g.update(-1.0, feti.dual.d(), 1.0);
  feti.coarse.project(g);
  feti.coarse.addGt(1.0, run.mu, g);
  const std::vector<double> gradient = fromVector(g);
  std::vector<double> projected;
  for (std::size_t k = 0; k < x.size(); ++k)
    projected.push_back(x[k] <= lower[k] ? std::min(gradient[k], 0.0) : gradient[k]);
  return {norm(projected), norm(equality)};
}

} // namespace

TEST(Stability, penalty_from_1e_3_to_1e9) {
  const scene::Scene scene = valley();
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  // With ρ = 1e9‖PFP‖ rounding errors of ρGᵀGλ are ε·1e9 = 2e-7 of ‖PFP‖‖λ‖, some ten times ‖Pd‖.
  const double tolerance = 1e-5;
  for (double penalty : {1e-3, 1.0, 1e3, 1e6, 1e9}) {
    std::ostringstream text;
    text << penalty;
    for (const char* kind : {"none", "Dirichlet"}) {
      const TestRun run =
          runScene(scene, tolerance,
                   {"Solver/Method=SMALBE", "Solver/Expert/SMALBE/Initial penalty=" + text.str(),
                    std::string("Dual operator/Preconditioner=") + kind});
      expectReference(reference, run, 1e3 * tolerance, text.str());
      tellFigure("rho = " + text.str() + ", " + kind + ": products", products(run.report));
      tellFigure("rho = " + text.str() + ", " + kind + ": deviation", deviation(reference, run).largest());
    }
    const TestRun off = runScene(
        scene, tolerance, {"Solver/Method=Dual Penalty", "Solver/Expert/Dual Penalty/Penalty=" + text.str()});
    tellFigure("rho = " + text.str() + ", no multiplier: products", products(off.report));
    tellFigure("rho = " + text.str() + ", no multiplier: deviation", deviation(reference, off).largest());
    if (penalty <= 1.0)
      EXPECT_GT(deviation(reference, off).largest(), 0.1);
  }
}

TEST(Stability, tolerance_from_1e_2_to_1e_12) {
  const scene::Scene scene = valley();
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  for (const char* form : {"primal", "dual"})
    for (const char* method : {"PDAS", "SMALBE"})
      for (const char* kind : {"none", "Dirichlet"}) {
        const std::vector<std::string> how = {std::string("Decomposition/Dirichlet=") + form,
                                              std::string("Solver/Method=") + method,
                                              std::string("Dual operator/Preconditioner=") + kind};
        const run::RunOptions options = testOptions(1e-2, how);
        const TestFeti feti(modelOf(scene), options.dirichlet.value_or(feti::DirichletForm::Primal),
                            options.dual.inverses);
        for (double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
          const TornRun run = solveTorn(feti, tolerance, how);
          std::ostringstream name;
          name << form << ", " << method << ", " << kind << ", " << tolerance;
          expectReference(reference, run, 1e2 * tolerance, name.str());
          // What is told, what was asked for, and what is found from F, d and G anew: the last one with
          // rounding errors of its own.
          const run::RunReport& report = run.report;
          const Residuals anew = residualsOf(feti, run);
          const double rounding = 1e-14;
          EXPECT_LE(anew.gradient, (1.01 * tolerance + rounding) * report.gradientScale) << name.str();
          EXPECT_LE(anew.equality, (1.01 * tolerance + rounding) * report.equalityScale) << name.str();
          EXPECT_NEAR(anew.gradient, report.result.projectedGradientNorm,
                      0.1 * anew.gradient + rounding * report.gradientScale)
              << name.str();
          if (kind[0] == 'D' && form[0] == 'p') {
            tellFigure(name.str() + ": products", products(report));
            tellFigure(name.str() + ": deviation", deviation(reference, run).largest());
          }
        }
      }
}

TEST(Stability, stagnation_detected) {
  const scene::Scene scene = valley();
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  for (const char* method : {"PDAS", "SMALBE"}) {
    const std::string how = std::string("Solver/Method=") + method;
    const TestRun run = runScene(scene, 1e-18, {how});
    EXPECT_FALSE(run.report.converged);
    EXPECT_EQ(run.report.result.reason, qp::Reason::Stagnation);
    EXPECT_TRUE(contains(run.report.reason, "at the level of rounding errors")) << run.report.reason;
    // The answer is as good as it gets, and costs little more than one to a tolerance that can be met.
    EXPECT_LE(deviation(reference, run).largest(), 1e-10);
    const double wanted = products(runScene(scene, 1e-12, {how}).report);
    EXPECT_LE(products(run.report), 2.0 * wanted + 10.0);
    tellFigure(std::string(method) + ": products", products(run.report));
    tellFigure(std::string(method) + ": products at 1e-12", wanted);
    tellFigure(std::string(method) + ": deviation", deviation(reference, run).largest());
  }
}

TEST(Stability, products_rounded_too_much) {
  const RandomScene drawn = randomScene(254); // slender strips in plane stress, cut along their length
  const auto with = [&](const std::string& precision) {
    std::vector<std::string> settings = drawn.settings;
    std::replace(settings.begin(), settings.end(), std::string("Dual operator/Precision=double"),
                 "Dual operator/Precision=" + precision);
    EXPECT_NE(std::find(settings.begin(), settings.end(), "Dual operator/Precision=" + precision),
              settings.end());
    settings.push_back("Dual operator/Expert/Weights=none"); // with them it converges before rounding is seen
    return runScene(drawn.scene, drawn.tolerance, settings);
  };
  const TestRun exact = with("double"), rounded = with("auto");
  for (const TestRun* run : {&exact, &rounded}) {
    EXPECT_TRUE(run->report.converged) << run->report.reason;
    EXPECT_TRUE(feti::auditAgrees(run->report));
    EXPECT_EQ(run->report.roundedFactorizations, 0);
  }
  // Products were rounded at first, and then made anew.
  EXPECT_NE(rounded.report.dualOperator.find("mixed"), std::string::npos) << rounded.report.dualOperator;
  EXPECT_GT(rounded.report.factorisations, exact.report.factorisations);
  // Each energy is exact to ten tolerances at most.
  EXPECT_NEAR(rounded.report.audit.energy / exact.report.audit.energy, 1.0, 20.0 * drawn.tolerance);
  // The second solve begins where the first has ended: together little more than what is asked for at once.
  EXPECT_LE(products(rounded.report), 2.0 * products(exact.report));
  // Rows are counted on.
  const std::vector<qp::IterationRecord>& history = rounded.report.result.history;
  for (std::size_t k = 1; k < history.size(); ++k)
    EXPECT_GE(history[k].hessianApplications, history[k - 1].hessianApplications);
  tellFigure("products in double precision", products(exact.report));
  tellFigure("products, rounded at first", products(rounded.report));
}

TEST(Stability, single_precision_not_enough) {
  for (unsigned seed : {127u, 1406u}) { // materials that jump; dense blocks, and factors
    const RandomScene drawn = randomScene(seed);
    std::vector<std::string> settings = drawn.settings;
    const auto precision =
        std::find(settings.begin(), settings.end(), std::string("Dual operator/Precision=single"));
    ASSERT_NE(precision, settings.end());
    const TestRun single = runScene(drawn.scene, drawn.tolerance, settings);
    *precision = "Dual operator/Precision=double";
    const TestRun exact = runScene(drawn.scene, drawn.tolerance, settings);
    for (const TestRun* run : {&exact, &single}) {
      EXPECT_TRUE(run->report.converged) << seed << " " << run->report.reason;
      EXPECT_TRUE(feti::auditAgrees(run->report)) << seed;
    }
    if (seed == 127u) // the other one is at the limit
      EXPECT_FALSE(single.report.isSingle);
    EXPECT_NE(single.report.dualOperator.find("single"), std::string::npos) << single.report.dualOperator;
    EXPECT_NEAR(single.report.audit.energy / exact.report.audit.energy, 1.0, 20.0 * drawn.tolerance) << seed;
    tellFigure(std::to_string(seed) + ": products in double precision", products(exact.report));
    tellFigure(std::to_string(seed) + ": products, in single precision at first", products(single.report));
  }
}
