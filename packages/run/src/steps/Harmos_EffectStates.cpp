// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_EffectStates.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_KeyedNumbers.hpp"

#include <algorithm>
#include <map>
#include <string>

namespace Harmos::run {

using Bond = scene::ContactSetup::Bond;
using Law = scene::InterfaceLaw;

EffectStates::EffectStates(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                           const scene::ContactSetup& contact)
    : comm_(comm), contact_(contact) {
  placeRows();
  std::map<const scene::Effect*, std::vector<std::size_t>> points, limited;
  const auto addSlips = [&](const scene::Effect* effect, const contact::SlipPoint& slip) {
    for (std::size_t t = 0; t < slip.tangents.size(); ++t)
      limited[effect].push_back(slip.firstPlace + t);
  };
  for (std::size_t k = 0; k < contact.points.size(); ++k)
    points[contact.effects[k]].push_back(k);
  for (std::size_t s = 0; s < contact.slips.size(); ++s)
    if (contact.slips[s].hasFriction)
      addSlips(contact.frictions[s], contact.slips[s]);
  for (const Bond& bond : contact.bonds) {
    points[bond.effect].push_back(bond.point);
    if (bond.slip != Bond::none)
      addSlips(bond.effect, contact.slips[bond.slip]);
  }
  for (const auto& effect : scene.effects)
    if (effect->interfaceLaw() != nullptr)
      add(*effect, points[effect.get()], limited[effect.get()]);
  makeSoftening();
}

void EffectStates::placeRows() {
  for (std::size_t k = 0; k < contact_.points.size(); ++k)
    placeOfPoint_.emplace(contact_.points[k].number, k);
  pointOfSlip_.resize(contact_.slipRows());
  for (const contact::SlipPoint& slip : contact_.slips)
    for (std::size_t t = 0; t < slip.tangents.size(); ++t) {
      placeOfSlip_.emplace(slip.firstRow + static_cast<long long>(t), slip.firstPlace + t);
      pointOfSlip_[slip.firstPlace + t] = slip.point;
    }
}

void EffectStates::add(const scene::Effect& effect, const std::vector<std::size_t>& points,
                       const std::vector<std::size_t>& limited) {
  if (globalMax(comm_, static_cast<long long>(points.size() + limited.size())) == 0)
    return;
  State state{&effect, effect.interfaceLaw(), points, limited, {}, {}, {}, {}};
  std::map<std::size_t, std::size_t> places;
  const auto addRow = [&](std::size_t point, bool isLimited) {
    const auto [place, isNew] = places.emplace(point, places.size());
    if (isNew)
      state.numbers.push_back(contact_.points[point].number);
    state.rows.push_back({&contact_.points[point], place->second, isLimited});
  };
  for (const std::size_t point : points)
    addRow(point, false);
  for (const std::size_t row : limited)
    addRow(pointOfSlip_[row], true);
  state.committed = state.trial = scene::PointStates(places.size(), state.law->stateSize());
  states_.push_back(std::move(state));
}

std::size_t EffectStates::size() const {
  std::size_t sum = 0;
  for (const State& state : states_)
    sum += state.committed.points() * state.law->stateSize();
  return sum;
}

// Of springs as they were made.
void EffectStates::makeSoftening() {
  const Rows rows = made();
  std::vector<long long> keys;
  std::vector<double> stiffnesses;
  bool softens = false;
  for (const State& state : states_) {
    if (!state.law->softens())
      continue;
    softens = true;
    for (const std::size_t point : state.points) {
      keys.push_back(contact_.points[point].number);
      stiffnesses.push_back(1.0 / *rows.softness[point]);
    }
    for (std::size_t k = 0; k < state.limited.size(); ++k)
      stiffnesses.push_back(1.0 / *rows.slipSoftness[state.limited[k]]);
    std::vector<long long> numbers(pointOfSlip_.size());
    for (const auto& [number, place] : placeOfSlip_)
      numbers[place] = number;
    for (const std::size_t row : state.limited)
      keys.push_back(contact_.pointCount + numbers[row]);
  }
  if (softens) // on every rank alike
    softening_.emplace(comm_, std::move(keys), std::move(stiffnesses));
}

void EffectStates::begin(std::optional<double> advance) {
  for (State& state : states_) {
    state.trial = state.committed;
    state.law->beginStep(state.trial);
  }
  if (softening_)
    softening_->begin(softeningParts(), advance);
}

bool EffectStates::update(const std::vector<ContactState>& answer, const std::vector<RowSlip>& slips,
                          double tolerance, const feti::WarmStart& multipliers, double startedAt) {
  if (!any())
    return false;
  const Rows rows = applied();
  const auto largest = [this](double value) { return globalMax(comm_, value); };
  bool again = false;
  std::vector<Softening::Part> softening;
  for (State& state : states_) {
    std::vector<Law::RowAnswer> answers = answersOf(state, rows, answer, slips);
    if (state.law->softens())
      softening.push_back({state.law, &state.rows, std::move(answers), &state.trial});
    else
      again = state.law->updateState(answers, tolerance, largest, state.trial) || again; // each is asked
  }
  again = largest(again ? 1.0 : 0.0) > 0.0;
  return (softening_ && softening_->update(softening, multipliers, tolerance, startedAt)) || again;
}

std::vector<Law::RowAnswer> EffectStates::answersOf(const State& state, const Rows& rows,
                                                    const std::vector<ContactState>& answer,
                                                    const std::vector<RowSlip>& slips) const {
  const std::vector<double> own = shiftsBy(state);
  std::vector<Law::RowAnswer> answers;
  for (std::size_t k = 0; k < state.rows.size(); ++k) {
    Law::RowAnswer& row = answers.emplace_back();
    static_cast<Law::Row&>(row) = state.rows[k];
    if (!row.isLimited) {
      const std::size_t place = state.points[k];
      row.gap = answer[place].gap;
      row.force = answer[place].force;
      row.softness = rows.softness[place];
      row.unstretched = rows.unstretched[place];
      continue;
    }
    // Against the bound that this law thinks of, where several act on the row.
    const std::size_t place = state.limited[k - state.points.size()];
    const RowSlip slip = slips.empty() ? RowSlip() : slips[place];
    row.softness = rows.slipSoftness[place];
    row.unstretched = row.softness ? rows.slip[place] : 0.0;
    row.force = slip.force;
    row.gap = -(row.softness ? *row.softness * row.force : slip.slip) + (own[k] - rows.slip[place]);
  }
  return answers;
}

// What breaks at once, and what slips, is to be sure.
double EffectStates::tolerance(double asked) const {
  const bool allSoften =
      std::all_of(states_.begin(), states_.end(), [](const State& state) { return state.law->softens(); });
  return softening_ && allSoften ? softening_->tolerance(asked) : asked;
}

void EffectStates::commit() {
  for (State& state : states_)
    state.committed = state.trial;
  if (softening_)
    softening_->commit();
}

std::vector<Softening::Part> EffectStates::softeningParts() {
  std::vector<Softening::Part> parts;
  for (State& state : states_)
    if (state.law->softens())
      parts.push_back({state.law, &state.rows, {}, &state.trial});
  return parts;
}

std::vector<double> EffectStates::shiftsBy(const State& state) const {
  std::vector<double> own(state.rows.size(), 0.0);
  state.law->addToBounds(state.trial, state.rows, own);
  return own;
}

// With springs as they were made, and nothing else.
EffectStates::Rows EffectStates::made() const {
  Rows rows;
  rows.shift.assign(contact_.points.size(), 0.0);
  rows.slip.assign(pointOfSlip_.size(), 0.0);
  rows.unstretched.assign(contact_.points.size(), 0.0);
  rows.softness.resize(rows.shift.size());
  rows.slipSoftness.resize(rows.slip.size());
  for (const Bond& bond : contact_.bonds) {
    rows.softness[bond.point] = bond.softness;
    if (bond.slip != Bond::none)
      for (std::size_t t = 0; t < contact_.slips[bond.slip].tangents.size(); ++t)
        rows.slipSoftness[contact_.slips[bond.slip].firstPlace + t] = bond.tangentialSoftness;
  }
  return rows;
}

EffectStates::Rows EffectStates::applied() const {
  Rows rows = made();
  std::vector<double> slipUnstretched(rows.slip.size(), 0.0);
  std::vector<std::optional<double>> brokenAt(rows.slip.size());
  for (const State& state : states_) {
    const std::vector<double> own = shiftsBy(state);
    std::vector<Law::Spring> springs;
    const auto place = [&](std::size_t k, auto& ofPoints, auto& ofSlips) -> auto& {
      return k < state.points.size() ? ofPoints[state.points[k]]
                                     : ofSlips[state.limited[k - state.points.size()]];
    };
    for (std::size_t k = 0; k < own.size(); ++k) {
      place(k, rows.shift, rows.slip) += own[k];
      springs.push_back({place(k, rows.softness, rows.slipSoftness), 0.0, std::nullopt});
    }
    state.law->soften(state.trial, state.rows, springs);
    for (std::size_t k = 0; k < own.size(); ++k) {
      place(k, rows.softness, rows.slipSoftness) = springs[k].softness;
      place(k, rows.unstretched, slipUnstretched) += springs[k].unstretched;
      if (springs[k].brokenAt)
        brokenAt[state.limited[k - state.points.size()]] = springs[k].brokenAt;
    }
  }
  for (std::size_t k = 0; k < rows.slip.size(); ++k)
    if (rows.slipSoftness[k]) // of friction that takes over one day
      rows.slip[k] = slipUnstretched[k];
    else if (brokenAt[k])
      rows.slip[k] = *brokenAt[k];
  return rows;
}

std::vector<ConstraintRow> EffectStates::rows() const {
  std::vector<ConstraintRow> result = contact_.rows;
  if (!any())
    return result;
  const Rows rows = applied();
  for (ConstraintRow& row : result) {
    if (row.kind == ConstraintRow::Kind::Inequality) {
      const std::size_t place = placeOfPoint_.at(row.number);
      row.bound += rows.shift[place] + rows.unstretched[place];
      row.softness = rows.softness[place];
    } else if (const auto slip = placeOfSlip_.find(row.number);
               row.kind == ConstraintRow::Kind::Limited && slip != placeOfSlip_.end()) { // no lock
      row.bound += rows.slip[slip->second];
      row.softness = rows.slipSoftness[slip->second];
    }
  }
  return result;
}

std::vector<char> EffectStates::broken() const {
  std::vector<char> result(contact_.points.size(), 0);
  for (const State& state : states_)
    for (std::size_t k = 0; k < state.points.size() && state.law->breaks(); ++k)
      result[state.points[k]] = state.law->damage(state.committed, state.rows[k].place) >= 1.0 ? 1 : 0;
  return result;
}

double EffectStates::dissipated() const {
  double sum = 0.0;
  for (const State& state : states_)
    sum += state.law->broken(state.trial, state.rows).dissipated;
  return globalSum(comm_, sum);
}

double EffectStates::haste() const {
  double most = 0.0;
  for (const State& state : states_) {
    const Law::Broken broken = state.law->broken(state.trial, state.rows);
    std::vector<double> sums = {broken.share, broken.area};
    globalSum(comm_, sums);
    if (sums[1] > 0.0)
      most = std::max(most, sums[0] / sums[1] / state.law->mostBroken());
  }
  return most;
}

void EffectStates::tell(const std::vector<RowSlip>& slips, std::vector<ContactState>& answer) const {
  if (contact_.bondCount == 0 || !any())
    return;
  const Rows rows = applied();
  std::vector<double> damage(contact_.points.size(), 0.0);
  for (const State& state : states_)
    for (std::size_t k = 0; k < state.points.size() && state.law->breaks(); ++k)
      damage[state.points[k]] = state.law->damage(state.trial, state.rows[k].place);
  for (const scene::ContactSetup::Bond& bond : contact_.bonds) {
    ContactState& point = answer[bond.point];
    const contact::ContactPoint& place = contact_.points[bond.point];
    const std::optional<double>& softness = rows.softness[bond.point];
    const bool holds = softness.has_value();
    point.isBound = true;
    point.damage = damage[bond.point];
    if (holds) {
      point.pressure = point.force / place.area;
      point.gap = point.closed ? point.gap : -*softness * point.force;
      point.friction = Friction::None;
      point.slip = {};
    }
    if (holds && bond.slip != scene::ContactSetup::Bond::none) {
      const contact::SlipPoint& slip = contact_.slips[bond.slip];
      point.traction = {};
      for (std::size_t t = 0; t < slip.tangents.size(); ++t) {
        const double force = slips[slip.firstPlace + t].force;
        const double stretch = *rows.slipSoftness[slip.firstPlace + t] * force;
        for (std::size_t d = 0; d < 3; ++d) {
          point.slip[d] += stretch * slip.tangents[t][d];
          point.traction[d] -= force / place.area * slip.tangents[t][d];
        }
      }
    }
    for (std::size_t d = 0; d < 3; ++d) {
      point.jump[d] = point.slip[d] - point.gap * place.normal[d];
      point.wholeTraction[d] = point.traction[d] - point.pressure * place.normal[d];
    }
  }
}

void EffectStates::exchangeAnswers(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem) {
  if (softening_)
    softening_->exchange(archive, problem);
}

void EffectStates::exchange(qp::StateArchive<MultiVector>& archive) {
  for (std::size_t k = 0; k < states_.size(); ++k) {
    State& state = states_[k];
    const KeyedNumbers points(comm_, state.numbers);
    const std::string number = std::to_string(k), label = state.effect->label();
    points.exchange(archive, "committed state " + number, label, state.committed.numbers());
    points.exchange(archive, "trial state " + number, label, state.trial.numbers());
  }
}

} // namespace Harmos::run
