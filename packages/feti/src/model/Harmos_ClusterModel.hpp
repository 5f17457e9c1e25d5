// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_StepModel.hpp"

#include <array>
#include <vector>

namespace Harmos::feti {

/// How products grow with clusters of m subdomains, d = 2 or 3: 1 + a_d log₂ m^(1/d) + c_d (aspect − 1)
/// times those without, the aspect being that of the longest side of a cluster to its shortest.
///
/// The one place for a_d and c_d. a_d fitted by tests/performance/clusters/cluster_growth.py to products to
/// 1e-8 with the Dirichlet preconditioner (in the plane the mean of membranes and plane strain), c_d roughly
/// to slender clusters on such grids; tests/performance/performance_model.py has them too, in GROWTH and
/// SLENDER.
struct ProductGrowth {
  static constexpr double plane = 0.42, space = 0.71;
  static constexpr double slenderInPlane = 0.4, slenderInSpace = 1.2;
};
double growthOfProducts(double clusterSize, bool isInSpace, double aspect = 1.0);

/// The longest and the shortest side of a rank's share, counted in subdomains.
struct ShareSides {
  double longest = 1.0, shortest = 1.0;
};
/// Of as many subdomains as there are centres, which fill the box of these: (e_1/h + 1) … (e_d/h + 1) of
/// them, e the sides of the box. Local.
ShareSides sidesOf(const std::vector<std::array<double, 3>>& centres, bool isInSpace);
/// Of one of so many clusters of a share, whose longest side is halved again and again.
double aspectOfClusters(const ShareSides& share, double subdomains, double clusters, bool isInSpace);

/// What clusters of a rank cost depends on. A cluster is taken for a square or a cube of subdomains.
struct ClusterShape {
  double size = 1.0;       ///< m, subdomains of a cluster
  double share = 1.0;      ///< clusters for each subdomain, over all ranks
  double subdomains = 1.0; ///< s, of the rank
  double distinct = 1.0;   ///< q, operators that they have
  double boundary = 0.0;   ///< b, dofs of a subdomain's
  double motions = 1.0;    ///< r, of a subdomain that floats: 1 of a membrane, 3 in the plane, 6 in space
  double aspect = 1.0;     ///< of a cluster's sides

  bool isInSpace() const { return motions > 3.5; }
};

/// What the joining adds to a product with F and one with the Dirichlet preconditioner.
struct JoinCosts {
  double averages = 0.0;  ///< a, of a cluster
  double bytesRead = 0.0; ///< of W and S₀⁺
  double entries = 0.0;   ///< of L, LLᵀ = F₀, in all solves
  double bytesHeld = 0.0;
};

/// With faces f = d (m − m^((d−1)/d)) of a cluster of m subdomains, k = s/m clusters, columns of K⁺B₀ᵀ j =
/// r·2f/m of a subdomain by itself, r·min(2d, 2f) where some share an operator (then each has all):
///
///     averages   a = r f
///     bytes read 16 b (2j + r) q max(1, s/6q) + 4 k rm (rm + 1)
///     entries    6 k entries(F₀), as of a coarse problem of f parts
///     bytes held 8 b (2j + r) q + k (32 entries(F₀) + 4 rm (rm + 1))
///
/// W = [K⁺B₀ᵀ, R] is read twice in a product with F, and twice without R in one with the preconditioner
/// (ClusterInverse::gather, add); six vectors at once take as long to multiply with as W to be read. F has
/// two solves with F₀ and one product with S₀⁺, the preconditioner one solve. Nothing for m = 1.
JoinCosts joinCosts(const ClusterShape& clusters);

/// A step with clusters. @param step the same without: n, own and exchanged motions become those of clusters,
/// L is that of the smaller coarse problem, which is distributed or not as before.
StepShape withClusters(const StepShape& step, const ClusterShape& clusters);

} // namespace Harmos::feti
