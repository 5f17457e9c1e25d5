// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PointSlips.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_PointAlgebra.hpp"

namespace Harmos::run {

PointSlips::Key PointSlips::keyOf(const scene::ContactSetup& contact, std::size_t point) const {
  std::size_t effect = 0;
  while (scene_->effects[effect].get() != contact.effects[point])
    ++effect;
  return {effect, contact.points[point].node, contact.points[point].side};
}

std::vector<double> PointSlips::of(const scene::ContactSetup& contact) const {
  std::vector<double> result;
  for (const contact::SlipPoint& slip : contact.slips) {
    const auto found = slips_.find(keyOf(contact, slip.point));
    for (const fem::Point& tangent : slip.tangents)
      result.push_back(found == slips_.end() ? 0.0 : dot(found->second, tangent));
  }
  return result;
}

void PointSlips::keep(const scene::ContactSetup& contact, const std::vector<ContactState>& states) {
  for (const contact::SlipPoint& slip : contact.slips)
    slips_[keyOf(contact, slip.point)] = states[slip.point].slip;
}

void PointSlips::exchange(const Teuchos::Comm<int>& comm, qp::StateArchive<MultiVector>& archive) {
  constexpr std::size_t width = 6;
  std::vector<double> all;
  if (!archive.isReading()) {
    for (const auto& [key, slip] : slips_) {
      all.insert(all.end(), {static_cast<double>(std::get<0>(key)), static_cast<double>(std::get<1>(key)),
                             static_cast<double>(std::get<2>(key))});
      all.insert(all.end(), slip.begin(), slip.end());
    }
    all = gatherAll(comm, all);
  }
  archive.numbers("slips of points", all);
  if (!archive.isReading())
    return;
  slips_.clear(); // those of other ranks do no harm
  for (std::size_t k = 0; k + width <= all.size(); k += width)
    slips_[{static_cast<std::size_t>(all[k]), static_cast<long long>(all[k + 1]),
            static_cast<int>(all[k + 2])}] = {all[k + 3], all[k + 4], all[k + 5]};
}

} // namespace Harmos::run
