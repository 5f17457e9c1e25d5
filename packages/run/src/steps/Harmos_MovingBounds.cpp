// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MovingBounds.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>

namespace Harmos::run {
MovingBounds::MovingBounds(const scene::Scene& scene, const scene::ContactSetup& contact)
    : scene_(scene),
      contact_(contact),
      any_(std::any_of(scene.effects.begin(), scene.effects.end(), [](const auto& effect) {
        return effect->hasMagnitude() && effect->bodies().empty() && effect->exertsForce();
      })) {}

void MovingBounds::move(std::vector<ConstraintRow>& rows, double time) const {
  if (!any_ || rows.empty())
    return;
  HARMOS_REQUIRE(rows.size() == contact_.moving.size(), "rows are those of the contact");
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (contact_.moving[k] != 0.0)
      rows[k].bound += (scene_.timeline.factor(*contact_.origins[k].effect, time) - 1.0) * contact_.moving[k];
}

double MovingBounds::product(const std::vector<double>& multipliers) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < contact_.moving.size(); ++k)
    sum -= multipliers[k] * contact_.moving[k];
  return sum;
}

void MovingBounds::addProducts(const Teuchos::Comm<int>& comm, const std::vector<double>& multipliers,
                               const std::vector<scene::TimedLoads::Case>& cases,
                               scene::TimedLoads::Products& products) const {
  if (!any_)
    return;
  std::vector<double> sums(cases.size(), 0.0);
  for (std::size_t k = 0; k < contact_.moving.size(); ++k) {
    if (contact_.moving[k] == 0.0)
      continue;
    const std::string history = scene_.timeline.historyOf(*contact_.origins[k].effect);
    const auto found = std::find_if(cases.begin(), cases.end(), [&](const scene::TimedLoads::Case& c) {
      return c.history == history && !c.isStrain;
    });
    HARMOS_REQUIRE(found != cases.end(), "an effect follows a history that loads do not know");
    sums[static_cast<std::size_t>(found - cases.begin())] -= multipliers[k] * contact_.moving[k];
  }
  globalSum(comm, sums);
  for (std::size_t c = 0; c < sums.size(); ++c)
    products.motion[c] += sums[c];
}

} // namespace Harmos::run
