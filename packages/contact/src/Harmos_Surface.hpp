// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoxTree.hpp"
#include "Harmos_Mesh.hpp"

#include <Teuchos_Comm.hpp>

#include <functional>
#include <string>
#include <vector>

namespace Harmos::contact {

/// Unit outward normal at a point of a boundary part, where the geometry is known: the radial direction of a
/// generated circle for instance.
using NormalField = std::function<fem::Point(const fem::Point&)>;

/// A named boundary part of a body: the piece of it that lies on this rank's subdomains, and the facets of
/// other ranks around that. What is said of the whole is the same on every rank.
///
/// Normals are averaged over the facets around a node, weighted by their area, over all subdomains and the
/// named part alone: so they do not depend on the decomposition, and an edge between two parts has a normal
/// in each. Facets follow each other by their node numbers, and sums go over all facets of a node in that
/// order: a node has the same position, normal and area, to the last bit, on all ranks and on any number of
/// them.
struct Surface {
  std::string name;               ///< for messages: "ring/inner"
  int dimension = 0;              ///< of the space: 2 or 3
  fem::CellType facetType{};      ///< of its facets
  bool isAxisymmetric = false;    ///< in the meridian plane: integrals go around the axis, see fem::Mesh
  std::vector<long long> numbers; ///< global node numbers, rising: of the nodes of all facets that are here
  std::vector<fem::Point> positions; ///< of each node
  std::vector<fem::Point> normals;   ///< of each node, outward, of length one
  std::vector<double> areas; ///< ∫ φ_i: lengths in the plane (per unit thickness); axisymmetric: areas; 0 at
                             ///< the corners of straight triangles of six nodes
  std::vector<int> facets;      ///< nodes (places in numbers) of each facet, in the order of its shape,
                                ///< seen from outside
  std::vector<char> isOwnFacet; ///< 1: of a subdomain of this rank
  std::vector<char> isOwnNode;  ///< 1: this rank makes the contact point of the node; a node is one rank's
                                ///< own, and that has all facets around it
  /// Where the surface has sharp edges: the normal at each node of each facet, in the order of facets, which
  /// is that of the smooth side of the node that the facet belongs to. Empty without sharp edges.
  std::vector<fem::Point> sideNormals;

  const Teuchos::Comm<int>* comm = nullptr; ///< of all ranks that have a piece, or none
  long long wholeNodes = 0;                 ///< of all of it
  fem::Box wholeBox;                        ///< around these

  int numberOfNodes() const { return static_cast<int>(numbers.size()); }
  int nodesPerFacet() const { return fem::shapeOf(facetType).nodes; }
  int numberOfFacets() const { return static_cast<int>(facets.size()) / nodesPerFacet(); }
};

/// Whether a constant pressure has forces at corners that are no pushes: quadrilaterals of eight nodes, where
/// it pulls; lines of three nodes around an axis, which have none on it. Rows of contact are those of the
/// carriers then, see Carriers.
inline bool hasCarrierRows(const Surface& surface) {
  return surface.facetType == fem::CellType::Quadrilateral8 ||
         (surface.isAxisymmetric && surface.facetType == fem::CellType::Line3);
}

/// Gathers the pieces of a boundary part. Nodes meet at a rank that follows from their number, which tells
/// who else has them; facets at such nodes go from rank to rank. Memory and time go with the piece.
/// @param comm to outlive the surface. @param parts this rank's subdomains of the body. @param field null:
/// averaged facet normals.
/// @throws InputError on all ranks if the part is empty, has facets of different types, is not a manifold
///         (more than two facets at an edge, in the plane more than two at a node, or two that look to
///         opposite sides; named by position), or has a facet without area, if a node's averaged normal
///         vanishes, or if the field does not look outward.
/// @note Collective.
/// Guarded by tests/unit/contact/test_surface.cpp and tests/unit/contact/test_pieces.cpp.
Surface gatherSurface(const Teuchos::Comm<int>& comm, const std::vector<const fem::PlacedMesh*>& parts,
                      const std::string& set, const std::string& name, const NormalField& field = nullptr);

/// The facets of a surface that touch boxes, in the order of the whole surface, with the nodes of these
/// alone, their normals among them: from whatever ranks they are on. Ranks whose facets are nowhere near say
/// nothing to each other.
/// @param boxes this rank's. @note Collective; boxes of the ranks' pieces are known to all.
Surface facetsTouching(const Surface& surface, const std::vector<fem::Box>& boxes);

/// Of points of a facet; those of second order bulge beyond the box of their nodes, by at most a quarter of
/// its size. @param points more that the box is to hold.
fem::Box boxOfFacet(const Surface& surface, int facet, std::vector<fem::Point> points = {});

/// Facets that meet at more than this angle make a sharp edge: circles of seven facets are round.
constexpr double sharpestAngle = 60.0 / 180.0 * 3.14159265358979323846;

/// The surface with its smooth sides apart: a node on a sharp edge stands once for each side
/// (Surface::numbers repeats it, in the order of the first facet of each side), with the normal and the area
/// of that side alone. The surface itself where nothing is sharp. Local; right at the nodes of own facets.
/// Guarded by tests/unit/contact/test_surface_sides.cpp.
Surface splitAtEdges(const Surface& surface);

/// Cosine of the angle beyond which a facet does not face what is opposite: 84 degrees. Projections are ill
/// conditioned there, and no pressure passes.
constexpr double leastFacing = 0.1;

/// How far a surface of straight-edged facets stays behind the curved one through its nodes, at most: Lθ/8
/// for an edge of length L over which the normal turns by θ, the sagitta of an arc. 0 for facets of second
/// order and plane surfaces; edges that turn by more than 30° are corners. @note Collective.
double sagitta(const Surface& surface);

/// The part of the surface that belongs to each node: a measure of area that is positive everywhere. As
/// Surface::areas, but for the corners of triangles of six nodes, from the functions that are linear on the
/// four triangles which the nodes cut each facet into. Right at the nodes of own facets. Local.
/// @param towards of each node the direction of what it may touch: facets that do not face it (leastFacing)
/// bear no pressure and do not count, unless none of the node does. Not given: all count.
std::vector<double> tributaryAreas(const Surface& surface, const std::vector<fem::Point>& towards = {});

} // namespace Harmos::contact
