// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Contact.hpp"

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
  return {Contact::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            return std::make_shared<Contact>(SurfacePair::fromList(list, path, scene),
                                             list.get<double>("Gap"), scene::nameIn(path),
                                             list.get<double>("Stiffness"));
          }};
}

Contact::Contact(SurfacePair pair, double gap, std::string name, double stiffness)
    : Effect(kindName, std::move(name)), pair_(std::move(pair)), gap_(gap), stiffness_(stiffness) {}

void Contact::addConstraints(scene::ConstraintCollector& collector) const {
  std::vector<contact::ContactPoint> points = pair_.points(collector, SurfacePair::Purpose::Contact, gap_);
  for (contact::ContactPoint& point : points) {
    point.gap += gap_;
    if (stiffness_ > 0.0)
      point.compliance = 1.0 / (stiffness_ * point.area);
  }
  collector.addContacts(points, {{pair_.first.body, pair_.first.set}, {pair_.second.body, pair_.second.set}});
}

} // namespace Harmos::effects
