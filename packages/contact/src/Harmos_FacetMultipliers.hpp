// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Facet.hpp"

#include <array>
#include <vector>

namespace Harmos::contact {

/// Which nodes of a facet bear multipliers of mortar coupling, where some of its nodes are to have none:
/// those that belong to both surfaces, and those that another effect holds. The carrier of a node x without a
/// multiplier goes to its neighbours on the facet,
///
///     φ̃'_j = φ̃_j + c_jx φ̃_x,  Σ_j c_jx = 1,
///
/// so that the carriers still sum to one, and a constant pressure is passed on exactly up to that node (as at
/// crosspoints and ends of interfaces: Wohlmuth 2001; Puso & Laursen 2003).
/// Guarded by tests/unit/contact/test_shared_nodes.cpp.
class FacetMultipliers {
 public:
  using Values = std::array<double, maxFacetNodes>;

  /// @param without of each node of the surface whether it has no multiplier.
  FacetMultipliers(const Facet& facet, const std::vector<char>& without);

  /// Nodes of the facet with a multiplier.
  const std::vector<std::size_t>& nodes() const { return bearing_; }
  bool isWhole() const { return lacking_.empty(); }
  /// φ̃', in the order of nodes().
  Values values(const Values& carriers) const;
  /// c_jx of the node x, in the order of nodes(); x lacks a multiplier.
  const Values& sharesOf(std::size_t lacking) const { return shares_[lacking]; }

 private:
  std::vector<std::size_t> bearing_, lacking_;
  std::array<Values, maxFacetNodes> shares_{};
};

} // namespace Harmos::contact
