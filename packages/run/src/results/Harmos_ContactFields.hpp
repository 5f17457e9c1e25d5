// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactPoint.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_KktAudit.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::run {

/// Of a contact point: without friction, or what that does.
enum class Friction : unsigned char { None, Sticks, Slips };

/// The state of a contact point in the solution.
struct ContactState {
  double pressure; ///< see tractions(); of springs that hold force per tributary area
  double force;
  double gap; ///< that is left
  bool closed;
  Friction friction = Friction::None;
  fem::Point traction{};        ///< of friction or springs, on the first body: likewise
  fem::Point tangentialForce{}; ///< of the same
  fem::Point slip{};            ///< of the first body against the second, since the beginning of the run
  // Of points that adhesion binds, or has bound.
  bool isBound = false;
  double damage = 0.0;
  fem::Point jump{}; ///< of the first body against the second: the slip, and the opening along the normal
  fem::Point wholeTraction{}; ///< of all that acts at the point, on the first body: force per tributary area
};

/// Of this rank's points, in their order.
/// @note Collective: rows are where their subdomains are, points where they were found.
std::vector<ContactState> contactStates(const Teuchos::Comm<int>& comm,
                                        const std::vector<contact::ContactPoint>& points,
                                        const feti::ContactState& state);

/// Forces per area at this rank's points, from forces of points: by contact::ContactPoint::pressure, else per
/// tributary area. @note Collective: some of them are found on other ranks.
/// Guarded by tests/verification/test_contact_patch.cpp.
std::vector<fem::Point> tractions(const Teuchos::Comm<int>& comm,
                                  const std::vector<contact::ContactPoint>& points,
                                  const std::vector<fem::Point>& forces);

/// How many points there are of what kind, over all ranks.
struct ContactCounts {
  long long points = 0, closed = 0, sticking = 0, slipping = 0;
  long long broken = 0, damaged = 0; ///< of those that adhesion binds
};
/// @note Collective.
ContactCounts countContact(const Teuchos::Comm<int>& comm, const std::vector<ContactState>& states);

/// Points and states of all ranks, by the numbers of the points.
struct WholeContact {
  std::vector<contact::ContactPoint> points;
  std::vector<ContactState> states;
};
/// On every rank, for what looks at an answer as a whole: comparisons and tests. @note Collective.
WholeContact gatherContact(const Teuchos::Comm<int>& comm, const std::vector<contact::ContactPoint>& points,
                           const std::vector<ContactState>& states);

/// Contact results at the nodes of this rank's subdomains, for output.
struct ContactFields {
  feti::TornVector pressure;                         ///< 0 where no point is
  feti::TornVector gap;                              ///< that is left, 0 where no point is
  std::vector<std::vector<unsigned char>> activeSet; ///< 0 where no point is, 1 open, 2 closed (force > 0)
  // Of scenes with friction only.
  feti::TornVector traction, slip;                  ///< three numbers a node
  std::vector<std::vector<unsigned char>> friction; ///< 0 none, 1 sticks, 2 slips
  // Of scenes with adhesion only.
  std::vector<std::vector<unsigned char>> bound; ///< 1 where adhesion acts, broken or not; plain contact is 0
  feti::TornVector damage;                       ///< 0 where nothing is bound
  feti::TornVector jump, interfaceTraction;      ///< three numbers a node; 0 where nothing is bound
};

/// Which fields there are: a matter of the scene, the same for all of its steps.
struct ContactFieldKinds {
  bool friction = false, adhesion = false;
};

/// Brings the states to the nodes; every copy of a node gets the same values. With node to node contact both
/// sides have them, with mortar coupling the side that carries the multipliers; a node of that
/// which belongs to another effect shows the pressure next to it, and no state. Tractions, slips and jumps on
/// the second side are the negative ones.
/// @param points, states of this rank. @note Collective: points meet those who have their nodes.
ContactFields contactFields(const Teuchos::Comm<int>& comm, const std::vector<scene::OwnedSubdomain>& owned,
                            const std::vector<contact::ContactPoint>& points,
                            const std::vector<ContactState>& states, ContactFieldKinds kinds = {});

} // namespace Harmos::run
