// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Timeline.hpp"
#include "Harmos_Types.hpp"

namespace Harmos::run {

/// The time of a run of several steps and its next attempt: a step of the deck, or a part of it after a
/// failed attempt. Parts result from repeated halving, so their ends do not depend on the history of
/// attempts. The rest of a step is done in parts of equal length; the next step is tried as a whole.
///
/// All members are local. Guarded by tests/unit/run/test_step_sequence.cpp.
class StepClock {
 public:
  explicit StepClock(const scene::Timeline& timeline) : timeline_(timeline) {}

  bool isOver() const { return step_ == static_cast<int>(timeline_.ends().size()); }
  int steps() const { return static_cast<int>(timeline_.ends().size()); }
  /// Of the deck, from 1: the one that is being done.
  int step() const { return step_ + 1; }
  double from() const { return at(done_); }
  double to() const { return at(done_ + 1); }
  /// Whether to() is the end of the deck's step.
  bool endsStep() const { return done_ + 1 == parts_; }
  bool isPart() const { return parts_ > 1; }

  /// to() has been reached. @param keepsParts the deck's next step begins with as many parts.
  void accept(bool keepsParts = false);
  /// Half of the last part is tried next; false, and nothing is changed, if that were less than the smallest.
  bool halve();
  /// Whether halve() would. A single step is a static state: half of it is none.
  bool mayHalve() const;
  /// Twice the last part is tried next, where that ends where a part twice as long would.
  void join();

  void exchange(qp::StateArchive<MultiVector>& archive);

 private:
  double at(long long part) const;

  const scene::Timeline& timeline_;
  int step_ = 0;                   // done, of the deck
  long long parts_ = 1, done_ = 0; // of the present step
};

} // namespace Harmos::run
