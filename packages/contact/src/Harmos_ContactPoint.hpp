// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_Surface.hpp"

#include <Teuchos_Comm.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::contact {

/// A place where two surfaces, or a surface and an obstacle, may touch: one inequality row.
///
/// With the relative displacement w = Σ weight · u(node): normal · w ≤ gap. The weights of the first surface
/// (the one that carries the multipliers, "slave" in the literature) sum to 1, those of the second one to −1.
/// Of the first surface it is the node itself that counts, on edges of second order its corners too.
struct ContactPoint {
  struct Term {
    long long node;
    double weight;
  };
  /// Part of a contact pressure, see pressure.
  struct PressureTerm {
    long long node;   ///< of a point of the same effect,
    int side;         ///< and its side;
    long long number; ///< that point's, once it has one
    double weight;    ///< pressure by force
  };
  long long node = 0;      ///< of the first surface, which the point belongs to
  int side = 0;            ///< which of the smooth sides of that node, at sharp edges
  long long number = -1;   ///< of its row, over all ranks; −1: it has none yet
  fem::Point position{};   ///< of that node
  std::vector<Term> terms; ///< by rising node number
  fem::Point normal{};     ///< outward from the first surface
  double gap = 0.0;        ///< initial distance along the normal; negative: penetration
  /// The part of a penetration that goes with a history; gap is that of the factor 1.
  double interference = 0.0;
  double area = 0.0;       ///< tributary area, positive
  double compliance = 0.0; ///< penetration by force; 0: none gives way
  /// Contact pressure = Σ weight · force; empty: force of the row / area. See setPressures().
  std::vector<PressureTerm> pressure{};
  /// Nodes beside it that have no point of their own, where another effect or both surfaces have them: the
  /// pressure there is the mean of those of the points, by these weights.
  std::vector<Term> beside{};
};

/// What pressures and tractions follow from, where forces of nodes are not the pressure times an area that is
/// positive: on triangles of six nodes a constant pressure p has the forces p∫φ_k, none of them at corners.
/// Tested with the carriers φ̃ of mortar coupling (Carriers), which are all positive,
///
///     p_k = ∫φ̃_k p / ∫φ̃_k,  ∫φ̃_k p = f_k + s Σ_e f_e at a corner k with its edges e, (1 − 2s) f_k at edges,
///
/// a mean of the pressure around the node: right for constants, no larger than the largest pressure, and
/// positive where forces are. Other facets are left as they are.
/// @param surface with its sides apart where points have these. @param towards as with tributaryAreas().
/// @param points of this rank's own nodes. Local.
/// Guarded by tests/verification/test_contact_patch.cpp and tests/verification/interfaces/test_interfaces.py.
void setPressures(const Surface& surface, const std::vector<fem::Point>& towards,
                  std::vector<ContactPoint>& points);

/// Nodes within this, relative, are at the same place.
constexpr double samePlace = 1e-9;

/// Where two surfaces touch initially in nodes of the same position: u¹ − u² at each pair.
///
/// The normal is that of the first surface, averaged with the opposite one of the second surface; the area
/// that of tributaryAreas().
/// @param tolerance of the positions, relative to the extent of the surfaces and their distance from the
/// origin.
/// A node of both surfaces, as at the tip of a crack, is in contact with itself and has no point. At sharp
/// edges each smooth side has a point of its own, as with mortarPoints().
/// @return those of this rank's own nodes of the first surface, by node number.
/// @throws InputError on all ranks if a node of either has no partner, naming it, or if both surfaces look
/// the same way there.
/// @note Collective: see facetsTouching().
/// Guarded by tests/unit/contact/test_match_nodes.cpp.
/// @param joinsEdges one point a node at sharp edges too, see MortarOptions.
std::vector<ContactPoint> matchNodes(const Surface& first, const Surface& second,
                                     double tolerance = samePlace, bool joinsEdges = false);

/// matchNodes() where each node of both has a partner, and each facet, else nothing: node to node forces of a
/// constant pressure are equal on equal facets alone. @note Collective.
std::optional<std::vector<ContactPoint>> matchNodesIfAll(const Surface& first, const Surface& second,
                                                         double tolerance = samePlace,
                                                         bool joinsEdges = false);

/// Mortar coupling of surfaces that need not match, with dual Lagrange multipliers (Wohlmuth 2000; Popp,
/// Gitterle, Gee, Wall 2010): a point for each node i of the first surface,
///
///     w_i = Σ_j D_ij u_j − Σ_k M_ik u_k, divided by their sum D_i,
///     D_i = ∫φ̃_i,   D_ij u_j = D_i ũ_i,   M_ik = ∫ψ_i φ_k∘χ,
///
/// gap_i = ∫ψ_i g / D_i, all integrals over the part of the first surface that has a counterpart: ψ_i, dual
/// to the carriers φ̃_i, are made there too (Cichosz & Bischoff 2011), so that the patch test holds at the
/// ends of the surfaces. ũ_i is the coefficient of φ̃_i in u, on facets of first order u_i; see Carriers. The
/// area of a point is D_i, its normal that of the node. In the plane edges are cut at projections of nodes
/// along the averaged normals; in space facets are clipped against each other in the plane of the facet of
/// the first surface (Puso & Laursen 2004).
///
/// Linear displacements of flat surfaces are reproduced to rounding, whatever the quadrature, for ψ_i are
/// dual in the sums of the very same quadrature; rigid translations always. Gaps of curved surfaces converge
/// with h², those of second order faster, down to the error O(gap² h²) of projecting a facet along one
/// normal.
///
/// Nodes with weights above 1e4 give no point: those at the far end of a facet that is covered by less than
/// 1e-4 of its length, on facets of second order by less than some hundredths. A constant pressure has its
/// exact resultant but for them.
///
/// Cost: proportional to the number of this rank's own facets of the first surface and those of the second
/// one near them, but for the search, which is O(n log n). 20 000 facets of each surface take less than a
/// second on one rank. A facet between ranks is sampled by each rank that makes a point of one of its nodes:
/// so a point is the same, to the last bit, on any number of ranks.
///
/// @param reach counterparts farther than this are none; 0: a tenth of the extent of the smaller surface.
/// @return those of this rank's own nodes of the first surface, by node number; nodes without a counterpart
/// give none.
/// @throws InputError on all ranks if no node has a counterpart (the pair never meets), for surfaces whose
/// facets are not
///         supported, for surfaces of different dimensions and a negative reach, and for facets too distorted
///         to be projected.
/// @note Collective.
/// Guarded by tests/unit/contact/test_mortar_plane.cpp, tests/unit/contact/test_mortar_space.cpp and, on
/// several ranks, tests/unit/contact/test_pieces.cpp.
/// At sharp edges of the first surface (sharpestAngle) each smooth side has a point of its own, with its own
/// normal: sides that meet nothing have none, and do not turn the normals of those that do.
std::vector<ContactPoint> mortarPoints(const Surface& first, const Surface& second, double reach = 0.0);

struct MortarOptions {
  double reach = 0.0; ///< see above
  /// One point a node at sharp edges too, for couplings to which normals do not matter.
  bool joinsEdges = false;
  /// Nodes of the first surface that have no multiplier, rising: those of both surfaces, and those that
  /// another effect holds; see FacetMultipliers. They have no point.
  std::vector<long long> without{};
  /// Surfaces that do not meet have no points, in the place of an error.
  bool mayBeApart = false;
};
std::vector<ContactPoint> mortarPoints(const Surface& first, const Surface& second,
                                       const MortarOptions& options);

/// The reach of a mortar coupling: as given, else a tenth of the extent of the smaller surface.
double reachOf(const Surface& first, const Surface& second, double given);

/// Of each node of the first surface that is here, whether it belongs to both surfaces, as at the tip of a
/// crack. @note Collective.
std::vector<char> isShared(const Surface& first, const Surface& second);

/// A rigid body, at rest.
struct Obstacle {
  enum class Shape { HalfSpace, Cylinder, Sphere };
  Shape shape = Shape::HalfSpace;
  fem::Point point{};     ///< on the plane; on the axis; the centre
  fem::Point direction{}; ///< outward normal of the half-space; of the axis; not used by spheres. In the
                          ///< plane cylinders have the axis (0, 0, 1)
  double radius = 0.0;    ///< negative: the elastic body is inside of a hollow cylinder or sphere
};

/// Contact with a rigid obstacle: n·u ≤ gap at each node of the surface, n the direction towards the
/// obstacle at the initial position of the node, gap its distance. Where a constant pressure does not push at
/// all corners (hasCarrierRows()), rows are those of the coefficients of the carriers (Carriers).
/// @return those of this rank's own nodes, by node number; areas from tributaryAreas().
/// @throws InputError on all ranks for a direction of length zero, a radius of zero, and a node at the
/// centre.
/// @note Collective.
/// Guarded by tests/unit/contact/test_obstacle.cpp.
std::vector<ContactPoint> obstaclePoints(const Surface& surface, const Obstacle& obstacle);

/// Points from rank to rank, as exchangeItems(). @note Collective.
std::vector<std::vector<ContactPoint>> exchangePoints(const Teuchos::Comm<int>& comm,
                                                      const std::vector<std::vector<ContactPoint>>& sends);
/// All of them on every rank, by their numbers. @note Collective.
std::vector<ContactPoint> gatherPoints(const Teuchos::Comm<int>& comm,
                                       const std::vector<ContactPoint>& points);

/// Rows n·w ≤ gap, one a point, with the point's number.
/// @param components dofs a node: dof = node · components + component; 1 for scalar problems, where w is the
///        displacement itself and the normal plays no part. Components of a normal that are rounding errors
///        (below 1e-14) give no terms.
/// @param extent of all points, see extentOf(): gaps are known to its rounding errors. Local.
/// Guarded by tests/unit/contact/test_contact_rows.cpp.
std::vector<ConstraintRow> contactRows(const std::vector<ContactPoint>& points, int components,
                                       double extent);

/// A contact point that bears friction, or is bound along the surfaces.
struct SlipPoint {
  std::size_t point = 0;            ///< its place among the contact points of this rank
  std::vector<fem::Point> tangents; ///< one or two, orthonormal to the normal and each other
  long long firstRow = 0;           ///< the number of its first row, over all ranks: one for each tangent
  std::size_t firstPlace = 0;       ///< of that row, among those of this rank
  double limit = 0.0;               ///< of its force, where that is given
  bool follows = false;             ///< or the limit follows the force of contact:
  double coefficient = 0.0;         ///< limit over that
  bool hasFriction = true;          ///< or has a limit of zero, once it is not bound any more
};

/// Whether the surfaces touch at a point with this gap: it is zero to what matchNodes() takes for the same
/// place.
/// @param extent the largest coordinate of all the points that it is one of.
bool touches(double gap, double extent);
/// That coordinate. @note Collective.
double extentOf(const Teuchos::Comm<int>& comm, const std::vector<ContactPoint>& points);

/// Dofs with prescribed values, and these.
using HeldDofs = std::map<long long, double>;

/// In which directions a point may slip: in the plane e_z × n; in space n × of the axis that is farthest from
/// n, and what is across both.
///
/// Where both sides are held alike in a direction, as at a plane of symmetry that goes through the contact,
/// nothing slips and friction, were it there, would act on what little the counterparts have beside the
/// plane. It has no part in that direction: in space one tangent is left, or none.
/// @param held at each time that matters. Held alike: see tieRows(), and all by the same value; by none on an
/// obstacle. A direction counts that is at least 60° from the normal.
/// Guarded by tests/unit/contact/test_contact_rows.cpp.
std::vector<fem::Point> slipDirections(const ContactPoint& point, int components,
                                       const std::map<double, HeldDofs>& held);

/// Rows t·w = 0 whose force is limited, numbered by SlipPoint::firstRow: one a tangent, where there are two
/// they have one disc. In the order of slips and tangents.
/// @param points of this rank. @param components two or three. @param extent see contactRows(). Local.
/// Guarded by tests/unit/contact/test_contact_rows.cpp.
std::vector<ConstraintRow> slipRows(const std::vector<ContactPoint>& points,
                                    const std::vector<SlipPoint>& slips, int components, double extent);

/// The components c of a point for which a tie has a row w_c = 0.
/// @param held dofs with prescribed values, and these. A row whose own dof is held is left out if the weights
///        of its dofs that are not sum up to at most a half: both surfaces end there on a held boundary, and
///        what the row has beside them, the small weights of nodes further inside, would hold those too, with
///        a force that nothing determines.
/// @throws InputError if a row that is left out has prescribed values alone and they differ, naming the node.
///         Local.
std::vector<int> tiedComponents(const ContactPoint& point, int components, const HeldDofs& held = {});

/// That row. Local.
ConstraintRow tieRow(const ContactPoint& point, int component, int components, long long number);

} // namespace Harmos::contact
