// SPDX-License-Identifier: BSD-3-Clause
// What guards the record of designs: a run that goes on from it asks for nothing that is there, and notices
// where it goes another way.
#include "Harmos_DesignRecord.hpp"
#include "Harmos_MemoryArchive.hpp"
#include "Harmos_TestErrors.hpp"

#include <BelosTpetraAdapter.hpp>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace Harmos::shape {
namespace {

using Design = std::vector<double>;

// Σ a², refused above 100; counts what it is asked.
class Squares : public sensitivity::DesignFunction {
 public:
  int values = 0, gradients = 0;

  double value(const Design& design, double) override {
    ++values;
    double sum = 0.0;
    for (double a : design)
      sum += a * a;
    if (sum > 100.0)
      throw sensitivity::RefusedDesign("too\nlarge: " + std::to_string(design.front()));
    return sum;
  }
  Design gradient(const Design& design, double) override {
    ++gradients;
    Design result = design;
    for (double& a : result)
      a *= 2.0;
    return result;
  }
};

struct Recorded {
  Squares function;
  int asked = 0;
  DesignRecord record{function, [this] { ++asked; }};
};

const Design first = {1.0, 0.1}, second = {0.3, -2.0}, far = {20.0, 0.0};

// What an optimiser asks: a step that is refused, one that is taken, and a design made of answers.
Design walk(DesignRecord& record) {
  Design told = {record.value(first, 0.0)};
  const Design gradient = record.gradient(first, 0.0);
  told.insert(told.end(), gradient.begin(), gradient.end());
  try {
    record.value(far, 0.0);
    ADD_FAILURE() << "the design is refused";
  } catch (const sensitivity::RefusedDesign& error) {
    EXPECT_TRUE(contains(error.what(), "large: 20.0"));
  }
  told.push_back(record.value(second, 1e-3));
  const Design made = record.derived(second, [] { return Design{7.0}; });
  told.insert(told.end(), made.begin(), made.end());
  EXPECT_TRUE(record.derived(first, [] { return Design(); }).empty());
  return told;
}

// Over a checkpoint.
void carry(Recorded& from, Recorded& to) {
  MemoryState<MultiVector> state;
  MemoryArchive<MultiVector> writer(state, false), reader(state, true);
  from.record.exchange(writer);
  to.record.exchange(reader);
  to.record.setRefusals(from.record.refusals());
}

} // namespace

TEST(DesignRecord, first_run_asks_for_everything) {
  Recorded run;
  EXPECT_EQ(walk(run.record), (Design{1.01, 2.0, 0.2, 4.09, 7.0}));
  EXPECT_EQ(run.function.values, 3);
  EXPECT_EQ(run.function.gradients, 1);
  // A run may stop before values only.
  EXPECT_EQ(run.asked, 3);
  EXPECT_EQ(run.record.values(), 3);
  EXPECT_EQ(run.record.refused(), 1);
  EXPECT_FALSE(run.record.isRecalling());
}

TEST(DesignRecord, next_run_asks_for_nothing_that_is_there) {
  Recorded run, next;
  const Design told = walk(run.record);
  carry(run, next);
  EXPECT_TRUE(next.record.isRecalling());
  EXPECT_EQ(walk(next.record), told);
  EXPECT_FALSE(next.record.isRecalling());
  EXPECT_EQ(next.function.values + next.function.gradients + next.asked, 0);
  EXPECT_EQ(next.record.values(), 3);
  EXPECT_EQ(next.record.refused(), 1);
  EXPECT_EQ(next.record.forgotten(), 0U);
  // And goes on, with the whole on record.
  EXPECT_EQ(next.record.value({2.0, 0.0}, 0.0), 4.0);
  EXPECT_EQ(next.asked, 1);
  Recorded third;
  carry(next, third);
  walk(third.record);
  EXPECT_TRUE(third.record.isRecalling());
  EXPECT_EQ(third.record.value({2.0, 0.0}, 0.0), 4.0);
  EXPECT_EQ(third.function.values, 0);
}

TEST(DesignRecord, another_question_ends_what_is_recalled) {
  // By the design, the tolerance, and what is asked.
  for (int other = 0; other < 3; ++other) {
    Recorded run, next;
    walk(run.record);
    carry(run, next);
    next.record.value(first, 0.0);
    if (other == 0)
      next.record.gradient(second, 0.0);
    else if (other == 1)
      next.record.gradient(first, 1e-8);
    else
      next.record.value(first, 0.0);
    EXPECT_FALSE(next.record.isRecalling()) << other;
    EXPECT_EQ(next.record.forgotten(), 5U) << other;
    EXPECT_EQ(next.function.values + next.function.gradients, 1) << other;
    // What was forgotten does not come back.
    Recorded third;
    carry(next, third);
    third.record.value(first, 0.0);
    EXPECT_TRUE(third.record.isRecalling());
    EXPECT_EQ(third.function.values, 0);
    EXPECT_THROW(third.record.value(far, 0.0), sensitivity::RefusedDesign);
    EXPECT_EQ(third.function.values, 1) << other;
  }
}

TEST(DesignRecord, halt_before_a_value_keeps_what_was) {
  Squares function;
  int left = 1;
  DesignRecord record(function, [&left] {
    if (left-- == 0)
      throw InputError("halt");
  });
  record.value(first, 0.0);
  record.gradient(first, 0.0);
  EXPECT_THROW(record.value(second, 0.0), InputError);
  EXPECT_EQ(record.values(), 1);
  EXPECT_EQ(function.values, 1);
  MemoryState<MultiVector> state;
  MemoryArchive<MultiVector> writer(state, false), reader(state, true);
  record.exchange(writer);
  Recorded next;
  next.record.exchange(reader);
  next.record.value(first, 0.0);
  next.record.gradient(first, 0.0);
  EXPECT_EQ(next.function.values + next.function.gradients, 0);
  EXPECT_EQ(next.record.value(second, 0.0), 4.09);
}

TEST(DesignRecord, record_that_is_cut_off) {
  Recorded run, next;
  walk(run.record);
  MemoryState<MultiVector> state;
  MemoryArchive<MultiVector> writer(state, false), reader(state, true);
  run.record.exchange(writer);
  state.numbers.begin()->second.pop_back();
  state.numbers.begin()->second.pop_back();
  EXPECT_THROW(next.record.exchange(reader), InternalError);
}

} // namespace Harmos::shape
