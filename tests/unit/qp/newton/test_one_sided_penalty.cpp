// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_NonsmoothBlock.hpp"
#include "Harmos_RandomQp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace test_one_sided_penalty {

using namespace Harmos;
using namespace Harmos::qp;
using Vector = std::vector<double>;

/// Terms of one's own, as docs/qp.md shows: soft bounds whose lower ends are hard,
/// ψ(x) = ∞ for x < l, 0 up to u, ½κ(x − u)² beyond.
struct OneSidedPenalty : NonsmoothBlock {
  std::vector<SoftBound> terms_; // local, by rising entries
  explicit OneSidedPenalty(std::vector<SoftBound> terms) : terms_(std::move(terms)) {}
  Kind kind() const override { return {false, true, true}; }
  void mark(char* entries) const override {
    for (const SoftBound& term : terms_)
      entries[term.entry] = 1;
  }
  void project(double* x) const override {
    for (const SoftBound& term : terms_)
      x[term.entry] = std::max(x[term.entry], term.lower);
  }
  void addForces(const double* x, double* y) const override {
    for (const SoftBound& term : terms_)
      y[term.entry] += term.curvature * std::max(x[term.entry] - term.upper, 0.0);
  }
  void update(const double* x, const double* g, const FaceUpdate& how, const ActiveFace& before,
              ActiveFace& face, FaceTally& tally) const override {
    Kernels::SpringOf springBefore(before.springs);
    for (const auto& [i, lower, upper, curvature] : terms_) {
      const bool isSoft = how.keepsSprings ? springBefore(i) != nullptr : x[i] > upper + how.xNoise;
      const bool isHeld = face[i] != 0;
      if (isSoft)
        face.springs.push_back({i, 1, upper, curvature});
      tally.wrong2 += isHeld ? std::pow(std::min(g[i], 0.0), 2) : 0.0;
      tally.violation2 += isHeld ? 0.0 : std::pow(std::max(lower - x[i], 0.0), 2);
      face[i] = (isHeld ? g[i] >= -how.gradientNoise : x[i] < lower - how.xNoise) ? -1 : 0;
    }
  }
  void moveToFace(const ActiveFace& face, double* x) const override {
    for (const SoftBound& term : terms_)
      x[term.entry] = face[term.entry] != 0 ? term.lower : x[term.entry];
  }
  void project(const double* x, double* g) const override {
    for (const SoftBound& term : terms_)
      g[term.entry] = std::min(g[term.entry], x[term.entry] <= term.lower ? 0.0 : infinity);
  }
  double recede(double* d) const override { // ψ grows to either side, if only near
    double removed2 = 0.0;
    for (const SoftBound& term : terms_)
      removed2 += std::pow(std::exchange(d[term.entry], 0.0), 2);
    return removed2;
  }
};

TEST(OneSidedPenalty, functions_are_those_of_the_definition) {
  const OneSidedPenalty block({{1, -1.0, 1.0, 10.0}, {2, 0.0, 0.5, 2.0}});
  Vector x = {5.0, 1.7, -3.0}, low = x, force(3, 0.0), model = force, g = {-1.0, 1.0, 1.0}, pull(3, -1.0);
  ActiveFace face(3, 0);
  FaceTally tally;
  block.update(x.data(), g.data(), {}, ActiveFace(3, 0), face, tally);
  EXPECT_TRUE(face[0] == 0 && face[1] == 0 && face[2] == -1 && tally.violation2 == 9.0);
  block.moveToFace(face, x.data());
  block.project(low.data());
  EXPECT_TRUE(x == low && low == (Vector{5.0, 1.7, 0.0}));
  block.addForces(x.data(), force.data());
  EXPECT_NEAR(force[1], 5.0 * (0.8 * 0.8 - 0.6 * 0.6) / 0.2, 1e-13); // ψ(1.8) and ψ(1.6): a square
  Kernels::addSprings(face.springs, 1.0, x.data(), true, model.data());
  block.project(x.data(), g.data());
  EXPECT_TRUE(model == force && g == (Vector{-1.0, 1.0, 0.0}));
  block.update(x.data(), pull.data(), {}, ActiveFace(3, 0), face, tally);
  EXPECT_TRUE(face[2] == 0 && tally.wrong2 == 1.0);
}

TEST(OneSidedPenalty, random_problems_against_enumeration) {
  std::mt19937 random(41);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int known = 0;
  for (int k = 0; k < 240; ++k) {
    SmallQp smooth = randomQp(random, 3 + k % 6, k % 3, true, std::pow(10.0, 3.0 * unit(random)));
    SmallQp split = smooth; // what is enumerated: bounds below, soft ones above
    split.upper = smooth.lower = smooth.upper = {};
    const DistributedQp distributed(smooth);
    std::vector<SoftBound> local;
    for (int i = 0; i < smooth.size(); ++i) {
      const double lower = split.lower[std::size_t(i)], upper = unit(random) + std::max(lower, -1.0);
      split.soft.push_back({i, -infinity, upper, smooth.a(i, i) * std::pow(10.0, 8.0 * unit(random) - 2.0)});
      if (distributed.map->isNodeGlobalElement(i))
        local.push_back({distributed.map->getLocalElement(i), lower, upper, split.soft.back().curvature});
    }
    distributed.problem->addBlock(std::make_shared<OneSidedPenalty>(local));
    ASSERT_TRUE(distributed.problem->setProblem()) << distributed.problem->whyNotSet();
    if (k / 6 % 2 == 1)
      distributed.precondition(jacobi(smooth.a));
    const auto list = Teuchos::parameterList();
    list->set("Convergence Tolerance", 1e-10);
    const auto solver = TpetraSolverFactory().create(k / 12 % 2 == 0 ? "PDAS" : "Auto", list);
    solver->setProblem(distributed.problem);
    const Result result = solver->solve();
    // Rounding errors of κ(x − u) may be above 1e-10‖b‖.
    const bool isAnswer = result.converged() || result.explanation.find("at the level") != std::string::npos;
    EXPECT_TRUE(isAnswer) << k << ": " << result.explanation;
    const Vector x = bruteForceOfSides(split, [](const SmallQp& plain) { return bruteForce(plain); });
    known += isAnswer && !x.empty() ? 1 : 0;
    // Of ‖b‖ some 10, eigenvalues from 1: x is off by 1e-9 then.
    EXPECT_LE(isAnswer ? distance(x, fromVector(*distributed.solution)) : 0.0, 1e-8 * (1.0 + norm(x))) << k;
  }
  EXPECT_GE(known, 225);
}

} // namespace test_one_sided_penalty
