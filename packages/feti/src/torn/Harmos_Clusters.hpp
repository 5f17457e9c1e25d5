// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Constraints.hpp"
#include "Harmos_RigidMotions.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace Harmos::feti {

/// Which subdomains are joined to clusters, and by what: "Decomposition/Clusters" of a deck.
struct ClusterOptions {
  enum class Kind {
    Auto, ///< by the cost model
    None,
    Rank, ///< the subdomains of a rank are one
    Size  ///< of about so many
  };
  Kind kind = Kind::Auto;
  int size = 0;
  /// Where two subdomains meet; where more do, which are corners in the plane, and edges and corners in
  /// space; both.
  enum class Joins { Faces, Corners, All }; ///< Faces: and what is around those of too few dofs
  Joins joins = Joins::Faces;
};

class Clusters;

/// Null where there are to be none. @note Collective, as Clusters().
std::shared_ptr<const Clusters> makeClusters(const SubdomainSystem& system, const Constraints& constraints,
                                             const ClusterOptions& options);

/// Clusters of subdomains of a rank, joined by averages (Hybrid Total FETI; Klawonn, Rheinbach: Highly
/// scalable parallel domain decomposition methods with an application to biomechanics, ZAMM 90, 2010; Říha et
/// al. 2016; Dostál et al., Numer. Algorithms 2022).
///
/// Dofs that the same subdomains have copies of make a place: a face, or a corner or an edge. Of a place
/// within a cluster the motions of its first subdomain are averaged over its gluing rows: B₀ = UᵀB with
/// orthonormal columns U, rows of B having two entries at a face, and B₀u = ±Σ r(x)(u_i − u_j)(x). Whatever U
/// is, B₀u = 0 holds for the solution, so that it may be demanded of all u: each average costs a coarse row,
/// and none of the answer.
///
/// What of u is left then: K⁺ of a cluster (ClusterInverse), its kernel Rt with B₀Rt = 0, found by singular
/// value decompositions while the cluster grows from subdomain to subdomain; and rows UᵀF = 0, for which
/// vectors are kept orthogonal to U. Inequality, limited and Dirichlet rows are outside of U.
///
/// Guarded by tests/unit/feti/clusters/test_clusters.cpp.
class Clusters {
 public:
  /// Values at a subdomain's dofs of a place, by columns.
  struct Side {
    int subdomain;              ///< of this rank
    std::vector<int> dofs;      ///< rising
    std::vector<double> values; ///< dofs by columns
  };
  /// Columns that reach over the subdomains of a place.
  struct Columns {
    int count = 0;
    int first = 0; ///< among those of the cluster
    std::vector<Side> sides;
  };
  /// A place that joins subdomains: its sides are those of B₀ᵀ.
  struct Join : Columns {
    std::vector<int> rows;       ///< of B, owned by this rank
    std::vector<double> weights; ///< U, rows by columns
  };
  struct Cluster {
    std::vector<int> members; ///< subdomains of this rank, by rising numbers
    std::vector<Join> joins;
    int averages = 0; ///< rows of B₀
    /// Motions of places, the same at all copies: what may move without a jump; see DualPreconditioner.
    std::vector<Columns> moves;
    int motions = 0; ///< columns of these
  };

  /// @param options of Kind Rank or Size.
  /// @throws NumericalError on all ranks for averages that are none. @note Collective.
  Clusters(const SubdomainSystem& system, const Constraints& constraints, const ClusterOptions& options);
  Clusters(const Clusters&) = delete;
  Clusters& operator=(const Clusters&) = delete;

  const std::vector<Cluster>& all() const { return clusters_; }
  /// Over all ranks.
  long long total() const { return motions_->totalParts(); }
  /// A number by which clusters are told from others: of the subdomains of each, on all ranks; not zero.
  double fingerprint() const { return fingerprint_; }
  /// The kernels of all clusters.
  const RigidMotions& motions() const { return *motions_; }
  /// v ← v − UUᵀv. Local.
  void removeJoined(MultiVector& v) const;
  /// v ← v + Uμ, μ the averages' of all clusters of this rank, one after the other. Local.
  void addJoined(const std::vector<double>& mu, MultiVector& v) const;
  /// Of each cluster the place of its first average among them, and the end.
  const std::vector<std::size_t>& averagePlaces() const { return averagePlaces_; }

 private:
  std::vector<Cluster> clusters_;
  std::optional<RigidMotions> motions_;
  std::vector<std::size_t> averagePlaces_ = {0};
  double fingerprint_ = 0.0;
};

} // namespace Harmos::feti
