// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_RowConditions.hpp"
#include "Harmos_RowWeights.hpp"
#include "Harmos_SubdomainSystem.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_RCP.hpp>

#include <map>
#include <vector>

namespace Harmos::feti {

namespace Details {
struct BuiltRows;
struct MultiplierTerm;
struct RowEntry;
} // namespace Details

/// The constraints B = [B_I; B_E], c of the torn problem, distributed by rows: the dofs that rows act on, and
/// what rows ask (RowConditions). B is immutable; c may be set anew.
///
/// Rules (design of the dual problem):
///  - at a dof with m copies of weights d, the m − 1 gluing rows are orthonormal in the inner product of D⁻¹:
///  row k is (d₁, …, d_k, −s, 0, …)√d_{k+1}/√(s(s + d_{k+1})), s = d₁ + … + d_k; with d = 1 that is (1, …, 1,
///  −k, 0, …)/√(k(k + 1));
///  - a given row takes the weighted mean of the copies of each of its dofs, which is orthogonal to the
///  gluing rows, and is scaled to unit length in that inner product; rowScale() keeps the factor, so that
///  residuals and multipliers are told in physical units;
///  - with weights, and without where other rows name a or b as well, rows u_a − u_b = 0 that are given, such
///  as ties between meshes that match, make a and b one dof with
///    the copies of both: where they meet others each gluing row has to weigh all of them;
///  - a row that gives way, Bu = c + Cλ, is scaled so that bD⁻¹bᵀ + c = 1 with weights: F + C has a diagonal
///  of about one there, whatever C. Without weights its length is one, as that of others;
///  - with weights all of the dual problem is that of the variable λ̂ = Q^{−½}λ, Q = (BD⁻¹Bᵀ)⁻¹ block by
///  block: bounds of zero stay such, the coarse projector is I − QG̃ᵀ(G̃QG̃ᵀ)⁻¹G̃ of λ (Bhardwaj et al.,
///  Application of the FETI method to ASCI problems, Int. J. Numer. Meth. Engng. 47, 2000; Rixen, Farhat
///  1999), and norms of residuals are those weighted by Q;
///  - softness of a row has no say in its scale;
///  - prescribed values in a given row go to its bound, unless there is nothing else in it; what the row is
///  at
///    them is kept beside, for the forces of the full row (heldForces());
///  - with DirichletForm::Dual each fixed copy gets a row u = g and no gluing row, which would depend on
///  those.
///
/// Global row numbers: given inequalities, limited rows, equalities, then gluing and Dirichlet rows by dof
/// number. They do not depend on the number of ranks, and neither do the rows. A row is owned by the rank of
/// the lowest of its subdomains; the two rows of a disc by that of both, and so limits and what they follow.
/// They are scaled alike, by the mean of their lengths, so that a disc stays one.
///
/// Guarded by tests/unit/feti/test_constraints.cpp.
class Constraints : public RowConditions {
 public:
  /// A value at a local dof of a subdomain in a local (overlapping) row.
  struct Entry {
    int row; ///< local index in overlapMap()
    int dof;
    double value;
    bool operator==(const Entry& other) const {
      return row == other.row && dof == other.dof && value == other.value;
    }
  };

  /// @param system the torn problem, to outlive this.
  /// @param rows this rank's share of the given rows; see ConstraintRow.
  /// @throws InputError on all ranks for rows that name a dof which is not an interface dof of any subdomain,
  /// and for
  ///         dofs fixed to different values.
  /// @note Collective. Rendezvous by dof number; nothing is gathered on one rank.
  Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows,
              RowWeights weights = RowWeights::None);

  /// New bounds c, limits and softness of the rows that were given, and of what the system prescribes now.
  /// @param rows those given to the constructor, with other bounds, limits and softness, or with none or some
  /// where it was not.
  /// @throws InputError on all ranks if they differ in more, and as the constructor. @note Collective.
  void setBounds(const std::vector<ConstraintRow>& rows);

  /// The rows that this rank gave, as they are now.
  const std::vector<ConstraintRow>& givenRows() const { return given_; }

  /// The same B with other bounds, limits, softness and statuses, for a system that differs in loads and
  /// prescribed values alone. @param system to outlive the answer. @throws InputError likewise. @note
  /// Collective.
  Constraints withBounds(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows) const;

  /// Rows owned by this rank: the map of dual vectors.
  const Teuchos::RCP<const Map>& rowMap() const { return rowMap_; }
  /// Rows that touch a subdomain of this rank.
  Teuchos::RCP<const Map> overlapMap() const;
  /// Rank that owns a row of overlapMap().
  int overlapOwner(int row) const { return overlapOwner_[static_cast<std::size_t>(row)]; }
  /// B_i, in the subdomain's frame, sorted by row.
  const std::vector<Entry>& entries(int subdomain) const {
    return entries_[static_cast<std::size_t>(subdomain)];
  }

  /// B_i of all subdomains of this rank.
  const std::vector<std::vector<Entry>>& entries() const { return entries_; }

  /// Whether rows are orthonormal in the inner product of weights; see RowWeights.
  bool hasWeights() const { return hasWeights_; }
  /// Rows of all ranks.
  long long dualDimension() const;

  /// y = Bu. @note Collective.
  void applyB(const TornVector& u, MultiVector& y) const;
  /// y = Bu − c − Cλ, less what soft rows give way: zero in rows that hold as equations. @note Collective.
  void residual(const TornVector& u, const MultiVector& lambda, MultiVector& y) const;

  /// λ on overlapMap(): what addBt() takes. @note Collective, one neighbour exchange.
  std::vector<double> toOverlap(const MultiVector& lambda) const;
  /// y = the sum over the ranks of vectors on overlapMap(). @note Collective, one neighbour exchange.
  void fromOverlap(const std::vector<double>& overlap, MultiVector& y) const;

  /// Bᵀ of a vector on overlapMap(), for one subdomain: t ← B_iᵀx. Local.
  void addBt(int subdomain, const double* overlap, double* t) const;
  /// overlap ← overlap + B_i u. Local.
  void addB(int subdomain, const double* u, double* overlap) const;

  const Teuchos::RCP<const Import>& importer() const { return import_; }

  /// Physical multipliers of the rows that this rank gave to the constructor, in their order: with Ku = f −
  /// Bᵀλ each row exerts −coefficient · multiplier on its dofs. @note Collective.
  std::vector<double> givenMultipliers(const MultiVector& lambda) const;

  /// Bv of the rows that this rank gave, physical and in their order, for a v that is zero where values are
  /// prescribed; zero of rows that another one stands for. @note Collective.
  std::vector<double> givenProducts(const TornVector& v) const;
  /// residual() likewise: of an open contact the negative gap. @note Collective.
  std::vector<double> givenResiduals(const TornVector& u, const MultiVector& lambda) const;

  /// Bᵀλ of the given rows, in full, at dofs with prescribed values: of each subdomain a value for each of
  /// Subdomain::fixed. @note Collective.
  std::vector<std::vector<double>> heldForces(const MultiVector& lambda) const;

 private:
  using Sent = std::vector<std::vector<Details::RowEntry>>; // by sender
  Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows, bool hasWeights,
              const Details::Weights& weights);
  Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows, bool hasWeights,
              const Details::Weights& weights, const Details::BuiltRows& built);
  void keepRows(const Details::BuiltRows& built);
  void enterFrames();
  void keepFullRows(const Sent& held);
  void keepGiven(const std::vector<ConstraintRow>& rows, const Details::BuiltRows& built);
  void keepMultipliers(const std::vector<Details::MultiplierTerm>& terms);
  bool setPlainBounds(const std::vector<ConstraintRow>& rows);
  void changePlain(const std::vector<ConstraintRow>& rows, bool isSame);
  void takeBounds(const Constraints& changed);
  std::vector<double> atGiven(MultiVector& scaled) const;
  static std::vector<std::vector<Entry>>
  bySubdomain(const Sent& entries, const std::map<long long, int>& localRow, int subdomains);

  // A row that this rank gave: an inequality with unknowns, one that is no row, or neither; what was taken
  // from its bound; and its physical multiplier, a sum of factors times rows of givenImport_'s target.
  enum class Standing { Plain, Taken, Other };
  struct MultiplierTerm {
    int place;
    double factor;
  };
  struct Given {
    Standing standing;
    std::vector<double> subtracted;
    std::vector<MultiplierTerm> multiplier;
  };

  const SubdomainSystem* system_;
  Details::Weights weights_; // as they were at first
  bool hasWeights_ = false;
  Teuchos::RCP<const Map> rowMap_;
  Teuchos::RCP<const Import> import_; // to overlapMap()
  std::vector<int> overlapOwner_;
  std::vector<std::vector<Entry>> entries_;
  // What given rows are at prescribed dofs: by row of heldMap_.
  Teuchos::RCP<const Map> heldMap_;
  std::vector<std::vector<Entry>> heldEntries_;
  // The rows that this rank gave last, at these prescribed values.
  std::vector<ConstraintRow> given_;
  std::vector<std::vector<double>> prescribed_;
  std::vector<Given> standings_; // of each
  Teuchos::RCP<const Import> givenImport_;
};

} // namespace Harmos::feti
