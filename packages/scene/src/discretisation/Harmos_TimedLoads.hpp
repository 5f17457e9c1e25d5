// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectCosts.hpp"
#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <Teuchos_Comm.hpp>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace Harmos::scene {

/// Loads and prescribed values of this rank's subdomains at any time:
///
///     f(t) = Σ_h h(t) f_h,   g(t) = Σ_h h(t) g_h
///
/// over the histories that effects follow. f_h is assembled once; a time costs a sum of vectors for each set
/// of subdomains that share their loads. Loads that come from strains (of temperatures) are cases of their
/// own, for the energy.
///
/// Guarded by tests/unit/run/test_step_sequence.cpp and tests/regression/test_steps.py.
class TimedLoads {
 public:
  /// Assembles. Local.
  TimedLoads(const Scene& scene, const std::vector<OwnedSubdomain>& owned, EffectCosts& costs);

  /// What follows one history.
  struct Case {
    std::string history;
    bool isStrain; ///< f_h = ∫B̄ᵀC ε_h of a strain
  };
  const std::vector<Case>& cases() const { return cases_; }
  /// h(t) of each case.
  std::vector<double> factors(double time) const;

  /// Of each subdomain. Those that share their loads in every case share the vector. Local.
  std::vector<std::shared_ptr<const std::vector<double>>> loads(double time) const;
  /// Values of the Dirichlet conditions of each subdomain, in the order of Subdomain::fixed; a dof that two
  /// effects prescribe has that of the first. Local.
  std::vector<std::vector<double>> prescribed(double time) const;
  /// Whether any value is ever other than zero. Local.
  bool prescribesMotion() const { return prescribesMotion_; }

  /// f_hᵀu of each case, and of prescribed values g_hᵀr of forces r on them; a dof counts once.
  /// @param reactions for each of Subdomain::fixed. @note Collective.
  struct Products {
    std::vector<double> load, motion;
  };
  Products products(const Teuchos::Comm<int>& comm, const feti::TornVector& displacement,
                    const std::vector<std::vector<double>>& reactions) const;

  /// @throws InputError if two effects prescribe different values for a dof at any time of the run, naming
  /// both, the body, the time and the values. Local; the others are to be told.
  void requireConsistent() const;

 private:
  struct Prescribed {
    int dof;
    double value; ///< at factor one
    std::size_t which;
    const Effect* effect;
    std::size_t first; ///< place of the first value of the same dof: its own, but for duplicates
  };
  std::size_t caseOf(const Effect& effect, bool isStrain);
  void collectPrescribed(const OwnedSubdomain& subdomain);

  const Scene& scene_;
  const std::vector<OwnedSubdomain>& owned_;
  std::vector<Case> cases_;
  using Vector = std::shared_ptr<const std::vector<double>>;
  std::vector<std::vector<Vector>> loads_; // of each subdomain by case; null: none
  std::vector<std::vector<Prescribed>> prescribed_;
  bool prescribesMotion_ = false;
};

/// ½∫ε_T:C:ε_T of the strains that temperatures of a time would cause if nothing held the bodies: the part of
/// the stored energy ½∫(ε − ε_T):C:(ε − ε_T) that does not depend on displacements. @note Collective.
double freeStrainEnergy(const Teuchos::Comm<int>& comm, const Scene& scene,
                        const std::vector<OwnedSubdomain>& owned, double time);

} // namespace Harmos::scene
