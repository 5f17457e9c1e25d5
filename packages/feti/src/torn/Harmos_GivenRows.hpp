// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DofCopies.hpp"

#include <array>
#include <string>
#include <vector>

namespace Harmos::feti::Details {

/// How many rows of each kind all ranks give.
struct GivenCounts {
  long long inequalities = 0, limited = 0, equalities = 0;
  /// The number of the first row of a kind in B.
  long long first(ConstraintRow::Kind kind) const;
};

/// @throws InputError on all ranks where rows of a kind are not numbered 0, 1, ... without gaps. @note
/// Collective.
GivenCounts countGiven(const Teuchos::Comm<int>& comm, const std::vector<ConstraintRow>& rows);

/// Numbers in B of the rows that are left, in the order given: inequalities, limited rows, equalities.
/// @param isTaken equalities that are no rows; see DofCopies::unite(). @note Collective.
std::vector<long long> numbersOfGiven(const Teuchos::Comm<int>& comm, const std::vector<ConstraintRow>& rows,
                                      const std::vector<char>& isTaken, const GivenCounts& counts);

/// A term of a row at a copy of a dof.
struct CopyTerm {
  Copy copy;
  double value;
};

/// A given row by the copies of its dofs, not yet scaled.
struct GivenRow {
  std::vector<CopyTerm> terms, held; ///< with unknowns; at prescribed values
  double norm2 = 0.0;                ///< bD⁻¹bᵀ
  double bound = 0.0;
  std::vector<double> prescribed; ///< what was taken from the bound: coefficients times prescribed values
  double compliance = 0.0;
  bool hasUnknown = false;
  bool isIdle = false; ///< no force of its own moves anything
};

/// A row that no force can change has to hold already. One that gives way bears a force all the same, which
/// is known; and so does a limited one, whose dofs prescribed values let slip: it gets a compliance that is
/// small beside those of the bodies.
/// @param softness of a dof: displacement by force.
/// @throws InputError for rows that name dofs of no subdomain, that are zero or not finite, or cannot be met.
GivenRow givenRow(const ConstraintRow& row, const DofCopies::Answers& answers, DirichletForm form,
                  double softness);

/// For messages: "dof 7 (subdomain 3)".
std::string dofText(const Copy& copy);

/// Given rows that have one disc, by their places among the rows of this rank; in the order of discs.
/// While they are soft their limits do not count, and each has its own softness.
/// @throws InputError for a disc of which there are not two rows, and for limits that are no radius of it.
std::vector<std::array<std::size_t, 2>> discsOf(const std::vector<ConstraintRow>& rows);

/// Limited rows whose limit follows an inequality, and that, by their places among the rows of this rank.
/// @throws InputError where that row is not given here, or the limited one has a limit of its own.
std::vector<std::array<std::size_t, 2>> followersOf(const std::vector<ConstraintRow>& rows);

} // namespace Harmos::feti::Details
