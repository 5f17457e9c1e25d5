// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FixingDofs.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <limits>

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

} // namespace

std::vector<int> fixingDofs(const LocalMatrix& matrix, int count) {
  const int n = matrix.rows();
  std::vector<int> result;
  if (n == 0)
    return result;
  const std::vector<int> far(static_cast<std::size_t>(n), std::numeric_limits<int>::max());
  std::vector<int> distance = far;
  spread(matrix, 0, distance);
  const int first = farthest(distance);
  distance = far;
  for (int next = first; static_cast<int>(result.size()) < std::min(count, n); next = farthest(distance)) {
    result.push_back(next);
    spread(matrix, next, distance);
  }
  std::sort(result.begin(), result.end());
  return result;
}

LocalMatrix regularized(const LocalMatrix& matrix, const Kernel& kernel, const std::vector<int>& fixing) {
  // N with orthonormal columns makes N(NᵀN)⁻¹Nᵀ = NNᵀ.
  Kernel rows;
  rows.rows = static_cast<int>(fixing.size());
  rows.columns = kernel.columns;
  for (int k = 0; k < kernel.columns; ++k)
    for (int dof : fixing)
      rows.values.push_back(kernel.column(k)[dof]);
  const Kernel n = heldKernel(rows, {});
  double rho = 0.0;
  for (double entry : matrix.diagonal())
    rho = std::max(rho, entry);

  std::vector<MatrixEntry> entries;
  for (int a = 0; a < rows.rows; ++a)
    for (int b = 0; b < rows.rows; ++b) {
      double value = 0.0;
      for (int k = 0; k < n.columns; ++k)
        value += n.column(k)[a] * n.column(k)[b];
      entries.push_back(
          {fixing[static_cast<std::size_t>(a)], fixing[static_cast<std::size_t>(b)], rho * value});
    }
  for (int i = 0; i < matrix.rows(); ++i)
    for (std::size_t k = matrix.offsets[static_cast<std::size_t>(i)];
         k < matrix.offsets[static_cast<std::size_t>(i) + 1]; ++k)
      entries.push_back({i, matrix.columns[k], matrix.values[k]});
  return makeLocalMatrix(matrix.rows(), std::move(entries));
}

} // namespace Harmos::feti
