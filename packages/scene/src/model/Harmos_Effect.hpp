// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalMatrix.hpp"
#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <optional>
#include <string>
#include <vector>

namespace Harmos::contact {
struct ContactPoint;
}

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
  /// As loadKey(), for addStiffness().
  virtual std::optional<Key> stiffnessKey(const Scene&, const OwnedSubdomain&) const { return std::nullopt; }
  /// K += a symmetric positive semidefinite matrix; entries at equal places add up. The kernel of the sum
  /// follows by itself (feti::keptKernel()).
  virtual void addStiffness(const Scene&, const OwnedSubdomain&, std::vector<MatrixEntry>&) const {}
  /// Rise of the temperature of a body, which stresses at given displacements depend on.
  virtual double temperatureRise(int) const { return 0.0; }

  // What it adds to the constraints.

  /// @note Collective.
  virtual void addConstraints(ConstraintCollector&) const {}

  // What it keeps from one step to the next: slip, damage. The run holds it, in two copies: what was
  // committed with the last step that was accepted, and the trial state of the step that is being solved,
  // which starts from that. A step that fails, is halved or taken up again from a checkpoint starts from the
  // committed one, whatever happened to the trial. All of it is the same on every rank, and local.

  /// One of its inequality rows, or of the limited rows of its friction or adhesion, which follow those.
  struct Row {
    const contact::ContactPoint* point;
    std::size_t place = 0; ///< of its point, among those that the effect has rows at
    bool isLimited = false;
  };
  /// The same in an answer.
  struct RowAnswer : Row {
    double gap = 0.0;               ///< that is left to the bound, as the state has shifted it
    double force = 0.0;             ///< multiplier
    std::optional<double> softness; ///< with which it was found
    double unstretched = 0.0;       ///< see Spring

    /// How far it is open, below zero where springs on the way to an answer let surfaces pass, or has
    /// slipped.
    double opening() const;
    /// The force against that; nothing of limited rows that no spring holds.
    double hold() const;
  };
  /// What holds a row: ConstraintRow::softness, and by how much Bu is beyond the bound that the row was made
  /// with where it has no force. Of a limited row whose spring broke in this step: at which slip, from where
  /// friction takes over.
  struct Spring {
    std::optional<double> softness;
    double unstretched = 0.0;
    std::optional<double> brokenAt = std::nullopt;
  };
  /// How many numbers it keeps, with so many inequality rows and limited ones; they are zero before the first
  /// step.
  virtual std::size_t stateSize(std::size_t /*rows*/, std::size_t /*limited*/) const { return 0; }
  /// A step begins, for the first time or again, from what was committed.
  virtual void beginStep(std::vector<double>& /*trial*/) const {}
  /// What the state adds to the bounds of these rows.
  virtual void addToBounds(const std::vector<double>& /*state*/, std::vector<double>& /*bounds*/) const {}
  /// What the state makes of the springs of these rows, of which some may have none.
  /// @param springs as the rows were made; no softness: a contact, or friction.
  virtual void soften(const std::vector<double>& /*state*/, const std::vector<Row>& /*rows*/,
                      std::vector<Spring>& /*springs*/) const {}
  /// Brings the trial state up to an answer that has converged; whether the step is to be solved again with
  /// it. A step whose state does not settle has failed. @param tolerance of the answer.
  virtual bool updateState(const std::vector<RowAnswer>& /*answer*/, double /*tolerance*/,
                           std::vector<double>& /*trial*/) const {
    return false;
  }

  // Of effects whose points soften, so that no convex problem has their answer: the run looks for openings at
  // which bodies and law agree, those of all such effects together, with the springs of soften(). See
  // run::Softening.

  virtual bool softens() const { return false; }
  /// The forces by which the law holds rows that are open so far, from the state with which the step began.
  virtual std::vector<double> lawForces(const std::vector<double>& /*trial*/,
                                        const std::vector<Row>& /*rows*/,
                                        const std::vector<double>& /*openings*/) const {
    return {};
  }
  /// How far forces of an answer are from the law's, at the worst point: a share of its strength.
  virtual double misfit(const std::vector<RowAnswer>& /*answer*/,
                        const std::vector<double>& /*trial*/) const {
    return 0.0;
  }
  /// The damage of such openings, and springs: with it, through the origin; or where points soften through
  /// force and opening, so many times as stiff as softening is steep.
  /// @param known to what tractions are, as a share of the strength.
  /// @return whether any of them softens.
  virtual bool follow(const std::vector<Row>& /*rows*/, const std::vector<double>& /*openings*/,
                      std::optional<double> /*steepness*/, double /*known*/,
                      std::vector<double>& /*trial*/) const {
    return false;
  }

  // Of effects whose points break.

  /// Whether it has any: even a static state is a step then, for its first solution need not be its last.
  virtual bool breaks() const { return false; }
  /// From 0 to 1, of each point that it has rows at; nothing of effects that know none.
  virtual std::vector<double> damage(const std::vector<double>& /*state*/) const { return {}; }
  /// What damage has dissipated, since the beginning of the run.
  virtual double dissipated(const std::vector<double>& /*state*/) const { return 0.0; }
  /// How much has broken since the step began, in units of what may in one step: beyond 1 the step is halved,
  /// as long as it may be.
  virtual double haste(const std::vector<double>& /*trial*/) const { return 0.0; }

 protected:
  /// sum += more, for vectors of the same length.
  static void addTo(std::vector<double>& sum, const std::vector<double>& more);

 private:
  std::string kind_, name_;
};

} // namespace Harmos::scene
