// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FiniteBehaviour.hpp"
#include "Harmos_InterfaceLaw.hpp"
#include "Harmos_LocalMatrix.hpp"
#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <optional>
#include <string>
#include <vector>

namespace Harmos::scene {

struct Scene;
class ConstraintCollector;

/// An effect that is on in a scene: a contact, a load, a support. Immutable.
///
/// A run asks each effect of its scene what it adds to the discrete problem
///
///     min ½uᵀKu − fᵀu   subject to   B_I u ≤ c_I,  B_E u = c_E :
///
/// to K and f of a subdomain, Dirichlet conditions, and rows of B. The default contribution is nothing, and
/// an absent contribution costs no memory or time.
///
/// Further needs of new effects extend this interface: a new kind of row in ConstraintCollector, like the
/// limited rows of friction; output fields by a hook beside run::writeResult(), like ContactFields for
/// contacts.
///
/// Guarded by tests/unit/effects/test_absence.cpp.
class Effect {
 public:
  /// @param kind as in the registry: "Contact". @param name its own, as in the deck; may be empty.
  Effect(std::string kind, std::string name);
  virtual ~Effect();
  Effect(const Effect&) = delete;
  Effect& operator=(const Effect&) = delete;

  const std::string& kind() const { return kind_; }
  const std::string& name() const { return name_; }
  /// For messages: contact "joint"; "a contact" if it has no name.
  std::string label() const;

  /// How many effects of a kind this process has: now, and since it began. Thread-safe. For tests that a run
  /// makes none.
  struct Count {
    long long living = 0;
    long long made = 0;
  };
  static Count count(const std::string& kind);

  // What it refers to, so that what is not there is refused before the run, and others know what to expect.

  struct BoundaryPart {
    int body;
    std::string set;
    bool needsSides; ///< sides of cells; else nodes are enough
    /// What acts at its nodes acts once at each: on the subdomain that OwnedSubdomain::ownNodes says.
    bool countsNodes = false;
    /// What acts on it depends on its area or direction: OwnedSubdomain::measures.
    bool isMeasured = false;
  };
  virtual std::vector<BoundaryPart> boundaryParts() const { return {}; }
  /// Bodies whose subdomains it is asked about: for Dirichlet conditions, loads and stiffness.
  virtual std::vector<int> bodies() const { return {}; }
  /// Bodies that it holds against rigid motions by itself, without inequalities.
  virtual std::vector<int> heldBodies() const { return {}; }
  virtual bool givesInequalities() const { return false; }
  /// Whether it holds two surfaces together: nodes of both are its own, see ConstraintCollector::taken().
  virtual bool tiesSurfaces() const { return false; }
  /// Whether a run tells the force that it exerts: as a support, a foundation, an obstacle, or between two
  /// bodies.
  virtual bool exertsForce() const { return givesInequalities() || !heldBodies().empty(); }
  /// Whether it has a size that a history scales over time (see Timeline): loads, prescribed values and
  /// strains that it adds are those of the factor 1.
  virtual bool hasMagnitude() const { return false; }
  /// What it is of bodies at finite displacements; null: it does not go with them.
  virtual const FiniteBehaviour* finite() const { return nullptr; }
  /// @throws InputError for settings that the scene does not admit. Local; the same on all ranks.
  virtual void check(const Scene&) const {}

  // What it adds to a subdomain. Local.

  /// What an addition looks like from within the subdomain: subdomains of the same mesh and body get the same
  /// addition where keys are equal, and share its result.
  using Key = std::vector<double>;
  /// Of additions that nothing else shares.
  static Key ownKey(const OwnedSubdomain& subdomain) { return {static_cast<double>(subdomain.number)}; }

  virtual void addPrescribed(const Scene&, const OwnedSubdomain&, std::vector<feti::FixedDof>&) const {}
  /// Nothing where the subdomain has no such load; else addLoad() follows for the first of each key.
  virtual std::optional<Key> loadKey(const Scene&, const OwnedSubdomain&) const { return std::nullopt; }
  /// f += ...; a number for each dof = node · components + component.
  virtual void addLoad(const Scene&, const OwnedSubdomain&, std::vector<double>&) const {}
  /// Whether loads are of the force which the effect tells of, as between two sides of a cut.
  virtual bool loadsWithItsForce() const { return false; }
  /// f += those on the first side alone. @param subdomain at rest, and of finite displacements as it is now.
  virtual void addForce(const Scene&, const FiniteBehaviour::Deformed& /*subdomain*/,
                        std::vector<double>& /*load*/) const {}
  /// As loadKey(), for addStiffness().
  virtual std::optional<Key> stiffnessKey(const Scene&, const OwnedSubdomain&) const { return std::nullopt; }
  /// K += a symmetric positive semidefinite matrix; entries at equal places add up. The kernel of the sum
  /// follows by itself (feti::keptKernel()).
  virtual void addStiffness(const Scene&, const OwnedSubdomain&, std::vector<MatrixEntry>&) const {}
  /// Rise of the temperature of a body, which stresses at given displacements depend on.
  virtual double temperatureRise(int) const { return 0.0; }
  /// The nodal field of the body's mesh (fem::PlacedMesh::fields) that is such a rise; "": none.
  virtual std::string temperatureField(int) const { return ""; }

  // What it adds to the constraints.

  /// @note Collective.
  virtual void addConstraints(ConstraintCollector&) const {}

  /// What holds its points, from a state that they keep from one step to the next: slip, damage. Null: none.
  virtual const InterfaceLaw* interfaceLaw() const { return nullptr; }

 protected:
  /// sum += more, for vectors of the same length.
  static void addTo(std::vector<double>& sum, const std::vector<double>& more);

 private:
  std::string kind_, name_;
};

} // namespace Harmos::scene
