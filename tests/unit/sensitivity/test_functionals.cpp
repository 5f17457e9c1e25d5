// SPDX-License-Identifier: BSD-3-Clause

/// What functionals of an answer are: their partial derivatives against differences of values with other
/// forces, signs by the balance of forces, bounds of norms.

#include "Harmos_DesignDerivatives.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace test_functionals {

using namespace Harmos;
using sensitivity::Functional;
using sensitivity::PressureNorm;
using sensitivity::PressureSpread;
using sensitivity::Resultant;

namespace {

constexpr double tolerance = 1e-12; // of the solver

struct Solved {
  ContactCase problem;
  int surface;
  sensitivity::RowGeometry geometry;
  std::vector<double> forces;

  Solved(bool isSpace, bool onPlane)
      : problem(pressedBlocks(isSpace, onPlane, isSpace ? 2 : 6, 0.002), contactCaseParameters(tolerance)),
        surface(problem.effect(onPlane ? "Obstacle" : "Contact")),
        geometry(problem.geometry()) {
    EXPECT_TRUE(problem.solver->solve().converged);
    forces = problem.solver->rowForces();
  }
  double value(const Functional& functional, const std::vector<double>& with) const {
    return functional.value({*problem.solver, with, geometry});
  }
};

// The place among this rank's rows of a number of contact points, −1 on other ranks.
long long placeOf(const Solved& item, long long number) {
  for (std::size_t r = 0; r < item.problem.contact.rows.size(); ++r)
    if (item.problem.contact.rows[r].kind == ConstraintRow::Kind::Inequality &&
        item.problem.contact.rows[r].number == number)
      return static_cast<long long>(r);
  return -1;
}

} // namespace

// ∂Φ/∂λ_r of points that bear something and of those that do not, where pressures have no kink.
TEST(Functionals, partials_agree_with_differences) {
  for (bool isSpace : {false, true})
    for (bool onPlane : {false, true}) {
      const Solved item(isSpace, onPlane);
      const double mean =
          sensitivity::pressureSummary(*testComm(), item.forces, item.geometry, {item.surface}).mean;
      for (const auto& [name, functional] : functionalsOf(item.problem, item.surface)) {
        if (name == "energy")
          continue;
        const Functional::Partials partials =
            functional->partials({*item.problem.solver, item.forces, item.geometry});
        for (long long number = 0; number < item.problem.contact.pointCount; ++number) {
          const long long r = placeOf(item, number);
          const double area =
              globalMax(*testComm(), r >= 0 ? item.geometry.areas[static_cast<std::size_t>(r)] : 0.0);
          const double step = 1e-5 * mean * area;
          const auto valueAt = [&](double by) {
            std::vector<double> forces = item.forces;
            if (r >= 0)
              forces[static_cast<std::size_t>(r)] += by;
            return item.value(*functional, forces);
          };
          const double force =
              globalMax(*testComm(), r >= 0 ? item.forces[static_cast<std::size_t>(r)] : 0.0);
          if (force <= 2.0 * step) // a pull is none; to the other side powers of less than two are steep
            continue;
          const double difference = (valueAt(step) - valueAt(-step)) / (2.0 * step);
          const double partial =
              partials.forces.empty() || r < 0 ? 0.0 : partials.forces[static_cast<std::size_t>(r)];
          // Errors of the second order, of powers up to six of the pressure: (6 · 1e-5)²; and rounding
          // errors.
          const double size = item.value(*functional, item.forces) / (mean * area);
          EXPECT_NEAR(globalSum(*testComm(), partial), difference, 1e-7 * std::abs(size))
              << name << ", point " << number << (isSpace ? ", space" : ", plane")
              << (onPlane ? ", obstacle" : "");
        }
      }
    }
}

// lᵀu is what it says, whatever copies share it.
TEST(Functionals, displacements_of_copies) {
  const Solved item(false, false);
  feti::TornVector weights = randomWeights(item.problem, 3);
  const sensitivity::LinearDisplacement functional(weights);
  const double value = item.value(functional, item.forces);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    for (std::size_t j = 0; j < weights[i].size(); ++j)
      sum += weights[i][j] * item.problem.solver->displacement()[i][j];
  EXPECT_NEAR(value, globalSum(*testComm(), sum), 1e-14 * std::abs(value) + 1e-16);
  EXPECT_EQ(functional.partials({*item.problem.solver, item.forces, item.geometry}).displacement, weights);
  EXPECT_TRUE(functional.partials({*item.problem.solver, item.forces, item.geometry}).forces.empty());
}

// The upper body is pressed down, the first body of a contact with it is the lower one; on a plane the first
// body is the one that rests on it.
TEST(Functionals, resultants_balance_the_loads) {
  for (bool isSpace : {false, true})
    for (bool onPlane : {false, true}) {
      const Solved item(isSpace, onPlane);
      const std::size_t components = isSpace ? 3 : 2, up = components - 1;
      double load = 0.0;
      for (int i = 0; i < item.problem.solver->system().size(); ++i) {
        const std::vector<double>& f = *item.problem.solver->system().subdomain(i).load;
        for (std::size_t j = up; j < f.size(); j += components)
          load += f[j];
      }
      load = globalSum(*testComm(), load);
      EXPECT_LT(load, -0.05);
      fem::Point direction{};
      direction[up] = 1.0;
      const double resultant = item.value(Resultant({item.surface}, direction), item.forces);
      // Nothing else bears it: sides slide, and prescribed components are others.
      EXPECT_NEAR(resultant, onPlane ? -load : load, 1e4 * tolerance * std::abs(load)) << isSpace << onPlane;
      direction[up] = 2.0;
      EXPECT_NEAR(item.value(Resultant({item.surface}, direction), item.forces), 2.0 * resultant,
                  1e-14 * std::abs(load));
      EXPECT_EQ(item.value(Resultant({item.surface + 17}, direction), item.forces), 0.0);
    }
}

// Between the mean and the peak, rising with the exponent; a uniform pressure has no spread, and its norms
// are all the same.
TEST(Functionals, norms_and_spread_of_pressures) {
  const Solved item(true, false);
  const std::set<int> surfaces = {item.surface};
  const sensitivity::PressureSummary summary =
      sensitivity::pressureSummary(*testComm(), item.forces, item.geometry, surfaces);
  EXPECT_NEAR(summary.area, 2.0, 1e-12);
  double last = summary.mean;
  for (double exponent : {1.5, 2.0, 4.0, 16.0, 200.0}) {
    const double norm = item.value(PressureNorm(surfaces, exponent), item.forces);
    EXPECT_GE(norm, last * (1.0 - 1e-14)) << exponent;
    last = norm;
  }
  EXPECT_LE(last, summary.peak);
  // (a/Σa)^(1/q) of the peak's point alone.
  EXPECT_GE(last, 0.97 * summary.peak);
  const double square = item.value(PressureNorm(surfaces, 2.0), item.forces) / summary.mean;
  EXPECT_NEAR(item.value(PressureSpread(surfaces), item.forces), square * square - 1.0, 1e-12);

  std::vector<double> uniform;
  for (double area : item.geometry.areas)
    uniform.push_back(0.7 * area);
  EXPECT_NEAR(item.value(PressureSpread(surfaces), uniform), 0.0, 1e-14);
  EXPECT_NEAR(item.value(PressureNorm(surfaces, 9.0), uniform), 0.7, 1e-14);
  // Pressures in other units: powers do not overflow.
  for (double& force : uniform)
    force *= 1e200;
  EXPECT_NEAR(item.value(PressureNorm(surfaces, 9.0), uniform) / 1e200, 0.7, 1e-13);
}

TEST(Functionals, that_there_are_not) {
  const Solved item(false, true);
  const std::set<int> surfaces = {item.surface};
  for (double exponent : {1.0, 0.5, -2.0, std::nan("")})
    EXPECT_TRUE(
        contains(inputErrorOf([&] { PressureNorm norm(surfaces, exponent); }), "give an exponent above 1"))
        << exponent;
  const std::string nowhere =
      inputErrorOf([&] { item.value(PressureSpread({item.surface + 1}), item.forces); });
  EXPECT_TRUE(contains(nowhere, "the surfaces whose pressure is the cost have no contact points")) << nowhere;
  const std::vector<double> none(item.forces.size(), 0.0);
  for (const std::shared_ptr<Functional>& functional :
       {std::shared_ptr<Functional>(std::make_shared<PressureNorm>(surfaces, 4.0)),
        std::shared_ptr<Functional>(std::make_shared<PressureSpread>(surfaces))}) {
    EXPECT_THROW(item.value(*functional, none), sensitivity::RefusedDesign);
    EXPECT_THROW(functional->partials({*item.problem.solver, none, item.geometry}),
                 sensitivity::RefusedDesign);
  }
  EXPECT_EQ(item.value(Resultant(surfaces, {0.0, 1.0, 0.0}), none), 0.0);
}

} // namespace test_functionals
