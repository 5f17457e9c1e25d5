// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Elasticity.hpp"

#include "Harmos_CellIntegrator.hpp"
#include "Harmos_Errors.hpp"

#include <Teuchos_LAPACK.hpp>

#include <cmath>

namespace Harmos::fem {
namespace {

// Rows of strains that take part: xx, yy, zz, xy in the plane.
std::size_t strainSize(const Mesh& mesh) {
  return mesh.dimension() == 2 ? 4 : 6;
}

// Functions of a coordinate relative to the centre of the cell: 1, or 1, x, y(, z).
int polynomials(int degree, int dimension) {
  return degree == 0 ? 1 : 1 + dimension;
}

// Solves the symmetric positive definite system of order n for several right-hand sides (columns).
void solveSmall(int n, std::vector<double>& matrix, int columns, double* rhs) {
  int info = 0;
  Teuchos::LAPACK<int, double>().POSV('L', n, columns, matrix.data(), n, rhs, n, &info);
  HARMOS_REQUIRE(info == 0, "a cell has too few quadrature points for its polynomials");
}

// B̄ of a cell at all its quadrature points.
class StrainOperator {
 public:
  StrainOperator(const Mesh& mesh, const CellIntegrator& cell, bool projected)
      : cell_(cell),
        dimension_(static_cast<std::size_t>(mesh.dimension())),
        rows_(strainSize(mesh)),
        dofs_(static_cast<std::size_t>(cell.basisSize()) * dimension_),
        projected_(projected) {
    const CellShape& shape = shapeOf(mesh.cellType);
    functions_ = polynomials(shape.order == 2 && !shape.isSimplex ? 1 : 0, mesh.dimension());
    values_.resize(static_cast<std::size_t>(cell.points()) * rows_ * dofs_);
  }

  std::size_t rows() const { return rows_; }
  std::size_t dofs() const { return dofs_; }

  // Row r of B̄ at point q.
  const double* row(int q, std::size_t r) const {
    return values_.data() + (static_cast<std::size_t>(q) * rows_ + r) * dofs_;
  }

  // For the cell that the integrator has turned to.
  void update() {
    std::fill(values_.begin(), values_.end(), 0.0);
    for (int q = 0; q < cell_.points(); ++q)
      for (int i = 0; i < cell_.basisSize(); ++i) {
        const Point& g = cell_.gradient(i, q);
        const std::size_t k = static_cast<std::size_t>(i) * dimension_;
        at(q, 0)[k] = g[0];
        at(q, 1)[k + 1] = g[1];
        at(q, 3)[k] = g[1];
        at(q, 3)[k + 1] = g[0];
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

 private:
  double* at(int q, std::size_t r) {
    return values_.data() + (static_cast<std::size_t>(q) * rows_ + r) * dofs_;
  }

  // The divergence d of each basis function becomes its L2 projection d̄: ε̄ = ε + (d̄ − d)/3 · I.
  void project() {
    const auto m = static_cast<std::size_t>(functions_);
    std::vector<double> gram(m * m, 0.0), moments(m * dofs_, 0.0);
    const auto points = static_cast<std::size_t>(cell_.points());
    std::vector<double> psi(points * m, 1.0);
    Point centre{};
    const double size = cell_.size();
    for (int q = 0; q < cell_.points(); ++q)
      for (std::size_t d = 0; d < 3; ++d)
        centre[d] += cell_.measure(q) / size * cell_.position(q)[d];
    const double length = std::pow(size, 1.0 / static_cast<double>(dimension_));
    std::vector<double> divergence(points * dofs_);
    for (std::size_t q = 0; q < points; ++q) {
      const int iq = static_cast<int>(q);
      const Point x = cell_.position(iq);
      for (std::size_t a = 1; a < m; ++a)
        psi[q * m + a] = (x[a - 1] - centre[a - 1]) / length;
      for (std::size_t j = 0; j < dofs_; ++j)
        divergence[q * dofs_ + j] = row(iq, 0)[j] + row(iq, 1)[j] + (dimension_ == 3 ? row(iq, 2)[j] : 0.0);
      for (std::size_t a = 0; a < m; ++a) {
        const double weight = cell_.measure(iq) * psi[q * m + a];
        for (std::size_t b = 0; b < m; ++b)
          gram[a * m + b] += weight * psi[q * m + b];
        for (std::size_t j = 0; j < dofs_; ++j)
          moments[j * m + a] += weight * divergence[q * dofs_ + j];
      }
    }
    solveSmall(functions_, gram, static_cast<int>(dofs_), moments.data());
    for (std::size_t q = 0; q < points; ++q)
      for (std::size_t j = 0; j < dofs_; ++j) {
        double projected = 0.0;
        for (std::size_t a = 0; a < m; ++a)
          projected += psi[q * m + a] * moments[j * m + a];
        const double change = (projected - divergence[q * dofs_ + j]) / 3.0;
        for (std::size_t r = 0; r < 3; ++r)
          at(static_cast<int>(q), r)[j] += change;
      }
  }

  const CellIntegrator& cell_;
  std::size_t dimension_, rows_, dofs_;
  bool projected_;
  int functions_ = 1;
  std::vector<double> values_;
};

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

const VoigtMatrix& of(const std::vector<VoigtMatrix>& all, int region) {
  HARMOS_REQUIRE(region >= 0 && region < static_cast<int>(all.size()), "a region has no material");
  return all[static_cast<std::size_t>(region)];
}

} // namespace

int stiffnessDegree(CellType type) {
  const CellShape& shape = shapeOf(type);
  if (shape.isSimplex)
    return shape.order == 1 ? 1 : 4;
  return shape.order == 1 ? 3 : 5;
}

LocalMatrix assembleElasticity(const Mesh& mesh, const Elasticity& elasticity) {
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh.cellType));
  CellIntegrator cell(mesh, element);
  StrainOperator strain(mesh, cell, isProjected(mesh, elasticity));
  const std::vector<VoigtMatrix> stiffness = stiffnesses(elasticity);
  BlockAssembler assembler(mesh, mesh.dimension());
  const std::size_t n = strain.dofs(), rows = strain.rows();
  std::vector<double> k(n * n), stress(rows * n);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    strain.update();
    const VoigtMatrix& material = of(stiffness, mesh.region(c));
    std::fill(k.begin(), k.end(), 0.0);
    for (int q = 0; q < cell.points(); ++q) {
      std::fill(stress.begin(), stress.end(), 0.0);
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t s = 0; s < rows; ++s) {
          const double entry = cell.measure(q) * material[r][s];
          if (entry != 0.0)
            for (std::size_t j = 0; j < n; ++j)
              stress[r * n + j] += entry * strain.row(q, s)[j];
        }
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t i = 0; i < n; ++i) {
          const double b = strain.row(q, r)[i];
          if (b != 0.0)
            for (std::size_t j = 0; j < n; ++j)
              k[i * n + j] += b * stress[r * n + j];
        }
    }
    assembler.add(c, k);
  }
  return assembler.take();
}

std::vector<double> assembleThermalLoad(const Mesh& mesh, const Elasticity& elasticity, double temperature) {
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh.cellType));
  CellIntegrator cell(mesh, element);
  StrainOperator strain(mesh, cell, isProjected(mesh, elasticity));
  const std::vector<VoigtMatrix> stiffness = stiffnesses(elasticity);
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  std::vector<double> f(static_cast<std::size_t>(mesh.numberOfNodes()) * dimension, 0.0);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    strain.update();
    const VoigtMatrix& material = of(stiffness, mesh.region(c));
    const Voigt expansion = elasticity.materials[static_cast<std::size_t>(mesh.region(c))].thermalStrain();
    for (std::size_t r = 0; r < strain.rows(); ++r) {
      double stress = 0.0;
      for (std::size_t s = 0; s < 6; ++s)
        stress += material[r][s] * expansion[s] * temperature;
      for (int q = 0; q < cell.points() && stress != 0.0; ++q)
        for (std::size_t j = 0; j < strain.dofs(); ++j)
          f[static_cast<std::size_t>(mesh.cell(c)[j / dimension]) * dimension + j % dimension] +=
              cell.measure(q) * stress * strain.row(q, r)[j];
    }
  }
  return f;
}

StressSums stressSums(const Mesh& mesh, const Elasticity& elasticity, const std::vector<double>& displacement,
                      double temperature) {
  const CellShape& shape = shapeOf(mesh.cellType);
  // The projection needs the points of the stiffness matrix; stresses are sampled at fewer.
  const ReferenceElement full(mesh.cellType, stiffnessDegree(mesh.cellType));
  const int sampleDegree = shape.order == 1 ? 1 : (shape.isSimplex ? 2 : 3);
  const ReferenceElement sample(mesh.cellType, sampleDegree);
  const bool projected = isProjected(mesh, elasticity);
  // With a projected dilatation strains are sampled where they are integrated.
  const ReferenceElement& element = projected && shape.order == 2 ? full : sample;
  CellIntegrator cell(mesh, element);
  StrainOperator strain(mesh, cell, projected);
  const std::vector<VoigtMatrix> stiffness = stiffnesses(elasticity);
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  const auto nodes = static_cast<std::size_t>(mesh.numberOfNodes());
  const int m = polynomials(shape.order - 1, mesh.dimension());
  const auto functions = static_cast<std::size_t>(m);
  StressSums sums{std::vector<Voigt>(nodes), std::vector<double>(nodes, 0.0)};
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    strain.update();
    const VoigtMatrix& material = of(stiffness, mesh.region(c));
    const Voigt expansion = elasticity.materials[static_cast<std::size_t>(mesh.region(c))].thermalStrain();
    const double length = std::pow(cell.size(), 1.0 / static_cast<double>(dimension));
    const Point origin = mesh.local(mesh.cell(c)[0]);
    std::vector<double> gram(functions * functions, 0.0), moments(functions * 6, 0.0);
    const auto basis = [&](const Point& x, std::size_t a) {
      return a == 0 ? 1.0 : (x[a - 1] - origin[a - 1]) / length;
    };
    for (int q = 0; q < cell.points(); ++q) {
      Voigt e{}, s{};
      for (std::size_t r = 0; r < strain.rows(); ++r) {
        for (std::size_t j = 0; j < strain.dofs(); ++j)
          e[r] +=
              strain.row(q, r)[j] *
              displacement[static_cast<std::size_t>(mesh.cell(c)[j / dimension]) * dimension + j % dimension];
      }
      for (std::size_t r = 0; r < 6; ++r)
        e[r] -= temperature * expansion[r];
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t k = 0; k < 6; ++k)
          s[r] += material[r][k] * e[k];
      const Point x = cell.position(q);
      for (std::size_t a = 0; a < functions; ++a) {
        const double weight = cell.measure(q) * basis(x, a);
        for (std::size_t b = 0; b < functions; ++b)
          gram[a * functions + b] += weight * basis(x, b);
        for (std::size_t r = 0; r < 6; ++r)
          moments[r * functions + a] += weight * s[r];
      }
    }
    solveSmall(m, gram, 6, moments.data());
    for (int i = 0; i < cell.basisSize(); ++i) {
      const auto node = static_cast<std::size_t>(mesh.cell(c)[i]);
      const Point x = mesh.local(mesh.cell(c)[i]);
      sums.size[node] += cell.size();
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t a = 0; a < functions; ++a)
          sums.weighted[node][r] += cell.size() * basis(x, a) * moments[r * functions + a];
    }
  }
  return sums;
}

} // namespace Harmos::fem
