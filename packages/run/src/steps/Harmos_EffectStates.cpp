// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_EffectStates.hpp"

#include "Harmos_Errors.hpp"

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
      limited[contact.frictions[k]].push_back(contact.slips[k].firstRow + t);
      pointOfSlip_.push_back(contact.slips[k].point);
    }
  for (const auto& effect : scene.effects) {
    const std::vector<std::size_t>&own = points[effect.get()], &slips = limited[effect.get()];
    if (const std::size_t size = effect->stateSize(own.size() + slips.size()); size > 0)
      states_.push_back(
          {effect.get(), own, slips, std::vector<double>(size, 0.0), std::vector<double>(size, 0.0)});
  }
}

void EffectStates::begin() {
  for (State& state : states_) {
    state.trial = state.committed;
    state.effect->beginStep(state.trial);
  }
}

bool EffectStates::update(const std::vector<ContactState>& answer, const std::vector<RowSlip>& slips) {
  bool again = false;
  for (State& state : states_) {
    std::vector<scene::Effect::RowAnswer> rows;
    for (std::size_t k : state.points)
      rows.push_back({&contact_.points[k], answer[k].gap, answer[k].force});
    for (std::size_t k : state.limited)
      rows.push_back({&contact_.points[pointOfSlip_[k]], -slips[k].slip, slips[k].force});
    again = state.effect->updateState(rows, state.trial) || again; // each is asked
  }
  return again;
}

void EffectStates::commit() {
  for (State& state : states_)
    state.committed = state.trial;
}

std::vector<ConstraintRow> EffectStates::rows() const {
  std::vector<ConstraintRow> rows = contact_.rows;
  std::vector<double> shift(contact_.points.size(), 0.0), slip(pointOfSlip_.size(), 0.0);
  for (const State& state : states_) {
    const std::size_t points = state.points.size();
    std::vector<double> own(points + state.limited.size(), 0.0);
    state.effect->addToBounds(state.trial, own);
    for (std::size_t k = 0; k < own.size(); ++k)
      (k < points ? shift[state.points[k]] : slip[state.limited[k - points]]) = own[k];
  }
  for (ConstraintRow& row : rows)
    if (row.kind == ConstraintRow::Kind::Inequality)
      row.bound += shift[static_cast<std::size_t>(row.number)];
    else if (row.kind == ConstraintRow::Kind::Limited)
      row.bound += slip[static_cast<std::size_t>(row.number)];
  return rows;
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
