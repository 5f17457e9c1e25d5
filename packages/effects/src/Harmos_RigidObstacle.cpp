// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RigidObstacle.hpp"

#include "Harmos_ConstraintCollector.hpp"
#include "Harmos_Errors.hpp"

namespace Harmos::effects {
namespace {

using Shape = contact::Obstacle::Shape;

void requireGeometry(const contact::Obstacle& obstacle, const scene::Scene& scene, const std::string& path) {
  const bool inPlane = scene.components() == 2;
  const auto& [x, y, z] = obstacle.direction;
  const bool needsDirection =
      obstacle.shape == Shape::HalfSpace || (obstacle.shape == Shape::Cylinder && !inPlane);
  if (needsDirection && x == 0.0 && y == 0.0 && (inPlane || z == 0.0))
    throw InputError("\"" + path + "/Direction\" is a zero vector" + (inPlane ? " in the plane" : "") +
                         "; give the outward normal of the half-space or the axis of the cylinder",
                     {{"path", path + "/Direction"}});
  if (obstacle.shape != Shape::HalfSpace && obstacle.radius == 0.0)
    throw InputError(
        "\"" + path +
            "/Radius\" is 0; give a positive radius, or a negative one for a hollow obstacle around the body",
        {{"path", path + "/Radius"}});
}

std::shared_ptr<const scene::Effect> makeRigidObstacle(const Teuchos::ParameterList& list,
                                                       const std::string& path, const scene::Scene& scene) {
  requireElastic(scene, "\"" + path + "\"");
  const Part part = partIn(scene, list, "Part", path);
  const std::string shape = list.get<std::string>("Shape");
  contact::Obstacle obstacle;
  obstacle.shape = shape == "cylinder" ? Shape::Cylinder
                   : shape == "sphere" ? Shape::Sphere
                                       : Shape::HalfSpace;
  obstacle.point = pointIn(list, "Point");
  obstacle.direction = pointIn(list, "Direction");
  obstacle.radius = list.get<double>("Radius");
  requireGeometry(obstacle, scene, path);
  return std::make_shared<RigidObstacle>(part, obstacle, scene::nameIn(path));
}

} // namespace

scene::EffectKind kindOfRigidObstacle() {
  ParameterSpec spec("<obstacle>",
                     "A boundary part does not penetrate a rigid obstacle at rest. \"Effects/Friction\" and "
                     "\"Effects/Adhesion\" add friction and adhesion.");
  spec.text("Part", "", "\"body/boundary part\" in contact. Required.");
  spec.choice("Shape", "half-space",
              {{"half-space", "plane through \"Point\" with the outward normal \"Direction\""},
               {"cylinder", "with the axis through \"Point\" along \"Direction\""},
               {"sphere", "with the centre \"Point\""}},
              "Shape of the obstacle.");
  spec.reals("Point", {0.0, 0.0, 0.0}, Range(), "Point on the plane or on the axis, or the centre.");
  spec.reals(
      "Direction", {0.0, 1.0, 0.0}, Range(),
      "Half-space: outward normal, towards the body. Cylinder: axis; 0, 0, 1 in plane scenes. Not used by "
      "spheres.");
  spec.real("Radius", 0.0, Range(), "Radius of cylinder and sphere; negative: hollow, with the body inside.");
  return {RigidObstacle::kindName, spec, makeRigidObstacle};
}

RigidObstacle::RigidObstacle(Part part, const contact::Obstacle& obstacle, std::string name)
    : Effect(kindName, std::move(name)), part_(std::move(part)), obstacle_(obstacle) {}

void RigidObstacle::addConstraints(scene::ConstraintCollector& collector) const {
  collector.addContacts(contact::obstaclePoints(collector.surface(part_.body, part_.set), obstacle_),
                        {{part_.body, part_.set}});
}

} // namespace Harmos::effects
