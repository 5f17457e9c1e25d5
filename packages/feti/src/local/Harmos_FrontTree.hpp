// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalMatrix.hpp"

#include <cstddef>
#include <vector>

namespace Harmos::feti {

/// In which order a sparse symmetric matrix is eliminated, and in which dense pieces: the assembly tree of
/// the multifrontal method (Duff, Reid: The multifrontal solution of indefinite sparse symmetric linear
/// systems, ACM Trans. Math. Softw. 9, 1983; Davis: Direct methods for sparse linear systems, SIAM 2006,
/// chapter 4).
///
/// Columns of L with the same rows below make a front. Fronts with few columns are joined with their parent
/// where that stores few zeros. Children stand before their parents; places are counted in the order of
/// elimination. Depends on the pattern alone.
///
/// Guarded by tests/unit/feti/local/test_multifrontal_cholesky.cpp.
struct FrontTree {
  struct Front {
    int first = 0;           ///< place of its first column
    int columns = 0;         ///< k
    int below = 0;           ///< r: rows of L below them
    int inner = 0;           ///< those of them that are eliminated, which come first: L keeps no others
    int parent = -1;         ///< or −1: what it leaves is of rows that stay, or nothing
    std::size_t rows = 0;    ///< where its places below begin in `rows`, rising
    std::size_t entries = 0; ///< where its columns begin in the factor, panel after panel

    int height() const { return columns + inner; } ///< of what is kept
  };
  /// What becomes of rows that are not eliminated.
  enum class Rest {
    Stays, ///< what is left of them is wanted: their Schur complement
    Absent ///< they are not there: the factor of a part of the matrix is wanted
  };

  /// Columns of a panel, in which the factor is stored: a trapezoid in a rectangle wastes half their square.
  static constexpr int panelColumns = 48;

  FrontTree() = default;
  /// @param rest rows that are not eliminated; rising. Those that stay take the last places, in their order.
  /// @param like of the same pattern with other rows left; or null. Where it eliminates nearly all that this
  /// does its order is taken: METIS' takes longer than all else that is done here.
  /// @throws InternalError if METIS fails.
  FrontTree(const LocalMatrix& pattern, const std::vector<int>& rest, Rest use = Rest::Stays,
            const FrontTree* like = nullptr);

  /// Of places.
  int size() const { return static_cast<int>(order.size()); }
  /// Rows that are eliminated.
  int eliminated() const { return size() - remaining; }

  std::vector<int> order; ///< row of the matrix at each place
  std::vector<int> place; ///< of each row of the matrix; −1 of absent ones
  std::vector<Front> fronts;
  std::vector<int> rows; ///< places below, front after front
  int remaining = 0;     ///< rows that stay

  std::size_t factorEntries = 0; ///< of L, stored
  std::size_t stackEntries = 0;  ///< most entries of update matrices that wait for their parents
  int largestFront = 0;          ///< most rows, k + r
  double flops = 0.0;            ///< of the numerical factorisation

  /// Fronts that a solution needs of which only these rows have loads, and only they are asked for: those
  /// that hold one of them, and all above.
  std::vector<char> reachedFrom(const std::vector<int>& matrixRows) const;
  /// Entries of L in the fronts that are reached.
  double entriesOf(const std::vector<char>& reached) const;
};

} // namespace Harmos::feti
