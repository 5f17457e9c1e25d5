// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestQp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace Harmos;

namespace {

using BT = qp::BoundTraits<Scalar, MultiVector>;
constexpr double inf = std::numeric_limits<double>::infinity();

// One entry for each case of the definitions.
struct Cases {
  //                          free   free   at l    at l    at u    at u   free, near l  free, near u  l = u
  std::vector<double> x = {0.5, 0.5, 0.0, 0.0, 1.0, 1.0, 0.1, 0.9, 2.0};
  std::vector<double> g = {2.0, -3.0, 5.0, -7.0, 11.0, -13.0, 4.0, -6.0, 9.0};
  std::vector<double> l = {-inf, -inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0};
  std::vector<double> u = {inf, inf, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0};
  Teuchos::RCP<const Map> map = Teuchos::rcp(new Map(9, 0, testComm()));
  Teuchos::RCP<MultiVector> xv = toVector(x, map), gv = toVector(g, map), lv = toVector(l, map),
                            uv = toVector(u, map);
};

} // namespace

// Small whole numbers: every sum is exact.
TEST(BoundTraits, splitting_of_every_case) {
  const Cases c;
  MultiVector phi(c.map, 1);
  qp::LocalActiveSet active;
  const auto image = toVector({1, 1, 1, 1, 1, 1, 1, 1, 1}, c.map);
  const double step = 0.5;
  const qp::SplitSums sums = BT::split(*c.xv, *c.gv, c.lv.get(), c.uv.get(), step, image.get(), phi, active);
  EXPECT_EQ(fromVector(phi), (std::vector<double>{2, -3, 0, 0, 0, 0, 4, -6, 0}));
  EXPECT_EQ(sums.freeNorm2, 4 + 9 + 16 + 36);
  EXPECT_EQ(sums.choppedNorm2, 49 + 121); // −7 at l, 11 at u; the others point outwards, l = u does not move
  EXPECT_EQ(sums.freeDotImage, 2 - 3 + 4 - 6);
  // φ̃: 2, −3 unbounded; min(0.1/0.5, 4) = 0.2; max(−0.1/0.5, −6) = −0.2.
  EXPECT_NEAR(sums.reducedNorm2, 4 + 9 + 0.2 * 4 + 0.2 * 6, 1e-14);
  EXPECT_EQ(sums.active, 5);
  EXPECT_EQ(sums.changed, 9); // all are new
  EXPECT_EQ(sums.projectedNorm2(), sums.freeNorm2 + sums.choppedNorm2);
  EXPECT_NEAR(BT::projectedGradientNorm(*c.xv, *c.gv, c.lv.get(), c.uv.get()),
              std::sqrt(sums.projectedNorm2()), 1e-14);
  MultiVector beta(c.map, 1);
  BT::choppedGradient(*c.xv, *c.gv, c.lv.get(), c.uv.get(), beta);
  EXPECT_EQ(fromVector(beta), (std::vector<double>{0, 0, 0, -7, 11, 0, 0, 0, 0}));

  auto moved = c.x;
  moved[2] = 0.25;
  const qp::SplitSums again =
      BT::split(*toVector(moved, c.map), *c.gv, c.lv.get(), c.uv.get(), step, nullptr, phi, active);
  EXPECT_EQ(again.changed, 1);
  EXPECT_EQ(again.active, 4);
}

TEST(BoundTraits, absent_bounds_leave_all_free) {
  const Cases c;
  MultiVector phi(c.map, 1);
  qp::LocalActiveSet active;
  const qp::SplitSums sums = BT::split(*c.xv, *c.gv, nullptr, nullptr, 1.0, nullptr, phi, active);
  EXPECT_EQ(sums.active, 0);
  EXPECT_EQ(fromVector(phi), c.g);
  EXPECT_EQ(sums.reducedNorm2, sums.freeNorm2);
}

TEST(BoundTraits, longest_step_and_step_to_the_boundary) {
  const auto map = Teuchos::rcp(new Map(4, 0, testComm()));
  const auto x = toVector({1.0, 1.0, 1.0, 1.0}, map);
  const auto p = toVector({3.0, -2.0, 0.5, 0.0}, map);
  const auto l = toVector({0.0, 0.0, -inf, 1.0}, map);
  const auto u = toVector({inf, 1.5, inf, 1.0}, map);
  const qp::DirectionSums sums = BT::direction(*x, *x, *p, *p, l.get(), u.get());
  EXPECT_EQ(sums.longestStep, 0.25); // entry 1: (1 − 1.5)/(−2); entry 0 allows 1/3
  EXPECT_EQ(sums.gradientDotDirection, 1.5);
  EXPECT_EQ(sums.directionNorm2, 13.25);
  EXPECT_EQ(sums.directionDotImage, 13.25);
  EXPECT_EQ(BT::direction(*x, *x, *p, *p, nullptr, nullptr).longestStep, inf);
  // Exactly onto the bound, however the product rounds; beyond it for none.
  BT::stepToBoundary(*x, *p, 1.0 / 3.0, l.get(), u.get());
  const std::vector<double> moved = fromVector(*x);
  EXPECT_EQ(moved[0], 0.0);
  EXPECT_EQ(moved[1], 1.5);
  EXPECT_EQ(moved[3], 1.0);
}

TEST(BoundTraits, projection) {
  const Cases c;
  const auto x = toVector({-5, 5, -5, 5, 0.5, -5, 5, 0.5, 0}, c.map);
  BT::project(*x, c.lv.get(), c.uv.get());
  EXPECT_EQ(fromVector(*x), (std::vector<double>{-5, 5, 0, 1, 0.5, 0, 1, 0.5, 2}));
}

TEST(BoundTraits, inconsistent_bounds_are_seen) {
  const auto map = Teuchos::rcp(new Map(2, 0, testComm()));
  const auto l = toVector({0.0, 0.0}, map);
  EXPECT_TRUE(BT::boundsAreConsistent(l.get(), toVector({0.0, inf}, map).get()));
  EXPECT_FALSE(BT::boundsAreConsistent(l.get(), toVector({1.0, -1e-300}, map).get()));
  EXPECT_FALSE(BT::boundsAreConsistent(l.get(), toVector({1.0, std::nan("")}, map).get()));
  EXPECT_FALSE(BT::boundsAreConsistent(toVector({0.0, inf}, map).get(), nullptr));
  EXPECT_TRUE(BT::boundsAreConsistent(nullptr, nullptr));
}

TEST(BoundTraits, random_vectors_do_not_depend_on_the_distribution) {
  MultiVector distributed(Teuchos::rcp(new Map(100, 0, testComm())), 1);
  MultiVector replicated(Teuchos::rcp(new Map(100, 0, testComm(), Tpetra::LocallyReplicated)), 1);
  BT::setRandom(distributed);
  BT::setRandom(replicated);
  EXPECT_EQ(fromVector(distributed), fromVector(replicated));
  double sum = 0.0;
  for (double value : fromVector(distributed)) {
    EXPECT_LT(std::abs(value), 1.0);
    sum += value;
  }
  EXPECT_LT(std::abs(sum), 30.0); // five standard deviations of a sum of 100 uniform numbers
}
