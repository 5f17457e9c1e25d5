// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundaryOperator.hpp"
#include "Harmos_Clusters.hpp"
#include "Harmos_SparseCholesky.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace Harmos::feti {

/// What joins the subdomains of clusters when loads t are answered: u = K⁺(t − B₀ᵀμ) + Rα with B₀u = 0 and
/// Rᵀ(t − B₀ᵀμ) = 0 as far as the cluster has no motion of its own,
///
///     α = S₀⁺(Rᵀt − G₀F₀⁻¹B₀K⁺t),   μ = F₀⁻¹(B₀K⁺t + G₀ᵀα)
///     F₀ = B₀K⁺B₀ᵀ,   G₀ = RᵀB₀ᵀ,   S₀ = G₀F₀⁻¹G₀ᵀ,   S₀⁺ = (S₀ + ρTTᵀ)⁻¹
///
/// T spans the kernel of S₀: amplitudes of the motions of the whole cluster. On the boundary K⁺B₀ᵀ is kept,
/// so that a product takes no further one with K⁺: u = K⁺t − W(μ, −α), W = [K⁺B₀ᵀ, R], and what is asked for
/// of t is Wᵀt. Congruent subdomains share W, congruent clusters F₀ and S₀.
///
/// Guarded by tests/unit/feti/local/test_cluster_inverse.cpp.
class ClusterInverse {
 public:
  /// Subdomains that share an operator.
  struct Group {
    std::vector<int> members;  ///< subdomains of this rank
    std::vector<int> boundary; ///< dofs, rising
    const BoundaryOperator* op = nullptr;
  };
  /// Numbers of averages and amplitudes: of the averages of all clusters of this rank, and of the columns of
  /// all R_i, each one after the other.
  struct Amounts {
    std::vector<double> averages, amplitudes;
  };

  enum class Role {
    Inverse,       ///< of K⁺, as above
    Preconditioner ///< of S, with the moves of a cluster in the place of its averages, and without R
  };

  /// @param groups (K⁺)_bb, or S, of all subdomains of this rank.
  /// @throws NumericalError, InternalError where a cluster has motions that its kernel does not contain.
  /// Local.
  ClusterInverse(std::shared_ptr<const Clusters> clusters, const std::vector<Group>& groups,
                 Role role = Role::Inverse);

  const Clusters& clusters() const { return *clusters_; }
  const std::shared_ptr<const Clusters>& sharedClusters() const { return clusters_; }
  /// Pairs of F₀ and S₀ that are held.
  int distinctFactors() const { return static_cast<int>(factors_.size()); }
  double bytes() const;

  // In a product with all subdomains: what each group has got, then for each group what is to be added.
  /// @param t boundary vectors of the members, column by column of the product.
  void gather(std::size_t group, const double* t, int columns) const;
  void solve(int columns) const;
  /// u ← u − W(μ, −α).
  void add(std::size_t group, double* u, int columns) const;

  // The same by itself, of whole loads.
  Amounts none() const;
  /// Adds B₀u and Rᵀf of a subdomain. @param u K⁺f.
  void measure(int subdomain, const double* u, const double* f, Amounts& amounts) const;
  /// μ and α.
  Amounts answer(const Amounts& amounts) const;
  /// f ← f − B₀ᵀμ of a subdomain.
  void subtractForces(int subdomain, const Amounts& answer, double* f) const;
  /// u ← u + Rα.
  void addMotion(int subdomain, const Amounts& answer, double* u) const;
  /// u ← u − W(μ, −α) at the boundary of a subdomain; zero elsewhere.
  void addCorrection(int subdomain, const Amounts& answer, double* u) const;

 private:
  /// A distinct side of a group's members: columns of B₀ᵀ.
  struct KnownSide {
    std::vector<int> dofs;
    std::vector<double> values;
    int first = 0, columns = 0;
  };
  /// Of a group.
  struct Shared {
    std::vector<int> boundary;
    int width = 0, joined = 0, motions = 0; ///< columns of W, of K⁺B₀ᵀ in it, of R
    std::vector<double> w;                  ///< boundary × width
    std::vector<double> f, g; ///< B₀K⁺B₀ᵀ and RᵀB₀ᵀ of the sides, joined × joined, motions × joined
    std::vector<int> members;
    bool isSelective = false;            ///< most members use few of the columns
    mutable std::vector<double> amounts; ///< Wᵀt, then (μ, −α): width for each vector
  };
  /// How a subdomain has part in a join.
  struct Use {
    int column;  ///< of W
    int average; ///< first one of the join in its cluster
    int columns;
    double sign;
    const Clusters::Side* side;
  };
  struct Member {
    std::size_t group = 0, place = 0; ///< among the members of its group
    std::size_t cluster = 0;
    std::size_t amplitude = 0; ///< first one of it in its cluster
    std::vector<Use> uses;
  };
  struct Factor {
    SparseCholesky f0;
    int averages = 0, amplitudes = 0;
    std::optional<DenseOperator> inverse; ///< S₀⁺; none where nothing moves
  };

  int columnsOf(const Clusters::Cluster& cluster) const {
    return role_ == Role::Inverse ? cluster.averages : cluster.motions;
  }
  /// Of the member that a vector of a group is of.
  const std::vector<Use>& usesOf(const Shared& shared, std::size_t vector) const {
    return members_[static_cast<std::size_t>(shared.members[vector % shared.members.size()])].uses;
  }
  std::vector<std::vector<KnownSide>> findMembers(const std::vector<Group>& groups);
  Shared sharedOf(const Group& group, const std::vector<KnownSide>& known) const;
  Use useOf(const Clusters::Columns& join, const Clusters::Side& side, std::vector<KnownSide>& known) const;
  std::vector<int> signature(std::size_t cluster) const;
  Factor factorOf(std::size_t cluster) const;
  std::vector<double> motionsOf(std::size_t cluster) const;
  /// G₀μ and G₀ᵀα.
  std::vector<double> gTimes(std::size_t cluster, const std::vector<double>& mu) const;
  std::vector<double> gTransposedTimes(std::size_t cluster, const std::vector<double>& alpha) const;
  /// μ and α, in the place of B₀K⁺t and Rᵀt.
  void solveCluster(std::size_t cluster, std::vector<double>& averages,
                    std::vector<double>& amplitudes) const;

  std::shared_ptr<const Clusters> clusters_;
  Role role_;
  std::vector<Shared> shared_;  ///< by group
  std::vector<Member> members_; ///< by subdomain
  std::vector<Factor> factors_;
  std::vector<std::size_t> factorOf_; ///< by cluster
};

} // namespace Harmos::feti
