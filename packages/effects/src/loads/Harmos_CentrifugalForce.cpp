// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CentrifugalForce.hpp"

#include "Harmos_DeckPlaces.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Loads.hpp"
#include "Harmos_PointAlgebra.hpp"

namespace Harmos::effects {

scene::EffectKind kindOfCentrifugalForce() {
  ParameterSpec spec("<rotation>",
                     "A body turns about an axis at a constant speed; displacements turn with it.");
  spec.text("Body", "", "Name of the body. Required.");
  spec.real("Mass density", 1.0, Range::above(0.0), "Mass per volume.");
  spec.real("Angular velocity", 0.0, Range(),
            "Radians per time. With a \"History\" the factor scales the force, the square of it.");
  spec.reals("Point", {0.0, 0.0, 0.0}, Range(), "A point on the axis.");
  spec.reals("Axis", {0.0, 0.0, 1.0}, Range(),
             "Direction of the axis; in plane scenes z, in axisymmetric ones y.");
  return {CentrifugalForce::kindName, spec,
          [](const Teuchos::ParameterList& list, const std::string& path, const scene::Scene& scene) {
            requireElastic(scene, "\"" + path + "\"");
            const CentrifugalForce::Rotation rotation = {list.get<double>("Mass density"),
                                                         list.get<double>("Angular velocity"),
                                                         pointIn(list, "Point"), pointIn(list, "Axis")};
            return std::make_shared<CentrifugalForce>(bodyIn(scene, list, "Body", path), rotation,
                                                      scene::nameIn(path));
          },
          true};
}

CentrifugalForce::CentrifugalForce(int body, const Rotation& rotation, std::string name)
    : Effect(kindName, std::move(name)), body_(body), rotation_(rotation) {}

void CentrifugalForce::check(const scene::Scene& scene) const {
  requireElastic(scene, label());
  const fem::Point& axis = rotation_.axis;
  if (!(norm(axis) > 0.0))
    throw InputError(label() + ": its axis is a zero vector; give a direction");
  if (scene.physics == scene::Physics::Axisymmetric) {
    if (axis[0] != 0.0 || axis[2] != 0.0 || rotation_.point[0] != 0.0)
      throw InputError(label() + ": its axis is not y; axisymmetric bodies turn about their own axis, x = 0");
  } else if (scene.components() == 2 && (axis[0] != 0.0 || axis[1] != 0.0)) {
    throw InputError(label() + ": its axis is not z; bodies in the plane turn about an axis normal to it");
  }
}

std::optional<scene::Effect::Key> CentrifugalForce::loadKey(const scene::Scene&,
                                                            const scene::OwnedSubdomain& subdomain) const {
  return ownKey(subdomain);
}

// Force per volume, by place.
fem::VectorField CentrifugalForce::density() const {
  const fem::Point axis = scaled(1.0 / norm(rotation_.axis), rotation_.axis), point = rotation_.point;
  const double size = rotation_.massDensity * rotation_.angularVelocity * rotation_.angularVelocity;
  return [=](const fem::Point& x) {
    const fem::Point offset = difference(x, point);
    return scaled(size, difference(offset, scaled(dot(offset, axis), axis)));
  };
}

void CentrifugalForce::addLoad(const scene::Scene& scene, const scene::OwnedSubdomain& subdomain,
                               std::vector<double>& load) const {
  if (scene.isFinite())
    return;
  const fem::PlacedMesh& placed = subdomain.mesh;
  addTo(load, fem::assembleBodyForce(*placed.mesh, placed.anchor, density(),
                                     scene.bodies[static_cast<std::size_t>(body_)].integration));
}

void CentrifugalForce::addFollowingLoad(const scene::Scene& scene, const Deformed& subdomain,
                                        std::vector<double>& load) const {
  const fem::PlacedMesh &rest = subdomain.rest.mesh, &now = subdomain.now.mesh;
  std::vector<double> displacement = now.mesh->coordinates;
  for (std::size_t k = 0; k < displacement.size(); ++k)
    displacement[k] -= rest.mesh->coordinates[k];
  addTo(load, fem::assembleMovedBodyForce(*rest.mesh, rest.anchor, displacement, density(),
                                          scene.bodies[static_cast<std::size_t>(body_)].integration));
}

} // namespace Harmos::effects
