// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SlipStates.hpp"

#include "Harmos_Rendezvous.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::run {

std::vector<RowSlip> rowSlips(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
                              const feti::FrictionState& state) {
  if (contact.limitedRows == 0)
    return {};
  std::vector<std::pair<long long, RowSlip>> known;
  for (std::size_t k = 0; k < state.row.size(); ++k)
    known.emplace_back(state.row[k], RowSlip{state.slip[k], state.force[k]});
  std::vector<long long> asked;
  for (const contact::SlipPoint& slip : contact.slips)
    for (std::size_t t = 0; t < slip.tangents.size(); ++t)
      asked.push_back(slip.firstRow + static_cast<long long>(t));
  std::vector<RowSlip> result;
  for (const std::optional<RowSlip>& answer : lookUp(comm, known, asked))
    result.push_back(answer.value_or(RowSlip()));
  return result;
}

std::vector<double> slipsBefore(const std::vector<ConstraintRow>& rows) {
  std::vector<double> result;
  for (const ConstraintRow& row : rows)
    if (row.kind == ConstraintRow::Kind::Limited)
      result.push_back(row.bound);
  return result;
}

void addSlips(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
              const std::vector<RowSlip>& slips, const std::vector<double>& before,
              std::vector<ContactState>& states) {
  if (contact.limitedRows == 0)
    return;
  std::vector<fem::Point> forces(states.size());
  constexpr double rounding = 1e-9; // as where rows of an answer are told apart
  for (const contact::SlipPoint& point : contact.slips) {
    ContactState& state = states[point.point];
    double force2 = 0.0;
    state.slip = state.traction = {};
    for (std::size_t t = 0; t < point.tangents.size(); ++t) {
      const std::size_t row = point.firstPlace + t;
      const double slip = slips[row].slip + (before.empty() ? 0.0 : before[row]);
      force2 += slips[row].force * slips[row].force;
      for (std::size_t d = 0; d < 3; ++d) {
        state.slip[d] += slip * point.tangents[t][d];
        state.traction[d] -= slips[row].force / contact.points[point.point].area * point.tangents[t][d];
        forces[point.point][d] -= slips[row].force * point.tangents[t][d];
      }
    }
    const double limit = point.follows ? point.coefficient * std::max(0.0, state.force) : point.limit;
    if (!point.hasFriction)
      continue;
    state.friction = point.follows && !state.closed                 ? Friction::None
                     : std::sqrt(force2) < (1.0 - rounding) * limit ? Friction::Sticks
                                                                    : Friction::Slips;
  }
  const std::vector<fem::Point> found = tractions(comm, contact.points, forces);
  for (const contact::SlipPoint& point : contact.slips) {
    states[point.point].tangentialForce = forces[point.point];
    if (!contact.points[point.point].pressure.empty())
      states[point.point].traction = found[point.point];
  }
}

} // namespace Harmos::run
