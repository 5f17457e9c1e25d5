// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundaryRule.hpp"
#include "Harmos_Effect.hpp"
#include "Harmos_Elasticity.hpp"
#include "Harmos_Mesh.hpp"
#include "Harmos_Timeline.hpp"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::scene {

/// What the bodies of a scene are; one for all of them.
enum class Physics {
  Membrane,    ///< −Δu = f, one displacement a node, normal to the plane
  PlaneStrain, ///< elastic, two displacements a node
  PlaneStress,
  Axisymmetric, ///< elastic bodies of revolution: x is the distance from the axis, y along it
  Solid         ///< elastic, three displacements a node
};

/// Degrees of freedom a node.
int componentsOf(Physics physics);
fem::Kinematics kinematicsOf(Physics physics);
/// Rigid-body modes of a body that nothing holds.
int rigidBodyModesOf(Physics physics);

/// A body, already cut into subdomains.
struct Body {
  std::string name;
  int subdomains = 0;
  /// Mesh of subdomain s, pure: made one by one, on any rank.
  std::function<fem::PlacedMesh(int)> subdomain;
  /// Instead of that: all of them, on rank 0, from where they are distributed; empty on the other ranks.
  std::shared_ptr<const std::vector<fem::PlacedMesh>> onRoot;
  /// Its subdomains are parts into which a mesh was cut, of any shape, as those of `onRoot` are: defaults of
  /// solvers follow.
  bool isCut = false;

  // Of an elastic body.
  std::vector<fem::Material> materials; ///< of each region of the meshes
  fem::Dilatation dilatation = fem::Dilatation::Full;
  fem::Integration integration = fem::Integration::Full;
  std::vector<double> thickness; ///< in the plane, of each region; empty: 1
};

/// A number that a run of several steps tells of each besides: a force as a stress, a factor as a strain.
struct Measure {
  std::string name;                     ///< of its column in steps.csv
  std::shared_ptr<const Effect> effect; ///< of the scene
  /// Of the force that the effect exerts, 0 to 2; none: the factor of its history.
  std::optional<std::size_t> component;
  double scale = 1.0; ///< times that
};

/// What is to be simulated: bodies and the effects on and between them, and nothing else.
///
/// An effect that a scene does not name has no object, row, timer or memory in the run.
struct Scene {
  std::string name;
  Physics physics = Physics::Membrane;
  fem::Strains strains = fem::Strains::Small;
  std::vector<Body> bodies;
  /// Boundary parts besides those that the meshes have; in their order: one may be named by those after it.
  std::vector<fem::BoundaryRule> boundaryRules;
  /// In their order they are asked: it is that of the rows, and of sums of loads.
  std::vector<std::shared_ptr<const Effect>> effects;
  Timeline timeline;
  std::vector<Measure> measures;
  std::vector<std::string> notes; ///< told at the beginning of the run
  /// By body, of those whose number of subdomains a cost model chose: a restart keeps them. On all ranks.
  std::map<std::string, int> chosenSubdomains;
  double secondsToMake = 0.0; ///< of reading and cutting meshes before the run: part of its mesh stage

  int components() const { return componentsOf(physics); }
  int subdomains() const;
  bool hasInequalities() const;
  /// Whether points may break: even a static state goes the way of a step then.
  bool breaks() const;
  /// Whether any effect holds points by a law with a state, as friction.
  bool hasInterfaceLaws() const;
  /// Whether displacements are of any size: equilibrium and contact are those of the deformed bodies.
  bool isFinite() const { return strains == fem::Strains::Finite; }
  /// Whether any material yields.
  bool yields() const;
  /// Whether equilibrium is found by Newton's iterations.
  bool iterates() const { return isFinite() || yields(); }
  /// Whether bodies have inertia.
  bool isTransient() const { return timeline.isTransient(); }
  /// Whether it is solved step by step.
  bool goesInSteps() const { return timeline.hasSteps() || breaks() || iterates(); }
  /// A body that no effect holds, but for inequalities, floats.
  bool hasFloatingBody() const;
  /// Whether stiffnesses differ from body to body or region to region.
  bool hasSeveralMaterials() const;
  /// The largest over the smallest stiffness of its materials: Young's modulus, where strains are not free
  /// across the plane that of uniaxial strain, (1 − ν)/((1 + ν)(1 − 2ν)) times that. 1 for membranes.
  double materialContrast() const;
  /// Rise of each body's temperature, of all effects, at a time.
  std::vector<double> temperatureRises(double time) const;
  /// Rises at the nodes of a subdomain at a time, from nodal fields of its mesh; null without these.
  /// @throws InputError if the mesh has no such field.
  std::shared_ptr<const std::vector<double>> nodalRises(const OwnedSubdomain& subdomain, double time) const;
  /// Whether any body has another temperature than in its stress-free state, at a time.
  bool hasTemperatures(double time) const;
  /// Kinds of the effects that are on, each once, in their order.
  std::vector<std::string> effectKinds() const;
  /// Of each effect, for people and files: "Contact/joint"; one without a name has its number among those of
  /// its kind, "Contact/1". Each once.
  std::vector<std::string> effectPaths() const;
  /// Of those that exert a force.
  std::vector<std::string> forcePaths() const;
  /// Of those that give inequalities.
  std::vector<std::string> contactPaths() const;
};

/// A nodal field of a subdomain's mesh. @param label of the effect that asks, for the message.
/// @throws InputError if there is none of this name, naming those that there are.
const std::vector<double>& nodalField(const Scene& scene, const OwnedSubdomain& subdomain,
                                      const std::string& name, const std::string& label);

/// The direction in space of a component of the displacement; that of membranes is z.
fem::Point directionOf(const Scene& scene, int component);

/// A body's elastic properties as the fem package takes them.
fem::Elasticity elasticityOf(const Scene& scene, const Body& body);

} // namespace Harmos::scene
