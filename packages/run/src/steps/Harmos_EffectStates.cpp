// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_EffectStates.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <map>
#include <string>

namespace Harmos::run {

EffectStates::EffectStates(const scene::Scene& scene, const scene::ContactSetup& contact)
    : contact_(contact) {
  std::map<const scene::Effect*, std::vector<std::size_t>> points, limited;
  for (std::size_t k = 0; k < contact.effects.size(); ++k)
    points[contact.effects[k]].push_back(k);
  for (std::size_t k = 0; k < contact.frictions.size(); ++k)
    for (std::size_t t = 0; t < contact.slips[k].tangents.size(); ++t) {
      if (contact.slips[k].hasFriction)
        limited[contact.frictions[k]].push_back(contact.slips[k].firstRow + t);
      pointOfSlip_.push_back(contact.slips[k].point);
    }
  for (const scene::ContactSetup::Bond& bond : contact.bonds) {
    points[bond.effect].push_back(bond.point);
    if (bond.slip != scene::ContactSetup::Bond::none)
      for (std::size_t t = 0; t < contact.slips[bond.slip].tangents.size(); ++t)
        limited[bond.effect].push_back(contact.slips[bond.slip].firstRow + t);
  }
  for (const auto& effect : scene.effects)
    add(*effect, points[effect.get()], limited[effect.get()]);
  if (std::vector<double> stiffnesses = stiffnessesOfSoftening(); !stiffnesses.empty())
    softening_.emplace(std::move(stiffnesses));
}

void EffectStates::add(const scene::Effect& effect, std::vector<std::size_t> points,
                       std::vector<std::size_t> limited) {
  const std::size_t size = effect.stateSize(points.size(), limited.size());
  if (size == 0)
    return;
  State state = {&effect,
                 std::move(points),
                 std::move(limited),
                 {},
                 std::vector<double>(size, 0.0),
                 std::vector<double>(size, 0.0)};
  std::map<std::size_t, std::size_t> places;
  const auto addRow = [&](std::size_t point, bool isLimited) {
    const std::size_t place = places.emplace(point, places.size()).first->second;
    state.rows.push_back({&contact_.points[point], place, isLimited});
  };
  for (std::size_t point : state.points)
    addRow(point, false);
  for (std::size_t row : state.limited)
    addRow(pointOfSlip_[row], true);
  states_.push_back(std::move(state));
}

void EffectStates::begin(std::optional<double> advance) {
  for (State& state : states_) {
    state.trial = state.committed;
    state.effect->beginStep(state.trial);
  }
  if (softening_)
    softening_->begin(softeningParts(), advance);
}

bool EffectStates::update(const std::vector<ContactState>& answer, const std::vector<RowSlip>& slips,
                          double tolerance, const feti::WarmStart& multipliers, double startedAt) {
  const Rows rows = applied();
  bool again = false;
  std::vector<Softening::Part> softening;
  for (State& state : states_) {
    std::vector<scene::Effect::RowAnswer> answers = answersOf(state, rows, answer, slips);
    if (state.effect->softens())
      softening.push_back({state.effect, &state.rows, std::move(answers), &state.trial});
    else
      again = state.effect->updateState(answers, tolerance, state.trial) || again; // each is asked
  }
  return (softening_ && softening_->update(softening, multipliers, tolerance, startedAt)) || again;
}

std::vector<scene::Effect::RowAnswer> EffectStates::answersOf(const State& state, const Rows& rows,
                                                              const std::vector<ContactState>& answer,
                                                              const std::vector<RowSlip>& slips) const {
  const std::vector<double> own = shiftsBy(state);
  std::vector<scene::Effect::RowAnswer> answers;
  for (std::size_t k = 0; k < state.rows.size(); ++k) {
    scene::Effect::RowAnswer& row = answers.emplace_back();
    static_cast<scene::Effect::Row&>(row) = state.rows[k];
    if (!row.isLimited) {
      const std::size_t number = state.points[k];
      row.gap = answer[number].gap;
      row.force = answer[number].force;
      row.softness = rows.softness[number];
      row.unstretched = rows.unstretched[number];
      continue;
    }
    // Against the bound that this effect thinks of, where several act on the row.
    const std::size_t number = state.limited[k - state.points.size()];
    row.softness = rows.slipSoftness[number];
    row.unstretched = row.softness ? rows.slip[number] : 0.0;
    row.force = slips[number].force;
    row.gap = -(row.softness ? *row.softness * row.force : slips[number].slip) + (own[k] - rows.slip[number]);
  }
  return answers;
}

// Of springs as they were made.
std::vector<double> EffectStates::stiffnessesOfSoftening() const {
  std::map<std::size_t, double> ofPoints, ofSlips;
  for (const scene::ContactSetup::Bond& bond : contact_.bonds) {
    ofPoints[bond.point] = 1.0 / bond.softness;
    if (bond.slip != scene::ContactSetup::Bond::none)
      for (std::size_t t = 0; t < contact_.slips[bond.slip].tangents.size(); ++t)
        ofSlips[contact_.slips[bond.slip].firstRow + t] = 1.0 / bond.tangentialSoftness;
  }
  std::vector<double> stiffnesses;
  for (const State& state : states_) {
    if (!state.effect->softens())
      continue;
    for (std::size_t point : state.points)
      stiffnesses.push_back(ofPoints.at(point));
    for (std::size_t row : state.limited)
      stiffnesses.push_back(ofSlips.at(row));
  }
  return stiffnesses;
}

// What breaks at once, and what slips, is to be sure.
double EffectStates::tolerance(double asked) const {
  const bool allSoften =
      std::all_of(states_.begin(), states_.end(), [](const State& state) { return state.effect->softens(); });
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
    if (state.effect->softens())
      parts.push_back({state.effect, &state.rows, {}, &state.trial});
  return parts;
}

std::vector<double> EffectStates::shiftsBy(const State& state) const {
  std::vector<double> own(state.rows.size(), 0.0);
  state.effect->addToBounds(state.trial, own);
  return own;
}

EffectStates::Rows EffectStates::applied() const {
  Rows rows;
  rows.shift.assign(contact_.points.size(), 0.0);
  rows.slip.assign(pointOfSlip_.size(), 0.0);
  rows.unstretched.assign(contact_.points.size(), 0.0);
  rows.softness.resize(rows.shift.size());
  rows.slipSoftness.resize(rows.slip.size());
  for (const scene::ContactSetup::Bond& bond : contact_.bonds) {
    rows.softness[bond.point] = bond.softness;
    if (bond.slip != scene::ContactSetup::Bond::none)
      for (std::size_t t = 0; t < contact_.slips[bond.slip].tangents.size(); ++t)
        rows.slipSoftness[contact_.slips[bond.slip].firstRow + t] = bond.tangentialSoftness;
  }
  std::vector<double> slipUnstretched(rows.slip.size(), 0.0);
  for (const State& state : states_) {
    const std::vector<double> own = shiftsBy(state);
    std::vector<scene::Effect::Spring> springs;
    const auto place = [&](std::size_t k, auto& ofPoints, auto& ofSlips) -> auto& {
      return k < state.points.size() ? ofPoints[state.points[k]]
                                     : ofSlips[state.limited[k - state.points.size()]];
    };
    for (std::size_t k = 0; k < own.size(); ++k) {
      place(k, rows.shift, rows.slip) += own[k];
      springs.push_back({place(k, rows.softness, rows.slipSoftness), 0.0});
    }
    state.effect->soften(state.trial, state.rows, springs);
    for (std::size_t k = 0; k < own.size(); ++k) {
      place(k, rows.softness, rows.slipSoftness) = springs[k].softness;
      place(k, rows.unstretched, slipUnstretched) += springs[k].unstretched;
    }
  }
  for (std::size_t k = 0; k < rows.slip.size(); ++k)
    if (rows.slipSoftness[k]) // of friction that takes over one day
      rows.slip[k] = slipUnstretched[k];
  return rows;
}

std::vector<ConstraintRow> EffectStates::rows() const {
  std::vector<ConstraintRow> result = contact_.rows;
  const Rows rows = applied();
  for (ConstraintRow& row : result) {
    const auto number = static_cast<std::size_t>(row.number);
    if (row.kind == ConstraintRow::Kind::Inequality) {
      row.bound += rows.shift[number] + rows.unstretched[number];
      row.softness = rows.softness[number];
    } else if (row.kind == ConstraintRow::Kind::Limited) {
      row.bound += rows.slip[number];
      row.softness = rows.slipSoftness[number];
    }
  }
  return result;
}

double EffectStates::dissipated() const {
  double sum = 0.0;
  for (const State& state : states_)
    sum += state.effect->dissipated(state.trial);
  return sum;
}

double EffectStates::haste() const {
  double most = 0.0;
  for (const State& state : states_)
    most = std::max(most, state.effect->haste(state.trial));
  return most;
}

void EffectStates::tell(const std::vector<RowSlip>& slips, std::vector<ContactState>& answer) const {
  if (contact_.bonds.empty())
    return;
  const Rows rows = applied();
  for (const State& state : states_) {
    const std::vector<double> damage = state.effect->damage(state.trial);
    for (std::size_t k = 0; k < damage.size(); ++k)
      answer[state.points[k]].damage = damage[k];
  }
  for (const scene::ContactSetup::Bond& bond : contact_.bonds) {
    ContactState& point = answer[bond.point];
    const contact::ContactPoint& place = contact_.points[bond.point];
    const std::optional<double>& softness = rows.softness[bond.point];
    const bool holds = softness.has_value();
    point.isBound = true;
    if (holds) {
      point.gap = point.closed ? point.gap : -*softness * point.force;
      point.friction = Friction::None;
      point.slip = {};
    }
    if (holds && bond.slip != scene::ContactSetup::Bond::none) {
      const contact::SlipPoint& slip = contact_.slips[bond.slip];
      for (std::size_t t = 0; t < slip.tangents.size(); ++t) {
        const std::size_t row = slip.firstRow + t;
        for (std::size_t d = 0; d < 3; ++d)
          point.slip[d] += *rows.slipSoftness[row] * slips[row].force * slip.tangents[t][d];
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
    const std::size_t size = states_[k].committed.size();
    archive.numbers("committed state " + std::to_string(k), states_[k].committed);
    archive.numbers("trial state " + std::to_string(k), states_[k].trial);
    if (states_[k].committed.size() != size || states_[k].trial.size() != size)
      throw InputError("the checkpoint holds " + std::to_string(states_[k].committed.size()) +
                       " numbers of " + states_[k].effect->label() + ", but there are " +
                       std::to_string(size) +
                       "; restart with the deck and the meshes of the run that wrote it");
  }
}

} // namespace Harmos::run
