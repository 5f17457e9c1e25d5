// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <Teuchos_Comm.hpp>

#include <functional>
#include <string>
#include <vector>

namespace Harmos::contact {

/// Unit outward normal at a point of a boundary part, where the geometry is known: the radial direction of a
/// generated circle for instance.
using NormalField = std::function<fem::Point(const fem::Point&)>;

/// A named boundary part of a body, whole, the same on every rank. Its size is that of a boundary, not of a
/// body.
///
/// Normals are averaged over the facets around a node, weighted by their area, over all subdomains and the
/// named part alone: so they do not depend on the decomposition, and an edge between two parts has a normal
/// in each.
struct Surface {
  std::string name;                  ///< for messages: "ring/inner"
  int dimension = 0;                 ///< of the space: 2 or 3
  fem::CellType facetType{};         ///< of its facets
  std::vector<long long> numbers;    ///< global node numbers, rising
  std::vector<fem::Point> positions; ///< of each node
  std::vector<fem::Point> normals;   ///< of each node, outward, of length one
  std::vector<double> areas; ///< ∫ φ_i: lengths in the plane (per unit thickness); 0 at the corners of
                             ///< straight triangles of six nodes
  std::vector<int> facets;   ///< nodes (places in numbers) of each facet, in the order of its shape,
                             ///< seen from outside

  int numberOfNodes() const { return static_cast<int>(numbers.size()); }
  int nodesPerFacet() const { return fem::shapeOf(facetType).nodes; }
  int numberOfFacets() const { return static_cast<int>(facets.size()) / nodesPerFacet(); }
};

/// Gathers a boundary part on every rank.
///
/// Facets are ordered by their node numbers, so that the answer does not depend on the decomposition or the
/// number of ranks, but for rounding in sums.
/// @param parts this rank's subdomains of the body. @param field null: averaged facet normals.
/// @throws InputError on all ranks if the part is empty, has facets of different types, is not a manifold
///         (more than two facets at an edge, in the plane more than two at a node, or two that look to
///         opposite sides; named by position), or has a facet without area, if a node's averaged normal
///         vanishes, or if the field does not look outward.
/// @note Collective.
/// Guarded by tests/unit/contact/test_surface.cpp.
Surface gatherSurface(const Teuchos::Comm<int>& comm, const std::vector<const fem::PlacedMesh*>& parts,
                      const std::string& set, const std::string& name, const NormalField& field = nullptr);

/// The part of the surface that belongs to each node, for contact pressures: force of a node / area. As
/// Surface::areas, but with positive areas for the corners of triangles of six nodes, from the functions that
/// are linear on the four triangles which the nodes cut each facet into. Local.
std::vector<double> tributaryAreas(const Surface& surface);

} // namespace Harmos::contact
