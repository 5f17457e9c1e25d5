// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FixingDofs.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace Harmos::feti {
namespace {

// Lowers distance[·] to the distances from a dof, where they are smaller.
void spread(const LocalMatrix& matrix, int from, std::vector<int>& distance) {
  std::vector<int> front = {from};
  distance[static_cast<std::size_t>(from)] = 0;
  while (!front.empty()) {
    std::vector<int> next;
    for (int dof : front) {
      const auto i = static_cast<std::size_t>(dof);
      for (std::size_t k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k) {
        const auto j = static_cast<std::size_t>(matrix.columns[k]);
        if (distance[j] > distance[i] + 1) {
          distance[j] = distance[i] + 1;
          next.push_back(matrix.columns[k]);
        }
      }
    }
    front.swap(next);
  }
}

int farthest(const std::vector<int>& distance) {
  return static_cast<int>(std::max_element(distance.begin(), distance.end()) - distance.begin());
}

// Of the dofs around a place those that hold motions of their own there: the place itself, then whichever
// row of R sticks out most of those taken. In elasticity these are the components of one displacement.
std::vector<int> dofsAt(const LocalMatrix& matrix, const Kernel& kernel, int place) {
  const auto columns = static_cast<std::size_t>(kernel.columns);
  const auto rowOf = [&](int dof) {
    std::vector<double> row(columns);
    for (int k = 0; k < kernel.columns; ++k)
      row[static_cast<std::size_t>(k)] = kernel.column(k)[dof];
    return row;
  };
  const auto dot = [](const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  };
  const auto i = static_cast<std::size_t>(place);
  std::vector<int> candidates(matrix.columns.begin() + static_cast<std::ptrdiff_t>(matrix.offsets[i]),
                              matrix.columns.begin() + static_cast<std::ptrdiff_t>(matrix.offsets[i + 1]));
  std::vector<std::vector<double>> rest;
  for (int candidate : candidates)
    rest.push_back(rowOf(candidate));
  const double scale = std::sqrt(dot(rowOf(place), rowOf(place)));
  constexpr double independent = 0.3; // of the length of a row; neighbouring nodes differ by less
  std::vector<int> result;
  int next = static_cast<int>(std::find(candidates.begin(), candidates.end(), place) - candidates.begin());
  while (next >= 0 && static_cast<int>(result.size()) < kernel.columns) {
    const auto chosen = static_cast<std::size_t>(next);
    const std::vector<double> direction = rest[chosen];
    const double length2 = dot(direction, direction);
    result.push_back(candidates[chosen]);
    next = -1;
    double longest = independent * scale;
    for (std::size_t c = 0; c < rest.size(); ++c) {
      const double product = length2 > 0.0 ? dot(rest[c], direction) / length2 : 0.0;
      for (std::size_t k = 0; k < columns; ++k)
        rest[c][k] -= product * direction[k];
      const double length = std::sqrt(dot(rest[c], rest[c]));
      if (length > longest * (1.0 + 1e-8)) { // of equals the first
        longest = length;
        next = static_cast<int>(c);
      }
    }
  }
  return result;
}

// N^T N is far from singular: rows of R at evenly spread dofs have singular values of sqrt(m/n).
bool holds(const Kernel& kernel, const std::vector<int>& dofs) {
  if (static_cast<int>(dofs.size()) < kernel.columns)
    return false;
  const Kernel rows = restricted(kernel, dofs);
  return smallestSingularValue(rows) >= 0.1 * std::sqrt(static_cast<double>(rows.rows) / kernel.rows);
}

} // namespace

std::vector<int> fixingDofs(const LocalMatrix& matrix, const Kernel& kernel, int places) {
  const int n = matrix.rows();
  std::vector<int> result;
  if (n == 0)
    return result;
  const std::vector<int> far(static_cast<std::size_t>(n), std::numeric_limits<int>::max());
  std::vector<int> distance = far;
  spread(matrix, 0, distance);
  const int first = farthest(distance);
  distance = far;
  int taken = 0;
  for (int next = first; taken < n && distance[static_cast<std::size_t>(next)] > 0;
       next = farthest(distance)) {
    // Places are added until they hold the kernel, should the wanted number not do.
    if (taken >= places && holds(kernel, result))
      break;
    for (int dof : dofsAt(matrix, kernel, next))
      if (std::find(result.begin(), result.end(), dof) == result.end())
        result.push_back(dof);
    spread(matrix, next, distance);
    ++taken;
  }
  std::sort(result.begin(), result.end());
  return result;
}

Kernel regularization(const Kernel& rows, const std::vector<double>& diagonal) {
  const auto scaleRows = [&](Kernel& kernel) {
    for (int k = 0; k < kernel.columns; ++k)
      for (int i = 0; i < kernel.rows; ++i)
        kernel.values[static_cast<std::size_t>(k) * static_cast<std::size_t>(kernel.rows) +
                      static_cast<std::size_t>(i)] *= std::sqrt(diagonal[static_cast<std::size_t>(i)]);
  };
  Kernel v = rows;
  scaleRows(v);
  v = heldKernel(v, {});
  scaleRows(v);
  return v;
}

Kernel regularizationAt(const LocalMatrix& matrix, const Kernel& kernel, const std::vector<int>& fixing) {
  const std::vector<double> diagonal = matrix.diagonal();
  std::vector<double> weights;
  for (int dof : fixing)
    weights.push_back(diagonal[static_cast<std::size_t>(dof)]);
  return regularization(restricted(kernel, fixing), weights);
}

LocalMatrix withRegularization(const LocalMatrix& matrix, const Kernel& v, const std::vector<int>& fixing) {
  std::vector<MatrixEntry> entries;
  for (int a = 0; a < v.rows; ++a)
    for (int b = 0; b < v.rows; ++b) {
      double value = 0.0;
      for (int k = 0; k < v.columns; ++k)
        value += v.column(k)[a] * v.column(k)[b];
      entries.push_back({fixing[static_cast<std::size_t>(a)], fixing[static_cast<std::size_t>(b)], value});
    }
  return sum(matrix, makeLocalMatrix(matrix.rows(), std::move(entries)));
}

LocalMatrix regularized(const LocalMatrix& matrix, const Kernel& kernel, const std::vector<int>& fixing) {
  return withRegularization(matrix, regularizationAt(matrix, kernel, fixing), fixing);
}

} // namespace Harmos::feti
