// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ElasticFoundation.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Loads.hpp"

namespace Harmos::effects {

scene::EffectKind kindOfElasticFoundation() {
  ParameterSpec spec("<foundation>",
                     "A boundary part rests on distributed springs in tension and compression.");
  spec.text("Part", "", "\"body/boundary part\" on the springs. Required.");
  spec.real("Normal stiffness", 1.0, Range::atLeast(0.0),
            "Force per area and displacement, along the normal.");
  spec.real("Tangential stiffness", 0.0, Range::atLeast(0.0),
            "Force per area and displacement, along the surface.");
  return {ElasticFoundation::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            requireElastic(scene, "\"" + path + "\"");
            return std::make_shared<ElasticFoundation>(
                partIn(scene, list, "Part", path), list.get<double>("Normal stiffness"),
                list.get<double>("Tangential stiffness"), scene::nameIn(path));
          }};
}

ElasticFoundation::ElasticFoundation(Part part, double normal, double tangential, std::string name)
    : Effect(kindName, std::move(name)), part_(std::move(part)), normal_(normal), tangential_(tangential) {}

std::vector<int> ElasticFoundation::heldBodies() const {
  const bool holds = normal_ > 0.0 && tangential_ > 0.0;
  return holds ? std::vector<int>{part_.body} : std::vector<int>();
}

void ElasticFoundation::check(const scene::Scene& scene) const {
  requireElastic(scene, label());
  if (!(normal_ >= 0.0 && tangential_ >= 0.0 && normal_ + tangential_ > 0.0))
    throw InputError(label() + " has zero stiffness; give a positive normal or tangential stiffness");
}

// Congruent subdomains with the same sides on the foundation share their matrix.
std::optional<scene::Effect::Key>
ElasticFoundation::stiffnessKey(const scene::Scene&, const scene::OwnedSubdomain& subdomain) const {
  const auto sides = subdomain.mesh.sides.find(part_.set);
  if (sides == subdomain.mesh.sides.end())
    return std::nullopt;
  Key key;
  for (const fem::Side& side : sides->second) {
    key.push_back(side.cell);
    key.push_back(side.side);
  }
  return key;
}

void ElasticFoundation::addStiffness(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                                     std::vector<MatrixEntry>& entries) const {
  const fem::Mesh& mesh = *subdomain.mesh.mesh;
  const int components = scene.components();
  // φ_i φ_j on sides that are not bent; a little more for those that are.
  const int degree = 2 * fem::shapeOf(mesh.cellType).order + 2;
  fem::visitSides(mesh, subdomain.mesh.sides.at(part_.set), degree, [&](const fem::SidePoint& point) {
    for (std::size_t i = 0; i < point.nodes.size(); ++i)
      for (std::size_t j = 0; j < point.nodes.size(); ++j) {
        const double product = point.measure * point.values[i] * point.values[j];
        for (int a = 0; a < components; ++a)
          for (int b = 0; b < components; ++b) {
            const double nn =
                point.normal[static_cast<std::size_t>(a)] * point.normal[static_cast<std::size_t>(b)];
            const double c = normal_ * nn + tangential_ * ((a == b ? 1.0 : 0.0) - nn);
            entries.push_back(
                {point.nodes[i] * components + a, point.nodes[j] * components + b, product * c});
          }
      }
  });
}

} // namespace Harmos::effects
