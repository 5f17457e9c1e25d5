// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_TestScene.hpp"

#include <string>
#include <vector>

namespace Harmos {

/// A scene drawn at random, and how it is to be run; the same for the same seed, whatever the ranks.
///
/// One to four blocks stacked along x or upwards, tied to or in contact with each other, on a held base or on
/// an obstacle: membranes, plane strain, plane stress and solids of every cell type, cut into random
/// subdomains, with meshes that match or do not. Young's moduli are log-uniform in 1e-6…1e6, lengths in
/// 1e-3…1e3; gaps of both signs; Poisson's ratios up to 0.4999; tractions, body forces, temperatures,
/// prescribed displacements.
///
/// Bodies are centred on the axis of the stack, and whatever contact alone holds is pressed down by loads
/// that are symmetric about it or held against sideways motion and rotation: so there is a solution, unless
/// isSolvable is false because the topmost body is pulled away.
///
/// With friction, elastic bodies alone, Young's moduli in 1e-2…1e2: most contacts have it, by Coulomb's law
/// or Tresca's, and the topmost body is pushed sideways too. Where friction alone holds it, by half of what
/// each contact below it bears at most, and not enough to tilt it; or by twice what holds it, and there is no
/// solution.
struct RandomScene {
  unsigned seed = 0;
  scene::Scene scene;
  scene::Scene untorn; ///< the same, one subdomain a body
  double tolerance = 0.0;
  std::vector<std::string> settings; ///< of the deck, as with --set
  bool isSolvable = true;
  double mostFriction = 0.0; ///< the most that a coefficient of friction may be; 0: none

  /// A line that says which scene this is.
  std::string text() const;
};

RandomScene randomScene(unsigned seed);
/// @param most coefficients are log-uniform from a fiftieth of it.
RandomScene randomFrictionScene(unsigned seed, double most);

} // namespace Harmos
