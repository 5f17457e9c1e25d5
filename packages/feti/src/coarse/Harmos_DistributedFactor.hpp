// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mumps.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_RCP.hpp>

#include <memory>
#include <mpi.h>
#include <utility>
#include <vector>

namespace Harmos::feti {

/// The graph of a symmetric matrix A = ΣA_r of which each rank r has some entries, and how these get to
/// groups of ranks: each group has all of A in shares, no rank of two or more has it whole.
///
/// Rows and columns are numbered by rank: those of rank 0, of rank 1, ...; places().
/// Guarded by tests/unit/feti/coarse/test_distributed_factor.cpp.
class DistributedGraph {
 public:
  /// @param own rows that are this rank's. @param entries of A_r, either triangle, each once. @param
  /// groupRanks of a group, at least; groups are as equal as they can be. @note Collective.
  DistributedGraph(Teuchos::RCP<const Teuchos::Comm<int>> comm, int own,
                   const std::vector<std::pair<int, int>>& entries, int groupRanks);

  const Teuchos::Comm<int>& comm() const { return *comm_; }
  MPI_Comm world() const { return world_; }
  MPI_Comm group() const { return *group_; }
  int groupRank() const { return groupRank_; }
  int groupSize() const { return groupSize_; }
  int groups() const { return groups_; }

  int order() const { return firsts_.back(); }
  /// Of this rank's rows: the first one's number, and how many there are.
  int first() const { return firsts_[static_cast<std::size_t>(comm_->getRank())]; }
  int own() const { return static_cast<int>(counts_[static_cast<std::size_t>(comm_->getRank())]); }
  /// Most rows of a rank.
  int mostOwn() const;
  /// By rank, and of firsts() the end.
  const std::vector<int>& firsts() const { return firsts_; }
  const std::vector<int>& counts() const { return counts_; }
  /// Of the ranks of this group in the numbers of comm(): from firstOfGroup() on.
  int firstOfGroup() const { return firstOfGroup_; }

  /// This rank's share of the group's entries, one-based; the diagonal is among them, and places may be there
  /// several times: values add up.
  const std::vector<int>& rows() const { return rows_; }
  const std::vector<int>& columns() const { return columns_; }
  /// Values of the share. @param values of this rank's entries. @param leftOut rows, rising, that with their
  /// columns are to be those of the unit matrix times `unit`. @note Collective.
  std::vector<double> share(const std::vector<double>& values, const std::vector<int>& leftOut,
                            double unit) const;
  /// All entries of a vector, of which each rank has its own. @note Collective, one all-gather.
  std::vector<double> gather(const std::vector<double>& own) const;
  /// @param sums of the ranks, to be added up over them with the same all-gather.
  std::vector<double> gather(const std::vector<double>& own, std::vector<double>& sums) const;

  /// The order of elimination of the first factorisation, on the first rank of a group; see Mumps.
  std::vector<int>& ordering() const { return ordering_; }

 private:
  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  MPI_Comm world_ = MPI_COMM_NULL;
  std::shared_ptr<MPI_Comm> group_;
  int groups_ = 1, groupRank_ = 0, groupSize_ = 1, firstOfGroup_ = 0;
  std::vector<int> counts_, firsts_;
  std::vector<int> targets_; // of this rank's entries: a rank of each group
  std::size_t entries_ = 0;
  std::vector<int> rows_, columns_;
  mutable std::vector<int> ordering_;
};

/// A⁻ of a symmetric positive semidefinite matrix that no rank holds: LDLᵀ by MUMPS in each group of ranks,
/// with rows left out whose pivot is a rounding error. What the group that finds most leaves out all leave
/// out.
///
/// Where memory allows, each rank keeps the rows of A⁻ that are its own, dense: a product costs an all-gather
/// and n·own multiplications then, and goes on falling with the number of ranks (ESPRESO's way; Říha et al.,
/// Adv. Eng. Softw. 103, 2017). Else the first rank of each group solves for its ranks.
/// Guarded by tests/unit/feti/coarse/test_distributed_factor.cpp.
class DistributedFactor {
 public:
  enum class Form { Rows, Solves };
  struct Options {
    Form form = Form::Rows;
    double threshold = 0.0;   ///< pivots below this part of the largest entry count as zero
    std::vector<int> leftOut; ///< rows to be left out at any rate, rising
  };

  /// @param values of this rank's entries, as they were given to it.
  /// @throws NumericalError, InternalError on all ranks, as Mumps does. @note Collective.
  DistributedFactor(const DistributedGraph& graph, const std::vector<double>& values, const Options& options);

  /// Rows left out, rising.
  const std::vector<int>& leftOut() const { return leftOut_; }
  bool isLeftOut(int row) const;
  /// A⁻e on this rank's rows, zero at those left out. Entries are not numbers if a solve failed.
  /// @note Collective, one all-gather; in the form of solves messages within groups, too.
  std::vector<double> solve(const std::vector<double>& e) const;
  /// @param sums of the ranks, to be added up over them with the same all-gather.
  std::vector<double> solve(const std::vector<double>& e, std::vector<double>& sums) const;

  Form form() const { return form_; }
  /// Of L, on all ranks of a group.
  double entries() const { return entries_; }
  /// Bytes of this rank: of rows, and MUMPS' of the group in equal parts.
  double bytes() const { return bytes_; }
  /// Largest entry on the diagonal of A⁻ on this rank, of rows; 0 in the form of solves.
  double largestDiagonal() const;

 private:
  void factor(const std::vector<double>& values, double threshold);
  std::vector<int> nullRows() const;
  void leaveOutWeakRows(const std::vector<double>& values, double threshold);
  std::vector<double> solveByGroups(const std::vector<double>& e, std::vector<double>& sums) const;
  void makeRows();

  const DistributedGraph& graph_;
  std::unique_ptr<Mumps> mumps_;
  std::vector<int> leftOut_;
  Form form_;
  std::vector<double> inverse_; // columns of A⁻ of this rank's rows, one after the other
  double entries_ = 0.0, bytes_ = 0.0;
};

} // namespace Harmos::feti
