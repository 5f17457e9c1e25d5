// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LocalMatrix.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace Harmos {

void LocalMatrix::multiply(const double* x, double* y) const {
  const int n = rows();
  for (int i = 0; i < n; ++i) {
    double sum = 0.0;
    for (std::size_t k = offsets[static_cast<std::size_t>(i)]; k < offsets[static_cast<std::size_t>(i) + 1];
         ++k)
      sum += values[k] * x[columns[k]];
    y[i] = sum;
  }
}

std::vector<double> LocalMatrix::diagonal() const {
  std::vector<double> result(offsets.size() - 1, 0.0);
  for (std::size_t i = 0; i < result.size(); ++i)
    for (std::size_t k = offsets[i]; k < offsets[i + 1]; ++k)
      if (columns[k] == static_cast<int>(i))
        result[i] = values[k];
  return result;
}

double LocalMatrix::maxNorm() const {
  double result = 0.0;
  for (double value : values)
    result = std::max(result, std::abs(value));
  return result;
}

double LocalMatrix::infinityNorm() const {
  double result = 0.0;
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
    double sum = 0.0;
    for (std::size_t k = offsets[i]; k < offsets[i + 1]; ++k)
      sum += std::abs(values[k]);
    result = std::max(result, sum);
  }
  return result;
}

std::size_t patternHash(const LocalMatrix& matrix) {
  // FNV-1a, a word at a time.
  std::size_t hash = 1469598103934665603ULL;
  const auto mix = [&](std::size_t word) { hash = (hash ^ word) * 1099511628211ULL; };
  mix(matrix.offsets.size());
  for (std::size_t offset : matrix.offsets)
    mix(offset);
  for (int column : matrix.columns)
    mix(static_cast<std::size_t>(column));
  return hash;
}

bool sameContent(const LocalMatrix& a, const LocalMatrix& b, double tolerance) {
  if (&a == &b)
    return true;
  if (a.offsets.size() != b.offsets.size() || a.values.size() != b.values.size())
    return false;
  // Values first: matrices of different materials differ in one of the first.
  const std::vector<double> diagonal = a.diagonal();
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    if (a.offsets[i + 1] != b.offsets[i + 1])
      return false;
    for (std::size_t k = a.offsets[i]; k < a.offsets[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(a.columns[k]);
      if (a.columns[k] != b.columns[k] || !(std::abs(a.values[k] - b.values[k]) <=
                                            tolerance * std::sqrt(diagonal[i]) * std::sqrt(diagonal[j])))
        return false;
    }
  }
  return true;
}

Triplets lowerTriangle(const LocalMatrix& matrix, int base) {
  Triplets result;
  for (int i = 0; i < matrix.rows(); ++i)
    for (std::size_t k = matrix.offsets[static_cast<std::size_t>(i)];
         k < matrix.offsets[static_cast<std::size_t>(i) + 1]; ++k)
      if (matrix.columns[k] <= i) {
        result.rows.push_back(i + base);
        result.columns.push_back(matrix.columns[k] + base);
        result.values.push_back(matrix.values[k]);
      }
  return result;
}

LocalMatrix makeLocalMatrix(int rows, std::vector<MatrixEntry> entries) {
  std::stable_sort(entries.begin(), entries.end(), [](const MatrixEntry& a, const MatrixEntry& b) {
    return std::tie(a.row, a.column) < std::tie(b.row, b.column);
  });
  LocalMatrix matrix;
  matrix.offsets.assign(static_cast<std::size_t>(rows) + 1, 0);
  int lastRow = -1;
  for (const MatrixEntry& entry : entries) {
    HARMOS_REQUIRE(entry.row >= 0 && entry.row < rows && entry.column >= 0 && entry.column < rows,
                   "a matrix entry lies outside of the matrix");
    if (entry.row == lastRow && matrix.columns.back() == entry.column) {
      matrix.values.back() += entry.value;
      continue;
    }
    lastRow = entry.row;
    matrix.columns.push_back(entry.column);
    matrix.values.push_back(entry.value);
    ++matrix.offsets[static_cast<std::size_t>(entry.row) + 1];
  }
  for (std::size_t i = 0; i + 1 < matrix.offsets.size(); ++i)
    matrix.offsets[i + 1] += matrix.offsets[i];
  return matrix;
}

LocalMatrix sum(const LocalMatrix& a, const LocalMatrix& b) {
  HARMOS_REQUIRE(a.rows() == b.rows(), "matrices of different orders cannot be added");
  LocalMatrix result;
  result.offsets.reserve(a.offsets.size());
  result.columns.reserve(a.columns.size() + b.columns.size());
  result.values.reserve(a.values.size() + b.values.size());
  for (std::size_t i = 0; i + 1 < a.offsets.size(); ++i) {
    std::size_t k = a.offsets[i], l = b.offsets[i];
    while (k < a.offsets[i + 1] || l < b.offsets[i + 1]) {
      const bool fromB = k == a.offsets[i + 1] || (l < b.offsets[i + 1] && b.columns[l] < a.columns[k]);
      const bool both = !fromB && l < b.offsets[i + 1] && b.columns[l] == a.columns[k];
      result.columns.push_back(fromB ? b.columns[l] : a.columns[k]);
      result.values.push_back(fromB ? b.values[l] : both ? a.values[k] + b.values[l] : a.values[k]);
      k += fromB ? 0 : 1;
      l += fromB || both ? 1 : 0;
    }
    result.offsets.push_back(result.columns.size());
  }
  return result;
}

} // namespace Harmos
