// SPDX-License-Identifier: BSD-3-Clause

/// Limits that follow the solution, as Coulomb's law has them: in the plane against all states of all points,
/// in space against the program that the answer's own limits make, by an interior-point method.

#include "Harmos_EqualityRows_def.hpp"
#include "Harmos_InteriorPath.hpp"
#include "Harmos_InteriorPoint.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_RandomQp.hpp"
#include "Harmos_SecondOrderCones.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace test_following_limits {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// All solutions in the plane: each point open, stuck, or slipping to either side.
std::vector<std::vector<double>> allSolutions(const SmallQp& qp) {
  const int n = qp.size(), m = qp.c.rows, points = static_cast<int>(qp.follows.size());
  std::vector<std::vector<double>> result;
  int states = 1;
  for (int p = 0; p < points; ++p)
    states *= 4;
  for (int state = 0; state < states; ++state) {
    // Equations of n entries and m multipliers: rows of Ax + Cᵀμ = b are replaced where an entry is held.
    Dense matrix(n + m, n + m);
    std::vector<double> rhs(at(n + m));
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j)
        matrix(i, j) = qp.a(i, j);
      for (int r = 0; r < m; ++r)
        matrix(i, n + r) = matrix(n + r, i) = qp.c(r, i);
      rhs[at(i)] = qp.b[at(i)];
    }
    for (int r = 0; r < m; ++r)
      rhs[at(n + r)] = qp.cRhs[at(r)];
    const auto hold = [&](int i, int k, double f) { // x_i = f x_k
      for (int j = 0; j < n + m; ++j)
        matrix(i, j) = 0.0;
      matrix(i, i) = 1.0;
      if (f != 0.0)
        matrix(i, k) -= f;
      rhs[at(i)] = 0.0;
    };
    std::vector<int> of;
    for (int p = 0, rest = state; p < points; ++p, rest /= 4) {
      const FollowingLimit& limit = qp.follows[at(p)];
      of.push_back(rest % 4);
      if (of.back() == 0)
        hold(limit.source, limit.source, 0.0);
      if (of.back() != 1)
        hold(limit.place, limit.source, of.back() == 0 ? 0.0 : of.back() == 2 ? limit.factor : -limit.factor);
    }
    std::vector<double> x = solveDense(matrix, rhs);
    if (x.empty())
      continue; // singular: no solution of its own
    const auto gradient = [&](int i) {
      double sum = -qp.b[at(i)];
      for (int j = 0; j < n; ++j)
        sum += qp.a(i, j) * x[at(j)];
      for (int r = 0; r < m; ++r)
        sum += qp.c(r, i) * x[at(n + r)];
      return sum;
    };
    bool isSolution = true;
    for (int p = 0; p < points && isSolution; ++p) {
      const FollowingLimit& limit = qp.follows[at(p)];
      constexpr double tiny = 1e-11;
      const double normal = x[at(limit.source)], tangential = x[at(limit.place)];
      isSolution = of[at(p)] == 0   ? gradient(limit.source) >= -tiny
                   : of[at(p)] == 1 ? normal >= -tiny && std::abs(tangential) <= limit.factor * normal + tiny
                   : of[at(p)] == 2 ? normal >= -tiny && gradient(limit.place) <= tiny
                                    : normal >= -tiny && gradient(limit.place) >= -tiny;
    }
    x.resize(at(n));
    bool isKnown = false;
    for (const std::vector<double>& known : result)
      isKnown = isKnown || distance(known, x) <= 1e-9 * (1.0 + norm(x));
    if (isSolution && !isKnown)
      result.push_back(x);
  }
  return result;
}

struct Answer {
  bool isConverged;
  std::vector<double> x;
  Result result;
};

Answer solved(const SmallQp& qp, const std::string& name, bool preconditioned, int iterations = 20000) {
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", 1e-11);
  list->set("Maximum Iterations", iterations);
  const DistributedQp distributed(qp);
  if (preconditioned)
    distributed.precondition(jacobi(qp.a));
  const auto solver = TpetraSolverFactory().create(name, list);
  solver->setProblem(distributed.problem);
  const Result result = solver->solve();
  return {result.converged(), fromVector(*distributed.solution), result};
}

// What x is farthest from being the minimum over the discs and intervals that its own limits make.
double wrong(const SmallQp& qp, const std::vector<double>& x) {
  SmallQp own = qp;
  own.follows.clear();
  for (const FollowingLimit& limit : qp.follows) {
    const double radius = limit.factor * x[at(limit.source)];
    if (limit.isDisc) {
      own.discs[at(limit.place)].radius = radius;
    } else {
      own.lower[at(limit.place)] = -radius;
      own.upper[at(limit.place)] = radius;
    }
  }
  return distance(interiorPoint(own), x);
}

} // namespace

TEST(FollowingLimits, three_hundred_problems_in_the_plane_against_all_states) {
  std::mt19937 random(22);
  int unique = 0, several = 0, none = 0, byProgram = 0, products = 0;
  int runs = 0, converged = 0, programs = 0, programsConverged = 0;
  for (int k = 0; k < 300; ++k) {
    const double factor = std::array{0.1, 0.3, 0.6, 1.0}[at(k % 4)];
    const SmallQp qp = followingQp(random, 1 + k % 4, 1, k % 3, k / 4 % 3, factor);
    const std::vector<std::vector<double>> expected = allSolutions(qp);
    (expected.empty() ? none : expected.size() == 1 ? unique : several) += 1;
    for (const std::string name : {"PDAS", "SMALBE"}) {
      if (name == "SMALBE" && k % 5 != 0)
        continue;
      const Answer answer = solved(qp, qp.c.rows > 0 || name == "PDAS" ? name : "MPRGP", k % 2 == 1);
      const std::string what = name + " " + std::to_string(k);
      if (expected.empty()) {
        EXPECT_FALSE(answer.isConverged) << what;
        continue;
      }
      EXPECT_NE(answer.result.reason, Reason::Infeasible) << what << ": " << answer.result.explanation;
      (name == "PDAS" ? runs : programs) += 1;
      (name == "PDAS" ? converged : programsConverged) += answer.isConverged ? 1 : 0;
      if (!answer.isConverged)
        continue;
      double least = infinity;
      for (const std::vector<double>& x : expected)
        least = std::min(least, distance(x, answer.x));
      // Of ‖b‖ some 5, eigenvalues from 1: off by 1e-10, times what limits add to the condition.
      EXPECT_LE(least, 1e-8 * (1.0 + norm(answer.x))) << what;
      byProgram += answer.result.counters.safeguards;
      products += name == "PDAS" ? answer.result.counters.hessianApplications : 0;
    }
  }
  if (testComm()->getRank() == 0)
    std::cout << unique << " with one solution, " << several << " with several, " << none << " without; "
              << converged << " of " << runs << " converged, " << programsConverged << " of " << programs
              << " by fixed points; " << products << " products by sets, " << byProgram << " handed over\n";
  EXPECT_GT(unique, 250);
  EXPECT_EQ(converged, runs); // none of these is without a solution
  EXPECT_GE(programsConverged, 0.9 * programs);
  EXPECT_LE(byProgram, 15);
}

// Fixed points that take a quarter of the iterations leave the rest to sets.
TEST(FollowingLimits, fixed_points_that_take_long_hand_over) {
  std::mt19937 random(27);
  int tried = 0, handedOver = 0, converged = 0;
  for (int k = 0; k < 30; ++k) {
    const SmallQp qp = followingQp(random, 4, 1, k % 3, 1, 0.3);
    const std::vector<std::vector<double>> expected = allSolutions(qp);
    if (expected.size() != 1)
      continue;
    ++tried;
    const Answer answer = solved(qp, qp.c.rows > 0 ? "SMALBE" : "MPRGP", false, 150);
    handedOver += answer.result.counters.safeguards > 0 ? 1 : 0;
    converged += answer.isConverged ? 1 : 0;
    if (answer.isConverged)
      EXPECT_LE(distance(expected[0], answer.x), 1e-8 * (1.0 + norm(answer.x))) << k; // as above
  }
  EXPECT_GT(handedOver, tried / 2);
  EXPECT_EQ(converged, tried);
}

// Where limits do not contract that is said; with coefficients of a tenth they do.
TEST(FollowingLimits, a_solution_that_need_not_be_the_only_one_is_told) {
  std::mt19937 random(26);
  for (double factor : {0.1, 3.0}) {
    int told = 0;
    for (int k = 0; k < 30; ++k) {
      const SmallQp qp = followingQp(random, 4, 1, 0, 1, factor);
      const auto list = Teuchos::parameterList();
      list->set("Convergence Tolerance", 1e-9);
      const DistributedQp distributed(qp);
      const auto solver = TpetraSolverFactory().create("SMALBE", list);
      std::ostringstream out, errors;
      solver->setLog(Log(out, errors, Log::Verbosity::Normal, true));
      solver->setProblem(distributed.problem);
      const bool isConverged = solver->solve().converged();
      const bool isTold = out.str().find("the solution need not be unique") != std::string::npos;
      EXPECT_TRUE(isConverged || !isTold);
      told += isTold ? 1 : 0;
    }
    if (factor < 1.0)
      EXPECT_EQ(told, 0);
    else
      EXPECT_GT(told, 0);
  }
}

TEST(FollowingLimits, hundred_problems_in_space) {
  std::mt19937 random(23);
  int slips = 0, sticks = 0;
  for (int k = 0; k < 100; ++k) {
    const double factor = std::array{0.1, 0.3, 0.6}[at(k % 3)];
    const SmallQp qp = followingQp(random, 1 + k % 4, 2, k % 2, k / 3 % 3, factor);
    const Answer answer = solved(qp, "PDAS", k % 2 == 1);
    ASSERT_TRUE(answer.isConverged) << k << ": " << answer.result.explanation;
    bool allTouch = true; // what an interior-point method needs
    for (const FollowingLimit& limit : qp.follows) {
      const double normal = answer.x[at(limit.source)], radius = limit.factor * normal;
      const Disc& disc = qp.discs[at(limit.place)];
      const double length = std::hypot(answer.x[at(disc.first)], answer.x[at(disc.second)]);
      EXPECT_LE(length, radius * (1.0 + 1e-12) + 1e-14) << k;
      allTouch = allTouch && radius > 1e-3;
      (length > (1.0 - 1e-9) * radius ? slips : sticks) += 1;
    }
    if (allTouch)
      EXPECT_LE(wrong(qp, answer.x), 1e-8 * (1.0 + norm(answer.x))) << k;
  }
  EXPECT_GT(slips, 50);
  EXPECT_GT(sticks, 30);
}

// From a solution, with its multipliers, the first face is that of the solution: points that slip begin so.
TEST(FollowingLimits, a_solution_stays_where_it_is) {
  std::mt19937 random(29);
  int slips = 0;
  for (int k = 0; k < 60; ++k) {
    const SmallQp qp = followingQp(random, 2 + k % 3, 2, 0, 0, 0.3);
    const Answer answer = solved(qp, "PDAS", true);
    ASSERT_TRUE(answer.isConverged) << k;
    for (const FollowingLimit& limit : qp.follows) {
      const Disc& disc = qp.discs[at(limit.place)];
      const double normal = answer.x[at(limit.source)];
      slips += normal > 1e-3 && std::hypot(answer.x[at(disc.first)], answer.x[at(disc.second)]) >
                                    (1.0 - 1e-9) * limit.factor * normal
                   ? 1
                   : 0;
    }
    const auto list = Teuchos::parameterList();
    list->set("Convergence Tolerance", 1e-9); // a hundred times that of the solution
    const DistributedQp again(qp);
    again.precondition(jacobi(qp.a));
    again.solution->update(1.0, *toVector(answer.x, again.map), 0.0);
    const auto solver = TpetraSolverFactory().create("PDAS", list);
    solver->setProblem(again.problem);
    const Result result = solver->solve();
    EXPECT_TRUE(result.converged()) << k;
    EXPECT_LE(result.counters.faces, 2) << k; // with a step by the gradient alone up to fourteen
    EXPECT_LE(distance(fromVector(*again.solution), answer.x), 1e-8 * (1.0 + norm(answer.x))) << k;
  }
  EXPECT_GT(slips, 30);
}

// Newton's method on single entries goes round in circles.
TEST(FollowingLimits, bodies_that_turn_settle) {
  std::mt19937 random(24);
  for (int k = 0; k < 20; ++k) {
    const SmallQp qp = turningBodiesQp(random, 3, 4, 0.2);
    const Answer answer = solved(qp, "PDAS", true);
    ASSERT_TRUE(answer.isConverged) << k << ": " << answer.result.explanation;
    EXPECT_EQ(answer.result.counters.safeguards, 0) << k;
    EXPECT_LE(wrong(qp, answer.x), 1e-8 * (1.0 + norm(answer.x))) << k;
  }
}

// p is the point of the cone next to z where z − p makes no sharp angle with any point of it, and none at all
// with p. Also where nothing is along the arm, and below the tip.
TEST(FollowingLimits, nearest_points_of_cones) {
  const double lower[] = {-0.2, 0.0};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-2.0, 2.0);
  for (int k = 0; k < 200; ++k) {
    const double factor = k % 3 == 0 ? 0.0 : 0.4;
    const FollowingLimits limits = {{1, false, 0, factor, 0.3}};
    const double z[] = {k < 8 ? -2.0 + 0.5 * k : number(random), k < 8 ? 0.3 : number(random)};
    double p[] = {z[0], z[1]};
    Kernels::projectOntoCones(Kernels::conesOf(limits, p, nullptr), limits, lower, nullptr, p);
    const double height = p[0] - lower[0], arm = p[1] - 0.3;
    const double left[] = {z[0] - p[0], z[1] - p[1]};
    constexpr double rounding = 1e-14; // a few roundings of numbers of about one
    ASSERT_TRUE(std::isfinite(height) && std::isfinite(arm)) << z[0] << " " << z[1];
    EXPECT_GE(height, -rounding);
    EXPECT_LE(std::abs(arm), factor * height + rounding);
    EXPECT_NEAR(left[0] * height + left[1] * arm, 0.0, rounding);
    for (const double side : {-factor, 0.0, factor})
      EXPECT_LE(left[0] + side * left[1], rounding) << z[0] << " " << z[1];
  }
}

// Bits do not depend on units, and no factor is no tangential force.
TEST(FollowingLimits, no_factor_no_force) {
  std::mt19937 random(25);
  SmallQp qp = followingQp(random, 3, 1, 2, 1, 0.0);
  const Answer answer = solved(qp, "PDAS", true);
  ASSERT_TRUE(answer.isConverged) << answer.result.explanation;
  for (const FollowingLimit& limit : qp.follows) {
    EXPECT_EQ(answer.x[at(limit.place)], 0.0);
    qp.lower[at(limit.place)] = qp.upper[at(limit.place)] = 0.0;
  }
  qp.follows.clear();
  EXPECT_LE(distance(bruteForce(qp), answer.x), 1e-9 * (1.0 + norm(answer.x)));
}

// A shoe: pressed down by 1, and drawn along. Up to the friction that there is it stays; beyond that nothing
// holds it, with the proof: a motion along and up.
TEST(FollowingLimits, shoe) {
  constexpr double factor = 0.3;
  for (int tangents : {1, 2})
    for (double share : {0.5, 0.99, 1.01, 2.0}) {
      constexpr int points = 4;
      const int of = 1 + tangents, n = points * of;
      SmallQp qp{Dense(n, n),
                 std::vector<double>(at(n), 0.0),
                 std::vector<double>(at(n), -infinity),
                 std::vector<double>(at(n), infinity),
                 Dense(of, n),
                 std::vector<double>(at(of), 0.0)};
      for (int p = 0; p < points; ++p) {
        for (int k = 0; k < of; ++k) {
          qp.a(p * of + k, p * of + k) = 1.0 + 0.3 * p;
          qp.c(k, p * of + k) = 0.5;
        }
        qp.lower[at(p * of)] = 0.0;
        if (tangents == 2)
          qp.discs.push_back({p * of + 1, p * of + 2, {0.0, 0.0}, 1e100});
        qp.follows.push_back({tangents == 2 ? p : p * of + 1, tangents == 2, p * of, factor});
      }
      qp.cRhs[0] = 1.0;
      qp.cRhs[1] = share * factor * (tangents == 2 ? 0.6 : 1.0);
      if (tangents == 2)
        qp.cRhs[2] = share * factor * 0.8;
      const Answer answer = solved(qp, "PDAS", true);
      const std::string what = std::to_string(tangents) + ", " + std::to_string(share);
      if (share < 1.0) {
        EXPECT_TRUE(answer.isConverged) << what << ": " << answer.result.explanation;
        EXPECT_LE(wrong(qp, answer.x), 1e-8) << what;
      } else {
        EXPECT_EQ(answer.result.reason, Reason::Infeasible) << what << ": " << answer.result.explanation;
      }
    }
}

namespace {

struct PathEnd {
  bool isReached;
  std::vector<double> x;
};

// Of a path through interior points.
PathEnd endOfPath(const SmallQp& qp, bool preconditioned) {
  const DistributedQp distributed(qp);
  if (preconditioned)
    distributed.precondition(jacobi(qp.a));
  EXPECT_TRUE(distributed.problem->setProblem()) << distributed.problem->whyNotSet();
  EqualityRows<Scalar, MultiVector, Operator> rows(*distributed.problem, 1000);
  KeptDirections<Scalar, MultiVector, Operator> kept(*distributed.problem, rows);
  Counters counters;
  InteriorPath<Scalar, MultiVector, Operator> path(*distributed.problem, rows, CgOptions(), kept, 10,
                                                   counters);
  const bool isReached = path.run(*distributed.solution, 5.0, 1e-5, 10000, [] { return false; });
  return {isReached, fromVector(path.x())};
}

} // namespace

// Points of cones with friction in one or two directions, a bound alone, an interval and a disc that are
// given.
TEST(InteriorPath, scaled_points_of_cones) {
  const double lower[] = {0.5, -infinity, -infinity, 0.0, -infinity, -infinity, -infinity, -1.0, -infinity};
  const double upper[] = {infinity, infinity, infinity, infinity, infinity, infinity, 2.0, 1.0, infinity};
  const std::vector<Disc> discs = {{1, 2, {0.1, -0.2}, 7.0}, {4, 5, {0.3, 0.4}, 0.8}};
  const FollowingLimits limits = {{0, true, 0, 0.4}};
  Kernels::SecondOrderCones cones(9, lower, upper, &discs, &limits);
  EXPECT_EQ(cones.size(), 5u); // one that follows, a disc, two bounds, an interval; the last entry is free
  std::vector<double> x = {0.2, 3.0, -4.0, 5.0, 0.3, -2.0, 3.0, 0.9, 8.0}, free = x;
  constexpr double distance = 0.25, tau = 0.03, q = 3.0;
  cones.begin(distance, tau, x.data());
  EXPECT_EQ(x[8], free[8]);
  EXPECT_NEAR(x[0], 0.75, 1e-15);
  EXPECT_NEAR(std::hypot(x[1] - 0.1, x[2] + 0.2), 0.5 * 0.4 * 0.25, 1e-15);
  EXPECT_NEAR(std::hypot(x[4] - 0.3, x[5] - 0.4), 0.4, 1e-15);
  EXPECT_NEAR(x[6], 1.75, 1e-15);
  EXPECT_NEAR(x[7], 0.5, 1e-15);
  std::vector<double> products(9, 0.0);
  cones.putProducts(products.data());
  for (int place : {0, 3, 4, 6, 7})
    EXPECT_NEAR(products[at(place)], tau, 1e-15) << place;

  // Away from the central path, W⁻²s = z still; D inverts 1 + W⁻²/q.
  std::mt19937 random(31);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> dx(9);
  for (int k = 0; k < 5; ++k) {
    cones.scale(q);
    for (double& entry : dx)
      entry = 0.3 * uniform(random);
    const double length = cones.findStep(dx.data(), 0.5 * tau);
    ASSERT_GT(length, 0.0);
    cones.advance(0.7 * length);
    for (std::size_t i = 0; i < 9; ++i)
      x[i] += 0.7 * length * dx[i];
  }
  cones.scale(q);
  const std::vector<double> s = {x[0] - 0.5, x[1] - 0.1, x[2] + 0.2, x[3], 0, 0, x[6] - 2.0, 0, 0};
  std::vector<double> image(9, 0.0);
  cones.addCurvature(s.data(), image.data());
  cones.subtractDual(image.data()); // and the shift, by f|z_1|
  std::vector<double> shift(9, 0.0);
  cones.addCentring(0.0, shift.data());
  image[0] += shift[0];
  for (int place : {0, 1, 2, 3, 6}) // where all of s is in x
    EXPECT_NEAR(image[at(place)], 0.0, 1e-12) << place;
  std::vector<double> v(9), back(9);
  for (std::size_t i = 0; i < 9; ++i)
    v[i] = back[i] = uniform(random);
  std::vector<double> curved(9, 0.0);
  cones.addCurvature(v.data(), curved.data());
  for (std::size_t i = 0; i < 9; ++i)
    back[i] += curved[i] / q;
  cones.weigh(back.data());
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_NEAR(back[i], v[i], 1e-12) << i;
}

// Limits that are given: the quadratic program.
TEST(InteriorPath, leads_to_the_solution_of_programs) {
  std::mt19937 random(33);
  for (int k = 0; k < 20; ++k) {
    SmallQp qp = followingQp(random, 3, 2, 2, k % 3, 0.3);
    qp.follows.clear();
    for (Disc& disc : qp.discs)
      disc.radius = 0.2;
    const PathEnd end = endOfPath(qp, k % 2 == 1);
    EXPECT_TRUE(end.isReached) << k;
    // τ is 1e-10 of what it was.
    EXPECT_LE(distance(interiorPoint(qp), end.x), 1e-5 * (1.0 + norm(end.x))) << k;
  }
}

// Limits that follow: to the neighbourhood of a solution, of all that there are; and where the path breaks
// off, PDAS, of which this is but a part, does not.
TEST(InteriorPath, leads_to_where_limits_follow) {
  std::mt19937 random(32);
  int near = 0, reached = 0;
  for (int k = 0; k < 60; ++k) {
    const double factor = std::array{0.1, 0.3, 0.6}[at(k % 3)];
    const SmallQp qp = followingQp(random, 1 + k % 4, 1, k % 3, k / 4 % 3, factor);
    const PathEnd end = endOfPath(qp, k % 4 < 2);
    double least = infinity;
    for (const std::vector<double>& x : allSolutions(qp))
      least = std::min(least, distance(x, end.x));
    reached += end.isReached ? 1 : 0;
    near += least <= 1e-2 * (1.0 + norm(end.x)) ? 1 : 0;
  }
  if (testComm()->getRank() == 0)
    std::cout << reached << " of 60 paths reach their end, " << near << " lead near a solution\n";
  EXPECT_GE(reached, 55);
  EXPECT_GE(near, 55);
}

} // namespace test_following_limits
