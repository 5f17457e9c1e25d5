// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SparseCholesky.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <metis.h>
#include <numeric>
#include <type_traits>

namespace Harmos::feti {
namespace {

// Rows in METIS' order of elimination.
std::vector<int> nestedDissection(int n, const std::vector<int>& rows, const std::vector<int>& columns) {
  std::vector<std::vector<idx_t>> neighbours(static_cast<std::size_t>(n));
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] != columns[k]) {
      neighbours[static_cast<std::size_t>(rows[k])].push_back(columns[k]);
      neighbours[static_cast<std::size_t>(columns[k])].push_back(rows[k]);
    }
  std::vector<idx_t> offsets = {0}, adjacent;
  for (const std::vector<idx_t>& list : neighbours) {
    adjacent.insert(adjacent.end(), list.begin(), list.end());
    offsets.push_back(static_cast<idx_t>(adjacent.size()));
  }
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  if (adjacent.empty())
    return order;
  idx_t count = n;
  std::vector<idx_t> permutation(static_cast<std::size_t>(n)), inverse(static_cast<std::size_t>(n));
  const int status = METIS_NodeND(&count, offsets.data(), adjacent.data(), nullptr, nullptr,
                                  permutation.data(), inverse.data());
  HARMOS_REQUIRE(status == METIS_OK, "METIS could not order the coarse matrix");
  std::copy(permutation.begin(), permutation.end(), order.begin());
  return order;
}

} // namespace

template<class Real>
SparseCholesky::SparseCholesky(int n, const std::vector<int>& rows, const std::vector<int>& columns,
                               const std::vector<Real>& values, double relativeThreshold)
    : n_(n), order_(nestedDissection(n, rows, columns)) {
  const auto size = static_cast<std::size_t>(n);
  std::vector<int> place(size);
  for (std::size_t k = 0; k < size; ++k)
    place[static_cast<std::size_t>(order_[k])] = static_cast<int>(k);

  // Row k of the permuted matrix, its entries left of the diagonal.
  std::vector<std::vector<EntryOf<Real>>> a(size);
  std::vector<Real> diagonal(size, 0.0);
  Real largest = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int i = place[static_cast<std::size_t>(rows[k])], j = place[static_cast<std::size_t>(columns[k])];
    if (i == j) {
      diagonal[static_cast<std::size_t>(i)] = values[k];
      largest = std::max(largest, values[k]);
    } else {
      a[static_cast<std::size_t>(std::max(i, j))].push_back({std::min(i, j), values[k]});
    }
  }
  const Real zero = std::max(n * std::numeric_limits<double>::epsilon(), relativeThreshold) * largest;

  std::vector<std::vector<EntryOf<Real>>> below(size); // of L, under the diagonal
  std::vector<Real> roots(size, 1.0);
  std::vector<bool> isKept(size, false);
  std::vector<int> parent(size, -1), ancestor(size, -1), mark(size, -1), pattern, path;
  std::vector<Real> x(size, 0.0);
  for (std::size_t k = 0; k < size; ++k) {
    const int row = static_cast<int>(k);
    // The elimination tree, with compressed paths.
    for (const EntryOf<Real>& entry : a[k])
      for (int j = entry.row; j >= 0 && j < row;) {
        const int next = ancestor[static_cast<std::size_t>(j)];
        ancestor[static_cast<std::size_t>(j)] = row;
        if (next < 0)
          parent[static_cast<std::size_t>(j)] = row;
        j = next;
      }
    // Pattern of row k of L: what is reached in the tree from the entries of A, below k, in rising order.
    pattern.clear();
    mark[k] = row;
    for (const EntryOf<Real>& entry : a[k]) {
      x[static_cast<std::size_t>(entry.row)] = entry.value;
      for (int j = entry.row; j >= 0 && mark[static_cast<std::size_t>(j)] != row;
           j = parent[static_cast<std::size_t>(j)]) {
        mark[static_cast<std::size_t>(j)] = row;
        pattern.push_back(j);
      }
    }
    std::sort(pattern.begin(), pattern.end());
    Real pivot = diagonal[k];
    std::vector<Real> rowOfL(pattern.size());
    for (std::size_t p = 0; p < pattern.size(); ++p) {
      const auto j = static_cast<std::size_t>(pattern[p]);
      const Real value = isKept[j] ? x[j] / roots[j] : Real(0.0);
      x[j] = 0.0;
      rowOfL[p] = value;
      if (value == 0.0)
        continue;
      for (const EntryOf<Real>& entry : below[j])
        if (mark[static_cast<std::size_t>(entry.row)] == row)
          x[static_cast<std::size_t>(entry.row)] -= entry.value * value;
      pivot -= value * value;
    }
    x[k] = 0.0; // a column may reach the diagonal; the pivot was gathered apart
    if (!(pivot > zero)) {
      dependent_.push_back(order_[k]);
      continue;
    }
    isKept[k] = true;
    kept_.push_back(row);
    roots[k] = std::sqrt(pivot);
    smallestRatio_ = std::min(smallestRatio_, static_cast<double>(pivot / largest));
    for (std::size_t p = 0; p < pattern.size(); ++p)
      if (rowOfL[p] != 0.0)
        below[static_cast<std::size_t>(pattern[p])].push_back({row, rowOfL[p]});
  }
  if constexpr (std::is_same_v<Real, double>) {
    columns_ = std::move(below);
    diagonal_ = std::move(roots);
  } else {
    for (const std::vector<EntryOf<Real>>& column : below) {
      std::vector<Entry>& rounded = columns_.emplace_back();
      for (const EntryOf<Real>& entry : column)
        rounded.push_back({entry.row, static_cast<double>(entry.value)});
    }
    diagonal_.assign(roots.begin(), roots.end());
  }
}

template SparseCholesky::SparseCholesky(int, const std::vector<int>&, const std::vector<int>&,
                                        const std::vector<double>&, double);
template SparseCholesky::SparseCholesky(int, const std::vector<int>&, const std::vector<int>&,
                                        const std::vector<long double>&, double);

double SparseCholesky::entries() const {
  double sum = static_cast<double>(kept_.size());
  for (const std::vector<Entry>& column : columns_)
    sum += static_cast<double>(column.size());
  return sum;
}

std::vector<double> SparseCholesky::solveL(const std::vector<double>& e) const {
  std::vector<double> x(static_cast<std::size_t>(n_), 0.0), w;
  w.reserve(kept_.size());
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] = e[static_cast<std::size_t>(order_[k])];
  for (int place : kept_) {
    const auto k = static_cast<std::size_t>(place);
    x[k] /= diagonal_[k];
    w.push_back(x[k]);
    for (const Entry& entry : columns_[k])
      x[static_cast<std::size_t>(entry.row)] -= entry.value * x[k];
  }
  return w;
}

std::vector<double> SparseCholesky::solveLt(const std::vector<double>& w) const {
  std::vector<double> x(static_cast<std::size_t>(n_), 0.0), result(x.size(), 0.0);
  for (std::size_t r = kept_.size(); r-- > 0;) {
    const auto k = static_cast<std::size_t>(kept_[r]);
    double sum = w[r];
    for (const Entry& entry : columns_[k])
      sum -= entry.value * x[static_cast<std::size_t>(entry.row)];
    x[k] = sum / diagonal_[k];
    result[static_cast<std::size_t>(order_[k])] = x[k];
  }
  return result;
}

std::vector<double> SparseCholesky::multiplyL(const std::vector<double>& w) const {
  std::vector<double> result(static_cast<std::size_t>(n_), 0.0);
  for (std::size_t r = 0; r < kept_.size(); ++r) {
    const auto k = static_cast<std::size_t>(kept_[r]);
    result[static_cast<std::size_t>(order_[k])] += diagonal_[k] * w[r];
    for (const Entry& entry : columns_[k])
      result[static_cast<std::size_t>(order_[static_cast<std::size_t>(entry.row)])] += entry.value * w[r];
  }
  return result;
}

std::vector<double> SparseCholesky::multiplyLt(const std::vector<double>& v) const {
  std::vector<double> w;
  for (int place : kept_) {
    const auto k = static_cast<std::size_t>(place);
    double sum = diagonal_[k] * v[static_cast<std::size_t>(order_[k])];
    for (const Entry& entry : columns_[k])
      sum += entry.value * v[static_cast<std::size_t>(order_[static_cast<std::size_t>(entry.row)])];
    w.push_back(sum);
  }
  return w;
}

} // namespace Harmos::feti
