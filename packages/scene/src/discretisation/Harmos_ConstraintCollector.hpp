// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_DistinctPoints.hpp"
#include "Harmos_EffectCosts.hpp"
#include "Harmos_EquationRows.hpp"
#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_PartsOfRank.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_SubdomainEffects.hpp"

#include <Teuchos_Comm.hpp>

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace Harmos::scene {

/// Where bodies may touch each other and obstacles, and the rows that follow: those of this rank. What is
/// counted is counted over all ranks.
struct ContactSetup {
  /// What a row's multiplier does: −multiplier · direction is the force on the first body, at the position.
  struct Origin {
    const Effect* effect;
    fem::Point position, direction;
    double area;               ///< tributary, of its point
    bool isTangential = false; ///< of friction or adhesion, which act on that effect
    /// Where the opposite force acts on the same body, of rows that make couples alone.
    std::optional<fem::Point> counter = std::nullopt;
  };
  /// An equation without force up to a time, which keeps the value that it has then: a limited row of rank 0,
  /// of limit zero, behind those of slips.
  struct Lock {
    const Effect* effect;
    double from;       ///< that time
    std::size_t place; ///< of its row on rank 0, among all
    std::vector<ConstraintRow::Term> terms;
  };
  /// A point that adhesion binds by springs.
  struct Bond {
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    const Effect* effect; ///< that says so
    std::size_t point;    ///< its place among the points
    std::size_t slip;     ///< that among those with limited rows; none: held on both sides in all directions
    double softness, tangentialSoftness; ///< opening, and slip, by force
  };
  /// Of bodies that have moved: a point that goes on facing the same places of the second body as at rest,
  /// for adhesion binds it.
  struct Pairing {
    const Effect* contact;
    contact::ContactPoint point; ///< at rest: of deformed bodies the normal is another
    std::vector<fem::Point> tangents;
  };
  /// The points of the inequality rows, by their numbers, which rise with the effects and, of each, with the
  /// nodes: the same on any number of ranks.
  std::vector<contact::ContactPoint> points;
  std::vector<const Effect*> effects; ///< of each point
  long long pointCount = 0;           ///< of all ranks
  /// The points that bear friction, or are bound, in the order of the limited rows, and the effects that say
  /// so: of a point that does both friction.
  std::vector<contact::SlipPoint> slips;
  std::vector<const Effect*> frictions;
  long long limitedRows = 0; ///< of slips, of all ranks
  std::vector<Lock> locks;   ///< the same on all ranks
  bool hasFriction = false;  ///< whether any of these points, on any rank, does not only hold by springs
  std::set<const Effect*> tangential; ///< effects of points with limited rows, on any rank
  /// In the order of the effects that bind them and of points.
  std::vector<Bond> bonds;
  long long bondCount = 0; ///< of all ranks
  /// Limited rows of this rank.
  std::size_t slipRows() const {
    return slips.empty() ? 0 : slips.back().firstPlace + slips.back().tangents.size();
  }
  std::vector<ConstraintRow> rows; ///< of inequalities, of slips, of ties
  std::vector<Origin> origins;     ///< of each of these; a row that two effects ask for is the first one's
  /// Of each row the part of its bound that goes with the history of its effect; bounds are those of
  /// factor 1.
  std::vector<double> moving;
  std::vector<std::string> notes; ///< what the user should know; sentences
};

/// Where effects put their constraints, and what they need to find them. Every row is told apart from those
/// of all effects before.
class ConstraintCollector {
 public:
  /// All of these have to outlive it.
  ConstraintCollector(const Teuchos::Comm<int>& comm, const Scene& scene,
                      const std::vector<OwnedSubdomain>& owned, EffectCosts& costs);
  /// Of bodies that have moved.
  struct AtRest {
    const std::vector<OwnedSubdomain>& owned; ///< as they were
    /// Points of this rank; null: those that touch.
    const std::vector<ContactSetup::Pairing>* bound = nullptr;
  };
  ConstraintCollector(const Teuchos::Comm<int>& comm, const Scene& scene,
                      const std::vector<OwnedSubdomain>& moved, EffectCosts& costs, const AtRest& atRest);

  // For effects.

  /// Whether nodes have one dof, and normals play no part.
  bool isScalar() const { return scene_.components() == 1; }
  bool isAroundAxis() const { return scene_.physics == Physics::Axisymmetric; }
  /// Whether bodies are at finite displacements, or will be.
  bool isOfFinite() const { return scene_.isFinite(); }
  /// Whether surfaces are those of deformed bodies, which may be apart for a while; those of ties are not.
  bool isOfMoved() const { return places_.atRest && asked_ != nullptr && !asked_->tiesSurfaces(); }

  /// A boundary part: the piece that is on this rank; see contact::gatherSurface(). @note Collective.
  contact::Surface surface(int body, const std::string& set,
                           const contact::NormalField& normal = nullptr) const;
  /// The same of the bodies at rest. @note Collective.
  contact::Surface surfaceAtRest(int body, const std::string& set) const;

  /// This rank's subdomains of a body.
  std::vector<const fem::PlacedMesh*> subdomainsOf(int body) const { return partsOfAsked().of(body); }

  /// A node at which an effect that was asked before has a point between the same two bodies.
  struct Taken {
    fem::Point normal; ///< of that point
    bool isTied;       ///< by it, whatever the normal
    int effect;        ///< which: how many were asked before
  };
  /// Of each of these nodes. Rows of two effects would hold the same jump, and how they shared its force were
  /// arbitrary: such a node belongs to the first effect, ties before contacts.
  /// @param nodes of this rank, of either body. @note Collective.
  std::vector<std::optional<Taken>> taken(int body, int other, const std::vector<long long>& nodes) const;

  /// Inequality rows n·w ≤ gap, one a point, of this rank's points: each point on one rank alone.
  /// @param surfaces that the points belong to, body and boundary part: where they are not given, friction
  /// does not know where both sides are held. @note On every rank.
  void addContacts(const std::vector<contact::ContactPoint>& points,
                   const std::vector<std::pair<int, std::string>>& surfaces = {});

  /// Equality rows w_c = 0, one a point and component; points as above. Where both sides end on prescribed
  /// displacements rows are left out, see contact::tieRows().
  /// @param surfaces that the points belong to: body and boundary part.
  /// @note On every rank.
  void addTies(const std::vector<contact::ContactPoint>& points,
               const std::vector<std::pair<int, std::string>>& surfaces);

  using Node = EquationRows::Node;
  /// The node of each of these parts, on all ranks.
  /// @param parts body and boundary part. @throws InputError on all ranks for a part of several nodes.
  /// @note Collective.
  std::vector<Node> nodesOf(const std::vector<std::pair<int, std::string>>& parts);

  /// Of each node of the bodies.
  int components() const { return scene_.components(); }
  /// Of a part that an effect measures, see Effect::BoundaryPart; the same on all ranks. @note Collective.
  PartMeasure measureOf(int body, const std::string& set) const;
  /// The same of the bodies at rest. @note Collective.
  PartMeasure measureAtRest(int body, const std::string& set) const;
  /// All nodes of a part, by their numbers, on all ranks. @note Collective.
  std::vector<Node> allNodesOf(int body, const std::string& set);
  /// The same of the bodies at rest. @note Collective.
  std::vector<Node> allNodesAtRest(int body, const std::string& set) const;
  /// Whether a component is prescribed at any node of a part, at any time. @note Collective.
  bool isHeldAnywhere(int body, const std::string& set, int component);

  using Equation = EquationRows::Equation;
  /// An equality row Σ coefficient · displacement = value. Where all of its dofs are prescribed it is left
  /// out. @note The same on every rank.
  void addEquation(const Equation& equation) { equations_.add(equation, *asked_); }

  /// Friction at the points of a contact or an obstacle: rows t·w = 0, whose force is limited by the bound
  /// times the area of the point. A point of two contacts bears the first friction alone. In directions in
  /// which both sides are held there is none, see contact::slipDirections().
  /// @param contact an effect of the scene, asked before or after. @param bound force per area, not negative,
  /// by position; asked by finish(). @note Collective.
  void addFriction(const Effect& contact, std::function<double(const fem::Point&)> bound) {
    addFriction({&contact, asked_, std::move(bound), false});
  }
  /// The same, limited by a multiple of the force of contact at the point.
  /// @param coefficient not negative, by position. @note Collective.
  void addFrictionByPressure(const Effect& contact, std::function<double(const fem::Point&)> coefficient) {
    addFriction({&contact, asked_, std::move(coefficient), true});
  }

  /// What adhesion is, at a point of an interface.
  struct Glue {
    double normal, tangential; ///< force per area and opening, above 0
    /// Of a law that softens, min G/σ²: times E the length over which a crack does so, which points have to
    /// resolve.
    double toughness = 0.0;
  };

  /// Springs at those points of a contact or an obstacle where the surfaces touch (contact::touches()): the
  /// softness of its row, and of rows t·w = 0 in each direction in which it may slip; those of friction,
  /// where that acts on it, else such of limit 0. A point of two contacts has the first springs alone. A note
  /// tells how many there are.
  /// @param contact an effect of the scene, asked before or after. @note Collective.
  void addAdhesion(const Effect& contact, const Glue& glue);

  /// What the user should know; a sentence.
  void note(const std::string& text) { notes_.push_back(text); }

  // For the run.

  /// Asks an effect. @note Collective.
  void collect(const Effect& effect);

  /// See FiniteBehaviour::fault(). @note Collective.
  std::string faultOf(const Effect& effect);

  /// All that was collected; the collector is empty then.
  /// @throws InputError on all ranks if a tie or an equation contradicts prescribed displacements.
  /// @note Collective.
  ContactSetup finish();

 private:
  using Part = std::pair<int, std::string>;
  void addContactRows(ContactSetup& setup, double extent);
  void findSlips(ContactSetup& setup);
  void findBonds(ContactSetup& setup, double extent);
  double gapAtBegin(std::size_t point) const;
  void requireOneInterference() const;
  void numberSlips(ContactSetup& setup) const;
  void addSlipRows(ContactSetup& setup, double extent);
  void count(ContactSetup& setup) const;
  void soften(ContactSetup& setup) const;
  void loosenHeldRows(ContactSetup& setup, double extent) const;
  void addTieRows(ContactSetup& setup);
  void addEquationRows(ContactSetup& setup);
  void findHeldDofs();
  struct Friction {
    const Effect *contact, *effect;
    std::function<double(const fem::Point&)> value; ///< a bound, or
    bool isByPressure;                              ///< a coefficient
  };
  void addFriction(Friction friction);
  struct Adhesion {
    const Effect *contact, *effect;
    Glue glue;
  };
  void tellOfProcessZone(const Adhesion& adhesion, long long bound, double area);
  bool isAlong(const Effect* contact) const;
  void take(const std::vector<contact::ContactPoint>& points, const std::vector<Part>& surfaces, bool isTied);
  void askForHeldDofs(const std::vector<std::pair<int, std::string>>& surfaces) {
    heldParts_.insert(surfaces.begin(), surfaces.end());
  }

  const Teuchos::Comm<int>& comm_;
  const Scene& scene_;
  EffectCosts& costs_;
  SubdomainEffects effects_;
  using PointKey = std::tuple<const Effect*, long long, int>; // contact, node, side
  struct Places {
    PartsOfRank now;
    std::optional<PartsOfRank> atRest = std::nullopt; // of bodies that have moved
    std::optional<std::map<PointKey, const ContactSetup::Pairing*>> bound = std::nullopt;
  };
  const ContactSetup::Pairing* pairingOf(const Effect& contact, const contact::ContactPoint& point) const;
  std::vector<fem::Point> tangentsOf(std::size_t point) const;
  bool binds(std::size_t point, double extent) const;
  void keepPairings(const std::vector<Part>& surfaces, std::vector<contact::ContactPoint>& points) const;
  const PartsOfRank& partsOfAsked() const { return isOfMoved() ? places_.now : partsAtRest(); }
  const PartsOfRank& partsAtRest() const { return places_.atRest ? *places_.atRest : places_.now; }
  Places places_;
  const Effect* asked_ = nullptr;
  int askedBefore_ = -1;
  DistinctPoints contacts_, ties_;
  std::vector<Friction> frictions_;
  std::vector<Adhesion> adhesions_;
  EquationRows equations_;
  std::vector<std::size_t> slipOrder_; // of each slip: place of what asked for it, friction before adhesion
  std::map<const Effect*, std::vector<Part>> surfacesOf_; // of contacts
  std::set<Part> heldParts_;                              // where ties are, equations, and limited rows
  std::map<double, contact::HeldDofs> held_;              // of dofs of this rank's points there, by time
  std::map<std::pair<int, int>, std::vector<std::pair<long long, Taken>>> taken_; // of this rank, by bodies
  std::vector<std::string> notes_;
};

} // namespace Harmos::scene
