// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SlipStates.hpp"

#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::run {
namespace {

template<class T>
struct Item {
  long long row;
  T value;
};

template<class T>
std::vector<T> byRow(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
                     const std::vector<Item<T>>& mine) {
  if (contact.slips.empty())
    return {};
  std::vector<T> result(contact.slipRows());
  for (const Item<T>& item : gatherAll(comm, mine))
    result[static_cast<std::size_t>(item.row)] = item.value;
  return result;
}

} // namespace

std::vector<RowSlip> rowSlips(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
                              const feti::FrictionState& state) {
  std::vector<Item<RowSlip>> mine;
  for (std::size_t k = 0; k < state.row.size(); ++k)
    mine.push_back({state.row[k], {state.slip[k], state.force[k]}});
  return byRow(comm, contact, mine);
}

std::vector<double> slipsBefore(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
                                const std::vector<ConstraintRow>& rows) {
  std::vector<Item<double>> mine;
  for (const ConstraintRow& row : rows)
    if (row.kind == ConstraintRow::Kind::Limited)
      mine.push_back({row.number, row.bound});
  return byRow(comm, contact, mine);
}

void addSlips(const scene::ContactSetup& contact, const std::vector<RowSlip>& slips,
              const std::vector<double>& before, std::vector<ContactState>& states) {
  if (contact.slips.empty())
    return;
  constexpr double rounding = 1e-9; // as where rows of an answer are told apart
  for (const contact::SlipPoint& point : contact.slips) {
    ContactState& state = states[point.point];
    double force2 = 0.0;
    state.slip = state.traction = {};
    for (std::size_t t = 0; t < point.tangents.size(); ++t) {
      const std::size_t row = point.firstRow + t;
      const double slip = slips[row].slip + (before.empty() ? 0.0 : before[row]);
      force2 += slips[row].force * slips[row].force;
      for (std::size_t d = 0; d < 3; ++d) {
        state.slip[d] += slip * point.tangents[t][d];
        state.traction[d] -= slips[row].force / contact.points[point.point].area * point.tangents[t][d];
      }
    }
    const double limit = point.follows ? point.coefficient * std::max(0.0, state.force) : point.limit;
    if (!point.hasFriction)
      continue;
    state.friction = point.follows && !state.closed                 ? Friction::None
                     : std::sqrt(force2) < (1.0 - rounding) * limit ? Friction::Sticks
                                                                    : Friction::Slips;
  }
}

} // namespace Harmos::run
