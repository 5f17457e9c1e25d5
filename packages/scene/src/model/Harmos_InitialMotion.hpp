// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"

#include <vector>

namespace Harmos::scene {

struct Scene;

/// What an effect may be besides: one that says how bodies move when a transient run begins.
class InitialMotion {
 public:
  virtual ~InitialMotion();

  /// v += velocities of all dofs = node · components + component, of a subdomain of one of Effect::bodies().
  /// Local.
  virtual void addVelocity(const Scene& scene, const OwnedSubdomain& subdomain,
                           std::vector<double>& velocity) const = 0;
};

} // namespace Harmos::scene
