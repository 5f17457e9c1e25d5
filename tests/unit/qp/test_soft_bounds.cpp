// SPDX-License-Identifier: BSD-3-Clause

/// Entries that may leave their intervals against a curvature.

#include "Harmos_InteriorPoint.hpp"
#include "Harmos_MemoryArchive.hpp"
#include "Harmos_RandomQp.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace test_soft_bounds {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

Teuchos::RCP<Teuchos::ParameterList> parameters(double tolerance) {
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  return list;
}

struct Outcome {
  Result result;
  std::vector<double> x;
};

Outcome solved(const SmallQp& qp, const std::string& method, const Teuchos::RCP<Teuchos::ParameterList>& list,
               bool isPreconditioned) {
  const DistributedQp distributed(qp);
  EXPECT_TRUE(distributed.problem->isProblemSet()) << distributed.problem->whyNotSet();
  if (isPreconditioned)
    distributed.precondition(jacobi(qp.a));
  const auto solver = TpetraSolverFactory().create(method, list);
  solver->setProblem(distributed.problem);
  Outcome run;
  run.result = solver->solve();
  run.x = fromVector(*distributed.solution);
  return run;
}

// Few enough to enumerate.
SmallQp randomSoftQp(std::mt19937& random, int k, double least, double most) {
  constexpr std::size_t mostSoft = 4;
  while (true) {
    SmallQp qp = k % 4 == 3 ? randomFrictionQp(random, 3 + k % 5, k % 3)
                            : randomQp(random, 3 + k % 5, k % 3, k % 2 == 0);
    addSoftBounds(random, qp, least, most);
    if (!qp.soft.empty() && qp.soft.size() <= mostSoft)
      return qp;
  }
}

std::vector<double> reference(const SmallQp& qp) {
  return bruteForceOfSides(qp, [](const SmallQp& plain) {
    if (plain.discs.empty())
      return bruteForce(plain);
    // Now and then Newton's method gets stuck there.
    const std::vector<double> x = interiorPoint(plain);
    return norm(equalityResidual(plain, x)) <= 1e-9 ? x : std::vector<double>();
  });
}

} // namespace

TEST(SoftBounds, random_problems_against_enumeration) {
  std::mt19937 random(23);
  int held = 0, known = 0, inside = 0, outside = 0;
  for (int k = 0; k < 400; ++k) {
    const SmallQp qp = randomSoftQp(random, k, 1e-6, 1e3);
    const std::vector<double> expected = reference(qp);
    if (expected.empty())
      continue;
    ++known;
    for (const SoftBound& bound : qp.soft) {
      const double at = expected[static_cast<std::size_t>(bound.entry)];
      (at < bound.lower || at > bound.upper ? outside : inside) += 1;
    }
    const auto list = parameters(1e-10);
    if (k % 3 == 0) // sides are held as soon as that may be
      list->sublist("Expert").sublist("PDAS").set("Active sets without progress", 1);
    const Outcome run = solved(qp, k % 5 == 0 ? "Auto" : "PDAS", list, k % 2 == 1);
    ASSERT_TRUE(run.result.converged()) << k << ": " << run.result.explanation;
    held += run.result.counters.descents;
    // Of ‖b‖ some 10, eigenvalues from 1: x is off by 1e-9 then; interior points by 1e-10.
    EXPECT_LE(distance(run.x, expected), 1e-8 * (1.0 + norm(expected))) << k;
  }
  if (testComm()->getRank() == 0)
    std::cout << known << " known, " << outside << " entries outside, " << inside << " inside; sides held "
              << held << " times\n";
  EXPECT_GT(known, 380);
  EXPECT_GT(outside, 100);
  EXPECT_GT(inside, 100);
}

// Newton's method on sides goes round in circles on one in some hundreds of these, with exact solutions too:
// the cost has to fall.
TEST(SoftBounds, sides_that_go_in_circles) {
  constexpr int trials = 2000;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  int held = 0;
  for (int k = 0; k < trials; ++k) {
    const int n = 3 + k % 3;
    SmallQp qp{withSpectrum(randomOrthonormal(random, n), 0, std::pow(10.0, 1.0 + 3.0 * unit(random))),
               {},
               {},
               {},
               Dense(0, n),
               {}};
    double mean = 0.0;
    for (int i = 0; i < n; ++i)
      mean += qp.a(i, i) / n;
    for (int i = 0; i < n; ++i) {
      qp.b.push_back(10.0 * normal(random));
      qp.soft.push_back({i, normal(random), infinity, mean * std::pow(10.0, -1.0 + 4.0 * unit(random))});
    }
    const auto list = parameters(1e-9);
    list->sublist("Expert").sublist("PDAS").set("Inner reduction", 1e-6); // as exact as it takes for circles
    const Outcome run = solved(qp, "PDAS", list, false);
    ASSERT_TRUE(run.result.converged()) << k << ": " << run.result.explanation;
    held += run.result.counters.descents;
    std::vector<double> gradient = lagrangianGradient(qp, run.x, {});
    for (const SoftBound& bound : qp.soft) {
      const auto i = static_cast<std::size_t>(bound.entry);
      gradient[i] += bound.curvature * std::min(0.0, run.x[i] - bound.lower);
    }
    EXPECT_LE(norm(gradient), 1.01e-9 * norm(qp.b)) << k;
  }
  if (testComm()->getRank() == 0)
    std::cout << "sides held in " << held << " of " << trials << "\n";
  EXPECT_GT(held, 0);
}

namespace {

// Flexibilities of a string on an elastic bed, with loads of its own; rows that sum over parts of it. All
// entries are soft: half to one side, half to both.
SmallQp softString(int n, double share) {
  SmallQp qp{Dense(n, n), {}, {}, {}, Dense(4, n), std::vector<double>(4, 0.0)};
  double mean = 0.0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j)
      qp.a(i, j) = std::exp(-0.2 * std::abs(i - j));
    mean += qp.a(i, i) / n;
    qp.b.push_back(2.0 * std::sin(0.11 * i) + std::sin(0.7 * i));
  }
  for (int k = 0; k < 4; ++k) {
    for (int i = k * n / 4; i < (k + 1) * n / 4; ++i)
      qp.c(k, i) = 1.0;
    qp.cRhs[static_cast<std::size_t>(k)] = 0.5 * k - 0.5;
  }
  for (int i = 0; i < n; ++i)
    qp.soft.push_back({i, 0.0, i % 2 == 0 ? infinity : 0.0, share * mean});
  return qp;
}

} // namespace

// Rows are sums over entries that are all springs: what they hold is held by nothing else. Stiff ones leave
// less to be found than soft ones, which are as good as free.
TEST(SoftBounds, products_do_not_depend_on_stiffness) {
  constexpr int n = 120;
  constexpr double tolerance = 1e-8;
  for (bool isPreconditioned : {true, false}) {
    std::vector<int> products;
    for (double share = 1e-6; share < 2e6; share *= 100.0) {
      const SmallQp qp = softString(n, share);
      const DistributedQp distributed(qp);
      if (isPreconditioned) { // A⁻¹ is that of a bed and a string: tridiagonal, up to its ends
        Dense inverse(n, n);
        const double r = std::exp(-0.2), scale = 1.0 / (1.0 - r * r);
        for (int i = 0; i < n; ++i) {
          inverse(i, i) = 1.3 * scale * (1.0 + r * r); // a bit off
          if (i + 1 < n)
            inverse(i, i + 1) = inverse(i + 1, i) = -r * scale;
        }
        distributed.precondition(inverse);
      }
      const auto solver = TpetraSolverFactory().create("PDAS", parameters(tolerance));
      solver->setProblem(distributed.problem);
      const Result result = solver->solve();
      ASSERT_TRUE(result.converged()) << share << ": " << result.explanation;
      products.push_back(result.counters.hessianApplications);
      // The gradient with springs, by definition.
      const std::vector<double> x = fromVector(*distributed.solution);
      std::vector<double> gradient = lagrangianGradient(qp, x, fromVector(*distributed.multiplier));
      for (const SoftBound& bound : qp.soft) {
        const auto i = static_cast<std::size_t>(bound.entry);
        gradient[i] += bound.curvature * (x[i] - std::clamp(x[i], bound.lower, bound.upper));
      }
      EXPECT_LE(norm(gradient), 1.01 * tolerance * norm(qp.b)) << share;
      EXPECT_LE(norm(equalityResidual(qp, x)), 1e-10 * norm(x)) << share;
      if (testComm()->getRank() == 0)
        std::cout << (isPreconditioned ? "preconditioned" : "not preconditioned") << ", stiffness " << share
                  << " of the mean: " << products.back() << " products, " << result.counters.activeSetUpdates
                  << " sets\n";
    }
    EXPECT_LE(*std::max_element(products.begin(), products.end()),
              (isPreconditioned ? 1.1 : 1.25) * products.front());
  }
}

// What is to become nearly nothing, against curvatures that made forces of a hundred million of it where it
// began: the rounding errors which these leave are not those of the answer.
TEST(SoftBounds, springs_that_begin_far_from_where_they_end) {
  constexpr int n = 12;
  constexpr double curvature = 1e8, tolerance = 1e-12;
  SmallQp qp{Dense(n, n), {}, {}, {}, Dense(0, n), {}};
  for (int i = 0; i < n; ++i) {
    qp.a(i, i) = 1.0;
    qp.b.push_back(-1.0 - 0.1 * i);
    qp.soft.push_back({i, 0.0, infinity, curvature});
  }
  const DistributedQp distributed(qp);
  distributed.solution->putScalar(-1.0);
  const auto solver = TpetraSolverFactory().create("PDAS", parameters(tolerance));
  solver->setProblem(distributed.problem);
  const Result result = solver->solve();
  ASSERT_TRUE(result.converged()) << result.explanation;
  const std::vector<double> x = fromVector(*distributed.solution);
  for (std::size_t i = 0; i < x.size(); ++i)
    EXPECT_NEAR(x[i], qp.b[i] / (1.0 + curvature), 1.01 * tolerance * norm(qp.b) / curvature) << i;
}

// The first face holds too much for the rows, and nothing else takes soft bounds: sides are frozen, and faces
// descend. With other values of the rows nothing meets them, which is proven as without soft bounds.
TEST(SoftBounds, faces_that_cannot_meet_the_rows) {
  SmallQp qp = {Dense(3, 3), {-10.0, 10.0, -10.0}, {0.0, -infinity, 0.0}, {}, Dense(2, 3), {}};
  for (int i = 0; i < 3; ++i)
    qp.a(i, i) = 1.0;
  qp.soft = {{1, -infinity, 10.0, 1.0}};
  qp.c(0, 0) = qp.c(0, 1) = qp.c(1, 1) = qp.c(1, 2) = 1.0;
  for (const bool isPreconditioned : {false, true}) {
    qp.cRhs = {1.0, 1.5};
    const Outcome run = solved(qp, "PDAS", parameters(1e-10), isPreconditioned);
    ASSERT_TRUE(run.result.converged()) << run.result.explanation;
    EXPECT_LE(distance(run.x, {0.0, 1.0, 0.5}), 1e-9); // ‖b‖ times the tolerance, eigenvalues from 1
  }
  qp.lower = {0.0, 0.0, -infinity};
  qp.soft = {{2, -infinity, 10.0, 1.0}};
  qp.cRhs = {-1.0, 1.5};
  EXPECT_EQ(solved(qp, "PDAS", parameters(1e-10), false).result.reason, Reason::Infeasible);
}

TEST(SoftBounds, others_refuse_them) {
  std::mt19937 random(3);
  const SmallQp qp = softString(8, 1.0);
  for (const char* method : {"MPRGP", "SMALBE", "PCPG", "Dual Penalty"}) {
    const DistributedQp distributed(qp);
    const auto solver = TpetraSolverFactory().create(method, parameters(1e-8));
    solver->setProblem(distributed.problem);
    const std::string said = inputErrorOf([&] { solver->solve(); });
    EXPECT_TRUE(contains(said, method) && contains(said, "soft bounds") && contains(said, "use PDAS or Auto"))
        << said;
  }
}

TEST(SoftBounds, bad_ones_are_refused) {
  const SmallQp good = softString(8, 1.0);
  const auto faultOf = [](const SmallQp& qp) { return DistributedQp(qp).problem->whyNotSet(); };
  EXPECT_EQ(faultOf(good), "");
  SmallQp crossed = good, negative = good, noNumber = good, bounded = good, inDisc = good;
  crossed.soft[2] = {2, 1.0, 0.5, 1.0};
  negative.soft[2].curvature = -1.0;
  noNumber.soft[2].lower = std::numeric_limits<double>::quiet_NaN();
  bounded.lower.assign(8, -infinity);
  bounded.lower[3] = 0.0;
  inDisc.discs = {{4, 5, {0.0, 0.0}, 1.0}};
  for (const SmallQp* qp : {&crossed, &negative, &noNumber, &bounded, &inDisc})
    EXPECT_TRUE(contains(faultOf(*qp), "soft bound")) << faultOf(*qp);
}

// Forces that friction limits, beside free entries that are springs: against enumeration of these by PDAS
// without soft bounds.
TEST(SoftBounds, beside_limits_that_follow) {
  std::mt19937 random(29);
  int known = 0;
  for (int k = 0; k < 40; ++k) {
    SmallQp qp = followingQp(random, 3, 1 + k % 2, 3, k % 3, 0.4);
    for (int i = qp.size() - 3; i < qp.size(); ++i) // the free ones
      qp.soft.push_back({i, i % 2 == 0 ? -0.2 : 0.1, i % 2 == 0 ? infinity : 0.1, std::pow(10.0, k % 5 - 2)});
    const std::vector<double> expected = bruteForceOfSides(qp, [](const SmallQp& plain) {
      const Outcome run = solved(plain, "PDAS", parameters(1e-11), false);
      return run.result.converged() ? run.x : std::vector<double>();
    });
    if (expected.empty())
      continue;
    ++known;
    const Outcome run = solved(qp, "PDAS", parameters(1e-10), k % 2 == 0);
    ASSERT_TRUE(run.result.converged()) << k << ": " << run.result.explanation;
    EXPECT_LE(distance(run.x, expected), 1e-7 * (1.0 + norm(expected))) << k;
  }
  EXPECT_GT(known, 30);
}

// From every state that was described, springs as they were.
TEST(Resume, with_soft_bounds) {
  std::mt19937 random(31);
  for (int k = 0; k < 8; ++k) {
    SmallQp qp =
        k % 4 == 3 ? randomFrictionQp(random, 12, k % 3, 10.0) : randomQp(random, 24, k % 3, k % 2 == 0, 1e3);
    addSoftBounds(random, qp, 1e-2, 1e2);
    const auto solve = [&](const Teuchos::RCP<MemoryMonitor<MultiVector>>& monitor) {
      const auto list = parameters(1e-7);
      if (k >= 4)
        list->sublist("Expert").sublist("PDAS").set("Active sets without progress", 1);
      const DistributedQp distributed(qp);
      if (k % 2 == 1)
        distributed.precondition(jacobi(qp.a));
      const auto solver = TpetraSolverFactory().create("PDAS", list);
      solver->setProblem(distributed.problem);
      solver->setMonitor(monitor);
      Outcome run;
      run.result = solver->solve();
      run.x = fromVector(*distributed.solution);
      return run;
    };
    const auto watched = Teuchos::rcp(new MemoryMonitor<MultiVector>);
    const Outcome plain = solve(watched);
    ASSERT_TRUE(plain.result.converged()) << k << plain.result.explanation;
    ASSERT_GT(watched->saved.size(), 2u);
    for (std::size_t state = 0; state < watched->saved.size(); state += testComm()->getSize()) {
      const auto monitor = Teuchos::rcp(new MemoryMonitor<MultiVector>);
      monitor->resumed = &watched->saved[state];
      const Outcome run = solve(monitor);
      EXPECT_EQ(run.x, plain.x) << k << ", from " << state;
      EXPECT_EQ(run.result.history.size(), plain.result.history.size()) << k << ", from " << state;
      EXPECT_EQ(run.result.counters.hessianApplications, plain.result.counters.hessianApplications);
    }
  }
}

} // namespace test_soft_bounds
