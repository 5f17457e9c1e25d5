// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_RowWeights.hpp"
#include "Harmos_SubdomainSystem.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_RCP.hpp>

#include <array>
#include <map>
#include <vector>

namespace Harmos::feti {

namespace Details {
struct GivenRow;
/// An entry of a finished row on its way to the rank of its subdomain.
struct RowEntry {
  long long row;
  double value;
  int place; ///< of the subdomain among those of its rank
  int local; ///< dof
  int owner; ///< rank of the row
};
} // namespace Details

/// What a row of B stands for.
enum class RowType {
  Inequality, ///< B_I u ≤ c_I
  Limited,    ///< an equality given by the application, whose force is limited
  Equality,   ///< a tie or another equality given by the application
  Gluing,     ///< copies of a dof are equal
  Dirichlet   ///< a prescribed value, Total FETI only
};

/// Whether rows of a type hold as equations whatever their multipliers are.
inline bool isUnconditional(RowType type) {
  return type != RowType::Inequality && type != RowType::Limited;
}

/// The constraints B = [B_I; B_E], c of the torn problem, distributed by rows. B is immutable; c may be set
/// anew.
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
class Constraints {
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

  /// A limit that follows the force of an inequality: factor · (λ_normal)⁺, all of scaled rows of this rank.
  struct Follower {
    int row;    ///< of a disc its first one
    int disc;   ///< place in discs(); −1: none
    int normal; ///<
    double factor;
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
  const Teuchos::RCP<const Map>& overlapMap() const { return overlapMap_; }
  /// Rank that owns a row of overlapMap().
  int overlapOwner(int row) const { return overlapOwner_[static_cast<std::size_t>(row)]; }
  /// B_i, sorted by row.
  const std::vector<Entry>& entries(int subdomain) const {
    return entries_[static_cast<std::size_t>(subdomain)];
  }

  /// B_i of all subdomains of this rank.
  const std::vector<std::vector<Entry>>& entries() const { return entries_; }

  /// Of an owned row, by local index of rowMap(); an inequality that is decided is an equality where it is
  /// closed, and where it is open limited to a force of zero.
  RowType rowType(int row) const {
    const auto r = static_cast<std::size_t>(row);
    return statuses_[r] == ConstraintRow::Status::Undecided ? types_[r]
           : statuses_[r] == ConstraintRow::Status::Closed  ? RowType::Equality
                                                            : RowType::Limited;
  }
  /// Factor by which the physical row was multiplied: residual/scale and multiplier·scale are physical.
  double rowScale(int row) const { return scales_[static_cast<std::size_t>(row)]; }
  /// Whether rows are orthonormal in the inner product of weights; see RowWeights.
  bool hasWeights() const { return hasWeights_; }
  /// c of the scaled row.
  double bound(int row) const { return bounds_[static_cast<std::size_t>(row)]; }
  /// C of the scaled row: compliance · scale².
  double compliance(int row) const { return compliances_[static_cast<std::size_t>(row)]; }
  /// Whether the force of an owned row may leave its limits, see ConstraintRow::softness; and softness ·
  /// scale².
  bool isSoft(int row) const { return softness_[static_cast<std::size_t>(row)] >= 0.0; }
  double softness(int row) const { return softness_[static_cast<std::size_t>(row)]; }
  /// By which a soft row gives way: softness times what of its scaled multiplier is beyond its limits; else
  /// 0.
  double giving(int row, double lambda) const {
    return !isSoft(row) || (rowType(row) == RowType::Inequality && lambda >= 0.0) ? 0.0
                                                                                  : softness(row) * lambda;
  }
  /// Whether any row is soft, on any rank.
  bool hasSoft() const { return hasSoft_; }
  /// Of a limited row, scaled like its multiplier: limit / scale; zero where it follows.
  double limit(int row) const { return limits_[static_cast<std::size_t>(row)]; }
  /// Of each owned row, where forces are these: limits that follow are known by them alone. Local.
  std::vector<double> limits(const MultiVector& lambda) const;
  /// By rising rows.
  const std::vector<Follower>& followers() const { return followers_; }
  /// Whether any limit follows, on any rank.
  bool hasFollowers() const { return followerCount_ > 0; }
  /// Pairs of owned rows, each of a disc; by rising rows. Without those that are soft now.
  const std::vector<std::array<int, 2>>& discs() const { return discs_; }
  /// With those.
  const std::vector<std::array<int, 2>>& pairs() const { return pairs_; }
  /// Whether there are discs, and limited rows in none, on any rank. Soft ones are neither.
  bool hasDiscs() const { return discCount_ > 0; }
  bool hasIntervals() const { return limited_ > 2 * discCount_ + softLimited_ || openCount_ > 0; }
  /// Whether an owned row is limited, in no disc and not soft; or an open inequality.
  bool isInterval(int row) const { return isInterval_[static_cast<std::size_t>(row)] != 0; }
  /// Whether any row gives way, on any rank.
  bool hasCompliance() const { return hasCompliance_; }

  /// ‖·‖ of what the bounds of all rows, scaled, are known to; see ConstraintRow::rounding.
  double boundRounding() const { return boundRounding_; }

  long long dualDimension() const { return dualDimension_; }
  /// Whatever their statuses.
  long long inequalities() const { return inequalities_; }
  long long limited() const { return limited_; }

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
              Details::Weights weights);
  void keepFullRows(const Sent& held);
  void findSoft(const Teuchos::Comm<int>& comm);
  void keepGiven(const std::vector<ConstraintRow>& rows, const std::vector<char>& isTaken,
                 const std::vector<Details::GivenRow>& parts);
  bool setPlainBounds(const std::vector<ConstraintRow>& rows);
  void takeBounds(const Constraints& changed);
  std::vector<double> atGiven(MultiVector& scaled) const;
  static std::vector<std::vector<Entry>>
  bySubdomain(const Sent& entries, const std::map<long long, int>& localRow, int subdomains);

  const SubdomainSystem* system_;
  Details::Weights weights_; // as they were at first
  bool hasWeights_ = false;
  Teuchos::RCP<const Map> rowMap_;
  Teuchos::RCP<const Map> overlapMap_;
  Teuchos::RCP<const Import> import_;
  std::vector<int> overlapOwner_;
  std::vector<std::vector<Entry>> entries_;
  // What given rows are at prescribed dofs: by row of heldMap_.
  Teuchos::RCP<const Map> heldMap_;
  std::vector<std::vector<Entry>> heldEntries_;
  // Physical multipliers of the rows that this rank gave: sums of factors times rows of givenMap_.
  struct MultiplierTerm {
    int place;
    double factor;
  };
  Teuchos::RCP<const Map> givenMap_;
  std::vector<std::vector<MultiplierTerm>> multipliers_;
  Teuchos::RCP<const Import> givenImport_;
  // The rows that this rank gave last, at these prescribed values; an inequality with unknowns, one that is
  // no row, or neither; and what was taken from its bound.
  enum class Standing { Plain, Taken, Other };
  std::vector<ConstraintRow> given_;
  std::vector<std::vector<double>> prescribed_;
  std::vector<Standing> standing_;
  std::vector<std::vector<double>> subtracted_;
  std::vector<RowType> types_; // whatever the statuses
  std::vector<ConstraintRow::Status> statuses_;
  std::vector<double> scales_;
  std::vector<double> bounds_;
  std::vector<double> compliances_, limits_;
  std::vector<double> softness_; // −1: none
  std::vector<std::array<int, 2>> discs_, pairs_;
  std::vector<char> isInterval_;
  long long discCount_ = 0, followerCount_ = 0, softLimited_ = 0, openCount_ = 0;
  bool hasSoft_ = false;
  std::vector<Follower> followers_;
  bool hasCompliance_ = false;
  long long dualDimension_ = 0;
  long long inequalities_ = 0, limited_ = 0;
  double boundRounding_ = 0.0;
};

} // namespace Harmos::feti
