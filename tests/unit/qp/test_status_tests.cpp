// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestQp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace test_status_tests {

using namespace Harmos;
using namespace Harmos::qp;

namespace {

using State = IterationState<MultiVector>;
using Combo = StatusTestCombo<MultiVector>;

// Counts how often it is asked.
class Probe : public StatusTest<MultiVector> {
 public:
  explicit Probe(Status answer) : answer_(answer) {}
  Status checkStatus(const State&) override {
    ++asked;
    return answer_;
  }
  Status getStatus() const override { return answer_; }
  void reset() override {}
  void print(std::ostream&, int) const override {}
  int asked = 0;

 private:
  Status answer_;
};

} // namespace

TEST(StatusTest, projected_gradient_passes_at_the_limit_and_never_for_nan) {
  StatusTestProjectedGradient<MultiVector> test(0.5, 4.0);
  EXPECT_EQ(test.getStatus(), Status::Undefined);
  State state;
  state.projectedGradient = 2.0;
  EXPECT_EQ(test.checkStatus(state), Status::Passed);
  state.projectedGradient = 2.0000001;
  EXPECT_EQ(test.checkStatus(state), Status::Failed);
  state.projectedGradient = std::nan("");
  EXPECT_EQ(test.checkStatus(state), Status::Failed);
  test.reset();
  EXPECT_EQ(test.getStatus(), Status::Undefined);
}

// ‖x + s‖ grows above the fixed scale: 5 against 1.
TEST(StatusTest, equality_residual_is_measured_against_the_shifted_solution) {
  const auto map = Teuchos::rcp(new Map(2, 0, testComm()));
  const auto x = toVector({2.0, 4.0}, map);
  StatusTestEqualityResidual<MultiVector> test(0.1, 1.0, toVector({1.0, 0.0}, map));
  State state;
  state.x = x.get();
  state.equalityResidual = 0.49;
  EXPECT_EQ(test.checkStatus(state), Status::Passed);
  EXPECT_EQ(test.scale(), 5.0);
  state.equalityResidual = 0.51;
  EXPECT_EQ(test.checkStatus(state), Status::Failed);
  StatusTestEqualityResidual<MultiVector> fixed(0.1, 1.0);
  state.equalityResidual = 0.49;
  EXPECT_EQ(fixed.checkStatus(state), Status::Failed);
}

// A solution of rounding errors has residuals of rounding errors; one that is larger has none of these
// excuses.
TEST(StatusTest, equality_residual_of_a_negligible_solution) {
  const auto map = Teuchos::rcp(new Map(2, 0, testComm()));
  const auto zero = toVector({0.0, 0.0}, map);
  for (const auto& [size, status] : {std::pair(1e-15, Status::Passed), std::pair(1e-13, Status::Failed)}) {
    const auto x = toVector({size, 0.0}, map);
    StatusTestEqualityResidual<MultiVector> test(1e-8, 0.0, zero, 1e-14);
    State state;
    state.x = x.get();
    state.equalityResidual = 0.5 * size;
    EXPECT_EQ(test.checkStatus(state), status) << size;
  }
}

TEST(StatusTest, iteration_limit) {
  StatusTestMaxIterations<MultiVector> test(3);
  State state;
  state.inner = 2;
  EXPECT_EQ(test.checkStatus(state), Status::Failed);
  state.inner = 3;
  EXPECT_EQ(test.checkStatus(state), Status::Passed);
}

TEST(StatusTest, gradient_relative_to_the_first) {
  StatusTestInitialGradient<MultiVector> test(0.1);
  State state;
  state.projectedGradient = 50.0;
  EXPECT_EQ(test.checkStatus(state), Status::Failed);
  state.projectedGradient = 5.0;
  EXPECT_EQ(test.checkStatus(state), Status::Passed);
  test.reset();
  EXPECT_EQ(test.checkStatus(state), Status::Failed); // 5 is the first now
}

// Ten units at first; then less than a tenth of all over two steps.
TEST(StatusTest, cost_stagnation_over_a_window) {
  StatusTestCostStagnation<MultiVector> test(0.1, 2);
  State state;
  const auto check = [&](double decrease) {
    ++state.inner;
    state.decrease = decrease;
    return test.checkStatus(state);
  };
  EXPECT_EQ(check(10.0), Status::Failed);
  EXPECT_EQ(check(0.5), Status::Failed);
  EXPECT_EQ(check(0.4), Status::Passed);              // 0.9 of 10.9
  EXPECT_EQ(test.checkStatus(state), Status::Passed); // asked again about the same iterate
  EXPECT_EQ(test.reason(), Reason::Stagnation);
  EXPECT_EQ(check(std::nan("")), Status::Failed);
  EXPECT_EQ(check(0.1), Status::Failed); // the window begins anew
  EXPECT_EQ(check(0.1), Status::Passed);
}

TEST(StatusTest, time_limit) {
  const auto x = toVector({1.0}, Teuchos::rcp(new Map(1, 0, testComm())));
  State state;
  state.x = x.get();
  StatusTestMaxTime<MultiVector> never(1e9), at_once(0.0);
  EXPECT_EQ(never.checkStatus(state), Status::Failed);
  EXPECT_EQ(at_once.checkStatus(state), Status::Passed);
  EXPECT_EQ(at_once.reason(), Reason::TimeLimit);
}

TEST(StatusTest, reason_of_a_combination) {
  const auto gradient = Teuchos::rcp(new StatusTestProjectedGradient<MultiVector>(1.0, 1.0));
  const auto limit = Teuchos::rcp(new StatusTestMaxIterations<MultiVector>(3));
  Combo either(Combo::Type::Or, {limit, gradient}), both(Combo::Type::And, {gradient, limit});
  State state;
  state.inner = 3;
  state.projectedGradient = 2.0;
  EXPECT_EQ(either.checkStatus(state), Status::Passed);
  EXPECT_EQ(either.reason(), Reason::IterationLimit);
  state.projectedGradient = 0.5; // converged at the limit is converged
  EXPECT_EQ(either.checkStatus(state), Status::Passed);
  EXPECT_EQ(either.reason(), Reason::Converged);
  EXPECT_EQ(both.checkStatus(state), Status::Passed);
  EXPECT_EQ(both.reason(), Reason::IterationLimit);
}

TEST(StatusTest, combinations) {
  const auto yes = Teuchos::rcp(new Probe(Status::Passed)), no = Teuchos::rcp(new Probe(Status::Failed));
  const State state;
  EXPECT_EQ(Combo(Combo::Type::And, {yes, no}).checkStatus(state), Status::Failed);
  EXPECT_EQ(Combo(Combo::Type::And, {yes, yes}).checkStatus(state), Status::Passed);
  EXPECT_EQ(Combo(Combo::Type::Or, {no, yes}).checkStatus(state), Status::Passed);
  EXPECT_EQ(Combo(Combo::Type::Or, {no, no}).checkStatus(state), Status::Failed);
  const auto last = Teuchos::rcp(new Probe(Status::Passed));
  EXPECT_EQ(Combo(Combo::Type::Sequence, {no, last}).checkStatus(state), Status::Failed);
  EXPECT_EQ(last->asked, 0); // the sequence stops at the first failure
}

TEST(StatusTest, prints_value_and_limit) {
  StatusTestProjectedGradient<MultiVector> test(0.5, 4.0);
  State state;
  state.projectedGradient = 8.0;
  test.checkStatus(state);
  std::ostringstream text;
  test.print(text);
  EXPECT_EQ(text.str(), "projected gradient = 8 > 2\n");
}

} // namespace test_status_tests
