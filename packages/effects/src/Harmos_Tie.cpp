// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Tie.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::effects {

scene::EffectKind kindOfTie() {
  ParameterSpec spec("<tie>", "Two boundary parts are bonded.");
  SurfacePair::addTo(spec);
  return {Tie::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            return std::make_shared<Tie>(SurfacePair::fromList(list, path, scene), scene::nameIn(path));
          }};
}

Tie::Tie(SurfacePair pair, std::string name) : Effect(kindName, std::move(name)), pair_(std::move(pair)) {}

void Tie::addConstraints(scene::ConstraintCollector& collector) const {
  std::vector<contact::ContactPoint> points = pair_.points(collector, SurfacePair::Purpose::Tie);
  if (collector.isOfFinite()) {
    double largest = 0.0;
    for (const contact::ContactPoint& point : points)
      largest = std::max(largest, std::abs(point.gap));
    pair_.requireNear(collector, largest, label() + " takes");
  }
  collector.addTies(std::move(points),
                    {{pair_.first.body, pair_.first.set}, {pair_.second.body, pair_.second.set}});
}

} // namespace Harmos::effects
