// SPDX-License-Identifier: BSD-3-Clause

/// An answer that is good enough, and what becomes of it when the solver goes on.

#include "Harmos_KeptAnswer.hpp"
#include "Harmos_MemoryArchive.hpp"
#include "Harmos_Qp.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <gtest/gtest.h>

namespace test_kept_answer {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

Teuchos::RCP<MultiVector> vectorOf(double value) {
  const auto map = Teuchos::rcp(new Map(7, 0, testComm()));
  const auto x = Teuchos::rcp(new MultiVector(map, 1));
  x->putScalar(value);
  return x;
}

double firstOf(const MultiVector& x) {
  std::vector<double> largest(1);
  x.normInf(Teuchos::arrayViewFromVector(largest));
  return largest[0];
}

qp::Result ended(qp::Reason reason) {
  qp::Result result;
  result.reason = reason;
  result.projectedGradientNorm = 9.0;
  result.equalityNorm = 8.0;
  return result;
}

} // namespace

TEST(KeptAnswer, takes_the_place_of_what_came_no_further) {
  for (const qp::Reason reason :
       {qp::Reason::Stagnation, qp::Reason::IterationLimit, qp::Reason::TimeLimit, qp::Reason::Breakdown}) {
    const auto lambda = vectorOf(1.0), mu = vectorOf(2.0);
    feti::Details::KeptAnswer kept;
    kept.keep(*lambda, mu, 0.5, 0.25, 30, {55, 20.0});
    lambda->putScalar(5.0);
    mu->putScalar(6.0);
    qp::Result result = ended(reason);
    EXPECT_TRUE(kept.replace(result, *lambda, mu));
    EXPECT_TRUE(result.converged());
    EXPECT_EQ(firstOf(*lambda), 1.0);
    EXPECT_EQ(firstOf(*mu), 2.0);
    EXPECT_EQ(result.projectedGradientNorm, 0.5);
    EXPECT_EQ(result.equalityNorm, 0.25);
  }
}

TEST(KeptAnswer, leaves_a_better_one_and_a_run_that_is_to_go_on) {
  for (const qp::Reason reason : {qp::Reason::Converged, qp::Reason::Interrupted}) {
    const auto lambda = vectorOf(1.0);
    feti::Details::KeptAnswer kept;
    kept.keep(*lambda, Teuchos::null, 0.5, 0.0, 30, {55, 20.0});
    lambda->putScalar(5.0);
    qp::Result result = ended(reason);
    EXPECT_FALSE(kept.replace(result, *lambda, Teuchos::null));
    EXPECT_EQ(result.reason, reason);
    EXPECT_EQ(firstOf(*lambda), 5.0);
  }
  const auto lambda = vectorOf(5.0);
  feti::Details::KeptAnswer none;
  none.keep(*lambda, Teuchos::null, 0.5, 0.0, 30, {55, 20.0});
  none.forget();
  qp::Result result = ended(qp::Reason::Stagnation);
  EXPECT_FALSE(none.replace(result, *lambda, Teuchos::null));
  EXPECT_EQ(result.reason, qp::Reason::Stagnation);
}

// Going on is worth half of the iterations again, and twenty.
TEST(KeptAnswer, is_spent) {
  feti::Details::KeptAnswer kept;
  EXPECT_FALSE(kept.isSpent(1000));
  kept.keep(*vectorOf(1.0), Teuchos::null, 0.5, 0.0, 40, {60, 20.0});
  EXPECT_FALSE(kept.isSpent(100));
  EXPECT_TRUE(kept.isSpent(101));
  kept.observe(60, 0.26); // no half of it
  EXPECT_TRUE(kept.isSpent(101));
  kept.observe(70, 0.24);
  EXPECT_FALSE(kept.isSpent(130));
  EXPECT_TRUE(kept.isSpent(131));
  kept.observe(71, 9.9);
  EXPECT_FALSE(kept.isSpent(72));
  kept.observe(72, 10.1); // more than twenty times what is kept
  kept.observe(73, 0.2);
  EXPECT_TRUE(kept.isSpent(73));
  kept.forget();
  kept.observe(120, 0.1);
  EXPECT_FALSE(kept.isSpent(1000));
}

// It is part of what a checkpoint knows.
TEST(KeptAnswer, goes_through_an_archive) {
  const auto lambda = vectorOf(1.0), mu = vectorOf(2.0);
  for (const bool isThere : {false, true}) {
    feti::Details::KeptAnswer kept;
    if (isThere)
      kept.keep(*lambda, mu, 0.5, 0.25, 30, {55, 20.0});
    kept.observe(40, 0.2);
    MemoryState<MultiVector> state;
    MemoryArchive<MultiVector> writer(state, false), reader(state, true);
    kept.exchange(writer, *lambda, mu);
    feti::Details::KeptAnswer read;
    read.keep(*vectorOf(3.0), vectorOf(3.0), 3.0, 3.0, 3, {1, 1.0}); // what it knew before is no more
    const auto x = vectorOf(5.0), y = vectorOf(6.0);
    read.exchange(reader, *x, y);
    EXPECT_EQ(read.isThere(), isThere);
    read.observe(45, 0.15);
    EXPECT_FALSE(read.isSpent(95));
    EXPECT_EQ(read.isSpent(96), isThere);
    qp::Result result = ended(qp::Reason::Stagnation);
    EXPECT_EQ(read.replace(result, *x, y), isThere);
    EXPECT_EQ(firstOf(*x), isThere ? 1.0 : 5.0);
    EXPECT_EQ(firstOf(*y), isThere ? 2.0 : 6.0);
    EXPECT_EQ(result.projectedGradientNorm, isThere ? 0.5 : 9.0);
  }
}

} // namespace test_kept_answer
