// SPDX-License-Identifier: BSD-3-Clause

/// Quadratic programs whose feasible set has discs beside intervals, as friction with a given bound has in
/// space: solvers against an interior-point method, the proven decrease, certificates, units.

#include "Harmos_InteriorPoint.hpp"
#include "Harmos_RandomQp.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace test_discs {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

Teuchos::RCP<Teuchos::ParameterList> parameters(double tolerance) {
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  return list;
}

// How far x is outside.
double outside(const SmallQp& qp, const std::vector<double>& x) {
  double most = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    most = std::max({most, qp.lower[i] - x[i], x[i] - qp.upper[i]});
  for (const Disc& disc : qp.discs)
    most = std::max(most, std::hypot(x[static_cast<std::size_t>(disc.first)] - disc.centre[0],
                                     x[static_cast<std::size_t>(disc.second)] - disc.centre[1]) -
                              disc.radius);
  return most;
}

} // namespace

// The oracle itself, where another one is there.
TEST(Discs, interior_points_agree_with_enumeration) {
  std::mt19937 random(5);
  for (int k = 0; k < 40; ++k) {
    const SmallQp qp = randomQp(random, 3 + k % 4, k % 3, true);
    EXPECT_LE(distance(interiorPoint(qp), bruteForce(qp)), 1e-10 * (1.0 + norm(bruteForce(qp)))) << k;
  }
}

TEST(Discs, five_hundred_random_friction_problems) {
  std::mt19937 random(2012);
  int runs = 0, rims = 0, insides = 0, sets = 0, handedOver = 0, penalties = 0, penaltiesConverged = 0;
  std::vector<int> products, productsOfSteps;
  for (int k = 0; k < 500; ++k) {
    const int equalities = k % 3;
    const SmallQp qp = randomFrictionQp(random, 3 + k % 8, equalities);
    const std::vector<double> expected = interiorPoint(qp);
    for (const Disc& disc : qp.discs)
      (std::hypot(expected[static_cast<std::size_t>(disc.first)] - disc.centre[0],
                  expected[static_cast<std::size_t>(disc.second)] - disc.centre[1]) >
               (1.0 - 1e-8) * disc.radius
           ? rims
           : insides) += 1;
    std::vector<std::string> names = {equalities > 0 ? "SMALBE" : "MPRGP", "PDAS"};
    if (k % 10 < 3) {
      names.push_back("Auto");
      // Steps of 1/‖A + ρCᵀC‖ along rims: some thousand for a digit.
      if (equalities > 0 && k < 60)
        names.push_back("Dual Penalty");
    }
    for (const std::string& name : names) {
      // Of ‖b‖ some 10, eigenvalues from 1: x is off by 1e-9 then. A penalty's answers have an error of
      // their own.
      const bool isPenalty = name == "Dual Penalty";
      const auto list = parameters(1e-10);
      list->set("Maximum Iterations", 30000);
      const DistributedQp distributed(qp);
      if (k % 2 == 1) {
        distributed.precondition(jacobi(qp.a));
      }
      const auto solver = TpetraSolverFactory().create(name, list);
      solver->setProblem(distributed.problem);
      const Result result = solver->solve();
      const std::string what = name + " " + std::to_string(k);
      penalties += isPenalty ? 1 : 0;
      if (isPenalty && !result.converged())
        continue;
      penaltiesConverged += isPenalty ? 1 : 0;
      ASSERT_TRUE(result.converged()) << what << ": " << result.explanation;
      const std::vector<double> x = fromVector(*distributed.solution);
      EXPECT_LE(outside(qp, x), 1e-14 * (1.0 + norm(x))) << what;
      EXPECT_LE(distance(x, expected), (isPenalty ? 1e-2 : 1e-8) * (1.0 + norm(expected))) << what;
      ++runs;
      if (name == "PDAS") {
        ++sets;
        handedOver += result.counters.safeguards > 0 ? 1 : 0;
        products.push_back(result.counters.hessianApplications);
      } else if (name == "SMALBE" || name == "MPRGP") {
        productsOfSteps.push_back(result.counters.hessianApplications);
      }
    }
  }
  EXPECT_GT(runs, 1100);
  EXPECT_GT(penaltiesConverged, 0) << penaltiesConverged << " of " << penalties;
  // Newton's method on rims: a fraction of the products, where it need not hand over.
  EXPECT_EQ(sets, 500);
  EXPECT_LE(handedOver, 10);
  const auto median = [](std::vector<int> numbers) {
    std::sort(numbers.begin(), numbers.end());
    return numbers[numbers.size() / 2];
  };
  EXPECT_LE(3 * median(products), median(productsOfSteps));
  if (testComm()->getRank() == 0)
    std::cout << "dual penalty: " << penaltiesConverged << " of " << penalties
              << "; products, median: " << median(products) << " by sets, " << median(productsOfSteps)
              << " by steps; " << handedOver << " handed over\n";
  EXPECT_GT(rims, 300);
  EXPECT_GT(insides, 100);
}

// Steps along rims that take a quarter of the iterations leave the rest to sets, which do not hand back.
TEST(Discs, steps_that_take_long_hand_over) {
  std::mt19937 random(410);
  int handedOver = 0;
  for (int k = 0; k < 20; ++k) {
    const SmallQp qp = randomFrictionQp(random, 10, k % 3);
    const auto list = parameters(1e-10);
    list->set("Maximum Iterations", 120); // sets take some 20, steps some 200
    const DistributedQp distributed(qp);
    const auto solver = TpetraSolverFactory().create(k % 3 > 0 ? "SMALBE" : "MPRGP", list);
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    ASSERT_TRUE(result.converged()) << k << ": " << result.explanation;
    const std::vector<double> x = fromVector(*distributed.solution), expected = interiorPoint(qp);
    EXPECT_LE(distance(x, expected), 1e-8 * (1.0 + norm(expected))) << k; // as above
    EXPECT_LE(result.lastRecord().inner, 120);
    handedOver += result.counters.safeguards > 0 ? 1 : 0;
  }
  EXPECT_GT(handedOver, 10);
}

// A round patch on a half space, dragged and twisted, under Hertz' pressure: from stick nearly everywhere to
// slip nearly everywhere. Compliances are those of Mindlin's point forces, that of a point itself h·3.5.
TEST(Discs, patch_dragged_and_twisted) {
  constexpr int half = 6;
  constexpr double h = 1.0 / half, poisson = 0.3;
  std::vector<std::array<double, 2>> points;
  for (int i = -half; i <= half; ++i)
    for (int j = -half; j <= half; ++j)
      if (const double x = (i + 0.3) * h, y = (j + 0.1) * h; x * x + y * y < 0.98)
        points.push_back({x, y});
  const int n = static_cast<int>(points.size());
  const std::vector<double> none(static_cast<std::size_t>(2 * n), infinity);
  for (const auto& [drag, least, most] : {std::make_tuple(0.3, 0.0, 0.1), std::make_tuple(3.0, 0.5, 0.9)}) {
    SmallQp qp{Dense(2 * n, 2 * n), {}, none, none, Dense(0, 2 * n), {}};
    for (double& bound : qp.lower)
      bound = -infinity;
    for (int p = 0; p < n; ++p) {
      const auto& at = points[static_cast<std::size_t>(p)];
      for (int q = 0; q < n; ++q) {
        const auto& other = points[static_cast<std::size_t>(q)];
        const double d[] = {at[0] - other[0], at[1] - other[1]}, r = std::hypot(d[0], d[1]);
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j)
            qp.a(2 * p + i, 2 * q + j) =
                p == q ? (i == j ? 3.5 * h : 0.0)
                       : h * h * ((i == j ? (1.0 - poisson) / r : 0.0) + poisson * d[i] * d[j] / (r * r * r));
      }
      qp.b.insert(qp.b.end(), {drag * (1.0 - 0.5 * at[1]), drag * 0.5 * at[0]});
      qp.discs.push_back({2 * p, 2 * p + 1, {0.0, 0.0}, std::sqrt(1.0 - at[0] * at[0] - at[1] * at[1])});
    }
    std::vector<std::vector<double>> answers;
    for (const char* method : {"PDAS", "MPRGP"}) {
      const DistributedQp distributed(qp);
      const auto solver = TpetraSolverFactory().create(method, parameters(1e-8));
      solver->setProblem(distributed.problem);
      const Result result = solver->solve();
      ASSERT_TRUE(result.converged()) << result.explanation;
      EXPECT_EQ(result.counters.safeguards, 0);
      answers.push_back(fromVector(*distributed.solution));
      if (answers.size() == 1)
        EXPECT_LE(result.counters.activeSetUpdates, 25);
      const double slipping = static_cast<double>(result.history.back().active) / (2.0 * n);
      EXPECT_TRUE(slipping >= least && slipping <= most) << slipping;
      if (testComm()->getRank() == 0)
        std::cout << n << " points, " << slipping << " slip: " << method << " "
                  << result.counters.activeSetUpdates << " sets, " << result.counters.hessianApplications
                  << " products\n";
    }
    // Both gradients vanish to 1e-8‖b‖; the least eigenvalue is some h.
    EXPECT_LE(distance(answers[0], answers[1]), 2.0 * 1e-8 * norm(qp.b) / h) << drag;
  }
}

TEST(Discs, units_change_nothing) {
  std::mt19937 random(3);
  for (int k = 0; k < 40; ++k) {
    const SmallQp qp = randomFrictionQp(random, 6, k % 2);
    const char* method = k % 4 < 2 ? "PDAS" : "Auto"; // which is MPRGP or SMALBE
    std::vector<int> products;
    std::vector<std::vector<double>> answers;
    for (double unit : {1.0, std::ldexp(1.0, 40), std::ldexp(1.0, -40)}) { // powers of two: the same bits
      SmallQp scaled = qp;
      for (std::vector<double>* values : {&scaled.b, &scaled.lower, &scaled.upper, &scaled.cRhs})
        for (double& value : *values)
          value *= unit;
      for (Disc& disc : scaled.discs) {
        disc.radius *= unit;
        for (double& entry : disc.centre)
          entry *= unit;
      }
      const DistributedQp distributed(scaled);
      const auto solver = TpetraSolverFactory().create(method, parameters(1e-9));
      solver->setProblem(distributed.problem);
      const Result result = solver->solve();
      ASSERT_TRUE(result.converged());
      products.push_back(result.counters.hessianApplications);
      answers.push_back(fromVector(*distributed.solution));
      for (double& value : answers.back())
        value /= unit;
    }
    for (int other : {1, 2}) {
      EXPECT_EQ(products[static_cast<std::size_t>(other)], products[0]) << method << k;
      EXPECT_EQ(answers[static_cast<std::size_t>(other)], answers[0]) << k;
    }
  }
}

// x_0 + x_1 ≤ m_0 + m_1 + √2 r in a disc: a sum beyond that is proved impossible, one just within is found.
TEST(Discs, what_no_disc_allows_is_proved) {
  for (double beyond : {1e-3, -0.1}) {
    SmallQp qp{
        Dense(3, 3), {0.0, 0.0, 0.0}, {-infinity, -infinity, 0.0}, {infinity, infinity, 0.5}, Dense(1, 3),
        {}};
    for (int i = 0; i < 3; ++i) {
      qp.a(i, i) = 1.0;
      qp.c(0, i) = 1.0;
    }
    qp.discs = {{0, 1, {0.3, -0.1}, 2.0}};
    qp.cRhs = {0.2 + 2.0 * std::sqrt(2.0) + 0.5 + beyond};
    const DistributedQp distributed(qp);
    const auto solver = TpetraSolverFactory().create("SMALBE", parameters(1e-8));
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    EXPECT_EQ(result.reason, beyond > 0.0 ? Reason::Infeasible : Reason::Converged) << result.explanation;
    if (beyond > 0.0)
      EXPECT_NEAR(result.certificate.gap, beyond, 0.5 * beyond);
  }
}

// A is singular along x_2, which the load pulls and nothing holds; in a disc it could not go far.
TEST(Discs, without_end_only_beside_them) {
  for (bool isHeld : {false, true}) {
    SmallQp qp{Dense(4, 4), {1.0, 1.0, 1.0, 1.0}, {}, {}, Dense(0, 4), {}};
    qp.a(0, 0) = qp.a(1, 1) = 1.0;
    qp.discs = {{0, 1, {0.0, 0.0}, 0.5}};
    if (isHeld)
      qp.discs.push_back({2, 3, {1.0, 0.0}, 0.5});
    const DistributedQp distributed(qp);
    const auto solver = TpetraSolverFactory().create("MPRGP", parameters(1e-8));
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    EXPECT_EQ(result.reason, isHeld ? Reason::Converged : Reason::Unbounded) << result.explanation;
    if (isHeld) // the point of the disc that lies farthest along (1, 1)
      EXPECT_LE(distance(fromVector(*distributed.solution),
                         {std::sqrt(0.125), std::sqrt(0.125), 1.0 + std::sqrt(0.125), std::sqrt(0.125)}),
                1e-8);
  }
}

// A bound of zero leaves a point; one below zero nothing; what is no number is refused.
TEST(Discs, radii) {
  std::mt19937 random(11);
  SmallQp qp = randomFrictionQp(random, 5, 0);
  qp.lower.assign(5, -infinity);
  qp.upper.assign(5, infinity);
  const auto solved = [&](double radius) {
    qp.discs = {{1, 2, {0.25, -0.5}, radius}};
    const DistributedQp distributed(qp);
    const auto solver = TpetraSolverFactory().create("MPRGP", parameters(1e-11));
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    return std::make_pair(result, fromVector(*distributed.solution));
  };
  const auto [point, x] = solved(0.0);
  ASSERT_TRUE(point.converged()) << point.explanation;
  SmallQp pinned = qp;
  pinned.discs.clear();
  for (std::size_t k : {1U, 2U})
    pinned.lower[k] = pinned.upper[k] = k == 1 ? 0.25 : -0.5;
  EXPECT_LE(distance(x, bruteForce(pinned)), 1e-8);
  EXPECT_EQ(solved(-1e-3).first.reason, Reason::Infeasible);

  qp.discs = {{1, 2, {0.25, std::nan("")}, 1.0}};
  const DistributedQp fault(qp);
  EXPECT_FALSE(fault.problem->isProblemSet());
  EXPECT_NE(fault.problem->whyNotSet().find("disc"), std::string::npos) << fault.problem->whyNotSet();

  qp.discs = {{1, 2, {0.25, -0.5}, 1.0}};
  qp.upper[2] = 0.7;
  const DistributedQp both(qp);
  EXPECT_NE(both.problem->whyNotSet().find("bounds of entry 1"), std::string::npos)
      << both.problem->whyNotSet();

  // On one rank alone, and of another length there: told on all.
  qp.upper[2] = infinity;
  const DistributedQp sound(qp);
  const bool isFirst = testComm()->getRank() == 0;
  sound.problem->setDiscs(isFirst ? std::make_shared<LocalDiscs>(std::vector<Disc>(), 99) : nullptr);
  EXPECT_FALSE(sound.problem->setProblem());
  EXPECT_NE(sound.problem->whyNotSet().find(testComm()->getSize() > 1 ? "on some ranks"
                                                                      : "do not match the length"),
            std::string::npos)
      << sound.problem->whyNotSet();
}

} // namespace test_discs
