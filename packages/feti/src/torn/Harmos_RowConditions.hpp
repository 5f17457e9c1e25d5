// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_Comm.hpp>

#include <array>
#include <vector>

namespace Harmos::feti {

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

/// What a row asks of its force and of its residual; all of it scaled but the scale.
struct RowCondition {
  long long number; ///< of the row
  double bound;
  double scale; ///< by which the physical row was multiplied
  double compliance = 0.0;
  RowType type = RowType::Equality; ///< whatever the status
  double limit = 0.0;
  long long disc = -1; ///< −1: none
  double coefficient = 0.0;
  long long normal = -1;  ///< row that the limit follows, −1: none
  double softness = -1.0; ///< −1: none
  ConstraintRow::Status status = ConstraintRow::Status::Undecided;
};

/// The conditions of the rows of B that this rank owns, by local index of Constraints::rowMap(): all that
/// problems and tests need to know of rows but the dofs that they act on.
///
/// Guarded by tests/unit/feti/test_constraints.cpp, test_limited_rows.cpp.
class RowConditions {
 public:
  /// A limit that follows the force of an inequality: factor · (λ_normal)⁺, all of scaled rows of this rank.
  struct Follower {
    int row;    ///< of a disc its first one
    int disc;   ///< place in discs(); −1: none
    int normal; ///< row
    double factor;
  };

  /// @param rows by rising numbers. The two of a disc are on one rank, and so are a limit and what it
  /// follows. @param inequalities, limited rows of all ranks. @param rounding2 squares of what the bounds
  /// that this rank gave are known to.
  /// @throws InputError on all ranks for a limit that follows a soft inequality. @note Collective.
  RowConditions(const Teuchos::Comm<int>& comm, std::vector<RowCondition> rows, long long inequalities,
                long long limited, double rounding2);

  /// Of an owned row, by local index of rowMap(); an inequality that is decided is an equality where it is
  /// closed, and where it is open limited to a force of zero.
  RowType rowType(int row) const {
    const RowCondition& it = at(row);
    return it.status == ConstraintRow::Status::Undecided ? it.type
           : it.status == ConstraintRow::Status::Closed  ? RowType::Equality
                                                         : RowType::Limited;
  }
  /// Factor by which the physical row was multiplied: residual/scale and multiplier·scale are physical.
  double rowScale(int row) const { return at(row).scale; }
  /// c of the scaled row.
  double bound(int row) const { return at(row).bound; }
  /// C of the scaled row: compliance · scale².
  double compliance(int row) const { return at(row).compliance; }
  /// Whether the force of an owned row may leave its limits, see ConstraintRow::softness; and softness ·
  /// scale².
  bool isSoft(int row) const { return at(row).softness >= 0.0; }
  double softness(int row) const { return at(row).softness; }
  /// By which a soft row gives way: softness times what of its scaled multiplier is beyond its limits; else
  /// 0.
  double giving(int row, double lambda) const {
    return !isSoft(row) || (rowType(row) == RowType::Inequality && lambda >= 0.0) ? 0.0
                                                                                  : softness(row) * lambda;
  }
  /// Whether any row is soft, on any rank.
  bool hasSoft() const { return hasSoft_; }
  /// Of a limited row, scaled like its multiplier: limit / scale; zero where it follows.
  double limit(int row) const { return at(row).limit; }
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
  bool isInterval(int row) const {
    return rowType(row) == RowType::Limited && at(row).disc < 0 && !isSoft(row);
  }
  /// Whether any row gives way, on any rank.
  bool hasCompliance() const { return hasCompliance_; }

  /// ‖·‖ of what the bounds of all rows, scaled, are known to; see ConstraintRow::rounding.
  double boundRounding() const { return boundRounding_; }

  /// Of all ranks, whatever their statuses.
  long long inequalities() const { return inequalities_; }
  long long limited() const { return limited_; }

 protected:
  ConstraintRow::Status status(int row) const { return at(row).status; }
  /// Whether rows differ in nothing but what changes from step to step: bounds, limits, softness, statuses.
  bool areOfOneKind(const RowConditions& other) const;
  /// Other bounds and statuses of inequalities without softness; all other rows keep theirs, but for bounds
  /// that become zero with all prescribed values.
  struct Change {
    double bound;
    ConstraintRow::Status status;
  };
  /// @param change of each owned row. @param rounding2 as for the constructor. @note Collective.
  void change(const Teuchos::Comm<int>& comm, const std::vector<Change>& changes, double rounding2);

 private:
  const RowCondition& at(int row) const { return rows_[static_cast<std::size_t>(row)]; }
  void count(const Teuchos::Comm<int>& comm);

  std::vector<RowCondition> rows_;
  std::vector<std::array<int, 2>> discs_, pairs_;
  std::vector<Follower> followers_;
  long long discCount_ = 0, followerCount_ = 0, softLimited_ = 0, openCount_ = 0;
  bool hasSoft_ = false;
  bool hasCompliance_ = false;
  long long inequalities_, limited_;
  double boundRounding_ = 0.0;
};

} // namespace Harmos::feti
