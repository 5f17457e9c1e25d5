// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FiniteStrain.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::fem {
namespace {

// FᵀF, as strains in Voigt: twice the entries off the diagonal.
Voigt squareOf(const DeformationGradient& f) {
  Voigt c{};
  for (std::size_t r = 0; r < 6; ++r) {
    const auto [i, j] = voigtPairs[r];
    for (std::size_t a = 0; a < 3; ++a)
      c[r] += (i == j ? 1.0 : 2.0) * f[a][i] * f[a][j];
  }
  return c;
}

// E = ½(H + Hᵀ + HᵀH), H = F − I, without the digits that F and I have in common.
Voigt greenStrain(const Tensor& h) {
  Voigt e{};
  for (std::size_t r = 0; r < 6; ++r) {
    const auto [i, j] = voigtPairs[r];
    double sum = h[i][j] + h[j][i];
    for (std::size_t a = 0; a < 3; ++a)
      sum += h[a][i] * h[a][j];
    e[r] = i == j ? 0.5 * sum : sum;
  }
  return e;
}

} // namespace

FiniteStrain::FiniteStrain(const Mesh& mesh, const CellIntegrator& cell, bool projected)
    : cell_(cell),
      dimension_(static_cast<std::size_t>(mesh.dimension())),
      rows_(dimension_ == 2 ? 4 : 6),
      dofs_(static_cast<std::size_t>(cell.basisSize()) * dimension_),
      projected_(projected),
      hasHoop_(mesh.isAxisymmetric),
      space_(mesh, cell),
      gradients_(static_cast<std::size_t>(cell.points())),
      dilatations_(gradients_.size()),
      factors_(gradients_.size(), 1.0),
      strains_(gradients_.size()),
      values_(gradients_.size() * rows_ * dofs_) {}

void FiniteStrain::update(const double* values, bool needsOperator) {
  findGradients(values);
  if (!(leastJacobian_ > 0.0))
    return;
  if (projected_) {
    findProjection();
    leastJacobian_ = std::min(leastJacobian_, 1.0 + *std::min_element(smooth_.begin(), smooth_.end()));
    if (!(leastJacobian_ > 0.0))
      return;
    projectStrains();
  }
  if (!needsOperator)
    return;
  findOperator();
  if (projected_)
    project();
}

void FiniteStrain::findGradients(const double* values) {
  for (std::size_t q = 0; q < points(); ++q) {
    const int iq = static_cast<int>(q);
    Tensor h{}; // F − I
    for (int i = 0; i < cell_.basisSize(); ++i) {
      const Point& g = cell_.gradient(i, iq);
      const double* u = values + static_cast<std::size_t>(i) * dimension_;
      for (std::size_t a = 0; a < dimension_; ++a)
        for (std::size_t b = 0; b < dimension_; ++b)
          h[a][b] += u[a] * g[b];
      if (hasHoop_)
        h[2][2] += u[0] * cell_.value(i, iq) / cell_.position(iq)[0];
    }
    strains_[q] = greenStrain(h);
    const bool isThroughAxis = hasHoop_ && !(h[2][2] > -1.0);
    dilatations_[q] = isThroughAxis ? -2.0 : determinantBeyondOne(h);
    for (std::size_t a = 0; a < 3; ++a)
      h[a][a] += 1.0;
    gradients_[q] = h;
  }
  leastJacobian_ = 1.0 + *std::min_element(dilatations_.begin(), dilatations_.end());
}

// J̄ − 1 = ΣₐᵦψₐG⁻¹ₐᵦ∫ψᵦ(J − 1), as a matrix that takes values at points.
void FiniteStrain::findProjection() {
  space_.update();
  const std::size_t m = space_.size(), n = points();
  std::vector<double> gram(m * m, 0.0), moments(m * n);
  for (std::size_t q = 0; q < n; ++q) {
    const double* psi = space_.at(q);
    for (std::size_t a = 0; a < m; ++a) {
      moments[q * m + a] = cell_.measure(static_cast<int>(q)) * psi[a];
      for (std::size_t b = 0; b < m; ++b)
        gram[a * m + b] += moments[q * m + a] * psi[b];
    }
  }
  solveSmall(static_cast<int>(m), gram, static_cast<int>(n), moments.data());
  projection_.assign(n * n, 0.0);
  smooth_.assign(n, 0.0);
  for (std::size_t q = 0; q < n; ++q)
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t a = 0; a < m; ++a)
        projection_[q * n + p] += space_.at(q)[a] * moments[p * m + a];
      smooth_[q] += projection_[q * n + p] * dilatations_[p];
    }
}

// Ē = (J̄/J)^{2/3}E + ½((J̄/J)^{2/3} − 1)I.
void FiniteStrain::projectStrains() {
  for (std::size_t q = 0; q < points(); ++q) {
    const double logarithm = std::log1p((smooth_[q] - dilatations_[q]) / (1.0 + dilatations_[q]));
    factors_[q] = std::exp(logarithm / 3.0);
    const double change = std::expm1(2.0 / 3.0 * logarithm);
    for (std::size_t r = 0; r < 6; ++r)
      strains_[q][r] += change * (strains_[q][r] + (r < 3 ? 0.5 : 0.0));
  }
}

void FiniteStrain::findOperator() {
  std::fill(values_.begin(), values_.end(), 0.0);
  for (std::size_t q = 0; q < points(); ++q) {
    const int iq = static_cast<int>(q);
    const DeformationGradient& f = gradients_[q];
    for (int i = 0; i < cell_.basisSize(); ++i) {
      const Point& g = cell_.gradient(i, iq);
      for (std::size_t a = 0; a < dimension_; ++a) {
        const std::size_t k = static_cast<std::size_t>(i) * dimension_ + a;
        at(q, 0)[k] = f[a][0] * g[0];
        at(q, 1)[k] = f[a][1] * g[1];
        at(q, 3)[k] = f[a][0] * g[1] + f[a][1] * g[0];
        if (dimension_ == 3) {
          at(q, 2)[k] = f[a][2] * g[2];
          at(q, 4)[k] = f[a][1] * g[2] + f[a][2] * g[1];
          at(q, 5)[k] = f[a][0] * g[2] + f[a][2] * g[0];
        }
      }
      if (hasHoop_)
        at(q, 2)[static_cast<std::size_t>(i) * dimension_] =
            f[2][2] * cell_.value(i, iq) / cell_.position(iq)[0];
    }
  }
}

// δJ at all points, by dof.
void FiniteStrain::findChangesOfVolume(std::vector<double>& changes) const {
  changes.assign(points() * dofs_, 0.0);
  for (std::size_t q = 0; q < points(); ++q) {
    const int iq = static_cast<int>(q);
    const double jacobian = 1.0 + dilatations_[q];
    const DeformationGradient h = inverseTransposed(gradients_[q], jacobian);
    for (int i = 0; i < cell_.basisSize(); ++i) {
      const Point& g = cell_.gradient(i, iq);
      for (std::size_t a = 0; a < dimension_; ++a) {
        double& change = changes[q * dofs_ + static_cast<std::size_t>(i) * dimension_ + a];
        for (std::size_t b = 0; b < dimension_; ++b)
          change += jacobian * h[a][b] * g[b];
        if (hasHoop_ && a == 0)
          change += jacobian * h[2][2] * cell_.value(i, iq) / cell_.position(iq)[0];
      }
    }
  }
}

// δĒ = (J̄/J)^{2/3}(δE + ⅓C(δJ̄/J̄ − δJ/J)).
void FiniteStrain::project() {
  std::vector<double> changes, smooth(dofs_);
  findChangesOfVolume(changes);
  for (std::size_t q = 0; q < points(); ++q) {
    std::fill(smooth.begin(), smooth.end(), 0.0);
    for (std::size_t p = 0; p < points(); ++p)
      for (std::size_t k = 0; k < dofs_; ++k)
        smooth[k] += projection_[q * points() + p] * changes[p * dofs_ + k];
    const Voigt c = squareOf(gradients_[q]);
    const double square = factors_[q] * factors_[q];
    for (std::size_t r = 0; r < rows_; ++r)
      for (std::size_t k = 0; k < dofs_; ++k)
        at(q, r)[k] = square * (at(q, r)[k] + c[r] / 3.0 *
                                                  (smooth[k] / (1.0 + smooth_[q]) -
                                                   changes[q * dofs_ + k] / (1.0 + dilatations_[q])));
  }
}

} // namespace Harmos::fem
