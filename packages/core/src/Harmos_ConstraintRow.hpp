// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace Harmos {

/// A linear condition on physical (untorn) dofs: Σ coefficient · u(dof) ≤ bound, or = bound. One that gives
/// way under its force: ≤ bound + compliance · λ, or =, as of a layer between two bodies.
///
/// Or an equality whose force is limited, as of friction with a given bound: it holds while |λ| < limit, and
/// gives way along its force where |λ| = limit. Two limited rows of one disc have a common limit, of √(λ₁² +
/// λ₂²): the two directions in which surfaces in space may slip. Both are given on the same rank.
///
/// As of Coulomb's friction, the limit may follow the force of an inequality: coefficient · λ_normal. That
/// row is given on the same rank, too.
///
/// What contact and tie conditions are made of before the bodies are torn. Rows of one kind are numbered
/// 0, 1, ... without gaps over all ranks, each row on exactly one rank: so their order does not depend on the
/// number of ranks.
struct ConstraintRow {
  struct Term {
    long long dof;
    double coefficient;
  };
  enum class Kind { Inequality, Equality, Limited };
  /// What is known of an inequality: closed, it is an equality, whatever the sign of its force; open, it has
  /// none. So that a problem is linear, as one of what changes an answer a little.
  enum class Status { Undecided, Closed, Open };

  Kind kind = Kind::Equality;
  long long number = 0;
  std::vector<Term> terms;
  double bound = 0.0;
  double rounding = 0.0;   ///< the bound is known up to this: gaps are differences of coordinates
  double compliance = 0.0; ///< ≥ 0, in units of the bound by those of the multiplier; 0: does not give way
  /// Where it is given, the force of an inequality or a limited row may leave its limits, and what it bounds
  /// gives way by that: an inequality pulls, λ < 0, and Bu = bound + softness · λ there (closed, λ > 0, it is
  /// as stiff as ever); a limited row, whose limit does not count then, has Bu = bound + softness · λ on both
  /// sides. Springs of an interface that is glued, and not broken yet. ≥ 0; bounds and softness may change
  /// from one solution to the next.
  std::optional<double> softness = std::nullopt;
  double limit = 0.0;       ///< ≥ 0, of limited rows
  long long disc = -1;      ///< of limited rows: a number that no other pair has; −1: none
  double coefficient = 0.0; ///< ≥ 0, of limited rows whose limit follows an inequality
  long long normal = -1;    ///< the number of that inequality; −1: the limit is given
  /// Of inequalities without softness, which no limit follows; may change from one solution to the next.
  Status status = Status::Undecided;
};

} // namespace Harmos
