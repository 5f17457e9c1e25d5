// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BlockOps.hpp"
#include "Harmos_BoundTraitsTpetra.hpp"
#include "Harmos_DiscKernels.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_TestQp.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace test_bound_ops {

using namespace Harmos;

namespace {

using Bounds = qp::BoundOps<Scalar, MultiVector>;
using Faces = qp::FaceOps<Scalar, MultiVector>;
using Terms = qp::BlockOps<Scalar, MultiVector>;
using Set = qp::FeasibleSet<MultiVector>;
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
TEST(BoundOps, splitting_of_every_case) {
  const Cases c;
  MultiVector phi(c.map, 1);
  qp::ActiveFace active;
  const double step = 0.5;
  const qp::SplitSums sums = Bounds::split(*c.xv, *c.gv, {c.lv.get(), c.uv.get()}, step, &phi, active);
  EXPECT_EQ(fromVector(phi), (std::vector<double>{2, -3, 0, 0, 0, 0, 4, -6, 0}));
  EXPECT_EQ(sums.freeNorm2, 4 + 9 + 16 + 36);
  EXPECT_EQ(sums.choppedNorm2, 49 + 121); // −7 at l, 11 at u; the others point outwards, l = u does not move
  // φ̃: 2, −3 unbounded; min(0.1/0.5, 4) = 0.2; max(−0.1/0.5, −6) = −0.2.
  EXPECT_NEAR(sums.reducedNorm2, 4 + 9 + 0.2 * 4 + 0.2 * 6, 1e-14);
  EXPECT_EQ(sums.active, 5);
  EXPECT_EQ(sums.changed, 9);                    // all are new
  EXPECT_NEAR(sums.longestStep, 0.1 / 6, 1e-16); // entry 7 meets its upper bound first: (0.9 − 1)/(−6)
  EXPECT_EQ(sums.projectedNorm2(), sums.freeNorm2 + sums.choppedNorm2);
  EXPECT_NEAR(Bounds::projectedGradientNorm(*c.xv, *c.gv, {c.lv.get(), c.uv.get()}),
              std::sqrt(sums.projectedNorm2()), 1e-14);
  MultiVector beta(c.map, 1);
  // Along β = −7 at l = 0 the upper bound 1 is met at 1/7, along 11 at u = 1 the lower one 0 at 1/11.
  EXPECT_EQ(Bounds::choppedDirection(*c.xv, *c.gv, {c.lv.get(), c.uv.get()}, beta), 1.0 / 11.0);
  EXPECT_EQ(fromVector(beta), (std::vector<double>{0, 0, 0, -7, 11, 0, 0, 0, 0}));

  auto moved = c.x;
  moved[2] = 0.25;
  const qp::SplitSums again =
      Bounds::split(*toVector(moved, c.map), *c.gv, {c.lv.get(), c.uv.get()}, step, nullptr, active);
  EXPECT_EQ(again.changed, 1);
  EXPECT_EQ(again.active, 4);
}

TEST(BoundOps, absent_bounds_leave_all_free) {
  const Cases c;
  MultiVector phi(c.map, 1);
  qp::ActiveFace active;
  const qp::SplitSums sums = Bounds::split(*c.xv, *c.gv, {}, 1.0, &phi, active);
  EXPECT_EQ(sums.active, 0);
  EXPECT_EQ(fromVector(phi), c.g);
  EXPECT_EQ(sums.reducedNorm2, sums.freeNorm2);
  EXPECT_EQ(sums.longestStep, inf);
}

TEST(BoundOps, sums_of_a_product) {
  const auto map = Teuchos::rcp(new Map(3, 0, testComm()));
  const auto g = toVector({1, 2, 3}, map), p = toVector({4, 5, 0}, map), image = toVector({7, -8, 9}, map);
  // Entry 2 is active on the rank that owns it.
  qp::ActiveFace active;
  for (std::size_t i = 0; i < g->getLocalLength(); ++i)
    active.push_back(map->getGlobalElement(static_cast<LocalOrdinal>(i)) == 2 ? -1 : 0);
  const qp::CurvatureSums sums = Bounds::curvature(*g, *p, *image, active);
  EXPECT_EQ(sums.gradientDotDirection, 14);
  EXPECT_EQ(sums.directionDotImage, -12);
  EXPECT_EQ(sums.directionNorm2, 41);
  EXPECT_EQ(sums.freeDotImage, -9);
  EXPECT_EQ(sums.freeImageNorm2, 113);
}

// One fused pass against its parts, each from the definition.
TEST(BoundOps, advance_is_step_splitting_and_direction) {
  const auto map = Teuchos::rcp(new Map(4, 0, testComm()));
  const auto x = toVector({1.0, 1.0, 0.0, 5.0}, map), g = toVector({4.0, -4.0, 2.0, 8.0}, map),
             p = toVector({4.0, -4.0, 0.0, 8.0}, map), image = toVector({2.0, 1.0, 1.0, 4.0}, map),
             l = toVector({0.0, 0.0, 0.0, -inf}, map), u = toVector({inf, 3.0, inf, inf}, map);
  qp::ActiveFace active;
  Bounds::split(*x, *g, {l.get(), u.get()}, 1.0, nullptr, active);
  const qp::SplitSums sums =
      Bounds::advance(*x, *g, *p, *image, 0.125, 0.5, false, {l.get(), u.get()}, 1.0, *p, active);
  EXPECT_EQ(fromVector(*x), (std::vector<double>{0.5, 1.5, 0.0, 4.0}));
  EXPECT_EQ(fromVector(*g), (std::vector<double>{3.75, -4.125, 1.875, 7.5}));
  EXPECT_EQ(fromVector(*p), (std::vector<double>{1.75, -2.125, 0.0, 3.5})); // φ − p/2, nothing at the bound
  EXPECT_EQ(sums.freeNorm2, 3.75 * 3.75 + 4.125 * 4.125 + 7.5 * 7.5);
  EXPECT_EQ(sums.choppedNorm2, 0.0);
  EXPECT_EQ(sums.reducedNorm2, 0.5 * 3.75 + 1.5 * 4.125 + 7.5 * 7.5);
  EXPECT_EQ(sums.active, 1);
  EXPECT_EQ(sums.changed, 0);
  EXPECT_EQ(sums.longestStep, 0.5 / 1.75);
}

TEST(BoundOps, steps_to_the_boundary_end_exactly_on_it) {
  const auto map = Teuchos::rcp(new Map(4, 0, testComm()));
  const auto x = toVector({1.0, 1.0, 1.0, 1.0}, map), g = toVector({0, 0, 0, 0}, map),
             p = toVector({3.0, -2.0, 0.5, 0.0}, map), l = toVector({0.0, 0.0, -inf, 1.0}, map),
             u = toVector({inf, 1.5, inf, 1.0}, map), next = toVector({0, 0, 0, 0}, map);
  MultiVector direction(*p, Teuchos::Copy);
  EXPECT_EQ(Bounds::conjugate(*x, *p, 0.0, {l.get(), u.get()}, direction),
            0.25); // entry 1; entry 0 allows 1/3
  EXPECT_EQ(Bounds::conjugate(*x, *p, 0.0, {}, direction), inf);
  qp::ActiveFace active;
  Bounds::split(*x, *g, {l.get(), u.get()}, 1.0, nullptr, active);
  // Exactly onto the bound, however the product rounds; beyond it for none.
  const qp::SplitSums sums =
      Bounds::advance(*x, *g, *p, *g, 1.0 / 3.0, 0.0, true, {l.get(), u.get()}, 1.0, *next, active);
  const std::vector<double> moved = fromVector(*x);
  EXPECT_EQ(moved[0], 0.0);
  EXPECT_EQ(moved[1], 1.5);
  EXPECT_EQ(moved[3], 1.0);
  EXPECT_EQ(sums.active, 3);
  EXPECT_EQ(sums.changed, 2);
}

TEST(BoundOps, projected_step_and_the_change_it_makes) {
  const auto map = Teuchos::rcp(new Map(2, 0, testComm()));
  const auto x = toVector({1.0, 2.0}, map), p = toVector({1.0, 8.0}, map), l = toVector({0.0, 0.0}, map),
             gOld = toVector({2.0, 4.0}, map), g = toVector({0.0, -2.0}, map);
  MultiVector old(map, 1);
  Bounds::projectedStep(*x, old, *p, 0.5, {l.get()});
  EXPECT_EQ(fromVector(*x), (std::vector<double>{0.5, 0.0}));
  EXPECT_EQ(fromVector(old), (std::vector<double>{1.0, 2.0}));
  const qp::ChangeSums change = Bounds::change(*x, old, *g, *gOld);
  EXPECT_EQ(change.cost, 0.5 * (-0.5 * 2.0 - 2.0 * 2.0));
  EXPECT_EQ(change.moved2, 4.25);
  EXPECT_EQ(change.gradientNorm2, 20.0);
}

TEST(BoundOps, active_sets_follow_multipliers_and_violations) {
  const auto map = Teuchos::rcp(new Map(6, 0, testComm()));
  //                          free,  below l, above u,  at l held, at l freed, l = u
  const auto x = toVector({0.5, -1.0, 2.0, 0.0, 0.0, 3.0}, map),
             g = toVector({9.0, 0.0, 0.0, 1.0, -2.0, -5.0}, map),
             l = toVector({0.0, 0.0, 0.0, 0.0, 0.0, 3.0}, map),
             u = toVector({1.0, 1.0, 1.0, 1.0, 1.0, 3.0}, map);
  qp::ActiveFace set;
  for (std::size_t i = 0; i < x->getLocalLength(); ++i)
    set.push_back(map->getGlobalElement(static_cast<LocalOrdinal>(i)) >= 3 ? -1 : 0);
  const qp::ActiveFace before = set;
  const qp::FaceChange change = Terms::update(Set{l.get(), u.get()}, *x, *g, {}, set);
  EXPECT_EQ(change.active, 4);
  EXPECT_EQ(change.changed, 3);
  EXPECT_EQ(change.violation2, 2.0);
  EXPECT_EQ(change.wrongSign2, 4.0);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const int expected[] = {0, -1, 1, -1, 0, -1};
    EXPECT_EQ(set[i], expected[map->getGlobalElement(static_cast<LocalOrdinal>(i))]);
  }
  // What lies within the noise is let be.
  qp::ActiveFace tolerant = before;
  EXPECT_EQ(Terms::update(Set{l.get(), u.get()}, *x, *g, {1.0, 2.0}, tolerant).changed, 0);
  // Signatures: the same for the same set, another for another.
  qp::ActiveFace copy = before;
  const qp::FaceChange same = Terms::update(Set{l.get(), u.get()}, *x, *g, {}, copy);
  EXPECT_EQ(same.signature[0], change.signature[0]);
  EXPECT_EQ(same.signature[1], change.signature[1]);
  const qp::FaceChange other = Terms::update(Set{l.get(), u.get()}, *x, *g, {1.0, 2.0}, tolerant);
  EXPECT_NE(other.signature[0], change.signature[0]);
  Terms::moveToFace(Set{l.get(), u.get()}, set, *x);
  EXPECT_EQ(fromVector(*x), (std::vector<double>{0.5, 0.0, 1.0, 0.0, 0.0, 3.0}));
  Faces::mask(*g, set);
  EXPECT_EQ(fromVector(*g), (std::vector<double>{9.0, 0.0, 0.0, 0.0, -2.0, 0.0}));
}

TEST(BoundOps, infimum_over_the_box_and_recession_cone) {
  const auto map = Teuchos::rcp(new Map(4, 0, testComm()));
  const auto l = toVector({-2.0, -inf, -inf, 1.0}, map), u = toVector({inf, 3.0, inf, 2.0}, map);
  const auto w = toVector({1.0, -1.0, 0.0, -4.0}, map);
  const qp::BoxInfimum closed = Bounds::boxInfimum(*w, {l.get(), u.get()});
  EXPECT_EQ(closed.value, -2.0 - 3.0 - 8.0);
  EXPECT_EQ(closed.openNorm, 0.0);
  EXPECT_EQ(closed.boundNorm, std::sqrt(4.0 + 9.0 + 4.0));
  const qp::BoxInfimum open = Bounds::boxInfimum(*toVector({-3.0, 4.0, 12.0, 0.0}, map), {l.get(), u.get()});
  EXPECT_EQ(open.value, 0.0);
  EXPECT_EQ(open.openNorm, 13.0);
  const auto d = toVector({-3.0, -1.0, 5.0, 4.0}, map);
  EXPECT_EQ(Terms::recede(Terms::setsOf({l.get(), u.get()}), *d), 5.0);
  EXPECT_EQ(fromVector(*d), (std::vector<double>{0.0, -1.0, 5.0, 0.0}));
}

TEST(BoundOps, gather_and_scatter) {
  const std::vector<double> values = {3, 1, 4, 1, 5, 9, 2};
  for (const auto& map : {Teuchos::rcp(new Map(7, 0, testComm())),
                          Teuchos::rcp(new Map(7, 0, testComm(), Tpetra::LocallyReplicated))}) {
    MultiVector v(map, 1);
    BT::scatter(values, v);
    EXPECT_EQ(fromVector(v), values);
    EXPECT_EQ(BT::gather(v), values);
  }
  // A map with gaps has no numbering to gather by.
  std::vector<GlobalOrdinal> indices;
  if (testComm()->getRank() == 0)
    indices = {0, 5};
  const auto gaps = Teuchos::rcp(new Map(2, Teuchos::arrayViewFromVector(indices), 0, testComm()));
  EXPECT_THROW(BT::gather(MultiVector(gaps, 1)), InputError);
}

TEST(BoundOps, projection) {
  const Cases c;
  const auto x = toVector({-5, 5, -5, 5, 0.5, -5, 5, 0.5, 0}, c.map);
  Bounds::project(*x, {c.lv.get(), c.uv.get()});
  EXPECT_EQ(fromVector(*x), (std::vector<double>{-5, 5, 0, 1, 0.5, 0, 1, 0.5, 2}));
}

TEST(BoundOps, inconsistent_bounds_are_found) {
  const auto map = Teuchos::rcp(new Map(3, 0, testComm()));
  const auto l = toVector({0.0, 0.0, 0.0}, map);
  EXPECT_FALSE(Bounds::findBoundFault(*l, {l.get(), toVector({0.0, inf, 1.0}, map).get()}).found);
  EXPECT_FALSE(Bounds::findBoundFault(*l, {}).found);
  const qp::BoundFault crossed = Bounds::findBoundFault(*l, {l.get(), toVector({1.0, 1.0, -0.5}, map).get()});
  EXPECT_TRUE(crossed.found);
  EXPECT_EQ(crossed.entry, 2);
  EXPECT_EQ(crossed.lower, 0.0);
  EXPECT_EQ(crossed.upper, -0.5);
  EXPECT_TRUE(
      std::isnan(Bounds::findBoundFault(*l, {l.get(), toVector({1.0, std::nan(""), 1.0}, map).get()}).upper));
  EXPECT_EQ(Bounds::findBoundFault(*l, {toVector({0.0, inf, 0.0}, map).get()}).entry, 1);
}

TEST(BoundOps, random_vectors_do_not_depend_on_the_distribution) {
  MultiVector distributed(Teuchos::rcp(new Map(100, 0, testComm())), 1);
  MultiVector replicated(Teuchos::rcp(new Map(100, 0, testComm(), Tpetra::LocallyReplicated)), 1);
  Bounds::setRandom(distributed);
  Bounds::setRandom(replicated);
  EXPECT_EQ(fromVector(distributed), fromVector(replicated));
  double sum = 0.0;
  for (double value : fromVector(distributed)) {
    EXPECT_LT(std::abs(value), 1.0);
    sum += value;
  }
  EXPECT_LT(std::abs(sum), 30.0); // five standard deviations of a sum of 100 uniform numbers
}

// A disc's projection, smoothed: along the radius that of an interval, along the tangent x/v; the derivative
// that it says it has is the one of differences, and without width it is the projection itself.
TEST(BoundOps, smoothed_discs) {
  const qp::Disc disc = {0, 1, {0.3, -0.2}, 0.7};
  std::vector<qp::Slip> rims;
  const auto projected = [&](double a, double b, double width, double* slope) {
    std::array<double, 2> x = {a, b};
    double unused[2];
    rims.clear();
    qp::Kernels::projectSmoothly(std::vector<qp::Disc>{disc}, width, x.data(),
                                 slope != nullptr ? slope : unused, rims);
    return x;
  };
  for (double width : {1.0, 0.1, 1e-2})
    for (const auto& [a, b] : std::vector<std::pair<double, double>>{{0.4, 0.1}, {1.5, 0.8}, {-3.0, 2.0}}) {
      double slope[2];
      projected(a, b, width, slope);
      const std::vector<qp::Slip> found = rims;
      constexpr double h = 1e-6;
      for (int k = 0; k < 2; ++k) {
        const auto up = projected(a + (k == 0 ? h : 0), b + (k == 1 ? h : 0), width, nullptr),
                   down = projected(a - (k == 0 ? h : 0), b - (k == 1 ? h : 0), width, nullptr);
        double expected[2] = {k == 0 ? slope[0] : 0.0, k == 1 ? slope[1] : 0.0};
        for (const qp::Slip& rim : found) {
          const double t[2] = {-rim.normal[1], rim.normal[0]};
          for (int i = 0; i < 2; ++i)
            expected[i] += t[i] * t[k] / (1.0 + rim.curvature);
        }
        for (std::size_t i = 0; i < 2; ++i) // h²/w² of differences, and ε/h
          EXPECT_NEAR((up[i] - down[i]) / (2.0 * h), expected[i], 1e-7) << width << " " << a;
      }
    }
  const auto x = projected(1.5, 0.8, 1e-9, nullptr);
  const double reach = std::hypot(1.2, 1.0);
  EXPECT_NEAR(x[0], 0.3 + 0.7 * 1.2 / reach, 1e-8);
  EXPECT_NEAR(x[1], -0.2 + 0.7 * 1.0 / reach, 1e-8);
  const auto inside = projected(0.4, 0.1, 1e-9, nullptr);
  EXPECT_NEAR(inside[0], 0.4, 1e-8);
  EXPECT_NEAR(inside[1], 0.1, 1e-8);
}

} // namespace test_bound_ops
