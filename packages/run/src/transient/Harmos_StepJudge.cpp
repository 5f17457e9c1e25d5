// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StepJudge.hpp"

#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace Harmos::run {
namespace {

// Of the largest energy there has been: what contacts may give in all.
constexpr double mostGiven = 1e-3;

} // namespace

StepJudge::StepJudge(const Teuchos::Comm<int>& comm, const scene::Scene& scene, const Motion& motion)
    : comm_(comm), scene_(scene), motion_(motion), energy_(motion.kineticEnergy()), kinetic_(energy_) {}

void StepJudge::look(const scene::ContactSetup& contact, const std::vector<ContactState>& states) {
  std::unordered_map<const scene::Effect*, std::size_t> places;
  for (std::size_t k = 0; k < scene_.effects.size(); ++k)
    places[scene_.effects[k].get()] = k;
  reached_.clear();
  const double before = motion_.weightBefore();
  double given = 0.0, closed = 0.0;
  for (std::size_t k = 0; k < states.size(); ++k) {
    if (states[k].isBound)
      continue;
    const Point now = {std::max(0.0, states[k].force), std::max(0.0, states[k].gap)};
    const Key key = {places.at(contact.effects[k]), contact.points[k].node, contact.points[k].side};
    reached_[key] = now;
    closed += now.force > 0.0 ? 1.0 : 0.0;
    if (const auto last = committed_.find(key); last != committed_.end())
      given += before * last->second.force * now.gap - (1.0 - before) * now.force * last->second.gap;
  }
  std::vector<double> sums = {given, closed};
  globalSum(comm_, sums);
  givenByStep_ = sums[0];
  if (!(sums[1] > 0.0)) // what contacts took before is nobody's any more
    givenByStep_ = std::max(givenByStep_, -given_);
  const double kinetic = std::max(kinetic_, motion_.kineticEnergy());
  error_ = kinetic > 0.0 ? motion_.error() / std::sqrt(2.0 * kinetic) : 0.0;
}

bool StepJudge::isTooLong() const {
  return scene_.timeline.timeError() > 0.0 && error_ > scene_.timeline.timeError();
}

bool StepJudge::gains() const {
  return givenByStep_ > 0.0 && given_ + givenByStep_ > mostGiven * energy_;
}

void StepJudge::commit(double stored) {
  if (!motion_.isDamped())
    given_ += givenByStep_;
  committed_ = reached_;
  kinetic_ = std::max(kinetic_, motion_.kineticEnergy());
  energy_ = std::max(energy_, motion_.kineticEnergy() + stored);
}

// The error is of second order.
bool StepJudge::isCalm() const {
  constexpr double doubled = 4.0, margin = 1.5;
  return doubled * margin * error_ < scene_.timeline.timeError();
}

void StepJudge::exchange(qp::StateArchive<MultiVector>& archive) {
  constexpr std::size_t width = 5;
  std::vector<double> all;
  if (!archive.isReading()) {
    for (const auto& [key, point] : committed_)
      all.insert(all.end(), {static_cast<double>(std::get<0>(key)), static_cast<double>(std::get<1>(key)),
                             static_cast<double>(std::get<2>(key)), point.force, point.gap});
    all = gatherAll(comm_, all);
  }
  archive.numbers("contacts of the last step", all);
  archive.number("energy given by contacts", given_);
  archive.number("largest energy", energy_);
  archive.number("largest kinetic energy", kinetic_);
  if (!archive.isReading())
    return;
  committed_.clear(); // those of other ranks do no harm
  for (std::size_t k = 0; k + width <= all.size(); k += width)
    committed_[{static_cast<std::size_t>(all[k]), static_cast<long long>(all[k + 1]),
                static_cast<int>(all[k + 2])}] = {all[k + 3], all[k + 4]};
}

} // namespace Harmos::run
