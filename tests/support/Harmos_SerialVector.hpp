// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// A serial vector and operator with what Belos asks of them.

#include "Harmos_TestModel.hpp"

#include <BelosMultiVecTraits.hpp>
#include <BelosOperatorTraits.hpp>
#include <Teuchos_SerialDenseMatrix.hpp>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace Harmos {

struct SerialVector {
  std::vector<std::vector<double>> columns;
  SerialVector(std::size_t length, int count)
      : columns(static_cast<std::size_t>(count), std::vector<double>(length, 0.0)) {}
  explicit SerialVector(const std::vector<double>& values) : columns{values} {}
  std::vector<double>& operator()() { return columns.front(); }
  const std::vector<double>& operator()() const { return columns.front(); }
};

struct SerialOperator {
  Dense matrix;
};

} // namespace Harmos

namespace Belos {

template<>
class MultiVecTraits<double, Harmos::SerialVector> {
  using MV = Harmos::SerialVector;
  using Matrix = Teuchos::SerialDenseMatrix<int, double>;

 public:
  static Teuchos::RCP<MV> Clone(const MV& v, int n) {
    return Teuchos::rcp(new MV(v.columns.front().size(), n));
  }
  static Teuchos::RCP<const MV> CloneView(const MV& v, const Teuchos::Range1D& range) {
    const Teuchos::RCP<MV> copy = Clone(v, static_cast<int>(range.size()));
    std::copy(v.columns.begin() + range.lbound(), v.columns.begin() + range.ubound() + 1,
              copy->columns.begin());
    return copy;
  }
  static void SetBlock(const MV& from, const Teuchos::Range1D& range, MV& to) {
    std::copy(from.columns.begin(), from.columns.begin() + range.size(), to.columns.begin() + range.lbound());
  }
  static Teuchos::RCP<MV> CloneCopy(const MV& v) { return Teuchos::rcp(new MV(v)); }
  static std::ptrdiff_t GetGlobalLength(const MV& v) {
    return static_cast<std::ptrdiff_t>(v.columns.front().size());
  }
  static int GetNumberVecs(const MV& v) { return static_cast<int>(v.columns.size()); }
  static void MvAddMv(double a, const MV& x, double b, const MV& y, MV& z) {
    for (std::size_t c = 0; c < z.columns.size(); ++c)
      for (std::size_t i = 0; i < z.columns[c].size(); ++i)
        z.columns[c][i] = (a == 0.0 ? 0.0 : a * x.columns[c][i]) + (b == 0.0 ? 0.0 : b * y.columns[c][i]);
  }
  static void MvTimesMatAddMv(double a, const MV& x, const Matrix& m, double b, MV& y) {
    for (int c = 0; c < m.numCols(); ++c)
      for (std::size_t i = 0; i < y.columns.front().size(); ++i) {
        double sum = b == 0.0 ? 0.0 : b * y.columns[static_cast<std::size_t>(c)][i];
        for (int k = 0; k < m.numRows(); ++k)
          sum += a * x.columns[static_cast<std::size_t>(k)][i] * m(k, c);
        y.columns[static_cast<std::size_t>(c)][i] = sum;
      }
  }
  static void MvTransMv(double a, const MV& x, const MV& y, Matrix& m) {
    for (int i = 0; i < m.numRows(); ++i)
      for (int j = 0; j < m.numCols(); ++j) {
        m(i, j) = 0.0;
        for (std::size_t k = 0; k < x.columns.front().size(); ++k)
          m(i, j) +=
              a * x.columns[static_cast<std::size_t>(i)][k] * y.columns[static_cast<std::size_t>(j)][k];
      }
  }
  static void MvScale(MV& v, double a) {
    for (auto& column : v.columns)
      for (double& value : column)
        value *= a;
  }
  static void MvDot(const MV& x, const MV& y, std::vector<double>& dots) {
    for (std::size_t c = 0; c < x.columns.size(); ++c) {
      dots[c] = 0.0;
      for (std::size_t i = 0; i < x.columns[c].size(); ++i)
        dots[c] += x.columns[c][i] * y.columns[c][i];
    }
  }
  static void MvNorm(const MV& v, std::vector<double>& norms, NormType = TwoNorm) {
    MvDot(v, v, norms);
    for (std::size_t c = 0; c < v.columns.size(); ++c)
      norms[c] = std::sqrt(norms[c]);
  }
  static void Assign(const MV& from, MV& to) { to.columns = from.columns; }
  static void MvInit(MV& v, double a = 0.0) {
    for (auto& column : v.columns)
      std::fill(column.begin(), column.end(), a);
  }
};

template<>
class OperatorTraits<double, Harmos::SerialVector, Harmos::SerialOperator> {
 public:
  static void Apply(const Harmos::SerialOperator& op, const Harmos::SerialVector& x, Harmos::SerialVector& y,
                    ETrans mode = NOTRANS) {
    const Harmos::Dense& m = op.matrix;
    std::vector<double> result(static_cast<std::size_t>(mode == NOTRANS ? m.rows : m.columns), 0.0);
    for (int i = 0; i < m.rows; ++i)
      for (int j = 0; j < m.columns; ++j) {
        const auto from = static_cast<std::size_t>(mode == NOTRANS ? j : i);
        const auto to = static_cast<std::size_t>(mode == NOTRANS ? i : j);
        result[to] += m(i, j) * x()[from];
      }
    y() = result;
  }
  static bool HasApplyTranspose(const Harmos::SerialOperator&) { return true; }
};

} // namespace Belos
