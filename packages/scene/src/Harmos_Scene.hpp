// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Assembly.hpp"
#include "Harmos_Mesh.hpp"

#include <functional>
#include <string>
#include <vector>

namespace Harmos::scene {

/// A body, already cut into subdomains whose meshes can be made one by one, on any rank.
struct Body {
  std::string name;
  int subdomains = 0;
  std::function<fem::PlacedMesh(int)> subdomain; ///< mesh of subdomain s; pure
  std::vector<fem::BoxLoad> bodyForce;

  struct PrescribedDisplacement {
    std::string set; ///< named boundary part
    double value;
  };
  std::vector<PrescribedDisplacement> prescribed;
};

/// What happens between boundary parts of two bodies.
struct Interface {
  enum class Kind {
    Contact, ///< frictionless unilateral: u² − u¹ ≥ −gap
    Tie      ///< u¹ = u²
  };
  Kind kind;
  int firstBody;
  std::string firstSet;
  int secondBody;
  std::string secondSet;
};

/// What is to be simulated: bodies, loads and the effects between them, and nothing else.
///
/// An effect that a scene does not name has no object, row, timer or memory in the run.
struct Scene {
  std::string name;
  std::vector<Body> bodies;
  std::vector<Interface> interfaces;

  int subdomains() const;
  bool hasInequalities() const;
  /// A body without a prescribed displacement floats.
  bool hasFloatingBody() const;
  /// Names of the effects that are on, in a fixed order.
  std::vector<std::string> effects() const;
};

} // namespace Harmos::scene
