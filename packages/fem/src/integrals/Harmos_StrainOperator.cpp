// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StrainOperator.hpp"

#include "Harmos_Errors.hpp"

#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos::fem {
namespace {

std::size_t strainSize(const Mesh& mesh) {
  return mesh.dimension() == 2 ? 4 : 6;
}

bool isReducible(const CellShape& shape) {
  return shape.isSerendipity || (shape.isWedge && shape.order == 1);
}

} // namespace

int stiffnessDegree(CellType type, Integration integration) {
  const CellShape& shape = shapeOf(type);
  if (integration == Integration::Full || !isReducible(shape))
    return shape.stiffnessDegree;
  return shape.isWedge ? shape.order : 3;
}

int stiffnessDegree(const Mesh& mesh, Integration integration) {
  const int degree = stiffnessDegree(mesh.cellType, integration);
  return mesh.isAxisymmetric ? std::max(degree, 2) : degree;
}

void solveSmall(int n, std::vector<double>& matrix, int columns, double* rhs) {
  int info = 0;
  Teuchos::LAPACK<int, double>().POSV('L', n, columns, matrix.data(), n, rhs, n, &info);
  HARMOS_REQUIRE(info == 0, "a cell has too few quadrature points for its polynomials");
}

bool isProjected(const Mesh& mesh, const Elasticity& elasticity) {
  const CellShape& shape = shapeOf(mesh.cellType);
  return elasticity.dilatation == Dilatation::Projected && elasticity.kinematics != Kinematics::PlaneStress &&
         !(shape.isSimplex && shape.order == 1);
}

std::vector<VoigtMatrix> stiffnesses(const Elasticity& elasticity) {
  std::vector<VoigtMatrix> result;
  for (const Material& material : elasticity.materials)
    result.push_back(material.stiffness(elasticity.kinematics));
  return result;
}

const VoigtMatrix& stiffnessOf(const std::vector<VoigtMatrix>& all, int region) {
  HARMOS_REQUIRE(region >= 0 && region < static_cast<int>(all.size()), "a region has no material");
  return all[static_cast<std::size_t>(region)];
}

TemperatureField::TemperatureField(const Mesh& mesh, const ReferenceElement& element, Integration integration)
    : mesh_(mesh) {
  const CellType linear = linearOf(mesh.cellType);
  if (linear == mesh.cellType) {
    const auto nodes = static_cast<std::size_t>(mesh.nodesPerCell());
    weights_.assign(element.quadrature().points.size(),
                    std::vector<double>(nodes, 1.0 / static_cast<double>(nodes)));
    return;
  }
  if (shapeOf(mesh.cellType).isSerendipity && integration == Integration::Reduced) {
    weights_ = basisValues(mesh.cellType, element.quadrature().points);
    return;
  }
  const auto size = static_cast<std::size_t>(mesh.nodesPerCell()),
             corners = static_cast<std::size_t>(shapeOf(linear).nodes);
  const auto atNodes = basisValues(linear, shapeOf(mesh.cellType).nodeCoordinates);
  std::vector<double> gram(corners * corners, 0.0), moments(corners * size);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t a = 0; a < corners; ++a) {
      moments[i * corners + a] = atNodes[i][a];
      for (std::size_t b = 0; b < corners; ++b)
        gram[a * corners + b] += atNodes[i][a] * atNodes[i][b];
    }
  solveSmall(static_cast<int>(corners), gram, static_cast<int>(size), moments.data());
  for (const std::vector<double>& functions : basisValues(linear, element.quadrature().points)) {
    std::vector<double>& weights = weights_.emplace_back(size, 0.0);
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t a = 0; a < corners; ++a)
        weights[i] += functions[a] * moments[i * corners + a];
  }
}

double TemperatureField::at(const std::vector<double>& nodal, int cell, int q) const {
  double sum = 0.0;
  const std::vector<double>& weights = weights_[static_cast<std::size_t>(q)];
  for (std::size_t i = 0; i < weights.size(); ++i)
    sum += weights[i] * nodal[static_cast<std::size_t>(mesh_.cell(cell)[i])];
  return sum;
}

DilatationSpace::DilatationSpace(const Mesh& mesh, const CellIntegrator& cell)
    : cell_(cell), dimension_(static_cast<std::size_t>(mesh.dimension())) {
  const CellShape& shape = shapeOf(mesh.cellType);
  size_ = shape.order == 2 && !shape.isSimplex && !shape.isWedge ? 1 + dimension_ : 1;
  values_.assign(static_cast<std::size_t>(cell.points()) * size_, 1.0);
}

void DilatationSpace::update() {
  if (size_ == 1)
    return; // the constant is the same in all cells
  Point centre{};
  const double size = cell_.size();
  for (int q = 0; q < cell_.points(); ++q)
    for (std::size_t d = 0; d < 3; ++d)
      centre[d] += cell_.measure(q) / size * cell_.position(q)[d];
  length_ = std::pow(size, 1.0 / static_cast<double>(dimension_));
  for (int q = 0; q < cell_.points(); ++q) {
    const Point x = cell_.position(q);
    for (std::size_t a = 1; a < size_; ++a)
      values_[static_cast<std::size_t>(q) * size_ + a] = (x[a - 1] - centre[a - 1]) / length_;
  }
}

StrainOperator::StrainOperator(const Mesh& mesh, const CellIntegrator& cell, bool projected)
    : cell_(cell),
      dimension_(static_cast<std::size_t>(mesh.dimension())),
      rows_(strainSize(mesh)),
      dofs_(static_cast<std::size_t>(cell.basisSize()) * dimension_),
      projected_(projected),
      hasHoop_(mesh.isAxisymmetric),
      space_(mesh, cell) {
  values_.resize(static_cast<std::size_t>(cell.points()) * rows_ * dofs_);
}

void StrainOperator::update() {
  std::fill(values_.begin(), values_.end(), 0.0);
  for (int q = 0; q < cell_.points(); ++q)
    for (int i = 0; i < cell_.basisSize(); ++i) {
      const Point& g = cell_.gradient(i, q);
      const std::size_t k = static_cast<std::size_t>(i) * dimension_;
      at(q, 0)[k] = g[0];
      at(q, 1)[k + 1] = g[1];
      at(q, 3)[k] = g[1];
      at(q, 3)[k + 1] = g[0];
      if (hasHoop_)
        at(q, 2)[k] = cell_.value(i, q) / cell_.position(q)[0];
      if (dimension_ == 3) {
        at(q, 2)[k + 2] = g[2];
        at(q, 4)[k + 1] = g[2];
        at(q, 4)[k + 2] = g[1];
        at(q, 5)[k] = g[2];
        at(q, 5)[k + 2] = g[0];
      }
    }
  if (projected_)
    project();
}

// The divergence d of each basis function becomes its L2 projection d̄: ε̄ = ε + (d̄ − d)/3 · I.
void StrainOperator::project() {
  space_.update();
  const std::size_t m = space_.size();
  std::vector<double> gram(m * m, 0.0), moments(m * dofs_, 0.0);
  const auto points = static_cast<std::size_t>(cell_.points());
  std::vector<double> divergence(points * dofs_);
  for (std::size_t q = 0; q < points; ++q) {
    const int iq = static_cast<int>(q);
    const double* psi = space_.at(q);
    for (std::size_t j = 0; j < dofs_; ++j)
      divergence[q * dofs_ + j] =
          row(iq, 0)[j] + row(iq, 1)[j] + (dimension_ == 3 || hasHoop_ ? row(iq, 2)[j] : 0.0);
    for (std::size_t a = 0; a < m; ++a) {
      const double weight = cell_.measure(iq) * psi[a];
      for (std::size_t b = 0; b < m; ++b)
        gram[a * m + b] += weight * psi[b];
      for (std::size_t j = 0; j < dofs_; ++j)
        moments[j * m + a] += weight * divergence[q * dofs_ + j];
    }
  }
  solveSmall(static_cast<int>(m), gram, static_cast<int>(dofs_), moments.data());
  for (std::size_t q = 0; q < points; ++q)
    for (std::size_t j = 0; j < dofs_; ++j) {
      double projected = 0.0;
      for (std::size_t a = 0; a < m; ++a)
        projected += space_.at(q)[a] * moments[j * m + a];
      const double change = (projected - divergence[q * dofs_ + j]) / 3.0;
      for (std::size_t r = 0; r < 3; ++r)
        at(static_cast<int>(q), r)[j] += change;
    }
}

Voigt StrainOperator::stress(int q, const double* values, const VoigtMatrix& stiffness,
                             const Voigt& thermalStrain) const {
  Voigt e{}, s{};
  for (std::size_t r = 0; r < rows_; ++r)
    for (std::size_t j = 0; j < dofs_; ++j)
      e[r] += row(q, r)[j] * values[j];
  for (std::size_t r = 0; r < 6; ++r)
    e[r] -= thermalStrain[r];
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t k = 0; k < 6; ++k)
      s[r] += stiffness[r][k] * e[k];
  return s;
}

} // namespace Harmos::fem
