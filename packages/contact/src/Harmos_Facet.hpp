// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ReferenceElement.hpp"
#include "Harmos_Surface.hpp"

#include <array>
#include <utility>
#include <vector>

namespace Harmos::contact {

/// A place on the reference facet; lines use the first number only.
using FacetPlace = std::array<double, 2>;

constexpr std::size_t maxFacetNodes = 9;

/// Basis functions of a facet at one place, and their reference gradients.
struct FacetBasis {
  std::array<double, maxFacetNodes> values{};
  std::array<FacetPlace, maxFacetNodes> gradients{};
};

/// The same functions as fem::basisValues() and basisGradients(), without a view and an allocation for each
/// call: projections ask for one place at a time, very often.
/// Guarded by tests/unit/contact/test_surface.cpp, against Intrepid2.
FacetBasis facetBasis(fem::CellType type, const FacetPlace& at);

/// The functions that carry the multipliers of mortar coupling on a facet: those of the facet on facets of
/// first order; on those of second order, of which some have no area or a negative one, every edge gives a
/// share s of its function to each of its two corners,
///
///     φ̃_c = φ_c + Σ s_e φ_e,   φ̃_e = (1 − 2s_e)φ_e,
///
/// a local change of basis (Popp, Wohlmuth, Gee, Wall, SIAM J. Sci. Comput. 34, 2012, who take 1/5). With a
/// share of 1/4, and the function in the middle of a quadrilateral shared likewise, they are the Bernstein
/// polynomials, which are nowhere negative: so on facets that are covered in part. Corner functions of
/// quadrilaterals of eight nodes, ¼(1 + x)(1 + y)((1 − 2s)(x + y) + 4s − 1), are nowhere negative from 3/8
/// on. Guarded by tests/unit/contact/test_surface.cpp.
class Carriers {
 public:
  /// Of facets that are covered as a whole. Triangles of six nodes, the area of whose corner functions is
  /// zero, take 1/10: between 1/20 and 1/4 that has the smallest errors of smooth solutions and the fewest
  /// products (tests/verification/test_mortar_pairs.cpp; 40 to 43 on half a ball on a block, with 1/4 45 to
  /// 56). Quadrilaterals of eight nodes, whose corner functions have −1/12 of the area, take 1/5, as do lines
  /// around an axis, whose functions on it have none. Other facets of second order have positive areas as
  /// they are.
  static double usualShare(fem::CellType type, bool isAxisymmetric = false) {
    const bool pulls =
        type == fem::CellType::Quadrilateral8 || (isAxisymmetric && type == fem::CellType::Line3);
    return type == fem::CellType::Triangle6 ? 0.1 : pulls ? 0.2 : 0.0;
  }
  static double partialShare(fem::CellType type) {
    return type == fem::CellType::Quadrilateral8 ? 0.375 : 0.25;
  }

  /// @param shares of the edge nodes, in their order. @param isPartial whether the facet is covered in part;
  /// then all of its shares are partialShare().
  Carriers(fem::CellType type, const std::array<double, 4>& shares, bool isPartial);
  /// Of a facet that is covered as a whole, like its neighbours.
  explicit Carriers(fem::CellType type, bool isAxisymmetric = false);

  /// Their values at a place, from those of the functions of the facet.
  std::array<double, maxFacetNodes> values(const std::array<double, maxFacetNodes>& lagrange) const;
  /// The coefficient of carrier k of a function, of its values at the nodes: on an edge from a to b
  /// (u_k − s(u_a + u_b))/(1 − 2s). Pairs of node of the facet and weight, which sum to 1.
  std::vector<std::pair<std::size_t, double>> coefficient(std::size_t k) const;

 private:
  std::array<std::size_t, 2> endsOf(std::size_t edgeNode) const;
  double share(std::size_t edgeNode) const { return shares_[edgeNode - corners_]; }

  std::size_t size_, corners_, edges_; // nodes in all, and of each kind; one more may be in the middle
  std::array<double, 4> shares_;
  double toCorner_ = 0.0, toEdge_ = 0.0; // of the function in the middle
};

/// The middle of the reference facet.
FacetPlace facetCentre(fem::CellType type);

/// One facet of a surface. Holds a reference to it.
class Facet {
 public:
  struct State {
    FacetBasis basis;
    fem::Point position{};
    std::array<fem::Point, 2> tangents{};
    fem::Point areaNormal{}; ///< outward; its length is the measure of the facet by that of the reference one
    double measure = 0.0;    ///< that length; axisymmetric: times that of the circle, 2πx
  };

  Facet(const Surface& surface, int facet)
      : surface_(surface),
        nodes_(surface.facets.data() +
               static_cast<std::size_t>(facet) * static_cast<std::size_t>(surface.nodesPerFacet())) {}

  std::size_t size() const { return static_cast<std::size_t>(surface_.nodesPerFacet()); }
  std::size_t corners() const { return static_cast<std::size_t>(fem::shapeOf(surface_.facetType).corners); }
  fem::CellType type() const { return surface_.facetType; }
  const fem::CellShape& shape() const { return fem::shapeOf(surface_.facetType); }
  /// Place of a node in the lists of the surface.
  std::size_t node(std::size_t k) const { return static_cast<std::size_t>(nodes_[k]); }
  const fem::Point& position(std::size_t k) const { return surface_.positions[node(k)]; }
  State at(const FacetPlace& place) const;
  /// The nodal normals, interpolated and of length one again. @pre the surface has normals.
  fem::Point smoothNormal(const FacetBasis& basis) const;

 private:
  const Surface& surface_;
  const int* nodes_;
};

/// Whether a facet, at one of its nodes, looks into a direction (of length one), see leastFacing.
bool facesAt(const Facet& facet, std::size_t node, const fem::Point& direction);

/// ∫1 and ∫φ_k over a facet.
struct FacetIntegrals {
  double area = 0.0;
  std::array<double, maxFacetNodes> ofNodes{};
};
FacetIntegrals integralsOn(const Facet& facet, const fem::Quadrature& rule);

} // namespace Harmos::contact
