// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_EffectStates.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>

namespace Harmos::run {

EffectStates::EffectStates(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                           const scene::ContactSetup& contact)
    : comm_(comm), scene_(scene), contact_(contact) {
  if (!anyHasState())
    return;
  gather();
  std::map<const scene::Effect*, std::vector<std::size_t>> points, limited;
  for (std::size_t k = 0; k < whole_.effects.size(); ++k)
    points[whole_.effects[k]].push_back(k);
  for (std::size_t row = 0; row < whole_.slipEffects.size(); ++row)
    if (whole_.slipEffects[row] != nullptr)
      limited[whole_.slipEffects[row]].push_back(row);
  for (const Whole::Bond& bond : whole_.bonds) {
    points[bond.effect].push_back(bond.point);
    for (std::size_t t = 0; t < bond.slips; ++t)
      limited[bond.effect].push_back(bond.firstSlip + t);
  }
  for (const auto& effect : scene.effects)
    add(*effect, points[effect.get()], limited[effect.get()]);
  if (std::vector<double> stiffnesses = stiffnessesOfSoftening(); !stiffnesses.empty())
    softening_.emplace(std::move(stiffnesses));
}

// Of all ranks' points and rows.
bool EffectStates::anyHasState() const {
  std::map<const scene::Effect*, std::size_t> places;
  for (std::size_t k = 0; k < scene_.effects.size(); ++k)
    places[scene_.effects[k].get()] = k;
  std::vector<double> counts(2 * places.size(), 0.0); // points and limited rows of each effect
  for (const scene::Effect* effect : contact_.effects)
    counts[2 * places.at(effect)] += 1.0;
  for (std::size_t s = 0; s < contact_.slips.size(); ++s)
    if (contact_.slips[s].hasFriction)
      counts[2 * places.at(contact_.frictions[s]) + 1] +=
          static_cast<double>(contact_.slips[s].tangents.size());
  for (const scene::ContactSetup::Bond& bond : contact_.bonds) {
    counts[2 * places.at(bond.effect)] += 1.0;
    if (bond.slip != scene::ContactSetup::Bond::none)
      counts[2 * places.at(bond.effect) + 1] +=
          static_cast<double>(contact_.slips[bond.slip].tangents.size());
  }
  globalSum(comm_, counts);
  for (std::size_t k = 0; k < scene_.effects.size(); ++k)
    if (scene_.effects[k]->stateSize(static_cast<std::size_t>(counts[2 * k]),
                                     static_cast<std::size_t>(counts[2 * k + 1])) > 0)
      return true;
  return false;
}

// Effects are told by their places in the scene.
void EffectStates::gather() {
  std::map<const scene::Effect*, long long> places;
  for (const auto& effect : scene_.effects)
    places.emplace(effect.get(), static_cast<long long>(places.size()));
  const auto effectAt = [&](long long place) {
    return place < 0 ? nullptr : scene_.effects[static_cast<std::size_t>(place)].get();
  };
  struct PointEffect {
    long long number, effect;
  };
  struct Slip {
    long long row, point, effect;
  };
  struct Bond {
    long long effect, point, firstSlip, slips;
    double softness, tangentialSoftness;
  };
  std::vector<PointEffect> effects;
  std::vector<Slip> slips;
  std::vector<Bond> bonds;
  for (std::size_t k = 0; k < contact_.points.size(); ++k)
    effects.push_back({contact_.points[k].number, places.at(contact_.effects[k])});
  for (std::size_t s = 0; s < contact_.slips.size(); ++s) {
    const contact::SlipPoint& slip = contact_.slips[s];
    for (std::size_t t = 0; t < slip.tangents.size(); ++t)
      slips.push_back({slip.firstRow + static_cast<long long>(t), contact_.points[slip.point].number,
                       slip.hasFriction ? places.at(contact_.frictions[s]) : -1});
  }
  for (const scene::ContactSetup::Bond& bond : contact_.bonds) {
    Bond& item = bonds.emplace_back();
    item = {places.at(bond.effect), contact_.points[bond.point].number, 0, 0, bond.softness,
            bond.tangentialSoftness};
    if (bond.slip == scene::ContactSetup::Bond::none)
      continue;
    item.firstSlip = contact_.slips[bond.slip].firstRow;
    item.slips = static_cast<long long>(contact_.slips[bond.slip].tangents.size());
  }
  const auto at = [](long long k) { return static_cast<std::size_t>(k); };
  whole_.points = contact::gatherPoints(comm_, contact_.points);
  whole_.effects.resize(whole_.points.size());
  for (const PointEffect& item : gatherAll(comm_, effects))
    whole_.effects[at(item.number)] = effectAt(item.effect);
  whole_.pointOfSlip.resize(at(contact_.limitedRows));
  whole_.slipEffects.resize(at(contact_.limitedRows));
  for (const Slip& item : gatherAll(comm_, slips)) {
    whole_.pointOfSlip[at(item.row)] = at(item.point);
    whole_.slipEffects[at(item.row)] = effectAt(item.effect);
  }
  bonds = gatherAll(comm_, bonds);
  // Of several effects in their order.
  std::sort(bonds.begin(), bonds.end(), [](const Bond& a, const Bond& b) {
    return std::tie(a.effect, a.point) < std::tie(b.effect, b.point);
  });
  for (const Bond& item : bonds)
    whole_.bonds.push_back({effectAt(item.effect), at(item.point), item.softness, item.tangentialSoftness,
                            at(item.firstSlip), at(item.slips)});
}

std::vector<ContactState> EffectStates::gathered(const std::vector<ContactState>& answer) const {
  struct Item {
    long long number;
    ContactState state;
  };
  std::vector<Item> mine;
  for (std::size_t k = 0; k < answer.size(); ++k)
    mine.push_back({contact_.points[k].number, answer[k]});
  std::vector<ContactState> all(whole_.points.size());
  for (const Item& item : gatherAll(comm_, mine))
    all[static_cast<std::size_t>(item.number)] = item.state;
  return all;
}

std::vector<RowSlip> EffectStates::gathered(const std::vector<RowSlip>& slips) const {
  struct Item {
    long long row;
    RowSlip slip;
  };
  std::vector<Item> mine;
  for (const contact::SlipPoint& slip : contact_.slips)
    for (std::size_t t = 0; t < slip.tangents.size() && !slips.empty(); ++t)
      mine.push_back({slip.firstRow + static_cast<long long>(t), slips[slip.firstPlace + t]});
  std::vector<RowSlip> all(whole_.pointOfSlip.size());
  for (const Item& item : gatherAll(comm_, mine))
    all[static_cast<std::size_t>(item.row)] = item.slip;
  return all;
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
    state.rows.push_back({&whole_.points[point], place, isLimited});
  };
  for (std::size_t point : state.points)
    addRow(point, false);
  for (std::size_t row : state.limited)
    addRow(whole_.pointOfSlip[row], true);
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

bool EffectStates::update(const std::vector<ContactState>& ownAnswer, const std::vector<RowSlip>& ownSlips,
                          double tolerance, const feti::WarmStart& multipliers, double startedAt) {
  if (!any())
    return false;
  const std::vector<ContactState> answer = gathered(ownAnswer);
  const std::vector<RowSlip> slips = gathered(ownSlips);
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
  for (const Whole::Bond& bond : whole_.bonds) {
    ofPoints[bond.point] = 1.0 / bond.softness;
    for (std::size_t t = 0; t < bond.slips; ++t)
      ofSlips[bond.firstSlip + t] = 1.0 / bond.tangentialSoftness;
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
  rows.shift.assign(whole_.points.size(), 0.0);
  rows.slip.assign(whole_.pointOfSlip.size(), 0.0);
  rows.unstretched.assign(whole_.points.size(), 0.0);
  rows.softness.resize(rows.shift.size());
  rows.slipSoftness.resize(rows.slip.size());
  for (const Whole::Bond& bond : whole_.bonds) {
    rows.softness[bond.point] = bond.softness;
    for (std::size_t t = 0; t < bond.slips; ++t)
      rows.slipSoftness[bond.firstSlip + t] = bond.tangentialSoftness;
  }
  std::vector<double> slipUnstretched(rows.slip.size(), 0.0);
  std::vector<std::optional<double>> brokenAt(rows.slip.size());
  for (const State& state : states_) {
    const std::vector<double> own = shiftsBy(state);
    std::vector<scene::Effect::Spring> springs;
    const auto place = [&](std::size_t k, auto& ofPoints, auto& ofSlips) -> auto& {
      return k < state.points.size() ? ofPoints[state.points[k]]
                                     : ofSlips[state.limited[k - state.points.size()]];
    };
    for (std::size_t k = 0; k < own.size(); ++k) {
      place(k, rows.shift, rows.slip) += own[k];
      springs.push_back({place(k, rows.softness, rows.slipSoftness), 0.0, std::nullopt});
    }
    state.effect->soften(state.trial, state.rows, springs);
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
  if (contact_.bondCount == 0 || !any())
    return;
  const Rows rows = applied();
  std::vector<double> damage(whole_.points.size(), 0.0);
  for (const State& state : states_) {
    const std::vector<double> own = state.effect->damage(state.trial);
    for (std::size_t k = 0; k < own.size(); ++k)
      damage[state.points[k]] = own[k];
  }
  for (const scene::ContactSetup::Bond& bond : contact_.bonds) {
    ContactState& point = answer[bond.point];
    const contact::ContactPoint& place = contact_.points[bond.point];
    const auto number = static_cast<std::size_t>(place.number);
    const std::optional<double>& softness = rows.softness[number];
    const bool holds = softness.has_value();
    point.isBound = true;
    point.damage = damage[number];
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
        const double stretch = *rows.slipSoftness[static_cast<std::size_t>(slip.firstRow) + t] * force;
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
