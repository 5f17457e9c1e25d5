// SPDX-License-Identifier: BSD-3-Clause

/// Nonsmooth terms and their faces against their definitions, entry by entry.

#include "Harmos_BlockOps.hpp"
#include "Harmos_FaceOps.hpp"
#include "Harmos_SerialQp.hpp"
#include "Harmos_SoftBounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace test_blocks {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

using Terms = BlockOps<double, SerialVector>;
using Faces = FaceOps<double, SerialVector>;
using Reference = SerialFaces;
constexpr double inf = std::numeric_limits<double>::infinity();

// Intervals of all kinds, and two discs, with points in, on and off them.
struct Sample {
  explicit Sample(std::mt19937& random) {
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    const auto fill = [&](SerialVector& v) {
      v().resize(size);
      std::generate(v().begin(), v().end(), [&] { return number(random); });
    };
    for (SerialVector* v : {&x, &g, &lower, &upper})
      fill(*v);
    for (std::size_t i = 0; i < size; ++i) {
      const bool isPaired = i == 1 || i == 5 || i == 8 || i == 9;
      const double low = -0.3 + 0.5 * lower()[i], width = 0.2 * static_cast<double>(i % 3);
      lower()[i] = isPaired || i % 4 == 3 ? -inf : low;
      upper()[i] = isPaired || i % 4 == 2 || i == 7 ? inf : low + width;
      face.push_back(0);
    }
    discs = std::make_unique<LocalDiscs>(std::vector<Disc>{{8, 5, {0.1, -0.2}, 0.4}, {1, 9, {0.0, 0.0}, 0.9}},
                                         size);
    set = {&lower, &upper, discs.get()};
  }

  static constexpr std::size_t size = 12;
  SerialVector x{{}}, g{{}}, lower{{}}, upper{{}};
  std::unique_ptr<LocalDiscs> discs;
  FeasibleSet<SerialVector> set;
  ActiveFace face;
};

void expectSame(const ActiveFace& one, const ActiveFace& other) {
  EXPECT_TRUE(std::equal(one.begin(), one.end(), other.begin(), other.end()));
  ASSERT_EQ(one.slipping.size(), other.slipping.size());
  for (std::size_t k = 0; k < one.slipping.size(); ++k) {
    const Slip &a = one.slipping[k], &b = other.slipping[k];
    EXPECT_EQ(a.first, b.first);
    EXPECT_EQ(a.second, b.second);
    for (int i : {0, 1})
      EXPECT_NEAR(a.normal[i], b.normal[i], 1e-14);
    EXPECT_NEAR(a.curvature, b.curvature, 1e-13 * (1.0 + b.curvature));
  }
}

} // namespace

// A chain of updates, each from the face before.
TEST(Blocks, faces_of_intervals_and_discs_are_those_of_their_definitions) {
  std::mt19937 random(5);
  std::size_t slips = 0, held = 0;
  for (int k = 0; k < 300; ++k) {
    Sample sample(random);
    ActiveFace reference = sample.face;
    for (int update = 0; update < 4; ++update) {
      const Sample next(random);
      const FaceUpdate how = {0.02, 0.05, 0.7, update % 2 == 0 ? 0.0 : 0.3};
      const FaceChange change = Terms::update(sample.set, next.x, next.g, how, sample.face);
      const FaceChange expected = Reference::update(next.x, next.g, sample.set, how, reference);
      expectSame(sample.face, reference);
      EXPECT_EQ(change.active, expected.active);
      EXPECT_EQ(change.changed, expected.changed);
      EXPECT_EQ(change.slips, expected.slips);
      EXPECT_NEAR(change.violation2, expected.violation2, 1e-14);
      EXPECT_NEAR(change.wrongSign2, expected.wrongSign2, 1e-14);
      slips += sample.face.slipping.size();
      held += static_cast<std::size_t>(change.active);

      // On that face.
      SerialVector moved = next.x, other = next.x, masked = next.g, maskedToo = next.g;
      Terms::moveToFace(sample.set, sample.face, moved);
      Reference::moveToFace(other, sample.set, reference);
      Faces::mask(masked, sample.face);
      Reference::mask(maskedToo, reference);
      Faces::addCurvature(sample.face, 0.5, next.x, true, masked);
      Reference::addCurvature(reference, 0.5, next.x, true, maskedToo);
      for (std::size_t i = 0; i < Sample::size; ++i) {
        EXPECT_NEAR(moved()[i], other()[i], 1e-14);
        EXPECT_NEAR(masked()[i], maskedToo()[i], 1e-12);
      }
    }
  }
  EXPECT_GT(slips, 500U);
  EXPECT_GT(held, 3000U);
}

// The projected gradient is that of gradient projection's splitting, and what recedes is a direction that the
// set has for ever.
TEST(Blocks, projected_gradients_and_receding_directions) {
  std::mt19937 random(6);
  for (int k = 0; k < 200; ++k) {
    Sample sample(random);
    const Blocks blocks = Terms::setsOf(sample.set);
    Terms::project(blocks, sample.x);
    SerialVector projected = sample.g;
    double norm2 = 0.0;
    for (const auto& block : blocks)
      block->project(sample.x().data(), projected().data());
    for (std::size_t i = 0; i < Sample::size; ++i) {
      const double expected = Reference::phi(sample.x, sample.g, i, sample.set) +
                              Reference::beta(sample.x, sample.g, i, sample.set);
      EXPECT_NEAR(projected()[i], expected, 1e-14) << i;
      norm2 += expected * expected;
    }
    EXPECT_NEAR(Terms::projectedGradientNorm(sample.set, blocks, sample.x, sample.g), std::sqrt(norm2),
                1e-13);
    SerialVector d = sample.g, other = sample.g;
    EXPECT_NEAR(Terms::recede(blocks, d), Reference::recede(other, sample.set), 1e-14);
    EXPECT_EQ(d(), other());
  }
}

// What limits that follow an entry move with it: pairs along the normal of their rim, intervals by their
// side.
TEST(Blocks, what_is_held_at_limits_follows_them) {
  const std::vector<Coupling> couplings = {{0, 1, {0.6, 0.8}, {3.0, 4.0}, 3, 0.5},
                                           {2, -1, {-1.0, 0.0}, {5.0, 0.0}, 3, 0.25}};
  const std::vector<double> x = {7.0, 7.0, 7.0, 2.0};
  std::vector<double> y = {1.0, 1.0, 1.0, 1.0};
  Kernels::addFollowing(couplings, x.data(), y.data());
  EXPECT_EQ(y, (std::vector<double>{1.0 + 0.6, 1.0 + 0.8, 1.0 - 0.5, 1.0}));
}

// Forces are derivatives of ½κ dist², springs are what forces are beyond ends, and what the face makes of
// them is their value.
TEST(Blocks, soft_intervals_pull_and_bend) {
  const LocalSoftBounds bounds(
      {{0, -1.0, 1.0, 10.0}, {2, -inf, 0.5, 4.0}, {3, 2.0, 2.0, 3.0}, {4, 0.0, 1.0, 0.0}}, 5);
  const Blocks blocks = {std::make_shared<SoftIntervals>(bounds)};
  SerialVector x({}), y({}), none({});
  x() = {-3.0, 7.0, 1.5, 1.0, 9.0};
  y().assign(5, 0.0);
  none().assign(5, 0.0);
  Terms::addForces(blocks, x, y);
  EXPECT_EQ(y(), (std::vector<double>{-20.0, 0.0, 4.0, -3.0, 0.0}));
  ActiveFace face(5, 0);
  const FaceChange change = Terms::update(blocks, x, none, {}, face);
  EXPECT_EQ(change.changed, 3);
  EXPECT_EQ(change.active, 0);
  EXPECT_EQ(change.wrongForces2, 400.0 + 16.0 + 9.0);
  ASSERT_EQ(face.springs.size(), 3U);
  SerialVector model({});
  model().assign(5, 0.0);
  Faces::addSprings(face, 1.0, x, true, model);
  EXPECT_EQ(model(), y());
  // Within its noise of an end nothing changes; beyond, the face does, and says by how much it was wrong.
  x()[0] = -1.0 + 1e-3;
  ActiveFace still = face;
  EXPECT_EQ(Terms::update(blocks, x, none, {1e-2}, still).changed, 0);
  const FaceChange freed = Terms::update(blocks, x, none, {}, face);
  EXPECT_EQ(freed.changed, 1);
  EXPECT_NEAR(freed.wrongForces2, 1e-4, 1e-12);
  Terms::correctForces(blocks, face, x, none);
  EXPECT_EQ(none(), std::vector<double>(5, 0.0));
  // Frozen.
  x() = {5.0, 0.0, 0.0, 0.0, 0.0};
  const std::size_t before = face.springs.size();
  EXPECT_EQ(Terms::update(blocks, x, none, {0.0, 0.0, 0.0, 0.0, true}, face).changed, 0);
  EXPECT_EQ(face.springs.size(), before);
  SerialVector d({});
  d() = {-1.0, 2.0, -3.0, 4.0, 5.0};
  EXPECT_EQ(Terms::recede(blocks, d), std::sqrt(1.0 + 16.0));
  EXPECT_EQ(d(), (std::vector<double>{0.0, 2.0, -3.0, 0.0, 5.0}));
}

} // namespace test_blocks
