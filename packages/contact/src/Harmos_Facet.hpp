// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Surface.hpp"

#include <array>

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
  };

  Facet(const Surface& surface, int facet)
      : surface_(surface),
        nodes_(surface.facets.data() +
               static_cast<std::size_t>(facet) * static_cast<std::size_t>(surface.nodesPerFacet())) {}

  std::size_t size() const { return static_cast<std::size_t>(surface_.nodesPerFacet()); }
  std::size_t corners() const { return static_cast<std::size_t>(fem::shapeOf(surface_.facetType).corners); }
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

} // namespace Harmos::contact
