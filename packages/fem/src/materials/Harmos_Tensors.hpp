// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

/// Tensors of the second order in space.
namespace Harmos::fem {

using Tensor = std::array<std::array<double, 3>, 3>;

/// Row and column of each entry of a symmetric tensor in Voigt's order, see Voigt.
constexpr std::array<std::array<std::size_t, 2>, 6> voigtPairs = {
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};

/// The entry at row a and column b of det(t) t⁻ᵀ.
inline double cofactor(const Tensor& t, std::size_t a, std::size_t b) {
  const std::size_t r = (a + 1) % 3, s = (a + 2) % 3, u = (b + 1) % 3, v = (b + 2) % 3;
  return t[r][u] * t[s][v] - t[r][v] * t[s][u];
}

inline double determinant(const Tensor& t) {
  return t[0][0] * cofactor(t, 0, 0) + t[0][1] * cofactor(t, 0, 1) + t[0][2] * cofactor(t, 0, 2);
}

/// det(I + t) − 1, to its own digits where t is small.
inline double determinantBeyondOne(const Tensor& t) {
  return t[0][0] + t[1][1] + t[2][2] + cofactor(t, 0, 0) + cofactor(t, 1, 1) + cofactor(t, 2, 2) +
         determinant(t);
}

/// t⁻ᵀ. @param det its determinant, not zero.
inline Tensor inverseTransposed(const Tensor& t, double det) {
  Tensor result;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      result[a][b] = cofactor(t, a, b) / det;
  return result;
}

} // namespace Harmos::fem
