// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MovingBounds.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <map>

namespace Harmos::run {
namespace {

// Effects whose magnitude is that of rows, not of loads or of prescribed values of bodies.
bool movesRows(const scene::Effect& effect) {
  return effect.hasMagnitude() && effect.bodies().empty() && effect.exertsForce();
}

} // namespace

MovingBounds::MovingBounds(const scene::Scene& scene, const scene::ContactSetup& contact)
    : scene_(scene),
      contact_(contact),
      any_(std::any_of(scene.effects.begin(), scene.effects.end(),
                       [](const auto& effect) { return movesRows(*effect); })),
      moving_(contact.rows.size(), 0.0) {
  std::map<long long, double> interference; // by the number of the row
  for (const contact::ContactPoint& point : contact.points)
    interference[point.number] = point.interference;
  for (std::size_t k = 0; k < moving_.size(); ++k) {
    const ConstraintRow& row = contact.rows[k];
    if (row.kind == ConstraintRow::Kind::Inequality)
      moving_[k] = -interference.at(row.number);
    else if (row.kind == ConstraintRow::Kind::Equality && movesRows(*contact.origins[k].effect))
      moving_[k] = row.bound;
  }
}

void MovingBounds::move(std::vector<ConstraintRow>& rows, double time) const {
  if (!any_ || rows.empty())
    return;
  HARMOS_REQUIRE(rows.size() == moving_.size(), "rows are others than when the run began");
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (moving_[k] != 0.0)
      rows[k].bound += (scene_.timeline.factor(*contact_.origins[k].effect, time) - 1.0) * moving_[k];
}

double MovingBounds::product(const std::vector<double>& multipliers) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < moving_.size(); ++k)
    sum -= multipliers[k] * moving_[k];
  return sum;
}

void MovingBounds::addProducts(const Teuchos::Comm<int>& comm, const std::vector<double>& multipliers,
                               const std::vector<scene::TimedLoads::Case>& cases,
                               scene::TimedLoads::Products& products) const {
  if (!any_)
    return;
  std::vector<double> sums(cases.size(), 0.0);
  for (std::size_t k = 0; k < moving_.size(); ++k) {
    if (moving_[k] == 0.0)
      continue;
    const std::string history = scene_.timeline.historyOf(*contact_.origins[k].effect);
    const auto found = std::find_if(cases.begin(), cases.end(), [&](const scene::TimedLoads::Case& c) {
      return c.history == history && !c.isStrain;
    });
    HARMOS_REQUIRE(found != cases.end(), "an effect follows a history that loads do not know");
    sums[static_cast<std::size_t>(found - cases.begin())] -= multipliers[k] * moving_[k];
  }
  globalSum(comm, sums);
  for (std::size_t c = 0; c < sums.size(); ++c)
    products.motion[c] += sums[c];
}

} // namespace Harmos::run
