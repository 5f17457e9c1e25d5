// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LogarithmicStrain.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::fem {

Eigenpairs eigenpairsOf(const Tensor& symmetric) {
  Tensor a = symmetric;
  Eigenpairs pairs;
  for (std::size_t d = 0; d < 3; ++d)
    pairs.vectors[d][d] = 1.0;
  constexpr int mostSweeps = 30; // five or six are usual
  for (int sweep = 0; sweep < mostSweeps; ++sweep) {
    const double off = std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]);
    if (off <= 1e-17 * (std::abs(a[0][0]) + std::abs(a[1][1]) + std::abs(a[2][2])))
      break;
    for (std::size_t p = 0; p < 2; ++p)
      for (std::size_t q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0.0)
          continue;
        const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
        const double c = 1.0 / std::hypot(t, 1.0), s = t * c;
        for (std::size_t k = 0; k < 3; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
          const double vp = pairs.vectors[k][p], vq = pairs.vectors[k][q];
          pairs.vectors[k][p] = c * vp - s * vq;
          pairs.vectors[k][q] = s * vp + c * vq;
        }
      }
  }
  pairs.values = {a[0][0], a[1][1], a[2][2]};
  return pairs;
}

Tensor exponentialOf(const Tensor& symmetric) {
  const Eigenpairs pairs = eigenpairsOf(symmetric);
  Tensor result{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t k = 0; k < 3; ++k)
        result[a][b] += std::exp(pairs.values[k]) * pairs.vectors[a][k] * pairs.vectors[b][k];
  return result;
}

namespace {

// ln[a, b] = (ln a − ln b)/(a − b).
double firstDifference(double a, double b) {
  const double x = (a - b) / b;
  return x == 0.0 ? 1.0 / b : std::log1p(x) / x / b;
}

// ln[a, b, c]. Where they are close, by the series about their mean, Σ ln⁽ⁿ⁺²⁾(m)/(n + 2)! hₙ(a − m, b − m, c
// − m) with the complete symmetric polynomials hₙ.
double secondDifference(double a, double b, double c) {
  constexpr double close = 0.05;
  const double m = (a + b + c) / 3.0, x = (a - m) / m, y = (b - m) / m, z = (c - m) / m;
  if (std::max({std::abs(x), std::abs(y), std::abs(z)}) > close) {
    // The two that are farthest apart divide.
    if (std::abs(a - c) < std::abs(a - b))
      std::swap(b, c);
    if (std::abs(a - c) < std::abs(b - c))
      std::swap(a, b);
    return (firstDifference(a, b) - firstDifference(b, c)) / (a - c);
  }
  constexpr int terms = 12; // 0.1¹² is rounding errors
  double sum = 0.0, ofZ = 1.0, ofYZ = 1.0, ofAll = 1.0;
  for (int n = 0; n < terms; ++n) {
    sum += (n % 2 == 0 ? -1.0 : 1.0) / static_cast<double>(n + 2) * ofAll;
    ofZ *= z;
    ofYZ = y * ofYZ + ofZ;
    ofAll = x * ofAll + ofYZ;
  }
  return sum / (m * m);
}

// Vᵀ T V.
Tensor along(const Tensor& vectors, const Tensor& t) {
  Tensor half{}, result{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t b = 0; b < 3; ++b)
        half[a][j] += t[a][b] * vectors[b][j];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t a = 0; a < 3; ++a)
        result[i][j] += vectors[a][i] * half[a][j];
  return result;
}

} // namespace

LogarithmicStrain::LogarithmicStrain(const Voigt& strain, const Tensor& inverse) {
  Tensor c{};
  for (std::size_t r = 0; r < 6; ++r) {
    const auto [i, j] = voigtPairs[r];
    c[i][j] = c[j][i] = i == j ? 1.0 + 2.0 * strain[r] : strain[r];
  }
  Tensor a = along(inverse, c);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < i; ++j)
      a[i][j] = a[j][i];
  pairs_ = eigenpairsOf(a);
  isSound_ = *std::min_element(pairs_.values.begin(), pairs_.values.end()) > 0.0;
  if (!isSound_)
    return;
  for (std::size_t r = 0; r < 6; ++r) {
    const auto [i, j] = voigtPairs[r];
    for (std::size_t k = 0; k < 3; ++k)
      strain_[r] +=
          (i == j ? 0.5 : 1.0) * std::log(pairs_.values[k]) * pairs_.vectors[i][k] * pairs_.vectors[j][k];
    Tensor change{};
    change[i][j] = change[j][i] = i == j ? 2.0 : 1.0;
    changes_[r] = along(pairs_.vectors, along(inverse, change));
  }
}

void LogarithmicStrain::pullBack(Voigt& stress, VoigtMatrix& tangent) const {
  Tensor t{};
  for (std::size_t r = 0; r < 6; ++r)
    t[voigtPairs[r][0]][voigtPairs[r][1]] = t[voigtPairs[r][1]][voigtPairs[r][0]] = stress[r];
  t = along(pairs_.vectors, t);
  const auto& of = pairs_.values;
  Tensor first{};
  std::array<Tensor, 3> second{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      first[i][j] = firstDifference(of[i], of[j]);
      for (std::size_t k = 0; k < 3; ++k)
        second[i][j][k] = secondDifference(of[i], of[j], of[k]);
    }
  VoigtMatrix derivative{}, half{}; // ∂H/∂E, by columns, and D times it
  for (std::size_t s = 0; s < 6; ++s) {
    stress[s] = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const double change = 0.5 * first[i][j] * changes_[s][i][j];
        stress[s] += t[i][j] * change;
        for (std::size_t r = 0; r < 6; ++r) {
          const auto [a, b] = voigtPairs[r];
          derivative[r][s] += (a == b ? 1.0 : 2.0) * change * pairs_.vectors[a][i] * pairs_.vectors[b][j];
        }
      }
  }
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t s = 0; s < 6; ++s)
        half[r][s] += tangent[r][a] * derivative[a][s];
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t s = r; s < 6; ++s) {
      double sum = 0.0;
      for (std::size_t a = 0; a < 6; ++a)
        sum += derivative[a][r] * half[a][s];
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          for (std::size_t k = 0; k < 3; ++k)
            sum += 0.5 * second[i][j][k] * t[k][i] *
                   (changes_[r][i][j] * changes_[s][j][k] + changes_[s][i][j] * changes_[r][j][k]);
      tangent[r][s] = tangent[s][r] = sum;
    }
}

} // namespace Harmos::fem
