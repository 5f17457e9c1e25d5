// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <cstddef>
#include <map>
#include <vector>

namespace Harmos::feti::Details {

/// A copy of a dof, as the rank that all copies of it are told to sees it.
struct Copy {
  long long dof;
  long long subdomain;
  double value;  ///< of the Dirichlet condition
  double weight; ///< stiffness, relative
  int local;     ///< dof in the subdomain
  int place;     ///< subdomain among those of its rank
  int rank;
  int fixed;
};

/// A row u_a − u_b = 0 that unite() has taken.
struct Union {
  long long dofs[2];  ///< of the row
  double coefficient; ///< of the first one; that of the second one is its negative
  long long name;     ///< dof that the united ones go by: the lowest
  int rank, place;    ///< rank that gave the row, and its place there
};

/// Where the copies of each dof meet: rendezvous by ranges of dof numbers; nothing is gathered on one rank.
///
/// Guarded by tests/unit/feti/test_constraints.cpp.
class DofCopies {
 public:
  using Table = std::map<long long, std::vector<Copy>>; ///< by dof, copies by subdomain

  /// @param weights of the interface dofs of each subdomain of this rank; none at all: ones.
  /// @throws InputError on all ranks for rows that name a dof beyond those of all subdomains. @note
  /// Collective.
  DofCopies(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows,
            const std::vector<std::vector<double>>& weights);

  /// Dofs that rows of two terms and no bound glue together, such as ties between meshes that match, become
  /// one, with the copies of all; where one of them is prescribed they do not.
  /// @param all false: only those that other rows name as well, as where several bodies meet. Such rows are
  /// not orthogonal
  ///        to each other, and may depend on each other.
  /// @return by row whether it is one of these. @note Collective; as many exchanges as rows in a chain.
  std::vector<char> unite(const std::vector<ConstraintRow>& rows, bool all);

  /// Rank where the copies of a dof meet.
  std::size_t home(long long dof) const { return static_cast<std::size_t>((dof - least_) / width_); }
  /// Those that meet on this rank.
  const Table& here() const { return table_; }
  /// Rows that made the dofs of here() one; by name.
  const std::map<long long, std::vector<Union>>& unions() const { return unions_; }

  /// Of the dofs in this rank's rows. @note Collective.
  struct Answers {
    Table copies;                        ///< by name
    std::map<long long, long long> name; ///< by dof; dofs that no subdomain has are missing
    /// Null: no subdomain has it.
    const std::vector<Copy>* of(long long dof) const;
    bool isUnited(long long dof) const;
  };
  Answers ask(const std::vector<ConstraintRow>& rows) const;

 private:
  std::map<long long, long long> namesOf(const std::vector<long long>& dofs) const;
  std::map<long long, int> rowsAt(const std::vector<long long>& dofs,
                                  const std::vector<ConstraintRow>& rows) const;
  struct Glue {
    std::vector<ConstraintRow> rows;
    std::vector<std::size_t> places; // among the rows given
  };
  Glue glueAmong(const std::vector<ConstraintRow>& rows, bool all) const;
  std::map<long long, long long> spreadNames(const std::vector<ConstraintRow>& glue);
  void moveCopies();

  const Teuchos::Comm<int>& comm_;
  long long least_ = 0, width_ = 1;
  Table table_;
  std::map<long long, long long> names_; // of dofs at home here that go by another
  std::map<long long, std::vector<Union>> unions_;
};

} // namespace Harmos::feti::Details
