// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectCosts.hpp"
#include "Harmos_Scene.hpp"

#include <functional>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

namespace Harmos::scene {

/// What all effects of a scene add to its subdomains at one time. What looks the same from within congruent
/// subdomains is made once and shared by them.
class SubdomainEffects {
 public:
  /// At the end of the first step. @param scene, costs have to outlive it.
  SubdomainEffects(const Scene& scene, EffectCosts& costs);

  /// Dirichlet conditions; what they cost is not counted, so that they may be asked for again.
  std::vector<feti::FixedDof> prescribed(const OwnedSubdomain& subdomain) const;
  std::vector<feti::FixedDof> prescribed(const OwnedSubdomain& subdomain, double time) const;
  std::vector<feti::FixedDof> countedPrescribed(const OwnedSubdomain& subdomain);

  /// The load vector; subdomains without load share one of zeros.
  std::shared_ptr<const std::vector<double>> load(const OwnedSubdomain& subdomain);

  /// That of some effects, at the factor one; null if none of them acts there.
  std::shared_ptr<const std::vector<double>> wholeLoad(const OwnedSubdomain& subdomain,
                                                       const std::function<bool(const Effect&)>& takes);

  /// A stiffness matrix and its kernel.
  struct Stiffness {
    std::shared_ptr<const LocalMatrix> matrix;
    std::shared_ptr<const feti::Kernel> motions;
  };
  /// With what the effects add to the matrix of the subdomain's mesh and body, and the motions that are left;
  /// the given one if they add nothing.
  Stiffness stiffness(const OwnedSubdomain& subdomain, const Stiffness& elastic);

 private:
  // Mesh, body and keys of all effects that act.
  using Place = std::tuple<const fem::Mesh*, int, std::vector<double>>;
  struct Acting {
    Place place;
    std::vector<const Effect*> effects;
  };
  using KeyOf = std::optional<Effect::Key> (Effect::*)(const Scene&, const OwnedSubdomain&) const;
  Acting acting(const OwnedSubdomain& subdomain, KeyOf keyOf,
                const std::function<bool(const Effect&)>& takes = nullptr) const;

  // Multiplied by the effect's factor, where it is not one.
  void addPrescribed(const Effect& effect, const OwnedSubdomain& subdomain, double time,
                     std::vector<feti::FixedDof>& fixed) const;
  void addLoad(const Effect& effect, const OwnedSubdomain& subdomain, std::vector<double>& load) const;

  const Scene& scene_;
  EffectCosts& costs_;
  double time_;
  std::vector<std::vector<const Effect*>> ofBody_;
  std::map<std::size_t, std::shared_ptr<const std::vector<double>>> zeros_; // by length
  std::map<Place, std::shared_ptr<const std::vector<double>>> loads_, wholeLoads_;
  std::map<Place, Stiffness> stiffness_;
};

} // namespace Harmos::scene
