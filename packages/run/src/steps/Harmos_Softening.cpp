// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Softening.hpp"

#include "Harmos_SolutionHistory.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace Harmos::run {
namespace {

using Law = scene::InterfaceLaw;

std::vector<double> cut(const std::vector<double>& all, std::size_t begin, std::size_t size) {
  const auto from = all.begin() + static_cast<std::ptrdiff_t>(begin);
  return {from, from + static_cast<std::ptrdiff_t>(size)};
}

constexpr double steepness = 0.25; // θ

// Tractions are known to some ten times what residuals are.
double known(double tolerance) {
  constexpr double factor = 10.0, most = 0.01;
  return std::min(factor * tolerance, most);
}

bool isThroughOrigin(const Law::RowAnswer& row) {
  return row.unstretched == 0.0;
}

} // namespace

Softening::Softening(const Teuchos::Comm<int>& comm, std::vector<long long> keys,
                     std::vector<double> stiffnesses)
    : rows_(comm, std::move(keys)), stiffnesses_(std::move(stiffnesses)), span_(rows_, stiffnesses_) {}

// Whether any point softens, on any rank.
bool Softening::follow(const std::vector<Part>& parts, const std::vector<double>& openings,
                       std::optional<double> times, double known) const {
  bool softens = false;
  std::size_t begin = 0;
  for (const Part& part : parts) {
    const std::vector<double> own = cut(openings, begin, part.rows->size());
    softens = part.law->follow(*part.rows, own, times, known, *part.trial) || softens;
    begin += part.rows->size();
  }
  return rows_.largest(softens ? 1.0 : 0.0) > 0.0;
}

void Softening::begin(const std::vector<Part>& parts, std::optional<double> advance) {
  span_.begin();
  agreed_ = 0.0;
  answers_ = 0.0;
  start_ = {};
  isOnTheWay_ = false;
  leastMisfit_ = 0.0;
  waited_ = 0.0;
  startedAt_ = 1.0;
  if (!advance || accepted_.size() < 2)
    return;
  std::vector<double> openings = accepted_[1].openings;
  for (std::size_t k = 0; k < openings.size(); ++k)
    openings[k] += *advance * (openings[k] - accepted_[0].openings[k]);
  isOnTheWay_ = follow(parts, openings, steepness, 0.0);
  if (!isOnTheWay_ || accepted_[1].multipliers.multiplier.is_null())
    return;
  const feti::WarmStart &before = accepted_[0].multipliers, &now = accepted_[1].multipliers;
  const auto multiplier = Teuchos::rcp(new MultiVector(*now.multiplier, Teuchos::Copy));
  multiplier->update(-*advance, *before.multiplier, 1.0 + *advance);
  start_ = {multiplier, now.mu};
  for (std::size_t k = 0; k < now.mu.size(); ++k)
    start_.mu[k] += *advance * (now.mu[k] - before.mu[k]);
}

void Softening::commit() {
  if (accepted_.size() == 2)
    accepted_.erase(accepted_.begin());
  accepted_.push_back(last_);
}

// Where nothing gets better differences lead astray: of answers that touch otherwise, or hardly differ.
void Softening::watch(double worst) {
  constexpr double better = 0.7, patience = 5.0;
  if (leastMisfit_ == 0.0 || worst < better * leastMisfit_) {
    leastMisfit_ = worst;
    waited_ = 0.0;
  } else if (++waited_ >= patience) {
    span_.forget();
    waited_ = 0.0;
    leastMisfit_ = worst;
  }
}

// Where surfaces press in the last answer they go on to, as springs: they part where what presses is gone.
std::vector<double> Softening::forces(const std::vector<Part>& parts,
                                      const std::vector<double>& openings) const {
  std::vector<double> all;
  for (const Part& part : parts) {
    std::vector<double> own = cut(openings, all.size(), part.rows->size());
    const std::vector<double> law = part.law->lawForces(*part.trial, *part.rows, own);
    for (std::size_t k = 0; k < own.size(); ++k) {
      const double pressed =
          part.answer[k].isLimited
              ? 0.0
              : std::min(0.0, std::min(0.0, part.answer[k].hold()) + stiffnesses_[all.size()] * own[k]);
      all.push_back(law[k] + pressed);
    }
  }
  return all;
}

double Softening::tolerance(double asked) const {
  if (!isOnTheWay_)
    return asked;
  constexpr double share = 0.1, least = 1.0 / 30.0;
  return std::clamp(share * startedAt_, least * asked, asked);
}

bool Softening::update(const std::vector<Part>& parts, const feti::WarmStart& multipliers, double tolerance,
                       double startedAt) {
  start_ = {};
  double worst = 0.0;
  bool isFrozen = true;
  std::vector<double> openings, holds;
  for (const Part& part : parts) {
    worst = std::max(worst, part.law->misfit(part.answer, *part.trial));
    for (const Law::RowAnswer& row : part.answer) {
      isFrozen = isFrozen && isThroughOrigin(row);
      openings.push_back(row.opening());
      holds.push_back(row.hold());
    }
  }
  worst = rows_.largest(worst);
  isFrozen = !(rows_.largest(isFrozen ? 0.0 : 1.0) > 0.0);
  // Springs through the origin have the same answer as those that met the law, but for what the solver
  // leaves: where it has met the law twice no more is to be had, up to a hundredth of the strength.
  constexpr double certain = 2.0, amplified = 100.0, most = 0.01;
  const bool isThere = worst <= known(tolerance);
  const bool isAsGood = agreed_ >= certain && worst <= std::min(amplified * known(tolerance), most);
  const double its = this->tolerance(tolerance);
  answers_ += 1.0;
  last_ = {openings, multipliers};
  if (isFrozen && (isThere || isAsGood))
    return false;
  span_.add(openings, holds, multipliers, its);
  startedAt_ = startedAt;
  watch(worst);
  if (isThere) {
    agreed_ += 1.0;
    isOnTheWay_ = false;
    follow(parts, openings, std::nullopt, known(tolerance));
    return true;
  }
  isOnTheWay_ = true;
  const AnswerSpan::Found found =
      span_.settle([&](const std::vector<double>& there) { return forces(parts, there); });
  start_ = found.multipliers;
  follow(parts, found.openings, steepness, known(tolerance));
  return true;
}

void Softening::exchange(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem) {
  archive.number("laws met in the step", agreed_);
  archive.number("answers of interfaces in the step", answers_);
  archive.number("on the way", isOnTheWay_);
  archive.number("residual at the start", startedAt_);
  archive.number("least misfit", leastMisfit_);
  archive.number("waited for a smaller misfit", waited_);
  span_.exchange(archive, problem);
  bool startsElsewhere = !start_.multiplier.is_null();
  archive.number("starts elsewhere", startsElsewhere);
  if (startsElsewhere)
    feti::exchange(archive, problem, "next start", start_);
  std::size_t count = accepted_.size();
  archive.number("accepted answers", count);
  accepted_.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::string name = "accepted answer " + std::to_string(k);
    accepted_[k].openings.resize(rows_.size());
    rows_.exchange(archive, name + ", openings", "interfaces", accepted_[k].openings);
    feti::exchange(archive, problem, name, accepted_[k].multipliers);
  }
}

} // namespace Harmos::run
