// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Assembly.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Elasticity.hpp"
#include "Harmos_Loads.hpp"
#include "Harmos_Mesh.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace Harmos::scene {

/// What the bodies of a scene are; one for all of them.
enum class Physics {
  Membrane,    ///< −Δu = f, one displacement a node, normal to the plane
  PlaneStrain, ///< elastic, two displacements a node
  PlaneStress,
  Solid ///< elastic, three displacements a node
};

/// Degrees of freedom a node.
int componentsOf(Physics physics);
fem::Kinematics kinematicsOf(Physics physics);

/// A body, already cut into subdomains.
struct Body {
  std::string name;
  int subdomains = 0;
  /// Mesh of subdomain s, pure: made one by one, on any rank.
  std::function<fem::PlacedMesh(int)> subdomain;
  /// Instead of that: all of them, on rank 0, from where they are distributed; empty on the other ranks.
  std::shared_ptr<const std::vector<fem::PlacedMesh>> onRoot;

  /// A boundary part is held at a value in one component.
  struct PrescribedDisplacement {
    std::string set;
    double value = 0.0;
    int component = 0;
    std::function<double(const fem::Point&)> field = nullptr; ///< if given, in the place of the value
  };
  std::vector<PrescribedDisplacement> prescribed;

  std::vector<fem::BoxLoad> bodyForce; ///< of a membrane

  // Of an elastic body.
  std::vector<fem::Material> materials; ///< of each region of the meshes
  fem::Dilatation dilatation = fem::Dilatation::Full;
  std::vector<fem::VectorField> forces; ///< per volume
  struct Traction {
    std::string set;
    fem::Traction density; ///< per area
  };
  std::vector<Traction> tractions;
  double temperature = 0.0; ///< rise above that of the stress-free state
};

/// What happens between boundary parts of two bodies.
struct Interface {
  enum class Kind {
    Contact, ///< frictionless unilateral: n·(u¹ − u²) ≤ gap
    Tie      ///< u¹ = u²
  };
  /// How the two meshes are brought together.
  enum class Coupling {
    Automatic, ///< node to node where the nodes match, else mortar
    Nodes,
    Mortar
  };
  Kind kind;
  int firstBody; ///< the one that carries the multipliers
  std::string firstSet;
  int secondBody;
  std::string secondSet;
  Coupling coupling = Coupling::Automatic;
  double gap = 0.0;                      ///< added to the distance of the meshes; negative: penetration
  contact::NormalField normal = nullptr; ///< of the first surface, where it is known
  double reach = 0.0;                    ///< counterparts farther than this are none; 0: automatic
};

/// A boundary part that may touch a rigid obstacle.
struct ObstacleContact {
  std::string name;
  int body;
  std::string set;
  contact::Obstacle obstacle;
};

/// What is to be simulated: bodies, loads and the effects between them, and nothing else.
///
/// An effect that a scene does not name has no object, row, timer or memory in the run.
struct Scene {
  std::string name;
  Physics physics = Physics::Membrane;
  std::vector<Body> bodies;
  std::vector<Interface> interfaces;
  std::vector<ObstacleContact> obstacles;
  std::vector<std::string> notes; ///< told at the beginning of the run
  double secondsToMake = 0.0;     ///< of reading and cutting meshes before the run: part of its mesh stage

  int components() const { return componentsOf(physics); }
  int subdomains() const;
  bool hasInequalities() const;
  /// A body without a prescribed displacement floats.
  bool hasFloatingBody() const;
  /// Whether stiffnesses differ from body to body or region to region.
  bool hasSeveralMaterials() const;
  /// Names of the effects that are on, in a fixed order.
  std::vector<std::string> effects() const;
};

} // namespace Harmos::scene
