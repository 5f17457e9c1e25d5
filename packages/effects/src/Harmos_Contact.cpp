// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Contact.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_Overlap.hpp"
#include "Harmos_PointAlgebra.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::effects {

scene::EffectKind kindOfContact() {
  ParameterSpec spec("<contact>", "Two boundary parts do not penetrate each other. \"Effects/Friction\" and "
                                  "\"Effects/Adhesion\" add friction "
                                  "and adhesion.");
  SurfacePair::addTo(spec);
  spec.real("Gap", 0.0, Range(),
            "Length added to the distance of the meshes; negative: initial penetration.");
  spec.real("Stiffness", 0.0, Range::atLeast(0.0),
            "Soft contact: pressure by penetration, a force per volume. 0: hard contact, no penetration.");
  spec.real(
      "Adjust", 0.0, Range::atLeast(0.0),
      "Distances of the meshes up to this length, and penetrations, are taken to be zero, without strain, "
      "before the gap is added. 0: distances stay as they are.");
  spec.real(
      "Interference", 0.0, Range(),
      "Penetration besides, as of a shrink fit, a length; \"History\" scales it over the steps. No other "
      "contact may act at the same points.");
  return {Contact::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            const Contact::Options options = {list.get<double>("Gap"), list.get<double>("Stiffness"),
                                              list.get<double>("Adjust"), list.get<double>("Interference")};
            return std::make_shared<Contact>(SurfacePair::fromList(list, path, scene), options,
                                             scene::nameIn(path));
          },
          true};
}

Contact::Contact(SurfacePair pair, double gap, std::string name)
    : Contact(std::move(pair), Options{gap, 0.0, 0.0, 0.0}, std::move(name)) {}

Contact::Contact(SurfacePair pair, const Options& options, std::string name)
    : Effect(kindName, std::move(name)), pair_(std::move(pair)), options_(options) {}

void Contact::check(const scene::Scene& scene) const {
  if (!scene.isFinite())
    return;
  if (pair_.coupling == Coupling::Nodes)
    throw InputError(label() + " has the coupling \"nodes\", but with \"Model/Kinematics\" = \"finite\" "
                               "surfaces slide: use \"mortar\" or \"automatic\"");
}

void Contact::addConstraints(scene::ConstraintCollector& collector) const {
  std::vector<contact::ContactPoint> points =
      pair_.points(collector, SurfacePair::Purpose::Contact, options_.gap - options_.interference);
  // Of deformed bodies a node keeps what it was adjusted by at rest, wherever it slides.
  std::map<std::pair<long long, int>, double> atRest;
  if (options_.adjust > 0.0 && collector.isOfMoved()) {
    atRest = pair_.gapsAtRest(collector);
    // Forces on coarse, curved surfaces were off by some per cent.
    double largest = 0.0;
    for (const auto& [place, gap] : atRest)
      largest = std::max(largest, gap <= options_.adjust ? std::abs(gap) : 0.0);
    pair_.requireNear(collector, largest, label() + ": \"Adjust\" takes");
  }
  for (contact::ContactPoint& point : points) {
    if (const auto gap = atRest.find({point.node, point.side}); gap != atRest.end())
      point.gap -= gap->second <= options_.adjust ? gap->second : 0.0;
    else if (options_.adjust > 0.0 && !collector.isOfMoved() && point.gap <= options_.adjust)
      point.gap = 0.0;
    point.gap += options_.gap - options_.interference;
    point.interference = options_.interference;
    if (options_.stiffness > 0.0)
      point.compliance = 1.0 / (options_.stiffness * point.area);
  }
  collector.addContacts(points, {{pair_.first.body, pair_.first.set}, {pair_.second.body, pair_.second.set}});
}

std::string Contact::fault(const scene::ConstraintCollector& deformed) const {
  const contact::Surface first = deformed.surface(pair_.first.body, pair_.first.set),
                         second = deformed.surface(pair_.second.body, pair_.second.set);
  const double reach = pair_.reachFor(first, second, options_.gap - options_.interference);
  std::optional<fem::Point> place =
      contact::deepOverlap(first, deformed.subdomainsOf(pair_.second.body), reach);
  if (!place)
    place = contact::deepOverlap(second, deformed.subdomainsOf(pair_.first.body), reach);
  return !place ? std::string()
                : label() + ": " + first.name + " and " + second.name + " overlap at " + placeText(*place) +
                      " by more than " + scientific(reach) +
                      ", within which counterparts are looked for; take smaller steps or a longer \"Reach\"";
}

} // namespace Harmos::effects
