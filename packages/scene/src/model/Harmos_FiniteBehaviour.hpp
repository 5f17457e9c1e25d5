// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"

#include <string>
#include <vector>

namespace Harmos::scene {

class ConstraintCollector;
struct Scene;

/// What an effect is of bodies at finite displacements. Its loads keep their direction, and their size over
/// the body at rest, unless it says otherwise; rows of ties and equations are those of the body at rest,
/// those of contacts those of the deformed one.
class FiniteBehaviour {
 public:
  virtual ~FiniteBehaviour();

  /// Whether it has loads that go with the deformed body, as pressures do: those are not among
  /// Effect::addLoad() then.
  virtual bool hasFollowingLoads() const { return false; }
  /// A subdomain at rest, and as moved() has it.
  struct Deformed {
    const OwnedSubdomain& rest;
    const OwnedSubdomain& now;
  };
  /// @param load f += those at the factor one. Local.
  virtual void addFollowingLoad(const Scene& scene, const Deformed& subdomain,
                                std::vector<double>& load) const;

  /// What deformed bodies in equilibrium do that the effect forbids but does not see: an answer that looks
  /// right and is not. @param deformed where they are. @return a sentence, the same on all ranks; empty:
  /// nothing. @note Collective.
  virtual std::string fault(const ConstraintCollector& deformed) const;

  /// One without such loads or faults.
  static const FiniteBehaviour& plain();
};

} // namespace Harmos::scene
