// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StepClock.hpp"

namespace Harmos::run {

double StepClock::at(long long part) const {
  const auto step = static_cast<std::size_t>(step_);
  const double begin = step_ == 0 ? 0.0 : timeline_.ends()[step - 1], end = timeline_.ends()[step];
  if (part == parts_)
    return end;
  return begin + (end - begin) * static_cast<double>(part) / static_cast<double>(parts_);
}

void StepClock::accept(bool keepsParts) {
  if (++done_ < parts_)
    return;
  ++step_;
  if (!keepsParts)
    parts_ = 1;
  done_ = 0;
}

bool StepClock::mayHalve() const {
  constexpr double rounding = 1.0 + 1e-12; // of shares like 1/64
  return timeline_.hasSteps() && 2.0 * static_cast<double>(parts_) * timeline_.smallest() <= rounding;
}

bool StepClock::halve() {
  if (!mayHalve())
    return false;
  parts_ *= 2;
  done_ *= 2;
  return true;
}

void StepClock::join() {
  if (parts_ == 1 || done_ % 2 != 0)
    return;
  parts_ /= 2;
  done_ /= 2;
}

void StepClock::exchange(qp::StateArchive<MultiVector>& archive) {
  archive.number("steps done", step_);
  archive.number("parts of the step", parts_);
  archive.number("parts done", done_);
}

} // namespace Harmos::run
