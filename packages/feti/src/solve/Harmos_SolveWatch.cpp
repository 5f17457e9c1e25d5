// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SolveWatch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::feti::Details {

Patience slowness(double tolerance) {
  // For each power of ten of the tolerance: twice what bodies of one material in good subdomains take.
  constexpr double productsPerDigit = 20.0;
  const double products = productsPerDigit * std::clamp(-std::log10(tolerance), 2.0, 12.0);
  return [products, worst = 0.0, best = std::numeric_limits<double>::infinity()](
             const qp::IterationRecord& record, double target) mutable {
    worst = std::max(worst, record.projectedGradient);
    best = std::min(best, record.projectedGradient);
    if (record.hessianApplications < products || !(best > target))
      return false;
    // At the rate so far, is as much again to come as half of what was?
    return 2.0 * std::log(best / target) > std::log(worst / best);
  };
}

Patience standstill() {
  constexpr long long most = 300; // products without half the residual
  return [mark = std::numeric_limits<double>::infinity(), since = 0LL](const qp::IterationRecord& record,
                                                                       double) mutable {
    if (record.projectedGradient < 0.5 * mark) {
      mark = record.projectedGradient;
      since = record.hessianApplications;
    }
    return record.hessianApplications - since > most;
  };
}

void SolveWatch::exchange(Archive& archive) {
  double asked = asked_, tolerance = tolerance_;
  archive.number("tolerance asked", asked);
  archive.number("tolerance", tolerance);
  if (asked == asked_)
    tolerance_ = tolerance;
  if (further_)
    further_(archive);
  if (vectors_ == Vectors::None)
    return;
  bool isSo = true;
  archive.number(vectors_ == Vectors::In ? vectorsName : leftName, isSo);
  exchangeBefore(archive);
}

void SolveWatch::exchangeBefore(Archive& archive) {
  std::vector<double> rows = qp::toNumbers(before_.history), counters = qp::toNumbers(before_.counters);
  archive.numbers("history before vectors", rows);
  archive.numbers("counters before vectors", counters);
  before_.history = qp::historyOf(rows);
  before_.counters = qp::countersOf(counters);
  int ranks = ranks_;
  archive.number("ranks of vectors", ranks);
  if (archive.isReading())
    isForeign_ = vectors_ == Vectors::In && ranks != ranks_;
}

void SolveWatch::goesOnAfter(const qp::Result& before) {
  before_ = before;
  patience_ = nullptr;
  isOver_ = isStopped_ = false;
  if (!monitor_.is_null() && !before.history.empty())
    monitor_->goesOnAfter(before.lastRecord());
}

void SolveWatch::recorded(const qp::IterationRecord& record) {
  isOver_ = patience_ && patience_(record, target_());
  if (!monitor_.is_null())
    monitor_->recorded(record);
}

SolveWatch::Wish SolveWatch::ask(const qp::IterationState<MultiVector>& state) {
  const Wish wish = monitor_.is_null() ? Wish::GoOn : monitor_->ask(state);
  isStopped_ = wish == Wish::GoOn && isOver_;
  return isStopped_ ? Wish::SaveAndStop : wish;
}

void SolveWatch::save(const Exchange& state) {
  if (isStopped_ || monitor_.is_null()) // goes on at once; or nobody keeps it
    return;
  monitor_->save([&](Archive& archive) {
    exchange(archive);
    state(archive);
  });
}

} // namespace Harmos::feti::Details
